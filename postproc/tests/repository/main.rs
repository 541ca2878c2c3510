//! Tests that read files of the repository around the package, and are not published with it: the pages of dialects and of Z17.
//!
//! `cargo test --test repository NAME::` runs those of one file.
#![allow(clippy::unwrap_used)]

#[path = "../../../tools/tests/repository/fresh.rs"]
mod fresh;
mod page;
mod papers;
