//! A program with three tools on LinuxCNC itself, on its two sample machines with a tilting table, limits on.
//!
//! The packages' files are laid over the system in a mount namespace of their own, so that nothing is installed; who may not do that
//! is told that the simulation is not run. `osculate post` makes the program of `xtask/interop/three-tools.cl` for machine files with
//! the limits, speeds and places of the INI files. LinuxCNC homes and runs it to its end without a screen: no message may come, no
//! joint may leave its limits, and wherever a tool is among its CL points its tip, which the shipped kinematics find from the joints, must
//! be on the way between them. It takes as long as the machine would: about a minute each.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::apart::apart;
use super::headless::{Headless, Ran, hindrance};
use super::linuxcnc::{Kins, Witness};
use crate::cmd::{self, Failure};

/// Where the sample configurations lie in the packages.
const SAMPLE: &str =
    "usr/share/doc/linuxcnc/examples/sample-configs/sim/axis/vismach/5axis/table-rotary-tilting";
/// A tip may be off the way by so much, mm: corners, chords and rounding.
const WAY_MM: f64 = 0.002;
/// What of it the control may round corners by (`G64 P`).
const BLEND_MM: &str = "0.001";
/// Longest run, s: several times what the programs take.
const LIMIT_S: u32 = 400;

struct Sample {
    kind: &'static str,
    /// As its INI file sets the pins of its kinematics.
    pins: &'static [&'static str],
    /// Limits of its joints, mm and deg.
    limits: [[f64; 2]; 5],
}

const SAMPLES: [Sample; 2] = [
    Sample {
        kind: "xyzac",
        pins: &["y-offset=20", "z-offset=10"],
        limits: [[-200.0, 200.0], [-100.0, 100.0], [-120.0, 120.0], [-100.0, 50.0], [-36000.0, 36000.0]],
    },
    Sample {
        kind: "xyzbc",
        pins: &["x-offset=-20", "z-offset=-15"],
        limits: [[-200.0, 200.0], [-100.0, 100.0], [-120.0, 120.0], [-36000.0, 36000.0], [-36000.0, 36000.0]],
    },
];

/// Runs both machines, where that can be done.
pub(super) fn run(witness: &Witness) -> Result<(), Failure> {
    if let Some(why) = hindrance() {
        println!("LinuxCNC itself is not run: {why}");
        return Ok(());
    }
    let cl = witness.root.join("xtask/interop/three-tools.cl");
    let text = std::fs::read_to_string(&cl).map_err(|why| Failure::Read { path: cl.clone(), why })?;
    let ways = ways(&text);
    println!("{:<34} {:>7} {:>12}", "LinuxCNC runs, to the end", "places", "tip mm");
    for sample in &SAMPLES {
        let (program, lines) = post(witness, &cl, sample.kind)?;
        let ran = simulate(witness, sample.kind, &program)?;
        if let Some(why) = wrong(&ran, lines, &sample.limits) {
            return Err(Failure::Answer { line: format!("LinuxCNC, {}", program.display()), why });
        }
        for (tool, way) in &ways {
            let (places, worst) = off(witness, sample, &ran, (*tool, way))?;
            println!("{:<34} {places:>7} {worst:>12.6}", format!("{} T{tool}", sample.kind));
            if places < 20 || worst > WAY_MM {
                let why = format!("T{tool}: {places} places, the tip is {worst} mm off its way");
                return Err(Failure::Answer { line: format!("LinuxCNC, {}", program.display()), why });
            }
        }
    }
    Ok(())
}

/// The program for a sample machine, and its number of lines.
fn post(witness: &Witness, cl: &Path, kind: &str) -> Result<(PathBuf, usize), Failure> {
    let program = witness.work.join("simulation").join(format!("three-{kind}.ngc"));
    cmd::write(&program, "")?;
    let machine = witness.root.join(format!("xtask/interop/sim-{kind}.toml"));
    let mut post = cmd::cargo(&witness.root, &["run", "-q", "--locked", "-p", "osculate", "--", "post"]);
    post.arg(cl).arg("--machine").arg(machine);
    post.args(["--dialect", "linuxcnc", "--feed", "tcp", "--json", "--blend-mm", BLEND_MM, "--out"])
        .arg(&program);
    cmd::output_quietly(post)?;
    let text =
        std::fs::read_to_string(&program).map_err(|why| Failure::Read { path: program.clone(), why })?;
    Ok((program, text.lines().count()))
}

