//! The static picture: part, path and tool in orthographic projection as plain SVG.
//!
//! Surfaces are painted from far to near, lines are drawn where a depth map of the full mesh says that nothing lies
//! in front of them. The number of facets and line points is bounded, so that the file stays near 300 kB whatever
//! the part; where passes are left out, the caption says so. Coordinates are written in half pixels, as integers.

mod lines;
mod paint;
mod tool;
mod view;

use self::lines::Scene;
use self::paint::{Facet, nearness, paint, shaded};
use super::data::{Report, Scalar};
use super::legend::{Limits, Scale, nice_step};
use super::mesh::{Clean, clean};
use super::opening::opening;
use super::pack::{Bounds, finite};
use super::project::{Camera, DepthMap, Frame, unit};
use super::simplify::simplify;
use super::text::{coordinate, escape, figure};
use std::fmt::Write;
pub use view::{PartColours, PathColours, USUAL, View};

/// Facets of the part in the picture at most: 20 bytes each where neighbours have one colour, 45 where none do.
const FACETS: usize = 14_000;
/// What the painted facets may take, bytes; lines, tool and legends take the rest of about 300 kB.
const FACET_BYTES: usize = 225_000;
/// Triangles so much farther than what is seen are left out, px: what stands for several of them may lie in front of it.
const BEHIND: f64 = 8.0;
/// The share of values beyond each end of a quantity's scale.
const OUTSIDE: f64 = 0.01;
/// Width of a legend, px, and of a letter of its title.
const LEGEND: f64 = 118.0;
const LETTER: f64 = 7.4;
/// The picture of `report` as an SVG document.
pub fn svg(report: &Report, view: &View) -> String {
    let mut faces: Vec<Clean> = report.faces.iter().map(|f| clean(f, quantities(report, view))).collect();
    if let PartColours::Quantity(k) = view.part {
        // Facets are made few by what is painted.
        for face in &mut faces {
            face.deviation_mm = face.scalars.get(k).cloned().unwrap_or_default();
        }
    }
    svg_of(report, &faces, view)
}

/// What stands above a scale: the name and its unit.
fn title(scale: &Scale) -> String {
    if scale.unit.is_empty() { scale.name.clone() } else { format!("{}, {}", scale.name, scale.unit) }
}

/// Room for a scale with its title, px.
fn legend_width(scale: &Scale) -> f64 {
    LEGEND.max(LETTER * title(scale).chars().count() as f64 + 12.0)
}

/// How many quantities the faces need for a picture.
fn quantities(report: &Report, view: &View) -> usize {
    if matches!(view.part, PartColours::Quantity(_)) { report.scalars.len() } else { 0 }
}

/// The scale of a quantity, without the few values beyond most others: the least and the greatest of many samples are noise.
fn scale_of(scalar: &Scalar, values: impl Iterator<Item = f64>) -> Option<Scale> {
    let mut all: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    let cut = (OUTSIDE * all.len() as f64) as usize;
    let within = all.get(cut..all.len() - cut).unwrap_or_default();
    Scale::sequential(&scalar.name, &scalar.unit, within.iter().copied())
}

