//! The inside of a set of boundary chains on a parameter rectangle that may close on itself.
//!
//! Parameters live on a plane, a cylinder or a torus: a direction that closes is taken modulo its period. A chain is
//! a closed polyline there; followed continuously (unwrapped) it may end a whole number of periods from where it
//! began. Crossing a chain changes inside to outside, so that after one reference value (the `base`, at the lower
//! left corner) everything follows by counting crossings modulo two: along the lower edge of the rectangle, then up.
//! The base comes from what is known of the ends of the rectangle, or from the orientation of the chains (material on
//! their left), or from even-odd counting of the unwrapped chains.

use super::bands::{Bands, Segment};
use super::outline::{Sheet, outline};
use osculate_geom::{Axis, Domain, Interval, Uv, uv};

/// A closed boundary, unwrapped: the last point is the first one shifted by whole periods.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chain {
    /// The points, first and last equal modulo the periods.
    pub(crate) points: Vec<Uv>,
}

impl Chain {
    /// Net shift from the first to the last point.
    pub(crate) fn winding(&self) -> Uv {
        match (self.points.first(), self.points.last()) {
            (Some(a), Some(b)) => uv(b.u - a.u, b.v - a.v),
            _ => uv(0.0, 0.0),
        }
    }
}

/// What is known about the inside before any orientation is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Known {
    /// Below the rectangle (or the lower edge is no pole and would have a boundary) everything is outside.
    pub(crate) below_out: bool,
    /// The same above it.
    pub(crate) above_out: bool,
    /// The chains run with the inside on their left.
    pub(crate) oriented: bool,
}

/// The inside of chains on a rectangle.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    /// The rectangle, in swapped coordinates where `swap` is set.
    x: Interval,
    y: Interval,
    /// First and second parameter exchanged, so that a single closing direction is always x.
    swap: bool,
    /// Whether the lower left corner is inside.
    base: bool,
    /// Places on the lower edge where the inside changes, ascending: crossings of the cut of a closing y.
    flips: Vec<f64>,
    segments: Vec<Segment>,
    columns: Bands,
    rows: Bands,
    /// False where the known ends contradicted the chains.
    pub(crate) consistent: bool,
}

impl Region {
    /// The inside of `chains` on `domain`, closing in the directions flagged in `closes`.
    pub(crate) fn new(domain: Domain, closes: [bool; 2], chains: &[Chain], known: Known) -> Self {
        let swap = closes[1] && !closes[0];
        let (x, y) = if swap { (domain.v, domain.u) } else { (domain.u, domain.v) };
        let (close_x, close_y) = if swap { (true, false) } else { (closes[0], closes[1]) };
        let mut cut = Cut { x, y, close_x, close_y, segments: Vec::new(), flips: Vec::new() };
        for chain in chains {
            for w in chain.points.windows(2) {
                let (a, b) = (order(w[0], swap), order(w[1], swap));
                cut.add(a, b);
            }
        }
        let Cut { segments, mut flips, .. } = cut;
        flips.sort_by(f64::total_cmp);
        let columns = Bands::new(&segments);
        let swapped: Vec<Segment> = segments.iter().map(Segment::swapped).collect();
        let rows = Bands::new(&swapped);
        let mut region = Self { x, y, swap, base: false, flips, segments, columns, rows, consistent: true };
        region.base = region.choose_base(chains, known, close_y);
        region
    }

    /// Whether the parameters, which must be inside the rectangle, are inside the chains.
    pub(crate) fn inside(&self, at: Uv) -> bool {
        let [x, y] = order(at, self.swap);
        // A query on the rim is a query just inside it: half-open counting would leave the far rims out.
        let (x, y) = (within(x, self.x), within(y, self.y));
        self.parity(x, y)
    }

    fn parity(&self, x: f64, y: f64) -> bool {
        let flips = self.flips.partition_point(|f| *f <= x);
        self.base ^ ((flips + self.columns.below(x, y)) % 2 == 1)
    }

