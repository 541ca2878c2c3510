//! Change of knots without change of shape, by blossoms.
//!
//! A pole of a spline is the blossom of its polynomial at the pole's own inner knots, so the poles over any
//! other knot vector that has the old breaks are blossoms too: one formula inserts knots, cuts out a piece
//! and extracts Bezier segments. Every new pole is a mean of old ones with weights between 0 and 1.
//!
//! Source: [Ramshaw, Blossoms are polar forms; Cohen, Lyche & Riesenfeld, Discrete B-splines].

use crate::knots::Knots;
use nalgebra::SVector;

/// How one new pole follows from old ones.
pub(crate) struct Mean {
    /// The first old pole.
    first: usize,
    /// Weights of the `degree + 1` old poles from there on.
    weights: Vec<f64>,
}

impl Mean {
    /// The new pole from the old ones.
    pub(crate) fn of<const N: usize>(&self, old: impl Fn(usize) -> SVector<f64, N>) -> SVector<f64, N> {
        self.weights.iter().enumerate().fold(SVector::zeros(), |sum, (r, w)| sum + old(self.first + r) * *w)
    }
}

/// The means that give the poles over `new`, a knot vector of the same degree that lies in the old domain and
/// has all old breaks between its ends.
pub(crate) fn means(old: &Knots, new: &[f64]) -> Vec<Mean> {
    let p = old.degree();
    (0..new.len() - p - 1)
        .map(|j| {
            // The piece where this pole's support begins; it may end several pieces later, which the blossom
            // does not notice since the pieces join smoothly up to the multiplicity of the knots between
            // them.
            let (first, weights) = old.blossom(old.find(new[j]), &new[j + 1..=j + p]);
            Mean { first, weights: weights[..=p].to_vec() }
        })
        .collect()
}

/// The knot vector of the piece over `[lo, hi]`, clamped at both ends.
pub(crate) fn clamped_piece(old: &Knots, lo: f64, hi: f64) -> Vec<f64> {
    let ends = old.degree() + 1;
    let inner = old.as_slice().iter().copied().filter(|t| *t > lo && *t < hi);
    std::iter::repeat_n(lo, ends).chain(inner).chain(std::iter::repeat_n(hi, ends)).collect()
}

/// The knot vector with `t` standing `times` more often.
pub(crate) fn inserted(old: &Knots, t: f64, times: usize) -> Vec<f64> {
    let knots = old.as_slice();
    let at = knots.partition_point(|k| *k <= t);
    let mut new = knots[..at].to_vec();
    new.extend(std::iter::repeat_n(t, times));
    new.extend_from_slice(&knots[at..]);
    new
}

/// The knot vector of the same clamped spline taken as one of a degree more: every knot stands once more often.
pub(crate) fn elevated(old: &Knots) -> Vec<f64> {
    old.as_slice()
        .chunk_by(|a, b| a == b)
        .flat_map(|run| std::iter::repeat_n(run[0], run.len() + 1))
        .collect()
}

/// The means that give the poles over [`elevated`] knots.
pub(crate) fn elevated_means(old: &Knots, new: &[f64]) -> Vec<Mean> {
    let p = old.degree();
    (0..new.len() - p - 2)
        .map(|j| {
            let span = old.find(new[j]);
            let arguments = &new[j + 1..=j + p + 1];
            let mut mean = Mean { first: old.first_pole(span), weights: vec![0.0; p + 1] };
            for left_out in 0..=p {
                let rest: Vec<f64> =
                    arguments.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, t)| *t).collect();
                let (_, weights) = old.blossom(span, &rest);
                for (sum, w) in mean.weights.iter_mut().zip(weights) {
                    *sum += w / (p + 1) as f64;
                }
            }
            mean
        })
        .collect()
}
