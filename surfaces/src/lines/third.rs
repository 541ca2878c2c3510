//! How the fundamental forms change along the surface: what third derivatives are good for.
//!
//! With the outward normal n, `L = S_uu . n` and so on, and Weingarten's `n_u = -(a S_u + b S_v)`, `(a, b)` the column
//! of `I^-1 II`:
//!
//! ```text
//! E_u = 2 S_u . S_uu,   F_u = S_uu . S_v + S_u . S_uv,   ...
//! L_u = S_uuu . n + S_uu . n_u,   ...
//! ```
//!
//! The curvature along a principal direction t, `k = -II(t, t) / I(t, t)`, then changes along t by
//! `-(II_t + k I_t)(t, t) / I(t, t)`: the *extremality*, zero on ridges.

use nalgebra::Matrix2;
use osculate_geom::{Axis, Degenerate, Forms, Surface, Uv};

/// Both fundamental forms in the parameter basis and their derivatives by u and v.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FormsRate {
    /// The forms at the point.
    pub forms: Forms,
    /// I.
    pub first: Matrix2<f64>,
    /// II with the outward normal: negative along a convex direction.
    pub second: Matrix2<f64>,
    /// Derivatives of I by u and v.
    pub first_rate: [Matrix2<f64>; 2],
    /// Derivatives of II by u and v.
    pub second_rate: [Matrix2<f64>; 2],
}

/// The forms at `at` and how they change, from the surface's third-order jet.
///
/// # Errors
/// [`Degenerate`] without a tangent plane.
pub fn forms_rate(surface: &dyn Surface, at: Uv) -> Result<FormsRate, Degenerate> {
    let jet3 = surface.jet3(at);
    let jet = &jet3.jet2;
    let forms = jet.forms()?;
    let n = forms.normal.into_inner();
    let [e, f, g] = forms.first;
    let [l, m, k] = forms.second;
    let first = Matrix2::new(e, f, f, g);
    let second = Matrix2::new(l, m, m, k);
    let det = e * g - f * f;
    let inverse = Matrix2::new(g, -f, -f, e) / det;
    let weingarten = inverse * second;
    let s = [jet.du, jet.dv];
    let ss = [[jet.duu, jet.duv], [jet.duv, jet.dvv]];
    let sss = |i: usize, j: usize, d: usize| match i + j + d {
        0 => jet3.duuu,
        1 => jet3.duuv,
        2 => jet3.duvv,
        _ => jet3.dvvv,
    };
    let mut first_rate = [Matrix2::zeros(); 2];
    let mut second_rate = [Matrix2::zeros(); 2];
    for d in 0..2 {
        let n_d = -(s[0] * weingarten[(0, d)] + s[1] * weingarten[(1, d)]);
        for i in 0..2 {
            for j in 0..2 {
                first_rate[d][(i, j)] = ss[i][d].dot(&s[j]) + s[i].dot(&ss[j][d]);
                second_rate[d][(i, j)] = sss(i, j, d).dot(&n) + ss[i][j].dot(&n_d);
            }
        }
    }
    Ok(FormsRate { forms, first, second, first_rate, second_rate })
}

impl FormsRate {
    /// Mean curvature H and its derivatives by u and v, convex positive.
    #[must_use]
    pub fn mean(&self) -> (f64, [f64; 2]) {
        let (shape, rate) = self.shape();
        (-0.5 * shape.trace(), rate.map(|r| -0.5 * r.trace()))
    }

    /// Gaussian curvature and its derivatives by u and v.
    #[must_use]
    pub fn gauss(&self) -> (f64, [f64; 2]) {
        let (a, rate) = self.shape();
        let derivative = |r: Matrix2<f64>| {
            r[(0, 0)] * a[(1, 1)] + a[(0, 0)] * r[(1, 1)] - r[(0, 1)] * a[(1, 0)] - a[(0, 1)] * r[(1, 0)]
        };
        (self.forms.gauss(), rate.map(derivative))
    }

    /// `(k_1 - k_2)^2` and its derivatives by u and v; smooth at umbilics too.
    #[must_use]
    pub fn difference_squared(&self) -> (f64, [f64; 2]) {
        let w = &self.forms.curvature;
        // From W, where the difference does not cancel; 4 (H^2 - K) would.
        let value = (w[(0, 0)] - w[(1, 1)]).powi(2) + 4.0 * w[(0, 1)].powi(2);
        let (a, rate) = self.shape();
        // With the trace-free part B of I^-1 II: (k_1 - k_2)^2 = 2 tr B^2, whose derivative is 4 tr(B B').
        let b = a - Matrix2::identity() * (0.5 * a.trace());
        (value, rate.map(|r| 4.0 * (b * r).trace()))
    }

