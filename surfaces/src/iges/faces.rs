//! Faces of an IGES file: trimmed (144), bounded (143) and free surfaces, and the faces (510) of solids and shells.
//!
//! Loops come from the parameter-space curves of 142 and 141 where they are present and lie on the model-space
//! curves; else the model-space curves are projected. Only faces of solids (186) say where the material is.

use super::cards::{Cards, Entity, Param};
use super::geometry::{Geometry, Space, Unread};
use super::names::kind_name;
use crate::part::{Face, FaceKind, Format, Leftovers, Part};
use crate::trim::boundary::{Boundary, Built, build};
use crate::trim::carrier::FaceSurface;
use crate::trim::curve::{Curve, Line, Motion, Piece};
use crate::trimmed::TrimError;
use osculate_geom::{Box3, Diagnostic, Point3, Side, Surface, uv};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

#[derive(Debug, thiserror::Error)]
enum FaceError {
    #[error(transparent)]
    Unread(#[from] Unread),
    #[error(transparent)]
    Trim(#[from] TrimError),
}

/// Surfaces that are faces when nothing refers to them.
const SURFACES: [u32; 5] = [114, 118, 120, 122, 128];

/// A parameter-space curve farther than this fraction of the loop's size from the model-space curve is not used.
/// Writers keep the two apart by up to a few parts in ten thousand; a curve of another surface or scale is off by more
/// than a hundredth.
const AGREE: f64 = 1e-3;

/// Builds the part of a file's cards.
pub(crate) fn part(mut cards: Cards) -> Part {
    let mut diagnostics = std::mem::take(&mut cards.diagnostics);
    let scale_mm = cards.global.unit_mm / cards.global.scale;
    if cards.global.scale != 1.0 {
        diagnostics.push(Diagnostic::note(
            "",
            format!("the model scale is {}; lengths were divided by it", cards.global.scale),
        ));
    }
    let geometry = Geometry { cards: &cards, scale_mm, used: RefCell::new(BTreeSet::new()) };
    let owned = owned_surfaces(&geometry);
    let sides = solid_sides(&geometry);
    let mut faces: Vec<Face> = Vec::new();
    let mut left = Leftovers::default();
    let mut number = 0;
    for (de, entity) in &cards.entities {
        let free = SURFACES.contains(&entity.kind) && !owned.contains(de);
        if !matches!(entity.kind, 143 | 144 | 510) && !free {
            continue;
        }
        number += 1;
        let label = format!("F{number}");
        let place = format!("{label} (DE {de})");
        geometry.used.borrow_mut().insert(*de);
        let mut findings = Vec::new();
        let made = match entity.kind {
            144 => trimmed(&geometry, *de, entity, &mut findings),
            143 => bounded(&geometry, *de, entity, &mut findings),
            510 => solid_face(&geometry, *de, entity, sides.get(de).copied()),
            _ => free_surface(&geometry, *de),
        };
        match made {
            Ok(Made { built, kind }) => {
                findings.extend(built.findings);
                diagnostics.extend(findings.into_iter().map(|f| Diagnostic::warning(&place, f)));
                faces.push(Face {
                    id: label,
                    name: entity.label.clone(),
                    entity: *de as u64,
                    kind,
                    oriented: sides.contains_key(de),
                    carrier: built.assembled.carrier,
                    surface: Arc::new(built.assembled.surface),
                });
            }
            Err(why) => {
                let kind = surface_of(&geometry, entity)
                    .map_or_else(|| kind_name(entity.kind, entity.form), |s| kind_name(s.kind, s.form));
                diagnostics.push(Diagnostic::loss(&place, format!("{kind}: {why}")));
                left.add(&kind, reason(&why));
            }
        }
    }
    leftovers(&geometry, &mut left, &mut diagnostics);
    Part {
        format: Format::Iges,
        unit: cards.global.unit_name.clone(),
        schema: cards.global.version.clone(),
        faces,
        not_used: left.into_entries(),
        truncated: cards.truncated,
        diagnostics,
    }
}

/// A reason without numbers, to count by.
fn reason(why: &FaceError) -> &'static str {
    match why {
        FaceError::Unread(Unread::Kind { .. }) => "this kind of surface or boundary curve is not read",
        FaceError::Unread(Unread::Missing { .. }) => "it points to an entity that is not in the file",
        FaceError::Unread(Unread::Malformed { .. }) => "its parameters make no surface or curve",
        FaceError::Trim(_) => "its loops limit no part of its surface",
    }
}

struct Made {
    built: Built,
    kind: FaceKind,
}

/// Surface pointer of a face entity.
fn surface_pointer(entity: &Entity) -> Option<i64> {
    let k = if entity.kind == 143 { 1 } else { 0 };
    entity.params.get(k).and_then(Param::number).map(|p| p as i64)
}

fn surface_of<'g>(geometry: &Geometry<'g>, entity: &Entity) -> Option<&'g Entity> {
    geometry.cards.entities.get(&surface_pointer(entity)?)
}

