//! The error along the rule and the ratio of the errors over the radius: as arrays and as pictures, figures 6, 7, 9 and 10 of D98
//! for a face of one's own.

use osculate::report::curves::{self, Curve, Limit, Panel};
use osculate::report::text::{figure, short};
use osculate::work::flank::methods::{Answer, Study};
use osculate::work::flank::ratio::{self, NoRatio, Ratios};
use serde::Serialize;

/// The error along the rule of every positioning.
#[derive(Debug, Serialize)]
pub struct Profiles {
    /// Places along the rule, from the directrix at v = 0, mm.
    pub along_mm: Vec<f64>,
    /// One of each method that stands at the rule.
    pub methods: Vec<AlongRule>,
}

/// The error along the rule of one positioning.
#[derive(Debug, Serialize)]
pub struct AlongRule {
    /// The name of the method.
    pub name: &'static str,
    /// The static deviation at each place, below zero gouged, mm.
    pub error_mm: Vec<f64>,
}

impl Profiles {
    /// The errors along a rule of this length.
    pub fn of(answers: &[Answer], rule_mm: f64) -> Self {
        let methods: Vec<_> =
            answers.iter().filter_map(|a| Some((a.row.name, a.profile.as_ref()?))).collect();
        let along_mm = methods
            .first()
            .map(|(_, p)| p.samples.iter().map(|s| s.v * rule_mm).collect())
            .unwrap_or_default();
        let methods = methods
            .into_iter()
            .map(|(name, p)| AlongRule { name, error_mm: p.samples.iter().map(|s| s.deviation_mm).collect() })
            .collect();
        Self { along_mm, methods }
    }
}

/// A deviation in words, rounding as none.
fn deviation(mm: f64) -> String {
    figure(if mm.abs() < 1e-9 { 0.0 } else { mm }, 4)
}

/// A second panel, cut off at three times the best, is drawn where the largest is this many times as high.
const ENLARGED: f64 = 2.0;

