//! Plane, cylinder, cone, sphere and torus as carriers of faces: placed, limited to a rectangle, with the exact
//! parameters of a point.
//!
//! Parameters are those of [`osculate_geom::analytic`]: the angle about z first (plane: x), then the meridian's
//! parameter. The natural normal points away from the axis (plane: +z).

use osculate_geom::analytic::{BadSize, Cone, Cylinder, Placed, Placement, Plane, Sphere, Spindle, Torus};
use osculate_geom::{Axis, Domain, Interval, Point3, Surface, Uv, forward_surface, uv};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The kind and size of an analytic surface, in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// z = 0.
    Plane,
    /// About z.
    Cylinder {
        /// Radius, mm.
        radius_mm: f64,
    },
    /// About z, opening towards +z.
    Cone {
        /// Radius at z = 0, mm.
        radius_mm: f64,
        /// Angle between axis and generator, rad.
        half_angle_rad: f64,
    },
    /// About the origin.
    Sphere {
        /// Radius, mm.
        radius_mm: f64,
    },
    /// About z; where the tube is wider than its circle, the outer part of the spindle torus.
    Torus {
        /// From the axis to the centre of the tube, mm.
        major_radius_mm: f64,
        /// Radius of the tube, mm.
        minor_radius_mm: f64,
    },
    /// The inner part of a spindle torus about z, whose tube is wider than its circle.
    Lemon {
        /// From the axis to the centre of the tube, mm.
        major_radius_mm: f64,
        /// Radius of the tube, mm.
        minor_radius_mm: f64,
    },
}

#[derive(Clone, Copy, Debug)]
enum Inner {
    Plane(Placed<Plane>),
    Cylinder(Placed<Cylinder>),
    Cone(Placed<Cone>),
    Sphere(Placed<Sphere>),
    Torus(Placed<Torus>),
}

/// A placed analytic surface on a parameter rectangle.
#[derive(Clone, Copy, Debug)]
pub struct Analytic {
    shape: Shape,
    placement: Placement,
    inner: Inner,
    domain: Domain,
}

impl Analytic {
    /// The surface on its widest rectangle; unlimited directions have an infinite range until
    /// [`Analytic::limited`] narrows it.
    ///
    /// ```
    /// use osculate_geom::analytic::Placement;
    /// use osculate_geom::{Point3, Surface, Vec3, uv};
    /// use osculate_surfaces::{Analytic, Shape};
    /// // A shaft of radius 25 about the x axis, its angle from +z on: the place next to a point, and the surface 5 mm further out.
    /// let placement = Placement::new(Point3::origin(), Vec3::x_axis(), Some(Vec3::z()));
    /// let shaft = Analytic::new(Shape::Cylinder { radius_mm: 25.0 }, placement)?;
    /// let at = shaft.locate(&Point3::new(7.0, 0.0, 30.0), uv(0.0, 0.0));
    /// assert!(at.u.abs() < 1e-12 && (at.v - 7.0).abs() < 1e-12);
    /// assert_eq!(shaft.offset(5.0)?.shape(), Shape::Cylinder { radius_mm: 30.0 });
    /// assert!((shaft.point(at) - Point3::new(7.0, 0.0, 25.0)).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BadSize`] for a size that makes no surface.
    pub fn new(shape: Shape, placement: Placement) -> Result<Self, BadSize> {
        let all = Interval::new(f64::NEG_INFINITY, f64::INFINITY);
        let turn = Interval::periodic(0.0, TAU);
        let (inner, domain) = match shape {
            Shape::Plane => {
                let domain = Domain { u: all, v: all };
                (Inner::Plane(Placed { surface: Plane::new(domain), placement }), domain)
            }
            Shape::Cylinder { radius_mm } => {
                let surface = Cylinder::new(radius_mm, all)?;
                (Inner::Cylinder(Placed { surface, placement }), Domain { u: turn, v: all })
            }
            Shape::Cone { radius_mm, half_angle_rad } => {
                let surface = Cone::new(radius_mm, half_angle_rad, all)?;
                // One nappe: the side of the apex where the radius is positive.
                let apex = -radius_mm / half_angle_rad.sin();
                let v = if half_angle_rad > 0.0 {
                    Interval::new(apex, f64::INFINITY)
                } else if half_angle_rad < 0.0 {
                    Interval::new(f64::NEG_INFINITY, apex)
                } else {
                    all
                };
                (Inner::Cone(Placed { surface, placement }), Domain { u: turn, v })
            }
            Shape::Sphere { radius_mm } => {
                let surface = Sphere::new(radius_mm)?;
                let v = Interval::new(-FRAC_PI_2, FRAC_PI_2);
                (Inner::Sphere(Placed { surface, placement }), Domain { u: turn, v })
            }
            Shape::Torus { major_radius_mm, minor_radius_mm } => {
                let whole = Torus::new(major_radius_mm, minor_radius_mm)?;
                let spindle = minor_radius_mm > major_radius_mm;
                let surface = if spindle { whole.spindle(Spindle::Apple)? } else { whole };
                (Inner::Torus(Placed { surface, placement }), surface.domain())
            }
            Shape::Lemon { major_radius_mm, minor_radius_mm } => {
                let surface = Torus::new(major_radius_mm, minor_radius_mm)?.spindle(Spindle::Lemon)?;
                (Inner::Torus(Placed { surface, placement }), surface.domain())
            }
        };
        Ok(Self { shape, placement, inner, domain })
    }

