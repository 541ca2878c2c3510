//! Productivity of a program in the time that it takes on its control: at every instant, over the cells of the faces, and as a whole.
//!
//! Of every place of the faces the verdict knows the motion that finished it, and of every motion the time is known as the control
//! runs it, so that nothing here is what a planner hoped for. With declared raw material the volume is told too [R97, definition 4].

use crate::job::Job;
use crate::job::stock::Blank;
use crate::part::{Part, area};
use crate::report::Scalar;
use crate::work::held::{Held, SLOWER};
use crate::work::program::Planned;
use crate::work::rough;
use crate::work::verify::Verified;
use osculate_geom::Surface;
use osculate_postproc::motion::JointDemand;
use osculate_productivity::real_time::{
    Cells, Fineness, FinishedPlace, Finishing, Region, Spread, Stretch, TimedMotion, stretches,
};
use osculate_productivity::rough::layer_depth_mm;
use osculate_tools::removal::{Body, Cut, Limits, Sample, Swept};
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::Range;

/// The name of the map of the area that is finished a minute.
pub const PRODUCTIVITY: &str = "Productivity";
/// Cells of the maps over all faces together, about: a summary stays a file that one can look at.
const CELLS: f64 = 1024.0;

/// How a productivity is spread over the time in which something is made.
#[derive(Debug, Serialize, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SpreadKeys {
    /// Least.
    pub min: f64,
    /// Half of the time it is lower.
    pub median: f64,
    /// Greatest.
    pub max: f64,
    /// What is made over the time of it.
    pub mean: f64,
}

impl From<Spread> for SpreadKeys {
    fn from(s: Spread) -> Self {
        let [min, median, max, mean] = [s.min, s.median, s.max, s.mean].map(six_digits);
        Self { min, median, max, mean }
    }
}

/// The map of one face; cells stand in rows of u, as `[i][j]` at `i * v.len() + j`.
#[derive(Debug, Serialize, Clone, PartialEq)]
#[non_exhaustive]
pub struct FaceMap {
    /// The face.
    pub face: String,
    /// Middles of the cells along u.
    pub u: Vec<f64>,
    /// Middles of the cells along v.
    pub v: Vec<f64>,
    /// Area finished in each.
    pub area_mm2: Vec<f64>,
    /// The time of that.
    pub time_s: Vec<f64>,
    /// Area over time; null where nothing was finished.
    pub mm2_min: Vec<Option<f64>>,
    /// What holds the feed over most of the area of each, as in [`RealProductivity::feed_held_by`]; empty where that is not known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub held_by: Vec<Option<String>>,
}

/// What is removed of declared raw material.
#[derive(Debug, Serialize, Clone, PartialEq)]
#[non_exhaustive]
pub struct RemovalKeys {
    /// At every instant in which something is removed.
    pub instantaneous_mm3_min: Option<SpreadKeys>,
    /// All of it.
    pub removed_mm3: f64,
    /// The time in which something is removed.
    pub removing_min: f64,
    /// Over the whole time of the program, or of the operation.
    pub global_mm3_min: f64,
    /// The volume of a declared layer over the faces, with the curvature of the faces [R97, eq. 18]; of the whole program alone, and
    /// absent where normals of the faces cross in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer_mm3: Option<f64>,
}

/// The `productivity` object of `summary.json`, and of each operation there, which has no maps.
#[derive(Debug, Serialize, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct RealProductivity {
    /// Of finishing, at every instant in which something is finished; absent for a roughing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instantaneous_mm2_min: Option<SpreadKeys>,
    /// The area that is finished, each place once: all but the uncut area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finished_mm2: Option<f64>,
    /// The time in which something is finished; the rest is ways, run-outs and air.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finishing_min: Option<f64>,
    /// The share of that time in which the tip is slower than 95 % of the feed of the job; of a list each operation has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slower_share: Option<f64>,
    /// What holds the feed, with its share of that time: the cap on the job's feed (`feed`, `feed_per_tooth` or `tooth_mark`), `joint X`
    /// at its greatest speed, or else `acceleration`; of a program of one tool whose machine is known.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub feed_held_by: BTreeMap<String, f64>,
    /// Strip width times way over the finished area: 1 and what strips share with each other or lay beside the faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strips_over_area: Option<f64>,
    /// The finished area over the whole time of the program, or of the operation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub global_mm2_min: Option<f64>,
    /// By cells of each face.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub regional: Vec<FaceMap>,
    /// Speed of the edge where it touches the faces, m/min, each place counting by its area; absent without a spindle speed. A ball
    /// whose axis is the normal cuts with its tip, which stands still.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cutting_speed_m_min: Option<SpreadKeys>,
    /// With declared raw material.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub removal: Option<RemovalKeys>,
}

