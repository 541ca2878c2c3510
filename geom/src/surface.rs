//! The one view of a surface that machining code has.

use crate::domain::{Domain, Interval};
use crate::jet::{Jet2, Jet3, Side};
use crate::point::{Axis, Point3, Uv};
use crate::taylor::Taylor;
use std::sync::Arc;

/// A parametric surface, possibly trimmed, with a material side.
///
/// `tools`, `productivity` and `postproc` see surfaces only through this trait. Three methods are
/// required.
///
/// A surface of one's own from its formula, by the arithmetic of [`Series`](crate::Series):
///
/// ```
/// use osculate_geom::{Axis, Domain, Interval, Jet2, Series, Side, Surface, Taylor, Uv, uv};
/// /// z = x y over a square.
/// struct Saddle;
/// impl Surface for Saddle {
///     fn domain(&self) -> Domain {
///         Domain { u: Interval::new(-9.0, 9.0), v: Interval::new(-9.0, 9.0) }
///     }
///     fn jet2(&self, at: Uv) -> Jet2 {
///         self.taylor(at, 2).jet2()
///     }
///     fn taylor(&self, at: Uv, order: usize) -> Taylor {
///         let (x, y) = (Series::variable(Axis::U, at.u, order), Series::variable(Axis::V, at.v, order));
///         Taylor { uv: at, side: Side::Along, coordinates: [x, y, x * y] }
///     }
/// }
/// let forms = Saddle.jet2(uv(0.0, 0.0)).forms()?;
/// assert!((forms.gauss() + 1.0).abs() < 1e-15 && forms.mean().abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Surface: Send + Sync {
    /// The parameter rectangle. A trimmed surface gives the rectangle of its untrimmed carrier.
    fn domain(&self) -> Domain;

    /// Point and partial derivatives to second order. Parameters outside the domain are brought in
    /// ([`Domain::bring`]) or, where the carrier extends naturally (analytic surfaces), evaluated as they are.
    fn jet2(&self, uv: Uv) -> Jet2;

    /// The Taylor polynomial to `order` (at most [`MAX_ORDER`](crate::MAX_ORDER)) at the place that [`Surface::jet2`]
    /// takes for `uv`: exact derivatives, not differences. Where a surface can give fewer orders (an offset has one
    /// less than its base) the polynomial says so in its [`Taylor::order`], and what lies above is NaN.
    fn taylor(&self, uv: Uv, order: usize) -> Taylor;

    /// Point and exact partial derivatives to third order; the first two orders are those of [`Surface::jet2`].
    fn jet3(&self, uv: Uv) -> Jet3 {
        Jet3 { jet2: self.jet2(uv), ..self.taylor(uv, 3).jet3() }
    }

    /// The point alone.
    fn point(&self, uv: Uv) -> Point3 {
        self.jet2(uv).point
    }

    /// Whether the parameters lie on the surface: inside the domain and, where the surface is trimmed, inside the
    /// outer loop and outside the holes.
    fn contains(&self, uv: Uv) -> bool {
        self.domain().contains(uv)
    }

    /// Parameters at which the surface is less smooth than inside (knots), ascending, both ends included.
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let i = self.domain().get(axis);
        vec![i.lo, i.hi]
    }

    /// Stretches inside the surface along the line on which the other parameter is `fixed`, ascending. A trimmed
    /// surface that knows its loops answers exactly; the answer from [`contains`](Self::contains) alone misses what is
    /// narrower than a four-hundredth of the line.
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        scanned_spans(self.domain().get(axis), &|t| self.contains(Uv::from_axis(axis, t, fixed)))
    }

    /// Places of the boundary where it turns back in u or in v, corners among them: a line between two neighbouring
    /// ones in a parameter meets every part of the surface. Without trims the corners of the rectangle.
    fn turns(&self) -> Vec<Uv> {
        let d = self.domain();
        [[d.u.lo, d.v.lo], [d.u.hi, d.v.lo], [d.u.hi, d.v.hi], [d.u.lo, d.v.hi]]
            .into_iter()
            .map(|[u, v]| Uv { u, v })
            .filter(|at| self.contains(*at))
            .collect()
    }

    /// Rectangles of parameters that are looked at one by one, where a surface is of several pieces that need not meet, such as
    /// triangles; pieces may be flat and as small as they come. A surface of one piece gives its domain.
    fn pieces(&self) -> Vec<Domain> {
        vec![self.domain()]
    }
}

