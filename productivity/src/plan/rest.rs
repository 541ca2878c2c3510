//! Passes where earlier tools left material, and nowhere else.
//!
//! The places that stand too high come from a verdict on what was cut so far. A station of a pass remains where such a place lies in its
//! strip, or no further beside it than an overlap. What lies between two stretches that remain is cut along where that is shorter than a hop
//! over it.

use super::stations::{Stretches, pieces, stations};
use super::{CcPoint, Pass};
use osculate_geom::Point3;
use osculate_tools::reach::{ObstacleKind, ObstaclePoint, Obstacles, ObstaclesError};
use rayon::prelude::*;

/// Distance of stations along a pass, of the overlap and of the widest strip, whichever is less.
const STEP: f64 = 0.25;
/// Stretches that are no longer than this many hops are cut along.
const BRIDGED: f64 = 2.0;

/// What is to be cut again. Lengths mm.
#[derive(Clone, Copy, Debug)]
pub struct Rest<'a> {
    /// Places of the faces that stand too high.
    pub places: &'a [Point3],
    /// How far beyond them passes go on.
    pub overlap_mm: f64,
    /// How high a hop from one stretch to the next goes.
    pub hop_mm: f64,
}

/// Why places say nothing about passes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RestError {
    /// An overlap or a hop that is none.
    #[error("{what} must be positive and finite, got {got} mm")]
    Length {
        /// Which.
        what: &'static str,
        /// The value, mm.
        got: f64,
    },
    /// A place that is none.
    #[error(transparent)]
    Places(#[from] ObstaclesError),
}

/// The passes as far as they cut what stands too high.
///
/// # Errors
/// Lengths that are not positive, places that are not finite.
pub fn rest_of(passes: &[Pass], rest: &Rest<'_>) -> Result<Stretches, RestError> {
    for (what, got) in [("the overlap of rest passes", rest.overlap_mm), ("the height of a hop", rest.hop_mm)]
    {
        if !(got > 0.0 && got.is_finite()) {
            return Err(RestError::Length { what, got });
        }
    }
    let point = |(p, owner): (&Point3, u32)| ObstaclePoint { point: *p, owner, kind: ObstacleKind::Part };
    let places = Obstacles::new(rest.places.iter().zip(0u32..).map(point))?;
    let each: Vec<Stretches> = passes.par_iter().map(|p| remaining(p, rest, &places)).collect();
    Ok(each.into_iter().collect())
}

fn remaining(pass: &Pass, rest: &Rest<'_>, places: &Obstacles) -> Stretches {
    let widest = pass.points.iter().map(|p| p.width_mm).fold(0.0, f64::max);
    let step = STEP * if widest > 0.0 { rest.overlap_mm.min(widest) } else { rest.overlap_mm };
    let stations = stations(pass, step);
    let cuts = |at: &CcPoint| places.is_near(&at.point, 0.5 * at.width_mm.max(0.0) + rest.overlap_mm);
    let mut out: Vec<bool> = stations.iter().map(|s| !cuts(&s.point)).collect();
    bridge(&mut out, &stations.iter().map(|s| s.point.point).collect::<Vec<_>>(), BRIDGED * rest.hop_mm);
    if !out.iter().any(|o| *o) {
        return vec![pass.clone()].into();
    }
    pieces(pass, &stations, &out, 0.0)
}

