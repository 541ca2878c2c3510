//! The side of a cutter near its reference section: cylinder, cone and barrel in one form.
//!
//! The meridian passes through (R, 0) in (rho, s), rho from the axis and s along it from the reference section, with the
//! angle tau to the axis (the side opens towards the spindle for tau > 0) and the curvature kappa (a barrel bulges for
//! kappa > 0). With `e = rho - R` and
//!
//! ```text
//! L = cos(tau) e - sin(tau) s,   W = sqrt(1 + 2 kappa L + kappa^2 (e^2 + s^2))
//! delta = (2 L + kappa (e^2 + s^2)) / (W + 1)
//! ```
//!
//! delta is the exact signed distance, outside positive: `rho - R` for a cylinder, L for a cone, the distance from a circle
//! of radius 1/kappa less that radius for a barrel. Nothing cancels for small kappa.

use super::axis::{AxisJet, AxisLine};
use nalgebra::Matrix3;
use osculate_geom::{Point3, Vec3};

/// A side without ends.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_tools::flank::{AxisLine, SideTool};
/// // Along z: a cylinder of radius 10, and a cone that is as thick at the height 0 and opens by 45 degrees upwards.
/// let axis = AxisLine { point: Point3::origin(), direction: Vec3::z_axis() };
/// let p = Point3::new(12.0, 0.0, 1.0);
/// assert!((SideTool::cylinder(10.0)?.deviation_mm(&axis, &p) - 2.0).abs() < 1e-12);
/// let cone = SideTool::cone(10.0, 45f64.to_radians())?;
/// assert!((cone.deviation_mm(&axis, &p) - 1.0 / 2f64.sqrt()).abs() < 1e-12);
/// assert!(SideTool::cylinder(-10.0).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideTool {
    radius_mm: f64,
    taper_rad: f64,
    /// Sine and cosine of the taper.
    lean: [f64; 2],
    bulge_per_mm: f64,
}

/// Numbers that make no side.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what} is {got}; it must be {need}")]
#[non_exhaustive]
pub struct SideToolError {
    /// Which number.
    pub what: &'static str,
    /// Its value.
    pub got: f64,
    /// What it may be.
    pub need: &'static str,
}

/// Distance from a side and its derivative by a step of the point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SideNear {
    /// Signed distance, mm: negative inside the tool.
    pub deviation_mm: f64,
    /// Its gradient: the outward unit normal of the tool.
    pub normal: Vec3,
}

impl SideTool {
    /// A cylinder.
    ///
    /// # Errors
    /// [`SideToolError`] unless the radius is positive and finite.
    pub fn cylinder(radius_mm: f64) -> Result<Self, SideToolError> {
        Self::barrel(radius_mm, 0.0, 0.0)
    }

    /// A cone with the radius at its reference section, opening towards the spindle by the half angle.
    ///
    /// # Errors
    /// [`SideToolError`] unless the radius is positive and the angle below a right one.
    pub fn cone(radius_mm: f64, taper_rad: f64) -> Result<Self, SideToolError> {
        Self::barrel(radius_mm, taper_rad, 0.0)
    }

    /// A meridian arc of curvature `bulge_per_mm`, with the radius and the angle to the axis that it has at the reference
    /// section.
    ///
    /// # Errors
    /// [`SideToolError`] unless the radius is positive, the angle below a right one either way and the curvature not
    /// negative.
    pub fn barrel(radius_mm: f64, taper_rad: f64, bulge_per_mm: f64) -> Result<Self, SideToolError> {
        let bad = |what, got, need| Err(SideToolError { what, got, need });
        if !(radius_mm > 0.0 && radius_mm.is_finite()) {
            return bad("radius_mm", radius_mm, "positive and finite");
        }
        if taper_rad.is_nan() || taper_rad.abs() >= std::f64::consts::FRAC_PI_2 {
            return bad("taper_rad", taper_rad, "below a right angle");
        }
        if !(bulge_per_mm >= 0.0 && bulge_per_mm.is_finite()) {
            return bad("bulge_per_mm", bulge_per_mm, "at least 0 and finite");
        }
        let lean = [taper_rad.sin(), taper_rad.cos()];
        Ok(Self { radius_mm, taper_rad, lean, bulge_per_mm })
    }

