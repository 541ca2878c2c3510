//! Kinds of IGES curves and surfaces against closed forms.

use crate::punched;

use osculate_geom::{Point3, Surface, uv};
use osculate_surfaces::FaceKind;
use osculate_surfaces::iges;
use punched::{Entity, assert_area, entity, file, only_face, part};
use std::f64::consts::PI;

/// A face of the plane z = 0 bounded by one or more curves.
fn flat(curves: &[Entity]) -> Vec<Entity> {
    let n = curves.len();
    let mut list = curves.to_vec();
    let members: String = (0..n).map(|k| format!(",@{k}")).collect();
    list.push(entity(102, format!("{n}{members}")));
    list.push(Entity(108, 1, 0, format!("0.,0.,1.,0.,@{n},0.,0.,0.,0.")));
    list
}

#[test]
fn ellipses_hyperbolas_and_parabolas() {
    // x^2 / 9 + y^2 / 4 = 1, all of it.
    let whole = Entity(104, 1, 0, "4.,0.,9.,0.,0.,-36.,0.,3.,0.,3.,0.".into());
    assert_area(&only_face(&flat(&[whole])), 6.0 * PI);
    // The same turned by 30 degrees about (5, 1): squares of the turned coordinates.
    let (s, c) = 30_f64.to_radians().sin_cos();
    let (a, b, d) = (4.0 * c * c + 9.0 * s * s, -10.0 * s * c, 4.0 * s * s + 9.0 * c * c);
    let (x0, y0) = (5.0, 1.0);
    let linear = [-2.0 * a * x0 - b * y0, -2.0 * d * y0 - b * x0];
    let rest = a * x0 * x0 + b * x0 * y0 + d * y0 * y0 - 36.0;
    // From one end of the long axis to the other: the lower half, closed by that axis.
    let end = |f: f64| (x0 + f * 3.0 * c, y0 + f * 3.0 * s);
    let ((xa, ya), (xb, yb)) = (end(-1.0), end(1.0));
    let half =
        format!("{a:?},{b:?},{d:?},{:?},{:?},{rest:?},0.,{xa:?},{ya:?},{xb:?},{yb:?}", linear[0], linear[1]);
    let chord = entity(110, format!("{xb:?},{yb:?},0.,{xa:?},{ya:?},0."));
    let face = only_face(&flat(&[entity(104, half), chord]));
    assert_area(&face, 3.0 * PI);
    let middle = face.bbox();
    assert!(middle.min.y < y0 - 1.5, "the half counter-clockwise from the lower end: {middle:?}");
    // x^2 / 4 - y^2 / 0.25 = 1 between y = -sinh(1) / 2 and the same above: between arc and chord a b (sinh t cosh t - t).
    let (sh, ch) = (1_f64.sinh(), 1_f64.cosh());
    let arc = Entity(
        104,
        2,
        0,
        format!("0.25,0.,-4.,0.,0.,-1.,0.,{:?},{:?},{:?},{:?}", 2.0 * ch, -0.5 * sh, 2.0 * ch, 0.5 * sh),
    );
    let chord = entity(110, format!("{:?},{:?},0.,{:?},{:?},0.", 2.0 * ch, 0.5 * sh, 2.0 * ch, -0.5 * sh));
    assert_area(&only_face(&flat(&[arc, chord])), sh * ch - 1.0);
    // y = x^2 between -1 and 2: the chord cuts off 27 / 6.
    let arc = Entity(104, 3, 0, "1.,0.,0.,0.,-1.,0.,0.,-1.,1.,2.,4.".into());
    let chord = entity(110, "2.,4.,0.,-1.,1.,0.");
    assert_area(&only_face(&flat(&[arc, chord])), 4.5);
    // A point off its conic is told.
    let off = Entity(104, 1, 0, "4.,0.,9.,0.,0.,-36.,0.,3.1,0.,3.1,0.".into());
    assert!(part(&flat(&[off])).diagnostics.iter().any(|d| d.message.contains("lies 1.000e-1 off")));
}

#[test]
fn parametric_splines_and_offsets() {
    // y = x^2 for x from 0 to 2 in two segments: below the chord 8 / 6.
    let curve = "3,2,2,2,0.,1.,2.,0.,1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,0.,1.,1.,0.,0.,1.,2.,1.,0.,0.,0.,0.,0.";
    let chord = entity(110, "2.,4.,0.,0.,0.,0.");
    assert_area(&only_face(&flat(&[entity(112, curve), chord])), 8.0 / 6.0);
    // A circle of radius 2 offset by 0.5 to its left.
    let mut list =
        vec![entity(100, "0.,0.,0.,2.,0.,2.,0."), entity(130, "@0,1,0,0,0,0.5,0.,0.,0.,0.,0.,1.,0.,6.3")];
    list.push(Entity(108, 1, 0, "0.,0.,1.,0.,@1,0.,0.,0.,0.".into()));
    assert_area(&only_face(&list), PI * 2.25);
    // An offset that follows a function is told.
    list[1] = entity(130, "@0,3,0,2,1,0.5,0.,0.,0.,0.,0.,1.,0.,6.3");
    let part = part(&list);
    assert!(part.faces.is_empty() && part.diagnostics.iter().any(|d| d.message.contains("by a function")));
}

