//! The job file: TOML with units in its keys, checked as a whole before any work begins.

pub mod cutter;
pub mod flank;
mod lead;

use crate::failure::{Failure, read_text};
use crate::work::setup::SetupTable;
pub use lead::LeadKey;
use osculate_geom::{Unit3, Vec3};
use osculate_tools::{Cutter, CutterSpec, HolderSpec, Lean};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Greatest change of a local lead where the job says none: at 2000 mm/min some 30 degrees a second, as rotary axes can.
const LEAD_RATE_DEG_PER_MM: f64 = 1.0;
/// Material that is assumed on faces where no raw material is declared: this many scallops, so that heights are told far above
/// what is accepted, and no less than this, mm, ...
const LAYER_SCALLOPS: f64 = 20.0;
const LEAST_LAYER_MM: f64 = 0.5;
/// ... but no more than this share of the approach height, at which rapid moves end.
pub const LAYER_OF_APPROACH: f64 = 0.75;
/// The share of the scallop tolerance that tooth marks take at most.
const MARK_SHARE: f64 = 0.5;
/// The format that this version reads.
const FORMAT: u32 = 1;

/// A job file as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    format: u32,
    /// The part and which of its faces.
    pub part: PartTable,
    /// The cutter; of several, the one in hand.
    tool: Option<ToolTable>,
    /// Cutters to choose from, instead of one.
    tools: Option<Vec<ToolTable>>,
    /// What must hold.
    pub tolerance: ToleranceTable,
    /// How to cut.
    #[serde(default)]
    pub strategy: StrategyTable,
    /// Spindle and feed.
    #[serde(default)]
    pub cutting: CuttingTable,
    /// Machine and control.
    pub machine: Option<MachineTable>,
    /// Where the part sits on the machine.
    #[serde(default)]
    pub setup: SetupTable,
    /// One contact, for `strip`.
    pub contact: Option<ContactTable>,
    /// Raw material, for `verify`.
    pub stock: Option<crate::work::stock::StockTable>,
    /// What holds the part, for `verify`.
    pub fixture: Option<crate::work::stock::FixtureTable>,
    /// For `flank`.
    #[serde(default)]
    pub flank: flank::FlankTable,
    /// How densely to verify.
    #[serde(default)]
    pub verification: VerificationTable,
    /// The file it came from.
    #[serde(skip)]
    pub path: PathBuf,
}

/// `[part]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartTable {
    /// STEP or IGES file, relative to the job file.
    pub file: Option<String>,
    /// Millimetres in a unit of a file of point sections or patches that names none, or another than is meant.
    pub unit_mm: Option<f64>,
    /// Faces to machine.
    pub faces: Option<FaceChoice>,
    /// Faces that the tool must not touch; all others of the part are none the less.
    pub check_faces: Option<FaceChoice>,
    /// Faces that the tool may hit: they are not looked at, and the verdict says so.
    pub may_hit: Option<FaceChoice>,
    /// Which side the material is on, for faces whose file does not say.
    #[serde(default)]
    pub normals: Normals,
    /// A built-in surface instead of a file.
    pub builtin: Option<toml::Table>,
    /// The surface between two curves instead of a file.
    pub ruled: Option<flank::RuledTable>,
}

/// Which side of a face the outward normal is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Normals {
    /// As the file says; where it does not, by looking which side is enclosed.
    #[default]
    Auto,
    /// Along S_u x S_v as the file has it.
    File,
    /// Against it.
    Reversed,
}

/// A choice of faces.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub enum FaceChoice {
    /// `"all"` or one id.
    Word(String),
    /// Ids as `inspect` prints them.
    Ids(Vec<String>),
    /// `{ largest = n }`
    Largest(LargestTable),
}

impl FaceChoice {
    /// Whether all faces are meant.
    #[must_use]
    pub fn is_all(&self) -> bool {
        matches!(self, Self::Word(w) if w == "all")
    }
}

/// `{ largest = n }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LargestTable {
    /// How many of the largest faces.
    pub largest: usize,
}

