//! Wrong usage and impossible jobs: what is said, the exit code, and that nothing half-written stays behind.

use crate::common;
use common::{Scratch, job, osculate};
use osculate::job::Job;
use std::path::Path;
use std::time::Instant;

#[test]
fn wrong_usage_is_exit_code_two() {
    for args in [
        vec!["plan"],
        vec!["plan", "job.toml"],
        vec!["inspect"],
        vec!["inspect", "a.igs", "--builtin", "kind = \"sphere\", radius_mm = 1"],
        vec!["probe", "--builtin", "kind = \"sphere\", radius_mm = 1", "--at", "0.1"],
        vec!["probe", "--builtin", "kind = \"sphere\", radius_mm = -1", "--at", "0.1,0.2"],
        vec![],
    ] {
        let run = osculate(&args);
        assert_eq!(run.code, 2, "{args:?}: {}{}", run.out, run.err);
        assert!(!run.err.is_empty() && run.out.is_empty(), "{args:?}");
    }
    assert_eq!(osculate(&["--version"]).code, 0);
}

#[test]
fn files_that_are_no_parts() {
    let scratch = Scratch::new();
    let inspect = |path: &Path| osculate(&["inspect", path.to_str().unwrap()]);
    inspect(&scratch.path("nothing.igs")).refused(&["nothing.igs", "cannot be read"]);
    inspect(&scratch.write("empty.step", "")).refused(&["empty.step", "empty"]);
    inspect(&scratch.write("prose.step", "It was a dark and stormy night.\n"))
        .refused(&["prose.step", "no format that is read"]);
    let hull = include_str!("data/hull.step");
    let cut = &hull[..hull.len() / 3];
    let run = inspect(&scratch.write("cut.step", cut));
    // What is complete of a truncated file is shown, and that it is not the whole.
    assert!(run.out.contains("0 faces") && run.out.contains("lost"), "{}", run.out);
    run.refused(&["cut.step", "truncated", "export"]);
}

#[test]
fn jobs_that_cannot_be_done_say_what_where_and_what_to_change() {
    let scratch = Scratch::new();
    let out = scratch.path("out");
    let plan = |text: String| {
        let path = scratch.write("job.toml", &text);
        let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert_eq!(run.code, 1, "{}{}\n{text}", run.out, run.err);
        assert!(
            !out.exists() || std::fs::read_dir(&out).unwrap().next().is_none(),
            "something was written: {text}"
        );
        run
    };
    let with = |from: &str, to: &str| {
        plan(job(|j| {
            assert!(j.contains(from), "{from}");
            j.replace(from, to)
        }))
    };
    with("format = 1", "format = 2").refused(&["format = 2", "format = 1"]);
    with("scallop_mm", "scallop_um").refused(&["scallop_um"]);
    with("diameter_mm = 10", "diameter = 10").refused(&["diameter"]);
    with("scallop_mm = 0.02", "scallop_mm = 0").refused(&["scallop_mm = 0", "from 0.000001 to 1000"]);
    with("scallop_mm = 0.02", "scallop_mm = -1").refused(&["scallop_mm = -1", "from 0.000001 to 1000"]);
    with("scallop_mm = 0.02", "scallop_mm = nan").refused(&["scallop_mm = NaN", "from 0.000001 to 1000"]);
    with("scallop_mm = 0.02", "scallop_mm = \"fine\"").refused(&["scallop_mm"]);
    with("kind = \"ball\"", "kind = \"toroidal\"\ncorner_radius_mm = 6")
        .refused(&["corner_radius_mm = 6", "radius 5"]);
    with("kind = \"ball\"", "kind = \"drill\"").refused(&["drill", "toroidal"]);
    with("kind = \"ball\"", "kind = \"ball\"\ncorner_radius_mm = 1").refused(&["corner_radius_mm = 1"]);
    with("kind = \"isoparametric\"", "kind = \"spiral\"").refused(&["spiral", "isoparametric"]);
    with("lead_deg = 15", "lead_deg = 95").refused(&["lead", "90"]);
    with("trunnion-ac", "hexapod").refused(&["hexapod", "trunnion-ac"]);
    with("linuxcnc", "esperanto").refused(&["esperanto", "linuxcnc"]);
    with("feed = \"tcp\"", "feed = \"fast\"").refused(&["fast", "tcp"]);
    with("feed_mm_min = 2000", "feed_mm_min = -2").refused(&["feed_mm_min"]);
    with("builtin", "file = \"a.igs\"\nbuiltin").refused(&["several of file, builtin and ruled"]);
    with("half_size_mm = 6", "half_size_mm = 6, v_range = [0, 9]").refused(&["v_range"]);
    let tool = "[tool]\nkind = \"ball\"\ndiameter_mm = 10\nlength_mm = 50\n";
    with(tool, "").refused(&["[tool]", "[[tools]]"]);
    with("format = 1", "format = 1\ntools = []").refused(&["both [tool] and [[tools]]"]);
    plan(job(|j| j.replace(tool, "").replace("format = 1", "format = 1\ntools = []")))
        .refused(&["the list of tools is empty"]);
    with(
        tool,
        "[[tools]]\nkind = \"flat\"\ndiameter_mm = 4\n[[tools]]\nkind = \"toroidal\"\ndiameter_mm = 4\n",
    )
    .refused(&["[[tools]] number 2", "corner_radius_mm"]);
    // A ball of 300 mm in a place hollow with a radius of 100 mm.
    with("diameter_mm = 10\nlength_mm = 50", "diameter_mm = 300\nlength_mm = 400").refused(&[
        "does not fit",
        "radius",
        "or less",
    ]);
    // Upside down the tool would have to come through the table.
    with("[verification]", "[setup]\nrotate_deg = [180, 0, 0]\n[verification]")
        .refused(&["joint A", "range"]);
}

