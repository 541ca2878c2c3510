//! The way of an edge as a function of the parameter that it is written with.

use osculate_geom::{Point3, Vec3};

/// The way of an edge as a function of the parameter that it is written with.
pub(crate) struct Track<'a> {
    /// Point and derivative.
    pub(crate) jet: Box<dyn Fn(f64) -> (Point3, Vec3) + 'a>,
    /// Parameters between which it is smooth, ends included, ascending.
    pub(crate) breaks: Vec<f64>,
    /// Whether the parameter grows along the edge's own course.
    pub(crate) forward: bool,
}

impl Track<'_> {
    /// The breaks without those that only rounding parts from others.
    pub(super) fn apart(&self) -> Vec<f64> {
        let [first, last] = [self.breaks[0], self.breaks[self.breaks.len() - 1]];
        let hair = 1e-9 * (last - first);
        let mut out = vec![first];
        for t in &self.breaks {
            if *t - out[out.len() - 1] > hair && last - t > hair {
                out.push(*t);
            }
        }
        out.push(last);
        out
    }
}
