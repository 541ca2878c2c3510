//! Concrete surfaces: NURBS with their evaluation, refinement and closest points, and what is imported from CAD files.
//!
//! - [`NurbsSurface`] is a checked tensor-product NURBS; it implements [`osculate_geom::Surface`].
//! - [`NurbsCurve`] is a NURBS curve in the plane ([`NurbsCurve2`]) or in space ([`NurbsCurve3`]).
//! - [`closest()`] finds the nearest point of a NURBS surface with a certificate, [`closest_near`] the one near a hint.
//! - [`ruled()`] joins two curves by straight rulings.
//!
//! Lengths are millimetres, parameters have no unit.
//!
//! # From poles to a nearest point
//!
//! ```
//! use osculate_geom::{Point3, Surface, uv};
//! use osculate_surfaces::{Net, NurbsSurface, closest};
//! // z = x y over the unit square.
//! let corner = |x: f64, y: f64| Point3::new(x, y, x * y);
//! let points = vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 0.0), corner(1.0, 1.0)];
//! let flat = vec![0.0, 0.0, 1.0, 1.0];
//! let net = Net { count: [2, 2], points, weights: None };
//! let saddle = NurbsSurface::new([1, 1], [flat.clone(), flat], net)?;
//! assert_eq!(saddle.point(uv(0.5, 0.5)).z, 0.25);
//! let foot = closest(&saddle, &Point3::new(2.0, 2.0, 1.0), None)?;
//! assert!((foot.distance_mm - 2f64.sqrt()).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From a CAD file to a face
//!
//! [`read`] takes what [`detect`] knows: STEP, IGES, Bezier patches, sections of points, the JSON of this crate. A [`Part`] has its
//! faces, what was not understood by kind and count, and findings.
//!
//! ```
//! use osculate_geom::{Axis, Surface};
//! use osculate_surfaces::read;
//! // Bezier patches as text stand for a file here: one flat patch of 10 x 20 mm.
//! let part = read(b"1\n1 1\n0 0 0\n0 20 0\n10 0 0\n10 20 0\n")?;
//! let face = part.face("F1").ok_or("it has no face")?;
//! assert!((face.area_mm2() - 200.0).abs() < 1e-9 && part.not_used.is_empty());
//! // A face is a surface, with its trims and its material side.
//! assert_eq!(face.spans(Axis::U, 0.5).len(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From points to a surface
//!
//! [`fit`] goes through points or near them, [`fn@approximate`] is near another surface, [`ToNurbs`] is exact.
//!
//! ```
//! use osculate_geom::{Point3, Surface, uv};
//! use osculate_surfaces::fit::{LoftOptions, Spacing, loft};
//! // Four straight sections on a plane that rises with y: the surface between them is that plane.
//! let section = |y: f64| (0..5).map(|k| Point3::new(10.0 * f64::from(k), y, 0.5 * y)).collect::<Vec<_>>();
//! let options = LoftOptions { degree: [3, 3], spacing: Spacing::Chord, closed: false, tolerance_mm: None };
//! let sheet = loft(&[section(0.0), section(10.0), section(20.0), section(30.0)], &options)?.surface;
//! assert!((sheet.point(uv(0.5, 0.5)) - Point3::new(20.0, 15.0, 7.5)).norm() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From faces to a file
//!
//! [`step`], [`iges`] and [`mod@json`] write faces, [`mesh_faces`] makes triangles of them and [`stl`] writes these.
//!
//! ```
//! use osculate_surfaces::{MeshOptions, mesh_faces, read, stl};
//! let part = read(b"1\n1 1\n0 0 0\n0 20 0\n10 0 0\n10 20 0\n")?;
//! let mesh = mesh_faces(&part.faces, &MeshOptions::chord(0.01))?;
//! // Two triangles are a rectangle.
//! assert_eq!((mesh.triangles.len(), mesh.area_mm2()), (2, 200.0));
//! assert_eq!(stl::ascii(&mesh, "plate").matches("facet normal").count(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod facets;
pub mod fit;
pub mod folds;
pub mod gallery;
pub mod groups;
pub mod hidden;
pub mod iges;
mod import;
pub mod json;
mod leftovers;
pub mod lines;
mod mesh;
mod part;
pub mod patches;
pub mod pattern;
pub mod sections;
pub mod sides;
pub mod step;
pub mod stl;
pub mod structure;
mod topology;
mod trim;
mod trimmed;

mod approximate;
mod basis;
mod closest;
mod convert;
mod knots;
mod nurbs;
mod quad;
mod refine;
mod ruled;

pub use approximate::{ApproximateError, Approximation, approximate};
pub use closest::{
    ClosestError, FaceSearch, Foot, FootKind, closest, closest_batch, closest_near, closest_sampled,
};
pub use convert::{ConvertError, CurveToNurbs, ToNurbs};
pub use import::{ImportError, detect, read};
pub use knots::{KnotError, Knots, MAX_DEGREE};
pub use mesh::{Mesh, MeshError, MeshOptions, MeshReport, PartMesh, mesh_faces, tessellate};
pub use nurbs::{
    BezierPatch, CurveError, CurveJet, EditError, Net, NurbsCurve, NurbsCurve2, NurbsCurve3, NurbsError,
    NurbsSurface, RemovedCurve, RemovedSurface,
};
pub use part::{Colour, CurvatureRange, Face, FaceKind, Format, NotUsed, Part};
pub use ruled::{
    Band, Mate, RuledBand, RuledError, Ruling, RulingError, RulingOptions, ruled, ruled_bands, ruling,
};
pub use trim::Imbalance;
pub use trim::analytic::{Analytic, Shape};
pub use trim::carrier::FaceSurface;
pub use trimmed::{Loop, TrimError, TrimmedSurface};

/// The example of the package's README is run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
