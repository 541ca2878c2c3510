//! The main job, from the part to a verified NC program with a report.

use crate::failure::Failure;
use crate::files;
use crate::job::Job;
use crate::job::strategy::Kind;
use crate::part::{self, Part};
use crate::report::fill::{self, Story};
use crate::watch::{Stage, Watch};
use crate::work::axes::Fields;
use crate::work::budget::Shares;
use crate::work::choice::{self, Choice, Row};
use crate::work::joints::JointFigures;
use crate::work::nc::Motions;
use crate::work::passes::{self, Way};
use crate::work::productivity::{InTime, RealProductivity, Timed, strips_over_area};
use crate::work::program::{Planned, Posted, WallS};
use crate::work::summary::{Productivity, SetupSummary, Summary};
use crate::work::verify::{VerdictKeys, Verified};
use crate::work::{drop, ideal, left_out, rough};
use osculate_geom::Diagnostic;
use osculate_productivity::compare::Axes;
use osculate_productivity::levels::{Totals, levels};
use osculate_productivity::plan::{CcPoint, Passes};
use osculate_tools::Lean;
use osculate_tools::removal::Verdict;
use std::path::Path;

/// A file of a plan, by its name.
///
/// ```
/// use osculate::PlanFile;
///
/// let file = PlanFile::of_text("notes.txt", "two passes".into());
/// assert_eq!((file.name.as_str(), file.text()), ("notes.txt", Some("two passes")));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlanFile {
    /// Name, without a folder.
    pub name: String,
    /// What stands in it.
    pub bytes: Vec<u8>,
}

impl PlanFile {
    /// A file of text.
    #[must_use]
    pub fn of_text(name: impl Into<String>, text: String) -> Self {
        Self { name: name.into(), bytes: text.into_bytes() }
    }

    /// What stands in it, where it is text.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        std::str::from_utf8(&self.bytes).ok()
    }
}

/// A plan with its program, what was proved of it, and the pages that a person looks at.
#[non_exhaustive]
pub struct Plan {
    /// The job, with the tool in hand that the plan is for.
    pub job: Job,
    /// The figures.
    pub summary: Summary,
    /// What verification of the program measured.
    pub verified: Verified,
    /// Findings of all stages.
    pub diagnostics: Vec<Diagnostic>,
    /// CL data, program, report, pictures and summary.
    pub files: Vec<PlanFile>,
}

impl Plan {
    /// The text file of this name.
    #[must_use]
    pub fn file(&self, name: &str) -> Option<&str> {
        self.files.iter().find(|f| f.name == name).and_then(PlanFile::text)
    }

    /// The NC program, whatever its control calls its files.
    #[must_use]
    pub fn program(&self) -> &str {
        let program = self.files.iter().find(|f| f.name.starts_with("program."));
        program.and_then(PlanFile::text).unwrap_or_default()
    }

    /// What was proved of the program: the answer with its scope.
    #[must_use]
    pub const fn verdict(&self) -> &Verdict {
        &self.verified.verdict
    }

    /// The report, a page of HTML that needs nothing beside it.
    #[must_use]
    pub fn report(&self) -> &str {
        self.file(REPORT).unwrap_or_default()
    }

    /// CL data, program, report, pictures and summary.
    #[must_use]
    pub fn files(&self) -> &[PlanFile] {
        &self.files
    }

    /// Writes all files into a folder, which is made where it is not there. Each appears whole or not at all.
    ///
    /// # Errors
    /// Where one cannot be written; none of them is new then.
    pub fn write(&self, folder: &Path) -> Result<(), Failure> {
        self.write_watched(folder, &())
    }

    /// As [`write`](Self::write), with somebody who hears of temporary files.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_watched(&self, folder: &Path, watch: &dyn Watch) -> Result<(), Failure> {
        let all: Vec<_> = self.files.iter().map(|f| (folder.join(&f.name), &*f.bytes)).collect();
        files::write_set(&all, watch)
    }
}

/// The name of the report.
const REPORT: &str = "report.html";

/// Refuses a job that is for another verb, before its part is read.
///
/// # Errors
/// Where the strategy is that of `flank`.
pub fn check(job: &Job) -> Result<(), Failure> {
    if job.strategy().kind == Kind::Flank { Err(not_planned(job)) } else { Ok(()) }
}

fn not_planned(job: &Job) -> Failure {
    let name = job.strategy().name();
    job.refuse("strategy", "kind", format!("kind = \"{name}\" is not planned here: it is for the verb flank"))
}

