//! Bodies of a machine: what of its head, table and bed could run into each other or into the part.
//!
//! A body moves with the joint that carries it. Seen from the table, frame `k` is what the first `k` joints of the chain make of it:
//! the joint nearest to the part carries the table itself, frame 0; the bed is behind all joints of the table; what the last joint of the
//! head carries is the spindle.
//!
//! Bodies of the table and of the bed are measured from the table's reference point, those of the head from the gauge point, all joints at zero.

use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use osculate_geom::convex::{Convex, Crowd};
use osculate_geom::{Box3, Point3};

use super::chain::{Joint, JointKind, JointValues, MAX_JOINTS};
use super::error::MachineError;
use super::numbers;
use super::spec::{BodySpec, CarriedSide};

/// The triangles of a mesh of which a machine file names the file.
pub type Meshes<'a> = &'a dyn Fn(&str) -> Result<Vec<[Point3; 3]>, String>;

/// A body of a checked machine.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Whether it is on the side of the tool: the head is, table and bed are not.
    pub of_head: bool,
    /// The frame in which it stands still: so many joints lie between it and the part.
    pub frame: usize,
    /// What it is, in its frame.
    pub shape: Arc<Crowd>,
}

/// Two bodies are the same where their descriptions are.
impl PartialEq for Body {
    fn eq(&self, other: &Self) -> bool {
        let (a, b) = (self, other);
        a.name == b.name
            && a.of_head == b.of_head
            && a.frame == b.frame
            && a.shape.members() == b.shape.members()
    }
}

/// By what a body is carried that moves with no joint.
const BED: &str = "bed";

/// The bodies of a machine file, held against its joints.
pub(super) fn bodies(
    specs: &[BodySpec],
    joints: &[Joint],
    meshes: Meshes<'_>,
) -> Result<Vec<Body>, MachineError> {
    let of_table = joints.iter().take_while(|j| j.side == CarriedSide::Table).count();
    let mut out: Vec<Body> = Vec::with_capacity(specs.len());
    for spec in specs {
        let (name, carrier) = (spec.name(), spec.carried_by());
        if name.trim().is_empty() || out.iter().any(|b| b.name == name) {
            return Err(MachineError::BodyName { name: name.into() });
        }
        let (frame, of_head) = if carrier == BED {
            (of_table, false)
        } else {
            let place =
                joints.iter().position(|j| j.letter == carrier).ok_or_else(|| MachineError::Carrier {
                    body: name.into(),
                    got: carrier.into(),
                    known: joints.iter().map(|j| j.letter.as_str()).collect::<Vec<_>>().join(", "),
                })?;
            if joints[place].side == CarriedSide::Table { (place, false) } else { (place + 1, true) }
        };
        let shape = Crowd::new(members(spec, meshes)?)
            .map_err(|e| MachineError::Body { name: name.into(), why: e.to_string() })?;
        out.push(Body { name: name.into(), of_head, frame, shape: Arc::new(shape) });
    }
    Ok(out)
}

fn members(spec: &BodySpec, meshes: Meshes<'_>) -> Result<Vec<Convex>, MachineError> {
    let wrong = |why: String| MachineError::Body { name: spec.name().into(), why };
    let whose = format!("body {}", spec.name());
    match spec {
        BodySpec::Box { min_mm, max_mm, .. } => {
            for c in min_mm.iter().chain(max_mm) {
                numbers::place(&whose, "min_mm or max_mm", *c)?;
            }
            if !(0..3).all(|k| min_mm[k] < max_mm[k]) {
                return Err(wrong("min_mm must be below max_mm in x, y and z".into()));
            }
            Ok(vec![Convex::cuboid(&Box3 { min: Point3::from(*min_mm), max: Point3::from(*max_mm) })])
        }
        BodySpec::Cylinder { from_mm, to_mm, diameter_mm, to_diameter_mm, .. } => {
            for c in from_mm.iter().chain(to_mm) {
                numbers::place(&whose, "from_mm or to_mm", *c)?;
            }
            let upper = to_diameter_mm.unwrap_or(*diameter_mm);
            for (what, diameter) in [("diameter_mm", *diameter_mm), ("to_diameter_mm", upper)] {
                numbers::size(&whose, what, diameter)?;
            }
            let ends = [Point3::from(*from_mm), Point3::from(*to_mm)];
            if ends[0] == ends[1] {
                return Err(wrong("from_mm and to_mm are the same place".into()));
            }
            Ok(vec![Convex::Frustum { ends, radii_mm: [0.5 * diameter_mm, 0.5 * upper] }])
        }
        BodySpec::Mesh { file, .. } => {
            let triangles = meshes(file).map_err(wrong)?;
            Ok(triangles.into_iter().map(Convex::Triangle).collect())
        }
    }
}

/// The frames of a chain, from the table outwards, with the joints where they themselves are (slides at the spindle nose): the first is the
/// table's, the last the spindle's.
pub(crate) fn frames(joints: &[Joint], at_nose: &JointValues) -> [Isometry3<f64>; MAX_JOINTS + 1] {
    let mut frames = [Isometry3::identity(); MAX_JOINTS + 1];
    for (k, (joint, value)) in joints.iter().zip(at_nose).enumerate() {
        let step = match joint.kind {
            JointKind::Linear => Isometry3::from(joint.direction.into_inner() * *value),
            JointKind::Rotary => {
                let turn = UnitQuaternion::from_axis_angle(&joint.direction, *value);
                let centre = joint.point.coords;
                Isometry3::from_parts(Translation3::from(centre - turn * centre), turn)
            }
        };
        frames[k + 1] = frames[k] * step;
    }
    frames
}
