//! What must be so for a program to hold: the goal against which [`prove`](super::prove()) judges motions.
//!
//! A goal names everything that is looked at, and everything that is not: faces to machine, all other faces of the part, the tool
//! with its holder and teeth, raw material, fixtures, the state of the control. What it leaves out is named in the verdict's
//! scope. Lengths are mm in the part's frame.

use super::job::{Sample, Swept};
use super::stock::{Blank, Resolution};
use crate::cutter::Cutter;
use crate::holder::Holder;
use osculate_geom::{Surface, Uv};
use std::ops::Range;

/// A face with its name.
#[derive(Clone)]
#[non_exhaustive]
pub struct GoalFace<'a> {
    /// As people name it.
    pub name: &'a str,
    /// The face, its normal out of the material. A roughing is measured against faces set out by its allowance.
    pub surface: &'a dyn Surface,
    /// Closed polylines of its trims, where it is trimmed.
    pub outlines: Vec<&'a [Uv]>,
    /// What of it is looked at, where that is not all of it.
    pub part_of_it: Option<String>,
    /// Polylines of its rim where no other face goes on, in pieces: nothing says what lies beneath, and depth counts up to the rim as if a
    /// wall stood there along the normals. Everywhere else depth is that along the normals and from all other faces.
    pub open_rims: &'a [Vec<Uv>],
}

impl<'a> GoalFace<'a> {
    /// All of a face that is not trimmed and has neighbours all around.
    #[must_use]
    pub const fn new(name: &'a str, surface: &'a dyn Surface) -> Self {
        Self { name, surface, outlines: Vec::new(), part_of_it: None, open_rims: &[] }
    }
}

/// Why faces of the part are not looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unseen {
    /// The job says that they may be hit.
    MayBeHit(Vec<String>),
    /// Nothing says on which side of them the material is.
    NoSide(Vec<String>),
    /// They lie in the material of other bodies, wholly or in part: in words, each with its area. That leaves nothing of the
    /// part's surface out.
    Hidden(Vec<String>),
    /// A mesh stands for the part: in words, what that leaves open. All of its triangles are looked at.
    Mesh(String),
}

/// A tool that motions carry.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct GoalTool<'a> {
    /// The whole tool below the holder.
    pub cutter: &'a Cutter,
    /// The part of it that cuts; the whole one where nothing else is known.
    pub flutes: &'a Cutter,
    /// What is above the part that cuts, up to the cutter's length.
    pub shank: Option<&'a Cutter>,
    /// The holder.
    pub holder: Option<&'a Holder>,
    /// Cutting edges; where nothing says how many, tooth marks are those of a single one.
    pub teeth: Option<u32>,
    /// Revolutions a minute. Without it tooth marks are not known.
    pub spindle_rpm: Option<f64>,
    /// The fastest that its tip may go where it cuts, mm/min. Without it that is not looked at.
    pub feed_mm_min: Option<f64>,
}

impl<'a> GoalTool<'a> {
    /// A cutter that cuts all along, without a holder; nothing is known of its teeth and speed.
    #[must_use]
    pub const fn new(cutter: &'a Cutter) -> Self {
        Self {
            cutter,
            flutes: cutter,
            shank: None,
            holder: None,
            teeth: None,
            spindle_rpm: None,
            feed_mm_min: None,
        }
    }

    /// The same with so many teeth at a speed, whose marks are told.
    #[must_use]
    pub const fn turning(mut self, teeth: u32, spindle_rpm: f64) -> Self {
        (self.teeth, self.spindle_rpm) = (Some(teeth), Some(spindle_rpm));
        self
    }
}

/// Raw material.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub enum GoalStock<'a> {
    /// None is declared: a layer of this thickness on the faces to machine stands for it.
    Assumed {
        /// The thickness, mm.
        layer_mm: f64,
    },
    /// What is declared.
    Declared {
        /// Before the first motion.
        blank: Blank<'a>,
        /// How finely it is looked at.
        resolution: Resolution,
        /// What stands on the faces to machine at most as far as they are judged, mm.
        layer_mm: f64,
        /// In words.
        words: &'a str,
    },
}

impl GoalStock<'_> {
    /// The layer on the faces to machine, mm.
    #[must_use]
    pub const fn layer_mm(&self) -> f64 {
        match self {
            Self::Assumed { layer_mm } | Self::Declared { layer_mm, .. } => *layer_mm,
        }
    }
}

