//! Shells, solids and the product that they are the shape of.

use super::options::StepOptions;
use super::records::{Records, list, real, text};
use crate::part::Face;
use crate::topology::{Topology, bodies};

/// The shape items: a solid for faces that close, a shell for the others. Returns their numbers, and whether all are
/// solids.
pub(super) fn items(
    out: &mut Records<'_>,
    faces: &[Face],
    topology: &Topology,
    written: &[usize],
) -> (Vec<usize>, bool) {
    let mut solids = Vec::new();
    let mut open = Vec::new();
    for body in bodies(faces, topology) {
        let ids: Vec<usize> = body.faces.iter().map(|f| written[*f]).collect();
        let kind = if body.closed { "CLOSED_SHELL" } else { "OPEN_SHELL" };
        let shell = out.add(format!("{kind}('',{})", list(&ids)));
        if body.solid {
            solids.push(out.add(format!("MANIFOLD_SOLID_BREP('',#{shell})")));
        } else {
            open.push(shell);
        }
    }
    let only_solids = open.is_empty();
    if !open.is_empty() {
        solids.push(out.add(format!("SHELL_BASED_SURFACE_MODEL('',{})", list(&open))));
    }
    (solids, only_solids)
}

/// The product structure around the shape items.
pub(super) fn product(
    out: &mut Records<'_>,
    options: &StepOptions,
    (items, only_solids): &(Vec<usize>, bool),
    accuracy_mm: f64,
) {
    let name = text(&options.name);
    let application =
        out.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')".to_owned());
    out.add(format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})"
    ));
    let context = out.add(format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
    let product = out.add(format!("PRODUCT({name},{name},'',(#{context}))"));
    out.add(format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"));
    let formation = out.add(format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
    let design = out.add(format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
    let definition = out.add(format!("PRODUCT_DEFINITION('design','',#{formation},#{design})"));
    let shape = out.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
    let length = out.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))".to_owned());
    let angle = out.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))".to_owned());
    let solid = out.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())".to_owned());
    let uncertainty = out.add(format!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{length},'distance_accuracy_value','')",
        real(accuracy_mm)
    ));
    let units = out.add(format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))REPRESENTATION_CONTEXT('',''))"
    ));
    let frame = out.placement(&osculate_geom::analytic::Placement::identity());
    let kind = match (only_solids, items.len()) {
        (true, _) => "ADVANCED_BREP_SHAPE_REPRESENTATION",
        (false, 1) => "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
        (false, _) => "SHAPE_REPRESENTATION",
    };
    let mut all = vec![frame];
    all.extend(items);
    let representation = out.add(format!("{kind}({name},{},#{units})", list(&all)));
    out.add(format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})"));
}
