//! Parts that are meshes: read, grouped into faces, and what of them can be used for what.

use crate::failure::Failure;
use crate::part::loaded::{Loaded, LoadedFace};
use crate::triangles;
use crate::words::number;
use osculate_geom::Diagnostic;
use osculate_surfaces::TrimmedSurface;
use osculate_surfaces::facets::{self, MeshFormat, SHARP_RAD, mesh_part};
use osculate_surfaces::structure::Structure;
use std::path::Path;
use std::sync::Arc;

/// What a mesh can be used for, and what not.
pub const USES: &str = "a mesh can be held against programs and CL data (verify), as the part, as raw material and as fixtures; to plan, \
                        paths need the curvature of faces, which triangles do not have: export the part as STEP or IGES";

/// What a part that is a mesh is known by.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshFacts {
    /// Triangles in all.
    pub triangles: usize,
    /// Whether every side belongs to two triangles.
    pub closed: bool,
    /// How far it stands off a smooth surface, as its angles suggest, mm.
    pub chord_mm: f64,
}

impl MeshFacts {
    /// What a verdict on such a part leaves out.
    #[must_use]
    pub fn words(&self) -> String {
        let Self { triangles, chord_mm, .. } = self;
        let off = if *chord_mm > 0.0 {
            format!("their angles suggest about {} mm where they bend", number(*chord_mm, 2))
        } else {
            "none of them bend".to_owned()
        };
        format!(
            "{triangles} triangles stand for the part: the verdict is on them, and how far they lie off what they stand for is NOT known; {off}"
        )
    }
}

/// A mesh as a part; `unit_mm` are the millimetres in a unit of the file, where a job says it.
pub(super) fn loaded(path: &Path, bytes: &[u8], unit_mm: Option<f64>) -> Result<Loaded, Failure> {
    let file = triangles::parsed(path, bytes)?;
    if let (Some(_), Some(own)) = (unit_mm, file.unit_mm) {
        let text = format!(
            "[part] unit_mm goes with meshes without a unit; this file says that its unit is {own} mm"
        );
        return Err(Failure::file(path, text));
    }
    let unit = match (file.unit_mm, unit_mm) {
        (Some(own), _) => format!("{own} mm"),
        (None, Some(said)) => format!("{said} mm, as the job says"),
        (None, None) => "mm taken, as it has none".to_owned(),
    };
    let format = match file.format {
        MeshFormat::Stl => "stl",
        MeshFormat::Ply => "ply",
        MeshFormat::ThreeMf => "3mf",
    };
    let triangles = triangles::scaled(file.triangles, file.unit_mm.or(unit_mm).unwrap_or(1.0));
    let part = mesh_part(&triangles, SHARP_RAD).map_err(|e| Failure::file(path, e))?;
    let face = |(k, f): (usize, facets::MeshFace)| LoadedFace {
        id: format!("F{}", k + 1),
        name: if f.rest { "many small pieces".to_owned() } else { String::new() },
        kind: "mesh".to_owned(),
        surface: Arc::new(TrimmedSurface::of_facets(Arc::new(f.facets))),
        source: None,
        spline: None,
        part_of_it: None,
    };
    let facts = MeshFacts { triangles: part.triangles, closed: part.closed, chord_mm: part.chord_mm };
    let mut diagnostics = part.diagnostics;
    diagnostics.push(Diagnostic::note("mesh", format!("{}; {USES}", facts.words())));
    Ok(Loaded {
        format,
        unit,
        schema: String::new(),
        uncertainty_mm: None,
        faces: part.faces.into_iter().enumerate().map(face).collect(),
        structure: Structure::default(),
        hidden: Vec::new(),
        not_used: Vec::new(),
        truncated: None,
        mesh: Some(facts),
        diagnostics,
    })
}

impl Loaded {
    /// The part, where paths can be planned on it.
    ///
    /// # Errors
    /// For a mesh, with what it can be used for.
    pub fn to_plan(&self, of: &Path) -> Result<&Self, Failure> {
        match &self.mesh {
            Some(_) => Err(Failure::file(of, format!("its part is a mesh: {USES}"))),
            None => Ok(self),
        }
    }
}
