//! Batches: the bits of one place at a time, in any order of the places, on any number of threads.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::{any_surface, reference, sphere};
use osculate_geom::{Surface, Uv, uv};
use proptest::prelude::*;

const LANES: usize = osculate_geom::lanes::LANES;

/// Places in no order and, by turns, in runs of one piece.
fn places(count: usize) -> Vec<Uv> {
    let part = |k: usize, step: f64| (0.5 + k as f64 * step).fract();
    (0..count)
        .map(|k| {
            let slow = k - k % 50;
            let k = if (k / 200) % 2 == 0 { k } else { slow };
            uv(part(k, 0.754_877_666_246_693), part(k, 0.569_840_290_998_053))
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn blocks_have_the_bits_of_single_jets(s in any_surface(), count in 1usize..1500, out in -0.1f64..0.1) {
        let at: Vec<Uv> = places(count).iter().map(|p| s.domain().at(p.u * (1.0 + out), p.v + out)).collect();
        let (mut blocks, mut parallel) = (Vec::new(), Vec::new());
        s.jets_into(&at, &mut blocks);
        s.par_jets_into(&at, &mut parallel);
        prop_assert_eq!(&blocks, &parallel);
        for (k, at) in at.iter().enumerate() {
            prop_assert_eq!(blocks[k / LANES].get(k % LANES), s.jet2(*at));
        }
        // The lanes behind the last place repeat it.
        for lane in (count - 1) % LANES..LANES {
            prop_assert_eq!(blocks[(count - 1) / LANES].get(lane), s.jet2(at[count - 1]));
        }
    }
}

#[test]
fn curvatures_agree_with_single_ones_and_do_not_depend_on_threads() {
    for s in [reference(false), reference(true)] {
        let at = places(5000);
        let (mut blocks, mut parallel) = (Vec::new(), Vec::new());
        s.curvatures_into(&at, &mut blocks);
        let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        for threads in [1, 3] {
            pool(threads).install(|| s.par_curvatures_into(&at, &mut parallel));
            assert_eq!(blocks, parallel);
        }
        for (k, at) in at.iter().enumerate() {
            let one = s.jet2(*at).forms().unwrap().principal();
            let eight = blocks[k / LANES].get(k % LANES).unwrap();
            let size = one.k_max.abs().max(one.k_min.abs());
            // Some twenty roundings each way, over the sine between the parameter lines, here above 0.1.
            assert!((one.k_max - eight.k_max).abs() <= 1e-13 * size, "{at:?}");
            assert!((one.k_min - eight.k_min).abs() <= 1e-13 * size, "{at:?}");
            let turn = 1e-13 * size / (one.k_max - one.k_min);
            assert!(one.d_max.cross(&eight.d_max).norm() <= turn + 1e-14, "{at:?}");
        }
    }
}

#[test]
fn a_pole_is_refused_in_its_lane_only() {
    let s = sphere(20.0);
    let mut blocks = Vec::new();
    s.curvatures_into(&[uv(0.3, 0.0), uv(0.3, 0.7)], &mut blocks);
    assert_eq!(blocks[0].get(0).unwrap_err().at, uv(0.3, 0.0));
    assert!((blocks[0].get(1).unwrap().k_max - 0.05).abs() < 1e-14);
    s.curvatures_into(&[], &mut blocks);
    assert!(blocks.is_empty());
}
