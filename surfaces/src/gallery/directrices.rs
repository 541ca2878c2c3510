//! Directrices of D98's ruled surfaces in closed form, for any sizes of their families.
//!
//! ```text
//! C(u) = sum over k of c_k u^k + r sqrt(u) + s sin(pi u / 2)
//! ```
//!
//! The curves go on beyond their range as their formulas do.

use super::HyperbolicSize;
use osculate_geom::{Axis, Curve, CurveTaylor, Interval, Series, Vec3};
use std::f64::consts::FRAC_PI_2;

/// A curve whose coordinates are cubics with a square root and a sine, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FormulaCurve {
    /// c_0 to c_3.
    pub powers: [Vec3; 4],
    /// r, of sqrt(u).
    pub root: Vec3,
    /// s, of sin(pi u / 2).
    pub sine: Vec3,
    /// The range of u.
    pub range: Interval,
}

impl FormulaCurve {
    /// The polynomial alone.
    #[must_use]
    pub fn cubic(powers: [Vec3; 4], range: Interval) -> Self {
        Self { powers, root: Vec3::zeros(), sine: Vec3::zeros(), range }
    }
}

impl Curve for FormulaCurve {
    fn domain(&self) -> Interval {
        self.range
    }
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        let u = Series::variable(Axis::U, t, order);
        let with_root = self.root != Vec3::zeros();
        let root = if with_root { u.sqrt() } else { Series::constant(0.0, order) };
        let with_sine = self.sine != Vec3::zeros();
        let sine = if with_sine { (u * FRAC_PI_2).sin_cos().0 } else { Series::constant(0.0, order) };
        let [a, b, c, d] = self.powers;
        CurveTaylor::from_coefficients(t, order, |k| {
            // Horner's rule, differentiated k times and divided by k!.
            let power = match k {
                0 => a + (b + (c + d * t) * t) * t,
                1 => b + (c * 2.0 + d * (3.0 * t)) * t,
                2 => c + d * (3.0 * t),
                3 => d,
                _ => Vec3::zeros(),
            };
            let mut sum = power;
            if with_root {
                // At u = 0 the value is known, the derivatives are not finite.
                let c = if k == 0 { t.sqrt() } else { root.coefficient(k, 0) };
                sum += self.root.map(|r| if r == 0.0 { 0.0 } else { r * c });
            }
            if with_sine {
                sum += self.sine * sine.coefficient(k, 0);
            }
            sum
        })
    }
}

/// Sizes of a surface like Liu's: a line `(u, line_mm, 0)` and a parabola `(u, bend u^2, height_mm)` over `0 <= u <= end_mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiuSize {
    /// y of the line, mm.
    pub line_mm: f64,
    /// Factor of u^2, 1/mm.
    pub bend_per_mm: f64,
    /// z of the parabola, mm.
    pub height_mm: f64,
    /// Greatest u, mm.
    pub end_mm: f64,
}

impl Default for LiuSize {
    /// As printed in D98, 4.2.
    fn default() -> Self {
        Self { line_mm: 20.429, bend_per_mm: 0.0382, height_mm: 33.995, end_mm: 23.014 }
    }
}

/// Both directrices of a surface like Liu's.
#[must_use]
pub fn liu_directrices(size: LiuSize) -> [FormulaCurve; 2] {
    let (zero, range) = (Vec3::zeros(), Interval::new(0.0, size.end_mm));
    let line = FormulaCurve::cubic([Vec3::new(0.0, size.line_mm, 0.0), Vec3::x(), zero, zero], range);
    let bend = Vec3::new(0.0, size.bend_per_mm, 0.0);
    let parabola = FormulaCurve::cubic([Vec3::new(0.0, 0.0, size.height_mm), Vec3::x(), bend, zero], range);
    [line, parabola]
}

/// Both directrices of the surface of D98, eq. 18, u from 0 to 1. At u = 0 they have no tangent.
#[must_use]
pub fn eq18_directrices() -> [FormulaCurve; 2] {
    let (v, zero, range) = (Vec3::new, Vec3::zeros(), Interval::new(0.0, 1.0));
    let first = FormulaCurve {
        powers: [v(30.0, -50.0, 70.0), v(10.0, 0.0, 0.0), v(30.0, 0.0, -30.0), zero],
        root: v(0.0, 100.0, 0.0),
        sine: zero,
        range,
    };
    // v = 1: the root cancels.
    let second = FormulaCurve {
        powers: [v(20.0, 40.0, -60.0), zero, v(50.0, 0.0, 20.0), zero],
        root: zero,
        sine: v(0.0, -60.0, 0.0),
        range,
    };
    [first, second]
}

