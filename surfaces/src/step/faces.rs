//! Faces of a Part 21 file: loops, edges, senses, and what of the file is left over.
//!
//! Senses. A face's normal is its surface's, turned over where `same_sense` is false, and points out of the material;
//! an oriented shell that is reversed turns its faces over again. Seen along the normal a loop has the face on its
//! left, a bound whose orientation is false is walked backwards.

use super::bodies::structure;
use super::colour::colours;
use super::geometry::{Geometry, Unread};
use super::graph::{Args, Graph, Record, arg};
use super::rectangle::rectangle;
use super::structure::is_face;
use super::units::Contexts;
use super::unused;
use super::walk::{Occurrence, occurrences};
use crate::leftovers::{Leftovers, MAX_COPIES, too_many_copies};
use crate::part::{Face, FaceKind, Format, Part};
use crate::trim::boundary::{Boundary, Built, build};
use crate::trim::carrier::PlaceError;
use crate::trim::curve::{Curve, Line, Piece};
use osculate_geom::{Box3, Diagnostic, Point3, Side};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// Builds the part of a record graph.
pub(crate) fn part(mut graph: Graph<'_>) -> Part {
    let mut diagnostics = std::mem::take(&mut graph.diagnostics);
    let graph = &graph;
    let contexts = Contexts::read(graph);
    let found = occurrences(graph, &contexts, &mut diagnostics);
    if contexts.names().is_empty() && !found.faces.is_empty() {
        diagnostics.push(Diagnostic::warning("", "the file states no length unit; millimetres are assumed"));
    }
    let colours = colours(graph);
    // Every face once in its own coordinates, however often it is placed.
    let mut index: HashMap<(u64, bool, Option<usize>), usize> = HashMap::new();
    let mut own: Vec<&Occurrence> = Vec::new();
    for o in &found.faces {
        index.entry((o.face, o.turned, o.context)).or_insert_with(|| {
            own.push(o);
            own.len() - 1
        });
    }
    let read: Vec<Result<Made, FaceError>> = own
        .par_iter()
        .map(|o| {
            let geometry = Geometry::new(graph, contexts.units(o.context));
            face(&geometry, o)
        })
        .collect();
    let mut left = Leftovers::default();
    let mut told = vec![false; read.len()];
    let mut faces = Vec::with_capacity(found.faces.len());
    let mut kept = Vec::with_capacity(found.faces.len());
    let (mut copied, mut left_out) = (0, 0_usize);
    for (number, o) in found.faces.iter().enumerate() {
        let label = format!("F{}", number + 1);
        let Some(k) = index.get(&(o.face, o.turned, o.context)).copied() else { continue };
        let first = !std::mem::replace(&mut told[k], true);
        let place = || format!("{label} ({})", graph.place(o.face));
        let placed = match &read[k] {
            Ok(made) => {
                copied += if first { 0 } else { made.face.copy_bytes() };
                if copied > MAX_COPIES {
                    left_out += 1;
                    continue;
                }
                if first {
                    diagnostics.extend(made.findings.iter().map(|f| Diagnostic::warning(place(), f.clone())));
                }
                made.face
                    .placed(o.motion.as_ref(), o.place as u64)
                    .map_err(|why| FaceError::Placed(why).to_string())
            }
            Err(why) => Err(why.to_string()),
        };
        match placed {
            Ok(mut face) => {
                face.id = label;
                face.product = o.product().to_owned();
                face.colour = colours.get(&o.face).or_else(|| colours.get(&o.item?)).copied();
                faces.push(face);
                kept.push(o);
            }
            Err(why) => {
                let record = graph.peek(o.face);
                let kind = record.map_or_else(|| "face".to_owned(), |r| surface_kind(graph, &r));
                diagnostics.push(Diagnostic::loss(place(), format!("{kind}: {why}")));
                let line = record.map_or(0, |r| graph.line(r.at()));
                left.add_at(&kind, read[k].as_ref().err().map_or("it cannot be placed", reason), line);
            }
        }
    }
    if left_out > 0 {
        diagnostics.push(too_many_copies(left_out));
    }
    let structure = structure(graph, kept.into_iter().zip(faces.iter().map(|f: &Face| f.id.as_str())));
    unused::leftovers(graph, &mut left);
    Part {
        structure,
        format: Format::Step,
        unit: contexts.names(),
        uncertainty_mm: contexts.uncertainty_mm(),
        schema: graph.schemas.join(", "),
        faces,
        not_used: left.into_entries(),
        truncated: graph.truncated || found.cut_short || left_out > 0,
        diagnostics,
    }
}

