//! Sweeps: the same table whoever made its rows and in whatever order, runs that go on, and sweeps that cannot be meant.

use crate::common;
use common::{Run, Scratch, osculate};
use std::path::Path;

const JOB: &str = "format = 1\n[part]\nbuiltin = { kind = \"plane\", half_size_mm = 5 }\n\
                   [tool]\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 40\nteeth = 2\n[tolerance]\nscallop_mm = 0.1\n\
                   [strategy]\nkind = \"isoparametric\"\nlead_deg = 10\n[cutting]\nspindle_rpm = 8000\n\
                   [machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\nfeed = \"tcp\"\n";

/// Three tools, two parts, two tolerances.
const SWEEP: &str = "format = 1\njob = \"job.toml\"\n\
                     [[vary]]\nkey = \"tool.diameter_mm\"\nvalues = [4, 6, 8]\n\
                     [[vary]]\nname = \"part\"\ncases = [\n  { label = \"flat\" },\n  { label = \"bowl\", part.builtin = { kind = \"ellipsoid\", \
                     semi_axes_mm = [5, 5, 5], u_range = [-0.3, 0.3], v_range = [-0.3, 0.3], material = \"outside\" } },\n]\n\
                     [[vary]]\nkey = \"tolerance.scallop_mm\"\nvalues = [0.05, 0.1]\n";

fn sweep(file: &Path, out: &Path, more: &[&str]) -> Run {
    let mut args = vec!["sweep", file.to_str().unwrap(), "--out", out.to_str().unwrap()];
    args.extend(more);
    osculate(&args)
}

fn table(out: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(out.join("table.csv")).unwrap();
    text.lines().map(|l| l.split(',').map(ToOwned::to_owned).collect()).collect()
}

fn files(s: &Scratch) -> std::path::PathBuf {
    s.write("job.toml", JOB);
    s.write("sweep.toml", SWEEP)
}

#[test]
fn shards_in_any_order_and_runs_that_go_on_make_the_same_table() {
    let s = Scratch::new();
    let file = files(&s);
    let whole = s.path("whole");
    let run = sweep(&file, &whole, &["--threads", "2", "--json"]);
    let told = run.json();
    assert_eq!((&told["cases"], &told["complete"], &told["planned"]), (&12.into(), &true.into(), &12.into()));
    let rows = table(&whole);
    assert_eq!(rows.len(), 13);
    assert_eq!(rows[0][..5], ["case", "tool.diameter_mm", "part", "tolerance.scallop_mm", "answer"]);
    // The last thing varied changes from case to case.
    assert_eq!(rows[1][..4], ["1", "4", "flat", "0.05"]);
    assert_eq!(rows[12][..4], ["12", "8", "bowl", "0.1"]);
    let time = |case: usize| rows[case][5].parse::<f64>().unwrap();
    for flat in [1, 5] {
        assert_eq!(rows[flat][4], "held");
        // A larger ball and a wider tolerance are faster, by closed form in proportion to the square root of their product.
        assert!(time(flat + 1) < time(flat) && time(flat + 4) < time(flat), "{rows:?}");
    }
    assert!(rows[1..].iter().all(|r| r[4] == "held"), "{rows:?}");

    let shards = s.path("shards");
    for shard in ["3/3", "1/3"] {
        let run = sweep(&file, &shards, &["--shard", shard, "--threads", "1"]);
        assert!(run.out.contains("no table yet"), "{}{}", run.out, run.err);
    }
    sweep(&file, &shards, &["--merge"]).refused(&["4 of 12 cases have no row here (2, 5, 8, 11)", "--merge"]);
    assert!(!shards.join("table.csv").exists());
    // A run that is ended in the middle of a line goes on behind the last whole one.
    sweep(&file, &shards, &["--shard", "2/3"]);
    let rows_file = shards.join("rows-2-of-3.jsonl");
    let bytes = std::fs::read(&rows_file).unwrap();
    std::fs::write(&rows_file, &bytes[..bytes.len() - 40]).unwrap();
    let run = sweep(&file, &shards, &["--shard", "2/3", "--json"]);
    assert_eq!(run.json()["planned"], 1, "{}", run.err);
    sweep(&file, &shards, &["--merge"]);
    for name in ["table.csv", "sweep.html"] {
        let [a, b] = [&whole, &shards].map(|out| std::fs::read_to_string(out.join(name)).unwrap());
        assert_eq!(a, b, "{name}");
    }
    // Nothing is left to do; with another job everything is.
    assert_eq!(sweep(&file, &whole, &["--json"]).json()["planned"], 0);
    s.write("job.toml", &JOB.replace("spindle_rpm = 8000", "spindle_rpm = 9000"));
    let run = sweep(&file, &whole, &["--shard", "1/4", "--json"]);
    assert_eq!(run.json()["planned"], 3, "{}", run.err);
    assert!(run.err.contains("12 rows are of another job"), "{}", run.err);
    // No table is made of rows of the job as it was.
    let before = std::fs::read(whole.join("table.csv")).unwrap();
    sweep(&file, &whole, &["--merge"]).refused(&[
        "9 of 12 cases have rows of another job, other files or another version only (2, 3, 4, 6, 7, 8, 10, 11, ...)",
        "run the sweep without --merge",
        "--print 2",
    ]);
    assert_eq!(std::fs::read(whole.join("table.csv")).unwrap(), before);
}

