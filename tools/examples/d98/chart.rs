//! Plain SVG charts: lines over a linear abscissa, and maps of a value over a rectangle.

use std::fmt::Write;

/// A line with its name.
pub(crate) struct Series {
    pub name: String,
    /// Points in rising x; a NaN breaks the line.
    pub points: Vec<[f64; 2]>,
    /// Drawn dashed.
    pub dashed: bool,
}

const COLOURS: [&str; 6] = ["#c22", "#16c", "#283", "#a60", "#717", "#088"];
const SIZE: [f64; 2] = [720.0, 380.0];
const LEFT: f64 = 64.0;
const RIGHT: f64 = 150.0;
const TOP: f64 = 34.0;
const LOW: f64 = 44.0;

fn head(title: &str) -> String {
    let [w, h] = SIZE;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"white\"/>\n<text x=\"{LEFT}\" y=\"18\">{title}</text>\n"
    )
}

/// Round steps that divide a range into about six.
fn ticks(lo: f64, hi: f64) -> Vec<f64> {
    let raw = (hi - lo) / 6.0;
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|s| *s >= raw).unwrap_or(raw);
    let first = (lo / step).ceil() as i64;
    (first..=(hi / step).floor() as i64).map(|k| k as f64 * step).collect()
}

fn label(v: f64) -> String {
    let v = if v.abs() < 1e-12 { 0.0 } else { v };
    format!("{}", (v * 1e6).round() / 1e6)
}

/// Lines; a logarithmic ordinate where `log` is set.
pub(crate) fn lines(title: &str, axes: [&str; 2], series: &[Series], log: bool) -> String {
    let [w, h] = SIZE;
    let value = |y: f64| if log { y.log10() } else { y };
    let all = || series.iter().flat_map(|s| &s.points).filter(|p| value(p[1]).is_finite());
    let range = |f: &dyn Fn(&[f64; 2]) -> f64| {
        all().map(f).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let (x0, x1) = range(&|p| p[0]);
    let (mut y0, mut y1) = range(&|p| value(p[1]));
    if log {
        (y0, y1) = (y0.floor(), y1.ceil());
    } else {
        let margin = 0.05 * (y1 - y0).max(1e-9);
        (y0, y1) = (y0 - margin, y1 + margin);
    }
    let px = |x: f64| LEFT + (x - x0) / (x1 - x0) * (w - LEFT - RIGHT);
    let py = |y: f64| h - LOW - (y - y0) / (y1 - y0) * (h - LOW - TOP);
    let mut s = head(title);
    let levels = if log { (y0 as i64..=y1 as i64).map(|k| k as f64).collect() } else { ticks(y0, y1) };
    for level in levels {
        let name = if log { label(10f64.powf(level)) } else { label(level) };
        let at = py(level);
        let _ = writeln!(
            s,
            "<path d=\"M{LEFT} {at:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{name}</text>",
            w - RIGHT,
            LEFT - 6.0,
            at + 4.0
        );
    }
    for tick in ticks(x0, x1) {
        let at = px(tick);
        let _ = writeln!(
            s,
            "<path d=\"M{at:.1} {TOP}V{:.1}\" stroke=\"#eee\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            h - LOW,
            h - LOW + 16.0,
            label(tick)
        );
    }
    let [x_name, y_name] = axes;
    let _ = writeln!(
        s,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x_name}</text><text x=\"{LEFT}\" y=\"{:.1}\">{y_name}</text>",
        0.5 * (LEFT + w - RIGHT),
        h - 8.0,
        TOP - 4.0
    );
    for (k, line) in series.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let mut d = String::new();
        let mut pen = 'M';
        for p in &line.points {
            if value(p[1]).is_finite() {
                let _ = write!(d, "{pen}{:.1} {:.1}", px(p[0]), py(value(p[1])));
                pen = 'L';
            } else {
                pen = 'M';
            }
        }
        let dash = if line.dashed { " stroke-dasharray=\"5 4\"" } else { "" };
        let y = TOP + 14.0 + 17.0 * k as f64;
        let _ = writeln!(
            s,
            "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"{dash}/>\n\
             <path d=\"M{0:.1} {1:.1}h18\" stroke=\"{colour}\" stroke-width=\"1.5\"{dash}/><text x=\"{2:.1}\" y=\"{3:.1}\">{4}</text>",
            w - RIGHT + 8.0,
            y - 4.0,
            w - RIGHT + 30.0,
            y,
            line.name
        );
    }
    s.push_str("</svg>\n");
    s
}

