//! What verbs take of memory and processor time, as multiples of the size of the files that they read: the bounds of `docs/bounds.md`.
#![cfg(target_os = "linux")]

use crate::common;
use common::{Scratch, osculate};
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Memory whatever the file, MiB: the program, threads, buffers, samples.
const ALWAYS_MIB: f64 = 26.0;
/// Processor time whatever the file, s.
const ALWAYS_S: f64 = 2.0;
/// How often a run is looked at.
const EVERY: Duration = Duration::from_millis(4);
const MIB: f64 = 1024.0 * 1024.0;
/// Ticks of the system's clock in a second.
const TICKS_PER_S: f64 = 100.0;

/// A verb on a file with what it may take.
struct Bound {
    line: &'static str,
    /// The file whose size counts.
    file: &'static str,
    /// Memory in sizes of the file, the file itself included.
    times: f64,
    /// Processor time for each MiB of the file: four times what `docs/bounds.md` says, for slow and shared machines, s.
    s_per_mib: f64,
}

const fn bound(line: &'static str, file: &'static str, times: f64, s_per_mib: f64) -> Bound {
    Bound { line, file, times, s_per_mib }
}

#[rustfmt::skip]
const BOUNDS: [Bound; 21] = [
    bound("inspect faces.step --json", "faces.step", 6.0, 4.0),
    bound("probe faces.step --face F1 --at 0.5,0.5", "faces.step", 6.0, 1.0),
    bound("export faces.step --out out.stl", "faces.step", 6.0, 2.0),
    bound("export faces.step --out out.igs", "faces.step", 6.0, 2.0),
    bound("inspect faces.igs --json", "faces.igs", 6.0, 4.0),
    bound("export faces.igs --out out.step", "faces.igs", 6.0, 2.0),
    bound("inspect faces.json --json", "faces.json", 12.0, 4.0),
    bound("export faces.json --out out2.step", "faces.json", 15.0, 2.0),
    bound("inspect mesh.stl", "mesh.stl", 8.0, 1.0),
    bound("inspect mesh.ply", "mesh.ply", 15.0, 2.0),
    bound("verify small.cl --job mesh.toml", "mesh.stl", 9.0, 4.0),
    bound("time program.nc --machine trunnion-ac", "program.nc", 0.5, 1.0),
    bound("readback program.nc --machine trunnion-ac --out back.cl", "program.nc", 0.5, 2.0),
    bound("verify program.nc --job plane.toml --lenient", "program.nc", 20.0, 8.0),
    bound("post path.cl --machine trunnion-ac --dialect heidenhain --out out.h", "path.cl", 2.0, 1.0),
    bound("verify path.cl --job plane.toml", "path.cl", 20.0, 8.0),
    bound("check remarks.toml", "remarks.toml", 20.0, 4.0),
    bound("machines --check machine.toml", "machine.toml", 20.0, 4.0),
    bound("tools library.toml", "library.toml", 40.0, 2.0),
    bound("tools library.tbl", "library.tbl", 40.0, 2.0),
    bound("tools library.json", "library.json", 40.0, 2.0),
];

const JOB: &str = "[tool]\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 30\n[tolerance]\nscallop_mm = 0.05\ngouge_mm = 0.05\n\
    [cutting]\nfeed_mm_min = 1000\n[machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\n[verification]\nmax_samples = 2000\n";
const PLANE: &str = "builtin = { kind = \"plane\", u_range = [0, 20], v_range = [0, 20] }\n";

/// Rational bicubic faces side by side, as the JSON of faces.
fn faces(count: usize) -> String {
    let poles = 14;
    let face = |k: usize| {
        let at = |i: usize, j: usize| {
            let [x, y] = [i, j].map(|n| 9.0 * n as f64 / 13.0);
            let z = (0.7 * i as f64 + 0.3 * j as f64 + k as f64).sin();
            format!("[{:?},{y:?},{z:?}]", 10.0 * k as f64 + x)
        };
        let rows = |of: &dyn Fn(usize, usize) -> String| {
            let row = |i: usize| (0..poles).map(|j| of(i, j)).collect::<Vec<_>>().join(",");
            (0..poles).map(|i| format!("[{}]", row(i))).collect::<Vec<_>>().join(",")
        };
        let inner = (1..poles - 3).map(|n| format!("{:?}", n as f64 / 11.0)).collect::<Vec<_>>().join(",");
        let knots = format!("[0,0,0,0,{inner},1,1,1,1]");
        let weights = rows(&|i, j| format!("{:?}", 1.0 + 0.1 * (i * j % 3) as f64));
        format!(
            "{{\"id\":\"F{}\",\"kind\":\"bspline\",\"oriented\":true,\"side\":\"along\",\"surface\":{{\"nurbs\":{{\"degree\":[3,3],\
             \"knots\":[{knots},{knots}],\"poles_mm\":[{}],\"weights\":[{weights}],\"side\":\"along\"}}}}}}",
            k + 1,
            rows(&at)
        )
    };
    let all: Vec<String> = (0..count).map(face).collect();
    format!("{{\"format\":1,\"faces\":[{}]}}", all.join(","))
}

/// A raster over the plane as a program and as CL data.
fn moves(count: usize) -> [String; 2] {
    let mut nc = "O1\nG17 G21 G90 G94\nT1 M6\nS8000 M3\nG0 X0 Y0 Z40 A0 C0\n".to_owned();
    let mut cl = "UNITS/MM\nCUTTER/6, 3, 0, 0, 0, 0, 30\nSPINDL/RPM,8000,CLW\nRAPID\nGOTO/0,0,40,0,0,1\n\
                  FEDRAT/1000,MMPM\n"
        .to_owned();
    for k in 0..count {
        let (x, y, z) = (0.1 * (k % 200) as f64, 0.02 * (k / 200) as f64, (0.01 * k as f64).sin());
        writeln!(nc, "G1 X{x:.3} Y{y:.3} Z{z:.4} F1000").unwrap();
        writeln!(cl, "GOTO/{x:.4},{y:.4},{z:.5},0,0,1").unwrap();
    }
    [nc + "G0 Z40\nM30\n", cl + "FINI\n"]
}

