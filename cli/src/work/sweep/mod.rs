//! A sweep: one job with some of its values varied, every combination planned and judged, one table of all.
//!
//! The list of cases is a pure function of the sweep's file and its job, so that any machine knows which cases are its own: of `N` shards
//! the shard `K` has the cases `K`, `K + N`, `K + 2 N`, ... A finished case is a row in the file of its shard. Rows of all shards make the
//! same table in whatever order they were made; what differs from run to run, the wall time, is in the rows only.

pub mod case;
pub mod page;
pub mod rows;
pub mod run;
mod set;
pub mod table;

use crate::failure::{Failure, beside, read, read_text};
use case::{Case, Digest};
use serde::Deserialize;
use set::Step;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Most cases of a sweep.
const MOST: usize = 10_000_000;
/// Longest label that is made of a value, characters.
const LABEL: usize = 40;

/// The file as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSweep {
    format: u32,
    job: String,
    vary: Vec<RawVaried>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawVaried {
    key: Option<String>,
    values: Option<Vec<toml::Value>>,
    name: Option<String>,
    cases: Option<Vec<toml::Table>>,
}

/// One thing that is varied.
#[derive(Debug, Clone)]
pub struct Varied {
    /// As the table heads it.
    pub name: String,
    /// Each of its values as people read it.
    pub labels: Vec<String>,
    /// What each value sets in the job.
    sets: Vec<Vec<(Vec<Step>, toml::Value)>>,
}

/// A job with what is varied of it.
#[derive(Debug, Clone)]
pub struct Sweep {
    path: PathBuf,
    job_path: PathBuf,
    job: toml::Table,
    varied: Vec<Varied>,
    cases: usize,
    /// The bytes of files that the job or a value names, as numbers.
    files: BTreeMap<String, u64>,
}

impl Sweep {
    /// The sweep of a file.
    ///
    /// # Errors
    /// Where it or its job cannot be read, where a key or value cannot be meant, or where there are more than ten million cases.
    pub fn load(path: &Path) -> Result<Self, Failure> {
        Self::from_toml(&read_text(path)?, path)
    }

    /// The sweep of a text; its job is looked for beside `path`.
    ///
    /// ```
    /// use osculate::work::sweep::{Sweep, rows::Shard};
    ///
    /// # let folder = std::env::temp_dir().join(format!("osculate-sweep-doc-{}", std::process::id()));
    /// # std::fs::create_dir_all(&folder)?;
    /// std::fs::write(folder.join("job.toml"), "format = 1\n[tool]\nkind = \"ball\"\ndiameter_mm = 6\n")?;
    /// let text = r#"
    /// format = 1
    /// job = "job.toml"
    /// [[vary]]
    /// key = "tool.diameter_mm"
    /// values = [4, 6, 8]
    /// [[vary]]
    /// key = "tolerance.scallop_mm"
    /// values = [0.02, 0.1]
    /// "#;
    /// let sweep = Sweep::from_toml(text, &folder.join("sweep.toml"))?;
    /// // Three diameters by two tolerances; the second of two machines takes every other case.
    /// assert_eq!(sweep.cases(), 6);
    /// assert_eq!(Shard { which: 2, of: 2 }.numbers(6).collect::<Vec<_>>(), [2, 4, 6]);
    /// assert_eq!(sweep.labels_of(6), ["8", "0.1"]);
    /// # std::fs::remove_dir_all(&folder)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Sweep::load`].
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, Failure> {
        let fail = |what: String| Failure::file(path, what);
        let raw: RawSweep = toml::from_str(text).map_err(|e| fail(e.to_string().trim_end().to_owned()))?;
        if raw.format != 1 {
            return Err(fail(format!(
                "format = {} must be 1: this is what a sweep is written in",
                raw.format
            )));
        }
        if raw.vary.is_empty() {
            return Err(fail(
                "vary is empty: add [[vary]] with key and values, or with name and cases".to_owned(),
            ));
        }
        let job_path = beside(path, &raw.job);
        let job_text = read_text(&job_path)?;
        let job: toml::Table = job_text
            .parse()
            .map_err(|e: toml::de::Error| Failure::file(&job_path, e.to_string().trim_end()))?;
        let varied: Vec<Varied> = raw
            .vary
            .into_iter()
            .zip(1..)
            .map(|(v, k)| Varied::of(v).map_err(|what| fail(format!("vary[{k}] {what}"))))
            .collect::<Result<_, _>>()?;
        for (k, v) in varied.iter().enumerate() {
            if varied[..k].iter().any(|before| before.name == v.name) {
                let what = format!(
                    "vary[{}] is named {:?} as one before it: give it a name of its own",
                    k + 1,
                    v.name
                );
                return Err(fail(what));
            }
        }
        let cases =
            varied.iter().try_fold(1usize, |n, v| n.checked_mul(v.labels.len()).filter(|n| *n <= MOST));
        let Some(cases) = cases else {
            let counts: Vec<String> = varied.iter().map(|v| v.labels.len().to_string()).collect();
            return Err(fail(format!(
                "{} are more than {MOST} cases: vary less at once",
                counts.join(" x ")
            )));
        };
        let mut sweep =
            Self { path: path.to_path_buf(), job_path, job, varied, cases, files: BTreeMap::new() };
        sweep.files = sweep.digests()?;
        // What cannot be set in one case can be set in none.
        for axis in 0..sweep.varied.len() {
            for value in 0..sweep.varied[axis].sets.len() {
                sweep.set(&mut sweep.job.clone(), axis, value).map_err(|what| {
                    fail(format!("vary[{}], {}: {what}", axis + 1, sweep.varied[axis].labels[value]))
                })?;
            }
        }
        Ok(sweep)
    }

