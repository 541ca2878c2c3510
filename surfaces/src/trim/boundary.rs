//! Faces from a surface and the curves of its loops, the same for both formats.

use super::analytic::Shape;
use super::assemble::{Assembled, assemble};
use super::carrier::{Carrier, FaceSurface};
use super::chain::{EdgeUse, join};
use super::curve::{Curve, Moved, Piece};
use super::edge::FaceEdge;
use super::motion::Motion;
use super::pull::{Pulled, Tolerance, flatten, pull};
use super::side::along_side;
use crate::trimmed::TrimError;
use nalgebra::Matrix3;
use osculate_geom::{Box3, Point3, Side, Surface, Uv, Vec3, uv};
use std::sync::Arc;

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

/// A boundary that reaches less than this fraction of its extent to the near side of a cone's apex lies beyond it:
/// files carry seven digits or more.
const SAME_APEX: f64 = 1e-6;

/// Builds the trimmed surface of a face. Loops have the inside on their left, seen against the carrier's normal, if
/// `oriented`.
pub(crate) fn build(
    surface: FaceSurface,
    loops: &[Vec<Boundary>],
    side: Side,
    oriented: bool,
) -> Result<Built, TrimError> {
    let turned = beyond_apex(&surface, loops);
    let (surface, loops) = match &turned {
        Some((surface, loops)) => (surface.clone(), loops.as_slice()),
        None => (surface, loops),
    };
    let carrier = Carrier::new(surface, oriented);
    let size = size_mm(&carrier, loops);
    let tolerance = Tolerance { chord_mm: CHORD * size, near_mm: NEAR * size, far_mm: FAR * size };
    let mut gap_mm = 0.0_f64;
    let mut gaps_mm = Vec::new();
    let mut edges = Vec::new();
    for (owner, l) in loops.iter().enumerate() {
        for b in l {
            edges.push(match b {
                Boundary::Space { piece, key } => {
                    // A curve that is a side of the surface needs no search.
                    let side = carrier.surface.nurbs().and_then(|n| along_side(piece, n));
                    let pulled = match side {
                        Some(ends) => Pulled { points: ends.to_vec(), gap_mm: 0.0 },
                        None => pull(piece, &carrier, tolerance),
                    };
                    gap_mm = gap_mm.max(pulled.gap_mm);
                    gaps_mm.push(pulled.gap_mm);
                    EdgeUse { points: pulled.points, ends: piece.end_points(), key: *key, owner, own: false }
                }
                Boundary::Parameter { piece } => {
                    let points = flatten(piece, &carrier, tolerance);
                    gaps_mm.push(0.0);
                    let end = |at: Option<&Uv>| carrier.surface.point(at.copied().unwrap_or_default());
                    let ends = [end(points.first()), end(points.last())];
                    EdgeUse { points, ends, key: None, owner, own: true }
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
    let kept = loops.iter().flatten().zip(&edges).zip(gaps_mm).map(|((b, e), gap_mm)| FaceEdge {
        key: e.key,
        owner: e.owner,
        gap_mm,
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
    if joined.turned_edges > 0 {
        findings.push(format!(
            "{} of its edges run against their loop and are turned round",
            joined.turned_edges
        ));
    }
    if joined.jump_mm > tolerance.near_mm {
        findings
            .push(format!("the boundary has a gap of {:.3e} mm, closed by a straight line", joined.jump_mm));
    }
    if joined.corners > 0 {
        findings.push(
            "the boundary jumps between sides of the surface that are one point; it is led along these sides"
                .into(),
        );
    }
    let mut assembled = match assemble(&carrier, &joined, side) {
        Ok(made) if made.consistent && made.idle == 0 => made,
        first => {
            // Loops that separate nothing: a side as small as a gap is the pole that they lack an edge around.
            let poled = carrier.with_poles(tolerance.near_mm).and_then(|(carrier, mm)| {
                Some((assemble(&carrier, &joined, side).ok().filter(|made| made.consistent)?, mm))
            });
            match poled {
                Some((made, mm)) => {
                    findings.push(format!(
                        "its loops have no edge around the end of the surface, which is {mm:.3e} mm large; it is taken for a pole"
                    ));
                    made
                }
                None => first?,
            }
        }
    };
    assembled.surface = assembled.surface.with_edges(kept);
    if assembled.idle > 0 {
        findings.push(format!(
            "{} of its loops go once around the surface without a partner and bound nothing; they are left out",
            assembled.idle
        ));
    }
    if !assembled.consistent {
        findings.push("the loops do not separate an inside from an outside on this surface".into());
    }
    Ok(Built { assembled, findings })
}

/// The other nappe of a cone, with the loops in its parameters, where the whole boundary lies beyond the apex.
fn beyond_apex(surface: &FaceSurface, loops: &[Vec<Boundary>]) -> Option<(FaceSurface, Vec<Vec<Boundary>>)> {
    let FaceSurface::Analytic(cone) = surface else { return None };
    let (other, apex) = cone.other_nappe()?;
    let Shape::Cone { half_angle_rad, .. } = cone.shape() else { return None };
    let slope = half_angle_rad.cos() * half_angle_rad.signum();
    // How far a point is beyond the apex, along the axis.
    let beyond = |b: &Boundary, t: f64| match b {
        Boundary::Space { piece, .. } => half_angle_rad.signum() * other.placement().local(&piece.point(t)).z,
        Boundary::Parameter { piece } => slope * (apex - piece.point(t).y),
    };
    let ways: Vec<f64> =
        loops.iter().flatten().flat_map(|b| (0..=8).map(|k| beyond(b, f64::from(k) / 8.0))).collect();
    let (least, most) = ways.iter().fold((0.0_f64, 0.0_f64), |r, w| (r.0.min(*w), r.1.max(*w)));
    if !(most > 0.0 && -least <= SAME_APEX * most) {
        return None;
    }
    let motion = Motion {
        linear: Matrix3::from_diagonal(&Vec3::new(-1.0, -1.0, 1.0)),
        shift: Vec3::new(0.0, apex, 0.0),
    };
    let mapped = |b: &Boundary| match b {
        Boundary::Space { piece, key } => Boundary::Space { piece: piece.clone(), key: *key },
        Boundary::Parameter { piece } => Boundary::Parameter {
            piece: Piece { curve: Arc::new(Moved { curve: piece.curve.clone(), motion }), ends: piece.ends },
        },
    };
    let loops = loops.iter().map(|l| l.iter().map(mapped).collect()).collect();
    Some((FaceSurface::Analytic(Arc::new(other)), loops))
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
