//! Random faults in good NC programs of all dialects: how many verification finds, by kind, against a slow reference.
//!
//! `cargo run --release -p osculate-postproc --example mutate -- [FAULTS] [SEED]` (200 and 1 where not given); exits 1 where
//! a harmful fault was not found or a harmless one was called a fault.

#![allow(clippy::print_stdout, dead_code, reason = "a study prints its table")]

#[path = "../tests/mutation/study.rs"]
mod study;

use std::process::ExitCode;

/// Places of the reference along each side of the patch.
const SIDE: u32 = 81;

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let mut number = |default: u64| args.next().and_then(Result::ok).unwrap_or(default);
    let (count, seed) = (number(200), number(1));
    let programs = study::programs();
    study::check_good(&programs, SIDE);
    let rows = study::study(&programs, count as usize, seed, SIDE);
    println!(
        "{:<16} {:>6} {:>8} {:>6} {:>9} {:>12} {:>6}",
        "kind", "faults", "harmful", "found", "harmless", "false alarms", "close"
    );
    let mut sum = [0; 6];
    for (kind, c) in study::table(&rows) {
        println!("{kind:<16} {:>6} {:>8} {:>6} {:>9} {:>12} {:>6}", c[0], c[1], c[2], c[3], c[4], c[5]);
        sum = std::array::from_fn(|k| sum[k] + c[k]);
    }
    println!(
        "{:<16} {:>6} {:>8} {:>6} {:>9} {:>12} {:>6}",
        "all", sum[0], sum[1], sum[2], sum[3], sum[4], sum[5]
    );
    for row in rows.iter().filter(|r| r.right() != Some(true)) {
        let share = row.truth.map_or(f64::NAN, |t| t.share);
        let word = if row.right().is_none() { "close" } else { "WRONG" };
        println!(
            "{word}: {} tcp {} {}: {:?}, reference {share:.3} of the limit; {}",
            row.dialect, row.tcp, row.kind, row.says, row.fault
        );
    }
    ExitCode::from(u8::from(rows.iter().any(|r| r.right() == Some(false))))
}
