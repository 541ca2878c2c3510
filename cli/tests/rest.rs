//! Rest in a fillet: roughed with 12, finished with 8, rest with 4 and 2 mm, and what stands in it before and after each.
//!
//! The part is a floor and a wall of 10 degrees draft with a fillet of 2.2 mm between them, the same all along y. A ball of radius R
//! that touches both planes leaves more the larger it is: its centre and that of the fillet are on the same line out of the corner.

use crate::common;
use common::{Scratch, osculate};
use serde_json::{Value, json};
use std::f64::consts::PI;

const FILLET_MM: f64 = 2.2;
const DRAFT_DEG: f64 = 10.0;
const LONG_MM: f64 = 4.0;
/// Of the finished part, and of the rest with 4 mm, which leaves work for that with 2 mm.
const SCALLOP_MM: f64 = 0.03;
const COARSE_MM: f64 = 0.1;
/// A rest goes where more stands than this share of its scallop: the other part is for the marks of teeth.
const MARKS: f64 = 0.85;

/// Half the angle between wall and floor.
fn half_rad() -> f64 {
    0.5 * (90.0 + DRAFT_DEG).to_radians()
}

/// Wall, fillet and floor as the JSON of faces.
fn trough() -> String {
    let face = |id: &str, across: &[[f64; 2]], middle: f64| {
        let degree = across.len() - 1;
        let knots = [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
        let poles: Vec<_> = across.iter().map(|[x, z]| json!([[x, 0.0, z], [x, LONG_MM, z]])).collect();
        let weights: Vec<_> =
            (0..=degree).map(|k| if degree == 2 && k == 1 { [middle; 2] } else { [1.0; 2] }).collect();
        json!({ "id": id, "kind": "bspline", "oriented": true, "side": "along", "surface": { "nurbs": {
            "degree": [degree, 1], "knots": [knots, [0.0, 0.0, 1.0, 1.0]], "poles_mm": poles, "weights": weights,
            "side": "along" } } })
    };
    let (s, c) = DRAFT_DEG.to_radians().sin_cos();
    let wall = |along: f64| [-along * s, along * c];
    let tangent = FILLET_MM / half_rad().tan();
    let floor = [tangent, 0.0];
    let faces = [
        face("wall", &[wall(6.0), wall(tangent)], 1.0),
        face("fillet", &[wall(tangent), [0.0, 0.0], floor], half_rad().sin()),
        face("floor", &[floor, [8.0, 0.0]], 1.0),
    ];
    json!({ "format": 1, "faces": faces }).to_string()
}

fn job() -> String {
    let tool = |(kind, diameter): &(&str, u32)| {
        format!(
            "[[tool]]\nnumber = {diameter}\nkind = \"{kind}\"\ndiameter_mm = {diameter}\nlength_mm = 30\nteeth = 2\n\
             cutting = {{ spindle_rpm = 12000, feed_mm_min = 1200 }}\n"
        )
    };
    let tools: String = [("flat", 12), ("ball", 8), ("ball", 4), ("ball", 2)].iter().map(tool).collect();
    let own = |name: &str, keys: &str| {
        let strategy = "strategy = { kind = \"isoplanar_3c\", feed_direction = [0, 1, 0] }";
        format!("[[operation]]\nname = \"{name}\"\n{keys}\n{strategy}\n")
    };
    format!(
        "format = 2\n[part]\nfile = \"trough.json\"\nfaces = \"all\"\n\
         [stock]\nbox_mm = [-3, 0, -2, 8, {LONG_MM}, 6]\ncell_mm = 0.25\n\
         [tolerance]\nscallop_mm = {SCALLOP_MM}\ngouge_mm = 0.02\n\
         [verification]\nspacing_mm = 0.08\naccept = \"samples\"\n\
         [machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\n{tools}\
         [[operation]]\nname = \"rough\"\nkind = \"rough\"\ntools = [12]\nallowance_mm = 0.4\n"
    ) + &own("finish", "kind = \"finish\"\ntools = [8]")
        + &own("rest 4", &format!("kind = \"rest\"\ntools = [4]\nscallop_mm = {COARSE_MM}"))
        + &own("rest 2", "kind = \"rest\"\ntools = [2]")
}

/// What a ball leaves that stays off wall and floor by the same, looked at along the profile: the highest in the fillet along its
/// normals, and the width over the fillet and over all three faces that is above a limit, mm.
fn closed_form(ball_mm: f64, off_mm: f64, limit_mm: f64) -> (f64, [f64; 2]) {
    let half = half_rad();
    // From the corner on along the line between both centres.
    let (fillet, ball) = (FILLET_MM / half.sin(), (ball_mm + off_mm) / half.sin());
    let (mut highest, mut width) = (0.0f64, 0.0);
    let n = 20_000;
    let step = (PI - 2.0 * half) / f64::from(n);
    for k in 0..n {
        // Off the line, seen from the fillet's centre; along the normal to where the ball begins.
        let a = half - 0.5 * PI + (f64::from(k) + 0.5) * step;
        let from = [fillet - FILLET_MM * a.cos() - ball, FILLET_MM * a.sin()];
        let along = from[0] * a.cos() - from[1] * a.sin();
        let high = -along - (along * along - from[0].hypot(from[1]).powi(2) + ball_mm * ball_mm).sqrt();
        highest = highest.max(high);
        width += if high > limit_mm { FILLET_MM * step } else { 0.0 };
    }
    // Over a plane it is a circle, off the plane in its middle: too high nearer to the corner than this.
    let below = ball_mm - (limit_mm - off_mm);
    let reach = (ball_mm * ball_mm - below * below).max(0.0).sqrt();
    let plane = ((ball_mm + off_mm - FILLET_MM) / half.tan() - reach).max(0.0);
    (highest, [width, width + 2.0 * plane])
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))
}

