//! Operations that are planned are kept beside the results, so that a run that was stopped goes on where it was.
//!
//! What is kept counts only for the same text of the job, the same bytes of every file that it names, and the same version of the
//! program. Numbers come back bit by bit.

use crate::failure::{Failure, beside, read};
use crate::job::Operations;
use crate::work::choice::Row;
use crate::work::extras::{Extras, FaceLeftOut};
use crate::work::program::Planned;
use osculate_geom::{Diagnostic, Point3, Severity, Unit3, Uv, Vec3};
use osculate_productivity::compare::Axes;
use osculate_productivity::plan::{CcPoint, Linked, Pass, Passes};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::{Lean, Pose};
use serde::{Deserialize, Serialize};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Parameters, point, normal, tip and axis of a point of a pass, and its width where it has one: no text of a number says NaN.
type KeptPoint = ([f64; 14], Option<f64>);

/// Whence an axis can be, by the number that is kept.
const AXES: [Axes; 4] = [Axes::Held, Axes::Local, Axes::Balanced, Axes::Field];

/// A planned operation as it is kept.
#[derive(Serialize, Deserialize)]
pub struct Kept {
    /// Of job, files and version.
    key: u64,
    /// The number of the tool in hand.
    pub tool: u32,
    /// How high material stood, mm.
    pub standing_mm: Option<f64>,
    /// Of rest, the area that stood too high, mm2.
    pub too_high_mm2: Option<f64>,
    /// Wall time of planning, s.
    pub plan_s: f64,
    strategy: String,
    lean_rad: [f64; 2],
    axes: u8,
    with_strips: bool,
    passes: Vec<(bool, Vec<KeptPoint>)>,
    moves: Vec<[f64; 7]>,
    pass_of_move: Vec<Option<u32>>,
    lengths_mm: [f64; 2],
    left_out: Vec<(String, f64)>,
    said: [Vec<(u8, String, String)>; 2],
    /// What it was chosen from.
    pub compared: Vec<Row>,
}

/// What a list depends on, as a number.
///
/// # Errors
/// Where a file that it names cannot be read.
pub fn key(list: &Operations) -> Result<u64, Failure> {
    let mut hasher = DefaultHasher::new();
    env!("CARGO_PKG_VERSION").hash(&mut hasher);
    list.text().hash(&mut hasher);
    for file in list.files() {
        read(&beside(list.path(), file))?.hash(&mut hasher);
    }
    Ok(hasher.finish())
}

/// The name under which an operation is kept, by its place.
pub fn name(place: usize) -> String {
    format!("operation-{}.kept", place + 1)
}

fn said(all: &[Diagnostic]) -> Vec<(u8, String, String)> {
    all.iter().map(|d| (d.severity as u8, d.place.clone(), d.message.clone())).collect()
}

fn heard(all: &[(u8, String, String)]) -> Vec<Diagnostic> {
    let severity = |n: u8| match n {
        n if n == Severity::Note as u8 => Severity::Note,
        n if n == Severity::Warning as u8 => Severity::Warning,
        _ => Severity::Loss,
    };
    let one = |(n, place, message): &(u8, String, String)| Diagnostic {
        severity: severity(*n),
        place: place.clone(),
        message: message.clone(),
    };
    all.iter().map(one).collect()
}

/// Three numbers of each.
fn flat(parts: [Vec3; 4]) -> impl Iterator<Item = f64> {
    parts.into_iter().flat_map(|p| [p.x, p.y, p.z])
}

