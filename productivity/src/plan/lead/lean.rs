//! Lead and tilt of a task: held, to be found, or a field over the face.

use crate::compare::Around;
use crate::plan::level::Spline;
use crate::plan::line::{PassLine, Rectangle};
use osculate_geom::{Axis, Forms, Jet2, Uv, Vec3};
use osculate_tools::{ContactError, Cutter, Lean};

/// How a local lead is found. Angles rad, rates rad/mm.
#[derive(Clone, Copy)]
pub struct LocalLead<'a> {
    /// Tilt, held.
    pub tilt_rad: f64,
    /// Least lead used.
    pub least_rad: f64,
    /// Greatest lead used.
    pub most_rad: f64,
    /// Greatest change of the lead per mm of the face; times the feed it bounds the angular rate that the lead adds.
    pub rate_rad_per_mm: f64,
    /// The holder, a cylinder that begins where the cutter ends.
    pub holder: Option<&'a Cutter>,
    /// What else the tool must stay out of.
    pub around: Option<&'a Around>,
}

impl LocalLead<'_> {
    /// Least lead, rad: below a degree a bottom rubs where it should cut.
    pub const LEAST_RAD: f64 = 0.017_453_292_519_943_295;
    /// Greatest lead, rad.
    pub const MOST_RAD: f64 = std::f64::consts::FRAC_PI_4;
}

/// Lead and tilt of a task.
#[derive(Clone, Copy)]
pub enum Leaning<'a> {
    /// Held along all passes.
    Held(Lean),
    /// To be found place by place, before passes are laid out.
    Local(&'a LocalLead<'a>),
    /// As found.
    Field(&'a LeadField),
}

impl From<Lean> for Leaning<'_> {
    fn from(lean: Lean) -> Self {
        Self::Held(lean)
    }
}

/// The direction in which passes run at a place, either sense; None where there is none.
pub(in crate::plan) type Feed<'a> = dyn Fn(Uv, &Jet2) -> Option<Vec3> + Sync + 'a;

impl Leaning<'_> {
    /// Lead and tilt at a place; the least lead where it has not been found yet.
    #[must_use]
    pub fn at(&self, at: Uv) -> Lean {
        match self {
            Self::Held(lean) => *lean,
            Self::Local(l) => Lean { lead_rad: l.least_rad, tilt_rad: l.tilt_rad },
            Self::Field(f) => f.at(at).0,
        }
    }

    /// Lead and tilt at a place, about, where they have not been found yet: at a lead of sine `R k` the far side of a disc of radius R
    /// just clears a face that is hollow by k, to second order and whatever the feed.
    pub(in crate::plan) fn about(&self, at: Uv, forms: &Forms, cutter: &Cutter) -> Lean {
        let Self::Local(l) = self else { return self.at(at) };
        let sine = cutter.radius_mm() * (-forms.principal().k_min).max(0.0);
        let lead_rad = sine.min(1.0).asin().clamp(l.least_rad, l.most_rad);
        Lean { lead_rad, tilt_rad: l.tilt_rad }
    }

    /// Refuses what is no lean.
    pub(in crate::plan) fn checked(&self) -> Result<(), ContactError> {
        match self {
            Self::Held(lean) => lean.checked().map(|_| ()),
            Self::Local(l) => {
                for lead_rad in [l.least_rad, l.most_rad] {
                    Lean { lead_rad, tilt_rad: l.tilt_rad }.checked()?;
                }
                Ok(())
            }
            Self::Field(_) => Ok(()),
        }
    }

    /// Lead and tilt along a line, and the lead's rate by the line's parameter.
    pub(in crate::plan) fn along(&self, line: &dyn PassLine, t: f64) -> (Lean, f64) {
        match self {
            Self::Field(f) => {
                let ((lean, slope), rate) = (f.at(line.uv(t)), line.rate(t));
                (lean, slope[0] * rate.u + slope[1] * rate.v)
            }
            held => (held.at(Uv { u: 0.0, v: 0.0 }), 0.0),
        }
    }
}

/// Lead over a face, with a tilt that is held.
#[derive(Clone, Debug)]
pub struct LeadField {
    pub(super) spline: Spline,
    pub(super) rectangle: Rectangle,
    pub(super) tilt_rad: f64,
    /// Places that no lead clears, and all at which one was looked for.
    pub(super) unmet: [usize; 2],
}

impl LeadField {
    /// Lead and tilt at a place, and the lead's derivatives by u and v; beyond the border of the face its border's.
    #[must_use]
    pub fn at(&self, at: Uv) -> (Lean, [f64; 2]) {
        let mut within = [true; 2];
        let held = |axis: Axis, within: &mut bool| {
            let (i, t) = (self.rectangle.domain.get(axis), at.get(axis));
            if t >= i.lo && t <= i.hi {
                t
            } else if self.rectangle.closes(axis) {
                (t - i.lo).rem_euclid(i.length()) + i.lo
            } else {
                *within = false;
                t.clamp(i.lo, i.hi)
            }
        };
        let place = Uv { u: held(Axis::U, &mut within[0]), v: held(Axis::V, &mut within[1]) };
        let jet = self.spline.jet(place);
        let slope = [0, 1].map(|k| if within[k] { jet.slope[k] } else { 0.0 });
        (Lean { lead_rad: jet.value, tilt_rad: self.tilt_rad }, slope)
    }
}
