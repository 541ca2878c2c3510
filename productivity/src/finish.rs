//! Productivity of finishing in time: area of the part per minute [R97, eqs. 31 to 35].
//!
//! The machining of a face is a change of parameters `(t, w) -> (u, v)`: t the time, w a parameter along the line that is
//! being finished at t. With J the Jacobian of the change,
//!
//! ```text
//! E_F(t) = d|F|/dt = int sqrt(E G - F^2) |J| dw,  w from w_1(t) to w_2(t)        [R97, eqs. 32, 34, 35]
//! ```
//!
//! Its integral over the time of machining is the area of the face, each place counted as often as it is passed. The mean is
//! area over time [R97, eq. 31]. R97 writes (22), the like for roughing, with `dU dV` where one integral over w is meant.

use osculate_geom::quadrature::gauss;
use osculate_geom::{Surface, Uv};

/// A place of the face as a function of (t, w), with its two derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Parameters of the face.
    pub at: Uv,
    /// Their rate by the time, per min.
    pub by_time: Uv,
    /// Their rate by w.
    pub by_across: Uv,
}

impl Place {
    /// The Jacobian `u_t v_w - u_w v_t` [R97, eq. 21].
    #[must_use]
    pub fn jacobian(&self) -> f64 {
        self.by_time.u * self.by_across.v - self.by_across.u * self.by_time.v
    }
}

/// The line that is being machined at an instant: w from `from` to `to`, cut into panels for the quadrature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Across {
    /// w_1(t).
    pub from: f64,
    /// w_2(t).
    pub to: f64,
    /// Panels of five Gauss nodes.
    pub panels: usize,
}

/// Why an instant has no productivity.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RateError {
    /// The change of parameters folds: parts of the line move forwards, others backwards.
    #[error("the Jacobian of (t, w) -> (u, v) changes its sign at w = {across}, u = {}, v = {}", at.u, at.v)]
    Folds {
        /// w.
        across: f64,
        /// Where.
        at: Uv,
    },
    /// The line or its Jacobian is not finite.
    #[error("the line at this instant is not finite at w = {across}")]
    NotFinite {
        /// w.
        across: f64,
    },
}

/// `E_F(t)`, mm2/min: `line` is the change of parameters at the fixed time, as a function of w.
///
/// ```
/// use osculate_geom::{Domain, Interval, analytic::Plane, uv};
/// use osculate_productivity::finish::{Across, Place, area_rate_mm2_min};
///
/// // A line of 8 mm across the feed goes along u at 600 mm a minute.
/// let plane = Plane::new(Domain { u: Interval::new(0.0, 100.0), v: Interval::new(0.0, 8.0) });
/// let line = |w: f64| Place { at: uv(50.0, w), by_time: uv(600.0, 0.0), by_across: uv(0.0, 1.0) };
/// let rate = area_rate_mm2_min(&plane, Across { from: 0.0, to: 8.0, panels: 2 }, line)?;
/// assert!((rate - 4800.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RateError`].
pub fn area_rate_mm2_min(
    surface: &dyn Surface,
    across: Across,
    line: impl Fn(f64) -> Place,
) -> Result<f64, RateError> {
    weighted_rate(across, line, |at| {
        let jet = surface.jet2(at);
        jet.du.cross(&jet.dv).norm()
    })
}

/// `int f(u, v) |J| dw` with the sign of J watched.
pub(crate) fn weighted_rate(
    across: Across,
    line: impl Fn(f64) -> Place,
    density: impl Fn(Uv) -> f64,
) -> Result<f64, RateError> {
    let (mut positive, mut negative, mut wrong) = (None, None, None);
    let value = gauss(across.from, across.to, across.panels, |w| {
        let place = line(w);
        let j = place.jacobian();
        if !(j.is_finite() && place.at.u.is_finite() && place.at.v.is_finite()) {
            wrong = wrong.or(Some(w));
            return 0.0;
        }
        if j > 0.0 {
            positive = Some((w, place.at));
        } else if j < 0.0 {
            negative = Some((w, place.at));
        }
        j.abs() * density(place.at)
    });
    if let Some(across) = wrong {
        return Err(RateError::NotFinite { across });
    }
    if let (Some(_), Some((across, at))) = (positive, negative) {
        return Err(RateError::Folds { across, at });
    }
    Ok(value.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::{Sphere, Torus};
    use osculate_geom::quadrature::area;
    use osculate_geom::uv;
    use proptest::prelude::*;

    proptest! {
        /// Whatever the change of parameters, its integral over time is the area: here rotated, sheared and bent.
        #[test]
        fn any_change_of_parameters_gives_the_area(turn in 0.1..1.4f64, bend in -0.3..0.3f64, speed in 0.2..5.0f64) {
            let torus = Torus::new(30.0, 11.0).unwrap();
            // (x, w) in the unit square, x = speed t: u = c x - s w + bend x^2, v = s x + c w + bend x w.
            let (s, c) = turn.sin_cos();
            let place = |t: f64, w: f64| {
                let x = speed * t;
                Place {
                    at: uv(c * x - s * w + bend * x * x, s * x + c * w + bend * x * w),
                    by_time: uv(speed * (c + 2.0 * bend * x), speed * (s + bend * w)),
                    by_across: uv(-s, c + bend * x),
                }
            };
            let across = Across { from: 0.0, to: 1.0, panels: 3 };
            let whole = gauss(0.0, 1.0 / speed, 3, |t| {
                area_rate_mm2_min(&torus, across, |w| place(t, w)).unwrap()
            });
            // The same patch by triangles in the image of a fine grid.
            let n = 60u32;
            let p = |i: u32, j: u32| {
                let a = place(f64::from(i) / f64::from(n) / speed, f64::from(j) / f64::from(n)).at;
                torus.point(a)
            };
            let mut by_triangles = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let (a, b, c, d) = (p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1));
                    by_triangles += 0.5 * (c - a).cross(&(d - b)).norm();
                }
            }
            prop_assert!((whole / by_triangles - 1.0).abs() < 3e-4, "{whole} {by_triangles}");
        }
    }

    /// A sphere swept by its meridians at a constant rate of longitude: E_F is constant, and the sum is the area.
    #[test]
    fn a_sphere_by_its_meridians() {
        let sphere = Sphere::new(20.0).unwrap();
        let d = sphere.domain();
        let across = Across { from: d.v.lo, to: d.v.hi, panels: 20 };
        let line = |w: f64| Place { at: uv(1.0, w), by_time: uv(0.5, 0.0), by_across: uv(0.0, 1.0) };
        let got = area_rate_mm2_min(&sphere, across, line).unwrap();
        // 2 R^2 per radian, half a radian per minute.
        assert!((got - 400.0).abs() < 1e-9 * got, "{got}");
        let total = got * (d.u.hi - d.u.lo) / 0.5;
        assert!((total / area(&sphere, 1e-10).value - 1.0).abs() < 1e-8);
    }

    #[test]
    fn a_fold_is_refused() {
        let torus = Torus::new(30.0, 11.0).unwrap();
        let across = Across { from: -1.0, to: 1.0, panels: 2 };
        let fold = |w: f64| Place { at: uv(0.0, w), by_time: uv(w, 0.0), by_across: uv(0.0, 1.0) };
        assert!(matches!(area_rate_mm2_min(&torus, across, fold), Err(RateError::Folds { .. })));
        let nan = |w: f64| Place { at: uv(0.0, w), by_time: uv(f64::NAN, 0.0), by_across: uv(0.0, 1.0) };
        assert!(matches!(area_rate_mm2_min(&torus, across, nan), Err(RateError::NotFinite { .. })));
    }
}