/// Six digits: the places are not worth more, and files stay short.
fn six_digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// A program whose motions have their times.
#[derive(Clone, Copy)]
pub struct Timed<'a> {
    /// Straight pieces.
    pub motions: &'a [Swept],
    /// Time at the end of each, min.
    pub times_min: &'a [f64],
    /// What its feed moves ask of the joints, of a program of one tool on a known machine.
    pub joints: Option<&'a JointDemand>,
}

/// Productivity over the whole of a program, from which that of its parts is told.
#[derive(Default)]
pub struct InTime {
    places: Vec<FinishedPlace>,
    /// The angle between axis and normal as each place was finished, rad; not a number where nothing finished it.
    leans_rad: Vec<f32>,
    finishing: Option<Finishing>,
    removing: Option<Vec<Stretch>>,
    held: Option<Held>,
}

impl InTime {
    /// What a verdict measured, in the time of the program that it is on. Where a time is not known there is nothing to tell.
    pub fn of(job: &Job, program: Timed<'_>, verified: &Verified) -> Self {
        let Timed { motions, times_min, joints } = program;
        let begins = std::iter::once(&0.0).chain(times_min);
        let timed: Vec<TimedMotion> = motions
            .iter()
            .zip(times_min.iter().zip(begins))
            .map(|(m, (end, begin))| TimedMotion {
                time_min: (end - begin).max(0.0),
                length_mm: (m.to.tip - m.from.tip).norm(),
                feed: !m.rapid,
            })
            .collect();
        let verdict = &verified.verdict;
        let tolerance = job.tolerance();
        let uncut_mm = Limits::new(tolerance.scallop_mm, tolerance.gouge_mm).uncut_mm;
        let finishes = |s: &Sample, c: &Cut| !s.check_only && c.standoff_mm <= uncut_mm;
        let place = |(s, c): (&Sample, &Cut)| FinishedPlace {
            face: s.face,
            at: s.uv,
            area_mm2: if s.check_only { 0.0 } else { s.area_mm2 },
            by: c.by.filter(|b| !b.rapid && b.body == Body::Cutter && finishes(s, c)).map(|b| b.motion),
        };
        let places: Vec<FinishedPlace> = verdict.samples().iter().zip(verdict.cuts()).map(place).collect();
        let fineness = Fineness::of_places(verified.summary.spacing_mm);
        let lean = |(p, s): (&FinishedPlace, &Sample)| {
            p.by.and_then(|m| motions.get(m as usize)).map_or(f32::NAN, |m| m.to.axis.angle(&s.normal) as f32)
        };
        let leans_rad = places.iter().zip(verdict.samples()).map(lean).collect();
        let finishing = Finishing::of(&places, &timed, fineness).ok();
        let removing = verdict.figures().stock.as_ref().and_then(|found| {
            let mut volumes = vec![0.0; timed.len()];
            for w in &found.carved.work {
                *volumes.get_mut(w.motion as usize)? += w.volume_mm3;
            }
            // As fine as the cells of the stock, of which as many make a stretch as of places.
            let fine = Fineness::of_places(found.cell_mm);
            stretches(&timed, &volumes, Fineness { amount: fine.amount * found.cell_mm, ..fine }).ok()
        });
        let held = finishing
            .as_ref()
            .zip(joints)
            .map(|(finishing, demand)| Held::of(job, motions, &finishing.stretches, demand));
        Self { places, leans_rad, finishing, removing, held }
    }

