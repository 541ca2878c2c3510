//! `init`: a first job for a part.

use crate::screen::args::InitArgs;
use crate::screen::{output, render};
use osculate::failure::{Done, Failure, Outcome};
use osculate::job::library::Library;
use osculate::words::findings;
use osculate::work::init::{First, Wanted, init};
use osculate::work::nc;
use std::path::{Path, PathBuf};

/// Runs the verb.
pub fn run(options: &InitArgs, json: bool) -> Outcome {
    output::folder(&options.out)?;
    let job = options.out.join("job.toml");
    if job.exists() {
        return Err(Failure::file(&job, "is there already: give another --out, or take it away"));
    }
    let library = options.tools.as_deref().map_or_else(Library::shipped, Library::load)?;
    let name = options.tools.as_deref().map_or_else(|| "the tools of the program".to_owned(), words);
    let machine = nc::machine(&options.machine)?;
    let file = beside(&options.machine, &options.out);
    let first = init(&Wanted {
        part: &options.part,
        job: &job,
        faces: &options.faces,
        machine: &file,
        on: &machine,
        tools: (&library, &name),
    })?;
    output::set(&options.out, &[("job.toml", first.text.as_bytes()), ("faces.html", first.page.as_bytes())])?;
    if json {
        let findings: Vec<String> = first.diagnostics.iter().map(ToString::to_string).collect();
        render::json(&serde_json::json!({
            "job": job.display().to_string(),
            "page": options.out.join("faces.html").display().to_string(),
            "faces": first.faces,
            "chosen": first.told,
            "diagnostics": findings,
        }))?;
    } else {
        render::text(&describe(&first, &job, &options.out))?;
    }
    Ok(Done::Yes)
}

fn words(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

/// A machine file as a job in another folder names it; a built-in name stays.
fn beside(machine: &str, folder: &Path) -> String {
    if !machine.ends_with(".toml") {
        return machine.to_owned();
    }
    let to: PathBuf = osculate::work::init::relative(Path::new(machine), &folder.join("job.toml"));
    to.to_string_lossy().into_owned()
}

fn describe(first: &First, job: &Path, out: &Path) -> String {
    let mut text = String::from("\n");
    for line in &first.told {
        text.push_str(&format!("  {line}\n"));
    }
    if !first.diagnostics.is_empty() {
        text.push_str(&format!("\n{}", findings(&first.diagnostics)));
    }
    let (job, plan) = (job.display(), out.join("plan").display().to_string());
    text.push_str(&format!("\n  {job}\n  {}: the faces with their ids\n  next: osculate check {job}; osculate plan {job} --out {plan}\n\n", out.join("faces.html").display()));
    text
}
