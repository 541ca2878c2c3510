//! Precomputed polynomial pieces of a surface and the kernel that evaluates them.
//!
//! On the rectangle between neighbouring knots numerator and denominator are polynomials in x and y, which run
//! over `[-1, 1]`. A jet is Horner's rule with two derivatives in y on every row and in x on the results:
//!
//! ```text
//! r0 <- r0 t + k,  r1 <- r1 t + r0,  r2 <- r2 t + r1        p, p', p'' / 2
//! ```
//!
//! The kernel is written once over [`Lanes`]: over the four components of one place, or over eight places of
//! one component. Every lane does the same operations in the same order, so that both give the same bits.

use super::net::Net;
use crate::knots::Knots;
use crate::quad::Quad;
use nalgebra::Vector4;
use osculate_geom::lanes::Lanes;
use osculate_geom::{Point3, Uv};

/// Room for a piece's coefficients: 8 bytes each, 64 MiB in all, 130 thousand bicubic pieces. A surface with
/// more is evaluated by the direct sum.
pub(crate) const MAX_COEFFICIENTS: usize = 8 << 20;

/// Rounding of a derivative, in units of the sum of its terms.
pub(crate) const NOISE: f64 = 4.0 * f64::EPSILON;

/// Value, first derivatives by u and v, second ones by uu, uv and vv.
pub(crate) type Orders<T> = [T; 6];

/// One span along one axis: its ends and the reciprocal of its length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    rate: f64,
}

impl Frame {
    /// The place of t, from -1 to 1 (exactly there at the ends).
    #[inline(always)]
    pub(crate) fn local<const N: usize>(&self, t: Lanes<N>) -> Lanes<N> {
        ((t - Lanes::splat(self.lo)) - (Lanes::splat(self.hi) - t)) * Lanes::splat(self.rate)
    }

    /// The rate of that place by t.
    #[inline(always)]
    pub(crate) fn slope(&self) -> f64 {
        2.0 * self.rate
    }
}

/// Polynomial coefficients of every piece.
#[derive(Clone)]
pub(crate) struct Pieces {
    /// Coefficients a piece has along u and v.
    terms: [usize; 2],
    /// Spans along u and v.
    frames: [Vec<Frame>; 2],
    /// Whether the fourth component is a weight; zero otherwise.
    pub(crate) rational: bool,
    /// Piece after piece, v fastest: the place that its coefficients are relative to, and what rounding makes
    /// of derivatives by x and y that are zero.
    heads: Vec<[f64; 4]>,
    /// Piece after piece: `x^a y^b` at `a * terms[1] + b`, components x, y, z, w.
    coefficients: Vec<[f64; 4]>,
}

/// One piece, ready to evaluate.
#[derive(Clone, Copy)]
pub(crate) struct Piece<'a> {
    pub(crate) frames: [&'a Frame; 2],
    pub(crate) terms: [usize; 2],
    pub(crate) origin: [f64; 3],
    pub(crate) noise: f64,
    pub(crate) coefficients: &'a [[f64; 4]],
}

impl Pieces {
    pub(crate) fn new(knots: &[Knots; 2], net: &Net, rational: bool) -> Self {
        let powers =
            [0, 1].map(|a| (0..knots[a].span_count()).map(|s| knots[a].span_powers(s)).collect::<Vec<_>>());
        let frames = [0, 1].map(|a: usize| {
            let ends = knots[a].breaks().windows(2);
            ends.map(|w| Frame { lo: w[0], hi: w[1], rate: 1.0 / (w[1] - w[0]) }).collect()
        });
        let terms = [knots[0].degree() + 1, knots[1].degree() + 1];
        let count = powers[0].len() * powers[1].len();
        let mut pieces = Self {
            terms,
            frames,
            rational,
            heads: Vec::with_capacity(count),
            coefficients: Vec::with_capacity(count * terms[0] * terms[1]),
        };
        // Equal weights divide out.
        let plain: Net;
        let net = if rational || net.weights.is_none() {
            net
        } else {
            plain = Net { count: net.count, points: net.points.clone(), weights: None };
            &plain
        };
        for (su, pu) in powers[0].iter().enumerate() {
            for (sv, pv) in powers[1].iter().enumerate() {
                let (origin, sums) = piece_powers(knots, net, [su, sv], [pu, pv]);
                // Terms x^a y^b at 1, times the powers that derivatives bring down; the constant term only
                // counts through the weights' derivatives.
                let n = pieces.terms[1];
                let sum: f64 =
                    sums.iter().enumerate().map(|(k, c)| (k / n + k % n) as f64 * c.xyz().norm()).sum();
                let least = sums[0].w - sums[1..].iter().map(|c| c.w.abs()).sum::<f64>();
                let noise = NOISE * sum / least.max(0.25 * sums[0].w);
                pieces.heads.push([origin.x, origin.y, origin.z, noise]);
                let weight = |w: f64| if rational { w } else { 0.0 };
                pieces.coefficients.extend(sums.iter().map(|s| [s.x, s.y, s.z, weight(s.w)]));
            }
        }
        pieces
    }

