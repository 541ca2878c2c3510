//! The frame of a tool with a fixed axis: x along the feed, y across it, z up the axis.

use osculate_geom::{Point3, Unit3, Vec3, any_perpendicular};

/// A right-handed orthonormal frame at the part's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    x: Vec3,
    y: Vec3,
    pub axis: Unit3,
}

impl Frame {
    /// The feed direction is brought into the plane across the axis; any direction there where it is along the axis.
    pub(super) fn new(axis: Unit3, feed: &Vec3) -> Self {
        let a = axis.into_inner();
        // A feed within a thousandth of the axis has no direction across it.
        let x = Unit3::try_new(feed - a * feed.dot(&a), 1e-3 * feed.norm())
            .unwrap_or_else(|| any_perpendicular(&axis))
            .into_inner();
        Self { x, y: a.cross(&x), axis }
    }

    /// Coordinates of a vector.
    pub(super) fn along(&self, d: &Vec3) -> [f64; 3] {
        [d.dot(&self.x), d.dot(&self.y), d.dot(&self.axis)]
    }

    /// Coordinates of a point.
    pub(super) fn of(&self, p: &Point3) -> [f64; 3] {
        self.along(&p.coords)
    }

    /// The point with these coordinates.
    pub(super) fn point(&self, [x, y, z]: [f64; 3]) -> Point3 {
        Point3::from(self.x * x + self.y * y + self.axis.into_inner() * z)
    }
}
