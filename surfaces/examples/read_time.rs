//! Reads a STEP or IGES file several times and prints the least seconds, and the most memory beyond the
//! file itself, in sizes of the file: `read_time TIMES FILE`.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [times, path] = arguments.as_slice() else {
        println!("usage: read_time TIMES FILE");
        return;
    };
    let bytes = std::fs::read(path).unwrap();
    let before = peak_kb();
    let mut best = f64::INFINITY;
    let mut faces = 0;
    for _ in 0..times.parse::<usize>().unwrap() {
        let start = Instant::now();
        let part = osculate_surfaces::read(&bytes).unwrap();
        best = best.min(start.elapsed().as_secs_f64());
        faces = part.faces.len();
    }
    println!(
        "{{\"file\": \"{path}\", \"bytes\": {}, \"faces\": {faces}, \"read_s\": {best:.6}, \"peak_of_file\": {:.2}}}",
        bytes.len(),
        1024.0 * (peak_kb() - before) / bytes.len() as f64
    );
}

/// The most memory that the process has had, kB; zero where the system does not say.
fn peak_kb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.trim().split(' ').next()?.parse().ok()).unwrap_or(0.0)
}
