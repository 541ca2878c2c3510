//! Evaluation of a NURBS surface: polynomial pieces precomputed per knot rectangle, and the direct sum over
//! basis functions where they would be too many or too steep.
//!
//! On the rectangle between neighbouring knots the numerator and the denominator are polynomials
//! ([`super::pieces`]). Their coefficients are stored once, about an origin of their own near the piece, so
//! that derivatives do not lose digits to the distance from the frame's origin. For rational surfaces the
//! quotient rule follows [The NURBS Book, eq. 4.20]:
//!
//! ```text
//! S = A / w,  S_a = (A_a - w_a S) / w,  S_ab = (A_ab - w_a S_b - w_b S_a - w_ab S) / w
//! ```

use super::net::Net;
use super::pieces::{MAX_COEFFICIENTS, NOISE, Orders, Pieces};
use crate::knots::{Knots, MAX_DEGREE};
use crate::quad::Quad;
use nalgebra::Vector4;
use osculate_geom::{Point3, Uv, Vec3};

/// Above this degree the powers on `[-1, 1]` lose more digits (a bit a degree and direction) than the direct
/// sum.
const MAX_POWER_DEGREE: usize = 7;

/// How a surface is evaluated.
#[derive(Clone)]
pub(crate) enum Evaluator {
    /// Precomputed pieces.
    Pieces(Pieces),
    /// The sum over basis functions.
    Direct,
}

impl Evaluator {
    pub(crate) fn new(knots: &[Knots; 2], net: &Net) -> Self {
        let terms = [knots[0].degree() + 1, knots[1].degree() + 1];
        let rational = net.weights.as_ref().is_some_and(|w| w.iter().any(|x| *x != w[0]));
        let count = [knots[0].span_count(), knots[1].span_count(), terms[0], terms[1], 4]
            .iter()
            .try_fold(1usize, |product, n| product.checked_mul(*n));
        let fits = count.is_some_and(|n| n <= MAX_COEFFICIENTS);
        if !fits || terms.iter().any(|n| *n > MAX_POWER_DEGREE + 1) {
            Self::Direct
        } else {
            Self::Pieces(Pieces::new(knots, net, rational))
        }
    }

    /// The precomputed pieces, where there are any.
    pub(crate) const fn pieces(&self) -> Option<&Pieces> {
        match self {
            Self::Pieces(pieces) => Some(pieces),
            Self::Direct => None,
        }
    }

    /// The jet by the direct sum at `at` of the piece over the spans `span`, continued where `at` lies outside
    /// them.
    pub(crate) fn direct(knots: &[Knots; 2], net: &Net, at: Uv, span: [usize; 2]) -> Orders<Vec3> {
        let (origin, orders, noise) = direct(knots, net, at, span);
        without_noise(quotient(&origin, &orders), noise.map(|x| x * x))
    }

    #[inline]
    pub(crate) fn point(&self, knots: &[Knots; 2], net: &Net, at: Uv, span: [usize; 2]) -> Point3 {
        match self {
            Self::Pieces(pieces) => {
                let piece = pieces.piece(span);
                let c = piece.value(at.u, at.v).0;
                let r = if pieces.rational { 1.0 / c[3] } else { 1.0 };
                Point3::from(piece.origin) + Vec3::new(c[0], c[1], c[2]) * r
            }
            Self::Direct => Self::direct(knots, net, at, span)[0].into(),
        }
    }
}

/// The jet at a place of a precomputed piece, continued where the place lies outside it.
#[inline(always)]
pub(crate) fn piece_orders<Q: Quad>(q: Q, pieces: &Pieces, at: Uv, span: [usize; 2]) -> Orders<Vec3> {
    let piece = pieces.piece(span);
    let mut orders = piece.orders(q, at.u, at.v);
    if pieces.rational {
        orders = quotient_of_quads(q, orders);
    }
    let [x, y, z] = piece.origin;
    let [s, su, sv, suu, suv, svv] = orders;
    let s = q.add(s, q.load(&[x, y, z, 0.0]));
    let jet = [vector(q, s), vector(q, su), vector(q, sv), vector(q, suu), vector(q, suv), vector(q, svv)];
    without_noise(jet, piece.silent())
}

#[inline(always)]
fn vector<Q: Quad>(q: Q, c: Q::V) -> Vec3 {
    let [x, y, z, _] = q.array(c);
    Vec3::new(x, y, z)
}

/// The quotient rule for `(x, y, z, w)`.
#[inline(always)]
fn quotient_of_quads<Q: Quad>(q: Q, a: Orders<Q::V>) -> Orders<Q::V> {
    let (wu, wv) = (q.splat_last(a[1]), q.splat_last(a[2]));
    let (wuu, wuv, wvv) = (q.splat_last(a[3]), q.splat_last(a[4]), q.splat_last(a[5]));
    let r = q.div(q.splat(1.0), q.splat_last(a[0]));
    let s = q.mul(a[0], r);
    let su = q.mul(q.sub(a[1], q.mul(s, wu)), r);
    let sv = q.mul(q.sub(a[2], q.mul(s, wv)), r);
    let suu = q.mul(q.sub(q.sub(a[3], q.mul(su, q.add(wu, wu))), q.mul(s, wuu)), r);
    let suv = q.mul(q.sub(q.sub(q.sub(a[4], q.mul(sv, wu)), q.mul(su, wv)), q.mul(s, wuv)), r);
    let svv = q.mul(q.sub(q.sub(a[5], q.mul(sv, q.add(wv, wv))), q.mul(s, wvv)), r);
    [s, su, sv, suu, suv, svv]
}

