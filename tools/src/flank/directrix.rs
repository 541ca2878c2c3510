//! A directrix of a strip: a curve, or a border of a surface, with what lies beyond its ends.
//!
//! Beyond its domain a directrix goes on as its Taylor polynomial of the highest order kept about the end: exact for
//! straight lines and polynomial pieces up to that degree, else as smooth at the end as that order.

use osculate_geom::{Axis, Curve, CurveTaylor, Interval, MAX_ORDER, Point3, Surface, Uv, Vec3};

/// Point and two derivatives of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CurveJet2 {
    /// C, mm.
    pub point: Point3,
    /// C'.
    pub first: Vec3,
    /// C''.
    pub second: Vec3,
}

impl CurveJet2 {
    /// Whether all coordinates are numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        [self.point.coords, self.first, self.second].iter().all(|v| v.iter().all(|c| c.is_finite()))
    }
}

/// What a directrix is evaluated from.
pub(super) enum Source<'a> {
    /// A curve of its own.
    Curve(Box<dyn Curve + 'a>),
    /// The line of a surface along which the parameter `along` varies and the other one is `fixed`.
    Border { surface: &'a dyn Surface, along: Axis, fixed: f64 },
}

impl Source<'_> {
    pub fn domain(&self) -> Interval {
        match self {
            Self::Curve(c) => c.domain(),
            Self::Border { surface, along, .. } => surface.domain().get(*along),
        }
    }

    fn point(&self, t: f64) -> Point3 {
        match self {
            Self::Curve(c) => c.point(t),
            Self::Border { surface, along, fixed } => surface.point(Uv::from_axis(*along, t, *fixed)),
        }
    }

    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        match self {
            Self::Curve(c) => c.taylor(t, order),
            Self::Border { surface, along, fixed } => {
                let all = surface.taylor(Uv::from_axis(*along, t, *fixed), order);
                CurveTaylor::from_derivatives(t, all.order(), |k| match along {
                    Axis::U => all.derivative(k, 0),
                    Axis::V => all.derivative(0, k),
                })
            }
        }
    }

    fn jet(&self, t: f64) -> CurveJet2 {
        match self {
            Self::Curve(c) => {
                let t = c.taylor(t, 2);
                CurveJet2 { point: t.derivative(0).into(), first: t.derivative(1), second: t.derivative(2) }
            }
            Self::Border { surface, along, fixed } => {
                let j = surface.jet2(Uv::from_axis(*along, t, *fixed));
                let (first, second) = match along {
                    Axis::U => (j.du, j.duu),
                    Axis::V => (j.dv, j.dvv),
                };
                CurveJet2 { point: j.point, first, second }
            }
        }
    }

    fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Curve(c) => c.breaks(),
            Self::Border { surface, along, .. } => surface.breaks(*along),
        }
    }
}

/// A source with its own parameter mapped proportionally onto the strip's.
pub(super) struct Directrix<'a> {
    source: Source<'a>,
    domain: Interval,
    own: Interval,
    /// Own parameter by the strip's.
    rate: f64,
    ends: [CurveTaylor; 2],
}

impl<'a> Directrix<'a> {
    pub fn new(source: Source<'a>, domain: Interval) -> Self {
        let own = source.domain();
        let ends = [own.lo, own.hi].map(|t| source.taylor(t, MAX_ORDER));
        let rate = if own.length() == domain.length() { 1.0 } else { own.length() / domain.length() };
        Self { source, domain, own, rate, ends }
    }

    /// The source's own parameter at the strip's u.
    fn own(&self, u: f64) -> f64 {
        if self.rate == 1.0 && self.own.lo == self.domain.lo {
            u
        } else if u == self.domain.hi {
            self.own.hi
        } else {
            self.own.lo + (u - self.domain.lo) * self.rate
        }
    }

    /// The point alone, inside the domain: there may be one where derivatives are not finite.
    pub fn point(&self, u: f64) -> Point3 {
        self.source.point(self.own(self.domain.bring(u)))
    }

    /// Point and derivatives by the strip's parameter, beyond the ends too.
    pub fn jet(&self, u: f64) -> CurveJet2 {
        let t = self.own(u);
        let j = if self.domain.periodic || (t >= self.own.lo && t <= self.own.hi) {
            self.source.jet(t)
        } else {
            let end = usize::from(t > self.own.hi);
            beyond(&self.ends[end], t - if end == 0 { self.own.lo } else { self.own.hi })
        };
        let r = self.rate;
        CurveJet2 { point: j.point, first: j.first * r, second: j.second * (r * r) }
    }

    /// The Taylor polynomial in the strip's parameter, inside the domain.
    pub fn taylor(&self, u: f64, order: usize) -> CurveTaylor {
        let t = self.source.taylor(self.own(self.domain.bring(u)), order);
        CurveTaylor::from_coefficients(u, t.order(), |k| t.coefficient(k) * self.rate.powi(k as i32))
    }

    /// Breaks of the source in the strip's parameter, ends left out.
    pub fn inner_breaks(&self) -> Vec<f64> {
        let inner = self.source.breaks().into_iter().filter(|t| *t > self.own.lo && *t < self.own.hi);
        inner.map(|t| self.domain.lo + (t - self.own.lo) / self.rate).collect()
    }
}

/// A Taylor polynomial and two derivatives at a step from its place.
fn beyond(t: &CurveTaylor, step: f64) -> CurveJet2 {
    let (mut point, mut first, mut second) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros());
    for k in (0..=t.order()).rev() {
        second = second * step + first * 2.0;
        first = first * step + point;
        point = point * step + t.coefficient(k);
    }
    CurveJet2 { point: point.into(), first, second }
}
