//! Sides of faces against what the file says: `cargo run --release -p osculate-surfaces --example sides -- FILE...`
//!
//! Where a file says all sides, its faces are turned over at random and the sides found again, without the file's word. A line for
//! each file: faces right, wrong and open, groups, neighbours that do not fit, time. Then each group, and the volume behind the
//! faces that are not open, mm3.
//!
//! With `--data FOLDER` all parts of a reference collection as one table, with rays through triangles as a second opinion on each face
//! and the volume that another kernel computed (`table.rs`).

#![allow(clippy::print_stdout, reason = "it prints its findings")]

use osculate_geom::{Jet2, Point3, Side, Vec3};
use osculate_surfaces::Face;
use osculate_surfaces::Part;
use osculate_surfaces::sides::{Before, settle};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

mod parity;
mod table;

/// The faces of a part, some of those whose side the file says turned over, and the side that each should get then.
struct Turned {
    faces: Vec<Face>,
    truth: Vec<Side>,
}

fn turned(part: &Part) -> Turned {
    let mut seed = 1_u64;
    let mut truth = Vec::new();
    let faces = part
        .faces
        .iter()
        .map(|f| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let turn = f.oriented && seed >> 63 == 1;
            truth.push(if turn { Side::Against } else { Side::Along });
            if turn { f.clone().flipped() } else { f.clone() }
        })
        .collect();
    Turned { faces, truth }
}

/// Which faces bound which solid of the file.
fn solids(part: &Part) -> Vec<Option<usize>> {
    part.structure.solids(part.faces.iter().map(|f| f.id.as_str()))
}

/// What is known without the word of the file on sides.
fn before<'a>(part: &Part, solids: &'a [Option<usize>]) -> Before<'a> {
    Before { sides: &[], solids, uncertainty_mm: part.uncertainty_mm }
}

/// Volume behind a face seen from a point, mm3.
fn behind(face: &Face, side: Side, from: Point3) -> f64 {
    let flux = |jet: &Jet2| jet.normal().map_or(0.0, |n| (jet.point - from).dot(&n) / 3.0);
    face.surface.integrate(1e-4, &flux) * side.sign()
}

/// What normals times areas do not cancel, mm2: nothing for a closed shell.
fn leak(faces: &[Face], sides: &[Option<Side>]) -> f64 {
    let mut sum = Vec3::zeros();
    for (f, s) in faces.iter().zip(sides) {
        for k in 0..3 {
            let sign = s.map_or(0.0, Side::sign);
            sum[k] += sign * f.surface.integrate(1e-4, &|jet| jet.normal().map_or(0.0, |n| n[k]));
        }
    }
    sum.norm()
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [flag, data] if flag == "--data" => {
            if let Err(why) = table::print(Path::new(data)) {
                println!("{why}");
                return ExitCode::FAILURE;
            }
        }
        files => each(files),
    }
    ExitCode::SUCCESS
}

/// What was found of each file, with its groups.
fn each(files: &[String]) {
    for path in files {
        let part = match std::fs::read(path).map_err(|e| e.to_string()) {
            Ok(bytes) => osculate_surfaces::read(&bytes).map_err(|e| e.to_string()),
            Err(e) => Err(e),
        };
        let part = match part {
            Ok(part) => part,
            Err(e) => {
                println!("{path}: {e}");
                continue;
            }
        };
        let Turned { faces, truth } = turned(&part);
        let all: Vec<&Face> = faces.iter().collect();
        let start = Instant::now();
        let solids = solids(&part);
        let found = settle(&all, &before(&part, &solids));
        let time = start.elapsed().as_secs_f64();
        let (mut right, mut wrong, mut open) = (0, Vec::new(), Vec::new());
        for (k, f) in part.faces.iter().enumerate() {
            match found.of[k] {
                None => open.push(f.id.as_str()),
                Some(s) if s == truth[k] || !f.oriented => right += 1,
                Some(_) => wrong.push(f.id.as_str()),
            }
        }
        let said = part.faces.iter().filter(|f| f.oriented).count();
        println!(
            "{path}: {} faces ({said} said), {right} right, {} wrong, {} open, {} groups, {} conflicts, {time:.2} s",
            faces.len(),
            wrong.len(),
            open.len(),
            found.groups.len(),
            found.conflicts.len()
        );
        println!("  wrong {wrong:?}\n  open {open:?}");
        for g in &found.groups {
            let ids: Vec<&str> = g.faces.iter().take(8).map(|k| faces[*k].id.as_str()).collect();
            println!("  {:?} {:+.3} of {} faces: {}", g.settled, g.certainty, g.faces.len(), ids.join(" "));
        }
        for c in &found.conflicts {
            let [a, b] = c.faces.map(|f| faces[f].id.as_str());
            println!("  conflict {a} {b} {:.3} mm within {}", c.length_mm, c.within);
        }
        let from = part.bbox().centre();
        let volume: f64 =
            (0..faces.len()).filter_map(|k| found.of[k].map(|s| behind(&faces[k], s, from))).sum();
        let said: f64 = part.faces.iter().map(|f| behind(f, Side::Along, from)).sum();
        let area: f64 = part.faces.iter().map(Face::area_mm2).sum();
        println!(
            "  volume {volume:.1} mm3, leak {:.3} mm2; as the file has it {said:.1} mm3, {:.3} mm2; area {area:.1} mm2",
            leak(&faces, &found.of),
            leak(&part.faces, &vec![Some(Side::Along); faces.len()])
        );
    }
}
