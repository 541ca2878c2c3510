//! Surfaces of IGES entities as carriers of faces, in millimetres.

use super::cards::{Entity, Param};
use super::geometry::{Geometry, Space, Unread};
use crate::nurbs::{Net, NurbsSurface};
use crate::part::FaceKind;
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use crate::trim::curve::{Curve, Motion, Piece};
use crate::trim::spline::Spline;
use crate::trim::sweep::{extrude, revolve};
use osculate_geom::analytic::Placement;
use osculate_geom::{Axis, Point3, Unit3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

impl Geometry<'_> {
    /// A surface with its transform and `outer` applied, and its kind. The parameters of splines are those of the
    /// file; those of other kinds are not.
    pub(crate) fn surface(&self, de: i64, outer: &Motion) -> Result<(FaceSurface, FaceKind), Unread> {
        let e = self.entity(de)?;
        let motion = self.motion(e)?.then(outer);
        let malformed = |what: String| Unread::Malformed { de, what };
        match e.kind {
            128 => {
                let n = self.spline_surface(de, e, &motion)?;
                Ok((FaceSurface::Nurbs(Arc::new(n)), FaceKind::Bspline))
            }
            108 => {
                let normal = self.triple(de, e, 0)?;
                let n2 = normal.norm_squared();
                let Some(z) = Unit3::try_new(motion.linear * normal, 0.0) else {
                    return Err(malformed("a plane without normal".into()));
                };
                let origin = Point3::from(normal * (self.number(de, e, 3)? / n2 * self.scale_mm));
                let made = Analytic::new(Shape::Plane, Placement::new(motion.point(&origin), z, None))
                    .map_err(|e| malformed(e.to_string()))?;
                Ok((FaceSurface::Analytic(Arc::new(made)), FaceKind::Plane))
            }
            120 => {
                let axis =
                    self.pointer(de, e, 0)?.ok_or_else(|| malformed("a revolution without axis".into()))?;
                let generatrix = self
                    .pointer(de, e, 1)?
                    .ok_or_else(|| malformed("a revolution without generatrix".into()))?;
                let line = self.pieces(axis, Space::Model, &Motion::identity())?;
                let [a, b] = line
                    .first()
                    .map(Piece::end_points)
                    .ok_or_else(|| malformed("a revolution without axis".into()))?;
                let z =
                    Unit3::try_new(b - a, 0.0).ok_or_else(|| malformed("an axis of length zero".into()))?;
                let angles = [self.number(de, e, 2)?, self.number(de, e, 3)?];
                let sweep = angles[1] - angles[0];
                if !(sweep > 0.0 && sweep <= TAU * (1.0 + 1e-9)) {
                    return Err(malformed(format!("a revolution over {sweep} rad")));
                }
                let curve = self.generatrix(generatrix)?;
                let made =
                    revolve(&curve, &Placement::new(a, z, None), [angles[0], angles[1].min(angles[0] + TAU)])
                        .map_err(|e| malformed(e.to_string()))?;
                Ok((moved(de, made, &motion)?, FaceKind::Revolution))
            }
            122 => {
                let directrix = self
                    .pointer(de, e, 0)?
                    .ok_or_else(|| malformed("a cylinder without directrix".into()))?;
                let curve = self.generatrix(directrix)?;
                let end = Point3::from(self.triple(de, e, 1)? * self.scale_mm);
                let direction = end - curve.point(curve.range()[0]);
                if direction.norm() == 0.0 {
                    return Err(malformed("a cylinder of length zero".into()));
                }
                let made = extrude(&curve, &direction, [0.0, 1.0]).map_err(|e| malformed(e.to_string()))?;
                Ok((moved(de, made, &motion)?, FaceKind::Extrusion))
            }
            190 | 192 | 194 | 196 | 198 => {
                let (shape, kind, placement) = self.analytic(de, e)?;
                let placement = Placement::new(
                    motion.point(&placement.origin),
                    Unit3::new_normalize(motion.linear * placement.z.into_inner()),
                    Some(motion.linear * placement.x.into_inner()),
                );
                let made = Analytic::new(shape, placement).map_err(|e| malformed(e.to_string()))?;
                Ok((FaceSurface::Analytic(Arc::new(made)), kind))
            }
            _ => Err(Unread::Kind { de, kind: e.kind, form: e.form }),
        }
    }

    /// The analytic surfaces of boundary representations.
    fn analytic(&self, de: i64, e: &Entity) -> Result<(Shape, FaceKind, Placement), Unread> {
        let malformed = |what: &str| Unread::Malformed { de, what: what.into() };
        let origin = {
            let p = self.pointer(de, e, 0)?.ok_or_else(|| malformed("no location"))?;
            let point = self.entity(p)?;
            Point3::from(self.triple(p, point, 0)? * self.scale_mm)
        };
        let direction = |k: usize| -> Result<Option<Vec3>, Unread> {
            match e.params.get(k).and_then(Param::number) {
                Some(p) if p > 0.0 => {
                    let d = self.entity(p as i64)?;
                    Ok(Some(self.triple(p as i64, d, 0)?))
                }
                _ => Ok(None),
            }
        };
        let length = |k: usize| Ok::<f64, Unread>(self.number(de, e, k)? * self.scale_mm);
        let (shape, kind, z, x) = match e.kind {
            190 => (Shape::Plane, FaceKind::Plane, direction(1)?, direction(2)?),
            192 => {
                (Shape::Cylinder { radius_mm: length(2)? }, FaceKind::Cylinder, direction(1)?, direction(3)?)
            }
            194 => {
                let half_angle_rad = self.number(de, e, 3)?.to_radians();
                let shape = Shape::Cone { radius_mm: length(2)?, half_angle_rad };
                (shape, FaceKind::Cone, direction(1)?, direction(4)?)
            }
            196 => (Shape::Sphere { radius_mm: length(1)? }, FaceKind::Sphere, direction(2)?, direction(3)?),
            _ => {
                let shape = Shape::Torus { major_radius_mm: length(2)?, minor_radius_mm: length(3)? };
                (shape, FaceKind::Torus, direction(1)?, direction(4)?)
            }
        };
        let z = match z {
            Some(v) => Unit3::try_new(v, 0.0).ok_or_else(|| malformed("an axis of length zero"))?,
            None => Vec3::z_axis(),
        };
        Ok((shape, kind, Placement::new(origin, z, x)))
    }

    /// A curve to sweep, as a spline.
    fn generatrix(&self, de: i64) -> Result<Spline, Unread> {
        let e = self.entity(de)?;
        let motion = self.motion(e)?;
        let malformed = |what: String| Unread::Malformed { de, what };
        let spline = match e.kind {
            100 => {
                let arc = self.arc(de, e, self.scale_mm)?;
                let r = arc.semi_axes[0];
                Spline::arc(arc.frame.origin, Vec3::x() * r, Vec3::y() * r, arc.range)
                    .map_err(|e| malformed(e.to_string()))?
            }
            110 => {
                let a = Point3::from(self.triple(de, e, 0)? * self.scale_mm);
                let b = Point3::from(self.triple(de, e, 3)? * self.scale_mm);
                Spline::polyline(vec![a, b]).map_err(|e| malformed(e.to_string()))?
            }
            126 => self.spline(de, e, self.scale_mm)?.0,
            106 if matches!(e.form, 1..=3 | 11..=13 | 63) => {
                let poles = self.copious(de, e, self.scale_mm)?;
                Spline::polyline(poles).map_err(|e| malformed(e.to_string()))?
            }
            102 => {
                // A composite of one curve is that curve.
                let pieces = self.count(de, e, 0, 1, 1)?;
                if pieces == 1
                    && let Some(only) = self.pointer(de, e, 1)?
                    && only != de
                    && self.entity(only)?.kind != 102
                {
                    let inner = self.generatrix(only)?;
                    return inner.mapped(&motion).map_err(|e| malformed(e.to_string()));
                }
                return Err(malformed(format!("a composite generatrix of {pieces} pieces is not read")));
            }
            _ => return Err(Unread::Kind { de, kind: e.kind, form: e.form }),
        };
        spline.mapped(&motion).map_err(|e| malformed(e.to_string()))
    }

    /// Entity 128. The file runs through the poles with u fastest.
    fn spline_surface(&self, de: i64, e: &Entity, motion: &Motion) -> Result<NurbsSurface, Unread> {
        let count = |k: usize| -> Result<usize, Unread> { Ok(self.count(de, e, k, 9, 1)? + 1) };
        let count = [count(0)?, count(1)?];
        let degree = [self.degree(de, e, 2)?, self.degree(de, e, 3)?];
        let poles = count[0].checked_mul(count[1]).filter(|n| n.saturating_mul(4) <= e.params.len());
        let Some(poles) = poles else {
            let what = format!("{} x {} poles in {} parameters", count[0], count[1], e.params.len());
            return Err(Unread::Malformed { de, what });
        };
        let numbers = |from: usize, count: usize| -> Result<Vec<f64>, Unread> {
            (from..from + count).map(|k| self.number(de, e, k)).collect()
        };
        let lengths = [count[0] + degree[0] + 1, count[1] + degree[1] + 1];
        let knots = [numbers(9, lengths[0])?, numbers(9 + lengths[0], lengths[1])?];
        let at_weights = 9 + lengths[0] + lengths[1];
        let at_poles = at_weights + poles;
        let mut points = Vec::with_capacity(poles);
        let mut weights = Vec::with_capacity(poles);
        for i in 0..count[0] {
            for j in 0..count[1] {
                let k = j * count[0] + i;
                weights.push(self.number(de, e, at_weights + k)?);
                let p = Point3::from(self.triple(de, e, at_poles + 3 * k)? * self.scale_mm);
                points.push(motion.point(&p));
            }
        }
        // Equal weights change nothing and cost a division at every point.
        let weights = (weights.iter().any(|w| *w != weights[0])).then_some(weights);
        NurbsSurface::new(degree, knots, Net { count, points, weights })
            .map_err(|e| Unread::Malformed { de, what: e.to_string() })
    }

    /// The parameter rectangle that an entity 128 names, `[u0, u1, v0, v1]`.
    pub(crate) fn named_rectangle(&self, de: i64) -> Option<[f64; 4]> {
        let e = self.cards.entities.get(&de).filter(|e| e.kind == 128)?;
        let n = |k: usize| e.params.get(k).and_then(Param::number).map(|x| x as usize);
        let (k1, k2, m1, m2) = (n(0)?, n(1)?, n(2)?, n(3)?);
        let poles = (k1 + 1).checked_mul(k2 + 1)?;
        let at = poles.checked_mul(4)?.checked_add(9 + k1 + m1 + 2 + k2 + m2 + 2)?;
        let value = |k: usize| e.params.get(at + k).and_then(Param::number);
        Some([value(0)?, value(1)?, value(2)?, value(3)?])
    }
}

fn moved(de: i64, surface: NurbsSurface, motion: &Motion) -> Result<FaceSurface, Unread> {
    if *motion == Motion::identity() {
        return Ok(FaceSurface::Nurbs(Arc::new(surface)));
    }
    let net = surface.net();
    let points = net.points.iter().map(|p| motion.point(p)).collect();
    let net = Net { count: net.count, points, weights: net.weights.clone() };
    let knots = [Axis::U, Axis::V].map(|axis| surface.knots(axis).as_slice().to_vec());
    NurbsSurface::new(surface.degree(), knots, net)
        .map(|n| FaceSurface::Nurbs(Arc::new(n)))
        .map_err(|e| Unread::Malformed { de, what: e.to_string() })
}
