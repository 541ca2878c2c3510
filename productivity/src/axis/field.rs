//! Axes over the parameters of a face: the direction of a vector spline.

use super::pace::Pace;
use crate::rectangle::{AXES, Rectangle};
use crate::spline::{Four, Spline};
use osculate_geom::{Surface, Unit3, Uv, Vec3};

/// The tool's axis over a face, in the part's frame.
#[derive(Clone, Debug)]
pub struct AxisField {
    /// Vectors of any length but zero.
    pub(super) spline: Spline<Vec3>,
    pub(super) rectangle: Rectangle,
    /// The parameters of the spline, by those of the face.
    pub(super) paces: [Pace; 2],
}

impl AxisField {
    /// The same axis all over a face.
    #[must_use]
    pub fn held(surface: &dyn Surface, axis: Unit3) -> Self {
        let rectangle = Rectangle::of(surface);
        let paces = AXES.map(|axis| Pace::even(rectangle.domain.get(axis)));
        Self { spline: Spline::constant(&rectangle, [1, 1], axis.into_inner()), rectangle, paces }
    }

    /// The splines at a place of the rectangle, and how fast their parameters grow.
    pub(super) fn bases(&self, at: Uv) -> ([Four; 2], [f64; 2]) {
        let [(u, du), (v, dv)] = [self.paces[0].at(at.u), self.paces[1].at(at.v)];
        ([self.spline.bases[0].at(u), self.spline.bases[1].at(v)], [du, dv])
    }

    /// The axis at a place and its derivatives by u and v; beyond the border of the face its border's.
    #[must_use]
    pub fn at(&self, at: Uv) -> (Unit3, [Vec3; 2]) {
        let (place, within) = self.rectangle.held(at);
        let ([u, v], speeds) = self.bases(place);
        let (raw, slope) = self.spline.first(&u, &v);
        let length = raw.norm();
        let axis = raw / length;
        let rates = [0, 1].map(|k| {
            let rate = || (slope[k] - axis * slope[k].dot(&axis)) * (speeds[k] / length);
            if within[k] { rate() } else { Vec3::zeros() }
        });
        (Unit3::new_unchecked(axis), rates)
    }
}
