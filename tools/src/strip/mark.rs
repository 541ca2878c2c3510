//! The mark of one tooth: how far along the feed the tool, standing still at a contact, stays within a tolerance.
//!
//! Between two passages of the cutting edges the tool stands, in effect, once at each end of the feed per tooth; the ridge
//! between is as high as the tolerance when the feed per tooth is the length of the mark. This is the exact form of the
//! greatest feed per tooth [R97, eq. 41], the body of revolution standing for the edges.

use super::asked::StripError;
use super::knotted::Knotted;
use super::traced::Traced;
use crate::contact::{Contact, ContactLine};
use crate::cutter::Line;
use osculate_geom::line::SurfaceLine;
use osculate_geom::quadrature::gauss;
use osculate_geom::roots::{End, bracketed};

/// The mark of a tooth along the feed line; arc lengths on the part, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Mark {
    /// From the contact forward.
    pub ahead_mm: f64,
    /// From the contact back.
    pub behind_mm: f64,
    /// Estimate of the numerical error of the sum.
    pub error_mm: f64,
    /// Whether the mark ends at an edge of the surface: `[ahead, behind]`.
    pub at_edge: [bool; 2],
}

impl Mark {
    /// The greatest feed per tooth, mm.
    #[must_use]
    pub const fn length_mm(&self) -> f64 {
        self.ahead_mm + self.behind_mm
    }
}

/// Steps of the walk in leading-order half lengths.
const STEPS: f64 = 4.0;
/// Most steps of the walk.
const MAX_STEPS: u32 = 2000;

