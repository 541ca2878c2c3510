//! What the program writes: only regular files are replaced, nothing that is read, never a part of a set, and nothing that
//! steers a terminal.
#![cfg(target_os = "linux")]

use crate::common;
use common::{Scratch, job, osculate};
use std::fs::OpenOptions;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const HULL: &str = include_str!("data/hull.step");

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn export(part: &Path, out: &Path) -> common::Run {
    osculate(&["export", text(part), "--out", text(out)])
}

#[test]
fn only_regular_files_are_replaced() {
    let scratch = Scratch::new();
    let hull = scratch.write("hull.step", HULL);
    let pipe = scratch.path("pipe.step");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    export(&hull, &pipe).refused(&["pipe.step", "only regular files are replaced"]);
    assert!(pipe.symlink_metadata().unwrap().file_type().is_fifo());
    // A device, reached by a link in case it is replaced.
    let device = scratch.path("device.step");
    symlink("/dev/null", &device).unwrap();
    export(&hull, &device).refused(&["device.step", "only regular files are replaced"]);
    assert_eq!(device.read_link().unwrap(), Path::new("/dev/null"));
    let nowhere = scratch.path("nowhere.step");
    symlink(scratch.path("missing"), &nowhere).unwrap();
    export(&hull, &nowhere).refused(&["nowhere.step", "link"]);
    std::fs::create_dir(scratch.path("folder.step")).unwrap();
    export(&hull, &scratch.path("folder.step")).refused(&["folder.step", "is a folder"]);
    // A link to a file stays, and the file is replaced.
    let (old, link) = (scratch.write("old.step", "old"), scratch.path("link.step"));
    symlink("old.step", &link).unwrap();
    assert_eq!(export(&hull, &link).code, 0);
    assert_eq!(link.read_link().unwrap(), Path::new("old.step"));
    assert!(std::fs::read_to_string(old).unwrap().starts_with("ISO-10303-21"));
    // Of a set as well, and before the others are there.
    std::fs::create_dir_all(scratch.path("out")).unwrap();
    symlink("/dev/null", scratch.path("out/lines.json")).unwrap();
    let out = scratch.path("out");
    osculate(&["lines", text(&hull), "--out", text(&out)]).refused(&["lines.json", "only regular files"]);
    assert_eq!(std::fs::read_dir(out).unwrap().count(), 1);
}

#[test]
fn results_have_the_rights_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = Scratch::new();
    let (hull, out) = (scratch.write("hull.step", HULL), scratch.path("out.step"));
    assert_eq!(export(&hull, &out).code, 0);
    let mode = |p: &Path| p.metadata().unwrap().permissions().mode();
    assert_eq!(mode(&out), mode(&hull));
    assert_eq!(scratch.files(), ["hull.step", "out.step"]);
}

#[test]
fn what_is_read_is_not_overwritten() {
    let scratch = Scratch::new();
    let cl = "PARTNO/A\nUNITS/MM\nCUTTER/10,5,0,5,0,0,50\nFROM/0,0,50,0,0,1\nFEDRAT/500\nGOTO/0,0,10,0,0,1\nEND\nFINI\n";
    let path = scratch.write("a.cl", cl);
    std::fs::create_dir(scratch.path("f")).unwrap();
    for out in [path.clone(), scratch.path("f/../a.cl")] {
        osculate(&[
            "post",
            text(&path),
            "--machine",
            "trunnion-ac",
            "--dialect",
            "fanuc",
            "--out",
            text(&out),
        ])
        .refused(&["a.cl", "another file"]);
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap(), cl);
    let hull = scratch.write("hull.step", HULL);
    export(&hull, &hull).refused(&["hull.step", "another file"]);
    assert_eq!(std::fs::read_to_string(&hull).unwrap(), HULL);
}

#[test]
fn a_full_screen_is_heard_of_and_a_closed_one_is_not() {
    let scratch = Scratch::new();
    let hull = scratch.write("hull.step", HULL);
    for more in
        [&["inspect", text(&hull)][..], &["inspect", text(&hull), "--json"], &["machines"], &["--help"]]
    {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let program = || {
            let mut command = Command::new(env!("CARGO_BIN_EXE_osculate"));
            command.args(more);
            command
        };
        let done = program().stdout(full).stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(
            done.status.code() == Some(1) && said.contains("cannot be written to stdout"),
            "{more:?}: {said}"
        );
        // Nobody reads: the other end of the pipe is closed before anything is written.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let done = program().stdout(writer).stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(done.status.code() == Some(0) && said.is_empty(), "{more:?}: {:?} {said}", done.status);
    }
}