/// First derivatives that are all rounding are zero: a side that shrinks to a point has no tangent there, and
/// must not pretend to.
#[inline(always)]
fn without_noise(mut jet: Orders<Vec3>, silent: [f64; 2]) -> Orders<Vec3> {
    for k in 0..2 {
        if jet[k + 1].norm_squared() < silent[k] {
            jet[k + 1] = Vec3::zeros();
        }
    }
    jet
}

/// The quotient rule for numerators relative to `origin` and denominators.
#[inline]
fn quotient(origin: &Point3, a: &Orders<Vector4<f64>>) -> Orders<Vec3> {
    let r = 1.0 / a[0].w;
    let s = a[0].xyz() * r;
    let su = (a[1].xyz() - s * a[1].w) * r;
    let sv = (a[2].xyz() - s * a[2].w) * r;
    let suu = (a[3].xyz() - su * (2.0 * a[1].w) - s * a[3].w) * r;
    let suv = (a[4].xyz() - sv * a[1].w - su * a[2].w - s * a[4].w) * r;
    let svv = (a[5].xyz() - sv * (2.0 * a[2].w) - s * a[5].w) * r;
    [s + origin.coords, su, sv, suu, suv, svv]
}

/// Sum over the basis functions, about the middle pole of those that act.
fn direct(
    knots: &[Knots; 2],
    net: &Net,
    at: Uv,
    span: [usize; 2],
) -> (Point3, Orders<Vector4<f64>>, [f64; 2]) {
    let bu = knots[0].basis(span[0], at.u);
    let bv = knots[1].basis(span[1], at.v);
    let [p, q] = [knots[0].degree(), knots[1].degree()];
    let place = |i: usize, j: usize| (bu.first + i) * net.count[1] + bv.first + j;
    let origin = net.points[place(p.div_ceil(2), q.div_ceil(2))];
    let mut sums = [Vector4::zeros(); 6];
    // Sizes of the terms of both first derivatives.
    let mut terms = [0.0; 2];
    for i in 0..=p {
        let mut row = [Vector4::zeros(); 3];
        for j in 0..=q {
            let k = place(i, j);
            let w = net.weights.as_ref().map_or(1.0, |w| w[k]);
            let d = (net.points[k] - origin) * w;
            let pole = Vector4::new(d.x, d.y, d.z, w);
            let size = d.norm();
            terms[0] += size * (bu.order[1][i] * bv.order[0][j]).abs();
            terms[1] += size * (bu.order[0][i] * bv.order[1][j]).abs();
            for (sum, order) in row.iter_mut().zip(&bv.order) {
                *sum += pole * order[j];
            }
        }
        let [n0, n1, n2] = [bu.order[0][i], bu.order[1][i], bu.order[2][i]];
        for (sum, term) in sums.iter_mut().zip([
            row[0] * n0,
            row[0] * n1,
            row[1] * n0,
            row[0] * n2,
            row[1] * n1,
            row[2] * n0,
        ]) {
            *sum += term;
        }
    }
    if net.weights.is_none() {
        // The basis sums to one but for rounding, which must not turn up as a weight.
        for (k, sum) in sums.iter_mut().enumerate() {
            sum.w = if k == 0 { 1.0 } else { 0.0 };
        }
    }
    // The basis itself carries a rounding or two a degree.
    let noise = terms.map(|t| NOISE * (p + q) as f64 * t / sums[0].w);
    (origin, sums, noise)
}

const _: () = assert!(MAX_POWER_DEGREE <= MAX_DEGREE);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quad::Plain;
    use osculate_geom::uv;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn pieces_agree_with_the_direct_sum(
            p in 1usize..=7, q in 1usize..=7, eu in 0usize..4, ev in 0usize..4,
            rational in any::<bool>(),
            numbers in proptest::collection::vec(-1.0f64..1.0, 4 * 121),
            f in 0.0f64..=1.0, g in 0.0f64..=1.0,
        ) {
            let count = [p + 1 + eu, q + 1 + ev];
            let line = |p: usize, n: usize, shift: usize| {
                let inner: Vec<f64> = (0..n - p - 1).map(|k| 0.2 + 0.1 * numbers[shift + k].abs() + k as f64).collect();
                let end = (n - p) as f64;
                let mut k = vec![0.0; p + 1];
                k.extend(inner);
                k.extend(vec![end; p + 1]);
                Knots::new(p, n, k).expect("ascending")
            };
            let knots = [line(p, count[0], 0), line(q, count[1], 10)];
            let total = count[0] * count[1];
            let points = (0..total)
                .map(|k| Point3::new(numbers[4 * k], numbers[4 * k + 1], numbers[4 * k + 2]) * 10.0)
                .collect();
            let weights = rational.then(|| (0..total).map(|k| 1.5 + numbers[4 * k + 3]).collect());
            let net = Net { count, points, weights };
            let evaluator = Evaluator::new(&knots, &net);
            prop_assert!(!matches!(evaluator, Evaluator::Direct));
            let at = uv(f * knots[0].domain()[1], g * knots[1].domain()[1]);
            let span = [knots[0].find(at.u), knots[1].find(at.v)];
            let fast = piece_orders(Plain, evaluator.pieces().expect("checked above"), at, span);
            let slow = Evaluator::direct(&knots, &net, at, span);
            let size = slow.iter().skip(1).fold(10.0_f64, |m, d| m.max(d.norm()));
            for (a, b) in fast.iter().zip(&slow) {
                // Powers of degree 7 in two directions lose up to 14 bits of a result of this size, the
                // quotient rule up to 4 more with weights from 0.5 to 2.5.
                prop_assert!((a - b).norm() <= 2e-16 * f64::from(1 << 16) * size, "{a} {b}");
            }
            prop_assert!((evaluator.point(&knots, &net, at, span).coords - fast[0]).norm() <= 1e-14 * size);
        }
    }
}
