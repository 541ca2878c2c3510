//! Integrals over parameter rectangles by Gauss-Legendre panels between the breaks of a surface.

use crate::jet::Jet2;
use crate::point::{Axis, uv};
use crate::surface::Surface;

/// Nodes and weights of the 5-point Gauss-Legendre rule on `[0, 1]`: exact to degree 9.
pub const GAUSS5: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_6, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// An integral and an estimate of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Integral {
    /// The value.
    pub value: f64,
    /// Difference between the last two refinements.
    pub error: f64,
}

/// Integral of `f` over `[lo, hi]` by `panels` Gauss panels of equal length.
///
/// ```
/// use osculate_geom::quadrature::gauss;
/// // One panel is exact to degree 9.
/// assert!((gauss(0.0, 2.0, 1, |x| x.powi(9)) - 102.4).abs() < 1e-12);
/// ```
pub fn gauss(lo: f64, hi: f64, panels: usize, mut f: impl FnMut(f64) -> f64) -> f64 {
    let n = panels.max(1);
    let step = (hi - lo) / n as f64;
    let mut sum = 0.0;
    for k in 0..n {
        let start = lo + step * k as f64;
        for (x, w) in GAUSS5 {
            sum += w * f(start + step * x);
        }
    }
    sum * step
}

/// Integral of `f dA` over the carrier rectangle of a surface (trims are not applied), refined between breaks
/// until two refinements agree to `relative`, at most five times.
///
/// Places without a tangent plane have no area and contribute nothing.
///
/// ```
/// use osculate_geom::{analytic::Sphere, quadrature::{area, over_surface}};
/// use std::f64::consts::PI;
/// // A ball's area, and its total curvature, which is 4 pi whatever its radius.
/// let ball = Sphere::new(10.0)?;
/// assert!((area(&ball, 1e-10).value - 400.0 * PI).abs() < 1e-6);
/// let total = over_surface(&ball, 1e-10, |jet| jet.forms().map_or(0.0, |f| f.gauss()));
/// assert!((total.value - 4.0 * PI).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn over_surface(surface: &dyn Surface, relative: f64, f: impl Fn(&Jet2) -> f64) -> Integral {
    let (bu, bv) = (surface.breaks(Axis::U), surface.breaks(Axis::V));
    let run = |panels: usize| -> f64 {
        let mut total = 0.0;
        for wu in bu.windows(2) {
            for wv in bv.windows(2) {
                total += gauss(wu[0], wu[1], panels, |u| {
                    gauss(wv[0], wv[1], panels, |v| {
                        let jet = surface.jet2(uv(u, v));
                        let density = jet.du.cross(&jet.dv).norm();
                        if density > 0.0 { density * f(&jet) } else { 0.0 }
                    })
                });
            }
        }
        total
    };
    let mut last = run(1);
    let mut panels = 2;
    loop {
        let next = run(panels);
        let error = (next - last).abs();
        if error <= relative * next.abs() || panels >= 32 {
            return Integral { value: next, error };
        }
        last = next;
        panels *= 2;
    }
}

/// Area of the carrier rectangle, mm2.
pub fn area(surface: &dyn Surface, relative: f64) -> Integral {
    over_surface(surface, relative, |_| 1.0)
}

/// The share of the carrier rectangle's area that lies within the trims of a face, about: from a raster of places, never below one of
/// them.
pub fn share_within_trims(surface: &dyn Surface) -> f64 {
    const RASTER: u32 = 32;
    let domain = surface.domain();
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(RASTER);
    let (mut within, mut all) = (0.0, 0.0);
    for k in 0..RASTER * RASTER {
        let place = domain.at(at(k % RASTER), at(k / RASTER));
        let jet = surface.jet2(place);
        let density = jet.du.cross(&jet.dv).norm();
        if density > 0.0 && density.is_finite() {
            all += density;
            within += if surface.contains(place) { density } else { 0.0 };
        }
    }
    let least = 1.0 / f64::from(RASTER * RASTER);
    if all > 0.0 { (within / all).max(least) } else { 1.0 }
}

/// Area of a face within its trims, mm2: coarse, to share out counts by. Exact areas of trimmed faces come from their outlines.
pub fn coarse_area(surface: &dyn Surface) -> f64 {
    area(surface, 1e-2).value * share_within_trims(surface)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_is_exact_to_degree_nine() {
        let got = gauss(-1.0, 2.0, 1, |x| x.powi(9) - 3.0 * x.powi(8));
        let want = (2f64.powi(10) - 1.0) / 10.0 - (2f64.powi(9) + 1.0) / 3.0;
        assert!((got - want).abs() < 1e-12 * want.abs());
    }
}
