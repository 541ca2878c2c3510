//! The nearest point of a trimmed face: inside its loops, on their sides or at their vertices.
//!
//! The carrier's nearest point is the face's where it lies inside the loops. Else the face's is a lesser minimum
//! inside, or on the boundary. The boundary is cut into short pieces, straight in the parameters, with a length
//! l in space; by the triangle inequality no point of a piece with ends at distances a and b is nearer than
//!
//! ```text
//! (a + b - l) / 2
//! ```
//!
//! so that only pieces that may hold the nearest point are followed down. Likewise for cells of a grid over the
//! rectangle, with their radius in space.

use super::closest;
use super::descent::{Of, descend};
use super::foot::{ClosestError, Foot, FootKind, PERPENDICULAR, finish, finite};
use crate::nurbs::NurbsSurface;
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Axis, Point3, Surface, Uv, uv};
use rayon::prelude::*;

/// Pieces of the boundary between neighbouring lines between spans, and cells of a span in either direction.
const PARTS: usize = 4;

/// Lengths and radii come from chords; they are enlarged by this for what bends between.
const SLACK: f64 = 1.25;

/// Cells followed down for one query, at most.
const MAX_DESCENTS: usize = 32;

/// Halvings of a piece of the boundary: down to rounding.
const MAX_STEPS: usize = 60;

/// A vertex holds a foot when the sine of the offset's lean against both sides is above this.
const LEAN: f64 = 1e-9;

/// A piece of the boundary.
#[derive(Clone, Copy, Debug)]
struct Side {
    ends: [Uv; 2],
    points: [Point3; 2],
    length_mm: f64,
    /// The piece before it in its loop, and the one after it.
    next_to: [usize; 2],
}

/// A cell of the grid.
#[derive(Clone, Copy, Debug)]
struct Patch {
    middle: Uv,
    centre: Point3,
    radius_mm: f64,
}

/// What the search for nearest points of one trimmed face needs. A query costs a pass over the boundary's pieces
/// and, where the carrier's nearest point is cut away, over the cells.
///
/// ```
/// use osculate_geom::{Domain, Interval, Point3, Side, analytic::Plane, uv};
/// use osculate_surfaces::{FaceSearch, FootKind, TrimmedSurface};
/// use std::sync::Arc;
/// // A plate with a square hole: over the hole the nearest place is the hole's side.
/// let side = Interval::new(0.0, 40.0);
/// let square = |lo: f64, hi: f64| vec![uv(lo, lo), uv(hi, lo), uv(hi, hi), uv(lo, hi)];
/// let plane = Arc::new(Plane::new(Domain { u: side, v: side }));
/// let plate = TrimmedSurface::new(plane, &[square(0.0, 40.0), square(10.0, 30.0)], Side::Along)?;
/// let foot = FaceSearch::new(&plate, None).closest(&Point3::new(13.0, 20.0, 4.0), None)?;
/// assert!((foot.distance_mm - 5.0).abs() < 1e-9 && foot.kind == FootKind::Edge);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FaceSearch<'a> {
    face: &'a TrimmedSurface,
    carrier: Option<&'a NurbsSurface>,
    sides: Vec<Side>,
    patches: Vec<Patch>,
}

/// A place on the boundary.
struct OnSide {
    side: usize,
    place: f64,
    square: f64,
}

