//! A part as it was read: its faces with names, and what was found on the way.

use crate::failure::Failure;
use crate::part::mesh::MeshFacts;
use crate::words::number;
use osculate_geom::{Diagnostic, Surface, Uv, uv};
use osculate_surfaces::structure::Structure;
use osculate_surfaces::{Face, NotUsed, NurbsSurface, TrimmedSurface};
use std::sync::Arc;

/// A face ready for work.
#[derive(Clone)]
#[non_exhaustive]
pub struct LoadedFace {
    /// `F1`, `F2`, ...
    pub id: String,
    /// Name in the file.
    pub name: String,
    /// Kind as `inspect` prints it.
    pub kind: String,
    /// The face with trims and material side.
    pub surface: Arc<TrimmedSurface>,
    /// The imported face, where it comes from a file.
    pub source: Option<Arc<Face>>,
    /// The spline, where it is a built-in one.
    pub spline: Option<Arc<NurbsSurface>>,
    /// What of the face is looked at, where that is not all of it.
    pub part_of_it: Option<String>,
}

/// A face of which something is hidden.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct InBodies {
    /// Its id.
    pub id: String,
    /// The area within other bodies, mm2.
    pub hidden_mm2: f64,
    /// Whether that is all of it.
    pub wholly: bool,
    /// Each of the bodies, by the ids of its faces.
    pub bodies: Vec<String>,
}

impl InBodies {
    /// What is hidden and where, in words.
    #[must_use]
    pub fn words(&self) -> String {
        let bodies = self.bodies.join(" and in ");
        if self.wholly {
            format!("all of {} in {bodies}", self.id)
        } else {
            format!("{} mm2 of {} in {bodies}", number(self.hidden_mm2, 5), self.id)
        }
    }
}

/// A part ready for work.
#[derive(Clone)]
#[non_exhaustive]
pub struct Loaded {
    /// `step`, `iges`, `patches`, `sections`, `json`, `stl`, `ply`, `3mf` or `builtin`.
    pub format: &'static str,
    /// The file's unit.
    pub unit: String,
    /// The file's schema.
    pub schema: String,
    /// What the file says of its own exactness, mm.
    pub uncertainty_mm: Option<f64>,
    /// Faces; those that lie wholly in other bodies are not among them where a job reads the part.
    pub faces: Vec<LoadedFace>,
    /// Bodies and layers, as the file says.
    pub structure: Structure,
    /// What of the faces lies in other bodies, where that was looked for.
    pub hidden: Vec<InBodies>,
    /// What the file has that is not used.
    pub not_used: Vec<NotUsed>,
    /// The message for a file that ends too early.
    pub truncated: Option<String>,
    /// What it is known by where it is a mesh.
    pub mesh: Option<MeshFacts>,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

impl LoadedFace {
    /// The spline that the face is a piece of, where it is one.
    pub fn nurbs(&self) -> Option<&NurbsSurface> {
        self.spline.as_deref().or_else(|| self.source.as_ref().and_then(|f| f.carrier.nurbs()).map(|n| &**n))
    }

    /// The place that an option `--at U,V` names.
    ///
    /// # Errors
    /// Where it lies outside the rectangle of the parameters.
    pub fn at(&self, [u, v]: [f64; 2]) -> Result<Uv, Failure> {
        let (at, d) = (uv(u, v), self.surface.domain());
        if d.contains(at) {
            return Ok(at);
        }
        let what = format!(
            "{u},{v} is outside the parameters of {}: u in [{}, {}], v in [{}, {}]",
            self.id, d.u.lo, d.u.hi, d.v.lo, d.v.hi
        );
        Err(Failure::at("--at", what))
    }
}

impl Loaded {
    /// The faces that come from a file, with the sides that they have now.
    pub fn shapes(&self) -> Vec<Face> {
        let shape = |f: &LoadedFace| {
            f.source.as_deref().map(|source| Face { surface: f.surface.clone(), ..source.clone() })
        };
        self.faces.iter().filter_map(shape).collect()
    }

    /// The only face, or the one with this id.
    pub fn one(&self, id: Option<&str>) -> Result<&LoadedFace, Failure> {
        match (id, self.faces.as_slice()) {
            (Some(id), _) => self.face(id),
            (None, [one]) => Ok(one),
            (None, all) => {
                Err(Failure::Usage(format!("the part has {} faces: say which with --face", all.len())))
            }
        }
    }

    /// The face of this id.
    pub fn face(&self, id: &str) -> Result<&LoadedFace, Failure> {
        if let Some(hidden) = self.hidden.iter().find(|h| h.wholly && h.id == id) {
            let text =
                format!("{}: it lies in the material there, and no tool has to reach it", hidden.words());
            return Err(Failure::job(text));
        }
        self.faces.iter().find(|f| f.id == id).ok_or_else(|| {
            let all: Vec<&str> = self.faces.iter().map(|f| f.id.as_str()).collect();
            Failure::no_face(id, &all)
        })
    }
}
