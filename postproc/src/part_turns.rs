//! Turns of a part on the table that come into question for a setup.
//!
//! What a shop can clamp without a wedge are turns that map the axes of the part to axes of the machine, one of six directions of
//! the part up, and from there about the vertical. All others are free turns.

use crate::machine::Machine;
use crate::machine::spec::CarriedSide;
use crate::orienting::Orienting;
use crate::suggest::{stands, turn};
use nalgebra::UnitQuaternion;
use osculate_geom::{Unit3, Vec3};
use osculate_tools::cl::ClPath;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Steps about the vertical, a whole turn in so many: a divider's 15 degrees.
const VERTICAL_STEPS: u32 = 24;

/// Tilts that are tried, degrees, each in so many directions.
const TILTS_DEG: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];
const TILT_DIRECTIONS: u32 = 8;

/// A table's joint this close to the vertical turns about it: the sine is that of rounding.
const VERTICAL_SINE: f64 = 1e-9;

/// The 24 turns of a part that map its own axes to axes of the machine, the best first for faces or tool axes that look in these
/// directions of the part.
///
/// The part as it stands is best where nothing looks further down than [`crate::suggest`] leaves standing. Then come those that have the
/// lowest direction highest; of the four with one direction up the least turned first. A machine of three or four axes has no choice where
/// its tool looks from: there those come first with which the direction furthest from all of its axes is nearest to them.
///
/// ```
/// use osculate_geom::Vec3;
/// use osculate_postproc::{Machine, axis_turns};
///
/// let machine = Machine::built_in("trunnion-ac")?;
/// let turns = axis_turns(&machine, &[-Vec3::z_axis()]);
/// assert_eq!(turns.len(), 24);
/// // The first brings what looks down to look up.
/// assert!(((turns[0] * -Vec3::z_axis()).z - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn axis_turns(machine: &Machine, looks: &[Unit3]) -> Vec<UnitQuaternion<f64>> {
    // How high the lowest one looks; a part that stands well is above all others.
    let height = |up: &Unit3| {
        if *up == Vec3::z_axis() && stands(looks) {
            return f64::INFINITY;
        }
        looks.iter().map(|n| n.dot(up)).fold(1.0, f64::min)
    };
    let mut ups = ups();
    ups.sort_by(|a, b| height(b).total_cmp(&height(a)));
    let quarters = [0.0, FRAC_PI_2, -FRAC_PI_2, PI];
    let turns = ups.iter().flat_map(|up| quarters.map(|angle| about_vertical(angle) * upright(up)));
    let mut turns: Vec<UnitQuaternion<f64>> = turns.collect();
    if machine.rotary().len() < 2 {
        let identity = UnitQuaternion::identity();
        turns.sort_by(|a, b| identity.angle_to(a).total_cmp(&identity.angle_to(b)));
        by_line(machine, looks, &mut turns);
    }
    turns
}

/// Directions that are asked on a machine of three or four axes.
const MOST_LOOKS: usize = 1000;
/// Cosines of the angle to the nearest axis above which a part stands well: of four axes, and of three, where a part stands as it is drawn if the
/// tool sees its faces at all.
const WELL_BY_CIRCLE: f64 = 0.86;
const WELL_BY_ONE: f64 = 0.1;

/// Sorts turns of a part by how near the axes of a machine come to what is furthest from them; all that do well stay as they are.
fn by_line(machine: &Machine, looks: &[Unit3], turns: &mut Vec<UnitQuaternion<f64>>) {
    let well = if machine.rotary().is_empty() { WELL_BY_ONE } else { WELL_BY_CIRCLE };
    let near = |turn: &UnitQuaternion<f64>| {
        let joints = Orienting::new(machine, turn);
        let looks = looks.iter().step_by(looks.len().div_ceil(MOST_LOOKS).max(1));
        looks.map(|n| joints.nearest(n).dot(n)).fold(well, f64::min)
    };
    let mut rated: Vec<(f64, UnitQuaternion<f64>)> = turns.iter().map(|t| (near(t), *t)).collect();
    rated.sort_by(|a, b| b.0.total_cmp(&a.0));
    *turns = rated.into_iter().map(|r| r.1).collect();
}

/// The six directions of a part along its axes, the least turned first when they come up.
fn ups() -> [Unit3; 6] {
    let [x, y, z] = [Vec3::x_axis(), Vec3::y_axis(), Vec3::z_axis()];
    [z, x, -x, y, -y, -z]
}

