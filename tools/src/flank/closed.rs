//! Closed forms of the static deviation: D98's for settings along the rule, and the hyperbolic paraboloid's for three
//! tangencies.
//!
//! Along the rule [D98, 1.2]: a directrix whose projection along the rule is a circle of radius rho, the contact normal of
//! the tool turned by alpha from the directrix' own,
//!
//! ```text
//! eps = R + rho - sign(rho) sqrt(R^2 + rho^2 + 2 R rho cos alpha)
//!     = 4 R s^2 / (1 + k R + sqrt((1 + k R)^2 - 4 k R s^2)),   s = sin(alpha/2), k = 1/rho
//! ```
//!
//! The second form, for convex (k > 0), straight (k = 0) and hollow directrices (k > -1/R), loses no digits.
//!
//! Paraboloid of height h and half twist a at its middle rule: its lines across the rule are straight, so that with
//! `c = cos gamma`, `t = tan a` and q from 0 (middle) to 1 (ends), the square of the height,
//!
//! ```text
//! (h/2) sin gamma (sqrt(c^2 + t^2) + c) = R t                                  three tangencies
//! delta(q) = (R c + (h/2) t q sin gamma) / sqrt(c^2 + t^2 q) - R               exact, lines going on
//! ```
//!
//! As a falls to zero the gouge is `R a^4/32`, the least possible deviation `R a^4/64` and the standard setting's
//! `16/a^2` times the gouge, each with a relative error of the order of a^2.

use osculate_geom::roots::{End, bracketed};
use std::f64::consts::FRAC_PI_2;

/// A rule end under a tool along the rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RuleEnd {
    /// R, mm.
    pub radius_mm: f64,
    /// 1/rho: curvature of the directrix projected along the rule, 1/mm, positive convex.
    pub curvature_per_mm: f64,
    /// alpha: between the tool's contact normal and the directrix' normal, rad.
    pub turn_rad: f64,
}

impl RuleEnd {
    /// eps: how deep the tool cuts below the directrix, mm. Exact where the projection is a circle or straight; for other
    /// directrices the error is of third order in alpha, from the change of curvature along the directrix.
    ///
    /// NaN where the tool does not fit into the hollow.
    #[must_use]
    pub fn depth_mm(&self) -> f64 {
        let kr = self.curvature_per_mm * self.radius_mm;
        let s = (0.5 * self.turn_rad).sin();
        if kr <= -1.0 {
            return f64::NAN;
        }
        let root = ((1.0 + kr) * (1.0 + kr) - 4.0 * kr * s * s).max(0.0).sqrt();
        4.0 * self.radius_mm * s * s / (1.0 + kr + root)
    }
}

/// D98's hyperbolic paraboloid at its middle rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MiddleRule {
    /// h_p, mm.
    pub height_mm: f64,
    /// alpha_0: half the angle between the end normals, rad.
    pub half_twist_rad: f64,
    /// R, mm.
    pub radius_mm: f64,
}

/// Three tangencies at the middle rule.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MiddleThree {
    /// |gamma|, rad.
    pub turn_rad: f64,
    /// Depth of the gouge between the contacts, mm.
    pub depth_mm: f64,
    /// Distance of the contacts from the rule along x, mm: within half the extent they lie on the directrices.
    pub contact_mm: f64,
}

impl MiddleRule {
    /// Depth of the standard setting with distributed error, `R (1 - cos alpha_0)`, mm; exact.
    #[must_use]
    pub fn standard_depth_mm(&self) -> f64 {
        let s = (0.5 * self.half_twist_rad).sin();
        2.0 * self.radius_mm * s * s
    }

    /// delta at the height `share h/2` from the middle, for a turn gamma, mm; the lines across the rule go on as far as
    /// they are needed.
    #[must_use]
    pub fn deviation_mm(&self, turn_rad: f64, share: f64) -> f64 {
        let (sin, c) = turn_rad.sin_cos();
        let t = self.half_twist_rad.tan();
        let q = share * share;
        // (R c + B q) / W - R with W = sqrt(c^2 + t^2 q), without the difference of W and c.
        let w = (c * c + t * t * q).sqrt();
        let rise = 0.5 * self.height_mm * t * q * sin;
        (rise - self.radius_mm * t * t * q / (w + c)) / w
    }

    /// Three tangencies; None where there is no root, the twist being too large for R/h.
    #[must_use]
    pub fn three_tangent(&self) -> Option<MiddleThree> {
        let t = self.half_twist_rad.tan();
        let f = |g: f64| {
            let (sin, c) = g.sin_cos();
            0.5 * self.height_mm * sin * ((c * c + t * t).sqrt() + c) - self.radius_mm * t
        };
        // The left side rises from zero to its only maximum, where s(g) = sin g (sqrt(c^2 + t^2) + c) turns; the root of
        // least turn lies before.
        let turn_back = {
            let slope = |g: f64| {
                let (sin, c) = g.sin_cos();
                let w = (c * c + t * t).sqrt();
                (w + c) * (c - sin * sin / w)
            };
            let ends = (End { x: 0.0, f: slope(0.0) }, End { x: FRAC_PI_2, f: slope(FRAC_PI_2) });
            bracketed(ends.0, ends.1, 1e-15, slope).map_or(FRAC_PI_2, |r| r.x)
        };
        let ends = (End { x: 0.0, f: f(0.0) }, End { x: turn_back, f: f(turn_back) });
        let turn_rad = bracketed(ends.0, ends.1, 1e-16, f).ok()?.x;
        let (sin, c) = turn_rad.sin_cos();
        // d delta/dq = 0 at q = R c/B - 2 c^2/t^2, B = (h/2) t sin gamma. With B from the condition above,
        // R/B = (w + c)/t^2, so that q = c (w - c)/t^2 = c/(w + c).
        let w = (c * c + t * t).sqrt();
        let share = (c / (w + c)).sqrt();
        // Foot on the upper directrix of the common perpendicular with the axis (0, R, 0) + s (-sin, 0, cos).
        let contact_mm = (self.radius_mm * t - 0.5 * self.height_mm * sin * c) / (c * c + t * t);
        Some(MiddleThree {
            turn_rad,
            depth_mm: -self.deviation_mm(turn_rad, share),
            contact_mm: contact_mm.abs(),
        })
    }

    /// `R alpha_0^4 / 32`: depth of three tangencies to leading order, mm.
    #[must_use]
    pub fn leading_depth_mm(&self) -> f64 {
        self.radius_mm * self.half_twist_rad.powi(4) / 32.0
    }

    /// `R alpha_0^4 / 64`: least possible deviation to leading order, mm.
    #[must_use]
    pub fn leading_minimax_mm(&self) -> f64 {
        0.5 * self.leading_depth_mm()
    }

    /// `16 / alpha_0^2`: standard over three tangencies to leading order.
    #[must_use]
    pub fn leading_ratio(&self) -> f64 {
        16.0 / (self.half_twist_rad * self.half_twist_rad)
    }
}
