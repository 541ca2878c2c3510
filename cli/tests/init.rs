//! A first job from a part alone, and what is said of jobs before they are planned.

use crate::common;
use common::{Scratch, job, osculate};
use std::f64::consts::PI;

/// A ball that is larger than a hollow is told before anything is planned.
#[test]
fn check_says_what_a_tool_does_not_reach() {
    let scratch = Scratch::new();
    let good = scratch.write("good.toml", &job(|t| t));
    let run = osculate(&["check", &good.display().to_string()]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.out.contains("fits") && run.out.contains("not set: [stock]"), "{}", run.out);
    // Hollow to a radius of 1 / (2 * 0.3) = 1.7 mm.
    let hollow = job(|t| t.replace("a_per_mm = 0.005, b_per_mm = -0.003", "a_per_mm = 0.3, b_per_mm = 0.3"));
    let bad = scratch.write("bad.toml", &hollow);
    let run = osculate(&["check", &bad.display().to_string(), "--json"]);
    assert_eq!(run.code, 1, "{}", run.err);
    assert!(run.json()["unreached_mm2"].as_f64().unwrap() > 1.0);
}

/// Two balls on one hollow face, each of which reaches most of it: what neither reaches is its middle, and no share of the one makes up for it.
#[test]
fn check_of_a_list_says_what_no_operation_reaches() {
    let scratch = Scratch::new();
    let tool = |number: u32, diameter_mm: u32| {
        format!("[[tool]]\nnumber = {number}\nkind = \"ball\"\ndiameter_mm = {diameter_mm}\nlength_mm = 40\n")
    };
    let operation = |number: u32| {
        format!(
            "[[operation]]\nname = \"T{number}\"\nkind = \"finish\"\ntools = [{number}]\nstrategy = {{ kind = \"isoplanar_3c\" }}\n"
        )
    };
    let text = "format = 2\n[part]\nbuiltin = { kind = \"paraboloid\", a_per_mm = 0.1, b_per_mm = 0.1, half_size_mm = 6 }\n\
                [stock]\nbox_mm = [-6, -6, -1, 6, 6, 8]\n[tolerance]\nscallop_mm = 0.02\ngouge_mm = 0.01\n"
        .to_owned()
        + &(tool(1, 11) + &tool(2, 12) + &operation(1) + &operation(2));
    let job = scratch.write("list.toml", &text);
    let run = osculate(&["check", &job.display().to_string(), "--json"]);
    assert_eq!(run.code, 1, "{}{}", run.out, run.err);
    let v = run.json();
    let [small, large] = [0, 1].map(|k| {
        let r = &v["reached"][k];
        [&r["reached_mm2"], &r["area_mm2"]].map(|x| x.as_f64().unwrap())
    });
    assert!(small[0] + large[0] > 1.2 * small[1], "{small:?} {large:?}");
    // A ball of radius R rests on z = r^2 / 10 no nearer to its middle than r^2 = R^2 - 5^2.
    let r2 = 5.5f64.powi(2) - 25.0;
    let middle = PI * 50.0 / 3.0 * ((1.0 + r2 / 25.0).powf(1.5) - 1.0);
    let unreached = v["unreached_mm2"].as_f64().unwrap();
    assert!((0.5..1.1).contains(&(unreached / middle)), "{unreached} {middle}");
    assert!((unreached - (small[1] - small[0])).abs() < 1e-9 * middle);
}

/// The schema has every key of the reference, with its words.
#[test]
fn the_schema_has_all_keys() {
    let schema = osculate(&["keys", "--schema"]).json();
    let reference = osculate(&["keys", "--json"]).json();
    for (k, rows) in ["keys", "operations"].iter().enumerate() {
        for row in reference[rows].as_array().unwrap() {
            let (table, key) = (row["table"].as_str().unwrap(), row["key"].as_str().unwrap());
            let mut at = &schema["oneOf"][k];
            for name in table.split('.').filter(|n| !n.is_empty()) {
                let next = &at["properties"][name];
                let either = next["anyOf"].as_array().and_then(|a| a.iter().find(|v| v["type"] == "object"));
                at = either.unwrap_or(if next["type"] == "array" { &next["items"] } else { next });
            }
            let own = &at["properties"][key];
            assert!(own.is_object(), "[{table}] {key}");
            let words = row["words"].as_array().unwrap();
            assert!(words.iter().all(|w| own.to_string().contains(w.as_str().unwrap())), "[{table}] {key}");
        }
    }
}

#[test]
fn shells_and_the_manual_know_all_verbs() {
    let scratch = Scratch::new();
    for shell in ["bash", "zsh", "fish"] {
        let run = osculate(&["completions", shell]);
        assert!(
            run.code == 0 && ["inspect", "init", "verify"].iter().all(|v| run.out.contains(v)),
            "{}",
            run.err
        );
    }
    let pages = scratch.path("man");
    assert_eq!(osculate(&["man", "--out", &pages.display().to_string()]).code, 0);
    let page = std::fs::read_to_string(pages.join("osculate-plan.1")).unwrap();
    assert!(page.contains("The main job") && pages.join("osculate.1").is_file());
}