/// Surfaces that a face or another surface or curve refers to.
fn owned_surfaces(geometry: &Geometry<'_>) -> BTreeSet<i64> {
    let mut owned = BTreeSet::new();
    for entity in geometry.cards.entities.values() {
        // Where in the parameters the pointer to a surface stands.
        let k = match entity.kind {
            143 | 142 => 1,
            141 => 2,
            144 | 510 => 0,
            140 => 4,
            _ => continue,
        };
        if let Some(p) = entity.params.get(k).and_then(Param::number) {
            owned.insert(p as i64);
        }
    }
    owned
}

/// The material side of each face of a manifold solid: its outward normal along or against the surface's own.
fn solid_sides(geometry: &Geometry<'_>) -> BTreeMap<i64, Side> {
    let mut sides = BTreeMap::new();
    for (de, solid) in geometry.cards.entities.iter().filter(|e| e.1.kind == 186) {
        geometry.used.borrow_mut().insert(*de);
        let number = |k: usize| solid.params.get(k).and_then(Param::number);
        let mut shells = vec![(number(0), number(1))];
        let voids = number(2).unwrap_or(0.0).clamp(0.0, solid.params.len() as f64) as usize;
        shells.extend((0..voids).map(|k| (number(3 + 2 * k), number(4 + 2 * k))));
        for (shell, along) in shells {
            let Some(shell) = shell.and_then(|s| geometry.entity(s as i64).ok()).filter(|s| s.kind == 514)
            else {
                continue;
            };
            let n = |k: usize| shell.params.get(k).and_then(Param::number);
            let count = n(0).unwrap_or(0.0).clamp(0.0, shell.params.len() as f64) as usize;
            for k in 0..count {
                let (Some(face), Some(same)) = (n(1 + 2 * k), n(2 + 2 * k)) else { continue };
                let agrees = (same != 0.0) == (along != Some(0.0));
                sides.insert(face as i64, if agrees { Side::Along } else { Side::Against });
            }
        }
    }
    sides
}

/// Entity 144.
fn trimmed(
    geometry: &Geometry<'_>,
    de: i64,
    e: &Entity,
    findings: &mut Vec<String>,
) -> Result<Made, FaceError> {
    let motion = geometry.motion(e)?;
    let surface_de = geometry
        .pointer(de, e, 0)?
        .ok_or_else(|| Unread::Malformed { de, what: "a trimmed surface without surface".into() })?;
    let inner = geometry.count(de, e, 2, 4, 1)?;
    let outer = if geometry.number(de, e, 1)? == 0.0 { None } else { geometry.pointer(de, e, 3)? };
    let (surface, kind) = geometry.surface(surface_de, &motion)?;
    let mut loops = Vec::new();
    match outer {
        Some(curve) => loops.push(curve_on_surface(
            geometry,
            curve,
            &Target { surface: &surface, kind },
            &motion,
            findings,
        )?),
        None => loops.extend(rectangle(geometry, surface_de, &surface)),
    }
    for k in 0..inner {
        if let Some(curve) = geometry.pointer(de, e, 4 + k)? {
            loops.push(curve_on_surface(
                geometry,
                curve,
                &Target { surface: &surface, kind },
                &motion,
                findings,
            )?);
        }
    }
    // Without an outer loop the natural rectangle is the outer one: its sides are needed for the holes to be holes.
    if outer.is_none() && loops.len() == inner && inner > 0 {
        loops.push(sides(&surface));
    }
    Ok(Made { built: build(surface, &loops, Side::Along, false)?, kind })
}

/// The sides of a surface's rectangle as a loop of parameter lines.
fn sides(surface: &FaceSurface) -> Vec<Boundary> {
    let d = surface.domain();
    lines([d.u.lo, d.u.hi, d.v.lo, d.v.hi])
}

fn lines([u0, u1, v0, v1]: [f64; 4]) -> Vec<Boundary> {
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
fn rectangle(geometry: &Geometry<'_>, de: i64, surface: &FaceSurface) -> Option<Vec<Boundary>> {
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
    Some(lines([u0, u1, v0, v1]))
}

/// A surface that no face refers to.
fn free_surface(geometry: &Geometry<'_>, de: i64) -> Result<Made, FaceError> {
    let (surface, kind) = geometry.surface(de, &Motion::identity())?;
    let loops: Vec<Vec<Boundary>> = rectangle(geometry, de, &surface).into_iter().collect();
    Ok(Made { built: build(surface, &loops, Side::Along, false)?, kind })
}

/// The surface that a loop lies on. Only splines are kept with the parameters of the file.
struct Target<'a> {
    surface: &'a FaceSurface,
    kind: FaceKind,
}

