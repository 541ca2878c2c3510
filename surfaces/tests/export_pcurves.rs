//! The parameter curves of exported STEP: on the surface they are the edge, at every parameter, and a seam has two.

use crate::part21;
use crate::solids;

use osculate_geom::{Point3, Surface, Vec3, uv};
use osculate_surfaces::step::{self, StepOptions};
use osculate_surfaces::{Face, NurbsCurve, NurbsCurve2};
use part21::{circle, file, flat_patch, only_face, polygon};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_4, TAU};

/// Records of an exported file, which has one on a line.
struct Records<'a>(HashMap<&'a str, &'a str>);

impl<'a> Records<'a> {
    fn new(text: &'a str) -> Self {
        let record = |line: &'a str| line.strip_suffix(';')?.split_once('=');
        Self(text.lines().filter_map(record).collect())
    }

    /// The arguments of a record of this kind, split at the outermost commas.
    fn arguments(&self, id: &str, kind: &str) -> Option<Vec<&'a str>> {
        let inner = self.0[id].strip_prefix(kind)?.strip_prefix('(')?.strip_suffix(')')?;
        Some(split(inner))
    }

    fn point<const D: usize>(&self, id: &str) -> [f64; D] {
        let all = self.arguments(id, "CARTESIAN_POINT").or_else(|| self.arguments(id, "DIRECTION")).unwrap();
        let numbers: Vec<f64> =
            split(&all[1][1..all[1].len() - 1]).iter().map(|x| x.parse().unwrap()).collect();
        numbers.try_into().unwrap()
    }

    fn spline<const D: usize>(&self, a: &[&str]) -> NurbsCurve<D> {
        let poles = split(&a[2][1..a[2].len() - 1]).into_iter().map(|p| self.point::<D>(p).into()).collect();
        let times = split(&a[6][1..a[6].len() - 1]);
        let values = split(&a[7][1..a[7].len() - 1]);
        let knots = times
            .iter()
            .zip(values)
            .flat_map(|(n, t)| std::iter::repeat_n(t.parse::<f64>().unwrap(), n.parse().unwrap()));
        NurbsCurve::new(a[1].parse().unwrap(), knots.collect(), poles, None).unwrap()
    }

    /// The way of an edge's curve.
    fn way(&self, id: &str) -> Box<dyn Fn(f64) -> Point3> {
        if let Some(a) = self.arguments(id, "LINE") {
            let vector = self.arguments(a[2], "VECTOR").unwrap();
            let (p, d) = (Point3::from(self.point(a[1])), Vec3::from(self.point::<3>(vector[1])));
            let size: f64 = vector[2].parse().unwrap();
            return Box::new(move |t| p + d * (size * t));
        }
        if let Some(a) = self.arguments(id, "CIRCLE") {
            let frame = self.arguments(a[1], "AXIS2_PLACEMENT_3D").unwrap();
            let centre = Point3::from(self.point(frame[1]));
            let [z, x] = [frame[2], frame[3]].map(|d| Vec3::from(self.point::<3>(d)));
            let (y, radius): (Vec3, f64) = (z.cross(&x), a[2].parse().unwrap());
            return Box::new(move |t| centre + (x * t.cos() + y * t.sin()) * radius);
        }
        let curve = self.spline::<3>(&self.arguments(id, "B_SPLINE_CURVE_WITH_KNOTS").unwrap());
        Box::new(move |t| curve.point(t))
    }

    fn pcurve(&self, id: &str) -> (&'a str, NurbsCurve2) {
        let a = self.arguments(id, "PCURVE").unwrap();
        let definition = self.arguments(a[2], "DEFINITIONAL_REPRESENTATION").unwrap();
        let curve = definition[1].trim_matches(['(', ')']);
        (a[1], self.spline(&self.arguments(curve, "B_SPLINE_CURVE_WITH_KNOTS").unwrap()))
    }
}

fn split(text: &str) -> Vec<&str> {
    let (mut depth, mut from, mut out) = (0, 0, Vec::new());
    for (k, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 0 => {
                out.push(&text[from..k]);
                from = k + 1;
            }
            _ => {}
        }
    }
    out.push(&text[from..]);
    out
}

