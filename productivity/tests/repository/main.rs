//! Tests that read files of the repository around the package, and are not published with it: example parts, pages of papers.
//!
//! `cargo test --test repository NAME::` runs those of one file.
#![allow(clippy::unwrap_used)]

#[path = "../../../tools/tests/repository/fresh.rs"]
mod fresh;
#[path = "../common/limits.rs"]
mod limits;
mod optimum;
mod papers;
mod productivity_in_time;
mod rows;
mod slot;
