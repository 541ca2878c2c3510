//! Why a description is no cutter.

/// A cutter that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CutterError {
    /// A length that is not positive and finite.
    #[error("the cutter's {what} must be positive and finite, got {got}")]
    Size {
        /// Which length.
        what: &'static str,
        /// Its value, mm.
        got: f64,
    },
    /// A corner radius that does not fit.
    #[error(
        "corner_radius_mm = {corner_mm} does not fit a cutter of radius {radius_mm} mm: it must lie between 0 and \
         the radius (equal to it the cutter is a ball)"
    )]
    Corner {
        /// The corner radius, mm.
        corner_mm: f64,
        /// The outer radius, mm.
        radius_mm: f64,
    },
    /// A cutter shorter than its rounded end.
    #[error("length_mm = {length_mm} is not above the corner radius {corner_mm} mm")]
    Length {
        /// The length, mm.
        length_mm: f64,
        /// The corner radius, mm.
        corner_mm: f64,
    },
    /// An angle out of range.
    #[error("{what} = {got_deg} must lie between {least_deg} and {most_deg}")]
    Angle {
        /// Which angle.
        what: &'static str,
        /// Its value, deg.
        got_deg: f64,
        /// Lower limit, deg, not allowed itself.
        least_deg: f64,
        /// Upper limit, deg, not allowed itself.
        most_deg: f64,
    },
    /// A corner that is larger than the shape has room for.
    #[error("corner_radius_mm = {corner_mm} does not fit this shape: at most {most_mm:.4} mm")]
    ShapeCorner {
        /// The corner radius, mm.
        corner_mm: f64,
        /// The largest that fits, mm.
        most_mm: f64,
    },
    /// A barrel more curved than a ball.
    #[error("barrel_radius_mm = {barrel_mm} must be above half the diameter, {radius_mm} mm")]
    Barrel {
        /// The barrel's radius, mm.
        barrel_mm: f64,
        /// Half the diameter, mm.
        radius_mm: f64,
    },
    /// A length at which the shape is not complete or has closed already.
    #[error("length_mm = {length_mm} must lie between {least_mm:.4} and {most_mm:.4} mm for this shape")]
    ShapeLength {
        /// The length, mm.
        length_mm: f64,
        /// The least, mm.
        least_mm: f64,
        /// The most, mm.
        most_mm: f64,
    },
}
