//! The other times at which a moving tool comes over a strip: its heel behind the contact, its shank before it, and on wavy
//! parts the same bottom at a neighbouring instant.
//!
//! The entry of a fixed line into the tool has a minimum near the instant of contact. It may have others: over a part that is
//! hollow along the feed a leaning disc's far rim comes over the same place a tool's diameter later and lies deeper than
//! its near one where the lead is less than about R over the hollow's radius; over waves a tool that turns with the normal
//! rocks. The tool is looked at as long as its body can lie over the contact, every quarter of its radius; as far as its bottom reaches
//! every third of the distance between the surface's knots where that is less: between knots a spline has no finer waves. Where an entry comes down to
//! the tolerance, or heads there, at another instant than that of contact, every place of the strip takes the deepest of all passages.
//!
//! *Limits.* Of a shank only the part below two radii is looked at where a hollow of twice the local curvature would not reach
//! higher. Instants at which the part has turned by a right angle are not: the tool is on the part's other side. Knots closer than
//! three hundredths of the tool's radius are looked at every hundredth.

use super::ContactMotion;
use crate::contact::{Contact, Lean};
use crate::cutter::{Cutter, Line};
use crate::pose::Pose;
use crate::sweep::{Reach, SweptMotion, reach_from};
use osculate_geom::Darboux;

/// Greatest and least distance between the instants looked at, in the tool's radius, and most of them to a side at the greatest.
pub(super) const APART: f64 = 0.25;
const CLOSEST: f64 = 0.01;
const MOST: f64 = 48.0;
/// Instants looked at between two knots.
const OF_PITCH: f64 = 1.0 / 3.0;
/// Way along a hollow over the straight distance: enough for one of one and a third times the tool's radius.
const AROUND: f64 = 1.25;
/// How far an entry is taken to go on falling between instants, of what it falls from one to the next.
const AHEAD: f64 = 1.0;
/// How much further than to the instants next to it an entry may fall, for which its least stands: entries bend more than the plane
/// of the tip where the corner comes over a line.
const SLACK: f64 = 2.0;
/// Way of the cutter's bottom between instants that is short against the corner's radius: a circle rises over half of it, the way to
/// the nearer instant, by an eighth of what the square of all of it over the radius says.
const SHORT: f64 = 0.5;
/// First step of the search from an instant looked at, of the distance between them.
const FIRST: f64 = 0.25;

/// Poses of the tool along the feed, from the last instant before the contact to the last one after it.
pub(super) struct Passages {
    poses: Vec<(f64, Pose)>,
    /// The contact's own.
    own: usize,
}

/// How far from the contact waves are looked at, mm: as far as the tool's bottom reaches, not its shank.
pub(super) fn bottom_mm(cutter: &Cutter) -> f64 {
    2.0 * AROUND * cutter.radius_mm()
}

impl Passages {
    /// Poses while the body can lie over the contact at `t0`, `speed` mm per unit of the motion's parameter; `pitch_mm` is the
    /// distance between knots along the feed.
    pub(super) fn new(
        contact: &Contact<'_>,
        motion: &ContactMotion<'_>,
        (t0, speed): (f64, f64),
        (reach, pitch_mm): ([f64; 2], f64),
    ) -> Self {
        let radius = contact.cutter.radius_mm();
        let coarse = (APART * radius).max(reach[0].max(reach[1]) / MOST);
        let fine = coarse.min((OF_PITCH * pitch_mm).max(CLOSEST * radius));
        let side = |sign: f64, reach_mm: f64| {
            let mut way = 0.0;
            std::iter::from_fn(|| {
                if way >= reach_mm {
                    return None;
                }
                way += if way < bottom_mm(contact.cutter) { fine } else { coarse };
                let t = t0 + sign * way / speed;
                let (frame, _) = motion.line.frame(t).ok()?;
                let same_side = frame.normal.dot(&contact.frame.normal) > 0.0;
                same_side.then(|| (t, contact.lean.pose(contact.cutter, &frame, contact.lift_mm)))
            })
            .collect::<Vec<_>>()
        };
        let mut poses = side(-1.0, reach[1]);
        poses.reverse();
        let own = poses.len();
        poses.push((t0, contact.pose()));
        poses.extend(side(1.0, reach[0]));
        Self { poses, own }
    }

