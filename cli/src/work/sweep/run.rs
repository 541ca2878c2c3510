//! Cases planned beside each other: each on a thread of its own, which is faster than one after the other on all of them, and comes to the
//! same bytes.

use super::case::{Case, Row};
use super::{Sweep, rows};
use crate::failure::Failure;
use crate::watch::{Stage, Watch};
use crate::work::plan::Plan;
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// What is done with a plan that is made, beside its row. Where nothing is, plans have no report.
pub type Keep<'a> = dyn Fn(&Case, &Plan) -> Result<(), Failure> + Sync + 'a;

/// How many cases of a sweep cannot be planned as their jobs stand, with what the first of them says.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Refused {
    /// How many.
    pub count: usize,
    /// The first of them by number: what is wrong.
    pub first: Option<(usize, String)>,
}

/// Everything that can be said of cases without their parts, before the work.
///
/// # Errors
/// Where a case cannot be made at all.
pub fn checked(sweep: &Sweep, numbers: &[usize]) -> Result<Refused, Failure> {
    let found: Vec<Option<(usize, String)>> = numbers
        .par_iter()
        .map(|n| Ok(sweep.case(*n)?.work().err().map(|why| (*n, why.message().to_owned()))))
        .collect::<Result<_, Failure>>()?;
    let count = found.iter().flatten().count();
    Ok(Refused { count, first: found.into_iter().flatten().next() })
}

/// Plans cases on so many threads and hands each row to `writer`; how many there were that have no plan.
///
/// # Errors
/// Where a row or a plan cannot be written: then no further case begins.
pub fn run(
    sweep: &Sweep,
    numbers: &[usize],
    (threads, keep): (usize, Option<&Keep<'_>>),
    (writer, watch): (&rows::Writer, &dyn Watch),
) -> Result<usize, Failure> {
    let stage = Stage::begin(watch, "sweep");
    let (next, done, failed) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    let stopped: Mutex<Option<Failure>> = Mutex::new(None);
    let held = || stopped.lock().unwrap_or_else(PoisonError::into_inner);
    let worker = || {
        // A pool of one: what is parallel within a case does not wait for other cases.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(Failure::job)?;
        while held().is_none() {
            let Some(number) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
            let row = pool.install(|| one(&sweep.case(*number)?, keep))?;
            failed.fetch_add(usize::from(row.figures.is_none()), Ordering::Relaxed);
            writer.add(&row)?;
            stage.at((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / numbers.len() as f64);
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.clamp(1, numbers.len().max(1)))
            .map(|_| {
                scope.spawn(|| {
                    if let Err(why) = worker() {
                        held().get_or_insert(why);
                    }
                })
            })
            .collect();
        for each in workers {
            if each.join().is_err() {
                held().get_or_insert_with(|| Failure::job("a thread of the sweep ended early"));
            }
        }
    });
    stage.end();
    let stopped = stopped.into_inner().unwrap_or_else(PoisonError::into_inner);
    stopped.map_or_else(|| Ok(failed.load(Ordering::Relaxed)), Err)
}

/// Hears nothing of a case; its report is made where the plan is kept.
struct Quiet {
    pages: bool,
}

impl Watch for Quiet {
    fn wants_pages(&self) -> bool {
        self.pages
    }
}

/// A case planned and judged. One that ends in a panic is a row as well: the others go on.
fn one(case: &Case, keep: Option<&Keep<'_>>) -> Result<Row, Failure> {
    let begin = Instant::now();
    let planned = catch_unwind(AssertUnwindSafe(|| case.plan(&Quiet { pages: keep.is_some() })));
    let wall_s = begin.elapsed().as_secs_f64();
    Ok(match planned {
        Ok(Ok(plan)) => {
            keep.map_or(Ok(()), |keep| keep(case, &plan))?;
            Row::of(case, Ok(&plan), wall_s)
        }
        Ok(Err(why)) => Row::of(case, Err(why.message()), wall_s),
        Err(_) => {
            Row::of(case, Err("a mistake of this program ended it; what it said stands on stderr"), wall_s)
        }
    })
}
