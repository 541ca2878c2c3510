//! `cargo xtask package`: the packages as a registry would get them, built, and tested where there is no repository around them.
//!
//! `cargo publish --dry-run` says whether a registry would take them. What is packed is unpacked into a temporary folder, where the packages
//! are a workspace of their own, built there without what only tests need, and tested: what a package lacks, or reads from the repository,
//! fails. A package of which fewer tests pass than stand in it fails as well.
//!
//! Cargo's own check of what it packs is left out (`--no-verify`): from the second run on it builds a package on those below it as an earlier
//! run has unpacked them.

use crate::cmd::{Failure, cargo, output, root, run as run_command, write};
use serde_json::Value;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// How the command is called; printed with wrong usage.
pub const TAKES: &str = "package takes --allow-dirty and --only PACKAGE";

/// What is asked for.
#[derive(Debug, Default, PartialEq)]
pub struct Options<'a> {
    /// Changes that git has no commit of go into the packages too.
    dirty: bool,
    /// The one package whose tests are run.
    only: Option<&'a str>,
}

impl<'a> Options<'a> {
    /// The options of a command line; `None` where it is none.
    pub fn of(words: &[&'a str]) -> Option<Self> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match *word {
                "--allow-dirty" => options.dirty = true,
                "--only" => options.only = Some(words.next()?),
                _ => return None,
            }
        }
        Some(options)
    }
}

/// A package of the workspace that can be published.
struct Package {
    name: String,
    version: String,
}

impl Package {
    /// Its name with the version, as cargo names file and folder.
    fn stem(&self) -> String {
        format!("{}-{}", self.name, self.version)
    }
}

/// What the tests of an unpacked package came to.
#[derive(Debug, Default, PartialEq)]
struct Counts {
    passed: usize,
    failed: usize,
}

/// Packs, builds, unpacks and tests; prints a table.
pub fn run(options: &Options<'_>) -> Result<(), Failure> {
    let root = root()?;
    let metadata = output(cargo(&root, &["metadata", "--no-deps", "--format-version", "1", "--locked"]))?;
    let (packages, kept_back, target) = read(&metadata)?;
    let start = Instant::now();
    for verb in [["publish", "--dry-run"].as_slice(), &["package"]] {
        let mut arguments = [verb, &["--workspace", "--no-verify", "--locked", "--quiet"]].concat();
        kept_back.iter().for_each(|name| arguments.extend(["--exclude", name]));
        arguments.extend(options.dirty.then_some("--allow-dirty"));
        run_command(cargo(&root, &arguments))?;
    }
    println!("package: packed in {:.1} s", start.elapsed().as_secs_f64());

    let folder = std::env::temp_dir().join(format!("osculate-packages-{:016x}", number_of(&root)));
    // What a run that was ended has left.
    let _ = std::fs::remove_dir_all(&folder);
    let done = tested(options, &packages, &Places { root: &root, target: &target, folder: &folder });
    // Left over it only takes room; what failed is told above.
    let _ = std::fs::remove_dir_all(&folder);
    done
}

/// A number that a checkout keeps: two of them do not unpack into one folder, and cargo finds in it again what it has built.
fn number_of(root: &Path) -> u64 {
    let mut hasher = DefaultHasher::new();
    root.hash(&mut hasher);
    hasher.finish()
}

/// Where things are.
struct Places<'a> {
    root: &'a Path,
    /// Cargo's folder of builds.
    target: &'a Path,
    /// Where the packages are unpacked.
    folder: &'a Path,
}

fn tested(options: &Options<'_>, packages: &[Package], places: &Places<'_>) -> Result<(), Failure> {
    unpack(packages, places)?;
    let start = Instant::now();
    run_command(in_packages(places, &["build", "--workspace"]))?;
    println!("package: built in {:.1} s", start.elapsed().as_secs_f64());
    println!("package               size KiB  files  tests in it  passed       s");
    println!("-----------------------------------------------------------------");
    let mut wrong = 0;
    for package in packages.iter().filter(|p| options.only.is_none_or(|only| p.name == only)) {
        let start = Instant::now();
        let own = places.folder.join(package.stem());
        let (files, tests) = looked_at(&own)?;
        let archive = archive(package, places);
        let bytes = archive.metadata().map_err(|why| Failure::Read { path: archive, why })?.len();
        let counts = test(package, places)?;
        println!(
            "{:<21} {:>8.1} {files:>6} {tests:>12} {:>7} {:>7.1}",
            package.name,
            bytes as f64 / 1024.0,
            counts.passed,
            start.elapsed().as_secs_f64()
        );
        if let Some(what) = fault(&counts, tests) {
            println!("package: {}: {what}", package.name);
            wrong += 1;
        }
    }
    if wrong > 0 { Err(Failure::Packages(wrong)) } else { Ok(()) }
}

