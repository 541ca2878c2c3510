//! Curves in space: the view that sweeping, trimming and drawing have of them, and what follows from their
//! derivatives: Frenet frame, curvature, torsion, arc length.
//!
//! With dots for derivatives by the parameter [do Carmo, Differential Geometry of Curves and Surfaces, 1-5]:
//!
//! ```text
//! k = |C' x C''| / |C'|^3,   tau = (C' x C'') . C''' / |C' x C''|^2
//! t' = k b_n,  b_n' = -k t + tau b,  b' = -tau b_n      (by arc length; b_n the principal normal, b = t x b_n)
//! ```

use crate::domain::Interval;
use crate::point::{Axis, Point3, Unit3, Vec3};
use crate::quadrature::{Integral, gauss};
use crate::roots::{End, RootError, bracketed};
use crate::series::{MAX_ORDER, Series, factorial};

/// A parametric curve in space, mm.
///
/// ```
/// use osculate_geom::{Curve, CurveTaylor, Interval, Vec3};
/// /// A thread of radius 6 mm that climbs 8 mm per radian.
/// struct Thread;
/// impl Curve for Thread {
///     fn domain(&self) -> Interval {
///         Interval::new(0.0, 10.0)
///     }
///     fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
///         let rise = |k| [8.0 * t, 8.0].get(k).copied().unwrap_or(0.0);
///         // Every derivative of sine and cosine is a quarter turn further on.
///         let turned = |k: usize| (t + k as f64 * std::f64::consts::FRAC_PI_2).sin_cos();
///         CurveTaylor::from_derivatives(t, order, |k| Vec3::new(6.0 * turned(k).1, 6.0 * turned(k).0, rise(k)))
///     }
/// }
/// // Curvature r / (r^2 + h^2), torsion h / (r^2 + h^2).
/// let frenet = Thread.jet(1.0).frenet()?;
/// assert!((frenet.curvature_per_mm - 0.06).abs() < 1e-14 && (frenet.torsion_per_mm - 0.08).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Curve: Send + Sync {
    /// The parameter interval; ends may be infinite.
    fn domain(&self) -> Interval;

    /// The Taylor polynomial about `t` to `order` (at most [`MAX_ORDER`]): exact derivatives, not differences.
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor;

    /// Point and derivatives to third order.
    fn jet(&self, t: f64) -> CurveJet3 {
        self.taylor(t, 3).jet()
    }

    /// The point alone.
    fn point(&self, t: f64) -> Point3 {
        self.taylor(t, 0).derivative(0).into()
    }

    /// Parameters at which the curve is less smooth than inside, ascending, both ends included.
    fn breaks(&self) -> Vec<f64> {
        let i = self.domain();
        vec![i.lo, i.hi]
    }
}

/// The Taylor polynomial of a curve at a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveTaylor {
    /// The parameter.
    pub t: f64,
    order: usize,
    c: [Vec3; MAX_ORDER + 1],
}

impl CurveTaylor {
    /// The polynomial with coefficient `f(k) = C^(k) / k!`. Orders above [`MAX_ORDER`] are cut to it.
    pub fn from_coefficients(t: f64, order: usize, mut f: impl FnMut(usize) -> Vec3) -> Self {
        let order = order.min(MAX_ORDER);
        let c = std::array::from_fn(|k| if k <= order { f(k) } else { Vec3::zeros() });
        Self { t, order, c }
    }

    /// The polynomial with derivatives `f(k)`.
    pub fn from_derivatives(t: f64, order: usize, mut f: impl FnMut(usize) -> Vec3) -> Self {
        Self::from_coefficients(t, order, |k| f(k) / factorial(k))
    }

    /// Orders of derivatives that are known.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.order
    }

    /// `C^(k) / k!`; NaN above the order.
    #[must_use]
    pub fn coefficient(&self, k: usize) -> Vec3 {
        if k <= self.order { self.c[k] } else { Vec3::repeat(f64::NAN) }
    }

    /// `C^(k)`; NaN above the order.
    #[must_use]
    pub fn derivative(&self, k: usize) -> Vec3 {
        self.coefficient(k) * if k <= self.order { factorial(k) } else { 1.0 }
    }

    /// Point and derivatives to third order.
    #[must_use]
    pub fn jet(&self) -> CurveJet3 {
        CurveJet3 {
            t: self.t,
            point: self.derivative(0).into(),
            first: self.derivative(1),
            second: self.derivative(2),
            third: self.derivative(3),
        }
    }

    /// The coordinates as functions of one parameter of a surface, which moves `rate` times as fast as `t`.
    #[must_use]
    pub fn along(&self, axis: Axis, rate: f64) -> [Series; 3] {
        [0, 1, 2].map(|c| {
            let coefficients: [f64; MAX_ORDER + 1] =
                std::array::from_fn(|k| self.c[k][c] * rate.powi(k as i32));
            Series::along(axis, &coefficients, self.order)
        })
    }

    /// The polynomial with its value moved to `point(value)` and every derivative mapped by the linear `vector`.
    #[must_use]
    pub fn mapped(&self, point: impl Fn(&Point3) -> Point3, vector: impl Fn(&Vec3) -> Vec3) -> Self {
        let moved = |k| if k == 0 { point(&self.c[0].into()).coords } else { vector(&self.c[k]) };
        Self::from_coefficients(self.t, self.order, moved)
    }
}

