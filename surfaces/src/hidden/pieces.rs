//! Pieces of border and lines of intersection, joined to the border of what is left of a face.
//!
//! Every piece has what is left of the face on one side only, or it is no border. At a node, where pieces meet, an even number
//! of them is border; so they join to closed loops.

use super::border::{Border, Metric, Segment};
use super::sheet::{Sheet, between};
use super::trace::Line;
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Uv, uv};

/// How near ends of lines have to be to be one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joins {
    /// To the border, mm: as exactly as files have their edges.
    pub(super) border_mm: f64,
    /// To each other, where nothing is nearer, mm: faces of a body gape.
    pub(super) gap_mm: f64,
}

/// A piece of border or line.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Its points, both ends included; of a closed one the first is not repeated.
    pub(super) points: Vec<Uv>,
    /// The nodes at both ends; none where it closes.
    pub(super) nodes: Option<[usize; 2]>,
    /// The face that a line is on besides; none for border.
    pub(super) other: Option<usize>,
}

/// A line that ends in the middle of the face: the face that it is on besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Loose(pub(super) Option<usize>);

/// Places where pieces meet.
struct Nodes<'a> {
    surface: &'a TrimmedSurface,
    at: Vec<Uv>,
    /// Where on the border each is, if it is.
    border: Vec<Option<(Segment, f64)>>,
}

impl Nodes<'_> {
    fn distance_mm(&self, a: Uv, b: Uv) -> f64 {
        let metric = Metric::new(&Sheet::new(self.surface).at(b));
        metric.length_mm(uv(a.u - b.u, a.v - b.v))
    }

    /// The nearest node within a distance, or a new one.
    fn of(&mut self, at: Uv, within_mm: f64, border: Option<(Segment, f64)>) -> usize {
        let near =
            (0..self.at.len()).map(|k| (self.distance_mm(at, self.at[k]), k)).filter(|n| n.0 <= within_mm);
        match near.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((_, k)) => k,
            None => {
                self.at.push(at);
                self.border.push(border);
                self.at.len() - 1
            }
        }
    }
}

/// Cuts the border where lines meet it, and joins the ends of lines.
pub(super) fn pieces(
    surface: &TrimmedSurface,
    border: &Border<'_>,
    lines: &[Line],
    joins: Joins,
) -> Result<Vec<Piece>, Loose> {
    let mut nodes = Nodes { surface, at: Vec::new(), border: Vec::new() };
    let mut ends: Vec<[Option<usize>; 2]> = vec![[None; 2]; lines.len()];
    let open: Vec<(usize, usize, Uv)> = lines
        .iter()
        .enumerate()
        .filter(|(_, l)| !l.closed)
        .flat_map(|(k, l)| [(k, 0, l.places[0].at[0]), (k, 1, l.places[l.places.len() - 1].at[0])])
        .collect();
    let on_border = |at: Uv, within_mm: f64| border.nearest(at).filter(|n| n.2 <= within_mm);
    let place = |(segment, way, _): (Segment, f64, f64)| {
        let [a, b] = border.ends(segment);
        (between(a, b, way), (segment, way))
    };
    for (k, end, at) in &open {
        if let Some(near) = on_border(*at, joins.border_mm) {
            let (at, on) = place(near);
            ends[*k][*end] = Some(nodes.of(at, joins.border_mm, Some(on)));
        }
    }
    let mut free: Vec<(usize, usize, Uv)> = Vec::new();
    for (k, end, at) in &open {
        if ends[*k][*end].is_none() {
            ends[*k][*end] = Some(nodes.of(*at, joins.border_mm, None));
            free.push((*k, *end, *at));
        }
    }
    // An end that met no other one goes to the nearest that met none either, or to the border, if that is near enough.
    let lone = |ends: &[[Option<usize>; 2]], node: usize| {
        ends.iter().flatten().filter(|n| **n == Some(node)).count() == 1
    };
    for (k, end, at) in &free {
        let node = ends[*k][*end];
        let Some(node) = node.filter(|n| nodes.border[*n].is_none() && lone(&ends, *n)) else { continue };
        let near = free.iter().filter(|f| (f.0, f.1) != (*k, *end));
        let near = near.filter_map(|f| Some((nodes.distance_mm(*at, f.2), ends[f.0][f.1]?)));
        let near =
            near.filter(|(mm, n)| *mm <= joins.gap_mm && nodes.border[*n].is_none() && lone(&ends, *n));
        let other = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        ends[*k][*end] = Some(match other {
            Some((_, other)) => other,
            None => {
                let near = on_border(nodes.at[node], joins.gap_mm).ok_or(Loose(Some(lines[*k].other)))?;
                let (at, on) = place(near);
                nodes.of(at, joins.border_mm, Some(on))
            }
        });
    }
    let mut out = border_pieces(border, &nodes);
    for (line, ends) in lines.iter().zip(ends) {
        let mut points: Vec<Uv> = line.places.iter().map(|p| p.at[0]).collect();
        let found = match ends {
            [Some(a), Some(b)] => {
                let last = points.len() - 1;
                (points[0], points[last]) = (nodes.at[a], nodes.at[b]);
                Some([a, b])
            }
            _ => None,
        };
        out.push(Piece { points, nodes: found, other: Some(line.other) });
    }
    Ok(out)
}

