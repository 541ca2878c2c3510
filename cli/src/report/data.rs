//! What a report shows, as plain values: filled by the commands, read by [`super::html`] and [`super::svg`].
//!
//! Frame: the part's, z up in the pictures. Lengths mm, time min, wall time s. A deviation is measured along the
//! part's outward normal: **positive is material left (scallop), negative is material missing (gouge)**. NaN means
//! 'not known' wherever a field is a float, and is shown as such; it never counts as zero.

use super::machine::Machine;
use osculate_geom::Diagnostic;
use osculate_postproc::machine::MAX_JOINTS;

/// Everything on the page.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Report {
    /// The heading: part and strategy, for example.
    pub title: String,
    /// One line under it: job file, machine, dialect.
    pub subtitle: String,
    /// The page is about faces alone: nothing is planned or measured, and their ids are what a reader looks for.
    pub faces_only: bool,
    /// What the verification measured.
    pub verdict: Verdict,
    /// The part's faces.
    pub faces: Vec<FaceMesh>,
    /// Further quantities over the part that the viewer can show; [`FaceMesh::scalars`] has their values.
    pub scalars: Vec<Scalar>,
    /// The cutting passes, in the order of cutting.
    pub passes: Vec<Pass>,
    /// Which point of the tool the passes follow.
    pub path_points: PathPoints,
    /// What lies between the passes: approaches, links and rapids.
    pub links: Vec<Link>,
    /// The tools, where there are some to show, in the order in which they are in hand.
    pub tools: Vec<Tool>,
    /// The machine, where one is known.
    pub machine: Option<Machine>,
    /// Where the tool goes, in order; thinned by the caller to what an animation needs (6000 poses are plenty).
    pub poses: Vec<ToolPose>,
    /// How the deviation is spread.
    pub histogram: Histogram,
    /// How fast the tool goes.
    pub pace: Pace,
    /// Tables beside the picture.
    pub tables: Vec<Table>,
    /// What was found on the way.
    pub diagnostics: Vec<Diagnostic>,
    /// How long the computation took.
    pub stages: Vec<Stage>,
}

/// The verdict in one word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Outcome {
    /// Measured, and inside every tolerance.
    Within,
    /// Measured, and outside at least one tolerance.
    Outside,
    /// Not measured: nothing is claimed.
    #[default]
    NotVerified,
    /// Within its limits at the samples; that it is so between them, or everywhere in the scope, is not shown.
    NotShown,
}

/// What the verification measured and what it was held against.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The verdict in one word.
    pub outcome: Outcome,
    /// The verdict in a sentence: what is out, where, what to change.
    pub words: String,
    /// What was verified: "the NC program, read back", "the CL path".
    pub source: String,
    /// On how many points of the part.
    pub samples: usize,
    /// Highest material left, mm.
    pub scallop_max_mm: f64,
    /// 99 of 100 samples have less than this left, mm.
    pub scallop_p99_mm: f64,
    /// Deepest gouge, mm, as a positive number.
    pub gouge_max_mm: f64,
    /// Area that no pass reached, mm2.
    pub uncut_area_mm2: f64,
    /// Area that the job accepts as not reached, mm2; NaN where it is not known.
    pub uncut_accepted_mm2: f64,
    /// Area of the faces to machine, mm2; NaN where it is not known.
    pub area_mm2: f64,
    /// Accepted scallop, mm.
    pub scallop_tolerance_mm: f64,
    /// Accepted gouge, mm, as a positive number.
    pub gouge_tolerance_mm: f64,
    /// The worst places, worst first.
    pub worst: Vec<Worst>,
}

impl Default for Verdict {
    fn default() -> Self {
        Self {
            outcome: Outcome::NotVerified,
            words: String::new(),
            source: String::new(),
            samples: 0,
            scallop_max_mm: f64::NAN,
            scallop_p99_mm: f64::NAN,
            gouge_max_mm: f64::NAN,
            uncut_area_mm2: f64::NAN,
            uncut_accepted_mm2: f64::NAN,
            area_mm2: f64::NAN,
            scallop_tolerance_mm: f64::NAN,
            gouge_tolerance_mm: f64::NAN,
            worst: Vec::new(),
        }
    }
}

/// A place worth looking at.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Worst {
    /// Deviation there, mm, signed.
    pub deviation_mm: f64,
    /// Where, mm.
    pub at_mm: [f64; 3],
    /// The place in words: face, parameters, NC block.
    pub place: String,
    /// Which of the report's poses made it so; `None` where nothing came there.
    pub pose: Option<usize>,
}

