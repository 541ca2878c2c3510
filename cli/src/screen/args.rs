//! The command line as typed.

use clap::{Args, Parser, Subcommand};
use osculate::failure::Failure;
use osculate::part::{self, Loaded};
use osculate::work::sweep::rows::Shard;
use std::path::PathBuf;

/// Plan, verify and post multi-axis NC machining of free-form surfaces.
#[derive(Debug, Parser)]
#[command(name = "osculate", version, about, long_about = None)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
    /// One JSON object on stdout and nothing else there.
    #[arg(long, global = true)]
    pub json: bool,
    /// No results as text on stdout and no progress: exit code, files and messages of failures say what came of it.
    #[arg(long, global = true, conflicts_with = "json")]
    pub quiet: bool,
    /// Words in colour.
    #[arg(long, global = true, value_name = "WHEN", value_parser = ["auto", "always", "never"], default_value = "auto")]
    pub color: String,
    /// A line on stderr for every stage and per cent of it, for other programs: `progress: verify 42 %`.
    #[arg(long, global = true)]
    pub progress: bool,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// What is in a CAD file: faces with kind, degrees, poles, area, curvature range, what was not understood.
    Inspect(InspectArgs),
    /// A first job for a part: faces, tool, axes and tolerance chosen, each with its reason, ready for `plan`.
    Init(InitArgs),
    /// What fits and what is not reached or not set, without planning.
    Check {
        /// The job file.
        job: PathBuf,
    },
    /// Faces as STEP, IGES or JSON, or their triangles as STL or OBJ, by the ending of the file to write.
    Export(ExportArgs),
    /// Point, normal, fundamental forms, principal curvatures and directions at parameters.
    Probe {
        /// The part.
        #[command(flatten)]
        part: PartArgs,
        /// The face, by its id in `inspect`; may be left out where there is only one.
        #[arg(long)]
        face: Option<String>,
        /// Surface parameters; may be given more than once.
        #[arg(long, value_name = "U,V", required = true, value_parser = pair, allow_hyphen_values = true)]
        at: Vec<[f64; 2]>,
    },
    /// Characteristic lines of a face as SVG figures and JSON: lines of curvature, umbilics, contours, gradients, ridges.
    Lines(LinesArgs),
    /// Strip width at one contact: exact and every closed form that applies, side by side.
    Strip {
        /// The job file, with its contact table.
        job: PathBuf,
        /// Folder for strip.json and strip.svg: the indicatrices of part and tool, and productivity over the share of marks.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Tools, strategies, directions and leads of a job side by side: time, length, productivity, ranked, with why each lost.
    Compare {
        /// The job file.
        job: PathBuf,
        /// Folder for compare.json and for pictures of the best posture all over the faces: of every tool, and of the
        /// best tool at each place.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Pictures: places along u and along v.
        #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u64).range(1..=200))]
        nodes: u64,
    },
    /// How the tool may lean over the faces of a job, without planning: the field of axes, and what stands in the way at single places.
    Axes(AxesArgs),
    /// The main job: path, CL file, NC program, verification, report.
    Plan {
        /// The job file.
        job: PathBuf,
        /// Folder for the results.
        #[arg(long)]
        out: PathBuf,
    },
    /// One job with some of its values varied: every combination planned and judged, one table and a page of all.
    Sweep(SweepArgs),
    /// The side of a cutter on a ruled face: every positioning side by side, the chosen one as path, NC program and report.
    Flank {
        /// The job file, with its flank table.
        job: PathBuf,
        /// Folder for path, program and report; without it only the table is made.
        #[arg(long)]
        out: Option<PathBuf>,
        /// The largest cylinder that holds the tolerance by each setting, at the rule and over the span, in place of what the job's tool leaves.
        #[arg(long, conflicts_with = "out")]
        largest_tool: bool,
    },
    /// CL data to NC code.
    Post(PostArgs),
    /// Material removal against the part: scallop, gouge, uncut area.
    Verify {
        /// A CL file or an NC program; of a list of operations the program of each setup, in their order.
        #[arg(required = true, num_args = 1..)]
        files: Vec<PathBuf>,
        /// The job file: part, tool, tolerance and machine.
        #[arg(long)]
        job: PathBuf,
        /// Skip words of the NC program that are not understood, with a finding each, instead of stopping.
        #[arg(long)]
        lenient: bool,
        /// Judge an NC program again by frozen poses against points of the whole part, with code that shares nothing with the
        /// verification; where the two disagree the answer is that nothing is shown.
        #[arg(long)]
        second_opinion: bool,
        /// Write the surface as cut, coloured by its deviation, as a PLY file.
        #[arg(long, value_name = "FILE")]
        ply: Option<PathBuf>,
        /// Write what each block took from the raw material, its chip section and engagement, as a CSV file.
        #[arg(long, value_name = "FILE")]
        blocks: Option<PathBuf>,
        /// Write what was measured at every sample and the way of the tool into a folder, as files of VTK (.vtp, for ParaView) and NumPy (.npz).
        #[arg(long, value_name = "FOLDER")]
        data: Option<PathBuf>,
    },
    /// Machining time of an NC program with the axes' limits.
    Time(TimeArgs),
    /// What an NC program makes the tool do, as CL data.
    Readback(ReadbackArgs),
    /// The built-in machines.
    Machines {
        /// A machine file (or a built-in name): what it leaves open, and what that means.
        #[arg(long, value_name = "FILE")]
        check: Option<String>,
    },
    /// The built-in dialects.
    Dialects,
    /// The cutter kinds that a job can ask for; with a library of tools, what stands in it, also as another kind of library.
    Tools(ToolsArgs),
    /// The surfaces with a name, for --builtin and for jobs.
    Gallery,
    /// All keys of a job file: what each takes, what holds where it is left out, and what it means.
    Keys {
        /// Print a commented job file instead, which can be run.
        #[arg(long)]
        template: bool,
        /// Print a JSON schema of job files instead, for editors that complete and check TOML.
        #[arg(long, conflicts_with = "template")]
        schema: bool,
    },
    /// A script that completes verbs and options in a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// The pages of the manual, one for each verb.
    Man {
        /// Folder for the pages.
        #[arg(long)]
        out: PathBuf,
    },
}

