//! `strip`: the strip at one contact, exact and by every closed form that applies.

use crate::screen::{cancel, output, render};
use osculate::failure::{Done, Failure, Outcome};
use osculate::figure::indicatrices;
use osculate::job::strategy::Kind;
use osculate::job::{ContactFeed, Job, LeanKey};
use osculate::part;
use osculate::words::{Table, number};
use osculate::work::strip::{Answer, Bends, Forms, Instant, Passing, Sharing};
use osculate_geom::{Surface, uv};
use osculate_productivity::plan::{Along, Strategy};
use osculate_tools::{Contact, FeedLine};
use std::path::Path;

/// Per cent of a form are told up to this many times the exact width. Where forms apply they are off by less than half of it; two contacts
/// (5C) are several times as wide as the one that the job's lead gives.
const MOST_TIMES: f64 = 100.0;

/// Runs the verb.
pub fn run(path: &Path, out: Option<&Path>, json: bool) -> Outcome {
    if let Some(out) = out {
        output::folder(out)?;
    }
    let job = Job::load_with_one_tool(path)?;
    let table = job.contact().ok_or_else(|| {
        Failure::file(path, "strip needs a [contact] table: at = [u, v] and along or angle_deg")
    })?;
    let cutter = job.cutter();
    let scallop_mm = job.tolerance().scallop_mm;
    let face = part::one_face(&job)?;
    let feed = match table.feed {
        ContactFeed::Along(axis) => FeedLine::Iso(axis),
        ContactFeed::Angle(rad) => FeedLine::Angle(rad),
    };
    let at = uv(table.at[0], table.at[1]);
    if !face.surface.domain().contains(at) {
        let d = face.surface.domain();
        return Err(Failure::file(
            path,
            format!(
                "[contact] at = {:?} is outside the parameters of {}: u in [{}, {}], v in [{}, {}]",
                table.at, face.id, d.u.lo, d.u.hi, d.v.lo, d.v.hi
            ),
        ));
    }
    if job.strategy().lead == LeanKey::Local {
        let why = "[strategy] lead_deg = \"local\" is for paths: one contact needs a number";
        return Err(Failure::file(job.path(), why));
    }
    let aside = match (job.strategy().side_tilt(), &job.strategy().kind) {
        (
            Some(_),
            Kind::Faces(
                Strategy::Isoparametric { along: Along::Fixed(axis) }
                | Strategy::Regions { along: Along::Fixed(axis) },
            ),
        ) => Some(*axis),
        _ => None,
    };
    if aside.is_some_and(|axis| table.feed != ContactFeed::Along(axis)) {
        let why = "[strategy] side_tilt_deg is of passes along its parameter: one contact needs the same along in [contact]";
        return Err(Failure::file(job.path(), why));
    }
    let contact = Contact::new(&*face.surface, at, &cutter, feed, job.lean(0.0))
        .map_err(|e| Failure::file(path, e))?
        .lifted(table.lift_mm);
    let answer = Answer::of(&contact, Passing::of(&job)).map_err(|e| Failure::file(path, e))?;
    if let Some(out) = out {
        let whole = serde_json::to_string(&answer).map_err(Failure::job)?;
        let title = format!("{}: contact at u, v = {}, {}", face.id, table.at[0], table.at[1]);
        let picture = indicatrices::page(&answer, &title);
        let claimed = output::claim(out)?;
        let undivided = cancel::whole();
        output::set(out, &[("strip.json", whole.as_bytes()), ("strip.svg", picture.as_bytes())])?;
        drop((undivided, claimed));
    }
    if json {
        render::json(&answer)?;
    } else {
        render::text(&describe(&answer, scallop_mm))?;
    }
    Ok(Done::Yes)
}

/// A form beside the exact width. Where next to nothing is left of the strip, as under a tool lifted by the tolerance, per cent say nothing.
fn against(width_mm: f64, exact_mm: f64) -> String {
    match width_mm / exact_mm {
        times if times <= MOST_TIMES => format!("{:+.3} %", 100.0 * (times - 1.0)),
        _ => format!("over {MOST_TIMES} times"),
    }
}

/// Closed forms beside what is exact.
fn beside(what: &str, exact_mm: Option<f64>, forms: &Forms) -> String {
    let mut t = Table::new([what, "mm", "against exact"]);
    t.row(["exact".into(), exact_mm.map_or_else(|| "-".into(), |mm| number(mm, 8)), String::new()]);
    for (name, form) in forms {
        let (width, off) = form.width_mm.map_or_else(
            || ("-".into(), "does not apply".into()),
            |w| (number(w, 8), exact_mm.map_or_else(String::new, |exact| against(w, exact))),
        );
        t.row([(*name).into(), width, off]);
    }
    t.render()
}

/// Curvatures and radii in the direction of the feed and across it.
fn bends(a: &Answer) -> String {
    let mut t = Table::new(["", "part 1/mm", "radius mm", "tool 1/mm", "radius mm"]);
    let radius = |k: f64| if k == 0.0 { "straight".into() } else { number(1.0 / k, 6) };
    let mut row = |name: &str, b: &Bends| {
        let [tool, of_tool] =
            b.tool_per_mm.map_or_else(|| ["infinite".into(), "edge".into()], |k| [number(k, 6), radius(k)]);
        t.row([name.into(), number(b.part_per_mm, 6), radius(b.part_per_mm), tool, of_tool]);
    };
    row("along the feed", &a.turns.along_feed);
    row("across the feed", &a.turns.across_feed);
    t.render()
}

