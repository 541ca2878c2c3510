//! Seating the tool on faces that are rough on a scale below the tool's.
//!
//! Faces interpolated through measured or computed points often carry ripples of a few micrometres between knots, with
//! curvatures that no tool follows. A contact there would sink the tool into the neighbouring crests and swing its axis
//! with every ripple. So the normal at the contact is averaged over a short stretch of the line, and the tool is raised along it
//! until it rests on the highest places around. On smooth places both change nothing: the average of a symmetric
//! stretch is the normal up to second order, and the contact itself is the highest place. Lead and tilt that are held refer to the
//! average over a longer stretch, so that rotary joints run evenly: an axis may stray further than a contact.

use super::line::PassLine;
use super::ripples::{AVERAGE, PLACES, Ripples, places};
use super::{Leaning, Task};
use crate::rectangle::Rectangle;
use osculate_geom::line::{IsoLine, LineError};
use osculate_geom::{Axis, Darboux, Domain, Point3, Unit3, Uv, Vec3};
use osculate_tools::sweep::Moving;
use osculate_tools::{Lean, Pose, pose_with_axis};
use rayon::prelude::*;

/// Depth of roughness that is looked for, as a part of the tool's radius: the look reaches as far as a ball of that
/// radius on a plane would come as near.
const ROUGHNESS: f64 = 0.0125;
/// Reach of the wide look, in radii of the tool.
const WIDE: f64 = 0.6;
/// Points of a look between neighbouring knots, and fewest to one side.
const PER_SPAN: f64 = 4.0;
const FEWEST: f64 = 3.0;
/// Most points of a look to one side.
const MOST: f64 = 32.0;
/// What a pass leaves on its own line counts as nothing up to this part of the scallop.
const NOTHING_LEFT: f64 = 1e-4;
/// A tool that crests hold up so that it leaves more than this part of the scallop is let into them, by this part of the gouge at most:
/// chords and words need the rest. Under the first share the ridges between passes still have room.
const TOO_MUCH: f64 = 0.75;
const INTO_CRESTS: f64 = 0.4;
/// Raising moves the place of rest, slowly where that is on a steep part of the tool; rounds end early once settled.
const ROUNDS: usize = 10;

/// The normal that lead and tilt refer to on a rough face is averaged over so many times the stretch, so far that the axis leans by no more than
/// this part of its lean more or less. (Tuned on a turbine blade with a lead of 20 degrees by the time on the control, min: 8.32 without, 7.20
/// with 2 and 0.25, 6.84 with 4 and 0.1, 6.79 with 4 and 0.15; above that strips become uneven.)
const STEADY: i32 = 4;
const STEADY_OFF: f64 = 0.1;

/// Deviation of the normal from its average above which a face counts as rough, rad.
const ROUGH_ANGLE: f64 = 0.01;

/// Places to each side of one at which it is asked whether a face is rough there.
const NEAR: i32 = 2;

/// Knot spans looked at to tell whether a face is rough.
const MOST_SPANS: usize = 500;

/// Places before and after one, a part of [`AVERAGE`] apart, that cut at its contact too.
const AROUND: i32 = 4;

/// A tool that rests on a face.
struct Rest {
    pose: Pose,
    frame: Darboux,
}

/// The pose of a tool let so far into what it rests on.
fn sunk(rest: &Rest, by_mm: f64) -> Pose {
    Pose { tip: rest.pose.tip - rest.frame.normal.into_inner() * by_mm, axis: rest.pose.axis }
}

/// Seats on one face.
pub(super) struct Seat<'a> {
    task: &'a Task<'a>,
    ripples: Ripples,
    rough: bool,
    /// The parameters of what holds the tool.
    holds: Domain,
}

impl<'a> Seat<'a> {
    /// For passes that run about along `along`.
    pub(super) fn new(task: &'a Task<'a>, along: Axis) -> Self {
        let mut seat = Self::smooth(task);
        seat.rough = seat.is_rough_along(along);
        seat
    }

