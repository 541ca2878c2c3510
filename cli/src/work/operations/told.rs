//! What is told of a list of operations: figures of each and of the whole, report, pictures, programs, and the material left.

use crate::failure::Failure;
use crate::job::{OperationWord, Operations};
use crate::part::Part;
use crate::report::fill;
use crate::report::{Column, Table};
use crate::watch::{Stage, Watch};
use crate::words::number;
use crate::work::extras::Extras;
use crate::work::ideal::{self, Share};
use crate::work::nc;
use crate::work::operations::Judged;
use crate::work::operations::course::Course;
use crate::work::operations::posted::Program;
use crate::work::operations::standing;
use crate::work::operations::step::Step;
use crate::work::plan::{self, Plan, PlanFile, Times, summary_of};
use crate::work::productivity::{InTime, Timed};
use crate::work::program::{Planned, WallS};
use crate::work::summary::{OperationSummary, SetupSummary, Summary};
use crate::work::verify::Verified;
use crate::work::{passes, stock};
use osculate_geom::Diagnostic;
use osculate_postproc::nc::Dialect;
use osculate_productivity::compare::Axes;
use osculate_productivity::plan::{Linked, Passes};
use osculate_tools::Lean;
use osculate_tools::removal::Answer;
use std::fmt::Write;
use std::ops::Range;
use std::time::Instant;

/// Cubes along the longest side of meshes of what is left.
const CUBES: usize = 160;

/// Everything that is known of a list of operations.
#[non_exhaustive]
pub struct Known<'a> {
    /// The list.
    pub list: &'a Operations,
    /// The part with all faces to machine.
    pub part: &'a Part,
    /// The operations that have a path.
    pub steps: Vec<Step<'a>>,
    /// The program of each setup.
    pub programs: Vec<Program>,
    /// What they do.
    pub course: Course,
    /// The verdict on each, with what it left.
    pub judged: Vec<Judged>,
    /// The verdict on the finished part.
    pub whole: Verified,
    /// Findings of the list.
    pub notes: Vec<Diagnostic>,
    /// Wall time by stage.
    pub wall_s: WallS,
    /// When planning began.
    pub begin: Instant,
}

