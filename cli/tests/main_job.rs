//! The main job on a small built-in part: files, figures, and the verdict from the NC text.

use crate::common;
use common::{Scratch, job, osculate};
use serde_json::Value;

fn number(v: &Value, path: &[&str]) -> f64 {
    path.iter().fold(v, |v, k| &v[*k]).as_f64().unwrap_or_else(|| panic!("{path:?} in {v}"))
}

#[test]
fn a_plan_is_written_posted_verified_and_reported() {
    let scratch = Scratch::new();
    let mut by_tip_min = f64::NAN;
    for (dialect, extension, feed) in
        [("linuxcnc", "ngc", "tcp"), ("linuxcnc", "ngc", "inverse_time"), ("sinumerik", "mpf", "tcp")]
    {
        let text = job(|j| {
            j.replace("\"linuxcnc\"", &format!("\"{dialect}\"")).replace("\"tcp\"", &format!("\"{feed}\""))
        });
        let path = scratch.write("job.toml", &text);
        let out = scratch.path(&format!("{dialect}-{feed}"));
        let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
        assert_eq!(run.code, 0, "{}{}", run.out, run.err);
        let program = out.join(format!("program.{extension}"));
        let mut names: Vec<String> = std::fs::read_dir(&out)
            .unwrap()
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        let mut want = vec![
            "path.cl".to_owned(),
            "path.svg".into(),
            "picture.svg".into(),
            "productivity.svg".into(),
            format!("program.{extension}"),
            "report.html".into(),
            "summary.json".into(),
        ];
        want.sort();
        assert_eq!(names, want);

        let summary: Value =
            serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["verification"], run.json()["verification"]);
        let v = &summary["verification"];
        assert_eq!((v["source"].as_str(), v["within_tolerance"].as_bool()), (Some("nc"), Some(true)), "{v}");
        let scallop = number(v, &["scallop_max_mm"]);
        assert!(scallop > 0.012 && scallop <= 0.02, "{v}");
        assert!(number(v, &["gouge_max_mm"]) <= 0.005 && number(v, &["uncut_area_mm2"]) == 0.0, "{v}");
        assert!(number(&summary, &["time_min"]) >= number(&summary, &["cutting_time_min"]));
        let global = number(&summary, &["area_mm2"]) / number(&summary, &["time_min"]);
        assert!((number(&summary, &["productivity_mm2_min", "global"]) / global - 1.0).abs() < 1e-12);
        assert_eq!(
            summary["productivity_mm2_min"]["regional"].as_array().unwrap().len() as f64,
            number(&summary, &["passes"])
        );

        // The time on the control is what `time` tells of the program alone.
        let (machine, dialect) = (summary["machine"].as_str().unwrap(), summary["dialect"].as_str().unwrap());
        let asked = ["time", program.to_str().unwrap(), "--machine", machine, "--dialect", dialect, "--json"];
        let clock = osculate(&asked).json();
        for (own, its) in [("control_time_min", "time_min"), ("control_cutting_time_min", "cutting_min")] {
            let [own, its] = [number(&summary, &[own]), number(&clock, &[its])];
            assert!((own / its - 1.0).abs() < 1e-9, "{own} {its}");
        }

        // Where another feed mode takes less for the path, a note says what: as the job with that mode takes, whose path is nearly the same.
        let notes = summary["diagnostics"].as_array().unwrap().iter().filter_map(Value::as_str);
        let of_feed: Vec<&str> =
            notes.filter_map(|n| n.split_once("the same path takes ")).map(|n| n.1).collect();
        let now_min = number(&summary, &["control_time_min"]);
        // A control that keeps to corners of its slides alone is brought to rest where rotary joints stop or start: nothing is left out.
        let text = std::fs::read_to_string(&program).unwrap();
        assert_eq!(text.contains("G61.1"), feed != "tcp", "{}", run.out);
        assert!(!run.out.contains("without an exact stop"), "{}", run.out);
        if feed != "tcp" {
            let blended = text.replace("G61.1\n", "");
            let path_b = scratch.write("blended.ngc", &blended);
            let verify = osculate(&["verify", "--job", path.to_str().unwrap(), path_b.to_str().unwrap()]);
            assert!(verify.out.contains("without an exact stop"), "{}", verify.out);
        }
        if feed == "tcp" {
            assert!(of_feed.is_empty(), "{of_feed:?}");
            by_tip_min = if dialect == "linuxcnc" { now_min } else { by_tip_min };
        } else {
            let min: f64 = of_feed[0].split(' ').next().unwrap().parse().unwrap();
            assert!(
                (min / by_tip_min - 1.0).abs() < 0.05 && min < 0.7 * now_min,
                "{min} {by_tip_min} {now_min}"
            );
            assert!(
                of_feed[0].contains(&format!("feed = \"tcp\", {now_min:.2} with \"{feed}\"")),
                "{of_feed:?}"
            );
        }

        let real = &summary["productivity"];
        let sum = |map: &Value, key: &str| -> f64 {
            map[key].as_array().unwrap().iter().filter_map(Value::as_f64).sum()
        };
        // Nothing is uncut: all of the face is finished, and the map over the time of its cells is that area.
        let area = number(&summary, &["area_mm2"]);
        let finished = number(real, &["finished_mm2"]);
        assert!((finished / area - 1.0).abs() < 0.005, "{finished} of {area}");
        let map = &real["regional"][0];
        let held = real["feed_held_by"].as_object().unwrap();
        assert!((held.values().map(|v| v.as_f64().unwrap()).sum::<f64>() - 1.0).abs() < 1e-4, "{held:?}");
        let slower = number(real, &["slower_share"]);
        let asked = held.iter().filter(|(by, _)| *by != "acceleration" && !by.starts_with("joint "));
        let asked: f64 = asked.map(|(_, v)| v.as_f64().unwrap()).sum();
        assert!((asked + slower - 1.0).abs() < 1e-4, "{held:?} {slower}");
        let (by, rates) = (map["held_by"].as_array().unwrap(), map["mm2_min"].as_array().unwrap());
        assert!(by.len() == rates.len() && by.iter().zip(rates).all(|(b, r)| b.is_null() == r.is_null()));
        let rates = map["mm2_min"].as_array().unwrap().iter().zip(map["time_s"].as_array().unwrap());
        let by_cells: f64 = rates.filter_map(|(e, t)| Some(e.as_f64()? * t.as_f64()? / 60.0)).sum();
        assert!((by_cells / area - 1.0).abs() < 0.005, "{by_cells} of {area}");
        // Cells take the time in which something is finished, which the cutting time contains.
        let finishing = number(real, &["finishing_min"]);
        assert!((sum(map, "time_s") / 60.0 / finishing - 1.0).abs() < 1e-4);
        assert!(finishing <= number(&summary, &["cutting_time_min"]) * (1.0 + 1e-9));
        let mean = number(real, &["instantaneous_mm2_min", "mean"]);
        assert!((mean * finishing / finished - 1.0).abs() < 1e-4);
        assert!(number(real, &["strips_over_area"]) > 0.995, "{}", real["strips_over_area"]);
        let map = std::fs::read_to_string(out.join("productivity.svg")).unwrap();
        assert!(map.contains("Productivity, mm2/min") && map.matches("<path").count() > 50, "{}", map.len());
        // A ball of 5 mm that leans by 15 degrees along the pass: 2 pi R sin 15 of way a turn, 8000 times a minute.
        let speed = std::f64::consts::TAU * 5.0 * 15f64.to_radians().sin() * 8.0;
        let median = number(real, &["cutting_speed_m_min", "median"]);
        assert!((median / speed - 1.0).abs() < 0.02, "{median} of {speed}");

        // The CL file verifies too, and so does the program on its own.
        for (file, source) in [(out.join("path.cl"), "cl"), (program.clone(), "nc")] {
            let run =
                osculate(&["verify", file.to_str().unwrap(), "--job", path.to_str().unwrap(), "--json"]);
            assert_eq!(run.code, 0, "{}{}", run.out, run.err);
            let v = run.json();
            assert_eq!((v["source"].as_str(), v["within_tolerance"].as_bool()), (Some(source), Some(true)));
            assert!((number(&v, &["scallop_max_mm"]) / scallop - 1.0).abs() < 0.05, "{v}");
            assert!(v["worst"].as_array().is_some_and(|w| !w.is_empty()));
            // What feed moves ask of the joints is read from the program alone.
            let joints = if source == "nc" { &summary["joints"] } else { &Value::Null };
            assert_eq!(&v["joints"], joints);
        }
        assert!(number(&summary, &["joints", "blocks"]) > 100.0, "{}", summary["joints"]);
        let report = std::fs::read_to_string(out.join("report.html")).unwrap();
        for joint in ["A", "C"] {
            let block = number(&summary, &["joints", "largest_step_block", joint]);
            let step = number(&summary, &["joints", "largest_step_deg", joint]);
            assert!(block > 0.0 && step > 0.0 && step < 90.0, "{}", summary["joints"]);
            assert!(report.contains(&format!("largest step of {joint}")));
        }
        // A clock reads the same steps; F as the program has it is no faster than the joints, but for rounding.
        let machine = summary["machine"].as_str().unwrap();
        let run = osculate(&["time", program.to_str().unwrap(), "--machine", machine, "--json"]);
        let timed = run.json();
        assert_eq!(timed["joints"]["blocks"], summary["joints"]["blocks"]);
        assert_eq!(timed["joints"]["largest_step_block"], summary["joints"]["largest_step_block"]);

        // A tool that plunges by 30 um in one block of the program is found, at that block, and the exit code says so.
        let text = std::fs::read_to_string(out.join("path.cl")).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let goto: Vec<usize> = (0..lines.len()).filter(|k| lines[*k].starts_with("GOTO/")).collect();
        let parse = |line: &str| -> Vec<f64> { line[5..].split(',').map(|x| x.parse().unwrap()).collect() };
        // One in the middle at which the ball touches: its centre stands one radius above the part.
        let touches = |k: &usize| {
            let n = parse(lines[*k]);
            let c: Vec<f64> = (0..3).map(|i| n[i] + 5.0 * n[i + 3]).collect();
            (c[2] - 0.005 * c[0] * c[0] + 0.003 * c[1] * c[1] - 5.0).abs() < 0.05
        };
        let middle = *goto[goto.len() / 2..].iter().find(|k| touches(k)).unwrap();
        let mut numbers = parse(lines[middle]);
        for k in 0..3 {
            numbers[k] -= 0.03 * numbers[k + 3];
        }
        let spoiled =
            format!("GOTO/{}", numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(","));
        let mut changed: Vec<&str> = lines.clone();
        changed[middle] = &spoiled;
        let file = scratch.write("spoiled.cl", &changed.join("\n"));
        let run = osculate(&["verify", file.to_str().unwrap(), "--job", path.to_str().unwrap(), "--json"]);
        assert_eq!(run.code, 1, "{}{}", run.out, run.err);
        let v = run.json();
        assert_eq!(v["within_tolerance"].as_bool(), Some(false));
        let gouge = number(&v, &["gouge_max_mm"]);
        assert!(gouge > 0.025 && gouge < 0.033, "{gouge}");
        let worst = v["worst"].as_array().unwrap().iter().find(|w| w["kind"] == "gouge").unwrap();
        let index = goto.iter().position(|g| *g == middle).unwrap() as f64;
        assert!((number(worst, &["block"]) - index).abs() <= 1.0, "{worst} against {index}");
    }
}

