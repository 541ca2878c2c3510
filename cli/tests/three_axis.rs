//! Gradient lines and roughing from job file to verified program.

use crate::common;
use common::{Scratch, job, osculate};

const ONE: &str = "[tool]\nkind = \"ball\"\ndiameter_mm = 10\nlength_mm = 50\n";
const FINISH: &str = "kind = \"isoparametric\"\nlead_deg = 15";
const BULL: &str = "[tool]\nkind = \"toroidal\"\ndiameter_mm = 5\ncorner_radius_mm = 1\nlength_mm = 50\n";
const LAYERS: &str = "kind = \"z_level\"\nstepdown_mm = 1\nstepover_mm = 1.5\nallowance_mm = 0.3";
const STOCK: &str = "[stock]\nbox_mm = [-7, -7, -2, 7, 7, 2.5]\ncell_mm = 0.25\n";

/// The small job with another tool and strategy.
fn with(tool: &str, strategy: &str) -> String {
    job(|j| {
        assert!(j.contains(ONE) && j.contains(FINISH));
        j.replace(ONE, tool).replace(FINISH, strategy)
    })
}

fn planned(text: &str) -> common::Run {
    let folder = Scratch::new();
    let job = folder.write("job.toml", text);
    osculate(&["plan", job.to_str().unwrap(), "--out", folder.path("out").to_str().unwrap(), "--json"])
}

#[test]
fn gradient_lines_hold_and_say_what_they_leave() {
    let run = planned(&with(BULL, "kind = \"gradient_3c\"\naxis = [0.3, 0, 1]"));
    let summary = run.json();
    assert_eq!(run.code, 0, "{summary}");
    assert_eq!(summary["strategy"], "gradient_3c");
    assert_eq!(summary["verification"]["within_tolerance"], true);
    planned(&with(ONE, "kind = \"gradient_3c\"")).refused(&["gradient_3c", "flat or toroidal cutter"]);
    planned(&with(BULL, "kind = \"gradient_3c\"\nlead_deg = 5"))
        .refused(&["gradient_3c keeps the tool axis"]);
}

#[test]
fn roughing_leaves_its_allowance_and_wants_raw_material() {
    let rough = with(BULL, LAYERS).replace("scallop_mm = 0.02", "scallop_mm = 0.3") + STOCK;
    let run = planned(&rough);
    let summary = run.json();
    assert_eq!(run.code, 0, "{summary}");
    let verified = &summary["verification"];
    // Measured from the allowance: nothing deeper than the chords, nothing left but cusps between rows.
    assert!(verified["gouge_max_mm"].as_f64().unwrap() <= 0.005, "{verified}");
    assert_eq!(verified["uncut_area_mm2"].as_f64().unwrap(), 0.0, "{verified}");
    let notes = summary["diagnostics"].to_string();
    assert!(notes.contains("mm3 are taken") && !notes.contains("goes"), "{notes}");
    planned(&with(BULL, LAYERS)).refused(&["z_level needs the raw material", "[stock]"]);
    planned(&(with(BULL, "kind = \"z_level\"\nstepover_mm = 2") + STOCK)).refused(&["needs stepdown_mm"]);
    let below = STOCK.replace("7, 7, 2.5", "7, 7, -1.5");
    planned(&(with(BULL, LAYERS) + &below)).refused(&["nothing stands on it that the tool reaches"]);
}
