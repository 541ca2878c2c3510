//! One program of several paths, each with its own tool.

use crate::machine::Machine;
use crate::nc::Program;
use crate::nc::writer::Writer;
use crate::post::{PostReport, PostSummary, comments, flush, moves_from, program_of};
use crate::post_error::PostError;
use crate::post_options::{PostOptions, check};
use crate::setup::Setup;
use crate::source::MoveSource;
use osculate_geom::Diagnostic;
use osculate_tools::cl::ClPath;
use std::io;

/// A path with its tool.
#[derive(Clone, Debug)]
pub struct Section<'a, S = ClPath> {
    /// What is done, for people: it stands in the program.
    pub name: String,
    /// The path, or another source of its moves.
    pub path: &'a S,
    /// From the spindle's nose to the tip, mm.
    pub gauge_length_mm: f64,
    /// Tool, speed, tolerances. Dialect, feed and orientation are the same in all sections; name, number and work offset of the
    /// program are those of the first.
    pub options: PostOptions,
}

/// A program of several sections.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PostedSections {
    /// The program.
    pub text: String,
    /// The figures of each section; the way from one to the next is in none of them.
    pub sections: Vec<PostSummary>,
    /// Findings, with the name of their section.
    pub diagnostics: Vec<Diagnostic>,
}

