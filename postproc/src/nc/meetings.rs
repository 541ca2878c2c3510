//! What of a machine's head comes too near to its table, its bed, the part and what holds it, anywhere along a program.
//!
//! A text runs through the model of the control once more, and every block is followed from its start: where two bodies are d apart, and
//! nothing of the one strays by more than d less the clearance from where it was then, they stay clear of each other. Else the way is
//! halved, and they are measured again. So nothing lies between the looks, and most blocks cost no look at all.
//!
//! How far a body strays is asked of the corners of the box around it: between two placings nothing in the box moves farther than one of
//! them. The way between bends off the straight by what is seen of it in the middle; pieces turn so little that twice that is more than all.

use nalgebra::{Isometry3, Translation3};
use osculate_geom::convex::{Convex, Crowd};
use osculate_geom::{Diagnostic, Point3};

use super::Dialect;
use super::event::{Event, Frame, Moved, Sink};
use super::flow::Flow;
use super::interpret::Interpreter;
use super::names::Names;
use super::read_error::ReadError;
use super::state::Known;
use crate::machine::{Machine, frames};
use crate::setup::Setup;

/// Bodies that come nearer than this count as meeting, mm: they are described by hand, and machines do not hold thermal growth.
pub const CLEARANCE_MM: f64 = 1.0;
/// A distance is known when its bounds are within this share of each other.
const SHARE: f64 = 0.05;
/// Pieces of a way turn by this at most, rad: what a bend is off the parabola through its ends and middle is then a hundredth of it.
const PIECE_RAD: f64 = 0.05;
/// Pieces of a block at most: 200 turns.
const MOST_PIECES: f64 = 25_000.0;
/// What stays clear by less than this, mm, is not looked at more finely: it counts as meeting.
const FINE_MM: f64 = 0.01;
/// Halvings of a piece at most.
const MOST_HALVINGS: u32 = 24;

/// Something that stands on the table: the part, what holds it, its raw material.
#[derive(Clone, Debug)]
pub struct Standing {
    /// Its name.
    pub name: String,
    /// Its shape, in the part's frame.
    pub shape: Crowd,
}

/// A tool as the spindle holds it.
#[derive(Clone, Debug)]
pub struct InSpindle {
    /// Its number; none where the program is to be taken as having one tool.
    pub number: Option<u32>,
    /// Cutter and holder, the tip at the origin and the axis along z.
    pub shape: Crowd,
}

/// Two bodies that come too near to each other.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Meeting {
    /// The body of the head, or the tool.
    pub mover: String,
    /// What it comes near to.
    pub other: String,
    /// Of what stands on the table, its place in the list.
    pub standing: Option<usize>,
    /// The first block in which they do: its line, from 1.
    pub line: usize,
    /// In how many blocks they do.
    pub blocks: usize,
    /// How near they come where it was measured, mm; zero where they touch.
    pub least_mm: f64,
}

/// What came of a look at a text.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct Meetings {
    /// Every pair that comes too near, by line.
    pub found: Vec<Meeting>,
    /// Pairs of bodies that were looked at.
    pub pairs: usize,
}

/// Looks at a text for the machine that it was read for: the bodies of the head against those of table and bed and what stands on the
/// table, and each tool against the bodies of table and bed. Lengths are those of [`super::readback::read_tools`].
///
/// # Errors
/// As [`super::readback::read()`].
pub fn meetings(
    text: &str,
    dialect: Dialect,
    machine: &Machine,
    (setup, lengths_mm): (&Setup, &[(u32, f64)]),
    (standing, tools): (&[Standing], &[InSpindle]),
    strict: bool,
) -> Result<(Meetings, Vec<Diagnostic>), ReadError> {
    setup.check()?;
    let mut names = Names::new(dialect, machine);
    text.lines().for_each(|line| names.line(line));
    let follow = Follow::new(machine, setup, (standing, tools));
    let pairs = follow.pairs.len();
    let mut control = Interpreter::new(names.dialect(), Frame { machine, setup }, strict, follow);
    control.lengths = lengths_mm.to_vec();
    control.rest_unnamed(names.all());
    let mut flow = Flow::new(names.dialect(), names.kept());
    for (k, line) in text.lines().enumerate() {
        let mut run = |number: usize, text: &str| control.text_line(number, text);
        if flow.line(k + 1, line, &mut run)? {
            break;
        }
    }
    control.end()?;
    let mut found: Vec<Meeting> = control.sink.pairs.into_iter().filter_map(|p| p.found).collect();
    found.sort_by_key(|m| m.line);
    Ok((Meetings { found, pairs }, control.diagnostics))
}

