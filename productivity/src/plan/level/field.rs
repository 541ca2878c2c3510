//! Scalar fields over a face whose level lines are passes, and the line of one level near a place.
//!
//! A level line runs so that the field grows to its left, `b = n x t`; reversed it runs the other way. Along the path
//! `(u, v)' = (-phi_v, phi_u)` the field is constant, and one more derivative gives the path's acceleration, so that the
//! Darboux frame with its geodesic curvature is exact.

use crate::rectangle::Rectangle;
use crate::spline::{FieldJet, Spline};
use osculate_geom::line::LineError;
use osculate_geom::solve::symmetric;
use osculate_geom::{Darboux, Degenerate, Jet2, Surface, Unit3, Uv, Vec3, geodesic_curvature, uv};

/// A field over a face with two derivatives.
pub(crate) trait ScalarField: Sync {
    /// The jet at parameters where the surface's jet is at hand.
    fn at(&self, at: Uv, jet: &Jet2) -> FieldJet;
}

/// Height along a direction: level lines lie in parallel planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Height(pub Unit3);

impl ScalarField for Height {
    fn at(&self, _: Uv, jet: &Jet2) -> FieldJet {
        let d = self.0.into_inner();
        FieldJet {
            value: jet.point.coords.dot(&d),
            slope: [jet.du.dot(&d), jet.dv.dot(&d)],
            bend: [jet.duu.dot(&d), jet.duv.dot(&d), jet.dvv.dot(&d)],
        }
    }
}

impl ScalarField for Spline {
    fn at(&self, at: Uv, _: &Jet2) -> FieldJet {
        self.jet(at)
    }
}

/// A face with a field over it.
#[derive(Clone, Copy)]
pub(crate) struct Face<'a> {
    pub surface: &'a dyn Surface,
    pub rectangle: Rectangle,
    pub field: &'a dyn ScalarField,
}

/// Newton steps onto a level; quadratic convergence needs three or four.
const NEWTON: u32 = 12;
/// Steps up or down to a level, of which four times as many as Newton's may be shortened.
const LED: u32 = 5 * NEWTON;
/// Distance from the level that counts as on it, mm, as a share of one over the sampling of curvature: far below any
/// chord tolerance, far above rounding.
const ON_LEVEL_MM: f64 = 1e-8;

impl<'a> Face<'a> {
    /// Both jets at a place, brought round where the face closes; None outside.
    pub fn at(&self, at: Uv) -> Option<(Uv, Jet2, FieldJet)> {
        let at = self.rectangle.bring(at)?;
        let jet = self.surface.jet2(at);
        let phi = self.field.at(at, &jet);
        Some((at, jet, phi))
    }

    fn outside(at: Uv) -> LineError {
        LineError::Outside { at }
    }

    /// The place where the field has `level`, from `at` along `way`; the field's slope along it must not vanish.
    pub fn settle(&self, at: Uv, way: Uv, level: f64) -> Result<Uv, LineError> {
        let mut here = at;
        for _ in 0..NEWTON {
            let (_, jet, phi) = self.at(here).ok_or(Self::outside(here))?;
            let slope = phi.slope[0] * way.u + phi.slope[1] * way.v;
            let step = (level - phi.value) / slope;
            let length = jet.tangent(way).norm() * step.abs();
            if !length.is_finite() {
                return Err(Degenerate { at: here, sin_uv: 0.0 }.into());
            }
            here = uv(here.u + way.u * step, here.v + way.v * step);
            if length <= ON_LEVEL_MM {
                return Ok(here);
            }
        }
        Err(Degenerate { at: here, sin_uv: 0.0 }.into())
    }

    /// The place with `level` that the steepest way up or down from `at` leads to, in steps of at most `step_mm`: next to where the field
    /// turns back, or has a saddle, straight ways may pass the level by.
    pub fn led(&self, at: Uv, level: f64, step_mm: f64) -> Result<Uv, LineError> {
        let mut here = at;
        for _ in 0..LED {
            let (_, jet, phi) = self.at(here).ok_or(Self::outside(here))?;
            let (uphill, slope) = Self::ascent(&jet, &phi)?;
            let by_mm = (level - phi.value) / slope;
            let step = by_mm.clamp(-step_mm, step_mm);
            here = uv(here.u + uphill.u * step, here.v + uphill.v * step);
            if by_mm.abs() <= ON_LEVEL_MM {
                return Ok(here);
            }
        }
        Err(Degenerate { at: here, sin_uv: 0.0 }.into())
    }

