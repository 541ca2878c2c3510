//! Exact NURBS forms of the kinds that have one: lines and conics, plane, cylinder, cone, sphere, torus, ellipsoid,
//! paraboloid, and what is extruded or revolved from curves that have one.
//!
//! The points are the same to rounding; along circles and hyperbolas the parameter is not, for no rational function runs
//! around a circle at constant speed. Where a kind is polynomial in its parameters (plane, paraboloid, extrusions along
//! v) these are kept. Offsets have no exact form in general and none is made up here.
//!
//! Source: [Piegl & Tiller, The NURBS Book, chapters 7 and 8].

use crate::nurbs::{CurveError, EditError, Net, NurbsCurve3, NurbsError, NurbsSurface};
use crate::trim::spline::Spline;
use crate::trim::sweep::{SweepError, extrude, revolve};
use osculate_geom::analytic::{
    Cone, Conic, ConicKind, Cylinder, Ellipsoid, Line, Paraboloid, Placed, Placement, Plane, Sphere, Torus,
};
use osculate_geom::{
    Axis, Curve, Domain, Extruded, Flipped, Interval, Patch, Point3, Revolved, Side, Surface, Uv, Vec3,
};

/// Why a curve or surface is not written as NURBS.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConvertError {
    /// The part asked for is empty, has no ends, or does not lie on the curve or surface.
    #[error("the part from {from} to {to} is not within [{lo}, {hi}], or has no two ends")]
    Part {
        /// Where the part begins.
        from: f64,
        /// Where it ends.
        to: f64,
        /// Where the curve or surface begins.
        lo: f64,
        /// Where it ends.
        hi: f64,
    },
    /// A spline cannot be cut there.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The numbers make no NURBS curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// The numbers make no NURBS surface.
    #[error(transparent)]
    Surface(#[from] NurbsError),
}

impl From<SweepError> for ConvertError {
    fn from(e: SweepError) -> Self {
        match e {
            SweepError::Arc(e) => Self::Curve(e),
            SweepError::Surface(e) => Self::Surface(e),
        }
    }
}

/// `part` where it lies on `whole`: anywhere, up to one period, where that closes.
fn checked(part: Interval, whole: Interval) -> Result<Interval, ConvertError> {
    // Rounding of ends that are computed.
    let slack = 1e-12 * part.length().abs();
    let ends = part.lo.is_finite() && part.hi.is_finite() && part.length() > 0.0;
    let within = if whole.periodic {
        part.length() <= whole.length() + slack
    } else {
        part.lo >= whole.lo - slack && part.hi <= whole.hi + slack
    };
    if ends && within {
        Ok(part)
    } else {
        Err(ConvertError::Part { from: part.lo, to: part.hi, lo: whole.lo, hi: whole.hi })
    }
}

/// A curve with an exact NURBS form.
///
/// ```
/// use osculate_geom::analytic::{Conic, Placement};
/// use osculate_geom::Interval;
/// use osculate_surfaces::CurveToNurbs;
/// // A circle is rational of degree two, and stays a circle.
/// let circle = Conic::circle(10.0, Placement::identity())?;
/// let arc = circle.to_nurbs(Interval::new(0.0, 1.5))?;
/// assert!(arc.is_rational() && arc.degree() == 2);
/// assert!((arc.point(0.7).coords.norm() - 10.0).abs() < 1e-12);
/// // Beyond what there is no arc.
/// assert!(circle.to_nurbs(Interval::new(0.0, 9.0)).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait CurveToNurbs: Curve {
    /// The part of the curve over a parameter interval, in the curve's sense. The parameter of an arc counts its pieces from 0, a
    /// quarter turn each at most: it is not the angle.
    ///
    /// # Errors
    /// [`ConvertError`].
    fn to_nurbs(&self, part: Interval) -> Result<NurbsCurve3, ConvertError>;
}

/// A surface with an exact NURBS form.
///
/// ```
/// use osculate_geom::{Domain, Interval, Surface, analytic::Torus};
/// use osculate_surfaces::ToNurbs;
/// // Exact: the Gaussian curvature on the outer equator of a ring is that of its radii. The equator is half way along v.
/// let ring = Torus::new(50.0, 10.0)?;
/// let part = ring.to_nurbs(Domain { u: Interval::new(0.0, 1.0), v: Interval::new(-1.0, 1.0) })?;
/// let k = part.jet2(part.domain().at(0.0, 0.5)).forms()?.gauss();
/// assert!((k - 1.0 / (10.0 * 60.0)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait ToNurbs: Surface {
    /// The part of the surface over a parameter rectangle, with u and v in the surface's sense and the material on the
    /// same side. Along arcs the parameter is as in [`CurveToNurbs::to_nurbs`], not the angle.
    ///
    /// # Errors
    /// [`ConvertError`].
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError>;
}