/// Plans a job on its part, posts the path, verifies the program and makes the report.
///
/// ```
/// use osculate::{Job, Part};
/// use std::path::Path;
///
/// let text = r#"
/// format = 1
/// part = { builtin = { kind = "plane", half_size_mm = 2 } }
/// tool = { kind = "ball", diameter_mm = 6, length_mm = 40, teeth = 2 }
/// tolerance = { scallop_mm = 0.1 }
/// strategy = { kind = "isoparametric", lead_deg = 10 }
/// cutting = { spindle_rpm = 8000 }
/// machine = { name = "trunnion-ac", dialect = "heidenhain", feed = "tcp" }
/// "#;
/// let job = Job::from_toml(text, Path::new("plane.toml"))?;
/// let plan = osculate::plan(&Part::of(&job)?, &job, &())?;
/// // What was proved of it is what the figures say.
/// assert_eq!(plan.summary.verification.within_tolerance, plan.verdict().is_held());
/// assert!(plan.program().starts_with("BEGIN PGM") || plan.program().starts_with("0 BEGIN PGM"));
/// // CL data stands beside the program.
/// assert!(plan.file("path.cl").is_some_and(|cl| cl.contains("GOTO/")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Where no path can be planned or posted. A plan that does not hold is none: its verdict says so.
pub fn plan(part: &Part, job: &Job, watch: &dyn Watch) -> Result<Plan, Failure> {
    part.part.to_plan(job.path())?;
    let mut wall_s = WallS { import: part.import_s, ..WallS::default() };
    if job.is_open() {
        let (job, chosen) = chosen(job, part, &mut wall_s, watch).map_err(|why| part.warned(why))?;
        return chosen.told(&job, part, wall_s, watch);
    }
    let stage = Stage::begin(watch, "plan");
    let planned = planned(job, part, watch, &|f| stage.at(f)).map_err(|why| part.warned(why))?;
    wall_s.plan = stage.end();
    prove(job, part, planned, wall_s, watch)
}

/// Posts a path that is planned already, verifies the program and tells everything.
///
/// # Errors
/// Where it cannot be posted or verified.
pub fn prove(
    job: &Job,
    faces: &Part,
    planned: Planned<'_>,
    mut wall_s: WallS,
    watch: &dyn Watch,
) -> Result<Plan, Failure> {
    let posted = Posted::of(job, faces, &planned, &mut wall_s, watch)?;
    let verified = posted.verify(job, faces, &mut wall_s, watch)?;
    Proved { planned, posted, verified, compared: Vec::new() }.told(job, faces, wall_s, watch)
}

/// The fastest of all candidates whose program holds, with the job that has its tool.
fn chosen(
    job: &Job,
    faces: &Part,
    wall_s: &mut WallS,
    watch: &dyn Watch,
) -> Result<(Job, Proved<'static>), Failure> {
    let stage = Stage::begin(watch, "choose");
    // A tool that keeps its axis leaves nothing out itself, and yet what it does not reach was accepted.
    let accepted = left_out::is_wanted(job);
    let mut choice = Choice::screen(job, faces)?;
    let settled = choice::settle(&mut choice, 1, watch, wall_s, &|f| stage.at(f))?;
    let mut planned = settled.planned;
    let compared = choice.rows();
    planned.extras.diagnostics.push(Diagnostic::note("auto", choice.story()));
    let caption = "Tools, strategies and leads compared".to_owned();
    planned.extras.tables.push(choice::page_table(&compared, caption));
    // Programs and verifications on the way have times of their own.
    wall_s.plan = stage.end() - wall_s.post - wall_s.verify;
    let (job, posted, mut verified) = (settled.job, settled.posted, settled.verified);
    if accepted {
        // Here no operation follows that what is left out could be left to.
        verified = posted.verify(&job, faces, wall_s, watch)?;
    }
    Ok((job, Proved { planned, posted, verified, compared }))
}

/// A plan with its program and what was measured, and what it was chosen from.
struct Proved<'a> {
    planned: Planned<'a>,
    posted: Posted,
    verified: Verified,
    compared: Vec<Row>,
}

