//! Charts as inline SVG: how the deviation is spread, how wide the strips are, where the time went.
//!
//! Colours of text and axes come from the page (`currentColor` and its CSS variables), so that the charts follow its
//! light and dark theme. A chart without data is `None`: the page then says so instead of showing an empty frame.

use super::data::{Histogram, Pace, Pass, Stage};
use super::legend::{Scale, hex, nice_step};
use super::text::{coordinate, count, escape, figure, fixed, short};
use std::fmt::Write;

/// The frame that all charts share, in SVG user units.
pub(super) const WIDTH: f64 = 560.0;
pub(super) const HEIGHT: f64 = 210.0;
pub(super) const LEFT: f64 = 58.0;
pub(super) const RIGHT: f64 = 10.0;
pub(super) const TOP: f64 = 14.0;
pub(super) const BOTTOM: f64 = 40.0;

/// A linear axis from values to user units.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    pub lo: f64,
    pub hi: f64,
    pub from: f64,
    pub to: f64,
}

impl Axis {
    pub fn at(&self, value: f64) -> f64 {
        let span = if self.hi > self.lo { self.hi - self.lo } else { 1.0 };
        self.from + (self.to - self.from) * ((value - self.lo) / span).clamp(0.0, 1.0)
    }

    /// Round values on the axis, about `wanted` of them.
    pub fn ticks(&self, wanted: f64) -> Vec<f64> {
        let span = self.hi - self.lo;
        if !(span > 0.0 && span.is_finite()) {
            return vec![self.lo];
        }
        let step = nice_step(span / wanted);
        let first = (self.lo / step).ceil();
        // The slack keeps a tick that rounding pushed past the end; the sum next to zero is written as zero.
        (0..)
            .map(|i| (first + f64::from(i)) * step)
            .take(60)
            .take_while(|v| *v <= self.hi + 1e-9 * span)
            .map(|v| if v.abs() < 1e-9 * span { 0.0 } else { v })
            .collect()
    }
}

pub(super) fn frame(label: &str, x: Axis, y: Axis, x_ticks: &[f64], x_title: &str, y_title: &str) -> String {
    let mut out = format!(
        "<svg class=\"chart\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">",
        escape(label)
    );
    for value in y.ticks(4.0) {
        let at = coordinate(y.at(value));
        let _ = write!(
            out,
            "<path class=\"grid\" d=\"M{LEFT} {at}H{}\"/><text x=\"{}\" y=\"{at}\" dy=\".35em\" text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            short(value, 4)
        );
    }
    for &value in x_ticks {
        let at = coordinate(x.at(value));
        let _ = write!(
            out,
            "<path class=\"axis\" d=\"M{at} {}v4\"/><text x=\"{at}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            HEIGHT - BOTTOM,
            HEIGHT - BOTTOM + 17.0,
            short(value, 4)
        );
    }
    let _ = write!(
        out,
        "<text class=\"title\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\
         <text class=\"title\" x=\"0\" y=\"9\">{}</text>",
        WIDTH - RIGHT,
        HEIGHT - 4.0,
        escape(x_title),
        escape(y_title)
    );
    out
}

pub(super) fn base_line() -> String {
    format!("<path class=\"axis\" d=\"M{LEFT} {}H{}\"/>", HEIGHT - BOTTOM, WIDTH - RIGHT)
}

