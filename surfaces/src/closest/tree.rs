//! A tree of boxes over cells, four children a node and four cells a leaf, each looked at four at a time.
//!
//! The nearest point of a parallelogram `c + a s + b t`, s and t in `[-1, 1]`, minimises a convex quadratic
//! over a square. Where the least value of the plane lies outside, that of the square is on one of the sides
//! beyond which it lies, so that it is the nearer of two points: s clamped and t the best for it, and t
//! clamped and s the best for it. No branch depends on which of them it is.

use super::cell::Cell;
use crate::quad::{self, Quad};
use nalgebra::Vector3;
use osculate_geom::{Box3, Point3, Vec3};

/// Children of a node and cells of a leaf.
const WIDTH: usize = 4;

/// Marks the number of a leaf.
const LEAF: u32 = 1 << 31;

/// No child: a box that is infinitely far.
const NONE: u32 = u32::MAX;

/// Nodes that can wait. Splitting into halves twice keeps the depth below 16 for 2^31 leaves, and every level
/// leaves three of its four children behind.
const MAX_WAITING: usize = 64;

/// Squared sine between the sides of a parallelogram below which it is taken for a line.
const NARROW: f64 = 1e-8;

/// One number of four children or cells.
type Row = [f64; WIDTH];

/// Four boxes.
#[derive(Clone, Copy, Debug)]
struct Node {
    min: [Row; 3],
    max: [Row; 3],
    /// Numbers of nodes, or of leaves with [`LEAF`] set.
    child: [u32; WIDTH],
}

const EMPTY: Node =
    Node { min: [[f64::INFINITY; WIDTH]; 3], max: [[f64::NEG_INFINITY; WIDTH]; 3], child: [NONE; WIDTH] };

/// Four parallelograms.
#[derive(Clone, Copy, Debug, Default)]
struct Leaf {
    centre: [Row; 3],
    a: [Row; 3],
    b: [Row; 3],
    /// `a . a`, `a . b`, `b . b`.
    metric: [Row; 3],
    /// Reciprocals of `a . a`, of `b . b` and of the determinant; zero for that of zero.
    inverse: [Row; 3],
    flatness: Row,
}

/// The tree. A leaf's cells are its number times four and the next three.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    cells: u32,
}

/// Cells and the tree over them.
#[derive(Clone, Debug)]
pub(crate) struct Index {
    pub(super) cells: Vec<Cell>,
    pub(super) tree: Tree,
}

/// A cell that may hold the nearest point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// No point of the cell is nearer, mm.
    pub(super) least_mm: f64,
    pub(super) cell: u32,
}

/// What the tree knows about a query.
#[derive(Debug)]
pub(super) struct Seen {
    /// Those whose bound is not above the best upper bound at the time they were seen.
    pub(super) candidates: Vec<Candidate>,
    /// The cell whose parallelogram is nearest, and the place on it.
    pub(super) start: Option<(u32, [f64; 2])>,
}

impl Tree {
    /// Puts the cells in the order of the leaves.
    pub(super) fn new(cells: &mut Vec<Cell>) -> Self {
        let boxes: Vec<Box3> = cells.iter().map(Cell::box_around).collect();
        let mut order: Vec<u32> = (0..cells.len() as u32).collect();
        let count = cells.len().div_ceil(WIDTH);
        let cells_of = |from: usize, to: usize| WIDTH * from..(WIDTH * to).min(boxes.len());
        let around = |order: &[u32], from: usize, to: usize| {
            order[cells_of(from, to)].iter().fold(Box3::empty(), |b, k| b.union(&boxes[*k as usize]))
        };
        let mut nodes = vec![EMPTY];
        let mut stack = vec![(0, 0, count)];
        while let Some((node, from, to)) = stack.pop() {
            let mut parts = vec![(from, to)];
            for _ in 0..2 {
                parts = parts
                    .into_iter()
                    .flat_map(|(from, to)| {
                        if to - from < 2 {
                            return vec![(from, to)];
                        }
                        let whole = around(&order, from, to);
                        let axis = (whole.max - whole.min).imax();
                        let middle = (from + to) / 2;
                        let key = |k: &u32| boxes[*k as usize].centre()[axis];
                        order[cells_of(from, to)].select_nth_unstable_by(WIDTH * (middle - from), |a, b| {
                            key(a).total_cmp(&key(b)).then(a.cmp(b))
                        });
                        vec![(from, middle), (middle, to)]
                    })
                    .collect();
            }
            for (k, (from, to)) in parts.into_iter().enumerate() {
                let b = around(&order, from, to);
                for axis in 0..3 {
                    nodes[node].min[axis][k] = b.min[axis];
                    nodes[node].max[axis][k] = b.max[axis];
                }
                nodes[node].child[k] = if to - from == 1 {
                    LEAF | from as u32
                } else {
                    stack.push((nodes.len(), from, to));
                    nodes.push(EMPTY);
                    nodes.len() as u32 - 1
                };
            }
        }
        *cells = order.iter().map(|k| cells[*k as usize]).collect();
        let leaves = cells.chunks(WIDTH).map(Leaf::new).collect();
        Self { nodes, leaves, cells: cells.len() as u32 }
    }

