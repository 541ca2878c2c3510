//! A face in regions across its passes, each with passes as far apart as it allows itself.
//!
//! Isoparametric passes lie as close everywhere as they must at the tightest place along them. Where strips are wide over a good
//! part of the way, cutting that part with fewer passes takes less time than running all of them through, though every pass of two
//! neighbouring regions goes over the border between them. How many passes each column across the passes needs by itself is
//! known from the same exact reaches that space them; borders are put where the length is least, by dynamic programming.

use super::columns::{Column, first_step, stretches};
use super::ends::Ends;
use super::extended::Extended;
use super::isoparametric::{Cover, built, close_chords, inside_across, lay_out};
use super::lead::{Clearance, LeadField, Leaning};
use super::seat::Seat;
use super::{Along, MAX_PASSES, Passes, PlanError, Task, shorter};
use osculate_geom::line::LineError;
use osculate_geom::{Axis, Diagnostic, Interval, Jet2, Surface, Uv, forward_surface};
use rayon::prelude::*;

/// Most regions: each costs a retract, and wide regions have most of the gain.
const MOST: usize = 4;
/// Intervals between the columns that are asked.
const COLUMNS: usize = 40;
/// By how much passes go over a border between regions, in radii of the tool.
const OVER: f64 = 0.5;
/// Shares of the progress.
const LEADS: f64 = 0.2;
const NEEDS: f64 = 0.3;

/// A face of which only what lies between two parameters along its passes is inside.
struct Region<'a> {
    base: &'a dyn Surface,
    along: Axis,
    range: Interval,
}

impl Surface for Region<'_> {
    forward_surface!(domain | s | s.base);
    forward_surface!(shape | s | s.base);
    forward_surface!(breaks | s | s.base);
    fn contains(&self, at: Uv) -> bool {
        self.range.contains(at.get(self.along)) && self.base.contains(at)
    }
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        if axis != self.along {
            return if self.range.contains(fixed) { self.base.spans(axis, fixed) } else { Vec::new() };
        }
        let cut = |s: Interval| Interval { lo: s.lo.max(self.range.lo), hi: s.hi.min(self.range.hi), ..s };
        self.base.spans(axis, fixed).into_iter().map(cut).filter(|s| s.lo < s.hi).collect()
    }
    fn turns(&self) -> Vec<Uv> {
        self.base.turns().into_iter().filter(|at| self.range.contains(at.get(self.along))).collect()
    }
}

/// A column across the passes with the number of passes that it needs by itself.
#[derive(Clone, Copy, Debug)]
struct Need {
    /// Parameter along the passes.
    t: f64,
    passes: u32,
    /// Length of face along the passes that it stands for, mm.
    length_mm: f64,
}

/// Plans isoparametric passes over a face in regions across them, each region with passes as far apart as it allows itself; where no
/// border between regions would make the path shorter there is one region, and passes are those of [`super::isoparametric()`], as they are round a face that closes.
///
/// # Errors
/// [`PlanError`], as for isoparametric passes.
pub fn regions(task: &Task<'_>, along: Along) -> Result<Passes, PlanError> {
    task.check()?;
    let task = &Task { tolerance: close_chords(task), ..*task };
    let one = |axis: Axis, progress: &(dyn Fn(f64) + Sync)| {
        let task = &Task { progress, ..*task };
        let Leaning::Local(local) = task.lean else { return in_regions(task, axis, None) };
        let seat = Seat::new(task, axis);
        let (rough, one_way) = (seat.rough(), seat.closes(axis));
        let feed = |_: Uv, jet: &Jet2| Some(if axis == Axis::U { jet.du } else { jet.dv });
        // The whole face says what lead keeps the tool off it, whatever region the tool is in.
        let field = LeadField::find(task, local, (&feed, one_way), rough)?;
        progress(LEADS);
        let clearance = Clearance::new(task, local, rough);
        let led = Task { lean: Leaning::Field(&field), ..*task };
        Ok(field.told(in_regions(&led, axis, Some(&clearance))?, task.face))
    };
    match along {
        Along::Fixed(axis) => one(axis, task.progress),
        Along::Auto => {
            let u = one(Axis::U, &|f| (task.progress)(0.5 * f));
            shorter(u, one(Axis::V, &|f| (task.progress)(0.5 + 0.5 * f)), Passes::length_mm)
        }
    }
}

