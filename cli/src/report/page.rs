//! The page around the pictures: verdict, tables, charts, findings, and the data the viewer reads.
//!
//! Everything stands in the one file, and its content policy forbids the browser to load anything else. Whatever the
//! report says is escaped; the data block is base64 and the JSON head has no `<`.

use super::chart;
use super::data::{Outcome, Report, Table, Tool, Verdict};
use super::joint_chart::{self, Moved};
use super::legend::{Limits, Scale, UNKNOWN};
use super::mesh::{Clean, clean};
use super::opening::opening;
use super::pack::pack;
use super::text::{STYLE, base64, count, escape, figure, fixed, script_json, short};
use super::tool_body::{Piece, outlines};
use super::viewer::{LEGEND_PX, Scales, viewer};
use miniz_oxide::deflate::compress_to_vec_zlib;
use osculate_geom::Severity;
use serde_json::{Value, json};
use std::fmt::Write;

/// How hard the block is packed, of 10: more takes longer and saves little.
const PACKED: u8 = 6;

const THREE: &str = include_str!("../../assets/three.bundle.min.js");
const VIEWER: &str = include_str!("../../assets/viewer.js");

/// Tables with more columns than this stand below the picture and not beside it.
const NARROW_COLUMNS: usize = 3;
/// Tables of more columns have the width of the page to themselves.
const BESIDE_ANOTHER: usize = 5;

/// The page of `report`: a complete HTML document that needs no other file and no network.
pub fn html(report: &Report) -> String {
    let faces: Vec<Clean> = report.faces.iter().map(|f| clean(f, report.scalars.len())).collect();
    let limits = Limits {
        scallop_mm: report.verdict.scallop_tolerance_mm,
        gouge_mm: report.verdict.gouge_tolerance_mm,
    };
    let scales = Scales::new(report, &faces, limits);
    let packed = pack(report, &faces);
    let mut head = packed.head;
    let opening = opening(report, &faces);
    head["opening"] = json!(opening.toward());
    head["limits"] = json!({"scallop": limits.scallop_mm, "gouge": limits.gouge_mm});
    head["unknown"] = json!(UNKNOWN);
    head["measured"] = json!(!report.faces_only);
    head["legend_length"] = json!(LEGEND_PX);
    head["deviation"] = scale_json(&scales.deviation);
    head["width"] = scales.width.as_ref().map_or(Value::Null, scale_json);
    head["scalars"] = scales.scalars.iter().map(|s| s.as_ref().map_or(Value::Null, scale_json)).collect();
    head["tools"] = report.tools.iter().map(tool_json).collect();

    let mut out = String::with_capacity(packed.bytes.len() * 4 / 3 + THREE.len() + 400_000);
    let _ = write!(
        out,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; \
         style-src 'unsafe-inline'; img-src data: blob:\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"generator\" content=\"osculate {}\">\n<title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <div class=\"wrap\">\n",
        env!("CARGO_PKG_VERSION"),
        escape(&report.title)
    );
    let _ = writeln!(
        out,
        "<header><div><h1>{}</h1><p>{}</p></div><button id=\"theme\" type=\"button\" \
         title=\"Switch between light and dark\">Light / dark</button></header>",
        escape(&report.title),
        escape(&report.subtitle)
    );
    if !report.faces_only {
        verdict(&mut out, &report.verdict);
    }

    let (beside, below): (Vec<&Table>, Vec<&Table>) =
        report.tables.iter().partition(|t| t.columns.len() <= NARROW_COLUMNS);
    let solo = if beside.is_empty() && report.verdict.worst.is_empty() { " solo" } else { "" };
    let _ = writeln!(out, "<main class=\"main{solo}\">");
    viewer(&mut out, report, &faces, (&scales, opening));
    if solo.is_empty() {
        out.push_str("<aside class=\"card\"><div>");
        beside.iter().for_each(|t| table(&mut out, t));
        worst(&mut out, &report.verdict, limits);
        out.push_str("</div></aside>\n");
    }
    out.push_str("</main>\n");
    if !report.faces_only {
        charts(&mut out, report, &scales);
    }
    if !below.is_empty() {
        out.push_str("<div class=\"wide-tables\">");
        for t in below {
            let whole = if t.columns.len() > BESIDE_ANOTHER { " whole" } else { "" };
            let _ = write!(out, "<section class=\"card scroll{whole}\">");
            table(&mut out, t);
            out.push_str("</section>");
        }
        out.push_str("</div>\n");
    }
    findings(&mut out, report, &packed.notes);
    let frame = if report.faces_only {
        "Lengths in mm. Click a face to copy its id."
    } else {
        "Lengths in mm; deviation along the outward normal: positive is material left, negative is gouge."
    };
    let _ = write!(out, "<footer>osculate {}. {frame}</footer>\n</div>\n", env!("CARGO_PKG_VERSION"));
    let _ = write!(
        out,
        "<script id=\"report-head\" type=\"application/json\">{}</script>\n\
         <script id=\"report-data\" type=\"text/plain\">{}</script>\n<script>{THREE}</script>\n<script>\n{VIEWER}</script>\n\
         </body>\n</html>\n",
        script_json(&head),
        base64(&compress_to_vec_zlib(&packed.bytes, PACKED))
    );
    out
}