#[test]
fn faces_that_are_not_there() {
    let scratch = Scratch::new();
    std::fs::write(scratch.path("hull.step"), include_str!("data/hull.step")).unwrap();
    let part = |faces: &str| {
        let text = job(|j| {
            let start = j.find("builtin").unwrap();
            let end = j[start..].find('\n').unwrap() + start;
            format!("{}file = \"hull.step\"\nfaces = {faces}{}", &j[..start], &j[end..])
        });
        let path = scratch.write("job.toml", &text);
        osculate(&["plan", path.to_str().unwrap(), "--out", scratch.path("out").to_str().unwrap()])
    };
    part("[\"F9\"]").refused(&["F9", "F1"]);
    part("[\"F1\"]\ncheck_faces = [\"F1\"]").refused(&["check_faces names F1", "face to machine"]);
    part("{ largest = 5 }").refused(&["largest = 5"]);
    part("{ smallest = 5 }").refused(&["faces"]);
    let hull = scratch.path("hull.step");
    let probe = osculate(&["probe", hull.to_str().unwrap(), "--face", "F2", "--at", "0,0"]);
    probe.refused(&["F2", "F1"]);
    osculate(&["probe", hull.to_str().unwrap(), "--face", "F1", "--at", "0,7"]).refused(&["0,7", "outside"]);
}

/// Longest time in which a job that cannot be meant is refused, s.
const AT_ONCE_S: f64 = 0.2;

