//! Closed outlines of a region on a rectangle whose boundary chains may have been cut at its sides.
//!
//! A chain that wraps around a closing direction leaves the rectangle on one side and comes back on the other. The
//! pieces between are joined along the parts of the rim that are inside: pieces and inside rim intervals are the
//! edges of a graph in which every walk closes.

use super::bands::Segment;
use osculate_geom::Interval;

/// What an outline is made of.
pub(crate) struct Sheet<'a> {
    /// Range of the first coordinate.
    pub(crate) x: Interval,
    /// Range of the second coordinate.
    pub(crate) y: Interval,
    /// Boundary segments within the rectangle, those of a chain in sequence.
    pub(crate) segments: &'a [Segment],
    /// Whether a point is inside the region; a point on the rim counts as just inside the rectangle.
    pub(crate) inside: &'a dyn Fn([f64; 2]) -> bool,
}

/// Two places closer than this fraction of a side are one: pieces are cut at the sides by interpolation, which is
/// exact to a few rounding errors.
const SAME: f64 = 1e-9;

/// The outlines, each closed: the first point is not repeated.
pub(crate) fn outline(sheet: &Sheet<'_>) -> Vec<Vec<[f64; 2]>> {
    let mut loops = Vec::new();
    let mut open = Vec::new();
    for piece in pieces(sheet) {
        if piece.len() > 2 && near(sheet, piece[0], piece[piece.len() - 1]) {
            loops.push(piece[..piece.len() - 1].to_vec());
        } else {
            open.push(piece);
        }
    }
    let Rim { places, intervals } = rim(sheet, &open);
    // Graph edges: the two places they join, and the points between in that sense.
    let mut edges: Vec<(usize, usize, Vec<[f64; 2]>)> = Vec::new();
    for piece in open {
        let (Some(a), Some(b)) =
            (place_of(sheet, &places, piece[0]), place_of(sheet, &places, piece[piece.len() - 1]))
        else {
            continue;
        };
        edges.push((a, b, piece));
    }
    for (a, b) in intervals {
        edges.push((a, b, vec![at(sheet, places[a]), at(sheet, places[b])]));
    }
    let mut used = vec![false; edges.len()];
    for first in 0..edges.len() {
        if used[first] {
            continue;
        }
        let (start, mut here, ref points) = edges[first];
        used[first] = true;
        let mut walk = points.clone();
        while here != start {
            let next = (0..edges.len()).find(|k| !used[*k] && (edges[*k].0 == here || edges[*k].1 == here));
            let Some(next) = next else { break };
            used[next] = true;
            let (a, b, ref points) = edges[next];
            if a == here {
                walk.extend_from_slice(&points[1..]);
                here = b;
            } else {
                walk.extend(points.iter().rev().skip(1));
                here = a;
            }
        }
        if walk.len() > 2 && near(sheet, walk[0], walk[walk.len() - 1]) {
            walk.pop();
        }
        if walk.len() > 2 {
            loops.push(walk);
        }
    }
    loops
}

/// Polylines of consecutive segments, cut where they meet the rim; open ones are joined where they meet inside the
/// rectangle. Segments along the rim are left out: which parts of it bound the region is asked from inside, since on
/// a closing direction the region may lie on the other side of the cut.
fn pieces(sheet: &Sheet<'_>) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut cut = true;
    for s in sheet.segments {
        if along_rim(sheet, s) {
            cut = true;
            continue;
        }
        match pieces.last_mut() {
            Some(last) if !cut && last.last() == Some(&s.a) => last.push(s.b),
            _ => pieces.push(vec![s.a, s.b]),
        }
        cut = on_rim(sheet, s.b);
    }
    let mut joined: Vec<Vec<[f64; 2]>> = Vec::new();
    for piece in pieces {
        // A chain may begin anywhere: its last piece then ends where its first one starts.
        let end = piece[piece.len() - 1];
        let closed = near(sheet, piece[0], end);
        let follower = joined.iter().position(|j| !closed && !on_rim(sheet, end) && near(sheet, j[0], end));
        match follower {
            Some(k) => {
                let mut whole = piece;
                whole.extend_from_slice(&joined[k][1..]);
                joined[k] = whole;
            }
            None => joined.push(piece),
        }
    }
    joined
}