/// [`svg`] with the faces already made clean.
pub fn svg_of(report: &Report, faces: &[Clean], view: &View) -> String {
    let (width, height) = (view.width_px.clamp(160, 4000), view.height_px.clamp(120, 4000));
    let quantity = match view.part {
        PartColours::Quantity(k) => report.scalars.get(k),
        _ => None,
    };
    let limits = match quantity {
        // Of a quantity no value counts more than others.
        Some(_) => Limits { scallop_mm: f64::INFINITY, gouge_mm: f64::INFINITY },
        None => Limits {
            scallop_mm: report.verdict.scallop_tolerance_mm,
            gouge_mm: report.verdict.gouge_tolerance_mm,
        },
    };
    let values = || faces.iter().flat_map(|f| &f.deviation_mm).map(|d| f64::from(*d));
    let reach = || values().filter(|d| d.is_finite()).fold(0.0, |m: f64, d| m.max(d.abs()));
    let part_scale = match (view.part, quantity) {
        (PartColours::Deviation, _) => Some(Scale::deviation(limits, reach())),
        (_, Some(scalar)) => scale_of(scalar, values()),
        _ => None,
    };
    let widths = report.passes.iter().flat_map(|p| &p.widths_mm).map(|w| f64::from(*w));
    let path_scale = (view.path == PathColours::StripWidth)
        .then(|| Scale::sequential("Strip width", "mm", widths))
        .flatten();
    let legends: Vec<&Scale> = part_scale.iter().chain(&path_scale).collect();

    let margin = 22.0;
    let frame = Frame {
        x: margin,
        y: 48.0,
        width: f64::from(width) - 2.0 * margin - legends.iter().map(|s| legend_width(s)).sum::<f64>(),
        height: f64::from(height) - 48.0 - 40.0,
    };
    let direction = view.direction.unwrap_or_else(|| opening(report, faces));
    let camera = Camera::fit(direction, frame, seen_points(report, faces, view));

    let (columns, rows) = (width as usize, height as usize);
    let mut depth = DepthMap::new(columns, rows);
    let pictures: Vec<Vec<[f64; 3]>> = faces
        .iter()
        .map(|f| f.positions.iter().map(|p| camera.project(p.map(f64::from))).collect())
        .collect();
    for (face, picture) in faces.iter().zip(&pictures) {
        face.triangles.iter().for_each(|t| depth.fill(t.map(|i| picture[i as usize])));
    }
    // What lies behind takes no share of the facets.
    let seen = |(face, picture): (&Clean, &Vec<[f64; 3]>)| {
        let shown = |t: &&[u32; 3]| depth.shows(t.map(|i| picture[i as usize]), BEHIND);
        Clean { triangles: face.triangles.iter().filter(shown).copied().collect(), ..face.clone() }
    };
    let front: Vec<Clean> = faces.iter().zip(&pictures).map(seen).collect();
    let tool =
        tool::placed(report, view.tool_at).map(|t| tool::facets(&t, &camera, &mut depth)).unwrap_or_default();
    let look = Look { camera: &camera, limits, scale: part_scale.as_ref() };
    let mut budget = FACETS;
    let painted = loop {
        let mut facets = part_facets(&front, &pictures, look, budget);
        facets.extend(&tool);
        facets.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));
        let painted = paint(&facets, columns, rows);
        // A handful of facets is all there can be: their size is then that of the tool.
        if painted.len() <= FACET_BYTES || budget < 100 {
            break painted;
        }
        budget = budget * FACET_BYTES / painted.len() * 19 / 20;
    };

    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\" aria-label=\"{title}\" font-family=\"system-ui,-apple-system,Segoe UI,Roboto,sans-serif\" \
         font-size=\"12\" color=\"#27323d\" fill=\"currentColor\"><rect width=\"{width}\" height=\"{height}\" rx=\"8\" \
         fill=\"#f7f9fa\"/><g transform=\"scale(.5)\" fill=\"currentColor\" stroke=\"currentColor\" stroke-width=\"1.9\" \
         stroke-linejoin=\"round\">",
        title = escape(&report.title)
    );
    out.push_str(&painted);
    out.push_str("</g>");
    let scene = Scene { camera, depth };
    let shown = lines::lines(&mut out, report, view, path_scale.as_ref(), &scene);
    let sheet = Sheet { width: f64::from(width), height: f64::from(height), scale: scene.camera.scale };
    furniture(&mut out, report, &legends, sheet, &caption(report, shown));
    out + "</svg>"
}

/// The points that the camera makes room for: part, passes, links where shown, and of the tool what stands near the
/// part.
fn seen_points<'a>(
    report: &'a Report,
    faces: &'a [Clean],
    view: &View,
) -> impl Iterator<Item = [f64; 3]> + 'a {
    let part = || faces.iter().flat_map(|f| &f.positions);
    let links = if view.links { report.links.as_slice() } else { &[] };
    let extent =
        Bounds::of(part()).map_or(0.0, |b| (0..3).map(|i| f64::from(b.hi[i] - b.lo[i])).fold(0.0, f64::max));
    let tool = tool::placed(report, view.tool_at).into_iter().flat_map(move |place| {
        place.rings(12).into_iter().filter(move |r| r.height < 0.3 * extent).flat_map(|r| r.points)
    });
    part()
        .chain(report.passes.iter().flat_map(|p| &p.points_mm))
        .chain(links.iter().flat_map(|l| &l.points_mm))
        .filter(|p| finite(p))
        .map(|p| p.map(f64::from))
        .chain(tool)
}

