//! The axis of least greatest static deviation at a rule.
//!
//! ```text
//! min over the axis of  max over v of |delta(v)|
//! ```
//!
//! by sequential linear programming: delta and its derivative by the axis at samples of v and at its extremes, a linear
//! program for the step, a trust region on the step. The multipliers of the last program bound the value from below for the
//! linearised problem: how near the optimum is.

use super::axis::{AxisJet, AxisLine};
use super::lp::{Rows, solve};
use super::rule::Rule;
use super::ruled::RuledStrip;
use super::section::{Least, Stations, least_at};
use super::standard::along_rule;
use super::three::three_tangent;
use super::tool::SideTool;
use super::touch::{PlaceError, Touch};
use nalgebra::{DMatrix, DVector, SVector};
use osculate_geom::roots::{FLAT, minimum};
use osculate_geom::{Point3, Unit3, Vec3};

/// Unknowns of a step: the axis moved along x and y, turned about x and y, slid along itself, and the value.
const N: usize = 6;
type Step = SVector<f64, N>;

/// How to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimaxSearch {
    /// Samples of v beside the extremes.
    pub samples: usize,
    /// Rounds at most.
    pub rounds: u32,
    /// A step below this ends the search, mm at the ends of the rule.
    pub step_mm: f64,
    /// What keeps the axis at its rule.
    pub hold: Hold,
}

/// What keeps an axis at its rule: without anything it drifts along the strip to where the rules are less twisted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Hold {
    /// The tool touches the straight line of the rule.
    Tangent,
    /// The axis passes over the contact M2 that three tangencies have with the rule, over the middle of the rule where there
    /// is no such position: its point there moves along y only.
    OverContact,
    /// The axis passes over the point of the rule at this v.
    Over(f64),
    /// Nothing: the best position on the strip that small steps lead to.
    Nothing,
}

impl Default for MinimaxSearch {
    fn default() -> Self {
        Self { samples: 33, rounds: 60, step_mm: 1e-9, hold: Hold::OverContact }
    }
}

/// A minimax axis.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MinimaxAxis {
    /// The axis.
    pub axis: AxisLine,
    /// Its derivative by u, where the places of greatest deviation determine it.
    pub motion: Option<AxisJet>,
    /// Greatest |delta|, mm.
    pub deviation_mm: f64,
    /// The least value of the last linear program less its duality gap, mm: no small change of the axis goes below, but for
    /// the square of that change.
    pub bound_mm: f64,
    /// Places where |delta| is greatest.
    pub active: Vec<Touch>,
    /// Size of the last step, mm.
    pub step_mm: f64,
    /// Rounds.
    pub iterations: u32,
}

struct Search<'s> {
    strip: &'s RuledStrip<'s>,
    stations: &'s Stations,
    rule: Rule,
    tool: SideTool,
    how: MinimaxSearch,
    /// Where on the rule the axis is held or, without that, turned about: v, and its rate by u.
    pivot: (f64, f64),
}

