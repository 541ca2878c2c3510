//! One figure: what is drawn, with which pen, and what the legend says.

use super::drawing::{Anchor, Drawing, Mark, Pen, Type, letters, pen};
use super::scene::{Place, Scene, length};
use super::study::{Levels, Study};
use crate::report::legend::nice_step;
use crate::report::text::short;
use osculate_geom::{Point3, Vec3};
use osculate_surfaces::lines::{Contour, CriticalKind, Family, SurfacePolyline, UmbilicKind};

/// The figures, a to f as in the paper, and one more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Panel {
    /// a: lines of constant parameter.
    ParameterNet,
    /// b: control net of the Bezier patches.
    BezierNet,
    /// c: lines of curvature and umbilics.
    Curvature,
    /// d: lines of constant difference of the principal curvatures.
    Difference,
    /// e: contour lines.
    Contours,
    /// f: gradient lines.
    Gradients,
    /// g: ridges, parabolic and asymptotic lines.
    Features,
}

impl Panel {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::ParameterNet,
        Self::BezierNet,
        Self::Curvature,
        Self::Difference,
        Self::Contours,
        Self::Gradients,
        Self::Features,
    ];

    /// The letter in front of the caption.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::ParameterNet => "a",
            Self::BezierNet => "b",
            Self::Curvature => "c",
            Self::Difference => "d",
            Self::Contours => "e",
            Self::Gradients => "f",
            Self::Features => "g",
        }
    }

    /// The file's name, without its ending.
    pub const fn file(self) -> &'static str {
        match self {
            Self::ParameterNet => "a-parameter-net",
            Self::BezierNet => "b-bezier-net",
            Self::Curvature => "c-lines-of-curvature",
            Self::Difference => "d-constant-difference",
            Self::Contours => "e-contours",
            Self::Gradients => "f-gradients",
            Self::Features => "g-features",
        }
    }

    /// Whether the face has what the figure shows.
    pub const fn applies(self, study: &Study) -> bool {
        !matches!(self, Self::BezierNet) || !study.bezier.is_empty()
    }

    fn caption(self, study: &Study) -> String {
        let along = axis_name(study);
        match self {
            Self::ParameterNet => "lines of constant u and v".to_owned(),
            Self::BezierNet => match study.bezier.len() {
                1 => "Bezier net".to_owned(),
                n => format!("Bezier nets of {n} patches"),
            },
            Self::Curvature => "lines of curvature".to_owned(),
            Self::Difference => "constant difference of the principal curvatures".to_owned(),
            Self::Contours => format!("contours along {along}"),
            Self::Gradients => format!("gradient lines along {along}"),
            Self::Features => "ridges, parabolic and asymptotic lines".to_owned(),
        }
    }
}

/// The tool axis in words.
fn axis_name(study: &Study) -> String {
    let a = study.axis;
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        if (a[k] - 1.0).abs() < 1e-12 {
            return name.to_owned();
        }
        if (a[k] + 1.0).abs() < 1e-12 {
            return format!("\u{2212}{name}");
        }
    }
    format!("({}, {}, {})", short(a.x, 3), short(a.y, 3), short(a.z, 3))
}

/// Width of a figure, px.
pub const WIDTH: f64 = 440.0;
/// Height of a figure with its caption, px.
pub const HEIGHT: f64 = 396.0;
/// Where the face is drawn: left, top, width, height.
pub const FRAME: [f64; 4] = [16.0, 14.0, 408.0, 306.0];
/// Length of a colour bar beside the face, px.
pub const BAR_LENGTH: f64 = 150.0;
/// Where it stands.
pub const BAR_AT: [f64; 2] = [FRAME[0] + FRAME[2] - 70.0, FRAME[1]];

const INK: &str = "#222";
const MOST: &str = "#17477e";
const LEAST: &str = "#c2703d";
const LEVEL: &str = "#2a6f6a";
const HEIGHT_LINE: &str = "#6b4f1d";
const FLOW: &str = "#3c3c78";
const FAINT: &str = "#9a9a9a";

/// A line of the legend.
enum Key {
    Line(Pen, String),
    Mark(Mark, String),
    Text(String),
}

