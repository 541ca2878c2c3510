//! The offset (parallel) surface of any surface, as a surface.
//!
//! ```text
//! O(u, v) = S(u, v) + d n(u, v),   O_u = S_u + d n_u,   n_u = W S_u
//! k' = k / (1 + d k),   dA' = (1 + d k_1)(1 + d k_2) dA
//! ```
//!
//! with n out of the material and k positive where the body is convex: a ball of radius R becomes one of radius R + d.
//! The normal of the offset is the normal of its base, everywhere. Where `1 + d k` reaches zero for a principal
//! curvature the offset has a cusp, and behind it it lies inside out: [`Offset::regular`] is the checked view, and
//! [`clear_range`] the distances for which there is none. That two far parts of an offset cross is not seen here.
//!
//! Derivatives are exact: O to order m takes S to order m + 1. Where the base has a pole the normal is its limit along
//! the parameter lines ([`crate::limit`]): the offset of a cone ends in a circle about the apex.
//!
//! Source: [do Carmo, Differential Geometry of Curves and Surfaces, 3-5, exercise 11; theory of M86: a toroidal cutter
//! is a flat end on the offset].

use crate::diagnostic::Diagnostic;
use crate::forms::Degenerate;
use crate::forward_surface;
use crate::jet::{Jet2, Jet3};
use crate::limit;
use crate::point::{Axis, Point3, Uv, Vec3, uv};
use crate::series::{MAX_ORDER, Series};
use crate::surface::Surface;
use crate::taylor::{Taylor, cross};

/// Why there is no offset, or none without a cusp at a place.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OffsetError {
    /// A distance that is no number.
    #[error("an offset by {got} mm: the distance must be finite")]
    Distance {
        /// The value, mm.
        got: f64,
    },
    /// The base has no normal there.
    #[error(transparent)]
    Degenerate(#[from] Degenerate),
    /// The offset reaches or passes a centre of curvature.
    #[error(
        "the offset by {distance_mm} mm has a cusp or lies inside out at u = {}, v = {}: the curvature {k_per_mm:.6e} \
         1/mm there leaves 1 + d k = {factor:.3e}", at.u, at.v
    )]
    Cusp {
        /// Where.
        at: Uv,
        /// The offset, mm.
        distance_mm: f64,
        /// The principal curvature of the base that does it, 1/mm.
        k_per_mm: f64,
        /// 1 + d k, not positive.
        factor: f64,
    },
}

/// A surface moved along its outward normal.
#[derive(Clone, Copy, Debug)]
pub struct Offset<S> {
    base: S,
    distance_mm: f64,
}

impl<S: Surface> Offset<S> {
    /// The surface `distance_mm` outside (negative: inside) of `base`.
    ///
    /// ```
    /// use osculate_geom::{Offset, Surface, analytic::Sphere, uv};
    /// // A ball of radius 10 grows to 12; 10 mm inwards it is a point, which is no surface.
    /// let ball = Sphere::new(10.0)?;
    /// let grown = Offset::new(&ball, 2.0)?;
    /// assert!((grown.jet2(uv(0.3, 0.5)).forms()?.mean() - 1.0 / 12.0).abs() < 1e-14);
    /// assert!((grown.further(-3.0)?.point(uv(0.0, 0.0)).x - 9.0).abs() < 1e-14);
    /// assert!(Offset::new(&ball, -10.0)?.regular(uv(0.3, 0.5)).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`OffsetError::Distance`].
    pub fn new(base: S, distance_mm: f64) -> Result<Self, OffsetError> {
        if distance_mm.is_finite() {
            Ok(Self { base, distance_mm })
        } else {
            Err(OffsetError::Distance { got: distance_mm })
        }
    }

    /// The offset of the offset: one offset by the sum, with no order of derivatives lost.
    ///
    /// # Errors
    /// [`OffsetError::Distance`].
    pub fn further(self, distance_mm: f64) -> Result<Self, OffsetError> {
        Self::new(self.base, self.distance_mm + distance_mm)
    }

    /// The surface that is offset.
    #[must_use]
    pub const fn base(&self) -> &S {
        &self.base
    }

    /// The distance, mm, positive outwards.
    #[must_use]
    pub const fn distance_mm(&self) -> f64 {
        self.distance_mm
    }

    /// The jet where the offset has neither a cusp nor lies inside out.
    ///
    /// # Errors
    /// [`OffsetError`] with the curvature that is in the way.
    pub fn regular(&self, at: Uv) -> Result<Jet2, OffsetError> {
        let k = self.base.jet2(at).forms()?.principal();
        for k_per_mm in [k.k_min, k.k_max] {
            let factor = 1.0 + self.distance_mm * k_per_mm;
            if factor.is_nan() || factor <= 0.0 {
                return Err(OffsetError::Cusp { at, distance_mm: self.distance_mm, k_per_mm, factor });
            }
        }
        Ok(self.jet2(at))
    }