/// How surfaces look.
#[derive(Clone, Copy)]
struct Look<'a> {
    camera: &'a Camera,
    limits: Limits,
    scale: Option<&'a Scale>,
}

/// About `budget` facets of the part.
fn part_facets(faces: &[Clean], pictures: &[Vec<[f64; 3]>], look: Look, budget: usize) -> Vec<Facet> {
    let Look { camera, limits, scale } = look;
    let mut facets = Vec::new();
    for ((face, picture), few) in faces.iter().zip(pictures).zip(simplify(faces, pictures, limits, budget)) {
        for facet in few {
            let normal = facet.corners.map(|i| face.normals[i as usize].map(f64::from));
            let sum = std::array::from_fn(|i| normal[0][i] + normal[1][i] + normal[2][i]);
            let light = camera.light(unit(sum));
            let colour = match scale {
                Some(scale) => shaded(scale.colour(facet.deviation_mm), 0.66 + 0.34 * light),
                None => shaded([0xc3, 0xce, 0xd8], 0.5 + 0.5 * light),
            };
            facets.push(Facet { corners: facet.corners.map(|i| picture[i as usize]), colour });
        }
    }
    facets
}

/// What the caption says: how many passes, how many of them drawn, the tool.
fn caption(report: &Report, [shown, passes]: [usize; 2]) -> String {
    let mut words = Vec::new();
    if passes > 0 {
        let drawn = if (1..passes).contains(&shown) { format!("{shown} of ") } else { String::new() };
        words.push(format!("{drawn}{passes} passes"));
    }
    match &report.tools[..] {
        [] => {}
        [one] => words.push(one.label.clone()),
        several => words.push(format!("{} operations", several.len())),
    }
    words.join(", ")
}

/// The picture's size, px, and its scale, px/mm.
#[derive(Clone, Copy)]
struct Sheet {
    width: f64,
    height: f64,
    scale: f64,
}

/// Title, legends, scale bar and caption.
fn furniture(out: &mut String, report: &Report, legends: &[&Scale], sheet: Sheet, caption: &str) {
    let Sheet { width, height, scale: px_mm } = sheet;
    let _ = write!(
        out,
        "<text x=\"22\" y=\"30\" font-size=\"16\" font-weight=\"600\">{}</text>",
        escape(&report.title)
    );
    for (i, scale) in legends.iter().enumerate() {
        let x = width - legends[i..].iter().map(|s| legend_width(s)).sum::<f64>();
        let long = (height - 130.0).clamp(60.0, 320.0);
        // Tool and holder may reach behind it.
        let _ = write!(
            out,
            "<rect x=\"{}\" y=\"40\" width=\"{}\" height=\"{}\" rx=\"6\" fill=\"#f7f9fa\" fill-opacity=\".88\"/>\
             <text x=\"{x}\" y=\"56\" font-weight=\"600\">{}</text><g transform=\"translate({x} 70)\">{}</g>",
            x - 8.0,
            legend_width(scale) + 4.0,
            long + 44.0,
            escape(&title(scale)),
            scale.bar(long)
        );
    }
    let long = nice_step(60.0 / px_mm);
    let (from, base) = (22.0, height - 18.0);
    let to = from + long * px_mm;
    let _ = write!(
        out,
        "<path d=\"M{from} {}v6h{}v-6\" fill=\"none\" stroke=\"currentColor\"/><text x=\"{}\" y=\"{base}\">{} mm</text>\
         <text x=\"{}\" y=\"{base}\" text-anchor=\"end\">{}</text>",
        coordinate(base - 7.0),
        coordinate(to - from),
        coordinate(to + 8.0),
        figure(long, 1),
        width - 22.0,
        escape(caption)
    );
}
