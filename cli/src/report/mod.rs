//! What a person looks at before cutting metal: one offline HTML page, and a picture of it as SVG.
//!
//! [`html`] makes the page of a [`Report`]: verdict, part in 3D coloured by what the verification measured, path,
//! moving tool, tables, charts and findings. Scripts and data stand in the file itself; nothing is loaded from
//! anywhere. [`svg`] makes a static picture of at most about 300 kB, which the page also shows where the browser
//! has no WebGL. Same report, same bytes.
// A library of views in itself: the commands of this version need not use every one.
#![allow(dead_code, unused_imports)]

mod chart;
pub mod curves;
mod data;
pub mod fill;
mod joint_chart;
pub mod legend;
pub mod machine;
pub mod measured;
mod mesh;
mod opening;
mod pack;
mod page;
mod picture;
pub mod project;
pub mod sheet;
mod simplify;
pub mod sweep;
pub mod text;
mod tool_body;
mod viewer;

#[cfg(test)]
mod tests;

pub use data::{
    Column, FaceMesh, Histogram, Holder, Link, Outcome, Pace, PaceStep, Pass, PathPoints, Report, Scalar,
    Stage, Table, Tool, ToolPose, Verdict, Worst,
};
pub use page::html;
pub use picture::{PartColours, PathColours, View, svg};
pub use project::Direction;
