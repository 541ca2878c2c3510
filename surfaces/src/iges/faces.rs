//! Faces of an IGES file: trimmed (144), bounded (143) and free surfaces, and the faces (510) of shells and solids.

use super::directory::Entity;
use super::geometry::{Geometry, Space, Unread};
use super::loops::{Target, boundary, curve_on_surface, edge_loop, open_by, own_rectangle, reversed, sides};
use super::tree::Placed;
use crate::part::FaceKind;
use crate::trim::boundary::{Boundary, Built, build};
use crate::trim::carrier::FaceSurface;
use crate::trim::motion::Motion;
use crate::trimmed::TrimError;
use osculate_geom::{Side, Surface};

/// Why an entity is no face.
#[derive(Debug, thiserror::Error)]
pub(super) enum FaceError {
    #[error(transparent)]
    Unread(#[from] Unread),
    #[error(transparent)]
    Trim(#[from] TrimError),
}

impl FaceError {
    /// The reason without numbers, to count by.
    pub(super) const fn reason(&self) -> &'static str {
        match self {
            Self::Unread(Unread::Kind { .. }) => "this kind of surface or boundary curve is not read",
            Self::Unread(Unread::Missing { .. }) => "it points to an entity that is not in the file",
            Self::Unread(Unread::Malformed { .. }) => "its parameters make no surface or curve",
            Self::Unread(Unread::Unlimited { .. }) => "it has no ends and nothing bounds it",
            Self::Trim(_) => "its loops limit no part of its surface",
        }
    }
}

/// A face.
pub(super) struct Made {
    pub(super) built: Built,
    pub(super) kind: FaceKind,
}

/// The face of an entity in one of its places.
pub(super) fn face(geometry: &Geometry<'_>, de: i64, placed: &Placed) -> Result<Made, FaceError> {
    let e = geometry.entity(de)?;
    match e.kind {
        144 => trimmed(geometry, de, e, &placed.motion),
        143 => bounded(geometry, de, e, &placed.motion),
        510 => solid_face(geometry, de, e, placed),
        108 if e.form == 1 => bounded_plane(geometry, de, e, &placed.motion),
        _ => free_surface(geometry, de, &placed.motion),
    }
}

/// The loops that are loops; the others are told and left out. The first is the outer one where `outer`.
fn closed(
    geometry: &Geometry<'_>,
    surface: &FaceSurface,
    loops: Vec<Vec<Boundary>>,
    outer: bool,
) -> Vec<Vec<Boundary>> {
    loops
        .into_iter()
        .enumerate()
        .filter(|(k, l)| match open_by(surface, l) {
            None => true,
            Some(gap_mm) => {
                geometry.say(if outer && *k == 0 {
                    format!(
                        "its outer loop has a gap of {gap_mm:.3e} mm and bounds nothing; the whole surface is the face"
                    )
                } else {
                    format!("a loop has a gap of {gap_mm:.3e} mm and bounds nothing; it is left out, a hole is closed")
                });
                false
            }
        })
        .map(|l| l.1)
        .collect()
}

/// Entity 144.
fn trimmed(geometry: &Geometry<'_>, de: i64, e: &Entity, outer: &Motion) -> Result<Made, FaceError> {
    let motion = geometry.motion(e)?.then(outer);
    let surface_de = geometry.required(de, e, 0, "surface")?;
    let inner = geometry.count(de, e, 2, [4, 1])?;
    let limit = if geometry.number(de, e, 1)? == 0.0 { None } else { geometry.pointer(de, e, 3)? };
    let (surface, kind) = geometry.surface(surface_de, &motion)?;
    let target = Target { surface: &surface, parameters: geometry.parameters(surface_de)?, motion: &motion };
    let mut loops = Vec::new();
    if let Some(curve) = limit {
        loops.push(curve_on_surface(geometry, curve, &target)?);
    }
    for k in 0..inner {
        if let Some(curve) = geometry.pointer(de, e, 4 + k)? {
            loops.push(curve_on_surface(geometry, curve, &target)?);
        }
    }
    let given = loops.len();
    let mut loops = closed(geometry, &surface, loops, limit.is_some());
    // Without an outer loop the natural rectangle is the outer one: its sides are needed for the holes to be holes.
    if limit.is_none() || loops.len() < given {
        match own_rectangle(geometry, surface_de, &surface) {
            Some(own) => loops.push(own),
            None if !loops.is_empty() => loops.push(rim(&surface)),
            None => {}
        }
    }
    Ok(Made { built: build(surface, &loops, Side::Along, false)?, kind })
}

/// The sides of a surface's rectangle as a loop of parameter lines.
fn rim(surface: &FaceSurface) -> Vec<Boundary> {
    let d = surface.domain();
    sides([d.u.lo, d.u.hi, d.v.lo, d.v.hi])
}

/// A surface that no face refers to.
fn free_surface(geometry: &Geometry<'_>, de: i64, outer: &Motion) -> Result<Made, FaceError> {
    if let Some(why) = geometry.unlimited(de) {
        return Err(why.into());
    }
    let (surface, kind) = geometry.surface(de, outer)?;
    let loops: Vec<Vec<Boundary>> = own_rectangle(geometry, de, &surface).into_iter().collect();
    Ok(Made { built: build(surface, &loops, Side::Along, false)?, kind })
}

/// Entity 108, form 1: a plane and a closed curve.
fn bounded_plane(geometry: &Geometry<'_>, de: i64, e: &Entity, outer: &Motion) -> Result<Made, FaceError> {
    let (surface, kind) = geometry.surface(de, outer)?;
    let motion = geometry.motion(e)?.then(outer);
    let curve = geometry.required(de, e, 4, "bounding curve")?;
    let pieces = geometry.pieces(curve, Space::Model, &motion)?;
    let l = pieces.into_iter().map(|piece| Boundary::Space { piece, key: None }).collect();
    Ok(Made { built: build(surface, &[l], Side::Along, false)?, kind })
}

/// Entity 143 with its boundaries 141.
fn bounded(geometry: &Geometry<'_>, de: i64, e: &Entity, outer: &Motion) -> Result<Made, FaceError> {
    let motion = geometry.motion(e)?.then(outer);
    let surface_de = geometry.required(de, e, 1, "surface")?;
    let count = geometry.count(de, e, 2, [3, 1])?;
    let (surface, kind) = geometry.surface(surface_de, &motion)?;
    let target = Target { surface: &surface, parameters: geometry.parameters(surface_de)?, motion: &motion };
    let mut loops = Vec::new();
    for k in 0..count {
        if let Some(b) = geometry.pointer(de, e, 3 + k)? {
            loops.push(boundary(geometry, b, &target)?);
        }
    }
    let loops = closed(geometry, &surface, loops, true);
    Ok(Made { built: build(surface, &loops, Side::Along, false)?, kind })
}

/// Entity 510 with its loops.
fn solid_face(geometry: &Geometry<'_>, de: i64, e: &Entity, placed: &Placed) -> Result<Made, FaceError> {
    let motion = geometry.motion(e)?.then(&placed.motion);
    let surface_de = geometry.required(de, e, 0, "surface")?;
    let (surface, kind) = geometry.surface(surface_de, &motion)?;
    // A mirror image has its loops the other way round, seen against its normal, and its normal turned.
    let mirrored = motion.linear.determinant() < 0.0;
    let side = placed.side.unwrap_or_default();
    let side = if mirrored { side.flipped() } else { side };
    let mut loops = Vec::new();
    for k in 0..geometry.count(de, e, 1, [3, 1])? {
        let Some(loop_de) = geometry.pointer(de, e, 3 + k)? else { continue };
        let l = edge_loop(geometry, loop_de, &motion)?;
        // A loop of a vertex alone, on a pole or a closed surface, bounds nothing.
        if !l.is_empty() {
            loops.push(if mirrored { reversed(l) } else { l });
        }
    }
    Ok(Made { built: build(surface, &loops, side, true)?, kind })
}
