//! The order in which passes are cut, and from which end each: that of the least time of the moves between them.
//!
//! Times are those of ways that nothing stands in: along the surface at feed, or off it, across in rapid and down again. From one
//! pass on always that follows which is reached soonest; this order and the one that passes come in are then made shorter by turning
//! stretches of the order around and by moving a few passes elsewhere (`improve`), and the shorter one counts. A closed pass may begin
//! anywhere. Where chips are wished for, or what stands above is to be cut first, passes that lie beside each other stay in their order.

use super::improve::improve;
use super::near::Places;
use super::rates::Step;
use super::ways::Finder;
use super::{Links, STRAIGHT, Walls, contacts};
use crate::plan::{CcPoint, Pass, Stretches};
use osculate_geom::{Point3, Unit3, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};

/// What an order may do with passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Freedom {
    /// Whether a pass may be run the other way: it leaves the same either way, and nobody asked for a sense.
    pub turned: bool,
    /// Whether passes that lie beside each other stay in the order in which they come.
    pub in_turn: bool,
}

/// Places at which a closed pass may begin while an order is sought; when it is found, anywhere.
const BEGINS: usize = 16;
/// Passes lie beside each other where a point of one is no farther from one of the other than this many widths of its strip.
const BESIDE: f64 = 1.5;

/// Times that an order is sought, each with what is known of the ways of those before.
const ROUNDS: usize = 4;
/// An order that takes a smaller part of the time than this is worth it.
const LESS: f64 = 0.999;

/// Where the tool is at an end of a pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub tip: Point3,
    pub axis: Unit3,
}

impl End {
    const fn of(p: &CcPoint) -> Self {
        Self { tip: p.pose.tip, axis: p.pose.axis }
    }
}

/// A pass in its place of an order: which, and at which of the ends of all it is entered and left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub pass: u32,
    pub enter: u32,
    pub leave: u32,
}

impl Placed {
    pub const fn turned(self) -> Self {
        Self { enter: self.leave, leave: self.enter, ..self }
    }
}

/// Passes by their ends.
pub(super) struct Ends<'a> {
    links: &'a Links,
    pub freedom: Freedom,
    /// All ends: of an open pass its first point and its last, of a closed one some of its points.
    pub ends: Vec<End>,
    /// The pass of each, and which point of it.
    pub of: Vec<(u32, u32)>,
    /// The ends of each pass.
    first: Vec<u32>,
    closed: Vec<bool>,
    /// Times of ways that were found, from end to end, min: something stands in those that nothing was thought to stand in.
    found: HashMap<(u32, u32), f64>,
}

impl<'a> Ends<'a> {
    fn new(passes: &[&Pass], links: &'a Links, freedom: Freedom) -> Self {
        let mut out = Self {
            links,
            freedom,
            ends: Vec::new(),
            of: Vec::new(),
            first: Vec::new(),
            closed: passes.iter().map(|p| p.closed).collect(),
            found: HashMap::new(),
        };
        for (pass, k) in passes.iter().zip(0u32..) {
            // Fewer than an index can hold, as points of passes are.
            out.first.push(out.ends.len() as u32);
            let last = pass.points.len() - 1;
            let step = if pass.closed { last.div_ceil(BEGINS).max(1) } else { last.max(1) };
            for i in (0..=last).step_by(step).filter(|i| !(pass.closed && *i == last && last > 0)) {
                out.ends.push(End::of(&pass.points[i]));
                out.of.push((k, i as u32));
            }
        }
        out.first.push(out.ends.len() as u32);
        out
    }

    pub fn passes(&self) -> usize {
        self.closed.len()
    }

    /// A pass entered at one of its ends; None where it may not be.
    fn entered(&self, end: u32) -> Option<Placed> {
        let (pass, _) = self.of[end as usize];
        let (first, next) = (self.first[pass as usize], self.first[pass as usize + 1]);
        if self.closed[pass as usize] || next - first == 1 {
            return Some(Placed { pass, enter: end, leave: end });
        }
        let other = first + next - 1 - end;
        (end == first || self.freedom.turned).then_some(Placed { pass, enter: end, leave: other })
    }

    /// Time from one end to another, min.
    pub fn min(&self, from: u32, to: u32) -> f64 {
        let expected = || self.min_between(&self.ends[from as usize], &self.ends[to as usize]);
        // The way back takes as long, or nearly.
        self.found.get(&(from.min(to), from.max(to))).copied().unwrap_or_else(expected)
    }

