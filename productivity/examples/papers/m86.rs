//! The page of M86.

use super::forms::{Row, table};
use super::plot::{Curve, logarithmic};
use osculate_geom::analytic::Torus;
use osculate_geom::{Axis, Flipped, uv};
use osculate_productivity::closed_form::{five_axis_flat, three_axis_flat, two_axis_ball};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};

/// Radius of the tool, tube and the groove's circle, mm.
const TOOL: f64 = 10.0;
const TUBE: f64 = 60.0;
const CIRCLE: f64 = 140.0;

const EQUATIONS: [[&str; 3]; 5] = [
    [
        "2CL: 2 sqrt(2 h R)",
        "`closed_form::two_axis_ball`",
        "R set to one; holds where the part is straight across the feed",
    ],
    [
        "3C: 2 sqrt(2 h R / (sin alpha + k_y R))",
        "`closed_form::three_axis_flat`; with a corner `three_axis_toroidal`",
        "kappa_y = -k_y",
    ],
    [
        "3C: undercut",
        "`closed_form::contour_per_mm` below -1/R, `DomainError::DoesNotFit`",
        "printed 'curvature smaller than 1/r': it is the radius of curvature that must not be smaller than r",
    ],
    [
        "5C: 2 R sqrt(4 s - 4 s^2), s = sqrt(2 (h/R) / (D R))",
        "`closed_form::five_axis_flat`, with its lead",
        "printed with the second term inside the inner root, which is never real",
    ],
    [
        "lines to machine along",
        "2CL contour lines, 3C gradient lines, 5C lines of the more convex curvature: `osculate lines`",
        "",
    ],
];

/// Exact width between the outer zeros where the tool dips by h, for a flat end.
fn exact_five(h: f64) -> Option<(f64, f64)> {
    let groove = Flipped(Torus::new(CIRCLE + TUBE, TUBE).ok()?);
    let cutter = Cutter::try_from(CutterSpec::Flat { diameter_mm: 2.0 * TOOL, length_mm: 100.0 }).ok()?;
    let start = five_axis_flat(TOOL, 0.0, 1.0 / CIRCLE, -1.0 / TUBE, h).ok()?.lead_rad;
    let with = |lead_rad: f64| {
        let at = uv(0.0, std::f64::consts::PI);
        Contact::new(&groove, at, &cutter, FeedLine::Iso(Axis::U), Lean { lead_rad, tilt_rad: 0.0 }).ok()
    };
    let dip = |lead: f64| Some(strip::exact(&with(lead)?, 1e-9).ok()?.undercut_mm / h - 1.0);
    let (mut a, mut b) = (0.97 * start, start);
    let (mut fa, mut fb) = (dip(a)?, dip(b)?);
    for _ in 0..12 {
        if fb.abs() < 1e-10 || fb == fa {
            break;
        }
        let next = b - fb * (b - a) / (fb - fa);
        (a, fa) = (b, fb);
        (b, fb) = (next, dip(next)?);
    }
    Some((strip::exact(&with(b)?, 1e-12).ok()?.width_mm, b))
}

pub fn page(rows: &[Row]) -> Vec<(String, String)> {
    let own: Vec<Row> = rows
        .iter()
        .filter(|r| r.source.starts_with("M86"))
        .map(|r| Row { worst: r.worst.clone(), ..*r })
        .collect();
    let mut text = String::from(
        "# M86: curvature and contour lines in sculptured surface machining\n\n\
         Made by `cargo xtask papers m86`. The formulas of K. Marciniak and J. Wojciechowski for machines of two and a half, three and\n\
         five axes, with the tool's radius R kept and curvature positive where the body is convex.\n\n\
         ## Equations\n\n| formula | here | remark |\n|---|---|---|\n",
    );
    for [a, b, c] in EQUATIONS {
        text += &format!("| {a} | {b} | {c} |\n");
    }
    text += "\n## Against the exact strip\n\n";
    text += &table(&own);
    text += "\nWhere the deviation is largest, at h/R = 1e-3:\n\n";
    for r in &own {
        text += &format!("- {}: {:.1e}, {}\n", r.name, r.worst[1].0, r.worst[1].1);
    }
    text += &format!(
        "\n## Two contacts in a groove\n\nA flat end of R = {TOOL} mm in a groove of profile radius {TUBE} mm, {CIRCLE} mm from its axis, fed along the \
         groove. Exact: the width between the outer\nzeros of the standoff at the lead where the tool dips by just h; lifted by h it stays within [0, h].\n\n\
         | h, mm | 5C formula, mm | exact, mm | off, % | lead by formula, deg | exact, deg | ball of the same radius, mm |\n|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    let mut dots = Vec::new();
    for h in [1e-5, 1e-4, 1e-3, 1e-2, 5e-2] {
        let (Ok(five), Some((width, lead))) =
            (five_axis_flat(TOOL, 0.0, 1.0 / CIRCLE, -1.0 / TUBE, h), exact_five(h))
        else {
            continue;
        };
        let ball = two_axis_ball(TOOL, h).unwrap_or(f64::NAN);
        dots.push([h, width]);
        text += &format!(
            "| {h:.0e} | {:.5} | {width:.5} | {:+.2} | {:.4} | {:.4} | {ball:.5} |\n",
            five.width_mm,
            100.0 * (five.width_mm / width - 1.0),
            five.lead_rad.to_degrees(),
            lead.to_degrees()
        );
    }
    text += "\n![Widths by tolerance](m86-width.svg)\n";
    let heights: Vec<f64> = (0..=40).map(|k| 10f64.powf(-5.0 + 3.7 * f64::from(k) / 40.0)).collect();
    let curve = |name: &str, f: &dyn Fn(f64) -> f64| Curve {
        name: name.to_owned(),
        points: heights.iter().map(|h| [*h, f(*h)]).filter(|p| p[1].is_finite()).collect(),
        dots: false,
    };
    let curves = [
        curve("5C, two contacts", &|h| {
            five_axis_flat(TOOL, 0.0, 1.0 / CIRCLE, -1.0 / TUBE, h).map_or(f64::NAN, |f| f.width_mm)
        }),
        Curve { name: "exact".into(), points: dots, dots: true },
        curve("3C, lead 20 deg", &|h| {
            three_axis_flat(TOOL, 20f64.to_radians(), -1.0 / TUBE, h).unwrap_or(f64::NAN)
        }),
        curve("2CL, ball", &|h| two_axis_ball(TOOL, h).unwrap_or(f64::NAN)),
    ];
    vec![
        ("m86.md".into(), text),
        (
            "m86-width.svg".into(),
            logarithmic("M86: strip width in a groove, R = 10 mm", ["h, mm", "width, mm"], &curves),
        ),
    ]
}
