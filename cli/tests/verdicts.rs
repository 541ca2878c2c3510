//! What a verdict must not leave out, through the program as a user runs it: raw material, tooth marks, the state of the control.
//! Neighbours, roughing that stops early and the real face behind a ruled one stand in `repository/verdicts.rs`, on example parts.

use crate::common;
use common::verdict::{agree, answer, plan, verify, why};
use common::{Scratch, job};

/// A block that stands far above the part: passes and the ways to them are fed through it, but the holder of a short tool is not, and the
/// plan says so as the verification does; a mesh that is not there is told before any work.
#[test]
fn declared_raw_material_is_judged_by_plans_too() {
    let s = Scratch::new();
    let block = "[stock]\nbox_mm = [-7, -7, -10, 7, 7, 15]\ncell_mm = 0.5\n";
    let run = plan(&s.write("long.toml", &job(|t| t + block)), &s.path("long"));
    assert_eq!((run.code, answer(&run.json())), (0, "held"));
    let short = "length_mm = 12\n[tool.holder]\ndiameter_mm = 20\nlength_mm = 40\n";
    let path = s.write("job.toml", &job(|t| t.replace("length_mm = 50\n", short) + block));
    let run = plan(&path, &s.path("out"));
    let planned = run.json();
    assert_eq!((run.code, answer(&planned)), (1, "not_held"));
    assert!(why(&planned).contains("raw material"), "{}", why(&planned));
    let run = verify(&s.path("out").join("program.ngc"), &path);
    assert_eq!(run.code, 1);
    agree(&planned, &run.json());

    let path = s.write("none.toml", &job(|t| t + "[stock]\nfile = \"missing.stl\"\n"));
    plan(&path, &s.path("none")).refused(&["missing.stl", "[stock]"]);
    assert!(!s.path("none").exists());
}

/// A scallop of 0.15 mm: what stands on the face where no raw material is declared leaves room for the approach, and a declared
/// layer is judged as it is.
#[test]
fn assumed_material_leaves_room_for_approaches() {
    let s = Scratch::new();
    let coarse = |more: &str| job(|t| t.replace("scallop_mm = 0.02", "scallop_mm = 0.15") + more);
    for (name, more, want, code) in [
        ("open", "", "held", 0),
        ("layer", "[stock]\nallowance_mm = 3\ncell_mm = 0.5\n", "held", 0),
        // The last of the way down is fed where material may stand.
        ("low", "[setup]\napproach_mm = 2\n[stock]\nallowance_mm = 3\ncell_mm = 0.5\n", "held", 0),
    ] {
        let path = s.write(&format!("{name}.toml"), &coarse(more));
        let run = plan(&path, &s.path(name));
        let v = run.json();
        assert_eq!((answer(&v), run.code), (want, code), "{name}: {v}");
    }
}

/// 500 rpm, one tooth and 2000 mm/min are 4 mm a tooth: the plan goes slower, and the same program at that feed leaves marks that
/// the verdict counts. `R - sqrt(R^2 - f^2/4)` is 0.76 mm on a plane.
#[test]
fn tooth_marks_belong_to_the_scallop() {
    let s = Scratch::new();
    let text = job(|t| {
        t.replace(
            "kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 6",
            "kind = \"sphere\", radius_mm = 60, material = \"inside\", u_range = [-0.1, 0.1], v_range = [-0.1, 0.1]",
        )
        .replace("diameter_mm = 10", "diameter_mm = 6\nteeth = 1")
        .replace("spindle_rpm = 8000", "spindle_rpm = 500")
        .replace("scallop_mm = 0.02", "scallop_mm = 0.005")
        .replace("gouge_mm = 0.005\n", "gouge_mm = 0.0025\n")
        .replace("chord_mm = 0.003", "chord_mm = 0.001")
        .replace("max_samples = 20000", "max_samples = 60000")
    });
    let path = s.write("job.toml", &text);
    let run = plan(&path, &s.path("out"));
    let v = run.json();
    assert_eq!((answer(&v), run.code), ("held", 0), "{v}");
    let mark = v["verification"]["tooth_mark_max_mm"].as_f64().unwrap();
    assert!(mark > 0.001 && mark < 0.005, "{mark}");
    let program = std::fs::read_to_string(s.path("out").join("program.ngc")).unwrap();
    let feed = |line: &str| line.split_whitespace().find_map(|w| w.strip_prefix('F')?.parse::<f64>().ok());
    let fastest = program.lines().filter_map(feed).fold(0.0, f64::max);
    assert!(fastest > 0.0 && fastest < 200.0, "{fastest}");
    // The same way at 2000 mm/min.
    let fast: Vec<String> = program
        .lines()
        .map(|l| {
            let words = l.split_whitespace().map(|w| match w.strip_prefix('F').map(str::parse::<f64>) {
                Some(Ok(_)) => "F2000".to_owned(),
                _ => w.to_owned(),
            });
            words.collect::<Vec<_>>().join(" ")
        })
        .collect();
    let run = verify(&s.write("fast.ngc", &(fast.join("\n") + "\n")), &path);
    let v = run.json();
    assert_eq!((answer(&v), run.code), ("not_held", 1), "{v}");
    assert!(why(&v).contains("tooth mark"), "{}", why(&v));
    let mark = v["tooth_mark_max_mm"].as_f64().unwrap();
    assert!(mark > 0.4 && mark < 0.9, "{mark}");
}

