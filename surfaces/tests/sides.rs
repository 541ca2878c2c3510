//! The side of the material from the whole part, held against files that say it.

use crate::bodies;
use crate::solids;

use osculate_geom::{Point3, Side, Vec3};
use osculate_surfaces::sides::{Before, Settled, Sides, settle};
use osculate_surfaces::{Face, Part, patches};
use proptest::prelude::*;
use std::path::Path;

/// Faces of which some are turned over, as a seed has it, and which.
fn turned(faces: &[Face], seed: u64) -> (Vec<Face>, Vec<Side>) {
    let mut state = seed;
    let each = |f: &Face| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if state >> 63 == 1 { (f.clone().flipped(), Side::Against) } else { (f.clone(), Side::Along) }
    };
    faces.iter().map(each).unzip()
}

fn found(faces: &[Face], known: &[Option<Side>]) -> Sides {
    of_solids(faces, known, &[])
}

fn of_solids(faces: &[Face], sides: &[Option<Side>], solids: &[Option<usize>]) -> Sides {
    settle(&faces.iter().collect::<Vec<_>>(), &Before { sides, solids, uncertainty_mm: None })
}

fn example(path: &str) -> Part {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    osculate_surfaces::read(&std::fs::read(root.join(path)).unwrap()).unwrap()
}

/// The faces of closed bodies have the sides that their files say, whatever sides they are given with.
#[test]
fn closed_bodies_get_the_sides_that_their_files_say() {
    let bodies = [
        ("cylinder", solids::cylinder()),
        ("block with bore", solids::block_with_bore()),
        ("sphere", solids::sphere()),
        ("torus", solids::torus()),
        ("cone", solids::cone()),
        ("propeller", example("propeller/propeller.step").faces),
    ];
    for (what, faces) in bodies {
        assert!(faces.iter().all(|f| f.oriented));
        for seed in 1..4 {
            let (given, truth) = turned(&faces, seed);
            let sides = found(&given, &vec![None; given.len()]);
            let truth: Vec<Option<Side>> = truth.into_iter().map(Some).collect();
            assert_eq!(sides.of, truth, "{what}, seed {seed}");
            assert_eq!(sides.groups.len(), 1, "{what}");
            assert!(
                sides.groups[0].certainty > 0.9 && sides.conflicts.is_empty(),
                "{what}: {:?}",
                sides.groups
            );
            assert_eq!(sides.groups[0].settled, Settled::Enclosed, "{what}");
        }
    }
}

/// Bodies that lie in each other, touch or overlap: each by its own shell, the walls of a void by the outer shell of the same solid. Without the
/// word of the file on what is a solid, what lies within is taken for a hollow.
#[test]
fn solids_within_others_get_their_sides_from_their_own_faces() {
    let at = |x: f64, y: f64, z: f64| bodies::frame([x, y, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let cube = || bodies::block(&at(0.0, 0.0, 0.0), [10.0; 3]);
    let inner = || bodies::ball(&at(5.0, 5.0, 5.0), 2.0);
    let hollow = || inner().into_iter().map(Face::flipped).collect::<Vec<_>>();
    let cases: [(&str, Vec<Vec<Face>>); 6] = [
        ("a ball in a box", vec![cube(), inner()]),
        ("a box around a ball", vec![inner(), cube()]),
        ("a box with a void", vec![[cube(), hollow()].concat()]),
        ("a box with a void and a ball that fills it", vec![[cube(), hollow()].concat(), inner()]),
        ("boxes that overlap", vec![cube(), bodies::block(&at(6.0, 3.0, 4.0), [8.0, 9.0, 7.0])]),
        ("boxes that touch", vec![cube(), bodies::block(&at(10.0, 0.0, 0.0), [4.0, 10.0, 10.0])]),
    ];
    for (what, parts) in cases {
        let solids: Vec<Option<usize>> =
            parts.iter().enumerate().flat_map(|(k, faces)| vec![Some(k); faces.len()]).collect();
        let faces: Vec<Face> = parts.concat();
        for seed in 1..4 {
            let (given, truth) = turned(&faces, seed);
            let sides = of_solids(&given, &[], &solids);
            assert_eq!(sides.of, truth.iter().copied().map(Some).collect::<Vec<_>>(), "{what}, seed {seed}");
            assert!(sides.conflicts.is_empty() && sides.groups.iter().all(|g| g.certainty > 0.9), "{what}");
            assert!(sides.groups.is_sorted_by_key(|g| g.faces[0]), "{what}");
        }
    }
    // One part by the word of nobody: the ball is a hollow.
    let faces = [cube(), inner()].concat();
    let sides = found(&faces, &[]);
    assert_eq!(sides.of[..6], [Some(Side::Along); 6]);
    assert_eq!(sides.of[6], Some(Side::Against));
}

/// A file says which faces bound which solid.
#[test]
fn files_say_which_faces_bound_which_solid() {
    let part = example("propeller/propeller.step");
    let ids = |p: &Part| p.faces.iter().map(|f| f.id.clone()).collect::<Vec<_>>();
    let solids = part.structure.solids(ids(&part).iter().map(String::as_str));
    assert!(!solids.is_empty() && solids.iter().all(|s| *s == Some(0)), "{solids:?}");
    assert_eq!(part.structure.solids(["F0"]), [None]);
}

/// A known face settles those that hang together with it, even against what rays say: a mould is cut from within. Known faces that
/// do not fit are named, and stay as they are.
#[test]
fn known_faces_settle_the_others() {
    let faces = example("propeller/propeller.step").faces;
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
    let faces = example("propeller/propeller.step").faces;
    let sides = found(&faces[6..7], &[None]);
    assert_eq!((sides.of, sides.groups[0].settled), (vec![None], Settled::Open));
    assert!(found(&[], &[]).of.is_empty());
}

#[test]
fn threads_do_not_change_the_answer() {
    let (faces, _) = turned(&example("propeller/propeller.step").faces, 9);
    let known = vec![None; faces.len()];
    let with = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| found(&faces, &known))
    };
    assert_eq!(with(1), with(4));
}

