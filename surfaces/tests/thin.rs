//! Packages of thin solids: plates with a hole, so thin that both sides lie within what the file says of its own exactness, against the
//! closed form of their area and volume.

use osculate_geom::Jet2;
use osculate_surfaces::{Part, step};
use std::f64::consts::PI;

/// Width, depth and radius of the hole of each plate, mm, and how many lie over each other.
const PLATE: [f64; 3] = [10.0, 6.0, 1.3];
const PLATES: usize = 3;
/// What the file says of its exactness, mm: more than the thinnest plates.
const UNCERTAIN: &str = "1.E-3";
/// Areas of planes are exact; rings are integrated to 1e-9.
const EXACT: f64 = 1e-9;

/// Records in sequence.
#[derive(Default)]
struct Records(Vec<String>);

impl Records {
    fn add(&mut self, record: String) -> usize {
        self.0.push(record);
        self.0.len()
    }

    fn triple(&mut self, word: &str, [x, y, z]: [f64; 3]) -> usize {
        self.add(format!("{word}('',({x:?},{y:?},{z:?}))"))
    }

    fn frame(&mut self, at: [f64; 3], z: [f64; 3], x: [f64; 3]) -> usize {
        let [at, z, x] =
            [("CARTESIAN_POINT", at), ("DIRECTION", z), ("DIRECTION", x)].map(|(w, p)| self.triple(w, p));
        self.add(format!("AXIS2_PLACEMENT_3D('',#{at},#{z},#{x})"))
    }

    fn vertex(&mut self, p: [f64; 3]) -> usize {
        let p = self.triple("CARTESIAN_POINT", p);
        self.add(format!("VERTEX_POINT('',#{p})"))
    }

    fn line(&mut self, [a, b]: [[f64; 3]; 2], [from, to]: [usize; 2]) -> usize {
        let way = [0, 1, 2].map(|k| b[k] - a[k]);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        let d = self.triple("DIRECTION", way.map(|x| x / length));
        let (p, v) = (self.triple("CARTESIAN_POINT", a), self.add(format!("VECTOR('',#{d},1.)")));
        let line = self.add(format!("LINE('',#{p},#{v})"));
        self.add(format!("EDGE_CURVE('',#{from},#{to},#{line},.T.)"))
    }

    fn looped(&mut self, edges: &[(usize, char)]) -> usize {
        let all: Vec<usize> =
            edges.iter().map(|(e, s)| self.add(format!("ORIENTED_EDGE('',*,*,#{e},.{s}.)"))).collect();
        self.add(format!("EDGE_LOOP('',({}))", list(&all)))
    }

    fn face(&mut self, loops: &[usize], surface: usize, sense: char) -> usize {
        let bounds: Vec<usize> = loops
            .iter()
            .enumerate()
            .map(|(k, l)| {
                let word = if k == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
                self.add(format!("{word}('',#{l},.T.)"))
            })
            .collect();
        self.add(format!("ADVANCED_FACE('',({}),#{surface},.{sense}.)", list(&bounds)))
    }
}

fn list(ids: &[usize]) -> String {
    ids.iter().map(|k| format!("#{k}")).collect::<Vec<_>>().join(",")
}

