//! docs/control-time.md from the results that are kept.

use super::kept::{CLOCKED, OTHER_RATES, RATE, Which};
use super::machine::LETTERS;
use super::programs::{MODES, PARTS, Part};
use crate::cmd::{self, Failure};
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

const HEAD: &str = "# Time on LinuxCNC itself\n\nMade by `cargo xtask control`, of which `--only TEXT` makes some: programs run by the motion planner of LinuxCNC 2.9 \
(Debian's `linuxcnc-uspace`), without a screen, on `xyzac-trt-kins` with the limits of the machine files `xtask/control/fast.toml` (the drives of `trunnion-ac`) and `small.toml`. Seconds are servo \
cycles of 1 ms, as HAL's sampler wrote them down. The jobs are examples, and surfaces of M86 by isoparametric lines.\n\n## What we say beside what it takes\n\n\
*plan* is `control_time_min` of `plan`, *time* that of `osculate time` for the program it wrote; both count rapid moves from the first known place on. *Feed* is the time of feed moves. \
*Rapid* is that of rapid moves after the program has named every joint: where those before it begin is the machine's, *approach* is their time on LinuxCNC from its zero. *Idle* is without motion between the first and the last feed move.\n\n\
| part | feed mode | blocks | plan s | time s | off % | feed: time s | LinuxCNC s | off % | rapid: time s | LinuxCNC s | both: off % | approach s | idle s | lost samples |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

const FEEDS: &str = "\n## Feed modes of one path\n\nThe path of the part's first plan, posted in every feed mode with the job's `G64 P`. `none` is the constant F of the job over X Y Z of the joints. *Share* is that of the time \
with `none`. Joints' largest speed, acceleration and jerk in feed moves are per cent of the machine file's limits; LinuxCNC 2.9 limits no jerk, so that acceleration steps from cycle to cycle, and with `tcp` it \
limits the tip's axes but not the joints. `fastest` goes as fast as the joints can, beyond the job's F where they can: it is no candidate for the best mode. *Tip* is how far the tip is off the straight pieces between CL points, by forward kinematics of the sampled joints: the most, and 99 of 100 cycles.\n";
const COLUMNS: &str = "\n| part | feed mode | blocks | LinuxCNC feed s | our feed s | off % | share % | speed % | acceleration % | jerk % | tip, most mm | tip, 99 % mm |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";

const DRIVEN: &str = "\n## What is left by the joints as they moved\n\nThe samples of a program without tool-centre-point control are a program of their own: every servo cycle a straight move of 1 ms, nothing blended. \
`verify` says what it leaves, beside what `plan` said of the blocks: *scallop* with tooth marks and *gouge* at samples, each with what may hide between them as *at most*. Verdicts on blocks add all of P everywhere; \
what blended corners really add is the difference.\n\n\
| part | P mm | scallop: blocks mm | as driven mm | gouge: blocks mm | as driven mm | scallop at most: blocks mm | as driven mm | gouge at most: blocks mm | as driven mm | held: blocks | as driven |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";

/// Writes the page.
pub fn write(root: &Path) -> Result<(), Failure> {
    let kept = |part: &Part, which: &Which<'_>| -> Option<Value> {
        let text = std::fs::read_to_string(which.file(root, part)).ok()?;
        serde_json::from_str(&text).ok()
    };
    cmd::write(&root.join("docs/control-time.md"), &page(&kept))
}

