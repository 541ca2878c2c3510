//! Running cargo and git in the workspace's root and writing files, with what went wrong in words.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

/// Why a command of xtask did not do its work.
#[derive(Debug)]
pub enum Failure {
    /// A program could not be started.
    Start {
        /// The command line.
        line: String,
        /// What the system said.
        why: io::Error,
    },
    /// A program ran and reported failure.
    Status {
        /// The command line.
        line: String,
        /// Its exit status.
        status: ExitStatus,
    },
    /// The answer of a program is not what its documentation promises.
    Answer {
        /// The command line.
        line: String,
        /// What is wrong with it.
        why: String,
    },
    /// A file could not be read.
    Read {
        /// The file, relative to the root.
        path: PathBuf,
        /// What the system said.
        why: io::Error,
    },
    /// A file could not be written.
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        why: io::Error,
    },
    /// No `Cargo.toml` with a `[workspace]` at or above the place where the search began.
    NoWorkspace(PathBuf),
    /// The rules of `tidy` that are broken.
    Untidy(usize),
    /// A program of others that a comparison needs is not there.
    NoPeer {
        /// What it is.
        what: &'static str,
        /// How to get it.
        how: &'static str,
    },
    /// Comparisons with another program that came out differently.
    Differs(usize),
    /// What a source file says cannot be told.
    Source {
        /// The file, relative to the root.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// Packages whose public items are not those that are kept.
    Interface(usize),
    /// What is wrong with pages in a browser.
    Pages(usize),
    /// Packages whose tests do not pass outside the repository.
    Packages(usize),
    /// Damaged files with which something was found.
    Mutants(usize),
    /// A step of `ci` failed.
    Step {
        /// The step.
        name: &'static str,
        /// What it said.
        why: Box<Failure>,
    },
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Start { line, why } => write!(f, "cannot start `{line}`: {why}"),
            Self::Status { line, status } => write!(f, "`{line}` failed with {status}"),
            Self::Answer { line, why } => write!(f, "`{line}` answered what cannot be used: {why}"),
            Self::Read { path, why } => write!(f, "cannot read {}: {why}", path.display()),
            Self::Write { path, why } => write!(f, "cannot write {}: {why}", path.display()),
            Self::Source { path, why } => write!(f, "{}: {why}", path.display()),
            Self::Interface(count) => write!(
                f,
                "the public items of {count} packages are not those in api, see above: where that is meant, run `cargo xtask api --bless` and \
                 let CHANGELOG.md name what breaks callers"
            ),
            Self::NoWorkspace(from) => {
                write!(f, "no Cargo.toml with a [workspace] at or above {}", from.display())
            }
            Self::NoPeer { what, how } => write!(f, "{what} is missing: {how}"),
            Self::Differs(count) => write!(f, "{count} parts came out differently, see above"),
            Self::Pages(count) => write!(f, "browser: {count} findings, see above"),
            Self::Packages(count) => write!(f, "{count} packages do not stand alone, see above"),
            Self::Mutants(count) => write!(f, "{count} findings on damaged files, see above"),
            Self::Untidy(1) => write!(f, "tidy: 1 finding, see above"),
            Self::Untidy(count) => write!(f, "tidy: {count} findings, see above"),
            Self::Step { name, why } => write!(f, "step {name} FAILED: {why}"),
        }
    }
}

/// The root of the workspace: the folder above xtask's manifest when cargo runs xtask, else the nearest folder at or
/// above the working directory whose `Cargo.toml` has a `[workspace]`.
pub fn root() -> Result<PathBuf, Failure> {
    let start = match std::env::var_os("CARGO_MANIFEST_DIR") {
        Some(folder) => PathBuf::from(folder),
        None => std::env::current_dir()
            .map_err(|why| Failure::Read { path: PathBuf::from("the working directory"), why })?,
    };
    let is_root = |folder: &&Path| {
        std::fs::read_to_string(folder.join("Cargo.toml"))
            .is_ok_and(|text| text.lines().any(|line| line.trim() == "[workspace]"))
    };
    let found = start.ancestors().find(is_root).map(Path::to_path_buf);
    found.ok_or(Failure::NoWorkspace(start))
}