/// A plate of this thickness from z upwards, as a solid.
fn plate(r: &mut Records, z: f64, thick: f64) -> usize {
    let [w, d, radius] = PLATE;
    let corners = [[0.0, 0.0], [w, 0.0], [w, d], [0.0, d]];
    let p = corners.map(|[x, y]| [[x, y, z], [x, y, z + thick]]);
    let v = p.map(|q| q.map(|p| r.vertex(p)));
    let next = |k: usize| (k + 1) % 4;
    let [low, high] =
        [0, 1].map(|s| [0, 1, 2, 3].map(|k| r.line([p[k][s], p[next(k)][s]], [v[k][s], v[next(k)][s]])));
    let up = [0, 1, 2, 3].map(|k| r.line(p[k], v[k]));
    let rim = [z, z + thick].map(|z| [0.5 * w + radius, 0.5 * d, z]);
    let on = rim.map(|p| r.vertex(p));
    let rings = [0, 1].map(|s| {
        let frame = r.frame([0.5 * w, 0.5 * d, rim[s][2]], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        let circle = r.add(format!("CIRCLE('',#{frame},{radius:?})"));
        r.add(format!("EDGE_CURVE('',#{},#{},#{circle},.T.)", on[s], on[s]))
    });
    let seam = r.line(rim, on);
    let mut faces = Vec::new();
    for (s, sense) in [(0, 'F'), (1, 'T')] {
        let outer: Vec<(usize, char)> = if s == 1 {
            high.map(|e| (e, 'T')).to_vec()
        } else {
            low.iter().rev().map(|e| (*e, 'F')).collect()
        };
        let loops = [r.looped(&outer), r.looped(&[(rings[s], if s == 1 { 'F' } else { 'T' })])];
        let frame = r.frame(p[0][s], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        let plane = r.add(format!("PLANE('',#{frame})"));
        faces.push(r.face(&loops, plane, sense));
    }
    let sides = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
    for (k, [x, y]) in sides.into_iter().enumerate() {
        let around = r.looped(&[(low[k], 'T'), (up[next(k)], 'T'), (high[k], 'F'), (up[k], 'F')]);
        let frame = r.frame(p[k][0], [x, y, 0.0], [-y, x, 0.0]);
        let plane = r.add(format!("PLANE('',#{frame})"));
        faces.push(r.face(&[around], plane, 'T'));
    }
    let wall = r.looped(&[(rings[0], 'F'), (seam, 'T'), (rings[1], 'T'), (seam, 'F')]);
    let frame = r.frame([0.5 * w, 0.5 * d, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let cylinder = r.add(format!("CYLINDRICAL_SURFACE('',#{frame},{radius:?})"));
    faces.push(r.face(&[wall], cylinder, 'F'));
    let shell = r.add(format!("CLOSED_SHELL('',({}))", list(&faces)));
    r.add(format!("MANIFOLD_SOLID_BREP('',#{shell})"))
}

fn package(thick: f64) -> Part {
    let mut r = Records::default();
    let solids: Vec<usize> = (0..PLATES).map(|k| plate(&mut r, 2.0 * thick * k as f64, thick)).collect();
    let mm = r.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))".to_owned());
    let rad = r.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))".to_owned());
    let about = r.add(format!("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({UNCERTAIN}),#{mm},'','')"));
    let context = r.add(format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{about}))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT((#{mm},#{rad}))REPRESENTATION_CONTEXT('',''))"
    ));
    r.add(format!("ADVANCED_BREP_SHAPE_REPRESENTATION('',({}),#{context})", list(&solids)));
    let data: String = r.0.iter().enumerate().map(|(k, text)| format!("#{}={text};\n", k + 1)).collect();
    let text = format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n{data}ENDSEC;\nEND-ISO-10303-21;\n"
    );
    step::read(text.as_bytes()).unwrap()
}

#[test]
fn thin_solids_have_all_of_their_area() {
    let [w, d, r] = PLATE;
    for thick in [1.0, 0.035, 0.002, 0.0005] {
        let part = package(thick);
        assert_eq!(part.faces.len(), 7 * PLATES, "{thick}");
        assert!(part.diagnostics.is_empty(), "{thick}: {:?}", part.diagnostics);
        let holed = w * d - PI * r * r;
        let exact = PLATES as f64 * (2.0 * holed + (2.0 * (w + d) + 2.0 * PI * r) * thick);
        let area: f64 = part.faces.iter().map(|f| f.area_mm2()).sum();
        assert!((area - exact).abs() < EXACT * exact, "{thick}: {area} is not {exact}");
        // The divergence theorem: sides that were swapped or lost would show here, however thin the plates.
        let flux = |jet: &Jet2| jet.normal().map_or(0.0, |n| jet.point.z * n.z);
        let volume: f64 = part.faces.iter().map(|f| f.surface.integrate(1e-9, &flux)).sum();
        let exact = PLATES as f64 * holed * thick;
        assert!((volume - exact).abs() < 1e-6 * exact, "{thick}: {volume} is not {exact}");
        assert!(part.faces.iter().all(|f| f.imbalance().is_none()), "{thick}");
    }
}
