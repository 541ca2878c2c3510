//! Descents over a NURBS surface: the loop and the jets of its pieces as one piece of code with the processor's
//! widest registers, so that no jet travels through memory between two steps.

use super::descent::{Found, Jets, descend};
use crate::nurbs::{NurbsSurface, Pieces};
use crate::quad::{self, Quad};
use osculate_geom::{Domain, Jet2, Point3, Surface, Uv};
use std::cell::Cell;

/// Down over the whole surface, or with `span` over one piece, continued where `rect` reaches past it.
pub(super) fn descend_surface(
    surface: &NurbsSurface,
    span: Option<[usize; 2]>,
    rect: &Domain,
    query: &Point3,
    start: Uv,
) -> Found {
    match surface.pieces() {
        Some(pieces) => quad::run(Way { surface, pieces, span, rect, query, start }),
        None => descend(&Direct { surface, span }, rect, query, start),
    }
}

/// A descent over precomputed pieces.
struct Way<'a> {
    surface: &'a NurbsSurface,
    pieces: &'a Pieces,
    span: Option<[usize; 2]>,
    rect: &'a Domain,
    query: &'a Point3,
    start: Uv,
}

impl quad::Over for Way<'_> {
    type Output = Found;

    #[inline(always)]
    fn run<Q: Quad>(self, q: Q) -> Found {
        let (fixed, last) = (self.span.is_some(), Cell::new(self.span.unwrap_or_default()));
        let jets = OnPieces { q, surface: self.surface, pieces: self.pieces, fixed, last };
        descend(&jets, self.rect, self.query, self.start)
    }
}

/// Jets of precomputed pieces.
struct OnPieces<'a, Q> {
    q: Q,
    surface: &'a NurbsSurface,
    pieces: &'a Pieces,
    /// Whether the first piece is that of all jets.
    fixed: bool,
    /// The piece of the last jet.
    last: Cell<[usize; 2]>,
}

impl<Q: Quad> Jets for OnPieces<'_, Q> {
    #[inline(always)]
    fn jet(&self, at: Uv) -> Jet2 {
        // Most steps stay on their piece. To guess that and to check it is no wait for what depends on it, as
        // looking the piece up would be. A descent brings its parameters into the domain itself.
        let mut span = self.last.get();
        if !self.fixed && !self.pieces.holds(span, at) {
            span = self.surface.span(at);
            self.last.set(span);
        }
        self.surface.jet_on(self.q, self.pieces, at, span)
    }
}

/// Jets by the direct sum.
struct Direct<'a> {
    surface: &'a NurbsSurface,
    span: Option<[usize; 2]>,
}

impl Jets for Direct<'_> {
    fn jet(&self, at: Uv) -> Jet2 {
        match self.span {
            Some(span) => self.surface.piece_jet(at, span),
            None => self.surface.jet2(at),
        }
    }
}
