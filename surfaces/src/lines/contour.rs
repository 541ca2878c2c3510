//! All lines on which a scalar field has given values.
//!
//! The crossings of a triangulation ([`Web`]) are linked, which closes what is closed and ends what ends on the
//! border; each point is settled on the field by a bracketed root along its edge, and pieces are halved, their
//! middles brought to the level by Newton's method, until the chords are within tolerance. Lines that run through a
//! pole are joined there; lines are cut where they leave the face's trims.
//!
//! Complete means: no component is missed that crosses an edge of the triangulation once, or twice where the cubic
//! through values and slopes shows it, or that surrounds one of the `extremes`. What can be missed lies between
//! two samples of a cell, [`Contours::resolution_mm`], without reaching across an edge.

use super::chart::Chart;
use super::critical::CriticalPoints;
use super::field::{FieldSample, ScalarField};
use super::stitch::chains;
use super::trace::{LineEnd, LinePoint, SurfacePolyline};
use super::web::{Extreme, Web, edge, same_sense};
use osculate_geom::roots::{End, bracketed};
use osculate_geom::solve::symmetric;
use osculate_geom::{Axis, Uv, Vec3, uv};
use rayon::prelude::*;
use std::collections::HashMap;

/// A component of a level.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// The field's value on it.
    pub level: f64,
    /// The line.
    pub line: SurfacePolyline,
}

/// The lines of a field at several levels.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Contours {
    /// The components, level by level.
    pub lines: Vec<Contour>,
    /// Side of the largest cell, mm, see the module's promise.
    pub resolution_mm: f64,
    /// Pieces of the triangulation in which a level may do more than is drawn: the field is noise there.
    pub coarse_pieces: usize,
}

/// Halvings of one piece between two crossings.
const HALVINGS: u32 = 10;
/// Where more than this part of the triangulation is too coarse, the field is noise, and pieces are drawn straight.
const NOISE: f64 = 0.1;
/// Newton steps towards a level.
const NEWTON: usize = 12;

/// All lines on which `field` has one of `levels`, inside the face's trims. `extremes` are the field's critical
/// points where they are known.
#[must_use]
pub fn contours(
    chart: &Chart,
    field: &dyn ScalarField,
    levels: &[f64],
    extremes: Option<&CriticalPoints>,
) -> Contours {
    let mut sorted: Vec<f64> = levels.iter().copied().filter(|l| l.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let known: Vec<Extreme> = extremes
        .map(|c| c.points.iter().map(|p| Extreme { at: p.at, value: p.value }).collect())
        .unwrap_or_default();
    let rounding = field.rounding(chart.scale());
    // Lines are drawn a rounding below their level: where the field stays at a level but for rounding, as the Gaussian
    // curvature of a cylinder, there is no line.
    let lowered: Vec<f64> = sorted.iter().map(|l| l - rounding).collect();
    let web = Web::new(chart, field, &lowered, &known);
    let drawn: Vec<Vec<Contour>> = sorted
        .par_iter()
        .map(|named| Level { chart, field, named: *named, level: named - rounding }.draw(&web))
        .collect();
    Contours {
        lines: drawn.into_iter().flatten().collect(),
        resolution_mm: chart.resolution_mm(),
        coarse_pieces: web.uncut,
    }
}

/// One level of a field.
struct Level<'a> {
    chart: &'a Chart<'a>,
    field: &'a dyn ScalarField,
    /// The level asked for.
    named: f64,
    /// The level drawn, a rounding below.
    level: f64,
}

