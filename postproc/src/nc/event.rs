//! What a control does, block by block, for those who listen.

use super::state::{FeedReading, Known};
use super::way::Way;
use crate::machine::{JointValues, Machine};
use crate::motion::linuxcnc::PathControl;
use crate::setup::Setup;
use osculate_geom::Unit3;
use osculate_tools::Pose;

/// Machine and setup: what makes poses of places.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<'a> {
    pub machine: &'a Machine,
    pub setup: &'a Setup,
}

impl Frame<'_> {
    /// The tool in the part's frame.
    pub fn pose(&self, known: &Known) -> Pose {
        if !known.tcp {
            let joints = known.joints(self.machine, self.setup).unwrap_or_default();
            return self.machine.forward(&joints, self.setup);
        }
        let axis = known.axis.unwrap_or_else(|| self.machine.axis_at(&known.rotary));
        let back = self.setup.part_zero.rotation.inverse();
        Pose {
            tip: self.setup.from_program(&known.tip()),
            axis: Unit3::new_normalize(back * axis.into_inner()),
        }
    }
}

impl Frame<'_> {
    /// Where the joints themselves stand, slides at the spindle nose.
    pub fn at_nose(&self, known: &Known) -> Option<JointValues> {
        let mut joints = known.joints(self.machine, self.setup)?;
        for (value, joint) in joints.iter_mut().zip(self.machine.joints()) {
            *value = joint.at_nose(*value, self.setup.gauge_length_mm);
        }
        Some(joints)
    }
}

/// F of a move as the control has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FeedNow {
    pub reading: FeedReading,
    /// In the program's units.
    pub value: f64,
    pub unit_mm: f64,
    pub speed_rpm: Option<f64>,
}

/// A move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moved {
    pub line: usize,
    pub way: Way,
    pub from: JointValues,
    pub to: JointValues,
    pub rapid: bool,
    /// Absent in rapid moves.
    pub feed: Option<FeedNow>,
    /// Time by F, min; 0 in rapid moves.
    pub time_min: f64,
    /// Number of the tool in the spindle.
    pub tool: Option<u32>,
    /// To a place of the machine's own frame.
    pub own_frame: bool,
}

/// Something that happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Event<'e> {
    /// Every axis has been named for the first time, or again after a move to a place that is not known.
    Placed { line: usize, known: Known, joints: JointValues, tool: Option<u32> },
    /// A move.
    Moved(&'e Moved),
    /// The machine waits, min.
    Dwell(f64),
    /// G61, G64.
    Path(PathControl),
    /// The machine stands for a moment: tool change, end of the program, a switch of the kinematics.
    Halt,
}

/// Takes what happens.
pub(super) trait Sink {
    fn take(&mut self, frame: Frame<'_>, event: &Event<'_>);
}
