//! What was measured, on the triangles of the faces that a report draws.
//!
//! Of a face to machine the deviation is what stands over it or was cut too deep; of any other face only what was cut of it,
//! and zero where nothing was: what stands on it is not to go.

use super::data::FaceMesh;
use crate::part::LoadedFace;
use osculate_geom::Point3;
use osculate_surfaces::tessellate;
use osculate_tools::removal::{Cut, Sample};
use rayon::prelude::*;
use std::collections::HashMap;

/// How far from a vertex its sample may be, in distances between samples.
const REACH: f64 = 2.0;
/// Faces that are only checked have samples this many times as far apart.
const CHECK_COARSER: f64 = 4.0;

/// Triangles of a face for the picture.
pub fn mesh_of(face: &LoadedFace, edge_mm: f64) -> FaceMesh {
    let m = tessellate(&face.surface, 0.2 * edge_mm, Some(edge_mm));
    let flat = |v: &[[f64; 3]]| v.iter().map(|p| p.map(|x| x as f32)).collect();
    FaceMesh {
        id: face.id.clone(),
        checked: false,
        positions: flat(&m.positions),
        normals: flat(&m.normals),
        triangles: m.triangles,
        deviation_mm: Vec::new(),
        scalars: Vec::new(),
    }
}

/// Samples by cells of space, with what was measured there.
pub struct Measured<'a> {
    samples: &'a [Sample],
    cuts: &'a [Cut],
    machined: Cells,
    checked: Cells,
}

struct Cells {
    cell_mm: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl Cells {
    fn of(samples: &[Sample], cell_mm: f64, check_only: bool) -> Self {
        let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        for (k, s) in samples.iter().enumerate().filter(|(_, s)| s.check_only == check_only) {
            cells.entry(Self::key(cell_mm, &s.point)).or_default().push(k as u32);
        }
        Self { cell_mm, cells }
    }

    fn key(cell_mm: f64, p: &Point3) -> [i64; 3] {
        [p.x, p.y, p.z].map(|c| (c / cell_mm).floor() as i64)
    }

    /// The nearest sample of a face in the cells around a point.
    fn nearest(&self, p: &Point3, face: u32, samples: &[Sample]) -> Option<u32> {
        let [a, b, c] = Self::key(self.cell_mm, p);
        let mut best: Option<(f64, u32)> = None;
        for i in -1..=1 {
            for j in -1..=1 {
                for k in -1..=1 {
                    for s in self.cells.get(&[a + i, b + j, c + k]).into_iter().flatten() {
                        let sample = &samples[*s as usize];
                        let d = (sample.point - p).norm_squared();
                        if sample.face == face && best.is_none_or(|b| (d, *s) < b) {
                            best = Some((d, *s));
                        }
                    }
                }
            }
        }
        best.map(|b| b.1)
    }
}

impl<'a> Measured<'a> {
    /// Of samples that are so far apart on the faces to machine.
    pub fn new(samples: &'a [Sample], cuts: &'a [Cut], spacing_mm: f64) -> Self {
        let cell_mm = REACH * spacing_mm;
        Self {
            samples,
            cuts,
            machined: Cells::of(samples, cell_mm, false),
            checked: Cells::of(samples, CHECK_COARSER * cell_mm, true),
        }
    }

    /// Of every vertex of a face with this number the sample nearest to it, where one is near.
    pub fn nearest(&self, mesh: &FaceMesh, face: u32) -> Vec<Option<u32>> {
        let cells = if mesh.checked { &self.checked } else { &self.machined };
        let at = |p: &[f32; 3]| cells.nearest(&Point3::from(p.map(f64::from)), face, self.samples);
        mesh.positions.par_iter().map(at).collect()
    }

    /// The deviation at vertices with these samples next to them, mm; NaN where none is.
    pub fn deviation_mm(&self, nearest: &[Option<u32>], checked: bool) -> Vec<f32> {
        let most = if checked { 0.0 } else { f64::INFINITY };
        let at = |s: &Option<u32>| s.map_or(f32::NAN, |s| self.cuts[s as usize].standoff_mm.min(most) as f32);
        nearest.iter().map(at).collect()
    }
}
