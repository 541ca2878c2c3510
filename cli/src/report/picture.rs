//! The static picture: part, path and tool in orthographic projection as plain SVG.
//!
//! Surfaces are painted from far to near, lines are drawn where a depth map of the full mesh says that nothing lies in
//! front of them. The number of facets and line points is bounded, so that the file stays near 300 kB whatever the part;
//! where passes are left out, the caption says so. Coordinates are written in half pixels, as integers.

use super::data::Report;
use super::legend::{Limits, Rgb, Scale, UNKNOWN};
use super::mesh::{Clean, clean};
use super::pack::{Bounds, finite};
use super::project::{Camera, DepthMap, Direction, Frame, dot, unit};
use super::simplify::simplify;
use super::text::{coordinate, escape, figure};
use super::tool_body::{Piece, outlines};
use std::fmt::Write;

/// Facets of the part in the picture, about 40 bytes each.
const FACETS: usize = 5200;
/// Passes in the picture; more are a grey area and not lines.
const PASSES: usize = 130;
/// Corners of all lines in the picture, about 8 bytes each.
const LINE_POINTS: usize = 9000;
/// Facets around the tool.
const SECTORS: usize = 40;
/// Lines lie on the surface: this many pixels behind it they still count as visible.
const SLACK_PX: f64 = 2.5;

/// What the surface's colours say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PartColours {
    /// The deviation.
    #[default]
    Deviation,
    /// Nothing but its shape.
    Plain,
}

/// What the path's colours say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PathColours {
    /// No path.
    Hidden,
    /// Nothing but its way.
    #[default]
    Plain,
    /// The strip width.
    StripWidth,
}

/// How to look at the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From where.
    pub direction: Direction,
    /// Width of the picture, px.
    pub width_px: u32,
    /// Height of the picture, px.
    pub height_px: u32,
    /// What the surface's colours say.
    pub part: PartColours,
    /// What the path's colours say.
    pub path: PathColours,
    /// With the links and rapids.
    pub links: bool,
    /// With the tool, at this share of the path from 0 to 1.
    pub tool_at: Option<f64>,
}

impl Default for View {
    fn default() -> Self {
        Self {
            direction: Direction { azimuth_deg: -52.0, elevation_deg: 34.0 },
            width_px: 960,
            height_px: 600,
            part: PartColours::Deviation,
            path: PathColours::Plain,
            links: false,
            tool_at: Some(0.62),
        }
    }
}

/// Something to paint: corners in the picture, how near, which colour.
struct Facet {
    corners: [[f64; 3]; 3],
    colour: Rgb,
}

/// The picture of `report` as an SVG document.
pub fn svg(report: &Report, view: &View) -> String {
    let faces: Vec<Clean> = report.faces.iter().map(|f| clean(f, 0)).collect();
    svg_of(report, &faces, view)
}

/// [`svg`] with the faces already made clean.
pub fn svg_of(report: &Report, faces: &[Clean], view: &View) -> String {
    let (width, height) = (view.width_px.clamp(160, 4000), view.height_px.clamp(120, 4000));
    let limits = Limits {
        scallop_mm: report.verdict.scallop_tolerance_mm,
        gouge_mm: report.verdict.gouge_tolerance_mm,
    };
    let deviations = faces.iter().flat_map(|f| &f.deviation_mm).map(|d| f64::from(*d));
    let reach = deviations.filter(|d| d.is_finite()).fold(0.0, |m: f64, d| m.max(d.abs()));
    let part_scale = (view.part == PartColours::Deviation).then(|| Scale::deviation(limits, reach));
    let widths = report.passes.iter().flat_map(|p| &p.widths_mm).map(|w| f64::from(*w));
    let path_scale = (view.path == PathColours::StripWidth)
        .then(|| Scale::sequential("Strip width", "mm", widths))
        .flatten();
    let legends: Vec<&Scale> = part_scale.iter().chain(&path_scale).collect();

    let margin = 22.0;
    let frame = Frame {
        x: margin,
        y: 48.0,
        width: f64::from(width) - 2.0 * margin - 104.0 * legends.len() as f64,
        height: f64::from(height) - 48.0 - 40.0,
    };
    let camera = Camera::fit(view.direction, frame, seen_points(report, faces, view));

    let mut depth = DepthMap::new(width as usize, height as usize);
    let mut facets = part_facets(faces, &camera, limits, part_scale.as_ref(), &mut depth);
    facets.extend(tool_facets(report, view, &camera, &mut depth));
    facets.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));

    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\" aria-label=\"{title}\" font-family=\"system-ui,-apple-system,Segoe UI,Roboto,sans-serif\" \
         font-size=\"12\" color=\"#27323d\" fill=\"currentColor\"><rect width=\"{width}\" height=\"{height}\" rx=\"8\" \
         fill=\"#f7f9fa\"/><g transform=\"scale(.5)\" fill=\"currentColor\" stroke=\"currentColor\" stroke-width=\"1.2\" \
         stroke-linejoin=\"round\">",
        title = escape(&report.title)
    );
    paint(&mut out, &facets);
    out.push_str("</g>");
    let shown = lines(&mut out, report, view, &camera, &depth, path_scale.as_ref());
    furniture(&mut out, report, &camera, &legends, [f64::from(width), f64::from(height)], shown);
    out + "</svg>"
}

