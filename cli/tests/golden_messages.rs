//! What is said of bad input, word for word: what is wrong, where it stands, what would do, and what is near to it. Nothing is left behind.

use crate::common;
use common::{Scratch, job};
use std::process::Command;

enum File {
    Nothing,
    /// Name and text.
    Text(&'static str, &'static str),
    /// A job with a line put in place of another.
    Job(&'static str, &'static str),
}
use File::{Job, Nothing, Text};

struct Case {
    what: &'static str,
    file: File,
    args: &'static str,
    /// All of stderr.
    says: &'static str,
}

#[rustfmt::skip]
const CASES: &[Case] = &[
    Case { what: "an arc without end", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nMOVARC/-1000000,0,9,0,0,1,1000000,ANGLE,36000\nGOTO/0,0,9\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7: the arc asks for 7024815 moves, at most 100000: is a length in another unit, or a count wrong?\n" },
    Case { what: "a device as a program", file: Nothing, args: "time /dev/zero --machine 3-axis --dialect fanuc", says: "osculate: /dev/zero: line 1: longer than 65536 bytes: this is no program\n" },
    Case { what: "a speed that no spindle has", file: Job("spindle_rpm = 8000", "spindle_rpm = 1e308"), args: "plan job.toml --out out", says: "osculate: job.toml: line 16: [cutting] spindle_rpm = 1e308 must be a positive number up to 1000000, rpm\n" },
    Case { what: "a cutter of no width", file: Job("diameter_mm = 10", "diameter_mm = 0.0001"), args: "plan job.toml --out out", says: "osculate: job.toml: line 6: [tool] diameter_mm = 0.0001 must be a number from 0.001 to 1000000, mm\n" },
    Case { what: "a cycle of another form", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nCYCLE/TAP,50.7,1.0\nGOTO/0,0,0\nCYCLE/OFF\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7: CYCLE/TAP (1 x) is not interpreted and may change the tool's way\n  --lenient leaves such statements out and lists them\n" },
    Case { what: "a feed mode that the control reads otherwise", file: Job("name = \"trunnion-ac\"", "name = \"head-ca\""), args: "plan job.toml --out out", says: "osculate: job.toml: line 21: [machine] head-ca cannot be posted in dialect = \"linuxcnc\" with feed = \"tcp\": the machine file has no control.linuxcnc_tcp (the words that switch its kinematics): add it or choose a feed mode without tool-centre-point control\n" },
    Case { what: "compensation at the control", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nCUTCOM/LEFT\nGOTO/1,0,0\nCUTCOM/OFF\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7, 9: CUTCOM (2 x) is not interpreted and may change the tool's way\n  --cutcom centre says that points under CUTCOM are the cutter's centre, and posts them so\n  --lenient leaves such statements out and lists them\n" },
    Case { what: "a placing that scales", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nTRACUT/2,0,0,0,0,2,0,0,0,0,2,0\nGOTO/1,0,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7: TRACUT/ is not interpreted and may change the tool's way: its matrix does not keep lengths\n  --lenient leaves such statements out and lists them\n" },
    Case { what: "a copy over a tool change", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nINDEX/1\nGOTO/1,0,0\nLOADTL/2\nGOTO/2,0,0\nCOPY/1,SAME,2\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 11: COPY/ is not interpreted and may change the tool's way: another tool is called since its INDEX/\n  --lenient leaves such statements out and lists them\n" },
    Case { what: "copies of copies without end", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nINDEX/1\nGOTO/0,0,1\nINDEX/2\nGOTO/0,0,2\nCOPY/2,SAME,90000\nCOPY/1,SAME,90000\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 12: COPY/ asks for 500001 moves, at most 500000: is a length in another unit, or a count wrong?\n" },
    Case { what: "a word misspelt", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nGOTTO/1,0,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7: GOTTO (1 x) is not interpreted and may change the tool's way (is GOTO meant?)\n  --lenient leaves such statements out and lists them\n" },
    Case { what: "no number", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nGOTO/1,O,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7: 'O' in GOTO/ is not a finite number\n" },
    Case { what: "no points", file: Text("in.cl", "PARTNO/X\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: no GOTO/ or FROM/ in 2 lines: this is no cutter location data, or in binary form\n" },
    Case { what: "a feed per turn without a speed", file: Text("in.cl", "CUTTER/10\nFEDRAT/0.1,MMPR\nRAPID\nGOTO/0,0,9\nGOTO/0,0,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 2: a feed or dwell per revolution or a tap before any SPINDL/ in rpm: put SPINDL/ first, or use MMPM and seconds\n" },
    Case { what: "a move at feed before a feed", file: Text("in.cl", "CUTTER/10\nRAPID\nGOTO/0,0,9\nGOTO/0,0,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 4: a move that is not RAPID before any FEDRAT/: the feed is unknown\n" },
    Case { what: "a dwell in another unit", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nDELAY/1e9\nGOTO/0,0,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7: a dwell of 1000000000 s: from 0 to 36000 s\n" },
    Case { what: "a feed of nothing", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nFEDRAT/0\nGOTO/0,0,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7: a feed of 0.0 mm/min: it must be above zero, from 1e-6 to 1e9\n" },
    Case { what: "an axis of no length", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nGOTO/0,0,0,0,0,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7: the tool axis has length 0.000e0: give a direction\n" },
    Case { what: "an axis that the machine does not reach", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nGOTO/0,0,0,0,0,-1\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7, 9.000 mm on the way: CL move 1: at (0.000, 0.000, 0.000) joint A would be at -180.0000 deg, its range is -120.0000 to 120.0000 deg: move or turn the part in its setup, or change lead and tilt\n" },
    Case { what: "a path beyond the travel", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nGOTO/9000,0,0\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc", says: "osculate: in.cl: line 7, 9000.004 mm on the way: CL move 1: at (9000.000, 0.000, 0.000) joint X would be at 9000.0000 mm at the spindle nose, its range is -3000.0000 to 3000.0000 mm: move or turn the part in its setup, or change lead and tilt\n" },
    Case { what: "a machine misspelt", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nFINI\n"), args: "post in.cl --machine trunion-ac --dialect fanuc --out out.nc", says: "osculate: machine: there is no built-in machine \"trunion-ac\" (is trunnion-ac meant?); there are 3-axis, trunnion-ac, trunnion-bc, linuxcnc-xyzac, linuxcnc-xyzbc, head-ca, head-b-table-c, nutated-b-table-c, mill-turn-xyzc\n" },
    Case { what: "a dialect misspelt", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect sinumeric --out out.nc", says: "osculate: dialect: there is no dialect \"sinumeric\" (is sinumerik meant?); there are sinumerik, heidenhain, fanuc, linuxcnc, haas, mazak, sinumerik-one\n" },
    Case { what: "a work offset that the control has not", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out out.nc --work-offset G99", says: "osculate: --work-offset: no work offset is called 'G99'; there are G54 to G59, G59.1 to G59.3, G54.1 P1 and on, G505 to G599, G500 and 'preset 1' and on\n" },
    Case { what: "a result over the input", file: Text("in.cl", "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\nFINI\n"), args: "post in.cl --machine trunnion-ac --dialect fanuc --out in.cl", says: "osculate: in.cl: is what is read here: --out must name another file\n" },
    Case { what: "a call without end", file: Text("in.nc", "O1\nG17 G21 G90 G94\nG0 X0 Y0 Z10\nM98 P9 L9999999\nM30\nO9\nG0 X1\nM99\n"), args: "time in.nc --machine 3-axis --dialect fanuc --strict", says: "osculate: in.nc: line 4: more than 300000 lines run by calls and repeats: is a count wrong?\n" },
    Case { what: "a subprogram in itself", file: Text("in.nc", "O1\nG17 G21 G90 G94\nG0 X0 Y0 Z10\nM98 P9\nM30\nO9\nM98 P9\nM99\n"), args: "time in.nc --machine 3-axis --dialect fanuc --strict", says: "osculate: in.nc: line 7: more than 16 calls and repeats within each other: is a count wrong?\n" },
    Case { what: "a subprogram that is not there", file: Text("in.nc", "O1\nG17 G21 G90 G94\nG0 X0 Y0 Z10\nM98 P77\nM30\n"), args: "time in.nc --machine 3-axis --dialect fanuc --strict", says: "osculate: in.nc: line 4: M98 is not interpreted and may change the tool's way; read without `strict` to leave it out\n" },
    Case { what: "a jump", file: Text("in.nc", "O1\nG17 G21 G90 G94\nG0 X0 Y0 Z10\nIF [#1 LT 5] GOTO 10\nM30\n"), args: "time in.nc --machine 3-axis --dialect fanuc --strict", says: "osculate: in.nc: line 4: IF is not interpreted and may change the tool's way; read without `strict` to leave it out\n" },
    Case { what: "an arc whose ends miss its circle", file: Text("in.nc", "O1\nG17 G21 G90 G94\nG0 X0 Y0 Z10\nG2 X10 Y0 I3 J0 F100\nM30\n"), args: "time in.nc --machine 3-axis --dialect fanuc --strict", says: "osculate: in.nc: line 4: the ends of the arc miss one circle about its centre by 4.0000 mm\n" },
    Case { what: "a feed move without F", file: Text("in.nc", "O1\nG17 G21 G90 G94\nG0 X0 Y0 Z10\nG1 X10\nM30\n"), args: "time in.nc --machine 3-axis --dialect fanuc --strict", says: "osculate: in.nc: line 4: a feed move without an F above zero\n" },
    Case { what: "a program in another dialect", file: Text("in.nc", "0 BEGIN PGM A MM\n1 L X+0 Y+0 Z+9 FMAX\n2 END PGM A MM\n"), args: "time in.nc --machine 3-axis --dialect fanuc --strict", says: "osculate: in.nc: line 1: '0 BEGIN PGM A MM' is no word that can be read\n" },
    Case { what: "a key misspelt", file: Job("scallop_mm = 0.02", "scalop_mm = 0.02"), args: "plan job.toml --out out", says: "osculate: job.toml: line 9: [tolerance] scalop_mm is no key here; [tolerance] takes scallop_mm, gouge_mm, chord_mm, unreached_mm2 (is scallop_mm meant?)\n" },
    Case { what: "a tolerance of nothing", file: Job("scallop_mm = 0.02", "scallop_mm = 0"), args: "plan job.toml --out out", says: "osculate: job.toml: line 9: [tolerance] scallop_mm = 0 must be a number from 0.000001 to 1000, mm\n" },
    Case { what: "a dialect of a job misspelt", file: Job("dialect = \"linuxcnc\"", "dialect = \"linuxnc\""), args: "plan job.toml --out out", says: "osculate: job.toml: line 20: [machine] dialect = \"linuxnc\" must be one of \"sinumerik\", \"heidenhain\", \"fanuc\", \"linuxcnc\", \"haas\", \"mazak\", \"sinumerik-one\" (is \"linuxcnc\" meant?)\n" },
    Case { what: "a strategy misspelt", file: Job("kind = \"isoparametric\"", "kind = \"isoparametrc\""), args: "plan job.toml --out out", says: "osculate: job.toml: line 13: [strategy] kind = \"isoparametrc\" must be one of \"auto\", \"isoparametric\", \"regions\", \"isoplanar\", \"isoscallop\", \"streamline\", \"curvature_5c\", \"along_walls\", \"contour_2cl\", \"gradient_3c\", \"isoplanar_3c\", \"waterline_3c\", \"z_level\", \"flank\" (is \"isoparametric\" meant?)\n" },
];

#[test]
fn bad_input_is_told_word_for_word() {
    let mut off = Vec::new();
    for case in CASES {
        let scratch = Scratch::new();
        match case.file {
            Nothing => {}
            Text(name, text) => drop(scratch.write(name, text)),
            Job(from, to) => {
                let text = job(|j| {
                    assert!(j.contains(from), "{}", case.what);
                    j.replace(from, to)
                });
                scratch.write("job.toml", &text);
            }
        }
        let before = scratch.files();
        let mut run = Command::new(env!("CARGO_BIN_EXE_osculate"));
        let run = run.current_dir(scratch.path("")).args(case.args.split(' ')).output().expect("it starts");
        let says = String::from_utf8_lossy(&run.stderr);
        if run.status.code() != Some(1) || says != case.says || !run.stdout.is_empty() {
            off.push(format!("{}: {:?}\n{says}instead of\n{}", case.what, run.status.code(), case.says));
        }
        assert_eq!(scratch.files(), before, "{}: something is left behind", case.what);
    }
    assert!(off.is_empty(), "{}", off.join("\n"));
    assert!(CASES.len() >= 30);
}