impl Level<'_> {
    fn draw(&self, web: &Web) -> Vec<Contour> {
        let mut nodes: HashMap<(u32, u32), u32> = HashMap::new();
        let mut places: Vec<Option<Uv>> = Vec::new();
        let mut links = Vec::new();
        for t in &web.triangles {
            let [a, b, c] = t.map(|v| web.samples[v as usize]);
            let (Some(a), Some(b), Some(c)) = (a, b, c) else { continue };
            if web.is_zero(&[a, b, c]) {
                continue;
            }
            let crossed: Vec<u32> = (0..3)
                .filter_map(|k| {
                    let (i, j) = edge(t[k], t[(k + 1) % 3]);
                    let (p, q) = (web.samples[i as usize]?, web.samples[j as usize]?);
                    let flip = same_sense(&p, &q);
                    // A vertex on the level counts as above it, in its own sense: were it to follow the neighbour's, a
                    // triangle could have one crossing.
                    let above = |v: f64| if v < self.level { -1.0 } else { 1.0 };
                    if above(p.value) * above(q.value) * flip > 0.0 {
                        return None;
                    }
                    Some(*nodes.entry((i, j)).or_insert_with(|| {
                        places.push(self.crossing(web, (i, &p), (j, &q)));
                        (places.len() - 1) as u32
                    }))
                })
                .collect();
            // One or three crossings: the sense of a signless field turns in the triangle, the line ends there.
            if let [x, y] = crossed[..] {
                links.push((x, y));
            }
        }
        // A crossing that could not be settled is no crossing.
        links.retain(|(a, b)| places[*a as usize].is_some() && places[*b as usize].is_some());
        let noise = web.uncut as f64 > NOISE * web.triangles.len() as f64;
        let halvings = if noise { 0 } else { HALVINGS };
        let mut lines = Vec::new();
        for (chain, closed) in chains(places.len(), &links) {
            let rough: Vec<Uv> = chain.iter().filter_map(|n| places[*n as usize]).collect();
            lines.push((self.polished(&rough, closed, halvings), closed));
        }
        let lines = self.joined_at_poles(lines);
        lines
            .into_iter()
            .flat_map(|(points, closed)| self.trimmed(points, closed))
            .map(|line| Contour { level: self.named, line })
            .collect()
    }

    /// The field less the level, in the sense of `like`.
    fn off(&self, at: Uv, like: Option<&Vec3>) -> Option<(f64, FieldSample)> {
        let s = self.field.sample(self.chart.surface(), at)?;
        let sign = match (like, s.sense) {
            (Some(l), Some(x)) if l.dot(&x) < 0.0 => -1.0,
            _ => 1.0,
        };
        Some((sign * s.value - self.level, s))
    }

    /// Where the level crosses an edge.
    fn crossing(&self, web: &Web, (i, p): (u32, &FieldSample), (j, q): (u32, &FieldSample)) -> Option<Uv> {
        let (a, b) = (web.at[i as usize], web.at[j as usize]);
        let length = (self.chart.surface().point(b) - self.chart.surface().point(a)).norm();
        let tolerance = (0.1 * self.chart.tolerance().position_mm / length).clamp(1e-15, 1e-3);
        let ends = (
            End { x: 0.0, f: p.value - self.level },
            End { x: 1.0, f: same_sense(p, q) * q.value - self.level },
        );
        let f = |t: f64| self.off(self.chart.towards(a, b, t), p.sense.as_ref()).map_or(f64::NAN, |(v, _)| v);
        let root = bracketed(ends.0, ends.1, tolerance, f).ok()?;
        Some(self.chart.towards(a, b, root.x))
    }

    /// The place brought to the level by Newton steps along the field's gradient on the surface; `None` where they
    /// lead further away than `reach_mm` or do not settle.
    fn settled(&self, start: Uv, like: Option<&Vec3>, reach_mm: f64) -> Option<Uv> {
        let (surface, mut at) = (self.chart.surface(), start);
        let origin = surface.point(start);
        for _ in 0..NEWTON {
            let (v, sample) = self.off(at, like)?;
            let g = match sample.gradient {
                Some(g) => g,
                None => {
                    let h = self.chart.half_cell(at).map(|h| 1e-4 * h);
                    let slope = |du: f64, dv: f64| {
                        let f = |s: f64| self.off(uv(at.u + s * du, at.v + s * dv), like).map(|x| x.0);
                        Some(f(1.0)? - f(-1.0)?)
                    };
                    [slope(h[0], 0.0)? / (2.0 * h[0]), slope(0.0, h[1])? / (2.0 * h[1])]
                }
            };
            let jet = surface.jet2(at);
            let (e, f, k) = (jet.du.dot(&jet.du), jet.du.dot(&jet.dv), jet.dv.dot(&jet.dv));
            // I^-1 g, the gradient on the surface, as a parameter rate.
            let [du, dv] = symmetric([e, f, k], g);
            let rate = uv(du, dv);
            let steep = rate.u * g[0] + rate.v * g[1];
            let step = uv(-v * rate.u / steep, -v * rate.v / steep);
            if !(step.u.is_finite() && step.v.is_finite()) {
                return None;
            }
            at = self.chart.bring(uv(at.u + step.u, at.v + step.v));
            let size = jet.tangent(step).norm();
            if size > reach_mm || (surface.point(at) - origin).norm() > reach_mm {
                return None;
            }
            if size <= self.chart.tolerance().position_mm {
                return Some(at);
            }
        }
        None
    }

    /// The line through crossings with pieces halved, so often at most, until the chords are within tolerance.
    fn polished(&self, rough: &[Uv], closed: bool, halvings: u32) -> Vec<LinePoint> {
        let surface = self.chart.surface();
        let point = |at: Uv| LinePoint { at, point: surface.point(at) };
        let mut out: Vec<LinePoint> = Vec::with_capacity(2 * rough.len());
        let pieces = if closed { rough.len() } else { rough.len() - 1 };
        let sense = |at: Uv| self.field.sample(surface, at).and_then(|s| s.sense);
        out.push(point(rough[0]));
        for k in 0..pieces {
            let mut goals = vec![(point(rough[(k + 1) % rough.len()]), halvings)];
            while let Some((goal, left)) = goals.pop() {
                let from = *out.last().expect("the first point is in");
                let chord = goal.point - from.point;
                let middle = self.chart.towards(from.at, goal.at, 0.5);
                let reach = chord.norm();
                let settled = if left > 0 && reach > 0.0 {
                    self.settled(middle, sense(from.at).as_ref(), reach)
                } else {
                    None
                };
                if let Some(at) = settled {
                    let m = point(at);
                    let aside = chord.cross(&(m.point - from.point)).norm() / reach;
                    if aside > self.chart.tolerance().chord_mm {
                        goals.push((goal, left - 1));
                        goals.push((m, left - 1));
                        continue;
                    }
                }
                out.push(goal);
            }
        }
        if closed {
            out.pop();
        }
        out
    }

    /// Lines that end on the ring around a pole at opposite places, joined through the pole.
    fn joined_at_poles(&self, mut lines: Vec<(Vec<LinePoint>, bool)>) -> Vec<(Vec<LinePoint>, bool)> {
        for pole in self.chart.poles() {
            let i = self.chart.domain().get(pole.axis);
            let slack = 1e-9 * i.length();
            let on_ring = |p: &LinePoint| {
                let t = p.at.get(pole.axis);
                if pole.high { t >= i.hi - slack } else { t <= i.lo + slack }
            };
            // Ends on the ring in its order: line, and whether the end is its last point.
            let mut ends: Vec<(f64, usize, bool)> = Vec::new();
            for (k, (points, closed)) in lines.iter().enumerate() {
                for last in [false, true] {
                    let p = if last { points.last() } else { points.first() };
                    if let Some(p) = p.filter(|p| !closed && on_ring(p)) {
                        ends.push((p.at.get(pole.axis.other()), k, last));
                    }
                }
            }
            // A line through the pole comes in and goes out: 2 n ends, each continued by the opposite one.
            if ends.is_empty() || !ends.len().is_multiple_of(2) {
                continue;
            }
            ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            let half = ends.len() / 2;
            let pairs: Vec<_> =
                (0..half).map(|k| ((ends[k].1, ends[k].2), (ends[k + half].1, ends[k + half].2))).collect();
            let through = LinePoint { at: pole.at, point: pole.point };
            lines = join(lines, &pairs, through);
        }
        lines
    }

    /// The pieces of a line inside the trims.
    fn trimmed(&self, points: Vec<LinePoint>, closed: bool) -> Vec<SurfacePolyline> {
        let surface = self.chart.surface();
        let inside: Vec<bool> = points.iter().map(|p| surface.contains(p.at)).collect();
        let n = points.len();
        if inside.iter().all(|i| *i) {
            let ends = match closed {
                true => [LineEnd::Closed; 2],
                false => [self.end_of(&points[0]), self.end_of(&points[n - 1])],
            };
            return vec![SurfacePolyline { points, ends }];
        }
        // A closed line begins outside.
        let first = if closed { inside.iter().position(|i| !i).unwrap_or(0) } else { 0 };
        let count = if closed { n + 1 } else { n };
        let (mut out, mut current) = (Vec::new(), Vec::new());
        let mut start = LineEnd::Trim;
        for k in 0..count {
            let (i, previous) = ((first + k) % n, (first + k + n - 1) % n);
            if k > 0 && inside[i] != inside[previous] {
                let rim = self.rim(&points[previous], &points[i], inside[previous]);
                current.push(rim);
                if inside[previous] {
                    out.push(SurfacePolyline {
                        points: std::mem::take(&mut current),
                        ends: [start, LineEnd::Trim],
                    });
                } else {
                    start = LineEnd::Trim;
                }
            } else if k == 0 && inside[i] {
                start = self.end_of(&points[i]);
            }
            if inside[i] {
                current.push(points[i]);
            }
        }
        if current.len() > 1 {
            let end = self.end_of(current.last().expect("longer than one"));
            out.push(SurfacePolyline { points: current, ends: [start, end] });
        }
        out
    }

    /// Where the piece between a point inside and one outside crosses the trim, on the level.
    fn rim(&self, a: &LinePoint, b: &LinePoint, a_inside: bool) -> LinePoint {
        let surface = self.chart.surface();
        let (mut lo, mut hi) = (0.0, 1.0);
        let reach = (b.point - a.point).norm();
        let sense = self.field.sample(surface, a.at).and_then(|s| s.sense);
        let on = |t: f64| {
            let at = self.chart.towards(a.at, b.at, t);
            self.settled(at, sense.as_ref(), reach).unwrap_or(at)
        };
        // Forty halvings leave a part in 1e12 of the piece.
        for _ in 0..40 {
            let middle = 0.5 * (lo + hi);
            if surface.contains(on(middle)) == a_inside {
                lo = middle;
            } else {
                hi = middle;
            }
        }
        let at = on(if a_inside { lo } else { hi });
        LinePoint { at, point: surface.point(at) }
    }

    /// What an open line's end is.
    fn end_of(&self, p: &LinePoint) -> LineEnd {
        let on = |axis: Axis| {
            let i = self.chart.domain().get(axis);
            let slack = 1e-9 * i.length();
            !i.periodic && (p.at.get(axis) <= i.lo + slack || p.at.get(axis) >= i.hi - slack)
        };
        if on(Axis::U) || on(Axis::V) { LineEnd::Border } else { LineEnd::Singular }
    }
}

