//! The certified search for the nearest point of a NURBS surface.
//!
//! The tree gives the cells whose lower bound is below the best upper bound. The nearest of them starts a
//! descent over the whole surface; after it a cell is done with when one of these is shown:
//!
//! 1. its lower bound is not below the best distance;
//! 2. the quadratic Taylor polynomial of the squared distance, less a bound of its remainder, is not below
//!    it;
//! 3. the squared distance is convex over it, or over the side to which it falls all over the cell, and the
//!    tangent plane of that function at some place, or a descent in the cell, shows that it has nothing
//!    nearer;
//! 4. else it is halved, until the work allowed is spent; then the least lower bound left is reported as the
//!    gap.

use super::cell::Cell;
use super::descent::Found;
use super::foot::{ClosestError, Foot, FootKind, PERPENDICULAR, finish};
use super::tree::{Seen, sharpened};
use super::way::descend_surface;
use crate::nurbs::NurbsSurface;
use osculate_geom::solve::definite;
use osculate_geom::{Axis, Domain, Interval, Jet2, Point3, Surface, Uv};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Cells looked at after the tree, at most: some milliseconds. Ordinary queries need fewer than twenty.
const MAX_CELLS: u32 = 20_000;

/// Lower bounds within this fraction of the best distance are not followed up: it is the accuracy of a
/// distance.
const SAME_DISTANCE: f64 = 1e-12;

/// A cell to look at.
#[derive(Clone, Copy, Debug)]
struct Task {
    /// No point of the cell is nearer, mm.
    least_mm: f64,
    cell: Cell,
    /// Order of arrival, so that equal bounds are worked on in one order on every machine.
    number: u32,
}

impl Ord for Task {
    fn cmp(&self, other: &Self) -> Ordering {
        // The heap gives the greatest first: the least bound, then the earliest.
        other.least_mm.total_cmp(&self.least_mm).then(other.number.cmp(&self.number))
    }
}
impl PartialOrd for Task {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for Task {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Task {}

/// The nearest point of the whole surface.
pub(super) fn search(surface: &NurbsSurface, query: &Point3) -> Result<Foot, ClosestError> {
    let index = surface.index();
    let Seen { mut candidates, start } = index.tree.look(query);
    // The start is on the nearest parallelogram, not in the cell of the least bound, which favours large ones.
    let Some((k, place)) = start else { return Err(ClosestError::NotFinite { query: *query }) };
    let cell = &index.cells[k as usize];
    let start = cell.at(sharpened(cell, query, place));
    let domain = surface.domain();
    let mut best = Best { found: descend_surface(surface, None, &domain, query, start), cell: None };
    // Few of them are left once a foot is known.
    let reached = best.found.distance_mm * (1.0 - SAME_DISTANCE);
    candidates.retain(|c| c.least_mm < reached || c.least_mm.is_nan());
    candidates.sort_unstable_by(|a, b| a.least_mm.total_cmp(&b.least_mm).then(a.cell.cmp(&b.cell)));

    let mut gap_mm = 0.0;
    let mut tasks: BinaryHeap<Task> = BinaryHeap::new();
    let mut number = 0;
    let mut next = candidates.iter();
    let mut pending = next.next();
    loop {
        // Candidates and tasks are both in the order of their bounds.
        let from_list = match (pending, tasks.peek()) {
            (Some(c), Some(t)) => c.least_mm <= t.least_mm,
            (Some(_), None) => true,
            (None, Some(_)) => false,
            (None, None) => break,
        };
        let (least_mm, cell) = if from_list {
            let c = pending.expect("looked at above");
            pending = next.next();
            (c.least_mm, index.cells[c.cell as usize])
        } else {
            let t = tasks.pop().expect("looked at above");
            (t.least_mm, t.cell)
        };
        if least_mm >= best.found.distance_mm * (1.0 - SAME_DISTANCE) {
            break;
        }
        if number >= MAX_CELLS {
            gap_mm = best.found.distance_mm - least_mm.max(0.0);
            break;
        }
        let model = Model::new(&cell, query);
        if model.least_mm() >= best.found.distance_mm * (1.0 - SAME_DISTANCE) {
            continue;
        }
        let mut rect = cell.rect(surface);
        if model.cut_to_least(&mut rect) {
            let at = rect.bring(best.found.uv);
            // Of the foot itself nothing is left to compute, unless it is on a line to the next piece.
            let known = strictly_inside(&rect, best.found.uv);
            let tangent =
                if known { Tangent::at(&best.found) } else { Tangent::of(&cell.jet(surface, at), query) };
            if !tangent.cannot_beat(&rect, best.found.distance_mm) {
                best.offer(descend_surface(surface, Some(cell.spans()), &rect, query, at), &cell);
            }
            continue;
        }
        if 2.0 * model.value < best.found.distance_mm * best.found.distance_mm {
            best.offer(descend_surface(surface, Some(cell.spans()), &rect, query, cell.middle), &cell);
        }
        for half in cell.halves(surface, cell.bent_axis()) {
            number += 1;
            let least = half.least_mm(query);
            if least < best.found.distance_mm * (1.0 - SAME_DISTANCE) {
                tasks.push(Task { least_mm: least.max(least_mm), cell: half, number });
            }
        }
    }
    best.foot(surface, &domain, query, gap_mm)
}

/// The nearest point so far, and the cell in which it was found where that was not the whole surface.
struct Best {
    found: Found,
    cell: Option<Cell>,
}

impl Best {
    fn offer(&mut self, found: Found, cell: &Cell) {
        if found.distance_mm < self.found.distance_mm {
            *self = Self { found, cell: Some(*cell) };
        }
    }

