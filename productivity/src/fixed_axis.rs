//! A tool that does not turn, at a place of a face: whether it stands there without digging in next to its contact [M86, 3C].
//!
//! What is told is local. A place that is clear here may still be out of reach because the tool would cut elsewhere:
//! [`access`](crate::access) and the drops of [`plan`](crate::plan) look at the whole part.

use osculate_geom::{Darboux, Jet2, Relative, Surface, Unit3, Uv, any_perpendicular};
use osculate_tools::{Cutter, Lean};
use rayon::prelude::*;

/// Why a tool with a fixed axis cannot machine a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Undercut {
    /// The place looks away from the tool, or sideways.
    #[error("faces away from the tool axis")]
    FacesAway,
    /// Its contour line is hollow and bends tighter than the cutter's circle there.
    #[error("has a contour line that bends tighter than the cutter")]
    TightContour,
    /// The tool does not fit into its hollow in another direction.
    #[error("is too hollow for the tool")]
    TooHollow,
    /// It has no tangent plane.
    #[error("has no tangent plane")]
    NoTangent,
}

/// The smaller eigenvalue of the relative form Q, 1/mm, of a cutter that touches a place with its axis along `axis`.
///
/// A bottom that lies flat on level ground has no curvature: there the place's own counts.
///
/// ```
/// use osculate_geom::{Surface, Vec3, analytic::Paraboloid, uv};
/// use osculate_productivity::fixed_axis::{Undercut, clear};
/// use osculate_tools::{Cutter, CutterSpec};
/// // A bowl of radius 50 at its bottom: a ball of 10 fits, a flat end does not get around the minimum.
/// let bottom = Paraboloid::new([0.01, 0.01], 20.0)?.jet2(uv(0.0, 0.0));
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 20.0, length_mm: 60.0 })?;
/// assert!((clear(&bottom, &Vec3::z_axis(), &ball)? - (0.1 - 0.02)).abs() < 1e-12);
/// let flat = Cutter::try_from(CutterSpec::Flat { diameter_mm: 20.0, length_mm: 60.0 })?;
/// assert_eq!(clear(&bottom, &Vec3::z_axis(), &flat), Err(Undercut::TooHollow));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Undercut`].
pub fn clear(jet: &Jet2, axis: &Unit3, cutter: &Cutter) -> Result<f64, Undercut> {
    let forms = jet.forms().map_err(|_| Undercut::NoTangent)?;
    let up = forms.normal.dot(axis);
    if up <= 0.0 {
        return Err(Undercut::FacesAway);
    }
    // The tool leans along the slope: up it is ahead.
    let slope = axis.into_inner() - forms.normal.into_inner() * up;
    let level = slope.norm() <= LEVEL;
    let ahead = if level { any_perpendicular(&forms.normal).into_inner() } else { slope };
    let frame = Darboux::with_forms(jet, &forms, &ahead, 0.0);
    let lean = Lean::of(axis, &frame);
    let flat = level && cutter.touching(lean.lead_rad).centre_rho_mm > 0.0;
    if flat {
        let least = forms.principal().k_min;
        return if least >= 0.0 { Ok(least) } else { Err(Undercut::TooHollow) };
    }
    let tool = lean.tool_curvature(cutter, &frame);
    let q = Relative::new(&forms, &tool);
    if !level && forms.normal_curvature(&frame.left) + tool.across < 0.0 {
        return Err(Undercut::TightContour);
    }
    if q.min >= 0.0 { Ok(q.min) } else { Err(Undercut::TooHollow) }
}

/// Below this sine between normal and axis ground is level: what rounding makes of it.
const LEVEL: f64 = 1e-12;

/// A place of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Place {
    /// Parameters.
    pub at: Uv,
    /// What [`clear`] says; None outside the face.
    pub clear: Option<Result<f64, Undercut>>,
    /// The face's area for a unit of both parameters: its weight among the others.
    pub weight: f64,
}

/// The places of a face at equal steps of both parameters, half a step from the border, in rows of v for each u, as
/// [`best_postures`](crate::field::best_postures) has them.
#[must_use]
pub fn over(surface: &dyn Surface, axis: &Unit3, cutter: &Cutter, [n, m]: [usize; 2]) -> Vec<Place> {
    let domain = surface.domain();
    (0..n * m)
        .into_par_iter()
        .map(|k| {
            let part = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
            let at = domain.at(part(k / m, n), part(k % m, m));
            let jet = surface.jet2(at);
            let clear = surface.contains(at).then(|| clear(&jet, axis, cutter));
            Place { at, clear, weight: jet.du.cross(&jet.dv).norm() }
        })
        .collect()
}
