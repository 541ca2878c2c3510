//! Keeping the tool on its line: blocks are halved until the control's own interpolation is near enough.
//!
//! Between two CL points the tip moves on a straight line and the axis on a great circle. A control interpolates the
//! joints linearly instead; with tool-centre-point control it keeps the tip on the line and only the axis strays.
//! A block is accepted where neither the tip nor the axis strays by more than its tolerance at seven inner points and
//! the end; of the tip's what goes towards the part, where it is known how far from its axis the tool touches it.
//! The deviation of one block is close to a parabola, so the inner points see at least 98 % of its height.
//! Short blocks are looked at in the middle and at the end only: where rotary joints turn by less than [`SHORT_RAD`]
//! and a quarter of the tolerance is used there, a curve with four times as much elsewhere does not exist.

use nalgebra::Vector3;
use osculate_geom::{Unit3, any_perpendicular};
use osculate_tools::{Pose, cl::Motion};

use crate::joint_path::{BlockKind, JointBlock, JointPath};
use crate::machine::{JointValues, Machine, NearWish, angle_between};
use crate::setup::Setup;
use crate::solve_error::SolveError;
use crate::solve_options::SolveOptions;

/// Rotary joints never move further in one block, rad. Controls that take the shortest way need less than half a turn.
pub(crate) const LARGEST_ROTARY_STEP_RAD: f64 = 0.5 * std::f64::consts::PI;

/// Parts per block at which the deviation is looked at.
const PARTS: u32 = 8;

/// Blocks that turn by less than this are parabolas to a part in a hundred, rad.
const SHORT_RAD: f64 = 0.1;

/// Halvings after which a block counts as a jump: 2^-24 of a CL move is far below any resolution.
const MOST_HALVINGS: u32 = 24;

/// Across the axis the tip may stray by this many times its tolerance, where no part of that goes towards the part.
const ACROSS: f64 = 4.0;

/// Blocks of one CL move at most. A metre with a tool that turns over at the finest tolerance in use has some thousands.
const MOST_PIECES: usize = 100_000;

/// The pose at parameter `t` of a CL move: straight tip, great circle of the axis.
pub(crate) fn pose_between(a: &Pose, b: &Pose, t: f64) -> Pose {
    Pose { tip: a.tip + (b.tip - a.tip) * t, axis: slerp(&a.axis, &b.axis, t) }
}

/// On the great circle from `a` to `b`; opposite axes go round by an arbitrary but fixed way.
pub(crate) fn slerp(a: &Unit3, b: &Unit3, t: f64) -> Unit3 {
    let angle = angle_between(a, b);
    // Below this the arc and its chord are the same number.
    if angle < 1e-9 {
        return Unit3::new_normalize(a.into_inner() * (1.0 - t) + b.into_inner() * t);
    }
    let across = Unit3::try_new(b.into_inner() - a.into_inner() * a.dot(b), 1e-9)
        .unwrap_or_else(|| any_perpendicular(a));
    let (s, c) = (angle * t).sin_cos();
    Unit3::new_normalize(a.into_inner() * c + across.into_inner() * s)
}

/// How much of what the tip strays by goes towards the part, mm, where the tool touches it at no more than `touch_rad` from its axis:
/// the most over all directions within that angle. Across the axis [`ACROSS`] times as much passes at most.
fn towards(off: &Vector3<f64>, axis: &Unit3, touch_rad: f64) -> f64 {
    let along = off.dot(axis).abs();
    let across = (off - axis.into_inner() * off.dot(axis)).norm();
    if across.atan2(along) <= touch_rad {
        return off.norm();
    }
    let (sin, cos) = touch_rad.sin_cos();
    (along * cos + across * sin).max(across / ACROSS)
}

/// How far a block strays.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(crate) struct Stray {
    pub tip_mm: f64,
    pub axis_rad: f64,
}