/// Places on the rim and the intervals between neighbours that bound the region.
struct Rim {
    /// Rim parameters, ascending: each side has length one, beginning at the lower left, counter-clockwise.
    places: Vec<f64>,
    /// Pairs of places.
    intervals: Vec<(usize, usize)>,
}

fn rim(sheet: &Sheet<'_>, open: &[Vec<[f64; 2]>]) -> Rim {
    let mut places = vec![0.0, 1.0, 2.0, 3.0];
    for piece in open {
        places.extend([piece[0], piece[piece.len() - 1]].iter().filter_map(|p| rim_parameter(sheet, *p)));
    }
    places.sort_by(f64::total_cmp);
    places.dedup_by(|b, a| (*b - *a).abs() <= 4.0 * SAME);
    if places.last().is_some_and(|t| *t > 4.0 - 4.0 * SAME) {
        places.pop();
    }
    let mut intervals = Vec::new();
    for k in 0..places.len() {
        let (t0, next) = (places[k], (k + 1) % places.len());
        let t1 = if next == 0 { 4.0 } else { places[next] };
        let middle = at(sheet, 0.5 * (t0 + t1));
        if (sheet.inside)(middle) {
            intervals.push((k, next));
        }
    }
    Rim { places, intervals }
}

/// Whether a segment runs along a side of the rectangle.
fn along_rim(sheet: &Sheet<'_>, s: &Segment) -> bool {
    let (a, b) = (fraction(sheet, s.a), fraction(sheet, s.b));
    (0..2).any(|k| [0.0, 1.0].iter().any(|side| (a[k] - side).abs() <= SAME && (b[k] - side).abs() <= SAME))
}

fn fraction(sheet: &Sheet<'_>, p: [f64; 2]) -> [f64; 2] {
    [(p[0] - sheet.x.lo) / sheet.x.length(), (p[1] - sheet.y.lo) / sheet.y.length()]
}

fn near(sheet: &Sheet<'_>, p: [f64; 2], q: [f64; 2]) -> bool {
    let (a, b) = (fraction(sheet, p), fraction(sheet, q));
    (a[0] - b[0]).abs() <= SAME && (a[1] - b[1]).abs() <= SAME
}

fn on_rim(sheet: &Sheet<'_>, p: [f64; 2]) -> bool {
    rim_parameter(sheet, p).is_some()
}

/// The rim parameter of a point on the rim.
fn rim_parameter(sheet: &Sheet<'_>, p: [f64; 2]) -> Option<f64> {
    let [fx, fy] = fraction(sheet, p);
    if fy.abs() <= SAME {
        Some(fx)
    } else if (fx - 1.0).abs() <= SAME {
        Some(1.0 + fy)
    } else if (fy - 1.0).abs() <= SAME {
        Some(3.0 - fx)
    } else if fx.abs() <= SAME {
        Some(4.0 - fy)
    } else {
        None
    }
}

fn place_of(sheet: &Sheet<'_>, places: &[f64], p: [f64; 2]) -> Option<usize> {
    let t = rim_parameter(sheet, p)?;
    let gap = |u: f64| {
        let d = (u - t).abs();
        d.min(4.0 - d)
    };
    (0..places.len()).min_by(|a, b| gap(places[*a]).total_cmp(&gap(places[*b])))
}

/// The point at a rim parameter.
fn at(sheet: &Sheet<'_>, t: f64) -> [f64; 2] {
    let side = t.floor().min(3.0);
    let f = t - side;
    let (x, y) = (sheet.x, sheet.y);
    match side as u8 {
        0 => [x.at(f), y.lo],
        1 => [x.hi, y.at(f)],
        2 => [x.at(1.0 - f), y.hi],
        _ => [x.lo, y.at(1.0 - f)],
    }
}
