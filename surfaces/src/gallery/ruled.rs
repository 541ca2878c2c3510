//! The ruled surfaces of D98, in the paper's parameters: u along the directrices, v along the rule from 0 to 1.

use crate::{Net, NurbsSurface};

use osculate_geom::{Axis, Domain, Interval, Jet2, Point3, Series, Side, Surface, Taylor, Uv};
use std::f64::consts::FRAC_PI_2;

/// The surface of eq. 18 of D98, mm:
///
/// ```text
/// x = 30 u^2 + 10 u + 30 + 20 v u^2 - 10 v u - 10 v
/// y = 100 sqrt(u) - 50 - 100 v sqrt(u) + 90 v - 60 v sin(pi u / 2)
/// z = 70 - 30 u^2 - 130 v + 50 v u^2
/// ```
///
/// At u = 0 the derivative by u is infinite: there is no jet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Eq18;

/// The surface of eq. 18 of D98 over the unit square.
#[must_use]
pub const fn d98_eq18() -> Eq18 {
    Eq18
}

impl Surface for Eq18 {
    fn domain(&self) -> Domain {
        Domain { u: Interval::new(0.0, 1.0), v: Interval::new(0.0, 1.0) }
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.taylor(uv, 2).jet2()
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let at = self.domain().bring(uv);
        let (u, v) = (Series::variable(Axis::U, at.u, order), Series::variable(Axis::V, at.v, order));
        let one = Series::constant(1.0, order);
        let (u2, root) = (u * u, u.sqrt());
        let (sin, _) = (u * FRAC_PI_2).sin_cos();
        let x = u2 * 30.0 + u * 10.0 + one * 30.0 + v * (u2 * 20.0 - u * 10.0 - one * 10.0);
        let y = root * 100.0 - one * 50.0 + v * (one * 90.0 - root * 100.0 - sin * 60.0);
        let z = one * 70.0 - u2 * 30.0 + v * (u2 * 50.0 - one * 130.0);
        Taylor { uv: at, side: Side::Along, coordinates: [x, y, z] }
    }
    fn point(&self, uv: Uv) -> Point3 {
        let at = self.domain().bring(uv);
        let (u, v, root) = (at.u, at.v, at.u.sqrt());
        Point3::new(
            30.0 * u * u + 10.0 * u + 30.0 + v * (20.0 * u * u - 10.0 * u - 10.0),
            100.0 * root - 50.0 + v * (90.0 - 100.0 * root - 60.0 * (FRAC_PI_2 * u).sin()),
            70.0 - 30.0 * u * u + v * (50.0 * u * u - 130.0),
        )
    }
}

/// Liu's surface as D98 gives it: from the line (u, 20.429, 0) to the parabola (u, 0.0382 u^2, 33.995), u from 0 to
/// 23.014 mm.
#[must_use]
pub fn d98_liu() -> NurbsSurface {
    const END: f64 = 23.014;
    let pole = |u: f64, y: f64, z: f64| Point3::new(u, y, z);
    // The parabola y = c u^2 over [0, e] has the Bezier heights 0, 0 and c e^2.
    let points = vec![
        pole(0.0, 20.429, 0.0),
        pole(0.0, 0.0, 33.995),
        pole(0.5 * END, 20.429, 0.0),
        pole(0.5 * END, 0.0, 33.995),
        pole(END, 20.429, 0.0),
        pole(END, 0.0382 * END * END, 33.995),
    ];
    let net = Net { count: [3, 2], points, weights: None };
    NurbsSurface::new([2, 1], [vec![0.0, 0.0, 0.0, END, END, END], vec![0.0, 0.0, 1.0, 1.0]], net)
        .expect("six finite poles over clamped knots")
}

/// Sizes that make no hyperbolic paraboloid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what} is {got}; it must be {need}")]
#[non_exhaustive]
pub struct HyperbolicSize {
    /// Which size.
    pub what: &'static str,
    /// Its value.
    pub got: f64,
    /// What it may be.
    pub need: &'static str,
}

