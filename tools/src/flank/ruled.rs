//! The ruled strip between two directrices, as a surface and as a family of rules.

use super::directrix::{CurveJet2, Directrix, Source};
use super::rule::{Rule, RuleError};
use osculate_geom::roots::{FLAT, minimum};
use osculate_geom::{
    Axis, Curve, Domain, Interval, Jet2, Point3, Series, Side, Surface, Taylor, Uv, Vec3, uv,
};

/// Why two directrices make no strip.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RuledError {
    /// A directrix without ends.
    #[error("directrix {end} over [{lo}, {hi}] has no two ends")]
    Unlimited {
        /// 0 or 1.
        end: usize,
        /// Lower end of its domain.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
    /// A point of a directrix is not finite.
    #[error("directrix {end} has no point at u = {u}")]
    NotFinite {
        /// 0 or 1.
        end: usize,
        /// Parameter of the strip.
        u: f64,
    },
    /// The directrices meet or cross, or come nearer than asked for.
    #[error(
        "the directrices come within {length_mm:.3e} mm of each other at u = {u}; a rule must be at least {least_mm:.3e} mm long"
    )]
    Crossing {
        /// Parameter of the strip.
        u: f64,
        /// Length of the rule there, mm.
        length_mm: f64,
        /// Least length asked for, mm.
        least_mm: f64,
    },
    /// The least length of a rule is no positive number.
    #[error("the least length of a rule is {least_mm} mm; it must be positive and finite")]
    LeastLength {
        /// The value given.
        least_mm: f64,
    },
}

/// Rules looked at between two breaks for the shortest one.
const LOOKS: usize = 48;

/// A ruled surface `S(u, v) = (1 - v) C0(u) + v C1(u)`, v from 0 to 1, with the side that the tool is on.
///
/// u is the parameter of the first directrix; that of the second one runs proportionally over its own domain. Beyond the
/// ends in u the strip goes on as the Taylor polynomials of its directrices do.
///
/// ```
/// use osculate_geom::{Point3, Side, Vec3, analytic::Line};
/// use osculate_tools::flank::{RuledError, RuledStrip};
/// let edge = |z: f64| Line::segment(Point3::new(0.0, 0.0, z), Point3::new(50.0, 0.0, z));
/// let wall = RuledStrip::new(edge(0.0)?, edge(30.0)?, Side::Along, 1.0)?;
/// let rule = wall.rule(0.5)?;
/// assert_eq!((rule.length_mm, rule.frame.z), (30.0, Vec3::z()));
/// // The tool is on the side of S_u x S_v, here x cross z: towards -y.
/// assert_eq!(rule.frame.y, -Vec3::y());
/// // Directrices that meet make no strip.
/// assert!(matches!(RuledStrip::new(edge(0.0)?, edge(0.0)?, Side::Along, 1.0), Err(RuledError::Crossing { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RuledStrip<'a> {
    directrices: [Directrix<'a>; 2],
    domain: Interval,
    side: Side,
}

impl std::fmt::Debug for RuledStrip<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RuledStrip")
            .field("domain", &self.domain)
            .field("side", &self.side)
            .finish_non_exhaustive()
    }
}

impl<'a> RuledStrip<'a> {
    /// The strip between two curves with ends, whose rules are all longer than `least_mm`.
    ///
    /// The shortest rule is looked for between breaks and closed in on, so that directrices that cross between two looks
    /// are found.
    ///
    /// # Errors
    /// [`RuledError`].
    pub fn new(
        at_zero: impl Curve + 'a,
        at_one: impl Curve + 'a,
        side: Side,
        least_mm: f64,
    ) -> Result<Self, RuledError> {
        Self::of([Source::Curve(Box::new(at_zero)), Source::Curve(Box::new(at_one))], side, least_mm)
    }

    /// The strip between the two borders of a surface across which the other parameter runs: `along` is the parameter
    /// that becomes u. The surface's own points between the borders are not looked at.
    ///
    /// The side is the surface's: the tool is where its outward normal points.
    ///
    /// # Errors
    /// [`RuledError`].
    pub fn between_borders(surface: &'a dyn Surface, along: Axis, least_mm: f64) -> Result<Self, RuledError> {
        let across = surface.domain().get(along.other());
        let middle = surface.domain().at(0.5, 0.5);
        let side = surface.taylor(middle, 0).side;
        let border = |fixed: f64| Source::Border { surface, along, fixed };
        // u x v keeps its sense only where u stays first.
        let side = if along == Axis::U { side } else { side.flipped() };
        Self::of([border(across.lo), border(across.hi)], side, least_mm)
    }

