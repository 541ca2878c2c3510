//! The page of a sweep: charts of a figure over what was varied, grids of the least time, and the table.

use super::chart::{Axis, BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, base_line, frame};
use super::text::{STYLE, coordinate, count, escape, figure};
use std::fmt::Write;

/// Cells are one line, but the last of a row, which says why.
const CELLS: &str = "td:not(:last-child), th { white-space: nowrap; }\n";

/// Most dots of a chart; of more only the range and the median of each value are drawn.
const DOTS: usize = 3000;
/// Share of its place that the dots of a value take, and their radius.
const SPREAD: f64 = 0.6;
const RADIUS: f64 = 2.6;
/// Most labels below a chart, and the letters of all of them.
const LABELS: usize = 12;
const LETTERS: usize = 80;

/// A page of a sweep.
#[non_exhaustive]
pub struct Page {
    /// Of the page.
    pub title: String,
    /// Below it.
    pub subtitle: String,
    /// Figures over what was varied.
    pub charts: Vec<Chart>,
    /// The least time over two things that were varied.
    pub grids: Vec<Grid>,
    /// Of the table.
    pub headings: Vec<String>,
    /// Of the table.
    pub rows: Vec<Vec<String>>,
    /// Rows that the table leaves out.
    pub left_out: usize,
}

/// A figure over the values of one thing.
#[non_exhaustive]
pub struct Chart {
    /// What was varied.
    pub x: String,
    /// The figure with its unit.
    pub y: &'static str,
    /// The values.
    pub labels: Vec<String>,
    /// One of each case.
    pub dots: Vec<Dot>,
}

/// A case in a chart.
#[non_exhaustive]
pub struct Dot {
    /// Which value it has.
    pub at: usize,
    /// The figure.
    pub value: f64,
    /// `held`, `not_held`, `not_shown`.
    pub answer: String,
    /// What it is, for who points at it.
    pub words: String,
}

/// The least time over two things, min; None where nothing holds.
pub struct Grid {
    /// Name and values of the rows.
    pub down: (String, Vec<String>),
    /// Name and values of the columns.
    pub across: (String, Vec<String>),
    /// By rows.
    pub cells: Vec<Vec<Option<f64>>>,
}

/// The page: a complete HTML document that needs no other file and no network.
#[must_use]
pub fn html(page: &Page) -> String {
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}: sweep</title>\n\
         <style>\n{STYLE}{CELLS}</style>\n</head>\n<body>\n<div class=\"wrap\">\n<header><div><h1>{title}: sweep</h1><p>{}</p></div></header>\n",
        escape(&page.subtitle),
        title = escape(&page.title),
    );
    out.push_str("<div class=\"charts\">");
    for chart in &page.charts {
        let _ = write!(
            out,
            "<section class=\"card\"><h2>{} over {}</h2>{}</section>",
            escape(chart.y),
            escape(&chart.x),
            drawn(chart)
        );
    }
    out.push_str("</div>\n<div class=\"wide-tables\">");
    for grid in &page.grids {
        let _ = write!(out, "<section class=\"card scroll\">{}</section>", table_of(grid));
    }
    out.push_str("<section class=\"card scroll whole\"><table><caption>Cases, the fastest that hold first");
    if page.left_out > 0 {
        let _ = write!(out, "; {} more are in table.csv", count(page.left_out));
    }
    out.push_str("</caption><thead><tr>");
    for heading in &page.headings {
        let _ = write!(out, "<th>{}</th>", escape(heading));
    }
    out.push_str("</tr></thead><tbody>");
    for row in &page.rows {
        out.push_str("<tr>");
        for cell in row {
            let _ = write!(out, "<td>{}</td>", escape(cell));
        }
        out.push_str("</tr>\n");
    }
    let _ = write!(
        out,
        "</tbody></table></section></div>\n<footer>osculate {}. Dots: held are filled, others are rings; the line joins the medians of those \
         that hold.</footer>\n</div>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION")
    );
    out
}

/// The colour of an answer.
fn colour(answer: &str) -> &'static str {
    match answer {
        "held" => "var(--good)",
        "not_held" => "var(--bad)",
        _ => "var(--open)",
    }
}

/// The value in the middle of some, of an even number the lower.
fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().checked_sub(1)? / 2).copied()
}

