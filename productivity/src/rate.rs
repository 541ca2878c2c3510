//! Instantaneous productivity of finishing: area of the part per minute under the caps of tool and machine.
//!
//! `E = |S_L x S_C|` per tooth, the magnitude of the cross product of feed per tooth and strip [R97, eqs. 1, 2 and 45; the
//! printed "dot product" of (1) contradicts (2)], times teeth and spindle speed. Here S_C is measured across the feed, so
//! that the sine is one. The feed per tooth is the smallest of the tooth mark's length at its share of the tolerance, the
//! cutter's cap and the machine's feed.

/// What limits the feed, apart from the part.
///
/// ```
/// use osculate_productivity::rate::{Caps, FeedLimit};
///
/// // Two teeth at 10 000 rpm: 20 000 cuts a minute of 0.1 mm at most, which is slower than the machine's 3 m a minute.
/// let caps = Caps { spindle_rpm: 10_000.0, teeth: 2, feed_mm_min: 3000.0, feed_per_tooth_mm: 0.1 }.checked()?;
/// assert_eq!(caps.passages_per_min(), 20_000.0);
/// assert_eq!(caps.greatest_per_tooth(), (0.1, FeedLimit::FeedPerTooth));
/// // A spindle that stands is refused.
/// assert!(Caps { spindle_rpm: 0.0, ..caps }.checked().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Caps {
    /// Spindle speed, 1/min.
    pub spindle_rpm: f64,
    /// Cutting edges.
    pub teeth: u32,
    /// Greatest feed of the tool over the part, mm/min.
    pub feed_mm_min: f64,
    /// Greatest feed per tooth that the cutter stands, mm; infinite where there is no such limit.
    pub feed_per_tooth_mm: f64,
}

/// Caps that are none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what} must be positive and finite, got {got}")]
#[non_exhaustive]
pub struct CapsError {
    /// Which cap.
    pub what: &'static str,
    /// Its value.
    pub got: f64,
}

/// What holds the feed down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FeedLimit {
    /// The ridges between tooth marks.
    ToothMark,
    /// The cutter's feed per tooth.
    FeedPerTooth,
    /// The machine's or the user's feed.
    Feed,
}

/// Instantaneous productivity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rate {
    /// Feed per tooth S_L, mm.
    pub feed_per_tooth_mm: f64,
    /// Feed over the part, mm/min.
    pub feed_mm_min: f64,
    /// Strip width S_C, mm.
    pub width_mm: f64,
    /// Area per minute E, mm2/min.
    pub area_mm2_min: f64,
    /// What holds the feed down.
    pub limit: FeedLimit,
}

impl Caps {
    /// A feed alone, mm/min: teeth so many that their marks need next to no share of the tolerance.
    #[must_use]
    pub const fn of_feed(feed_mm_min: f64) -> Self {
        /// Passages of teeth a minute.
        const FAST_RPM: f64 = 1e9;
        Self { spindle_rpm: FAST_RPM, teeth: 1, feed_mm_min, feed_per_tooth_mm: f64::INFINITY }
    }

    /// The caps when they are usable.
    ///
    /// # Errors
    /// [`CapsError`].
    pub fn checked(self) -> Result<Self, CapsError> {
        let finite = [
            ("spindle_rpm", self.spindle_rpm),
            ("teeth", f64::from(self.teeth)),
            ("feed_mm_min", self.feed_mm_min),
        ];
        for (what, got) in finite {
            if !(got > 0.0 && got.is_finite()) {
                return Err(CapsError { what, got });
            }
        }
        if self.feed_per_tooth_mm > 0.0 {
            Ok(self)
        } else {
            Err(CapsError { what: "feed_per_tooth_mm", got: self.feed_per_tooth_mm })
        }
    }

    /// Passages of teeth per minute.
    #[must_use]
    pub fn passages_per_min(&self) -> f64 {
        self.spindle_rpm * f64::from(self.teeth)
    }

    /// The greatest feed per tooth whatever the part, mm, and what sets it.
    #[must_use]
    pub fn greatest_per_tooth(&self) -> (f64, FeedLimit) {
        let by_feed = self.feed_mm_min / self.passages_per_min();
        if self.feed_per_tooth_mm < by_feed {
            (self.feed_per_tooth_mm, FeedLimit::FeedPerTooth)
        } else {
            (by_feed, FeedLimit::Feed)
        }
    }

