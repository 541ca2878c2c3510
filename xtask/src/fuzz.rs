//! `cargo xtask fuzz`: the targets of `fuzz/` built by the nightly compiler and run one after another, cargo-fuzz not needed.
//!
//! The workspace has no unsafe code, so that the targets are built without a sanitizer; what counts as found is a panic, an input that
//! takes longer than [`SLOWEST_S`], and more memory than [`MEMORY_MB`]. New inputs go to a folder below the target folder, which the next run
//! begins with beside the seeds of `fuzz/corpus`; what was found is kept there and shown.

use crate::cmd::{Failure, output, root, run};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Longest time of one input, s, and most memory, MiB.
const SLOWEST_S: u32 = 20;
const MEMORY_MB: u32 = 2048;
/// Largest input, bytes.
const LARGEST: u32 = 8192;
/// How libFuzzer sees where a program has been: counters, comparisons, and the places of both.
const FLAGS: [&str; 7] = [
    "--cfg=fuzzing",
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "-Cdebug-assertions",
];

/// What is asked for.
pub struct Options {
    /// Seconds of each target.
    seconds: u32,
    /// Only targets whose name has this.
    only: String,
}

impl Options {
    /// Of the words of the command line; none where they are wrong.
    pub fn of(words: &[&str]) -> Option<Self> {
        let mut out = Self { seconds: 60, only: String::new() };
        let mut rest = words.iter();
        while let Some(word) = rest.next() {
            let value = rest.next()?;
            match *word {
                "--seconds" => out.seconds = value.parse().ok()?,
                "--only" => out.only = (*value).to_owned(),
                _ => return None,
            }
        }
        Some(out)
    }
}

/// Builds the targets and runs each of them.
pub fn fuzz(options: &Options) -> Result<(), Failure> {
    let root = root()?;
    let nightly = Command::new("rustup").args(["run", "nightly", "rustc", "-vV"]).output();
    let about = nightly.ok().filter(|o| o.status.success()).and_then(|o| String::from_utf8(o.stdout).ok());
    let host = about.as_deref().and_then(|a| a.lines().find_map(|l| l.strip_prefix("host: ")));
    let host = host
        .ok_or(Failure::NoPeer { what: "the nightly compiler", how: "rustup toolchain install nightly" })?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let target = root.join(target).join("fuzz");
    let mut build = Command::new("rustup");
    // For the host by name: build scripts are not instrumented then.
    build.current_dir(root.join("fuzz")).args(["run", "nightly", "cargo", "build", "--release", "--locked"]);
    build.args(["--target", host, "--target-dir"]).arg(&target).env("RUSTFLAGS", FLAGS.join(" "));
    run(build)?;
    let mut found = 0;
    for name in targets(&root)?.iter().filter(|n| n.contains(&options.only)) {
        let (grown, kept) = (target.join("corpus").join(name), target.join("found").join(format!("{name}-")));
        for folder in [Some(grown.as_path()), kept.parent()].into_iter().flatten() {
            std::fs::create_dir_all(folder)
                .map_err(|why| Failure::Write { path: folder.to_path_buf(), why })?;
        }
        let mut one = Command::new(target.join(host).join("release").join(name));
        one.arg(&grown)
            .arg(root.join("fuzz/corpus").join(name))
            .arg(format!("-artifact_prefix={}", kept.display()));
        one.args([
            format!("-max_total_time={}", options.seconds),
            format!("-timeout={SLOWEST_S}"),
            format!("-rss_limit_mb={MEMORY_MB}"),
            format!("-max_len={LARGEST}"),
            "-print_final_stats=1".to_owned(),
        ]);
        let words = root.join(format!("fuzz/dictionaries/{name}.dict"));
        if words.is_file() {
            one.arg(format!("-dict={}", words.display()));
        }
        println!("{name}: {} s", options.seconds);
        if let Err(why) = run(one) {
            println!("{name}: {why}; the input is at {}*", kept.display());
            found += 1;
        }
    }
    if found == 0 { Ok(()) } else { Err(Failure::Mutants(found)) }
}

/// The names of the targets, from their manifest.
fn targets(root: &Path) -> Result<Vec<String>, Failure> {
    let path = root.join("fuzz/Cargo.toml");
    let mut metadata =
        crate::cmd::cargo(root, &["metadata", "--no-deps", "--format-version", "1", "--manifest-path"]);
    metadata.arg(&path);
    let text = output(metadata)?;
    let all: serde_json::Value = serde_json::from_str(&text)
        .map_err(|why| Failure::Answer { line: "cargo metadata".to_owned(), why: why.to_string() })?;
    let all = all["packages"][0]["targets"].as_array().cloned().unwrap_or_default();
    Ok(all.iter().filter_map(|t| t["name"].as_str().map(str::to_owned)).collect())
}
