//! `verify` reads where the part sits out of the head of a program of its own, in the comments of every dialect.

use crate::common;
use common::{Scratch, job, osculate};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

const JOB: &str = r#"format = 1
[part]
builtin = { kind = "plane", u_range = [-3, 3], v_range = [-3, 3] }
[tool]
kind = "flat"
diameter_mm = 8
length_mm = 30
[tolerance]
scallop_mm = 0.02
gouge_mm = 0.01
[verification]
spacing_mm = 0.1
"#;

/// An upright flat cutter over the plane z = 0: nothing is left and nothing taken where the part sits as posted.
fn rows() -> String {
    let mut text = "UNITS/MM\nCUTTER/8,0,0,0,0,0,30\nRAPID\nGOTO/0,0,40,0,0,1\nFEDRAT/1000,MMPM\n".to_owned();
    for (x, y) in [(-6, -4), (6, -4), (6, 0), (-6, 0), (-6, 4), (6, 4)] {
        writeln!(text, "GOTO/{x},{y},0,0,0,1").expect("a string takes all");
    }
    text + "FINI\n"
}

/// The findings about the setup.
fn setup_findings(v: &Value) -> Vec<&str> {
    v["diagnostics"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(Value::as_str)
        .filter(|d| d.contains("setup"))
        .collect()
}

fn figure(v: &Value, key: &str) -> f64 {
    v[key].as_f64().expect("a number")
}

#[test]
fn the_part_sits_where_the_program_says() {
    let scratch = Scratch::new();
    let cl = scratch.write("rows.cl", &rows());
    for (dialect, ending) in [("sinumerik", "mpf"), ("heidenhain", "h"), ("fanuc", "nc"), ("linuxcnc", "ngc")]
    {
        // Without tool-centre-point control the place of the part is in every block.
        let program = scratch.path(&format!("rows.{ending}"));
        let zero = "--part-zero=12.34567,-7,33";
        let args = [
            "post",
            cl.to_str().unwrap(),
            "--machine",
            "trunnion-ac",
            "--dialect",
            dialect,
            "--feed",
            "none",
        ];
        let posted = osculate(&[&args[..], &[zero, "--out", program.to_str().unwrap()]].concat());
        assert_eq!(posted.code, 0, "{}", posted.err);
        let verify = |program: &Path, setup: &str| {
            let machine =
                format!("[machine]\nname = \"trunnion-ac\"\ndialect = \"{dialect}\"\nfeed = \"none\"\n");
            let job = scratch.write("job.toml", &format!("{JOB}{machine}{setup}"));
            osculate(&["verify", program.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"])
        };
        let run = verify(&program, "");
        let v = run.json();
        assert!(run.code == 0 && figure(&v, "gouge_max_mm") < 1e-4, "{dialect}: {v}");
        let found = setup_findings(&v);
        let said =
            "note: setup: part_zero_mm = [12.3457, -7.0000, 33.0000], rotate_deg = [0.0000, 0.0000, 0.0000]";
        assert!(found.len() == 1 && found[0].starts_with(said) && found[0].contains("head"), "{found:?}");
        // The same said twice is no contradiction.
        let same = verify(&program, "[setup]\npart_zero_mm = [12.34567, -7, 33]\nrotate_deg = [0, 0, 0]\n");
        assert!(same.code == 0 && setup_findings(&same.json()).is_empty(), "{}", same.out);
        // Another place in the job is taken, and both are told: the part sits 0.03 mm higher than the program takes it.
        let higher = verify(&program, "[setup]\npart_zero_mm = [12.34567, -7, 33.03]\n");
        let v = higher.json();
        assert!(higher.code == 1 && (figure(&v, "gouge_max_mm") - 0.03).abs() < 1e-3, "{v}");
        let warned = setup_findings(&v).join("\n");
        assert!(
            warned.contains("warning") && warned.contains("33.0300]") && warned.contains("33.0000]"),
            "{warned}"
        );
        // So is another turn, with which nothing meets.
        verify(&program, "[setup]\nrotate_deg = [0, 0, 90]\n").refused(&[
            "do not meet",
            "rotate_deg = [0.0000, 0.0000, 90.0000] is taken",
            "posted for rotate_deg = [0.0000, 0.0000, 0.0000]",
        ]);
        // A head that was changed by hand is told, and the place is found from the job as for other programs.
        let text = std::fs::read_to_string(&program).unwrap();
        let broken = text.replace("setup part zero X", "setup part zero X about ");
        assert_ne!(text, broken);
        let broken = scratch.write(&format!("broken.{ending}"), &broken);
        verify(&broken, "").refused(&["do not meet", "is not understood"]);
        let v = verify(&broken, "[setup]\npart_zero_mm = [12.34567, -7, 33]\n").json();
        let found = setup_findings(&v).join("\n");
        assert!(v["within_tolerance"] == true && found.contains("is not understood"), "{found}");
    }
}

#[test]
fn a_turn_of_the_part_comes_back_too() {
    let scratch = Scratch::new();
    let text = job(|t| t.replace("half_size_mm = 6", "half_size_mm = 2.5"));
    let turned = scratch.write("job.toml", &format!("{text}[setup]\nrotate_deg = [10, -20, 33]\n"));
    let out = scratch.path("out");
    let plan = osculate(&["plan", turned.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
    assert_eq!(plan.code, 0, "{}{}", plan.out, plan.err);
    let plain = scratch.write("plain.toml", &text);
    let program = out.join("program.ngc");
    let run = osculate(&["verify", program.to_str().unwrap(), "--job", plain.to_str().unwrap(), "--json"]);
    let v = run.json();
    assert!(run.code == 0 && figure(&v, "uncut_area_mm2") == 0.0, "{v}");
    assert!(setup_findings(&v)[0].contains("rotate_deg = [10.0000, -20.0000, 33.0000]"), "{v}");
}

/// A quarter of a turn about one axis, as findings have it.
const QUARTERS: [&str; 4] = [
    "[90.000, 0.000, 0.000]",
    "[-90.000, 0.000, 0.000]",
    "[0.000, 90.000, 0.000]",
    "[0.000, -90.000, 0.000]",
];

/// A small bowl around the pole of the table: its joints hold the path up where it stands, and less where it is tilted.
#[test]
fn a_part_is_tilted_where_its_program_is_quicker_so() {
    let scratch = Scratch::new();
    let text = "format = 1\n[part]\nbuiltin = { kind = \"paraboloid\", a_per_mm = 0.05, b_per_mm = 0.05, half_size_mm = 3 }\n\
        [tool]\nkind = \"toroidal\"\ndiameter_mm = 4\ncorner_radius_mm = 1\nlength_mm = 40\n\
        [tolerance]\nscallop_mm = 0.02\ngouge_mm = 0.02\n[strategy]\nkind = \"isoparametric\"\nlead_deg = 10\n\
        [cutting]\nspindle_rpm = 12000\nfeed_mm_min = 3000\n\
        [machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\nfeed = \"inverse_time\"\n";
    let plan = |name: &str, setup: &str| {
        let job = scratch.write(&format!("{name}.toml"), &format!("{text}{setup}"));
        let out = scratch.path(name);
        let run = osculate(&["plan", job.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
        assert_eq!(run.code, 0, "{}{}", run.out, run.err);
        (run.json(), job, out.join("program.ngc"))
    };
    let (stands, ..) = plan("stands", "[setup]\nrotate_deg = [0, 0, 0]\n");
    let (stays, ..) = plan("stays", "[setup]\nturns = \"none\"\n");
    assert_eq!(figure(&stays, "time_min"), figure(&stands, "time_min"));
    // What a shop can clamp: on its side, by a quarter of a turn about one axis.
    let (laid, ..) = plan("laid", "");
    let said = setup_findings(&laid).join("\n");
    assert!(said.contains("turned so that the joints hold the path up less"), "{said}");
    assert!(QUARTERS.iter().any(|q| said.contains(q)), "{said}");
    let [before, now] = [&stands, &laid].map(|v| figure(v, "time_min"));
    assert!(now < 0.97 * before, "{now} {before}");
    let (tilted, job, program) = plan("tilted", "[setup]\nturns = \"free\"\n");
    let said = setup_findings(&tilted).join("\n");
    assert!(said.contains("turned so that the joints hold the path up less"), "{said}");
    let [before, now] = [&stands, &tilted].map(|v| figure(v, "time_min"));
    assert!(now < 0.97 * before, "{now} {before}");
    // The program says how the part sits, and verification finds the same there.
    let run = osculate(&["verify", program.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"]);
    let [again, planned] = [run.json(), tilted["verification"].clone()].map(|v| figure(&v, "gouge_max_mm"));
    assert!(run.code == 0 && (again - planned).abs() < 1e-3, "{again} {planned}");
}

/// The bowl as an operation of a list, whose part is turned where its setup asks for that.
#[test]
fn the_part_of_a_list_is_tilted_where_its_setup_asks_for_it() {
    let scratch = Scratch::new();
    let text = "format = 2\n[part]\nbuiltin = { kind = \"paraboloid\", a_per_mm = 0.05, b_per_mm = 0.05, half_size_mm = 3 }\n\
        [tolerance]\nscallop_mm = 0.02\ngouge_mm = 0.02\n\
        [machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\nfeed = \"inverse_time\"\n\
        [[tool]]\nnumber = 1\nkind = \"toroidal\"\ndiameter_mm = 4\ncorner_radius_mm = 1\nlength_mm = 40\n\
        cutting = { spindle_rpm = 12000, feed_mm_min = 3000 }\n\
        [[operation]]\nkind = \"finish\"\nstrategy = { kind = \"isoparametric\", lead_deg = 10 }\n";
    let plan = |name: &str, setup: &str| {
        let job =
            scratch.write(&format!("{name}.toml"), &text.replace("[[tool]]", &format!("{setup}[[tool]]")));
        let out = scratch.path(name);
        let run = osculate(&["plan", job.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
        assert_eq!(run.code, 0, "{}{}", run.out, run.err);
        let program = out.join("program.ngc");
        let verify =
            osculate(&["verify", program.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"]);
        assert_eq!(verify.json()["verdict"], run.json()["verdict"]);
        run.json()
    };
    let stands = plan("stands", "");
    assert!(!setup_findings(&stands).join("\n").contains("hold the path up"), "{stands}");
    let stays = plan("stays", "[[setup]]\nname = \"op10\"\nturns = \"none\"\n");
    let tilted = plan("tilted", "[[setup]]\nname = \"op10\"\nturns = \"free\"\n");
    let said = setup_findings(&tilted).join("\n");
    assert!(said.contains("turned so that the joints hold the path up less"), "{said}");
    let [before, same, now] = [&stands, &stays, &tilted].map(|v| figure(v, "control_time_min"));
    assert_eq!(before, same);
    assert!(now < 0.97 * before, "{now} {before}");
}

/// A piece of a sphere around +x: its normals are up to 35 degrees from that.
#[test]
fn a_face_that_looks_aside_is_turned_about_one_axis() {
    let scratch = Scratch::new();
    let text = job(|t| {
        t.replace(
            "kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 6",
            "kind = \"sphere\", radius_mm = 25, u_range = [-0.2, 0.2], v_range = [-0.6, 0.6]",
        )
    });
    let plan = |name: &str, setup: &str| {
        let job = scratch.write(&format!("{name}.toml"), &format!("{text}{setup}"));
        let out = scratch.path(name);
        let run = osculate(&["plan", job.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
        assert_eq!(run.code, 0, "{}{}", run.out, run.err);
        setup_findings(&run.json()).join("\n")
    };
    let said = plan("none", "[setup]\nturns = \"none\"\n");
    assert!(said.contains("rotate_deg = [0.000, -90.000, 0.000]"), "{said}");
    // On another side it may be quicker, by a quarter of a turn about one axis too.
    let said = plan("axis", "");
    assert!(QUARTERS.iter().any(|q| said.contains(q)), "{said}");
    // What the job gives is not turned.
    let given = plan("given", "[setup]\nrotate_deg = [0, -80, 10]\nturns = \"free\"\n");
    assert!(!given.contains("turned"), "{given}");
}