impl CurveToNurbs for Line {
    fn to_nurbs(&self, part: Interval) -> Result<NurbsCurve3, ConvertError> {
        let p = checked(part, self.domain())?;
        let poles = vec![self.point(p.lo), self.point(p.hi)];
        Ok(NurbsCurve3::new(1, vec![p.lo, p.lo, p.hi, p.hi], poles, None)?)
    }
}

impl CurveToNurbs for Conic {
    fn to_nurbs(&self, part: Interval) -> Result<NurbsCurve3, ConvertError> {
        let p = checked(part, self.domain())?;
        let frame = self.frame();
        let on = |x: f64, y: f64| frame.point(&Point3::new(x, y, 0.0));
        let knots = [vec![p.lo; 3], vec![p.hi; 3]].concat();
        let (m, half) = (0.5 * (p.lo + p.hi), 0.5 * p.length());
        match self.kind() {
            ConicKind::Ellipse { semi_axes_mm: [a, b] } => {
                let (x, y) = (frame.x.into_inner() * a, frame.y.into_inner() * b);
                Ok(Spline::arc(frame.origin, x, y, [p.lo, p.hi])?.curve().clone())
            }
            // The blossom of t^2 at (lo, hi) is their product.
            ConicKind::Parabola { focal_mm: f } => {
                let middle = on(f * p.lo * p.hi, 2.0 * f * m);
                Ok(NurbsCurve3::new(2, knots, vec![self.point(p.lo), middle, self.point(p.hi)], None)?)
            }
            // As for an arc, with hyperbolic functions: the tangents at the ends meet beside the middle.
            ConicKind::Hyperbola { semi_axes_mm: [a, b] } => {
                let w = half.cosh();
                let middle = on(a * m.cosh() / w, b * m.sinh() / w);
                let poles = vec![self.point(p.lo), middle, self.point(p.hi)];
                Ok(NurbsCurve3::new(2, knots, poles, Some(vec![1.0, w, 1.0]))?)
            }
        }
    }
}

impl CurveToNurbs for NurbsCurve3 {
    fn to_nurbs(&self, part: Interval) -> Result<NurbsCurve3, ConvertError> {
        let whole = Self::domain(self);
        if part == whole { Ok(self.clone()) } else { Ok(self.restricted(part)?) }
    }
}

/// The surface with the material where `of` has it.
fn sided(made: NurbsSurface, of: &dyn Surface, part: Domain) -> NurbsSurface {
    made.with_side(of.jet2(part.at(0.5, 0.5)).side)
}

/// The meridian `curve` in the xz plane turned about z.
fn turned(of: &dyn Surface, meridian: &NurbsCurve3, part: Domain) -> Result<NurbsSurface, ConvertError> {
    let u = checked(part.u, of.domain().u)?;
    checked(part.v, of.domain().v)?;
    let made = revolve(&Spline::from_curve(meridian.clone()), &Placement::identity(), [u.lo, u.hi])?;
    Ok(sided(made, of, part))
}

/// The meridian at angle zero as a straight line or an arc about a centre in the xz plane.
fn straight(of: &dyn Surface, v: Interval) -> Result<NurbsCurve3, ConvertError> {
    let v = checked(v, of.domain().v)?;
    let poles = [v.lo, v.hi].map(|v| of.point(Uv { u: 0.0, v })).to_vec();
    Ok(NurbsCurve3::new(1, vec![v.lo, v.lo, v.hi, v.hi], poles, None)?)
}

fn arc(centre_mm: f64, radius_mm: f64, v: Interval, whole: Interval) -> Result<NurbsCurve3, ConvertError> {
    let v = checked(v, whole)?;
    let (x, z) = (Vec3::x() * radius_mm, Vec3::z() * radius_mm);
    Ok(Spline::arc(Point3::new(centre_mm, 0.0, 0.0), x, z, [v.lo, v.hi])?.curve().clone())
}

