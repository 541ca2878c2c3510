//! Curves of a Part 21 file, in millimetres and radians.

use super::geometry::{Geometry, MAX_CHAIN, MAX_NESTED, Unread};
use super::graph::{Args, Record, arg};
use super::rectangle::Measured;
use super::units::Units;
use crate::trim::carrier::FaceSurface;
use crate::trim::compound::{Compound, Lifted, OffsetCurve};
use crate::trim::curve::{Curve, Ellipse, Line, Moved, OpenConic, OpenKind, Piece, Polyline};
use crate::trim::motion::Motion;
use osculate_geom::{Point3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A surface and a curve in its parameters (z = 0).
pub(super) type OnSurface = (FaceSurface, Arc<dyn Curve>);

impl Geometry<'_> {
    /// A curve in space.
    pub(crate) fn curve(&self, id: u64, depth: usize) -> Result<Arc<dyn Curve>, Unread> {
        let record = self.record(id)?;
        if depth >= MAX_CHAIN {
            return Err(Unread::Malformed { id, what: "curves refer to each other in a circle".into() });
        }
        if let Some(args) = record.part("LINE") {
            let origin = self.point(self.to(id, &args, 1)?)?;
            let direction = self.vector(self.to(id, &args, 2)?)?;
            if direction.norm() == 0.0 {
                return Err(Unread::Malformed { id, what: "a line without direction".into() });
            }
            return Ok(Arc::new(Line { origin, direction, range: [f64::NEG_INFINITY, f64::INFINITY] }));
        }
        if let Some(ellipse) = self.ellipse(id, &record)? {
            return Ok(Arc::new(ellipse));
        }
        if let Some(args) = record.part("HYPERBOLA").or_else(|| record.part("PARABOLA")) {
            let frame = self.placement(self.to(id, &args, 1)?)?;
            let a = self.number(id, &args, 2)? * self.units.length_mm;
            let kind = if record.is("PARABOLA") {
                OpenKind::Parabola { focal_mm: a }
            } else {
                OpenKind::Hyperbola { semi_axes_mm: [a, self.number(id, &args, 3)? * self.units.length_mm] }
            };
            if !(a != 0.0 && a.is_finite()) {
                return Err(Unread::Malformed { id, what: format!("a conic of size {a} mm") });
            }
            return Ok(Arc::new(OpenConic { frame, kind }));
        }
        if let Some(args) = record.part("POLYLINE") {
            let points = self.points(id, &arg(&args, 1).list())?;
            if points.len() < 2 {
                return Err(Unread::Malformed { id, what: format!("a polyline of {} points", points.len()) });
            }
            return Ok(Arc::new(Polyline { points }));
        }
        for kind in ["SURFACE_CURVE", "SEAM_CURVE", "INTERSECTION_CURVE", "BOUNDED_SURFACE_CURVE"] {
            // The space curve is the first reference: behind the name, or first in a complex record.
            if let Some(curve) = record.part(kind).and_then(|a| a.iter().find_map(|v| v.reference())) {
                return self.curve(curve, depth + 1);
            }
        }
        if let Some(args) = record.part("TRIMMED_CURVE") {
            return self.trimmed(id, &args, depth);
        }
        if let Some(spline) = self.spline(id, &record)? {
            return Ok(Arc::new(spline));
        }
        self.derived(id, &record, depth)
    }

    /// A curve made of other curves.
    fn derived(&self, id: u64, record: &Record<'_>, depth: usize) -> Result<Arc<dyn Curve>, Unread> {
        let malformed = |what: String| Unread::Malformed { id, what };
        let composite = record.any(&["COMPOSITE_CURVE", "COMPOSITE_CURVE_ON_SURFACE"]);
        if let Some((_, args)) = composite.filter(|c| !c.1.is_empty()) {
            let list = [0, 1].map(|k| arg(&args, k).list());
            let mut pieces = Vec::new();
            for segment in list.iter().flat_map(Args::references) {
                let (parent, forward) = self.segment(segment)?;
                self.nested.set(self.nested.get() + usize::from(depth > 0));
                if self.nested.get() > MAX_NESTED {
                    return Err(malformed(format!(
                        "composite curves within each other have more than {MAX_NESTED} segments; export them as one"
                    )));
                }
                let whole = Piece::whole(self.curve(parent, depth + 1)?);
                let piece = whole.ok_or_else(|| malformed(format!("its segment #{segment} has no ends")))?;
                pieces.push(if forward { piece } else { piece.reversed() });
            }
            let made = Compound::new(pieces);
            return Ok(Arc::new(made.ok_or_else(|| malformed("a composite curve without segments".into()))?));
        }
        if let Some(args) = record.part("OFFSET_CURVE_3D") {
            let curve = self.curve(self.to(id, &args, 1)?, depth + 1)?;
            let distance_mm = self.number(id, &args, 2)? * self.units.length_mm;
            let across = self.direction(self.to(id, &args, 4)?)?;
            return Ok(Arc::new(OffsetCurve { curve, distance_mm, across }));
        }
        if let Some(args) = record.part("CURVE_REPLICA") {
            let curve = self.curve(self.to(id, &args, 1)?, depth + 1)?;
            let motion = self.operator(&self.record(self.to(id, &args, 2)?)?).map_err(malformed)?;
            return Ok(Arc::new(Moved { curve, motion }));
        }
        if let Some((surface, curve)) = self.pcurve(record, depth)? {
            return Ok(Arc::new(Lifted { surface, curve }));
        }
        Err(Unread::Kind { id, kind: record.kind() })
    }

    /// Curve and sense of a COMPOSITE_CURVE_SEGMENT.
    pub(super) fn segment(&self, id: u64) -> Result<(u64, bool), Unread> {
        let record = self.record(id)?;
        let args = record
            .part("COMPOSITE_CURVE_SEGMENT")
            .or_else(|| record.part("REPARAMETRISED_COMPOSITE_CURVE_SEGMENT"))
            .ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        Ok((self.to(id, &args, 2)?, arg(&args, 1).flag().unwrap_or(true)))
    }

    /// The surface and the parameter curve (z = 0, in the carrier's own parameters) of a PCURVE; `None` for another
    /// kind.
    pub(super) fn pcurve(&self, record: &Record<'_>, depth: usize) -> Result<Option<OnSurface>, Unread> {
        let Some((_, args)) = record.any(&["PCURVE", "DEGENERATE_PCURVE"]) else { return Ok(None) };
        let id = record.id();
        let definition = self.record(self.to(id, &args, 2)?)?;
        let held =
            definition.part("DEFINITIONAL_REPRESENTATION").or_else(|| definition.part("REPRESENTATION"));
        let curve = held.and_then(|d| arg(&d, 1).list().references().next());
        let curve = curve.ok_or_else(|| Unread::Malformed { id, what: "a PCURVE without curve".into() })?;
        let basis = self.to(id, &args, 1)?;
        let surface = self.surface(basis, &[], depth + 1)?.surface;
        // Parameters are plain numbers; those that are lengths or angles follow the context's units.
        let plain = Units { length_mm: 1.0, angle_rad: self.units.angle_rad, uncertainty_mm: None };
        let inner = Self { graph: self.graph, units: plain, nested: self.nested.clone() };
        let flat = inner.curve(curve, depth + 1);
        self.nested.set(inner.nested.get());
        let flat = Measured::on(self, basis, flat?)?;
        let scale = surface.parameter_units(self.units.length_mm, self.units.angle_rad);
        let linear = nalgebra::Matrix3::from_diagonal(&Vec3::new(scale[0], scale[1], 1.0));
        let motion = Motion { linear, shift: Vec3::zeros() };
        Ok(Some((surface, Arc::new(Moved { curve: flat, motion }))))
    }

    pub(super) fn ellipse(&self, id: u64, record: &Record<'_>) -> Result<Option<Ellipse>, Unread> {
        let (args, count) = match (record.part("CIRCLE"), record.part("ELLIPSE")) {
            (Some(a), _) => (a, 1),
            (_, Some(a)) => (a, 2),
            _ => return Ok(None),
        };
        let frame = self.placement(self.to(id, &args, 1)?)?;
        let a = self.number(id, &args, 2)? * self.units.length_mm;
        let b = if count == 2 { self.number(id, &args, 3)? * self.units.length_mm } else { a };
        if !(a > 0.0 && b > 0.0) {
            return Err(Unread::Malformed { id, what: format!("radii {a} mm and {b} mm") });
        }
        Ok(Some(Ellipse { frame, semi_axes: [a, b], range: [0.0, TAU] }))
    }

    /// TRIMMED_CURVE: the part of a curve between two parameters or points.
    fn trimmed(&self, id: u64, args: &Args<'_>, depth: usize) -> Result<Arc<dyn Curve>, Unread> {
        let basis_id = self.to(id, args, 1)?;
        let basis = self.curve(basis_id, depth + 1)?;
        let forward = arg(args, 4).flag().unwrap_or(true);
        let mut ends = [Point3::origin(); 2];
        for (end, k) in ends.iter_mut().zip([2, 3]) {
            let choices = arg(args, k).list();
            *end = match choices.iter().find_map(|v| v.reference()) {
                Some(p) => self.point(p)?,
                None => {
                    let Some(t) = choices.iter().find_map(|v| v.number()) else {
                        return Err(Unread::Malformed {
                            id,
                            what: "a trim without point and parameter".into(),
                        });
                    };
                    let is_angle =
                        self.graph.get(basis_id).is_some_and(|r| r.is("CIRCLE") || r.is("ELLIPSE"));
                    basis.point(if is_angle { t * self.units.angle_rad } else { t })
                }
            };
        }
        let slack = 1e-9 * (ends[0] - ends[1]).norm();
        let piece = Piece::between(basis, ends, forward, slack)
            .ok_or_else(|| Unread::Malformed { id, what: "trims at the same place".into() })?;
        Ok(Arc::new(piece))
    }
}
