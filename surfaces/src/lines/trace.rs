//! Following a course over a face from a point, both ways.
//!
//! The parameters are integrated by arc length with Dormand & Prince's step ([`OdeStep`]); the length of a step is
//! chosen so that its estimated error, measured on the surface, and the turn of the direction within it stay small.
//! The sense of a signless direction follows the direction at the start of the step. A line ends at the border, at a
//! trim, at a stop (an umbilic, an extremum), where it closes, and where its course has no direction; parameters that
//! close are followed across the seam.

use super::chart::Chart;
use super::course::{Course, Family, NoCourse};
use super::{ChartError, LineTolerance};
use osculate_geom::ode::{OdeStep, step_factor};
use osculate_geom::{Point3, Surface, Unit3, Uv, Vec3, uv};

/// A point of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePoint {
    /// Parameters, inside the rectangle.
    pub at: Uv,
    /// The point of the surface, mm.
    pub point: Point3,
}

/// Why a line ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineEnd {
    /// It closes; the first point is not repeated.
    Closed,
    /// The border of the parameter rectangle.
    Border,
    /// A trim of the face.
    Trim,
    /// The stop of this number: an umbilic, an extremum.
    Stop(usize),
    /// The course has no direction beyond: an umbilic that was not among the stops, a horizontal tangent plane, a
    /// parabolic line for an asymptotic line.
    Isotropic,
    /// No tangent plane beyond.
    Degenerate,
    /// A place where the sense of a signless field cannot be settled: an umbilic, for ridges.
    Singular,
    /// Another line is too near, see [`cover`](super::cover()).
    Crowded,
    /// The line is longer, or has more steps, than was allowed.
    TooLong,
}

/// A line on a surface as straight pieces within the chord tolerance.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SurfacePolyline {
    /// Its points, at least one.
    pub points: Vec<LinePoint>,
    /// What its two ends are.
    pub ends: [LineEnd; 2],
}

impl SurfacePolyline {
    /// Whether the last point is followed by the first.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.ends[0] == LineEnd::Closed
    }

    /// Length of the straight pieces, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        let open: f64 = self.points.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum();
        match (self.is_closed(), self.points.first(), self.points.last()) {
            (true, Some(a), Some(b)) => open + (a.point - b.point).norm(),
            _ => open,
        }
    }
}

/// Where lines stop, and how long they may get.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TraceStops {
    /// Places at which a line that comes near ends: umbilics for lines of curvature, extrema for gradient lines.
    pub places: Vec<LinePoint>,
    /// Longest half of a line, mm; 50 times the face's size where it is `None`.
    pub longest_mm: Option<f64>,
}

/// The line of curvature of a family through a point, both ways. Without stops it goes on past umbilics, unless it
/// meets one.
///
/// ```
/// use osculate_geom::{analytic::Torus, uv};
/// use osculate_surfaces::lines::{Family, LineTolerance, curvature_line};
/// // On a ring the lines of the most convex curvature are the circles of its tube.
/// let ring = Torus::new(50.0, 10.0)?;
/// let line = curvature_line(&ring, uv(0.3, 0.0), Family::Most, &LineTolerance::for_size(120.0))?;
/// assert!(line.is_closed());
/// assert!((line.length_mm() / (std::f64::consts::TAU * 10.0) - 1.0).abs() < 1e-2);
/// assert!(line.points.iter().all(|p| (p.at.u - 0.3).abs() < 1e-9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ChartError`] for tolerances that are not positive and for surfaces without a finite extent.
pub fn curvature_line(
    surface: &dyn Surface,
    at: Uv,
    family: Family,
    tolerance: &LineTolerance,
) -> Result<SurfacePolyline, ChartError> {
    let chart = Chart::new(surface, *tolerance)?;
    Ok(trace(&chart, Course::Curvature(family), at, &TraceStops::default()))
}

/// The line of a course through a point, both ways. A point without direction gives a line of one point.
#[must_use]
pub fn trace(chart: &Chart, course: Course, at: Uv, stops: &TraceStops) -> SurfacePolyline {
    trace_while(chart, course, at, stops, &|_, _| true)
}