/// The points that the camera makes room for: part, passes, links where shown, and of the tool what stands near the
/// part.
fn seen_points<'a>(report: &'a Report, faces: &'a [Clean], view: &View) -> impl Iterator<Item = [f64; 3]> + 'a {
    let part = || faces.iter().flat_map(|f| &f.positions);
    let links = if view.links { report.links.as_slice() } else { &[] };
    let extent = Bounds::of(part()).map_or(0.0, |b| (0..3).map(|i| f64::from(b.hi[i] - b.lo[i])).fold(0.0, f64::max));
    let tool = placed_tool(report, view).into_iter().flat_map(move |place| {
        place.rings(12).into_iter().filter(move |r| r.height < 0.3 * extent).flat_map(|r| r.points)
    });
    part()
        .chain(report.passes.iter().flat_map(|p| &p.points_mm))
        .chain(links.iter().flat_map(|l| &l.points_mm))
        .filter(|p| finite(p))
        .map(|p| p.map(f64::from))
        .chain(tool)
}

fn part_facets(
    faces: &[Clean],
    camera: &Camera,
    limits: Limits,
    scale: Option<&Scale>,
    depth: &mut DepthMap,
) -> Vec<Facet> {
    let total: usize = faces.iter().map(|f| f.triangles.len()).sum();
    let mut facets = Vec::new();
    for face in faces {
        let picture: Vec<[f64; 3]> = face.positions.iter().map(|p| camera.project(p.map(f64::from))).collect();
        for t in &face.triangles {
            depth.fill(t.map(|i| picture[i as usize]));
        }
        let budget = (FACETS * face.triangles.len()).div_ceil(total.max(1)).max(12);
        for facet in simplify(face, &picture, limits, budget) {
            let normal = facet.corners.map(|i| face.normals[i as usize].map(f64::from));
            let sum = std::array::from_fn(|i| normal[0][i] + normal[1][i] + normal[2][i]);
            let light = camera.light(unit(sum));
            let colour = match scale {
                Some(scale) => shaded(scale.colour(facet.deviation_mm), 0.66 + 0.34 * light),
                None => shaded([0xb9, 0xc4, 0xcf], 0.45 + 0.55 * light),
            };
            facets.push(Facet { corners: facet.corners.map(|i| picture[i as usize]), colour });
        }
    }
    facets
}

/// A circle around the tool's axis.
struct Ring {
    piece: Piece,
    height: f64,
    points: Vec<[f64; 3]>,
}

/// The tool at one pose.
struct Placed {
    tip: [f64; 3],
    /// Two directions across the axis and the axis.
    frame: [[f64; 3]; 3],
    outlines: Vec<(Piece, Vec<[f64; 2]>)>,
}

fn placed_tool(report: &Report, view: &View) -> Option<Placed> {
    let share = view.tool_at.filter(|s| s.is_finite())?;
    let poses: Vec<_> = report.poses.iter().filter(|p| finite(&p.tip_mm) && finite(&p.axis)).collect();
    let pose = poses.get((share.clamp(0.0, 1.0) * poses.len().saturating_sub(1) as f64).round() as usize)?;
    let axis = unit(pose.axis.map(f64::from));
    let aside = if axis[0].abs() < 0.8 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let x = unit(cross(aside, axis));
    let outlines = outlines(report.tool.as_ref()?);
    Some(Placed { tip: pose.tip_mm.map(f64::from), frame: [x, cross(axis, x), axis], outlines })
}