    /// The inside intervals of the line along `axis` at the value `fixed` of the other parameter.
    pub(crate) fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        let along_y = (axis == Axis::V) != self.swap;
        let (line, across) = if along_y { (self.y, self.x) } else { (self.x, self.y) };
        let fixed = within(fixed, across);
        let cuts = if along_y { self.columns.crossings(fixed) } else { self.rows.crossings(fixed) };
        let mut ends = vec![line.lo];
        let first = within(line.lo, line);
        ends.extend(cuts.into_iter().filter(|t| *t > first && *t < line.hi));
        ends.push(line.hi);
        let state = |t: f64| if along_y { self.parity(fixed, t) } else { self.parity(t, fixed) };
        // Asking in every interval heals a crossing lost to rounding; with very many crossings it would be quadratic.
        let ask = ends.len() <= 64;
        let mut inside = state(within(line.lo, line));
        let mut spans: Vec<Interval> = Vec::new();
        for (k, w) in ends.windows(2).enumerate() {
            if k > 0 {
                inside = !inside;
            }
            if w[1] <= w[0] {
                continue;
            }
            if ask {
                inside = state(0.5 * (w[0] + w[1]));
            }
            if !inside {
                continue;
            }
            match spans.last_mut() {
                Some(last) if last.hi == w[0] => last.hi = w[1],
                _ => spans.push(Interval::new(w[0], w[1])),
            }
        }
        spans
    }

    /// Whether every chain runs along the rim of the rectangle, to `slack` of its sides, and the middle is inside.
    pub(crate) fn is_whole(&self, slack: f64) -> bool {
        let near = |t: f64, i: Interval| (t - i.lo).abs().min((t - i.hi).abs()) <= slack * i.length();
        let on_rim = |s: &Segment| {
            (near(s.a[0], self.x)
                && near(s.b[0], self.x)
                && (s.a[0] - s.b[0]).abs() <= slack * self.x.length())
                || (near(s.a[1], self.y)
                    && near(s.b[1], self.y)
                    && (s.a[1] - s.b[1]).abs() <= slack * self.y.length())
        };
        self.segments.iter().all(on_rim) && self.parity(self.x.at(0.5), self.y.at(0.5))
    }

    /// The boundary segments, as pairs of parameters within the rectangle.
    pub(crate) fn segments(&self) -> impl Iterator<Item = (Uv, Uv)> + '_ {
        self.segments.iter().map(|s| (back(s.a, self.swap), back(s.b, self.swap)))
    }

    /// The region as closed polylines within the rectangle, cut open along its sides where chains wrap.
    pub(crate) fn outline(&self) -> Vec<Vec<Uv>> {
        let inside = |p: [f64; 2]| self.parity(within(p[0], self.x), within(p[1], self.y));
        let sheet = Sheet { x: self.x, y: self.y, segments: &self.segments, inside: &inside };
        let loops = outline(&sheet);
        loops.into_iter().map(|l| l.into_iter().map(|p| back(p, self.swap)).collect()).collect()
    }

    /// Whether the lower left corner is inside.
    fn choose_base(&mut self, chains: &[Chain], known: Known, close_y: bool) -> bool {
        if self.segments.is_empty() {
            return true;
        }
        if !close_y && known.below_out {
            // The total along a column must be even where the top is out as well.
            if known.above_out && self.top(false) {
                self.consistent = false;
            }
            return false;
        }
        if !close_y && known.above_out {
            return self.top(false);
        }
        if known.oriented {
            let (ballot, total) = self.votes();
            if ballot.abs() > 0.1 * total {
                return ballot > 0.0;
            }
        }
        self.unwrapped_base(chains)
    }

    /// Whether the top is inside when the base is `base`: by majority over a few columns.
    fn top(&self, base: bool) -> bool {
        let above = self.y.hi + self.y.length().abs() + 1.0;
        let odd = SAMPLES
            .iter()
            .filter(|f| {
                let x = self.x.at(**f);
                (self.flips.partition_point(|f| *f <= x) + self.columns.below(x, above)) % 2 == 1
            })
            .count();
        base ^ (2 * odd > SAMPLES.len())
    }

    /// Votes of the segments for an inside corner, by length in x: a segment that runs towards +x has the inside
    /// above it. Returns votes for minus votes against, and the total.
    fn votes(&self) -> (f64, f64) {
        // A few hundred segments decide as well as all of them.
        let stride = self.segments.len().div_ceil(400);
        let (mut ballot, mut total) = (0.0, 0.0);
        for s in self.segments.iter().step_by(stride) {
            let run = s.b[0] - s.a[0];
            if run == 0.0 {
                continue;
            }
            let (x, y) = (0.5 * (s.a[0] + s.b[0]), 0.5 * (s.a[1] + s.b[1]));
            // Parity just below the segment when the corner is outside. The segment itself passes through the
            // point, so the count is taken a hair under it.
            let hair = 1e-9 * self.y.length();
            let flips = self.flips.partition_point(|f| *f <= x);
            let odd_below = (flips + self.columns.below(x, y - hair)) % 2 == 1;
            // Inside above means outside below: the corner's state is then the opposite of the count's parity.
            // Exchanged coordinates exchange left and right.
            let inside_above = (run > 0.0) != self.swap;
            let corner_inside = if inside_above { odd_below } else { !odd_below };
            ballot += if corner_inside { run.abs() } else { -run.abs() };
            total += run.abs();
        }
        (ballot, total)
    }

    /// The base that agrees with even-odd counting of the unwrapped chains, for chains without orientation.
    fn unwrapped_base(&self, chains: &[Chain]) -> bool {
        let plain: Vec<Segment> = chains
            .iter()
            .flat_map(|c| c.points.windows(2))
            .map(|w| Segment { a: order(w[0], self.swap), b: order(w[1], self.swap) })
            .collect();
        let bands = Bands::new(&plain);
        let mut agree = 0_i32;
        for f in SAMPLES {
            for g in SAMPLES {
                let (x, y) = (self.x.at(f), self.y.at(g));
                let mut inside = false;
                for i in -2..=2 {
                    for j in -2..=2 {
                        let (dx, dy) = (f64::from(i) * self.x.length(), f64::from(j) * self.y.length());
                        inside |= bands.below(x + dx, y + dy) % 2 == 1;
                    }
                }
                let flips = self.flips.partition_point(|f| *f <= x);
                let odd = (flips + self.columns.below(x, y)) % 2 == 1;
                agree += if odd == inside { 1 } else { -1 };
            }
        }
        agree < 0
    }
}

