//! Points along a pass: as few as hold the chord tolerance at the contact.

use super::line::PassLine;
use super::seat::Seat;
use super::{CcPoint, Task};
use osculate_geom::line::LineError;
use osculate_geom::{Point3, Unit3};
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Pose, pose_with_axis};

/// Axis turns between two points are kept below this, so that machines see smooth orientation, rad.
const MAX_TURN: f64 = 0.06;
/// The contact may stray sideways from the chord by this part of the tool's radius: it only moves the strip.
const SIDEWAYS: f64 = 0.01;
/// Halvings of one initial piece; past it the surface is not smooth.
const MAX_DEPTH: u32 = 16;
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

/// Parameters and poses along `line` from `from` to `to`, starting from the pieces between `breaks` and halving each
/// until the straight motion between neighbours stays within the chord tolerance at the contact.
pub(super) fn resample(
    seat: &Seat<'_>,
    task: &Task<'_>,
    line: &dyn PassLine,
    [from, to]: [f64; 2],
    breaks: &[f64],
) -> Result<Vec<Knot>, LineError> {
    let (lo, hi) = (from.min(to), from.max(to));
    let mut stops = vec![lo];
    let slack = 1e-9 * (hi - lo);
    stops.extend(breaks.iter().copied().filter(|b| *b > lo + slack && *b < hi - slack));
    stops.push(hi);
    if from > to {
        stops.reverse();
    }
    let mut out = vec![knot(seat, task, line, from)?];
    for w in stops.windows(2) {
        let mut last = out[out.len() - 1];
        // Two pieces at least between breaks: the mid-point of a symmetric piece can look straight.
        for k in 1..=2 {
            let t = w[0] + (w[1] - w[0]) * 0.5 * f64::from(k);
            let end = knot(seat, task, line, t)?;
            halve(seat, task, line, last, end, 0, &mut out)?;
            last = end;
        }
    }
    Ok(thin(seat, task, line, &out))
}

fn halve(
    seat: &Seat<'_>,
    task: &Task<'_>,
    line: &dyn PassLine,
    a: Knot,
    b: Knot,
    depth: u32,
    out: &mut Vec<Knot>,
) -> Result<(), LineError> {
    let mid = knot(seat, task, line, 0.5 * (a.t + b.t))?;
    if straight(seat, task, line, &a, &b, Some(&mid))? {
        out.push(b);
    } else if depth < MAX_DEPTH {
        halve(seat, task, line, a, mid, depth + 1, out)?;
        halve(seat, task, line, mid, b, depth + 1, out)?;
    } else {
        roll((seat, task, line), &a, &b, 0, out);
    }
    Ok(())
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
    let mid = middle().filter(|mid| !motion.at(0.5).is_some_and(|now| holds(task, &now.pose, mid)));
    match mid {
        Some(mid) if depth < MAX_ROLLS => {
            roll(on, a, &mid, depth + 1, out);
            roll(on, &mid, b, depth + 1, out);
        }
        _ => out.push(*b),
    }
}

/// Whether a pose of the straight motion does what the true pose of a knot does: at the contact, and as far to its
/// sides as the strip reaches.
fn holds(task: &Task<'_>, pose: &Pose, knot: &Knot) -> bool {
    let t = &task.tolerance;
    if (task.cutter.distance(pose, &knot.point) - knot.height).abs() > t.chord_mm {
        return false;
    }
    // A ball is the same under any lean.
    if task.cutter.is_ball() {
        return true;
    }
    // Where the contact swings round the end of the tool another part of it than the true one may go through the tangent plane.
    if (knot.pose.tip - pose.tip).dot(&knot.normal) > t.chord_mm {
        return false;
    }
    let radius = task.cutter.radius_mm();
    let reach = radius.min(2.0 * (2.0 * t.scallop_mm * radius).sqrt());
    pose.axis.angle(&knot.pose.axis) * reach <= t.chord_mm
}

/// Whether the straight motion from `a` to `b` holds the tolerance at three contacts between.
fn straight(
    seat: &Seat<'_>,
    task: &Task<'_>,
    line: &dyn PassLine,
    a: &Knot,
    b: &Knot,
    mid: Option<&Knot>,
) -> Result<bool, LineError> {
    if a.pose.axis.angle(&b.pose.axis) > MAX_TURN {
        return Ok(false);
    }
    let motion = LinearMotion { from: a.pose, to: b.pose };
    let chord = b.point - a.point;
    let length = chord.norm();
    for fraction in [0.5, 0.25, 0.75] {
        let k = match mid {
            Some(m) if fraction == 0.5 => *m,
            _ => knot(seat, task, line, a.t + (b.t - a.t) * fraction)?,
        };
        // The instant at which the straight motion is abreast of the contact.
        let along = if length > 0.0 { (k.point - a.point).dot(&chord) / (length * length) } else { fraction };
        let Some(now) = motion.at(along.clamp(0.0, 1.0)) else { return Ok(false) };
        if !holds(task, &now.pose, &k) {
            return Ok(false);
        }
        let off = (k.point - a.point) - chord * along;
        let sideways = off - k.normal.into_inner() * off.dot(&k.normal);
        if sideways.norm() > SIDEWAYS * task.cutter.radius_mm() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Drops knots whose neighbours can be joined directly: the halving leaves up to twice as many as needed.
fn thin(seat: &Seat<'_>, task: &Task<'_>, line: &dyn PassLine, knots: &[Knot]) -> Vec<Knot> {
    let mut out = vec![knots[0]];
    let mut at = 0;
    while at + 1 < knots.len() {
        // Join as long as every knot passed over, and the contacts between, stay within the tolerance.
        let mut next = at + 1;
        while next + 1 < knots.len() && next - at < 8 && joins(seat, task, line, &knots[at..=next + 1]) {
            next += 1;
        }
        out.push(knots[next]);
        at = next;
    }
    out
}

fn joins(seat: &Seat<'_>, task: &Task<'_>, line: &dyn PassLine, knots: &[Knot]) -> bool {
    let (a, b) = (&knots[0], &knots[knots.len() - 1]);
    if !straight(seat, task, line, a, b, None).unwrap_or(false) {
        return false;
    }
    let motion = LinearMotion { from: a.pose, to: b.pose };
    let chord = b.point - a.point;
    let l2 = chord.norm_squared();
    knots[1..knots.len() - 1].iter().all(|k| {
        let along = if l2 > 0.0 { (k.point - a.point).dot(&chord) / l2 } else { 0.5 };
        motion.at(along.clamp(0.0, 1.0)).is_some_and(|m| holds(task, &m.pose, k))
    })
}

/// Contact points from knots; the strip width is filled in by the caller.
pub(super) fn contact_points(knots: &[Knot], uv: impl Fn(f64) -> osculate_geom::Uv) -> Vec<CcPoint> {
    knots
        .iter()
        .map(|k| CcPoint { uv: uv(k.t), point: k.point, normal: k.normal, pose: k.pose, width_mm: f64::NAN })
        .collect()
}
