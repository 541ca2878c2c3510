//! Parts as commands see them: faces with names, from a file or built in.

mod doubts;
mod fingerprint;
pub mod hidden;
mod loaded;
pub mod mesh;
mod sides;
mod turned;

pub use doubts::doubts;
pub use loaded::{InBodies, Loaded, LoadedFace};
pub use turned::{TurnedFaces, turned};

use crate::failure::{Failure, read};
use crate::job::builtin::{self, Builtin};
use crate::job::{FaceChoice, Job, Source};
use osculate_geom::{Box3, Point3, Side, Surface, Unit3, Uv};
use osculate_productivity::axis::Left;
use osculate_productivity::plan::Walls;
use osculate_surfaces::TrimmedSurface;
use osculate_surfaces::facets::mesh_format;
use osculate_surfaces::sides::open_rims;
use osculate_surfaces::structure::Structure;
use osculate_tools::removal::Unseen;
use osculate_tools::removal::stock::Stock;
use rayon::prelude::*;
use sides::Told;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, OnceLock};

fn from_builtin(b: Builtin) -> Result<Loaded, Failure> {
    let surface = TrimmedSurface::new(b.surface, &[], Side::Along).map_err(Failure::job)?;
    let face = LoadedFace {
        id: "F1".to_owned(),
        name: String::new(),
        kind: b.kind.to_owned(),
        surface: Arc::new(surface),
        source: None,
        spline: b.spline,
        part_of_it: None,
    };
    Ok(Loaded {
        format: "builtin",
        unit: "mm".to_owned(),
        schema: String::new(),
        uncertainty_mm: None,
        faces: vec![face],
        structure: Structure::default(),
        hidden: Vec::new(),
        not_used: Vec::new(),
        truncated: None,
        mesh: None,
        diagnostics: Vec::new(),
    })
}

fn from_file(path: &Path, unit_mm: Option<f64>) -> Result<Loaded, Failure> {
    let bytes = read(path)?;
    if mesh_format(&bytes).is_some() {
        return mesh::loaded(path, &bytes, unit_mm);
    }
    let mut part = osculate_surfaces::read(&bytes).map_err(|e| Failure::file(path, e))?;
    if unit_mm.is_some() {
        part = match part.format {
            osculate_surfaces::Format::Sections => {
                osculate_surfaces::sections::read_in(&bytes, unit_mm).map_err(|e| Failure::file(path, e))?
            }
            osculate_surfaces::Format::Patches => {
                osculate_surfaces::patches::read_in(&bytes, unit_mm).map_err(|e| Failure::file(path, e))?
            }
            _ => {
                let text = "[part] unit_mm goes with point sections, sets of patches and meshes; this file says its unit itself";
                return Err(Failure::file(path, text));
            }
        };
    }
    let format = match part.format {
        osculate_surfaces::Format::Step => "step",
        osculate_surfaces::Format::Iges => "iges",
        osculate_surfaces::Format::Patches => "patches",
        osculate_surfaces::Format::Sections => "sections",
        osculate_surfaces::Format::Json => "json",
    };
    let faces = part
        .faces
        .into_iter()
        .map(|f| {
            let source = Arc::new(f);
            LoadedFace {
                id: source.id.clone(),
                name: source.name.clone(),
                kind: source.kind.to_string(),
                surface: source.surface.clone(),
                source: Some(source),
                spline: None,
                part_of_it: None,
            }
        })
        .collect();
    Ok(Loaded {
        format,
        unit: part.unit,
        schema: part.schema,
        uncertainty_mm: part.uncertainty_mm,
        faces,
        structure: part.structure,
        hidden: Vec::new(),
        not_used: part.not_used,
        truncated: part.truncated.then(|| {
            let what =
                "is truncated: faces may be missing (inspect shows what was read); export or copy it again";
            format!("{}: the file {what}", path.display())
        }),
        mesh: None,
        diagnostics: part.diagnostics,
    })
}

/// Places farther from the origin than this belong to no part, mm: a thousand kilometres.
const FAR_MM: f64 = 1e9;
/// Ids of such faces that a message lists at most.
const FAR_LISTED: usize = 12;

/// The part, unless its file ends too early or has places that no part has.
///
/// # Errors
/// In these cases.
pub fn whole(part: Loaded) -> Result<Loaded, Failure> {
    match (&part.truncated, far(&part)) {
        (Some(message), _) => Err(Failure::job(message)),
        (None, Some(message)) => Err(Failure::job(message)),
        (None, None) => Ok(part),
    }
}

