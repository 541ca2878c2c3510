//! `inspect`: what is in a CAD file.

use crate::cmd::groups::{self, GroupRow, Neighbours};
use crate::screen::args::{InspectArgs, PartArgs};
use crate::screen::{output, render};
use osculate::failure::{Done, Failure, Outcome};
use osculate::job::Normals;
use osculate::job::problem::Problem;
use osculate::part::hidden::{self, Found};
use osculate::part::{self, Loaded, LoadedFace};
use osculate::words;
use osculate::words::{Table, number};
use osculate::work::faces_page;
use osculate::work::init::Grouped;
use osculate_geom::{Box3, Surface};
use osculate_surfaces::Colour;
use osculate_surfaces::structure::{Body, Shell, Structure};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashMap;
use std::path::Path;

#[derive(Serialize)]
struct FaceRow {
    id: String,
    name: String,
    /// The product that it belongs to; empty where the file names none.
    product: String,
    /// `#rrggbb`; empty where the file has none.
    colour: String,
    /// The body that it belongs to; empty where the file names none.
    body: String,
    /// The layers that it is on.
    layers: Vec<String>,
    kind: String,
    entity: u64,
    degree: Vec<usize>,
    poles: Vec<usize>,
    rational: bool,
    trimmed: bool,
    /// All of it, with what is hidden.
    area_mm2: f64,
    /// Within other bodies of the part.
    hidden_mm2: f64,
    /// Each of these bodies, by its faces.
    hidden_in: Vec<String>,
    bbox_mm: Vec<f64>,
    /// Least and greatest; empty where no point of the face has a tangent plane, and for triangles.
    principal_curvature_per_mm: Vec<f64>,
    u_range: [f64; 2],
    v_range: [f64; 2],
}

#[derive(Serialize)]
struct NotUsed {
    kind: String,
    count: usize,
    why: String,
    /// Where the first ones stand.
    lines: Vec<usize>,
}

/// Faces of one product.
#[derive(Serialize)]
struct Product {
    name: String,
    faces: usize,
    /// How often the face that stands most often does.
    instances: usize,
}

/// A body as the file gives it.
#[derive(Serialize)]
struct BodyRow {
    id: String,
    name: String,
    /// `solid`, `surfaces` or `set`.
    kind: String,
    entity: u64,
    /// Products from the whole assembly down to its own.
    path: Vec<String>,
    shells: Vec<ShellRow>,
}

/// A shell of a body.
#[derive(Serialize)]
struct ShellRow {
    name: String,
    entity: u64,
    /// Whether the file says that it closes.
    closed: bool,
    faces: Vec<String>,
}

/// Faces that the file shows and hides together.
#[derive(Serialize)]
struct LayerRow {
    name: String,
    faces: Vec<String>,
}

#[derive(Serialize)]
struct Answer {
    format: &'static str,
    unit: String,
    schema: String,
    /// Empty where the file names no product.
    products: Vec<Product>,
    /// Solids and other bodies, each at each of its places.
    bodies: Vec<BodyRow>,
    layers: Vec<LayerRow>,
    faces: Vec<FaceRow>,
    bbox_mm: Vec<f64>,
    area_mm2: f64,
    not_used: Vec<NotUsed>,
    diagnostics: Vec<String>,
    /// Groups of faces, where they are asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    groups: Option<Vec<GroupRow>>,
    /// How faces meet, where groups are asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    neighbours: Option<Vec<Neighbours>>,
    /// The page that was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    page: Option<String>,
    /// Why this is not all of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<Problem>,
}

fn corners(b: &Box3) -> Vec<f64> {
    if b.is_empty() { Vec::new() } else { b.min.iter().chain(b.max.iter()).copied().collect() }
}

