//! Inverse kinematics of a whole path: `machine.solve(&path, &setup, &options)`.
//!
//! 1. every CL point's candidates, with all limits applied;
//! 2. branch and turn over the path ([`crate::sequence`]);
//! 3. rewinds, where no continuous choice exists: away from the part along the tool, the rotary joints into their
//!    other turn or branch with the tip held at its place relative to the part, and back;
//! 4. linearisation ([`crate::linearize`]).

use osculate_geom::{Diagnostic, Point3};
use osculate_tools::cl::{ClPath, Motion};
use osculate_tools::{Pose, cl::ClMove};
use rayon::prelude::*;

use crate::joint_path::{BlockKind, JointBlock, JointPath};
use crate::linearize::{Label, Liner, Placed, pose_between};
use crate::machine::{AxisUnreachable, JointValues, Machine, angle_between, nearest_turn};
use crate::sequence::{self, Choice, Node};
use crate::setup::{Setup, SetupError};

/// How a path is to be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveOptions {
    /// The control keeps the tip on its line (tool-centre-point control).
    pub tcp: bool,
    /// How far the tip may leave the CL line in feed moves, mm.
    pub tip_tol_mm: f64,
    /// How far the axis may leave the CL's in feed moves, rad.
    pub axis_tol_rad: f64,
    /// How far the tip may leave its line in rapid moves, mm.
    pub rapid_tol_mm: f64,
    /// Within this angle of a pole the outer rotary joint is held and the axis errs by at most this, rad.
    pub singular_cone_rad: f64,
    /// How far the tool leaves the part along its axis for a rewind, mm.
    pub rewind_retract_mm: f64,
}

impl Default for SolveOptions {
    /// No tool-centre-point control; 2 um and 0.02 deg, held within 0.005 deg of a pole; rapids within 0.1 mm;
    /// rewinds 50 mm away from the part.
    fn default() -> Self {
        Self {
            tcp: false,
            tip_tol_mm: 0.002,
            axis_tol_rad: 0.02f64.to_radians(),
            rapid_tol_mm: 0.1,
            singular_cone_rad: 0.005f64.to_radians(),
            rewind_retract_mm: 50.0,
        }
    }
}

/// Why a path cannot be run on a machine. `index` counts CL moves from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// Nothing to do.
    #[error("the path has no moves")]
    Empty,
    /// The setup is none.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// An option that makes no sense.
    #[error("solve option {what} is {value}: it must be a finite number {wanted}")]
    Option {
        /// The option.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        wanted: &'static str,
    },
    /// A pose or feed is not finite, or a feed is not positive.
    #[error("CL move {index}: a coordinate or feed is not a finite number, or the feed is not above zero")]
    NotFinite {
        /// The move.
        index: usize,
    },
    /// The rotary joints cannot point the tool so.
    #[error(
        "CL move {index}: the tool axis ({:.6}, {:.6}, {:.6}) at ({:.3}, {:.3}, {:.3}) is {off_deg:.4} deg outside of \
         what the machine's rotary joints reach: turn the part in its setup or change lead and tilt",
        axis[0], axis[1], axis[2], tip.x, tip.y, tip.z
    )]
    Unreachable {
        /// The move.
        index: usize,
        /// The tip, part frame.
        tip: Point3,
        /// The axis, part frame.
        axis: [f64; 3],
        /// Angle to what can be reached.
        off_deg: f64,
    },
    /// Every way to reach a pose leaves a joint's range.
    #[error(
        "CL move {index}: at ({:.3}, {:.3}, {:.3}) joint {joint} would be at {value:.4} {unit}, its range is {min:.4} to \
         {max:.4} {unit}: move or turn the part in its setup, or change lead and tilt",
        tip.x, tip.y, tip.z
    )]
    Limit {
        /// The move.
        index: usize,
        /// The tip, part frame.
        tip: Point3,
        /// The joint that is out by least.
        joint: String,
        /// Where it would be.
        value: f64,
        /// mm or deg.
        unit: &'static str,
        /// Smallest value; `-inf` without limit.
        min: f64,
        /// Largest value; `inf` without limit.
        max: f64,
    },
    /// The linear joints cannot move the tip in all directions.
    #[error("CL move {index}: the linear joints lie in one plane here, the tip at ({:.3}, {:.3}, {:.3}) cannot be held", tip.x, tip.y, tip.z)]
    Flat {
        /// The move.
        index: usize,
        /// The tip, part frame.
        tip: Point3,
    },
    /// The joints would have to jump.
    #[error(
        "CL move {index}: the rotary joints would jump by {rotary_deg:.3} deg (tip off by {tip_mm:.4} mm, axis by \
         {axis_deg:.4} deg): widen the tolerances or the singular cone, or turn the part in its setup"
    )]
    Jump {
        /// The move.
        index: usize,
        /// Tip deviation left.
        tip_mm: f64,
        /// Axis deviation left.
        axis_deg: f64,
        /// Rotary step.
        rotary_deg: f64,
    },
    /// A rewind is needed and no point of the move allows both turns.
    #[error(
        "CL move {index}: the rotary joints must be rewound, and nowhere on this move both turns are inside the \
         limits: turn the part in its setup, or choose a machine with a wider range"
    )]
    NoRewind {
        /// The move.
        index: usize,
    },
}

