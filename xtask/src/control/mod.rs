//! `cargo xtask control`: docs/control-time.md, programs on LinuxCNC's own motion planner beside what `plan` and `time` say.
//!
//! LinuxCNC runs headless from Debian's packages, unpacked below `target/interop`, as in `cargo xtask interop`. Its INI file
//! has the limits of the machine file. HAL's sampler writes down the joints in every servo cycle; times are rows, so that it
//! does not matter how fast the computer is. A quicker clock for the realtime part saves waiting: the page compares runs with
//! and without. Programs, samples and results stay below `target/control`.

mod driven;
mod kept;
mod machine;
mod page;
mod programs;
mod run;
mod samples;
mod tip;

use crate::cmd::{self, Failure, program, root};
use kept::{CLOCKED, OTHER_RATES, RATE, Which, place};
use programs::{MODES, Made, PARTS, Part};
use run::{Control, Pace};
use serde_json::Value;
use std::path::Path;

/// What the command takes.
#[derive(Default)]
pub struct Options<'a> {
    only: &'a str,
    /// Without the posts in every feed mode.
    planned: bool,
    program: Option<&'a str>,
}

impl<'a> Options<'a> {
    /// Pairs of option and value; None where one is unknown.
    pub fn of(words: &[&'a str]) -> Option<Self> {
        let mut out = Self::default();
        for pair in words.chunks(2) {
            match *pair {
                ["--only", v] => out.only = v,
                ["--posts", "no"] => out.planned = true,
                ["--posts", "yes"] => out.planned = false,
                ["--program", v] => out.program = Some(v),
                _ => return None,
            }
        }
        Some(out)
    }
}

/// Runs every part whose name has the text in it, and writes the page after each program: results of other parts stay.
///
/// # Errors
/// Where LinuxCNC cannot be run, or a program does not run to its end.
pub fn run(options: &Options<'_>) -> Result<(), Failure> {
    let root = root()?;
    let program = program(&root, options.program)?;
    let control = Control::new(&root)?;
    for part in PARTS.iter().filter(|p| p.name.contains(options.only)) {
        each(part, options.planned, &(&root, &program), &control)?;
    }
    Ok(())
}

/// The programs of a part.
fn each(
    part: &Part,
    planned: bool,
    (root, osculate): &(&Path, &Path),
    control: &Control<'_>,
) -> Result<(), Failure> {
    let place = place(root, part);
    let mut first = None;
    for feed in part.planned {
        let made = programs::plan(part, feed, (root, osculate), &place.join(feed))?;
        look(part, &Which { feed, posted: false, rate: RATE }, (root, osculate), (control, &made))?;
        if (part.name, *feed) == CLOCKED {
            for rate in OTHER_RATES {
                look(part, &Which { feed, posted: false, rate }, (root, osculate), (control, &made))?;
            }
        }
        first.get_or_insert(made);
    }
    let Some(plan) = first.filter(|_| part.every_mode && !planned) else { return Ok(()) };
    for feed in MODES {
        let made = programs::post(part, feed, (root, osculate), &plan)?;
        look(part, &Which { feed, posted: true, rate: RATE }, (root, osculate), (control, &made))?;
    }
    Ok(())
}

/// Runs a program, keeps what it shows and writes the page.
fn look(
    part: &Part,
    which: &Which<'_>,
    (root, osculate): (&Path, &Path),
    (control, made): (&Control<'_>, &Made),
) -> Result<(), Failure> {
    let machine = programs::machine_file(part, root);
    let mut time = std::process::Command::new(osculate);
    time.arg("time").arg(&made.program).arg("--machine").arg(&machine).arg("--json");
    let told: Value = serde_json::from_str(&cmd::output_quietly(time)?).unwrap_or_default();
    let seconds = |key: &str| 60.0 * told[key].as_f64().unwrap_or(f64::NAN);
    let drives = programs::drives(part, root)?;
    let run = place(root, part).join("run");
    let pace = Pace { folder: &run, rate: which.rate, expected_s: seconds("time_min") };
    let (shown, rate) = control.shown(&drives, made, &pace)?;
    // Joints of programs of the tip are not those words.
    let driven = if !which.posted && which.feed == "inverse_time" && which.rate == RATE {
        driven::judged(osculate, made, (&run.join("samples.txt"), drives.top_mm()))?
    } else {
        Value::Null
    };
    let value = serde_json::json!({
        "driven": driven,
        "blocks": told["joints"]["blocks"],
        "plan_s": made.planned_s,
        "time_s": seconds("time_min"), "time_feed_s": seconds("cutting_min"),
        "feed_s": shown.feed_s, "rapid_s": shown.rapid_s, "approach_s": shown.approach_s, "idle_s": shown.idle_s, "lost": shown.lost, "rate": rate,
        "shares": shown.shares(&drives.joints), "tip_mm": shown.tip_mm, "tip_p99_mm": shown.tip_p99_mm,
    });
    cmd::write(&which.file(root, part), &value.to_string())?;
    println!(
        "{} {}{} at {}: {value}",
        part.name,
        which.feed,
        if which.posted { ", posted" } else { "" },
        rate
    );
    page::write(root)
}
