//! From a job to a program and its proof: choosing, passes, posting, verification, and what is told of them.

pub mod axes;
pub mod budget;
pub mod check;
pub mod choice;
pub mod drop;
pub mod extras;
pub mod flank;
pub mod goal;
pub mod ideal;
pub mod import;
pub mod joints;
pub mod left_out;
pub mod look;
pub mod nc;
pub mod opinion;
pub mod passes;
pub mod plan;
pub mod ply;
pub mod posted_setup;
pub mod program;
pub mod reading;
pub mod rough;
pub mod setup;
pub mod stock;
pub mod summary;
pub mod verify;
