//! How part and tool bend at a contact, as polar curves: Dupin's indicatrices, that of conformity, the directions that they ask for,
//! and beside them what the tolerance gives as it is shared between marks and strip.
//!
//! The tangent plane is seen from outside along the normal; the direction of u points to the right.

use super::drawing::{Anchor, Drawing, Pen, Type, letters, pen};
use super::scene::Place;
use crate::report::legend::nice_step;
use crate::report::text::{fixed, short};
use crate::work::strip::{Answer, Sharing};

/// Width of a panel and height of the page, px.
const PANEL: f64 = 440.0;
const HEIGHT: f64 = 470.0;
/// Middle of the polar diagrams in their panel, and their radius, px.
const MIDDLE: Place = [220.0, 222.0];
const RADIUS: f64 = 160.0;
/// Curves are drawn up to so many times the smallest radius.
const MOST_TIMES: f64 = 4.0;
/// The chart of shares: left, top, right, bottom, px.
const CHART: [f64; 4] = [66.0, 62.0, 420.0, 382.0];
/// Where legends begin, and their rows, px.
const LEGEND: f64 = 412.0;
const ROW: f64 = 16.0;

const INK: &str = "#222";
const GREY: &str = "#555";
const FAINT: &str = "#c8c8c8";
const PART: &str = "#17477e";
const TOOL: &str = "#c2703d";
const BOTH: &str = "#2a6f6a";
const WIDEST: &str = "#b3122b";

/// A polar curve: its radii by the answer's angles.
struct Curve<'a> {
    name: &'a str,
    radii: &'a [Option<f64>],
    colour: &'static str,
}

/// A line through the middle.
struct Direction {
    name: String,
    deg: f64,
    pen: Pen,
}

/// The page of a contact.
pub fn page(answer: &Answer, title: &str) -> String {
    let turns = &answer.turns;
    let mut sheet = Drawing::default();
    sheet.text([16.0, 24.0], title, Type { bold: true, ..letters(15.0) });
    let feed = || Direction { name: "feed".into(), deg: turns.feed_deg, pen: pen(INK, 1.2) };
    let dupin = [
        Curve { name: "part", radii: &turns.dupin_part_root_mm, colour: PART },
        Curve { name: "tool", radii: &turns.dupin_tool_root_mm, colour: TOOL },
    ];
    let kinds =
        format!("Dupin's indicatrices: part {}, tool {}", turns.dupin_part.words(), turns.dupin_tool.words());
    sheet.insert(&polar(&kinds, &turns.angle_deg, &dupin, &[feed()]), [0.0, 24.0]);
    let both = [Curve { name: "part and tool", radii: &turns.conformity_root_mm, colour: BOTH }];
    let widest = answer.widest_direction_deg;
    let mut ways = vec![feed()];
    ways.push(Direction {
        name: format!("feed of the widest strip, {} deg", fixed(widest, 1)),
        deg: widest,
        pen: pen(WIDEST, 1.6),
    });
    if let Some(deg) = turns.claimed_direction_deg {
        let name = format!("feed across the smallest radius, {} deg", fixed(deg, 1));
        ways.push(Direction { name, deg, pen: Pen { dashes: "5 4", ..pen(BOTH, 1.6) } });
    }
    sheet.insert(&polar("indicatrix of conformity", &turns.angle_deg, &both, &ways), [PANEL, 24.0]);
    let last = match &answer.sharing {
        Some(sharing) => shares(sharing),
        None => {
            let mut d = Drawing::default();
            let why = answer.no_sharing.as_deref().unwrap_or_default();
            d.text([16.0, 40.0], &format!("no shares: {why}"), letters(11.0));
            d
        }
    };
    sheet.insert(&last, [2.0 * PANEL, 24.0]);
    sheet.finish(3.0 * PANEL, HEIGHT + 24.0, title)
}

/// A place on a polar diagram, degrees anticlockwise from the right.
fn at(deg: f64, radius_px: f64) -> Place {
    let (s, c) = deg.to_radians().sin_cos();
    [MIDDLE[0] + radius_px * c, MIDDLE[1] - radius_px * s]
}

