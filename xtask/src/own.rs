//! `cargo xtask own`: docs/papers/own-parts.md, the papers' quantities for real parts: verbs of the release program with what they print
//! and draw.
//!
//! Results stay below `target/own`.

use crate::cmd::{Failure, program, root, write};
use crate::parts::{self, Options};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// A command and what the page shows of it.
struct Shown {
    heading: &'static str,
    /// What to see.
    text: &'static str,
    /// The verb and its arguments; the folder for results follows as `--out` where there are pictures.
    command: &'static [&'static str],
    /// Only lines with one of these words; all where there are none.
    lines: &'static [&'static str],
    /// Pictures in the folder of results, and what they are called on the page.
    pictures: &'static [&'static str],
}

/// Rows of a plan that say what it makes in its time.
const IN_TIME: &[&str] = &[
    "passes  ",
    "time  ",
    "time on the control",
    "productivity",
    "slower than the feed",
    "feed held by",
    "cutting speed",
    "  held",
    "  not shown",
    "  NOT held",
];

const SHOWN: [Shown; 20] = [
    Shown {
        heading: "Propeller: one contact",
        text: "A ball on a convex side. The strip beside every closed form, radii along and across the feed, the mark of one tooth, how the \
               tolerance is best shared, what passes in a minute [R97]. For a ball on a convex part the smallest radius of conformity asks \
               for the narrowest strip.",
        command: &["strip", "docs/papers/own/propeller.toml"],
        lines: &[],
        pictures: &["strip.svg"],
    },
    Shown {
        heading: "Impeller blade: one contact",
        text: "A saddle: Dupin's indicatrix of the part is a pair of hyperbolas.",
        command: &["strip", "docs/papers/own/impeller-blade.toml"],
        lines: &[],
        pictures: &["strip.svg"],
    },
    Shown {
        heading: "Turbine blade: one contact",
        text: "The file's surface ripples by some micrometres, so that curvature along the blade changes its sign from place to place: closed \
               forms, which take the curvature at the contact for that of the whole strip, are off by per cents there, and the mark of one \
               tooth by more.",
        command: &["strip", "docs/papers/own/blade.toml"],
        lines: &[],
        pictures: &["strip.svg"],
    },
    Shown {
        heading: "Hull: one contact",
        text: "A bull-nose cutter of 40 mm that leans by 3 degrees on a hull of 2.5 m.",
        command: &["strip", "docs/papers/own/hull.toml"],
        lines: &[],
        pictures: &["strip.svg"],
    },
    Shown {
        heading: "Propeller: productivity of the planned path",
        text: "At an instant, over the face and as a whole, in the time of the program on its control [R97, definitions 1 to 3, 5].",
        command: &["plan", "docs/papers/own/propeller.toml"],
        lines: IN_TIME,
        pictures: &["productivity.svg"],
    },
    Shown {
        heading: "Impeller blade: productivity of the planned path",
        text: "",
        command: &["plan", "docs/papers/own/impeller-blade.toml"],
        lines: IN_TIME,
        pictures: &["productivity.svg"],
    },
    Shown {
        heading: "Turbine blade: productivity of the planned path",
        text: "",
        command: &["plan", "docs/papers/own/blade.toml"],
        lines: IN_TIME,
        pictures: &["productivity.svg"],
    },
    Shown {
        heading: "Hull: productivity of the planned path",
        text: "",
        command: &["plan", "docs/papers/own/hull.toml"],
        lines: IN_TIME,
        pictures: &["productivity.svg"],
    },
    Shown {
        heading: "Propeller: characteristic lines",
        text: "Lines of curvature with the umbilic, constant difference, contours and gradient lines for an axis along y [M86].",
        command: &["lines", "examples/propeller/propeller.step", "--face", "F7", "--axis=0,1,0"],
        lines: &["umbilic", "star", "lemon", "monstar", "contours"],
        pictures: &["figures.svg"],
    },
    Shown {
        heading: "Hull: characteristic lines",
        text: "",
        command: &["lines", "examples/wigley-hull/hull.step", "--axis=0,1,0"],
        lines: &["umbilic", "star", "lemon", "monstar", "contours"],
        pictures: &["figures.svg"],
    },
    Shown {
        heading: "Mould: undercut and an axis without minima",
        text: "A bull-nose cutter of 10 mm held along z does not get around the minimum of a mould's floor, nor around hollows whose contour \
               lines bend tighter than its bottom; leant by 8 degrees the floor has no minimum left [M86, 5.2].",
        command: &[
            "lines",
            "examples/mould/mould.step",
            "--face",
            "F23",
            "--tool",
            "kind=\"toroidal\",diameter_mm=10,corner_radius_mm=2,length_mm=60",
        ],
        lines: &["contours", "along", "held"],
        pictures: &["i-fixed-axis.svg"],
    },
    Shown {
        heading: "Mould: productivity of a roughing",
        text: "Volume in place of area [R97, definition 4].",
        command: &["plan", "docs/papers/own/mould-rough.toml"],
        lines: &[
            "passes  ",
            "time  ",
            "time on the control",
            "removal",
            "note: stock",
            "  held",
            "  not shown",
            "  NOT held",
        ],
        pictures: &["picture.svg"],
    },
    Shown {
        heading: "Ways of machining side by side: the paper's surfaces",
        text: "The cutters and lines that [M86] gives to each kind of machine, 16 mm across, on its four surfaces: which wins, and what each \
               leaves. Length, minutes of cutting by feed words and of all on the control, and the verdict.",
        command: &["sweep", "docs/papers/own/ways.toml"],
        lines: &[],
        pictures: &[],
    },
    Shown {
        heading: "Ways of machining side by side: real faces",
        text: "The same on a propeller, an impeller blade and a hull. None of the three holds the tolerance on a whole real face by itself; \
               `auto` does, and takes the least.",
        command: &["sweep", "docs/papers/own/ways-real.toml"],
        lines: &[],
        pictures: &[],
    },
    Shown {
        heading: "Turbine blade: ways of saying the feed",
        text: "One path with every correction of the feed of [Z17], on a control that reads F over all axes: minutes as the control takes them, \
               without a correction and with tool-centre-point control for comparison.",
        command: &["sweep", "docs/papers/own/feeds.toml"],
        lines: &[],
        pictures: &[],
    },
    Shown {
        heading: "Turbine blade: both edges on four axes",
        text: "A ball that goes around the blade and both its edges on a turning centre with a milling spindle, its axis across that of the \
               part. The control reads F over X, Y and Z.",
        command: &["plan", "docs/papers/own/four-axis.toml"],
        lines: IN_TIME,
        pictures: &["productivity.svg"],
    },
    Shown {
        heading: "Turbine blade: ways of saying the feed on four axes",
        text: "What [Z17] corrects, and what it costs: without a correction and with K_V and K_Z the tip runs faster than asked where the part \
               turns, so that the marks of teeth grow; K_F and inverse time keep the feed, and the tolerance. Verdicts take F at its word. \
               LinuxCNC's planner brakes at every block of a program with rotary axes, so that on this control they all take as long.",
        command: &["sweep", "docs/papers/own/feeds-four-axis.toml"],
        lines: &[],
        pictures: &[],
    },
    Shown {
        heading: "Impeller blade: the side of a cutter",
        text: "A ruled blade by the positions of [D98]: the error along the rule of each, and the ratio of the standard error to the least \
               over the radius.",
        command: &["flank", "examples/centrifugal-blade/job.toml"],
        lines: &[],
        pictures: &["profile.svg", "ratio.svg"],
    },
    Shown {
        heading: "Impeller blade: a better span",
        text: "On the pressure side contacts of the last positions leave the face; a span that ends earlier is proposed.",
        command: &["flank", "docs/papers/own/pressure-side.toml"],
        lines: &["method", "optimum", "minimax", "span_u"],
        pictures: &[],
    },
    Shown {
        heading: "Impeller blade: the largest cutter",
        text: "The largest radius that holds the tolerance, by each position [D98, 4.1].",
        command: &["flank", "examples/centrifugal-blade/job.toml", "--largest-tool"],
        lines: &[],
        pictures: &[],
    },
];

