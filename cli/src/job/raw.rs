//! The tables of a job file as written; what they mean is made of them in [`crate::job::Job`].

use crate::job::words::{
    Accept, AlongWord, AxisKey, AxisWord, ClimbWord, CoolantWord, DirectionsKey, EffortWord, EntryWord,
    FeedWord, FlankShape, Gouges, LeanKey, MaterialWord, Method, Normals, OperationWord, StrategyWord, Tip,
    ToolKind, Turns,
};
use osculate_tools::HolderSpec;
use serde::Deserialize;

/// A whole file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Raw {
    #[allow(dead_code)]
    pub format: u32,
    pub part: Part,
    pub tool: Option<Tool>,
    pub tools: Option<Vec<Tool>>,
    pub tolerance: Tolerance,
    #[serde(default)]
    pub strategy: Strategy,
    #[serde(default)]
    pub cutting: Cutting,
    pub machine: Option<Machine>,
    #[serde(default)]
    pub setup: Setup,
    pub contact: Option<Contact>,
    pub stock: Option<Stock>,
    pub fixture: Option<Fixture>,
    #[serde(default)]
    pub flank: Flank,
    #[serde(default)]
    pub verification: Verification,
    /// How high material stands on the faces, where operations before have left it, mm.
    #[serde(skip)]
    pub standing_mm: Option<f64>,
    /// Whether others of the same program keep their axis.
    #[serde(skip)]
    pub beside_kept: bool,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Part {
    pub file: Option<String>,
    pub unit_mm: Option<f64>,
    pub faces: Option<FaceChoice>,
    pub check_faces: Option<FaceChoice>,
    pub may_hit: Option<FaceChoice>,
    #[serde(default)]
    pub normals: Normals,
    pub side: Option<Sides>,
    pub builtin: Option<toml::Table>,
    pub ruled: Option<Ruled>,
}

/// Sides of faces: of some, or several such.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Sides {
    One(SideKey),
    Several(Vec<SideKey>),
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct SideKey {
    pub faces: Ids,
    pub material: MaterialWord,
}

/// An id, or several.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Ids {
    One(String),
    Several(Vec<String>),
}

impl Sides {
    /// Each face that is named with its side, in their order.
    pub fn each(&self) -> Vec<(String, MaterialWord)> {
        let all = match self {
            Self::One(one) => std::slice::from_ref(one),
            Self::Several(all) => all,
        };
        let of = |s: &SideKey| match &s.faces {
            Ids::One(id) => vec![(id.clone(), s.material)],
            Ids::Several(ids) => ids.iter().map(|id| (id.clone(), s.material)).collect(),
        };
        all.iter().flat_map(of).collect()
    }
}

/// A choice of faces.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum FaceChoice {
    /// `"all"` or one id.
    Word(String),
    /// Ids as `inspect` prints them.
    Ids(Vec<String>),
    /// `{ largest = n }`
    Largest(Largest),
}

impl FaceChoice {
    /// Whether all faces are meant.
    #[must_use]
    pub fn is_all(&self) -> bool {
        matches!(self, Self::Word(w) if w == "all")
    }
}

/// `{ largest = n }`
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Largest {
    /// How many of the largest faces.
    pub largest: usize,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Ruled {
    pub c0: Curve,
    pub c1: Curve,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Curve {
    pub degree: Option<usize>,
    pub knots: Option<Vec<f64>>,
    pub poles: Option<Vec<[f64; 3]>>,
    pub weights: Option<Vec<f64>>,
    pub points: Option<Vec<[f64; 3]>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    pub kind: ToolKind,
    pub diameter_mm: f64,
    pub number: Option<u32>,
    pub corner_radius_mm: Option<f64>,
    pub length_mm: Option<f64>,
    pub flute_length_mm: Option<f64>,
    pub taper_deg: Option<f64>,
    pub tip_diameter_mm: Option<f64>,
    pub barrel_radius_mm: Option<f64>,
    pub bottom_angle_deg: Option<f64>,
    pub side_angle_deg: Option<f64>,
    pub teeth: Option<u32>,
    #[serde(default)]
    pub plunges: bool,
    pub holder: Option<Holder>,
    /// In a list of operations only, as all that follows here.
    pub name: Option<String>,
    pub cutting: Option<Cutting>,
}

/// A holder: one section, or several from the nose upwards.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Holder {
    One(HolderSpec),
    Several(Vec<HolderSpec>),
}

impl Holder {
    /// Its sections, from the nose upwards.
    pub fn sections(&self) -> Vec<HolderSpec> {
        match self {
            Self::One(section) => vec![*section],
            Self::Several(sections) => sections.clone(),
        }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    pub scallop_mm: f64,
    pub gouge_mm: Option<f64>,
    pub chord_mm: Option<f64>,
    pub unreached_mm2: Option<f64>,
}

#[derive(Debug, Default, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct Strategy {
    pub kind: StrategyWord,
    pub lead_deg: LeanKey,
    pub lead_rate_deg_per_mm: Option<f64>,
    pub tilt_deg: LeanKey,
    pub side_tilt_deg: Option<f64>,
    pub effort: EffortWord,
    pub along: AlongWord,
    pub axis: Option<AxisKey>,
    #[serde(default)]
    pub one_way: bool,
    #[serde(default)]
    pub climb: ClimbWord,
    pub feed_direction: Option<[f64; 3]>,
    pub normal: Option<[f64; 3]>,
    pub stepdown_mm: Option<f64>,
    pub stepover_mm: Option<f64>,
    pub allowance_mm: Option<f64>,
    pub ramp_deg: Option<f64>,
    pub directions: Option<DirectionsKey>,
    pub least_share: Option<f64>,
    pub entry: Option<EntryWord>,
    pub volume_rate_mm3_min: Option<f64>,
    pub gouges: Gouges,
    pub keep_off_mm: Option<f64>,
}

#[derive(Debug, Default, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Cutting {
    pub spindle_rpm: Option<f64>,
    pub feed_mm_min: Option<f64>,
    pub air_feed_mm_min: Option<f64>,
    pub feed_per_tooth_mm: Option<f64>,
    pub coolant: Option<CoolantWord>,
}

