//! Wrong usage and impossible jobs: what is said, the exit code, and that nothing half-written stays behind.

mod common;
use common::{Scratch, job, osculate};

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
    let inspect = |path: &std::path::Path| osculate(&["inspect", path.to_str().unwrap()]);
    inspect(&scratch.path("nothing.igs")).refused(&["nothing.igs", "cannot be read"]);
    inspect(&scratch.write("empty.step", "")).refused(&["empty.step", "empty"]);
    inspect(&scratch.write("prose.step", "It was a dark and stormy night.\n"))
        .refused(&["prose.step", "no format that is read"]);
    let hull = include_str!("../../examples/wigley-hull/hull.step");
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
    with("scallop_mm = 0.02", "scallop_mm = 0").refused(&["scallop_mm = 0", "positive"]);
    with("scallop_mm = 0.02", "scallop_mm = -1").refused(&["scallop_mm = -1", "positive"]);
    with("scallop_mm = 0.02", "scallop_mm = nan").refused(&["scallop_mm = NaN", "positive"]);
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
    std::fs::write(scratch.path("hull.step"), include_str!("../../examples/wigley-hull/hull.step")).unwrap();
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
