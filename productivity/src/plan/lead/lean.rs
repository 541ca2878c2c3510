//! The tool's axis in a task: lead and tilt held, a lean to one side of the face, a lead to be found, as found, or a field of axes.

use crate::axis::AxisField;
use crate::compare::Around;
use crate::plan::line::PassLine;
use crate::rectangle::Rectangle;
use crate::spline::Spline;
use osculate_geom::{Darboux, Forms, Jet2, Uv, Vec3};
use osculate_tools::sweep::Moving;
use osculate_tools::{ContactError, Cutter, Holder, Lean, moving_with_axis};

/// How a local lead is found. Angles rad, rates rad/mm.
#[derive(Clone, Copy)]
pub struct LocalLead<'a> {
    /// Tilt, held; None: where the strip reaches as far to both sides of the contact as can be.
    pub tilt_rad: Option<f64>,
    /// Least lead used: [`Cutter::least_lean_rad`], unless one is given.
    pub least_rad: f64,
    /// Greatest lead used.
    pub most_rad: f64,
    /// Greatest change of the lead per mm of the face; times the feed it bounds the angular rate that the lead adds.
    pub rate_rad_per_mm: f64,
    /// The holder, whose nose sits where the cutter ends.
    pub holder: Option<&'a Holder>,
    /// What else the tool must stay out of.
    pub around: Option<&'a Around>,
}

impl LocalLead<'_> {
    /// Greatest lead, rad.
    pub const MOST_RAD: f64 = std::f64::consts::FRAC_PI_4;

    /// The tilt that is held, none where it is to be found.
    fn held_rad(&self) -> f64 {
        self.tilt_rad.unwrap_or(0.0)
    }
}

/// A lean with a lead towards the feed and a tilt whose side does not change with the sense of a pass, rad.
///
/// With d the unit tangent along which the parameter of the pass's line grows (the surface's own on an isoparametric line), t the feed, which
/// is d or -d, and n the outward normal, the axis is along `n + tan(lead) t + tan(side) (n x d)`: a positive side is to the left of the
/// growing parameter, seen from outside. Both lie strictly between -90 and 90 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideTilt {
    /// From n towards the feed.
    pub lead_rad: f64,
    /// From n to the left of the growing parameter.
    pub side_rad: f64,
}

impl SideTilt {
    /// Lead and tilt against the feed: the lead is that of the whole lean, zero or more. `speed` is that of the line by its parameter, negative where
    /// the feed runs against it.
    #[must_use]
    pub fn lean(self, speed: f64) -> Lean {
        let (ahead, side) = (self.lead_rad.tan(), self.side_rad.tan());
        let left = if speed < 0.0 { -side } else { side };
        Lean { lead_rad: ahead.hypot(left).atan(), tilt_rad: left.atan2(ahead) }
    }
}

/// The tool's axis in a task.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub enum Leaning<'a> {
    /// Lead and tilt held along all passes.
    Held(Lean),
    /// A lean to the same side of the face along passes to and fro.
    Sided(SideTilt),
    /// A lead to be found place by place, before passes are laid out.
    Local(&'a LocalLead<'a>),
    /// A lead as found.
    Field(&'a LeadField),
    /// Axes in the part's frame, the same for passes to and fro.
    Axes(&'a AxisField),
}

impl From<Lean> for Leaning<'_> {
    fn from(lean: Lean) -> Self {
        Self::Held(lean)
    }
}

/// The direction in which passes run at a place, either sense; None where there is none.
pub(in crate::plan) type Feed<'a> = dyn Fn(Uv, &Jet2) -> Option<Vec3> + Sync + 'a;