/// `profile.svg`.
pub fn profile(p: &Profiles, answers: &[Answer], study: &Study<'_>) -> String {
    let radius = study.cutter.radius_mm();
    let worst = |c: &AlongRule| c.error_mm.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    let curves: Vec<Curve> = p
        .methods
        .iter()
        .enumerate()
        .map(|(colour, c)| {
            let range = answers.iter().find(|a| a.row.name == c.name).and_then(|a| a.row.static_mm);
            Curve {
                name: c.name.to_owned(),
                note: range
                    .map_or_else(String::new, |r| format!("{} to {} mm", deviation(r.min), deviation(r.max))),
                points: p.along_mm.iter().zip(&c.error_mm).map(|(x, y)| [*x, *y]).collect(),
                colour,
                ..Curve::default()
            }
        })
        .collect();
    let missing = answers.iter().filter(|a| a.profile.is_none());
    let mut notes: Vec<String> =
        vec!["Above zero material is left, below zero the face is cut into.".to_owned()];
    notes.extend(missing.map(|a| format!("{}: {}", a.row.name, a.row.why)));
    let [above, below] = [study.tolerance[0], -study.tolerance[1]];
    let limit = |value: f64, name: String| Limit { value, name };
    let both = format!("tolerance {} to {} mm", short(below, 4), short(above, 4));
    let axes = ["along the rule, from the directrix at v = 0, mm".to_owned(), "error, mm".to_owned()];
    let whole = Panel {
        title: format!("Error along the rule at u = {}, R = {} mm", short(study.at_u, 6), short(radius, 6)),
        axes: axes.clone(),
        curves: curves.clone(),
        limits: vec![limit(above, both), limit(below, String::new())],
        notes,
        ..Panel::default()
    };
    let mut panels = vec![whole];
    let sizes = || p.methods.iter().map(worst);
    let (best, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    let size = (3.0 * best).max(1e-6);
    if best.is_finite() && most > ENLARGED * size {
        let shown = [above, below].into_iter().filter(|t| t.abs() < size);
        let shown = shown.map(|t| limit(t, format!("tolerance {} mm", short(t, 4)))).collect();
        panels.push(Panel {
            title: "The same, enlarged to the best".to_owned(),
            axes,
            curves: curves.into_iter().map(|c| Curve { note: String::new(), ..c }).collect(),
            limits: shown,
            range: Some([-size, size]),
            ..Panel::default()
        });
    }
    curves::svg("Error along the rule", &panels)
}

/// The words on the end of a curve.
fn end(c: &ratio::Curve) -> String {
    let off = c.off_face_from_mm.map(|r| format!("a contact is off the face from R = {} mm on", short(r, 4)));
    let end = c.ends_at_mm.map(|r| format!("ends at R = {} mm", short(r, 5)));
    [off, end].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

fn drawn(c: &ratio::Curve, name: String, colour: usize, bold: bool) -> Curve {
    Curve {
        name,
        note: end(c),
        points: c.radius_mm.iter().zip(&c.ratio).map(|(x, y)| [*x, *y]).collect(),
        dashed_from: c.off_face_from_mm,
        colour,
        bold,
    }
}

/// The colour of the exact curve: black.
const EXACT: usize = 6;

/// `ratio.svg`.
pub fn ratio(found: &Result<Ratios, NoRatio>) -> String {
    let axes =
        ["radius of the cylinder, mm".to_owned(), "standard_b over optimum, greatest errors".to_owned()];
    let title = "Ratio of the errors over the radius";
    let r = match found {
        Ok(r) => r,
        Err(why) => {
            let panel =
                Panel { title: title.to_owned(), axes, notes: vec![why.to_string()], ..Panel::default() };
            return curves::svg(title, &[panel]);
        }
    };
    let (length, twist) = (r.exact.rule_mm, r.exact.half_twist_deg);
    let mut notes = vec![sentence(r)];
    if !r.exact.ends_by.is_empty() {
        notes.push(format!("The exact curve ends: {}.", r.exact.ends_by));
    }
    notes.push("Dashed: a contact lies off the face. All but the exact curve are the closed form of straight directrices.".to_owned());
    let panel = |title: String, all: &[ratio::Curve], name: &dyn Fn(&ratio::Curve) -> String| {
        let form = |(k, c): (usize, &ratio::Curve)| {
            let own = (c.rule_mm, c.half_twist_deg) == (r.closed.rule_mm, r.closed.half_twist_deg);
            drawn(c, if own { format!("{}, the rule's own", name(c)) } else { name(c) }, k, own)
        };
        let mut curves: Vec<Curve> = all.iter().enumerate().map(form).collect();
        curves.push(drawn(&r.exact, "exact, on this face".to_owned(), EXACT, true));
        let dots = r.own.exact.map(|y| ([r.own.radius_mm, y], EXACT)).into_iter().collect();
        Panel {
            title,
            axes: axes.clone(),
            curves,
            dots,
            logarithmic: true,
            notes: notes.clone(),
            ..Panel::default()
        }
    };
    let lengths = panel(
        format!("{title}: rules of other lengths, end normals at {} deg from the middle's", short(twist, 4)),
        &r.lengths,
        &|c| format!("{} mm long", short(c.rule_mm, 4)),
    );
    let twists = panel(format!("{title}: other twists, rule of {} mm", short(length, 4)), &r.twists, &|c| {
        format!("{} deg", short(c.half_twist_deg, 4))
    });
    curves::svg(title, &[lengths, twists])
}

/// Exact beside approximate at the cutter's radius, in words.
pub fn sentence(r: &Ratios) -> String {
    let radius = short(r.own.radius_mm, 6);
    match (r.own.exact, r.own.closed, r.own.difference_percent) {
        (Some(exact), Some(_), Some(difference)) if difference.abs() < 1e-4 => format!(
            "At R = {radius} mm standard_b deviates {} times as much as three tangencies; the closed form of straight directrices says \
             the same.",
            figure(exact, 4)
        ),
        (Some(exact), Some(closed), Some(difference)) => format!(
            "At R = {radius} mm standard_b deviates {} times as much as three tangencies; the closed form of straight directrices says \
             {}, {} % off.",
            figure(exact, 4),
            figure(closed, 4),
            figure(difference, 2)
        ),
        (Some(exact), ..) => format!(
            "At R = {radius} mm standard_b deviates {} times as much as three tangencies; the closed form of straight directrices has \
             no three tangencies there.",
            figure(exact, 4)
        ),
        (None, Some(closed), _) => format!(
            "At R = {radius} mm the face has no three tangencies; the closed form of straight directrices would have a ratio of {}.",
            figure(closed, 4)
        ),
        _ => format!("At R = {radius} mm there are no three tangencies."),
    }
}
