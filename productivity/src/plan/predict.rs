//! A quick look at how long a plan will be, for ranking leads before any is planned.

use super::Task;
use osculate_geom::{Axis, Uv};
use osculate_tools::{Contact, FeedLine, strip};

/// Points a side of the look around a contact, which reaches one diameter of the tool.
const AROUND: i32 = 10;

/// Whether the tool at a contact goes deep into the face somewhere below its end.
fn digs_in(task: &Task<'_>, contact: &Contact<'_>) -> bool {
    let surface = task.surface;
    let jet = surface.jet2(contact.at);
    let step = 2.0 * task.cutter.radius_mm() / f64::from(AROUND);
    let (du, dv) = (step / jet.du.norm().max(1e-12), step / jet.dv.norm().max(1e-12));
    let pose = contact.pose();
    // Roughness next to the contact is not meant: seating deals with it.
    let limit = -(task.tolerance.gouge_mm + task.tolerance.scallop_mm);
    (-AROUND..=AROUND).any(|i| {
        (-AROUND..=AROUND).any(|j| {
            let at = Uv { u: contact.at.u + du * f64::from(i), v: contact.at.v + dv * f64::from(j) };
            surface.domain().contains(at) && task.cutter.distance(&pose, &surface.point(at)) < limit
        })
    })
}

/// Places a side at which [`predicted_length_mm`] looks.
const LOOKS: usize = 10;

/// A quick estimate of the length of isoparametric passes over a face: its area over the exact strip width, at a grid of
/// places, for the better of the two directions. Infinite where the tool does not fit, or digs in with its heel or side,
/// at a tenth of the places.
///
/// ```
/// use osculate_geom::{Domain, Interval, analytic::Plane};
/// use osculate_productivity::plan::{Task, Tolerance, predicted_length_mm};
/// use osculate_tools::{Cutter, CutterSpec, Lean};
///
/// let plane = Plane::new(Domain { u: Interval::new(0.0, 50.0), v: Interval::new(0.0, 40.0) });
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 })?;
/// let lean = Lean { lead_rad: 0.2, tilt_rad: 0.0 };
/// let tolerance = Tolerance { scallop_mm: 0.05, gouge_mm: 0.01, chord_mm: 0.005 };
/// let task = Task::new("top", &plane, &ball, lean, tolerance);
/// // Area over the strip's width, which on a plane is 2 sqrt(h (2 R - h)).
/// let expected_mm = 50.0 * 40.0 / (2.0 * f64::sqrt(0.05 * (10.0 - 0.05)));
/// assert!((predicted_length_mm(&task) / expected_mm - 1.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn predicted_length_mm(task: &Task<'_>) -> f64 {
    let d = task.surface.domain();
    let along = |axis: Axis| -> f64 {
        let (mut length, mut seen, mut bad) = (0.0, 0u32, 0u32);
        for i in 0..LOOKS {
            for j in 0..LOOKS {
                let at = d.at((i as f64 + 0.5) / LOOKS as f64, (j as f64 + 0.5) / LOOKS as f64);
                if !task.surface.contains(at) {
                    continue;
                }
                seen += 1;
                let jet = task.surface.jet2(at);
                let share =
                    jet.du.cross(&jet.dv).norm() * d.u.length() * d.v.length() / (LOOKS * LOOKS) as f64;
                let contact = task.contact_at(at, FeedLine::Iso(axis), 1.0);
                let strip = contact.ok().filter(|c| c.fits().is_ok() && !digs_in(task, c)).and_then(|c| {
                    strip::exact(&c, task.tolerance.scallop_mm)
                        .ok()
                        .filter(|s| s.undercut_mm <= task.tolerance.gouge_mm)
                });
                match strip {
                    Some(s) => length += share / s.width_mm,
                    None => bad += 1,
                }
            }
        }
        if seen == 0 || 10 * bad >= seen {
            return f64::INFINITY;
        }
        length * f64::from(seen) / f64::from(seen - bad)
    };
    along(Axis::U).min(along(Axis::V))
}
