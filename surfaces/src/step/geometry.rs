//! Points, directions, placements and operators of a Part 21 file, in millimetres and radians.

use super::graph::{Args, Graph, Record, Value, arg};
use super::units::Units;
use crate::trim::motion::Motion;
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Unit3, Vec3};
use std::cell::Cell;

/// Why an entity could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Unread {
    /// A reference to nothing.
    #[error("#{id} is not defined")]
    Missing { id: u64 },
    /// A kind that is not read.
    #[error("#{id} is a {kind}, which is not read")]
    Kind { id: u64, kind: String },
    /// Parameters that make no such entity.
    #[error("#{id}: {what}")]
    Malformed { id: u64, what: String },
}

/// References followed from one curve or surface to another at most.
pub(super) const MAX_CHAIN: usize = 16;

/// Segments of composite curves within composite curves of one face at most: writers nest a handful, and a file of
/// composites that name each other several times would reach any number.
pub(super) const MAX_NESTED: usize = 20_000;

/// A reader of geometry with the units of its context.
pub(crate) struct Geometry<'g> {
    pub(crate) graph: &'g Graph<'g>,
    pub(crate) units: Units,
    /// Segments of composite curves within composite curves so far.
    pub(super) nested: Cell<usize>,
}

impl<'g> Geometry<'g> {
    pub(crate) const fn new(graph: &'g Graph<'g>, units: Units) -> Self {
        Self { graph, units, nested: Cell::new(0) }
    }

