//! What the joints really did, judged as a program of its own: every servo cycle a straight move of 1 ms, with exact path. Blended corners are in it,
//! so that it needs no allowance for them; what it leaves and how deep it goes shows whether the allowance of the verdict is enough.

use super::programs::{Made, Setup};
use super::samples::{CUT, RAPID, rows};
use crate::cmd::{self, Failure};
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// What `plan` said of a program, and what of the way that it was driven: scallop with marks of teeth and gouge at samples, with what may hide between
/// them, mm, and the verdicts.
pub fn judged(osculate: &Path, made: &Made, (samples, top_mm): (&Path, f64)) -> Result<Value, Failure> {
    let read_text = |path: &Path| {
        std::fs::read_to_string(path).map_err(|why| Failure::Read { path: path.to_path_buf(), why })
    };
    let text = read_text(&made.program)?;
    let setup = Setup::of(&text, &made.program)?;
    let driven = made.program.with_file_name("driven.ngc");
    cmd::write(&driven, &program(&text, &read_text(samples)?, top_mm - setup.length_mm))?;
    let folder = made.program.parent().unwrap_or(Path::new("."));
    let mut verify = Command::new(osculate);
    verify.arg("verify").arg(&driven).arg("--job").arg(folder.join("../job.toml")).arg("--json");
    // A program that is not held fails, and says how far off it is.
    let line = format!("osculate verify, {}", driven.display());
    let answer = verify.output().map_err(|why| Failure::Start { line: line.clone(), why })?;
    let summary = read_text(&folder.join("summary.json"))?;
    let [Ok(driven), Ok(planned)] =
        [&answer.stdout[..], summary.as_bytes()].map(serde_json::from_slice::<Value>)
    else {
        return Err(Failure::Answer { line, why: String::from_utf8_lossy(&answer.stderr).into_owned() });
    };
    let told = |figures: &Value, verdict: &Value| {
        let number = |key: &str| figures[key].as_f64();
        let keys = ["height_max_mm", "hidden_scallop_mm", "gouge_max_mm", "hidden_gouge_mm"];
        serde_json::json!({ "mm": keys.map(number), "answer": verdict["answer"] })
    };
    Ok(serde_json::json!({
        "planned": told(&planned["verification"], &planned["verdict"]),
        "driven": told(&driven, &driven["verdict"]),
        "blend_mm": setup.blend_mm,
    }))
}

/// The head of a program up to its first move without `G53`, and a move for every row.
fn program(text: &str, samples: &str, z_mm: f64) -> String {
    let moves =
        |l: &&str| l.starts_with(['X', 'Y', 'Z', 'A', 'C']) || l.starts_with("G0 ") || l.starts_with("G1 ");
    let head: Vec<&str> = text.lines().take_while(|l| !moves(l)).filter(|l| !l.starts_with("G64")).collect();
    let mut out = head.join("\n") + "\nG61\n";
    let mut kind = 0;
    for row in rows(samples) {
        let [x, y, z, a, c] = row.joints;
        let to = format!("X{x:.4} Y{y:.4} Z{:.4} A{a:.4} C{c:.4}", z + z_mm);
        match row.kind {
            RAPID if kind == RAPID => out += &to,
            RAPID => {
                let _ = write!(out, "G94\nG0 {to}");
            }
            k if CUT.contains(&k) => {
                let word = if CUT.contains(&kind) { "" } else { "G93\nG1 " };
                let _ = write!(out, "{word}{to} F60000");
            }
            _ => continue,
        }
        kind = row.kind;
        out.push('\n');
    }
    out + "G94\nM5\nG53 G0 Z0\nM30\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_become_a_program_of_moves_one_by_one() {
        let text = "G21 G90\nG64 P0.001\nG53 G0 Z0\nG43 H1\nS9000 M3\nG0 X1 Y2 Z3 A0 C0\nG93\nG1 X2 Y2 Z3 A0 C0 F60\nG94\nG53 G0 Z0\nM30\n";
        // A rapid, two feed moves about an arc, a row at rest, and a rapid.
        let samples = "1 1 2 13 0 0 1 6\n2 1.5 2 13 0 0 2 8\n3 2 2 13 1.25 -0.5 3 8\n4 2 2 13 1.25 -0.5 0 8\n5 2 2 20 1.25 -0.5 1 10\n";
        let want = "G21 G90\nG53 G0 Z0\nG43 H1\nS9000 M3\nG61\nG94\nG0 X1.0000 Y2.0000 Z3.0000 A0.0000 C0.0000\n\
                    G93\nG1 X1.5000 Y2.0000 Z3.0000 A0.0000 C0.0000 F60000\nX2.0000 Y2.0000 Z3.0000 A1.2500 C-0.5000 F60000\n\
                    G94\nG0 X2.0000 Y2.0000 Z10.0000 A1.2500 C-0.5000\nG94\nM5\nG53 G0 Z0\nM30\n";
        assert_eq!(program(text, samples, -10.0), want);
    }
}
