//! `axes`: how the tool may lean over the faces of a job, as a table and as pictures.

use crate::screen::args::AxesArgs;
use crate::screen::progress::SCREEN;
use crate::screen::{cancel, output, render};
use osculate::Part;
use osculate::failure::{Done, Outcome};
use osculate::job::Job;
use osculate::report::text::{fixed, short};
use osculate::words::{self, Table, number};
use osculate::work::axis_places::PlaceFigures;
use osculate::work::axis_view::{self, Asked, AxesOverFaces, FieldFigures};

/// What keeps the tool from directions of a place that a line lists at most.
const LISTED: usize = 4;

/// Runs the verb.
pub fn run(args: &AxesArgs, json: bool) -> Outcome {
    if let Some(out) = &args.out {
        output::folder(out)?;
    }
    let job = Job::load(&args.job)?;
    axis_view::strategies(&job)?;
    let claimed = args.out.as_deref().map(output::claim).transpose()?;
    let part = Part::watched(&job, &SCREEN)?;
    let asked = Asked { face: args.face.as_deref(), at: &args.at, pictures: args.out.is_some() };
    let found = axis_view::of_job(&job, &part, &asked, &SCREEN).map_err(|why| part.warned(why))?;
    if let Some(out) = &args.out {
        let files: Vec<_> =
            found.pictures.iter().map(|(name, svg)| (name.as_str(), svg.as_bytes())).collect();
        let whole = cancel::whole();
        output::set(out, &files)?;
        drop(whole);
    }
    drop(claimed);
    if json {
        render::json(&found)?;
    } else {
        let mut text = describe(&found);
        if let Some(out) = &args.out {
            let names: Vec<&str> = found.pictures.iter().map(|(name, _)| name.as_str()).collect();
            text += &format!("  {}: {}\n\n", out.display(), names.join(", "));
        }
        render::text(&text)?;
    }
    Ok(if found.all_have_fields() { Done::Yes } else { Done::NotWithinTolerance })
}

fn describe(found: &AxesOverFaces) -> String {
    let [least, most] = found.lean_deg.map(|l| number(l, 2));
    let mut out = format!("\n  {}, leaning {least} to {most} deg off the normal\n\n", found.tool);
    let mut t = Table::left([
        "face",
        "passes",
        "area mm2",
        "unreached mm2",
        "places",
        "not clear",
        "lean deg",
        "largest turn between neighbouring places",
    ]);
    for face in &found.faces {
        for field in &face.fields {
            t.row([
                face.face.clone(),
                field.along.map_or_else(|| "the job's".to_owned(), |a| format!("along {a}")),
                number(face.area_mm2, 4),
                number(face.unreached_mm2, 3),
                field.places_asked.to_string(),
                field.places_not_clear.to_string(),
                field.lean_deg.map_or_else(|| "-".to_owned(), |l| l.map(|l| number(l, 3)).join(" to ")),
                turns(field),
            ]);
        }
    }
    out += &t.render();
    out += "\n";
    for face in &found.faces {
        // Where there is a field its findings say so.
        if face.fields.iter().all(|f| f.no_field.is_some()) {
            for why in &face.unreached {
                out += &format!("  {}: {} ({} mm2)\n", face.face, why.what, number(why.area_mm2, 3));
            }
        }
    }
    let mut t = Table::left(["place", "u, v", "free %", "kept from the others by", "axis leans deg"]);
    for face in &found.faces {
        for (k, place) in face.places.iter().enumerate() {
            t.row([
                format!("{}-{}", face.face, k + 1),
                place.uv.map(|x| short(x, 5)).join(", "),
                fixed(place.free_percent, 1),
                kept_from(place),
                leans(place),
            ]);
        }
    }
    out += &format!("{}\n", t.render());
    out += &words::findings(&found.diagnostics);
    if !found.diagnostics.is_empty() {
        out += "\n";
    }
    out
}

/// The largest turns of the joints in a cell.
fn turns(field: &FieldFigures) -> String {
    if let Some(why) = &field.no_field {
        return format!("no field: {why}");
    }
    let one = |t: &axis_view::Turn| {
        format!("{} {} deg over {} mm", t.joint, number(t.turn_deg, 3), number(t.over_mm, 2))
    };
    field.largest_turns.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// What bars directions at a place, with its share.
fn kept_from(place: &PlaceFigures) -> String {
    let one = |s: &osculate::work::axis_places::Share| format!("{} {} %", s.what, fixed(s.percent, 1));
    let mut all: Vec<String> = place.barred.iter().take(LISTED).map(one).collect();
    let more = place.barred.iter().skip(LISTED);
    if more.len() > 0 {
        let percent: f64 = more.clone().map(|s| s.percent).sum();
        all.push(format!("{} more {} %", more.len(), fixed(percent, 1)));
    }
    if place.lift_mm > 0.0 {
        all.push(format!("all of it {} mm off the face", number(place.lift_mm, 3)));
    }
    all.join(", ")
}

/// How far the axes of the fields lean at a place.
fn leans(place: &PlaceFigures) -> String {
    let one = |a: &osculate::work::axis_places::AxisFigures| {
        let clear = if a.clear { "" } else { ", NOT clear" };
        format!("{} {}{clear}", a.passes, number(a.lean_deg, 3))
    };
    place.axes.iter().map(one).collect::<Vec<_>>().join("; ")
}
