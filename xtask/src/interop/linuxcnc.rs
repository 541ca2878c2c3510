//! LinuxCNC as a witness: its interpreter reads our programs, its kinematics give back our CL points.
//!
//! Nothing is installed: the Debian packages are unpacked under `target/interop`. For every program of the example
//! `interop_linuxcnc` the stand-alone interpreter must end without an error; its canonical moves, taken as joints,
//! go through the forward kinematics of the module that LinuxCNC ships (taken as poses, there and back), and must
//! meet every CL point in order. pygcode parses the same texts.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cmd::{self, Failure};

/// How far the tip may be off a CL point, mm.
const TIP_MM: f64 = 0.002;
/// How far the axis may be off, deg.
const AXIS_DEG: f64 = 0.002;

/// Debian packages with the interpreter, its libraries and the kinematics modules, and what its user interface's module asks for.
const PACKAGES: [&str; 3] = ["linuxcnc-uspace", "libboost-python1.74.0", "libepoxy0"];
/// A file of the first and of the last one.
const UNPACKED: [&str; 2] = ["usr/bin/rs274", "usr/lib/x86_64-linux-gnu/libepoxy.so.0"];

/// The worst of one program.
#[derive(Default)]
pub(super) struct Worst {
    pub tip_mm: f64,
    pub axis_deg: f64,
    pub points: usize,
}

impl Worst {
    /// Whether all is near enough.
    pub fn fine(&self) -> bool {
        self.points > 0 && self.tip_mm <= TIP_MM && self.axis_deg <= AXIS_DEG
    }
}

/// LinuxCNC, ready to be asked.
pub(super) struct Witness {
    pub root: PathBuf,
    /// The packages' files.
    pub unpacked: PathBuf,
    /// The program that calls its kinematics.
    pub kins: PathBuf,
    /// Where files for it and from it lie.
    pub work: PathBuf,
}

/// LinuxCNC's files, unpacked, and the program that calls its kinematics.
pub(super) fn witness() -> Result<Witness, Failure> {
    let root = cmd::root()?;
    let work = root.join("target/interop");
    let unpacked = unpack(&work)?;
    let kins = build_kins(&root, &work)?;
    Ok(Witness { root, unpacked, kins, work })
}

/// Compares the programs of the example.
pub(super) fn run() -> Result<Witness, Failure> {
    let Witness { root, unpacked, kins, work } = witness()?;
    let programs = work.join("linuxcnc");
    let example = ["run", "-q", "--locked", "-p", "osculate-postproc", "--example", "interop_linuxcnc", "--"];
    let mut write = cmd::cargo(&root, &example);
    write.arg(&programs);
    cmd::run(write)?;
    prepare(&root, &programs)?;
    cmd::write(&programs.join("tool.tbl"), "T1 P1 Z0 D4\n")?;
    let mut names: Vec<PathBuf> = list(&programs)?;
    names.retain(|p| p.extension().is_some_and(|e| e == "ngc") && p.with_extension("cl").exists());
    names.sort();
    println!("{:<34} {:>7} {:>12} {:>12}", "program", "points", "tip mm", "axis deg");
    let mut bad = 0;
    for program in &names {
        let moves = interpret(&unpacked, &programs, program)?;
        let worst = compare(&unpacked, &kins, program, &moves)?;
        let fine = worst.fine();
        bad += usize::from(!fine);
        let name = program.file_stem().unwrap_or_default().to_string_lossy();
        let verdict = if fine { "" } else { "  OFF" };
        println!("{name:<34} {:>7} {:>12.6} {:>12.6}{verdict}", worst.points, worst.tip_mm, worst.axis_deg);
    }
    pygcode(&work, &names)?;
    if bad > 0 || names.is_empty() {
        let why = format!("{bad} of {} programs miss CL points", names.len());
        return Err(Failure::Answer { line: "interop linuxcnc".into(), why });
    }
    println!(
        "{} programs: the interpreter accepts them, the kinematics give back every CL point",
        names.len()
    );
    Ok(Witness { root, unpacked, kins, work })
}

fn list(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let fail = |why| Failure::Read { path: folder.to_path_buf(), why };
    std::fs::read_dir(folder).map_err(fail)?.map(|e| e.map(|e| e.path()).map_err(fail)).collect()
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|why| Failure::Read { path: path.to_path_buf(), why })
}

/// The packages' files, downloaded once.
pub(super) fn unpack(work: &Path) -> Result<PathBuf, Failure> {
    let files = work.join("packages/files");
    if UNPACKED.iter().all(|f| files.join(f).exists()) {
        return Ok(files);
    }
    std::fs::create_dir_all(&files).map_err(|why| Failure::Read { path: files.clone(), why })?;
    let folder = work.join("packages");
    let mut download = Command::new("apt-get");
    download.current_dir(&folder).arg("download").args(PACKAGES);
    cmd::run(download).map_err(|_| Failure::NoPeer {
        what: "LinuxCNC",
        how: "`apt-get download` of Debian 12's linuxcnc-uspace, libboost-python1.74.0 and libepoxy0 must work",
    })?;
    for package in list(&folder)?.iter().filter(|p| p.extension().is_some_and(|e| e == "deb")) {
        let mut extract = Command::new("dpkg");
        extract.arg("-x").arg(package).arg(&files);
        cmd::run(extract)?;
    }
    Ok(files)
}

