//! What another body leaves of a face.

use super::border::{Border, Metric};
use super::inside::{Solid, Where, patches};
use super::pieces::{Joins, Piece, loops, pieces};
use super::seeds::{Seed, seeds};
use super::sheet::{Meet, Pair, Sheet, between};
use super::trace::{Faces, LEAST_SINE, Line, March, line};
use crate::trim::region::{Chain, Known, Region};
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Axis, Surface, Uv, uv};

/// Depth below which a place is not hidden, as a part of the smaller body: files have their edges to that.
const TOLERANCE: f64 = 1e-5;
/// Distance of the triangles from the faces, likewise: seeds of lines come from them.
const TRIANGLES: f64 = 2e-4;
/// Chord tolerance of the new loops, likewise: the area between chord and arc of a full circle is then about 2e-5 of it.
const CHORD: f64 = 1e-5;
/// Longest step of a march, likewise.
const STEP: f64 = 0.05;
/// Surfaces meet within this, likewise.
const CLOSE: f64 = 1e-10;
/// Ends of lines are one within this where nothing is nearer, likewise: faces of a body gape as much in real files.
const GAP: f64 = 5e-4;
/// Steps off a piece at which is asked what is beside it, as parts of the tolerance: the first clear answer counts.
const BESIDE: [f64; 6] = [4.0, 16.0, 64.0, 256.0, 1024.0, 2048.0];
/// Places along a piece where it is asked.
const ALONG: [f64; 7] = [0.5, 0.31, 0.69, 0.17, 0.83, 0.07, 0.93];
/// Places of a face, in either direction about, at which what is left is held against rays.
const CHECKS: usize = 20;
/// Lines between two faces at most.
const LINES: usize = 1000;

/// Lengths that belong to two bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Size of the smaller one, mm.
    pub(super) size_mm: f64,
}

impl Scale {
    fn tolerance_mm(self) -> f64 {
        TOLERANCE * self.size_mm
    }
}

/// The chord of triangles for a body of a size.
pub(super) fn triangles_mm(size_mm: f64) -> f64 {
    TRIANGLES * size_mm
}

/// What is left of a face.
pub(super) enum Left {
    /// All of it.
    All,
    /// Nothing.
    Nothing,
    /// This.
    Part(Box<TrimmedSurface>),
}

/// Why it could not be found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stuck {
    /// Number of the other face.
    pub(super) other: usize,
    pub(super) why: &'static str,
}

/// What a body leaves of a face.
pub(super) fn cut(surface: &TrimmedSurface, solid: &Solid<'_>, scale: Scale) -> Result<Left, Stuck> {
    let lines = lines(surface, solid, scale)?;
    let border = Border::new(surface, true);
    let joins = Joins { border_mm: 4.0 * scale.tolerance_mm(), gap_mm: GAP * scale.size_mm };
    let first = solid.walls.first().map_or(0, |w| w.face);
    let loose = |l: super::pieces::Loose| Stuck {
        other: l.0.unwrap_or(first),
        why: "the lines of intersection do not close on the face",
    };
    let all = pieces(surface, &border, &lines, joins).map_err(loose)?;
    let beside = Beside { surface, border: &border, solid, pieces: &all, tolerance_mm: scale.tolerance_mm() };
    let kept = even(&all, &(0..all.len()).map(|k| beside.bounds(k)).collect::<Vec<_>>());
    let changed = all.iter().zip(&kept).any(|(p, k)| p.other.is_some() == *k);
    let left = if !changed {
        Left::All
    } else if kept.contains(&true) {
        let kept: Vec<Piece> = all.into_iter().zip(kept).filter(|(_, k)| *k).map(|(p, _)| p).collect();
        let loops = loops(&kept).map_err(loose)?;
        let made = trimmed(surface, loops);
        Left::Part(Box::new(made.ok_or(Stuck { other: first, why: "what is left of the face has no area" })?))
    } else {
        Left::Nothing
    };
    match wrong(surface, solid, &left) {
        Some(other) => {
            Err(Stuck { other, why: "rays do not agree with what the lines of intersection leave" })
        }
        None => Ok(left),
    }
}

/// The lines of intersection of a face with the faces of a body.
fn lines(surface: &TrimmedSurface, solid: &Solid<'_>, scale: Scale) -> Result<Vec<Line>, Stuck> {
    let size_mm = scale.size_mm;
    let mut found = seeds(&patches(0, surface, triangles_mm(size_mm)), &solid.soup);
    // Long ones first: they are farthest from where faces end.
    found.sort_by(|a, b| a.other.cmp(&b.other).then(b.length_mm.total_cmp(&a.length_mm)));
    let march = March { chord_mm: CHORD * size_mm, step_mm: STEP * size_mm };
    let near_mm = 2.0 * scale.tolerance_mm();
    let mut out: Vec<Line> = Vec::new();
    for of in found.chunk_by(|a, b| a.other == b.other) {
        let Some(wall) = of.first().map(|s| solid.walls[s.other]) else { continue };
        let borders = [Border::new(surface, true), Border::new(wall.surface, false)];
        let pair =
            Pair { sheets: [Sheet::new(surface), Sheet::new(wall.surface)], close_mm: CLOSE * size_mm };
        let faces = Faces { pair, borders: [&borders[0], &borders[1]] };
        let mine = out.len();
        for seed in of {
            if out.len() - mine > LINES {
                return Err(Stuck { other: wall.face, why: "they meet in too many lines" });
            }
            let Some(place) = settled(&faces, seed, near_mm, size_mm) else { continue };
            if out[mine..].iter().any(|l| passes(&faces.pair.sheets[0], l, &place, 4.0 * march.chord_mm)) {
                continue;
            }
            let line = line(&faces, wall.face, place, march);
            out.push(line.map_err(|lost| Stuck { other: wall.face, why: lost.words() })?);
        }
    }
    Ok(out)
}