const HEAD: &str = "# The papers on parts of one's own\n\nMade by `cargo xtask own`, of which `--only TEXT` makes some: what `osculate` prints and draws of \
real parts, an answer to rows of [the table of equations](equations.md). Jobs stand in [own](own). OUT is a folder.\n";

/// Runs every command whose heading has the text in it, and writes the page.
///
/// # Errors
/// Where a command cannot be run or leaves no picture.
pub fn run(options: &Options<'_>) -> Result<(), Failure> {
    let root = root()?;
    let program = program(&root, options.program)?;
    let to = root.join("docs/papers/own-parts.md");
    let before = std::fs::read_to_string(&to).unwrap_or_default();
    let mut page = HEAD.to_owned();
    for shown in &SHOWN {
        let text = if shown.heading.contains(options.only) {
            println!("own: {}", shown.heading);
            section(shown, &program, &root)?
        } else {
            parts::section(&before, shown.heading)
        };
        page.push_str(&text);
    }
    write(&to, &page)
}

/// What a picture is called on the page.
fn named(shown: &Shown, picture: &str) -> String {
    let words = shown.heading.to_lowercase().replace([':', ' '], "-").replace("--", "-");
    format!("own-{words}-{picture}")
}

/// Runs a command: its section.
fn section(shown: &Shown, program: &Path, root: &Path) -> Result<String, Failure> {
    let quoted = |word: &&str| if word.contains('"') { format!("'{word}'") } else { (*word).to_owned() };
    let words: Vec<String> = shown.command.iter().map(quoted).collect();
    let line = format!("osculate {}", words.join(" "));
    let out = root.join("target/own").join(named(shown, ""));
    // Results of an earlier run must not be taken for this one's.
    let _ = std::fs::remove_dir_all(&out);
    let sweep = shown.command[0] == "sweep";
    let with_out = sweep || !shown.pictures.is_empty();
    let mut run = Command::new(program);
    run.current_dir(root).args(shown.command);
    if with_out {
        run.arg("--out").arg(&out);
    }
    let said = run.output().map_err(|why| Failure::Start { line: line.clone(), why })?;
    let told = String::from_utf8_lossy(&said.stdout);
    if told.trim().is_empty() {
        let why = String::from_utf8_lossy(&said.stderr).into_owned();
        return Err(Failure::Answer { line, why });
    }
    let mut text = format!("\n## {}\n", shown.heading);
    if !shown.text.is_empty() {
        let _ = write!(text, "\n{}\n", shown.text);
    }
    let tail = if with_out { " --out OUT" } else { "" };
    let _ = write!(text, "\n`{line}{tail}`\n");
    if sweep {
        text.push_str(&ways(&out.join("table.csv"))?);
    } else {
        let wanted = |l: &&str| shown.lines.is_empty() || shown.lines.iter().any(|w| l.contains(w));
        // What names the folder of results or tells seconds is of one machine.
        let own = out.to_string_lossy();
        let lines: Vec<&str> = told.lines().filter(|l| !l.contains(&*own) && !l.contains("wall s")).collect();
        let kept: Vec<&str> = lines.into_iter().filter(wanted).map(str::trim_end).collect();
        let _ = write!(text, "\n```text\n{}\n```\n", kept.join("\n").trim_matches('\n'));
    }
    for picture in shown.pictures {
        let (from, name) = (out.join(picture), named(shown, picture));
        let to = root.join("docs/papers").join(&name);
        std::fs::copy(from, &to).map_err(|why| Failure::Write { path: to, why })?;
        let _ = write!(text, "\n![{}]({name})\n", shown.heading);
    }
    Ok(text)
}