/// What is wrong with a package of which `tests` tests stand in its files.
fn fault(counts: &Counts, tests: usize) -> Option<String> {
    if counts.failed > 0 {
        return Some(format!("{} tests failed, see above", counts.failed));
    }
    let few = tests == 0 || counts.passed < tests;
    few.then(|| format!("{} tests passed of {tests} that stand in it", counts.passed))
}

/// The packages that can be published, the names of the others, and the folder of builds, from cargo's metadata.
fn read(metadata: &str) -> Result<(Vec<Package>, Vec<String>, PathBuf), Failure> {
    let wrong = |why: &str| Failure::Answer { line: "cargo metadata".to_owned(), why: why.to_owned() };
    let json: Value = serde_json::from_str(metadata).map_err(|e| wrong(&e.to_string()))?;
    let target = json["target_directory"].as_str().ok_or_else(|| wrong("no `target_directory`"))?;
    let all = json["packages"].as_array().ok_or_else(|| wrong("no array `packages`"))?;
    let (mut packages, mut kept_back) = (Vec::new(), Vec::new());
    for package in all {
        let (Some(name), Some(version)) = (package["name"].as_str(), package["version"].as_str()) else {
            return Err(wrong("a package without name or version"));
        };
        // `publish = false` is an empty list of registries.
        if package["publish"].as_array().is_some_and(Vec::is_empty) {
            kept_back.push(name.to_owned());
        } else {
            packages.push(Package { name: name.to_owned(), version: version.to_owned() });
        }
    }
    Ok((packages, kept_back, PathBuf::from(target)))
}

fn archive(package: &Package, places: &Places<'_>) -> PathBuf {
    places.target.join("package").join(package.stem() + ".crate")
}

/// Unpacks the packages side by side, and makes a workspace of them.
fn unpack(packages: &[Package], places: &Places<'_>) -> Result<(), Failure> {
    write(&places.folder.join("Cargo.toml"), &workspace(packages))?;
    let lock = places.folder.join("Cargo.lock");
    std::fs::copy(places.root.join("Cargo.lock"), &lock).map_err(|why| Failure::Write { path: lock, why })?;
    for package in packages {
        let mut tar = Command::new("tar");
        // Not with the times of the archive, which are the same whatever is in it: cargo would take what it built of the last one.
        tar.current_dir(places.folder).arg("-xzmf").arg(archive(package, places));
        run_command(tar)?;
    }
    Ok(())
}

/// The manifest: packages that need each other get each other and not what a registry may have under these names. Tests are optimised
/// as in the repository.
fn workspace(packages: &[Package]) -> String {
    let members: Vec<String> = packages.iter().map(|p| format!("\"{}\"", p.stem())).collect();
    let mut text =
        format!("[workspace]\nresolver = \"3\"\nmembers = [{}]\n\n[patch.crates-io]\n", members.join(", "));
    for package in packages {
        text += &format!("{} = {{ path = \"{}\" }}\n", package.name, package.stem());
    }
    text + "\n[profile.dev]\nopt-level = 2\ndebug = false\n\n[profile.dev.package.\"*\"]\nopt-level = 2\n"
}

/// A cargo command among the unpacked packages. What it builds is kept between runs, so that the next one builds less.
fn in_packages(places: &Places<'_>, arguments: &[&str]) -> Command {
    let mut command = cargo(places.folder, arguments);
    command.env("CARGO_TARGET_DIR", places.target.join("packaged"));
    command
}