/// A map over a rectangle: gouges red, material left blue, white at zero, the scale in both colours to `scale`.
pub(crate) struct Map<'a> {
    pub title: &'a str,
    pub axes: [&'a str; 2],
    pub x: [f64; 2],
    pub y: [f64; 2],
    pub scale: f64,
}

/// The map of `f` on a grid of cells.
pub(crate) fn map(m: &Map<'_>, f: impl Fn(f64, f64) -> f64) -> String {
    const CELLS: [usize; 2] = [80, 48];
    let [w, h] = SIZE;
    let (wide, high) = ((w - LEFT - RIGHT) / CELLS[0] as f64, (h - LOW - TOP) / CELLS[1] as f64);
    let mut s = head(m.title);
    let colour = |d: f64| {
        // Sixteen shades: neighbouring cells of one shade are drawn as one.
        let t = ((d.abs() / m.scale).min(1.0).sqrt() * 16.0).round() / 16.0;
        let (full, pale) = (255.0, 255.0 * (1.0 - t));
        let (r, g, b) = if d < 0.0 { (full, pale, pale) } else { (pale, pale, full) };
        format!("#{:02x}{:02x}{:02x}", r as u8, g as u8, b as u8)
    };
    for j in 0..CELLS[1] {
        let y = m.y[0] + (m.y[1] - m.y[0]) * (j as f64 + 0.5) / CELLS[1] as f64;
        let shade = |i: usize| colour(f(m.x[0] + (m.x[1] - m.x[0]) * (i as f64 + 0.5) / CELLS[0] as f64, y));
        let shades: Vec<String> = (0..CELLS[0]).map(shade).collect();
        let mut first = 0;
        for run in shades.chunk_by(|a, b| a == b) {
            let _ = writeln!(
                s,
                "<path d=\"M{:.1} {:.1}h{:.1}v{:.1}h-{2:.1}z\" fill=\"{}\"/>",
                LEFT + wide * first as f64,
                h - LOW - high * (j + 1) as f64,
                wide * run.len() as f64 + 0.1,
                high + 0.1,
                run[0]
            );
            first += run.len();
        }
    }
    for tick in ticks(m.x[0], m.x[1]) {
        let at = LEFT + (tick - m.x[0]) / (m.x[1] - m.x[0]) * (w - LEFT - RIGHT);
        let _ = writeln!(
            s,
            "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            h - LOW + 16.0,
            label(tick)
        );
    }
    for tick in ticks(m.y[0], m.y[1]) {
        let at = h - LOW - (tick - m.y[0]) / (m.y[1] - m.y[0]) * (h - LOW - TOP);
        let _ = writeln!(
            s,
            "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            LEFT - 6.0,
            at + 4.0,
            label(tick)
        );
    }
    let [x_name, y_name] = m.axes;
    let _ = writeln!(
        s,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x_name}</text><text x=\"{LEFT}\" y=\"{:.1}\">{y_name}</text>",
        0.5 * (LEFT + w - RIGHT),
        h - 8.0,
        TOP - 4.0
    );
    for (k, d) in [-1.0, -0.25, 0.0, 0.25, 1.0].into_iter().enumerate() {
        let y = TOP + 22.0 * k as f64;
        let _ = writeln!(
            s,
            "<rect x=\"{:.1}\" y=\"{y:.1}\" width=\"18\" height=\"18\" fill=\"{}\" stroke=\"#999\"/><text x=\"{:.1}\" y=\"{:.1}\">{} mm</text>",
            w - RIGHT + 12.0,
            colour(d * m.scale),
            w - RIGHT + 36.0,
            y + 13.0,
            label(d * m.scale)
        );
    }
    s.push_str("</svg>\n");
    s
}
