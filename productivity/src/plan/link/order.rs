//! The order in which passes are cut, and from which end each: that of the least time of the moves between them.
//!
//! Times are those of ways that nothing stands in: along the surface at feed, or off it, across in rapid and down again. From one
//! pass on always that follows which is reached soonest; this order and the one that passes come in are then made shorter by turning
//! stretches of the order around and by moving a few passes elsewhere (`improve`), and the shorter one counts. A closed pass may begin
//! anywhere. Where chips are wished for, or what stands above is to be cut first, passes that lie beside each other stay in their order.

use super::ends::{End, Ends, Freedom};
use super::improve::improve;
use super::links::{Links, contacts};
use super::walls::Walls;
use super::ways::Finder;
use crate::plan::{CcPoint, Pass, Stretches};
use osculate_geom::Point3;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};

/// Passes lie beside each other where a point of one is no farther from one of the other than this many widths of its strip.
const BESIDE: f64 = 1.5;

/// Times that an order is sought, each with what is known of the ways of those before.
const ROUNDS: usize = 4;
/// An order that takes a smaller part of the time than this is worth it.
const LESS: f64 = 0.999;

/// For each pass those that lie beside it and come after it.
fn beside(passes: &[&Pass], links: &Links) -> Vec<Vec<u32>> {
    let wide = |p: &CcPoint| if p.width_mm > 0.0 { p.width_mm } else { links.cutter.radius_mm() };
    let reach = |p: &CcPoint| BESIDE * wide(p);
    let most = passes.iter().flat_map(|p| &p.points).map(reach).fold(0.0, f64::max);
    if most <= 0.0 {
        return vec![Vec::new(); passes.len()];
    }
    // Coordinates over a strip's width: far less than a whole number can hold.
    let cell = |p: &Point3| [p.x, p.y, p.z].map(|x| (x / most).floor() as i64);
    let mut bins: HashMap<[i64; 3], Vec<(u32, Point3, f64)>> = HashMap::new();
    let mut places: Vec<Vec<(Point3, f64)>> = Vec::with_capacity(passes.len());
    for (pass, k) in passes.iter().zip(0u32..) {
        let mut own: Vec<(Point3, f64)> = Vec::new();
        for w in pass.points.windows(2) {
            let (way, near) = (w[1].point - w[0].point, reach(&w[0]).min(reach(&w[1])));
            let pieces = (2.0 * way.norm() / near).ceil().max(1.0);
            own.extend((0..pieces as usize).map(|i| (w[0].point + way * (i as f64 / pieces), near)));
        }
        own.extend(pass.points.last().map(|p| (p.point, reach(p))));
        own.iter().for_each(|(p, near)| bins.entry(cell(p)).or_default().push((k, *p, *near)));
        places.push(own);
    }
    places
        .par_iter()
        .enumerate()
        .map(|(k, own)| {
            let mut found: BTreeSet<u32> = BTreeSet::new();
            for (p, near) in own {
                let c = cell(p);
                for i in 0..27 {
                    let key = [c[0] + i % 3 - 1, c[1] + i / 3 % 3 - 1, c[2] + i / 9 - 1];
                    let others = bins.get(&key).into_iter().flatten();
                    found.extend(
                        others
                            .filter(|(j, q, n)| *j as usize > k && (q - p).norm() <= near.max(*n))
                            .map(|o| o.0),
                    );
                }
            }
            found.into_iter().collect()
        })
        .collect()
}

/// Passes in the order of the least time between them; the ways between are found by [`link`](super::link).
#[must_use]
pub fn ordered(stretches: &Stretches, links: &Links, walls: &Walls, freedom: Freedom) -> Stretches {
    let all = stretches.passes.iter().zip(&stretches.skipped).filter(|(p, _)| !p.points.is_empty());
    let (known, skipped): (Vec<&Pass>, Vec<&[CcPoint]>) = all.map(|(p, s)| (p, s.as_slice())).unzip();
    let mut ends = Ends::new(&known, links, freedom);
    let waits = if freedom.in_turn { beside(&known, links) } else { Vec::new() };
    let contacts = contacts(&stretches.passes, links);
    let finder = Finder::new(links, (&contacts, walls), None);
    let mut order = ends.as_given();
    ends.find(&order, (&known, &skipped), &finder);
    let mut least = ends.whole_min(&order);
    let mut from = order.clone();
    for _ in 0..ROUNDS {
        let mut orders = vec![from, ends.soonest(0, &waits)];
        if !freedom.in_turn {
            orders.push(ends.soonest(ends.farthest(), &waits));
            orders.par_iter_mut().for_each(|order| improve(&ends, order));
        }
        // Of equal ones the first: passes stay as they come where that is as good.
        let best =
            orders.into_iter().map(|o| (ends.whole_min(&o), o)).reduce(|a, b| if b.0 < a.0 { b } else { a });
        let Some((hoped, next)) = best.filter(|b| b.0 < LESS * least) else { break };
        ends.find(&next, (&known, &skipped), &finder);
        let min = ends.whole_min(&next);
        if min < least {
            (least, order) = (min, next.clone());
        }
        // What was found takes as long as was hoped.
        if min <= hoped / LESS {
            break;
        }
        from = next;
    }
    let mut out = Stretches::default();
    for (k, placed) in order.iter().enumerate() {
        let pass = known[placed.pass as usize];
        let last = k.checked_sub(1).and_then(|k| out.passes.get(k)).and_then(|p| p.points.last()).copied();
        let next = order.get(k + 1);
        let turned = !pass.closed && ends.of[placed.enter as usize].1 > 0;
        out.passes.push(if pass.closed {
            // A closed pass that follows begins where this one ends.
            let open = next.filter(|n| !known[n.pass as usize].closed);
            begun(pass, &ends, (last, open.map(|n| ends.ends[n.enter as usize])))
        } else {
            let mut points = pass.points.clone();
            if turned {
                points.reverse();
            }
            Pass { points, closed: false }
        });
        let on = next.map_or(Vec::new(), |next| {
            let (a, b) = (placed.leave, next.enter);
            let mut on = ends.skipped(a.min(b), a.max(b), &skipped).to_vec();
            if b < a {
                on.reverse();
            }
            on
        });
        out.skipped.push(on);
    }
    out
}

/// A closed pass from where that is best between its neighbours.
fn begun(pass: &Pass, ends: &Ends<'_>, (before, after): (Option<CcPoint>, Option<End>)) -> Pass {
    let around = pass.points.len() - 1;
    let min = |k: usize| {
        let here = End::of(&pass.points[k]);
        let from = before.map_or(0.0, |b| ends.min_between(&End::of(&b), &here));
        from + after.map_or(0.0, |a| ends.min_between(&here, &a))
    };
    let best = (0..around).map(|k| (min(k), k)).reduce(|a, b| if b.0 < a.0 { b } else { a });
    let Some((_, begin)) = best.filter(|b| b.1 > 0) else { return pass.clone() };
    let mut points = pass.points[..around].to_vec();
    points.rotate_left(begin);
    points.push(points[0]);
    Pass { points, closed: true }
}
