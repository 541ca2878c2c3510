//! Where a part must stand for the linear joints to take the tool all along a path.
//!
//! With the rotary joints where an axis has them, the linear joints are affine in the place of the part: each limit of each of them at
//! each pose leaves a half space of places. A place in all of them is found by stepping over the half space that is
//! missed most, again and again, which comes to a place in all of them where there is one with some room.

use crate::machine::Machine;
use crate::setup::Setup;
use osculate_geom::{Point3, Vec3};
use osculate_tools::Pose;

/// Poses that are looked at while a place is sought; all of them are asked in the end.
const MOST_POSES: usize = 10_000;
/// Steps at most.
const MOST_STEPS: usize = 2000;
/// What is kept from limits where there is room, mm: moves between poses bend.
const ROOM_MM: f64 = 0.5;
/// A limit that is missed by less than this is met, mm or rad, as in posting.
const MET: f64 = 1e-9;

/// The linear joints with one stance of the rotary ones.
struct Stance {
    /// Where they are as the part stands, mm, at the spindle nose.
    at_mm: [f64; 3],
    /// How they go with its place.
    ways: [Vec3; 3],
}

/// By how much a joint is out of its range, mm, and the way of the part on which that grows; negative within.
type Missed = (f64, Vec3);

impl Stance {
    fn missed(&self, moved: &Vec3, limits: &[[Option<f64>; 2]; 3], room_mm: f64) -> Missed {
        let mut worst = (f64::NEG_INFINITY, Vec3::zeros());
        for ((at, way), [low, high]) in self.at_mm.iter().zip(&self.ways).zip(limits) {
            let at = at + way.dot(moved);
            for (out, way) in [(high.map(|h| at - h), *way), (low.map(|l| l - at), -*way)] {
                let out = out.map_or(f64::NEG_INFINITY, |out| out + room_mm);
                if out > worst.0 {
                    worst = (out, way);
                }
            }
        }
        worst
    }
}

/// Whether joints of a machine take the tool to a pose of the part of a setup, linear and rotary ones within their limits.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_postproc::{Machine, Setup, in_travel, into_travel};
/// use osculate_tools::Pose;
///
/// // X of this machine ends 3 m from the table's reference point.
/// let machine = Machine::built_in("trunnion-ac")?;
/// let pose = Pose { tip: Point3::new(10.0, 0.0, 0.0), axis: Vec3::z_axis() };
/// assert!(in_travel(&pose, &machine, &Setup::default()));
/// let aside = Setup::at(Vec3::new(5000.0, 0.0, 0.0), 0.0);
/// // At 5 m no turn of C brings the place within 3 m along X and along Y.
/// assert!(!in_travel(&pose, &machine, &aside));
/// let moved = into_travel(&[pose], &machine, &aside).expect("there is room nearer the middle");
/// let nearer = Setup::at(Vec3::new(5000.0, 0.0, 0.0) + moved, 0.0);
/// assert!(in_travel(&pose, &machine, &nearer));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn in_travel(pose: &Pose, machine: &Machine, setup: &Setup) -> bool {
    let pose = setup.to_table(pose);
    rotary(machine, &pose).iter().any(|rotary_rad| {
        let values = machine.with_tip(rotary_rad, &pose.tip, setup.gauge_length_mm);
        values.is_some_and(|values| machine.out_of_limits(&values, setup.gauge_length_mm).is_none())
    })
}

/// The rotary joints within their limits for a pose of the table's frame.
fn rotary(machine: &Machine, pose: &Pose) -> Vec<[f64; 2]> {
    let Ok(found) = machine.orientations(&pose.axis) else { return Vec::new() };
    let within = |mut rotary_rad: [f64; 2]| {
        for (place, q) in machine.rotary().iter().zip(&mut rotary_rad) {
            let joint = machine.joint_at(*place);
            let middle = joint.min.zip(joint.max).map_or(0.0, |(a, b)| 0.5 * (a + b));
            *q = machine.turned_near(*place, *q, middle);
            if joint.excess(*q) > MET {
                return None;
            }
        }
        Some(rotary_rad)
    };
    found.candidates().iter().filter_map(|c| within(c.rotary_rad)).collect()
}

/// The linear joints at a pose, for each stance of the rotary joints within their limits.
fn stances(machine: &Machine, setup: &Setup, pose: &Pose) -> Vec<Stance> {
    let pose = setup.to_table(pose);
    let one = |rotary_rad: &[f64; 2]| {
        let linear = |tip: Point3| {
            let values = machine.with_tip(rotary_rad, &tip, setup.gauge_length_mm)?;
            Some(
                machine
                    .linear()
                    .map(|place| machine.joint_at(place).at_nose(values[place], setup.gauge_length_mm)),
            )
        };
        let at_mm = linear(pose.tip)?;
        let mut ways = [Vec3::zeros(); 3];
        for axis in 0..3 {
            let mut step = Vec3::zeros();
            step[axis] = 1.0;
            let there = linear(pose.tip + step)?;
            for k in 0..3 {
                ways[k][axis] = there[k] - at_mm[k];
            }
        }
        Some(Stance { at_mm, ways })
    };
    rotary(machine, &pose).iter().filter_map(one).collect()
}