impl<'a> FaceSearch<'a> {
    /// Prepares the search. `carrier` is the NURBS surface under the face, with the face's own parameters, where
    /// there is one: with it answers carry a proven [`Foot::gap_mm`].
    #[must_use]
    pub fn new(face: &'a TrimmedSurface, carrier: Option<&'a NurbsSurface>) -> Self {
        let breaks = [face.breaks(Axis::U), face.breaks(Axis::V)];
        let mut sides = Vec::new();
        for l in face.loops() {
            let (n, first) = (l.points.len(), sides.len());
            for k in 0..n {
                add_sides(face, &breaks, [l.points[k], l.points[(k + 1) % n]], &mut sides);
            }
            let count = sides.len() - first;
            for (k, side) in sides[first..].iter_mut().enumerate() {
                side.next_to = [first + (k + count - 1) % count, first + (k + 1) % count];
            }
        }
        let lines = |b: &[f64]| -> Vec<[f64; 2]> {
            let at = |w: &[f64], j: usize| w[0] + (w[1] - w[0]) * j as f64 / PARTS as f64;
            b.windows(2).flat_map(|w| (0..PARTS).map(move |j| [at(w, j), at(w, j + 1)])).collect()
        };
        let mut patches = Vec::new();
        for u in lines(&breaks[0]) {
            for v in lines(&breaks[1]) {
                let middle = uv(0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
                let centre = face.point(middle);
                let corners = [uv(u[0], v[0]), uv(u[1], v[0]), uv(u[0], v[1]), uv(u[1], v[1])];
                let far = corners.iter().map(|c| (face.point(*c) - centre).norm()).fold(0.0, f64::max);
                patches.push(Patch { middle, centre, radius_mm: SLACK * far });
            }
        }
        Self { face, carrier, sides, patches }
    }

    /// The nearest point of the face: of all of it without a hint, of the neighbourhood of the hint with one.
    ///
    /// On the boundary the foot is a [`FootKind::Edge`], or a [`FootKind::Corner`] where it is held by a vertex of
    /// the loops' polygons from both sides; [`Foot::residual`] is taken against the boundary's direction there.
    /// Without a hint and with a NURBS carrier [`Foot::gap_mm`] is the distance less the carrier's own: the face
    /// has nothing nearer than that. Otherwise it is the distance.
    ///
    /// # Errors
    /// As [`closest`] and [`super::closest_near`].
    pub fn closest(&self, query: &Point3, hint: Option<Uv>) -> Result<Foot, ClosestError> {
        if !finite(query, hint.unwrap_or(uv(0.0, 0.0))) {
            return Err(ClosestError::NotFinite { query: *query });
        }
        if let Some(hint) = hint {
            let inside = self.inside(query, hint, f64::INFINITY);
            return inside.map_or_else(|| self.follow_side(query, hint), Ok);
        }
        let mut least_mm = 0.0;
        if let Some(carrier) = self.carrier {
            let foot = closest(carrier, query, None)?;
            if self.face.contains(foot.uv) {
                return Ok(Foot { uv: self.face.domain().bring(foot.uv), ..foot });
            }
            least_mm = foot.distance_mm - foot.gap_mm;
        }
        let mut best = self.nearest_side(query)?;
        let mut near: Vec<(f64, &Patch)> = self
            .patches
            .iter()
            .map(|p| ((p.centre - query).norm() - p.radius_mm, p))
            .filter(|(least, _)| *least < best.distance_mm)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (least, patch) in near.into_iter().take(MAX_DESCENTS) {
            if least >= best.distance_mm {
                break;
            }
            if let Some(foot) = self.inside(query, patch.middle, best.distance_mm) {
                best = foot;
            }
        }
        Ok(Foot { gap_mm: (best.distance_mm - least_mm).max(0.0), ..best })
    }

    /// [`FaceSearch::closest`] for many queries on all threads, in their order. Of hints that are fewer than the
    /// queries the rest go without.
    #[must_use]
    pub fn closest_batch(&self, queries: &[Point3], hints: Option<&[Uv]>) -> Vec<Result<Foot, ClosestError>> {
        let hint = |k: usize| hints.and_then(|h| h.get(k).copied());
        queries.par_iter().with_min_len(32).enumerate().map(|(k, q)| self.closest(q, hint(k))).collect()
    }

    /// The foot below a start, where it lies inside the loops and nearer than `limit_mm`.
    fn inside(&self, query: &Point3, start: Uv, limit_mm: f64) -> Option<Foot> {
        let domain = self.face.domain();
        let found = descend(&Of(self.face), &domain, query, start);
        // Negated: a NaN is not nearer.
        if !(found.distance_mm < limit_mm && self.face.contains(found.uv)) {
            return None;
        }
        finish(&found, &domain, found.distance_mm).ok()
    }

    /// The nearest point of the whole boundary.
    fn nearest_side(&self, query: &Point3) -> Result<Foot, ClosestError> {
        let distance = |p: &Point3| (p - query).norm();
        let mut upper = self.sides.iter().map(|s| distance(&s.points[0])).fold(f64::INFINITY, f64::min);
        let mut best: Option<OnSide> = None;
        for (side, s) in self.sides.iter().enumerate() {
            let least = 0.5 * (distance(&s.points[0]) + distance(&s.points[1]) - s.length_mm);
            if least > upper {
                continue;
            }
            let found = self.down_side(query, side);
            upper = upper.min(found.square.sqrt());
            if best.as_ref().is_none_or(|b| found.square < b.square) {
                best = Some(found);
            }
        }
        best.map_or(Err(ClosestError::NotFinite { query: *query }), |b| self.foot_on(query, &b))
    }

    /// The boundary's foot from the piece nearest to the hint, on along the loop while the distance falls.
    fn follow_side(&self, query: &Point3, hint: Uv) -> Result<Foot, ClosestError> {
        let from = self.face.point(self.face.domain().bring(hint));
        let off = |s: &Side| (s.points[0] - from).norm() + (s.points[1] - from).norm() - s.length_mm;
        let start = (0..self.sides.len())
            .min_by(|a, b| off(&self.sides[*a]).total_cmp(&off(&self.sides[*b])))
            .ok_or(ClosestError::NotFinite { query: *query })?;
        let mut here = self.down_side(query, start);
        for _ in 0..self.sides.len() {
            let ends = self.sides[here.side].next_to;
            let next = ends.map(|side| self.down_side(query, side));
            let Some(better) = next.into_iter().min_by(|a, b| a.square.total_cmp(&b.square)) else { break };
            if better.square >= here.square || better.square.is_nan() {
                break;
            }
            here = better;
        }
        self.foot_on(query, &here)
    }

    fn at(&self, side: usize, place: f64) -> Uv {
        let [a, b] = self.sides[side].ends;
        match place {
            0.0 => a,
            1.0 => b,
            t => uv(a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)),
        }
    }