/// A reason without numbers, to count by.
fn reason(why: &FaceError) -> &'static str {
    match why {
        FaceError::Unread(Unread::Kind { .. }) => "this kind of surface or edge curve is not read",
        FaceError::Unread(Unread::Missing { .. }) => "it refers to a record that is not in the file",
        FaceError::Unread(Unread::Malformed { .. }) => "its parameters make no surface or curve",
        FaceError::Trim(_) => "its loops limit no part of its surface",
        FaceError::Placed(_) => "it cannot be placed",
    }
}

/// The keyword of a face's surface.
fn surface_kind(graph: &Graph<'_>, face: &Record<'_>) -> String {
    let surface = if is_face(face) {
        face.all_args().find_map(|a| arg(&a, 2).reference()).and_then(|s| graph.get(s))
    } else {
        Some(*face)
    };
    let Some(surface) = surface else { return "face without surface".into() };
    // Of a complex record the part that tells most.
    let known = ["B_SPLINE_SURFACE_WITH_KNOTS", "RATIONAL_B_SPLINE_SURFACE", "B_SPLINE_SURFACE"];
    known.into_iter().find(|k| surface.is(k)).map_or_else(|| surface.kind(), str::to_owned)
}

#[derive(Debug, thiserror::Error)]
enum FaceError {
    #[error(transparent)]
    Unread(#[from] Unread),
    #[error(transparent)]
    Trim(#[from] crate::trimmed::TrimError),
    #[error(transparent)]
    Placed(PlaceError),
}

/// A face in its own coordinates, and what its boundary gave reason to say.
struct Made {
    face: Face,
    findings: Vec<String>,
}

/// An edge with both vertices at one end of an open curve is taken as straight up to this fraction of the curve's size.
const SHORT_EDGE: f64 = 1e-4;

/// Vertices nearer than this fraction of the face's size are one: writers keep seven digits or more.
const SAME_VERTEX: f64 = 1e-6;

fn face(geometry: &Geometry<'_>, occurrence: &Occurrence) -> Result<Made, FaceError> {
    let id = occurrence.face;
    let record = geometry.graph.get(id).ok_or(Unread::Missing { id })?;
    let Some((_, args)) = record.any(&["ADVANCED_FACE", "FACE_SURFACE"]) else {
        return free_surface(geometry, occurrence);
    };
    // A complex record has the name and bounds elsewhere; only the simple form occurs in files.
    let surface_id = arg(&args, 2)
        .reference()
        .ok_or_else(|| Unread::Malformed { id, what: "a face without a reference to its surface".into() })?;
    let same_sense = arg(&args, 3).flag().unwrap_or(true);
    let mut loops: Vec<Vec<Edge>> = Vec::new();
    for bound in arg(&args, 1).list().references() {
        loops.extend(bound_edges(geometry, bound)?);
    }
    let reach: Vec<Point3> =
        loops.iter().flatten().flat_map(|e| (0..=8).map(|k| e.piece.point(f64::from(k) / 8.0))).collect();
    let carried = geometry.surface(surface_id, &reach, 0)?;
    let straight: Vec<String> = loops
        .iter()
        .flatten()
        .filter_map(|e| Some((e.key?, e.straight_mm?)))
        .map(|(k, mm)| {
            format!("the curve of edge #{k} ends before it; a straight line of {mm:.3e} mm stands for it")
        })
        .collect();
    // The loops are on the left seen along the face's normal; the builder wants them so along the carrier's.
    let along = same_sense != carried.reversed;
    let bounds: Vec<Vec<Boundary>> = loops
        .into_iter()
        .map(|edges| {
            let directed = edges.into_iter().map(|e| Boundary::Space {
                piece: if along { e.piece } else { e.piece.reversed() },
                key: e.key,
            });
            if along { directed.collect() } else { directed.rev().collect() }
        })
        .collect();
    let side = if along != occurrence.turned { Side::Along } else { Side::Against };
    let mut built = build(carried.surface, &bounds, side, true)?;
    built.findings.extend(straight);
    Ok(made(occurrence, arg(&args, 0).text(), carried.kind, built))
}

fn made(occurrence: &Occurrence, name: String, kind: FaceKind, built: Built) -> Made {
    let face = Face {
        id: String::new(),
        name,
        product: String::new(),
        colour: None,
        entity: occurrence.face,
        kind,
        oriented: true,
        carrier: built.assembled.carrier,
        surface: Arc::new(built.assembled.surface),
    };
    Made { face, findings: built.findings }
}

/// A bounded surface of a geometric set as a face; nothing says where its material is.
fn free_surface(geometry: &Geometry<'_>, occurrence: &Occurrence) -> Result<Made, FaceError> {
    let id = occurrence.face;
    let record = geometry.graph.get(id).ok_or(Unread::Missing { id })?;
    let mut reach = Vec::new();
    let loops = if let Some(args) = record.part("CURVE_BOUNDED_SURFACE") {
        let curves = arg(&args, 2).list().references();
        curves.map(|c| boundary_curve(geometry, c)).collect::<Result<Vec<_>, _>>()?
    } else if let Some(args) = record.part("RECTANGULAR_TRIMMED_SURFACE") {
        let rectangle = rectangle(geometry, id, &args)?;
        reach = rectangle.reach;
        vec![rectangle.sides]
    } else {
        Vec::new()
    };
    let carried = geometry.surface(id, &reach, 0)?;
    // Boundary curves have the surface on their left, seen against its normal (ISO 10303-42, curve_bounded_surface).
    let built = build(carried.surface, &loops, Side::Along, true)?;
    let mut made = made(occurrence, String::new(), carried.kind, built);
    made.face.oriented = false;
    Ok(made)
}

/// The pieces of a boundary curve of a CURVE_BOUNDED_SURFACE.
fn boundary_curve(geometry: &Geometry<'_>, id: u64) -> Result<Vec<Boundary>, Unread> {
    let record = geometry.record(id)?;
    let kinds = [
        "BOUNDARY_CURVE",
        "OUTER_BOUNDARY_CURVE",
        "COMPOSITE_CURVE_ON_SURFACE",
        "COMPOSITE_CURVE",
        "DEGENERATE_PCURVE",
    ];
    let (_, args) = record.any(&kinds).ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
    let mut pieces = Vec::new();
    for segment in arg(&args, 1).list().references() {
        let (curve, forward) = geometry.segment(segment)?;
        let endless = || Unread::Malformed { id: curve, what: "a boundary without ends".into() };
        let parameter = geometry.pcurve(&geometry.record(curve)?, 0)?;
        let in_plane = parameter.is_some();
        let curve = match parameter {
            Some((_, flat)) => flat,
            None => geometry.curve(curve, 0)?,
        };
        let piece = Piece::whole(curve).ok_or_else(endless)?;
        let piece = if forward { piece } else { piece.reversed() };
        pieces.push(if in_plane {
            Boundary::Parameter { piece }
        } else {
            Boundary::Space { piece, key: None }
        });
    }
    Ok(pieces)
}

/// An edge in the sense of its loop.
struct Edge {
    piece: Piece,
    key: Option<u64>,
    /// Length of an edge whose curve does not reach between its vertices, mm; a straight line stands for it.
    straight_mm: Option<f64>,
}

/// The edges of a FACE_BOUND; `None` for a loop that is a single vertex.
fn bound_edges(geometry: &Geometry<'_>, id: u64) -> Result<Option<Vec<Edge>>, Unread> {
    let graph = geometry.graph;
    let record = graph.get(id).ok_or(Unread::Missing { id })?;
    let args = record
        .part("FACE_BOUND")
        .or_else(|| record.part("FACE_OUTER_BOUND"))
        .ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
    let loop_id = arg(&args, 1)
        .reference()
        .ok_or_else(|| Unread::Malformed { id, what: "a bound without loop".into() })?;
    let forward = arg(&args, 2).flag().unwrap_or(true);
    let record = graph.get(loop_id).ok_or(Unread::Missing { id: loop_id })?;
    let mut edges = if let Some(args) = record.part("EDGE_LOOP") {
        let mut edges = Vec::new();
        for oriented in arg(&args, 1).list().references() {
            edges.extend(oriented_edge(geometry, oriented)?);
        }
        edges
    } else if let Some(args) = record.part("POLY_LOOP") {
        polygon(geometry, loop_id, &arg(&args, 1).list())?
    } else if record.is("VERTEX_LOOP") {
        return Ok(None);
    } else {
        return Err(Unread::Kind { id: loop_id, kind: record.kind() });
    };
    if !forward {
        edges.reverse();
        for e in &mut edges {
            e.piece = e.piece.reversed();
        }
    }
    Ok(Some(edges))
}

/// The straight edges of a POLY_LOOP.
fn polygon(geometry: &Geometry<'_>, id: u64, values: &Args<'_>) -> Result<Vec<Edge>, Unread> {
    let points: Vec<Point3> = values.references().map(|p| geometry.point(p)).collect::<Result<_, _>>()?;
    if points.len() < 3 {
        return Err(Unread::Malformed { id, what: format!("a polygon of {} points", points.len()) });
    }
    let n = points.len();
    let sides = (0..n).map(|k| (points[k], points[(k + 1) % n])).filter(|(a, b)| a != b);
    Ok(sides
        .map(|(a, b)| Edge {
            piece: Piece { curve: Arc::new(Line::segment(a, b)), ends: [0.0, 1.0] },
            key: None,
            straight_mm: None,
        })
        .collect())
}

/// An ORIENTED_EDGE; `None` for an edge of no length.
fn oriented_edge(geometry: &Geometry<'_>, id: u64) -> Result<Option<Edge>, Unread> {
    let graph = geometry.graph;
    let record = graph.get(id).ok_or(Unread::Missing { id })?;
    // Some writers put the edge itself into the loop.
    let (edge_id, forward) = match record.part("ORIENTED_EDGE") {
        Some(args) => {
            let malformed = || Unread::Malformed { id, what: "an oriented edge without edge".into() };
            (arg(&args, 3).reference().ok_or_else(malformed)?, arg(&args, 4).flag().unwrap_or(true))
        }
        None => (id, true),
    };
    let record = graph.get(edge_id).ok_or(Unread::Missing { id: edge_id })?;
    let args = record.part("EDGE_CURVE").ok_or_else(|| Unread::Kind { id: edge_id, kind: record.kind() })?;
    let end = |k: usize| {
        let malformed = || Unread::Malformed { id: edge_id, what: "an edge without vertices".into() };
        geometry.vertex(arg(&args, k).reference().ok_or_else(malformed)?)
    };
    let ends = [end(1)?, end(2)?];
    let curve_id = arg(&args, 3)
        .reference()
        .ok_or_else(|| Unread::Malformed { id: edge_id, what: "an edge without curve".into() })?;
    let curve = geometry.curve(curve_id, 0)?;
    let same_sense = arg(&args, 4).flag().unwrap_or(true);
    // Identity of vertices is exact in the file; the slack is for writers that repeat a vertex.
    let one_vertex = arg(&args, 1).reference() == arg(&args, 2).reference();
    let range = curve.range();
    let sample = if range.iter().all(|t| t.is_finite()) {
        Box3::around(&[0.0, 0.25, 0.5, 0.75].map(|f| curve.point(range[0] + f * (range[1] - range[0]))))
            .diagonal_mm()
    } else {
        (ends[1] - ends[0]).norm()
    };
    let slack =
        if one_vertex { 1e-9 * sample } else { (SAME_VERTEX * sample).min(0.1 * (ends[1] - ends[0]).norm()) };
    let chord_mm = (ends[1] - ends[0]).norm();
    match Piece::between(curve, ends, same_sense, slack) {
        Some(piece) => {
            let piece = if forward { piece } else { piece.reversed() };
            Ok(Some(Edge { piece, key: Some(edge_id), straight_mm: None }))
        }
        // Both ends at one place of an open curve.
        None if one_vertex => Ok(None),
        // Both vertices at or just beyond one end of the curve: the way between them is straight for all that the file
        // says.
        None if chord_mm > 0.0 && chord_mm <= SHORT_EDGE * sample => {
            let [a, b] = if forward { ends } else { [ends[1], ends[0]] };
            let piece = Piece { curve: Arc::new(Line::segment(a, b)), ends: [0.0, 1.0] };
            Ok(Some(Edge { piece, key: Some(edge_id), straight_mm: Some(chord_mm) }))
        }
        None => {
            Err(Unread::Malformed { id: edge_id, what: "both ends at one place of an open curve".into() })
        }
    }
}
