//! Programs for LinuxCNC beside the CL points that they must come back to, for an outside witness to read.
//!
//! `cargo run -p osculate-postproc --example interop_linuxcnc -- FOLDER` writes `NAME.ngc`, and `NAME.cl` with one
//! line a CL point: tip x y z in mm and axis i j k. The name begins with the kinematics module and says whether the
//! words are joints or poses.
#![allow(clippy::print_stderr, clippy::expect_used)]

#[path = "../tests/common/blade.rs"]
mod blade;

use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, post};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: interop_linuxcnc FOLDER");
        return ExitCode::from(2);
    };
    match write_all(&folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("interop_linuxcnc: {e}");
            ExitCode::FAILURE
        }
    }
}

fn write_all(folder: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    let modes = [
        ("tcp", FeedMode::Tcp),
        ("none", FeedMode::None),
        ("kf", FeedMode::Kf),
        ("kv", FeedMode::Kv { fgref_mm: None }),
        ("inverse", FeedMode::InverseTime),
    ];
    for kinematics in ["xyzac", "xyzbc"] {
        let machine = Machine::built_in(&format!("linuxcnc-{kinematics}"))?;
        for (path_name, path) in blade::five_axis() {
            for (mode_name, mode) in modes {
                let options = PostOptions::new(Dialect::LinuxCnc, mode);
                let posted = post(&path, &machine, &Setup::default(), &options)?;
                let words = if mode == FeedMode::Tcp { "pose" } else { "joint" };
                let name = format!("{kinematics}-{words}-{path_name}-{mode_name}");
                std::fs::write(folder.join(format!("{name}.ngc")), posted.text)?;
                let mut points = String::new();
                for m in &path.moves {
                    let (p, a) = (m.pose.tip, m.pose.axis);
                    writeln!(points, "{} {} {} {} {} {}", p.x, p.y, p.z, a.x, a.y, a.z)?;
                }
                std::fs::write(folder.join(format!("{name}.cl")), points)?;
            }
        }
    }
    Ok(())
}