impl Kept {
    /// Of a plan.
    pub fn of(key: u64, tool: u32, planned: &Planned<'_>) -> Self {
        let point = |c: &CcPoint| {
            let mut out = [0.0; 14];
            let own = flat([c.point.coords, *c.normal, c.pose.tip.coords, *c.pose.axis]);
            out.iter_mut().zip([c.uv.u, c.uv.v].into_iter().chain(own)).for_each(|(to, from)| *to = from);
            (out, Some(c.width_mm).filter(|w| w.is_finite()))
        };
        let step = |m: &ClMove| {
            let (t, a) = (m.pose.tip, m.pose.axis);
            let feed = if let Motion::Feed(feed) = m.motion { feed } else { 0.0 };
            [t.x, t.y, t.z, a.x, a.y, a.z, feed]
        };
        let linked = &planned.linked;
        Self {
            key,
            tool,
            standing_mm: None,
            too_high_mm2: None,
            plan_s: 0.0,
            strategy: planned.strategy.clone(),
            lean_rad: [planned.lean.lead_rad, planned.lean.tilt_rad],
            axes: AXES.iter().position(|a| *a == planned.axes).unwrap_or(0) as u8,
            with_strips: planned.with_strips,
            passes: planned
                .passes
                .passes
                .iter()
                .map(|p| (p.closed, p.points.iter().map(point).collect()))
                .collect(),
            moves: linked.path.moves.iter().map(step).collect(),
            pass_of_move: linked.pass_of_move.clone(),
            lengths_mm: [linked.cutting_length_mm, linked.air_length_mm],
            left_out: planned.extras.left_out.iter().map(|f| (f.face.clone(), f.area_mm2)).collect(),
            said: [said(&planned.passes.diagnostics), said(&planned.extras.diagnostics)],
            compared: Vec::new(),
        }
    }

    /// As it is written.
    pub fn bytes(&self) -> Vec<u8> {
        // Plain numbers and texts can be written.
        serde_json::to_vec(self).unwrap_or_default()
    }

    /// What was written, where it is for the same list.
    pub fn read(bytes: &[u8], key: u64) -> Option<Self> {
        serde_json::from_slice::<Self>(bytes).ok().filter(|kept| kept.key == key)
    }

    /// The plan.
    pub fn planned(&self) -> Planned<'static> {
        let v = |x: &[f64]| Vec3::new(x[0], x[1], x[2]);
        let point = |(x, width): &KeptPoint| CcPoint {
            uv: Uv { u: x[0], v: x[1] },
            point: Point3::from(v(&x[2..5])),
            normal: Unit3::new_unchecked(v(&x[5..8])),
            pose: Pose { tip: Point3::from(v(&x[8..11])), axis: Unit3::new_unchecked(v(&x[11..14])) },
            width_mm: width.unwrap_or(f64::NAN),
        };
        let step = |x: &[f64; 7]| ClMove {
            pose: Pose { tip: Point3::from(v(&x[..3])), axis: Unit3::new_unchecked(v(&x[3..6])) },
            motion: if x[6] > 0.0 { Motion::Feed(x[6]) } else { Motion::Rapid },
        };
        let passes = self
            .passes
            .iter()
            .map(|(closed, points)| Pass { points: points.iter().map(point).collect(), closed: *closed });
        let [said, of_extras] = &self.said;
        let left_out = self.left_out.iter().map(|(face, a)| FaceLeftOut { face: face.clone(), area_mm2: *a });
        Planned {
            passes: Passes { passes: passes.collect(), diagnostics: heard(said) },
            skipped: Vec::new(),
            linked: Linked {
                path: ClPath { moves: self.moves.iter().map(step).collect(), ..ClPath::default() },
                pass_of_move: self.pass_of_move.clone(),
                cutting_length_mm: self.lengths_mm[0],
                air_length_mm: self.lengths_mm[1],
            },
            strategy: self.strategy.clone(),
            lean: Lean { lead_rad: self.lean_rad[0], tilt_rad: self.lean_rad[1] },
            axes: AXES.get(usize::from(self.axes)).copied().unwrap_or(Axes::Held),
            extras: Extras {
                left_out: left_out.collect(),
                diagnostics: heard(of_extras),
                ..Extras::default()
            },
            with_strips: self.with_strips,
        }
    }
}