    /// For passes in any direction.
    pub(super) fn any(task: &'a Task<'a>) -> Self {
        let mut seat = Self::smooth(task);
        seat.rough = seat.is_rough_along(Axis::U) || seat.is_rough_along(Axis::V);
        seat
    }

    fn smooth(task: &'a Task<'a>) -> Self {
        let ripples = Ripples::new(task.surface, task.cutter.radius_mm());
        Self { task, rough: false, holds: ripples.rectangle.domain, ripples }
    }

    /// Where a face goes on over its border it is the face itself alone, of these parameters, that holds the tool, and the
    /// contact.
    pub(super) const fn held_by(mut self, own: Domain) -> Self {
        self.holds = own;
        self
    }

    /// The parameters of the face itself.
    pub(super) const fn holds(&self) -> Domain {
        self.holds
    }

    fn is_rough_along(&self, along: Axis) -> bool {
        let surface = self.task.surface;
        let knots = self.ripples.breaks(along);
        let stride = knots.len().div_ceil(MOST_SPANS);
        let across = surface.domain().get(along.other());
        [0.02, 0.25, 0.5, 0.75, 0.98].par_iter().any(|f| {
            let line = IsoLine { surface, along, fixed: across.at(*f), reversed: false };
            knots.windows(2).step_by(stride).any(|w| {
                [0.0, 0.25, 0.5, 0.75].iter().any(|g| self.is_rough(&line, w[0] + (w[1] - w[0]) * g))
            })
        })
    }

    /// Whether the face changes its normal faster than the tool can follow next to a place, `by` to both sides.
    pub(super) fn rough_near(&self, at: Uv, by: [f64; 2]) -> bool {
        let looks = |axis: Axis, by: f64| {
            let line = IsoLine {
                surface: self.task.surface,
                along: axis,
                fixed: at.get(axis.other()),
                reversed: false,
            };
            let i = self.task.surface.domain().get(axis);
            (-NEAR..=NEAR).any(|k| {
                let t = at.get(axis) + by * f64::from(k) / f64::from(NEAR);
                self.is_rough(&line, if i.periodic { t } else { t.clamp(i.lo, i.hi) })
            })
        };
        self.rough && (looks(Axis::U, by[0]) || looks(Axis::V, by[1]))
    }

    /// The face's parameters and where it meets itself.
    pub(super) const fn rectangle(&self) -> &Rectangle {
        &self.ripples.rectangle
    }

    /// Whether the face meets itself at the ends of `axis`.
    pub(super) const fn closes(&self, axis: Axis) -> bool {
        self.ripples.rectangle.closes(axis)
    }

    /// Whether the face changes its normal faster than the tool can follow.
    pub(super) const fn rough(&self) -> bool {
        self.rough
    }

    pub(super) const fn task(&self) -> &'a Task<'a> {
        self.task
    }

    /// A parameter of a line, or where it goes on: both ends of one that goes round are one place, beyond those of another the end counts.
    fn held(&self, line: &dyn PassLine, t: f64) -> f64 {
        let i = line.range();
        match (i.periodic, line.goes_round(self.rectangle())) {
            (true, _) => t,
            (false, true) => i.lo + (t - i.lo).rem_euclid(i.length()),
            (false, false) => t.clamp(i.lo, i.hi),
        }
    }

