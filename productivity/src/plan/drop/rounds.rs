//! Rounds of passes: lay them out, measure with the swept cutter what they leave, and ask again, closer, where it is too much.

use super::wants::Want;
use super::{DESIGN, Ground, Lines, Pass, PlanError, design_mm, nothing};
use osculate_tools::removal::{self, Job, Sample, Swept};
use rayon::prelude::*;

/// Rounds of measuring and asking again.
const ROUNDS: usize = 5;
/// A pass within this part of a place's reach runs right over it.
const RIGHT_OVER: f64 = 0.05;
/// A place within this part of its reach, and not right under a pass, is not measured between planes: what it keeps grows with
/// the square of the distance, so that a place further out would tell first if leading order were wrong by as much.
const NEAR: f64 = 0.6;

/// The passes of a round.
pub(super) struct Round {
    pub passes: Vec<Pass>,
    /// How far a place is off the nearest of them, mm.
    pub off: Box<dyn Fn(&Want) -> f64 + Sync>,
}

/// The passes of the last round of `lay`; wants that it did not meet are told with their area in `lost`.
///
/// # Errors
/// Those of `lay`, and [`PlanError::Nothing`] where there are no passes.
pub(super) fn in_rounds(
    ground: &Ground<'_>,
    wants: &mut Vec<Want>,
    lost: &mut Vec<(f64, &'static str)>,
    lay: impl Fn(&mut Vec<Want>) -> Result<Round, PlanError>,
) -> Result<Vec<Pass>, PlanError> {
    let task = ground.task;
    let (mut passes, mut left) = (Vec::new(), 0.0);
    for round in 0..ROUNDS {
        let laid = lay(wants)?;
        (task.progress)(0.4 + 0.6 * (round + 1) as f64 / ROUNDS as f64);
        let unmet = measure(ground, wants, &laid)?;
        (passes, left) = (laid.passes, unmet.area_mm2);
        if unmet.mended == 0 {
            break;
        }
    }
    lost.push((left, "keeps more than scallop_mm even under a pass"));
    (task.progress)(1.0);
    if passes.is_empty() {
        return Err(nothing(task, "the tool meets none of it from above; give another axis"));
    }
    Ok(passes)
}

/// What measuring found.
struct Unmet {
    /// Places that are asked again, closer.
    mended: usize,
    /// Area that no pass can help, mm2.
    area_mm2: f64,
}

/// Places that may keep too much.
fn judged(ground: &Ground<'_>, round: &Round) -> Vec<Sample> {
    let height = design_mm(&ground.task.tolerance);
    let asked = |s: &&Sample| {
        let Ok(w) = ground.want(s, [height, 0.0]) else { return true };
        let share = (round.off)(&w) / w.reach;
        share <= RIGHT_OVER || share >= NEAR
    };
    ground.judged.par_iter().filter(asked).copied().collect()
}

/// Measures what the passes leave; a place that keeps too much becomes a want of its own with a shorter reach.
fn measure(ground: &Ground<'_>, wants: &mut Vec<Want>, round: &Round) -> Result<Unmet, PlanError> {
    let task = ground.task;
    let some;
    let samples = match ground.lines {
        Lines::Planes => {
            some = judged(ground, round);
            &some
        }
        // The distance from many bent courses costs more than the measurement.
        Lines::Gradient => &ground.judged,
    };
    let motions: Vec<Swept> = round
        .passes
        .iter()
        .flat_map(|p| p.points.windows(2))
        .map(|w| Swept { from: w[0].pose, to: w[1].pose, rapid: false, block: 0 })
        .collect();
    let limit = task.tolerance.scallop_mm;
    let job = Job {
        cutter: task.cutter,
        holder: None,
        motions: &motions,
        samples,
        stock_mm: 4.0 * limit,
        depth_mm: limit,
    };
    let cuts = removal::cut(&job, &|_| ()).map_err(|e| nothing(task, &e.to_string()))?;
    let (mut unmet, mut more) = (Unmet { mended: 0, area_mm2: 0.0 }, Vec::new());
    for (s, c) in samples.iter().zip(&cuts) {
        if c.standoff_mm <= ground.lines.met() * limit {
            continue;
        }
        // What cannot be cut from above was told of before.
        let Ok(mut w) = ground.want(s, [design_mm(&task.tolerance), 0.0]) else { continue };
        if ground.drops.coarse(w.at) > w.tip + limit {
            continue;
        }
        let off = (round.off)(&w);
        // A pass right over the place left it: another one will not help.
        if off <= RIGHT_OVER * w.reach {
            unmet.area_mm2 += s.area_mm2;
            continue;
        }
        w.reach = off.min(w.reach) * (DESIGN * limit / c.standoff_mm).sqrt().min(0.95);
        unmet.mended += 1;
        more.push(w);
    }
    wants.extend(more);
    Ok(unmet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Tolerance;
    use crate::plan::drop::{DropTask, Named, asked, ground, levels, off};
    use osculate_geom::analytic::Plane;
    use osculate_geom::{Domain, Interval, Surface, Vec3};
    use osculate_tools::{Cutter, CutterSpec};

    /// On a plane places are spread evenly over the distance from the passes: of a reach the shares up to `RIGHT_OVER` and from
    /// `NEAR` on are measured, and at the borders some more.
    #[test]
    fn places_well_within_reach_are_not_measured() {
        let i = Interval::new(0.0, 12.0);
        let face = Plane::new(Domain { u: i, v: i });
        let cutter =
            Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 30.0 }).expect("a ball");
        let task = DropTask {
            faces: &[Named { face: "F1", surface: &face }],
            check: &[],
            cutter: &cutter,
            axis: Vec3::z_axis(),
            feed: Vec3::x(),
            tolerance: Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.002 },
            progress: &|_| (),
        };
        let surfaces: [&dyn Surface; 1] = [&face];
        let ground = ground(&task, &surfaces, Lines::Planes).expect("a plane");
        let (mut wants, _) = asked(&ground);
        let levels = levels(&mut wants);
        let all: Vec<f64> = wants.iter().map(|w| off(&levels, w) / w.reach).collect();
        let furthest = all.iter().copied().fold(0.0, f64::max);
        let round = Round { passes: Vec::new(), off: Box::new(move |w| off(&levels, w)) };
        let some = judged(&ground, &round);
        let share = some.len() as f64 / ground.judged.len() as f64;
        assert!(share > 0.3 && share < 0.6, "{share}");
        let shares = some.iter().map(|s| {
            let w = ground.want(s, [design_mm(&task.tolerance), 0.0]).expect("level ground");
            (round.off)(&w) / w.reach
        });
        assert!(shares.fold(0.0, f64::max) > 0.95 * furthest, "{furthest}");
    }
}
