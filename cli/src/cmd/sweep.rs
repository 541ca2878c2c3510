//! `sweep`: a job with some of its values varied, every combination planned and judged, and one table of all.

use crate::screen::args::SweepArgs;
use crate::screen::progress::SCREEN;
use crate::screen::{cancel, output, render};
use osculate::Plan;
use osculate::failure::{Done, Failure, Outcome};
use osculate::words::{Table, number};
use osculate::work::sweep::case::{Case, Row};
use osculate::work::sweep::rows::{Rows, Shard, Writer};
use osculate::work::sweep::{Sweep, page, run, table};
use serde::Serialize;
use std::path::Path;

/// Files of the table.
const TABLE: &str = "table.csv";
const PAGE: &str = "sweep.html";
/// Folder of the plans that are kept.
const PLANS: &str = "plans";
/// Cases or shards that a message lists at most.
const LISTED: usize = 8;
/// Lines of the table on a screen.
const SHOWN: usize = 20;

/// What `--json` prints.
#[derive(Serialize)]
struct Told<'a> {
    format: u32,
    cases: usize,
    /// Of them, what this run planned.
    planned: usize,
    /// Whether all are done and the table is written.
    complete: bool,
    held: usize,
    not_held: usize,
    not_shown: usize,
    failed: usize,
    fastest: Option<&'a Row>,
}

/// Runs the verb.
pub fn run(args: &SweepArgs, json: bool) -> Outcome {
    if let Some(number) = args.print {
        let sweep = Sweep::load(&args.sweep)?;
        let case = sweep.case(number)?;
        let beside = case.path.parent().unwrap_or_else(|| Path::new("")).display().to_string();
        let beside = if beside.is_empty() { ".".to_owned() } else { beside };
        let head = format!(
            "# Case {number}: {}. Put it into {beside}, beside which its files are.\n",
            sweep.words_of(number)
        );
        render::text(&(head + &case.text))?;
        return Ok(Done::Yes);
    }
    let out = args.out.as_deref().expect("clap asks for --out where there is no --print");
    output::folder(out)?;
    let sweep = Sweep::load(&args.sweep)?;
    let shard = args.shard.unwrap_or(Shard::WHOLE);
    let planned = if args.merge { 0 } else { plan_all(&sweep, shard, (out, args))? };
    if args.merge && !out.is_dir() {
        let what = "is no folder with rows: run the sweep or its shards with this --out first, then --merge";
        return Err(Failure::file(out, what));
    }
    let rows = read(&sweep, out)?;
    let complete = rows.count() == sweep.cases();
    if args.merge {
        mergeable(&sweep, &rows, out)?;
    }
    // The table is of all cases: made by a run that has them all, or by --merge from the rows of every shard, the same whoever made these.
    let whole = complete && (args.merge || shard == Shard::WHOLE);
    let all: Vec<&Row> = rows.all().collect();
    if whole {
        let files = [(TABLE, table::csv(&sweep, all.iter().copied())), (PAGE, page::of(&sweep, &all))];
        let files: Vec<(&str, &[u8])> = files.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
        output::set(out, &files)?;
    }
    let failed = all.iter().filter(|r| r.figures.is_none()).count();
    if json {
        let count = |answer: &str| all.iter().filter(|r| r.answer == answer).count();
        render::json(&Told {
            format: 1,
            cases: sweep.cases(),
            planned,
            complete,
            held: count("held"),
            not_held: count("not_held"),
            not_shown: count("not_shown"),
            failed,
            fastest: page::fastest(&all),
        })?;
    } else {
        render::text(&describe(&sweep, (&all, whole), out))?;
    }
    // A case that cannot be planned is a result too.
    Ok(Done::Yes)
}

/// The rows in a folder that are of this sweep.
fn read(sweep: &Sweep, out: &Path) -> Result<Rows, Failure> {
    let key = |n: usize| sweep.case(n).ok().map(|c| c.key);
    Rows::read(out, &key)
}

/// Refuses a table while cases have no row of the job as it stands; says which of them have one of another.
fn mergeable(sweep: &Sweep, rows: &Rows, out: &Path) -> Result<(), Failure> {
    let lacking: Vec<usize> = (1..=sweep.cases()).filter(|n| !rows.has(*n)).collect();
    if lacking.is_empty() {
        tell_stale(rows, out);
        return Ok(());
    }
    let of = sweep.cases();
    let stale: Vec<usize> = lacking.iter().copied().filter(|n| rows.of_another(*n).is_some()).collect();
    let what = if let Some(first) = stale.first() {
        let mut shards: Vec<Shard> = stale.iter().filter_map(|n| rows.of_another(*n)).collect();
        shards.sort_by_key(|shard| (shard.of, shard.which));
        shards.dedup();
        let again: Vec<String> =
            shards.iter().filter(|s| **s != Shard::WHOLE).map(Shard::to_string).collect();
        let again = if again.is_empty() {
            String::new()
        } else {
            let more = if again.len() > LISTED { ", ..." } else { "" };
            format!("--shard {}{more} again, or ", again[..again.len().min(LISTED)].join(", --shard "))
        };
        let never = lacking.len() - stale.len();
        let never = if never == 0 { String::new() } else { format!(", and {never} have none") };
        format!(
            "{} of {of} cases have rows of another job, other files or another version only ({}){never}: run {again}the sweep \
             without --merge; sweep --print {first} shows the job of a case as it is now",
            stale.len(),
            listed(&stale)
        )
    } else {
        format!(
            "{} of {of} cases have no row here ({}): run their shards, or the sweep without --merge",
            lacking.len(),
            listed(&lacking)
        )
    };
    Err(Failure::file(out, what))
}

