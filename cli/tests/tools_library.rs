//! Libraries of tools of other systems: read, written, read again. The texts here have the form of what LinuxCNC, FreeCAD and Fusion write.

use crate::common;

use common::{Scratch, osculate};
use osculate::job::library::{Library, Unit};
use serde_json::{Value, json};
use std::path::Path;

/// A tool of Fusion in inches, one in millimetres with a holder, a bull nose, and a drill.
fn fusion() -> String {
    let tool = |kind: &str, unit: &str, geometry: Value, number: u32| {
        json!({
            "type": kind, "unit": unit, "description": format!("{kind} {number}"), "geometry": geometry, "vendor": "somebody",
            "post-process": {"number": number, "diameter-offset": number, "length-offset": number},
            "start-values": {"presets": [{"name": "Default preset", "n": 12000, "v_f": 30, "tool-coolant": "flood"}]},
        })
    };
    let mut held = tool(
        "ball end mill",
        "millimeters",
        json!({"DC": 8, "RE": 4, "LB": 40, "LCF": 16, "NOF": 2, "OAL": 90}),
        3,
    );
    held["holder"] = json!({"type": "holder", "unit": "millimeters", "segments": [
        {"height": 30, "lower-diameter": 16, "upper-diameter": 24}, {"height": 20, "lower-diameter": 40, "upper-diameter": 40},
    ]});
    let all = [
        tool("flat end mill", "inches", json!({"DC": 0.25, "LB": 1.5, "LCF": 0.75, "NOF": 4, "OAL": 2.5}), 1),
        held,
        tool(
            "bull nose end mill",
            "millimeters",
            json!({"DC": 10, "RE": 1.5, "LB": 45, "LCF": 20, "NOF": 3}),
            4,
        ),
        tool("drill", "millimeters", json!({"DC": 5, "SIG": 118}), 5),
    ];
    json!({"data": all, "version": 1}).to_string()
}

/// What must be the same after a way through another file.
fn sizes(library: &Library) -> Vec<Value> {
    let size = |x: f64| json!((x * 1e4).round() / 1e4);
    library
        .tools
        .iter()
        .map(|t| {
            let c = t.cutter();
            json!([
                t.number(),
                t.words(),
                t.kind().word(),
                size(2.0 * c.radius_mm()),
                size(c.corner_mm()),
                size(c.length_mm()),
                size(t.flutes().0.length_mm()),
                t.teeth(),
                t.holder_sections()
            ])
        })
        .collect()
}

#[test]
fn a_library_of_fusion_is_read_with_its_units_and_holders() {
    let scratch = Scratch::new();
    let library = Library::load(&scratch.write("shop.json", &fusion())).unwrap();
    assert_eq!(library.format, "Fusion");
    let found = sizes(&library);
    // A quarter of an inch, an inch and a half.
    assert_eq!(found[0], json!([1, "flat end mill 1", "flat", 6.35, 0.0, 38.1, 19.05, 4, []]));
    let sections = json!([{"diameter_mm": 16.0, "length_mm": 30.0, "upper_diameter_mm": 24.0}, {"diameter_mm": 40.0, "length_mm": 20.0}]);
    assert_eq!(found[1], json!([3, "ball end mill 3", "ball", 8.0, 4.0, 40.0, 16.0, 2, sections]));
    assert_eq!(found[2], json!([4, "bull nose end mill 4", "toroidal", 10.0, 1.5, 45.0, 20.0, 3, []]));
    assert_eq!(library.tools[0].spindle_rpm(), Some(12000.0));
    // The drill is told and not guessed at.
    assert_eq!(library.diagnostics.len(), 1);
    assert!(
        library.diagnostics[0].to_string().contains("\"drill\" is no cutter"),
        "{}",
        library.diagnostics[0]
    );
}

