//! Sides of faces against what the file says: `cargo run --release --example sides -- FILE...`
//!
//! Where a file says all sides, its faces are turned over at random and the sides found again, without the file's word. A line for
//! each file: faces right, wrong and open, groups, neighbours that do not fit, time. Then each group, and the volume behind the
//! faces that are not open, mm3.

use osculate_geom::Side;
use osculate_surfaces::sides::settle;
use osculate_surfaces::{Face, tessellate};
use std::time::Instant;

/// Volume behind a face seen from a point, mm3, with its area.
fn behind(face: &Face, side: Side, chord_mm: f64, from: nalgebra::Vector3<f64>) -> f64 {
    let mesh = tessellate(&face.surface, chord_mm, None);
    let at = |k: u32| nalgebra::Vector3::from(mesh.positions[k as usize]) - from;
    let sum: f64 = mesh.triangles.iter().map(|t| at(t[0]).dot(&at(t[1]).cross(&at(t[2]))) / 6.0).sum();
    sum * side.sign()
}

fn main() {
    for path in std::env::args().skip(1) {
        let part = match std::fs::read(&path).map_err(|e| e.to_string()) {
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
        let mut seed = 1_u64;
        let mut turned = Vec::new();
        let faces: Vec<Face> = part
            .faces
            .iter()
            .map(|f| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                turned.push(f.oriented && seed >> 63 == 1);
                if f.oriented && seed >> 63 == 1 { f.clone().flipped() } else { f.clone() }
            })
            .collect();
        let all: Vec<&Face> = faces.iter().collect();
        let start = Instant::now();
        let found = settle(&all, &vec![None; all.len()], part.uncertainty_mm);
        let time = start.elapsed().as_secs_f64();
        let (mut right, mut wrong, mut open) = (0, Vec::new(), Vec::new());
        for (k, f) in part.faces.iter().enumerate() {
            let truth = if turned[k] { Side::Against } else { Side::Along };
            match found.of[k] {
                None => open.push(f.id.as_str()),
                Some(s) if s == truth || !f.oriented => right += 1,
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
        let b = part.bbox();
        let from = b.centre().coords;
        let volume: f64 = (0..faces.len())
            .filter_map(|k| found.of[k].map(|s| behind(&faces[k], s, 2e-4 * b.diagonal_mm(), from)))
            .sum();
        println!("  volume {volume:.1}");
    }
}
