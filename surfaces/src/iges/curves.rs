//! Curves of IGES entities, as pieces of a boundary and as splines to sweep.

use super::directory::Entity;
use super::geometry::{Geometry, MAX_CHAIN, Space, Unread};
use super::parametric;
use crate::trim::curve::{Curve, Ellipse, Line, Moved, Piece, Polyline};
use crate::trim::motion::Motion;
use crate::trim::spline::Spline;
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Members of composite curves within composite curves of one face at most: a bound for files whose composites contain
/// each other, empty ones included.
const MAX_MEMBERS: usize = 20_000;

/// Forms of copious data that are paths.
const PATHS: [i32; 7] = [1, 2, 3, 11, 12, 13, 63];

impl Geometry<'_> {
    /// A curve as consecutive pieces; composites are taken apart. `outer` is applied last.
    pub(crate) fn pieces(&self, de: i64, space: Space, outer: &Motion) -> Result<Vec<Piece>, Unread> {
        let mut out = Vec::new();
        self.add_pieces(de, space, outer, 0, &mut out)?;
        Ok(out)
    }

    pub(super) fn add_pieces(
        &self,
        de: i64,
        space: Space,
        outer: &Motion,
        depth: usize,
        out: &mut Vec<Piece>,
    ) -> Result<(), Unread> {
        self.within_chain(de, depth)?;
        let e = self.entity(de)?;
        let motion = match space {
            Space::Model => self.motion(e)?.then(outer),
            Space::Parameter => *outer,
        };
        if e.kind == 102 {
            for k in 0..self.count(de, e, 0, [1, 1])? {
                if let Some(member) = self.pointer(de, e, 1 + k)? {
                    // Points may stand between the curves.
                    if !matches!(self.entity(member)?.kind, 116 | 132) {
                        self.add_pieces(member, space, &motion, depth + 1, out)?;
                    }
                }
            }
            return Ok(());
        }
        let piece = self.simple(de, e, space, depth)?;
        out.push(if motion == Motion::identity() {
            piece
        } else {
            Piece { curve: Arc::new(Moved { curve: piece.curve, motion }), ends: piece.ends }
        });
        Ok(())
    }

    /// Refuses composites that contain each other, or each other's parts any number of times.
    fn within_chain(&self, de: i64, depth: usize) -> Result<(), Unread> {
        self.members.set(self.members.get() + usize::from(depth > 1));
        if depth >= MAX_CHAIN || self.members.get() > MAX_MEMBERS {
            return Err(self.malformed(de, "composite curves contain each other, or too many"));
        }
        Ok(())
    }

    /// A curve entity that is no composite, before its transform.
    fn simple(&self, de: i64, e: &Entity, space: Space, depth: usize) -> Result<Piece, Unread> {
        let unit = self.unit(space);
        let whole = |curve: Arc<dyn Curve>| {
            Piece::whole(curve).ok_or_else(|| self.malformed(de, "a curve without ends"))
        };
        match e.kind {
            100 => whole(Arc::new(self.arc(de, e, unit)?)),
            104 => self.conic(de, e, unit),
            106 if PATHS.contains(&e.form) => {
                whole(Arc::new(Polyline { points: self.copious(de, e, unit)? }))
            }
            110 if e.form == 0 => {
                let [a, b] = self.line(de, e, unit)?;
                whole(Arc::new(Line::segment(a, b)))
            }
            112 => whole(Arc::new(self.parametric_curve(de, e, unit)?)),
            126 => {
                let (spline, ends) = self.spline(de, e, unit)?;
                Ok(Piece { curve: Arc::new(spline), ends })
            }
            130 => {
                if depth + 1 >= MAX_CHAIN {
                    return Err(self.malformed(de, "offset curves refer to each other in a circle"));
                }
                self.offset_curve(de, e, space, depth)
            }
            _ => Err(Unread::Kind { de, kind: e.kind, form: e.form }),
        }
    }

    /// Entity 110.
    fn line(&self, de: i64, e: &Entity, unit: f64) -> Result<[Point3; 2], Unread> {
        let a = Point3::from(self.triple(de, e, 0)? * unit);
        let b = Point3::from(self.triple(de, e, 3)? * unit);
        if a == b {
            return Err(self.malformed(de, "a line of length zero"));
        }
        Ok([a, b])
    }

    /// Entity 100, counter-clockwise in a plane parallel to xy.
    fn arc(&self, de: i64, e: &Entity, unit: f64) -> Result<Ellipse, Unread> {
        let at = |k: usize| Ok::<f64, Unread>(self.number(de, e, k)? * unit);
        let z = at(0)?;
        let centre = Point3::new(at(1)?, at(2)?, z);
        let (a, b) = (Point3::new(at(3)?, at(4)?, z) - centre, Point3::new(at(5)?, at(6)?, z) - centre);
        let radius = a.norm();
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(self.malformed(de, format!("an arc of radius {radius}")));
        }
        let off = (b.norm() - radius).abs();
        // Beyond what seven digits of the coordinates explain.
        if off > 1e-5 * (radius + centre.coords.norm()) {
            self.say(format!(
                "DE {de}: the ends of the arc are {off:.3e} mm apart in their distance from its centre"
            ));
        }
        let (t0, mut t1) = (a.y.atan2(a.x), b.y.atan2(b.x));
        // Equal ends, to the digits of the file, are a full circle.
        if (a - b).norm() <= 1e-7 * radius {
            t1 = t0 + TAU;
        }
        if t1 <= t0 {
            t1 += TAU;
        }
        let frame = Placement { origin: centre, ..Placement::identity() };
        Ok(Ellipse { frame, semi_axes: [radius, radius], range: [t0, t1] })
    }

    /// Entity 106 as a polyline.
    fn copious(&self, de: i64, e: &Entity, unit: f64) -> Result<Vec<Point3>, Unread> {
        let layout = self.number(de, e, 0)?;
        let (from, each) = match layout {
            1.0 => (3, 2),
            2.0 => (2, 3),
            3.0 => (2, 6),
            _ => {
                return Err(
                    self.malformed(de, format!("copious data of layout {layout}, 1 to 3 have a meaning"))
                );
            }
        };
        let n = self.count(de, e, 1, [from, each])?;
        if n < 2 {
            return Err(self.malformed(de, format!("a polyline of {n} points")));
        }
        let z = if each == 2 { self.number(de, e, 2)? } else { 0.0 };
        let data = self.numbers(de, e, from, from + each * n)?;
        let mut points: Vec<Point3> = data
            .chunks_exact(each)
            .map(|c| Point3::new(c[0], c[1], if each == 2 { z } else { c[2] }) * unit)
            .collect();
        if e.form == 63 && points[0] != points[n - 1] {
            points.push(points[0]);
        }
        points.dedup();
        if points.len() < 2 {
            return Err(self.malformed(de, "a polyline whose points are all the same"));
        }
        Ok(points)
    }

    /// Entity 126 and its range.
    pub(super) fn spline(&self, de: i64, e: &Entity, unit: f64) -> Result<(Spline, [f64; 2]), Unread> {
        // Each pole takes at least five parameters: a knot, a weight and three coordinates.
        let n = self.count(de, e, 0, [6, 5])? + 1;
        let degree = self.degree(de, e, 1)?;
        let knot_count = n + degree + 1;
        let knots = self.numbers(de, e, 6, 6 + knot_count)?;
        let at = 6 + knot_count + n;
        let mut weights = self.numbers(de, e, 6 + knot_count, at)?;
        let poles = self
            .numbers(de, e, at, at + 3 * n)?
            .chunks_exact(3)
            .map(|c| Point3::new(c[0], c[1], c[2]) * unit)
            .collect::<Vec<_>>();
        if weights.iter().all(|w| *w == weights[0]) {
            weights.clear();
        }
        let spline = Spline::new(degree, knots, poles, weights)
            .map_err(|error| self.malformed(de, error.to_string()))?;
        let [lo, hi] = spline.range();
        let after = at + 3 * n;
        let named = [e.params.number(after), e.params.number(after + 1)];
        let ends = match named {
            [Some(a), Some(b)] if a < b => [a.clamp(lo, hi), b.clamp(lo, hi)],
            _ => [lo, hi],
        };
        // Ends outside the knots by no more than their digits are the knots' ends.
        if let [Some(a), Some(b)] = named {
            let beyond = (lo - a).max(b - hi);
            if beyond > 1e-6 * (hi - lo) && a < b {
                self.say(format!("DE {de}: its parameters run {beyond:.3e} beyond its knots; cut at them"));
            }
        }
        let ends = if ends[0] < ends[1] { ends } else { [lo, hi] };
        Ok((spline, ends))
    }

    /// Entity 112 as a spline.
    fn parametric_curve(&self, de: i64, e: &Entity, unit: f64) -> Result<Spline, Unread> {
        let n = self.count(de, e, 3, [5, 13])?;
        if n == 0 {
            return Err(self.malformed(de, "a parametric spline of no segments"));
        }
        let breaks = self.numbers(de, e, 4, 5 + n)?;
        let coefficients = self.numbers(de, e, 5 + n, 5 + 13 * n)?;
        let (spline, jump) = parametric::curve(&breaks, &coefficients, unit)
            .map_err(|error| self.malformed(de, error.to_string()))?;
        if let Some(jump_mm) = jump {
            self.say(format!(
                "DE {de}: its segments are up to {jump_mm:.3e} apart where they meet; they were joined"
            ));
        }
        Ok(spline)
    }

    /// A curve to sweep, as a spline; composites are joined.
    pub(super) fn generatrix(&self, de: i64) -> Result<Spline, Unread> {
        let mut parts = Vec::new();
        self.add_generatrices(de, &Motion::identity(), 0, &mut parts)?;
        let count = parts.len();
        let (joined, gap_mm) = super::join::joined(parts).map_err(|e| self.malformed(de, e.to_string()))?;
        if count > 1
            && gap_mm > 1e-6 * joined.curve().poles().iter().map(|p| p.coords.norm()).fold(0.0, f64::max)
        {
            self.say(format!(
                "DE {de}: its parts are up to {gap_mm:.3e} mm apart where they meet; they were joined"
            ));
        }
        Ok(joined)
    }

    fn add_generatrices(
        &self,
        de: i64,
        outer: &Motion,
        depth: usize,
        out: &mut Vec<Spline>,
    ) -> Result<(), Unread> {
        self.within_chain(de, depth)?;
        let e = self.entity(de)?;
        let motion = self.motion(e)?.then(outer);
        let unit = self.scale_mm;
        let bad = |error: crate::nurbs::CurveError| self.malformed(de, error.to_string());
        let spline = match e.kind {
            100 => {
                let arc = self.arc(de, e, unit)?;
                let r = arc.semi_axes[0];
                Spline::arc(arc.frame.origin, Vec3::x() * r, Vec3::y() * r, arc.range).map_err(bad)?
            }
            102 => {
                for k in 0..self.count(de, e, 0, [1, 1])? {
                    if let Some(member) = self.pointer(de, e, 1 + k)?
                        && !matches!(self.entity(member)?.kind, 116 | 132)
                    {
                        self.add_generatrices(member, &motion, depth + 1, out)?;
                    }
                }
                return Ok(());
            }
            104 => self.conic_spline(de, e, unit)?,
            106 if PATHS.contains(&e.form) => Spline::polyline(self.copious(de, e, unit)?).map_err(bad)?,
            110 => Spline::polyline(self.line(de, e, unit)?.to_vec()).map_err(bad)?,
            112 => self.parametric_curve(de, e, unit)?,
            126 => {
                let (spline, ends) = self.spline(de, e, unit)?;
                if ends == spline.range() {
                    spline
                } else {
                    super::join::part(&spline, ends).map_err(|e| self.malformed(de, e.to_string()))?
                }
            }
            _ => return Err(Unread::Kind { de, kind: e.kind, form: e.form }),
        };
        out.push(if motion == Motion::identity() { spline } else { spline.mapped(&motion).map_err(bad)? });
        Ok(())
    }
}