    /// Half the derivative of the squared distance along a piece, its own derivative, and the squares of the
    /// distance and of the piece's tangent.
    fn slope(&self, query: &Point3, side: usize, place: f64) -> [f64; 4] {
        let [a, b] = self.sides[side].ends;
        let (s, t) = (b.u - a.u, b.v - a.v);
        let jet = self.face.jet2(self.at(side, place));
        let r = jet.point - query;
        let tangent = jet.du * s + jet.dv * t;
        let bend = jet.duu * (s * s) + jet.duv * (2.0 * s * t) + jet.dvv * (t * t);
        let square = tangent.norm_squared();
        [r.dot(&tangent), square + r.dot(&bend), r.norm_squared(), square]
    }

    /// The nearest point of one piece: Newton's method inside a bracket that halves where it fails.
    fn down_side(&self, query: &Point3, side: usize) -> OnSide {
        let ends = [0.0, 1.0].map(|t| (t, self.slope(query, side, t)));
        let (mut lo, mut hi) = (0.0, 1.0);
        let nearer = if ends[0].1[2] <= ends[1].1[2] { &ends[0] } else { &ends[1] };
        let mut best = OnSide { side, place: nearer.0, square: nearer.1[2] };
        if !(ends[0].1[0] < 0.0 && ends[1].1[0] > 0.0) {
            // It falls towards an end all the way.
            return best;
        }
        let mut place = 0.5;
        for _ in 0..MAX_STEPS {
            let [g, h, square, _] = self.slope(query, side, place);
            if square < best.square {
                best = OnSide { side, place, square };
            }
            if g > 0.0 {
                hi = place;
            } else {
                lo = place;
            }
            let newton = place - g / h;
            let next = if h > 0.0 && newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
            if (next - place).abs() <= f64::EPSILON {
                break;
            }
            place = next;
        }
        // Near the foot the squares are equal to rounding; the slope knows better.
        let [_, _, square, _] = self.slope(query, side, place);
        if square <= best.square * (1.0 + 8.0 * f64::EPSILON) {
            best = OnSide { side, place, square };
        }
        best
    }

    fn foot_on(&self, query: &Point3, on: &OnSide) -> Result<Foot, ClosestError> {
        let at = self.at(on.side, on.place);
        let point = self.face.point(at);
        let distance_mm = (point - query).norm();
        // Lean against the boundary's direction, positive where the distance grows along it.
        let size = point.coords.norm() + query.coords.norm();
        let lean = |side: usize, place: f64| {
            let [g, _, _, square] = self.slope(query, side, place);
            let noise = 8.0 * f64::EPSILON * size;
            let along = if square > 0.0 { g / square.sqrt() } else { 0.0 };
            if along.abs() <= noise || distance_mm <= noise { 0.0 } else { along / distance_mm }
        };
        let here = lean(on.side, on.place);
        let [before, after] = self.sides[on.side].next_to;
        // At an end the distance must grow on both sides of it.
        let other = match on.place {
            0.0 => Some([-lean(before, 1.0), here]),
            1.0 => Some([-here, lean(after, 0.0)]),
            _ => None,
        };
        let (kind, residual) = match other {
            Some([back, on]) => {
                let corner = back > LEAN && on > LEAN;
                (if corner { FootKind::Corner } else { FootKind::Edge }, (-back).max(-on).max(0.0))
            }
            None => (FootKind::Edge, here.abs()),
        };
        if residual > PERPENDICULAR || residual.is_nan() {
            return Err(ClosestError::NotConverged { at, distance_mm, residual, steps: MAX_STEPS as u32 });
        }
        Ok(Foot { uv: at, point, distance_mm, residual, kind, gap_mm: distance_mm })
    }
}

/// The pieces of one side of a loop.
fn add_sides(face: &TrimmedSurface, breaks: &[Vec<f64>; 2], [a, b]: [Uv; 2], out: &mut Vec<Side>) {
    let crossed = |axis: Axis| {
        let (lo, hi) = (a.get(axis).min(b.get(axis)), a.get(axis).max(b.get(axis)));
        breaks[axis as usize].iter().filter(|t| **t > lo && **t < hi).count()
    };
    // The short sides of a fine polygon need no cutting.
    let domain = face.domain();
    let share = ((b.u - a.u) / domain.u.length()).abs().max(((b.v - a.v) / domain.v.length()).abs());
    let fine = share < 0.01;
    let parts = if fine { 1 } else { PARTS * (1 + crossed(Axis::U) + crossed(Axis::V)) };
    let at = |t: f64| {
        if t == 1.0 { b } else { uv(a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)) }
    };
    for k in 0..parts {
        let [s, t] = [k, k + 1].map(|k| k as f64 / parts as f64);
        let ends = [at(s), at(t)];
        let (points, middle) = (ends.map(|e| face.point(e)), face.point(at(0.5 * (s + t))));
        let length = (middle - points[0]).norm() + (middle - points[1]).norm();
        out.push(Side { ends, points, length_mm: SLACK * length, next_to: [0, 0] });
    }
}