    /// The cells that may hold the nearest point.
    pub(super) fn look(&self, query: &Point3) -> Seen {
        quad::run(Look { tree: self, query })
    }
}

impl Node {
    /// Squared distances of the boxes.
    #[inline(always)]
    fn squares<Q: Quad>(&self, q: Q, query: &[Q::V; 3]) -> Row {
        let [x, y, z] = [
            outside(q, query[0], &self.min[0], &self.max[0]),
            outside(q, query[1], &self.min[1], &self.max[1]),
            outside(q, query[2], &self.min[2], &self.max[2]),
        ];
        q.array(q.add(q.add(x, y), z))
    }
}

/// What a leaf says about a query.
struct Reach {
    least: Row,
    distance: Row,
    most: Row,
    s: Row,
    t: Row,
}

impl Leaf {
    /// The last cell stands for those that are missing.
    fn new(cells: &[Cell]) -> Self {
        let mut leaf = Self::default();
        for k in 0..WIDTH {
            let cell = &cells[k.min(cells.len() - 1)];
            let [mut a, mut b] = cell.sides;
            let mut flatness = cell.flatness_mm();
            let (e, f, g) = (a.norm_squared(), a.dot(&b), b.norm_squared());
            let mut det = e * g - f * f;
            // Negated: numbers that are not finite count as narrow.
            if !(det > NARROW * e * g && det.is_finite()) {
                // A line along the longer side: no point is farther from it than the shorter side is long.
                det = 0.0;
                if e >= g {
                    flatness += b.norm();
                    b = Vec3::zeros();
                } else {
                    flatness += a.norm();
                    a = Vec3::zeros();
                }
            }
            let inverse = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
            let (e, f, g) = (a.norm_squared(), a.dot(&b), b.norm_squared());
            for axis in 0..3 {
                leaf.centre[axis][k] = cell.centre[axis];
                leaf.a[axis][k] = a[axis];
                leaf.b[axis][k] = b[axis];
            }
            for (row, x) in leaf.metric.iter_mut().zip([e, f, g]) {
                row[k] = x;
            }
            for (row, x) in leaf.inverse.iter_mut().zip([e, g, det]) {
                row[k] = inverse(x);
            }
            leaf.flatness[k] = flatness;
        }
        leaf
    }

    #[inline(always)]
    fn reach<Q: Quad>(&self, q: Q, query: &[Q::V; 3]) -> Reach {
        let (a, b, c) = (load(q, &self.a), load(q, &self.b), load(q, &self.centre));
        let ([e, f, g], [ie, ig, id]) = (load(q, &self.metric), load(q, &self.inverse));
        // From the middle to the query.
        let r = [q.sub(query[0], c[0]), q.sub(query[1], c[1]), q.sub(query[2], c[2])];
        let (ra, rb) = (dot(q, &r, &a), dot(q, &r, &b));
        let s1 = clamp(q, q.mul(q.sub(q.mul(g, ra), q.mul(f, rb)), id));
        let t2 = clamp(q, q.mul(q.sub(q.mul(e, rb), q.mul(f, ra)), id));
        let t1 = clamp(q, q.mul(q.sub(rb, q.mul(f, s1)), ig));
        let s2 = clamp(q, q.mul(q.sub(ra, q.mul(f, t2)), ie));
        let (d1, d2) = (square(q, &r, &a, &b, [s1, t1]), square(q, &r, &a, &b, [s2, t2]));
        let distance = q.sqrt(q.min(d1, d2));
        let flatness = q.load(&self.flatness);
        Reach {
            least: q.array(q.sub(distance, flatness)),
            distance: q.array(distance),
            most: q.array(q.add(distance, flatness)),
            s: q.array(q.less(d1, d2, s1, s2)),
            t: q.array(q.less(d1, d2, t1, t2)),
        }
    }
}

// Functions where closures would read better: only these are made part of the caller always, without which the
// registers would travel through memory.

#[inline(always)]
fn load<Q: Quad>(q: Q, rows: &[Row; 3]) -> [Q::V; 3] {
    [q.load(&rows[0]), q.load(&rows[1]), q.load(&rows[2])]
}

#[inline(always)]
fn dot<Q: Quad>(q: Q, a: &[Q::V; 3], b: &[Q::V; 3]) -> Q::V {
    q.add(q.add(q.mul(a[0], b[0]), q.mul(a[1], b[1])), q.mul(a[2], b[2]))
}

