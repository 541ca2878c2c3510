//! How far the pass on a level covers a place: the interval of levels whose strip takes it in.
//!
//! The pass of a level is followed exactly where it is nearest, at its foot steepest up or down from the place, and the
//! swept tool is asked how far it comes down there, as for isoparametric passes.

use super::field::{Face, Near};
use crate::plan::Task;
use crate::plan::motion::PassMotion;
use crate::plan::seat::Seat;
use crate::plan::walk::Walk;
use osculate_geom::line::LineError;
use osculate_geom::{Darboux, Relative, Uv};
use osculate_tools::strip::standoff;

/// Accuracy of a reach, of itself.
const TOLERANCE: f64 = 2e-3;
/// A reach is looked for up to so many times the leading-order half width.
const FURTHEST: f64 = 12.0;
/// Leading-order half width at most, of the tool's radius.
const WIDEST: f64 = 0.8;

/// Reaches of the passes above and below a place, as differences of the field; None where the face ends before. Of passes with
/// the uphill side to the left, and of those that run the other way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    pub up: [Option<f64>; 2],
    pub down: [Option<f64>; 2],
    /// The field's slope, 1/mm.
    pub slope_per_mm: f64,
}

/// One place and one direction of feed.
struct Asked<'a> {
    task: &'a Task<'a>,
    seat: &'a Seat<'a>,
    face: Face<'a>,
    at: Uv,
    value: f64,
    height_mm: f64,
    reversed: bool,
}

impl Asked<'_> {
    /// Standoff above the design height at the place, of the pass `by` away.
    fn excess(&self, by: f64) -> Result<f64, LineError> {
        let task = self.task;
        let near = Near::below(self.face, self.at, self.value + by, self.reversed)?;
        let motion = PassMotion { seat: self.seat, line: &near };
        let radius = task.cutter.radius_mm();
        let reach = standoff(task.cutter, task.surface, self.at, &motion, 0.0, 0.05 * radius)?;
        Ok(reach.map_or(radius, |r| r.at_mm - self.height_mm))
    }

    /// How far up (`sign` 1) or down (-1) passes cover the place, from a guess; None where there are none so far: the face
    /// ends before, or the field turns back.
    fn reach(&self, sign: f64, guess: f64) -> Option<f64> {
        let walk = Walk { from: 0.0, to: FURTHEST * guess, guess: 2.0 * guess, tolerance: TOLERANCE * guess };
        walk.last_below(|by| self.excess(sign * by)).ok()
    }
}

/// The reaches around a place; a tool without side is the same both ways.
///
/// # Errors
/// [`LineError`] where the level lines have no frame.
pub(super) fn reach(seat: &Seat<'_>, face: Face<'_>, at: Uv) -> Result<Reach, LineError> {
    let task = seat.task();
    let (_, jet, phi) = face.at(at).ok_or(LineError::Outside { at })?;
    let (_, slope) = Face::ascent(&jet, &phi)?;
    let (frame, ..) = face.frame(at, false)?;
    let forms = jet.forms()?;
    let q = Relative::new(&forms, &task.lean.against(at, (&frame, 1.0)).tool_curvature(task.cutter, &frame))
        .along(&frame.left);
    let height_mm = height_mm(seat, face, at, phi.value, &frame)?;
    let radius = task.cutter.radius_mm();
    let half = (2.0 * height_mm / q.max(1e-9)).sqrt().min(WIDEST * radius);
    let both = |sign: f64| {
        let one = |reversed: bool| {
            let asked = Asked { task, seat, face, at, value: phi.value, height_mm, reversed };
            asked.reach(sign, half * slope)
        };
        let first = one(false);
        let second = if task.cutter.is_ball() { first } else { one(true) };
        // Where one of them is not known the other stands for both.
        [first.or(second), second.or(first)]
    };
    Ok(Reach { up: both(1.0), down: both(-1.0), slope_per_mm: slope })
}

/// Standoffs tell how far passes reach where they are at least so high, of the design height.
const LOW: f64 = 0.4;

/// Reaches of the passes on two levels at the ridge between them that lies steepest up or down from a place, up and down from
/// the ridge; `share` of the way between the levels lies below it, and `reversed` tells whether the pass below and that above run
/// the other way; where that is open both ways are asked. None where one of the passes is not there, or they meet so
/// low that the ridge does not tell.
pub(super) fn met(
    seat: &Seat<'_>,
    face: Face<'_>,
    from: Uv,
    [below, above]: [f64; 2],
    (share, reversed): (f64, Option<[bool; 2]>),
) -> Option<[f64; 2]> {
    let task = seat.task();
    let (_, jet, phi) = face.at(from)?;
    let (uphill, _) = Face::ascent(&jet, &phi).ok()?;
    let value = below + (above - below) * share;
    let at = face.settle(from, uphill, value).ok()?;
    let (frame, ..) = face.frame(at, false).ok()?;
    let height_mm = height_mm(seat, face, at, value, &frame).ok()?;
    let reach = |by: f64, way: Option<bool>| {
        let mut left = 0.0_f64;
        let both = [false, true];
        let asked = match way {
            Some(false) => &both[..1],
            Some(true) => &both[1..],
            None if task.cutter.is_ball() => &both[..1],
            None => &both[..],
        };
        for reversed in asked {
            let asked = Asked { task, seat, face, at, value, height_mm, reversed: *reversed };
            left = left.max(asked.excess(by).ok()? + height_mm);
        }
        (left >= LOW * height_mm).then(|| by.abs() * (height_mm / left).sqrt())
    };
    Some([reach(above - value, reversed.map(|r| r[1]))?, reach(below - value, reversed.map(|r| r[0]))?])
}

/// The height that passes are laid out for at a place of a level line.
fn height_mm(seat: &Seat<'_>, face: Face<'_>, at: Uv, level: f64, frame: &Darboux) -> Result<f64, LineError> {
    let left_mm =
        if seat.rough() { seat.left_over(&Near::below(face, at, level, false)?, 0.0)? } else { 0.0 };
    Ok(seat.task().design_scallop_mm(frame.turn.dot(&frame.left), left_mm))
}