fn scale_json(scale: &Scale) -> Value {
    let stops: Vec<Value> = scale
        .stops
        .iter()
        .map(|s| {
            let [r, g, b] = s.colour;
            json!([s.value, r, g, b])
        })
        .collect();
    json!({"name": scale.name, "unit": scale.unit, "stops": stops})
}

fn tool_json(tool: &Tool) -> Value {
    let kind = |piece| match piece {
        Piece::Cutter => "cutter",
        Piece::Shank => "shank",
        Piece::Holder => "holder",
    };
    let pieces: Vec<Value> = outlines(tool)
        .into_iter()
        .map(|(piece, outline)| json!({"kind": kind(piece), "outline": outline}))
        .collect();
    json!({"label": tool.label, "pieces": pieces})
}

/// What stands first on the page, and how it looks: with an uncut area nothing is plainly within tolerance.
fn headline(v: &Verdict) -> (&'static str, String) {
    let uncut = v.uncut_area_mm2 > 0.0;
    let (class, word) = match v.outcome {
        Outcome::Within if uncut => ("partly", "Within tolerance where it is cut"),
        Outcome::Within => ("within", "Within tolerance"),
        Outcome::Outside => ("outside", "Out of tolerance"),
        Outcome::NotShown => ("unknown", "Not shown to hold"),
        Outcome::NotVerified => ("unknown", "Not verified"),
    };
    if !uncut {
        return (class, word.to_owned());
    }
    let mut words = format!("{word}; {} mm\u{b2} stay uncut", figure(v.uncut_area_mm2, 4));
    let share = 100.0 * v.uncut_area_mm2 / v.area_mm2;
    if share.is_finite() {
        let _ = write!(words, ", {} % of the faces", figure(share, 2));
    }
    if v.outcome == Outcome::Within {
        words.push_str(", as the job accepts");
    }
    (class, words)
}

fn verdict(out: &mut String, v: &Verdict) {
    let (class, word) = headline(v);
    let _ = write!(
        out,
        "<section class=\"card verdict {class}\"><div class=\"call\"><div class=\"word\">{word}</div><p>{}</p>",
        escape(&v.words)
    );
    if v.samples > 0 {
        let from = if v.source.is_empty() { String::new() } else { format!("{}, ", v.source) };
        let _ = write!(out, "<p class=\"source\">{}{} samples</p>", escape(&from), count(v.samples));
    }
    out.push_str("</div>");
    tile(out, "Scallop, greatest", v.scallop_max_mm, v.scallop_tolerance_mm);
    tile(out, "Scallop, 99 of 100 below", v.scallop_p99_mm, v.scallop_tolerance_mm);
    tile(out, "Gouge, deepest", v.gouge_max_mm, v.gouge_tolerance_mm);
    let bad = if v.uncut_area_mm2 > 0.0 { " bad" } else { "" };
    let of = if v.uncut_accepted_mm2 > 0.0 {
        format!("no pass reached; {} are accepted", figure(v.uncut_accepted_mm2, 4))
    } else {
        "that no pass reached".to_owned()
    };
    let _ = writeln!(
        out,
        "<div class=\"tile{bad}\"><div class=\"name\">Uncut area</div><div class=\"value\">{} <small>mm\u{b2}</small></div>\
         <div class=\"of\">{of}</div></div></section>",
        figure(v.uncut_area_mm2, 3)
    );
}

/// One measured value against its tolerance; the tolerance stands at two thirds of the gauge.
fn tile(out: &mut String, name: &str, value: f64, tolerance: f64) {
    let share = value / tolerance;
    let bad = if value > tolerance { " bad" } else { "" };
    let _ = write!(
        out,
        "<div class=\"tile{bad}\"><div class=\"name\">{name}</div><div class=\"value\">{} <small>mm</small></div>",
        fixed(value, 4)
    );
    if share.is_finite() && tolerance > 0.0 {
        let _ = write!(
            out,
            "<div class=\"gauge\"><i style=\"width:{:.1}%\"></i><b></b></div><div class=\"of\">{} % of {} mm</div>",
            (share * 200.0 / 3.0).clamp(0.0, 100.0),
            fixed(100.0 * share, 0),
            short(tolerance, 3)
        );
    } else {
        out.push_str("<div class=\"of\">nothing to compare</div>");
    }
    out.push_str("</div>");
}