/// The sample configuration without its screens.
fn configured(ini: &str, kind: &str) -> String {
    let mut out = String::new();
    for line in ini.lines() {
        let key = line.split('=').next().unwrap_or_default().trim();
        let own = format!("{kind}-trt-gui.");
        let left_out = matches!(
            key,
            "PYVCP" | "POSTGUI_HALFILE" | "HALUI" | "OPEN_FILE" | "INTRO_GRAPHIC" | "INTRO_TIME"
        ) || line.contains("loadusr -W");
        let line = match key {
            _ if left_out => continue,
            "DISPLAY" => "DISPLAY = ./ui".to_owned(),
            // The control waits this long for an answer, s; the machine may be busy.
            "COMM_TIMEOUT" => "COMM_TIMEOUT = 30".to_owned(),
            "HALFILE" => "HALFILE = LIB:basic_sim.tcl -no_use_hal_manualtoolchange".to_owned(),
            _ => line.split(' ').filter(|word| !word.starts_with(&own)).collect::<Vec<_>>().join(" "),
        };
        out += &line;
        out.push('\n');
    }
    out
}

/// Runs a program on a sample machine.
fn simulate(witness: &Witness, kind: &str, program: &Path) -> Result<Ran, Failure> {
    let folder = witness.work.join("simulation").join(kind);
    let sample = witness.unpacked.join(SAMPLE);
    std::fs::create_dir_all(&folder).map_err(|why| Failure::Write { path: folder.clone(), why })?;
    let mut copy = Command::new("cp");
    copy.arg("-rL").arg(sample.join(".")).arg(&folder);
    cmd::run(copy)?;
    let ini = folder.join(format!("{kind}-trt.ini"));
    let text = std::fs::read_to_string(&ini).map_err(|why| Failure::Read { path: ini.clone(), why })?;
    cmd::write(&ini, &configured(&text, kind))?;
    cmd::write(&folder.join(format!("{kind}-trt.tbl")), "T4 P4 Z30 D10\nT17 P17 Z25 D6\nT9 P9 Z40 D4\n")?;
    let headless = Headless {
        root: &witness.root,
        unpacked: &witness.unpacked,
        folder: &folder,
        ini: &ini,
        program,
        limit_s: LIMIT_S,
        clock: None,
    };
    headless.run()
}

/// What is wrong with a run, the program having so many lines.
fn wrong(ran: &Ran, lines: usize, limits: &[[f64; 2]; 5]) -> Option<String> {
    if let Some(message) = ran.messages.first() {
        return Some(format!("{} messages, the first: {message}", ran.messages.len()));
    }
    match &ran.end {
        // The last line is that of M30.
        Some((line, switches)) if line + 1 >= lines && switches.iter().all(|s| *s == 0) => {}
        end => {
            return Some(format!(
                "it ends so (line, limit switches): {end:?}; the program has {lines} lines"
            ));
        }
    }
    let beyond = |joints: &[f64; 5]| {
        (0..5).find(|k| joints[*k] < limits[*k][0] - 1e-6 || joints[*k] > limits[*k][1] + 1e-6)
    };
    let hit = ran.rows.iter().find_map(|row| Some((beyond(&row.2)?, row.2)))?;
    Some(format!("joint {} leaves its limits: {:?}", hit.0, hit.1))
}

