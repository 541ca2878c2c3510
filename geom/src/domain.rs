//! The parameter rectangle of a surface, with closing (periodic) directions.

use crate::point::{Axis, Uv, uv};

/// A parameter interval `[lo, hi]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end, never below `lo`.
    pub hi: f64,
    /// True where the surface closes on itself: the point at `hi` is the point at `lo` and the surface is smooth
    /// across it, so that parameters wrap.
    pub periodic: bool,
}

impl Interval {
    /// An interval that ends at its ends.
    #[must_use]
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi, periodic: false }
    }

    /// An interval that wraps.
    #[must_use]
    pub const fn periodic(lo: f64, hi: f64) -> Self {
        Self { lo, hi, periodic: true }
    }

    /// `hi - lo`.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.hi - self.lo
    }

    /// The parameter brought into the interval: wrapped where periodic, clamped elsewhere.
    ///
    /// ```
    /// use osculate_geom::Interval;
    /// assert_eq!(Interval::new(0.0, 10.0).bring(12.0), 10.0);
    /// assert_eq!(Interval::periodic(0.0, 10.0).bring(12.0), 2.0);
    /// ```
    #[must_use]
    pub fn bring(&self, t: f64) -> f64 {
        if self.periodic {
            let r = (t - self.lo).rem_euclid(self.length()) + self.lo;
            if t == self.hi { self.hi } else { r }
        } else {
            t.clamp(self.lo, self.hi)
        }
    }

    /// Whether `t` lies inside, with a slack of `1e-12` of the length for rounding. Always true where periodic.
    #[must_use]
    pub fn contains(&self, t: f64) -> bool {
        let slack = 1e-12 * self.length();
        self.periodic || (t >= self.lo - slack && t <= self.hi + slack)
    }

    /// Both ends, and of ascending breaks of something larger those between them.
    #[must_use]
    pub fn breaks(&self, of: Vec<f64>) -> Vec<f64> {
        let mut kept = vec![self.lo];
        kept.extend(of.into_iter().filter(|t| *t > self.lo && *t < self.hi));
        kept.push(self.hi);
        kept
    }

    /// The parameter at `fraction` of the way from `lo` to `hi`.
    #[must_use]
    pub fn at(&self, fraction: f64) -> f64 {
        self.lo + fraction * (self.hi - self.lo)
    }
}

/// The parameter rectangle of a surface.
///
/// ```
/// use osculate_geom::{Axis, Domain, Interval, uv};
/// let domain = Domain { u: Interval::periodic(0.0, 360.0), v: Interval::new(0.0, 80.0) };
/// assert_eq!(domain.at(0.25, 0.5), uv(90.0, 40.0));
/// assert_eq!(domain.bring(uv(-90.0, 100.0)), uv(270.0, 80.0));
/// assert_eq!(domain.get(Axis::V).length(), 80.0);
/// assert!(domain.contains(uv(400.0, 80.0)) && !domain.contains(uv(0.0, 81.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Range of the first parameter.
    pub u: Interval,
    /// Range of the second parameter.
    pub v: Interval,
}

impl Domain {
    /// The interval of one axis.
    #[must_use]
    pub const fn get(&self, axis: Axis) -> Interval {
        match axis {
            Axis::U => self.u,
            Axis::V => self.v,
        }
    }

    /// Both parameters brought into range, see [`Interval::bring`].
    #[must_use]
    pub fn bring(&self, at: Uv) -> Uv {
        uv(self.u.bring(at.u), self.v.bring(at.v))
    }

    /// Whether the parameters lie in the rectangle, see [`Interval::contains`].
    #[must_use]
    pub fn contains(&self, at: Uv) -> bool {
        self.u.contains(at.u) && self.v.contains(at.v)
    }

    /// The parameters at the given fractions of both ranges.
    #[must_use]
    pub fn at(&self, fu: f64, fv: f64) -> Uv {
        uv(self.u.at(fu), self.v.at(fv))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bring_wraps_and_clamps() {
        let p = Interval::periodic(1.0, 3.0);
        assert_eq!(p.bring(3.5), 1.5);
        assert_eq!(p.bring(0.5), 2.5);
        assert_eq!(p.bring(3.0), 3.0);
        let c = Interval::new(1.0, 3.0);
        assert_eq!(c.bring(3.5), 3.0);
        assert!(!c.contains(3.5) && p.contains(3.5));
    }
}