/// A figure.
pub fn draw(study: &Study, scene: &Scene, panel: Panel) -> Drawing {
    let mut d = Drawing::default();
    let mut keys = Vec::new();
    if panel == Panel::ParameterNet {
        shade(&mut d, study, scene);
    }
    let outline = if panel == Panel::BezierNet { pen(FAINT, 0.7) } else { pen(INK, 1.1) };
    match panel {
        Panel::ParameterNet => {
            let [u, v] = &study.net;
            d.lines(&seen(scene, u), pen(MOST, 0.6));
            d.lines(&seen(scene, v), pen(LEAST, 0.6));
            keys.push(Key::Line(pen(MOST, 1.2), "u = const".to_owned()));
            keys.push(Key::Line(pen(LEAST, 1.2), "v = const".to_owned()));
        }
        Panel::BezierNet => bezier(&mut d, study, scene, &mut keys),
        Panel::Curvature => curvature(&mut d, study, scene, &mut keys),
        Panel::Difference => difference(&mut d, study, scene, &mut keys),
        Panel::Contours => {
            levels(&mut d, scene, &study.heights, &study.heights.values, HEIGHT_LINE);
            keys.push(Key::Text(step_text("height", &study.heights.values, "mm")));
            height_marks(&mut d, study, scene, &mut keys);
        }
        Panel::Gradients => {
            let lines: Vec<_> = study.gradients.iter().flat_map(|l| scene.visible(points(l))).collect();
            d.lines(&lines, pen(FLOW, 0.7));
            keys.push(Key::Line(pen(FLOW, 1.0), "steepest ascent".to_owned()));
            height_marks(&mut d, study, scene, &mut keys);
        }
        Panel::Features => features(&mut d, study, scene, &mut keys),
    }
    d.lines(&seen(scene, &study.silhouette(&scene.toward())), pen(outline.colour, 0.8 * outline.width));
    let hidden: Vec<_> = study.borders.iter().flat_map(|b| scene.hidden(b.iter().copied())).collect();
    d.lines(&hidden, Pen { colour: FAINT, width: 0.6, dashes: "2.5 2.5" });
    d.lines(&seen(scene, &study.borders), outline);
    ornaments(&mut d, study, scene);
    legend(&mut d, panel, study, &keys);
    d
}

/// The points of a line, closed where it closes.
fn points(line: &SurfacePolyline) -> impl Iterator<Item = Point3> + '_ {
    let again = line.is_closed().then(|| line.points[0].point);
    line.points.iter().map(|p| p.point).chain(again)
}

/// The pieces of lines on the face that are seen.
pub fn seen(scene: &Scene, lines: &[Vec<Point3>]) -> Vec<Vec<Place>> {
    lines.iter().flat_map(|l| scene.visible(l.iter().copied())).collect()
}

/// The face in light greys, from far to near.
fn shade(d: &mut Drawing, study: &Study, scene: &Scene) {
    let p = |k: u32| Point3::from(study.coarse.positions[k as usize]);
    let mut facets: Vec<(f64, [Point3; 3])> = study
        .coarse
        .triangles
        .iter()
        .map(|t| {
            let c = t.map(p);
            (c.iter().map(|p| scene.nearness(p)).sum::<f64>(), c)
        })
        .collect();
    facets.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, c) in facets {
        let n = (c[1] - c[0]).cross(&(c[2] - c[0]));
        if n.norm() <= 0.0 {
            continue;
        }
        // Sixteen greys: neighbours that share one need no seam.
        let grey = 208 + 3 * (scene.light(&n) * 15.0).round() as i64;
        d.area(&c.map(|p| scene.place(&p)), &format!("#{grey:02x}{grey:02x}{grey:02x}"));
    }
}