    fn of(sources: [Source<'a>; 2], side: Side, least_mm: f64) -> Result<Self, RuledError> {
        if !(least_mm > 0.0 && least_mm.is_finite()) {
            return Err(RuledError::LeastLength { least_mm });
        }
        let domains = [0, 1].map(|k: usize| sources[k].domain());
        for (end, d) in domains.iter().enumerate() {
            if !(d.length() > 0.0 && d.length().is_finite()) {
                return Err(RuledError::Unlimited { end, lo: d.lo, hi: d.hi });
            }
        }
        let domain = Interval { periodic: domains[0].periodic && domains[1].periodic, ..domains[0] };
        let strip = Self { directrices: sources.map(|s| Directrix::new(s, domain)), domain, side };
        let short = strip.shortest()?;
        if short.1 < least_mm {
            return Err(RuledError::Crossing { u: short.0, length_mm: short.1, least_mm });
        }
        Ok(strip)
    }

    /// Parameter and length of the shortest rule, mm.
    fn shortest(&self) -> Result<(f64, f64), RuledError> {
        let length = |u: f64| {
            let [a, b] = [0, 1].map(|k: usize| self.directrices[k].point(u));
            match [a, b].iter().position(|p| p.iter().any(|c| !c.is_finite())) {
                Some(end) => Err(RuledError::NotFinite { end, u }),
                None => Ok((b - a).norm()),
            }
        };
        let mut best = (self.domain.lo, f64::INFINITY);
        for w in Surface::breaks(self, Axis::U).windows(2) {
            let at = |k: usize| w[0] + (w[1] - w[0]) * k as f64 / LOOKS as f64;
            let seen: Result<Vec<f64>, RuledError> = (0..=LOOKS).map(|k| length(at(k))).collect();
            let seen = seen?;
            for k in 0..=LOOKS {
                let (before, after) = (k.saturating_sub(1), (k + 1).min(LOOKS));
                if seen[k] > seen[before] || seen[k] > seen[after] {
                    continue;
                }
                let found = minimum([at(before), at(after)], FLAT, |u| length(u).unwrap_or(f64::NAN));
                for (u, l) in [(at(k), seen[k]), (found.x, found.f)] {
                    if l < best.1 {
                        best = (u, l);
                    }
                }
            }
        }
        Ok(best)
    }

    /// The range of u.
    #[must_use]
    pub const fn u_domain(&self) -> Interval {
        self.domain
    }

    /// The side that the tool is on.
    #[must_use]
    pub const fn side(&self) -> Side {
        self.side
    }

    /// The same strip with the tool on the given side.
    #[must_use]
    pub fn on_side(mut self, side: Side) -> Self {
        self.side = side;
        self
    }

    /// Directrix 0 or 1 at u, beyond the ends too. Other numbers are taken as 1.
    #[must_use]
    pub fn directrix(&self, end: usize, u: f64) -> CurveJet2 {
        self.directrices[end.min(1)].jet(u)
    }

    /// The point of directrix 0 or 1 at u, inside the domain there too where derivatives are not finite.
    pub(super) fn place(&self, end: usize, u: f64) -> Point3 {
        let d = &self.directrices[end.min(1)];
        if self.domain.contains(u) { d.point(u) } else { d.jet(u).point }
    }

    /// The point at (u, v), beyond the ends too.
    #[must_use]
    pub fn point_at(&self, u: f64, v: f64) -> Point3 {
        let [a, b] = [0, 1].map(|end: usize| self.directrices[end].jet(u).point);
        a + (b - a) * v
    }

    /// The rule at u.
    ///
    /// # Errors
    /// [`RuleError`].
    pub fn rule(&self, u: f64) -> Result<Rule, RuleError> {
        Rule::new(u, [self.directrix(0, u), self.directrix(1, u)], self.side)
    }
}

impl Surface for RuledStrip<'_> {
    fn domain(&self) -> Domain {
        Domain { u: self.domain, v: Interval::new(0.0, 1.0) }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        let [p, q] = [0, 1].map(|k: usize| self.directrices[k].jet(at.u));
        let mix = |x: &Vec3, y: &Vec3| x + (y - x) * at.v;
        let rule = q.point - p.point;
        Jet2 {
            uv: at,
            point: p.point + rule * at.v,
            du: mix(&p.first, &q.first),
            dv: rule,
            duu: mix(&p.second, &q.second),
            duv: q.first - p.first,
            dvv: Vec3::zeros(),
            side: self.side,
        }
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let at = uv(self.domain.bring(at.u), at.v);
        let [p, q] = [0, 1].map(|k: usize| self.directrices[k].taylor(at.u, order).along(Axis::U, 1.0));
        let v = Series::variable(Axis::V, at.v, order);
        Taylor { uv: at, side: self.side, coordinates: [0, 1, 2].map(|k| p[k] + (q[k] - p[k]) * v) }
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        if axis == Axis::V {
            return vec![0.0, 1.0];
        }
        let mut all: Vec<f64> = self.directrices.iter().flat_map(Directrix::inner_breaks).collect();
        all.push(self.domain.lo);
        all.sort_by(f64::total_cmp);
        // Breaks of both curves at one place, but for the rounding of the map.
        all.dedup_by(|x, y| *x - *y <= 1e-13 * self.domain.length());
        all.retain(|u| self.domain.hi - u > 1e-13 * self.domain.length());
        all.push(self.domain.hi);
        all
    }
}