/// A part: a file or a built-in surface.
#[derive(Debug, Args)]
pub struct PartArgs {
    /// A STEP or IGES file, or a mesh (STL, PLY, 3MF) to look at.
    #[arg(required_unless_present = "builtin", conflicts_with = "builtin")]
    pub part: Option<PathBuf>,
    /// A built-in surface as a TOML table's keys, for example 'kind = "torus", major_radius_mm = 200, ...'.
    #[arg(long, value_name = "KEYS")]
    pub builtin: Option<String>,
}

impl PartArgs {
    /// The part.
    pub fn load(&self) -> Result<Loaded, Failure> {
        match (&self.part, &self.builtin) {
            (Some(path), None) => part::open(path),
            (None, Some(keys)) => part::built_in(keys),
            _ => Err(Failure::Usage("give either a part file or --builtin".to_owned())),
        }
    }
}

/// What `inspect` takes.
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// The part.
    #[command(flatten)]
    pub part: PartArgs,
    /// The faces in groups that look alike and go on smoothly, with what each is, and how neighbours meet.
    #[arg(long)]
    pub groups: bool,
    /// Folder for faces.html: the part in 3D, its faces with their ids, coloured by group.
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
}

/// What `init` takes.
#[derive(Debug, Args)]
pub struct InitArgs {
    /// A STEP or IGES file.
    pub part: PathBuf,
    /// Faces or groups to machine, by their ids in `inspect`, with commas between, or all; chosen where not given.
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    pub faces: Vec<String>,
    /// A built-in machine or the path of a machine file.
    #[arg(long, default_value = "trunnion-ac")]
    pub machine: String,
    /// A library of tools to choose from; that of the program where not given.
    #[arg(long, value_name = "FILE")]
    pub tools: Option<PathBuf>,
    /// Folder for job.toml.
    #[arg(long)]
    pub out: PathBuf,
}

