//! Running the program as a user does.
#![allow(dead_code, clippy::unwrap_used)]

pub mod verdict;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder of its own that goes away with the test.
pub struct Scratch(PathBuf);

impl Scratch {
    /// A new empty folder below the build folder.
    pub fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let n = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{n}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// A path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file into it.
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Names of all files in it, hidden ones included.
    pub fn files(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(&self.0)
            .unwrap()
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // Left over, it only takes room below the build folder.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// What a run printed.
pub struct Run {
    /// Exit code.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// Runs the program.
pub fn osculate<S: AsRef<std::ffi::OsStr>>(args: &[S]) -> Run {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_osculate")).args(args).output().unwrap();
    Run {
        code: status.code().expect("the program ends by itself"),
        out: String::from_utf8(stdout).unwrap(),
        err: String::from_utf8(stderr).unwrap(),
    }
}

impl Run {
    /// The JSON object on stdout, which must be all there is.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}: {}{}", self.out, self.err))
    }

    /// Asserts a refusal with exit code 1 whose message has all these words.
    pub fn refused(&self, words: &[&str]) {
        assert_eq!(self.code, 1, "{}{}", self.out, self.err);
        for w in words {
            assert!(self.err.contains(w), "'{w}' is missing in: {}", self.err);
        }
        assert!(!self.err.contains("panicked"), "{}", self.err);
    }
}

/// A small job on a built-in patch; `change` edits its text.
pub fn job(change: impl Fn(String) -> String) -> String {
    change(
        r#"format = 1
[part]
builtin = { kind = "paraboloid", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 6 }
[tool]
kind = "ball"
diameter_mm = 10
length_mm = 50
[tolerance]
scallop_mm = 0.02
gouge_mm = 0.005
chord_mm = 0.003
[strategy]
kind = "isoparametric"
lead_deg = 15
[cutting]
spindle_rpm = 8000
feed_mm_min = 2000
[machine]
name = "trunnion-ac"
dialect = "linuxcnc"
feed = "tcp"
[verification]
max_samples = 20000
"#
        .to_owned(),
    )
}

/// Asserts a number of an answer to a relative tolerance.
pub fn close(got: &serde_json::Value, want: f64, relative: f64) {
    let got = got.as_f64().unwrap();
    assert!((got - want).abs() <= relative * want.abs(), "{got} against {want}");
}