fn drawn(chart: &Chart) -> String {
    let most = chart.dots.iter().map(|d| d.value).fold(0.0, f64::max);
    let n = chart.labels.len();
    let x = Axis { lo: 0.0, hi: n as f64, from: LEFT, to: WIDTH - RIGHT };
    let y = Axis {
        lo: 0.0,
        hi: if most > 0.0 { 1.05 * most } else { 1.0 },
        from: HEIGHT - BOTTOM,
        to: TOP + 4.0,
    };
    let mut out = frame(&format!("{} over {}", chart.y, chart.x), x, y, &[], &chart.x, chart.y);
    let stride = n.div_ceil(LABELS);
    for (k, label) in chart.labels.iter().enumerate().step_by(stride) {
        let short: String = label.chars().take(LETTERS / n.min(LABELS)).collect();
        let _ = write!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}<title>{}</title></text>",
            coordinate(x.at(k as f64 + 0.5)),
            HEIGHT - BOTTOM + 17.0,
            escape(&short),
            escape(label)
        );
    }
    let mut path = String::new();
    for k in 0..n {
        let own: Vec<&Dot> = chart.dots.iter().filter(|d| d.at == k).collect();
        let mut held: Vec<f64> = own.iter().filter(|d| d.answer == "held").map(|d| d.value).collect();
        let middle = coordinate(x.at(k as f64 + 0.5));
        if let Some(at) = median(&mut held) {
            let word = if path.is_empty() { 'M' } else { 'L' };
            let _ = write!(path, "{word}{middle} {}", coordinate(y.at(at)));
            if chart.dots.len() > DOTS {
                let [lo, hi] = [held[0], held[held.len() - 1]].map(|v| coordinate(y.at(v)));
                let _ = write!(out, "<path class=\"axis\" d=\"M{middle} {lo}V{hi}\"/>");
            }
        }
        if chart.dots.len() > DOTS {
            continue;
        }
        for (i, dot) in own.iter().enumerate() {
            let share = (i as f64 + 0.5) / own.len() as f64 - 0.5;
            let colour = colour(&dot.answer);
            let fill = if dot.answer == "held" { colour } else { "none" };
            let _ = write!(
                out,
                "<circle cx=\"{}\" cy=\"{}\" r=\"{RADIUS}\" fill=\"{fill}\" stroke=\"{colour}\"><title>{}: {} {}</title></circle>",
                coordinate(x.at(k as f64 + 0.5 + SPREAD * share)),
                coordinate(y.at(dot.value)),
                escape(&dot.words),
                figure(dot.value, 4),
                escape(&dot.answer.replace('_', " "))
            );
        }
    }
    let _ = write!(out, "<path d=\"{path}\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.2\"/>");
    out + &base_line() + "</svg>"
}

fn table_of(grid: &Grid) -> String {
    let known = || grid.cells.iter().flatten().flatten().copied();
    let (least, most) = known().fold((f64::INFINITY, 0.0f64), |(lo, hi), t| (lo.min(t), hi.max(t)));
    let mut out = format!(
        "<table><caption>Least time that holds, min: {} down, {} across</caption><thead><tr><th></th>",
        escape(&grid.down.0),
        escape(&grid.across.0)
    );
    for label in &grid.across.1 {
        let _ = write!(out, "<th>{}</th>", escape(label));
    }
    out.push_str("</tr></thead><tbody>");
    for (label, cells) in grid.down.1.iter().zip(&grid.cells) {
        let _ = write!(out, "<tr><th>{}</th>", escape(label));
        for cell in cells {
            match cell {
                Some(t) => {
                    // The faster the deeper.
                    let share = if most > least { (most - t) / (most - least) } else { 1.0 };
                    let _ = write!(
                        out,
                        "<td style=\"background:color-mix(in srgb, var(--good) {:.0}%, transparent)\">{}</td>",
                        50.0 * share,
                        figure(*t, 4)
                    );
                }
                None => out.push_str("<td>\u{2013}</td>"),
            }
        }
        out.push_str("</tr>");
    }
    out + "</tbody></table>"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(at: usize, value: f64, answer: &str) -> Dot {
        Dot { at, value, answer: answer.to_owned(), words: format!("<{at}>") }
    }

    fn chart(dots: Vec<Dot>) -> Chart {
        Chart { x: "tool".into(), y: "time, min", labels: vec!["a<b".into(), "c".into()], dots }
    }

    #[test]
    fn each_case_is_a_dot_and_medians_of_what_holds_are_joined() {
        let text = drawn(&chart(vec![
            dot(0, 1.0, "held"),
            dot(0, 3.0, "held"),
            dot(0, 2.0, "held"),
            dot(1, 4.0, "held"),
            dot(1, 0.5, "not_held"),
        ]));
        assert_eq!(text.matches("<circle").count(), 5);
        assert_eq!(text.matches("fill=\"none\" stroke=\"var(--bad)\"").count(), 1);
        assert!(text.contains("a&lt;b") && text.contains("&lt;1&gt;: 4.000 held"), "{text}");
        let y = Axis { lo: 0.0, hi: 4.2, from: HEIGHT - BOTTOM, to: TOP + 4.0 };
        let ways = [2.0, 4.0].map(|t| format!(" {}", coordinate(y.at(t))));
        let line = text.rsplit("<path d=\"").next().unwrap_or_default();
        assert!(ways.iter().all(|w| line.contains(w)), "{line}");
    }

    #[test]
    fn of_very_many_cases_ranges_are_drawn() {
        let text = drawn(&chart((0..4000).map(|k| dot(k % 2, 1.0 + k as f64, "held")).collect()));
        assert_eq!(
            (text.matches("<circle").count(), text.matches("<path class=\"axis\" d=\"M").count()),
            (0, 3)
        );
    }

    #[test]
    fn nothing_that_holds_is_a_dash_and_the_fastest_is_the_deepest() {
        let grid = Grid {
            down: ("d".into(), vec!["1".into(), "2".into()]),
            across: ("a".into(), vec!["x".into()]),
            cells: vec![vec![Some(2.0)], vec![None]],
        };
        let text = table_of(&grid);
        assert!(
            text.contains("--good) 50%, transparent)\">2.000</td>") && text.contains("<td>\u{2013}</td>"),
            "{text}"
        );
    }
}
