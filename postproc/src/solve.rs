//! Inverse kinematics of a whole path: `machine.solve(&path, &setup, &options)`.
//!
//! 1. every CL point's candidates, with all limits applied, and branch and turn over the path ([`crate::sequence`]);
//! 2. the path again, a piece at a time, with the joints chosen ([`crate::choices`]);
//! 3. rewinds, where no continuous choice exists: away from the part along the tool, the rotary joints into their
//!    other turn or branch with the tip held at its place relative to the part, and back;
//! 4. linearisation ([`crate::linearize`]).

use std::ops::ControlFlow;

use osculate_geom::Diagnostic;
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};
use rayon::prelude::*;

use crate::choices::{Choice, Choices};
use crate::join::alike;
use crate::joint_path::{BlockKind, JointBlock, JointPath};
use crate::linearize::{Label, Liner, Placed, pose_between};
use crate::machine::{JointValues, Machine, angle_between, nearest_turn};
use crate::sequence::{Node, Search, Slots, all_turns};
use crate::setup::Setup;
use crate::solve_error::SolveError;
use crate::solve_options::{SolveOptions, check_options};
use crate::source::MoveSource;

/// CL moves that are worth a thread of their own.
const SHARE: usize = 2048;

/// CL moves that are held at a time.
const PIECE: usize = 8 * SHARE;

impl Machine {
    /// The path in joints.
    ///
    /// ```
    /// use osculate_postproc::{Machine, Setup, SolveError, SolveOptions, cldata};
    ///
    /// // The axis turns by 45 deg about X while the tip goes along X, 50 mm off the axis of A: A has to turn as much.
    /// let path = cldata::read("FEDRAT/600\nGOTO/0,50,0,0,0,1\nGOTO/10,50,0,0,-1,1\nFINI\n")?.path;
    /// let machine = Machine::built_in("trunnion-ac")?;
    /// let options = SolveOptions { tip_tol_mm: 0.01, ..SolveOptions::default() };
    /// let joints = machine.solve(&path, &Setup::default(), &options)?;
    /// let a = machine.joint_named("A").expect("it has one");
    /// let last = joints.blocks.last().expect("it moves").joints;
    /// assert!((last[a].abs().to_degrees() - 45.0).abs() < 1e-9);
    /// // Points are put in so that the tip keeps to its line.
    /// assert!(joints.summary.inserted_points > 0 && joints.summary.tip_error_mm <= 0.01);
    /// // A tool that comes from below is out of reach.
    /// let below = cldata::read("GOTO/0,0,0,0,0,-1\nFINI\n")?.path;
    /// let refused = machine.solve(&below, &Setup::default(), &SolveOptions::default());
    /// assert!(matches!(refused, Err(SolveError::Unreachable { index: 0, .. } | SolveError::Limit { index: 0, .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Where the input is no path, or the machine cannot run it; the error names the CL move and what to change.
    pub fn solve(
        &self,
        path: &ClPath,
        setup: &Setup,
        options: &SolveOptions,
    ) -> Result<JointPath, SolveError> {
        self.solve_from(path, setup, options)
    }

    /// As [`Machine::solve`], from any source of moves.
    pub(crate) fn solve_from<S: MoveSource, E: From<SolveError> + From<S::Error>>(
        &self,
        source: &S,
        setup: &Setup,
        options: &SolveOptions,
    ) -> Result<JointPath, E> {
        let mut whole = JointPath::default();
        let solved = self.solve_pieces(source, setup, options, |blocks| {
            whole.blocks.extend_from_slice(blocks);
            Ok::<(), E>(())
        })?;
        Ok(JointPath { blocks: whole.blocks, ..solved })
    }

    /// As [`Machine::solve`], with the blocks given to `take` piece by piece; the answer has none. What is held at a
    /// time does not grow with the path, except for the places where branches and turns meet ([`crate::sequence`]).
    pub(crate) fn solve_pieces<S: MoveSource, E: From<SolveError> + From<S::Error>>(
        &self,
        source: &S,
        setup: &Setup,
        options: &SolveOptions,
        mut take: impl FnMut(&[JointBlock]) -> Result<(), E>,
    ) -> Result<JointPath, E> {
        setup.check().map_err(SolveError::from)?;
        check_options(options)?;
        let slots = search::<S, E>(self, source, setup, options)?;
        let choices = Choices::new(self, setup, (&slots, options.singular_cone_rad));
        let mut solver = Solver {
            machine: self,
            setup,
            options,
            choices,
            last: None,
            index: 0,
            sum: JointPath::default(),
        };
        each_piece(source, |moves| solver.piece(moves, &mut take))?;
        Ok(solver.sum)
    }
}