/// `[tool]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolTable {
    /// One of [`crate::job::cutter::KINDS`].
    pub kind: String,
    /// Outer diameter; of `apt`, d.
    pub diameter_mm: f64,
    /// Radius of the rounded end or corner.
    pub corner_radius_mm: Option<f64>,
    /// From the tip to the holder.
    pub length_mm: Option<f64>,
    /// From the tip to where the cutting edges end and the shank begins; the whole length where not given.
    pub flute_length_mm: Option<f64>,
    /// Of a cone, half its angle.
    pub taper_deg: Option<f64>,
    /// Of a cone without a ball tip.
    pub tip_diameter_mm: Option<f64>,
    /// Of a barrel's large arc.
    pub barrel_radius_mm: Option<f64>,
    /// Of `apt`: rise of the bottom.
    pub bottom_angle_deg: Option<f64>,
    /// Of `apt`: opening of the side.
    pub side_angle_deg: Option<f64>,
    /// Number of teeth.
    pub teeth: Option<u32>,
    /// Holder above the cutter.
    pub holder: Option<HolderSpec>,
}

/// `[tolerance]`
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToleranceTable {
    /// Highest material left.
    pub scallop_mm: f64,
    /// Uncut area that is accepted, mm2; none where not given.
    pub unreached_mm2: Option<f64>,
    /// Deepest undercut accepted; half the scallop where not given.
    pub gouge_mm: Option<f64>,
    /// Chord tolerance of the path; a fifth of the scallop where not given.
    pub chord_mm: Option<f64>,
}

/// `[strategy]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrategyTable {
    /// `auto` or the name of a strategy.
    #[serde(default = "auto")]
    pub kind: String,
    /// Lead.
    #[serde(default)]
    pub lead_deg: LeadKey,
    /// Of a local lead: its greatest change per mm of the face.
    pub lead_rate_deg_per_mm: Option<f64>,
    /// Tilt.
    #[serde(default)]
    pub tilt_deg: f64,
    /// `u`, `v` or `auto`: the parameter that isoparametric passes run along.
    #[serde(default = "auto")]
    pub along: String,
    /// The tool axis of passes that keep it.
    pub axis: Option<[f64; 3]>,
    /// The way of three-axis passes, across the axis; the longest side of the faces where not given.
    pub feed_direction: Option<[f64; 3]>,
    /// Normal of the planes of isoplanar passes.
    pub normal: Option<[f64; 3]>,
    /// Of a roughing: deepest cut along the axis.
    pub stepdown_mm: Option<f64>,
    /// Of a roughing: distance of rows.
    pub stepover_mm: Option<f64>,
    /// Of a roughing: what it leaves on the faces; nothing where not given.
    pub allowance_mm: Option<f64>,
    /// Of a roughing: steepest way down into material.
    pub ramp_deg: Option<f64>,
    /// What becomes of places where the tool would go into the part or a check face.
    #[serde(default)]
    pub gouges: Gouges,
    /// Of places left out: what cutter and holder keep from check faces, and the holder from faces to machine.
    pub keep_off_mm: Option<f64>,
}

/// What becomes of places where the tool would go into the part.
#[derive(Debug, Clone, Copy, Deserialize, Default, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Gouges {
    /// They are machined, and verification says that the path does not hold.
    #[default]
    Report,
    /// Passes end before them; verification counts what stands as uncut.
    LeaveOut,
}

fn auto() -> String {
    "auto".to_owned()
}

impl Default for StrategyTable {
    fn default() -> Self {
        Self {
            kind: auto(),
            lead_deg: LeadKey::Auto,
            lead_rate_deg_per_mm: None,
            tilt_deg: 0.0,
            along: auto(),
            axis: None,
            feed_direction: None,
            normal: None,
            stepdown_mm: None,
            stepover_mm: None,
            allowance_mm: None,
            ramp_deg: None,
            gouges: Gouges::Report,
            keep_off_mm: None,
        }
    }
}

/// `[cutting]`
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct CuttingTable {
    /// Spindle speed.
    pub spindle_rpm: Option<f64>,
    /// Feed of the tool tip on the part.
    pub feed_mm_min: Option<f64>,
    /// Cap on the feed per tooth.
    pub feed_per_tooth_mm: Option<f64>,
}

