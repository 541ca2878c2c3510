//! Points along a pass: as few as hold the chord tolerance at the contact.

use super::line::PassLine;
use super::seat::Seat;
use super::{CcPoint, Leaning, Task};
use osculate_geom::line::LineError;
use osculate_geom::{Point3, Unit3};
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Pose, pose_with_axis};

/// Axis turns between two points are kept below this, so that machines see smooth orientation, rad.
const MAX_TURN: f64 = 0.06;
/// The contact may stray sideways from the chord by this part of the tool's radius: it only moves the strip.
const SIDEWAYS: f64 = 0.01;
/// Where the strip ends the tool may be higher or lower than it should by this part of the scallop, as its axis turns about the feed.
/// (Tuned on a turbine blade with ripples: of 21,105 points 17,539 are left, and the control takes 5.88 min in place of 6.84; four times as
/// much leaves 16,238 points and 5.63 min.)
const EDGE: f64 = 0.05;
/// The far side of its end may be lower by this part of the gouge limit, where the lead is as small as the part allows.
const HEEL: f64 = 0.3;
/// Steps aim at this part of the longest that holds the tolerance: where the line bends more a little further on they hold it still.
const AIM: f64 = 0.95;
/// A step grows or shrinks by no more than these factors from one to the next.
const GROWTH: [f64; 2] = [0.5, 2.0];
/// ... and where it does not hold by one of these until the next try.
const SHRINK: [f64; 2] = [0.1, 0.85];
/// A step that strains less than this is tried longer once.
const ENOUGH: f64 = 0.7;
/// Tries for a step by what the last one strayed, before it is bisected.
const TRIES: u32 = 4;
/// The shortest step, of the longest that is allowed there: where it does not hold the surface is not smooth.
const FINEST: f64 = 1.0 / 65536.0;
/// The first step of a line, of the longest that is allowed there.
const FIRST: f64 = 0.125;
/// Breaks of the line that one step may pass over.
const MOST_BREAKS: usize = 8;
/// A step that ends this near to the end of the line, in steps, goes there.
const NEAR_END: f64 = 1.1;
/// Halvings of the way over a crease.
const MAX_ROLLS: u32 = 6;

/// A contact pose at a line parameter.
#[derive(Clone, Copy)]
pub(super) struct Knot {
    /// Line parameter; for contours the first surface parameter.
    pub t: f64,
    /// For contours the second surface parameter, else unused.
    pub v: f64,
    pub point: Point3,
    pub normal: Unit3,
    pub pose: Pose,
    /// Height of the seated tool above the contact, mm.
    pub height: f64,
}

fn knot(seat: &Seat<'_>, task: &Task<'_>, line: &dyn PassLine, t: f64) -> Result<Knot, LineError> {
    let (pose, frame, _) = seat.at(line, t)?;
    let height = task.cutter.distance(&pose, &frame.point);
    Ok(Knot { t, v: 0.0, point: frame.point, normal: frame.normal, pose, height })
}

/// Parameters and poses along `line` from `from` to `to`, each as far from the one before as the straight motion between them
/// stays within the chord tolerance at the contact, over a few of the `breaks` at most.
pub(super) fn resample(
    seat: &Seat<'_>,
    task: &Task<'_>,
    line: &dyn PassLine,
    [from, to]: [f64; 2],
    breaks: &[f64],
) -> Result<Vec<Knot>, LineError> {
    let march = March { on: (seat, task, line), to, longest: Longest::new([from, to], breaks) };
    let mut last = knot(seat, task, line, from)?;
    let mut out = vec![last];
    let mut step = FIRST * march.longest.at(from);
    while last.t != to {
        step = march.step(&last, step, &mut out)?;
        last = out[out.len() - 1];
    }
    Ok(out)
}

/// How far a step may go along a line.
struct Longest {
    /// Places where the line's derivatives jump, and its ends, ascending.
    stops: Vec<f64>,
    forwards: bool,
}

impl Longest {
    fn new([from, to]: [f64; 2], breaks: &[f64]) -> Self {
        let (lo, hi) = (from.min(to), from.max(to));
        let slack = 1e-9 * (hi - lo);
        let mut stops = vec![lo];
        stops.extend(breaks.iter().copied().filter(|b| *b > lo + slack && *b < hi - slack));
        // Two pieces at least: the middle of a symmetric line can look straight.
        if stops.len() == 1 {
            stops.push(0.5 * (lo + hi));
        }
        stops.push(hi);
        stops.dedup();
        Self { stops, forwards: to > from }
    }

