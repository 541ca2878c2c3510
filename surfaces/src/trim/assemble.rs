//! From a carrier and joined chains to a trimmed surface.
//!
//! Analytic carriers are narrowed to the rectangle around the inside; where nothing of the inside lies along some
//! line across a closing direction, that line becomes the cut and the direction no longer closes.

use super::carrier::{Carrier, FaceSurface};
use super::chain::Joined;
use super::region::{Chain, Known, Region};
use crate::trimmed::{TrimError, TrimmedSurface};
use osculate_geom::{Axis, Domain, Interval, Side, Uv, uv};
use std::sync::Arc;

/// A trimmed surface and whether the chains agreed with what is known of the carrier's ends.
pub(crate) struct Assembled {
    pub(crate) surface: TrimmedSurface,
    pub(crate) carrier: FaceSurface,
    pub(crate) consistent: bool,
    /// Chains left out because they go around the carrier and separate nothing.
    pub(crate) idle: usize,
}

/// Limits the carrier by the chains.
pub(crate) fn assemble(carrier: &Carrier, joined: &Joined, side: Side) -> Result<Assembled, TrimError> {
    let mut chains: Vec<Chain> = joined.chains.clone();
    if let Some((index, at)) = chains
        .iter()
        .enumerate()
        .find_map(|(k, c)| c.points.iter().find(|p| !(p.u.is_finite() && p.v.is_finite())).map(|p| (k, *p)))
    {
        return Err(TrimError::NotFinite { index, at });
    }
    let mut idle = 0;
    let mut domain = carrier.domain;
    // Unlimited directions end where the chains do.
    for axis in [Axis::U, Axis::V] {
        let i = domain.get(axis);
        if !i.length().is_finite() {
            let Some([lo, hi]) = extent(&chains, axis) else {
                return Err(TrimError::Unlimited { axis });
            };
            let lo = if i.lo.is_finite() { i.lo } else { lo };
            let hi = if i.hi.is_finite() { i.hi } else { hi };
            if hi <= lo {
                return Err(TrimError::Empty { loops: chains.len() });
            }
            set(&mut domain, axis, Interval::new(lo, hi));
        }
    }
    let mut closes = carrier.closes;
    let mut known = carrier.known;
    let mut region = Region::new(domain, closes, &chains, known);
    let mut consistent = region.consistent;
    if let Some(bounding) = without_idle_turns(carrier, &chains, &region) {
        let rest = Region::new(domain, closes, &bounding, known);
        if rest.consistent {
            (consistent, idle) = (true, chains.len() - bounding.len());
            (chains, region) = (bounding, rest);
        }
    }
    if matches!(carrier.surface, FaceSurface::Analytic(_)) && !chains.is_empty() {
        for axis in [Axis::U, Axis::V] {
            let k = index(axis);
            if closes[k] {
                if let Some(range) = cut_free(&chains, axis, domain, &region) {
                    chains =
                        chains.iter().map(|c| shifted(c, axis, range, domain.get(axis).length())).collect();
                    set(&mut domain, axis, range);
                    closes[k] = false;
                    // With one direction cut along a line that is outside, the ends of what is left are out.
                    if closes == [false, false] || closes == [false, true] {
                        known = Known { below_out: true, above_out: true, ..known };
                    }
                    region = Region::new(domain, closes, &chains, known);
                }
            } else if let Some([lo, hi]) = extent(&chains, axis) {
                let i = domain.get(axis);
                let mut narrowed = i;
                let outside = |t: f64| region.spans(axis.other(), t).is_empty();
                if lo > i.lo && lo < i.hi && outside(0.5 * (i.lo + lo)) {
                    narrowed.lo = lo;
                    known.below_out |= axis == Axis::V;
                }
                if hi < i.hi && hi > i.lo && outside(0.5 * (i.hi + hi)) {
                    narrowed.hi = hi;
                    known.above_out |= axis == Axis::V;
                }
                if narrowed != i && narrowed.hi > narrowed.lo {
                    set(&mut domain, axis, narrowed);
                    region = Region::new(domain, closes, &chains, known);
                }
            }
        }
    }
    let carrier = match &carrier.surface {
        FaceSurface::Analytic(a) => FaceSurface::Analytic(Arc::new(a.limited(domain))),
        other => other.clone(),
    };
    let shared = carrier.shared();
    let surface = TrimmedSurface::from_region(shared, domain, region, side, joined.chains.len())?;
    Ok(Assembled { surface, carrier, consistent, idle })
}