/// A pass of a ball along a strip, by hand: as fast as its tool is for it says nothing more, in the air it may be faster, and where it cuts
/// that is told, with raw material and without.
#[test]
fn what_cuts_faster_than_its_tool_is_for_is_told() {
    let s = Scratch::new();
    let strip = "format = 1\npart = { builtin = { kind = \"plane\", half_size_mm = 1 } }\n\
                 tool = { kind = \"ball\", diameter_mm = 6, length_mm = 40 }\ntolerance = { scallop_mm = 0.2 }\n\
                 cutting = { spindle_rpm = 8000, feed_mm_min = 500 }\n\
                 machine = { name = \"3-axis\", dialect = \"linuxcnc\", feed = \"none\" }\n";
    let pass = "G21 G90 G94 G54 G61\nT1 M6\nS8000 M3\nG43 H1\nG0 X-8 Y0\nG0 Z5\nG1 Z0 F500\nG1 X-5\nG1 X5 F500\nG1 X8\nG0 Z50\nM30\n";
    let stock = "stock = { box_mm = [-1, -1, -2, 1, 1, 0.5], cell_mm = 0.1 }\n";
    for (name, stock) in [("assumed", ""), ("declared", stock)] {
        let path = s.write(&format!("{name}.toml"), &format!("{strip}{stock}"));
        let said = |program: &str| {
            let v = verify(&s.write("pass.ngc", program), &path).json();
            assert_eq!(answer(&v), "held", "{name}: {v}");
            let remarks = v["verdict"]["remarks"].as_array().unwrap().len();
            (v["verdict"]["scope"]["feed"].as_str().unwrap().to_owned(), remarks)
        };
        let (row, remarks) = said(pass);
        assert!(row.contains("no faster than its tool's feed") && remarks == 0, "{name}: {row}");
        let in_air = pass.replace("G1 X-5\n", "G1 X-5 F3000\n").replace("G1 X8\n", "G1 X8 F3000\n");
        assert_eq!(said(&in_air), (row, 0), "{name}");
        let (row, remarks) = said(&pass.replace("X5 F500", "X5 F1500"));
        assert!(
            row.starts_with("1 move that cuts is faster") && row.contains("1500 mm/min"),
            "{name}: {row}"
        );
        assert_eq!(remarks, 1, "{name}");
    }
}

/// Faults of state that move no axis: none may pass.
#[test]
fn a_program_in_another_state_of_the_control_does_not_hold() {
    let s = Scratch::new();
    let path = s.write("job.toml", &job(|t| t));
    let run = plan(&path, &s.path("out"));
    assert_eq!(answer(&run.json()), "held", "{}", run.out);
    let text = std::fs::read_to_string(s.path("out").join("program.ngc")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let middle = lines.len() / 2;
    let insert = |what: &str| [&lines[..middle], &[what], &lines[middle..]].concat().join("\n") + "\n";
    let replace = |from: &str, to: &str| {
        assert!(text.contains(from), "'{from}' is not in the program");
        text.replacen(from, to, 1)
    };
    let skipped: Vec<String> = lines
        .iter()
        .enumerate()
        .map(|(k, l)| if (middle..middle + 30).contains(&k) { format!("/{l}") } else { (*l).to_owned() })
        .collect();
    let faults = [
        ("no length", replace("G43 H1", ""), "not_held"),
        ("length off amid", insert("G49"), "not_held"),
        ("another length", replace("G43 H1", "G43 H2"), "not_held"),
        ("another tool", replace("T1 M6", "T7 M6"), "not_held"),
        ("another offset", replace("G54", "G55"), "not_held"),
        ("no spindle", replace("S8000 M3", ""), "not_held"),
        ("spindle off amid", insert("M5"), "not_held"),
        ("wide corners", insert("G64 P0.5"), "not_shown"),
        ("skipped blocks", skipped.join("\n") + "\n", "not_shown"),
    ];
    for (name, program, want) in faults {
        let file = s.write("fault.ngc", &program);
        let run = verify(&file, &path);
        let v = run.json();
        assert_eq!((answer(&v), run.code), (want, 1), "{name}: {v}");
        assert!(!why(&v).is_empty());
    }
    // What says the same in other words changes nothing.
    // Comments stay: the head of the program says there where the part sits.
    let wide = |l: &&str| if l.starts_with('(') { (*l).to_owned() } else { l.replace(' ', "  ") };
    let spaced = lines.iter().map(wide).collect::<Vec<_>>().join("\n").replace("G54", "G54 (offset)") + "\n";
    let number = |(k, l): (usize, &&str)| {
        if l.starts_with(['(', '%']) { (*l).to_owned() } else { format!("N{} {l}", 10 * k) }
    };
    let numbered: Vec<String> = lines.iter().enumerate().map(number).collect();
    let right = verify(&s.path("out").join("program.ngc"), &path).json();
    for program in [spaced, numbered.join("\n") + "\n"] {
        let v = verify(&s.write("same.ngc", &program), &path).json();
        assert_eq!(v["verdict"]["answer"], right["verdict"]["answer"]);
        assert_eq!(v["height_max_mm"], right["height_max_mm"]);
    }
}