#[test]
fn a_table_of_a_job_that_changed_since_is_refused_and_names_what_to_run_again() {
    let s = Scratch::new();
    s.write("job.toml", JOB);
    let text = |values: &str| {
        format!("format = 1\njob = \"job.toml\"\n[[vary]]\nkey = \"tool.diameter_mm\"\nvalues = [{values}]\n")
    };
    let file = s.write("sweep.toml", &text("4, 6, 8"));
    let out = s.path("out");
    sweep(&file, &out, &["--merge"]).refused(&["is no folder with rows", "then --merge"]);
    for shard in ["1/3", "2/3", "3/3"] {
        assert_eq!(sweep(&file, &out, &["--shard", shard]).code, 0);
    }
    let run = sweep(&file, &out, &["--merge"]);
    assert!(run.code == 0 && run.err.is_empty(), "{}", run.err);
    // One value is another: its case alone is of another job.
    s.write("sweep.toml", &text("4, 7, 8, 9"));
    sweep(&file, &out, &["--merge"]).refused(&[
        "1 of 4 cases have rows of another job, other files or another version only (2), and 1 have none",
        "run --shard 2/3 again, or the sweep without --merge",
        "--print 2 shows",
    ]);
    s.write("sweep.toml", &text("4, 7, 8"));
    assert_eq!(sweep(&file, &out, &["--shard", "2/3", "--json"]).json()["planned"], 1);
    // What is left of the old job is told and does no harm.
    let run = sweep(&file, &out, &["--merge"]);
    assert!(run.code == 0 && run.err.contains("1 rows are of another job"), "{}", run.err);
    assert_eq!(table(&out)[2][..2], ["2", "7"]);
}

#[test]
fn a_case_that_is_printed_is_the_job_that_was_planned() {
    let s = Scratch::new();
    let file = files(&s);
    let out = s.path("out");
    sweep(&file, &out, &["--shard", "6/12", "--plans"]);
    let printed = osculate(&["sweep", file.to_str().unwrap(), "--print", "6"]);
    assert_eq!(printed.code, 0, "{}", printed.err);
    assert!(
        printed.out.starts_with("# Case 6: tool.diameter_mm = 6, part = flat, tolerance.scallop_mm = 0.1.")
    );
    let job = s.write("six.toml", &printed.out);
    let alone = s.path("alone");
    let plan = osculate(&["plan", job.to_str().unwrap(), "--out", alone.to_str().unwrap(), "--json"]);
    assert_eq!(plan.code, 0, "{}", plan.err);
    let row = std::fs::read_to_string(out.join("rows-6-of-12.jsonl")).unwrap();
    let row: serde_json::Value = serde_json::from_str(&row).unwrap();
    assert_eq!(row["figures"]["numbers"][0], plan.json()["time_min"]);
    let program = |folder: &Path| std::fs::read_to_string(folder.join("path.cl")).unwrap();
    let moves =
        |text: String| text.lines().filter(|l| l.starts_with("GOTO")).map(str::to_owned).collect::<Vec<_>>();
    let [a, b] = [out.join("plans/000006"), alone].map(|f| moves(program(&f)));
    assert!(!a.is_empty() && a == b);
}