/// `[machine]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineTable {
    /// A built-in machine.
    pub name: Option<String>,
    /// A machine file, relative to the job file.
    pub file: Option<String>,
    /// The control's language.
    pub dialect: Option<String>,
    /// How the feed is programmed.
    pub feed: Option<String>,
    /// Largest growth of the feed correction between blocks, for `kz`.
    pub kz_step: Option<f64>,
}

/// `[contact]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactTable {
    /// Surface parameters.
    pub at: [f64; 2],
    /// Height above the contact.
    #[serde(default)]
    pub lift_mm: f64,
    /// `u` or `v`: feed along the isoparametric line.
    pub along: Option<String>,
    /// Or the geodesic at this angle from S_u towards S_v.
    pub angle_deg: Option<f64>,
}

/// `[verification]`
#[derive(Debug, Clone, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct VerificationTable {
    /// Distance between samples; from the strip width where not given.
    pub spacing_mm: Option<f64>,
    /// Most samples.
    pub max_samples: Option<usize>,
    /// `samples`: limits that are met at the samples are enough.
    pub accept: Option<String>,
}

/// A length that must be positive.
fn positive(path: &Path, key: &str, value: f64) -> Result<f64, Failure> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Failure::file(path, format!("{key} = {value} must be a positive number")))
    }
}

impl Job {
    /// Reads and checks a job file.
    pub fn load(path: &Path) -> Result<Self, Failure> {
        let text = read_text(path)?;
        let mut job: Self =
            toml::from_str(&text).map_err(|e| Failure::file(path, e.to_string().trim_end()))?;
        job.path = path.to_path_buf();
        if job.format != FORMAT {
            return Err(Failure::file(
                path,
                format!("format = {}: this version reads format = {FORMAT}", job.format),
            ));
        }
        let p = &job.part;
        match [p.file.is_some(), p.builtin.is_some(), p.ruled.is_some()].iter().filter(|x| **x).count() {
            0 => {
                let need = "[part] needs file = \"...\", builtin = { ... } or [part.ruled]";
                return Err(Failure::file(path, need));
            }
            1 => {}
            _ => {
                return Err(Failure::file(
                    path,
                    "[part] has several of file, builtin and ruled; keep one of them",
                ));
            }
        }
        match (&job.tool, job.tools.as_deref()) {
            (Some(_), None) => {}
            (Some(_), Some(_)) => {
                return Err(Failure::file(path, "has both [tool] and [[tools]]; keep one of them"));
            }
            (None, None) => {
                return Err(Failure::file(path, "needs a [tool] table, or [[tools]] to choose from"));
            }
            (None, Some([])) => {
                return Err(Failure::file(path, "tools = []: the list of tools is empty; give at least one"));
            }
            (None, Some([first, ..])) => job.tool = Some(first.clone()),
        }
        job.tolerance()?;
        job.lean(0.0)?;
        job.lead_rate_rad_per_mm()?;
        job.spindle_rpm()?;
        let all = job.each_tool();
        for (k, one) in all.iter().enumerate() {
            one.check_tool().map_err(|e| match all.len() {
                1 => e,
                // The keys are those of [tool]; which table is meant must be said.
                _ => Failure::Job(e.message().replacen(
                    "[tool",
                    &format!("[[tools]] number {}: [tool", k + 1),
                    1,
                )),
            })?;
        }
        Ok(job)
    }

    /// Whether the tool in hand is one.
    fn check_tool(&self) -> Result<(), Failure> {
        self.cutter()?;
        self.feed_mm_min()?;
        self.holder()?;
        self.flutes()?;
        Ok(())
    }

    /// Reads and checks a job file of a single tool.
    pub fn load_with_one_tool(path: &Path) -> Result<Self, Failure> {
        let job = Self::load(path)?;
        match job.tools.as_deref() {
            Some([_, _, ..]) => Err(Failure::file(
                path,
                "has several [[tools]] where one is needed: copy the job with the one meant as [tool]",
            )),
            _ => Ok(job),
        }
    }

    /// The job once with each of its tools in hand.
    pub fn each_tool(&self) -> Vec<Self> {
        let with = |t: &ToolTable| Self { tool: Some(t.clone()), ..self.clone() };
        self.tools.as_ref().map_or_else(|| vec![self.clone()], |all| all.iter().map(with).collect())
    }