/// Turns that bring each axis of a part up, and from there by steps of 15 degrees about the vertical. A table whose first joint turns about
/// the vertical without end turns these together, and has only one of them.
///
/// ```
/// use osculate_postproc::{Machine, clamped_turns};
///
/// // Six sides up; where no table turns about the vertical, each in 24 steps of 15 degrees.
/// assert_eq!(clamped_turns(&Machine::built_in("trunnion-ac")?).len(), 6);
/// assert_eq!(clamped_turns(&Machine::built_in("3-axis")?).len(), 6 * 24);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn clamped_turns(machine: &Machine) -> Vec<UnitQuaternion<f64>> {
    let turntable = machine.rotary().first().is_some_and(|&place| {
        let joint = machine.joint_at(place);
        let vertical = joint.direction.cross(&Vec3::z()).norm() < VERTICAL_SINE;
        place == 0 && joint.side == CarriedSide::Table && joint.is_endless() && vertical
    });
    let steps = if turntable { 1 } else { VERTICAL_STEPS };
    let angles = (0..steps).map(|k| TAU * f64::from(k) / f64::from(VERTICAL_STEPS));
    angles.flat_map(|angle_rad| ups().map(|up| about_vertical(angle_rad) * upright(&up))).collect()
}

/// Turns of a part that need not keep its axes along those of the machine: as [`crate::suggest`] has it, with the mean of what looks out
/// along the tool, and tilts of these; on a machine of four axes tilts
/// of the best turn by the part's own axes.
#[must_use]
pub fn free_turns(machine: &Machine, looks: &[Unit3]) -> Vec<UnitQuaternion<f64>> {
    if machine.rotary().len() == 1 {
        let by_axes = axis_turns(machine, looks);
        let best = by_axes.first().copied().unwrap_or_default();
        let mut turns: Vec<UnitQuaternion<f64>> = [best].into_iter().chain(tilts(&best)).collect();
        by_line(machine, looks, &mut turns);
        return turns;
    }
    let suggested = turn(looks);
    let mean: Vec3 = looks.iter().map(|n| n.into_inner()).sum();
    let along_tool = UnitQuaternion::rotation_between(&mean, &machine.tool_axis());
    let first = [Some(suggested), along_tool].into_iter().flatten();
    first.chain(tilts(&suggested)).collect()
}

/// A turned part tilted by some tens of degrees to all sides, the least tilted first.
#[must_use]
pub fn tilts(turned: &UnitQuaternion<f64>) -> Vec<UnitQuaternion<f64>> {
    let tilt = |deg: f64, k: u32| {
        let (s, c) = (TAU * f64::from(k) / f64::from(TILT_DIRECTIONS)).sin_cos();
        UnitQuaternion::from_scaled_axis(Vec3::new(c, s, 0.0) * deg.to_radians())
    };
    TILTS_DEG
        .iter()
        .flat_map(|deg| (0..TILT_DIRECTIONS).map(move |k| tilt(*deg, k)))
        .map(|tilt| tilt * turned)
        .collect()
}

/// The first of some turns of a part with which the rotary joints reach all tool axes of a path within their limits.
///
/// ```
/// use osculate_geom::Vec3;
/// use osculate_postproc::{Machine, axis_turns, cldata, first_in_range};
///
/// let machine = Machine::built_in("3-axis")?;
/// let path = cldata::read("GOTO/0,0,0,1,0,0\nFINI\n")?.path;
/// let turns = axis_turns(&machine, &[]);
/// let turn = first_in_range(&path, &machine, &turns).expect("one of them brings x up");
/// assert!((turn * Vec3::x() - Vec3::z()).norm() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn first_in_range(
    path: &ClPath,
    machine: &Machine,
    turns: &[UnitQuaternion<f64>],
) -> Option<UnitQuaternion<f64>> {
    let axes = axes_of(path);
    turns.par_iter().find_first(|turn| reaches_all(machine, turn, &axes)).copied()
}

/// The tool axes of a path, those that follow on themselves once.
pub(crate) fn axes_of(path: &ClPath) -> Vec<Unit3> {
    let mut axes: Vec<Unit3> = path.moves.iter().map(|m| m.pose.axis).collect();
    axes.dedup();
    axes
}

/// Whether the rotary joints reach all axes of a part that is turned so.
pub(crate) fn reaches_all(machine: &Machine, turned: &UnitQuaternion<f64>, axes: &[Unit3]) -> bool {
    let joints = Orienting::new(machine, turned);
    axes.iter().all(|axis| joints.reaches(axis))
}

fn about_vertical(angle_rad: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vec3::z_axis(), angle_rad)
}

