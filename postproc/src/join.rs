//! As few blocks as the tolerances need: a block goes on over the CL points between its ends for as long as the tool
//! passes each of them, and what lies between them, as closely as a block between two CL points keeps to its line.
//!
//! Where the axis turns, every block costs a control that brakes between blocks about sqrt(2 angle / acceleration):
//! half as many take it 0.7 times as long.

use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, Motion};

use crate::choices::Choice;
use crate::joint_path::{BlockKind, JointBlock};
use crate::linearize::{LARGEST_ROTARY_STEP_RAD, Liner, Placed, Stray, pose_between};
use crate::machine::angle_between;
use crate::solve_error::SolveError;

/// Moves that one block takes at most: bounds the work, and how far a block is from those that it stands for.
const MOST_MOVES: usize = 512;

/// Axes that turn by less than this do not, rad: their straight ways are those of the machine already.
const TURNS_RAD: f64 = 1e-9;

/// Parts of a block, and of each of its moves, at the ends of which it is looked at, at least.
const PARTS: usize = 8;
const LEAST_PARTS: usize = 2;

/// A place on one of the moves that a block stands for.
struct Passed {
    pose: Pose,
    /// Its share of the way.
    share: f64,
}

impl Liner<'_> {
    /// Appends one block for as many of the moves, which are alike, as it can stand for, two at least; where it ends, and after how many
    /// moves. `None` where it can stand for one alone. The first of the moves starts at `from`.
    pub(crate) fn join(
        &mut self,
        from: &Placed,
        (moves, choices): (&[ClMove], &[Choice]),
        first: usize,
    ) -> Result<Option<(Placed, usize)>, SolveError> {
        let count = moves.len().min(MOST_MOVES);
        let place = |k: usize| {
            let pose = moves[k - 1].pose;
            self.checked(&choices[k - 1].rotary_rad, &pose, first + k - 1)
                .map(|joints| Placed { pose, joints })
        };
        // Twice as far each time, then between the last that was near enough and the first that was not.
        let (mut good, mut near, mut step, mut beyond) = (None, 1, 1, count + 1);
        while near + 1 < beyond {
            let k = if beyond > count { (near + step).min(count) } else { usize::midpoint(near, beyond) };
            let to = place(k)?;
            match self.passes(from, &to, &moves[..k]) {
                Some(stray) => (good, near, step) = (Some((to, stray)), k, 2 * step),
                None => beyond = k,
            }
        }
        let (Some((to, stray)), k) = (good, near) else { return Ok(None) };
        let tip_length_mm = lengths(from, &moves[..k]).sum();
        let summary = &mut self.path.summary;
        summary.joined_points += k - 1;
        summary.add_stray(stray.tip_mm, stray.axis_rad);
        self.path.blocks.push(JointBlock {
            joints: to.joints,
            tip: to.pose.tip,
            motion: moves[k - 1].motion,
            source: first + k - 1,
            tip_length_mm,
            kind: BlockKind::Point,
        });
        Ok(Some((to, k)))
    }

    /// By how much the block strays from the moves that it would stand for; `None` where that is too much.
    fn passes(&self, from: &Placed, to: &Placed, moves: &[ClMove]) -> Option<Stray> {
        let (qa, qb) = (self.machine.rotary_of(&from.joints), self.machine.rotary_of(&to.joints));
        if (0..2).any(|k| (qb[k] - qa[k]).abs() > LARGEST_ROTARY_STEP_RAD) {
            return None;
        }
        let mut worst = Stray::default();
        let whole: f64 = lengths(from, moves).sum();
        let parts = PARTS.div_ceil(moves.len()).max(LEAST_PARTS);
        let (mut before, mut done) = (from.pose, 0.0);
        for (m, length) in moves.iter().zip(lengths(from, moves)) {
            for k in 1..=parts {
                let t = k as f64 / parts as f64;
                let at =
                    Passed { pose: pose_between(&before, &m.pose, t), share: (done + t * length) / whole };
                let stray = self.abreast(from, to, &at);
                if !stray.within(self.options) {
                    return None;
                }
                worst = worst.or(stray);
            }
            (before, done) = (m.pose, done + length);
        }
        Some(worst)
    }

    /// How far the block is from a place when it is abreast of it.
    fn abreast(&self, from: &Placed, to: &Placed, at: &Passed) -> Stray {
        let chord = to.pose.tip - from.pose.tip;
        let pose = self.on_block(from, to, at.share);
        // One step of Newton's: what is left of the way is of second order in a stray that is small.
        let ahead = (pose.tip - at.pose.tip).dot(&chord) / chord.norm_squared();
        let share = if ahead.is_finite() { (at.share - ahead).clamp(0.0, 1.0) } else { at.share };
        let pose = self.on_block(from, to, share);
        self.off(&pose, &at.pose)
    }

    /// The tool on a block from `from` to `to`.
    fn on_block(&self, from: &Placed, to: &Placed, share: f64) -> Pose {
        let mut q = from.joints;
        for (v, (a, b)) in q.iter_mut().zip(from.joints.iter().zip(&to.joints)) {
            *v = a + (b - a) * share;
        }
        let pose = self.machine.forward(&q, self.setup);
        if self.options.tcp {
            return Pose { tip: from.pose.tip + (to.pose.tip - from.pose.tip) * share, ..pose };
        }
        pose
    }
}

/// How many of the moves are alike: turning feed moves at one feed, without rewinds or poles.
pub(crate) fn alike(from: &Placed, moves: &[ClMove], choices: &[Choice]) -> usize {
    let Some(first) = moves.first() else { return 0 };
    let mut axis = from.pose.axis;
    let fits = |(m, choice): (&ClMove, &Choice)| {
        let turns = angle_between(&axis, &m.pose.axis) > TURNS_RAD;
        axis = m.pose.axis;
        let feeds = m.motion != Motion::Rapid && !m.aloft;
        turns && feeds && m.motion == first.motion && !choice.rewind && !choice.singular
    };
    moves.iter().zip(choices).map(fits).take_while(|fit| *fit).count()
}

/// Lengths of the tip's ways of the moves, mm.
fn lengths<'a>(from: &Placed, moves: &'a [ClMove]) -> impl Iterator<Item = f64> + use<'a> {
    let mut tip = from.pose.tip;
    moves.iter().map(move |m| {
        let length = (m.pose.tip - tip).norm();
        tip = m.pose.tip;
        length
    })
}
