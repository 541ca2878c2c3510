//! Writing IGES 5.3: faces of boundary representations over rational B-spline surfaces.
//!
//! Every surface becomes entity 128 and every edge curve entity 126, exactly (a piece of a hyperbola to 1e-10 of its
//! length). Faces are 510 with loops 508, edges 504 and vertices 502, gathered in shells 514: closed ones in solids
//! 186, others open by themselves. A whole closed surface without any edge is a 128 by itself. The 510 keeps what 144
//! cannot say: shared edges and the material's side.
//!
//! Source: [IGES 5.3, US PRO 1996, chapters 2 and 4].

mod cards;
mod options;
mod splines;

pub use options::{IgesOptions, IgesWriteError};

use crate::nurbs::{NurbsCurve2, NurbsCurve3};
use crate::part::Face;
use crate::topology::{
    Edge, Ground, Step, Topology, Track, as_spline, bodies, natural_loops, outward, pcurves,
};
use cards::{Cards, Value};
use osculate_geom::{Axis, Side};

/// Faces as an IGES file, lengths in millimetres.
///
/// ```
/// use osculate_surfaces::iges::{self, IgesOptions};
/// use osculate_surfaces::patches;
/// let part = patches::read(b"1\n1 1\n0 0 0\n0 20 0\n10 0 0\n10 20 5\n")?;
/// let text = iges::write(&part.faces, &IgesOptions::default())?;
/// // Cards of 80 columns, the letter of their section in the 73rd.
/// assert!(text.lines().all(|card| card.len() == 80) && text.as_bytes()[72] == b'S');
/// let back = iges::read(text.as_bytes())?;
/// assert!((back.faces[0].area_mm2() - part.faces[0].area_mm2()).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`IgesWriteError`].
pub fn write(faces: &[Face], options: &IgesOptions) -> Result<String, IgesWriteError> {
    let mut out = Vec::new();
    write_to(faces, options, &mut out)?;
    String::from_utf8(out).map_err(|e| IgesWriteError::Output { why: e.to_string() })
}

/// As [`write()`], card by card. Where it fails the output has a part of the file.
///
/// # Errors
/// [`IgesWriteError`].
pub fn write_to(
    faces: &[Face],
    options: &IgesOptions,
    to: &mut dyn std::io::Write,
) -> Result<(), IgesWriteError> {
    if faces.is_empty() {
        return Err(IgesWriteError::NoFaces);
    }
    let topology = Topology::new(faces, None);
    let mut out = Cards::new();
    let curves = edge_curves(&topology)?;
    let lists = edge_list(&mut out, &topology, &curves);
    let mut of_face: Vec<Option<usize>> = Vec::with_capacity(faces.len());
    for (face, of) in faces.iter().zip(&topology.faces) {
        let (spline, covered) =
            splines::surface(face, of).ok_or_else(|| IgesWriteError::Surface { face: face.id.clone() })?;
        let walks = natural_loops(face, of);
        if walks.is_empty() {
            let whole = if outward(face) == Side::Against { spline.reversed(Axis::U) } else { spline };
            let surface = surface(&mut out, &whole, cards::INDEPENDENT);
            out.name(surface, &face.name);
            of_face.push(None);
            continue;
        }
        let surface = surface(&mut out, &spline, cards::DEPENDENT);
        let ground = Ground::spline(&spline, covered, face, &of.chart);
        let parameters = pcurves(&ground, of, &walks, &|edge| track(&curves[edge]));
        let mut values = vec![Value::Pointer(surface), Value::Integer(walks.len()), Value::Integer(0)];
        for (walk, parameters) in walks.iter().zip(&parameters) {
            values.push(Value::Pointer(edge_loop(&mut out, walk, parameters, lists)));
        }
        let entity = out.add(510, 1, cards::DEPENDENT, values);
        out.name(entity, &face.name);
        of_face.push(Some(entity));
    }
    for body in bodies(faces, &topology) {
        let uses: Vec<(usize, &Face)> =
            body.faces.iter().filter_map(|f| of_face[*f].map(|e| (e, &faces[*f]))).collect();
        if uses.is_empty() {
            continue;
        }
        let mut values = vec![Value::Integer(uses.len())];
        for (entity, face) in uses {
            values.push(Value::Pointer(entity));
            values.push(Value::Integer(usize::from(outward(face) == Side::Along)));
        }
        if body.solid {
            let shell = out.add(514, 1, cards::DEPENDENT, values);
            let solid = vec![Value::Pointer(shell), Value::Integer(1), Value::Integer(0)];
            out.add(186, 0, cards::INDEPENDENT, solid);
        } else {
            out.add(514, if body.closed { 1 } else { 2 }, cards::INDEPENDENT, values);
        }
    }
    out.file(options, topology.size_mm, to)
}

/// The numbers of the vertex list and the edge list.
#[derive(Clone, Copy)]
struct Lists {
    edges: usize,
}

/// The edges' curves as splines along the edges.
fn edge_curves(topology: &Topology) -> Result<Vec<NurbsCurve3>, IgesWriteError> {
    let of = |(number, e): (usize, &Edge)| {
        as_spline(&e.course, e.length_mm).ok_or(IgesWriteError::Curve { edge: number + 1 })
    };
    topology.edges.iter().enumerate().map(of).collect()
}

fn track(c: &NurbsCurve3) -> Track<'_> {
    let d = c.domain();
    let mut breaks: Vec<f64> =
        c.knots().as_slice().iter().copied().filter(|t| *t >= d.lo && *t <= d.hi).collect();
    breaks.dedup();
    let jet = |t: f64| {
        let jet = c.jet(t);
        (jet.point, jet.first)
    };
    Track { jet: Box::new(jet), breaks, forward: true }
}

