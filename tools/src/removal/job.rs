//! What goes into [`cut`](super::cut) and what comes out.

use crate::cl::{ClPath, Motion};
use crate::cutter::Cutter;
use crate::holder::Holder;
use crate::pose::Pose;
use osculate_geom::{Point3, Unit3, Uv};

/// A point of a face at which material is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The point, mm.
    pub point: Point3,
    /// Outward normal of the part.
    pub normal: Unit3,
    /// Which face, as numbered by the caller.
    pub face: u32,
    /// Surface parameters.
    pub uv: Uv,
    /// The share of the face's area that the sample stands for, mm2.
    pub area_mm2: f64,
    /// True on a face that is not to be machined: it carries no stock, and only gouges count.
    pub check_only: bool,
}

/// One motion of the tool: tip and axis move linearly, the axis renormalised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swept {
    /// Where it begins.
    pub from: Pose,
    /// Where it ends.
    pub to: Pose,
    /// Whether it is a rapid, which must not touch material.
    pub rapid: bool,
    /// The NC line or CL point that it is reported under.
    pub block: u32,
}

impl Swept {
    /// The motions of a path, each with the index of the CL point at which it ends as its block. The first
    /// point is reached from an unknown place and makes no motion.
    ///
    /// ```
    /// use osculate_geom::{Point3, Vec3};
    /// use osculate_tools::Pose;
    /// use osculate_tools::cl::{ClMove, ClPath, Motion};
    /// use osculate_tools::removal::Swept;
    /// // Three points make two motions; the first point is come to from nobody knows where.
    /// let to = |x: f64, motion| {
    ///     let pose = Pose { tip: Point3::new(x, 0.0, 0.0), axis: Vec3::z_axis() };
    ///     ClMove { pose, motion, aloft: false }
    /// };
    /// let moves = vec![to(0.0, Motion::Rapid), to(5.0, Motion::Rapid), to(40.0, Motion::Feed(900.0))];
    /// let motions = Swept::along(&ClPath { moves, ..Default::default() });
    /// assert_eq!(motions.len(), 2);
    /// assert!(motions[0].rapid && !motions[1].rapid && motions[1].from == motions[0].to);
    /// ```
    #[must_use]
    pub fn along(path: &ClPath) -> Vec<Self> {
        path.moves
            .windows(2)
            .zip(1u32..)
            .map(|(pair, block)| Self {
                from: pair[0].pose,
                to: pair[1].pose,
                rapid: matches!(pair[1].motion, Motion::Rapid),
                block,
            })
            .collect()
    }
}

/// A removal to be computed.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The cutter. Its whole length cuts.
    pub cutter: &'a Cutter,
    /// The holder, whose nose sits where the cutter's length ends.
    pub holder: Option<&'a Holder>,
    /// Tools that take over from these, in the order of the motions.
    pub changes: &'a [Change<'a>],
    /// The motions in the order in which they happen.
    pub motions: &'a [Swept],
    /// Where material is measured.
    pub samples: &'a [Sample],
    /// Height of material above each sample before the first motion, mm. Zero: only gouges are looked for.
    pub stock_mm: f64,
    /// How deep gouges are followed, mm; deeper ones are reported as this deep.
    pub depth_mm: f64,
}

/// Another tool in the spindle.
#[derive(Clone, Copy, Debug)]
pub struct Change<'a> {
    /// Index of the first motion that it makes; it makes all from there to the next change.
    pub first: usize,
    /// Its cutter.
    pub cutter: &'a Cutter,
    /// Its holder.
    pub holder: Option<&'a Holder>,
}

impl Job<'_> {
    /// What there is at the samples before the first motion: the whole layer, and none on faces that are not machined.
    pub(super) fn before_any(&self) -> Vec<Cut> {
        let height = |s: &Sample| if s.check_only { 0.0 } else { self.stock_mm };
        self.samples.iter().map(|s| Cut::untouched(height(s))).collect()
    }

    /// Which tool makes a motion, counted from 0.
    pub(super) fn tool_of(&self, motion: u32) -> usize {
        self.changes.partition_point(|c| c.first <= motion as usize)
    }

    /// The cutter that makes a motion.
    pub(super) fn cutter_of(&self, motion: u32) -> &Cutter {
        self.tool_of(motion).checked_sub(1).map_or(self.cutter, |k| self.changes[k].cutter)
    }

    /// All cutters, in the order of the motions.
    pub(super) fn cutters(&self) -> impl Iterator<Item = &Cutter> {
        std::iter::once(self.cutter).chain(self.changes.iter().map(|c| c.cutter))
    }
}

