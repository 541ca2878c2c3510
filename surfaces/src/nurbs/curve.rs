//! NURBS curves in the plane and in space.
//!
//! `C(t) = sum N_i(t) w_i P_i / sum N_i(t) w_i` over `[t_p, t_n]`. Curves in space are edges, mm; curves in
//! the plane are mostly lines in the parameters of a surface, without unit. Parameters outside the domain are
//! clamped to it.
//!
//! Source: [Piegl & Tiller, The NURBS Book, chapters 3 and 4].

use super::edit_error::{EditError, check_insertion, check_piece};
use crate::knots::{KnotError, Knots};
use crate::refine::{Mean, clamped_piece, inserted, means};
use nalgebra::{Point, SVector, Vector1};
use osculate_geom::Interval;

/// Why data are no NURBS curve, or a curve cannot be sampled as asked.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// The knots are out of order.
    #[error(transparent)]
    Knots(#[from] KnotError),
    /// There is not one weight for each pole.
    #[error("{got} weights for {need} poles")]
    WeightCount {
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// A pole with a coordinate that is not a finite number.
    #[error("coordinate {coordinate} of pole {index} is {got}, not a finite number")]
    NonFinite {
        /// Which pole, from 0.
        index: usize,
        /// Which coordinate, from 0.
        coordinate: usize,
        /// Its value.
        got: f64,
    },
    /// A weight that is zero, negative or not finite.
    #[error("weight {index} is {got}: weights must be positive and finite")]
    Weight {
        /// Which, from 0.
        index: usize,
        /// Its value.
        got: f64,
    },
    /// A chord tolerance that is not positive, or too small for the curve.
    #[error("a chord tolerance of {chord} is not possible here: it must be above {least:.3e}")]
    Chord {
        /// The tolerance asked for.
        chord: f64,
        /// What it must be above.
        least: f64,
    },
}

/// A point of a curve with two derivatives by its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CurveJet<const D: usize> {
    /// C.
    pub point: Point<f64, D>,
    /// C'.
    pub first: SVector<f64, D>,
    /// C''.
    pub second: SVector<f64, D>,
}

/// A checked NURBS curve in D dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve<const D: usize> {
    knots: Knots,
    poles: Vec<Point<f64, D>>,
    weights: Option<Vec<f64>>,
}

/// A curve in the plane.
pub type NurbsCurve2 = NurbsCurve<2>;
/// A curve in space.
pub type NurbsCurve3 = NurbsCurve<3>;

/// Most halvings of a span by [`NurbsCurve::polyline`]: each divides the distance from the chord by four, so
/// twenty reach 1e-12 of the first one.
const MAX_HALVINGS: u32 = 20;

impl<const D: usize> NurbsCurve<D> {
    /// The curve of the given degree, knots (multiple ones written out), poles and positive weights, `None`
    /// for a polynomial curve.
    ///
    /// ```
    /// use osculate_geom::Point3;
    /// use osculate_surfaces::{CurveError, NurbsCurve3};
    /// // A quarter of a circle of radius 10: the middle weight is cos 45 deg.
    /// let poles = [[10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0]].map(Point3::from).to_vec();
    /// let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    /// let arc = NurbsCurve3::new(2, knots.clone(), poles.clone(), Some(vec![1.0, 0.5f64.sqrt(), 1.0]))?;
    /// assert!((arc.point(0.3).coords.norm() - 10.0).abs() < 1e-12);
    /// assert!(matches!(NurbsCurve3::new(2, knots, poles, Some(vec![1.0])), Err(CurveError::WeightCount { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CurveError`] says which number is wrong.
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        poles: Vec<Point<f64, D>>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, CurveError> {
        let knots = Knots::new(degree, poles.len(), knots)?;
        for (index, p) in poles.iter().enumerate() {
            if let Some(coordinate) = p.iter().position(|c| !c.is_finite()) {
                return Err(CurveError::NonFinite { index, coordinate, got: p[coordinate] });
            }
        }
        if let Some(w) = &weights {
            if w.len() != poles.len() {
                return Err(CurveError::WeightCount { got: w.len(), need: poles.len() });
            }
            let bad = w.iter().enumerate().find(|(_, w)| !(**w > 0.0 && w.is_finite()));
            if let Some((index, got)) = bad {
                return Err(CurveError::Weight { index, got: *got });
            }
        }
        Ok(Self { knots, poles, weights })
    }

    /// The knots.
    #[must_use]
    pub const fn knots(&self) -> &Knots {
        &self.knots
    }

    /// The degree.
    #[must_use]
    pub const fn degree(&self) -> usize {
        self.knots.degree()
    }

    /// The poles.
    #[must_use]
    pub fn poles(&self) -> &[Point<f64, D>] {
        &self.poles
    }

