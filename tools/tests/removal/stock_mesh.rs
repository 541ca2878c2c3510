//! What is left as a mesh: closed, of the volume that is left, and read back as raw material.

use osculate_geom::{Box3, Point3, Vec3};
use osculate_surfaces::facets::read_stl;
use osculate_tools::removal::Swept;
use osculate_tools::removal::stock::{Blank, Mesh, Resolution, Stock, StockJob};
use osculate_tools::{Cutter, CutterSpec, Pose};
use std::collections::HashMap;

const FINE: Resolution = Resolution { cell_mm: 0.25, tri: true, budget_bytes: 1 << 30 };

/// Every edge has as many triangles in one sense as in the other.
fn assert_closed(mesh: &Mesh) {
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for t in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            assert_ne!(a, b);
            *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    assert!(edges.len() > 100 && edges.values().all(|n| *n == 0));
}

fn block() -> Stock {
    let corners = Box3 { min: Point3::new(-10.0, -8.0, -6.0), max: Point3::new(10.0, 8.0, 0.0) };
    Stock::fill(&Blank::Box(corners), &FINE).expect("a box").stock
}

#[test]
fn a_box_with_a_slot_through_it_is_closed_and_comes_back() {
    let mut stock = block();
    let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 40.0 }).expect("a ball");
    let at = |x: f64| Pose { tip: Point3::new(x, 1.0, -4.0), axis: Vec3::z_axis() };
    let motions = [Swept { from: at(-20.0), to: at(20.0), rapid: false, block: 1 }];
    let job = StockJob { cutter: &cutter, uppers: &[], motions: &motions, touch_mm: 1e-6 };
    stock.carve(&job, &|_| {}).expect("a slot");
    for (most, share) in [(40, 0.02), (1000, 0.004)] {
        let mesh = stock.mesh(most);
        assert_closed(&mesh);
        let (is, left) = (mesh.volume_mm3(), stock.volume().mm3);
        assert!((is - left).abs() < share * left, "{most}: {is} {left}");
    }
    let mesh = stock.mesh(1000);
    let triangles = read_stl(&mesh.stl()).expect("what was written");
    assert_eq!(triangles.len(), mesh.triangles.len());
    let again = Stock::fill(&Blank::Mesh(&triangles), &FINE).expect("a closed mesh").stock;
    let (is, left) = (again.volume().mm3, stock.volume().mm3);
    assert!((is - left).abs() < 0.01 * left, "{is} {left}");
    let ply = mesh.ply();
    let head = format!("element vertex {}\n", mesh.points.len());
    assert!(String::from_utf8_lossy(&ply[..400]).contains(&head));
    let body = 12 * mesh.points.len() + 13 * mesh.triangles.len();
    let begins = ply.windows(11).position(|w| w == b"end_header\n").expect("a head") + 11;
    assert_eq!(ply.len() - begins, body);
}

#[test]
fn a_box_keeps_its_flat_faces() {
    let stock = block();
    let mesh = stock.mesh(1000);
    assert_closed(&mesh);
    for p in &mesh.points {
        let off =
            [10.0 - p.x.abs(), 8.0 - p.y.abs(), p.z + 6.0, -p.z].into_iter().fold(f64::INFINITY, f64::min);
        // Edges are broken by a part of a cell.
        assert!(off.abs() < 0.15, "{p}");
    }
}