/// The place that a seed means, where it is on both faces and not along the border of either.
fn settled(faces: &Faces<'_, '_>, seed: &Seed, near_mm: f64, size_mm: f64) -> Option<Meet> {
    let from = faces.pair.sheets[0].at(seed.at[0]).point;
    let place = faces.pair.near(seed.at)?;
    let moved = (place.point - from).norm() <= STEP * size_mm;
    let on = |k: usize| {
        let border = faces.borders[k];
        border.holds(place.at[k]) && border.nearest(place.at[k]).is_none_or(|n| n.2 > near_mm)
    };
    (moved && on(0) && on(1) && faces.pair.along(place.at, LEAST_SINE).is_some()).then_some(place)
}

/// Whether a line passes a place, in the parameters of the face: there its chords are within the chord tolerance.
fn passes(sheet: &Sheet<'_>, line: &Line, place: &Meet, within_mm: f64) -> bool {
    let metric = Metric::new(&sheet.at(place.at[0]));
    let p = &line.places;
    let count = if line.closed { p.len() } else { p.len() - 1 };
    (0..count)
        .any(|k| metric.to_segment(place.at[0], [p[k].at[0], p[(k + 1) % p.len()].at[0]]).1 <= within_mm)
}

/// Asks what is beside pieces.
struct Beside<'a> {
    surface: &'a TrimmedSurface,
    border: &'a Border<'a>,
    solid: &'a Solid<'a>,
    pieces: &'a [Piece],
    tolerance_mm: f64,
}

/// What is beside a place of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// The face is not there.
    Off,
    /// Nothing clear before the face ends.
    Near,
    /// Nothing clear before another piece.
    Blocked,
    Hidden,
    Visible,
}

impl Side {
    fn clear(self) -> bool {
        matches!(self, Self::Hidden | Self::Visible)
    }
}

/// Whether a piece bounds what is left, by what is beside it.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    kept: bool,
    /// Whether other pieces stand too near to say it from this one alone.
    blocked: bool,
}

impl Beside<'_> {
    /// Whether a piece bounds what is left: a line between a hidden side and one that is not, border beside what is not hidden.
    fn bounds(&self, number: usize) -> Bounds {
        let piece = &self.pieces[number];
        let mut last: Option<[Side; 2]> = None;
        for way in ALONG {
            let Some((at, across, segment)) = self.place(piece, way) else { continue };
            let of = |sign: f64| self.side(at, uv(sign * across.u, sign * across.v), (number, segment));
            let sides = [of(1.0), of(-1.0)];
            if last.is_none() || !sides.contains(&Side::Blocked) {
                last = Some(sides);
            }
            let enough = if piece.other.is_some() {
                sides.iter().all(|s| s.clear())
            } else {
                sides.iter().any(|s| s.clear())
            };
            if enough {
                last = Some(sides);
                break;
            }
        }
        let Some(sides) = last else { return Bounds { kept: piece.other.is_none(), blocked: false } };
        let hidden = sides.map(|s| s == Side::Hidden);
        match piece.other {
            Some(_) => Bounds { kept: hidden[0] != hidden[1], blocked: sides.contains(&Side::Blocked) },
            None => Bounds {
                kept: !hidden.contains(&true),
                blocked: sides.contains(&Side::Blocked) && !sides.iter().any(|s| s.clear()),
            },
        }
    }

    /// A place of a piece, the direction of parameters across it with a length of about one in space, and the segment.
    fn place(&self, piece: &Piece, way: f64) -> Option<(Uv, Uv, usize)> {
        let p = &piece.points;
        let count = if piece.nodes.is_none() { p.len() } else { p.len() - 1 };
        let lengths: Vec<f64> = (0..count)
            .map(|k| {
                let (a, b) = (self.surface.point(p[k]), self.surface.point(p[(k + 1) % p.len()]));
                let middle = self.surface.point(between(p[k], p[(k + 1) % p.len()], 0.5));
                (middle - a).norm() + (b - middle).norm()
            })
            .collect();
        let whole: f64 = lengths.iter().sum();
        let mut rest = way * whole;
        let k = lengths.iter().position(|l| {
            rest -= l;
            rest <= 0.0
        });
        let k = k.unwrap_or(count - 1);
        let part = if lengths[k] > 0.0 { (1.0 + rest / lengths[k]).clamp(0.0, 1.0) } else { 0.5 };
        let (a, b) = (p[k], p[(k + 1) % p.len()]);
        let at = between(a, b, part);
        let across = uv(a.v - b.v, b.u - a.u);
        let length = across.u.hypot(across.v);
        let across = uv(across.u / length, across.v / length);
        let t = Sheet::new(self.surface).at(at);
        let speed = (t.du * across.u + t.dv * across.v).norm();
        let scaled = uv(across.u / speed, across.v / speed);
        (scaled.u.is_finite() && scaled.v.is_finite()).then_some((at, scaled, k))
    }

    /// What is beside a place on a segment of a piece.
    fn side(&self, at: Uv, across: Uv, from: (usize, usize)) -> Side {
        let mut said = Side::Off;
        for step in BESIDE {
            let h = step * self.tolerance_mm;
            let there = uv(at.u + h * across.u, at.v + h * across.v);
            if !self.border.holds(there) {
                break;
            }
            if self.crosses(at, there, from) {
                return Side::Blocked;
            }
            said = match self.solid.tell(&self.surface.point(there), self.tolerance_mm) {
                Where::Inside => return Side::Hidden,
                Where::Outside => return Side::Visible,
                Where::Near => Side::Near,
            };
        }
        said
    }

    /// Whether a step from a place on a segment of a piece meets another one.
    fn crosses(&self, from: Uv, to: Uv, own: (usize, usize)) -> bool {
        let of = |(number, piece): (usize, &Piece)| {
            let p = &piece.points;
            let count = if piece.nodes.is_none() { p.len() } else { p.len() - 1 };
            (0..count).any(|k| (number, k) != own && meet([from, to], [p[k], p[(k + 1) % p.len()]]))
        };
        self.pieces.iter().enumerate().any(of)
    }
}

