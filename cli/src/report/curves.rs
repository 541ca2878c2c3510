//! Curves over one abscissa as an SVG file of its own: panels one below the other, each with axes, limits and a legend.
//!
//! Curves are drawn solid up to a place and dashed from there on; points that are no numbers break them. What leaves the frame is
//! cut off. Same curves, same bytes.

use super::chart::Axis;
use super::text::{coordinate, escape, short};
use std::fmt::Write;

/// Colours that those who see fewer of them tell apart too (Okabe & Ito), without the yellow that white drowns.
const COLOURS: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f"];

/// The page and the frame of a panel, px.
const WIDTH: f64 = 920.0;
const HEIGHT: f64 = 340.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 330.0;
const TOP: f64 = 46.0;
const BOTTOM: f64 = 46.0;
/// A line of the legend, px, and the letters that fit into one.
const ROW: f64 = 15.0;
const LETTERS: usize = 45;
/// Decades up to which a logarithmic axis has marks at 2 and 5 too.
const FEW_DECADES: f64 = 2.5;

/// A line with its name.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// Its name in the legend, and in `data-curve`.
    pub name: String,
    /// What is to be known about it, in the legend below the name.
    pub note: String,
    /// Points in rising x.
    pub points: Vec<[f64; 2]>,
    /// Dashed from this x on.
    pub dashed_from: Option<f64>,
    /// Place in the list of colours.
    pub colour: usize,
    /// Drawn bold: the one that the others are beside.
    pub bold: bool,
}

/// A value that is marked across the frame.
#[derive(Clone, Debug)]
pub struct Limit {
    /// The value.
    pub value: f64,
    /// Its name.
    pub name: String,
}

/// One frame with its curves.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// The heading.
    pub title: String,
    /// Name and unit of the abscissa and of the ordinate.
    pub axes: [String; 2],
    /// The curves.
    pub curves: Vec<Curve>,
    /// Marked values of the ordinate.
    pub limits: Vec<Limit>,
    /// Marked points, with the curves' colour of the given place.
    pub dots: Vec<([f64; 2], usize)>,
    /// The range of the ordinate; that of curves and limits where not given.
    pub range: Option<[f64; 2]>,
    /// A logarithmic ordinate.
    pub logarithmic: bool,
    /// Lines of text at the end of the legend.
    pub notes: Vec<String>,
}

/// Where the values of a panel lie.
struct Frame {
    x: Axis,
    y: Axis,
    logarithmic: bool,
}

impl Frame {
    fn value(&self, y: f64) -> f64 {
        if self.logarithmic { y.log10() } else { y }
    }

    /// On the page, also outside the frame; not finite where the value is not.
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let on = |a: &Axis, v: f64| a.from + (a.to - a.from) * (v - a.lo) / (a.hi - a.lo);
        [on(&self.x, x), on(&self.y, self.value(y))]
    }
}

/// Least and greatest of finite numbers, None without any.
fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let [lo, hi] = values
        .filter(|v| v.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
    (lo <= hi).then_some([lo, hi])
}

/// A range that is no point, with some room at both ends.
fn roomy([lo, hi]: [f64; 2], share: f64) -> [f64; 2] {
    let room = if hi > lo { share * (hi - lo) } else { 0.5 * hi.abs().max(1e-6) };
    [lo - room, hi + room]
}

fn frame(p: &Panel, top: f64) -> Option<Frame> {
    let value = |y: f64| if p.logarithmic { y.log10() } else { y };
    let points = || p.curves.iter().flat_map(|c| &c.points);
    let [x0, x1] = range(points().map(|q| q[0]))?;
    let limits = p.limits.iter().map(|l| value(l.value));
    let given = p.range.map(|r| r.map(value));
    let [y0, y1] = match given {
        Some(given) => given,
        None => roomy(range(points().map(|q| value(q[1])).chain(limits))?, 0.05),
    };
    let [x0, x1] = if x1 > x0 { [x0, x1] } else { roomy([x0, x1], 0.0) };
    let x = Axis { lo: x0, hi: x1, from: LEFT, to: WIDTH - RIGHT };
    let y = Axis { lo: y0, hi: y1, from: top + HEIGHT - BOTTOM, to: top + TOP };
    Some(Frame { x, y, logarithmic: p.logarithmic })
}