    /// Steepest ascent: the parameter direction, and the field's slope along it for a mm.
    pub fn ascent(jet: &Jet2, phi: &FieldJet) -> Result<(Uv, f64), LineError> {
        let forms = jet.forms()?;
        let [a, b] = phi.slope;
        let [du, dv] = symmetric(forms.first, phi.slope);
        let way = uv(du, dv);
        let square = a * way.u + b * way.v;
        let slope = square.max(0.0).sqrt();
        if !(slope > 0.0 && slope.is_finite()) {
            return Err(Degenerate { at: jet.uv, sin_uv: 0.0 }.into());
        }
        // Scaled to a mm.
        Ok((uv(way.u / slope, way.v / slope), slope))
    }

    /// The frame of the level line at a place, and the parameters' first and second derivative by arc length along it, the
    /// second up to what lies along the line.
    pub fn frame(&self, at: Uv, reversed: bool) -> Result<(Darboux, Uv, Uv), LineError> {
        let (at, jet, phi) = self.at(at).ok_or(Self::outside(at))?;
        let forms = jet.forms()?;
        let ([a, b], [aa, ab, bb]) = (phi.slope, phi.bend);
        // The way to the left of (-phi_v, phi_u) about S_u x S_v is uphill.
        let sign = jet.side.sign() * if reversed { -1.0 } else { 1.0 };
        let rate = uv(-b * sign, a * sign);
        let acceleration = uv(-(ab * rate.u + bb * rate.v) * sign, (aa * rate.u + ab * rate.v) * sign);
        let direction: Vec3 = jet.tangent(rate);
        let speed = direction.norm();
        if !(speed > 0.0 && speed.is_finite()) {
            return Err(Degenerate { at, sin_uv: 0.0 }.into());
        }
        let k_g = geodesic_curvature(&jet, rate, acceleration)?;
        let frame = Darboux::with_forms(&jet, &forms, &direction, k_g);
        let s2 = speed * speed;
        Ok((frame, uv(rate.u / speed, rate.v / speed), uv(acceleration.u / s2, acceleration.v / s2)))
    }
}

/// A level line around a foot; `t` is arc length from there up to third order, mm, along the feed.
pub(crate) struct Near<'a> {
    face: Face<'a>,
    level: f64,
    foot: Uv,
    rate: Uv,
    bend: Uv,
    uphill: Uv,
    reversed: bool,
}

impl<'a> Near<'a> {
    /// The line of `level` through the foot that lies steepest up or down from `at`.
    pub fn below(face: Face<'a>, at: Uv, level: f64, reversed: bool) -> Result<Self, LineError> {
        let (_, jet, phi) = face.at(at).ok_or(Face::outside(at))?;
        let (uphill, _) = Face::ascent(&jet, &phi)?;
        let foot = face.settle(at, uphill, level)?;
        let (_, rate, second) = face.frame(foot, reversed)?;
        let bend = uv(0.5 * second.u, 0.5 * second.v);
        Ok(Self { face, level, foot, rate, bend, uphill, reversed })
    }

    fn place(&self, t: f64) -> Result<Uv, LineError> {
        let guess = uv(
            self.foot.u + (self.rate.u + self.bend.u * t) * t,
            self.foot.v + (self.rate.v + self.bend.v * t) * t,
        );
        if t == 0.0 { Ok(guess) } else { self.face.settle(guess, self.uphill, self.level) }
    }
}

impl osculate_geom::line::SurfaceLine for Near<'_> {
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError> {
        Ok((self.face.frame(self.place(t)?, self.reversed)?.0, 1.0))
    }
}

impl crate::plan::line::PassLine for Near<'_> {
    fn uv(&self, t: f64) -> Uv {
        self.place(t).unwrap_or(self.foot)
    }
    fn rate(&self, t: f64) -> Uv {
        uv(self.rate.u + 2.0 * self.bend.u * t, self.rate.v + 2.0 * self.bend.v * t)
    }
    fn reversed(&self) -> bool {
        self.reversed
    }
    fn range(&self) -> osculate_geom::Interval {
        osculate_geom::Interval::new(f64::MIN, f64::MAX)
    }
}
