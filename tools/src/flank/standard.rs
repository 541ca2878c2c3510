//! Settings along the rule and through two offset points.
//!
//! Standard setting [D98, 1.2]: the generator of the tool lies on the rule; n, perpendicular to z, points from the rule to the
//! axis. (a) n is the normal at one directrix; (b) n is turned about z until the static deviations at both directrices are
//! equal. Double point offset [D98, 4.2, after Liu]: the axis through two points of the rule at the fractions t and 1 - t,
//! each moved by R along the surface's normal there.

use super::axis::AxisJet;
use super::rule::Rule;
use super::ruled::RuledStrip;
use super::section::{Stations, end_deviation};
use super::tool::SideTool;
use super::touch::PlaceError;
use osculate_geom::Vec3;
use osculate_geom::roots::{End, FLAT, bracketed, minimum};

/// The normal n at an angle about z from the frame's y, and its derivative by u when the angle moves.
fn normal(rule: &Rule, angle: f64, angle_rate: f64) -> (Vec3, Vec3) {
    let (f, r) = (&rule.frame, &rule.frame_rate);
    // x is y turned by a right angle against the turn about z, so that -x comes next.
    let (sin, cos) = angle.sin_cos();
    let n = f.y * cos - f.x * sin;
    (n, r.y * cos - r.x * sin - (f.y * sin + f.x * cos) * angle_rate)
}

/// The tool along the rule with its contact normal n at `angle` from y about z; the reference section touches the middle
/// of the rule.
pub(super) fn along_rule(rule: &Rule, tool: &SideTool, angle: f64, angle_rate: f64) -> Option<AxisJet> {
    let (n, n_rate) = normal(rule, angle, angle_rate);
    let (sin, cos) = tool.taper_rad().sin_cos();
    let (z, z_rate) = (rule.frame.z, rule.frame_rate.z);
    let [a, b] = &rule.ends;
    let middle = a.point + (b.point - a.point) * 0.5;
    let to_axis = (n * cos - z * sin) * tool.radius_mm();
    let to_axis_rate = (n_rate * cos - z_rate * sin) * tool.radius_mm();
    AxisJet::of(
        rule.u,
        (middle + to_axis, (a.first + b.first) * 0.5 + to_axis_rate),
        (z * cos + n * sin, z_rate * cos + n_rate * sin),
    )
}

/// Angle of the normal at directrix `end` from y about z, rad, and its derivative by u.
fn end_angle(rule: &Rule, end: usize) -> (f64, f64) {
    let sign = rule.side.sign();
    let n = rule.normals[end].into_inner() * sign;
    let (f, r) = (&rule.frame, &rule.frame_rate);
    let angle = (-f.x.dot(&n)).atan2(f.y.dot(&n));
    // Both unit and perpendicular to z: the difference of their turns about z.
    let turn = |v: &Vec3, rate: &Vec3| f.z.dot(&v.cross(rate));
    (angle, turn(&n, &(rule.normal_rates[end] * sign)) - turn(&f.y, &r.y))
}

/// Setting (a): the normal at directrix `end`.
pub(super) fn at_directrix(rule: &Rule, tool: &SideTool, end: usize) -> Result<AxisJet, PlaceError> {
    let (angle, rate) = end_angle(rule, end);
    along_rule(rule, tool, angle, rate).ok_or(PlaceError::NoAxis { u: rule.u })
}

/// Below this twist, rad, both ends deviate by rounding only, R times its square.
const FLAT_RAD: f64 = 1e-8;
/// Relative accuracy of the angle at which both ends deviate alike: rounding.
const ANGLE_TOLERANCE_RAD: f64 = 1e-15;

