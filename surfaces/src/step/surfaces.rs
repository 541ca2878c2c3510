//! Surfaces of a Part 21 file, in millimetres and radians.

use super::geometry::{Geometry, MAX_CHAIN, Unread};
use super::graph::{Record, arg};
use crate::part::FaceKind;
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use crate::trim::spline::Spline;
use crate::trim::sweep::{extrude, revolve};
use osculate_geom::Point3;
use osculate_geom::analytic::Placement;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A surface with its kind, and whether its normal is against the one of the surface returned.
pub(crate) struct Carried {
    pub(crate) surface: FaceSurface,
    pub(crate) kind: FaceKind,
    pub(crate) reversed: bool,
}

/// Keywords of the surfaces with closed forms.
const ELEMENTARY: [&str; 6] = [
    "PLANE",
    "CYLINDRICAL_SURFACE",
    "CONICAL_SURFACE",
    "SPHERICAL_SURFACE",
    "TOROIDAL_SURFACE",
    "DEGENERATE_TOROIDAL_SURFACE",
];

/// Relative difference below which the two radii of a torus are the same number, written with rounding.
const SAME_RADIUS: f64 = 1e-12;

impl Geometry<'_> {
    /// A surface. `reach` holds the face's boundary: swept surfaces without ends are built as far as it goes.
    pub(crate) fn surface(&self, id: u64, reach: &[Point3], depth: usize) -> Result<Carried, Unread> {
        let record = self.record(id)?;
        if depth >= MAX_CHAIN {
            return Err(Unread::Malformed { id, what: "surfaces refer to each other in a circle".into() });
        }
        let malformed = |what: String| Unread::Malformed { id, what };
        let plain = |surface, kind| Ok(Carried { surface, kind, reversed: false });
        if let Some((shape, kind, placement)) = self.shape(id, &record)? {
            let made =
                Analytic::new(shape, placement).map_err(|e| Unread::Malformed { id, what: e.to_string() })?;
            return plain(FaceSurface::Analytic(Arc::new(made)), kind);
        }
        if let Some((n, kind)) = self.spline_surface(id, &record)? {
            return plain(FaceSurface::Nurbs(Arc::new(n)), kind);
        }
        if let Some(args) = record.part("OFFSET_SURFACE") {
            let inner = self.surface(self.to(id, &args, 1)?, reach, depth + 1)?;
            let against = if inner.reversed { -1.0 } else { 1.0 };
            let distance_mm = self.number(id, &args, 2)? * self.units.length_mm * against;
            let surface = inner.surface.offset(distance_mm).map_err(malformed)?;
            return Ok(Carried { surface, kind: FaceKind::Offset, ..inner });
        }
        if let Some(args) = record.part("SURFACE_REPLICA") {
            let inner = self.surface(self.to(id, &args, 1)?, reach, depth + 1)?;
            let motion = self.operator(&self.record(self.to(id, &args, 2)?)?).map_err(malformed)?;
            let scale = motion.scale().ok_or_else(|| malformed("a replica that distorts".into()))?;
            let surface = inner.surface.moved(&motion, scale).map_err(|e| malformed(e.to_string()))?;
            return Ok(Carried { surface, reversed: inner.reversed != (scale < 0.0), ..inner });
        }
        if let Some(args) = record.part("CURVE_BOUNDED_SURFACE") {
            return self.surface(self.to(id, &args, 1)?, reach, depth + 1);
        }
        if let Some(args) = record.part("RECTANGULAR_TRIMMED_SURFACE") {
            // The loops of the face are the limits; only the senses of the parameters remain.
            let mut inner = self.surface(self.to(id, &args, 1)?, reach, depth + 1)?;
            let sense = |k| arg(&args, k).flag().unwrap_or(true);
            inner.reversed ^= sense(6) != sense(7);
            return Ok(inner);
        }
        if let Some(args) = record.part("SURFACE_OF_LINEAR_EXTRUSION") {
            let direction = self.vector(self.to(id, &args, 2)?)?;
            let generatrix = self.generatrix(self.to(id, &args, 1)?, reach, depth + 1)?;
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
            let axis = self.placement(self.to(id, &args, 2)?)?;
            let generatrix = self.generatrix(self.to(id, &args, 1)?, reach, depth + 1)?;
            let made = revolve(&generatrix, &axis, [0.0, TAU]).map_err(|e| malformed(e.to_string()))?;
            return plain(FaceSurface::Nurbs(Arc::new(made)), FaceKind::Revolution);
        }
        Err(Unread::Kind { id, kind: record.kind() })
    }

    /// A curve to sweep, as a spline that holds at least the part in use.
    pub(super) fn generatrix(&self, id: u64, reach: &[Point3], depth: usize) -> Result<Spline, Unread> {
        let record = self.record(id)?;
        if depth >= MAX_CHAIN {
            return Err(Unread::Malformed { id, what: "curves refer to each other in a circle".into() });
        }
        let malformed = |what: String| Unread::Malformed { id, what };
        if let Some(spline) = self.spline(id, &record)? {
            return Ok(spline);
        }
        if let Some(e) = self.ellipse(id, &record)? {
            let (x, y) = (e.frame.x.into_inner() * e.semi_axes[0], e.frame.y.into_inner() * e.semi_axes[1]);
            return Spline::arc(e.frame.origin, x, y, [0.0, TAU]).map_err(|e| malformed(e.to_string()));
        }
        if let Some(args) = record.part("LINE") {
            let origin = self.point(self.to(id, &args, 1)?)?;
            let direction = self.vector(self.to(id, &args, 2)?)?;
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
            let basis = self.generatrix(self.to(id, &args, 1)?, reach, depth + 1)?;
            return if arg(&args, 4).flag() == Some(false) { Ok(basis.reversed()) } else { Ok(basis) };
        }
        if let Some(args) = record.part("POLYLINE") {
            let poles = self.points(id, &arg(&args, 1).list())?;
            return Spline::polyline(poles).map_err(|e| malformed(e.to_string()));
        }
        Err(Unread::Kind { id, kind: record.kind() })
    }

    fn shape(&self, id: u64, record: &Record<'_>) -> Result<Option<(Shape, FaceKind, Placement)>, Unread> {
        let found = record.any(&ELEMENTARY).filter(|found| !found.1.is_empty());
        let Some((kind, args)) = found else { return Ok(None) };
        let placement = self.placement(self.to(id, &args, 1)?)?;
        let length = |k| Ok::<f64, Unread>(self.number(id, &args, k)? * self.units.length_mm);
        let (shape, kind) = match kind {
            "PLANE" => (Shape::Plane, FaceKind::Plane),
            "CYLINDRICAL_SURFACE" => (Shape::Cylinder { radius_mm: length(2)? }, FaceKind::Cylinder),
            "CONICAL_SURFACE" => {
                let half_angle_rad = self.number(id, &args, 3)? * self.units.angle_rad;
                (Shape::Cone { radius_mm: length(2)?, half_angle_rad }, FaceKind::Cone)
            }
            "SPHERICAL_SURFACE" => (Shape::Sphere { radius_mm: length(2)? }, FaceKind::Sphere),
            _ => {
                let (mut major_radius_mm, minor_radius_mm) = (length(2)?, length(3)?);
                // Radii that differ by their last digits are a horn torus: no spindle has parts that small.
                if (major_radius_mm - minor_radius_mm).abs() <= SAME_RADIUS * minor_radius_mm {
                    major_radius_mm = minor_radius_mm;
                }
                let outer = record.part("DEGENERATE_TOROIDAL_SURFACE").is_none_or(|d| {
                    // Alone in a complex record, else behind name, place and radii.
                    let flag = if d.len() > 4 { arg(&d, 4) } else { arg(&d, 0) };
                    flag.flag().unwrap_or(true)
                });
                let shape = if minor_radius_mm > major_radius_mm && !outer {
                    Shape::Lemon { major_radius_mm, minor_radius_mm }
                } else {
                    Shape::Torus { major_radius_mm, minor_radius_mm }
                };
                (shape, FaceKind::Torus)
            }
        };
        Ok(Some((shape, kind, placement)))
    }
}