/// Holds every parameter curve against its edge; the parameter curves of each edge curve. The scale of a file's second
/// parameter on a cone is the cosine of its angle.
fn checked(faces: &[Face], v_scale: f64) -> Vec<Vec<NurbsCurve2>> {
    let text = step::write(faces, &StepOptions::default()).unwrap();
    let records = Records::new(&text);
    let face_of: HashMap<&str, &Face> = {
        let mut ids: Vec<&str> =
            records.0.keys().copied().filter(|id| records.arguments(id, "ADVANCED_FACE").is_some()).collect();
        ids.sort_by_key(|id| id[1..].parse::<u64>().unwrap());
        let surface = |id: &str| records.arguments(id, "ADVANCED_FACE").unwrap()[2];
        ids.into_iter().map(surface).zip(faces).collect()
    };
    let mut out = Vec::new();
    for id in records.0.keys() {
        let Some((kind, a)) = ["SURFACE_CURVE", "SEAM_CURVE"]
            .into_iter()
            .find_map(|kind| Some((kind, records.arguments(id, kind)?)))
        else {
            continue;
        };
        let way = records.way(a[1]);
        let mut curves = Vec::new();
        for p in split(a[2].trim_matches(['(', ')'])) {
            let (surface, curve) = records.pcurve(p);
            let face = face_of[surface];
            let d = curve.domain();
            for k in 0..=40 {
                let t = d.at(f64::from(k) / 40.0);
                let at = curve.point(t);
                let off = (face.surface.carrier().point(uv(at.x, at.y / v_scale)) - way(t)).norm();
                // Splines keep to the feet within 1e-8 of the face's size, about 10 mm; these edges lie on their faces.
                assert!(off <= 2e-7, "{}: {off} at {t} of {id}", face.id);
            }
            curves.push(curve);
        }
        let on: Vec<&str> =
            split(a[2].trim_matches(['(', ')'])).iter().map(|p| records.pcurve(p).0).collect();
        assert_eq!(kind == "SEAM_CURVE", on.len() == 2 && on[0] == on[1]);
        out.push(curves);
    }
    out
}

#[test]
fn parameter_curves_are_the_edges() {
    // A cylinder's two circles; a block's bore; a sphere needs no edge.
    assert_eq!(checked(&solids::cylinder(), 1.0).len(), 2);
    assert_eq!(checked(&solids::block_with_bore(), 1.0).len(), 2);
    assert_eq!(checked(&solids::sphere(), 1.0).len(), 0);
    let hole = circle(300, [5.0, 5.0, 0.0], 2.0, false);
    let (outer, l) = polygon(200, &part21::SQUARE);
    let face = only_face(&file(&format!(
        "{}{outer}{hole}#400=FACE_BOUND('',#{l},.T.);#401=FACE_BOUND('',#309,.T.);\
         #402=ADVANCED_FACE('',(#400,#401),#120,.T.);",
        flat_patch()
    )));
    let curves = checked(std::slice::from_ref(&face), 1.0);
    // Four sides, straight in the parameters too, and the hole.
    assert_eq!(curves.iter().filter(|c| c[0].degree() == 1).count(), 4);
    assert_eq!(curves.iter().filter(|c| c[0].degree() == 3).count(), 1);
}

#[test]
fn a_cone_is_measured_along_its_axis() {
    // Radius 3 at the bottom, 5 at the height of 2: the half angle is a quarter of a right angle twice.
    let rings = [circle(300, [0.0; 3], 3.0, true), circle(320, [0.0, 0.0, 2.0], 5.0, false)];
    let face = only_face(&file(&format!(
        "#120=CONICAL_SURFACE('',#7,3.,{FRAC_PI_4:?});{}#203=FACE_BOUND('',#309,.T.);#204=FACE_BOUND('',#329,.T.);\
         #402=ADVANCED_FACE('',(#203,#204),#120,.T.);",
        rings.concat()
    )));
    let curves = checked(std::slice::from_ref(&face), FRAC_PI_4.cos());
    let mut heights: Vec<f64> = curves.iter().map(|c| c[0].poles()[0].y).collect();
    heights.sort_by(f64::total_cmp);
    assert!(heights[0].abs() < 1e-12 && (heights[1] - 2.0).abs() < 1e-12, "{heights:?}");
}

#[test]
fn a_seam_has_two_a_period_apart() {
    let rings = [circle(300, [0.0; 3], 3.0, true), circle(320, [0.0, 0.0, 5.0], 3.0, true)];
    let face = only_face(&file(&format!(
        "#120=CYLINDRICAL_SURFACE('',#7,3.);{}#340=VECTOR('',#4,1.);#341=LINE('',#303,#340);\
         #342=EDGE_CURVE('',#304,#324,#341,.T.);#343=ORIENTED_EDGE('',*,*,#342,.T.);\
         #344=ORIENTED_EDGE('',*,*,#342,.F.);#345=ORIENTED_EDGE('',*,*,#325,.F.);\
         #346=EDGE_LOOP('',(#306,#343,#345,#344));#347=FACE_BOUND('',#346,.T.);\
         #402=ADVANCED_FACE('',(#347),#120,.T.);",
        rings.concat()
    )));
    let curves = checked(std::slice::from_ref(&face), 1.0);
    assert_eq!(curves.len(), 3);
    let seam = curves.iter().find(|c| c.len() == 2).unwrap();
    let apart: Vec<f64> = (0..2).map(|k| seam[0].poles()[k].x - seam[1].poles()[k].x).collect();
    assert!(apart.iter().all(|d| (d.abs() - TAU).abs() < 1e-12), "{apart:?}");
}
