//! Open rims: where a face ends and no other goes on. Nothing says what lies beneath, so that the material is taken to end there too, along
//! the face's normals, as if a wall stood on the rim.

use osculate_geom::{Point3, Surface, Uv, uv};
use std::collections::{HashMap, HashSet};

/// Steps towards the nearest place of a wall along one chord of the rim.
const STEPS: usize = 4;

/// Pieces of open rims that are looked at for a place: at a corner two of them are near.
const MOST_RIMS: usize = 4;
/// Boxes in which cells at open rims are found, of those in which rims are: twice as wide as samples are apart.
const NARROW: f64 = 0.25;
/// Points on a chord of an open rim at most: chords of more are no part's.
const MOST_PARTS: f64 = 1e4;

/// A piece of a rim: on a face a polyline in its parameters.
pub(super) struct OpenRim<'a> {
    pub face: u32,
    surface: &'a dyn Surface,
    points: &'a [Uv],
}

impl<'a> OpenRim<'a> {
    /// None where the polyline has no chord.
    pub fn new(face: u32, surface: &'a dyn Surface, points: &'a [Uv]) -> Option<Self> {
        (points.len() > 1).then_some(Self { face, surface, points })
    }

    /// Chords of the polyline.
    pub const fn chords(&self) -> usize {
        self.points.len() - 1
    }

    /// The parameters at a place along the rim, counted in chords.
    fn at(&self, s: f64) -> Uv {
        let s = s.clamp(0.0, self.chords() as f64);
        let k = (s as usize).min(self.chords() - 1);
        let (a, b, t) = (self.points[k], self.points[k + 1], s - k as f64);
        uv(a.u + t * (b.u - a.u), a.v + t * (b.v - a.v))
    }

    /// Whether a place is on the wall: along the rim in chords, and how far beneath it, mm.
    pub fn contains(&self, place: Uv) -> bool {
        (0.0..=self.chords() as f64).contains(&place.u) && place.v >= 0.0
    }

    /// A place of the wall; where the face has no normal, one of the rim.
    pub fn point(&self, place: Uv) -> Point3 {
        let jet = self.surface.jet2(self.at(place.u));
        jet.normal().map_or(jet.point, |n| jet.point - n.into_inner() * place.v)
    }

    /// How far beneath the rim the wall is nearest to a point.
    fn down_mm(&self, s: f64, q: &Point3) -> f64 {
        let jet = self.surface.jet2(self.at(s));
        jet.normal().map_or(0.0, |n| (jet.point - q).dot(&n).max(0.0))
    }

    /// The distance of a point from a place of the wall that is near it, and that place. Along every chord the wall between its ends is
    /// taken as flat, a few times over.
    pub fn nearest(&self, q: &Point3) -> (f64, Uv) {
        let mut best = (f64::INFINITY, uv(0.0, 0.0));
        for k in 0..self.chords() {
            let ends = [k, k + 1].map(|k| k as f64);
            let mut s = ends[0] + 0.5;
            for _ in 0..STEPS {
                let t = self.down_mm(s, q);
                let here = self.point(uv(s, t));
                let along = self.point(uv(ends[1], t)) - self.point(uv(ends[0], t));
                let square = along.norm_squared();
                if square > 0.0 {
                    s = (s + (q - here).dot(&along) / square).clamp(ends[0], ends[1]);
                }
                let place = uv(s, self.down_mm(s, q));
                let mm = (self.point(place) - q).norm();
                if mm < best.0 {
                    best = (mm, place);
                }
            }
        }
        best
    }
}

/// Where open rims are, by their numbers.
pub(super) struct Rims {
    side_mm: f64,
    /// Of each box of space the pieces in it, each with a point on it.
    points: HashMap<[i64; 3], Vec<(u32, Point3)>>,
    /// Boxes a quarter as wide, with a piece in them or next to them.
    beside: HashSet<[i64; 3]>,
}

impl Rims {
    /// In boxes so wide, by points closer together than the narrower boxes are wide.
    pub fn new(rims: &[OpenRim<'_>], side_mm: f64) -> Self {
        let mut out = Self { side_mm, points: HashMap::new(), beside: HashSet::new() };
        let narrow_mm = NARROW * side_mm;
        for (rim, k) in rims.iter().zip(0..) {
            for chord in 0..rim.chords() {
                let point = |t: f64| rim.point(uv(chord as f64 + t, 0.0));
                let parts =
                    (2.0 * (point(1.0) - point(0.0)).norm() / narrow_mm).ceil().clamp(1.0, MOST_PARTS);
                for j in 0..=parts as u32 {
                    let p = point(f64::from(j) / parts);
                    out.points.entry(key(&p, side_mm)).or_default().push((k, p));
                    out.beside.extend(around(&p, narrow_mm));
                }
            }
        }
        out
    }

    /// Whether a rim of a face is this near to a place of it, where that is about as far as the narrower boxes are wide.
    pub fn is_within(&self, rims: &[OpenRim<'_>], (place, face): (&Point3, u32), within_mm: f64) -> bool {
        self.beside.contains(&key(place, NARROW * self.side_mm))
            && self
                .near(rims, (place, face))
                .into_iter()
                .any(|k| rims[k as usize].nearest(place).0 <= within_mm)
    }

    /// The rims of a face that are nearest to a place of it, the nearest first.
    pub fn near(&self, rims: &[OpenRim<'_>], (place, face): (&Point3, u32)) -> Vec<u32> {
        let mut near: Vec<(f64, u32)> = Vec::new();
        for key in around(place, self.side_mm) {
            for (rim, point) in self.points.get(&key).into_iter().flatten() {
                if rims[*rim as usize].face != face {
                    continue;
                }
                let away = (point - place).norm();
                match near.iter_mut().find(|n| n.1 == *rim) {
                    Some(n) => n.0 = n.0.min(away),
                    None => near.push((away, *rim)),
                }
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.into_iter().take(MOST_RIMS).map(|n| n.1).collect()
    }
}

/// The box of space around a point.
pub(super) fn key(p: &Point3, side_mm: f64) -> [i64; 3] {
    // Casting takes what is too far for a whole number to the last one.
    [p.x, p.y, p.z].map(|x| (x / side_mm).floor() as i64)
}

/// That box and those around it.
pub(super) fn around(p: &Point3, side_mm: f64) -> impl Iterator<Item = [i64; 3]> + use<> {
    let [x, y, z] = key(p, side_mm);
    (0..27).map(move |k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1])
}