/// The spread of the deviation, each bin in its colour of `scale`, the tolerances marked. Heights are shares of the
/// whole.
pub fn histogram(data: &Histogram, scale: &Scale) -> Option<String> {
    let total: f64 = data.weights.iter().filter(|w| w.is_finite()).sum();
    let bins: Vec<(f64, f64, f64)> = data
        .edges_mm
        .windows(2)
        .zip(&data.weights)
        .map(|(e, w)| (e[0], e[1], *w))
        .filter(|(a, b, w)| a.is_finite() && b > a && b.is_finite() && w.is_finite() && *w >= 0.0)
        .collect();
    let (first, last) = (bins.first()?, bins.last()?);
    if total <= 0.0 {
        return None;
    }
    let tallest = bins.iter().map(|b| b.2).fold(0.0, f64::max);
    // The limits belong into the picture also where nothing comes near them.
    let (lo, hi) =
        scale.marks.iter().fold((first.0, last.1), |(lo, hi), m| (lo.min(1.1 * m), hi.max(1.1 * m)));
    let x = Axis { lo, hi, from: LEFT, to: WIDTH - RIGHT };
    let y = Axis { lo: 0.0, hi: 100.0 * tallest / total, from: HEIGHT - BOTTOM, to: TOP + 6.0 };
    let mut out = frame("Histogram of the deviation", x, y, &x.ticks(8.0), "deviation, mm", "share, %");
    for (lo, hi, weight) in &bins {
        let (x0, x1) = (x.at(*lo), x.at(*hi));
        let top = y.at(100.0 * weight / total);
        let _ = write!(
            out,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"><title>{} to {} mm: {} {} ({} %)</title></rect>",
            coordinate(x0),
            coordinate(top),
            coordinate((x1 - x0 - 0.6).max(0.4)),
            coordinate(HEIGHT - BOTTOM - top),
            hex(scale.colour(0.5 * (lo + hi))),
            figure(*lo, 3),
            figure(*hi, 3),
            figure(*weight, 4),
            escape(&data.unit),
            figure(100.0 * weight / total, 3)
        );
    }
    for &mark in scale.marks.iter().filter(|m| (x.lo..=x.hi).contains(*m)) {
        let at = coordinate(x.at(mark));
        let (anchor, dx) = if x.at(mark) > 0.8 * WIDTH { ("end", -4.0) } else { ("start", 4.0) };
        let _ = write!(
            out,
            "<path class=\"mark\" d=\"M{at} {TOP}V{}\"/><text class=\"strong\" x=\"{at}\" dx=\"{dx}\" y=\"{}\" \
             text-anchor=\"{anchor}\">limit {} mm</text>",
            HEIGHT - BOTTOM,
            TOP + 5.0,
            short(mark, 4)
        );
    }
    Some(out + &base_line() + "</svg>")
}

/// Strip widths of one pass: least, mean and greatest of the known ones.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Widths {
    /// Least, mm.
    pub min_mm: f64,
    /// Mean over the points, mm.
    pub mean_mm: f64,
    /// Greatest, mm.
    pub max_mm: f64,
}

impl Widths {
    /// `None` where no width is known.
    pub fn of(pass: &Pass) -> Option<Self> {
        let known = || pass.widths_mm.iter().map(|w| f64::from(*w)).filter(|w| w.is_finite());
        let n = known().count();
        (n > 0).then(|| Self {
            min_mm: known().fold(f64::INFINITY, f64::min),
            mean_mm: known().sum::<f64>() / n as f64,
            max_mm: known().fold(f64::NEG_INFINITY, f64::max),
        })
    }
}

/// Mean strip width per pass as a line, from least to greatest as a band.
pub fn strip_widths(passes: &[Pass], scale: Option<&Scale>) -> Option<String> {
    let known: Vec<(usize, Widths)> =
        passes.iter().enumerate().filter_map(|(i, p)| Some((i + 1, Widths::of(p)?))).collect();
    let (first, last) = (known.first()?.0, known.last()?.0);
    let top = known.iter().map(|k| k.1.max_mm).fold(0.0, f64::max);
    let x = Axis { lo: first as f64 - 0.5, hi: last as f64 + 0.5, from: LEFT, to: WIDTH - RIGHT };
    let y = Axis { lo: 0.0, hi: 1.05 * top, from: HEIGHT - BOTTOM, to: TOP + 4.0 };
    let mut x_ticks: Vec<f64> = x.ticks(8.0).into_iter().filter(|t| t.fract() == 0.0).collect();
    if x_ticks.is_empty() {
        x_ticks.push(first as f64);
    }
    let mut out = frame("Strip width of each pass", x, y, &x_ticks, "pass", "strip width, mm");
    let slot = (x.to - x.from) / (x.hi - x.lo);
    let bar = (0.62 * slot).clamp(0.5, 18.0);
    for (number, w) in &known {
        let at = x.at(*number as f64);
        let (high, low, mean) = (y.at(w.max_mm), y.at(w.min_mm), y.at(w.mean_mm));
        let colour = scale.map_or_else(|| "currentColor".into(), |s| hex(s.colour(w.mean_mm)));
        let _ = write!(
            out,
            "<g><title>pass {number}: {} to {} mm, mean {} mm</title><rect x=\"{left}\" y=\"{}\" width=\"{bar}\" height=\"{}\" \
             fill=\"{colour}\" opacity=\".45\"/><rect x=\"{left}\" y=\"{}\" width=\"{bar}\" height=\"2.4\" fill=\"{colour}\"/></g>",
            figure(w.min_mm, 3),
            figure(w.max_mm, 3),
            figure(w.mean_mm, 3),
            coordinate(high),
            coordinate((low - high).max(1.0)),
            coordinate(mean - 1.2),
            left = coordinate(at - 0.5 * bar),
            bar = coordinate(bar)
        );
    }
    Some(out + &base_line() + "</svg>")
}