fn hex(c: Colour) -> String {
    let [r, g, b] = [c.red, c.green, c.blue].map(|x| (255.0 * x).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The products in the order of their first faces.
fn products(faces: &[FaceRow]) -> Vec<Product> {
    let mut out: Vec<Product> = Vec::new();
    if faces.iter().all(|f| f.product.is_empty()) {
        return out;
    }
    let mut times: HashMap<(&str, u64), usize> = HashMap::new();
    for f in faces {
        let times = times.entry((&f.product, f.entity)).or_default();
        *times += 1;
        match out.iter_mut().find(|p| p.name == f.product) {
            Some(p) => {
                p.faces += 1;
                p.instances = p.instances.max(*times);
            }
            None => out.push(Product { name: f.product.clone(), faces: 1, instances: 1 }),
        }
    }
    out
}

fn body(b: &Body) -> BodyRow {
    let shell = |s: &Shell| ShellRow {
        name: s.name.clone(),
        entity: s.entity,
        closed: s.closed,
        faces: s.faces.clone(),
    };
    BodyRow {
        id: b.id.clone(),
        name: b.name.clone(),
        kind: b.kind.to_string(),
        entity: b.entity,
        path: b.path.clone(),
        shells: b.shells.iter().map(shell).collect(),
    }
}

/// Says of each face which body it belongs to and on which layers it is.
fn join(faces: &mut [FaceRow], structure: &Structure) {
    let number: HashMap<String, usize> = faces.iter().enumerate().map(|(k, f)| (f.id.clone(), k)).collect();
    for b in &structure.bodies {
        for k in b.faces().filter_map(|id| number.get(id)) {
            faces[*k].body.clone_from(&b.id);
        }
    }
    for l in &structure.layers {
        for k in l.faces.iter().filter_map(|id| number.get(id)) {
            faces[*k].layers.push(l.name.clone());
        }
    }
}

fn row(face: &LoadedFace) -> (FaceRow, Box3) {
    let b = part::bounds(face);
    let d = face.surface.domain();
    let source = face.source.as_ref();
    let row = FaceRow {
        id: face.id.clone(),
        name: face.name.clone(),
        product: source.map_or_else(String::new, |f| f.product.clone()),
        colour: source.and_then(|f| f.colour).map_or_else(String::new, hex),
        body: String::new(),
        layers: Vec::new(),
        kind: face.kind.clone(),
        entity: source.map_or(0, |f| f.entity),
        degree: source.and_then(|f| f.degree()).map_or_else(Vec::new, |d| d.to_vec()),
        poles: source.and_then(|f| f.pole_count()).map_or_else(Vec::new, |d| d.to_vec()),
        rational: source.and_then(|f| f.is_rational()).unwrap_or(false),
        trimmed: source.is_some_and(|f| f.trimmed()),
        area_mm2: part::area(face),
        hidden_mm2: 0.0,
        hidden_in: Vec::new(),
        bbox_mm: corners(&b),
        // Triangles are flat, whatever the face bends by.
        principal_curvature_per_mm: part::curvature_range(&*face.surface)
            .filter(|_| face.surface.facets().is_none())
            .map_or_else(Vec::new, |r| r.to_vec()),
        u_range: [d.u.lo, d.u.hi],
        v_range: [d.v.lo, d.v.hi],
    };
    (row, b)
}

/// Runs the verb.
pub fn run(options: &InspectArgs, json: bool) -> Outcome {
    let args = &options.part;
    options.out.as_deref().map_or(Ok(()), output::folder)?;
    let mut part = args.load()?;
    let why = failure(args, &part);
    // Faces with places that no part has can take minutes.
    if why.is_none() {
        let doubts = part::doubts(&part);
        part.diagnostics.extend(doubts);
    }
    let oriented = |k: usize| part.faces[k].source.as_ref().is_some_and(|f| f.oriented);
    let found = hidden::find(&part, &oriented);
    let grouped = (options.groups || options.out.is_some()).then(|| Grouped::of(part.clone(), Normals::Auto));
    let page = options.out.as_ref().map(|folder| folder.join("faces.html"));
    if let (Some(to), Some(grouped)) = (&page, &grouped) {
        let title = args.part.as_deref().and_then(Path::file_stem).map(|n| n.to_string_lossy().into_owned());
        let text = faces_page::page(grouped, &title.unwrap_or_else(|| "part".to_owned()));
        output::write(to, text.as_bytes())?;
    }
    let answer = Answer {
        error: why.as_ref().map(Failure::problem),
        groups: grouped.as_ref().map(groups::groups),
        neighbours: grouped.as_ref().map(groups::neighbours),
        page: page.as_ref().map(|p| p.display().to_string()),
        ..answer(&part, &found)
    };
    // What could be read is shown all the same.
    if !json {
        render::text(
            &(describe(&answer, &part, &found) + &groups::describe(&answer.groups, &answer.neighbours)),
        )?;
        if let Some(page) = &answer.page {
            render::text(&format!("  {page}\n\n"))?;
        }
        return why.map_or(Ok(Done::Yes), Err);
    }
    render::json(&answer)?;
    // The answer holds it already: one object is all that stands on stdout.
    Ok(why.map_or(Done::Yes, |why| {
        render::complaint(why.message());
        Done::NotWithinTolerance
    }))
}

/// Why what is shown is not the file.
fn failure(args: &PartArgs, part: &Loaded) -> Option<Failure> {
    if let Some(message) = &part.truncated {
        return Some(Failure::job(message));
    }
    if let Some(message) = part::far(part) {
        return Some(Failure::job(message));
    }
    let path = args.part.as_ref().filter(|_| part.faces.is_empty())?;
    let what = "no face of it could be read: what is lost and what is not used say why; export it again with surfaces";
    Some(Failure::file(path, what))
}

fn answer(part: &Loaded, found: &Found) -> Answer {
    let rows: Vec<(FaceRow, Box3)> = part.faces.par_iter().map(row).collect();
    let whole = rows.iter().fold(Box3::empty(), |b, r| b.union(&r.1));
    let mut faces: Vec<FaceRow> = rows.into_iter().map(|r| r.0).collect();
    join(&mut faces, &part.structure);
    for row in &mut faces {
        if let Some(of) = found.faces.iter().find(|f| f.id == row.id) {
            (row.hidden_mm2, row.hidden_in) = (of.hidden_mm2, of.bodies.clone());
        }
    }
    Answer {
        format: part.format,
        unit: part.unit.clone(),
        schema: part.schema.clone(),
        bbox_mm: corners(&whole),
        // An empty sum is minus zero.
        area_mm2: faces.iter().map(|f| f.area_mm2).sum::<f64>() + 0.0,
        products: products(&faces),
        bodies: part.structure.bodies.iter().map(body).collect(),
        layers: part
            .structure
            .layers
            .iter()
            .map(|l| LayerRow { name: l.name.clone(), faces: l.faces.clone() })
            .collect(),
        faces,
        not_used: part.not_used.iter().map(not_used).collect(),
        diagnostics: part.diagnostics.iter().chain(&found.diagnostics).map(ToString::to_string).collect(),
        groups: None,
        neighbours: None,
        page: None,
        error: None,
    }
}

fn not_used(n: &osculate_surfaces::NotUsed) -> NotUsed {
    NotUsed { kind: n.kind.clone(), count: n.count, why: n.why.clone(), lines: n.lines.clone() }
}

/// The first lines, and that there are more.
fn lines(n: &NotUsed) -> String {
    const SHOWN: usize = 3;
    let shown: Vec<String> = n.lines.iter().take(SHOWN).map(ToString::to_string).collect();
    let more = if n.count > shown.len() && !shown.is_empty() { ", ..." } else { "" };
    format!("{}{more}", shown.join(", "))
}

/// The columns of faces that stand where a file has any of them.
const NAMED: [&str; 5] = ["name", "product", "colour", "body", "layer"];

/// The table of bodies, and how many there are of each kind; nothing of a file without.
fn body_table(bodies: &[BodyRow]) -> String {
    if bodies.is_empty() {
        return String::new();
    }
    let mut t = Table::left(["body", "kind", "faces", "shells", "name", "in"]);
    for b in bodies {
        let faces: usize = b.shells.iter().map(|s| s.faces.len()).sum();
        let closed = b.shells.iter().filter(|s| s.closed).count();
        let shells = match (closed, b.shells.len() - closed) {
            (closed, 0) => format!("{closed} closed"),
            (0, open) => format!("{open} open"),
            (closed, open) => format!("{closed} closed, {open} open"),
        };
        t.row([b.id.clone(), b.kind.clone(), faces.to_string(), shells, b.name.clone(), b.path.join(" / ")]);
    }
    format!("\n{}", t.render())
}

/// The table of faces; names, products and colours where the file has any.
fn face_table(faces: &[FaceRow]) -> String {
    let pair = |v: &[usize]| v.iter().map(ToString::to_string).collect::<Vec<_>>().join("x");
    let yes = |b: bool| if b { "yes" } else { "-" }.to_owned();
    let words = |f: &FaceRow| {
        [f.name.clone(), f.product.clone(), f.colour.clone(), f.body.clone(), f.layers.join(", ")]
    };
    let named: Vec<usize> =
        (0..NAMED.len()).filter(|k| faces.iter().any(|f| !words(f)[*k].is_empty())).collect();
    let plain =
        ["face", "kind", "degree", "poles", "rational", "trimmed", "area mm2", "k_min 1/mm", "k_max 1/mm"];
    let mut t = Table::new(plain.into_iter().chain(named.iter().map(|k| NAMED[*k])));
    for f in faces {
        let k = |i: usize| f.principal_curvature_per_mm.get(i).map_or_else(|| "-".into(), |k| number(*k, 4));
        let plain = [
            f.id.clone(),
            f.kind.clone(),
            pair(&f.degree),
            pair(&f.poles),
            yes(f.rational),
            yes(f.trimmed),
            number(f.area_mm2, 6),
            k(0),
            k(1),
        ];
        let words = words(f);
        t.row(plain.into_iter().chain(named.iter().map(|k| words[*k].clone())));
    }
    t.render()
}

fn describe(a: &Answer, part: &Loaded, found: &Found) -> String {
    let unit = if a.unit.is_empty() { "no unit stated".to_owned() } else { format!("unit {}", a.unit) };
    let mut out = format!("\n  {} file, {unit}", a.format);
    if !a.schema.is_empty() {
        out.push_str(&format!(", schema {}", a.schema));
    }
    out.push_str(&format!("; {} faces, {} mm2\n", a.faces.len(), number(a.area_mm2, 7)));
    if let [x0, y0, z0, x1, y1, z1] = a.bbox_mm[..] {
        out.push_str(&format!("  box mm: {x0:.3} {y0:.3} {z0:.3} to {x1:.3} {y1:.3} {z1:.3}\n"));
    }
    if !a.faces.is_empty() {
        out.push_str(&format!("\n{}", face_table(&a.faces)));
    }
    out.push_str(&body_table(&a.bodies));
    if !found.faces.is_empty() {
        let mut t = Table::new(["face", "hidden mm2", "of it", "in"]);
        for f in a.faces.iter().filter(|f| !f.hidden_in.is_empty()) {
            let share = format!("{:.1} %", 100.0 * f.hidden_mm2 / f.area_mm2);
            t.row([f.id.clone(), number(f.hidden_mm2, 6), share, f.hidden_in.join("; ")]);
        }
        out.push_str(&format!("\n{}", t.render()));
    }
    if a.products.iter().any(|p| p.instances > 1) || a.products.len() > 1 {
        let mut t = Table::new(["product", "faces", "instances"]);
        for p in &a.products {
            t.row([p.name.clone(), p.faces.to_string(), p.instances.to_string()]);
        }
        out.push_str(&format!("\n{}", t.render()));
    }
    if !a.not_used.is_empty() {
        let mut t = Table::new(["not used", "count", "lines", "why"]);
        for n in &a.not_used {
            t.row([n.kind.clone(), n.count.to_string(), lines(n), n.why.clone()]);
        }
        out.push_str(&format!("\n{}", t.render()));
    }
    let findings = [part.diagnostics.as_slice(), &found.diagnostics].concat();
    if !findings.is_empty() {
        out.push_str(&format!("\n{}", words::findings(&findings)));
    }
    out.push('\n');
    out
}
