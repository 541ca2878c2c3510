//! STEP import against closed forms: every file is written here, face by face.

use crate::part21;

use osculate_geom::{Axis, Side, Surface, uv};
use osculate_surfaces::step::{self, StepError};
use osculate_surfaces::{FaceKind, Format, ImportError, Part, detect, read};
use part21::{SQUARE, assert_area, circle, file, flat_patch, only_face, polygon};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn a_patch_with_a_circular_hole() {
    let (outer, l) = polygon(200, &SQUARE);
    let hole = circle(300, [5.0, 5.0, 0.0], 2.0, false);
    let face = only_face(&file(&format!(
        "{}{outer}{hole}#400=FACE_OUTER_BOUND('',#{l},.T.);#401=FACE_BOUND('',#309,.T.);\
         #402=ADVANCED_FACE('the patch',(#400,#401),#120,.T.);",
        flat_patch()
    )));
    assert_eq!((face.id.as_str(), face.name.as_str(), face.entity), ("F1", "the patch", 402));
    assert_eq!((face.kind, face.oriented, face.trimmed()), (FaceKind::Bspline, true, true));
    assert_eq!(
        (face.degree(), face.pole_count(), face.is_rational()),
        (Some([3, 3]), Some([4, 4]), Some(false))
    );
    assert_area(&face, 100.0 - 4.0 * PI);
    assert_eq!(face.surface.loops().len(), 2);
    // The hole has radius 0.2 in both parameters; loops are within 2e-6 of 14 mm of it.
    for k in 0..60 {
        let t = TAU * f64::from(k) / 60.0;
        let at = |r: f64| uv(0.5 + r * t.cos(), 0.5 + r * t.sin());
        assert!(face.contains(at(0.2001)) && !face.contains(at(0.1999)), "{k}");
    }
    let spans = face.surface.spans(Axis::U, 0.5);
    assert_eq!(spans.len(), 2);
    for (got, want) in spans.iter().zip([[0.0, 0.3], [0.7, 1.0]]) {
        assert!((got.lo - want[0]).abs() < 3e-6 && (got.hi - want[1]).abs() < 3e-6, "{spans:?}");
    }
    assert_eq!(face.surface.spans(Axis::V, 0.1).len(), 1);
    // The domain's corners and sides belong to the face.
    for at in [uv(0.0, 0.0), uv(1.0, 1.0), uv(0.0, 1.0), uv(1.0, 0.4)] {
        assert!(face.contains(at), "{at:?}");
    }
    let b = face.bbox();
    assert!((b.min.x.abs() + b.min.y.abs()) < 1e-9 && (b.max.x - 10.0).abs() < 1e-9);
}

#[test]
fn the_natural_boundary_is_no_trim() {
    let (outer, l) = polygon(200, &SQUARE);
    let text = format!(
        "{}{outer}#400=FACE_BOUND('',#{l},.T.);#402=ADVANCED_FACE('',(#400),#120,.T.);",
        flat_patch()
    );
    let face = only_face(&file(&text));
    assert!(!face.trimmed());
    assert!((face.area_mm2() - 100.0).abs() < 1e-10);
    assert_eq!(face.jet2(uv(0.5, 0.5)).normal().unwrap().z, 1.0);
    assert_eq!(face.surface.side(), Side::Along);
    // Turned over: the same boundary seen from the other side runs the other way.
    let turned = only_face(&file(&text.replace("#120,.T.", "#120,.F.").replace(",.T.);#402", ",.F.);#402")));
    assert!(!turned.trimmed());
    assert_eq!(turned.jet2(uv(0.5, 0.5)).normal().unwrap().z, -1.0);
}

