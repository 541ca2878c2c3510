//! Tool paths: passes over one face, the moves between them, and what they should yield.
//!
//! A strategy places passes of contact points ([`Pass`]) so that the exact strips meet within the scallop tolerance;
//! [`link`] joins passes to a [`ClPath`](osculate_tools::cl::ClPath). What a plan promises is checked elsewhere, from the NC text.

mod beside;
mod columns;
mod contour;
mod cover;
mod drop;
mod ends;
pub(crate) mod extended;
mod fits;
mod isoparametric;
mod lead;
mod leave_out;
mod level;
mod line;
mod link;
mod march;
mod motion;
mod predict;
mod regions;
mod repeat;
mod resample;
mod rest;
pub(crate) mod ripples;
pub(crate) mod samples;
mod seat;
mod senses;
mod stations;
mod strategy;
mod task;
mod walk;
mod wall_edges;

pub use beside::wall_edges;
pub use contour::contour_2cl;
pub use drop::{
    DropTask, Entry, Heading, Headings, Places, RoughTask, Roughing, Rows, Search, Sizes, ThreeAxis,
    ThreeAxisLines, drop_cutter, gradient_3c, rough, waterline_3c,
};
pub use isoparametric::isoparametric;
pub use lead::{LeadField, Leaning, LocalLead, SideTilt};
pub use leave_out::{Guard, LeaveOutError, LeftOut, leave_out};
pub use level::{along_walls, curvature_5c, isoplanar, isoscallop, streamline};
pub use link::{Freedom, Keeping, Linked, Links, Rates, Walls, link, link_stretches, ordered};
pub use predict::predicted_length_mm;
pub use regions::regions;
pub use repeat::repeated;
pub use rest::{Rest, RestError, rest_of};
pub use senses::{Milling, Senses, run_in};
pub use stations::Stretches;
pub use strategy::{Strategy, run};
pub use task::{Along, CcPoint, Named, Pass, Passes, PlanError, Task, Tolerance};
use task::{MAX_PASSES, check_tolerance, shorter};
pub use wall_edges::WallEdges;
