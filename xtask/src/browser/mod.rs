//! `cargo xtask browser`: reports of a few parts, opened, looked at and clicked in a real browser.
//!
//! Each report must be small and quick, show its part, and do what its buttons say; pictures of it are kept below `target/browser` for
//! a person to look at, and held against `xtask/browser/golden.json`: the mean colours of the fields of each picture, so that neither
//! fonts nor the smoothing of edges decide. Where no browser can be had the command fails and says how to get one.

mod chrome;
mod golden;
mod page;
mod report;

use crate::cmd::{Failure, program, root};
use chrome::Chrome;
use golden::Golden;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the command takes.
#[derive(Default)]
pub struct Options<'a> {
    only: &'a str,
    program: Option<&'a str>,
    report: Option<&'a str>,
    bless: bool,
}

impl<'a> Options<'a> {
    /// Words of the command line; None where one is unknown.
    pub fn of(words: &[&'a str]) -> Option<Self> {
        let mut out = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match *word {
                "--bless" => out.bless = true,
                "--only" => out.only = words.next()?,
                "--program" => out.program = Some(words.next()?),
                "--report" => out.report = Some(words.next()?),
                _ => return None,
            }
        }
        Some(out)
    }
}

/// A report that is looked at.
struct Looked {
    name: &'static str,
    job: &'static str,
    /// Whether its plan holds.
    held: bool,
}

/// A blade by five axes, a mould by several operations with neighbours that are only checked, and a plan that cuts too deep.
const LOOKED: [Looked; 3] = [
    Looked { name: "blade", job: "examples/eee-hpt-rotor2/job.toml", held: true },
    Looked { name: "mould", job: "examples/mould/job.toml", held: true },
    Looked { name: "gouge", job: "xtask/browser/gouge.toml", held: false },
];

/// Plans the parts, opens their reports and checks them; with `--report` that one alone, which has no goldens.
///
/// # Errors
/// Where there is no browser, a part cannot be planned, or a page does not do what it should.
pub fn run(options: &Options<'_>) -> Result<(), Failure> {
    let root = root()?;
    // Before anything takes time.
    let mut chrome = Chrome::start()?;
    chrome.warm()?;
    let out = root.join("target/browser");
    let mut golden = Golden::read(&root.join("xtask/browser/golden.json"))?;
    let mut wrong = Vec::new();
    if let Some(given) = options.report {
        let file = std::fs::canonicalize(given).map_err(|why| Failure::Read { path: given.into(), why })?;
        wrong.extend(report::check(&mut chrome, &file, &out.join("given"), None)?);
    } else {
        let program = program(&root, options.program)?;
        for looked in LOOKED.iter().filter(|l| l.name.contains(options.only)) {
            let folder = out.join(looked.name);
            let page = planned(&program, &root, looked, &folder)?;
            let golden = Some((&mut golden, looked.name, options.bless));
            let found = report::check(&mut chrome, &page, &folder, golden)?;
            wrong.extend(found.into_iter().map(|what| format!("{}: {what}", looked.name)));
        }
    }
    if options.bless {
        golden.write()?;
    }
    for what in &wrong {
        println!("browser: {what}");
    }
    println!("browser: pictures are in {}", out.display());
    if wrong.is_empty() { Ok(()) } else { Err(Failure::Pages(wrong.len())) }
}

/// Plans a part; its report.
fn planned(program: &Path, root: &Path, looked: &Looked, folder: &Path) -> Result<PathBuf, Failure> {
    println!("browser: {} ...", looked.name);
    // Results of an earlier run must not be taken for this one's.
    let _ = std::fs::remove_dir_all(folder);
    let mut plan = Command::new(program);
    plan.arg("plan").arg(root.join(looked.job)).arg("--out").arg(folder);
    let said = plan.output().map_err(|why| Failure::Start { line: format!("plan {}", looked.job), why })?;
    let page = folder.join("report.html");
    if said.status.success() != looked.held || !page.is_file() {
        eprintln!("{}", String::from_utf8_lossy(&said.stderr).trim_end());
        return Err(Failure::Status { line: format!("plan {}", looked.job), status: said.status });
    }
    Ok(page)
}
