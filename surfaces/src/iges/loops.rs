//! Boundaries of faces: curves on surfaces (142), boundaries (141), and loops of solids' faces (508).
//!
//! Loops come from parameter-space curves where they are present and lie on the model-space curves; else the
//! model-space curves are projected.

use super::directory::Entity;
use super::geometry::{Geometry, Space, Unread};
use super::pcurves::{OnCarrier, Parameters};
use crate::trim::boundary::Boundary;
use crate::trim::carrier::FaceSurface;
use crate::trim::curve::{Curve, Line, Piece};
use crate::trim::motion::Motion;
use osculate_geom::{Box3, Point3, Surface, uv};
use std::sync::Arc;

/// A parameter-space curve farther than this fraction of the loop's size from the model-space curve is not used.
/// Writers keep the two apart by up to a few parts in ten thousand; a curve of another surface or scale is off by more
/// than a hundredth.
const AGREE: f64 = 1e-3;

/// The same where the file says that the parameter-space curve is the better one.
const AGREE_PREFERRED: f64 = 1e-2;

/// A loop with a gap beyond this fraction of its size bounds nothing: its curves are no loop. Gaps that writers leave
/// between neighbours stay below a hundredth.
const OPEN: f64 = 0.2;

/// The surface that a loop lies on.
pub(super) struct Target<'a> {
    pub(super) surface: &'a FaceSurface,
    /// What the file's parameters are on it, where that is known.
    pub(super) parameters: Option<Parameters>,
    /// Factor and motion of the instance that the face is in.
    pub(super) motion: &'a Motion,
}

/// Entity 142 as a loop.
pub(super) fn curve_on_surface(
    geometry: &Geometry<'_>,
    de: i64,
    target: &Target<'_>,
) -> Result<Vec<Boundary>, Unread> {
    let e = geometry.entity(de)?;
    if e.kind != 142 {
        return Err(Unread::Kind { de, kind: e.kind, form: e.form });
    }
    let motion = geometry.motion(e)?.then(target.motion);
    // A pointer that is not there, or leads nowhere, is not fatal where the other curve is.
    let read = |k: usize, space: Space, motion: &Motion| match geometry.pointer(de, e, k)? {
        Some(p) => geometry.pieces(p, space, motion).map(Some),
        None => Ok(None),
    };
    let parameter = read(2, Space::Parameter, &Motion::identity());
    let model = read(3, Space::Model, &motion);
    let (parameter, model) = match (parameter, model) {
        (Ok(p), Ok(m)) => (p, m),
        (Ok(Some(p)), Err(why)) => {
            geometry
                .say(format!("DE {de}: the model-space curve cannot be read ({why}); the other one is used"));
            (Some(p), None)
        }
        (Err(why), Ok(Some(m))) => {
            if target.parameters.is_some_and(Parameters::are_same) {
                geometry.say(format!(
                    "DE {de}: the parameter-space curve cannot be read ({why}); the other one is used"
                ));
            }
            (None, Some(m))
        }
        (Err(why), _) | (_, Err(why)) => return Err(why),
    };
    let preferred = geometry.number(de, e, 4)? == 1.0;
    choose(geometry, de, target, [parameter, model], preferred)
}