    /// The frame at `t` with its normal and tangent averaged along the line, and the speed there.
    fn frame(&self, line: &dyn PassLine, t: f64) -> Result<(Darboux, f64), LineError> {
        let t = self.held(line, t);
        let (here, speed) = line.frame(t)?;
        let reach = self.ripples.reach(line.uv(t), line.rate(t), speed);
        // Sums of normals and tangents and of their rates.
        let mut sums = [Vec3::zeros(); 4];
        for (share, weight) in places(PLACES) {
            let (f, v) = line.frame(self.held(line, t + reach * share))?;
            let turn = f.turn * v;
            for (sum, x) in sums.iter_mut().zip([
                f.normal.into_inner(),
                f.tangent.into_inner(),
                turn.cross(&f.normal),
                turn.cross(&f.tangent),
            ]) {
                *sum += x * weight;
            }
        }
        let [n, t, dn, dt] = sums;
        let (Some(normal), Some(_)) = (Unit3::try_new(n, 1e-6), Unit3::try_new(t, 1e-6)) else {
            return Ok((here, speed));
        };
        let tangent = osculate_geom::project_to_tangent(&normal, &t);
        let left = Unit3::new_unchecked(normal.cross(&tangent));
        // The frame turns so that it carries n along, and about n as the tangent does.
        let turn = normal.cross(&dn) / n.norm() + normal.into_inner() * (left.dot(&dt) / t.norm());
        // Per mm, as frames have it.
        let turn = if speed == 0.0 { here.turn } else { turn / speed };
        Ok((Darboux { tangent, left, normal, turn, ..here }, speed))
    }

    /// Whether the normal at `t` differs from its average by more than the limit.
    fn is_rough(&self, line: &dyn PassLine, t: f64) -> bool {
        match (line.frame(t), self.frame(line, t)) {
            (Ok((a, _)), Ok((b, _))) => a.normal.angle(&b.normal) > ROUGH_ANGLE,
            _ => false,
        }
    }

    /// The pose raised (or lowered) along `normal` until the cutter just rests on the face around `at`, and by how much.
    ///
    /// The look reaches `reach_mm` to each side.
    fn rest(&self, at: Uv, normal: &Unit3, pose: Pose, reach_mm: f64) -> (Pose, f64) {
        let task = self.task;
        let surface = task.surface;
        let domain = surface.domain();
        let jet = surface.jet2(at);
        let offsets = |axis: Axis, speed: f64| -> Vec<f64> {
            let t = domain.get(axis).bring(at.get(axis));
            let reach = reach_mm / speed.max(1e-12);
            let step = (self.ripples.span(axis, t) / PER_SPAN).min(reach / FEWEST);
            // At most two dozen.
            let n = (reach / step).ceil().min(MOST) as i32;
            let mut all: Vec<f64> = (-n..=n).map(|k| reach * f64::from(k) / f64::from(n)).collect();
            let creases = self.ripples.creases(axis);
            let from = creases.partition_point(|b| *b <= t - reach);
            all.extend(creases[from..].iter().map(|b| b - t).take_while(|by| *by < reach));
            all
        };
        let (us, vs) = (offsets(Axis::U, jet.du.norm()), offsets(Axis::V, jet.dv.norm()));
        let mut points = Vec::with_capacity(us.len() * vs.len());
        for du in &us {
            for dv in &vs {
                let p = Uv { u: at.u + du, v: at.v + dv };
                // Beyond the border the tool goes on at the height of its contact.
                let holds = |p: &Uv| (*du == 0.0 && *dv == 0.0) || self.holds.contains(*p);
                let on = self.ripples.rectangle.bring(p).filter(holds);
                points.extend(on.map(|p| surface.point(p)));
            }
        }
        let mut seated = pose;
        let mut lift = 0.0;
        for _ in 0..ROUNDS {
            let gap = points.iter().map(|p| task.cutter.distance(&seated, p)).fold(f64::INFINITY, f64::min);
            if !gap.is_finite() || gap.abs() < 1e-7 {
                break;
            }
            lift -= gap;
            seated = Pose { tip: pose.tip + normal.into_inner() * lift, axis: pose.axis };
        }
        (seated, lift)
    }

    /// A pose at a contact brought to rest on the face around it along a normal, and by how much.
    pub(super) fn raised(&self, at: Uv, normal: &Unit3, pose: Pose) -> (Pose, f64) {
        let radius = self.task.cutter.radius_mm();
        let near = (2.0 * ROUGHNESS).sqrt() * radius;
        let (seated, lift) = if self.rough { (pose, 0.0) } else { self.rest(at, normal, pose, near) };
        // A tool that does not rest on its contact leans towards places further off than those next to it.
        if self.rough || lift > 1e-3 * self.task.tolerance.gouge_mm {
            self.rest(at, normal, pose, WIDE * radius)
        } else {
            (seated, lift)
        }
    }

