//! Tools as TOML of ours.

use crate::job::{Tool, raw};
use osculate_tools::{CutterSpec, HolderSpec};
use std::fmt::Write;

/// Lengths are written to a nanometre, so that inches come back.
const DIGITS: f64 = 1e6;

/// The keys of a cutter beside its kind, in the order of a job.
fn keys(spec: &CutterSpec) -> Vec<(&'static str, f64)> {
    match *spec {
        CutterSpec::Ball { diameter_mm, length_mm }
        | CutterSpec::Flat { diameter_mm, length_mm }
        | CutterSpec::Cylindrical { diameter_mm, length_mm } => {
            vec![("diameter_mm", diameter_mm), ("length_mm", length_mm)]
        }
        CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm } => vec![
            ("diameter_mm", diameter_mm),
            ("corner_radius_mm", corner_radius_mm),
            ("length_mm", length_mm),
        ],
        CutterSpec::Cone { diameter_mm, taper_deg, corner_radius_mm, tip_diameter_mm, length_mm } => {
            let mut all = vec![
                ("diameter_mm", diameter_mm),
                ("taper_deg", taper_deg),
                ("corner_radius_mm", corner_radius_mm),
            ];
            all.extend(tip_diameter_mm.map(|d| ("tip_diameter_mm", d)));
            all.push(("length_mm", length_mm));
            all
        }
        CutterSpec::Barrel { diameter_mm, barrel_radius_mm, corner_radius_mm, length_mm } => vec![
            ("diameter_mm", diameter_mm),
            ("barrel_radius_mm", barrel_radius_mm),
            ("corner_radius_mm", corner_radius_mm),
            ("length_mm", length_mm),
        ],
        CutterSpec::Apt { diameter_mm, corner_radius_mm, bottom_angle_deg, side_angle_deg, length_mm } => {
            vec![
                ("diameter_mm", diameter_mm),
                ("corner_radius_mm", corner_radius_mm),
                ("bottom_angle_deg", bottom_angle_deg),
                ("side_angle_deg", side_angle_deg),
                ("length_mm", length_mm),
            ]
        }
    }
}

/// A number with the digits that it has.
fn plain(x: f64) -> String {
    // Divided by a whole number, so that decimals are the nearest ones.
    format!("{}", (x * DIGITS).round() / DIGITS)
}

/// Spindle and feed, key by key.
fn cutting(c: &raw::Cutting) -> Vec<String> {
    let numbers = [
        ("spindle_rpm", c.spindle_rpm),
        ("feed_mm_min", c.feed_mm_min),
        ("air_feed_mm_min", c.air_feed_mm_min),
        ("feed_per_tooth_mm", c.feed_per_tooth_mm),
    ];
    let mut out: Vec<String> =
        numbers.iter().filter_map(|(key, x)| x.map(|x| format!("{key} = {}", plain(x)))).collect();
    out.extend(c.coolant.map(|w| format!("coolant = \"{}\"", w.word())));
    out
}

fn section(s: &HolderSpec) -> String {
    let upper =
        s.upper_diameter_mm.map_or_else(String::new, |d| format!(", upper_diameter_mm = {}", plain(d)));
    format!("{{ diameter_mm = {}{upper}, length_mm = {} }}", plain(s.diameter_mm), plain(s.length_mm))
}

/// A text as TOML.
fn text(s: &str) -> String {
    ::toml::Value::from(s).to_string()
}

/// A tool as a `[[tool]]` table, with its number or another one.
#[must_use]
pub fn toml(tool: &Tool, number: u32) -> String {
    let mut out = format!(
        "[[tool]]\nnumber = {number}\nname = {}\nkind = \"{}\"\n",
        text(tool.words()),
        tool.kind().word()
    );
    for (key, value) in keys(&tool.spec()) {
        let _ = writeln!(out, "{key} = {}", plain(value));
    }
    if tool.flutes().1.is_some() {
        let _ = writeln!(out, "flute_length_mm = {}", plain(tool.flutes().0.length_mm()));
    }
    if let Some(teeth) = tool.teeth() {
        let _ = writeln!(out, "teeth = {teeth}");
    }
    if tool.plunges() {
        out += "plunges = true\n";
    }
    match tool.holder_sections() {
        [] => {}
        [one] => {
            let _ = writeln!(out, "holder = {}", section(one));
        }
        all => {
            let all: Vec<String> = all.iter().map(section).collect();
            let _ = writeln!(out, "holder = [{}]", all.join(", "));
        }
    }
    let cutting = cutting(tool.feeding());
    if !cutting.is_empty() {
        let _ = writeln!(out, "cutting = {{ {} }}", cutting.join(", "));
    }
    out
}
