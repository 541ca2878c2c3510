//! What carves, and what every tile of rays is carved by.

use crate::cutter::Cutter;
use crate::holder::Holder;
use crate::removal::body::Body as Moved;
use crate::removal::tree::Ways;
use crate::removal::{Body, Swept};

/// A body above the cutter: a shank or a section of a holder.
#[derive(Clone, Copy, Debug)]
pub struct Upper<'a> {
    /// Its shape.
    pub body: &'a Cutter,
    /// How far its lower end is above the tool tip, mm.
    pub above_mm: f64,
    /// Which it is.
    pub kind: Body,
}

impl<'a> Upper<'a> {
    /// Shank and holder above the part of a tool that cuts, in ascending order.
    #[must_use]
    pub fn all(flutes: &Cutter, shank: Option<&'a Cutter>, holder: Option<&'a Holder>) -> Vec<Self> {
        let top_mm = flutes.length_mm();
        let nose_mm = top_mm + shank.map_or(0.0, Cutter::length_mm);
        let mut out: Vec<Self> =
            shank.map(|body| Self { body, above_mm: top_mm, kind: Body::Shank }).into_iter().collect();
        out.extend(holder.map(Holder::sections).unwrap_or_default().iter().map(|s| Self {
            body: &s.body,
            above_mm: nose_mm + s.above_mm,
            kind: Body::Holder,
        }));
        out
    }
}

/// What carves.
#[derive(Clone, Copy, Debug)]
pub struct StockJob<'a> {
    /// The cutter. Its whole length cuts.
    pub cutter: &'a Cutter,
    /// Bodies above it, which must not meet material.
    pub uppers: &'a [Upper<'a>],
    /// The motions in the order in which they happen.
    pub motions: &'a [Swept],
    /// Longest stretch that a rapid, shank or holder may take from a ray before it is a collision, mm.
    pub touch_mm: f64,
}

/// What every tile is carved by.
pub(super) struct World<'a> {
    pub job: &'a StockJob<'a>,
    pub bodies: Vec<Moved<'a>>,
    pub ways: Ways,
    /// How far the straight pieces of a turning motion may stray from it, mm.
    pub stray_mm: f64,
}