impl Search<'_> {
    /// Why there is no optimum: where no cylinder of this radius fits into the hollow, that.
    fn unsettled(&self, step_mm: f64, iterations: u32) -> PlaceError {
        let (u, radius_mm, largest_mm) = (self.rule.u, self.tool.radius_mm(), self.rule.largest_fit_mm());
        if radius_mm >= largest_mm {
            PlaceError::TooLarge { u, radius_mm, largest_mm }
        } else {
            PlaceError::NotConverged { u, step_mm, iterations }
        }
    }

    fn at(&self, axis: &AxisLine, v: f64) -> Least {
        least_at(self.strip, self.stations, &self.tool, axis, v)
    }

    /// Samples and the extremes between them.
    fn deviations(&self, axis: &AxisLine) -> Vec<Least> {
        let cells = self.how.samples.max(5) - 1;
        let v = |k: usize| k as f64 / cells as f64;
        let level = SETTLED * self.tool.radius_mm();
        let mut all: Vec<Least> = (0..=cells).map(|k| self.at(axis, v(k))).collect();
        for k in 1..cells {
            let [a, b, c] = [k - 1, k, k + 1].map(|k| all[k].deviation_mm);
            // Between samples that are level but for rounding nothing stands out; beside a developable strip all are.
            if (a - b).abs().max((c - b).abs()) <= level {
                continue;
            }
            for sign in [1.0, -1.0] {
                if sign * b <= sign * a && sign * b <= sign * c {
                    let at = minimum([v(k - 1), v(k + 1)], FLAT, |v| sign * self.at(axis, v).deviation_mm);
                    all.push(self.at(axis, at.x));
                }
            }
        }
        all
    }

    /// Derivative of a deviation by the unknowns, lengths in mm at the ends of the rule.
    fn gradient(&self, axis: &AxisLine, place: &Least) -> Step {
        self.gradient_at(axis, &self.strip.point_at(place.u, place.v))
    }

    fn gradient_at(&self, axis: &AxisLine, p: &Point3) -> Step {
        let n = self.tool.near(axis, p).normal;
        let f = &self.rule.frame;
        let arm = p - self.pivot(axis);
        let half = 0.5 * self.rule.length_mm;
        let turn = |about: &Vec3| -n.dot(&about.cross(&arm)) / half;
        let slide = if self.tool.is_cylinder() { 0.0 } else { -n.dot(&axis.direction) };
        let sideways = if self.is_over() { 0.0 } else { -n.dot(&f.x) };
        Step::from([sideways, -n.dot(&f.y), turn(&f.x), turn(&f.y), slide, 0.0])
    }

    fn is_over(&self) -> bool {
        matches!(self.how.hold, Hold::Over(_) | Hold::OverContact)
    }

    /// The point of the axis abreast of that place.
    fn pivot(&self, axis: &AxisLine) -> Point3 {
        let middle = self.rule.point(self.pivot.0);
        let z = self.rule.frame.z;
        axis.at((middle - axis.point).dot(&z) / axis.direction.dot(&z))
    }

    /// The axis moved sideways so that it passes over the place where it is held.
    fn onto_hold(&self, axis: AxisLine) -> AxisLine {
        if !self.is_over() {
            return axis;
        }
        let x = self.rule.frame.x;
        let off = (self.pivot(&axis) - self.rule.point(self.pivot.0)).dot(&x);
        AxisLine { point: axis.point - x * off, ..axis }
    }

    /// The places of greatest deviation, each once.
    fn active(&self, seen: &[Least], worst: f64) -> Vec<Least> {
        let mut active: Vec<Least> =
            seen.iter().filter(|l| l.deviation_mm.abs() >= worst * (1.0 - ACTIVE)).copied().collect();
        active.sort_by(|a, b| a.v.total_cmp(&b.v));
        let near = 0.5 / self.how.samples as f64;
        active.dedup_by(|a, b| (a.v - b.v).abs() < near && a.deviation_mm * b.deviation_mm > 0.0);
        active
    }

    fn touch(&self, l: &Least) -> Touch {
        Touch { u: l.u, v: l.v, point: self.strip.point_at(l.u, l.v) }
    }

    /// How the axis moves with u while the active places stay equal: the deviation there changes with the axis alone, since
    /// the places are stationary. Where more of them are active than the axis has freedoms the motion has a kink, and
    /// what comes is the mean in the sense of least squares. Only for an axis held over its rule.
    fn motion(&self, axis: &AxisLine, active: &[Least]) -> Option<AxisJet> {
        let (v, v_rate) = self.pivot;
        if !self.is_over() || !self.tool.is_cylinder() || active.len() < 4 {
            return None;
        }
        let (f, rate) = (&self.rule.frame, &self.rule.frame_rate);
        let pivot = self.pivot(axis);
        let height = (pivot - self.rule.point(v)).dot(&f.y);
        let along = f.z * (self.rule.length_mm * v_rate);
        let carried = self.rule.du(v) + along + rate.y * height;
        let half = 0.5 * self.rule.length_mm;
        // Unknowns: rate of the height, of the turns about x and y at half a rule's length, and of the value.
        let mut left = DMatrix::<f64>::zeros(active.len(), 4);
        let mut right = DVector::<f64>::zeros(active.len());
        for (k, l) in active.iter().enumerate() {
            let p = self.strip.point_at(l.u, l.v);
            let n = self.tool.near(axis, &p).normal;
            let arm = p - pivot;
            left[(k, 0)] = -n.dot(&f.y);
            left[(k, 1)] = -n.dot(&f.x.cross(&arm)) / half;
            left[(k, 2)] = -n.dot(&f.y.cross(&arm)) / half;
            left[(k, 3)] = -l.deviation_mm.signum();
            right[k] = n.dot(&carried);
        }
        let got = left.svd(true, true).solve(&right, f64::EPSILON).ok()?;
        let spin = (f.x * got[1] + f.y * got[2]) / half;
        let d = axis.direction.into_inner();
        AxisJet::of(self.rule.u, (pivot, carried + f.y * got[0]), (d, spin.cross(&d)))
    }

    fn moved(&self, axis: &AxisLine, step: &Step) -> AxisLine {
        let f = &self.rule.frame;
        let half = 0.5 * self.rule.length_mm;
        let pivot = self.pivot(axis);
        let d = axis.direction.into_inner();
        let spin = (f.x * step[2] + f.y * step[3]) / half;
        let turned = Unit3::new_normalize(d + spin.cross(&d));
        let slide = (axis.point - pivot).dot(&d) + step[4];
        let pivot = pivot + f.x * step[0] + f.y * step[1];
        AxisLine { point: pivot + turned.into_inner() * slide, direction: turned }
    }

    /// How far the tool is from the straight line of the rule, mm, and where: the equation of [`Hold::Tangent`].
    fn off_rule(&self, axis: &AxisLine) -> (f64, Step) {
        // The least deviation on the line is where its slope vanishes; a cylinder's is a parabola's near the foot.
        let distance = |v: f64| self.tool.deviation_mm(axis, &self.rule.point(v));
        let v = minimum([0.0, 1.0], FLAT, distance).x;
        let p = self.rule.point(v);
        (distance(v), self.gradient_at(axis, &p))
    }

    fn step(&self, axis: &AxisLine, seen: &[Least], trust: f64) -> Option<(Step, f64)> {
        let worst = greatest(seen);
        // Under tangency the move along y follows from the others.
        let held = (self.how.hold == Hold::Tangent).then(|| self.off_rule(axis));
        let reduced = |g: Step| match &held {
            None => (g, 0.0),
            Some((off, c)) => {
                let share = g[1] / c[1];
                let mut r = g - c * share;
                r[1] = 0.0;
                (r, -share * off)
            }
        };
        let mut rows = Rows { a: Vec::new(), b: Vec::new() };
        for place in seen {
            let (g, shift) = reduced(self.gradient(axis, place));
            for sign in [1.0, -1.0] {
                let mut row = g * sign;
                row[5] = -1.0;
                rows.a.push(row);
                rows.b.push(-sign * (place.deviation_mm + shift));
            }
        }
        for k in 0..N - 1 {
            for sign in [1.0, -1.0] {
                let mut row = Step::zeros();
                row[k] = sign;
                rows.a.push(row);
                rows.b.push(trust);
            }
        }
        let mut start = Step::zeros();
        let off = held.as_ref().map_or(0.0, |(off, _)| off.abs());
        start[5] = 1.1 * worst + 0.1 * trust + 4.0 * off;
        let mut c = Step::zeros();
        c[5] = 1.0;
        let solved = solve(&c, &rows, start, 1e-12 * (worst + self.tool.radius_mm() * 1e-3))?;
        let mut x = solved.x;
        if let Some((off, c)) = held {
            x[1] = 0.0;
            x[1] = -(off + c.fixed_rows::<5>(0).dot(&x.fixed_rows::<5>(0))) / c[1];
        }
        Some((x, x[5] - solved.gap))
    }
}

