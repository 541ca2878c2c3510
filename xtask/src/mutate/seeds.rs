//! Whole files of every kind, with the verbs that read them.

use crate::cmd::Failure;
use std::path::{Path, PathBuf};

/// Files that are larger take too long for thousands of runs, bytes.
const LARGEST: u64 = 400_000;
/// The job beside NC and CL files, and the path beside others.
const JOB: &str = "format = 1\n[part]\nbuiltin = { kind = \"plane\", u_range = [0, 20], v_range = [0, 20] }\n[tool]\nkind = \"ball\"\n\
    diameter_mm = 6\nlength_mm = 30\n[tolerance]\nscallop_mm = 0.05\ngouge_mm = 0.05\n[cutting]\nfeed_mm_min = 1000\n\
    [machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\n[verification]\nmax_samples = 2000\n";
/// A path of a few moves.
const PATH: &str = "UNITS/MM\nCUTTER/6, 3, 0, 0, 0, 0, 30\nSPINDL/RPM,8000,CLW\nFEDRAT/1000,MMPM\nRAPID\nGOTO/0,0,40,0,0,1\nGOTO/0,0,0,0,0,1\n\
    GOTO/20,0,0,0,0,1\nGOTO/20,1,0,0,0.1,1\nRAPID\nGOTO/20,1,40,0,0,1\nFINI\n";
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

/// What reads a file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Part,
    Program,
    Path,
    Job,
    Machine,
    Dialect,
}

/// A file that is whole.
pub struct Seed {
    pub name: String,
    pub bytes: Vec<u8>,
    /// Files that a run needs beside it.
    pub beside: Vec<(String, Vec<u8>)>,
    kind: Kind,
}

impl Seed {
    /// The command lines on it.
    pub fn runs(&self) -> Vec<Vec<String>> {
        let name = self.name.as_str();
        let lines: &[&[&str]] = match self.kind {
            Kind::Part => {
                &[&["inspect", name, "--json"], &["verify", "path-of.cl", "--job", "job-of.toml", "--json"]]
            }
            Kind::Program => &[
                &["time", name, "--machine", "trunnion-ac", "--json"],
                &["verify", name, "--job", "job-of.toml", "--json", "--lenient"],
            ],
            Kind::Path => &[
                &[
                    "post",
                    name,
                    "--machine",
                    "trunnion-ac",
                    "--dialect",
                    "heidenhain",
                    "--out",
                    "out.h",
                    "--json",
                    "--lenient",
                ],
                &["verify", name, "--job", "job-of.toml", "--json", "--lenient"],
            ],
            Kind::Job => &[&["check", name, "--json"]],
            Kind::Machine => &[
                &["machines", "--check", name, "--json"],
                &[
                    "post",
                    "path-of.cl",
                    "--machine",
                    name,
                    "--dialect",
                    "heidenhain",
                    "--out",
                    "out.h",
                    "--json",
                ],
            ],
            Kind::Dialect => &[&[
                "post",
                "path-of.cl",
                "--machine",
                "trunnion-ac",
                "--dialect",
                name,
                "--out",
                "out.nc",
                "--json",
            ]],
        };
        lines.iter().map(|l| l.iter().map(|w| (*w).to_owned()).collect()).collect()
    }
}

/// Whole files by their kind.
pub struct Seeds {
    kinds: Vec<Vec<Seed>>,
}

/// In which order kinds take turns: parts are of many forms.
const TURNS: [Kind; 10] = [
    Kind::Part,
    Kind::Program,
    Kind::Part,
    Kind::Path,
    Kind::Part,
    Kind::Job,
    Kind::Part,
    Kind::Machine,
    Kind::Part,
    Kind::Dialect,
];

impl Seeds {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.kinds.iter().map(Vec::len).sum()
    }

    /// The file whose turn it is.
    pub fn nth(&self, number: usize) -> &Seed {
        let kind = TURNS[number % TURNS.len()];
        let own = &self.kinds[kind as usize];
        let before = TURNS[..number % TURNS.len()].iter().filter(|k| **k == kind).count();
        let each = TURNS.iter().filter(|k| **k == kind).count();
        &own[(number / TURNS.len() * each + before) % own.len()]
    }
}

