//! Bodies of the machine in a job: the head against the part and the table, the tool against the table, and machine files that say it wrongly.

use crate::common;
use common::{Scratch, osculate};

const MACHINE: &str = r#"format = 1
name = "with bodies"
[control]
feed_reading = { kind = "linear" }
[[joint]]
kind = "linear"
letter = "X"
side = "table"
direction = [1, 0, 0]
max_velocity_mm_s = 500
max_acceleration_mm_s2 = 4000
[[joint]]
kind = "linear"
letter = "Y"
side = "head"
direction = [0, 1, 0]
max_velocity_mm_s = 500
max_acceleration_mm_s2 = 4000
[[joint]]
kind = "linear"
letter = "Z"
side = "head"
direction = [0, 0, 1]
min_mm = -500
max_mm = 500
max_velocity_mm_s = 500
max_acceleration_mm_s2 = 4000
"#;

const HEAD: &str = r#"[[body]]
kind = "cylinder"
name = "spindle"
carried_by = "Z"
from_mm = [0, 0, 0]
to_mm = [0, 0, 120]
diameter_mm = 60
"#;

/// A hollow 20 mm deep and 40 mm wide: in its middle the nose is a tool's length above the floor.
fn job(length_mm: f64) -> String {
    format!(
        r#"format = 1
[part]
builtin = {{ kind = "paraboloid", a_per_mm = 0.05, b_per_mm = 0.0, u_range = [-20, 20], v_range = [-8, 8] }}
[tool]
kind = "ball"
diameter_mm = 10
length_mm = {length_mm}
[cutting]
spindle_rpm = 8000
feed_mm_min = 1200
[tolerance]
scallop_mm = 0.05
gouge_mm = 0.02
[machine]
file = "machine.toml"
dialect = "linuxcnc"
feed = "none"
[strategy]
kind = "isoplanar_3c"
[verification]
spacing_mm = 0.3
"#
    )
}

#[test]
fn a_short_tool_brings_the_head_down_on_the_rim() {
    let scratch = Scratch::new();
    scratch.write("machine.toml", &format!("{MACHINE}{HEAD}"));
    let plan = |length_mm: f64| {
        let job = scratch.write("job.toml", &job(length_mm));
        let out = scratch.path(&format!("out-{length_mm}"));
        let run = osculate(&["plan", job.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
        let program = out.join("program.ngc");
        let again =
            osculate(&["verify", program.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"]);
        assert_eq!(run.json()["verdict"], again.json()["verdict"], "{}", again.err);
        run.json()
    };
    let long = plan(60.0);
    assert_eq!(long["verdict"]["answer"], "held", "{long}");
    let row = long["verdict"]["scope"]["machine"].as_str().unwrap();
    assert!(row.contains("of the head spindle") && row.contains("the part") && !row.contains("NOT"), "{row}");
    let short = plan(15.0);
    assert_eq!(short["verdict"]["answer"], "not_held", "{short}");
    let text = short["verdict"].to_string();
    assert!(
        text.contains("spindle meets the part") || text.contains("spindle comes within 1.0 mm of the part"),
        "{text}"
    );
}

#[test]
fn a_machine_file_says_its_bodies_wrongly() {
    let scratch = Scratch::new();
    let said = |body: &str| {
        let file = scratch.write("machine.toml", &format!("{MACHINE}{body}"));
        osculate(&["machines", "--check", file.to_str().unwrap()])
    };
    let open = said("");
    assert!(open.code == 0 && open.out.contains("[[body]]"), "{}", open.out);
    assert!(said(HEAD).out.contains("[[body]] of the table"));
    said(&HEAD.replace("\"Z\"", "\"W\"")).refused(&["spindle", "\"W\"", "X, Y, Z", "bed"]);
    said(&format!("{HEAD}{HEAD}")).refused(&["spindle", "no two the same"]);
    said(&HEAD.replace("diameter_mm = 60", "diameter_mm = -60")).refused(&["line 34", "diameter_mm", "-60"]);
    said(&HEAD.replace("120]", "0]")).refused(&["spindle", "same place"]);
    let mesh = "[[body]]\nkind = \"mesh\"\nname = \"table\"\ncarried_by = \"X\"\nfile = \"table.stl\"\n";
    said(mesh).refused(&["table.stl"]);
    scratch.write(
        "table.stl",
        "solid t\nfacet normal 0 0 1\nouter loop\nvertex -90 -90 -40\nvertex 90 -90 -40\nvertex 0 90 -40\nendloop\nendfacet\nendsolid t\n",
    );
    let read = said(mesh);
    assert!(read.code == 0 && read.out.contains("[[body]] of the head"), "{}{}", read.out, read.err);
}
