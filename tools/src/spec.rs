//! Plain descriptions of tools as they stand in job files and CL data. Validation happens in [`crate::Cutter`].

use serde::{Deserialize, Serialize};

/// A cutter as a user writes it. All lengths mm, the diameter is the outer one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
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
}

/// A cylindrical tool holder above the cutter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HolderSpec {
    /// Diameter.
    pub diameter_mm: f64,
    /// Length.
    pub length_mm: f64,
}
