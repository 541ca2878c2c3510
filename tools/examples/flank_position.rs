//! Positions of a cutter at one rule of a surface of D98's families, any sizes.
//!
//! ```text
//! flank_position liu LINE_MM BEND_PER_MM HEIGHT_MM END_MM U RADIUS_MM [SIDE]
//! flank_position paraboloid HEIGHT_MM HALF_TWIST_DEG EXTENT_MM U RADIUS_MM [SIDE]
//! flank_position eq18 U RADIUS_MM [SIDE]
//! ```
//!
//! SIDE is + (that of N0 + N1, the default) or -. The surface goes on beyond its ends by a third of its length.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use osculate_geom::Side;
use osculate_surfaces::gallery::{
    FormulaCurve, LiuSize, ParaboloidSize, eq18_directrices, liu_directrices, paraboloid_directrices,
};
use osculate_tools::flank::{
    RuledStrip, Setting, SideTool, Stations, balanced_fraction, place, three_tangent,
};
use std::error::Error;
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match run(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("flank_position: {why}");
            ExitCode::FAILURE
        }
    }
}

/// The directrices of a family with these sizes.
fn family(name: &str, sizes: &[f64]) -> Result<[FormulaCurve; 2], Box<dyn Error>> {
    match (name, sizes) {
        ("liu", &[line_mm, bend_per_mm, height_mm, end_mm]) => {
            Ok(liu_directrices(LiuSize { line_mm, bend_per_mm, height_mm, end_mm }))
        }
        ("paraboloid", &[height_mm, half_twist_deg, extent_mm]) => {
            let half_twist_rad = half_twist_deg.to_radians();
            Ok(paraboloid_directrices(ParaboloidSize { height_mm, half_twist_rad, extent_mm })?)
        }
        ("eq18", []) => Ok(eq18_directrices()),
        _ => Err("a family with its sizes: `liu` with 4, `paraboloid` with 3 or `eq18` with none, then U and RADIUS_MM".into()),
    }
}

fn run(words: &[String]) -> Result<(), Box<dyn Error>> {
    let (name, rest) = words.split_first().ok_or("the family is missing: liu, paraboloid or eq18")?;
    let (side, rest) = match rest.split_last() {
        Some((s, rest)) if s == "-" => (Side::Against, rest),
        Some((s, rest)) if s == "+" => (Side::Along, rest),
        _ => (Side::Along, rest),
    };
    let numbers: Vec<f64> = rest
        .iter()
        .map(|w| w.parse::<f64>().map_err(|_| format!("{w} is no number")))
        .collect::<Result<_, _>>()?;
    let Some((sizes, &[u, radius_mm])) = numbers.split_last_chunk::<2>() else {
        return Err("U and RADIUS_MM are missing".into());
    };
    let [a, b] = family(name, sizes)?;
    let strip = RuledStrip::new(a, b, side, 1e-6)?;
    let (tool, stations) = (SideTool::cylinder(radius_mm)?, Stations::beyond(&strip, 64, 0.34));
    let rule = strip.rule(u)?;
    println!("rule: length {:.12} mm, twist {:.10} deg", rule.length_mm, rule.twist_rad().to_degrees());
    println!("largest cylinder along the rule that fits its hollow: {:.6} mm", rule.largest_fit_mm());
    match three_tangent(&strip, u, tool) {
        Ok(root) => println!(
            "three tangencies: u0 {:.12}, u1 {:.12}, h0 {:.10} mm, gamma {:.11} deg, residual {:.1e} mm, {} steps",
            root.contacts[0],
            root.contacts[1],
            root.height_mm,
            root.turn_rad.to_degrees(),
            root.residual_mm,
            root.iterations
        ),
        Err(why) => println!("three tangencies: {why}"),
    }
    let mut settings = vec![
        ("standard (a) at C0", Setting::AtDirectrix(0)),
        ("standard (a) at C1", Setting::AtDirectrix(1)),
        ("standard (b)", Setting::Distributed),
        ("double point offset 1/4", Setting::DoublePoint(0.25)),
    ];
    match balanced_fraction(&rule, tool) {
        Ok(t) => {
            let placed = place(&strip, &stations, u, tool, Setting::DoublePoint(t))?;
            let on_rule = tool
                .deviation_mm(&placed.axis, &rule.point(0.0))
                .max(tool.deviation_mm(&placed.axis, &rule.point(1.0)));
            println!("double point offset balanced on the rule: fraction {t:.9}, +-{on_rule:.9} mm");
            settings.push(("double point, balanced", Setting::DoublePoint(t)));
        }
        Err(why) => println!("double point offset balanced on the rule: {why}"),
    }
    settings.extend([("three tangencies", Setting::ThreeTangent), ("static minimax", Setting::Minimax)]);
    println!("{:<24} {:>18} {:>18}  verdict within 0.01 mm", "static deviation, mm", "lowest", "highest");
    for (name, setting) in settings {
        match place(&strip, &stations, u, tool, setting) {
            Ok(placed) => {
                let p = placed.profile(&strip, &stations, &tool, 65);
                let verdict = placed.verdict(&strip, &tool, &p, 0.01)?;
                println!(
                    "{name:<24} {:>18.12} {:>18.12}  {verdict:?}",
                    p.lowest.deviation_mm, p.highest.deviation_mm
                );
            }
            Err(why) => println!("{name:<24} {why}"),
        }
    }
    Ok(())
}
