//! The same surface under other parameters: swapped and reversed. The material stays where it is.

use crate::domain::{Domain, Interval};
use crate::jet::Jet2;
use crate::point::{Axis, Point3, Uv, uv};
use crate::series::Series;
use crate::surface::Surface;
use crate::taylor::Taylor;

/// A surface with u and v exchanged.
#[derive(Clone, Copy, Debug)]
pub struct Swapped<S>(pub S);

impl<S: Surface> Surface for Swapped<S> {
    fn domain(&self) -> Domain {
        let d = self.0.domain();
        Domain { u: d.v, v: d.u }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        let j = self.0.jet2(uv(at.v, at.u));
        Jet2 { uv: at, du: j.dv, dv: j.du, duu: j.dvv, dvv: j.duu, side: j.side.flipped(), ..j }
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let t = self.0.taylor(uv(at.v, at.u), order);
        let swap = |c: Series| Series::from_coefficients(c.order(), |i, j| c.coefficient(j, i));
        Taylor { uv: at, side: t.side.flipped(), coordinates: t.coordinates.map(swap) }
    }
    fn point(&self, at: Uv) -> Point3 {
        self.0.point(uv(at.v, at.u))
    }
    fn contains(&self, at: Uv) -> bool {
        self.0.contains(uv(at.v, at.u))
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.0.breaks(axis.other())
    }
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        self.0.spans(axis.other(), fixed)
    }
    fn turns(&self) -> Vec<Uv> {
        self.0.turns().into_iter().map(|at| uv(at.v, at.u)).collect()
    }
}

/// A surface with one parameter running backwards over the same interval.
#[derive(Clone, Copy, Debug)]
pub struct Reversed<S> {
    /// The surface.
    pub surface: S,
    /// Which parameter.
    pub axis: Axis,
}

impl<S: Surface> Reversed<S> {
    /// The parameters of the same point, there and back.
    pub fn place(&self, at: Uv) -> Uv {
        let i = self.surface.domain().get(self.axis);
        let t = i.lo + (i.hi - at.get(self.axis));
        Uv::from_axis(self.axis, t, at.get(self.axis.other()))
    }
}

impl<S: Surface> Surface for Reversed<S> {
    fn domain(&self) -> Domain {
        self.surface.domain()
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        let j = self.surface.jet2(self.place(at));
        let (du, dv) = if self.axis == Axis::U { (-j.du, j.dv) } else { (j.du, -j.dv) };
        Jet2 { uv: at, du, dv, duv: -j.duv, side: j.side.flipped(), ..j }
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let t = self.surface.taylor(self.place(at), order);
        let back = |c: Series| {
            Series::from_coefficients(c.order(), |i, j| {
                let odd = if self.axis == Axis::U { i } else { j };
                if odd.is_multiple_of(2) { c.coefficient(i, j) } else { -c.coefficient(i, j) }
            })
        };
        Taylor { uv: at, side: t.side.flipped(), coordinates: t.coordinates.map(back) }
    }
    fn point(&self, at: Uv) -> Point3 {
        self.surface.point(self.place(at))
    }
    fn contains(&self, at: Uv) -> bool {
        self.surface.contains(self.place(at))
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let mut breaks = self.surface.breaks(axis);
        if axis == self.axis {
            let i = self.surface.domain().get(axis);
            breaks.reverse();
            let last = breaks.len() - 1;
            for (k, t) in breaks.iter_mut().enumerate() {
                // The ends are met without rounding.
                *t = if k == 0 {
                    i.lo
                } else if k == last {
                    i.hi
                } else {
                    i.lo + (i.hi - *t)
                };
            }
        }
        breaks
    }
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        let i = self.surface.domain().get(self.axis);
        let back = |t: f64| i.lo + (i.hi - t);
        if axis != self.axis {
            return self.surface.spans(axis, back(fixed));
        }
        let spans = self.surface.spans(axis, fixed).into_iter().rev();
        spans.map(|s| Interval { lo: back(s.hi), hi: back(s.lo), ..s }).collect()
    }
    fn turns(&self) -> Vec<Uv> {
        self.surface.turns().into_iter().map(|at| self.place(at)).collect()
    }
}
