//! `auto` and `compare`: what is chosen holds, by a distance check that shares no code with the program, and losers say why.

use crate::common;
use common::{Scratch, job, osculate};
use serde_json::Value;

const A: f64 = 0.005;
const B: f64 = -0.003;
const HALF_MM: f64 = 6.0;
const GOUGE_MM: f64 = 0.005;

const TOOLS: &str = r#"[[tools]]
kind = "ball"
diameter_mm = 10
length_mm = 50
[[tools]]
kind = "toroidal"
diameter_mm = 10
corner_radius_mm = 1
length_mm = 50
[tools.holder]
diameter_mm = 24
length_mm = 30
"#;

/// The small job with these tools and an open strategy.
fn open(tools: &str) -> String {
    job(|j| {
        let one = "[tool]\nkind = \"ball\"\ndiameter_mm = 10\nlength_mm = 50\n";
        assert!(j.contains(one));
        j.replace(one, tools).replace("kind = \"isoparametric\"\nlead_deg = 15", "kind = \"auto\"")
    })
}

fn number(v: &Value, keys: &[&str]) -> f64 {
    keys.iter().fold(v, |v, k| &v[*k]).as_f64().unwrap_or_else(|| panic!("{keys:?}: {v}"))
}

type V = [f64; 3];

fn dot(a: &V, b: &V) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Signed distance of a point to a cutter with a corner (or a cylinder: corner 0) in its own half plane.
fn distance(radius_mm: f64, corner_mm: f64, length_mm: f64, rho: f64, z: f64) -> f64 {
    let core = radius_mm - corner_mm;
    if z > length_mm {
        return (z - length_mm).hypot((rho - radius_mm).max(0.0));
    }
    if z >= corner_mm {
        // Beside the cylinder, or in it: the side or the bottom, whichever is nearer.
        return if corner_mm > 0.0 { rho - radius_mm } else { (rho - radius_mm).max(-z) };
    }
    if rho <= core { -z } else { (rho - core).hypot(z - corner_mm) - corner_mm }
}

/// Poses of a CL file: tip and axis, no further apart than `step_mm` at the tip and 0.01 in the axis.
fn dense_poses(text: &str, step_mm: f64) -> Vec<(V, V)> {
    let given: Vec<[f64; 6]> = text
        .lines()
        .filter_map(|l| l.strip_prefix("GOTO/"))
        .map(|l| {
            let n: Vec<f64> = l.split(',').map(|x| x.trim().parse().unwrap()).collect();
            n.try_into().unwrap()
        })
        .collect();
    let mut out = Vec::new();
    for w in given.windows(2) {
        let far = (0..3).map(|k| (w[1][k] - w[0][k]).powi(2)).sum::<f64>().sqrt();
        let turn = (3..6).map(|k| (w[1][k] - w[0][k]).powi(2)).sum::<f64>().sqrt();
        let n = (far / step_mm).max(turn / 0.01).ceil().max(1.0) as usize;
        for i in 0..n {
            let f = i as f64 / n as f64;
            let at = |k: usize| w[0][k] + f * (w[1][k] - w[0][k]);
            let axis = [at(3), at(4), at(5)];
            let length = dot(&axis, &axis).sqrt();
            out.push(([at(0), at(1), at(2)], axis.map(|a| a / length)));
        }
    }
    out
}

/// The deepest that cutter and holder go into the paraboloid anywhere along a path, mm.
fn deepest_mm(text: &str, tool: &Value, holder: Option<[f64; 2]>) -> f64 {
    let radius = 0.5 * number(tool, &["diameter_mm"]);
    let corner =
        if tool["kind"] == "ball" { radius } else { tool["corner_radius_mm"].as_f64().unwrap_or(0.0) };
    let length = number(tool, &["length_mm"]);
    let side = 81;
    let place = |k: usize| HALF_MM * (2.0 * k as f64 / (side - 1) as f64 - 1.0);
    let points: Vec<V> = (0..side * side)
        .map(|k| (place(k % side), place(k / side)))
        .map(|(x, y)| [x, y, A * x * x + B * y * y])
        .collect();
    let mut deepest = 0.0f64;
    for (tip, axis) in dense_poses(text, 0.1) {
        for p in &points {
            let d = [p[0] - tip[0], p[1] - tip[1], p[2] - tip[2]];
            let z = dot(&d, &axis);
            let rho = (dot(&d, &d) - z * z).max(0.0).sqrt();
            deepest = deepest.max(-distance(radius, corner, length, rho, z));
            if let Some([diameter, long]) = holder {
                deepest = deepest.max(-distance(0.5 * diameter, 0.0, long, rho, z - length));
            }
        }
    }
    deepest
}