impl Proved<'_> {
    /// Everything that is told of it.
    fn told(self, job: &Job, faces: &Part, mut wall_s: WallS, watch: &dyn Watch) -> Result<Plan, Failure> {
        let Proved { planned, posted, verified, compared } = self;
        let stage = Stage::begin(watch, "ideal");
        let ideal = ideal::of_plan(job, faces, &planned, posted.read.cutting_time_min)?;
        wall_s.ideal = stage.end();
        let stage = Stage::begin(watch, "report");
        let of_feed = posted.note_of_feed(job, faces, &planned);
        let Posted { cl_text, control, program, setup, read, diagnostics } = posted;
        let title = passes::title(job);
        let before = [&faces.part.diagnostics, &planned.passes.diagnostics, &planned.extras.diagnostics];
        let diagnostics: Vec<Diagnostic> = before
            .into_iter()
            .flatten()
            .cloned()
            .chain(diagnostics)
            .chain(of_feed)
            .chain(verified.diagnostics.iter().cloned())
            .collect();
        let times = Times::of(&read);
        let times_min = times.time_min;
        let mut summary = summary_of(job, faces, &planned, times, &verified)?;
        // Productivity is told in the control's time; where none is known F tells.
        let (clock_min, whole_min) = match &read.on_control {
            Some(control) => (&control.times_min, control.time_min),
            None => (&read.times_min, times_min),
        };
        let timed = Timed { motions: &read.motions, times_min: clock_min, joints: read.joints.as_ref() };
        let in_time = InTime::of(job, timed, &verified);
        let mut found = in_time.whole(job, faces, whole_min);
        found.strips_over_area = strips_over_area(&planned, found.finished_mm2);
        summary.productivity = found;
        summary.ideal = ideal;
        summary.wall_s = wall_s;
        summary.compared = compared;
        let file = format!("program.{}", control.extension);
        summary.setups = vec![SetupSummary::of("setup", &file, times_min, &setup)];
        summary.diagnostics = diagnostics.iter().map(ToString::to_string).collect();
        let story = Story {
            title: &title,
            job,
            faces,
            passes: &planned.passes,
            linked: &planned.linked,
            verified: &verified,
            summary: &summary,
            diagnostics: &diagnostics,
            time_by_move: &read,
            chain: &control.machine,
            setups: vec![(0, setup)],
            hands: vec![(0, fill::tool(job))],
            extras: &planned.extras,
            in_time: &in_time,
        };
        let pages = pages(&story, watch, &|f| stage.at(f));
        let mut files = vec![PlanFile::of_text("path.cl", cl_text), PlanFile::of_text(file, program.text)];
        files.extend(pages);
        summary.wall_s.report = stage.end();
        let w = summary.wall_s;
        summary.wall_s.total = w.import + w.plan + w.post + w.verify + w.ideal + w.report;
        let text = serde_json::to_string_pretty(&summary).map_err(Failure::job)? + "\n";
        files.push(PlanFile::of_text("summary.json", text));
        Ok(Plan { job: job.clone(), summary, verified, diagnostics, files })
    }
}

/// Report and pictures of a plan; none where nobody looks at them.
pub fn pages(story: &Story<'_>, watch: &dyn Watch, progress: &(dyn Fn(f64) + Sync)) -> Vec<PlanFile> {
    if !watch.wants_pages() {
        return Vec::new();
    }
    let made = fill::pages(story, progress);
    let named = [(REPORT, made.html), ("picture.svg", made.svg), ("path.svg", made.path_svg)];
    let by_place = made.productivity_svg.map(|svg| ("productivity.svg", svg));
    named.into_iter().chain(by_place).map(|(name, text)| PlanFile::of_text(name, text)).collect()
}

/// How long a program takes, and what it asks of the joints.
#[non_exhaustive]
pub struct Times {
    /// All of it, min.
    pub time_min: f64,
    /// Its feed moves, min.
    pub cutting_min: f64,
    /// The same two on the control, with its accelerations and corners, where that is known.
    pub on_control_min: Option<[f64; 2]>,
    /// What the feed moves ask of the joints, where that is known.
    pub joints: Option<JointFigures>,
}

impl Times {
    fn of(read: &Motions) -> Self {
        Self {
            time_min: read.time_min,
            cutting_min: read.cutting_time_min,
            on_control_min: read.on_control.as_ref().map(|c| [c.time_min, c.cutting_min]),
            joints: read.joints.as_ref().map(JointFigures::of),
        }
    }
}