/// Stretches of inside on a grid of cells, ends refined by bisection.
fn scanned_spans(line: Interval, inside: &dyn Fn(f64) -> bool) -> Vec<Interval> {
    const CELLS: usize = 400;
    // `a` is inside, `b` is not; forty halvings exhaust what matters of a cell.
    let edge = |mut a: f64, mut b: f64| -> f64 {
        for _ in 0..40 {
            let m = 0.5 * (a + b);
            if inside(m) { a = m } else { b = m }
        }
        a
    };
    let mut out = Vec::new();
    let mut open: Option<f64> = None;
    let mut last = line.lo;
    for k in 0..=CELLS {
        let t = line.at(k as f64 / CELLS as f64);
        match (inside(t), open) {
            (true, None) => open = Some(if k == 0 { t } else { edge(t, last) }),
            (false, Some(start)) => {
                out.push(Interval::new(start, edge(last, t)));
                open = None;
            }
            _ => {}
        }
        last = t;
    }
    out.extend(open.map(|start| Interval::new(start, line.hi)));
    out
}

/// Writes methods of [`Surface`] that hand the question on to another surface.
///
/// A wrapper that writes them by hand forgets the provided ones, whose defaults then hide what the surface below knows: a
/// trimmed surface would have the corners of its rectangle for its turns. `trims` is everything about where the surface
/// is (domain, contains, breaks, spans, turns, pieces), `shape` everything about its points, `all` is both; single methods go by
/// their names.
///
/// ```
/// use osculate_geom::{Jet2, Surface, Taylor, Uv, forward_surface};
/// struct Seen<S>(S);
/// impl<S: Surface> Surface for Seen<S> {
///     forward_surface!(all |s| s.0);
/// }
/// ```
#[macro_export]
macro_rules! forward_surface {
    (all |$s:ident| $base:expr) => {
        $crate::forward_surface!(shape | $s | $base);
        $crate::forward_surface!(trims | $s | $base);
    };
    (shape |$s:ident| $base:expr) => {
        fn jet2(&self, uv: $crate::Uv) -> $crate::Jet2 {
            let $s = self;
            $base.jet2(uv)
        }
        fn taylor(&self, uv: $crate::Uv, order: usize) -> $crate::Taylor {
            let $s = self;
            $base.taylor(uv, order)
        }
        fn jet3(&self, uv: $crate::Uv) -> $crate::Jet3 {
            let $s = self;
            $base.jet3(uv)
        }
        $crate::forward_surface!(point | $s | $base);
    };
    (trims |$s:ident| $base:expr) => {
        $crate::forward_surface!(domain | $s | $base);
        $crate::forward_surface!(breaks | $s | $base);
        $crate::forward_surface!(turns | $s | $base);
        fn pieces(&self) -> Vec<$crate::Domain> {
            let $s = self;
            $base.pieces()
        }
        fn contains(&self, uv: $crate::Uv) -> bool {
            let $s = self;
            $base.contains(uv)
        }
        fn spans(&self, axis: $crate::Axis, fixed: f64) -> Vec<$crate::Interval> {
            let $s = self;
            $base.spans(axis, fixed)
        }
    };
    (point |$s:ident| $base:expr) => {
        fn point(&self, uv: $crate::Uv) -> $crate::Point3 {
            let $s = self;
            $base.point(uv)
        }
    };
    (domain |$s:ident| $base:expr) => {
        fn domain(&self) -> $crate::Domain {
            let $s = self;
            $base.domain()
        }
    };
    (breaks |$s:ident| $base:expr) => {
        fn breaks(&self, axis: $crate::Axis) -> Vec<f64> {
            let $s = self;
            $base.breaks(axis)
        }
    };
    (turns |$s:ident| $base:expr) => {
        fn turns(&self) -> Vec<$crate::Uv> {
            let $s = self;
            $base.turns()
        }
    };
}

