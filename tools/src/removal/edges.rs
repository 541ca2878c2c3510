//! Places beside sharp outer edges, where a depth along one face's normal says nothing.
//!
//! A gouge is deeper than h where the tool takes a point of the part that is farther than h from all of its faces. Along the normal
//! of a face this is read off by how far the tool goes beneath a sample, but for samples beside an outer edge: there the points
//! beneath lie next to the other face as well. A tool that goes a thousandth too deep over a face takes nearly a tenth of a
//! millimetre from the rim of the wall below it, as measured along the wall's normal, and no point of that is deeper than the
//! thousandth. So such places are measured by the distance from the other face too. Distances are to points that were found on
//! the other faces: they are never too small, and neither are depths. At inner and at smooth edges nothing changes.

use super::job::{Cut, Sample};
use osculate_geom::{Point3, Surface, Unit3, Uv};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::OnceLock;

/// What lies beneath is nearer to another face than this share of the depth that is asked for; at an inner edge it is as far.
const NEARER: f64 = 0.999;
/// Steps towards the nearest point of another face.
const STEPS: usize = 8;
/// Places along what was taken beneath a sample.
const BENEATH: u32 = 8;
/// Depths below this share of the limit are left as they seem.
const DEEP: f64 = 0.25;
/// Samples that are measured anew at most: beyond it a program is far off wherever it goes.
const MOST: usize = 50_000;

/// Which samples lie beside a sharp outer edge: what lies so far beneath them, along their normals, is nearer to another of the faces,
/// so that a tool there takes nothing that deep, whatever its depth along the normal. Samples name their faces by number, and are no
/// farther apart than `apart_mm`.
#[must_use]
pub fn beside_edges(
    surfaces: &[&dyn Surface],
    samples: &[Sample],
    apart_mm: f64,
    depth_mm: impl Fn(&Sample) -> f64 + Sync,
) -> Vec<bool> {
    let edges = Edges::new(surfaces, samples, apart_mm);
    samples.par_iter().map(|s| edges.is_beside((&s.point, &s.normal), s.face, depth_mm(s))).collect()
}

/// Of each box of space the samples in it: face and place on it.
type Hints = HashMap<[i64; 3], Vec<(u32, Uv, Point3)>>;

/// All faces of a goal, found by place.
pub(super) struct Edges<'a> {
    surfaces: &'a [&'a dyn Surface],
    samples: &'a [Sample],
    side_mm: f64,
    /// Made when they are first asked for: where nothing is deep, nobody asks.
    hints: OnceLock<Hints>,
}

