//! A span of positions that serves the face better than the one that is asked for.
//!
//! With three tangencies the contacts on both directrices lie on either side of the rule, so that positions from end to end of a
//! face leave its ends untouched by one contact or the other. A span that goes on until both contacts have passed the end
//! ends that; where the face cannot go on, a shorter span may at least not gouge. Both are tried, and proposed if they help.

use super::methods::{Method, Range, STATIONS, Study, setting_of};
use osculate_geom::Interval;
use osculate_tools::flank::{SideTool, Stations, place};

/// Rules looked at over half the judged length at either end.
const LOOKS: usize = 64;
/// Halvings between the last rule on one side of the mark and the first on the other.
const HALVINGS: usize = 20;
/// A span is proposed if it takes at least this part off the greatest deviation.
const HELPS: f64 = 0.05;

/// A better span.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BetterSpan {
    /// The method that it is for.
    pub name: &'static str,
    /// First and last position.
    pub span: Interval,
    /// What its envelope leaves over the judged face, mm.
    pub envelope_mm: Range,
    /// Where contacts of the span that was asked for are off the face: up to the first, from the second on.
    pub off_face: [Option<f64>; 2],
}

fn worst(r: &Range) -> f64 {
    r.max.max(-r.min)
}

/// A round number at least as far outwards, of a thousandth of the length or finer.
fn outwards(u: f64, up: bool, length: f64) -> f64 {
    let digits = (3.0 - length.log10().floor()).clamp(0.0, 9.0);
    let unit = 10f64.powi(digits as i32);
    if up { (u * unit).ceil() / unit } else { (u * unit).floor() / unit }
}

impl Study<'_> {
    /// A span with which the envelope of a setting deviates less from the judged face, None where the one asked for is as
    /// good, the tolerance is held already, or the method is none of a rule.
    #[must_use]
    pub fn better_span(&self, row: &Method) -> Option<BetterSpan> {
        let setting = setting_of(row.name)?;
        let now =
            row.envelope_mm.filter(|_| row.share_within.is_some_and(|s| s < 1.0) && self.is_cylinder())?;
        let tool = SideTool::cylinder(self.cutter.radius_mm()).ok()?;
        let stations = Stations::beyond(self.strip, STATIONS, self.beyond);
        // First and last u of the contacts of the position at u.
        let contacts = |u: f64| {
            let placed = place(self.strip, &stations, u, tool, setting).ok()?;
            let all = || placed.touches.iter().map(|t| t.u);
            Some([all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)])
        };
        let face = self.strip.u_domain();
        let (lo, hi) = (self.judge.lo, self.judge.hi);
        let step = 0.5 * self.judge.length() / LOOKS as f64;
        // The first position from `from` on, by steps, that is as wanted; None where positions end before.
        let first = |from: f64, step: f64, wanted: &dyn Fn([f64; 2]) -> bool| {
            let at = |k: usize| from + step * k as f64;
            let k = (0..=LOOKS).find_map(|k| match contacts(at(k)) {
                None => Some(None),
                Some(c) => wanted(c).then_some(Some(k)),
            })??;
            if k == 0 {
                return Some(from);
            }
            let (mut before, mut there) = (at(k - 1), at(k));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (before + there);
                match contacts(middle).is_some_and(wanted) {
                    true => there = middle,
                    false => before = middle,
                }
            }
            Some(there)
        };
        let inside = |c: [f64; 2]| c[0] >= face.lo && c[1] <= face.hi;
        let longer = [first(lo, -step, &|c| c[1] <= lo), first(hi, step, &|c| c[0] >= hi)];
        let shorter = [first(self.span.lo, step, &inside), first(self.span.hi, -step, &inside)];
        let off_face = [shorter[0].filter(|u| *u > self.span.lo), shorter[1].filter(|u| *u < self.span.hi)];
        let length = self.judge.length();
        let span = |[a, b]: [Option<f64>; 2], out: bool| {
            let (a, b) = (a.unwrap_or(self.span.lo), b.unwrap_or(self.span.hi));
            let span = Interval::new(outwards(a, !out, length), outwards(b, out, length));
            (span.lo < span.hi && [span.lo, span.hi] != [self.span.lo, self.span.hi]).then_some(span)
        };
        [span(longer, true), span(shorter, false)]
            .into_iter()
            .flatten()
            .filter_map(|span| Some((span, self.with_span(span).run(row.name).row.envelope_mm?)))
            .filter(|(_, then)| worst(then) < (1.0 - HELPS) * worst(&now))
            .min_by(|a, b| worst(&a.1).total_cmp(&worst(&b.1)))
            .map(|(span, envelope_mm)| BetterSpan { name: row.name, span, envelope_mm, off_face })
    }
}
