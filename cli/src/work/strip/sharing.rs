//! How the tolerance is shared between the marks of teeth along the feed and the scallops across it, at one contact.

use osculate_productivity::rate::{Caps, FeedLimit, leading_area_per_tooth_mm2};
use osculate_productivity::split::{Best, best_share};
use osculate_tools::Contact;
use osculate_tools::strip::{self, StripError};
use serde::Serialize;

/// Shares that are told: so many steps from 0 to 1, without both ends.
const STEPS: u32 = 40;

/// Productivity over the share chi of the tolerance that marks take [R97, eqs. 6 to 8], by the exact mark and the exact strip.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Sharing {
    /// The share of the marks along the feed; the strip has the rest.
    pub chi: Vec<f64>,
    /// Feed per tooth at each, mm: the mark, or the cap where that is shorter.
    pub feed_per_tooth_mm: Vec<f64>,
    /// Width of the strip at each, mm.
    pub strip_mm: Vec<f64>,
    /// Area per tooth at each, mm2.
    pub area_per_tooth_mm2: Vec<f64>,
    /// The best.
    pub best: BestShare,
    /// The greatest feed per tooth of spindle, teeth and feed, mm, and what sets it; absent without a spindle speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cap: Option<Cap>,
}

/// A cap on the feed per tooth.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Cap {
    /// The feed per tooth, mm.
    pub feed_per_tooth_mm: f64,
    /// What sets it: `feed` or `feed_per_tooth`.
    pub by: &'static str,
}

/// The share with the greatest area per tooth.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct BestShare {
    /// The share of the marks.
    pub chi: f64,
    /// Feed per tooth, mm.
    pub feed_per_tooth_mm: f64,
    /// Width of the strip, mm.
    pub strip_mm: f64,
    /// Area per tooth, mm2.
    pub area_per_tooth_mm2: f64,
    /// The same to leading order, without a cap [R97, eq. 46 as it should read]; absent where the tool does not fit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leading_area_per_tooth_mm2: Option<f64>,
    /// Whether the cap holds the feed, so that marks take no more than it needs.
    pub capped: bool,
    /// Area a minute by spindle speed and teeth, mm2/min.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_mm2_min: Option<f64>,
}

impl Sharing {
    /// Of a contact.
    ///
    /// # Errors
    /// [`StripError`]: where mark or strip have no end within the tolerance.
    pub fn of(contact: &Contact<'_>, tolerance_mm: f64, caps: Option<Caps>) -> Result<Self, StripError> {
        let along = |h_mm: f64| strip::mark(contact, h_mm).map(|m| m.length_mm());
        let across = |h_mm: f64| strip::exact(contact, h_mm).map(|s| s.width_mm);
        let cap = caps.map(|c| c.greatest_per_tooth());
        let cap_mm = cap.map_or(f64::INFINITY, |(mm, _)| mm);
        let best = best_share(tolerance_mm, cap_mm, along, across)?;
        let chi: Vec<f64> = (1..STEPS).map(|k| f64::from(k) / f64::from(STEPS)).collect();
        let feeds = chi.iter().map(|c| Ok(along(c * tolerance_mm)?.min(cap_mm)));
        let feed_per_tooth_mm = feeds.collect::<Result<Vec<f64>, StripError>>()?;
        let widths = chi.iter().map(|c| across((1.0 - c) * tolerance_mm));
        let strip_mm = widths.collect::<Result<Vec<f64>, StripError>>()?;
        let area_per_tooth_mm2 = feed_per_tooth_mm.iter().zip(&strip_mm).map(|(a, b)| a * b).collect();
        Ok(Self {
            best: told(contact, &best, caps),
            chi,
            feed_per_tooth_mm,
            strip_mm,
            area_per_tooth_mm2,
            cap: cap.map(|(feed_per_tooth_mm, by)| Cap {
                feed_per_tooth_mm,
                by: if by == FeedLimit::FeedPerTooth { "feed_per_tooth" } else { "feed" },
            }),
        })
    }
}

fn told(contact: &Contact<'_>, best: &Best, caps: Option<Caps>) -> BestShare {
    let (q, frame) = (contact.relative(), &contact.frame);
    let leading = leading_area_per_tooth_mm2(&q, &frame.tangent, &contact.forms.normal, best.share);
    let area = best.feed_per_tooth_mm * best.width_mm;
    BestShare {
        chi: best.share.chi,
        feed_per_tooth_mm: best.feed_per_tooth_mm,
        strip_mm: best.width_mm,
        area_per_tooth_mm2: area,
        leading_area_per_tooth_mm2: leading.ok().filter(|a| a.is_finite() && *a > 0.0),
        capped: best.capped,
        area_mm2_min: caps.map(|c| area * c.passages_per_min()),
    }
}