/// Whether two segments meet.
fn meet([a, b]: [Uv; 2], [c, d]: [Uv; 2]) -> bool {
    let (s, t, r) = (uv(b.u - a.u, b.v - a.v), uv(d.u - c.u, d.v - c.v), uv(c.u - a.u, c.v - a.v));
    let det = s.u * t.v - s.v * t.u;
    let within = |x: f64| (0.0..=1.0).contains(&x);
    within((r.u * t.v - r.v * t.u) / det) && within((r.u * s.v - r.v * s.u) / det)
}

/// Which pieces bound what is left. At every node their number is even; that tells of those that stand too near to others.
fn even(pieces: &[Piece], bounds: &[Bounds]) -> Vec<bool> {
    let mut kept: Vec<bool> = bounds.iter().map(|b| b.kept).collect();
    let mut open: Vec<bool> = bounds.iter().map(|b| b.blocked).collect();
    let nodes = pieces.iter().filter_map(|p| p.nodes).flatten().max().map_or(0, |n| n + 1);
    let mut at: Vec<Vec<usize>> = vec![Vec::new(); nodes];
    for (k, piece) in pieces.iter().enumerate() {
        for node in piece.nodes.iter().flatten() {
            at[*node].push(k);
        }
    }
    while let Some((of, k)) = at.iter().find_map(|of| {
        let mut still = of.iter().filter(|k| open[**k]);
        still.next().filter(|_| still.next().is_none()).map(|k| (of, *k))
    }) {
        kept[k] = of.iter().filter(|o| **o != k && kept[**o]).count() % 2 == 1;
        open[k] = false;
    }
    kept
}

/// The face inside loops that lie flat in its rectangle.
fn trimmed(surface: &TrimmedSurface, loops: Vec<Vec<Uv>>) -> Option<TrimmedSurface> {
    let count = loops.len();
    let closed = |mut points: Vec<Uv>| {
        points.extend(points.first().copied());
        Chain { points }
    };
    let chains: Vec<Chain> = loops.into_iter().map(closed).collect();
    let known = Known { below_out: true, above_out: true, oriented: false };
    let region = Region::new(surface.domain(), [false, false], &chains, known);
    TrimmedSurface::from_region(surface.carrier().clone(), surface.domain(), region, surface.side(), count)
        .ok()
}

/// The face of the body nearest to a place at which rays say something else than what is left of a face.
fn wrong(surface: &TrimmedSurface, solid: &Solid<'_>, left: &Left) -> Option<usize> {
    let spans = surface.breaks(Axis::U).len().max(surface.breaks(Axis::V).len()) - 1;
    // Far enough off the body that neither triangles nor loops are in doubt.
    let clear_mm = solid.doubt_mm();
    surface.samples(CHECKS.div_ceil(spans.max(1))).into_iter().find_map(|(at, p)| {
        let near = solid.soup.nearest(&p).filter(|n| n.distance_mm > 2.0 * clear_mm)?;
        let hidden = solid.tell(&p, clear_mm) == Where::Inside;
        let visible = match left {
            Left::All => true,
            Left::Nothing => false,
            Left::Part(rest) => rest.contains(at),
        };
        (hidden == visible).then(|| solid.walls[solid.soup.patches[near.patch].face].face)
    })
}
