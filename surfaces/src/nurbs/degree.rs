//! Degree elevation and knot removal.
//!
//! Elevation is exact: the blossom of a polynomial f of degree p, taken as one of degree p + 1, is the mean of
//! f's blossom over the ways to leave one argument out, and a pole is the blossom at its own knots
//! ([`crate::refine`]).
//!
//! A knot can only be removed exactly where the spline is smoother than its knots say. Else the poles that
//! belong to it are computed from both sides [The NURBS Book, A5.8] and the answer carries a proven bound of
//! what moved: with P the old poles and Q those of the new spline over the old knots, weights w and v, every
//! point of the new spline is within
//!
//! ```text
//! max ( w_i |P_i - Q_i| + |w_i - v_i| d ) / min w,     d the diameter of the poles' box
//! ```
//!
//! of the old one at the same parameter.

use super::curve::NurbsCurve;
use super::edit_error::EditError;
use super::surface::NurbsSurface;
use crate::knots::{Knots, MAX_DEGREE};
use crate::refine::{clamped_piece, elevated, elevated_means};
use nalgebra::{Point, SVector};
use osculate_geom::{Axis, Point3};

/// A curve with fewer knots, and how far it may have moved.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RemovedCurve<const D: usize> {
    /// The curve.
    pub curve: NurbsCurve<D>,
    /// No point moved farther, in the unit of the poles.
    pub bound: f64,
}

/// A surface with fewer knots, and how far it may have moved.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RemovedSurface {
    /// The surface.
    pub surface: NurbsSurface,
    /// No point moved farther.
    pub bound_mm: f64,
}

/// Checks that the degree may rise.
fn check_degree(knots: &Knots, by: usize) -> Result<(), EditError> {
    let degree = knots.degree().saturating_add(by);
    if degree > MAX_DEGREE { Err(EditError::Degree { degree, most: MAX_DEGREE }) } else { Ok(()) }
}

/// Checks that a knot stands inside the domain often enough.
fn check_removal(knots: &Knots, t: f64, times: usize) -> Result<(), EditError> {
    let [lo, hi] = knots.domain();
    if !(t > lo && t < hi) {
        return Err(EditError::Outside { got: t, lo, hi });
    }
    let multiplicity = knots.multiplicity(t);
    if times > multiplicity { Err(EditError::NoKnot { at: t, multiplicity, times }) } else { Ok(()) }
}

impl<const D: usize> NurbsCurve<D> {
    /// The same curve with its degree `by` higher; clamped where it was not.
    ///
    /// # Errors
    /// [`EditError::Degree`] above [`MAX_DEGREE`].
    pub fn elevated(&self, by: usize) -> Result<Self, EditError> {
        check_degree(self.knots(), by)?;
        let [lo, hi] = self.knots().domain();
        let mut curve = if by == 0 { self.clone() } else { self.over(clamped_piece(self.knots(), lo, hi)) };
        for _ in 0..by {
            let new = elevated(curve.knots());
            curve = curve.changed(curve.degree() + 1, &elevated_means(curve.knots(), &new), new);
        }
        Ok(curve)
    }

    /// The curve with the knot `t` standing `times` less often, near this one.
    ///
    /// # Errors
    /// [`EditError`] for a parameter outside the domain and a knot that does not stand so often.
    pub fn remove_knot(&self, t: f64, times: usize) -> Result<RemovedCurve<D>, EditError> {
        check_removal(self.knots(), t, times)?;
        let weight = |i: usize| self.weights().map_or(1.0, |w| w[i]);
        let mut rows: Vec<Vec<f64>> = (0..self.poles().len())
            .map(|i| self.poles()[i].iter().map(|x| x * weight(i)).chain([weight(i)]).collect())
            .collect();
        let knots = removed(self.knots(), t, times, &mut rows);
        let weights: Option<Vec<f64>> = self.weights().map(|_| rows.iter().map(|r| r[D]).collect());
        if let Some((index, got)) =
            weights.iter().flatten().copied().enumerate().find(|(_, w)| !(*w > 0.0 && w.is_finite()))
        {
            return Err(EditError::Weight { index, got });
        }
        let poles = rows.iter().map(|r| {
            let w = weights.as_ref().map_or(1.0, |_| r[D]);
            Point::from(SVector::from_fn(|c, _| r[c] / w))
        });
        let curve = Self::checked(knots, poles.collect(), weights);
        let back = curve.over(self.knots().as_slice().to_vec());
        let pole = |c: &Self, i: usize| (c.poles()[i], c.weights().map_or(1.0, |w| w[i]));
        let bound = bound(self.poles().len(), |i| (pole(self, i), pole(&back, i)));
        Ok(RemovedCurve { curve, bound })
    }
}

impl NurbsSurface {
    /// The same surface with its degree along an axis `by` higher; clamped there where it was not.
    ///
    /// ```
    /// use osculate_geom::{Axis, Surface, uv};
    /// use osculate_surfaces::gallery;
    /// let s = gallery::m86(1);
    /// let finer = s.elevated(Axis::U, 1)?.insert_knot(Axis::V, 0.4, 1)?;
    /// assert!((finer.point(uv(0.3, 0.7)) - s.point(uv(0.3, 0.7))).norm() < 1e-12);
    /// let back = finer.remove_knot(Axis::V, 0.4, 1)?;
    /// assert!(back.bound_mm < 1e-11);
    /// # Ok::<(), osculate_surfaces::EditError>(())
    /// ```
    ///
    /// # Errors
    /// [`EditError::Degree`] above [`MAX_DEGREE`].
    pub fn elevated(&self, axis: Axis, by: usize) -> Result<Self, EditError> {
        check_degree(self.knots(axis), by)?;
        let [lo, hi] = self.knots(axis).domain();
        let mut surface =
            if by == 0 { self.clone() } else { self.over(axis, clamped_piece(self.knots(axis), lo, hi)) };
        for _ in 0..by {
            let knots = surface.knots(axis);
            let new = elevated(knots);
            surface = surface.changed(axis, knots.degree() + 1, &elevated_means(knots, &new), new);
        }
        Ok(surface)
    }

