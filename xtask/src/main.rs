//! The workspace's own commands: `cargo xtask test`, `cargo xtask tidy`, `cargo xtask api`, `cargo xtask ci`,
//! `cargo xtask bench`, `cargo xtask reference`, `cargo xtask figures`, `cargo xtask first-hour`, `cargo xtask browser`, `cargo xtask plans`,
//! `cargo xtask control`, `cargo xtask mutate`, `cargo xtask fuzz`, `cargo xtask package`, `cargo xtask truth` and `cargo xtask sides`.
//!
//! Exit status as everywhere in this workspace: 0 done, 1 something was found or failed, 2 wrong usage.

// A command of developers talks to its terminal; the ban on printing is for the libraries.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod api;
mod bench;
mod browser;
mod ci;
mod cmd;
mod control;
mod figures;
mod first_hour;
mod fuzz;
mod interop;
mod measured;
mod mutate;
mod own;
mod package;
mod parts;
mod plans;
mod test;
mod tidy;

use std::process::ExitCode;

/// What is printed for a missing or unknown command.
const USAGE: &str = "\
usage: cargo xtask COMMAND

  test [ARGS]   every test of the workspace, doctests included; ARGS go to `cargo test`
  interop [occt FILES | occt --time FILE]
                our exports of the example parts (or FILES) read by OpenCASCADE: faces, kinds, areas, validity;
                --time: its reading of a STEP file beside ours, the best of seven
  tidy          the rules of the workspace that neither the compiler nor clippy checks
  interop linuxcnc
                LinuxCNC's interpreter and kinematics, and pygcode, on our programs (Debian: apt-get, dpkg, gcc, pip), and LinuxCNC
                itself on its sample machines where it can be run (root, tcl8.6, python3.11)
  interop simulation
                LinuxCNC itself alone: a program with three tools, limits on, to the end
  interop roundtrip
                CL to NC and back on a real blade, for every machine, dialect and feed mode: a table of what is off
  ci            formatting, tidy, public items, clippy, WebAssembly, documentation and tests; stops at the first failure
  api [--bless | --count]
                the public items of each package, from the sources, compared with those in api; --bless keeps them, --count counts them
  package [--allow-dirty] [--only PACKAGE]
                the packages as a registry would get them: packed, built, unpacked elsewhere and their tests run there; a table
  bench [--peers]
                times of the kernel; with --peers OpenCASCADE and SISL beside them (Debian: g++, libocct-*-dev, libsisl-dev)
  reference [--data FOLDER]
                the kernel against reference vectors and samples to 1e-12 and 1e-9
  papers [r97] [m86] [z17] [d98]
                the pages of papers in docs/papers, all where none is named: r97 and m86, with docs/closed-forms.md, closed forms of strip
                width against the exact strip; z17 the feed modes side by side on a real blade, with plots of K and F by block; d98 the
                values, errata and figures, ours beside theirs
  plans --data FOLDER [--where] [--only TEXT] [--program FILE]
                docs/plans.md: real faces of a reference collection planned by auto, isoparametric and ball isoplanar; --where by auto
                alone, and the examples that are whole parts: where their time goes
  plans --speed [--only TEXT] [--program FILE]
                seconds and memory of planning: a plane by every strategy, auto over five tools, a million points
  control [--only TEXT] [--posts yes|no] [--program FILE]
                docs/control-time.md: programs on LinuxCNC's own motion planner, in servo cycles, beside what plan and time say, and feed
                modes of the same path with what they ask of the joints (Debian: apt-get, dpkg, gcc, tcl8.6, python3.11, root)
  parts [--only TEXT] [--program FILE]
                docs/parts.md: the examples that are whole parts, from the block to finished, planned and verified
  own [--only TEXT] [--program FILE]
                docs/papers/own-parts.md: what the papers' quantities are for real parts, with pictures
  first-hour --data FOLDER [--only TEXT] [--program FILE] [--limit S]
                docs/first-hour.md: eleven real parts of a reference collection by init, check and plan, no key changed
  browser [--only TEXT] [--program FILE] [--report FILE] [--bless]
                reports of three parts in a real browser (Debian: apt-get install chromium): what they show and do, pictures
                below target/browser, held against xtask/browser/golden.json; --report looks at another one
  mutate --data FOLDER [--count N] [--seed S] [--program FILE] [--keep FOLDER]
                damaged files of every kind that is read, of a reference collection and of the examples, given to the verbs
                below 20 s and 2 GiB: panics, signals, runs out of bounds and success with nonsense
  fuzz [--seconds N] [--only TEXT]
                the targets of fuzz/, built by the nightly compiler, N seconds each (60): panics, inputs beyond 20 s and 2 GiB
  figures       the figures of the gallery: docs/figures and docs/gallery.md
  truth [ARGS]  every STEP and IGES file of a reference collection read and compared with another kernel's answers:
                --data FOLDER [--only TEXT] [--all] [--json] [--malformed]
  sides --data FOLDER
                the sides of all parts of a reference collection, found without the word of their files, as a table: beside that word,
                volumes of another kernel and rays through triangles; FILE... instead tells the groups of single files";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        ["test", rest @ ..] => test::run(rest),
        ["tidy"] => tidy::run(),
        ["ci"] => ci::run(),
        ["api", rest @ ..] => match api::Action::of(rest) {
            Some(action) => api::run(action),
            None => return wrong_usage("api takes nothing, --bless or --count"),
        },
        ["interop", "linuxcnc"] => interop::linuxcnc(),
        ["interop", "simulation"] => interop::simulation(),
        ["interop", "roundtrip"] => postproc_example("roundtrip", &[]),
        ["bench"] => bench::run(false),
        ["bench", "--peers"] => bench::run(true),
        ["reference", rest @ ..] => example("reference", rest),
        ["truth", rest @ ..] => example("truth", rest),
        ["sides", rest @ ..] if !rest.is_empty() => example("sides", rest),
        ["papers", rest @ ..] => match rest.iter().find(|p| !PAPERS.contains(p)) {
            None => papers(if rest.is_empty() { &PAPERS } else { rest }),
            Some(other) => return wrong_usage(&format!("papers are {}, not {other}", PAPERS.join(", "))),
        },
        ["plans", rest @ ..] => match plans::Options::of(rest) {
            Some(options) => plans::run(&options),
            None => {
                return wrong_usage(
                    "plans takes --data FOLDER, --where, --only TEXT and --program FILE; with --speed neither --data nor --where",
                );
            }
        },
        ["parts", rest @ ..] => match parts::Options::of(rest) {
            Some(options) => parts::run(&options),
            None => return wrong_usage("parts takes --only TEXT and --program FILE"),
        },
        ["control", rest @ ..] => match control::Options::of(rest) {
            Some(options) => control::run(&options),
            None => return wrong_usage("control takes --only TEXT and --program FILE"),
        },
        ["own", rest @ ..] => match parts::Options::of(rest) {
            Some(options) => own::run(&options),
            None => return wrong_usage("own takes --only TEXT and --program FILE"),
        },
        ["first-hour", rest @ ..] => match first_hour::Options::of(rest) {
            Some(options) => first_hour::run(&options),
            None => {
                return wrong_usage(
                    "first-hour takes --data FOLDER, --only TEXT, --program FILE and --limit SECONDS",
                );
            }
        },
        ["browser", rest @ ..] => match browser::Options::of(rest) {
            Some(options) => browser::run(&options),
            None => {
                return wrong_usage("browser takes --only TEXT, --program FILE, --report FILE and --bless");
            }
        },
        ["mutate", rest @ ..] => match mutate::Options::of(rest) {
            Some(options) => mutate::run(&options),
            None => {
                return wrong_usage(
                    "mutate takes --data FOLDER, --count N, --seed S, --program FILE and --keep FOLDER",
                );
            }
        },
        ["package", rest @ ..] => match package::Options::of(rest) {
            Some(options) => package::run(&options),
            None => return wrong_usage(package::TAKES),
        },
        ["fuzz", rest @ ..] => match fuzz::Options::of(rest) {
            Some(options) => fuzz::fuzz(&options),
            None => return wrong_usage("fuzz takes --seconds N and --only TEXT"),
        },
        ["figures"] => figures::run(),
        ["interop"] => interop::occt(&[]),
        ["interop", "occt", rest @ ..] => interop::occt(rest),
        ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            Ok(())
        }
        [] => return wrong_usage("no command given"),
        [command @ ("tidy" | "ci" | "figures"), extra, ..] => {
            return wrong_usage(&format!("{command} takes no arguments, got {extra}"));
        }
        [unknown, ..] => return wrong_usage(&format!("unknown command {unknown}")),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("xtask: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// Runs a comparison, which lives with the surfaces as an example, optimised.
fn example(name: &str, rest: &[&str]) -> Result<(), cmd::Failure> {
    let example = ["run", "--release", "--locked", "-p", "osculate-surfaces", "--example", name, "--"];
    cmd::run(cmd::cargo(&cmd::root()?, &[&example, rest].concat()))
}

/// Runs an example of the postprocessor.
fn postproc_example(name: &str, rest: &[&str]) -> Result<(), cmd::Failure> {
    let example = ["run", "--locked", "-p", "osculate-postproc", "--example", name, "--"];
    cmd::run(cmd::cargo(&cmd::root()?, &[&example, rest].concat()))
}

/// The papers that have pages.
const PAPERS: [&str; 4] = ["r97", "m86", "z17", "d98"];

/// Makes the pages of papers anew.
fn papers(names: &[&str]) -> Result<(), cmd::Failure> {
    let (strip_widths, others): (Vec<&str>, Vec<&str>) =
        names.iter().partition(|p| ["r97", "m86"].contains(*p));
    if !strip_widths.is_empty() {
        strips(&strip_widths)?;
    }
    for paper in others {
        if paper == "z17" { postproc_example("z17", &["docs/papers"]) } else { d98() }?;
    }
    Ok(())
}

/// Runs the study of side milling, an example of the tools.
fn d98() -> Result<(), cmd::Failure> {
    let example = ["run", "--locked", "-p", "osculate-tools", "--example", "d98", "--", "docs/papers"];
    cmd::run(cmd::cargo(&cmd::root()?, &example))
}

/// Runs the study of strip widths, an example of the productivity crate.
fn strips(papers: &[&str]) -> Result<(), cmd::Failure> {
    let example = ["run", "--locked", "-p", "osculate-productivity", "--example", "papers", "--", "docs"];
    cmd::run(cmd::cargo(&cmd::root()?, &[&example, papers].concat()))
}

fn wrong_usage(why: &str) -> ExitCode {
    eprintln!("xtask: {why}\n{USAGE}");
    ExitCode::from(2)
}