/// Deviations within this fraction of the greatest count as equal: a hundred times what the last program leaves.
const ACTIVE: f64 = 1e-6;

/// Deviations that differ by less than this part of the radius are level, and what a step could gain of them is none: rounding of lengths
/// like the radius is a thousand times smaller.
const SETTLED: f64 = 1e-12;

fn greatest(seen: &[Least]) -> f64 {
    seen.iter().map(|l| l.deviation_mm.abs()).fold(0.0, f64::max)
}

/// The minimax axis at the rule at u.
///
/// # Errors
/// [`PlaceError::Rule`], [`PlaceError::NotConverged`], and [`PlaceError::TooLarge`] where it does not converge since the radius is beyond the
/// hollow's.
pub fn minimax(
    strip: &RuledStrip<'_>,
    stations: &Stations,
    u: f64,
    tool: SideTool,
    how: &MinimaxSearch,
) -> Result<MinimaxAxis, PlaceError> {
    let rule = strip.rule(u)?;
    // Three tangencies are near the optimum; without them the bisector is a start.
    let (start, contact) = match three_tangent(strip, u, tool) {
        Ok(root) => {
            let v = root.height_mm / rule.length_mm;
            (root.axis.line, (v, (root.rates[2] - v * rule.length_rate_mm) / rule.length_mm))
        }
        Err(_) => (along_rule(&rule, &tool, 0.0, 0.0).ok_or(PlaceError::NoAxis { u })?.line, (0.5, 0.0)),
    };
    let pivot = match how.hold {
        Hold::Over(v) => (v, 0.0),
        Hold::OverContact => contact,
        Hold::Tangent | Hold::Nothing => (0.5, 0.0),
    };
    let search = Search { strip, stations, rule, tool, how: *how, pivot };
    let mut axis = search.onto_hold(start);
    let mut seen = search.deviations(&axis);
    let mut worst = greatest(&seen);
    let mut trust = (worst * 4.0).max(1e-6 * tool.radius_mm());
    let mut size = f64::INFINITY;
    for iteration in 0..how.rounds {
        let (step, predicted) =
            search.step(&axis, &seen, trust).ok_or_else(|| search.unsettled(size, iteration))?;
        let next = search.moved(&axis, &step);
        let there = search.deviations(&next);
        let value = greatest(&there);
        let (gain, hoped) = (worst - value, worst - predicted);
        size = step.rows(0, N - 1).amax();
        let settled = size <= how.step_mm || hoped <= SETTLED * tool.radius_mm();
        if gain > 0.1 * hoped || (settled && gain >= 0.0) {
            (axis, seen, worst) = (next, there, value);
            if gain > 0.75 * hoped {
                trust *= 2.0;
            }
        } else {
            trust = 0.25 * size;
        }
        if settled || trust < how.step_mm {
            let active = search.active(&seen, worst);
            return Ok(MinimaxAxis {
                axis,
                motion: search.motion(&axis, &active),
                deviation_mm: worst,
                bound_mm: predicted,
                active: active.iter().map(|l| search.touch(l)).collect(),
                step_mm: size,
                iterations: iteration + 1,
            });
        }
    }
    Err(search.unsettled(size, how.rounds))
}
