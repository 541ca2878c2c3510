//! A surface moved to another frame.

use crate::forward_surface;
use crate::jet::{Jet2, Jet3};
use crate::point::{Point3, Unit3, Uv, Vec3, any_perpendicular};
use crate::surface::Surface;
use crate::taylor::Taylor;

/// A right-handed orthonormal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Origin, mm.
    pub origin: Point3,
    /// First axis.
    pub x: Unit3,
    /// Second axis, `z x x`.
    pub y: Unit3,
    /// Third axis.
    pub z: Unit3,
}

impl Placement {
    /// The world frame.
    #[must_use]
    pub fn identity() -> Self {
        Self { origin: Point3::origin(), x: Vec3::x_axis(), y: Vec3::y_axis(), z: Vec3::z_axis() }
    }

    /// The frame with the given `z`, and `x` as near to `x_hint` as being perpendicular allows.
    ///
    /// ```
    /// use osculate_geom::{Point3, Vec3, analytic::Placement};
    /// // A fixture turned about z by 90 degrees: its x is the machine's y.
    /// let fixture = Placement::new(Point3::new(10.0, 0.0, 0.0), Vec3::z_axis(), Some(Vec3::y()));
    /// let p = Point3::new(3.0, 2.0, 1.0);
    /// assert!((fixture.point(&p) - Point3::new(8.0, 3.0, 1.0)).norm() < 1e-15);
    /// assert!((fixture.local(&fixture.point(&p)) - p).norm() < 1e-15);
    /// ```
    #[must_use]
    pub fn new(origin: Point3, z: Unit3, x_hint: Option<Vec3>) -> Self {
        let x = x_hint
            .and_then(|h| Unit3::try_new(h - z.into_inner() * h.dot(&z), 1e-9 * h.norm()))
            .unwrap_or_else(|| any_perpendicular(&z));
        Self { origin, x, y: Unit3::new_unchecked(z.cross(&x)), z }
    }

    /// A local vector in world coordinates.
    #[must_use]
    pub fn vector(&self, a: &Vec3) -> Vec3 {
        self.x.into_inner() * a.x + self.y.into_inner() * a.y + self.z.into_inner() * a.z
    }

    /// A local point in world coordinates.
    #[must_use]
    pub fn point(&self, p: &Point3) -> Point3 {
        self.origin + self.vector(&p.coords)
    }

    /// A local jet in world coordinates.
    fn jet2(&self, j: &Jet2) -> Jet2 {
        Jet2 {
            uv: j.uv,
            point: self.point(&j.point),
            du: self.vector(&j.du),
            dv: self.vector(&j.dv),
            duu: self.vector(&j.duu),
            duv: self.vector(&j.duv),
            dvv: self.vector(&j.dvv),
            side: j.side,
        }
    }

    /// A world point in local coordinates.
    #[must_use]
    pub fn local(&self, p: &Point3) -> Point3 {
        let w = p - self.origin;
        Point3::new(w.dot(&self.x), w.dot(&self.y), w.dot(&self.z))
    }
}

/// A surface in another frame.
#[derive(Clone, Copy, Debug)]
pub struct Placed<S> {
    /// The surface in its own frame.
    pub surface: S,
    /// Where that frame is.
    pub placement: Placement,
}

impl<S: Surface> Surface for Placed<S> {
    forward_surface!(trims | s | s.surface);
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.placement.jet2(&self.surface.jet2(uv))
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        let (j, f) = (self.surface.jet3(uv), &self.placement);
        Jet3 {
            jet2: f.jet2(&j.jet2),
            duuu: f.vector(&j.duuu),
            duuv: f.vector(&j.duuv),
            duvv: f.vector(&j.duvv),
            dvvv: f.vector(&j.dvvv),
        }
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let f = &self.placement;
        self.surface.taylor(uv, order).mapped(|p| f.point(p), |a| f.vector(a))
    }
    fn point(&self, uv: Uv) -> Point3 {
        self.placement.point(&self.surface.point(uv))
    }
}
