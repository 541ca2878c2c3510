//! Material removal against closed forms, against brute force, and on planted faults.

mod brute_force;
mod closed_forms;
mod collisions;
mod common;
mod edges;
mod frozen;
mod gouges;
mod hidden;
mod prove;
mod rasters;
mod sampling;
mod several;
mod stock;
mod stock_mesh;
mod verdicts;
mod volumes;