    /// The same surface on another rectangle.
    #[must_use]
    pub const fn limited(mut self, domain: Domain) -> Self {
        self.domain = domain;
        self
    }

    /// Kind and size.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// Where the surface's own frame is.
    #[must_use]
    pub const fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Parameters of the point of the surface nearest to `p`; where an angle is undefined (on the axis) it is taken
    /// from `hint`.
    #[must_use]
    pub fn locate(&self, p: &Point3, hint: Uv) -> Uv {
        let q = self.placement.local(p);
        let r = q.x.hypot(q.y);
        // On the axis, to the rounding of the coordinates, the angle is noise.
        let size = q.z.abs() + r + self.reach_mm();
        let angle = |y: f64, x: f64, else_: f64| {
            if y.hypot(x) > 1e-12 * size { y.atan2(x) } else { else_ }
        };
        let u = angle(q.y, q.x, hint.u);
        match self.shape {
            Shape::Plane => uv(q.x, q.y),
            Shape::Cylinder { .. } => uv(u, q.z),
            Shape::Cone { radius_mm, half_angle_rad } => {
                let (s, c) = half_angle_rad.sin_cos();
                uv(u, (r - radius_mm) * s + q.z * c)
            }
            Shape::Sphere { .. } => uv(u, angle(q.z, r, hint.v)),
            Shape::Torus { major_radius_mm, minor_radius_mm } => {
                let v = angle(q.z, r - major_radius_mm, hint.v);
                // The apple goes from -apex to apex, through zero.
                let apex = (-major_radius_mm / minor_radius_mm).max(-1.0).acos();
                uv(u, if minor_radius_mm > major_radius_mm { v.clamp(-apex, apex) } else { v })
            }
            // The lemon's radius is negative: it lies on the other side of the axis.
            Shape::Lemon { major_radius_mm, minor_radius_mm } => {
                let apex = (-major_radius_mm / minor_radius_mm).acos();
                let v = angle(q.z, -r - major_radius_mm, hint.v).rem_euclid(TAU);
                uv(angle(-q.y, -q.x, hint.u), v.clamp(apex, TAU - apex))
            }
        }
    }

