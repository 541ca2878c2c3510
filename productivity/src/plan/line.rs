//! Lines that passes run along, and the way round a face that closes on itself.

use osculate_geom::line::{IsoLine, SurfaceLine};
use osculate_geom::{Axis, Domain, Interval, Surface, Uv};

/// A line of contact points that knows its parameters on the face.
pub(super) trait PassLine: SurfaceLine {
    /// Surface parameters at line parameter `t`.
    fn uv(&self, t: f64) -> Uv;
    /// Their rate by `t`.
    fn rate(&self, t: f64) -> Uv;
    /// Where `t` runs; periodic where the line closes.
    fn range(&self) -> Interval;
}

impl PassLine for IsoLine<'_> {
    fn uv(&self, t: f64) -> Uv {
        IsoLine::uv(self, t)
    }
    fn rate(&self, _: f64) -> Uv {
        Uv::from_axis(self.along, 1.0, 0.0)
    }
    fn range(&self) -> Interval {
        self.surface.domain().get(self.along)
    }
}

/// The parameter rectangle of a face and where it meets itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rectangle {
    pub domain: Domain,
    /// Whether the face meets itself at the ends of u and of v, smoothly or in a crease.
    pub closes: [bool; 2],
}

impl Rectangle {
    pub(super) fn of(surface: &dyn Surface) -> Self {
        let closes = [Axis::U, Axis::V].map(|axis| meets_itself(surface, axis));
        Self { domain: surface.domain(), closes }
    }

    /// Whether the face meets itself at the ends of `axis`.
    pub(super) const fn closes(&self, axis: Axis) -> bool {
        match axis {
            Axis::U => self.closes[0],
            Axis::V => self.closes[1],
        }
    }

    /// The parameters held within the rectangle where it does not close.
    pub(super) fn clamped(&self, at: Uv) -> Uv {
        let held = |axis: Axis| {
            let i = self.domain.get(axis);
            if self.closes(axis) { at.get(axis) } else { at.get(axis).clamp(i.lo, i.hi) }
        };
        Uv { u: held(Axis::U), v: held(Axis::V) }
    }

    /// The parameters brought round where the face closes; None outside it.
    pub(super) fn bring(&self, at: Uv) -> Option<Uv> {
        let round = |axis: Axis| {
            let i = self.domain.get(axis);
            let t = at.get(axis);
            if t >= i.lo && t <= i.hi {
                Some(t)
            } else if self.closes(axis) {
                Some((t - i.lo).rem_euclid(i.length()) + i.lo)
            } else {
                // Rounding at the ends.
                let slack = 1e-12 * i.length();
                (t >= i.lo - slack && t <= i.hi + slack).then(|| t.clamp(i.lo, i.hi))
            }
        };
        Some(Uv { u: round(Axis::U)?, v: round(Axis::V)? })
    }
}

/// Whether a face is the same line of points at both ends of a parameter, to a millionth of its size.
pub(super) fn meets_itself(surface: &dyn Surface, axis: Axis) -> bool {
    let (i, across) = (surface.domain().get(axis), surface.domain().get(axis.other()));
    let at = |t: f64, f: f64| surface.point(Uv::from_axis(axis, t, across.at(f)));
    let fractions = [0.0, 0.3, 0.5, 0.8, 1.0];
    let gap = fractions.iter().map(|f| (at(i.hi, *f) - at(i.lo, *f)).norm()).fold(0.0, f64::max);
    let size = fractions.iter().map(|f| (at(i.at(0.5), *f) - at(i.lo, *f)).norm()).fold(0.0, f64::max);
    i.periodic || gap <= 1e-6 * size
}
/// Axes in the order of their index.
pub(super) const AXES: [Axis; 2] = [Axis::U, Axis::V];

/// Greatest lengths of the face along u and along v, mm.
pub(super) fn lengths(surface: &dyn Surface, rectangle: &Rectangle) -> [f64; 2] {
    AXES.map(|axis| {
        let [i, across] = [rectangle.domain.get(axis), rectangle.domain.get(axis.other())];
        let at = |f: f64, g: f64| surface.point(Uv::from_axis(axis, i.at(f), across.at(g)));
        (0..=4)
            .map(|k| {
                let g = f64::from(k) / 4.0;
                (0..40).map(|s| (at(f64::from(s + 1) / 40.0, g) - at(f64::from(s) / 40.0, g)).norm()).sum()
            })
            .fold(0.0, f64::max)
    })
}
