//! Material removal against closed forms, against brute force, and on planted faults.

mod brute_force;
mod closed_forms;
mod collisions;
mod common;
mod gouges;
mod hidden;
mod prove;
mod rasters;
mod sampling;
mod stock;
mod verdicts;
mod volumes;
