//! Plots as SVG: curves over logarithmic axes, and polar curves.

/// A curve with its name.
pub struct Curve {
    pub name: String,
    pub points: Vec<[f64; 2]>,
    pub dots: bool,
}

const COLOURS: [&str; 7] = ["#1b5e9b", "#c0392b", "#2e8b57", "#8e44ad", "#d68910", "#444444", "#16a0a0"];
const SIZE: [f64; 2] = [640.0, 420.0];

fn page(body: &str, [w, h]: [f64; 2]) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w:.0} {h:.0}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{body}</svg>\n"
    )
}

fn text(at: [f64; 2], anchor: &str, colour: &str, words: &str) -> String {
    let words = words.replace('&', "&amp;").replace('<', "&lt;");
    format!(
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{words}</text>\n",
        at[0], at[1]
    )
}

fn path(points: &[[f64; 2]], colour: &str) -> String {
    let d: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", p[0], p[1])).collect();
    format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>\n", d.join(" "))
}

/// Curves over two logarithmic axes, which span whole decades.
pub fn logarithmic(title: &str, axes: [&str; 2], curves: &[Curve]) -> String {
    let all: Vec<[f64; 2]> = curves.iter().flat_map(|c| &c.points).filter(|p| p[1] > 0.0).copied().collect();
    let range = |k: usize| {
        let logs = all.iter().map(|p| p[k].log10());
        let (lo, hi) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        [lo.floor(), hi.ceil().max(lo.floor() + 1.0)]
    };
    let [x, y] = [range(0), range(1)];
    let (left, right, top, bottom) = (70.0, 430.0, 40.0, 370.0);
    let at = |p: &[f64; 2]| {
        let f = |v: f64, r: [f64; 2]| (v.log10() - r[0]) / (r[1] - r[0]);
        [left + (right - left) * f(p[0], x), bottom + (top - bottom) * f(p[1], y)]
    };
    let mut out = text([left, 22.0], "start", "#111111", title);
    for (k, r) in [x, y].into_iter().enumerate() {
        for d in r[0] as i32..=r[1] as i32 {
            let v = 10f64.powi(d);
            let ends = if k == 0 {
                [[v, 10f64.powf(y[0])], [v, 10f64.powf(y[1])]]
            } else {
                [[10f64.powf(x[0]), v], [10f64.powf(x[1]), v]]
            };
            let [a, b] = ends.map(|e| at(&e));
            out += &format!(
                "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#dddddd\"/>\n",
                a[0], a[1], b[0], b[1]
            );
            let label = format!("1e{d}");
            out += &if k == 0 {
                text([a[0], bottom + 18.0], "middle", "#333333", &label)
            } else {
                text([left - 6.0, a[1] + 4.0], "end", "#333333", &label)
            };
        }
    }
    out += &text([0.5 * (left + right), 405.0], "middle", "#333333", axes[0]);
    out += &text([14.0, 36.0], "start", "#333333", axes[1]);
    for (k, c) in curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let points: Vec<[f64; 2]> = c.points.iter().filter(|p| p[1] > 0.0).map(at).collect();
        if c.dots {
            for p in &points {
                out +=
                    &format!("<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3.4\" fill=\"{colour}\"/>\n", p[0], p[1]);
            }
        } else {
            out += &path(&points, colour);
        }
        out += &text([right + 14.0, top + 12.0 + 18.0 * k as f64], "start", colour, &c.name);
    }
    page(&out, SIZE)
}

/// Polar curves, each scaled to its own greatest radius; points are (angle, radius).
pub fn polar(title: &str, curves: &[Curve], marks: &[(f64, &str)]) -> String {
    let (cx, cy, r) = (230.0, 225.0, 170.0);
    let mut out = text([20.0, 22.0], "start", "#111111", title);
    out += &format!("<circle cx=\"{cx}\" cy=\"{cy}\" r=\"{r}\" fill=\"none\" stroke=\"#dddddd\"/>\n");
    for (k, c) in curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let most = c.points.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
        let points: Vec<[f64; 2]> = c
            .points
            .iter()
            .map(|p| {
                let s = r * p[1].abs() / most;
                [cx + s * p[0].cos(), cy - s * p[0].sin()]
            })
            .collect();
        out += &path(&points, colour);
        out += &text([430.0, 60.0 + 18.0 * k as f64], "start", colour, &c.name);
    }
    for (k, (angle, name)) in marks.iter().enumerate() {
        let colour = COLOURS[(curves.len() + k) % COLOURS.len()];
        let (s, c) = angle.sin_cos();
        out += &format!(
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{colour}\" stroke-dasharray=\"6 4\"/>\n",
            cx - 1.1 * r * c,
            cy + 1.1 * r * s,
            cx + 1.1 * r * c,
            cy - 1.1 * r * s
        );
        out += &text([430.0, 60.0 + 18.0 * (curves.len() + k) as f64], "start", colour, name);
    }
    page(&out, SIZE)
}