    /// The longest step from `t`: as far as it is over [`MOST_BREAKS`] breaks, were all as far apart as the two around it.
    fn at(&self, t: f64) -> f64 {
        let n = self.stops.len();
        let k = if self.forwards {
            self.stops.partition_point(|s| *s <= t)
        } else {
            self.stops.partition_point(|s| *s < t)
        };
        let k = k.clamp(1, n - 1);
        MOST_BREAKS as f64 * (self.stops[k] - self.stops[k - 1])
    }

    /// How many breaks lie between two places.
    fn between(&self, a: f64, b: f64) -> usize {
        let below = |t: f64| self.stops.partition_point(|s| *s < t);
        below(a.max(b)) - below(a.min(b))
    }
}

/// The way along a line, step by step.
struct March<'a> {
    on: (&'a Seat<'a>, &'a Task<'a>, &'a dyn PassLine),
    to: f64,
    longest: Longest,
}

impl March<'_> {
    /// Goes on from `a` by about `wish`, as far as it holds; the length that the next step should have.
    fn step(&self, a: &Knot, wish: f64, out: &mut Vec<Knot>) -> Result<f64, LineError> {
        let left = (self.to - a.t).abs();
        let longest = self.longest.at(a.t);
        let finest = FINEST * longest;
        let mut step = wish.clamp(finest, longest);
        let (mut held, mut broken) = (None, f64::INFINITY);
        for _ in 0..TRIES {
            // No short piece is left for the end.
            if left <= NEAR_END * step || left <= finest {
                step = left;
            } else if left < 2.0 * step {
                step = 0.5 * left;
            }
            let b = self.knot(a, step)?;
            let strain = self.strain(a, &b)?;
            let next = step * AIM / strain;
            if strain <= 1.0 {
                held = Some((b, next.clamp(GROWTH[0] * step, GROWTH[1] * step)));
                let longer = next.min(GROWTH[1] * step).min(longest);
                if strain >= ENOUGH || longer >= broken || longer <= step || left < 2.0 * longer {
                    break;
                }
                step = longer;
            } else {
                broken = step;
                step = next.clamp(SHRINK[0] * step, SHRINK[1] * step);
                if held.is_some() || step <= finest {
                    break;
                }
            }
        }
        if let Some((b, next)) = held {
            out.push(b);
            return Ok(next);
        }
        // Something sharp lies ahead: up to it in one step, or over it, and on as before.
        let (mut up_to, mut low) = (None, 0.0);
        while broken - low > finest {
            let middle = 0.5 * (low + broken);
            let b = self.knot(a, middle)?;
            if self.strain(a, &b)? <= 1.0 {
                (up_to, low) = (Some(b), middle);
            } else {
                broken = middle;
            }
        }
        match up_to {
            Some(b) => out.push(b),
            None => roll(self.on, a, &self.knot(a, broken)?, 0, out),
        }
        Ok(wish)
    }

    /// The length of the straight motion from `a` to `b` over that of the longest that would hold the tolerance at contacts
    /// between, three at least and two for each break: what strays grows with the square of the length, turns with the length.
    fn strain(&self, a: &Knot, b: &Knot) -> Result<f64, LineError> {
        let (seat, task, line) = self.on;
        let turn = a.pose.axis.angle(&b.pose.axis) / MAX_TURN;
        if turn > 1.0 {
            return Ok(turn);
        }
        let motion = LinearMotion { from: a.pose, to: b.pose };
        let chord = b.point - a.point;
        let length = chord.norm();
        let mut worst = 0.0f64;
        let half = 1 + self.longest.between(a.t, b.t).max(1);
        // The middle first, which strays most.
        for k in 0..2 * half - 1 {
            let aside = k.div_ceil(2);
            let place = if k % 2 == 0 { half + aside } else { half - aside };
            let fraction = place as f64 / (2 * half) as f64;
            let at = knot(seat, task, line, a.t + (b.t - a.t) * fraction)?;
            // The instant at which the straight motion is abreast of the contact.
            let along =
                if length > 0.0 { (at.point - a.point).dot(&chord) / (length * length) } else { fraction };
            let Some(now) = motion.at(along.clamp(0.0, 1.0)) else { return Ok(f64::INFINITY) };
            let off = (at.point - a.point) - chord * along;
            let sideways = off - at.normal.into_inner() * off.dot(&at.normal);
            let aside = sideways.norm() / (SIDEWAYS * task.cutter.radius_mm());
            let across = Unit3::try_new(at.normal.cross(&chord), 0.0);
            worst = worst.max(stray(task, &now.pose, &at, across)).max(aside);
            if worst > 1.0 {
                break;
            }
        }
        Ok(turn.max(worst.sqrt()))
    }

    fn knot(&self, a: &Knot, step: f64) -> Result<Knot, LineError> {
        let (seat, task, line) = self.on;
        let left = self.to - a.t;
        let t = a.t + step.copysign(left);
        // A step too short for its parameter's last digit would lead nowhere.
        knot(seat, task, line, if step >= left.abs() || t == a.t { self.to } else { t })
    }
}

