//! `repeat` of an operation: equal places in a circle, of which one is planned.

use crate::job::raw;
use osculate_geom::{Point3, TurnAxis, Unit3, Vec3};

/// Equal places in a circle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Repeat {
    /// The axis, where the job says it.
    pub axis: Option<TurnAxis>,
    /// How many places, that of the operation's faces counted.
    pub count: usize,
}

impl Repeat {
    pub(super) fn of(t: raw::Repeat) -> Self {
        match t {
            raw::Repeat::Count(count) => Self { axis: None, count },
            raw::Repeat::Circle(c) => {
                let direction = Unit3::new_normalize(Vec3::from(c.axis.unwrap_or([0.0, 0.0, 1.0])));
                let origin = Point3::from(c.at_mm.unwrap_or_default());
                Self { axis: Some(TurnAxis { origin, direction }), count: c.count }
            }
        }
    }
}
