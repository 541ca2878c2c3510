//! Plain descriptions of tools as they stand in job files and CL data. Validation happens in [`crate::Cutter`].

#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// A cutter as a user writes it. All lengths mm, angles deg; the diameter is the outer one but for `apt`.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_tools::{Cutter, CutterError, CutterSpec, Line, Pose};
/// let bull = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 };
/// let cutter = Cutter::try_from(bull)?;
/// // It stands upright on the origin. A line up to its corner, 9 mm from the axis, enters at z = 2 - sqrt(2^2 - 1^2).
/// let pose = Pose { tip: Point3::origin(), axis: Vec3::z_axis() };
/// let up = Line { origin: Point3::new(9.0, 0.0, -10.0), direction: Vec3::z_axis() };
/// let entry = cutter.entry(&pose, &up).ok_or("it misses the tool")?;
/// assert!((up.point(entry.at_mm).z - (2.0 - 3f64.sqrt())).abs() < 1e-12);
/// // Sizes that make no cutter are refused.
/// let none = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 11.0, length_mm: 60.0 };
/// assert_eq!(Cutter::try_from(none), Err(CutterError::Corner { corner_mm: 11.0, radius_mm: 10.0 }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields))]
pub enum CutterSpec {
    /// Ball end: the corner radius is half the diameter.
    Ball {
        /// Outer diameter.
        diameter_mm: f64,
        /// Length from the tip to the holder.
        length_mm: f64,
    },
    /// Flat end with a sharp edge.
    Flat {
        /// Outer diameter.
        diameter_mm: f64,
        /// Length from the tip to the holder.
        length_mm: f64,
    },
    /// Bull nose: a flat end with a rounded corner.
    Toroidal {
        /// Outer diameter.
        diameter_mm: f64,
        /// Corner radius, less than half the diameter.
        corner_radius_mm: f64,
        /// Length from the tip to the holder.
        length_mm: f64,
    },
    /// A cylinder that works with its side: the same body as a flat end.
    Cylindrical {
        /// Outer diameter.
        diameter_mm: f64,
        /// Length from the tip to the holder.
        length_mm: f64,
    },
    /// A cone with a rounded end, and a cylinder above it.
    Cone {
        /// Diameter of the cylinder.
        diameter_mm: f64,
        /// Half the angle of the cone, from the axis.
        taper_deg: f64,
        /// Radius of the rounded end.
        corner_radius_mm: f64,
        /// Diameter at which the cone would meet the tip's plane without the corner; a ball end where not given.
        #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
        tip_diameter_mm: Option<f64>,
        /// Length from the tip to the holder.
        length_mm: f64,
    },
    /// A barrel: a ball tip that runs smoothly into a large arc, widest at the outer diameter.
    Barrel {
        /// Greatest diameter.
        diameter_mm: f64,
        /// Radius of the large arc, above half the diameter.
        barrel_radius_mm: f64,
        /// Radius of the tip.
        corner_radius_mm: f64,
        /// Length from the tip to the holder; the barrel's widest place lies below it.
        length_mm: f64,
    },
    /// APT's general cutter `CUTTER/d, r, e, f, a, b, h`, its corner tangent to bottom and side.
    Apt {
        /// Twice the radius at which the lines of bottom and side meet, d.
        diameter_mm: f64,
        /// Corner radius, r.
        corner_radius_mm: f64,
        /// Rise of the bottom from the tip's plane, a.
        #[cfg_attr(feature = "serde", serde(default))]
        bottom_angle_deg: f64,
        /// Opening of the side from the axis, b; negative where it closes upwards.
        #[cfg_attr(feature = "serde", serde(default))]
        side_angle_deg: f64,
        /// Length from the tip to the holder, h.
        length_mm: f64,
    },
}

/// A section of a tool holder: a cylinder, or a cone.
///
/// ```
/// use osculate_tools::{Holder, HolderSpec};
/// let sleeve = HolderSpec { diameter_mm: 30.0, length_mm: 50.0, upper_diameter_mm: None };
/// assert_eq!(Holder::new(&[sleeve])?, Holder::cylinder(30.0, 50.0)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct HolderSpec {
    /// Diameter, at the lower end.
    pub diameter_mm: f64,
    /// Length.
    pub length_mm: f64,
    /// Diameter at the upper end, where it is another.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub upper_diameter_mm: Option<f64>,
}