macro_rules! forward_curve {
    ($($t:ty),*) => {$(
        impl<C: Curve + ?Sized> Curve for $t {
            fn domain(&self) -> Interval {
                (**self).domain()
            }
            fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
                (**self).taylor(t, order)
            }
            fn jet(&self, t: f64) -> CurveJet3 {
                (**self).jet(t)
            }
            fn point(&self, t: f64) -> Point3 {
                (**self).point(t)
            }
            fn breaks(&self) -> Vec<f64> {
                (**self).breaks()
            }
        }
    )*};
}
forward_curve!(&C, Box<C>, std::sync::Arc<C>);

/// A point of a curve with its derivatives by the parameter to third order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveJet3 {
    /// The parameter.
    pub t: f64,
    /// C, mm.
    pub point: Point3,
    /// C'.
    pub first: Vec3,
    /// C''.
    pub second: Vec3,
    /// C'''.
    pub third: Vec3,
}

/// Why a curve has no Frenet frame at a point.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrenetError {
    /// C' vanishes or is no number: a cusp, or a parameter that stands still.
    #[error("the curve stands still at t = {t}: |C'| = {speed_mm:.3e} mm per unit of the parameter")]
    Still {
        /// The parameter.
        t: f64,
        /// |C'|, mm per unit of t.
        speed_mm: f64,
    },
    /// C' and C'' are parallel: the tangent exists, the plane of bending does not.
    #[error(
        "the curve is straight at t = {t} (the sine between C' and C'' is {sine:.3e}): it has a tangent only"
    )]
    Straight {
        /// The parameter.
        t: f64,
        /// Sine of the angle between C' and C''; zero where C'' vanishes.
        sine: f64,
        /// Unit tangent.
        tangent: Unit3,
    },
}

/// The Frenet frame of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Frenet {
    /// Unit tangent.
    pub tangent: Unit3,
    /// Principal normal: towards the centre of curvature.
    pub normal: Unit3,
    /// `tangent x normal`.
    pub binormal: Unit3,
    /// Curvature, 1/mm, positive.
    pub curvature_per_mm: f64,
    /// Torsion, 1/mm, positive for a right-handed helix.
    pub torsion_per_mm: f64,
}

/// Smallest sine between C' and C'' that gives a principal normal: below it rounding of C'' turns the plane of bending
/// by more than a ten-thousandth.
const MIN_SINE: f64 = 1e-12;

impl CurveJet3 {
    /// Unit tangent.
    ///
    /// # Errors
    /// [`FrenetError::Still`].
    pub fn tangent(&self) -> Result<Unit3, FrenetError> {
        let speed_mm = self.first.norm();
        if speed_mm > 0.0 && speed_mm.is_finite() {
            Ok(Unit3::new_unchecked(self.first / speed_mm))
        } else {
            Err(FrenetError::Still { t: self.t, speed_mm })
        }
    }

    /// Curvature, 1/mm; zero where the curve is straight.
    ///
    /// # Errors
    /// [`FrenetError::Still`].
    pub fn curvature_per_mm(&self) -> Result<f64, FrenetError> {
        let t = self.tangent()?;
        Ok(t.cross(&self.second).norm() / self.first.norm_squared())
    }