/// As [`trace`], as long as `free` says so of the points reached and the lengths behind them.
pub(crate) fn trace_while(
    chart: &Chart,
    course: Course,
    at: Uv,
    stops: &TraceStops,
    free: &dyn Fn(&Point3, f64) -> bool,
) -> SurfacePolyline {
    let at = chart.bring(at);
    let start = LinePoint { at, point: chart.surface().point(at) };
    if !chart.surface().contains(at) {
        return SurfacePolyline { points: vec![start], ends: [LineEnd::Trim; 2] };
    }
    let follower = Follower { chart, course, stops, free };
    let direction = match course.tangent(&chart.surface().jet2(at), None) {
        Ok((_, d)) => d,
        Err(why) => return SurfacePolyline { points: vec![start], ends: [end_of(why); 2] },
    };
    let (forward, end) = follower.run(at, direction);
    if end == LineEnd::Closed {
        let mut points = vec![start];
        points.extend(forward);
        return SurfacePolyline { points, ends: [end; 2] };
    }
    let (mut points, begin) = follower.run(at, -direction);
    points.reverse();
    points.push(start);
    points.extend(forward);
    SurfacePolyline { points, ends: [begin, end] }
}

const fn end_of(why: NoCourse) -> LineEnd {
    match why {
        NoCourse::Degenerate => LineEnd::Degenerate,
        NoCourse::Isotropic | NoCourse::Elliptic => LineEnd::Isotropic,
    }
}

/// Largest turn of the direction in a step, rad: a signless direction that turns less keeps its sense.
const MOST_TURN: f64 = 0.2;
/// A step shorter than this part of the face's size does not go on.
const SHORTEST: f64 = 1e-12;
/// A line that comes nearer to a stop than this part of a cell ends there.
const STOP: f64 = 1e-4;
/// A line that comes back to its start nearer than this many position tolerances, per step taken, is closed: the
/// errors of the steps add up.
const CLOSING: f64 = 100.0;
/// Most steps of one half of a line: smooth ones have some hundred, what winds about noise has all that it may.
const MOST_STEPS: usize = 20_000;

struct Follower<'a> {
    chart: &'a Chart<'a>,
    course: Course,
    stops: &'a TraceStops,
    free: &'a dyn Fn(&Point3, f64) -> bool,
}