    /// Radius at the reference section, mm.
    #[must_use]
    pub const fn radius_mm(&self) -> f64 {
        self.radius_mm
    }

    /// Angle between meridian and axis at the reference section, rad.
    #[must_use]
    pub const fn taper_rad(&self) -> f64 {
        self.taper_rad
    }

    /// Curvature of the meridian, 1/mm.
    #[must_use]
    pub const fn bulge_per_mm(&self) -> f64 {
        self.bulge_per_mm
    }

    /// Whether the side is a cylinder's.
    #[must_use]
    pub fn is_cylinder(&self) -> bool {
        self.taper_rad == 0.0 && self.bulge_per_mm == 0.0
    }

    /// The same shape with another radius at the reference section, unchecked: for radii between good ones.
    pub(super) const fn with_radius(self, radius_mm: f64) -> Self {
        Self { radius_mm, ..self }
    }

    /// delta and its derivatives by e and s.
    fn meridian(&self, e: f64, s: f64) -> (f64, f64, f64, f64) {
        let [sin, cos] = self.lean;
        let k = self.bulge_per_mm;
        let line = cos * e - sin * s;
        let square = e * e + s * s;
        let w = (1.0 + k * (2.0 * line + k * square)).max(0.0).sqrt();
        ((2.0 * line + k * square) / (w + 1.0), (cos + k * e) / w, (k * s - sin) / w, w)
    }

    /// The tool's signed distance from a point, and the tool's outward normal there, for an axis whose point lies in the
    /// reference section.
    #[must_use]
    pub fn near(&self, axis: &AxisLine, p: &Point3) -> SideNear {
        let s = axis.along_mm(p);
        let across = axis.across(p);
        let rho = across.norm();
        let (deviation_mm, by_e, by_s, _) = self.meridian(rho - self.radius_mm, s);
        SideNear { deviation_mm, normal: across * (by_e / rho) + axis.direction.into_inner() * by_s }
    }

    /// The signed distance alone, mm.
    #[must_use]
    pub fn deviation_mm(&self, axis: &AxisLine, p: &Point3) -> f64 {
        self.meridian(axis.distance_mm(p) - self.radius_mm, axis.along_mm(p)).0
    }

    /// Rate by u of the signed distance of a point that stays from the moving tool, mm.
    #[must_use]
    pub fn rate_mm(&self, axis: &AxisJet, p: &Point3) -> f64 {
        // e falls as the axis comes nearer; s changes as the section's point moves and the axis turns.
        let line = &axis.line;
        let (across, s) = (line.across(p), line.along_mm(p));
        let rho = across.norm();
        let (_, by_e, by_s, _) = self.meridian(rho - self.radius_mm, s);
        let s_rate = (p - line.point).dot(&axis.direction_rate) - axis.point_rate.dot(&line.direction);
        by_e * axis.distance_rate_mm(p) + by_s * s_rate
    }