/// Wrong inputs: what stands in the job, what stands there instead, and words of the answer, the key first.
const WRONG: &[(&str, &str, &[&str])] = &[
    ("format = 1", "format = 2", &["format = 2", "line 1", "1"]),
    ("format = 1", "format = \"1\"", &["format"]),
    ("format = 1\n", "", &["needs format"]),
    ("[tolerance]\n", "[tolerances]\n", &["tolerances", "is tolerance meant?"]),
    ("[strategy]", "[stratgy]", &["stratgy", "is strategy meant?"]),
    ("[cutting]", "[cuting]", &["cuting", "is cutting meant?"]),
    ("[machine]", "[machines]", &["machines", "is machine meant?"]),
    ("[verification]", "[verify]\na = 1\n[verification]", &["verify"]),
    ("scallop_mm = 0.02", "scallop_um = 20", &["scallop_um", "line 9", "is scallop_mm meant?"]),
    ("scallop_mm = 0.02", "", &["needs scallop_mm"]),
    ("scallop_mm = 0.02", "scallop_mm = nan", &["scallop_mm = NaN", "from 0.000001 to 1000"]),
    ("scallop_mm = 0.02", "scallop_mm = inf", &["scallop_mm = inf", "from 0.000001 to 1000"]),
    ("scallop_mm = 0.02", "scallop_mm = 0", &["scallop_mm = 0", "from 0.000001 to 1000"]),
    ("scallop_mm = 0.02", "scallop_mm = 0.02\nscallop_mm = 1", &["scallop_mm", "line 10"]),
    ("gouge_mm = 0.005", "gouge_mm = -1", &["gouge_mm = -1", "line 10"]),
    ("gouge_mm = 0.005", "gouge_mm = true", &["gouge_mm = true"]),
    ("chord_mm = 0.003", "chord_mm = 0", &["chord_mm = 0", "line 11"]),
    ("chord_mm = 0.003", "chord_mm = [1]", &["chord_mm = [1]"]),
    ("chord_mm = 0.003", "unreached_mm2 = -1", &["unreached_mm2 = -1"]),
    ("diameter_mm = 10", "diameter_mm = -10", &["diameter_mm = -10", "[tool]", "line 6"]),
    ("diameter_mm = 10", "diameter = 10", &["diameter", "is diameter_mm meant?"]),
    ("diameter_mm = 10\n", "", &["needs diameter_mm"]),
    ("length_mm = 50", "length_mm = 0", &["length_mm = 0"]),
    ("length_mm = 50", "flute_length_mm = 60", &["flute_length_mm = 60", "50"]),
    ("length_mm = 50", "number = 0", &["number = 0", "1 to 9999"]),
    ("length_mm = 50", "number = 10000", &["number = 10000"]),
    ("length_mm = 50", "teeth = 1.5", &["teeth = 1.5", "whole"]),
    ("length_mm = 50", "taper_deg = 10", &["taper_deg", "leave it out"]),
    ("length_mm = 50", "holder = { diameter_mm = 40 }", &["tool.holder", "needs length_mm"]),
    ("length_mm = 50", "holder = { diameter_mm = -40, length_mm = 1 }", &["diameter_mm = -40"]),
    ("length_mm = 50", "holder = { diameter = 40, length_mm = 1 }", &["diameter", "is diameter_mm meant?"]),
    ("length_mm = 50", "holder = 40", &["holder", "table"]),
    ("kind = \"ball\"", "kind = \"bal\"", &["kind", "is \"ball\" meant?"]),
    ("kind = \"ball\"", "kind = 3", &["kind = 3", "toroidal"]),
    ("kind = \"ball\"", "kind = \"cone\"", &["needs taper_deg"]),
    ("kind = \"isoparametric\"", "kind = \"isoparametrc\"", &["is \"isoparametric\" meant?", "line 13"]),
    ("kind = \"isoparametric\"", "kind = \"z_level\"", &["needs stepdown_mm", "line 13"]),
    ("kind = \"isoparametric\"\nlead_deg = 15", "kind = \"z_level\"", &["needs stepdown_mm"]),
    (
        "kind = \"isoparametric\"",
        "kind = \"isoplanar\"\nalong = \"u\"",
        &["along", "isoparametric and regions"],
    ),
    ("kind = \"isoparametric\"", "kind = \"isoplanar\"\nnormal = [0, 0, 0]", &["normal", "direction"]),
    (
        "kind = \"isoparametric\"\nlead_deg = 15",
        "kind = \"contour_2cl\"\ntilt_deg = 3",
        &["tilt_deg", "leave out"],
    ),
    (
        "kind = \"isoparametric\"\nlead_deg = 15",
        "kind = \"gradient_3c\"\nfeed_direction = [0, 0, 2]",
        &["feed_direction", "across"],
    ),
    ("lead_deg = 15", "lead_deg = 90", &["lead_deg = 90", "-90"]),
    ("lead_deg = 15", "lead_deg = nan", &["lead_deg = NaN"]),
    ("lead_deg = 15", "lead_deg = \"locl\"", &["lead_deg", "is \"local\" meant?"]),
    ("lead_deg = 15", "tilt_deg = inf", &["tilt_deg = inf"]),
    (
        "lead_deg = 15",
        "lead_deg = 15\ntilt_deg = \"local\"",
        &["tilt_deg = \"local\"", "lead_deg = \"local\"", "line 15"],
    ),
    ("lead_deg = 15", "along = \"u\"\nside_tilt_deg = 61", &["side_tilt_deg = 61", "60"]),
    ("lead_deg = 15", "side_tilt_deg = 15", &["side_tilt_deg", "along = \"u\" or \"v\"", "line 14"]),
    (
        "lead_deg = 15",
        "along = \"u\"\nside_tilt_deg = 15\ntilt_deg = 5",
        &["tilt_deg", "leave one", "line 16"],
    ),
    (
        "lead_deg = 15",
        "along = \"u\"\nside_tilt_deg = 15\nlead_deg = \"auto\"",
        &["lead_deg as a number", "line 16"],
    ),
    ("lead_deg = 15", "along = \"u\"\nside_tilt_deg = 15\naxis = \"field\"", &["leave out side_tilt_deg"]),
    (
        "kind = \"isoparametric\"",
        "kind = \"isoplanar\"\nside_tilt_deg = 15",
        &["side_tilt_deg is for isoparametric and regions", "leave it out"],
    ),
    ("lead_deg = 15", "stepdown_mm = 1", &["stepdown_mm", "z_level"]),
    ("lead_deg = 15", "keep_off_mm = 1", &["keep_off_mm", "leave_out"]),
    ("lead_deg = 15", "gouges = \"leave out\"", &["gouges", "is \"leave_out\" meant?"]),
    ("lead_deg = 15", "hop_mm = 1", &["hop_mm", "[setup] hop_mm"]),
    ("spindle_rpm = 8000", "spindle_rpm = 0", &["spindle_rpm = 0"]),
    ("feed_mm_min = 2000", "feed_mm_min = nan", &["feed_mm_min = NaN"]),
    ("feed_mm_min = 2000", "feed_per_tooth_mm = 0.1", &["feed_per_tooth_mm", "teeth"]),
    ("feed_mm_min = 2000", "coolant = \"flod\"", &["coolant", "is \"flood\" meant?"]),
    ("trunnion-ac", "trunion-ac", &["name", "is \"trunnion-ac\" meant?"]),
    ("name = \"trunnion-ac\"", "file = \"none.toml\"", &["file", "none.toml", "cannot be read"]),
    ("name = \"trunnion-ac\"\n", "", &["[machine]", "needs name"]),
    ("name = \"trunnion-ac\"", "name = \"trunnion-ac\"\nfile = \"m.toml\"", &["file", "keep one"]),
    ("\"trunnion-ac\"", "\"head-ca\"", &["feed", "linuxcnc_tcp"]),
    ("linuxcnc", "linux", &["dialect", "is \"linuxcnc\" meant?"]),
    ("feed = \"tcp\"", "feed = \"inverse-time\"", &["feed", "is \"inverse_time\" meant?"]),
    ("feed = \"tcp\"", "feed = \"kz\"\nkz_step = 0", &["kz_step = 0"]),
    ("feed = \"tcp\"", "work_offset = \"G53\"", &["work_offset", "G54"]),
    ("feed = \"tcp\"", "program_number = 0", &["program_number = 0"]),
    ("\"linuxcnc\"\nfeed = \"tcp\"", "\"heidenhain\"\nfeed = \"inverse_time\"", &["feed", "heidenhain"]),
    ("max_samples = 20000", "max_samples = 5", &["max_samples = 5", "100"]),
    ("max_samples = 20000", "max_samples = 1e5", &["max_samples", "whole"]),
    ("max_samples = 20000", "spacing_mm = nan", &["spacing_mm = NaN"]),
    ("max_samples = 20000", "accept = \"sample\"", &["accept", "is \"samples\" meant?"]),
    ("[verification]", "[setup]\nhop_mm = -1\n[verification]", &["[setup] hop_mm = -1", "line 23"]),
    ("[verification]", "[setup]\nhop_mm = 3\n[verification]", &["hop_mm = 3", "approach_mm = 2"]),
    ("[verification]", "[setup]\nrotate_deg = [nan, 0, 0]\n[verification]", &["rotate_deg", "line 23"]),
    ("[verification]", "[setup]\npart_zero_mm = [0, 0]\n[verification]", &["part_zero_mm = [0, 0]"]),
    ("[verification]", "[stock]\nbox_mm = [0, 0, 0, 1, -1, 1]\n[verification]", &["box_mm", "lower corner"]),
    ("[verification]", "[stock]\n[verification]", &["[stock]", "needs one of"]),
    (
        "[verification]",
        "[stock]\nfile = \"none.stl\"\n[verification]",
        &["file", "none.stl", "cannot be read"],
    ),
    ("[verification]", "[stock]\nfile = \"job.toml\"\n[verification]", &["file", "no mesh"]),
    (
        "[verification]",
        "[stock]\nallowance_mm = 1\nbox_mm = [0, 0, 0, 1, 1, 1]\n[verification]",
        &["allowance_mm", "keep one"],
    ),
    (
        "[verification]",
        "[stock.cylinder]\ndiameter_mm = 1\nz_mm = [1, 0]\n[verification]",
        &["z_mm = [1, 0]", "lower one first"],
    ),
    ("[verification]", "[stock.cylinder]\ndiameter_mm = 1\n[verification]", &["needs z_mm"]),
    ("[verification]", "[fixture]\nfiles = [\"none.stl\"]\n[verification]", &["files", "none.stl"]),
    ("[verification]", "[contact]\nat = [0, 0]\n[verification]", &["[contact]", "along"]),
    ("[verification]", "[contact]\nat = [0, nan]\nalong = \"u\"\n[verification]", &["at = [0, nan]"]),
    ("[verification]", "[contact]\nat = [0, 0]\nalong = \"w\"\n[verification]", &["along = \"w\""]),
    ("[verification]", "[flank]\nmethod = \"optimun\"\n[verification]", &["method", "is \"optimum\" meant?"]),
    ("[verification]", "[flank]\npositions = 3\n[verification]", &["positions = 3"]),
    ("[verification]", "[flank]\nside = 0\n[verification]", &["side = 0", "1 or -1"]),
    ("[verification]", "[flank]\njudge_u = [1, 0]\n[verification]", &["judge_u = [1, 0]"]),
    ("[verification]", "[flank]\ntip = \"v2\"\n[verification]", &["tip = \"v2\""]),
    ("half_size_mm = 6", "half_size = 6", &["builtin", "half_size", "line 3"]),
    ("half_size_mm = 6", "half_size_mm = -6", &["builtin", "half_size_mm"]),
    ("builtin", "faces = []\nbuiltin", &["faces = []"]),
    ("builtin", "faces = { largest = 0 }\nbuiltin", &["faces", "largest"]),
    ("builtin", "may_hit = { largest = 2 }\nbuiltin", &["may_hit", "ids"]),
    ("builtin", "faces = [\"F1\"]\nmay_hit = [\"F1\"]\nbuiltin", &["may_hit names F1"]),
    ("builtin", "normals = \"reverse\"\nbuiltin", &["normals", "is \"reversed\" meant?"]),
    ("builtin", "unit_mm = 2\nbuiltin", &["unit_mm", "leave it out"]),
    ("[tool]", "file = \"none.step\"\n[tool]", &["several of file, builtin and ruled"]),
    ("[tool]", "[[tool]]", &["tool", "[tool]"]),
    ("[tool]", "[tools]", &["tools", "[[tools]]"]),
];

