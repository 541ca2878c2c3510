//! `completions`, `man`: what a shell and a manual know of the command line, made of the arguments themselves.

use crate::screen::args::Cli;
use crate::screen::{output, render};
use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;
use osculate::failure::{Done, Failure, Outcome};
use std::path::Path;

/// Prints a script that completes verbs and options.
pub fn completions(shell: Shell) -> Outcome {
    let mut out = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "osculate", &mut out);
    render::text(&String::from_utf8_lossy(&out))?;
    Ok(Done::Yes)
}

/// Writes a page for the program and one for each verb.
pub fn man(folder: &Path) -> Outcome {
    output::folder(folder)?;
    let mut whole = Cli::command();
    whole.build();
    let page = |command: clap::Command, name: &str| -> Result<(), Failure> {
        let mut out = Vec::new();
        Man::new(command).render(&mut out).map_err(Failure::job)?;
        output::write(&folder.join(format!("{name}.1")), &out)
    };
    for verb in whole.get_subcommands().filter(|v| v.get_name() != "help") {
        page(verb.clone(), verb.get_display_name().unwrap_or(verb.get_name()))?;
    }
    page(whole, "osculate")?;
    Ok(Done::Yes)
}
