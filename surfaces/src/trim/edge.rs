//! The edges of a face as its file gave them, kept beside the loops: what tessellation and export share between faces.

use super::curve::Piece;
use osculate_geom::Uv;

/// An edge as one loop of a face uses it, slits and seams included.
#[derive(Clone)]
pub(crate) struct FaceEdge {
    /// The edge's identity in the file, the same for every use of it.
    pub(crate) key: Option<u64>,
    /// The loop it belongs to; edges of a loop stand in its order.
    pub(crate) owner: usize,
    /// The curve in space along the loop's sense; `None` where the file gives only parameters.
    pub(crate) curve: Option<Piece>,
    /// Carrier parameters along the loop's sense, unwrapped, to the chord tolerance of the loops.
    pub(crate) points: Vec<Uv>,
}