fn page(kept: &dyn Fn(&Part, &Which<'_>) -> Option<Value>) -> String {
    let (mut out, mut missing) = (HEAD.to_owned(), Vec::new());
    for part in &PARTS {
        for feed in part.planned {
            match kept(part, &Which { feed, posted: false, rate: RATE }) {
                Some(v) => out += &planned(part.name, feed, &v),
                None => missing.push(format!("{} {feed}", part.name)),
            }
        }
    }
    out += DRIVEN;
    for part in &PARTS {
        let found = part.planned.iter().find_map(|feed| {
            let v = kept(part, &Which { feed, posted: false, rate: RATE })?;
            v["driven"].is_object().then_some(v)
        });
        if let Some(v) = found {
            out += &driven(part.name, &v["driven"]);
        }
    }
    out += FEEDS;
    out += COLUMNS;
    for part in PARTS.iter().filter(|p| p.every_mode) {
        let found: Vec<(&str, Option<Value>)> =
            MODES.iter().map(|feed| (*feed, kept(part, &Which { feed, posted: true, rate: RATE }))).collect();
        let constant = found[0].1.as_ref().map(|v| number(v, "feed_s"));
        for (feed, value) in &found {
            match value {
                Some(v) => out += &posted(part.name, feed, v, constant),
                None => missing.push(format!("{} {feed}, posted", part.name)),
            }
        }
        if let Some(line) = best(part.name, &found) {
            out += &line;
        }
    }
    out += &clocks(kept);
    if !missing.is_empty() {
        let _ = write!(out, "\nNot run yet: {}.\n", missing.join("; "));
    }
    out
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or(f64::NAN)
}

/// By how many per cent the first is above the second.
fn off(ours: f64, theirs: f64) -> f64 {
    100.0 * (ours / theirs - 1.0)
}

fn planned(name: &str, feed: &str, v: &Value) -> String {
    let [plan, time, feeds, linuxcnc] = [
        v["plan_s"][0].as_f64().unwrap_or(f64::NAN),
        number(v, "time_s"),
        number(v, "time_feed_s"),
        number(v, "feed_s"),
    ];
    let rapid = number(v, "rapid_s");
    format!(
        "| {name} | {feed} | {} | {plan:.2} | {time:.2} | {:.2} | {feeds:.3} | {linuxcnc:.3} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {} |\n",
        v["blocks"],
        off(plan, time),
        off(feeds, linuxcnc),
        time - feeds,
        rapid,
        off(time, linuxcnc + rapid),
        number(v, "approach_s"),
        number(v, "idle_s"),
        v["lost"]
    )
}

/// What the blocks of a program leave, and the way that they were driven.
fn driven(name: &str, v: &Value) -> String {
    let of = |which: &str| {
        let mm = |k: usize| v[which]["mm"][k].as_f64().unwrap_or(f64::NAN);
        let blend_mm = v["blend_mm"].as_str().and_then(|w| w.parse().ok()).unwrap_or(f64::NAN);
        let more = if which == "planned" { blend_mm } else { 0.0 };
        ([mm(0), mm(2)], [mm(0) + mm(1) + more, mm(2) + mm(3) + more])
    };
    let ((is, most), (drove, drove_most)) = (of("planned"), of("driven"));
    let held = |which: &str| if v[which]["answer"] == "held" { "yes" } else { "**no**" };
    let numbers = [is[0], drove[0], is[1], drove[1], most[0], drove_most[0], most[1], drove_most[1]];
    let cells: Vec<String> = numbers.iter().map(|x| format!("{x:.4}")).collect();
    format!(
        "| {name} | {} | {} | {} | {} |\n",
        v["blend_mm"].as_str().unwrap_or("-"),
        cells.join(" | "),
        held("planned"),
        held("driven")
    )
}

fn posted(name: &str, feed: &str, v: &Value, constant: Option<f64>) -> String {
    let shares = |k: usize| {
        let joints = LETTERS.iter().enumerate();
        let words = joints.map(|(j, letter)| {
            format!("{letter} {:.0}", 100.0 * v["shares"][k][j].as_f64().unwrap_or(f64::NAN))
        });
        words.collect::<Vec<_>>().join(", ")
    };
    let (linuxcnc, ours) = (number(v, "feed_s"), number(v, "time_feed_s"));
    let share = constant.map_or("-".to_owned(), |c| format!("{:.1}", 100.0 * linuxcnc / c));
    format!(
        "| {name} | {feed} | {} | {linuxcnc:.3} | {ours:.3} | {:.2} | {share} | {} | {} | {} | {:.4} | {:.4} |\n",
        v["blocks"],
        off(ours, linuxcnc),
        shares(0),
        shares(1),
        shares(2),
        number(v, "tip_mm"),
        number(v, "tip_p99_mm")
    )
}

/// The best feed mode of a part among those that hold the job's F.
fn best(name: &str, found: &[(&str, Option<Value>)]) -> Option<String> {
    let times = found.iter().filter_map(|(feed, v)| Some((*feed, number(v.as_ref()?, "feed_s"))));
    let (feed, seconds) = times.filter(|(feed, _)| *feed != "fastest").min_by(|a, b| a.1.total_cmp(&b.1))?;
    let constant = number(found.first()?.1.as_ref()?, "feed_s");
    let less = -off(seconds, constant);
    let words = if feed == MODES[0] {
        "constant F is the best".to_owned()
    } else {
        format!("{feed} takes {less:.1} % less than constant F")
    };
    Some(format!("| {name} | *{words}* | | | | | | | | | | |\n"))
}

/// One program with clocks of other rates.
fn clocks(kept: &dyn Fn(&Part, &Which<'_>) -> Option<Value>) -> String {
    let Some(part) = PARTS.iter().find(|p| p.name == CLOCKED.0) else { return String::new() };
    let mut out = format!(
        "\n## The clock\n\nThe control's clock runs {RATE} times as fast as the computer's, so that a cycle is done sooner after the one before. \
         What a cycle computes knows no clock; that blocks come in time all the same, the same program ({}, {}) shows with other clocks.\n\n\
         | times as fast | feed s | rapid s | lost samples |\n|---|---|---|---|\n",
        CLOCKED.0, CLOCKED.1
    );
    for rate in OTHER_RATES.into_iter().chain([RATE]) {
        if let Some(v) = kept(part, &Which { feed: CLOCKED.1, posted: false, rate }) {
            let (feed, rapid) = (number(&v, "feed_s"), number(&v, "rapid_s"));
            let _ = writeln!(out, "| {rate} | {feed:.3} | {rapid:.3} | {} |", v["lost"]);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_have_what_is_kept_and_name_what_is_not() {
        let shares = [[0.5; 5], [1.0; 5], [80.0; 5]];
        let value = |feed_s: f64| {
            serde_json::json!({ "blocks": 7, "plan_s": [11.0, 10.0], "time_s": 11.0, "time_feed_s": 10.0, "feed_s": feed_s,
                "rapid_s": 1.0, "approach_s": 1.5, "idle_s": 0.0, "lost": 0, "shares": shares, "tip_mm": 0.01, "tip_p99_mm": 0.005 })
        };
        let kept = |part: &Part, which: &Which<'_>| {
            let here = part.name == PARTS[0].name && which.feed != "kz";
            here.then(|| value(if which.feed == "tcp" { 7.0 } else { 10.0 }))
        };
        let page = page(&kept);
        let row = "| eee-hpt-rotor2 | none | 7 | 11.00 | 11.00 | 0.00 | 10.000 | 10.000 | 0.00 | 1.00 | 1.00 | 0.00 | 1.50 | 0.00 | 0 |";
        assert!(page.contains(row), "{page}");
        assert!(page.contains("*tcp takes 30.0 % less than constant F*"), "{page}");
        assert!(page.contains("| 70.0 | X 50, Y 50"), "{page}");
        assert!(page.contains("eee-hpt-rotor2 kz, posted"), "{page}");
    }

    #[test]
    fn what_was_driven_stands_beside_what_blocks_say_with_the_allowance_on_one_side() {
        let v = serde_json::json!({ "blend_mm": "0.0010", "planned": { "mm": [0.008, 0.001, 0.003, 0.0005], "answer": "held" },
            "driven": { "mm": [0.0081, 0.0012, 0.0032, 0.0004], "answer": "not_shown" } });
        let row = "| blade | 0.0010 | 0.0080 | 0.0081 | 0.0030 | 0.0032 | 0.0100 | 0.0093 | 0.0045 | 0.0036 | yes | **no** |\n";
        assert_eq!(driven("blade", &v), row);
    }
}