impl<S: Surface + ?Sized> Surface for &S {
    forward_surface!(all | s | (**s));
}

impl<S: Surface + ?Sized> Surface for Box<S> {
    forward_surface!(all | s | (**s));
}

impl<S: Surface + ?Sized> Surface for Arc<S> {
    forward_surface!(all | s | (**s));
}

/// A surface with its material side turned over: the same points, the opposite outward normal.
///
/// ```
/// use osculate_geom::{Flipped, Interval, Surface, analytic::Cylinder, uv};
/// // The wall of a bore of radius 20 instead of a shaft's: hollow, with the normal towards the axis.
/// let bore = Flipped(Cylinder::new(20.0, Interval::new(0.0, 80.0))?);
/// let forms = bore.jet2(uv(0.0, 40.0)).forms()?;
/// assert!((forms.normal.x + 1.0).abs() < 1e-15 && (forms.principal().k_min + 1.0 / 20.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Flipped<S>(pub S);

impl<S: Surface> Surface for Flipped<S> {
    forward_surface!(trims | s | s.0);
    forward_surface!(point | s | s.0);
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.0.jet2(uv).turned(Side::Against)
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        self.0.taylor(uv, order).turned(Side::Against)
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        self.0.jet3(uv).turned(Side::Against)
    }
}

/// A surface restricted to a parameter rectangle and given a material side.
///
/// ```
/// use osculate_geom::{Domain, Interval, Patch, Side, analytic::Sphere, quadrature::area};
/// use std::f64::consts::FRAC_PI_2;
/// // An octant of a ball has an eighth of its area.
/// let quarter = Interval::new(0.0, FRAC_PI_2);
/// let domain = Domain { u: quarter, v: quarter };
/// let octant = Patch { surface: Sphere::new(10.0)?, domain, side: Side::Along };
/// assert!((area(&octant, 1e-10).value - 100.0 * FRAC_PI_2).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Patch<S> {
    /// The whole surface.
    pub surface: S,
    /// The rectangle kept.
    pub domain: Domain,
    /// The material side, relative to the carrier's own.
    pub side: Side,
}

impl<S: Surface> Surface for Patch<S> {
    forward_surface!(point | s | s.surface);
    fn domain(&self) -> Domain {
        self.domain
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.surface.jet2(uv).turned(self.side)
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        self.surface.jet3(uv).turned(self.side)
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        self.surface.taylor(uv, order).turned(self.side)
    }
    fn contains(&self, uv: Uv) -> bool {
        self.domain.contains(uv) && self.surface.contains(uv)
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.domain.get(axis).breaks(self.surface.breaks(axis))
    }
    /// As exact as those of the whole surface where the rectangle lies inside its own; else from `contains`.
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        let (kept, whole) = (self.domain.get(axis), self.surface.domain().get(axis));
        if !self.domain.get(axis.other()).contains(fixed) {
            return Vec::new();
        }
        if kept.lo < whole.lo || kept.hi > whole.hi {
            return scanned_spans(kept, &|t| self.contains(Uv::from_axis(axis, t, fixed)));
        }
        let cut = |s: Interval| Interval::new(s.lo.max(kept.lo), s.hi.min(kept.hi));
        self.surface.spans(axis, fixed).into_iter().map(cut).filter(|s| s.lo < s.hi).collect()
    }
    /// Where the sides of the rectangle enter and leave the surface, and the surface's own turns between them.
    fn turns(&self) -> Vec<Uv> {
        let d = self.domain;
        let side = |axis: Axis, fixed: f64| {
            let ends = self.spans(axis, fixed).into_iter().flat_map(|s| [s.lo, s.hi]);
            ends.map(|t| Uv::from_axis(axis, t, fixed)).collect::<Vec<Uv>>()
        };
        let mut all = side(Axis::U, d.v.lo);
        all.extend(side(Axis::U, d.v.hi).into_iter().rev());
        let inner = self.surface.turns().into_iter().filter(|at| d.contains(*at)).map(|at| d.bring(at));
        for at in side(Axis::V, d.u.lo).into_iter().chain(side(Axis::V, d.u.hi)).chain(inner) {
            if !all.contains(&at) {
                all.push(at);
            }
        }
        all
    }
}
