//! Curves made of other curves: chains, offsets, and parameter curves lifted to their surface.

use super::carrier::FaceSurface;
use super::curve::{Curve, Piece};
use osculate_geom::roots::{FLAT, minimum};
use osculate_geom::{Point3, Surface, Unit3, Vec3, uv};
use std::sync::Arc;

/// Pieces end to end, parameter = index.
#[derive(Clone)]
pub(crate) struct Compound {
    pieces: Vec<Piece>,
    closed: bool,
}

/// Ends nearer than this fraction of a chain's size close it: files keep seven digits or more.
const SAME_END: f64 = 1e-6;

impl Compound {
    /// The chain; `None` without pieces.
    pub(crate) fn new(pieces: Vec<Piece>) -> Option<Self> {
        let (first, last) = (pieces.first()?.end_points()[0], pieces.last()?.end_points()[1]);
        let all: Vec<Point3> =
            pieces.iter().flat_map(|p| [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| p.point(t))).collect();
        let size = osculate_geom::Box3::around(&all).diagonal_mm();
        let closed = (first - last).norm() <= SAME_END * size;
        Some(Self { pieces, closed })
    }
}

impl Curve for Compound {
    fn point(&self, t: f64) -> Point3 {
        let n = self.pieces.len();
        let t = if self.closed && !(t >= 0.0 && t <= n as f64) { t.rem_euclid(n as f64) } else { t };
        let k = (t.max(0.0) as usize).min(n - 1);
        self.pieces[k].point((t - k as f64).clamp(0.0, 1.0))
    }
    fn range(&self) -> [f64; 2] {
        [0.0, self.pieces.len() as f64]
    }
    fn period(&self) -> Option<f64> {
        self.closed.then_some(self.pieces.len() as f64)
    }
    fn locate(&self, p: &Point3) -> f64 {
        let near = |k: usize| {
            let t = self.pieces[k].locate(p);
            ((self.pieces[k].point(t) - p).norm_squared(), k as f64 + t)
        };
        let best = (0..self.pieces.len()).map(near).min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(0.0, |b| b.1)
    }
    fn breaks(&self) -> Vec<f64> {
        let mut ts = Vec::new();
        for (k, p) in self.pieces.iter().enumerate() {
            if k > 0 {
                ts.push(k as f64);
            }
            ts.extend(p.breaks().into_iter().map(|t| k as f64 + t));
        }
        ts
    }
}

/// `C + d (v x T) / |v x T|` with the tangent T ([ISO 10303-42, offset_curve_3d]).
#[derive(Clone)]
pub(crate) struct OffsetCurve {
    /// The curve C.
    pub(crate) curve: Arc<dyn Curve>,
    /// The distance d, mm.
    pub(crate) distance_mm: f64,
    /// The direction v.
    pub(crate) across: Unit3,
}

/// Half the interval of the tangent's difference quotient, as a fraction of the range: its error, with the third
/// derivative, and the rounding error are then both near 1e-10 of the distance.
const STEP: f64 = 1e-5;

impl OffsetCurve {
    fn tangent(&self, t: f64) -> Vec3 {
        let [lo, hi] = self.curve.range();
        let length = if (hi - lo).is_finite() { hi - lo } else { 1.0 };
        let (mut a, mut b) = (t - STEP * length, t + STEP * length);
        if self.curve.period().is_none() {
            (a, b) = (a.max(lo), b.min(hi));
        }
        self.curve.point(b) - self.curve.point(a)
    }
}

impl Curve for OffsetCurve {
    fn point(&self, t: f64) -> Point3 {
        let side = self.across.cross(&self.tangent(t));
        let n = side.norm();
        self.curve.point(t) + if n > 0.0 { side * (self.distance_mm / n) } else { Vec3::zeros() }
    }
    fn range(&self) -> [f64; 2] {
        self.curve.range()
    }
    fn period(&self) -> Option<f64> {
        self.curve.period()
    }
    fn locate(&self, p: &Point3) -> f64 {
        // The foot on the base curve is the foot here, but for points beyond a centre of curvature.
        self.curve.locate(p)
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
}

/// A parameter curve (z = 0) on a surface.
#[derive(Clone)]
pub(crate) struct Lifted {
    /// The surface.
    pub(crate) surface: FaceSurface,
    /// The parameters.
    pub(crate) curve: Arc<dyn Curve>,
}

/// Samples of a lifted curve when a point of it is looked for.
const SAMPLES: u32 = 64;

impl Curve for Lifted {
    fn point(&self, t: f64) -> Point3 {
        let p = self.curve.point(t);
        self.surface.point(uv(p.x, p.y))
    }
    fn range(&self) -> [f64; 2] {
        self.curve.range()
    }
    fn locate(&self, p: &Point3) -> f64 {
        let [lo, hi] = self.range();
        if !(lo.is_finite() && hi.is_finite()) {
            return 0.0;
        }
        let d2 = |t: f64| (self.point(t) - p).norm_squared();
        let step = (hi - lo) / f64::from(SAMPLES);
        let best = (0..=SAMPLES).map(|k| lo + step * f64::from(k)).min_by(|a, b| d2(*a).total_cmp(&d2(*b)));
        let middle = best.unwrap_or(lo);
        // Between the neighbours of the best sample.
        let found = minimum([(middle - step).max(lo), (middle + step).min(hi)], FLAT, d2).x;
        [lo, hi].into_iter().fold(found, |best, end| if d2(end) <= d2(best) { end } else { best })
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::{Ellipse, Line};
    use super::*;
    use osculate_geom::analytic::Placement;
    use std::f64::consts::TAU;

    #[test]
    fn a_chain_of_two_segments() {
        let at = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let whole = |a, b| Piece::whole(Arc::new(Line::segment(a, b))).unwrap();
        let chain = Compound::new(vec![whole(at(0.0, 0.0), at(2.0, 0.0)), whole(at(2.0, 0.0), at(2.0, 4.0))])
            .unwrap();
        assert_eq!((chain.range(), chain.period(), chain.breaks()), ([0.0, 2.0], None, vec![1.0]));
        assert_eq!((chain.point(0.5), chain.point(1.25)), (at(1.0, 0.0), at(2.0, 1.0)));
        assert!((chain.locate(&at(3.0, 3.0)) - 1.75).abs() < 1e-15);
        assert!(Compound::new(Vec::new()).is_none());
    }

    #[test]
    fn an_offset_circle_is_a_circle() {
        let circle = Ellipse { frame: Placement::identity(), semi_axes: [3.0, 3.0], range: [0.0, TAU] };
        // z x T of a circle run counter-clockwise points to its centre.
        let inner = OffsetCurve { curve: Arc::new(circle), distance_mm: 1.0, across: Vec3::z_axis() };
        for k in 0..20 {
            assert!((inner.point(f64::from(k)).coords.norm() - 2.0).abs() < 1e-9);
        }
    }
}