/// Into `[-1, 1]`.
#[inline(always)]
fn clamp<Q: Quad>(q: Q, x: Q::V) -> Q::V {
    q.max(q.min(x, q.splat(1.0)), q.splat(-1.0))
}

/// `|r - a s - b t|^2`
#[inline(always)]
fn square<Q: Quad>(q: Q, r: &[Q::V; 3], a: &[Q::V; 3], b: &[Q::V; 3], [s, t]: [Q::V; 2]) -> Q::V {
    let x = [
        q.sub(q.sub(r[0], q.mul(a[0], s)), q.mul(b[0], t)),
        q.sub(q.sub(r[1], q.mul(a[1], s)), q.mul(b[1], t)),
        q.sub(q.sub(r[2], q.mul(a[2], s)), q.mul(b[2], t)),
    ];
    dot(q, &x, &x)
}

/// Square of how far x is outside an interval.
#[inline(always)]
fn outside<Q: Quad>(q: Q, x: Q::V, min: &Row, max: &Row) -> Q::V {
    let out = q.max(q.max(q.sub(q.load(min), x), q.sub(x, q.load(max))), q.splat(0.0));
    q.mul(out, out)
}

/// [`Tree::look`] over the processor's widest registers.
struct Look<'a> {
    tree: &'a Tree,
    query: &'a Point3,
}

impl quad::Over for Look<'_> {
    type Output = Seen;

    #[inline(always)]
    fn run<Q: Quad>(self, q: Q) -> Seen {
        let Self { tree, query } = self;
        let near = [q.splat(query.x), q.splat(query.y), q.splat(query.z)];
        let mut candidates = Vec::with_capacity(32);
        let mut start = (f64::INFINITY, 0, [0.0; 2]);
        let (mut upper, mut square_limit) = (f64::INFINITY, f64::INFINITY);
        let mut waiting = [(0.0, 0u32); MAX_WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (square, at) = waiting[count];
            if square > square_limit || at == NONE {
                continue;
            }
            if at & LEAF != 0 {
                let leaf = at & !LEAF;
                let reach = tree.leaves[leaf as usize].reach(q, &near);
                // Comparisons by hand: a NaN counts as no bound, and is kept.
                for most in reach.most {
                    upper = if most < upper { most } else { upper };
                }
                square_limit = upper * upper;
                for k in 0..WIDTH {
                    let least_mm = reach.least[k];
                    if least_mm <= upper || least_mm.is_nan() {
                        let cell = (WIDTH as u32 * leaf + k as u32).min(tree.cells - 1);
                        candidates.push(Candidate { least_mm, cell });
                        if reach.distance[k] < start.0 {
                            start = (reach.distance[k], cell, [reach.s[k], reach.t[k]]);
                        }
                    }
                }
                continue;
            }
            let node = &tree.nodes[at as usize];
            let squares = node.squares(q, &near);
            // The nearest last, so that it comes first; what is too far is overwritten, without a branch.
            let nearer = |a: usize, b: usize| if squares[b] < squares[a] { b } else { a };
            let first = nearer(nearer(0, 1), nearer(2, 3));
            for (k, (square, child)) in squares.into_iter().zip(node.child).enumerate() {
                waiting[count] = (square, child);
                count += usize::from(square <= square_limit && k != first);
            }
            waiting[count] = (squares[first], node.child[first]);
            count += usize::from(squares[first] <= square_limit);
        }
        let start = if start.0 < f64::INFINITY {
            Some((start.1, start.2))
        } else {
            candidates.first().map(|c: &Candidate| (c.cell, [0.0; 2]))
        };
        Seen { candidates, start }
    }
}

/// The place of a cell that is nearest by its second-order polynomial: a step of Newton's from `place`.
///
/// Not clamped to the cell, as the nearest point may lie in the next one, but kept near it.
pub(super) fn sharpened(cell: &Cell, query: &Point3, place @ [s, t]: [f64; 2]) -> [f64; 2] {
    const BEYOND: f64 = 1.25;
    let ([a, b], [ss, st, tt]) = (&cell.sides, &cell.bends);
    let (along, across): (Vector3<f64>, Vector3<f64>) = (ss * s + st * t, st * s + tt * t);
    let r = (cell.centre - query) + (a + along * 0.5) * s + (b + across * 0.5) * t;
    let (ps, pt) = (a + along, b + across);
    let (g, h) = (r.dot(&ps), r.dot(&pt));
    let (e, f, c) = (ps.dot(&ps) + r.dot(ss), ps.dot(&pt) + r.dot(st), pt.dot(&pt) + r.dot(tt));
    let det = e * c - f * f;
    if e > 0.0 && det > NARROW * e * c {
        let k = 1.0 / det;
        let near = |x: f64| x.clamp(-BEYOND, BEYOND);
        [near(s - (g * c - h * f) * k), near(t - (h * e - g * f) * k)]
    } else {
        place
    }
}