/// The loops of the border, cut at the nodes on them.
fn border_pieces(border: &Border<'_>, nodes: &Nodes<'_>) -> Vec<Piece> {
    let mut out = Vec::new();
    for (chain, points) in border.loops.iter().enumerate() {
        let on =
            |k: usize| nodes.border[k].filter(|(s, _)| s.chain == chain).map(|(s, way)| (s.first, way, k));
        let mut cuts: Vec<(usize, f64, usize)> = (0..nodes.at.len()).filter_map(on).collect();
        cuts.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        if cuts.is_empty() {
            out.push(Piece { points: points.clone(), nodes: None, other: None });
            continue;
        }
        for k in 0..cuts.len() {
            let (from, to) = (cuts[k], cuts[(k + 1) % cuts.len()]);
            let steps = if k + 1 < cuts.len() { to.0 - from.0 } else { to.0 + points.len() - from.0 };
            let mut way = vec![nodes.at[from.2]];
            way.extend((1..=steps).map(|s| points[(from.0 + s) % points.len()]));
            way.push(nodes.at[to.2]);
            way.dedup();
            if way.len() > 1 {
                out.push(Piece { points: way, nodes: Some([from.2, to.2]), other: None });
            }
        }
    }
    out
}

/// The closed loops that pieces make.
pub(super) fn loops(pieces: &[Piece]) -> Result<Vec<Vec<Uv>>, Loose> {
    let mut out = Vec::new();
    let mut used: Vec<bool> = pieces.iter().map(|p| p.nodes.is_none()).collect();
    out.extend(pieces.iter().filter(|p| p.nodes.is_none()).map(|p| p.points.clone()));
    for first in 0..pieces.len() {
        let (false, Some([start, mut here])) = (used[first], pieces[first].nodes) else { continue };
        used[first] = true;
        let mut walk = pieces[first].points.clone();
        let mut last = first;
        while here != start {
            let next = (0..pieces.len()).filter(|k| !used[*k]).find_map(|k| {
                let [a, b] = pieces[k].nodes?;
                if a == here {
                    Some((k, b, false))
                } else if b == here {
                    Some((k, a, true))
                } else {
                    None
                }
            });
            let Some((k, there, turned)) = next else { return Err(Loose(pieces[last].other)) };
            used[k] = true;
            let points = &pieces[k].points;
            if turned {
                walk.extend(points.iter().rev().skip(1));
            } else {
                walk.extend(points.iter().skip(1));
            }
            (here, last) = (there, k);
        }
        walk.pop();
        out.push(walk);
    }
    out.retain(|l| l.len() > 2);
    Ok(out)
}