#[test]
fn wrong_values_are_refused_at_once_with_file_line_and_key() {
    let scratch = Scratch::new();
    scratch.write("job.toml", &job(|j| j));
    let path = scratch.path("job.toml");
    let mut off = Vec::new();
    let mut refused = |text: &str, words: &[&str]| {
        let begun = Instant::now();
        let answer = Job::from_toml(text, &path);
        let took_s = begun.elapsed().as_secs_f64();
        let Err(error) = answer else {
            off.push(format!("taken, {words:?}"));
            return;
        };
        let (code, message) = (error.code(), error.message());
        let missing: Vec<_> = words.iter().chain(&["job.toml"]).filter(|w| !message.contains(**w)).collect();
        if took_s > AT_ONCE_S || code != 1 || !missing.is_empty() {
            off.push(format!("{took_s} s, code {code}, without {missing:?}: {message}"));
        }
    };
    assert!(WRONG.len() >= 60);
    for (from, to, words) in WRONG {
        let text = job(|j| {
            assert!(j.contains(from), "{from}");
            j.replacen(from, to, 1)
        });
        refused(&text, words);
    }
    let builtin = job(|j| j).lines().nth(2).unwrap().to_owned();
    refused(
        &job(|j| j.replace(&builtin, "file = \"none.step\"")),
        &["file", "none.step", "cannot be read", "line 3"],
    );
    refused(&job(|j| j.replace(&builtin, "")), &["[part]", "needs file"]);
    refused(&job(|j| j.replace("[part]\n", "").replace(&builtin, "")), &["needs a table [part]"]);
    refused(&job(|j| j.replace("[part]", "[part")), &["line 2"]);
    refused("", &["needs"]);
    assert!(off.is_empty(), "{}", off.join("\n"));
    // The job that all of them are made of is one.
    assert!(Job::from_toml(&job(|j| j), &path).is_ok());
}

