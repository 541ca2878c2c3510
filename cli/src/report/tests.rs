//! The page and the picture as a whole: well-formed, safe against what names may contain, calm about nothing and
//! nonsense.

use super::*;
use osculate_geom::Diagnostic;

/// A wavy 40 by 30 mm sheet of 2 n^2 triangles with the deviation of a scallop pattern, passes along x, and a tool.
fn sheet(n: u32) -> Report {
    let stride = n + 1;
    let at = |i: u32| {
        let (x, y) = (40.0 * (i % stride) as f32 / n as f32, 30.0 * (i / stride) as f32 / n as f32);
        [x, y, 3.0 * (0.2 * x).sin() + 0.02 * y * y]
    };
    let positions: Vec<[f32; 3]> = (0..stride * stride).map(at).collect();
    let corner = |i: u32| (i / n) * stride + i % n;
    let triangles =
        (0..n * n).map(corner).flat_map(|c| [[c, c + 1, c + stride], [c + 1, c + stride + 1, c + stride]]);
    let deviation_mm = positions.iter().map(|p| 0.008 * (2.0 * p[1]).sin().abs()).collect();
    let scalars = vec![positions.iter().map(|p| 0.01 * p[0]).collect()];
    let face = FaceMesh {
        id: "F1".into(),
        triangles: triangles.collect(),
        positions,
        deviation_mm,
        scalars,
        ..FaceMesh::default()
    };
    let pass = |k: u32| Pass {
        points_mm: (0..40)
            .map(|i| {
                let (x, y) = (i as f32, k as f32);
                [x, y, 3.0 * (0.2 * x).sin() + 0.02 * y * y]
            })
            .collect(),
        widths_mm: (0..40).map(|i| 1.0 + 0.01 * i as f32).collect(),
    };
    let pose = |k: u32| ToolPose {
        tip_mm: [k as f32, 2.0, 1.0],
        axis: [0.1, 0.0, 0.995],
        time_min: k as f32,
        pass: Some(k),
        tool: 0,
        line: 10 * k,
        setup: 0,
        at_nose: [0.1 * k as f32; 5],
    };
    Report {
        title: "Sheet".into(),
        faces: vec![face],
        scalars: vec![Scalar { name: "curvature".into(), unit: "1/mm".into() }],
        passes: (0..30).map(pass).collect(),
        links: vec![Link { points_mm: vec![[0.0; 3], [0.0, 0.0, 20.0]], rapid: true }],
        tools: vec![Tool {
            label: "ball D10".into(),
            diameter_mm: 10.0,
            corner_radius_mm: 5.0,
            length_mm: 40.0,
            ..Tool::default()
        }],
        poses: (0..30).map(pose).collect(),
        verdict: Verdict {
            outcome: Outcome::Within,
            scallop_max_mm: 0.008,
            scallop_tolerance_mm: 0.01,
            gouge_tolerance_mm: 0.005,
            ..Verdict::default()
        },
        ..Report::default()
    }
}

/// Every element that opens closes in order, every attribute is quoted, and no bare `<` or `&` stands in text: what
/// an XML parser would insist on, for the subset that is written here. Panics with what is wrong.
fn assert_well_formed(xml: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = xml;
    while let Some(start) = rest.find('<') {
        check_entities(&rest[..start]);
        let end = start + rest[start..].find('>').expect("a tag ends");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "closes what is open");
            continue;
        }
        let (body, alone) = tag.strip_suffix('/').map_or((tag, false), |b| (b, true));
        let name = body.split_whitespace().next().expect("a tag has a name");
        let mut attributes = body[name.len()..].trim();
        let mut seen = Vec::new();
        while !attributes.is_empty() {
            let (key, after) = attributes.split_once("=\"").unwrap_or_else(|| panic!("unquoted: {tag}"));
            let (value, after) = after.split_once('"').unwrap_or_else(|| panic!("unclosed: {tag}"));
            assert!(!value.contains('<') && !seen.contains(&key.trim()), "{tag}");
            check_entities(value);
            seen.push(key.trim());
            attributes = after.trim();
        }
        if !alone {
            open.push(name);
        }
    }
    check_entities(rest);
    assert!(open.is_empty(), "left open: {open:?}");
}

fn check_entities(text: &str) {
    for piece in text.split('&').skip(1) {
        let name = piece.split(';').next().unwrap_or_default();
        assert!(["amp", "lt", "gt", "quot", "#39"].contains(&name), "bare & before {piece}");
    }
}

