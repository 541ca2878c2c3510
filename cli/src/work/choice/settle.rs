//! Contenders verified from their programs until enough of them hold.

use super::measured::Measured;
use super::search::{Choice, Contender};
use super::table::text_table;
use crate::failure::Failure;
use crate::job::Job;
use crate::part;
use crate::watch::Watch;
use crate::work::look::{Excess, Objection};
use crate::work::program::{Planned, Posted, WallS};
use crate::work::verify::{Verification, Verified};
use osculate_productivity::levels::{Totals, levels};
use osculate_tools::removal::{Answer, Limits};

/// The plan that is chosen.
pub struct Settled {
    /// The job with its tool.
    pub job: Job,
    /// The plan.
    pub planned: Planned<'static>,
    /// Its program.
    pub posted: Posted,
    /// What the program leaves, where what its passes leave to other operations is accepted.
    pub verified: Verified,
}

/// Verifies contenders until `enough` hold, and then those around the first that may take less time; the fastest that holds is
/// chosen, or where none does the one that is least off.
///
/// # Errors
/// Where no candidate comes as far as verification, with every reason in one table.
pub fn settle(
    choice: &mut Choice<'_>,
    enough: usize,
    watch: &dyn Watch,
    wall_s: &mut WallS,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Settled, Failure> {
    let mut best: Option<((f64, f64), Settled)> = None;
    let (mut holding, mut verified, mut not_shown) = (0, 0, 0);
    let most = choice.most;
    while verified < most.verified && not_shown < most.not_shown {
        let Some(contender) = choice.next(watch, wall_s, progress)? else { break };
        verified += 1;
        let judged = choice.judged(&contender);
        let found = match contender.posted.verify(&judged, choice.faces, wall_s, watch) {
            Ok(found) => found,
            Err(why) => {
                choice.lost(&contender, &why);
                continue;
            }
        };
        let why = objection(&judged, choice.blend_mm(&contender), &found);
        holding += usize::from(why.is_none());
        let measured = measured(choice, &contender, &found.summary)?;
        let again = choice.record(&contender, measured, why);
        let time_min = choice.counted_min(&contender, found.summary.high_area_mm2);
        not_shown += usize::from(found.verdict.answer() == Answer::NotShown && !again);
        if holding >= enough && found.summary.within_tolerance {
            choice.undercut(&contender, &found.summary, time_min);
        }
        let rank = (off_by(&judged, &found)?, time_min);
        if best.as_ref().is_none_or(|b| rank < b.0) {
            let Contender { job, planned, posted, .. } = contender;
            best = Some((rank, Settled { job, planned, posted, verified: found }));
        }
    }
    best.map(|b| b.1).ok_or_else(|| {
        let job = &choice.jobs[0];
        let table = text_table(&choice.rows());
        Failure::file(job.path(), format!("no tool and strategy holds the tolerance:\n\n{table}"))
    })
}

/// How far off a plan counts that holds at its samples: less than any that does not.
const NEARLY: f64 = 0.5;

/// By how much of its limits a verification is off; nothing where it holds, so that the first that holds stays the best.
fn off_by(job: &Job, found: &Verified) -> Result<f64, Failure> {
    let v = &found.summary;
    match found.verdict.answer() {
        Answer::Held => return Ok(0.0),
        Answer::NotShown => return Ok(NEARLY),
        Answer::NotHeld => {}
    }
    let t = job.tolerance();
    Ok((v.height_max_mm / t.scallop_mm).max(v.gouge_max_mm / t.gouge_mm).max(1.0))
}

/// Why a program does not hold whose corners may be blended by so much; None where it does.
pub fn objection(job: &Job, blend_mm: f64, found: &Verified) -> Option<Objection> {
    let v = &found.summary;
    let t = job.tolerance();
    // What may be hidden between samples counts where nothing is too much without it: it is not looked for elsewhere.
    let excess = |is_mm: f64, may_mm: f64, hidden_mm: Option<f64>| {
        let hidden_mm = if is_mm > may_mm { 0.0 } else { hidden_mm? };
        Some(Excess { is_mm: is_mm + hidden_mm, may_mm })
    };
    let marks_mm = v.height_max_mm - v.scallop_max_mm;
    let dug = excess(v.gouge_max_mm, t.gouge_mm - blend_mm, v.hidden_gouge_mm);
    let left = excess(v.scallop_max_mm, t.scallop_mm - marks_mm - blend_mm, v.hidden_scallop_mm);
    match found.verdict.answer() {
        Answer::Held => return None,
        Answer::NotShown => {
            let text = format!("verified: {}", found.verdict.words());
            return Some(Objection { dug, left, hidden: true, text });
        }
        Answer::NotHeld => {}
    }
    let collision = Limits::new(t.scallop_mm, t.gouge_mm).collision_mm;
    let figures = [
        ("gouge", v.gouge_max_mm, t.gouge_mm, "mm"),
        ("holder takes", v.holder_max_mm, collision, "mm"),
        ("rapid move takes", v.rapid_max_mm, collision, "mm"),
        ("uncut area", v.uncut_area_mm2, job.unreached_mm2(), "mm2"),
        ("scallop with tooth mark", v.height_max_mm, t.scallop_mm, "mm"),
    ];
    let bad = figures.into_iter().enumerate().find(|(_, (_, is, limit, _))| is > limit);
    let (k, text) = bad.map_or_else(
        || (0, format!("verified: {}", found.verdict.words())),
        |(k, (what, is, limit, unit))| {
            (k, format!("verified: {what} {is:.4} {unit}, {limit} {unit} is accepted"))
        },
    );
    let (dug, left) = (dug.filter(|_| k == 0), left.filter(|_| k == 4));
    Some(Objection { dug, left, hidden: false, text })
}

fn measured(choice: &Choice<'_>, contender: &Contender, v: &Verification) -> Result<Measured, Failure> {
    let area_mm2 = choice.faces.faces.iter().map(part::area).sum();
    let totals = Totals { area_mm2, time_min: contender.posted.time_min() };
    let passes = &contender.planned.passes;
    let l = levels(&passes.passes, contender.job.feed_mm_min(), totals);
    let lengths: Vec<f64> = passes.passes.iter().map(|p| p.length_mm()).collect();
    let whole: f64 = lengths.iter().sum();
    let regional = l.regional.iter().zip(&lengths).map(|(r, l)| r * l).sum::<f64>();
    Ok(Measured {
        scallop_max_mm: v.scallop_max_mm,
        scallop_median_mm: v.scallop_median_mm,
        gouge_max_mm: v.gouge_max_mm,
        uncut_area_mm2: v.uncut_area_mm2,
        within_tolerance: v.within_tolerance,
        instantaneous_mm2_min: [l.instantaneous_min, l.instantaneous_max],
        regional_mm2_min: if whole > 0.0 { regional / whole } else { 0.0 },
        global_mm2_min: l.global,
    })
}