#[test]
fn what_cannot_be_meant_ends_before_the_part_is_read() {
    let scratch = Scratch::new();
    let out = scratch.path("out");
    let plan = |from: &str, to: &str, out: &Path| {
        let path = scratch.write("job.toml", &job(|j| j.replacen(from, to, 1)));
        let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
        assert!(!run.err.contains("import"), "{}", run.err);
        let answer = run.json();
        for key in ["what", "where", "expected", "nearest"] {
            assert!(answer["error"][key].is_string(), "{answer}");
        }
        run
    };
    let setup = |key: &str| format!("[setup]\n{key}\n[verification]");
    plan("[verification]", &setup("hop_mm = -1"), &out).refused(&["hop_mm = -1", "positive"]);
    plan("[verification]", &setup("rotate_deg = [nan, 0, 0]"), &out).refused(&["rotate_deg"]);
    plan("max_samples = 20000", "max_samples = 5", &out).refused(&["max_samples = 5"]);
    plan("\"trunnion-ac\"", "\"head-ca\"", &out).refused(&["linuxcnc_tcp", "feed"]);
    let file = scratch.write("taken", "");
    plan("", "", &file).refused(&["taken", "is a file", "--out"]);
    assert!(!out.exists());
}

#[test]
fn keys_are_listed_and_the_template_loads() {
    let scratch = Scratch::new();
    let text = osculate(&["keys", "--template"]);
    assert_eq!(text.code, 0, "{}", text.err);
    assert!(Job::load(&scratch.write("job.toml", &text.out)).is_ok());
    let listed = osculate(&["keys", "--json"]).json();
    let keys = listed["keys"].as_array().unwrap();
    assert!(keys.len() > 90 && keys.iter().any(|k| k["table"] == "tolerance" && k["key"] == "scallop_mm"));
    assert!(osculate(&["keys"]).out.contains("scallop_mm"));
}

