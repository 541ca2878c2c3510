//! A machine file of the project as LinuxCNC's INI file: the same travels, speeds and accelerations, joint by joint.
//!
//! The control's zero of Z is the top of its travel, as in the machine file; the table's reference point, about which the
//! kinematics turn, is that much lower. Joints are X Y Z A C.

use crate::cmd::Failure;
use std::fmt::Write;
use std::path::Path;

/// Letters of the joints in the control's order.
pub const LETTERS: [&str; 5] = ["X", "Y", "Z", "A", "C"];

/// One joint, mm or deg and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    pub velocity: f64,
    pub acceleration: f64,
    pub jerk: f64,
    /// None: without end.
    pub travel: Option<[f64; 2]>,
}

/// What of a machine file the control is to know.
#[derive(Clone, Debug, PartialEq)]
pub struct Drives {
    /// In the order of [`LETTERS`].
    pub joints: [Joint; 5],
    /// Greatest speed along the path, mm/s.
    pub path_velocity_mm_s: f64,
}

/// The number of a key among lines, whatever its unit.
fn number(lines: &[&str], key: &str) -> Option<f64> {
    lines.iter().find_map(|l| {
        let (name, value) = l.split_once('=')?;
        let rest = name.trim().strip_prefix(key)?;
        let unit = rest.is_empty() || rest.starts_with("_mm") || rest.starts_with("_deg");
        unit.then(|| value.trim().parse().ok())?
    })
}

impl Drives {
    /// Reads the keys that `xtask/control` uses.
    ///
    /// # Errors
    /// Where a joint or a key is missing.
    pub fn of(text: &str, path: &Path) -> Result<Self, Failure> {
        let lacks = |what: &str| Failure::Source { path: path.to_path_buf(), why: format!("no {what}") };
        let sections: Vec<Vec<&str>> = text.split("[[joint]]").map(|s| s.lines().collect()).collect();
        let joint = |letter: &str| {
            let is = |s: &&Vec<&str>| s.iter().any(|l| *l == format!("letter = \"{letter}\""));
            let lines = sections.iter().find(is).ok_or_else(|| lacks(&format!("joint {letter}")))?;
            let get = |key: &str| number(lines, key).ok_or_else(|| lacks(&format!("{key} of {letter}")));
            Ok::<_, Failure>(Joint {
                velocity: get("max_velocity")?,
                acceleration: get("max_acceleration")?,
                jerk: get("max_jerk")?,
                travel: number(lines, "min").zip(number(lines, "max")).map(|(a, b)| [a, b]),
            })
        };
        Ok(Self {
            joints: [joint("X")?, joint("Y")?, joint("Z")?, joint("A")?, joint("C")?],
            path_velocity_mm_s: number(&sections[0], "max_path_velocity")
                .ok_or_else(|| lacks("max_path_velocity_mm_s"))?,
        })
    }

    /// How high the control's zero of Z is above the table's reference point, mm.
    pub fn top_mm(&self) -> f64 {
        self.joints[2].travel.map_or(0.0, |t| t[1])
    }

    /// The INI file.
    pub fn ini(&self) -> String {
        let mut out = format!(
            "{HEAD}[MACHINE]\nTABLE_Z = {}\n[TRAJ]\nCOORDINATES = XYZAC\nLINEAR_UNITS = mm\nANGULAR_UNITS = deg\n\
             MAX_LINEAR_VELOCITY = {}\n",
            -self.top_mm(),
            self.path_velocity_mm_s
        );
        for (k, (letter, joint)) in LETTERS.iter().zip(&self.joints).enumerate() {
            let zero = if *letter == "Z" { self.top_mm() } else { 0.0 };
            let mut limits =
                format!("MAX_VELOCITY = {}\nMAX_ACCELERATION = {}\n", joint.velocity, joint.acceleration);
            if let Some([low, high]) = joint.travel {
                let _ = write!(limits, "MIN_LIMIT = {}\nMAX_LIMIT = {}\n", low - zero, high - zero);
            }
            let kind = if k < 3 { "LINEAR" } else { "ANGULAR" };
            let _ = write!(
                out,
                "[AXIS_{letter}]\n{limits}[JOINT_{k}]\nTYPE = {kind}\nHOME = 0\nHOME_SEARCH_VEL = 0\nHOME_SEQUENCE = 0\n{limits}"
            );
        }
        out
    }
}

/// What is the same for every machine. The task's cycle is short, as the clock may run quicker than it.
const HEAD: &str = "[EMC]\nVERSION = 1.1\nMACHINE = control\n[DISPLAY]\nDISPLAY = ./ui\n\
    [RS274NGC]\nSUBROUTINE_PATH = ./remap_subs\nHAL_PIN_VARS = 1\nPARAMETER_FILE = machine.var\n\
    REMAP = M428 modalgroup=10 ngc=428remap\nREMAP = M429 modalgroup=10 ngc=429remap\n\
    [KINS]\nKINEMATICS = xyzac-trt-kins sparm=identityfirst\nJOINTS = 5\n[HAL]\nHALFILE = machine.hal\n\
    [EMCMOT]\nEMCMOT = motmod\nSERVO_PERIOD = 1000000\nCOMM_TIMEOUT = 30\n[TASK]\nTASK = milltask\nCYCLE_TIME = 0.001\n\
    [EMCIO]\nEMCIO = io\nCYCLE_TIME = 0.02\nTOOL_TABLE = machine.tbl\n";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_of_the_command_are_read() {
        let text = include_str!("../../control/fast.toml");
        let fast = Drives::of(text, Path::new("fast.toml")).unwrap();
        let z =
            Joint { velocity: 500.0, acceleration: 4000.0, jerk: 50_000.0, travel: Some([-1500.0, 400.0]) };
        assert_eq!(fast.joints[2], z);
        assert_eq!((fast.joints[4].velocity, fast.joints[4].travel), (360.0, None));
        let ini = fast.ini();
        assert!(ini.contains("TABLE_Z = -400\n") && ini.contains("MAX_LINEAR_VELOCITY = 500\n"), "{ini}");
        let z = "[AXIS_Z]\nMAX_VELOCITY = 500\nMAX_ACCELERATION = 4000\nMIN_LIMIT = -1900\nMAX_LIMIT = 0\n";
        assert!(ini.contains(z), "{ini}");
        let broken = text.replace("max_jerk_deg_s3", "jerk");
        let why = Drives::of(&broken, Path::new("a.toml")).unwrap_err().to_string();
        assert!(why.contains("max_jerk of A"), "{why}");
    }
}