/// Stretches of time for which one value of the feed is drawn.
const PACE_SLOTS: usize = 260;

/// The mean feed over the time; where rapids take a stretch for the most part there is a gap. The feed asked for is marked.
pub fn pace(data: &Pace) -> Option<String> {
    let end = data.steps.last()?.end_min;
    if !(end > 0.0 && end.is_finite()) {
        return None;
    }
    let mut slots = vec![(0.0, 0.0); PACE_SLOTS];
    let slot_min = end / PACE_SLOTS as f64;
    let mut from = 0.0;
    for step in &data.steps {
        let (begin, took) = (from, step.end_min - from);
        from = step.end_min;
        if step.rapid || !(took > 0.0 && step.length_mm.is_finite()) {
            continue;
        }
        let (first, last) = ((begin / slot_min) as usize, (step.end_min / slot_min) as usize);
        for (k, slot) in slots.iter_mut().enumerate().take(last + 1).skip(first) {
            let lower = (k as f64 * slot_min).max(begin);
            let share = ((((k + 1) as f64) * slot_min).min(step.end_min) - lower).max(0.0);
            slot.0 += share;
            slot.1 += step.length_mm * share / took;
        }
    }
    let feeds: Vec<Option<f64>> =
        slots.iter().map(|(took, way)| (*took > 0.5 * slot_min).then(|| way / took)).collect();
    let most = feeds.iter().flatten().copied().chain(data.asked_mm_min).fold(0.0, f64::max);
    if most <= 0.0 {
        return None;
    }
    let x = Axis { lo: 0.0, hi: end, from: LEFT, to: WIDTH - RIGHT };
    let y = Axis { lo: 0.0, hi: 1.05 * most, from: HEIGHT - BOTTOM, to: TOP + 4.0 };
    let mut out = frame("Feed over the time", x, y, &x.ticks(8.0), "time, min", "feed, mm/min");
    let mut d = String::new();
    let mut pen_down = false;
    for (k, feed) in feeds.iter().enumerate() {
        let Some(feed) = feed else {
            pen_down = false;
            continue;
        };
        let word = if pen_down { 'L' } else { 'M' };
        let at = x.at((k as f64 + 0.5) * slot_min);
        // A lone stretch is a dot.
        let dot = if pen_down { "" } else { "h.6" };
        let _ = write!(d, "{word}{} {}{dot}", coordinate(at), coordinate(y.at(*feed)));
        pen_down = true;
    }
    let _ = write!(
        out,
        "<path d=\"{d}\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.4\" stroke-linejoin=\"round\"/>"
    );
    if let Some(asked) = data.asked_mm_min.filter(|a| a.is_finite() && *a > 0.0) {
        let at = coordinate(y.at(asked));
        let _ = write!(
            out,
            "<path class=\"mark\" d=\"M{LEFT} {at}H{}\"/><text class=\"strong\" x=\"{}\" y=\"{at}\" dy=\"-4\" \
             text-anchor=\"end\">asked for {} mm/min</text>",
            WIDTH - RIGHT,
            WIDTH - RIGHT - 2.0,
            short(asked, 4)
        );
    }
    Some(out + &base_line() + "</svg>")
}

