//! From standoffs to sums: what is left, where, and the worst of it.
//!
//! A machined sample (not `check_only`) is *uncut* where nothing touched it or where more than `uncut_mm`
//! stands: a place that was missed, not a cusp between passes. All other machined samples make the scallop
//! statistics, area-weighted. A path is within tolerance when nothing is uncut, the highest scallop and the
//! deepest gouge (on checked faces too) keep their limits, and neither holder nor rapids took more than
//! `collision_mm`.

use super::density::{Density, Hidden};
use super::job::{Cut, Sample};
use osculate_geom::{Box3, Point3, Uv};

/// What is acceptable, all mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Greatest height of scallops.
    pub scallop_mm: f64,
    /// Greatest depth of gouges.
    pub gouge_mm: f64,
    /// Height above which material counts as not machined rather than as a scallop; at least `scallop_mm`.
    pub uncut_mm: f64,
    /// Most that the holder or a rapid may take away, for touches that are only rounding.
    pub collision_mm: f64,
    /// Most places listed of each kind.
    pub worst: usize,
}

impl Limits {
    /// Limits for a scallop and a gouge tolerance: uncut above five times the scallop (a stepover more than
    /// doubled), collisions from the gouge tolerance on, ten places of each kind.
    ///
    /// ```
    /// use osculate_tools::removal::Limits;
    /// let limits = Limits::new(0.01, 0.005);
    /// assert_eq!((limits.scallop_mm, limits.gouge_mm, limits.collision_mm), (0.01, 0.005, 0.005));
    /// assert_eq!((limits.uncut_mm, limits.worst), (0.05, 10));
    /// ```
    #[must_use]
    pub const fn new(scallop_mm: f64, gouge_mm: f64) -> Self {
        Self { scallop_mm, gouge_mm, uncut_mm: 5.0 * scallop_mm, collision_mm: gouge_mm, worst: 10 }
    }
}

/// The kind of a place in [`Tally::worst`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Material standing between passes.
    Scallop,
    /// Material taken from the part.
    Gouge,
    /// Material not machined.
    Uncut,
    /// Material taken by the holder.
    Holder,
    /// Material taken in a rapid.
    Rapid,
}

/// A place that stands out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Worst {
    /// Of which kind.
    pub kind: Kind,
    /// Height, depth or height taken, mm, positive.
    pub value_mm: f64,
    /// Where, mm.
    pub at: Point3,
    /// On which face.
    pub face: u32,
    /// Surface parameters.
    pub uv: Uv,
    /// The block that did it; None where nothing did (uncut).
    pub block: Option<u32>,
    /// The motion, by its index.
    pub motion: Option<u32>,
}

/// A bin of the histogram of standoffs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bin {
    /// Lower end, mm; the first bin begins at minus infinity.
    pub from_mm: f64,
    /// Upper end, mm, not included; the last bin ends at infinity.
    pub to_mm: f64,
    /// Area of the machined samples in it, mm2.
    pub area_mm2: f64,
}

/// What a path left at all samples.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Tally {
    /// Whether all limits are kept.
    pub within: bool,
    /// Samples judged.
    pub samples: usize,
    /// Highest scallop, mm.
    pub scallop_max_mm: f64,
    /// Height that 99 percent of the area which is not uncut stays below, mm.
    pub scallop_p99_mm: f64,
    /// Median standoff of that area, mm; negative where most of it is cut below the part.
    pub median_mm: f64,
    /// Deepest gouge, mm.
    pub gouge_max_mm: f64,
    /// Area gouged deeper than the limit, mm2.
    pub gouge_area_mm2: f64,
    /// Area left unmachined, mm2.
    pub uncut_area_mm2: f64,
    /// Samples left unmachined.
    pub uncut_samples: usize,
    /// The most that a rapid took, mm.
    pub rapid_max_mm: f64,
    /// The most that the holder took, mm.
    pub holder_max_mm: f64,
    /// What may hide between the samples, mm.
    pub hidden: Hidden,
    /// The most notable places of each kind, worst first, no two of a kind nearer than a fiftieth of the
    /// part.
    pub worst: Vec<Worst>,
    /// Area by standoff: forty equal bins from twice the gouge limit (a quarter of the scallop's at least)
    /// below the part to twice the scallop limit above it, and one beyond each end.
    pub histogram: Vec<Bin>,
}

