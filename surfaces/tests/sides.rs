//! The side of the material from the whole part, held against files that say it.

use crate::bodies;
use crate::solids;
use crate::turned::{assert_come_back, found, of_solids, turned};

use osculate_geom::{Point3, Side, Vec3};
use osculate_surfaces::{Face, patches};
use proptest::prelude::*;

/// The faces of closed bodies have the sides that their files say, whatever sides they are given with.
#[test]
fn closed_bodies_get_the_sides_that_their_files_say() {
    let bodies = [
        ("cylinder", solids::cylinder()),
        ("block with bore", solids::block_with_bore()),
        ("sphere", solids::sphere()),
        ("torus", solids::torus()),
        ("cone", solids::cone()),
    ];
    for (what, faces) in bodies {
        assert_come_back(what, &faces);
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