/// Takes in what lies between two stretches and is no longer than `most_mm`.
fn bridge(out: &mut [bool], at: &[Point3], most_mm: f64) {
    let mut from: Option<usize> = None;
    for k in 0..out.len() {
        if out[k] {
            continue;
        }
        if let Some(last) = from {
            let length: f64 = at[last..=k].windows(2).map(|w| (w[1] - w[0]).norm()).sum();
            if length <= most_mm {
                out[last..k].fill(false);
            }
        }
        from = Some(k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Unit3, Vec3, uv};
    use osculate_tools::Pose;
    use proptest::prelude::*;

    /// A pass along x with points a millimetre apart.
    fn straight(y: f64, length_mm: usize, width_mm: f64) -> Pass {
        let at = |k: usize| {
            let point = Point3::new(k as f64, y, 0.0);
            let (normal, axis) = (Vec3::z_axis(), Unit3::new_normalize(Vec3::new(0.1, 0.0, 1.0)));
            let pose = Pose { tip: point, axis };
            CcPoint { uv: uv(k as f64, y), point, normal, pose, width_mm }
        };
        Pass { points: (0..=length_mm).map(at).collect(), closed: false }
    }

    proptest! {
        /// Every place within reach of a pass is within reach of what remains, and what remains is near a place all along but for
        /// what is bridged.
        #[test]
        fn what_remains_is_where_places_are(
            places in proptest::collection::vec((0.0..100.0f64, -3.0..3.0f64), 1..12),
            width in 0.2..2.0f64,
            overlap in 0.2..2.0f64,
            hop in 0.1..3.0f64,
        ) {
            let places: Vec<Point3> = places.into_iter().map(|(x, y)| Point3::new(x, y, 0.0)).collect();
            let pass = straight(0.0, 100, width);
            let got = rest_of(std::slice::from_ref(&pass), &Rest { places: &places, overlap_mm: overlap, hop_mm: hop }).unwrap().passes;
            let reach = 0.5 * width + overlap;
            // Ends lie on stations.
            let slack = STEP * overlap.min(width) + 1e-9;
            let covers = |x: f64| got.iter().any(|p| {
                let (a, b) = (p.points[0].point.x, p.points[p.points.len() - 1].point.x);
                a - slack <= x && x <= b + slack
            });
            let mut x = 0.0;
            while x <= 100.0 {
                let near = |by: f64| places.iter().any(|p| (p - Point3::new(x, 0.0, 0.0)).norm() <= by);
                if near(reach - slack) {
                    prop_assert!(covers(x), "{x} is left out");
                }
                // Somewhere within half a bridge there is a place.
                if got.iter().any(|p| p.points[0].point.x <= x && x <= p.points[p.points.len() - 1].point.x) {
                    prop_assert!(near(reach + slack + BRIDGED * hop), "{x} is cut for nothing");
                }
                x += 0.05;
            }
        }
    }

    /// Three-axis passes do not know their strips: they are cut where places are no farther than the overlap.
    #[test]
    fn passes_without_strips_remain_where_places_are() {
        let pass = straight(0.0, 100, f64::NAN);
        let places = [Point3::new(20.0, 0.1, 0.0), Point3::new(70.0, 0.0, 0.0)];
        let got = rest_of(&[pass], &Rest { places: &places, overlap_mm: 0.5, hop_mm: 0.3 }).unwrap().passes;
        let ends: Vec<[f64; 2]> =
            got.iter().map(|p| [p.points[0].point.x, p.points[p.points.len() - 1].point.x]).collect();
        assert_eq!(got.len(), 2, "{ends:?}");
        for (at, [a, b]) in places.iter().zip(ends) {
            assert!(a < at.x && at.x < b && b - a <= 1.01, "{a} {b}");
        }
    }

    #[test]
    fn without_places_nothing_remains_and_with_all_of_them_everything() {
        let passes = [straight(0.0, 10, 1.0), straight(1.0, 10, 1.0)];
        let rest = |places: &[Point3]| {
            rest_of(&passes, &Rest { places, overlap_mm: 0.5, hop_mm: 0.3 }).unwrap().passes
        };
        assert!(rest(&[]).is_empty());
        let all: Vec<Point3> = (0..=20).map(|k| Point3::new(0.5 * f64::from(k), 0.5, 0.0)).collect();
        assert_eq!(rest(&all), passes);
    }

    #[test]
    fn lengths_that_are_none_are_refused() {
        for (overlap_mm, hop_mm) in [(0.0, 1.0), (f64::NAN, 1.0), (1.0, -1.0), (1.0, f64::INFINITY)] {
            let got = rest_of(&[], &Rest { places: &[], overlap_mm, hop_mm });
            assert!(matches!(got, Err(RestError::Length { .. })), "{got:?}");
        }
    }
}
