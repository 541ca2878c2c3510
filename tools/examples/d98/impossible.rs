//! Why the example of D98 with surface (18), u = 0.4 and R = 40 cannot be.

use super::{Done, eq18, stations};
use osculate_geom::{Side, Surface, uv};
use osculate_tools::flank::{RuledStrip, Setting, SideTool, place};
use std::fmt::Write;

/// Least radius of a hollow along the rule, over v: of the principal curvature, of the section across the rule.
fn hollows(s: &RuledStrip<'_>, u: f64) -> Done<[(f64, f64); 2]> {
    let rule = s.rule(u)?;
    let mut least = [(f64::INFINITY, 0.0); 2];
    for k in 0..=200 {
        let v = f64::from(k) / 200.0;
        let j = s.jet2(uv(u, v));
        let f = j.forms()?;
        let n = f.normal;
        let along = j.du.dot(&rule.frame.z);
        let across = (j.du - rule.frame.z * along).norm_squared();
        let section = -(j.duu.dot(&n) - 2.0 * along * j.duv.dot(&n) / rule.length_mm) / across;
        for (k, curvature) in [f.principal().k_min, section].into_iter().enumerate() {
            if curvature < 0.0 && -1.0 / curvature < least[k].0 {
                least[k] = (-1.0 / curvature, v);
            }
        }
    }
    Ok(least)
}

pub(crate) fn impossible(text: &mut String) -> Done<()> {
    writeln!(
        text,
        "## Surface (18) with R = 40\n\n\
         The paper prints 4.880 mm for the standard setting and 0.181 mm for its own, at u_p = 0.4 with R = 40. No cylinder of\n\
         40 mm fits there, on either side. Least radii of the hollow along the rule:\n\n\
         | side | principal | section across the rule | projected along the rule |\n|---|---:|---:|---:|"
    )?;
    for (name, side) in [("+", Side::Along), ("-", Side::Against)] {
        let s = eq18(side)?;
        let [principal, section] = hollows(&s, 0.4)?;
        writeln!(
            text,
            "| {name} | {:.3} mm at v = {:.3} | {:.3} mm at v = {:.3} | {:.3} mm |",
            principal.0,
            principal.1,
            section.0,
            section.1,
            s.rule(0.4)?.largest_fit_mm()
        )?;
    }
    writeln!(
        text,
        "\nWhat R = 40 does, static:\n\n| side | setting | lowest, mm | highest, mm |\n|---|---|---:|---:|"
    )?;
    let tool = SideTool::cylinder(40.0)?;
    let settings = [
        ("standard (a) at C0", Setting::AtDirectrix(0)),
        ("standard (a) at C1", Setting::AtDirectrix(1)),
        ("standard (b)", Setting::Distributed),
        ("three tangencies", Setting::ThreeTangent),
        ("static minimax", Setting::Minimax),
    ];
    for (sign, side) in [("+", Side::Along), ("-", Side::Against)] {
        let s = eq18(side)?;
        let st = stations(&s);
        for (name, setting) in settings {
            match place(&s, &st, 0.4, tool, setting) {
                Ok(placed) => {
                    let p = placed.profile(&s, &st, &tool, 65);
                    let (a, b) = (p.lowest.deviation_mm, p.highest.deviation_mm);
                    writeln!(text, "| {sign} | {name} | {a:.3} | {b:.3} |")?;
                }
                Err(why) => writeln!(text, "| {sign} | {name} | {why} | |")?,
            }
        }
    }
    let near = nearest()?;
    writeln!(
        text,
        "\nNor is it another rule: over both sides and u from 0.02 to 0.98 with R = 40, the pair of errors nearest to 4.880 and\n\
         0.181 is {:.3} and {:.3} mm, at u = {:.2} on side {}.\n\n\
         The two numbers alone name no case: u and R together can be chosen to meet both. On (18) they are met at",
        near.errors[0], near.errors[1], near.u, near.sign
    )?;
    for (sign, side, start) in [("+", Side::Along, [0.915, 24.7]), ("-", Side::Against, [0.805, 23.8])] {
        match meet(side, start)? {
            Some([u, r]) => {
                let errors = errors(side, u, r)?.unwrap_or([f64::NAN; 2]);
                let fit = eq18(side)?.rule(u)?.largest_fit_mm();
                writeln!(
                    text,
                    "u = {u:.4}, R = {r:.3} mm (side {sign}: {:.3} and {:.3} mm, the hollow there takes {fit:.1} mm){}",
                    errors[0],
                    errors[1],
                    if sign == "+" { " and" } else { "." }
                )?;
            }
            None => writeln!(text, "no place on side {sign};")?,
        }
    }
    writeln!(text)?;
    Ok(())
}

/// Greatest static errors of the standard setting and of three tangencies.
fn errors(side: Side, u: f64, radius_mm: f64) -> Done<Option<[f64; 2]>> {
    let s = eq18(side)?;
    let (st, tool) = (stations(&s), SideTool::cylinder(radius_mm)?);
    let error =
        |setting| place(&s, &st, u, tool, setting).ok().map(|p| p.profile(&s, &st, &tool, 33).max_abs_mm());
    Ok(error(Setting::Distributed).zip(error(Setting::ThreeTangent)).map(|(a, b)| [a, b]))
}

const PRINTED: [f64; 2] = [4.880, 0.181];

struct Near {
    errors: [f64; 2],
    u: f64,
    sign: &'static str,
    off: f64,
}

/// The rule at which R = 40 comes nearest to the printed pair, by the greater of both relative differences.
fn nearest() -> Done<Near> {
    let mut best = Near { errors: [f64::NAN; 2], u: f64::NAN, sign: "", off: f64::INFINITY };
    for (sign, side) in [("+", Side::Along), ("-", Side::Against)] {
        for i in 0..97 {
            let u = 0.02 + 0.01 * f64::from(i);
            let Some(found) = errors(side, u, 40.0)? else { continue };
            let off = (0..2).map(|k| (found[k] / PRINTED[k] - 1.0).abs()).fold(0.0, f64::max);
            if off < best.off {
                best = Near { errors: found, u, sign, off };
            }
        }
    }
    Ok(best)
}

/// u and R at which both errors are as printed, by Newton's method with differences.
fn meet(side: Side, start: [f64; 2]) -> Done<Option<[f64; 2]>> {
    let [mut u, mut r] = start;
    for _ in 0..30 {
        let at = |u: f64, r: f64| errors(side, u, r);
        let (Some(e), Some(eu), Some(er)) = (at(u, r)?, at(u + 1e-6, r)?, at(u, r + 1e-5)?) else {
            return Ok(None);
        };
        let f = [e[0] - PRINTED[0], e[1] - PRINTED[1]];
        if f[0].abs().max(f[1].abs()) < 1e-7 {
            return Ok(Some([u, r]));
        }
        let j = nalgebra::Matrix2::new(
            (eu[0] - e[0]) / 1e-6,
            (er[0] - e[0]) / 1e-5,
            (eu[1] - e[1]) / 1e-6,
            (er[1] - e[1]) / 1e-5,
        );
        let Some(step) = j.lu().solve(&nalgebra::Vector2::new(f[0], f[1])) else { return Ok(None) };
        (u, r) = (u - step[0], r - step[1]);
        if !(u > 0.0 && u < 1.0 && r > 0.0) {
            return Ok(None);
        }
    }
    Ok(None)
}
