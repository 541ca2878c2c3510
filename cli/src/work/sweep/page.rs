//! A page of a sweep: what each varied thing does to the time, the least time over two of them, the table.

use super::Sweep;
use super::case::Row;
use crate::report::sweep::{Chart, Dot, Grid, Page, html};
use crate::words::number;
use std::path::Path;

/// Most rows of the table on the page.
const SHOWN: usize = 2000;
/// Most pairs of things varied that have a grid.
const PAIRS: usize = 6;
/// Figures that are drawn over what is varied, with their titles.
const DRAWN: [(&str, &str); 3] = [
    ("control_time_min", "time on the control, min"),
    ("cutting_time_min", "cutting time by feed words, min"),
    ("efficiency_percent", "efficiency, %"),
];
/// Columns of the table, with their headings.
const COLUMNS: [(&str, &str); 6] = [
    ("control_time_min", "control min"),
    ("cutting_time_min", "cutting min"),
    ("efficiency_percent", "efficiency %"),
    ("height_mm", "height mm"),
    ("gouge_mm", "gouge mm"),
    ("uncut_mm2", "uncut mm2"),
];

/// The page of all rows: a complete HTML document.
#[must_use]
pub fn of(sweep: &Sweep, rows: &[&Row]) -> String {
    let values: Vec<Vec<usize>> = rows.iter().map(|r| sweep.values_of(r.case)).collect();
    let mut charts = Vec::new();
    for (axis, varied) in sweep.varied().iter().enumerate() {
        // What never changes tells nothing.
        if varied.labels.len() < 2 {
            continue;
        }
        for (name, title) in DRAWN {
            let dots = rows.iter().zip(&values).filter_map(|(row, values)| {
                let words = format!("case {}: {}", row.case, sweep.words_of(row.case));
                Some(Dot { at: values[axis], value: row.number(name)?, answer: row.answer.clone(), words })
            });
            let dots: Vec<Dot> = dots.collect();
            if !dots.is_empty() {
                charts.push(Chart { x: varied.name.clone(), y: title, labels: varied.labels.clone(), dots });
            }
        }
    }
    let held: Vec<(&Row, &[usize], f64)> = rows
        .iter()
        .zip(&values)
        .filter_map(|(row, values)| Some((*row, values.as_slice(), row.number("time_min")?)))
        .filter(|(row, ..)| row.holds())
        .collect();
    let many: Vec<usize> =
        (0..sweep.varied().len()).filter(|k| sweep.varied()[*k].labels.len() > 1).collect();
    let pairs = many.iter().enumerate().flat_map(|(k, a)| many[k + 1..].iter().map(|b| (*a, *b)));
    let grids = pairs.take(PAIRS).map(|(a, b)| {
        let [down, across] = [a, b].map(|k| &sweep.varied()[k]);
        let mut least = vec![vec![None; across.labels.len()]; down.labels.len()];
        for (_, values, time) in &held {
            let cell: &mut Option<f64> = &mut least[values[a]][values[b]];
            *cell = Some(cell.map_or(*time, |t| t.min(*time)));
        }
        Grid {
            down: (down.name.clone(), down.labels.clone()),
            across: (across.name.clone(), across.labels.clone()),
            cells: least,
        }
    });
    let mut order: Vec<&Row> = rows.to_vec();
    let rank = |r: &Row| (u8::from(!r.holds()), r.number("time_min").unwrap_or(f64::INFINITY));
    order.sort_by(|a, b| {
        let (a, b) = ((rank(a), a.case), (rank(b), b.case));
        a.0.0.cmp(&b.0.0).then(a.0.1.total_cmp(&b.0.1)).then(a.1.cmp(&b.1))
    });
    let headings = ["case".to_owned()].into_iter().chain(sweep.varied().iter().map(|v| v.name.clone()));
    let headings = headings.chain(["answer".to_owned()]).chain(COLUMNS.map(|(_, h)| h.to_owned()));
    let line = |row: &&Row| {
        let labels = sweep.labels_of(row.case).into_iter().map(ToOwned::to_owned);
        let shown = |x: Option<f64>| x.map_or_else(String::new, |x| number(x, 4));
        let cells = std::iter::once(row.case.to_string()).chain(labels).chain([row.answer.clone()]);
        let cells = cells.chain(COLUMNS.map(|(name, _)| shown(row.number(name)))).chain([row.why.clone()]);
        cells.collect()
    };
    html(&Page {
        title: title(sweep.path()),
        subtitle: words(rows),
        charts,
        grids: grids.collect(),
        headings: headings.chain(["why".to_owned()]).collect(),
        rows: order.iter().take(SHOWN).map(line).collect(),
        left_out: order.len().saturating_sub(SHOWN),
    })
}

/// The sweep by its file, or by its folder where the file is called sweep.
fn title(path: &Path) -> String {
    let name = path.file_stem().unwrap_or_default();
    let folder = path.parent().and_then(Path::file_name).filter(|_| name == "sweep");
    folder.unwrap_or(name).to_string_lossy().into_owned()
}

/// How many of them hold, and which is the fastest.
#[must_use]
pub fn words(rows: &[&Row]) -> String {
    let count = |answer: &str| rows.iter().filter(|r| r.answer == answer).count();
    let all = [("held", "held"), ("not_held", "not held"), ("not_shown", "not shown"), ("failed", "failed")];
    let counts: Vec<String> = all
        .iter()
        .map(|(key, words)| (count(key), words))
        .filter(|(n, _)| *n > 0)
        .map(|(n, words)| format!("{n} {words}"))
        .collect();
    format!("{} cases: {}", rows.len(), counts.join(", "))
}

/// The fastest of those that hold.
#[must_use]
pub fn fastest<'a>(rows: &[&'a Row]) -> Option<&'a Row> {
    let time = |r: &Row| r.number("time_min").unwrap_or(f64::INFINITY);
    rows.iter().filter(|r| r.holds()).copied().min_by(|a, b| time(a).total_cmp(&time(b)))
}
