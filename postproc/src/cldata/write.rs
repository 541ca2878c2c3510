//! Writing a path as APT text: one `GOTO` a line, so that line-based tools can handle it.

use std::fmt::Write as _;

use osculate_tools::CutterSpec;
use osculate_tools::cl::{ClMove, ClPath, Motion};

use super::cutter;

/// Decimals of tip coordinates: a tenth of the 1e-6 mm that must survive.
const TIP_DECIMALS: usize = 7;
/// Decimals of axis components: a tenth of the 1e-9 that must survive.
const AXIS_DECIMALS: usize = 10;

/// What a path does not know of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClWriteOptions {
    /// Text behind `PARTNO`.
    pub part_name: String,
    /// Tool number behind `LOADTL/`.
    pub tool_number: u32,
}

impl Default for ClWriteOptions {
    fn default() -> Self {
        Self { part_name: "OSCULATE".into(), tool_number: 1 }
    }
}

/// Why a path cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ClWriteError {
    /// NaN, infinite, or a feed that is not above zero.
    #[error(
        "CL move {index}: a coordinate or feed is not finite, or the feed is not above zero; nothing was written"
    )]
    NotFinite {
        /// The move, from 0.
        index: usize,
    },
}

/// The path as APT text.
///
/// ```
/// use osculate_postproc::cldata::{ClWriteOptions, read, write};
///
/// let path = read("SPINDL/8000,CLW\nRAPID\nGOTO/0,0,5\nFEDRAT/600\nGOTO/1.5,-2,0,0,0.6,0.8\nFINI\n")?.path;
/// let text = write(&path, &ClWriteOptions { part_name: "BRACKET".into(), ..ClWriteOptions::default() })?;
/// assert!(text.starts_with("PARTNO BRACKET\n"));
/// // And read again it is the same path, speed of the spindle included.
/// assert_eq!(read(&text)?.path, path);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Where a number is not finite.
pub fn write(path: &ClPath, options: &ClWriteOptions) -> Result<String, ClWriteError> {
    // 90 characters hold the longest GOTO of a part within 100 m.
    let mut text = String::with_capacity(300 + 90 * path.moves.len());
    let mut writer = ClWriter::new(options, path.cutter.as_ref(), path.spindle_rpm, &mut text);
    for m in &path.moves {
        writer.take(m, &mut text)?;
    }
    writer.end(&mut text);
    Ok(text)
}

/// Writes a path move by move; the text belongs to the caller, who may take it away at any time.
#[derive(Clone, Debug)]
pub struct ClWriter {
    feed: Option<f64>,
    index: usize,
}

impl ClWriter {
    /// The head goes into `text`.
    pub fn new(
        options: &ClWriteOptions,
        cutter: Option<&CutterSpec>,
        spindle_rpm: Option<f64>,
        text: &mut String,
    ) -> Self {
        let name: String = options.part_name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        // Writing into a String cannot fail; the results of `write!` are dropped for that reason.
        let _ = writeln!(text, "PARTNO {name}\nUNITS/MM\nMULTAX/ON");
        let _ = writeln!(text, "LOADTL/{}", options.tool_number);
        if let Some(p) = cutter.and_then(cutter::parameters) {
            let p: Vec<String> = p.iter().map(|v| format!("{}", v + 0.0)).collect();
            let _ = writeln!(text, "CUTTER/{}", p.join(","));
        }
        if let Some(rpm) = spindle_rpm.filter(|r| r.is_finite() && *r > 0.0) {
            let _ = writeln!(text, "SPINDL/{rpm},CLW");
        }
        Self { feed: None, index: 0 }
    }

    /// One move.
    ///
    /// # Errors
    /// Where a number is not finite.
    pub fn take(&mut self, m: &ClMove, text: &mut String) -> Result<(), ClWriteError> {
        let (p, a, index) = (m.pose.tip, m.pose.axis, self.index);
        self.index += 1;
        if !p.iter().chain(a.iter()).all(|c| c.is_finite()) {
            return Err(ClWriteError::NotFinite { index });
        }
        match m.motion {
            Motion::Rapid => text.push_str("RAPID\n"),
            Motion::Feed(f) if !(f.is_finite() && f > 0.0) => return Err(ClWriteError::NotFinite { index }),
            Motion::Feed(f) if self.feed != Some(f) => {
                let _ = writeln!(text, "FEDRAT/{f},MMPM");
                self.feed = Some(f);
            }
            Motion::Feed(_) => {}
        }
        let tip = [p.x, p.y, p.z].map(|v| fixed(v, TIP_DECIMALS)).join(",");
        let axis = [a.x, a.y, a.z].map(|v| fixed(v, AXIS_DECIMALS)).join(",");
        let _ = writeln!(text, "GOTO/{tip},{axis}");
        Ok(())
    }

    /// The end.
    pub fn end(self, text: &mut String) {
        text.push_str("FINI\n");
    }
}

/// Fixed decimals, never `-0`.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| b == b'0' || b == b'.') => rest.to_string(),
        _ => text,
    }
}