/// Four corners of a bilinear patch, the first two along one side.
type Corners = [Point3; 4];

/// Two patches as text, and their faces.
fn two(a: Corners, b: Corners) -> Vec<Face> {
    let mut text = "2\n".to_owned();
    for patch in [a, b] {
        text += "1 1\n";
        for p in patch {
            text += &format!("{} {} {}\n", p.x, p.y, p.z);
        }
    }
    patches::read(text.as_bytes()).unwrap().faces
}

/// The rectangle from a hinge of length 4 along y, `d` wide, with its parameters in one of eight ways.
fn leaf(d: Vec3, way: usize) -> Corners {
    let (o, h) = (Point3::new(1.0, 2.0, 3.0), Vec3::y() * 4.0);
    let grid = [[o, o + h], [o + d, o + d + h]];
    let at = |i: usize, j: usize| {
        let (i, j) = if way & 4 != 0 { (j, i) } else { (i, j) };
        grid[i ^ (way & 1)][j ^ (way >> 1 & 1)]
    };
    [at(0, 0), at(0, 1), at(1, 0), at(1, 1)]
}

/// The normal of a face in its middle.
fn normal(face: &Face) -> Vec3 {
    use osculate_geom::Surface;
    face.surface.jet2(face.surface.domain().at(0.5, 0.5)).normal().unwrap().into_inner()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Two planes at any angle between them: the side of one settles the other, so that the material fills the angle or all but
    /// the angle.
    #[test]
    fn two_planes_at_any_angle_fit(degrees in 8.0..352.0_f64, ways in (0..8_usize, 0..8_usize), width in 0.5..6.0_f64) {
        let (s, c) = degrees.to_radians().sin_cos();
        // The second leaf is the first one turned about the hinge, from x towards -z.
        let second = Vec3::new(c, 0.0, -s) * width;
        let faces = two(leaf(Vec3::x() * 3.0, ways.0), leaf(second, ways.1));
        for said in [Side::Along, Side::Against] {
            let sides = found(&faces, &[Some(said), None]);
            let outward = |k: usize| normal(&faces[k]) * sides.of[k].unwrap().sign();
            // The first leaf's normal turned about the hinge with the leaf points into the wedge, where it pointed out.
            let n = outward(0);
            let turned = Vec3::new(-s * n.z, 0.0, -c * n.z);
            prop_assert!((outward(1) - turned).norm() < 1e-9, "{degrees} {n} {turned} {}", outward(1));
        }
    }

    /// Leaves that lie on each other are not joined: they may be two walls of one body, or one wall twice.
    #[test]
    fn folded_planes_are_not_joined(degrees in -4.0..4.0_f64, ways in (0..8_usize, 0..8_usize)) {
        let (s, c) = degrees.to_radians().sin_cos();
        let faces = two(leaf(Vec3::x() * 3.0, ways.0), leaf(Vec3::new(c, 0.0, -s) * 2.0, ways.1));
        prop_assert_eq!(found(&faces, &[None, None]).groups.len(), 2);
    }
}