#[test]
fn the_picture_is_well_formed_in_every_view() {
    let report = sheet(20);
    for part in [PartColours::Deviation, PartColours::Plain] {
        for path in [PathColours::Hidden, PathColours::Plain, PathColours::StripWidth] {
            for tool_at in [None, Some(0.5)] {
                let text =
                    svg(&report, &View { part, path, tool_at, links: tool_at.is_some(), ..View::default() });
                assert_well_formed(&text);
                assert!(text.starts_with("<svg xmlns=") && !text.contains("NaN") && !text.contains("inf"));
            }
        }
    }
}

/// A tool that is away for a change is shown where it comes back: the picture is that of the next pose among the passes.
#[test]
fn the_picture_has_no_room_for_the_way_to_a_tool_change() {
    let view = View { tool_at: Some(15.0 / 29.0), ..View::default() };
    let mut away = sheet(20);
    away.poses[15].tip_mm = [1400.0, -2200.0, 1500.0];
    let mut back = sheet(20);
    back.poses[15] = back.poses[16];
    let picture = svg(&away, &view);
    assert_eq!(picture, svg(&back, &view));
    assert_ne!(picture, svg(&sheet(20), &view));
}

/// 2 * 250^2 triangles, whose colours change from facet to facet as much as scallops can make them.
#[test]
fn the_picture_stays_small() {
    let text = svg(&sheet(250), &View { links: true, ..View::default() });
    assert!((60_000..300_000).contains(&text.len()), "{}", text.len());
}

/// 100 000 shared vertices at 14 bytes and 200 000 triangles at 12 would be 5.1 MB of base64; packed they leave room for the
/// scripts, 0.6 MB, and the still picture.
#[test]
fn the_page_of_200_000_triangles_stays_below_3_mb() {
    let report = sheet(317);
    assert!(report.faces[0].triangles.len() > 200_000);
    let text = html(&report);
    assert!((1_000_000..3_000_000).contains(&text.len()), "{}", text.len());
}

/// The charts of the joints stand on the page where the report has a machine; without one it says that nothing is known.
#[test]
fn joints_have_their_charts() {
    let mut report = sheet(4);
    let page = html(&report);
    assert!(page.contains("No places of rotary joints are known") && page.contains("No places of slides"));
    let joint = |letter: &str, turns: bool| machine::Joint {
        letter: letter.into(),
        turns,
        of_table: true,
        direction: [0.0, 0.0, 1.0],
        point_mm: [0.0; 3],
    };
    let joints = vec![joint("X", false), joint("<i>", true)];
    report.machine = Some(machine::Machine { joints, ..machine::Machine::default() });
    let page = html(&report);
    for name in ["Rotary joints over the time", "Slides over the time"] {
        let chart = page.split(&format!("<h2>{name}</h2>")).nth(1).expect("a chart");
        let chart = chart.split("</section>").next().expect("it ends");
        assert_well_formed(chart);
        assert!(chart.starts_with("<svg") && !chart.contains("NaN"), "{chart}");
    }
    assert!(page.contains(">&lt;i&gt;</text>") && !page.contains("No places of"));
}

#[test]
fn same_report_same_bytes() {
    let report = sheet(80);
    assert_eq!(html(&report), html(&report.clone()));
}

#[test]
fn nothing_to_show_is_no_reason_to_fail() {
    let empty = Report::default();
    assert_well_formed(&svg(&empty, &View::default()));
    let page = html(&empty);
    assert!(page.contains("Not verified") && !page.contains("Within tolerance"));
}

#[test]
fn nonsense_is_no_reason_to_fail() {
    let mut report = sheet(4);
    report.faces[0].positions[3] = [f32::NAN; 3];
    report.faces[0].triangles.push([7, 8, 4_000_000]);
    report.faces[0].deviation_mm.truncate(5);
    report.faces[0].deviation_mm[1] = f32::INFINITY;
    report.faces[0].scalars.clear();
    report.passes[0].points_mm[2] = [f32::INFINITY; 3];
    report.passes[1].widths_mm.clear();
    report.poses[0].axis = [0.0; 3];
    report.poses[1].tip_mm = [f32::NAN; 3];
    report.links.push(Link::default());
    report.verdict.scallop_tolerance_mm = f64::NAN;
    report.verdict.gouge_tolerance_mm = -1.0;
    report.stages.push(Stage { name: String::new(), wall_s: f64::NAN });
    report.tables.push(Table { rows: vec![vec![], vec!["a".into(); 9]], ..Table::default() });
    let page = html(&report);
    assert!(page.contains("triangles are not drawn") && page.contains("links are not drawn"));
    for tool_at in [Some(0.0), Some(f64::NAN), Some(9.0)] {
        let view = View { tool_at, width_px: 0, height_px: u32::MAX, ..View::default() };
        assert_well_formed(&svg(&report, &view));
    }
}

