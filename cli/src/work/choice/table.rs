//! What became of the candidates, as rows for people and for programs.

use super::candidates;
use super::entry::{Entry, State};
use super::measured::Measured;
use crate::job::Job;
use crate::report;
use crate::words::Table;
use osculate_productivity::compare::Axes;
use serde::{Deserialize, Serialize};

/// Characters of a reason in the table; all of it is in the JSON.
const WHY: usize = 90;

/// What became of a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Outcome {
    /// Verified within tolerance; the first such row is the best.
    Holds,
    /// Possible, and slower than the best by what is known of it.
    Slower,
    /// Screened only: others promised more, or enough was planned.
    NotPlanned,
    /// Planned or verified, and not within tolerance.
    Fails,
    /// Not possible.
    NotPossible,
}

/// One row.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Row {
    /// The tool in words.
    pub tool: String,
    /// Strategy with direction.
    pub strategy: String,
    /// Lead; of a local one the least allowed.
    pub lead_deg: f64,
    /// Whether the lead was found place by place.
    pub local_lead: bool,
    /// Whether the tilt was, too.
    pub local_tilt: bool,
    /// Whether axes are measured from the `feed` or are a `field` in the part's frame.
    pub axis: String,
    /// Tilt.
    pub tilt_deg: f64,
    /// Tilt to the left of the growing parameter, where the job asks for one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side_tilt_deg: Option<f64>,
    /// Leads looked at.
    pub leads: usize,
    /// Time by strips at places; absent where there are none.
    pub pointwise_min: Option<f64>,
    /// Time with the overlap of constant spacing.
    pub layout_min: Option<f64>,
    /// Length of passes so predicted.
    pub predicted_length_mm: Option<f64>,
    /// Passes of the plan, where there is one.
    pub passes: Option<usize>,
    /// Moves of the plan.
    pub points: Option<usize>,
    /// Length of cutting moves of the plan.
    pub cutting_length_mm: Option<f64>,
    /// Time of the program, where it was posted.
    pub time_min: Option<f64>,
    /// What was measured, where it was verified.
    pub verified: Option<Measured>,
    /// What became of it.
    pub outcome: Outcome,
    /// Why it is not the best.
    pub why: String,
}

fn of_entry(jobs: &[Job], entry: &Entry, leads: usize) -> Row {
    let c = &entry.candidate;
    let finite = |x: f64| x.is_finite().then_some(x);
    let f = entry.figures;
    let lean = jobs[c.tool].strategy().as_given(c.lean);
    let (outcome, why) = match &entry.state {
        State::Out(why) if f.is_some() => (Outcome::Fails, why.clone()),
        State::Out(why) => (Outcome::NotPossible, why.clone()),
        State::Taken if entry.verified.is_some_and(|v| v.within_tolerance) => (Outcome::Holds, String::new()),
        State::Open => {
            let promise = entry.least_min();
            (Outcome::NotPlanned, format!("not planned: strips alone take {promise:.2} min"))
        }
        _ => (Outcome::Slower, format!("takes {:.2} min at least", entry.least_min())),
    };
    Row {
        tool: jobs[c.tool].tool_words(),
        strategy: candidates::words(&c.strategy),
        lead_deg: lean.lead_rad.to_degrees(),
        local_lead: c.axes.is_local(),
        local_tilt: c.axes == Axes::Balanced,
        axis: if c.axes == Axes::Field { "field" } else { "feed" }.to_owned(),
        tilt_deg: lean.tilt_rad.to_degrees(),
        side_tilt_deg: jobs[c.tool].strategy().side_tilt_deg,
        leads,
        pointwise_min: finite(entry.screened.pointwise_min),
        layout_min: finite(entry.screened.layout_min),
        predicted_length_mm: finite(entry.screened.length_mm),
        passes: f.map(|f| f.passes),
        points: f.map(|f| f.points),
        cutting_length_mm: f.map(|f| f.cutting_length_mm),
        time_min: f.and_then(|f| f.posted_min),
        verified: entry.verified,
        outcome,
        why,
    }
}

/// How far a row has come, the furthest first.
fn rank(entry: &Entry) -> (u8, f64) {
    let class = match &entry.state {
        State::Taken => 0,
        State::Posted(_) | State::Planned(_) => 1,
        // What was planned and failed says more than what was not planned.
        State::Out(_) if entry.verified.is_some() => 2,
        State::Out(_) if entry.figures.is_some() => 3,
        State::Out(_) if entry.tried => 4,
        State::Open => 5,
        State::Out(_) => 6,
    };
    (class, entry.least_min())
}

pub(super) fn rows(entries: &[Entry], jobs: &[Job]) -> Vec<Row> {
    let mut best: Vec<(&Entry, usize)> = Vec::new();
    for e in entries {
        let key = |e: &Entry| (e.candidate.tool, e.candidate.strategy, e.is_field());
        let group = |o: &Entry| key(o) == key(e);
        match best.iter_mut().find(|(o, _)| group(o)) {
            Some((o, leads)) => {
                *leads += 1;
                if rank(e) < rank(o) {
                    *o = e;
                }
            }
            None => best.push((e, 1)),
        }
    }
    best.sort_by(|a, b| {
        let (a, b) = (rank(a.0), rank(b.0));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    best.into_iter().map(|(e, leads)| of_entry(jobs, e, leads)).collect()
}

fn cells(row: &Row) -> [String; 9] {
    let time = |t: Option<f64>| t.map_or_else(|| "-".to_owned(), |t| format!("{t:.2}"));
    let length = row.cutting_length_mm.or(row.predicted_length_mm);
    let measured = row
        .verified
        .map_or_else(|| "-".to_owned(), |v| format!("{:.4} / {:.4}", v.scallop_max_mm, v.gouge_max_mm));
    let mut why: String = row.why.lines().next().unwrap_or("").chars().take(WHY).collect();
    if row.outcome == Outcome::Holds {
        why = "within tolerance".to_owned();
    }
    [
        row.tool.clone(),
        row.strategy.clone(),
        match row.axis.as_str() {
            "feed" if row.local_tilt => "local, tilt local".to_owned(),
            "feed" if row.local_lead => "local".to_owned(),
            "feed" => format!("{:.0}", row.lead_deg),
            field => field.to_owned(),
        },
        time(row.pointwise_min),
        time(row.layout_min),
        length.map_or_else(|| "-".to_owned(), |l| format!("{l:.0}")),
        time(row.time_min),
        measured,
        why,
    ]
}

const HEADINGS: [&str; 9] = [
    "tool",
    "strategy",
    "lead deg",
    "pointwise min",
    "layout min",
    "length mm",
    "time min",
    "scallop / gouge mm",
    "",
];

/// The rows as text.
pub fn text_table(rows: &[Row]) -> String {
    let mut t = Table::new(HEADINGS);
    rows.iter().for_each(|r| t.row(cells(r)));
    t.render()
}

/// The rows for the report.
pub fn page_table(rows: &[Row], caption: String) -> report::Table {
    let columns =
        HEADINGS.map(|h| report::Column { name: h.to_owned(), ..report::Column::default() }).to_vec();
    report::Table { caption, columns, rows: rows.iter().map(|r| cells(r).to_vec()).collect() }
}
