//! Machine tools: joints as data, checked; forward and inverse kinematics of single poses.

mod body;
mod built_in;
mod chain;
mod error;
mod gaps;
mod numbers;
mod pose;
pub mod spec;
mod two_axis;

use osculate_geom::{Point3, Unit3};
use osculate_tools::Pose;

pub(crate) use body::frames;
pub use body::{Body, Meshes};
pub use built_in::{built_in_names, built_in_text};
pub use chain::{Drive, Joint, JointKind, JointValues, MAX_JOINTS};
use error::FORMAT;
pub use error::MachineError;
pub use gaps::Gap;
pub(crate) use pose::{Beyond, LIMIT_SLACK, NearWish, angle_between, nearest_turn};
pub use pose::{Candidate, Orientations};
use spec::{ControlSpec, MachineSpec};
pub use two_axis::{Angles, AxisUnreachable, Solutions, TwoAxis, TwoAxisError};
pub(crate) use two_axis::{REACH_TOLERANCE_RAD, angle_about};

use crate::setup::Setup;

/// Volume of the box spanned by the linear directions below which they do not span space; a machine's are orthogonal
/// (volume 1), slant beds reach 0.5.
const SMALLEST_VOLUME: f64 = 1e-3;

/// A checked machine tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    name: String,
    description: String,
    joints: Vec<Joint>,
    tool_axis: Unit3,
    control: ControlSpec,
    linear: [usize; 3],
    rotary: Vec<usize>,
    pair: Option<TwoAxis>,
    bodies: Vec<Body>,
}

impl Machine {
    /// A machine from the text of a TOML file.
    ///
    /// ```
    /// use osculate_postproc::{Machine, MachineError, built_in_text};
    ///
    /// // A machine of one's own begins as a copy of a file that comes with the library; here A ends at 30 deg to either side.
    /// let text = built_in_text("trunnion-ac").expect("it comes with the library");
    /// let machine = Machine::from_toml(&text.replace("120", "30"))?;
    /// let a = &machine.joints()[machine.rotary()[1]];
    /// assert!(a.letter == "A" && (a.shown(a.max.expect("it is limited")) - 30.0).abs() < 1e-12);
    /// // Another version of the format is not read.
    /// let other = Machine::from_toml(&text.replace("format = 1", "format = 2"));
    /// assert!(matches!(other, Err(MachineError::Format { got: 2 })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Where the file is malformed or describes no machine, and where a body is a mesh: see [`Self::from_toml_with`].
    pub fn from_toml(text: &str) -> Result<Self, MachineError> {
        Self::from_toml_with(text, &no_meshes)
    }

    /// As [`Self::from_toml`], with a reader of the meshes that bodies are.
    ///
    /// # Errors
    /// As there, and where a mesh cannot be read.
    pub fn from_toml_with(text: &str, meshes: Meshes<'_>) -> Result<Self, MachineError> {
        Self::of_spec(&toml::from_str::<MachineSpec>(text)?, meshes).map_err(|e| numbers::with_line(e, text))
    }

    /// A machine by the name of a file that comes with the library; see [`built_in_names`].
    ///
    /// ```
    /// use osculate_postproc::{Machine, MachineError, built_in_names};
    ///
    /// for name in built_in_names() {
    ///     assert_eq!(Machine::built_in(name)?.name(), name);
    /// }
    /// assert!(matches!(Machine::built_in("hexapod"), Err(MachineError::Unknown { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MachineError::Unknown`] with the names there are.
    pub fn built_in(name: &str) -> Result<Self, MachineError> {
        match built_in_text(name) {
            Some(text) => Self::from_toml(text),
            None => Err(MachineError::Unknown { name: name.into(), known: built_in_names().join(", ") }),
        }
    }

    /// A machine from its plain description.
    ///
    /// # Errors
    /// Where the description is of no machine, or a body is a mesh.
    pub fn from_spec(spec: &MachineSpec) -> Result<Self, MachineError> {
        Self::of_spec(spec, &no_meshes)
    }

    fn of_spec(spec: &MachineSpec, meshes: Meshes<'_>) -> Result<Self, MachineError> {
        if spec.format != FORMAT {
            return Err(MachineError::Format { got: spec.format });
        }
        let tool_axis = numbers::direction("the machine", "tool_axis", spec.tool_axis)?;
        let mut joints = spec.joint.iter().map(numbers::joint).collect::<Result<Vec<_>, _>>()?;
        numbers::check_control(&spec.control)?;
        check_names_and_order(&joints)?;
        let of_kind = |kind| (0..joints.len()).filter(|&i| joints[i].kind == kind).collect::<Vec<_>>();
        let (linear, rotary) = (of_kind(JointKind::Linear), of_kind(JointKind::Rotary));
        let count = MachineError::JointCount { linear: linear.len(), rotary: rotary.len() };
        if rotary.len() > 2 {
            return Err(count);
        }
        let Ok(linear) = <[usize; 3]>::try_from(linear) else { return Err(count) };
        let [x, y, z] = linear.map(|i| joints[i].direction);
        let volume = x.cross(&y).dot(&z);
        if volume.abs() < SMALLEST_VOLUME {
            return Err(MachineError::LinearDependent { volume: volume.abs() });
        }
        // The tool along the slides, with rotary joints at zero: what a control adds to their words as the tool's length.
        let along = [tool_axis.cross(&y).dot(&z), x.cross(&tool_axis).dot(&z), x.cross(&y).dot(&tool_axis)];
        for (place, share) in linear.into_iter().zip(along) {
            joints[place].nose_per_mm = share / volume;
        }
        let pair = match rotary[..] {
            [outer, inner] => {
                Some(TwoAxis::new(joints[outer].direction, joints[inner].direction, tool_axis)?)
            }
            // A single one may lie along the tool: a turntable, which then stays where it is in a posted path.
            _ => None,
        };
        let bodies = body::bodies(&spec.body, &joints, meshes)?;
        Ok(Self {
            name: spec.name.clone(),
            description: spec.description.clone(),
            joints,
            tool_axis,
            control: spec.control.clone(),
            linear,
            rotary,
            pair,
            bodies,
        })
    }

