//! `probe`: differential geometry at parameters.

use crate::screen::args::PartArgs;
use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome};
use osculate::part;
use osculate::words::number;
use osculate_geom::{Surface, Unit3};
use serde::Serialize;

#[derive(Serialize)]
struct Point {
    uv: [f64; 2],
    point_mm: [f64; 3],
    normal: [f64; 3],
    first_form: [f64; 3],
    second_form: [f64; 3],
    principal_per_mm: [f64; 2],
    principal_directions: [[f64; 3]; 2],
    inside: bool,
}

#[derive(Serialize)]
struct Answer {
    face: String,
    points: Vec<Point>,
}

/// Runs the verb.
pub fn run(args: &PartArgs, face: Option<&str>, at: &[[f64; 2]], json: bool) -> Outcome {
    let loaded = part::whole(args.load()?)?;
    let face = loaded.one(face)?;
    let array = |d: &Unit3| [d.x, d.y, d.z];
    let mut points = Vec::new();
    for [u, v] in at {
        let at = face.at([*u, *v])?;
        let jet = face.surface.jet2(at);
        let forms = jet.forms().map_err(|e| Failure::job(format!("{}: {e}", face.id)))?;
        let p = forms.principal();
        points.push(Point {
            uv: [*u, *v],
            point_mm: [jet.point.x, jet.point.y, jet.point.z],
            normal: array(&forms.normal),
            first_form: forms.first,
            second_form: forms.second,
            principal_per_mm: [p.k_max, p.k_min],
            principal_directions: [array(&p.d_max), array(&p.d_min)],
            inside: face.surface.contains(at),
        });
    }
    if json {
        render::json(&Answer { face: face.id.clone(), points })?;
        return Ok(Done::Yes);
    }
    let list = |v: &[f64]| v.iter().map(|x| number(*x, 9)).collect::<Vec<_>>().join("  ");
    for p in &points {
        let inside = if p.inside { "" } else { "   (outside the trim)" };
        render::text(&format!("\n  {} at u, v = {}{inside}\n", face.id, list(&p.uv)))?;
        render::text(&format!("  point mm             {}\n", list(&p.point_mm)))?;
        render::text(&format!("  outward normal       {}\n", list(&p.normal)))?;
        render::text(&format!("  first form E F G     {}\n", list(&p.first_form)))?;
        render::text(&format!("  second form L M N    {}\n", list(&p.second_form)))?;
        render::text(&format!(
            "  k_max, k_min 1/mm    {}   (positive is convex)\n",
            list(&p.principal_per_mm)
        ))?;
        render::text(&format!("  direction of k_max   {}\n", list(&p.principal_directions[0])))?;
        render::text(&format!("  direction of k_min   {}\n", list(&p.principal_directions[1])))?;
    }
    Ok(Done::Yes)
}
