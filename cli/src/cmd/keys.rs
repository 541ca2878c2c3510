//! `keys`: the reference of all keys of a job file, and a commented job to begin with.

use crate::screen::render;
use osculate::failure::{Done, Outcome};
use osculate::job::{Job, Operations, editor, reference};

/// Runs the verb.
pub fn run(template: bool, json: bool) -> Outcome {
    let (one, list) = (&Job::schema().tables, &Operations::schema().tables);
    match (template, json) {
        (true, false) => render::text(&reference::template(one))?,
        (false, false) => {
            render::text(&reference::text(one))?;
            render::text("\nA list of operations (format = 2) has these tables:\n")?;
            render::text(&reference::text(list))?;
        }
        (true, true) => render::json(&serde_json::json!({ "template": reference::template(one) }))?,
        (false, true) => {
            let (keys, operations) = (reference::rows(one), reference::rows(list));
            render::json(&serde_json::json!({ "keys": keys, "operations": operations }))?;
        }
    }
    Ok(Done::Yes)
}

/// Prints the JSON schema of job files.
pub fn schema() -> Outcome {
    render::json(&editor::schema(&[Job::schema(), Operations::schema()]))?;
    Ok(Done::Yes)
}