/// Goes over the moves in pieces; the first failure ends it.
fn each_piece<S: MoveSource, E: From<S::Error>>(
    source: &S,
    mut take: impl FnMut(&[ClMove]) -> Result<(), E>,
) -> Result<(), E> {
    let mut failed = None;
    source.pieces(PIECE, &mut |moves| match take(moves) {
        Ok(()) => ControlFlow::Continue(()),
        Err(e) => {
            failed = Some(e);
            ControlFlow::Break(())
        }
    })?;
    failed.map_or(Ok(()), Err)
}

/// The second time over the path.
struct Solver<'a> {
    machine: &'a Machine,
    setup: &'a Setup,
    options: &'a SolveOptions,
    choices: Choices<'a>,
    /// Where the piece before has ended.
    last: Option<(ClMove, Choice)>,
    /// Moves in the pieces before.
    index: usize,
    sum: JointPath,
}

impl Solver<'_> {
    fn liner(&self) -> Liner<'_> {
        Liner { machine: self.machine, setup: self.setup, options: self.options, path: JointPath::default() }
    }

    fn piece<E: From<SolveError>>(
        &mut self,
        moves: &[ClMove],
        take: &mut impl FnMut(&[JointBlock]) -> Result<(), E>,
    ) -> Result<(), E> {
        let Some(end) = moves.last() else { return Ok(()) };
        let mut chosen = self.choices.next_piece(moves);
        let last = self.last.replace((*end, chosen[moves.len() - 1]));
        // The first move of a piece starts where the piece before has ended.
        let mut joined = Vec::new();
        let (first, moves) = match last {
            Some((m, choice)) => {
                chosen.insert(0, choice);
                joined.reserve(moves.len() + 1);
                joined.push(m);
                joined.extend_from_slice(moves);
                (self.index - 1, &joined[..])
            }
            None => {
                let mut liner = self.liner();
                start(&mut liner, &moves[0], &chosen[0])?;
                let path = liner.path;
                take(&path.blocks)?;
                self.sum.append_report(path);
                (0, moves)
            }
        };
        self.index = first + moves.len();
        let run = Run { moves, first, choices: &chosen };
        // Every move depends on the choices at its two ends alone; pieces are put together in order.
        let count = chosen.len() - 1;
        let shares: Vec<usize> = (0..count).step_by(SHARE).collect();
        let this = &*self;
        let solved: Vec<Result<JointPath, SolveError>> = shares
            .into_par_iter()
            .map(|from| {
                let mut liner = this.liner();
                liner.path.blocks.reserve(SHARE);
                run.moves(&mut liner, from..(from + SHARE).min(count))?;
                Ok(liner.path)
            })
            .collect();
        for share in solved {
            let share = share?;
            take(&share.blocks)?;
            self.sum.append_report(share);
        }
        Ok(())
    }
}

/// Branch and turn of every point.
fn search<S: MoveSource, E: From<SolveError> + From<S::Error>>(
    machine: &Machine,
    source: &S,
    setup: &Setup,
    options: &SolveOptions,
) -> Result<Slots, E> {
    let mut search = Search::new(machine, options.singular_cone_rad);
    let mut nodes: Vec<Result<Node, SolveError>> = Vec::new();
    let mut index = 0;
    each_piece(source, |moves| {
        // In parallel, merged in order: the first error is that of the first move that has one.
        moves
            .par_iter()
            .enumerate()
            .with_min_len(SHARE)
            .map(|(i, m)| node(machine, setup, options, index + i, m))
            .collect_into_vec(&mut nodes);
        for node in nodes.drain(..) {
            search.add(node?);
        }
        index += moves.len();
        Ok::<(), E>(())
    })?;
    if index == 0 {
        return Err(SolveError::Empty.into());
    }
    Ok(search.finish())
}