    /// The surface at a distance along its natural normal, on its widest rectangle: of the same kind.
    ///
    /// # Errors
    /// [`BadSize`] where the distance leaves no surface.
    pub fn offset(&self, distance_mm: f64) -> Result<Self, BadSize> {
        let mut placement = self.placement;
        let shape = match self.shape {
            Shape::Plane => {
                placement.origin += placement.z.into_inner() * distance_mm;
                Shape::Plane
            }
            Shape::Cylinder { radius_mm } => Shape::Cylinder { radius_mm: radius_mm + distance_mm },
            Shape::Cone { radius_mm, half_angle_rad } => {
                // Along the axis too, so that v stays the distance from the same circle of the cone.
                let (s, c) = half_angle_rad.sin_cos();
                placement.origin -= placement.z.into_inner() * (distance_mm * s);
                Shape::Cone { radius_mm: radius_mm + distance_mm * c, half_angle_rad }
            }
            Shape::Sphere { radius_mm } => Shape::Sphere { radius_mm: radius_mm + distance_mm },
            Shape::Torus { major_radius_mm, minor_radius_mm } => {
                Shape::Torus { major_radius_mm, minor_radius_mm: minor_radius_mm + distance_mm }
            }
            Shape::Lemon { major_radius_mm, minor_radius_mm } => {
                Shape::Lemon { major_radius_mm, minor_radius_mm: minor_radius_mm - distance_mm }
            }
        };
        Self::new(shape, placement)
    }

    /// The nappe of a cone on the other side of its apex, as a cone of its own, and the v of the apex here: the
    /// parameters (u, v) of the file's cone are (-u, apex - v) on that one, with the same natural normal.
    #[must_use]
    pub fn other_nappe(&self) -> Option<(Self, f64)> {
        let Shape::Cone { radius_mm, half_angle_rad } = self.shape else { return None };
        let (s, c) = half_angle_rad.sin_cos();
        let apex = -radius_mm / s;
        let p = &self.placement;
        let origin = p.origin + p.z.into_inner() * (apex * c);
        let placement = Placement::new(origin, -p.z, Some(-p.x.into_inner()));
        let made = Self::new(Shape::Cone { radius_mm: 0.0, half_angle_rad }, placement).ok()?;
        apex.is_finite().then_some((made, apex))
    }

    /// The largest radius in the shape, mm.
    fn reach_mm(&self) -> f64 {
        match self.shape {
            Shape::Plane => 0.0,
            Shape::Cylinder { radius_mm } | Shape::Cone { radius_mm, .. } | Shape::Sphere { radius_mm } => {
                radius_mm
            }
            Shape::Torus { major_radius_mm, minor_radius_mm }
            | Shape::Lemon { major_radius_mm, minor_radius_mm } => major_radius_mm + minor_radius_mm,
        }
    }

    /// Whether a parameter is an angle.
    const fn is_angle(&self, axis: Axis) -> bool {
        match (self.shape, axis) {
            (Shape::Plane, _) => false,
            (Shape::Sphere { .. } | Shape::Torus { .. } | Shape::Lemon { .. }, _) | (_, Axis::U) => true,
            (_, Axis::V) => false,
        }
    }
}

impl Inner {
    fn surface(&self) -> &dyn Surface {
        match self {
            Self::Plane(s) => s,
            Self::Cylinder(s) => s,
            Self::Cone(s) => s,
            Self::Sphere(s) => s,
            Self::Torus(s) => s,
        }
    }
}

impl Surface for Analytic {
    forward_surface!(shape | s | s.inner.surface());
    fn domain(&self) -> Domain {
        self.domain
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let i = self.domain.get(axis);
        // An eighth of a turn at most, so that a few quadrature points between breaks are exact to rounding.
        let panels =
            if self.is_angle(axis) { (i.length() / (TAU / 8.0) - 1e-9).ceil().max(1.0) } else { 1.0 };
        (0..=panels as usize)
            .map(|k| if k as f64 == panels { i.hi } else { i.at(k as f64 / panels) })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Jet2, Vec3};