/// Input that cannot be judged.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TallyError {
    /// Not one result for each sample.
    #[error("{samples} samples but {cuts} results: tally what cut() returned for the same samples")]
    Count {
        /// Samples.
        samples: usize,
        /// Results.
        cuts: usize,
    },
    /// Limits that contradict themselves.
    #[error(
        "limits must be finite with scallop_mm > 0, gouge_mm >= 0, collision_mm >= 0 and uncut_mm >= \
         scallop_mm, got scallop_mm = {}, gouge_mm = {}, collision_mm = {}, uncut_mm = {}",
        .0.scallop_mm, .0.gouge_mm, .0.collision_mm, .0.uncut_mm
    )]
    Limits(Limits),
    /// A sample whose area is negative or not a number.
    #[error("sample {sample} stands for an area of {area_mm2} mm2")]
    Area {
        /// Index of the sample.
        sample: usize,
        /// Its area, mm2.
        area_mm2: f64,
    },
}

impl Limits {
    fn valid(&self) -> bool {
        let all = [self.scallop_mm, self.gouge_mm, self.uncut_mm, self.collision_mm];
        all.iter().all(|x| x.is_finite() && *x >= 0.0)
            && self.scallop_mm > 0.0
            && self.uncut_mm >= self.scallop_mm
    }
}

/// Judges the result of [`cut`](super::cut) for the same samples; the samples' density and the tool's
/// effective radius bound what they may have missed, see [`Density::bound`].
///
/// # Errors
/// [`TallyError`].
pub fn tally(
    samples: &[Sample],
    cuts: &[Cut],
    limits: &Limits,
    density: &Density,
    tool_radius_mm: f64,
) -> Result<Tally, TallyError> {
    if samples.len() != cuts.len() {
        return Err(TallyError::Count { samples: samples.len(), cuts: cuts.len() });
    }
    if !limits.valid() {
        return Err(TallyError::Limits(*limits));
    }
    for (k, s) in samples.iter().enumerate() {
        if !(s.area_mm2 >= 0.0 && s.area_mm2.is_finite()) {
            return Err(TallyError::Area { sample: k, area_mm2: s.area_mm2 });
        }
    }
    let mut places = Places { samples, of: Default::default() };
    let mut left: Vec<(f64, f64)> = Vec::new();
    let mut v = Tally {
        within: false,
        samples: samples.len(),
        scallop_max_mm: 0.0,
        scallop_p99_mm: 0.0,
        median_mm: 0.0,
        gouge_max_mm: 0.0,
        gouge_area_mm2: 0.0,
        uncut_area_mm2: 0.0,
        uncut_samples: 0,
        rapid_max_mm: 0.0,
        holder_max_mm: 0.0,
        hidden: Hidden { scallop_mm: 0.0, gouge_mm: 0.0 },
        worst: Vec::new(),
        histogram: bins(limits),
    };
    for (k, (sample, cut)) in samples.iter().zip(cuts).enumerate() {
        let (height, area) = (cut.standoff_mm, sample.area_mm2);
        let by = cut.by.map(|by| Maker { motion: by.motion, block: by.block });
        if height < 0.0 {
            v.gouge_max_mm = v.gouge_max_mm.max(-height);
            if -height > limits.gouge_mm {
                v.gouge_area_mm2 += area;
            }
            places.see(Kind::Gouge, -height, k, by);
        }
        for (kind, touch, max) in
            [(Kind::Holder, cut.holder, &mut v.holder_max_mm), (Kind::Rapid, cut.rapid, &mut v.rapid_max_mm)]
        {
            if let Some(touch) = touch {
                *max = max.max(touch.removed_mm);
                if touch.removed_mm > limits.collision_mm {
                    let by = Maker { motion: touch.motion, block: touch.block };
                    places.see(kind, touch.removed_mm, k, Some(by));
                }
            }
        }
        if sample.check_only {
            continue;
        }
        // The last bin ends at infinity.
        if let Some(bin) = v.histogram.iter_mut().find(|b| height < b.to_mm) {
            bin.area_mm2 += area;
        }
        if cut.by.is_none() || height > limits.uncut_mm {
            v.uncut_area_mm2 += area;
            v.uncut_samples += 1;
            places.see(Kind::Uncut, height, k, by);
        } else {
            v.scallop_max_mm = v.scallop_max_mm.max(height);
            left.push((height, area));
            if height > 0.0 {
                places.see(Kind::Scallop, height, k, by);
            }
        }
    }
    left.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    v.scallop_p99_mm = quantile(&left, 0.99).max(0.0);
    v.median_mm = quantile(&left, 0.5);
    v.hidden = density.bound(tool_radius_mm, v.scallop_max_mm);
    v.worst = places.worst(limits.worst);
    v.within = v.uncut_samples == 0
        && v.scallop_max_mm <= limits.scallop_mm
        && v.gouge_max_mm <= limits.gouge_mm
        && v.rapid_max_mm <= limits.collision_mm
        && v.holder_max_mm <= limits.collision_mm;
    Ok(v)
}

