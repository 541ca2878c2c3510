//! What a program comes to: straight moves between places of which everything is known.

use super::kinematics::{Chain, Pose};
use super::refusal::NoOpinion;
use super::setup::Stand;
use super::vector::{V, between, norm, on_circle, sub, unit};

/// A control's language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    Sinumerik,
    Heidenhain,
    Fanuc,
    LinuxCnc,
}

impl Dialect {
    pub fn of(name: &str) -> Result<Self, NoOpinion> {
        match name {
            "sinumerik" => Ok(Self::Sinumerik),
            "heidenhain" => Ok(Self::Heidenhain),
            "fanuc" => Ok(Self::Fanuc),
            "linuxcnc" => Ok(Self::LinuxCnc),
            _ => Err(NoOpinion::Dialect { name: name.into() }),
        }
    }
}

/// What goes evenly from one place to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// All joints.
    Joints,
    /// The tip, and the rotary joints.
    Tip,
    /// The tip, and the tool's direction on a great circle.
    Circle,
}

/// A place of which everything is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Linear joints in chain order, or the tip in the table's frame; mm.
    pub linear: V,
    /// Rotary joints, rad.
    pub rotary: [f64; 2],
    /// The tool's direction in the table's frame.
    pub axis: V,
}

/// A straight move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Move {
    pub line: usize,
    pub rapid: bool,
    pub way: Way,
    pub from: Place,
    pub to: Place,
}

/// How far the tool may leave the chord between two poses of a move: the second derivative of a place of the tool by the share
/// of the move, of the tip and per mm above it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bend {
    pub tip: f64,
    pub per_mm: f64,
}

/// Machine and setup.
#[derive(Clone, Debug)]
pub(super) struct Shop {
    pub chain: Chain,
    pub stand: Stand,
}

impl Move {
    /// The tool at a share of the move, in the part's frame.
    pub fn pose(&self, shop: &Shop, t: f64) -> Pose {
        let (chain, stand) = (&shop.chain, &shop.stand);
        let linear = between(self.from.linear, self.to.linear, t);
        let rotary = [0, 1].map(|k| self.from.rotary[k] + t * (self.to.rotary[k] - self.from.rotary[k]));
        let table = match self.way {
            Way::Joints => chain.at(&linear, &rotary, stand.gauge_mm).0,
            Way::Tip => Pose { tip: linear, axis: chain.axis(&rotary) },
            Way::Circle => Pose { tip: linear, axis: on_circle(self.from.axis, self.to.axis, t) },
        };
        // Turns of unit vectors stay so to rounding, which a part of some metres does not see.
        let axis = stand.direction(table.axis);
        Pose { tip: stand.point(table.tip), axis: unit(axis).unwrap_or(axis) }
    }

    /// Bounds on second derivatives over the move.
    ///
    /// A point that is carried by rotary joints whose angles change by W in all, at most `rho` from their axes, and moved by V
    /// along the linear ones, is accelerated by `W^2 rho + 2 W V` at most.
    pub fn bend(&self, shop: &Shop) -> Bend {
        let turned: f64 = (0..2).map(|k| (self.to.rotary[k] - self.from.rotary[k]).abs()).sum();
        let straight = norm(sub(self.to.linear, self.from.linear));
        match self.way {
            Way::Tip => Bend { tip: 0.0, per_mm: turned * turned },
            Way::Circle => {
                // The angle is at most pi / 2 times the chord.
                let chord = norm(sub(self.to.axis, self.from.axis));
                Bend { tip: 0.0, per_mm: (std::f64::consts::FRAC_PI_2 * chord).powi(2) }
            }
            Way::Joints => {
                let reach = |p: &Place| shop.chain.at(&p.linear, &p.rotary, shop.stand.gauge_mm).1;
                let ends = reach(&self.from).max(reach(&self.to));
                // In between the distance rho from an axis grows by what joints nearer the tool move: from the nearer end by
                // less than (V + W rho) / 2, and by no more than 2 rho of an axis however far that turns.
                let rho = if turned < 0.5 { 4.0 / 3.0 * (ends + straight) } else { 3.0 * (ends + straight) };
                Bend { tip: turned * (turned * rho + 2.0 * straight), per_mm: turned * turned }
            }
        }
    }
}

/// The moves of a program.
#[derive(Clone, Debug, Default)]
pub(super) struct Path {
    pub moves: Vec<Move>,
    /// Rapids from or to places that are not known.
    pub unseen_rapids: usize,
}