/// CL moves that are worth a thread of their own.
const LEAST_SHARE: usize = 2048;

impl SolveError {
    pub(crate) fn unreachable(index: usize, pose: &Pose, e: AxisUnreachable) -> Self {
        let axis = [pose.axis.x, pose.axis.y, pose.axis.z];
        Self::Unreachable { index, tip: pose.tip, axis, off_deg: e.off_rad.to_degrees() }
    }

    pub(crate) fn limit(machine: &Machine, index: usize, pose: &Pose, place: usize, value: f64) -> Self {
        let joint = machine.joint_at(place);
        Self::Limit {
            index,
            tip: pose.tip,
            joint: joint.letter.clone(),
            value: joint.shown(value),
            unit: joint.unit(),
            min: joint.min.map_or(f64::NEG_INFINITY, |m| joint.shown(m)),
            max: joint.max.map_or(f64::INFINITY, |m| joint.shown(m)),
        }
    }

    pub(crate) const fn flat(index: usize, pose: &Pose) -> Self {
        Self::Flat { index, tip: pose.tip }
    }
}

impl Machine {
    /// The path in joints.
    ///
    /// # Errors
    /// Where the input is no path, or the machine cannot run it; the error names the CL move and what to change.
    pub fn solve(
        &self,
        path: &ClPath,
        setup: &Setup,
        options: &SolveOptions,
    ) -> Result<JointPath, SolveError> {
        setup.check()?;
        check_options(options)?;
        if path.moves.is_empty() {
            return Err(SolveError::Empty);
        }
        // In parallel, merged in order: the first error is that of the first move that has one.
        let nodes: Vec<Result<Node, SolveError>> = path
            .moves
            .par_iter()
            .enumerate()
            .with_min_len(LEAST_SHARE)
            .map(|(index, m)| node(self, setup, options, index, m))
            .collect();
        let nodes = nodes.into_iter().collect::<Result<Vec<Node>, _>>()?;
        let choices = sequence::choose(self, &nodes, options.singular_cone_rad);
        let mut liner = Liner { machine: self, setup, options, path: JointPath::default() };
        start(&mut liner, &path.moves[0], &choices[0])?;
        let run = Run { path, nodes: &nodes, choices: &choices };
        // Every move depends on the choices at its two ends alone; pieces are put together in order.
        let indices: Vec<usize> = (1..path.moves.len()).collect();
        let pieces: Vec<Result<JointPath, SolveError>> = indices
            .par_chunks(LEAST_SHARE)
            .map(|part| {
                let mut liner = Liner { machine: self, setup, options, path: JointPath::default() };
                liner.path.blocks.reserve(part.len());
                for &index in part {
                    run.move_to(&mut liner, index)?;
                }
                Ok(liner.path)
            })
            .collect();
        for piece in pieces {
            liner.path.append(piece?);
        }
        Ok(liner.path)
    }
}

/// A path with everything chosen.
struct Run<'a> {
    path: &'a ClPath,
    nodes: &'a [Node],
    choices: &'a [Choice],
}

impl Run<'_> {
    /// The blocks of one CL move.
    fn move_to(&self, liner: &mut Liner, index: usize) -> Result<(), SolveError> {
        let (before, m) = (&self.path.moves[index - 1], &self.path.moves[index]);
        let placed = |liner: &Liner, index: usize, m: &ClMove| {
            let joints = liner.checked(&self.choices[index].rotary_rad, &m.pose, index)?;
            Ok::<_, SolveError>(Placed { pose: m.pose, joints })
        };
        let mut at = placed(liner, index - 1, before)?;
        let to = placed(liner, index, m)?;
        let label = Label { motion: m.motion, source: index, kind: BlockKind::Point };
        if self.choices[index].rewind {
            at = rewind(liner, &at, &to, &self.choices[index], &label)?;
        }
        let turns = angle_between(&at.pose.axis, &m.pose.axis) > 1e-9;
        let singular = self.nodes[index - 1].singular || self.nodes[index].singular;
        if turns && m.motion != Motion::Rapid && singular {
            liner.path.summary.singular_mm += (m.pose.tip - at.pose.tip).norm();
        }
        liner.line(&at, &to, &label)
    }
}

