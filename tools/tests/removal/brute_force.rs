//! `cut` against the tool put at many poses of each motion.

use crate::removal::common::{ball, flat, pose, sample, shapes, through, toroidal};
use osculate_geom::Unit3;
use osculate_tools::removal::{Job, Sample, Swept, cut};
use osculate_tools::{Cutter, Line, Pose};
use proptest::prelude::*;

fn at(swept: &Swept, t: f64) -> Pose {
    let axis = swept.from.axis.into_inner() * (1.0 - t) + swept.to.axis.into_inner() * t;
    Pose { tip: swept.from.tip + (swept.to.tip - swept.from.tip) * t, axis: Unit3::new_normalize(axis) }
}

/// The interval of the line that the body covers in a pose.
fn covered(cutter: &Cutter, pose: &Pose, s: &Sample) -> Option<[f64; 2]> {
    let up = Line { origin: s.point, direction: s.normal };
    let down = Line { origin: s.point, direction: -s.normal };
    Some([cutter.entry(pose, &up)?.at_mm, -cutter.entry(pose, &down)?.at_mm])
}

/// The height that one motion leaves, from `steps` poses: the rule for a tool that stands still, at each.
fn height(cutter: &Cutter, swept: &Swept, s: &Sample, steps: u32) -> f64 {
    (0..=steps)
        .filter_map(|k| covered(cutter, &at(swept, f64::from(k) / f64::from(steps)), s))
        .filter(|[_, exit]| *exit >= 0.0)
        .map(|[entry, exit]| if entry >= 0.0 { entry } else { entry.max(-exit) })
        .fold(f64::INFINITY, f64::min)
}

const STOCK: f64 = 1.5;
const DEPTH: f64 = 2.0;

/// Compares `cut` with `steps` poses of each motion.
fn check(cutter: &Cutter, motions: &[Swept], samples: &[Sample], steps: u32) -> Result<usize, TestCaseError> {
    let job = Job { cutter, holder: None, changes: &[], motions, samples, stock_mm: STOCK, depth_mm: DEPTH };
    let cuts = cut(&job, &|_| ()).expect("a good job");
    let mut touched = 0;
    for (s, c) in samples.iter().zip(&cuts) {
        let each = motions.iter().map(|m| height(cutter, m, s, steps));
        let want = each.fold(STOCK, f64::min).max(-DEPTH);
        // Too high it may be by what `cut` allows itself where a turning tool is deepest twice in a row.
        prop_assert!(c.standoff_mm <= want + 5e-5, "{} above brute force {want}: {s:?}", c.standoff_mm);
        touched += usize::from(want < STOCK);
        // Too low: the poses are some micrometres apart, and brute force sees an entry too high by that times
        // the steepness of the boundary against the line. So where the two differ the tool must really come
        // to the point found, within the distance of two poses.
        let lower = want - c.standoff_mm;
        if lower > 1e-6 {
            let by = c.by.expect("lower than the stock");
            let m = &motions[by.motion as usize];
            let near = |height: f64| {
                let p = s.point + s.normal.into_inner() * height;
                let of = |k: u32| cutter.distance(&at(m, f64::from(k) / f64::from(steps)), &p).abs();
                (0..=steps).map(of).fold(f64::INFINITY, f64::min)
            };
            // A gouge from behind is as deep as the exit: the point is then on the other side.
            let off = near(c.standoff_mm).min(if c.standoff_mm < 0.0 {
                near(-c.standoff_mm)
            } else {
                f64::INFINITY
            });
            prop_assert!(off < 5e-3 && lower < 0.2, "lower by {lower}, off {off}: {c:?} want {want}, {s:?}");
        }
    }
    Ok(touched)
}

fn tool(kind: u8) -> Cutter {
    let [a, b, c, d] = shapes();
    [ball(6.0), toroidal(8.0, 1.5), flat(5.0), a, b, c, d][usize::from(kind)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    /// Random short motions of all kinds of cutters around random samples.
    #[test]
    fn agrees_with_many_poses(
        kind in 0u8..7,
        tips in prop::collection::vec(prop::array::uniform3(-2.0..2.0f64), 5),
        axes in prop::collection::vec(prop::array::uniform2(-0.6..0.6f64), 5),
        points in prop::collection::vec(prop::array::uniform5(-1.0..1.0f64), 12)
    ) {
        let pairs = tips.iter().zip(&axes);
        let poses: Vec<Pose> =
            pairs.map(|(p, a)| pose([p[0], p[1], 0.6 * p[2]], [a[0], a[1], 1.0])).collect();
        let place = |p: &[f64; 5]| {
            sample([2.5 * p[0], 2.5 * p[1], 0.5 * p[2]], [0.5 * p[3], 0.5 * p[4], 1.0])
        };
        let samples: Vec<Sample> = points.iter().map(place).collect();
        check(&tool(kind), &through(&poses), &samples, 2000)?;
    }

    /// The axis swings widely about a tip that stands still.
    #[test]
    fn swings_agree_with_many_poses(
        kind in 0u8..7,
        axes in prop::array::uniform2(prop::array::uniform2(-1.0..1.0f64)),
        points in prop::collection::vec(prop::array::uniform5(-1.0..1.0f64), 12)
    ) {
        let at = |a: [f64; 2]| pose([0.0; 3], [a[0], a[1], 1.0]);
        // Around the tool's side as well, with normals towards its axis.
        let place = |p: &[f64; 5]| {
            let (x, y, z) = (6.0 * p[0], 6.0 * p[1], 6.0 + 8.0 * p[2]);
            if p[2] > 0.0 {
                sample([x, y, z], [-x, -y, p[3]])
            } else {
                sample([x, y, 0.5 * p[4]], [p[3], 0.1, 1.0])
            }
        };
        let samples: Vec<Sample> = points.iter().map(place).collect();
        check(&tool(kind), &through(&axes.map(at)), &samples, 3000)?;
    }
}

/// A flat end that turns, its bottom nearly along the sample's line: Newton's steps for the entry went round in a circle,
/// and the height at which they were broken off was no place of the tool.
#[test]
fn steps_that_go_round_in_a_circle() {
    let motion = through(&[
        pose(
            [-1.5652148873294407, -0.3294005312077431, -1.1151799384382867],
            [-0.3718737479337894, -0.10079961349606471, 1.0],
        ),
        pose(
            [0.7321162750199102, -1.4101821427388406, -0.7940869819760365],
            [-0.19501372374950113, 0.14305029590709514, 1.0],
        ),
    ]);
    let s = sample(
        [1.0074857475204944, 1.2861467818645784, -0.34532134543321086],
        [0.3447726448737095, -0.15177725159495606, 0.9263344370393817],
    );
    assert_eq!(check(&flat(5.0), &motion, &[s], 4000).unwrap(), 1);
}

/// The comparison above has something to compare.
#[test]
fn samples_of_the_comparison_are_touched() {
    let samples: Vec<Sample> =
        (0..9).map(|k| sample([0.5 * f64::from(k) - 2.0, 0.3, 0.0], [0.1, 0.0, 1.0])).collect();
    let motions =
        through(&[pose([-1.0, 0.0, 0.2], [0.2, 0.1, 1.0]), pose([1.0, 0.5, -0.3], [-0.2, 0.0, 1.0])]);
    for kind in 0..7 {
        assert!(check(&tool(kind), &motions, &samples, 4000).unwrap() >= 7);
    }
}
