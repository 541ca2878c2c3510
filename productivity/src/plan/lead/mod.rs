//! The lead as a function of the place: the least one that keeps the tool off the part, as far as it may change along the way.
//!
//! At places all over the face [`need`] finds the least lead at which the tool, in the direction in which a pass
//! runs there, goes nowhere into the part. A bicubic spline, which makes the tool's motion smooth, is laid above these as low as can be ([`fit`]), and
//! changes by no more than a stated rate per mm of the face ([`envelope`]); places between are asked again
//! ([`field`]). Strips of two contacts are narrow peaks in the lead, a tenth of a degree wide: passes to and fro have each a field of their own.
//! A tilt that is to be found comes first ([`balance`]): it shifts the strip across. It is a problem of the whole way: a place that needs a great lead raises the lead
//! before and after it, and where nothing is in the way the lead is as small, and the strip as wide, as can be.

mod balance;
mod envelope;
mod field;
mod fit;
mod lean;
mod need;

pub use lean::{LeadField, Leaning, LocalLead, SideTilt};
pub(super) use need::Clearance;