/// Entity 142 as a loop.
fn curve_on_surface(
    geometry: &Geometry<'_>,
    de: i64,
    target: &Target<'_>,
    outer: &Motion,
    findings: &mut Vec<String>,
) -> Result<Vec<Boundary>, Unread> {
    let e = geometry.entity(de)?;
    if e.kind != 142 {
        return Err(Unread::Kind { de, kind: e.kind, form: e.form });
    }
    let motion = geometry.motion(e)?.then(outer);
    // A pointer that is not there is not fatal where the other curve is.
    let parameter = match geometry.pointer(de, e, 2)? {
        Some(p) => Some(geometry.pieces(p, Space::Parameter, &Motion::identity())?),
        None => None,
    };
    let model = match geometry.pointer(de, e, 3)? {
        Some(p) => Some(geometry.pieces(p, Space::Model, &motion)?),
        None => None,
    };
    choose(de, target, parameter, model, findings)
}

/// The parameter-space curve where it is usable, else the model-space one.
fn choose(
    de: i64,
    target: &Target<'_>,
    parameter: Option<Vec<Piece>>,
    model: Option<Vec<Piece>>,
    findings: &mut Vec<String>,
) -> Result<Vec<Boundary>, Unread> {
    let parameter = parameter.filter(|p| target.kind == FaceKind::Bspline && !p.is_empty());
    let model = model.filter(|m| !m.is_empty());
    let in_space =
        |pieces: Vec<Piece>| pieces.into_iter().map(|piece| Boundary::Space { piece, key: None }).collect();
    match (parameter, model) {
        (Some(p), Some(m)) => {
            let off = deviation(target.surface, &p, &m);
            if off.is_none_or(|d| d > AGREE) {
                findings.push(format!(
                    "DE {de}: the parameter-space curve does not lie on the model-space curve ({}); the \
                     model-space curve is projected",
                    off.map_or("it leaves the surface's rectangle".into(), |d| format!(
                        "off by {d:.1e} of the loop's size"
                    ))
                ));
                return Ok(in_space(m));
            }
            Ok(p.into_iter().map(|piece| Boundary::Parameter { piece }).collect())
        }
        (Some(p), None) => Ok(p.into_iter().map(|piece| Boundary::Parameter { piece }).collect()),
        (None, Some(m)) => Ok(in_space(m)),
        (None, None) => Err(Unread::Malformed { de, what: "a boundary without a usable curve".into() }),
    }
}

/// Largest distance of points of the parameter-space curve, on the surface, from the model-space curve, as a fraction
/// of its size; `None` where it leaves the rectangle.
fn deviation(surface: &FaceSurface, parameter: &[Piece], model: &[Piece]) -> Option<f64> {
    let d = surface.domain();
    let spread = |k: f64, n: f64| k / n;
    let mut box3 = Box3::empty();
    for m in model {
        for k in 0..=8 {
            box3.add(&m.point(spread(f64::from(k), 8.0)));
        }
    }
    let size = box3.diagonal_mm();
    let mut worst = 0.0_f64;
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
            let gap = |m: &Piece| (m.point(m.locate(&s)) - s).norm();
            // The nearest pieces' boxes would spare little: loops have few pieces.
            worst = worst.max(model.iter().map(gap).fold(f64::INFINITY, f64::min));
        }
    }
    Some(if size > 0.0 { worst / size } else { worst })
}

