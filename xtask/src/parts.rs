//! `cargo xtask parts`: docs/parts.md, whole parts from the block to finished: every example that is a list of operations, planned and
//! verified by the release program, with what each operation takes.
//!
//! The verdict of `plan` is held against that of `verify` on the programs that it wrote. Results stay below `target/parts`.

use crate::cmd::{Failure, program, root, write};
use crate::measured::{self, Measured};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the command takes.
#[derive(Default)]
pub struct Options<'a> {
    pub only: &'a str,
    pub program: Option<&'a str>,
}

impl<'a> Options<'a> {
    /// Pairs of option and value; None where one is unknown.
    pub fn of(words: &[&'a str]) -> Option<Self> {
        let mut out = Self::default();
        for pair in words.chunks(2) {
            match *pair {
                ["--only", v] => out.only = v,
                ["--program", v] => out.program = Some(v),
                _ => return None,
            }
        }
        Some(out)
    }
}

const HEAD: &str = "# Whole parts from the block to finished\n\nMade by `cargo xtask parts`, of which `--only TEXT` makes some: examples that are lists of operations, each by `osculate plan JOB --out DIR`, and \
its programs judged again by `osculate verify`, which must say the same. *Uncut* is where an operation leaves more than five scallops on the faces that it is for; of the finished part, where the job \
accepts an area, all above the scallop counts, with what is around it. *Stood* is how high material stood on them before it. Minutes are those of the machine, wall and CPU seconds those of the program, on two cores.\n";

/// Plans and verifies every whole part whose name has the text in it, and writes the page.
///
/// # Errors
/// Where an example cannot be run, or `verify` and `plan` disagree.
pub fn run(options: &Options<'_>) -> Result<(), Failure> {
    let root = root()?;
    let program = program(&root, options.program)?;
    let to = root.join("docs/parts.md");
    let before = std::fs::read_to_string(&to).unwrap_or_default();
    let mut page = HEAD.to_owned();
    let mut differ = 0;
    for name in wholes(&root)? {
        let text = if name.contains(options.only) {
            let (text, same) = one(&name, &program, &root)?;
            differ += usize::from(!same);
            println!("{text}");
            text
        } else {
            section(&before, &name)
        };
        page.push_str(&text);
    }
    write(&to, &page)?;
    if differ > 0 { Err(Failure::Differs(differ)) } else { Ok(()) }
}

/// The names of examples that are lists of operations.
fn wholes(root: &Path) -> Result<Vec<String>, Failure> {
    let place = root.join("examples");
    let read = |why| Failure::Read { path: place.clone(), why };
    let mut out = Vec::new();
    for entry in std::fs::read_dir(&place).map_err(read)? {
        let entry = entry.map_err(read)?;
        let job = std::fs::read_to_string(entry.path().join("job.toml")).unwrap_or_default();
        if job.lines().any(|l| l == "format = 2") {
            out.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    out.sort();
    Ok(out)
}

/// The section of a part on an earlier page; nothing where it has none.
pub fn section(page: &str, name: &str) -> String {
    let head = format!("\n## {name}\n");
    let Some(from) = page.find(&head) else { return String::new() };
    let rest = &page[from + 1..];
    let to = rest.find("\n## ").unwrap_or(rest.len());
    format!("\n{}", &rest[..to])
}

/// Plans and verifies a part: its section, and whether the two verdicts are one.
fn one(name: &str, program: &Path, root: &Path) -> Result<(String, bool), Failure> {
    let (job, out) =
        (root.join("examples").join(name).join("job.toml"), root.join("target/parts").join(name));
    // Results of an earlier run must not be taken for this one's.
    let _ = std::fs::remove_dir_all(&out);
    let mut plan = Command::new(program);
    plan.arg("plan").arg(&job).arg("--out").arg(&out);
    let ran = measured::run(plan)?;
    let summary = out.join("summary.json");
    let text = std::fs::read_to_string(&summary).map_err(|why| Failure::Read { path: summary, why })?;
    let answer =
        |why: serde_json::Error| Failure::Answer { line: format!("plan {name}"), why: why.to_string() };
    let s: Value = serde_json::from_str(&text).map_err(answer)?;
    let programs: Vec<PathBuf> = s["setups"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|setup| setup["program"].as_str())
        .map(|file| out.join(file))
        .collect();
    let mut verify = Command::new(program);
    verify.arg("verify").args(&programs).arg("--job").arg(&job).arg("--json");
    let said = verify.output().map_err(|why| Failure::Start { line: format!("verify {name}"), why })?;
    let again: Value = serde_json::from_slice(&said.stdout).map_err(answer)?;
    let same = again["verdict"] == s["verdict"];
    let picture = format!("part-{name}.svg");
    let to = root.join("docs/figures").join(&picture);
    std::fs::copy(out.join("picture.svg"), &to).map_err(|why| Failure::Write { path: to, why })?;
    Ok((told(name, &s, &ran, same), same))
}

fn number(v: &Value, digits: usize) -> String {
    v.as_f64().map_or("-".to_owned(), |x| format!("{x:.digits$}"))
}

/// The section of a part.
fn told(name: &str, s: &Value, ran: &Measured, same: bool) -> String {
    let v = &s["verification"];
    let words = |v: &Value| v.as_str().unwrap_or("-").to_owned();
    let list = |v: &Value| {
        let all: Vec<&str> = v.as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        all.join("; ")
    };
    let mut out = format!("\n## {name}\n\n`osculate plan examples/{name}/job.toml --out DIR`\n\n");
    let why = list(&s["verdict"]["why"]);
    let _ = write!(out, "**{}**", words(&s["verdict"]["answer"]).replace('_', " "));
    if !why.is_empty() {
        let _ = write!(out, ": {why}");
    } else if v["certain"] == false {
        out.push_str(" at the samples, which the job takes as enough");
    }
    let _ = write!(
        out,
        ". {} machine minutes; scallop and mark {} mm, gouge {} mm, uncut {} of {} mm2; {}.\n\n",
        number(&s["time_min"], 1),
        number(&v["height_max_mm"], 4),
        number(&v["gouge_max_mm"], 4),
        number(&v["uncut_area_mm2"], 1),
        number(&s["area_mm2"], 0),
        if same { "`verify` says the same" } else { "**`verify` says something else**" }
    );
    let optional = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.0}"));
    let _ = write!(
        out,
        "The program took {:.0} s of wall time, {} s of CPU and {} MB.\n\n",
        ran.wall_s,
        optional(ran.cpu_s),
        optional(ran.memory_mb)
    );
    out.push_str(
        "| operation | setup | tool | passes | min | cut mm | air mm | area mm2 | stood mm | took mm3 | uncut mm2 | step | planned in s |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for o in s["operations"].as_array().into_iter().flatten() {
        let _ = writeln!(
            out,
            "| {} | {} | T{} {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            words(&o["name"]),
            words(&o["setup"]),
            number(&o["tool_number"], 0),
            words(&o["tool_words"]),
            number(&o["passes"], 0),
            number(&o["time_min"], 2),
            number(&o["cutting_length_mm"], 0),
            number(&o["air_length_mm"], 0),
            number(&o["area_mm2"], 0),
            number(&o["standing_mm"], 1),
            number(&o["removed_mm3"], 0),
            number(&o["verification"]["uncut_area_mm2"], 1),
            words(&o["step"]),
            number(&o["wall_s"]["plan"], 1)
        );
    }
    let standing: Vec<&Value> = s["left_standing"].as_array().into_iter().flatten().collect();
    if !standing.is_empty() {
        out.push_str("\n| too high on, each mm2 | highest mm | why, and what would do |\n|---|---|---|\n");
        let mut whys: Vec<&str> = Vec::new();
        for why in standing.iter().filter_map(|l| l["why"].as_str()) {
            if !whys.contains(&why) {
                whys.push(why);
            }
        }
        for why in whys {
            let own = || standing.iter().filter(|l| l["why"] == why);
            let faces: Vec<String> =
                own().map(|l| format!("{} {}", words(&l["face"]), number(&l["area_mm2"], 1))).collect();
            let highest = own().filter_map(|l| l["highest_mm"].as_f64()).fold(0.0, f64::max);
            let more = if own().any(|l| l["or_more"] == true) { " or more" } else { "" };
            let _ = writeln!(out, "| {} | {highest:.3}{more} | {why} |", faces.join(", "));
        }
    }
    let _ = write!(out, "\n![{name}](figures/part-{name}.svg)\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_of_other_parts_stay() {
        let page = format!("{HEAD}\n## a\n\ntext of a\n\n## b\n\ntext of b\n");
        assert_eq!(section(&page, "a"), "\n## a\n\ntext of a\n");
        assert_eq!(section(&page, "b"), "\n## b\n\ntext of b\n");
        assert_eq!(section(&page, "c"), "");
    }

    #[test]
    fn a_section_says_what_was_not_held() {
        let s = serde_json::json!({
            "verdict": { "answer": "not_held", "why": ["a gouge of 1 mm where 0.02 mm are accepted"] },
            "operations": [{ "name": "rough", "tool_number": 3, "tool_words": "flat 12", "time_min": 1.5 }],
        });
        let ran = Measured { wall_s: 3.2, cpu_s: Some(5.0), ..Measured::default() };
        let said = told("x", &s, &ran, false);
        assert!(said.contains("**not held**: a gouge of 1 mm where 0.02 mm are accepted."), "{said}");
        assert!(said.contains("| rough | - | T3 flat 12 | - | 1.50 |"), "{said}");
        assert!(said.contains("**`verify` says something else**"), "{said}");
        assert!(said.contains("3 s of wall time, 5 s of CPU and - MB"), "{said}");
    }
}
