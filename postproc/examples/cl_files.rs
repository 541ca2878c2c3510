//! CL files posted tool by tool in every dialect and read back: `cargo run --example cl_files -- FILE...`.
//!
//! Each file is posted for machines that reach other places than a trunnion does too, until one runs it.
#![allow(clippy::print_stdout, clippy::expect_used, dead_code)]

#[path = "../tests/common/cl_text.rs"]
mod cl_text;

use osculate_postproc::{Dialect, FeedMode, Machine};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for file in std::env::args().skip(1) {
        let bytes = std::fs::read(&file).expect("a file that can be read");
        let text = String::from_utf8_lossy(&bytes);
        let name = std::path::Path::new(&file).file_name().map(|n| n.to_string_lossy().into_owned());
        println!("{}", name.unwrap_or(file));
        for dialect in Dialect::ALL {
            for machine_name in ["trunnion-ac", "linuxcnc-xyzac", "head-ca", "head-b-table-c", "4-axis"] {
                let machine = match machine_name {
                    "4-axis" => cl_text::four_axes(),
                    name => Machine::built_in(name).expect("a built-in machine"),
                };
                let feed = if dialect == Dialect::LinuxCnc && machine.control().linuxcnc_tcp.is_none() {
                    FeedMode::InverseTime
                } else {
                    FeedMode::Tcp
                };
                match cl_text::posted(&text, &machine, dialect, feed) {
                    Err(e) => println!("  {dialect} {machine_name}: section {}: {e}", e.section),
                    Ok(posted) => {
                        let off = posted.worst_mm();
                        if off.is_err() {
                            code = ExitCode::FAILURE;
                        }
                        println!(
                            "  {dialect} {machine_name}: {} tools, {} moves: {}",
                            posted.moves.len(),
                            posted.moves.iter().map(Vec::len).sum::<usize>(),
                            off.map_or_else(|why| why, |mm| format!("come back within {mm:.6} mm"))
                        );
                        break;
                    }
                }
            }
        }
    }
    code
}
