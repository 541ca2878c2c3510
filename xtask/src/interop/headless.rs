//! LinuxCNC run without a screen and without being installed: it homes, runs one program to its end and writes down what happens.
//!
//! The packages' files are laid over the system in a mount namespace of their own. Shared memory and ports are of this run
//! alone too, so that it meets no other LinuxCNC. `xtask/interop/simulate.py` is its user interface.

use std::path::Path;
use std::process::Command;

use crate::cmd::{self, Failure};

/// Namespaces of a run's own: mounts, shared memory, network, processes.
const ALONE: [&str; 7] = ["-m", "-i", "-n", "-p", "-f", "--mount-proc", "--kill-child"];

/// What a run has written down.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Ran {
    /// Tool, length and joints.
    pub rows: Vec<(u32, f64, [f64; 5])>,
    pub messages: Vec<String>,
    /// The last line, and the limit switches of the joints.
    pub end: Option<(usize, Vec<u32>)>,
}

impl Ran {
    /// From the text that the user interface writes.
    pub fn of(text: &str) -> Self {
        let mut out = Self::default();
        for line in text.lines() {
            let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
            let numbers: Vec<f64> = rest.split(' ').filter_map(|n| n.parse().ok()).collect();
            match (word, &numbers[..]) {
                ("at", [_, tool, length, joints @ ..]) => {
                    if let Ok(joints) = <[f64; 5]>::try_from(joints) {
                        out.rows.push((*tool as u32, *length, joints));
                    }
                }
                ("end", [line, limits @ ..]) => {
                    out.end = Some((*line as usize, limits.iter().map(|l| *l as u32).collect()));
                }
                ("message", _) => out.messages.push(rest.to_owned()),
                _ => {}
            }
        }
        out
    }
}

/// What stands against running LinuxCNC here.
pub(crate) fn hindrance() -> Option<&'static str> {
    let tcl = Path::new("/usr/bin/tclsh8.6").exists();
    let python = Path::new("/usr/bin/python3.11").exists();
    if !(tcl && python) {
        return Some("it needs Debian's tcl8.6 and python3.11");
    }
    let mut try_mount = Command::new("unshare");
    try_mount.args(ALONE).args(["mount", "-t", "tmpfs", "none", "/mnt"]);
    let may = cmd::output_quietly(try_mount).is_ok();
    (!may).then_some("files can be laid over the system by root only")
}

/// A quicker clock for the realtime part: the library that makes it, and how many times as fast it runs.
pub(crate) struct Clock<'a> {
    pub library: &'a Path,
    pub rate: f64,
}

/// A configured machine with a program.
pub(crate) struct Headless<'a> {
    pub root: &'a Path,
    /// The packages' files.
    pub unpacked: &'a Path,
    /// Where it runs: the INI file's folder.
    pub folder: &'a Path,
    /// Its `DISPLAY` is `./ui`.
    pub ini: &'a Path,
    pub program: &'a Path,
    /// The program is given up after so long, s.
    pub limit_s: u32,
    /// None: the system's clock.
    pub clock: Option<Clock<'a>>,
}

impl Headless<'_> {
    /// Runs the program to its end.
    pub fn run(&self) -> Result<Ran, Failure> {
        let folder = self.folder;
        let drive = self.root.join("xtask/interop/simulate.py");
        let ui = format!("#!/bin/sh\nexec env -u LD_PRELOAD /usr/bin/python3.11 {}\n", drive.display());
        cmd::write(&folder.join("ui"), &ui)?;
        let mut allow = Command::new("chmod");
        allow.arg("+x").arg(folder.join("ui"));
        cmd::run(allow)?;
        let file = folder.join("ran.txt");
        cmd::write(&file, "")?;
        let script = "mount -t overlay overlay -o lowerdir=\"$OVER/usr\":/usr /usr && \
                      mount -t overlay overlay -o lowerdir=\"$OVER/etc\":/etc /etc && \
                      LD_PRELOAD=\"$CLOCK\" exec linuxcnc -r \"$INI\"";
        let mut start = Command::new("unshare");
        let longest = (self.limit_s + 100).to_string();
        start.current_dir(folder).args(ALONE).args(["timeout", "-k", "10", &longest, "sh", "-c", script]);
        start.env("OVER", self.unpacked).env("INI", self.ini).env("HOME", folder).env_remove("DISPLAY");
        start.env("PROGRAM", self.program).env("FILE", &file).env("MOST_S", self.limit_s.to_string());
        // The realtime part gives up root for a user that may write where all may.
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let fifo = std::env::temp_dir().join(format!("osculate-{}-{name}", std::process::id()));
        start.env("RTAPI_UID", "65534").env("RTAPI_FIFO_PATH", fifo);
        start.env("LD_LIBRARY_PATH", "/usr/lib").env("PYTHONPATH", "/usr/lib/python3/dist-packages");
        let clock = self.clock.as_ref();
        start.env("CLOCK", clock.map_or(Path::new(""), |c| c.library));
        start.env("CLOCK_RATE", clock.map_or(1.0, |c| c.rate).to_string());
        cmd::output_quietly(start)?;
        let text = std::fs::read_to_string(&file).map_err(|why| Failure::Read { path: file.clone(), why })?;
        Ok(Ran::of(&text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_read() {
        let one = Ran::of("at 3 4 30.000000 1.0 2.0 3.0 4.0 5.0\nmessage a b\nend 9 0 0 0 0 0\n");
        assert_eq!(one.rows, [(4, 30.0, [1.0, 2.0, 3.0, 4.0, 5.0])]);
        assert_eq!(one.messages, ["a b"]);
        assert_eq!(one.end, Some((9, vec![0; 5])));
    }
}
