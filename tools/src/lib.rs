//! Cutters, their contact with a surface, the strips they leave, and what is left on a part.

pub mod cl;
mod pose;
mod spec;

pub use pose::Pose;
pub use spec::{CutterSpec, HolderSpec};
