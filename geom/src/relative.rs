//! The relative curvature form of part and tool, `Q = W_P + W_T`, at a point of contact.
//!
//! Q decides everything local: no gouging near the contact iff Q is positive semidefinite; the strip left within
//! a small tolerance is widest across the eigenvector of Q's smaller eigenvalue.

use crate::forms::{Forms, SymEigen};
use crate::point::{Unit3, Vec3};
use nalgebra::Matrix2;

/// Principal curvatures of a tool at its contact, convex positive, 1/mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolCurvature {
    /// Along `direction`; infinite on a sharp edge.
    pub along: f64,
    /// Across it; finite.
    pub across: f64,
    /// Unit tangent of `along`.
    pub direction: Unit3,
}

/// The form Q and its eigenvectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relative {
    /// Smaller eigenvalue, 1/mm; negative: the tool digs in along `d_min`.
    pub min: f64,
    /// Larger eigenvalue, 1/mm; infinite for a sharp edge.
    pub max: f64,
    /// Direction of `min`: the widest strip lies along it, the feed goes across it.
    pub d_min: Unit3,
    /// Direction of `max`.
    pub d_max: Unit3,
}

impl Relative {
    /// Q of a part's forms and a tool's curvature at the same contact.
    ///
    /// ```
    /// use osculate_geom::{Relative, Surface, ToolCurvature, analytic::Sphere, uv};
    /// let part = Sphere::new(40.0)?.jet2(uv(0.2, 0.1)).forms()?;
    /// let ball = ToolCurvature { along: 1.0 / 10.0, across: 1.0 / 10.0, direction: part.frame[0] };
    /// let q = Relative::new(&part, &ball);
    /// assert!((q.min - (1.0 / 40.0 + 1.0 / 10.0)).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn new(part: &Forms, tool: &ToolCurvature) -> Self {
        let across = Unit3::new_unchecked(part.normal.cross(&tool.direction));
        if tool.along.is_infinite() {
            // A sharp edge: Q is infinite along the meridian, so the finite eigenvector is across it.
            let min = part.normal_curvature(&across) + tool.across;
            return Self { min, max: f64::INFINITY, d_min: across, d_max: tool.direction };
        }
        let [e1, e2] = part.frame;
        let (c, s) = (tool.direction.dot(&e1), tool.direction.dot(&e2));
        let (a, b) = (tool.along, tool.across);
        let w = part.curvature
            + Matrix2::new(a * c * c + b * s * s, (a - b) * c * s, (a - b) * c * s, a * s * s + b * c * c);
        let eig = SymEigen::of(&w);
        let dir =
            |d: [f64; 2]| -> Unit3 { Unit3::new_normalize(e1.into_inner() * d[0] + e2.into_inner() * d[1]) };
        Self { min: eig.min, max: eig.max, d_min: dir(eig.d_min), d_max: dir(eig.d_max) }
    }

    /// `q(d) = d^T Q d` for a tangent vector, 1/mm; infinite off the finite direction of a sharp edge.
    #[must_use]
    pub fn along(&self, direction: &Vec3) -> f64 {
        let (c, s) = (direction.dot(&self.d_min), direction.dot(&self.d_max));
        let r2 = c * c + s * s;
        let sharp = if s == 0.0 { 0.0 } else { self.max * s * s };
        (self.min * c * c + sharp) / r2
    }
}
