//! One million blocks posted, read back for their time: how long it takes and how much memory it needs.
//!
//! `cargo run --release -p osculate-postproc --example million [BLOCKS]`. The CL text is written first; what is timed
//! is from CL text to NC text, and from NC text to the time of the program.
#![allow(clippy::print_stdout, clippy::expect_used)]

use osculate_postproc::nc::timing::time;
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post_to};
use std::fmt::Write;
use std::time::Instant;

/// Peak of the process's memory so far, MB, where the system tells.
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:")).unwrap_or_default();
    line.split_whitespace().next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1024.0
}

/// CPU seconds of all threads so far, where the system tells (in hundredths).
fn cpu_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit(')').next().unwrap_or_default();
    // utime and stime are the 14th and 15th field of the line, the 12th and 13th behind the name.
    let ticks: f64 = after.split_whitespace().skip(11).take(2).filter_map(|t| t.parse::<f64>().ok()).sum();
    ticks / 100.0
}

fn main() {
    let blocks: u32 = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    let mut cl = String::from("UNITS/MM\nSPINDL/8000,RPM\nRAPID\nGOTO/0,0,10,0,0.3,1\nFEDRAT/2000,MMPM\n");
    for i in 0..blocks {
        let t = f64::from(i) * 0.01;
        let (s, c) = (0.05 * t).sin_cos();
        let lean = 0.3 + 0.1 * (0.031 * t).sin();
        writeln!(
            cl,
            "GOTO/{:.4},{:.4},{:.4},{:.6},{:.6},{:.6}",
            60.0 * s,
            40.0 * (0.073 * t).sin(),
            10.0 + 5.0 * c,
            lean * c,
            lean * s,
            1.0
        )
        .expect("text");
    }
    let machine = Machine::built_in("trunnion-ac").expect("built in");
    let setup = Setup::default();
    println!("{blocks} CL points, {:.0} MB of text, peak {:.0} MB", cl.len() as f64 / 1e6, peak_mb());
    for (dialect, feed) in
        [(Dialect::Sinumerik, FeedMode::Kv { fgref_mm: None }), (Dialect::Sinumerik, FeedMode::Tcp)]
    {
        let (start, cpu) = (Instant::now(), cpu_s());
        let path = cldata::read(&cl).expect("CL").path;
        let read_s = start.elapsed().as_secs_f64();
        let (held, options) = (peak_mb(), PostOptions::new(dialect, feed));
        let place = std::env::temp_dir().join(format!("osculate-million-{}.nc", std::process::id()));
        let mut file = std::fs::File::create(&place).expect("a file for the program");
        let posted = post_to(&path, &machine, &setup, &options, &mut file).expect("posts");
        let post_s = start.elapsed().as_secs_f64();
        let n = posted.summary.blocks;
        println!(
            "{dialect} {feed:?}: {n} blocks, CL read in {read_s:.2} s, posted after {post_s:.2} s (CPU {:.2} s), peak {:.0} MB, {held:.0} MB of them with the path read",
            cpu_s() - cpu,
            peak_mb()
        );
        let text = std::fs::read_to_string(&place).expect("the program");
        std::fs::remove_file(&place).expect("the program");
        let (start, cpu) = (Instant::now(), cpu_s());
        let timed = time(&text, dialect, &machine, &setup, true).expect("reads");
        println!(
            "  time {:.2} min in {:.2} s (CPU {:.2} s), peak {:.0} MB",
            timed.time.time_min(),
            start.elapsed().as_secs_f64(),
            cpu_s() - cpu,
            peak_mb()
        );
    }
}