    /// Of some of its motions, which take so long: without maps.
    pub fn told(&self, job: &Job, (motions, time_min): (Range<usize>, f64)) -> RealProductivity {
        let within = |s: &&Stretch| motions.contains(&s.motions.start);
        let mut out = RealProductivity::default();
        if let Some(finishing) = self.finishing.as_ref().filter(|_| !rough::is(job)) {
            let own: Vec<&Stretch> = finishing.stretches.iter().filter(within).collect();
            let sum = |of: &dyn Fn(&Stretch) -> f64| own.iter().fold(0.0, |sum, s| sum + of(s));
            let (area, time) = (sum(&|s| s.amount), sum(&|s| s.time_min));
            let slow_mm_min = SLOWER * job.feed_mm_min();
            let slow = sum(&|s| if s.speed_mm_min() < slow_mm_min { s.time_min } else { 0.0 });
            out.instantaneous_mm2_min = Spread::of(own.iter().copied()).map(Into::into);
            out.finished_mm2 = Some(area);
            out.finishing_min = Some(time);
            out.slower_share = (time > 0.0).then(|| six_digits(slow / time));
            out.global_mm2_min = (time_min > 0.0).then(|| area / time_min);
            out.cutting_speed_m_min = edge(job).and_then(|speed| {
                let own = |p: &FinishedPlace| p.by.is_some_and(|m| motions.contains(&(m as usize)));
                let all = self.places.iter().zip(&self.leans_rad).filter(|(p, _)| own(p));
                let speeds = all.map(|(p, lean)| (speed(f64::from(*lean)), p.area_mm2));
                Spread::weighted(speeds.filter(|(v, _)| v.is_finite())).map(Into::into)
            });
        }
        out.removal = self.removing.as_ref().map(|all| {
            let own: Vec<&Stretch> = all.iter().filter(within).collect();
            let removed_mm3 = own.iter().fold(0.0, |sum, s| sum + s.amount);
            RemovalKeys {
                instantaneous_mm3_min: Spread::of(own.iter().copied()).map(Into::into),
                removed_mm3,
                removing_min: own.iter().fold(0.0, |sum, s| sum + s.time_min),
                global_mm3_min: if time_min > 0.0 { removed_mm3 / time_min } else { 0.0 },
                layer_mm3: None,
            }
        });
        out
    }

    /// Of the whole program, with the maps of its faces.
    pub fn whole(&self, job: &Job, faces: &Part, time_min: f64) -> RealProductivity {
        let mut out = self.told(job, (0..usize::MAX, time_min));
        if let Some(removal) = &mut out.removal {
            removal.layer_mm3 = self.layer_mm3(job, faces);
        }
        let Some(finishing) = self.finishing.as_ref().filter(|_| out.finished_mm2.is_some()) else {
            return out;
        };
        if let Some(held) = &self.held {
            out.feed_held_by = held.shares(&finishing.stretches);
            out.feed_held_by.values_mut().for_each(|share| *share = six_digits(*share));
        }
        let areas: Vec<f64> = faces.faces.iter().map(area).collect();
        let all: f64 = areas.iter().sum();
        let own = faces.faces.iter().zip(&areas).zip(0u32..).map(|((face, area), number)| {
            let most = (CELLS * area / all).round().max(1.0) as usize;
            let cells = Cells::over(&face.surface, number, most);
            let found = Region::of(&self.places, finishing, cells);
            let held = self.held.as_ref().map(|held| held.by_cell(&self.places, finishing, &cells));
            let short = |all: &[f64]| all.iter().map(|x| six_digits(*x)).collect();
            FaceMap {
                face: face.id.clone(),
                u: short(&found.u),
                v: short(&found.v),
                area_mm2: short(&found.area_mm2),
                time_s: found.time_min.iter().map(|t| six_digits(60.0 * t)).collect(),
                mm2_min: found.mm2_min().into_iter().map(|e| e.is_finite().then(|| six_digits(e))).collect(),
                held_by: held.unwrap_or_default(),
            }
        });
        out.regional = own.collect();
        out
    }

    /// The volume of a declared layer, by its depth at every place.
    fn layer_mm3(&self, job: &Job, faces: &Part) -> Option<f64> {
        let Blank::Layer(thickness_mm) = job.stock()?.blank else { return None };
        let mut sum = 0.0;
        for p in self.places.iter().filter(|p| p.area_mm2 > 0.0) {
            let jet = faces.faces.get(p.face as usize)?.surface.jet2(p.at);
            sum += p.area_mm2 * layer_depth_mm(&jet, thickness_mm).ok()?;
        }
        Some(sum)
    }

