//! The verbs.

pub mod compare;
pub mod export;
pub mod flank;
pub mod gallery;
pub mod init;
pub mod inspect;
pub mod keys;
pub mod lines;
pub mod list;
pub mod plan;
pub mod post;
pub mod probe;
pub mod readback;
pub mod strip;
pub mod time;
pub mod verify;
