//! A binary tree of cones over a set of directions.
//!
//! A cone is told by its middle axis c and the greatest angle alpha between c and its members; every member a has
//! `|a - c| <= 2 sin(alpha / 2)`. A cone of one member has alpha = 0 and is that member.

use osculate_geom::{Unit3, Vec3};
use std::ops::Range;

/// Added to the angle of a cone, rad: it was computed, and must not come out too small.
const ROUNDING_RAD: f64 = 1e-12;

/// A cone of directions.
#[derive(Clone, Debug)]
pub(super) struct Cone {
    pub axis: Unit3,
    /// Greatest angle between the axis and a member; zero for a single member.
    pub angle_rad: f64,
    /// Its members, as places in [`ConeTree::order`].
    pub members: Range<usize>,
    /// The second half of it; the first half follows the cone itself. None for a single member.
    pub second: Option<usize>,
}

/// The tree; the first cone is the root.
#[derive(Clone, Debug)]
pub(super) struct ConeTree {
    pub cones: Vec<Cone>,
    /// Indices of directions, those of each cone together.
    pub order: Vec<u32>,
}

impl ConeTree {
    pub fn new(all: &[Unit3]) -> Self {
        let order = (0..all.len() as u32).collect();
        let mut tree = Self { cones: Vec::with_capacity(2 * all.len()), order };
        tree.add(all, 0..all.len());
        tree
    }

    fn add(&mut self, all: &[Unit3], members: Range<usize>) -> usize {
        let own = &mut self.order[members.clone()];
        let of = |k: &u32| all[*k as usize];
        let sum = own.iter().fold(Vec3::zeros(), |s, k| s + of(k).into_inner());
        let first = of(&own[0]);
        // The whole sphere has no mean: any axis serves it.
        let axis = if own.len() == 1 {
            first
        } else {
            Unit3::try_new(sum, 1e-9 * own.len() as f64).unwrap_or(first)
        };
        let chord = own.iter().map(|k| (of(k).into_inner() - axis.into_inner()).norm()).fold(0.0, f64::max);
        let angle_rad = if own.len() == 1 {
            0.0
        } else {
            (2.0 * (0.5 * chord).min(1.0).asin() + ROUNDING_RAD).min(std::f64::consts::PI)
        };
        let index = self.cones.len();
        self.cones.push(Cone { axis, angle_rad, members: members.clone(), second: None });
        if members.len() > 1 {
            let spread = |i: usize| {
                let (lo, hi) = own.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), k| {
                    (lo.min(of(k)[i]), hi.max(of(k)[i]))
                });
                hi - lo
            };
            let widest = (1..3).fold(0, |w, i| if spread(i) > spread(w) { i } else { w });
            let half = members.len() / 2;
            own.select_nth_unstable_by(half, |a, b| {
                of(a)[widest].total_cmp(&of(b)[widest]).then_with(|| a.cmp(b))
            });
            let middle = members.start + half;
            self.add(all, members.start..middle);
            let second = self.add(all, middle..members.end);
            self.cones[index].second = Some(second);
        }
        index
    }
}