    pub(super) fn record(&self, id: u64) -> Result<Record<'g>, Unread> {
        self.graph.get(id).ok_or(Unread::Missing { id })
    }

    /// A reference parameter.
    pub(super) fn to(&self, id: u64, args: &Args<'_>, k: usize) -> Result<u64, Unread> {
        let what = || format!("parameter {} is no reference", k + 1);
        arg(args, k).reference().ok_or_else(|| Unread::Malformed { id, what: what() })
    }

    /// A number parameter.
    pub(super) fn number(&self, id: u64, args: &Args<'_>, k: usize) -> Result<f64, Unread> {
        let what = || format!("parameter {} is no number", k + 1);
        arg(args, k).number().ok_or_else(|| Unread::Malformed { id, what: what() })
    }

    fn triple(&self, id: u64, values: &Args<'_>) -> Result<Vec3, Unread> {
        let (mut c, mut n) = ([0.0; 3], 0);
        for x in values.iter() {
            let Some(x) = x.number() else {
                return Err(Unread::Malformed { id, what: "a coordinate that is no number".into() });
            };
            if n < 3 {
                c[n] = x;
            }
            n += 1;
        }
        match n {
            2 | 3 => Ok(Vec3::from(c)),
            _ => Err(Unread::Malformed { id, what: format!("{n} coordinates, three are needed") }),
        }
    }

    /// A CARTESIAN_POINT, mm.
    pub(crate) fn point(&self, id: u64) -> Result<Point3, Unread> {
        let record = self.record(id)?;
        let args = record.part("CARTESIAN_POINT").ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        Ok(Point3::from(self.triple(id, &arg(&args, 1).list())? * self.units.length_mm))
    }

    pub(crate) fn direction(&self, id: u64) -> Result<Unit3, Unread> {
        let record = self.record(id)?;
        let args = record.part("DIRECTION").ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        Unit3::try_new(self.triple(id, &arg(&args, 1).list())?, 0.0)
            .ok_or_else(|| Unread::Malformed { id, what: "a direction of length zero".into() })
    }

    /// A VECTOR, mm.
    pub(super) fn vector(&self, id: u64) -> Result<Vec3, Unread> {
        let record = self.record(id)?;
        let args = record.part("VECTOR").ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        let direction = self.direction(self.to(id, &args, 1)?)?;
        Ok(direction.into_inner() * (self.number(id, &args, 2)? * self.units.length_mm))
    }

    /// An AXIS2_PLACEMENT_3D or AXIS1_PLACEMENT.
    pub(crate) fn placement(&self, id: u64) -> Result<Placement, Unread> {
        let record = self.record(id)?;
        let args = record
            .part("AXIS2_PLACEMENT_3D")
            .or_else(|| record.part("AXIS1_PLACEMENT"))
            .ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        let origin = self.point(self.to(id, &args, 1)?)?;
        let z = match arg(&args, 2).reference() {
            Some(d) => self.direction(d)?,
            None => Vec3::z_axis(),
        };
        let hint = match arg(&args, 3).reference() {
            Some(d) => Some(self.direction(d)?.into_inner()),
            // The standard's default for a missing reference direction.
            None => Some(if z.x.abs() > 0.999_999 { Vec3::y() } else { Vec3::x() }),
        };
        Ok(Placement::new(origin, z, hint))
    }

    /// A CARTESIAN_TRANSFORMATION_OPERATOR_3D: axes along the unit vectors' images, the third one completing them.
    pub(crate) fn operator(&self, record: &Record<'_>) -> Result<Motion, String> {
        let own = record.part("CARTESIAN_TRANSFORMATION_OPERATOR");
        let third = record.part("CARTESIAN_TRANSFORMATION_OPERATOR_3D");
        let Some(args) = own.or(third) else { return Err(format!("a {} is not read", record.kind())) };
        // The origin is the one point among the parameters; the others stand around it.
        let is_point = |id: u64| self.graph.get(id).is_some_and(|r| r.is("CARTESIAN_POINT"));
        let at = (0..args.len()).find(|k| arg(&args, *k).reference().is_some_and(is_point));
        let Some(at) = at.filter(|k| *k >= 2) else { return Err("an operator without origin".into()) };
        let direction = |v: Option<u64>| v.map(|d| self.direction(d)).transpose().map_err(|e| e.to_string());
        let origin = arg(&args, at).reference().map(|p| self.point(p));
        let origin = origin.transpose().map_err(|e| e.to_string())?.unwrap_or_default();
        let axis1 = direction(arg(&args, at - 2).reference())?;
        let axis2 = direction(arg(&args, at - 1).reference())?;
        let scale = arg(&args, at + 1).number().unwrap_or(1.0);
        let axis3 = match (own, third) {
            (Some(_), Some(t)) => arg(&t, 0).reference(),
            _ => arg(&args, at + 2).reference(),
        };
        let z = direction(axis3)?.unwrap_or_else(|| match (axis1, axis2) {
            (Some(x), Some(y)) => Unit3::try_new(x.cross(&y), 1e-9).unwrap_or_else(Vec3::z_axis),
            _ => Vec3::z_axis(),
        });
        let frame = Placement::new(origin, z, axis1.map(Unit3::into_inner));
        // base_axis of ISO 10303-42: the second axis points to the side of the one given.
        let y = if axis2.is_some_and(|y| y.dot(&frame.y) < 0.0) { -frame.y } else { frame.y };
        if !(scale.is_finite() && scale > 0.0) {
            return Err(format!("an operator of scale {scale}"));
        }
        let columns = [frame.x, y, frame.z].map(|c| c.into_inner() * scale);
        Ok(Motion { linear: nalgebra::Matrix3::from_columns(&columns), shift: origin.coords })
    }

    /// A VERTEX_POINT, mm.
    pub(crate) fn vertex(&self, id: u64) -> Result<Point3, Unread> {
        let record = self.record(id)?;
        let args = record.part("VERTEX_POINT").ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        self.point(self.to(id, &args, 1)?)
    }

    /// Points by reference, mm.
    pub(super) fn points(&self, id: u64, values: &Args<'_>) -> Result<Vec<Point3>, Unread> {
        values.iter().map(|v| self.pole(id, v)).collect()
    }

    /// A point by reference, mm.
    pub(super) fn pole(&self, id: u64, value: Value<'_>) -> Result<Point3, Unread> {
        match value.reference() {
            Some(p) => self.point(p),
            None => Err(Unread::Malformed { id, what: "a pole that is no reference".into() }),
        }
    }
}