/// Values of the ordinate with a line.
fn levels(f: &Frame) -> Vec<f64> {
    if !f.logarithmic {
        return f.y.ticks(6.0);
    }
    let steps: &[f64] = if f.y.hi - f.y.lo <= FEW_DECADES { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let decades = f.y.lo.floor().max(-300.0) as i32..=f.y.hi.ceil().min(300.0) as i32;
    let all = decades.flat_map(|d| steps.iter().map(move |s| s * 10f64.powi(d)));
    all.filter(|v| (f.y.lo..=f.y.hi).contains(&v.log10())).collect()
}

/// Path data of the points for which `wanted` holds.
fn path(f: &Frame, points: &[[f64; 2]], wanted: impl Fn(usize) -> bool) -> String {
    let mut d = String::new();
    let mut pen = 'M';
    for (k, p) in points.iter().enumerate() {
        let at = f.place(*p);
        if wanted(k) && at.iter().all(|c| c.is_finite()) {
            // Writing to a String cannot fail.
            let _ = write!(d, "{pen}{} {}", coordinate(at[0]), coordinate(at[1]));
            pen = 'L';
        } else {
            pen = 'M';
        }
    }
    d
}

/// Words in lines of no more than so many letters.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < LETTERS => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn curve(out: &mut String, f: &Frame, c: &Curve) {
    let first = c
        .dashed_from
        .map_or(c.points.len(), |x| c.points.iter().position(|p| p[0] >= x).unwrap_or(c.points.len()));
    // Both parts share the point at which the dashes begin.
    let parts = [path(f, &c.points, |k| k <= first), path(f, &c.points, |k| k >= first)];
    let (colour, width) = (COLOURS[c.colour % COLOURS.len()], if c.bold { 2.6 } else { 1.4 });
    let _ =
        write!(out, "<g data-curve=\"{}\" stroke=\"{colour}\" stroke-width=\"{width}\">", escape(&c.name));
    for (d, dash) in parts.iter().zip(["", " stroke-dasharray=\"5 4\""]) {
        if d.contains('L') {
            let _ = write!(out, "<path d=\"{d}\"{dash}/>");
        }
    }
    out.push_str("</g>\n");
}

fn legend(out: &mut String, p: &Panel, top: f64) -> f64 {
    let x = WIDTH - RIGHT + 14.0;
    let mut y = top + TOP + 8.0;
    for c in &p.curves {
        let (colour, width) = (COLOURS[c.colour % COLOURS.len()], if c.bold { 2.6 } else { 1.4 });
        let bold = if c.bold { " font-weight=\"bold\"" } else { "" };
        let _ = writeln!(
            out,
            "<path d=\"M{x} {}h20\" stroke=\"{colour}\" stroke-width=\"{width}\"/><text x=\"{}\" y=\"{}\"{bold}>{}</text>",
            coordinate(y - 4.0),
            x + 26.0,
            coordinate(y),
            escape(&c.name)
        );
        y += ROW;
        for line in wrapped(&c.note) {
            let _ = writeln!(
                out,
                "<text class=\"n\" x=\"{}\" y=\"{}\">{}</text>",
                x + 26.0,
                coordinate(y - 2.0),
                escape(&line)
            );
            y += ROW - 2.0;
        }
    }
    y += 4.0;
    for line in p.notes.iter().flat_map(|n| wrapped(n)) {
        let _ = writeln!(out, "<text class=\"n\" x=\"{x}\" y=\"{}\">{}</text>", coordinate(y), escape(&line));
        y += ROW - 2.0;
    }
    y
}

