//! IGES written from faces and read again: the same splines, areas and sides, bodies that stay closed.

use crate::part21;
use crate::solids;

use osculate_geom::{Surface, uv};
use osculate_surfaces::iges::{self, IgesOptions, IgesWriteError};
use osculate_surfaces::{Face, MeshOptions, Part, mesh_faces};
use part21::{circle, file, flat_patch, only_face};

fn again(faces: &[Face]) -> Part {
    let text = iges::write(faces, &IgesOptions::default()).unwrap();
    assert!(text.lines().all(|l| l.len() == 80), "cards have 80 columns");
    let part = iges::read(text.as_bytes()).unwrap();
    assert!(part.diagnostics.is_empty(), "{:?}", part.diagnostics);
    // Names are properties, which make no face.
    assert!(part.not_used.iter().all(|n| n.kind.starts_with("406")), "{:?}", part.not_used);
    assert_eq!(part.faces.len(), faces.len());
    part
}

#[test]
fn bodies_come_back_closed_with_the_same_areas() {
    for (what, faces) in
        [("cylinder", solids::cylinder()), ("block", solids::block_with_bore()), ("cone", solids::cone())]
    {
        let part = again(&faces);
        for (a, b) in faces.iter().zip(&part.faces) {
            let (p, q) = (a.area_mm2(), b.area_mm2());
            // Loops of both follow the edges to 2e-6 of the face's size, with corners in other places.
            assert!((p - q).abs() <= 1e-5 * p, "{what} {}: {p} {q}", a.id);
            assert!(b.oriented, "{what} {}", a.id);
            let (_, at) = a.surface.samples(3)[0];
            let normal = |f: &Face| {
                let samples = f.surface.samples(9);
                let near = samples.iter().min_by(|x, y| (x.1 - at).norm().total_cmp(&(y.1 - at).norm()));
                f.jet2(near.unwrap().0).normal().unwrap()
            };
            assert!(normal(a).dot(&normal(b)) > 0.5, "{what} {}", a.id);
        }
        let mesh = mesh_faces(&part.faces, &MeshOptions::chord(0.01)).unwrap();
        assert!(mesh.report.watertight(), "{what}: {:?}", mesh.report);
        assert!(mesh.volume_mm3() > 0.0);
        // A second time: nothing moves any more.
        let text = |faces: &[Face]| iges::write(faces, &IgesOptions::default()).unwrap();
        let twice = again(&part.faces);
        assert_eq!(text(&again(&twice.faces).faces), text(&twice.faces), "{what}");
    }
}

#[test]
fn whole_closed_surfaces_stand_by_themselves() {
    for (what, faces) in [("sphere", solids::sphere()), ("torus", solids::torus())] {
        let part = again(&faces);
        let (p, q) = (faces[0].area_mm2(), part.faces[0].area_mm2());
        // Exact rational forms, integrated to 1e-7.
        assert!((p - q).abs() <= 1e-6 * p, "{what}: {p} {q}");
        assert!(part.faces[0].is_rational().unwrap());
    }
}

#[test]
fn a_spline_with_a_hole_keeps_its_net_and_its_name() {
    let hole = circle(300, [5.0, 5.0, 0.0], 2.0, false);
    let (outer, l) = part21::polygon(200, &part21::SQUARE);
    let text = file(&format!(
        "{}{outer}{hole}#400=FACE_BOUND('',#{l},.T.);#401=FACE_BOUND('',#309,.T.);\
         #402=ADVANCED_FACE('a patch',(#400,#401),#120,.T.);",
        flat_patch()
    ));
    let face = only_face(&text);
    let part = again(std::slice::from_ref(&face));
    let [a, b] = [&face, &part.faces[0]].map(|f| f.carrier.nurbs().unwrap());
    assert_eq!(a.net().points, b.net().points);
    assert_eq!(part.faces[0].name, "a patch");
    assert!(!part.faces[0].contains(uv(0.5, 0.5)) && part.faces[0].contains(uv(0.1, 0.5)));
    assert!((face.area_mm2() - part.faces[0].area_mm2()).abs() < 1e-5 * face.area_mm2());
    assert_eq!(iges::write(&[], &IgesOptions::default()), Err(IgesWriteError::NoFaces));
}