/// Waves over the plane as binary STL and as PLY as text.
fn mesh(side: usize) -> (Vec<u8>, String) {
    let at = |i: usize, j: usize| {
        let [x, y] = [i, j].map(|n| 20.0 * n as f64 / side as f64);
        [x, y, (0.3 * x).sin() * (0.2 * y).cos()].map(|c| c as f32)
    };
    let cells = || (0..side).flat_map(|i| (0..side).map(move |j| (i, j)));
    let mut stl = vec![b' '; 80];
    stl.extend((2 * side * side).to_le_bytes()[..4].iter());
    let mut ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        (side + 1) * (side + 1),
        2 * side * side
    );
    for (i, j) in (0..=side).flat_map(|i| (0..=side).map(move |j| (i, j))) {
        let [x, y, z] = at(i, j);
        writeln!(ply, "{x} {y} {z}").unwrap();
    }
    for (i, j) in cells() {
        for t in [[(i, j), (i + 1, j), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i, j + 1)]] {
            stl.extend([0; 12]);
            t.iter().flat_map(|(i, j)| at(*i, *j)).for_each(|x| stl.extend(x.to_le_bytes()));
            stl.extend([0; 2]);
            let [a, b, c] = t.map(|(i, j)| i * (side + 1) + j);
            writeln!(ply, "3 {a} {b} {c}").unwrap();
        }
    }
    (stl, ply)
}

/// The most memory, MiB, and the processor time, s, of a run in a folder.
fn taken(folder: &Path, line: &str) -> (f64, f64) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("RAYON_NUM_THREADS", "2")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let place = format!("/proc/{}", child.id());
    let (mut memory, mut time) = (0.0, 0.0);
    loop {
        let status = std::fs::read_to_string(format!("{place}/status")).unwrap_or_default();
        let peak = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
        if let Some(kib) = peak.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok()) {
            memory = kib / 1024.0;
        }
        let stat = std::fs::read_to_string(format!("{place}/stat")).unwrap_or_default();
        let ticks = |n: usize| stat.rsplit_once(')')?.1.split_whitespace().nth(n)?.parse::<f64>().ok();
        if let (Some(user), Some(system)) = (ticks(11), ticks(12)) {
            time = (user + system) / TICKS_PER_S;
        }
        if let Some(done) = child.try_wait().unwrap() {
            // 1 is an answer too: not held.
            assert!(done.code().is_some_and(|c| c < 2), "{line}: {done}");
            return (memory, time);
        }
        std::thread::sleep(EVERY);
    }
}

#[test]
fn memory_and_time_go_with_the_size_of_the_file() {
    let scratch = Scratch::new();
    scratch.write("faces.json", &faces(150));
    for to in ["faces.step", "faces.igs"] {
        let [from, to] = ["faces.json", to].map(|n| scratch.path(n).to_str().unwrap().to_owned());
        assert_eq!(osculate(&["export", &from, "--out", &to]).code, 0);
    }
    let [nc, cl] = moves(60_000);
    scratch.write("program.nc", &nc);
    scratch.write("path.cl", &cl);
    scratch.write("small.cl", &moves(400)[1]);
    let (stl, ply) = mesh(150);
    std::fs::write(scratch.path("mesh.stl"), stl).unwrap();
    scratch.write("mesh.ply", &ply);
    let job = |part: &str, more: &str| format!("format = 1\n{more}[part]\n{part}{JOB}");
    scratch.write("plane.toml", &job(PLANE, ""));
    scratch.write("mesh.toml", &job("file = \"mesh.stl\"\n", ""));
    let remarks = "# nothing that a job asks for, but a line that is read all the same\n".repeat(15_000);
    scratch.write("remarks.toml", &job(PLANE, &remarks));
    let machine = osculate_postproc::built_in_text("trunnion-ac").unwrap();
    scratch.write("machine.toml", &format!("{remarks}{machine}"));
    let tool = |n: usize| {
        format!(
            "[[tool]]\nnumber = {n}\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 40\nteeth = 2\n\
             cutting = {{ spindle_rpm = 9000, feed_mm_min = 1500 }}\n"
        )
    };
    scratch.write("library.toml", &("format = 1\n".to_owned() + &(1..=9999).map(tool).collect::<String>()));
    // All tools of a table with one number: each is given the next free one.
    let line = |n: usize| format!("T1 P{n} Z+40 D+6 ;ball {n}\n");
    scratch.write("library.tbl", &(1..=9999).map(line).collect::<String>());
    let [from, to] = ["library.toml", "library.json"].map(|n| scratch.path(n).to_str().unwrap().to_owned());
    assert_eq!(osculate(&["tools", &from, "--out", &to]).code, 0);
    let folder = scratch.path("");
    let mut over = String::new();
    for Bound { line, file, times, s_per_mib } in &BOUNDS {
        let size = std::fs::metadata(scratch.path(file)).unwrap().len() as f64 / MIB;
        let (memory, time) = taken(&folder, line);
        let words = format!("{line}: {memory:.1} MiB and {time:.2} s for {size:.2} MiB");
        println!("{words}");
        if memory > ALWAYS_MIB + times * size || time > ALWAYS_S + s_per_mib * size {
            writeln!(over, "{words}").unwrap();
        }
    }
    assert!(over.is_empty(), "beyond {ALWAYS_MIB} MiB and so many sizes of the file:\n{over}");
}