    /// The weights, where there are any.
    #[must_use]
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// Whether the weights differ from each other: equal ones make a polynomial curve.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        self.weights.as_ref().is_some_and(|w| w.iter().any(|x| *x != w[0]))
    }

    /// The parameter interval.
    #[must_use]
    pub fn domain(&self) -> Interval {
        let [lo, hi] = self.knots.domain();
        Interval::new(lo, hi)
    }

    fn weight(&self, i: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |w| w[i])
    }

    /// The point at `t`.
    #[must_use]
    pub fn point(&self, t: f64) -> Point<f64, D> {
        let t = self.domain().bring(t);
        let (first, n) = self.knots.basis_values(self.knots.find(t), t);
        let origin = self.poles[first];
        let (mut a, mut w) = (SVector::zeros(), 0.0);
        for (i, value) in (first..=first + self.degree()).zip(n) {
            let share = value * self.weight(i);
            a += (self.poles[i] - origin) * share;
            w += share;
        }
        origin + a / w
    }

    /// Point and derivatives to second order at `t`; at a knot those to its right.
    #[must_use]
    pub fn jet(&self, t: f64) -> CurveJet<D> {
        let t = self.domain().bring(t);
        let basis = self.knots.basis(self.knots.find(t), t);
        let origin = self.poles[basis.first];
        let (mut a, mut w) = ([SVector::<f64, D>::zeros(); 3], [0.0; 3]);
        for r in 0..=self.degree() {
            let (i, weight) = (basis.first + r, self.weight(basis.first + r));
            let pole = (self.poles[i] - origin) * weight;
            for k in 0..3 {
                a[k] += pole * basis.order[k][r];
                w[k] += weight * basis.order[k][r];
            }
        }
        if self.weights.is_none() {
            // The basis sums to one but for rounding, which must not turn up as a weight.
            w = [1.0, 0.0, 0.0];
        }
        let c = a[0] / w[0];
        let first = (a[1] - c * w[1]) / w[0];
        let second = (a[2] - first * (2.0 * w[1]) - c * w[2]) / w[0];
        CurveJet { point: origin + c, first, second }
    }

    /// The same curve over the finer or shorter knots `new`.
    pub(crate) fn over(&self, new: Vec<f64>) -> Self {
        self.changed(self.degree(), &means(&self.knots, &new), new)
    }

    /// The curve of data that are known to be in order.
    pub(crate) const fn checked(knots: Knots, poles: Vec<Point<f64, D>>, weights: Option<Vec<f64>>) -> Self {
        Self { knots, poles, weights }
    }

    /// The curve with the poles that `means` give over the knots `new` of some degree.
    pub(crate) fn changed(&self, degree: usize, means: &[Mean], new: Vec<f64>) -> Self {
        let weights: Option<Vec<f64>> =
            self.weights.as_ref().map(|w| means.iter().map(|m| m.of(|i| Vector1::new(w[i])).x).collect());
        let poles = means
            .iter()
            .enumerate()
            .map(|(j, m)| {
                let sum = m.of(|i| self.poles[i].coords * self.weight(i));
                Point::from(sum / weights.as_ref().map_or(1.0, |w| w[j]))
            })
            .collect();
        Self { knots: Knots::with_spans(degree, new, means.len()), poles, weights }
    }

    /// The same curve with the knot `t` standing `times` more often.
    ///
    /// # Errors
    /// [`EditError`] for a parameter outside the domain and a knot more often than the degree.
    pub fn insert_knot(&self, t: f64, times: usize) -> Result<Self, EditError> {
        check_insertion(&self.knots, t, times)?;
        Ok(self.over(inserted(&self.knots, t, times)))
    }

    /// The same curve with each knot standing so many times more often, ascending.
    ///
    /// # Errors
    /// [`EditError`] as [`Self::insert_knot`].
    pub fn insert_knots(&self, more: &[(f64, usize)]) -> Result<Self, EditError> {
        let mut new = self.knots.as_slice().to_vec();
        for (t, times) in more {
            check_insertion(&self.knots, *t, *times)?;
            new.extend(std::iter::repeat_n(*t, *times));
        }
        new.sort_by(f64::total_cmp);
        Ok(self.over(new))
    }

    /// The piece over a parameter interval, with clamped knots.
    ///
    /// # Errors
    /// [`EditError::Interval`] where that is empty or reaches outside.
    pub fn restricted(&self, part: Interval) -> Result<Self, EditError> {
        check_piece(&self.knots, part.lo, part.hi)?;
        Ok(self.over(clamped_piece(&self.knots, part.lo, part.hi)))
    }

    /// The two pieces below and above `t`.
    ///
    /// ```
    /// use osculate_geom::nalgebra::Point2;
    /// use osculate_surfaces::{EditError, NurbsCurve2};
    /// // A parabola cut in the middle: both halves have its points.
    /// let poles = vec![Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(2.0, 4.0)];
    /// let parabola = NurbsCurve2::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], poles, None)?;
    /// let [low, high] = parabola.split(0.5)?;
    /// assert!((low.point(0.25) - parabola.point(0.25)).norm() < 1e-15);
    /// assert_eq!(low.poles().last(), high.poles().first());
    /// assert!(matches!(parabola.split(1.0), Err(EditError::Outside { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EditError::Outside`] unless `t` is inside the domain.
    pub fn split(&self, t: f64) -> Result<[Self; 2], EditError> {
        let [lo, hi] = self.knots.domain();
        if !(t > lo && t < hi) {
            return Err(EditError::Outside { got: t, lo, hi });
        }
        Ok([[lo, t], [t, hi]].map(|[a, b]| self.over(clamped_piece(&self.knots, a, b))))
    }

    /// The Bezier pieces between the knots, in order.
    #[must_use]
    pub fn bezier_pieces(&self) -> Vec<Self> {
        let cut = |w: &[f64]| {
            self.over([w[0], w[1]].iter().flat_map(|t| std::iter::repeat_n(*t, self.degree() + 1)).collect())
        };
        self.knots.breaks().windows(2).map(cut).collect()
    }

    /// The same points run through backwards over the same domain: `t` becomes `lo + hi - t`.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            knots: self.knots.reversed(),
            poles: self.poles.iter().rev().copied().collect(),
            weights: self.weights.as_ref().map(|w| w.iter().rev().copied().collect()),
        }
    }

    /// Parameters, ascending and with both ends and all knots, between which the curve stays within `chord`
    /// (in the unit of the poles) of the straight line.
    ///
    /// Certain, not sampled: a piece is halved until its Bezier poles are within `chord` of its chord, and
    /// the curve is within the hull of these. On a cubic that asks for about a sixth more points than needed.
    ///
    /// ```
    /// use osculate_geom::nalgebra::Point2;
    /// use osculate_surfaces::NurbsCurve2;
    /// let poles = vec![Point2::new(0.0, 0.0), Point2::new(50.0, 40.0), Point2::new(100.0, 0.0)];
    /// let arc = NurbsCurve2::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], poles, None)?;
    /// // The middle pole is 40 mm off the chord. Every halving leaves a quarter of that: five come below 0.1.
    /// assert_eq!(arc.polyline(0.1)?.len(), 33);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CurveError::Chord`] where `chord` is not positive or would take more than 2^20 pieces between two
    /// knots.
    pub fn polyline(&self, chord: f64) -> Result<Vec<f64>, CurveError> {
        if chord <= 0.0 || chord.is_nan() {
            return Err(CurveError::Chord { chord, least: 0.0 });
        }
        let breaks = self.knots.breaks();
        let mut out = vec![breaks[0]];
        for (piece, ends) in self.bezier_pieces().iter().zip(breaks.windows(2)) {
            let poles: Vec<_> = piece
                .poles
                .iter()
                .enumerate()
                .map(|(i, p)| (p.coords * piece.weight(i), piece.weight(i)))
                .collect();
            // The part that comes first along the curve is on top.
            let mut stack = vec![(poles, ends[0], ends[1], 0)];
            while let Some((poles, lo, hi, depth)) = stack.pop() {
                let off = distance_from_chord(&poles);
                // Written so that overflow ends in an error too.
                if off <= chord {
                    out.push(hi);
                    continue;
                }
                let mid = lo + 0.5 * (hi - lo);
                if depth == MAX_HALVINGS || !(mid > lo && mid < hi) || !off.is_finite() {
                    return Err(CurveError::Chord { chord, least: off });
                }
                let [a, b] = halves(poles);
                stack.push((b, mid, hi, depth + 1));
                stack.push((a, lo, mid, depth + 1));
            }
        }
        Ok(out)
    }
}

