//! Times of the kernel on the bicubic reference surfaces: `cargo bench -p osculate-surfaces --bench kernel`.
//!
//! Each line is the best of several rounds over the same random places, in nanoseconds for one call; take
//! ratios within one run, not times across machines.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a program that prints its measurements"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use osculate_geom::{Point3, Surface, Uv, uv};
use osculate_surfaces::closest;
use std::hint::black_box;
use std::time::Instant;

const PLACES: usize = 2000;
const ROUNDS: usize = 9;

fn time(what: &str, calls: usize, mut run: impl FnMut()) {
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        run();
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{what:<38} {:>9.1} ns", best / calls as f64 * 1e9);
}

/// Weyl's sequence in two dimensions: even, and no two runs alike in their order of spans.
fn places() -> Vec<Uv> {
    let part = |k: usize, step: f64| (0.5 + k as f64 * step).fract();
    (0..PLACES).map(|k| uv(part(k, 0.754_877_666_246_693), part(k, 0.569_840_290_998_053))).collect()
}

fn main() {
    for (name, s) in [("polynomial", common::reference(false)), ("rational", common::reference(true))] {
        let at = places();
        let mut jets = Vec::with_capacity(PLACES);
        let mut blocks = Vec::new();
        let mut curvatures = Vec::new();
        let piece = |p: &Uv| (p.u * 7.0) as usize * 7 + (p.v * 7.0) as usize;
        let mut ordered = at.clone();
        ordered.sort_by_key(piece);
        time(&format!("{name}: jet blocks, random"), PLACES, || {
            s.jets_into(&at, &mut blocks);
            black_box(&blocks);
        });
        time(&format!("{name}: jet blocks, ordered"), PLACES, || {
            s.jets_into(&ordered, &mut blocks);
            black_box(&blocks);
        });
        time(&format!("{name}: curvature blocks, ordered"), PLACES, || {
            s.curvatures_into(&ordered, &mut curvatures);
            black_box(&curvatures);
        });
        time(&format!("{name}: curvature blocks, random"), PLACES, || {
            s.curvatures_into(&at, &mut curvatures);
            black_box(&curvatures);
        });
        time(&format!("{name}: point"), PLACES, || {
            at.iter().for_each(|p| {
                black_box(s.point(*p));
            });
        });
        time(&format!("{name}: jet"), PLACES, || {
            at.iter().for_each(|p| {
                black_box(s.jet2(*p));
            });
        });
        time(&format!("{name}: jets in a batch"), PLACES, || {
            jets.clear();
            s.jet2_batch(&at, &mut jets);
            black_box(&jets);
        });
        time(&format!("{name}: principal curvatures"), PLACES, || {
            at.iter().for_each(|p| {
                black_box(s.jet2(*p).forms().unwrap().principal());
            });
        });
        let above: Vec<(Point3, Uv)> = at
            .iter()
            .map(|p| {
                let jet = s.jet2(*p);
                (jet.point + jet.normal().unwrap().into_inner() * 3.0, uv(p.u + 0.003, p.v - 0.002))
            })
            .collect();
        // The first query builds the index.
        closest(&s, &above[0].0, None).unwrap();
        time(&format!("{name}: closest, 3 mm above, hint"), PLACES, || {
            above.iter().for_each(|(q, hint)| {
                black_box(closest(&s, q, Some(*hint)).unwrap());
            });
        });
        time(&format!("{name}: closest, 3 mm above, whole"), PLACES, || {
            above.iter().for_each(|(q, _)| {
                black_box(closest(&s, q, None).unwrap());
            });
        });
        let text = if s.is_rational() {
            include_str!("../tests/data/far_rat.txt")
        } else {
            include_str!("../tests/data/far_poly.txt")
        };
        let far: Vec<Point3> = text
            .lines()
            .skip(1)
            .map(|l| {
                let v: Vec<f64> = l.split_whitespace().map(|x| x.parse().unwrap()).collect();
                Point3::new(v[0], v[1], v[2])
            })
            .collect();
        time(&format!("{name}: closest, far, whole"), far.len(), || {
            far.iter().for_each(|q| {
                black_box(closest(&s, q, None).unwrap());
            });
        });
    }
}