fn bezier(d: &mut Drawing, study: &Study, scene: &Scene, keys: &mut Vec<Key>) {
    let grid: Vec<_> = study.net.iter().flat_map(|n| seen(scene, n)).collect();
    d.lines(&grid, pen("#cfcfcf", 0.5));
    let mut net = Vec::new();
    let mut dots = Vec::new();
    for patch in &study.bezier {
        let [n, m] = patch.net.count;
        let at = |i: usize, j: usize| scene.place(&patch.net.points[i * m + j]);
        net.extend((0..n).map(|i| (0..m).map(|j| at(i, j)).collect::<Vec<_>>()));
        net.extend((0..m).map(|j| (0..n).map(|i| at(i, j)).collect::<Vec<_>>()));
        dots.extend((0..n * m).map(|k| at(k / m, k % m)));
    }
    d.lines(&net, pen(MOST, 0.9));
    let few = dots.len() <= 400;
    for p in dots {
        d.disc(p, if few { 2.6 } else { 1.4 }, MOST, pen("#fff", 0.5));
    }
    keys.push(Key::Line(pen(MOST, 1.0), "control points and their net".to_owned()));
    keys.push(Key::Line(pen("#cfcfcf", 1.2), "surface".to_owned()));
}

fn curvature(d: &mut Drawing, study: &Study, scene: &Scene, keys: &mut Vec<Key>) {
    let lines =
        |k: usize| -> Vec<_> { study.curvature[k].iter().flat_map(|l| scene.visible(points(l))).collect() };
    d.lines(&lines(1), pen(LEAST, 0.5));
    d.lines(&lines(0), pen(MOST, 0.9));
    keys.push(Key::Line(pen(MOST, 1.2), "along k\u{2081}, most convex".to_owned()));
    keys.push(Key::Line(pen(LEAST, 0.8), "along k\u{2082}".to_owned()));
    umbilic_marks(d, study, scene, keys);
}

fn difference(d: &mut Drawing, study: &Study, scene: &Scene, keys: &mut Vec<Key>) {
    levels(d, scene, &study.difference, &study.difference.values, LEVEL);
    keys.push(Key::Text(step_text("k\u{2081} \u{2212} k\u{2082}", &study.difference.values, "1/mm")));
    let extremes = study.difference_extremes().map(|c| (c.point, c.kind));
    critical_marks(d, scene, extremes, keys);
    umbilic_marks(d, study, scene, keys);
}

fn features(d: &mut Drawing, study: &Study, scene: &Scene, keys: &mut Vec<Key>) {
    let thin: Vec<_> = study.asymptotic.iter().flatten().flat_map(|l| scene.visible(points(l))).collect();
    if !thin.is_empty() {
        d.lines(&thin, pen(FAINT, 0.5));
        keys.push(Key::Line(pen(FAINT, 0.9), "asymptotic".to_owned()));
    }
    let parabolic: Vec<_> =
        study.parabolic.lines.iter().flat_map(|c| scene.visible(points(&c.line))).collect();
    if !parabolic.is_empty() {
        d.lines(&parabolic, pen(INK, 1.5));
        keys.push(Key::Line(pen(INK, 1.5), "parabolic".to_owned()));
    }
    for (family, colour, name) in
        [(Family::Most, MOST, "ridge of k\u{2081}"), (Family::Least, LEAST, "ridge of k\u{2082}")]
    {
        for (crest, width) in [(false, 1.0), (true, 2.4)] {
            let lines: Vec<_> = study
                .ridges
                .iter()
                .filter(|r| r.family == family && r.crest == crest)
                .flat_map(|r| scene.visible(points(&r.line)))
                .collect();
            if !lines.is_empty() {
                d.lines(&lines, pen(colour, width));
                let name = if crest { format!("{name}, crest") } else { name.to_owned() };
                keys.push(Key::Line(pen(colour, width), name));
            }
        }
    }
    if keys.is_empty() {
        keys.push(Key::Text("there are none".to_owned()));
    }
    umbilic_marks(d, study, scene, keys);
}

/// Level lines with their values; every fifth is drawn stronger.
fn levels(d: &mut Drawing, scene: &Scene, field: &Levels, values: &[f64], colour: &'static str) {
    let step = if let [a, b, ..] = values { b - a } else { 1.0 };
    let mut taken: Vec<[f64; 4]> = Vec::new();
    let mut labels: Vec<(Place, f64, String)> = Vec::new();
    let (mut plain, mut strong) = (Vec::new(), Vec::new());
    for Contour { level, line } in &field.contours.lines {
        let value = nearest(values, *level);
        let pieces = scene.visible(points(line));
        if let Some(longest) = pieces.iter().max_by(|a, b| length(a).total_cmp(&length(b))) {
            label(longest, &short(value, 4), &mut taken, &mut labels);
        }
        let fifth = (value / step).round() as i64 % 5 == 0;
        if fifth { strong.extend(pieces) } else { plain.extend(pieces) }
    }
    d.lines(&plain, pen(colour, 0.7));
    d.lines(&strong, pen(colour, 1.3));
    for (at, turn_deg, text) in labels {
        let t = Type { anchor: Anchor::Middle, turn_deg, halo: true, colour, ..letters(9.0) };
        d.text(at, &text, t);
    }
}

