//! A face that goes on a little beyond the border of its parameters, so that passes can run out over it.
//!
//! A strip that meets the border at a slant must go on until its far edge has left the face. Beyond the border the face is
//! continued by its Taylor polynomial of third order there: what it does there decides only where the tool leaves. What lies inside
//! ([`Surface::contains`]) stays what it was. Across a seam at which a field is cut the face itself goes on.

use super::Task;
use super::level::widest_mm;
use super::seat::Seat;
use crate::rectangle::{AXES, meets_itself};
use osculate_geom::{Axis, Domain, Interval, Jet2, Jet3, Surface, Taylor, Uv, Vec3, forward_surface};

/// Strip widths that passes can run out over the border.
const RUN_OUT: f64 = 1.0;

/// A border is not gone over where the face is thinner there than this share of its thickest.
const THIN: f64 = 0.02;
/// Places along a border at which that is looked at.
const LOOKS: u32 = 16;

/// How far the normal may turn over the margin, rad, for a border that is continued by its bend.
const CURL: f64 = 0.35;

/// The continued face.
pub(crate) struct Extended<'a> {
    base: &'a dyn Surface,
    inner: Domain,
    outer: Domain,
    /// Axes whose parameters wrap beyond the border.
    wraps: [bool; 2],
    /// Rough on the scale of the tool: third derivatives belong to ripples there and are left out.
    rough: bool,
    /// For each axis whether the face goes on straight below its lower and above its upper end.
    straight: [[bool; 2]; 2],
}

impl<'a> Extended<'a> {
    /// The face of a task as far as its passes may run out over the border, for a field that does not close across the seam of the
    /// axis `cut`.
    pub fn of(task: &Task<'a>, cut: Option<Axis>) -> Self {
        Self::new(task.surface, RUN_OUT * widest_mm(task), cut, Seat::any(task).rough())
    }

    /// The face as far as passes of strips no wider than `widest_mm` may run out over the border.
    pub(crate) fn by(base: &'a dyn Surface, widest_mm: f64) -> Self {
        Self::new(base, RUN_OUT * widest_mm, None, false)
    }

    /// Continued by `margin_mm`, but not where the face closes, unless a field is cut there, nor at poles.
    fn new(base: &'a dyn Surface, margin_mm: f64, cut: Option<Axis>, rough: bool) -> Self {
        let inner = base.domain();
        let closes = AXES.map(|axis| meets_itself(base, axis));
        let mut wraps = [false; 2];
        let mut outer = inner;
        let mut straight = [[false; 2]; 2];
        for (k, axis) in AXES.into_iter().enumerate() {
            let i = inner.get(axis);
            wraps[k] = closes[k] && cut == Some(axis);
            if closes[k] && !wraps[k] {
                continue;
            }
            straight[k] = [i.lo, i.hi].map(|t| margin_mm * most_bent(base, axis, t) > CURL);
            let margin = |t: f64| margin(base, axis, t, margin_mm).min(0.1 * i.length());
            let wider = Interval::new(i.lo - margin(i.lo), i.hi + margin(i.hi));
            match axis {
                Axis::U => outer.u = wider,
                Axis::V => outer.v = wider,
            }
        }
        Self { base, inner, outer, wraps, rough, straight }
    }

    /// The parameters of the face itself, on its other side of a seam too.
    pub fn own(&self) -> Domain {
        let of = |k: usize, axis: Axis| if self.wraps[k] { self.outer } else { self.inner }.get(axis);
        Domain { u: of(0, Axis::U), v: of(1, Axis::V) }
    }

    /// The parameters of the continued face.
    pub const fn outer(&self) -> Domain {
        self.outer
    }

    /// The place of the face itself that stands for one of the continuation: the nearest of the border.
    pub(crate) fn inner(&self, at: Uv) -> Uv {
        let held = |axis: Axis| {
            let i = self.inner.get(axis);
            let t = at.get(axis);
            if self.wraps[usize::from(axis == Axis::V)] && !(t >= i.lo && t <= i.hi) {
                (t - i.lo).rem_euclid(i.length()) + i.lo
            } else if i.periodic {
                t
            } else {
                t.clamp(i.lo, i.hi)
            }
        };
        Uv { u: held(Axis::U), v: held(Axis::V) }
    }

    /// Offset beyond the border.
    fn beyond(&self, at: Uv, near: Uv) -> [f64; 2] {
        [(at.u - near.u, 0), (at.v - near.v, 1)].map(|(d, k)| if self.wraps[k] { 0.0 } else { d })
    }
}

/// The length of `margin_mm` across a border in the parameter; none where the face is thin along it.
fn margin(base: &dyn Surface, axis: Axis, t: f64, margin_mm: f64) -> f64 {
    let (i, across) = (base.domain().get(axis), base.domain().get(axis.other()));
    let jet = |t: f64, k: u32| base.jet2(Uv::from_axis(axis, t, across.at(f64::from(k) / f64::from(LOOKS))));
    let area = |jet: &Jet2| jet.du.cross(&jet.dv).norm();
    let thickest = (0..=LOOKS).map(|k| area(&jet(i.at(0.5), k))).fold(0.0, f64::max);
    let border: Vec<Jet2> = (0..=LOOKS).map(|k| jet(t, k)).collect();
    if border.iter().map(area).any(|a| a.is_nan() || a <= THIN * thickest) {
        return 0.0;
    }
    let speed = border.iter().map(|j| if axis == Axis::U { j.du.norm() } else { j.dv.norm() });
    margin_mm / speed.fold(f64::INFINITY, f64::min)
}

