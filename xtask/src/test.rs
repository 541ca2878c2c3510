//! `cargo xtask test`: every test of every crate, doctests included, against the committed lock file.

use crate::cmd::{Failure, cargo, root, run as run_command};

/// Runs the tests; `rest` is handed on to `cargo test`.
pub fn run(rest: &[&str]) -> Result<(), Failure> {
    let root = root()?;
    let arguments = [&["test", "--workspace", "--locked"], rest].concat();
    run_command(cargo(&root, &arguments))
}
