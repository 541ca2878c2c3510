//! One program on LinuxCNC: its folder with INI file, tool table and offsets, the run, and what the samples show.

use super::machine::Drives;
use super::programs::{Made, Setup};
use super::samples::{Place, Shown, read};
use super::tip::{turned, way};
use crate::cmd::{self, Failure};
use crate::interop::headless::{Clock, Headless, hindrance};
use crate::interop::unpacked;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The subprograms that switch the kinematics, in the packages.
const SWITCHES: &str =
    "usr/share/doc/linuxcnc/examples/sample-configs/sim/axis/vismach/5axis/table-rotary-tilting/remap_subs";
/// No clock is made slower than this: even a busy computer keeps up with it.
const SLOWEST: f64 = 5.0;
/// A run that takes longer than this, s, and so many times what it should is given up.
const LEAST_LIMIT_S: f64 = 60.0;
const PATIENCE: f64 = 4.0;

/// How a program is run.
#[derive(Clone, Copy)]
pub struct Pace<'a> {
    /// Where.
    pub folder: &'a Path,
    /// How many times as fast the control's clock runs.
    pub rate: f64,
    /// What the program should take on the control, s.
    pub expected_s: f64,
}

impl Pace<'_> {
    /// When a run is given up, s of the computer's clock.
    fn limit_s(&self) -> u32 {
        (LEAST_LIMIT_S + PATIENCE * self.expected_s / self.rate).ceil() as u32
    }
}

/// LinuxCNC, ready to run programs.
pub struct Control<'a> {
    root: &'a Path,
    unpacked: PathBuf,
    /// The quicker clock.
    clock: PathBuf,
}

impl<'a> Control<'a> {
    /// Unpacks the packages and builds the clock.
    ///
    /// # Errors
    /// Where LinuxCNC cannot be run here.
    pub fn new(root: &'a Path) -> Result<Self, Failure> {
        if let Some(how) = hindrance() {
            return Err(Failure::NoPeer { what: "a system that can run LinuxCNC", how });
        }
        let unpacked = unpacked(&root.join("target/interop"))?;
        let clock = root.join("target/control/clock.so");
        cmd::write(&clock, "")?;
        let mut compile = Command::new("gcc");
        compile.args(["-O1", "-shared", "-fPIC", "-o"]).arg(&clock);
        compile.arg(root.join("xtask/control/clock.c")).arg("-ldl");
        cmd::run(compile)?;
        Ok(Self { root, unpacked, clock })
    }

    /// Runs a program and reads its samples. On a busy computer blocks may come too late for a quick clock, and the control
    /// stands still: then the run is made anew with a slower one, until a run shows no stand or the same as the one before.
    ///
    /// # Errors
    /// Where the control says anything, or does not come to the last line within several times what the program should take.
    pub fn shown(&self, drives: &Drives, made: &Made, pace: &Pace<'_>) -> Result<(Shown, f64), Failure> {
        let mut rate = pace.rate;
        let mut before = None;
        loop {
            let shown = self.once(drives, made, &Pace { rate, ..*pace })?;
            let late = shown.idle_s > 0.0 || shown.lost > 0;
            let seen = (shown.feed_s, shown.idle_s, shown.lost);
            if !late || rate <= SLOWEST || before == Some(seen) {
                return Ok((shown, rate));
            }
            println!(
                "  {:.3} s idle and {} samples lost at {rate} times the clock: once more, slower",
                shown.idle_s, shown.lost
            );
            before = Some(seen);
            rate = (0.5 * rate).max(SLOWEST);
        }
    }

    fn once(&self, drives: &Drives, made: &Made, pace: &Pace<'_>) -> Result<Shown, Failure> {
        let Pace { folder, rate, .. } = *pace;
        let limit_s = pace.limit_s();
        let read_text = |path: &Path| {
            std::fs::read_to_string(path).map_err(|why| Failure::Read { path: path.to_path_buf(), why })
        };
        let text = read_text(&made.program)?;
        let setup = Setup::of(&text, &made.program)?;
        let ini = self.configure(folder, drives, &setup)?;
        let headless = Headless {
            root: self.root,
            unpacked: &self.unpacked,
            folder,
            ini: &ini,
            program: &made.program,
            limit_s,
            clock: Some(Clock { library: &self.clock, rate }),
        };
        let ran = headless.run()?;
        let line = || format!("LinuxCNC, {}", made.program.display());
        if let Some(message) = ran.messages.first() {
            return Err(Failure::Answer { line: line(), why: message.clone() });
        }
        let lines = text.lines().count();
        if ran.end.as_ref().is_none_or(|(last, _)| last + 1 < lines) {
            let why = format!(
                "after {limit_s} s at most it stands so (line, limit switches): {:?}; the program has {lines} lines. Its folder {} has what it wrote down",
                ran.end,
                folder.display()
            );
            return Err(Failure::Answer { line: line(), why });
        }
        let way = turned(way(&read_text(&made.cl)?), setup.turn);
        let z_mm = drives.top_mm() - setup.length_mm;
        let place = Place { z_mm, named_line: setup.named_line, part_zero_mm: setup.part_zero_mm, way: &way };
        read(&folder.join("samples.txt"), &place)
    }

    /// The control's files, for a program's setup.
    fn configure(&self, folder: &Path, drives: &Drives, setup: &Setup) -> Result<PathBuf, Failure> {
        if folder.exists() {
            std::fs::remove_dir_all(folder)
                .map_err(|why| Failure::Write { path: folder.to_path_buf(), why })?;
        }
        let ini = folder.join("machine.ini");
        cmd::write(&ini, &drives.ini())?;
        let mut copy = Command::new("cp");
        copy.arg("-rL").arg(self.unpacked.join(SWITCHES)).arg(self.root.join("xtask/control/machine.hal"));
        copy.arg(folder);
        cmd::run(copy)?;
        cmd::write(&folder.join("machine.tbl"), &format!("T1 P1 Z{}\n", setup.length_mm))?;
        // G54: the part's origin where X Y Z are the tip in the part, else the table's reference point.
        let [x, y, z] = if setup.tcp { setup.part_zero_mm } else { [0.0; 3] };
        let offsets = format!("5221\t{x}\n5222\t{y}\n5223\t{}\n", z - drives.top_mm());
        cmd::write(&folder.join("machine.var"), &offsets)?;
        // The sampler runs as a user that may write where all may.
        cmd::write(&folder.join("samples.txt"), "")?;
        let mut allow = Command::new("chmod");
        allow.arg("-R").arg("a+rwX").arg(folder);
        cmd::run(allow)?;
        Ok(ini)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_given_up() {
        let pace = Pace { folder: Path::new(""), rate: 20.0, expected_s: 1000.0 };
        assert_eq!(pace.limit_s(), 260);
    }
}
