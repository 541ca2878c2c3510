//! The Taylor polynomials of NURBS surfaces and curves to any order: exact rational derivatives.
//!
//! Numerator and denominator are summed over the basis functions and their derivatives, about a pole near the
//! place, and divided as power series; that is the quotient rule of [The NURBS Book, eq. 4.20] to every order.

use super::curve::NurbsCurve3;
use super::net::Net;
use super::pieces::Pieces;
use crate::knots::Knots;
use nalgebra::Vector4;
use osculate_geom::{Curve, CurveTaylor, Interval, MAX_ORDER, Point3, Series, Side, Taylor, Uv, Vec3};

/// The polynomial of the piece over the spans `span`, continued where `at` lies outside them.
pub(crate) fn taylor(
    knots: &[Knots; 2],
    net: &Net,
    side: Side,
    place: (Uv, [usize; 2]),
    order: usize,
) -> Taylor {
    let (at, span) = place;
    let bu = knots[0].basis_taylor(span[0], at.u, order);
    let bv = knots[1].basis_taylor(span[1], at.v, order);
    let [p, q] = [knots[0].degree(), knots[1].degree()];
    let pole = |i: usize, j: usize| (bu.first + i) * net.count[1] + bv.first + j;
    let origin = net.points[pole(p.div_ceil(2), q.div_ceil(2))];
    let weights = net.weights.as_ref().filter(|w| w.iter().any(|x| *x != w[0]));
    // Coefficient (a, b) of the sum of f over the poles.
    let sum = |f: &dyn Fn(usize) -> f64| {
        Series::from_coefficients(order, |a, b| {
            if a > p || b > q {
                return 0.0;
            }
            let row = |i: usize| -> f64 { (0..=q).map(|j| bv.order[b][j] * f(pole(i, j))).sum() };
            (0..=p).map(|i| bu.order[a][i] * row(i)).sum()
        })
    };
    let mut coordinates =
        [0, 1, 2].map(|c| sum(&|k| (net.points[k][c] - origin[c]) * weights.map_or(1.0, |w| w[k])));
    if let Some(w) = weights {
        let below = sum(&|k| w[k]).recip();
        coordinates = coordinates.map(|c| c * below);
    }
    for (c, series) in coordinates.iter_mut().enumerate() {
        *series = *series + Series::constant(origin[c], order);
    }
    Taylor { uv: at, side, coordinates }
}

/// S_uuu, S_uuv, S_uvv and S_vvv on the piece over the spans `span`: as [`taylor`] has them, without its generality.
pub(crate) fn third(knots: &[Knots; 2], net: &Net, at: Uv, span: [usize; 2]) -> [Vec3; 4] {
    let bu = knots[0].basis_taylor(span[0], at.u, 3);
    let bv = knots[1].basis_taylor(span[1], at.v, 3);
    let [p, q] = [knots[0].degree(), knots[1].degree()];
    let row_of = |i: usize| (bu.first + i) * net.count[1] + bv.first;
    let origin = net.points[row_of(p.div_ceil(2)) + q.div_ceil(2)];
    let weights = net.weights.as_ref().filter(|w| w.iter().any(|x| *x != w[0]));
    // Coefficients of x^a y^b of the numerator about the origin, and of the denominator.
    let mut sums = [[Vector4::zeros(); 4]; 4];
    for i in 0..=p {
        let mut row = [Vector4::zeros(); 4];
        for j in 0..=q {
            let k = row_of(i) + j;
            let w = weights.map_or(1.0, |w| w[k]);
            let d = (net.points[k] - origin) * w;
            let pole = Vector4::new(d.x, d.y, d.z, w);
            for (sum, order) in row.iter_mut().zip(&bv.order) {
                *sum += pole * order[j];
            }
        }
        for (a, along) in sums.iter_mut().enumerate() {
            for (sum, r) in along[..4 - a].iter_mut().zip(&row) {
                *sum += r * bu.order[a][i];
            }
        }
    }
    thirds(&sums, weights.is_some())
}

/// [`third`] of a surface with precomputed pieces.
pub(crate) fn third_of_piece(pieces: &Pieces, at: Uv, span: [usize; 2]) -> [Vec3; 4] {
    thirds(&pieces.piece(span).powers_at(at.u, at.v), pieces.rational)
}

