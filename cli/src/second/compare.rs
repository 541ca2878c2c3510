//! The second opinion beside the verification's own figures.

use super::opinion::Opinion;

/// What the verification has found, with its bounds on what may hide between its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Deepest gouge along a normal at a sample.
    pub gouge_mm: f64,
    /// No gouge is deeper.
    pub gouge_bound_mm: f64,
    /// Most that stands over a sample of the faces to machine.
    pub left_mm: f64,
    /// Nothing stands higher.
    pub left_bound_mm: f64,
}

/// What is accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accepted {
    /// Greatest gouge.
    pub gouge_mm: f64,
    /// Most that may stand.
    pub left_mm: f64,
}

/// Which figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Which {
    /// The deepest gouge.
    Gouge,
    /// What is left standing.
    Left,
}

/// What both come to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Agreement {
    /// As far as both can tell they say the same.
    Agrees {
        /// By how much the gouges differ.
        gouge_apart_mm: f64,
        /// By how much what is left differs.
        left_apart_mm: f64,
        /// What they may differ by.
        slack_mm: f64,
    },
    /// They do not.
    Disagrees {
        /// In which figure.
        which: Which,
        /// The verification's: its bound where ours is above it.
        theirs_mm: f64,
        /// The second opinion's.
        ours_mm: f64,
        /// What they may differ by.
        slack_mm: f64,
    },
}

/// Holds an opinion against the figures of a verification.
///
/// Ours are poses and points that are there: a figure above their bound by more than the slack is something that they have not
/// seen. Theirs may be above ours by what may lie between our points too. A gouge of theirs is measured along the normal and is never
/// less than ours, the depth in the tool; it is held against ours only where one is within what is accepted and the other not.
#[must_use]
pub fn compare(opinion: &Opinion, theirs: &Figures, accepted: &Accepted) -> Agreement {
    let slack_mm = opinion.slack_mm;
    // Negative gouges are distances: nothing is cut.
    let gouge = opinion.gouge_mm.max(0.0);
    let differs =
        |which, theirs_mm, ours_mm, slack_mm| Agreement::Disagrees { which, theirs_mm, ours_mm, slack_mm };
    if gouge > theirs.gouge_bound_mm.max(0.0) + slack_mm {
        return differs(Which::Gouge, theirs.gouge_bound_mm, gouge, slack_mm);
    }
    let between = slack_mm + opinion.gouge_between_mm;
    if theirs.gouge_mm > accepted.gouge_mm && gouge + between < accepted.gouge_mm {
        return differs(Which::Gouge, theirs.gouge_mm, gouge, between);
    }
    let left = opinion.left_mm;
    if left > theirs.left_bound_mm + slack_mm {
        return differs(Which::Left, theirs.left_bound_mm, left, slack_mm);
    }
    let between = slack_mm + opinion.left_between_mm(theirs.left_mm);
    if theirs.left_mm > left + between && theirs.left_mm > accepted.left_mm {
        return differs(Which::Left, theirs.left_mm, left, between);
    }
    Agreement::Agrees {
        gouge_apart_mm: (theirs.gouge_mm.max(0.0) - gouge).abs(),
        left_apart_mm: (theirs.left_mm - left).abs(),
        slack_mm: between.max(slack_mm + opinion.gouge_between_mm),
    }
}
