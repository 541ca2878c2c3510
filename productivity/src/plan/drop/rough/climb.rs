//! Lines taken apart so that the tool goes up walls and never dives into material: what leads down steeply is run the other way.

use super::layer::{Sheet, THIN};
use super::moves::{Moves, apart, between};

/// A stretch that leads down, or up, by less than this share of a step down is level.
const LEVEL: f64 = 0.05;

/// Which way a piece of a line leads through material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sense {
    /// Either way will do.
    Level,
    /// Down too steeply.
    Down,
    /// Up so steeply that it must not be run the other way.
    Up,
}

/// Pieces that lead one way, but for level ones between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Block {
    sense: Sense,
    first: usize,
    last: usize,
}

/// The blocks of a line that rise or fall by more than `least_mm` in all.
fn blocks(stations: &[[f64; 3]], senses: &[Sense], least_mm: f64) -> Vec<Block> {
    let mut out: Vec<(Block, f64)> = Vec::new();
    for (k, sense) in senses.iter().enumerate().filter(|(_, s)| **s != Sense::Level) {
        let rise = (stations[k + 1][2] - stations[k][2]).abs();
        match out.last_mut() {
            Some((block, sum)) if block.sense == *sense => {
                block.last = k;
                *sum += rise;
            }
            _ => out.push((Block { sense: *sense, first: k, last: k }, rise)),
        }
    }
    let mut merged: Vec<Block> = Vec::new();
    for (block, _) in out.into_iter().filter(|(_, sum)| *sum > least_mm) {
        match merged.last_mut() {
            Some(last) if last.sense == block.sense => last.last = block.last,
            _ => merged.push(block),
        }
    }
    merged
}

/// The stretches of a line, first and last station of each; one that leads down is run from its end. What is level between two goes with the
/// one on the side where the tool is not: `from_end` says that it is at the end.
fn stretches(count: usize, blocks: &[Block], from_end: bool) -> Vec<(Sense, [usize; 2])> {
    let mut out = Vec::with_capacity(blocks.len());
    let mut begin = 0;
    for (k, block) in blocks.iter().enumerate() {
        let end = match blocks.get(k + 1) {
            None => count - 1,
            // A floor between two walls is run away from the tool, and up the wall there.
            Some(next) if block.sense == Sense::Down && from_end => next.first,
            Some(_) => block.last + 1,
        };
        out.push((block.sense, [begin, end]));
        begin = end;
    }
    out
}

impl Moves<'_> {
    /// Whether a piece of a way leads down into material more steeply than the tool may.
    pub(super) fn dives(&self, sheet: &Sheet, [a, b]: [[f64; 3]; 2]) -> bool {
        let (across, drop) = ((b[0] - a[0]).hypot(b[1] - a[1]), a[2] - b[2]);
        if self.manner.plunges || drop <= across * self.manner.sizes.ramp_rad.tan() {
            return false;
        }
        let thin = THIN * (sheet.layer.ceiling - sheet.layer.floor);
        let steps = (apart(a, b) / self.site.grid.cell).ceil().max(1.0) as usize;
        drop > thin
            && (1..=steps).any(|s| {
                let p = between(a, b, s as f64 / steps as f64);
                self.stands_at([p[0], p[1]]) > p[2] + thin
            })
    }

    /// A line as stretches that may be run one after the other.
    pub(super) fn climbing(&self, sheet: &Sheet, stations: Vec<[f64; 3]>) -> Vec<Vec<[f64; 3]>> {
        let sense = |w: &[[f64; 3]]| match () {
            () if self.dives(sheet, [w[0], w[1]]) => Sense::Down,
            () if self.dives(sheet, [w[1], w[0]]) => Sense::Up,
            () => Sense::Level,
        };
        let senses: Vec<Sense> = stations.windows(2).map(sense).collect();
        let least = LEVEL * self.manner.sizes.stepdown_mm;
        let found = blocks(&stations, &senses, least);
        if found.iter().all(|b| b.sense != Sense::Down) {
            return vec![stations];
        }
        let away = |p: [f64; 3]| self.here().map_or(0.0, |h| (p[0] - h[0]).hypot(p[1] - h[1]));
        let from_end = away(stations[0]) > away(stations[stations.len() - 1]);
        let mut out: Vec<(Sense, Vec<[f64; 3]>)> = stretches(stations.len(), &found, from_end)
            .into_iter()
            .map(|(sense, [a, b])| (sense, stations[a..=b].to_vec()))
            .collect();
        for (sense, stretch) in &mut out {
            if *sense == Sense::Down {
                stretch.reverse();
            }
        }
        if from_end {
            out.reverse();
        }
        // The wall next to the tool comes before the floor and the other wall, where the tool gets to its foot from what is cleared; else
        // the floor leads there.
        let mut k = 0;
        while k + 1 < out.len() {
            let next = if from_end { Sense::Up } else { Sense::Down };
            let is_led = out[k].0 == next && out[k + 1].0 != next;
            if is_led && !out[k].1.first().is_some_and(|foot| self.gets_to(sheet, *foot)) {
                out.swap(k, k + 1);
                k += 1;
            }
            k += 1;
        }
        out.into_iter().map(|(_, stretch)| stretch).filter(|s| s.len() > 1).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Down a wall, over a floor and up another: the floor goes with the wall that is farther from the tool.
    #[test]
    fn a_floor_goes_with_one_of_its_walls() {
        let heights = [5.0, 5.0, 3.0, 1.0, 1.0, 1.0, 3.0, 5.0];
        let stations: Vec<[f64; 3]> = (0u32..).zip(heights).map(|(k, z)| [f64::from(k), 0.0, z]).collect();
        let senses: Vec<Sense> = heights
            .windows(2)
            .map(|w| match w[1] - w[0] {
                d if d < 0.0 => Sense::Down,
                d if d > 0.0 => Sense::Up,
                _ => Sense::Level,
            })
            .collect();
        let found = blocks(&stations, &senses, 0.5);
        assert_eq!(found.iter().map(|b| (b.first, b.last)).collect::<Vec<_>>(), [(1, 2), (5, 6)]);
        assert_eq!(stretches(8, &found, false), [(Sense::Down, [0, 3]), (Sense::Up, [3, 7])]);
        assert_eq!(stretches(8, &found, true), [(Sense::Down, [0, 5]), (Sense::Up, [5, 7])]);
        // What falls by less than is asked for is level.
        assert_eq!(blocks(&stations, &senses, 4.5), []);
    }
}