/// The parameter-space curve, the first, where it is usable, else the model-space one.
fn choose(
    geometry: &Geometry<'_>,
    de: i64,
    target: &Target<'_>,
    [parameter, model]: [Option<Vec<Piece>>; 2],
    preferred: bool,
) -> Result<Vec<Boundary>, Unread> {
    let parameter = match (parameter, target.parameters) {
        // On carriers with parameters of their own the curves in space are the safer ones.
        (Some(p), Some(own)) if !p.is_empty() && (own.are_same() || preferred || model.is_none()) => Some(
            p.into_iter()
                .map(|p| {
                    if own.are_same() {
                        p
                    } else {
                        Piece { curve: Arc::new(OnCarrier { curve: p.curve, parameters: own }), ends: p.ends }
                    }
                })
                .collect::<Vec<Piece>>(),
        ),
        _ => None,
    };
    let model = model.filter(|m| !m.is_empty());
    let in_space =
        |pieces: Vec<Piece>| pieces.into_iter().map(|piece| Boundary::Space { piece, key: None }).collect();
    let as_parameters =
        |pieces: Vec<Piece>| pieces.into_iter().map(|piece| Boundary::Parameter { piece }).collect();
    match (parameter, model) {
        (Some(p), Some(m)) => {
            let Some(Deviation { off_mm, size_mm }) = deviation(target.surface, &p, &m) else {
                geometry.say(format!(
                    "DE {de}: the parameter-space curve leaves the surface's rectangle; the model-space curve is \
                     projected"
                ));
                return Ok(in_space(m));
            };
            let off = if size_mm > 0.0 { off_mm / size_mm } else { off_mm };
            if off > AGREE && !(preferred && off <= AGREE_PREFERRED) {
                geometry.say(format!(
                    "DE {de}: the parameter-space curve is up to {off_mm:.3e} mm from the model-space curve; that one \
                     is projected"
                ));
                return Ok(in_space(m));
            }
            if off > AGREE {
                geometry.say(format!(
                    "DE {de}: the parameter-space curve, which the file prefers, is up to {off_mm:.3e} mm from the \
                     model-space curve"
                ));
            }
            Ok(as_parameters(p))
        }
        (Some(p), None) => Ok(as_parameters(p)),
        (None, Some(m)) => Ok(in_space(m)),
        (None, None) => Err(geometry.malformed(de, "a boundary without a usable curve")),
    }
}

struct Deviation {
    off_mm: f64,
    size_mm: f64,
}

/// Largest distance of points of the parameter-space curve, on the surface, from the model-space curve; `None` where
/// it leaves the rectangle.
fn deviation(surface: &FaceSurface, parameter: &[Piece], model: &[Piece]) -> Option<Deviation> {
    let d = surface.domain();
    // Samples of each model curve, to look only at the near ones.
    let boxes: Vec<Box3> = model
        .iter()
        .map(|m| {
            let mut b = Box3::empty();
            for k in 0..=8 {
                b.add(&m.point(f64::from(k) / 8.0));
            }
            b
        })
        .collect();
    let size_mm = boxes.iter().fold(Box3::empty(), |all, b| all.union(b)).diagonal_mm();
    let mut off_mm = 0.0_f64;
    // A few samples of each piece; more where there are few pieces.
    let samples = (24 / parameter.len()).clamp(2, 8);
    for p in parameter {
        for k in 0..=samples {
            let q = p.point(k as f64 / samples as f64);
            let slack = [1e-4 * d.u.length(), 1e-4 * d.v.length()];
            if q.x < d.u.lo - slack[0]
                || q.x > d.u.hi + slack[0]
                || q.y < d.v.lo - slack[1]
                || q.y > d.v.hi + slack[1]
            {
                return None;
            }
            let s = surface.point(uv(q.x, q.y));
            // Nearest boxes first; a box that is farther than the best so far, with as much to spare as the curve
            // may leave the box of its samples, cannot win.
            let mut order: Vec<(f64, usize)> =
                boxes.iter().enumerate().map(|(j, b)| (outside(b, &s) - 0.25 * b.diagonal_mm(), j)).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut best = f64::INFINITY;
            for (least, j) in order {
                if least > best {
                    break;
                }
                let m = &model[j];
                best = best.min((m.point(m.locate(&s)) - s).norm());
            }
            off_mm = off_mm.max(best);
        }
    }
    Some(Deviation { off_mm, size_mm })
}

/// Distance of a point from a box.
fn outside(b: &Box3, p: &Point3) -> f64 {
    (0..3).map(|k| (b.min[k] - p[k]).max(p[k] - b.max[k]).max(0.0).powi(2)).sum::<f64>().sqrt()
}

