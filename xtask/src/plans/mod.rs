//! `cargo xtask plans --data FOLDER`: docs/plans.md, what `auto` makes of real faces and of the four surfaces of M86.
//!
//! Every face is planned with the same tolerances, feeds and machine: by `auto` over a list of tools, by plain isoparametric
//! lines with the first tool, by them, by constant scallop and by streamlines with the tool that `auto` chose, and in parallel
//! planes with the ball. A second table, which `--where` makes alone, says where the time of `auto` goes, of whole parts too. Jobs and
//! results stay below `target/plans`.

mod dense;
mod page;
mod speed;
mod spent;

use crate::cmd::{Failure, program, root, write};
use dense::{Cloud, Cutter};
use page::{Names, Page};
use serde_json::Value;
use spent::PARTS;
use std::path::Path;
use std::process::Command;

/// Where a face comes from.
enum Source {
    /// A built-in surface over the unit square.
    BuiltIn(&'static str),
    /// A file below the folder of data, its face, and further keys of `[part]`.
    File { path: &'static str, face: &'static str, keys: &'static str },
}

/// A face to plan, with its tools (a ball last).
struct Case {
    name: &'static str,
    source: Source,
    tools: [&'static str; 4],
    /// Diameter and length of their holder, which sits on their ends.
    holder_mm: [f64; 2],
    scallop_mm: f64,
    /// Tool axis on three axes, about the mean normal.
    axis: [f64; 3],
}

const LARGE: [&str; 4] = [
    "kind = \"toroidal\", diameter_mm = 16, corner_radius_mm = 2, length_mm = 80",
    "kind = \"toroidal\", diameter_mm = 25, corner_radius_mm = 3, length_mm = 80",
    "kind = \"flat\", diameter_mm = 12, length_mm = 80",
    "kind = \"ball\", diameter_mm = 10, length_mm = 80",
];
const SMALL: [&str; 4] = [
    "kind = \"toroidal\", diameter_mm = 6, corner_radius_mm = 1, length_mm = 50",
    "kind = \"toroidal\", diameter_mm = 10, corner_radius_mm = 1, length_mm = 50",
    "kind = \"flat\", diameter_mm = 4, length_mm = 50",
    "kind = \"ball\", diameter_mm = 6, length_mm = 50",
];
const MINI: [&str; 4] = [
    "kind = \"toroidal\", diameter_mm = 3, corner_radius_mm = 0.5, length_mm = 30",
    "kind = \"toroidal\", diameter_mm = 6, corner_radius_mm = 1, length_mm = 30",
    "kind = \"flat\", diameter_mm = 2, length_mm = 30",
    "kind = \"ball\", diameter_mm = 2, length_mm = 30",
];
const TINY: [&str; 4] = [
    "kind = \"toroidal\", diameter_mm = 0.6, corner_radius_mm = 0.1, length_mm = 6",
    "kind = \"toroidal\", diameter_mm = 1, corner_radius_mm = 0.1, length_mm = 6",
    "kind = \"flat\", diameter_mm = 0.4, length_mm = 6",
    "kind = \"ball\", diameter_mm = 0.4, length_mm = 6",
];
const HUGE: [&str; 4] = [
    "kind = \"toroidal\", diameter_mm = 40, corner_radius_mm = 6, length_mm = 150",
    "kind = \"toroidal\", diameter_mm = 63, corner_radius_mm = 6, length_mm = 150",
    "kind = \"flat\", diameter_mm = 32, length_mm = 150",
    "kind = \"ball\", diameter_mm = 20, length_mm = 150",
];

const fn m86(name: &'static str) -> Case {
    let source = Source::BuiltIn(name);
    Case { name, source, tools: LARGE, holder_mm: [50.0, 60.0], scallop_mm: 0.01, axis: [0.0, 0.0, 1.0] }
}

const fn file(name: &'static str, path: &'static str, face: &'static str, axis: [f64; 3]) -> Case {
    let source = Source::File { path, face, keys: "" };
    Case { name, source, tools: SMALL, holder_mm: [32.0, 50.0], scallop_mm: 0.01, axis }
}

const BLADE: &str = "blade/nasa_pyturbo_centrif_compressor_mainblade_xyz_pts.csv";
const BLADE_KEYS: &str = "unit_mm = 1000\n";

const fn blade(name: &'static str, face: &'static str, axis: [f64; 3]) -> Case {
    let source = Source::File { path: BLADE, face, keys: BLADE_KEYS };
    Case { name, source, tools: MINI, holder_mm: [25.0, 40.0], scallop_mm: 0.01, axis }
}

const fn teapot(keys: &'static str) -> Source {
    Source::File { path: "bezier/newell_teapot.txt", face: "F5", keys }
}

const CASES: [Case; 13] = [
    m86("m86-1"),
    m86("m86-2"),
    m86("m86-3"),
    m86("m86-4"),
    blade("compressor blade, suction side", "F1", [-0.45, -0.59, -0.67]),
    blade("compressor blade, pressure side", "F2", [0.44, 0.59, 0.67]),
    file("impeller blade", "iges/pyiges_impeller.igs", "F118", [0.16, -0.72, -0.68]),
    file("impeller hub", "iges/pyiges_impeller.igs", "F33", [0.0, -0.06, 1.0]),
    file("propeller", "step/autogiro_propeller.step", "F7", [-0.03, 0.9, 0.43]),
    Case {
        tools: HUGE,
        holder_mm: [100.0, 100.0],
        scallop_mm: 0.05,
        ..file("hull", "step/dealii_wigley_hull.step", "F1", [0.0, 0.97, -0.24])
    },
    Case {
        tools: TINY,
        holder_mm: [8.0, 20.0],
        scallop_mm: 0.001,
        ..file("connecting rod", "step/occt_linkrods.step", "F24", [0.09, -1.0, 0.0])
    },
    // The cavity of a mould for the body: the side towards the axis.
    Case {
        name: "teapot mould",
        source: teapot("normals = \"file\"\n"),
        tools: TINY,
        holder_mm: [8.0, 20.0],
        scallop_mm: 0.001,
        axis: [-0.67, 0.67, -0.34],
    },
    // At three millimetres the joints' speeds decide; this is the size of a teapot.
    Case {
        name: "teapot mould, 40 mm a unit",
        source: teapot("normals = \"file\"\nunit_mm = 40\n"),
        tools: LARGE,
        holder_mm: [50.0, 60.0],
        scallop_mm: 0.01,
        axis: [-0.67, 0.67, -0.34],
    },
];

/// Teeth of all tools.
const TEETH: u32 = 4;
/// The tool of the pictures around umbilics, so that they stay comparable.
const PICTURED: &str = "toroidal 16 r 2";

/// Points of a face for the second opinion, about.
const POINTS: f64 = 40_000.0;

/// The plans of a face.
const KINDS: [&str; 6] =
    ["auto", "isoparametric", "isoparametric, tool of auto", "isoscallop", "streamline", BALL];
const BALL: &str = "ball, 3 axes";

/// The tool that `auto` chose, as keys of a job; None where the choice keeps its axis.
fn chosen_tool(summary: &Value) -> Option<String> {
    let table: Vec<String> = summary["tool"]
        .as_object()?
        .iter()
        .filter(|(_, v)| v.is_string() || v.is_number())
        .map(|(k, v)| format!("{k} = {v}"))
        .collect();
    summary["lead_deg"].as_f64().filter(|lead| *lead > 0.0).map(|_| table.join(", "))
}

/// The job of a case.
fn job(case: &Case, kind: &str, data: &str, chosen: Option<&str>) -> String {
    let part = match case.source {
        Source::BuiltIn(name) => format!("builtin = {{ kind = \"{name}\" }}"),
        Source::File { path, face, keys } => {
            // A face by itself: what stands around it is not part of the comparison.
            format!("file = \"{data}/{path}\"\nfaces = [\"{face}\"]\nmay_hit = \"all\"\n{keys}")
        }
    };
    let h = case.scallop_mm;
    let (tools, strategy): (Vec<&str>, String) = match (kind, chosen) {
        ("auto", _) => (case.tools.to_vec(), "kind = \"auto\"".to_owned()),
        (BALL, _) => (case.tools[3..].to_vec(), format!("kind = \"isoplanar_3c\"\naxis = {:?}", case.axis)),
        // Without a choice the first tool.
        ("isoscallop" | "streamline", c) => (vec![c.unwrap_or(case.tools[0])], format!("kind = \"{kind}\"")),
        ("isoparametric, tool of auto", Some(c)) => (vec![c], "kind = \"isoparametric\"".to_owned()),
        _ => (case.tools[..1].to_vec(), "kind = \"isoparametric\"".to_owned()),
    };
    let [wide, long] = case.holder_mm;
    let holder = format!("holder = {{ diameter_mm = {wide}, length_mm = {long} }}");
    let tools: String = tools.iter().map(|t| format!("  {{ {t}, teeth = {TEETH}, {holder} }},\n")).collect();
    format!(
        "format = 1\ntools = [\n{tools}]\n[part]\n{part}\n[tolerance]\nscallop_mm = {h}\ngouge_mm = {}\n\
         [strategy]\n{strategy}\n[cutting]\nspindle_rpm = 12000\nfeed_mm_min = 2000\n[machine]\nname = \"trunnion-ac\"\n\
         dialect = \"linuxcnc\"\nfeed = \"inverse_time\"\n[setup]\nturns = \"free\"\n[verification]\nmax_samples = 600000\n",
        0.5 * h
    )
}

/// What the command takes.
#[derive(Default)]
pub struct Options<'a> {
    data: Option<&'a str>,
    only: &'a str,
    program: Option<&'a str>,
    speed: bool,
    spent: bool,
}

impl<'a> Options<'a> {
    /// Pairs of option and value, and `--speed` or `--where` among them where it is meant; None where one is unknown or the folder of data is
    /// missing where it is needed.
    pub fn of(words: &[&'a str]) -> Option<Self> {
        let has = |word: &str| words.contains(&word);
        let mut out = Self { speed: has("--speed"), spent: has("--where"), ..Self::default() };
        let rest: Vec<&str> = words.iter().copied().filter(|w| !["--speed", "--where"].contains(w)).collect();
        for pair in rest.chunks(2) {
            match *pair {
                ["--data", v] if !out.speed => out.data = Some(v),
                ["--only", v] => out.only = v,
                ["--program", v] => out.program = Some(v),
                _ => return None,
            }
        }
        (out.speed != out.data.is_some() && !(out.speed && out.spent)).then_some(out)
    }
}

/// Plans every case whose name has the text in it, and writes the page after each.
pub fn run(options: &Options<'_>) -> Result<(), Failure> {
    let root = root()?;
    let (data, only) = (options.data.unwrap_or("."), options.only);
    let data = std::fs::canonicalize(data).map_err(|why| Failure::Read { path: data.into(), why })?;
    let program = program(&root, options.program)?;
    if options.speed {
        return speed::run(only, &program, &root);
    }
    let to = root.join("docs/plans.md");
    let (mut made, mut timed): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    let faces = CASES.map(|c| c.name);
    let names = Names { faces: &faces, parts: &PARTS };
    // After each case, as all of them take long: what was made so far stays.
    let keep = |name: &str, rows: Option<String>, times: String, made: [&[&str]; 2]| {
        let before = std::fs::read_to_string(&to).unwrap_or_default();
        let mut page = Page::read(&before, names);
        if let Some(rows) = rows {
            page.set_plans(name, rows);
        }
        page.set_times(name, times);
        write(&to, &page.text(HEAD, names, made, FIGURES))
    };
    for case in CASES.iter().filter(|c| c.name.contains(only)) {
        let place = root.join("target/plans").join(case.name.replace([' ', ','], "-"));
        let rows = if options.spent {
            let folder = place.join("auto");
            let file = folder.join("job.toml");
            write(&file, &job(case, "auto", &data.to_string_lossy(), None))?;
            // What is not possible has no summary, which the row says.
            let _ = plan(&program, &file, &folder);
            None
        } else {
            made.push(case.name);
            Some(one(case, &program, &data, &root)?)
        };
        timed.push(case.name);
        keep(case.name, rows, said(spent::row(case.name, &place.join("auto"))?), [&made, &timed])?;
    }
    for part in PARTS.iter().filter(|p| options.spent && p.contains(only)) {
        let folder = root.join("target/plans").join(part);
        let _ = plan(&program, &root.join("examples").join(part).join("job.toml"), &folder);
        timed.push(part);
        keep(part, None, said(spent::row(part, &folder)?), [&made, &timed])?;
    }
    Ok(())
}

fn said(row: String) -> String {
    print!("{row}");
    row
}

/// The rows of a case.
fn one(case: &Case, program: &Path, data: &Path, root: &Path) -> Result<String, Failure> {
    let place = root.join("target/plans").join(case.name.replace([' ', ','], "-"));
    let mut rows = String::new();
    let mut say = |line: String| {
        print!("{line}");
        rows.push_str(&line);
    };
    let (mut times, mut cloud, mut chosen) = (Vec::new(), None, None);
    for kind in KINDS {
        let folder = place.join(kind.replace([' ', ','], "-"));
        let file = folder.join("job.toml");
        write(&file, &job(case, kind, &data.to_string_lossy(), chosen.as_deref()))?;
        let summary = plan(program, &file, &folder);
        if kind == "auto" {
            chosen = summary.as_ref().ok().and_then(chosen_tool);
        }
        if cloud.is_none()
            && let Some(area) = summary.as_ref().ok().and_then(|s| s["area_mm2"].as_f64())
        {
            cloud = Some(points(program, case, data, &place, area)?);
        }
        let pictured =
            |s: &Value| s["tool_words"] == PICTURED && s["verification"]["within_tolerance"] == true;
        if kind == "isoscallop"
            && matches!(case.name, "m86-3" | "m86-4")
            && summary.as_ref().is_ok_and(pictured)
        {
            let to = root.join("docs/figures").join(format!("plan-{}.svg", case.name));
            std::fs::copy(folder.join("path.svg"), &to).map_err(|why| Failure::Write { path: to, why })?;
        }
        let second = summary.as_ref().ok().zip(cloud.as_ref()).and_then(|(s, c)| look(s, c, &folder));
        say(row(case.name, kind, &summary, second));
        let of = |key: &str| summary.as_ref().ok().and_then(|s| s[key].as_f64());
        times.push(["cutting_time_min", "control_time_min"].map(of));
    }
    // Of both times, over those of three of the plans.
    let shares = |which: usize| {
        let share = |k: usize| match (times[0][which], times[k][which]) {
            (Some(a), Some(b)) => format!("{:.2}", a / b),
            _ => "-".to_owned(),
        };
        [1, 2, 5].map(share).join(", ")
    };
    say(format!(
        "| | *time of auto over that of isoparametric, of isoparametric with its tool, of the ball* | | | | {} | {} | | | | | | | | |\n",
        shares(0),
        shares(1)
    ));
    Ok(rows)
}

/// Points of the face for the second opinion.
fn points(program: &Path, case: &Case, data: &Path, place: &Path, area_mm2: f64) -> Result<Cloud, Failure> {
    let spacing = (area_mm2 / POINTS).sqrt();
    let run = |args: &[String]| {
        let mut command = Command::new(program);
        command.args(args);
        crate::cmd::output_quietly(command)
    };
    // Cells that hold some ten points.
    let cell_mm = 3.0 * spacing;
    match case.source {
        Source::BuiltIn(name) => {
            let side = POINTS.sqrt() as usize;
            let at = |k: usize| {
                format!("{},{}", (k % side) as f64 / (side - 1) as f64, (k / side) as f64 / (side - 1) as f64)
            };
            let all: Vec<usize> = (0..side * side).collect();
            let mut found = Vec::with_capacity(side * side);
            for chunk in all.chunks(4000) {
                let mut args = ["probe", "--json", "--builtin", &format!("kind = \"{name}\"")]
                    .map(str::to_owned)
                    .to_vec();
                args.extend(chunk.iter().flat_map(|k| ["--at".to_owned(), at(*k)]));
                let answer: Value = serde_json::from_str(&run(&args)?).unwrap_or_default();
                for p in answer["points"].as_array().into_iter().flatten() {
                    found.push(std::array::from_fn(|k| p["point_mm"][k].as_f64().unwrap_or(f64::NAN)));
                }
            }
            Ok(Cloud::new(found.into_iter(), cell_mm))
        }
        Source::File { path, face, keys } => {
            // The files of points have no unit; the job says it.
            let unit = keys.lines().find_map(|l| l.strip_prefix("unit_mm = ")?.parse().ok());
            let scale: f64 = unit.unwrap_or(1.0);
            let mesh = place.join("face.stl");
            let words = [
                "export".to_owned(),
                data.join(path).to_string_lossy().into_owned(),
                "--faces".to_owned(),
                face.to_owned(),
                "--out".to_owned(),
                mesh.to_string_lossy().into_owned(),
                "--max-edge-mm".to_owned(),
                (1.5 * spacing / scale).to_string(),
            ];
            run(&words)?;
            let bytes = std::fs::read(&mesh).map_err(|why| Failure::Read { path: mesh.clone(), why })?;
            Ok(Cloud::new(dense::stl_points(&bytes).map(|p| p.map(|x| x * scale)), cell_mm))
        }
    }
}

/// The second opinion on a plan, mm.
fn look(summary: &Value, cloud: &Cloud, folder: &Path) -> Option<f64> {
    let cutter = Cutter::of(&summary["tool"])?;
    let cl = std::fs::read_to_string(folder.join("path.cl")).ok()?;
    let step_mm = 0.02 * summary["tool"]["diameter_mm"].as_f64()?;
    Some(dense::deepest_mm(&cl, &cutter, cloud, step_mm).0)
}

const HEAD: &str = "# Plans of real faces\n\nMade by `cargo xtask plans --data FOLDER`: every face planned by `auto` over four tools in wide holders, by isoparametric lines with \
the first of them, by isoparametric lines, constant scallop and streamlines with the one that `auto` chose (each with the best of six leads held all over), and in parallel planes with the ball on three axes; at the same \
tolerances (gouge half the scallop, chord a fifth), feed (2000 mm/min) and machine. Scallop and gouge are measured from \
the NC text, at samples some tenths of a strip apart, and at more of them wherever more than the limits might hide between these; a plan is *within* where everything is, with all that may hide after that, and *not shown* to be where only the samples are. *Use* is the median height of the crests between passes over the tolerance. *Ideal* is an estimate of the least time of any plan with the tools of the job, *isoparametric* that of isoparametric passes, each with the best lead at every place and as wide as its narrowest place, cut into up to four regions for nothing; *efficiency* is the ideal over the cutting time; `auto` chooses by the time on the control within tolerance; cutting time is by feed words, *on the control* is all of the program with accelerations and corners. The *second opinion* is how deep the cutter goes into some 40,000 points of the face at poses a fiftieth of its diameter apart, by formulas that share \
no code with the verification. *Wall* is the whole run of the program; the times of a row depend on the machine.\n\n\
| face | plan | tool, lead | passes | length mm | cutting min | on the control min | ideal min | isoparametric min | efficiency % | scallop / gouge mm | use | second opinion mm | within | wall s |\n\
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

const FIGURES: &str = "\n## Around umbilics\n\nThe passes of constant scallop with the toroidal cutter of 16 mm on the surfaces of M86 that have umbilics, coloured by the width of their strips \
(`path.svg` of the plan).\n\n![m86-3](figures/plan-m86-3.svg)\n\n![m86-4](figures/plan-m86-4.svg)\n";

/// Runs the program and reads its summary; what it says where there is none.
fn plan(program: &Path, job: &Path, out: &Path) -> Result<Value, String> {
    // A summary of an earlier run must not be taken for this one's.
    let _ = std::fs::remove_file(out.join("summary.json"));
    let done = Command::new(program).arg("plan").arg(job).arg("--out").arg(out).output();
    let said = done.map_err(|e| e.to_string())?;
    let text = std::fs::read_to_string(out.join("summary.json")).map_err(|_| {
        String::from_utf8_lossy(&said.stderr).lines().next().unwrap_or("no summary").to_owned()
    })?;
    serde_json::from_str(&text).map_err(|e| e.to_string())
}

fn row(name: &str, kind: &str, summary: &Result<Value, String>, second: Option<f64>) -> String {
    let s = match summary {
        Ok(s) => s,
        Err(why) => {
            let why = why.rsplit("job.toml: ").next().unwrap_or(why);
            return format!("| {name} | {kind} | not possible: {why} | | | | | | | | | | | | |\n");
        }
    };
    let text = |k: &str| s[k].as_str().unwrap_or("-").to_owned();
    let n = |v: &Value, digits: usize| v.as_f64().map_or("-".to_owned(), |x| format!("{x:.digits$}"));
    let v = &s["verification"];
    let lead = |s: &Value| match s["lead_range_deg"].as_array().map(Vec::as_slice) {
        Some([least, most]) => {
            let tilt = if s["tilt_range_deg"].is_null() { "" } else { ", tilt too" };
            format!("{} to {} deg, local{tilt}", n(least, 0), n(most, 0))
        }
        _ => format!("{} deg", n(&s["lead_deg"], 0)),
    };
    format!(
        "| {name} | {kind}: {} | {}, {} | {} | {} | {} | {} | {} | {} | {} | {} / {} | {} | {} | {} | {:.0} |\n",
        text("strategy"),
        text("tool_words"),
        lead(s),
        n(&s["passes"], 0),
        n(&s["cutting_length_mm"], 0),
        n(&s["cutting_time_min"], 2),
        n(&s["control_time_min"], 2),
        n(&s["ideal"]["time_min"], 2),
        n(&s["ideal"]["isoparametric_min"], 2),
        n(&s["efficiency_percent"], 0),
        n(&v["scallop_max_mm"], 4),
        n(&v["gouge_max_mm"], 4),
        n(&v["scallop_use"], 2),
        second.map_or("-".to_owned(), |d| format!("{d:.4}")),
        spent::answer(s),
        s["wall_s"]["total"].as_f64().unwrap_or(f64::NAN)
    )
}
