//! Open rims: where a face ends and no other goes on. Nothing says what lies beneath, so that the material is taken to end there too, along
//! the face's normals, as if a wall stood on the rim.

use osculate_geom::{Point3, Surface, Uv, uv};

/// Steps towards the nearest place of a wall along one chord of the rim.
const STEPS: usize = 4;

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