/// Entity 141 as a loop.
pub(super) fn boundary(
    geometry: &Geometry<'_>,
    de: i64,
    target: &Target<'_>,
) -> Result<Vec<Boundary>, Unread> {
    let b = geometry.entity(de)?;
    if b.kind != 141 {
        return Err(Unread::Kind { de, kind: b.kind, form: b.form });
    }
    let motion = geometry.motion(b)?.then(target.motion);
    let preferred = geometry.number(de, b, 1)? == 2.0;
    let curves = geometry.count(de, b, 3, [4, 3])?;
    let (mut model, mut parameter): (Vec<Piece>, Vec<Piece>) = (Vec::new(), Vec::new());
    let mut complete = true;
    let mut at = 4;
    for _ in 0..curves {
        let curve = geometry.pointer(de, b, at)?;
        let against = geometry.number(de, b, at + 1)? == 2.0;
        let pcurves = geometry.count(de, b, at + 2, [at + 3, 1])?;
        if let Some(c) = curve {
            let mut pieces = geometry.pieces(c, Space::Model, &motion)?;
            if against {
                pieces = pieces.iter().rev().map(Piece::reversed).collect();
            }
            model.extend(pieces);
        }
        complete &= pcurves > 0;
        for j in 0..pcurves {
            // Those of other surfaces than splines are not used.
            if target.parameters.is_some()
                && let Some(p) = geometry.pointer(de, b, at + 3 + j)?
            {
                parameter.extend(geometry.pieces(p, Space::Parameter, &Motion::identity())?);
            }
        }
        at += 3 + pcurves;
    }
    choose(geometry, de, target, [complete.then_some(parameter), Some(model)], preferred)
}

/// Entity 508 as a loop; without edges, a vertex, it is empty.
pub(super) fn edge_loop(geometry: &Geometry<'_>, de: i64, outer: &Motion) -> Result<Vec<Boundary>, Unread> {
    let l = geometry.entity(de)?;
    if l.kind != 508 {
        return Err(Unread::Kind { de, kind: l.kind, form: l.form });
    }
    let edges = geometry.count(de, l, 0, [1, 5])?;
    let mut boundary = Vec::new();
    let mut at = 1;
    for _ in 0..edges {
        let is_vertex = geometry.number(de, l, at)? == 1.0;
        let list = geometry.pointer(de, l, at + 1)?;
        let index = geometry.number(de, l, at + 2)?;
        let forward = geometry.number(de, l, at + 3)? != 0.0;
        let pcurves = geometry.count(de, l, at + 4, [at + 5, 2])?;
        at += 5 + 2 * pcurves;
        let Some(list) = list.filter(|_| !is_vertex) else { continue };
        let edge_list = geometry.entity(list)?;
        if edge_list.kind != 504 {
            return Err(Unread::Kind { de: list, kind: edge_list.kind, form: edge_list.form });
        }
        let total = geometry.count(list, edge_list, 0, [1, 5])?;
        if !(index >= 1.0 && index <= total as f64 && index.fract() == 0.0) {
            return Err(geometry.malformed(de, format!("edge {index} of a list of {total}")));
        }
        let Some(curve) = geometry.pointer(list, edge_list, 1 + 5 * (index as usize - 1))? else {
            return Err(geometry.malformed(list, format!("edge {index} has no curve")));
        };
        let pieces = geometry.pieces(curve, Space::Model, outer)?;
        let single = pieces.len() == 1;
        // One edge used twice is a seam; pieces of a composite get numbers of their own.
        let key = |j: usize| (list as u64) << 40 | (index as u64) << 16 | j as u64;
        let mut uses: Vec<Boundary> = pieces
            .into_iter()
            .enumerate()
            .map(|(j, piece)| Boundary::Space {
                piece: if forward { piece } else { piece.reversed() },
                key: Some(key(if single { 0 } else { j + 1 })),
            })
            .collect();
        if !forward {
            uses.reverse();
        }
        boundary.extend(uses);
    }
    Ok(boundary)
}

