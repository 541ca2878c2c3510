//! `cargo xtask interop`: outside witnesses of what this workspace writes.

mod linuxcnc;
mod lists;
mod occt;

use crate::cmd::Failure;

/// LinuxCNC's interpreter and kinematics, and a parser of G-code, on our LinuxCNC programs.
pub fn linuxcnc() -> Result<(), Failure> {
    lists::run(&linuxcnc::run()?)
}

/// OpenCASCADE on our STEP and IGES exports, or its reading time beside ours.
pub fn occt(arguments: &[&str]) -> Result<(), Failure> {
    occt::run(arguments)
}
