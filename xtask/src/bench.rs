//! `cargo xtask bench [--peers]`: the kernel's times, and OpenCASCADE's and SISL's beside them in one run.
//!
//! The peers are two small programs in `xtask/peers` over Debian's `libocct-*-dev` and `libsisl-dev`, compiled
//! with g++ when asked for. Ours and theirs take turns, and the best of both turns counts: a machine that is
//! busy slows all alike.

use crate::cmd::{self, Failure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Times by their names, ns.
type Times = BTreeMap<String, f64>;

/// Turns that ours and the peers take.
const TURNS: usize = 2;

/// A line of the table: its title, our name, OpenCASCADE's names (the better one counts) and SISL's.
const LINES: [(&str, &str, &[&str], &str); 9] = [
    ("point, random", "point", &["point direct random", "point adaptor random"], "point random"),
    ("jet (2nd order), random", "jet", &["jet direct random", "jet adaptor random"], "jet random"),
    (
        "jet, ordered by piece, batch",
        "jets in blocks, ordered",
        &["jet direct ordered", "jet adaptor ordered"],
        "jet ordered",
    ),
    (
        "jet, random, batch",
        "jets in blocks, random",
        &["jet direct random", "jet adaptor random"],
        "jet random",
    ),
    ("principal curvatures", "principal curvatures", &["principal"], "principal"),
    ("principal curvatures, batch", "curvatures in blocks, ordered", &["principal"], "principal"),
    ("closest, hint", "closest, 3 mm above, hint", &[], "closest hint"),
    ("closest, 3 mm above", "closest, 3 mm above, whole", &["closest above"], "closest above"),
    ("closest, far", "closest, far, whole", &["closest far"], "closest far"),
];

/// A peer program.
struct Peer {
    name: &'static str,
    source: &'static str,
    flags: &'static [&'static str],
    /// What to install where it does not build.
    packages: &'static str,
}

const PEERS: [Peer; 2] = [
    Peer {
        name: "OpenCASCADE",
        source: "occt.cpp",
        flags: &[
            "-I/usr/include/opencascade",
            "-lTKGeomAlgo",
            "-lTKGeomBase",
            "-lTKG3d",
            "-lTKG2d",
            "-lTKMath",
            "-lTKernel",
        ],
        packages: "libocct-modeling-algorithms-dev libocct-modeling-data-dev libocct-foundation-dev",
    },
    Peer { name: "SISL", source: "sisl.cpp", flags: &["-lsisl"], packages: "libsisl-dev" },
];

/// Runs the benches and prints the table.
pub fn run(peers: bool) -> Result<(), Failure> {
    let root = cmd::root()?;
    let built: Vec<Option<PathBuf>> =
        PEERS.iter().map(|p| if peers { build(&root, p) } else { Ok(None) }).collect::<Result<_, _>>()?;
    let mut ours: BTreeMap<String, Times> = BTreeMap::new();
    let mut theirs: Vec<BTreeMap<String, Times>> = vec![BTreeMap::new(); PEERS.len()];
    let mut version = String::new();
    for _ in 0..if peers { TURNS } else { 1 } {
        let bench = ["bench", "-q", "-p", "osculate-surfaces", "--bench", "kernel"];
        for line in output(&mut cmd::cargo(&root, &bench))?.lines() {
            if let [surface, what, time] = line.split('\t').collect::<Vec<_>>()[..] {
                keep(ours.entry(surface.to_string()).or_default(), what, time);
            }
        }
        for (k, program) in built.iter().enumerate() {
            let Some(program) = program else { continue };
            for (surface, short) in [("polynomial", "poly"), ("rational", "rat")] {
                let data = root.join("surfaces/tests/data");
                let mut command = Command::new(program);
                command
                    .arg(data.join(format!("surf_{short}.txt")))
                    .arg(data.join(format!("far_{short}.txt")));
                for line in output(&mut command)?.lines() {
                    match line.split_once('\t') {
                        Some(("version", v)) => version = v.to_string(),
                        Some((what, time)) => {
                            keep(theirs[k].entry(surface.to_string()).or_default(), what, time)
                        }
                        None => {}
                    }
                }
            }
        }
    }
    for (surface, times) in &ours {
        print(surface, times, &theirs, &version);
    }
    Ok(())
}

