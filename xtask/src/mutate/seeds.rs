//! Whole files of every kind, with the verbs that read them.

use super::kind::{KINDS, Kind};
use super::made;
use crate::cmd::Failure;
use std::path::{Path, PathBuf};

/// Files that are larger take too long for thousands of runs, bytes.
const LARGEST: u64 = 400_000;
/// Places in a collection.
const FOLDERS: [&str; 10] = [
    "files/step",
    "files/step_micro",
    "files/iges",
    "files/iges_micro",
    "files/bezier",
    "files/blade",
    "files/nc",
    "files/cl",
    "files/malformed",
    "step_dialects",
];

/// A file that is whole.
pub struct Seed {
    pub name: String,
    pub bytes: Vec<u8>,
    /// Files that a run needs beside it.
    pub beside: Vec<(String, Vec<u8>)>,
    kind: Kind,
}

impl Seed {
    /// The command lines on it: those that every file of the kind gets, and one of the others, which take turns.
    pub fn runs(&self, turn: usize) -> Vec<Vec<String>> {
        let (always, others) = lines(self.kind);
        let other = (!others.is_empty()).then(|| &others[turn % others.len()]);
        let name = |w: &str| if w == "FILE" { self.name.clone() } else { w.to_owned() };
        let words = |line: &&str| line.split_whitespace().map(name).chain(["--json".to_owned()]).collect();
        always.iter().chain(other).map(words).collect()
    }
}

/// The command lines on a file of a kind: those that every one gets, and those that take turns. Results lie in folders of the run.
const fn lines(kind: Kind) -> (&'static [&'static str], &'static [&'static str]) {
    match kind {
        Kind::Part => (
            &["inspect FILE", "verify path-of.cl --job job-of.toml"],
            &[
                "inspect FILE --groups --out faces",
                "export FILE --out out.stl",
                "export FILE --out out.step",
                "export FILE --out out.igs",
                "export FILE --out out.json",
                "export FILE --out out.obj",
                "probe FILE --face F1 --at 0.5,0.5",
                "lines FILE --face F1 --out lines",
                "init FILE --faces F1 --out init",
                "check job-of.toml",
            ],
        ),
        Kind::Mesh => (
            &["inspect FILE", "verify path-of.cl --job job-of.toml"],
            &[
                "verify path-of.cl --job stock-of.toml",
                "plan job-of.toml --out plan",
                "export FILE --out out.step",
            ],
        ),
        Kind::Program => (
            &["time FILE --machine trunnion-ac", "verify FILE --job job-of.toml --lenient"],
            &[
                "readback FILE --machine trunnion-ac --out back.cl",
                "time FILE --machine 3-axis --dialect sinumerik",
                "time FILE --machine trunnion-bc --dialect heidenhain",
                "readback FILE --machine linuxcnc-xyzac --dialect fanuc --out back.cl",
                "verify FILE --job job-of.toml --lenient --second-opinion",
            ],
        ),
        Kind::Path => (
            &["verify FILE --job job-of.toml --lenient"],
            &[
                "post FILE --machine trunnion-ac --dialect heidenhain --out out.h --lenient",
                "post FILE --machine head-ca --dialect sinumerik --orientation vectors --out out.mpf --lenient",
                "post FILE --machine 3-axis --dialect fanuc --feed kf --out out.nc --lenient",
                "post FILE --machine linuxcnc-xyzac --dialect linuxcnc --feed fastest --out out.ngc --lenient",
                "verify FILE --job job-of.toml --lenient --ply out.ply --blocks out.csv",
            ],
        ),
        Kind::Job => (&["check FILE"], &["strip FILE", "verify path-of.cl --job FILE"]),
        Kind::SmallJob => (
            &["check FILE"],
            &[
                "plan FILE --out plan",
                "compare FILE",
                "axes FILE --out axes",
                "strip FILE",
                "flank FILE",
                "verify path-of.cl --job FILE",
            ],
        ),
        Kind::SideJob => (&["check FILE", "flank FILE"], &["strip FILE", "verify path-of.cl --job FILE"]),
        Kind::Machine => (
            &["machines --check FILE", "post path-of.cl --machine FILE --dialect heidenhain --out out.h"],
            &["time program-of.nc --machine FILE", "readback program-of.nc --machine FILE --out back.cl"],
        ),
        Kind::Dialect => (
            &["post path-of.cl --machine trunnion-ac --dialect FILE --out out.nc"],
            &["time program-of.nc --machine trunnion-ac --dialect FILE"],
        ),
        Kind::Library => (
            &["tools FILE"],
            &[
                "tools FILE --out out.json",
                "tools FILE --out out.tbl",
                "init sheet-of.json --tools FILE --out init",
            ],
        ),
        Kind::Stock => (&["plan left-of.toml --out plan"], &["check left-of.toml"]),
    }
}