/// The value that a contour stands for: itself, or the root of its square.
fn nearest(values: &[f64], level: f64) -> f64 {
    let root = level.max(0.0).sqrt();
    let close = |x: f64| values.iter().copied().find(|v| (v - x).abs() <= 1e-9 * (v.abs() + 1e-300));
    close(level).or_else(|| close(root)).unwrap_or(level)
}

/// A label on a line, upright along it, where there is room.
fn label(line: &[Place], text: &str, taken: &mut Vec<[f64; 4]>, out: &mut Vec<(Place, f64, String)>) {
    let width = 5.2 * text.chars().count() as f64 + 4.0;
    let whole = length(line);
    if whole < 1.6 * width {
        return;
    }
    for share in [0.5, 0.35, 0.65, 0.2, 0.8, 0.1, 0.9] {
        let (middle, Some(a), Some(b)) = (
            along(line, share * whole),
            along(line, share * whole - 0.5 * width),
            along(line, share * whole + 0.5 * width),
        ) else {
            continue;
        };
        let Some([x, y]) = middle else { continue };
        let chord = (b[0] - a[0]).hypot(b[1] - a[1]);
        // On a tight bend letters would leave the line.
        if chord < 0.85 * width {
            continue;
        }
        let r = 0.5 * width + 1.0;
        let own = [x - r, y - r, x + r, y + r];
        if taken.iter().any(|t| own[0] < t[2] && t[0] < own[2] && own[1] < t[3] && t[1] < own[3]) {
            continue;
        }
        let mut turn = (b[1] - a[1]).atan2(b[0] - a[0]).to_degrees();
        if turn > 90.0 {
            turn -= 180.0;
        } else if turn < -90.0 {
            turn += 180.0;
        }
        // Down by a third of the letters' height, across the line.
        let (s, c) = turn.to_radians().sin_cos();
        taken.push(own);
        out.push(([x - 3.0 * s, y + 3.0 * c], turn, text.to_owned()));
        return;
    }
}

/// The place at a length along a line.
fn along(line: &[Place], at: f64) -> Option<Place> {
    let mut left = at;
    if left < 0.0 {
        return None;
    }
    for w in line.windows(2) {
        let step = (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]);
        if left <= step {
            let t = if step > 0.0 { left / step } else { 0.0 };
            return Some([w[0][0] + t * (w[1][0] - w[0][0]), w[0][1] + t * (w[1][1] - w[0][1])]);
        }
        left -= step;
    }
    None
}

fn step_text(name: &str, values: &[f64], unit: &str) -> String {
    match values {
        [] => format!("{name} is constant"),
        [a] => format!("{name} = {} {unit}", short(*a, 4)),
        [a, b, ..] => {
            let last = values[values.len() - 1];
            format!(
                "{name} from {} to {} {unit} in steps of {}",
                short(*a, 4),
                short(last, 4),
                short(b - a, 3)
            )
        }
    }
}

fn umbilic_marks(d: &mut Drawing, study: &Study, scene: &Scene, keys: &mut Vec<Key>) {
    let mut shown = Vec::new();
    for u in study.umbilics.inside() {
        let (mark, name) = match u.kind {
            UmbilicKind::Lemon => (Mark::Lemon, "umbilic, lemon"),
            UmbilicKind::Monstar => (Mark::Monstar, "umbilic, monstar"),
            UmbilicKind::Star => (Mark::Star, "umbilic, star"),
            UmbilicKind::Degenerate => (Mark::Umbilic, "umbilic of higher index"),
        };
        if scene.sees(&u.point) {
            d.mark(scene.place(&u.point), mark);
            if !shown.contains(&name) {
                shown.push(name);
                keys.push(Key::Mark(mark, name.to_owned()));
            }
        }
    }
    if !study.umbilics.regions.is_empty() {
        keys.push(Key::Text("regions of umbilics".to_owned()));
    }
}

