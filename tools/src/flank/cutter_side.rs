//! The side of a cutter as flank milling sees it: a body of revolution told by distances to its meridian.
//!
//! A cylinder has no ends here: the tip is put below the face's lower directrix and the holder above the upper one
//! afterwards ([`super::path`]). Cones, barrels and APT cutters keep their tips and go on without end above their length.
//! Heights z count along the axis from the point Q0 of [`super::axes`].

use crate::cutter::Cutter;
use crate::meridian::Meridian;

/// Signed distance of a point beside the axis and its gradient in (rho, z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Near {
    pub distance: f64,
    pub by_rho: f64,
    pub by_z: f64,
}

/// The side of a cutter.
///
/// ```
/// use osculate_tools::flank::cutter_side::CutterSide;
/// use osculate_tools::{Cutter, CutterSpec};
/// // A cone with a ball of radius 2 and a half angle of 5 degrees, its tip at the point from which heights count.
/// let spec = CutterSpec::Cone {
///     diameter_mm: 16.0,
///     taper_deg: 5.0,
///     corner_radius_mm: 2.0,
///     tip_diameter_mm: None,
///     length_mm: 80.0,
/// };
/// let side = CutterSide::of(&Cutter::try_from(spec)?, 0.0);
/// let taper = 5f64.to_radians();
/// assert!((side.taper_at_rad(30.0) - taper).abs() < 1e-12 && !side.is_cylinder());
/// assert!((side.radius_at_mm(40.0) - side.radius_at_mm(30.0) - 10.0 * taper.tan()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutterSide {
    radius: f64,
    /// None for a cylinder.
    meridian: Option<Meridian>,
    /// Height of the tip of a meridian.
    tip: f64,
}

impl CutterSide {
    /// The side of an end mill, a cylinder of the cutter's radius without ends, or of a cutter with a meridian of its own
    /// whose tip stands at `tip_mm` along the axis from Q0 (negative: below it, which is where it should be).
    #[must_use]
    pub fn of(cutter: &Cutter, tip_mm: f64) -> Self {
        Self { radius: cutter.radius_mm(), meridian: cutter.meridian().copied(), tip: tip_mm }
    }

    /// Whether the side is a cylinder, for which the height of the tip does not matter.
    #[must_use]
    pub const fn is_cylinder(&self) -> bool {
        self.meridian.is_none()
    }

    /// Greatest radius, mm.
    #[must_use]
    pub const fn radius_mm(&self) -> f64 {
        self.radius
    }

    /// Radius at a height, mm: where the signed distance vanishes.
    #[must_use]
    pub fn radius_at_mm(&self, z_mm: f64) -> f64 {
        if self.is_cylinder() {
            return self.radius;
        }
        let (mut lo, mut hi) = (0.0, self.radius);
        // To the last digits of a radius: the distance grows with rho.
        for _ in 0..60 {
            let middle = 0.5 * (lo + hi);
            if self.near(middle, z_mm).distance <= 0.0 { lo = middle } else { hi = middle }
        }
        lo
    }

    /// Angle between the side and the axis at a height, rad: positive where it opens towards the spindle.
    #[must_use]
    pub fn taper_at_rad(&self, z_mm: f64) -> f64 {
        let n = self.near(self.radius_at_mm(z_mm), z_mm);
        (-n.by_z).atan2(n.by_rho)
    }

    pub(crate) fn near(&self, rho: f64, z: f64) -> Near {
        match &self.meridian {
            None => Near { distance: rho - self.radius, by_rho: 1.0, by_z: 0.0 },
            Some(m) => {
                let n = m.near(rho, z - self.tip);
                Near { distance: n.distance, by_rho: n.by_rho, by_z: n.by_z }
            }
        }
    }
}
