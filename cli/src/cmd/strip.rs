//! `strip`: the strip at one contact, exact and by every closed form that applies.

use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome};
use osculate::job::strategy::Kind;
use osculate::job::{ContactFeed, Job, LeadKey};
use osculate::part;
use osculate::words::{Table, number};
use osculate_geom::{Surface, uv};
use osculate_productivity::closed_form::{self, DomainError, Section};
use osculate_productivity::plan::{Along, Strategy};
use osculate_tools::{Contact, FeedLine, strip};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Per cent of a form are told up to this many times the exact width. Where forms apply they are off by less than half of it; two contacts
/// (5C) are several times as wide as the one that the job's lead gives.
const MOST_TIMES: f64 = 100.0;

#[derive(Serialize)]
struct Exact {
    width_mm: f64,
    left_mm: f64,
    right_mm: f64,
    undercut_mm: f64,
    error_mm: f64,
    ends_at_edge: [bool; 2],
}

#[derive(Serialize)]
struct Form {
    #[serde(skip_serializing_if = "Option::is_none")]
    width_mm: Option<f64>,
    /// Why the form has no value here.
    #[serde(skip_serializing_if = "Option::is_none")]
    why_not: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lead_deg: Option<f64>,
}

#[derive(Serialize)]
struct MinMax {
    min: f64,
    /// Absent for a sharp edge, whose curvature is infinite.
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<f64>,
}

#[derive(Serialize)]
struct Answer {
    exact: Exact,
    closed_forms: BTreeMap<&'static str, Form>,
    relative_curvature_per_mm: MinMax,
    /// Why the tool digs in next to the contact, with what would fit.
    #[serde(skip_serializing_if = "Option::is_none")]
    does_not_fit: Option<String>,
    widest_direction_deg: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_feed_per_tooth_mm: Option<f64>,
}

/// Runs the verb.
pub fn run(path: &Path, json: bool) -> Outcome {
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
    if job.strategy().lead == LeadKey::Local {
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
    let exact = strip::exact(&contact, scallop_mm).map_err(|e| Failure::file(path, e))?;
    let answer = answer(&contact, &exact, scallop_mm);
    if json {
        render::json(&answer)?;
    } else {
        render::text(&describe(&answer, scallop_mm))?;
    }
    Ok(Done::Yes)
}

fn answer(contact: &Contact<'_>, exact: &strip::Strip, scallop_mm: f64) -> Answer {
    let q = contact.relative();
    let (left, tangent) = (contact.frame.left.into_inner(), contact.frame.tangent.into_inner());
    let part_across = contact.forms.normal_curvature(&left);
    let part_along = contact.forms.normal_curvature(&tangent);
    let section = Section { part_per_mm: part_across, tool_per_mm: q.along(&left) - part_across, scallop_mm };
    let lengthwise =
        Section { part_per_mm: part_along, tool_per_mm: q.along(&tangent) - part_along, scallop_mm };
    let mut forms = BTreeMap::new();
    let mut put = |name, value: Result<f64, DomainError>, lead: Option<f64>| {
        let form = match value {
            Ok(w) => Form { width_mm: Some(w), why_not: None, lead_deg: lead },
            Err(e) => Form { width_mm: None, why_not: Some(e.to_string()), lead_deg: None },
        };
        forms.insert(name, form);
    };
    put("r97_37", closed_form::width_37(section), None);
    put("r97_38", closed_form::chord_38(section), None);
    put("r97_40", closed_form::linear_40(section), None);
    put("leading_order", closed_form::leading_order(section), None);
    put("leading_order_swept", closed_form::leading_order_swept(&q, &left, scallop_mm), None);
    let cutter = contact.cutter;
    if cutter.is_ball() {
        put("m86_2cl", closed_form::two_axis_ball(cutter.radius_mm(), scallop_mm), None);
    } else {
        let (arc, lead) = (cutter.touching(contact.lean.lead_rad), contact.lean.lead_rad);
        let (core, corner) = (arc.centre_rho_mm, arc.radius_mm);
        put("m86_3c", closed_form::three_axis_toroidal(core, corner, lead, part_across, scallop_mm), None);
        let five = closed_form::five_axis_flat(core, corner, part_along, part_across, scallop_mm);
        let lead = five.as_ref().ok().map(|f| f.lead_rad.to_degrees());
        put("m86_5c", five.map(|f| f.width_mm), lead);
    }
    // The angle from S_u towards S_v at which the strip is widest: the feed lies across the eigenvector of Q's
    // smaller eigenvalue.
    let widest = contact.forms.normal.cross(&q.d_min);
    let jet = contact.surface.jet2(contact.at);
    let e1 = contact.forms.frame[0];
    let e2 = contact.forms.frame[1].into_inner() * jet.side.sign();
    let angle = widest.dot(&e2).atan2(widest.dot(&e1)).to_degrees();
    Answer {
        exact: Exact {
            width_mm: exact.width_mm,
            left_mm: exact.left_mm,
            right_mm: exact.right_mm,
            undercut_mm: exact.undercut_mm,
            error_mm: exact.error_mm,
            ends_at_edge: exact.at_edge,
        },
        closed_forms: forms,
        relative_curvature_per_mm: MinMax { min: q.min, max: q.max.is_finite().then_some(q.max) },
        does_not_fit: contact.fits().err().map(|e| e.to_string()),
        // Directions are lines: the angle in (-90, 90].
        widest_direction_deg: if angle > 90.0 {
            angle - 180.0
        } else if angle <= -90.0 {
            angle + 180.0
        } else {
            angle
        },
        max_feed_per_tooth_mm: if lengthwise.tool_per_mm.is_finite() {
            closed_form::width_37(lengthwise).ok()
        } else {
            None
        },
    }
}

/// A form beside the exact width. Where next to nothing is left of the strip, as under a tool lifted by the tolerance, per cent say nothing.
fn against(width_mm: f64, exact_mm: f64) -> String {
    match width_mm / exact_mm {
        times if times <= MOST_TIMES => format!("{:+.3} %", 100.0 * (times - 1.0)),
        _ => format!("over {MOST_TIMES} times"),
    }
}

fn describe(a: &Answer, scallop_mm: f64) -> String {
    let mut t = Table::new(["strip", "width mm", "against exact"]);
    let e = &a.exact;
    t.row(["exact".into(), number(e.width_mm, 8), String::new()]);
    for (name, form) in &a.closed_forms {
        match (form.width_mm, &form.why_not) {
            (Some(w), _) => {
                t.row([(*name).into(), number(w, 8), against(w, e.width_mm)]);
            }
            (None, Some(_)) => t.row([(*name).into(), "-".into(), "does not apply".into()]),
            (None, None) => {}
        }
    }
    let mut out = format!("\n  strip at a tolerance of {scallop_mm} mm\n\n{}\n", t.render());
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
    if let Some(f) = a.max_feed_per_tooth_mm {
        out.push_str(&format!("  longest feed per tooth at this tolerance {} mm\n", number(f, 6)));
    }
    for (name, form) in &a.closed_forms {
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