    /// Short name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// One line for people.
    #[must_use]
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The joints, from the part to the tool.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Places of the linear joints in [`Self::joints`].
    #[must_use]
    pub const fn linear(&self) -> [usize; 3] {
        self.linear
    }

    /// Places of the rotary joints in [`Self::joints`], outer (nearest the part) first.
    #[must_use]
    pub fn rotary(&self) -> &[usize] {
        &self.rotary
    }

    /// What is known of the control.
    #[must_use]
    pub const fn control(&self) -> &ControlSpec {
        &self.control
    }

    /// Tool axis at zero.
    #[must_use]
    pub const fn tool_axis(&self) -> Unit3 {
        self.tool_axis
    }

    /// The orientation problem of a machine with two rotary axes.
    #[must_use]
    pub const fn pair(&self) -> Option<&TwoAxis> {
        self.pair.as_ref()
    }

    /// Bodies of head, table and bed.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The joint of this letter.
    #[must_use]
    pub fn joint_named(&self, letter: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.letter == letter)
    }

    /// Where the joint called Z is out of the way, in the control's own coordinate, mm: where the machine file says so, or else the end of
    /// its travel away from the part, which is zero where the file says nothing of the control's zero. None: there is no Z, or a zero
    /// of its own without the end of the travel.
    ///
    /// ```
    /// use osculate_postproc::Machine;
    ///
    /// // Nothing is said of the control's zero: it is the top of Z, where programs retract.
    /// assert_eq!(Machine::built_in("trunnion-ac")?.retract_mm(), Some(0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn retract_mm(&self) -> Option<f64> {
        let z = &self.joints[self.joint_named("Z").filter(|z| self.linear.contains(z))?];
        if z.retract.is_some() || z.machine_zero.is_none() {
            return Some(z.retract.unwrap_or(0.0));
        }
        let end = if z.direction.dot(&self.tool_axis) >= 0.0 { z.max } else { z.min };
        Some(end? - z.own_zero()?)
    }

    /// Forward kinematics: the pose of the tool in the **part's** frame.
    ///
    /// ```
    /// use osculate_geom::{Point3, Vec3};
    /// use osculate_postproc::{Machine, Setup};
    ///
    /// // Joints from the part to the tool: C, A, X, Y, Z. With A at a quarter the part looks along -Y, seen from the tool.
    /// let machine = Machine::built_in("trunnion-ac")?;
    /// let pose = machine.forward(&[0.0, std::f64::consts::FRAC_PI_2, 5.0, 0.0, 0.0], &Setup::default());
    /// assert!((pose.axis.into_inner() - Vec3::new(0.0, -1.0, 0.0)).norm() < 1e-12);
    /// // X lies along the axis of A.
    /// assert!((pose.tip - Point3::new(5.0, 0.0, 0.0)).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn forward(&self, values: &JointValues, setup: &Setup) -> Pose {
        let pose = chain::forward(&self.joints, &self.tool_axis, setup.gauge_length_mm, values);
        setup.to_part(&pose)
    }
}

/// Where nobody reads meshes.
fn no_meshes(file: &str) -> Result<Vec<[Point3; 3]>, String> {
    Err(format!("{file} is a mesh, which this reader of machine files does not open"))
}

/// Letters that mean something else in every dialect.
const RESERVED: &str = "GMNFSTDHOPLRIJKE";

fn check_names_and_order(joints: &[Joint]) -> Result<(), MachineError> {
    let mut head_seen = false;
    for (i, joint) in joints.iter().enumerate() {
        let letter = &joint.letter;
        let mut chars = letter.chars();
        let first = chars.next().is_some_and(|c| c.is_ascii_uppercase() && !RESERVED.contains(c));
        let rest =
            letter.len() <= 4 && letter.chars().skip(1).all(|c| c.is_ascii_uppercase() || c.is_ascii_digit());
        let ends = letter.len() < 2 || letter.ends_with(|c: char| c.is_ascii_digit());
        if !(first && rest && ends) || joints[..i].iter().any(|j| &j.letter == letter) {
            return Err(MachineError::Letter { letter: letter.clone() });
        }
        if joint.side == spec::CarriedSide::Head {
            head_seen = true;
        } else if head_seen {
            return Err(MachineError::Order { letter: letter.clone() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
