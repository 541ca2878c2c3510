//! From cutter location data to NC programs and back.
//!
//! ## From CL data to NC
//!
//! - [`cldata`] reads and writes APT cutter location files.
//! - [`feed`] writes F so that every block takes the time it should.
//! - [`nc`] words programs in the dialects of controls and reads them back to the tool's way; [`post()`] does it all.
//! - [`conduct`] says whether a program makes its moves in the state of the control that the job means.
//!
//! ```
//! use osculate_postproc::{cldata, conduct, post, readback, Dialect, FeedMode, Machine, PostOptions, Setup};
//!
//! let text = "RAPID\nGOTO/0,0,5,0,0.2,1\nFEDRAT/800,MMPM\nGOTO/10,0,5,0,0.3,1\nFINI\n";
//! let path = cldata::read(text)?.path;
//! let machine = Machine::built_in("trunnion-ac")?;
//! let setup = Setup::default();
//! let posted = post(&path, &machine, &setup, &PostOptions::new(Dialect::Sinumerik, FeedMode::InverseTime))?;
//! assert!(posted.summary.tip_error_mm <= 0.002);
//! let options = readback::ReadOptions::default();
//! let back = readback::read(&posted.text, Dialect::Sinumerik, &machine, &setup, &options)?;
//! // The last moves retract in the machine's own coordinates.
//! let end = back.moves.iter().rfind(|m| !m.own_frame).expect("it cuts");
//! assert!((end.pose.tip - path.moves[1].pose.tip).norm() < 1e-3);
//!
//! // It runs with the job's tool in its offset; the job says no speed of the spindle.
//! let tool = conduct::ExpectedTool::new(1, 80.0);
//! let conduct = back.conduct(&conduct::Expected::new(tool, None, 0.01));
//! assert_eq!(conduct.worst(), Some(conduct::Grade::Warning));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ## From a pose to joints
//!
//! - [`machine`] describes machine tools as chains of joints; [`machine::Machine::solve`] finds the joints of a path:
//!   branch and turn over the whole path, poles, limits, linearisation.
//! - [`Orienting`] says which tool axes the rotary joints reach with a part as it is set up, and what turning costs.
//! - [`suggest()`], [`axis_turns`], [`into_travel`] find where a part may stand.
//!
//! ```
//! use osculate_geom::{Point3, Unit3, Vec3};
//! use osculate_postproc::{Machine, Setup};
//! use osculate_tools::Pose;
//!
//! let machine = Machine::built_in("trunnion-bc")?;
//! let pose = Pose { tip: Point3::new(3.0, 4.0, 5.0), axis: Unit3::new_normalize(Vec3::new(0.2, 0.1, 1.0)) };
//! for joints in machine.inverse(&pose, &Setup::default())? {
//!     assert!((machine.forward(&joints, &Setup::default()).tip - pose.tip).norm() < 1e-9);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ## From NC to a time
//!
//! - [`motion`] says how long the axes need, [`nc::timing`] how long a control takes over a text.
//!
//! ```
//! use osculate_postproc::{Dialect, Machine, Setup, nc::timing};
//!
//! let machine = Machine::built_in("3-axis")?;
//! // 50 mm at 500 mm a minute: a tenth of a minute, and what starting and stopping costs.
//! let text = "G21 G90 G94\nG0 X0 Y0 Z0\nG1 X50 F500\nM30\n";
//! let timed = timing::time(text, Dialect::Fanuc, &machine, &Setup::default(), true)?;
//! assert!((0.1..0.102).contains(&timed.time.cutting_min));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Lengths are millimetres, angles radians, times minutes, feeds mm/min. The tool axis points from the tip to the spindle; CL
//! data are in the part's frame.

mod auxiliary;
mod choices;
pub mod cldata;
mod draft;
pub mod feed;
mod join;
pub mod joint_path;
mod linearize;
pub mod machine;
pub mod motion;
pub mod nc;
mod orienting;
mod part_turns;
mod post;
mod post_error;
mod post_options;
mod sections;
mod sequence;
mod setup;
mod setup_comment;
mod solve;
mod solve_error;
mod solve_options;
pub mod source;
mod suggest;
mod travel;
mod turn;

pub use auxiliary::{Auxiliary, AuxiliaryWord, Spindle};
pub use feed::{FeedMode, PathMetric};
pub use joint_path::{BlockKind, JointBlock, JointPath, SolveSummary};
pub use machine::{Machine, MachineError, built_in_names, built_in_text};
pub use nc::conduct;
pub use nc::dialect_file::{DialectFile, DialectFileError, shipped_dialect_text, shipped_dialects};
pub use nc::meetings;
pub use nc::readback;
pub use nc::{Coolant, Dialect, Orientation, WorkOffset};
pub use orienting::Orienting;
pub use part_turns::{axis_turns, clamped_turns, first_in_range, free_turns, tilts};
pub use post::{PostReport, PostSummary, Posted, post, post_from, post_to};
pub use post_error::PostError;
pub use post_options::PostOptions;
pub use sections::{PostedSections, Section, SectionError, post_sections, post_sections_to};
pub use setup::{Setup, SetupError};
pub use setup_comment::SetupCommentError;
pub use solve_error::SolveError;
pub use solve_options::SolveOptions;
pub use source::MoveSource;
pub use suggest::{Suggestion, suggest};
pub use travel::{in_travel, into_travel};
pub use turn::{Pace, quicker_turns};

/// The example of the package's README is run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
