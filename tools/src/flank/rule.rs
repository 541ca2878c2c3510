//! One rule of a strip: its ends, the normals there, and the frame in which a cutter is put against it.

use super::directrix::CurveJet2;
use osculate_geom::roots::{FLAT, minimum};
use osculate_geom::{Point3, Side, Unit3, Vec3};

/// Why a rule gives no frame.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RuleError {
    /// A point or derivative is not finite.
    #[error("directrix {end} has no finite derivatives at u = {u}")]
    NotFinite {
        /// 0 or 1.
        end: usize,
        /// The parameter.
        u: f64,
    },
    /// The directrices meet.
    #[error("the directrices meet at u = {u}: the rule there is {length_mm:.3e} mm long")]
    ZeroLength {
        /// The parameter.
        u: f64,
        /// Length of the rule, mm.
        length_mm: f64,
    },
    /// A directrix stands still (a cusp) or runs along the rule: no tangent plane.
    #[error(
        "no tangent plane at the end of the rule at u = {u} on directrix {end}, which stands still there or runs along the rule: |C' x z| = {across_mm:.3e} mm"
    )]
    NoNormal {
        /// 0 or 1.
        end: usize,
        /// The parameter.
        u: f64,
        /// Length of C' across the rule, mm per unit of u.
        across_mm: f64,
    },
    /// The normals at both ends are opposite: they have no bisector.
    #[error(
        "the surface turns over along the rule at u = {u}: the end normals enclose {angle_deg:.6} degrees"
    )]
    Opposed {
        /// The parameter.
        u: f64,
        /// Angle between the normals, degrees.
        angle_deg: f64,
    },
}

/// The frame of a rule, or its derivative by u: the vectors x, y, z of [D98, section 2.1] with unit normals in the
/// bisector.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RuleFrame {
    /// Along the directrices: `y x z`.
    pub x: Vec3,
    /// From the surface to the tool: the bisector of the end normals.
    pub y: Vec3,
    /// Along the rule, from directrix 0 to directrix 1.
    pub z: Vec3,
}

/// A rule with its frame and their derivatives by u.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rule {
    /// The parameter.
    pub u: f64,
    /// Both directrices there.
    pub ends: [CurveJet2; 2],
    /// h_p, mm.
    pub length_mm: f64,
    /// Derivative of h_p by u, mm.
    pub length_rate_mm: f64,
    /// N_i = unit(T_i x z), along `S_u x S_v` whatever the side of the tool.
    pub normals: [Unit3; 2],
    /// Derivatives of N_i by u.
    pub normal_rates: [Vec3; 2],
    /// x, y, z; y points to the tool.
    pub frame: RuleFrame,
    /// Their derivatives by u.
    pub frame_rate: RuleFrame,
    /// The side that y is on.
    pub side: Side,
}

/// Unit vector along `v` and its derivative.
fn unit(v: &Vec3, rate: &Vec3) -> (Vec3, Vec3, f64) {
    let length = v.norm();
    let e = v / length;
    (e, (rate - e * e.dot(rate)) / length, length)
}

/// Lengths below this fraction of the sizes that they are differences of are rounding: a thousand units in the last
/// place.
const ROUNDING: f64 = 1e3 * f64::EPSILON;