impl ToNurbs for Plane {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        let (u, v) = (checked(part.u, self.domain().u)?, checked(part.v, self.domain().v)?);
        let points =
            [u.lo, u.hi].into_iter().flat_map(|x| [v.lo, v.hi].map(|y| Point3::new(x, y, 0.0))).collect();
        let knots = [u, v].map(|i| vec![i.lo, i.lo, i.hi, i.hi]);
        Ok(NurbsSurface::new([1, 1], knots, Net { count: [2, 2], points, weights: None })?)
    }
}

impl ToNurbs for Cylinder {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        turned(self, &straight(self, part.v)?, part)
    }
}

impl ToNurbs for Cone {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        turned(self, &straight(self, part.v)?, part)
    }
}

impl ToNurbs for Sphere {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        turned(self, &arc(0.0, self.radius_mm(), part.v, self.domain().v)?, part)
    }
}

impl ToNurbs for Torus {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        let meridian = arc(self.major_radius_mm(), self.minor_radius_mm(), part.v, self.domain().v)?;
        turned(self, &meridian, part)
    }
}

impl ToNurbs for Ellipsoid {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        let unit = turned(self, &arc(0.0, 1.0, part.v, self.domain().v)?, part)?;
        let axes = Vec3::from(self.semi_axes_mm());
        mapped(&unit, |p| Point3::from(p.coords.component_mul(&axes)))
    }
}

impl ToNurbs for Paraboloid {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        let (u, v) = (checked(part.u, self.domain().u)?, checked(part.v, self.domain().v)?);
        let [a, b] = self.coefficients_per_mm();
        // Blossoms of t and t^2 over an interval.
        let blossoms = |i: Interval| {
            let mid = 0.5 * (i.lo + i.hi);
            [(i.lo, i.lo * i.lo), (mid, i.lo * i.hi), (i.hi, i.hi * i.hi)]
        };
        let points = blossoms(u)
            .into_iter()
            .flat_map(|(x, xx)| blossoms(v).map(|(y, yy)| Point3::new(x, y, a * xx + b * yy)))
            .collect();
        let knots = [u, v].map(|i| [vec![i.lo; 3], vec![i.hi; 3]].concat());
        Ok(NurbsSurface::new([2, 2], knots, Net { count: [3, 3], points, weights: None })?)
    }
}

impl<C: CurveToNurbs> ToNurbs for Revolved<C> {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        let u = checked(part.u, self.domain().u)?;
        let meridian = Spline::from_curve(self.curve().to_nurbs(part.v)?);
        let axis = Placement::new(self.axis().origin, self.axis().direction, None);
        Ok(sided(revolve(&meridian, &axis, [u.lo, u.hi])?, self, part))
    }
}

impl<C: CurveToNurbs> ToNurbs for Extruded<C> {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        let v = checked(part.v, self.domain().v)?;
        let directrix = Spline::from_curve(self.curve().to_nurbs(part.u)?);
        Ok(sided(extrude(&directrix, self.direction(), [v.lo, v.hi])?, self, part))
    }
}

/// The surface with its poles mapped by an affine map.
fn mapped(s: &NurbsSurface, map: impl Fn(&Point3) -> Point3) -> Result<NurbsSurface, ConvertError> {
    let net = s.net();
    let points = net.points.iter().map(map).collect();
    let net = Net { count: net.count, points, weights: net.weights.clone() };
    let knots = [Axis::U, Axis::V].map(|axis| s.knots(axis).as_slice().to_vec());
    Ok(NurbsSurface::new(s.degree(), knots, net)?.with_side(s.side()))
}

impl<S: ToNurbs> ToNurbs for Placed<S> {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        mapped(&self.surface.to_nurbs(part)?, |p| self.placement.point(p))
    }
}

impl<S: ToNurbs> ToNurbs for Flipped<S> {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        let made = self.0.to_nurbs(part)?;
        let side = made.side().flipped();
        Ok(made.with_side(side))
    }
}

impl<S: ToNurbs> ToNurbs for Patch<S> {
    fn to_nurbs(&self, part: Domain) -> Result<NurbsSurface, ConvertError> {
        checked(part.u, self.domain.u)?;
        checked(part.v, self.domain.v)?;
        let made = self.surface.to_nurbs(part)?;
        let side = if self.side == Side::Against { made.side().flipped() } else { made.side() };
        Ok(made.with_side(side))
    }
}