impl Placed {
    fn point(&self, radius: f64, height: f64, turn: f64) -> [f64; 3] {
        let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
        let [x, y, axis] = self.frame;
        std::array::from_fn(|i| self.tip[i] + radius * (cos * x[i] + sin * y[i]) + height * axis[i])
    }

    /// Rings along all pieces, long walls cut into pieces short enough for painting in order of depth.
    fn rings(&self, sectors: usize) -> Vec<Ring> {
        let mut rings = Vec::new();
        for (piece, outline) in &self.outlines {
            let widest = outline.iter().map(|p| p[0]).fold(0.0, f64::max);
            for pair in outline.windows(2) {
                let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
                let steps = (length / widest.max(1e-9)).ceil().clamp(1.0, 12.0) as usize;
                for i in 0..steps {
                    let at = |k: usize| pair[0][k] + (pair[1][k] - pair[0][k]) * i as f64 / steps as f64;
                    rings.push(self.ring(*piece, [at(0), at(1)], sectors));
                }
            }
            if let Some(last) = outline.last() {
                rings.push(self.ring(*piece, *last, sectors));
            }
        }
        rings
    }

    fn ring(&self, piece: Piece, [radius, height]: [f64; 2], sectors: usize) -> Ring {
        let points = (0..sectors).map(|k| self.point(radius, height, k as f64 / sectors as f64)).collect();
        Ring { piece, height, points }
    }
}

fn tool_facets(report: &Report, view: &View, camera: &Camera, depth: &mut DepthMap) -> Vec<Facet> {
    let Some(placed) = placed_tool(report, view) else { return Vec::new() };
    let rings = placed.rings(SECTORS);
    let mut facets = Vec::new();
    for pair in rings.windows(2).filter(|pair| pair[0].piece == pair[1].piece) {
        let base = match pair[0].piece {
            Piece::Cutter => [0xd9, 0xb4, 0x5b],
            Piece::Shank => [0xb4, 0xbc, 0xc6],
            Piece::Holder => [0x6d, 0x78, 0x85],
        };
        for k in 0..SECTORS {
            let next = (k + 1) % SECTORS;
            let corners = [pair[0].points[k], pair[0].points[next], pair[1].points[next], pair[1].points[k]];
            let diagonal = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| corners[b][i] - corners[a][i]) };
            let (u, v) = (diagonal(0, 2), diagonal(1, 3));
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            // The body is closed: what faces away is behind what faces the viewer.
            if dot(normal, camera.toward) <= 0.0 {
                continue;
            }
            let colour = shaded(base, 0.5 + 0.5 * camera.light(unit(normal)));
            let q = corners.map(|p| camera.project(p));
            for corners in [[q[0], q[1], q[2]], [q[0], q[2], q[3]]] {
                depth.fill(corners);
                facets.push(Facet { corners, colour });
            }
        }
    }
    facets
}

fn nearness(facet: &Facet) -> f64 {
    facet.corners.iter().map(|c| c[2]).sum()
}

/// `colour` at the brightness `light`, in steps of 4: neighbours with one colour share a path.
fn shaded(colour: Rgb, light: f64) -> Rgb {
    colour.map(|c| ((f64::from(c) * light.min(1.0) / 4.0).round() * 4.0).min(255.0) as u8)
}

fn paint(out: &mut String, facets: &[Facet]) {
    let mut current: Option<Rgb> = None;
    for facet in facets {
        let [a, b, c] = facet.corners.map(|p| [(2.0 * p[0]).round() as i64, (2.0 * p[1]).round() as i64]);
        if (b[0] - a[0]) * (c[1] - a[1]) == (c[0] - a[0]) * (b[1] - a[1]) {
            continue;
        }
        if current != Some(facet.colour) {
            if current.is_some() {
                out.push_str("\"/>");
            }
            let [r, g, b] = facet.colour;
            let _ = write!(out, "<path color=\"#{r:02x}{g:02x}{b:02x}\" d=\"");
            current = Some(facet.colour);
        }
        let _ = write!(out, "M{} {}", a[0], a[1]);
        step(out, 'l', a, b);
        step(out, ' ', b, c);
        out.push('z');
    }
    if current.is_some() {
        out.push_str("\"/>");
    }
}

