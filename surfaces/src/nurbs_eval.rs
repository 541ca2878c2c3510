//! Evaluation of a NURBS surface: polynomial pieces precomputed per knot rectangle, and the direct sum over
//! basis functions where they would be too many or too steep.
//!
//! On the rectangle between neighbouring knots the numerator and the denominator are polynomials in `x` and
//! `y`, which run over `[-1, 1]`. Their coefficients are stored once, about an origin of their own near the
//! piece, so that derivatives do not lose digits to the distance from the frame's origin. A jet is then
//! Horner's rule with two derivatives and, for rational surfaces, the quotient rule [The NURBS Book, eq.
//! 4.20]:
//!
//! ```text
//! S = A / w,  S_a = (A_a - w_a S) / w,  S_ab = (A_ab - w_a S_b - w_b S_a - w_ab S) / w
//! ```

use crate::knots::{Knots, MAX_DEGREE};
use crate::nurbs::Net;
use nalgebra::Vector4;
use osculate_geom::{Point3, Uv, Vec3};

/// Above this degree the powers on `[-1, 1]` lose more digits (a bit a degree and direction) than the direct
/// sum.
const MAX_POWER_DEGREE: usize = 7;

/// Most coefficients stored, 8 bytes each: 64 MiB, 130 thousand rational bicubic pieces.
const MAX_COEFFICIENTS: usize = 8 << 20;

/// How a surface is evaluated.
#[derive(Clone)]
pub(crate) enum Evaluator {
    /// Pieces of a polynomial surface.
    Polynomial(Pieces<3>),
    /// Pieces of a rational surface, the weight last.
    Rational(Pieces<4>),
    /// The sum over basis functions.
    Direct,
}

/// Polynomial coefficients of every piece.
#[derive(Clone)]
pub(crate) struct Pieces<const C: usize> {
    /// Coefficients a piece has along u and v.
    terms: [usize; 2],
    /// Pieces along v.
    across: usize,
    /// Piece after piece, v fastest: the place that its coefficients are relative to.
    origins: Vec<Point3>,
    /// Piece after piece: `x^a y^b` at `a * terms[1] + b`.
    coefficients: Vec<[f64; C]>,
    /// Piece after piece: what rounding makes of derivatives by x and y that are zero.
    noise: Vec<f64>,
}

/// Rounding of a derivative, in units of the sum of its terms.
const NOISE: f64 = 4.0 * f64::EPSILON;

/// Value, first derivatives by u and v, second ones by uu, uv and vv.
type Orders<T> = [T; 6];

impl Evaluator {
    pub(crate) fn new(knots: &[Knots; 2], net: &Net) -> Self {
        let terms = [knots[0].degree() + 1, knots[1].degree() + 1];
        let rational = net.weights.as_ref().is_some_and(|w| w.iter().any(|x| *x != w[0]));
        let room = if rational { 4 } else { 3 };
        let count = [knots[0].span_count(), knots[1].span_count(), terms[0], terms[1], room]
            .iter()
            .try_fold(1usize, |product, n| product.checked_mul(*n));
        let fits = count.is_some_and(|n| n <= MAX_COEFFICIENTS);
        if !fits || terms.iter().any(|n| *n > MAX_POWER_DEGREE + 1) {
            Self::Direct
        } else if rational {
            Self::Rational(Pieces::new(knots, net))
        } else {
            Self::Polynomial(Pieces::new(knots, net))
        }
    }

    /// The jet at `at` of the piece over the spans `span`, continued where `at` lies outside them.
    #[inline]
    pub(crate) fn jet(&self, knots: &[Knots; 2], net: &Net, at: Uv, span: [usize; 2]) -> Orders<Vec3> {
        match self {
            Self::Polynomial(pieces) => {
                let (origin, orders, noise) = pieces.orders(knots, at, span);
                let mut jet = orders.map(|c| Vec3::new(c[0], c[1], c[2]));
                jet[0] += origin.coords;
                without_noise(jet, noise)
            }
            Self::Rational(pieces) => {
                let (origin, orders, noise) = pieces.orders(knots, at, span);
                without_noise(quotient(&origin, &orders.map(Vector4::from)), noise)
            }
            Self::Direct => {
                let (origin, orders, noise) = direct(knots, net, at, span);
                without_noise(quotient(&origin, &orders), noise)
            }
        }
    }

