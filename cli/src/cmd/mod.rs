//! The verbs.

pub mod inspect;
pub mod list;
pub mod plan;
pub mod post;
pub mod probe;
pub mod strip;
pub mod time;
pub mod verify;