    /// The tool in hand.
    pub fn tool(&self) -> &ToolTable {
        self.tool.as_ref().expect("loading puts a tool in hand")
    }

    /// The tool in hand in words, as tables show it.
    pub fn tool_words(&self) -> String {
        let t = self.tool();
        let corner = t.corner_radius_mm.filter(|_| t.kind != "ball").map(|r| format!(" r {r}"));
        format!("{} {}{}", t.kind, t.diameter_mm, corner.unwrap_or_default())
    }

    /// The tolerances, checked and completed.
    pub fn tolerance(&self) -> Result<osculate_productivity::plan::Tolerance, Failure> {
        let t = &self.tolerance;
        let check = |key: &str, v: f64| positive(&self.path, &format!("[tolerance] {key}"), v);
        let scallop_mm = check("scallop_mm", t.scallop_mm)?;
        Ok(osculate_productivity::plan::Tolerance {
            scallop_mm,
            gouge_mm: check("gouge_mm", t.gouge_mm.unwrap_or(0.5 * scallop_mm))?,
            chord_mm: check("chord_mm", t.chord_mm.unwrap_or(0.2 * scallop_mm))?,
        })
    }

    /// The cutter's description.
    pub fn cutter_spec(&self) -> Result<CutterSpec, Failure> {
        cutter::spec(&self.path, self.tool())
    }

    /// The cutter.
    pub fn cutter(&self) -> Result<Cutter, Failure> {
        Cutter::try_from(self.cutter_spec()?).map_err(|e| Failure::file(&self.path, format!("[tool] {e}")))
    }

    /// The part of the cutter that cuts, and the shank above it where the flutes end below the length.
    pub fn flutes(&self) -> Result<(Cutter, Option<Cutter>), Failure> {
        let whole = self.cutter()?;
        let Some(flute_mm) = self.tool().flute_length_mm else { return Ok((whole, None)) };
        let wrong =
            |why: String| Failure::file(&self.path, format!("[tool] flute_length_mm = {flute_mm}: {why}"));
        let shank_mm = whole.length_mm() - flute_mm;
        if !(flute_mm > 0.0 && shank_mm >= 0.0) {
            return Err(wrong(format!("must lie between 0 and the length, {} mm", whole.length_mm())));
        }
        let short = whole.shortened(flute_mm).map_err(|e| wrong(e.to_string()))?;
        let shank = if shank_mm > 0.0 {
            Some(Cutter::cylinder(2.0 * whole.radius_mm(), shank_mm).map_err(|e| wrong(e.to_string()))?)
        } else {
            None
        };
        Ok((short, shank))
    }

    /// The holder as a cylinder.
    pub fn holder(&self) -> Result<Option<Cutter>, Failure> {
        let Some(h) = &self.tool().holder else { return Ok(None) };
        Cutter::cylinder(h.diameter_mm, h.length_mm).map(Some).map_err(|e| {
            Failure::file(&self.path, format!("[tool.holder] {}", e.to_string().replace("cutter", "holder")))
        })
    }

    /// Lead and tilt, with this lead where the job leaves it to the program.
    pub fn lean(&self, auto_lead_rad: f64) -> Result<Lean, Failure> {
        let lead_rad = match self.strategy.lead_deg {
            LeadKey::Auto | LeadKey::Local => auto_lead_rad,
            LeadKey::Given(deg) => deg.to_radians(),
        };
        Lean { lead_rad, tilt_rad: self.strategy.tilt_deg.to_radians() }
            .checked()
            .map_err(|e| Failure::file(&self.path, format!("[strategy] {e}")))
    }

    /// Greatest change of a local lead per mm of the face.
    pub fn lead_rate_rad_per_mm(&self) -> Result<f64, Failure> {
        let deg = self.strategy.lead_rate_deg_per_mm.unwrap_or(LEAD_RATE_DEG_PER_MM);
        Ok(positive(&self.path, "[strategy] lead_rate_deg_per_mm", deg)?.to_radians())
    }

