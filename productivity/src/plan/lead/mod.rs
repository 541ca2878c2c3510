//! The lead as a function of the place: the least one that keeps the tool off the part, as far as it may change along the way.
//!
//! At the nodes of a grid over the face [`need`] finds the least lead at which the tool, in the directions in which the passes
//! run there, goes nowhere into the part. [`envelope`] raises these to a field that changes by no more than a stated rate per mm
//! of the face, a bicubic spline over it makes the tool's motion smooth, and places between the nodes are asked again
//! ([`field`]). It is a problem of the whole way: a place that needs a great lead raises the lead before and after it, and where
//! nothing is in the way the lead is as small, and the strip as wide, as can be.

mod envelope;
mod field;
mod lean;
mod need;

pub use lean::{LeadField, Leaning, LocalLead, SideTilt};
pub(super) use need::Clearance;
