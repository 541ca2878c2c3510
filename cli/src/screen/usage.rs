//! A command line that cannot be meant, in parts, for programs.

use clap::error::{ContextKind, ContextValue};
use osculate::job::problem::Problem;

/// What clap found, where, what may stand there and what is nearest.
pub fn problem(found: &clap::Error) -> Problem {
    let text = found.to_string();
    // What follows an empty line are hints and the usage, for a person.
    let lines: Vec<&str> = text.lines().map(str::trim).take_while(|l| !l.is_empty()).collect();
    let what = lines.join(" ").trim_start_matches("error: ").to_owned();
    let one_of =
        |kinds: &[ContextKind]| kinds.iter().find_map(|kind| found.get(*kind)).map(words).unwrap_or_default();
    let place = one_of(&[ContextKind::InvalidArg, ContextKind::InvalidSubcommand]);
    let expected = one_of(&[ContextKind::ValidValue, ContextKind::ValidSubcommand]);
    let nearest =
        one_of(&[ContextKind::SuggestedArg, ContextKind::SuggestedValue, ContextKind::SuggestedSubcommand]);
    Problem { message: what.clone(), what, place, expected, nearest }
}

fn words(value: &ContextValue) -> String {
    match value {
        ContextValue::String(one) => one.clone(),
        ContextValue::Strings(all) => all.join(", "),
        other => other.to_string(),
    }
}
