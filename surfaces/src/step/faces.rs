//! Faces of a Part 21 file: loops, edges, senses, and what of the file is left over.
//!
//! Senses. A face's normal is its surface's, turned over where `same_sense` is false, and points out of the material;
//! an oriented shell that is reversed turns its faces over again. Seen along the normal a loop has the face on its
//! left, a bound whose orientation is false is walked backwards.

use super::geometry::{Geometry, Unread};
use super::graph::{Graph, Record, Value, arg};
use super::units::{Contexts, Units, is_face};
use crate::part::{Face, Format, Leftovers, Part};
use crate::trim::boundary::{Boundary, build};
use crate::trim::curve::{Curve, Line, Piece};
use osculate_geom::{Box3, Diagnostic, Point3, Side};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Builds the part of a record graph.
pub(crate) fn part(mut graph: Graph) -> Part {
    let mut diagnostics = std::mem::take(&mut graph.diagnostics);
    let contexts = Contexts::read(&graph);
    let mut left = Leftovers::default();
    let turned = reversed_faces(&graph);
    let mut faces = Vec::new();
    let list: Vec<&(u64, Record)> = graph.records.iter().filter(|r| is_face(&r.1)).collect();
    if contexts.names().is_empty() && !list.is_empty() {
        diagnostics.push(Diagnostic::warning("", "the file states no length unit; millimetres are assumed"));
    }
    for (number, (id, record)) in list.into_iter().enumerate() {
        let geometry = Geometry { graph: &graph, units: contexts.of(*id) };
        let label = format!("F{}", number + 1);
        match face(&geometry, *id, record, turned.contains(id), &label) {
            Ok((face, findings)) => {
                let place = format!("{label} (#{id})");
                diagnostics.extend(findings.into_iter().map(|f| Diagnostic::warning(&place, f)));
                faces.push(face);
            }
            Err(why) => {
                let kind = surface_kind(&graph, record);
                diagnostics.push(Diagnostic::loss(format!("{label} (#{id})"), format!("{kind}: {why}")));
                left.add(&kind, reason(&why));
            }
        }
    }
    leftovers(&graph, &mut left, &mut diagnostics);
    Part {
        format: Format::Step,
        unit: contexts.names(),
        schema: graph.schemas.join(", "),
        faces,
        not_used: left.into_entries(),
        truncated: graph.truncated,
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
    }
}

/// The keyword of a face's surface.
fn surface_kind(graph: &Graph, face: &Record) -> String {
    let surface = face.parts.iter().find_map(|p| arg(&p.1, 2).reference()).and_then(|s| graph.get(s));
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
}

/// Vertices nearer than this fraction of the face's size are one: writers keep seven digits or more.
const SAME_VERTEX: f64 = 1e-6;

fn face(
    geometry: &Geometry<'_>,
    id: u64,
    record: &Record,
    turned: bool,
    label: &str,
) -> Result<(Face, Vec<String>), FaceError> {
    let args = record
        .part("ADVANCED_FACE")
        .filter(|a| !a.is_empty())
        .or_else(|| record.part("FACE_SURFACE").filter(|a| !a.is_empty()))
        .unwrap_or_default();
    // A complex record has the name and bounds elsewhere; only the simple form occurs in files.
    let surface_id = arg(args, 2)
        .reference()
        .ok_or_else(|| Unread::Malformed { id, what: "a face without a reference to its surface".into() })?;
    let same_sense = arg(args, 3).flag().unwrap_or(true);
    let mut loops: Vec<Vec<Edge>> = Vec::new();
    for bound in arg(args, 1).list().iter().filter_map(Value::reference) {
        loops.extend(bound_edges(geometry, bound)?);
    }
    let reach: Vec<Point3> =
        loops.iter().flatten().flat_map(|e| (0..=8).map(|k| e.piece.point(f64::from(k) / 8.0))).collect();
    let carried = geometry.surface(surface_id, &reach, 0)?;
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
    let side = if along != turned { Side::Along } else { Side::Against };
    let built = build(carried.surface, &bounds, side, true)?;
    let face = Face {
        id: label.to_owned(),
        name: arg(args, 0).text().to_owned(),
        entity: id,
        kind: carried.kind,
        oriented: true,
        carrier: built.assembled.carrier,
        surface: Arc::new(built.assembled.surface),
    };
    Ok((face, built.findings))
}

