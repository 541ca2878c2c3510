//! Programs with several tools through LinuxCNC's interpreter, with the tool table that is written beside them.
//!
//! `osculate plan` makes `xtask/interop/list.toml` for both tilting tables of LinuxCNC and three ways to word motions. Of every
//! program the interpreter must accept all lines, call the tools of the operations in their order, put in force the length that the
//! table has and the speed that the CL file has, and each operation's moves, with that length, must meet its CL points in order.

use std::collections::BTreeMap;
use std::path::Path;

use super::linuxcnc::{Kins, Witness, call, canonical, prepare, pygcode, straight};
use crate::cmd::{self, Failure};

/// The stand-alone interpreter has a machine that counts in inches, and no key for another one: a table in mm is read as inches.
const TABLE_MM: f64 = 25.4;
/// Tools as `list.toml` calls them, with cutter and holder as long as it says, mm.
const TOOLS: [(u32, f64); 3] = [(4, 30.0), (17, 62.5), (9, 33.5)];
/// The interpreter prints four decimals.
const PRINTED_MM: f64 = 1e-4;

/// What the interpreter makes of a program between two tool changes.
#[derive(Default, Debug, PartialEq)]
struct Stretch {
    tool: f64,
    /// Lengths that it puts in force.
    lengths_mm: Vec<f64>,
    rpm: Vec<f64>,
    moves: Vec<[f64; 6]>,
    feeds: usize,
}

/// What a CL file says.
struct Cl {
    tool: f64,
    rpm: f64,
    points: Vec<Vec<f64>>,
}

/// Plans, posts and compares.
pub(super) fn run(witness: &Witness) -> Result<(), Failure> {
    let Witness { root, unpacked, kins, work } = witness;
    let list = root.join("xtask/interop/list.toml");
    let text = read(&list)?;
    let mut out = Vec::new();
    println!("{:<34} {:>7} {:>12} {:>12}", "operation", "points", "tip mm", "axis deg");
    for kind in ["xyzac", "xyzbc"] {
        for feed in ["tcp", "none", "inverse_time"] {
            let folder = work.join("lists").join(format!("{kind}-{feed}"));
            let job = folder.join("job.toml");
            let of = text.replace("\"MACHINE\"", &format!("\"linuxcnc-{kind}\""));
            cmd::write(&job, &of.replace("\"FEED\"", &format!("\"{feed}\"")))?;
            let made = folder.join("out");
            let mut plan = cmd::cargo(root, &["run", "-q", "--locked", "-p", "osculate", "--", "plan"]);
            plan.arg(&job).arg("--out").arg(&made).arg("--json");
            cmd::output_quietly(plan)?;
            prepare(root, &made)?;
            let program = made.join("program.ngc");
            let stretches = stretches(&canonical(unpacked, &made, &program)?);
            let kins = Kins::new((kins, unpacked), kind, feed != "tcp");
            let name = format!("{kind}-{feed}");
            if let Some(why) = wrong(&name, &made, &stretches, kins)? {
                return Err(Failure::Answer { line: format!("rs274 {}", program.display()), why });
            }
            out.push(program);
        }
    }
    println!(
        "{} programs: tools, lengths and speeds come in their order, and moves meet CL points",
        out.len()
    );
    pygcode(work, &out)
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|why| Failure::Read { path: path.to_path_buf(), why })
}

/// What is wrong with a program, if anything.
fn wrong(
    name: &str,
    folder: &Path,
    stretches: &[Stretch],
    mut kins: Kins,
) -> Result<Option<String>, Failure> {
    let table = table(&read(&folder.join("tool.tbl"))?);
    if table != BTreeMap::from(TOOLS) {
        return Ok(Some(format!("tool.tbl has {table:?} instead of {TOOLS:?}")));
    }
    let mut files = Vec::new();
    while folder.join(format!("path-{}.cl", files.len() + 1)).exists() {
        files.push(cl(&read(&folder.join(format!("path-{}.cl", files.len() + 1)))?));
    }
    let order = |tools: Vec<f64>| tools.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let [called, wanted] =
        [stretches.iter().map(|s| s.tool).collect(), files.iter().map(|c| c.tool).collect()].map(order);
    let listed = order(TOOLS.map(|(tool, _)| f64::from(tool)).to_vec());
    if called != wanted || wanted != listed {
        return Ok(Some(format!("tools {called} are called instead of {wanted}")));
    }
    for (k, (stretch, cl)) in stretches.iter().zip(&files).enumerate() {
        let Some(length_mm) = table.get(&(cl.tool as u32)) else {
            return Ok(Some(format!("tool.tbl has no T{}", cl.tool)));
        };
        let lengths_mm: Vec<f64> = stretch.lengths_mm.iter().map(|l| l / TABLE_MM).collect();
        if !matches!(lengths_mm.as_slice(), [one] if (one - length_mm).abs() < PRINTED_MM) {
            return Ok(Some(format!("lengths of T{}: {lengths_mm:?} instead of {length_mm}", cl.tool)));
        }
        if stretch.rpm != [cl.rpm] || stretch.feeds == 0 {
            return Ok(Some(format!("T{} turns at {:?} instead of {}", cl.tool, stretch.rpm, cl.rpm)));
        }
        kins.length_mm = *length_mm;
        let worst = kins.meets(&stretch.moves, &cl.points)?;
        let name = format!("{name} {} T{}", k + 1, cl.tool);
        let verdict = if worst.fine() { "" } else { "  OFF" };
        println!("{name:<34} {:>7} {:>12.6} {:>12.6}{verdict}", worst.points, worst.tip_mm, worst.axis_deg);
        if !worst.fine() {
            return Ok(Some(format!("operation {} misses CL points", k + 1)));
        }
    }
    Ok(None)
}