/// Whatever a name holds, the page has as many script elements as without it, and the name is still there to read.
#[test]
fn names_cannot_break_out() {
    let evil = "</script><script>alert(1)</script><!--\"'&]]>";
    let mut report = sheet(3);
    report.title = evil.into();
    report.subtitle = evil.into();
    report.faces[0].id = evil.into();
    report.scalars[0].name = evil.into();
    report.verdict.words = evil.into();
    report.verdict.source = evil.into();
    report.verdict.samples = 1;
    report.verdict.worst =
        vec![Worst { deviation_mm: 0.1, at_mm: [0.0; 3], place: evil.into(), pose: Some(1) }];
    report.histogram = Histogram { edges_mm: vec![0.0, 1.0], weights: vec![1.0], unit: evil.into() };
    report.diagnostics = vec![Diagnostic::warning(evil, evil)];
    report.stages = vec![Stage { name: evil.into(), wall_s: 1.0 }];
    report.tables = vec![Table {
        caption: evil.into(),
        columns: vec![Column { name: evil.into(), unit: evil.into() }],
        rows: vec![vec![evil.into()]],
    }];
    if let Some(tool) = report.tools.first_mut() {
        tool.label = evil.into();
    }
    let page = html(&report);
    assert_eq!(page.matches("<script").count(), 4);
    assert_eq!(page.matches("</script").count(), 4);
    assert!(!page.contains("<!--") && !page.contains("alert(1)<"));
    assert!(page.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
    assert_well_formed(&svg(&report, &View::default()));
}

/// The bundled scripts stand inside `script` elements and must not end them; the page must not ask for anything.
#[test]
fn the_page_stands_alone() {
    let page = html(&sheet(3));
    let assets = [include_str!("../../assets/three.bundle.min.js"), include_str!("../../assets/viewer.js")];
    for asset in assets {
        assert!(!asset.contains("</script") && !asset.contains("<!--") && page.contains(asset));
    }
    assert!(page.contains("default-src 'none'"));
    let own = assets.iter().fold(page.clone(), |text, asset| text.replace(asset, ""));
    for reference in ["src=", "href=", "url(", "@import", "http://", "https://"] {
        // The one address is the name of the SVG vocabulary, which nobody loads.
        assert_eq!(
            own.replace("http://www.w3.org/2000/svg", "").matches(reference).count(),
            0,
            "{reference}"
        );
    }
}

/// What the verification measured decides the words, also where the numbers are good.
#[test]
fn the_verdict_is_said() {
    let mut report = sheet(3);
    for (outcome, word) in [
        (Outcome::Within, "Within tolerance"),
        (Outcome::Outside, "Out of tolerance"),
        (Outcome::NotVerified, "Not verified"),
    ] {
        report.verdict.outcome = outcome;
        assert!(html(&report).contains(&format!("<div class=\"word\">{word}</div>")));
    }
    report.verdict.scallop_max_mm = 0.0101;
    assert!(html(&report).contains("<div class=\"tile bad\"><div class=\"name\">Scallop, greatest</div>"));
}

/// A quarter of the faces that stays uncut stands in the headline, which then is not the one of a part that is done.
#[test]
fn what_stays_uncut_stands_in_the_headline() {
    let mut report = sheet(3);
    report.verdict.outcome = Outcome::Within;
    report.verdict.uncut_area_mm2 = 25.0;
    report.verdict.area_mm2 = 100.0;
    report.verdict.uncut_accepted_mm2 = 30.0;
    let page = html(&report);
    let words =
        "Within tolerance where it is cut; 25.00 mm\u{b2} stay uncut, 25 % of the faces, as the job accepts";
    assert!(page.contains(&format!("<div class=\"word\">{words}</div>")));
    assert!(page.contains("card verdict partly") && !page.contains("card verdict within"));
    assert!(page.contains("no pass reached; 30.00 are accepted"));
    report.verdict.outcome = Outcome::Outside;
    assert!(html(&report).contains("Out of tolerance; 25.00 mm\u{b2} stay uncut, 25 % of the faces</div>"));
}
