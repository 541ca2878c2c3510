//! Edges and their curves to and from their specs.

use super::fault::{FaceFault, finite_uv, possible};
use super::spec;
use super::surfaces::{of_frame, to_frame, to_point};
use crate::part::Face;
use crate::trim::boundary::Boundary;
use crate::trim::curve::{Curve, Ellipse, Form, Line, OpenConic, OpenKind, Piece, Polyline};
use crate::trim::spline::Spline;
use osculate_geom::{Point3, Uv, Vec3};
use std::sync::Arc;

/// The loops of a face: its file's edges, or its parameter polylines where it has none and is trimmed.
pub(super) fn of_loops(face: &Face) -> Vec<Vec<spec::Edge>> {
    let edges = face.surface.edges();
    if edges.is_empty() {
        if !face.trimmed() {
            return Vec::new();
        }
        let closed = |points: &[Uv]| {
            let all = points.iter().chain(points.first());
            spec::Edge {
                key: None,
                curve: None,
                ends: None,
                parameters: Some(all.map(|p| [p.u, p.v]).collect()),
            }
        };
        return face.surface.loops().iter().map(|l| vec![closed(&l.points)]).collect();
    }
    let mut out: Vec<(usize, Vec<spec::Edge>)> = Vec::new();
    for e in edges {
        let exact = e.curve.as_ref().and_then(|p| of_curve(p).map(|c| (c, p.ends)));
        let edge = match exact {
            Some((curve, ends)) => {
                spec::Edge { key: e.key, curve: Some(curve), ends: Some(ends), parameters: None }
            }
            None => {
                let parameters = Some(e.points.iter().map(|p| [p.u, p.v]).collect());
                spec::Edge { key: e.key, curve: None, ends: None, parameters }
            }
        };
        match out.last_mut() {
            Some((owner, list)) if *owner == e.owner => list.push(edge),
            _ => out.push((e.owner, vec![edge])),
        }
    }
    out.into_iter().map(|l| l.1).collect()
}

fn of_curve(piece: &Piece) -> Option<spec::Curve> {
    let array = |p: &Point3| -> [f64; 3] { p.coords.into() };
    Some(match piece.curve.form()? {
        Form::Line(l) => {
            spec::Curve::Line(spec::Line { origin_mm: array(&l.origin), direction_mm: l.direction.into() })
        }
        Form::Ellipse(e) => {
            spec::Curve::Ellipse(spec::Ellipse { frame: of_frame(&e.frame), semi_axes_mm: e.semi_axes })
        }
        Form::Open(c) => match c.kind {
            OpenKind::Parabola { focal_mm } => {
                spec::Curve::Parabola(spec::Parabola { frame: of_frame(&c.frame), focal_mm })
            }
            OpenKind::Hyperbola { semi_axes_mm } => {
                spec::Curve::Hyperbola(spec::Hyperbola { frame: of_frame(&c.frame), semi_axes_mm })
            }
        },
        Form::Polyline(p) => {
            spec::Curve::Polyline(spec::Polyline { points_mm: p.points.iter().map(array).collect() })
        }
        Form::Spline(s) => {
            let c = s.curve();
            spec::Curve::Spline(spec::Spline {
                degree: c.degree(),
                knots: c.knots().as_slice().to_vec(),
                poles_mm: c.poles().iter().map(array).collect(),
                weights: c.weights().map(<[f64]>::to_vec),
            })
        }
    })
}

/// An edge of a loop.
pub(super) fn to_boundary(e: spec::Edge, of: usize, edge: usize) -> Result<Boundary, FaceFault> {
    let bad = FaceFault::Edge { of, edge };
    match (e.curve, e.ends, e.parameters) {
        (Some(curve), Some(ends), None) => {
            if !(ends.iter().all(|t| t.is_finite()) && ends[0] != ends[1]) {
                return Err(FaceFault::Number { what: "an edge's ends: two different numbers," });
            }
            let piece = Piece { curve: to_curve(curve, ends)?, ends };
            Ok(Boundary::Space { piece, key: e.key })
        }
        (None, None, Some(parameters)) if parameters.len() > 1 => {
            let points: Vec<Uv> = parameters.into_iter().map(finite_uv).collect::<Result<_, _>>()?;
            let points: Vec<Point3> = points.iter().map(|p| Point3::new(p.u, p.v, 0.0)).collect();
            let last = (points.len() - 1) as f64;
            let piece = Piece { curve: Arc::new(Polyline { points }), ends: [0.0, last] };
            Ok(Boundary::Parameter { piece })
        }
        _ => Err(bad),
    }
}

/// Turns of a hyperbola's or line's parameter beyond this leave the range of numbers.
const FAR: f64 = 1e9;

fn to_curve(c: spec::Curve, ends: [f64; 2]) -> Result<Arc<dyn Curve>, FaceFault> {
    let positive = |what: &'static str, x: f64| {
        if x > 0.0 && x.is_finite() { Ok(x) } else { Err(FaceFault::Number { what }) }
    };
    if ends.iter().any(|t| t.abs() > FAR) {
        return Err(FaceFault::Number { what: "an edge's ends, below 1e9," });
    }
    Ok(match c {
        spec::Curve::Line(l) => {
            let direction = Vec3::from(l.direction_mm);
            positive("the length of a line's direction", direction.norm())?;
            let range = [f64::NEG_INFINITY, f64::INFINITY];
            Arc::new(Line { origin: to_point(l.origin_mm)?, direction, range })
        }
        spec::Curve::Ellipse(e) => {
            for a in e.semi_axes_mm {
                positive("a semi-axis", a)?;
            }
            let range = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            Arc::new(Ellipse { frame: to_frame(&e.frame)?, semi_axes: e.semi_axes_mm, range })
        }
        spec::Curve::Parabola(p) => {
            let focal_mm = positive("a focal length", p.focal_mm)?;
            Arc::new(OpenConic { frame: to_frame(&p.frame)?, kind: OpenKind::Parabola { focal_mm } })
        }
        spec::Curve::Hyperbola(h) => {
            for a in h.semi_axes_mm {
                positive("a semi-axis", a)?;
            }
            let kind = OpenKind::Hyperbola { semi_axes_mm: h.semi_axes_mm };
            Arc::new(OpenConic { frame: to_frame(&h.frame)?, kind })
        }
        spec::Curve::Polyline(p) => {
            let points: Vec<Point3> = p.points_mm.into_iter().map(to_point).collect::<Result<_, _>>()?;
            if points.len() < 2 {
                return Err(FaceFault::Number { what: "the number of a polyline's pieces" });
            }
            Arc::new(Polyline { points })
        }
        spec::Curve::Spline(s) => {
            if !possible(s.degree) {
                return Err(FaceFault::Number { what: "a degree, at least 1 and not above the greatest," });
            }
            let poles = s.poles_mm.into_iter().map(Point3::from).collect();
            Arc::new(Spline::new(s.degree, s.knots, poles, s.weights.unwrap_or_default())?)
        }
    })
}
