//! Curves and surfaces of IGES entities, in millimetres.
//!
//! Parameter-space curves use the same entities without units or model transforms: a [`Space`] says which.

use super::cards::{Cards, Entity, Param};
use crate::knots::MAX_DEGREE;
use crate::nurbs::{Net, NurbsSurface};
use crate::part::FaceKind;
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use crate::trim::curve::{Curve, Ellipse, Line, Motion, Moved, Piece, Polyline};
use crate::trim::spline::Spline;
use crate::trim::sweep::{extrude, revolve};
use osculate_geom::analytic::Placement;
use osculate_geom::{Axis, Point3, Unit3, Vec3};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Why an entity could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Unread {
    /// A pointer to nothing.
    #[error("directory entry {de} does not exist or could not be read")]
    Missing { de: i64 },
    /// A kind that is not read.
    #[error("directory entry {de} is a {}, which is not read", kind_name(*.kind, *.form))]
    Kind { de: i64, kind: u32, form: i32 },
    /// Parameters that make no such entity.
    #[error("directory entry {de}: {what}")]
    Malformed { de: i64, what: String },
}

/// What a curve's numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Space {
    /// Model space: scaled to millimetres, transforms applied.
    Model,
    /// Parameters of a surface: as they are.
    Parameter,
}

/// Pointers followed from one curve or transform to another at most.
const MAX_CHAIN: usize = 16;

/// Pieces of composite curves at most, a bound for files whose composites contain each other.
const MAX_PIECES: usize = 20_000;

/// A reader of geometry that keeps count of what it has read.
pub(crate) struct Geometry<'c> {
    pub(crate) cards: &'c Cards,
    /// Millimetres in one unit of the file's numbers.
    pub(crate) scale_mm: f64,
    /// Directory numbers that some face uses.
    pub(crate) used: RefCell<BTreeSet<i64>>,
}

