//! What must be so of a report in a browser.

use super::chrome::Chrome;
use super::golden::Golden;
use super::page::{DESK, Look, PHONE};
use crate::cmd::Failure;
use std::path::Path;

/// Bytes of a page at most.
const MOST_BYTES: u64 = 3_000_000;
/// Until a part is drawn, ms, on an idle core; a busy one is given as much more as it takes for a fixed sum, and half as much again: what
/// else loads the computer slows drawing more than a sum.
const FIRST_VIEW_MS: f64 = 2_000.0;
const SLACK: f64 = 1.5;
/// A page that comes late is opened this often at most: what else the computer does comes and goes, a slow page stays slow.
const OPENINGS: usize = 4;
/// Colours of a view that shows something: one of the background alone has three.
const COLOURS: u64 = 40;
/// Bodies of the machine stand where joints have them as exactly as single precision is, mm.
const NOSE_MM: f64 = 0.01;
/// Pages that the slider goes on between two looks at the machine.
const PAGES: usize = 3;
/// What moves changes the mean colours of a view by this at least, of 255.
const MOVED: f64 = 0.15;

const VIEW: &str = "#canvas-box";
const WORDS: &str = "document.getElementById('pose-words').textContent";

/// The goldens, the report's name among them, and whether pictures are kept as the new ones.
type Goldens<'a> = Option<(&'a mut Golden, &'a str, bool)>;

/// A report that is being looked at.
struct Visit<'a> {
    chrome: &'a mut Chrome,
    folder: &'a Path,
    golden: Goldens<'a>,
    wrong: Vec<String>,
}

/// Looks at a report; what is wrong with it. Pictures go into the folder.
///
/// # Errors
/// Where the browser does not answer, or a picture cannot be written.
pub fn check(
    chrome: &mut Chrome,
    file: &Path,
    folder: &Path,
    golden: Goldens<'_>,
) -> Result<Vec<String>, Failure> {
    std::fs::create_dir_all(folder).map_err(|why| Failure::Write { path: folder.to_path_buf(), why })?;
    let bytes = std::fs::metadata(file).map_err(|why| Failure::Read { path: file.to_path_buf(), why })?.len();
    let mut visit = Visit { chrome, folder, golden, wrong: Vec::new() };
    visit.must(bytes < MOST_BYTES, || format!("the page has {bytes} bytes, more than {MOST_BYTES}"));
    visit.first_view(file, bytes)?;
    visit.tables()?;
    visit.view()?;
    visit.tool()?;
    visit.machine()?;
    visit.worst()?;
    visit.dark()?;
    visit.phone()?;
    visit.print()?;
    let complaints = std::mem::take(&mut visit.chrome.complaints);
    visit.wrong.extend(complaints.into_iter().map(|c| format!("the page complains: {c}")));
    Ok(visit.wrong)
}

