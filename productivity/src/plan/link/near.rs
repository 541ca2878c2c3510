//! The ends of stretches by place: which of those that are left is reached soonest.

use osculate_geom::{Point3, Vec3};

/// Places in a balanced tree, of which each can be struck out.
pub(super) struct Places {
    /// In the order of the tree: the middle of a range parts it.
    order: Vec<u32>,
    at: Vec<Point3>,
    /// Around the places of each range, by its middle.
    boxes: Vec<[Point3; 2]>,
    /// Places left in each range, by its middle.
    left: Vec<u32>,
    /// Where each place stands in `order`.
    stands: Vec<u32>,
}

impl Places {
    pub fn new(places: &[Point3]) -> Self {
        let n = places.len();
        let mut out = Self {
            // Fewer than an index can hold: a plan has so many ends.
            order: (0..n as u32).collect(),
            at: places.to_vec(),
            boxes: vec![[Point3::origin(); 2]; n],
            left: vec![0; n],
            stands: vec![0; n],
        };
        out.part(0, n);
        for k in 0..n {
            out.stands[out.order[k] as usize] = k as u32;
        }
        out
    }

    fn part(&mut self, from: usize, to: usize) {
        if from >= to {
            return;
        }
        let at = &self.at;
        let own = &mut self.order[from..to];
        let first = at[own[0] as usize];
        let [lo, hi] = own.iter().fold([first, first], |[lo, hi], k| {
            let p = at[*k as usize];
            [lo.inf(&p), hi.sup(&p)]
        });
        let extent: Vec3 = hi - lo;
        let widest = extent.imax();
        let half = own.len() / 2;
        // Ties by number: the same tree whatever the order was.
        own.select_nth_unstable_by(half, |a, b| {
            at[*a as usize][widest].total_cmp(&at[*b as usize][widest]).then(a.cmp(b))
        });
        let middle = from + half;
        self.boxes[middle] = [lo, hi];
        self.left[middle] = (to - from) as u32;
        self.part(from, middle);
        self.part(middle + 1, to);
    }

    /// Strikes a place out; once.
    pub fn strike(&mut self, place: u32) {
        let target = self.stands[place as usize] as usize;
        let (mut from, mut to) = (0, self.order.len());
        while from < to {
            let middle = from + (to - from) / 2;
            self.left[middle] -= 1;
            match target.cmp(&middle) {
                std::cmp::Ordering::Less => to = middle,
                std::cmp::Ordering::Greater => from = middle + 1,
                std::cmp::Ordering::Equal => break,
            }
        }
        // Marked by standing nowhere.
        self.stands[place as usize] = u32::MAX;
    }

    fn is_left(&self, place: u32) -> bool {
        self.stands[place as usize] != u32::MAX
    }

    fn off(&self, middle: usize, from: &Point3) -> f64 {
        let [lo, hi] = &self.boxes[middle];
        let out = |k: usize| (lo[k] - from[k]).max(from[k] - hi[k]).max(0.0);
        Vec3::new(out(0), out(1), out(2)).norm()
    }

    /// The place of the least cost; of equal ones that of the least number. A place at a distance costs `least` of it or more, which
    /// does not fall.
    pub fn best(
        &self,
        from: &Point3,
        least: &impl Fn(f64) -> f64,
        cost: &mut impl FnMut(u32) -> f64,
    ) -> Option<(f64, u32)> {
        let mut best = None;
        self.search((0, self.order.len()), from, least, cost, &mut best);
        best
    }

    fn search(
        &self,
        (from, to): (usize, usize),
        at: &Point3,
        least: &impl Fn(f64) -> f64,
        cost: &mut impl FnMut(u32) -> f64,
        best: &mut Option<(f64, u32)>,
    ) {
        if from >= to {
            return;
        }
        let middle = from + (to - from) / 2;
        if self.left[middle] == 0 || best.is_some_and(|b| least(self.off(middle, at)) > b.0) {
            return;
        }
        let place = self.order[middle];
        if self.is_left(place) {
            let own = (cost(place), place);
            if best.is_none_or(|b| own.0 < b.0 || (own.0 == b.0 && own.1 < b.1)) {
                *best = Some(own);
            }
        }
        let (one, other) = ((from, middle), (middle + 1, to));
        let far = |(from, to): (usize, usize)| {
            if from < to { self.off(from + (to - from) / 2, at) } else { f64::INFINITY }
        };
        let (one, other) = if far(other) < far(one) { (other, one) } else { (one, other) };
        self.search(one, at, least, cost, best);
        self.search(other, at, least, cost, best);
    }

    /// The nearest places to a point, no more than `most`, the nearest first; those struck out as well.
    pub fn nearest(&self, from: &Point3, most: usize) -> Vec<u32> {
        let mut found: Vec<(f64, u32)> = Vec::with_capacity(most + 1);
        self.gather((0, self.order.len()), (from, most), &mut found);
        found.into_iter().map(|f| f.1).collect()
    }

    fn gather(&self, (from, to): (usize, usize), (at, most): (&Point3, usize), found: &mut Vec<(f64, u32)>) {
        if from >= to {
            return;
        }
        let middle = from + (to - from) / 2;
        if found.len() == most && found.last().is_some_and(|f| self.off(middle, at) > f.0) {
            return;
        }
        let place = self.order[middle];
        let own = ((self.at[place as usize] - at).norm(), place);
        let k = found.partition_point(|f| f.0 < own.0 || (f.0 == own.0 && f.1 < own.1));
        found.insert(k, own);
        found.truncate(most);
        let (one, other) = ((from, middle), (middle + 1, to));
        let far = |(from, to): (usize, usize)| {
            if from < to { self.off(from + (to - from) / 2, at) } else { f64::INFINITY }
        };
        let (one, other) = if far(other) < far(one) { (other, one) } else { (one, other) };
        self.gather(one, (at, most), found);
        self.gather(other, (at, most), found);
    }
}
