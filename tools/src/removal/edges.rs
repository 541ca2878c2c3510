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
/// Pieces of what was taken beneath a sample at first ...
const BENEATH: u32 = 4;
/// ... and places in it that are looked at, at most.
const LOOKS: usize = 128;
/// A face is off a chord of it by so many times what it is off its middle at most.
const BEND: f64 = 2.0;
/// What is said to be deep may be this share of the limit less.
const CLOSE: f64 = 0.02;
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

/// The nearest place of other faces that was found: how far it is, and the face and place on it.
#[derive(Clone, Copy, Debug)]
struct Foot {
    mm: f64,
    on: Option<(u32, Uv)>,
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
        self.foot(q, face, enough_mm).mm
    }

    /// The nearest place of faces other than one of them, in the same way.
    fn foot(&self, q: &Point3, face: u32, enough_mm: f64) -> Foot {
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
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut least = Foot { mm: f64::INFINITY, on: None };
        for (away, other, at) in near {
            let found = nearest(self.surfaces[other as usize], at, q);
            for (mm, at) in [(away, at), found] {
                if mm < least.mm {
                    least = Foot { mm, on: Some((other, at)) };
                }
            }
            if least.mm < enough_mm {
                break;
            }
        }
        least
    }

    /// The greatest depth between two depths along the normal, with their feet. Over the depth t the depth is that of `min(t, d(t))`. d, a
    /// distance, changes no faster than t: it is nowhere more than half of the sum of both and of the way between them. Where both feet
    /// are on one face the points of the chord between these are no farther than the farther of the two, and the face is off the
    /// chord by no more than twice what it is off its middle, if it bends about evenly.
    fn most_mm(&self, [a, b]: [&(f64, Foot); 2]) -> f64 {
        let slow = 0.5 * (a.1.mm + b.1.mm + b.0 - a.0);
        let beside = match (a.1.on, b.1.on) {
            (Some((face, from)), Some((other, to))) if face == other => {
                let surface = self.surfaces[face as usize];
                let (p, q) = (surface.point(from), surface.point(to));
                let middle = p + 0.5 * (q - p);
                let start = Uv { u: 0.5 * (from.u + to.u), v: 0.5 * (from.v + to.v) };
                a.1.mm.max(b.1.mm) + BEND * nearest(surface, start, &middle).0
            }
            _ => f64::INFINITY,
        };
        b.0.min(slow).min(beside)
    }

    /// How deep the deepest point beneath a sample is that was taken, where the tool went so far along its normal: no less, and more by
    /// a share of the limit at most, as long as looks suffice.
    fn depth_mm(&self, s: &Sample, along_mm: f64, limit_mm: f64) -> f64 {
        let look = |t: f64| (t, self.foot(&(s.point - s.normal.into_inner() * t), s.face, 0.0));
        let places: Vec<(f64, Foot)> =
            (0..=BENEATH).map(|k| look(along_mm * f64::from(k) / f64::from(BENEATH))).collect();
        let piece = |a: (f64, Foot), b: (f64, Foot)| (self.most_mm([&a, &b]), a, b);
        let mut pieces: Vec<_> = places.windows(2).map(|w| piece(w[0], w[1])).collect();
        let mut found = places.iter().map(|p| p.0.min(p.1.mm)).fold(0.0, f64::max);
        for _ in places.len()..LOOKS {
            let highest = (0..pieces.len()).max_by(|a, b| pieces[*a].0.total_cmp(&pieces[*b].0));
            let Some(k) = highest.filter(|k| pieces[*k].0 > found + CLOSE * limit_mm) else { break };
            let (_, a, b) = pieces[k];
            let middle = look(0.5 * (a.0 + b.0));
            found = found.max(middle.0.min(middle.1.mm));
            pieces[k] = piece(a, middle);
            pieces.push(piece(middle, b));
        }
        pieces.iter().map(|p| p.0).fold(found, f64::max)
    }

    /// Measures anew what seems deeper than a share of a limit.
    pub fn measure(&self, samples: &[Sample], cuts: &mut [Cut], limit_mm: f64) {
        let deep = samples.iter().zip(cuts).filter(|(_, c)| -c.standoff_mm > DEEP * limit_mm);
        for (s, c) in deep.take(MOST) {
            let along_mm = limit_mm.min(-c.standoff_mm);
            let own = (s.face as usize) < self.surfaces.len();
            if own && self.is_beside((&s.point, &s.normal), s.face, along_mm) {
                c.standoff_mm = -self.depth_mm(s, -c.standoff_mm, limit_mm);
            }
        }
    }
}