/// Setting (b): the same deviation at both directrices.
pub(super) fn distributed(
    strip: &RuledStrip<'_>,
    stations: &Stations,
    rule: &Rule,
    tool: &SideTool,
) -> Result<AxisJet, PlaceError> {
    let none = PlaceError::NoAxis { u: rule.u };
    let ends = [0, 1].map(|end| end_angle(rule, end).0);
    let deviation = |angle: f64, end: usize| -> Option<(f64, f64)> {
        let axis = along_rule(rule, tool, angle, 0.0)?.line;
        let found = end_deviation(strip, stations, tool, &axis, end);
        Some((found.deviation_mm, found.u))
    };
    let difference = |angle: f64| match (deviation(angle, 0), deviation(angle, 1)) {
        (Some(a), Some(b)) => a.0 - b.0,
        _ => f64::NAN,
    };
    if (ends[0] - ends[1]).abs() < FLAT_RAD {
        return along_rule(rule, tool, ends[0], end_angle(rule, 0).1).ok_or(none);
    }
    // At the normal of one end that end deviates least.
    let at = |x: f64| End { x, f: difference(x) };
    let angle = match bracketed(at(ends[0]), at(ends[1]), ANGLE_TOLERANCE_RAD, difference) {
        Ok(root) => root.x,
        // A hollow end deviates even at its own normal; the other bisector is still between.
        Err(_) => {
            let wide = 0.5 * (ends[1] - ends[0]);
            bracketed(at(ends[0] - wide), at(ends[1] + wide), ANGLE_TOLERANCE_RAD, difference)
                .map_err(|_| none.clone())?
                .x
        }
    };
    let (Some(a), Some(b)) = (deviation(angle, 0), deviation(angle, 1)) else { return Err(none) };
    // Both minima over u are stationary or at an end of the strip: only the axis moves them.
    let still = along_rule(rule, tool, angle, 0.0).ok_or(none.clone())?;
    let turned = along_rule(rule, tool, angle, 1.0).ok_or(none.clone())?;
    let points = [strip.directrix(0, a.1).point, strip.directrix(1, b.1).point];
    let rate = |jet: &AxisJet| tool.rate_mm(jet, &points[0]) - tool.rate_mm(jet, &points[1]);
    let (by_u, both) = (rate(&still), rate(&turned));
    let angle_rate = -by_u / (both - by_u);
    along_rule(rule, tool, angle, if angle_rate.is_finite() { angle_rate } else { 0.0 }).ok_or(none)
}

/// The double point offset at the fractions t and 1 - t.
pub(super) fn double_point(rule: &Rule, tool: &SideTool, fraction: f64) -> Result<AxisJet, PlaceError> {
    if !tool.is_cylinder() {
        return Err(PlaceError::CylinderOnly);
    }
    if !(0.0..0.5).contains(&fraction) {
        return Err(PlaceError::Fraction { fraction });
    }
    let none = PlaceError::NoAxis { u: rule.u };
    let [a, b] = &rule.ends;
    let offset = |v: f64| -> Option<(Vec3, Vec3)> {
        let (point, du) = (rule.point(v), rule.du(v));
        let duu = a.second + (b.second - a.second) * v;
        let cross = du.cross(&rule.frame.z) * rule.side.sign();
        let cross_rate = (duu.cross(&rule.frame.z) + du.cross(&rule.frame_rate.z)) * rule.side.sign();
        let length = cross.norm();
        let n = cross / length;
        let n_rate = (cross_rate - n * n.dot(&cross_rate)) / length;
        let r = tool.radius_mm();
        (length > 0.0).then(|| (point.coords + n * r, du + n_rate * r))
    };
    let (Some(p), Some(q)) = (offset(fraction), offset(1.0 - fraction)) else { return Err(none) };
    let (middle, middle_rate) = ((p.0 + q.0) * 0.5, (p.1 + q.1) * 0.5);
    AxisJet::of(rule.u, (middle.into(), middle_rate), (q.0 - p.0, q.1 - p.1)).ok_or(none)
}

/// Liu's fraction of the rule.
const LIU: f64 = 0.25;

/// The fraction t in (0, 1/2) at which the double point offset leaves as much at the ends of the rule as it gouges on the
/// rule: Liu's error, +-0.5860 mm on his surface.
///
/// The deviation is that of the points of the rule itself, as Liu and D98 have it. That of the surface beside the rule
/// ([`profile`](super::profile)) reaches lower.
///
/// A rule without twist is touched all along whatever the fraction: there it is Liu's quarter.
///
/// # Errors
/// [`PlaceError`]; [`PlaceError::NoBalance`] where no fraction balances.
pub fn balanced_fraction(rule: &Rule, tool: SideTool) -> Result<f64, PlaceError> {
    // The difference is smooth in t: a step of 1e-12 of the rule is rounding.
    const TOLERANCE: f64 = 1e-12;
    // R times the square of this twist is below 1e-10 mm for any mill: rounding has no balance.
    const FLAT_RAD: f64 = 1e-6;
    // Both points must stay apart.
    const LAST: f64 = 0.49;
    double_point(rule, &tool, LIU)?;
    if rule.twist_rad().abs() < FLAT_RAD {
        return Ok(LIU);
    }
    let balance = |t: f64| {
        double_point(rule, &tool, t).map_or(f64::NAN, |jet| {
            let on_rule = |v: f64| tool.deviation_mm(&jet.line, &rule.point(v));
            // The distance of two straight lines has one minimum: the ends are highest.
            on_rule(0.0).max(on_rule(1.0)) + minimum([0.0, 1.0], FLAT, on_rule).f
        })
    };
    let at = |x: f64| End { x, f: balance(x) };
    let (first, last) = (at(0.0), at(LAST));
    let root = bracketed(first, last, TOLERANCE, balance);
    root.map(|r| r.x).map_err(|_| PlaceError::NoBalance { u: rule.u, first_mm: first.f, last_mm: last.f })
}
