//! Small closed bodies from STEP records.

#![allow(clippy::unwrap_used)]

use crate::part21::{circle, file, polygon};
use osculate_surfaces::{Face, step};

pub fn faces(data: &str) -> Vec<Face> {
    let part = step::read(file(data).as_bytes()).unwrap();
    // The point of a loop that is a single vertex bounds nothing.
    assert!(part.not_used.iter().all(|n| n.kind.ends_with("POINT")), "{:?}", part.not_used);
    part.faces
}

/// A plane at a height, facing up or down, inside the loops.
pub fn level(n: u64, z: f64, up: bool, loops: &[u64]) -> String {
    let bounds: Vec<String> = (0..loops.len()).map(|k| format!("#{}", n + 10 + k as u64)).collect();
    let records: String = loops
        .iter()
        .enumerate()
        .map(|(k, l)| format!("#{}=FACE_BOUND('',#{l},.T.);\n", n + 10 + k as u64))
        .collect();
    format!(
        "#{n}=CARTESIAN_POINT('',(0.,0.,{z:?}));\n#{}=AXIS2_PLACEMENT_3D('',#{n},#4,#5);\n#{}=PLANE('',#{});\n{records}\
         #{}=ADVANCED_FACE('',({}),#{},{});\n",
        n + 1,
        n + 2,
        n + 1,
        n + 3,
        bounds.join(","),
        n + 2,
        if up { ".T." } else { ".F." }
    )
}

/// A cylinder of radius 3 and height 5: no seam edge, and every face with edges of its own.
pub fn cylinder() -> Vec<Face> {
    let rings = [
        circle(300, [0.0; 3], 3.0, true),
        circle(320, [0.0, 0.0, 5.0], 3.0, false),
        circle(340, [0.0; 3], 3.0, false),
        circle(360, [0.0, 0.0, 5.0], 3.0, true),
    ];
    faces(&format!(
        "#120=CYLINDRICAL_SURFACE('',#7,3.);{}#203=FACE_BOUND('',#309,.T.);#204=FACE_BOUND('',#329,.T.);\
         #402=ADVANCED_FACE('',(#203,#204),#120,.T.);{}{}",
        rings.concat(),
        level(500, 0.0, false, &[349]),
        level(600, 5.0, true, &[369])
    ))
}

/// A block of 10 x 8 x 5 with a bore of radius 2 along z.
pub fn block_with_bore() -> Vec<Face> {
    let at = |x: f64, y: f64, z: f64| [x, y, z];
    let corners = [(-5.0, -4.0), (5.0, -4.0), (5.0, 4.0), (-5.0, 4.0)];
    let mut data = [
        circle(300, [0.0; 3], 2.0, false),
        circle(320, [0.0, 0.0, 5.0], 2.0, true),
        circle(340, [0.0; 3], 2.0, true),
        circle(360, [0.0, 0.0, 5.0], 2.0, false),
    ]
    .concat();
    data += "#120=CYLINDRICAL_SURFACE('',#7,2.);#203=FACE_BOUND('',#309,.T.);#204=FACE_BOUND('',#329,.T.);\
             #402=ADVANCED_FACE('',(#203,#204),#120,.F.);";
    let mut below: Vec<[f64; 3]> = corners.iter().map(|c| at(c.0, c.1, 0.0)).collect();
    below.reverse();
    let (text, l) = polygon(1000, &below);
    data += &(text + &level(500, 0.0, false, &[l, 349]));
    let above: Vec<[f64; 3]> = corners.iter().map(|c| at(c.0, c.1, 5.0)).collect();
    let (text, l) = polygon(1100, &above);
    data += &(text + &level(600, 5.0, true, &[l, 369]));
    for k in 0..4 {
        let (p, q) = (corners[k], corners[(k + 1) % 4]);
        let n = 2000 + 100 * k as u64;
        let (text, l) =
            polygon(n, &[at(p.0, p.1, 0.0), at(q.0, q.1, 0.0), at(q.0, q.1, 5.0), at(p.0, p.1, 5.0)]);
        data += &text;
        let out = [q.1 - p.1, p.0 - q.0];
        data += &format!(
            "#{}=DIRECTION('',({:?},{:?},0.));#{}=AXIS2_PLACEMENT_3D('',#{n},#{},#4);#{}=PLANE('',#{});\
             #{}=FACE_BOUND('',#{l},.T.);#{}=ADVANCED_FACE('',(#{}),#{},.T.);",
            n + 80,
            out[0],
            out[1],
            n + 81,
            n + 80,
            n + 82,
            n + 81,
            n + 83,
            n + 84,
            n + 83,
            n + 82
        );
    }
    faces(&data)
}

pub fn sphere() -> Vec<Face> {
    faces(
        "#120=SPHERICAL_SURFACE('',#7,2.);#200=CARTESIAN_POINT('',(0.,0.,2.));#201=VERTEX_POINT('',#200);\
         #202=VERTEX_LOOP('',#201);#203=FACE_BOUND('',#202,.T.);#402=ADVANCED_FACE('',(#203),#120,.T.);",
    )
}

pub fn torus() -> Vec<Face> {
    faces(
        "#120=TOROIDAL_SURFACE('',#7,5.,1.5);#200=CARTESIAN_POINT('',(6.5,0.,0.));#201=VERTEX_POINT('',#200);\
         #202=VERTEX_LOOP('',#201);#203=FACE_BOUND('',#202,.T.);#402=ADVANCED_FACE('',(#203),#120,.T.);",
    )
}

/// A cone of radius 3 and height 6, with its apex, on a disk.
pub fn cone() -> Vec<Face> {
    faces(&format!(
        "#120=CONICAL_SURFACE('',#7,3.,0.4636476090008061);{}{}#203=FACE_BOUND('',#309,.F.);\
         #402=ADVANCED_FACE('',(#203),#120,.T.);{}",
        circle(300, [0.0; 3], 3.0, true),
        circle(340, [0.0; 3], 3.0, true),
        level(500, 0.0, true, &[349])
    ))
}
