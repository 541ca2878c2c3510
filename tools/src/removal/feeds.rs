//! How fast a tool goes where it cuts, against the feed that it is for.
//!
//! What takes declared raw material cuts, and so does what makes the faces to machine. Ways through the air are as fast as they like.

use super::goal::Program;
use super::job::{Body, Cut, Sample};
use super::stock::{Carved, Work};
use super::trial::Trial;

/// A feed above that of its tool by no more than this is one: rounding of feed words and of the path stays far below.
const EXCESS: f64 = 1.05;
/// Moves that are too short to tell their feed, mm: they say more about rounding.
const SHORT_MM: f64 = 0.05;

/// Moves that cut faster than the feed of their tool.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TooFast {
    /// How many.
    pub moves: usize,
    /// The block of that which exceeds its feed most.
    pub block: u32,
    /// How fast its tip goes, mm/min.
    pub mm_min: f64,
    /// The feed of its tool, mm/min.
    pub feed_mm_min: f64,
}

impl TooFast {
    /// With those of another stretch of a program.
    pub(super) fn with(self, other: Option<Self>) -> Self {
        let Some(other) = other else { return self };
        let most = if other.excess() > self.excess() { other } else { self };
        Self { moves: self.moves + other.moves, ..most }
    }

    fn excess(&self) -> f64 {
        self.mm_min / self.feed_mm_min
    }
}

impl Work {
    /// Whether this is more than a touch: a chip thicker than `touch_mm` all across a tool of this radius.
    #[must_use]
    pub fn is_cut(&self, radius_mm: f64, touch_mm: f64) -> bool {
        self.section_mm2 > 2.0 * radius_mm * touch_mm
    }
}

impl Trial<'_> {
    /// What of one tool's work is done too fast; its motions begin at `begin` of the program.
    pub fn too_fast(&self, carved: &Carved, begin: usize, touch_mm: f64) -> Option<TooFast> {
        let radius_mm = self.goal.tools[self.program.tool_of(begin)].flutes.radius_mm();
        let work = carved.work.iter().filter(|w| w.is_cut(radius_mm, touch_mm));
        self.fastest(work.map(|w| begin + w.motion as usize))
    }

    /// What of the faces to machine is made too fast.
    pub fn made_too_fast(&self, samples: &[Sample], cuts: &[Cut]) -> Option<TooFast> {
        let made = samples.iter().zip(cuts).filter(|(s, _)| !s.check_only);
        let by = made.filter_map(|(_, c)| c.by.filter(|by| !by.rapid && by.body == Body::Cutter));
        let mut motions: Vec<u32> = by.map(|by| by.motion).collect();
        motions.sort_unstable();
        motions.dedup();
        self.fastest(motions.into_iter().map(|m| m as usize))
    }

    /// Those of motions that are faster than the feeds of their tools, by the times of the program.
    fn fastest(&self, motions: impl Iterator<Item = usize>) -> Option<TooFast> {
        let Program { motions: all, times_min, .. } = self.program;
        let mut out: Option<TooFast> = None;
        for k in motions {
            let Some(feed_mm_min) = self.goal.tools[self.program.tool_of(k)].feed_mm_min else { continue };
            let length_mm = (all[k].to.tip - all[k].from.tip).norm();
            let begun_min = if k == 0 { 0.0 } else { *times_min.get(k - 1)? };
            let took_min = times_min.get(k)? - begun_min;
            if length_mm < SHORT_MM || took_min <= 0.0 {
                continue;
            }
            let mm_min = length_mm / took_min;
            if mm_min > EXCESS * feed_mm_min {
                let this = TooFast { moves: 1, block: all[k].block, mm_min, feed_mm_min };
                out = Some(this.with(out));
            }
        }
        out
    }

    /// What is said of feeds in the scope of a verdict, with raw material that was looked at or without.
    pub fn feed_words(&self, too_fast: Option<TooFast>, with_stock: bool) -> String {
        if self.program.times_min.is_empty() || self.goal.tools.iter().any(|t| t.feed_mm_min.is_none()) {
            return "NOT looked at: nothing says it, or what it is to be".to_owned();
        }
        let Some(fast) = too_fast else {
            let stock = if with_stock { ", and what takes raw material," } else { "" };
            return format!("what makes the faces{stock} goes no faster than its tool's feed");
        };
        let many = match fast.moves {
            1 => "1 move that cuts is faster than its tool's feed,".to_owned(),
            n => format!("{n} moves that cut are faster than their tool's feed, most"),
        };
        format!(
            "{many} in block {}: {:.0} mm/min where that is {:.0}",
            fast.block, fast.mm_min, fast.feed_mm_min
        )
    }
}
