//! What is asked of the search for the best motion, and what it answers.

use crate::flank::axes::{AxesError, AxisSurface};
use crate::flank::cutter_side::CutterSide;
use crate::flank::deviation::Patch;
use osculate_geom::{Interval, Surface};

/// What is made small.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Goal {
    /// The greatest absolute deviation.
    #[default]
    Minimax,
    /// The root of the mean square.
    Rms,
}

/// How the optimum is looked for.
///
/// ```
/// use osculate_tools::flank::global::{Goal, Options};
/// // The greatest deviation, gouges and material left alike. Here a gouge counts a hundredfold.
/// let careful = Options { gouge_weight: 100.0, ..Default::default() };
/// assert_eq!((careful.goal, Options::default().gouge_weight), (Goal::Minimax, 1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What is made small.
    pub goal: Goal,
    /// Spans of the guiding splines.
    pub spans: usize,
    /// What a gouge of 1 mm counts, in mm of material left: 1 treats both alike, 1000 all but forbids gouges. For
    /// [`Goal::Rms`] any value above 1 forbids them.
    pub gouge_weight: f64,
    /// Weight of the motion's unevenness, mm of deviation per square mm of the greatest second difference of poles; 0 leaves only
    /// what makes the answer unique.
    pub smoothness_per_mm: f64,
    /// Most linear problems.
    pub iterations: usize,
    /// A motion whose value, with what its unevenness weighs, is no more than this is good enough, and no better one is looked for, mm.
    /// Where the face lets the cutter fit exactly the search would go on to rounding.
    pub enough_mm: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            goal: Goal::Minimax,
            spans: 32,
            gouge_weight: 1.0,
            smoothness_per_mm: 0.0,
            iterations: 60,
            enough_mm: 0.0,
        }
    }
}

/// A face and the cutter for it.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The face: u along the directrices, v along the rules from 0 to 1.
    pub surface: &'a dyn Surface,
    /// The cutter.
    pub side: CutterSide,
    /// The positions' range of u; it may reach beyond the face.
    pub positions: Interval,
    /// Where the deviation counts, and at how many places.
    pub judged: Patch,
}

impl Task<'_> {
    /// The grid on which a motion is judged between the places that it was made for.
    pub(super) fn fine(&self) -> Patch {
        let [along, across] = self.judged.count;
        Patch { count: [4 * along - 3, 2 * across - 1], ..self.judged }
    }
}

/// An optimum.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Found {
    /// The motion.
    pub axes: AxisSurface,
    /// The goal's value over the places of the patch: the greatest deviation, gouges weighted, or the root mean square, mm.
    pub value_mm: f64,
    /// No motion on the same knots whose poles are each within [`Found::bound_within_mm`] of this one's has, to first order in
    /// the poles' displacements, a smaller greatest deviation at the places of the patch. It is the value of the linearised
    /// problem's dual at multipliers that are not negative, and so holds whether or not they are optimal. None for
    /// [`Goal::Rms`].
    pub bound_mm: Option<f64>,
    /// The same for splines with twice as many spans: how far a richer motion could still come.
    pub bound_refined_mm: Option<f64>,
    /// How far each coordinate of a pole may move for the bounds, mm.
    pub bound_within_mm: f64,
    /// Linear problems solved.
    pub iterations: usize,
    /// Whether the last linear problem promised next to nothing, or the motion is good enough; false where the iterations ran out.
    pub converged: bool,
}

/// Why a rule gives no first position.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// A rule of no length, or a directrix that stands still or runs along the rule.
    #[error(
        "the rule at u = {u} has no tangent planes at its ends: it has no length, or a directrix has a cusp there"
    )]
    Degenerate {
        /// The parameter.
        u: f64,
    },
    /// The normals at the ends of a rule are opposite.
    #[error("the rule at u = {u} is twisted by half a turn: the cutter has no side to stand on")]
    Opposite {
        /// The parameter.
        u: f64,
    },
}

/// Why there is no optimum.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GlobalError {
    /// Fewer spans or places than make a problem.
    #[error("{what} is {got}; at least {least} are needed")]
    TooFew {
        /// What there is too little of.
        what: &'static str,
        /// How many there are.
        got: usize,
        /// How many are needed.
        least: usize,
    },
    /// A weight that is negative or not finite.
    #[error("{what} = {got} must be finite and not below {least}")]
    Weight {
        /// Which.
        what: &'static str,
        /// Its value.
        got: f64,
        /// The least it may be.
        least: f64,
    },
    /// A place of the patch has no finite point or deviation.
    #[error("the face has no finite deviation at u = {u}, v = {v}")]
    NotFinite {
        /// Parameter along the directrices.
        u: f64,
        /// Parameter along the rule.
        v: f64,
    },
    /// The linear problem could not be solved.
    #[error("the linear problem {iteration} has no numerical solution")]
    Numbers {
        /// Its number.
        iteration: usize,
    },
    /// No place to begin.
    #[error(transparent)]
    Start(#[from] StartError),
    /// A motion that is none.
    #[error(transparent)]
    Axes(#[from] AxesError),
}