/// Wall seconds of each stage as bars.
pub fn stages(stages: &[Stage]) -> Option<String> {
    let known: Vec<&Stage> = stages.iter().filter(|s| s.wall_s.is_finite() && s.wall_s >= 0.0).collect();
    let longest = known.iter().map(|s| s.wall_s).fold(0.0, f64::max);
    known.first()?;
    // Room for the longest name, some seven units a letter.
    let letters = known.iter().map(|s| s.name.chars().count()).max().unwrap_or(0);
    let (row, left) = (24.0, (16.0 + 7.0 * letters as f64).clamp(110.0, 0.4 * WIDTH));
    let height = row * known.len() as f64 + 4.0;
    let mut out = format!(
        "<svg class=\"chart\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"Wall time of each stage\">"
    );
    let axis = Axis { lo: 0.0, hi: longest, from: 0.0, to: WIDTH - left - 90.0 };
    for (i, stage) in known.iter().enumerate() {
        let y = row * i as f64;
        let length = if longest > 0.0 { axis.at(stage.wall_s) } else { 0.0 };
        let _ = write!(
            out,
            "<text x=\"{}\" y=\"{base}\" text-anchor=\"end\">{}</text><rect class=\"bar\" x=\"{left}\" y=\"{}\" width=\"{}\" \
             height=\"15\" rx=\"2\"/><text x=\"{}\" y=\"{base}\">{} s</text>",
            left - 8.0,
            escape(&stage.name),
            coordinate(y + 3.0),
            coordinate(length.max(1.0)),
            coordinate(left + length + 8.0),
            if stage.wall_s >= 1000.0 { count(stage.wall_s as usize) } else { fixed(stage.wall_s, 2) },
            base = coordinate(y + 15.0)
        );
    }
    Some(out + "</svg>")
}

#[cfg(test)]
mod tests {
    use super::super::legend::Limits;
    use super::*;

    fn scale() -> Scale {
        Scale::deviation(Limits { scallop_mm: 0.01, gouge_mm: 0.005 }, 0.0)
    }

    #[test]
    fn without_data_there_is_no_chart() {
        assert!(histogram(&Histogram::default(), &scale()).is_none());
        assert!(strip_widths(&[Pass::default()], None).is_none());
        assert!(stages(&[]).is_none());
        let nothing = Histogram { edges_mm: vec![0.0, 1.0], weights: vec![0.0], unit: String::new() };
        assert!(histogram(&nothing, &scale()).is_none());
    }

    #[test]
    fn bins_have_the_colour_of_their_deviation_and_their_share() {
        let data = Histogram {
            edges_mm: vec![-0.02, -0.01, 0.0, 0.01, 0.02],
            weights: vec![1.0, 0.0, 2.0, 1.0],
            unit: "mm2".into(),
        };
        let text = histogram(&data, &scale()).expect("there is something to show");
        for (middle, share) in [(-0.015, "(25.0 %)"), (0.005, "(50.0 %)"), (0.015, "(25.0 %)")] {
            let bar = format!("fill=\"{}\"", hex(scale().colour(middle)));
            let at = text.find(&bar).unwrap_or_else(|| panic!("no bar for {middle} in {text}"));
            assert!(text[at..].split("</title>").next().is_some_and(|t| t.ends_with(share)), "{middle}");
        }
        assert!(text.contains("limit 0.01 mm") && text.contains("limit \u{2212}0.005 mm"));
    }

    #[test]
    fn widths_leave_out_what_is_not_known() {
        let pass = Pass { points_mm: vec![], widths_mm: vec![2.0, f32::NAN, 4.0] };
        assert_eq!(Widths::of(&pass), Some(Widths { min_mm: 2.0, mean_mm: 3.0, max_mm: 4.0 }));
    }

    #[test]
    fn hostile_numbers_end_in_a_chart_or_in_none() {
        let far =
            Histogram { edges_mm: vec![1e300, 1.0000000001e300], weights: vec![1.0], unit: String::new() };
        assert!(histogram(&far, &scale()).is_some());
        let broken = Histogram {
            edges_mm: vec![f64::NAN, 0.0, f64::INFINITY],
            weights: vec![1.0, 2.0],
            unit: String::new(),
        };
        assert!(histogram(&broken, &scale()).is_none());
        let stage = |wall_s| Stage { name: "<plan>".into(), wall_s };
        assert!(stages(&[stage(f64::NAN)]).is_none());
        assert!(stages(&[stage(0.0), stage(1e9)]).is_some_and(|t| t.contains("&lt;plan&gt;")));
    }
}
