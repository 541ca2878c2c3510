//! The reach on five parts against brute force: every direction and every point taken one by one, by code of its own.
//!
//! `cargo run --release -p osculate --example reach_truth -- [PLACES] [POINTS] [LEVEL] [SEED]` (200, 50000, 4 and 1 where not
//! given: 2,562 directions); exits 1 where a bit differs though no lean and no spare is within the slack of its limit.

#![allow(clippy::print_stdout, reason = "a study prints its figures")]

#[path = "../../tests/repository/reach_truth/study.rs"]
mod study;

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;
use study::{EXAMPLES, Size, study};

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let given: Vec<u64> = std::env::args().skip(1).map(|a| a.parse()).collect::<Result<_, _>>()?;
    let get = |k: usize, default: u64| given.get(k).copied().unwrap_or(default);
    let size = Size {
        places: get(0, 200) as usize,
        points: get(1, 50_000).max(1) as usize,
        level: get(2, 4) as u32,
        seed: get(3, 1),
    };
    let start = Instant::now();
    let mut wrong = 0;
    for example in &EXAMPLES {
        let found = study(example, size)?;
        print!("{found}");
        wrong += found.wrong.len();
    }
    println!("{wrong} bits differ beyond the slack; {:.1} s", start.elapsed().as_secs_f64());
    Ok(ExitCode::from(u8::from(wrong > 0)))
}
