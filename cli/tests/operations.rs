//! Lists of operations: several tools and setups, raw material handed on, one program a setup, and what cannot be meant.

use crate::common;
use common::{Run, Scratch, osculate};
use serde_json::Value;

/// Roughing and finishing of a shallow dish from a block, and what is left of it with a smaller ball.
const LIST: &str = r#"format = 2
[part]
builtin = { kind = "paraboloid", a_per_mm = 0.01, b_per_mm = 0.02, half_size_mm = 6 }
[stock]
box_mm = [-6, -6, -5, 6, 6, 4]
cell_mm = 0.25
[tolerance]
scallop_mm = 0.04
gouge_mm = 0.02
[verification]
spacing_mm = 0.1
accept = "samples"
[machine]
name = "trunnion-ac"
dialect = "linuxcnc"
program_number = 70
[[tool]]
number = 4
name = "flat 6"
kind = "flat"
diameter_mm = 6
length_mm = 30
teeth = 2
cutting = { spindle_rpm = 6000, feed_mm_min = 900, coolant = "flood" }
[[tool]]
number = 7
kind = "ball"
diameter_mm = 6
length_mm = 40
teeth = 2
cutting = { spindle_rpm = 9000, feed_mm_min = 1500 }
[[operation]]
name = "rough"
kind = "rough"
tools = [4]
allowance_mm = 0.4
[[operation]]
name = "finish"
kind = "finish"
tools = [7]
strategy = { kind = "isoplanar_3c" }
"#;

fn planned(scratch: &Scratch, text: &str) -> Run {
    let job = scratch.write("job.toml", text);
    osculate(&["plan", job.to_str().unwrap(), "--out", scratch.path("out").to_str().unwrap(), "--json"])
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))
}

