//! Tests of forms, curves, analytic surfaces and convex bodies through the public names of the crate.
//!
//! One program for all of them: each file is a module, `cargo test --test all NAME::` runs one.
#![allow(clippy::unwrap_used)]

mod bad_input;
mod convex;
mod curves;
mod laws;
mod limits;
mod lines_and_indicatrices;
mod offsets;
mod taylor;
mod wrappers;