impl Geometry<'_> {
    /// The entity of a directory entry, noted as used.
    pub(crate) fn entity(&self, de: i64) -> Result<&Entity, Unread> {
        let entity = self.cards.entities.get(&de).ok_or(Unread::Missing { de })?;
        self.used.borrow_mut().insert(de);
        Ok(entity)
    }

    /// Parameter `k` (from zero) as a number; a default is zero.
    pub(crate) fn number(&self, de: i64, e: &Entity, k: usize) -> Result<f64, Unread> {
        match e.params.get(k) {
            Some(Param::Number(x)) => Ok(*x),
            Some(Param::Default) => Ok(0.0),
            Some(_) => Err(Unread::Malformed { de, what: format!("parameter {} is no number", k + 1) }),
            None => Err(Unread::Malformed {
                de,
                what: format!("{} parameters, at least {} are needed", e.params.len(), k + 1),
            }),
        }
    }

    /// Parameter `k` as a pointer; zero is none.
    pub(crate) fn pointer(&self, de: i64, e: &Entity, k: usize) -> Result<Option<i64>, Unread> {
        let p = self.number(de, e, k)?;
        // A negative pointer means the same entity with another role.
        Ok((p != 0.0 && p.fract() == 0.0).then(|| p.abs() as i64))
    }

    /// Parameter `k` as a count of things that take at least `each` parameters from `from` on.
    pub(crate) fn count(
        &self,
        de: i64,
        e: &Entity,
        k: usize,
        from: usize,
        each: usize,
    ) -> Result<usize, Unread> {
        let n = self.number(de, e, k)?;
        let room = e.params.len().saturating_sub(from) / each.max(1);
        if n >= 0.0 && n.fract() == 0.0 && n <= room as f64 {
            Ok(n as usize)
        } else {
            Err(Unread::Malformed { de, what: format!("a count of {n} where the parameters hold {room}") })
        }
    }

    fn triple(&self, de: i64, e: &Entity, k: usize) -> Result<Vec3, Unread> {
        Ok(Vec3::new(self.number(de, e, k)?, self.number(de, e, k + 1)?, self.number(de, e, k + 2)?))
    }

    /// The transform of an entity to model space, in millimetres.
    pub(crate) fn motion(&self, e: &Entity) -> Result<Motion, Unread> {
        let mut motion = Motion::identity();
        let mut next = e.transform;
        for _ in 0..MAX_CHAIN {
            if next <= 0 {
                return Ok(motion);
            }
            let de = next;
            let t = self.entity(de)?;
            if t.kind != 124 {
                return Err(Unread::Kind { de, kind: t.kind, form: t.form });
            }
            let row = |r: usize| -> Result<[f64; 4], Unread> {
                Ok([
                    self.number(de, t, 4 * r)?,
                    self.number(de, t, 4 * r + 1)?,
                    self.number(de, t, 4 * r + 2)?,
                    self.number(de, t, 4 * r + 3)?,
                ])
            };
            let [a, b, c] = [row(0)?, row(1)?, row(2)?];
            let linear = nalgebra::Matrix3::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
            // A rotation or reflection, to the six digits that sparse writers keep.
            if (linear * linear.transpose() - nalgebra::Matrix3::identity()).norm() > 1e-4 {
                return Err(Unread::Malformed {
                    de,
                    what: "a matrix that is no rotation or reflection".into(),
                });
            }
            let shift = Vec3::new(a[3], b[3], c[3]) * self.scale_mm;
            motion = motion.then(&Motion { linear, shift });
            next = t.transform;
        }
        Err(Unread::Malformed { de: next, what: "transforms refer to each other in a circle".into() })
    }

    fn unit(&self, space: Space) -> f64 {
        match space {
            Space::Model => self.scale_mm,
            Space::Parameter => 1.0,
        }
    }

    /// A curve as consecutive pieces; composites are taken apart. `outer` is applied last.
    pub(crate) fn pieces(&self, de: i64, space: Space, outer: &Motion) -> Result<Vec<Piece>, Unread> {
        let mut out = Vec::new();
        self.add_pieces(de, space, outer, 0, &mut out)?;
        Ok(out)
    }

    fn add_pieces(
        &self,
        de: i64,
        space: Space,
        outer: &Motion,
        depth: usize,
        out: &mut Vec<Piece>,
    ) -> Result<(), Unread> {
        if depth >= MAX_CHAIN || out.len() >= MAX_PIECES {
            return Err(Unread::Malformed { de, what: "composite curves contain each other".into() });
        }
        let e = self.entity(de)?;
        let motion = match space {
            Space::Model => self.motion(e)?.then(outer),
            Space::Parameter => *outer,
        };
        if e.kind == 102 {
            let n = self.count(de, e, 0, 1, 1)?;
            for k in 0..n {
                if let Some(member) = self.pointer(de, e, 1 + k)? {
                    // Points may stand between the curves.
                    if !matches!(self.entity(member)?.kind, 116 | 132) {
                        self.add_pieces(member, space, &motion, depth + 1, out)?;
                    }
                }
            }
            return Ok(());
        }
        let piece = self.simple(de, e, space)?;
        out.push(if motion == Motion::identity() {
            piece
        } else {
            Piece { curve: Arc::new(Moved { curve: piece.curve, motion }), ends: piece.ends }
        });
        Ok(())
    }

    /// A curve entity that is no composite, before its transform.
    fn simple(&self, de: i64, e: &Entity, space: Space) -> Result<Piece, Unread> {
        let unit = self.unit(space);
        let whole = |curve: Arc<dyn Curve>| {
            Piece::whole(curve).ok_or_else(|| Unread::Malformed { de, what: "a curve without ends".into() })
        };
        match e.kind {
            100 => {
                let arc = self.arc(de, e, unit)?;
                whole(Arc::new(arc))
            }
            106 if matches!(e.form, 1..=3 | 11..=13 | 63) => {
                let points = self.copious(de, e, unit)?;
                whole(Arc::new(Polyline { points }))
            }
            110 if e.form == 0 => {
                let a = Point3::from(self.triple(de, e, 0)? * unit);
                let b = Point3::from(self.triple(de, e, 3)? * unit);
                whole(Arc::new(Line::segment(a, b)))
            }
            126 => {
                let (spline, ends) = self.spline(de, e, unit)?;
                Ok(Piece { curve: Arc::new(spline), ends })
            }
            _ => Err(Unread::Kind { de, kind: e.kind, form: e.form }),
        }
    }

    /// Entity 100, counter-clockwise in a plane parallel to xy.
    fn arc(&self, de: i64, e: &Entity, unit: f64) -> Result<Ellipse, Unread> {
        let at = |k: usize| Ok::<f64, Unread>(self.number(de, e, k)? * unit);
        let z = at(0)?;
        let centre = Point3::new(at(1)?, at(2)?, z);
        let (a, b) = (Point3::new(at(3)?, at(4)?, z) - centre, Point3::new(at(5)?, at(6)?, z) - centre);
        let radius = a.norm();
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(Unread::Malformed { de, what: format!("an arc of radius {radius}") });
        }
        let (t0, mut t1) = (a.y.atan2(a.x), b.y.atan2(b.x));
        // Equal ends, to the digits of the file, are a full circle.
        if (a - b).norm() <= 1e-7 * radius {
            t1 = t0 + TAU;
        }
        while t1 <= t0 {
            t1 += TAU;
        }
        let frame = Placement { origin: centre, ..Placement::identity() };
        Ok(Ellipse { frame, semi_axes: [radius, radius], range: [t0, t1] })
    }

    /// Entity 106 as a polyline.
    fn copious(&self, de: i64, e: &Entity, unit: f64) -> Result<Vec<Point3>, Unread> {
        let layout = self.number(de, e, 0)?;
        let (from, each) = if layout == 1.0 {
            (3, 2)
        } else if layout == 2.0 {
            (2, 3)
        } else {
            (2, 6)
        };
        let n = self.count(de, e, 1, from, each)?;
        if n < 2 {
            return Err(Unread::Malformed { de, what: format!("a polyline of {n} points") });
        }
        let z = if each == 2 { self.number(de, e, 2)? } else { 0.0 };
        let mut points = Vec::with_capacity(n + 1);
        for k in 0..n {
            let at = from + each * k;
            let third = if each == 2 { z } else { self.number(de, e, at + 2)? };
            points.push(Point3::new(
                self.number(de, e, at)? * unit,
                self.number(de, e, at + 1)? * unit,
                third * unit,
            ));
        }
        if e.form == 63 && points[0] != points[n - 1] {
            points.push(points[0]);
        }
        Ok(points)
    }

    fn degree(&self, de: i64, e: &Entity, k: usize) -> Result<usize, Unread> {
        let d = self.number(de, e, k)?;
        if d >= 1.0 && d <= MAX_DEGREE as f64 && d.fract() == 0.0 {
            Ok(d as usize)
        } else {
            Err(Unread::Malformed { de, what: format!("degree {d}, 1 to {MAX_DEGREE} can be read") })
        }
    }

    /// Entity 126 and its range.
    fn spline(&self, de: i64, e: &Entity, unit: f64) -> Result<(Spline, [f64; 2]), Unread> {
        // Each pole takes at least five parameters: a knot, a weight and three coordinates.
        let n = self.count(de, e, 0, 6, 5)? + 1;
        let degree = self.degree(de, e, 1)?;
        let numbers = |from: usize, count: usize| -> Result<Vec<f64>, Unread> {
            (from..from + count).map(|k| self.number(de, e, k)).collect()
        };
        let knot_count = n + degree + 1;
        let knots = numbers(6, knot_count)?;
        let mut weights = numbers(6 + knot_count, n)?;
        let at = 6 + knot_count + n;
        let poles = (0..n)
            .map(|k| Ok(Point3::from(self.triple(de, e, at + 3 * k)? * unit)))
            .collect::<Result<Vec<_>, Unread>>()?;
        if weights.iter().all(|w| *w == weights[0]) {
            weights.clear();
        }
        let spline = Spline::new(degree, knots, poles, weights)
            .map_err(|e| Unread::Malformed { de, what: e.to_string() })?;
        let [lo, hi] = spline.range();
        let after = at + 3 * n;
        let ends = match (
            e.params.get(after).and_then(Param::number),
            e.params.get(after + 1).and_then(Param::number),
        ) {
            (Some(a), Some(b)) if a < b => [a.clamp(lo, hi), b.clamp(lo, hi)],
            _ => [lo, hi],
        };
        let ends = if ends[0] < ends[1] { ends } else { [lo, hi] };
        Ok((spline, ends))
    }

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

