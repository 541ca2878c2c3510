//! The edges of a face as its file gave them, kept beside the loops: what tessellation and export share between faces.

use super::curve::{Moved, Piece};
use super::motion::Motion;
use osculate_geom::Uv;
use std::sync::Arc;

/// An edge as one loop of a face uses it, slits and seams included.
#[derive(Clone)]
pub(crate) struct FaceEdge {
    /// The edge's identity in the file, the same for every use of it.
    pub(crate) key: Option<u64>,
    /// The loop it belongs to; edges of a loop stand in its order.
    pub(crate) owner: usize,
    /// The curve in space along the loop's sense; `None` where the file gives only parameters.
    pub(crate) curve: Option<Piece>,
    /// The largest distance of the curve from the carrier where that was looked at, mm.
    pub(crate) gap_mm: f64,
    /// Carrier parameters along the loop's sense, unwrapped, to the chord tolerance of the loops.
    pub(crate) points: Vec<Uv>,
}

/// Spreads place numbers over the numbers of edges, so that one edge at two places is two edges.
const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;

impl FaceEdge {
    /// The edge at a place.
    pub(crate) fn placed(&self, motion: Option<&Motion>, place: u64) -> Self {
        let curve = match (&self.curve, motion) {
            (Some(p), Some(motion)) => {
                let moved = Moved { curve: p.curve.clone(), motion: *motion };
                Some(Piece { curve: Arc::new(moved), ends: p.ends })
            }
            (own, _) => own.clone(),
        };
        Self { key: self.key.map(|k| k.wrapping_add(place.wrapping_mul(SPREAD))), curve, ..self.clone() }
    }
}