/// A relative step, without the space where a minus separates already.
fn step(out: &mut String, command: char, from: [i64; 2], to: [i64; 2]) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    if command != ' ' || dx >= 0 {
        out.push(command);
    }
    let _ = write!(out, "{dx}");
    if dy >= 0 {
        out.push(' ');
    }
    let _ = write!(out, "{dy}");
}

/// A run of visible points with the class of colour it has.
type Run = (usize, Vec<[f64; 2]>);

/// Draws borders, passes and links; returns how many passes of how many are drawn.
fn lines(
    out: &mut String,
    report: &Report,
    view: &View,
    camera: &Camera,
    depth: &DepthMap,
    scale: Option<&Scale>,
) -> [usize; 2] {
    let project = |p: &[f32; 3]| camera.project(p.map(f64::from));
    let cut: Vec<_> = report.passes.iter().filter(|p| !p.points_mm.is_empty()).collect();
    let stride = cut.len().div_ceil(PASSES).max(1);
    let shown: Vec<_> = match view.path {
        PathColours::Hidden => Vec::new(),
        _ => cut.iter().step_by(stride).collect(),
    };
    const CLASSES: usize = 10;
    let class = |width: Option<&f32>| -> usize {
        let (Some(scale), Some(w)) = (scale, width.filter(|w| w.is_finite())) else { return CLASSES };
        let (lo, hi) = scale.range();
        let t = if hi > lo { (f64::from(*w) - lo) / (hi - lo) } else { 0.0 };
        (t * CLASSES as f64).clamp(0.0, CLASSES as f64 - 1.0) as usize
    };
    let mut runs: Vec<Run> = Vec::new();
    for pass in &shown {
        let points = pass.points_mm.iter().enumerate().filter(|(_, p)| finite(p));
        let located = points.map(|(i, p)| (class(pass.widths_mm.get(i)), project(p)));
        visible_runs(&mut runs, located, depth);
    }
    let thinned = thin(runs);
    for c in 0..=CLASSES {
        let mut d = String::new();
        for (_, run) in thinned.iter().filter(|(k, _)| *k == c) {
            polyline(&mut d, run);
        }
        if d.is_empty() {
            continue;
        }
        let (colour, opacity, width) = match scale {
            Some(scale) => {
                let (lo, hi) = scale.range();
                let colour = if c == CLASSES { UNKNOWN } else { scale.colour(lo + (hi - lo) * (c as f64 + 0.5) / CLASSES as f64) };
                (colour, "1", "3")
            }
            None => ([0x1c, 0x2b, 0x3a], ".55", "1.5"),
        };
        let [r, g, b] = colour;
        let _ = write!(
            out,
            "<path transform=\"scale(.5)\" fill=\"none\" stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-opacity=\"{opacity}\" \
             stroke-width=\"{width}\" stroke-linejoin=\"round\" d=\"{d}\"/>"
        );
    }
    if view.links {
        let mut runs: Vec<Run> = Vec::new();
        for link in &report.links {
            let located = link.points_mm.iter().filter(|p| finite(p)).map(|p| (usize::from(!link.rapid), project(p)));
            visible_runs(&mut runs, located, depth);
        }
        let thinned = thin(runs);
        for (kind, stroke) in [(0, "#c2410c\" stroke-dasharray=\"7 5"), (1, "#0369a1")] {
            let mut d = String::new();
            thinned.iter().filter(|(k, _)| *k == kind).for_each(|(_, run)| polyline(&mut d, run));
            if !d.is_empty() {
                let _ = write!(
                    out,
                    "<path transform=\"scale(.5)\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"1.6\" d=\"{d}\"/>"
                );
            }
        }
    }
    [shown.len(), cut.len()]
}

/// Cuts a line into runs of points that can be seen and have one class; a run of another class begins where the last
/// one ends.
fn visible_runs(runs: &mut Vec<Run>, points: impl Iterator<Item = (usize, [f64; 3])>, depth: &DepthMap) {
    let mut open: Option<Run> = None;
    for (class, p) in points {
        let at = [p[0], p[1]];
        if !depth.sees(p, SLACK_PX) {
            runs.extend(open.take());
            continue;
        }
        match &mut open {
            Some((c, run)) => {
                run.push(at);
                if *c != class {
                    runs.extend(open.replace((class, vec![at])));
                }
            }
            None => open = Some((class, vec![at])),
        }
    }
    runs.extend(open);
    runs.retain(|(_, run)| run.len() > 1);
}