/// The figures of a plan; what it was chosen from, its ideal time, wall times and findings are to be added.
///
/// # Errors
/// Where the tool cannot be told as data.
pub fn summary_of(
    job: &Job,
    faces: &Part,
    planned: &Planned<'_>,
    times: Times,
    verified: &Verified,
) -> Result<Summary, Failure> {
    let area_mm2: f64 = faces.faces.iter().map(part::area).sum();
    let left_mm2: f64 = planned.extras.left_out.iter().map(|f| f.area_mm2).sum();
    let totals = Totals { area_mm2: area_mm2 - left_mm2, time_min: times.time_min };
    let l = levels(&planned.passes.passes, job.feed_mm_min(), totals);
    let found = if planned.axes == Axes::Held { None } else { planned.passes.inclination_rad() };
    let tilted = if planned.axes == Axes::Balanced { planned.passes.tilts_rad() } else { None };
    let lean = job.strategy().as_given(planned.lean);
    let control = job.control();
    Ok(Summary {
        format: 1,
        strategy: planned.strategy.clone(),
        tool: serde_json::to_value(job.cutter_spec()).map_err(Failure::job)?,
        tool_words: job.tool_words(),
        lead_deg: found.map_or(lean.lead_rad, |[_, mean, _]| mean).to_degrees(),
        lead_range_deg: found.map(|[least, _, most]| [least, most].map(f64::to_degrees)),
        tilt_deg: lean.tilt_rad.to_degrees(),
        tilt_range_deg: tilted.map(|both| both.map(f64::to_degrees)),
        side_tilt_deg: job.strategy().side_tilt_deg,
        machine: control.machine.name().to_owned(),
        dialect: control.dialect_name.clone(),
        feed: control.feed_name.clone(),
        passes: planned.passes.passes.len(),
        points: planned.linked.path.moves.len(),
        cutting_length_mm: planned.linked.cutting_length_mm,
        air_length_mm: planned.linked.air_length_mm,
        time_min: times.time_min,
        cutting_time_min: times.cutting_min,
        control_time_min: times.on_control_min.map(|t| t[0]),
        control_cutting_time_min: times.on_control_min.map(|t| t[1]),
        joints: times.joints,
        area_mm2,
        productivity_mm2_min: Productivity {
            instantaneous_min: l.instantaneous_min,
            instantaneous_max: l.instantaneous_max,
            regional: l.regional,
            global: l.global,
        },
        productivity: RealProductivity::default(),
        ideal: None,
        verification: verified.summary.clone(),
        verdict: VerdictKeys::of(&verified.verdict),
        left_out: planned.extras.left_out.clone(),
        worst: verified.worst.clone(),
        wall_s: WallS::default(),
        compared: Vec::new(),
        diagnostics: Vec::new(),
        left_standing: Vec::new(),
        setups: Vec::new(),
        operations: Vec::new(),
    })
}

/// Passes before they are joined.
#[non_exhaustive]
pub struct Laid {
    /// The passes.
    pub passes: Passes,
    /// After each what was taken out of the pass that it is of, up to the next; none where nothing was.
    pub skipped: Vec<Vec<CcPoint>>,
    /// Lead and tilt.
    pub lean: Lean,
    /// Whence the axis.
    pub axes: Axes,
}

impl Laid {
    /// Passes by the strategy of a job that finishes.
    ///
    /// # Errors
    /// Where the strategy is another, or no passes can be laid.
    pub fn of(
        job: &Job,
        faces: &Part,
        watch: &dyn Watch,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Self, Failure> {
        let strategy = match &job.strategy().kind {
            Kind::Faces(strategy) => strategy,
            Kind::Drop(lines) => {
                let passes = drop::passes(job, faces, *lines, Shares::WHOLE, progress)?;
                return Ok(Self { passes, skipped: Vec::new(), lean: Lean::default(), axes: Axes::Held });
            }
            Kind::Layers(_) | Kind::Auto | Kind::Flank => return Err(not_planned(job)),
        };
        let (passes, lean) = match strategy.fixed_axis() {
            Some(_) => {
                let fields = &Fields::default();
                let way = Way {
                    strategy,
                    lean: Lean::default(),
                    axes: Axes::Held,
                    fields,
                    shares: Shares::WHOLE,
                    watch,
                };
                (passes::each_face(job, faces, &way, progress)?, Lean::default())
            }
            None => passes::with_best_lead(job, faces, strategy, watch, progress)?,
        };
        Ok(Self { passes, skipped: Vec::new(), lean, axes: passes::axes(job) })
    }

    /// The passes joined, less what the job wants left out of them.
    ///
    /// # Errors
    /// Where nothing remains.
    pub fn linked(self, job: &Job, faces: &Part) -> Result<Planned<'static>, Failure> {
        let Self { passes, skipped, lean, axes } = self;
        let left_out::Joined { passes, skipped, linked, extras } =
            left_out::linked(job, faces, (passes, skipped))?;
        let strategy = job.strategy().name().to_owned();
        Ok(Planned { passes, skipped, linked, strategy, lean, axes, extras, with_strips: true })
    }
}

/// Passes and links by the job's strategy.
pub fn planned(
    job: &Job,
    faces: &Part,
    watch: &dyn Watch,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Planned<'static>, Failure> {
    match &job.strategy().kind {
        Kind::Layers(layers) => rough::of_raw(job, faces, layers, progress),
        _ => Laid::of(job, faces, watch, progress)?.linked(job, faces),
    }
}