#[test]
fn auto_chooses_what_holds() {
    let scratch = Scratch::new();
    let path = scratch.write("job.toml", &open(TOOLS));
    let out = scratch.path("out");
    let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    let v = run.json();
    assert_eq!(v["verification"]["within_tolerance"].as_bool(), Some(true));
    // The bound is one; a few strips over a face of 12 mm overlap much, and their leads are all the same.
    let efficiency = number(&v, &["efficiency_percent"]);
    assert!(efficiency > 5.0 && efficiency <= 100.0 + 1e-9, "{efficiency}");
    let (ideal, cutting) = (number(&v, &["ideal", "time_min"]), number(&v, &["cutting_time_min"]));
    assert!(ideal > 0.0 && ideal <= cutting, "{ideal} {cutting}");
    assert!(number(&v, &["ideal", "error_min"]) < 0.2 * ideal);
    // The first row is the one chosen, and no other that was verified to hold is faster.
    let rows = v["compared"].as_array().unwrap();
    assert_eq!((rows[0]["outcome"].as_str(), rows[0]["why"].as_str()), (Some("holds"), Some("")), "{rows:?}");
    assert!((number(&rows[0], &["time_min"]) - number(&v, &["control_time_min"])).abs() < 1e-9);
    let others = |r: &Value| match r["outcome"].as_str().unwrap() {
        "holds" => number(r, &["time_min"]) >= number(&rows[0], &["time_min"]),
        _ => !r["why"].as_str().unwrap().is_empty(),
    };
    assert!(rows[1..].iter().all(others), "{rows:?}");
    // Neither cutter nor holder goes deeper than accepted, by formulas of this file alone.
    let text = std::fs::read_to_string(out.join("path.cl")).unwrap();
    let holder = (v["tool"]["kind"] != "ball").then_some([24.0, 30.0]);
    let deepest = deepest_mm(&text, &v["tool"], holder);
    assert!(deepest <= GOUGE_MM, "{deepest}");
    // The check itself finds a path that is too deep.
    let sunk: String = text
        .lines()
        .map(|l| match l.strip_prefix("GOTO/") {
            Some(n) => {
                let n: Vec<f64> = n.split(',').map(|x| x.trim().parse().unwrap()).collect();
                format!("GOTO/{},{},{},{},{},{}\n", n[0], n[1], n[2] - 0.02, n[3], n[4], n[5])
            }
            None => format!("{l}\n"),
        })
        .collect();
    let deepest = deepest_mm(&sunk, &v["tool"], holder);
    assert!(deepest > 0.01 && deepest < 0.03, "{deepest}");
}

/// Every tool's postures and the best of them at every place, as arrays and as pictures.
fn fields_hold_together(out: &std::path::Path, said: &str) {
    let text = std::fs::read_to_string(out.join("compare.json")).unwrap();
    let v: Value = serde_json::from_str(&text).unwrap();
    let face = &v["fields"][0];
    let tools = face["tools"].as_array().unwrap();
    let rates: Vec<Vec<Option<f64>>> = tools
        .iter()
        .map(|t| t["postures"]["area_mm2_min"].as_array().unwrap().iter().map(|e| e.as_f64()).collect())
        .collect();
    let best = &face["best"]["postures"];
    for k in 0..16 {
        let greatest = rates.iter().filter_map(|r| r[k]).fold(f64::NAN, f64::max);
        let tool = best["tool"][k].as_u64().unwrap() as usize;
        assert_eq!(rates[tool][k], Some(greatest));
        assert_eq!(best["area_mm2_min"][k].as_f64(), Some(greatest));
    }
    // The ball of 300 mm reaches the bottom of the hollow nowhere.
    let large = tools.iter().position(|t| t["tool"] == "ball 300").unwrap();
    assert!(rates[large][5].is_none() && rates[large][10].is_none(), "{:?}", rates[large]);
    let shares: f64 =
        face["best"]["share_percent"].as_array().unwrap().iter().map(|s| s.as_f64().unwrap()).sum();
    assert!((shares - 100.0).abs() < 1e-9 && said.contains("the best at"), "{shares} {said}");
    for picture in tools.iter().chain([&face["best"]]).map(|t| t["picture"].as_str().unwrap()) {
        let svg = std::fs::read_to_string(out.join(picture)).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("strip width"), "{picture}");
    }
}