    /// Frame, curvature and torsion.
    ///
    /// # Errors
    /// [`FrenetError`].
    pub fn frenet(&self) -> Result<Frenet, FrenetError> {
        let tangent = self.tangent()?;
        let bend = tangent.cross(&self.second);
        let (across, size) = (bend.norm(), self.second.norm());
        let sine = if size > 0.0 { across / size } else { 0.0 };
        if !(sine > MIN_SINE && sine.is_finite()) {
            return Err(FrenetError::Straight { t: self.t, sine, tangent });
        }
        let binormal = Unit3::new_unchecked(bend / across);
        let speed = self.first.norm();
        Ok(Frenet {
            tangent,
            normal: Unit3::new_unchecked(binormal.cross(&tangent)),
            binormal,
            curvature_per_mm: across / (speed * speed),
            // (C' x C'') . C''' / |C' x C''|^2 with C' x C'' = speed across b.
            torsion_per_mm: binormal.dot(&self.third) / (speed * across),
        })
    }
}

/// Why there is no point at an arc length.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LengthError {
    /// The curve ends before.
    #[error("{length_mm} mm along the curve are asked for; it is {whole_mm} mm long")]
    Beyond {
        /// Asked for, mm.
        length_mm: f64,
        /// Length of the curve, mm.
        whole_mm: f64,
    },
    /// The equation for the parameter was not solved.
    #[error(transparent)]
    Root(#[from] RootError),
}

/// Halvings of every interval between breaks at most.
const MAX_PANELS: usize = 1 << 10;

/// Arc length over `part`, mm, refined between breaks until two refinements agree to `relative`.
///
/// Where the curve has a cusp inside a panel the refinement converges slowly and the error says how far it came.
///
/// ```
/// use osculate_geom::{Curve, analytic::{Conic, Placement}, curve};
/// let circle = Conic::circle(10.0, Placement::identity())?;
/// let length = curve::length(&circle, circle.domain(), 1e-12);
/// assert!((length.value - std::f64::consts::TAU * 10.0).abs() < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn length(curve: &dyn Curve, part: Interval, relative: f64) -> Integral {
    let speed = |t: f64| curve.taylor(t, 1).derivative(1).norm();
    let mut cuts = vec![part.lo];
    cuts.extend(curve.breaks().into_iter().filter(|t| *t > part.lo && *t < part.hi));
    cuts.push(part.hi);
    let run = |panels: usize| -> f64 { cuts.windows(2).map(|w| gauss(w[0], w[1], panels, speed)).sum() };
    let (mut last, mut panels) = (run(2), 4);
    loop {
        let value = run(panels);
        let error = (value - last).abs();
        if error <= relative * value.abs() || panels >= MAX_PANELS || value.is_nan() {
            return Integral { value, error };
        }
        last = value;
        panels *= 2;
    }
}

/// The parameter `length_mm` along the curve from the beginning of its domain, met to `tolerance_mm`.
///
/// ```
/// use osculate_geom::{analytic::{Conic, Placement}, curve};
/// // 5 mm along a circle of radius 10 is half a radian; 70 mm are more than a turn.
/// let circle = Conic::circle(10.0, Placement::identity())?;
/// assert!((curve::parameter_at(&circle, 5.0, 1e-9)? - 0.5).abs() < 1e-9);
/// assert!(curve::parameter_at(&circle, 70.0, 1e-9).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LengthError`].
pub fn parameter_at(curve: &dyn Curve, length_mm: f64, tolerance_mm: f64) -> Result<f64, LengthError> {
    /// Two refinements of a length agree to this fraction: a digit more than positions on a part carry.
    const RELATIVE: f64 = 1e-13;
    let domain = curve.domain();
    let breaks = curve.breaks();
    let mut before = 0.0;
    for (k, w) in breaks.windows(2).enumerate() {
        let panel = length(curve, Interval::new(w[0], w[1]), RELATIVE).value;
        let last = k + 2 == breaks.len();
        if before + panel >= length_mm || (last && length_mm - before - panel <= tolerance_mm) {
            if length_mm - before >= panel {
                return Ok(w[1]);
            }
            if length_mm < 0.0 || length_mm.is_nan() {
                break;
            }
            let rest = length_mm - before;
            let f = |t: f64| length(curve, Interval::new(w[0], t), RELATIVE).value - rest;
            // A step of the parameter moves the point by the speed at most.
            let speed = (0..=8)
                .map(|i| curve.taylor(w[0] + (w[1] - w[0]) * f64::from(i) / 8.0, 1).derivative(1).norm())
                .fold(panel / (w[1] - w[0]), f64::max);
            let ends = (End { x: w[0], f: -rest }, End { x: w[1], f: panel - rest });
            return Ok(bracketed(ends.0, ends.1, tolerance_mm / speed, f)?.x);
        }
        before += panel;
    }
    let whole_mm = length(curve, domain, RELATIVE).value;
    Err(LengthError::Beyond { length_mm, whole_mm })
}