/// The chains that enclose something by themselves, where others go around a carrier that is outside at both ends without
/// a partner: those separate nothing.
fn without_idle_turns(carrier: &Carrier, chains: &[Chain], region: &Region) -> Option<Vec<Chain>> {
    let Known { below_out, above_out, oriented } = carrier.known;
    if region.consistent || !(below_out && above_out && oriented) {
        return None;
    }
    let turns = |c: &&Chain| {
        let w = c.winding();
        w.u == 0.0 && w.v == 0.0
    };
    let kept: Vec<Chain> = chains.iter().filter(turns).cloned().collect();
    // Holes in what the others should have bounded would leave the wrong side.
    let area =
        |c: &Chain| c.points.windows(2).map(|w| 0.5 * (w[0].u * w[1].v - w[1].u * w[0].v)).sum::<f64>();
    (kept.len() < chains.len() && kept.iter().map(area).sum::<f64>() > 0.0).then_some(kept)
}

const fn index(axis: Axis) -> usize {
    match axis {
        Axis::U => 0,
        Axis::V => 1,
    }
}

fn set(domain: &mut Domain, axis: Axis, i: Interval) {
    match axis {
        Axis::U => domain.u = i,
        Axis::V => domain.v = i,
    }
}

/// Least and greatest value of a parameter in all chains.
fn extent(chains: &[Chain], axis: Axis) -> Option<[f64; 2]> {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for p in chains.iter().flat_map(|c| &c.points) {
        range = [range[0].min(p.get(axis)), range[1].max(p.get(axis))];
    }
    (range[0] <= range[1]).then_some(range)
}

/// The shortest range of a closing parameter that holds the inside, where a line across it is free of it.
fn cut_free(chains: &[Chain], axis: Axis, domain: Domain, region: &Region) -> Option<Interval> {
    let i = domain.get(axis);
    let period = i.length();
    let mut covered: Vec<[f64; 2]> = Vec::new();
    for c in chains {
        if c.winding().get(axis).abs() > 0.5 * period {
            return None;
        }
        let [lo, hi] = extent(std::slice::from_ref(c), axis)?;
        if hi - lo >= period * (1.0 - 1e-9) {
            return None;
        }
        let start = i.lo + (lo - i.lo).rem_euclid(period);
        covered.push([start, start + hi - lo]);
    }
    covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
    // The widest gap between covered ranges, the wrap from last to first included.
    let mut reach = covered[0][1];
    let mut best = [0.0, 0.0];
    for c in &covered[1..] {
        if c[0] - reach > best[1] - best[0] {
            best = [reach, c[0]];
        }
        reach = reach.max(c[1]);
    }
    let wrapped = covered[0][0] + period;
    if wrapped - reach > best[1] - best[0] {
        best = [reach, wrapped];
    }
    if best[1] - best[0] <= 1e-6 * period {
        return None;
    }
    let middle = i.lo + (0.5 * (best[0] + best[1]) - i.lo).rem_euclid(period);
    if !region.spans(axis.other(), middle).is_empty() {
        return None;
    }
    let lo = best[1] - if best[1] >= i.hi { period } else { 0.0 };
    Some(Interval::new(lo, lo + period - (best[1] - best[0])))
}

/// The chain shifted by whole periods into the range.
fn shifted(c: &Chain, axis: Axis, range: Interval, period: f64) -> Chain {
    let [lo, hi] = extent(std::slice::from_ref(c), axis).unwrap_or([range.lo, range.hi]);
    let k = ((range.at(0.5) - 0.5 * (lo + hi)) / period).round();
    let move_by = |p: &Uv| match axis {
        Axis::U => uv(p.u + k * period, p.v),
        Axis::V => uv(p.u, p.v + k * period),
    };
    // A narrow chain near an end of a wide range may be nearer to the middle one period on: hold it inside.
    let mut points: Vec<Uv> = c.points.iter().map(move_by).collect();
    let (l, h) = (lo + k * period, hi + k * period);
    let slack = 1e-9 * period;
    let fix = if l < range.lo - slack {
        period
    } else if h > range.hi + slack {
        -period
    } else {
        0.0
    };
    if fix != 0.0 {
        for p in &mut points {
            match axis {
                Axis::U => p.u += fix,
                Axis::V => p.v += fix,
            }
        }
    }
    Chain { points }
}
