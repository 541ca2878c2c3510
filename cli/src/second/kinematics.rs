//! From joints to the tool: a machine as its description has it, and where its tool stands.
//!
//! Head joints carry the tool, those nearest the bed first; table joints carry the part, the one nearest the part first. The
//! tool is taken through the head into the machine's frame and from there through the table's joints to the part. By ISO 841 a
//! sign speaks of the tool relative to the part, so a table joint at `q` has turned the part by `-q`, and seen from the part the
//! tool turns by `q`. With all joints at zero the tip is at the table's reference point; places of head joints are measured
//! from the gauge point, which lies the gauge length above the tip.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::refusal::NoOpinion;
use super::vector::{V, ahead, angle, cross, dot, norm, sub, turned, unit, usual};

/// Keys of a joint that say nothing of where it goes.
const HARMLESS: [&str; 9] = [
    "min_mm",
    "max_mm",
    "max_velocity_mm_s",
    "max_acceleration_mm_s2",
    "max_jerk_mm_s3",
    "max_velocity_deg_s",
    "max_acceleration_deg_s2",
    "max_jerk_deg_s3",
    "decimals",
];

#[derive(Deserialize)]
struct MachineText {
    format: u32,
    tool_axis: Option<V>,
    #[serde(default)]
    control: ControlText,
    joint: Vec<JointText>,
}

#[derive(Deserialize, Default)]
struct ControlText {
    linuxcnc_tcp: Option<SwitchText>,
}

#[derive(Deserialize)]
struct SwitchText {
    on: String,
    off: String,
}

#[derive(Deserialize)]
struct JointText {
    kind: String,
    letter: String,
    side: String,
    direction: V,
    point_mm: Option<V>,
    sense: Option<String>,
    min_deg: Option<f64>,
    max_deg: Option<f64>,
    #[serde(flatten)]
    others: BTreeMap<String, toml::Value>,
}

/// A joint.
#[derive(Clone, Debug)]
struct Joint {
    letter: String,
    rotary: bool,
    table: bool,
    /// Along or about which the tool goes relative to the part where the value grows.
    direction: V,
    point: V,
    /// Of a rotary joint, rad.
    limits: [f64; 2],
}

/// A machine's joints.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    joints: Vec<Joint>,
    tool_axis: V,
    /// Words that turn LinuxCNC's kinematics on and off.
    pub switch: Option<[String; 2]>,
}

/// Tip and unit axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    pub tip: V,
    pub axis: V,
}

fn wrong<T>(what: impl Into<String>) -> Result<T, NoOpinion> {
    Err(NoOpinion::Machine { what: what.into() })
}

impl Joint {
    fn of(j: JointText) -> Result<Self, NoOpinion> {
        let name = &j.letter;
        if let Some(key) = j.others.keys().find(|k| !HARMLESS.contains(&k.as_str())) {
            return wrong(format!("joint {name}: the key {key} is not known"));
        }
        let rotary = match j.kind.as_str() {
            "rotary" => true,
            "linear" => false,
            kind => return wrong(format!("joint {name}: a kind '{kind}' is not known")),
        };
        let table = match j.side.as_str() {
            "table" => true,
            "head" => false,
            side => return wrong(format!("joint {name}: a side '{side}' is not known")),
        };
        let sign = match j.sense.as_deref() {
            None | Some("iso") => 1.0,
            Some("opposite") => -1.0,
            Some(sense) => return wrong(format!("joint {name}: a sense '{sense}' is not known")),
        };
        let Some(direction) = unit(j.direction) else {
            return wrong(format!("joint {name}: its direction is none"));
        };
        let point = j.point_mm.unwrap_or_default();
        if !point.iter().all(|x| usual(*x)) {
            return wrong(format!("joint {name}: its point is no place"));
        }
        let limits = [
            j.min_deg.map_or(f64::NEG_INFINITY, f64::to_radians),
            j.max_deg.map_or(f64::INFINITY, f64::to_radians),
        ];
        Ok(Self { letter: j.letter, rotary, table, direction: direction.map(|c| c * sign), point, limits })
    }

    fn endless(&self) -> bool {
        self.limits == [f64::NEG_INFINITY, f64::INFINITY]
    }

    /// A point as the joint at value `q` carries it; its distance from the joint's point is noted.
    fn carry(&self, x: V, q: f64, reach: &mut f64) -> V {
        if !self.rotary {
            return ahead(x, q, self.direction);
        }
        let arm = sub(x, self.point);
        *reach = reach.max(norm(arm));
        ahead(self.point, 1.0, turned(arm, self.direction, q))
    }
}

impl Chain {
    /// Reads a machine file.
    pub fn of(text: &str) -> Result<Self, NoOpinion> {
        let machine: MachineText = match toml::from_str(text) {
            Ok(machine) => machine,
            Err(e) => return wrong(e.message()),
        };
        if machine.format != 1 {
            return wrong(format!("format {} is not known", machine.format));
        }
        let Some(tool_axis) = unit(machine.tool_axis.unwrap_or([0.0, 0.0, 1.0])) else {
            return wrong("the tool axis is no direction");
        };
        let joints = machine.joint.into_iter().map(Joint::of).collect::<Result<Vec<_>, _>>()?;
        let count = |rotary: bool| joints.iter().filter(|j| j.rotary == rotary).count();
        if count(false) != 3 || count(true) > 2 {
            return wrong("three linear and at most two rotary joints are known");
        }
        if joints.windows(2).any(|w| !w[0].table && w[1].table) {
            return wrong("a table joint behind a head joint");
        }
        let switch = machine.control.linuxcnc_tcp.map(|s| [s.on, s.off]);
        Ok(Self { joints, tool_axis, switch })
    }

