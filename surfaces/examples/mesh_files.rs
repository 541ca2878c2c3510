//! Meshes every file named on the command line and prints whether the mesh closes, its area against the faces', and
//! its volume. The chord tolerance is a thousandth of each part's size.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use osculate_surfaces::{MeshOptions, mesh_faces, read};
use std::time::Instant;

fn main() {
    println!(
        "{:50} {:>6} {:>8} {:>6} {:>6} {:>5} {:>10} {:>10} {:>9} {:>8}",
        "file", "faces", "tris", "open", "bad", "unfin", "err/chord", "area rel", "volume", "s"
    );
    for path in std::env::args().skip(1) {
        let bytes = std::fs::read(&path).unwrap();
        let name: String = path.rsplit('/').next().unwrap_or(&path).chars().take(50).collect();
        let Ok(part) = read(&bytes) else {
            println!("{name:50} not read");
            continue;
        };
        if part.faces.is_empty() {
            println!("{name:50} no faces");
            continue;
        }
        let chord = 1e-3 * part.bbox().diagonal_mm();
        let start = Instant::now();
        let mesh = match mesh_faces(&part.faces, &MeshOptions::chord(chord)) {
            Ok(mesh) => mesh,
            Err(e) => {
                println!("{name:50} {e}");
                continue;
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let area: f64 = part.faces.iter().map(|f| f.area_mm2()).sum();
        let r = &mesh.report;
        println!(
            "{name:50} {:6} {:8} {:6} {:6} {:5} {:10.3} {:10.2e} {:9.3e} {:8.2}",
            part.faces.len(),
            mesh.triangles.len(),
            r.open_edges,
            r.bad_edges,
            r.unfinished.len(),
            r.chord_error_mm / chord,
            mesh.area_mm2() / area - 1.0,
            mesh.volume_mm3(),
            seconds
        );
    }
}
