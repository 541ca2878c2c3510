//! Which axes are possible at the places of a part.

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

pub use best::Best;
pub use bits::Bits;
pub use directions::{Directions, DirectionsError};
pub use gap::{Gap, Met};
pub use obstacles::{ObstacleKind, ObstaclePoint, Obstacles, ObstaclesError};
pub use problem::{Place, Reach, ReachError, ReachLimits, ReachProblem};
pub use tool::{Member, Mounted, Tool, ToolError};