    /// The longer of the ways to the instants before and after one, in the motion's parameter.
    fn apart(&self, k: usize) -> f64 {
        let t = |k: usize| self.poses[k.min(self.poses.len() - 1)].0;
        (t(k + 1) - t(k)).abs().max((t(k) - t(k.saturating_sub(1))).abs())
    }

    /// As [`minima`], with the entry and the most that it falls to there.
    fn falling(&self, cutter: &Cutter, line: &Line, below_mm: f64, mut see: impl FnMut(usize, f64, f64)) {
        minima(cutter, line, (&self.poses, below_mm), |k, [a, b, c]| {
            let fall = |x: f64| if x.is_finite() { x - b } else { 0.0 };
            see(k, b, fall(a).max(fall(c)));
        });
    }

    /// Whether the tool comes down to `height_mm` over a line at another instant than near `t`, or heads there.
    pub(super) fn matter(&self, cutter: &Cutter, line: &Line, t: f64, height_mm: f64) -> bool {
        let mut found = false;
        self.falling(cutter, line, height_mm, |k, low, falls| {
            let other = (self.poses[k].0 - t).abs() > 1.5 * self.apart(k);
            found |= other && low - AHEAD * falls <= height_mm;
        });
        found
    }

    /// The deepest of the passages over a line that go below `bound_mm` over it; `but` is the instant of one that is known.
    pub(super) fn deepest(
        &self,
        cutter: &Cutter,
        line: &Line,
        motion: &impl SweptMotion,
        (bound_mm, but): (f64, f64),
    ) -> Option<Reach> {
        let mut best = Reach { at_mm: bound_mm, t: f64::NAN };
        self.falling(cutter, line, bound_mm, |k, low, falls| {
            let t = self.poses[k].0;
            if low - AHEAD * falls < best.at_mm && (t - but).abs() > self.apart(k) {
                let found = reach_from(cutter, line, motion, t, FIRST * self.apart(k));
                best = found.filter(|f| f.at_mm < best.at_mm).unwrap_or(best);
            }
        });
        best.t.is_finite().then_some(best)
    }

    /// The lowest of the entries below a height that are looked at over a line at other instants than that of contact; infinite
    /// without.
    pub(super) fn lowest_mm(&self, cutter: &Cutter, line: &Line, below_mm: f64) -> f64 {
        let mut lowest = f64::INFINITY;
        self.falling(cutter, line, below_mm, |k, low, _| {
            if k != self.own {
                lowest = lowest.min(low);
            }
        });
        lowest
    }
}

/// Calls `see` with the instants at which the entry of a line is lower than at its neighbours, or as low, with the three entries
/// (infinite where the line misses, and beyond the ends), where it may come down below a height. An instant whose plane of the tip
/// stays above that, by more than [`SLACK`] times what it falls by to the instants next to it, is not looked at, nor one whose
/// corner does by as much as a least entry between instants may be lower.
pub(super) fn minima(
    cutter: &Cutter,
    line: &Line,
    (poses, below_mm): (&[(f64, Pose)], f64),
    mut see: impl FnMut(usize, [f64; 3]),
) {
    let entry = |k: Option<usize>| {
        let pose = k.and_then(|k| poses.get(k));
        pose.and_then(|p| cutter.entry(&p.1, line)).map_or(f64::INFINITY, |e| e.at_mm)
    };
    let least = |k: usize| poses.get(k).map(|p| Cutter::least_entry_mm(&p.1, line));
    let (mut least_before, mut least_here) = (None, least(0));
    let mut before = [f64::INFINITY; 2];
    // One more than there are, so that the last can be the lowest.
    for k in 0..=poses.len() {
        let least_next = least(k + 1);
        let next = match least_here {
            Some(here) => {
                let falls =
                    [least_before, least_next].into_iter().flatten().fold(0.0, |f, x| (x - here).max(f));
                let looked_mm = below_mm + SLACK * falls;
                let above = here > looked_mm
                    || cutter.enters_above(&poses[k].1, line, looked_mm + rise_mm(cutter, poses, k));
                if above { f64::INFINITY } else { entry(Some(k)) }
            }
            None => f64::INFINITY,
        };
        let [a, b] = before;
        if b.is_finite() && b <= a && b <= next {
            // Those next to it may be above the height, not looked at.
            let [first, last] = [(a, k.checked_sub(2)), (next, Some(k))]
                .map(|(x, of)| if x.is_finite() { x } else { entry(of) });
            if b <= first && b <= last {
                see(k - 1, [first, b, last]);
            }
        }
        before = [b, next];
        (least_before, least_here) = (least_here, least_next);
    }
}

