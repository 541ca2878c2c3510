//! `cargo xtask interop`: outside witnesses of what this workspace writes.

pub(crate) mod apart;
pub(crate) mod headless;
mod linuxcnc;
mod lists;
mod occt;
mod simulation;

use std::path::{Path, PathBuf};

use crate::cmd::Failure;

/// LinuxCNC's interpreter and kinematics, and a parser of G-code, on our LinuxCNC programs; LinuxCNC itself where it can be run.
pub fn linuxcnc() -> Result<(), Failure> {
    let witness = linuxcnc::run()?;
    lists::run(&witness)?;
    simulation::run(&witness)
}

/// The files of LinuxCNC's packages, unpacked below the folder.
pub(crate) fn unpacked(work: &Path) -> Result<PathBuf, Failure> {
    linuxcnc::unpack(work)
}

/// LinuxCNC itself alone.
pub fn simulation() -> Result<(), Failure> {
    simulation::run(&linuxcnc::witness()?)
}

/// OpenCASCADE on our STEP and IGES exports, or its reading time beside ours.
pub fn occt(arguments: &[&str]) -> Result<(), Failure> {
    occt::run(arguments)
}
