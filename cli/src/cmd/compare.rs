//! `compare`: tools, strategies, directions and leads of a job side by side, ranked, with the reason why each lost.

use crate::choice::{self, Choice, Row};
use crate::failure::{Done, Outcome};
use crate::ideal::{self, Bound};
use crate::job::Job;
use crate::part;
use crate::program::WallS;
use crate::progress::Stage;
use crate::render;
use serde::Serialize;
use std::path::Path;

/// Contenders that are verified beside the best.
const VERIFIED: usize = 3;

/// The answer.
#[derive(Debug, Serialize)]
struct Comparison {
    format: u32,
    area_mm2: f64,
    ideal: Bound,
    /// Fastest first.
    candidates: Vec<Row>,
    story: String,
}

/// Runs the verb.
pub fn run(path: &Path, json: bool) -> Outcome {
    let job = Job::load(path)?;
    let stage = Stage::begin("import");
    let faces = part::of_job(&job)?;
    stage.end();
    let stage = Stage::begin("ideal");
    let ideal = ideal::of_job(&job, &faces)?;
    stage.end();
    let stage = Stage::begin("choose");
    let mut choice = Choice::screen(&job, &faces)?;
    let settled = choice::settle(&mut choice, VERIFIED, None, &mut WallS::default(), &|f| stage.at(f))?;
    stage.end();
    let area_mm2 = faces.faces.iter().map(part::area).sum();
    let answer = Comparison { format: 1, area_mm2, ideal, candidates: choice.rows(), story: choice.story() };
    if json {
        render::json(&answer)?;
    } else {
        render::text(&format!(
            "\n{}\n  {}\n  ideal time, estimated {:.2} +- {:.2} min: {}\n\n",
            choice::text_table(&answer.candidates),
            answer.story,
            answer.ideal.time_min,
            answer.ideal.error_min,
            answer.ideal.assumes
        ));
    }
    Ok(if settled.verified.summary.within_tolerance { Done::Yes } else { Done::NotWithinTolerance })
}