#[test]
fn every_kind_of_library_gives_back_what_it_was_given() {
    let scratch = Scratch::new();
    let first = Library::load(&scratch.write("shop.json", &fusion())).unwrap();
    for name in ["a.toml", "a.tbl", "a.json", "Library/a.fctl"] {
        let to = scratch.path(name);
        let (files, told) = first.files(&to).unwrap();
        for (path, text) in &files {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let again = Library::load(&to).unwrap();
        assert_eq!(sizes(&again), sizes(&first), "{name}");
        assert!(again.diagnostics.is_empty(), "{name}: {:?}", again.diagnostics);
        // FreeCAD has no place for speeds, and says so; the others keep them.
        let keeps = name != "Library/a.fctl";
        assert_eq!(again.tools[0].spindle_rpm().is_some(), keeps, "{name}");
        assert_eq!(told.is_empty(), keeps, "{name}: {told:?}");
    }
    assert!(scratch.path("Bit/a-T3.fctb").is_file());
    // A bit alone is one tool.
    assert_eq!(Library::load(&scratch.path("Bit/a-T3.fctb")).unwrap().tools.len(), 1);
    let refused = first.files(Path::new("a.fctb")).unwrap_err().to_string();
    assert!(refused.contains("write a library, .fctl"), "{refused}");
}

#[test]
fn a_table_of_linuxcnc_says_what_it_does_not_say() {
    let scratch = Scratch::new();
    let text = "T1 P1 X0 Y0 Z12.5 D0.25 I0 J0 Q0 ;1/4\" ball endmill\nT2 P2 D0.5 ;square end mill\nT3 P3 D0.2 ;jobber drill\n\
                T4 P4 Z0 ;end mill\nT1 P9 D0.375 ;ball again\n";
    let table = scratch.write("tool.tbl", text);
    let library = Library::load_in(&table, Unit::Inch).unwrap();
    // Inches are binary fractions of a millimetre as little as decimals are.
    let rounded = |mm: f64| (mm * 1e9).round() / 1e9;
    let found: Vec<_> = library
        .tools
        .iter()
        .map(|t| (t.number(), t.kind().word(), rounded(2.0 * t.cutter().radius_mm())))
        .collect();
    // The second T1 gets the next free number.
    assert_eq!(found, [(1, "ball", 6.35), (2, "flat", 12.7), (3, "ball", 9.525)]);
    let told: Vec<String> = library.diagnostics.iter().map(ToString::to_string).collect();
    for words in ["T3: the remark", "T4 has no diameter", "five diameters", "is that of a tool before it"] {
        assert!(told.iter().any(|t| t.contains(words)), "{words}: {told:?}");
    }
}

/// Lengths that no key of a job allows are told and left out, whoever wrote them, in remarks of ours too.
#[test]
fn tools_beyond_what_a_job_allows_are_left_out() {
    let scratch = Scratch::new();
    let text = "T1 P1 Z40 D8 ;ball [[tool]] kind = \"ball\" | diameter_mm = 8 | length_mm = 1e308\nT2 P2 D1e9 ;ball nose\n\
                T3 P3 D6 ;ball nose\n";
    let library = Library::load(&scratch.write("tool.tbl", text)).unwrap();
    assert_eq!(library.tools.iter().map(osculate::job::Tool::number).collect::<Vec<_>>(), [3]);
    let told: Vec<String> = library.diagnostics.iter().map(ToString::to_string).collect();
    for words in ["line 1: left out", "line 2: left out", "length_mm", "up to 1000000"] {
        assert!(told.iter().any(|t| t.contains(words)), "{words}: {told:?}");
    }
}

#[test]
fn a_library_of_freecad_finds_its_bits() {
    let scratch = Scratch::new();
    for folder in ["Library", "Bit"] {
        std::fs::create_dir_all(scratch.path(folder)).unwrap();
    }
    let bit = |shape: &str, parameter: Value| {
        json!({"version": 2, "name": shape, "shape": format!("{shape}.fcstd"), "parameter": parameter, "attribute": {}}).to_string()
    };
    let ball =
        json!({"Diameter": "0.2500 in", "Length": "50,0000 mm", "CuttingEdgeHeight": "2 cm", "Flutes": "2"});
    scratch.write("Bit/ball.fctb", &bit("ballend", ball));
    scratch.write(
        "Bit/nose.fctb",
        &bit("bullnose", json!({"Diameter": 6, "FlatRadius": "2 mm", "Length": "40 mm"})),
    );
    scratch.write("Bit/v.fctb", &bit("v-bit", json!({"Diameter": "6 mm"})));
    // With a comma and a dot nobody knows which is which.
    scratch.write("Bit/both.fctb", &bit("ballend", json!({"Diameter": "1.234,5 mm", "Length": "50 mm"})));
    let list = json!({"version": 1, "tools": [
        {"nr": 7, "path": "ball.fctb"}, {"nr": 8, "path": "nose.fctb"}, {"nr": 9, "path": "v.fctb"}, {"nr": 10, "path": "gone.fctb"},
        {"nr": 11, "path": "both.fctb"},
    ]});
    let library = Library::load(&scratch.write("Library/shop.fctl", &list.to_string())).unwrap();
    assert_eq!(
        sizes(&library),
        [
            json!([7, "ballend", "ball", 6.35, 3.175, 50.0, 20.0, 2, []]),
            json!([8, "bullnose", "toroidal", 6.0, 1.0, 40.0, 40.0, null, []])
        ]
    );
    let told: Vec<String> = library.diagnostics.iter().map(ToString::to_string).collect();
    for words in [
        "v-bit is no cutter",
        "gone.fctb: left out",
        "both.fctb: left out",
        "not what stands out of the holder",
    ] {
        assert!(told.iter().any(|t| t.contains(words)), "{words}: {told:?}");
    }
}

#[test]
fn the_verb_writes_the_tools_of_the_program_and_reads_them_again() {
    let scratch = Scratch::new();
    let out = scratch.path("mine.json");
    let written = osculate(&["tools", "shipped", "--out", out.to_str().unwrap(), "--json"]).json();
    let again = osculate(&["tools", out.to_str().unwrap(), "--json"]).json();
    assert!(written["tools"].as_array().unwrap().len() > 5);
    assert_eq!(written["tools"], again["tools"]);
    assert_eq!(again["format"], "Fusion");
    osculate(&["tools", out.to_str().unwrap(), "--out", out.to_str().unwrap()])
        .refused(&["mine.json", "what is read here"]);
}

/// Of Fusion every tool has its own unit; where one has none that is told.
#[test]
fn a_tool_of_fusion_without_a_unit_is_told() {
    let scratch = Scratch::new();
    let tool = json!({"type": "flat end mill", "description": "a", "geometry": {"DC": 6, "LB": 30}});
    let library = json!({"data": [tool], "version": 1}).to_string();
    let found = Library::load(&scratch.write("a.json", &library)).unwrap();
    assert_eq!(found.tools.len(), 1);
    assert!(found.diagnostics.iter().any(|d| d.to_string().contains("no unit")), "{:?}", found.diagnostics);
}
