//! Ways through a part of a layer that are tried out: what they take and in what time, with everything as it was before.

use super::moves::Moves;

/// Columns are known to their nodes, so that this share of what may stand counts as high, and no more than the material is known to.
const HIGH: f64 = 0.5;

/// What a trial came to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tried {
    pub min: f64,
    pub taken_mm3: f64,
    /// Columns that stood high before it and do no more, ascending.
    pub cleared: Vec<usize>,
}

impl Tried {
    /// Whether it clears all that another one does.
    pub fn clears_all_of(&self, other: &Self) -> bool {
        other.cleared.iter().all(|k| self.cleared.binary_search(k).is_ok())
    }
}

impl Moves<'_> {
    /// Tries out moves on a layer down to a floor, and takes them back.
    pub fn tried(&mut self, floor: f64, moves: impl FnOnce(&mut Self)) -> Tried {
        let (taken_mm3, shut_mm3, here, passes) =
            (self.taken_mm3, self.shut_mm3, self.here, self.passes.len());
        let (count, cutting_mm, air_mm) =
            (self.linked.path.moves.len(), self.linked.cutting_length_mm, self.linked.air_length_mm);
        self.columns.try_out();
        self.been.try_out();
        moves(self);
        let rates = &self.manner.links.rates;
        let mut out = Tried {
            min: rates.moves_min(&self.linked.path.moves[count.saturating_sub(1)..]),
            taken_mm3: self.taken_mm3 - taken_mm3,
            cleared: Vec::new(),
        };
        let (least, high_mm) =
            (&self.site.least, (HIGH * self.manner.sizes.stands_mm).min(self.site.blur_mm));
        self.columns.restore(&mut |k, [before, after]| {
            let may = least[k].max(floor) + high_mm;
            if before > may && after <= may {
                out.cleared.push(k);
            }
        });
        self.been.restore();
        self.linked.path.moves.truncate(count);
        self.linked.pass_of_move.truncate(count);
        (self.linked.cutting_length_mm, self.linked.air_length_mm) = (cutting_mm, air_mm);
        self.passes.truncate(passes);
        (self.taken_mm3, self.shut_mm3, self.here) = (taken_mm3, shut_mm3, here);
        out
    }
}