    /// The foot. A point found in a cell is followed over the whole surface first, in case it stopped at the
    /// cell's side.
    fn foot(
        self,
        surface: &NurbsSurface,
        domain: &Domain,
        query: &Point3,
        gap_mm: f64,
    ) -> Result<Foot, ClosestError> {
        let Some(cell) = self.cell else {
            if self.found.residual <= PERPENDICULAR {
                return finish(&self.found, domain, gap_mm);
            }
            return self.on_crease(surface, domain, query, gap_mm);
        };
        let free = descend_surface(surface, None, domain, query, self.found.uv);
        if free.residual <= PERPENDICULAR && free.distance_mm <= self.found.distance_mm {
            return finish(&free, domain, gap_mm);
        }
        Self { found: self.found, cell: Some(cell) }.on_crease(surface, domain, query, gap_mm)
    }

    /// The foot where the distance does not fall on either side of a line between pieces.
    ///
    /// The offset is perpendicular to the surface on no side, but each side alone holds the parameter at its
    /// end.
    fn on_crease(
        self,
        surface: &NurbsSurface,
        domain: &Domain,
        query: &Point3,
        gap_mm: f64,
    ) -> Result<Foot, ClosestError> {
        let at = self.found.uv;
        for span in spans_around(surface, at) {
            let piece = |axis: Axis| {
                let ends = &surface.knots(axis).breaks()[span[axis as usize]..][..2];
                Interval::new(ends[0], ends[1])
            };
            let rect = Domain { u: piece(Axis::U), v: piece(Axis::V) };
            let found = descend_surface(surface, Some(span), &rect, query, at);
            let near = found.distance_mm <= self.found.distance_mm * (1.0 + SAME_DISTANCE);
            if near && found.residual <= PERPENDICULAR {
                let mut foot = finish(&found, domain, gap_mm)?;
                let stands = |i: Interval, t: f64| t <= i.lo || t >= i.hi;
                let at_side = stands(rect.u, found.uv.u) || stands(rect.v, found.uv.v);
                if foot.kind == FootKind::Interior && at_side {
                    foot.kind = FootKind::Crease;
                }
                return Ok(foot);
            }
        }
        finish(&self.found, domain, gap_mm)
    }
}

/// The pieces that meet at a place: one, two on a line between pieces, four where lines cross.
fn spans_around(surface: &NurbsSurface, at: Uv) -> Vec<[usize; 2]> {
    let on = |axis: Axis| {
        let knots = surface.knots(axis);
        let (t, breaks) = (at.get(axis), knots.breaks());
        // As far from the line as rounding of the parameter may have put the place.
        let slack = 1e-12 * (breaks[breaks.len() - 1] - breaks[0]);
        (0..knots.span_count())
            .filter(|k| t >= breaks[*k] - slack && t <= breaks[*k + 1] + slack)
            .collect::<Vec<_>>()
    };
    let (us, vs) = (on(Axis::U), on(Axis::V));
    us.iter().flat_map(|u| vs.iter().map(move |v| [*u, *v])).collect()
}

/// Taylor's polynomial of `f = |S - q|^2 / 2` about the middle of a cell, by s and t in `[-1, 1]`, with a
/// bound of how much its second derivatives change over the cell.
struct Model {
    value: f64,
    gradient: [f64; 2],
    /// By ss, st and tt.
    second: [f64; 3],
    /// The most that each may differ from that in the cell.
    change: [f64; 3],
}

impl Model {
    fn new(cell: &Cell, query: &Point3) -> Self {
        let ([a, b], [ss, st, tt]) = (&cell.sides, &cell.bends);
        let r = cell.centre - query;
        // Changes of the first derivatives, the second ones and the offset. All shrink at least in proportion
        // on the way to the middle.
        let ([m0, m1, m2], [t0, t1, t2, t3]) = (cell.bounds.second, cell.bounds.third);
        let (da, db) = (m0 + m1, m1 + m2);
        let (dss, dst, dtt) = (t0 + t1, t1 + t2, t2 + t3);
        let (la, lb, lr, dr) = (a.norm(), b.norm(), r.norm(), cell.radius_mm());
        Self {
            value: 0.5 * r.norm_squared(),
            gradient: [r.dot(a), r.dot(b)],
            second: [a.dot(a) + r.dot(ss), a.dot(b) + r.dot(st), b.dot(b) + r.dot(tt)],
            change: [
                2.0 * la * da + da * da + lr * dss + dr * (ss.norm() + dss),
                la * db + lb * da + da * db + lr * dst + dr * (st.norm() + dst),
                2.0 * lb * db + db * db + lr * dtt + dr * (tt.norm() + dtt),
            ],
        }
    }