/// A job that cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// The stock is negative or not finite.
    #[error("stock_mm must be finite and not negative, got {got}")]
    Stock {
        /// The value, mm.
        got: f64,
    },
    /// The depth is not positive and finite.
    #[error("depth_mm must be positive and finite, got {got}")]
    Depth {
        /// The value, mm.
        got: f64,
    },
    /// What was left before is not that of the samples.
    #[error("what was left before is given at {before} of {samples} samples: one for each is needed")]
    Before {
        /// Samples.
        samples: usize,
        /// Places at which it is given.
        before: usize,
    },
    /// A motion with a coordinate that is not finite, or so large that its square is not.
    #[error("motion {motion} (block {block}) has a coordinate that is not finite, or beyond 1e9 mm")]
    NotFinite {
        /// Index of the motion.
        motion: usize,
        /// Its block.
        block: u32,
    },
    /// A motion whose axis turns by nearly 180 degrees: the linear motion of the axis has no plane.
    #[error(
        "in motion {motion} (block {block}) the tool axis turns by more than 179 degrees, which a linear \
         motion of the axis leaves undefined: put a pose in between"
    )]
    Reversal {
        /// Index of the motion.
        motion: usize,
        /// Its block.
        block: u32,
    },
    /// A sample with a coordinate that is not finite.
    #[error("sample {sample} (face {face}) has a coordinate that is not finite")]
    SampleNotFinite {
        /// Index of the sample.
        sample: usize,
        /// Its face.
        face: u32,
    },
    /// Tools that do not take over one after the other.
    #[error("tool {tool} takes over at motion {first}, which is before the tool ahead of it does")]
    Changes {
        /// Which of the changes, from 1.
        tool: usize,
        /// Its first motion.
        first: usize,
    },
    /// More of something than can be numbered or held.
    #[error("too many {what}, at most {limit}: verify in parts")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
}

/// What touched the material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The cutter.
    Cutter,
    /// The part of the tool above its cutting edges.
    Shank,
    /// The holder.
    Holder,
}

/// What cut a sample to its final height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct By {
    /// Index of the motion.
    pub motion: u32,
    /// Its block.
    pub block: u32,
    /// With what.
    pub body: Body,
    /// Whether the motion was a rapid.
    pub rapid: bool,
}

/// Material taken where none should be: by a rapid or by the holder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Height taken at the sample, mm.
    pub removed_mm: f64,
    /// Index of the motion.
    pub motion: u32,
    /// Its block.
    pub block: u32,
}

/// What the path did at one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Height left above the sample along its normal, mm: the stock where nothing cut, negative for a gouge.
    pub standoff_mm: f64,
    /// What cut it to this height; None where nothing did. Of several motions that reach the same height it
    /// is one of them, the same in every run.
    pub by: Option<By>,
    /// The most that a rapid of the cutter took here, given what had been cut before it.
    pub rapid: Option<Touch>,
    /// The most that the holder took here, given what had been cut before it and by the cutter in the same
    /// motion.
    pub holder: Option<Touch>,
}

impl Cut {
    /// Of a place where so much stands and nothing was yet.
    #[must_use]
    pub const fn untouched(standoff_mm: f64) -> Self {
        Self { standoff_mm, by: None, rapid: None, holder: None }
    }

    /// The same with motions counted from so many motions before.
    pub(super) fn later(self, by: u32) -> Self {
        let touch = |t: Touch| Touch { motion: t.motion + by, ..t };
        Self {
            by: self.by.map(|b| By { motion: b.motion + by, ..b }),
            rapid: self.rapid.map(touch),
            holder: self.holder.map(touch),
            ..self
        }
    }
}
