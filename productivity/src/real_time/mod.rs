//! Productivity of a path in the time that it really takes: at every instant, region by region, and of the whole.
//!
//! A path is a row of motions, each with its time as the control runs it: accelerations and joints at their greatest speed
//! included. Every place of the faces is finished by one motion, the one that left it as low as it is; with dF the area that is
//! finished in dt
//!
//! ```text
//! E_F(t) = dF / dt,   int E_F dt = F        [R97, eqs. 31, 32; of a volume V of stock eqs. 11, 12]
//! ```
//!
//! so that each place counts once. The strip width times the speed, [R97, eq. 2], counts what neighbouring strips share as often
//! as it is passed: its integral is larger by their overlap. The three levels of R97 are here: [`Stretch`] at an instant,
//! [`Region`] over the cells of a face, and area over the whole time.
//!
//! Limits: places come from samples of the faces, so that an instant is a [`Stretch`] of motions long enough for several of them.
//! A region is a cell of the face and not a pass, as R97 has it (definition 2): of passes see [`levels`](crate::levels).

mod region;

pub use region::{Cells, Region};

use osculate_geom::Uv;
use std::ops::Range;

/// A motion with its time as the control runs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedMotion {
    /// Its time, min.
    pub time_min: f64,
    /// The way of the tool's tip, mm.
    pub length_mm: f64,
    /// Whether it cuts; what rapids come to does not count.
    pub feed: bool,
}

/// A place of a face with the motion that finished it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishedPlace {
    /// The face, by its number.
    pub face: u32,
    /// Its parameters there.
    pub at: Uv,
    /// The area that it stands for, mm2.
    pub area_mm2: f64,
    /// Index of the motion that left it as low as it is; none where nothing cut.
    pub by: Option<u32>,
}

/// How fine instants are told apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// A stretch comes to this much at least, mm2 or mm3: to many places, so that their number says how much it is.
    pub amount: f64,
    /// And is this long at least, mm: places lie in rows, and one row more or less must not matter.
    pub length_mm: f64,
    /// Motions that come to nothing along this way, mm, are no part of a stretch: they run beside the faces, or over what is finished.
    pub idle_mm: f64,
}

impl Fineness {
    /// For places that lie about so far apart, mm: 64 places, 16 rows of them, and at most four rows without any.
    ///
    /// A stretch of sixteen rows is known to a sixteenth where rows lie across the feed. Half as many make an eighth of it, and steps of
    /// the speed are seen twice as fine.
    ///
    /// ```
    /// use osculate_productivity::real_time::Fineness;
    ///
    /// let fineness = Fineness::of_places(0.5);
    /// assert_eq!((fineness.amount, fineness.length_mm, fineness.idle_mm), (16.0, 8.0, 2.0));
    /// ```
    #[must_use]
    pub fn of_places(spacing_mm: f64) -> Self {
        Self {
            amount: 64.0 * spacing_mm * spacing_mm,
            length_mm: 16.0 * spacing_mm,
            idle_mm: 4.0 * spacing_mm,
        }
    }
}

/// Neighbouring motions and what they come to: an instant of the path.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Stretch {
    /// Its motions.
    pub motions: Range<usize>,
    /// Their time, min.
    pub time_min: f64,
    /// The way of the tip, mm.
    pub length_mm: f64,
    /// Area, mm2, or volume, mm3.
    pub amount: f64,
}

impl Stretch {
    const fn at(first: usize) -> Self {
        Self { motions: first..first, time_min: 0.0, length_mm: 0.0, amount: 0.0 }
    }

    /// Productivity, mm2/min or mm3/min; infinite where the control takes no time.
    #[must_use]
    pub fn per_min(&self) -> f64 {
        self.amount / self.time_min
    }

    /// Speed of the tip, mm/min.
    #[must_use]
    pub fn speed_mm_min(&self) -> f64 {
        self.length_mm / self.time_min
    }
}

/// Why there is no productivity.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RealTimeError {
    /// Time, length or amount of a motion is negative or not finite.
    #[error("motion {motion}: {what} is {got}")]
    Motion {
        /// Which.
        motion: usize,
        /// What of it.
        what: &'static str,
        /// Its value.
        got: f64,
    },
    /// A place names a motion that is none of the path.
    #[error("place {place} is finished by motion {motion} of {motions}")]
    NoMotion {
        /// Which place.
        place: usize,
        /// The motion that it names.
        motion: u32,
        /// How many there are.
        motions: usize,
    },
    /// Amounts of another number of motions.
    #[error("amounts of {amounts} motions, times of {motions}")]
    Count {
        /// Amounts.
        amounts: usize,
        /// Motions.
        motions: usize,
    },
}

