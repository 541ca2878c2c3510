//! `inspect`: what is in a CAD file.

use crate::args::PartArgs;
use crate::failure::{Done, Outcome};
use crate::part::{self, Loaded, LoadedFace};
use crate::render::{self, Table, number};
use osculate_geom::{Box3, Surface};
use rayon::prelude::*;
use serde::Serialize;

#[derive(Serialize)]
struct FaceRow {
    id: String,
    name: String,
    kind: String,
    entity: u64,
    degree: Vec<usize>,
    poles: Vec<usize>,
    rational: bool,
    trimmed: bool,
    area_mm2: f64,
    bbox_mm: Vec<f64>,
    /// Least and greatest; empty where no point of the face has a tangent plane.
    principal_curvature_per_mm: Vec<f64>,
    u_range: [f64; 2],
    v_range: [f64; 2],
}

#[derive(Serialize)]
struct NotUsed {
    kind: String,
    count: usize,
    why: String,
}

#[derive(Serialize)]
struct Answer {
    format: &'static str,
    unit: String,
    schema: String,
    faces: Vec<FaceRow>,
    bbox_mm: Vec<f64>,
    area_mm2: f64,
    not_used: Vec<NotUsed>,
    diagnostics: Vec<String>,
}

fn corners(b: &Box3) -> Vec<f64> {
    if b.is_empty() { Vec::new() } else { b.min.iter().chain(b.max.iter()).copied().collect() }
}

fn row(face: &LoadedFace) -> (FaceRow, Box3) {
    let b = part::bounds(face);
    let d = face.surface.domain();
    let source = face.source.as_ref();
    let row = FaceRow {
        id: face.id.clone(),
        name: face.name.clone(),
        kind: face.kind.clone(),
        entity: source.map_or(0, |f| f.entity),
        degree: source.and_then(|f| f.degree()).map_or_else(Vec::new, |d| d.to_vec()),
        poles: source.and_then(|f| f.pole_count()).map_or_else(Vec::new, |d| d.to_vec()),
        rational: source.and_then(|f| f.is_rational()).unwrap_or(false),
        trimmed: source.is_some_and(|f| f.trimmed()),
        area_mm2: part::area(face),
        bbox_mm: corners(&b),
        principal_curvature_per_mm: part::curvature_range(&*face.surface)
            .map_or_else(Vec::new, |r| r.to_vec()),
        u_range: [d.u.lo, d.u.hi],
        v_range: [d.v.lo, d.v.hi],
    };
    (row, b)
}

/// Runs the verb.
pub fn run(args: &PartArgs, json: bool) -> Outcome {
    let part = part::load(args)?;
    let answer = answer(&part);
    if json {
        render::json(&answer)?;
    } else {
        render::text(&describe(&answer, &part));
    }
    // What could be read is shown all the same.
    part::whole(part).map(|_| Done::Yes)
}

fn answer(part: &Loaded) -> Answer {
    let rows: Vec<(FaceRow, Box3)> = part.faces.par_iter().map(row).collect();
    let whole = rows.iter().fold(Box3::empty(), |b, r| b.union(&r.1));
    let faces: Vec<FaceRow> = rows.into_iter().map(|r| r.0).collect();
    Answer {
        format: part.format,
        unit: part.unit.clone(),
        schema: part.schema.clone(),
        bbox_mm: corners(&whole),
        // An empty sum is minus zero.
        area_mm2: faces.iter().map(|f| f.area_mm2).sum::<f64>() + 0.0,
        faces,
        not_used: part
            .not_used
            .iter()
            .map(|(kind, count, why)| NotUsed { kind: kind.clone(), count: *count, why: why.clone() })
            .collect(),
        diagnostics: part.diagnostics.iter().map(ToString::to_string).collect(),
    }
}

fn describe(a: &Answer, part: &Loaded) -> String {
    let mut out = format!("\n  {} file, unit {}", a.format, a.unit);
    if !a.schema.is_empty() {
        out.push_str(&format!(", schema {}", a.schema));
    }
    out.push_str(&format!("; {} faces, {} mm2\n", a.faces.len(), number(a.area_mm2, 7)));
    if let [x0, y0, z0, x1, y1, z1] = a.bbox_mm[..] {
        out.push_str(&format!("  box mm: {x0:.3} {y0:.3} {z0:.3} to {x1:.3} {y1:.3} {z1:.3}\n"));
    }
    if !a.faces.is_empty() {
        let mut t = Table::new([
            "face",
            "kind",
            "degree",
            "poles",
            "rational",
            "trimmed",
            "area mm2",
            "k_min 1/mm",
            "k_max 1/mm",
        ]);
        let pair = |v: &[usize]| v.iter().map(ToString::to_string).collect::<Vec<_>>().join("x");
        let yes = |b: bool| if b { "yes" } else { "-" }.to_owned();
        for f in &a.faces {
            let k =
                |i: usize| f.principal_curvature_per_mm.get(i).map_or_else(|| "-".into(), |k| number(*k, 4));
            t.row([
                f.id.clone(),
                f.kind.clone(),
                pair(&f.degree),
                pair(&f.poles),
                yes(f.rational),
                yes(f.trimmed),
                number(f.area_mm2, 6),
                k(0),
                k(1),
            ]);
        }
        out.push_str(&format!("\n{}", t.render()));
    }
    if !a.not_used.is_empty() {
        let mut t = Table::new(["not used", "count", "why"]);
        for n in &a.not_used {
            t.row([n.kind.clone(), n.count.to_string(), n.why.clone()]);
        }
        out.push_str(&format!("\n{}", t.render()));
    }
    if !part.diagnostics.is_empty() {
        out.push_str(&format!("\n{}", render::findings(&part.diagnostics)));
    }
    out.push('\n');
    out
}
