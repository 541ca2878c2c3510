//! Tests of cutters, contact, reach and removal through the public names of the crate.
//!
//! One program for all of them: each file is a module, `cargo test --test all NAME::` runs one.
#![allow(clippy::unwrap_used)]

mod axis_motion;
mod dense;
mod flank_closed;
mod flank_envelope;
mod flank_families;
mod flank_position;
mod flank_strip;
mod flank_tools;
#[path = "reach/main.rs"]
mod reach;
#[path = "removal/main.rs"]
mod removal;
mod strip_dense;
mod strip_torus;