/// The whole files of a collection and of the workspace.
pub fn all(data: &Path, root: &Path) -> Result<Seeds, Failure> {
    let mut kinds: Vec<Vec<Seed>> = (0..6).map(|_| Vec::new()).collect();
    let mut take = |path: PathBuf, kind: Kind| -> Result<(), Failure> {
        let about = std::fs::metadata(&path).map_err(|why| Failure::Read { path: path.clone(), why })?;
        if !about.is_file() || about.len() > LARGEST {
            return Ok(());
        }
        let bytes = std::fs::read(&path).map_err(|why| Failure::Read { path: path.clone(), why })?;
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        kinds[kind as usize].push(Seed { beside: beside(kind, &name, &path), name, bytes, kind });
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
    for (name, bytes) in meshes() {
        let beside = beside(Kind::Part, name, Path::new(name));
        kinds[Kind::Part as usize].push(Seed { name: name.to_owned(), bytes, beside, kind: Kind::Part });
    }
    let names = ["parts", "programs", "paths", "jobs", "machines", "dialects"];
    if let Some(none) = kinds.iter().position(Vec::is_empty) {
        return Err(Failure::NoPeer {
            what: names[none],
            how: "say a folder with files of a reference collection by --data",
        });
    }
    Ok(Seeds { kinds })
}

/// What stands beside a file of a kind.
fn beside(kind: Kind, name: &str, path: &Path) -> Vec<(String, Vec<u8>)> {
    let part = format!("[part]\nfile = \"{name}\"\n[tool]");
    let of_part = JOB.replace(
        "[part]\nbuiltin = { kind = \"plane\", u_range = [0, 20], v_range = [0, 20] }\n[tool]",
        &part,
    );
    let mut out = match kind {
        Kind::Part => vec![("job-of.toml".to_owned(), of_part.into_bytes())],
        _ => vec![("job-of.toml".to_owned(), JOB.to_owned().into_bytes())],
    };
    out.push(("path-of.cl".to_owned(), PATH.to_owned().into_bytes()));
    if kind == Kind::Job {
        // The files that a job names lie in its folder.
        let others = path.parent().map(files).and_then(Result::ok).unwrap_or_default();
        for other in others.into_iter().filter(|o| o != path && o.is_file()) {
            if let (Some(name), Ok(bytes)) = (other.file_name(), std::fs::read(&other))
                && bytes.len() as u64 <= 10 * LARGEST
            {
                out.push((name.to_string_lossy().into_owned(), bytes));
            }
        }
    }
    out
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

/// A block as STL in both forms and as PLY in both forms.
fn meshes() -> [(&'static str, Vec<u8>); 4] {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| 20.0 * bit as f32);
    let sides: [[usize; 4]; 6] =
        [[4, 5, 7, 6], [0, 2, 3, 1], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    let triangles: Vec<[usize; 3]> =
        sides.iter().flat_map(|s| [[s[0], s[1], s[2]], [s[0], s[2], s[3]]]).collect();
    let mut text = "solid block\n".to_owned();
    let mut binary = vec![b' '; 80];
    binary.extend((triangles.len() as u32).to_le_bytes());
    for t in &triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        binary.extend([0; 12]);
        for p in t.map(corner) {
            text += &format!("vertex {} {} {}\n", p[0], p[1], p[2]);
            p.iter().for_each(|x| binary.extend(x.to_le_bytes()));
        }
        text += "endloop\nendfacet\n";
        binary.extend([0; 2]);
    }
    text += "endsolid block\n";
    let head = |form: &str| {
        format!(
            "ply\nformat {form} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 12\n\
             property list uchar int vertex_indices\nend_header\n"
        )
    };
    let (mut ply, mut ply_binary) = (head("ascii"), head("binary_little_endian").into_bytes());
    for p in (0..8).map(corner) {
        ply += &format!("{} {} {}\n", p[0], p[1], p[2]);
        p.iter().for_each(|x| ply_binary.extend(x.to_le_bytes()));
    }
    for [a, b, c] in &triangles {
        ply += &format!("3 {a} {b} {c}\n");
        ply_binary.push(3);
        [a, b, c].iter().for_each(|k| ply_binary.extend((**k as i32).to_le_bytes()));
    }
    [
        ("text.stl", text.into_bytes()),
        ("binary.stl", binary),
        ("text.ply", ply.into_bytes()),
        ("binary.ply", ply_binary),
    ]
}
