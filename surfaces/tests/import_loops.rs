//! Loops that go through poles, around a surface without a partner, against their edges or beyond an apex, with areas and
//! boxes in closed form.

use crate::part21;

use osculate_surfaces::{Face, FaceKind, step};
use part21::{AREA, file, numbered, triple};
use std::f64::consts::PI;

fn only(data: &str) -> (Face, Vec<String>) {
    let mut part = step::read(file(data).as_bytes()).unwrap();
    let said = part.diagnostics.iter().map(ToString::to_string).collect();
    assert_eq!(part.faces.len(), 1, "{said:?}");
    (part.faces.remove(0), said)
}

/// Records of a vertex, `n` its point and `n + 1` the vertex.
fn vertex(n: u64, p: [f64; 3]) -> String {
    numbered(n, &format!("@0=CARTESIAN_POINT('',{});\n@1=VERTEX_POINT('',@0);\n", triple(p)))
}

/// Records of an edge on a circle about the origin with the given axis and start direction, and its use: the curve is
/// `n + 3`, the edge `n + 4`, its oriented use `n + 5`.
fn arc(n: u64, axis: [f64; 3], x: [f64; 3], radius: f64, ends: [u64; 2], forward: bool) -> String {
    let frame = format!(
        "@0=DIRECTION('',{});\n@1=DIRECTION('',{});\n@2=AXIS2_PLACEMENT_3D('',#6,@0,@1);\n",
        triple(axis),
        triple(x)
    );
    part21::arc(n, &frame, radius, ends, [true, forward])
}

/// A face over a loop of oriented edges on the surface of number 900.
fn face(edges: &[u64], surface: &str) -> String {
    let edges: Vec<String> = edges.iter().map(|e| format!("#{e}")).collect();
    format!(
        "#900={surface};\n#901=EDGE_LOOP('',({}));\n#902=FACE_OUTER_BOUND('',#901,.T.);\n\
         #903=ADVANCED_FACE('',(#902),#900,.T.);\n#904=OPEN_SHELL('',(#903));\n\
         #905=SHELL_BASED_SURFACE_MODEL('',(#904));\n#906=SHAPE_REPRESENTATION('',(#7,#905),#3);\n",
        edges.join(",")
    )
}

#[test]
fn an_edge_through_a_pole_of_its_sphere() {
    // An octant of a sphere whose poles are at +-y; one of its edges runs through the pole +y and on to -x: a quarter of
    // the half z > 0, y > 0, which has two corners at +-x and whose third edge is the half circle in z = 0.
    let r = 3.0;
    let data = vertex(10, [r, 0.0, 0.0])
        + &vertex(20, [-r, 0.0, 0.0])
        + &arc(30, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], r, [11, 21], true)
        + &arc(40, [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], r, [11, 21], false)
        + "#50=DIRECTION('',(0.,1.,0.));\n#51=AXIS2_PLACEMENT_3D('',#6,#50,#5);\n"
        + &face(&[35, 45], "SPHERICAL_SURFACE('',#51,3.)");
    let (f, said) = only(&data);
    // The loop runs along +y below and back over +z: the quarter is on its left.
    assert!((f.area_mm2() / (PI * r * r) - 1.0).abs() < AREA, "{} {said:?}", f.area_mm2());
    let b = f.bbox();
    for (got, want) in [(b.min, [-r, 0.0, 0.0]), (b.max, [r, r, r])] {
        for k in 0..3 {
            // Loops follow their curves to 2e-6 of the size.
            assert!((got[k] - want[k]).abs() < 1e-5 * r, "{b:?}");
        }
    }
}

