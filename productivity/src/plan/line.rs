//! Lines that passes run along.

use crate::rectangle::Rectangle;
use osculate_geom::line::{IsoLine, SurfaceLine};
use osculate_geom::{Interval, Uv};

/// A line of contact points that knows its parameters on the face.
pub(super) trait PassLine: SurfaceLine {
    /// Surface parameters at line parameter `t`.
    fn uv(&self, t: f64) -> Uv;
    /// Their rate by `t`.
    fn rate(&self, t: f64) -> Uv;
    /// Whether it is fed against its growing parameter: isoparametric lines that of the face, level lines with the field's uphill side
    /// to the left.
    fn reversed(&self) -> bool;
    /// Where `t` runs; periodic where the line closes.
    fn range(&self) -> Interval;
    /// Whether the line goes on at its other end: round a face that meets itself there, smoothly or in a crease.
    fn goes_round(&self, _: &Rectangle) -> bool {
        self.range().periodic
    }
}

impl PassLine for IsoLine<'_> {
    fn uv(&self, t: f64) -> Uv {
        IsoLine::uv(self, t)
    }
    fn rate(&self, _: f64) -> Uv {
        Uv::from_axis(self.along, 1.0, 0.0)
    }
    fn reversed(&self) -> bool {
        self.reversed
    }
    fn range(&self) -> Interval {
        self.surface.domain().get(self.along)
    }
    fn goes_round(&self, rectangle: &Rectangle) -> bool {
        rectangle.closes(self.along)
    }
}