/// Whole files by their kind.
pub struct Seeds {
    kinds: Vec<Vec<Seed>>,
}

/// In which order kinds take turns: parts are of many forms.
const TURNS: [Kind; 21] = [
    Kind::Part,
    Kind::Program,
    Kind::Part,
    Kind::Path,
    Kind::Part,
    Kind::Job,
    Kind::Part,
    Kind::Machine,
    Kind::Part,
    Kind::Mesh,
    Kind::Part,
    Kind::Program,
    Kind::Part,
    Kind::Path,
    Kind::Part,
    Kind::SmallJob,
    Kind::Dialect,
    Kind::Mesh,
    Kind::Library,
    Kind::Stock,
    Kind::SideJob,
];

impl Seeds {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.kinds.iter().map(Vec::len).sum()
    }

    /// The file whose turn it is, and which of the verbs that take turns gets it: another one whenever the file comes again.
    pub fn nth(&self, number: usize) -> (&Seed, usize) {
        let kind = TURNS[number % TURNS.len()];
        let own = &self.kinds[kind as usize];
        let before = TURNS[..number % TURNS.len()].iter().filter(|k| **k == kind).count();
        let each = TURNS.iter().filter(|k| **k == kind).count();
        let turn = number / TURNS.len() * each + before;
        (&own[turn % own.len()], turn + turn / own.len())
    }
}

/// The whole files of a collection, of the workspace, and those that are made here or by the program.
pub fn all(data: &Path, root: &Path, program: &Path, scratch: &Path) -> Result<Seeds, Failure> {
    let mut kinds: Vec<Vec<Seed>> = (0..KINDS).map(|_| Vec::new()).collect();
    let mut take = |path: PathBuf, kind: Kind| -> Result<(), Failure> {
        let about = std::fs::metadata(&path).map_err(|why| Failure::Read { path: path.clone(), why })?;
        if !about.is_file() || about.len() > LARGEST {
            return Ok(());
        }
        let bytes = std::fs::read(&path).map_err(|why| Failure::Read { path: path.clone(), why })?;
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let mut beside = made::beside(kind, &name);
        if kind == Kind::Job {
            beside.extend(others(&path));
        }
        kinds[kind as usize].push(Seed { name, bytes, beside, kind });
        Ok(())
    };
    for folder in FOLDERS {
        let kind = match folder {
            "files/nc" => Kind::Program,
            "files/cl" => Kind::Path,
            _ => Kind::Part,
        };
        for path in files(&data.join(folder))? {
            take(path, kind)?;
        }
    }
    for folder in files(&root.join("examples"))? {
        for path in if folder.is_dir() { files(&folder)? } else { Vec::new() } {
            if path.extension().is_some_and(|e| e == "toml") {
                take(path, Kind::Job)?;
            }
        }
    }
    for path in files(&root.join("postproc/machines"))? {
        take(path, Kind::Machine)?;
    }
    for path in files(&root.join("postproc/dialects"))? {
        take(path, Kind::Dialect)?;
    }
    for (kind, name, bytes) in made::all(program, scratch)? {
        let beside = made::beside(kind, &name);
        kinds[kind as usize].push(Seed { name, bytes, beside, kind });
    }
    let names = [
        "parts",
        "meshes",
        "programs",
        "paths",
        "jobs",
        "small jobs",
        "jobs for the side of a cutter",
        "machines",
        "dialects",
        "libraries",
        "stocks",
    ];
    if let Some(none) = kinds.iter().position(Vec::is_empty) {
        return Err(Failure::NoPeer {
            what: names[none],
            how: "say a folder with files of a reference collection by --data",
        });
    }
    Ok(Seeds { kinds })
}

/// The files that a job names lie in its folder.
fn others(path: &Path) -> Vec<(String, Vec<u8>)> {
    let others = path.parent().map(files).and_then(Result::ok).unwrap_or_default();
    let read = |other: PathBuf| {
        let name = other.file_name()?.to_string_lossy().into_owned();
        let bytes = std::fs::read(&other).ok()?;
        (bytes.len() as u64 <= 10 * LARGEST).then_some((name, bytes))
    };
    others.into_iter().filter(|o| o != path && o.is_file()).filter_map(read).collect()
}

/// What is in a folder, in the order of names.
fn files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let read = |why| Failure::Read { path: folder.to_path_buf(), why };
    let mut out: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(read)?
        .map(|e| e.map(|e| e.path()))
        .collect::<Result<_, _>>()
        .map_err(read)?;
    out.sort();
    Ok(out)
}