impl<'a> Edges<'a> {
    /// Faces by number, with samples that are no farther apart than this.
    pub const fn new(surfaces: &'a [&'a dyn Surface], samples: &'a [Sample], apart_mm: f64) -> Self {
        Self { surfaces, samples, side_mm: 2.0 * apart_mm, hints: OnceLock::new() }
    }

    fn hints(&self) -> &Hints {
        self.hints.get_or_init(|| {
            let mut out = Hints::new();
            // Places on fixtures are on no face.
            for s in self.samples.iter().filter(|s| (s.face as usize) < self.surfaces.len()) {
                out.entry(self.key(&s.point)).or_default().push((s.face, s.uv, s.point));
            }
            out
        })
    }

    fn key(&self, p: &Point3) -> [i64; 3] {
        // Casting takes what is too far for a whole number to the last one.
        [p.x, p.y, p.z].map(|x| (x / self.side_mm).floor() as i64)
    }

    /// Whether the point so far beneath a place of a face lies nearer than that to another face.
    pub fn is_beside(&self, (place, normal): (&Point3, &Unit3), face: u32, depth_mm: f64) -> bool {
        let beneath = place - normal.into_inner() * depth_mm;
        self.distance_mm(&beneath, face, NEARER * depth_mm) < NEARER * depth_mm
    }

    /// The distance of a point from faces other than one of them, as far as it is found; looking ends where it is below `enough_mm`.
    fn distance_mm(&self, q: &Point3, face: u32, enough_mm: f64) -> f64 {
        let mut near = self.around(q, face);
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut least = f64::INFINITY;
        for (away, other, at) in near {
            least = least.min(away).min(nearest_mm(self.surfaces[other as usize], at, q));
            if least < enough_mm {
                break;
            }
        }
        least
    }

    /// Of each face around a point but one, the nearest sample: its distance, its face, its place.
    fn around(&self, q: &Point3, face: u32) -> Vec<(f64, u32, Uv)> {
        let [x, y, z] = self.key(q);
        let hints = self.hints();
        // Of each face around, the nearest sample.
        let mut near: Vec<(f64, u32, Uv)> = Vec::new();
        for key in
            (-1..=1).flat_map(|i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [x + i, y + j, z + k])))
        {
            for (other, at, point) in hints.get(&key).into_iter().flatten() {
                if *other == face {
                    continue;
                }
                let away = (point - q).norm();
                match near.iter_mut().find(|n| n.1 == *other) {
                    Some(n) if away < n.0 => *n = (away, *other, *at),
                    Some(_) => {}
                    None => near.push((away, *other, *at)),
                }
            }
        }
        near
    }

    /// Whether a sample lies within a range of depths beneath another of the first so many faces, as places of faces that are moved out do
    /// beside inner edges: no surface of what is left goes through it. What lies deeper is on the far side of a wall.
    pub fn is_beneath(&self, s: &Sample, faces: usize, [least_mm, most_mm]: [f64; 2]) -> bool {
        self.around(&s.point, s.face).into_iter().filter(|near| (near.1 as usize) < faces).any(|(_, face, at)| {
            let surface = self.surfaces[face as usize];
            let foot = nearest(surface, at, &s.point);
            let jet = surface.jet2(foot);
            let beneath = |normal: Unit3| (least_mm..most_mm).contains(&(jet.point - s.point).dot(&normal));
            surface.contains(foot) && jet.normal().is_ok_and(beneath)
        })
    }

    /// How deep the deepest point beneath a sample is that was taken, where the tool went so far along its normal.
    fn depth_mm(&self, s: &Sample, along_mm: f64) -> f64 {
        let each = (1..=BENEATH).map(|k| {
            let t = along_mm * f64::from(k) / f64::from(BENEATH);
            t.min(self.distance_mm(&(s.point - s.normal.into_inner() * t), s.face, 0.0))
        });
        each.fold(0.0, f64::max)
    }

    /// Measures anew what seems deeper than a share of a limit.
    pub fn measure(&self, samples: &[Sample], cuts: &mut [Cut], limit_mm: f64) {
        let deep = samples.iter().zip(cuts).filter(|(_, c)| -c.standoff_mm > DEEP * limit_mm);
        for (s, c) in deep.take(MOST) {
            let along_mm = limit_mm.min(-c.standoff_mm);
            let own = (s.face as usize) < self.surfaces.len();
            if own && self.is_beside((&s.point, &s.normal), s.face, along_mm) {
                c.standoff_mm = -self.depth_mm(s, -c.standoff_mm);
            }
        }
    }
}

/// The distance of a point from the place of a face that Newton's method comes to from a place near it; infinite where that is
/// not on the face.
fn nearest_mm(surface: &dyn Surface, from: Uv, q: &Point3) -> f64 {
    let at = nearest(surface, from, q);
    if surface.contains(at) { (surface.point(at) - q).norm() } else { f64::INFINITY }
}

/// The place of a face that Newton's method comes to from a place near it, on its way to the nearest to a point.
fn nearest(surface: &dyn Surface, from: Uv, q: &Point3) -> Uv {
    let domain = surface.domain();
    let mut at = from;
    for _ in 0..STEPS {
        let jet = surface.jet2(at);
        let off = q - jet.point;
        let (a, b, c) = (jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared());
        let (e, f) = (off.dot(&jet.du), off.dot(&jet.dv));
        let det = a * c - b * b;
        if det.is_nan() || det <= 0.0 {
            break;
        }
        let next = domain.bring(Uv { u: at.u + (e * c - f * b) / det, v: at.v + (f * a - e * b) / det });
        if next == at {
            break;
        }
        at = next;
    }
    at
}
