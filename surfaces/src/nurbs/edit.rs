//! Changes to a NURBS surface that keep its shape: more knots, a piece of it, Bezier patches, other
//! directions of the parameters.
//!
//! All are exact up to the rounding of means between poles ([`crate::refine`]); turning and swapping move
//! numbers only. The outward normal stays where it was, so that [`Side`] changes where the sense of `S_u x
//! S_v` does.

use super::edit_error::{EditError, check_insertion, check_piece};
use super::net::Net;
use super::surface::NurbsSurface;
use crate::knots::Knots;
use crate::refine::{Mean, clamped_piece, inserted, means};
use nalgebra::Vector4;
use osculate_geom::{Axis, Domain, Interval, Point3};

/// A polynomial or rational piece of a surface between neighbouring knots, as a Bezier net.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BezierPatch {
    /// The rectangle of the surface that it covers.
    pub domain: Domain,
    /// `degree + 1` poles in each direction.
    pub net: Net,
}

impl NurbsSurface {
    /// The same surface over the finer or shorter knots `new` along an axis.
    pub(crate) fn over(&self, axis: Axis, new: Vec<f64>) -> Self {
        let knots = self.knots(axis);
        self.changed(axis, knots.degree(), &means(knots, &new), new)
    }

    /// The surface with the poles that `means` give over the knots `new` of some degree along an axis.
    pub(crate) fn changed(&self, axis: Axis, degree: usize, means: &[Mean], new: Vec<f64>) -> Self {
        let a = axis as usize;
        let mut count = self.net().count;
        count[a] = means.len();
        let poles = (0..count[0] * count[1]).map(|k| {
            let (i, j) = (k / count[1], k % count[1]);
            match axis {
                Axis::U => means[i].of(|r| self.homogeneous(r, j)),
                Axis::V => means[j].of(|r| self.homogeneous(i, r)),
            }
        });
        let net = net_of(count, poles, self.net().weights.is_some());
        let mut knots = self.both_knots().clone();
        knots[a] = Knots::with_spans(degree, new, count[a]);
        Self::checked(knots, net, self.side())
    }

    /// The same surface with the knot `t` standing `times` more often along an axis.
    ///
    /// # Errors
    /// [`EditError`] for a parameter outside the domain and a knot more often than the degree.
    pub fn insert_knot(&self, axis: Axis, t: f64, times: usize) -> Result<Self, EditError> {
        let knots = self.knots(axis);
        check_insertion(knots, t, times)?;
        Ok(self.over(axis, inserted(knots, t, times)))
    }

    /// The piece over a parameter rectangle, with clamped knots.
    ///
    /// ```
    /// use osculate_geom::{Domain, Interval, Surface, uv};
    /// use osculate_surfaces::gallery;
    /// // Parameters stay, and so do the points.
    /// let whole = gallery::m86(1);
    /// let part = Domain { u: Interval::new(0.2, 0.6), v: Interval::new(0.1, 0.9) };
    /// let piece = whole.restricted(&part)?;
    /// assert_eq!(piece.domain(), part);
    /// assert!((piece.point(uv(0.3, 0.7)) - whole.point(uv(0.3, 0.7))).norm() < 1e-12);
    /// // A rectangle that reaches outside is none.
    /// assert!(whole.restricted(&Domain { u: Interval::new(0.2, 1.6), ..part }).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EditError::Interval`] where the rectangle is empty or reaches outside.
    pub fn restricted(&self, domain: &Domain) -> Result<Self, EditError> {
        let Domain { u, v } = domain;
        check_piece(self.knots(Axis::U), u.lo, u.hi)?;
        check_piece(self.knots(Axis::V), v.lo, v.hi)?;
        let strip = self.over(Axis::U, clamped_piece(self.knots(Axis::U), u.lo, u.hi));
        Ok(strip.over(Axis::V, clamped_piece(self.knots(Axis::V), v.lo, v.hi)))
    }

