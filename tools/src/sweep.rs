//! The deepest reach of a moving cutter along a line: min over the motion of the line's entry into the cutter.
//!
//! For a point X on the boundary with outward normal g and velocity v, the entry s moves at `ds/dt = (g . v) / (g . d)`.
//! The minimum over an open motion is where it vanishes (the grazing condition `g . v = 0` of the envelope) or
//! changes sign at an edge of the cutter. Cutters are convex; over motions that turn little in the time they
//! advance by their own size the entry has one minimum, which a bracket on the sign of ds/dt finds.

use crate::cutter::{Cutter, Line, Part};
use crate::pose::Pose;
use osculate_geom::Vec3;
use osculate_geom::roots::{End, FLAT, bracketed, minimum};

/// A pose and its velocity per unit of the motion's parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// The pose.
    pub pose: Pose,
    /// Velocity of the tip, mm.
    pub tip_rate: Vec3,
    /// Angular velocity, rad. The component along the axis is irrelevant.
    pub turn: Vec3,
}

/// A motion of a cutter.
pub trait SweptMotion {
    /// Pose and velocity at parameter `t`; None where the motion is not defined.
    fn at(&self, t: f64) -> Option<Moving>;
}

/// The motion between two poses: tip and axis interpolated linearly (the axis renormalised), t from 0 to 1.
///
/// ```
/// use osculate_geom::{Point3, Unit3, Vec3};
/// use osculate_tools::{Pose, sweep::{LinearMotion, SweptMotion}};
/// // Over 20 mm along x the axis turns from upright towards the feed: half way both are half way.
/// let from = Pose { tip: Point3::origin(), axis: Vec3::z_axis() };
/// let to = Pose { tip: Point3::new(20.0, 0.0, 0.0), axis: Unit3::new_normalize(Vec3::new(0.6, 0.0, 0.8)) };
/// let half = LinearMotion { from, to }.at(0.5).ok_or("it is defined")?;
/// assert!((half.pose.tip.x - 10.0).abs() < 1e-12 && (half.tip_rate.x - 20.0).abs() < 1e-12);
/// let wanted = Unit3::new_normalize(Vec3::new(0.3, 0.0, 0.9));
/// assert!((half.pose.axis.into_inner() - wanted.into_inner()).norm() < 1e-12);
/// // The turn is about y, right-handed: from z to x.
/// assert!(half.turn.y > 0.0 && half.turn.x.abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LinearMotion {
    /// Pose at t = 0.
    pub from: Pose,
    /// Pose at t = 1.
    pub to: Pose,
}

impl SweptMotion for LinearMotion {
    fn at(&self, t: f64) -> Option<Moving> {
        let tip_rate = self.to.tip - self.from.tip;
        let (a, b) = (self.from.axis.into_inner(), self.to.axis.into_inner());
        let raw = a + (b - a) * t;
        let length = raw.norm();
        let axis = osculate_geom::Unit3::new_unchecked(raw / length);
        // axis' = (b - a)/|raw| less its part along the axis; omega = axis x axis'.
        let turn = axis.cross(&((b - a) / length));
        Some(Moving { pose: Pose { tip: self.from.tip + tip_rate * t, axis }, tip_rate, turn })
    }
}

/// The deepest entry of a motion on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reach {
    /// Line parameter of the entry, mm.
    pub at_mm: f64,
    /// Motion parameter at which it happens.
    pub t: f64,
}

/// What the cutter does to a line at one instant.
#[derive(Clone, Copy)]
pub(crate) enum State {
    /// Enters at `s`, which moves at `rate`, on this part of the boundary.
    Hit { s: f64, rate: f64, part: Part },
    /// Passes at some distance that changes at `rate`.
    Miss { rate: f64 },
    /// The motion is not defined.
    Outside,
}

impl State {
    pub(crate) fn rate(self) -> f64 {
        match self {
            Self::Hit { rate, .. } | Self::Miss { rate } => rate,
            Self::Outside => f64::NAN,
        }
    }
}

