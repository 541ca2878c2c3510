//! The side of the material from the whole part, on a propeller whose file says it.

use crate::turned::{assert_come_back, found, turned};
use osculate_geom::Side;
use osculate_surfaces::Part;
use osculate_surfaces::sides::Settled;
use std::path::Path;

fn propeller() -> Part {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/propeller/propeller.step");
    osculate_surfaces::read(&std::fs::read(path).unwrap()).unwrap()
}

/// The faces of a closed body have the sides that its file says, whatever sides they are given with.
#[test]
fn a_propeller_gets_the_sides_that_its_file_says() {
    assert_come_back("propeller", &propeller().faces);
}

/// A file says which faces bound which solid.
#[test]
fn files_say_which_faces_bound_which_solid() {
    let part = propeller();
    let ids = |p: &Part| p.faces.iter().map(|f| f.id.clone()).collect::<Vec<_>>();
    let solids = part.structure.solids(ids(&part).iter().map(String::as_str));
    assert!(!solids.is_empty() && solids.iter().all(|s| *s == Some(0)), "{solids:?}");
    assert_eq!(part.structure.solids(["F0"]), [None]);
}

/// A known face settles those that hang together with it, even against what rays say: a mould is cut from within. Known faces that
/// do not fit are named, and stay as they are.
#[test]
fn known_faces_settle_the_others() {
    let faces = propeller().faces;
    let (given, truth) = turned(&faces, 5);
    let mut known = vec![None; given.len()];
    known[3] = Some(truth[3].flipped());
    let sides = found(&given, &known);
    let within: Vec<Option<Side>> = truth.iter().map(|s| Some(s.flipped())).collect();
    assert_eq!(sides.of, within);
    assert_eq!(sides.groups[0].settled, Settled::Known);
    assert!(sides.groups[0].certainty < -0.9);
    // A small face against a large one.
    let largest =
        (0..faces.len()).max_by(|a, b| faces[*a].area_mm2().total_cmp(&faces[*b].area_mm2())).unwrap();
    let smallest =
        (0..faces.len()).min_by(|a, b| faces[*a].area_mm2().total_cmp(&faces[*b].area_mm2())).unwrap();
    let mut known = vec![None; given.len()];
    known[largest] = Some(truth[largest]);
    known[smallest] = Some(truth[smallest].flipped());
    let sides = found(&given, &known);
    assert_eq!(sides.groups[0].otherwise, [smallest]);
    for (k, (got, want)) in sides.of.iter().zip(&truth).enumerate() {
        assert_eq!(*got == Some(*want), k != smallest);
    }
}

/// What hangs together with nothing and encloses nothing stays open.
#[test]
fn an_open_sheet_stays_open() {
    let faces = propeller().faces;
    let sides = found(&faces[6..7], &[None]);
    assert_eq!((sides.of, sides.groups[0].settled), (vec![None], Settled::Open));
    assert!(found(&[], &[]).of.is_empty());
}

#[test]
fn threads_do_not_change_the_answer() {
    let (faces, _) = turned(&propeller().faces, 9);
    let known = vec![None; faces.len()];
    let with = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| found(&faces, &known))
    };
    assert_eq!(with(1), with(4));
}
