//! Geodesics on a surface from a point in a direction, by arc length.

use crate::forms::Degenerate;
use crate::point::{Uv, Vec3, uv};
use crate::solve::symmetric;
use crate::surface::Surface;

/// A geodesic's state: parameters and their rate per mm of arc length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeodesicState {
    /// Parameters.
    pub at: Uv,
    /// Parameter rate per mm.
    pub rate: Uv,
}

/// The acceleration of the parameters that keeps the curve's acceleration normal to the surface.
fn acceleration(surface: &dyn Surface, s: GeodesicState) -> Result<Uv, Degenerate> {
    let jet = surface.jet2(s.at);
    let (e, f, g) = (jet.du.dot(&jet.du), jet.du.dot(&jet.dv), jet.dv.dot(&jet.dv));
    let det = e * g - f * f;
    let sin_uv = (det.max(0.0) / (e * g)).sqrt();
    if det.is_nan() || det <= 1e-22 * e * g {
        return Err(Degenerate { at: s.at, sin_uv });
    }
    let second = jet.second(s.rate);
    let (a, b) = (-second.dot(&jet.du), -second.dot(&jet.dv));
    let [u, v] = symmetric([e, f, g], [a, b]);
    Ok(uv(u, v))
}

impl GeodesicState {
    /// The start of the geodesic through `at` along the tangent vector `direction`.
    ///
    /// ```
    /// use osculate_geom::{Vec3, analytic::Sphere, geodesic::GeodesicState, uv};
    /// // Great circles: a quarter turn north from the equator in small steps ends at the pole's latitude.
    /// let ball = Sphere::new(10.0)?;
    /// let mut state = GeodesicState::start(&ball, uv(0.3, 0.0), &Vec3::z())?;
    /// for _ in 0..50 {
    ///     state = state.step(&ball, 10.0 * std::f64::consts::FRAC_PI_4 / 50.0)?;
    /// }
    /// assert!((state.at.v - std::f64::consts::FRAC_PI_4).abs() < 1e-9 && (state.at.u - 0.3).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Degenerate`] without a tangent plane.
    pub fn start(surface: &dyn Surface, at: Uv, direction: &Vec3) -> Result<Self, Degenerate> {
        let jet = surface.jet2(at);
        let forms = jet.forms()?;
        let unit = crate::forms::project_to_tangent(&forms.normal, direction);
        Ok(Self { at, rate: forms.rate(&jet, &unit) })
    }

    /// The rate of [`rate`](Self::rate) per mm of arc length.
    ///
    /// # Errors
    /// [`Degenerate`] without a tangent plane.
    pub fn acceleration(&self, surface: &dyn Surface) -> Result<Uv, Degenerate> {
        acceleration(surface, *self)
    }

    /// The state after `length_mm` more of arc length (negative: back), by one classical Runge-Kutta step.
    /// The local error is of fifth order in `length_mm` times the curvature of the surface.
    ///
    /// # Errors
    /// [`Degenerate`] without a tangent plane on the way.
    pub fn step(self, surface: &dyn Surface, length_mm: f64) -> Result<Self, Degenerate> {
        let h = length_mm;
        let shift = |r: Uv, a: Uv, k: f64| GeodesicState {
            at: uv(self.at.u + k * r.u, self.at.v + k * r.v),
            rate: uv(self.rate.u + k * a.u, self.rate.v + k * a.v),
        };
        let a1 = acceleration(surface, self)?;
        let s2 = shift(self.rate, a1, 0.5 * h);
        let a2 = acceleration(surface, s2)?;
        let s3 = shift(s2.rate, a2, 0.5 * h);
        let a3 = acceleration(surface, s3)?;
        let s4 = shift(s3.rate, a3, h);
        let a4 = acceleration(surface, s4)?;
        let mean = |a: f64, b: f64, c: f64, d: f64| (a + 2.0 * (b + c) + d) / 6.0;
        Ok(Self {
            at: uv(
                self.at.u + h * mean(self.rate.u, s2.rate.u, s3.rate.u, s4.rate.u),
                self.at.v + h * mean(self.rate.v, s2.rate.v, s3.rate.v, s4.rate.v),
            ),
            rate: uv(
                self.rate.u + h * mean(a1.u, a2.u, a3.u, a4.u),
                self.rate.v + h * mean(a1.v, a2.v, a3.v, a4.v),
            ),
        })
    }
}