/// A weighted pole `(w P, w)`.
type Weighted<const D: usize> = (SVector<f64, D>, f64);

/// Largest distance of Bezier poles from the straight line between the first and the last.
fn distance_from_chord<const D: usize>(poles: &[Weighted<D>]) -> f64 {
    let at = |i: usize| poles[i].0 / poles[i].1;
    let (a, b) = (at(0), at(poles.len() - 1));
    let along = b - a;
    let length_squared = along.norm_squared();
    (1..poles.len() - 1)
        .map(|i| {
            let d = at(i) - a;
            let f = if length_squared > 0.0 { (d.dot(&along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
            (d - along * f).norm()
        })
        .fold(0.0, |m, d| if d > m || d.is_nan() { d } else { m })
}

/// Both halves of a Bezier curve by de Casteljau's scheme.
fn halves<const D: usize>(mut poles: Vec<Weighted<D>>) -> [Vec<Weighted<D>>; 2] {
    let n = poles.len();
    let mut low = Vec::with_capacity(n);
    for last in (0..n).rev() {
        low.push(poles[0]);
        for i in 0..last {
            poles[i] = ((poles[i].0 + poles[i + 1].0) * 0.5, (poles[i].1 + poles[i + 1].1) * 0.5);
        }
    }
    // What is left in place are the last poles of every stage: the upper half.
    [low, poles]
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::Point3;

    fn quarter() -> NurbsCurve2 {
        let h = 0.5f64.sqrt();
        let poles = vec![Point::from([1.0, 0.0]), Point::from([1.0, 1.0]), Point::from([0.0, 1.0])];
        NurbsCurve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], poles, Some(vec![1.0, h, 1.0])).unwrap()
    }

    #[test]
    fn a_quarter_circle_has_radius_and_curvature_one() {
        let c = quarter();
        for k in 0..=20 {
            let j = c.jet(f64::from(k) / 20.0);
            assert!((j.point.coords.norm() - 1.0).abs() < 4e-16);
            assert!((c.point(f64::from(k) / 20.0) - j.point).norm() < 4e-16);
            let cross = j.first.x * j.second.y - j.first.y * j.second.x;
            // A handful of roundings of numbers of size one.
            assert!((cross / j.first.norm().powi(3) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_polyline_keeps_its_chord_and_is_not_wasteful() {
        let c = quarter();
        for chord in [1e-2, 1e-4, 1e-6] {
            let ts = c.polyline(chord).unwrap();
            assert!(ts[0] == 0.0 && ts[ts.len() - 1] == 1.0 && ts.windows(2).all(|w| w[0] < w[1]));
            for w in ts.windows(2) {
                // Sagitta of a unit circle's chord.
                let half = 0.5 * (c.point(w[1]) - c.point(w[0])).norm();
                assert!(1.0 - (1.0 - half * half).sqrt() <= chord * (1.0 + 1e-9));
            }
            // Equal steps with the full sagitta would need this many; halving costs at most twice, the
            // certificate (the middle pole is twice as far as the curve) another root of two.
            let least = (std::f64::consts::FRAC_PI_2 / (8.0 * chord).sqrt()).ceil();
            assert!((ts.len() as f64) < 3.0 * least + 2.0, "{} for {least}", ts.len());
        }
        assert_eq!(c.polyline(0.0), Err(CurveError::Chord { chord: 0.0, least: 0.0 }));
        assert!(c.polyline(f64::NAN).is_err());
        assert!(matches!(c.polyline(1e-300), Err(CurveError::Chord { least, .. }) if least < 1e-12));
    }

    #[test]
    fn every_refusal() {
        let flat = || vec![0.0, 0.0, 1.0, 1.0];
        let ends = || vec![Point3::origin(), Point3::new(1.0, 2.0, 3.0)];
        let knots = NurbsCurve::new(1, vec![0.0; 4], ends(), None).unwrap_err();
        assert_eq!(knots, CurveError::Knots(KnotError::Empty { lo: 0.0, hi: 0.0 }));
        let count = NurbsCurve::new(1, flat(), ends(), Some(vec![1.0])).unwrap_err();
        assert_eq!(count, CurveError::WeightCount { got: 1, need: 2 });
        let zero = NurbsCurve::new(1, flat(), ends(), Some(vec![1.0, 0.0])).unwrap_err();
        assert_eq!(zero, CurveError::Weight { index: 1, got: 0.0 });
        let far = vec![Point3::origin(), Point3::new(1.0, f64::INFINITY, 3.0)];
        let far = NurbsCurve::new(1, flat(), far, None).unwrap_err();
        assert_eq!(far, CurveError::NonFinite { index: 1, coordinate: 1, got: f64::INFINITY });
        let line = NurbsCurve::new(1, flat(), ends(), None).unwrap();
        assert_eq!(line.split(1.0).unwrap_err(), EditError::Outside { got: 1.0, lo: 0.0, hi: 1.0 });
        let empty = line.restricted(Interval::new(0.5, 0.5)).unwrap_err();
        assert_eq!(empty, EditError::Interval { from: 0.5, to: 0.5, lo: 0.0, hi: 1.0 });
        assert!(line.restricted(Interval::new(0.5, f64::NAN)).is_err());
        let often = EditError::Multiplicity { at: 0.5, multiplicity: 2, degree: 1 };
        assert_eq!(line.insert_knot(0.5, 2).unwrap_err(), often);
    }
}