#[derive(Debug, Default, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Machine {
    pub name: Option<String>,
    pub file: Option<String>,
    pub dialect: Option<String>,
    pub feed: Option<FeedWord>,
    pub kz_step: Option<f64>,
    pub dialect_file: Option<String>,
    pub work_offset: Option<String>,
    pub program_number: Option<u32>,
}

#[derive(Debug, Default, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    pub part_zero_mm: Option<[f64; 3]>,
    pub rotate_deg: Option<[f64; 3]>,
    pub turns: Option<Turns>,
    pub clearance_mm: Option<f64>,
    pub approach_mm: Option<f64>,
    pub hop_mm: Option<f64>,
    pub check_clearance_mm: Option<f64>,
    /// In a list of operations only, as all that follows here.
    pub name: Option<String>,
    pub fixtures: Option<Vec<String>>,
    pub fixture_spacing_mm: Option<f64>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Contact {
    pub at: [f64; 2],
    #[serde(default)]
    pub lift_mm: f64,
    pub along: Option<AxisWord>,
    pub angle_deg: Option<f64>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Stock {
    pub box_mm: Option<[f64; 6]>,
    pub file: Option<String>,
    pub allowance_mm: Option<f64>,
    pub cylinder: Option<Cylinder>,
    pub cell_mm: Option<f64>,
    pub memory_mb: Option<f64>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Cylinder {
    pub axis: Option<[f64; 3]>,
    pub diameter_mm: f64,
    pub z_mm: [f64; 2],
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Fixture {
    pub files: Vec<String>,
    pub spacing_mm: Option<f64>,
}

#[derive(Debug, Default, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Flank {
    pub at_u: Option<f64>,
    pub side: Option<i32>,
    pub span_u: Option<[f64; 2]>,
    pub judge_u: Option<[f64; 2]>,
    pub positions: Option<usize>,
    pub method: Option<Method>,
    pub along: Option<AlongWord>,
    pub face: Option<FlankShape>,
    pub tip: Option<Tip>,
    pub below_mm: Option<f64>,
    pub lead_mm: Option<f64>,
    pub spans: Option<usize>,
    pub gouge_weight: Option<f64>,
    pub smoothness_per_mm: Option<f64>,
    pub ruled_tolerance_mm: Option<f64>,
}

#[derive(Debug, Default, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Verification {
    pub spacing_mm: Option<f64>,
    pub max_samples: Option<usize>,
    pub accept: Option<Accept>,
}

/// A whole file of operations.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct RawList {
    #[allow(dead_code)]
    pub format: u32,
    pub part: Part,
    #[serde(default)]
    pub tool: Vec<Tool>,
    pub tolerance: Tolerance,
    #[serde(default)]
    pub cutting: Cutting,
    pub machine: Option<Machine>,
    #[serde(default)]
    pub setup: Vec<Setup>,
    pub stock: Option<Stock>,
    #[serde(default)]
    pub operation: Vec<Operation>,
    #[serde(default)]
    pub verification: Verification,
}

/// Equal places in a circle: a number of them, or with the axis.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Repeat {
    Count(usize),
    Circle(Circle),
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    pub axis: Option<[f64; 3]>,
    pub at_mm: Option<[f64; 3]>,
    pub count: usize,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Operation {
    pub name: Option<String>,
    pub setup: Option<String>,
    pub kind: OperationWord,
    pub tools: Option<Vec<u32>>,
    pub faces: Option<FaceChoice>,
    pub repeat: Option<Repeat>,
    pub allowance_mm: Option<f64>,
    pub stepdown_mm: Option<f64>,
    pub stepover_mm: Option<f64>,
    pub axis: Option<[f64; 3]>,
    pub ramp_deg: Option<f64>,
    pub directions: Option<DirectionsKey>,
    pub least_share: Option<f64>,
    pub entry: Option<EntryWord>,
    pub volume_rate_mm3_min: Option<f64>,
    pub overlap_mm: Option<f64>,
    pub scallop_mm: Option<f64>,
    pub gouge_mm: Option<f64>,
    #[serde(default)]
    pub strategy: Strategy,
}
