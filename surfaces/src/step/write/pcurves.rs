//! Edge curves with their parameter curves on the surfaces that they bound.
//!
//! A plane needs none. A curve and its parameter curves have one parameter.

use super::curves;
use super::records::{Records, knots, list, reals};
use crate::nurbs::NurbsCurve2;
use crate::part::Face;
use crate::topology::{Ground, Step, Topology, Way, pcurves};
use crate::trim::analytic;
use crate::trim::carrier::FaceSurface;

/// Parameter curves of one edge: the face, and the curve.
type Uses = Vec<(usize, NurbsCurve2)>;

/// What is written: faces, their edges' ways, and their loops with the face on the left seen against `S_u x S_v`.
pub(super) struct Shape<'a> {
    pub(super) faces: &'a [Face],
    pub(super) topology: &'a Topology,
    pub(super) ways: &'a [Way],
    pub(super) walks: &'a [Vec<Vec<Step>>],
}

/// The curves of all edges, with parameter curves on `surfaces`; their numbers.
pub(super) fn curves(out: &mut Records<'_>, shape: &Shape<'_>, surfaces: &[usize]) -> Vec<usize> {
    let uses = uses(shape);
    let mut space = None;
    let mut numbers = Vec::with_capacity(uses.len());
    for (way, uses) in shape.ways.iter().zip(&uses) {
        let curve = curves::curve(out, way);
        if uses.is_empty() {
            numbers.push(curve);
            continue;
        }
        let context = *space.get_or_insert_with(|| {
            out.add(
                "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()\
                 REPRESENTATION_CONTEXT('',''))"
                    .to_owned(),
            )
        });
        let seam = uses.len() == 2 && uses[0].0 == uses[1].0;
        // One parameter curve is enough where both uses have the same.
        let same = seam && uses[0].1.poles() == uses[1].1.poles();
        // The format has room for two.
        let written: Vec<usize> = uses
            .iter()
            .take(if same { 1 } else { 2 })
            .map(|(face, curve)| pcurve(out, curve, surfaces[*face], context))
            .collect();
        let kind = if seam && !same { "SEAM_CURVE" } else { "SURFACE_CURVE" };
        numbers.push(out.add(format!("{kind}('',#{curve},{},.CURVE_3D.)", list(&written))));
    }
    numbers
}

/// The parameter curves of every edge, in the parameters of the file.
fn uses(shape: &Shape<'_>) -> Vec<Uses> {
    let mut out: Vec<Uses> = vec![Vec::new(); shape.ways.len()];
    for (number, ((face, of), walks)) in
        shape.faces.iter().zip(&shape.topology.faces).zip(shape.walks).enumerate()
    {
        let Some(scale) = parameter_scale(face) else { continue };
        let ground = Ground::own(face, &of.chart);
        let made = pcurves(&ground, of, walks, &|edge| shape.ways[edge].track());
        for (step, curve) in walks.iter().flatten().zip(made.into_iter().flatten()) {
            out[step.edge].extend(curve.and_then(|c| scaled(&c, scale)).map(|c| (number, c)));
        }
    }
    out
}

/// What a unit of our parameters is in the file; `None` for a plane, and for a torus that meets itself, of which kernels
/// disagree.
fn parameter_scale(face: &Face) -> Option<[f64; 2]> {
    let FaceSurface::Analytic(a) = &face.carrier else { return Some([1.0, 1.0]) };
    match a.shape() {
        analytic::Shape::Plane | analytic::Shape::Lemon { .. } => None,
        analytic::Shape::Torus { major_radius_mm, minor_radius_mm } => {
            (major_radius_mm > minor_radius_mm).then_some([1.0, 1.0])
        }
        // The file measures along the axis, and a cone that opens downwards stands on its head.
        analytic::Shape::Cone { half_angle_rad, .. } => {
            let turned = if half_angle_rad < 0.0 { -1.0 } else { 1.0 };
            Some([turned, turned * half_angle_rad.cos()])
        }
        analytic::Shape::Cylinder { .. } | analytic::Shape::Sphere { .. } => Some([1.0, 1.0]),
    }
}

fn scaled(c: &NurbsCurve2, [u, v]: [f64; 2]) -> Option<NurbsCurve2> {
    let poles = c.poles().iter().map(|p| [p.x * u, p.y * v].into()).collect();
    NurbsCurve2::new(c.degree(), c.knots().as_slice().to_vec(), poles, None).ok()
}

fn pcurve(out: &mut Records<'_>, c: &NurbsCurve2, surface: usize, context: usize) -> usize {
    let ids: Vec<usize> =
        c.poles().iter().map(|p| out.add(format!("CARTESIAN_POINT('',{})", reals(&[p.x, p.y])))).collect();
    let (times, values) = knots(c.knots().as_slice());
    let (degree, poles) = (c.degree(), list(&ids));
    let curve = out.add(format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',{degree},{poles},.UNSPECIFIED.,.F.,.F.,{times},{values},.UNSPECIFIED.)"
    ));
    let definition = out.add(format!("DEFINITIONAL_REPRESENTATION('',(#{curve}),#{context})"));
    out.add(format!("PCURVE('',#{surface},#{definition})"))
}
