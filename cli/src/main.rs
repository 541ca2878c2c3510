//! `osculate`: plan, verify and post multi-axis NC machining of free-form surfaces.
//!
//! Exit codes: 0 done, 1 the job cannot be done as asked, 2 wrong usage. Results go to stdout (`--json`: one object
//! and nothing else), messages and progress to stderr.

mod cmd;
mod screen;

use clap::Parser;
use osculate::failure::{Done, Failure, Outcome};
use screen::args::{Cli, ToolsArgs, Verb};
use screen::{cancel, progress};
use std::process::ExitCode;

/// Exit code of a finished command whose result is not within tolerance.
const NOT_WITHIN: u8 = 1;

fn run(cli: &Cli) -> Outcome {
    match &cli.verb {
        Verb::Inspect(options) => cmd::inspect::run(options, cli.json),
        Verb::Init(options) => cmd::init::run(options, cli.json),
        Verb::Check { job } => cmd::check::run(job, cli.json),
        Verb::Export(options) => cmd::export::run(options, cli.json),
        Verb::Probe { part, face, at } => cmd::probe::run(part, face.as_deref(), at, cli.json),
        Verb::Lines(options) => cmd::lines::run(options, cli.json),
        Verb::Strip { job, out } => cmd::strip::run(job, out.as_deref(), cli.json),
        Verb::Compare { job, out, nodes } => {
            cmd::compare::run(job, out.as_deref(), *nodes as usize, cli.json)
        }
        Verb::Axes(options) => cmd::axes::run(options, cli.json),
        Verb::Plan { job, out } => cmd::plan::run(job, out, cli.json),
        Verb::Sweep(args) => cmd::sweep::run(args, cli.json),
        Verb::Flank { job, out, largest_tool } => {
            cmd::flank::run(job, (out.as_deref(), *largest_tool), cli.json)
        }
        Verb::Post(options) => cmd::post::run(options, cli.json),
        Verb::Verify { files, job, lenient, second_opinion, ply, blocks, data } => cmd::verify::run(
            files,
            job,
            &cmd::verify::Options {
                lenient: *lenient,
                second_opinion: *second_opinion,
                ply: ply.as_deref(),
                blocks: blocks.as_deref(),
                data: data.as_deref(),
            },
            cli.json,
        ),
        Verb::Time(args) => cmd::time::run(args, cli.json),
        Verb::Readback(args) => cmd::readback::run(args, cli.json),
        Verb::Machines { check: None } => cmd::list::machines(cli.json),
        Verb::Machines { check: Some(word) } => cmd::list::check_machine(word, cli.json),
        Verb::Dialects => cmd::list::dialects(cli.json),
        Verb::Tools(ToolsArgs { library: None, .. }) => cmd::list::tools(cli.json),
        Verb::Tools(args) => cmd::tools::run(args, cli.json),
        Verb::Gallery => cmd::gallery::run(cli.json),
        Verb::Keys { schema: true, .. } => cmd::keys::schema(),
        Verb::Keys { template, .. } => cmd::keys::run(*template, cli.json),
        Verb::Completions { shell } => cmd::complete::completions(*shell),
        Verb::Man { out } => cmd::complete::man(out),
    }
}

fn main() -> ExitCode {
    // Wrong usage ends here with clap's own message and exit code 2; --help and --version with 0 where they can be printed.
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(asked) if asked.use_stderr() => {
            if std::env::args_os().any(|word| word == "--json") {
                let _ = screen::render::json(&serde_json::json!({ "error": screen::usage::problem(&asked) }));
            }
            asked.exit()
        }
        Err(asked) => match screen::render::text(&asked.render().to_string()) {
            Ok(()) => return ExitCode::SUCCESS,
            Err(f) => return failed(&f),
        },
    };
    progress::SCREEN.lines(cli.progress);
    progress::SCREEN.quiet(cli.quiet);
    screen::render::speak(!cli.quiet, &cli.color);
    if let Err(why) = cancel::watch() {
        screen::render::complaint(&format!("an interrupt will end this run without a word: {why}"));
    }
    match run(&cli) {
        Ok(Done::Yes) => ExitCode::SUCCESS,
        Ok(Done::NotWithinTolerance | Done::Incomplete) => ExitCode::from(NOT_WITHIN),
        Err(f) => {
            if cli.json {
                // A failure to print it leaves the message on stderr.
                let _ = screen::render::json(&serde_json::json!({ "error": f.problem() }));
            }
            failed(&f)
        }
    }
}

/// Says why a command ended, and gives its exit code.
fn failed(why: &Failure) -> ExitCode {
    screen::render::complaint(why.message());
    ExitCode::from(why.code())
}