    /// The surface with the knot `t` along an axis standing `times` less often, near this one.
    ///
    /// # Errors
    /// [`EditError`] for a parameter outside the domain and a knot that does not stand so often.
    pub fn remove_knot(&self, axis: Axis, t: f64, times: usize) -> Result<RemovedSurface, EditError> {
        check_removal(self.knots(axis), t, times)?;
        let count = self.net().count;
        let [along, across] = if axis == Axis::U { count } else { [count[1], count[0]] };
        let place = |k: usize, l: usize| if axis == Axis::U { (k, l) } else { (l, k) };
        // A row of poles across the axis moves as one.
        let mut rows: Vec<Vec<f64>> = (0..along)
            .map(|k| {
                let row = (0..across).flat_map(|l| {
                    let (i, j) = place(k, l);
                    <[f64; 4]>::from(self.homogeneous(i, j))
                });
                row.collect()
            })
            .collect();
        let knots = removed(self.knots(axis), t, times, &mut rows);
        let mut new_count = count;
        new_count[axis as usize] = rows.len();
        let rational = self.net().weights.is_some();
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for i in 0..new_count[0] {
            for j in 0..new_count[1] {
                let (k, l) = place(i, j);
                let h = &rows[k][4 * l..][..4];
                let w = if rational { h[3] } else { 1.0 };
                if !(w > 0.0 && w.is_finite()) {
                    return Err(EditError::Weight { index: points.len(), got: w });
                }
                points.push(Point3::new(h[0] / w, h[1] / w, h[2] / w));
                weights.push(w);
            }
        }
        let net = crate::nurbs::Net { count: new_count, points, weights: rational.then_some(weights) };
        let mut both = self.both_knots().clone();
        both[axis as usize] = knots;
        let surface = Self::checked(both, net, self.side());
        let back = surface.over(axis, self.knots(axis).as_slice().to_vec());
        let pole = |s: &Self, k: usize| (s.net().points[k], s.net().weights.as_ref().map_or(1.0, |w| w[k]));
        let bound_mm = bound(self.net().points.len(), |k| (pole(self, k), pole(&back, k)));
        Ok(RemovedSurface { surface, bound_mm })
    }
}

/// A pole and its weight.
type Weighted<const D: usize> = (Point<f64, D>, f64);

/// The bound of the file's head over `count` pairs of an old and a new pole.
fn bound<const D: usize>(count: usize, pair: impl Fn(usize) -> (Weighted<D>, Weighted<D>)) -> f64 {
    let mut lo = SVector::<f64, D>::repeat(f64::INFINITY);
    let mut hi = -lo;
    let mut least = f64::INFINITY;
    for i in 0..count {
        let ((p, w), (q, _)) = pair(i);
        lo = lo.inf(&p.coords).inf(&q.coords);
        hi = hi.sup(&p.coords).sup(&q.coords);
        least = least.min(w);
    }
    let size = (hi - lo).norm();
    (0..count)
        .map(|i| {
            let ((p, w), (q, v)) = pair(i);
            w * (p - q).norm() + (w - v).abs() * size
        })
        .fold(0.0, f64::max)
        / least
}

/// Removes an inner knot `times` times from rows of homogeneous coordinates.
fn removed(old: &Knots, t: f64, times: usize, rows: &mut Vec<Vec<f64>>) -> Knots {
    let p = old.degree();
    let mut knots = old.as_slice().to_vec();
    for _ in 0..times {
        // The last place of t and how often it stands.
        let r = knots.partition_point(|k| *k <= t) - 1;
        let s = knots.iter().filter(|k| **k == t).count();
        remove_once(p, &knots, [r, s], rows);
        knots.remove(r);
    }
    let poles = rows.len();
    Knots::with_spans(p, knots, poles)
}

/// One round of [The NURBS Book, A5.8], without its test: new rows from both sides, and the one too many in the
/// middle dropped.
fn remove_once(p: usize, knots: &[f64], [r, s]: [usize; 2], rows: &mut Vec<Vec<f64>>) {
    let t = knots[r];
    let share = |i: usize| (t - knots[i]) / (knots[i + p + 1] - knots[i]);
    // Row i of the old spline is share(i) row i + (1 - share(i)) row i - 1 of the new one, for first <= i <= last.
    let (mut i, mut j) = (r - p, r - s);
    while i < j {
        let a = share(i);
        rows[i] = solved(&rows[i], &rows[i - 1], a);
        let b = share(j);
        rows[j] = solved(&rows[j], &rows[j + 1], 1.0 - b);
        i += 1;
        j -= 1;
    }
    if i > j {
        // Two rows for one: their mean.
        rows[i] = rows[i].iter().zip(&rows[j]).map(|(x, y)| 0.5 * (x + y)).collect();
    }
    rows.remove(j);
}

/// x of `whole = a x + (1 - a) known`.
fn solved(whole: &[f64], known: &[f64], a: f64) -> Vec<f64> {
    whole.iter().zip(known).map(|(w, k)| (w - (1.0 - a) * k) / a).collect()
}
