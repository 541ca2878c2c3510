//! Seeds along the silhouettes of a face, where it stands upright: a tool that comes down beside it rests on what reaches out furthest, or passes
//! it by.

use super::frame::Frame;
use super::height::{Seed, way};
use osculate_geom::{Axis, Surface, Uv, Vec3, uv};
use rayon::prelude::*;

/// Cells of the first lattice are this many distances of seeds wide: the two sides of a thin edge differ however wide they are.
const WIDE: f64 = 2.0;
/// Cells of the first lattice along one parameter, at most.
const MOST_LATTICE: f64 = 600.0;
/// Halvings of a cell: from twice the distance of seeds to a thirtieth of it.
const HALVINGS: u32 = 6;
/// Up to this cosine between normal and axis a face does not look up: a wall has no silhouette wherever rounding turns it to and fro.
const WALL: f64 = 1e-6;
/// Steps towards the place of a cell's side where a face stands upright. How far the face reaches out there changes with the square of what is left.
const STEPS: u32 = 16;
/// Cells that are halved together, at most: a face that stands upright in more of them is noise all over, and is looked at no closer.
const MOST_CELLS: usize = 50_000;

/// A corner of cells.
#[derive(Clone, Copy)]
struct Node {
    uv: Uv,
    at: [f64; 3],
    /// None where the face has no tangent plane.
    normal: Option<Vec3>,
    /// By how much the cosine between normal and tool axis is above that of a wall; not a number where there is no normal.
    up: f64,
}

/// How far apart seeds may stand.
#[derive(Clone, Copy)]
pub(super) struct Spacing {
    /// All over the face, mm.
    pub over_mm: f64,
    /// Along a silhouette, mm.
    pub along_mm: f64,
    /// A silhouette strays from the chords between them by this much, mm.
    pub off_mm: f64,
    /// Where it bends they are no closer than this, mm.
    pub least_mm: f64,
}

/// Corners of a cell: first along u, then along v.
type Cell = [Node; 4];

/// Whether a silhouette goes through.
fn is_upright(cell: &Cell) -> bool {
    cell.iter().any(|n| n.up > 0.0) && cell.iter().any(|n| n.up <= 0.0)
}

/// Its longer diagonal, mm, and the largest turn between normals at its corners, rad; that to leading order.
fn sizes(cell: &Cell) -> [f64; 2] {
    let pairs = (0..4).flat_map(|a| (a + 1..4).map(move |b| (&cell[a], &cell[b])));
    let turn = pairs.filter_map(|(a, b)| Some((a.normal? - b.normal?).norm())).fold(0.0, f64::max);
    let apart = |a: usize, b: usize| (Vec3::from(cell[b].at) - Vec3::from(cell[a].at)).norm();
    [apart(0, 3).max(apart(1, 2)), turn]
}

/// The longest of three lines across a face along a parameter, mm, by chords.
pub(super) fn long_mm(surface: &dyn Surface, axis: Axis) -> f64 {
    let domain = surface.domain();
    let place = |f: f64, g: f64| {
        surface.point(Uv::from_axis(axis, domain.get(axis).at(f), domain.get(axis.other()).at(g)))
    };
    let chord = |k: u32, g: f64| {
        let [a, b] = [k, k + 1].map(|k| place(f64::from(k) / 16.0, g));
        (b - a).norm()
    };
    [0.0, 0.5, 1.0].map(|g| (0..16).map(|k| chord(k, g)).sum()).into_iter().fold(0.0, f64::max)
}