pub(crate) fn state(cutter: &Cutter, line: &Line, motion: &impl SweptMotion, t: f64) -> State {
    let Some(m) = motion.at(t) else { return State::Outside };
    let velocity = |x: osculate_geom::Point3| m.tip_rate + m.turn.cross(&(x - m.pose.tip));
    match cutter.entry(&m.pose, line) {
        Some(e) => {
            let x = line.point(e.at_mm);
            let g = cutter.normal_at(&m.pose, &x, e.part);
            let along = g.dot(&line.direction);
            let gv = g.dot(&velocity(x));
            // A line that grazes (g perpendicular to it) counts by the sign of g . v alone.
            let rate = if along.abs() > 1e-12 { gv / along } else { -gv };
            State::Hit { s: e.at_mm, rate, part: e.part }
        }
        None => {
            // The shank counts as endless: a line that misses it passes beside the tool or below.
            let x = nearest_on_line(cutter, &m.pose, line);
            let z = (x - m.pose.tip).dot(&m.pose.axis);
            let part = if z >= cutter.corner_mm() {
                Part::Side
            } else {
                let rho = (x - m.pose.tip - m.pose.axis.into_inner() * z).norm();
                if rho <= cutter.core_mm() { Part::Bottom } else { Part::Corner }
            };
            State::Miss { rate: -cutter.normal_at(&m.pose, &x, part).dot(&velocity(x)) }
        }
    }
}

/// The point of a missing line nearest to the cutter: the distance is convex along it.
fn nearest_on_line(cutter: &Cutter, pose: &Pose, line: &Line) -> osculate_geom::Point3 {
    let centre = (pose.tip - line.origin).dot(&line.direction);
    let reach = cutter.length_mm() + cutter.radius_mm();
    let far = |s: f64| cutter.endless_distance(pose, &line.point(s));
    line.point(minimum([centre - reach, centre + reach], FLAT, far).x)
}

/// Relative accuracy of the motion parameter at a minimum. The entry is flat there, so that its own error is of
/// second order but on a sharp edge.
const T_TOLERANCE: f64 = 1e-13;

fn hit(s: State, t: f64) -> Option<Reach> {
    match s {
        State::Hit { s, .. } => Some(Reach { at_mm: s, t }),
        _ => None,
    }
}

/// The minimum inside a bracket with falling entry at its lower and rising entry at its upper end.
fn between(
    cutter: &Cutter,
    line: &Line,
    motion: &impl SweptMotion,
    [(lo, a), (hi, b)]: [(f64, State); 2],
    t_tolerance: f64,
) -> Option<Reach> {
    if let (State::Hit { part: p, .. }, State::Hit { part: q, .. }) = (a, b)
        && cutter.is_end_mill()
        && cutter.corner_mm() == 0.0
        && p != q
        && (p == Part::Bottom || q == Part::Bottom)
        && let Some(found) = on_sharp_edge(cutter, line, motion, [lo, hi], t_tolerance)
    {
        return Some(found);
    }
    let mut best: Option<Reach> = None;
    let mut see = |s: State, t: f64| {
        if let State::Hit { s, .. } = s
            && best.is_none_or(|b| s < b.at_mm)
        {
            best = Some(Reach { at_mm: s, t });
        }
    };
    see(a, lo);
    see(b, hi);
    let ends = [End { x: lo, f: a.rate() }, End { x: hi, f: b.rate() }];
    // Even without convergence (a motion that ends inside) the best instant seen is a true reach.
    let _ = bracketed(ends[0], ends[1], t_tolerance, |t| {
        let now = state(cutter, line, motion, t);
        see(now, t);
        now.rate()
    });
    best
}