    /// Number of pieces.
    pub(crate) fn count(&self) -> usize {
        self.heads.len()
    }

    /// The number of the piece over two spans.
    #[inline(always)]
    pub(crate) fn number(&self, span: [usize; 2]) -> usize {
        span[0] * self.frames[1].len() + span[1]
    }

    /// The spans of a piece.
    #[inline(always)]
    pub(crate) fn spans(&self, number: usize) -> [usize; 2] {
        [number / self.frames[1].len(), number % self.frames[1].len()]
    }

    /// Lower ends of two spans, and what parameters of the spans are below: their upper ends, which belong to
    /// the next span except at the end of the domain.
    #[inline(always)]
    pub(crate) fn ends(&self, span: [usize; 2]) -> [[f64; 2]; 2] {
        [0, 1].map(|a| {
            let f = &self.frames[a][span[a]];
            [f.lo, if span[a] + 1 == self.frames[a].len() { f.hi.next_up() } else { f.hi }]
        })
    }

    /// Whether parameters are below the upper ends of two spans and not below their lower ends.
    #[inline(always)]
    pub(crate) fn holds(&self, span: [usize; 2], at: Uv) -> bool {
        let [u, v] = [&self.frames[0][span[0]], &self.frames[1][span[1]]];
        u.lo <= at.u && at.u < u.hi && v.lo <= at.v && at.v < v.hi
    }

    /// The piece over two spans.
    #[inline(always)]
    pub(crate) fn piece(&self, span: [usize; 2]) -> Piece<'_> {
        let number = self.number(span);
        let size = self.terms[0] * self.terms[1];
        let [x, y, z, noise] = self.heads[number];
        Piece {
            frames: [&self.frames[0][span[0]], &self.frames[1][span[1]]],
            terms: self.terms,
            origin: [x, y, z],
            noise,
            coefficients: &self.coefficients[number * size..][..size],
        }
    }
}