/// The table of a sweep: what is varied, the answer, length and minutes.
fn ways(table: &Path) -> Result<String, Failure> {
    let text = std::fs::read_to_string(table).map_err(|why| Failure::Read { path: table.into(), why })?;
    let rows: Vec<Vec<String>> = text.lines().map(cells).collect();
    let head = rows.first().cloned().unwrap_or_default();
    let column = |name: &str| {
        let why = || Failure::Answer { line: "sweep".into(), why: format!("no column {name}") };
        head.iter().position(|h| h == name).ok_or_else(why)
    };
    let (answer, length, why) = (column("answer")?, column("cutting_length_mm")?, column("why")?);
    let (minutes, control) = (column("cutting_time_min")?, column("control_time_min")?);
    // What is varied stands between the case and the answer.
    let varied = 1..answer;
    let names = head.get(varied.clone()).unwrap_or_default().join(" | ");
    let mut out =
        format!("\n| {names} | mm | min | control min | verdict |\n|{}\n", "---|".repeat(varied.len() + 4));
    let digits =
        |cell: &str, n: usize| cell.parse::<f64>().map_or_else(|_| "-".to_owned(), |x| format!("{x:.n$}"));
    for row in rows.iter().skip(1) {
        let words =
            if row[why].is_empty() { String::new() } else { format!(": {}", row[why].replace('|', "/")) };
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} | {}{words} |",
            row[varied.clone()].join(" | "),
            digits(&row[length], 0),
            digits(&row[minutes], 2),
            digits(&row[control], 2),
            row[answer].replace('_', " ")
        );
    }
    Ok(out)
}

/// The cells of a line of CSV.
fn cells(line: &str) -> Vec<String> {
    let (mut out, mut quoted) = (vec![String::new()], false);
    let mut letters = line.chars().peekable();
    while let Some(c) = letters.next() {
        let last = out.len() - 1;
        match c {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                out[last].push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => out.push(String::new()),
            _ => out[last].push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_cells_keep_their_commas() {
        assert_eq!(cells("1,\"a, \"\"b\"\"\",,x"), ["1", "a, \"b\"", "", "x"]);
    }

    #[test]
    fn pictures_have_names_of_their_own() {
        let mut all: Vec<String> =
            SHOWN.iter().flat_map(|s| s.pictures.iter().map(|p| named(s, p))).collect();
        let many = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), many);
        assert!(all.iter().all(|n| !n.contains([' ', ':'])), "{all:?}");
    }
}