/// What `tools` takes.
#[derive(Debug, Args)]
pub struct ToolsArgs {
    /// A library: .toml of ours, .tbl of LinuxCNC, .fctl or .fctb of FreeCAD, .json of Fusion; "shipped" is that of the program.
    #[arg(value_name = "LIBRARY")]
    pub library: Option<PathBuf>,
    /// Write the tools to a library of the kind that its ending says.
    #[arg(long, value_name = "FILE", requires = "library")]
    pub out: Option<PathBuf>,
    /// The lengths of a table of LinuxCNC are inches.
    #[arg(long, requires = "library")]
    pub inch: bool,
}

/// What `axes` takes.
#[derive(Debug, Args)]
pub struct AxesArgs {
    /// The job file; the tool is its first, the strategy one whose tool leans along its passes.
    pub job: PathBuf,
    /// The face, by its id in `inspect`; all faces of the job where not given.
    #[arg(long, value_name = "ID")]
    pub face: Option<String>,
    /// Surface parameters of a place whose directions are looked at; may be given more than once. The middle of each face and the place
    /// with the fewest directions where not given.
    #[arg(long, value_name = "U,V", value_parser = pair, allow_hyphen_values = true)]
    pub at: Vec<[f64; 2]>,
    /// Folder for pictures: the field over each face, and a round map of the directions at each place.
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
}

/// What `sweep` takes.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// The sweep: the job, and what is varied of it.
    pub sweep: PathBuf,
    /// Folder for the rows of finished cases and for the table; a run that was ended goes on from its rows.
    #[arg(long, value_name = "FOLDER", required_unless_present = "print")]
    pub out: Option<PathBuf>,
    /// Only the K-th of N shards: the cases K, K + N, K + 2 N, ... No table is made.
    #[arg(long, value_name = "K/N", value_parser = shard, conflicts_with_all = ["merge", "print"])]
    pub shard: Option<Shard>,
    /// Only the table, from the rows of all shards in the folder.
    #[arg(long, conflicts_with = "print")]
    pub merge: bool,
    /// Writes each plan with its program and report into a folder of its own, plans/000001 and so on.
    #[arg(long, conflicts_with_all = ["merge", "print"])]
    pub plans: bool,
    /// Cases at the same time, each on one thread; as many as there are cores where not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=4096))]
    pub threads: Option<u64>,
    /// Prints the job of a case, by its number, and plans nothing.
    #[arg(long, value_name = "CASE")]
    pub print: Option<usize>,
}

/// `K/N`, K from 1 to N.
fn shard(text: &str) -> Result<Shard, String> {
    let two = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    match two {
        Some((which, of)) if (1..=of).contains(&which) => Ok(Shard { which, of }),
        _ => Err(format!("{text:?} is no shard: write K/N with K from 1 to N, such as 2/4")),
    }
}

/// What `lines` takes.
#[derive(Debug, Args)]
pub struct LinesArgs {
    /// The part.
    #[command(flatten)]
    pub part: PartArgs,
    /// The face, by its id in `inspect`; may be left out where there is only one.
    #[arg(long)]
    pub face: Option<String>,
    /// Tool axis for contours and gradients.
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,1", value_parser = triple, allow_hyphen_values = true)]
    pub axis: [f64; 3],
    /// Distance of neighbouring lines, mm; a twenty-second of the face's size where not given.
    #[arg(long)]
    pub spacing_mm: Option<f64>,
    /// About how many levels of height and of curvature difference.
    #[arg(long, default_value_t = 12)]
    pub levels: usize,
    /// Where the viewer stands: azimuth from +x towards +y and elevation, degrees; chosen by the face where not given.
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = pair, allow_hyphen_values = true)]
    pub view_deg: Option<[f64; 2]>,
    /// Best postures of a tool over the face.
    #[command(flatten)]
    pub postures: PostureArgs,
    /// Folder for the figures and lines.json.
    #[arg(long)]
    pub out: PathBuf,
}

