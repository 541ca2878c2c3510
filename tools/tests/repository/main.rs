//! Tests that read files of the repository around the package, and are not published with it: an example part, the page of D98.
//!
//! `cargo test --test repository NAME::` runs those of one file.
#![allow(clippy::unwrap_used)]

#[path = "../dense/mod.rs"]
mod dense;
mod fresh;
mod papers;
mod strip_blade;