/// The least height that `share` of the area does not exceed, heights ascending; 0 where there is nothing.
fn quantile(ascending: &[(f64, f64)], share: f64) -> f64 {
    let wanted = share * ascending.iter().map(|x| x.1).sum::<f64>();
    let mut area = 0.0;
    for (height, own) in ascending {
        area += own;
        if area >= wanted {
            return *height;
        }
    }
    // Only rounding of the sum leads here.
    ascending.last().map_or(0.0, |x| x.0)
}

fn bins(limits: &Limits) -> Vec<Bin> {
    const BINS: usize = 40;
    let (lo, hi) = (-2.0 * limits.gouge_mm.max(0.25 * limits.scallop_mm), 2.0 * limits.scallop_mm);
    let edge = |k: usize| lo + (hi - lo) * k as f64 / BINS as f64;
    let mut bins = vec![Bin { from_mm: f64::NEG_INFINITY, to_mm: lo, area_mm2: 0.0 }];
    bins.extend((0..BINS).map(|k| Bin { from_mm: edge(k), to_mm: edge(k + 1), area_mm2: 0.0 }));
    bins.push(Bin { from_mm: edge(BINS), to_mm: f64::INFINITY, area_mm2: 0.0 });
    bins
}

const KINDS: [Kind; 5] = [Kind::Gouge, Kind::Holder, Kind::Rapid, Kind::Uncut, Kind::Scallop];

/// What did it.
#[derive(Clone, Copy)]
struct Maker {
    motion: u32,
    block: u32,
}

/// A place seen: value, sample, and what did it.
type Seen = (f64, usize, Option<Maker>);

/// What was seen, by kind.
struct Places<'a> {
    samples: &'a [Sample],
    of: [Vec<Seen>; KINDS.len()],
}

impl Places<'_> {
    fn see(&mut self, kind: Kind, value: f64, sample: usize, by: Option<Maker>) {
        let k = KINDS.iter().position(|x| *x == kind).expect("every kind is listed");
        self.of[k].push((value, sample, by));
    }

    fn worst(self, most: usize) -> Vec<Worst> {
        let apart = Box3::around(self.samples.iter().map(|s| &s.point)).diagonal_mm() / 50.0;
        let mut out = Vec::new();
        for (kind, mut seen) in KINDS.into_iter().zip(self.of) {
            let top = seen.iter().map(|x| x.0).fold(0.0, f64::max);
            // Places of less than half the worst are not notable.
            seen.retain(|x| x.0 >= 0.5 * top);
            seen.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let first = out.len();
            for (value_mm, sample, by) in seen {
                if out.len() - first >= most {
                    break;
                }
                let s = &self.samples[sample];
                if out[first..].iter().any(|w: &Worst| (w.at - s.point).norm() < apart) {
                    continue;
                }
                let (block, motion) = (by.map(|b| b.block), by.map(|b| b.motion));
                out.push(Worst { kind, value_mm, at: s.point, face: s.face, uv: s.uv, block, motion });
            }
        }
        out
    }
}
