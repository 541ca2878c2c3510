//! The numbers of a machine file: what a machine can have, and on which line another one stands.
//!
//! Bounds are far outside of what machines have, and near enough that no time or place computed from what lies within them loses its
//! meaning: an axis that creeps at 0.06 mm/min or runs at a thousand metres a second is a slip of the pen or a damaged file.

use std::ops::RangeInclusive;

use osculate_geom::{Point3, Unit3, Vec3};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::chain::{Drive, Joint, JointKind};
use super::error::MachineError;
use super::spec::{ControlSpec, FeedReading, JointSpec, Sense};

/// Speeds, mm/s and deg/s: the slowest feed axes creep at a tenth of a mm/min, the fastest linear motors reach 1e4 mm/s.
const SPEEDS: RangeInclusive<f64> = 1e-3..=1e6;
/// Accelerations, mm/s^2 and deg/s^2: gravity is 1e4, and what reaches the slowest speed within ten seconds has 1e-4.
const ACCELERATIONS: RangeInclusive<f64> = 1e-3..=1e9;
/// Jerks, mm/s^3 and deg/s^3: machines have 1e3 to 1e6; what is meant to be none is often written as a large number.
const JERKS: RangeInclusive<f64> = 1e-2..=1e12;
/// Largest F of a control, mm/min: feeds of CL data end there too.
const FEEDS: RangeInclusive<f64> = 1.0..=1e9;
/// Radii for which a degree counts, mm.
const RADII: RangeInclusive<f64> = 1e-3..=1e6;
/// Places and limits, mm and deg: a thousand kilometres, beyond which double precision has no micrometre left.
const FAR: RangeInclusive<f64> = -1e9..=1e9;

/// Sizes of bodies, mm: a hundredth of a hair to a kilometre.
const SIZES: RangeInclusive<f64> = 1e-3..=1e6;

fn value(whose: &str, what: &'static str, value: f64, wanted: &str) -> MachineError {
    MachineError::Value { line: None, whose: whose.into(), what, value, wanted: wanted.into() }
}

/// A direction of a machine.
pub(super) fn direction(whose: &str, what: &'static str, d: [f64; 3]) -> Result<Unit3, MachineError> {
    let v = Vec3::from(d);
    // The square must not underflow; anything a person writes is far above.
    Unit3::try_new(v, 1e-9)
        .filter(|u| u.iter().all(|c| c.is_finite()))
        .ok_or_else(|| value(whose, what, v.norm(), "a finite direction that is not zero"))
}

/// A number between bounds; what is not finite lies in none.
fn within(
    whose: &str,
    what: &'static str,
    x: f64,
    bounds: &RangeInclusive<f64>,
) -> Result<f64, MachineError> {
    if bounds.contains(&x) {
        return Ok(x);
    }
    Err(value(whose, what, x, &format!("a number from {:e} to {:e} is wanted", bounds.start(), bounds.end())))
}

/// A coordinate of a place.
pub(super) fn place(whose: &str, what: &'static str, x: f64) -> Result<f64, MachineError> {
    within(whose, what, x, &FAR)
}

/// A size of a body.
pub(super) fn size(whose: &str, what: &'static str, x: f64) -> Result<f64, MachineError> {
    within(whose, what, x, &SIZES)
}

