//! One program on LinuxCNC: its folder with INI file, tool table and offsets, the run, and what the samples show.

use super::machine::Drives;
use super::programs::{Made, Setup};
use super::samples::{Place, Shown, read};
use super::tip::way;
use crate::cmd::{self, Failure};
use crate::interop::headless::{Clock, Headless, hindrance};
use crate::interop::unpacked;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The subprograms that switch the kinematics, in the packages.
const SWITCHES: &str =
    "usr/share/doc/linuxcnc/examples/sample-configs/sim/axis/vismach/5axis/table-rotary-tilting/remap_subs";
/// Longest run, s: the slowest clock and half an hour of cutting.
const LIMIT_S: u32 = 2000;
/// No clock is made slower than this.
const SLOWEST: f64 = 1.0;

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
    /// stands still: then the run is made anew with a slower one, and what the last of them shows counts.
    ///
    /// # Errors
    /// Where the control says anything or does not come to the last line.
    pub fn shown(
        &self,
        drives: &Drives,
        made: &Made,
        (folder, rate): (&Path, f64),
    ) -> Result<(Shown, f64), Failure> {
        let mut slower = rate;
        loop {
            let shown = self.once(drives, made, (folder, slower))?;
            let late = shown.idle_s > 0.0 || shown.lost > 0;
            if !late || slower <= SLOWEST {
                return Ok((shown, slower));
            }
            slower = (0.5 * slower).max(SLOWEST);
        }
    }

    fn once(&self, drives: &Drives, made: &Made, (folder, rate): (&Path, f64)) -> Result<Shown, Failure> {
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
            limit_s: LIMIT_S,
            clock: Some(Clock { library: &self.clock, rate }),
        };
        let ran = headless.run()?;
        let line = || format!("LinuxCNC, {}", made.program.display());
        if let Some(message) = ran.messages.first() {
            return Err(Failure::Answer { line: line(), why: message.clone() });
        }
        let lines = text.lines().count();
        if ran.end.as_ref().is_none_or(|(last, _)| last + 1 < lines) {
            let why =
                format!("it ends so (line, limit switches): {:?}; the program has {lines} lines", ran.end);
            return Err(Failure::Answer { line: line(), why });
        }
        let way = way(&read_text(&made.cl)?);
        let z_mm = drives.top_mm() - setup.length_mm;
        read(&folder.join("samples.txt"), &Place { z_mm, part_zero_mm: setup.part_zero_mm, way: &way })
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