/// How much higher than at its least an entry into the corner may be at the instant looked at next to it, mm: as a circle of the
/// corner's radius rises over the way of the cutter's bottom from this instant to its neighbours. Infinite where that is not short
/// against the radius.
fn rise_mm(cutter: &Cutter, poses: &[(f64, Pose)], k: usize) -> f64 {
    let corner = cutter.corner_mm();
    let (own, across) = (&poses[k].1, 2.0 * cutter.radius_mm());
    let way_squared = |to: usize| {
        poses.get(to).map_or(0.0, |(_, p)| {
            let turn = p.axis.into_inner() - own.axis.into_inner();
            2.0 * ((p.tip - own.tip).norm_squared() + across * across * turn.norm_squared())
        })
    };
    let way = way_squared(k + 1).max(way_squared(k.wrapping_sub(1)));
    if way < (SHORT * corner).powi(2) { way / corner } else { f64::INFINITY }
}

/// How far the tool's body reaches over the contact, ahead of and behind it in the motion's sense, mm.
pub(super) fn reach(contact: &Contact<'_>, forward: f64) -> [f64; 2] {
    let hollow = (-contact.forms.principal().k_min).max(0.0);
    let [behind, ahead] = extent(contact.cutter, contact.lean, &contact.frame, hollow);
    // The body lies behind the contact: it comes over it later.
    if forward > 0.0 { [-behind, ahead] } else { [ahead, -behind] }
}

/// How far the lowest point of the parabola through three equally spaced heights lies below the middle one.
pub(super) fn dip([a, b, c]: [f64; 3]) -> f64 {
    let (bend, slope) = (0.5 * (a + c) - b, 0.5 * (c - a));
    if bend.is_finite() && bend > 0.0 { 0.25 * slope * slope / bend } else { 0.0 }
}

/// How far the body reaches along the feed from the contact, mm: backward (at most zero) and forward; of the shank only as
/// much as can matter where the part is hollow by `hollow_per_mm`.
pub(super) fn extent(cutter: &Cutter, lean: Lean, frame: &Darboux, hollow_per_mm: f64) -> [f64; 2] {
    let (radius, length) = (cutter.radius_mm(), cutter.length_mm());
    let pose = lean.pose(cutter, frame, 0.0);
    // A shank at a length l from the tip stands l cos(lead) high; a hollow of twice the curvature rises to half its square
    // over the radius. The difference is concave in l: above zero at both ends it is so between.
    let clear = |l: f64| l * lean.lead_rad.cos() > hollow_per_mm * (l + radius).powi(2);
    let low = (2.0 * radius).min(length);
    let looked_at = if clear(low) && clear(length) { low } else { length };
    let along = |l: f64| {
        let p = pose.tip + pose.axis.into_inner() * l;
        (p - frame.point).dot(&frame.tangent)
    };
    let (a, b) = (along(0.0), along(looked_at));
    [(a.min(b) - radius).min(0.0) * AROUND, (a.max(b) + radius).max(0.0) * AROUND]
}

