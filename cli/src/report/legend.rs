//! Colours with a meaning: which colour stands for which deviation, strip width or other quantity.
//!
//! The deviation's scale has hard steps at the two tolerances, so that a place out of tolerance never looks like one
//! within: violet to magenta for gouge, pale to full green for what may stay, amber to dark red for what stands too
//! high. Lightness falls away from zero on both sides and green differs from amber in lightness too: the map reads in
//! grey and for colour-blind eyes.

use super::text::{coordinate, escape, short};
use std::fmt::Write;

/// An sRGB colour.
pub type Rgb = [u8; 3];

/// Where nothing is known.
pub const UNKNOWN: Rgb = [0xb4, 0xb8, 0xbd];

/// Colours of kinds, told apart by colour-blind eyes and, the first four, by their lightness.
pub const KINDS: [Rgb; 8] = [
    [0x33, 0x22, 0x88],
    [0xdd, 0xcc, 0x77],
    [0x11, 0x77, 0x33],
    [0xcc, 0x66, 0x77],
    [0x88, 0xcc, 0xee],
    [0x88, 0x22, 0x55],
    [0x44, 0xaa, 0x99],
    [0x99, 0x99, 0x33],
];

/// A colour as markup has it.
pub fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A value and the colour it has; between two stops the colour goes linearly, two stops at one value are a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Stop {
    /// The value, in the scale's unit.
    pub value: f64,
    /// Its colour.
    pub colour: Rgb,
}

/// A colour scale: stops in ascending order, at least one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Scale {
    /// What is shown.
    pub name: String,
    /// Its unit; empty for a ratio.
    pub unit: String,
    /// The stops.
    pub stops: Vec<Stop>,
    /// Marked values: the tolerances.
    pub marks: Vec<f64>,
    /// Values beyond the ends occur and have the end's colour.
    pub open_ended: bool,
}

/// The tolerances a deviation is held against, both positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Accepted material left, mm.
    pub scallop_mm: f64,
    /// Accepted gouge, mm.
    pub gouge_mm: f64,
}

impl Limits {
    /// How far out `deviation_mm` is: 1 at a tolerance, more outside, 0 where nothing is known.
    pub fn severity(&self, deviation_mm: f64) -> f64 {
        let limit = if deviation_mm >= 0.0 { self.scallop_mm } else { -self.gouge_mm };
        let severity = deviation_mm / limit;
        if severity.is_nan() { 0.0 } else { severity }
    }
}

impl Scale {
    /// The scale of deviations. A tolerance that is missing or not positive gets the step at zero: everything on
    /// that side then counts as outside, and no tolerance is marked. `reach_mm` is the largest deviation shown, from
    /// which the scale's length comes where both are missing.
    pub fn deviation(limits: Limits, reach_mm: f64) -> Self {
        let usable = |x: f64| if x.is_finite() && x > 0.0 { x } else { 0.0 };
        let (scallop, gouge) = (usable(limits.scallop_mm), usable(limits.gouge_mm));
        let reach = if usable(reach_mm) > 0.0 { reach_mm } else { 1.0 };
        let unit_up = if scallop > 0.0 {
            scallop
        } else if gouge > 0.0 {
            gouge
        } else {
            reach / 3.0
        };
        let unit_down = if gouge > 0.0 { gouge } else { unit_up };
        let mut stops = vec![
            Stop { value: -gouge - 2.0 * unit_down, colour: [0x52, 0x00, 0x4a] },
            Stop { value: -gouge, colour: [0xe5, 0x1f, 0x92] },
        ];
        let mut marks = vec![];
        if gouge > 0.0 {
            stops.push(Stop { value: -gouge, colour: [0x8c, 0x84, 0xd6] });
            stops.push(Stop { value: 0.0, colour: [0xe2, 0xe0, 0xf4] });
            marks.push(-gouge);
        }
        if scallop > 0.0 {
            stops.push(Stop { value: 0.0, colour: [0xdf, 0xf1, 0xe4] });
            stops.push(Stop { value: scallop, colour: [0x1d, 0x8f, 0x6d] });
            marks.push(scallop);
        }
        stops.push(Stop { value: scallop, colour: [0xff, 0xb0, 0x1f] });
        stops.push(Stop { value: scallop + unit_up, colour: [0xdd, 0x35, 0x1f] });
        stops.push(Stop { value: scallop + 2.0 * unit_up, colour: [0x78, 0x06, 0x10] });
        Self { name: "Deviation".into(), unit: "mm".into(), stops, marks, open_ended: true }
    }