#[test]
fn a_full_disk_leaves_no_part_of_a_set() {
    let scratch = Scratch::new();
    let path = scratch.write("job.toml", &job(|j| j));
    let out = scratch.path("out");
    let earlier = "of an earlier run";
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("program.ngc"), earlier).unwrap();
    // No file of more than 64 blocks of 512 bytes: path and program fit, the report does not.
    let limited = r#"trap "" XFSZ; ulimit -f 64; exec "$0" "$@""#;
    let done = Command::new("sh")
        .args(["-c", limited, env!("CARGO_BIN_EXE_osculate"), "plan", text(&path), "--out", text(&out)])
        .output()
        .unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.code() == Some(1) && said.contains("cannot be written"), "{said}");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1, "{said}");
    assert_eq!(std::fs::read_to_string(out.join("program.ngc")).unwrap(), earlier);
    // Where all of it fits all of it is there.
    let run = osculate(&["plan", text(&path), "--out", text(&out)]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(std::fs::read_to_string(out.join("program.ngc")).unwrap() != earlier);
    assert!(out.join("report.html").metadata().unwrap().len() > 64 * 512);
}

#[test]
fn one_run_at_a_time_has_a_folder() {
    let scratch = Scratch::new();
    let path = scratch.write("job.toml", &job(|j| j));
    let out = scratch.path("deep/out");
    let claim = osculate::files::claim(&out).unwrap();
    assert!(claim.is_locked());
    osculate(&["plan", text(&path), "--out", text(&out)]).refused(&["another run", "--out"]);
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0);
    // A folder that was made for nothing goes away.
    drop(claim);
    assert!(!out.exists());
    std::fs::create_dir(&out).unwrap();
    drop(osculate::files::claim(&out).unwrap());
    assert!(out.exists());
}

#[test]
fn names_do_not_steer_the_terminal() {
    let scratch = Scratch::new();
    // As bytes of the file, as escapes of the format, and as the eight-bit form of the same control character.
    let names = ["\u{1b}[31mred\u{7}", r"\X\1B[31mred", r"\X2\009B0031006D\X0\red", r"\X\0Ared"];
    for (k, name) in names.iter().enumerate() {
        let file = format!("{k}\u{1b}[2J.step");
        let hull = HULL.replace("ADVANCED_FACE(''", &format!("ADVANCED_FACE('{name}'"));
        let part = scratch.write(&file, &hull);
        let run = osculate(&["inspect", text(&part)]);
        assert_eq!(run.code, 0, "{}", run.err);
        let json = osculate(&["inspect", text(&part), "--json"]);
        let name = json.json()["faces"][0]["name"].as_str().unwrap().to_owned();
        assert!(name.ends_with("red") || name.ends_with("red\u{7}"), "{name:?}");
        assert!(run.out.contains("red"), "{}", run.out);
        let missing = osculate(&["inspect", text(&scratch.path(&format!("no {file}")))]);
        assert!(missing.err.contains("\\u{1b}[2J.step"), "{}", missing.err);
        let all = [run.out, json.out, missing.err].concat();
        assert!(all.chars().all(|c| c == '\n' || !c.is_control()), "{all:?}");
    }
}

#[test]
fn what_is_no_part_is_not_repeated() {
    let scratch = Scratch::new();
    let secret = "root:x:secret:19000\nanother: secret\n";
    let shadow = scratch.write("shadow", secret);
    let machine = scratch.write("shadow.toml", secret);
    let program = scratch.write("a.nc", "G0 X1\n");
    let runs = [
        osculate(&["inspect", text(&shadow)]),
        osculate(&["export", text(&shadow), "--out", text(&scratch.path("a.step"))]),
        osculate(&["time", text(&program), "--dialect", "fanuc", "--machine", text(&machine)]),
    ];
    for run in runs {
        run.refused(&["shadow"]);
        assert!(!run.err.contains("secret") && !run.out.contains("secret"), "{}{}", run.out, run.err);
    }
    let said = |name: &str, text: &str| {
        let path: PathBuf = scratch.write(name, text);
        osculate(&["inspect", path.to_str().unwrap()]).err
    };
    assert!(said("a.stl", "solid a\nendsolid a\n").contains("STL: there is no triangle in it"));
    assert!(said("a.pdf", "%PDF-1.4\n").contains("a PDF document"));
    assert!(said("a.txt", "It was a dark and stormy night.\n").contains("other text"));
}

#[test]
fn a_file_whose_faces_are_all_lost_is_no_success() {
    let scratch = Scratch::new();
    // The surface of the only face is gone.
    let part = scratch
        .write("lost.step", &HULL.replace("ADVANCED_FACE('',(#18),#40", "ADVANCED_FACE('',(#18),#99999"));
    let run = osculate(&["inspect", text(&part)]);
    assert!(run.out.contains("0 faces") && run.out.contains("lost"), "{}", run.out);
    run.refused(&["lost.step", "no face"]);
    let json = osculate(&["inspect", text(&part), "--json"]);
    let answer = json.json();
    assert_eq!((json.code, answer["faces"].as_array().unwrap().len()), (1, 0));
    assert!(answer["error"]["what"].as_str().unwrap().contains("no face"), "{answer}");
}