#[test]
fn a_polygon_with_a_slit_and_a_triangle() {
    // A triangle cut from the plane; the plane's x axis is the world's.
    let (outer, l) = polygon(200, &[[1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [1.0, 4.0, 0.0]]);
    let face = only_face(&file(&format!(
        "#120=PLANE('',#7);{outer}#400=FACE_BOUND('',#{l},.T.);#402=FACE_SURFACE('',(#400),#120,.T.);"
    )));
    assert_eq!((face.kind, face.trimmed()), (FaceKind::Plane, true));
    assert!((face.area_mm2() - 6.0).abs() < 1e-9);
    let d = face.domain();
    assert!((d.u.lo - 1.0).abs() < 1e-9 && (d.v.hi - 4.0).abs() < 1e-9);
    // Hypotenuse: 3 (x - 1) + 4 (y - 1) = 12.
    assert!(face.contains(uv(2.9, 2.5)) && !face.contains(uv(3.1, 2.5)));
}

/// A cylinder's wall of radius 3 from z = 0 to 5 with its seam at angle 0.
fn wall() -> String {
    format!(
        "#120=CYLINDRICAL_SURFACE('',#7,3.);{}{}#360=DIRECTION('',(0.,0.,1.));#361=VECTOR('',#360,1.);\
         #362=LINE('',#303,#361);#363=EDGE_CURVE('',#304,#324,#362,.T.);\
         #364=ORIENTED_EDGE('',*,*,#363,.T.);#365=ORIENTED_EDGE('',*,*,#363,.F.);\
         #366=EDGE_LOOP('',(#306,#364,#326,#365));#367=FACE_BOUND('',#366,.T.);",
        circle(300, [0.0; 3], 3.0, true),
        circle(320, [0.0, 0.0, 5.0], 3.0, false)
    )
}

#[test]
fn a_cylinder_with_a_seam() {
    let face = only_face(&file(&format!("{}#402=ADVANCED_FACE('',(#367),#120,.T.);", wall())));
    assert_eq!((face.kind, face.trimmed()), (FaceKind::Cylinder, false));
    assert!(face.domain().u.periodic);
    assert!((face.area_mm2() - 30.0 * PI).abs() < 1e-9 * 30.0 * PI);
    let jet = face.jet2(uv(0.7, 2.0));
    let n = jet.normal().unwrap();
    assert!(
        (n.x - 0.7f64.cos()).abs() < 1e-12
            && (jet.forms().unwrap().principal().k_max - 1.0 / 3.0).abs() < 1e-12
    );
    let k = face.curvature_range(9).unwrap();
    assert!((k.k_max_per_mm - 1.0 / 3.0).abs() < 1e-12 && k.k_min_per_mm.abs() < 1e-12);
    // The bore: material outside.
    let bore = only_face(&file(&format!("{}#402=ADVANCED_FACE('',(#367),#120,.F.);", wall())));
    assert!((bore.jet2(uv(0.7, 2.0)).normal().unwrap().x + 0.7f64.cos()).abs() < 1e-12);
    assert!((bore.jet2(uv(0.7, 2.0)).forms().unwrap().principal().k_min + 1.0 / 3.0).abs() < 1e-12);
}

#[test]
fn half_a_cylinder_is_cut_to_its_rectangle() {
    // The half with y < 0, across the seam at angle 0 of nothing: from pi to 2 pi.
    let data = "#120=CYLINDRICAL_SURFACE('',#7,3.);\
        #300=CARTESIAN_POINT('',(3.,0.,0.));#301=VERTEX_POINT('',#300);\
        #302=CARTESIAN_POINT('',(-3.,0.,0.));#303=VERTEX_POINT('',#302);\
        #304=CARTESIAN_POINT('',(3.,0.,5.));#305=VERTEX_POINT('',#304);\
        #306=CARTESIAN_POINT('',(-3.,0.,5.));#307=VERTEX_POINT('',#306);\
        #310=CARTESIAN_POINT('',(0.,0.,5.));#311=AXIS2_PLACEMENT_3D('',#310,#4,#5);\
        #312=CIRCLE('',#7,3.);#313=CIRCLE('',#311,3.);\
        #314=DIRECTION('',(0.,0.,1.));#315=VECTOR('',#314,1.);#316=LINE('',#300,#315);#317=LINE('',#302,#315);\
        #320=EDGE_CURVE('',#303,#301,#312,.T.);#321=EDGE_CURVE('',#301,#305,#316,.T.);\
        #322=EDGE_CURVE('',#307,#305,#313,.T.);#323=EDGE_CURVE('',#303,#307,#317,.T.);\
        #330=ORIENTED_EDGE('',*,*,#320,.T.);#331=ORIENTED_EDGE('',*,*,#321,.T.);\
        #332=ORIENTED_EDGE('',*,*,#322,.F.);#333=ORIENTED_EDGE('',*,*,#323,.F.);\
        #340=EDGE_LOOP('',(#330,#331,#332,#333));#341=FACE_BOUND('',#340,.T.);\
        #402=ADVANCED_FACE('',(#341),#120,.T.);";
    let face = only_face(&file(data));
    assert!(!face.trimmed() && !face.domain().u.periodic);
    assert!((face.domain().u.length() - PI).abs() < 1e-12 && (face.area_mm2() - 15.0 * PI).abs() < 1e-9);
    let middle = face.point(face.domain().at(0.5, 0.5));
    assert!((middle.y + 3.0).abs() < 1e-12, "{middle:?}");
}

#[test]
fn rational_complex_records() {
    // A quarter of a cylinder of radius 2 and height 3 as a rational spline.
    let data = "#101=CARTESIAN_POINT('',(2.,0.,0.));#102=CARTESIAN_POINT('',(2.,0.,3.));\
        #103=CARTESIAN_POINT('',(2.,2.,0.));#104=CARTESIAN_POINT('',(2.,2.,3.));\
        #105=CARTESIAN_POINT('',(0.,2.,0.));#106=CARTESIAN_POINT('',(0.,2.,3.));\
        #120=(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,((#101,#102),(#103,#104),(#105,#106)),.UNSPECIFIED.,.F.,.F.,\
        .F.)B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,3.),.UNSPECIFIED.)\
        GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(((1.,1.),(0.70710678118654752,\
        0.70710678118654752),(1.,1.)))REPRESENTATION_ITEM('')SURFACE());\
        #201=VERTEX_POINT('',#101);#202=VERTEX_POINT('',#105);#203=VERTEX_POINT('',#106);#204=VERTEX_POINT('',#102);\
        #210=(BOUNDED_CURVE()B_SPLINE_CURVE(2,(#101,#103,#105),.UNSPECIFIED.,.F.,.F.)\
        B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.),.UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()\
        RATIONAL_B_SPLINE_CURVE((1.,0.70710678118654752,1.))REPRESENTATION_ITEM(''));\
        #211=B_SPLINE_CURVE_WITH_KNOTS('',1,(#105,#106),.UNSPECIFIED.,.F.,.F.,(2,2),(0.,1.),.UNSPECIFIED.);\
        #212=(BOUNDED_CURVE()B_SPLINE_CURVE(2,(#102,#104,#106),.UNSPECIFIED.,.F.,.F.)BEZIER_CURVE()CURVE()\
        GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE((1.,0.70710678118654752,1.))\
        REPRESENTATION_ITEM(''));\
        #213=QUASI_UNIFORM_CURVE('',1,(#101,#102),.UNSPECIFIED.,.F.,.F.);\
        #220=EDGE_CURVE('',#201,#202,#210,.T.);#221=EDGE_CURVE('',#202,#203,#211,.T.);\
        #222=EDGE_CURVE('',#204,#203,#212,.T.);#223=EDGE_CURVE('',#201,#204,#213,.T.);\
        #230=ORIENTED_EDGE('',*,*,#220,.T.);#231=ORIENTED_EDGE('',*,*,#221,.T.);\
        #232=ORIENTED_EDGE('',*,*,#222,.F.);#233=ORIENTED_EDGE('',*,*,#223,.F.);\
        #240=EDGE_LOOP('',(#230,#231,#232,#233));#241=FACE_BOUND('',#240,.T.);\
        #402=ADVANCED_FACE('',(#241),#120,.T.);";
    let face = only_face(&file(data));
    assert_eq!(
        (face.degree(), face.pole_count(), face.is_rational()),
        (Some([2, 1]), Some([3, 2]), Some(true))
    );
    assert!(!face.trimmed());
    assert!((face.area_mm2() - 3.0 * PI).abs() < 1e-6 * 3.0 * PI);
    let p = face.point(uv(0.3, 1.0));
    assert!((p.x.hypot(p.y) - 2.0).abs() < 1e-14);
}

#[test]
fn spheres_whole_and_cut() {
    let vertex = "#120=SPHERICAL_SURFACE('',#7,2.);#200=CARTESIAN_POINT('',(0.,0.,2.));\
        #201=VERTEX_POINT('',#200);#202=VERTEX_LOOP('',#201);#203=FACE_BOUND('',#202,.T.);\
        #402=ADVANCED_FACE('',(#203),#120,.T.);";
    let whole = only_face(&file(vertex));
    assert!(!whole.trimmed() && (whole.area_mm2() - 16.0 * PI).abs() < 1e-8);
    // A cap above z = 1: the parallel of radius sqrt 3, counter-clockwise seen from above, has the cap on its left.
    let cut = |forward: bool| {
        let ring = circle(300, [0.0, 0.0, 1.0], 3f64.sqrt(), forward);
        only_face(&file(&format!(
            "#120=SPHERICAL_SURFACE('',#7,2.);{ring}#203=FACE_BOUND('',#309,.T.);\
             #402=ADVANCED_FACE('',(#203),#120,.T.);"
        )))
    };
    // Zones of a sphere: 2 pi R h.
    for (forward, height, pole) in [(true, 1.0, FRAC_PI_2), (false, 3.0, -FRAC_PI_2)] {
        let cap = cut(forward);
        assert_area(&cap, 4.0 * PI * height);
        assert!(cap.contains(uv(1.0, 0.9 * pole)) && !cap.contains(uv(1.0, -0.9 * pole)));
    }
}

#[test]
fn a_cone_to_its_apex_and_half_a_torus() {
    let cone = only_face(&file(&format!(
        "#120=CONICAL_SURFACE('',#7,3.,0.4636476090008061);{}#203=FACE_BOUND('',#309,.F.);\
         #402=ADVANCED_FACE('',(#203),#120,.T.);",
        circle(300, [0.0; 3], 3.0, true)
    )));
    // tan = 1/2: the apex is 6 below; slant sqrt 45.
    assert_area(&cone, PI * 3.0 * 45f64.sqrt());
    assert!((cone.domain().v.lo + 45f64.sqrt()).abs() < 1e-9);
    let torus = only_face(&file(&format!(
        "#120=TOROIDAL_SURFACE('',#7,5.,1.);{}{}#203=FACE_BOUND('',#309,.T.);#204=FACE_BOUND('',#329,.T.);\
         #402=ADVANCED_FACE('',(#203,#204),#120,.T.);",
        // The upper half: from the outer equator (left is up) to the inner one.
        circle(300, [0.0; 3], 6.0, true),
        circle(320, [0.0; 3], 4.0, false)
    )));
    assert_area(&torus, 2.0 * PI * PI * 5.0);
    assert!(torus.contains(uv(2.0, FRAC_PI_2)) && !torus.contains(uv(2.0, -FRAC_PI_2)));
    assert!((torus.bbox().max.z - 1.0).abs() < 1e-9 && torus.bbox().min.z.abs() < 1e-6);
}

#[test]
fn swept_surfaces_become_splines() {
    // The parabola-like arc y = 2 x (1 - x) extruded by 3, bounded by two of its copies and two lines.
    let data = "#101=CARTESIAN_POINT('',(0.,0.,0.));#102=CARTESIAN_POINT('',(0.5,1.,0.));\
        #103=CARTESIAN_POINT('',(1.,0.,0.));#104=BEZIER_CURVE('',2,(#101,#102,#103),.UNSPECIFIED.,.F.,.F.);\
        #105=VECTOR('',#4,1.);#120=SURFACE_OF_LINEAR_EXTRUSION('',#104,#105);\
        #111=CARTESIAN_POINT('',(0.,0.,3.));#112=CARTESIAN_POINT('',(0.5,1.,3.));\
        #113=CARTESIAN_POINT('',(1.,0.,3.));#114=BEZIER_CURVE('',2,(#111,#112,#113),.UNSPECIFIED.,.F.,.F.);\
        #201=VERTEX_POINT('',#101);#202=VERTEX_POINT('',#103);#203=VERTEX_POINT('',#113);#204=VERTEX_POINT('',#111);\
        #211=LINE('',#103,#105);#213=LINE('',#101,#105);\
        #220=EDGE_CURVE('',#201,#202,#104,.T.);#221=EDGE_CURVE('',#202,#203,#211,.T.);\
        #222=EDGE_CURVE('',#204,#203,#114,.T.);#223=EDGE_CURVE('',#201,#204,#213,.T.);\
        #230=ORIENTED_EDGE('',*,*,#220,.T.);#231=ORIENTED_EDGE('',*,*,#221,.T.);\
        #232=ORIENTED_EDGE('',*,*,#222,.F.);#233=ORIENTED_EDGE('',*,*,#223,.F.);\
        #240=EDGE_LOOP('',(#230,#231,#232,#233));#241=FACE_BOUND('',#240,.T.);\
        #402=ADVANCED_FACE('',(#241),#120,.T.);";
    let face = only_face(&file(data));
    assert_eq!(face.kind, FaceKind::Extrusion);
    // Arc length of y = 2x - 2x^2 over [0, 1]: (2 sqrt 5 + asinh 2) / 4.
    assert_area(&face, 3.0 * (2.0 * 5f64.sqrt() + 2f64.asinh()) / 4.0);
    // A line turned about the z axis: a cylinder of radius 3 between two circles.
    let turned = wall().replace(
        "#120=CYLINDRICAL_SURFACE('',#7,3.);",
        "#110=CARTESIAN_POINT('',(3.,0.,1.));#111=VECTOR('',#4,1.);#112=LINE('',#110,#111);\
         #113=AXIS1_PLACEMENT('',#6,#4);#120=SURFACE_OF_REVOLUTION('',#112,#113);",
    );
    let face = only_face(&file(&format!("{turned}#402=ADVANCED_FACE('',(#367),#120,.T.);")));
    assert_eq!(face.kind, FaceKind::Revolution);
    assert_area(&face, 30.0 * PI);
}

#[test]
fn units_convert_to_millimetres() {
    let (outer, l) = polygon(200, &SQUARE);
    let text = file(&format!(
        "{}{outer}#400=FACE_BOUND('',#{l},.T.);#402=ADVANCED_FACE('',(#400),#120,.T.);\
         #500=OPEN_SHELL('',(#402));#501=SHELL_BASED_SURFACE_MODEL('',(#500));\
         #502=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#501),#3);",
        flat_patch()
    ));
    let part = step::read(text.as_bytes()).unwrap();
    assert_eq!(
        (part.unit.as_str(), part.schema.as_str(), part.format),
        ("millimetre", "AUTOMOTIVE_DESIGN", Format::Step)
    );
    let inch = text.replace(
        "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));",
        "#8=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));\
         #9=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.54),#8);\
         #1=(CONVERSION_BASED_UNIT('INCH',#9)LENGTH_UNIT()NAMED_UNIT(*));",
    );
    let part = step::read(inch.as_bytes()).unwrap();
    assert_eq!(part.unit, "inch");
    assert!((part.faces[0].area_mm2() - 100.0 * 25.4 * 25.4).abs() < 1e-9 * 64516.0);
    // Dialects that mean the same give the same.
    let dialect = text.replace("10.0", "1.0D+01").replace("0.0,", "0,").replace('\n', "\r\n\t/* ' ; */");
    let other = step::read(format!("\u{feff}  {dialect}").as_bytes()).unwrap();
    assert_eq!(other.faces[0].area_mm2(), step::read(text.as_bytes()).unwrap().faces[0].area_mm2());
}

fn notes(part: &Part) -> String {
    part.diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn what_cannot_be_read_is_told() {
    let (outer, l) = polygon(200, &SQUARE);
    let face = |surface: &str| {
        let text = file(&format!(
            "{surface}{outer}#400=FACE_BOUND('',#{l},.T.);#402=ADVANCED_FACE('',(#400),#120,.T.);"
        ));
        let part = step::read(text.as_bytes()).unwrap();
        assert!(part.faces.is_empty());
        assert_eq!((part.not_used[0].count, part.not_used[0].lines.len()), (1, 1));
        (part.not_used[0].kind.clone(), notes(&part))
    };
    let (kind, text) = face("#120=BLENDED_SURFACE('',#7);");
    assert_eq!(kind, "BLENDED_SURFACE");
    assert!(text.contains("F1 (#402, line 44)") && text.contains("not read"), "{text}");
    // A missing record, a cycle, counts that lie, a surface that is none.
    assert!(face("").1.contains("#120 is not defined"));
    let loop_ = "#119=RECTANGULAR_TRIMMED_SURFACE('',#120,0.,1.,0.,1.,.T.,.T.);\
                 #120=RECTANGULAR_TRIMMED_SURFACE('',#119,0.,1.,0.,1.,.T.,.T.);";
    assert!(face(loop_).1.contains("circle"));
    let short = flat_patch().replace("(4,4),(4,4)", "(4,1000000000),(4,4)");
    assert!(face(&short).1.contains("multiplicity"));
    let fewer = flat_patch().replace("(4,4),(4,4)", "(4,3),(4,4)");
    assert!(face(&fewer).1.contains("7 knots"), "{}", face(&fewer).1);
    assert!(face("#120=CYLINDRICAL_SURFACE('',#7,-1.);").1.contains("radius"));
    // An edge on a curve that refers to itself.
    let text = file(
        "#120=PLANE('',#7);#130=SURFACE_CURVE('',#130,(),.CURVE_3D.);#131=VERTEX_POINT('',#6);\
        #132=EDGE_CURVE('',#131,#131,#130,.T.);#133=ORIENTED_EDGE('',*,*,#132,.T.);#134=EDGE_LOOP('',(#133));\
        #135=FACE_BOUND('',#134,.T.);#402=ADVANCED_FACE('',(#135),#120,.T.);",
    );
    assert!(notes(&step::read(text.as_bytes()).unwrap()).contains("circle"));
    // A boundary that is nowhere near its surface.
    let far =
        "#118=CARTESIAN_POINT('',(0.,0.,40.));#119=AXIS2_PLACEMENT_3D('',#118,#4,#5);#120=PLANE('',#119);";
    assert!(face(far).1.contains("mm off the surface"));
    // A plane without any boundary is unlimited.
    let text = file("#120=PLANE('',#7);#402=ADVANCED_FACE('',(),#120,.T.);");
    assert!(notes(&step::read(text.as_bytes()).unwrap()).contains("unlimited"));
}

#[test]
fn reversed_shells_turn_their_faces_over() {
    let (outer, l) = polygon(200, &SQUARE);
    let text = file(&format!(
        "{}{outer}#400=FACE_BOUND('',#{l},.T.);#402=ADVANCED_FACE('',(#400),#120,.T.);\
         #500=CLOSED_SHELL('',(#402));#501=ORIENTED_CLOSED_SHELL('',*,#500,.F.);",
        flat_patch()
    ));
    assert_eq!(only_face(&text).jet2(uv(0.5, 0.5)).normal().unwrap().z, -1.0);
}

#[test]
fn every_error() {
    assert_eq!(read(b" \n").unwrap_err(), ImportError::Empty);
    assert!(matches!(read(b"solid cube").unwrap_err(), ImportError::Unknown { .. }));
    assert_eq!(detect(b"solid"), None);
    assert_eq!(step::read(b"hello").unwrap_err(), StepError::NotStep { searched: 5 });
    assert_eq!(detect(b"\n\n ISO-10303-21;"), Some(Format::Step));
    let empty = b"ISO-10303-21;HEADER;ENDSEC;DATA;ENDSEC;END-ISO-10303-21;";
    assert!(matches!(step::read(empty).unwrap_err(), StepError::NoRecords { bytes: 56, .. }));
    assert!(matches!(read(empty), Err(ImportError::Step(_))));
}

#[test]
fn no_truncation_is_fatal() {
    let (outer, l) = polygon(200, &SQUARE);
    let text = file(&format!(
        "{}{outer}{}#400=FACE_BOUND('',#{l},.T.);#401=FACE_BOUND('',#309,.T.);\
         #402=ADVANCED_FACE('',(#400,#401),#120,.T.);",
        flat_patch(),
        circle(300, [5.0, 5.0, 0.0], 2.0, false)
    ));
    let whole = step::read(text.as_bytes()).unwrap();
    assert_eq!(whole.faces.len(), 1);
    for end in (20..text.len() - 20).step_by(13) {
        match step::read(&text.as_bytes()[..end]) {
            Ok(part) => assert!(notes(&part).contains("truncated"), "{end}"),
            Err(e) => assert!(matches!(e, StepError::NoRecords { .. }), "{end}: {e}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Bytes changed anywhere: an error or a part, never a panic.
    #[test]
    fn damage_never_panics(changes in prop::collection::vec((0.0..1.0, any::<u8>(), any::<bool>()), 1..8)) {
        let text = file(&format!("{}#402=ADVANCED_FACE('',(#367),#120,.T.);", wall()));
        let mut bytes = text.into_bytes();
        for (at, byte, keyboard) in changes {
            let k = (at * (bytes.len() - 1) as f64) as usize;
            // Half of the changes are characters that mean something.
            bytes[k] = if keyboard { b"0123456789.,;()#$*'-E"[byte as usize % 21] } else { byte };
        }
        if let Ok(part) = read(&bytes) {
            for f in &part.faces {
                prop_assert!(f.area_mm2() >= 0.0 && f.entity > 0);
            }
        }
    }
}