    /// A scale from the least to the greatest of `values` that are finite, dark blue to yellow; `None` where there is
    /// none. Equal values get a scale of one colour.
    pub fn sequential(name: &str, unit: &str, values: impl Iterator<Item = f64>) -> Option<Self> {
        let (lo, hi) = values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if lo > hi {
            return None;
        }
        let colours: [Rgb; 5] = [
            [0x2a, 0x0f, 0x86],
            [0x8a, 0x1c, 0x9c],
            [0xd2, 0x4a, 0x70],
            [0xf8, 0x93, 0x3f],
            [0xf4, 0xe4, 0x3a],
        ];
        let stops = colours
            .iter()
            .enumerate()
            .map(|(i, &colour)| Stop { value: lo + (hi - lo) * i as f64 / 4.0, colour })
            .collect();
        Some(Self { name: name.into(), unit: unit.into(), stops, marks: vec![], open_ended: false })
    }

    /// First and last value of the scale.
    pub fn range(&self) -> (f64, f64) {
        let end = |stop: Option<&Stop>| stop.map_or(0.0, |s| s.value);
        (end(self.stops.first()), end(self.stops.last()))
    }

    /// The colour of `value`; beyond the ends that of the end. At a step the value itself belongs to the side nearer
    /// to zero: a deviation equal to its tolerance is within.
    pub fn colour(&self, value: f64) -> Rgb {
        let (Some(first), Some(last)) = (self.stops.first(), self.stops.last()) else { return UNKNOWN };
        if value.is_nan() {
            return UNKNOWN;
        }
        if value < first.value {
            return first.colour;
        }
        if value > last.value {
            return last.colour;
        }
        let mut segments = self.stops.windows(2).filter(|w| w[0].value < w[1].value);
        let found = if value > 0.0 {
            segments.find(|w| value <= w[1].value)
        } else {
            segments.rfind(|w| w[0].value <= value)
        };
        found.map_or(last.colour, |w| {
            let t = (value - w[0].value) / (w[1].value - w[0].value);
            mix(w[0].colour, w[1].colour, t)
        })
    }

    /// A vertical bar with ticks as an SVG fragment, `length` high and about 80 wide with its text, top left at 0, 0.
    pub fn bar(&self, length: f64) -> String {
        let (lo, hi) = self.range();
        let span = if hi > lo { hi - lo } else { 1.0 };
        let y = |value: f64| length * (1.0 - ((value - lo) / span).clamp(0.0, 1.0));
        let mut out = String::new();
        for w in self.stops.windows(2) {
            // Thin rectangles instead of gradients: no ids, so that several bars can live in one document.
            let (top, bottom) = (y(w[1].value), y(w[0].value));
            let pieces = ((bottom - top) / 3.0).ceil().max(0.0) as usize;
            for i in 0..pieces {
                let t = |k: f64| k / pieces as f64;
                let [r, g, b] = mix(w[0].colour, w[1].colour, t(i as f64 + 0.5));
                let y0 = bottom + (top - bottom) * t(i as f64 + 1.0);
                let height = (bottom - top) / pieces as f64;
                let _ = write!(
                    out,
                    "<rect x=\"0\" y=\"{}\" width=\"14\" height=\"{}\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>",
                    coordinate(y0),
                    coordinate(height + 0.6)
                );
            }
        }
        if hi <= lo {
            let [r, g, b] = self.colour(lo);
            let _ = write!(
                out,
                "<rect width=\"14\" height=\"{}\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>",
                coordinate(length)
            );
        }
        for (value, marked) in self.ticks(length) {
            let at = coordinate(y(value));
            let (to, weight) = if marked { (21, " font-weight=\"700\"") } else { (17, "") };
            let _ = write!(
                out,
                "<path d=\"M{from} {at}H{to}\" stroke=\"currentColor\" fill=\"none\"/>\
                 <text x=\"24\" y=\"{at}\" dy=\".35em\"{weight}>{}</text>",
                escape(&self.tick_text(value)),
                from = if marked { 0 } else { 14 }
            );
        }
        out
    }

    /// The tick's text; at an open end it says so.
    fn tick_text(&self, value: f64) -> String {
        let (lo, hi) = self.range();
        // A round tick next to zero is zero up to the rounding of its sum.
        let text = if value.abs() < 1e-9 * (hi - lo) { "0".into() } else { short(value, 3) };
        match value {
            v if self.open_ended && v == hi => format!("\u{2265} {text}"),
            v if self.open_ended && v == lo => format!("\u{2264} {text}"),
            _ => text,
        }
    }

