//! Samples of many faces at once, each with as many as its share of their area.

use super::Named;
use osculate_geom::{Surface, quadrature};
use osculate_tools::removal::{Sampling, SamplingError, sample_surface};
use rayon::prelude::*;

/// Slivers on which no sample lies are sampled this many times as densely, so often.
const DENSER: f64 = 4.0;
const TRIES: u32 = 4;

/// How densely faces are sampled.
#[derive(Clone, Copy)]
pub(crate) struct Wanted {
    pub spacing_mm: f64,
    /// Most samples over all faces, and fewest of those that a face may have.
    pub most: f64,
    pub fewest: usize,
}

/// Samples of a face however narrow it is.
fn sampled(
    surface: &dyn Surface,
    face: u32,
    spacing_mm: f64,
    most: usize,
) -> Result<Sampling, SamplingError> {
    let mut found = sample_surface(surface, face, spacing_mm, most);
    for k in 1..TRIES {
        if !matches!(found, Err(SamplingError::Nothing { .. })) {
            break;
        }
        found = sample_surface(surface, face, spacing_mm / DENSER.powi(k as i32), most);
    }
    found
}

/// The samples of each face, which they name by its place among all.
///
/// # Errors
/// A face that cannot be sampled, by its name.
pub(crate) fn samples(
    faces: &[&Named<'_>],
    wanted: Wanted,
) -> Result<Vec<Sampling>, (String, SamplingError)> {
    let areas: Vec<f64> = faces.par_iter().map(|f| quadrature::coarse_area(f.surface)).collect();
    let all: f64 = areas.iter().sum();
    let one = |(k, (face, area)): (usize, (&&Named<'_>, &f64))| {
        // A share of what may be no number goes to the sampling, which says so.
        let share = if all > 0.0 { area / all } else { 1.0 };
        // No more than the most, far below what a whole number can hold.
        let most = ((wanted.most * share) as usize).max(wanted.fewest);
        sampled(face.surface, k as u32, wanted.spacing_mm, most).map_err(|e| (face.face.to_owned(), e))
    };
    faces.par_iter().zip(&areas).enumerate().map(one).collect()
}
