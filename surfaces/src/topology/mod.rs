//! Edges and vertices that the faces of a part share.
//!
//! A STEP file says which edge two faces have in common; IGES faces, and STEP faces that only touch, are matched by
//! geometry: both ends, the middle and the length agree within a tolerance. An edge has one course in space for all
//! its uses. Vertices come from the order of edges in loops, so that no tolerance decides on them where the file
//! is sound.

mod bodies;
mod chart;
mod course;
mod isoline;
mod local;
mod loops;
mod matching;
mod pcurve;
mod shared;
mod track;
mod way;

pub(crate) use bodies::bodies;
pub(crate) use chart::{Chart, Wrapped};
pub(crate) use course::{Course, Follower, Spacing, on_polyline};
pub(crate) use local::{LocalEdge, edges as local_edges};
pub(crate) use loops::{Step, natural_loops, outward, turned};
pub(crate) use pcurve::{Ground, pcurves};
pub(crate) use shared::{Edge, FaceEdges, Topology};
pub(crate) use track::Track;
pub(crate) use way::{Along, Way, as_spline, way};
