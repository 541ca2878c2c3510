//! STEP written from faces and read again: the same surfaces to the bit, the same areas, bodies that stay closed.

use crate::part21;
use crate::solids;

use osculate_geom::{Point3, Side, Surface, uv};
use osculate_surfaces::step::{self, StepOptions, StepWriteError};
use osculate_surfaces::{Face, FaceSurface, MeshOptions, Part, mesh_faces};
use part21::{circle, file, flat_patch, only_face};

fn again(faces: &[Face]) -> (String, Part) {
    let text = step::write(faces, &StepOptions::default()).unwrap();
    let part = step::read(text.as_bytes()).unwrap();
    assert!(part.diagnostics.is_empty(), "{:?}", part.diagnostics);
    // Nothing of the shape: product data, the point of a loop that is a single vertex, and parameter curves.
    let shapeless = |kind: &str| {
        kind.starts_with("APPLICATION_") || kind.starts_with("PRODUCT_") || kind.ends_with("_POINT")
    };
    let parametric = |why: &str| why.starts_with("a parameter curve");
    assert!(part.not_used.iter().all(|n| shapeless(&n.kind) || parametric(&n.why)), "{:?}", part.not_used);
    (text, part)
}

fn assert_same(a: &Face, b: &Face) {
    assert_eq!((a.kind, &a.name, a.oriented), (b.kind, &b.name, b.oriented));
    match (&a.carrier, &b.carrier) {
        (FaceSurface::Nurbs(s), FaceSurface::Nurbs(t)) => assert_eq!(s.net(), t.net()),
        (FaceSurface::Analytic(s), FaceSurface::Analytic(t)) => {
            assert_eq!(s.shape(), t.shape());
            assert_eq!(s.placement().origin, t.placement().origin);
            // Directions are made units again.
            assert!(s.placement().x.dot(&t.placement().x) > 1.0 - 1e-15);
            assert!(s.placement().z.dot(&t.placement().z) > 1.0 - 1e-15);
        }
        _ => panic!("{} became another kind of surface", a.id),
    }
    let (p, q) = (a.area_mm2(), b.area_mm2());
    // Both come from loops to 2e-6 of the face's size, pulled from the same curves.
    assert!((p - q).abs() <= 1e-9 * p, "{}: {p} {q}", a.id);
    let outward = |f: &Face| {
        let (at, _) = f.surface.samples(3)[0];
        f.jet2(at).normal().unwrap()
    };
    assert!(outward(a).dot(&outward(b)) > 1.0 - 1e-12, "{}", a.id);
}

#[test]
fn bodies_come_back_the_same_and_closed() {
    for (what, faces) in [
        ("cylinder", solids::cylinder()),
        ("block", solids::block_with_bore()),
        ("sphere", solids::sphere()),
        ("torus", solids::torus()),
        ("cone", solids::cone()),
    ] {
        let (text, part) = again(&faces);
        assert_eq!(part.faces.len(), faces.len(), "{what}");
        for (a, b) in faces.iter().zip(&part.faces) {
            assert_same(a, b);
        }
        let closed_by_edges = !["sphere", "torus"].contains(&what);
        if closed_by_edges {
            assert!(text.contains("MANIFOLD_SOLID_BREP") && text.contains("ADVANCED_BREP_SHAPE"), "{what}");
        }
        let mesh = mesh_faces(&part.faces, &MeshOptions::chord(0.01)).unwrap();
        assert!(mesh.report.watertight(), "{what}: {:?}", mesh.report);
        // Written again: the same bytes, so that nothing drifts.
        let (second, part) = again(&part.faces);
        assert_eq!(second, again(&part.faces).0, "{what}");
    }
}

#[test]
fn splines_with_holes_come_back() {
    let hole = circle(300, [5.0, 5.0, 0.0], 2.0, false);
    let (outer, l) = part21::polygon(200, &part21::SQUARE);
    let text = file(&format!(
        "{}{outer}{hole}#400=FACE_BOUND('',#{l},.T.);#401=FACE_BOUND('',#309,.T.);\
         #402=ADVANCED_FACE('a ''patch''',(#400,#401),#120,.T.);",
        flat_patch()
    ));
    let face = only_face(&text);
    let (text, part) = again(std::slice::from_ref(&face));
    assert!(text.contains("MANIFOLD_SURFACE_SHAPE_REPRESENTATION") && text.contains("OPEN_SHELL"));
    assert_eq!(part.faces[0].name, "a 'patch'");
    assert_same(&face, &part.faces[0]);
    assert!(!part.faces[0].contains(uv(0.5, 0.5)) && part.faces[0].contains(uv(0.1, 0.5)));
    // The other side out.
    let turned = face.flipped();
    let (_, part) = again(std::slice::from_ref(&turned));
    assert_eq!(part.faces[0].surface.side(), Side::Against);
    assert_same(&turned, &part.faces[0]);
}

#[test]
fn rational_nets_keep_their_weights() {
    // A quarter of a cylinder of radius 1 as a rational patch.
    let w = 0.5f64.sqrt();
    let data = format!(
        "#101=CARTESIAN_POINT('',(1.,0.,0.));#102=CARTESIAN_POINT('',(1.,1.,0.));#103=CARTESIAN_POINT('',(0.,1.,0.));\
         #104=CARTESIAN_POINT('',(1.,0.,2.));#105=CARTESIAN_POINT('',(1.,1.,2.));#106=CARTESIAN_POINT('',(0.,1.,2.));\
         #120=(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,((#101,#104),(#102,#105),(#103,#106)),.UNSPECIFIED.,.F.,.F.,.F.)\
         B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()\
         RATIONAL_B_SPLINE_SURFACE(((1.,1.),({w:?},{w:?}),(1.,1.)))REPRESENTATION_ITEM('')SURFACE());\
         #400=CARTESIAN_POINT('',(1.,0.,0.));#401=VERTEX_POINT('',#400);#402=VERTEX_LOOP('',#401);\
         #403=FACE_BOUND('',#402,.T.);#404=ADVANCED_FACE('',(#403),#120,.T.);"
    );
    let face = only_face(&file(&data));
    let (text, part) = again(std::slice::from_ref(&face));
    assert!(text.contains("RATIONAL_B_SPLINE_SURFACE") && text.contains("RATIONAL_B_SPLINE_CURVE"));
    assert_same(&face, &part.faces[0]);
    let p = part.faces[0].point(uv(0.5, 0.5));
    assert!((p - Point3::new(w, w, 1.0)).norm() < 1e-15);
}

#[test]
fn nothing_is_an_error() {
    assert_eq!(step::write(&[], &StepOptions::default()), Err(StepWriteError::NoFaces));
}
