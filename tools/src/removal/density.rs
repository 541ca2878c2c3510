//! What can hide between samples.
//!
//! Over a plane a pass of a tool of effective radius `rho` leaves the parabola `x^2 / (2 rho)`; over a part
//! whose normal curvature is k (convex positive) `K x^2 / 2` with the relative curvature `K = 1/rho + k`. A
//! point of the face is at most `r = spacing / sqrt(2)` from a sample: half a spacing from a row and half a
//! spacing along it.
//!
//! *Gouge.* At its bottom the standoff is level, so that a sample r away stands higher by at most
//! `K r^2 / 2`: that much of a gouge can be missed. (Between two samples on a line r is half the spacing and
//! this is `K spacing^2 / 8`.) Sharp rims have no K: for a flat end take the radius of its leaned contact.
//!
//! *Scallop.* On a cusp two passes meet at a slope. One that stands H at a sample has its foot
//! `sqrt(2 H / K)` away, and r farther stands `K/2 (r + sqrt(2 H / K))^2`: above H by
//! `r sqrt(2 K H) + K r^2 / 2`. That
//! is the worst case of a single cusp point; cusps are lines, along which some sample lies nearer.

/// How densely a part is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// Largest distance between neighbouring samples, mm.
    pub spacing_mm: f64,
    /// Greatest convex normal curvature at a sample, 1/mm; zero where the part is nowhere convex.
    pub convex_per_mm: f64,
}

/// Bounds on what lies between samples, to leading order in the spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Hidden {
    /// By how much a scallop may be higher than the highest seen, mm.
    pub scallop_mm: f64,
    /// By how much a gouge may be deeper than the deepest seen, mm.
    pub gouge_mm: f64,
}

impl Density {
    /// The bounds for a tool of effective radius `tool_radius_mm` (the radius of the ball, or for leaned
    /// toroidal and flat ends the inverse of [`crate::Lean::tool_curvature`] across the feed) where the
    /// highest standoff seen is `scallop_mm`.
    ///
    /// ```
    /// use osculate_tools::removal::Density;
    /// // On a plane, with a ball of radius 5: where nothing is left at the samples, half a diagonal away r^2 / 2 R may be.
    /// let density = Density { spacing_mm: 0.2, convex_per_mm: 0.0 };
    /// let hidden = density.bound(5.0, 0.0);
    /// let r = 0.1 * 2f64.sqrt();
    /// assert!((hidden.scallop_mm - r * r / 10.0).abs() < 1e-15 && hidden.gouge_mm == hidden.scallop_mm);
    /// ```
    #[must_use]
    pub fn bound(&self, tool_radius_mm: f64, scallop_mm: f64) -> Hidden {
        let relative = 1.0 / tool_radius_mm + self.convex_per_mm;
        let r = self.spacing_mm * std::f64::consts::FRAC_1_SQRT_2;
        let level = 0.5 * relative * r * r;
        Hidden { scallop_mm: level + r * (2.0 * relative * scallop_mm.max(0.0)).sqrt(), gouge_mm: level }
    }

    /// The density of two samplings taken together.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            spacing_mm: self.spacing_mm.max(other.spacing_mm),
            convex_per_mm: self.convex_per_mm.max(other.convex_per_mm),
        }
    }
}