#[test]
fn parametric_surfaces() {
    // x = s, y = 2 t, z = 0 over two patches along u and one along v; each row ends with a patch that means nothing.
    let patch = |x0: f64| {
        let mut c = vec![0.0; 48];
        (c[0], c[1], c[20]) = (x0, 1.0, 2.0);
        c
    };
    let mut numbers = vec![3.0, 1.0, 2.0, 1.0, 0.0, 1.5, 4.0, 0.0, 3.0];
    for x0 in [0.0, 1.5] {
        numbers.extend(patch(x0));
        numbers.extend([9.0; 48]);
    }
    let text = |n: &[f64]| n.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",");
    let face = only_face(&[entity(114, text(&numbers))]);
    assert_eq!(
        (face.kind, face.degree(), face.pole_count()),
        (FaceKind::Bspline, Some([3, 3]), Some([7, 4]))
    );
    assert!((face.area_mm2() - 24.0).abs() < 1e-10);
    assert!((face.point(uv(2.5, 1.0)) - Point3::new(2.5, 2.0, 0.0)).norm() < 1e-14);
    // With the last row of patches that the standard has.
    numbers.extend([9.0; 96]);
    assert!((only_face(&[entity(114, text(&numbers))]).area_mm2() - 24.0).abs() < 1e-10);
    // Patches that do not meet are joined, and it is told.
    numbers[9 + 96] += 0.25;
    let part = part(&[entity(114, text(&numbers))]);
    assert!(part.diagnostics[0].message.contains("2.500e-1 mm apart"), "{:?}", part.diagnostics);
}

#[test]
fn ruled_surfaces() {
    // Two quarter circles: a quarter of a frustum of radii 3 and 1, slant sqrt(4 + 9).
    let arcs = |flag: u8, form: i32| {
        [
            entity(100, "0.,0.,0.,3.,0.,0.,3."),
            entity(100, "3.,0.,0.,1.,0.,0.,1."),
            Entity(118, form, 0, format!("@0,@1,{flag},0")),
        ]
    };
    let face = only_face(&arcs(0, 1));
    assert_eq!(face.kind, FaceKind::Ruled);
    assert_area(&face, PI * (3.0 + 1.0) * 13_f64.sqrt() / 4.0);
    // First end to last end: the rulings cross over, the middle one is 3 - 1 apart and 3 up.
    let crossed = only_face(&arcs(1, 1));
    assert!((crossed.point(uv(0.0, 1.0)) - Point3::new(0.0, 1.0, 3.0)).norm() < 1e-14);
    // Lines of differing degree and knots: a spline and a line.
    let list = [
        entity(126, "2,2,0,0,1,0,0.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,1.,1.,0.,2.,0.,0.,0.,1.,0.,0.,1."),
        entity(110, "0.,0.,5.,2.,0.,5."),
        Entity(118, 1, 0, "@0,@1,0,0".into()),
    ];
    let face = only_face(&list);
    assert_eq!((face.degree(), face.pole_count()), (Some([2, 1]), Some([3, 2])));
    // The spline is (2 t, 2 t (1 - t)).
    assert!((face.point(uv(0.25, 0.0)) - Point3::new(0.5, 0.375, 0.0)).norm() < 1e-15);
    // Arc length asked for, parameters given: the size of the difference is told.
    let mut list = list.to_vec();
    list[1] = entity(126, "2,2,0,0,1,0,0.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,5.,0.,0.,5.,2.,0.,5.,0.,1.,0.,0.,1.");
    list[2].1 = 0;
    let part = part(&list);
    assert!(part.diagnostics.iter().any(|d| d.message.contains("equal fractions")), "{:?}", part.diagnostics);
}

#[test]
fn composites_are_swept_whole() {
    // Two lines turned by a full turn about z: a cylinder of radius 2 and height 3, and a ring from 2 to 5.
    let list = [
        entity(110, "0.,0.,0.,0.,0.,1."),
        entity(110, "2.,0.,0.,2.,0.,3."),
        // Against the sense of the first.
        entity(110, "5.,0.,3.,2.,0.,3."),
        entity(102, "2,@1,@2"),
        entity(120, format!("@0,@3,0.,{:?}", 2.0 * PI)),
    ];
    assert_area(&only_face(&list), 12.0 * PI + 21.0 * PI);
    // A line and a quarter circle extruded by 2.
    let list = [
        entity(110, "0.,0.,0.,3.,0.,0."),
        entity(100, "0.,3.,1.,3.,0.,4.,1."),
        entity(102, "2,@0,@1"),
        entity(122, "@2,0.,0.,2."),
    ];
    assert_area(&only_face(&list), 6.0 + PI);
    // A gap between the parts is told.
    let mut list = list.to_vec();
    list[1] = entity(100, "0.,3.01,1.,3.01,0.,4.01,1.");
    assert!(part(&list).diagnostics.iter().any(|d| d.message.contains("1.000e-2 mm apart")));
}