fn edge_list(out: &mut Cards, topology: &Topology, curves: &[NurbsCurve3]) -> Lists {
    if topology.edges.is_empty() {
        // No loop will ask for the list.
        return Lists { edges: 0 };
    }
    let mut values = vec![Value::Integer(topology.vertices.len())];
    values.extend(topology.vertices.iter().flat_map(|p| [p.x, p.y, p.z]).map(Value::Real));
    let vertices = out.add(502, 1, cards::DEPENDENT, values);
    let mut values = vec![Value::Integer(topology.edges.len())];
    for (e, curve) in topology.edges.iter().zip(curves) {
        values.push(Value::Pointer(self::curve(out, curve)));
        for v in e.vertices {
            values.push(Value::Pointer(vertices));
            values.push(Value::Integer(v + 1));
        }
    }
    Lists { edges: out.add(504, 1, cards::DEPENDENT, values) }
}

fn edge_loop(out: &mut Cards, walk: &[Step], parameters: &[Option<NurbsCurve2>], lists: Lists) -> usize {
    let mut values = vec![Value::Integer(walk.len())];
    for (s, parameters) in walk.iter().zip(parameters) {
        values.extend([
            Value::Integer(0),
            Value::Pointer(lists.edges),
            Value::Integer(s.edge + 1),
            Value::Integer(usize::from(s.forward)),
            Value::Integer(usize::from(parameters.is_some())),
        ]);
        if let Some(c) = parameters {
            let [a, b] = [c.poles()[0], c.poles()[c.poles().len() - 1]];
            let along_a_parameter = c.degree() == 1 && (a.x == b.x || a.y == b.y);
            values.push(Value::Integer(usize::from(along_a_parameter)));
            // Parameter curves run along the loop, whatever the edge does.
            values.push(Value::Pointer(parameter_curve(
                out,
                &if s.forward { c.clone() } else { c.reversed() },
            )));
        }
    }
    out.add(508, 1, cards::DEPENDENT, values)
}

/// Entity 126 in the parameters of a surface, along the edge.
fn parameter_curve(out: &mut Cards, c: &NurbsCurve2) -> usize {
    let (poles, d) = (c.poles(), c.domain());
    let closed = poles[0] == poles[poles.len() - 1];
    let mut values = vec![
        Value::Integer(poles.len() - 1),
        Value::Integer(c.degree()),
        Value::Integer(1),
        Value::Integer(usize::from(closed)),
        Value::Integer(1),
        Value::Integer(0),
    ];
    values.extend(c.knots().as_slice().iter().copied().map(Value::Real));
    values.extend(poles.iter().map(|_| Value::Real(1.0)));
    values.extend(poles.iter().flat_map(|p| [p.x, p.y, 0.0]).map(Value::Real));
    values.extend([d.lo, d.hi, 0.0, 0.0, 1.0].map(Value::Real));
    out.add(126, 0, cards::PARAMETRIC, values)
}

/// Entity 126.
fn curve(out: &mut Cards, c: &NurbsCurve3) -> usize {
    let poles = c.poles();
    let d = c.domain();
    let closed = (c.point(d.lo) - c.point(d.hi)).norm() <= 1e-12 * poles[0].coords.norm();
    let mut values = vec![
        Value::Integer(poles.len() - 1),
        Value::Integer(c.degree()),
        Value::Integer(0),
        Value::Integer(usize::from(closed)),
        Value::Integer(usize::from(!c.is_rational())),
        Value::Integer(0),
    ];
    values.extend(c.knots().as_slice().iter().copied().map(Value::Real));
    values.extend((0..poles.len()).map(|k| Value::Real(c.weights().map_or(1.0, |w| w[k]))));
    values.extend(poles.iter().flat_map(|p| [p.x, p.y, p.z]).map(Value::Real));
    values.extend([d.lo, d.hi, 0.0, 0.0, 0.0].map(Value::Real));
    out.add(126, 0, cards::DEPENDENT, values)
}

/// Entity 128.
fn surface(out: &mut Cards, n: &crate::nurbs::NurbsSurface, status: &'static str) -> usize {
    let net = n.net();
    let [nu, nv] = net.count;
    let [du, dv] = n.degree();
    let [cu, cv] = [Axis::U, Axis::V].map(|axis| Value::Integer(usize::from(n.closed(axis))));
    let polynomial = Value::Integer(usize::from(!n.is_rational()));
    let mut values = vec![
        Value::Integer(nu - 1),
        Value::Integer(nv - 1),
        Value::Integer(du),
        Value::Integer(dv),
        cu,
        cv,
        polynomial,
        Value::Integer(0),
        Value::Integer(0),
    ];
    for axis in [Axis::U, Axis::V] {
        values.extend(n.knots(axis).as_slice().iter().copied().map(Value::Real));
    }
    // The format counts the first parameter fastest.
    let order: Vec<usize> = (0..nv).flat_map(|j| (0..nu).map(move |i| i * nv + j)).collect();
    values.extend(order.iter().map(|k| Value::Real(net.weights.as_ref().map_or(1.0, |w| w[*k]))));
    values.extend(order.iter().flat_map(|k| net.points[*k].coords.iter().copied()).map(Value::Real));
    let d = osculate_geom::Surface::domain(n);
    values.extend([d.u.lo, d.u.hi, d.v.lo, d.v.hi].map(Value::Real));
    out.add(128, 0, status, values)
}
