//! Jets against exact rational arithmetic: Cox and de Boor's recurrence and the quotient rule in fractions of integers,
//! without any rounding, for Bezier, B-spline and rational surfaces and curves.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use osculate_geom::{Axis, Curve, Point3, Surface, Vec3, uv};
use osculate_surfaces::{Net, NurbsCurve3, NurbsSurface};
use std::ops::{Add, Mul, Sub};

/// A fraction in lowest terms with a positive denominator; overflow ends the test.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fraction {
    over: i128,
    under: i128,
}

fn fraction(over: i128, under: i128) -> Fraction {
    let gcd = |mut a: i128, mut b: i128| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a.abs()
    };
    assert!(under != 0);
    let g = gcd(over, under).max(1) * under.signum();
    Fraction { over: over / g, under: under / g }
}

const fn whole(n: i128) -> Fraction {
    Fraction { over: n, under: 1 }
}

impl Add for Fraction {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let cross = |x: i128, y: i128| x.checked_mul(y).expect("numbers are small");
        let over =
            cross(self.over, b.under).checked_add(cross(b.over, self.under)).expect("numbers are small");
        fraction(over, cross(self.under, b.under))
    }
}

impl Sub for Fraction {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + b * whole(-1)
    }
}

impl Mul for Fraction {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        // Across first, so that products stay small.
        let (x, y) = (fraction(self.over, b.under), fraction(b.over, self.under));
        let product = |x: i128, y: i128| x.checked_mul(y).expect("numbers are small");
        fraction(product(x.over, y.over), product(x.under, y.under))
    }
}

impl Fraction {
    fn recip(self) -> Self {
        fraction(self.under, self.over)
    }
    fn to_f64(self) -> f64 {
        self.over as f64 / self.under as f64
    }
}

/// A polynomial in the step from a parameter, coefficients ascending.
type Polynomial = Vec<Fraction>;

fn times(a: &Polynomial, b: &Polynomial) -> Polynomial {
    let mut c = vec![whole(0); a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            c[i + j] = c[i + j] + *x * *y;
        }
    }
    c
}

/// The basis function i of degree p about t, on the span `[knots[k], knots[k + 1]]`.
fn basis(knots: &[i128], i: usize, p: usize, k: usize, t: Fraction) -> Polynomial {
    if p == 0 {
        return vec![whole(i128::from(i == k))];
    }
    let mut sum = vec![whole(0); p + 1];
    let mut add = |from: i128, to: i128, rising: bool, i: usize| {
        if to == from {
            return;
        }
        let width = whole(to - from).recip();
        // (t + x - from) / width or (to - t - x) / width.
        let line = if rising {
            vec![(t - whole(from)) * width, width]
        } else {
            vec![(whole(to) - t) * width, width * whole(-1)]
        };
        for (s, c) in sum.iter_mut().zip(times(&line, &basis(knots, i, p - 1, k, t))) {
            *s = *s + c;
        }
    };
    add(knots[i], knots[i + p], true, i);
    add(knots[i + 1], knots[i + p + 1], false, i + 1);
    sum
}

/// A surface of integers.
struct Exact {
    degree: [usize; 2],
    knots: [Vec<i128>; 2],
    count: [usize; 2],
    poles: Vec<[i128; 3]>,
    weights: Vec<i128>,
}

/// Orders compared.
const ORDER: usize = 3;

impl Exact {
    /// Numbers that look random, from a multiplicative sequence.
    fn new(degree: [usize; 2], knots: [Vec<i128>; 2], rational: bool) -> Self {
        let count = [0, 1].map(|a| knots[a].len() - degree[a] - 1);
        let mut x = 7i128;
        let mut next = |n: i128| {
            x = x * 48_271 % 2_147_483_647;
            x % n
        };
        let total = count[0] * count[1];
        let poles = (0..total)
            .map(|k| [8 * (k / count[1]) as i128 + next(7), 8 * (k % count[1]) as i128 + next(7), next(15)])
            .collect();
        let weights = (0..total).map(|_| if rational { 1 + next(2) } else { 1 }).collect();
        Self { degree, knots, count, poles, weights }
    }