/// Devices without end, binary files and lines without end: refused at once, as programs and as CL data.
#[cfg(unix)]
#[test]
fn texts_without_end() {
    let scratch = Scratch::new();
    let out = scratch.path("out.nc");
    let start = Instant::now();
    let long = scratch.write("long.nc", &"G1 X1 ".repeat(20_000));
    for file in ["/dev/zero", long.to_str().unwrap()] {
        let time = ["time", file, "--machine", "trunnion-ac", "--dialect", "fanuc"];
        osculate(&time).refused(&[file, "line 1", "longer than 65536 bytes"]);
        let readback = [
            "readback",
            file,
            "--machine",
            "trunnion-ac",
            "--dialect",
            "fanuc",
            "--out",
            out.to_str().unwrap(),
        ];
        osculate(&readback).refused(&[file, "line 1", "longer than 65536 bytes"]);
        let post =
            ["post", file, "--machine", "trunnion-ac", "--dialect", "fanuc", "--out", out.to_str().unwrap()];
        osculate(&post).refused(&[file, "line 1", "longer than 65536 bytes"]);
        assert!(!out.exists());
    }
    let job_file = scratch.write("job.toml", &job(|j| j));
    let verify = ["verify", "/dev/zero", "--job", job_file.to_str().unwrap()];
    osculate(&verify).refused(&["/dev/zero", "no plain file", "256 MiB"]);
    assert!(start.elapsed().as_secs() < 20);
}

