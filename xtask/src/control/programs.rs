//! Which programs are run, and how they are made: `plan` for a job with the machine of this command, `post` for other feed
//! modes of the path that it wrote.

use super::machine::{Drives, LETTERS};
use crate::cmd::{self, Failure};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the job comes from.
pub enum Job {
    /// An example, with another machine.
    Example(&'static str),
    /// A surface of M86, by isoparametric lines.
    Surface(&'static str),
}

/// A part with its programs.
pub struct Part {
    pub name: &'static str,
    pub job: Job,
    /// File of `xtask/control`, without its ending.
    pub machine: &'static str,
    /// Feed modes that are planned.
    pub planned: &'static [&'static str],
    /// Whether the first one's path is posted in every feed mode.
    pub every_mode: bool,
}

/// Feed modes of one path: constant F first.
pub const MODES: [&str; 7] = ["none", "inverse_time", "kf", "kv", "kz", "fastest", "tcp"];
/// Largest rise of F from block to block for `kz`, mm/min.
const KZ_STEP: &str = "200";

const fn part(name: &'static str, job: Job, planned: &'static [&'static str]) -> Part {
    Part { name, job, machine: "fast", planned, every_mode: false }
}

const fn every(part: Part) -> Part {
    Part { every_mode: true, ..part }
}

const fn small(part: Part) -> Part {
    Part { machine: "small", ..part }
}

pub const PARTS: [Part; 10] = [
    every(part("eee-hpt-rotor2", Job::Example("eee-hpt-rotor2"), &["tcp", "none", "inverse_time"])),
    every(part("torus-groove", Job::Example("torus-groove"), &["inverse_time"])),
    small(part("torus-groove, small machine", Job::Example("torus-groove"), &["tcp"])),
    every(part("propeller", Job::Example("propeller"), &["tcp"])),
    every(part("impeller", Job::Example("impeller"), &["inverse_time"])),
    every(part("m86-1", Job::Surface("m86-1"), &["inverse_time"])),
    part("m86-2", Job::Surface("m86-2"), &["kv"]),
    part("m86-3", Job::Surface("m86-3"), &["tcp"]),
    small(part("m86-4, small machine", Job::Surface("m86-4"), &["fastest"])),
    small(part("m86-3, small machine", Job::Surface("m86-3"), &["kz"])),
];

/// A program on disk.
pub struct Made {
    pub program: PathBuf,
    pub cl: PathBuf,
    /// What `plan` says of it, s: all, feed moves.
    pub planned_s: Option<[f64; 2]>,
}

/// The job of a part in a feed mode.
pub fn job(part: &Part, text: &str, machine: &Path, feed: &str) -> String {
    let step = if feed == "kz" { format!("kz_step = {KZ_STEP}\n") } else { String::new() };
    let own = format!(
        "[machine]\nfile = \"{}\"\ndialect = \"linuxcnc\"\nfeed = \"{feed}\"\n{step}",
        machine.display()
    );
    if let Job::Surface(kind) = part.job {
        return format!(
            "format = 1\n[part]\nbuiltin = {{ kind = \"{kind}\" }}\n[tool]\nkind = \"toroidal\"\ndiameter_mm = 16\n\
             corner_radius_mm = 2\nlength_mm = 80\nteeth = 4\n[tolerance]\nscallop_mm = 0.01\ngouge_mm = 0.005\nchord_mm = 0.002\n\
             [strategy]\nkind = \"isoparametric\"\n[cutting]\nspindle_rpm = 12000\nfeed_mm_min = 2000\n{own}"
        );
    }
    let (mut out, mut inside) = (String::new(), false);
    for line in text.lines() {
        if line.starts_with('[') {
            inside = line == "[machine]";
            if inside {
                out += &own;
            }
        }
        if !inside {
            out += line;
            out.push('\n');
        }
    }
    out
}

/// Plans a part in a feed mode, in a folder of its own.
pub fn plan(
    part: &Part,
    feed: &str,
    (root, program): (&Path, &Path),
    folder: &Path,
) -> Result<Made, Failure> {
    let read = |path: PathBuf| {
        std::fs::read_to_string(&path).map_err(|why| Failure::Read { path: path.clone(), why })
    };
    let mut text = String::new();
    cmd::write(&folder.join("job.toml"), "")?;
    if let Job::Example(name) = part.job {
        let from = root.join("examples").join(name);
        let mut copy = Command::new("cp");
        copy.arg("-rL").arg(from.join(".")).arg(folder);
        cmd::run(copy)?;
        text = read(from.join("job.toml"))?;
    }
    let file = folder.join("job.toml");
    cmd::write(&file, &job(part, &text, &machine_file(part, root), feed))?;
    let out = folder.join("out");
    let mut plan = Command::new(program);
    plan.arg("plan").arg(&file).arg("--out").arg(&out).arg("--quiet");
    let line = format!("osculate plan, {} {feed}", part.name);
    let answer = plan.output().map_err(|why| Failure::Start { line: line.clone(), why })?;
    let summary = std::fs::read_to_string(out.join("summary.json")).ok();
    // A plan beyond its tolerance fails, and has written everything.
    let told: Option<Value> = summary.and_then(|t| serde_json::from_str(&t).ok());
    let seconds = |key: &str| Some(60.0 * told.as_ref()?[key].as_f64()?);
    let planned_s = seconds("control_time_min").zip(seconds("control_cutting_time_min"));
    let Some((all, feeds)) = planned_s else {
        return Err(Failure::Answer { line, why: String::from_utf8_lossy(&answer.stderr).into_owned() });
    };
    let made = (out.join("program.ngc"), out.join("path.cl"));
    Ok(Made { program: made.0, cl: made.1, planned_s: Some([all, feeds]) })
}

/// Posts the path of a plan in another feed mode, for the same place and the same corners.
pub fn post(part: &Part, feed: &str, (root, program): (&Path, &Path), plan: &Made) -> Result<Made, Failure> {
    let text = std::fs::read_to_string(&plan.program)
        .map_err(|why| Failure::Read { path: plan.program.clone(), why })?;
    let setup = Setup::of(&text, &plan.program)?;
    let to = plan.program.with_file_name(format!("posted-{feed}.ngc"));
    let mut post = Command::new(program);
    post.arg("post").arg(&plan.cl).arg("--machine").arg(machine_file(part, root));
    post.args(["--dialect", "linuxcnc", "--feed", feed, "--quiet", "--blend-mm", &setup.blend_mm]);
    if feed == "kz" {
        post.args(["--kz-step", KZ_STEP]);
    }
    let [x, y, z] = setup.part_zero_mm;
    post.arg(format!("--part-zero={x},{y},{z}"));
    post.arg("--gauge-length-mm").arg(setup.length_mm.to_string()).arg("--out").arg(&to);
    cmd::output_quietly(post)?;
    Ok(Made { program: to, cl: plan.cl.clone(), planned_s: None })
}

/// The machine file of a part.
pub fn machine_file(part: &Part, root: &Path) -> PathBuf {
    root.join(format!("xtask/control/{}.toml", part.machine))
}

/// The drives of a part's machine.
pub fn drives(part: &Part, root: &Path) -> Result<Drives, Failure> {
    let path = machine_file(part, root);
    let text = std::fs::read_to_string(&path).map_err(|why| Failure::Read { path: path.clone(), why })?;
    Drives::of(&text, &path)
}

/// What a program's head says of its setup.
#[derive(Debug, PartialEq)]
pub struct Setup {
    pub part_zero_mm: [f64; 3],
    /// The unit quaternion i j k w that turns the part into place.
    pub turn: [f64; 4],
    pub length_mm: f64,
    /// Whether X Y Z are the tip in the part.
    pub tcp: bool,
    /// The line with which X Y Z A C have all been named; the moves up to it begin where the program does not say.
    pub named_line: usize,
    /// As the program says it.
    pub blend_mm: String,
}

impl Setup {
    /// Reads the head of a program with one tool.
    ///
    /// # Errors
    /// Where it does not say its setup.
    pub fn of(text: &str, path: &Path) -> Result<Self, Failure> {
        let word = |start: &str| text.lines().take(100).find_map(|l| l.strip_prefix(start));
        let lacks = || Failure::Source {
            path: path.to_path_buf(),
            why: "the head does not say part zero, gauge length and G64".into(),
        };
        let number =
            |w: &str, letter: char| w.trim_end_matches(')').strip_prefix(letter)?.parse::<f64>().ok();
        let zero = word("(setup part zero ").ok_or_else(lacks)?;
        let numbers = |words: &str, letters: &[char]| -> Vec<f64> {
            words.split(' ').zip(letters).filter_map(|(w, l)| number(w, *l)).collect()
        };
        let parts = numbers(zero, &['X', 'Y', 'Z']);
        let turn = match word("(setup turn ") {
            Some(words) => numbers(words, &['I', 'J', 'K', 'W']).try_into().map_err(|_| lacks())?,
            None => [0.0, 0.0, 0.0, 1.0],
        };
        Ok(Self {
            part_zero_mm: parts.try_into().map_err(|_| lacks())?,
            turn,
            length_mm: word("(setup gauge length ").and_then(|w| number(w, 'L')).ok_or_else(lacks)?,
            named_line: named_line(text),
            tcp: text.lines().any(|l| l == "M428"),
            blend_mm: word("G64 P").and_then(|w| w.split(' ').next()).ok_or_else(lacks)?.to_owned(),
        })
    }
}

/// The line, counted from 1, with which moves have named every joint; X Y Z anew where they become the tip's.
fn named_line(text: &str) -> usize {
    let mut open: Vec<&str> = LETTERS.to_vec();
    let tcp = text.lines().any(|l| l == "M428");
    for (k, line) in text.lines().enumerate() {
        // Z of the joints, which `G53` names first, is not the tip's.
        let other = tcp && line.starts_with("G53");
        if !line.starts_with(['(', '%']) && !other {
            open.retain(|letter| !line.split(' ').any(|word| word.starts_with(letter)));
        }
        if open.is_empty() {
            return k + 1;
        }
    }
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_get_the_machine_of_the_command() {
        let text = "format = 1\n[machine]\nname = \"a\"\n[setup]\nturns = \"free\"\n";
        let made = job(&PARTS[0], text, Path::new("b.toml"), "kz");
        let machine = "[machine]\nfile = \"b.toml\"\ndialect = \"linuxcnc\"\nfeed = \"kz\"\nkz_step = 200\n";
        assert_eq!(made, format!("format = 1\n{machine}[setup]\nturns = \"free\"\n"));
    }

    #[test]
    fn heads_say_their_setup() {
        let text = "(setup part zero X-1.5 Y2 Z0.25)\n(setup turn I0.6 J0 K0 W0.8)\n(setup gauge length L80.0)\nG64 P0.0013\nG53 G0 Z0\n\
                    G0 A1 C2\nM428\nX3 Y4\nZ5\nX6\n";
        let want = Setup {
            part_zero_mm: [-1.5, 2.0, 0.25],
            turn: [0.6, 0.0, 0.0, 0.8],
            length_mm: 80.0,
            tcp: true,
            named_line: 9,
            blend_mm: "0.0013".to_owned(),
        };
        assert_eq!(Setup::of(text, Path::new("a.ngc")).unwrap(), want);
        assert!(Setup::of("G64 P1\n", Path::new("a.ngc")).is_err());
    }
}