#[test]
fn a_turn_without_partner_bounds_nothing() {
    // A patch of 0.2 rad and 5 mm on a cylinder of 10 mm; before it the loop goes once around from the same vertex.
    let (r, h) = (10.0_f64, 5.0);
    let (x, y) = (r * 0.2_f64.cos(), r * 0.2_f64.sin());
    let circle = |n: u64, at: f64, ends: [u64; 2], sense: &str| {
        format!(
            "#{n}=CARTESIAN_POINT('',(0.,0.,{at:?}));\n#{}=AXIS2_PLACEMENT_3D('',#{n},#4,#5);\n\
             #{}=CIRCLE('',#{},{r:?});\n#{}=EDGE_CURVE('',#{},#{},#{},.T.);\n#{}=ORIENTED_EDGE('',*,*,#{},{sense});\n",
            n + 1,
            n + 2,
            n + 1,
            n + 3,
            ends[0],
            ends[1],
            n + 2,
            n + 4,
            n + 3,
        )
    };
    let rise = |n: u64, ends: [u64; 2], sense: &str| {
        format!(
            "#{n}=VECTOR('',#4,1.);\n#{}=LINE('',#{},#{n});\n#{}=EDGE_CURVE('',#{},#{},#{},.T.);\n\
             #{}=ORIENTED_EDGE('',*,*,#{},{sense});\n",
            n + 1,
            ends[0] - 1,
            n + 2,
            ends[0],
            ends[1],
            n + 1,
            n + 3,
            n + 2,
        )
    };
    let data = vertex(10, [r, 0.0, 0.0])
        + &vertex(12, [x, y, 0.0])
        + &vertex(14, [x, y, h])
        + &vertex(16, [r, 0.0, h])
        + &circle(20, 0.0, [11, 11], ".T.")
        + &circle(30, 0.0, [11, 13], ".T.")
        + &rise(40, [13, 15], ".T.")
        + &circle(50, h, [17, 15], ".F.")
        + &rise(60, [11, 17], ".F.")
        + &face(&[24, 34, 43, 54, 63], "CYLINDRICAL_SURFACE('',#7,10.)");
    let (f, said) = only(&data);
    assert!((f.area_mm2() - 0.2 * r * h).abs() < AREA * r * h, "{} {said:?}", f.area_mm2());
    assert!(said.iter().any(|s| s.contains("without a partner")), "{said:?}");
}

#[test]
fn an_edge_that_runs_against_its_loop_is_turned_and_told() {
    let r = 2.0;
    // The upper half of a disc in the plane z = 0: its arc from +x to -x, and the diameter, flagged the wrong way.
    let data = vertex(10, [r, 0.0, 0.0])
        + &vertex(20, [-r, 0.0, 0.0])
        + &arc(30, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], r, [11, 21], true)
        + "#40=VECTOR('',#5,1.);\n#41=LINE('',#20,#40);\n#42=EDGE_CURVE('',#21,#11,#41,.T.);\n\
           #43=ORIENTED_EDGE('',*,*,#42,.F.);\n"
        + &face(&[35, 43], "PLANE('',#7)");
    let (f, said) = only(&data);
    assert!((f.area_mm2() / (0.5 * PI * r * r) - 1.0).abs() < AREA, "{said:?}");
    assert!(said.iter().any(|s| s.contains("against their loop")), "{said:?}");
}

