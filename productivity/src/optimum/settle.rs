//! Settling a posture: searches along its coordinates, to the brink of jumps and of two contacts.

use super::search::{Found, GRID, Search};
use super::{Measured, Posture};
use std::f64::consts::TAU;
use std::ops::Range;

/// A neighbour this much lower lies beyond a jump: the strip has met a wave of the part.
const JUMP: f64 = 0.88;
const JUMPS: u32 = 2;
/// Leads tried above an impossible one in each round.
const BRINK: u32 = 7;
/// Steps shrink in each round.
const SHRINK: f64 = 0.35;
/// Steps of a last, exact round, of a step of the grid.
const POLISH: f64 = 0.1;

impl Search<'_> {
    /// Coordinate searches with shrinking steps, a parabola through three values in each.
    pub(super) fn settle(&mut self, from: Found, rounds: Range<i32>) -> Found {
        let mut best = from;
        let limits = self.limits;
        for round in rounds {
            let shrink = SHRINK.powi(round);
            let step = [
                0.5 * TAU / GRID[0] as f64,
                limits.lead.width() / (GRID[1] - 1) as f64,
                0.5 * limits.tilt.width() / (GRID[2] - 1) as f64,
            ]
            .map(|s| s * shrink);
            for (k, s) in step.iter().enumerate() {
                if *s > 0.0 {
                    best = self.along(best, k, *s);
                }
            }
            // Turning the feed under a tool that keeps its heading: the valley of the strip's width.
            if limits.tilt.width() > 0.0 {
                best = self.along(best, 3, step[0]);
            }
        }
        best
    }

    /// A round with small steps.
    pub(super) fn refine(&mut self, from: Found) -> Found {
        let limits = self.limits;
        let widths = [TAU / GRID[0] as f64, limits.lead.width() / GRID[1] as f64, limits.tilt.width()];
        let mut best = from;
        for (k, w) in widths.into_iter().enumerate().filter(|(_, w)| *w > 0.0) {
            best = self.along(best, k, POLISH * w);
        }
        best
    }

    fn moved(&self, p: &Posture, coordinate: usize, by: f64) -> Posture {
        let mut q = *p;
        match coordinate {
            0 => q.direction_rad += by,
            1 => q.lean.lead_rad = self.limits.lead.clamp(p.lean.lead_rad + by),
            2 => q.lean.tilt_rad = self.limits.tilt.clamp(p.lean.tilt_rad + by),
            _ => {
                q.lean.tilt_rad = self.limits.tilt.clamp(p.lean.tilt_rad - by);
                q.direction_rad += p.lean.tilt_rad - q.lean.tilt_rad;
            }
        }
        q
    }

    fn along(&mut self, from: Found, coordinate: usize, step: f64) -> Found {
        let value = |f: Option<Measured>| f.map_or(0.0, |m| m.rate.area_mm2_min);
        let better = |a: Found, p: Posture, m: Option<Measured>| match m {
            Some(m) if m.rate.area_mm2_min > a.1.rate.area_mm2_min => (p, m),
            _ => a,
        };
        let (pa, pb) = (self.moved(&from.0, coordinate, -step), self.moved(&from.0, coordinate, step));
        let (a, b) = (self.measure(pa), self.measure(pb));
        let mut best = better(better(from, pa, a), pb, b);
        if coordinate == 1 && a.is_none() {
            let brink = self.brink_above(pa, BRINK);
            best = brink.map_or(best, |(p, m)| better(best, p, Some(m)));
        }
        let (fa, f0, fb) = (value(a), from.1.rate.area_mm2_min, value(b));
        // The best lies at a jump's brink where the slope leads there.
        for (sign, beyond, other) in [(1.0, fb, fa), (-1.0, fa, fb)] {
            if beyond >= JUMP * f0 || other >= f0 {
                continue;
            }
            let (mut near, mut far) = (0.0, step);
            for _ in 0..JUMPS {
                let by = 0.5 * (near + far);
                let p = self.moved(&from.0, coordinate, sign * by);
                let m = self.measure(p);
                best = better(best, p, m);
                if value(m) < JUMP * f0 { far = by } else { near = by }
            }
        }
        let bend = fa - 2.0 * f0 + fb;
        let to = if bend < 0.0 { 0.5 * step * (fa - fb) / bend } else { 0.0 };
        if to != 0.0 && to.abs() < 2.0 * step {
            let p = self.moved(&from.0, coordinate, to);
            let m = self.measure(p);
            best = better(best, p, m);
        }
        best
    }
}
