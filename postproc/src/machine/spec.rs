//! Machine files: what a user writes down about a machine tool.
//!
//! Joints stand in the order in which one meets them on the way **from the part to the tool**: first those that carry
//! the part (`side = "table"`, the one nearest the part first), then those that carry the tool (`side = "head"`, the
//! one nearest the bed first). Every joint has a direction in the machine's axes with all joints at zero.
//!
//! Sense: `"iso"` is ISO 841, where the sign of a joint speaks of the **tool relative to the part**. A table joint
//! with a positive value therefore turns the part left-handed about its direction. `"opposite"` is the other way
//! round, as LinuxCNC's table kinematics count. Linear joints are nearly always `"iso"`.
//!
//! Places: a table joint's `point_mm` is measured from the table's reference point, a head joint's from the gauge
//! point (the spindle nose on the tool axis), both with all joints at zero. Limits of linear joints are measured
//! from where the spindle nose touches the table's reference point; so is the zero of the control's own coordinates.

use serde::{Deserialize, Serialize};

/// Which body a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum CarriedSide {
    /// The joint moves the part.
    Table,
    /// The joint moves the tool.
    Head,
}

/// How the sign of a joint is to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Sense {
    /// Positive moves the tool, relative to the part, along or right-handed about the direction.
    #[default]
    Iso,
    /// The opposite of ISO.
    Opposite,
}

/// One joint of a machine file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
#[non_exhaustive]
pub enum JointSpec {
    /// A slide.
    Linear {
        /// Name of the axis in NC programs.
        letter: String,
        /// What it carries.
        side: CarriedSide,
        /// Direction in the machine's axes.
        direction: [f64; 3],
        /// How its sign is read.
        #[serde(default)]
        sense: Sense,
        /// Smallest value at the spindle nose, as a control counts its travel: a program's word for the tip is short of it by the
        /// gauge length along the tool. Absent: no limit.
        min_mm: Option<f64>,
        /// Largest value at the spindle nose; absent: no limit.
        max_mm: Option<f64>,
        /// Its value at the spindle nose where the control's own coordinate of it (`G53`, `SUPA`, `M91`) reads zero. Absent: the upper limit
        /// of a joint called Z, whose zero is the top of its travel, and zero of any other.
        #[serde(default)]
        machine_zero_mm: Option<f64>,
        /// Where `G28` leads it, in the control's own coordinate; absent: not known.
        #[serde(default)]
        home_mm: Option<f64>,
        /// Where it is out of the way, in the control's own coordinate: programs retract there before tools and planes are changed
        /// and at their end. Read of the joint called Z only. Absent: the end of its travel away from the part.
        #[serde(default)]
        retract_mm: Option<f64>,
        /// Greatest speed.
        max_velocity_mm_s: f64,
        /// Greatest acceleration.
        max_acceleration_mm_s2: f64,
        /// Greatest jerk; absent: acceleration may step.
        max_jerk_mm_s3: Option<f64>,
        /// Decimals of its positions in NC programs, 1 to 4.
        #[serde(default = "default_decimals")]
        decimals: u8,
    },
    /// A rotary axis.
    Rotary {
        /// Name of the axis in NC programs.
        letter: String,
        /// What it carries.
        side: CarriedSide,
        /// Direction of the axis of rotation.
        direction: [f64; 3],
        /// A point on the axis of rotation.
        #[serde(default)]
        point_mm: [f64; 3],
        /// How its sign is read.
        #[serde(default)]
        sense: Sense,
        /// Smallest value; absent: it turns without end.
        min_deg: Option<f64>,
        /// Largest value; absent: it turns without end.
        max_deg: Option<f64>,
        /// Greatest speed.
        max_velocity_deg_s: f64,
        /// Greatest acceleration.
        max_acceleration_deg_s2: f64,
        /// Greatest jerk; absent: acceleration may step.
        max_jerk_deg_s3: Option<f64>,
        /// Decimals of its positions in NC programs, 1 to 4.
        #[serde(default = "default_decimals")]
        decimals: u8,
    },
}