/// How the tolerance is best shared.
fn shared(s: &Sharing) -> String {
    let b = &s.best;
    let mut out = format!(
        "  best share of the tolerance for marks {}: {} mm a tooth x strip {} mm = {} mm2",
        number(b.chi, 4),
        number(b.feed_per_tooth_mm, 5),
        number(b.strip_mm, 5),
        number(b.area_per_tooth_mm2, 5)
    );
    if let Some(a) = b.leading_area_per_tooth_mm2 {
        out.push_str(&format!(" (leading order {})", number(a, 5)));
    }
    if let Some(a) = b.area_mm2_min {
        out.push_str(&format!(", {} mm2/min", number(a, 5)));
    }
    if let Some(cap) = s.cap.as_ref().filter(|_| b.capped) {
        let what = cap.by.replace('_', " ");
        out.push_str(&format!("; {what} holds it to {} mm a tooth", number(cap.feed_per_tooth_mm, 5)));
    }
    out.push('\n');
    out
}

/// What is made as the tool passes.
fn passing(i: &Instant) -> String {
    let mut out = format!(
        "  at {} mm/min: {} mm2/min (width times feed {})",
        number(i.feed_mm_min, 6),
        number(i.area_mm2_min, 6),
        number(i.width_times_feed_mm2_min, 6)
    );
    if let Some(v) = i.layer_mm3_min {
        out.push_str(&format!(", of a layer of {} mm {} mm3/min", number(i.layer_mm, 4), number(v, 6)));
    }
    if let Some(e) = &i.engagement {
        out.push_str(&format!(
            "\n  in that layer, uncut: {} mm3/min over {:.0} deg of the cutter",
            number(e.mm3_min, 6),
            e.arc_deg
        ));
        if let Some(t) = &e.teeth {
            let [few, many] = t.in_cut;
            out.push_str(&format!(
                ", {few} to {many} of {} teeth in cut, {} to {} mm3/min, one at most {}",
                t.count,
                number(t.mm3_min[0], 4),
                number(t.mm3_min[1], 4),
                number(t.one_most_mm3_min, 4)
            ));
        }
    }
    out.push('\n');
    out
}

fn describe(a: &Answer, scallop_mm: f64) -> String {
    let e = &a.exact;
    let strip = beside("strip", Some(e.width_mm), &a.closed_forms);
    let mut out = format!("\n  strip at a tolerance of {scallop_mm} mm\n\n{strip}\n");
    out.push_str(&format!(
        "  left {} mm, right {} mm, undercut {} mm, numerical error {} mm\n",
        number(e.left_mm, 8),
        number(e.right_mm, 8),
        number(e.undercut_mm, 4),
        number(e.error_mm, 2)
    ));
    let q = &a.relative_curvature_per_mm;
    let max = q.max.map_or_else(|| "infinite (sharp edge)".into(), |m| format!("{} 1/mm", number(m, 6)));
    out.push_str(&format!("  relative curvature: {} 1/mm to {max}\n", number(q.min, 6)));
    if let Some(why) = &a.does_not_fit {
        out.push_str(&format!("  {why}\n"));
    }
    out.push_str(&format!(
        "  widest strip with the feed at {:.2} deg from S_u towards S_v\n",
        a.widest_direction_deg
    ));
    if let Some([claimed, off]) =
        a.turns.claimed_direction_deg.zip(a.turns.claimed_off_deg).map(|(deg, off)| [deg, off])
    {
        out.push_str(&format!(
            "  the smallest radius of conformity asks for {claimed:.2} deg, {off:.2} deg off\n"
        ));
    }
    out.push_str(&format!(
        "  Dupin's indicatrix: part {}, tool {}\n\n{}\n",
        a.turns.dupin_part.words(),
        a.turns.dupin_tool.words(),
        bends(a)
    ));
    let marks = &a.feed_per_tooth;
    out.push_str(&beside("longest feed per tooth", marks.exact_mm, &marks.closed_forms));
    out.push('\n');
    match (&a.sharing, &a.no_sharing) {
        (Some(sharing), _) => out.push_str(&shared(sharing)),
        (None, Some(why)) => out.push_str(&format!("  no shares of the tolerance: {why}\n")),
        (None, None) => {}
    }
    if let Some(instant) = &a.instant {
        out.push_str(&passing(instant));
    }
    for (name, form) in a.closed_forms.iter().chain(&marks.closed_forms) {
        if let Some(why) = &form.why_not {
            out.push_str(&format!("  {name}: {why}\n"));
        }
    }
    out.push('\n');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn per_cent_are_finite() {
        assert_eq!(against(1.01, 1.0), "+1.000 %");
        assert_eq!(against(100.0, 1.0), "+9900.000 %");
        for exact_mm in [0.0, 1e-300, 1e-5] {
            assert_eq!(against(3.0, exact_mm), "over 100 times");
        }
    }
}
