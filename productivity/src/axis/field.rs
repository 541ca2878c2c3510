//! Axes over the parameters of a face: the direction of a vector spline.

use crate::rectangle::Rectangle;
use crate::spline::Spline;
use osculate_geom::{Surface, Unit3, Uv, Vec3};

/// The tool's axis over a face, in the part's frame.
#[derive(Clone, Debug)]
pub struct AxisField {
    /// Vectors of any length but zero.
    pub(super) spline: Spline<Vec3>,
    pub(super) rectangle: Rectangle,
}

impl AxisField {
    /// The same axis all over a face.
    #[must_use]
    pub fn held(surface: &dyn Surface, axis: Unit3) -> Self {
        let rectangle = Rectangle::of(surface);
        Self { spline: Spline::constant(&rectangle, [1, 1], axis.into_inner()), rectangle }
    }

    /// The axis at a place and its derivatives by u and v; beyond the border of the face its border's.
    #[must_use]
    pub fn at(&self, at: Uv) -> (Unit3, [Vec3; 2]) {
        let (place, within) = self.rectangle.held(at);
        let [u, v] = [self.spline.bases[0].at(place.u), self.spline.bases[1].at(place.v)];
        let (raw, slope) = self.spline.first(&u, &v);
        let length = raw.norm();
        let axis = raw / length;
        let rates = [0, 1].map(|k| {
            if within[k] { (slope[k] - axis * slope[k].dot(&axis)) / length } else { Vec3::zeros() }
        });
        (Unit3::new_unchecked(axis), rates)
    }
}
