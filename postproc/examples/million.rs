//! One million blocks posted, read back for their time: how long it takes and how much memory it needs.
//!
//! `cargo run --release -p osculate-postproc --example million [BLOCKS [all | post]]`. The CL file is written first;
//! what is timed is from CL file to NC file, from NC file to the time of the program, and from NC file to the tool's
//! way. `all`: every dialect has its turn; `post`: only that.
#![allow(clippy::print_stdout, clippy::expect_used)]

use osculate_postproc::cldata::{ClReadOptions, ClStream};
use osculate_postproc::nc::timing::{Clock, Names};
use osculate_postproc::readback::{ReadOptions, Reader};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, post_from};
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use std::path::Path;
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

/// A CL file of so many points on a bumpy patch, the tool leaning by about 17 degrees.
fn cl_file(place: &Path, blocks: u32) -> io::Result<()> {
    let mut out = BufWriter::new(File::create(place)?);
    writeln!(
        out,
        "UNITS/MM\nCUTTER/6,3,0,3,0,0,50\nSPINDL/8000,RPM\nRAPID\nGOTO/0,0,10,0,0.3,1\nFEDRAT/2000,MMPM"
    )?;
    for i in 0..blocks {
        let t = f64::from(i) * 0.01;
        let (s, c) = (0.05 * t).sin_cos();
        let lean = 0.3 + 0.1 * (0.031 * t).sin();
        let (x, y, z) = (60.0 * s, 40.0 * (0.073 * t).sin(), 10.0 + 5.0 * c);
        writeln!(out, "GOTO/{x:.4},{y:.4},{z:.4},{:.6},{:.6},{:.6}", lean * c, lean * s, 1.0)?;
    }
    writeln!(out, "FINI")
}

fn each_line(place: &Path, mut take: impl FnMut(&str)) -> io::Result<()> {
    let mut reader = BufReader::new(File::open(place)?);
    let mut line = String::new();
    while reader.read_line(&mut line)? > 0 {
        take(line.trim_end());
        line.clear();
    }
    Ok(())
}

/// Says what a step took.
fn step<T>(what: &str, run: impl FnOnce() -> T) -> T {
    let (start, cpu) = (Instant::now(), cpu_s());
    let answer = run();
    let (wall, cpu) = (start.elapsed().as_secs_f64(), cpu_s() - cpu);
    println!("  {what:<44} wall {wall:6.2} s, CPU {cpu:5.2} s, peak so far {:4.0} MB", peak_mb());
    answer
}

fn main() -> io::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let blocks: u32 = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    let what = arguments.next().unwrap_or_default();
    let folder = std::env::temp_dir().join(format!("osculate-million-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let (cl, nc) = (folder.join("path.cl"), folder.join("program.nc"));
    cl_file(&cl, blocks)?;
    let machine = Machine::built_in("trunnion-ac").expect("built in");
    let setup = Setup::default();
    println!("{blocks} CL points, {:.0} MB of text", std::fs::metadata(&cl)?.len() as f64 / 1e6);
    let kv = FeedMode::Kv { fgref_mm: None };
    let mut modes = vec![(Dialect::Sinumerik, kv), (Dialect::Sinumerik, FeedMode::Tcp)];
    if what == "all" {
        modes.push((Dialect::Heidenhain, FeedMode::Tcp));
        modes.push((Dialect::Fanuc, FeedMode::InverseTime));
        modes.push((Dialect::LinuxCnc, FeedMode::Kf));
    }
    for (dialect, feed) in modes {
        println!("{dialect} {feed:?}");
        let options = PostOptions { spindle_rpm: Some(8000.0), ..PostOptions::new(dialect, feed) };
        let source = ClStream::new(|| File::open(&cl).map(BufReader::new), ClReadOptions::default());
        let mut file = File::create(&nc)?;
        let posted = step("posted, from CL file to NC file", || {
            post_from(&source, &machine, &setup, &options, &mut file).expect("posts")
        });
        if what == "post" {
            println!("  {} blocks", posted.summary.blocks);
            continue;
        }
        let mut names = Names::new(dialect, &machine);
        let timed = step("timed, from NC file", || {
            each_line(&nc, |line| names.line(line)).expect("reads");
            let mut clock = Clock::new(&names, &machine, &setup, true).expect("a setup");
            each_line(&nc, |line| clock.line(line).expect("our own words")).expect("reads");
            clock.finish().expect("a whole program")
        });
        let mut points = 0;
        step("read back to the tool's way, from NC file", || {
            let options = ReadOptions::default();
            let mut reader = Reader::new(&names, &machine, &setup, &options).expect("a setup");
            each_line(&nc, |line| {
                reader.line(line).expect("our own words");
                points += reader.take_moves().count();
                reader.take_blocks();
            })
            .expect("reads");
            reader.end().expect("moves");
        });
        let (blocks, minutes) = (posted.summary.blocks, timed.time.time_min());
        println!("  {blocks} blocks, {points} points read back, {minutes:.2} min on the machine");
    }
    std::fs::remove_dir_all(&folder)
}