/// The greatest normal curvature across a border, 1/mm.
fn most_bent(base: &dyn Surface, axis: Axis, t: f64) -> f64 {
    let across = base.domain().get(axis.other());
    let bent = |k: u32| {
        let jet = base.jet2(Uv::from_axis(axis, t, across.at(f64::from(k) / f64::from(LOOKS))));
        let along = if axis == Axis::U { jet.dv } else { jet.du };
        let forms = jet.forms().ok()?;
        Some(forms.normal_curvature(&forms.normal.cross(&along)).abs())
    };
    (0..=LOOKS).filter_map(bent).fold(0.0, f64::max)
}

/// The polynomial of a jet at steps of the parameters from its place.
fn carried(jet: &Jet3, [a, b]: [f64; 2]) -> Jet2 {
    let j = &jet.jet2;
    let duu = j.duu + jet.duuu * a + jet.duuv * b;
    let duv = j.duv + jet.duuv * a + jet.duvv * b;
    let dvv = j.dvv + jet.duvv * a + jet.dvvv * b;
    // Halves and thirds of the steps from the derivatives at the place and at the end.
    let du = j.du + (j.duu + duu) * (0.5 * a) + (j.duv + duv) * (0.5 * b);
    let dv = j.dv + (j.duv + duv) * (0.5 * a) + (j.dvv + dvv) * (0.5 * b);
    let bend = |f: &dyn Fn(&Vec3, &Vec3) -> Vec3| {
        f(&j.duu, &duu) * (a * a) + f(&j.duv, &duv) * (2.0 * a * b) + f(&j.dvv, &dvv) * (b * b)
    };
    let point = j.point + j.du * a + j.dv * b + bend(&|from, to| from / 3.0 + to / 6.0);
    Jet2 { point, du, dv, duu, duv, dvv, ..*j }
}

impl Surface for Extended<'_> {
    forward_surface!(turns | s | s.base);
    fn domain(&self) -> Domain {
        self.outer
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        let near = self.inner(at);
        let [a, b] = self.beyond(at, near);
        if a == 0.0 && b == 0.0 {
            return Jet2 { uv: at, ..self.base.jet2(near) };
        }
        let mut jet = if self.rough {
            let none = Vec3::zeros();
            Jet3 { jet2: self.base.jet2(near), duuu: none, duuv: none, duvv: none, dvvv: none }
        } else {
            self.base.jet3(near)
        };
        let none = Vec3::zeros();
        if self.straight[0][usize::from(a > 0.0)] && a != 0.0 {
            (jet.jet2.duu, jet.duuu, jet.duuv) = (none, none, none);
        }
        if self.straight[1][usize::from(b > 0.0)] && b != 0.0 {
            (jet.jet2.dvv, jet.dvvv, jet.duvv) = (none, none, none);
        }
        Jet2 { uv: at, ..carried(&jet, [a, b]) }
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        self.base.taylor(self.inner(at), order)
    }
    fn contains(&self, at: Uv) -> bool {
        let i = self.inner;
        let within =
            |t: f64, i: Interval, k: usize| (i.periodic && !self.wraps[k]) || (t >= i.lo && t <= i.hi);
        within(at.u, i.u, 0) && within(at.v, i.v, 1) && self.base.contains(at)
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let (i, mut all) = (self.outer.get(axis), self.base.breaks(axis));
        if i.lo < all[0] {
            all.insert(0, i.lo);
        }
        if i.hi > all[all.len() - 1] {
            all.push(i.hi);
        }
        all
    }
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        let across = self.inner.get(axis.other());
        if fixed < across.lo || fixed > across.hi { Vec::new() } else { self.base.spans(axis, fixed) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::Torus;
    use osculate_geom::{Patch, Side, uv};

    /// Beyond the border the continuation stays on the whole torus to the fourth power of the distance.
    #[test]
    fn goes_on_as_the_face_would() {
        let surface = Torus::new(60.0, 20.0).unwrap();
        let domain = Domain { u: Interval::new(0.2, 0.9), v: Interval::new(0.5, 1.4) };
        let piece = Patch { surface, domain, side: Side::Along };
        let more = Extended::new(&piece, 1.5, None, false);
        assert!(more.domain().u.lo < 0.2 && more.domain().v.hi > 1.4);
        for at in [uv(0.19, 0.7), uv(0.5, 1.43), uv(0.19, 1.43), uv(0.5, 0.6)] {
            let (a, b) = (more.jet2(at), surface.jet2(at));
            let far = (0.2 - at.u).max(0.0).hypot((at.v - 1.4).max(0.0));
            assert!((a.point - b.point).norm() <= 80.0 * far.powi(4), "{at:?}");
            assert!(
                (a.duv - b.duv).norm() <= 80.0 * far.powi(2) && (a.duu - b.duu).norm() <= 80.0 * far.powi(2)
            );
            assert_eq!(more.contains(at), piece.contains(at));
        }
        // The whole ring closes: nothing is beyond it, but where it is cut.
        let ring = Torus::new(60.0, 20.0).unwrap();
        assert_eq!(Extended::new(&ring, 1.0, None, false).domain(), ring.domain());
        let cut = Extended::new(&ring, 1.0, Some(Axis::U), false);
        let (at, hi) = (uv(cut.domain().u.hi, 0.3), ring.domain().u.hi);
        assert!(at.u > hi && !cut.contains(at) && cut.contains(uv(0.5 * hi, 0.3)));
        assert!((cut.point(at) - ring.point(at)).norm() < 1e-9);
    }
}