/// Canonical calls by tool: what comes before the first change belongs to none.
fn stretches(text: &str) -> Vec<Stretch> {
    let mut out: Vec<Stretch> = Vec::new();
    let mut selected = f64::NAN;
    for (name, numbers) in text.lines().filter_map(call) {
        if name == "SELECT_TOOL" {
            selected = numbers.first().copied().unwrap_or(f64::NAN);
        }
        if name == "CHANGE_TOOL" {
            out.push(Stretch { tool: selected, ..Stretch::default() });
        }
        let Some(now) = out.last_mut() else { continue };
        match name {
            // Three of X Y Z first.
            "USE_TOOL_LENGTH_OFFSET" => now.lengths_mm.extend(numbers.get(2)),
            // The number of the spindle first.
            "SET_SPINDLE_SPEED" => now.rpm.extend(numbers.get(1)),
            _ => {
                now.moves.extend(straight(name, &numbers));
                now.feeds += usize::from(name == "STRAIGHT_FEED");
            }
        }
    }
    out
}

/// Lengths by tool number.
fn table(text: &str) -> BTreeMap<u32, f64> {
    let word = |line: &str, letter: char| -> Option<f64> {
        line.split(';').next()?.split_whitespace().find_map(|w| w.strip_prefix(letter)?.parse().ok())
    };
    text.lines().filter_map(|l| Some((word(l, 'T')? as u32, word(l, 'Z')?))).collect()
}

fn cl(text: &str) -> Cl {
    let numbers = |word: &str| {
        let rows = text.lines().filter_map(move |l| l.strip_prefix(word));
        rows.map(|r| r.split(',').filter_map(|n| n.parse().ok()).collect()).collect::<Vec<Vec<f64>>>()
    };
    let first = |word| numbers(word).first().and_then(|n| n.first().copied()).unwrap_or(f64::NAN);
    Cl { tool: first("LOADTL/"), rpm: first("SPINDL/"), points: numbers("GOTO/") }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CALLS: &str = "    1 N..... STRAIGHT_TRAVERSE(0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)
    2 N..... SELECT_TOOL(17)
    3 N..... CHANGE_TOOL(2)
    4 N..... USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 762.0000, 0.0000 0.0000 0.0000, 0.0000 0.0000 0.0000)
    5 N..... SET_SPINDLE_SPEED(0, 6000.0000)
    6 N..... COMMENT(\"STRAIGHT_FEED\")
    7 N..... STRAIGHT_FEED(7.0500, -9.2338, 4.0000, 0.0000, 0.0000, 5.0000)
";

    #[test]
    fn calls_are_taken_apart_by_tool() {
        let want = Stretch {
            tool: 17.0,
            lengths_mm: vec![762.0],
            rpm: vec![6000.0],
            moves: vec![[7.05, -9.2338, 4.0, 0.0, 0.0, 5.0]],
            feeds: 1,
        };
        assert_eq!(stretches(CALLS), [want]);
    }

    #[test]
    fn tables_and_paths_are_read() {
        let of = table("T4 P4 Z30.0000 D6.0000 ;flat 6\nT17 P17 Z62.5 D6 ;ball Z9\n");
        assert_eq!(of.into_iter().collect::<Vec<_>>(), [(4, 30.0), (17, 62.5)]);
        let of = cl("PARTNO x\nLOADTL/9\nSPINDL/9500,CLW\nRAPID\nGOTO/1,2,3,0,0,1\nFINI\n");
        assert_eq!((of.tool, of.rpm, of.points), (9.0, 9500.0, vec![vec![1.0, 2.0, 3.0, 0.0, 0.0, 1.0]]));
    }
}