    fn surface(&self, rational: bool) -> NurbsSurface {
        let points = self.poles.iter().map(|p| Point3::from(p.map(|c| c as f64))).collect();
        let weights = rational.then(|| self.weights.iter().map(|w| *w as f64).collect());
        let knots = [0, 1].map(|a| self.knots[a].iter().map(|k| *k as f64).collect());
        NurbsSurface::new(self.degree, knots, Net { count: self.count, points, weights }).unwrap()
    }

    /// Taylor coefficients of all three coordinates at a place: entry `[i][j]` for `x^i y^j`.
    fn taylor(&self, at: [Fraction; 2]) -> Vec<Vec<[Fraction; 3]>> {
        let side = |a: usize| -> Vec<Polynomial> {
            let (knots, p) = (&self.knots[a], self.degree[a]);
            let inside =
                |k: &usize| at[a].to_f64() >= knots[*k] as f64 && at[a].to_f64() < knots[k + 1] as f64;
            let k = (p..self.count[a]).find(inside).unwrap_or_else(|| {
                // The upper end belongs to the last span.
                (p..self.count[a]).rev().find(|k| knots[*k] < knots[k + 1]).unwrap()
            });
            (0..self.count[a])
                .map(|i| {
                    let mut b = basis(knots, i, p, k, at[a]);
                    b.resize(ORDER + 1, whole(0));
                    b
                })
                .collect()
        };
        let (bu, bv) = (side(0), side(1));
        // Homogeneous coefficients.
        let mut h = vec![vec![[whole(0); 4]; ORDER + 1]; ORDER + 1];
        for (k, (pole, w)) in self.poles.iter().zip(&self.weights).enumerate() {
            let (i, j) = (k / self.count[1], k % self.count[1]);
            for (a, x) in bu[i].iter().enumerate() {
                for (b, y) in bv[j].iter().enumerate() {
                    let f = *x * *y * whole(*w);
                    for c in 0..3 {
                        h[a][b][c] = h[a][b][c] + f * whole(pole[c]);
                    }
                    h[a][b][3] = h[a][b][3] + f;
                }
            }
        }
        // S w = A, coefficient by coefficient.
        let mut s = vec![vec![[whole(0); 3]; ORDER + 1]; ORDER + 1];
        for n in 0..=ORDER {
            for b in 0..=n {
                let a = n - b;
                for c in 0..3 {
                    let mut rest = h[a][b][c];
                    for i in 0..=a {
                        for j in 0..=b {
                            if (i, j) != (a, b) {
                                rest = rest - s[i][j][c] * h[a - i][b - j][3];
                            }
                        }
                    }
                    s[a][b][c] = rest * h[0][0][3].recip();
                }
            }
        }
        s
    }

    /// Every order of the surface's jets at a dyadic place against the fractions.
    fn check(&self, surface: &NurbsSurface, at: [Fraction; 2], digits: f64) {
        let want = self.taylor(at);
        let place = uv(at[0].to_f64(), at[1].to_f64());
        let (jet, t) = (surface.jet3(place), surface.taylor(place, ORDER));
        let exact = |i: usize, j: usize| {
            let f = (1..=i).product::<usize>() * (1..=j).product::<usize>();
            Vec3::from(want[i][j].map(|c| c.to_f64())) * f as f64
        };
        let size = |n: usize| {
            (1..=n)
                .flat_map(|n| (0..=n).map(move |j| (n - j, j)))
                .fold(1.0, |m: f64, (i, j)| m.max(exact(i, j).norm()))
        };
        let close = |got: Vec3, i: usize, j: usize| {
            let off = (got - exact(i, j)).norm();
            let most = digits * if i + j == 0 { 60.0 } else { size(i + j) };
            assert!(
                off <= most,
                "S_{i}{j} at {place:?}: {got:?} against {:?}, off by {off:.2e}",
                exact(i, j)
            );
        };
        let j = jet.jet2;
        close(j.point.coords, 0, 0);
        for (got, a, b) in [(j.du, 1, 0), (j.dv, 0, 1), (j.duu, 2, 0), (j.duv, 1, 1), (j.dvv, 0, 2)] {
            close(got, a, b);
        }
        for (got, a, b) in [(jet.duuu, 3, 0), (jet.duuv, 2, 1), (jet.duvv, 1, 2), (jet.dvvv, 0, 3)] {
            close(got, a, b);
        }
        for n in 0..=ORDER {
            for b in 0..=n {
                close(t.derivative(n - b, b), n - b, b);
            }
        }
    }
}

