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

/// Records whose numbers are written as `@0`, `@1`, ...: they count from `n` on.
pub fn numbered(n: u64, records: &str) -> String {
    let mut pieces = records.split('@');
    let mut out = pieces.next().unwrap().to_owned();
    for piece in pieces {
        let digits = piece.find(|c: char| !c.is_ascii_digit()).unwrap_or(piece.len());
        out += &format!("#{}{}", n + piece[..digits].parse::<u64>().unwrap(), &piece[digits..]);
    }
    out
}

/// A list of numbers as a point or direction has it.
pub fn triple([x, y, z]: [f64; 3]) -> String {
    format!("({x:?},{y:?},{z:?})")
}

/// Records of straight edges around points, from number `n` on, and their loop's number.
pub fn polygon(n: u64, points: &[[f64; 3]]) -> (String, u64) {
    let mut out = String::new();
    let k = points.len() as u64;
    for (i, p) in points.iter().enumerate() {
        let next = n + 10 * ((i as u64 + 1) % k);
        let q = points[(i + 1) % points.len()];
        let d = [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
        out += &numbered(
            n + 10 * i as u64,
            &format!(
                "@0=CARTESIAN_POINT('',{});\n@1=VERTEX_POINT('',@0);\n@2=DIRECTION('',{});\n\
                 @3=VECTOR('',@2,1.);\n@4=LINE('',@0,@3);\n@5=EDGE_CURVE('',@1,#{},@4,.T.);\n\
                 @6=ORIENTED_EDGE('',*,*,@5,.T.);\n",
                triple(*p),
                triple(d),
                next + 1,
            ),
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
    let records = format!(
        "@0=CARTESIAN_POINT('',{});\n@1=AXIS2_PLACEMENT_3D('',@0,#4,#5);\n@2=CIRCLE('',@1,{radius:?});\n\
         @3=CARTESIAN_POINT('',{});\n@4=VERTEX_POINT('',@3);\n@5=EDGE_CURVE('',@4,@4,@2,.T.);\n\
         @6=ORIENTED_EDGE('',*,*,@5,{sense});\n@9=EDGE_LOOP('',(@6));\n",
        triple(centre),
        triple([x + radius, y, z]),
    );
    numbered(n, &records)
}

/// Records of an edge on a circle and its use: `@3` is the curve, over a frame that the records of `frame` end with as
/// `@2`, `@4` the edge with the given sense, `@5` its oriented use.
pub fn arc(n: u64, frame: &str, radius: f64, ends: [u64; 2], senses: [bool; 2]) -> String {
    let [edge, used] = senses.map(|forward| if forward { ".T." } else { ".F." });
    let records = format!(
        "{frame}@3=CIRCLE('',@2,{radius:?});\n@4=EDGE_CURVE('',#{},#{},@3,{edge});\n\
         @5=ORIENTED_EDGE('',*,*,@4,{used});\n",
        ends[0], ends[1],
    );
    numbered(n, &records)
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