impl Follower<'_> {
    /// The parameter rate per mm in the sense nearest to `before`.
    fn rate(&self, y: &[f64; 2], before: &Vec3) -> Result<[f64; 2], NoCourse> {
        let jet = self.chart.surface().jet2(uv(y[0], y[1]));
        let (forms, d) = self.course.tangent(&jet, Some(before))?;
        let r = forms.rate(&jet, &d);
        if r.u.is_finite() && r.v.is_finite() { Ok([r.u, r.v]) } else { Err(NoCourse::Degenerate) }
    }

    /// The points beyond the start, and the end.
    fn run(&self, start: Uv, direction: Unit3) -> (Vec<LinePoint>, LineEnd) {
        let (chart, surface) = (self.chart, self.chart.surface());
        let tolerance = chart.tolerance();
        let origin = surface.point(start);
        let first = direction.into_inner();
        let longest = self.stops.longest_mm.unwrap_or(50.0 * chart.size_mm());
        let shortest = SHORTEST * chart.size_mm();
        let reach = STOP * tolerance.cell_mm;
        let mut points = Vec::new();
        let (mut y, mut d) = ([start.u, start.v], first);
        let Ok(mut slope) = self.rate(&y, &d) else { return (points, LineEnd::Degenerate) };
        let (mut h, mut length) = (0.1 * tolerance.cell_mm, 0.0);
        let mut left_start = false;
        for steps in 1..=MOST_STEPS {
            // Near a stop steps shrink with the distance, so that none jumps over it.
            let here = surface.point(uv(y[0], y[1]));
            let near =
                self.stops.places.iter().map(|s| (s.point - here).norm()).fold(f64::INFINITY, f64::min);
            h = h.min(tolerance.cell_mm).min((0.5 * near).max(reach)).min(longest - length + shortest);
            let step = match OdeStep::take(y, slope, h, |y| self.rate(y, &d)) {
                Ok(step) => step,
                Err(why) => {
                    if h <= shortest {
                        return (points, end_of(why));
                    }
                    h *= 0.25;
                    continue;
                }
            };
            let jet = surface.jet2(uv(step.end[0], step.end[1]));
            let error = jet.tangent(uv(step.error[0], step.error[1])).norm();
            let after = jet.tangent(uv(step.end_slope[0], step.end_slope[1]));
            let turn = d.cross(&after).norm().atan2(d.dot(&after));
            if !(error <= tolerance.position_mm && turn <= MOST_TURN) {
                if h <= shortest {
                    return (points, LineEnd::Isotropic);
                }
                // The turn is at most pi: a quarter of it at a time.
                let factor = step_factor(error, tolerance.position_mm);
                h *= if turn > MOST_TURN { factor.min(0.5) } else { factor.min(0.9) };
                continue;
            }
            // Events within the step, the earliest first.
            let pieces = ((turn * h / (8.0 * tolerance.chord_mm)).sqrt().ceil() as usize).clamp(1, 64);
            let mut from = 0.0;
            for k in 1..=pieces {
                let t = k as f64 / pieces as f64;
                let p = self.place(&step, t);
                if !self.is_on(&step, t) {
                    let rim = self.last_on(&step, from, t);
                    points.push(self.place(&step, rim));
                    return (points, self.beyond(&step, t));
                }
                if left_start && let Some(closing) = self.closing(&step, from, t, origin, &first) {
                    let gap = (self.place(&step, closing).point - origin).norm();
                    if gap <= CLOSING * tolerance.position_mm * (steps as f64).sqrt() {
                        return (points, LineEnd::Closed);
                    }
                }
                let behind = length + t * h;
                if !(self.free)(&p.point, behind) {
                    return (points, LineEnd::Crowded);
                }
                points.push(p);
                if let Some(k) =
                    self.stops.places.iter().position(|s| (s.point - p.point).norm() <= 2.0 * reach)
                {
                    points.push(self.stops.places[k]);
                    return (points, LineEnd::Stop(k));
                }
                left_start |= behind > 4.0 * reach && (p.point - origin).norm() > 2.0 * reach;
                from = t;
            }
            length += h;
            if length >= longest {
                return (points, LineEnd::TooLong);
            }
            (y, slope) = (step.end, step.end_slope);
            d = after / after.norm();
            h *=
                step_factor(error, tolerance.position_mm).min(if turn > 0.5 * MOST_TURN { 1.0 } else { 5.0 });
        }
        (points, LineEnd::TooLong)
    }

    fn place(&self, step: &OdeStep<2>, t: f64) -> LinePoint {
        let [u, v] = if t == 1.0 { step.end } else { step.at(t) };
        let at = self.chart.bring(uv(u, v));
        LinePoint { at, point: self.chart.surface().point(at) }
    }

    /// Whether the step is still on the face.
    fn is_on(&self, step: &OdeStep<2>, t: f64) -> bool {
        let [u, v] = step.at(t);
        let d = self.chart.whole();
        let within = |i: &osculate_geom::Interval, x: f64| i.periodic || (x >= i.lo && x <= i.hi);
        within(&d.u, u) && within(&d.v, v) && self.chart.surface().contains(uv(u, v))
    }

    /// The last place on the face between one on it and one beyond, by halving.
    fn last_on(&self, step: &OdeStep<2>, mut on: f64, mut off: f64) -> f64 {
        // To a part in 1e15 of the step.
        for _ in 0..50 {
            let middle = 0.5 * (on + off);
            if self.is_on(step, middle) {
                on = middle;
            } else {
                off = middle;
            }
        }
        on
    }

    /// What lies beyond the face at a place off it.
    fn beyond(&self, step: &OdeStep<2>, t: f64) -> LineEnd {
        let [u, v] = step.at(t);
        let d = self.chart.whole();
        let off = |i: &osculate_geom::Interval, x: f64| !i.periodic && (x < i.lo || x > i.hi);
        if off(&d.u, u) || off(&d.v, v) { LineEnd::Border } else { LineEnd::Trim }
    }

    /// Where the step crosses the plane through the start across its direction, in its sense.
    fn closing(&self, step: &OdeStep<2>, from: f64, to: f64, origin: Point3, first: &Vec3) -> Option<f64> {
        let off = |t: f64| (self.place(step, t).point - origin).dot(first);
        let (a, b) = (off(from), off(to));
        if !(a < 0.0 && b >= 0.0) {
            return None;
        }
        let (mut lo, mut hi) = (from, to);
        for _ in 0..50 {
            let middle = 0.5 * (lo + hi);
            if off(middle) < 0.0 {
                lo = middle;
            } else {
                hi = middle;
            }
        }
        Some(hi)
    }
}
