//! Where the search for the best motion begins: the cutter beside the rules, tilted more or less by the face's twist.

use crate::flank::axes::{AxisPoints, AxisSurface};
use crate::flank::global::{GlobalError, StartError, Task};
use osculate_geom::{Interval, Vec3, uv};

/// A first motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Start {
    /// The motion.
    pub axes: AxisSurface,
    /// How much of the twist between the end normals the axis follows: 0 none (standard setting), 1 all of it (double point
    /// offset).
    pub share: f64,
}

/// Shares of the twist tried.
const SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// Part of the face's length by which the first motion keeps off a rule with infinite derivatives, such as the end of a
/// directrix in the root of u: the rule that is taken lies within a thousandth of the length.
const ASIDE: f64 = 1e-6;

/// The axis beside the rule at u.
fn axis(task: &Task<'_>, u: f64, share: f64) -> Result<AxisPoints, StartError> {
    // Beyond the face the end rule goes on along the tangents of the directrices.
    let range = task.surface.domain().u;
    let at = |inside: f64| (inside, [0.0, 1.0].map(|v| task.surface.jet2(uv(inside, v))));
    let (mut inside, mut jets) = at(range.bring(u));
    // The point of such a jet may be no number either.
    if jets.iter().any(|j| !j.point.iter().chain(j.du.iter()).all(|x| x.is_finite())) {
        (inside, jets) = at(inside + ASIDE * (range.at(0.5) - inside).signum() * range.length());
    }
    let ends = jets.map(|j| j.point + j.du * (u - inside));
    let rule = ends[1] - ends[0];
    let sign = jets[0].side.sign();
    let normals = jets.map(|j| {
        let n: Vec3 = j.du.cross(&rule) * sign;
        n.try_normalize(0.0).filter(|n| n.iter().all(|x| x.is_finite()))
    });
    let [Some(a), Some(b)] = normals else { return Err(StartError::Degenerate { u }) };
    // A half turn to rounding has no bisector.
    let Some(middle) = (a + b).try_normalize(1e-9) else { return Err(StartError::Opposite { u }) };
    let length = rule.norm();
    let radius = [0.0, length].map(|z| task.side.radius_at_mm(z));
    let towards = |n: Vec3| (middle * (1.0 - share) + n * share).normalize();
    Ok(AxisPoints { lower: ends[0] + towards(a) * radius[0], upper: ends[1] + towards(b) * radius[1] })
}

/// First motions for a task.
///
/// # Errors
/// [`GlobalError::Start`], [`GlobalError::Axes`].
pub fn starts(task: &Task<'_>, spans: usize) -> Result<Vec<Start>, GlobalError> {
    let range: Interval = task.positions;
    SHARES
        .into_iter()
        .map(|share| {
            let places: Result<Vec<AxisPoints>, StartError> =
                (0..=spans).map(|k| axis(task, range.at(k as f64 / spans as f64), share)).collect();
            Ok(Start { axes: AxisSurface::along(range, &places?)?, share })
        })
        .collect()
}
