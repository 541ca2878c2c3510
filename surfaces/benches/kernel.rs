//! Times of the kernel on the bicubic reference surfaces: `cargo bench -p osculate-surfaces --bench kernel`.
//!
//! Each line is the best of several rounds over the same places, in nanoseconds for one call: `surface, tab,
//! what, tab, time`. Take ratios within one run, not times across machines; `cargo xtask bench --peers` puts
//! other kernels beside them.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a program that prints its measurements"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use osculate_geom::{Point3, Surface, Uv, uv};
use osculate_surfaces::{NurbsSurface, closest};
use std::hint::black_box;
use std::time::Instant;

const PLACES: usize = 2000;
const ROUNDS: usize = 9;

struct Bench {
    name: &'static str,
}

impl Bench {
    fn time(&self, what: &str, calls: usize, mut run: impl FnMut()) {
        let mut best = f64::INFINITY;
        for _ in 0..ROUNDS {
            let start = Instant::now();
            run();
            best = best.min(start.elapsed().as_secs_f64());
        }
        println!("{}\t{what}\t{:.2}", self.name, best / calls as f64 * 1e9);
    }
}

/// Weyl's sequence in two dimensions: even, and no two runs alike in their order of spans.
fn places(count: usize) -> Vec<Uv> {
    let part = |k: usize, step: f64| (0.5 + k as f64 * step).fract();
    (0..count).map(|k| uv(part(k, 0.754_877_666_246_693), part(k, 0.569_840_290_998_053))).collect()
}

fn evaluation(bench: &Bench, s: &NurbsSurface) {
    let at = places(PLACES);
    let piece = |p: &Uv| (p.u * 7.0) as usize * 7 + (p.v * 7.0) as usize;
    let mut ordered = at.clone();
    ordered.sort_by_key(piece);
    let (mut blocks, mut curvatures) = (Vec::new(), Vec::new());
    bench.time("point", PLACES, || {
        at.iter().for_each(|p| {
            black_box(s.point(*p));
        });
    });
    bench.time("jet", PLACES, || {
        at.iter().for_each(|p| {
            black_box(s.jet2(*p));
        });
    });
    for (order, at) in [("random", &at), ("ordered", &ordered)] {
        bench.time(&format!("jets in blocks, {order}"), PLACES, || {
            s.jets_into(at, &mut blocks);
            black_box(&blocks);
        });
        bench.time(&format!("curvatures in blocks, {order}"), PLACES, || {
            s.curvatures_into(at, &mut curvatures);
            black_box(&curvatures);
        });
    }
    bench.time("principal curvatures", PLACES, || {
        at.iter().for_each(|p| {
            black_box(s.jet2(*p).forms().unwrap().principal());
        });
    });
    // Row by row, as a face is sampled.
    let grid: Vec<Uv> =
        (0..1_000_000).map(|k| uv(f64::from(k / 1000) / 999.0, f64::from(k % 1000) / 999.0)).collect();
    bench.time("a million curvatures of a grid, all threads", 1, || {
        s.par_curvatures_into(&grid, &mut curvatures);
        black_box(&curvatures);
    });
    let million = places(1_000_000);
    bench.time("a million curvatures, all threads", 1, || {
        s.par_curvatures_into(&million, &mut curvatures);
        black_box(&curvatures);
    });
}

fn nearest(bench: &Bench, s: &NurbsSurface, far: &str) {
    let above: Vec<(Point3, Uv)> = places(PLACES)
        .iter()
        .map(|p| {
            let jet = s.jet2(*p);
            (jet.point + jet.normal().unwrap().into_inner() * 3.0, uv(p.u + 0.003, p.v - 0.002))
        })
        .collect();
    // The first query builds the index.
    closest(s, &above[0].0, None).unwrap();
    bench.time("closest, 3 mm above, hint", PLACES, || {
        above.iter().for_each(|(q, hint)| {
            black_box(closest(s, q, Some(*hint)).unwrap());
        });
    });
    bench.time("closest, 3 mm above, whole", PLACES, || {
        above.iter().for_each(|(q, _)| {
            black_box(closest(s, q, None).unwrap());
        });
    });
    let far: Vec<(Point3, f64)> = far
        .lines()
        .skip(1)
        .map(|l| {
            let v: Vec<f64> = l.split_whitespace().map(|x| x.parse().unwrap()).collect();
            (Point3::new(v[0], v[1], v[2]), v[3])
        })
        .collect();
    bench.time("closest, far, whole", far.len(), || {
        far.iter().for_each(|(q, _)| {
            black_box(closest(s, q, None).unwrap());
        });
    });
    let right = |q: &Point3, d: f64| closest(s, q, None).unwrap().distance_mm <= d * (1.0 + 1e-6);
    let wrong = far.iter().filter(|(q, d)| !right(q, *d)).count();
    println!("{}\twrong of {} far\t{wrong}", bench.name, far.len());
}

fn main() {
    let bench = Bench { name: "polynomial" };
    evaluation(&bench, &common::reference(false));
    nearest(&bench, &common::reference(false), include_str!("../tests/data/far_poly.txt"));
    let bench = Bench { name: "rational" };
    evaluation(&bench, &common::reference(true));
    nearest(&bench, &common::reference(true), include_str!("../tests/data/far_rat.txt"));
}
