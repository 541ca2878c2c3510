//! The Darboux frame along a line on a surface and how it turns.
//!
//! Frame at a point: `t` along the line, `n` the outward normal, `b = n x t` (left of the line seen from outside).
//! Per unit arc length the frame turns with the angular velocity (Darboux vector)
//! `omega = -w_tb t + k_n b + k_g n`: k_n is the normal curvature along t (convex positive: over a convex body the normal
//! leans forward), w_tb the component of the curvature matrix W between t and b, k_g the geodesic curvature.

use crate::forms::{Degenerate, Forms};
use crate::jet::Jet2;
use crate::point::{Point3, Unit3, Uv, Vec3};

/// Position, frame and angular velocity of the frame per unit arc length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Darboux {
    /// The point, mm.
    pub point: Point3,
    /// Unit tangent of the line.
    pub tangent: Unit3,
    /// `normal x tangent`.
    pub left: Unit3,
    /// Outward normal of the surface.
    pub normal: Unit3,
    /// Angular velocity of the frame per mm of line, rad/mm, in world coordinates.
    pub turn: Vec3,
}

impl Darboux {
    /// The frame of a line through the jet's point in `direction` (made tangent), with geodesic curvature
    /// `geodesic_per_mm` (positive: the line bends to the left, towards `b`).
    ///
    /// ```
    /// use osculate_geom::{Darboux, Surface, Vec3, analytic::Sphere, uv};
    /// // East along the equator of a ball of radius 50, at its place on the x axis: north is to the left, and the
    /// // frame turns about it by 1/50 for every mm.
    /// let jet = Sphere::new(50.0)?.jet2(uv(0.0, 0.0));
    /// let frame = Darboux::new(&jet, &Vec3::y(), 0.0)?;
    /// assert!((frame.normal.x - 1.0).abs() < 1e-15 && (frame.left.z - 1.0).abs() < 1e-15);
    /// assert!((frame.turn - Vec3::z() / 50.0).norm() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Degenerate`] without a tangent plane.
    pub fn new(jet: &Jet2, direction: &Vec3, geodesic_per_mm: f64) -> Result<Self, Degenerate> {
        let forms = jet.forms()?;
        Ok(Self::with_forms(jet, &forms, direction, geodesic_per_mm))
    }

    /// As [`Darboux::new`] with the forms at hand.
    #[must_use]
    pub fn with_forms(jet: &Jet2, forms: &Forms, direction: &Vec3, geodesic_per_mm: f64) -> Self {
        let normal = forms.normal;
        let tangent = crate::forms::project_to_tangent(&normal, direction);
        let left = Unit3::new_unchecked(normal.cross(&tangent));
        // Weingarten with k = -II: dn/ds = k_n t + w_tb b (moving over a convex body the normal leans forward).
        let k_n = forms.normal_curvature(&tangent);
        let w_tb = forms.geodesic_torsion(&tangent);
        // dn/ds = omega x n with omega = x t + y b + z n: t x n = -b, b x n = t, so y = k_n and x = -w_tb.
        // dt/ds = omega x t: z b - y n, the geodesic curvature is z.
        let turn =
            tangent.into_inner() * -w_tb + left.into_inner() * k_n + normal.into_inner() * geodesic_per_mm;
        Self { point: jet.point, tangent, left, normal, turn }
    }
}

/// Geodesic curvature, 1/mm, of the curve with parameter rate `rate` and parameter acceleration `acceleration`,
/// positive when it bends to the left (`b = n x t`).
///
/// ```
/// use osculate_geom::{Surface, analytic::Sphere, geodesic_curvature, uv};
/// // A parallel of a sphere, walked to the east: it bends towards the pole, by the tangent of its latitude over the radius.
/// let (radius_mm, latitude) = (50.0, 0.3_f64);
/// let jet = Sphere::new(radius_mm)?.jet2(uv(1.0, latitude));
/// let k = geodesic_curvature(&jet, uv(1.0, 0.0), uv(0.0, 0.0))?;
/// assert!((k - latitude.tan() / radius_mm).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Degenerate`] without a tangent plane.
pub fn geodesic_curvature(jet: &Jet2, rate: Uv, acceleration: Uv) -> Result<f64, Degenerate> {
    let n = jet.normal()?;
    let d1 = jet.tangent(rate);
    let d2 = jet.second(rate) + jet.tangent(acceleration);
    let speed = d1.norm();
    Ok(n.cross(&d1).dot(&d2) / (speed * speed * speed))
}

/// What a surface makes of a line on it, at a point.
///
/// The line's own curvature and torsion in space follow: `k^2 = normal^2 + geodesic^2`, and its torsion is
/// `d theta / ds - torsion`, theta the angle that its principal normal turns about the tangent against the surface's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LineCurvature {
    /// Normal curvature along the line, 1/mm, convex positive.
    pub normal_per_mm: f64,
    /// Geodesic curvature, 1/mm, positive where the line bends to the left.
    pub geodesic_per_mm: f64,
    /// Geodesic torsion, 1/mm: the component of W between the tangent and `n x t`; zero on a line of curvature.
    pub torsion_per_mm: f64,
}

/// Normal curvature, geodesic curvature and geodesic torsion of the line with parameter rate `rate` and parameter
/// acceleration `acceleration`.
///
/// ```
/// use osculate_geom::{Interval, Surface, analytic::Cylinder, line_curvature, uv};
/// // A helix at 45 degrees on a shaft of radius 25: half the curvature of the circle, straight on the surface, and
/// // half as much torsion.
/// let jet = Cylinder::new(25.0, Interval::new(0.0, 80.0))?.jet2(uv(0.0, 40.0));
/// let k = line_curvature(&jet, uv(1.0, 25.0), uv(0.0, 0.0))?;
/// assert!((k.normal_per_mm - 0.5 / 25.0).abs() < 1e-15 && k.geodesic_per_mm.abs() < 1e-15);
/// assert!((k.torsion_per_mm.abs() - 0.5 / 25.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Degenerate`] without a tangent plane.
pub fn line_curvature(jet: &Jet2, rate: Uv, acceleration: Uv) -> Result<LineCurvature, Degenerate> {
    let forms = jet.forms()?;
    let tangent = jet.tangent(rate);
    Ok(LineCurvature {
        normal_per_mm: forms.normal_curvature(&tangent),
        geodesic_per_mm: geodesic_curvature(jet, rate, acceleration)?,
        torsion_per_mm: forms.geodesic_torsion(&tangent),
    })
}
