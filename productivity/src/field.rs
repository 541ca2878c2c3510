//! Quantities over a face as arrays: the best posture at every node of a grid, and what the local geometry says there.
//!
//! Nodes stand at equal steps of both parameters, half a step from the border, so that no node lies on an edge. Nodes
//! outside a trimmed face, and those without an answer, are `None` with the reason kept. The same bytes come out for any number of
//! threads.

use crate::optimum::{self, Limits, Optimum, OptimumError};
use osculate_geom::indicatrix::Conformity;
use osculate_geom::{Darboux, Relative, Surface, Uv};
use osculate_tools::Cutter;
use rayon::prelude::*;

/// What is known at a node.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Node {
    /// Parameters.
    pub at: Uv,
    /// The best posture, or why there is none; None outside the face.
    pub best: Option<Result<Optimum, OptimumError>>,
    /// Angle between the direction that the indicatrix of conformity claims and the one of the widest strip at the best
    /// posture, rad [R97, eq. 63].
    pub claim_off_rad: Option<f64>,
    /// Smaller eigenvalue of Q at the best posture, 1/mm.
    pub relative_min_per_mm: Option<f64>,
}

/// Nodes over a face, in rows of v for each u.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Field {
    /// Counts in u and v.
    pub count: [usize; 2],
    /// The nodes.
    pub nodes: Vec<Node>,
}

/// The best postures over a face with `count` nodes in u and v.
///
/// ```
/// use osculate_geom::{Domain, Interval, analytic::Plane};
/// use osculate_productivity::{field::best_postures, optimum::{Limits, Range}, rate::Caps};
/// use osculate_tools::{Cutter, CutterSpec};
///
/// let plane = Plane::new(Domain { u: Interval::new(0.0, 40.0), v: Interval::new(0.0, 40.0) });
/// let tools = [Cutter::try_from(CutterSpec::Ball { diameter_mm: 8.0, length_mm: 40.0 })?];
/// let (lead, tilt) = (Range { least_rad: 0.1, most_rad: 0.4 }, Range::only(0.0));
/// let limits = Limits { scallop_mm: 0.01, gouge_mm: 0.001, lead, tilt, axis: None, caps: Caps::of_feed(1000.0) };
/// let field = best_postures(&plane, &tools, &limits, [2, 1])?;
/// // All places of a plane are alike, and half a step from the border: at a fourth and three fourths of it.
/// assert_eq!((field.nodes[0].at.u, field.nodes[1].at.u), (10.0, 30.0));
/// let widths_mm = field.widths_mm();
/// assert!((widths_mm[0] - widths_mm[1]).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`OptimumError`] of limits or tools that no node could be answered with; what fails at a node stays there.
pub fn best_postures(
    surface: &dyn Surface,
    tools: &[Cutter],
    limits: &Limits,
    count: [usize; 2],
) -> Result<Field, OptimumError> {
    optimum::check(tools, limits)?;
    let domain = surface.domain();
    let place = |k: usize| {
        let part = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        domain.at(part(k / count[1], count[0]), part(k % count[1], count[1]))
    };
    let nodes = (0..count[0] * count[1])
        .into_par_iter()
        .map(|k| {
            let at = place(k);
            let best = surface.contains(at).then(|| optimum::at(surface, at, tools, limits));
            let local =
                best.as_ref().and_then(|b| b.as_ref().ok()).and_then(|b| local(surface, tools, b, at));
            Node { at, best, claim_off_rad: local.map(|l| l[0]), relative_min_per_mm: local.map(|l| l[1]) }
        })
        .collect();
    Ok(Field { count, nodes })
}

/// The claim's angle and Q's smaller eigenvalue at a posture.
fn local(surface: &dyn Surface, tools: &[Cutter], best: &Optimum, at: Uv) -> Option<[f64; 2]> {
    let jet = surface.jet2(at);
    let forms = jet.forms().ok()?;
    let (s, c) = best.direction_rad.sin_cos();
    let direction = forms.frame[0].into_inner() * c + forms.frame[1].into_inner() * (s * jet.side.sign());
    let frame = Darboux::with_forms(&jet, &forms, &direction, 0.0);
    let tool = best.lean.tool_curvature(&tools[best.tool], &frame);
    Some([Conformity::new(forms, tool).claim().off_rad, Relative::new(&forms, &tool).min])
}

impl Field {
    /// A quantity of the best postures, NaN where there is none.
    pub fn values(&self, of: impl Fn(&Optimum) -> f64) -> Vec<f64> {
        self.nodes
            .iter()
            .map(|n| n.best.as_ref().and_then(|b| b.as_ref().ok()).map_or(f64::NAN, &of))
            .collect()
    }

    /// Strip widths, mm.
    #[must_use]
    pub fn widths_mm(&self) -> Vec<f64> {
        self.values(|o| o.rate.width_mm)
    }

    /// Areas per minute E, mm2/min.
    #[must_use]
    pub fn productivity_mm2_min(&self) -> Vec<f64> {
        self.values(|o| o.rate.area_mm2_min)
    }

    /// Feed directions from S_u towards S_v, rad.
    #[must_use]
    pub fn directions_rad(&self) -> Vec<f64> {
        self.values(|o| o.direction_rad)
    }

    /// Leads, rad.
    #[must_use]
    pub fn leads_rad(&self) -> Vec<f64> {
        self.values(|o| o.lean.lead_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimum::Range;
    use crate::rate::Caps;
    use osculate_geom::analytic::Torus;
    use osculate_tools::CutterSpec;

    #[test]
    fn a_field_on_a_ring() {
        let ring = Torus::new(80.0, 30.0).unwrap();
        let caps = Caps { spindle_rpm: 10_000.0, teeth: 2, feed_mm_min: 2000.0, feed_per_tooth_mm: 0.1 };
        let lead = Range { least_rad: 0.05, most_rad: 0.6 };
        let limits =
            Limits { scallop_mm: 0.01, gouge_mm: 0.002, lead, tilt: Range::only(0.0), axis: None, caps };
        let spec = CutterSpec::Toroidal { diameter_mm: 10.0, corner_radius_mm: 1.0, length_mm: 80.0 };
        let tools = [Cutter::try_from(spec).unwrap()];
        let field = best_postures(&ring, &tools, &limits, [2, 4]).unwrap();
        // The ring looks the same all around: rows of u are level.
        let e = field.productivity_mm2_min();
        for j in 0..4 {
            assert!((e[j] / e[4 + j] - 1.0).abs() < 5e-3, "{e:?}");
        }
        assert!(field.widths_mm().iter().all(|w| *w > 0.5));
        assert!(field.nodes.iter().all(|n| n.relative_min_per_mm.is_some_and(|q| q > 0.0)));
        assert_eq!(field, best_postures(&ring, &tools, &limits, [2, 4]).unwrap());
        assert!(best_postures(&ring, &[], &limits, [2, 4]).is_err());
    }
}
