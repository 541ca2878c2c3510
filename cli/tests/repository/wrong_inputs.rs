//! What is said of inputs that cannot be meant: what, where, what was expected, and what is nearest, held against
//! `wrong/golden.json`. After a change of words: `OSCULATE_BLESS=1 cargo test -p osculate --test repository wrong_inputs::`, and read what changed.

use crate::common;

use common::{Scratch, job, osculate};
use serde_json::{Map, Value, json};
use std::path::Path;

/// A name, what of the usual job is changed into what, and the verb with its arguments; `DIR` is the folder of the job.
type Case = (&'static str, &'static str, &'static str, &'static [&'static str]);

const CHECK: &[&str] = &["check", "DIR/job.toml"];
const BUILTIN: &str =
    "builtin = { kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 6 }";

/// Jobs of one operation.
const JOBS: &[Case] = &[
    ("table misspelt", "[tool]", "[toll]", CHECK),
    ("key misspelt", "diameter_mm = 10", "diametr_mm = 10", CHECK),
    ("key of another table", "lead_deg = 15", "scallop_mm = 0.01", CHECK),
    ("key of the other format", "[verification]", "operation = 3\n[verification]", CHECK),
    ("tool kind misspelt", "kind = \"ball\"", "kind = \"bal\"", CHECK),
    ("tool kind in capitals", "kind = \"ball\"", "kind = \"Ball\"", CHECK),
    ("strategy misspelt", "\"isoparametric\"", "\"isoparametrik\"", CHECK),
    ("machine misspelt", "\"trunnion-ac\"", "\"trunion-ac\"", CHECK),
    ("dialect misspelt", "\"linuxcnc\"", "\"linuxcmc\"", CHECK),
    ("feed mode misspelt", "feed = \"tcp\"", "feed = \"tpc\"", CHECK),
    ("table missing", "[tolerance]\nscallop_mm = 0.02\ngouge_mm = 0.005\nchord_mm = 0.003\n", "", CHECK),
    ("key missing", "diameter_mm = 10\n", "", CHECK),
    ("text for a number", "diameter_mm = 10", "diameter_mm = \"ten\"", CHECK),
    ("negative diameter", "diameter_mm = 10", "diameter_mm = -10", CHECK),
    ("no number", "scallop_mm = 0.02", "scallop_mm = nan", CHECK),
    ("tolerance of nothing", "scallop_mm = 0.02", "scallop_mm = 0", CHECK),
    ("corner larger than the tool", "kind = \"ball\"", "kind = \"toroidal\"\ncorner_radius_mm = 7", CHECK),
    ("ball with another corner", "kind = \"ball\"", "kind = \"ball\"\ncorner_radius_mm = 1", CHECK),
    ("ball longer than its length", "length_mm = 50", "length_mm = 3", CHECK),
    ("flutes longer than the tool", "length_mm = 50", "length_mm = 50\nflute_length_mm = 60", CHECK),
    ("no teeth", "length_mm = 50", "length_mm = 50\nteeth = 0", CHECK),
    (
        "holder of no diameter",
        "length_mm = 50",
        "length_mm = 50\nholder = { diameter_mm = 0, length_mm = 20 }",
        CHECK,
    ),
    (
        "holder key misspelt",
        "length_mm = 50",
        "length_mm = 50\nholder = { diameter_mm = 30, lenght_mm = 20 }",
        CHECK,
    ),
    ("cone without taper", "kind = \"ball\"", "kind = \"cone\"", CHECK),
    ("barrel smaller than the tool", "kind = \"ball\"", "kind = \"barrel\"\nbarrel_radius_mm = 2", CHECK),
    ("lead over the edge", "lead_deg = 15", "lead_deg = 95", CHECK),
    ("spindle stands", "spindle_rpm = 8000", "spindle_rpm = 0", CHECK),
    ("coolant misspelt", "spindle_rpm = 8000", "spindle_rpm = 8000\ncoolant = \"flod\"", CHECK),
    ("format of the future", "format = 1", "format = 3", CHECK),
    ("no format", "format = 1\n", "", CHECK),
    ("no TOML", "[tool]", "[tool", CHECK),
    ("key twice", "length_mm = 50", "length_mm = 50\nlength_mm = 40", CHECK),
    ("built-in misspelt", "paraboloid", "parabloid", CHECK),
    ("built-in key misspelt", "half_size_mm", "half_size", CHECK),
    ("two parts", BUILTIN, "file = \"a.step\"\nbuiltin = { kind = \"plane\", half_size_mm = 6 }", CHECK),
    ("part missing", BUILTIN, "file = \"none.step\"", CHECK),
    ("part is no CAD file", BUILTIN, "file = \"job.toml\"", CHECK),
    ("part of another kind", BUILTIN, "file = \"part.sldprt\"", CHECK),
    ("face that is not there", BUILTIN, "file = \"PART\"\nfaces = [\"F99\"]", CHECK),
    ("face in small letters", BUILTIN, "file = \"PART\"\nfaces = [\"f12\"]", CHECK),
    ("more faces than there are", BUILTIN, "file = \"PART\"\nfaces = { largest = 99 }", CHECK),
    (
        "may hit a face that is not there",
        BUILTIN,
        "file = \"PART\"\nfaces = [\"F3\"]\nmay_hit = [\"F99\"]",
        CHECK,
    ),
    (
        "side misspelt",
        "[tool]",
        "[[part.side]]\nfaces = [\"F1\"]\nmaterial = \"bellow_normal\"\n[tool]",
        CHECK,
    ),
    ("stock of nothing", "[verification]", "[stock]\n[verification]", CHECK),
    ("stock key misspelt", "[verification]", "[stock]\nbox = [0, 0, 0, 1, 1, 1]\n[verification]", CHECK),
    (
        "stock box turned over",
        "[verification]",
        "[stock]\nbox_mm = [0, 0, 0, 1, -1, 1]\n[verification]",
        CHECK,
    ),
    ("stock file missing", "[verification]", "[stock]\nfile = \"none.stl\"\n[verification]", CHECK),
    ("stock is no mesh", "[verification]", "[stock]\nfile = \"job.toml\"\n[verification]", CHECK),
    (
        "stock cylinder turned over",
        "[verification]",
        "[stock]\ncylinder = { diameter_mm = 9, z_mm = [5, 0] }\n[verification]",
        CHECK,
    ),
    ("fixture missing", "[verification]", "[fixture]\nfiles = [\"vice.stl\"]\n[verification]", CHECK),
    ("no job", "", "", &["check", "DIR/none.toml"]),
    ("a folder for a job", "", "", &["check", "DIR"]),
    ("strip without contact", "", "", &["strip", "DIR/job.toml"]),
    (
        "contact outside",
        "[verification]",
        "[contact]\nat = [99, 0]\nalong = \"u\"\n[verification]",
        &["strip", "DIR/job.toml"],
    ),
    (
        "contact along misspelt",
        "[verification]",
        "[contact]\nat = [0, 0]\nalong = \"x\"\n[verification]",
        &["strip", "DIR/job.toml"],
    ),
    ("axes of a face that is not there", "", "", &["axes", "DIR/job.toml", "--face", "F99"]),
    ("axes outside", "", "", &["axes", "DIR/job.toml", "--face", "F1", "--at", "99,0"]),
    ("axes at no place", "", "", &["axes", "DIR/job.toml", "--at", "here"]),
    (
        "axes of one of several faces",
        BUILTIN,
        "file = \"PART\"\nfaces = [\"F1\", \"F2\"]",
        &["axes", "DIR/job.toml", "--at", "0,0"],
    ),
    (
        "axes of a face that is not machined",
        BUILTIN,
        "file = \"PART\"\nfaces = [\"F1\", \"F2\"]",
        &["axes", "DIR/job.toml", "--face", "F3"],
    ),
    (
        "axes of a tool that keeps its axis",
        "kind = \"isoparametric\"\nlead_deg = 15",
        "kind = \"isoplanar_3c\"",
        &["axes", "DIR/job.toml"],
    ),
    ("axes into a file", "", "", &["axes", "DIR/job.toml", "--out", "DIR/job.toml"]),
    ("compare into a file", "", "", &["compare", "DIR/job.toml", "--out", "DIR/job.toml"]),
    ("plan into a file", "", "", &["plan", "DIR/job.toml", "--out", "DIR/job.toml"]),
    ("no program", "", "", &["verify", "DIR/none.ngc", "--job", "DIR/job.toml"]),
    ("an empty program", "", "", &["verify", "DIR/empty.ngc", "--job", "DIR/job.toml"]),
    ("a program that is none", "", "", &["verify", "DIR/words.ngc", "--job", "DIR/job.toml"]),
    ("CL data that are none", "", "", &["verify", "DIR/words.cl", "--job", "DIR/job.toml"]),
];

/// Other verbs, and command lines.
const VERBS: &[Case] = &[
    ("init of nothing", "", "", &["init", "DIR/none.step", "--out", "DIR/out"]),
    ("init of a text", "", "", &["init", "DIR/job.toml", "--out", "DIR/out"]),
    ("init into a file", "", "", &["init", "PART", "--out", "DIR/job.toml"]),
    ("init over a job", "", "", &["init", "PART", "--out", "DIR"]),
    ("init of a face that is not there", "", "", &["init", "PART", "--faces", "F99", "--out", "DIR/out"]),
    ("init on a machine misspelt", "", "", &["init", "PART", "--machine", "trunion-ac", "--out", "DIR/out"]),
    ("init with no library", "", "", &["init", "PART", "--tools", "DIR/none.toml", "--out", "DIR/out"]),
    ("library of another kind", "", "", &["tools", "DIR/part.sldprt"]),
    ("library packed", "", "", &["tools", "DIR/packed.tools"]),
    ("library of no tools", "", "", &["tools", "DIR/empty.toml"]),
    ("library key misspelt", "", "", &["tools", "DIR/wrong.toml"]),
    ("library is no JSON", "", "", &["tools", "DIR/broken.json"]),
    ("library is other JSON", "", "", &["tools", "DIR/other.json"]),
    ("table of drills", "", "", &["tools", "DIR/drills.tbl"]),
    ("bit of another shape", "", "", &["tools", "DIR/drill.fctb"]),
    ("probe of a face that is not there", "", "", &["probe", "PART", "--face", "F33", "--at", "0,0"]),
    ("probe outside", "", "", &["probe", "--builtin", "kind = \"sphere\", radius_mm = 5", "--at", "0,9"]),
    ("built-in that is none", "", "", &["inspect", "--builtin", "kind = \"spere\", radius_mm = 5"]),
    ("export of another kind", "", "", &["export", "PART", "--out", "DIR/a.dwg"]),
    ("verb misspelt", "", "", &["plam", "DIR/job.toml"]),
    ("option misspelt", "", "", &["plan", "DIR/job.toml", "--ouy", "DIR/out"]),
    ("option missing", "", "", &["plan", "DIR/job.toml"]),
    ("shell misspelt", "", "", &["completions", "bsh"]),
    ("count of none", "", "", &["compare", "DIR/job.toml", "--nodes", "0"]),
];

/// Lists of operations.
const LISTS: &[(&str, &str, &str)] = &[
    ("operation kind misspelt", "kind = \"finish\"", "kind = \"finsh\""),
    ("operation with no such tool", "tools = [1]", "tools = [4]"),
    ("operation in no such setup", "tools = [1]", "tools = [1]\nsetup = \"op11\""),
    ("operation key misspelt", "tools = [1]", "tool = [1]"),
    (
        "tool number twice",
        "[[operation]]",
        "[[tool]]\nnumber = 1\nkind = \"ball\"\ndiameter_mm = 4\n[[operation]]",
    ),
    ("setup key misspelt", "name = \"op10\"", "name = \"op10\"\nrotate = [0, 0, 0]"),
    ("roughing without stock", "kind = \"finish\"", "kind = \"rough\"\nstepdown_mm = 1"),
    ("repeat of once", "tools = [1]", "tools = [1]\nrepeat = 1"),
];

const LIST: &str = r#"format = 2
[part]
builtin = { kind = "plane", half_size_mm = 6 }
[tolerance]
scallop_mm = 0.02
gouge_mm = 0.005
chord_mm = 0.003
[machine]
name = "trunnion-ac"
dialect = "linuxcnc"
[[tool]]
number = 1
kind = "ball"
diameter_mm = 6
cutting = { spindle_rpm = 8000, feed_mm_min = 800 }
[[setup]]
name = "op10"
[[operation]]
kind = "finish"
tools = [1]
strategy = { kind = "isoparametric", lead_deg = 10 }
"#;

/// Files that the cases read.
const FILES: &[(&str, &str)] = &[
    ("part.sldprt", "no part"),
    ("empty.ngc", ""),
    ("words.ngc", "once upon a time\n"),
    ("words.cl", "once upon a time\n"),
    ("packed.tools", "PK"),
    ("empty.toml", "format = 1\n"),
    ("wrong.toml", "format = 1\n[[tool]]\nkind = \"ball\"\ndiamter_mm = 3\n"),
    ("broken.json", "{ \"data\": [ "),
    ("other.json", "{ \"tools\": [] }"),
    ("drills.tbl", "T1 P1 D3 ;jobber drill\nT2 P2 ;ball 4\n"),
    (
        "drill.fctb",
        "{ \"version\": 2, \"name\": \"d\", \"shape\": \"drill.fcstd\", \"parameter\": { \"Diameter\": \"3 mm\" } }",
    ),
];

#[test]
fn each_wrong_input_is_told_as_it_was_found_good() {
    let part = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/mould/mould.step");
    let part = part.to_str().unwrap();
    let mut said = Map::new();
    let mut off = Vec::new();
    let mut one = |name: &str, text: String, args: &[&str]| {
        let scratch = Scratch::new();
        let dir = scratch.path("").to_str().unwrap().trim_end_matches('/').to_owned();
        FILES.iter().for_each(|(name, text)| drop(scratch.write(name, text)));
        scratch.write("job.toml", &text.replace("PART", part));
        let args: Vec<String> = args.iter().map(|a| a.replace("DIR", &dir).replace("PART", part)).collect();
        let run = osculate(&[&args[..], &["--json".to_owned()]].concat());
        let error = &run.json()["error"];
        let mut told = json!({"code": run.code});
        for key in ["what", "where", "expected", "nearest"] {
            let text = error[key].as_str().map(|t| t.replace(&dir, "DIR").replace(part, "PART"));
            told[key] = json!(text);
        }
        if error.is_null() {
            off.push(format!("{name}: taken, code {}", run.code));
            return;
        }
        let what = told["what"].as_str().unwrap();
        // What a parser of others says of its own insides helps nobody.
        let bare = [
            "panicked",
            "TOML parse error",
            "unknown field",
            "unknown variant",
            "invalid type",
            "Os {",
            "Err(",
        ];
        if what.is_empty() || run.code == 0 || run.err.is_empty() || bare.iter().any(|b| what.contains(b)) {
            off.push(format!("{name}: {told}"));
        }
        said.insert(name.to_owned(), told);
    };
    for (name, from, to, args) in JOBS.iter().chain(VERBS) {
        let text = job(|j| j);
        assert!(text.contains(from), "{name}: {from}");
        one(name, text.replacen(from, to, 1), args);
    }
    for (name, from, to) in LISTS {
        assert!(LIST.contains(from), "{name}: {from}");
        one(name, LIST.replacen(from, to, 1), CHECK);
    }
    assert!(off.is_empty(), "{}", off.join("\n"));
    assert!(said.len() >= 60, "{}", said.len());
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/repository/wrong/golden.json");
    if std::env::var_os("OSCULATE_BLESS").is_some() {
        std::fs::write(&golden, serde_json::to_string_pretty(&said).unwrap() + "\n").unwrap();
    }
    let kept: Map<String, Value> = serde_json::from_str(&std::fs::read_to_string(&golden).unwrap()).unwrap();
    for (name, told) in &said {
        if kept.get(name) != Some(told) {
            off.push(format!("{name}: said {told}\n  golden {}", kept.get(name).unwrap_or(&Value::Null)));
        }
    }
    assert!(off.is_empty(), "{}", off.join("\n"));
    assert_eq!(kept.len(), said.len(), "the golden file has cases that are gone");
}
