//! Affine maps that keep shapes: where faces and their edges are placed.

use nalgebra::Matrix3;
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Vec3};

/// An affine map whose linear part is a rotation, a reflection or a uniform scaling of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    /// Linear part.
    pub(crate) linear: Matrix3<f64>,
    /// Shift, mm.
    pub(crate) shift: Vec3,
}

impl Motion {
    /// The map that changes nothing.
    pub(crate) fn identity() -> Self {
        Self { linear: Matrix3::identity(), shift: Vec3::zeros() }
    }
    /// The image of a point.
    pub(crate) fn point(&self, p: &Point3) -> Point3 {
        Point3::from(self.linear * p.coords + self.shift)
    }
    /// The rigid motion that takes one frame to another; `None` where, to the digits of a file, nothing moves.
    pub(crate) fn between(from: &Placement, to: &Placement) -> Option<Self> {
        let columns =
            |f: &Placement| Matrix3::from_columns(&[f.x.into_inner(), f.y.into_inner(), f.z.into_inner()]);
        let linear = columns(to) * columns(from).transpose();
        let shift = to.origin.coords - linear * from.origin.coords;
        let size = from.origin.coords.norm() + to.origin.coords.norm();
        let moves = (linear - Matrix3::identity()).amax() > 1e-12 || shift.amax() > 1e-12 * size;
        moves.then_some(Self { linear, shift })
    }
    /// The map back; `None` where there is none.
    pub(crate) fn inverse(&self) -> Option<Self> {
        let linear = self.linear.try_inverse()?;
        Some(Self { linear, shift: -(linear * self.shift) })
    }
    /// The factor of all lengths, negative where left and right are exchanged; `None` for a map that distorts.
    pub(crate) fn scale(&self) -> Option<f64> {
        let gram = self.linear.transpose() * self.linear;
        let square = gram.trace() / 3.0;
        // Directions of files have six digits or more; the frames are made of unit vectors, though.
        let even = (gram - Matrix3::identity() * square).amax() <= 1e-9 * square;
        even.then(|| square.sqrt() * self.linear.determinant().signum())
    }
    /// The image of a vector.
    pub(crate) fn vector(&self, v: &Vec3) -> Vec3 {
        self.linear * v
    }
    /// First `self`, then `outer`.
    pub(crate) fn then(&self, outer: &Self) -> Self {
        Self { linear: outer.linear * self.linear, shift: outer.linear * self.shift + outer.shift }
    }
}
