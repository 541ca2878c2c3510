//! Lines on a surface that a tool can be driven along: isoparametric lines and geodesics.

use crate::curve::{Curve, CurveTaylor};
use crate::domain::Interval;
use crate::forms::Degenerate;
use crate::frame::{Darboux, geodesic_curvature};
use crate::geodesic::GeodesicState;
use crate::point::{Axis, Point3, Uv, Vec3, uv};
use crate::surface::Surface;

/// Why a line has no frame at a parameter.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineError {
    /// The surface has no tangent plane there, or the line stands still.
    #[error(transparent)]
    Degenerate(#[from] Degenerate),
    /// The line has left the surface's parameter rectangle.
    #[error("the line leaves the surface at u = {}, v = {}", at.u, at.v)]
    Outside {
        /// The parameters reached.
        at: Uv,
    },
}

/// A line on a surface, with the Darboux frame at every parameter.
pub trait SurfaceLine: Sync {
    /// Frame at line parameter `t`, and the speed `ds/dt` along the frame's tangent, mm per unit of `t`.
    ///
    /// # Errors
    /// [`LineError`] where there is no frame.
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError>;
}

/// The line of constant parameter: `along` varies, the other parameter is `fixed`.
///
/// ```
/// use osculate_geom::{Axis, Interval, analytic::Cylinder, line::{IsoLine, SurfaceLine}};
/// // Around a shaft of radius 25, at its place on the x axis: a radian is 25 mm, and the line leaves along y.
/// let shaft = Cylinder::new(25.0, Interval::new(0.0, 80.0))?;
/// let around = IsoLine { surface: &shaft, along: Axis::U, fixed: 40.0, reversed: false };
/// let (frame, speed) = around.frame(0.0)?;
/// assert!((speed - 25.0).abs() < 1e-12 && (frame.tangent.y - 1.0).abs() < 1e-15);
/// // Fed the other way the tangent turns round, the normal stays.
/// let (back, _) = IsoLine { reversed: true, ..around }.frame(0.0)?;
/// assert!((back.tangent.y + 1.0).abs() < 1e-15 && back.normal == frame.normal);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct IsoLine<'a> {
    /// The surface.
    pub surface: &'a dyn Surface,
    /// The parameter that varies.
    pub along: Axis,
    /// The value of the other one.
    pub fixed: f64,
    /// False: the feed runs from low to high parameter; true: from high to low. `t` stays the parameter.
    pub reversed: bool,
}

impl IsoLine<'_> {
    /// Surface parameters at line parameter `t`.
    #[must_use]
    pub fn uv(&self, t: f64) -> Uv {
        Uv::from_axis(self.along, t, self.fixed)
    }
}

/// The line as a curve in space, always from low to high parameter.
impl Curve for IsoLine<'_> {
    fn domain(&self) -> Interval {
        self.surface.domain().get(self.along)
    }
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        let all = self.surface.taylor(self.uv(t), order);
        CurveTaylor::from_derivatives(t, all.order(), |k| match self.along {
            Axis::U => all.derivative(k, 0),
            Axis::V => all.derivative(0, k),
        })
    }
    fn point(&self, t: f64) -> Point3 {
        self.surface.point(self.uv(t))
    }
    fn breaks(&self) -> Vec<f64> {
        self.surface.breaks(self.along)
    }
}

impl SurfaceLine for IsoLine<'_> {
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError> {
        let at = self.uv(t);
        if !self.surface.domain().contains(at) {
            return Err(LineError::Outside { at });
        }
        let jet = self.surface.jet2(at);
        let sign = if self.reversed { -1.0 } else { 1.0 };
        let rate = Uv::from_axis(self.along, sign, 0.0);
        let forms = jet.forms()?;
        let direction = jet.tangent(rate);
        let k_g = geodesic_curvature(&jet, rate, uv(0.0, 0.0))?;
        // The tangent follows the feed; the speed carries the sign of t against it.
        Ok((Darboux::with_forms(&jet, &forms, &direction, k_g), sign * direction.norm()))
    }
}

