//! The `[tool]` table's keys, kind by kind: what each needs, what it may have, and what does not belong to it.

use crate::failure::Failure;
use crate::job::ToolTable;
use osculate_tools::CutterSpec;
use std::path::Path;

/// Length of a cutter that gives none, in diameters.
const DEFAULT_LENGTH: f64 = 5.0;

/// Kinds with the keys that each needs, and those that it may have; every kind may have length_mm.
pub const KINDS: [(&str, &[&str], &[&str]); 7] = [
    ("ball", &["diameter_mm"], &["corner_radius_mm"]),
    ("flat", &["diameter_mm"], &["corner_radius_mm"]),
    ("toroidal", &["diameter_mm", "corner_radius_mm"], &[]),
    ("cylindrical", &["diameter_mm"], &["corner_radius_mm"]),
    ("cone", &["diameter_mm", "taper_deg"], &["corner_radius_mm", "tip_diameter_mm"]),
    ("barrel", &["diameter_mm", "barrel_radius_mm", "corner_radius_mm"], &[]),
    ("apt", &["diameter_mm"], &["corner_radius_mm", "bottom_angle_deg", "side_angle_deg"]),
];

/// The cutter that a table describes.
pub fn spec(path: &Path, t: &ToolTable) -> Result<CutterSpec, Failure> {
    let failure = |text: String| Failure::file(path, format!("[tool] {text}"));
    let fail = |text: String| Err(failure(text));
    let kind = t.kind.as_str();
    let Some((_, needs, may)) = KINDS.iter().find(|k| k.0 == kind) else {
        let all = KINDS.map(|k| format!("\"{}\"", k.0)).join(", ");
        return fail(format!("kind = \"{kind}\" is not available: use one of {all}"));
    };
    let given = [
        ("corner_radius_mm", t.corner_radius_mm),
        ("taper_deg", t.taper_deg),
        ("tip_diameter_mm", t.tip_diameter_mm),
        ("barrel_radius_mm", t.barrel_radius_mm),
        ("bottom_angle_deg", t.bottom_angle_deg),
        ("side_angle_deg", t.side_angle_deg),
    ];
    for (key, value) in given {
        if value.is_none() && needs.contains(&key) {
            return fail(format!("kind = \"{kind}\" needs {key}"));
        }
        if value.is_some() && !needs.contains(&key) && !may.contains(&key) {
            return fail(format!("{key} does not go with kind = \"{kind}\": leave it out"));
        }
    }
    let diameter_mm = t.diameter_mm;
    let length_mm = t.length_mm.unwrap_or(DEFAULT_LENGTH * diameter_mm);
    let corner = t.corner_radius_mm.unwrap_or(0.0);
    let or_zero = |x: Option<f64>| x.unwrap_or(0.0);
    // A radius that the kind already says may be repeated, not contradicted.
    let fixed = |want: f64| match t.corner_radius_mm {
        Some(c) if (c - want).abs() > 1e-9 * diameter_mm => Err(failure(format!(
            "corner_radius_mm = {c} does not go with kind = \"{kind}\" of diameter {diameter_mm} mm: leave it out, \
             make it {want}, or use kind = \"toroidal\""
        ))),
        _ => Ok(()),
    };
    Ok(match kind {
        "ball" => {
            fixed(0.5 * diameter_mm)?;
            CutterSpec::Ball { diameter_mm, length_mm }
        }
        "flat" => {
            fixed(0.0)?;
            CutterSpec::Flat { diameter_mm, length_mm }
        }
        "cylindrical" => {
            fixed(0.0)?;
            CutterSpec::Cylindrical { diameter_mm, length_mm }
        }
        "toroidal" => CutterSpec::Toroidal { diameter_mm, corner_radius_mm: corner, length_mm },
        "cone" => CutterSpec::Cone {
            diameter_mm,
            taper_deg: or_zero(t.taper_deg),
            corner_radius_mm: corner,
            tip_diameter_mm: t.tip_diameter_mm,
            length_mm,
        },
        "barrel" => CutterSpec::Barrel {
            diameter_mm,
            barrel_radius_mm: or_zero(t.barrel_radius_mm),
            corner_radius_mm: corner,
            length_mm,
        },
        _ => CutterSpec::Apt {
            diameter_mm,
            corner_radius_mm: corner,
            bottom_angle_deg: or_zero(t.bottom_angle_deg),
            side_angle_deg: or_zero(t.side_angle_deg),
            length_mm,
        },
    })
}
