//! Why a direction is not possible at a place.

use super::gap::Met;
use super::problem::{Place, Reach};
use super::stance::Stance;

/// What keeps the tool from a direction: the first of these that does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Barred {
    /// The axis leans off the normal by more than the greatest lean, or by less than the least.
    Lean,
    /// The machine does not allow the direction.
    Machine,
    /// The tool comes too near to something. Of all such points it is the one that lies lowest along the axis: what stands in the way first, as
    /// seen from the tip, which need not be what the tool goes into deepest.
    Meets(Met),
}

impl Reach<'_> {
    /// What keeps the tool from a direction of the set at a place; None exactly where [`Reach::bits`] has the direction.
    ///
    /// ```
    /// use osculate_geom::{Point3, Vec3};
    /// use osculate_tools::reach::{
    ///     Barred, Directions, Obstacles, Place, Reach, ReachLimits, ReachProblem, Tool,
    /// };
    /// use osculate_tools::{Cutter, CutterSpec};
    /// // With nothing in the way the lean alone bars a direction.
    /// let tool = Tool::new(Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 25.0 })?, None);
    /// let limits = ReachLimits {
    ///     gouge_mm: 0.01,
    ///     clearance_mm: 1.0,
    ///     stock_mm: 0.0,
    ///     least_lean_rad: 0.0,
    ///     most_lean_rad: 70f64.to_radians(),
    /// };
    /// let (obstacles, directions) = (Obstacles::default(), Directions::icosphere(2)?);
    /// let problem =
    ///     ReachProblem { tool: &tool, limits, obstacles: &obstacles, directions: &directions, allowed: None };
    /// let reach = Reach::new(problem)?;
    /// let place = Place { point: Point3::origin(), normal: Vec3::z_axis() };
    /// assert_eq!(reach.barred(&place, directions.nearest(&Vec3::z_axis())), None);
    /// assert_eq!(reach.barred(&place, directions.nearest(&Vec3::x_axis())), Some(Barred::Lean));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// For an index that is no direction's.
    #[must_use]
    pub fn barred(&self, place: &Place, direction: usize) -> Option<Barred> {
        let axis = &self.directions.all()[direction];
        if !self.leans_within_limits(place, axis) {
            return Some(Barred::Lean);
        }
        if !self.allows(place, direction) {
            return Some(Barred::Machine);
        }
        let lowest = Stance::new(self, place, axis).lowest(self);
        lowest.map(|found| Barred::Meets(self.met(found)))
    }
}