#[test]
fn a_cone_beyond_its_apex() {
    // Half of the nappe below the apex of a cone of 30 degrees, 20 mm high, by parameter curves: area pi r s / 2 with
    // the radius h tan 30 and the slant h / cos 30.
    let line = |n: u64, from: [f64; 2], way: [f64; 2]| {
        format!(
            "#{n}=DIRECTION('',({:?},{:?}));\n#{}=VECTOR('',#{n},1.);\n#{}=CARTESIAN_POINT('',({:?},{:?}));\n\
             #{}=LINE('',#{},#{});\n#{}=TRIMMED_CURVE('',#{},(PARAMETER_VALUE(0.)),(PARAMETER_VALUE({:?})),.T.,\
             .PARAMETER.);\n#{}=DEFINITIONAL_REPRESENTATION('',(#{}),#8);\n#{}=PCURVE('',#900,#{});\n\
             #{}=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{});\n",
            way[0],
            way[1],
            n + 1,
            n + 2,
            from[0],
            from[1],
            n + 3,
            n + 2,
            n + 1,
            n + 4,
            n + 3,
            way[0].hypot(way[1]),
            n + 5,
            n + 4,
            n + 6,
            n + 5,
            n + 7,
            n + 6,
        )
    };
    let h = 20.0;
    let data = format!(
        "#8=PARAMETRIC_REPRESENTATION_CONTEXT('','');\n#900=CONICAL_SURFACE('',#7,0.,{:?});\n",
        PI / 6.0
    ) + &line(100, [0.0, 0.0], [0.0, -h])
        + &line(110, [0.0, -h], [PI, 0.0])
        + &line(120, [PI, -h], [0.0, h])
        + "#130=OUTER_BOUNDARY_CURVE('',(#107,#117,#127),.F.);\n#131=CURVE_BOUNDED_SURFACE('',#900,(#130),.F.);\n\
           #132=GEOMETRIC_SET('',(#131));\n#133=SHAPE_REPRESENTATION('',(#7,#132),#3);\n";
    let (f, said) = only(&data);
    let (radius, slant) = (h * (PI / 6.0).tan(), h / (PI / 6.0).cos());
    assert_eq!(f.kind, FaceKind::Cone);
    assert!((f.area_mm2() / (0.5 * PI * radius * slant) - 1.0).abs() < AREA, "{} {said:?}", f.area_mm2());
    let b = f.bbox();
    // The file's u is an angle of the nappe above: below, the half with y < 0 belongs to u from 0 to pi.
    assert!((b.min.z + h).abs() < 1e-9 && b.max.z.abs() < 1e-9 && b.max.y < 1e-9 && b.min.y < -radius + 1e-3);
}

#[test]
fn the_inside_of_a_spindle_torus() {
    // Tube of 2 mm about a circle of 1 mm; the sheet between the apexes at z = +-sqrt 3, the half on the left of a loop
    // down at x = -1 and up at x = 1. The natural normal points to the axis, so that is the half with y > 0.
    let z = 3.0_f64.sqrt();
    let meridian = |n: u64, centre: f64, ends: [u64; 2]| {
        let frame = format!(
            "@0=CARTESIAN_POINT('',({centre:?},0.,0.));\n@1=DIRECTION('',(0.,1.,0.));\n\
             @2=AXIS2_PLACEMENT_3D('',@0,@1,#5);\n"
        );
        part21::arc(n, &frame, 2.0, ends, [false, true])
    };
    let data = vertex(10, [0.0, 0.0, z])
        + &vertex(20, [0.0, 0.0, -z])
        + &meridian(30, 1.0, [11, 21])
        + &meridian(40, -1.0, [21, 11])
        + &face(&[35, 45], "DEGENERATE_TOROIDAL_SURFACE('',#7,1.,2.,.F.)");
    let (f, said) = only(&data);
    let b = f.bbox();
    assert!(b.min.y > -1e-5 && (b.max.y - 1.0).abs() < 1e-5, "{b:?} {said:?}");
    // Pappus for the arc of 120 degrees between the apexes: its centroid is 2 sin 60 / (pi / 3) from the tube's centre.
    let (arc, half) = (2.0 * PI / 3.0, PI / 3.0);
    let want = PI * (2.0 * half.sin() / half - 1.0) * 2.0 * arc;
    assert!((f.area_mm2() / want - 1.0).abs() < AREA, "{} {want}", f.area_mm2());
}