/// The stretches of a path that come to something, in their order: `amounts` is what each motion comes to, mm2 or mm3.
///
/// Motions that come to nothing are part of the stretch around them, so that a path of short blocks has no gaps, unless they
/// are longer than [`Fineness::idle_mm`]; a rapid always ends one. What is left over of a run is part of its last stretch.
///
/// ```
/// use osculate_productivity::real_time::{Fineness, TimedMotion, stretches};
///
/// // Ten blocks of 1 mm, each with a strip of 0.5 mm: the last five at half the speed.
/// let block = |time_min| TimedMotion { time_min, length_mm: 1.0, feed: true };
/// let path: Vec<_> = (0..10).map(|k| block(if k < 5 { 0.001 } else { 0.002 })).collect();
/// let fineness = Fineness { amount: 2.5, length_mm: 5.0, idle_mm: 1.0 };
/// let found = stretches(&path, &[0.5; 10], fineness)?;
/// assert_eq!(found.len(), 2);
/// assert!((found[0].per_min() - 500.0).abs() < 1e-9 && (found[1].per_min() - 250.0).abs() < 1e-9);
/// # Ok::<(), osculate_productivity::real_time::RealTimeError>(())
/// ```
///
/// # Errors
/// [`RealTimeError`].
pub fn stretches(
    motions: &[TimedMotion],
    amounts: &[f64],
    fineness: Fineness,
) -> Result<Vec<Stretch>, RealTimeError> {
    if motions.len() != amounts.len() {
        return Err(RealTimeError::Count { amounts: amounts.len(), motions: motions.len() });
    }
    let mut out: Vec<Stretch> = Vec::new();
    let mut run = Run::default();
    for (motion, (m, &amount)) in motions.iter().zip(amounts).enumerate() {
        for (what, got) in [("time_min", m.time_min), ("length_mm", m.length_mm), ("amount", amount)] {
            if !(got >= 0.0 && got.is_finite()) {
                return Err(RealTimeError::Motion { motion, what, got });
            }
        }
        if !m.feed {
            run.end(&mut out);
            continue;
        }
        if amount == 0.0 {
            run.idle = run.idle.with(m);
            if run.idle.length_mm > fineness.idle_mm {
                run.end(&mut out);
            }
            continue;
        }
        let mut idle = std::mem::take(&mut run.idle);
        if run.open.is_none() && run.last.is_none() {
            // What came to nothing before the first of a run is beside the faces.
            idle = Idle::default();
        }
        let stretch = run.open.get_or_insert_with(|| Stretch::at(motion - idle.count));
        stretch.motions.end = motion + 1;
        stretch.time_min += idle.time_min + m.time_min;
        stretch.length_mm += idle.length_mm + m.length_mm;
        stretch.amount += amount;
        if stretch.amount >= fineness.amount
            && stretch.length_mm >= fineness.length_mm
            && stretch.time_min > 0.0
        {
            run.last = Some(out.len());
            out.extend(run.open.take());
        }
    }
    run.end(&mut out);
    Ok(out)
}

/// Motions that came to nothing since the last that came to something.
#[derive(Clone, Copy, Default)]
struct Idle {
    count: usize,
    time_min: f64,
    length_mm: f64,
}

impl Idle {
    fn with(self, m: &TimedMotion) -> Self {
        Self {
            count: self.count + 1,
            time_min: self.time_min + m.time_min,
            length_mm: self.length_mm + m.length_mm,
        }
    }
}

/// Motions that follow each other with no longer way between them than is idle.
#[derive(Default)]
struct Run {
    /// Its last whole stretch.
    last: Option<usize>,
    /// The one that is not long enough yet.
    open: Option<Stretch>,
    idle: Idle,
}

impl Run {
    /// Ends the run: what is open is part of its last stretch, or one of its own.
    fn end(&mut self, out: &mut Vec<Stretch>) {
        let Self { last, open, .. } = std::mem::take(self);
        let Some(open) = open else { return };
        match last.and_then(|k| out.get_mut(k)) {
            Some(before) => {
                before.motions.end = open.motions.end;
                before.time_min += open.time_min;
                before.length_mm += open.length_mm;
                before.amount += open.amount;
            }
            None => out.push(open),
        }
    }
}