/// Entity 143 with its boundaries 141.
fn bounded(
    geometry: &Geometry<'_>,
    de: i64,
    e: &Entity,
    findings: &mut Vec<String>,
) -> Result<Made, FaceError> {
    let motion = geometry.motion(e)?;
    let surface_de = geometry
        .pointer(de, e, 1)?
        .ok_or_else(|| Unread::Malformed { de, what: "a bounded surface without surface".into() })?;
    let count = geometry.count(de, e, 2, 3, 1)?;
    let (surface, kind) = geometry.surface(surface_de, &motion)?;
    let mut loops = Vec::new();
    for k in 0..count {
        let Some(boundary) = geometry.pointer(de, e, 3 + k)? else { continue };
        let b = geometry.entity(boundary)?;
        if b.kind != 141 {
            return Err(Unread::Kind { de: boundary, kind: b.kind, form: b.form }.into());
        }
        let inner = geometry.motion(b)?.then(&motion);
        let curves = geometry.count(boundary, b, 3, 4, 3)?;
        let (mut model, mut parameter): (Vec<Piece>, Vec<Piece>) = (Vec::new(), Vec::new());
        let mut complete = true;
        let mut at = 4;
        for _ in 0..curves {
            let curve = geometry.pointer(boundary, b, at)?;
            let against = geometry.number(boundary, b, at + 1)? == 2.0;
            let pcurves = geometry.count(boundary, b, at + 2, at + 3, 1)?;
            if let Some(c) = curve {
                let mut pieces = geometry.pieces(c, Space::Model, &inner)?;
                if against {
                    pieces = pieces.iter().rev().map(Piece::reversed).collect();
                }
                model.extend(pieces);
            }
            complete &= pcurves > 0;
            for j in 0..pcurves {
                if let Some(p) = geometry.pointer(boundary, b, at + 3 + j)? {
                    parameter.extend(geometry.pieces(p, Space::Parameter, &Motion::identity())?);
                }
            }
            at += 3 + pcurves;
        }
        loops.push(choose(
            boundary,
            &Target { surface: &surface, kind },
            complete.then_some(parameter),
            Some(model),
            findings,
        )?);
    }
    Ok(Made { built: build(surface, &loops, Side::Along, false)?, kind })
}

/// Entity 510 with its loops 508 and edges 504.
fn solid_face(geometry: &Geometry<'_>, de: i64, e: &Entity, side: Option<Side>) -> Result<Made, FaceError> {
    let surface_de = geometry
        .pointer(de, e, 0)?
        .ok_or_else(|| Unread::Malformed { de, what: "a face without surface".into() })?;
    let (surface, kind) = geometry.surface(surface_de, &Motion::identity())?;
    let count = geometry.count(de, e, 1, 3, 1)?;
    let mut loops = Vec::new();
    for k in 0..count {
        let Some(loop_de) = geometry.pointer(de, e, 3 + k)? else { continue };
        let l = geometry.entity(loop_de)?;
        if l.kind != 508 {
            return Err(Unread::Kind { de: loop_de, kind: l.kind, form: l.form }.into());
        }
        let edges = geometry.count(loop_de, l, 0, 1, 5)?;
        let mut boundary = Vec::new();
        let mut at = 1;
        for _ in 0..edges {
            let is_vertex = geometry.number(loop_de, l, at)? == 1.0;
            let list = geometry.pointer(loop_de, l, at + 1)?;
            let index = geometry.number(loop_de, l, at + 2)?;
            let forward = geometry.number(loop_de, l, at + 3)? != 0.0;
            let pcurves = geometry.count(loop_de, l, at + 4, at + 5, 2)?;
            at += 5 + 2 * pcurves;
            let Some(list) = list.filter(|_| !is_vertex) else { continue };
            let edge_list = geometry.entity(list)?;
            if edge_list.kind != 504 {
                return Err(Unread::Kind { de: list, kind: edge_list.kind, form: edge_list.form }.into());
            }
            let total = geometry.count(list, edge_list, 0, 1, 5)?;
            if !(index >= 1.0 && index <= total as f64 && index.fract() == 0.0) {
                let what = format!("edge {index} of a list of {total}");
                return Err(Unread::Malformed { de: loop_de, what }.into());
            }
            let Some(curve) = geometry.pointer(list, edge_list, 1 + 5 * (index as usize - 1))? else {
                return Err(Unread::Malformed { de: list, what: format!("edge {index} has no curve") }.into());
            };
            let pieces = geometry.pieces(curve, Space::Model, &Motion::identity())?;
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
        loops.push(boundary);
    }
    Ok(Made { built: build(surface, &loops, side.unwrap_or_default(), true)?, kind })
}

/// Counts entities of shape that no face uses.
fn leftovers(geometry: &Geometry<'_>, left: &mut Leftovers, diagnostics: &mut Vec<Diagnostic>) {
    let used = geometry.used.borrow();
    let mut placed = 0;
    for (de, e) in &geometry.cards.entities {
        if used.contains(de) {
            continue;
        }
        let why = match e.kind {
            100..=106 | 110 | 112 | 116 | 126 | 130 | 142 => "no face uses it",
            108 | 140 | 190..=198 => "a surface without a boundary that is read",
            114 | 118 | 120 | 122 | 128 | 143 | 144 | 510 => continue,
            150..=184 | 430 => "solids by construction are not read",
            408 | 420 => {
                placed += 1;
                "placed instances are not put together"
            }
            200..=299 => "annotation",
            _ => continue,
        };
        left.add(&kind_name(e.kind, 0), why);
    }
    if placed > 0 {
        diagnostics.push(Diagnostic::warning(
            "",
            format!(
                "the file places {placed} instances of subfigures; every face is given once, in the coordinates of \
                 its definition"
            ),
        ));
    }
}
