//! `cargo xtask interop`: outside witnesses of what this workspace writes.

mod linuxcnc;

use crate::cmd::Failure;

/// LinuxCNC's interpreter and kinematics, and a parser of G-code, on our LinuxCNC programs.
pub fn linuxcnc() -> Result<(), Failure> {
    linuxcnc::run()
}