#[test]
fn parameter_curves_of_swept_surfaces() {
    // A cylinder of radius 2 and height 5 about z from 0.5 rad; a window over z from 1 to 3 and 0.8 to 2 rad, given by
    // parameters alone.
    let list = [
        entity(110, "0.,0.,0.,0.,0.,1."),
        entity(110, "2.,0.,0.,2.,0.,5."),
        entity(120, "@0,@1,0.5,4.5"),
        entity(110, "0.2,0.8,0.,0.6,0.8,0."),
        entity(110, "0.6,0.8,0.,0.6,2.,0."),
        entity(110, "0.6,2.,0.,0.2,2.,0."),
        entity(110, "0.2,2.,0.,0.2,0.8,0."),
        entity(102, "4,@3,@4,@5,@6"),
        entity(142, "0,@2,@7,0,1"),
        entity(144, "@2,1,0,@8"),
    ];
    let face = only_face(&list);
    assert_area(&face, 2.0 * 2.0 * 1.2);
    let b = face.bbox();
    assert!((b.min.z - 1.0).abs() < 1e-9 && (b.max.z - 3.0).abs() < 1e-9);
    assert!((b.max.x - 2.0 * 0.8_f64.cos()).abs() < 1e-6 && (b.min.x - 2.0 * 2_f64.cos()).abs() < 1e-6);
}

#[test]
fn analytic_surfaces_with_and_without_ends() {
    let sphere = [entity(116, "1.,2.,3.,0"), entity(196, "@0,2.")];
    let face = only_face(&sphere);
    assert_eq!(face.kind, FaceKind::Sphere);
    assert_area(&face, 16.0 * PI);
    let torus = [entity(116, "0.,0.,0.,0"), entity(123, "0.,0.,1."), entity(198, "@0,@1,5.,1.")];
    assert_area(&only_face(&torus), 20.0 * PI * PI);
    // Surfaces without ends are no faces, and that is said.
    for (list, kind) in [
        (vec![entity(108, "0.,0.,1.,2.,0,0.,0.,0.,0.")], "108 plane"),
        (
            vec![entity(116, "0.,0.,0.,0"), entity(123, "0.,0.,1."), entity(192, "@0,@1,5.")],
            "192 cylindrical surface",
        ),
    ] {
        let part = part(&list);
        assert!(part.faces.is_empty());
        let n = part.not_used.iter().find(|n| n.kind == kind).unwrap();
        assert!(n.why.contains("no ends") && n.why.contains(&format!("DE {}", 2 * list.len() - 1)), "{n:?}");
    }
    // A sphere with a vertex for a loop is a whole sphere.
    let list = [
        entity(116, "0.,0.,0.,0"),
        entity(196, "@0,2."),
        Entity(502, 1, 0, "1,0.,0.,2.".into()),
        Entity(508, 1, 0, "1,1,@2,1,0,0".into()),
        Entity(510, 1, 0, "@1,1,1,@3".into()),
    ];
    assert_area(&only_face(&list), 16.0 * PI);
}

#[test]
fn a_loop_that_is_none_is_left_out_and_told() {
    // The outer loop is three sides of a square.
    let mut list = vec![punched::flat_patch()];
    list.extend([
        entity(110, "1.,1.,0.,9.,1.,0."),
        entity(110, "9.,1.,0.,9.,9.,0."),
        entity(110, "9.,9.,0.,1.,9.,0."),
        entity(102, "3,@1,@2,@3"),
        entity(142, "0,@0,0,@4,2"),
        entity(144, "@0,1,0,@5"),
    ]);
    let part = iges::read(file(&list).as_bytes()).unwrap();
    assert_area(&part.faces[0], 100.0);
    assert!(
        part.diagnostics.iter().any(|d| d.message.contains("gap of 8.000e0 mm")),
        "{:?}",
        part.diagnostics
    );
}

#[test]
fn offset_surfaces() {
    // A sphere of radius 2, half a millimetre outside; the indicator is its normal in the middle, at -x.
    let list = [entity(116, "0.,0.,0.,0"), entity(196, "@0,2."), entity(140, "-1.,0.,0.,0.5,@1")];
    let face = only_face(&list);
    assert_eq!(face.kind, FaceKind::Offset);
    assert_area(&face, 25.0 * PI);
    // The other way in.
    let list = [entity(116, "0.,0.,0.,0"), entity(196, "@0,2."), entity(140, "1.,0.,0.,0.5,@1")];
    assert_area(&only_face(&list), 9.0 * PI);
    // A spline, 3 up.
    let face = only_face(&[punched::flat_patch(), entity(140, "0.,0.,1.,3.,@0")]);
    assert!((face.point(uv(0.5, 0.25)) - Point3::new(5.0, 2.5, 3.0)).norm() < 1e-12);
    assert!((face.area_mm2() - 100.0).abs() < 1e-9);
    // Offsets of each other have no root, an offset of itself is told.
    let told = part(&[entity(140, "0.,0.,1.,3.,@0")]);
    assert!(told.faces.is_empty() && told.diagnostics.iter().any(|d| d.message.contains("in a circle")));
}
