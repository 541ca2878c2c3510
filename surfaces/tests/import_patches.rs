//! Bezier patch sets: Newell's layout and the one with degrees and poles.

use osculate_geom::{Point3, Surface, uv};
use osculate_surfaces::patches::{self, PatchesError};
use osculate_surfaces::{FaceKind, Format, detect, read};

/// A flat bicubic patch over [0, 3] x [0, 3] beside its neighbour over [3, 6] x [0, 3], sharing four vertices.
fn two() -> String {
    let mut out = String::from("# two patches\n2\n");
    let at = |i: usize, j: usize| 4 * i + j + 1;
    for first in [0, 3] {
        let row: Vec<String> = (0..16).map(|k| at(first + k / 4, k % 4).to_string()).collect();
        out += &format!("{}\n", row.join(","));
    }
    out += "28\n";
    for i in 0..7 {
        for j in 0..4 {
            out += &format!("{}.0,{j}.0, 1.5\n", i);
        }
    }
    out
}

#[test]
fn patches_of_vertex_numbers() {
    let part = read(two().as_bytes()).unwrap();
    assert_eq!((part.format, part.faces.len(), part.unit.as_str()), (Format::Patches, 2, "mm"));
    for (k, f) in part.faces.iter().enumerate() {
        assert_eq!((f.kind, f.degree(), f.entity), (FaceKind::Bezier, Some([3, 3]), 3 + k as u64));
        assert!((f.area_mm2() - 9.0).abs() < 1e-12);
    }
    assert!((part.faces[1].point(uv(0.5, 0.25)) - Point3::new(4.5, 0.75, 1.5)).norm() < 1e-14);
    // The unit is told to be assumed.
    assert!(part.diagnostics[0].message.contains("millimetres"));
    // One that is given counts, and nothing is assumed.
    let part = patches::read_in(two().as_bytes(), Some(40.0)).unwrap();
    assert_eq!((part.unit.as_str(), part.diagnostics.len()), ("40 mm", 0));
    assert!((part.faces[1].point(uv(0.5, 0.25)) - Point3::new(180.0, 30.0, 60.0)).norm() < 1e-12);
    assert!((part.faces[0].area_mm2() - 14_400.0).abs() < 1e-8);
}

#[test]
fn patches_of_degrees_and_poles() {
    // A bilinear saddle, and a patch of degrees 2 and 1 whose first row of poles is one point.
    let text = "2\n1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 1\n2 1\n0 0 0\n0 0 0\n1 1 0\n1 -1 0\n2 1 0\n2 -1 0\n";
    let part = patches::read(text.as_bytes()).unwrap();
    assert_eq!(part.faces.len(), 2);
    assert!((part.faces[0].point(uv(0.5, 0.5)) - Point3::new(0.5, 0.5, 0.25)).norm() < 1e-15);
    // Half width 2 s (1 - s) + s^2 over x = 2 s: the area is 2 (2 s - s^2) 2 ds = 8 / 3.
    assert!((part.faces[1].area_mm2() - 8.0 / 3.0).abs() < 1e-6);
    // A patch in one point is left out and told.
    let point = "1\n1 1\n".to_owned() + &"4 5 6\n".repeat(4);
    let part = patches::read(point.as_bytes()).unwrap();
    assert_eq!((part.faces.len(), part.not_used[0].count), (0, 1));
}

#[test]
fn every_refusal() {
    let e = |text: &str| patches::read(text.as_bytes()).unwrap_err();
    assert_eq!(e("two\n"), PatchesError::NoCount { line: 1, got: "two".into() });
    assert_eq!(
        e("1000000000\n1 1\n0 0 0\n"),
        PatchesError::Ends { got: 1, want: 4, what: "poles of a patch" }
    );
    assert_eq!(
        e("3\n1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 1\n"),
        PatchesError::Ends { got: 1, want: 3, what: "patches" }
    );
    assert_eq!(e("1\n1 99\n"), PatchesError::Degree { line: 2, got: [1, 99] });
    let text = two();
    assert_eq!(
        e(&text.replacen("2\n1,", "2000000\n1,", 1)),
        PatchesError::Line { line: 5, got: "28".into(), want: "16 vertex numbers" }
    );
    assert_eq!(
        e(&text.replacen("28,", "29,", 1).replace("26,27,28", "26,27,29")),
        PatchesError::Vertex { line: 4, got: 29, vertices: 28 }
    );
    assert_eq!(
        e(&text.replace("6.0,3.0, 1.5\n", "")),
        PatchesError::Ends { got: 27, want: 28, what: "vertices" }
    );
    assert!(matches!(
        e(&text.replace("6.0,3.0, 1.5", "6.0,nan, 1.5")),
        PatchesError::Line { want: "three coordinates", .. }
    ));
    assert_eq!(detect(b"12 apples\n"), None);
}