    /// Signed distance, gradient and second derivatives in the frame of a contact at the reference section: a across the
    /// generator, b along the part's normal from the contact into the tool, c along the generator. At the contact all
    /// three are zero. Differences of lengths near the radius do not occur.
    pub(super) fn at_contact(&self, [a, b, c]: [f64; 3]) -> (f64, Vec3, Matrix3<f64>) {
        let [sin, cos] = self.lean;
        let q = sin * c - cos * b;
        let r = self.radius_mm + q;
        let rho = a.hypot(r);
        let e = (a * a + q * (q + 2.0 * self.radius_mm)) / (rho + self.radius_mm);
        let s = cos * c + sin * b;
        let (value, by_e, by_s, w) = self.meridian(e, s);
        let (ea, er) = (a / rho, r / rho);
        // The distance from an arc bends across its gradient only.
        let bend = self.bulge_per_mm / w;
        let (ee, es, ss) = (bend * (1.0 - by_e * by_e), -bend * by_e * by_s, bend * (1.0 - by_s * by_s));
        let (haa, har, hrr) = (
            ee * ea * ea + by_e * er * er / rho,
            ee * ea * er - by_e * ea * er / rho,
            ee * er * er + by_e * ea * ea / rho,
        );
        let (has, hrs) = (es * ea, es * er);
        // From (a, r, s) to (a, b, c): r = R - cos b + sin c, s = sin b + cos c.
        let gr = by_e * er;
        let gradient = Vec3::new(by_e * ea, sin * by_s - cos * gr, sin * gr + cos * by_s);
        let hab = sin * has - cos * har;
        let hac = sin * har + cos * has;
        let hbb = cos * cos * hrr - 2.0 * sin * cos * hrs + sin * sin * ss;
        let hbc = sin * cos * (ss - hrr) + (sin * sin - cos * cos) * hrs;
        let hcc = sin * sin * hrr + 2.0 * sin * cos * hrs + cos * cos * ss;
        (value, gradient, Matrix3::new(haa, hab, hac, hab, hbb, hbc, hac, hbc, hcc))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::Unit3;

    fn tools() -> [SideTool; 4] {
        [
            SideTool::cylinder(10.0).unwrap(),
            SideTool::cone(8.0, 0.2).unwrap(),
            SideTool::barrel(8.0, -0.1, 1.0 / 90.0).unwrap(),
            SideTool::barrel(8.0, 0.0, 1e-9).unwrap(),
        ]
    }

    /// The axis that touches the origin with the normal -y at the reference section, the generator along z.
    fn touching(t: &SideTool) -> AxisLine {
        let (sin, cos) = t.taper_rad().sin_cos();
        let e = Vec3::new(0.0, -cos, sin);
        AxisLine {
            point: (-e * t.radius_mm()).into(),
            direction: Unit3::new_unchecked(Vec3::new(0.0, sin, cos)),
        }
    }

    /// Both ways to the distance agree, and a barrel's is that from its circle.
    #[test]
    fn distances_agree_with_geometry() {
        for t in tools() {
            let axis = touching(&t);
            for p in [[0.0, 0.0, 0.0], [1.0, 0.3, 5.0], [-4.0, 2.0, -20.0], [0.5, -3.0, 12.0]] {
                let (value, g, _) = t.at_contact(p);
                let near = t.near(&axis, &Point3::from(Vec3::from(p)));
                assert!((value - near.deviation_mm).abs() < 1e-13, "{t:?} {p:?}");
                assert!((g - near.normal).norm() < 1e-13 && (g.norm() - 1.0).abs() < 1e-13);
                if t.bulge_per_mm() > 1e-3 {
                    let b = 1.0 / t.bulge_per_mm();
                    let p = Point3::from(Vec3::from(p));
                    let (sin, cos) = t.taper_rad().sin_cos();
                    let centre = [t.radius_mm() - b * cos, b * sin];
                    let at = [axis.distance_mm(&p) - centre[0], axis.along_mm(&p) - centre[1]];
                    assert!((at[0].hypot(at[1]) - b - value).abs() < 1e-12);
                }
            }
        }
    }

    /// Gradient and second derivatives against central differences, error 1e-10 by h^2 and 1e-11 by rounding.
    #[test]
    fn derivatives_match_differences() {
        const H: f64 = 1e-5;
        for t in tools() {
            let p = [1.5, 0.4, -7.0];
            let (_, g, hess) = t.at_contact(p);
            for k in 0..3 {
                let [lo, hi] = [-H, H].map(|h| {
                    let mut q = p;
                    q[k] += h;
                    t.at_contact(q)
                });
                assert!(((hi.0 - lo.0) / (2.0 * H) - g[k]).abs() < 1e-9);
                for m in 0..3 {
                    assert!(((hi.1[m] - lo.1[m]) / (2.0 * H) - hess[(k, m)]).abs() < 1e-8, "{t:?} {k} {m}");
                }
            }
        }
    }

    #[test]
    fn bad_numbers_are_refused() {
        assert!(SideTool::cylinder(0.0).is_err() && SideTool::cylinder(f64::NAN).is_err());
        assert!(SideTool::cone(5.0, 1.6).is_err() && SideTool::cone(5.0, f64::NAN).is_err());
        assert!(SideTool::barrel(5.0, 0.0, -0.1).is_err());
    }
}