/// Goes from one side of a crease to the other: the tool rolls over it, as its normal turns, in as few steps as hold the tolerance.
fn roll(
    on @ (seat, task, line): (&Seat<'_>, &Task<'_>, &dyn PassLine),
    a: &Knot,
    b: &Knot,
    depth: u32,
    out: &mut Vec<Knot>,
) {
    let middle = || {
        let normal = Unit3::try_new(a.normal.into_inner() + b.normal.into_inner(), 1e-6)?;
        let axis = Unit3::try_new(a.pose.axis.into_inner() + b.pose.axis.into_inner(), 1e-6)?;
        let (t, point) = (0.5 * (a.t + b.t), nalgebra::center(&a.point, &b.point));
        let pose = pose_with_axis(task.cutter, &point, &normal, &axis);
        let pose = seat.raised(line.uv(t), &normal, pose).0;
        Some(Knot { t, v: 0.0, point, normal, pose, height: task.cutter.distance(&pose, &point) })
    };
    let motion = LinearMotion { from: a.pose, to: b.pose };
    let mid =
        middle().filter(|mid| !motion.at(0.5).is_some_and(|now| stray(task, &now.pose, mid, None) <= 1.0));
    match mid {
        Some(mid) if depth < MAX_ROLLS => {
            roll(on, a, &mid, depth + 1, out);
            roll(on, &mid, b, depth + 1, out);
        }
        _ => out.push(*b),
    }
}

/// By how much a pose of the straight motion strays from the true pose of a knot, of what it may: at the contact, where the tool's
/// end goes through the tangent plane, as far to both sides along `across` as the strip reaches, and under the far side of the end. Without a
/// direction the axis alone tells what happens beside the contact.
fn stray(task: &Task<'_>, pose: &Pose, knot: &Knot, across: Option<Unit3>) -> f64 {
    let (t, cutter) = (&task.tolerance, task.cutter);
    let height = (cutter.distance(pose, &knot.point) - knot.height).abs();
    // A ball is the same under any lean.
    if cutter.is_ball() {
        return height / t.chord_mm;
    }
    // Where the contact swings round the end of the tool another part of it than the true one may go through the tangent plane.
    let down = (knot.pose.tip - pose.tip).dot(&knot.normal);
    let radius = cutter.radius_mm();
    let reach = radius.min(2.0 * (2.0 * t.scallop_mm * radius).sqrt());
    let edges = match across {
        Some(across) => [reach, -reach]
            .map(|y| {
                let edge = knot.point + across.into_inner() * y;
                (cutter.distance(pose, &edge) - cutter.distance(&knot.pose, &edge)).abs()
            })
            .into_iter()
            .fold(0.0, f64::max),
        None => pose.axis.angle(&knot.pose.axis) * reach,
    };
    // A lead found for a place keeps the far side of the end just off the part.
    let heel = if matches!(task.lean, Leaning::Field(_)) {
        let aside = knot.pose.tip - knot.point;
        let far = knot.point + (aside - knot.normal.into_inner() * aside.dot(&knot.normal)) * 2.0;
        (cutter.distance(&knot.pose, &far) - cutter.distance(pose, &far)).max(0.0) / (HEEL * t.gouge_mm)
    } else {
        0.0
    };
    (height.max(down) / t.chord_mm).max(edges / (EDGE * t.scallop_mm)).max(heel)
}

/// Contact points from knots; the strip width is filled in by the caller.
pub(super) fn contact_points(knots: &[Knot], uv: impl Fn(f64) -> osculate_geom::Uv) -> Vec<CcPoint> {
    knots
        .iter()
        .map(|k| CcPoint { uv: uv(k.t), point: k.point, normal: k.normal, pose: k.pose, width_mm: f64::NAN })
        .collect()
}