fn limits(
    whose: &str,
    [least, most]: [&'static str; 2],
    min: Option<f64>,
    max: Option<f64>,
) -> Result<(), MachineError> {
    for (what, limit) in [(least, min), (most, max)] {
        limit.map_or(Ok(0.0), |x| within(whose, what, x, &FAR))?;
    }
    match (min, max) {
        (Some(a), Some(b)) if a >= b => {
            Err(value(whose, least, a, &format!("it must be smaller than {most}, which is {b:?}")))
        }
        _ => Ok(()),
    }
}

/// A joint of what a machine file says of it.
pub(super) fn joint(spec: &JointSpec) -> Result<Joint, MachineError> {
    let (letter, side, dir, sense, kind) = match spec {
        JointSpec::Linear { letter, side, direction, sense, .. } => {
            (letter, *side, *direction, *sense, JointKind::Linear)
        }
        JointSpec::Rotary { letter, side, direction, sense, .. } => {
            (letter, *side, *direction, *sense, JointKind::Rotary)
        }
    };
    let whose = format!("joint {letter}");
    let dir = direction(&whose, "direction", dir)?;
    let direction = if sense == Sense::Iso { dir } else { -dir };
    let (point, [min, max], [v, a], j, keys, to) = match *spec {
        JointSpec::Linear {
            min_mm,
            max_mm,
            max_velocity_mm_s,
            max_acceleration_mm_s2,
            max_jerk_mm_s3,
            ..
        } => (
            [0.0; 3],
            [min_mm, max_mm],
            [max_velocity_mm_s, max_acceleration_mm_s2],
            max_jerk_mm_s3,
            ["min_mm", "max_mm", "max_velocity_mm_s", "max_acceleration_mm_s2", "max_jerk_mm_s3"],
            1.0,
        ),
        JointSpec::Rotary {
            point_mm,
            min_deg,
            max_deg,
            max_velocity_deg_s,
            max_acceleration_deg_s2,
            max_jerk_deg_s3,
            ..
        } => (
            point_mm,
            [min_deg, max_deg],
            [max_velocity_deg_s, max_acceleration_deg_s2],
            max_jerk_deg_s3,
            ["min_deg", "max_deg", "max_velocity_deg_s", "max_acceleration_deg_s2", "max_jerk_deg_s3"],
            1f64.to_radians(),
        ),
    };
    let decimals = match *spec {
        JointSpec::Linear { decimals, .. } | JointSpec::Rotary { decimals, .. } => decimals,
    };
    // Without a decimal some controls read a number in their smallest unit.
    if !(1..=4).contains(&decimals) {
        return Err(value(&whose, "decimals", f64::from(decimals), "from 1 to 4"));
    }
    let [least, most, velocity, acceleration, jerk] = keys;
    limits(&whose, [least, most], min, max)?;
    for c in point {
        within(&whose, "point_mm", c, &FAR)?;
    }
    let (machine_zero, home, retract) = match *spec {
        JointSpec::Linear { machine_zero_mm, home_mm, retract_mm, .. } => {
            (machine_zero_mm, home_mm, retract_mm)
        }
        JointSpec::Rotary { .. } => (None, None, None),
    };
    for (what, place) in [("machine_zero_mm", machine_zero), ("home_mm", home), ("retract_mm", retract)] {
        place.map_or(Ok(0.0), |x| within(&whose, what, x, &FAR))?;
    }
    Ok(Joint {
        letter: letter.clone(),
        kind,
        decimals: usize::from(decimals),
        side,
        direction,
        point: Point3::from(point),
        nose_per_mm: 0.0,
        min: min.map(|m| m * to),
        max: max.map(|m| m * to),
        machine_zero,
        home,
        retract,
        drive: Drive {
            velocity_per_s: within(&whose, velocity, v, &SPEEDS)? * to,
            acceleration_per_s2: within(&whose, acceleration, a, &ACCELERATIONS)? * to,
            jerk_per_s3: j.map(|j| within(&whose, jerk, j, &JERKS)).transpose()?.map(|j| j * to),
        },
    })
}

/// The numbers of a control.
pub(super) fn check_control(control: &ControlSpec) -> Result<(), MachineError> {
    within(CONTROL, "largest_feed", control.largest_feed, &FEEDS)?;
    if let Some(v) = control.max_path_velocity_mm_s {
        within(CONTROL, "max_path_velocity_mm_s", v, &SPEEDS)?;
    }
    if let FeedReading::Arc { radius_mm } = control.feed_reading {
        within(CONTROL, "feed_reading.radius_mm", radius_mm, &RADII)?;
    }
    Ok(())
}

/// Whose the numbers of a control are.
const CONTROL: &str = "the control";

/// The same with the line of the file on which its number stands.
pub(super) fn with_line(e: MachineError, text: &str) -> MachineError {
    match e {
        MachineError::Value { line: None, whose, what, value, wanted } => {
            let line = line_of(text, &whose, what);
            MachineError::Value { line, whose, what, value, wanted }
        }
        e => e,
    }
}

/// The line of a key of a joint, of a body, of the control or of the machine itself.
fn line_of(text: &str, whose: &str, what: &str) -> Option<usize> {
    let top = DeTable::parse(text).ok()?;
    let mut table = top.get_ref();
    let listed = [("joint", "letter"), ("body", "name")]
        .into_iter()
        .find_map(|(list, key)| Some((list, key, whose.strip_prefix(list)?.strip_prefix(' ')?)));
    if let Some((list, key, called)) = listed {
        let tables = table.get(list)?.get_ref().as_array()?;
        let is = |t: &DeTable<'_>| t.get(key).map(Spanned::get_ref).and_then(DeValue::as_str) == Some(called);
        table = tables.iter().filter_map(|t| t.get_ref().as_table()).find(|t| is(t))?;
    } else if whose == CONTROL {
        table = table.get("control")?.get_ref().as_table()?;
    }
    let (outer, inner) = what.split_once('.').map_or((what, None), |(o, i)| (o, Some(i)));
    let at = match (table.get(outer)?, inner) {
        (t, Some(inner)) => t.get_ref().as_table()?.get(inner)?.span().start,
        (v, None) => v.span().start,
    };
    Some(1 + text.bytes().take(at).filter(|b| *b == b'\n').count())
}
