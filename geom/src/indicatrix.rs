//! Dupin's indicatrix of a surface and the indicatrix of conformity of part and tool.
//!
//! Polar curves in the tangent plane, with R(d) = 1 / k(d) the signed radius of normal curvature, convex positive:
//!
//! ```text
//! Dupin                r(d) = sqrt |R(d)| sgn R(d)                                         [R97, eq. 51-54]
//! conformity           r(d) = sqrt |R_P(d)| sgn R_P(d) + sqrt |R_T(d)| sgn R_T(d)          [R97, eq. 63]
//! ```
//!
//! R97 prints eq. 57, 58, 61, 62 with `+ M sin 2 xi` for the direction turned by 90 degrees; it must be `- M sin 2 xi`,
//! or k(xi) + k(xi + 90 degrees) is not 2 H. Here both come from one curvature matrix.
//!
//! # What the indicatrix of conformity is said to tell, and what it does
//!
//! R97 says: the most productive feed is orthogonal to the direction in which |r| is smallest. The width of the strip
//! is, to leading order in the tolerance, `2 sqrt(2 h / q(d))` across the feed with q(d) = k_P(d) + k_T(d), so the widest
//! strip lies along the eigenvector of Q = W_P + W_T with the smaller eigenvalue ([`Relative`]). The smallest |r| is that
//! direction for a ball in a concave part, and in general only by chance:
//!
//! - ball, concave part: the same direction;
//! - ball, convex part: |r| is smallest along the *most* convex direction, where the strip is narrowest: 90 degrees off;
//! - other tools: anything, even in a concave part that has its principal directions in common with the tool. With
//!   k_P = (-0.01, -0.02) and k_T = (0.05, 0.1) 1/mm along the same two directions, |r| is (5.53, 3.91) root mm and
//!   points to the second, q is (0.04, 0.08) 1/mm and makes the strip wider along the first by a factor of 1.41.
//!
//! So it is here to be drawn beside Q, with [`Claim::off_rad`] to say how far the two are apart, and not to plan with.
//! What `r = 0` tells is true: there k_P(d) = -k_T(d), the surfaces osculate in that direction.

use crate::forms::{Forms, Principal};
use crate::point::{Unit3, Vec3};
use crate::relative::{Relative, ToolCurvature};
use crate::roots::{FLAT, minimum};

/// The shape of Dupin's indicatrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DupinKind {
    /// Both curvatures of one sign: an ellipse (K > 0).
    Ellipse,
    /// Curvatures of opposite signs: two conjugate hyperbolas, asymptotes along the asymptotic directions (K < 0).
    Hyperbolas,
    /// One curvature is zero: two parallel lines (K = 0).
    ParallelLines,
    /// Both are zero: no indicatrix at all.
    Flat,
}

/// The kind of Dupin's indicatrix; curvatures up to `flat_per_mm` from zero count as zero.
///
/// ```
/// use osculate_geom::indicatrix::{DupinKind, dupin_kind};
/// use osculate_geom::{Surface, analytic::Torus, uv};
/// // A ring is bent one way outside and both ways inside.
/// let ring = Torus::new(200.0, 60.0)?;
/// let kind = |v: f64| ring.jet2(uv(0.0, v)).forms().map(|f| dupin_kind(&f.principal(), 1e-12));
/// assert_eq!(kind(0.0)?, DupinKind::Ellipse);
/// assert_eq!(kind(std::f64::consts::FRAC_PI_2)?, DupinKind::ParallelLines);
/// assert_eq!(kind(std::f64::consts::PI)?, DupinKind::Hyperbolas);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn dupin_kind(k: &Principal, flat_per_mm: f64) -> DupinKind {
    let bent = [k.k_max, k.k_min].map(|x| x.abs() > flat_per_mm);
    match bent {
        [false, false] => DupinKind::Flat,
        [true, true] if k.k_max * k.k_min > 0.0 => DupinKind::Ellipse,
        [true, true] => DupinKind::Hyperbolas,
        _ => DupinKind::ParallelLines,
    }
}

/// `sqrt |R| sgn R` of a curvature, in root mm; infinite where it is zero.
fn root_radius(k_per_mm: f64) -> f64 {
    k_per_mm.signum() / k_per_mm.abs().sqrt()
}

/// Radius of Dupin's indicatrix along a tangent vector, in root mm: negative where the body is hollow, infinite along
/// an asymptotic direction.
#[must_use]
pub fn dupin_root_mm(forms: &Forms, direction: &Vec3) -> f64 {
    root_radius(forms.normal_curvature(direction))
}

/// The indicatrix of conformity of part and tool at a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conformity {
    part: Forms,
    tool: ToolCurvature,
}

/// The direction that R97 claims, beside the one that the strip width has.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Claim {
    /// Tangent along which |r| of the indicatrix is smallest: the widest strip lies along it, by the claim.
    pub across: Unit3,
    /// |r| there, root mm.
    pub radius_root_mm: f64,
    /// Tangent along which the strip is widest to leading order: the eigenvector of Q's smaller eigenvalue.
    pub widest: Unit3,
    /// Angle between the two, from 0 to 90 degrees, rad.
    pub off_rad: f64,
}

/// Directions over half a turn that are looked at for the smallest radius, the least of them settled between its neighbours: the
/// indicatrix has at most eight extremes over a turn.
const DIRECTIONS: usize = 360;

impl Conformity {
    /// The indicatrix of a part's forms and a tool's curvature at the same contact.
    #[must_use]
    pub const fn new(part: Forms, tool: ToolCurvature) -> Self {
        Self { part, tool }
    }

    /// Radius along a tangent vector, root mm [R97, eq. 63]; infinite where part or tool is flat along it.
    #[must_use]
    pub fn root_mm(&self, direction: &Vec3) -> f64 {
        let across = self.part.normal.cross(&self.tool.direction);
        let (c, s) = (direction.dot(&self.tool.direction), direction.dot(&across));
        let r2 = c * c + s * s;
        // A sharp edge has no radius but along itself.
        let along = if c == 0.0 { 0.0 } else { self.tool.along * c * c };
        let tool = root_radius((along + self.tool.across * s * s) / r2);
        root_radius(self.part.normal_curvature(direction)) + tool
    }

    /// Where |r| is smallest, beside the direction of the widest strip.
    #[must_use]
    pub fn claim(&self) -> Claim {
        let [e1, e2] = self.part.frame;
        let tangent = |t: f64| {
            let (s, c) = t.sin_cos();
            Unit3::new_normalize(e1.into_inner() * c + e2.into_inner() * s)
        };
        let size = |t: f64| self.root_mm(&tangent(t)).abs();
        let step = std::f64::consts::PI / DIRECTIONS as f64;
        let mut best = (f64::INFINITY, 0.0);
        for k in 0..DIRECTIONS {
            let t = step * k as f64;
            if size(t) < best.0 {
                best = (size(t), t);
            }
        }
        let across = tangent(minimum([best.1 - step, best.1 + step], FLAT, size).x);
        let widest = Relative::new(&self.part, &self.tool).d_min;
        let off_rad = across.cross(&widest).norm().atan2(across.dot(&widest).abs());
        Claim { across, radius_root_mm: self.root_mm(&across).abs(), widest, off_rad }
    }
}
