//! What a tool path leaves on the faces of a part, or takes from them: removal along normals.
//!
//! Every [`Sample`] of the part's faces carries a layer of material, `stock_mm` high along its outward normal
//! n.
//! [`cut`] moves cutter and holder through the whole path and keeps the lowest height at which any of them
//! enters the line `p + s n`: the standoff. Positive is material left (a scallop, or a place never machined),
//! negative a gouge. [`tally()`] sums standoffs up, [`sample_surface`] makes the samples. [`prove()`] does all of it and more: it alone
//! says whether a program holds, against a [`Goal`] that names everything that must be so.
//!
//! Tools are exact and so are the motions ([`crate::sweep::LinearMotion`]), but for 2e-5 mm where a turning
//! tool is deepest twice within a small stretch. What is approximate is that the part is looked at in
//! samples: [`hidden()`] bounds what can hide between them cell by cell, [`Density::bound`] quickly and loosely, and [`refine`] puts
//! samples where more than the limits can.
//!
//! What a single height per normal cannot say: an island that a tool leaves hanging above the height it cut
//! is not seen, and the layer of stock is taken to be as high everywhere.
//!
//! ```
//! use osculate_geom::{Domain, Interval, Point3, Vec3, analytic::Plane};
//! use osculate_tools::removal::{Job, Limits, Swept, cut, tally, sample_surface};
//! use osculate_tools::{Cutter, CutterSpec, Pose};
//! let face = Plane::new(Domain { u: Interval::new(0.0, 4.0), v: Interval::new(0.0, 4.0) });
//! let sampling = sample_surface(&face, 0, 0.5, 10_000)?;
//! let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 40.0 })?;
//! let at = |x: f64, y: f64| Pose { tip: Point3::new(x, y, 0.0), axis: Vec3::z_axis() };
//! let motions: Vec<Swept> = (0..=10)
//!     .map(|k| 0.4 * f64::from(k))
//!     .map(|y| Swept { from: at(0.0, y), to: at(4.0, y), rapid: false, block: 1 })
//!     .collect();
//! let job = Job {
//!     cutter: &cutter,
//!     holder: None,
//!     changes: &[],
//!     motions: &motions,
//!     samples: &sampling.samples,
//!     stock_mm: 0.5,
//!     depth_mm: 1.0,
//! };
//! let cuts = cut(&job, &|_| ())?;
//! let found = tally(&sampling.samples, &cuts, &Limits::new(0.01, 0.005), &sampling.density, 3.0)?;
//! // Passes 0.4 mm apart with a ball of radius 3: R - sqrt(R^2 - 0.2^2).
//! assert!(found.within && found.scallop_max_mm <= 3.0 - (9.0f64 - 0.04).sqrt() + 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod answer;
mod body;
mod boundary;
mod cell;
mod cluster;
mod conclude;
mod crest;
mod cut;
mod deepest;
mod density;
mod digs;
mod edges;
mod feeds;
mod foot;
mod goal;
mod grid;
mod hidden;
mod hints;
mod job;
mod material;
mod piece;
mod prove;
mod refine;
mod rim;
mod sampling;
mod steps;
pub mod stock;
mod tally;
mod target;
mod tooth;
mod tree;
mod trial;
mod unreached;
mod verdict;

pub use boundary::{sample_boundary, sample_triangles};
pub use crest::crests;
pub use cut::{cut, cut_on};
pub use density::{Density, Hidden};
pub use digs::DIVISIONS;
pub use edges::{beside_edges, measure_beside_edges};
pub use feeds::TooFast;
pub use goal::{
    Goal, GoalControl, GoalFace, GoalFixture, GoalLimits, GoalStock, GoalTool, Gravity, Looks, Program,
    Remark, Unseen,
};
pub use hidden::{Wanted, hidden};
pub use job::{Body, By, Change, Cut, Job, JobError, Sample, Swept, Touch};
pub use prove::{Proved, prove, prove_in_steps};
pub use refine::{Measured, Refined, refine};
pub use sampling::{Patch, Sampling, SamplingError, sample_surface};
pub use steps::GoalStep;
pub use tally::{Bin, Kind, Limits, Tally, TallyError, Worst, tally};
pub use trial::{LEAST_SAMPLES, ProveError};
pub use verdict::{Answer, Figures, ScopeRow, StockFound, Verdict};
