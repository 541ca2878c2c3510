//! Surfaces shared by the tests of the kernel.
#![allow(dead_code, reason = "every test program uses a part of this")]

use osculate_geom::{Point3, Vec3};
use osculate_surfaces::{Net, NurbsSurface};
use proptest::prelude::*;

/// A surface from its text, see `data/NOTICE.md`.
pub fn from_text(text: &str) -> NurbsSurface {
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

/// The polynomial and the rational surface of the reference data.
pub fn reference(rational: bool) -> NurbsSurface {
    from_text(if rational {
        include_str!("../data/surf_rat.txt")
    } else {
        include_str!("../data/surf_poly.txt")
    })
}

/// Knots of a full circle in four quarters.
const CIRCLE: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0];

/// The unit circle's nine poles and weights.
fn circle() -> Vec<([f64; 2], f64)> {
    let h = 0.5f64.sqrt();
    let corners = [
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
    ];
    corners.iter().enumerate().map(|(k, c)| (*c, if k % 2 == 0 { 1.0 } else { h })).collect()
}

/// The surface of revolution about z of a meridian of poles (radius, height) and weights: u around, v along.
pub fn revolved(degree: usize, knots: &[f64], meridian: &[([f64; 2], f64)]) -> NurbsSurface {
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (c, w) in circle() {
        for (m, x) in meridian {
            points.push(Point3::new(c[0] * m[0], c[1] * m[0], m[1]));
            weights.push(w * x);
        }
    }
    let net = Net { count: [9, meridian.len()], points, weights: Some(weights) };
    NurbsSurface::new([2, degree], [CIRCLE.to_vec(), knots.to_vec()], net).unwrap()
}

/// The sphere about the origin, from its south to its north pole along v.
pub fn sphere(radius: f64) -> NurbsSurface {
    let h = 0.5f64.sqrt();
    let r = radius;
    let meridian = [([0.0, -r], 1.0), ([r, -r], h), ([r, 0.0], 1.0), ([r, r], h), ([0.0, r], 1.0)];
    revolved(2, &[0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0], &meridian)
}

/// The torus about z.
pub fn torus(major: f64, minor: f64) -> NurbsSurface {
    let meridian: Vec<_> =
        circle().into_iter().map(|(c, w)| ([major + minor * c[0], minor * c[1]], w)).collect();
    revolved(2, &CIRCLE, &meridian)
}

/// The cylinder about z from z = 0 to `height`.
pub fn cylinder(radius: f64, height: f64) -> NurbsSurface {
    revolved(1, &[0.0, 0.0, height, height], &[([radius, 0.0], 1.0), ([radius, height], 1.0)])
}

/// The same surface with its poles moved: times `scale`, then by `shift`.
pub fn moved(s: &NurbsSurface, scale: f64, shift: Vec3) -> NurbsSurface {
    let mut net = s.net().clone();
    for p in &mut net.points {
        *p = *p * scale + shift;
    }
    let knots = [osculate_geom::Axis::U, osculate_geom::Axis::V].map(|a| s.knots(a).as_slice().to_vec());
    NurbsSurface::new(s.degree(), knots, net).unwrap()
}

/// A wavy surface of any degree to 9, rational or not, with double knots and unclamped ends among them. The
/// poles are those of a plane of 10 mm a pole, moved by up to 4 mm.
pub fn any_surface() -> impl Strategy<Value = NurbsSurface> {
    let line = || {
        (1usize..=5, any::<bool>(), 0usize..4, any::<bool>(), proptest::collection::vec(0.3f64..1.0, 24))
            .prop_map(|(p, high, extra, clamped, steps)| {
                let p = if high { p + 4 } else { p };
                let n = p + 1 + extra;
                let mut t = 0.0;
                let knots: Vec<f64> = (0..=n + p)
                    .map(|i| {
                        let fixed = clamped && (i <= p || i > n);
                        let double = p > 2 && i == p + 2 && i < n;
                        if i > 0 && !fixed && !double {
                            t += steps[i % steps.len()];
                        }
                        t
                    })
                    .collect();
                (p, n, knots)
            })
    };
    (line(), line(), any::<bool>(), proptest::collection::vec(-1.0f64..1.0, 4 * 169)).prop_map(
        |((p, n, ku), (q, m, kv), rational, x)| {
            let points = (0..n * m)
                .map(|k| {
                    let move_by = Vec3::new(x[4 * k], x[4 * k + 1], x[4 * k + 2]) * 4.0;
                    Point3::new((k / m) as f64 * 10.0, (k % m) as f64 * 10.0, 0.0) + move_by
                })
                .collect();
            let weights = rational.then(|| (0..n * m).map(|k| 2.0f64.powf(x[4 * k + 3])).collect());
            NurbsSurface::new([p, q], [ku, kv], Net { count: [n, m], points, weights }).unwrap()
        },
    )
}

/// The Bezier patch of the given degree over the square of half side `half` about the origin whose height over
/// u = x, v = y is `f`, a polynomial of at most that degree in each.
pub fn bezier_graph(half: f64, degree: usize, f: impl Fn(f64, f64) -> f64) -> NurbsSurface {
    let n = degree + 1;
    let node = |k: usize| k as f64 / degree as f64;
    let binomial = |k: usize| (0..k).fold(1.0, |b, i| b * (degree - i) as f64 / (i + 1) as f64);
    let bernstein = |k: usize, t: f64| binomial(k) * t.powi(k as i32) * (1.0 - t).powi((degree - k) as i32);
    let matrix = nalgebra::DMatrix::from_fn(n, n, |i, k| bernstein(k, node(i)));
    let at = |k: usize| half * (2.0 * node(k) - 1.0);
    let values = nalgebra::DMatrix::from_fn(n, n, |i, j| f(at(i), at(j)));
    let lu = matrix.lu();
    let rows = lu.solve(&values).unwrap();
    let heights = lu.solve(&rows.transpose()).unwrap().transpose();
    let points = (0..n * n).map(|k| Point3::new(at(k / n), at(k % n), heights[(k / n, k % n)])).collect();
    let knots = [vec![-half; n], vec![half; n]].concat();
    NurbsSurface::new([degree; 2], [knots.clone(), knots], Net { count: [n, n], points, weights: None })
        .unwrap()
}

/// A bicubic [`bezier_graph`].
pub fn graph(half: f64, f: impl Fn(f64, f64) -> f64) -> NurbsSurface {
    bezier_graph(half, 3, f)
}