/// What is to be said of a part with faces that lie farther away than any part is large: numbers of its file are damaged.
#[must_use]
pub fn far(part: &Loaded) -> Option<String> {
    let is_far = |f: &LoadedFace| {
        let b = f.surface.bbox(1);
        // What is no number is no place of a part either.
        !b.is_empty() && !b.min.iter().chain(b.max.iter()).all(|x| x.abs() <= FAR_MM)
    };
    let each: Vec<bool> = part.faces.par_iter().map(is_far).collect();
    let ids: Vec<&str> = part.faces.iter().zip(each).filter(|f| f.1).map(|f| f.0.id.as_str()).collect();
    let more = if ids.len() > FAR_LISTED { ", ..." } else { "" };
    let shown = ids[..ids.len().min(FAR_LISTED)].join(", ");
    (!ids.is_empty()).then(|| {
        format!("{shown}{more}: farther than {FAR_MM:e} mm from the origin, as no part is: numbers of the file are damaged; export or copy it again")
    })
}

/// The part of a file.
pub fn open(path: &Path) -> Result<Loaded, Failure> {
    from_file(path, None)
}

/// A built-in surface as a part, by its keys as an inline table of TOML has them, without the braces.
///
/// ```
/// use osculate::part;
///
/// let plane = part::built_in("kind = \"plane\", half_size_mm = 5")?;
/// assert_eq!((plane.faces.len(), plane.faces[0].id.as_str()), (1, "F1"));
/// // 10 x 10 mm, at z = 0.
/// assert!((part::area(&plane.faces[0]) - 100.0).abs() < 1e-9);
/// let bounds = part::bounds(&plane.faces[0]);
/// assert!((bounds.max - bounds.min - osculate_geom::Vec3::new(10.0, 10.0, 0.0)).norm() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn built_in(keys: &str) -> Result<Loaded, Failure> {
    from_builtin(builtin::parse(keys).map_err(Failure::Usage)?)
}

/// Raw material that operations before have left.
#[derive(Clone)]
#[non_exhaustive]
pub struct LeftMaterial {
    /// Points of its surface.
    pub points: Arc<[Point3]>,
    /// How far they are apart, mm.
    pub cell_mm: f64,
    /// All of it.
    pub stock: Arc<Stock>,
}

/// The part of a job: its faces, and which of them the job works on.
#[non_exhaustive]
pub struct Part {
    /// The whole part.
    pub part: Loaded,
    /// Faces to machine.
    pub faces: Vec<LoadedFace>,
    /// Faces that the tool must not touch: all others of the part.
    pub check: Vec<LoadedFace>,
    /// Faces that are not looked at.
    pub unseen: Vec<Unseen>,
    /// Ids of faces of which nothing says on which side the material is.
    pub open: Vec<String>,
    /// Of faces by their ids the open rims, once they are asked for.
    pub rims: OnceLock<BTreeMap<String, Vec<Vec<Uv>>>>,
    /// What links keep off, once it is asked for.
    pub walls: OnceLock<Arc<Walls>>,
    /// Raw material that operations before have left, where that is known.
    pub left: Option<LeftMaterial>,
    /// Wall time of reading it, s; zero where nobody measured it.
    pub import_s: f64,
}

impl Part {
    /// The pieces of a face's rim where no other face of the part goes on, in its parameters. Of faces that come from no file none is
    /// known.
    pub fn open_rims(&self, id: &str) -> &[Vec<Uv>] {
        let rims = self.rims.get_or_init(|| {
            let shapes = self.part.shapes();
            if shapes.len() < self.part.faces.len() {
                return BTreeMap::new();
            }
            let mut out: BTreeMap<String, Vec<Vec<Uv>>> = BTreeMap::new();
            for rim in open_rims(&shapes.iter().collect::<Vec<_>>(), self.part.uncertainty_mm) {
                out.entry(self.part.faces[rim.face].id.clone()).or_default().push(rim.points);
            }
            out
        });
        rims.get(id).map_or(&[], Vec::as_slice)
    }

    /// Raw material that is left; none where it is not known.
    pub fn left(&self) -> Left<'_> {
        self.left.as_ref().map_or_else(Left::default, |l| Left { points: &l.points, apart_mm: l.cell_mm })
    }

    /// The same part as another job on it sees it: its own faces to machine, all others to be kept.
    ///
    /// # Errors
    /// Where the job names a face that is not there.
    pub fn seen_by(&self, job: &Job) -> Result<Self, Failure> {
        let chosen = machined(job, &self.part)?;
        sorted(job, self.part.clone(), chosen, self.open.clone())
    }

    /// The same part with these faces to machine, as a job on others of its faces sees it.
    ///
    /// # Errors
    /// Where the job has one of them for something else.
    pub fn with_faces(&self, job: &Job, ids: Vec<String>) -> Result<Self, Failure> {
        sorted(job, self.part.clone(), ids, self.open.clone())
    }

    /// A failure with what was warned of when the part was read: it may be why.
    pub fn warned(&self, why: Failure) -> Failure {
        why.warned(&self.part.diagnostics)
    }
}

