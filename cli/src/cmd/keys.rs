//! `keys`: the reference of all keys of a job file, and a commented job to begin with.

use crate::screen::render;
use osculate::failure::{Done, Outcome};
use osculate::job::{Job, reference};

/// Runs the verb.
pub fn run(template: bool, json: bool) -> Outcome {
    match (template, json) {
        (true, false) => render::text(&reference::template(Job::schema())),
        (false, false) => render::text(&reference::text(Job::schema())),
        (true, true) => {
            let text = reference::template(Job::schema());
            render::json(&serde_json::json!({ "template": text }))?;
        }
        (false, true) => render::json(&serde_json::json!({ "keys": reference::rows(Job::schema()) }))?,
    }
    Ok(Done::Yes)
}
