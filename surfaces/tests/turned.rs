//! Faces turned over at random, and the sides that are found for them.
#![allow(dead_code)]

use osculate_geom::Side;
use osculate_surfaces::Face;
use osculate_surfaces::sides::{Before, Settled, Sides, settle};

/// Faces of which some are turned over, as a seed has it, and which.
pub fn turned(faces: &[Face], seed: u64) -> (Vec<Face>, Vec<Side>) {
    let mut state = seed;
    let each = |f: &Face| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if state >> 63 == 1 { (f.clone().flipped(), Side::Against) } else { (f.clone(), Side::Along) }
    };
    faces.iter().map(each).unzip()
}

pub fn found(faces: &[Face], known: &[Option<Side>]) -> Sides {
    of_solids(faces, known, &[])
}

pub fn of_solids(faces: &[Face], sides: &[Option<Side>], solids: &[Option<usize>]) -> Sides {
    settle(&faces.iter().collect::<Vec<_>>(), &Before { sides, solids, uncertainty_mm: None })
}

/// Asserts that the faces of one closed body have the sides that they say, whatever sides they are given with.
pub fn assert_come_back(what: &str, faces: &[Face]) {
    assert!(faces.iter().all(|f| f.oriented));
    for seed in 1..4 {
        let (given, truth) = turned(faces, seed);
        let sides = found(&given, &vec![None; given.len()]);
        let truth: Vec<Option<Side>> = truth.into_iter().map(Some).collect();
        assert_eq!(sides.of, truth, "{what}, seed {seed}");
        assert_eq!(sides.groups.len(), 1, "{what}");
        assert!(sides.groups[0].certainty > 0.9 && sides.conflicts.is_empty(), "{what}: {:?}", sides.groups);
        assert_eq!(sides.groups[0].settled, Settled::Enclosed, "{what}");
    }
}
