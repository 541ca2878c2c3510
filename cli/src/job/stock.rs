//! Raw material and fixtures of a job; meshes are looked at only as far as tells that they are some.

use crate::failure::{Failure, beside};
use crate::job::problem::Places;
use crate::job::raw;
use crate::job::strategy::direction;
use osculate_geom::{Box3, Point3, Unit3};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Memory for the stock where the job gives none.
const DEFAULT_MEMORY_MB: f64 = 512.0;
/// Distance of places on fixtures where the job gives none.
const FIXTURE_SPACING_MM: f64 = 1.0;
/// Largest mesh, bytes: beyond it the file is none that was meant.
const LARGEST: u64 = 4 << 30;
/// What the names of saved stocks end in.
const SAVED: &str = "stock";
/// What is read of a mesh to tell that it is one, bytes.
const LOOK: u64 = 1 << 16;
/// Head of a binary STL file and what each triangle takes, bytes.
const STL: [u64; 2] = [84, 50];
/// What a PLY file begins with.
const PLY: &[u8] = b"ply";
/// What a 3MF file begins with.
const ZIP: &[u8] = b"PK\x03\x04";

/// What raw material is.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Blank {
    /// A box in the part's frame.
    Box(Box3),
    /// A round blank about an axis through the origin of the part's frame.
    Cylinder {
        /// Its axis.
        axis: Unit3,
        /// Diameter.
        diameter_mm: f64,
        /// Where it begins and ends along the axis.
        along_mm: [f64; 2],
    },
    /// A closed mesh, with a layer around it where one is given.
    File {
        /// The file.
        path: PathBuf,
        /// Thickness of the layer.
        layer_mm: Option<f64>,
    },
    /// What another job has left, as it was saved.
    Saved(PathBuf),
    /// A layer of this thickness around the faces of the job, mm.
    Layer(f64),
}

/// Raw material.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Stock {
    /// Its shape.
    pub blank: Blank,
    /// Sides of cells; by its size where not given.
    pub cell_mm: Option<f64>,
    /// Memory for it.
    pub memory_mb: f64,
}

/// What holds the part.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Fixture {
    /// Meshes in the part's frame.
    pub files: Vec<PathBuf>,
    /// Distance of the places looked at.
    pub spacing_mm: f64,
}

impl Stock {
    pub(super) fn of(places: &Places, t: &raw::Stock) -> Result<Self, Failure> {
        const TABLE: &str = "stock";
        let given = [
            ("box_mm", t.box_mm.is_some()),
            ("cylinder", t.cylinder.is_some()),
            ("file", t.file.is_some()),
            ("allowance_mm", t.allowance_mm.is_some() && t.file.is_none()),
        ];
        let all: Vec<&str> = given.iter().filter(|g| g.1).map(|g| g.0).collect();
        if let [first, second, ..] = all[..] {
            let what = format!("has both {first} and {second}; keep one of them");
            return Err(places.refuse(TABLE, second, what));
        }
        let blank = if let Some(b) = t.box_mm {
            Blank::Box(Box3 { min: Point3::new(b[0], b[1], b[2]), max: Point3::new(b[3], b[4], b[5]) })
        } else if let Some(c) = &t.cylinder {
            let axis = direction(c.axis.unwrap_or([0.0, 0.0, 1.0]));
            Blank::Cylinder { axis, diameter_mm: c.diameter_mm, along_mm: c.z_mm }
        } else if let Some(file) = t.file.as_ref().filter(|file| is_saved(places, file)) {
            let words = "what was saved has its own cells, and nothing is around it";
            let given = [
                ("allowance_mm", t.allowance_mm.is_some()),
                ("cell_mm", t.cell_mm.is_some()),
                ("memory_mb", t.memory_mb.is_some()),
            ];
            for (key, given) in given {
                if given {
                    let what = format!("{key} does not go with file = \"{file}\": {words}; leave it out");
                    return Err(places.refuse(TABLE, key, what));
                }
            }
            Blank::Saved(present(places, TABLE, "file", file)?)
        } else if let Some(file) = &t.file {
            Blank::File { path: mesh(places, TABLE, "file", file)?, layer_mm: t.allowance_mm }
        } else if let Some(thickness_mm) = t.allowance_mm {
            Blank::Layer(thickness_mm)
        } else {
            let what = "needs one of box_mm, cylinder, file and allowance_mm";
            return Err(places.refuse(TABLE, "", what));
        };
        Ok(Self { blank, cell_mm: t.cell_mm, memory_mb: t.memory_mb.unwrap_or(DEFAULT_MEMORY_MB) })
    }
}

