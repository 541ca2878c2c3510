//! Entities and curves of IGES, in millimetres; surfaces are in [`super::carriers`].
//!
//! Parameter-space curves use the same entities without units or model transforms: a [`Space`] says which.

use super::cards::{Cards, Entity, Param};
use super::names::kind_name;
use crate::knots::MAX_DEGREE;
use crate::trim::curve::{Curve, Ellipse, Line, Motion, Moved, Piece, Polyline};
use crate::trim::spline::Spline;
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Vec3};
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

    pub(super) fn triple(&self, de: i64, e: &Entity, k: usize) -> Result<Vec3, Unread> {
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
    pub(super) fn arc(&self, de: i64, e: &Entity, unit: f64) -> Result<Ellipse, Unread> {
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
    pub(super) fn copious(&self, de: i64, e: &Entity, unit: f64) -> Result<Vec<Point3>, Unread> {
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

    pub(super) fn degree(&self, de: i64, e: &Entity, k: usize) -> Result<usize, Unread> {
        let d = self.number(de, e, k)?;
        if d >= 1.0 && d <= MAX_DEGREE as f64 && d.fract() == 0.0 {
            Ok(d as usize)
        } else {
            Err(Unread::Malformed { de, what: format!("degree {d}, 1 to {MAX_DEGREE} can be read") })
        }
    }

    /// Entity 126 and its range.
    pub(super) fn spline(&self, de: i64, e: &Entity, unit: f64) -> Result<(Spline, [f64; 2]), Unread> {
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
}