#[cfg(test)]
mod tests {
    use crate::strip::{Chart, Demand, StripError, Within, exact, exact_to};
    use crate::{Contact, Cutter, CutterSpec, FeedLine, Lean};
    use osculate_geom::analytic::Cylinder;
    use osculate_geom::{Axis, Flipped, Interval, uv};

    const HOLLOW_MM: f64 = 40.0;
    const RADIUS_MM: f64 = 10.0;

    fn flat() -> Cutter {
        let spec = CutterSpec::Flat { diameter_mm: 2.0 * RADIUS_MM, length_mm: 60.0 };
        Cutter::try_from(spec).unwrap()
    }

    fn bore() -> Flipped<Cylinder> {
        Flipped(Cylinder::new(HOLLOW_MM, Interval::new(-80.0, 80.0)).unwrap())
    }

    /// Around a bore of radius P the far rim of a leaning disc stands `sqrt(P^2 - 4 P R sin(lead) + 4 R^2)` from its axis.
    fn depth(lead_rad: f64) -> f64 {
        let (p, r) = (HOLLOW_MM, RADIUS_MM);
        (p * p - 4.0 * p * r * lead_rad.sin() + 4.0 * r * r).sqrt() - p
    }

    #[test]
    fn the_heel_of_a_disc_in_a_bore() {
        let (bore, cutter) = (bore(), flat());
        let chart = Chart::new(&bore, uv(1.0, 3.0), 1.2 * RADIUS_MM, 1e-4).unwrap();
        for (lead_rad, feed, angle) in [
            (0.17, FeedLine::Iso(Axis::U), 0.0),
            (0.2, FeedLine::IsoReversed(Axis::U), std::f64::consts::PI),
            (0.24, FeedLine::Angle(0.0), 0.0),
            (-0.2, FeedLine::Angle(0.0), 0.0),
        ] {
            let lean = Lean { lead_rad, tilt_rad: 0.0 };
            let contact = Contact::new(&bore, uv(1.0, 3.0), &cutter, feed, lean).unwrap();
            let want = depth(lead_rad.abs());
            // Next to the contact the tool fits: only the far rim goes deep, and deepest over the contact.
            assert!(contact.fits().is_ok() && want > 0.1);
            let got = exact(&contact, 0.01).unwrap();
            assert!((got.undercut_mm / want - 1.0).abs() < 1e-9, "{got:?} against {want}");
            let refused = exact_to(&contact, 0.01, Demand { deepest_mm: 0.05, relative: 0.0 });
            assert!(
                matches!(refused, Err(StripError::TooDeep { dip_mm, .. }) if dip_mm > 0.05),
                "{refused:?}"
            );
            let within = Within { scallop_mm: 0.01, gouge_mm: want + 1.0 };
            let near = chart.strip(&cutter, angle, lean, within).unwrap();
            assert!((near.undercut_mm / want - 1.0).abs() < 1e-3, "{near:?} against {want}");
        }
    }

    /// Where the heel stays clear the strip is that of the contact's own passage.
    #[test]
    fn a_heel_that_clears() {
        let (bore, cutter) = (bore(), flat());
        let lean = Lean { lead_rad: 0.3, tilt_rad: 0.0 };
        assert!(depth(lean.lead_rad) < -0.1);
        let contact = Contact::new(&bore, uv(1.0, 3.0), &cutter, FeedLine::Iso(Axis::U), lean).unwrap();
        let got = exact_to(&contact, 0.01, Demand { deepest_mm: 0.0, relative: 0.0 }).unwrap();
        assert!(got.undercut_mm < 1e-12 && got.width_mm > 1.0, "{got:?}");
        let nearly = exact_to(&contact, 0.01, Demand { deepest_mm: 0.0, relative: 1e-3 }).unwrap();
        assert!((nearly.width_mm / got.width_mm - 1.0).abs() < 1e-3, "{nearly:?} {got:?}");
    }
}
