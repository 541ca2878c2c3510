//! Faces from a surface and the curves of its loops, the same for both formats.

use super::assemble::{Assembled, assemble};
use super::carrier::{Carrier, FaceSurface};
use super::chain::{EdgeUse, join};
use super::curve::{Curve, Piece};
use super::edge::FaceEdge;
use super::pull::{Tolerance, flatten, pull};
use crate::trimmed::TrimError;
use osculate_geom::{Box3, Point3, Side, Surface, Uv, uv};

/// A boundary curve of a loop, in the loop's sense.
pub(crate) enum Boundary {
    /// A curve in space.
    Space {
        /// The curve from start to end.
        piece: Piece,
        /// The edge's number, the same for both uses of one edge.
        key: Option<u64>,
    },
    /// A curve in the parameter plane (z = 0).
    Parameter {
        /// The curve from start to end.
        piece: Piece,
    },
}

/// A face and what its boundary gave reason to say.
pub(crate) struct Built {
    pub(crate) assembled: Assembled,
    /// Findings, in words.
    pub(crate) findings: Vec<String>,
}

/// Chord tolerance of loops as a fraction of the face's size: the area between chord and arc of a full circle is
/// then about 5e-6 of the circle.
const CHORD: f64 = 2e-6;

/// Distance between a boundary curve and its surface, as a fraction of the face's size, up to which a neighbour's
/// parameters are trusted; beyond it the whole surface is searched and the gap is reported.
const NEAR: f64 = 1e-4;

/// Distance between a boundary curve and its surface, as a fraction of the face's size, beyond which they do not belong
/// together. Real files of poor quality stay below a hundredth.
const FAR: f64 = 0.1;

/// Builds the trimmed surface of a face. Loops have the inside on their left, seen against the carrier's normal, if
/// `oriented`.
pub(crate) fn build(
    surface: FaceSurface,
    loops: &[Vec<Boundary>],
    side: Side,
    oriented: bool,
) -> Result<Built, TrimError> {
    let carrier = Carrier::new(surface, oriented);
    let size = size_mm(&carrier, loops);
    let tolerance = Tolerance { chord_mm: CHORD * size, near_mm: NEAR * size, far_mm: FAR * size };
    let mut gap_mm = 0.0_f64;
    let mut edges = Vec::new();
    for (owner, l) in loops.iter().enumerate() {
        for b in l {
            edges.push(match b {
                Boundary::Space { piece, key } => {
                    let pulled = pull(piece, &carrier, tolerance);
                    gap_mm = gap_mm.max(pulled.gap_mm);
                    EdgeUse { points: pulled.points, ends: piece.end_points(), key: *key, owner }
                }
                Boundary::Parameter { piece } => {
                    let points = flatten(piece, &carrier, tolerance);
                    let end = |at: Option<&Uv>| carrier.surface.point(at.copied().unwrap_or_default());
                    let ends = [end(points.first()), end(points.last())];
                    EdgeUse { points, ends, key: None, owner }
                }
            });
        }
    }
    if gap_mm.is_nan() || gap_mm > tolerance.far_mm {
        return Err(TrimError::OffSurface { gap_mm, size_mm: size });
    }
    for e in &mut edges {
        snap(&carrier, &mut e.points, tolerance.chord_mm);
    }
    let kept = loops.iter().flatten().zip(&edges).map(|(b, e)| FaceEdge {
        key: e.key,
        owner: e.owner,
        curve: match b {
            Boundary::Space { piece, .. } => Some(piece.clone()),
            Boundary::Parameter { .. } => None,
        },
        points: e.points.clone(),
    });
    let kept: Vec<FaceEdge> = kept.collect();
    let joined = join(&carrier, edges, tolerance.near_mm);
    let mut findings = Vec::new();
    if gap_mm > tolerance.near_mm {
        findings.push(format!("the boundary lies up to {gap_mm:.3e} mm off the surface"));
    }
    if joined.jump_mm > tolerance.near_mm {
        findings
            .push(format!("the boundary has a gap of {:.3e} mm, closed by a straight line", joined.jump_mm));
    }
    let mut assembled = assemble(&carrier, &joined, side)?;
    assembled.surface = assembled.surface.with_edges(kept);
    if !assembled.consistent {
        findings.push("the loops do not separate an inside from an outside on this surface".into());
    }
    Ok(Built { assembled, findings })
}

/// Size of a face: the box around its boundary, or around its surface where there is none.
fn size_mm(carrier: &Carrier, loops: &[Vec<Boundary>]) -> f64 {
    let mut points: Vec<Point3> = Vec::new();
    for b in loops.iter().flatten() {
        match b {
            Boundary::Space { piece, .. } => {
                points.extend((0..=8).map(|k| piece.point(f64::from(k) / 8.0)));
            }
            Boundary::Parameter { piece } => {
                points.extend((0..=8).map(|k| {
                    let p = piece.point(f64::from(k) / 8.0);
                    carrier.surface.point(uv(p.x, p.y))
                }));
            }
        }
    }
    let size = Box3::around(&points).diagonal_mm();
    if size > 0.0 && size.is_finite() {
        return size;
    }
    let domain = carrier.domain;
    let corners = [(0.0, 0.0), (0.5, 0.25), (1.0, 0.5), (0.0, 0.75), (0.5, 1.0)];
    let own = Box3::around(&corners.map(|(f, g)| carrier.surface.point(domain.at(f, g)))).diagonal_mm();
    if own > 0.0 && own.is_finite() { own } else { 1.0 }
}

/// Puts points that are within the chord tolerance of a side of the rectangle onto it.
fn snap(carrier: &Carrier, points: &mut [Uv], chord_mm: f64) {
    let settle = |t: f64, k: usize| {
        let i = if k == 0 { carrier.domain.u } else { carrier.domain.v };
        if !i.length().is_finite() {
            return t;
        }
        let slack = (chord_mm / carrier.speed[k]).min(1e-6 * i.length());
        // Sides repeat every period where they are joined.
        let turns = if carrier.closes[k] { ((t - i.lo) / i.length()).floor() * i.length() } else { 0.0 };
        for side in [i.lo + turns, i.hi + turns] {
            if (t - side).abs() <= slack {
                return side;
            }
        }
        t
    };
    for p in points {
        *p = uv(settle(p.u, 0), settle(p.v, 1));
    }
}
