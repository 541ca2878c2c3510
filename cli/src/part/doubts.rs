//! What is doubtful about the faces of a part, before anybody works on them.

use crate::part::loaded::{Loaded, LoadedFace};
use crate::words::number;
use osculate_geom::{Box3, Diagnostic, Surface};
use osculate_surfaces::folds::folds;
use rayon::prelude::*;

/// Pieces in which normals turn round are a fold where they are no larger than this share of the part.
const FOLD_SHARE: f64 = 1e-5;
/// Places of a fold that a message lists at most.
const LISTED: usize = 3;

/// Warnings of faces that are not what a machinist takes them for.
#[must_use]
pub fn doubts(part: &Loaded) -> Vec<Diagnostic> {
    let mut out = unbalanced(part);
    out.extend(folded(part));
    out
}

/// A warning for every face that folds over itself.
#[must_use]
pub fn folded(part: &Loaded) -> Vec<Diagnostic> {
    let whole = part.faces.iter().fold(Box3::empty(), |all, f| all.union(&f.surface.bbox(1)));
    let within_mm = FOLD_SHARE * whole.diagonal_mm();
    let of = |f: &LoadedFace| {
        let nurbs = f.nurbs().filter(|_| within_mm > 0.0 && within_mm.is_finite())?;
        let found = folds(nurbs, within_mm, &|at| f.surface.contains(at)).found;
        let place = |p: &osculate_surfaces::folds::Fold| {
            format!("({})", p.point.iter().map(|x| number(*x, 6)).collect::<Vec<_>>().join(", "))
        };
        let places: Vec<String> = found.iter().take(LISTED).map(place).collect();
        let more = if found.len() > LISTED {
            format!(" and {} more places", found.len() - LISTED)
        } else {
            String::new()
        };
        let text = format!(
            "it folds over itself at {}{more}: its normals turn round there within {} mm, so that no depth of a gouge has a meaning and no \
             verdict on it can be *held*; have the face mended where it was made, or leave it out",
            places.join(", "),
            number(found.iter().map(|p| p.within_mm).fold(0.0, f64::max), 2)
        );
        (!found.is_empty()).then(|| Diagnostic::warning(f.id.clone(), text))
    };
    let each: Vec<Option<Diagnostic>> = part.faces.par_iter().map(of).collect();
    each.into_iter().flatten().collect()
}

/// A warning for every face whose area does not fit the curves of its boundary, by a second method (Stokes).
fn unbalanced(part: &Loaded) -> Vec<Diagnostic> {
    let of = |f: &LoadedFace| {
        let off = f.source.as_ref()?.imbalance()?;
        let [loops, curves] = [off.loops_mm2, off.boundary_mm2].map(|x| number(x, 6));
        let text = format!(
            "as its loops were put together it has {loops} mm2 seen along its mean normal, and by the curves of its boundary {curves}: look at it \
             (lines) before it is machined or checked"
        );
        Some(Diagnostic::warning(f.id.clone(), text))
    };
    let each: Vec<Option<Diagnostic>> = part.faces.par_iter().map(of).collect();
    each.into_iter().flatten().collect()
}