    /// What was taken out between two ends, the lower number first: of the end of a pass and the beginning of the next.
    fn skipped<'s>(&self, from: u32, to: u32, all: &[&'s [CcPoint]]) -> &'s [CcPoint] {
        let pass = self.of[from as usize].0 as usize;
        let is_next = to == from + 1 && self.of[to as usize].0 as usize != pass && !self.closed[pass];
        if is_next { all[pass] } else { &[] }
    }

    /// Finds the ways of an order of which the time is not known yet.
    fn find(&mut self, order: &[Placed], (passes, skipped): (&[&Pass], &[&[CcPoint]]), finder: &Finder<'_>) {
        let wanted: BTreeSet<(u32, u32)> =
            order.windows(2).map(|w| (w[0].leave, w[1].enter)).map(|(a, b)| (a.min(b), a.max(b))).collect();
        let wanted: Vec<_> = wanted.into_iter().filter(|pair| !self.found.contains_key(pair)).collect();
        let point = |end: u32| {
            let (pass, point) = self.of[end as usize];
            &passes[pass as usize].points[point as usize]
        };
        let min = |(a, b): &(u32, u32)| {
            finder.between((point(*a), point(*b)), 0, self.skipped(*a, *b, skipped)).min
        };
        let times: Vec<f64> = wanted.par_iter().map(min).collect();
        self.found.extend(wanted.into_iter().zip(times));
    }

    fn min_between(&self, a: &End, b: &End) -> f64 {
        let l = self.links;
        let step = Step { length_mm: (b.tip - a.tip).norm(), turn_rad: a.axis.angle(&b.axis) };
        let lift = if step.length_mm <= STRAIGHT * l.cutter.radius_mm() { 0.0 } else { 2.0 * l.hop_mm };
        let fed = l.rates.feed_min(step, l.feed_mm_min) + lift / l.feed_mm_min;
        fed.min(self.least_over() + l.rates.rapid_min(step))
    }

    /// Off the surface and down to it.
    fn least_over(&self) -> f64 {
        let l = self.links;
        l.approach_mm / l.feed_mm_min + l.approach_mm / l.plunge_mm_min
    }

    /// No end at a distance is reached sooner, min.
    fn least_min(&self, far_mm: f64) -> f64 {
        let l = self.links;
        let step = Step { length_mm: far_mm, turn_rad: 0.0 };
        l.rates.feed_min(step, l.feed_mm_min).min(self.least_over() + l.rates.rapid_min(step))
    }

    /// Time of all moves of an order, min.
    pub fn whole_min(&self, order: &[Placed]) -> f64 {
        order.windows(2).map(|w| self.min(w[0].leave, w[1].enter)).sum()
    }

    /// Passes as they come.
    fn as_given(&self) -> Vec<Placed> {
        (0..self.passes()).filter_map(|k| self.entered(self.first[k])).collect()
    }

    /// The end that is farthest from the middle of all.
    fn farthest(&self) -> u32 {
        let middle =
            self.ends.iter().fold(Vec3::zeros(), |sum, e| sum + e.tip.coords) / self.ends.len().max(1) as f64;
        let far = |k: u32| (self.ends[k as usize].tip.coords - middle).norm();
        let all = (0..self.ends.len() as u32).filter(|k| self.entered(*k).is_some());
        all.reduce(|a, b| if far(b) > far(a) { b } else { a }).unwrap_or(0)
    }

    /// From an end on always that which is reached soonest, of those that need not wait for another.
    fn soonest(&self, begin: u32, waits: &[Vec<u32>]) -> Vec<Placed> {
        let mut places = Places::new(&self.ends.iter().map(|e| e.tip).collect::<Vec<_>>());
        let mut waiting = vec![0u32; self.passes()];
        waits.iter().flatten().for_each(|k| waiting[*k as usize] += 1);
        let mut out: Vec<Placed> = Vec::with_capacity(self.passes());
        while out.len() < self.passes() {
            let next = match out.last() {
                None => self.entered(begin),
                Some(last) => {
                    let mut cost = |end: u32| {
                        let may =
                            self.entered(end).is_some() && waiting[self.of[end as usize].0 as usize] == 0;
                        if may { self.min(last.leave, end) } else { f64::INFINITY }
                    };
                    let best = places.best(
                        &self.ends[last.leave as usize].tip,
                        &|far| self.least_min(far),
                        &mut cost,
                    );
                    best.and_then(|(_, end)| self.entered(end))
                }
            };
            let Some(next) = next else { break };
            let own = self.first[next.pass as usize]..self.first[next.pass as usize + 1];
            own.for_each(|end| places.strike(end));
            if let Some(after) = waits.get(next.pass as usize) {
                after.iter().for_each(|k| waiting[*k as usize] -= 1);
            }
            out.push(next);
        }
        out
    }
}

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