/// Runs the tests of a package, doctests included; what they print is shown where one fails.
fn test(package: &Package, places: &Places<'_>) -> Result<Counts, Failure> {
    let mut command = in_packages(places, &["test", "--quiet", "--no-fail-fast", "-p", &package.name]);
    let line = format!("cargo test -p {}", package.name);
    let answer = command.output().map_err(|why| Failure::Start { line: line.clone(), why })?;
    let said = String::from_utf8_lossy(&answer.stdout).into_owned();
    let counts = counted(&said);
    if !answer.status.success() {
        println!("{said}{}", String::from_utf8_lossy(&answer.stderr));
        if counts.failed == 0 {
            return Err(Failure::Status { line, status: answer.status });
        }
    }
    Ok(counts)
}

/// The sums of all lines `test result: ok. 3 passed; 0 failed; ...`.
fn counted(said: &str) -> Counts {
    let mut counts = Counts::default();
    for line in said.lines().filter_map(|line| line.strip_prefix("test result: ")) {
        let of = |what: &str| {
            let mut words = line.split([' ', ';', '.']).filter(|w| !w.is_empty()).peekable();
            let mut last = 0;
            words.find_map(|word| {
                if word == what { Some(last) } else { word.parse().map(|n| last = n).ok().and(None) }
            })
        };
        counts.passed += of("passed").unwrap_or(0);
        counts.failed += of("failed").unwrap_or(0);
    }
    counts
}

/// How many files lie below a folder, and how many tests stand in its folders `src` and `tests`, without doctests.
fn looked_at(folder: &Path) -> Result<(usize, usize), Failure> {
    let (mut files, mut tests) = (0, 0);
    let mut folders = vec![folder.to_path_buf()];
    while let Some(at) = folders.pop() {
        let failed = |why| Failure::Read { path: at.clone(), why };
        for entry in std::fs::read_dir(&at).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            files += 1;
            let counts = ["src", "tests"].iter().any(|top| path.starts_with(folder.join(top)));
            if counts && path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).map_err(failed)?;
                tests += text.lines().filter(|line| line.trim() == "#[test]").count();
            }
        }
    }
    Ok((files, tests))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read() {
        let both = Options { dirty: true, only: Some("osculate-geom") };
        assert_eq!(Options::of(&["--only", "osculate-geom", "--allow-dirty"]), Some(both));
        assert_eq!(Options::of(&[]), Some(Options::default()));
        assert!(Options::of(&["--only"]).is_none() && Options::of(&["--dirty"]).is_none());
    }

    #[test]
    fn what_is_not_for_a_registry_is_kept_back() {
        let text = r#"{"target_directory": "t", "packages": [
            {"name": "a", "version": "1.2.0", "publish": null}, {"name": "x", "version": "0.0.0", "publish": []}]}"#;
        let (packages, kept_back, target) = read(text).unwrap();
        assert_eq!((packages.len(), packages[0].stem().as_str()), (1, "a-1.2.0"));
        assert_eq!((kept_back, target), (vec!["x".to_owned()], PathBuf::from("t")));
        let manifest = workspace(&packages);
        assert!(
            manifest.contains("members = [\"a-1.2.0\"]") && manifest.contains("a = { path = \"a-1.2.0\" }")
        );
        for wrong in ["", "{}", r#"{"target_directory": "t", "packages": [{"name": "a"}]}"#] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn results_of_all_programs_are_added_up() {
        let said = "running 3 tests\n...\ntest result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.11s\n\
                    test result: FAILED. 12 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out\n";
        assert_eq!(counted(said), Counts { passed: 15, failed: 2 });
        assert_eq!(counted("passed: nothing\n"), Counts::default());
    }

    #[test]
    fn packages_that_test_nothing_or_less_than_they_have_are_found() {
        let passed = |passed| Counts { passed, failed: 0 };
        assert_eq!(fault(&passed(5), 4), None);
        assert!(fault(&passed(3), 4).is_some() && fault(&passed(0), 0).is_some());
        assert!(fault(&Counts { passed: 9, failed: 1 }, 4).is_some());
    }

    #[test]
    fn tests_are_counted_where_they_stand() {
        let here = root().unwrap().join("xtask");
        let (files, tests) = looked_at(&here).unwrap();
        assert!(files > 40 && tests > 50, "{files} {tests}");
    }
}
