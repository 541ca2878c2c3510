//! Operations that are planned are kept beside the results, so that a run that was stopped goes on where it was.
//!
//! What is kept counts only for the same text of the job, the same bytes of every file that it names, and the same version of the
//! program. Numbers come back bit by bit.

use crate::failure::{Failure, beside, read};
use crate::job::{Job, Operations, Overrides};
use crate::work::choice::Row;
use crate::work::extras::{Extras, FaceLeftOut};
use crate::work::program::Planned;
use osculate_geom::{Diagnostic, Point3, Severity, Unit3, Uv, Vec3};
use osculate_productivity::compare::Axes;
use osculate_productivity::plan::{CcPoint, Linked, Pass, Passes, ThreeAxis, ThreeAxisLines};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::{Lean, Pose};
use serde::{Deserialize, Serialize};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Parameters, point, normal, tip and axis of a point of a pass, and its width where it has one: no text of a number says NaN.
type KeptPoint = ([f64; 14], Option<f64>);

/// Whence an axis can be, by the number that is kept.
const AXES: [Axes; 4] = [Axes::Held, Axes::Local, Axes::Balanced, Axes::Field];

/// What a search gave a job, as it is kept: the share of marks, the chord tolerance, and of a tool that keeps its axis the lines of its
/// passes, that axis and the way.
type KeptOverrides = (Option<f64>, Option<f64>, Option<f64>, Option<(u8, [f64; 6])>);

/// Lines of passes of a tool that keeps its axis, by the number that is kept.
const LINES: [ThreeAxisLines; 3] =
    [ThreeAxisLines::Planes, ThreeAxisLines::Gradient, ThreeAxisLines::Waterlines];

/// A planned operation as it is kept.
#[derive(Serialize, Deserialize)]
pub struct Kept {
    /// Of job, files and version.
    key: u64,
    /// The number of the tool in hand.
    tool: u32,
    own: KeptOverrides,
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
    moves: Vec<[f64; 8]>,
    pass_of_move: Vec<Option<u32>>,
    lengths_mm: [f64; 2],
    left_out: Vec<(String, f64)>,
    said: [Vec<(u8, String, String)>; 2],
    /// What it was chosen from.
    pub compared: Vec<Row>,
}

/// What an operation of a list depends on, as a number, of the list's own: what it is laid out for besides.
pub fn key_of(list: u64, at_most_mm: Option<f64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    (list, at_most_mm.map(f64::to_bits)).hash(&mut hasher);
    hasher.finish()
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
    pub fn of(key: u64, job: &Job, planned: &Planned<'_>) -> Self {
        let own = job.overrides();
        let three_axis = own.three_axis.map(|way| {
            let (a, f) = (way.axis, way.feed);
            let lines = LINES.iter().position(|l| *l == way.lines).unwrap_or(0) as u8;
            (lines, [a.x, a.y, a.z, f.x, f.y, f.z])
        });
        let point = |c: &CcPoint| {
            let mut out = [0.0; 14];
            let own = flat([c.point.coords, *c.normal, c.pose.tip.coords, *c.pose.axis]);
            out.iter_mut().zip([c.uv.u, c.uv.v].into_iter().chain(own)).for_each(|(to, from)| *to = from);
            (out, Some(c.width_mm).filter(|w| w.is_finite()))
        };
        let step = |m: &ClMove| {
            let (t, a) = (m.pose.tip, m.pose.axis);
            let feed = if let Motion::Feed(feed) = m.motion { feed } else { 0.0 };
            [t.x, t.y, t.z, a.x, a.y, a.z, feed, f64::from(u8::from(m.aloft))]
        };
        let linked = &planned.linked;
        Self {
            key,
            tool: job.tool().number(),
            own: (own.mark_share, own.chord_mm, own.blend_mm, three_axis),
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

    /// A job with the tool that was in hand, and what a search gave it.
    pub fn job(&self, job: Job) -> Job {
        let (mark_share, chord_mm, blend_mm, three_axis) = self.own;
        let three_axis = three_axis.map(|(lines, [x, y, z, u, v, w])| ThreeAxis {
            lines: LINES[usize::from(lines).min(LINES.len() - 1)],
            axis: Unit3::new_unchecked(Vec3::new(x, y, z)),
            feed: Vec3::new(u, v, w),
        });
        let job = if job.tools().len() > 1 { job.in_hand(self.tool) } else { job };
        job.with(Overrides { mark_share, chord_mm, blend_mm, three_axis, ..Overrides::default() })
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
        let step = |x: &[f64; 8]| ClMove {
            pose: Pose { tip: Point3::from(v(&x[..3])), axis: Unit3::new_unchecked(v(&x[3..6])) },
            motion: if x[6] > 0.0 { Motion::Feed(x[6]) } else { Motion::Rapid },
            aloft: x[7] > 0.0,
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn what_a_search_gave_comes_back() {
        let text = "format = 1\npart = { builtin = { kind = \"plane\", half_size_mm = 2 } }\ntolerance = { scallop_mm = 0.1 }\n\
            strategy = { kind = \"auto\" }\n[[tools]]\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 40\n[[tools]]\nkind = \"ball\"\ndiameter_mm = 4\n\
            length_mm = 40\n";
        let file = Job::from_toml(text, Path::new("two.toml")).unwrap();
        let planned = Planned {
            passes: Passes::default(),
            skipped: Vec::new(),
            linked: Linked::default(),
            strategy: "gradient_3c".to_owned(),
            lean: Lean::default(),
            axes: Axes::Held,
            extras: Extras::default(),
            with_strips: true,
        };
        let axis = Unit3::new_normalize(Vec3::new(0.1, 0.2, 0.3));
        for lines in LINES {
            let three_axis = Some(ThreeAxis { lines, axis, feed: Vec3::new(1.0, -2.0, 1.0 / 3.0) });
            let own = Overrides {
                mark_share: Some(0.1),
                chord_mm: Some(1.0 / 7.0),
                blend_mm: Some(1.0 / 70.0),
                three_axis,
                unreached_mm2: None,
            };
            for own in [own, Overrides::default()] {
                let job = file.each_tool()[1].with(own);
                let bytes = Kept::of(7, &job, &planned).bytes();
                let back = Kept::read(&bytes, 7).unwrap().job(file.clone());
                assert_eq!(back.overrides(), own);
                assert_eq!(back.tool().number(), job.tool().number());
                assert_eq!(back.strategy().name(), job.strategy().name());
                assert_eq!(back.strategy().kept_axis(), own.three_axis.map(|w| w.axis));
                assert!(Kept::read(&bytes, 8).is_none());
            }
        }
    }
}
