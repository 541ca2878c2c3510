//! Many strips of two arcs at once, as a structure of arrays [R97, eq. 37].
//!
//! The stable form of [`super::width_37`] in plain loops over eight lanes without branches, which the compiler turns into
//! vector instructions: `S = 2 x asin(y) / y`, the arc sine by a rational function of y^2 up to 1/2 and of
//! (1 - |y|) / 2 above, `asin y = pi/2 - 2 asin sqrt((1 - y)/2)` (coefficients of fdlibm's `e_asin.c`, error below
//! 1e-16). A result differs from the single call's by a few units of the last place.

use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// Sections of many contacts: arrays of one length.
#[derive(Clone, Copy, Debug)]
pub struct Sections<'a> {
    /// Normal curvature of the part across the feed, 1/mm, convex positive.
    pub part_per_mm: &'a [f64],
    /// Normal curvature of the tool in the same plane, 1/mm.
    pub tool_per_mm: &'a [f64],
    /// Tolerance, mm.
    pub scallop_mm: &'a [f64],
}

/// Arrays of different lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the arrays must have one length, got {part} of the part, {tool} of the tool, {scallop} tolerances and {out} places for widths"
)]
#[non_exhaustive]
pub struct LengthError {
    /// Of `part_per_mm`.
    pub part: usize,
    /// Of `tool_per_mm`.
    pub tool: usize,
    /// Of `scallop_mm`.
    pub scallop: usize,
    /// Of the output.
    pub out: usize,
}

/// Lanes of a block.
const LANES: usize = 8;
/// Sections that a task of the parallel form takes at a time.
const TASK: usize = 1 << 14;

/// Numerator and denominator of `(asin(x)/x - 1) / x^2` in x^2, constant term first.
// As printed there, more digits than a double keeps.
#[allow(clippy::excessive_precision)]
const TOP: [f64; 6] = [
    1.666_666_666_666_666_574_15e-01,
    -3.255_658_186_224_009_154_05e-01,
    2.012_125_321_348_629_258_81e-01,
    -4.005_553_450_067_941_140_27e-02,
    7.915_349_942_898_145_321_76e-04,
    3.479_331_075_960_211_675_70e-05,
];
#[allow(clippy::excessive_precision)]
const BOTTOM: [f64; 5] = [
    1.0,
    -2.403_394_911_734_414_218_78e+00,
    2.020_945_760_233_505_694_71e+00,
    -6.882_839_716_054_532_930_30e-01,
    7.703_815_055_590_193_527_91e-02,
];

/// `asin(y) / y` for y from 0 to 1.
#[inline(always)]
fn asinc(y: f64) -> f64 {
    let far = y > 0.5;
    let z = if far { 0.5 * (1.0 - y) } else { y * y };
    let top = TOP[0] + z * (TOP[1] + z * (TOP[2] + z * (TOP[3] + z * (TOP[4] + z * TOP[5]))));
    let bottom = BOTTOM[0] + z * (BOTTOM[1] + z * (BOTTOM[2] + z * (BOTTOM[3] + z * BOTTOM[4])));
    let ratio = 1.0 + z * (top / bottom);
    let by_half = (FRAC_PI_2 - 2.0 * z.sqrt() * ratio) / y;
    if far { by_half } else { ratio }
}

/// Width of one section; NaN outside the domain.
#[inline(always)]
fn width(kp: f64, kt: f64, h: f64) -> f64 {
    // A root of a negative quotient is NaN; that of two negative ones is sent there.
    let (top, bottom) = (h * (2.0 - h * kt), (kp + kt) * (1.0 + kp * h));
    let x = (top / bottom).sqrt();
    let y = 0.5 * kp.abs() * x;
    let fits = (h > 0.0) & (kp + kt > 0.0) & (top > 0.0) & (y <= 1.0);
    let s = 2.0 * x * asinc(y);
    if fits { s } else { f64::NAN }
}

