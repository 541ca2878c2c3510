//! Axes found from what is left: of all that the machine reaches, those along which the tool takes most of it.
//!
//! Material is looked at in points of a cube lattice. Every candidate sees the part once, as a relief, which says of each point whether the
//! tool with its holder reaches it; what is left changes from axis to axis, what is reached does not. Among those that take nearly the
//! most the one comes first that takes most for the way that it has to go.

use super::heading::Known;
use super::material::Material;
use super::relief::{Points, Relief};
use super::site::view;
use super::task::{Places, Search};
use osculate_geom::{Point3, Unit3};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Nodes of reliefs that are compared stand this part of the tool's radius apart.
const CELL: f64 = 0.25;
/// Points that are looked at, about so many.
const MOST_POINTS: f64 = 40_000.0;
/// They stand no closer than this part of the tool's radius.
const APART: f64 = 0.4;
/// Candidates that take so much of the most are compared by their way, too.
const NEARLY: f64 = 0.5;
/// Words of bits.
const WORD: usize = 64;

/// What candidates reach of the material.
pub(super) struct Views {
    /// One of those that are the same but for a turn.
    candidates: Vec<Unit3>,
    /// The points, in one of the places.
    points: Vec<Point3>,
    /// What each candidate takes from any place, a bit for each point.
    takes: Vec<Vec<u64>>,
    /// How often each of its points is gone over by a candidate in all places, at a mean.
    often: Vec<f64>,
    /// What any takes.
    any: Vec<u64>,
    each_mm3: f64,
}

/// Points of a part of which none is nearer to another than a third of a cell.
fn thinned(points: &Points, cell: f64) -> Points {
    let mut seen = BTreeSet::new();
    let (mut at, mut own) = (Vec::new(), Vec::new());
    for (p, is_own) in points.at.iter().zip(&points.own) {
        let bin = [0, 1, 2].map(|k| (p[k] / (0.5 * cell)).floor() as i64);
        if seen.insert((bin, *is_own)) {
            at.push(*p);
            own.push(*is_own);
        }
    }
    Points { at, own, spacing_mm: points.spacing_mm }
}

/// A lattice of points of the material, of one of equal places.
fn lattice(material: &Material<'_>, places: Option<&Places>, radius_mm: f64) -> (Vec<Point3>, f64) {
    let b = material.bounds();
    let size = b.max - b.min;
    let count = places.map_or(1.0, |p| p.count as f64);
    let step = (APART * radius_mm).max((size.x * size.y * size.z / (count * MOST_POINTS)).cbrt());
    let n = [0, 1, 2].map(|k| (size[k] / step).ceil().max(1.0) as usize);
    let in_wedge = |p: &Point3| {
        places.is_none_or(|places| places.angle_rad(p).rem_euclid(TAU) < TAU / places.count as f64)
    };
    let points = (0..n[2])
        .into_par_iter()
        .flat_map_iter(|k| {
            (0..n[0] * n[1]).filter_map(move |ij| {
                let at = [ij % n[0], ij / n[0], k];
                let p = Point3::from([0, 1, 2].map(|a| b.min[a] + step * (at[a] as f64 + 0.5)));
                (in_wedge(&p) && material.is(&p)).then_some(p)
            })
        })
        .collect();
    (points, step * step * step)
}

fn count(bits: &[u64]) -> u32 {
    bits.iter().map(|b| b.count_ones()).sum()
}

fn common(a: &[u64], b: &[u64]) -> Vec<u64> {
    a.iter().zip(b).map(|(a, b)| a & b).collect()
}