#[test]
fn a_sweep_that_cannot_be_meant_is_refused_before_the_work() {
    let s = Scratch::new();
    s.write("job.toml", JOB);
    let out = s.path("out");
    let head = "format = 1\njob = \"job.toml\"\n";
    let cases: [(&str, &[&str]); 10] = [
        ("vary = []", &["vary is empty"]),
        ("[[vary]]\nkey = \"tool.teeth\"\nvalues = []", &["vary[1]", "no values"]),
        ("[[vary]]\nkey = \"tool..teeth\"\nvalues = [1]", &["is no path", "tools[2].teeth"]),
        ("[[vary]]\nkey = \"tools[2].teeth\"\nvalues = [1]", &["tools is no list in the job"]),
        ("[[vary]]\nkey = \"tool.teeth\"\nvalues = [2, 2]", &["\"2\" twice", "label"]),
        (
            "[[vary]]\nkey = \"tool.teeth\"\nname = \"x\"\ncases = []",
            &["either key and values, or name and cases"],
        ),
        ("[[vary]]\nkeys = \"tool.teeth\"", &["unknown field `keys`", "line 4"]),
        (
            "[[vary]]\nkey = \"tool.teth\"\nvalues = [1, 2]",
            &["all 2 cases cannot be planned", "is teeth meant?"],
        ),
        (
            "[[vary]]\nkey = \"tool.teeth\"\nvalues = [1, 2]\n[[vary]]\nname = \"tool.teeth\"\ncases = [{}]",
            &["vary[2] is named \"tool.teeth\""],
        ),
        ("other = 1", &["unknown field `other`"]),
    ];
    for (text, words) in cases {
        let file = s.write("bad.toml", &format!("{head}{text}\n"));
        sweep(&file, &out, &[]).refused(words);
        assert!(!out.exists(), "what is refused leaves no folder: {text}");
    }
    let many = format!(
        "{head}{}",
        (0..8)
            .map(|k| format!(
                "[[vary]]\nname = \"v{k}\"\nkey = \"tool.teeth\"\nvalues = [1, 2, 3, 4, 5, 6, 7, 8, 9]\n"
            ))
            .collect::<String>()
    );
    sweep(&s.write("many.toml", &many), &out, &[]).refused(&["more than 10000000 cases"]);
    let lost = s.write("lost.toml", "format = 1\njob = \"none.toml\"\nvary = []\n");
    sweep(&lost, &out, &[]).refused(&["vary is empty"]);
    // One case of several that cannot be planned is a row of its own, told before the work.
    let text = format!("{head}[[vary]]\nkey = \"tool.kind\"\nvalues = [\"ball\", \"bull\"]\n");
    let run = sweep(&s.write("half.toml", &text), &out, &[]);
    assert_eq!(run.code, 0, "{}", run.out);
    assert!(run.err.contains("1 of 2 cases cannot be planned") && run.err.contains("case 2"), "{}", run.err);
    let rows = table(&out);
    assert_eq!((rows[1][2].as_str(), rows[2][2].as_str()), ("held", "failed"), "{rows:?}");
    // Shards are shards.
    let file = files(&s);
    for wrong in ["0/3", "4/3", "3", "a/b"] {
        let run = sweep(&file, &out, &["--shard", wrong]);
        assert!(run.code == 2 && run.err.contains("is no shard"), "{}", run.err);
    }
}
