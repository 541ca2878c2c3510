//! Every verb that judges a program gives the same verdict on it: `plan`'s own, and `verify`'s of the program that it wrote.

use crate::common;
use common::{Scratch, job, osculate};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Plans (or flank mills) a job, verifies the program that it wrote, and holds the two verdicts against each other, byte for byte.
fn agree(scratch: &Scratch, name: &str, verb: &str, job: &Path) -> Value {
    let out = scratch.path(name);
    let run = osculate(&[verb, job.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(run.code == 0 || run.code == 1, "{name}: {}{}", run.out, run.err);
    let summary: Value = serde_json::from_str(
        &std::fs::read_to_string(out.join("summary.json"))
            .unwrap_or_else(|e| panic!("{name}: {e}: {}{}", run.out, run.err)),
    )
    .unwrap();
    let is_program = |p: &PathBuf| p.file_stem().is_some_and(|s| s == "program");
    let program = std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().path()).find(is_program).unwrap();
    let checked = osculate(&["verify", program.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"]);
    assert_eq!(checked.code, run.code, "{name}: {}", checked.err);
    let v = checked.json();
    assert_eq!(summary["verdict"].to_string(), v["verdict"].to_string(), "{name}");
    let own = summary["verification"].as_object().unwrap();
    for (key, value) in own {
        assert_eq!(value.to_string(), v[key].to_string(), "{name}: {key}");
    }
    // The answer, the exit status and the key of older scripts say one thing.
    let held = v["verdict"]["answer"] == "held";
    assert_eq!((v["within_tolerance"] == true, run.code == 0), (held, held), "{name}");
    v["verdict"].clone()
}

/// Two pages of a text mesh of a box from (-8, -8, -12) to (8, 8, -6): a vice below the part.
fn vice() -> String {
    let (lo, hi) = ([-8.0, -8.0, -12.0], [8.0, 8.0, -6.0]);
    let at = |k: usize| -> [f64; 3] { [0, 1, 2].map(|a| if k >> a & 1 == 1 { hi[a] } else { lo[a] }) };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = String::from("solid vice\n");
    for [a, b, c, d] in faces {
        for t in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for k in t {
                let [x, y, z] = at(k);
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
    }
    text + "endsolid vice\n"
}

#[test]
fn small_jobs() {
    let s = Scratch::new();
    s.write("vice.stl", &vice());
    let dialect = |to: &str| {
        let to = to.to_owned();
        job(move |t| t.replace("dialect = \"linuxcnc\"", &format!("dialect = \"{to}\"")))
    };
    let three = "[machine]\nname = \"3-axis\"\ndialect = \"fanuc\"\n";
    let on_three = |t: String| {
        let from = t.find("[machine]").unwrap();
        let to = t.find("[verification]").unwrap();
        format!("{}{three}{}", &t[..from], &t[to..])
    };
    let planes = |t: String| {
        on_three(t)
            .replace("kind = \"isoparametric\"\nlead_deg = 15", "kind = \"isoplanar_3c\"\naxis = [0, 0, 1]")
    };
    let layers = |t: String| {
        on_three(t)
            .replace(
                "kind = \"isoparametric\"\nlead_deg = 15",
                "kind = \"z_level\"\nstepdown_mm = 1.5\nstepover_mm = 3\nallowance_mm = 0.3",
            )
            .replace("scallop_mm = 0.02", "scallop_mm = 1.5")
            .replace("gouge_mm = 0.005", "gouge_mm = 0.1")
            + "[stock]\nbox_mm = [-6.5, -6.5, -4, 6.5, 6.5, 2]\ncell_mm = 0.25\n"
    };
    let tools = |t: String| {
        t.replace("[tool]\nkind = \"ball\"\ndiameter_mm = 10\nlength_mm = 50\n", "")
            + "[[tools]]\nkind = \"ball\"\ndiameter_mm = 10\nlength_mm = 50\n\
               [[tools]]\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 40\n"
    };
    let cases: Vec<(&str, &str, String)> = vec![
        ("linuxcnc", "held", job(|t| t)),
        ("sinumerik", "held", dialect("sinumerik")),
        ("heidenhain", "held", dialect("heidenhain")),
        ("fanuc", "held", dialect("fanuc")),
        ("g93", "held", job(|t| t.replace("feed = \"tcp\"", "feed = \"inverse_time\""))),
        (
            "holder",
            "held",
            job(|t| {
                t.replace(
                    "length_mm = 50\n",
                    "length_mm = 50\nteeth = 3\n[tool.holder]\ndiameter_mm = 20\nlength_mm = 40\n",
                )
            }),
        ),
        ("stock", "held", job(|t| t + "[stock]\nbox_mm = [-7, -7, -10, 7, 7, 15]\ncell_mm = 0.5\n")),
        (
            "stock_in_the_way",
            "not_held",
            job(|t| {
                let block = "[stock]\nbox_mm = [-7, -7, -10, 7, 7, 15]\ncell_mm = 0.5\n";
                t.replace(
                    "length_mm = 50\n",
                    "length_mm = 12\n[tool.holder]\ndiameter_mm = 20\nlength_mm = 40\n",
                ) + block
            }),
        ),
        ("layer", "held", job(|t| t + "[stock]\nallowance_mm = 0.4\ncell_mm = 0.2\n")),
        ("fixture", "held", job(|t| t + "[fixture]\nfiles = [\"vice.stl\"]\n")),
        ("planes", "held", job(planes)),
        ("layers", "held", job(layers)),
        ("tools", "held", job(tools)),
    ];
    for (name, want, text) in cases {
        let path = s.write(&format!("{name}.toml"), &text);
        let verdict = agree(&s, name, "plan", &path);
        assert_eq!(verdict["answer"], want, "{name}: {verdict}");
    }
}

/// Whole parts take minutes with the build of tests: `cargo xtask parts` plans and verifies those, small ones are in `operations.rs`.
fn is_whole_part(job: &str) -> bool {
    job.lines().any(|line| line == "format = 2")
}

#[test]
fn every_other_example_of_one_operation() {
    let s = Scratch::new();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut names: Vec<String> = std::fs::read_dir(&examples)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let mut run = 0;
    for name in names {
        let job = examples.join(&name).join("job.toml");
        let text = std::fs::read_to_string(&job).unwrap();
        // The main job of the README is planned and verified by `.ci/run`, with the build that a user would run.
        if is_whole_part(&text) || name == "eee-hpt-rotor2" {
            continue;
        }
        run += 1;
        let verb = if text.contains("[flank]") { "flank" } else { "plan" };
        let verdict = agree(&s, &name, verb, &job);
        // A face that is bent 2.3 mm across cannot be flank milled, and the example shows how that is told.
        let want = if name == "centrifugal-blade" { "not_held" } else { "held" };
        assert_eq!(verdict["answer"], want, "{name}: {verdict}");
    }
    assert!(run >= 7, "{run}");
}