impl Views {
    /// What all candidates of a search reach.
    pub fn of(
        known: &Known<'_>,
        material: &Material<'_>,
        search: &Search<'_>,
        places: Option<&Places>,
    ) -> Self {
        let radius = known.rougher.bare.radius_mm;
        let (points, each_mm3) = lattice(material, places, radius);
        let candidates: Vec<Unit3> = match places {
            // Of images of each other one will do: that in the first wedge.
            Some(p) => {
                let angle = |a: &Unit3| p.angle_rad(&(p.axis.origin + a.into_inner())).rem_euclid(TAU);
                let is_first = |a: &&Unit3| p.of_axis(a).is_none() || angle(a) < TAU / p.count as f64;
                search.candidates.iter().filter(is_first).copied().collect()
            }
            None => search.candidates.to_vec(),
        };
        let cell = CELL * radius;
        let part = thinned(&known.points, cell);
        let back: Vec<_> = places.map_or_else(
            || vec![nalgebra::Isometry3::identity()],
            |p| p.turns().iter().map(nalgebra::Isometry3::inverse).collect(),
        );
        let seen: Vec<(Vec<u64>, f64)> = candidates
            .par_iter()
            .map(|axis| {
                let (frame, area, cell) =
                    view(material, (*axis, &known.task.rows.given()), &known.rougher, CELL);
                let relief = Relief::of(&part, (frame, material.bounds()), &known.rougher, (area, cell));
                let mut bits = vec![0u64; points.len().div_ceil(WORD)];
                let is_once = places.is_some_and(|p| p.of_axis(axis).is_none());
                let (mut taken, mut gone_over) = (0u32, 0u32);
                for (k, p) in points.iter().enumerate() {
                    let times = back.iter().filter(|turn| relief.takes(&(**turn * p))).count() as u32;
                    if times > 0 {
                        bits[k / WORD] |= 1 << (k % WORD);
                        taken += 1;
                        gone_over += if is_once { 1 } else { times };
                    }
                }
                (bits, f64::from(gone_over.max(1)) / f64::from(taken.max(1)))
            })
            .collect();
        let (takes, often): (Vec<Vec<u64>>, Vec<f64>) = seen.into_iter().unzip();
        let mut any = vec![0u64; points.len().div_ceil(WORD)];
        for bits in &takes {
            any.iter_mut().zip(bits).for_each(|(a, b)| *a |= b);
        }
        Self { candidates, points, takes, often, any, each_mm3 }
    }

    /// What all candidates together take, mm3.
    pub fn all_mm3(&self) -> f64 {
        f64::from(count(&self.any)) * self.each_mm3
    }

    /// Which points are material yet.
    pub fn left(&self, material: &Material<'_>) -> Vec<u64> {
        let is: Vec<bool> = self.points.par_iter().map(|p| material.is(p)).collect();
        let mut out = vec![0u64; self.any.len()];
        for (k, _) in is.iter().enumerate().filter(|(_, is)| **is) {
            out[k / WORD] |= 1 << (k % WORD);
        }
        common(&out, &self.any)
    }

    /// The candidates that take most of what is left, the best first, with the volume that they take, mm3.
    pub fn best(&self, left: &[u64], known: &Known<'_>) -> Vec<(Unit3, f64)> {
        let gains: Vec<u32> = self.takes.par_iter().map(|t| count(&common(t, left))).collect();
        let most = f64::from(gains.iter().copied().max().unwrap_or(0));
        if most == 0.0 {
            return Vec::new();
        }
        let near = |k: &usize| f64::from(gains[*k]) >= NEARLY * most;
        let mut found: Vec<(f64, usize)> = (0..gains.len())
            .filter(near)
            .map(|k| (f64::from(gains[k]) / (self.often[k] * self.way(k, left, known) as f64), k))
            .collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|(_, k)| (self.candidates[k], f64::from(gains[k]) * self.each_mm3)).collect()
    }

    /// How many cells of its layers a candidate has to go over.
    fn way(&self, k: usize, left: &[u64], known: &Known<'_>) -> usize {
        let frame = super::super::frame::Frame::new(self.candidates[k], &known.task.rows.given());
        let (apart, deep) = (self.each_mm3.cbrt(), known.task.sizes.stepdown_mm);
        let mut cells: BTreeSet<[i64; 3]> = BTreeSet::new();
        let bits = common(&self.takes[k], left);
        for (_, p) in self.points.iter().enumerate().filter(|(n, _)| bits[n / WORD] >> (n % WORD) & 1 == 1) {
            let [x, y, z] = frame.of(p);
            cells.insert([x / apart, y / apart, z / deep].map(|c| c.floor() as i64));
        }
        cells.len().max(1)
    }
}
