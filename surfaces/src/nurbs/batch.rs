//! Jets and curvatures of many places of a NURBS surface at once.
//!
//! Eight places of one piece are evaluated side by side ([`super::pieces`]); the loops run with the
//! widest vectors that the processor has, chosen once at run time. Neighbours in the input that lie in one
//! piece are taken as they stand; what is left over is sorted by pieces first. No operation is fused or
//! reordered, so that every jet has the bits of [`osculate_geom::Surface::jet2`], whatever the order of the
//! input, the processor and the number of threads.

use super::pieces::{Piece, Pieces};
use super::surface::NurbsSurface;
use osculate_geom::batch::{CurvatureBlock, JetBlock, Lane, block_count};
use osculate_geom::lanes::{LANES, dot};
use osculate_geom::{Jet2, Surface, Uv, uv};
use rayon::prelude::*;

/// Places worked on between two sorts: their blocks (170 kB) stay in the second-level cache.
const CHUNK: usize = 1024;

/// Pieces up to which sorting counts; above, comparing is cheaper than clearing the counts.
const COUNTED: usize = 4 * CHUNK;

impl NurbsSurface {
    /// Jets at many parameters, appended to `out` in their order; each is [`Surface::jet2`] to the bit.
    pub fn jet2_batch(&self, at: &[Uv], out: &mut Vec<Jet2>) {
        out.reserve(at.len());
        let mut blocks = Vec::new();
        for places in at.chunks(CHUNK) {
            self.jets_into(places, &mut blocks);
            out.extend((0..places.len()).map(|k| blocks[k / LANES].get(k % LANES)));
        }
    }

    /// Jets at many parameters in blocks of [`LANES`], replacing what `out` held. The last block is filled up
    /// with its last place.
    ///
    /// Fastest where neighbours in `at` lie in one piece; any order gives the same bits.
    pub fn jets_into(&self, at: &[Uv], out: &mut Vec<JetBlock>) {
        out.resize(block_count(at.len()), JetBlock::default());
        for (places, blocks) in at.chunks(CHUNK).zip(out.chunks_mut(CHUNK / LANES)) {
            self.jet_chunk(places, blocks);
        }
    }

    /// [`NurbsSurface::jets_into`] on all threads.
    pub fn par_jets_into(&self, at: &[Uv], out: &mut Vec<JetBlock>) {
        out.resize(block_count(at.len()), JetBlock::default());
        at.par_chunks(CHUNK)
            .zip(out.par_chunks_mut(CHUNK / LANES))
            .for_each(|(places, blocks)| self.jet_chunk(places, blocks));
    }

    /// Principal curvatures and directions at many parameters in blocks of [`LANES`], replacing what `out`
    /// held: [`JetBlock::curvatures`] of [`NurbsSurface::jets_into`].
    ///
    /// ```
    /// use osculate_geom::{Surface, lanes::LANES, uv};
    /// use osculate_surfaces::gallery;
    /// // Ten places are two blocks of eight: the ninth is the first of the second block.
    /// let s = gallery::m86(4);
    /// let places: Vec<_> = (0..10).map(|k| uv(0.05 + 0.1 * f64::from(k), 0.4)).collect();
    /// let mut blocks = Vec::new();
    /// s.curvatures_into(&places, &mut blocks);
    /// assert_eq!(blocks.len(), 2);
    /// let (ninth, alone) = (blocks[8 / LANES].get(8 % LANES)?, s.jet2(places[8]).forms()?.principal());
    /// assert!((ninth.k_max - alone.k_max).abs() < 1e-12 && (ninth.k_min - alone.k_min).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn curvatures_into(&self, at: &[Uv], out: &mut Vec<CurvatureBlock>) {
        out.resize(block_count(at.len()), CurvatureBlock::default());
        let mut jets = Vec::new();
        for (places, blocks) in at.chunks(CHUNK).zip(out.chunks_mut(CHUNK / LANES)) {
            self.curvature_chunk(places, &mut jets, blocks);
        }
    }

    /// [`NurbsSurface::curvatures_into`] on all threads.
    pub fn par_curvatures_into(&self, at: &[Uv], out: &mut Vec<CurvatureBlock>) {
        out.resize(block_count(at.len()), CurvatureBlock::default());
        at.par_chunks(CHUNK)
            .zip(out.par_chunks_mut(CHUNK / LANES))
            .for_each_init(Vec::new, |jets, (places, blocks)| self.curvature_chunk(places, jets, blocks));
    }

    fn curvature_chunk(&self, at: &[Uv], jets: &mut Vec<JetBlock>, out: &mut [CurvatureBlock]) {
        jets.resize(out.len(), JetBlock::default());
        self.jet_chunk(at, jets);
        pulp::Arch::new().dispatch(Curve { jets, out });
    }

    /// At most [`CHUNK`] places.
    fn jet_chunk(&self, at: &[Uv], out: &mut [JetBlock]) {
        match self.pieces() {
            Some(pieces) => pulp::Arch::new().dispatch(Chunk { surface: self, pieces, at, out }),
            None => {
                for (k, place) in at.iter().enumerate() {
                    out[k / LANES].set(k % LANES, &self.jet2(*place));
                }
            }
        }
        // The lanes behind the last place.
        let (last, used) = ((at.len() - 1) / LANES, (at.len() - 1) % LANES + 1);
        if used < LANES {
            let jet = out[last].get(used - 1);
            (used..LANES).for_each(|lane| out[last].set(lane, &jet));
        }
    }
}