fn build_kins(root: &Path, work: &Path) -> Result<PathBuf, Failure> {
    let kins = work.join("kins");
    let mut compile = Command::new("gcc");
    compile.args(["-O1", "-rdynamic", "-o"]).arg(&kins).arg(root.join("xtask/interop/kins.c")).arg("-ldl");
    cmd::run(compile)?;
    Ok(kins)
}

/// What a configured machine has beside a program: the words that switch its kinematics.
pub(super) fn prepare(root: &Path, programs: &Path) -> Result<(), Failure> {
    let ini = root.join("xtask/interop/switch.ini");
    let text = std::fs::read_to_string(&ini).map_err(|why| Failure::Read { path: ini, why })?;
    write(&programs.join("switch.ini"), &text)?;
    for name in ["switch_on", "switch_off"] {
        write(&programs.join(format!("{name}.ngc")), &format!("o<{name}>sub\no<{name}>endsub\nM2\n"))?;
    }
    Ok(())
}

/// What the interpreter says to a program in a folder with `switch.ini` and `tool.tbl`: canonical calls.
pub(super) fn canonical(unpacked: &Path, folder: &Path, program: &Path) -> Result<String, Failure> {
    let libraries = format!("{0}/usr/lib:{0}/usr/lib/x86_64-linux-gnu", unpacked.display());
    let mut rs274 = Command::new(unpacked.join("usr/bin/rs274"));
    rs274.current_dir(folder).env("LD_LIBRARY_PATH", libraries);
    rs274.args(["-i", "switch.ini", "-g", "-n", "2", "-t", "tool.tbl"]).arg(program);
    cmd::output_quietly(rs274)
}

/// Name and numbers of a canonical call.
pub(super) fn call(line: &str) -> Option<(&str, Vec<f64>)> {
    let (head, rest) = line.split_once('(')?;
    let numbers = rest.trim_end().trim_end_matches(')').split([',', ' ']);
    Some((head.split_whitespace().last()?, numbers.filter_map(|n| n.parse().ok()).collect()))
}

/// A canonical move: x y z a b c.
pub(super) fn straight(name: &str, numbers: &[f64]) -> Option<[f64; 6]> {
    numbers.try_into().ok().filter(|_| name.starts_with("STRAIGHT_"))
}

/// The canonical moves of a program.
fn interpret(unpacked: &Path, folder: &Path, program: &Path) -> Result<Vec<[f64; 6]>, Failure> {
    let text = canonical(unpacked, folder, program)?;
    Ok(text.lines().filter_map(call).filter_map(|(name, numbers)| straight(name, &numbers)).collect())
}

/// A machine of LinuxCNC with a tilting table: its kinematics with a tool in the spindle.
pub(super) struct Kins {
    /// The program that calls a module.
    program: PathBuf,
    module: PathBuf,
    /// The joint that tilts: A is 3, B is 4.
    second: usize,
    /// Whether the words of a program are joints.
    joints: bool,
    /// The tool length offset in force, mm.
    pub length_mm: f64,
    /// Pins of the module that are not zero, as `name=value`.
    pub pins: &'static [&'static str],
}

impl Kins {
    /// Of `xyzac` or `xyzbc`, whose modules lie below `unpacked`.
    pub fn new((program, unpacked): (&Path, &Path), kind: &str, joints: bool) -> Self {
        let module = unpacked.join(format!("usr/lib/linuxcnc/modules/{kind}-trt-kins.so"));
        let second = if kind == "xyzbc" { 4 } else { 3 };
        Self { program: program.to_path_buf(), module, second, joints, length_mm: 0.0, pins: &[] }
    }

    /// Where the tip is in the part after each move: the control adds the length in force to z.
    fn poses(&self, moves: &[[f64; 6]]) -> Result<Vec<[f64; 6]>, Failure> {
        let long = |m: &[f64; 6]| [m[0], m[1], m[2] + self.length_mm, m[3], m[4], m[5]];
        let moves: Vec<[f64; 6]> = moves.iter().map(long).collect();
        // Joints are X Y Z, the tilt, C; the canonical numbers have all of A B C.
        let as_joints = |m: &[f64; 6]| [m[0], m[1], m[2], m[self.second], m[5], 0.0];
        let joints = if self.joints {
            moves.iter().map(as_joints).collect()
        } else {
            self.through("inverse", &moves)?
        };
        let mut poses = self.through("forward", &joints)?;
        poses.iter_mut().for_each(|p| p[2] -= self.length_mm);
        Ok(poses)
    }

