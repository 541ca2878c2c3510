//! The control net of a surface.

use osculate_geom::Point3;

/// The control net of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// Number of poles along u and along v.
    pub count: [usize; 2],
    /// The poles, mm, v fastest: pole (i, j) is at `i * count[1] + j`.
    pub points: Vec<Point3>,
    /// A positive weight for each pole; `None` for a polynomial surface.
    pub weights: Option<Vec<f64>>,
}
