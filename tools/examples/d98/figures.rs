//! Figures 6 to 10 of D98.

use super::chart::{Map, Series, lines, map};
use super::{Done, deviation, eq18, paraboloid, stations};
use osculate_geom::Side;
use osculate_tools::flank::closed::MiddleRule;
use osculate_tools::flank::{RuledStrip, Setting, SideTool, place};
use std::fmt::Write;

const SETTINGS: [(&str, Setting); 4] = [
    ("standard (b)", Setting::Distributed),
    ("offset at 1/4", Setting::DoublePoint(0.25)),
    ("three tangencies", Setting::ThreeTangent),
    ("static minimax", Setting::Minimax),
];

/// delta along one rule in every setting.
fn along(strip: &RuledStrip<'_>, u: f64, radius_mm: f64, settings: &[(&str, Setting)]) -> Done<Vec<Series>> {
    settings
        .iter()
        .map(|(name, setting)| {
            let p = deviation(strip, u, radius_mm, *setting)?;
            let points = p.samples.iter().map(|s| [s.v, s.deviation_mm]).collect();
            Ok(Series { name: (*name).into(), points, dashed: false })
        })
        .collect()
}

/// Standard over three tangencies as a function of R; beyond the directrix dashed.
fn ratios(name: &str, m: MiddleRule) -> [Series; 2] {
    let point = |k: usize, on: bool| {
        let radius_mm = 0.5 * (k + 1) as f64;
        let m = MiddleRule { radius_mm, ..m };
        let ratio = m.three_tangent().map_or(f64::NAN, |t| {
            let inside = t.contact_mm <= 0.5 * m.height_mm;
            if inside == on { m.standard_depth_mm() / t.depth_mm } else { f64::NAN }
        });
        [radius_mm, ratio]
    };
    [true, false].map(|on| Series {
        name: if on { name.into() } else { String::new() },
        points: (0..160).map(|k| point(k, on)).collect(),
        dashed: !on,
    })
}

/// Drops dashed parts without a point, so that colours stay with the names.
fn kept(all: Vec<[Series; 2]>) -> Vec<Series> {
    all.into_iter()
        .map(|[on, off]| {
            let off_points = off.points.iter().any(|p| p[1].is_finite());
            if on.points.iter().all(|p| p[1].is_nan()) && off_points { off } else { on }
        })
        .collect()
}

/// The words on the figures, and the figures by file.
pub(crate) fn figures(text: &mut String) -> Done<Vec<(&'static str, String)>> {
    let mut files = Vec::new();
    writeln!(text, "\n## Figures\n")?;
    let mut save = |file: &'static str, svg: String, words: &str| -> Done<()> {
        writeln!(text, "{words}\n\n![{file}]({file})\n")?;
        files.push((file, svg));
        Ok(())
    };
    let e = eq18(Side::Along)?;
    let axes = ["v", "delta, mm"];
    save(
        "d98-6.svg",
        lines("Figure 6: surface (18), u = 0.4, R = 10", axes, &along(&e, 0.4, 10.0, &SETTINGS)?, false),
        "**Figure 6**, the error along a rule of any ruled surface: (18) with R = 10 at u = 0.4 (the paper's R = 40 is not possible, \
         see above).",
    )?;
    let m = MiddleRule { height_mm: 80.0, half_twist_rad: 30f64.to_radians(), radius_mm: 10.0 };
    let h = paraboloid(&m)?;
    save(
        "d98-7.svg",
        lines(
            "Figure 7: paraboloid, alpha = 30 deg, h_p = 80 mm, R = 10",
            axes,
            &along(&h, 0.5, 10.0, &SETTINGS)?,
            false,
        ),
        "**Figure 7**, the same on the paraboloid.",
    )?;
    save(
        "d98-7b.svg",
        lines("Figure 7, enlarged", axes, &along(&h, 0.5, 10.0, &SETTINGS[2..])?, false),
        "Three tangencies and the minimax alone: the former gouges by 0.0260 mm, the latter halves that.",
    )?;
    for (file, title, setting, scale) in [
        ("d98-8a.svg", "Figure 8: standard (b), surface (18), R = 10", Setting::Distributed, 6.0),
        ("d98-8b.svg", "Figure 8: three tangencies, surface (18), R = 10", Setting::ThreeTangent, 6.0),
    ] {
        let tool = SideTool::cylinder(10.0)?;
        let placed = place(&e, &stations(&e), 0.4, tool, setting)?;
        let m = Map { title, axes: ["u", "v"], x: [0.2, 0.6], y: [0.0, 1.0], scale };
        save(
            file,
            map(&m, |u, v| tool.deviation_mm(&placed.axis, &e.point_at(u, v))),
            if file.ends_with("a.svg") {
                "**Figure 8**, where the error is: the distance of every point around the rule u = 0.4 from the cutter that stands there; \
                 red is cut into. Along the rule it cuts both ends,"
            } else {
                "with three tangencies a little between the contacts:"
            },
        )?;
    }
    let heights = [20.0, 40.0, 80.0, 120.0, 160.0]
        .map(|height_mm| ratios(&format!("h_p = {height_mm} mm"), MiddleRule { height_mm, ..m }));
    save(
        "d98-9.svg",
        lines(
            "Figure 9: standard / three tangencies, alpha_0 = 30 deg",
            ["R, mm", "ratio"],
            &kept(heights.into()),
            true,
        ),
        "**Figure 9**, the ratio of the errors over R for several lengths of the rule. Lines end where a contact leaves the \
         directrix or there is no root.",
    )?;
    let angles = [5.0, 10.0, 15.0, 30.0, 45.0].map(|deg: f64| {
        ratios(&format!("alpha_0 = {deg} deg"), MiddleRule { half_twist_rad: deg.to_radians(), ..m })
    });
    save(
        "d98-10.svg",
        lines(
            "Figure 10: standard / three tangencies, h_p = 80 mm",
            ["R, mm", "ratio"],
            &kept(angles.into()),
            true,
        ),
        "**Figure 10**, the same for several twists. The lowest indicator is that of 45 degrees.",
    )?;
    let errors: Vec<Series> = [5.0, 10.0, 15.0, 30.0, 45.0]
        .into_iter()
        .map(|deg: f64| {
            let m = MiddleRule { half_twist_rad: deg.to_radians(), ..m };
            let point = |k: usize| {
                let m = MiddleRule { radius_mm: 0.5 * (k + 1) as f64, ..m };
                let t = m.three_tangent().filter(|t| t.contact_mm <= 0.5 * m.height_mm);
                [m.radius_mm, t.map_or(f64::NAN, |t| t.depth_mm)]
            };
            Series {
                name: format!("alpha_0 = {deg} deg"),
                points: (0..160).map(point).collect(),
                dashed: false,
            }
        })
        .collect();
    save(
        "d98-11.svg",
        lines("Gouge of three tangencies, h_p = 80 mm", ["R, mm", "mm"], &errors, true),
        "The error itself over R and twist:",
    )?;
    Ok(files)
}
