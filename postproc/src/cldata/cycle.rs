//! Drilling cycles of CL data, as the moves that they stand for.
//!
//! `CYCLE/DRILL,FEDTO,d,MMPM,f,RAPTO,r,RTRCTO,h`: at every point to come, which lies on the part's face, the tool goes
//! over it at h, rapidly down to r above it, at feed to d below, back to r (rapidly, or at feed for reaming, boring and
//! tapping) and to h. `1STPECK` and `SUBPECK` (or `STEP`) bound the depth of a peck; `DEEP` leaves the hole after each,
//! `BRKCHP` only breaks the chip. `DWELL` waits at the bottom, s. A tap turns back there and, when it is out, again. Forms without `FEDTO` differ from system to system and are not interpreted.

use super::error::ClReadError;
use super::feed::{FEEDS, Feed};
use super::fields::numbers;
use super::statement::Statement;

/// How far above the last depth the feed starts again, and how far a chip is broken, mm.
const GAP_MM: f64 = 0.5;
/// Pecks of one hole at most.
const MOST_PECKS: usize = 10_000;

/// How the tool gets out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Drill,
    /// Out at feed.
    Ream,
    /// Out at feed, and the spindle turns back.
    Tap,
    /// Out of the hole after every peck.
    Deep,
    /// A little back after every peck.
    BreakChip,
}

/// A cycle in force.
#[derive(Clone, Debug)]
pub(super) struct Cycle {
    pub kind: Kind,
    pub feed: Option<Feed>,
    /// At the bottom, s.
    pub dwell_s: f64,
    depth_mm: f64,
    clear_mm: f64,
    retract_mm: f64,
    pecks_mm: [f64; 2],
}

/// The cycle of a statement; `None` where it is not understood.
pub(super) fn cycle(s: &Statement, unit_mm: f64) -> Result<Option<Cycle>, ClReadError> {
    let name = s.fields.first().map_or("", String::as_str);
    let kind = match name {
        "DRILL" | "FACE" | "CSINK" | "SPOT" => Kind::Drill,
        "REAM" | "BORE" => Kind::Ream,
        "TAP" => Kind::Tap,
        "BRKCHP" | "BRKCHP2" => Kind::BreakChip,
        deep if deep.starts_with("DEEP") => Kind::Deep,
        _ => return Ok(None),
    };
    let value = |names: &[&str]| -> Result<Option<f64>, ClReadError> {
        match s.fields.iter().position(|f| names.contains(&f.as_str())) {
            Some(k) => Ok(numbers(s, s.fields.get(k + 1..k + 2).unwrap_or_default())?.first().copied()),
            None => Ok(None),
        }
    };
    let Some(depth) = value(&["FEDTO"])?.filter(|d| *d > 0.0) else { return Ok(None) };
    let mut feed = None;
    for (names, unit, per_turn) in
        [(["MMPM"], 1.0, false), (["MMPR"], 1.0, true), (["IPM"], 25.4, false), (["IPR"], 25.4, true)]
    {
        if let Some(mm) = value(&names)?.map(|f| f * unit) {
            if !FEEDS.contains(&mm) {
                return Err(ClReadError::Feed { line: s.line, feed_mm_min: mm });
            }
            feed = Some(Feed { mm, per_turn, line: s.line });
        }
    }
    let clear_mm = unit_mm * value(&["RAPTO"])?.unwrap_or(0.0);
    let peck = value(&["SUBPECK", "STEP"])?;
    let first = value(&["1STPECK"])?.or(peck).unwrap_or(depth);
    let cycle = Cycle {
        kind,
        feed,
        dwell_s: value(&["DWELL"])?.unwrap_or(0.0),
        depth_mm: unit_mm * depth,
        clear_mm,
        retract_mm: value(&["RTRCTO"])?.map_or(clear_mm, |h| unit_mm * h),
        pecks_mm: [unit_mm * first, unit_mm * peck.unwrap_or(first)],
    };
    let sane = cycle.pecks_mm.iter().all(|p| *p * MOST_PECKS as f64 > cycle.depth_mm);
    Ok(sane.then_some(cycle))
}

/// What follows when a height is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Then {
    GoOn,
    /// The bottom of the hole.
    Bottom,
    /// The spindle turns back (true), or as before.
    Reverse(bool),
}

/// A move of a cycle along the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// Above the point, mm.
    pub above_mm: f64,
    pub rapid: bool,
    pub then: Then,
}

impl Cycle {
    /// The moves at a point, one after the other.
    pub fn steps(&self) -> Vec<Step> {
        let go = |above_mm: f64, rapid: bool| Step { above_mm, rapid, then: Then::GoOn };
        let mut all = vec![go(self.retract_mm, true), go(self.clear_mm, true)];
        let pecks = matches!(self.kind, Kind::Deep | Kind::BreakChip);
        let [first, next] = self.pecks_mm;
        let mut depth = if pecks { first } else { self.depth_mm };
        while depth < self.depth_mm {
            all.push(go(-depth, false));
            let gap = GAP_MM.min(0.5 * next);
            if self.kind == Kind::Deep {
                all.push(go(self.clear_mm, true));
            }
            all.push(go(gap - depth, true));
            depth += next;
        }
        let tap = self.kind == Kind::Tap;
        let then = |tap_turns: bool| if tap { Then::Reverse(tap_turns) } else { Then::Bottom };
        all.push(Step { then: then(true), ..go(-self.depth_mm, false) });
        let out = go(self.clear_mm, !(tap || self.kind == Kind::Ream));
        all.push(if tap { Step { then: then(false), ..out } } else { out });
        if self.retract_mm > self.clear_mm {
            all.push(go(self.retract_mm, true));
        }
        all
    }
}
