//! Productivity of roughing as a layer over the part: volume of stock per minute [R97, eqs. 12 to 22].
//!
//! Stock of thickness S(u, v) along the normal. [R97, eq. 18] takes S times the area; the layer's volume is exactly
//!
//! ```text
//! V = int (S + S^2 H + S^3 K / 3) dA,      (1 + s k_1)(1 + s k_2) integrated over s from 0 to S
//! ```
//!
//! with H the mean and K the Gaussian curvature, convex positive, S constant or not. It holds where no normal meets its
//! neighbour within the layer: `1 + S k > 0` for both principal curvatures. E_R(t) is the same density along the line that is
//! machined at t, times the Jacobian of the change of parameters [R97, eq. 22; one integral, over w].
//! What a cutter takes out of real stock at an instant is in [`crate::engagement`].

use crate::finish::{Across, Place, RateError, weighted_rate};
use crate::given::Given;
use osculate_geom::quadrature::{Integral, over_surface};
use osculate_geom::{Jet2, Surface, Uv};
use std::cell::Cell;

/// Why a layer has no volume.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayerError {
    /// The layer is thicker than the part is hollow: its normals cross.
    #[error(
        "the layer of {thickness_mm} mm at u = {}, v = {} reaches past the centre of curvature {radius_mm} mm above the part; use \
         a thickness below it",
        at.u, at.v
    )]
    Crosses {
        /// Where.
        at: Uv,
        /// Thickness there.
        thickness_mm: f64,
        /// Distance of the nearest centre of curvature.
        radius_mm: f64,
    },
    /// The instant's line is unusable.
    #[error(transparent)]
    Rate(#[from] RateError),
}

/// Volume of the layer per area of the part at a place, mm: `S + S^2 H + S^3 K / 3`; zero where the surface has no tangent plane.
///
/// ```
/// use osculate_geom::{Surface, analytic::Sphere, uv};
/// use osculate_productivity::rough::layer_depth_mm;
///
/// // 1 mm around a ball of radius 10 mm: (11^3 - 10^3) / (3 * 10^2) of volume per area.
/// let depth = layer_depth_mm(&Sphere::new(10.0)?.jet2(uv(0.3, 0.4)), 1.0)?;
/// assert!((depth - 331.0 / 300.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LayerError::Crosses`].
pub fn layer_depth_mm(jet: &Jet2, thickness_mm: f64) -> Result<f64, LayerError> {
    let Ok(forms) = jet.forms() else { return Ok(0.0) };
    let k = forms.principal().k_min;
    if 1.0 + thickness_mm * k <= 0.0 {
        return Err(LayerError::Crosses { at: jet.uv, thickness_mm, radius_mm: -1.0 / k });
    }
    let s = thickness_mm;
    Ok(s * (1.0 + s * (forms.mean() + s * forms.gauss() / 3.0)))
}

/// The same for an integral, whose error is told after it.
fn depth(jet: &Jet2, thickness_mm: f64, crossed: &Cell<Option<LayerError>>) -> f64 {
    layer_depth_mm(jet, thickness_mm).unwrap_or_else(|e| {
        crossed.set(Some(e));
        0.0
    })
}

/// The exact volume of the layer over the surface's whole parameter rectangle, mm3, to the `relative` accuracy of its
/// quadrature.
///
/// ```
/// use osculate_geom::{Interval, analytic::Cylinder};
/// use osculate_productivity::{given::Given, rough::{flat_volume, layer_volume}};
/// use std::f64::consts::PI;
///
/// // 2 mm of stock around a cylinder of radius 20 mm, 30 mm high: a tube.
/// let cylinder = Cylinder::new(20.0, Interval::new(0.0, 30.0))?;
/// let stock = Given::uniform(2.0)?;
/// let volume = layer_volume(&cylinder, &stock, 1e-9)?;
/// assert!((volume.value - PI * (22.0f64.powi(2) - 20.0f64.powi(2)) * 30.0).abs() < 1e-6);
/// // Thickness times area leaves out that the tube is longer outside.
/// assert!((flat_volume(&cylinder, &stock, 1e-9).value - 2.0 * PI * 20.0 * 30.0 * 2.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LayerError::Crosses`].
pub fn layer_volume(surface: &dyn Surface, thickness: &Given, relative: f64) -> Result<Integral, LayerError> {
    let crossed = Cell::new(None);
    let volume = over_surface(surface, relative, |jet| depth(jet, thickness.at(jet.uv), &crossed));
    crossed.get().map_or(Ok(volume), Err)
}