impl Piece<'_> {
    /// Value and derivatives by u and v of all components at one place, relative to the origin.
    #[inline(always)]
    pub(crate) fn orders<Q: Quad>(&self, q: Q, u: f64, v: f64) -> Orders<Q::V> {
        let x = q.splat(self.frames[0].local(Lanes([u])).0[0]);
        let y = q.splat(self.frames[1].local(Lanes([v])).0[0]);
        // A known count lets the compiler unroll the commonest case.
        let o = match self.coefficients.as_chunks::<16>().0 {
            [sixteen] if self.terms == [4, 4] => horner([4, 4], &OfQuads { q, k: &sixteen[..], x, y }),
            _ => horner(self.terms, &OfQuads { q, k: self.coefficients, x, y }),
        };
        let r = self.rates();
        [
            o[0],
            q.mul(o[1], q.splat(r[0])),
            q.mul(o[2], q.splat(r[1])),
            q.mul(o[3], q.splat(r[2])),
            q.mul(o[4], q.splat(r[3])),
            q.mul(o[5], q.splat(r[4])),
        ]
    }

    /// The same for one component of N places.
    #[inline(always)]
    pub(crate) fn lanes<const N: usize>(
        &self,
        component: usize,
        x: Lanes<N>,
        y: Lanes<N>,
    ) -> Orders<Lanes<N>> {
        let mut orders = match self.coefficients.as_chunks::<16>().0 {
            [sixteen] if self.terms == [4, 4] => {
                horner([4, 4], &OfLanes { component, k: &sixteen[..], x, y })
            }
            _ => horner(self.terms, &OfLanes { component, k: self.coefficients, x, y }),
        };
        let rates = self.rates();
        for k in 0..rates.len() {
            orders[k + 1] = orders[k + 1] * Lanes::splat(rates[k]);
        }
        orders
    }

    /// What turns derivatives by x and y (second ones halved) into those by u and v.
    #[inline(always)]
    fn rates(&self) -> [f64; 5] {
        let [rx, ry] = [self.frames[0].slope(), self.frames[1].slope()];
        [rx, ry, 2.0 * (rx * rx), rx * ry, 2.0 * (ry * ry)]
    }

    /// The value of all components at one place, relative to the origin.
    #[inline(always)]
    pub(crate) fn value(&self, u: f64, v: f64) -> Lanes<4> {
        let x = self.frames[0].local(Lanes::<1>::splat(u)).0[0];
        let y = Lanes::splat(self.frames[1].local(Lanes::<1>::splat(v)).0[0]);
        let row = |terms: usize, a: usize| {
            let row = &self.coefficients[a * terms..][..terms];
            let top = Lanes(row[terms - 1]);
            row[..terms - 1].iter().rev().fold(top, |sum, k| sum * y + Lanes(*k))
        };
        let x = Lanes::splat(x);
        let along = |n: usize, m: usize| (0..n - 1).rev().fold(row(m, n - 1), |sum, a| sum * x + row(m, a));
        match self.terms {
            [4, 4] => along(4, 4),
            [n, m] => along(n, m),
        }
    }

    /// Coefficients of the powers of u and v about a place up to the third order together, numerator relative to the origin and
    /// weight: `[a][b]` of `u^a v^b`. Horner's rule with three derivatives, on plain numbers.
    pub(crate) fn powers_at(&self, u: f64, v: f64) -> [[Vector4<f64>; 4]; 4] {
        let x = self.frames[0].local(Lanes::<1>::splat(u)).0[0];
        let y = self.frames[1].local(Lanes::<1>::splat(v)).0[0];
        let mut sums = [[Vector4::zeros(); 4]; 4];
        for row in self.coefficients.chunks_exact(self.terms[1]).rev() {
            let mut r = [Vector4::zeros(); 4];
            for k in row.iter().rev() {
                for n in (1..4).rev() {
                    r[n] = r[n] * y + r[n - 1];
                }
                r[0] = r[0] * y + Vector4::from(*k);
            }
            for b in 0..4 {
                for a in (1..4 - b).rev() {
                    sums[a][b] = sums[a][b] * x + sums[a - 1][b];
                }
                sums[0][b] = sums[0][b] * x + r[b];
            }
        }
        let [rx, ry] = [self.frames[0].slope(), self.frames[1].slope()];
        let mut by_u = 1.0;
        for (a, row) in sums.iter_mut().enumerate() {
            let mut scale = by_u;
            for c in &mut row[..4 - a] {
                *c *= scale;
                scale *= ry;
            }
            by_u *= rx;
        }
        sums
    }

    /// Squares below which the first derivatives by u and v are rounding alone.
    #[inline(always)]
    pub(crate) fn silent(&self) -> [f64; 2] {
        let (x, y) = (self.noise * self.frames[0].slope(), self.noise * self.frames[1].slope());
        [x * x, y * y]
    }
}

/// A polynomial in x and y at one place of each.
///
/// A trait, where closures would do, since a method can be made part of the caller always: code over a
/// processor's wide registers is only fast where all of it is one function.
trait Polynomial {
    type V: Copy;
    /// The coefficient at a place of the list.
    fn k(&self, place: usize) -> Self::V;
    /// `s x + r`.
    fn x(&self, s: Self::V, r: Self::V) -> Self::V;
    /// `s y + r`.
    fn y(&self, s: Self::V, r: Self::V) -> Self::V;
    fn zero(&self) -> Self::V;
}

