//! Tests that read files of the repository around the package, and are not published with it: examples, documents, seeds of the fuzz targets.
//!
//! `cargo test --test repository NAME::` runs those of one file.
#![allow(clippy::unwrap_used)]

#[path = "../common/mod.rs"]
mod common;
mod corpus;
mod data;
mod dialects;
mod hidden;
mod init;
mod inspect;
mod matrix;
mod reach_truth;
mod strip;
mod verdicts;
mod wrong_inputs;
