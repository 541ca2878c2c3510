//! The index of a NURBS surface for closest points: nearly flat cells with proven bounds, in a tree of boxes.
//!
//! A cell is a sub-rectangle of one piece with its tangent parallelogram at the middle, `c + a s + b t` for s
//! and t in `[-1, 1]`, and bounds of the second and third derivatives over it ([`super::bounds`]). By
//! Taylor's theorem the surface stays within
//!
//! ```text
//! flatness = (|S_ss| + 2 |S_st| + |S_tt|) / 2
//! ```
//!
//! of the parallelogram, point by point, so that the distance of a query from the parallelogram less the
//! flatness bounds its distance from the cell from below.

use super::bounds::{Bounds, bounds, moved};
use super::cell::Cell;
use super::tree::{Index, Tree};
use crate::nurbs::{NurbsSurface, piece_powers};
use nalgebra::Vector4;
use osculate_geom::{Axis, Domain, Interval, Jet2, Uv, Vec3, uv};

/// A cell is flat enough for the index when it strays from its parallelogram by less than this fraction of
/// its own size: then Newton's method converges from any start in it unless the query is near a centre of
/// curvature.
const FLAT: f64 = 0.06;

/// Most halvings of a piece for the index; what is still curved then is halved by the search where it
/// matters.
const MAX_HALVINGS: u32 = 8;

/// Most cells made by halving pieces, beyond the one that every piece has.
const MAX_EXTRA_CELLS: usize = 1 << 17;

impl Cell {
    /// The cell's rectangle, cut to the ends of its piece, which rounding could pass.
    pub(super) fn rect(&self, surface: &NurbsSurface) -> Domain {
        let side = |axis: Axis| {
            let ends = &surface.knots(axis).breaks()[self.span[axis as usize] as usize..][..2];
            let (m, h) = (self.middle.get(axis), self.half.get(axis));
            Interval::new((m - h).max(ends[0]), (m + h).min(ends[1]))
        };
        Domain { u: side(Axis::U), v: side(Axis::V) }
    }

    /// The jet of the cell's own piece.
    pub(super) fn jet(&self, surface: &NurbsSurface, at: Uv) -> Jet2 {
        surface.piece_jet(at, self.spans())
    }

    /// Both halves across an axis, with bounds that shrink with them.
    pub(super) fn halves(&self, surface: &NurbsSurface, axis: Axis) -> [Self; 2] {
        let [(pu, fu), (pv, fv)] = match axis {
            Axis::U => [(0.5, 0.5), (0.0, 1.0)],
            Axis::V => [(0.0, 1.0), (0.5, 0.5)],
        };
        [-1.0, 1.0].map(|sign| {
            let middle = self.at([sign * pu, sign * pv]);
            let half = uv(self.half.u * fu, self.half.v * fv);
            let jet = self.jet(surface, middle);
            let [t0, t1, t2, t3] = self.bounds.third;
            let third = [t0 * fu * fu * fu, t1 * fu * fu * fv, t2 * fu * fv * fv, t3 * fv * fv * fv];
            let bends = bends(&jet, half);
            let [s0, s1, s2] = self.bounds.second;
            let second = [s0 * fu * fu, s1 * fu * fv, s2 * fv * fv];
            let bounds = Bounds { second, third }.tightened(&bends);
            Self {
                span: self.span,
                middle,
                half,
                centre: jet.point,
                sides: [jet.du * half.u, jet.dv * half.v],
                bends,
                bounds,
            }
        })
    }
}

/// Second derivatives by s and t, which run over the half widths.
fn bends(jet: &Jet2, half: Uv) -> [Vec3; 3] {
    [jet.duu * (half.u * half.u), jet.duv * (half.u * half.v), jet.dvv * (half.v * half.v)]
}

impl NurbsSurface {
    /// What the search for closest points needs, built on first use.
    pub(crate) fn index(&self) -> &Index {
        self.index_cell.get_or_init(|| Index::new(self))
    }
}