    /// Runs numbers through the kinematics.
    pub fn through(&self, way: &str, rows: &[[f64; 6]]) -> Result<Vec<[f64; 6]>, Failure> {
        let line = |r: &[f64; 6]| r.map(|v| v.to_string()).join(" ") + "\n";
        let input: String = rows.iter().map(line).collect();
        let mut run = Command::new(&self.program);
        run.arg(&self.module).arg(way).arg(self.length_mm.to_string()).args(self.pins);
        let text = cmd::output_of(run, &input)?;
        let row = |l: &str| {
            let n: Vec<f64> = l.split_whitespace().filter_map(|w| w.parse().ok()).collect();
            <[f64; 6]>::try_from(n).ok()
        };
        Ok(text.lines().filter_map(row).collect())
    }
}

fn compare(unpacked: &Path, kins: &Path, program: &Path, moves: &[[f64; 6]]) -> Result<Worst, Failure> {
    let name = program.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let kind = if name.starts_with("xyzbc") { "xyzbc" } else { "xyzac" };
    let cl = program.with_extension("cl");
    let text = std::fs::read_to_string(&cl).map_err(|why| Failure::Read { path: cl, why })?;
    let row = |line: &str| -> Vec<f64> { line.split_whitespace().filter_map(|w| w.parse().ok()).collect() };
    let points: Vec<Vec<f64>> = text.lines().map(row).collect();
    Kins::new((kins, unpacked), kind, name.contains("-joint-")).meets(moves, &points)
}

impl Kins {
    /// How far the moves of a program stay off CL points, x y z i j k each, that they are to come to in order.
    pub fn meets(&self, moves: &[[f64; 6]], points: &[Vec<f64>]) -> Result<Worst, Failure> {
        let poses = self.poses(moves)?;
        Ok(met(&poses, points, self.second))
    }
}

fn met(poses: &[[f64; 6]], points: &[Vec<f64>], second: usize) -> Worst {
    let mut worst = Worst::default();
    let mut at = 0;
    for want in points {
        let off = |p: &[f64; 6]| (tip_off(p, want), axis_off(&axis(p, second), &want[3..]));
        // The first pose from here on that is near enough; else the nearest one says by how much it is not.
        let near = poses[at..].iter().position(|p| {
            let (tip, turn) = off(p);
            tip <= TIP_MM && turn <= AXIS_DEG
        });
        let (tip, turn) = match near {
            Some(k) => {
                at += k;
                off(&poses[at])
            }
            None => {
                let all = poses[at..].iter().map(off);
                all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, f64::INFINITY))
            }
        };
        worst.tip_mm = worst.tip_mm.max(tip);
        worst.axis_deg = worst.axis_deg.max(turn);
        worst.points += 1;
    }
    worst
}

fn tip_off(pose: &[f64; 6], want: &[f64]) -> f64 {
    (0..3).map(|k| (pose[k] - want[k]).powi(2)).sum::<f64>().sqrt()
}

/// The tool in the part of a tilting table of LinuxCNC: the table turns right-handed by the tilt, then by C, so the
/// tool turns back about C and the tilt.
fn axis(pose: &[f64; 6], second: usize) -> [f64; 3] {
    let (s, c) = pose[second].to_radians().sin_cos();
    let tilted = if second == 4 { [-s, 0.0, c] } else { [0.0, s, c] };
    let (s, c) = pose[5].to_radians().sin_cos();
    [tilted[0] * c + tilted[1] * s, -tilted[0] * s + tilted[1] * c, tilted[2]]
}

fn axis_off(axis: &[f64; 3], want: &[f64]) -> f64 {
    let cross = [
        axis[1] * want[2] - axis[2] * want[1],
        axis[2] * want[0] - axis[0] * want[2],
        axis[0] * want[1] - axis[1] * want[0],
    ];
    let sine = cross.iter().map(|v| v * v).sum::<f64>().sqrt();
    let cosine: f64 = axis.iter().zip(want).map(|(a, b)| a * b).sum();
    sine.atan2(cosine).to_degrees()
}

/// pygcode parses every line of every program.
pub(super) fn pygcode(work: &Path, programs: &[PathBuf]) -> Result<(), Failure> {
    let folder = work.join("pygcode");
    if !folder.join("pygcode").exists() {
        let mut install = Command::new("python3");
        install.args(["-m", "pip", "install", "-q", "--target"]).arg(&folder).arg("pygcode");
        cmd::run(install)?;
    }
    let script = "import sys\nfrom pygcode import Line\n\
                  n = 0\n\
                  for f in sys.argv[1:]:\n    for k, l in enumerate(open(f), 1):\n        \
                  try: Line(l.rstrip()); n += 1\n        \
                  except Exception as e: sys.exit(f'{f}:{k}: {l.rstrip()}: {e}')\n\
                  print(f'pygcode parses {n} lines')\n";
    let mut parse = Command::new("python3");
    parse.env("PYTHONPATH", &folder).arg("-c").arg(script).args(programs);
    cmd::run(parse)
}
