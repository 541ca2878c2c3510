//! Writes a STEP file of 200 rational bicubic faces, each bounded by the curves of its four sides, for timing readers:
//! `rational_faces FILE`. The same bytes at every run; about 3.5 MB.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::fmt::Write as _;

/// Faces in the file.
const FACES: usize = 200;

/// Poles of a face in both directions: with their weights about 17 kB a face.
const POLES: [usize; 2] = [12, 12];

/// Records in sequence.
#[derive(Default)]
struct Records {
    text: String,
    last: usize,
}

impl Records {
    fn add(&mut self, what: &str) -> usize {
        self.last += 1;
        writeln!(self.text, "#{}={what};", self.last).unwrap();
        self.last
    }
}

fn list(ids: impl Iterator<Item = usize>) -> String {
    let all: Vec<String> = ids.map(|i| format!("#{i}")).collect();
    format!("({})", all.join(","))
}

fn reals(all: &[f64]) -> String {
    let all: Vec<String> = all.iter().map(|x| format!("{x:?}")).collect();
    format!("({})", all.join(","))
}

/// Multiplicities and values of a clamped uniform knot vector of degree three over `[0, 1]`.
fn knots(poles: usize) -> String {
    let spans = poles - 3;
    let counts: Vec<&str> = (0..=spans).map(|k| if k == 0 || k == spans { "4" } else { "1" }).collect();
    let values: Vec<f64> = (0..=spans).map(|k| k as f64 / spans as f64).collect();
    format!("({}),{}", counts.join(","), reals(&values))
}

fn face(out: &mut Records, number: usize) -> usize {
    let [n, m] = POLES;
    let (column, row) = ((number % 20) as f64, (number / 20) as f64);
    let mut ids = Vec::new();
    let mut weights = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let (u, v) = (i as f64 / (n - 1) as f64, j as f64 / (m - 1) as f64);
            let wave = (6.0 * u + 0.3 * column).sin() * (5.0 * v + 0.2 * row).cos();
            let p = [12.0 * column + 10.0 * u, 12.0 * row + 10.0 * v, 1.5 * wave];
            ids.push(out.add(&format!("CARTESIAN_POINT('',{})", reals(&p))));
            weights.push(1.0 + 0.4 * (3.0 * u - v + 0.1 * column).sin().powi(2));
        }
    }
    let at = |i: usize, j: usize| i * m + j;
    let rows: Vec<String> = (0..n).map(|i| list((0..m).map(|j| ids[at(i, j)]))).collect();
    let weight_rows: Vec<String> = (0..n).map(|i| reals(&weights[i * m..(i + 1) * m])).collect();
    let [u, v] = [knots(n), knots(m)].map(|k| {
        let (counts, values) = k.split_once("),").unwrap();
        (format!("{counts})"), values.to_owned())
    });
    let surface = out.add(&format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(3,3,({}),.UNSPECIFIED.,.F.,.F.,.F.)B_SPLINE_SURFACE_WITH_KNOTS({},{},{},{},\
         .UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({}))REPRESENTATION_ITEM('')SURFACE())",
        rows.join(","),
        u.0,
        v.0,
        u.1,
        v.1,
        weight_rows.join(",")
    ));
    let corners = [(0, 0), (n - 1, 0), (n - 1, m - 1), (0, m - 1)];
    let vertices = corners.map(|(i, j)| out.add(&format!("VERTEX_POINT('',#{})", ids[at(i, j)])));
    let sides: [Vec<usize>; 4] = [
        (0..n).map(|i| at(i, 0)).collect(),
        (0..m).map(|j| at(n - 1, j)).collect(),
        (0..n).rev().map(|i| at(i, m - 1)).collect(),
        (0..m).rev().map(|j| at(0, j)).collect(),
    ];
    let mut uses = Vec::new();
    for (k, side) in sides.iter().enumerate() {
        let w: Vec<f64> = side.iter().map(|i| weights[*i]).collect();
        let curve = out.add(&format!(
            "(BOUNDED_CURVE()B_SPLINE_CURVE(3,{},.UNSPECIFIED.,.F.,.F.)B_SPLINE_CURVE_WITH_KNOTS({},.UNSPECIFIED.)CURVE()\
             GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE({})REPRESENTATION_ITEM(''))",
            list(side.iter().map(|i| ids[*i])),
            knots(side.len()),
            reals(&w)
        ));
        let edge =
            out.add(&format!("EDGE_CURVE('',#{},#{},#{curve},.T.)", vertices[k], vertices[(k + 1) % 4]));
        uses.push(out.add(&format!("ORIENTED_EDGE('',*,*,#{edge},.T.)")));
    }
    let edges = out.add(&format!("EDGE_LOOP('',{})", list(uses.into_iter())));
    let bound = out.add(&format!("FACE_OUTER_BOUND('',#{edges},.T.)"));
    out.add(&format!("ADVANCED_FACE('',(#{bound}),#{surface},.T.)"))
}

fn main() {
    let Some(path) = std::env::args().nth(1) else {
        println!("usage: rational_faces FILE");
        return;
    };
    let mut out = Records::default();
    let faces: Vec<usize> = (0..FACES).map(|k| face(&mut out, k)).collect();
    let shell = out.add(&format!("OPEN_SHELL('',{})", list(faces.into_iter())));
    let model = out.add(&format!("SHELL_BASED_SURFACE_MODEL('',(#{shell}))"));
    let length = out.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    let angle = out.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let solid = out.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
    let context = out.add(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))\
         REPRESENTATION_CONTEXT('',''))"
    ));
    let application = out.add("APPLICATION_CONTEXT('automotive design')");
    out.add(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2010,#{application})"
    ));
    let product_context = out.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
    let product = out.add(&format!("PRODUCT('faces','faces','',(#{product_context}))"));
    let formation = out.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
    let design = out.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
    let definition = out.add(&format!("PRODUCT_DEFINITION('','',#{formation},#{design})"));
    let shape = out.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
    let whole = out.add(&format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{model}),#{context})"));
    out.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{whole})"));
    let text = format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 3 1 1 1 }}'));\nENDSEC;\nDATA;\n{}ENDSEC;\n\
         END-ISO-10303-21;\n",
        out.text
    );
    std::fs::write(&path, &text).unwrap();
    println!("{} bytes, {FACES} faces", text.len());
}