impl Rule {
    /// The rule between the points of two directrices.
    ///
    /// # Errors
    /// [`RuleError`].
    pub fn new(u: f64, ends: [CurveJet2; 2], side: Side) -> Result<Self, RuleError> {
        if let Some(end) = ends.iter().position(|j| !j.is_finite()) {
            return Err(RuleError::NotFinite { end, u });
        }
        let w = ends[1].point - ends[0].point;
        let w_rate = ends[1].first - ends[0].first;
        let size = ends[0].point.coords.amax().max(ends[1].point.coords.amax());
        let length_mm = w.norm();
        if length_mm <= ROUNDING * size {
            return Err(RuleError::ZeroLength { u, length_mm });
        }
        let (z, z_rate, _) = unit(&w, &w_rate);
        let mut normals = [Unit3::new_unchecked(z); 2];
        let mut normal_rates = [Vec3::zeros(); 2];
        for (end, j) in ends.iter().enumerate() {
            let across = j.first.cross(&z);
            let across_mm = across.norm();
            if across_mm <= ROUNDING * (size + j.first.norm()) {
                return Err(RuleError::NoNormal { end, u, across_mm });
            }
            let (n, rate, _) = unit(&across, &(j.second.cross(&z) + j.first.cross(&z_rate)));
            normals[end] = Unit3::new_unchecked(n);
            normal_rates[end] = rate;
        }
        let sigma = side.sign();
        let sum = normals[0].into_inner() + normals[1].into_inner();
        if sum.norm() <= ROUNDING {
            let angle_deg = normals[0].angle(&normals[1]).to_degrees();
            return Err(RuleError::Opposed { u, angle_deg });
        }
        let (y, y_rate, _) = unit(&(sum * sigma), &((normal_rates[0] + normal_rates[1]) * sigma));
        let frame = RuleFrame { x: y.cross(&z), y, z };
        let x = y_rate.cross(&z) + y.cross(&z_rate);
        let frame_rate = RuleFrame { x, y: y_rate, z: z_rate };
        let length_rate_mm = z.dot(&w_rate);
        Ok(Self { u, ends, length_mm, length_rate_mm, normals, normal_rates, frame, frame_rate, side })
    }

    /// Angle from N0 to N1 about z, rad, from -pi to pi: the twist alpha of the rule with its sense.
    #[must_use]
    pub fn twist_rad(&self) -> f64 {
        let [a, b] = self.normals;
        a.cross(&b).dot(&self.frame.z).atan2(a.dot(&b))
    }

    /// The point of the rule at v.
    #[must_use]
    pub fn point(&self, v: f64) -> Point3 {
        let [a, b] = &self.ends;
        a.point + (b.point - a.point) * v
    }

    /// S_u at v.
    #[must_use]
    pub fn du(&self, v: f64) -> Vec3 {
        let [a, b] = &self.ends;
        a.first + (b.first - a.first) * v
    }

    /// The unit normal at v on the side of the tool; None where S_u runs along the rule.
    #[must_use]
    pub fn normal(&self, v: f64) -> Option<Unit3> {
        let n = self.du(v).cross(&self.frame.z) * self.side.sign();
        Unit3::try_new(n, 0.0)
    }

    /// Curvature of the line of constant v, projected along the rule, 1/mm: positive where the body is convex on the
    /// tool's side. It is the curvature of the surface's section across the rule, as far as that line makes it; at v = 0
    /// and 1 it is 1/rho of the directrices. Not finite where there is no tangent plane.
    #[must_use]
    pub fn section_curvature_per_mm(&self, v: f64) -> f64 {
        let [a, b] = &self.ends;
        let z = self.frame.z;
        let across = self.du(v).cross(&z);
        let speed = across.norm();
        let bend = a.second + (b.second - a.second) * v;
        // k_P = -II / I with the normal to the tool; the projection has the same normal component.
        -bend.dot(&across) * self.side.sign() / (speed * speed * speed)
    }

    /// [`Rule::section_curvature_per_mm`] at the end on directrix 0 or 1.
    #[must_use]
    pub fn projected_curvature_per_mm(&self, end: usize) -> f64 {
        self.section_curvature_per_mm(end as f64)
    }

    /// The largest radius of a cylinder along the rule that no section across the rule is too hollow for, mm; infinite
    /// where none is hollow.
    #[must_use]
    pub fn largest_fit_mm(&self) -> f64 {
        const LOOKS: usize = 16;
        let at = |k: usize| k as f64 / LOOKS as f64;
        let hollow = |v: f64| {
            let k = -self.section_curvature_per_mm(v);
            if k.is_finite() { k } else { f64::NEG_INFINITY }
        };
        let seen: [f64; LOOKS + 1] = std::array::from_fn(|k| hollow(at(k)));
        let most = (0..=LOOKS).max_by(|a, b| seen[*a].total_cmp(&seen[*b])).unwrap_or(0);
        let (lo, hi) = (at(most.saturating_sub(1)), at((most + 1).min(LOOKS)));
        let found = -minimum([lo, hi], FLAT, |v| -hollow(v)).f;
        let most = found.max(seen[most]);
        if most > 0.0 { 1.0 / most } else { f64::INFINITY }
    }
}
