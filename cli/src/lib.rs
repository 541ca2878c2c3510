//! **osculate** plans, verifies and posts multi-axis NC machining of free-form surfaces.
//!
//! This is the library under the program of the same name. Five steps lead from a part to a program whose verdict is known;
//! each of them is a function here, and the program calls nothing else.
//!
//! ## From a text to a job
//!
//! A [`Job`] says everything that is wanted: the part and the faces to machine, the tool, the tolerance, the strategy, the machine
//! and its control. It is a text in TOML, read from a file with [`Job::load`] or from a string with [`Job::from_toml`]. Everything
//! that can be checked without the part is checked there, and the message of a [`Failure`] names line, key and remedy. `osculate
//! keys` prints all keys; [`Job::schema`] is what it prints from.
//!
//! ```
//! use osculate::Job;
//! use std::path::Path;
//!
//! // A job without a tool is refused, with what it needs.
//! let text = "format = 1\npart = { builtin = { kind = \"plane\", half_size_mm = 5 } }\ntolerance = { scallop_mm = 0.1 }\n";
//! let message = Job::from_toml(text, Path::new("plane.toml")).expect_err("no tool").to_string();
//! assert!(message.contains("plane.toml") && message.contains("[tool]"));
//! ```
//!
//! A whole part with several tools and setups is a list of operations, [`Operations`](job::Operations): [`work::operations`] reads its part, plans
//! it and judges its programs as [`plan()`] and [`verify()`] do for a job.
//!
//! ## From a job to a part
//!
//! [`Part::of`] reads the part of a job: STEP, IGES, patches, point sections, or a built-in surface. It holds the faces to machine
//! and all other faces as well, because the tool must not touch those. On which side of a face the material is, the file says or the
//! shape does; where neither says it, reading fails.
//!
//! ```
//! use osculate::part;
//!
//! // A built-in surface is a part as well; the area of this one is 2 pi r h.
//! let cylinder = part::built_in("kind = \"cylinder\", radius_mm = 10, height_mm = 20")?;
//! let area_mm2 = part::area(&cylinder.faces[0]);
//! assert!((area_mm2 - 2.0 * std::f64::consts::PI * 10.0 * 20.0).abs() < 1e-6 * area_mm2);
//! # Ok::<(), osculate::Failure>(())
//! ```
//!
//! ## From a part to a program
//!
//! [`plan()`] finds the passes, joins them, posts them for the control, reads the program back from its text, and judges what that
//! text does. The [`Plan`] holds the program, the report, and the [`Verdict`]. A verdict has one of three answers: [`Answer::Held`],
//! [`Answer::NotHeld`] with the reasons, or [`Answer::NotShown`] where the limits are met wherever it was looked but nothing
//! bounds what lies between. Its scope says what was looked at and what was not; printing a verdict prints both.
//!
//! ## From NC to a verdict
//!
//! [`verify()`] judges any program: one that was edited, or one that another system wrote. The text alone counts. The
//! program of a plan gets the plan's verdict again, byte for byte.
//!
//! ```
//! use osculate::{Answer, Job, Part};
//! use std::path::Path;
//!
//! let text = r#"
//!     format = 1
//!     part = { builtin = { kind = "plane", half_size_mm = 1 } }
//!     tool = { kind = "ball", diameter_mm = 6, length_mm = 40 }
//!     tolerance = { scallop_mm = 0.01 }
//!     machine = { name = "3-axis", dialect = "linuxcnc", feed = "none" }
//! "#;
//! let job = Job::from_toml(text, Path::new("strip.toml"))?;
//! // One pass along the middle leaves 3 - sqrt(8) = 0.17 mm at 1 mm beside it, where 0.01 mm may stand.
//! let program = "G21 G90 G94 G54 G61\nT1 M6\nS8000 M3\nG43 H1\nG0 X-4 Y0\nG0 Z5\nG1 Z0 F500\nG1 X4\nG0 Z50\nM30\n";
//! let verified = osculate::verify(&Part::of(&job)?, &job, program)?;
//! assert_eq!(verified.verdict.answer(), Answer::NotHeld);
//! assert!(!verified.verdict.why().is_empty());
//! # Ok::<(), osculate::Failure>(())
//! ```
//!
//! ## All of it
//!
//! ```
//! use osculate::{Answer, Job, Part};
//! use std::path::Path;
//!
//! let text = r#"
//!     format = 1
//!     [part]
//!     builtin = { kind = "plane", half_size_mm = 5 }
//!     [tool]
//!     kind = "ball"
//!     diameter_mm = 6
//!     length_mm = 40
//!     teeth = 2
//!     [tolerance]
//!     scallop_mm = 0.1
//!     [strategy]
//!     kind = "isoparametric"
//!     lead_deg = 10
//!     [cutting]
//!     spindle_rpm = 8000
//!     [machine]
//!     name = "trunnion-ac"
//!     dialect = "linuxcnc"
//!     feed = "tcp"
//! "#;
//! // Files that a job names lie beside this path, and messages name it.
//! let job = Job::from_toml(text, Path::new("plane.toml"))?;
//! let part = Part::of(&job)?;
//! let plan = osculate::plan(&part, &job, &())?;
//! println!("{}", plan.verdict());
//! assert_eq!(plan.verdict().answer(), Answer::Held);
//!
//! // Another look at the same text ends in the same words.
//! let again = osculate::verify(&part, &job, plan.program())?;
//! assert_eq!(again.verdict.to_string(), plan.verdict().to_string());
//!
//! // Program, CL data, report, pictures and figures.
//! let folder = std::env::temp_dir().join(format!("osculate-tour-{}", std::process::id()));
//! plan.write(&folder)?;
//! assert!(folder.join("report.html").is_file());
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ## Who listens
//!
//! A plan can take minutes. [`plan()`] names its stages, and how far each is, to a [`Watch`]; `()` is one that listens to nothing.
//! The library itself prints nothing, and it writes what [`Plan::write`] is asked to write.
//!
//! ## Below
//!
//! The crates below work without a job. `osculate_geom` has the trait that a surface of one's own implements, `osculate_tools` the
//! exact strips of a cutter and the verdict on motions, `osculate_productivity` the passes, `osculate_postproc` machines and
//! dialects, `osculate_surfaces` what CAD files hold. Programs of a page in `cli/examples` start from here: `read_a_face`
//! and `strip_widths` look at geometry, `own_surface` and `own_machine` bring a surface and a machine, `plan_a_part` goes from a STEP file to a report,
//! `judge_a_program` spoils a program and shows what the verdict says of it, `sweep` plans many jobs.

pub mod failure;
pub mod figure;
pub mod files;
pub mod job;
pub mod part;
pub mod report;
pub mod second;
pub mod triangles;
pub mod watch;
pub mod words;
pub mod work;

/// The linear algebra of the signatures of all crates below, in the version that they have.
pub use osculate_geom::nalgebra;

pub use failure::Failure;
pub use job::{Job, Overrides};
pub use osculate_tools::removal::{Answer, Verdict};
pub use part::Part;
pub use watch::Watch;
pub use work::check::verify;
pub use work::plan::{Plan, PlanFile, plan};
pub use work::verify::Verified;

/// The example of the package's README is run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