#[test]
fn compare_ranks_and_gives_reasons() {
    let scratch = Scratch::new();
    let large = "[[tools]]\nkind = \"ball\"\ndiameter_mm = 300\nlength_mm = 400\n";
    let path = scratch.write("job.toml", &open(&format!("{TOOLS}{large}")));
    let run = osculate(&["compare", path.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    let v = run.json();
    let rows = v["candidates"].as_array().unwrap();
    let holding: Vec<f64> =
        rows.iter().filter(|r| r["outcome"] == "holds").map(|r| number(r, &["time_min"])).collect();
    assert!(!holding.is_empty() && holding.is_sorted(), "{holding:?}");
    for r in rows.iter().filter(|r| r["outcome"] == "holds") {
        let m = &r["verified"];
        let [low, high] = [0, 1].map(|k| m["instantaneous_mm2_min"][k].as_f64().unwrap());
        let regional = number(m, &["regional_mm2_min"]);
        assert!(low <= regional && regional <= high && number(m, &["global_mm2_min"]) < regional, "{m}");
        // Strips at places are a fair prediction of the passes of so small a face: two passes or three, which overlap at its borders
        // where they may not run out over them.
        let ratio = number(r, &["predicted_length_mm"]) / number(r, &["cutting_length_mm"]);
        assert!(ratio > 0.4 && ratio < 1.25, "{ratio} {r}");
        assert!(number(r, &["pointwise_min"]) < number(r, &["time_min"]), "{r}");
    }
    // Hollow with a radius of 100 mm at the middle: a ball of 300 mm is too large, one of 200 mm fits.
    let too_large = rows.iter().filter(|r| r["tool"] == "ball 300").collect::<Vec<_>>();
    assert!(!too_large.is_empty());
    for r in too_large {
        assert_eq!(r["outcome"], "not_possible");
        let why = r["why"].as_str().unwrap();
        let percent: f64 = why.split_whitespace().nth(3).unwrap().parse().unwrap();
        // Contour lines leave so small a face at its corners before the ball comes down on it.
        let lines = r["strategy"].as_str().unwrap();
        let least = if ["contour_2cl", "waterline_3c"].contains(&lines) { 90.0 } else { 100.0 };
        assert!(why.starts_with("too large for ") && percent >= least, "{why}");
        assert!(why.contains("largest diameter"), "{why}");
        let largest: f64 =
            why.split(": ").last().unwrap().split_whitespace().next().unwrap().parse().unwrap();
        assert!((200.0..202.0).contains(&largest), "{why}");
    }
    let out = scratch.path("fields");
    let folder = out.to_str().unwrap();
    let text = osculate(&["compare", path.to_str().unwrap(), "--out", folder, "--nodes", "4"]);
    fields_hold_together(&out, &text.out);
    assert!(text.out.contains("within tolerance") && text.out.contains("too large"), "{}", text.out);

    // None possible: all reasons in one table, and nothing is written.
    let path = scratch.write("none.toml", &open(large));
    let out = scratch.path("none");
    let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    run.refused(&[
        "no tool and strategy is possible",
        "ball 300",
        "isoparametric u",
        "contour_2cl",
        "largest diameter",
    ]);
    assert!(!out.exists());
}

/// A ridge on which joints turn, so that the control does not reach the feed, with two tools that differ in their diameter alone.
fn ridge(minor_mm: f64, end: f64, corner_mm: f64, diameters_mm: [f64; 2], lead_deg: f64) -> String {
    let tool = |mm: f64| {
        format!(
            "[[tools]]\nkind = \"toroidal\"\ndiameter_mm = {mm}\ncorner_radius_mm = {corner_mm}\nlength_mm = 6\nteeth = 4\n"
        )
    };
    let scallop_mm = 0.01 * corner_mm;
    format!(
        "format = 1\n[part]\nbuiltin = {{ kind = \"torus\", major_radius_mm = 20, minor_radius_mm = {minor_mm}, material = \"inside\", \
         u_range = [0, {end}], v_range = [0.3, 2.8] }}\n{}[tolerance]\nscallop_mm = {scallop_mm}\ngouge_mm = {}\n[strategy]\n\
         kind = \"isoparametric\"\nalong = \"v\"\nlead_deg = {lead_deg}\n[cutting]\nspindle_rpm = 12000\nfeed_mm_min = 2000\n[machine]\n\
         name = \"trunnion-ac\"\ndialect = \"linuxcnc\"\nfeed = \"inverse_time\"\n[setup]\nturns = \"free\"\n[verification]\nmax_samples = 8000\n",
        diameters_mm.map(tool).concat(),
        0.5 * scallop_mm
    )
}

/// Plans a text; the summary, and what `verify` says of the program.
fn planned(text: &str, scratch: &Scratch, name: &str) -> [Value; 2] {
    let path = scratch.write(&format!("{name}.toml"), text);
    let out = scratch.path(name);
    let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    let program = out.join("program.ngc");
    let again = osculate(&["verify", program.to_str().unwrap(), "--job", path.to_str().unwrap(), "--json"]);
    assert_eq!(again.code, 0, "{}{}", again.out, again.err);
    [run.json(), again.json()]
}

/// What `plan` and `verify` say of one program, key by key.
fn same(plan: &Value, verify: &Value) {
    let found = plan["verification"].as_object().unwrap();
    for (key, value) in found
        .iter()
        .chain([(&"verdict".to_owned(), &plan["verdict"]), (&"joints".to_owned(), &plan["joints"])])
    {
        assert_eq!(value, &verify[key.as_str()], "{key}");
    }
    assert!(found.len() > 15);
}

fn story(v: &Value) -> String {
    let notes = v["diagnostics"].as_array().unwrap();
    let texts = notes.iter().filter_map(Value::as_str);
    texts.filter(|t| t.contains("candidates screened")).collect()
}

/// Where the control cannot follow, marks of teeth need less of the tolerance than a half, and the strips have the rest.
#[test]
fn marks_are_left_what_the_speed_needs() {
    let scratch = Scratch::new();
    let text = ridge(1.5, 0.03, 0.1, [1.0, 0.6], 10.0);
    let [open, verified] = planned(&text, &scratch, "open");
    assert!(story(&open).contains("marks of teeth are left"), "{}", story(&open));
    // The same tool by itself is not chosen, and shares the tolerance by halves.
    let other = text.find("[[tools]]\nkind = \"toroidal\"\ndiameter_mm = 0.6").unwrap();
    let end = text.find("[tolerance]").unwrap();
    let alone = text.replace(&text[other..end], "").replace("[[tools]]", "[tool]");
    let [given, _] = planned(&alone, &scratch, "alone");
    assert_eq!(open["tool"], given["tool"]);
    let time = |v: &Value| number(v, &["control_time_min"]);
    assert!(time(&open) < 0.9 * time(&given), "{} {}", time(&open), time(&given));
    // With the room for marks 7 passes of 11 are left.
    assert!(number(&open, &["passes"]) < 0.7 * number(&given, &["passes"]));
    let mark = |v: &Value| number(v, &["verification", "tooth_mark_max_mm"]);
    assert!(mark(&open) < 0.4 * mark(&given), "{} {}", mark(&open), mark(&given));
    // Both are held together, whoever reads the program; joints are still what holds the feed.
    assert!(number(&open, &["verification", "height_max_mm"]) <= 0.001);
    same(&open, &verified);
    let held = open["productivity"]["feed_held_by"].as_object().unwrap();
    assert!(held.keys().any(|by| by.starts_with("joint ")), "{held:?}");
}

/// A chord tolerance that the job leaves open may grow where blocks and corners hold the control; one that is given does not.
#[test]
fn an_open_chord_grows_where_that_is_quicker() {
    let scratch = Scratch::new();
    let text = ridge(9.0, 0.2, 1.0, [6.0, 4.0], 20.0).replace("length_mm = 6\n", "length_mm = 30\n");
    let [open, verified] = planned(&text, &scratch, "open");
    let grown = |mm: &str| story(&open).contains(&format!("the chord tolerance is {mm} mm"));
    assert!(["0.0040", "0.0080"].into_iter().any(grown), "{}", story(&open));
    same(&open, &verified);
    let [given, _] = planned(&text.replace("gouge_mm", "chord_mm = 0.002\ngouge_mm"), &scratch, "given");
    assert!(!story(&given).contains("chord"), "{}", story(&given));
    let (free, kept) = (number(&open, &["control_time_min"]), number(&given, &["control_time_min"]));
    assert!(free < kept, "{free} {kept}");
}

/// A plane of 8 by 8 mm on three axes, with a flat end and a ball.
const PLANE: &str = r#"
format = 1
part = { builtin = { kind = "plane", half_size_mm = 4 } }
tolerance = { scallop_mm = 0.01 }
strategy = { kind = "auto" }
cutting = { spindle_rpm = 12000, feed_mm_min = 2000 }
machine = { name = "3-axis", dialect = "linuxcnc", feed = "none" }
verification = { max_samples = 60000 }
[[tools]]
kind = "flat"
diameter_mm = 6
length_mm = 40
teeth = 4
[[tools]]
kind = "ball"
diameter_mm = 6
length_mm = 40
teeth = 4
"#;

/// On three axes a flat end stands on a plane: no end that must lean is as quick, and only ways that keep the axis have it stand.
#[test]
fn a_tool_that_keeps_its_axis_is_among_what_is_chosen_from() {
    let scratch = Scratch::new();
    let [v, verified] = planned(PLANE, &scratch, "three");
    let strategy = v["strategy"].as_str().unwrap();
    assert!(["isoplanar_3c", "gradient_3c"].contains(&strategy), "{strategy}");
    assert_eq!(v["tool"]["kind"], "flat");
    assert_eq!(v["verdict"]["answer"], "held");
    // 8 mm by strips of 6 mm, or by half of that beyond its rims.
    assert!([2.0, 3.0].contains(&number(&v, &["passes"])));
    assert!(number(&v, &["verification", "scallop_max_mm"]) < 1e-6);
    same(&v, &verified);
    // A ball would need passes half a millimetre apart.
    let rows = v["compared"].as_array().unwrap();
    let balls = rows.iter().filter(|r| r["tool"] == "ball 6").filter_map(|r| r["layout_min"].as_f64());
    assert!(balls.clone().count() > 4);
    assert!(balls.fold(f64::INFINITY, f64::min) > 2.0 * number(&v, &["control_cutting_time_min"]));
}

/// A quick search plans less and a long one more, and neither is worse than what it leaves out.
#[test]
fn an_effort_says_how_much_is_tried() {
    let scratch = Scratch::new();
    let plans = |v: &Value| -> f64 {
        let told = story(v);
        let before = told.split(" planned").next().unwrap();
        before.rsplit(' ').next().unwrap().parse().unwrap()
    };
    let [quick, normal, long] = ["quick", "normal", "long"].map(|effort| {
        let key = format!("kind = \"auto\", effort = \"{effort}\"");
        let [v, _] = planned(&PLANE.replace("kind = \"auto\"", &key), &scratch, effort);
        assert_eq!(v["verdict"]["answer"], "held", "{effort}");
        (plans(&v), number(&v, &["control_time_min"]))
    });
    assert!(quick.0 < normal.0 && normal.0 <= long.0 && quick.0 < long.0, "{quick:?} {normal:?} {long:?}");
    assert!(long.1 <= normal.1 && normal.1 <= quick.1, "{quick:?} {normal:?} {long:?}");
    // Where nothing is left to choose the key says nothing.
    let one = PLANE.split("[[tools]]\nkind = \"ball\"").next().unwrap().replace("[[tools]]", "[tool]");
    let given = one.replace("kind = \"auto\"", "kind = \"isoplanar_3c\", effort = \"long\"");
    let path = scratch.write("given.toml", &given);
    let run = osculate(&["check", path.to_str().unwrap()]);
    run.refused(&["[strategy] effort is for kind = \"auto\" or several tools", "isoplanar_3c"]);
}
