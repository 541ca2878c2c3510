//! Tests of strips, plans and their choice through the public names of the crate.
//!
//! One program for all of them: each file is a module, `cargo test --test all NAME::` runs one.
#![allow(clippy::unwrap_used)]

mod access;
mod against_exact;
mod axis;
mod compare;
mod contour;
#[path = "common/cutting.rs"]
mod cutting;
mod dense;
mod drop;
#[path = "common/dropped.rs"]
mod dropped;
mod errata;
mod fixed_axis;
mod gradient;
#[path = "common/heights.rs"]
mod heights;
mod isoparametric;
mod lead;
mod leave_out;
mod level;
#[path = "common/limits.rs"]
mod limits;
mod links;
mod optimum;
mod real_time;
mod regions;
mod rough;
mod side_tilt;
mod swings;
mod waterline;
mod z_level;
