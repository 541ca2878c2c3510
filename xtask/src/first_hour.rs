//! `cargo xtask first-hour`: docs/first-hour.md, eleven real parts as a new user has them: `init`, `check` and `plan` of the job as it is written,
//! no key changed, with what each took and said, and a picture of what the job leaves of each.
//!
//! Results stay below `target/first-hour`.

use crate::cmd::{Failure, program, root, write};
use crate::measured::{self, Measured};
use serde_json::Value;
use std::fmt::Write;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// What the command takes.
pub struct Options<'a> {
    data: &'a Path,
    only: &'a str,
    program: Option<&'a str>,
    limit_s: u64,
}

/// No verb may take longer, s, where nothing else is said.
const LIMIT_S: u64 = 300;

impl<'a> Options<'a> {
    /// Pairs of option and value; None where one is unknown or there is no collection.
    pub fn of(words: &[&'a str]) -> Option<Self> {
        let mut out = Self { data: Path::new(""), only: "", program: None, limit_s: LIMIT_S };
        for pair in words.chunks(2) {
            match *pair {
                ["--data", v] => out.data = Path::new(v),
                ["--only", v] => out.only = v,
                ["--program", v] => out.program = Some(v),
                ["--limit", v] => out.limit_s = v.parse().ok()?,
                _ => return None,
            }
        }
        (out.data != Path::new("")).then_some(out)
    }
}

/// The parts: what they are, and where they lie in the collection.
const PARTS: [(&str, &str); 11] = [
    ("turbine stator blade", "files/iges/nasa_eee_hpt_stator2.igs"),
    ("turbine rotor blade", "files/iges/nasa_eee_hpt_rotor2.igs"),
    ("blade, one large surface", "files/iges/clarkyeah_blade.igs"),
    ("side of a propeller's blade", "files/iges/bladex_lower.iges"),
    ("propeller", "files/step/autogiro_propeller.step"),
    ("impeller", "files/iges/pyiges_impeller.igs"),
    ("hull, 2.5 m", "files/iges/dealii_wigley_hull.iges"),
    ("bulbous bow", "files/iges/dealii_dtmb5415_bow.iges"),
    ("prismatic part with holes", "files/step/nist_ctc_01_asme1_ap242.stp"),
    ("half of a spherical shell", "files/step/caxif_s1_c5_214__HEAD_FRONT.stp"),
    ("cube with a round edge", "files/iges/igesio_rounded_cube.igs"),
];

const HEAD: &str = "# The first hour: eleven real parts, from the file to a verdict\n\n\
Made by `cargo xtask first-hour --data FOLDER`, of which `--only TEXT` makes some. FOLDER is the reference collection of real files of other \
people. Of each part, with no key written or changed by hand:\n\n\
```sh\nosculate init PART --out DIR\nosculate check DIR/job.toml\nosculate plan DIR/job.toml --out DIR/plan\n```\n\n\
Seconds are wall time on two cores with whatever else ran there, CPU seconds in brackets: where the first is more than the second, the machine \
was busy with other things. *Faces* are those that the job machines, of all. *Uncut* is what the tool does not reach, which the job accepts and the \
verdict names. Minutes are those of the machine.\n\n\
| part | file | faces | groups | init s | check s | plan s | answer | uncut mm2 | of mm2 | minutes |\n|---|---|---|---|---|---|---|---|---|---|---|\n";

/// Plans the parts whose file has the text in it, and writes the page; rows of the others stay.
///
/// # Errors
/// Where the program cannot be started, or says nothing that can be read. A part that is refused, or not held, is a row.
pub fn run(options: &Options<'_>) -> Result<(), Failure> {
    let root = root()?;
    let program = program(&root, options.program)?;
    let to = root.join("docs/first-hour.md");
    let before = std::fs::read_to_string(&to).unwrap_or_default();
    let mut page = HEAD.to_owned();
    let mut reasons = String::new();
    for (what, file) in PARTS {
        let name = name_of(file);
        let (row, reason) = if name.contains(options.only) {
            let found = one((what, &name), &program, options, &root)?;
            println!("{}{}", found.0, found.1);
            found
        } else {
            let line = |start: &str, mark: &str| {
                let same = |l: &&str| l.starts_with(start) && l.contains(mark);
                before.lines().filter(same).map(|l| format!("{l}\n")).collect::<String>()
            };
            (line("| ", &format!("| `{name}` |")), line("- ", &format!("`{name}`")))
        };
        page.push_str(&row);
        reasons.push_str(&reason);
    }
    if !reasons.is_empty() {
        let _ = write!(page, "\nWhat stands in the way, in the words of the program:\n\n{reasons}");
    }
    page.push_str("\nWhat each program leaves, as `picture.svg` of the plan shows it:\n");
    for (what, file) in PARTS {
        let name = name_of(file);
        if root.join("docs").join(picture(&name)).is_file() {
            let _ = write!(page, "\n{what}, `{name}`:\n\n![{what}]({})\n", picture(&name));
        }
    }
    write(&to, &page)
}

/// The name of a part's file.
fn name_of(file: &str) -> String {
    Path::new(file).file_stem().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

/// Where the picture of a part is, from the page.
fn picture(name: &str) -> String {
    format!("figures/first-hour-{name}.svg")
}

/// One verb of the program: what it took, and what it wrote.
struct Said {
    took: Measured,
    out: String,
    err: String,
}

impl Said {
    fn seconds(&self) -> String {
        let cpu = self.took.cpu_s.map_or_else(String::new, |s| format!(" ({s:.1})"));
        format!("{:.1}{cpu}", self.took.wall_s)
    }

    /// Its complaint, in a line.
    fn complaint(&self) -> String {
        let last = self.err.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or("");
        last.trim().trim_start_matches("osculate: ").to_owned()
    }
}

fn said(program: &Path, words: &[&str], (folder, limit_s): (&Path, u64)) -> Result<Said, Failure> {
    let open = |name: &str| {
        let path = folder.join(name);
        File::create(&path).map(|file| (file, path.clone())).map_err(|why| Failure::Write { path, why })
    };
    let ((out, out_path), (err, err_path)) = (open("stdout")?, open("stderr")?);
    let mut command = Command::new(program);
    command.args(words).stdout(out).stderr(err);
    let took = measured::run_to(command, Duration::from_secs(limit_s))?;
    let read = |path: PathBuf| std::fs::read_to_string(&path).map_err(|why| Failure::Read { path, why });
    Ok(Said { took, out: read(out_path)?, err: read(err_path)? })
}

/// A part: its row of the table, and why it was refused or is not held.
fn one(
    (what, name): (&str, &str),
    program: &Path,
    options: &Options<'_>,
    root: &Path,
) -> Result<(String, String), Failure> {
    let file =
        PARTS.iter().map(|p| options.data.join(p.1)).find(|f| f.file_stem().is_some_and(|s| s == name));
    let file = file.unwrap_or_default().display().to_string();
    let folder = root.join("target/first-hour").join(name);
    // Results of an earlier run must not be taken for this one's.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).map_err(|why| Failure::Write { path: folder.clone(), why })?;
    let at = |name: &str| folder.join(name).display().to_string();
    let within = (folder.as_path(), options.limit_s);
    let begin = format!("| {what} | `{name}` |");
    let init = said(program, &["init", &file, "--out", &at("job"), "--json"], within)?;
    let because = |verb: &str, why: &str| format!("- `{name}`, {verb}: {why}\n");
    let not_ended = |verb: &str| because(verb, &format!("not done after {} s", options.limit_s));
    let rest = "- | - | - | - |";
    match init.took.code {
        Some(0) => {}
        Some(_) => {
            let row = format!(
                "{begin} - | - | {} | - | - | refused before planning | - | - | - |\n",
                init.seconds()
            );
            return Ok((row, because("init", &told(&init))));
        }
        None => {
            return Ok((format!("{begin} - | - | {} | {rest} - | - |\n", init.seconds()), not_ended("init")));
        }
    }
    let warned = warnings(&init);
    let before: String = warned.iter().map(|w| because("init, before anything is planned", w)).collect();
    let because = |verb: &str, why: &str| format!("{before}{}", because(verb, why));
    let not_ended = |verb: &str| format!("{before}{}", not_ended(verb));
    let job = at("job/job.toml");
    let check = said(program, &["check", &job, "--json"], within)?;
    let asked: Value = serde_json::from_str(&check.out).unwrap_or_default();
    let [own, others] = [0, 1].map(|k| asked["faces"][k].as_u64().unwrap_or(0));
    let text = std::fs::read_to_string(&job).unwrap_or_default();
    let head = text.lines().find(|l| l.starts_with("# The part has ")).unwrap_or_default();
    let groups = head.split_whitespace().rev().nth(1).unwrap_or("-");
    let begin =
        format!("{begin} {own} of {} | {groups} | {} | {} |", own + others, init.seconds(), check.seconds());
    if check.took.code != Some(0) {
        let row = format!("{begin} - | refused before planning | - | - | - |\n");
        return Ok((row, because("check", &told(&check))));
    }
    let plan = said(program, &["plan", &job, "--out", &at("plan"), "--json"], within)?;
    let begin = format!("{begin} {} |", plan.seconds());
    let summary = std::fs::read_to_string(folder.join("plan/summary.json")).unwrap_or_default();
    let Ok(s) = serde_json::from_str::<Value>(&summary) else {
        let why = if plan.took.code.is_none() { not_ended("plan") } else { because("plan", &told(&plan)) };
        return Ok((format!("{begin} no plan | - | - | - |\n"), why));
    };
    let (from, to) = (folder.join("plan/picture.svg"), root.join("docs").join(picture(name)));
    std::fs::copy(from, &to).map_err(|why| Failure::Write { path: to, why })?;
    let number = |v: &Value| v.as_f64().map_or_else(|| "-".to_owned(), |x| format!("{x:.1}"));
    let answer = s["verdict"]["answer"].as_str().unwrap_or("?").replace('_', " ");
    let row = format!(
        "{begin} {answer} | {} | {} | {} |\n",
        number(&s["verification"]["uncut_area_mm2"]),
        number(&s["area_mm2"]),
        number(&s["time_min"])
    );
    let why = if answer == "held" { String::new() } else { because("plan", &verdict(&s)) };
    Ok((row, why))
}

/// The warnings of a verb that ended well, from its JSON.
fn warnings(said: &Said) -> Vec<String> {
    let object: Value = serde_json::from_str(&said.out).unwrap_or_default();
    let all = object["diagnostics"].as_array().cloned().unwrap_or_default();
    all.iter().filter_map(|d| Some(d.as_str()?.strip_prefix("warning: ")?.to_owned())).collect()
}

/// What a verb that ended with a failure said, from its JSON or its last line.
fn told(said: &Said) -> String {
    let object: Value = serde_json::from_str(&said.out).unwrap_or_default();
    let words = object["error"]["what"].as_str().map(str::to_owned);
    words.unwrap_or_else(|| {
        if object["unreached_mm2"].is_number() {
            format!("{} mm2 are not reached, {} accepted", object["unreached_mm2"], object["accepted_mm2"])
        } else {
            said.complaint()
        }
    })
}

/// Why a verdict is what it is.
fn verdict(s: &Value) -> String {
    let why = &s["verdict"]["why"];
    why.as_str().map_or_else(|| why.to_string(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_collection_must_be_named() {
        assert!(Options::of(&[]).is_none() && Options::of(&["--data"]).is_none());
        let options = Options::of(&["--data", "d", "--limit", "7"]);
        assert!(options.is_some_and(|o| o.limit_s == 7 && o.program.is_none()));
    }
}
