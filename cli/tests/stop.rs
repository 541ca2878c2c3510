//! Stopping a run by a signal: how far it came is said, and no half file stays behind.
#![cfg(unix)]

use crate::common;
use common::{Scratch, job, osculate};
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A job that is planned at once and verified for a long time.
fn long_job() -> String {
    job(|j| {
        j.replace("scallop_mm = 0.02", "scallop_mm = 0.001")
            .replace("chord_mm = 0.003", "chord_mm = 0.0002")
            .replace("max_samples = 20000", "max_samples = 9000000\nspacing_mm = 0.005")
    })
}

/// Runs the job, sends the signal when `when` says so, and returns exit code, messages and the names of what was left.
fn stopped(
    scratch: &Scratch,
    signal: &str,
    when: impl Fn(Duration) -> bool,
) -> (Option<i32>, String, Vec<String>) {
    let path = scratch.write("job.toml", &long_job());
    let out = scratch.path("out");
    let child = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .args(["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap()])
        .env("RAYON_NUM_THREADS", "1")
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !when(start.elapsed()) {
        std::thread::sleep(Duration::from_millis(20));
    }
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let done = child.wait_with_output().unwrap();
    assert!(start.elapsed() < Duration::from_secs(60), "it did not stop");
    let mut left: Vec<String> = std::fs::read_dir(&out)
        .map(|d| d.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect())
        .unwrap_or_default();
    left.sort();
    (done.status.code(), String::from_utf8(done.stderr).unwrap(), left)
}

/// The words after "stopped in stage": the stage and the per cent.
fn stage(message: &str) -> (String, f64) {
    let mut words = message.split("stopped in stage ").nth(1).expect(message).split_whitespace();
    let name = words.next().unwrap().to_owned();
    assert_eq!(words.next(), Some("at"), "{message}");
    let percent = words.next().unwrap().parse().unwrap();
    assert_eq!(words.next(), Some("%;"), "{message}");
    (name, percent)
}

#[test]
fn a_stopped_plan_says_how_far_it_came_and_leaves_no_half_file() {
    for (signal, after_ms) in [("-INT", 150), ("-TERM", 4000)] {
        let scratch = Scratch::new();
        let (code, message, left) = stopped(&scratch, signal, |t| t.as_millis() >= after_ms);
        assert_eq!(code, Some(1), "{message}");
        let (name, percent) = stage(&message);
        assert!((0.0..=100.0).contains(&percent), "{message}");
        // A slow machine may be at another stage; what it says must fit what is there. Where the plan ends either may be so.
        if name == "start" || name == "import" || name == "plan" && left.is_empty() {
            assert!(message.contains("nothing was written") && left.is_empty(), "{message} {left:?}");
            continue;
        }
        assert_eq!(left, ["path.partial.cl"], "{message}");
        assert!(
            message.contains("path.partial.cl has the whole path, not posted and not verified"),
            "{message}"
        );
        // What is saved is a whole CL file.
        let partial = scratch.path("out").join("path.partial.cl");
        let program = scratch.path("p.ngc");
        let [machine, dialect] = ["trunnion-ac", "linuxcnc"];
        let (cl, nc) = (partial.to_str().unwrap(), program.to_str().unwrap());
        let post = osculate(&["post", cl, "--machine", machine, "--dialect", dialect, "--out", nc]);
        assert_eq!(post.code, 0, "{}", post.err);
    }
}

/// Runs a job, sends the signal once a stage has passed a per cent, and returns exit code, what was said after the lines of
/// progress, and the names of what was left.
fn stopped_at(
    scratch: &Scratch,
    text: &str,
    (stage, percent): (&str, f64),
) -> (Option<i32>, String, Vec<String>) {
    let path = scratch.write("job.toml", text);
    let out = scratch.path("out");
    let mut child = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .args(["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--progress"])
        .env("RAYON_NUM_THREADS", "1")
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let begins = format!("progress: {stage} ");
    let mut line = String::new();
    loop {
        line.clear();
        assert!(said.read_line(&mut line).unwrap() > 0, "it ended before {percent} % of {stage}");
        let there = line.strip_prefix(&begins).and_then(|l| l.split_whitespace().next());
        if there.is_some_and(|p| p.parse::<f64>().unwrap() >= percent) {
            break;
        }
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let mut rest = String::new();
    said.read_to_string(&mut rest).unwrap();
    let code = child.wait().unwrap().code();
    let last: Vec<&str> = rest.lines().filter(|l| !l.starts_with("progress: ")).collect();
    let mut left: Vec<String> = std::fs::read_dir(&out)
        .map(|d| d.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect())
        .unwrap_or_default();
    left.sort();
    (code, last.join("\n"), left)
}

/// In the middle of planning there is nothing to keep; in the middle of verification the whole path.
#[test]
fn a_job_cut_at_half_leaves_no_half_file() {
    let scratch = Scratch::new();
    let text = long_job().replace("scallop_mm = 0.001", "scallop_mm = 0.0005");
    let (code, message, left) = stopped_at(&scratch, &text, ("plan", 50.0));
    assert_eq!(code, Some(1), "{message}");
    let (name, percent) = stage(&message);
    assert!(name == "plan" && (50.0..=100.0).contains(&percent), "{message}");
    assert!(message.contains("nothing was written") && left.is_empty(), "{message} {left:?}");

    let scratch = Scratch::new();
    let text = long_job().replace("spacing_mm = 0.005", "spacing_mm = 0.015");
    let (code, message, left) = stopped_at(&scratch, &text, ("verify", 50.0));
    assert_eq!(code, Some(1), "{message}");
    let (name, percent) = stage(&message);
    assert!(name == "verify" && (50.0..=100.0).contains(&percent), "{message}");
    assert_eq!(left, ["path.partial.cl"], "{message}");
    // It is whole: to the last word a CL file, that posts.
    let text = std::fs::read_to_string(scratch.path("out").join("path.partial.cl")).unwrap();
    assert!(text.trim_end().ends_with("FINI"), "{}", &text[text.len().saturating_sub(200)..]);
}