    /// The derivative of the curvature form less the metric's share, `-(II_t + k I_t)(t, t)`, along the parameter
    /// rate `t` of unit length on the surface: for a principal direction with curvature `k`, dk/dt.
    #[must_use]
    pub fn extremality(&self, rate: Uv, k_per_mm: f64) -> f64 {
        let c = [rate.get(Axis::U), rate.get(Axis::V)];
        let form = self.along(c) + self.metric_along(c) * k_per_mm;
        -(form[(0, 0)] * c[0] * c[0] + 2.0 * form[(0, 1)] * c[0] * c[1] + form[(1, 1)] * c[1] * c[1])
    }

    /// The cubic form of an umbilic with curvature `k`, in the orthonormal frame whose parameter rates are given:
    /// `[a, b, c, d]` of `(a x^3 + 3 b x^2 y + 3 c x y^2 + d y^3) / 6`, the third-order part of the surface over its
    /// tangent plane, measured into the material.
    #[must_use]
    pub fn cubic(&self, frame: [Uv; 2], k_per_mm: f64) -> [f64; 4] {
        let of = |d: usize, i: usize, j: usize| {
            let c = [frame[d].u, frame[d].v];
            let form = self.along(c) + self.metric_along(c) * k_per_mm;
            let (x, y) = (frame[i], frame[j]);
            -(form[(0, 0)] * x.u * y.u + form[(0, 1)] * (x.u * y.v + x.v * y.u) + form[(1, 1)] * x.v * y.v)
        };
        [of(0, 0, 0), of(1, 0, 0), of(0, 1, 1), of(1, 1, 1)]
    }

    fn along(&self, c: [f64; 2]) -> Matrix2<f64> {
        self.second_rate[0] * c[0] + self.second_rate[1] * c[1]
    }

    fn metric_along(&self, c: [f64; 2]) -> Matrix2<f64> {
        self.first_rate[0] * c[0] + self.first_rate[1] * c[1]
    }

    /// `I^-1 II` and its derivatives `I^-1 (II_d - I_d I^-1 II)`.
    fn shape(&self) -> (Matrix2<f64>, [Matrix2<f64>; 2]) {
        let i = &self.first;
        let inverse = Matrix2::new(i[(1, 1)], -i[(0, 1)], -i[(0, 1)], i[(0, 0)])
            / (i[(0, 0)] * i[(1, 1)] - i[(0, 1)] * i[(0, 1)]);
        let shape = inverse * self.second;
        let rate = [0, 1].map(|d| inverse * (self.second_rate[d] - self.first_rate[d] * shape));
        (shape, rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::{Ellipsoid, Torus};
    use osculate_geom::uv;

    /// Central differences with step h are good to h^2 and eps / h: 1e-9 at h = 1e-5.
    #[test]
    fn rates_match_differences() {
        let surfaces: [Box<dyn Surface>; 2] =
            [Box::new(Ellipsoid::new([3.0, 2.0, 1.0]).unwrap()), Box::new(Torus::new(5.0, 2.0).unwrap())];
        let h = 1e-5;
        for s in &surfaces {
            for at in [uv(0.7, 0.4), uv(2.0, -0.9), uv(4.5, 1.2)] {
                let r = forms_rate(s, at).unwrap();
                for d in 0..2 {
                    let step = [uv(h, 0.0), uv(0.0, h)][d];
                    let ends =
                        [1.0, -1.0].map(|t| forms_rate(s, uv(at.u + t * step.u, at.v + t * step.v)).unwrap());
                    let slope = |f: &dyn Fn(&FormsRate) -> f64| (f(&ends[0]) - f(&ends[1])) / (2.0 * h);
                    assert!((r.mean().1[d] - slope(&|x| x.mean().0)).abs() < 1e-8);
                    assert!((r.gauss().1[d] - slope(&|x| x.gauss().0)).abs() < 1e-8);
                    let difference = slope(&|x| x.difference_squared().0);
                    assert!((r.difference_squared().1[d] - difference).abs() < 1e-8);
                    // The change of k_max along u is the rate's share along both principal directions.
                    let p = r.forms.principal();
                    let jet = s.jet2(at);
                    let t = r.forms.rate(&jet, &p.d_max);
                    let k = |q: f64| {
                        let f = s.jet2(uv(at.u + q * t.u, at.v + q * t.v)).forms().unwrap();
                        f.principal().k_max
                    };
                    let want = (k(h) - k(-h)) / (2.0 * h);
                    assert!((r.extremality(t, p.k_max) - want).abs() < 1e-8);
                }
            }
        }
    }
}