#[test]
fn edges_along_the_sides_of_a_patch_leave_the_whole_rectangle() {
    // A rational bicubic patch, bent, with the curves of its outer poles as edges, one of them given backwards and its
    // weights doubled, which changes no curve.
    let (mut data, mut rows, mut weights) = (String::new(), Vec::new(), Vec::new());
    for i in 0..4_u32 {
        for j in 0..4_u32 {
            let (x, y) = (f64::from(i), f64::from(j));
            let w = 1.0 + 0.1 * f64::from((i + 2 * j) % 3);
            data += &format!("#{}=CARTESIAN_POINT('',({x:?},{y:?},{:?}));\n", 100 + 4 * i + j, 0.2 * x * y);
            weights.push(w);
        }
        rows.push(format!("(#{},#{},#{},#{})", 100 + 4 * i, 101 + 4 * i, 102 + 4 * i, 103 + 4 * i));
    }
    let w = |k: usize| format!("{:?}", weights[k]);
    let all: Vec<String> = (0..4)
        .map(|i| format!("({},{},{},{})", w(4 * i), w(4 * i + 1), w(4 * i + 2), w(4 * i + 3)))
        .collect();
    let surface = format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(3,3,({}),.UNSPECIFIED.,.F.,.F.,.F.)B_SPLINE_SURFACE_WITH_KNOTS((4,4),(4,4),\
         (0.,1.),(0.,2.),.UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({}))\
         REPRESENTATION_ITEM('')SURFACE())",
        rows.join(","),
        all.join(",")
    );
    let corners = [100_u64, 112, 115, 103];
    for (k, c) in corners.iter().enumerate() {
        data += &format!("#{}=VERTEX_POINT('',#{c});\n", 200 + k);
    }
    // Outer poles of the four sides in the sense of the loop; the third is written against it.
    let sides = [[0, 4, 8, 12], [12, 13, 14, 15], [3, 7, 11, 15], [3, 2, 1, 0]];
    for (k, side) in sides.iter().enumerate() {
        let n = 210 + 10 * k;
        let points: Vec<String> = side.iter().map(|i| format!("#{}", 100 + i)).collect();
        let weights: Vec<String> = side.iter().map(|i| format!("{:?}", 2.0 * weights[*i])).collect();
        let (a, b, sense) = if k == 2 { (203, 202, ".F.") } else { (200 + k, 200 + (k + 1) % 4, ".T.") };
        data += &format!(
            "#{n}=(BOUNDED_CURVE()B_SPLINE_CURVE(3,({}),.UNSPECIFIED.,.F.,.F.)B_SPLINE_CURVE_WITH_KNOTS((4,4),(5.,9.),\
             .UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE(({}))\
             REPRESENTATION_ITEM(''));\n#{}=EDGE_CURVE('',#{a},#{b},#{n},.T.);\n#{}=ORIENTED_EDGE('',*,*,#{},{sense});\n",
            points.join(","),
            weights.join(","),
            n + 1,
            n + 2,
            n + 1
        );
    }
    let (f, said) = only(&(data + &face(&[212, 222, 232, 242], &surface)));
    assert!(!f.surface.is_trimmed() && said.is_empty(), "{said:?}");
}

/// Records of a Bezier surface of degree 2 in both directions over points in rows of three, from number 100 on.
fn biquadratic(points: &[[f64; 3]; 9]) -> (String, String) {
    let records: String =
        (100..).zip(points).map(|(n, p)| format!("#{n}=CARTESIAN_POINT('',{});\n", triple(*p))).collect();
    let surface = "B_SPLINE_SURFACE_WITH_KNOTS('',2,2,((#100,#101,#102),(#103,#104,#105),(#106,#107,#108)),.UNSPECIFIED.,.F.,.F.,\
                   .F.,(3,3),(3,3),(0.,1.),(0.,1.),.UNSPECIFIED.)";
    (records, surface.to_owned())
}

/// Records of a Bezier curve of degree 2 over points, as an edge between two vertices: the edge's use is `n + 2`.
fn parabola(n: u64, poles: [u64; 3], ends: [u64; 2], sense: &str) -> String {
    let [a, b, c] = poles;
    format!(
        "#{n}=B_SPLINE_CURVE_WITH_KNOTS('',2,(#{a},#{b},#{c}),.UNSPECIFIED.,.F.,.F.,(3,3),(0.,1.),.UNSPECIFIED.);\n\
         #{}=EDGE_CURVE('',#{},#{},#{n},.T.);\n#{}=ORIENTED_EDGE('',*,*,#{},{sense});\n",
        n + 1,
        ends[0],
        ends[1],
        n + 2,
        n + 1
    )
}

