//! The viewer's part of the page: buttons, canvas, legends, and the still picture under it.
//!
//! `assets/viewer.js` finds these elements by their ids and fills them with life; without it the still picture stays.

use super::data::{PathPoints, Report, Scalar};
use super::legend::{Limits, Scale};
use super::mesh::Clean;
use super::picture::{View, svg_of};
use super::project::Direction;
use super::text::escape;
use std::fmt::Write;

/// Height of the viewer's legend bars, px.
pub const LEGEND_PX: f64 = 190.0;

/// The colour scales of a page.
#[non_exhaustive]
pub struct Scales {
    /// Of the deviation.
    pub deviation: Scale,
    /// Of the strip width; `None` where none is known.
    pub width: Option<Scale>,
    /// One for each of the report's scalars; `None` where no value is known.
    pub scalars: Vec<Option<Scale>>,
}

impl Scales {
    /// The scales that `report` needs.
    pub fn new(report: &Report, faces: &[Clean], limits: Limits) -> Self {
        let deviations = faces.iter().flat_map(|f| &f.deviation_mm).map(|d| f64::from(d.abs()));
        let reach = deviations.filter(|d| d.is_finite()).fold(0.0, f64::max);
        let widths = report.passes.iter().flat_map(|p| &p.widths_mm).map(|w| f64::from(*w));
        let scalar = |(i, s): (usize, &Scalar)| {
            let values = faces.iter().flat_map(|f| f.scalars.get(i).into_iter().flatten());
            Scale::sequential(&s.name, &s.unit, values.map(|v| f64::from(*v)))
        };
        Self {
            deviation: Scale::deviation(limits, reach),
            width: Scale::sequential("Strip width", "mm", widths),
            scalars: report.scalars.iter().enumerate().map(scalar).collect(),
        }
    }
}

/// Writes the section; the still picture is seen from where the view opens.
pub fn viewer(out: &mut String, report: &Report, faces: &[Clean], (scales, opening): (&Scales, Direction)) {
    let mut part = vec![("deviation".to_owned(), "Deviation".to_owned()), ("plain".into(), "Plain".into())];
    if report.faces_only {
        part.remove(0);
    }
    let shown = scales.scalars.iter().enumerate();
    part.extend(shown.filter_map(|(i, s)| Some((i.to_string(), escape(&s.as_ref()?.name)))));
    let mut path = vec![("off".to_owned(), "Off".to_owned()), ("plain".into(), "Lines".into())];
    if scales.width.is_some() {
        path.push(("width".into(), "Strip width".into()));
    }
    let which = match report.path_points {
        PathPoints::Contact => "contact points",
        PathPoints::Tip => "tool tip",
    };
    out.push_str("<section class=\"card viewer\"><div class=\"bar needs-live\">");
    // Of faces alone the first map is what tells them apart.
    let first = if !report.faces_only {
        "deviation"
    } else if report.scalars.is_empty() {
        "plain"
    } else {
        "0"
    };
    segment(out, ["part", "Part", ""], &part, first);
    if report.passes.iter().any(|p| p.points_mm.len() > 1) {
        segment(out, ["path", "Path", which], &path, "plain");
    } else {
        segment(out, ["path", "Path", which], &path[..1], "off");
    }
    let has_tool = !report.tools.is_empty() && !report.poses.is_empty();
    let has_bodies = report.machine.as_ref().is_some_and(|m| !m.bodies.is_empty());
    let checks = [
        ("show-links", "Links", false, !report.links.is_empty()),
        ("show-tool", "Tool", has_tool, has_tool),
        ("show-machine", "Machine", false, has_bodies && !report.poses.is_empty()),
        ("show-borders", "Borders", true, !faces.is_empty()),
        ("so-far", "Path so far", false, !report.poses.is_empty()),
    ];
    for (id, name, on, enabled) in checks {
        let _ = write!(
            out,
            "<label class=\"check\"{}><input type=\"checkbox\" id=\"{id}\"{}>{name}</label>",
            if enabled { "" } else { " hidden" },
            if on { " checked" } else { "" }
        );
    }
    out.push_str("</div><div id=\"canvas-box\"><div id=\"still\">");
    out.push_str(&svg_of(report, faces, &View { direction: Some(opening), ..View::default() }));
    out.push_str(
        "<p id=\"still-words\">Still picture. The view that turns needs a browser with scripts and WebGL.</p></div>\
         <svg id=\"triad\" class=\"needs-live\" viewBox=\"-38 -38 76 76\" aria-hidden=\"true\">",
    );
    for axis in ["x", "y", "z"] {
        let _ = write!(out, "<path id=\"axis-{axis}\"/><text id=\"axis-{axis}-label\">{axis}</text>");
    }
    out.push_str("</svg><div id=\"scale-bar\" class=\"needs-live\"></div><div class=\"legends needs-live\">");
    legend(out, &scales.deviation, "data-part-legend=\"deviation\"", true);
    for (i, scale) in scales.scalars.iter().enumerate() {
        if let Some(scale) = scale {
            legend(out, scale, &format!("data-part-legend=\"{i}\" hidden"), true);
        }
    }
    if let Some(scale) = &scales.width {
        legend(out, scale, "data-path-legend hidden", false);
    }
    out.push_str("</div>");
    out.push_str("<span class=\"segment views needs-live\">");
    for (view, name) in
        [("iso", "Iso"), ("top", "Top"), ("front", "Front"), ("right", "Side"), ("fit", "Fit")]
    {
        let _ = write!(out, "<button type=\"button\" data-view=\"{view}\">{name}</button>");
    }
    let _ = writeln!(
        out,
        "</span><div id=\"hover\" hidden></div></div><div class=\"bar below needs-live\"{}><button type=\"button\" \
         id=\"play\">Play</button><input type=\"range\" id=\"pose\" min=\"0\" max=\"0\" value=\"0\" aria-label=\"Tool position along \
         the path\"><span id=\"pose-words\"></span></div></section>",
        if report.poses.is_empty() { " hidden" } else { "" }
    );
}

/// Buttons of which one is down: the group's key, name and explanation, then the choices' keys and names.
fn segment(out: &mut String, [group, name, title]: [&str; 3], choices: &[(String, String)], chosen: &str) {
    let _ = write!(out, "<span class=\"segment\" role=\"radiogroup\" title=\"{title}\"><span>{name}</span>");
    for (value, label) in choices {
        let checked = if value == chosen { " checked" } else { "" };
        let _ = write!(
            out,
            "<input type=\"radio\" name=\"{group}\" id=\"{group}-{value}\" value=\"{value}\"{checked}><label \
             for=\"{group}-{value}\">{label}</label>"
        );
    }
    out.push_str("</span>");
}

fn legend(out: &mut String, scale: &Scale, attributes: &str, with_unknown: bool) {
    let unit = if scale.unit.is_empty() { String::new() } else { format!(", {}", scale.unit) };
    let _ = write!(
        out,
        "<div class=\"legend\" {attributes}><strong>{}{}</strong><svg width=\"78\" height=\"{height}\" viewBox=\"-7 -7 85 {height}\">{}",
        escape(&scale.name),
        escape(&unit),
        scale.bar(LEGEND_PX),
        height = LEGEND_PX + 14.0
    );
    out.push_str(
        "<path class=\"needle\" style=\"display:none\" d=\"M-7 -5L0 0L-7 5zM0 -1h14v2H0z\" fill=\"currentColor\"/></svg>",
    );
    if with_unknown {
        out.push_str("<div class=\"grey\"><i></i>not known</div>");
    }
    out.push_str("</div>");
}
