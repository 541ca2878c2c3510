//! Two surfaces at once: where they meet, by Newton's method.
//!
//! With parameters `x = (u, v)` on the first surface and `(s, t)` on the second one the surfaces meet where
//! `S(u, v) - R(s, t) = 0`: three equations for four numbers. A fourth one says which of the points is meant.

use crate::trimmed::TrimmedSurface;
use nalgebra::{Matrix3, Matrix3x4, Matrix4, Vector3, Vector4};
use osculate_geom::{Axis, Point3, Surface, Unit3, Uv, Vec3, uv};

/// Newton steps at most: they double the digits, and three are common.
const STEPS: usize = 12;

/// A step along a side of the rectangle that goes no farther than this, as a part of one across it, stays at a pole.
const POLE: f64 = 1e-9;
/// A line passes a pole if it is this many times as near as surfaces that meet.
const NEAR_POLE: f64 = 100.0;

/// A surface that may be asked a little beyond its rectangle, where it goes on straight.
#[derive(Clone, Copy)]
pub(super) struct Sheet<'a> {
    pub(super) surface: &'a TrimmedSurface,
}

/// A place of a surface with its first derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangents {
    pub(super) point: Point3,
    pub(super) du: Vec3,
    pub(super) dv: Vec3,
}

impl<'a> Sheet<'a> {
    pub(super) const fn new(surface: &'a TrimmedSurface) -> Self {
        Self { surface }
    }

    pub(super) fn at(&self, at: Uv) -> Tangents {
        let domain = self.surface.domain();
        // How far beyond a side that is one.
        let beyond = |axis: Axis| {
            let i = domain.get(axis);
            if i.periodic { 0.0 } else { at.get(axis) - at.get(axis).clamp(i.lo, i.hi) }
        };
        let (u, v) = (beyond(Axis::U), beyond(Axis::V));
        let jet = self.surface.jet2(uv(at.u - u, at.v - v));
        Tangents { point: jet.point + jet.du * u + jet.dv * v, du: jet.du, dv: jet.dv }
    }

    /// The outward unit normal; none where the surface has no tangent plane.
    pub(super) fn normal(&self, at: Uv) -> Option<Vec3> {
        let jet = self.surface.jet2(self.surface.domain().bring(at));
        jet.normal().ok().map(Unit3::into_inner)
    }

    /// The change of parameters that moves the point by `by`, as nearly as the tangent plane allows.
    pub(super) fn step(&self, t: &Tangents, by: &Vec3) -> Option<Uv> {
        let (e, f, g) = (t.du.norm_squared(), t.du.dot(&t.dv), t.dv.norm_squared());
        let det = e * g - f * f;
        let (p, q) = (t.du.dot(by), t.dv.dot(by));
        let step = uv((g * p - f * q) / det, (e * q - f * p) / det);
        (step.u.is_finite() && step.v.is_finite()).then_some(step)
    }

    /// The foot of a point near parameters, and its distance; none where the search does not settle.
    pub(super) fn foot(&self, p: &Point3, from: Uv, close_mm: f64) -> Option<(Uv, Point3)> {
        let mut at = from;
        for _ in 0..2 * STEPS {
            let t = self.at(at);
            let by = p - t.point;
            let step = self.step(&t, &by)?;
            at = uv(at.u + step.u, at.v + step.v);
            if (t.du * step.u + t.dv * step.v).norm() <= close_mm {
                return Some((at, self.at(at).point));
            }
        }
        None
    }
}

/// A place where two surfaces meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meet {
    /// Parameters on either.
    pub(super) at: [Uv; 2],
    /// The point on the first one, mm.
    pub(super) point: Point3,
}

/// Two surfaces, and how near counts as meeting.
#[derive(Clone, Copy)]
pub(super) struct Pair<'a> {
    pub(super) sheets: [Sheet<'a>; 2],
    /// Distance between the surfaces below which they meet, mm.
    pub(super) close_mm: f64,
}

/// A plane across the line of intersection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Across {
    pub(super) through: Point3,
    pub(super) normal: Vec3,
}

