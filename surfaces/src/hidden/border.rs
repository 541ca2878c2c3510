//! The border of a face as closed polylines of its parameters: where a step leaves the face, and how near the border is.
//!
//! Of the face that is cut the rectangle is flat: a seam is border on either side, so that what is left is made of plain loops. Of
//! the face that cuts a seam is none.

use super::sheet::{Sheet, Tangents};
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Axis, Domain, Surface, Uv, uv};

/// Places on a segment this far beyond its ends still count, as parts of it.
const END: f64 = 1e-9;
/// Sides of the rectangle are met to this part of it.
const SIDE: f64 = 1e-9;

/// A segment of a border: loop and number of its first point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Segment {
    pub(super) chain: usize,
    pub(super) first: usize,
}

/// Where a step meets the border.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Part of the step.
    pub(super) way: f64,
    pub(super) segment: Segment,
    /// Both ends of the segment, shifted by whole periods to where the step is.
    pub(super) ends: [Uv; 2],
}

/// The border of a face.
pub(super) struct Border<'a> {
    surface: &'a TrimmedSurface,
    domain: Domain,
    /// Whether seams are border.
    flat: bool,
    pub(super) loops: Vec<Vec<Uv>>,
}

impl<'a> Border<'a> {
    pub(super) fn new(surface: &'a TrimmedSurface, flat: bool) -> Self {
        let loops = surface.loops().iter().map(|l| l.points.clone()).collect();
        Self { surface, domain: surface.domain(), flat, loops }
    }

    /// The ends of a segment.
    pub(super) fn ends(&self, s: Segment) -> [Uv; 2] {
        let l = &self.loops[s.chain];
        [l[s.first], l[(s.first + 1) % l.len()]]
    }

    /// All segments; without seams where those are none.
    fn segments(&self) -> impl Iterator<Item = (Segment, [Uv; 2])> + '_ {
        let of = move |(chain, l): (usize, &'_ Vec<Uv>)| {
            (0..l.len()).map(move |first| {
                let s = Segment { chain, first };
                (s, self.ends(s))
            })
        };
        let all = self.loops.iter().enumerate().flat_map(of);
        all.filter(|(_, e)| self.flat || !self.is_seam(e))
    }

    fn is_seam(&self, [a, b]: &[Uv; 2]) -> bool {
        [Axis::U, Axis::V].iter().any(|axis| {
            let i = self.domain.get(*axis);
            let on = |side: f64| {
                (a.get(*axis) - side).abs() <= SIDE * i.length()
                    && (b.get(*axis) - side).abs() <= SIDE * i.length()
            };
            i.periodic && (on(i.lo) || on(i.hi))
        })
    }

    /// Whether a place is in the face, seen flat where the border is.
    pub(super) fn holds(&self, at: Uv) -> bool {
        let within = |axis: Axis| {
            let (i, t) = (self.domain.get(axis), at.get(axis));
            (i.periodic && !self.flat) || (t >= i.lo && t <= i.hi)
        };
        within(Axis::U) && within(Axis::V) && self.surface.contains(at)
    }

    /// Shifts by whole periods that bring copies of the border to a place.
    fn shifts(&self, at: Uv) -> Vec<Uv> {
        let of = |axis: Axis| -> Vec<f64> {
            let i = self.domain.get(axis);
            if self.flat || !i.periodic {
                return vec![0.0];
            }
            let home = ((at.get(axis) - i.lo) / i.length()).floor();
            [-1.0, 0.0, 1.0].map(|k| (home + k) * i.length()).to_vec()
        };
        let (us, vs) = (of(Axis::U), of(Axis::V));
        us.iter().flat_map(|u| vs.iter().map(move |v| uv(*u, *v))).collect()
    }

    /// The first crossing of a step with the border.
    pub(super) fn crossing(&self, from: Uv, to: Uv) -> Option<Crossing> {
        let d = uv(to.u - from.u, to.v - from.v);
        let mut best: Option<Crossing> = None;
        for shift in self.shifts(from) {
            for (segment, ends) in self.segments() {
                let [a, b] = ends.map(|e| uv(e.u + shift.u, e.v + shift.v));
                let e = uv(b.u - a.u, b.v - a.v);
                let det = d.u * e.v - d.v * e.u;
                let r = uv(a.u - from.u, a.v - from.v);
                let way = (r.u * e.v - r.v * e.u) / det;
                let along = (r.u * d.v - r.v * d.u) / det;
                let meets = (0.0..=1.0).contains(&way) && (-END..=1.0 + END).contains(&along);
                if meets && best.is_none_or(|c| way < c.way) {
                    best = Some(Crossing { way, segment, ends: [a, b] });
                }
            }
        }
        best
    }

    /// The place of the border nearest to a place of the face by the surface's metric there, and its distance, mm.
    pub(super) fn nearest(&self, at: Uv) -> Option<(Segment, f64, f64)> {
        let metric = Metric::new(&Sheet::new(self.surface).at(self.domain.bring(at)));
        let mut best: Option<(Segment, f64, f64)> = None;
        for shift in self.shifts(at) {
            for (segment, ends) in self.segments() {
                let ends = ends.map(|e| uv(e.u + shift.u, e.v + shift.v));
                let (way, distance_mm) = metric.to_segment(at, ends);
                if best.is_none_or(|b| distance_mm < b.2) {
                    best = Some((segment, way, distance_mm));
                }
            }
        }
        best
    }
}

/// The first fundamental form at a place: lengths of small steps of the parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Metric([f64; 3]);

impl Metric {
    pub(super) fn new(t: &Tangents) -> Self {
        Self([t.du.norm_squared(), t.du.dot(&t.dv), t.dv.norm_squared()])
    }

    fn product(self, a: Uv, b: Uv) -> f64 {
        let Self([e, f, g]) = self;
        e * a.u * b.u + f * (a.u * b.v + a.v * b.u) + g * a.v * b.v
    }

    /// The part of the way along a segment where it is nearest to a place, and its distance there, mm.
    pub(super) fn to_segment(self, at: Uv, ends: [Uv; 2]) -> (f64, f64) {
        let [a, b] = ends.map(|e| uv(e.u - at.u, e.v - at.v));
        let e = uv(b.u - a.u, b.v - a.v);
        let square = self.product(e, e);
        let way = if square > 0.0 { (-self.product(a, e) / square).clamp(0.0, 1.0) } else { 0.0 };
        (way, self.length_mm(uv(a.u + way * e.u, a.v + way * e.v)))
    }

    /// Length of a small step, mm.
    pub(super) fn length_mm(self, d: Uv) -> f64 {
        self.product(d, d).max(0.0).sqrt()
    }
}