    /// The feed, capped by the feed per tooth where the job gives both.
    pub fn feed_mm_min(&self) -> Result<f64, Failure> {
        let c = &self.cutting;
        let given = positive(&self.path, "[cutting] feed_mm_min", c.feed_mm_min.unwrap_or(1000.0))?;
        let feed = self.mark_cap_mm_min()?.map_or(given, |cap| given.min(cap));
        match (c.feed_per_tooth_mm, c.spindle_rpm, self.tool().teeth) {
            (Some(f), Some(n), Some(z)) => {
                let f = positive(&self.path, "[cutting] feed_per_tooth_mm", f)?;
                Ok(feed.min(f * n * f64::from(z)))
            }
            (Some(_), _, _) => Err(Failure::file(
                &self.path,
                "[cutting] feed_per_tooth_mm needs spindle_rpm and [tool] teeth to become a feed",
            )),
            _ => Ok(feed),
        }
    }

    /// The feed at which the marks of teeth take half of the scallop tolerance on a plane; None where nothing tells how often teeth
    /// pass, or what they leave depends on a lead that is not known yet. Half is best where the feed is free: the width of a strip
    /// goes with the square root of what is left for it, and so does the feed with what is left for the mark [R97, eq. 41].
    pub fn mark_cap_mm_min(&self) -> Result<Option<f64>, Failure> {
        let Some(rpm) = self.spindle_rpm()? else { return Ok(None) };
        let teeth = f64::from(self.tool().teeth.unwrap_or(1).max(1));
        let mark_mm = MARK_SHARE * self.tolerance()?.scallop_mm;
        Ok(self.feed_per_tooth_mm(mark_mm)?.map(|f| f * teeth * rpm))
    }

    /// The feed per tooth whose mark on a plane is as high as this, mm; None for an edge that leans by an unknown lead.
    ///
    /// A corner of radius r leaves `h = r - sqrt(r^2 - f^2/4)`; an edge that leans by the lead L leaves `h = f sin L cos L`.
    pub fn feed_per_tooth_mm(&self, mark_mm: f64) -> Result<Option<f64>, Failure> {
        let r = self.cutter()?.corner_mm();
        if r > 0.0 {
            let h = mark_mm.min(r);
            return Ok(Some(2.0 * (h * (2.0 * r - h)).sqrt()));
        }
        let lead = match self.strategy.lead_deg {
            LeadKey::Given(deg) => deg.to_radians().abs(),
            LeadKey::Auto | LeadKey::Local => return Ok(None),
        };
        let slope = lead.sin() * lead.cos();
        Ok((slope > 0.0).then(|| mark_mm / slope))
    }

    /// The spindle speed.
    pub fn spindle_rpm(&self) -> Result<Option<f64>, Failure> {
        self.cutting.spindle_rpm.map(|n| positive(&self.path, "[cutting] spindle_rpm", n)).transpose()
    }

    /// How high material stands on the faces to machine, mm: what is declared, or else what approaches leave room for.
    pub fn layer_mm(&self) -> Result<f64, Failure> {
        if let Some(allowance) = self.stock.as_ref().and_then(|s| s.allowance_mm.filter(|_| s.file.is_none()))
        {
            return positive(&self.path, "[stock] allowance_mm", allowance);
        }
        let (scallop_mm, radius_mm) = (self.tolerance()?.scallop_mm, self.cutter()?.radius_mm());
        let layer = (LAYER_SCALLOPS * scallop_mm).max(LEAST_LAYER_MM).min(0.5 * radius_mm);
        Ok(match self.setup.approach_mm {
            Some(approach) if approach.is_finite() && approach > 0.0 => {
                layer.min(LAYER_OF_APPROACH * approach)
            }
            _ => layer,
        })
    }

    /// The tool axis of contour passes.
    pub fn contour_axis(&self) -> Result<Unit3, Failure> {
        let a = self.strategy.axis.unwrap_or([0.0, 0.0, 1.0]);
        Unit3::try_new(Vec3::from(a), 1e-9)
            .filter(|u| u.iter().all(|c| c.is_finite()))
            .ok_or_else(|| Failure::file(&self.path, format!("[strategy] axis = {a:?} has no direction")))
    }
}
