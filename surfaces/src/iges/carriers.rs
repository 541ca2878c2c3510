//! Surfaces of IGES entities as carriers of faces, in millimetres.

use super::directory::Entity;
use super::geometry::{Geometry, MAX_CHAIN, Space, Unread};
use super::join::alike;
use super::parametric::{self, Patches};
use crate::nurbs::{Net, NurbsSurface};
use crate::part::FaceKind;
use crate::ruled::ruled;
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use crate::trim::curve::{Curve, Piece};
use crate::trim::motion::Motion;
use crate::trim::sweep::{extrude, revolve};
use osculate_geom::analytic::Placement;
use osculate_geom::{Axis, Interval, Point3, Surface, Unit3, Vec3, uv};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A revolution over this much more than a full turn is one: what the digits of 2 pi leave.
const OVER_A_TURN: f64 = 1e-6;

/// Largest pairing error of a ruled surface, as a fraction of its rulings' length, that is not told.
const PAIRED: f64 = 1e-9;

impl Geometry<'_> {
    /// A surface with its transform and `outer` applied, and its kind. The parameters of splines are those of the
    /// file; those of other kinds are not.
    pub(crate) fn surface(&self, de: i64, outer: &Motion) -> Result<(FaceSurface, FaceKind), Unread> {
        self.surface_below(de, outer, 0)
    }

    fn surface_below(
        &self,
        de: i64,
        outer: &Motion,
        depth: usize,
    ) -> Result<(FaceSurface, FaceKind), Unread> {
        if depth >= MAX_CHAIN {
            return Err(self.malformed(de, "offset surfaces refer to each other in a circle"));
        }
        let e = self.entity(de)?;
        let motion = self.motion(e)?.then(outer);
        match e.kind {
            128 => {
                let n = self.spline_surface(de, e, &motion)?;
                Ok((FaceSurface::Nurbs(Arc::new(n)), FaceKind::Bspline))
            }
            108 => {
                let n = self.numbers(de, e, 0, 4)?;
                let normal = Vec3::new(n[0], n[1], n[2]);
                let n2 = normal.norm_squared();
                let Some(z) = Unit3::try_new(motion.linear * normal, 0.0) else {
                    return Err(self.malformed(de, "a plane without normal"));
                };
                let origin = Point3::from(normal * (n[3] / n2 * self.scale_mm));
                let made = Analytic::new(Shape::Plane, Placement::new(motion.point(&origin), z, None))
                    .map_err(|e| self.malformed(de, e.to_string()))?;
                Ok((FaceSurface::Analytic(Arc::new(made)), FaceKind::Plane))
            }
            114 => {
                let n = self.parametric_surface(de, e, &motion)?;
                Ok((FaceSurface::Nurbs(Arc::new(n)), FaceKind::Bspline))
            }
            118 => Ok((self.moved(de, self.ruled(de, e)?, &motion)?, FaceKind::Ruled)),
            120 => Ok((self.moved(de, self.revolution(de, e)?, &motion)?, FaceKind::Revolution)),
            122 => {
                let curve = self.generatrix(self.required(de, e, 0, "directrix")?)?;
                let end = Point3::from(self.triple(de, e, 1)? * self.scale_mm);
                let direction = end - curve.point(curve.range()[0]);
                if direction.norm() == 0.0 {
                    return Err(self.malformed(de, "a cylinder of length zero"));
                }
                let made =
                    extrude(&curve, &direction, [0.0, 1.0]).map_err(|e| self.malformed(de, e.to_string()))?;
                Ok((self.moved(de, made, &motion)?, FaceKind::Extrusion))
            }
            140 => {
                let n = self.numbers(de, e, 0, 4)?;
                let base_de = self.required(de, e, 4, "surface")?;
                let (base, _) = self.surface_below(base_de, &motion, depth + 1)?;
                // The indicator is the normal of the offset in the middle of the surface.
                let d = base.domain();
                let middle = |i: Interval| if i.length().is_finite() { i.at(0.5) } else { 0.0 };
                let jet = base.jet2(uv(middle(d.u), middle(d.v)));
                let along = jet.du.cross(&jet.dv).dot(&(motion.linear * Vec3::new(n[0], n[1], n[2])));
                if along == 0.0 || !along.is_finite() {
                    return Err(self.malformed(de, "an offset whose indicator is not along the normal"));
                }
                let distance_mm = n[3] * self.scale_mm * scale_of(&motion) * along.signum();
                let made = base.offset(distance_mm).map_err(|what| self.malformed(de, what))?;
                Ok((made, FaceKind::Offset))
            }
            190 | 192 | 194 | 196 | 198 => {
                let (shape, kind, placement) = self.analytic(de, e)?;
                let factor = scale_of(&motion);
                let placement = Placement::new(
                    motion.point(&placement.origin),
                    Unit3::new_normalize(motion.linear * placement.z.into_inner()),
                    Some(motion.linear * placement.x.into_inner()),
                );
                let made = Analytic::new(shape_times(shape, factor), placement)
                    .map_err(|e| self.malformed(de, e.to_string()))?;
                Ok((FaceSurface::Analytic(Arc::new(made)), kind))
            }
            _ => Err(Unread::Kind { de, kind: e.kind, form: e.form }),
        }
    }

    /// Entity 120, the angle first.
    fn revolution(&self, de: i64, e: &Entity) -> Result<NurbsSurface, Unread> {
        let axis = self.required(de, e, 0, "axis")?;
        let generatrix = self.required(de, e, 1, "generatrix")?;
        let line = self.pieces(axis, Space::Model, &Motion::identity())?;
        let Some([a, b]) = line.first().map(Piece::end_points) else {
            return Err(self.malformed(de, "a revolution without axis"));
        };
        let z = Unit3::try_new(b - a, 0.0).ok_or_else(|| self.malformed(de, "an axis of length zero"))?;
        let angles = [self.number(de, e, 2)?, self.number(de, e, 3)?];
        let mut sweep = angles[1] - angles[0];
        if sweep <= 0.0 && sweep > -TAU {
            // The standard has the end above the start.
            self.say(format!(
                "DE {de}: the end of its turn is {sweep:.6} rad before the start; a turn was added"
            ));
            sweep += TAU;
        }
        if !(sweep > 0.0 && sweep <= TAU * (1.0 + OVER_A_TURN)) {
            return Err(self.malformed(de, format!("a revolution over {sweep} rad")));
        }
        let curve = self.generatrix(generatrix)?;
        revolve(&curve, &Placement::new(a, z, None), [angles[0], angles[0] + sweep.min(TAU)])
            .map_err(|e| self.malformed(de, e.to_string()))
    }

    /// Entity 118: rulings between points of equal parameter. Where the file asks for equal arc length (form 0), the
    /// largest distance that makes between the ends of the rulings is told.
    fn ruled(&self, de: i64, e: &Entity) -> Result<NurbsSurface, Unread> {
        let first = self.generatrix(self.required(de, e, 0, "first curve")?)?;
        let second = self.generatrix(self.required(de, e, 1, "second curve")?)?;
        let second = if self.number(de, e, 2)? == 0.0 { second } else { second.reversed() };
        let bad = |what: String| self.malformed(de, what);
        let [a, b] = alike([&first, &second]).map_err(|e| bad(e.to_string()))?;
        if e.form == 0 {
            let off_mm = unequal_lengths(&a, &b);
            let ruling = (a.point(0.0) - b.point(0.0)).norm().max((a.point(1.0) - b.point(1.0)).norm());
            if off_mm > PAIRED * ruling {
                self.say(format!(
                    "DE {de}: its rulings are to join points at equal fractions of the curves' lengths and join \
                     points of equal parameters instead, up to {off_mm:.3e} mm away"
                ));
            }
        }
        ruled(a.curve(), b.curve()).map_err(|e| bad(e.to_string()))
    }

    /// Entity 114.
    fn parametric_surface(&self, de: i64, e: &Entity, motion: &Motion) -> Result<NurbsSurface, Unread> {
        let count = [self.count(de, e, 2, [6, 1])?, self.count(de, e, 3, [6, 1])?];
        if count.contains(&0) {
            return Err(self.malformed(de, "a parametric spline surface of no patches"));
        }
        let at = 4 + count[0] + 1 + count[1] + 1;
        let u = self.numbers(de, e, 4, 4 + count[0] + 1)?;
        let v = self.numbers(de, e, 4 + count[0] + 1, at)?;
        // Each row ends with a patch that means nothing; there may be a last row of them.
        let stride = 48 * (count[1] + 1);
        let need = stride
            .checked_mul(count[0] - 1)
            .and_then(|n| n.checked_add(48 * count[1]))
            .filter(|n| n.saturating_add(at) <= e.params.len());
        let Some(need) = need else {
            let what = format!("{} x {} patches in {} parameters", count[0], count[1], e.params.len());
            return Err(self.malformed(de, what));
        };
        let coefficients = self.numbers(de, e, at, at + need)?;
        let patches = Patches { breaks: [&u, &v], coefficients: &coefficients, stride };
        let place = |p: &Vec3| motion.point(&Point3::from(p * self.scale_mm));
        let (surface, jump) =
            parametric::surface(&patches, place).map_err(|e| self.malformed(de, e.to_string()))?;
        if let Some(jump_mm) = jump {
            self.say(format!(
                "DE {de}: its patches are up to {jump_mm:.3e} mm apart where they meet; they were joined"
            ));
        }
        Ok(surface)
    }

    /// The analytic surfaces of boundary representations.
    fn analytic(&self, de: i64, e: &Entity) -> Result<(Shape, FaceKind, Placement), Unread> {
        let at = self.required(de, e, 0, "location")?;
        let point = self.entity(at)?;
        let origin = Point3::from(self.triple(at, point, 0)? * self.scale_mm);
        let origin = self.motion(point)?.point(&origin);
        let direction = |k: usize| -> Result<Option<Vec3>, Unread> {
            match e.params.number(k).filter(|p| *p > 0.0) {
                Some(p) => {
                    let p = p as i64;
                    let d = self.entity(p)?;
                    Ok(Some(self.motion(d)?.linear * self.triple(p, d, 0)?))
                }
                None => Ok(None),
            }
        };
        let length = |k: usize| Ok::<f64, Unread>(self.number(de, e, k)? * self.scale_mm);
        let (shape, kind, z, x) = match e.kind {
            190 => (Shape::Plane, FaceKind::Plane, direction(1)?, direction(2)?),
            192 => {
                (Shape::Cylinder { radius_mm: length(2)? }, FaceKind::Cylinder, direction(1)?, direction(3)?)
            }
            194 => {
                let half_angle_rad = self.number(de, e, 3)?.to_radians();
                let shape = Shape::Cone { radius_mm: length(2)?, half_angle_rad };
                (shape, FaceKind::Cone, direction(1)?, direction(4)?)
            }
            196 => (Shape::Sphere { radius_mm: length(1)? }, FaceKind::Sphere, direction(2)?, direction(3)?),
            _ => {
                let shape = Shape::Torus { major_radius_mm: length(2)?, minor_radius_mm: length(3)? };
                (shape, FaceKind::Torus, direction(1)?, direction(4)?)
            }
        };
        let z = match z {
            Some(v) => Unit3::try_new(v, 0.0).ok_or_else(|| self.malformed(de, "an axis of length zero"))?,
            None => Vec3::z_axis(),
        };
        Ok((shape, kind, Placement::new(origin, z, x)))
    }

    /// Entity 128. The file runs through the poles with u fastest.
    fn spline_surface(&self, de: i64, e: &Entity, motion: &Motion) -> Result<NurbsSurface, Unread> {
        let count = [self.count(de, e, 0, [9, 1])? + 1, self.count(de, e, 1, [9, 1])? + 1];
        let degree = [self.degree(de, e, 2)?, self.degree(de, e, 3)?];
        let poles = count[0].checked_mul(count[1]).filter(|n| n.saturating_mul(4) <= e.params.len());
        let Some(poles) = poles else {
            let what = format!("{} x {} poles in {} parameters", count[0], count[1], e.params.len());
            return Err(self.malformed(de, what));
        };
        let lengths = [count[0] + degree[0] + 1, count[1] + degree[1] + 1];
        let at_v = 9 + lengths[0];
        let at_weights = at_v + lengths[1];
        let at_poles = at_weights + poles;
        let knots = [self.numbers(de, e, 9, at_v)?, self.numbers(de, e, at_v, at_weights)?];
        let file_weights = self.numbers(de, e, at_weights, at_poles)?;
        let file_points = self.numbers(de, e, at_poles, at_poles + 3 * poles)?;
        // Equal weights change nothing and cost a division at every point.
        let rational = file_weights.iter().any(|w| *w != file_weights[0]);
        let still = *motion == Motion::identity();
        let mut points = Vec::with_capacity(poles);
        let mut weights = Vec::with_capacity(if rational { poles } else { 0 });
        for i in 0..count[0] {
            for j in 0..count[1] {
                let k = j * count[0] + i;
                let c = &file_points[3 * k..3 * k + 3];
                let p = Point3::new(c[0], c[1], c[2]) * self.scale_mm;
                points.push(if still { p } else { motion.point(&p) });
                if rational {
                    weights.push(file_weights[k]);
                }
            }
        }
        let weights = rational.then_some(weights);
        NurbsSurface::new(degree, knots, Net { count, points, weights })
            .map_err(|error| self.malformed(de, error.to_string()))
    }

    /// The parameter rectangle that an entity 128 names, `[u0, u1, v0, v1]`.
    pub(crate) fn named_rectangle(&self, de: i64) -> Option<[f64; 4]> {
        let e = self.cards.entities.get(&de).filter(|e| e.kind == 128)?;
        let n = |k: usize| e.params.number(k).filter(|x| *x >= 0.0).map(|x| x as usize);
        let (k1, k2, m1, m2) = (n(0)?, n(1)?, n(2)?, n(3)?);
        let poles = k1.checked_add(1)?.checked_mul(k2.checked_add(1)?)?;
        let at = poles.checked_mul(4)?.checked_add(9 + 4)?.checked_add(k1)?.checked_add(m1)?;
        let at = at.checked_add(k2)?.checked_add(m2)?;
        let value = |k: usize| e.params.number(at.checked_add(k)?);
        Some([value(0)?, value(1)?, value(2)?, value(3)?])
    }

    fn moved(&self, de: i64, surface: NurbsSurface, motion: &Motion) -> Result<FaceSurface, Unread> {
        if *motion == Motion::identity() {
            return Ok(FaceSurface::Nurbs(Arc::new(surface)));
        }
        let net = surface.net();
        let points = net.points.iter().map(|p| motion.point(p)).collect();
        let net = Net { count: net.count, points, weights: net.weights.clone() };
        let knots = [Axis::U, Axis::V].map(|axis| surface.knots(axis).as_slice().to_vec());
        NurbsSurface::new(surface.degree(), knots, net)
            .map(|n| FaceSurface::Nurbs(Arc::new(n)))
            .map_err(|e| self.malformed(de, e.to_string()))
    }

    /// Whether a surface has no ends by itself.
    pub(crate) fn unlimited(&self, de: i64) -> Option<Unread> {
        let mut at = de;
        for _ in 0..MAX_CHAIN {
            let e = self.cards.entities.get(&at)?;
            match e.kind {
                108 | 190 | 192 | 194 => return Some(Unread::Unlimited { de, kind: e.kind, form: e.form }),
                140 => at = e.params.number(4)? as i64,
                _ => return None,
            }
        }
        None
    }
}