/// Tips of the CL points of each tool.
fn ways(cl: &str) -> Vec<(u32, Vec<[f64; 3]>)> {
    let mut out: Vec<(u32, Vec<[f64; 3]>)> = Vec::new();
    for line in cl.lines() {
        if let Some(tool) = line.strip_prefix("LOADTL/").and_then(|n| n.parse().ok()) {
            out.push((tool, Vec::new()));
        }
        let numbers = line.strip_prefix("GOTO/").map(|n| n.split(',').filter_map(|n| n.parse().ok()));
        if let (Some(numbers), Some((_, way))) = (numbers, out.last_mut()) {
            let numbers: Vec<f64> = numbers.collect();
            way.extend(<[f64; 3]>::try_from(&numbers[..numbers.len().min(3)]));
        }
    }
    out
}

/// Places of a run where a tool is below its first CL point, and how far its tip is off its way there at most, mm.
fn off(
    witness: &Witness,
    sample: &Sample,
    ran: &Ran,
    (tool, way): (u32, &[[f64; 3]]),
) -> Result<(usize, f64), Failure> {
    let mut kins = Kins::new((&witness.kins, &witness.unpacked), sample.kind, true);
    let Some(length_mm) = ran.rows.iter().rfind(|r| r.0 == tool).map(|r| r.1) else { return Ok((0, 0.0)) };
    (kins.length_mm, kins.pins) = (length_mm, sample.pins);
    let joints: Vec<[f64; 6]> = ran
        .rows
        .iter()
        .filter(|r| r.0 == tool && r.1 == length_mm)
        .map(|r| [r.2[0], r.2[1], r.2[2], r.2[3], r.2[4], 0.0])
        .collect();
    let top = way.first().map_or(f64::NEG_INFINITY, |p| p[2]) - 0.01;
    let poses = kins.through("forward", &joints)?;
    let tips = poses.iter().map(|p| [p[0], p[1], p[2] - length_mm]).filter(|p| p[2] < top);
    let apart = tips.map(|p| {
        let pieces = way.windows(2).map(|w| apart(&p, &w[0], &w[1]));
        pieces.fold(f64::INFINITY, f64::min)
    });
    Ok(apart.fold((0, 0.0), |(count, worst), d| (count + 1, d.max(worst))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_judged() {
        let text = "at 3 4 30.000000 1.0 2.0 3.0 4.0 5.0\nend 9 0 0 0 0 0\n";
        let one = Ran::of(text);
        let limits = &SAMPLES[0].limits;
        assert_eq!(wrong(&one, 10, limits), None);
        assert!(wrong(&one, 30, limits).is_some_and(|w| w.contains("line")));
        let said = Ran::of(&format!("message Linear move exceeds limits\n{text}"));
        assert!(wrong(&said, 10, limits).is_some_and(|w| w.contains("exceeds")));
        let out = Ran::of(&text.replace("3.0", "121.0"));
        assert!(wrong(&out, 10, limits).is_some_and(|w| w.contains("joint 2")));
    }

    #[test]
    fn samples_lose_their_screens() {
        let ini = "[DISPLAY]\n PYVCP = a.xml\n DISPLAY = axis\nHALCMD = loadusr -W xyzac-trt-gui\n\
                   HALCMD = net :y  xyzac-trt-kins.y-offset xyzac-trt-gui.y-offset\nHALCMD = sets :y 20\n";
        let want =
            "[DISPLAY]\nDISPLAY = ./ui\nHALCMD = net :y  xyzac-trt-kins.y-offset\nHALCMD = sets :y 20\n";
        assert_eq!(configured(ini, "xyzac"), want);
    }

    #[test]
    fn ways_and_distances() {
        let all = ways("GOTO/9,9,9\nLOADTL/4\nGOTO/0,0,5,0,0,1\nGOTO/10,0,5\n");
        assert_eq!(all, [(4, vec![[0.0, 0.0, 5.0], [10.0, 0.0, 5.0]])]);
        assert_eq!(apart(&[5.0, 3.0, 9.0], &all[0].1[0], &all[0].1[1]), 5.0);
        assert_eq!(apart(&[13.0, 4.0, 5.0], &all[0].1[0], &all[0].1[1]), 5.0);
    }
}