impl Sections<'_> {
    fn checked(&self, out: &[f64]) -> Result<(), LengthError> {
        let [part, tool, scallop] = [self.part_per_mm, self.tool_per_mm, self.scallop_mm].map(<[f64]>::len);
        if part == tool && tool == scallop && scallop == out.len() {
            Ok(())
        } else {
            Err(LengthError { part, tool, scallop, out: out.len() })
        }
    }

    /// Widths of (37), mm; NaN where the section is outside the domain of [`super::width_37`].
    ///
    /// ```
    /// use osculate_productivity::closed_form::{Section, Sections, width_37};
    ///
    /// let (part, tool, scallop) = ([0.0, 0.01, -0.2], [0.1, 0.1, 0.1], [0.02; 3]);
    /// let mut widths_mm = [0.0; 3];
    /// Sections { part_per_mm: &part, tool_per_mm: &tool, scallop_mm: &scallop }.widths_37(&mut widths_mm)?;
    /// for k in 0..2 {
    ///     let one = width_37(Section { part_per_mm: part[k], tool_per_mm: tool[k], scallop_mm: scallop[k] })?;
    ///     assert!((widths_mm[k] / one - 1.0).abs() < 1e-14);
    /// }
    /// // The tool does not fit into the last one.
    /// assert!(widths_mm[2].is_nan());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`LengthError`].
    pub fn widths_37(&self, out: &mut [f64]) -> Result<(), LengthError> {
        self.checked(out)?;
        fill(self, out);
        Ok(())
    }

    /// As [`Sections::widths_37`] on all threads, with the same bits.
    ///
    /// # Errors
    /// [`LengthError`].
    pub fn widths_37_parallel(&self, out: &mut [f64]) -> Result<(), LengthError> {
        self.checked(out)?;
        out.par_chunks_mut(TASK).enumerate().for_each(|(k, out)| {
            let part = |all: &'_ [f64]| -> [usize; 2] {
                let from = (k * TASK).min(all.len());
                [from, (from + TASK).min(all.len())]
            };
            let [from, to] = part(self.part_per_mm);
            let piece = Sections {
                part_per_mm: &self.part_per_mm[from..to],
                tool_per_mm: &self.tool_per_mm[from..to],
                scallop_mm: &self.scallop_mm[from..to],
            };
            fill(&piece, out);
        });
        Ok(())
    }
}

/// Blocks of lanes, then the rest: the same arithmetic for each.
fn fill(s: &Sections<'_>, out: &mut [f64]) {
    let (kp, kp_rest) = s.part_per_mm.as_chunks::<LANES>();
    let (kt, kt_rest) = s.tool_per_mm.as_chunks::<LANES>();
    let (h, h_rest) = s.scallop_mm.as_chunks::<LANES>();
    let (to, to_rest) = out.as_chunks_mut::<LANES>();
    for (((kp, kt), h), to) in kp.iter().zip(kt).zip(h).zip(to) {
        for k in 0..LANES {
            to[k] = width(kp[k], kt[k], h[k]);
        }
    }
    for (((kp, kt), h), to) in kp_rest.iter().zip(kt_rest).zip(h_rest).zip(to_rest) {
        *to = width(*kp, *kt, *h);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Section, width_37};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every width is that of the single call, outside the domain too.
        #[test]
        fn batches_agree_with_single_calls(
            cases in prop::collection::vec((-0.5..0.5f64, -0.1..0.6f64, -0.01..3.0f64), 1..40)
        ) {
            let column = |f: fn(&(f64, f64, f64)) -> f64| cases.iter().map(f).collect::<Vec<f64>>();
            let (kp, kt, h) = (column(|c| c.0), column(|c| c.1), column(|c| c.2));
            let all = Sections { part_per_mm: &kp, tool_per_mm: &kt, scallop_mm: &h };
            let (mut out, mut parallel) = (vec![0.0; cases.len()], vec![0.0; cases.len()]);
            all.widths_37(&mut out).unwrap();
            all.widths_37_parallel(&mut parallel).unwrap();
            for (k, (got, c)) in out.iter().zip(&cases).enumerate() {
                prop_assert_eq!(got.to_bits(), parallel[k].to_bits());
                match width_37(Section { part_per_mm: c.0, tool_per_mm: c.1, scallop_mm: c.2 }) {
                    Ok(want) => prop_assert!((got - want).abs() <= 8.0 * f64::EPSILON * want, "{got} {want} {c:?}"),
                    Err(_) => prop_assert!(got.is_nan(), "{got} {c:?}"),
                }
            }
        }
    }

    #[test]
    fn flat_parts_flat_tools_and_lengths() {
        let s = Sections {
            part_per_mm: &[0.0, 0.1, 1e-9],
            tool_per_mm: &[0.1, 0.0, 0.1],
            scallop_mm: &[0.01; 3],
        };
        let mut out = [0.0; 3];
        s.widths_37(&mut out).unwrap();
        let limit = 2.0 * (0.01f64 * (2.0 - 0.001) * 10.0).sqrt();
        assert!((out[0] - limit).abs() < 1e-15 && out[1] > 0.0 && (out[2] - limit).abs() < 1e-8);
        assert_eq!(s.widths_37(&mut out[..2]), Err(LengthError { part: 3, tool: 3, scallop: 3, out: 2 }));
    }
}