/// What the postures of `lines` take.
#[derive(Debug, Args)]
pub struct PostureArgs {
    /// Show the best posture of this tool all over the face: a list of its keys, as under `[tool]` of a job:
    /// 'kind = "toroidal", diameter_mm = 12, corner_radius_mm = 2, length_mm = 60'.
    #[arg(long, value_name = "KEYS")]
    pub tool: Option<String>,
    /// Postures: material that may be left, mm.
    #[arg(long, default_value_t = 0.01)]
    pub scallop_mm: f64,
    /// Postures: undercut that may stay, mm.
    #[arg(long, default_value_t = 0.005)]
    pub gouge_mm: f64,
    /// Postures: feed of the contact, mm/min.
    #[arg(long, default_value_t = 1000.0)]
    pub feed_mm_min: f64,
    /// Postures: least and greatest lead, degrees.
    #[arg(long, value_name = "LEAST,MOST", default_value = "3,40", value_parser = pair, allow_hyphen_values = true)]
    pub lead_deg: [f64; 2],
    /// Postures: least and greatest tilt, degrees.
    #[arg(long, value_name = "LEAST,MOST", default_value = "0,0", value_parser = pair, allow_hyphen_values = true)]
    pub tilt_deg: [f64; 2],
    /// Postures: nodes along u and along v.
    #[arg(long, default_value_t = 20)]
    pub nodes: usize,
}

/// What `export` takes.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// A STEP or IGES file, or the JSON of an export.
    pub part: PathBuf,
    /// Only these faces, by their ids in `inspect`, with commas between.
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    pub faces: Vec<String>,
    /// The file to write: .step, .stp, .igs, .iges, .json, .stl or .obj.
    #[arg(long)]
    pub out: PathBuf,
    /// Triangles: largest distance from the faces; a thousandth of the part's size where not given.
    #[arg(long)]
    pub chord_mm: Option<f64>,
    /// Triangles: largest angle between the normals at the ends of a side.
    #[arg(long)]
    pub angle_deg: Option<f64>,
    /// Triangles: longest side.
    #[arg(long)]
    pub max_edge_mm: Option<f64>,
    /// STL as text.
    #[arg(long)]
    pub text: bool,
}

/// What `post` takes.
#[derive(Debug, Args)]
pub struct PostArgs {
    /// The CL file.
    pub clfile: PathBuf,
    /// A built-in machine or the path of a machine file.
    #[arg(long)]
    pub machine: String,
    /// A dialect (see `dialects`), or the path of a dialect file.
    #[arg(long)]
    pub dialect: String,
    /// tcp, none, kv, kf, kz, inverse_time, rotary (deg/min over the rotary axes) or fastest (as the joints allow).
    #[arg(long, default_value = "tcp")]
    pub feed: String,
    /// The largest rise of F from block to block, for --feed kz, mm/min.
    #[arg(long)]
    pub kz_step: Option<f64>,
    /// Put the moves into a subprogram that the main program calls (sinumerik).
    #[arg(long)]
    pub subprogram: bool,
    /// Where the tool points, in words: rotary joints, directions (A3= B3= C3=, TX TY TZ, I J K), or a tilted plane per
    /// position (CYCLE800, PLANE SPATIAL, G68.2).
    #[arg(long, value_parser = ["joints", "vectors", "planes"], default_value = "joints")]
    pub orientation: String,
    /// Where the part's origin sits from the table's reference point, mm.
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub part_zero: Option<[f64; 3]>,
    /// Two opposite corners of the box around the raw material, part's frame, mm: for the picture of a Heidenhain control.
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = sextuple, allow_hyphen_values = true)]
    pub blank_mm: Option<[f64; 6]>,
    /// From the tip to the spindle nose, mm; cutter and holder of the CL data where not given.
    #[arg(long)]
    pub gauge_length_mm: Option<f64>,
    /// The work offset: G54 to G59 and more, by the dialect; "preset 3" with heidenhain.
    #[arg(long)]
    pub work_offset: Option<String>,
    /// The program's number (fanuc).
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=9999))]
    pub program_number: Option<u32>,
    /// Put the next tool ready while one is at work (`T7`, `TOOL DEF 7`).
    #[arg(long)]
    pub preselect: bool,
    /// By how much the control may leave the way at corners and in smoothing (`G64 P`, `CYCLE832`, cycle 32), mm; 0.002 where not given.
    #[arg(long, value_name = "MM", value_parser = blend)]
    pub blend_mm: Option<f64>,
    /// Let blocks go on over points between which the axis turns, for as long as the tip, and the axis at the cutter's radius, keep within
    /// so much of the lines between them, mm: fewer blocks, at which controls brake less. Not for paths that the cutter's side cuts.
    #[arg(long, value_name = "MM", value_parser = blend)]
    pub join_mm: Option<f64>,
    /// Stop before each further tool where the operator asks for it (`M1`).
    #[arg(long)]
    pub stops: bool,
    /// What points between CUTCOM/LEFT or RIGHT and CUTCOM/OFF are. With `centre`, the cutter's centre as CL data has it: they are
    /// posted as they are, and wear is not compensated at the control. Without it CUTCOM is refused.
    #[arg(long, value_parser = ["centre"])]
    pub cutcom: Option<String>,
    /// Leave out statements that are not understood, or that the program cannot say, instead of refusing the file; they are listed.
    #[arg(long)]
    pub lenient: bool,
    /// The program to write.
    #[arg(long)]
    pub out: PathBuf,
}