fn check_options(o: &SolveOptions) -> Result<(), SolveError> {
    let above =
        [("tip_tol_mm", o.tip_tol_mm), ("axis_tol_rad", o.axis_tol_rad), ("rapid_tol_mm", o.rapid_tol_mm)];
    for (what, value) in above {
        if !(value.is_finite() && value > 0.0) {
            return Err(SolveError::Option { what, value, wanted: "above zero" });
        }
    }
    if !(o.rewind_retract_mm.is_finite() && o.rewind_retract_mm >= 0.0) {
        let (what, value) = ("rewind_retract_mm", o.rewind_retract_mm);
        return Err(SolveError::Option { what, value, wanted: "not below zero" });
    }
    let value = o.singular_cone_rad;
    if !(value >= 0.0 && value <= o.axis_tol_rad) {
        return Err(SolveError::Option {
            what: "singular_cone_rad",
            value,
            wanted: "from zero to axis_tol_rad",
        });
    }
    Ok(())
}

fn node(
    machine: &Machine,
    setup: &Setup,
    options: &SolveOptions,
    index: usize,
    m: &ClMove,
) -> Result<Node, SolveError> {
    let feed_ok = match m.motion {
        Motion::Rapid => true,
        Motion::Feed(f) => f.is_finite() && f > 0.0,
    };
    let unit = (m.pose.axis.norm() - 1.0).abs() < 1e-6;
    if !(feed_ok && unit && m.pose.tip.iter().all(|c| c.is_finite())) {
        return Err(SolveError::NotFinite { index });
    }
    let table = setup.to_table(&m.pose);
    let found = machine.orientations(&table.axis).map_err(|e| SolveError::unreachable(index, &m.pose, e))?;
    let singular = found.pole_rad <= options.singular_cone_rad;
    let mut node = Node { states: Vec::new(), axis: table.axis, singular, motion: m.motion };
    if singular {
        return Ok(node);
    }
    let mut nearest: Option<(f64, SolveError)> = None;
    let mut offer = |excess: f64, error: SolveError| {
        if nearest.as_ref().is_none_or(|(e, _)| excess < *e) {
            nearest = Some((excess, error));
        }
    };
    for candidate in found.candidates() {
        let states = sequence::turns(machine, candidate);
        if states.is_empty() {
            for (slot, &place) in machine.rotary().iter().enumerate() {
                let q = candidate.rotary_rad[slot];
                let excess = machine.joint_at(place).excess(q);
                if excess > 0.0 {
                    offer(excess, SolveError::limit(machine, index, &m.pose, place, q));
                }
            }
        }
        for state in states {
            let Some(joints) = machine.with_tip(&state.rotary_rad, &table.tip, setup.gauge_length_mm) else {
                offer(f64::MAX, SolveError::flat(index, &m.pose));
                continue;
            };
            match machine.out_of_limits(&joints) {
                None => node.states.push(state),
                Some((place, excess)) => {
                    offer(excess, SolveError::limit(machine, index, &m.pose, place, joints[place]));
                }
            }
        }
    }
    match nearest {
        Some((_, error)) if node.states.is_empty() => Err(error),
        _ => Ok(node),
    }
}

fn start(liner: &mut Liner, first: &ClMove, choice: &Choice) -> Result<(), SolveError> {
    let joints = liner.checked(&choice.rotary_rad, &first.pose, 0)?;
    if first.motion != Motion::Rapid {
        let text = "the first CL move leads from an unknown place and is run as a rapid move";
        liner.path.diagnostics.push(Diagnostic::warning("CL move 0", text));
    }
    liner.path.blocks.push(JointBlock {
        joints,
        tip: first.pose.tip,
        motion: Motion::Rapid,
        source: 0,
        tip_length_mm: 0.0,
        kind: BlockKind::Point,
    });
    Ok(())
}

