//! SVG, written compactly: lines in tenths of a pixel relative to the point before, thinned out first.

use super::scene::Place;
use crate::report::text::escape;
use std::fmt::Write;

/// How a line looks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Pen {
    /// Colour.
    pub colour: &'static str,
    /// Width, px.
    pub width: f64,
    /// Dashes, px, empty for none.
    pub dashes: &'static str,
}

/// A pen without dashes.
pub const fn pen(colour: &'static str, width: f64) -> Pen {
    Pen { colour, width, dashes: "" }
}

/// Where a text is anchored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Anchor {
    /// At its start.
    Start,
    /// At its middle.
    Middle,
}

/// How a text is set.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Type {
    /// Size, px.
    pub size: f64,
    /// Where it is anchored.
    pub anchor: Anchor,
    /// Turn, degrees clockwise.
    pub turn_deg: f64,
    /// Whether a white rim sets it off the lines below.
    pub halo: bool,
    /// Colour.
    pub colour: &'static str,
    /// Bold.
    pub bold: bool,
}

/// The usual type.
pub const fn letters(size: f64) -> Type {
    Type { size, anchor: Anchor::Start, turn_deg: 0.0, halo: false, colour: "#222", bold: false }
}

/// Marks of special points, in the manner of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mark {
    /// Umbilic of index +1/2 with one line of each family: a disc.
    Lemon,
    /// Umbilic of index +1/2 with three: a ring around a disc.
    Monstar,
    /// Umbilic of index -1/2: a star.
    Star,
    /// Another umbilic: a disc with a cross.
    Umbilic,
    /// Minimum: a triangle downwards.
    Minimum,
    /// Maximum: a triangle upwards.
    Maximum,
    /// Saddle: a cross.
    Saddle,
}

/// An SVG under way.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    body: String,
}

/// Points are dropped that lie nearer than this to the line through their neighbours, px.
const THIN: f64 = 0.12;

impl Drawing {
    /// Lines with one pen, as one path.
    pub fn lines(&mut self, lines: &[Vec<Place>], pen: Pen) {
        let d: String = lines.iter().filter(|l| l.len() > 1).map(|l| path(l, false)).collect();
        if d.is_empty() {
            return;
        }
        let dashes = if pen.dashes.is_empty() {
            String::new()
        } else {
            // In tenths, as everything within the group.
            let tenths: Vec<String> = pen
                .dashes
                .split(' ')
                .filter_map(|x| x.parse::<f64>().ok())
                .map(|x| format!("{}", 10.0 * x))
                .collect();
            format!(" stroke-dasharray=\"{}\"", tenths.join(" "))
        };
        // Writing to a String cannot fail.
        let _ = writeln!(
            self.body,
            "<path d=\"{d}\" stroke=\"{}\" stroke-width=\"{}\"{dashes}/>",
            pen.colour,
            tenths(pen.width)
        );
    }

    /// A filled area.
    pub fn area(&mut self, outline: &[Place], fill: &str) {
        self.areas([outline], fill);
    }