/// The passes of a face whose lead is known; with what keeps the tool off the face beyond its border, where that is asked.
fn in_regions(task: &Task<'_>, along: Axis, clearance: Option<&Clearance<'_>>) -> Result<Passes, PlanError> {
    let ends = |beyond: &Task<'_>, face: &Extended<'_>| match clearance {
        Some(clearance) => Ends::clear(beyond, face, along, clearance),
        None => Ends::whole(face, along),
    };
    let laid = |surface: &dyn Surface, progress: &(dyn Fn(f64) + Sync)| {
        let inner = Task { surface, progress, ..*task };
        let face = Extended::of(&inner, None);
        let beyond = &Task { surface: &face, ..inner };
        let layout = lay_out(beyond, ends(beyond, &face), &|f| progress(0.5 * f))?;
        built(beyond, &face, layout)
    };
    // Round a face that closes passes have no end at which they could turn back.
    if Seat::new(task, along).closes(along) {
        return laid(task.surface, task.progress);
    }
    let (needs, own) = {
        let face = Extended::of(task, None);
        let beyond = &Task { surface: &face, ..*task };
        let ends = ends(beyond, &face);
        (needs(beyond, &ends)?, ends.own.get(along))
    };
    (task.progress)(NEEDS);
    // A region costs its retract about what a way over the face does.
    let over: f64 = needs.iter().map(|n| n.length_mm).sum();
    let cuts = borders(&needs, OVER * task.cutter.radius_mm(), over);
    let ends: Vec<f64> = [own.lo].into_iter().chain(cuts).chain([own.hi]).collect();
    let count = ends.len() - 1;
    if count == 1 {
        return laid(task.surface, &|f| (task.progress)(NEEDS + (1.0 - NEEDS) * f));
    }
    let mut out = Passes::default();
    for (k, w) in ends.windows(2).enumerate() {
        let region =
            Region { base: task.surface, along, range: Interval { lo: w[0], hi: w[1], periodic: false } };
        let progress = |f: f64| (task.progress)(NEEDS + (1.0 - NEEDS) * (k as f64 + f) / count as f64);
        let passes = laid(&region, &progress)?;
        out.passes.extend(passes.passes);
        out.diagnostics.extend(passes.diagnostics);
    }
    let axis = if along == Axis::U { "u" } else { "v" };
    let at = ends[1..count].iter().map(|t| format!("{t:.4}")).collect::<Vec<_>>().join(", ");
    let what = format!("{count} regions with borders at {axis} = {at}, {:.0} mm", out.length_mm());
    out.diagnostics.push(Diagnostic::note(task.face, what));
    Ok(out)
}

/// How many passes columns across a face need, each by itself.
fn needs(task: &Task<'_>, ends: &Ends) -> Result<Vec<Need>, PlanError> {
    let (own, along) = (ends.own, ends.along);
    let [lo, hi] = inside_across(task, ends)?;
    let slack = 1e-7 * (hi - lo);
    let seat = Seat::new(task, along).held_by(own);
    let parameters: Vec<f64> = (0..=COLUMNS).map(|k| own.get(along).at(k as f64 / COLUMNS as f64)).collect();
    let step = first_step(task, along, Interval::new(lo, hi));
    let place = |k: usize| task.surface.point(Uv::from_axis(along, parameters[k], 0.5 * (lo + hi)));
    let need = |k: usize| -> Result<Need, LineError> {
        let inside = stretches(task.surface, along, [lo, hi], &parameters, k);
        let mut column = Column { t: parameters[k], inside, frontier: None, left: 0.0 };
        column.advance(lo, slack);
        let (mut passes, mut guess, mut last) = (0, step, None::<f64>);
        while let Some(frontier) = column.frontier {
            if passes as usize >= MAX_PASSES {
                break;
            }
            let cover = Cover { seat: &seat, task, ends, reversed: passes % 2 == 1, hi, guess };
            let pass = cover.furthest_pass(&column, frontier)?;
            let to = cover.reached(&column, pass)?;
            if let Some(last) = last {
                guess = (pass - last).max(slack);
            }
            last = Some(pass);
            passes += 1;
            // A column that no pass covers stands for as many as its neighbours: laying passes out says why.
            if to <= frontier {
                return Ok(Need { t: column.t, passes: 0, length_mm: 0.0 });
            }
            column.advance(to, slack);
        }
        // Beside the inside there is nothing to go along, and no region of it alone.
        let beside = if passes == 0 { 0.0 } else { 0.5 };
        let length_mm = beside * (place((k + 1).min(COLUMNS)) - place(k.saturating_sub(1))).norm();
        Ok(Need { t: column.t, passes, length_mm })
    };
    let found: Result<Vec<Need>, LineError> = (0..=COLUMNS).into_par_iter().map(need).collect();
    found.map_err(|e| task.contact(e.into()))
}

