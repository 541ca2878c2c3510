//! Meshes of closed bodies: every side has its neighbour, areas and volumes tend to the exact ones with the chord
//! tolerance, and no point of a face is farther from the mesh than that.

use crate::solids;

use osculate_geom::{Axis, Point3, Surface, uv};
use osculate_surfaces::{MeshError, MeshOptions, PartMesh, mesh_faces};
use solids::{block_with_bore, cone, cylinder, sphere, torus};
use std::f64::consts::PI;

fn closed(mesh: &PartMesh, what: &str) {
    assert!(mesh.report.watertight(), "{what}: {:?}", mesh.report);
    assert!(mesh.report.unfinished.is_empty(), "{what}: {:?}", mesh.report);
    // Euler: V - E + F is even for closed surfaces.
    let euler = mesh.positions.len() as i64 - mesh.triangles.len() as i64 / 2;
    assert_eq!(euler % 2, 0, "{what}");
}

#[test]
fn closed_bodies_close_and_converge() {
    let slant = 45f64.sqrt();
    let bodies = [
        ("cylinder", cylinder(), 48.0 * PI, 45.0 * PI),
        ("sphere", sphere(), 16.0 * PI, 32.0 / 3.0 * PI),
        ("torus", torus(), 4.0 * PI * PI * 7.5, 2.0 * PI * PI * 5.0 * 2.25),
        ("cone", cone(), 9.0 * PI + 3.0 * PI * slant, 18.0 * PI),
        ("block", block_with_bore(), 2.0 * (80.0 - 4.0 * PI) + 180.0 + 20.0 * PI, 5.0 * (80.0 - 4.0 * PI)),
    ];
    for (what, faces, area, volume) in bodies {
        let mut errors = Vec::new();
        for chord in [0.02, 0.005, 0.00125] {
            let mesh = mesh_faces(&faces, &MeshOptions::chord(chord)).unwrap();
            closed(&mesh, what);
            assert!(mesh.report.chord_error_mm <= chord, "{what}: {}", mesh.report.chord_error_mm);
            let error = [mesh.area_mm2() / area - 1.0, mesh.volume_mm3() / volume - 1.0].map(f64::abs);
            // A layer as thick as the chord tolerance over the whole area.
            assert!(error[1] <= chord * area / volume, "{what} at {chord}: {error:?}");
            errors.push(error);
        }
        // Twice h^2 = a sixteenth: the error of order h^2 falls with the chord, allowing for whole numbers of chords.
        for k in 0..2 {
            let fall = errors[2][k] / errors[0][k];
            assert!(fall < 0.2, "{what}: {errors:?}");
        }
    }
}

/// Distance of a point from a triangle.
fn from_triangle(p: &Point3, [a, b, c]: [Point3; 3]) -> f64 {
    let n = (b - a).cross(&(c - a));
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(s, t)| n.dot(&(t - s).cross(&(p - s))) >= 0.0);
    if inside {
        return (p - a).dot(&n).abs() / n.norm();
    }
    let side = |s: Point3, t: Point3| {
        let d = t - s;
        let f = ((p - s).dot(&d) / d.norm_squared()).clamp(0.0, 1.0);
        (s + d * f - p).norm()
    };
    side(a, b).min(side(b, c)).min(side(c, a))
}

#[test]
fn no_point_of_a_face_is_farther_off_than_asked() {
    for (what, faces) in [("torus", torus()), ("cone", cone()), ("block", block_with_bore())] {
        let chord = 0.02;
        let mesh = mesh_faces(&faces, &MeshOptions::chord(chord)).unwrap();
        for (face, range) in faces.iter().zip(&mesh.faces) {
            let own = &mesh.triangles[range.clone()];
            let d = face.domain();
            for k in 0..400 {
                // A sequence that fills the rectangle evenly and meets no grid line.
                let at =
                    d.at((0.5 + 0.754_877_666 * k as f64).fract(), (0.5 + 0.569_840_29 * k as f64).fract());
                if !face.contains(at) {
                    continue;
                }
                let p = face.point(at);
                let off = own
                    .iter()
                    .map(|t| from_triangle(&p, t.map(|i| mesh.positions[i as usize])))
                    .fold(f64::INFINITY, f64::min);
                // The middles of sides and triangles were measured; between them the distance may be a little larger.
                assert!(off <= 1.05 * chord, "{what}: {off} at {at:?}");
            }
        }
    }
}

#[test]
fn angle_and_length_limits_hold() {
    let faces = cylinder();
    let long =
        mesh_faces(&faces, &MeshOptions { max_edge_mm: Some(0.7), ..MeshOptions::chord(0.1) }).unwrap();
    closed(&long, "cylinder");
    for t in &long.triangles {
        for k in 0..3 {
            let (p, q) = (long.positions[t[k] as usize], long.positions[t[(k + 1) % 3] as usize]);
            assert!((p - q).norm() <= 0.7 + 1e-9);
        }
    }
    let limit = 5f64.to_radians();
    let turned =
        mesh_faces(&faces, &MeshOptions { angle_rad: Some(limit), ..MeshOptions::chord(1.0) }).unwrap();
    closed(&turned, "cylinder");
    // A full turn in steps of five degrees.
    assert!(turned.faces[0].len() >= 2 * 72);
}

#[test]
fn an_open_face_is_said_to_be_open() {
    let wall = &cylinder()[..1];
    let mesh = mesh_faces(wall, &MeshOptions::chord(0.05)).unwrap();
    assert!(!mesh.report.watertight() && mesh.report.bad_edges == 0);
    // Both rims are open, and nothing else: the wall closes along its seam.
    let rim: usize =
        mesh.triangles.iter().flatten().map(|k| *k as usize).collect::<std::collections::BTreeSet<_>>().len();
    assert_eq!(mesh.report.open_edges, rim);
    assert_eq!(wall[0].breaks(Axis::V).len(), 2);
    assert!(wall[0].contains(uv(1.0, 2.0)));
    let none = mesh_faces(&[], &MeshOptions::chord(1.0)).unwrap();
    assert!(none.triangles.is_empty() && none.report.watertight());
}

#[test]
fn every_limit_is_checked() {
    let faces = sphere();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(mesh_faces(&faces, &MeshOptions::chord(bad)), Err(MeshError::Limit { .. })));
        let edge = MeshOptions { max_edge_mm: Some(bad), ..MeshOptions::chord(0.1) };
        assert!(matches!(mesh_faces(&faces, &edge), Err(MeshError::Limit { .. })));
    }
    assert!(matches!(mesh_faces(&faces, &MeshOptions::chord(1e-9)), Err(MeshError::TooFine { .. })));
}
