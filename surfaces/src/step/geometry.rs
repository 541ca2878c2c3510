//! Points, placements, curves and surfaces of a Part 21 file, in millimetres and radians.

use super::graph::{Graph, Record, Value, arg};
use super::units::Units;
use crate::knots::MAX_DEGREE;
use crate::nurbs::{Net, NurbsSurface};
use crate::part::FaceKind;
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use crate::trim::curve::{Curve, Ellipse, Line, OpenConic, OpenKind, Piece, Polyline};
use crate::trim::spline::Spline;
use crate::trim::sweep::{extrude, revolve};
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Unit3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

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
const MAX_CHAIN: usize = 16;

/// Knot multiplicities are expanded; their sum is bounded by what one record can reasonably hold.
const MAX_KNOTS: usize = 1_000_000;

/// A surface with its kind, and whether its normal is against the one of the surface returned.
pub(crate) struct Carried {
    pub(crate) surface: FaceSurface,
    pub(crate) kind: FaceKind,
    pub(crate) reversed: bool,
}

/// A reader of geometry with the units of its context.
pub(crate) struct Geometry<'g> {
    pub(crate) graph: &'g Graph,
    pub(crate) units: Units,
}

impl Geometry<'_> {
    fn record(&self, id: u64) -> Result<&Record, Unread> {
        self.graph.get(id).ok_or(Unread::Missing { id })
    }

    /// A reference parameter.
    fn to(&self, id: u64, args: &[Value], k: usize) -> Result<u64, Unread> {
        let what = || format!("parameter {} is no reference", k + 1);
        arg(args, k).reference().ok_or_else(|| Unread::Malformed { id, what: what() })
    }

    /// A number parameter.
    fn number(&self, id: u64, args: &[Value], k: usize) -> Result<f64, Unread> {
        let what = || format!("parameter {} is no number", k + 1);
        arg(args, k).number().ok_or_else(|| Unread::Malformed { id, what: what() })
    }

    fn triple(&self, id: u64, values: &[Value]) -> Result<Vec3, Unread> {
        let c: Vec<f64> = values.iter().filter_map(Value::number).collect();
        match *c.as_slice() {
            [x, y, z] => Ok(Vec3::new(x, y, z)),
            [x, y] => Ok(Vec3::new(x, y, 0.0)),
            _ => Err(Unread::Malformed { id, what: format!("{} coordinates, three are needed", c.len()) }),
        }
    }

    /// A CARTESIAN_POINT, mm.
    pub(crate) fn point(&self, id: u64) -> Result<Point3, Unread> {
        let record = self.record(id)?;
        let args = record.part("CARTESIAN_POINT").ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        Ok(Point3::from(self.triple(id, arg(args, 1).list())? * self.units.length_mm))
    }

    fn direction(&self, id: u64) -> Result<Unit3, Unread> {
        let record = self.record(id)?;
        let args = record.part("DIRECTION").ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        Unit3::try_new(self.triple(id, arg(args, 1).list())?, 0.0)
            .ok_or_else(|| Unread::Malformed { id, what: "a direction of length zero".into() })
    }

    /// A VECTOR, mm.
    fn vector(&self, id: u64) -> Result<Vec3, Unread> {
        let record = self.record(id)?;
        let args = record.part("VECTOR").ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        let direction = self.direction(self.to(id, args, 1)?)?;
        Ok(direction.into_inner() * (self.number(id, args, 2)? * self.units.length_mm))
    }

    /// An AXIS2_PLACEMENT_3D or AXIS1_PLACEMENT.
    pub(crate) fn placement(&self, id: u64) -> Result<Placement, Unread> {
        let record = self.record(id)?;
        let args = record
            .part("AXIS2_PLACEMENT_3D")
            .or_else(|| record.part("AXIS1_PLACEMENT"))
            .ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        let origin = self.point(self.to(id, args, 1)?)?;
        let z = match arg(args, 2).reference() {
            Some(d) => self.direction(d)?,
            None => Vec3::z_axis(),
        };
        let hint = match arg(args, 3).reference() {
            Some(d) => Some(self.direction(d)?.into_inner()),
            // The standard's default for a missing reference direction.
            None => Some(if z.x.abs() > 0.999_999 { Vec3::y() } else { Vec3::x() }),
        };
        Ok(Placement::new(origin, z, hint))
    }

    /// A VERTEX_POINT, mm.
    pub(crate) fn vertex(&self, id: u64) -> Result<Point3, Unread> {
        let record = self.record(id)?;
        let args = record.part("VERTEX_POINT").ok_or_else(|| Unread::Kind { id, kind: record.kind() })?;
        self.point(self.to(id, args, 1)?)
    }

    /// A curve in space.
    pub(crate) fn curve(&self, id: u64, depth: usize) -> Result<Arc<dyn Curve>, Unread> {
        let record = self.record(id)?;
        if depth >= MAX_CHAIN {
            return Err(Unread::Malformed { id, what: "curves refer to each other in a circle".into() });
        }
        if let Some(args) = record.part("LINE") {
            let origin = self.point(self.to(id, args, 1)?)?;
            let direction = self.vector(self.to(id, args, 2)?)?;
            if direction.norm() == 0.0 {
                return Err(Unread::Malformed { id, what: "a line without direction".into() });
            }
            return Ok(Arc::new(Line { origin, direction, range: [f64::NEG_INFINITY, f64::INFINITY] }));
        }
        if let Some(ellipse) = self.ellipse(id, record)? {
            return Ok(Arc::new(ellipse));
        }
        if let Some(args) = record.part("HYPERBOLA").or_else(|| record.part("PARABOLA")) {
            let frame = self.placement(self.to(id, args, 1)?)?;
            let a = self.number(id, args, 2)? * self.units.length_mm;
            let kind = if record.is("PARABOLA") {
                OpenKind::Parabola { focal_mm: a }
            } else {
                OpenKind::Hyperbola { semi_axes_mm: [a, self.number(id, args, 3)? * self.units.length_mm] }
            };
            if !(a != 0.0 && a.is_finite()) {
                return Err(Unread::Malformed { id, what: format!("a conic of size {a} mm") });
            }
            return Ok(Arc::new(OpenConic { frame, kind }));
        }
        if let Some(args) = record.part("POLYLINE") {
            let points = self.points(id, arg(args, 1).list())?;
            if points.len() < 2 {
                return Err(Unread::Malformed { id, what: format!("a polyline of {} points", points.len()) });
            }
            return Ok(Arc::new(Polyline { points }));
        }
        for kind in ["SURFACE_CURVE", "SEAM_CURVE", "INTERSECTION_CURVE", "BOUNDED_SURFACE_CURVE"] {
            // The space curve is the first reference: behind the name, or first in a complex record.
            if let Some(curve) = record.part(kind).and_then(|a| a.iter().find_map(Value::reference)) {
                return self.curve(curve, depth + 1);
            }
        }
        if let Some(args) = record.part("TRIMMED_CURVE") {
            return self.trimmed(id, args, depth);
        }
        if let Some(spline) = self.spline(id, record)? {
            return Ok(Arc::new(spline));
        }
        Err(Unread::Kind { id, kind: record.kind() })
    }

    fn ellipse(&self, id: u64, record: &Record) -> Result<Option<Ellipse>, Unread> {
        let (args, count) = match (record.part("CIRCLE"), record.part("ELLIPSE")) {
            (Some(a), _) => (a, 1),
            (_, Some(a)) => (a, 2),
            _ => return Ok(None),
        };
        let frame = self.placement(self.to(id, args, 1)?)?;
        let a = self.number(id, args, 2)? * self.units.length_mm;
        let b = if count == 2 { self.number(id, args, 3)? * self.units.length_mm } else { a };
        if !(a > 0.0 && b > 0.0) {
            return Err(Unread::Malformed { id, what: format!("radii {a} mm and {b} mm") });
        }
        Ok(Some(Ellipse { frame, semi_axes: [a, b], range: [0.0, TAU] }))
    }

    fn points(&self, id: u64, values: &[Value]) -> Result<Vec<Point3>, Unread> {
        values
            .iter()
            .map(|v| match v.reference() {
                Some(p) => self.point(p),
                None => Err(Unread::Malformed { id, what: "a pole that is no reference".into() }),
            })
            .collect()
    }

    /// TRIMMED_CURVE: the part of a curve between two parameters or points.
    fn trimmed(&self, id: u64, args: &[Value], depth: usize) -> Result<Arc<dyn Curve>, Unread> {
        let basis_id = self.to(id, args, 1)?;
        let basis = self.curve(basis_id, depth + 1)?;
        let forward = arg(args, 4).flag().unwrap_or(true);
        let mut ends = [Point3::origin(); 2];
        for (end, k) in ends.iter_mut().zip([2, 3]) {
            let choices = arg(args, k).list();
            *end = match choices.iter().find_map(Value::reference) {
                Some(p) => self.point(p)?,
                None => {
                    let Some(t) = choices.iter().find_map(Value::number) else {
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

    /// Any B_SPLINE_CURVE, or `None` for another kind.
    fn spline(&self, id: u64, record: &Record) -> Result<Option<Spline>, Unread> {
        const KINDS: [&str; 4] =
            ["B_SPLINE_CURVE_WITH_KNOTS", "BEZIER_CURVE", "QUASI_UNIFORM_CURVE", "UNIFORM_CURVE"];
        let kind = KINDS.into_iter().find(|k| record.is(k));
        // A complex record spreads the parameters over its parts; a simple one has them all, a name first.
        let (base, knots): (&[Value], &[Value]) = match (record.part("B_SPLINE_CURVE"), kind) {
            (Some(base), Some(kind)) => (base, record.part(kind).unwrap_or_default()),
            (Some(base), None) => (base, &[]),
            (None, Some(kind)) => {
                let args = record.part(kind).unwrap_or_default();
                (args.get(1..).unwrap_or_default(), args.get(6..).unwrap_or_default())
            }
            (None, None) => return Ok(None),
        };
        let degree = self.degree(id, base, 0)?;
        let poles = self.points(id, arg(base, 1).list())?;
        let knots = self.knots(id, kind, degree, poles.len(), arg(knots, 0), arg(knots, 1))?;
        let weights = match record.part("RATIONAL_B_SPLINE_CURVE") {
            Some(args) => arg(args, 0).list().iter().filter_map(Value::number).collect(),
            None => Vec::new(),
        };
        Spline::new(degree, knots, poles, weights)
            .map(Some)
            .map_err(|e| Unread::Malformed { id, what: e.to_string() })
    }

    fn degree(&self, id: u64, args: &[Value], k: usize) -> Result<usize, Unread> {
        let d = self.number(id, args, k)?;
        if d >= 1.0 && d <= MAX_DEGREE as f64 && d.fract() == 0.0 {
            Ok(d as usize)
        } else {
            Err(Unread::Malformed { id, what: format!("degree {d}, 1 to {MAX_DEGREE} can be read") })
        }
    }

    /// The knot vector of one direction: written out, or by the rule of the kind.
    fn knots(
        &self,
        id: u64,
        kind: Option<&str>,
        degree: usize,
        poles: usize,
        multiplicities: &Value,
        values: &Value,
    ) -> Result<Vec<f64>, Unread> {
        let need = poles + degree + 1;
        if kind.is_some_and(|k| k.ends_with("_WITH_KNOTS")) {
            let (m, v) = (multiplicities.list(), values.list());
            if m.len() != v.len() {
                let what = format!("{} multiplicities for {} knots", m.len(), v.len());
                return Err(Unread::Malformed { id, what });
            }
            let mut knots = Vec::new();
            for (m, v) in m.iter().zip(v) {
                let (Some(m), Some(v)) = (m.number(), v.number()) else {
                    return Err(Unread::Malformed { id, what: "a knot that is no number".into() });
                };
                if !(m >= 0.0 && m + knots.len() as f64 <= MAX_KNOTS as f64) {
                    return Err(Unread::Malformed { id, what: format!("knot multiplicity {m}") });
                }
                knots.extend(std::iter::repeat_n(v, m as usize));
            }
            if knots.len() != need {
                let what =
                    format!("{} knots for {poles} poles of degree {degree}, {need} are needed", knots.len());
                return Err(Unread::Malformed { id, what });
            }
            return Ok(knots);
        }
        let uniform = kind.is_some_and(|k| k.starts_with("UNIFORM"));
        if uniform {
            return Ok((0..need).map(|k| k as f64 - degree as f64).collect());
        }
        // Ends with full multiplicity; inside, Bezier pieces meet with the degree, quasi-uniform knots are simple.
        let bezier = kind.is_some_and(|k| k.starts_with("BEZIER"));
        let step = if bezier { degree } else { 1 };
        let inner = poles.saturating_sub(degree + 1);
        if bezier && !inner.is_multiple_of(degree) {
            let what = format!("{poles} poles make no whole number of Bezier pieces of degree {degree}");
            return Err(Unread::Malformed { id, what });
        }
        let mut knots = vec![0.0; degree + 1];
        knots.extend((0..inner).map(|k| (k / step + 1) as f64));
        knots.extend(std::iter::repeat_n((inner / step + 1) as f64, degree + 1));
        Ok(knots)
    }

    /// A surface. `reach` holds the face's boundary: swept surfaces without ends are built as far as it goes.
    pub(crate) fn surface(&self, id: u64, reach: &[Point3], depth: usize) -> Result<Carried, Unread> {
        let record = self.record(id)?;
        if depth >= MAX_CHAIN {
            return Err(Unread::Malformed { id, what: "surfaces refer to each other in a circle".into() });
        }
        let plain = |surface, kind| Ok(Carried { surface, kind, reversed: false });
        if let Some((shape, kind, placement)) = self.shape(id, record)? {
            let made =
                Analytic::new(shape, placement).map_err(|e| Unread::Malformed { id, what: e.to_string() })?;
            return plain(FaceSurface::Analytic(Arc::new(made)), kind);
        }
        if let Some((n, kind)) = self.spline_surface(id, record)? {
            return plain(FaceSurface::Nurbs(Arc::new(n)), kind);
        }
        if let Some(args) = record.part("RECTANGULAR_TRIMMED_SURFACE") {
            // The loops of the face are the limits; only the senses of the parameters remain.
            let mut inner = self.surface(self.to(id, args, 1)?, reach, depth + 1)?;
            let sense = |k| arg(args, k).flag().unwrap_or(true);
            inner.reversed ^= sense(6) != sense(7);
            return Ok(inner);
        }
        let malformed = |what: String| Unread::Malformed { id, what };
        if let Some(args) = record.part("SURFACE_OF_LINEAR_EXTRUSION") {
            let direction = self.vector(self.to(id, args, 2)?)?;
            let generatrix = self.generatrix(self.to(id, args, 1)?, reach, depth + 1)?;
            let d2 = direction.norm_squared();
            if d2 == 0.0 || reach.is_empty() {
                return Err(malformed("an extrusion without direction or boundary".into()));
            }
            let along = |points: &[Point3]| {
                points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |r, p| {
                    let t = p.coords.dot(&direction) / d2;
                    [r[0].min(t), r[1].max(t)]
                })
            };
            let (b, g) = (along(reach), along(generatrix.curve().poles()));
            let range = [b[0] - g[1], b[1] - g[0]];
            let made = extrude(&generatrix, &direction, range).map_err(|e| malformed(e.to_string()))?;
            return plain(FaceSurface::Nurbs(Arc::new(made)), FaceKind::Extrusion);
        }
        if let Some(args) = record.part("SURFACE_OF_REVOLUTION") {
            let axis = self.placement(self.to(id, args, 2)?)?;
            let generatrix = self.generatrix(self.to(id, args, 1)?, reach, depth + 1)?;
            let made = revolve(&generatrix, &axis, [0.0, TAU]).map_err(|e| malformed(e.to_string()))?;
            return plain(FaceSurface::Nurbs(Arc::new(made)), FaceKind::Revolution);
        }
        Err(Unread::Kind { id, kind: record.kind() })
    }

    /// A curve to sweep, as a spline that holds at least the part in use.
    fn generatrix(&self, id: u64, reach: &[Point3], depth: usize) -> Result<Spline, Unread> {
        let record = self.record(id)?;
        if depth >= MAX_CHAIN {
            return Err(Unread::Malformed { id, what: "curves refer to each other in a circle".into() });
        }
        let malformed = |what: String| Unread::Malformed { id, what };
        if let Some(spline) = self.spline(id, record)? {
            return Ok(spline);
        }
        if let Some(e) = self.ellipse(id, record)? {
            let (x, y) = (e.frame.x.into_inner() * e.semi_axes[0], e.frame.y.into_inner() * e.semi_axes[1]);
            return Spline::arc(e.frame.origin, x, y, [0.0, TAU]).map_err(|e| malformed(e.to_string()));
        }
        if let Some(args) = record.part("LINE") {
            let origin = self.point(self.to(id, args, 1)?)?;
            let direction = self.vector(self.to(id, args, 2)?)?;
            // No point of the face is farther from the line's origin than this, swept or not.
            let far = reach.iter().map(|p| (p - origin).norm()).fold(0.0, f64::max);
            let step = direction * (far / direction.norm());
            if !(step.norm() > 0.0 && step.norm().is_finite()) {
                return Err(malformed("a line without direction or boundary".into()));
            }
            return Spline::polyline(vec![origin - step, origin + step])
                .map_err(|e| malformed(e.to_string()));
        }
        if let Some(args) = record.part("TRIMMED_CURVE") {
            // More of the curve than is in use does no harm: the loops cut it. Its sense is the surface's.
            let basis = self.generatrix(self.to(id, args, 1)?, reach, depth + 1)?;
            return if arg(args, 4).flag() == Some(false) { Ok(basis.reversed()) } else { Ok(basis) };
        }
        if let Some(args) = record.part("POLYLINE") {
            let poles = self.points(id, arg(args, 1).list())?;
            return Spline::polyline(poles).map_err(|e| malformed(e.to_string()));
        }
        Err(Unread::Kind { id, kind: record.kind() })
    }

    fn shape(&self, id: u64, record: &Record) -> Result<Option<(Shape, FaceKind, Placement)>, Unread> {
        let found =
            ["PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "SPHERICAL_SURFACE", "TOROIDAL_SURFACE"]
                .into_iter()
                .find_map(|k| record.part(k).map(|a| (k, a)));
        let Some((kind, args)) = found else { return Ok(None) };
        let placement = self.placement(self.to(id, args, 1)?)?;
        let length = |k| Ok::<f64, Unread>(self.number(id, args, k)? * self.units.length_mm);
        let (shape, kind) = match kind {
            "PLANE" => (Shape::Plane, FaceKind::Plane),
            "CYLINDRICAL_SURFACE" => (Shape::Cylinder { radius_mm: length(2)? }, FaceKind::Cylinder),
            "CONICAL_SURFACE" => {
                let half_angle_rad = self.number(id, args, 3)? * self.units.angle_rad;
                (Shape::Cone { radius_mm: length(2)?, half_angle_rad }, FaceKind::Cone)
            }
            "SPHERICAL_SURFACE" => (Shape::Sphere { radius_mm: length(2)? }, FaceKind::Sphere),
            _ => {
                let (major_radius_mm, minor_radius_mm) = (length(2)?, length(3)?);
                if minor_radius_mm > major_radius_mm {
                    // A spindle torus passes through its axis; half of it is hidden inside the other half.
                    return Err(Unread::Kind { id, kind: "TOROIDAL_SURFACE wider than its radius".into() });
                }
                (Shape::Torus { major_radius_mm, minor_radius_mm }, FaceKind::Torus)
            }
        };
        Ok(Some((shape, kind, placement)))
    }

    fn spline_surface(&self, id: u64, record: &Record) -> Result<Option<(NurbsSurface, FaceKind)>, Unread> {
        const KINDS: [&str; 4] =
            ["B_SPLINE_SURFACE_WITH_KNOTS", "BEZIER_SURFACE", "QUASI_UNIFORM_SURFACE", "UNIFORM_SURFACE"];
        let kind = KINDS.into_iter().find(|k| record.is(k));
        let (base, knots): (&[Value], &[Value]) = match (record.part("B_SPLINE_SURFACE"), kind) {
            (Some(base), Some(kind)) => (base, record.part(kind).unwrap_or_default()),
            (Some(base), None) => (base, &[]),
            (None, Some(kind)) => {
                let args = record.part(kind).unwrap_or_default();
                (args.get(1..).unwrap_or_default(), args.get(8..).unwrap_or_default())
            }
            (None, None) => return Ok(None),
        };
        let degree = [self.degree(id, base, 0)?, self.degree(id, base, 1)?];
        let rows = arg(base, 2).list();
        let columns = rows.first().map_or(0, |r| r.list().len());
        let mut points = Vec::new();
        for row in rows {
            if row.list().len() != columns {
                let what = format!("rows of {columns} and {} poles", row.list().len());
                return Err(Unread::Malformed { id, what });
            }
            points.extend(self.points(id, row.list())?);
        }
        let count = [rows.len(), columns];
        let vector = |k: usize| self.knots(id, kind, degree[k], count[k], arg(knots, k), arg(knots, k + 2));
        let vectors = [vector(0)?, vector(1)?];
        let weights = match record.part("RATIONAL_B_SPLINE_SURFACE") {
            Some(args) => {
                let w: Vec<f64> =
                    arg(args, 0).list().iter().flat_map(Value::list).filter_map(Value::number).collect();
                if w.len() != points.len() {
                    let what = format!("{} weights for {} poles", w.len(), points.len());
                    return Err(Unread::Malformed { id, what });
                }
                // Equal weights change nothing and cost a division at every point.
                (w.iter().any(|x| *x != w[0])).then_some(w)
            }
            None => None,
        };
        let kind = if kind == Some("BEZIER_SURFACE") { FaceKind::Bezier } else { FaceKind::Bspline };
        let made = NurbsSurface::new(degree, vectors, Net { count, points, weights })
            .map_err(|e| Unread::Malformed { id, what: e.to_string() })?;
        Ok(Some((made, kind)))
    }
}