impl Index {
    pub(crate) fn new(surface: &NurbsSurface) -> Self {
        let mut cells = cells(surface);
        let tree = Tree::new(&mut cells);
        Self { cells, tree }
    }
}

/// The cells of all pieces, halved until they are flat enough or too many.
fn cells(surface: &NurbsSurface) -> Vec<Cell> {
    let knots = surface.both_knots();
    let net = surface.net();
    let powers =
        [0, 1].map(|a| (0..knots[a].span_count()).map(|s| knots[a].span_powers(s)).collect::<Vec<_>>());
    let terms = [knots[0].degree() + 1, knots[1].degree() + 1];
    let mut cells = Vec::new();
    let mut extra = 0;
    for (su, pu) in powers[0].iter().enumerate() {
        for (sv, pv) in powers[1].iter().enumerate() {
            let (_, c) = piece_powers(knots, net, [su, sv], [pu, pv]);
            let piece = Piece {
                surface,
                span: [su as u32, sv as u32],
                terms,
                c,
                least_weight: least_weight(surface, [su, sv]),
            };
            let mut stack = vec![([0.0, 0.0], [1.0, 1.0], 0)];
            while let Some((middle, half, depth)) = stack.pop() {
                let cell = piece.cell(middle, half);
                let size = cell.sides[0].norm().max(cell.sides[1].norm());
                // Negated: a NaN from huge coordinates must not be halved.
                let curved = cell.flatness_mm() > FLAT * size;
                if !curved || depth >= MAX_HALVINGS || extra >= MAX_EXTRA_CELLS {
                    cells.push(cell);
                    continue;
                }
                extra += 1;
                let k = cell.bent_axis() as usize;
                for sign in [1.0, -1.0] {
                    let (mut m, mut h) = (middle, half);
                    h[k] *= 0.5;
                    m[k] += sign * h[k];
                    stack.push((m, h, depth + 1));
                }
            }
        }
    }
    cells
}

/// The least weight of the poles that act on a piece: its denominator is a mean of them.
fn least_weight(surface: &NurbsSurface, span: [usize; 2]) -> f64 {
    let net = surface.net();
    let Some(weights) = &net.weights else { return 1.0 };
    let [u, v] = surface.both_knots();
    let (i0, j0) = (u.first_pole(span[0]), v.first_pole(span[1]));
    let rows = i0..=i0 + u.degree();
    rows.flat_map(|i| weights[i * net.count[1] + j0..][..=v.degree()].iter().copied())
        .fold(f64::INFINITY, f64::min)
}

/// A piece of the surface as a polynomial in x and y over `[-1, 1]`.
struct Piece<'a> {
    surface: &'a NurbsSurface,
    span: [u32; 2],
    terms: [usize; 2],
    c: Vec<Vector4<f64>>,
    least_weight: f64,
}

impl Piece<'_> {
    /// The cell around (x, y) = `middle`.
    fn cell(&self, middle: [f64; 2], half: [f64; 2]) -> Cell {
        let c = moved(&self.c, self.terms, middle, half);
        let on = |axis: Axis| {
            let ends = &self.surface.knots(axis).breaks()[self.span[axis as usize] as usize..][..2];
            let (k, w) = (axis as usize, 0.5 * (ends[1] - ends[0]));
            (ends[0] + w * (1.0 + middle[k]), w * half[k])
        };
        let ((u, hu), (v, hv)) = (on(Axis::U), on(Axis::V));
        let jet = self.surface.piece_jet(uv(u, v), self.span.map(|s| s as usize));
        let bends = bends(&jet, uv(hu, hv));
        Cell {
            span: self.span,
            middle: uv(u, v),
            half: uv(hu, hv),
            centre: jet.point,
            sides: [jet.du * hu, jet.dv * hv],
            bends,
            bounds: bounds(&c, self.terms, self.least_weight).tightened(&bends),
        }
    }
}