#[test]
fn same_job_same_bytes_whatever_the_number_of_threads() {
    let scratch = Scratch::new();
    let path = scratch.write("job.toml", &job(|j| j));
    let run = |threads: &str| {
        let out = scratch.path(threads);
        let done = std::process::Command::new(env!("CARGO_BIN_EXE_osculate"))
            .args(["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap()])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert!(done.status.success());
        let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
        let mut summary: Value = serde_json::from_str(&summary).unwrap();
        // Wall times are the only thing that may differ.
        summary.as_object_mut().unwrap().remove("wall_s");
        let file = |n: &str| std::fs::read(out.join(n)).unwrap();
        (file("path.cl"), file("program.ngc"), file("picture.svg"), summary)
    };
    assert!(run("1") == run("3"));
}

#[test]
fn contour_passes_with_a_ball() {
    let scratch = Scratch::new();
    let text = job(|j| {
        j.replace(
            "kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 6",
            "kind = \"sphere\", radius_mm = 25, u_range = [0, 0.6], v_range = [0.4, 0.9]",
        )
        .replace("kind = \"isoparametric\"\nlead_deg = 15", "kind = \"contour_2cl\"")
    });
    let path = scratch.write("job.toml", &text);
    let out = scratch.path("out");
    let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    let v = run.json();
    assert_eq!(v["strategy"], "contour_2cl");
    assert_eq!(v["verification"]["within_tolerance"].as_bool(), Some(true));
}

#[test]
fn cl_data_is_posted_for_other_machines() {
    let scratch = Scratch::new();
    let path = scratch.write("job.toml", &job(|j| j));
    let out = scratch.path("out");
    let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.err);
    let cl = out.join("path.cl");
    for (machine, dialect, feed) in [
        ("trunnion-ac", "sinumerik", "inverse_time"),
        ("trunnion-ac", "sinumerik", "kv"),
        ("trunnion-bc", "linuxcnc", "inverse_time"),
    ] {
        let program = scratch.path("program.txt");
        let args = [
            "post",
            cl.to_str().unwrap(),
            "--machine",
            machine,
            "--dialect",
            dialect,
            "--feed",
            feed,
            "--out",
            program.to_str().unwrap(),
            "--json",
        ];
        let run = osculate(&args);
        assert_eq!(run.code, 0, "{}{}", run.out, run.err);
        let v = run.json();
        assert!(number(&v, &["blocks"]) > 50.0 && number(&v, &["time_min"]) > 0.0, "{v}");
        assert!(number(&v, &["tip_error_mm"]) <= 0.0021, "{v}");
        assert!(program.exists());
    }
    osculate(&["post", cl.to_str().unwrap(), "--machine", "nope", "--dialect", "sinumerik", "--out", "x"])
        .refused(&["nope", "trunnion-ac"]);
    let bad = scratch.write("bad.cl", "GOTO/1,2,zebra\n");
    osculate(&[
        "post",
        bad.to_str().unwrap(),
        "--machine",
        "trunnion-ac",
        "--dialect",
        "sinumerik",
        "--out",
        "x",
    ])
    .refused(&["bad.cl", "line 1"]);
}

/// Blocks go on over the points of any CL file as far as the tolerance lets them, and end at every point without.
#[test]
fn points_of_cl_data_are_joined_where_that_is_asked_for() {
    let scratch = Scratch::new();
    let arc = |k: u32| {
        let angle = f64::from(k) * 0.3_f64.to_radians();
        let [y, z] = [25.0 * angle.sin(), 25.0 * angle.cos() - 25.0];
        format!("GOTO/{:.6},{y:.6},{z:.6},0,{:.9},{:.9}\n", 0.1 * f64::from(k), angle.sin(), angle.cos())
    };
    let cl = |cutter: &str| {
        let points: String = (0..=120).map(arc).collect();
        format!(
            "PARTNO/A\nUNITS/MM\n{cutter}MULTAX/ON\nSPINDL/8000,CLW\nRAPID\nGOTO/0,0,50,0,0,1\nFEDRAT/500\n{points}END\nFINI\n"
        )
    };
    let post = |name: &str, text: &str, more: &[&str]| {
        let (file, out) = (scratch.write(name, text), scratch.path("out.ngc"));
        let fixed = ["--machine", "trunnion-ac", "--dialect", "linuxcnc", "--feed", "inverse_time", "--json"];
        let paths = ["post", file.to_str().unwrap(), "--out", out.to_str().unwrap()];
        osculate(&[&paths[..], &fixed, more].concat())
    };
    let with = cl("CUTTER/6,3,0,3,0,0,50\n");
    let each = post("a.cl", &with, &[]).json();
    assert_eq!(each["joined_points"], 0);
    let count = |v: &Value, key: &str| number(v, &[key]);
    let mut before = count(&each, "blocks");
    for mm in ["0.002", "0.01", "0.05"] {
        let joined = post("a.cl", &with, &["--join-mm", mm]).json();
        let blocks = count(&joined, "blocks");
        assert!(blocks < 0.7 * before, "{mm}: {blocks} of {before}");
        assert!(count(&joined, "tip_error_mm") <= mm.parse::<f64>().unwrap(), "{joined}");
        // Each of the points ends a block, or has one go on over it.
        let points = |v: &Value| count(v, "blocks") + count(v, "joined_points") - count(v, "inserted_points");
        assert_eq!(points(&joined), points(&each));
        before = blocks;
    }
    post("b.cl", &cl(""), &["--join-mm", "0.01"]).refused(&["b.cl", "--join-mm", "CUTTER/"]);
    let wide = post("a.cl", &with, &["--join-mm", "3"]);
    assert!(wide.code == 2 && wide.err.contains("0.0001 to 1 mm"), "{}", wide.err);
}

/// A lens between two sides that bulge towards +y (ss) and -y (ps), as point sections.
fn lens() -> String {
    let mut text = "span_index,ss_x,ss_y,ss_z,ps_x,ps_y,ps_z\n".to_owned();
    for z in 0..5 {
        for k in 0..=12 {
            let x = f64::from(k) - 6.0;
            let y = 1.5 * (1.0 - (x / 6.0).powi(2));
            text.push_str(&format!("{z},{x},{y},{0},{x},{1},{0}\n", 2 * z, -y));
        }
    }
    text
}

#[test]
fn a_side_from_within_the_part_is_told() {
    let scratch = Scratch::new();
    let part = scratch.write("lens.csv", &lens());
    let probe = ["probe", part.to_str().unwrap(), "--face", "F1", "--at", "0.5,0.5", "--json"];
    let along = number(&osculate(&probe).json()["points"][0]["normal"][1], &[]) > 0.0;
    for (normals, inside) in [("auto", false), ("file", !along), ("reversed", along)] {
        let text = job(|j| {
            let builtin = j.lines().find(|l| l.starts_with("builtin")).unwrap().to_owned();
            let file = format!("file = \"lens.csv\"\nunit_mm = 1\nfaces = [\"F1\"]\nnormals = \"{normals}\"");
            j.replace(&builtin, &file)
                .replace("max_samples = 20000", "max_samples = 1000")
                .replace("scallop_mm = 0.02", "scallop_mm = 0.2")
        });
        let path = scratch.write("lens.toml", &text);
        let out = scratch.path(normals);
        let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
        let said = run.json()["diagnostics"].to_string();
        assert_eq!(said.contains("cut from within"), inside, "{normals}: {said}");
        if inside {
            // The sides are bent with a radius of 12 mm: where there is no plan it is said too.
            let large = text.replace("diameter_mm = 10", "diameter_mm = 40");
            let path = scratch.write("large.toml", &large);
            let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
            run.refused(&["does not fit", "cut from within"]);
        }
    }
}