/// Least, median and greatest of the productivity of stretches, each counting by its time, with the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Spread {
    /// Least, per min.
    pub min: f64,
    /// Half of the time it is lower.
    pub median: f64,
    /// Greatest.
    pub max: f64,
    /// Amount over time of all of them.
    pub mean: f64,
}

impl Spread {
    /// Of stretches that take time; none where no stretch does.
    #[must_use]
    pub fn of<'a>(stretches: impl IntoIterator<Item = &'a Stretch>) -> Option<Self> {
        Self::weighted(stretches.into_iter().filter(|s| s.time_min > 0.0).map(|s| (s.per_min(), s.time_min)))
    }

    /// Of values with their weights, which are positive; none where there is none.
    #[must_use]
    pub fn weighted(values: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let mut all: Vec<(f64, f64)> = values.into_iter().filter(|(_, weight)| *weight > 0.0).collect();
        let (sum, whole) =
            all.iter().fold((0.0, 0.0), |(s, w), (value, weight)| (s + value * weight, w + weight));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut so_far = 0.0;
        let half = all.iter().find(|(_, weight)| {
            so_far += weight;
            so_far >= 0.5 * whole
        });
        let (first, last) = (all.first()?, all.last()?);
        Some(Self { min: first.0, median: half.unwrap_or(last).0, max: last.0, mean: sum / whole })
    }
}

/// What a path finishes of faces, in its time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Finishing {
    /// In the order of the path.
    pub stretches: Vec<Stretch>,
    /// Of each place the stretch that finished it.
    pub of_place: Vec<Option<u32>>,
    /// Area of all places, mm2.
    pub area_mm2: f64,
    /// Of it what feed motions finished: the integral of E_F over the time.
    pub finished_mm2: f64,
    /// Time of the stretches, min. The rest of the path's time finishes nothing: it is ways, run-outs and rapids.
    pub time_min: f64,
}

impl Finishing {
    /// Of places and the path that finished them.
    ///
    /// ```
    /// use osculate_geom::uv;
    /// use osculate_productivity::real_time::{FinishedPlace, Fineness, Finishing, Spread, TimedMotion};
    ///
    /// // Two passes over 10 x 2 mm in 0.01 min each, and a rapid between them.
    /// let pass = TimedMotion { time_min: 0.01, length_mm: 10.0, feed: true };
    /// let path = [pass, TimedMotion { time_min: 0.005, feed: false, ..pass }, pass];
    /// let place = |k: u32| FinishedPlace {
    ///     face: 0,
    ///     at: uv(f64::from(k % 10) + 0.5, f64::from(k / 10) + 0.5),
    ///     area_mm2: 1.0,
    ///     by: Some(if k < 10 { 0 } else { 2 }),
    /// };
    /// let places: Vec<_> = (0..20).map(place).collect();
    /// let fineness = Fineness { amount: 5.0, length_mm: 1.0, idle_mm: 1.0 };
    /// let found = Finishing::of(&places, &path, fineness)?;
    /// assert!((found.finished_mm2 - 20.0).abs() < 1e-12 && (found.time_min - 0.02).abs() < 1e-12);
    /// assert!(Spread::of(&found.stretches).is_some_and(|s| (s.mean - 1000.0).abs() < 1e-9));
    /// # Ok::<(), osculate_productivity::real_time::RealTimeError>(())
    /// ```
    ///
    /// # Errors
    /// [`RealTimeError`].
    pub fn of(
        places: &[FinishedPlace],
        motions: &[TimedMotion],
        fineness: Fineness,
    ) -> Result<Self, RealTimeError> {
        let mut amounts = vec![0.0; motions.len()];
        let mut area_mm2 = 0.0;
        for (place, p) in places.iter().enumerate() {
            area_mm2 += p.area_mm2;
            if let Some(motion) = p.by {
                let amount = amounts.get_mut(motion as usize);
                *amount.ok_or(RealTimeError::NoMotion { place, motion, motions: motions.len() })? +=
                    p.area_mm2;
            }
        }
        let stretches = stretches(motions, &amounts, fineness)?;
        // No stretch where a motion finishes nothing: of feed motions there is none in which places lie.
        let of_motion = |motion: u32| {
            let k = stretches.partition_point(|s| s.motions.end <= motion as usize);
            let found = stretches.get(k).filter(|s| s.motions.contains(&(motion as usize)));
            found.and_then(|_| u32::try_from(k).ok())
        };
        Ok(Self {
            of_place: places.iter().map(|p| p.by.and_then(of_motion)).collect(),
            area_mm2,
            finished_mm2: stretches.iter().fold(0.0, |sum, s| sum + s.amount),
            time_min: stretches.iter().fold(0.0, |sum, s| sum + s.time_min),
            stretches,
        })
    }