/// What must hold, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GoalLimits {
    /// Highest material left: scallop and tooth mark together; of a roughing above its allowance.
    pub scallop_mm: f64,
    /// Deepest undercut, in any face; holder and rapids take no more.
    pub gouge_mm: f64,
    /// Uncut area that is accepted, mm2.
    pub unreached_mm2: f64,
    /// Whether limits that are met at the samples are enough.
    pub at_samples: bool,
}

impl GoalLimits {
    /// All of the faces is to be machined, and what may hide between samples counts.
    #[must_use]
    pub const fn new(scallop_mm: f64, gouge_mm: f64) -> Self {
        Self { scallop_mm, gouge_mm, unreached_mm2: 0.0, at_samples: false }
    }
}

/// How densely faces are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Looks {
    /// Distance of samples, mm; from the width of a strip where not given.
    pub spacing_mm: Option<f64>,
    /// Most samples.
    pub max_samples: usize,
    /// Whether what may hide between them is bounded; where it is not, only limits met at the samples can be told.
    pub between: bool,
}

impl Default for Looks {
    /// Samples by the width of strips, a million at most, and a bound on what hides between them.
    fn default() -> Self {
        Self { spacing_mm: None, max_samples: 1_000_000, between: true }
    }
}

impl Looks {
    /// Samples at a distance, and no more than so many.
    #[must_use]
    pub const fn spaced(spacing_mm: f64, max_samples: usize) -> Self {
        Self { spacing_mm: Some(spacing_mm), max_samples, between: true }
    }
}

/// How grave a remark on the state of the control is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Gravity {
    /// To be told.
    Told,
    /// What the program does depends on something that is not known: nothing is shown.
    Open,
    /// The program does not run as the job means it.
    Breaks,
}

/// Something about the state of the control in which a program runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// How grave it is.
    pub gravity: Gravity,
    /// With its line.
    pub text: String,
}

/// The state of the control while the program runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GoalControl {
    /// What was looked at, in words; empty where it was not, as for CL data.
    pub words: String,
    /// Remarks.
    pub remarks: Vec<Remark>,
    /// Width to which corners are blended, mm.
    pub blend_mm: f64,
    /// Which bodies of the machine were looked at, in words; empty where none are described.
    pub bodies: String,
}

/// What holds the part while some of the motions are made.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalFixture {
    /// Places on it, numbered as faces after all others; nothing may be taken from them.
    pub samples: Vec<Sample>,
    /// While these motions are made, by their indices; those beyond the last are none.
    pub motions: Range<usize>,
}

/// Everything that must be so: [`Goal::new`].
#[non_exhaustive]
pub struct Goal<'a> {
    /// Faces to machine; at least one.
    pub machined: Vec<GoalFace<'a>>,
    /// All other faces that are looked at: nothing may be taken from them.
    pub checked: Vec<GoalFace<'a>>,
    /// Faces that are not looked at.
    pub unseen: Vec<Unseen>,
    /// What holds the part.
    pub fixtures: Vec<GoalFixture>,
    /// The tools in the order in which the program has them; at least one. A tool that comes back is there again.
    pub tools: Vec<GoalTool<'a>>,
    /// Raw material.
    pub stock: GoalStock<'a>,
    /// Limits.
    pub limits: GoalLimits,
    /// How densely to look.
    pub looks: Looks,
    /// What a roughing leaves on the faces on purpose, mm; None for a finishing.
    pub roughing_mm: Option<f64>,
    /// The control.
    pub control: GoalControl,
}

impl<'a> Goal<'a> {
    /// A finishing of faces, with nothing beside them, seen as densely as usual; the state of the control is not looked at.
    #[must_use]
    pub fn new(
        machined: Vec<GoalFace<'a>>,
        tools: Vec<GoalTool<'a>>,
        stock: GoalStock<'a>,
        limits: GoalLimits,
    ) -> Self {
        Self {
            machined,
            checked: Vec::new(),
            unseen: Vec::new(),
            fixtures: Vec::new(),
            tools,
            stock,
            limits,
            looks: Looks::default(),
            roughing_mm: None,
            control: GoalControl::default(),
        }
    }
}

/// What a program does, as it was read back.
#[derive(Clone, Copy)]
pub struct Program<'a> {
    /// Its motions, in their order.
    pub motions: &'a [Swept],
    /// When each ends, min from the start; empty where nothing says, as of CL data without feeds.
    pub times_min: &'a [f64],
    /// Indices of the motions at which the next of the goal's tools takes over; none with a single tool.
    pub changes: &'a [usize],
}

impl Program<'_> {
    /// Which tool makes a motion, counted from 0.
    #[must_use]
    pub fn tool_of(&self, motion: usize) -> usize {
        self.changes.partition_point(|first| *first <= motion)
    }
}
