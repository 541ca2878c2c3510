//! Groups of faces and how their faces meet, on bodies whose answer is known.

use crate::part21;
use crate::solids;

use osculate_geom::Surface;
use osculate_surfaces::Face;
use osculate_surfaces::groups::{Look, groups};
use osculate_surfaces::sides::{Meeting, OpenRim, meetings, open_rims};
use std::f64::consts::{FRAC_PI_2, TAU};

fn all(faces: &[Face]) -> Vec<&Face> {
    faces.iter().collect()
}

/// A block with a bore: four sides and two ends with a hole. Every edge is an outer one, those of the bore too.
#[test]
fn a_block_has_outer_edges_and_its_bore_is_a_hole() {
    let faces = solids::block_with_bore();
    let met = meetings(&all(&faces), None);
    // Twelve edges of the block and two of the bore.
    assert_eq!(met.len(), 14);
    // Normals at chords of the bore's rim are those of its middle: right angles all the same.
    assert!(met.iter().all(|m: &Meeting| !m.smooth && (m.bend_rad - FRAC_PI_2).abs() < 1e-6), "{met:?}");
    let round: Vec<f64> = met.iter().filter(|m| m.faces.contains(&0)).map(|m| m.length_mm).collect();
    assert_eq!(round.len(), 2);
    // Chords of pieces a two-hundredth of the part long are short by (piece / radius)^2 / 24 at most.
    assert!(round.iter().all(|l| (l - 2.0 * TAU).abs() < 1e-3 * TAU), "{round:?}");
    let found = groups(&all(&faces), &met);
    assert_eq!(found.len(), 7);
    let holes: Vec<_> = found.iter().filter(|g| g.look == Look::Hole).collect();
    assert_eq!(holes.len(), 1);
    assert_eq!(holes[0].faces, [0]);
    assert!((holes[0].hollow_mm - 2.0).abs() < 1e-9 && (holes[0].area_mm2 - 10.0 * TAU).abs() < 1e-2);
    // Largest first, opposite sides alike.
    assert!(found.windows(2).all(|w| w[0].area_mm2 >= w[1].area_mm2));
    let flat: Vec<usize> = found.iter().filter(|g| g.look == Look::Flat).map(|g| g.alike).collect();
    assert_eq!(flat, [2; 6]);
}

/// Turned inside out what bends outwards bends inwards, and the bore is a post.
#[test]
fn a_body_inside_out_has_inner_edges() {
    let faces: Vec<Face> = solids::block_with_bore().into_iter().map(Face::flipped).collect();
    let met = meetings(&all(&faces), None);
    assert!(met.len() == 14 && met.iter().all(|m| (m.bend_rad + FRAC_PI_2).abs() < 1e-6));
    let found = groups(&all(&faces), &met);
    assert!(found.iter().any(|g| g.look == Look::Round && g.faces == [0] && g.hollow_mm.is_infinite()));
}

/// Length of polylines on their faces, by the faces' numbers.
fn lengths(faces: &[Face], rims: &[OpenRim]) -> Vec<f64> {
    let mut out = vec![0.0; faces.len()];
    for rim in rims {
        let points: Vec<_> = rim.points.iter().map(|at| faces[rim.face].surface.point(*at)).collect();
        out[rim.face] += points.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
    }
    out
}

/// A closed body has no open rim. Without its lid the tube's upper one is open, without its bottom both are; standing on a disc that goes
/// on under it the lower one is not, and the disc's own is.
#[test]
fn rims_are_open_where_no_face_goes_on_or_stands() {
    for body in [solids::cylinder(), solids::block_with_bore(), solids::sphere(), solids::torus()] {
        assert_eq!(open_rims(&all(&body), None), []);
    }
    let round = 3.0 * TAU;
    let near = |a: f64, b: f64| (a - b).abs() < 1e-3 * round;
    let tube = solids::cylinder();
    for (faces, open) in [(&tube[..1], 2.0), (&tube[..2], 1.0)] {
        let found = lengths(faces, &open_rims(&all(faces), None));
        assert!(near(found[0], open * round) && found[1..].iter().all(|l| *l == 0.0), "{found:?}");
    }
    let rings = [
        part21::circle(300, [0.0; 3], 3.0, true),
        part21::circle(320, [0.0, 0.0, 5.0], 3.0, false),
        part21::circle(340, [0.0; 3], 6.0, true),
    ];
    let stands = solids::faces(&format!(
        "#120=CYLINDRICAL_SURFACE('',#7,3.);{}#203=FACE_BOUND('',#309,.T.);#204=FACE_BOUND('',#329,.T.);\
         #402=ADVANCED_FACE('',(#203,#204),#120,.T.);{}",
        rings.concat(),
        solids::level(500, 0.0, true, &[349])
    ));
    let found = lengths(&stands, &open_rims(&all(&stands), None));
    assert!(near(found[0], round) && near(found[1], 2.0 * round), "{found:?}");
    let upper = open_rims(&all(&stands), None);
    let on_tube = upper.iter().filter(|r| r.face == 0).flat_map(|r| &r.points);
    assert!(on_tube.map(|at| stands[0].surface.point(*at)).all(|p| (p.z - 5.0).abs() < 1e-9));
}
