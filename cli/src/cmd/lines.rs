//! `lines`: the characteristic lines of a face as figures and JSON.

use crate::screen::args::{LinesArgs, PostureArgs};
use crate::screen::{cancel, output, render};
use osculate::failure::{Done, Failure, Outcome};
use osculate::figure::fixed_axis::FixedAxis;
use osculate::figure::postures::Postures;
use osculate::figure::{self, Panel, Study, Wanted, json, sheet};
use osculate::part;
use osculate::report::project::Direction;
use osculate::words::{minima, number};
use osculate_geom::{Unit3, Vec3};
use osculate_productivity::optimum::{Limits, Range};
use osculate_productivity::rate::Caps;
use osculate_surfaces::lines::{CriticalKind, Turn, UmbilicKind};
use osculate_tools::{Cutter, CutterSpec};

/// Most levels that a figure can tell apart.
const MOST_LEVELS: usize = 200;
/// Most nodes of postures along a parameter.
const MOST_NODES: usize = 200;

/// Runs the verb.
pub fn run(args: &LinesArgs, json_wanted: bool) -> Outcome {
    output::folder(&args.out)?;
    let wanted = wanted(args)?;
    let tool = args.postures.tool.as_deref().map(|keys| limits(keys, &args.postures)).transpose()?;
    let loaded = part::whole(args.part.load()?)?;
    if let Some(path) = &args.part.part {
        loaded.to_plan(path)?;
    }
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
    let turn = study.turned().map_err(|e| Failure::job(format!("{}: {e}", face.id)))?;
    let mut answer = json::answer(&study, &turn, &face.id);
    let mut stands = Vec::new();
    let mut files = vec![("figures.svg".to_owned(), figure::page(&study, &scene, &name))];
    for panel in Panel::ALL.into_iter().filter(|p| p.applies(&study)) {
        files.push((format!("{}.svg", panel.file()), figure::single(&study, &scene, panel, &name)));
    }
    if let Some((cutter, limits)) = &tool {
        let postures = Postures::of(&face.surface, cutter, limits, args.postures.nodes)
            .map_err(|e| Failure::job(format!("{}: {e}", face.id)))?;
        let beside = sheet::beside_bar(&study, from);
        files.push(("h-postures.svg".to_owned(), postures.page(&study, &beside, &name)));
        answer.postures = Some(postures.arrays());
        let held = FixedAxis::of(&face.surface, cutter, &turn, args.postures.nodes);
        files.push(("i-fixed-axis.svg".to_owned(), held.page(&study, &scene, &name)));
        answer.fixed_axis = Some(held.arrays());
        stands = held.told();
    }
    answer.files = files.iter().map(|(f, _)| f.clone()).chain(["lines.json".to_owned()]).collect();
    files.push(("lines.json".to_owned(), serde_json::to_string(&answer).map_err(Failure::job)?));
    let claimed = output::claim(&args.out)?;
    let whole = cancel::whole();
    output::set(&args.out, &files.iter().map(|(f, t)| (f.as_str(), t.as_bytes())).collect::<Vec<_>>())?;
    drop((whole, claimed));
    if json_wanted {
        render::json(&answer)?;
    } else {
        render::text(&describe(&study, &name, (&turn, &stands), &answer.files, args))?;
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

/// The tool of the postures with what they must keep to.
fn limits(keys: &str, args: &PostureArgs) -> Result<(Cutter, Limits), Failure> {
    #[derive(serde::Deserialize)]
    struct Keys {
        tool: CutterSpec,
    }
    let usage = |e: String| Failure::Usage(format!("--tool '{keys}': {e}"));
    let Keys { tool: spec } = toml::from_str(&format!("tool = {{ {keys} }}"))
        .map_err(|e: toml::de::Error| usage(e.message().to_owned()))?;
    let cutter = Cutter::try_from(spec).map_err(|e| usage(e.to_string()))?;
    if args.nodes == 0 || args.nodes > MOST_NODES {
        return Err(Failure::Usage(format!("--nodes {} must be 1 to {MOST_NODES}", args.nodes)));
    }
    let range = |name: &str, [least, most]: [f64; 2]| {
        if least <= most && least > -90.0 && most < 90.0 {
            Ok(Range { least_rad: least.to_radians(), most_rad: most.to_radians() })
        } else {
            Err(Failure::Usage(format!(
                "{name} {least},{most} must be two angles within 90 degrees, the lesser first"
            )))
        }
    };
    for (name, x) in [
        ("--scallop-mm", args.scallop_mm),
        ("--gouge-mm", args.gouge_mm),
        ("--feed-mm-min", args.feed_mm_min),
    ] {
        if !(x > 0.0 && x.is_finite()) {
            return Err(Failure::Usage(format!("{name} {x} must be positive and finite")));
        }
    }
    let limits = Limits {
        scallop_mm: args.scallop_mm,
        gouge_mm: args.gouge_mm,
        lead: range("--lead-deg", args.lead_deg)?,
        tilt: range("--tilt-deg", args.tilt_deg)?,
        axis: None,
        caps: Caps::of_feed(args.feed_mm_min),
    };
    Ok((cutter, limits))
}

fn describe(
    study: &Study,
    name: &str,
    (turn, stands): (&Turn, &[String]),
    files: &[String],
    args: &LinesArgs,
) -> String {
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
    if turn.asked.minima > 0 {
        let f = &turn.fewest;
        out.push_str(&if f.minima < turn.asked.minima {
            let [x, y, z] = [f.axis.x, f.axis.y, f.axis.z].map(|x| number(x, 4));
            format!(
                "  along {x} {y} {z}, {} deg off: {}\n",
                number(f.turn_rad.to_degrees(), 3),
                minima(f.minima)
            )
        } else {
            "  no axis from which no more faces away has fewer minima\n".to_owned()
        });
    }
    for line in stands {
        out.push_str(&format!("  {line}\n"));
    }
    out.push_str(&format!("  searched in cells of at most {} mm\n", number(study.resolution_mm, 3)));
    for note in &study.notes {
        out.push_str(&format!("  note: {note}\n"));
    }
    out.push_str(&format!("\n  {}: {}\n\n", args.out.display(), files.join(", ")));
    out
}
