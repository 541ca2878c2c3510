//! Convex bodies, and how far two of them are apart.
//!
//! A body is known by its support: the point of it that is farthest along a direction. The distance of two is that of the origin from
//! the differences of their points, which a sequence of simplices of such differences comes near to (Gilbert, Johnson and Keerthi 1988).
//! Every support gives a plane that the differences lie behind, and with it a lower bound; the point of the simplex nearest to the origin
//! gives an upper one. Both come back: nothing rests on a tolerance of the search.

mod crowd;
mod nearest;

use nalgebra::Isometry3;

use crate::point::{Box3, Point3, Unit3, Vec3};
pub use crowd::{Crowd, CrowdError};
use nearest::Simplex;

/// A convex body.
#[derive(Clone, Debug, PartialEq)]
pub enum Convex {
    /// A flat triangle, mm.
    Triangle([Point3; 3]),
    /// All points between these, mm.
    Hull(Vec<Point3>),
    /// A cylinder or a cone, cut off square to its axis.
    Frustum {
        /// The centres of its ends, mm.
        ends: [Point3; 2],
        /// The radii at its ends, mm.
        radii_mm: [f64; 2],
    },
}

/// Between which bounds a distance lies, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// It is not less; zero where the bodies may meet.
    pub least_mm: f64,
    /// It is not more.
    pub most_mm: f64,
}

/// Steps of the search at most: flat bodies take a few, round ones come ten times nearer in about eight.
const MOST_STEPS: usize = 64;

impl Convex {
    /// The box between two corners.
    #[must_use]
    pub fn cuboid(bounds: &Box3) -> Self {
        let corner = |k: usize| {
            let pick = |axis: usize| if k >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
            Point3::new(pick(0), pick(1), pick(2))
        };
        Self::Hull((0..8).map(corner).collect())
    }

    /// A point of the body that is farthest along a direction, of any length.
    #[must_use]
    pub fn support(&self, along: &Vec3) -> Point3 {
        match self {
            Self::Triangle(corners) => farthest(corners, along),
            Self::Hull(points) => farthest(points, along),
            Self::Frustum { ends, radii_mm } => {
                let axis = ends[1] - ends[0];
                let length2 = axis.norm_squared();
                let flat = if length2 > 0.0 { along - axis * (axis.dot(along) / length2) } else { *along };
                // What rounding leaves of a direction along the axis would not be square to it: the centre is as far then.
                let out = flat.try_normalize(SQUARE * along.norm()).unwrap_or_else(Vec3::zeros);
                let rims = [ends[0] + out * radii_mm[0], ends[1] + out * radii_mm[1]];
                farthest(&rims, along)
            }
        }
    }

    /// Whether its points and sizes are numbers, and there is a point at all.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let all = |points: &[Point3]| {
            !points.is_empty() && points.iter().flat_map(|p| p.iter()).all(|x| x.is_finite())
        };
        match self {
            Self::Triangle(corners) => all(corners),
            Self::Hull(points) => all(points),
            Self::Frustum { ends, radii_mm } => {
                all(ends) && radii_mm.iter().all(|r| *r >= 0.0 && r.is_finite())
            }
        }
    }

    /// The box around it.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        let mut bounds = Box3::empty();
        match self {
            Self::Triangle(corners) => corners.iter().for_each(|p| bounds.add(p)),
            Self::Hull(points) => points.iter().for_each(|p| bounds.add(p)),
            Self::Frustum { ends, radii_mm } => {
                let axis = Unit3::try_new(ends[1] - ends[0], f64::MIN_POSITIVE);
                for (end, radius) in ends.iter().zip(radii_mm) {
                    // A disc reaches as far along x as its radius times the sine between x and its axis.
                    let reach = |x: f64| radius * axis.map_or(1.0, |_| (1.0 - x * x).max(0.0).sqrt());
                    let normal = axis.map_or_else(Vec3::zeros, Unit3::into_inner);
                    let half = Vec3::new(reach(normal.x), reach(normal.y), reach(normal.z));
                    bounds.add(&(end - half));
                    bounds.add(&(end + half));
                }
            }
        }
        bounds
    }

    /// How far another body is away that stands at `place` in the frame of this one. The search ends when the bounds are within `share`
    /// of each other, or the lower one is above `enough_mm`.
    ///
    /// ```
    /// use osculate_geom::{Point3, convex::Convex, nalgebra::Isometry3};
    /// // A rod of radius 5 mm along z, and the same beside it at (30, 40): 50 mm between the axes, 40 mm between the sides.
    /// let rod = Convex::Frustum { ends: [Point3::origin(), Point3::new(0.0, 0.0, 80.0)], radii_mm: [5.0, 5.0] };
    /// let d = rod.apart(&rod, &Isometry3::translation(30.0, 40.0, 0.0), 1e-6, f64::INFINITY);
    /// assert!(d.least_mm <= 40.0 + 1e-9 && 40.0 <= d.most_mm + 1e-9 && d.most_mm - d.least_mm < 1e-3);
    /// ```
    #[must_use]
    pub fn apart(&self, other: &Self, place: &Isometry3<f64>, share: f64, enough_mm: f64) -> Apart {
        let difference = |along: &Vec3| -> Vec3 {
            let own = self.support(along);
            let back = place.rotation.inverse() * -along;
            own - place * other.support(&back)
        };
        let mut simplex = Simplex::new(difference(&Vec3::x()));
        let mut least_mm: f64 = 0.0;
        let mut at = simplex.nearest();
        for _ in 0..MOST_STEPS {
            let most_mm = at.norm();
            if most_mm <= TOUCHING_MM {
                return Apart { least_mm: 0.0, most_mm };
            }
            let towards = difference(&-at);
            least_mm = least_mm.max(at.dot(&towards) / most_mm);
            if most_mm - least_mm <= share * most_mm || least_mm >= enough_mm || !simplex.take(towards) {
                return Apart { least_mm, most_mm };
            }
            let next = simplex.nearest();
            // Rounding: no step comes nearer any more.
            if next.norm() >= most_mm {
                return Apart { least_mm, most_mm };
            }
            at = next;
        }
        Apart { least_mm, most_mm: at.norm() }
    }
}

/// A direction that is off an axis by less than this, rad, is along it: a radius of a metre counts a nanometre for that.
const SQUARE: f64 = 1e-9;

/// Bodies nearer than this touch: rounding of coordinates of some metres is below it.
const TOUCHING_MM: f64 = 1e-9;

fn farthest(points: &[Point3], along: &Vec3) -> Point3 {
    let mut best = (f64::NEG_INFINITY, Point3::origin());
    for p in points {
        let far = p.coords.dot(along);
        if far > best.0 {
            best = (far, *p);
        }
    }
    best.1
}
