//! The static deviation along a rule: how far a tool that stands stays from the surface beside the rule.
//!
//! ```text
//! delta(v) = min over u of delta(S(u, v)),   u over the strip
//! ```
//!
//! The minimum is looked for among stations of the strip and closed in on, so that parts of the strip away from the rule
//! count where the tool meets them. Above zero material is left at v, below zero it is gouged.

use super::axis::AxisLine;
use super::directrix::CurveJet2;
use super::ruled::RuledStrip;
use super::tool::SideTool;
use osculate_geom::roots::{FLAT, minimum};
use osculate_geom::{Axis, Point3, Surface};

/// Points of both directrices at rising parameters, from which searches over u start.
#[derive(Clone, Debug)]
pub struct Stations {
    u: Vec<f64>,
    points: [Vec<Point3>; 2],
}

/// A least deviation over u.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Least {
    /// Where, along the directrices.
    pub u: f64,
    /// Where, along the rule.
    pub v: f64,
    /// delta, mm.
    pub deviation_mm: f64,
}

impl Stations {
    /// Stations at the breaks of the strip and `between` of them evenly between two breaks.
    #[must_use]
    pub fn new(strip: &RuledStrip<'_>, between: usize) -> Self {
        Self::beyond(strip, between, 0.0)
    }

    /// The same with the strip going on beyond both ends by the given share of its range of u, as its directrices do.
    #[must_use]
    pub fn beyond(strip: &RuledStrip<'_>, between: usize, share: f64) -> Self {
        let mut u = Vec::new();
        let mut breaks = strip.breaks(Axis::U);
        let more = share.max(0.0) * strip.u_domain().length();
        if more > 0.0 && !strip.u_domain().periodic {
            let (lo, hi) = (strip.u_domain().lo - more, strip.u_domain().hi + more);
            breaks.insert(0, lo);
            breaks.push(hi);
        }
        for w in breaks.windows(2) {
            let n = between + 1;
            u.extend((0..n).map(|k| w[0] + (w[1] - w[0]) * k as f64 / n as f64));
        }
        u.extend(breaks.last());
        let points = [0, 1].map(|end: usize| u.iter().map(|u| strip.place(end, *u)).collect());
        // Where a directrix has no continuation nothing is found.
        Self { u, points }
    }

    fn point(&self, k: usize, v: f64) -> Point3 {
        let (a, b) = (&self.points[0][k], &self.points[1][k]);
        a + (b - a) * v
    }

    /// Parameters of the stations.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.u
    }
}

/// The jet of the line of constant v.
fn across(strip: &RuledStrip<'_>, u: f64, v: f64) -> CurveJet2 {
    let [a, b] = [0, 1].map(|end: usize| strip.directrix(end, u));
    CurveJet2 {
        point: a.point + (b.point - a.point) * v,
        first: a.first + (b.first - a.first) * v,
        second: a.second + (b.second - a.second) * v,
    }
}

/// Newton steps in a bracket before bisection has done as much.
const MAX_STEPS: u32 = 60;

/// The least deviation at v.
#[must_use]
pub fn least_at(
    strip: &RuledStrip<'_>,
    stations: &Stations,
    tool: &SideTool,
    axis: &AxisLine,
    v: f64,
) -> Least {
    let value = |k: usize| tool.deviation_mm(axis, &stations.point(k, v));
    let last = stations.u.len() - 1;
    let mut best = (0, f64::INFINITY);
    for k in 0..=last {
        let d = value(k);
        if d < best.1 {
            best = (k, d);
        }
    }
    let (lo, hi) = (stations.u[best.0.saturating_sub(1)], stations.u[(best.0 + 1).min(last)]);
    let found = settle(strip, tool, axis, v, [lo, stations.u[best.0], hi]);
    if found.deviation_mm <= best.1 {
        found
    } else {
        Least { u: stations.u[best.0], v, deviation_mm: best.1 }
    }
}

/// The zero of the slope of delta along the line of constant v by Newton's method in a bracket, or the bracket's end.
fn settle(
    strip: &RuledStrip<'_>,
    tool: &SideTool,
    axis: &AxisLine,
    v: f64,
    [mut lo, start, mut hi]: [f64; 3],
) -> Least {
    let whole = hi - lo;
    let mut u = start;
    let mut best = Least { u: start, v, deviation_mm: f64::INFINITY };
    for _ in 0..MAX_STEPS {
        let j = across(strip, u, v);
        let near = tool.near(axis, &j.point);
        if near.deviation_mm < best.deviation_mm {
            best = Least { u, v, deviation_mm: near.deviation_mm };
        }
        let slope = near.normal.dot(&j.first);
        // Falling outwards at an end of the strip: the end itself is lowest.
        if (u == lo && slope >= 0.0) || (u == hi && slope <= 0.0) {
            return best;
        }
        if slope > 0.0 {
            hi = u;
        } else {
            lo = u;
        }
        // Second derivative with the tool as a cylinder, whose bend across is 1/rho; exact enough for a step in a bracket.
        let rho = (near.deviation_mm + tool.radius_mm()).abs().max(f64::MIN_POSITIVE);
        let d = axis.direction.into_inner();
        let flat = j.first - d * d.dot(&j.first) - near.normal * slope;
        let bend = flat.norm_squared() / rho + near.normal.dot(&j.second);
        let newton = u - slope / bend;
        let next = if bend > 0.0 && newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
        let step = (next - u).abs();
        u = next;
        // A step of 1e-8 of a station leaves 1e-16 of the value.
        if step <= 1e-8 * whole {
            break;
        }
    }
    let d = tool.deviation_mm(axis, &across(strip, u, v).point);
    if d < best.deviation_mm { Least { u, v, deviation_mm: d } } else { best }
}

/// The least deviation on directrix 0 or 1.
pub(super) fn end_deviation(
    strip: &RuledStrip<'_>,
    stations: &Stations,
    tool: &SideTool,
    axis: &AxisLine,
    end: usize,
) -> Least {
    least_at(strip, stations, tool, axis, end as f64)
}

/// The static deviation along a whole rule.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Profile {
    /// delta at evenly spread v, ends included.
    pub samples: Vec<Least>,
    /// The lowest delta: the deepest gouge where negative.
    pub lowest: Least,
    /// The highest delta.
    pub highest: Least,
}

impl Profile {
    /// Greatest |delta|, mm.
    #[must_use]
    pub fn max_abs_mm(&self) -> f64 {
        self.lowest.deviation_mm.abs().max(self.highest.deviation_mm.abs())
    }
}

/// The profile over `count` samples of v, its extremes closed in on between them.
#[must_use]
pub fn profile(
    strip: &RuledStrip<'_>,
    stations: &Stations,
    tool: &SideTool,
    axis: &AxisLine,
    count: usize,
) -> Profile {
    let cells = count.max(3) - 1;
    let v = |k: usize| k as f64 / cells as f64;
    let at = |v: f64| least_at(strip, stations, tool, axis, v);
    let samples: Vec<Least> = (0..=cells).map(|k| at(v(k))).collect();
    let extreme = |sign: f64| {
        let value = |k: usize| sign * samples[k].deviation_mm;
        let k = (0..=cells).min_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap_or(0);
        let around = [v(k.saturating_sub(1)), v((k + 1).min(cells))];
        let found = at(minimum(around, FLAT, |v| sign * at(v).deviation_mm).x);
        if sign * found.deviation_mm < value(k) { found } else { samples[k] }
    };
    let (lowest, highest) = (extreme(1.0), extreme(-1.0));
    Profile { samples, lowest, highest }
}