    /// Cuts the cell's rectangle to the side or corner on which the least value of f must lie, where f falls
    /// all the way to it, and says whether f is convex over what is left.
    fn cut_to_least(&self, rect: &mut Domain) -> bool {
        let (h, d) = (&self.second, &self.change);
        // A gradient changes by at most this on the way from the middle; changes that grow in proportion
        // count half.
        let turns =
            [h[0].abs() + h[1].abs() + 0.5 * (d[0] + d[1]), h[2].abs() + h[1].abs() + 0.5 * (d[2] + d[1])];
        let falls = [0, 1].map(|k| self.gradient[k].abs() > turns[k]);
        for (k, side) in [&mut rect.u, &mut rect.v].into_iter().enumerate() {
            if falls[k] {
                let end = if self.gradient[k] > 0.0 { side.lo } else { side.hi };
                *side = Interval::new(end, end);
            }
        }
        let (p, q, m) = (h[0] - d[0], h[2] - d[2], h[1].abs() + d[1]);
        match falls {
            [true, true] => true,
            [true, false] => q > 0.0,
            [false, true] => p > 0.0,
            [false, false] => p > 0.0 && q > 0.0 && p * q > m * m,
        }
    }

    /// No point of the cell is nearer: the least value of the quadratic polynomial over the cell, less the
    /// remainder. A change of the second derivatives that grows in proportion to the way counts with a sixth.
    fn least_mm(&self) -> f64 {
        let ([g, h], [a, b, c]) = (self.gradient, self.second);
        let quadratic = |s: f64, t: f64| g * s + h * t + 0.5 * (a * s * s + c * t * t) + b * s * t;
        // The least value of l x + q x^2 / 2 over [-1, 1] is at the vertex of a parabola open upwards or at
        // an end.
        let place = |l: f64, q: f64| if q > 0.0 { (-l / q).clamp(-1.0, 1.0) } else { -l.signum() };
        let mut least = f64::INFINITY;
        for end in [-1.0, 1.0] {
            least = least.min(quadratic(end, place(h + b * end, c)));
            least = least.min(quadratic(place(g + b * end, a), end));
        }
        if let Some([s, t]) = definite([a, b, c], [-g, -h], [false; 2], 0.0)
            && s.abs() <= 1.0
            && t.abs() <= 1.0
        {
            least = least.min(quadratic(s, t));
        }
        let [d0, d1, d2] = self.change;
        (2.0 * (self.value + least - (d0 + 2.0 * d1 + d2) / 6.0)).max(0.0).sqrt()
    }
}

/// Whether the parameters are inside, not on a side.
fn strictly_inside(rect: &Domain, at: Uv) -> bool {
    rect.u.lo < at.u && at.u < rect.u.hi && rect.v.lo < at.v && at.v < rect.v.hi
}

/// The tangent plane of half the squared distance at a place.
struct Tangent {
    at: Uv,
    square: f64,
    gradient: [f64; 2],
}

impl Tangent {
    fn of(jet: &Jet2, query: &Point3) -> Self {
        let r = jet.point - query;
        Self { at: jet.uv, square: r.norm_squared(), gradient: [r.dot(&jet.du), r.dot(&jet.dv)] }
    }

    fn at(found: &Found) -> Self {
        Self { at: found.uv, square: found.distance_mm * found.distance_mm, gradient: found.gradient }
    }

    /// Whether a squared distance that is convex over the rectangle stays above the best one everywhere in it:
    /// it lies above its tangent plane, whose least value is at a corner.
    fn cannot_beat(&self, rect: &Domain, best_mm: f64) -> bool {
        let fall = |g: f64, t: f64, side: &Interval| (g * (side.lo - t)).min(g * (side.hi - t));
        let fall = fall(self.gradient[0], self.at.u, &rect.u) + fall(self.gradient[1], self.at.v, &rect.v);
        self.square + 2.0 * fall >= best_mm * best_mm * (1.0 - SAME_DISTANCE)
    }
}
