//! Cutters, their contact with a surface, the strips they leave, and what is left on a part.
//!
//! - [`Cutter`] is a validated end mill, cone, barrel or APT cutter: a convex body that can be asked for distances and for
//!   where a line enters it. [`CutterSpec`] is its plain description.
//! - [`Contact`] puts a cutter on a surface with [`Lean`] (lead and tilt) and a feed; [`ContactMotion`] drives it along.
//! - [`sweep`] finds how deep a moving cutter reaches along a line; [`mod@strip`] turns that into the exact strip width.
//! - [`reach`] says which axes are possible at the places of a part.
//! - [`removal`] judges whole paths: scallop, gouge and uncut area on sampled faces.
//! - [`flank`] puts the side of a cutter against ruled surfaces.
//! - [`cl`] is the path that planning hands on to posting and verification.
//!
//! Lengths are millimetres, angles radians. The tool axis points from the tip to the spindle.
//!
//! # From a cutter to a strip
//!
//! ```
//! use osculate_geom::{Axis, Flipped, analytic::Torus, uv};
//! use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
//! // A bull-nose cutter along a groove: the inside of a torus' tube.
//! let groove = Flipped(Torus::new(200.0, 60.0)?);
//! let spec = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 };
//! let cutter = Cutter::try_from(spec)?;
//! let lean = Lean { lead_rad: 12f64.to_radians(), tilt_rad: 0.0 };
//! let at = uv(0.0, std::f64::consts::PI);
//! let contact = Contact::new(&groove, at, &cutter, FeedLine::Iso(Axis::U), lean)?;
//! let exact = strip::exact(&contact, 0.01)?;
//! assert!((exact.width_mm - 3.107566922).abs() < 1e-8 && exact.error_mm < 1e-8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From a contact to a pose
//!
//! What a machine is sent is where the tip is and where the axis points.
//!
//! ```
//! use osculate_geom::{Axis, Interval, analytic::Cylinder, uv};
//! use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean};
//! // A ball of radius 3 upright on a shaft of radius 20, at its place on the x axis: the tip is the contact.
//! let shaft = Cylinder::new(20.0, Interval::new(0.0, 80.0))?;
//! let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 40.0 })?;
//! let contact = Contact::new(&shaft, uv(0.0, 40.0), &ball, FeedLine::Iso(Axis::V), Lean::default())?;
//! let pose = contact.pose();
//! assert!((pose.tip.x - 20.0).abs() < 1e-12 && (pose.axis.x - 1.0).abs() < 1e-12);
//! // Lifted by 5 mm it stands off along the normal.
//! assert!((contact.lifted(5.0).pose().tip.x - 25.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From a place to its axes
//!
//! [`reach`] has the example with a wall beside the place; without anything in the way the lean alone decides.
//!
//! ```
//! use osculate_geom::{Point3, Vec3};
//! use osculate_tools::reach::{Directions, Obstacles, Place, Reach, ReachLimits, ReachProblem, Tool};
//! use osculate_tools::{Cutter, CutterSpec};
//! let tool = Tool::new(Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 25.0 })?, None);
//! let limits = ReachLimits {
//!     gouge_mm: 0.01,
//!     clearance_mm: 1.0,
//!     stock_mm: 0.0,
//!     least_lean_rad: 0.0,
//!     most_lean_rad: 60f64.to_radians(),
//! };
//! let (obstacles, directions) = (Obstacles::default(), Directions::icosphere(4)?);
//! let problem =
//!     ReachProblem { tool: &tool, limits, obstacles: &obstacles, directions: &directions, allowed: None };
//! let place = Place { point: Point3::origin(), normal: Vec3::z_axis() };
//! let count = Reach::new(problem)?.bits(&place).count();
//! // A cap of 60 degrees is a quarter of the sphere.
//! assert!((count as f64 / directions.all().len() as f64 - 0.25).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From motions to what is left
//!
//! [`removal`] measures it on the faces, [`removal::prove()`] says whether all limits hold, [`removal::stock`] takes it out of the
//! raw material.
//!
//! ```
//! use osculate_geom::{Domain, Interval, Point3, Vec3, analytic::Plane};
//! use osculate_tools::removal::{Job, Swept, cut, sample_surface};
//! use osculate_tools::{Cutter, Pose};
//! // A flat end of 10 mm, 0.02 mm above a plane: that is left at every sample.
//! let side = Interval::new(0.0, 4.0);
//! let samples = sample_surface(&Plane::new(Domain { u: side, v: side }), 0, 0.5, 10_000)?.samples;
//! let at = |x: f64| Pose { tip: Point3::new(x, 2.0, 0.02), axis: Vec3::z_axis() };
//! let motions = [Swept { from: at(-6.0), to: at(10.0), rapid: false, block: 1 }];
//! let cutter = Cutter::cylinder(10.0, 40.0)?;
//! let job = Job {
//!     cutter: &cutter,
//!     holder: None,
//!     changes: &[],
//!     motions: &motions,
//!     samples: &samples,
//!     stock_mm: 0.5,
//!     depth_mm: 1.0,
//! };
//! assert!(cut(&job, &|_| ())?.iter().all(|c| (c.standoff_mm - 0.02).abs() < 1e-9));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From a ruled face to the side of a cutter
//!
//! ```
//! use osculate_geom::{Point3, Side, analytic::Line};
//! use osculate_tools::flank::{RuledStrip, Setting, SideTool, Stations, Verdict, place};
//! // A plane wall is a rule's best case: a cylinder along any rule neither gouges nor leaves anything.
//! let edge = |z: f64| Line::segment(Point3::new(0.0, 0.0, z), Point3::new(50.0, 0.0, z));
//! let wall = RuledStrip::new(edge(0.0)?, edge(30.0)?, Side::Along, 1.0)?;
//! let (tool, stations) = (SideTool::cylinder(8.0)?, Stations::new(&wall, 8));
//! let placed = place(&wall, &stations, 0.5, tool, Setting::Distributed)?;
//! let profile = placed.profile(&wall, &stations, &tool, 9);
//! assert!(profile.max_abs_mm() < 1e-12);
//! assert_eq!(placed.verdict(&wall, &tool, &profile, 0.001)?, Verdict::Valid);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cl;
pub mod contact;
mod cutter;
pub mod flank;
mod holder;
mod make;
pub mod meridian;
mod pose;
pub mod reach;
pub mod removal;
mod spec;
pub mod strip;
pub mod sweep;

pub use contact::{Contact, ContactError, ContactMotion, FeedLine, Lean, moving_with_axis, pose_with_axis};
pub use cutter::{Cutter, CutterError, Entry, HEEL_CLEARANCE_MM, Line, Part};
pub use holder::{Holder, HolderError, HolderSection};
pub use pose::Pose;
pub use spec::{CutterSpec, HolderSpec};

/// The example of the package's README is run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