    #[inline]
    pub(crate) fn point(&self, knots: &[Knots; 2], net: &Net, at: Uv, span: [usize; 2]) -> Point3 {
        match self {
            Self::Polynomial(pieces) => {
                let (origin, c) = pieces.value(knots, at, span);
                origin + Vec3::new(c[0], c[1], c[2])
            }
            Self::Rational(pieces) => {
                let (origin, c) = pieces.value(knots, at, span);
                origin + Vec3::new(c[0], c[1], c[2]) * (1.0 / c[3])
            }
            Self::Direct => self.jet(knots, net, at, span)[0].into(),
        }
    }
}

/// First derivatives that are all rounding are zero: a side that shrinks to a point has no tangent there, and
/// must not pretend to.
#[inline]
fn without_noise(mut jet: Orders<Vec3>, noise: [f64; 2]) -> Orders<Vec3> {
    for k in 0..2 {
        if jet[k + 1].norm_squared() < noise[k] * noise[k] {
            jet[k + 1] = Vec3::zeros();
        }
    }
    jet
}

/// Coefficients of one piece about `origin`, `(w (P - origin), w)` in powers of x and y, v fastest. The
/// weights are those of `net`, or 1.
pub(crate) fn piece_powers(
    knots: &[Knots; 2],
    net: &Net,
    span: [usize; 2],
    powers: [&[Vec<f64>]; 2],
) -> (Point3, Vec<Vector4<f64>>) {
    let first = [knots[0].first_pole(span[0]), knots[1].first_pole(span[1])];
    let [nu, nv] = [powers[0].len(), powers[1].len()];
    let at = |i: usize, j: usize| (first[0] + i) * net.count[1] + first[1] + j;
    let origin = net.points[at(nu / 2, nv / 2)];
    let pole = |i: usize, j: usize| {
        let w = net.weights.as_ref().map_or(1.0, |w| w[at(i, j)]);
        let d = (net.points[at(i, j)] - origin) * w;
        Vector4::new(d.x, d.y, d.z, w)
    };
    let mut sums = vec![Vector4::zeros(); nu * nv];
    for i in 0..nu {
        // The row of poles along v, in powers of y.
        let mut row = vec![Vector4::zeros(); nv];
        for (j, polynomial) in powers[1].iter().enumerate() {
            let p = pole(i, j);
            for (c, sum) in polynomial.iter().zip(&mut row) {
                *sum += p * *c;
            }
        }
        for (a, c) in powers[0][i].iter().enumerate() {
            for (b, r) in row.iter().enumerate() {
                sums[a * nv + b] += r * *c;
            }
        }
    }
    (origin, sums)
}

impl<const C: usize> Pieces<C> {
    fn new(knots: &[Knots; 2], net: &Net) -> Self {
        let powers =
            [0, 1].map(|a| (0..knots[a].span_count()).map(|s| knots[a].span_powers(s)).collect::<Vec<_>>());
        let mut pieces = Self {
            terms: [knots[0].degree() + 1, knots[1].degree() + 1],
            across: powers[1].len(),
            origins: Vec::new(),
            coefficients: Vec::new(),
            noise: Vec::new(),
        };
        // Equal weights divide out.
        let plain = Net { count: net.count, points: net.points.clone(), weights: None };
        let net = if C == 4 { net } else { &plain };
        for (su, pu) in powers[0].iter().enumerate() {
            for (sv, pv) in powers[1].iter().enumerate() {
                let (origin, sums) = piece_powers(knots, net, [su, sv], [pu, pv]);
                pieces.origins.push(origin);
                // Terms x^a y^b at 1, times the powers that derivatives bring down; the constant term only
                // counts through the weights' derivatives.
                let n = pieces.terms[1];
                let sum: f64 =
                    sums.iter().enumerate().map(|(k, c)| (k / n + k % n) as f64 * c.xyz().norm()).sum();
                let least = sums[0].w - sums[1..].iter().map(|c| c.w.abs()).sum::<f64>();
                pieces.noise.push(NOISE * sum / least.max(0.25 * sums[0].w));
                pieces.coefficients.extend(sums.iter().map(|s| std::array::from_fn(|c| s[c])));
            }
        }
        pieces
    }