    /// A warning where the offset has a cusp, with the place and the distances that have none; `per_span` as in
    /// [`clear_range`].
    pub fn check(&self, per_span: usize) -> Option<Diagnostic> {
        let range = clear_range(&self.base, per_span);
        let d = self.distance_mm;
        let (worst, bound) = if d <= range.inward_mm {
            (range.inward_at, range.inward_mm)
        } else if d >= range.outward_mm {
            (range.outward_at, range.outward_mm)
        } else {
            return None;
        };
        let place = worst.map_or_else(String::new, |at| format!("u = {}, v = {}", at.u, at.v));
        let what = format!(
            "the offset by {d} mm has a cusp and lies inside out near it; offsets up to {bound:.6} mm have none"
        );
        Some(Diagnostic::warning(place, what))
    }

    /// The jet from the base's third order, where the base has a tangent plane.
    fn jet_from(&self, base: &Jet3) -> Option<Jet2> {
        let j = &base.jet2;
        let n = j.normal().ok()?.into_inner();
        let d = self.distance_mm;
        let sign = j.side.sign();
        // N = S_u x S_v, turned outwards, and its derivatives; N = m n.
        let n0 = j.du.cross(&j.dv) * sign;
        let nu = (j.duu.cross(&j.dv) + j.du.cross(&j.duv)) * sign;
        let nv = (j.duv.cross(&j.dv) + j.du.cross(&j.dvv)) * sign;
        let nuu = (base.duuu.cross(&j.dv) + j.duu.cross(&j.duv) * 2.0 + j.du.cross(&base.duuv)) * sign;
        let nuv = (base.duuv.cross(&j.dv) + j.duu.cross(&j.dvv) + j.du.cross(&base.duvv)) * sign;
        let nvv = (base.duvv.cross(&j.dv) + j.duv.cross(&j.dvv) * 2.0 + j.du.cross(&base.dvvv)) * sign;
        let m = n0.norm();
        let (mu, mv) = (n.dot(&nu), n.dot(&nv));
        let (eu, ev) = ((nu - n * mu) / m, (nv - n * mv) / m);
        // n_ab = (N_ab - m_a n_b - m_b n_a - m_ab n) / m with m_ab = N_ab . n + m n_a . n_b.
        let second = |nab: &Vec3, (ma, ea): (f64, &Vec3), (mb, eb): (f64, &Vec3)| {
            (nab - eb * ma - ea * mb - n * (nab.dot(&n) + m * ea.dot(eb))) / m
        };
        let (u, v) = ((mu, &eu), (mv, &ev));
        let mut jet = Jet2 {
            uv: j.uv,
            point: j.point + n * d,
            du: sum(&j.du, &(eu * d)),
            dv: sum(&j.dv, &(ev * d)),
            duu: j.duu + second(&nuu, u, u) * d,
            duv: j.duv + second(&nuv, u, v) * d,
            dvv: j.dvv + second(&nvv, v, v) * d,
            side: j.side,
        };
        // Between the two centres of curvature S_u x S_v has turned over, n has not.
        if jet.du.cross(&jet.dv).dot(&n) * sign < 0.0 {
            jet.side = jet.side.flipped();
        }
        Some(jet)
    }
}

impl<S: Surface> Surface for Offset<S> {
    forward_surface!(trims | s | s.base);
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.jet_from(&self.base.jet3(uv)).unwrap_or_else(|| self.taylor(uv, 2).jet2())
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        // Which way the normal runs at a pole takes more than the point.
        let (asked, order) = (order, order.clamp(3, MAX_ORDER - 1));
        let base = self.base.taylor(uv, order);
        let d = self.distance_mm;
        let Some(n) = limit::normal_series(&self.base, uv, order) else {
            let unknown = Series::constant(f64::NAN, 0);
            return Taylor { coordinates: [unknown; 3], ..base };
        };
        let coordinates = [0, 1, 2].map(|k| base.coordinates[k] + n[k] * d);
        let t = Taylor { coordinates, ..base };
        let side = if turned_over(&base, &t) { t.side.flipped() } else { t.side };
        Taylor { side, coordinates: t.coordinates.map(|c| c.truncated(asked)), ..t }
    }
    fn point(&self, uv: Uv) -> Point3 {
        let jet = self.base.jet2(uv);
        match jet.normal() {
            Ok(n) => jet.point + n.into_inner() * self.distance_mm,
            Err(_) => self.taylor(uv, 0).derivative(0, 0).into(),
        }
    }
}

