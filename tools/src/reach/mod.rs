//! Which axes are possible at the places of a part.
//!
//! A [`Tool`] touches a [`Place`] with its cutter; the axis is free. An axis is possible where the machine allows it, its lean
//! is within the [`ReachLimits`], the cutter goes no deeper into the part than the gouge limit, and what is mounted above it
//! keeps its clearance from everything. The part, the fixture and the stock that operations before have left are [`Obstacles`]: points, as near to each other
//! as the tool may miss something between them. Axes are taken from [`Directions`], an even set that covers the sphere; the
//! possible ones are [`Bits`] over it.
//!
//! - [`Reach::map`] gives the bits of many places at once. It decides cones of axes against balls of points together, and
//!   answers as if each axis had been asked for with [`Reach::is_clear`].
//! - [`Reach::gap`] says for any axis, of the set or not, how much is left, and which point has it.
//! - [`Reach::barred`] says of one direction what keeps the tool from it.
//! - [`Reach::best`] finds the axis with the most left: for a place without any bit, what stands in the way.
//!
//! ```
//! use osculate_geom::{Point3, Vec3};
//! use osculate_tools::reach::{
//!     Directions, ObstacleKind, ObstaclePoint, Obstacles, Place, Reach, ReachLimits, ReachProblem, Tool,
//! };
//! use osculate_tools::{Cutter, CutterSpec, Holder};
//! // A wall 20 mm high, 5 mm beside the place.
//! let lattice = (-40..=40).flat_map(|i| (0..=40).map(move |j| (0.5 * f64::from(i), 0.5 * f64::from(j))));
//! let wall = lattice.map(|(y, z)| Point3::new(5.0, y, z));
//! let obstacles =
//!     Obstacles::new(wall.map(|point| ObstaclePoint { point, owner: 0, kind: ObstacleKind::Part }))?;
//! let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 25.0 })?;
//! let holder = Holder::cylinder(30.0, 50.0)?;
//! let tool = Tool::new(cutter, Some(&holder));
//! let limits = ReachLimits {
//!     gouge_mm: 0.01,
//!     clearance_mm: 1.0,
//!     stock_mm: 0.0,
//!     least_lean_rad: 0.0,
//!     most_lean_rad: 70f64.to_radians(),
//! };
//! let directions = Directions::icosphere(3)?;
//! let problem =
//!     ReachProblem { tool: &tool, limits, obstacles: &obstacles, directions: &directions, allowed: None };
//! let reach = Reach::new(problem)?;
//! let place = Place { point: Point3::origin(), normal: Vec3::z_axis() };
//! let bits = &reach.map(&[place])[0];
//! // Upright the holder is above the wall; leaned away from it the tool is freer, towards it there is no way.
//! let toward = |x: f64| directions.nearest(&nalgebra::Unit::new_normalize(Vec3::new(x, 0.0, 1.0)));
//! assert!(bits.contains(toward(0.0)) && bits.contains(toward(-1.0)) && !bits.contains(toward(1.0)));
//! let best = reach.best(&place).ok_or("the lean allows no direction")?;
//! assert!(best.axis.x < 0.0 && best.gap.spare_mm > reach.gap(&place, &Vec3::z_axis()).spare_mm);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod barred;
mod best;
mod bits;
mod cones;
mod directions;
mod gap;
mod map;
mod obstacles;
mod problem;
mod stance;
mod tool;
mod view;

pub use barred::Barred;
pub use best::Best;
pub use bits::Bits;
pub use directions::{Directions, DirectionsError};
pub use gap::{Gap, Met};
pub use obstacles::{ObstacleKind, ObstaclePoint, Obstacles, ObstaclesError};
pub use problem::{Place, Reach, ReachError, ReachLimits, ReachProblem};
pub use tool::{Member, Mounted, Tool, ToolError};
