//! How far a candidate has come, and what is known of it.

use super::measured::Measured;
use crate::job::Overrides;
use crate::work::budget::Shares;
use crate::work::program::{Planned, Posted};
use osculate_productivity::compare::{Axes, Candidate, Screened};

/// How far a candidate has come.
pub(super) enum State {
    /// Screened.
    Open,
    /// Planned and looked at: the least time that its length needs, min.
    Planned(Box<Planned<'static>>),
    /// Posted: a contender.
    Posted(Box<(Planned<'static>, Posted)>),
    /// Handed out for verification.
    Taken,
    /// Out, with the reason.
    Out(String),
}

/// Figures of a plan, kept after the plan is gone.
#[derive(Clone, Copy)]
pub(super) struct Figures {
    pub passes: usize,
    pub points: usize,
    pub cutting_length_mm: f64,
    pub cutting_min: f64,
    pub posted_min: Option<f64>,
    /// What it leaves to other operations, by a coarse look or as it was measured.
    pub left: Left,
}

/// What a plan leaves to other operations.
#[derive(Clone, Copy)]
pub(super) struct Left {
    /// Area, mm2.
    pub area_mm2: f64,
    /// Of all of it.
    pub of_mm2: f64,
    /// What a small ball needs for it, min/mm2.
    pub min_per_mm2: f64,
}

impl Left {
    /// What a plan that takes so long itself counts for: with the time that others are taken to need for what it leaves, of which they make no more
    /// in a minute than it does, min.
    pub fn counted(self, own_min: f64) -> f64 {
        if self.area_mm2 <= 0.0 {
            return own_min;
        }
        let own_min_per_mm2 = own_min / (self.of_mm2 - self.area_mm2).max(0.0);
        own_min + self.area_mm2 * own_min_per_mm2.max(self.min_per_mm2)
    }
}

/// One candidate's story.
pub(super) struct Entry {
    pub candidate: Candidate,
    pub screened: Screened,
    pub state: State,
    pub figures: Option<Figures>,
    pub verified: Option<Measured>,
    /// The shares of the tolerances that it is laid out for.
    pub shares: Shares,
    /// How often it was laid out for less of the scallop, and of the gouge.
    pub lessened: [usize; 2],
    /// Of one that is another laid out again: which, and what its job is given for that.
    pub again: Option<(usize, Overrides)>,
    /// Whether it was planned, or would have been, and whether that was around a plan with another tool.
    pub tried: bool,
    pub elsewhere: bool,
}

impl Entry {
    /// Whether its lead is found place by place.
    pub fn is_local(&self) -> bool {
        self.candidate.axes.is_local()
    }

    /// Whether it is another with its tilt held instead of found.
    pub fn is_held_twin(&self, of: &Self) -> bool {
        let (a, b) = (&self.candidate, &of.candidate);
        a.axes == Axes::Local && b.axes == Axes::Balanced && (a.tool, a.strategy) == (b.tool, b.strategy)
    }

    /// Whether its axes are a field.
    pub fn is_field(&self) -> bool {
        self.candidate.axes == Axes::Field
    }

    /// The least time known of a candidate, min, with that of others for what it leaves to them.
    pub fn least_min(&self) -> f64 {
        self.figures
            .map_or(self.screened.layout_min, |f| f.left.counted(f.posted_min.unwrap_or(f.cutting_min)))
    }
}

/// What is told of a plan that is another laid out again.
pub(super) fn words(own: Overrides, shares: Shares) -> String {
    let marks =
        own.mark_share.map(|share| format!("marks of teeth are left {:.1} % of the scallop", 100.0 * share));
    let chord = own.chord_mm.map(|mm| format!("the chord tolerance is {mm:.4} mm"));
    let blend = own.blend_mm.map(|mm| format!("corners are rounded by up to {mm:.4} mm"));
    let Shares { scallop, gouge, .. } = shares;
    let other = (shares != Shares::WHOLE).then(|| {
        format!(
            "passes are for {:.0} % of the scallop and {:.0} % of the gouge that planning leaves first",
            100.0 * scallop,
            100.0 * gouge
        )
    });
    let given: Vec<String> = marks.into_iter().chain(chord).chain(blend).chain(other).collect();
    format!("; laid out again: {}", given.join(", "))
}

#[cfg(test)]
mod tests {
    use super::Left;

    #[test]
    fn what_is_left_counts_as_others_need_for_it() {
        let left = |area_mm2: f64| Left { area_mm2, of_mm2: 100.0, min_per_mm2: 0.01 };
        assert!((left(0.0).counted(2.0) - 2.0).abs() < 1e-12);
        // A small ball is slower than a plan of 0.5 min for 90 mm2, and no quicker than one of 2 min for 50.
        assert!((left(10.0).counted(0.5) - 0.6).abs() < 1e-12);
        assert!((left(50.0).counted(2.0) - 4.0).abs() < 1e-12);
        // One that cuts hardly anything in no time is worth nothing.
        assert!(left(99.0).counted(0.1) > 9.0 && left(100.0).counted(0.1).is_infinite());
    }
}