/// The factor of length of a motion.
pub(crate) fn scale_of(motion: &Motion) -> f64 {
    motion.linear.determinant().abs().cbrt()
}

fn shape_times(shape: Shape, factor: f64) -> Shape {
    match shape {
        Shape::Plane => Shape::Plane,
        Shape::Cylinder { radius_mm } => Shape::Cylinder { radius_mm: radius_mm * factor },
        Shape::Cone { radius_mm, half_angle_rad } => {
            Shape::Cone { radius_mm: radius_mm * factor, half_angle_rad }
        }
        Shape::Sphere { radius_mm } => Shape::Sphere { radius_mm: radius_mm * factor },
        Shape::Torus { major_radius_mm, minor_radius_mm } => Shape::Torus {
            major_radius_mm: major_radius_mm * factor,
            minor_radius_mm: minor_radius_mm * factor,
        },
        Shape::Lemon { major_radius_mm, minor_radius_mm } => Shape::Lemon {
            major_radius_mm: major_radius_mm * factor,
            minor_radius_mm: minor_radius_mm * factor,
        },
    }
}

/// Chords that a curve's length is measured with; the error of their sum is its square against one.
const CHORDS: usize = 512;

/// Farthest that the second curve's point at the fraction of length of a point of the first is from the one at its
/// parameter, mm; both curves over `[0, 1]`.
fn unequal_lengths(a: &impl Curve, b: &impl Curve) -> f64 {
    let at = |k: usize| k as f64 / CHORDS as f64;
    let fractions = |c: &dyn Curve| -> Vec<f64> {
        let mut sum = 0.0;
        let mut out = vec![0.0];
        for k in 0..CHORDS {
            sum += (c.point(at(k + 1)) - c.point(at(k))).norm();
            out.push(sum);
        }
        out.iter().map(|s| if sum > 0.0 { s / sum } else { 0.0 }).collect()
    };
    let (of_a, of_b) = (fractions(a), fractions(b));
    let mut worst = 0.0_f64;
    for (k, fraction) in of_a.iter().enumerate() {
        // Where the second curve has the same fraction.
        let j = of_b.partition_point(|f| f < fraction).clamp(1, CHORDS);
        let width = of_b[j] - of_b[j - 1];
        let f = if width > 0.0 { ((fraction - of_b[j - 1]) / width).clamp(0.0, 1.0) } else { 0.0 };
        let t = (j as f64 - 1.0 + f) / CHORDS as f64;
        worst = worst.max((b.point(t) - b.point(at(k))).norm());
    }
    // The interpolation between chords is right to about its square.
    let noise: f64 = (1..=CHORDS).map(|k| (b.point(at(k)) - b.point(at(k - 1))).norm()).fold(0.0, f64::max)
        / CHORDS as f64;
    if worst > noise { worst } else { 0.0 }
}