/// All components.
struct OfQuads<'a, Q: Quad> {
    q: Q,
    k: &'a [[f64; 4]],
    x: Q::V,
    y: Q::V,
}

impl<Q: Quad> Polynomial for OfQuads<'_, Q> {
    type V = Q::V;
    #[inline(always)]
    fn k(&self, place: usize) -> Q::V {
        self.q.load(&self.k[place])
    }
    #[inline(always)]
    fn x(&self, s: Q::V, r: Q::V) -> Q::V {
        self.q.add(self.q.mul(s, self.x), r)
    }
    #[inline(always)]
    fn y(&self, s: Q::V, r: Q::V) -> Q::V {
        self.q.add(self.q.mul(s, self.y), r)
    }
    #[inline(always)]
    fn zero(&self) -> Q::V {
        self.q.splat(0.0)
    }
}

/// One component of N places.
struct OfLanes<'a, const N: usize> {
    component: usize,
    k: &'a [[f64; 4]],
    x: Lanes<N>,
    y: Lanes<N>,
}

impl<const N: usize> Polynomial for OfLanes<'_, N> {
    type V = Lanes<N>;
    #[inline(always)]
    fn k(&self, place: usize) -> Lanes<N> {
        Lanes::splat(self.k[place][self.component])
    }
    #[inline(always)]
    fn x(&self, s: Lanes<N>, r: Lanes<N>) -> Lanes<N> {
        s * self.x + r
    }
    #[inline(always)]
    fn y(&self, s: Lanes<N>, r: Lanes<N>) -> Lanes<N> {
        s * self.y + r
    }
    #[inline(always)]
    fn zero(&self) -> Lanes<N> {
        Lanes::default()
    }
}

/// Horner's rule in y with two derivatives, the second one halved, for the `terms` coefficients from `first` on.
///
/// The first steps leave out what would be added to zero.
#[inline(always)]
fn taylor<P: Polynomial>(terms: usize, p: &P, first: usize) -> [P::V; 3] {
    let mut r0 = p.k(first + terms - 1);
    if terms == 1 {
        return [r0, p.zero(), p.zero()];
    }
    let mut r1 = r0;
    r0 = p.y(r0, p.k(first + terms - 2));
    if terms == 2 {
        return [r0, r1, p.zero()];
    }
    let mut r2 = r1;
    r1 = p.y(r1, r0);
    r0 = p.y(r0, p.k(first + terms - 3));
    for i in (0..terms - 3).rev() {
        r2 = p.y(r2, r1);
        r1 = p.y(r1, r0);
        r0 = p.y(r0, p.k(first + i));
    }
    [r0, r1, r2]
}

/// Value and derivatives of a polynomial piece by x and y, second ones by xx and yy halved.
#[inline(always)]
fn horner<P: Polynomial>([n, m]: [usize; 2], p: &P) -> Orders<P::V> {
    let [mut s0, mut s2, mut s5] = taylor(m, p, (n - 1) * m);
    let (mut s1, mut s3, mut s4) = (p.zero(), p.zero(), p.zero());
    if n > 1 {
        let r = taylor(m, p, (n - 2) * m);
        (s1, s4) = (s0, s2);
        (s0, s2, s5) = (p.x(s0, r[0]), p.x(s2, r[1]), p.x(s5, r[2]));
    }
    if n > 2 {
        let r = taylor(m, p, (n - 3) * m);
        s3 = s1;
        (s1, s4) = (p.x(s1, s0), p.x(s4, s2));
        (s0, s2, s5) = (p.x(s0, r[0]), p.x(s2, r[1]), p.x(s5, r[2]));
        for a in (0..n - 3).rev() {
            let r = taylor(m, p, a * m);
            s3 = p.x(s3, s1);
            (s1, s4) = (p.x(s1, s0), p.x(s4, s2));
            (s0, s2, s5) = (p.x(s0, r[0]), p.x(s2, r[1]), p.x(s5, r[2]));
        }
    }
    [s0, s1, s2, s3, s4, s5]
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
    let mut row = vec![Vector4::zeros(); nv];
    for i in 0..nu {
        // The row of poles along v, in powers of y.
        row.fill(Vector4::zeros());
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
