//! The one view of a surface that machining code has.

use crate::domain::{Domain, Interval};
use crate::jet::{Jet2, Jet3, Side};
use crate::point::{Axis, Point3, Uv};
use crate::taylor::Taylor;

/// A parametric surface, possibly trimmed, with a material side.
///
/// `tools`, `productivity` and `postproc` see surfaces only through this trait. Three methods are
/// required.
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

/// A surface with its material side turned over: the same points, the opposite outward normal.
#[derive(Clone, Copy, Debug)]
pub struct Flipped<S>(pub S);

impl<S: Surface> Surface for Flipped<S> {
    fn domain(&self) -> Domain {
        self.0.domain()
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        let mut jet = self.0.jet2(uv);
        jet.side = jet.side.flipped();
        jet
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        self.0.taylor(uv, order).flipped()
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        let mut jet = self.0.jet3(uv);
        jet.jet2.side = jet.jet2.side.flipped();
        jet
    }
    fn point(&self, uv: Uv) -> Point3 {
        self.0.point(uv)
    }
    fn contains(&self, uv: Uv) -> bool {
        self.0.contains(uv)
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.0.breaks(axis)
    }
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        self.0.spans(axis, fixed)
    }
    fn turns(&self) -> Vec<Uv> {
        self.0.turns()
    }
}

macro_rules! forward_surface {
    ($($t:ty),*) => {$(
        impl<S: Surface + ?Sized> Surface for $t {
            fn domain(&self) -> Domain {
                (**self).domain()
            }
            fn jet2(&self, uv: Uv) -> Jet2 {
                (**self).jet2(uv)
            }
            fn taylor(&self, uv: Uv, order: usize) -> Taylor {
                (**self).taylor(uv, order)
            }
            fn jet3(&self, uv: Uv) -> Jet3 {
                (**self).jet3(uv)
            }
            fn point(&self, uv: Uv) -> Point3 {
                (**self).point(uv)
            }
            fn contains(&self, uv: Uv) -> bool {
                (**self).contains(uv)
            }
            fn breaks(&self, axis: Axis) -> Vec<f64> {
                (**self).breaks(axis)
            }
            fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
                (**self).spans(axis, fixed)
            }
            fn turns(&self) -> Vec<Uv> {
                (**self).turns()
            }
        }
    )*};
}
forward_surface!(&S, Box<S>, std::sync::Arc<S>);

/// A surface restricted to a parameter rectangle and given a material side.
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
    fn domain(&self) -> Domain {
        self.domain
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        let mut jet = self.surface.jet2(uv);
        if self.side == Side::Against {
            jet.side = jet.side.flipped();
        }
        jet
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        let mut jet = self.surface.jet3(uv);
        if self.side == Side::Against {
            jet.jet2.side = jet.jet2.side.flipped();
        }
        jet
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let t = self.surface.taylor(uv, order);
        if self.side == Side::Against { t.flipped() } else { t }
    }
    fn point(&self, uv: Uv) -> Point3 {
        self.surface.point(uv)
    }
    fn contains(&self, uv: Uv) -> bool {
        self.domain.contains(uv) && self.surface.contains(uv)
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let i = self.domain.get(axis);
        let mut kept = vec![i.lo];
        kept.extend(self.surface.breaks(axis).into_iter().filter(|t| *t > i.lo && *t < i.hi));
        kept.push(i.hi);
        kept
    }
}
