//! Line, circle, ellipse, parabola and hyperbola as curves, each in the xy plane of its frame.
//!
//! ```text
//! line       O + t d
//! ellipse    O + a cos t x + b sin t y            circle: a = b
//! parabola   O + f t^2 x + 2 f t y                f from the vertex to the focus
//! hyperbola  O + a cosh t x + b sinh t y          one branch
//! ```
//!
//! These are the parametrisations of ISO 10303-42.

use super::{BadSize, Placement, positive};
use crate::curve::{Curve, CurveTaylor};
use crate::domain::Interval;
use crate::point::{Point3, Vec3};
use std::f64::consts::TAU;

/// `range` when it is ascending and without NaN.
fn ascending(range: Interval) -> Result<Interval, BadSize> {
    if range.lo < range.hi {
        Ok(range)
    } else {
        Err(BadSize { what: "the parameter range", need: "ascending", got: range.length() })
    }
}

/// A straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    origin: Point3,
    direction: Vec3,
    range: Interval,
}

impl Line {
    /// `origin + t direction` for t over `range`, which may be infinite.
    ///
    /// # Errors
    /// [`BadSize`] for an origin that is not finite, a direction without length and a range that is not ascending.
    pub fn new(origin: Point3, direction: Vec3, range: Interval) -> Result<Self, BadSize> {
        positive("the length of the direction", direction.norm())?;
        if let Some(got) = origin.iter().find(|c| !c.is_finite()) {
            return Err(BadSize { what: "every coordinate of the origin", need: "finite", got: *got });
        }
        Ok(Self { origin, direction, range: ascending(range)? })
    }

    /// The segment from `a` at 0 to `b` at 1.
    ///
    /// ```
    /// use osculate_geom::{Curve, Point3, analytic::Line};
    /// let edge = Line::segment(Point3::new(0.0, 0.0, 5.0), Point3::new(30.0, 40.0, 5.0))?;
    /// assert_eq!(edge.point(0.5), Point3::new(15.0, 20.0, 5.0));
    /// assert_eq!(edge.jet(0.5).first.norm(), 50.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BadSize`] where the points are one or not finite.
    pub fn segment(a: Point3, b: Point3) -> Result<Self, BadSize> {
        Self::new(a, b - a, Interval::new(0.0, 1.0))
    }
}

impl Curve for Line {
    fn domain(&self) -> Interval {
        self.range
    }
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        CurveTaylor::from_coefficients(t, order, |k| match k {
            0 => (self.origin + self.direction * t).coords,
            1 => self.direction,
            _ => Vec3::zeros(),
        })
    }
}

/// Kinds of conic with their sizes, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConicKind {
    /// An ellipse; a circle where both semi-axes agree.
    Ellipse {
        /// Along x and y, mm.
        semi_axes_mm: [f64; 2],
    },
    /// A parabola that opens along x.
    Parabola {
        /// Distance of vertex and focus, mm.
        focal_mm: f64,
    },
    /// The branch of a hyperbola that opens along x.
    Hyperbola {
        /// Along x and y, mm.
        semi_axes_mm: [f64; 2],
    },
}

/// A conic in the xy plane of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    kind: ConicKind,
    frame: Placement,
    range: Interval,
}

impl Conic {
    /// The conic over a parameter range. An ellipse over a full turn is periodic.
    ///
    /// ```
    /// use osculate_geom::{Curve, Interval, analytic::{Conic, ConicKind, Placement}};
    /// // At its vertex on the x axis an ellipse bends by a / b^2, at that on the y axis by b / a^2.
    /// let kind = ConicKind::Ellipse { semi_axes_mm: [40.0, 20.0] };
    /// let ellipse = Conic::new(kind, Placement::identity(), Interval::new(0.0, std::f64::consts::TAU))?;
    /// assert!((ellipse.jet(0.0).curvature_per_mm()? - 40.0 / 400.0).abs() < 1e-15);
    /// assert!((ellipse.jet(std::f64::consts::FRAC_PI_2).curvature_per_mm()? - 20.0 / 1600.0).abs() < 1e-15);
    /// assert!(ellipse.domain().periodic);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BadSize`] for a size that is not positive, a range that is not ascending, and more than a turn of an ellipse.
    pub fn new(kind: ConicKind, frame: Placement, range: Interval) -> Result<Self, BadSize> {
        let mut range = ascending(range)?;
        match kind {
            ConicKind::Ellipse { semi_axes_mm } => {
                for a in semi_axes_mm {
                    positive("semi_axes_mm", a)?;
                }
                let turn = range.length() / TAU;
                // Rounding of the ends' difference.
                if turn.is_nan() || turn > 1.0 + 1e-12 {
                    return Err(BadSize { what: "the part of a full turn", need: "at most 1", got: turn });
                }
                range.periodic = turn >= 1.0 - 1e-12;
            }
            ConicKind::Parabola { focal_mm } => {
                positive("focal_mm", focal_mm)?;
            }
            ConicKind::Hyperbola { semi_axes_mm } => {
                for a in semi_axes_mm {
                    positive("semi_axes_mm", a)?;
                }
            }
        }
        Ok(Self { kind, frame, range })
    }

    /// The full circle of `radius_mm` about the frame's z axis.
    ///
    /// # Errors
    /// [`BadSize`] for a radius that is not positive.
    pub fn circle(radius_mm: f64, frame: Placement) -> Result<Self, BadSize> {
        let semi_axes_mm = [positive("radius_mm", radius_mm)?; 2];
        Self::new(ConicKind::Ellipse { semi_axes_mm }, frame, Interval::new(0.0, TAU))
    }

    /// Kind and sizes.
    #[must_use]
    pub const fn kind(&self) -> ConicKind {
        self.kind
    }

    /// The frame whose xy plane holds the conic.
    #[must_use]
    pub const fn frame(&self) -> &Placement {
        &self.frame
    }

    /// Derivative k in the frame.
    fn local(&self, t: f64, k: usize) -> Vec3 {
        match self.kind {
            ConicKind::Ellipse { semi_axes_mm: [a, b] } => {
                let (s, c) = t.sin_cos();
                let wave = [c, -s, -c, s];
                Vec3::new(a * wave[k % 4], b * wave[(k + 3) % 4], 0.0)
            }
            ConicKind::Parabola { focal_mm: f } => match k {
                0 => Vec3::new(f * t * t, 2.0 * f * t, 0.0),
                1 => Vec3::new(2.0 * f * t, 2.0 * f, 0.0),
                2 => Vec3::new(2.0 * f, 0.0, 0.0),
                _ => Vec3::zeros(),
            },
            ConicKind::Hyperbola { semi_axes_mm: [a, b] } => {
                let (x, y) = if k.is_multiple_of(2) { (t.cosh(), t.sinh()) } else { (t.sinh(), t.cosh()) };
                Vec3::new(a * x, b * y, 0.0)
            }
        }
    }
}

impl Curve for Conic {
    fn domain(&self) -> Interval {
        self.range
    }
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        let f = &self.frame;
        CurveTaylor::from_derivatives(t, order, |k| self.local(t, k)).mapped(|p| f.point(p), |v| f.vector(v))
    }
    fn breaks(&self) -> Vec<f64> {
        // Every 45 degrees, and where a parabola or hyperbola turns most, so that quadrature converges at once.
        match self.kind {
            ConicKind::Ellipse { .. } => super::angle_breaks(self.range),
            _ if self.range.lo < 0.0 && self.range.hi > 0.0 => vec![self.range.lo, 0.0, self.range.hi],
            _ => vec![self.range.lo, self.range.hi],
        }
    }
}