/// The instant at which a line passes through the sharp rim of a flat cutter: a smooth root where ds/dt jumps.
fn on_sharp_edge(
    cutter: &Cutter,
    line: &Line,
    motion: &impl SweptMotion,
    [lo, hi]: [f64; 2],
    t_tolerance: f64,
) -> Option<Reach> {
    // Where the line meets the bottom plane, and how far outside the rim that is.
    let plane = |t: f64| -> Option<(f64, f64)> {
        let pose = motion.at(t)?.pose;
        let along = line.direction.dot(&pose.axis);
        if along <= 0.0 {
            return None;
        }
        let s = (pose.tip - line.origin).dot(&pose.axis) / along;
        Some((s, (line.point(s) - pose.tip).norm() - cutter.radius_mm()))
    };
    let (a, b) = (plane(lo)?, plane(hi)?);
    let root = bracketed(End { x: lo, f: a.1 }, End { x: hi, f: b.1 }, t_tolerance, |t| {
        plane(t).map_or(f64::NAN, |p| p.1)
    })
    .ok()?;
    // Only where the entry really has its minimum: on the far side of the rim it would be a maximum.
    let at_mm = plane(root.x)?.0;
    let d = 1e-6 * (hi - lo);
    let falls = state(cutter, line, motion, root.x - d).rate() <= 0.0;
    let rises = state(cutter, line, motion, root.x + d).rate() >= 0.0;
    (falls && rises).then_some(Reach { at_mm, t: root.x })
}

/// The deepest entry of an open motion near parameter `guess`, searched downhill in growing steps from `step` on.
///
/// The search stays within [`REACH_STEPS`] first steps of the guess: on a thin part the tool comes by again on the far
/// side. None where the line misses at every instant looked at.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_tools::sweep::{LinearMotion, reach_from};
/// use osculate_tools::{Cutter, CutterSpec, Line, Pose};
/// // A ball of radius 5 passes 3 mm beside a line along z: the deepest entry is at 5 - sqrt(5^2 - 3^2), half way.
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
/// let at = |x: f64| Pose { tip: Point3::new(x, 3.0, 0.0), axis: Vec3::z_axis() };
/// let motion = LinearMotion { from: at(-10.0), to: at(10.0) };
/// let line = Line { origin: Point3::origin(), direction: Vec3::z_axis() };
/// let deepest = reach_from(&ball, &line, &motion, 0.4, 0.05).ok_or("the tool misses the line")?;
/// assert!((deepest.at_mm - 1.0).abs() < 1e-12 && (deepest.t - 0.5).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn reach_from(
    cutter: &Cutter,
    line: &Line,
    motion: &impl SweptMotion,
    guess: f64,
    step: f64,
) -> Option<Reach> {
    /// Enough to double to the end of the search and to close in on the end of a motion from there.
    const MAX_STEPS: u32 = 60;
    let start = state(cutter, line, motion, guess);
    let slope = start.rate();
    let mut best = hit(start, guess);
    if slope == 0.0 || slope.is_nan() {
        return best;
    }
    let lower = |a: Option<Reach>, b: Option<Reach>| match (a, b) {
        (Some(x), Some(y)) if y.at_mm < x.at_mm => Some(y),
        (None, y) => y,
        (x, _) => x,
    };
    let first = step.abs();
    let mut step = if slope > 0.0 { -first } else { first };
    let tolerance = T_TOLERANCE * first;
    let (mut near, mut near_state) = (guess, start);
    for _ in 0..MAX_STEPS {
        let far = near + step;
        if (far - guess).abs() > REACH_STEPS * first {
            break;
        }
        let far_state = state(cutter, line, motion, far);
        let rate = far_state.rate();
        if rate.is_nan() {
            // The motion ends between: close in on its end, which is the deepest instant.
            if step.abs() <= tolerance.max(1e-9 * guess.abs()) {
                break;
            }
            step *= 0.25;
            continue;
        }
        if matches!(far_state, State::Hit { s, .. } if s < -FAR_SIDE * cutter.radius_mm()) {
            // The tool has come round to the far side of the part.
            break;
        }
        if (rate > 0.0) != (slope > 0.0) {
            let ends = if near < far {
                [(near, near_state), (far, far_state)]
            } else {
                [(far, far_state), (near, near_state)]
            };
            return lower(best, between(cutter, line, motion, ends, tolerance));
        }
        best = lower(best, hit(far_state, far));
        (near, near_state) = (far, far_state);
        step *= 2.0;
    }
    best
}

/// An entry this many radii below the surface is that of a tool on the far side of a thin part, not an undercut.
const FAR_SIDE: f64 = 0.25;
/// How far [`reach_from`] looks, in first steps to each side.
pub const REACH_STEPS: f64 = 40.0;