/// The third derivatives from the coefficients `[a][b]` of `u^a v^b` of numerator and, where it counts, denominator.
fn thirds(sums: &[[Vector4<f64>; 4]; 4], rational: bool) -> [Vec3; 4] {
    if !rational {
        return [
            sums[3][0].xyz() * 6.0,
            sums[2][1].xyz() * 2.0,
            sums[1][2].xyz() * 2.0,
            sums[0][3].xyz() * 6.0,
        ];
    }
    let mut s = [[Vec3::zeros(); 4]; 4];
    for n in 0..4 {
        for b in 0..=n {
            let a = n - b;
            // S w = A: what the lower orders leave.
            let mut rest = sums[a][b].xyz();
            for (i, low) in s[..=a].iter().enumerate() {
                for (j, c) in low[..=b].iter().enumerate() {
                    if i + j < n {
                        rest -= c * sums[a - i][b - j].w;
                    }
                }
            }
            s[a][b] = rest / sums[0][0].w;
        }
    }
    [s[3][0] * 6.0, s[2][1] * 2.0, s[1][2] * 2.0, s[0][3] * 6.0]
}

/// A curve in space ends at its ends, closed or not; beyond them it stays there.
impl Curve for NurbsCurve3 {
    fn domain(&self) -> Interval {
        Self::domain(self)
    }

    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        let t = Self::domain(self).bring(t);
        let order = order.min(MAX_ORDER);
        let basis = self.knots().basis_taylor(self.knots().find(t), t, order);
        let (first, p) = (basis.first, self.degree());
        let (poles, weights) =
            (&self.poles()[first..=first + p], self.weights().map(|w| &w[first..=first + p]));
        let origin = poles[p.div_ceil(2)];
        // Coefficients of the numerator about the origin, and of the denominator.
        let mut c = [Vec3::zeros(); MAX_ORDER + 1];
        let mut w = [0.0; MAX_ORDER + 1];
        for (r, pole) in poles.iter().enumerate() {
            let weight = weights.map_or(1.0, |w| w[r]);
            for k in 0..=order {
                c[k] += (pole - origin) * (weight * basis.order[k][r]);
                w[k] += weight * basis.order[k][r];
            }
        }
        if weights.is_some() {
            // C w = A, order by order.
            for k in 0..=order {
                for m in 1..=k {
                    let lower = c[k - m];
                    c[k] -= lower * w[m];
                }
                c[k] /= w[0];
            }
        }
        CurveTaylor::from_coefficients(t, order, |k| if k == 0 { c[0] + origin.coords } else { c[k] })
    }

    fn point(&self, t: f64) -> Point3 {
        Self::point(self, t)
    }

    fn breaks(&self) -> Vec<f64> {
        self.knots().breaks().to_vec()
    }
}

#[cfg(test)]
mod tests {
    use crate::nurbs::{Net, NurbsCurve3, NurbsSurface};
    use osculate_geom::{Curve, Point3, Surface, Vec3, uv};

    /// A bump with weights over a square of two by one spans.
    fn bump(rational: bool) -> NurbsSurface {
        let (nu, nv) = (5, 4);
        let mut points = Vec::new();
        let mut weights = Vec::new();
        for i in 0..nu {
            for j in 0..nv {
                let (x, y) = (i as f64, j as f64);
                points.push(Point3::new(10.0 * x, 10.0 * y, 3.0 * ((1.3 * x + 0.4).sin() + (0.9 * y).cos())));
                weights.push(1.0 + 0.4 * (0.7 * x - 1.1 * y).sin());
            }
        }
        let ku = vec![0.0, 0.0, 0.0, 0.0, 0.6, 1.0, 1.0, 1.0, 1.0];
        let kv = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        let net = Net { count: [nu, nv], points, weights: rational.then_some(weights) };
        NurbsSurface::new([3, 3], [ku, kv], net).unwrap()
    }

