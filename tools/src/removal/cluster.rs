//! Samples grouped by place, each group in a box that also holds the material above its samples.

use super::target::Target;
use super::{JobError, Sample};
use osculate_geom::{Box3, Unit3, Vec3};

/// Samples in a group: fewer, and the search for motions dominates; more, and its box gets too large to
/// select well.
const GROUP: usize = 32;

/// A group of samples.
pub(super) struct Cluster {
    /// Indices into the samples.
    pub members: Vec<u32>,
    normal: Unit3,
}

/// Groups the samples by halving along the longest side of their box, ties by index.
pub(super) fn clusters(samples: &[Sample]) -> Result<Vec<Cluster>, JobError> {
    for (k, s) in samples.iter().enumerate() {
        if !s.point.iter().chain(s.normal.iter()).all(|x| x.is_finite()) {
            return Err(JobError::SampleNotFinite { sample: k, face: s.face });
        }
    }
    let count = u32::try_from(samples.len())
        .map_err(|_| JobError::TooMany { what: "samples", limit: u32::MAX as usize })?;
    let mut order: Vec<u32> = (0..count).collect();
    Ok(halve(samples, &mut order))
}

fn halve(samples: &[Sample], order: &mut [u32]) -> Vec<Cluster> {
    if order.is_empty() {
        return Vec::new();
    }
    if order.len() <= GROUP {
        return vec![Cluster::around(samples, order)];
    }
    let bounds = Box3::around(order.iter().map(|k| &samples[*k as usize].point));
    let axis = (bounds.max - bounds.min).imax();
    let middle = order.len() / 2;
    let key = |k: &u32| samples[*k as usize].point[axis];
    order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    let (low, high) = order.split_at_mut(middle);
    let (mut low, high) = rayon::join(|| halve(samples, low), || halve(samples, high));
    low.extend(high);
    low
}

impl Cluster {
    fn around(samples: &[Sample], order: &[u32]) -> Self {
        let mut members = order.to_vec();
        // The halving leaves a group in no particular order of its own.
        members.sort_unstable();
        let sum: Vec3 = members.iter().map(|k| samples[*k as usize].normal.into_inner()).sum();
        // Normals that cancel give a group no side: any direction does.
        let normal = Unit3::try_new(sum, 1e-3).unwrap_or_else(Vec3::z_axis);
        Self { members, normal }
    }

    /// The box of the group's material, `height` of it above each member.
    pub fn target(&self, samples: &[Sample], height: impl Fn(usize) -> f64 + Clone) -> Target {
        let ends = self.members.iter().enumerate().flat_map(move |(k, member)| {
            let s = &samples[*member as usize];
            [s.point, s.point + s.normal.into_inner() * height(k)]
        });
        Target::around(ends, &self.normal)
    }
}