    /// The file it came from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is varied, in order.
    #[must_use]
    pub fn varied(&self) -> &[Varied] {
        &self.varied
    }

    /// How many cases there are.
    #[must_use]
    pub const fn cases(&self) -> usize {
        self.cases
    }

    /// Which value of each thing that is varied a case has; the last one changes from case to case. Cases count from 1.
    #[must_use]
    pub fn values_of(&self, number: usize) -> Vec<usize> {
        let mut left = number.saturating_sub(1);
        let mut out: Vec<usize> = self
            .varied
            .iter()
            .rev()
            .map(|v| {
                let value = left % v.labels.len();
                left /= v.labels.len();
                value
            })
            .collect();
        out.reverse();
        out
    }

    /// The values of a case as people read them.
    #[must_use]
    pub fn labels_of(&self, number: usize) -> Vec<&str> {
        self.varied.iter().zip(self.values_of(number)).map(|(v, k)| v.labels[k].as_str()).collect()
    }

    /// The values of a case in a line: `tool.diameter_mm = 4, part = dome`.
    #[must_use]
    pub fn words_of(&self, number: usize) -> String {
        let each = self.varied.iter().zip(self.labels_of(number));
        each.map(|(v, label)| format!("{} = {label}", v.name)).collect::<Vec<_>>().join(", ")
    }

    /// A case with the text of its job.
    ///
    /// # Errors
    /// Where there is no such case, or a value cannot be set next to the others.
    pub fn case(&self, number: usize) -> Result<Case, Failure> {
        if number == 0 || number > self.cases {
            let what = format!("there is no case {number}: there are {} from 1 on", self.cases);
            return Err(Failure::file(&self.path, what));
        }
        let mut job = self.job.clone();
        for (axis, value) in self.values_of(number).into_iter().enumerate() {
            self.set(&mut job, axis, value)
                .map_err(|what| Failure::file(&self.path, format!("case {number}: {what}")))?;
        }
        let text = toml::to_string(&job).map_err(|e| Failure::file(&self.path, e))?;
        let mut digest = Digest::default();
        digest.add(env!("CARGO_PKG_VERSION").as_bytes());
        digest.add(text.as_bytes());
        for (name, bytes) in &self.files {
            if set::names(&job, name) {
                digest.add(&bytes.to_le_bytes());
            }
        }
        // Files of the job are beside it; messages name the case.
        let name = format!("case {number} of {}", self.path.file_name().unwrap_or_default().display());
        Ok(Case { number, text, path: beside(&self.job_path, &name), key: digest.hex() })
    }

    fn set(&self, job: &mut toml::Table, axis: usize, value: usize) -> Result<(), String> {
        self.varied[axis].sets[value].iter().try_for_each(|(steps, value)| set::set(job, steps, value))
    }

    /// Of each file that the job or a value names, its bytes as a number.
    fn digests(&self) -> Result<BTreeMap<String, u64>, Failure> {
        let mut named = Vec::new();
        self.job.values().for_each(|v| set::strings(v, &mut named));
        self.varied
            .iter()
            .flat_map(|v| v.sets.iter().flatten())
            .for_each(|(_, v)| set::strings(v, &mut named));
        named.sort_unstable();
        named.dedup();
        let mut out = BTreeMap::new();
        for name in named {
            let file = beside(&self.job_path, name);
            if file.is_file() {
                let mut digest = Digest::default();
                digest.add(&read(&file)?);
                out.insert(name.to_owned(), digest.value());
            }
        }
        Ok(out)
    }
}

/// A value as people read it.
fn label(value: &toml::Value) -> String {
    let whole = match value {
        toml::Value::String(s) => s.clone(),
        other => other.to_string(),
    };
    let one_line = whole.split_whitespace().collect::<Vec<_>>().join(" ");
    if one_line.chars().count() <= LABEL {
        return one_line;
    }
    one_line.chars().take(LABEL - 3).chain("...".chars()).collect()
}

impl Varied {
    fn of(raw: RawVaried) -> Result<Self, String> {
        let out = match (raw.key, raw.values, raw.cases) {
            (Some(key), Some(values), None) => {
                let steps = set::steps(&key)?;
                Self {
                    name: raw.name.unwrap_or(key),
                    labels: values.iter().map(label).collect(),
                    sets: values.into_iter().map(|v| vec![(steps.clone(), v)]).collect(),
                }
            }
            (None, None, Some(cases)) => {
                let name = raw.name.ok_or("needs a name beside its cases")?;
                let (labels, sets) = cases.into_iter().zip(1..).map(Self::one).collect();
                Self { name, labels, sets }
            }
            _ => return Err("needs either key and values, or name and cases".to_owned()),
        };
        if out.labels.is_empty() {
            return Err("has no values: give at least one".to_owned());
        }
        // Two of the same label could not be told apart in the table.
        for (k, label) in out.labels.iter().enumerate() {
            if let Some(before) = out.labels[..k].iter().position(|l| l == label) {
                return Err(format!(
                    "has {label:?} twice, as its values {} and {}: leave one out, or give cases with a label each",
                    before + 1,
                    k + 1
                ));
            }
        }
        Ok(out)
    }

    /// Values that go together: of a table of the job each of its keys.
    fn one((mut table, k): (toml::Table, usize)) -> (String, Vec<(Vec<Step>, toml::Value)>) {
        let told = table.remove("label");
        let shown = told.as_ref().map_or_else(|| k.to_string(), label);
        let mut sets = Vec::new();
        for (name, value) in table {
            match value {
                toml::Value::Table(keys) => {
                    let each =
                        keys.into_iter().map(|(key, v)| (vec![Step::Key(name.clone()), Step::Key(key)], v));
                    sets.extend(each);
                }
                other => sets.push((vec![Step::Key(name)], other)),
            }
        }
        (shown, sets)
    }
}