/// The least turn that brings a direction up; straight from below about x.
pub(crate) fn upright(up: &Vec3) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(up, &Vec3::z())
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vec3::x_axis(), PI))
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_tools::Pose;
    use osculate_tools::cl::{ClMove, Motion};

    fn unit(x: f64, y: f64, z: f64) -> Unit3 {
        Unit3::new_normalize(Vec3::new(x, y, z))
    }

    /// Whether every column of the rotation is an axis.
    fn keeps_axes(turn: &UnitQuaternion<f64>) -> bool {
        turn.to_rotation_matrix().matrix().iter().all(|e| (e.abs() * (1.0 - e.abs())).abs() < 1e-12)
    }

    fn distinct(turns: &[UnitQuaternion<f64>]) -> bool {
        (0..turns.len()).all(|i| (0..i).all(|k| turns[i].angle_to(&turns[k]) > 0.1))
    }

    fn path(axes: &[Unit3]) -> ClPath {
        let mut path = ClPath::default();
        for &axis in axes {
            let pose = Pose { tip: osculate_geom::Point3::origin(), axis };
            path.moves.push(ClMove { pose, motion: Motion::Feed(1000.0), aloft: false });
        }
        path
    }

    #[test]
    fn the_turns_of_a_cube() {
        let five = Machine::built_in("trunnion-ac").unwrap();
        let turns = axis_turns(&five, &[]);
        assert_eq!(turns.len(), 24);
        assert!(turns.iter().all(keeps_axes) && distinct(&turns));
        assert_eq!(turns[0], UnitQuaternion::identity());
        // What looks about along +x comes up by a quarter of a turn about y.
        let looks = [unit(1.0, 0.2, 0.1), unit(1.0, -0.3, -0.3)];
        let quarter = UnitQuaternion::from_axis_angle(&Vec3::y_axis(), -FRAC_PI_2);
        assert!(axis_turns(&five, &looks)[0].angle_to(&quarter) < 1e-12);
        // Straight down it is a half turn about one axis too.
        let over = UnitQuaternion::from_axis_angle(&Vec3::x_axis(), PI);
        assert!(axis_turns(&five, &[-Vec3::z_axis()])[0].angle_to(&over) < 1e-12);
    }

    /// A belt of normals about y: a turning centre takes it with y along its spindle, whatever looks up.
    #[test]
    fn a_belt_is_laid_along_the_spindle() {
        let mill_turn = Machine::built_in("mill-turn-xyzc").unwrap();
        let belt: Vec<Unit3> = (0..=16)
            .map(|k| {
                let (s, c) = (f64::from(k) * 0.1).sin_cos();
                unit(c, 0.1, s)
            })
            .collect();
        for turns in [axis_turns(&mill_turn, &belt), free_turns(&mill_turn, &belt)] {
            let y = turns[0] * Vec3::y();
            assert!(y.z.abs() > 1.0 - 1e-12, "{y:?}");
        }
        let stands: Vec<Unit3> = belt.iter().map(|n| unit(n.x, n.z, n.y)).collect();
        assert_eq!(axis_turns(&mill_turn, &stands)[0], UnitQuaternion::identity());
        // Three axes see a slope that is not too steep: a part stays as it is drawn.
        let three = Machine::built_in("3-axis").unwrap();
        assert_eq!(
            axis_turns(&three, &[unit(1.0, 0.0, 0.2), unit(0.0, 0.0, 1.0)])[0],
            UnitQuaternion::identity()
        );
        let aside = axis_turns(&three, &[unit(1.0, 0.0, -0.2), unit(1.0, 0.0, 0.1)])[0] * Vec3::x();
        assert!(aside.z > 1.0 - 1e-12, "{aside:?}");
    }

    #[test]
    fn what_can_be_clamped() {
        // C turns the part about the vertical without end: there it makes no difference.
        assert_eq!(clamped_turns(&Machine::built_in("trunnion-ac").unwrap()).len(), 6);
        let turns = clamped_turns(&Machine::built_in("head-ca").unwrap());
        assert!(turns.len() == 6 * 24 && distinct(&turns));
        let upright = |turn: &UnitQuaternion<f64>| {
            let up = turn.inverse() * Vec3::z();
            (up.amax() - 1.0).abs() < 1e-12
        };
        assert!(turns.iter().all(upright));
        assert!(!tilts(&UnitQuaternion::identity()).iter().any(upright));
    }

    #[test]
    fn the_first_that_is_in_range() {
        let trunnion = Machine::built_in("trunnion-ac").unwrap();
        let looks = [unit(1.0, 0.0, -2.0), unit(1.0, 0.0, 0.3)];
        let turns = axis_turns(&trunnion, &looks);
        let found = first_in_range(&path(&looks), &trunnion, &turns).unwrap();
        assert!(found.angle_to(&turns[0]) < 1e-12);
        // A tool along (1, 1, 1) is nothing for three linear joints by the part's own axes, but for a free turn.
        let three = Machine::built_in("3-axis").unwrap();
        let corner = [unit(1.0, 1.0, 1.0)];
        assert!(first_in_range(&path(&corner), &three, &axis_turns(&three, &corner)).is_none());
        let free = first_in_range(&path(&corner), &three, &free_turns(&three, &corner)).unwrap();
        assert!((free * corner[0].into_inner() - Vec3::z()).norm() < 1e-12);
        // Along x a quarter of a turn will do.
        let side = [Vec3::x_axis()];
        let found = first_in_range(&path(&side), &three, &axis_turns(&three, &side)).unwrap();
        assert!(keeps_axes(&found) && (found * Vec3::x() - Vec3::z()).norm() < 1e-12);
    }
}