/// CL data that a program cannot say whole is refused with its lines, and posted without them where that is asked for.
#[test]
fn what_a_program_cannot_say() {
    let scratch = Scratch::new();
    let out = scratch.path("out.nc");
    let post = |text: &str, more: &[&str]| {
        let cl = scratch.write("a.cl", text);
        let mut args = vec!["post", cl.to_str().unwrap(), "--machine", "trunnion-ac", "--dialect", "fanuc"];
        args.extend(["--out", out.to_str().unwrap()]);
        args.extend(more);
        osculate(&args)
    };
    let text = "CUTTER/10\nLOADTL/4\nSPINDL/900\nRAPID\nGOTO/0,0,5\nFEDRAT/100\nCUTCOM/LEFT\nGOTO/1,0,0\nWEDGE/1\nLOADTL/9\nCUTTER/6\n\
                SPINDL/2500\nRAPID\nGOTO/5,0,5\nGOTO/5,0,0\nFINI\n";
    post(text, &[]).refused(&["a.cl", "line 7: CUTCOM", "line 9: WEDGE", "--lenient"]);
    assert!(!out.exists());
    let run = post(text, &["--lenient", "--work-offset", "G55", "--program-number", "77"]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.out.contains("CUTCOM") && run.out.contains("T9"), "{}", run.out);
    let program = std::fs::read_to_string(&out).unwrap();
    for line in ["O0077 (OUT)", "T4 M6", "T9 M6", "G55", "S900 M3", "S2500 M3"] {
        assert!(program.lines().any(|l| l == line), "{line}\n{program}");
    }
    post(text, &["--lenient", "--work-offset", "G599"]).refused(&["fanuc has no work offset G599"]);
    let negative = text.replace("SPINDL/900", "SPINDL/1e308");
    post(&negative, &["--lenient"]).refused(&["1e308 rpm", "at most 999999"]);
}

/// What is read but for some words is told, and does not pass for the whole.
#[test]
fn left_out_words_are_no_success() {
    let scratch = Scratch::new();
    let out = scratch.path("out.cl");
    let text = "G21 G90 G94\nG0 X0 Y0 Z10 A0 C0\nG81 X1 Y1 Z-3 R1 F100\nG1 X5 F100\nM30\n";
    let program = scratch.write("cycle.nc", text);
    let file = program.to_str().unwrap();
    let on = ["--machine", "trunnion-ac", "--dialect", "fanuc"];
    let time = osculate(&[&["time", file], &on[..]].concat());
    assert_eq!(time.code, 1, "{}", time.err);
    assert!(
        time.out.contains("line 3") && time.out.contains("G81") && time.out.contains("feed moves"),
        "{}",
        time.out
    );
    let readback = osculate(&[&["readback", file, "--out", out.to_str().unwrap()], &on[..]].concat());
    assert_eq!(readback.code, 1, "{}", readback.err);
    assert!(readback.out.contains("G81") && out.exists(), "{}", readback.out);
    let whole = scratch.write("whole.nc", &text.replace("G81 X1 Y1 Z-3 R1 F100\n", ""));
    assert_eq!(osculate(&[&["time", whole.to_str().unwrap()], &on[..]].concat()).code, 0);
}
