//! What a person needs beside the machine: how the part is set up, which tools are in the magazine, and when each is in hand.
//!
//! Frame: the table's, as the control counts; a turn is about the table's fixed axes, x first, then y, then z. Lengths mm.

use super::data::{Column, Table};
use crate::job::Job;
use crate::words::number;
use crate::work::summary::{SetupSummary, Summary};
use osculate_postproc::nc::Coolant;
use osculate_tools::removal::ScopeRow;

/// The setup sheet: one table of pairs for each setup.
#[must_use]
pub fn setups(job: &Job, summary: &Summary, scope: &[ScopeRow]) -> Vec<Table> {
    summary.setups.iter().map(|setup| one_setup(job, summary, setup, scope)).collect()
}

fn one_setup(job: &Job, summary: &Summary, setup: &SetupSummary, scope: &[ScopeRow]) -> Table {
    let covers = |what: &str| {
        scope
            .iter()
            .find(|row| row.what == what)
            .map_or_else(|| "not declared".to_owned(), |r| r.covers.clone())
    };
    let [x, y, z] = setup.part_zero_mm.map(|c| format!("{:.4}", c + 0.0));
    let several = summary.setups.len() > 1;
    let by_f = format!("{:.2} min by F", setup.time_min);
    // The control's time is known of all programs together.
    let time = match summary.control_time_min {
        Some(min) if !several => format!("{min:.2} min on the control, {by_f}"),
        _ => by_f,
    };
    let mut rows = vec![
        ("program", setup.program.clone()),
        ("machine, control", format!("{}, {}, feed {}", summary.machine, summary.dialect, summary.feed)),
        ("work offset", job.work_offset().unwrap_or("that of the control").to_owned()),
        ("part's origin from the table's point", format!("X {x}  Y {y}  Z {z}")),
        ("orientation", turns(setup.rotate_deg)),
        ("raw material", covers("raw material")),
        ("fixtures", covers("fixtures")),
        (
            "rapids and approach",
            format!(
                "{} mm over the part, feed from {} mm above it",
                number(job.setup().clearance_mm, 4),
                number(job.setup().approach_mm, 4)
            ),
        ),
        ("time", time),
    ];
    if let Some(n) = job.program_number() {
        rows.insert(1, ("program number", n.to_string()));
    }
    let rows = rows.into_iter().map(|(key, value)| vec![key.to_owned(), value]).collect();
    let caption = if several { format!("Setup sheet: {}", setup.name) } else { "Setup sheet".to_owned() };
    Table { caption, columns: Vec::new(), rows }
}

/// Three turns about named axes in words.
fn turns(rotate_deg: [f64; 3]) -> String {
    let told: Vec<String> = ["X", "Y", "Z"]
        .iter()
        .zip(rotate_deg)
        .filter(|(_, deg)| deg.abs() > 5e-4)
        .map(|(axis, deg)| format!("{deg:.3}\u{b0} about {axis}"))
        .collect();
    if told.is_empty() {
        "as in its file".to_owned()
    } else {
        format!("turned {}, about the table's axes", told.join(", then "))
    }
}

/// The tools, each with its sizes, what it stands out of the holder, and what it turns and feeds with.
#[must_use]
pub fn tools(job: &Job) -> Table {
    let column = |name: &str, unit: &str| Column { name: name.to_owned(), unit: unit.to_owned() };
    let columns = vec![
        column("tool", ""),
        column("name", ""),
        column("kind", ""),
        column("diameter", "mm"),
        column("corner", "mm"),
        column("out of the holder", "mm"),
        column("teeth", ""),
        column("spindle", "rpm"),
        column("feed", "mm/min"),
        column("coolant", ""),
        column("holder", ""),
    ];
    let row = |one: &Job| {
        let (tool, cutter) = (one.tool(), one.cutter());
        // A plan may go slower than its job lets the tool in hand go.
        let fed = if tool.number() == job.tool().number() { job } else { one };
        vec![
            format!("T{}", tool.number()),
            one.tool_words(),
            tool.kind().word().to_owned(),
            number(2.0 * cutter.radius_mm(), 5),
            number(cutter.corner_mm(), 5),
            number(cutter.length_mm(), 5),
            tool.teeth().map_or_else(|| "\u{2013}".to_owned(), |n| n.to_string()),
            one.spindle_rpm().map_or_else(|| "\u{2013}".to_owned(), |n| number(n, 6)),
            number(fed.feed_mm_min(), 6),
            match one.coolant() {
                None => "none",
                Some(Coolant::Flood) => "flood",
                Some(Coolant::Mist) => "mist",
            }
            .to_owned(),
            holder(one),
        ]
    };
    Table { caption: "Tools".to_owned(), columns, rows: job.each_tool().iter().map(row).collect() }
}

/// The sections of a holder from its nose upwards.
fn holder(job: &Job) -> String {
    let sections: Vec<String> = job
        .tool()
        .holder_sections()
        .iter()
        .map(|h| {
            let upper = h.upper_diameter_mm.filter(|d| *d != h.diameter_mm);
            let upper = upper.map(|d| format!(" to {}", number(d, 4))).unwrap_or_default();
            format!("\u{2300} {}{upper} x {}", number(h.diameter_mm, 4), number(h.length_mm, 4))
        })
        .collect();
    if sections.is_empty() { "none declared".to_owned() } else { sections.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_named_in_their_order() {
        assert_eq!(turns([0.0, -0.0, 0.0]), "as in its file");
        assert_eq!(
            turns([90.0, 0.0, -12.5]),
            "turned 90.000\u{b0} about X, then -12.500\u{b0} about Z, about the table's axes"
        );
    }
}
