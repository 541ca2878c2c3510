//! `interop`: what OpenCASCADE makes of our exports, and how long both take to read a file.
//!
//! OpenCASCADE comes as a Python package into `target/peers/occt`; `xtask/peers/occt.py` asks it. Every part is exported
//! as STEP and as IGES and read by OpenCASCADE together with the original: the faces must be as many, valid, and have
//! the original's areas to 1e-6 and ours to 1e-5 (`equal`), or ours alone (the original has parameter curves that say something
//! else than its space curves), or differ from ours by no more than the tolerances leave open that OpenCASCADE itself gives
//! the edges, each times its length: where edges lie off their surface, it may take other feet. A face whose area by
//! OpenCASCADE's own rule is not ours is integrated once more by Gauss panels between the knots, along OpenCASCADE's own parameter
//! curves; the line says how many.

use crate::cmd::{Failure, cargo, output, root, run as start};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Parts of the repository that are compared where none are named.
const PARTS: [&str; 3] = [
    "examples/wigley-hull/hull.step",
    "examples/propeller/propeller.step",
    "examples/eee-hpt-rotor2/blade.igs",
];

/// How often a file is read for its time.
const TIMES: &str = "7";

const HOW: &str = "python3 -m venv target/peers/occt && target/peers/occt/bin/pip install cadquery-ocp-novtk";

/// Compares, or times.
pub fn run(arguments: &[&str]) -> Result<(), Failure> {
    let root = root()?;
    let python = peer(&root)?;
    match arguments {
        ["--time", file] => return time(&root, &python, file),
        ["--time"] => return time(&root, &python, &rational_faces(&root)?),
        _ => {}
    }
    let parts: Vec<&str> = if arguments.is_empty() { PARTS.to_vec() } else { arguments.to_vec() };
    start(cargo(&root, &["build", "--release", "--quiet", "-p", "osculate"]))?;
    let folder = root.join("target/interop");
    std::fs::create_dir_all(&folder).map_err(|why| Failure::Read { path: folder.clone(), why })?;
    println!(
        "{:36} {:>6} {:>6} {:>6} {:>6} {:>6} {:>10} {:>10}",
        "export", "faces", "theirs", "kinds", "solids", "valid", "to occt", "to ours"
    );
    let mut different = 0;
    for part in parts {
        let stem = Path::new(part).file_stem().map_or_else(|| "part".into(), |s| s.to_string_lossy());
        let inspect = folder.join(format!("{stem}.json"));
        let answer = output(osculate(&root, &["inspect", part, "--json"]))?;
        std::fs::write(&inspect, answer).map_err(|why| Failure::Read { path: inspect.clone(), why })?;
        let exports = ["step", "igs"].map(|ending| folder.join(format!("{stem}.{ending}")));
        for path in &exports {
            output(osculate(&root, &["export", part, "--out", &path.to_string_lossy()]))?;
        }
        let mut compare = Command::new(&python);
        compare.current_dir(&root).arg("xtask/peers/occt.py").arg("--compare").arg(&inspect).arg(part);
        compare.args(&exports);
        match start(compare) {
            Ok(()) => {}
            Err(Failure::Status { .. }) => different += 1,
            Err(other) => return Err(other),
        }
    }
    if different > 0 { Err(Failure::Differs(different)) } else { Ok(()) }
}

/// A Python that has OpenCASCADE.
fn peer(root: &Path) -> Result<PathBuf, Failure> {
    let own = root.join("target/peers/occt/bin/python");
    let candidates = [own, PathBuf::from("python3")];
    let has = |python: &PathBuf| {
        let mut ask = Command::new(python);
        ask.args(["-c", "import OCP.STEPControl"]).stderr(std::process::Stdio::null());
        ask.status().is_ok_and(|s| s.success())
    };
    candidates.into_iter().find(has).ok_or(Failure::NoPeer { what: "OpenCASCADE for Python", how: HOW })
}

fn osculate(root: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(crate::cmd::built(root, "osculate"));
    command.current_dir(root).args(arguments);
    command
}

/// A file of 200 rational faces, always the same.
fn rational_faces(root: &Path) -> Result<String, Failure> {
    let folder = root.join("target/interop");
    std::fs::create_dir_all(&folder).map_err(|why| Failure::Read { path: folder.clone(), why })?;
    let file = folder.join("rational-faces.step").to_string_lossy().into_owned();
    let run =
        ["run", "--release", "--quiet", "-p", "osculate-surfaces", "--example", "rational_faces", &file];
    start(cargo(root, &run))?;
    Ok(file)
}

/// Both readers on one file, one after the other on the same machine.
fn time(root: &Path, python: &Path, file: &str) -> Result<(), Failure> {
    let example = ["build", "--release", "--quiet", "-p", "osculate-surfaces", "--example", "read_time"];
    start(cargo(root, &example))?;
    let mut ours = Command::new(crate::cmd::built(root, "examples/read_time"));
    ours.current_dir(root).args([TIMES, file]);
    let mut theirs = Command::new(python);
    theirs.current_dir(root).args(["xtask/peers/occt.py", "--time", TIMES, file]);
    println!("ours: {}", output(ours)?.trim());
    let answer = output(theirs)?;
    println!("occt: {}", answer.lines().find(|l| l.starts_with('{')).unwrap_or_default());
    Ok(())
}