/// The mark that one tooth leaves within `height_mm` of the part along the feed line.
///
/// ```
/// use osculate_geom::{Axis, Domain, Interval, analytic::Plane, uv};
/// use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
/// // Standing still on a plane a ball leaves a round dent: as long as its strip is wide.
/// let range = Interval::new(0.0, 50.0);
/// let plane = Plane::new(Domain { u: range, v: range });
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
/// let contact = Contact::new(&plane, uv(25.0, 25.0), &ball, FeedLine::Iso(Axis::U), Lean::default())?;
/// let h = 0.001_f64;
/// let mark = strip::mark(&contact, h)?;
/// assert!((mark.length_mm() - 2.0 * (h * (10.0 - h)).sqrt()).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StripError`].
pub fn mark(contact: &Contact<'_>, height_mm: f64) -> Result<Mark, StripError> {
    if !(height_mm > 0.0 && height_mm.is_finite()) {
        return Err(StripError::Tolerance { got: height_mm });
    }
    let (line, t0) = contact.line()?;
    let pose = contact.pose();
    let radius = contact.cutter.radius_mm();
    let part = Knotted::new(contact.surface);
    let traced = match &line {
        ContactLine::Geodesic(line) => {
            let rate = contact.forms.rate(&contact.surface.jet2(contact.at), &contact.frame.tangent);
            Some(Traced::new(contact, &part, line, part.pitch_mm(contact.at, rate, radius))?)
        }
        ContactLine::Iso(_) => None,
    };
    let line = traced.as_ref().map_or(&line as &dyn SurfaceLine, |t| t);
    // Above the tolerance: positive; None where the line has ended.
    let excess = |t: f64| -> Option<f64> {
        let (frame, _) = line.frame(t).ok()?;
        let up = Line { origin: frame.point, direction: frame.normal };
        Some(contact.cutter.entry(&pose, &up).map_or(radius, |e| e.at_mm - height_mm))
    };
    let first = excess(t0).unwrap_or(f64::INFINITY);
    if first > height_mm * 1e-6 {
        return Err(StripError::AboveTolerance { standoff_mm: first + height_mm, scallop_mm: height_mm });
    }
    let speed = |t: f64| line.frame(t).map_or(0.0, |(_, s)| s);
    let mm = speed(t0).abs().max(1e-12);
    let along = contact.relative().along(&contact.frame.tangent);
    // A sharp edge meets the part within a fraction of the tool.
    let half = if along.is_finite() && along > 0.0 {
        (2.0 * height_mm / along).sqrt().min(radius)
    } else {
        (height_mm * radius).sqrt().min(radius)
    };
    let step = half / STEPS / mm * speed(t0).signum();
    let walk = |sign: f64| -> Result<(f64, f64, bool), StripError> {
        let mut near = (t0, first.min(0.0));
        let mut step = sign * step;
        for _ in 0..MAX_STEPS {
            let far = near.0 + step;
            match excess(far) {
                None if step.abs() * mm < 1e-9 * radius => return Ok((near.0, step.abs() * mm, true)),
                None => step *= 0.5,
                Some(f) if f > 0.0 => {
                    let ends = [End { x: near.0, f: near.1.min(0.0) }, End { x: far, f }];
                    let tolerance = 1e-13 * (far - t0).abs();
                    let root = bracketed(ends[0], ends[1], tolerance, |t| excess(t).unwrap_or(f64::NAN))?;
                    return Ok((root.x, root.error * mm, false));
                }
                Some(f) => near = (far, f),
            }
        }
        Ok((near.0, step.abs() * mm, true))
    };
    let (ahead, behind) = (walk(1.0)?, walk(-1.0)?);
    // A geodesic runs by its length.
    let length = |t: f64| if traced.is_some() { (t - t0).abs() } else { gauss(t0, t, 1, speed).abs() };
    Ok(Mark {
        ahead_mm: length(ahead.0),
        behind_mm: length(behind.0),
        error_mm: ahead.1 + behind.1,
        at_edge: [ahead.2, behind.2],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cutter, CutterSpec, FeedLine, Lean};
    use osculate_geom::analytic::{Cylinder, Plane};
    use osculate_geom::{Axis, Domain, Interval, uv};

    /// A ball on a plane: two circles of radius R at distance f meet at `R - sqrt(R^2 - f^2/4)`.
    #[test]
    fn ball_on_a_plane() {
        let i = Interval::new(-50.0, 50.0);
        let plane = Plane::new(Domain { u: i, v: i });
        let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 }).unwrap();
        let lean = Lean { lead_rad: 0.3, tilt_rad: 0.2 };
        let c = Contact::new(&plane, uv(1.0, 2.0), &ball, FeedLine::Angle(0.7), lean).unwrap();
        for h in [1e-4, 1e-2, 0.3] {
            let want = 2.0 * (2.0f64 * 5.0 * h - h * h).sqrt();
            let got = mark(&c, h).unwrap();
            assert!((got.length_mm() - want).abs() < 1e-10 * want, "{got:?} against {want}");
            assert!((got.ahead_mm - got.behind_mm).abs() < 1e-10 * want);
        }
    }

    /// A flat end leaning forward: its bottom rises ahead by `tan(lead)`, its side behind by the cotangent.
    #[test]
    fn flat_end_on_a_plane() {
        let i = Interval::new(-50.0, 50.0);
        let plane = Plane::new(Domain { u: i, v: i });
        let flat = Cutter::try_from(CutterSpec::Flat { diameter_mm: 10.0, length_mm: 50.0 }).unwrap();
        let lean = Lean { lead_rad: 0.1, tilt_rad: 0.0 };
        let c = Contact::new(&plane, uv(1.0, 2.0), &flat, FeedLine::Iso(Axis::V), lean).unwrap();
        let got = mark(&c, 0.01).unwrap();
        let (a, b) = (0.01 / 0.1f64.tan(), 0.01 * 0.1f64.tan());
        let mut ends = [got.ahead_mm, got.behind_mm];
        ends.sort_by(f64::total_cmp);
        assert!((ends[0] - b).abs() < 1e-12 && (ends[1] - a).abs() < 1e-12, "{got:?} {a} {b}");
    }

    /// A ball along the circles of a cylinder: the planar form of two arcs is exact.
    #[test]
    fn ball_around_a_cylinder() {
        let part = Cylinder::new(40.0, Interval::new(-50.0, 50.0)).unwrap();
        let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 }).unwrap();
        let c = Contact::new(&part, uv(1.0, 2.0), &ball, FeedLine::Iso(Axis::U), Lean::default()).unwrap();
        let h = 0.02f64;
        let (kp, kt) = (1.0 / 40.0, 1.0 / 5.0);
        let x = (h * (2.0 - h * kt) / ((kp + kt) * (1.0 + kp * h))).sqrt();
        let want = 4.0 / kp * (0.5 * kp * x).asin();
        assert!((mark(&c, h).unwrap().length_mm() - want).abs() < 1e-10);
    }
}