    /// The axis on a rough face where the tool touches in a frame at `t`: lead and tilt refer to a normal averaged over a longer stretch, as far
    /// as that changes the lean by a small part of it. None where it does not.
    fn steady(
        &self,
        line: &dyn PassLine,
        t: f64,
        frame: &Darboux,
        lean: Lean,
    ) -> Result<Option<Unit3>, LineError> {
        let most_rad = STEADY_OFF * lean.lead_rad.abs();
        // Leads found for a place are narrow peaks, and axes of a field refer to no frame.
        if !self.rough || most_rad == 0.0 || !matches!(self.task.lean, Leaning::Held(_) | Leaning::Sided(_)) {
            return Ok(None);
        }
        let t = self.held(line, t);
        let (_, speed) = line.frame(t)?;
        let reach = f64::from(STEADY) * self.ripples.reach(line.uv(t), line.rate(t), speed);
        let mut sum = Vec3::zeros();
        for (share, weight) in places(STEADY * PLACES) {
            sum += line.frame(self.held(line, t + reach * share))?.0.normal.into_inner() * weight;
        }
        let Some(mean) = Unit3::try_new(sum, 1e-6) else { return Ok(None) };
        let off_rad = mean.angle(&frame.normal);
        let share = if off_rad > most_rad { most_rad / off_rad } else { 1.0 };
        let between = frame.normal.into_inner() * (1.0 - share) + mean.into_inner() * share;
        let normal = Unit3::new_normalize(between);
        let tangent = osculate_geom::project_to_tangent(&normal, &frame.tangent);
        let left = Unit3::new_unchecked(normal.cross(&tangent));
        Ok(Some(lean.pose(self.task.cutter, &Darboux { tangent, left, normal, ..*frame }, 0.0).axis))
    }

    /// The tool at its contact in a frame at `t`, not seated.
    fn touching(&self, line: &dyn PassLine, t: f64, moved: (&Darboux, f64)) -> Result<Pose, LineError> {
        let (cutter, frame) = (self.task.cutter, moved.0);
        let lean = self.task.lean.on(line, t, moved);
        let steady = self.steady(line, t, frame, lean)?;
        Ok(steady.map_or_else(
            || lean.pose(cutter, frame, 0.0),
            |axis| pose_with_axis(cutter, &frame.point, &frame.normal, &axis),
        ))
    }

    /// The motion of the tool along a line at `t`, led by averaged normals, not seated.
    pub(super) fn moving(&self, line: &dyn PassLine, t: f64) -> Result<Moving, LineError> {
        let (frame, speed) = if self.rough { self.frame(line, t)? } else { line.frame(t)? };
        Ok(self.task.lean.moving(self.task.cutter, line, t, (&frame, speed)))
    }

    /// The pose that rests on the face at a line parameter, its frame, and the lift.
    fn resting(&self, line: &dyn PassLine, t: f64) -> Result<(Pose, Darboux, f64), LineError> {
        let (frame, speed) = self.frame(line, t)?;
        let pose = self.touching(line, t, (&frame, speed))?;
        let (pose, lift) = self.raised(line.uv(t), &frame.normal, pose);
        Ok((pose, frame, lift))
    }

    /// The tool at rest at `t` and at so many places before and after it, as far as the line goes.
    fn rests(&self, line: &dyn PassLine, t: f64, places: i32) -> Result<Vec<Option<Rest>>, LineError> {
        let (i, speed) = (line.range(), line.frame(t)?.1);
        let step = 0.5 * AVERAGE * self.task.cutter.radius_mm() / speed.abs().max(1e-12);
        let at = |k: i32| {
            let s = t + step * f64::from(k);
            let there = i.contains(s) || k == 0;
            let rest = || self.resting(line, s).map(|(pose, frame, _)| Rest { pose, frame });
            there.then(rest).transpose()
        };
        (-places..=places).map(at).collect()
    }