/// The standard's name of an entity.
pub(crate) fn kind_name(kind: u32, form: i32) -> String {
    let name = match kind {
        100 => "circular arc",
        102 => "composite curve",
        104 => "conic arc",
        106 => "copious data",
        108 => "plane",
        110 => "line",
        112 => "parametric spline curve",
        114 => "parametric spline surface",
        116 => "point",
        118 => "ruled surface",
        120 => "surface of revolution",
        122 => "tabulated cylinder",
        124 => "transformation matrix",
        126 => "rational B-spline curve",
        128 => "rational B-spline surface",
        130 => "offset curve",
        140 => "offset surface",
        141 => "boundary",
        142 => "curve on a parametric surface",
        143 => "bounded surface",
        144 => "trimmed surface",
        150..=168 => "solid primitive",
        180 => "boolean tree",
        184 => "solid assembly",
        186 => "manifold solid",
        190 => "plane surface",
        192 => "cylindrical surface",
        194 => "conical surface",
        196 => "spherical surface",
        198 => "toroidal surface",
        308 | 320 => "subfigure definition",
        408 | 420 => "subfigure instance",
        430 => "solid instance",
        502 => "vertex list",
        504 => "edge list",
        508 => "loop",
        510 => "face",
        514 => "shell",
        200..=299 => "annotation",
        _ => "entity",
    };
    if form == 0 { format!("{kind} {name}") } else { format!("{kind} {name}, form {form}") }
}
