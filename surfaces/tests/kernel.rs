//! Jets and curvatures of bicubic surfaces against reference vectors of another kernel (`data/NOTICE.md`).

use osculate_geom::{Point3, Surface, Vec3, uv};
use osculate_surfaces::{Net, NurbsSurface};

fn surface(text: &str) -> NurbsSurface {
    let mut lines = text.lines();
    let numbers = |l: &str| l.split_whitespace().map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>();
    let head: Vec<usize> = lines.next().unwrap().split_whitespace().map(|x| x.parse().unwrap()).collect();
    let ku = numbers(lines.next().unwrap());
    let kv = numbers(lines.next().unwrap());
    let rows: Vec<Vec<f64>> = lines.filter(|l| !l.trim().is_empty()).map(numbers).collect();
    let points = rows.iter().map(|r| Point3::new(r[0], r[1], r[2])).collect();
    let weights: Vec<f64> = rows.iter().map(|r| r[3]).collect();
    let rational = weights.iter().any(|w| *w != weights[0]);
    let net = Net { count: [head[0], head[1]], points, weights: rational.then_some(weights) };
    NurbsSurface::new([head[2], head[3]], [ku, kv], net).unwrap()
}

fn check(surface: &NurbsSurface, vectors: &str) {
    let mut lines = vectors.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |n: &str| names.iter().position(|x| *x == n).unwrap();
    let mut seen = 0;
    for line in lines.filter(|l| !l.is_empty()) {
        let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let at = |n: &str| v[column(n)];
        let vector = |n: &str| Vec3::new(at(&format!("{n}_x")), at(&format!("{n}_y")), at(&format!("{n}_z")));
        let jet = surface.jet2(uv(at("u"), at("v")));
        // Sizes of the surface and of its derivatives: about 70 mm over a unit rectangle with 7 spans.
        let close = |got: Vec3, want: Vec3, size: f64, relative: f64, name: &str| {
            assert!((got - want).norm() <= relative * size, "{name} at {line}: {got:?} against {want:?}");
        };
        close(jet.point.coords, vector("S"), 70.0, 1e-14, "S");
        close(jet.du, vector("Su"), 70.0, 1e-12, "Su");
        close(jet.dv, vector("Sv"), 70.0, 1e-12, "Sv");
        close(jet.duu, vector("Suu"), 500.0, 1e-12, "Suu");
        close(jet.duv, vector("Suv"), 500.0, 1e-12, "Suv");
        close(jet.dvv, vector("Svv"), 500.0, 1e-12, "Svv");
        // The reference counts bending towards the normal as positive: the opposite of convex.
        let p = jet.forms().unwrap().principal();
        let (k_max, k_min) = (-at("kmin"), -at("kmax"));
        let size = k_max.abs().max(k_min.abs());
        assert!((p.k_max - k_max).abs() <= 1e-9 * size, "k_max at {line}: {} against {k_max}", p.k_max);
        assert!((p.k_min - k_min).abs() <= 1e-9 * size, "k_min at {line}: {} against {k_min}", p.k_min);
        if k_max - k_min > 1e-3 * size {
            assert!(p.d_max.dot(&vector("dmin")).abs() > 1.0 - 1e-9, "direction at {line}");
        }
        seen += 1;
    }
    assert_eq!(seen, 120);
}

#[test]
fn polynomial_surface() {
    check(&surface(include_str!("data/surf_poly.txt")), include_str!("data/vec_poly.csv"));
}

#[test]
fn rational_surface() {
    check(&surface(include_str!("data/surf_rat.txt")), include_str!("data/vec_rat.csv"));
}