    fn kind(&self, rotary: bool) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(move |j| j.rotary == rotary)
    }

    /// How many rotary joints there are.
    pub fn rotary_count(&self) -> usize {
        self.kind(true).count()
    }

    /// The place of a linear joint among its like.
    pub fn linear_named(&self, letter: &str) -> Option<usize> {
        self.kind(false).position(|j| j.letter == letter)
    }

    /// The place of a rotary joint among its like, and whether it turns without end.
    pub fn rotary_named(&self, letter: &str) -> Option<(usize, bool)> {
        self.kind(true).enumerate().find(|(_, j)| j.letter == letter).map(|(k, j)| (k, j.endless()))
    }

    /// The tool in the table's frame with its joints in chain order, and the greatest distance of the tip from the point of a
    /// rotary joint that carries it.
    pub fn at(&self, linear: &V, rotary: &[f64; 2], gauge_mm: f64) -> (Pose, f64) {
        let (mut slide, mut turn) = (3, self.rotary_count());
        // From the gauge point, with the tool's own axis.
        let (mut tip, mut axis) = (self.tool_axis.map(|c| -gauge_mm * c), self.tool_axis);
        let (mut head, mut reach) = (true, 0.0);
        for joint in self.joints.iter().rev() {
            if joint.table && head {
                tip = ahead(tip, gauge_mm, self.tool_axis);
                head = false;
            }
            let value = if joint.rotary {
                turn -= 1;
                rotary[turn]
            } else {
                slide -= 1;
                linear[slide]
            };
            tip = joint.carry(tip, value, &mut reach);
            if joint.rotary {
                axis = turned(axis, joint.direction, value);
            }
        }
        if head {
            tip = ahead(tip, gauge_mm, self.tool_axis);
        }
        (Pose { tip, axis }, reach)
    }

    /// The tool's axis in the table's frame.
    pub fn axis(&self, rotary: &[f64; 2]) -> V {
        self.at(&[0.0; 3], rotary, 0.0).0.axis
    }

    /// The rotary joints that point the tool along `w` (table's frame) and are nearest to `near`; None where there are none, or
    /// two as near.
    ///
    /// With a before b on the way from the tool: `R(b) R(a) u = w`. The direction between, `v = R(a) u`, has `v.a = u.a` and
    /// `v.b = w.b`, and what is left of its length goes along `a x b`, to one side or the other.
    pub fn pointing(&self, w: V, near: &[f64; 2]) -> Option<[f64; 2]> {
        /// A direction is reached to the rounding of seven decimals.
        const REACHED_RAD: f64 = 1e-6;
        let joints: Vec<&Joint> = self.kind(true).collect();
        let u = self.tool_axis;
        let mut found: Vec<[f64; 2]> = Vec::new();
        match joints[..] {
            [] => found.push([0.0; 2]),
            [only] => found.push([turn_between(only.direction, u, w), 0.0]),
            [outer, inner, ..] => {
                let (a, b) = (inner.direction, outer.direction);
                let (c, ua, wb) = (dot(a, b), dot(u, a), dot(w, b));
                let square = 1.0 - c * c;
                if square < 1e-6 {
                    return None;
                }
                let (x, y) = ((ua - c * wb) / square, (wb - c * ua) / square);
                let rest = (1.0 - x * x - y * y - 2.0 * x * y * c) / square;
                for side in [1.0, -1.0] {
                    let z = side * rest.max(0.0).sqrt();
                    let v = ahead(ahead(a.map(|k| x * k), y, b), z, cross(a, b));
                    // At a pole the outer joint stays.
                    let pole = norm(cross(b, w)) < 1e-12;
                    let beta = if pole { near[0] } else { turn_between(b, v, w) };
                    found.push([beta, turn_between(a, u, v)]);
                }
            }
        }
        let mut best: Option<([f64; 2], f64)> = None;
        let mut alike = false;
        for mut q in found {
            let mut way = 0.0;
            let mut within = angle(self.axis(&q), w) < REACHED_RAD;
            for (k, joint) in joints.iter().enumerate() {
                let whole = std::f64::consts::TAU;
                let start = q[k] + whole * ((near[k] - q[k]) / whole).round();
                let inside = |v: f64| v >= joint.limits[0] - 1e-9 && v <= joint.limits[1] + 1e-9;
                let turns = [start, start - whole, start + whole];
                let nearest = turns
                    .into_iter()
                    .filter(|v| inside(*v))
                    .min_by(|p, r| (p - near[k]).abs().total_cmp(&(r - near[k]).abs()));
                match nearest {
                    Some(v) => q[k] = v,
                    None => within = false,
                }
                way += (q[k] - near[k]).abs();
            }
            if !within {
                continue;
            }
            match best {
                Some((other, least)) if way > least - 1e-6 => {
                    let same = (0..2).all(|k| (other[k] - q[k]).abs() < 1e-6);
                    alike |= way < least + 1e-6 && !same;
                }
                _ => (best, alike) = (Some((q, way)), false),
            }
        }
        best.filter(|_| !alike).map(|b| b.0)
    }
}

/// The angle about `k` by which `from` turns into `to`, seen along `k`.
fn turn_between(k: V, from: V, to: V) -> f64 {
    let flat = |v: V| ahead(v, -dot(v, k), k);
    let (p, q) = (flat(from), flat(to));
    dot(k, cross(p, q)).atan2(dot(p, q))
}