#[test]
fn jets_are_those_of_exact_fractions() {
    let bezier = |p: usize, end: i128| [vec![0; p + 1], vec![end; p + 1]].concat();
    // One span, several with simple and double knots, and unclamped ends.
    let cases: Vec<([usize; 2], [Vec<i128>; 2])> = vec![
        ([3, 3], [bezier(3, 1), bezier(3, 1)]),
        ([5, 2], [bezier(5, 2), bezier(2, 1)]),
        ([3, 2], [vec![0, 0, 0, 0, 1, 1, 2, 4, 4, 4, 4], vec![0, 0, 0, 1, 3, 3, 3]]),
        ([3, 3], [vec![-2, -1, 0, 1, 2, 3, 4, 5, 7], vec![0, 0, 0, 0, 2, 2, 2, 2]]),
    ];
    for (degree, knots) in cases {
        for rational in [false, true] {
            let exact = Exact::new(degree, knots.clone(), rational);
            let surface = exact.surface(rational);
            let lines = |axis: Axis| -> Vec<Fraction> {
                let b = surface.breaks(axis);
                let (lo, hi) = (b[0] as i128, b[b.len() - 1] as i128);
                (0..=4).map(|k| whole(lo) + fraction((hi - lo) * k, 4)).collect()
            };
            for u in lines(Axis::U) {
                for v in lines(Axis::V) {
                    // A few hundred roundings; a third derivative of a quintic and a quotient lose two digits.
                    exact.check(&surface, [u, v], if rational { 2e-13 } else { 2e-14 });
                }
            }
        }
    }
}

#[test]
fn curves_are_those_of_exact_fractions() {
    let knots: Vec<i128> = vec![0, 0, 0, 0, 1, 1, 2, 4, 4, 4, 4];
    for rational in [false, true] {
        // A surface of degree one across with equal rows is its curve.
        let mut exact = Exact::new([3, 1], [knots.clone(), vec![0, 0, 1, 1]], rational);
        for k in (0..exact.poles.len()).step_by(2) {
            (exact.poles[k + 1], exact.weights[k + 1]) = (exact.poles[k], exact.weights[k]);
        }
        let poles = exact.poles.iter().step_by(2).map(|p| Point3::from(p.map(|c| c as f64))).collect();
        let weights = rational.then(|| exact.weights.iter().step_by(2).map(|w| *w as f64).collect());
        let c = NurbsCurve3::new(3, knots.iter().map(|k| *k as f64).collect(), poles, weights).unwrap();
        for k in 0..=16 {
            let t = fraction(k, 4);
            let want = exact.taylor([t, whole(0)]);
            let got = Curve::taylor(&c, t.to_f64(), ORDER);
            let mut size: f64 = 60.0;
            for (i, w) in want.iter().enumerate() {
                let w = Vec3::from(w[0].map(Fraction::to_f64));
                size = size.max(w.norm());
                assert!((got.coefficient(i) - w).norm() <= 1e-13 * size, "order {i} at {t:?}");
            }
        }
    }
}