/// The first of some cases.
fn listed(cases: &[usize]) -> String {
    let first: Vec<String> = cases.iter().take(LISTED).map(ToString::to_string).collect();
    first.join(", ") + if cases.len() > LISTED { ", ..." } else { "" }
}

/// Says how many rows do not count.
fn tell_stale(rows: &Rows, out: &Path) {
    if rows.stale() > 0 {
        render::complaint(&format!(
            "{}: {} rows are of another job, other files or another version, and do not count",
            out.display(),
            rows.stale()
        ));
    }
}

/// Plans the cases of a shard that have no row yet; how many there were.
fn plan_all(sweep: &Sweep, shard: Shard, (out, args): (&Path, &SweepArgs)) -> Result<usize, Failure> {
    let own: Vec<usize> = shard.numbers(sweep.cases()).collect();
    let refused = run::checked(sweep, &own)?;
    if let Some((number, why)) = &refused.first {
        let of = if own.len() == 1 { "the only case".to_owned() } else { format!("all {} cases", own.len()) };
        if refused.count == own.len() {
            return Err(Failure::file(sweep.path(), format!("{of} cannot be planned; case {number}: {why}")));
        }
        render::complaint(&format!(
            "{} of {} cases cannot be planned and count as failed; the first is case {number} ({}): {why}",
            refused.count,
            own.len(),
            sweep.words_of(*number)
        ));
    }
    // Not before: what cannot be planned leaves no folder.
    std::fs::create_dir_all(out)
        .map_err(|e| Failure::file(out, format!("the folder cannot be made: {e}")))?;
    let writer = Writer::open(shard, out)?;
    let rows = read(sweep, out)?;
    tell_stale(&rows, out);
    let left: Vec<usize> = own.iter().copied().filter(|n| !rows.has(*n)).collect();
    let file = shard.file(out).display().to_string();
    cancel::keep(Box::new(move || {
        Ok(format!("what was finished is in {file}: the same command goes on from there"))
    }));
    let keep = |case: &Case, plan: &Plan| plan.write(&out.join(PLANS).join(format!("{:06}", case.number)));
    let threads = args.threads.map_or_else(rayon::current_num_threads, |n| n as usize);
    run::run(sweep, &left, (threads, args.plans.then_some(&keep)), (&writer, &SCREEN))?;
    Ok(left.len())
}

fn describe(sweep: &Sweep, (rows, whole): (&[&Row], bool), out: &Path) -> String {
    let mut text = format!("\n  {}", page::words(rows));
    if rows.len() < sweep.cases() {
        text += &format!("; {} of {} have no row yet", sweep.cases() - rows.len(), sweep.cases());
    }
    text += "\n\n";
    let mut order: Vec<&&Row> = rows.iter().filter(|r| r.holds()).collect();
    let time = |r: &Row| r.number("control_time_min").unwrap_or(f64::INFINITY);
    order.sort_by(|a, b| time(a).total_cmp(&time(b)));
    let headings = ["case"].into_iter().chain(sweep.varied().iter().map(|v| v.name.as_str()));
    let mut t = Table::left(headings.chain(["control min", "cutting min", "height mm", "gouge mm"]));
    for row in order.iter().take(SHOWN) {
        let labels = sweep.labels_of(row.case).into_iter().map(ToOwned::to_owned);
        let shown = ["control_time_min", "cutting_time_min", "height_mm", "gouge_mm"]
            .map(|name| row.number(name).map_or_else(|| "-".to_owned(), |x| number(x, 4)));
        t.row(std::iter::once(row.case.to_string()).chain(labels).chain(shown));
    }
    if !order.is_empty() {
        text += &t.render();
        if order.len() > SHOWN {
            text += &format!("  ... and {} more that hold\n", order.len() - SHOWN);
        }
    }
    for row in rows.iter().filter(|r| r.figures.is_none()).take(3) {
        text += &format!("  case {} failed ({}): {}\n", row.case, sweep.words_of(row.case), row.why);
    }
    if whole {
        text += &format!("\n  {}, {}\n\n", out.join(TABLE).display(), out.join(PAGE).display());
    } else {
        text += "\n  no table yet: when all shards are done, sweep --merge makes it\n\n";
    }
    text
}
