//! Tests of machines, programs and the models of controls through the public names of the crate.
//!
//! One program for all of them: each file is a module, `cargo test --test all NAME::` runs one.
#![allow(clippy::unwrap_used)]

mod blade;
mod blank;
mod bounds;
mod cl_tools;
mod cldata;
mod cldata_arcs;
mod common;
mod dialect_files;
mod feed_metrics;
mod flow;
mod join;
mod machine_data;
mod meetings;
#[path = "mutation/main.rs"]
mod mutation;
mod nose;
mod orientation;
mod properties;
mod readback;
mod roundtrip;
mod sections;
mod solve;
mod state_faults;
mod state_rewrites;
mod stops;
mod stream;
mod timing;