/// One face as triangles. Vertices that are shared are stored once; the three per-vertex lists go with `positions`.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct FaceMesh {
    /// The face's name as `inspect` prints it.
    pub id: String,
    /// It is not to be machined, only kept clear of: its deviation is what was cut of it, zero where nothing was.
    pub checked: bool,
    /// Vertices, mm.
    pub positions: Vec<[f32; 3]>,
    /// Outward unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Triangles, indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// Deviation at each vertex, mm; NaN where not verified. Empty: no vertex was.
    pub deviation_mm: Vec<f32>,
    /// Values of [`Report::scalars`], in that order, one a vertex each.
    pub scalars: Vec<Vec<f32>>,
}

/// A quantity over the part, for example a principal curvature.
#[derive(Clone, Debug)]
pub struct Scalar {
    /// Its name.
    pub name: String,
    /// Its unit, empty for a ratio.
    pub unit: String,
}

/// One cutting pass.
#[derive(Clone, Debug, Default)]
pub struct Pass {
    /// Points along it, mm.
    pub points_mm: Vec<[f32; 3]>,
    /// Strip width at each point, mm; NaN or missing where not known.
    pub widths_mm: Vec<f32>,
}

/// Which point of the tool the passes follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PathPoints {
    /// Where the tool touches the part.
    #[default]
    Contact,
    /// The tool tip.
    Tip,
}

/// A way of the tool tip between passes.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Link {
    /// Points along it, mm.
    pub points_mm: Vec<[f32; 3]>,
    /// Driven as fast as the machine goes; otherwise at a feed.
    pub rapid: bool,
}

/// The tool as a body of revolution about its axis, tip at the origin, spindle upwards.
#[derive(Clone, Debug, Default)]
pub struct Tool {
    /// How people call it: "toroidal D20 r2"; of several with what it is used for.
    pub label: String,
    /// Outer diameter, mm.
    pub diameter_mm: f64,
    /// Corner radius, mm: half the diameter for a ball, 0 for a flat end.
    pub corner_radius_mm: f64,
    /// From the tip to the holder, mm.
    pub length_mm: f64,
    /// Length with cutting edges, mm; `None` where not known: the whole length is then drawn as cutter.
    pub flute_mm: Option<f64>,
    /// The sections of the holder above the cutter, from the nose upwards.
    pub holder: Vec<Holder>,
    /// The meridian of a cutter of another kind (cone, barrel): `[radius, height]` in mm from the tip upwards. Empty:
    /// diameter, corner radius and length say it all.
    pub meridian_mm: Vec<[f64; 2]>,
}

/// A section of a holder, standing on what is below it.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Holder {
    /// Diameters at its lower and its upper end, mm.
    pub diameters_mm: [f64; 2],
    /// Length, mm.
    pub length_mm: f64,
}

/// Where the tool is at one moment.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ToolPose {
    /// Tool tip, mm.
    pub tip_mm: [f32; 3],
    /// Unit axis, from tip to spindle.
    pub axis: [f32; 3],
    /// Machining time up to here, min; NaN where not known.
    pub time_min: f32,
    /// The pass being cut, counted from 0; `None` between passes.
    pub pass: Option<u32>,
    /// Which of the tools is in hand.
    pub tool: u32,
    /// Line of the program that ends here; 0 where not known.
    pub line: u32,
    /// Which of the setups of [`Report::machine`] the part sits in.
    pub setup: u32,
    /// Where the joints of [`Report::machine`] stand, mm and rad, slides at the spindle nose; NaN where not known.
    pub at_nose: [f32; MAX_JOINTS],
}

/// How the deviation is spread: bin `i` reaches from `edges_mm[i]` to `edges_mm[i + 1]`.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Histogram {
    /// Bin borders, mm, ascending; one more than `weights`.
    pub edges_mm: Vec<f64>,
    /// What falls into each bin, in `unit`.
    pub weights: Vec<f64>,
    /// Unit of the weights: "samples", "mm2".
    pub unit: String,
}

/// How fast the tip goes, over the time.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Pace {
    /// Feed moves and rapids in order.
    pub steps: Vec<PaceStep>,
    /// The feed that is asked for, mm/min; `None` where several are.
    pub asked_mm_min: Option<f64>,
}

/// A stretch of the program.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct PaceStep {
    /// When it ends, min.
    pub end_min: f64,
    /// The way of the tip, mm.
    pub length_mm: f64,
    /// Driven as fast as the machine goes.
    pub rapid: bool,
}

/// A table. With `columns` empty, its rows are pairs of key and value.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// What it is about.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, formatted.
    pub rows: Vec<Vec<String>>,
}

/// One column of a table.
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
}

/// A stage of the computation.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// Wall time, s.
    pub wall_s: f64,
}
