//! Cutters, their contact with a surface, the strips they leave, and what is left on a part.

pub mod cl;
pub mod contact;
mod cutter;
mod pose;
pub mod removal;
mod spec;
pub mod strip;
pub mod sweep;

pub use contact::{Contact, ContactError, ContactMotion, FeedLine, Lean};
pub use cutter::{Cutter, CutterError, Entry, Line, Part};
pub use pose::Pose;
pub use spec::{CutterSpec, HolderSpec};
