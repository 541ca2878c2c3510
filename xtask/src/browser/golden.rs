//! Mean colours of pictures as they were when somebody looked at them and found them right.

use super::page::{FIELDS, Look};
use crate::cmd::{Failure, write};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Mean difference of colours, of 255, up to which a picture counts as the same: fonts and edges come to less than 2, another view of a
/// part to more than 10.
const SAME: f64 = 5.0;

/// All goldens, by report and picture.
pub struct Golden {
    path: PathBuf,
    all: Map<String, Value>,
}

impl Golden {
    /// Of a file; none where there is no such file yet.
    ///
    /// # Errors
    /// Where what stands there is no JSON object.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).unwrap_or_else(|_| "{}".to_owned());
        let all = serde_json::from_str(&text)
            .map_err(|why| Failure::Answer { line: path.display().to_string(), why: why.to_string() })?;
        Ok(Self { path: path.to_path_buf(), all })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn write(&self) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(&Value::Object(self.all.clone())).unwrap_or_default();
        write(&self.path, &(text + "\n"))
    }

    /// Keeps a picture.
    pub fn keep(&mut self, report: &str, picture: &str, look: &Look) {
        let hex: String = look.fields.iter().flatten().map(|c| format!("{c:02x}")).collect();
        let of = self.all.entry(report.to_owned()).or_insert_with(|| json!({}));
        of[picture] = json!(hex);
    }

    /// What is wrong with a picture.
    pub fn compare(&self, report: &str, picture: &str, look: &Look) -> Option<String> {
        let kept = self.all.get(report).and_then(|r| r[picture].as_str());
        let Some(fields) = kept.and_then(fields_of_hex) else {
            return Some(format!("{picture}: there is no golden of it: look at it and run with --bless"));
        };
        let by = look.differs_by(&fields);
        (by > SAME)
            .then(|| format!("{picture}: looks different, mean colours by {by:.1} of 255 (allowed {SAME})"))
    }
}

fn fields_of_hex(text: &str) -> Option<Vec<[u8; 3]>> {
    let two = |at: usize| u8::from_str_radix(text.get(at..at + 2)?, 16).ok();
    let [columns, rows] = FIELDS;
    (0..columns * rows).map(|k| Some([two(6 * k)?, two(6 * k + 2)?, two(6 * k + 4)?])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_picture_is_the_same_and_another_one_is_not() {
        let mut golden = Golden { path: PathBuf::new(), all: Map::new() };
        let [columns, rows] = FIELDS;
        let look =
            |grey: u8| Look { png: Vec::new(), fields: vec![[grey, 7, 250]; columns * rows], colours: 1 };
        assert!(golden.compare("part", "open", &look(40)).is_some_and(|w| w.contains("no golden")));
        golden.keep("part", "open", &look(40));
        assert_eq!(golden.compare("part", "open", &look(54)), None);
        assert!(golden.compare("part", "open", &look(56)).is_some_and(|w| w.contains("looks different")));
    }
}
