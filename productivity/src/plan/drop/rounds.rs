//! Rounds of passes: lay them out, measure with the swept cutter what they leave, and ask again, closer, where it is too much.

use super::ground::{DESIGN, Ground, design_mm, nothing};
use super::wants::Want;
use crate::plan::{Pass, PlanError};
use osculate_tools::removal::{self, Job, Sample, Swept};
use rayon::prelude::*;

/// Rounds of measuring and asking again.
const ROUNDS: usize = 5;
/// A pass within this part of a place's reach runs right over it.
const RIGHT_OVER: f64 = 0.05;
/// Material over the places, of the scallop: its lowest layer, which is cut first and by fewer motions, is then as high as that.
const STOCK: f64 = 16.0;
/// What stands higher than this, of the scallop, is no measure of how much closer passes must be.
const FURTHEST: f64 = 4.0;

/// For each place how far it is off the nearest of some passes, as a share of its reach.
pub(super) type Shares<'a> = Box<dyn Fn(&[Want]) -> Vec<f64> + 'a>;

/// The passes of a round.
pub(super) struct Round<'a> {
    pub passes: Vec<Pass>,
    /// How far places are off them.
    pub shares: Shares<'a>,
}

/// Places at which what is left is measured, and what each of them wants.
struct Judged {
    samples: Vec<Sample>,
    wants: Vec<Want>,
}

impl Judged {
    /// Those that the tool can cut from above.
    fn of(ground: &Ground<'_>) -> Self {
        let height = design_mm(&ground.task.tolerance);
        let asked = |s: &Sample| Some((*s, ground.want(s, [height, 0.0]).ok()?));
        let (samples, wants) = ground.judged.par_iter().filter_map(asked).unzip();
        Self { samples, wants }
    }

    /// Which of them may keep too much, and their shares.
    fn doubtful(&self, ground: &Ground<'_>, round: &Round<'_>) -> Vec<(usize, f64)> {
        let shares = (round.shares)(&self.wants);
        let doubtful = |(_, share): &(usize, f64)| *share <= RIGHT_OVER || *share >= ground.lines.near();
        shares.into_iter().enumerate().filter(doubtful).collect()
    }
}

/// The passes of the last round of `lay`; wants that it did not meet are told with their area in `lost`.
///
/// # Errors
/// Those of `lay`, and [`PlanError::Nothing`] where there are no passes.
pub(super) fn in_rounds<'a>(
    ground: &Ground<'_>,
    wants: &mut Vec<Want>,
    lost: &mut Vec<(f64, &'static str)>,
    lay: impl Fn(&mut Vec<Want>) -> Result<Round<'a>, PlanError>,
) -> Result<Vec<Pass>, PlanError> {
    let task = ground.task;
    let judged = Judged::of(ground);
    let (mut passes, mut left) = (Vec::new(), 0.0);
    for round in 0..ROUNDS {
        let laid = lay(wants)?;
        (task.progress)(0.4 + 0.6 * (round + 1) as f64 / ROUNDS as f64);
        let unmet = measure(ground, wants, &judged, &laid)?;
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

/// Measures what the passes leave; a place that keeps too much becomes a want of its own with a shorter reach.
fn measure(
    ground: &Ground<'_>,
    wants: &mut Vec<Want>,
    judged: &Judged,
    round: &Round<'_>,
) -> Result<Unmet, PlanError> {
    let task = ground.task;
    let doubtful = judged.doubtful(ground, round);
    let samples: Vec<Sample> = doubtful.iter().map(|(k, _)| judged.samples[*k]).collect();
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
        changes: &[],
        motions: &motions,
        samples: &samples,
        stock_mm: STOCK * limit,
        depth_mm: limit,
    };
    let cuts = removal::cut(&job, &|_| ()).map_err(|e| nothing(task, &e.to_string()))?;
    let (mut unmet, mut more) = (Unmet { mended: 0, area_mm2: 0.0 }, Vec::new());
    for ((k, share), c) in doubtful.iter().zip(&cuts) {
        if c.standoff_mm <= ground.lines.met() * limit {
            continue;
        }
        let mut w = judged.wants[*k];
        // What another place keeps the tool from was told of before.
        if ground.drops.is_above(w.at, w.tip + limit) {
            continue;
        }
        // A pass right over the place left it: another one will not help.
        if *share <= RIGHT_OVER {
            unmet.area_mm2 += w.area;
            continue;
        }
        let standoff_mm = c.standoff_mm.min(FURTHEST * limit);
        w.reach *= share.min(1.0) * (DESIGN * limit / standoff_mm).sqrt().min(0.95);
        unmet.mended += 1;
        more.push(w);
    }
    wants.extend(more);
    Ok(unmet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::drop::ground::{Lines, asked, ground};
    use crate::plan::drop::planes::{levels, shares};
    use crate::plan::drop::task::DropTask;
    use crate::plan::{Named, Tolerance};
    use osculate_geom::analytic::Plane;
    use osculate_geom::{Domain, Interval, Surface, Vec3};
    use osculate_tools::{Cutter, CutterSpec};

    /// On a plane places are spread evenly over the distance from the passes: of a reach the shares up to `RIGHT_OVER` and from
    /// `Lines::near` on are measured, and at the borders some more.
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
        let furthest = shares(&levels, &wants).into_iter().fold(0.0, f64::max);
        let round = Round { passes: Vec::new(), shares: Box::new(|wants| shares(&levels, wants)) };
        let judged = Judged::of(&ground);
        let some = judged.doubtful(&ground, &round);
        let part = some.len() as f64 / ground.judged.len() as f64;
        assert!(part > 0.25 && part < 0.5, "{part}");
        let worst = some.iter().map(|(_, share)| *share).fold(0.0, f64::max);
        assert!(worst > 0.95 * furthest, "{worst} {furthest}");
    }
}
