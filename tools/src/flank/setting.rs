//! The settings of a tool against a rule by name, where they touch, and what they are worth.

use super::axis::{AxisJet, AxisLine};
use super::minimax::{MinimaxSearch, minimax};
use super::rule::{Rule, RuleError};
use super::ruled::RuledStrip;
use super::section::{Profile, Stations, profile};
use super::standard::{at_directrix, balanced_fraction, distributed, double_point};
use super::three::three_tangent;
use super::tool::SideTool;
use super::touch::{PlaceError, Touch};

/// How a tool is put against a rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// Along the rule, tangent at directrix 0 or 1: D98's standard setting (a).
    AtDirectrix(usize),
    /// Along the rule, the same deviation at both directrices: D98's standard setting (b).
    Distributed,
    /// Through the points at the fractions t and 1 - t of the rule, offset along the normals; Liu takes 1/4.
    DoublePoint(f64),
    /// The same with the fraction that leaves as much at the ends of the rule as it gouges on the rule: [`balanced_fraction`].
    BalancedDoublePoint,
    /// Tangent to the rule and to both directrices: D98's optimum setting.
    ThreeTangent,
    /// The axis of least greatest static deviation.
    Minimax,
}

/// A tool put against a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The rule's parameter.
    pub u: f64,
    /// The axis; its point lies in the tool's reference section.
    pub axis: AxisLine,
    /// The axis with its exact derivative by u, the setting being kept; None for a static minimax without one, and for a
    /// balanced double point offset, whose fraction changes from rule to rule.
    pub motion: Option<AxisJet>,
    /// Where the tool touches by construction. For the standard settings and the double point offset these are the points of
    /// the rule used, for three tangencies M0, M1 and M2, for the minimax the places of greatest deviation.
    pub touches: Vec<Touch>,
    /// Angle between the rule and the axis or generator, rad, signed as D98's gamma.
    pub turn_rad: f64,
    /// Residual of the equations, mm; 0 where none are solved.
    pub residual_mm: f64,
    /// Steps of the solver.
    pub iterations: u32,
}

/// What a position is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Every contact on the face, no deviation beyond the tolerance.
    Valid,
    /// A contact lies beyond an end of a directrix: u there.
    ContactOutside {
        /// 0 or 1.
        end: usize,
        /// Parameter of the contact.
        u: f64,
    },
    /// A section across the rule is more hollow than the tool.
    DoesNotFit {
        /// The largest radius that fits, mm.
        largest_mm: f64,
    },
    /// The part is cut into by more than the tolerance.
    Gouge {
        /// How deep, mm.
        depth_mm: f64,
    },
    /// More than the tolerance is left, nothing is gouged beyond it.
    Left {
        /// How much, mm.
        height_mm: f64,
    },
}

/// gamma of an axis: about y from the rule to the axis projected into the plane of z and x.
fn turn_rad(rule: &Rule, axis: &AxisLine) -> f64 {
    let f = &rule.frame;
    (-axis.direction.dot(&f.x)).atan2(axis.direction.dot(&f.z))
}

/// The tool at the rule at u in a setting.
///
/// `stations` are of the same strip; [`Setting::ThreeTangent`] and the double point offsets do not use them.
///
/// # Errors
/// [`PlaceError`].
pub fn place(
    strip: &RuledStrip<'_>,
    stations: &Stations,
    u: f64,
    tool: SideTool,
    setting: Setting,
) -> Result<Placed, PlaceError> {
    let rule = strip.rule(u)?;
    let touch = |v: f64| Touch { u, v, point: rule.point(v) };
    let simple = |motion: AxisJet, touches: Vec<Touch>| Placed {
        u,
        axis: motion.line,
        motion: Some(motion),
        touches,
        turn_rad: turn_rad(&rule, &motion.line),
        residual_mm: 0.0,
        iterations: 0,
    };
    match setting {
        Setting::AtDirectrix(end) => {
            let end = end.min(1);
            Ok(simple(at_directrix(&rule, &tool, end)?, vec![touch(end as f64)]))
        }
        Setting::Distributed => {
            Ok(simple(distributed(strip, stations, &rule, &tool)?, vec![touch(0.0), touch(1.0)]))
        }
        Setting::DoublePoint(t) => Ok(simple(double_point(&rule, &tool, t)?, vec![touch(t), touch(1.0 - t)])),
        Setting::BalancedDoublePoint => {
            let t = balanced_fraction(&rule, tool)?;
            let placed = simple(double_point(&rule, &tool, t)?, vec![touch(t), touch(1.0 - t)]);
            Ok(Placed { motion: None, ..placed })
        }
        Setting::ThreeTangent => {
            let root = three_tangent(strip, u, tool)?;
            Ok(Placed {
                u,
                axis: root.axis.line,
                motion: Some(root.axis),
                touches: root.touches(strip, u).to_vec(),
                turn_rad: root.turn_rad,
                residual_mm: root.residual_mm,
                iterations: root.iterations,
            })
        }
        Setting::Minimax => {
            let found = minimax(strip, stations, u, tool, &MinimaxSearch::default())?;
            Ok(Placed {
                u,
                axis: found.axis,
                motion: found.motion,
                touches: found.active,
                turn_rad: turn_rad(&rule, &found.axis),
                residual_mm: found.step_mm,
                iterations: found.iterations,
            })
        }
    }
}

impl Placed {
    /// The static deviation along the rule at `count` samples.
    #[must_use]
    pub fn profile(
        &self,
        strip: &RuledStrip<'_>,
        stations: &Stations,
        tool: &SideTool,
        count: usize,
    ) -> Profile {
        profile(strip, stations, tool, &self.axis, count)
    }

    /// What the position is worth within a tolerance, mm. The first that applies: a contact off the face, a hollow that the
    /// radius does not fit, a gouge, material left.
    ///
    /// # Errors
    /// [`RuleError`] where the rule has no frame.
    pub fn verdict(
        &self,
        strip: &RuledStrip<'_>,
        tool: &SideTool,
        profile: &Profile,
        tolerance_mm: f64,
    ) -> Result<Verdict, RuleError> {
        let range = strip.u_domain();
        if let Some(t) = self.touches.iter().find(|t| !range.contains(t.u)) {
            return Ok(Verdict::ContactOutside { end: usize::from(t.v > 0.5), u: t.u });
        }
        let largest_mm = strip.rule(self.u)?.largest_fit_mm();
        if tool.radius_mm() > largest_mm && tool.is_cylinder() {
            return Ok(Verdict::DoesNotFit { largest_mm });
        }
        if -profile.lowest.deviation_mm > tolerance_mm {
            return Ok(Verdict::Gouge { depth_mm: -profile.lowest.deviation_mm });
        }
        if profile.highest.deviation_mm > tolerance_mm {
            return Ok(Verdict::Left { height_mm: profile.highest.deviation_mm });
        }
        Ok(Verdict::Valid)
    }
}