impl Stray {
    /// The worse of both.
    pub fn or(self, other: Self) -> Self {
        Self { tip_mm: self.tip_mm.max(other.tip_mm), axis_rad: self.axis_rad.max(other.axis_rad) }
    }

    pub fn within(&self, options: &SolveOptions) -> bool {
        self.tip_mm <= options.tip_tol_mm && self.axis_rad <= options.axis_tol_rad
    }

    /// As [`within`](Self::within), where the tool is off everything.
    fn within_aloft(&self, options: &SolveOptions) -> bool {
        let (tip_mm, axis_rad) = options.aloft_tol;
        self.tip_mm <= options.tip_tol_mm.max(tip_mm) && self.axis_rad <= options.axis_tol_rad.max(axis_rad)
    }
}

/// A pose with the joints chosen for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub pose: Pose,
    pub joints: JointValues,
}

/// What all blocks of a path have in common.
pub(crate) struct Liner<'a> {
    pub machine: &'a Machine,
    pub setup: &'a Setup,
    pub options: &'a SolveOptions,
    pub path: JointPath,
}

/// What all blocks of one line have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Label {
    pub motion: Motion,
    /// Whether the tool is off everything.
    pub aloft: bool,
    pub source: usize,
    pub kind: BlockKind,
}

impl Liner<'_> {
    /// Appends the blocks from `from` (where the path ends) to `to`.
    pub(crate) fn line(&mut self, from: &Placed, to: &Placed, label: &Label) -> Result<(), SolveError> {
        let most = self.path.blocks.len() + MOST_PIECES;
        self.part(&Line { from, to, label, most }, (0.0, from.joints), (1.0, to.joints), MOST_HALVINGS)
    }

    fn part(
        &mut self,
        line: &Line,
        a: (f64, JointValues),
        b: (f64, JointValues),
        left: u32,
    ) -> Result<(), SolveError> {
        let rapid = line.label.motion == Motion::Rapid;
        let stray = self.stray(line, a, b);
        let o = self.options;
        let near = match line.label {
            _ if rapid => stray.tip_mm <= o.rapid_tol_mm,
            Label { aloft: true, .. } => stray.within_aloft(o),
            _ => stray.within(o),
        };
        let (qa, qb) = (self.machine.rotary_of(&a.1), self.machine.rotary_of(&b.1));
        let turns = (0..2).map(|k| (qb[k] - qa[k]).abs()).fold(0.0, f64::max);
        if near && turns <= LARGEST_ROTARY_STEP_RAD {
            self.push(line, a.0, b, &stray);
            return Ok(());
        }
        if self.path.blocks.len() >= line.most {
            return Err(SolveError::Pieces { index: line.label.source, most: MOST_PIECES });
        }
        if left == 0 {
            return Err(SolveError::Jump {
                index: line.label.source,
                tip_mm: stray.tip_mm,
                axis_deg: stray.axis_rad.to_degrees(),
                rotary_deg: turns.to_degrees(),
            });
        }
        let t = 0.5 * (a.0 + b.0);
        let wish = [0.5 * (qa[0] + qb[0]), 0.5 * (qa[1] + qb[1])];
        let pose = pose_between(&line.from.pose, &line.to.pose, t);
        let middle = self.place(&pose, wish, rapid, line.label.source)?;
        self.part(line, a, (t, middle), left - 1)?;
        self.part(line, (t, middle), b, left - 1)
    }

    /// Joints for a pose in between. A rapid move keeps the tip only; its axis may go the joints' own way.
    fn place(
        &self,
        pose: &Pose,
        wish: [f64; 2],
        rapid: bool,
        index: usize,
    ) -> Result<JointValues, SolveError> {
        let table = self.setup.to_table(pose);
        let rotary = if rapid {
            wish
        } else {
            let wish = NearWish { rotary_rad: wish, cone_rad: self.options.singular_cone_rad };
            let found = self.machine.rotary_near(&table.axis, &wish);
            found.map_err(|e| SolveError::unreachable(index, pose, e))?
        };
        self.checked(&rotary, pose, index)
    }

    /// Joints for rotary joints and a pose whose tip they must hold, inside all limits.
    pub(crate) fn checked(
        &self,
        rotary: &[f64; 2],
        pose: &Pose,
        index: usize,
    ) -> Result<JointValues, SolveError> {
        let table = self.setup.to_table(pose);
        let joints = self.machine.with_tip(rotary, &table.tip, self.setup.gauge_length_mm);
        let joints = joints.ok_or_else(|| SolveError::flat(index, pose))?;
        match self.machine.out_of_limits(&joints, self.setup.gauge_length_mm) {
            None => Ok(joints),
            Some(out) => Err(SolveError::limit(self.machine, index, pose, (out.place, out.at))),
        }
    }

    fn stray(&self, line: &Line, a: (f64, JointValues), b: (f64, JointValues)) -> Stray {
        let (qa, qb) = (self.machine.rotary_of(&a.1), self.machine.rotary_of(&b.1));
        let short = (0..2).all(|k| (qb[k] - qa[k]).abs() < SHORT_RAD);
        if short {
            let worst = self.stray_at(line, (a, b), &[0.5, 1.0]);
            let o = self.options;
            if worst.tip_mm <= 0.25 * o.tip_tol_mm && worst.axis_rad <= 0.25 * o.axis_tol_rad {
                return worst;
            }
        }
        let parts: [f64; PARTS as usize] = std::array::from_fn(|k| (k + 1) as f64 / f64::from(PARTS));
        self.stray_at(line, (a, b), &parts)
    }

    /// The worst at these shares of the block.
    fn stray_at(&self, line: &Line, ends: ((f64, JointValues), (f64, JointValues)), shares: &[f64]) -> Stray {
        let (a, b) = ends;
        let mut worst = Stray::default();
        for &s in shares {
            let want = pose_between(&line.from.pose, &line.to.pose, a.0 + (b.0 - a.0) * s);
            let mut q = a.1;
            for (i, v) in q.iter_mut().enumerate() {
                *v += (b.1[i] - a.1[i]) * s;
            }
            let mut pose = self.machine.forward(&q, self.setup);
            if self.options.tcp {
                pose.tip = want.tip;
            }
            worst = worst.or(self.off(&pose, &want));
        }
        worst
    }

    /// How far a pose is from the one that is wanted.
    pub(crate) fn off(&self, pose: &Pose, want: &Pose) -> Stray {
        Stray {
            tip_mm: towards(&(pose.tip - want.tip), &want.axis, self.options.touch_rad),
            axis_rad: angle_between(&pose.axis, &want.axis),
        }
    }

    fn push(&mut self, line: &Line, t: f64, end: (f64, JointValues), stray: &Stray) {
        let whole = line.to.pose.tip - line.from.pose.tip;
        let kind = match line.label.kind {
            BlockKind::Point if end.0 < 1.0 => BlockKind::Inserted,
            kind => kind,
        };
        let summary = &mut self.path.summary;
        summary.inserted_points += usize::from(kind == BlockKind::Inserted);
        if line.label.motion != Motion::Rapid && !line.label.aloft {
            summary.add_stray(stray.tip_mm, stray.axis_rad);
        }
        self.path.blocks.push(JointBlock {
            joints: end.1,
            tip: line.from.pose.tip + whole * end.0,
            motion: line.label.motion,
            source: line.label.source,
            tip_length_mm: whole.norm() * (end.0 - t),
            kind,
        });
    }
}

/// One CL move with the joints at its ends.
struct Line<'a> {
    from: &'a Placed,
    to: &'a Placed,
    label: &'a Label,
    /// Blocks of the path when the move has as many as it may.
    most: usize,
}

#[cfg(test)]
#[path = "linearize_tests.rs"]
mod tests;
