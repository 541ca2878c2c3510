//! The feed mode beside the one that a job asks for: what its path would take if the control kept the tip on its line.

use crate::job::Control;
use osculate_geom::Diagnostic;
use osculate_postproc::nc::timing::time;
use osculate_postproc::{FeedMode, Setup};

/// Less than this share less is not worth a word.
const WORTH: f64 = 0.05;

/// What to say of a program, where the control would take less for the same path, at the same feed of the tip, with tool-centre-point control.
/// `posted` writes its program; None where it cannot be written.
pub fn note(
    control: &Control,
    place: &Setup,
    text: &str,
    posted: impl FnOnce(&Control) -> Option<String>,
) -> Option<Diagnostic> {
    if matches!(control.feed, FeedMode::Tcp) || control.machine.rotary().is_empty() {
        return None;
    }
    let taken_min = |control: &Control, text: &str| {
        let text = control.language.engine_text(text);
        let timed = time(&text, control.dialect, &control.machine, place, false).ok()?;
        Some(timed.time.time_min())
    };
    let tip = control.by_tip();
    let (now_min, min) = (taken_min(control, text)?, taken_min(&tip, &posted(&tip)?)?);
    (min < (1.0 - WORTH) * now_min).then(|| {
        let what = format!(
            "the same path takes {min:.2} min on the control with feed = \"{}\", {now_min:.2} with \"{}\": where the machine has \
             tool-centre-point control, use it",
            tip.feed_name, control.feed_name
        );
        Diagnostic::note("feed", what)
    })
}
