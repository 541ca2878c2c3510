//! How the tolerance is best shared between tooth marks along the feed and scallops across it [R97, eq. 6].
//!
//! With `S_L ~ a sqrt(chi h)` and `S_C ~ b sqrt((1 - chi) h)` the area per tooth `S_L S_C` is greatest at chi = 1/2. Where the feed
//! per tooth is capped below that, more for the marks buys nothing: the best share is the smallest that still allows
//! the cap. The exact widths move both by terms of order h; [`best_share`] maximises with whatever widths it is given.

use crate::rate::Share;
use osculate_geom::roots::try_minimum;

/// The best share by leading orders: 1/2, or less where `cap_mm` is reached before.
///
/// `along_per_mm` is q(d) of the relative form along the feed: `S_L = 2 sqrt(2 h_L / q)`. Its relative error in the area per
/// tooth is of first order in h.
///
/// ```
/// use osculate_productivity::split::leading_share;
///
/// // A half each, unless the feed per tooth is capped first: S_L = 2 sqrt(2 h_L / q) is 0.4 mm at h_L = 0.002 mm here.
/// assert_eq!(leading_share(0.1, f64::INFINITY, 0.01), 0.5);
/// assert!((leading_share(0.1, 0.4, 0.01) - 0.2).abs() < 1e-12);
/// ```
#[must_use]
pub fn leading_share(along_per_mm: f64, cap_mm: f64, tolerance_mm: f64) -> f64 {
    let enough = cap_mm * cap_mm * along_per_mm / (8.0 * tolerance_mm);
    enough.clamp(0.0, 0.5)
}

/// A share and the area per tooth that it gives.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Best {
    /// The share.
    pub share: Share,
    /// Feed per tooth, mm: the mark at the share, or the cap.
    pub feed_per_tooth_mm: f64,
    /// Strip width at the rest of the tolerance, mm.
    pub width_mm: f64,
    /// Whether the cap on the feed per tooth binds.
    pub capped: bool,
}

/// Bisections towards the cap: half of double precision's digits settle it.
const STEPS: u32 = 40;
/// The optimum without the cap is flat: this share of its range loses less than the tenth digit of the product.
const SHARE: f64 = 3e-5;

/// The share that makes `min(S_L, cap) S_C` greatest, for any two widths that grow with their part of the tolerance.
///
/// ```
/// use osculate_productivity::split::best_share;
/// use std::convert::Infallible;
///
/// // Both widths grow with the root of their part of the tolerance: the product is greatest at a half each.
/// let width = |h_mm: f64| Ok::<_, Infallible>(h_mm.sqrt());
/// let best = best_share(0.02, f64::INFINITY, width, width)?;
/// assert!((best.share.chi - 0.5).abs() < 1e-3 && !best.capped);
/// assert!((best.share.along_mm() + best.share.across_mm() - 0.02).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The first error of either width.
pub fn best_share<E>(
    tolerance_mm: f64,
    cap_mm: f64,
    along: impl Fn(f64) -> Result<f64, E>,
    across: impl Fn(f64) -> Result<f64, E>,
) -> Result<Best, E> {
    let share = |chi: f64| Share { tolerance_mm, chi };
    let made = |chi: f64, capped: bool| -> Result<Best, E> {
        let s = share(chi);
        let feed = if capped { cap_mm } else { along(s.along_mm())?.min(cap_mm) };
        Ok(Best { share: s, feed_per_tooth_mm: feed, width_mm: across(s.across_mm())?, capped })
    };
    // Without the cap: a product that has one maximum.
    let area = |chi: f64| -> Result<f64, E> {
        let s = share(chi);
        Ok(along(s.along_mm())? * across(s.across_mm())?)
    };
    let free = try_minimum([0.02, 0.98], SHARE, |chi| area(chi).map(|a| -a))?.x;
    if along(share(free).along_mm())? <= cap_mm {
        return made(free, false);
    }
    // The smallest share that reaches the cap.
    let (mut lo, mut hi) = (0.0, free);
    for _ in 0..STEPS {
        let m = 0.5 * (lo + hi);
        if along(share(m).along_mm())? < cap_mm { lo = m } else { hi = m }
    }
    made(hi, true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::convert::Infallible;

    proptest! {
        /// With square roots the answer is known; with further terms it is never beaten by a scan.
        #[test]
        fn best_of_a_scan(
            q in 0.01..1.0f64, p in 0.001..1.0f64, h in 1e-4..1e-1f64, cap in 0.01..3.0f64, bend in -0.3..0.3f64
        ) {
            let along = |x: f64| Ok::<_, Infallible>(2.0 * (2.0 * x / q).sqrt());
            let across = |x: f64| Ok::<_, Infallible>(2.0 * (2.0 * x / p).sqrt() * (1.0 + bend * x / h));
            let got = best_share(h, cap, along, across).unwrap();
            let product = |chi: f64| {
                let (Ok(a), Ok(b)) = (along(chi * h), across((1.0 - chi) * h));
                a.min(cap) * b
            };
            let own = got.feed_per_tooth_mm * got.width_mm;
            for k in 1..400 {
                prop_assert!(product(f64::from(k) / 400.0) <= own * (1.0 + 1e-9));
            }
            let plain = best_share(h, cap, along, |x| Ok::<_, Infallible>((x / p).sqrt())).unwrap();
            prop_assert!((plain.share.chi - leading_share(q, cap, h)).abs() < 1e-4, "{plain:?}");
        }
    }
}
