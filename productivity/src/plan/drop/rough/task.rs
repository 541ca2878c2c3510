//! What to rough, and what comes of it.

use crate::plan::{Linked, Links, Named, Passes, PlanError};
use osculate_geom::{TurnAxis, Unit3, Vec3};
use osculate_tools::Cutter;
use osculate_tools::removal::stock::Stock;

/// What to rough.
#[derive(Clone, Copy)]
pub struct RoughTask<'a> {
    /// Faces to machine.
    pub faces: &'a [Named<'a>],
    /// Faces that the tool must not come nearer to than the allowance either.
    pub check: &'a [Named<'a>],
    /// The cutter: a ball, flat or toroidal end.
    pub cutter: &'a Cutter,
    /// From where it is roughed.
    pub from: Headings<'a>,
    /// The way of rows.
    pub rows: Rows,
    /// What operations before have left.
    pub stock: &'a Stock,
    /// Equal places in a circle, of which the first is planned.
    pub repeat: Option<Places>,
    /// How much is taken and left.
    pub sizes: Sizes,
    /// How it comes into the material.
    pub entry: Entry,
    /// Whether the tool may go straight down into material.
    pub plunges: bool,
    /// Greatest volume a minute that it takes, mm3/min; the feed is lowered where it would take more.
    pub volume_rate_mm3_min: f64,
    /// How the tool goes between rows and layers, with its holder and its feeds.
    pub links: &'a Links,
    /// Told how far the work is, 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

/// From where a part is roughed.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub enum Headings<'a> {
    /// Along one axis, from the tip to the holder.
    Along(Unit3),
    /// Along the axes that take most, one after the other.
    Found(Search<'a>),
}

/// The way of rows, brought into the plane across the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Rows {
    /// Along a direction.
    Along(Vec3),
    /// Along this direction or turned about the axis from it, in each part of a layer whichever takes the least time
    /// for what it takes.
    Quickest(Vec3),
}

impl Rows {
    /// The direction itself.
    pub(super) const fn given(self) -> Vec3 {
        match self {
            Self::Along(way) | Self::Quickest(way) => way,
        }
    }
}

/// How axes are found.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    /// Those that the machine reaches.
    pub candidates: &'a [Unit3],
    /// No more than so many.
    pub most: usize,
    /// One that would take less than this share of what all can take is left out.
    pub least_share: f64,
}

/// Equal places in a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Places {
    /// The axis of the circle.
    pub axis: TurnAxis,
    /// How many, the first one counted.
    pub count: usize,
}

/// How the tool comes into the material where it cannot come from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Entry {
    /// By a helix where one fits, else to and fro along the pass, else straight down where the tool may.
    Auto,
    /// By a helix.
    Helix,
    /// To and fro along the pass.
    Ramp,
    /// From outside only.
    Outside,
}

/// How much a roughing takes at once and leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Deepest cut along the axis, mm.
    pub stepdown_mm: f64,
    /// Distance of rows, mm.
    pub stepover_mm: f64,
    /// What is left on the faces, mm; zero or more.
    pub allowance_mm: f64,
    /// Steepest way down into material, rad.
    pub ramp_rad: f64,
    /// Deviation of the path's pieces from the allowance, mm.
    pub chord_mm: f64,
    /// What may stand above the allowance, mm: it is what steps on slopes are laid out for, and what no other direction is taken for
    /// where it is no thicker than half of it.
    pub stands_mm: f64,
}

impl Sizes {
    pub(super) fn check(&self) -> Result<(), PlanError> {
        for (what, got, least) in [
            ("stepdown_mm", self.stepdown_mm, 0.0),
            ("stepover_mm", self.stepover_mm, 0.0),
            ("chord_mm", self.chord_mm, 0.0),
            ("ramp", self.ramp_rad, 0.0),
            ("allowance_mm", self.allowance_mm, -f64::MIN_POSITIVE),
            ("stands_mm", self.stands_mm, 0.0),
        ] {
            if !(got > least && got.is_finite()) {
                return Err(PlanError::Tolerance { what, got });
            }
        }
        Ok(())
    }
}

/// Layers along one axis.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Heading {
    /// The axis, from the tip to the holder.
    pub axis: Unit3,
    /// The way of most of its rows, across the axis.
    pub rows: Unit3,
    /// Heights of the layers along it, from the top, mm.
    pub layers: Vec<f64>,
    /// What the tool takes, in the one place that is planned, mm3.
    pub volume_mm3: f64,
    /// Length of the passes there, mm.
    pub cutting_length_mm: f64,
    /// What is left because nothing leads into it: pockets too narrow for the way down, mm3.
    pub shut_mm3: f64,
}

/// A roughing.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct Roughing {
    /// Passes in the order of cutting.
    pub passes: Passes,
    /// The whole path.
    pub linked: Linked,
    /// The axes with their layers, in order.
    pub headings: Vec<Heading>,
}