/// Files, figures and pages.
///
/// # Errors
/// Where figures or paths cannot be written as text.
pub fn told(known: Known<'_>, watch: &dyn Watch) -> Result<Plan, Failure> {
    let Known { list, part, steps, programs, course, judged, whole, notes, mut wall_s, begin } = known;
    let stage = Stage::begin(watch, "ideal");
    let mut operations = Vec::with_capacity(steps.len());
    let mut shares = Vec::new();
    let timed = Timed { motions: &course.motions, times_min: &course.on_control.times_min, joints: None };
    let in_time = InTime::of(list.whole(), timed, &whole);
    for ((step, judged), section) in steps.iter().zip(&judged).zip(&course.sections) {
        let times = times(&course, &section.motions);
        let part = (section.motions.clone(), times.on_control_min.map_or(times.time_min, |t| t[0]));
        let cutting_min = times.cutting_min;
        let mut told = operation(list, step, judged, times)?;
        // The least time for whole faces says nothing of what leaves some of them to others, as roughings and rests do.
        let finishes = step.operation.kind == OperationWord::Finish;
        if finishes && judged.verified.summary.uncut_area_mm2 <= 0.0 {
            let found = ideal::of_plan(&step.judged()?, &step.part, &step.planned, cutting_min);
            told.figures.ideal = found.map_err(|why| why.in_operation(&step.operation.name))?;
        }
        if finishes || step.operation.kind == OperationWord::Rest {
            let contact_length_mm = step.planned.passes.length_mm();
            shares.push(Share { job: &step.job, part: &step.part, contact_length_mm, cutting_min });
        }
        told.figures.productivity = in_time.told(&step.job, part);
        operations.push(told);
    }
    let left_standing = standing::left(list, part, &steps, &whole);
    // The least time for faces says nothing of a part that is left with something on them nobody knows where.
    let known = !left_standing.is_empty() || whole.summary.uncut_area_mm2 <= 0.0;
    let ideal =
        if known { ideal::of_part(&shares, &list.whole().tolerance(), &left_standing)? } else { None };
    wall_s.ideal = stage.end();
    let stage = Stage::begin(watch, "report");
    let hands = steps.iter().zip(&course.sections).map(|(step, section)| {
        let mut tool = fill::tool(&step.job);
        tool.label = format!("{}: T{} {}", step.operation.name, step.job.tool().number(), tool.label);
        (section.motions.start, tool)
    });
    let hands = hands.collect();
    let merged = merged(&steps);
    let all = Times {
        time_min: course.setup_min.iter().sum(),
        cutting_min: operations.iter().map(|o| o.figures.cutting_time_min).sum(),
        on_control_min: Some([course.on_control.time_min, course.on_control.cutting_min]),
        joints: None,
    };
    let job = list.whole();
    let mut summary = summary_of(job, part, &merged, all, &whole)?;
    summary.format = 2;
    summary.productivity = in_time.whole(job, part, course.on_control.time_min);
    // Each operation has a feed, a spindle speed and a tool of its own.
    summary.productivity.slower_share = None;
    summary.productivity.cutting_speed_m_min = None;
    summary.setups = setups(list, &programs, &course);
    let mut diagnostics: Vec<Diagnostic> = part.part.diagnostics.clone();
    diagnostics.extend(notes);
    for step in &steps {
        let own = step.planned.passes.diagnostics.iter().chain(&step.planned.extras.diagnostics);
        diagnostics.extend(own.map(|d| {
            let message = format!("{}: {}", step.operation.name, d.message);
            Diagnostic { message, ..d.clone() }
        }));
    }
    diagnostics.extend(programs.iter().flat_map(|p| p.diagnostics.iter().cloned()));
    diagnostics.extend(course.diagnostics.iter().cloned());
    diagnostics.extend(whole.diagnostics.iter().cloned());
    summary.diagnostics = diagnostics.iter().map(ToString::to_string).collect();
    summary.left_standing = left_standing;
    summary.ideal = ideal;
    let mut tables = vec![table(&operations, &steps)];
    if !summary.left_standing.is_empty() {
        tables.push(standing::table(&summary.left_standing));
    }
    let extras = Extras { tables, ..Extras::default() };
    summary.operations = operations;
    summary.wall_s = wall_s;
    let clamped = course.setups.iter().zip(&programs).map(|(range, p)| (range.start, p.setup)).collect();
    let read = course.into_motions();
    let title = passes::title(job);
    let story = fill::Story {
        title: &title,
        job,
        faces: part,
        passes: &merged.passes,
        linked: &merged.linked,
        verified: &whole,
        summary: &summary,
        diagnostics: &diagnostics,
        time_by_move: &read,
        chain: &job.control().machine,
        setups: clamped,
        hands,
        extras: &extras,
        in_time: &in_time,
    };
    let pages = plan::pages(&story, watch, &|f| stage.at(f));
    let mut files = Vec::new();
    for (k, step) in steps.iter().enumerate() {
        let cl = passes::cl_path(&step.job, &step.planned.linked);
        let text = nc::cl_text(&cl, step.job.tool().number(), &step.operation.name).map_err(Failure::job)?;
        files.push(PlanFile::of_text(format!("path-{}.cl", k + 1), text));
    }
    let of = stock::of_part(list.whole(), part);
    for (k, left) in judged.iter().enumerate().filter_map(|(k, j)| Some((k, j.left.as_ref()?))) {
        let mesh = left.mesh(CUBES);
        files.push(PlanFile { name: format!("stock-{}.stl", k + 1), bytes: mesh.stl() });
        files.push(PlanFile { name: format!("stock-{}.ply", k + 1), bytes: mesh.ply() });
        files.push(PlanFile { name: format!("stock-{}.stock", k + 1), bytes: left.saved(&of) });
    }
    files.push(PlanFile::of_text("job.resolved.toml", list.text_anywhere()));
    if let Some(text) = tool_table(list) {
        files.push(PlanFile::of_text("tool.tbl", text));
    }
    files.extend(programs.into_iter().map(|p| PlanFile::of_text(p.file, p.text)));
    files.extend(pages);
    wall_s.report = stage.end();
    wall_s.total = part.import_s + begin.elapsed().as_secs_f64();
    summary.wall_s = wall_s;
    let text = serde_json::to_string_pretty(&summary).map_err(Failure::job)? + "\n";
    files.push(PlanFile::of_text("summary.json", text));
    Ok(Plan { job: job.clone(), summary, verified: whole, diagnostics, files })
}

/// Times of a stretch of the motions.
fn times(course: &Course, &Range { start, end }: &Range<usize>) -> Times {
    let of = |clock: &[f64]| {
        let at = |k: usize| if k == 0 { 0.0 } else { clock[k - 1] };
        let feeds = (start..end).filter(|k| !course.motions[*k].rapid);
        [at(end) - at(start), feeds.map(|k| at(k + 1) - at(k)).sum()]
    };
    let [time_min, cutting_min] = of(&course.times_min);
    Times { time_min, cutting_min, on_control_min: Some(of(&course.on_control.times_min)), joints: None }
}