/// Curvatures of all blocks.
struct Curve<'a> {
    jets: &'a [JetBlock],
    out: &'a mut [CurvatureBlock],
}

impl pulp::NullaryFnOnce for Curve<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (jet, k) in self.jets.iter().zip(self.out) {
            *k = jet.curvatures();
        }
    }
}

/// Jets of a chunk.
struct Chunk<'a> {
    surface: &'a NurbsSurface,
    pieces: &'a Pieces,
    at: &'a [Uv],
    out: &'a mut [JetBlock],
}

/// A place that shares its block with places of other pieces.
#[derive(Clone, Copy)]
struct Stray {
    piece: u32,
    /// Index in the chunk.
    index: u32,
    at: Uv,
}

impl pulp::NullaryFnOnce for Chunk<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { surface, pieces, at, out } = self;
        let side = surface.side().sign();
        let mut strays: Vec<Stray> = Vec::new();
        let mut piece = pieces.piece([0, 0]);
        let mut inside = Inside::of(pieces, [0, 0]);
        for (k, places) in at.chunks(LANES).enumerate() {
            if let Ok(eight) = <&[Uv; LANES]>::try_from(places) {
                let u = Lane::from_array(std::array::from_fn(|k| eight[k].u));
                let v = Lane::from_array(std::array::from_fn(|k| eight[k].v));
                if !inside.holds(&u, &v) {
                    let span = surface.span(surface.bring(eight[0]));
                    inside = Inside::of(pieces, span);
                    piece = pieces.piece(span);
                }
                if inside.holds(&u, &v) {
                    piece_block(&piece, pieces.rational, u, v, side, &mut out[k]);
                    continue;
                }
                // The common case in ordered input: the first lanes belong to one piece, the rest to the next.
                let other = surface.span(surface.bring(eight[LANES - 1]));
                let next = Inside::of(pieces, other);
                let split = inside.count(&u, &v);
                if next.holds_from(&u, &v, split) {
                    let mut rest = JetBlock::default();
                    piece_block(&piece, pieces.rational, u, v, side, &mut out[k]);
                    (inside, piece) = (next, pieces.piece(other));
                    piece_block(&piece, pieces.rational, u, v, side, &mut rest);
                    (split..LANES).for_each(|lane| rest.copy_lane(lane, &mut out[k], lane));
                    continue;
                }
            }
            strays.extend(places.iter().enumerate().map(|(lane, place)| {
                let at = surface.bring(*place);
                let piece = pieces.number(surface.span(at)) as u32;
                Stray { piece, index: (k * LANES + lane) as u32, at }
            }));
        }
        if strays.is_empty() {
            return;
        }
        sort(&mut strays, pieces.count());
        let mut block = JetBlock::default();
        for run in strays.chunk_by(|a, b| a.piece == b.piece) {
            let piece = pieces.piece(pieces.spans(run[0].piece as usize));
            for group in run.chunks(LANES) {
                let place = |lane: usize| group[lane.min(group.len() - 1)].at;
                let u = Lane::from_array(std::array::from_fn(|k| place(k).u));
                let v = Lane::from_array(std::array::from_fn(|k| place(k).v));
                piece_block(&piece, pieces.rational, u, v, side, &mut block);
                for (lane, stray) in group.iter().enumerate() {
                    let to = &mut out[stray.index as usize / LANES];
                    block.copy_lane(lane, to, stray.index as usize % LANES);
                }
            }
        }
    }
}