    /// The stretch that finished a place.
    #[must_use]
    pub fn stretch(&self, place: usize) -> Option<&Stretch> {
        self.of_place.get(place).copied().flatten().and_then(|k| self.stretches.get(k as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINE: Fineness = Fineness { amount: 2.0, length_mm: 2.0, idle_mm: 1.5 };

    fn feed(length_mm: f64) -> TimedMotion {
        TimedMotion { time_min: 0.001 * length_mm, length_mm, feed: true }
    }

    #[test]
    fn ways_beside_the_faces_are_no_part() {
        // Run-in, two motions of a pass with a gap of one between them, run-out, another pass, run-out.
        let path = [feed(5.0), feed(1.0), feed(1.0), feed(1.0), feed(4.0), feed(3.0), feed(1.0)];
        let found = stretches(&path, &[0.0, 1.0, 0.0, 1.0, 0.0, 3.0, 0.0], FINE).unwrap();
        let parts: Vec<_> = found.iter().map(|s| s.motions.clone()).collect();
        assert_eq!(parts, [1..4, 5..6]);
        assert!((found[0].time_min - 0.003).abs() < 1e-15 && (found[0].length_mm - 3.0).abs() < 1e-15);
        assert!((found[1].per_min() - 1000.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_left_over_belongs_to_the_last_and_gaps_to_the_next() {
        let path = [feed(2.0), feed(1.0), feed(2.0), feed(1.0)];
        let found = stretches(&path, &[2.0, 0.0, 2.0, 0.5], FINE).unwrap();
        let parts: Vec<_> = found.iter().map(|s| s.motions.clone()).collect();
        assert_eq!(parts, [0..1, 1..4]);
        assert_eq!((found[1].amount, found[1].length_mm), (2.5, 4.0));
        let time: f64 = found.iter().map(|s| s.time_min).sum();
        assert!((time - 0.006).abs() < 1e-15);
    }

    #[test]
    fn a_rapid_ends_a_stretch_and_finishes_nothing() {
        let rapid = TimedMotion { feed: false, ..feed(1.0) };
        let found = stretches(&[feed(1.0), rapid, feed(1.0)], &[0.5, 9.0, 0.5], FINE).unwrap();
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|s| s.amount == 0.5));
    }

    #[test]
    fn a_motion_without_time_waits_for_one_that_takes_some() {
        let still = TimedMotion { time_min: 0.0, ..feed(3.0) };
        let found = stretches(&[still, feed(3.0)], &[3.0, 3.0], FINE).unwrap();
        assert_eq!(found.len(), 1);
        assert!((found[0].per_min() - 2000.0).abs() < 1e-9);
    }

    #[test]
    fn nonsense_is_refused() {
        let bad = TimedMotion { time_min: f64::NAN, ..feed(1.0) };
        assert!(matches!(stretches(&[bad], &[1.0], FINE), Err(RealTimeError::Motion { motion: 0, .. })));
        assert!(matches!(stretches(&[], &[1.0], FINE), Err(RealTimeError::Count { .. })));
        let place = FinishedPlace { face: 0, at: osculate_geom::uv(0.0, 0.0), area_mm2: 1.0, by: Some(3) };
        assert!(matches!(
            Finishing::of(&[place], &[feed(1.0)], FINE),
            Err(RealTimeError::NoMotion { motion: 3, .. })
        ));
    }

    #[test]
    fn the_median_counts_by_time() {
        let stretch =
            |time_min: f64, amount: f64| Stretch { motions: 0..1, time_min, length_mm: 1.0, amount };
        let all = [stretch(1.0, 1.0), stretch(5.0, 50.0), stretch(1.0, 30.0)];
        let spread = Spread::of(&all).unwrap();
        assert_eq!((spread.min, spread.median, spread.max), (1.0, 10.0, 30.0));
        assert!((spread.mean - 81.0 / 7.0).abs() < 1e-12);
        assert!(Spread::of(&[]).is_none());
    }
}