/// The borders between regions that make the least length of path, where a border adds `over_mm` to each pass that ends at it, and a
/// region `each_mm`.
fn borders(needs: &[Need], over_mm: f64, each_mm: f64) -> Vec<f64> {
    let n = needs.len();
    // Length of a region of the columns from i to before j.
    let cost = |i: usize, j: usize| {
        let passes = needs[i..j].iter().map(|c| c.passes).max().unwrap_or(0);
        let length: f64 = needs[i..j].iter().map(|c| c.length_mm).sum();
        let ends = u32::from(i > 0) + u32::from(j < n);
        f64::from(passes) * (length + f64::from(ends) * over_mm) + each_mm
    };
    // Least length of the first columns in so many regions, and where the last of these begins.
    let mut rounds: Vec<Vec<(f64, usize)>> = Vec::new();
    for round in 0..MOST {
        let least = |j: usize| {
            let from = |i: usize| match rounds.last() {
                Some(before) => before[i].0 + cost(i, j),
                None if i == 0 => cost(0, j),
                None => f64::INFINITY,
            };
            (round..j).map(|i| (from(i), i)).fold((f64::INFINITY, 0), |a, b| if b.0 < a.0 { b } else { a })
        };
        let next = (0..=n).map(least).collect();
        rounds.push(next);
    }
    // The fewest regions of the least length.
    let best = (0..MOST).fold(0, |a, b| if rounds[b][n].0 < rounds[a][n].0 { b } else { a });
    let (mut cuts, mut j) = (Vec::new(), n);
    for round in rounds[..=best].iter().rev() {
        j = round[j].1;
        if j > 0 {
            cuts.push(0.5 * (needs[j - 1].t + needs[j].t));
        }
    }
    cuts.reverse();
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn column(k: usize, passes: u32) -> Need {
        Need { t: k as f64, passes, length_mm: 1.0 }
    }

    #[test]
    fn no_region_lies_beside_the_inside_alone() {
        let beside = Need { t: 0.0, passes: 0, length_mm: 0.0 };
        for n in 1..6 {
            let mut needs = vec![beside; n];
            needs.extend((n..n + 4).map(|k| column(k, 40)).chain((n + 4..n + 8).map(|k| column(k, 5))));
            needs.extend(vec![beside; n]);
            needs.iter_mut().enumerate().for_each(|(k, need)| need.t = k as f64);
            assert_eq!(borders(&needs, 0.1, 8.0), [n as f64 + 3.5]);
        }
    }

    /// Length of path with borders after the columns marked by bits.
    fn length(needs: &[Need], marks: u32, over: f64, each: f64) -> f64 {
        let n = needs.len();
        let mut all = vec![0];
        all.extend((1..n).filter(|k| marks >> (k - 1) & 1 == 1));
        all.push(n);
        let of = |w: &[usize]| {
            let passes = needs[w[0]..w[1]].iter().map(|c| c.passes).max().unwrap();
            let ends = f64::from(u8::from(w[0] > 0) + u8::from(w[1] < n));
            f64::from(passes) * ((w[1] - w[0]) as f64 + ends * over) + each
        };
        all.windows(2).map(of).sum()
    }

    proptest! {
        /// No other choice of at most three borders is shorter.
        #[test]
        fn borders_are_the_best(passes in prop::collection::vec(1u32..30, 1..10), over in 0.0..2.0f64, each in 0.0..20.0f64) {
            let needs: Vec<Need> = passes.iter().enumerate().map(|(k, p)| column(k, *p)).collect();
            let cuts = borders(&needs, over, each);
            let marks = cuts.iter().map(|t| 1u32 << (t - 0.5) as u32).sum::<u32>();
            let got = length(&needs, marks, over, each);
            let all = (0..1u32 << (needs.len() - 1)).filter(|m| m.count_ones() < MOST as u32);
            let want = all.map(|m| length(&needs, m, over, each)).fold(f64::INFINITY, f64::min);
            prop_assert!((got - want).abs() < 1e-9, "{got} against {want}");
        }
    }
}