/// The geodesic through a point in a direction; `t` is arc length from there, mm.
#[derive(Clone, Copy)]
pub struct GeodesicLine<'a> {
    surface: &'a dyn Surface,
    start: GeodesicState,
    max_step_mm: f64,
}

impl<'a> GeodesicLine<'a> {
    /// The geodesic through `at` along `direction`, integrated in steps of at most `max_step_mm`.
    ///
    /// ```
    /// use osculate_geom::{Interval, Vec3, analytic::Cylinder, line::GeodesicLine, uv};
    /// // On a cylinder it is a helix: 3 mm around for 4 mm along.
    /// let shaft = Cylinder::new(25.0, Interval::new(0.0, 80.0))?;
    /// let helix = GeodesicLine::new(&shaft, uv(0.0, 10.0), &Vec3::new(0.0, 3.0, 4.0), 1.0)?;
    /// let after = helix.state(50.0)?.at;
    /// assert!((after.u - 30.0 / 25.0).abs() < 1e-12 && (after.v - 50.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Degenerate`] without a tangent plane at the start.
    pub fn new(
        surface: &'a dyn Surface,
        at: Uv,
        direction: &Vec3,
        max_step_mm: f64,
    ) -> Result<Self, Degenerate> {
        Ok(Self { surface, start: GeodesicState::start(surface, at, direction)?, max_step_mm })
    }

    /// Parameters and rate after arc length `t`, mm.
    ///
    /// # Errors
    /// [`LineError`] where the geodesic leaves the surface or meets a place without a tangent plane.
    pub fn state(&self, t: f64) -> Result<GeodesicState, LineError> {
        let steps = (t.abs() / self.max_step_mm).ceil().max(1.0);
        let h = t / steps;
        let mut s = self.start;
        for _ in 0..steps as usize {
            s = s.step(self.surface, h)?;
        }
        if self.surface.domain().contains(s.at) { Ok(s) } else { Err(LineError::Outside { at: s.at }) }
    }
}

impl SurfaceLine for GeodesicLine<'_> {
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError> {
        let s = self.state(t)?;
        let jet = self.surface.jet2(s.at);
        let direction = jet.tangent(s.rate);
        Ok((Darboux::new(&jet, &direction, 0.0)?, direction.norm()))
    }
}

/// Where a path in the parameters is, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState {
    /// Parameters.
    pub at: Uv,
    /// Their rate by the line's parameter.
    pub rate: Uv,
    /// Their acceleration by the line's parameter.
    pub acceleration: Uv,
}

/// Any line on a surface, given as a path in its parameters.
///
/// ```
/// use osculate_geom::line::{PathLine, PathState, SurfaceLine};
/// use osculate_geom::{Domain, Interval, analytic::Plane, uv};
/// // The parabola v = u^2 on a plane: at its vertex it goes along x and turns to the left by 2 rad/mm, about the normal.
/// let side = Interval::new(-5.0, 5.0);
/// let plane = Plane::new(Domain { u: side, v: side });
/// let path = |t: f64| PathState { at: uv(t, t * t), rate: uv(1.0, 2.0 * t), acceleration: uv(0.0, 2.0) };
/// let (frame, speed) = PathLine { surface: &plane, path }.frame(0.0)?;
/// assert!((speed - 1.0).abs() < 1e-15 && (frame.turn.z - 2.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct PathLine<'a, F> {
    /// The surface.
    pub surface: &'a dyn Surface,
    /// The path with two derivatives.
    pub path: F,
}

impl<F: Fn(f64) -> PathState + Sync> SurfaceLine for PathLine<'_, F> {
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError> {
        let s = (self.path)(t);
        if !self.surface.domain().contains(s.at) {
            return Err(LineError::Outside { at: s.at });
        }
        let jet = self.surface.jet2(s.at);
        let forms = jet.forms()?;
        let direction = jet.tangent(s.rate);
        let speed = direction.norm();
        if !(speed > 0.0 && speed.is_finite()) {
            return Err(LineError::Degenerate(Degenerate { at: s.at, sin_uv: 0.0 }));
        }
        let k_g = geodesic_curvature(&jet, s.rate, s.acceleration)?;
        Ok((Darboux::with_forms(&jet, &forms, &direction, k_g), speed))
    }
}