/// A panel from `top` on; where it ends.
fn panel(out: &mut String, p: &Panel, top: f64, number: usize) -> f64 {
    let low = top + HEIGHT - BOTTOM;
    let (right, high) = (WIDTH - RIGHT, top + TOP);
    let _ = writeln!(
        out,
        "<text x=\"{LEFT}\" y=\"{}\" font-size=\"14\" font-weight=\"bold\">{}</text>",
        top + 18.0,
        escape(&p.title)
    );
    if let Some(f) = frame(p, top) {
        for level in levels(&f) {
            let at = coordinate(f.place([f.x.lo, level])[1]);
            let _ = writeln!(
                out,
                "<path class=\"g\" d=\"M{LEFT} {at}H{right}\"/><text x=\"{}\" y=\"{at}\" dy=\".35em\" text-anchor=\"end\">{}</text>",
                LEFT - 6.0,
                short(level, 4)
            );
        }
        for tick in f.x.ticks(8.0) {
            let at = coordinate(f.x.at(tick));
            let _ = writeln!(
                out,
                "<path class=\"g\" d=\"M{at} {high}V{low}\"/><text x=\"{at}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                low + 16.0,
                short(tick, 4)
            );
        }
        let (wide, tall) = (right - LEFT, low - high);
        let _ = writeln!(
            out,
            "<rect class=\"f\" x=\"{LEFT}\" y=\"{high}\" width=\"{wide}\" height=\"{tall}\"/>\n\
             <clipPath id=\"c{number}\"><rect x=\"{LEFT}\" y=\"{high}\" width=\"{wide}\" height=\"{tall}\"/></clipPath>\n\
             <g clip-path=\"url(#c{number})\" stroke-linejoin=\"round\">"
        );
        for l in &p.limits {
            let at = coordinate(f.place([f.x.lo, l.value])[1]);
            // Writing to a String cannot fail.
            let _ = writeln!(
                out,
                "<path d=\"M{LEFT} {at}H{right}\" stroke=\"#b3122b\" stroke-dasharray=\"2 3\"/>\
                 <text class=\"l\" x=\"{}\" y=\"{at}\" dy=\"-3\" text-anchor=\"end\">{}</text>",
                right - 4.0,
                escape(&l.name)
            );
        }
        p.curves.iter().for_each(|c| curve(out, &f, c));
        for (at, colour) in &p.dots {
            let [x, y] = f.place(*at).map(coordinate);
            let _ = writeln!(
                out,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"4.5\" fill=\"{}\" stroke=\"#fff\"/>",
                COLOURS[colour % COLOURS.len()]
            );
        }
        out.push_str("</g>\n");
    }
    let [x_title, y_title] = &p.axes;
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text><text x=\"{LEFT}\" y=\"{}\">{}</text>",
        0.5 * (LEFT + right),
        top + HEIGHT - 8.0,
        escape(x_title),
        high - 8.0,
        escape(y_title)
    );
    legend(out, p, top).max(top + HEIGHT)
}

/// The file of some panels.
#[must_use]
pub fn svg(title: &str, panels: &[Panel]) -> String {
    let mut body = String::new();
    let mut height = 0.0;
    for (k, p) in panels.iter().enumerate() {
        height = panel(&mut body, p, height, k) + 12.0;
    }
    let height = coordinate(height);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
         fill=\"none\" font-family=\"Helvetica,Arial,sans-serif\" font-size=\"12\">\n<title>{}</title>\n\
         <style>text{{fill:#222}}.n{{fill:#555;font-size:11px}}.l{{fill:#b3122b;font-size:11px}}.g{{stroke:#e4e4e4}}\
         .f{{stroke:#888}}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{body}</svg>\n",
        escape(title)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[[f64; 2]]) -> Curve {
        Curve { name: "a<b".into(), points: points.to_vec(), ..Curve::default() }
    }

    #[test]
    fn curves_break_at_gaps_and_turn_to_dashes() {
        let gap = line(&[[0.0, 1.0], [1.0, 2.0], [2.0, f64::NAN], [3.0, 1.0], [4.0, 2.0]]);
        let page = |c: Curve| svg("t", &[Panel { curves: vec![c], ..Panel::default() }]);
        let text = page(gap);
        assert!(text.contains("data-curve=\"a&lt;b\"") && !text.contains("NaN"));
        let d = text.split("<path d=\"M").nth(1).and_then(|t| t.split('"').next()).unwrap_or_default();
        assert_eq!(d.matches('M').count(), 1, "{d}");
        let text = page(Curve { dashed_from: Some(1.0), ..line(&[[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]]) });
        assert_eq!(text.matches("stroke-dasharray").count(), 1);
        // Two parts of one segment each.
        let group =
            text.split("<g data-curve").nth(1).and_then(|t| t.split("</g>").next()).unwrap_or_default();
        assert_eq!((group.matches('M').count(), group.matches('L').count()), (2, 2), "{group}");
    }

    #[test]
    fn without_numbers_there_are_words_and_no_frame() {
        let empty = Panel { notes: vec!["nothing to draw".into()], ..Panel::default() };
        let text = svg("t", &[empty]);
        assert!(text.contains("nothing to draw") && !text.contains("class=\"f\""));
        let one = svg("t", &[Panel { curves: vec![line(&[[1.0, 1.0]])], ..Panel::default() }]);
        assert!(!one.contains("NaN") && !one.contains("inf"));
    }

    #[test]
    fn logarithmic_axes_have_round_levels() {
        let p =
            Panel { curves: vec![line(&[[0.0, 8.0], [1.0, 60.0]])], logarithmic: true, ..Panel::default() };
        let f = frame(&p, 0.0).map(|f| levels(&f));
        assert_eq!(f, Some(vec![10.0, 20.0, 50.0]));
    }
}