/// Sizes of D98's hyperbolic paraboloid, section 3.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParaboloidSize {
    /// h_p: length of the middle rule, u = 1/2, mm.
    pub height_mm: f64,
    /// alpha_0: between each end normal of the middle rule and their bisector, rad.
    pub half_twist_rad: f64,
    /// k: extent of both directrices along x, mm. The paper takes h_p.
    pub extent_mm: f64,
}

/// Both directrices of D98's hyperbolic paraboloid, `(k u, +-k tan(alpha_0) (u - 1/2), +-h_p/2)`, u from 0 to 1.
///
/// # Errors
/// [`HyperbolicSize`] unless both lengths are positive and the angle is at least 0 and below a right one.
pub fn paraboloid_directrices(size: ParaboloidSize) -> Result<[FormulaCurve; 2], HyperbolicSize> {
    for (what, got) in [("height_mm", size.height_mm), ("extent_mm", size.extent_mm)] {
        if !(got > 0.0 && got.is_finite()) {
            return Err(HyperbolicSize { what, got, need: "positive and finite" });
        }
    }
    if !(size.half_twist_rad >= 0.0 && size.half_twist_rad < FRAC_PI_2) {
        let need = "at least 0 and below 90 degrees";
        return Err(HyperbolicSize { what: "half_twist", got: size.half_twist_rad, need });
    }
    let slope = size.extent_mm * size.half_twist_rad.tan();
    let line = |sign: f64| {
        let at_zero = Vec3::new(0.0, -0.5 * sign * slope, 0.5 * sign * size.height_mm);
        let rate = Vec3::new(size.extent_mm, sign * slope, 0.0);
        FormulaCurve::cubic([at_zero, rate, Vec3::zeros(), Vec3::zeros()], Interval::new(0.0, 1.0))
    };
    Ok([line(1.0), line(-1.0)])
}

#[cfg(test)]
mod tests {
    use super::super::{d98_eq18, d98_liu};
    use super::*;
    use osculate_geom::{Surface, uv};

    /// The directrices are the borders of the surfaces in the gallery, to third order.
    #[test]
    fn they_are_the_borders_of_the_surfaces() {
        let check = |s: &dyn Surface, curves: [FormulaCurve; 2], at: f64| {
            for (v, c) in [0.0, 1.0].into_iter().zip(curves) {
                let (want, got) = (s.taylor(uv(at, v), 3), c.taylor(at, 3));
                for k in 0..=3 {
                    let (want, got) = (want.derivative(k, 0), got.derivative(k));
                    assert!((want - got).norm() < 1e-11 * (1.0 + want.norm()), "{at} {v} {k}: {want} {got}");
                }
            }
        };
        check(&d98_eq18(), eq18_directrices(), 0.37);
        check(&d98_liu(), liu_directrices(LiuSize::default()), 17.3);
    }

    #[test]
    fn the_paraboloid_has_its_sizes() {
        let size = ParaboloidSize { height_mm: 80.0, half_twist_rad: 0.5, extent_mm: 60.0 };
        let [a, b] = paraboloid_directrices(size).unwrap();
        assert!(((a.point(0.5) - b.point(0.5)).norm() - 80.0).abs() < 1e-13);
        let angle = a.taylor(0.2, 1).derivative(1).angle(&b.taylor(0.2, 1).derivative(1));
        assert!((angle - 1.0).abs() < 1e-12);
        assert!((a.point(1.0) - a.point(0.0)).x == 60.0);
        assert!(paraboloid_directrices(ParaboloidSize { height_mm: -1.0, ..size }).is_err());
        assert!(paraboloid_directrices(ParaboloidSize { half_twist_rad: FRAC_PI_2, ..size }).is_err());
        assert!(paraboloid_directrices(ParaboloidSize { extent_mm: f64::NAN, ..size }).is_err());
    }
}