    /// What tools with these poses around a place leave at its contact.
    fn left(&self, poses: impl Iterator<Item = Pose>, contact: &Point3) -> f64 {
        poses.map(|pose| self.task.cutter.distance(&pose, contact)).fold(f64::INFINITY, f64::min).max(0.0)
    }

    /// By how much the tool is let into crests that have it leave so much; not where that is too much even so.
    fn sunk_mm(&self, left_mm: f64) -> f64 {
        let t = &self.task.tolerance;
        let most_mm = INTO_CRESTS * t.gouge_mm;
        let of_use_mm = t.scallop_mm + 2.0 * most_mm - left_mm;
        (left_mm - TOO_MUCH * t.scallop_mm).min(of_use_mm).clamp(0.0, most_mm)
    }

    /// By how much the tool is let into crests at the middle of an odd number of places at rest.
    fn sunk_among_mm(&self, rests: &[Option<Rest>]) -> f64 {
        let Some(Some(middle)) = rests.get(rests.len() / 2) else { return 0.0 };
        self.sunk_mm(self.left(rests.iter().flatten().map(|r| r.pose), &middle.frame.point))
    }

    /// Whether a tool that rests like this may leave too much at its own line.
    fn may_be_sunk(&self, rest: &Rest) -> bool {
        let left_mm = self.task.cutter.distance(&rest.pose, &rest.frame.point);
        left_mm > TOO_MUCH * self.task.tolerance.scallop_mm
    }

    /// The seated pose at a line parameter, its frame, and the lift: at rest, or let into crests that keep it too far off the face.
    pub(super) fn at(&self, line: &dyn PassLine, t: f64) -> Result<(Pose, Darboux, f64), LineError> {
        let (pose, frame, lift) = self.resting(line, t)?;
        if !self.may_be_sunk(&Rest { pose, frame }) {
            return Ok((pose, frame, lift));
        }
        let sunk_mm = self.sunk_among_mm(&self.rests(line, t, AROUND)?);
        Ok((sunk(&Rest { pose, frame }, sunk_mm), frame, lift - sunk_mm))
    }

    /// What a pass leaves at its own line at `t`, the tool seated there and a little before and after: zero on a smooth
    /// face, the depth of what the tool cannot enter on a rough one.
    pub(super) fn left_over(&self, line: &dyn PassLine, t: f64) -> Result<f64, LineError> {
        let (pose, frame, _) = self.resting(line, t)?;
        // As a rule the tool rests on its contact, and there is nothing to look for around it.
        let least_mm = self.task.cutter.distance(&pose, &frame.point).max(0.0);
        if least_mm <= NOTHING_LEFT * self.task.tolerance.scallop_mm {
            return Ok(least_mm);
        }
        let into = self.may_be_sunk(&Rest { pose, frame });
        let rests = self.rests(line, t, if into { 2 * AROUND } else { AROUND })?;
        let around = 2 * AROUND as usize + 1;
        let poses: Vec<Pose> = if into {
            let seated = |near: &[Option<Rest>]| {
                let rest = near[AROUND as usize].as_ref()?;
                Some(sunk(rest, self.sunk_among_mm(near)))
            };
            rests.windows(around).filter_map(seated).collect()
        } else {
            rests.iter().flatten().map(|r| r.pose).collect()
        };
        Ok(self.left(poses.into_iter(), &frame.point))
    }

    /// How far the whole end of the tool, not only the part of it next to the contact, is held off the face.
    pub(super) fn wide_lift(&self, line: &dyn PassLine, t: f64) -> Result<f64, LineError> {
        let (frame, speed) = self.frame(line, t)?;
        let pose = self.touching(line, t, (&frame, speed))?;
        Ok(self.rest(line.uv(t), &frame.normal, pose, WIDE * self.task.cutter.radius_mm()).1)
    }
}