/// A face of a job where a key of `[part]` cannot be meant.
fn in_part(job: &Job, e: &Failure) -> Failure {
    let found = e.problem();
    match e {
        Failure::At(_) => job.lacks("part", "faces", found),
        _ => job.refuse("part", "faces", e.message()),
    }
}

/// The ids of the faces that a job works on.
fn machined(job: &Job, part: &Loaded) -> Result<Vec<String>, Failure> {
    let chosen = choose(part, job.part().faces(), "faces").map_err(|e| in_part(job, &e))?;
    if chosen.is_empty() {
        return Err(job.refuse("part", "faces", "faces chooses no face"));
    }
    Ok(chosen.into_iter().map(|f| f.id).collect())
}

/// The faces of a job, with their material sides settled.
pub fn of_job(job: &Job) -> Result<Part, Failure> {
    let mut part = match job.part().source() {
        Source::File { path, unit_mm } => whole(from_file(path, *unit_mm)?)?,
        Source::Builtin(b) | Source::Ruled(b) => from_builtin(b.clone())?,
    };
    let doubts = doubts(&part);
    part.diagnostics.extend(doubts);
    let chosen = machined(job, &part)?;
    let said = sides::said(job, &part)?;
    let open = settle(&mut part, (job.part().normals(), &said), &chosen);
    // Of the faces named, those that are left.
    let chosen = if part.hidden.is_empty() { chosen } else { machined(job, &part)? };
    sorted(job, part, chosen, open)
}

/// Turns the faces of a part to the side of its material, and leaves of them what no other body hides. What a job says of its
/// faces is meant for those that it works on. The ids of the faces of which nothing says a side come back.
pub fn settle(part: &mut Loaded, told: Told<'_>, chosen: &[String]) -> Vec<String> {
    let sideless = sides::settle(told, part, chosen);
    let open = sideless.iter().map(|k| part.faces[*k].id.clone()).collect();
    hidden::hide(part, &sideless);
    open
}

/// The faces of a part with settled sides, those that a job works on before all others. Nothing says a side of the `open` ones.
fn sorted(job: &Job, part: Loaded, chosen: Vec<String>, open: Vec<String>) -> Result<Part, Failure> {
    let here = |e: Failure| in_part(job, &e);
    if let Some(id) = chosen.iter().find(|id| open.contains(id)) {
        return Err(Failure::file(
            job.path(),
            format!(
                "[part] {id}: neither the file nor the shape of the part says on which side of the face the material is. Ask for \
                 `lines PART --face {id} --out FOLDER` (a picture) and `probe` (its normal), then say: [[part.side]] faces = \
                 [\"{id}\"], material = \"below_normal\" or \"above_normal\"; or normals = \"file\" or \"reversed\" for all faces to \
                 machine. Open are {}",
                open.iter().take(12).cloned().collect::<Vec<_>>().join(", ")
                    + if open.len() > 12 { ", ..." } else { "" }
            ),
        ));
    }
    let faces: Vec<LoadedFace> = chosen.iter().map(|id| part.face(id).cloned()).collect::<Result<_, _>>()?;
    let machined = |f: &LoadedFace| faces.iter().any(|m| m.id == f.id);
    if let Some(named) = job.part().check_faces().filter(|c| !c.is_all()) {
        let named = choose(&part, Some(named), "check_faces").map_err(here)?;
        if let Some(both) = named.iter().find(|f| machined(f)) {
            return Err(both_kinds(job, "check_faces", &both.id, "the tool must touch it"));
        }
    }
    let may_hit = match job.part().may_hit() {
        None => Vec::new(),
        some => choose(&part, some, "may_hit").map_err(here)?,
    };
    if let Some(both) =
        may_hit.iter().find(|f| machined(f) && !job.part().may_hit().is_some_and(FaceChoice::is_all))
    {
        return Err(both_kinds(job, "may_hit", &both.id, "it is cut to its tolerance"));
    }
    // All other faces of the part are there, whether the job names them or not.
    let hit = |f: &LoadedFace| may_hit.iter().any(|m| m.id == f.id);
    let mut check: Vec<LoadedFace> = part.faces.iter().filter(|f| !machined(f) && !hit(f)).cloned().collect();
    let ids = |all: &mut dyn Iterator<Item = &LoadedFace>| all.map(|f| f.id.clone()).collect::<Vec<_>>();
    let mut unseen = Vec::new();
    let allowed = ids(&mut may_hit.iter().filter(|f| !machined(f)));
    if !allowed.is_empty() {
        unseen.push(Unseen::MayBeHit(allowed));
    }
    if let Some(mesh) = &part.mesh {
        unseen.push(Unseen::Mesh(mesh.words()));
    }
    if !part.hidden.is_empty() {
        unseen.push(Unseen::Hidden(part.hidden.iter().map(InBodies::words).collect()));
    }
    let no_side = ids(&mut check.iter().filter(|f| open.contains(&f.id)));
    if !no_side.is_empty() {
        unseen.push(Unseen::NoSide(no_side));
        check.retain(|f| !open.contains(&f.id));
    }
    let (rims, walls) = (OnceLock::new(), OnceLock::new());
    Ok(Part { part, faces, check, unseen, open, rims, walls, left: None, import_s: 0.0 })
}

