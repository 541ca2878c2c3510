//! Directions to follow over a face: lines of curvature, gradient lines, asymptotic lines.
//!
//! Lines of curvature and asymptotic lines have no sense: the field gives a direction, and who follows it chooses
//! between it and its opposite by the direction it came from.

use osculate_geom::{Forms, Jet2, Principal, Unit3, Vec3};

/// One of the two families of lines of curvature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Along the most convex curvature k_1. In M86's sign, where convex is negative, this is the smaller curvature:
    /// the family recommended for five axes.
    Most,
    /// Along the least convex curvature k_2.
    Least,
}

impl Family {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Most, Self::Least];

    /// The family's curvature and direction.
    #[must_use]
    pub const fn of(self, p: &Principal) -> (f64, Unit3) {
        match self {
            Self::Most => (p.k_max, p.d_max),
            Self::Least => (p.k_min, p.d_min),
        }
    }
}

/// A field of tangent directions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Course {
    /// A principal direction.
    Curvature(Family),
    /// Steepest ascent along an axis. It has a sense; a line is followed both ways all the same.
    Gradient(Unit3),
    /// A direction without normal curvature, where the body is a saddle: turned from the direction of k_1 towards
    /// that of k_2 (`left`) or away from it.
    Asymptotic {
        /// Which of the two.
        left: bool,
    },
}

/// Why a course has no direction at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoCourse {
    /// No tangent plane.
    Degenerate,
    /// All directions are alike: an umbilic, or a horizontal tangent plane.
    Isotropic,
    /// No asymptotic direction: the body is convex or concave.
    Elliptic,
}

/// Directions from a form that is smaller than this part of the largest curvature are rounding.
const ISOTROPIC: f64 = 1e-13;

impl Course {
    /// The unit tangent at a point, in the sense nearest to `before`.
    pub(crate) fn tangent(self, jet: &Jet2, before: Option<&Vec3>) -> Result<(Forms, Unit3), NoCourse> {
        let forms = jet.forms().map_err(|_| NoCourse::Degenerate)?;
        let d = match self {
            Self::Curvature(family) => {
                let p = forms.principal();
                let size = p.k_max.abs().max(p.k_min.abs());
                if p.k_max - p.k_min <= ISOTROPIC * size {
                    return Err(NoCourse::Isotropic);
                }
                family.of(&p).1
            }
            Self::Gradient(axis) => {
                let n = forms.normal.into_inner();
                let up = axis.into_inner() - n * n.dot(&axis);
                let up = Unit3::try_new(up, ISOTROPIC).ok_or(NoCourse::Isotropic)?;
                let against = before.is_some_and(|b| b.dot(&up) < 0.0);
                return Ok((forms, if against { -up } else { up }));
            }
            Self::Asymptotic { left } => {
                let p = forms.principal();
                if !(p.k_max > 0.0 && p.k_min < 0.0) {
                    return Err(NoCourse::Elliptic);
                }
                // k_1 cos^2 + k_2 sin^2 = 0.
                let (s, c) = (p.k_max.sqrt(), (-p.k_min).sqrt());
                let n = forms.normal.into_inner();
                // d_min as d_max turned left, whatever sign the eigenvector came with.
                let across = n.cross(&p.d_max) * if left { 1.0 } else { -1.0 };
                Unit3::new_normalize(p.d_max.into_inner() * c + across * s)
            }
        };
        let against = before.is_some_and(|b| b.dot(&d) < 0.0);
        Ok((forms, if against { -d } else { d }))
    }
}