/// Something that is looked at, and the frame that it stands still in.
#[derive(Clone, Copy)]
struct Side<'a> {
    name: &'a str,
    shape: &'a Crowd,
    frame: usize,
    /// In that frame.
    place: Isometry3<f64>,
    /// A tool hangs below the gauge point by its length.
    hangs: bool,
}

/// Two bodies, and what is known of their distance.
struct Pair<'a> {
    head: Side<'a>,
    other: Side<'a>,
    /// The place of `other` in the list of what stands on the table.
    standing: Option<usize>,
    /// The tool that it is about: none where it is about the head, or about the only tool.
    tool: Option<u32>,
    corners: [Point3; 8],
    /// Where the head's was, seen from the other, when they were last measured, and how far apart they were at least.
    measured: Option<(Isometry3<f64>, f64)>,
    found: Option<Meeting>,
}

type Frames = [Isometry3<f64>; crate::machine::MAX_JOINTS + 1];

/// Where all joints stand.
#[derive(Clone, Copy)]
struct Stand {
    frames: Frames,
    gauge_mm: f64,
}

impl Stand {
    fn at(frame: Frame<'_>, known: &Known) -> Option<Self> {
        let joints = frame.at_nose(known)?;
        let gauge_mm = frame.setup.gauge_length_mm;
        Some(Self { frames: frames(frame.machine.joints(), &joints), gauge_mm })
    }

    /// A side in the table's frame.
    fn of(&self, side: &Side<'_>) -> Isometry3<f64> {
        let below_mm = if side.hangs { self.gauge_mm } else { 0.0 };
        self.frames[side.frame] * side.place * Translation3::new(0.0, 0.0, -below_mm)
    }
}

impl Pair<'_> {
    /// The head's, seen from the other.
    fn seen(&self, stand: &Stand) -> Isometry3<f64> {
        stand.of(&self.other).inverse() * stand.of(&self.head)
    }

    /// How far a corner is at most from where it is at another placing.
    fn stray(&self, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        self.corners.iter().map(|c| (a * c - b * c).norm()).fold(0.0, f64::max)
    }

    /// How far the middle of a way is off the straight between its ends, at most.
    fn bend(&self, ends: [&Isometry3<f64>; 2], middle: &Isometry3<f64>) -> f64 {
        let off = |c: &Point3| {
            let straight = ((ends[0] * c).coords + (ends[1] * c).coords) * 0.5;
            ((middle * c).coords - straight).norm()
        };
        self.corners.iter().map(off).fold(0.0, f64::max)
    }

    fn measure(&mut self, at: &Isometry3<f64>) -> f64 {
        let apart = self.other.shape.apart(self.head.shape, at, SHARE, f64::INFINITY);
        self.measured = Some((*at, apart.least_mm));
        apart.least_mm
    }

    /// None where they stay clear between two stands; else how near they come where it was measured. `stand` gives what stands between.
    fn nearest(
        &mut self,
        stand: &dyn Fn(f64) -> Stand,
        (from, a): (f64, &Isometry3<f64>),
        (to, b): (f64, &Isometry3<f64>),
        left: u32,
    ) -> Option<f64> {
        let half = 0.5 * (from + to);
        let middle = self.seen(&stand(half));
        let bend = 2.0 * self.bend([a, b], &middle);
        if let Some((at, free_mm)) = self.measured
            && free_mm - self.stray(&at, a).max(self.stray(&at, b)) - bend >= CLEARANCE_MM
        {
            return None;
        }
        let free_mm = self.measure(a);
        if free_mm < CLEARANCE_MM {
            return Some(free_mm);
        }
        let stray = self.stray(a, b) + bend;
        if free_mm - stray >= CLEARANCE_MM {
            return None;
        }
        if left == 0 || stray < FINE_MM {
            return Some(free_mm);
        }
        self.nearest(stand, (from, a), (half, &middle), left - 1)
            .or_else(|| self.nearest(stand, (half, &middle), (to, b), left - 1))
    }

    /// They come so near in a block.
    fn meet(&mut self, line: usize, least_mm: f64) {
        match &mut self.found {
            Some(found) => {
                found.blocks += 1;
                found.least_mm = found.least_mm.min(least_mm);
            }
            None => {
                let (mover, other) = (self.head.name.to_owned(), self.other.name.to_owned());
                self.found =
                    Some(Meeting { mover, other, standing: self.standing, line, blocks: 1, least_mm });
            }
        }
    }
}