/// Leaves out points that lie on the line of their neighbours, within a quarter pixel or as much more as the bound on
/// points needs.
fn thin(runs: Vec<Run>) -> Vec<Run> {
    let mut slack = 0.25;
    loop {
        let out: Vec<Run> = runs.iter().map(|(c, run)| (*c, straightened(run, slack))).collect();
        let points: usize = out.iter().map(|(_, run)| run.len()).sum();
        // At two points a run nothing more can be left out.
        if points <= LINE_POINTS.max(2 * runs.len()) || slack > 1e4 {
            return out;
        }
        slack *= 1.6;
    }
}

/// Douglas and Peucker's thinning, without recursion.
fn straightened(run: &[[f64; 2]], slack: f64) -> Vec<[f64; 2]> {
    let mut keep = vec![false; run.len()];
    let mut open = vec![(0, run.len().saturating_sub(1))];
    while let Some((from, to)) = open.pop() {
        keep[from] = true;
        keep[to] = true;
        let (a, b) = (run[from], run[to]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        let off = |p: [f64; 2]| {
            let (px, py) = (p[0] - a[0], p[1] - a[1]);
            if length > 0.0 { (px * dy - py * dx).abs() / length } else { px.hypot(py) }
        };
        let far = (from + 1..to).max_by(|&i, &j| off(run[i]).total_cmp(&off(run[j])));
        if let Some(far) = far.filter(|&i| off(run[i]) > slack) {
            open.push((from, far));
            open.push((far, to));
        }
    }
    run.iter().zip(keep).filter(|(_, k)| *k).map(|(p, _)| *p).collect()
}

fn polyline(d: &mut String, run: &[[f64; 2]]) {
    let points: Vec<[i64; 2]> = run.iter().map(|p| p.map(|x| (2.0 * x).round() as i64)).collect();
    let Some(first) = points.first() else { return };
    let _ = write!(d, "M{} {}", first[0], first[1]);
    for (i, pair) in points.windows(2).enumerate() {
        step(d, if i == 0 { 'l' } else { ' ' }, pair[0], pair[1]);
    }
}

/// Title, legends, scale bar and caption.
fn furniture(
    out: &mut String,
    report: &Report,
    camera: &Camera,
    legends: &[&Scale],
    [width, height]: [f64; 2],
    [shown, passes]: [usize; 2],
) {
    let _ = write!(
        out,
        "<text x=\"22\" y=\"30\" font-size=\"16\" font-weight=\"600\">{}</text>",
        escape(&report.title)
    );
    for (i, scale) in legends.iter().enumerate() {
        let x = width - 104.0 * (legends.len() - i) as f64 - 4.0;
        let unit = if scale.unit.is_empty() { String::new() } else { format!(", {}", scale.unit) };
        let _ = write!(
            out,
            "<text x=\"{x}\" y=\"56\" font-weight=\"600\">{}{}</text><g transform=\"translate({x} 70)\">{}</g>",
            escape(&scale.name),
            escape(&unit),
            scale.bar((height - 130.0).clamp(60.0, 320.0))
        );
    }
    let long = super::legend::nice_step(60.0 / camera.scale);
    let (from, base) = (22.0, height - 18.0);
    let to = from + long * camera.scale;
    let mut caption = String::new();
    if passes > 0 {
        let _ = match shown {
            0 => write!(caption, "{passes} passes"),
            _ if shown < passes => write!(caption, "{shown} of {passes} passes drawn"),
            _ => write!(caption, "{passes} passes"),
        };
    }
    if let Some(tool) = &report.tool {
        let _ = write!(caption, "{}{}", if caption.is_empty() { "" } else { ", " }, tool.label);
    }
    let _ = write!(
        out,
        "<path d=\"M{from} {}v6h{}v-6\" fill=\"none\" stroke=\"currentColor\"/><text x=\"{}\" y=\"{base}\">{} mm</text>\
         <text x=\"{}\" y=\"{base}\" text-anchor=\"end\">{}</text>",
        coordinate(base - 7.0),
        coordinate(to - from),
        coordinate(to + 8.0),
        figure(long, 1),
        width - 22.0,
        escape(&caption)
    );
}