/// The volume of [R97, eq. 18], which leaves curvature out: off by `S H` relative to the exact one.
#[must_use]
pub fn flat_volume(surface: &dyn Surface, thickness: &Given, relative: f64) -> Integral {
    over_surface(surface, relative, |jet| thickness.at(jet.uv))
}

/// `E_R(t)`, mm3/min: the layer's volume passed per minute by the line that is machined at the instant.
///
/// # Errors
/// [`LayerError`].
pub fn layer_rate_mm3_min(
    surface: &dyn Surface,
    thickness: &Given,
    across: Across,
    line: impl Fn(f64) -> Place,
) -> Result<f64, LayerError> {
    let crossed = Cell::new(None);
    let rate = weighted_rate(across, line, |at| {
        let jet = surface.jet2(at);
        jet.du.cross(&jet.dv).norm() * depth(&jet, thickness.at(at), &crossed)
    })?;
    crossed.get().map_or(Ok(rate), Err)
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::{Cylinder, Sphere, Torus};
    use osculate_geom::quadrature::gauss;
    use osculate_geom::{Flipped, Interval, uv};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    proptest! {
        /// Shells of spheres inside and out, cylinders, tori: the volumes of the book.
        #[test]
        fn layers_with_closed_forms(r in 5.0..50.0f64, part in 0.01..0.9f64, hollow: bool) {
            let s = part * r;
            let thickness = Given::uniform(s).unwrap();
            let outer = if hollow { r - s } else { r + s };
            let (sphere, tube) = (Sphere::new(r).unwrap(), Cylinder::new(r, Interval::new(0.0, 7.0)).unwrap());
            let ring = Torus::new(3.0 * r, r).unwrap();
            let of = |surface: &dyn Surface| layer_volume(surface, &thickness, 1e-11).unwrap().value;
            let got = if hollow {
                [of(&Flipped(sphere)), of(&Flipped(tube)), of(&Flipped(ring))]
            } else {
                [of(&sphere), of(&tube), of(&ring)]
            };
            let want = [
                4.0 / 3.0 * PI * (outer.powi(3) - r.powi(3)).abs(),
                7.0 * PI * (outer * outer - r * r).abs(),
                2.0 * PI * PI * 3.0 * r * (outer * outer - r * r).abs(),
            ];
            for (a, b) in got.iter().zip(want) {
                prop_assert!((a / b - 1.0).abs() < 1e-8, "{got:?} {want:?}");
            }
            // (18) misses by the mean curvature's share.
            let flat = flat_volume(&sphere, &thickness, 1e-11).value;
            prop_assert!((flat / (4.0 * PI * r * r * s) - 1.0).abs() < 1e-9);
            prop_assert!((flat / want[0] - 1.0).abs() > 0.5 * part.min(0.5));
        }
    }

    /// Integrated over time the rate is the volume, with stock that varies.
    #[test]
    fn the_rate_adds_up_to_the_volume() {
        let ring = Torus::new(40.0, 12.0).unwrap();
        let d = ring.domain();
        let stock = Given::grid(
            vec![0.0, PI, 2.0 * PI],
            vec![0.0, PI, 2.0 * PI],
            vec![1.0, 2.0, 1.0, 3.0, 0.5, 3.0, 1.0, 2.0, 1.0],
        )
        .unwrap();
        let across = Across { from: d.v.lo, to: d.v.hi, panels: 8 };
        let rate = |t: f64| {
            let line = |w: f64| Place { at: uv(t, w), by_time: uv(1.0, 0.0), by_across: uv(0.0, 1.0) };
            layer_rate_mm3_min(&ring, &stock, across, line).unwrap()
        };
        let total = gauss(d.u.lo, d.u.hi, 8, rate);
        let volume = layer_volume(&ring, &stock, 1e-7).unwrap();
        assert!((total / volume.value - 1.0).abs() < 1e-6, "{total} {volume:?}");
    }

    #[test]
    fn a_layer_past_the_centre_of_curvature_is_refused() {
        let hole = Flipped(Cylinder::new(5.0, Interval::new(0.0, 7.0)).unwrap());
        let got = layer_volume(&hole, &Given::uniform(5.5).unwrap(), 1e-6);
        assert!(matches!(got, Err(LayerError::Crosses { radius_mm, .. }) if (radius_mm - 5.0).abs() < 1e-9));
    }
}