/// The limit that is missed most at some poses; None where a pose has no stance at all.
fn most_missed<'a>(
    all: impl Iterator<Item = &'a Vec<Stance>>,
    moved: &Vec3,
    limits: &[[Option<f64>; 2]; 3],
    room_mm: f64,
) -> Missed {
    let mut worst = (f64::NEG_INFINITY, Vec3::zeros());
    for stances in all {
        let missed = stances.iter().map(|s| s.missed(moved, limits, room_mm));
        // The stance that is nearest to its range.
        if let Some(least) = missed.min_by(|a, b| a.0.total_cmp(&b.0))
            && least.0 > worst.0
        {
            worst = least;
        }
    }
    worst
}

/// By how much the part of a setup must be moved on the table, in the table's frame, mm, for the linear joints to be within their limits at all
/// poses that the rotary joints reach: nothing where they are already, None where no such place was found.
#[must_use]
pub fn into_travel(poses: &[Pose], machine: &Machine, setup: &Setup) -> Option<Vec3> {
    let limits = machine.linear().map(|place| {
        let joint = machine.joint_at(place);
        [joint.min, joint.max]
    });
    let fits = |moved: &Vec3| {
        poses.iter().all(|pose| {
            let stances = stances(machine, setup, pose);
            most_missed([stances].iter(), moved, &limits, 0.0).0 <= MET
        })
    };
    let mut moved = Vec3::zeros();
    if fits(&moved) {
        return Some(moved);
    }
    let every = poses.len().div_ceil(MOST_POSES).max(1);
    let all: Vec<Vec<Stance>> =
        poses.iter().step_by(every).map(|pose| stances(machine, setup, pose)).collect();
    for _ in 0..MOST_STEPS {
        let (missed_mm, way) = most_missed(all.iter(), &moved, &limits, ROOM_MM);
        if missed_mm <= MET {
            break;
        }
        moved -= way * ((missed_mm + MET) / way.norm_squared().max(f64::MIN_POSITIVE));
    }
    (moved.iter().all(|x| x.is_finite()) && fits(&moved)).then_some(moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::Unit3;

    /// A tool that looks at a part on a turning centre from all sides.
    fn around(places: &[(f64, f64)]) -> Vec<Pose> {
        let pose = |(tip_x, deg): &(f64, f64)| {
            let (s, c) = deg.to_radians().sin_cos();
            Pose { tip: Point3::new(*tip_x, 0.0, 10.0), axis: Unit3::new_normalize(Vec3::new(c, s, 0.0)) }
        };
        places.iter().map(pose).collect()
    }

    fn reached(poses: &[Pose], machine: &Machine, setup: &Setup) -> bool {
        poses.iter().all(|pose| in_travel(pose, machine, setup))
    }

    #[test]
    fn a_part_is_moved_into_the_travel_of_a_turning_centre() -> Result<(), Box<dyn std::error::Error>> {
        let machine = Machine::built_in("mill-turn-xyzc")?;
        let mut setup = Setup::default();
        // X ends 20 mm behind the axis: from here a tool 40 mm behind it has to wait until the part is moved.
        let poses = around(&[(-40.0, 0.0), (-60.0, 0.0), (-70.0, 90.0), (-65.0, 45.0)]);
        assert!(!reached(&poses, &machine, &setup));
        let moved = into_travel(&poses, &machine, &setup).ok_or("no place")?;
        setup.part_zero.translation.vector += moved;
        assert!(reached(&poses, &machine, &setup), "{moved:?}");
        // Where it stands well it stays.
        assert_eq!(into_travel(&poses, &machine, &setup), Some(Vec3::zeros()));
        // From both sides there is no place for tools that both go 30 mm beyond the middle.
        let both = around(&[(-30.0, 0.0), (30.0, 180.0)]);
        assert_eq!(into_travel(&both, &machine, &setup), None);
        Ok(())
    }

    #[test]
    fn a_table_s_rotary_joints_carry_the_part_along() -> Result<(), Box<dyn std::error::Error>> {
        let machine = Machine::built_in("linuxcnc-xyzac")?;
        let mut setup = Setup::at(Vec3::new(0.0, 350.0, -320.0), 50.0);
        let leant = |y: f64, z: f64| Unit3::new_normalize(Vec3::new(0.2, y, z));
        let poses: Vec<Pose> = [leant(0.0, 1.0), leant(0.6, 1.0), leant(-0.6, 1.0)]
            .iter()
            .map(|axis| Pose { tip: Point3::from(axis.into_inner() * 20.0), axis: *axis })
            .collect();
        assert!(!reached(&poses, &machine, &setup));
        let moved = into_travel(&poses, &machine, &setup).ok_or("no place")?;
        setup.part_zero.translation.vector += moved;
        assert!(reached(&poses, &machine, &setup), "{moved:?}");
        Ok(())
    }
}