impl Pair<'_> {
    /// The meeting place nearest to parameters, about.
    pub(super) fn near(&self, from: [Uv; 2]) -> Option<Meet> {
        self.settle(from, |a, b, miss| {
            // The shortest step, each parameter measured by the way that it goes.
            let columns = [a.du, a.dv, -b.du, -b.dv];
            let scale = columns.map(|c| if c.norm() > 0.0 { c.norm().recip() } else { 0.0 });
            let m = Matrix3x4::from_columns(&[0, 1, 2, 3].map(|k| columns[k] * scale[k]));
            let y = m.transpose() * (m * m.transpose()).lu().solve(&-miss)?;
            Some(Vector4::new(y[0] * scale[0], y[1] * scale[1], y[2] * scale[2], y[3] * scale[3]))
        })
    }

    /// The meeting place in a plane.
    pub(super) fn in_plane(&self, from: [Uv; 2], plane: &Across) -> Option<Meet> {
        self.settle(from, |a, b, miss| {
            let n = &plane.normal;
            let row = |c: Vec3, last: f64| Vector4::new(c.x, c.y, c.z, last);
            let m = Matrix4::from_columns(&[
                row(a.du, n.dot(&a.du)),
                row(a.dv, n.dot(&a.dv)),
                row(-b.du, 0.0),
                row(-b.dv, 0.0),
            ]);
            m.lu().solve(&-row(*miss, n.dot(&(a.point - plane.through))))
        })
    }

    /// The meeting place on a segment between two places of one of the surfaces: the way along it, from 0 to 1, and the place.
    pub(super) fn on_segment(&self, which: usize, ends: [Uv; 2], from: Meet) -> Option<(f64, Meet)> {
        let [p, q] = ends;
        let d = uv(q.u - p.u, q.v - p.v);
        let length = d.u * d.u + d.v * d.v;
        let h = from.at[which];
        let mut way = ((h.u - p.u) * d.u + (h.v - p.v) * d.v) / length;
        let mut other = from.at[1 - which];
        // A side that is a single point, as the pole of a sphere, is met there or not at all.
        let here = between(p, q, way.clamp(0.0, 1.0));
        let a = self.sheets[which].at(here);
        if (a.du * d.u + a.dv * d.v).norm()
            <= POLE * (a.du.norm() * d.u.abs()).max(a.dv.norm() * length.sqrt())
        {
            let (other, foot) = self.sheets[1 - which].foot(&a.point, other, self.close_mm)?;
            let at = if which == 0 { [here, other] } else { [other, here] };
            let met = (foot - a.point).norm() <= NEAR_POLE * self.close_mm;
            return met.then_some((way.clamp(0.0, 1.0), Meet { at, point: a.point }));
        }
        for _ in 0..STEPS {
            let here = uv(p.u + way * d.u, p.v + way * d.v);
            let (a, b) = (self.sheets[which].at(here), self.sheets[1 - which].at(other));
            let miss: Vector3<f64> = a.point - b.point;
            if miss.norm() <= self.close_mm {
                let at = if which == 0 { [here, other] } else { [other, here] };
                return Some((way, Meet { at, point: a.point }));
            }
            let m = Matrix3::from_columns(&[a.du * d.u + a.dv * d.v, -b.du, -b.dv]);
            let y = m.lu().solve(&-miss)?;
            way += y[0];
            other = uv(other.u + y[1], other.v + y[2]);
            if !(way.is_finite() && other.u.is_finite() && other.v.is_finite()) {
                return None;
            }
        }
        None
    }

    /// Newton steps until the surfaces meet and the steps have settled.
    fn settle(
        &self,
        from: [Uv; 2],
        step: impl Fn(&Tangents, &Tangents, &Vector3<f64>) -> Option<Vector4<f64>>,
    ) -> Option<Meet> {
        let mut at = from;
        for _ in 0..STEPS {
            let [a, b] = [0, 1].map(|k| self.sheets[k].at(at[k]));
            let y = step(&a, &b, &(a.point - b.point))?;
            at = [uv(at[0].u + y[0], at[0].v + y[1]), uv(at[1].u + y[2], at[1].v + y[3])];
            if !y.iter().all(|c| c.is_finite()) {
                return None;
            }
            let moved = (a.du * y[0] + a.dv * y[1]).norm().max((b.du * y[2] + b.dv * y[3]).norm());
            if moved <= self.close_mm {
                return Some(Meet { at, point: self.sheets[0].at(at[0]).point });
            }
        }
        None
    }

    /// The unit direction of the line of intersection; none where the surfaces touch.
    pub(super) fn along(&self, at: [Uv; 2], least_sine: f64) -> Option<Vec3> {
        let [a, b] = [0, 1].map(|k| {
            let t = self.sheets[k].at(at[k]);
            t.du.cross(&t.dv).try_normalize(0.0)
        });
        let across = a?.cross(&b?);
        (across.norm() >= least_sine).then(|| across.normalize())
    }
}

/// The parameters at a part of the way between two.
pub(super) fn between(a: Uv, b: Uv, way: f64) -> Uv {
    uv(a.u + way * (b.u - a.u), a.v + way * (b.v - a.v))
}
