//! A program run to its end with what it took: wall time, processor time and the greatest memory.

use crate::cmd::Failure;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// How often a running program is asked for its memory and processor time.
const EVERY: Duration = Duration::from_millis(20);
/// Ticks of the system's clock in a second, in which it counts processor time: the same on every Linux.
const TICKS_PER_S: f64 = 100.0;

/// What a run took.
#[derive(Debug, Clone, Copy, Default)]
pub struct Measured {
    /// From its start to its end, s.
    pub wall_s: f64,
    /// Processor time in user mode, up to the last look at it, s; only on systems that tell it.
    pub cpu_s: Option<f64>,
    /// The greatest memory, MB; only on systems that tell it.
    pub memory_mb: Option<f64>,
    /// Its exit status, where it ended by itself.
    pub code: Option<i32>,
}

/// Runs a program without terminal and output.
///
/// # Errors
/// Where it cannot be started.
pub fn run(mut command: Command) -> Result<Measured, Failure> {
    command.stdout(Stdio::null()).stderr(Stdio::null());
    run_to(command, Duration::MAX)
}

/// Runs a program without terminal, whose output goes where the command says; it is ended after so long.
///
/// # Errors
/// Where it cannot be started.
pub fn run_to(mut command: Command, limit: Duration) -> Result<Measured, Failure> {
    let program = command.get_program().to_string_lossy().into_owned();
    let begun = Instant::now();
    let mut child =
        command.stdin(Stdio::null()).spawn().map_err(|why| Failure::Start { line: program.clone(), why })?;
    let place = format!("/proc/{}", child.id());
    let mut out = Measured::default();
    loop {
        let done = child.try_wait().map_err(|why| Failure::Start { line: program.clone(), why })?;
        if let Some(status) = done {
            out.code = status.code();
            out.wall_s = begun.elapsed().as_secs_f64();
            return Ok(out);
        }
        let read = |name: &str| std::fs::read_to_string(format!("{place}/{name}")).ok();
        out.memory_mb = read("status").and_then(|t| memory_mb(&t)).or(out.memory_mb);
        out.cpu_s = read("stat").and_then(|t| cpu_s(&t)).or(out.cpu_s);
        if begun.elapsed() > limit {
            // It has ended by itself meanwhile where this fails.
            let _ = child.kill();
        }
        std::thread::sleep(EVERY);
    }
}

/// The greatest memory that a status of the system tells.
fn memory_mb(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kb: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kb / 1024.0)
}

/// Processor time in user mode: the fourteenth word, counted after the name in brackets, which may hold anything.
fn cpu_s(stat: &str) -> Option<f64> {
    let ticks: f64 = stat.rsplit_once(')')?.1.split_whitespace().nth(11)?.parse().ok()?;
    Some(ticks / TICKS_PER_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_system_are_read() {
        assert_eq!(memory_mb("Name:\tx\nVmHWM:\t    2048 kB\nVmRSS:\t 1 kB\n"), Some(2.0));
        assert_eq!(memory_mb("Name:\tx\n"), None);
        let stat = "7 (a ) b) R 1 2 3 4 5 6 7 8 9 10 250 30 0 0 20 0";
        assert_eq!(cpu_s(stat), Some(2.5));
    }

    #[test]
    fn an_exit_status_comes_back() {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args(["--list", "--no-such-option"]);
        let ran = run(command).unwrap();
        assert!(ran.code.is_some_and(|c| c != 0) && ran.wall_s > 0.0);
    }
}
