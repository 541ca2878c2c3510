//! Mesh files read back by their own rules.

use crate::solids;

use osculate_surfaces::{MeshOptions, mesh_faces, stl};
use std::collections::HashMap;

type Corner = [u32; 3];

/// Whether every directed side of the triangles has its opposite exactly once.
fn closes(triangles: &[[Corner; 3]]) -> bool {
    let mut sides: HashMap<[Corner; 2], i32> = HashMap::new();
    for t in triangles {
        for k in 0..3 {
            *sides.entry([t[k], t[(k + 1) % 3]]).or_default() += 1;
        }
    }
    sides.iter().all(|([a, b], n)| *n == 1 && sides.get(&[*b, *a]) == Some(&1))
}

fn volume(triangles: &[[Corner; 3]]) -> f64 {
    let at = |c: Corner| c.map(|b| f64::from(f32::from_bits(b)));
    triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(at);
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        })
        .sum()
}

#[test]
fn binary_and_text_hold_the_same_closed_body() {
    let faces = solids::block_with_bore();
    let mesh = mesh_faces(&faces, &MeshOptions::chord(0.01)).unwrap();
    let bytes = stl::binary(&mesh);
    let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
    assert_eq!((bytes.len(), count), (84 + 50 * count, mesh.triangles.len()));
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let corner = |at: usize| [word(at), word(at + 4), word(at + 8)];
    let from_binary: Vec<[Corner; 3]> =
        (0..count).map(|k| [0, 1, 2].map(|j| corner(84 + 50 * k + 12 + 12 * j))).collect();
    assert!(closes(&from_binary));
    // Single precision: 24 bits of coordinates up to 5.
    assert!((volume(&from_binary) / mesh.volume_mm3() - 1.0).abs() < 1e-6);
    let text = stl::ascii(&mesh, "block\nwith bore");
    assert!(text.starts_with("solid blockwith bore\n") && text.ends_with("endsolid blockwith bore\n"));
    let numbers: Vec<Corner> = text
        .lines()
        .filter_map(|l| l.strip_prefix("vertex "))
        .map(|l| {
            let c: Vec<u32> = l.split(' ').map(|w| w.parse::<f32>().unwrap().to_bits()).collect();
            [c[0], c[1], c[2]]
        })
        .collect();
    let from_text: Vec<[Corner; 3]> = numbers.chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
    assert_eq!(from_text, from_binary);
}

#[test]
fn obj_counts_from_one_and_names_the_faces() {
    let faces = solids::cylinder();
    let mesh = mesh_faces(&faces, &MeshOptions::chord(0.1)).unwrap();
    let ids: Vec<&str> = faces.iter().map(|f| f.id.as_str()).collect();
    let text = stl::obj(&mesh, &ids);
    let count = |start: &str| text.lines().filter(|l| l.starts_with(start)).count();
    assert_eq!((count("v "), count("f "), count("g ")), (mesh.positions.len(), mesh.triangles.len(), 3));
    let indices = text.lines().filter_map(|l| l.strip_prefix("f ")).flat_map(|l| l.split(' '));
    let range =
        indices.map(|w| w.parse::<usize>().unwrap()).fold([usize::MAX, 0], |r, k| [r[0].min(k), r[1].max(k)]);
    assert_eq!(range, [1, mesh.positions.len()]);
}
