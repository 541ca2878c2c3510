//! The parameter rectangle of a face, and the way round a face that closes on itself.

use osculate_geom::{Axis, Domain, Surface, Uv};

/// The parameter rectangle of a face and where it meets itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    pub domain: Domain,
    /// Whether the face meets itself at the ends of u and of v, smoothly or in a crease.
    pub closes: [bool; 2],
}

impl Rectangle {
    pub(crate) fn of(surface: &dyn Surface) -> Self {
        let closes = [Axis::U, Axis::V].map(|axis| meets_itself(surface, axis));
        Self { domain: surface.domain(), closes }
    }

    /// Whether the face meets itself at the ends of `axis`.
    pub(crate) const fn closes(&self, axis: Axis) -> bool {
        match axis {
            Axis::U => self.closes[0],
            Axis::V => self.closes[1],
        }
    }

    /// The parameters held within the rectangle where it does not close.
    pub(crate) fn clamped(&self, at: Uv) -> Uv {
        let held = |axis: Axis| {
            let i = self.domain.get(axis);
            if self.closes(axis) { at.get(axis) } else { at.get(axis).clamp(i.lo, i.hi) }
        };
        Uv { u: held(Axis::U), v: held(Axis::V) }
    }

    /// The parameters brought round where the face closes and held at its border elsewhere, and along which of them they are
    /// within it.
    pub(crate) fn held(&self, at: Uv) -> (Uv, [bool; 2]) {
        let [(u, within_u), (v, within_v)] = AXES.map(|axis| {
            let (i, t) = (self.domain.get(axis), at.get(axis));
            if t >= i.lo && t <= i.hi {
                (t, true)
            } else if self.closes(axis) {
                ((t - i.lo).rem_euclid(i.length()) + i.lo, true)
            } else {
                (t.clamp(i.lo, i.hi), false)
            }
        });
        (Uv { u, v }, [within_u, within_v])
    }

    /// The parameters brought round where the face closes; None outside it.
    pub(crate) fn bring(&self, at: Uv) -> Option<Uv> {
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
pub(crate) fn meets_itself(surface: &dyn Surface, axis: Axis) -> bool {
    let (i, across) = (surface.domain().get(axis), surface.domain().get(axis.other()));
    let at = |t: f64, f: f64| surface.point(Uv::from_axis(axis, t, across.at(f)));
    let fractions = [0.0, 0.3, 0.5, 0.8, 1.0];
    let gap = fractions.iter().map(|f| (at(i.hi, *f) - at(i.lo, *f)).norm()).fold(0.0, f64::max);
    let size = fractions.iter().map(|f| (at(i.at(0.5), *f) - at(i.lo, *f)).norm()).fold(0.0, f64::max);
    i.periodic || gap <= 1e-6 * size
}
/// Axes in the order of their index.
pub(crate) const AXES: [Axis; 2] = [Axis::U, Axis::V];

/// Greatest lengths of the face along u and along v, mm.
pub(crate) fn lengths(surface: &dyn Surface, rectangle: &Rectangle) -> [f64; 2] {
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