/// A face that two keys of a job name for different things.
fn both_kinds(job: &Job, key: &str, id: &str, why: &str) -> Failure {
    let text = format!(
        "[part] {key} names {id}, which is also a face to machine: {why}. Take {id} out of one of them; all other faces of the \
         part are checked whether they are named or not"
    );
    Failure::file(job.path(), text)
}

/// The single face of a job.
pub fn one_face(job: &Job) -> Result<LoadedFace, Failure> {
    let part = of_job(job)?;
    part.part.to_plan(job.path())?;
    let mut all = part.faces;
    match (all.pop(), all.len()) {
        (Some(one), 0) => Ok(one),
        (_, more) => Err(Failure::file(
            job.path(),
            format!("[part] faces chooses {} faces where one is needed", more + 1),
        )),
    }
}

fn choose(part: &Loaded, choice: Option<&FaceChoice>, key: &str) -> Result<Vec<LoadedFace>, Failure> {
    match choice {
        None => Ok(part.faces.clone()),
        Some(FaceChoice::Word(w)) if w == "all" => Ok(part.faces.clone()),
        Some(FaceChoice::Word(id)) => Ok(vec![part.face(id)?.clone()]),
        Some(FaceChoice::Ids(ids)) => {
            // One that is wholly hidden is left out, unless there is no other.
            let gone = |id: &String| part.hidden.iter().any(|h| h.wholly && h.id == *id);
            let all = ids.iter().all(gone);
            ids.iter().filter(|id| all || !gone(id)).map(|id| part.face(id).cloned()).collect()
        }
        Some(FaceChoice::Largest(l)) => {
            if l.largest == 0 || l.largest > part.faces.len() {
                return Err(Failure::job(format!(
                    "{key} = {{ largest = {} }}: the part has {} faces",
                    l.largest,
                    part.faces.len()
                )));
            }
            let mut sized: Vec<(f64, &LoadedFace)> = part.faces.iter().map(|f| (area(f), f)).collect();
            // Equal areas keep the order of the file.
            sized.sort_by(|a, b| b.0.total_cmp(&a.0));
            Ok(sized.into_iter().take(l.largest).map(|s| s.1.clone()).collect())
        }
    }
}

/// Area of a face, mm2.
pub fn area(face: &LoadedFace) -> f64 {
    face.surface.area_mm2()
}

/// Box around a face.
pub fn bounds(face: &LoadedFace) -> Box3 {
    face.surface.bbox(4)
}

/// Points with normals on a grid over a face's parameters, those inside its trims.
pub fn grid(surface: &dyn Surface, n: usize) -> Vec<(Uv, Point3, Unit3)> {
    let d = surface.domain();
    let mut out = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            let at = d.at(i as f64 / n as f64, j as f64 / n as f64);
            let jet = surface.jet2(at);
            if let Ok(normal) = jet.normal()
                && surface.contains(at)
            {
                out.push((at, jet.point, normal));
            }
        }
    }
    out
}

/// Range of the principal curvatures over a face, 1/mm, from a grid of its inside.
///
/// ```
/// use osculate::part;
///
/// // A sphere of 20 mm is as round everywhere, and convex.
/// let sphere = part::built_in("kind = \"sphere\", radius_mm = 20")?;
/// let [least, greatest] = part::curvature_range(&*sphere.faces[0].surface).expect("it has an inside");
/// assert!((least.abs() - 0.05).abs() < 1e-9 && (greatest - least).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn curvature_range(surface: &dyn Surface) -> Option<[f64; 2]> {
    let mut range: Option<[f64; 2]> = None;
    for (at, ..) in grid(surface, 24) {
        if let Ok(forms) = surface.jet2(at).forms() {
            let p = forms.principal();
            let r = range.get_or_insert([p.k_min, p.k_max]);
            *r = [r[0].min(p.k_min), r[1].max(p.k_max)];
        }
    }
    range
}