/// How the control reads F in G94 where linear and rotary axes move together and the program does not say. LinuxCNC reads it over the
/// linear axes whatever stands here.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum FeedReading {
    /// Over the linear axes; a move of rotary axes alone is read in degrees.
    Linear,
    /// Over all axes, a rotary axis counting as an arc of this radius. `180 / pi` makes a degree count as 1 mm.
    Arc {
        /// The radius.
        radius_mm: f64,
    },
    /// Over the rotary axes in degrees; a move of linear axes alone is read in mm.
    RotaryOnly,
}

/// The words by which a program turns the control's tool-centre-point kinematics on and off.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct TcpWords {
    /// On, for example `M428`.
    pub on: String,
    /// Off, for example `M429`.
    pub off: String,
}

/// What the machine's control does that no dialect fixes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlSpec {
    /// How F is read.
    pub feed_reading: FeedReading,
    /// Largest F that the control's format takes, in mm/min or 1/min.
    #[serde(default = "default_largest_feed")]
    pub largest_feed: f64,
    /// Greatest speed of the tool along the path, whatever the joints can do; absent: no such limit.
    #[serde(default)]
    pub max_path_velocity_mm_s: Option<f64>,
    /// LinuxCNC's kinematics switch, where this machine has one.
    pub linuxcnc_tcp: Option<TcpWords>,
}

/// A tenth of a micrometre, or of a thousandth of a degree.
const fn default_decimals() -> u8 {
    4
}

/// Five digits before the point, which every control of the last decades takes.
const fn default_largest_feed() -> f64 {
    99_999.0
}

/// A body of the machine that could run into something: a piece of its head, its table or its bed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
#[non_exhaustive]
pub enum BodySpec {
    /// A box along the machine's axes, all joints at zero.
    Box {
        /// Its name in messages.
        name: String,
        /// The letter of the joint that it moves with, or `"bed"`.
        carried_by: String,
        /// The corner where x, y and z are least; from the table's reference point, or on the head from the gauge point.
        min_mm: [f64; 3],
        /// The opposite corner.
        max_mm: [f64; 3],
    },
    /// A cylinder or a cone.
    Cylinder {
        /// Its name in messages.
        name: String,
        /// The letter of the joint that it moves with, or `"bed"`.
        carried_by: String,
        /// The centre of one end.
        from_mm: [f64; 3],
        /// The centre of the other.
        to_mm: [f64; 3],
        /// The diameter, of a cone that at `from_mm`.
        diameter_mm: f64,
        /// Of a cone the diameter at `to_mm`.
        #[serde(default)]
        to_diameter_mm: Option<f64>,
    },
    /// Triangles of an STL, PLY or 3MF file, mm.
    Mesh {
        /// Its name in messages.
        name: String,
        /// The letter of the joint that it moves with, or `"bed"`.
        carried_by: String,
        /// The file, seen from the machine file.
        file: String,
    },
}

impl BodySpec {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Box { name, .. } | Self::Cylinder { name, .. } | Self::Mesh { name, .. } => name,
        }
    }

    /// What carries it.
    #[must_use]
    pub fn carried_by(&self) -> &str {
        match self {
            Self::Box { carried_by, .. }
            | Self::Cylinder { carried_by, .. }
            | Self::Mesh { carried_by, .. } => carried_by,
        }
    }
}

/// A machine file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineSpec {
    /// Version of the format: 1.
    pub format: u32,
    /// Short name.
    pub name: String,
    /// One line for people.
    #[serde(default)]
    pub description: String,
    /// From the tip to the spindle with all joints at zero.
    #[serde(default = "default_tool_axis")]
    pub tool_axis: [f64; 3],
    /// The control.
    pub control: ControlSpec,
    /// The joints, from the part to the tool.
    pub joint: Vec<JointSpec>,
    /// Its bodies; none: what head and table run into is not judged.
    #[serde(default)]
    pub body: Vec<BodySpec>,
}

const fn default_tool_axis() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}