/// Chains of seeds along the silhouettes of a face.
pub(super) fn silhouettes(
    (surface, face): (&dyn Surface, u32),
    frame: &Frame,
    spacing: Spacing,
) -> Vec<Seed> {
    let domain = surface.domain();
    let see = |at: Uv| {
        let jet = surface.jet2(at);
        let normal = jet.normal().ok().map(|n| n.into_inner());
        let up = normal.map_or(f64::NAN, |n| frame.along(&n)[2] - WALL);
        Node { uv: at, at: frame.of(&jet.point), normal, up }
    };
    let place = |u: f64, v: f64| uv(domain.u.at(u), domain.v.at(v));
    let count = |axis: Axis| {
        (long_mm(surface, axis) / (WIDE * spacing.over_mm)).ceil().clamp(1.0, MOST_LATTICE) as usize
    };
    let n = [Axis::U, Axis::V].map(count);
    let rows: Vec<Vec<Node>> = (0..=n[1])
        .into_par_iter()
        .map(|j| (0..=n[0]).map(|i| see(place(i as f64 / n[0] as f64, j as f64 / n[1] as f64))).collect())
        .collect();
    let of_two = |w: &[Vec<Node>]| -> Vec<Cell> {
        let pairs = w[0].windows(2).zip(w[1].windows(2));
        pairs.map(|(a, b)| [a[0], a[1], b[0], b[1]]).filter(is_upright).collect()
    };
    let mut cells: Vec<Cell> = rows.windows(2).flat_map(of_two).collect();
    let is_fine = |c: &Cell| {
        let [wide, turn] = sizes(c);
        let is_straight = wide <= spacing.along_mm && wide * turn <= 8.0 * spacing.off_mm;
        is_straight || wide <= spacing.least_mm
    };
    let mut fine: Vec<Cell> = Vec::new();
    for _ in 0..HALVINGS {
        if cells.len() > MOST_CELLS {
            break;
        }
        let (done, open): (Vec<Cell>, Vec<Cell>) = cells.into_iter().partition(&is_fine);
        fine.extend(done);
        let quarters: Vec<[Cell; 4]> = open.par_iter().map(|c| quarters(c, &see)).collect();
        cells = quarters.into_iter().flatten().filter(is_upright).collect();
    }
    fine.extend(cells);
    let chains: Vec<Option<Seed>> = fine
        .par_iter()
        .map(|c| {
            let sides = [(0, 1), (1, 3), (3, 2), (2, 0)];
            let mut ends = sides.iter().filter_map(|(a, b)| upright([&c[*a], &c[*b]], &see));
            let (from, to) = (ends.next()?, ends.next()?);
            let inside = surface.contains(from.uv) && surface.contains(to.uv);
            let [from, to] = [from, to].map(|n| Seed { at: n.at, uv: n.uv, face, along: [0.0; 3] });
            inside.then(|| Seed { along: way(&from, &to), ..from })
        })
        .collect();
    chains.into_iter().flatten().collect()
}

/// The four cells that a cell is halved into along both parameters.
fn quarters([a, b, c, d]: &Cell, see: &impl Fn(Uv) -> Node) -> [Cell; 4] {
    let middle = |p: &Node, q: &Node| see(uv(0.5 * (p.uv.u + q.uv.u), 0.5 * (p.uv.v + q.uv.v)));
    let [ab, ac, ad, bd, cd] = [middle(a, b), middle(a, c), middle(a, d), middle(b, d), middle(c, d)];
    [[*a, ab, ac, ad], [ab, *b, ad, bd], [ac, ad, *c, cd], [ad, bd, cd, *d]]
}

/// The place between two where the face stands upright; None where both face the same way.
fn upright(ends: [&Node; 2], see: &impl Fn(Uv) -> Node) -> Option<Node> {
    let [mut a, mut b] = ends.map(|n| *n);
    if (a.up > 0.0) == (b.up > 0.0) || !(a.up * b.up).is_finite() {
        return None;
    }
    let (mut fa, mut fb) = (a.up, b.up);
    for _ in 0..STEPS {
        // By the secant; an end that stays twice counts half, and then the other one moves (Illinois).
        let t = (fa / (fa - fb)).clamp(0.01, 0.99);
        let at = see(uv(a.uv.u + t * (b.uv.u - a.uv.u), a.uv.v + t * (b.uv.v - a.uv.v)));
        if at.up == 0.0 || at.up.is_nan() {
            return at.normal.map(|_| at);
        }
        if at.up * fb < 0.0 {
            (a, fa) = (b, fb);
        } else {
            fa *= 0.5;
        }
        (b, fb) = (at, at.up);
    }
    Some(if fa.abs() < fb.abs() { a } else { b })
}