/// Follows a text.
struct Follow<'a> {
    pairs: Vec<Pair<'a>>,
}

impl<'a> Follow<'a> {
    fn new(
        machine: &'a Machine,
        setup: &Setup,
        (standing, tools): (&'a [Standing], &'a [InSpindle]),
    ) -> Self {
        let still = |name: &'a str, shape: &'a Crowd, frame| Side {
            name,
            shape,
            frame,
            place: Isometry3::identity(),
            hangs: false,
        };
        let on_part = |s: &'a Standing| Side { place: setup.part_zero, ..still(&s.name, &s.shape, 0) };
        let (head, rest): (Vec<_>, Vec<_>) = machine.bodies().iter().partition(|b| b.of_head);
        let spindle = machine.joints().len();
        let upright =
            nalgebra::UnitQuaternion::rotation_between(&nalgebra::Vector3::z(), &machine.tool_axis())
                .unwrap_or_else(|| {
                    nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::x() * std::f64::consts::PI)
                });
        let mut pairs = Vec::new();
        let mut add = |head: Side<'a>, other: Side<'a>, standing: Option<usize>, tool: Option<u32>| {
            let Convex::Hull(corners) = Convex::cuboid(head.shape.bounds()) else { return };
            let Ok(corners) = <[Point3; 8]>::try_from(corners) else { return };
            pairs.push(Pair { head, other, standing, tool, corners, measured: None, found: None });
        };
        for body in &head {
            let own = still(&body.name, &body.shape, body.frame);
            for other in &rest {
                add(own, still(&other.name, &other.shape, other.frame), None, None);
            }
            for (k, s) in standing.iter().enumerate() {
                add(own, on_part(s), Some(k), None);
            }
        }
        for tool in tools {
            for other in &rest {
                let place = Isometry3::from_parts(Translation3::identity(), upright);
                let own = Side { place, hangs: true, ..still("tool or holder", &tool.shape, spindle) };
                add(own, still(&other.name, &other.shape, other.frame), None, tool.number);
            }
        }
        Self { pairs }
    }

    fn block(&mut self, frame: Frame<'_>, m: &Moved) {
        let stand = |t: f64| Stand::at(frame, &m.way.at(t));
        let Some(mut from) = stand(0.0) else { return };
        let pieces = (m.way.turned_rad() / PIECE_RAD).ceil().clamp(1.0, MOST_PIECES);
        let mut met = vec![false; self.pairs.len()];
        let mut k = 0.0;
        while k < pieces {
            let (a, b) = (k / pieces, (k + 1.0) / pieces);
            let Some(to) = stand(b) else { return };
            for (pair, met) in self.pairs.iter_mut().zip(&mut met) {
                if *met || pair.tool.is_some_and(|n| m.tool.is_some_and(|now| now != n)) {
                    continue;
                }
                let ends = [pair.seen(&from), pair.seen(&to)];
                // Joints that can stand at both ends of a piece this short can stand between.
                let between = |t: f64| stand(t).unwrap_or(from);
                if let Some(least_mm) = pair.nearest(&between, (a, &ends[0]), (b, &ends[1]), MOST_HALVINGS) {
                    *met = true;
                    pair.meet(m.line, least_mm);
                }
            }
            from = to;
            k += 1.0;
        }
    }
}

impl Sink for Follow<'_> {
    fn take(&mut self, frame: Frame<'_>, event: &Event<'_>) {
        match event {
            Event::Placed { line, known, tool, .. } => {
                let Some(stand) = Stand::at(frame, known) else { return };
                for pair in &mut self.pairs {
                    if pair.tool.is_some_and(|n| tool.is_some_and(|now| now != n)) {
                        continue;
                    }
                    let seen = pair.seen(&stand);
                    let least_mm = pair.measure(&seen);
                    if least_mm < CLEARANCE_MM {
                        pair.meet(*line, least_mm);
                    }
                }
            }
            Event::Moved(m) => self.block(frame, m),
            Event::Dwell(_) | Event::Path(_) | Event::Halt => {}
        }
    }
}