fn height_marks(d: &mut Drawing, study: &Study, scene: &Scene, keys: &mut Vec<Key>) {
    let all = study.heights.critical.points.iter().filter(|c| c.inside);
    critical_marks(d, scene, all.map(|c| (c.point, c.kind)), keys);
}

fn critical_marks(
    d: &mut Drawing,
    scene: &Scene,
    all: impl Iterator<Item = (Point3, CriticalKind)>,
    keys: &mut Vec<Key>,
) {
    let mut shown = Vec::new();
    for (point, kind) in all {
        let (mark, name) = match kind {
            CriticalKind::Minimum => (Mark::Minimum, "minimum"),
            CriticalKind::Maximum => (Mark::Maximum, "maximum"),
            CriticalKind::Saddle => (Mark::Saddle, "saddle"),
            CriticalKind::Degenerate => continue,
        };
        if scene.sees(&point) {
            d.mark(scene.place(&point), mark);
            if !shown.contains(&name) {
                shown.push(name);
                keys.push(Key::Mark(mark, name.to_owned()));
            }
        }
    }
}

/// The axes and the scale, in the lower corners.
pub fn ornaments(d: &mut Drawing, study: &Study, scene: &Scene) {
    let at = [34.0, FRAME[1] + FRAME[3] - 4.0];
    let o = scene.place(&Point3::origin());
    for (axis, name) in [(Vec3::x(), "x"), (Vec3::y(), "y"), (Vec3::z(), "z")] {
        let p = scene.place(&Point3::from(axis));
        let way = [(p[0] - o[0]) / scene.camera.scale, (p[1] - o[1]) / scene.camera.scale];
        let size = way[0].hypot(way[1]);
        // An axis towards the viewer has no arrow.
        if size < 0.15 {
            continue;
        }
        let tip = [at[0] + 20.0 * way[0], at[1] + 20.0 * way[1]];
        d.lines(&[vec![at, tip]], pen(INK, 0.8));
        let beyond =
            [at[0] + 20.0 * way[0] + 7.0 * way[0] / size, at[1] + 20.0 * way[1] + 7.0 * way[1] / size + 3.0];
        d.text(beyond, name, Type { anchor: Anchor::Middle, ..letters(9.5) });
    }
    let bar = nice_step(0.13 * study.size_mm);
    let wide = bar * scene.camera.scale;
    let (right, y) = (WIDTH - 18.0, FRAME[1] + FRAME[3] + 6.0);
    d.lines(&[vec![[right - wide, y - 3.0], [right - wide, y], [right, y], [right, y - 3.0]]], pen(INK, 0.8));
    let text = format!("{} mm", short(bar, 3));
    d.text([right - 0.5 * wide, y - 5.0], &text, Type { anchor: Anchor::Middle, ..letters(9.5) });
}

/// Caption and legend below the figure.
fn legend(d: &mut Drawing, panel: Panel, study: &Study, keys: &[Key]) {
    let top = FRAME[1] + FRAME[3] + 30.0;
    d.text([FRAME[0], top], panel.letter(), Type { bold: true, ..letters(13.0) });
    d.text([FRAME[0] + 16.0, top], &panel.caption(study), letters(13.0));
    let (mut x, mut y) = (FRAME[0] + 16.0, top + 18.0);
    for key in keys {
        let (lead, text) = match key {
            Key::Line(_, t) => (20.0, t),
            Key::Mark(_, t) => (13.0, t),
            Key::Text(t) => (0.0, t),
        };
        let width = lead + 5.9 * text.chars().count() as f64 + 12.0;
        if x + width > WIDTH && x > FRAME[0] + 16.0 {
            x = FRAME[0] + 16.0;
            y += 15.0;
        }
        match key {
            Key::Line(p, _) => d.lines(&[vec![[x, y - 3.5], [x + 15.0, y - 3.5]]], *p),
            Key::Mark(m, _) => d.mark([x + 5.0, y - 3.5], *m),
            Key::Text(_) => {}
        }
        d.text([x + lead, y], text, letters(10.5));
        x += width;
    }
}