    /// The two pieces below and above `t` along an axis.
    ///
    /// # Errors
    /// [`EditError::Outside`] unless `t` is inside the domain.
    pub fn split(&self, axis: Axis, t: f64) -> Result<[Self; 2], EditError> {
        let knots = self.knots(axis);
        let [lo, hi] = knots.domain();
        if !(t > lo && t < hi) {
            return Err(EditError::Outside { got: t, lo, hi });
        }
        Ok([[lo, t], [t, hi]].map(|[a, b]| self.over(axis, clamped_piece(knots, a, b))))
    }

    /// The Bezier patches between the knots, v fastest.
    #[must_use]
    pub fn bezier_patches(&self) -> Vec<BezierPatch> {
        // For each axis and span, the means that give the span's Bezier poles from the surface's.
        let spans = |axis: Axis| -> Vec<(Interval, Vec<Mean>)> {
            let knots = self.knots(axis);
            let piece = |w: &[f64]| {
                let ends = [w[0], w[1]].map(|t| std::iter::repeat_n(t, knots.degree() + 1));
                let clamped: Vec<f64> = ends.into_iter().flatten().collect();
                (Interval::new(w[0], w[1]), means(knots, &clamped))
            };
            knots.breaks().windows(2).map(piece).collect()
        };
        let (along, across) = (spans(Axis::U), spans(Axis::V));
        let mut patches = Vec::with_capacity(along.len() * across.len());
        for (u, mu) in &along {
            for (v, mv) in &across {
                let poles = mu
                    .iter()
                    .flat_map(|a| mv.iter().map(move |b| a.of(|i| b.of(|j| self.homogeneous(i, j)))));
                let net = net_of([mu.len(), mv.len()], poles, self.net().weights.is_some());
                patches.push(BezierPatch { domain: Domain { u: *u, v: *v }, net });
            }
        }
        patches
    }

    /// The same surface with one parameter running backwards over the same domain: `t` becomes `lo + hi - t`.
    #[must_use]
    pub fn reversed(&self, axis: Axis) -> Self {
        let mut knots = self.both_knots().clone();
        knots[axis as usize] = knots[axis as usize].reversed();
        let count = self.net().count;
        let net = self.rearranged(count, |i, j| match axis {
            Axis::U => (count[0] - 1 - i, j),
            Axis::V => (i, count[1] - 1 - j),
        });
        Self::checked(knots, net, self.side().flipped())
    }

    /// The same surface with u and v exchanged.
    ///
    /// ```
    /// use osculate_geom::{Surface, uv};
    /// use osculate_surfaces::gallery;
    /// // Exchanging the parameters turns S_u x S_v round, and the side with it: the material stays where it is.
    /// let (s, swapped) = (gallery::m86(2), gallery::m86(2).swapped());
    /// assert!((swapped.point(uv(0.7, 0.3)) - s.point(uv(0.3, 0.7))).norm() < 1e-12);
    /// let normals = [swapped.jet2(uv(0.7, 0.3)).normal()?, s.jet2(uv(0.3, 0.7)).normal()?];
    /// assert!(normals[0].dot(&normals[1]) > 1.0 - 1e-12 && swapped.side() != s.side());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn swapped(&self) -> Self {
        let [u, v] = self.both_knots().clone();
        let [n, m] = self.net().count;
        let net = self.rearranged([m, n], |i, j| (j, i));
        Self::checked([v, u], net, self.side().flipped())
    }

    /// The net whose pole (i, j) is this one's pole `from(i, j)`.
    fn rearranged(&self, count: [usize; 2], from: impl Fn(usize, usize) -> (usize, usize)) -> Net {
        let old = self.net();
        let order = (0..count[0] * count[1]).map(|k| {
            let (i, j) = from(k / count[1], k % count[1]);
            i * old.count[1] + j
        });
        Net {
            count,
            points: order.clone().map(|k| old.points[k]).collect(),
            weights: old.weights.as_ref().map(|w| order.map(|k| w[k]).collect()),
        }
    }
}

/// The net of homogeneous poles.
fn net_of(count: [usize; 2], poles: impl Iterator<Item = Vector4<f64>>, weighted: bool) -> Net {
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for p in poles {
        if weighted {
            points.push(Point3::from(p.xyz() / p.w));
            weights.push(p.w);
        } else {
            points.push(Point3::from(p.xyz()));
        }
    }
    Net { count, points, weights: weighted.then_some(weights) }
}
