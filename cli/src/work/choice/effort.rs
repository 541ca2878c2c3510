//! How much is tried: counts, so that the same job gives the same choice everywhere.

use crate::job::words::EffortWord;

/// How many candidates are planned or verified at most.
#[derive(Debug, Clone, Copy)]
pub struct Most {
    /// Plans, and while none is known to hold.
    pub plans: usize,
    pub in_need: usize,
    /// Plans around one that holds: with its tool and leads found place by place, with leads beside its own, and with other strategies.
    pub local: usize,
    pub beside: usize,
    pub others: usize,
    /// The same where one with a field of axes holds; nothing else is tried then, nor lines of curvature: on none of thirteen real faces
    /// was a plan along them the quickest that held.
    pub local_beside_field: usize,
    /// Plans with fields of axes, which are the first, and with those that are tried around one that holds.
    pub fields: usize,
    pub fields_around: usize,
    /// Plans with other tools then, also where a field holds, and with one of them.
    pub elsewhere: usize,
    pub elsewhere_beside_field: usize,
    pub of_another: usize,
    /// Plans with a tilt held of those whose tilt was found place by place.
    pub held_twins: usize,
    /// Plans of tools that keep their axis around one that holds.
    pub kept: usize,
    /// Plans of one thing again, each for other shares of the tolerance.
    pub again: usize,
    /// Contenders that are verified, and of those that hold at their samples only, and closer passes too, after which the best of them is
    /// taken: finer looks are for the job to ask for.
    pub verified: usize,
    pub not_shown: usize,
}

/// (Tuned on thirteen real faces, by what more plans gained.)
const NORMAL: Most = Most {
    plans: 16,
    in_need: 28,
    local: 6,
    beside: 3,
    others: 3,
    local_beside_field: 2,
    fields: 3,
    fields_around: 4,
    elsewhere: 4,
    elsewhere_beside_field: 2,
    of_another: 2,
    held_twins: 2,
    kept: 3,
    again: 8,
    verified: 12,
    not_shown: 2,
};

/// Leads found place by place gain the most; until something holds as much is tried as else.
const QUICK: Most = Most {
    local: 1,
    beside: 0,
    others: 0,
    local_beside_field: 1,
    fields_around: 3,
    elsewhere: 0,
    elsewhere_beside_field: 0,
    held_twins: 0,
    kept: 1,
    again: 0,
    ..NORMAL
};

const LONG: Most = Most {
    plans: 48,
    in_need: 84,
    local: 12,
    beside: 6,
    others: 9,
    local_beside_field: 8,
    fields: 6,
    fields_around: 8,
    elsewhere: 12,
    elsewhere_beside_field: 8,
    of_another: 4,
    held_twins: 6,
    kept: 8,
    again: 16,
    verified: 30,
    not_shown: 4,
};

impl Most {
    /// What an effort allows.
    pub const fn of(effort: EffortWord) -> Self {
        match effort {
            EffortWord::Quick => QUICK,
            EffortWord::Normal => NORMAL,
            EffortWord::Long => LONG,
        }
    }
}
