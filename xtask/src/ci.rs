//! `cargo xtask ci`: what must hold before a change goes in, the quick checks first.

use crate::cmd::{Failure, cargo, root, run as run_command};
use std::path::Path;
use std::time::Instant;

/// One step: what it is called and what it does.
struct Step {
    name: &'static str,
    action: fn(&Path) -> Result<(), Failure>,
}

/// The steps in the order in which they run.
const STEPS: [Step; 8] = [
    Step { name: "format", action: |root| run_command(cargo(root, &["fmt", "--all", "--check"])) },
    Step { name: "tidy", action: |_| crate::tidy::run() },
    Step { name: "public items", action: |_| crate::api::run(crate::api::Action::Compare) },
    Step { name: "clippy", action: clippy },
    Step { name: "wasm", action: wasm },
    Step { name: "documentation", action: documentation },
    Step { name: "test", action: |_| crate::test::run(&[]) },
    Step { name: "examples", action: crate::test::examples },
];

/// Runs every step; stops at the first failure.
pub fn run() -> Result<(), Failure> {
    let root = root()?;
    let start = Instant::now();
    run_steps(&STEPS, &root)?;
    println!("ci: {} steps passed in {:.1} s", STEPS.len(), start.elapsed().as_secs_f64());
    Ok(())
}

fn run_steps(steps: &[Step], root: &Path) -> Result<(), Failure> {
    for step in steps {
        println!("ci: {} ...", step.name);
        let start = Instant::now();
        let done = (step.action)(root);
        let wall_s = start.elapsed().as_secs_f64();
        match done {
            Ok(()) => println!("ci: {} passed in {wall_s:.1} s", step.name),
            Err(why) => {
                println!("ci: {} failed after {wall_s:.1} s", step.name);
                return Err(Failure::Step { name: step.name, why: Box::new(why) });
            }
        }
    }
    Ok(())
}

fn clippy(root: &Path) -> Result<(), Failure> {
    run_command(cargo(root, &["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"]))
}

/// The target of what runs in a browser.
const WASM: &str = "wasm32-unknown-unknown";

/// What computes alone compiles for a target without files, clock and threads, and without what can be left out of it.
fn wasm(root: &Path) -> Result<(), Failure> {
    let check = ["check", "--locked", "--target", WASM, "-p", "osculate-geom", "-p", "osculate-tools"];
    for features in [&[][..], &["--no-default-features"]] {
        run_command(cargo(root, &[&check, features].concat())).inspect_err(|_| {
            println!("ci: where `core` is not found above the target is missing: rustup target add {WASM}");
        })?;
    }
    Ok(())
}

fn documentation(root: &Path) -> Result<(), Failure> {
    // The public documentation alone: with private items included, a public page that links to a private one passes.
    let mut command = cargo(root, &["doc", "--workspace", "--no-deps", "--locked"]);
    command.env("RUSTDOCFLAGS", "-D warnings");
    run_command(command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_failure_stops_the_run_and_names_the_step() {
        let fails: fn(&Path) -> Result<(), Failure> = |_| Err(Failure::Untidy(3));
        let steps = [
            Step { name: "good", action: |_| Ok(()) },
            Step { name: "bad", action: fails },
            Step { name: "later", action: |_| unreachable!("a step after a failure") },
        ];
        let said = run_steps(&steps, Path::new(".")).unwrap_err().to_string();
        assert_eq!(said, "step bad FAILED: tidy: 3 findings, see above");
        assert!(run_steps(&steps[..1], Path::new(".")).is_ok());
    }
}