/// One end of one line: which, and whether its last point.
type LineTip = (usize, bool);

/// Lines joined at pairs of ends through a common point.
fn join(
    mut lines: Vec<(Vec<LinePoint>, bool)>,
    pairs: &[(LineTip, LineTip)],
    through: LinePoint,
) -> Vec<(Vec<LinePoint>, bool)> {
    // Where each original tip is now.
    let mut moved: HashMap<LineTip, LineTip> = HashMap::new();
    for (a, b) in pairs {
        let (a, b) = (*moved.get(a).unwrap_or(a), *moved.get(b).unwrap_or(b));
        if a.0 == b.0 {
            let line = &mut lines[a.0];
            line.0.push(through);
            line.1 = true;
            continue;
        }
        let (mut first, mut second) = (std::mem::take(&mut lines[a.0].0), std::mem::take(&mut lines[b.0].0));
        if !a.1 {
            first.reverse();
        }
        if b.1 {
            second.reverse();
        }
        first.push(through);
        first.append(&mut second);
        lines[a.0].0 = first;
        // The free ends: the first line's at the start, the second's at the end.
        let original = |now: LineTip, moved: &HashMap<LineTip, LineTip>| {
            moved.iter().find(|(_, v)| **v == now).map_or(now, |(k, _)| *k)
        };
        let (free_a, free_b) = (original((a.0, !a.1), &moved), original((b.0, !b.1), &moved));
        moved.insert(free_a, (a.0, false));
        moved.insert(free_b, (a.0, true));
    }
    lines.retain(|(points, _)| points.len() > 1);
    lines
}
