//! `check`: what fits of a job, and what is not reached or not set, without planning.

use crate::screen::progress::SCREEN;
use crate::screen::render;
use osculate::Part;
use osculate::failure::{Done, Outcome, read_text};
use osculate::job::{Job, Operations};
use osculate::words::{self, Table, number};
use osculate::work::reached::{Checked, of_job, of_list};
use osculate::work::{operations, plan};
use std::path::Path;

/// Unreached faces that a line lists at most.
const LISTED: usize = 6;

/// Runs the verb.
pub fn run(path: &Path, json: bool) -> Outcome {
    let text = read_text(path)?;
    let checked = if Operations::are_in(&text) {
        let (part, list) = operations::part(Operations::from_toml(&text, path)?, &SCREEN)?;
        of_list(&list, &part)?
    } else {
        let job = Job::from_toml(&text, path)?;
        plan::check(&job)?;
        of_job(&job, &Part::watched(&job, &SCREEN)?)?
    };
    if json {
        render::json(&checked)?;
    } else {
        render::text(&describe(&checked))?;
    }
    Ok(if checked.fits() { Done::Yes } else { Done::NotWithinTolerance })
}

fn describe(c: &Checked) -> String {
    let mut t = Table::left(["operation", "tool", "reaches mm2", "of mm2", "not reached"]);
    for r in &c.reached {
        let unreached: Vec<String> =
            r.unreached.iter().map(|(id, mm2)| format!("{id} {}", number(*mm2, 3))).collect();
        let name = if r.operation.is_empty() { "the job".to_owned() } else { r.operation.clone() };
        t.row([
            name,
            r.tool.clone(),
            number(r.reached_mm2, 4),
            number(r.area_mm2, 4),
            words::listed(&unreached, LISTED),
        ]);
    }
    let mut out = format!("\n  {} faces to machine, {} others\n\n{}\n", c.faces[0], c.faces[1], t.render());
    for what in &c.unset {
        out.push_str(&format!("  not set: {what}\n"));
    }
    for what in &c.diagnostics {
        out.push_str(&format!("  {what}\n"));
    }
    let areas = [c.unreached_mm2, c.accepted_mm2].map(|x| number(x, 3));
    out.push_str(&if c.fits() {
        format!("\n  fits: about {} mm2 are not reached, of {} mm2 that the job accepts\n\n", areas[0], areas[1])
    } else {
        format!(
            "\n  does NOT fit: about {} mm2 are not reached, but the job accepts {}: take a smaller or longer tool, other axes, or say \
             unreached_mm2 in [tolerance]\n\n",
            areas[0], areas[1]
        )
    });
    out
}