    #[test]
    fn first_orders_are_the_jet_and_third_ones_its_differences() {
        for rational in [false, true] {
            let s = bump(rational);
            for at in [uv(0.2, 0.3), uv(0.85, 0.5), uv(0.61, 0.95)] {
                let (jet, t) = (s.jet3(at), s.taylor(at, 6));
                let pairs = [
                    (jet.jet2.point.coords, t.derivative(0, 0)),
                    (jet.jet2.du, t.derivative(1, 0)),
                    (jet.jet2.dv, t.derivative(0, 1)),
                    (jet.jet2.duu, t.derivative(2, 0)),
                    (jet.jet2.duv, t.derivative(1, 1)),
                    (jet.jet2.dvv, t.derivative(0, 2)),
                ];
                for (a, b) in pairs {
                    // Two ways of summing some sixteen terms of size 1000.
                    assert!((a - b).norm() < 1e-11, "{a} {b}");
                }
                // Third orders by pieces and the sum over the poles, which shares nothing with them; by the series, too.
                let direct = super::third(s.both_knots(), s.net(), at, s.span(at));
                for (k, got) in [jet.duuu, jet.duuv, jet.duvv, jet.dvvv].into_iter().enumerate() {
                    let want = t.derivative(3 - k, k);
                    assert!((got - want).norm() < 1e-9 * (1.0 + want.norm()), "{got} {want}");
                    assert!((got - direct[k]).norm() < 1e-9 * (1.0 + want.norm()), "{got} {}", direct[k]);
                }
                let h = 1e-4;
                let (up, um) = (s.jet2(uv(at.u + h, at.v)), s.jet2(uv(at.u - h, at.v)));
                let (vp, vm) = (s.jet2(uv(at.u, at.v + h)), s.jet2(uv(at.u, at.v - h)));
                let d = |a: Vec3, b: Vec3| (a - b) / (2.0 * h);
                // Fifth derivatives are below 1e6, times h^2 / 6; rounding of second derivatives over h is 1e-8.
                for (got, want) in [
                    (jet.duuu, d(up.duu, um.duu)),
                    (jet.duuv, d(vp.duu, vm.duu)),
                    (jet.duuv, d(up.duv, um.duv)),
                    (jet.duvv, d(vp.duv, vm.duv)),
                    (jet.dvvv, d(vp.dvv, vm.dvv)),
                ] {
                    assert!((got - want).norm() < 2e-3, "{at:?} {rational}: {got} {want}");
                }
                // The polynomial itself: order 6 of a cubic is exact where there are no weights.
                if !rational {
                    let (x, y) = (0.1f64, -0.2f64);
                    let mut sum = Vec3::zeros();
                    for i in 0..=3i32 {
                        for j in 0..=3i32 {
                            let f = |n: i32| f64::from((1..=n).product::<i32>());
                            let k = x.powi(i) * y.powi(j) / (f(i) * f(j));
                            sum += t.derivative(i as usize, j as usize) * k;
                        }
                    }
                    let inside = uv(at.u + x, at.v + y);
                    if (at.u < 0.6) == (inside.u < 0.6) && inside.u < 1.0 {
                        assert!((sum - s.point(inside).coords).norm() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn a_curve_is_an_isoparametric_line() {
        for rational in [false, true] {
            let s = bump(rational);
            // The side v = 0: its poles are the first of every row.
            let (net, nv) = (s.net(), s.net().count[1]);
            let poles: Vec<Point3> = net.points.iter().step_by(nv).copied().collect();
            let weights = net.weights.as_ref().map(|w| w.iter().step_by(nv).copied().collect());
            let knots = s.knots(osculate_geom::Axis::U).as_slice().to_vec();
            let c = NurbsCurve3::new(3, knots, poles, weights).unwrap();
            for t in [0.0, 0.2, 0.6, 0.85, 1.0] {
                let (along, side) = (Curve::taylor(&c, t, 6), s.taylor(uv(t, 0.0), 6));
                let inherent = c.jet(t);
                assert!((inherent.second - along.derivative(2)).norm() < 1e-11);
                for k in 0..=6 {
                    let size = side.derivative(k, 0).norm() + 1e3;
                    assert!((along.derivative(k) - side.derivative(k, 0)).norm() < 1e-12 * size, "{t} {k}");
                }
            }
        }
    }
}