impl Visit<'_> {
    fn must(&mut self, holds: bool, otherwise: impl FnOnce() -> String) {
        if !holds {
            self.wrong.push(otherwise());
        }
    }

    /// The part is drawn soon, at the best of some openings.
    fn first_view(&mut self, file: &Path, bytes: u64) -> Result<(), Failure> {
        let mut late = Vec::new();
        for _ in 0..OPENINGS {
            self.chrome.report(file)?;
            let slowness = self.chrome.slowness()?;
            self.chrome.window(DESK, false, false)?;
            let drawn_ms =
                self.chrome.number("performance.getEntriesByName('osculate-drawn')[0].startTime")?;
            println!(
                "browser: {bytes} bytes, drawn after {drawn_ms:.0} ms on a core that is {slowness:.1} times as slow as an idle one"
            );
            let most_ms = SLACK * FIRST_VIEW_MS * slowness;
            if drawn_ms < most_ms {
                return Ok(());
            }
            late.push(format!("{drawn_ms:.0} ms where {most_ms:.0} are allowed"));
        }
        self.wrong.push(format!("each time the part is drawn too late: after {}", late.join("; after ")));
        Ok(())
    }

    /// A picture of the view, kept and held against its golden.
    fn picture(&mut self, name: &str) -> Result<Look, Failure> {
        let look = self.chrome.look(Some(VIEW))?;
        self.save(&format!("{name}.png"), &look.png)?;
        if let Some((golden, report, bless)) = &mut self.golden {
            if *bless {
                golden.keep(report, name, &look);
            } else {
                self.wrong.extend(golden.compare(report, name, &look));
            }
        }
        Ok(look)
    }

    fn save(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.folder.join(name);
        std::fs::write(&path, bytes).map_err(|why| Failure::Write { path, why })
    }

    /// What a shop needs stands on the page.
    fn tables(&mut self) -> Result<(), Failure> {
        let text = self.chrome.value("document.body.innerText")?;
        let text = text.as_str().unwrap_or_default().to_owned();
        for wanted in [
            "Setup sheet",
            "Tools",
            "out of the holder",
            "spindle",
            "raw material",
            "work offset",
            "Feed over the time",
        ] {
            self.must(text.contains(wanted), || format!("'{wanted}' does not stand on the page"));
        }
        let whole = self.chrome.look(None)?;
        self.save("page.png", &whole.png)
    }

    /// The part is seen, and in the colours of what was measured.
    fn view(&mut self) -> Result<(), Failure> {
        let open = self.picture("open")?;
        self.must(open.colours > COLOURS, || {
            format!("the view has {} colours only: it is empty", open.colours)
        });
        self.chrome.click("label[for=part-plain]")?;
        let plain = self.picture("plain")?;
        self.must(open.differs_by(&plain.fields) > MOVED, || {
            "without colours the part looks the same".to_owned()
        });
        self.chrome.click("label[for=part-deviation]")?;
        let known = self.chrome.number("Number(document.querySelector('#canvas-box').dataset.known)")?;
        self.must(known > 0.98, || {
            format!("of the faces' vertices {:.1} % only have a deviation", 100.0 * known)
        });
        Ok(())
    }

    /// The slider, by the keyboard, moves the tool.
    fn tool(&mut self) -> Result<(), Failure> {
        let count = self.chrome.number("Number(document.getElementById('pose').max)")?;
        self.must(count > 0.0, || "there are no places of the tool".to_owned());
        self.chrome.value("document.getElementById('pose').focus()")?;
        let before = self.chrome.value(WORDS)?;
        let stood = self.chrome.look(Some(VIEW))?;
        // A page down is a tenth of the way.
        self.chrome.key("PageDown", 34, 3)?;
        let after = self.chrome.value(WORDS)?;
        self.must(before != after, || format!("the slider leaves the tool where it is: {before}"));
        self.must(after.as_str().is_some_and(|w| w.contains("line ")), || {
            format!("no line is named: {after}")
        });
        let stands = self.picture("moved")?;
        self.must(stood.differs_by(&stands.fields) > MOVED, || {
            "the slider moves no tool in the view".to_owned()
        });
        Ok(())
    }

    /// A machine that has bodies is shown with them, the spindle's nose where the tool ends, and the slider moves them.
    fn machine(&mut self) -> Result<(), Failure> {
        let there = "!document.getElementById('show-machine').closest('label').hidden";
        if self.chrome.value(there)? != true {
            return Ok(());
        }
        let part = self.chrome.look(Some(VIEW))?;
        self.chrome.click("#show-machine")?;
        let shown = self.picture("machine")?;
        self.must(part.differs_by(&shown.fields) > MOVED, || "no machine is shown".to_owned());
        self.chrome.value("document.getElementById('pose').focus()")?;
        for _ in 0..3 {
            let off = self.chrome.number("Number(document.querySelector('#canvas-box').dataset.nose)")?;
            self.must(off < NOSE_MM, || format!("the spindle's nose is {off} mm off the end of the tool"));
            self.chrome.key("PageUp", 33, PAGES)?;
        }
        let moved = self.chrome.look(Some(VIEW))?;
        self.must(shown.differs_by(&moved.fields) > MOVED, || "the slider moves no machine".to_owned());
        self.chrome.key("PageDown", 34, 6)?;
        self.chrome.click("#show-machine")
    }

    /// A click on the worst place sets tool, slider and line there, and turns the part so that it is seen.
    fn worst(&mut self) -> Result<(), Failure> {
        let places = self.chrome.number("document.querySelectorAll('[data-at]').length")?;
        if places == 0.0 {
            return Ok(());
        }
        let before = self.chrome.look(Some(VIEW))?;
        let pose = self.chrome.value("document.querySelector('[data-at]').dataset.pose ?? null")?;
        self.chrome.click("[data-at]")?;
        let shown = self.picture("worst")?;
        self.must(before.differs_by(&shown.fields) > MOVED, || "Show changes nothing".to_owned());
        let seen = self.chrome.value("document.querySelector('#canvas-box').dataset.seen")?;
        self.must(seen == "true", || "Show: the part hides the place".to_owned());
        let slider = self.chrome.value("document.getElementById('pose').value")?;
        self.must(pose.is_null() || pose == slider, || {
            format!("Show sets the slider to {slider}, not to {pose}")
        });
        Ok(())
    }

    fn dark(&mut self) -> Result<(), Failure> {
        self.chrome.window(DESK, true, false)?;
        self.chrome.click("[data-view=iso]")?;
        let look = self.picture("dark")?;
        let whole = self.chrome.look(None)?;
        self.save("page-dark.png", &whole.png)?;
        let mean = |look: &Look| {
            look.fields.iter().flatten().map(|c| f64::from(*c)).sum::<f64>() / (3 * look.fields.len()) as f64
        };
        self.must(mean(&whole) < 110.0, || format!("the dark page has a mean of {:.0} of 255", mean(&whole)));
        self.must(look.colours > COLOURS, || "the dark view is empty".to_owned());
        Ok(())
    }

    fn phone(&mut self) -> Result<(), Failure> {
        self.chrome.window(PHONE, false, false)?;
        let wide = self.chrome.number("document.documentElement.scrollWidth")?;
        self.must(wide <= f64::from(PHONE.width), || format!("on a phone the page is {wide} pixels wide"));
        let look = self.picture("phone")?;
        self.must(look.colours > COLOURS, || "the view on a phone is empty".to_owned());
        let whole = self.chrome.look(None)?;
        self.save("page-phone.png", &whole.png)?;
        self.chrome.window(DESK, false, false)
    }

    /// On paper the still picture stands in place of the view, and no buttons.
    fn print(&mut self) -> Result<(), Failure> {
        self.chrome.window(DESK, false, true)?;
        for (selector, wanted) in [("#still", true), ("#canvas-box canvas", false), (".bar", false)] {
            let expression =
                format!("getComputedStyle(document.querySelector({selector:?})).display !== 'none'");
            let shown = self.chrome.value(&expression)?;
            self.must(shown == wanted, || format!("printed, {selector} is there: {shown}"));
        }
        let look = self.picture("print")?;
        self.must(look.colours > COLOURS, || "printed, the picture is empty".to_owned());
        let pdf = self.chrome.printed()?;
        self.must(pdf.starts_with(b"%PDF"), || "it cannot be printed".to_owned());
        self.save("print.pdf", &pdf)?;
        self.chrome.window(DESK, false, false)
    }
}
