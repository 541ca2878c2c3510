//! Stock as a file of its own: what is left, exactly as it is, for a later job to begin from.
//!
//! A line that says what it is, a line of what it is stock of, and numbers, least byte first: the box, the cell, and of every direction its
//! axis, the origin, sides and counts of its cells, and of every ray how many stretches it has and where they begin and end. The last
//! eight bytes are a sum over all before (FNV-1a, 64 bit), so that half a file is none.

use super::lattice::{Lattice, SIDE, TILE, Tile};
use super::{Field, Stock};
use osculate_geom::{Box3, Point3};

/// The first line.
const HEAD: &[u8] = b"osculate stock 1\n";
/// Longest second line, bytes.
const LONGEST: usize = 4096;
/// A count of stretches that does not fit a byte follows it in four.
const MORE: u8 = u8::MAX;
/// Most rays of a direction: far more than any memory is given for.
const MOST_RAYS: u64 = 1 << 32;

/// A file that is no stock.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SavedError {
    /// It begins with something else.
    #[error("it is no stock that was saved: it does not begin with \"osculate stock 1\"")]
    Head,
    /// It ends too early, or its bytes are not those that were written.
    #[error("it is damaged: {what}")]
    Damaged {
        /// How that is seen.
        what: &'static str,
    },
}

const fn damaged(what: &'static str) -> SavedError {
    SavedError::Damaged { what }
}

/// FNV-1a of bytes, 64 bit: the same on every machine.
#[must_use]
pub fn sum_of(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, b| (sum ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3))
}

/// Bytes that are read from the front.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], SavedError> {
        let (front, rest) = self.0.split_at_checked(count).ok_or(damaged("it ends too early"))?;
        self.0 = rest;
        Ok(front)
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], SavedError> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N)?);
        Ok(out)
    }

    fn number(&mut self) -> Result<f64, SavedError> {
        let x = f64::from_le_bytes(self.bytes()?);
        if x.is_finite() { Ok(x) } else { Err(damaged("a number is not finite")) }
    }

    fn point(&mut self) -> Result<Point3, SavedError> {
        Ok(Point3::new(self.number()?, self.number()?, self.number()?))
    }
}

impl Stock {
    /// The bytes of a file, with what it is stock of: one line, by which it is known again.
    ///
    /// ```
    /// use osculate_geom::{Box3, Point3};
    /// use osculate_tools::removal::stock::{Blank, Resolution, SavedError, Stock};
    /// let block = Blank::Box(Box3::around(&[Point3::origin(), Point3::new(30.0, 20.0, 10.0)]));
    /// let stock = Stock::fill(&block, &Resolution { cell_mm: 2.0, tri: false, budget_bytes: 1 << 24 })?.stock;
    /// let bytes = stock.saved("block 1");
    /// assert!(Stock::is_saved(&bytes));
    /// let (back, of) = Stock::read(&bytes)?;
    /// assert!(back.volume() == stock.volume() && of == "block 1");
    /// // Half a file is none.
    /// assert!(matches!(Stock::read(&bytes[..bytes.len() / 2]), Err(SavedError::Damaged { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn saved(&self, of: &str) -> Vec<u8> {
        let mut out = HEAD.to_vec();
        out.extend(of.lines().next().unwrap_or_default().bytes().take(LONGEST));
        out.push(b'\n');
        let number = |out: &mut Vec<u8>, x: f64| out.extend(x.to_le_bytes());
        for x in self.bounds.min.iter().chain(self.bounds.max.iter()).chain([&self.cell]) {
            number(&mut out, *x);
        }
        // Three directions at most.
        out.push(self.fields.len() as u8);
        for Field { lattice, tiles } in &self.fields {
            out.push(lattice.axis as u8);
            for x in lattice.origin.iter().chain(&lattice.cell) {
                number(&mut out, *x);
            }
            lattice.count.iter().for_each(|n| out.extend((*n as u64).to_le_bytes()));
            for tile in tiles {
                for ray in 0..TILE {
                    let spans = tile.of(ray);
                    match u8::try_from(spans.len()) {
                        Ok(few) if few < MORE => out.push(few),
                        // A ray has no more stretches than motions are numbered.
                        _ => {
                            out.push(MORE);
                            out.extend((spans.len() as u32).to_le_bytes());
                        }
                    }
                    spans.iter().flatten().for_each(|x| number(&mut out, *x));
                }
            }
        }
        let sum = sum_of(&out);
        out.extend(sum.to_le_bytes());
        out
    }

    /// Whether bytes begin as those of a saved stock do.
    #[must_use]
    pub fn is_saved(bytes: &[u8]) -> bool {
        bytes.starts_with(HEAD)
    }

    /// Stock that was saved, with what it is stock of.
    ///
    /// # Errors
    /// [`SavedError`].
    pub fn read(bytes: &[u8]) -> Result<(Self, String), SavedError> {
        let rest = bytes.strip_prefix(HEAD).ok_or(SavedError::Head)?;
        let (whole, sum) = bytes.split_last_chunk::<8>().ok_or(damaged("it ends too early"))?;
        if sum_of(whole) != u64::from_le_bytes(*sum) {
            return Err(damaged("its sum is not that of what was written"));
        }
        let line = rest
            .iter()
            .take(LONGEST + 1)
            .position(|b| *b == b'\n')
            .ok_or(damaged("it says not what it is of"))?;
        let of = String::from_utf8_lossy(&rest[..line]).into_owned();
        let mut from = Reader(&rest[line + 1..rest.len() - sum.len()]);
        let bounds = Box3 { min: from.point()?, max: from.point()? };
        let cell = from.number()?;
        let [count] = from.bytes()?;
        if !(cell > 0.0 && (bounds.max - bounds.min).min() > 0.0 && (1..=3).contains(&count)) {
            return Err(damaged("its box has no volume"));
        }
        let fields = (0..count).map(|_| field(&mut from)).collect::<Result<_, _>>()?;
        if from.0.is_empty() {
            Ok((Self { bounds, cell, fields }, of))
        } else {
            Err(damaged("it goes on after its end"))
        }
    }
}