/// What `time` takes.
#[derive(Debug, Args)]
pub struct TimeArgs {
    /// The NC program.
    #[arg(value_name = "NCFILE")]
    pub file: PathBuf,
    /// A built-in machine or the path of a machine file.
    #[arg(long)]
    pub machine: String,
    /// A dialect (see `dialects`) or the path of a dialect file; by the program's extension where not given.
    #[arg(long)]
    pub dialect: Option<String>,
    /// Where the part's origin sits from the table's reference point, mm; as the program's head says where not given.
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub part_zero: Option<[f64; 3]>,
    /// From the tip to the spindle nose, mm; as the program's head says where not given.
    #[arg(long)]
    pub gauge_length_mm: Option<f64>,
    /// Stop at the first word that is not understood instead of leaving it out with a finding.
    #[arg(long)]
    pub strict: bool,
}

/// What `readback` takes.
#[derive(Debug, Args)]
pub struct ReadbackArgs {
    /// The program and its machine.
    #[command(flatten)]
    pub nc: TimeArgs,
    /// The CL file to write.
    #[arg(long)]
    pub out: PathBuf,
}

fn numbers<const N: usize>(s: &str) -> Result<[f64; N], String> {
    let parts: Vec<&str> = s.split(',').collect();
    if parts.len() != N {
        return Err(format!("expected {N} numbers separated by commas, got {}", parts.len()));
    }
    let mut out = [0.0; N];
    for (o, p) in out.iter_mut().zip(parts) {
        *o = p.trim().parse::<f64>().map_err(|_| format!("'{p}' is not a number"))?;
        if !o.is_finite() {
            return Err(format!("'{p}' is not a finite number"));
        }
    }
    Ok(out)
}

fn pair(s: &str) -> Result<[f64; 2], String> {
    numbers(s)
}

/// What programs word with four decimals, and no part is meant to be off by more.
fn blend(s: &str) -> Result<f64, String> {
    let mm: f64 = s.parse().map_err(|_| format!("'{s}' is not a number"))?;
    if (1e-4..=1.0).contains(&mm) { Ok(mm) } else { Err("0.0001 to 1 mm is wanted".into()) }
}

fn triple(s: &str) -> Result<[f64; 3], String> {
    numbers(s)
}

fn sextuple(s: &str) -> Result<[f64; 6], String> {
    numbers(s)
}
