//! Reads a STEP or IGES file several times and prints the least seconds: `read_time TIMES FILE`.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [times, path] = arguments.as_slice() else {
        println!("usage: read_time TIMES FILE");
        return;
    };
    let bytes = std::fs::read(path).unwrap();
    let mut best = f64::INFINITY;
    let mut faces = 0;
    for _ in 0..times.parse::<usize>().unwrap() {
        let start = Instant::now();
        let part = osculate_surfaces::read(&bytes).unwrap();
        best = best.min(start.elapsed().as_secs_f64());
        faces = part.faces.len();
    }
    println!(
        "{{\"file\": \"{path}\", \"bytes\": {}, \"faces\": {faces}, \"read_s\": {best:.6}}}",
        bytes.len()
    );
}