/// The rays of one direction.
fn field(from: &mut Reader<'_>) -> Result<Field, SavedError> {
    let [axis] = from.bytes()?;
    let origin = from.point()?;
    let cell = [from.number()?, from.number()?];
    let count = [u64::from_le_bytes(from.bytes()?), u64::from_le_bytes(from.bytes()?)];
    let rays = count[0].checked_mul(count[1]).filter(|n| (1..=MOST_RAYS).contains(n));
    // Every ray takes a byte at least, those that fill the last tiles too.
    let tiles = count.map(|n| n.div_ceil(SIDE as u64)).iter().product::<u64>();
    let fits = tiles.checked_mul(TILE as u64).is_some_and(|n| n <= from.0.len() as u64);
    if axis > 2 || rays.is_none() || !fits || cell.iter().any(|c| *c <= 0.0) {
        return Err(damaged("a direction has no rays, or more than bytes"));
    }
    let lattice = Lattice { axis: usize::from(axis), origin, cell, count: count.map(|n| n as usize) };
    let tiles = (0..lattice.tiles()).map(|_| tile(from)).collect::<Result<_, _>>()?;
    Ok(Field { lattice, tiles })
}

fn tile(from: &mut Reader<'_>) -> Result<Tile, SavedError> {
    let mut rays: Vec<Vec<[f64; 2]>> = Vec::with_capacity(TILE);
    for _ in 0..TILE {
        let count = match from.bytes()? {
            [MORE] => u32::from_le_bytes(from.bytes()?) as usize,
            [few] => usize::from(few),
        };
        if count.saturating_mul(16) > from.0.len() {
            return Err(damaged("it ends too early"));
        }
        let mut spans: Vec<[f64; 2]> = Vec::with_capacity(count);
        for _ in 0..count {
            let span = [from.number()?, from.number()?];
            let after = spans.last().map_or(f64::NEG_INFINITY, |s| s[1]);
            if !(after <= span[0] && span[0] <= span[1]) {
                return Err(damaged("stretches of a ray are not in order"));
            }
            spans.push(span);
        }
        rays.push(spans);
    }
    Ok(Tile::pack(&rays))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::removal::stock::{Blank, Resolution, StockJob};
    use crate::removal::{Swept, stock::Made};
    use crate::{Cutter, CutterSpec, Pose};
    use osculate_geom::Vec3;

    fn carved() -> Stock {
        let bounds = Box3 { min: Point3::new(-5.0, -4.0, -3.0), max: Point3::new(5.0, 4.0, 2.0) };
        let resolution = Resolution { cell_mm: 0.3, tri: true, budget_bytes: 1 << 30 };
        let Made { mut stock, .. } = Stock::fill(&Blank::Box(bounds), &resolution).unwrap();
        let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 3.0, length_mm: 20.0 }).unwrap();
        let pose = |x: f64| Pose { tip: Point3::new(x, 0.4, -1.0), axis: Vec3::z_axis() };
        let motions = [Swept { from: pose(-7.0), to: pose(3.0), rapid: false, block: 1 }];
        let job = StockJob { cutter: &ball, uppers: &[], motions: &motions, touch_mm: 1e-3 };
        stock.carve(&job, &|_| ()).unwrap();
        stock
    }

    /// What comes back has the same bits, and a byte more, less or changed is seen.
    #[test]
    fn a_saved_stock_comes_back_and_a_damaged_one_does_not() {
        let stock = carved();
        let bytes = stock.saved("a part\nwith two lines");
        assert!(Stock::is_saved(&bytes));
        assert_eq!(Stock::read(&bytes), Ok((stock, "a part".to_owned())));
        assert_eq!(Stock::read(b"solid bar"), Err(SavedError::Head));
        for k in [20, 60, 70, 100, 500, bytes.len() / 2, bytes.len() - 4] {
            let mut changed = bytes.clone();
            changed[k] ^= 0x40;
            assert!(matches!(Stock::read(&changed), Err(SavedError::Damaged { .. })), "{k}");
            assert!(matches!(Stock::read(&bytes[..k]), Err(SavedError::Damaged { .. })), "{k}");
        }
        assert!(matches!(Stock::read(&[&bytes[..], &[0]].concat()), Err(SavedError::Damaged { .. })));
    }

    /// Bytes that lie about how much follows, with a sum that is right, take no memory.
    #[test]
    fn counts_that_cannot_be_are_refused() {
        let bytes = carved().saved("x");
        // Behind two lines, the box, the cell, the count of directions, and the axis, origin and cells of the first.
        let count = HEAD.len() + 2 + 7 * 8 + 1 + 1 + 5 * 8;
        let mut lie = bytes[..bytes.len() - 8].to_vec();
        lie[count..count + 8].copy_from_slice(&(1u64 << 40).to_le_bytes());
        let sum = sum_of(&lie);
        lie.extend(sum.to_le_bytes());
        assert!(matches!(Stock::read(&lie), Err(SavedError::Damaged { .. })));
    }
}
