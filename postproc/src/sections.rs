//! One program of several paths, each with its own tool.

use crate::machine::Machine;
use crate::nc::Program;
use crate::nc::writer::Writer;
use crate::post::{PostSummary, comments, flush, moves_from, program_of};
use crate::post_error::PostError;
use crate::post_options::{PostOptions, check};
use crate::setup::Setup;
use osculate_geom::Diagnostic;
use osculate_tools::cl::ClPath;
use std::io;

/// A path with its tool.
#[derive(Clone, Debug)]
pub struct Section<'a> {
    /// What is done, for people: it stands in the program.
    pub name: String,
    /// The path.
    pub path: &'a ClPath,
    /// From the spindle's nose to the tip, mm.
    pub gauge_length_mm: f64,
    /// Tool, speed, tolerances. Dialect, feed and orientation are the same in all sections; name, number and work offset of the
    /// program are those of the first.
    pub options: PostOptions,
}

/// A program of several sections.
#[derive(Clone, Debug, PartialEq)]
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
/// # Errors
/// As [`post()`](crate::post()), and where there is no section or sections differ in what a program has once.
pub fn post_sections(
    sections: &[Section<'_>],
    machine: &Machine,
    setup: &Setup,
) -> Result<PostedSections, PostError> {
    let Some(first) = sections.first() else { return Err(PostError::NoSection) };
    let own: Vec<PostOptions> = sections
        .iter()
        .map(|s| PostOptions {
            spindle_rpm: s.options.spindle_rpm.or(s.path.spindle_rpm),
            program_name: first.options.program_name.clone(),
            program_number: first.options.program_number,
            work_offset: first.options.work_offset,
            ..s.options.clone()
        })
        .collect();
    for (k, options) in own.iter().enumerate() {
        check(options)?;
        let once = |o: &PostOptions| (o.dialect, o.feed, o.orientation, o.subprogram);
        if once(options) != once(&own[0]) {
            return Err(PostError::Sections { section: k + 1, name: sections[k].name.clone() });
        }
    }
    let stands = |s: &Section<'_>| Setup { gauge_length_mm: s.gauge_length_mm, ..*setup };
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
            program_of(machine, options, said)
        })
        .collect();
    let mut text = Vec::new();
    let sink: &mut dyn io::Write = &mut text;
    let mut writer = Writer::new(first.options.dialect, &programs[0])?;
    let (mut summaries, mut diagnostics) = (Vec::with_capacity(sections.len()), Vec::new());
    for (k, (section, program)) in sections.iter().zip(&programs).enumerate() {
        if k > 0 {
            writer.change(program)?;
        }
        let setup = stands(section);
        let report = moves_from(section.path, machine, &setup, (&own[k], program), &mut writer, sink)?;
        summaries.push(report.summary);
        let named = report.diagnostics.into_iter().map(|mut d| {
            if sections.len() > 1 {
                d.message = format!("{}: {}", section.name, d.message);
            }
            d
        });
        diagnostics.extend(named);
    }
    writer.finish();
    flush(&mut writer, sink)?;
    let text = String::from_utf8(text).expect("the pieces are text");
    Ok(PostedSections { text, sections: summaries, diagnostics })
}

/// What a section does, as the program says where it begins.
fn heading(k: usize, section: &Section<'_>) -> String {
    format!("operation {}: {}, T{}", k + 1, section.name, section.options.tool_number)
}

/// The tools in the order in which they are called first, with what they are for.
fn listed(sections: &[Section<'_>]) -> Vec<String> {
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
