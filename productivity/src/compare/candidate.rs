//! What is compared, on what, and what is said of it.

use super::around::Around;
use crate::ideal::Patch;
use crate::plan::{Strategy, ThreeAxis, Tolerance};
use osculate_geom::Unit3;
use osculate_tools::{Cutter, Holder, Lean};

/// A tool to choose from.
#[derive(Clone, Copy)]
pub struct Tool<'a> {
    /// The cutter.
    pub cutter: &'a Cutter,
    /// The holder, whose nose sits where the cutter ends.
    pub holder: Option<&'a Holder>,
    /// Feed, mm/min.
    pub feed_mm_min: f64,
}

/// What candidates are compared on.
pub struct Setting<'a> {
    /// The faces to machine.
    pub faces: &'a [Patch<'a>],
    /// The tools.
    pub tools: &'a [Tool<'a>],
    /// What must hold.
    pub tolerance: Tolerance,
    /// Points that bodies of tools must stay out of.
    pub around: &'a Around,
    /// The only axes that the machine has, in the part's frame, one next to the other; None where they fill a part of the sphere.
    pub line: Option<&'a [Unit3]>,
}

/// One way to machine the faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Index of the tool.
    pub tool: usize,
    /// Strategy with its direction.
    pub strategy: Strategy,
    /// Lead and tilt.
    pub lean: Lean,
    /// How the axis is found.
    pub axes: Axes,
}

impl Candidate {
    /// How its tool is led, where that keeps its axis and is dropped onto the faces.
    #[must_use]
    pub const fn three_axis(&self) -> Option<&ThreeAxis> {
        if let Strategy::ThreeAxis(way) = &self.strategy { Some(way) } else { None }
    }
}

/// How the axes of a tool that leans are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// One lead and tilt everywhere.
    Held,
    /// The least lead that fits at every place, from a given one on.
    Local,
    /// The same, with the tilt at every place with which strips reach as far to both sides.
    Balanced,
    /// A field in the part's frame, the same for passes to and fro.
    Field,
}

impl Axes {
    /// Whether leads are found place by place, each for its own direction of feed.
    #[must_use]
    pub const fn is_local(self) -> bool {
        matches!(self, Self::Local | Self::Balanced)
    }
}

/// What screening says of a candidate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Screened {
    /// Time by strips at places, min.
    pub pointwise_min: f64,
    /// Time with the overlap of constant spacing, min.
    pub layout_min: f64,
    /// Length of passes of that layout, mm.
    pub length_mm: f64,
    /// Why it is out; the times above are then those of the places where it would do.
    pub out: Option<Reason>,
}

/// Why a candidate is not possible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The tool digs in next to the contact.
    #[error("too large for {percent:.0} % of the area{}", largest(*largest_mm))]
    TooLarge {
        /// Share of the area.
        percent: f64,
        /// Largest diameter of a tool of this shape that fits everywhere in this posture; zero where none does.
        largest_mm: f64,
    },
    /// Its body meets the part or a check face elsewhere.
    #[error("goes {depth_mm:.2} mm into {face} while touching {percent:.0} % of the area")]
    Body {
        /// Share of the area.
        percent: f64,
        /// Depth, mm.
        depth_mm: f64,
        /// The face it meets.
        face: String,
    },
    /// The holder meets something.
    #[error("its holder goes {depth_mm:.2} mm into {face} while it touches {percent:.0} % of the area")]
    Holder {
        /// Share of the area.
        percent: f64,
        /// Depth, mm.
        depth_mm: f64,
        /// The face it meets.
        face: String,
    },
    /// The face looks away from a fixed tool axis.
    #[error("{percent:.0} % of the area look away from the tool axis")]
    Away {
        /// Share of the area.
        percent: f64,
    },
    /// No strip within the tolerance.
    #[error("leaves more than the scallop at {percent:.0} % of the area")]
    NoStrip {
        /// Share of the area.
        percent: f64,
    },
}

fn largest(diameter_mm: f64) -> String {
    if diameter_mm > 0.0 {
        format!(": {diameter_mm:.2} mm is the largest diameter that fits")
    } else {
        String::new()
    }
}