fn worst(out: &mut String, v: &Verdict, limits: Limits) {
    if v.worst.is_empty() {
        return;
    }
    out.push_str(
        "<table><caption>Worst places</caption><thead><tr><th>mm</th>\
         <th>where</th><th></th></tr></thead><tbody>",
    );
    for place in &v.worst {
        let class = if limits.severity(place.deviation_mm) > 1.0 { "bad" } else { "" };
        let sign = if place.deviation_mm > 0.0 { "+" } else { "" };
        let [x, y, z] = place.at_mm;
        let _ = write!(
            out,
            "<tr><td class=\"{class}\" style=\"white-space:nowrap\">{sign}{}</td><td>{} <span class=\"faint\">({}, {}, {})</span></td>\
             <td class=\"n\">",
            fixed(place.deviation_mm, 4),
            escape(&place.place),
            fixed(x, 2),
            fixed(y, 2),
            fixed(z, 2)
        );
        if place.at_mm.iter().all(|c| c.is_finite()) {
            let pose = place.pose.map_or_else(String::new, |k| format!(" data-pose=\"{k}\""));
            let _ = write!(
                out,
                "<button type=\"button\" class=\"needs-live\" data-at=\"{x} {y} {z}\"{pose}>Show</button>"
            );
        }
        out.push_str("</td></tr>");
    }
    out.push_str("</tbody></table>");
}

/// Does the cell hold a number, so that it belongs to the right?
fn is_number(cell: &str) -> bool {
    let plain: String =
        cell.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '\u{2212}' { '-' } else { c }).collect();
    plain.is_empty()
        || plain == "\u{2013}"
        || plain == "-"
        || plain.trim_end_matches('%').parse::<f64>().is_ok()
}

fn table(out: &mut String, table: &Table) {
    let pairs = table.columns.is_empty();
    let _ = write!(
        out,
        "<table{}><caption>{}</caption>",
        if pairs { " class=\"pairs\"" } else { "" },
        escape(&table.caption)
    );
    let numeric: Vec<bool> = (0..table.columns.len())
        .map(|k| table.rows.iter().all(|row| row.get(k).is_none_or(|cell| is_number(cell))))
        .collect();
    let side = |k: usize| if numeric.get(k) == Some(&true) { " class=\"n\"" } else { "" };
    if !pairs {
        out.push_str("<thead><tr>");
        for (k, column) in table.columns.iter().enumerate() {
            let _ = write!(out, "<th{}>{}", side(k), escape(&column.name));
            if !column.unit.is_empty() {
                let _ = write!(out, "<br>{}", escape(&column.unit));
            }
            out.push_str("</th>");
        }
        out.push_str("</tr></thead>");
    }
    out.push_str("<tbody>");
    for row in &table.rows {
        out.push_str("<tr>");
        for (k, cell) in row.iter().enumerate() {
            if pairs && k == 0 {
                let _ = write!(out, "<th>{}</th>", escape(cell));
            } else {
                let _ = write!(out, "<td{}>{}</td>", side(k), escape(cell));
            }
        }
        out.push_str("</tr>");
    }
    out.push_str("</tbody></table>");
}

fn charts(out: &mut String, report: &Report, scales: &Scales) {
    let figures = [
        (
            "Deviation over the part",
            chart::histogram(&report.histogram, &scales.deviation),
            "Nothing was measured.",
        ),
        (
            "Strip width: least to greatest, and mean",
            chart::strip_widths(&report.passes, scales.width.as_ref()),
            "No strip widths are known.",
        ),
        ("Feed over the time", chart::pace(&report.pace), "No times of motions are known."),
        (
            "Rotary joints over the time",
            joint_chart::joints(report.machine.as_ref(), &report.poses, Moved::Turning),
            "No places of rotary joints are known.",
        ),
        (
            "Slides over the time",
            joint_chart::joints(report.machine.as_ref(), &report.poses, Moved::Sliding),
            "No places of slides are known.",
        ),
        ("Computing time", chart::stages(&report.stages), "No times are known."),
    ];
    out.push_str("<div class=\"charts\">");
    for (name, picture, otherwise) in figures {
        let body = picture.unwrap_or_else(|| format!("<p class=\"none\">{otherwise}</p>"));
        let _ = write!(out, "<section class=\"card\"><h2>{name}</h2>{body}</section>");
    }
    out.push_str("</div>\n");
}

fn findings(out: &mut String, report: &Report, notes: &[String]) {
    out.push_str("<section class=\"card\"><h2>Findings</h2>");
    if report.diagnostics.is_empty() && notes.is_empty() {
        out.push_str("<p class=\"none\">None.</p>");
    }
    out.push_str("<ul class=\"findings\">");
    // What was lost first, what is merely worth knowing last; among equals as they came.
    let mut sorted: Vec<_> = report.diagnostics.iter().collect();
    sorted.sort_by_key(|d| std::cmp::Reverse(d.severity));
    for d in sorted {
        let (class, word) = match d.severity {
            Severity::Note => ("note", "note"),
            Severity::Warning => ("warning", "warning"),
            Severity::Loss => ("loss", "lost"),
        };
        let place = if d.place.is_empty() { String::new() } else { format!("{}: ", d.place) };
        let _ = write!(
            out,
            "<li class=\"{class}\"><b>{word}</b><span>{}{}</span></li>",
            escape(&place),
            escape(&d.message)
        );
    }
    for note in notes {
        let _ = write!(out, "<li class=\"note\"><b>picture</b><span>{}</span></li>", escape(note));
    }
    out.push_str("</ul></section>\n");
}
