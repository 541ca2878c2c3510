//! Samples as first guesses: of each face the one that is nearest to a point.

use super::job::Sample;
use super::rim::{around, key};
use osculate_geom::{Box3, Point3, Uv, Vec3};
use std::collections::HashMap;

/// Samples of a flock at most: those that were added where limits are near crowd together by thousands.
const MOST: usize = 24;

/// Places on a face, and where they are.
type Members = Vec<(Uv, Point3)>;

/// Samples of a face that lie together.
struct Flock {
    face: u32,
    bounds: Box3,
    members: Members,
}

impl Flock {
    /// The members in flocks of [`MOST`] at most, halved across the longest side of their boxes.
    fn halved(face: u32, members: &mut [(Uv, Point3)], out: &mut Vec<Self>) {
        let bounds = Box3::around(members.iter().map(|m| &m.1));
        if members.len() <= MOST {
            out.push(Self { face, bounds, members: members.to_vec() });
            return;
        }
        let axis = (bounds.max - bounds.min).imax();
        let middle = members.len() / 2;
        members.select_nth_unstable_by(middle, |a, b| a.1[axis].total_cmp(&b.1[axis]));
        let (low, high) = members.split_at_mut(middle);
        Self::halved(face, low, out);
        Self::halved(face, high, out);
    }

    /// No member is nearer to a point, mm.
    fn away_mm(&self, q: &Point3) -> f64 {
        let beyond = |k: usize| (self.bounds.min[k] - q[k]).max(q[k] - self.bounds.max[k]).max(0.0);
        Vec3::new(beyond(0), beyond(1), beyond(2)).norm()
    }
}

/// Of each box of space the samples in it.
pub(super) struct Hints {
    side_mm: f64,
    boxes: HashMap<[i64; 3], Vec<Flock>>,
}

/// A sample of a face: how far it is, its face and its place there.
pub(super) type Hint = (f64, u32, Uv);

impl Hints {
    /// The samples on so many faces, found in boxes of this side. Places on fixtures are on no face.
    pub fn new(samples: &[Sample], faces: usize, side_mm: f64) -> Self {
        let mut whole: HashMap<[i64; 3], Vec<(u32, Members)>> = HashMap::new();
        for s in samples.iter().filter(|s| (s.face as usize) < faces) {
            let all = whole.entry(key(&s.point, side_mm)).or_default();
            let place = all.iter().position(|f| f.0 == s.face).unwrap_or_else(|| {
                all.push((s.face, Vec::new()));
                all.len() - 1
            });
            all[place].1.push((s.uv, s.point));
        }
        let flocks = |all: Vec<(u32, Members)>| {
            let mut out = Vec::new();
            all.into_iter().for_each(|(face, mut members)| Flock::halved(face, &mut members, &mut out));
            out
        };
        let boxes = whole.into_iter().map(|(key, all)| (key, flocks(all))).collect();
        Self { side_mm, boxes }
    }

    /// Of each face that has samples in the boxes around a point the one nearest to it, the nearest face first.
    pub fn nearest(&self, q: &Point3) -> Vec<Hint> {
        let mut near: Vec<Hint> = Vec::new();
        for flock in around(q, self.side_mm).filter_map(|key| self.boxes.get(&key)).flatten() {
            let known = near.iter().position(|n| n.1 == flock.face);
            let mut best = known.map_or((f64::INFINITY, flock.face, Uv { u: 0.0, v: 0.0 }), |k| near[k]);
            if flock.away_mm(q) >= best.0 {
                continue;
            }
            for (at, point) in &flock.members {
                let away = (point - q).norm();
                if away < best.0 {
                    best = (away, flock.face, *at);
                }
            }
            match known {
                Some(k) => near[k] = best,
                None => near.push(best),
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Against all samples in the boxes around, one after another; half of them crowd in a corner.
        #[test]
        fn the_nearest_of_each_face_is_found(
            places in prop::collection::vec(prop::array::uniform3(-2.0..2.0_f64), 1..200),
            q in prop::array::uniform3(-2.0..2.0_f64),
        ) {
            let sample = |(k, p): (usize, &[f64; 3])| {
                let p = if k % 2 == 0 { *p } else { p.map(|x| 0.9 + 0.01 * x) };
                let uv = Uv { u: k as f64, v: 0.0 };
                Sample { point: p.into(), normal: Vec3::z_axis(), face: (k % 3) as u32, uv, area_mm2: 1.0, check_only: false }
            };
            let samples: Vec<Sample> = places.iter().enumerate().map(sample).collect();
            let q = Point3::from(q);
            // The third face is no face of the goal.
            let found = Hints::new(&samples, 2, 0.7).nearest(&q);
            let boxes: Vec<[i64; 3]> = around(&q, 0.7).collect();
            for face in 0..3 {
                let own = samples.iter().filter(|s| s.face == face && face < 2 && boxes.contains(&key(&s.point, 0.7)));
                let least = own.map(|s| (s.point - q).norm()).fold(f64::INFINITY, f64::min);
                let hint = found.iter().find(|h| h.1 == face).map_or(f64::INFINITY, |h| h.0);
                prop_assert_eq!(hint, least);
            }
            prop_assert!(found.windows(2).all(|w| w[0].0 <= w[1].0));
        }
    }
}