/// Keeps the better of two times.
fn keep(times: &mut Times, what: &str, time: &str) {
    if let Ok(t) = time.trim().parse::<f64>() {
        times.entry(what.to_string()).and_modify(|old| *old = old.min(t)).or_insert(t);
    }
}

/// What a program prints.
fn output(command: &mut Command) -> Result<String, Failure> {
    let line = format!("{command:?}");
    let done = command.output().map_err(|why| Failure::Start { line: line.clone(), why })?;
    if !done.status.success() {
        return Err(Failure::Status { line, status: done.status });
    }
    Ok(String::from_utf8_lossy(&done.stdout).into_owned())
}

/// Compiles a peer into the target folder; `None`, said plainly, where that is not possible here.
fn build(root: &Path, peer: &Peer) -> Result<Option<PathBuf>, Failure> {
    let folder = root.join("target/peers");
    std::fs::create_dir_all(&folder).map_err(|why| Failure::Read { path: folder.clone(), why })?;
    let program = folder.join(peer.source.trim_end_matches(".cpp"));
    let mut command = Command::new("g++");
    command.args(["-O2", "-w", "-std=c++17"]).arg(root.join("xtask/peers").join(peer.source));
    command.args(["-o".as_ref(), program.as_os_str()]).args(peer.flags);
    match command.output() {
        Ok(done) if done.status.success() => Ok(Some(program)),
        Ok(done) => {
            let said = String::from_utf8_lossy(&done.stderr).into_owned();
            let why = said.lines().find(|l| l.contains("error") || l.contains("cannot find")).unwrap_or("");
            println!("{} is missing: {why}\n  on Debian: apt-get install {}", peer.name, peer.packages);
            Ok(None)
        }
        Err(why) => {
            println!("{} is missing: g++ does not start: {why}", peer.name);
            Ok(None)
        }
    }
}

fn print(surface: &str, ours: &Times, theirs: &[BTreeMap<String, Times>], version: &str) {
    let empty = Times::new();
    let of = |k: usize| theirs[k].get(surface).unwrap_or(&empty);
    let occt = if version.is_empty() { "OCCT".to_string() } else { format!("OCCT {version}") };
    println!("\n{surface}, bicubic 10 x 10, ns a call");
    println!("{:<30} {:>10} {:>12} {:>7} {:>12} {:>7}", "", "ours", occt, "ratio", "SISL", "ratio");
    for (title, name, names, sisl) in LINES {
        let Some(t) = ours.get(name) else { continue };
        let best = names.iter().filter_map(|n| of(0).get(*n)).copied().reduce(f64::min);
        let columns = [best, of(1).get(sisl).copied()].map(|x| match x {
            Some(x) => format!("{x:>12.1} {:>6.1}x", x / t),
            None => format!("{:>12} {:>7}", "-", ""),
        });
        println!("{title:<30} {t:>10.1} {} {}", columns[0], columns[1]);
    }
    for (name, value) in ours {
        if name.starts_with("wrong") {
            let wrong = |k: usize| of(k).get("wrong far").map_or("-".to_string(), |w| format!("{w}"));
            println!("{name:<30} {value:>10} {:>12} {:>7} {:>12}", wrong(0), "", wrong(1));
        }
    }
    for (name, line) in [
        ("a million curvatures", "a million curvatures, all threads"),
        ("a million, of a grid", "a million curvatures of a grid, all threads"),
    ] {
        if let Some(t) = ours.get(line) {
            println!("{name:<30} {:>8.4} s", t * 1e-9);
        }
    }
}