impl Fixture {
    pub(super) fn of(places: &Places, t: &raw::Fixture) -> Result<Self, Failure> {
        let files = t.files.iter().map(|f| mesh(places, "fixture", "files", f)).collect::<Result<_, _>>()?;
        Ok(Self { files, spacing_mm: t.spacing_mm.unwrap_or(FIXTURE_SPACING_MM) })
    }
}

/// Whether a file is a stock that was saved, by its name or by what it begins with.
fn is_saved(places: &Places, file: &str) -> bool {
    let path = beside(places.path(), file);
    let mut head = Vec::new();
    let named = path.extension().is_some_and(|e| e.eq_ignore_ascii_case(SAVED));
    let read = File::open(path).and_then(|f| f.take(LOOK).read_to_end(&mut head));
    named || (read.is_ok() && osculate_tools::removal::stock::Stock::is_saved(&head))
}

/// A file that is there, by its path from the job.
pub(super) fn present(places: &Places, table: &str, key: &str, file: &str) -> Result<PathBuf, Failure> {
    let path = beside(places.path(), file);
    let wrong = |why: String| {
        let what = format!("{key} = \"{file}\": {} cannot be read: {why}", path.display());
        places.full(table, key, what, "a file that is there".to_owned(), None)
    };
    let about = std::fs::metadata(&path).map_err(|e| wrong(e.to_string()))?;
    if about.is_file() { Ok(path) } else { Err(wrong("it is no file".to_owned())) }
}

/// A mesh that is there.
fn mesh(places: &Places, table: &str, key: &str, file: &str) -> Result<PathBuf, Failure> {
    let path = present(places, table, key, file)?;
    match why_no_mesh(&path) {
        Ok(None) => Ok(path),
        Ok(Some(why)) => {
            let what = format!("{key} = \"{file}\" is no mesh that is read: {why}");
            Err(places.full(table, key, what, "an STL, PLY or 3MF mesh".to_owned(), None))
        }
        Err(e) => Err(places.refuse(table, key, format!("{key} = \"{file}\" cannot be read: {e}"))),
    }
}

/// Why a file is no mesh, by its beginning and its size.
fn why_no_mesh(path: &Path) -> std::io::Result<Option<String>> {
    let mut file = File::open(path)?;
    let size = file.metadata()?.len();
    if size > LARGEST {
        return Ok(Some(format!("it has {size} bytes, more than {LARGEST}")));
    }
    let mut head = Vec::new();
    file.by_ref().take(LOOK).read_to_end(&mut head)?;
    if [PLY, ZIP].iter().any(|begin| head.starts_with(begin)) {
        return Ok(None);
    }
    let [before, each] = STL;
    let count = head.get(80..84).map(|b| u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    if count.is_some_and(|n| n > 0 && before + each * n == size) {
        return Ok(None);
    }
    let text = String::from_utf8_lossy(&head).to_lowercase();
    if !text.trim_start().starts_with("solid") {
        return Ok(Some(match count {
            Some(n) => format!("it has {size} bytes, and {n} triangles would take {}", before + each * n),
            None => format!("it has {size} bytes only"),
        }));
    }
    Ok((!text.contains("vertex")).then(|| "it has no triangle".to_owned()))
}