/// Posts paths as one program. Between two of them the tool goes to the machine's own end of Z, everything is switched off, the next
/// tool is called with its length, speed and coolant, and every word is said again, whether the tool is another or not. The head of the
/// program lists tools and sections, and each section is named where it begins, one alone too.
///
/// ```
/// use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Section, Setup, cldata, post_sections};
///
/// let face = cldata::read("SPINDL/3000,CLW\nRAPID\nGOTO/0,0,5\nFEDRAT/800\nGOTO/50,0,0\nFINI\n")?.path;
/// let edge = cldata::read("SPINDL/9000,CLW\nRAPID\nGOTO/0,9,5\nFEDRAT/300\nGOTO/50,9,0\nFINI\n")?.path;
/// let with = |name: &str, path, tool_number, gauge_length_mm| Section {
///     name: name.to_owned(),
///     path,
///     gauge_length_mm,
///     options: PostOptions { tool_number, ..PostOptions::new(Dialect::Fanuc, FeedMode::InverseTime) },
/// };
/// let sections = [with("face", &face, 1, 120.0), with("edge", &edge, 2, 80.0)];
/// let posted = post_sections(&sections, &Machine::built_in("3-axis")?, &Setup::default())?;
/// assert_eq!(posted.sections.len(), 2);
/// // Each tool is called with its own length offset.
/// assert!(["T1", "H1", "T2", "H2", "S3000", "S9000"].iter().all(|word| posted.text.contains(word)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`post()`](crate::post()), and where there is no section or sections differ in what a program has once.
pub fn post_sections(
    sections: &[Section<'_>],
    machine: &Machine,
    setup: &Setup,
) -> Result<PostedSections, PostError> {
    let spoken: Vec<Section<'_>> = sections
        .iter()
        .map(|s| {
            let spindle_rpm = s.options.spindle_rpm.or(s.path.spindle_rpm);
            Section { options: PostOptions { spindle_rpm, ..s.options.clone() }, ..s.clone() }
        })
        .collect();
    let mut text = Vec::new();
    let reports = post_sections_to(&spoken, machine, setup, &mut text).map_err(|e| e.error)?;
    let mut diagnostics = Vec::new();
    for (section, report) in sections.iter().zip(&reports) {
        diagnostics.extend(report.diagnostics.iter().cloned().map(|mut d| {
            if sections.len() > 1 {
                d.message = format!("{}: {}", section.name, d.message);
            }
            d
        }));
    }
    let text = String::from_utf8(text).expect("the pieces are text");
    Ok(PostedSections { text, sections: reports.iter().map(|r| r.summary).collect(), diagnostics })
}

/// Why sections cannot be posted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{error}")]
#[non_exhaustive]
pub struct SectionError {
    /// Which one is at fault, from 0.
    pub section: usize,
    /// What is the matter; its moves count from the beginning of the section.
    pub error: PostError,
}

/// As [`post_sections`], of any sources of moves, with the text going to `sink` as [`post_to`](crate::post_to()) gives it; the speeds are
/// those of the options. What became of each section.
///
/// # Errors
/// As [`post_sections`], and where a source fails or the sink takes no more.
pub fn post_sections_to<S: MoveSource>(
    sections: &[Section<'_, S>],
    machine: &Machine,
    setup: &Setup,
    sink: &mut dyn io::Write,
) -> Result<Vec<PostReport>, SectionError>
where
    PostError: From<S::Error>,
{
    let of = |section: usize| move |error: PostError| SectionError { section, error };
    let Some(first) = sections.first() else { return Err(of(0)(PostError::NoSection)) };
    let own: Vec<PostOptions> = sections
        .iter()
        .map(|s| PostOptions {
            program_name: first.options.program_name.clone(),
            program_number: first.options.program_number,
            work_offset: first.options.work_offset,
            blank_mm: first.options.blank_mm,
            ..s.options.clone()
        })
        .collect();
    for (k, options) in own.iter().enumerate() {
        check(options).map_err(of(k))?;
        let once = |o: &PostOptions| (o.dialect, o.feed, o.orientation, o.subprogram);
        if once(options) != once(&own[0]) {
            return Err(of(k)(PostError::Sections { section: k + 1, name: sections[k].name.clone() }));
        }
    }
    let stands = |s: &Section<'_, S>| Setup { gauge_length_mm: s.gauge_length_mm, ..*setup };
    let programs: Vec<Program> = sections
        .iter()
        .zip(&own)
        .enumerate()
        .map(|(k, (section, options))| {
            let mut said = Vec::new();
            if k == 0 {
                said = comments(machine, &stands(section), options);
                said.extend(listed(sections));
            }
            said.push(heading(k, section));
            program_of(machine, setup, options, said)
        })
        .collect();
    let mut programs = programs;
    for k in 1..programs.len() {
        let next = programs[k].tool_number;
        let ready = own[k - 1].preselect && next != programs[k - 1].tool_number;
        programs[k - 1].next_tool = ready.then_some(next);
    }
    let mut writer = Writer::new(first.options.dialect, &programs[0]).map_err(|e| of(0)(e.into()))?;
    let mut reports = Vec::with_capacity(sections.len());
    for (k, (section, program)) in sections.iter().zip(&programs).enumerate() {
        if k > 0 {
            writer.change(program).map_err(|e| of(k)(e.into()))?;
        }
        let setup = stands(section);
        let report = moves_from(section.path, machine, &setup, (&own[k], program), &mut writer, sink);
        reports.push(report.map_err(of(k))?);
    }
    writer.finish();
    flush(&mut writer, sink).map_err(of(sections.len() - 1))?;
    Ok(reports)
}

/// What a section does, as the program says where it begins.
fn heading<S>(k: usize, section: &Section<'_, S>) -> String {
    format!("operation {}: {}, T{}", k + 1, section.name, section.options.tool_number)
}

/// The tools in the order in which they are called first, with what they are for.
fn listed<S>(sections: &[Section<'_, S>]) -> Vec<String> {
    let mut out: Vec<(u32, String)> = Vec::new();
    if sections.len() < 2 {
        return Vec::new();
    }
    for (k, section) in sections.iter().enumerate() {
        let number = section.options.tool_number;
        match out.iter_mut().find(|t| t.0 == number) {
            Some(tool) => tool.1 += &format!(", {}", k + 1),
            None => {
                let length = section.gauge_length_mm;
                out.push((number, format!("tool T{number}, gauge length {length:.4}, operations {}", k + 1)));
            }
        }
    }
    out.into_iter().map(|t| t.1).collect()
}