/// Parameters that belong to one piece without being wrapped or clamped.
struct Inside {
    lo: Uv,
    /// Not inside any more.
    hi: Uv,
}

impl Inside {
    #[inline(always)]
    fn of(pieces: &Pieces, span: [usize; 2]) -> Self {
        let [u, v] = pieces.ends(span);
        Self { lo: uv(u[0], v[0]), hi: uv(u[1], v[1]) }
    }

    #[inline(always)]
    fn lane(&self, u: &Lane, v: &Lane, k: usize) -> bool {
        (u.0[k] >= self.lo.u) & (u.0[k] < self.hi.u) & (v.0[k] >= self.lo.v) & (v.0[k] < self.hi.v)
    }

    #[inline(always)]
    fn holds(&self, u: &Lane, v: &Lane) -> bool {
        (0..LANES).fold(true, |all, k| all & self.lane(u, v, k))
    }

    /// Whether all lanes from `first` on are inside.
    #[inline(always)]
    fn holds_from(&self, u: &Lane, v: &Lane, first: usize) -> bool {
        (first..LANES).all(|k| self.lane(u, v, k))
    }

    /// How many lanes are inside before the first that is not.
    #[inline(always)]
    fn count(&self, u: &Lane, v: &Lane) -> usize {
        (0..LANES).take_while(|k| self.lane(u, v, *k)).count()
    }
}

/// By piece, then by index.
#[inline(always)]
fn sort(strays: &mut Vec<Stray>, pieces: usize) {
    if pieces > COUNTED || strays.len() < 2 * LANES {
        strays.sort_unstable_by_key(|s| (s.piece, s.index));
        return;
    }
    let mut starts = vec![0u32; pieces + 1];
    for s in strays.iter() {
        starts[s.piece as usize + 1] += 1;
    }
    for k in 0..pieces {
        starts[k + 1] += starts[k];
    }
    let mut sorted = strays.clone();
    for s in strays.iter() {
        let to = &mut starts[s.piece as usize];
        sorted[*to as usize] = *s;
        *to += 1;
    }
    *strays = sorted;
}

/// Eight jets of one piece: the arithmetic of one jet, lane by lane.
#[inline(always)]
fn piece_block(piece: &Piece<'_>, rational: bool, u: Lane, v: Lane, side: f64, out: &mut JetBlock) {
    let (x, y) = (piece.frames[0].local(u), piece.frames[1].local(v));
    out.uv = [u, v];
    out.side = Lane::splat(side);
    if rational {
        let [w, wu, wv, wuu, wuv, wvv] = piece.lanes(3, x, y);
        let r = Lane::splat(1.0) / w;
        for c in 0..3 {
            let [a, au, av, auu, auv, avv] = piece.lanes(c, x, y);
            let s = a * r;
            let su = (au - s * wu) * r;
            let sv = (av - s * wv) * r;
            out.orders[0][c] = s + Lane::splat(piece.origin[c]);
            out.orders[1][c] = su;
            out.orders[2][c] = sv;
            out.orders[3][c] = (auu - su * (wu + wu) - s * wuu) * r;
            out.orders[4][c] = (auv - sv * wu - su * wv - s * wuv) * r;
            out.orders[5][c] = (avv - sv * (wv + wv) - s * wvv) * r;
        }
    } else {
        for c in 0..3 {
            let orders = piece.lanes(c, x, y);
            for (k, order) in orders.into_iter().enumerate() {
                out.orders[k][c] = order;
            }
            out.orders[0][c] = out.orders[0][c] + Lane::splat(piece.origin[c]);
        }
    }
    for (k, silent) in piece.silent().into_iter().enumerate() {
        let d = out.orders[k + 1];
        let square = dot(&d, &d);
        out.orders[k + 1] = d.map(|c| c.with(square, |x, s| if s < silent { 0.0 } else { x }));
    }
}