/// The distance of a point from the place of a face that Newton's method comes to from a place near it, and that place; infinite where
/// it is not on the face.
fn nearest(surface: &dyn Surface, from: Uv, q: &Point3) -> (f64, Uv) {
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
    (if surface.contains(at) { (surface.point(at) - q).norm() } else { f64::INFINITY }, at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::{Cylinder, Placed, Placement, Plane};
    use osculate_geom::{Domain, Interval, Vec3, uv};
    use proptest::prelude::*;

    proptest! {
        /// Beneath a place beside the edge of two planes at any angle, against the distance from the other plane.
        #[test]
        fn depths_beside_an_edge_are_no_less_than_the_closed_form(
            inner_rad in 0.3..2.9f64,
            e in 0.01..0.4f64,
            along in 0.02..0.8f64,
            limit in 0.01..0.2f64,
        ) {
            let i = Interval::new(0.0, 6.0);
            let flat = Plane::new(Domain { u: i, v: i });
            // The other plane goes down from the edge at x = 6, the material between them.
            let (sin, cos) = inner_rad.sin_cos();
            let (down, out) = (Vec3::new(-cos, 0.0, -sin), Vec3::new(sin, 0.0, -cos));
            let at = Placement::new(Point3::new(6.0, 0.0, 0.0), Unit3::new_normalize(out), Some(down));
            let wall = Placed { surface: flat, placement: at };
            let surfaces: [&dyn Surface; 2] = [&flat, &wall];
            let sample = |face: u32, at: Uv| {
                let jet = surfaces[face as usize].jet2(at);
                let normal = if face == 0 { Vec3::z_axis() } else { Unit3::new_normalize(out) };
                Sample { point: jet.point, normal, face, uv: at, area_mm2: 0.01, check_only: false }
            };
            let own = sample(0, uv(6.0 - e, 3.0));
            prop_assert!((own.point - Point3::new(6.0 - e, 3.0, 0.0)).norm() < 1e-12);
            let mut samples = vec![own];
            for k in 0..60 {
                for j in 25..36 {
                    let s = sample(1, uv(0.1 * f64::from(k), 0.1 * f64::from(j)));
                    prop_assert!(s.point.z < 1e-9);
                    samples.push(s);
                }
            }
            let edges = Edges::new(&surfaces, &samples, 1.0);
            let found = edges.depth_mm(&own, along, limit);
            let beneath = |t: f64| t.min((e * sin - t * cos).abs());
            let want = (0..=20_000).map(|k| beneath(along * f64::from(k) / 2e4)).fold(0.0, f64::max);
            prop_assert!(found >= want - 1e-9, "{found} of {want}");
            prop_assert!(found <= want + CLOSE * limit + 1e-9, "{found} of {want}");
        }
    }

    /// A flat end goes flush over a face, round or not, and far beyond its edge: beneath the rim of the wall nothing is taken, however far
    /// that goes along the wall's normal.
    #[test]
    fn what_is_flush_is_not_deep() {
        let i = Interval::new(0.0, 6.0);
        let flat = Plane::new(Domain { u: i, v: i });
        let round = Cylinder::new(20.0, i).unwrap();
        // The wall x = 0 below the plane, and that across the cylinder at its end.
        let down = Placement::new(Point3::origin(), -Vec3::x_axis(), Some(-Vec3::z()));
        let wall = Placed { surface: flat, placement: down };
        let end = Plane::new(Domain { u: Interval::new(-20.0, 20.0), v: Interval::new(-20.0, 20.0) });
        for (other, own, normal, rim) in [
            (&flat as &dyn Surface, &wall as &dyn Surface, -Vec3::x_axis(), Point3::new(0.0, 3.0, 0.0)),
            (&round, &end, -Vec3::z_axis(), Point3::new(20.0, 0.0, 0.0)),
        ] {
            let surfaces = [own, other];
            let d = other.domain();
            let mut samples = Vec::new();
            for k in 0..=120 {
                for j in 0..=120 {
                    let at = d.at(f64::from(k) / 120.0, f64::from(j) / 120.0);
                    let jet = other.jet2(at);
                    samples.push(Sample {
                        point: jet.point,
                        normal,
                        face: 1,
                        uv: at,
                        area_mm2: 0.01,
                        check_only: false,
                    });
                }
            }
            let s =
                Sample { point: rim, normal, face: 0, uv: uv(0.0, 0.0), area_mm2: 0.01, check_only: false };
            let found = Edges::new(&surfaces, &samples, 1.5).depth_mm(&s, 4.0, 0.01);
            assert!(found <= CLOSE * 0.01, "{found}");
        }
    }
}