/// The hyperbolic paraboloid of D98's figure 7 between two straight directrices at the distance `h_mm`: at the middle
/// rule, u = 1/2, the rule has the length h and the normals at its ends enclose `alpha_rad`. The directrices are h long and lie
/// across the rule, turned by half the angle each.
///
/// ```
/// use osculate_geom::{Surface, uv};
/// use osculate_surfaces::gallery;
/// // The middle rule is h long, and the normals at its ends are as far apart as asked for.
/// let s = gallery::d98_hyperbolic(80.0, 30f64.to_radians())?;
/// let [low, high] = [uv(0.5, 0.0), uv(0.5, 1.0)].map(|at| s.jet2(at));
/// assert!(((high.point - low.point).norm() - 80.0).abs() < 1e-12);
/// let (low, high) = (low.normal()?, high.normal()?);
/// assert!((low.dot(&high) - 30f64.to_radians().cos()).abs() < 1e-12);
/// assert!(gallery::d98_hyperbolic(-80.0, 0.5).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`HyperbolicSize`] unless h is positive and the angle between 0 and a half turn, both excluded.
pub fn d98_hyperbolic(h_mm: f64, alpha_rad: f64) -> Result<NurbsSurface, HyperbolicSize> {
    if !(h_mm > 0.0 && h_mm.is_finite()) {
        return Err(HyperbolicSize { what: "h_mm", got: h_mm, need: "positive and finite" });
    }
    if !(alpha_rad > 0.0 && alpha_rad < std::f64::consts::PI) {
        return Err(HyperbolicSize { what: "alpha", got: alpha_rad, need: "between 0 and 180 degrees" });
    }
    let (s, c) = (0.5 * alpha_rad).sin_cos();
    let r = 0.5 * h_mm;
    let pole = |along: f64, v: f64, sign: f64| Point3::new(along * c, sign * along * s, v * h_mm);
    let points = vec![pole(-r, 0.0, 1.0), pole(-r, 1.0, -1.0), pole(r, 0.0, 1.0), pole(r, 1.0, -1.0)];
    let net = Net { count: [2, 2], points, weights: None };
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    Ok(NurbsSurface::new([1, 1], [knots.clone(), knots], net).expect("four finite poles over clamped knots"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{laws, uv};

    /// The reference values of D98's surfaces: rule length and angle between the end normals.
    #[test]
    fn rules_have_the_known_lengths_and_twists() {
        let twist = |s: &dyn Surface, u: f64| {
            let [a, b] = [0.0, 1.0].map(|v| s.jet2(uv(u, v)));
            let rule = b.point - a.point;
            let n = [a, b].map(|j| j.du.cross(&rule));
            (rule.norm(), n[0].angle(&n[1]).to_degrees())
        };
        let (length, angle) = twist(&d98_eq18(), 0.4);
        assert!((length - 122.772_576_426_018).abs() < 1e-11 && (angle - 129.463_643_468_2).abs() < 1e-9);
        let h = d98_hyperbolic(80.0, 30f64.to_radians()).unwrap();
        let (length, angle) = twist(&h, 0.5);
        assert!((length - 80.0).abs() < 1e-12 && (angle - 30.0).abs() < 1e-12);
        let liu = d98_liu();
        let p = liu.point(uv(10.0, 1.0));
        assert!((p - Point3::new(10.0, 3.82, 33.995)).norm() < 1e-13);
        assert!(d98_hyperbolic(0.0, 1.0).is_err() && d98_hyperbolic(1.0, f64::NAN).is_err());
    }

    #[test]
    fn eq18_obeys_the_laws() {
        for at in [uv(0.3, 0.2), uv(0.7, 0.9)] {
            laws::jets_match_differences(&Eq18, at, 1e-5, 1e-7);
            assert!((Eq18.point(at) - Eq18.jet2(at).point).norm() < 1e-12);
        }
        assert!(Eq18.jet2(uv(0.0, 0.5)).forms().is_err());
    }
}