/// A cargo command in the root, the same cargo that runs xtask.
pub fn cargo(root: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root).args(arguments);
    command
}

/// The command line as a person would type it, without the path of the program.
fn line(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|w| w.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

/// Runs the command with the terminal as its input and output.
pub fn run(mut command: Command) -> Result<(), Failure> {
    let line = line(&command);
    match command.status() {
        Err(why) => Err(Failure::Start { line, why }),
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Failure::Status { line, status }),
    }
}

/// Runs the command and returns its standard output; its standard error goes to the terminal.
pub fn output(mut command: Command) -> Result<String, Failure> {
    let line = line(&command);
    let answer = match command.stderr(std::process::Stdio::inherit()).output() {
        Err(why) => return Err(Failure::Start { line, why }),
        Ok(answer) => answer,
    };
    if !answer.status.success() {
        return Err(Failure::Status { line, status: answer.status });
    }
    String::from_utf8(answer.stdout).map_err(|why| Failure::Answer { line, why: why.to_string() })
}

/// As [`output`], with its standard error as the command has it.
pub fn output_quietly(mut command: Command) -> Result<String, Failure> {
    let line = line(&command);
    let answer = match command.output() {
        Err(why) => return Err(Failure::Start { line, why }),
        Ok(answer) => answer,
    };
    if !answer.status.success() {
        let said = String::from_utf8_lossy(&answer.stderr);
        eprintln!("{}", said.trim_end());
        return Err(Failure::Status { line, status: answer.status });
    }
    String::from_utf8(answer.stdout).map_err(|why| Failure::Answer { line, why: why.to_string() })
}

/// As [`output`], of a command that reads the text.
pub fn output_of(mut command: Command, input: &str) -> Result<String, Failure> {
    use std::io::Write;
    let said = line(&command);
    command.stdin(std::process::Stdio::piped()).stdout(std::process::Stdio::piped());
    let start = |why| Failure::Start { line: said.clone(), why };
    let mut child = command.spawn().map_err(start)?;
    let pipe = child.stdin.take();
    // A thread of its own writes, so that neither pipe fills up while the other one waits.
    let answer = std::thread::scope(|scope| {
        scope.spawn(|| pipe.map(|mut pipe| pipe.write_all(input.as_bytes())));
        child.wait_with_output()
    });
    let answer = answer.map_err(start)?;
    if !answer.status.success() {
        return Err(Failure::Status { line: said, status: answer.status });
    }
    String::from_utf8(answer.stdout).map_err(|why| Failure::Answer { line: said, why: why.to_string() })
}

/// Writes a text file and the folders above it.
pub fn write(to: &Path, text: &str) -> Result<(), Failure> {
    let made = to.parent().map_or(Ok(()), std::fs::create_dir_all);
    made.and_then(|()| std::fs::write(to, text)).map_err(|why| Failure::Write { path: to.to_path_buf(), why })
}

/// A release program that cargo has built: below the target folder that it uses.
pub fn built(root: &Path, name: &str) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    root.join(target).join("release").join(name)
}

/// The program that is given, or else the release one, built.
///
/// # Errors
/// Where it cannot be built.
pub fn program(root: &Path, given: Option<impl AsRef<Path>>) -> Result<PathBuf, Failure> {
    if let Some(given) = given {
        return Ok(given.as_ref().to_path_buf());
    }
    run(cargo(root, &["build", "--release", "--locked", "-p", "osculate"]))?;
    Ok(built(root, "osculate"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failing_program_is_reported_with_its_line() {
        let mut unknown = cargo(&root().unwrap(), &["no-such-command"]);
        unknown.stderr(std::process::Stdio::null());
        let failed = run(unknown).unwrap_err().to_string();
        assert!(failed.starts_with("`cargo no-such-command` failed with"), "{failed}");
        let missing = run(Command::new("osculate-no-such-program")).unwrap_err().to_string();
        assert!(missing.starts_with("cannot start"), "{missing}");
    }

    #[test]
    fn the_root_has_the_workspace_manifest() {
        let manifest = std::fs::read_to_string(root().unwrap().join("Cargo.toml")).unwrap();
        assert!(manifest.contains("members"));
    }
}
