//! The sense in which passes are run.
//!
//! Passes that share their axes leave the same whichever way they are run, so that the sense is a wish about cutting: all one way,
//! or the spindle's rotation with or against the feed. The spindle turns clockwise seen from above (M3): with what is still to be cut on the
//! right of the feed its teeth go into the full chip and out of nothing, which is climb milling.

use super::{CcPoint, Pass};
use osculate_geom::Vec3;

/// How chips are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Milling {
    /// As it comes.
    #[default]
    Any,
    /// From thick to thin.
    Climb,
    /// From thin to thick.
    Conventional,
}

/// Wishes about the sense of passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Senses {
    /// Whether neighbouring passes all run the same way.
    pub one_way: bool,
    /// How chips are cut.
    pub milling: Milling,
}

/// Passes lie side by side where the middle of one is no further from the other than so many widths of its strip.
const BESIDE: f64 = 3.0;

/// The middle point of a pass and the direction of feed there.
fn middle(pass: &Pass) -> Option<(&CcPoint, Vec3)> {
    let k = pass.points.len() / 2;
    let (a, b) = (pass.points.get(k.checked_sub(1)?)?, pass.points.get(k)?);
    Some((b, (b.point - a.point).normalize()))
}

/// The point of a pass that is nearest to another's middle, and the feed there; None where that is not beside it.
fn beside<'a>(of: &CcPoint, other: &'a Pass) -> Option<(&'a CcPoint, Vec3)> {
    let far = |p: &CcPoint| (p.point - of.point).norm_squared();
    let k =
        (0..other.points.len()).min_by(|a, b| far(&other.points[*a]).total_cmp(&far(&other.points[*b])))?;
    let near = &other.points[k];
    let (a, b) = (&other.points[k.saturating_sub(1)], other.points.get(k + 1).unwrap_or(near));
    (far(near).sqrt() <= BESIDE * of.width_mm.max(near.width_mm))
        .then(|| (near, (b.point - a.point).normalize()))
}

fn turn(pass: &mut Pass) {
    pass.points.reverse();
}

/// How much of what is still to be cut lies on the right of a pass's feed: that which a pass run after it lies beside it, or else the
/// other side of the one before; None for a pass that stands alone.
fn right_of(passes: &[Pass], k: usize) -> Option<f64> {
    let (here, feed) = middle(&passes[k])?;
    let right = feed.cross(&here.normal);
    let side = |j: usize| beside(here, passes.get(j)?).map(|(p, _)| (p.point - here.point).dot(&right));
    side(k + 1).or_else(|| side(k.checked_sub(1)?).map(|x| -x))
}

/// Runs passes in the senses wished for. Passes that stand alone stay as they are where the wish is about chips.
///
/// ```
/// use osculate_geom::{Point3, Vec3, uv};
/// use osculate_productivity::plan::{CcPoint, Milling, Pass, Senses, run_in};
/// use osculate_tools::Pose;
///
/// let at = |x: f64, y: f64| {
///     let point = Point3::new(x, y, 0.0);
///     CcPoint { uv: uv(x, y), point, normal: Vec3::z_axis(), pose: Pose { tip: point, axis: Vec3::z_axis() }, width_mm: 1.0 }
/// };
/// let pass = |y: f64, from: f64, to: f64| Pass { points: vec![at(from, y), at(to, y)], closed: false };
/// // To and fro, then all the same way.
/// let mut passes = [pass(0.0, 0.0, 10.0), pass(1.0, 10.0, 0.0), pass(2.0, 0.0, 10.0)];
/// run_in(&mut passes, Senses { one_way: true, milling: Milling::Any });
/// let forward = |p: &Pass| p.points[1].point.x > p.points[0].point.x;
/// assert!(passes.iter().all(|p| forward(p) == forward(&passes[0])));
/// ```
pub fn run_in(passes: &mut [Pass], senses: Senses) {
    match senses.milling {
        Milling::Any if senses.one_way => {
            for k in 1..passes.len() {
                let (before, rest) = passes.split_at_mut(k);
                let against = middle(&rest[0]).is_some_and(|(here, feed)| {
                    beside(here, &before[k - 1]).is_some_and(|(_, other)| feed.dot(&other) < 0.0)
                });
                if against {
                    turn(&mut rest[0]);
                }
            }
        }
        Milling::Any => {}
        Milling::Climb | Milling::Conventional => {
            let wanted = if senses.milling == Milling::Climb { 1.0 } else { -1.0 };
            let against: Vec<bool> =
                (0..passes.len()).map(|k| right_of(passes, k).is_some_and(|x| x * wanted < 0.0)).collect();
            for (pass, against) in passes.iter_mut().zip(against) {
                if against {
                    turn(pass);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Point3, uv};
    use osculate_tools::Pose;
    use proptest::prelude::*;

    /// Passes along x over a plane, y growing from pass to pass, each run either way.
    fn passes(ways: &[bool]) -> Vec<Pass> {
        let point = |k: usize, i: usize, back: bool| {
            let x = if back { 9 - i } else { i } as f64;
            let point = Point3::new(x, k as f64, 0.0);
            let pose = Pose { tip: point, axis: Vec3::z_axis() };
            CcPoint { uv: uv(x, k as f64), point, normal: Vec3::z_axis(), pose, width_mm: 1.0 }
        };
        let one = |(k, back): (usize, &bool)| Pass {
            points: (0..10).map(|i| point(k, i, *back)).collect(),
            closed: false,
        };
        ways.iter().enumerate().map(one).collect()
    }

    fn feed_x(pass: &Pass) -> f64 {
        (pass.points[9].point - pass.points[0].point).x
    }

    proptest! {
        #[test]
        fn a_wish_is_kept_on_every_pass(ways in prop::collection::vec(any::<bool>(), 2..12), climb in any::<bool>()) {
            let mut all = passes(&ways);
            let milling = if climb { Milling::Climb } else { Milling::Conventional };
            run_in(&mut all, Senses { one_way: false, milling });
            // What is still to be cut lies towards greater y: on the right of a feed along -x.
            for p in &all {
                prop_assert_eq!(feed_x(p) < 0.0, climb);
            }
            let mut all = passes(&ways);
            run_in(&mut all, Senses { one_way: true, milling: Milling::Any });
            for p in &all {
                prop_assert_eq!(feed_x(p), feed_x(&all[0]));
            }
            let mut same = passes(&ways);
            run_in(&mut same, Senses::default());
            prop_assert_eq!(same, passes(&ways));
        }
    }
}
