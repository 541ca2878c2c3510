//! `export`: faces of a part as STEP, IGES, JSON, or triangles as STL or OBJ.

use crate::screen::args::ExportArgs;
use crate::screen::{output, render};
use osculate::failure::{Done, Failure, Outcome, read};
use osculate_surfaces::{Face, MeshOptions, PartMesh, iges, json, mesh_faces, step, stl};
use serde::Serialize;
use std::io::{BufWriter, Seek, Write};

#[derive(Serialize)]
struct Triangles {
    count: usize,
    area_mm2: f64,
    chord_error_mm: f64,
    open_edges: usize,
    bad_edges: usize,
    watertight: bool,
    unfinished: Vec<String>,
}

#[derive(Serialize)]
struct Answer {
    out: String,
    format: &'static str,
    faces: usize,
    bytes: u64,
    triangles: Option<Triangles>,
}

/// Endings of files, and what they mean.
const FORMATS: [(&str, &str); 7] = [
    ("step", "step"),
    ("stp", "step"),
    ("igs", "iges"),
    ("iges", "iges"),
    ("json", "json"),
    ("stl", "stl"),
    ("obj", "obj"),
];

/// Chord tolerance as a part of the box's diagonal where none is given.
const CHORD: f64 = 1e-3;

/// Runs the verb.
pub fn run(args: &ExportArgs, as_json: bool) -> Outcome {
    output::file(&args.out, &[&args.part])?;
    let faces = chosen(args)?;
    let name = args.out.file_stem().map_or_else(|| "part".to_owned(), |s| s.to_string_lossy().into_owned());
    let kind = args.out.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let fail = |e: &dyn std::fmt::Display| Failure::file(&args.out, e);
    let Some(format) = FORMATS.iter().find(|f| f.0 == kind).map(|f| f.1) else {
        let path = args.out.display();
        return Err(Failure::Usage(format!(
            "{path}: the ending says what to write: .step, .stp, .igs, .iges, .json, .stl or .obj"
        )));
    };
    let mesh = match format {
        "stl" | "obj" => Some(meshed(args, &faces)?),
        _ => None,
    };
    let bytes = output::stream(&args.out, |file| {
        let mut out = BufWriter::new(file);
        match (format, &mesh) {
            ("step", _) => {
                let options = step::StepOptions { name, ..step::StepOptions::default() };
                step::write_to(&faces, &options, &mut out).map_err(|e| fail(&e))?;
            }
            ("iges", _) => {
                let options = iges::IgesOptions { name, ..iges::IgesOptions::default() };
                iges::write_to(&faces, &options, &mut out).map_err(|e| fail(&e))?;
            }
            (_, None) => {
                let text = json::write(&faces).map_err(|e| fail(&e))?;
                out.write_all(text.as_bytes()).map_err(|e| fail(&e))?;
            }
            (_, Some(mesh)) => {
                let ids: Vec<&str> = faces.iter().map(|f| f.id.as_str()).collect();
                let bytes = match (format, args.text) {
                    ("obj", _) => stl::obj(mesh, &ids).into_bytes(),
                    (_, true) => stl::ascii(mesh, &name).into_bytes(),
                    (_, false) => stl::binary(mesh),
                };
                out.write_all(&bytes).map_err(|e| fail(&e))?;
            }
        }
        out.stream_position().map_err(|e| fail(&e))
    })?;
    let triangles = mesh.as_ref().map(found);
    let out = args.out.display().to_string();
    let answer = Answer { out, format, faces: faces.len(), bytes, triangles };
    if as_json {
        render::json(&answer)?;
        return Ok(Done::Yes);
    }
    render::text(&format!("  {}: {} faces, {} bytes\n", answer.out, answer.faces, answer.bytes))?;
    if let Some(t) = &answer.triangles {
        let closed = if t.watertight {
            "closed".to_owned()
        } else {
            format!("not closed: {} open sides, {} bad ones", t.open_edges, t.bad_edges)
        };
        let (count, error) = (t.count, t.chord_error_mm);
        render::text(&format!("  {count} triangles, {closed}; at most {error:.3e} mm off where measured\n"))?;
        if !t.unfinished.is_empty() {
            render::text(&format!("  farther off than asked: {}\n", t.unfinished.join(", ")))?;
        }
    }
    Ok(Done::Yes)
}

/// The faces asked for, of a file that is whole.
fn chosen(args: &ExportArgs) -> Result<Vec<Face>, Failure> {
    let bytes = read(&args.part)?;
    if osculate_surfaces::facets::mesh_format(&bytes).is_some() {
        let what = format!("it is a mesh, which has no faces to export: {}", osculate::part::mesh::USES);
        return Err(Failure::file(&args.part, what));
    }
    let part = osculate_surfaces::read(&bytes).map_err(|e| Failure::file(&args.part, e))?;
    if part.truncated {
        let what = "the file is truncated: faces may be missing; export or copy it again";
        return Err(Failure::file(&args.part, what));
    }
    let mut faces = part.faces;
    if !args.faces.is_empty() {
        if let Some(id) = args.faces.iter().find(|id| faces.iter().all(|f| f.id != **id)) {
            let (count, part) = (faces.len(), &args.part);
            return Err(Failure::file(
                part,
                format!("there is no face {id} among its {count} (see inspect)"),
            ));
        }
        faces.retain(|f| args.faces.contains(&f.id));
    }
    if faces.is_empty() {
        return Err(Failure::file(&args.part, "it has no face to export (see inspect)"));
    }
    Ok(faces)
}

fn meshed(args: &ExportArgs, faces: &[Face]) -> Result<PartMesh, Failure> {
    let size = || faces.iter().fold(osculate_geom::Box3::empty(), |b, f| b.union(&f.bbox())).diagonal_mm();
    let options = MeshOptions {
        chord_mm: args.chord_mm.unwrap_or_else(|| CHORD * size()),
        angle_rad: args.angle_deg.map(f64::to_radians),
        max_edge_mm: args.max_edge_mm,
        join_mm: None,
    };
    mesh_faces(faces, &options).map_err(Failure::job)
}

fn found(mesh: &PartMesh) -> Triangles {
    let r = &mesh.report;
    Triangles {
        count: mesh.triangles.len(),
        area_mm2: mesh.area_mm2(),
        chord_error_mm: r.chord_error_mm,
        open_edges: r.open_edges,
        bad_edges: r.bad_edges,
        watertight: r.watertight(),
        unfinished: r.unfinished.clone(),
    }
}
