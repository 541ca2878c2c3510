//! Files damaged at random, the same ones for the same seed.

/// Random numbers (SplitMix64).
pub struct Dice(u64);

impl Dice {
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// One of so many, from 0; of none the first.
    pub fn below(&mut self, many: usize) -> usize {
        (self.next() % many.max(1) as u64) as usize
    }
}

/// Words that numbers are replaced by.
const NUMBERS: [&str; 16] = [
    "0",
    "-0",
    "1",
    "-1",
    "1e308",
    "-1e308",
    "1e-308",
    "1e999",
    "99999999999999999999",
    "2147483648",
    "4294967295",
    "nan",
    "inf",
    ".",
    "-",
    "",
];
/// Kinds of damage.
const KINDS: usize = 9;
/// Damages to a file at most.
const MOST: usize = 4;

/// A file with one to four damages.
pub fn damaged(whole: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..=dice.below(MOST) {
        let (kind, at) = (dice.below(KINDS), dice.below(bytes.len()));
        match kind {
            0 => {
                for _ in 0..=dice.below(8) {
                    let at = dice.below(bytes.len());
                    if let Some(b) = bytes.get_mut(at) {
                        *b ^= 1 << dice.below(8);
                    }
                }
            }
            1 if dice.below(4) == 0 => bytes.truncate(at),
            1 | 2 => number(&mut bytes, at, dice),
            3 => number(&mut bytes, at, dice),
            4 | 5 => {
                // A line goes, or comes once more elsewhere.
                let line = line_at(&bytes, at);
                let copy = bytes[line.clone()].to_vec();
                if kind == 4 {
                    bytes.drain(line);
                } else {
                    let to = line_at(&bytes, dice.below(bytes.len())).start;
                    bytes.splice(to..to, copy);
                }
            }
            6 => {
                let noise: Vec<u8> = (0..=dice.below(6)).map(|_| dice.below(256) as u8).collect();
                bytes.splice(at..at, noise);
            }
            7 => {
                // A stretch goes.
                let end = (at + 1 + dice.below(64)).min(bytes.len());
                bytes.drain(at.min(end)..end);
            }
            _ => {
                // A stretch of elsewhere instead.
                let from = dice.below(bytes.len());
                let length = (1 + dice.below(64)).min(bytes.len() - from.max(at).min(bytes.len()));
                let copy = bytes[from..from + length].to_vec();
                bytes.splice(at..at + length, copy);
            }
        }
    }
    bytes
}

/// The line around a place, with its end.
fn line_at(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let at = at.min(bytes.len());
    let start = bytes[..at].iter().rposition(|b| *b == b'\n').map_or(0, |k| k + 1);
    let end = bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |k| at + k + 1);
    start..end
}

/// Replaces the number that stands at a place or after it.
fn number(bytes: &mut Vec<u8>, at: usize, dice: &mut Dice) {
    let is = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+');
    let Some(start) = bytes.iter().skip(at).position(u8::is_ascii_digit).map(|k| at + k) else { return };
    let end = bytes[start..].iter().position(|b| !is(b)).map_or(bytes.len(), |k| start + k);
    let word = NUMBERS[dice.below(NUMBERS.len())].bytes();
    bytes.splice(start..end, word);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_damages_alike_and_others_otherwise() {
        let whole: Vec<u8> = (0..60).flat_map(|k| format!("line {k} is 12.5 and 7\n").into_bytes()).collect();
        let all: Vec<Vec<u8>> = (0..300).map(|k| damaged(&whole, &mut Dice::new(k))).collect();
        for (k, bytes) in all.iter().enumerate() {
            assert_eq!(*bytes, damaged(&whole, &mut Dice::new(k as u64)));
        }
        let same = all.iter().filter(|b| **b == whole).count();
        assert!(same < 10, "{same}");
        // What is empty stays a file.
        for k in 0..300 {
            damaged(b"", &mut Dice::new(k));
            damaged(b"7", &mut Dice::new(k));
        }
    }
}