/// Whether S_u x S_v of the offset points against that of its base: by the first coefficient of the base's that does not
/// vanish, which at a pole is not the value.
fn turned_over(base: &Taylor, offset: &Taylor) -> bool {
    let both = [base, offset].map(|t| cross(&t.differentiated(Axis::U), &t.differentiated(Axis::V)));
    let order = both[1][0].order();
    let at = |s: &[Series; 3], i: usize, j: usize| Vec3::from([0, 1, 2].map(|k| s[k].coefficient(i, j)));
    let all = || (0..=order).flat_map(|n| (0..=n).map(move |j| (n - j, j)));
    let largest = all().map(|(i, j)| at(&both[0], i, j).norm()).fold(0.0, f64::max);
    // Coefficients of rounding are far below, those of the shape not.
    let first = all().find(|(i, j)| at(&both[0], *i, *j).norm() > 1e-11 * largest);
    first.is_some_and(|(i, j)| at(&both[0], i, j).dot(&at(&both[1], i, j)) < 0.0)
}

/// A sum that is zero where it is all rounding: on a cusp along a parameter line S_u vanishes, and what rounding leaves of it
/// must not pass for a tangent.
fn sum(a: &Vec3, b: &Vec3) -> Vec3 {
    let sum = a + b;
    // A normal's derivative carries some ten roundings.
    let noise = 32.0 * f64::EPSILON * (a.norm() + b.norm());
    if sum.norm() <= noise { Vec3::zeros() } else { sum }
}

/// The distances by which a surface can be offset without a cusp.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ClearRange {
    /// Offsets must lie above this, mm; minus infinity where nothing is convex.
    pub inward_mm: f64,
    /// The most convex place.
    pub inward_at: Option<Uv>,
    /// Offsets must lie below this, mm; infinite where nothing is concave.
    pub outward_mm: f64,
    /// The most concave place.
    pub outward_at: Option<Uv>,
}

/// The offsets of a surface that have no cusp: between `-1 / k_max` and `-1 / k_min` of its most convex and most concave
/// place.
///
/// These are looked for at `per_span` x `per_span` places between breaks, and settled from the best of them by steps
/// that halve down to a billionth of a span. An extreme narrower than the samples can be missed; one that is found is
/// met to rounding squared. Places outside the trims and without a tangent plane do not count.
///
/// ```
/// use osculate_geom::{analytic::Torus, offset::clear_range};
/// // A ring can lose its tube's radius, and gain until its hole closes.
/// let range = clear_range(&Torus::new(200.0, 60.0)?, 4);
/// assert!((range.inward_mm + 60.0).abs() < 1e-9 && (range.outward_mm - 140.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn clear_range(surface: &dyn Surface, per_span: usize) -> ClearRange {
    let domain = surface.domain();
    let curvature = |at: Uv, most: bool| -> Option<f64> {
        if !(domain.contains(at) && surface.contains(at)) {
            return None;
        }
        let k = surface.jet2(at).forms().ok()?.principal();
        Some(if most { k.k_max } else { -k.k_min })
    };
    let cuts = |axis: Axis| -> Vec<(f64, f64)> {
        let n = per_span.max(1);
        let inside = |w: &[f64]| {
            let (lo, step) = (w[0], (w[1] - w[0]) / n as f64);
            (0..=n).map(|k| (lo + step * k as f64, step)).collect::<Vec<_>>()
        };
        surface.breaks(axis).windows(2).filter(|w| (w[1] - w[0]).is_finite()).flat_map(inside).collect()
    };
    let (us, vs) = (cuts(Axis::U), cuts(Axis::V));
    let settle = |most: bool| -> Option<(f64, Uv)> {
        let mut best: Option<(f64, Uv, [f64; 2])> = None;
        for (u, du) in &us {
            for (v, dv) in &vs {
                let Some(k) = curvature(uv(*u, *v), most) else { continue };
                if best.is_none_or(|b| k > b.0) {
                    best = Some((k, uv(*u, *v), [*du, *dv]));
                }
            }
        }
        let (mut k, mut at, mut step) = best?;
        // Thirty halvings reach a billionth of the step; each may move on a few times.
        let mut halvings = 0;
        for _ in 0..400 {
            let tries = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
            let next = tries
                .into_iter()
                .map(|(a, b)| uv(at.u + a * step[0], at.v + b * step[1]))
                .filter_map(|p| curvature(p, most).map(|k| (k, p)))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            match next {
                Some((better, p)) if better > k => (k, at) = (better, p),
                _ => {
                    step = step.map(|s| 0.5 * s);
                    halvings += 1;
                    if halvings > 30 {
                        break;
                    }
                }
            }
        }
        (k > 0.0).then_some((k, at))
    };
    let (convex, concave) = (settle(true), settle(false));
    ClearRange {
        inward_mm: convex.map_or(f64::NEG_INFINITY, |c| -1.0 / c.0),
        inward_at: convex.map(|c| c.1),
        outward_mm: concave.map_or(f64::INFINITY, |c| 1.0 / c.0),
        outward_at: concave.map(|c| c.1),
    }
}
