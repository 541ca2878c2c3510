//! Columns across isoparametric passes: where spacing is computed, what of the face they answer for, and how far it is
//! covered.

use super::cover::union;
use super::resample::resample;
use super::seat::Seat;
use super::{PlanError, Task};
use osculate_geom::line::IsoLine;
use osculate_geom::roots::minimum;
use osculate_geom::{Axis, Interval, Surface, Uv};
use rayon::prelude::*;

/// Fewest and most columns at which spacing is computed.
const COLUMNS: [usize; 2] = [96, 320];
/// Least length of the stretch that a turn of the boundary counts as, as a share of the covered range.
const TIP: f64 = 1e-6;
/// Columns at which more than this part of the scallop is left ask for more at so many places towards each neighbour: what keeps the
/// tool off is often narrower than columns are apart.
const MUCH: f64 = 0.1;
const ASKED: u32 = 5;
/// The top between them is found to this part of their distance.
const TOP: f64 = 0.02;
/// Lines looked at between a column and each of its neighbours.
const BETWEEN: i32 = 8;

/// One column: a parameter along the passes, the inside stretches across it, and the frontier.
pub(super) struct Column {
    pub t: f64,
    pub inside: Vec<[f64; 2]>,
    /// None once the column is covered.
    pub frontier: Option<f64>,
    /// What the pass before leaves on its own line here, because the face is rough.
    pub left: f64,
}

impl Column {
    /// Whether a rough face keeps the tool off by more than next to nothing.
    pub fn is_held_off(&self, task: &Task<'_>) -> bool {
        self.left > MUCH * task.tolerance.scallop_mm
    }

    /// Moves the frontier to `f`, or to the next inside stretch, or to none.
    pub fn advance(&mut self, f: f64, slack: f64) {
        self.frontier = self.inside.iter().find(|s| s[1] > f + slack).map(|s| s[0].max(f));
    }
}

/// Stretches of inside across the passes that column `k` answers for: its own and those up to its neighbours, so that
/// no corner of a trim falls between columns.
pub(super) fn stretches(
    surface: &dyn Surface,
    along: Axis,
    [lo, hi]: [f64; 2],
    parameters: &[f64],
    k: usize,
) -> Vec<[f64; 2]> {
    let t = parameters[k];
    let domain = surface.domain().get(along);
    let before = k.checked_sub(1).map_or(domain.lo, |j| parameters[j]);
    let after = parameters.get(k + 1).copied().unwrap_or(domain.hi);
    let mut all = Vec::new();
    for i in -BETWEEN..=BETWEEN {
        let f = f64::from(i.abs()) / f64::from(BETWEEN);
        let to = if i < 0 { before } else { after };
        all.extend(surface.spans(along.other(), t + (to - t) * f).iter().map(|s| [s.lo, s.hi]));
    }
    let tip = TIP * (hi - lo);
    for at in surface.turns() {
        let (t, x) =
            (domain.bring(at.get(along)), surface.domain().get(along.other()).bring(at.get(along.other())));
        if t >= before && t <= after {
            all.push([x - tip, x + tip]);
        }
    }
    let within = all.into_iter().map(|s| [s[0].max(lo), s[1].min(hi)]).filter(|s| s[0] < s[1]);
    union(within.collect(), 0.0)
}

