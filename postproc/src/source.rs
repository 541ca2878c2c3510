//! Where the moves of a path come from: memory, or a text that is read each time.

use std::convert::Infallible;
use std::ops::ControlFlow;

use osculate_tools::cl::{ClMove, ClPath};

/// Moves that can be gone over more than once.
///
/// ```
/// use osculate_postproc::{MoveSource, cldata};
/// use std::ops::ControlFlow;
///
/// let path = cldata::read("RAPID\nGOTO/0,0,5\nFEDRAT/600\nGOTO/1,0,5\nGOTO/2,0,5\nFINI\n")?.path;
/// let mut lengths = Vec::new();
/// path.pieces(2, &mut |piece| {
///     lengths.push(piece.len());
///     ControlFlow::Continue(())
/// })?;
/// assert_eq!(lengths, [2, 1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait MoveSource {
    /// Why they cannot be had.
    type Error;

    /// Gives all moves in order, in pieces of `most` (the last one may be shorter), until `take` breaks off.
    ///
    /// # Errors
    /// Where the source fails.
    fn pieces(
        &self,
        most: usize,
        take: &mut dyn FnMut(&[ClMove]) -> ControlFlow<()>,
    ) -> Result<(), Self::Error>;
}

impl MoveSource for ClPath {
    type Error = Infallible;

    fn pieces(
        &self,
        most: usize,
        take: &mut dyn FnMut(&[ClMove]) -> ControlFlow<()>,
    ) -> Result<(), Infallible> {
        for piece in self.moves.chunks(most.max(1)) {
            if take(piece).is_break() {
                break;
            }
        }
        Ok(())
    }
}