/// The radius of the rim: all of the curves, but no more than some times the smallest radius, beyond which they are asymptotes.
fn rim(curves: &[Curve<'_>]) -> f64 {
    let all = || curves.iter().flat_map(|c| c.radii.iter().flatten()).map(|r| r.abs());
    let most = all().fold(0.0, f64::max);
    let each = curves.iter().map(|c| c.radii.iter().flatten().fold(f64::INFINITY, |m, r| r.abs().min(m)));
    // Of the curve that begins farthest out, so that each of them is seen.
    let least = each.filter(|m| m.is_finite()).fold(0.0, f64::max);
    let rim = 1.05 * most.min(MOST_TIMES * least);
    if rim > 0.0 { rim } else { 1.0 }
}

fn polar(caption: &str, angles: &[f64], curves: &[Curve<'_>], ways: &[Direction]) -> Drawing {
    let mut d = Drawing::default();
    d.text([16.0, 28.0], caption, letters(12.0));
    let rim = rim(curves);
    let px = |r: f64| RADIUS * r / rim;
    let step = nice_step(rim / 4.0);
    for ring in (1..5).map(|k| f64::from(k) * step).filter(|r| *r <= rim) {
        let circle: Vec<Place> = (0..=72).map(|k| at(5.0 * f64::from(k), px(ring))).collect();
        d.lines(&[circle], pen(FAINT, 0.7));
        d.text(at(-67.5, px(ring)), &short(ring, 3), Type { halo: true, colour: GREY, ..letters(10.0) });
    }
    for deg in [0.0, 90.0] {
        d.lines(&[vec![at(deg, -RADIUS), at(deg, RADIUS)]], pen(FAINT, 0.7));
    }
    d.text(at(0.0, RADIUS + 8.0), "u", Type { colour: GREY, ..letters(11.0) });
    for way in ways {
        d.lines(&[vec![at(way.deg, -RADIUS), at(way.deg, RADIUS)]], way.pen);
    }
    let mut row = LEGEND;
    let mut legend = |d: &mut Drawing, pen: Pen, name: &str| {
        d.lines(&[vec![[20.0, row - 4.0], [48.0, row - 4.0]]], pen);
        d.text([56.0, row], name, letters(11.0));
        row += ROW;
    };
    for curve in curves {
        // Convex whole, hollow dashed.
        for (hollow, dashes) in [(false, ""), (true, "3 3")] {
            let own = Pen { dashes, ..pen(curve.colour, 1.8) };
            let lines = runs(angles, curve.radii, |r| (r < 0.0) == hollow && r.abs() <= rim);
            let lines: Vec<Vec<Place>> =
                lines.iter().map(|l| l.iter().map(|(deg, r)| at(*deg, px(r.abs()))).collect()).collect();
            if !lines.is_empty() {
                d.lines(&lines, own);
                let sign = if hollow { ", negative" } else { "" };
                legend(&mut d, own, &format!("{}{sign}, root mm", curve.name));
            }
        }
    }
    for way in ways {
        legend(&mut d, way.pen, &way.name);
    }
    d
}

/// Runs of neighbours around a turn that are wanted, the first place standing at its end once more.
fn runs(angles: &[f64], radii: &[Option<f64>], wanted: impl Fn(f64) -> bool) -> Vec<Vec<(f64, f64)>> {
    let mut all = vec![Vec::new()];
    let turn = angles.iter().zip(radii).chain(angles.first().zip(radii.first()));
    for (deg, radius) in turn {
        match radius.filter(|r| wanted(*r)) {
            Some(r) => {
                let last = all.len() - 1;
                all[last].push((*deg, r));
            }
            None => all.push(Vec::new()),
        }
    }
    all.retain(|line| line.len() > 1);
    all
}

/// Area per tooth over the share of marks.
fn shares(s: &Sharing) -> Drawing {
    let mut d = Drawing::default();
    let [left, top, right, bottom] = CHART;
    d.text(
        [16.0, 28.0],
        "area per tooth, mm\u{b2}, over the share of the tolerance for marks",
        letters(12.0),
    );
    let most = s.area_per_tooth_mm2.iter().copied().fold(s.best.area_per_tooth_mm2, f64::max);
    let step = nice_step(most / 5.0);
    let high = step * (most / step).ceil();
    let place = |chi: f64, area: f64| -> Place {
        [left + (right - left) * chi, bottom - (bottom - top) * (area / high).clamp(0.0, 1.0)]
    };
    for k in 0..=(high / step).round() as u32 {
        let value = f64::from(k) * step;
        let [_, y] = place(0.0, value);
        d.lines(&[vec![[left, y], [right, y]]], pen(FAINT, 0.7));
        d.text([8.0, y + 4.0], &short(value, 4), Type { colour: GREY, ..letters(10.0) });
    }
    for k in 0..=5 {
        let chi = 0.2 * f64::from(k);
        let [x, y] = place(chi, 0.0);
        d.lines(&[vec![[x, y], [x, y + 4.0]]], pen(INK, 0.8));
        let middle = Type { anchor: Anchor::Middle, colour: GREY, ..letters(10.0) };
        d.text([x, y + 16.0], &short(chi, 2), middle);
    }
    let line: Vec<Place> = s.chi.iter().zip(&s.area_per_tooth_mm2).map(|(c, a)| place(*c, *a)).collect();
    d.lines(&[line], pen(BOTH, 1.8));
    let best = &s.best;
    d.disc(place(best.chi, best.area_per_tooth_mm2), 4.0, WIDEST, pen("#fff", 0.8));
    let cap = match &s.cap {
        Some(cap) if best.capped => format!(", as {} holds the feed", cap.by.replace('_', " ")),
        _ => String::new(),
    };
    let words = [
        format!(
            "best {}{cap}: {} mm a tooth, strip {} mm",
            fixed(best.chi, 3),
            short(best.feed_per_tooth_mm, 4),
            short(best.strip_mm, 4)
        ),
        best.area_mm2_min.map_or_else(String::new, |a| format!("{} mm\u{b2} a minute", short(a, 4))),
    ];
    for (k, line) in words.iter().enumerate() {
        d.text([20.0, LEGEND + 4.0 + ROW * k as f64], line, letters(11.0));
    }
    d
}