/// An edge in the sense of its loop.
struct Edge {
    piece: Piece,
    key: Option<u64>,
}

/// The edges of a FACE_BOUND; `None` for a loop that is a single vertex.
fn bound_edges(geometry: &Geometry<'_>, id: u64) -> Result<Option<Vec<Edge>>, Unread> {
    let graph = geometry.graph;
    let record = graph.get(id).ok_or(Unread::Missing { id })?;
    let args = record
        .part("FACE_BOUND")
        .or_else(|| record.part("FACE_OUTER_BOUND"))
        .ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
    let loop_id = arg(args, 1)
        .reference()
        .ok_or_else(|| Unread::Malformed { id, what: "a bound without loop".into() })?;
    let forward = arg(args, 2).flag().unwrap_or(true);
    let record = graph.get(loop_id).ok_or(Unread::Missing { id: loop_id })?;
    let mut edges = if let Some(args) = record.part("EDGE_LOOP") {
        let mut edges = Vec::new();
        for oriented in arg(args, 1).list().iter().filter_map(Value::reference) {
            edges.extend(oriented_edge(geometry, oriented)?);
        }
        edges
    } else if let Some(args) = record.part("POLY_LOOP") {
        polygon(geometry, loop_id, arg(args, 1).list())?
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
fn polygon(geometry: &Geometry<'_>, id: u64, values: &[Value]) -> Result<Vec<Edge>, Unread> {
    let points: Vec<Point3> =
        values.iter().filter_map(Value::reference).map(|p| geometry.point(p)).collect::<Result<_, _>>()?;
    if points.len() < 3 {
        return Err(Unread::Malformed { id, what: format!("a polygon of {} points", points.len()) });
    }
    let n = points.len();
    let sides = (0..n).map(|k| (points[k], points[(k + 1) % n])).filter(|(a, b)| a != b);
    Ok(sides
        .map(|(a, b)| Edge {
            piece: Piece { curve: Arc::new(Line::segment(a, b)), ends: [0.0, 1.0] },
            key: None,
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
            (arg(args, 3).reference().ok_or_else(malformed)?, arg(args, 4).flag().unwrap_or(true))
        }
        None => (id, true),
    };
    let record = graph.get(edge_id).ok_or(Unread::Missing { id: edge_id })?;
    let args = record.part("EDGE_CURVE").ok_or_else(|| Unread::Kind { id: edge_id, kind: record.kind() })?;
    let end = |k: usize| {
        let malformed = || Unread::Malformed { id: edge_id, what: "an edge without vertices".into() };
        geometry.vertex(arg(args, k).reference().ok_or_else(malformed)?)
    };
    let ends = [end(1)?, end(2)?];
    let curve_id = arg(args, 3)
        .reference()
        .ok_or_else(|| Unread::Malformed { id: edge_id, what: "an edge without curve".into() })?;
    let curve = geometry.curve(curve_id, 0)?;
    let same_sense = arg(args, 4).flag().unwrap_or(true);
    // Identity of vertices is exact in the file; the slack is for writers that repeat a vertex.
    let one_vertex = arg(args, 1).reference() == arg(args, 2).reference();
    let range = curve.range();
    let sample = if range.iter().all(|t| t.is_finite()) {
        Box3::around(&[0.0, 0.25, 0.5, 0.75].map(|f| curve.point(range[0] + f * (range[1] - range[0]))))
            .diagonal_mm()
    } else {
        (ends[1] - ends[0]).norm()
    };
    let slack =
        if one_vertex { 1e-9 * sample } else { (SAME_VERTEX * sample).min(0.1 * (ends[1] - ends[0]).norm()) };
    match Piece::between(curve, ends, same_sense, slack) {
        Some(piece) => {
            let piece = if forward { piece } else { piece.reversed() };
            Ok(Some(Edge { piece, key: Some(edge_id) }))
        }
        // Both ends at one place of an open curve.
        None if one_vertex => Ok(None),
        None => {
            Err(Unread::Malformed { id: edge_id, what: "both ends at one place of an open curve".into() })
        }
    }
}

/// Faces that reversed shells or oriented faces turn over.
fn reversed_faces(graph: &Graph) -> BTreeSet<u64> {
    let mut turned = BTreeSet::new();
    let mut flip = |id: u64| {
        if !turned.insert(id) {
            turned.remove(&id);
        }
    };
    for (_, record) in &graph.records {
        for keyword in ["ORIENTED_CLOSED_SHELL", "ORIENTED_OPEN_SHELL", "ORIENTED_FACE"] {
            let Some(args) = record.part(keyword) else { continue };
            if arg(args, 3).flag() != Some(false) {
                continue;
            }
            let Some(target) = arg(args, 2).reference() else { continue };
            if keyword == "ORIENTED_FACE" {
                flip(target);
            } else if let Some(shell) = graph.get(target) {
                let faces =
                    shell.part("CLOSED_SHELL").or_else(|| shell.part("OPEN_SHELL")).unwrap_or_default();
                arg(faces, 1).list().iter().filter_map(Value::reference).for_each(&mut flip);
            }
        }
    }
    turned
}

/// Kinds of shape items that are containers of faces, or say nothing about shape.
const CONTAINERS: [&str; 11] = [
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
    "AXIS2_PLACEMENT_3D",
    "AXIS2_PLACEMENT_2D",
    "CARTESIAN_TRANSFORMATION_OPERATOR_3D",
    "OPEN_SHELL",
    "CLOSED_SHELL",
    "CONNECTED_FACE_SET",
];

/// Counts shape items that hold no readable face, and placed instances.
fn leftovers(graph: &Graph, left: &mut Leftovers, diagnostics: &mut Vec<Diagnostic>) {
    for (_, record) in &graph.records {
        let Some((_, args)) = record.parts.iter().find(|p| p.0.ends_with("SHAPE_REPRESENTATION")) else {
            continue;
        };
        for item in arg(args, 1).list().iter().filter_map(Value::reference).filter_map(|i| graph.get(i)) {
            if item.is("MAPPED_ITEM") || CONTAINERS.iter().any(|k| item.is(k)) || is_face(item) {
                continue;
            }
            left.add(&item.kind(), "a shape item without faces that carry surfaces");
        }
    }
    let plain_faces = graph.records.iter().filter(|r| r.1.part("FACE").is_some_and(|a| a.len() == 2)).count();
    if plain_faces > 0 {
        left.add_many("FACE", plain_faces, "a face without surface");
    }
    let placed = graph.records.iter().filter(|r| moves(graph, &r.1)).count();
    if placed > 0 {
        left.add_many(
            "placed instance",
            placed,
            "assemblies are not put together: faces stay in their own part's frame",
        );
        diagnostics.push(Diagnostic::warning(
            "",
            format!(
                "the file moves {placed} instances of parts to their places; every face is given once, in the \
                 coordinates of the part that it belongs to. Export one body to have its parts in place"
            ),
        ));
    }
}

/// Whether a record places a part somewhere else than where its own coordinates say.
fn moves(graph: &Graph, record: &Record) -> bool {
    let pair = if let Some(args) = record.part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") {
        let transformation = args.iter().rev().find_map(Value::reference).and_then(|t| graph.get(t));
        transformation
            .and_then(|t| t.part("ITEM_DEFINED_TRANSFORMATION"))
            .map(|t| [arg(t, 2).reference(), arg(t, 3).reference()])
    } else if let Some(args) = record.part("MAPPED_ITEM") {
        let source = arg(args, 1).reference().and_then(|m| graph.get(m));
        source
            .and_then(|m| m.part("REPRESENTATION_MAP"))
            .map(|m| [arg(m, 0).reference(), arg(args, 2).reference()])
    } else {
        return false;
    };
    let units = Units { length_mm: 1.0, angle_rad: 1.0, name: String::new() };
    let geometry = Geometry { graph, units };
    let frame = |id: Option<u64>| geometry.placement(id?).ok();
    match pair.map(|[a, b]| (frame(a), frame(b))) {
        // Equal frames, to the digits of a file, leave everything where it is.
        Some((Some(a), Some(b))) => {
            let far = a.origin.coords.norm() + b.origin.coords.norm() + 1e-3;
            (a.origin - b.origin).norm() > 1e-9 * far || (a.x.dot(&b.x)).min(a.z.dot(&b.z)) < 1.0 - 1e-12
        }
        // What cannot be read may be a motion.
        _ => true,
    }
}
