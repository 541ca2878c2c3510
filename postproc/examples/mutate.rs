//! Random faults in good NC programs of all dialects: how many verification finds, by kind, against a slow reference.
//!
//! `cargo run --release -p osculate-postproc --example mutate -- [FAULTS] [SEED]` (200 and 1 where not given); exits 1 where
//! a harmful fault was not found or a harmless one was called a fault.

#![allow(clippy::print_stdout, reason = "a study prints its table")]

#[path = "../tests/mutation/study/mod.rs"]
mod study;

use std::process::ExitCode;
use study::Count;

/// Places of the reference along each side of the patch.
const SIDE: u32 = 49;

fn line(kind: &str, c: &Count) -> String {
    let counts = [c.faults, c.harmful, c.found, c.harmless, c.alarms, c.garbled, c.close];
    let cells: Vec<String> = counts.iter().map(|n| format!("{n:>9}")).collect();
    format!("{kind:<16}{}", cells.join(""))
}

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let mut number = |default: u64| args.next().and_then(Result::ok).unwrap_or(default);
    let (count, seed) = (number(200), number(1));
    let programs = study::programs();
    println!("good programs, largest share of a limit by the reference:");
    for g in &programs {
        let (r, share) = (&g.recipe, study::check_good(g, SIDE));
        let tool = if g.cutter.is_ball() { "ball" } else { "toroidal" };
        println!("  {:<18} {:<11} {:<9} {:<7} {share:.2}", r.machine, r.dialect, tool, r.part.name());
    }
    let rows = study::study(&programs, count as usize, seed, SIDE);
    println!(
        "\n{:<16}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}",
        "kind", "faults", "harmful", "found", "harmless", "alarms", "refused", "close"
    );
    let mut sum = Count::default();
    for (kind, c) in study::table(&rows) {
        println!("{}", line(kind, &c));
    }
    rows.iter().for_each(|row| sum.add(row));
    println!("{}\n", line("all", &sum));
    for row in rows.iter().filter(|r| r.garbled() && r.kind != "garbled word") {
        println!("refused: {}: {}", row.kind, row.refused.as_deref().unwrap_or_default());
    }
    for row in rows.iter().filter(|r| r.right() != Some(true)) {
        let word = if row.right().is_none() { "close" } else { "WRONG" };
        let share = row.truth.unwrap_or(f64::INFINITY);
        println!(
            "{word}: {} {} {}, {}: {:?}, reference {share:.4} of the limit; {}",
            row.machine, row.dialect, row.part, row.kind, row.says, row.note
        );
    }
    ExitCode::from(u8::from(rows.iter().any(|r| r.right() == Some(false))))
}