#[test]
fn a_list_becomes_one_program_with_its_tools_and_verify_says_the_same() {
    let scratch = Scratch::new();
    let run = planned(&scratch, LIST);
    let v = run.json();
    assert_eq!((run.code, &v["verdict"]["answer"]), (0, &"held".into()), "{}", v["verdict"]);
    let all = v["operations"].as_array().unwrap();
    let kinds: Vec<_> =
        all.iter().map(|o| (o["kind"].as_str().unwrap(), o["tool_number"].as_u64())).collect();
    assert_eq!(kinds, [("rough", Some(4)), ("finish", Some(7))]);
    // What one leaves is where the next begins, and the finish stands on what the roughing left on purpose.
    let before = number(&all[0]["left_mm3"]) - number(&all[1]["left_mm3"]);
    assert!((before - number(&all[1]["removed_mm3"])).abs() < 1e-6 * number(&all[0]["left_mm3"]));
    let standing = number(&all[1]["standing_mm"]);
    assert!((0.4..2.0).contains(&standing), "{standing}");
    for key in ["passes", "points", "cutting_length_mm", "air_length_mm", "time_min"] {
        let sum: f64 = all.iter().map(|o| number(&o[key])).sum();
        assert!((sum - number(&v[key])).abs() < 1e-9 * sum, "{key}: {sum} {}", v[key]);
    }
    // The finish's ball stands upright on slopes of up to tan = .12 and .24: its edge is as fast as its radius there lets it be, and next to
    // nothing at the bottom. Of both tools together there is no one speed.
    let speed = &all[1]["productivity"]["cutting_speed_m_min"];
    let steepest = 0.12f64.hypot(0.24).atan();
    let fastest = std::f64::consts::TAU * 3.0 * steepest.sin() * 9.0;
    assert!(
        (number(&speed["max"]) / fastest - 1.0).abs() < 0.03 && number(&speed["min"]) < 1.0,
        "{speed}, {fastest}"
    );
    assert!(
        v["productivity"]["cutting_speed_m_min"].is_null() && v["productivity"]["finished_mm2"].is_number()
    );
    // From the block down to the dish: the volume between them, by the integral of a x^2 + b y^2.
    let between = 144.0 * (4.0 - (0.01 + 0.02) * 36.0 / 3.0);
    let taken: f64 = all.iter().map(|o| number(&o["removed_mm3"])).sum();
    assert!((taken - between).abs() < 0.01 * between, "{taken} {between}");
    let program = std::fs::read_to_string(scratch.path("out/program.ngc")).unwrap();
    let calls: Vec<&str> = program.lines().filter(|l| l.contains("M6")).collect();
    assert!(calls.len() == 2 && calls[0].contains("T4") && calls[1].contains("T7"), "{calls:?}");
    for words in ["S6000", "S9000", "operation 2: finish, T7"] {
        assert!(program.contains(words), "{words}");
    }
    let table = std::fs::read_to_string(scratch.path("out/tool.tbl")).unwrap();
    assert_eq!(table, "T4 P4 Z30.0000 D6.0000 ;flat 6\nT7 P7 Z40.0000 D6.0000 ;ball 6\n");
    for name in ["path-1.cl", "path-2.cl", "stock-1.stl", "stock-2.ply", "report.html", "picture.svg"] {
        assert!(scratch.path("out").join(name).is_file(), "{name}");
    }
    let (job, file) = (scratch.path("job.toml"), scratch.path("out/program.ngc"));
    let verify = |text: &str| {
        std::fs::write(&file, text).unwrap();
        osculate(&["verify", file.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"])
    };
    let again = verify(&program).json();
    assert_eq!(again["verdict"], v["verdict"]);
    assert_eq!(again["within_tolerance"], v["verification"]["within_tolerance"]);
    for (key, value) in v["verification"].as_object().unwrap() {
        assert_eq!(&again[key], value, "{key}");
    }
    // The finishing tool left out: the roughing's length is stated for what follows.
    let finish = program.lines().position(|l| l.contains("T7") && l.contains("M6")).unwrap();
    let one_tool: Vec<&str> =
        program.lines().enumerate().filter(|(k, _)| *k != finish).map(|(_, l)| l).collect();
    let spoilt = verify(&(one_tool.join("\n") + "\n"));
    assert_eq!(spoilt.code, 1, "{}", spoilt.out);
    assert_ne!(spoilt.json()["verdict"]["answer"], "held");
    let unknown = verify(&program.replace("T7", "T8"));
    unknown.refused(&["calls T8, but the tools of the job are 4, 7"]);
}

#[test]
fn the_second_setup_begins_with_what_the_first_left_and_fixtures_count_in_their_own() {
    let scratch = Scratch::new();
    // A pin that ends above the finished face and below what the roughing leaves on it.
    scratch.write("bar.stl", &bar([-0.5, -0.5, 0.1], [0.5, 0.5, 0.3]));
    let setups = "[[setup]]\nname = \"op10\"\n[[setup]]\nname = \"op20\"\nrotate_deg = [0, 0, 90]\n";
    let second = LIST.replace("name = \"finish\"\n", "name = \"finish\"\nsetup = \"op20\"\n");
    let v = planned(&scratch, &(second.clone() + setups)).json();
    assert_eq!(v["verdict"]["answer"], "held", "{}", v["verdict"]);
    let names: Vec<_> = v["setups"].as_array().unwrap().iter().map(|s| s["program"].clone()).collect();
    assert_eq!(names, ["program-op10.ngc", "program-op20.ngc"]);
    assert!((number(&v["setups"][1]["rotate_deg"][2]) - 90.0).abs() < 1e-9);
    let all = &v["operations"];
    let (left, taken) = (number(&all[0]["left_mm3"]), number(&all[1]["removed_mm3"]));
    assert!((left - taken - number(&all[1]["left_mm3"])).abs() < 1e-6 * left);
    let [one, two] = ["out/program-op10.ngc", "out/program-op20.ngc"].map(|f| scratch.path(f));
    let job = scratch.path("job.toml");
    let args = [&one, &two].map(|p| p.to_str().unwrap().to_owned());
    let verify = |files: &[String]| {
        let more = ["--job", job.to_str().unwrap(), "--json"].map(ToOwned::to_owned);
        osculate(&[&["verify".to_owned()], files, &more].concat())
    };
    assert_eq!(verify(&args).json()["verdict"], v["verdict"]);
    verify(&args[..1]).refused(&["1 programs are given for 2 setups", "op10, op20"]);
    // The first program may not stand for the second: what it leaves is far too high.
    assert_eq!(verify(&[args[0].clone(), args[0].clone()]).code, 1);
    // The finishing runs into the pin.
    let held = setups.replace("name = \"op20\"", "name = \"op20\"\nfixtures = [\"bar.stl\"]");
    let hit = planned(&scratch, &(second.clone() + &held)).json();
    assert_eq!(hit["verdict"]["answer"], "not_held", "{}", hit["verdict"]);
    let why = hit["verdict"]["why"].to_string();
    assert!(why.contains("gouge"), "{why}");
    assert!(hit["worst"].as_array().unwrap().iter().any(|w| w["face"] == "fixture"), "{}", hit["worst"]);
    // Only while the part is roughed it is in nobody's way.
    let aside = setups.replace("name = \"op10\"", "name = \"op10\"\nfixtures = [\"bar.stl\"]");
    let clear = planned(&scratch, &(second + &aside)).json();
    assert_eq!(clear["verdict"]["answer"], "held", "{}", clear["verdict"]);
}

/// A box as a mesh.
fn bar(lo: [f64; 3], hi: [f64; 3]) -> String {
    let p = |k: usize| [0, 1, 2].map(|j| if k >> j & 1 == 0 { lo[j] } else { hi[j] });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = String::from("solid bar\n");
    for [a, b, c, d] in quads {
        for t in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for k in t {
                let [x, y, z] = p(k);
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
    }
    text + "endsolid\n"
}

#[test]
fn rest_goes_where_too_much_stands_and_only_there() {
    let scratch = Scratch::new();
    // A finishing that leaves high cusps, and a rest with the same ball.
    let coarse = LIST.replace("kind = \"finish\"\n", "kind = \"finish\"\nscallop_mm = 0.3\n");
    let rest = "[[operation]]\nname = \"rest\"\nkind = \"rest\"\ntools = [7]\n";
    let v = planned(&scratch, &(coarse + rest)).json();
    assert_eq!(v["verdict"]["answer"], "held", "{}", v["verdict"]);
    let all = v["operations"].as_array().unwrap();
    let high = number(&all[2]["too_high_mm2"]);
    assert!(high > 10.0 && high < 140.0, "{high}");
    // Both go over the one face, which counts once in the least time: strips of a ball of 6 mm at the scallop of the part, on hollows that
    // widen them by some hundredths, over a dish hardly larger than its square.
    let flat_min = 144.0 / (1500.0 * 2.0 * f64::sqrt(0.04 * (6.0 - 0.04)));
    let least_min = number(&v["ideal"]["time_min"]);
    assert!((0.88..1.0).contains(&(least_min / flat_min)), "{least_min} {flat_min}");
    let cutting_min: f64 = all[1..].iter().map(|o| number(&o["cutting_time_min"])).sum();
    let efficiency = number(&v["efficiency_percent"]);
    assert!(efficiency > 1.0 && efficiency <= 100.0 * least_min / cutting_min + 1e-9, "{efficiency}");
    // Nothing is left for a rest after a finishing to tolerance.
    let v = planned(&scratch, &(LIST.to_owned() + rest)).json();
    assert_eq!((v["operations"].as_array().unwrap().len(), &v["verdict"]["answer"]), (2, &"held".into()));
    let told = v["diagnostics"].to_string();
    assert!(told.contains("rest: nothing stands above its tolerance"), "{told}");
}

#[test]
fn a_finishing_that_may_leave_a_little_too_much_is_laid_out_again() {
    let scratch = Scratch::new();
    // So few samples do not show that all of the tolerance holds.
    let few = LIST.replace("spacing_mm = 0.1\naccept = \"samples\"", "max_samples = 4000");
    let named =
        |mm: f64| few.replace("kind = \"finish\"\n", &format!("kind = \"finish\"\nscallop_mm = {mm}\n"));
    let notes = |v: &Value| -> Vec<String> {
        let all = v["diagnostics"].as_array().unwrap().iter().map(|d| d.as_str().unwrap().to_owned());
        all.filter(|d| d.contains("laid out again")).collect()
    };
    let all = planned(&scratch, &named(0.04)).json();
    let [note] = &notes(&all)[..] else { panic!("{:?}", all["diagnostics"]) };
    assert!(note.contains("where 0.04000 mm are accepted: finish for 0.03"), "{note}");
    assert_eq!(
        all["within_tolerance"].as_bool().or(all["verification"]["within_tolerance"].as_bool()),
        Some(true)
    );
    // What was laid out for less to begin with is not.
    let less = planned(&scratch, &named(0.034)).json();
    assert!(notes(&less).is_empty(), "{:?}", notes(&less));
    for v in [&all, &less] {
        let finish = &v["operations"][1];
        assert_eq!(finish["step"], "held");
        assert!(number(&finish["verification"]["height_max_mm"]) < 0.04);
    }
    // What leaves more on purpose is left as it is named.
    let more = planned(&scratch, &named(0.05)).json();
    assert!(notes(&more).is_empty(), "{:?}", notes(&more));
    assert_eq!(more["verdict"]["answer"], "not_held");
}

#[test]
fn a_list_is_derived_and_runs_again_from_where_it_was_written() {
    let scratch = Scratch::new();
    let none = LIST.split("[[operation]]").next().unwrap();
    let run = planned(&scratch, none);
    let v = run.json();
    assert_eq!((run.code, &v["verdict"]["answer"]), (0, &"held".into()), "{}", v["verdict"]);
    let kinds: Vec<_> = v["operations"].as_array().unwrap().iter().map(|o| o["kind"].clone()).collect();
    assert_eq!(kinds, ["rough", "finish"]);
    let resolved = scratch.path("out/job.resolved.toml");
    let text = std::fs::read_to_string(&resolved).unwrap();
    assert!(text.contains("# T4 is the largest that cuts layers well."), "{text}");
    let again = scratch.path("again");
    let args = ["plan", resolved.to_str().unwrap(), "--out", again.to_str().unwrap(), "--json"];
    assert_eq!(osculate(&args).json()["verdict"], v["verdict"]);
    for name in ["path-1.cl", "path-2.cl", "stock-2.stl"] {
        let [a, b] = [scratch.path("out").join(name), again.join(name)].map(|p| std::fs::read(p).unwrap());
        assert!(a == b, "{name}");
    }
}

/// A list that only roughs is planned, and its part is not held. The same once more finds nothing to take.
#[test]
fn level_faces_are_left_to_the_bottom_of_the_tool_that_roughs() {
    use osculate::job::Operations;
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/mould/job.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let head = &text[..text.find("[[operation]]").unwrap()];
    let derived = |head: &str| {
        let list = Operations::from_toml(head, &path).unwrap();
        osculate::work::operations::part(list, &()).unwrap()
    };
    let (part, list) = derived(head);
    let faces = |k: usize| -> Vec<String> {
        let one = &list.all()[k];
        let seen = osculate::work::operations::seen(one, &one.judged().unwrap(), &part).unwrap();
        seen.faces.into_iter().map(|f| f.id).collect()
    };
    let names: Vec<&str> = list.all().iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["rough", "level faces", "finish", "rest 1"]);
    // The top of the mould; the rest goes wherever too much stands.
    assert_eq!(faces(1), ["F3"]);
    assert_eq!((faces(3).len(), &faces(3)[0][..]), (18, "F3"));
    assert_eq!(faces(2), faces(3)[1..]);
    assert_eq!(list.all()[1].judged().unwrap().tool().number(), 1);
    // A ball has no bottom.
    let ball = head.replace("name = \"flat 12\"\nkind = \"flat\"", "name = \"ball 12\"\nkind = \"ball\"");
    assert_eq!(derived(&ball).1.all().len(), 3);
}

#[test]
fn a_second_roughing_knows_what_the_first_left() {
    let scratch = Scratch::new();
    scratch.write("bar.stl", &bar([-3.0, -3.0, -3.0], [3.0, 3.0, 3.0]));
    let head = LIST.split("[[operation]]").next().unwrap();
    let rough = |name: &str, keys: &str| {
        format!(
            "[[operation]]\nname = \"{name}\"\nkind = \"rough\"\ntools = [4]\nallowance_mm = 0.3\nstepdown_mm = 1\n{keys}"
        )
    };
    let once = planned(&scratch, &(head.to_owned() + &rough("once", ""))).json();
    assert_eq!(once["verdict"]["answer"], "not_held", "{}", once["verdict"]);
    assert_eq!(once["operations"][0]["step"], "held", "{}", once["operations"][0]["verdict"]);
    let twice = head.to_owned() + &rough("once", "") + &rough("again", "");
    planned(&scratch, &twice).refused(&["again", "nothing stands on it"]);
}

#[test]
fn what_cannot_be_meant_is_refused_at_once() {
    let scratch = Scratch::new();
    let bar = bar([-3.0, -3.0, -3.0], [3.0, 3.0, 3.0]);
    scratch.write("bar.stl", &bar);
    let refused = |text: &str, words: &[&str]| {
        let begun = std::time::Instant::now();
        planned(&scratch, text).refused(words);
        assert!(begun.elapsed().as_secs_f64() < 0.5, "{words:?}");
        assert!(!scratch.path("out").join("summary.json").exists());
    };
    let tool = "number = 7\n";
    refused(
        &LIST.replace(tool, "number = 4\n"),
        &["[[tool]] number 2", "number = 4 is that of a tool before it"],
    );
    refused(&LIST.replace(tool, ""), &["line ", "[[tool]] number 2", "needs number"]);
    refused(&LIST.replace("tools = [7]", "tools = [9]"), &["tools names 9, but the tools are 4, 7"]);
    refused(&LIST.replace("tools = [7]", "tools = []"), &["the list of tools is empty"]);
    refused(&LIST.replace("tools = [4]", "tools = [4, 7]"), &["kind = \"rough\" takes one tool"]);
    refused(
        &LIST.replace("name = \"finish\"", "name = \"rough\""),
        &["name = \"rough\" is that of an operation"],
    );
    refused(
        &LIST.replace("kind = \"finish\"", "kind = \"finsih\""),
        &["[[operation]] number 2", "(is \"finish\" meant?)"],
    );
    refused(&LIST.replace("tools = [7]", "tool = [7]"), &["tool is no key here", "(is tools meant?)"]);
    refused(&LIST.replace("tools = [7]", "setup = \"op20\""), &["setup = \"op20\" is none of op10"]);
    refused(
        &LIST.replace("strategy = { kind = \"isoplanar_3c\" }", "stepdown_mm = 1"),
        &["stepdown_mm is for kind = \"rough\""],
    );
    refused(
        &LIST.replace("kind = \"finish\"", "kind = \"finish\"\nallowance_mm = 0.1"),
        &["only kind = \"rough\" leaves an allowance"],
    );
    let stock = "box_mm = [-6, -6, -5, 6, 6, 4]\ncell_mm = 0.25\n";
    refused(&LIST.replace(&format!("[stock]\n{stock}"), ""), &["kind = \"rough\" needs the raw material"]);
    refused(&LIST.replace("box_mm = [-6, ", "box_mm = [-5, "), &["does not hold the part"]);
    let only = |kind: &str| {
        let head = LIST.split("[[operation]]").next().unwrap();
        format!("{head}[[operation]]\nkind = \"{kind}\"\ntools = [4]\n")
    };
    refused(&only("rest"), &["kind = \"rest\" cuts what operations before it left: there is none"]);
    let rough = |keys: &str| LIST.replace("kind = \"rough\"", &format!("kind = \"rough\"\n{keys}"));
    refused(
        &rough("axis = [0, 0, 1]\ndirections = \"auto\""),
        &["directions finds the axes, and axis gives one"],
    );
    refused(&rough("least_share = 0.1"), &["least_share is for found axes"]);
    refused(&rough("entry = \"spiral\""), &["entry = \"spiral\"", "helix"]);
    refused(
        &LIST.replace("kind = \"finish\"", "kind = \"finish\"\nentry = \"ramp\""),
        &["entry is for kind = \"rough\""],
    );
    let none = LIST.split("[[operation]]").next().unwrap();
    refused(&none.replace(&format!("[stock]\n{stock}"), ""), &["has no [[operation]]", "add one of the two"]);
    let setup = "[[setup]]\nname = \"a\"\n[[setup]]\nname = \"a\"\n";
    refused(&(LIST.to_owned() + setup), &["[[setup]] number 2", "name = \"a\" is that of a setup before it"]);
    // Verbs of one operation say what they take.
    let job = scratch.write("list.toml", LIST);
    osculate(&["compare", job.to_str().unwrap()])
        .refused(&["a list of operations is taken by plan, verify, check and post"]);
    refused(&LIST.replace("format = 2", "format = 3"), &["format = 3 must be"]);
}

/// Five operations; the fourth looks for what is left at so many places that there is time to stop it.
fn five() -> String {
    let half = "kind = \"finish\"\nscallop_mm = 0.3\n";
    let one = |name: &str, keys: &str| format!("[[operation]]\nname = \"{name}\"\ntools = [7]\n{keys}\n");
    let along = "strategy = { kind = \"isoplanar_3c\" }";
    LIST.replace("kind = \"finish\"\n", half)
        + &one("again", &format!("kind = \"finish\"\nscallop_mm = 0.2\n{along}"))
        + &one("rest", "kind = \"rest\"\noverlap_mm = 0.02")
        + &one("last", &format!("kind = \"finish\"\n{along}"))
}

#[cfg(unix)]
#[test]
fn a_run_that_was_stopped_goes_on_with_what_it_kept() {
    use std::process::{Command, Stdio};
    let scratch = Scratch::new();
    let job = scratch.write("job.toml", &five());
    let args = |out: &str| ["plan".into(), job.clone(), "--out".into(), scratch.path(out), "--json".into()];
    let child = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .args(args("out"))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let kept = [1, 2, 3].map(|k| scratch.path(&format!("out/operation-{k}.kept")));
    let begun = std::time::Instant::now();
    while !kept[2].exists() {
        assert!(begun.elapsed().as_secs() < 60, "nothing is kept");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let done = child.wait_with_output().unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(1), "{said}");
    assert!(said.contains("the same command goes on from them"), "{said}");
    // Three operations are there, whole; of the fourth and of results there is nothing.
    let there = || {
        let all = std::fs::read_dir(scratch.path("out")).unwrap();
        let mut names: Vec<_> = all.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(there(), ["operation-1.kept", "operation-2.kept", "operation-3.kept"]);
    // A word of each is changed: what is kept is taken, as the answer shows, and the others are planned.
    let texts = kept.each_ref().map(|k| std::fs::read_to_string(k).unwrap());
    for (k, text) in kept.iter().zip(&texts) {
        let v: Value = serde_json::from_str(text).unwrap();
        let word = format!("\"strategy\":{}", v["strategy"]);
        assert!(text.contains(&word));
        std::fs::write(k, text.replacen(&word, "\"strategy\":\"as kept\"", 1)).unwrap();
    }
    let again = osculate(&args("out")).json();
    let all = again["operations"].as_array().unwrap();
    let taken: Vec<bool> = all.iter().map(|o| o["strategy"] == "as kept").collect();
    assert_eq!(taken, [true, true, true, false, false]);
    assert!(there().iter().all(|name| !name.ends_with(".kept")), "{:?}", there());
    let clean = osculate(&args("clean")).json();
    assert_eq!(again["verdict"], clean["verdict"]);
    assert_eq!(clean["verdict"]["answer"], "held", "{}", clean["verdict"]);
    let paths = [1, 2, 3, 4, 5].map(|k| format!("path-{k}.cl"));
    let others = ["program.ngc", "stock-3.ply", "stock-5.stl", "tool.tbl", "job.resolved.toml"];
    for name in paths.iter().map(String::as_str).chain(others) {
        let [a, b] = ["out", "clean"].map(|f| std::fs::read(scratch.path(f).join(name)).unwrap());
        assert!(a == b, "{name}");
    }
    // Half of a file is none, and of another job nothing is taken.
    std::fs::write(&kept[0], &texts[0][..texts[0].len() / 2]).unwrap();
    std::fs::write(&job, LIST).unwrap();
    assert_eq!(osculate(&args("out")).json()["operations"][0]["strategy"], "z_level");
    std::fs::write(&kept[0], texts[0].replace("\"z_level\"", "\"as kept\"")).unwrap();
    assert_eq!(osculate(&args("out")).json()["operations"][0]["strategy"], "z_level");
}