    /// Areas filled alike, as one path.
    pub fn areas<'a>(&mut self, outlines: impl IntoIterator<Item = &'a [Place]>, fill: &str) {
        let d: String = outlines.into_iter().map(|outline| path(outline, true)).collect();
        let _ = writeln!(self.body, "<path d=\"{d}\" fill=\"{fill}\" stroke=\"{fill}\" stroke-width=\"4\"/>");
    }

    /// A disc.
    pub fn disc(&mut self, [x, y]: Place, radius: f64, fill: &str, rim: Pen) {
        let _ = writeln!(
            self.body,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{fill}\" stroke=\"{}\" stroke-width=\"{}\"/>",
            tenths(x),
            tenths(y),
            tenths(radius),
            rim.colour,
            tenths(rim.width)
        );
    }

    /// A text.
    pub fn text(&mut self, [x, y]: Place, text: &str, t: Type) {
        let anchor = match t.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
        };
        let turn = if t.turn_deg == 0.0 {
            String::new()
        } else {
            format!(" transform=\"rotate({} {} {})\"", t.turn_deg.round(), tenths(x), tenths(y))
        };
        let halo = if t.halo { " class=\"h\"" } else { "" };
        let bold = if t.bold { " font-weight=\"bold\"" } else { "" };
        let _ = writeln!(
            self.body,
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"{anchor}{turn}{halo}{bold}>{}</text>",
            tenths(x),
            tenths(y),
            tenths(t.size),
            t.colour,
            escape(text)
        );
    }

    /// A mark.
    pub fn mark(&mut self, at: Place, mark: Mark) {
        const RED: &str = "#b3122b";
        let [x, y] = at;
        let rim = pen("#fff", 0.8);
        let closed =
            |points: &[[f64; 2]]| -> Vec<Place> { points.iter().map(|p| [x + p[0], y + p[1]]).collect() };
        let cross = |r: f64| vec![vec![[x - r, y - r], [x + r, y + r]], vec![[x - r, y + r], [x + r, y - r]]];
        match mark {
            Mark::Lemon => self.disc(at, 3.6, RED, rim),
            Mark::Monstar => {
                self.disc(at, 5.2, "#fff", pen(RED, 1.3));
                self.disc(at, 2.4, RED, pen("none", 0.0));
            }
            Mark::Star => {
                let points: Vec<[f64; 2]> = (0..6)
                    .map(|k| {
                        let (s, c) = (std::f64::consts::PI * f64::from(k) / 3.0).sin_cos();
                        let r = if k % 2 == 0 { 6.2 } else { 2.0 };
                        [r * s, -r * c]
                    })
                    .collect();
                self.area(&closed(&points), RED);
            }
            Mark::Umbilic => {
                self.disc(at, 5.0, "#fff", pen(RED, 1.3));
                self.lines(&cross(2.6), pen(RED, 1.3));
            }
            Mark::Minimum => self.triangle(&closed(&[[-4.6, -3.4], [4.6, -3.4], [0.0, 4.6]])),
            Mark::Maximum => self.triangle(&closed(&[[-4.6, 3.4], [4.6, 3.4], [0.0, -4.6]])),
            Mark::Saddle => {
                self.lines(&cross(4.0), pen("#fff", 3.4));
                self.lines(&cross(4.0), pen("#222", 1.5));
            }
        }
    }

    fn triangle(&mut self, corners: &[Place]) {
        let _ = writeln!(
            self.body,
            "<path d=\"{}\" fill=\"#222\" stroke=\"#fff\" stroke-width=\"8\"/>",
            path(corners, true)
        );
    }

    /// Another drawing at an offset.
    pub fn insert(&mut self, other: &Self, [x, y]: Place) {
        let _ = writeln!(
            self.body,
            "<g transform=\"translate({} {})\">\n{}</g>",
            tenths(x),
            tenths(y),
            other.body
        );
    }

    /// SVG in whole pixels at an offset, such as a colour bar.
    pub fn fragment(&mut self, svg: &str, [x, y]: Place, size: f64) {
        let _ = writeln!(
            self.body,
            "<g transform=\"translate({} {}) scale(10)\" font-size=\"{size}\" color=\"#222\" fill=\"#222\">{svg}</g>",
            tenths(x),
            tenths(y)
        );
    }

    /// The whole file.
    pub fn finish(&self, width: f64, height: f64, title: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\" \
             fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" \
             font-family=\"Helvetica,Arial,sans-serif\">\n<title>{}</title>\n<style>text{{stroke:none}}\
             .h{{paint-order:stroke;stroke:#fff;stroke-width:28px}}</style>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
            tenths(width),
            tenths(height),
            escape(title),
            self.body
        )
    }
}

/// Tenths of a pixel, whole.
fn tenths(x: f64) -> i64 {
    (10.0 * x).round() as i64
}

/// Path data of a line.
fn path(line: &[Place], closed: bool) -> String {
    let kept = thinned(line);
    let mut out = String::new();
    let mut before = [0_i64; 2];
    let mut first = true;
    for p in kept {
        let q = p.map(tenths);
        let d = [q[0] - before[0], q[1] - before[1]];
        if first {
            let _ = write!(out, "M{} {}", q[0], q[1]);
        } else if d == [0, 0] {
            continue;
        } else {
            let sign = if d[1] < 0 { "" } else { " " };
            let _ = write!(out, "l{}{sign}{}", d[0], d[1]);
        }
        first = false;
        before = q;
    }
    if closed {
        out.push('z');
    }
    out
}

/// The line without the points that one does not see (Douglas & Peucker).
fn thinned(line: &[Place]) -> Vec<Place> {
    if line.len() < 3 {
        return line.to_vec();
    }
    let mut keep = vec![false; line.len()];
    keep[0] = true;
    keep[line.len() - 1] = true;
    let mut queue = vec![(0, line.len() - 1)];
    while let Some((a, b)) = queue.pop() {
        let (p, q) = (line[a], line[b]);
        let d = [q[0] - p[0], q[1] - p[1]];
        let size = d[0].hypot(d[1]);
        let off = |r: Place| {
            let e = [r[0] - p[0], r[1] - p[1]];
            if size > 1e-9 { (d[0] * e[1] - d[1] * e[0]).abs() / size } else { e[0].hypot(e[1]) }
        };
        let mut far = (THIN, a);
        for (k, r) in line.iter().enumerate().take(b).skip(a + 1) {
            let o = off(*r);
            if o > far.0 {
                far = (o, k);
            }
        }
        if far.1 > a {
            keep[far.1] = true;
            queue.push((a, far.1));
            queue.push((far.1, b));
        }
    }
    line.iter().zip(keep).filter(|(_, k)| *k).map(|(p, _)| *p).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_lose_their_inner_points() {
        let line: Vec<Place> = (0..50).map(|k| [f64::from(k), 2.0 * f64::from(k)]).collect();
        assert_eq!(path(&line, false), "M0 0l490 980");
        let bend = vec![[0.0, 0.0], [5.0, 1.0], [10.0, -3.0]];
        assert_eq!(path(&bend, true), "M0 0l50 10l50-40z");
    }

    #[test]
    fn texts_are_escaped() {
        let mut d = Drawing::default();
        d.text([1.0, 2.0], "k < 3 & \"4\"", letters(10.0));
        let svg = d.finish(10.0, 20.0, "a<b");
        assert!(svg.contains("k &lt; 3 &amp; &quot;4&quot;") && svg.contains("<title>a&lt;b</title>"));
    }
}