#[test]
fn two_sides_that_are_one_point() {
    // x = u v, y = u v (u - v) over the unit square: u = 0 and v = 0 are the origin. |S_u x S_v| is
    // |v (u^2 - 2 u v) - u (2 u v - v^2)| = |-u^2 v - u v^2|, whose integral is 2/6 = 1/3.
    // Poles: products of the degree-raised factors 0, 1/2, 1 of u and 0, 0, 1 of u^2.
    let (linear, square) = ([0.0, 0.5, 1.0], [0.0, 0.0, 1.0]);
    let mut points = [[0.0; 3]; 9];
    for i in 0..3 {
        for j in 0..3 {
            points[3 * i + j] = [linear[i] * linear[j], square[i] * linear[j] - linear[i] * square[j], 0.0];
        }
    }
    let (records, surface) = biquadratic(&points);
    // u = 1 from v = 0 up, then v = 1 from u = 1 down; both end where the other begins.
    let data = records
        + "#200=VERTEX_POINT('',#100);\n#201=VERTEX_POINT('',#108);\n"
        + &parabola(210, [106, 107, 108], [200, 201], ".T.")
        + &parabola(220, [102, 105, 108], [200, 201], ".F.");
    let (f, said) = only(&(data + &face(&[212, 222], &surface)));
    assert!((f.area_mm2() - 1.0 / 3.0).abs() < AREA, "{} {said:?}", f.area_mm2());
    assert!(said.len() == 1 && said[0].contains("one point"), "{said:?}");
    assert_eq!(f.imbalance(), None);
}

#[test]
fn a_loop_that_lacks_the_edge_around_a_small_end() {
    // A parabola z = r^2 / 20 from r = e to r = 10 turned about z. The loop is the rim alone; e is larger than what is a point
    // on a surface of this size, and smaller than a gap. Its area is pi/6 c^2 ((1 + 4 r^2 / c^2)^(3/2) - 1) with c = 20.
    let e = 1e-5_f64;
    let c = 20.0;
    let (b, pole) = (10.0_f64, |r: f64, z: f64| triple([r, 0.0, z]));
    // The middle pole of a parabola stands where the tangents at its ends meet: at the mean of the ends' r.
    let middle = (0.5 * (e + b), e * b / c);
    let data = format!(
        "#10=CARTESIAN_POINT('',{});\n#11=CARTESIAN_POINT('',{});\n#12=CARTESIAN_POINT('',{});\n\
         #13=B_SPLINE_CURVE_WITH_KNOTS('',2,(#10,#11,#12),.UNSPECIFIED.,.F.,.F.,(3,3),(0.,1.),.UNSPECIFIED.);\n\
         #14=AXIS1_PLACEMENT('',#6,#4);\n",
        pole(e, e * e / c),
        pole(middle.0, middle.1),
        pole(b, b * b / c)
    ) + &part21::circle(30, [0.0, 0.0, b * b / c], b, true)
        + "#900=SURFACE_OF_REVOLUTION('',#13,#14);\n#902=FACE_OUTER_BOUND('',#39,.T.);\n\
           #903=ADVANCED_FACE('',(#902),#900,SENSE);\n#904=OPEN_SHELL('',(#903));\n\
           #905=SHELL_BASED_SURFACE_MODEL('',(#904));\n#906=SHAPE_REPRESENTATION('',(#7,#905),#3);\n";
    let want = PI / 6.0 * c * c * ((1.0 + 4.0 * b * b / (c * c)).powf(1.5) - 1.0);
    for sense in [".T.", ".F."] {
        let (f, said) = only(&data.replace("SENSE", sense));
        assert!((f.area_mm2() / want - 1.0).abs() < AREA, "{} of {want}: {said:?}", f.area_mm2());
        assert!(said.len() == 1 && said[0].contains("taken for a pole"), "{said:?}");
    }
}