#[test]
fn a_fillet_is_cleared_by_smaller_and_smaller_balls() {
    let scratch = Scratch::new();
    scratch.write("trough.json", &trough());
    let job = scratch.write("job.toml", &job());
    let run =
        osculate(&["plan", job.to_str().unwrap(), "--out", scratch.path("out").to_str().unwrap(), "--json"]);
    let v = run.json();
    assert_eq!((run.code, &v["verdict"]["answer"]), (0, &"held".into()), "{}", v["verdict"]);
    let all = v["operations"].as_array().unwrap();
    let names: Vec<_> = all.iter().map(|o| o["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["rough", "finish", "rest 4", "rest 2"]);
    // What stands on a face before or after an operation: the highest, and the area that is too high for the finished part.
    let on = |operation: usize, when: &str, face: &str| {
        let faces = all[operation]["on_faces"].as_array().unwrap();
        let found = &faces.iter().find(|f| f["face"] == face).unwrap()[when];
        ["highest_mm", "too_high_mm2"].map(|key| number(&found[key]))
    };
    // What one leaves is what the next finds.
    for face in ["wall", "fillet", "floor"] {
        (1..4).for_each(|k| assert_eq!(on(k, "before", face), on(k - 1, "after", face)));
    }
    // The block is 6 mm high; the roughing leaves its allowance at least.
    assert!(on(0, "before", "fillet")[0] > 4.0 && on(0, "after", "floor")[0] > 0.39);
    // The ball of 8 mm leaves what it does not come into. Its passes lie to both sides of the middle of the fillet, and may stay off either
    // plane by the scallop there: off both by twice that, not more.
    let (least, [_, from]) = closed_form(4.0, 0.0, SCALLOP_MM);
    let (most, [_, to]) = closed_form(4.0, 2.0 * SCALLOP_MM, SCALLOP_MM);
    let (_, [fillet, _]) = closed_form(4.0, SCALLOP_MM, SCALLOP_MM);
    let [high, area] = on(1, "after", "fillet");
    assert!(high > least - 1e-3 && high < most, "{least} {high} {most}");
    assert!((area - fillet * LONG_MM).abs() < 0.01 * area, "{area} {}", fillet * LONG_MM);
    let whole = on(1, "after", "wall")[1] + area + on(1, "after", "floor")[1];
    assert!(0.99 * from * LONG_MM < whole && whole < 1.01 * to * LONG_MM, "{from} {} {to}", whole / LONG_MM);
    // That of 4 mm begins with it, goes everywhere, and leaves its own coarse cusps: less in the fillet, to which it nearly fits.
    let limit = MARKS * COARSE_MM;
    let [(_, [_, from]), (_, [_, to])] = [0.0, SCALLOP_MM].map(|off| closed_form(4.0, off, limit));
    let first = number(&all[2]["too_high_mm2"]);
    assert!(0.99 * from * LONG_MM < first && first < 1.01 * to * LONG_MM, "{from} {} {to}", first / LONG_MM);
    assert!(on(2, "after", "fillet")[0] < SCALLOP_MM);
    let [cusp, left] = on(2, "after", "floor");
    assert!(cusp > 1.5 * SCALLOP_MM && cusp <= COARSE_MM && left > 0.0, "{cusp} {left}");
    // That of 2 mm has these only, and nothing is left.
    let second = number(&all[3]["too_high_mm2"]);
    assert!(second > 0.9 * left && second < 0.5 * first, "{second} {left} {first}");
    for face in ["wall", "fillet", "floor"] {
        let [high, area] = on(3, "after", face);
        assert!(high <= SCALLOP_MM && area == 0.0, "{face}: {high} {area}");
    }
    assert!(v.get("left_standing").is_none());
    let most = number(&v["verification"]["scallop_max_mm"]);
    assert!(most <= SCALLOP_MM, "{most}");
    // Where it is steep, rest has only a part of the passes of a finishing.
    let lengths: Vec<f64> = all.iter().map(|o| number(&o["cutting_length_mm"])).collect();
    assert!(lengths[3] < 0.5 * lengths[2], "{lengths:?}");
}

/// The wall by what is chosen for a toroidal cutter that is too wide for its foot, the rest of it and the other faces with a ball.
fn chosen(gouges: &str) -> String {
    let own = |name: &str, keys: &str, strategy: &str| {
        format!("[[operation]]\nname = \"{name}\"\n{keys}\nstrategy = {{ {strategy} }}\n")
    };
    let planes = "kind = \"isoplanar_3c\", feed_direction = [0, 1, 0]";
    let job = job();
    let (begin, _) = job.split_once("[[operation]]\nname = \"finish\"").unwrap();
    let tool = "[[tool]]\nnumber = 6\nkind = \"toroidal\"\ndiameter_mm = 6\ncorner_radius_mm = 1\nlength_mm = 30\n\
                teeth = 2\ncutting = { spindle_rpm = 12000, feed_mm_min = 1200 }\n[[operation]]";
    begin.replacen("[[operation]]", tool, 1)
        + &own(
            "wall",
            "kind = \"finish\"\ntools = [6]\nfaces = [\"wall\"]",
            &format!("kind = \"auto\", effort = \"quick\"{gouges}"),
        )
        + &own("others", "kind = \"finish\"\ntools = [4]\nfaces = [\"fillet\", \"floor\"]", planes)
        + &own("foot", "kind = \"rest\"\ntools = [4]", planes)
}

#[test]
fn what_is_chosen_leaves_to_others_what_its_tool_does_not_reach() {
    let scratch = Scratch::new();
    scratch.write("trough.json", &trough());
    let plan = |name: &str, gouges: &str| {
        let job = scratch.write(&format!("{name}.toml"), &chosen(gouges));
        osculate(&["plan", job.to_str().unwrap(), "--out", scratch.path(name).to_str().unwrap(), "--json"])
    };
    let planned = |name: &str, gouges: &str| {
        let run = plan(name, gouges);
        let v = run.json();
        assert_eq!((run.code, &v["verdict"]["answer"]), (0, &"held".into()), "{}", v["verdict"]);
        assert!(v["diagnostics"].to_string().contains("auto: wall: "), "{}", v["diagnostics"]);
        v["operations"].as_array().unwrap().clone()
    };
    let high = |operation: &Value| {
        let faces = operation["on_faces"].as_array().unwrap();
        number(&faces.iter().find(|f| f["face"] == "wall").unwrap()["after"]["too_high_mm2"])
    };
    let all = planned("left", "");
    let names: Vec<_> = all.iter().map(|o| o["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["rough", "wall", "others", "foot"]);
    // Its foot is left, and the rest clears it; a tool of 6 mm across the wall comes no nearer to the floor than half of that.
    let wall = LONG_MM * (6.0 - FILLET_MM / half_rad().tan());
    let left = high(&all[1]);
    assert!(left > 0.02 * wall && left < 0.5 * wall, "{left} of {wall}");
    assert!(high(&all[3]) < 1e-9, "{}", high(&all[3]));
    // Where nothing may be left out all of it is cut, by leads that stay off the floor: longer passes.
    let whole = planned("whole", ", gouges = \"report\"");
    assert!(high(&whole[1]) < 0.02 * wall, "{}", high(&whole[1]));
    let length = |all: &[Value]| number(&all[1]["cutting_length_mm"]);
    assert!(length(&all) < length(&whole), "{} {}", length(&all), length(&whole));
}

#[test]
fn what_is_left_of_a_job_of_its_own_is_not_accepted() {
    let scratch = Scratch::new();
    scratch.write("trough.json", &trough());
    // On three axes alone a tool that keeps its axis is chosen, which comes no nearer to the fillet than that lets it.
    let text = "format = 1\n[part]\nfile = \"trough.json\"\nfaces = [\"floor\"]\n\
                [tool]\nkind = \"flat\"\ndiameter_mm = 6\nlength_mm = 30\nteeth = 2\n\
                [tolerance]\nscallop_mm = 0.03\ngouge_mm = 0.02\n\
                [strategy]\nkind = \"auto\"\neffort = \"quick\"\ngouges = \"leave_out\"\n\
                [cutting]\nspindle_rpm = 12000\nfeed_mm_min = 1200\n\
                [machine]\nname = \"3-axis\"\nfeed = \"none\"\ndialect = \"linuxcnc\"\n\
                [verification]\nspacing_mm = 0.08\n";
    let job = scratch.write("job.toml", text);
    let (job, out) = (job.to_str().unwrap(), scratch.path("out"));
    let plan = osculate(&["plan", job, "--out", out.to_str().unwrap(), "--json"]).json();
    let program = out.join("program.ngc");
    let verify = osculate(&["verify", program.to_str().unwrap(), "--job", job, "--json"]).json();
    assert_eq!(plan["strategy"], "isoplanar_3c");
    assert_eq!(
        (&plan["verdict"]["answer"], &verify["verdict"]["answer"]),
        (&"not_held".into(), &"not_held".into())
    );
    for key in ["uncut_area_mm2", "height_max_mm", "gouge_max_mm"] {
        assert!(plan["verification"][key].is_number());
        assert_eq!(plan["verification"][key], verify[key], "{key}");
    }
}