/// The curves in the opposite sense.
pub(super) fn reversed(l: Vec<Boundary>) -> Vec<Boundary> {
    l.into_iter()
        .rev()
        .map(|b| match b {
            Boundary::Space { piece, key } => Boundary::Space { piece: piece.reversed(), key },
            Boundary::Parameter { piece } => Boundary::Parameter { piece: piece.reversed() },
        })
        .collect()
}

/// The gap of a loop that is so wide that it is none, mm.
pub(super) fn open_by(surface: &FaceSurface, l: &[Boundary]) -> Option<f64> {
    let point = |b: &Boundary, t: f64| match b {
        Boundary::Space { piece, .. } => piece.point(t),
        Boundary::Parameter { piece } => {
            let p = piece.point(t);
            surface.point(uv(p.x, p.y))
        }
    };
    let mut around = Box3::empty();
    let ends: Vec<[Point3; 2]> = l
        .iter()
        .map(|b| {
            for k in 0..=8 {
                around.add(&point(b, f64::from(k) / 8.0));
            }
            [point(b, 0.0), point(b, 1.0)]
        })
        .collect();
    // To the nearest end of any other curve, or its own other end: the curves need not be in sequence.
    let mut gap_mm = 0.0_f64;
    let all: Vec<Point3> = ends.iter().flatten().copied().collect();
    for (k, own) in all.iter().enumerate() {
        let others = all.iter().enumerate().filter(|(j, _)| *j != k);
        let near = others.map(|(_, p)| (p - own).norm()).fold(f64::INFINITY, f64::min);
        gap_mm = gap_mm.max(near);
    }
    (gap_mm.is_finite() && gap_mm > OPEN * around.diagonal_mm()).then_some(gap_mm)
}

/// The sides of a rectangle of parameters, `[u0, u1, v0, v1]`, as a loop.
pub(super) fn sides([u0, u1, v0, v1]: [f64; 4]) -> Vec<Boundary> {
    let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(|[u, v]| Point3::new(u, v, 0.0));
    (0..4)
        .map(|k| Boundary::Parameter {
            piece: Piece {
                curve: Arc::new(Line::segment(corners[k], corners[(k + 1) % 4])),
                ends: [0.0, 1.0],
            },
        })
        .collect()
}

/// The rectangle that a spline surface names for itself, where it is a real part of the domain.
pub(super) fn own_rectangle(
    geometry: &Geometry<'_>,
    de: i64,
    surface: &FaceSurface,
) -> Option<Vec<Boundary>> {
    let [u0, u1, v0, v1] = geometry.named_rectangle(de)?;
    let d = surface.domain();
    let cuts = |lo: f64, hi: f64, a: f64, b: f64| {
        let slack = 1e-6 * (hi - lo);
        a < b && (a > lo + slack || b < hi - slack) && a >= lo - slack && b <= hi + slack
    };
    let (cut_u, cut_v) = (cuts(d.u.lo, d.u.hi, u0, u1), cuts(d.v.lo, d.v.hi, v0, v1));
    if !(cut_u || cut_v) {
        return None;
    }
    let (u0, u1) = if cut_u { (u0, u1) } else { (d.u.lo, d.u.hi) };
    let (v0, v1) = if cut_v { (v0, v1) } else { (d.v.lo, d.v.hi) };
    Some(sides([u0, u1, v0, v1]))
}

/// The parameters of a face entity's surface, from its directory number.
pub(super) fn surface_pointer(e: &Entity) -> Option<i64> {
    let k = match e.kind {
        143 => 1,
        144 | 510 => 0,
        140 => 4,
        _ => return None,
    };
    e.params.number(k).map(|p| p.abs() as i64)
}
