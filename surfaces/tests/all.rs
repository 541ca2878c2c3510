//! Tests of surfaces, files and bodies through the public names of the crate.
//!
//! One program for all of them: each file is a module, `cargo test --test all NAME::` runs one.
#![allow(clippy::unwrap_used)]

mod approximate;
mod bodies;
mod closest;
mod closest_face;
mod common;
mod convert;
mod degenerate;
mod edit;
mod edit_degree;
mod exact;
mod export_iges;
mod export_pcurves;
mod export_step;
mod fit;
mod groups;
mod hidden;
mod import_assembly;
mod import_bombs;
mod import_dialects;
mod import_iges;
mod import_iges_kinds;
mod import_iges_tree;
mod import_loops;
mod import_patches;
mod import_sections;
mod import_step;
mod import_trim;
mod json;
mod kernel;
mod kernel_batch;
mod laws;
mod lines_contours;
mod lines_curvature;
mod lines_noise;
mod mesh;
mod part21;
mod pattern;
mod punched;
mod ruling;
mod sides;
mod solids;
mod stl;
mod thin;
mod turned;