    /// The piece at `at`: its origin and coefficients, and x, y with their rates by u, v.
    #[inline]
    fn find(&self, knots: &[Knots; 2], at: Uv, span: [usize; 2]) -> (usize, &[[f64; C]], [f64; 2], [f64; 2]) {
        let (x, rx) = local(&knots[0], span[0], at.u);
        let (y, ry) = local(&knots[1], span[1], at.v);
        let piece = span[0] * self.across + span[1];
        let size = self.terms[0] * self.terms[1];
        (piece, &self.coefficients[piece * size..][..size], [x, y], [rx, ry])
    }

    #[inline]
    fn orders(&self, knots: &[Knots; 2], at: Uv, span: [usize; 2]) -> (Point3, Orders<[f64; C]>, [f64; 2]) {
        let (piece, coefficients, [x, y], [rx, ry]) = self.find(knots, at, span);
        let mut orders = match self.terms {
            // Known counts let the compiler unroll the commonest case.
            [4, 4] => match coefficients.as_chunks::<16>().0 {
                [sixteen] => horner(sixteen, [4, 4], x, y),
                _ => horner(coefficients, [4, 4], x, y),
            },
            terms => horner(coefficients, terms, x, y),
        };
        for (order, rate) in orders[1..].iter_mut().zip([rx, ry, rx * rx, rx * ry, ry * ry]) {
            for c in order {
                *c *= rate;
            }
        }
        let noise = self.noise[piece];
        (self.origins[piece], orders, [noise * rx, noise * ry])
    }

    #[inline]
    fn value(&self, knots: &[Knots; 2], at: Uv, span: [usize; 2]) -> (Point3, [f64; C]) {
        let (piece, coefficients, [x, y], _) = self.find(knots, at, span);
        let mut sum = [0.0; C];
        for row in coefficients.chunks_exact(self.terms[1]).rev() {
            let mut inner = [0.0; C];
            for k in row.iter().rev() {
                for c in 0..C {
                    inner[c] = inner[c] * y + k[c];
                }
            }
            for c in 0..C {
                sum[c] = sum[c] * x + inner[c];
            }
        }
        (self.origins[piece], sum)
    }
}

/// The place of `t` in a span, from -1 to 1, and the rate of that place by t.
#[inline]
fn local(knots: &Knots, span: usize, t: f64) -> (f64, f64) {
    let (lo, hi) = (knots.breaks()[span], knots.breaks()[span + 1]);
    let rate = 1.0 / (hi - lo);
    // Exactly -1 and 1 at the ends.
    (((t - lo) - (hi - t)) * rate, 2.0 * rate)
}

/// Value and derivatives of a polynomial piece by x and y.
#[inline(always)]
fn horner<const C: usize>(coefficients: &[[f64; C]], terms: [usize; 2], x: f64, y: f64) -> Orders<[f64; C]> {
    // Rows of Horner's rule in y: value, first, half the second derivative; each feeds Horner's rule in x.
    let mut s = [[0.0; C]; 6];
    for a in (0..terms[0]).rev() {
        let mut r = [[0.0; C]; 3];
        for b in (0..terms[1]).rev() {
            let k = &coefficients[a * terms[1] + b];
            for c in 0..C {
                r[2][c] = r[2][c] * y + r[1][c];
                r[1][c] = r[1][c] * y + r[0][c];
                r[0][c] = r[0][c] * y + k[c];
            }
        }
        for c in 0..C {
            s[3][c] = s[3][c] * x + s[1][c];
            s[1][c] = s[1][c] * x + s[0][c];
            s[0][c] = s[0][c] * x + r[0][c];
            s[4][c] = s[4][c] * x + s[2][c];
            s[2][c] = s[2][c] * x + r[1][c];
            s[5][c] = s[5][c] * x + r[2][c];
        }
    }
    for k in [3, 5] {
        for c in &mut s[k] {
            *c *= 2.0;
        }
    }
    s
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
            let fast = evaluator.jet(&knots, &net, at, span);
            let slow = Evaluator::Direct.jet(&knots, &net, at, span);
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
