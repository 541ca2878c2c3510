//! Small Part-21 files, record by record.

#![allow(clippy::unwrap_used, dead_code)]

use osculate_surfaces::Face;
use osculate_surfaces::step;

/// Loops follow their curves to 2e-6 of the face's size and areas come to 1e-7 of the rectangle; a boundary of length
/// about three sizes changes the area by less than 1e-5.
pub const AREA: f64 = 1e-5;

/// A file with millimetres and radians around the records.
pub fn file(data: &str) -> String {
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n\
         #1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
         #2=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
         #3=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#2))\
         REPRESENTATION_CONTEXT('',''));\n\
         #4=DIRECTION('',(0.,0.,1.));\n#5=DIRECTION('',(1.,0.,0.));\n#6=CARTESIAN_POINT('',(0.,0.,0.));\n\
         #7=AXIS2_PLACEMENT_3D('',#6,#4,#5);\n\
         {data}ENDSEC;\nEND-ISO-10303-21;\n"
    )
}

/// Records of straight edges around points, from number `n` on, and their loop's number.
pub fn polygon(n: u64, points: &[[f64; 3]]) -> (String, u64) {
    let mut out = String::new();
    let k = points.len() as u64;
    for (i, p) in points.iter().enumerate() {
        let at = n + 10 * i as u64;
        let next = n + 10 * ((i as u64 + 1) % k);
        let q = points[(i + 1) % points.len()];
        let d = [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
        out += &format!(
            "#{at}=CARTESIAN_POINT('',({:?},{:?},{:?}));\n#{}=VERTEX_POINT('',#{at});\n\
             #{}=DIRECTION('',({:?},{:?},{:?}));\n#{}=VECTOR('',#{},1.);\n#{}=LINE('',#{at},#{});\n\
             #{}=EDGE_CURVE('',#{},#{},#{},.T.);\n#{}=ORIENTED_EDGE('',*,*,#{},.T.);\n",
            p[0],
            p[1],
            p[2],
            at + 1,
            at + 2,
            d[0],
            d[1],
            d[2],
            at + 3,
            at + 2,
            at + 4,
            at + 3,
            at + 5,
            at + 1,
            next + 1,
            at + 4,
            at + 6,
            at + 5,
        );
    }
    let edges: Vec<String> = (0..k).map(|i| format!("#{}", n + 10 * i + 6)).collect();
    let number = n + 10 * k;
    out += &format!("#{number}=EDGE_LOOP('',({}));\n", edges.join(","));
    (out, number)
}

/// Records of a full circle about z, counter-clockwise from angle 0, from number `n` on; the loop is `n + 9`.
pub fn circle(n: u64, centre: [f64; 3], radius: f64, forward: bool) -> String {
    let [x, y, z] = centre;
    let sense = if forward { ".T." } else { ".F." };
    format!(
        "#{n}=CARTESIAN_POINT('',({x:?},{y:?},{z:?}));\n#{}=AXIS2_PLACEMENT_3D('',#{n},#4,#5);\n\
         #{}=CIRCLE('',#{},{radius:?});\n#{}=CARTESIAN_POINT('',({:?},{y:?},{z:?}));\n#{}=VERTEX_POINT('',#{});\n\
         #{}=EDGE_CURVE('',#{},#{},#{},.T.);\n#{}=ORIENTED_EDGE('',*,*,#{},{sense});\n#{}=EDGE_LOOP('',(#{}));\n",
        n + 1,
        n + 2,
        n + 1,
        n + 3,
        x + radius,
        n + 4,
        n + 3,
        n + 5,
        n + 4,
        n + 4,
        n + 2,
        n + 6,
        n + 5,
        n + 9,
        n + 6,
    )
}

pub fn only_face(text: &str) -> Face {
    let part = step::read(text.as_bytes()).unwrap();
    assert!(part.diagnostics.is_empty(), "{:?}", part.diagnostics);
    assert_eq!(part.faces.len(), 1, "{:?}", part.not_used);
    part.faces.into_iter().next().unwrap()
}

pub fn assert_area(face: &Face, want: f64) {
    let got = face.area_mm2();
    assert!((got - want).abs() <= AREA * want, "area {got}, {want} wanted");
}

/// A flat bicubic patch over `[0, 10]^2` with u = x / 10 and v = y / 10.
pub fn flat_patch() -> String {
    let mut out = String::new();
    let mut rows = Vec::new();
    for i in 0..4 {
        let mut row = Vec::new();
        for j in 0..4 {
            let n = 100 + 4 * i + j;
            let (x, y) = (10.0 * f64::from(i) / 3.0, 10.0 * f64::from(j) / 3.0);
            out += &format!("#{n}=CARTESIAN_POINT('',({x:?},{y:?},0.));\n");
            row.push(format!("#{n}"));
        }
        rows.push(format!("({})", row.join(",")));
    }
    out + &format!(
        "#120=B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({}),.UNSPECIFIED.,.F.,.F.,.F.,(4,4),(4,4),(0.,1.),(0.,1.),\
         .UNSPECIFIED.);\n",
        rows.join(",")
    )
}

pub const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0]];