    /// Productivity of a strip of `width_mm` where the tooth marks allow `mark_mm` per tooth.
    ///
    /// ```
    /// use osculate_productivity::rate::{Caps, FeedLimit};
    ///
    /// let caps = Caps { spindle_rpm: 10_000.0, teeth: 2, feed_mm_min: 3000.0, feed_per_tooth_mm: 0.2 };
    /// // The machine's 3000 mm/min are less than 0.2 mm a tooth: a strip of 0.5 mm makes 1500 mm2 a minute.
    /// let fast = caps.rate(0.5, 1.0);
    /// assert_eq!((fast.limit, fast.feed_mm_min), (FeedLimit::Feed, 3000.0));
    /// assert!((fast.area_mm2_min - 1500.0).abs() < 1e-9);
    /// // Ridges between tooth marks bind where they allow less: 0.05 mm, 1000 mm/min.
    /// let marked = caps.rate(0.5, 0.05);
    /// assert_eq!(marked.limit, FeedLimit::ToothMark);
    /// assert!((marked.feed_mm_min - 1000.0).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn rate(&self, width_mm: f64, mark_mm: f64) -> Rate {
        let (cap, why) = self.greatest_per_tooth();
        let (per_tooth, limit) = if mark_mm < cap { (mark_mm, FeedLimit::ToothMark) } else { (cap, why) };
        let feed = per_tooth * self.passages_per_min();
        Rate {
            feed_per_tooth_mm: per_tooth,
            feed_mm_min: feed,
            width_mm,
            area_mm2_min: feed * width_mm,
            limit,
        }
    }
}

/// Area per tooth of a parallelogram of feed and strip at an angle [R97, eq. 1 as it should read].
#[must_use]
pub fn area_per_tooth_mm2(feed_mm: f64, strip_mm: f64, angle_rad: f64) -> f64 {
    feed_mm * strip_mm * angle_rad.sin().abs()
}

/// Leading order of the greatest area per tooth in the feed direction d, `8 sqrt(h_L h_C) / sqrt(q(d) q(d'))`, d' across.
///
/// It is greatest, and equal, along both principal directions of Q.
///
/// # Errors
/// [`DomainError`](crate::closed_form::DomainError) where Q is not positive along and across the feed.
pub fn leading_area_per_tooth_mm2(
    relative: &osculate_geom::Relative,
    feed: &osculate_geom::Vec3,
    normal: &osculate_geom::Unit3,
    share: Share,
) -> Result<f64, crate::closed_form::DomainError> {
    let (along, across) = (relative.along(feed), relative.along(&normal.cross(feed)));
    for q in [along, across] {
        if q.is_nan() || q <= 0.0 {
            return Err(crate::closed_form::DomainError::DoesNotFit {
                part_per_mm: f64::NAN,
                tool_per_mm: f64::NAN,
                sum_per_mm: q,
            });
        }
    }
    Ok(8.0 * (share.along_mm() * share.across_mm()).sqrt() / (along * across).sqrt())
}

/// A tolerance and the share of it that tooth marks get.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Share {
    /// The whole tolerance h, mm.
    pub tolerance_mm: f64,
    /// chi: `h_L = chi h` along the feed, `h_C = (1 - chi) h` across [R97, eq. 6].
    pub chi: f64,
}

impl Share {
    /// `chi h`, mm.
    #[must_use]
    pub fn along_mm(&self) -> f64 {
        self.chi * self.tolerance_mm
    }

    /// `(1 - chi) h`, mm.
    #[must_use]
    pub fn across_mm(&self) -> f64 {
        (1.0 - self.chi) * self.tolerance_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAPS: Caps = Caps { spindle_rpm: 10_000.0, teeth: 2, feed_mm_min: 2000.0, feed_per_tooth_mm: 0.06 };

    #[test]
    fn the_smallest_limit_binds() {
        let by_cutter = CAPS.rate(0.5, 1.0);
        assert_eq!(by_cutter.limit, FeedLimit::FeedPerTooth);
        assert!((by_cutter.area_mm2_min - 0.06 * 2.0 * 10_000.0 * 0.5).abs() < 1e-9);
        let by_mark = CAPS.rate(0.5, 0.02);
        assert_eq!((by_mark.limit, by_mark.feed_mm_min), (FeedLimit::ToothMark, 400.0));
        let by_feed = Caps { feed_mm_min: 1000.0, ..CAPS }.rate(0.5, 1.0);
        assert_eq!((by_feed.limit, by_feed.feed_mm_min), (FeedLimit::Feed, 1000.0));
    }

    #[test]
    fn refuses_nonsense() {
        assert!(Caps { teeth: 0, ..CAPS }.checked().is_err());
        assert!(Caps { spindle_rpm: f64::NAN, ..CAPS }.checked().is_err());
        assert!(Caps { feed_per_tooth_mm: -1.0, ..CAPS }.checked().is_err());
        assert!(Caps { feed_per_tooth_mm: f64::INFINITY, ..CAPS }.checked().is_ok());
    }
}
