//! Sets of directions as bits, 64 to a word.

/// A set of indices below a fixed number, as a rule directions of a [`super::Directions`].
///
/// ```
/// use osculate_tools::reach::Bits;
/// // What the machine allows and what the part allows, together.
/// let (machine, part) = (Bits::of(10, |k| k < 6), Bits::of(10, |k| k % 2 == 1));
/// let both = machine.and(&part);
/// assert_eq!(both.iter().collect::<Vec<_>>(), [1, 3, 5]);
/// assert!(both.count() == 3 && both.contains(5) && !both.contains(7) && !both.contains(99));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bits {
    words: Vec<u64>,
    len: usize,
}

impl Bits {
    /// The empty set over `len` indices.
    #[must_use]
    pub fn none(len: usize) -> Self {
        Self { words: vec![0; len.div_ceil(64)], len }
    }

    /// The set of those indices below `len` for which `is_in` holds.
    #[must_use]
    pub fn of(len: usize, is_in: impl Fn(usize) -> bool) -> Self {
        let mut bits = Self::none(len);
        (0..len).filter(|&k| is_in(k)).for_each(|k| bits.set(k));
        bits
    }

    /// How many indices there are, in the set or not.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether nothing is in the set.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&w| w == 0)
    }

    /// Whether an index is in the set; one that is too large is not.
    #[must_use]
    pub fn contains(&self, k: usize) -> bool {
        self.words.get(k / 64).is_some_and(|w| w >> (k % 64) & 1 == 1)
    }

    /// Puts an index into the set.
    ///
    /// # Panics
    /// For an index that is not below [`Bits::len`].
    pub fn set(&mut self, k: usize) {
        assert!(k < self.len, "index {k} of a set over {}", self.len);
        self.words[k / 64] |= 1 << (k % 64);
    }

    /// Takes an index out of the set; one that is too large is not in it.
    pub fn clear(&mut self, k: usize) {
        if let Some(word) = self.words.get_mut(k / 64) {
            *word &= !(1 << (k % 64));
        }
    }

    /// How many indices are in the set.
    #[must_use]
    pub fn count(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// The indices in the set, ascending.
    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.words.iter().enumerate().flat_map(|(i, &word)| {
            let rest = std::iter::successors(Some(word), |w| Some(w & w.wrapping_sub(1)));
            rest.take_while(|&w| w != 0).map(move |w| 64 * i + w.trailing_zeros() as usize)
        })
    }

    /// What is in both sets.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self::of(self.len.min(other.len), |k| self.contains(k) && other.contains(k))
    }
}
