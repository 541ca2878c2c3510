//! Sections of points: layouts, closed and open sides, contours, refusals.

use osculate_geom::{Point3, Surface, uv};
use osculate_surfaces::sections::{self, SectionsError};
use osculate_surfaces::{FaceKind, Format, detect, read};
use std::f64::consts::{PI, TAU};

/// Point k of n on a circle of radius 2 at height z.
fn on_circle(k: usize, n: usize, z: f64) -> String {
    let a = TAU * k as f64 / n as f64;
    format!("{:.12}\t{:.12} {z}", 2.0 * a.cos(), 2.0 * a.sin())
}

/// Four circles of 24 points at heights 0, 1, 3, 4 with `head` before each.
fn circles(head: impl Fn(usize) -> String, each: impl Fn(usize, &str) -> String) -> String {
    let mut out = String::new();
    for (i, z) in [0.0, 1.0, 3.0, 4.0].into_iter().enumerate() {
        out += &head(i);
        for k in 0..24 {
            out += &each(i, &on_circle(k, 24, z));
        }
    }
    out
}

#[test]
fn sections_by_header_blank_line_count_index_and_height() {
    let plain = |_: usize, p: &str| format!("{p}\n");
    let none = |_: usize| String::new();
    for (what, text) in [
        ("header", circles(|i| format!("# Profile {i} at {}%\n", 30 * i), plain)),
        ("blank", circles(|_| "\n".into(), plain)),
        ("count", circles(|_| "24\n".into(), plain)),
        ("index", circles(none, |i, p| format!("{i} {p}\n"))),
        ("height", circles(none, plain)),
        (
            "named",
            format!(
                "section,x,y,z\n{}",
                circles(none, |i, p| format!("{i}, {}\n", p.replace(['\t', ' '], ", ")))
            ),
        ),
    ] {
        assert_eq!(detect(text.as_bytes()), Some(Format::Sections), "{what}");
        let part = read(text.as_bytes()).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_eq!(part.faces.len(), 1, "{what}");
        let f = &part.faces[0];
        assert_eq!((f.kind, f.degree()), (FaceKind::Bspline, Some([3, 3])), "{what}");
        // A closed cubic through 24 points of a circle is off by 2 (pi / 12)^4 / 384, under 3e-5.
        assert!((f.area_mm2() - 16.0 * PI).abs() < 1e-3 * 16.0 * PI, "{what}: {}", f.area_mm2());
        for (u, v) in [(0.1, 0.2), (0.7, 0.9), (0.0, 0.0)] {
            let p = f.point(f.domain().at(u, v));
            assert!((p.x.hypot(p.y) - 2.0).abs() < 5e-5, "{what}: {p}");
        }
        assert!(
            part.diagnostics.iter().any(|d| d.message.contains("4 closed sections of 24 points")),
            "{what}: {:?}",
            part.diagnostics
        );
        assert!(part.diagnostics.iter().any(|d| d.message.contains("millimetres")), "{what}");
    }
}

#[test]
fn units_and_repeated_points() {
    let closed = |i: usize, p: &str| {
        format!(
            "{p}\n{}",
            if p.starts_with("1.931851652578\t-") {
                on_circle(0, 24, [0.0, 1.0, 3.0, 4.0][i]) + "\n"
            } else {
                String::new()
            }
        )
    };
    let text = format!("# Coordinates unit : cm\n{}", circles(|i| format!("# {i}\n"), closed));
    let part = sections::read(text.as_bytes()).unwrap();
    assert_eq!(part.unit, "cm");
    assert!((part.faces[0].area_mm2() - 1600.0 * PI).abs() < 1e-3 * 1600.0 * PI);
    assert!(
        part.diagnostics.iter().any(|d| d.message.contains("repeated last ones")),
        "{:?}",
        part.diagnostics
    );
    // What the caller says counts first.
    let inch = sections::read_in(text.as_bytes(), Some(25.4)).unwrap();
    assert!((inch.faces[0].area_mm2() / part.faces[0].area_mm2() - 6.4516).abs() < 1e-9);
}

#[test]
fn two_sides_in_one_row_and_differing_counts() {
    // Two planes y = 0 and y = 1, x from 0 to 3, z from 0 to 2.
    let mut text = String::from("span_index,ss_x,ss_y,ss_z,ps_x,ps_y,ps_z\n");
    for i in 0..3 {
        for k in 0..7 {
            let x = f64::from(k) / 2.0;
            text += &format!("{i}, {x}, 0.0, {i}.0, {x}, 1.0, {i}.0\n");
        }
    }
    let part = read(text.as_bytes()).unwrap();
    let names: Vec<&str> = part.faces.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["ss", "ps"]);
    for (k, f) in part.faces.iter().enumerate() {
        assert!((f.area_mm2() - 6.0).abs() < 1e-10);
        assert!((f.point(uv(0.5, 0.5)) - Point3::new(1.5, k as f64, 1.0)).norm() < 1e-12);
    }
    // Open sections of 5, 6 and 9 points on a plane.
    let mut text = String::new();
    for (z, n) in [(0, 5), (1, 6), (2, 9)] {
        for k in 0..n {
            text += &format!("{} 0 {z}\n", 3.0 * f64::from(k) / f64::from(n - 1));
        }
        text += "\n";
    }
    let part = read(text.as_bytes()).unwrap();
    assert!((part.faces[0].area_mm2() - 6.0).abs() < 1e-9);
    assert!(part.diagnostics.iter().any(|d| d.message.contains("open sections of 5 to 9 points")));
}

#[test]
fn a_contour_is_turned() {
    // A cone of radii 1 and 4 over x from 0 to 4: pi (1 + 4) 5.
    let text: String = "x,r\n".to_owned()
        + &(0..9)
            .map(|k| format!("{},{}\n", 0.5 * f64::from(k), 1.0 + 0.375 * f64::from(k)))
            .collect::<String>();
    let part = read(text.as_bytes()).unwrap();
    assert_eq!(part.faces[0].kind, FaceKind::Revolution);
    assert!((part.faces[0].area_mm2() - 25.0 * PI).abs() < 1e-4);
    let b = part.faces[0].bbox();
    assert!(b.min.x.abs() < 1e-9 && (b.max.x - 4.0).abs() < 1e-9 && (b.max.y - 4.0).abs() < 1e-6);
}

#[test]
fn every_refusal() {
    let e = |text: &str| sections::read(text.as_bytes()).unwrap_err();
    assert_eq!(e("words only\n"), SectionsError::NoRows);
    assert_eq!(e("1 2 3\n4 5 6\n7 8\n"), SectionsError::Columns { line: 3, got: 2, want: 3 });
    assert_eq!(e("1 2\n3 4\n5 6\n"), SectionsError::TwoColumns { line: 1 });
    assert_eq!(e("1.5 2 3 4\n3 4 5 6\n"), SectionsError::Unnamed { line: 1, columns: 4 });
    assert!(matches!(e("1 2 nan\n"), SectionsError::NotFinite { line: 1, .. }));
    assert_eq!(e("1 0 0 0\n2 1 0 0\n3 0 1 0\n"), SectionsError::Cloud { points: 3 });
    assert_eq!(e("0 0 0\n1 1 1\n2 2 4\n"), SectionsError::OneSection { points: 3 });
    assert_eq!(
        e("0 0 0\n1 0 0\n1 0 0\n\n0 1 1\n1 1 1\n2 1 1\n"),
        SectionsError::FewPoints { line: 1, got: 2, need: 3 }
    );
    assert!(matches!(e("x,r\n0,1\n1,-1\n2,1\n"), SectionsError::Contour(_)));
}