/// Parameters of the columns: where a path along three lines of the face would put its points, thinned.
pub(super) fn column_parameters(
    seat: &Seat<'_>,
    along: Axis,
    across: Interval,
) -> Result<Vec<f64>, PlanError> {
    let task = seat.task();
    let surface = task.surface;
    let i = seat.holds().get(along);
    let breaks = surface.breaks(along);
    let mut all: Vec<f64> = (0..=COLUMNS[0]).map(|k| i.at(k as f64 / COLUMNS[0] as f64)).collect();
    let mut held_off = Vec::new();
    for f in [0.02, 0.5, 0.98] {
        let line = IsoLine { surface, along, fixed: across.at(f), reversed: false };
        for s in surface.spans(along, across.at(f)) {
            if s.length() > 1e-9 * i.length()
                && let Ok(knots) = resample(seat, task, &line, [s.lo, s.hi], &breaks)
            {
                all.extend(knots.iter().map(|k| k.t));
                held_off.extend(kept_off(seat, &line, knots.iter().map(|k| k.t).collect()));
            }
        }
    }
    if all.len() > COLUMNS[1] {
        all.sort_by(f64::total_cmp);
        let n = all.len();
        all = (0..COLUMNS[1]).map(|k| all[k * (n - 1) / (COLUMNS[1] - 1)]).collect();
    }
    // So is a place where the tool is held off most.
    held_off.sort_by(|a: &(f64, f64), b| b.0.total_cmp(&a.0));
    all.extend(held_off.iter().take(COLUMNS[0]).map(|h| h.1));
    // A tip of the boundary is reached by a column of its own, if there are not too many to be tips.
    let turns: Vec<f64> = surface.turns().iter().map(|at| i.bring(at.get(along))).collect();
    if turns.len() <= COLUMNS[0] {
        all.extend(turns);
    }
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < 1e-6 * i.length());
    if i.periodic {
        // The last column would be the first again.
        all.pop();
    }
    if all.is_empty() {
        return Err(PlanError::Nothing {
            face: task.face.to_owned(),
            why: "its parameter range is empty".to_owned(),
        });
    }
    Ok(all)
}

/// Where a rough face holds the tool off a line more than on both sides, much more than nothing: by how much, mm, and the parameter.
fn kept_off(seat: &Seat<'_>, line: &IsoLine<'_>, knots: Vec<f64>) -> Vec<(f64, f64)> {
    if !seat.rough() {
        return Vec::new();
    }
    let least_mm = MUCH * seat.task().tolerance.scallop_mm;
    let left: Vec<f64> = knots.par_iter().map(|t| seat.left_over(line, *t).unwrap_or(0.0)).collect();
    let of = |k: usize| left.get(k).copied().unwrap_or(0.0);
    let tops = (0..knots.len()).filter(|k| {
        let before = k.checked_sub(1).map_or(0.0, of);
        left[*k] > least_mm && left[*k] >= before && left[*k] > of(k + 1)
    });
    tops.map(|k| (left[k], knots[k])).collect()
}

/// A first guess of the parameter step between passes.
pub(super) fn first_step(task: &Task<'_>, along: Axis, across: Interval) -> f64 {
    let i = task.surface.domain().get(along);
    let at = Uv::from_axis(along, i.at(0.5), across.at(0.5));
    let jet = task.surface.jet2(at);
    let speed = if along == Axis::U { jet.dv.norm() } else { jet.du.norm() };
    let half = (2.0 * task.tolerance.scallop_mm * task.cutter.radius_mm()).sqrt();
    (half / speed.max(1e-12)).clamp(1e-6 * across.length(), 0.2 * across.length())
}

/// What a rough face keeps at each column of a pass, and next to it.
pub(super) fn rough_columns(
    seat: &Seat<'_>,
    along: Axis,
    fixed: f64,
    reversed: bool,
    columns: &mut [Column],
) {
    let line = IsoLine { surface: seat.task().surface, along, fixed, reversed };
    // Where the pass has no frame the level itself will say so.
    let left = |t: f64| seat.left_over(&line, t).unwrap_or(0.0);
    let parameters: Vec<f64> = columns.iter().map(|c| c.t).collect();
    columns.par_iter_mut().enumerate().for_each(|(k, c)| {
        c.left = left(c.t);
        if c.is_held_off(seat.task()) {
            let beside =
                [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|j| parameters.get(j));
            // From the column halfway to each neighbour, and what is left at the top between the places asked.
            let (t, mut top_mm) = (c.t, c.left);
            for to in beside {
                let by = (to - t) * 0.5 / f64::from(ASKED);
                let asked = (1..=ASKED).map(|n| t + by * f64::from(n)).map(|t| (left(t), t));
                let most = asked.fold((c.left, t), |a, b| if b.0 > a.0 { b } else { a });
                let around = [most.1 - by.abs(), most.1 + by.abs()];
                top_mm = top_mm.max(-minimum(around, TOP, |t| -left(t)).f);
            }
            c.left = top_mm;
        }
    });
}