impl Leaning<'_> {
    /// Lead and tilt at a place against the frame of a line there, whose parameter moves it at `speed`; the least lead where it has not
    /// been found yet.
    #[must_use]
    pub fn against(&self, at: Uv, (frame, speed): (&Darboux, f64)) -> Lean {
        match self {
            Self::Held(lean) => *lean,
            Self::Sided(tilt) => tilt.lean(speed),
            Self::Local(l) => Lean { lead_rad: l.least_rad, tilt_rad: l.held_rad() },
            Self::Field(f) => f.at(at, speed < 0.0).0,
            Self::Axes(f) => Lean::of(&f.at(at).0, frame),
        }
    }

    /// Lead and tilt at a place, about, where they have not been found yet: at a lead of sine `R k` the far side of a disc of radius R
    /// just clears a face that is hollow by k, to second order and whatever the feed.
    pub(in crate::plan) fn about(&self, at: Uv, forms: &Forms, frame: &Darboux, cutter: &Cutter) -> Lean {
        let Self::Local(l) = self else { return self.against(at, (frame, 1.0)) };
        let sine = cutter.radius_mm() * (-forms.principal().k_min).max(0.0);
        let lead_rad = sine.min(1.0).asin().clamp(l.least_rad, l.most_rad);
        Lean { lead_rad, tilt_rad: l.held_rad() }
    }

    /// Refuses what is no lean.
    pub(in crate::plan) fn checked(&self) -> Result<(), ContactError> {
        match self {
            Self::Held(lean) => lean.checked().map(|_| ()),
            Self::Sided(tilt) => {
                for lead_rad in [tilt.lead_rad, tilt.side_rad, tilt.lean(1.0).lead_rad] {
                    Lean { lead_rad, tilt_rad: 0.0 }.checked()?;
                }
                Ok(())
            }
            Self::Local(l) => {
                for lead_rad in [l.least_rad, l.most_rad] {
                    Lean { lead_rad, tilt_rad: l.held_rad() }.checked()?;
                }
                Ok(())
            }
            Self::Field(_) | Self::Axes(_) => Ok(()),
        }
    }

    /// Lead and tilt on a line, against its frame at `t` or an average of that, with the speed there.
    pub(in crate::plan) fn on(&self, line: &dyn PassLine, t: f64, moved: (&Darboux, f64)) -> Lean {
        match self {
            Self::Held(lean) => *lean,
            Self::Field(f) => f.at(line.uv(t), line.reversed()).0,
            _ => self.against(line.uv(t), moved),
        }
    }

    /// The tool's motion on a line at `t`, held against a frame that moves at `speed` by the line's parameter.
    pub(in crate::plan) fn moving(
        &self,
        cutter: &Cutter,
        line: &dyn PassLine,
        t: f64,
        (frame, speed): (&Darboux, f64),
    ) -> Moving {
        match self {
            Self::Field(f) => {
                let ((lean, slopes), rate) = (f.at(line.uv(t), line.reversed()), line.rate(t));
                let rates = slopes.map(|[by_u, by_v]| by_u * rate.u + by_v * rate.v);
                lean.moving(cutter, frame, 0.0, (speed, rates))
            }
            Self::Axes(f) => {
                let ((axis, slope), rate) = (f.at(line.uv(t)), line.rate(t));
                moving_with_axis(cutter, frame, speed, &axis, &(slope[0] * rate.u + slope[1] * rate.v))
            }
            Self::Held(_) | Self::Sided(_) | Self::Local(_) => {
                self.on(line, t, (frame, speed)).moving(cutter, frame, 0.0, (speed, [0.0; 2]))
            }
        }
    }
}

/// Lead and tilt over a face, for passes along the growing parameter of their line and for those against it.
#[derive(Clone, Debug)]
pub struct LeadField {
    /// By sense; twice the same where one lead serves both.
    pub(super) senses: [Angles; 2],
    pub(super) rectangle: Rectangle,
    /// Places that no lead clears, and all at which one was looked for.
    pub(super) unmet: [usize; 2],
}

/// Fields of lead and tilt, rad.
#[derive(Clone, Debug)]
pub(super) struct Angles {
    pub lead: Spline,
    pub tilt: Spline,
}

impl LeadField {
    /// Lead and tilt at a place of a pass along the growing parameter of its line or against it, and the derivatives of both by u and v;
    /// beyond the border of the face its border's.
    #[must_use]
    pub fn at(&self, at: Uv, reversed: bool) -> (Lean, [[f64; 2]; 2]) {
        let (place, within) = self.rectangle.held(at);
        let angles = &self.senses[usize::from(reversed)];
        let [lead, tilt] = [&angles.lead, &angles.tilt].map(|s| s.jet(place));
        let slope = |by: [f64; 2]| [0, 1].map(|k| if within[k] { by[k] } else { 0.0 });
        (Lean { lead_rad: lead.value, tilt_rad: tilt.value }, [slope(lead.slope), slope(tilt.slope)])
    }
}