    #[test]
    fn points_give_back_their_parameters() {
        let z = osculate_geom::Unit3::new_normalize(Vec3::new(1.0, -2.0, 0.5));
        let placement = Placement::new(Point3::new(5.0, -3.0, 8.0), z, None);
        for shape in [
            Shape::Plane,
            Shape::Cylinder { radius_mm: 3.0 },
            Shape::Cone { radius_mm: 2.0, half_angle_rad: 0.4 },
            Shape::Cone { radius_mm: 2.0, half_angle_rad: -0.4 },
            Shape::Sphere { radius_mm: 4.0 },
            Shape::Torus { major_radius_mm: 6.0, minor_radius_mm: 1.5 },
            Shape::Torus { major_radius_mm: 6.0, minor_radius_mm: 6.5 },
        ] {
            let s = Analytic::new(shape, placement).unwrap();
            for (u, v) in [(0.3, 0.7), (2.9, -1.2), (-2.0, 0.1)] {
                let got = s.locate(&s.point(uv(u, v)), uv(0.0, 0.0));
                // Coordinates of size 10 carry 2e-15; the parameters are angles or lengths of size one.
                assert!((got.u - u).abs() < 1e-13 && (got.v - v).abs() < 1e-13, "{shape:?}: {got:?}");
            }
        }
    }

    #[test]
    fn a_lemon_gives_back_its_parameters_and_offsets_keep_their_distance() {
        let lemon = Shape::Lemon { major_radius_mm: 1.0, minor_radius_mm: 2.0 };
        let s = Analytic::new(lemon, Placement::identity()).unwrap();
        for (u, v) in [(0.3, 2.2), (2.9, 3.1), (-2.0, 4.0)] {
            let got = s.locate(&s.point(uv(u, v)), uv(0.0, 0.0));
            assert!((got.u - u).abs() < 1e-14 && (got.v - v).abs() < 1e-14, "{got:?}");
        }
        let shapes = [
            Shape::Plane,
            Shape::Cylinder { radius_mm: 3.0 },
            Shape::Cone { radius_mm: 2.0, half_angle_rad: 0.4 },
            Shape::Sphere { radius_mm: 4.0 },
            Shape::Torus { major_radius_mm: 6.0, minor_radius_mm: 1.5 },
            lemon,
        ];
        for shape in shapes {
            let s = Analytic::new(shape, Placement::identity()).unwrap();
            let o = s.offset(0.25).unwrap();
            let at = uv(0.7, if shape == lemon { 2.5 } else { 1.1 });
            let jet = s.jet2(at);
            let n = jet.du.cross(&jet.dv).normalize();
            let foot = jet.point + n * 0.25;
            let there = o.point(o.locate(&foot, at));
            // Coordinates of size ten.
            assert!((there - foot).norm() < 1e-14, "{shape:?}");
        }
    }

    #[test]
    fn the_other_nappe_is_the_same_cone() {
        for half_angle_rad in [0.4, -0.4] {
            let shape = Shape::Cone { radius_mm: 2.0, half_angle_rad };
            let placement = Placement::new(Point3::new(5.0, -3.0, 8.0), Vec3::x_axis(), None);
            let cone = Analytic::new(shape, placement).unwrap();
            let (other, apex) = cone.other_nappe().unwrap();
            for (u, beyond) in [(0.3, 1.0), (2.9, 4.0)] {
                // The formula of the cone holds beyond its apex as well.
                let v = apex - beyond * half_angle_rad.signum();
                let (a, b) = (cone.jet2(uv(u, v)), other.jet2(uv(-u, apex - v)));
                let normal = |j: &Jet2| j.du.cross(&j.dv).normalize();
                assert!((a.point - b.point).norm() < 1e-14 && (normal(&a) - normal(&b)).norm() < 1e-14);
            }
        }
        assert!(Analytic::new(Shape::Plane, Placement::identity()).unwrap().other_nappe().is_none());
    }

    #[test]
    fn the_hint_decides_on_the_axis() {
        let s = Analytic::new(Shape::Sphere { radius_mm: 4.0 }, Placement::identity()).unwrap();
        let got = s.locate(&Point3::new(0.0, 0.0, 4.0), uv(1.25, 0.0));
        assert!((got.u - 1.25).abs() < 1e-15 && (got.v - FRAC_PI_2).abs() < 1e-15);
    }
}