/// Fractions of a side at which majority decisions sample; irrational, so that they meet no vertex of a grid.
const SAMPLES: [f64; 5] = [0.5 * 0.236_067_977, 0.302_775_637, 0.472_135_955, 0.645_751_311, 0.886_000_936];

/// `t` moved off the ends of the interval by the rounding of a parameter.
fn within(t: f64, i: Interval) -> f64 {
    let hair = 1e-12 * i.length();
    t.clamp(i.lo + hair, i.hi - hair)
}

const fn order(p: Uv, swap: bool) -> [f64; 2] {
    if swap { [p.v, p.u] } else { [p.u, p.v] }
}

const fn back(p: [f64; 2], swap: bool) -> Uv {
    if swap { uv(p[1], p[0]) } else { uv(p[0], p[1]) }
}

/// Collects segments, cut at the sides of the rectangle.
struct Cut {
    x: Interval,
    y: Interval,
    close_x: bool,
    close_y: bool,
    segments: Vec<Segment>,
    flips: Vec<f64>,
}

impl Cut {
    /// Adds one unwrapped segment.
    fn add(&mut self, a: [f64; 2], b: [f64; 2]) {
        if a == b {
            return;
        }
        // Fractions of the segment at which it enters another period.
        let mut cuts = vec![0.0];
        for (closes, interval, k) in [(self.close_x, self.x, 0), (self.close_y, self.y, 1)] {
            if closes {
                let (ka, kb) = (period(a[k], interval), period(b[k], interval));
                let (lo, hi) = (ka.min(kb), ka.max(kb));
                // Chains wind a few times at most; a wild one is not followed for ever.
                for m in 1..=(hi - lo).min(64.0) as usize {
                    let line = interval.lo + (lo + m as f64) * interval.length();
                    cuts.push(((line - a[k]) / (b[k] - a[k])).clamp(0.0, 1.0));
                }
            }
        }
        cuts.push(1.0);
        cuts.sort_by(f64::total_cmp);
        let point = |f: f64| {
            if f == 0.0 {
                a
            } else if f == 1.0 {
                b
            } else {
                [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])]
            }
        };
        for w in cuts.windows(2) {
            let (p, q) = (point(w[0]), point(w[1]));
            if p == q {
                continue;
            }
            let middle = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
            let sx = self.shift(middle[0], a[0], b[0], self.x, self.close_x);
            let sy = self.shift(middle[1], a[1], b[1], self.y, self.close_y);
            let place = |r: [f64; 2]| {
                [(r[0] - sx).clamp(self.x.lo, self.x.hi), (r[1] - sy).clamp(self.y.lo, self.y.hi)]
            };
            self.segments.push(Segment { a: place(p), b: place(q) });
        }
        if self.close_y {
            let (ka, kb) = (period(a[1], self.y), period(b[1], self.y));
            let (lo, hi) = (ka.min(kb), ka.max(kb));
            for m in 1..=(hi - lo).min(64.0) as usize {
                let line = self.y.lo + (lo + m as f64) * self.y.length();
                let f = ((line - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0);
                let x = a[0] + f * (b[0] - a[0]);
                let k = if self.close_x { period(x, self.x) } else { 0.0 };
                self.flips.push(x - k * self.x.length());
            }
        }
    }

    /// Shift by whole periods that brings the piece around `middle` into the interval. A piece along the cut itself
    /// takes the period of its value, as [`period`] counts it.
    fn shift(&self, middle: f64, a: f64, b: f64, interval: Interval, closes: bool) -> f64 {
        if !closes {
            return 0.0;
        }
        let k = if a == b { period(a, interval) } else { period(middle, interval) };
        k * interval.length()
    }
}

/// Number of the period that holds `t`; a value at the upper end belongs to the next one.
fn period(t: f64, interval: Interval) -> f64 {
    ((t - interval.lo) / interval.length()).floor()
}
