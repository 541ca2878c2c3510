//! The figures of a plan: `summary.json`.

use crate::words::number;
use crate::work::choice::Row;
use crate::work::extras::FaceLeftOut;
use crate::work::ideal::IdealTime;
use crate::work::joints::JointFigures;
use crate::work::operations::behind::OnFace;
use crate::work::operations::standing::LeftStanding;
use crate::work::productivity::RealProductivity;
use crate::work::program::WallS;
use crate::work::verify::{VerdictKeys, Verification, WorstPlace};
use osculate_postproc::Setup;
use serde::Serialize;

/// Productivity of passes at the feed asked for, and of the whole program, mm2/min.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct Productivity {
    /// Least at a place of a pass.
    pub instantaneous_min: f64,
    /// Greatest at a place of a pass.
    pub instantaneous_max: f64,
    /// Of each pass.
    pub regional: Vec<f64>,
    /// Of the whole program.
    pub global: f64,
}

/// `summary.json`.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct Summary {
    /// Of this file.
    pub format: u32,
    /// The strategy by name.
    pub strategy: String,
    /// The tool's sizes.
    pub tool: serde_json::Value,
    /// The tool in words.
    pub tool_words: String,
    /// Lead, deg; of a local one the mean.
    pub lead_deg: f64,
    /// Least and greatest of a local lead; `lead_deg` is then their mean by length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lead_range_deg: Option<[f64; 2]>,
    /// Tilt, deg.
    pub tilt_deg: f64,
    /// Least and greatest of a tilt that was found place by place; `tilt_deg` is then 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_range_deg: Option<[f64; 2]>,
    /// Tilt to the left of the growing parameter, deg, where the job asks for one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side_tilt_deg: Option<f64>,
    /// The machine by name.
    pub machine: String,
    /// The control's language.
    pub dialect: String,
    /// How F is programmed.
    pub feed: String,
    /// Passes.
    pub passes: usize,
    /// CL points.
    pub points: usize,
    /// Length of the passes.
    pub cutting_length_mm: f64,
    /// Length of what joins them.
    pub air_length_mm: f64,
    /// Time of the program by its feed words and the joints' greatest speeds.
    pub time_min: f64,
    /// Time of its feed moves.
    pub cutting_time_min: f64,
    /// Time of the program on its control, with accelerations, corners and dwells, as `time` tells it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control_time_min: Option<f64>,
    /// Of it feed moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control_cutting_time_min: Option<f64>,
    /// What the feed moves ask of the joints.
    pub joints: Option<JointFigures>,
    /// Area of the faces to machine.
    pub area_mm2: f64,
    /// Area over time at three levels.
    pub productivity_mm2_min: Productivity,
    /// In the time that the program takes; `productivity_mm2_min` has the passes at the feed that was asked for.
    pub productivity: RealProductivity,
    /// The estimated ideal time, with which the plan is compared.
    #[serde(flatten)]
    pub ideal: Option<IdealTime>,
    /// What the program leaves.
    pub verification: Verification,
    /// The verdict.
    pub verdict: VerdictKeys,
    /// Of faces, what passes leave out so that the tool does not go into the part; it is uncut too.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<FaceLeftOut>,
    /// Where it is worst.
    pub worst: Vec<WorstPlace>,
    /// Wall time by stage, s.
    pub wall_s: WallS,
    /// What the plan was chosen from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub compared: Vec<Row>,
    /// Findings.
    pub diagnostics: Vec<String>,
    /// Of a list of operations, what stands too high on the finished part, by face.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_standing: Vec<LeftStanding>,
    /// How the part is held, in order; one where the job is no list of operations.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub setups: Vec<SetupSummary>,
    /// Of a list of operations, each of them, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub operations: Vec<OperationSummary>,
}

/// A setup of a list of operations.
#[derive(Debug, Serialize, Clone)]
#[non_exhaustive]
pub struct SetupSummary {
    /// As operations name it.
    pub name: String,
    /// The file of its program.
    pub program: String,
    /// Time of its program, tool changes left out, min.
    pub time_min: f64,
    /// How the part is turned, about x, then y, then z.
    pub rotate_deg: [f64; 3],
    /// Where the part's origin sits from the table's reference point.
    pub part_zero_mm: [f64; 3],
}

impl SetupSummary {
    /// Of a program in this file.
    pub fn of(name: &str, program: &str, time_min: f64, setup: &Setup) -> Self {
        let t = setup.part_zero.translation.vector;
        Self {
            name: name.to_owned(),
            program: program.to_owned(),
            time_min,
            rotate_deg: setup.turn_rad().map(f64::to_degrees),
            part_zero_mm: [t.x, t.y, t.z],
        }
    }
}

/// An operation of a list, with the keys that a plan of it alone has.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct OperationSummary {
    /// As people name it.
    pub name: String,
    /// What it does.
    pub kind: &'static str,
    /// Its setup.
    pub setup: String,
    /// The tool's number.
    pub tool_number: u32,
    /// How high material stood on its faces before, at most, mm; absent where no raw material is declared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standing_mm: Option<f64>,
    /// Of rest, the area of its faces that stood too high before, mm2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub too_high_mm2: Option<f64>,
    /// What stood on each of its faces before and after, by the paths; empty where no raw material is declared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub on_faces: Vec<OnFace>,
    /// What it took of the raw material, mm3; absent where none is declared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub removed_mm3: Option<f64>,
    /// What is left of it, mm3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_mm3: Option<f64>,
    /// In a word what became of its faces: held, leaves some (later operations may take it), not held (something is harmed), not shown.
    pub step: &'static str,
    /// Its figures.
    #[serde(flatten)]
    pub figures: Summary,
}

impl Summary {
    /// Lead and tilt in words, degrees; a tilt to one side is to the left or right of the growing parameter.
    pub fn lean_words(&self) -> String {
        let aside = |deg: f64| {
            format!("{} to the {}", number(deg.abs(), 4), if deg < 0.0 { "right" } else { "left" })
        };
        let tilt = match self.tilt_range_deg {
            Some([least, most]) => format!("{} to {}", number(least, 3), number(most, 3)),
            None => self.side_tilt_deg.map_or_else(|| number(self.tilt_deg, 4), aside),
        };
        match self.lead_range_deg {
            Some([least, most]) => {
                let [least, mean, most] = [least, self.lead_deg, most].map(|x| number(x, 3));
                format!("{least} to {most} (mean {mean}), {tilt}")
            }
            None => format!("{}, {tilt}", number(self.lead_deg, 4)),
        }
    }
}