/// A piece of a path with everything chosen.
struct Run<'a> {
    moves: &'a [ClMove],
    /// The CL move of the first choice.
    first: usize,
    choices: &'a [Choice],
}

impl Run<'_> {
    /// The blocks of the moves behind these choices.
    fn moves(&self, liner: &mut Liner, range: std::ops::Range<usize>) -> Result<(), SolveError> {
        let mut at = self.placed(liner, range.start)?;
        // Moves up to the last of those that are alike may become one.
        let (mut i, mut last) = (range.start, range.start);
        while i < range.end {
            let mut joined = None;
            if liner.options.join {
                if last <= i {
                    let rest = i + 1..range.end + 1;
                    last = i + alike(&at, &self.moves[rest.clone()], &self.choices[rest]).max(1);
                }
                let next = i + 1..last + 1;
                joined = liner.join(
                    &at,
                    (&self.moves[next.clone()], &self.choices[next.clone()]),
                    self.first + next.start,
                )?;
            }
            (at, i) = match joined {
                Some((to, count)) => (to, i + count),
                None => (self.move_to(liner, &at, i + 1)?, i + 1),
            };
        }
        Ok(())
    }

    fn placed(&self, liner: &Liner, i: usize) -> Result<Placed, SolveError> {
        let index = self.first + i;
        let pose = self.moves[i].pose;
        let joints = liner.checked(&self.choices[i].rotary_rad, &pose, index)?;
        Ok(Placed { pose, joints })
    }

    /// The blocks of one CL move; where it ends.
    fn move_to(&self, liner: &mut Liner, from: &Placed, i: usize) -> Result<Placed, SolveError> {
        let m = &self.moves[i];
        let to = self.placed(liner, i)?;
        let label =
            Label { motion: m.motion, aloft: m.aloft, source: self.first + i, kind: BlockKind::Point };
        let mut at = *from;
        if self.choices[i].rewind {
            at = rewind(liner, &at, &to, &self.choices[i], &label)?;
        }
        let turns = angle_between(&at.pose.axis, &m.pose.axis) > 1e-9;
        let singular = self.choices[i - 1].singular || self.choices[i].singular;
        if turns && m.motion != Motion::Rapid && singular {
            liner.path.summary.singular_mm += (m.pose.tip - at.pose.tip).norm();
        }
        liner.line(&at, &to, &label)?;
        Ok(to)
    }
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
    let rapid = m.motion == Motion::Rapid;
    let mut node = Node { states: Vec::new(), axis: table.axis, singular, rapid };
    if singular {
        return Ok(node);
    }
    // The limit that is missed by least, and the value; put into words only where nothing else is left.
    let mut nearest: Option<(f64, Option<(usize, f64)>)> = None;
    let mut offer = |excess: f64, at: Option<(usize, f64)>| {
        if nearest.as_ref().is_none_or(|(e, _)| excess < *e) {
            nearest = Some((excess, at));
        }
    };
    let states = all_turns(machine, &found);
    for candidate in found.candidates() {
        if states.iter().all(|s| s.branch != candidate.branch) {
            for (slot, &place) in machine.rotary().iter().enumerate() {
                let q = candidate.rotary_rad[slot];
                let excess = machine.joint_at(place).excess(q);
                if excess > 0.0 {
                    offer(excess, Some((place, q)));
                }
            }
        }
        for state in states.iter().filter(|s| s.branch == candidate.branch) {
            let Some(joints) = machine.with_tip(&state.rotary_rad, &table.tip, setup.gauge_length_mm) else {
                offer(f64::MAX, None);
                continue;
            };
            match machine.out_of_limits(&joints, setup.gauge_length_mm) {
                None => node.states.push(*state),
                Some(out) => offer(out.by, Some((out.place, out.at))),
            }
        }
    }
    match nearest {
        Some((_, at)) if node.states.is_empty() => Err(at.map_or_else(
            || SolveError::flat(index, &m.pose),
            |out| SolveError::limit(machine, index, &m.pose, out),
        )),
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
    let rapid = Label { motion: Motion::Rapid, aloft: true, source: index, kind: BlockKind::Rewind };
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
