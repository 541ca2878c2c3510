//! The seeds of the fuzz targets, whole and damaged, through the same looks as the targets give them: no panic, none that does not end.
//! This stands for the fuzzer where the nightly compiler cannot be had.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[path = "../../../fuzz/looks/cl.rs"]
mod cl;
#[path = "../../../fuzz/looks/iges.rs"]
mod iges;
#[path = "../../../fuzz/looks/job.rs"]
mod job;
#[path = "../../../fuzz/looks/json.rs"]
mod json;
#[path = "../../../fuzz/looks/machine.rs"]
mod machine;
#[path = "../../../fuzz/looks/mesh.rs"]
mod mesh;
#[path = "../../../fuzz/looks/nc.rs"]
mod nc;
#[path = "../../../fuzz/looks/step.rs"]
mod step;

/// A look takes milliseconds on an idle machine; the tests run on loaded ones.
const LIMIT: Duration = Duration::from_secs(20);
/// Damaged forms of each seed.
const DAMAGED: u64 = 24;

fn seeds(kind: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(kind);
    let mut all: Vec<PathBuf> = std::fs::read_dir(&folder)
        .expect("a folder of seeds")
        .filter_map(Result::ok)
        .map(|e| e.path())
        .collect();
    all.sort();
    all
}

/// Numbers of a linear congruence (Knuth's): the same at every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, many: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % many.max(1)
    }
}

/// A seed cut short, with bits turned over, with a stretch of it twice or a number put in place of another.
fn damaged(whole: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut out = whole.to_vec();
    let at = dice.below(out.len());
    match dice.below(4) {
        0 => out.truncate(at),
        1 => (0..4).for_each(|_| {
            let at = dice.below(out.len());
            if let Some(b) = out.get_mut(at) {
                *b ^= 1 << dice.below(8);
            }
        }),
        2 => {
            let end = (at + 1 + dice.below(80)).min(out.len());
            let copy = out[at..end].to_vec();
            out.splice(at..at, copy);
        }
        _ => {
            let words = ["0", "-1", "1e308", "1e-308", "nan", "99999999999999999999", "2147483648", ""];
            if let Some(start) = out.iter().skip(at).position(u8::is_ascii_digit).map(|k| at + k) {
                let end =
                    out[start..].iter().position(|b| !b.is_ascii_digit()).map_or(out.len(), |k| start + k);
                out.splice(start..end, words[dice.below(words.len())].bytes());
            }
        }
    }
    out
}

fn looked(kind: &str, count: usize, look: fn(&[u8])) {
    let all = seeds(kind);
    assert_eq!(all.len(), count, "seeds of {kind}");
    let mut slow = String::new();
    for path in &all {
        let whole = std::fs::read(path).expect("a seed");
        let mut dice = Dice(whole.len() as u64);
        for k in 0..=DAMAGED {
            let bytes = if k == 0 { whole.clone() } else { damaged(&whole, &mut dice) };
            let begun = Instant::now();
            look(&bytes);
            if begun.elapsed() > LIMIT {
                writeln!(slow, "{} in its form {k}: {:?}", path.display(), begun.elapsed())
                    .expect("a string");
            }
        }
    }
    assert!(slow.is_empty(), "{slow}");
}

#[test]
fn step_files() {
    looked("step", 54, step::look);
}

#[test]
fn iges_files() {
    looked("iges", 35, iges::look);
}

#[test]
fn faces_as_json() {
    looked("json", 1, json::look);
}

#[test]
fn meshes() {
    looked("mesh", 7, mesh::look);
}

#[test]
fn programs() {
    looked("nc", 6, nc::look);
}

#[test]
fn cl_data() {
    looked("cl", 5, cl::look);
}

#[test]
fn machines_and_dialects() {
    looked("machine", 3, machine::look);
}

#[test]
fn jobs_and_libraries() {
    looked("job", 4, job::look);
}
