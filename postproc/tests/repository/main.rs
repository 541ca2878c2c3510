//! Tests that read files of the repository around the package, and are not published with it: the page of dialects.
//!
//! `cargo test --test repository NAME::` runs those of one file.
#![allow(clippy::unwrap_used)]

mod page;
