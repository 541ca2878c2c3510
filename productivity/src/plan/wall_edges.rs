//! The places of a face's border beyond which the part stands up, and which way lines run along them.
//!
//! Passes between two walls run along them where they run across the direction to the nearest of them, as [`WallEdges::across`] has it.

use osculate_geom::{Jet2, Point3, Unit3, Vec3};

/// Directions to the places of an edge count by this power of one over their distance: one of a straight wall is trusted by
/// [`STRAIGHT`].
const POWER: i32 = 12;
const STRAIGHT: f64 = 5.0 / 6.0;

/// The places of a face's border beyond which the part stands up, for one tool: [`wall_edges`](super::wall_edges).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WallEdges {
    pub(super) points: Vec<Point3>,
}

impl WallEdges {
    /// Whether the part stands up nowhere beside the face.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The direction from a place to the walls around it, in the tangent frame there, and how clearly it is one direction, 0 to 1. It has no
    /// sign: midway between two walls it is that to either.
    #[must_use]
    pub fn across(&self, place: &Point3, frame: &[Unit3; 2]) -> ([f64; 2], f64) {
        // The moments of the directions; scaled by the nearest, so that powers neither vanish nor overflow.
        let away = |p: &Point3| (p - place).norm_squared();
        let nearest = self.points.iter().map(away).fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE);
        let (mut cosine, mut sine, mut all) = (0.0, 0.0, 0.0);
        for p in &self.points {
            let d = p - place;
            let [x, y] = frame.map(|e| d.dot(&e));
            let square = x * x + y * y;
            if square > 0.0 {
                let weight = (nearest / d.norm_squared()).powi(POWER / 2) / square;
                cosine += weight * (x * x - y * y);
                sine += weight * 2.0 * x * y;
                all += weight * square;
            }
        }
        if all > 0.0 {
            let (s, c) = (0.5 * sine.atan2(cosine)).sin_cos();
            ([c, s], (sine.hypot(cosine) / all / STRAIGHT).min(1.0))
        } else {
            ([1.0, 0.0], 0.0)
        }
    }

    /// The direction along the walls around a place, of either sense; None where there is none.
    #[must_use]
    pub fn along(&self, jet: &Jet2) -> Option<Vec3> {
        let forms = jet.forms().ok()?;
        let (across, trust) = self.across(&jet.point, &forms.frame);
        let left = forms.frame[0].into_inner() * across[0] + forms.frame[1].into_inner() * across[1];
        (trust > 0.0).then(|| left.cross(&forms.normal))
    }
}