/// Leaves the part, changes turn or branch, returns; afterwards the tool stands at a point of the move from `at` to
/// `to` in the configuration of `to`.
fn rewind(
    liner: &mut Liner,
    at: &Placed,
    to: &Placed,
    choice: &Choice,
    label: &Label,
) -> Result<Placed, SolveError> {
    let machine = liner.machine;
    let index = label.source;
    let (old, new) = (machine.rotary_of(&at.joints), choice.rotary_rad);
    let old_branch = nearest_branch(liner, at, &old);
    let t = rewind_place(liner, at, to, (old, old_branch), (new, choice.branch));
    let t = t.ok_or(SolveError::NoRewind { index })?;
    let pose = pose_between(&at.pose, &to.pose, t);
    let none = SolveError::NoRewind { index };
    let before = configured(liner, &pose, &old, old_branch).ok_or_else(|| none.clone())?;
    let after = configured(liner, &pose, &new, choice.branch).ok_or(none)?;
    let before = Placed { pose, joints: before };
    let after = Placed { pose, joints: after };
    if t > 0.0 {
        liner.line(at, &before, &Label { kind: BlockKind::Inserted, ..*label })?;
    }
    let away = pose.retracted(liner.options.rewind_retract_mm);
    let rapid = Label { motion: Motion::Rapid, source: index, kind: BlockKind::Rewind };
    let out = Placed { pose: away, joints: liner.checked(&machine.rotary_of(&before.joints), &away, index)? };
    let back = Placed { pose: away, joints: liner.checked(&machine.rotary_of(&after.joints), &away, index)? };
    liner.line(&before, &out, &rapid)?;
    liner.line(&out, &back, &rapid)?;
    liner.line(&back, &after, &Label { kind: BlockKind::Rewind, ..*label })?;
    liner.path.summary.rewinds += 1;
    let deg = (new[0] - old[0]).to_degrees();
    liner.path.diagnostics.push(Diagnostic::warning(
        format!("CL move {index}"),
        format!(
            "rewind: the tool leaves the part by {} mm, the outer rotary joint turns by {deg:.3} deg",
            liner.options.rewind_retract_mm
        ),
    ));
    Ok(after)
}

/// The branch in which the joints stand.
fn nearest_branch(liner: &Liner, at: &Placed, rotary: &[f64; 2]) -> usize {
    let axis = liner.setup.to_table(&at.pose).axis;
    let off = |c: &crate::machine::Candidate| {
        (0..2).map(|k| (nearest_turn(c.rotary_rad[k], rotary[k]) - rotary[k]).abs()).sum::<f64>()
    };
    let Ok(found) = liner.machine.orientations(&axis) else { return 0 };
    found.candidates().iter().min_by(|a, b| off(a).total_cmp(&off(b))).map_or(0, |c| c.branch)
}

/// Joints at `pose` in the given branch and in the turn nearest to `near`; `None` outside of the limits.
fn configured(liner: &Liner, pose: &Pose, near: &[f64; 2], branch: usize) -> Option<JointValues> {
    let axis = liner.setup.to_table(pose).axis;
    let found = liner.machine.orientations(&axis).ok()?;
    let mut q = found.candidates().iter().find(|c| c.branch == branch)?.rotary_rad;
    for k in 0..liner.machine.rotary().len() {
        q[k] = nearest_turn(q[k], near[k]);
    }
    liner.checked(&q, pose, 0).ok()
}

/// Where on the move both configurations are inside the limits: at its start if possible, else as late as the old one
/// allows.
fn rewind_place(
    liner: &Liner,
    at: &Placed,
    to: &Placed,
    old: ([f64; 2], usize),
    new: ([f64; 2], usize),
) -> Option<f64> {
    let ok = |t: f64, c: &([f64; 2], usize)| {
        configured(liner, &pose_between(&at.pose, &to.pose, t), &c.0, c.1).is_some()
    };
    if ok(0.0, &new) {
        return Some(0.0);
    }
    if !ok(0.0, &old) {
        return None;
    }
    let (mut inside, mut outside) = (0.0, 1.0);
    if ok(1.0, &old) {
        inside = 1.0;
    } else {
        // 50 halvings: to the rounding of t.
        for _ in 0..50 {
            let t = 0.5 * (inside + outside);
            if ok(t, &old) { inside = t } else { outside = t }
        }
    }
    // The new turn opens where the old one closes; a hair later where rounding of t lies between.
    [inside, outside].into_iter().find(|&t| ok(t, &new) && ok(t, &old))
}