    /// What the report paints, of every sample of the verdict; NaN where nothing was finished. None for a roughing. Of several tools
    /// each may have a feed of its own: then the map of the speed is left out.
    pub fn maps(&self, job: &Job, one_tool: bool) -> Vec<(Scalar, Vec<f32>)> {
        let Some(finishing) = self.finishing.as_ref().filter(|_| !rough::is(job)) else { return Vec::new() };
        let map = |name: &str, unit: &str, value: &dyn Fn(&Stretch) -> f64| {
            let one = |k: usize| finishing.stretch(k).map_or(f32::NAN, |s| value(s) as f32);
            let scalar = Scalar { name: name.to_owned(), unit: unit.to_owned() };
            (scalar, (0..self.places.len()).map(one).collect())
        };
        let mut out = vec![map(PRODUCTIVITY, "mm2/min", &Stretch::per_min)];
        if one_tool {
            let asked_mm_min = job.feed_mm_min();
            out.push(map("Speed of feed asked", "%", &|s| 100.0 * s.speed_mm_min() / asked_mm_min));
            if let Some(speed) = edge(job) {
                let scalar = Scalar { name: "Cutting speed".to_owned(), unit: "m/min".to_owned() };
                let one = |lean: &f32| speed(f64::from(*lean)) as f32;
                out.push((scalar, self.leans_rad.iter().map(one).collect()));
            }
        }
        out
    }
}

/// The speed of the edge, m/min, by the angle between axis and normal, rad; None without a spindle speed.
fn edge(job: &Job) -> Option<impl Fn(f64) -> f64> {
    let (rpm, cutter) = (job.spindle_rpm()?, job.cutter());
    Some(move |lean_rad: f64| {
        let arc = cutter.touching(lean_rad);
        TAU * (arc.centre_rho_mm + arc.radius_mm * lean_rad.sin()) * rpm / 1000.0
    })
}

/// Strip width times way over the finished area, of passes that know their strips.
pub fn strips_over_area(planned: &Planned<'_>, finished_mm2: Option<f64>) -> Option<f64> {
    let finished = finished_mm2.filter(|area| planned.with_strips && *area > 0.0)?;
    let strips = planned.passes.passes.iter().flat_map(|p| p.points.windows(2)).map(|w| {
        let width = 0.5 * (w[0].width_mm + w[1].width_mm);
        if width.is_finite() { width * (w[1].point - w[0].point).norm() } else { 0.0 }
    });
    let strips: f64 = strips.sum();
    (strips > 0.0).then(|| six_digits(strips / finished))
}

impl RealProductivity {
    /// Rows for people: what, value, unit.
    pub fn rows(&self) -> Vec<(&'static str, String, &'static str)> {
        let spread = |s: &SpreadKeys| format!("{:.1} to {:.1}, median {:.1}", s.min, s.max, s.median);
        let mut out = Vec::new();
        if let Some(s) = &self.instantaneous_mm2_min {
            out.push(("productivity at an instant", spread(s), "mm2/min"));
        }
        if let Some(share) = self.slower_share {
            out.push(("slower than the feed asked for", format!("{:.0}", 100.0 * share), "% of it"));
        }
        if !self.feed_held_by.is_empty() {
            let mut by: Vec<_> = self.feed_held_by.iter().collect();
            by.sort_by(|a, b| b.1.total_cmp(a.1));
            let each = by
                .into_iter()
                .map(|(name, share)| format!("{} {:.0}", name.replace('_', " "), 100.0 * share));
            out.push(("feed held by", each.collect::<Vec<_>>().join(", "), "% of it"));
        }
        if let Some(s) = &self.cutting_speed_m_min {
            out.push(("cutting speed at the contact", spread(s), "m/min"));
        }
        // Of a roughing alone: of all others the area says more.
        if let Some(r) = self.removal.as_ref().filter(|_| self.finished_mm2.is_none()) {
            if let Some(s) = &r.instantaneous_mm3_min {
                out.push(("removal at an instant", spread(s), "mm3/min"));
            }
            out.push(("global removal", format!("{:.1}", r.global_mm3_min), "mm3/min"));
        }
        out
    }
}
