//! `cargo xtask mutate`: damaged files of every kind that the program reads, and what it makes of them.
//!
//! Files of a collection and of the examples are damaged at random ([`damage`]) and given to the verbs that read them, each run below 20
//! seconds of processor time and 2 GiB of memory. What counts as found is a panic, a signal, a run out of bounds, an exit code that
//! means none of what is documented, and success with nonsense in its answer: a length or an area that is no number. The same seed
//! gives the same files.

mod answer;
mod damage;
mod kind;
mod made;
mod seeds;

use crate::cmd::{Failure, program, root};
use damage::Dice;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Processor time of a run, s, and its memory, KiB.
const LIMITS: [u64; 2] = [20, 2 << 20];
/// Runs side by side.
const TOGETHER: usize = 2;

/// What is asked for.
pub struct Options {
    /// The collection.
    data: PathBuf,
    /// Damaged files in all.
    count: usize,
    /// Which ones.
    seed: u64,
    /// The program; built where not given.
    program: Option<PathBuf>,
    /// Where files that something was found with are kept.
    keep: Option<PathBuf>,
}

impl Options {
    /// Of the words of the command line; none where they are wrong.
    pub fn of(words: &[&str]) -> Option<Self> {
        let (mut data, mut program, mut keep) = (None, None, None);
        let (mut count, mut seed) = (1000, 1);
        let mut rest = words.iter();
        while let Some(word) = rest.next() {
            let value = rest.next()?;
            match *word {
                "--data" => data = Some(PathBuf::from(value)),
                "--count" => count = value.parse().ok()?,
                "--seed" => seed = value.parse().ok()?,
                "--program" => program = Some(PathBuf::from(value)),
                "--keep" => keep = Some(PathBuf::from(value)),
                _ => return None,
            }
        }
        Some(Self { data: data?, count, seed, program, keep })
    }
}

/// What is wrong with a run, with the file that it was on.
struct Found {
    number: usize,
    what: String,
    line: String,
}

/// Damages files and runs the program on them.
pub fn run(options: &Options) -> Result<(), Failure> {
    let root = root()?;
    let program = program(&root, options.program.as_ref())?;
    let scratch = std::env::temp_dir().join(format!("osculate-mutate-{}", std::process::id()));
    let seeds = seeds::all(&options.data, &root, &program, &scratch.join("made"))?;
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<Found>> = Mutex::new(Vec::new());
    let codes: Mutex<BTreeMap<(String, i32), usize>> = Mutex::new(BTreeMap::new());
    let work = |worker: usize| -> Result<(), Failure> {
        let folder = scratch.join(worker.to_string());
        std::fs::create_dir_all(&folder).map_err(|why| Failure::Write { path: folder.clone(), why })?;
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= options.count {
                return Ok(());
            }
            let mut dice = Dice::new(options.seed.wrapping_mul(0x1_0000_0001).wrapping_add(number as u64));
            let (seed, turn) = seeds.nth(number);
            let bytes = damage::damaged(&seed.bytes, &mut dice);
            let file = folder.join(&seed.name);
            std::fs::write(&file, &bytes).map_err(|why| Failure::Write { path: file.clone(), why })?;
            for (name, text) in &seed.beside {
                let path = folder.join(name);
                std::fs::write(&path, text).map_err(|why| Failure::Write { path, why })?;
            }
            for arguments in seed.runs(turn) {
                let (code, what, line) = run_one(&program, &folder, &arguments, LIMITS)?;
                *lock(&codes).entry((arguments[0].clone(), code)).or_default() += 1;
                let Some(what) = what else { continue };
                println!("{number}: {what}: {line}");
                if let Some(keep) = &options.keep {
                    let path = keep.join(format!("{number}-{}", seed.name));
                    let kept = std::fs::create_dir_all(keep).and_then(|()| std::fs::write(&path, &bytes));
                    kept.map_err(|why| Failure::Write { path, why })?;
                }
                lock(&found).push(Found { number, what, line });
            }
        }
    };
    let results: Vec<Result<(), Failure>> = std::thread::scope(|scope| {
        let all: Vec<_> = (0..TOGETHER).map(|k| scope.spawn(move || work(k))).collect();
        all.into_iter().filter_map(|t| t.join().ok()).collect()
    });
    // Left over, it only takes room.
    let _ = std::fs::remove_dir_all(&scratch);
    results.into_iter().collect::<Result<Vec<_>, _>>()?;
    for ((verb, code), runs) in codes.into_inner().unwrap_or_default() {
        println!("  {verb:<10} ended with {code:>4}: {runs:>6} runs");
    }
    let mut found = found.into_inner().unwrap_or_default();
    found.sort_by_key(|f| f.number);
    println!("{} files damaged of {} that are whole, {} findings", options.count, seeds.count(), found.len());
    for f in &found {
        println!("  {}: {}: {}", f.number, f.what, f.line);
    }
    if found.is_empty() { Ok(()) } else { Err(Failure::Mutants(found.len())) }
}

/// What a thread that failed has left is as good as what it would have.
fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// One run: its exit code (128 and the signal where one ended it), what is wrong with it, and its command line.
fn run_one(
    program: &Path,
    folder: &Path,
    arguments: &[String],
    [seconds, memory]: [u64; 2],
) -> Result<(i32, Option<String>, String), Failure> {
    let line = arguments.join(" ");
    let limited = format!("ulimit -t {seconds} && ulimit -v {memory} && exec \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &limited, "sh"]).arg(program).args(arguments).current_dir(folder);
    command.env("RAYON_NUM_THREADS", "2").stdin(Stdio::null());
    let output = command.output().map_err(|why| Failure::Start { line: line.clone(), why })?;
    let code = answer::code(output.status);
    let what = answer::wrong(code, &output.stdout, &String::from_utf8_lossy(&output.stderr));
    Ok((code, what, line))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    /// Both bounds of a run hold: a loop without end is stopped, and so is what asks for more memory than it may have.
    #[test]
    fn runs_are_stopped_at_their_bounds() {
        let run = |text: &str, limits| {
            let arguments = ["-c", text].map(str::to_owned);
            run_one(Path::new("/bin/sh"), &std::env::temp_dir(), &arguments, limits).expect("it starts")
        };
        let (code, what, _) = run("while :; do :; done", [1, 2 << 20]);
        assert!(code == 152 || code == 137, "{code}");
        assert_eq!(what.as_deref(), Some("out of time or memory"));
        let takes = "exec dd if=/dev/zero of=/dev/null bs=300M count=1";
        assert_eq!(run(takes, [20, 2 << 20]).0, 0);
        assert_ne!(run(takes, [20, 100 << 10]).0, 0);
    }
}
