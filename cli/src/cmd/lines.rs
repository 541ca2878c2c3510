//! `lines`: the characteristic lines of a face as figures and JSON.

use crate::args::LinesArgs;
use crate::failure::{Done, Failure, Outcome};
use crate::figure::{self, Panel, Study, Wanted, json, sheet};
use crate::render::{self, number};
use crate::report::project::Direction;
use crate::{output, part};
use osculate_geom::{Unit3, Vec3};
use osculate_surfaces::lines::{CriticalKind, UmbilicKind};

/// Most levels that a figure can tell apart.
const MOST_LEVELS: usize = 200;

/// Runs the verb.
pub fn run(args: &LinesArgs, json_wanted: bool) -> Outcome {
    let wanted = wanted(args)?;
    let loaded = part::whole(part::load(&args.part)?)?;
    let face = loaded.one(args.face.as_deref())?;
    let study = Study::of(&face.surface, face.nurbs(), &wanted)
        .map_err(|e| Failure::job(format!("{}: {e}", face.id)))?;
    let name = match (&args.part.part, face.name.is_empty()) {
        (None, _) => face.kind.clone(),
        (Some(_), true) => face.id.clone(),
        (Some(_), false) => format!("{} {}", face.id, face.name),
    };
    let from = args.view_deg.map(|[azimuth_deg, elevation_deg]| Direction { azimuth_deg, elevation_deg });
    let scene = sheet::scene(&study, from);
    let mut answer = json::answer(&study, &face.id);
    let mut files = vec![("figures.svg".to_owned(), figure::page(&study, &scene, &name))];
    for panel in Panel::ALL.into_iter().filter(|p| p.applies(&study)) {
        files.push((format!("{}.svg", panel.file()), figure::single(&study, &scene, panel, &name)));
    }
    answer.files = files.iter().map(|(f, _)| f.clone()).chain(["lines.json".to_owned()]).collect();
    for (file, text) in &files {
        output::write(&args.out.join(file), text.as_bytes())?;
    }
    let text = serde_json::to_string(&answer).map_err(Failure::job)?;
    output::write(&args.out.join("lines.json"), text.as_bytes())?;
    if json_wanted {
        render::text(&(text + "\n"));
    } else {
        render::text(&describe(&study, &name, &answer.files, args));
    }
    Ok(Done::Yes)
}

/// The arguments, checked.
fn wanted(args: &LinesArgs) -> Result<Wanted, Failure> {
    let [x, y, z] = args.axis;
    let axis = Unit3::try_new(Vec3::new(x, y, z), 0.0)
        .ok_or_else(|| Failure::Usage(format!("--axis {x},{y},{z} has no direction")))?;
    if let Some(s) = args.spacing_mm
        && !(s > 0.0 && s.is_finite())
    {
        return Err(Failure::Usage(format!("--spacing-mm {s} must be positive and finite")));
    }
    if args.levels == 0 || args.levels > MOST_LEVELS {
        return Err(Failure::Usage(format!("--levels {} must be 1 to {MOST_LEVELS}", args.levels)));
    }
    Ok(Wanted { axis, spacing_mm: args.spacing_mm, levels: args.levels })
}

fn describe(study: &Study, name: &str, files: &[String], args: &LinesArgs) -> String {
    let mut out = format!("\n  {name}, {} mm across\n\n", number(study.size_mm, 4));
    let u = &study.umbilics;
    let count = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
    out.push_str(&format!("  {}", count(u.inside().count(), "umbilic", "umbilics")));
    if !u.regions.is_empty() {
        out.push_str(", and regions that consist of umbilics");
    }
    if !u.lines.is_empty() {
        out.push_str(&format!(", and {} of umbilics", count(u.lines.len(), "line", "lines")));
    }
    out.push_str(if u.confirmed() {
        "; the sum of their indices agrees with the turn of the lines along the border\n"
    } else {
        "\n"
    });
    for p in u.inside() {
        let kind = match p.kind {
            UmbilicKind::Lemon => "lemon",
            UmbilicKind::Monstar => "monstar",
            UmbilicKind::Star => "star",
            UmbilicKind::Degenerate => "degenerate",
        };
        let index = p.index_twice.map_or_else(|| "?".to_owned(), |i| format!("{:+}", 0.5 * f64::from(i)));
        let c = p.point;
        out.push_str(&format!(
            "    {kind}, index {index}, at {} {} {} mm, k = {} 1/mm\n",
            number(c.x, 7),
            number(c.y, 7),
            number(c.z, 7),
            number(p.curvature_per_mm, 6)
        ));
    }
    let a = study.axis;
    let c = &study.heights.critical;
    let of = |k| c.inside(k).count();
    out.push_str(&format!(
        "  contours along {} {} {}: {}, {}, {}\n",
        number(a.x, 4),
        number(a.y, 4),
        number(a.z, 4),
        count(of(CriticalKind::Minimum), "minimum", "minima"),
        count(of(CriticalKind::Maximum), "maximum", "maxima"),
        count(of(CriticalKind::Saddle), "saddle", "saddles"),
    ));
    out.push_str(&format!("  searched in cells of at most {} mm\n", number(study.resolution_mm, 3)));
    out.push_str(&format!("\n  {}: {}\n\n", args.out.display(), files.join(", ")));
    out
}