    /// The ticks, ascending: marked ones, zero and the ends always, round ones where there is room.
    fn ticks(&self, length: f64) -> Vec<(f64, bool)> {
        let (lo, hi) = self.range();
        let span = hi - lo;
        if span <= 0.0 || !span.is_finite() {
            return vec![(lo, false)];
        }
        let room = 14.0 / length * span;
        let mut ticks: Vec<(f64, bool)> = self.marks.iter().map(|value| (*value, true)).collect();
        let step = nice_step(span / 8.0);
        let round =
            (0..).map(|i| ((lo / step).ceil() + f64::from(i)) * step).take(40).take_while(|v| *v <= hi);
        let near = |ticks: &[(f64, bool)], v: f64| ticks.iter().any(|(t, _)| (t - v).abs() < room);
        let always = [0.0, hi, lo];
        for v in always.into_iter().filter(|v| (lo..=hi).contains(v)).chain(round) {
            if !near(&ticks, v) {
                ticks.push((v, false));
            }
        }
        ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        ticks
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below `step`.
pub fn nice_step(step: f64) -> f64 {
    let decade = 10.0_f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * decade).find(|s| *s >= step * (1.0 - 1e-9)).unwrap_or(step)
}

/// `t` of the way from `a` to `b`, in sRGB as the browser's canvas does it.
fn mix(a: Rgb, b: Rgb, t: f64) -> Rgb {
    std::array::from_fn(|i| {
        (f64::from(a[i]) + (f64::from(b[i]) - f64::from(a[i])) * t).round().clamp(0.0, 255.0) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LIMITS: Limits = Limits { scallop_mm: 0.01, gouge_mm: 0.005 };

    fn is_green([r, g, b]: Rgb) -> bool {
        g > r && g > b
    }

    #[test]
    fn the_tolerance_itself_is_within_and_what_exceeds_it_is_not() {
        let scale = Scale::deviation(LIMITS, 0.0);
        assert_eq!(scale.colour(0.01), [0x1d, 0x8f, 0x6d]);
        assert_eq!(scale.colour(0.01 + 1e-12), [0xff, 0xb0, 0x1f]);
        assert_eq!(scale.colour(-0.005), [0x8c, 0x84, 0xd6]);
        assert_eq!(scale.colour(-0.005 - 1e-12), [0xe5, 0x1f, 0x92]);
        assert_eq!(scale.colour(f64::NAN), UNKNOWN);
    }

    #[test]
    fn beyond_the_ends_stays_the_colour_of_the_end() {
        let scale = Scale::deviation(LIMITS, 0.0);
        assert_eq!(scale.colour(1e9), scale.colour(0.03));
        assert_eq!(scale.colour(f64::INFINITY), [0x78, 0x06, 0x10]);
        assert_eq!(scale.colour(f64::NEG_INFINITY), [0x52, 0x00, 0x4a]);
        assert_eq!(scale.range(), (-0.015, 0.03));
    }

    #[test]
    fn without_tolerances_nothing_looks_accepted() {
        for missing in [f64::NAN, 0.0, -1.0] {
            let scale = Scale::deviation(Limits { scallop_mm: missing, gouge_mm: missing }, 0.3);
            assert!(scale.marks.is_empty());
            assert!(!is_green(scale.colour(1e-6)) && !is_green(scale.colour(0.2)), "{missing}");
            assert!(scale.range().1 > 0.0 && scale.range().1.is_finite());
        }
    }

    #[test]
    fn a_sequential_scale_has_its_ends_at_the_extremes() {
        let scale =
            Scale::sequential("w", "mm", [2.0, f64::NAN, 1.0, 3.0].into_iter()).expect("finite values");
        assert_eq!(scale.range(), (1.0, 3.0));
        assert_eq!(scale.colour(2.0), [0xd2, 0x4a, 0x70]);
        assert!(Scale::sequential("w", "mm", [f64::NAN].into_iter()).is_none());
        assert_eq!(Scale::sequential("w", "mm", [4.0; 3].into_iter()).expect("finite").range(), (4.0, 4.0));
    }

    #[test]
    fn the_bar_names_both_tolerances() {
        let bar = Scale::deviation(LIMITS, 0.0).bar(200.0);
        for text in [">\u{2212}0.005<", ">0.01<", ">0<", ">\u{2265} 0.03<"] {
            assert!(bar.contains(text), "{text} is missing in {bar}");
        }
    }

    #[test]
    fn severity_is_one_at_either_tolerance() {
        assert_eq!(LIMITS.severity(0.01), 1.0);
        assert_eq!(LIMITS.severity(-0.01), 2.0);
        assert_eq!(LIMITS.severity(f64::NAN), 0.0);
    }

    #[test]
    fn steps_are_round() {
        assert_eq!([0.0013, 0.2, 3.0, 70.0].map(nice_step), [0.002, 0.2, 5.0, 100.0]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        /// Green means within the tolerance and nothing else, at any scale.
        #[test]
        fn green_is_within(deviation in -5.0..5.0_f64, scale in -6..6_i32) {
            let unit = 10.0_f64.powi(scale);
            let limits = Limits { scallop_mm: unit, gouge_mm: 0.5 * unit };
            let colour = Scale::deviation(limits, 0.0).colour(deviation * unit);
            prop_assert_eq!(is_green(colour), deviation > 0.0 && deviation <= 1.0);
        }
    }
}