fn operation(
    list: &Operations,
    step: &Step<'_>,
    judged: &Judged,
    times: Times,
) -> Result<OperationSummary, Failure> {
    let mut figures = summary_of(&step.job, &step.part, &step.planned, times, &judged.verified)?;
    figures.compared = step.compared.clone();
    figures.wall_s.plan = step.plan_s;
    Ok(OperationSummary {
        name: step.operation.name.clone(),
        kind: step.operation.kind.word(),
        setup: list.setups()[step.operation.setup].name.clone(),
        tool_number: step.job.tool().number(),
        standing_mm: step.standing_mm,
        too_high_mm2: step.too_high_mm2,
        on_faces: step.on_faces.clone(),
        removed_mm3: judged.verified.stock.as_ref().map(|s| s.removed_mm3),
        left_mm3: judged.verified.stock.as_ref().map(|s| s.left_mm3),
        step: match judged.verified.verdict.answer() {
            Answer::Held => "held",
            Answer::NotHeld if judged.verified.verdict.leaves_only() => "leaves some",
            Answer::NotHeld => "NOT held",
            Answer::NotShown => "not shown",
        },
        figures,
    })
}

fn setups(list: &Operations, programs: &[Program], course: &Course) -> Vec<SetupSummary> {
    let all = list.setups().iter().zip(programs).zip(&course.setup_min);
    all.map(|((held, program), time_min)| {
        SetupSummary::of(&held.name, &program.file, *time_min, &program.setup)
    })
    .collect()
}

/// The plans of all operations as one, for pictures.
fn merged(steps: &[Step<'_>]) -> Planned<'static> {
    let (mut passes, mut linked) = (Passes::default(), Linked::default());
    let mut extras = Extras::default();
    let mut names: Vec<&str> = Vec::new();
    for step in steps {
        let before = passes.passes.len() as u32;
        let own = &step.planned;
        passes.passes.extend(own.passes.passes.iter().cloned());
        linked.path.moves.extend(own.linked.path.moves.iter().copied());
        linked.pass_of_move.extend(own.linked.pass_of_move.iter().map(|p| p.map(|p| p + before)));
        linked.cutting_length_mm += own.linked.cutting_length_mm;
        linked.air_length_mm += own.linked.air_length_mm;
        extras.left_out.clear();
        if !names.contains(&own.strategy.as_str()) {
            names.push(&own.strategy);
        }
    }
    let strategy = names.join(", ");
    let skipped = Vec::new();
    Planned {
        passes,
        skipped,
        linked,
        strategy,
        lean: Lean::default(),
        axes: Axes::Held,
        extras,
        with_strips: true,
    }
}

/// The operations with the figures that one compares.
fn table(operations: &[OperationSummary], steps: &[Step<'_>]) -> Table {
    let names = [
        "operation",
        "setup",
        "tool",
        "strategy",
        "rpm",
        "feed mm/min",
        "time min",
        "efficiency %",
        "cut mm",
        "air mm",
        "area mm2",
        "uncut mm2",
        "step",
    ];
    let row = |(o, step): (&OperationSummary, &Step<'_>)| {
        let f: &Summary = &o.figures;
        vec![
            o.name.clone(),
            o.setup.clone(),
            format!("T{} {}", o.tool_number, f.tool_words),
            f.strategy.clone(),
            step.job.spindle_rpm().map_or_else(|| "\u{2013}".to_owned(), |n| number(n, 6)),
            number(step.job.feed_mm_min(), 6),
            format!("{:.2}", f.time_min),
            f.ideal.as_ref().map_or_else(String::new, |i| format!("{:.0}", i.efficiency_percent)),
            format!("{:.0}", f.cutting_length_mm),
            format!("{:.0}", f.air_length_mm),
            format!("{:.1}", f.area_mm2),
            number(f.verification.uncut_area_mm2, 4),
            o.step.to_owned(),
        ]
    };
    Table {
        caption: "Operations, each judged after all before it".to_owned(),
        columns: names.map(|n| Column { name: n.to_owned(), ..Column::default() }).to_vec(),
        rows: operations.iter().zip(steps).map(row).collect(),
    }
}

/// The tool table of a LinuxCNC control.
fn tool_table(list: &Operations) -> Option<String> {
    let job = list.whole();
    if job.control().dialect != Dialect::LinuxCnc {
        return None;
    }
    let mut out = String::new();
    for one in job.each_tool() {
        let n = one.tool().number();
        let (length, diameter) = (nc::gauge_mm(&one), 2.0 * one.cutter().radius_mm());
        let _ = writeln!(out, "T{n} P{n} Z{length:.4} D{diameter:.4} ;{}", one.tool_words());
    }
    Some(out)
}
