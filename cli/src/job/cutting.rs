//! What is cut at which feed: the layer on the faces, and the feed as far as the marks of teeth allow.

use crate::failure::Failure;
use crate::job::problem::Places;
use crate::job::raw::Raw;
use crate::job::strategy::Strategy;
use crate::job::tool::Tool;
use crate::job::words::LeanKey;
use osculate_productivity::rate::{Caps, FeedLimit};

/// Feed of a job that gives none, mm/min.
const FEED_MM_MIN: f64 = 1000.0;
/// Material that is assumed on faces where no raw material is declared: this many scallops, so that heights are told far above
/// what is accepted, and no less than this, mm, ...
const LAYER_SCALLOPS: f64 = 20.0;
const LEAST_LAYER_MM: f64 = 0.5;
/// ... but no more than this share of the approach height, at which rapid moves end.
pub(super) const LAYER_OF_APPROACH: f64 = 0.75;
/// The share of the scallop tolerance that tooth marks take at most, unless a search lets them take less. Half is best where the feed
/// is free: the width of a strip goes with the square root of what is left for it, and so does the feed with what is left for the
/// mark [R97, eq. 41].
pub(super) const MARK_SHARE: f64 = 0.5;

/// How high material stands on the faces to machine, mm: what is declared, or else what approaches leave room for.
pub(super) fn layer_mm(raw: &Raw, tool: &Tool) -> f64 {
    if let Some(standing) = raw.standing_mm {
        return standing;
    }
    if let Some(allowance) = raw.stock.as_ref().and_then(|s| s.allowance_mm.filter(|_| s.file.is_none())) {
        return allowance;
    }
    thin_mm(
        raw.tolerance.scallop_mm,
        tool.cutter().radius_mm(),
        raw.setup.approach_mm.unwrap_or(f64::INFINITY),
    )
}

/// A layer that tells heights far above what is accepted, and below the height at which rapid moves end, mm.
pub(super) fn thin_mm(scallop_mm: f64, radius_mm: f64, approach_mm: f64) -> f64 {
    (LAYER_SCALLOPS * scallop_mm)
        .max(LEAST_LAYER_MM)
        .min(0.5 * radius_mm)
        .min(LAYER_OF_APPROACH * approach_mm)
}

/// The feed per tooth whose mark on a plane is as high as this, mm; None for an edge that leans by an unknown lead.
///
/// A corner of radius r leaves `h = r - sqrt(r^2 - f^2/4)`; an edge that leans by the lead L leaves `h = f sin L cos L`, and no more where
/// some of L is to one side.
pub(super) fn feed_per_tooth_mm(tool: &Tool, strategy: &Strategy, mark_mm: f64) -> Option<f64> {
    let r = tool.cutter().corner_mm();
    if r > 0.0 {
        let h = mark_mm.min(r);
        return Some(2.0 * (h * (2.0 * r - h)).sqrt());
    }
    let LeanKey::Given(deg) = strategy.lead else { return None };
    let lead_rad = strategy.side_tilt().map_or(deg.to_radians(), |side| side.lean(1.0).lead_rad);
    let slope = (lead_rad.sin() * lead_rad.cos()).abs();
    (slope > 0.0).then(|| mark_mm / slope)
}

/// What holds the feed of a tool down besides the marks of its teeth; None without a spindle speed.
pub(super) fn caps(tool: &Tool) -> Option<Caps> {
    let c = tool.feeding();
    Some(Caps {
        spindle_rpm: c.spindle_rpm?,
        teeth: tool.teeth().unwrap_or(1),
        feed_mm_min: c.feed_mm_min.unwrap_or(FEED_MM_MIN),
        feed_per_tooth_mm: c.feed_per_tooth_mm.unwrap_or(f64::INFINITY),
    })
}

/// A feed and what sets it, or a lesser one, mm/min.
fn lesser(feed: (f64, FeedLimit), other: f64, by: FeedLimit) -> (f64, FeedLimit) {
    if other < feed.0 { (other, by) } else { feed }
}

/// That feed, and no more than at which the marks of teeth take this share of the scallop tolerance on a plane. Layers of a roughing
/// stand higher than marks.
pub(super) fn marked(
    feed: (f64, FeedLimit),
    (tool, strategy): (&Tool, &Strategy),
    (share, scallop_mm): (f64, f64),
) -> (f64, FeedLimit) {
    let (Some(rpm), None) = (tool.feeding().spindle_rpm, strategy.layers()) else { return feed };
    let teeth = f64::from(tool.teeth().unwrap_or(1));
    let per_tooth = feed_per_tooth_mm(tool, strategy, share * scallop_mm);
    per_tooth.map_or(feed, |mm| lesser(feed, mm * teeth * rpm, FeedLimit::ToothMark))
}

/// The feed of a tool, capped by the feed per tooth where the job gives both, and what sets it.
pub(super) fn feed_mm_min(places: &Places, tool: &Tool) -> Result<(f64, FeedLimit), Failure> {
    let c = tool.feeding();
    let feed = (c.feed_mm_min.unwrap_or(FEED_MM_MIN), FeedLimit::Feed);
    if let Some(air) = c.air_feed_mm_min.filter(|air| *air < feed.0) {
        let what = format!(
            "air_feed_mm_min = {air}: where the tool takes nothing it goes no slower than where it does: give feed_mm_min = {} or more, or leave it out",
            feed.0
        );
        return Err(places.refuse("cutting", "air_feed_mm_min", what));
    }
    match (c.feed_per_tooth_mm, c.spindle_rpm, tool.teeth()) {
        (None, ..) => Ok(feed),
        (Some(f), Some(n), Some(z)) => Ok(lesser(feed, f * n * f64::from(z), FeedLimit::FeedPerTooth)),
        _ => {
            let what = "feed_per_tooth_mm needs spindle_rpm and [tool] teeth to become a feed";
            Err(places.refuse("cutting", "feed_per_tooth_mm", what))
        }
    }
}
