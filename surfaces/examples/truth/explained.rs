//! Files whose difference from the reference has a name: who is right, and for which reasons only.
//!
//! An explained file does not agree; it is counted apart. `docs/import-differences.md` says more of each.

use crate::compare::Difference;

/// What was found out about a file.
struct Finding {
    /// End of the file's path.
    file: &'static str,
    /// The reasons that it explains; any other stays open.
    reasons: &'static [&'static str],
    /// The largest relative difference of an area that was looked into; a larger one stays open.
    area: f64,
    /// Why ours is right, in a few words.
    why: &'static str,
}

const COUNT: &[&str] = &["faces without a reference"];
const AREAS: &[&str] = &["area of a face", "area in all", "box"];
const UNBOUNDED: &[&str] = &["number of faces", "area in all", "box", "number of faces of one entity"];
const FACE_AREAS: &[&str] = &["area of a face"];
const NO_PRODUCT: &str = "faces stand in the file, no product definition leads to them";
const PARAMETERS: &str = "the reference follows parameter curves that leave the space curves";
const INACCURATE: &str = "the reference's area is less accurate than it says; both kinds of curves give ours";
const OFF: &str = "the edges lie off their surfaces, by more than the areas differ; elsewhere the second integral gives ours";
const ENDLESS: &str = "a surface without limits is no face; the reference shows one of 1e100 mm";

/// Only files in which ours was found right by a second computation or by hand.
const FINDINGS: &[Finding] = &[
    Finding { file: "ap214_direct_manifold.stp", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "ap242_swept_solids.stp", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding {
        file: "doubly_periodic_native_remap_transaction.stp",
        reasons: COUNT,
        area: 0.0,
        why: NO_PRODUCT,
    },
    Finding { file: "periodic_budget_solid_a.stp", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "periodic_budget_solid_b.stp", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "ap203_periodic_pole_solid.stp", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "scaled_periodic_pole_solids.stp", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "pc01_surface_parameter.p21", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "pc04_shared_pcurve.p21", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "pc04_shared_pcurve_reordered.p21", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "tp12_two_admissions.p21", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "cadmpeg_ap214_sheet.p21", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "ap242_tessellation.p21", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding { file: "ap242_vertex_loop.p21", reasons: COUNT, area: 0.0, why: NO_PRODUCT },
    Finding {
        file: "ap203_invalid_brep.stp",
        reasons: UNBOUNDED,
        area: 0.0,
        why: "one circle around a cylinder bounds no part of it: refused with a word; the reference's face has no area and \
              fails its own check",
    },
    Finding {
        file: "chrono_assembly.stp",
        reasons: &["number of faces", "area in all", "box", "number of faces of one entity"],
        area: 0.51,
        why: "the reference shows parts placed by mapped items a second time, unplaced",
    },
    Finding {
        file: "axom_boxed_sphere.step",
        reasons: &["area of a face", "area in all", "sample: inside"],
        area: 0.35,
        why: PARAMETERS,
    },
    Finding {
        file: "caxif_s1_c5_214__MAINBODY_FRONT.stp",
        reasons: &["area of a face"],
        area: 6e-4,
        why: "arcs end 3e-3 mm apart; with the gap closed both kinds of curves give ours",
    },
    Finding { file: "near_degenerate_nurbs_pole.stp", reasons: AREAS, area: 7e-4, why: PARAMETERS },
    Finding {
        file: "closed_nurbs_interval.stp",
        reasons: AREAS,
        area: 6e-5,
        why: "a cylinder of radius 10 over 0.4 rad and 10 mm: area 40, as ours",
    },
    Finding {
        file: "unclamped_closed_curve_knots.stp",
        reasons: AREAS,
        area: 2.1e-2,
        why: "de Boor's rule on the file's numbers gives ours, the reference changes the curve",
    },
    Finding {
        file: "open_nurbs_measured_mismatch.stp",
        reasons: &["box"],
        area: 0.0,
        why: "the edges lie 0.15 mm off the surface; ours is the box of the surface, z = 0",
    },
    Finding {
        file: "nurbs_terminal_extension.stp",
        reasons: &["box"],
        area: 0.0,
        why: "the reference's box holds a curve that the face uses no part of",
    },
    Finding { file: "nist_mbe_pmi_5_ap203.stp", reasons: &["area of a face"], area: 1e-4, why: INACCURATE },
    Finding { file: "build123d_m6_screw.step", reasons: &["area of a face"], area: 2e-5, why: INACCURATE },
    Finding { file: "trimesh_featuretype.STEP", reasons: &["area of a face"], area: 2e-5, why: INACCURATE },
    Finding { file: "occt_hammer.iges", reasons: &["area of a face"], area: 2e-4, why: INACCURATE },
    Finding {
        file: "nist_ctc_05_asme1_ap242.stp",
        reasons: &["area of a face"],
        area: 3e-5,
        why: "the reference follows parameter curves up to 2.5e-3 mm off the space curves",
    },
    Finding {
        file: "caxif_s1_c5_214__HEAD_BACK.stp",
        reasons: AREAS,
        area: 0.7,
        why: "a quarter sphere less half a cap is 10788.76 mm2 as ours; the reference takes the complement",
    },
    Finding { file: "iges_micro/cadmpeg_plane.igs", reasons: UNBOUNDED, area: 1.1, why: ENDLESS },
    Finding { file: "cadmpeg_analytic_plane_surface.igs", reasons: UNBOUNDED, area: 1.1, why: ENDLESS },
    Finding { file: "cadmpeg_analytic_cone_surface.igs", reasons: UNBOUNDED, area: 1.1, why: ENDLESS },
    Finding {
        file: "mapped_assembly.stp",
        reasons: COUNT,
        area: 0.0,
        why: "the one face of six that lies on its plane, at two places",
    },
    Finding {
        file: "pc05_periodic_trim.p21",
        reasons: COUNT,
        area: 0.0,
        why: "four rectangles of tori stand in the file without a product",
    },
    Finding {
        file: "br01_topology_root_identity.p21",
        reasons: COUNT,
        area: 0.0,
        why: "one shell that four items use, shown once for each",
    },
    Finding {
        file: "tp05_missing_vertex_carrier.p21",
        reasons: COUNT,
        area: 0.0,
        why: "one face of two; the other's vertex is of an unknown kind, and that is said",
    },
    Finding {
        file: "explicit_tetrahedron_solid_with_boolean.igs",
        reasons: COUNT,
        area: 0.0,
        why: "four faces (510) of a solid (186) stand in the file; the reference drops them with the boolean",
    },
    Finding {
        file: "explicit_vertex_loop.igs",
        reasons: &["number of faces"],
        area: 0.0,
        why: "a vertex loop at the pole bounds the whole sphere; the reference drops the face",
    },
    Finding {
        file: "explicit_cylinder_seam.igs",
        reasons: UNBOUNDED,
        area: 1.1,
        why: "the only loop is a seam there and back, which bounds nothing; the reference's 0.1097 mm2 is no area of the file",
    },
    Finding {
        file: "multi_pcurve_boundary.igs",
        reasons: AREAS,
        area: 0.0,
        why: "a unit square has the area 1, as ours; reference 0",
    },
    Finding {
        file: "pythonocc_testfile.igs",
        reasons: &["area of a face", "area in all", "box", "sample: point"],
        area: 1.1,
        why: "the file says millimetres (field 14 is 2); the reference takes inches, 25.4 times all lengths",
    },
    Finding {
        file: "kcl_exhaust-manifold.step",
        reasons: &["sample: curvature"],
        area: 0.0,
        why: "the samples lie one digit before a knot, where the curvature jumps; the reference gives the other side",
    },
    Finding {
        file: "gmsh_laufrad_wheel.stp",
        reasons: &["area of a face", "number of faces", "number of faces of one entity"],
        area: 3e-3,
        why: "the reference cuts the face #352 in two along u = 0; their areas add up to ours to 8e-6",
    },
    Finding {
        file: "brlcad_plate_creo.stp",
        reasons: FACE_AREAS,
        area: 1.5e-5,
        why: "Gauss panels over the rectangle in the file give ours to 1e-12",
    },
    Finding {
        file: "repeated_vertex_periodic_lobe.stp",
        reasons: &["box"],
        area: 0.0,
        why: "the reference's box holds a circle that bounds nothing of the face",
    },
    Finding { file: "gmsh_917_fusee_rocket.stp", reasons: FACE_AREAS, area: 6e-2, why: OFF },
    Finding { file: "gmsh_solid56_rational.step", reasons: FACE_AREAS, area: 1.2e-3, why: OFF },
    Finding { file: "gmsh_wrenchnut_allbspline.stp", reasons: FACE_AREAS, area: 1.5e-4, why: OFF },
    Finding { file: "atterwind_acat_hull.step", reasons: FACE_AREAS, area: 7.5e-4, why: OFF },
    Finding { file: "atterwind_dnaf1x_model.step", reasons: FACE_AREAS, area: 7.5e-4, why: OFF },
    Finding { file: "occt_linkrods.step", reasons: FACE_AREAS, area: 8e-4, why: OFF },
    Finding {
        file: "pygem_pipe_deformed.step",
        reasons: AREAS,
        area: 1.2e-4,
        why: "the edges lie up to 24 mm off their surfaces; areas and box differ by less",
    },
    Finding {
        file: "autogiro_propeller.step",
        reasons: AREAS,
        area: 2e-4,
        why: "edges up to 4e-4 mm off; no point of the faces lies beyond 130.0001 mm, the reference's box ends at 130.143",
    },
    Finding {
        file: "caxif_s1_c5_214__MAINBODY_BACK.stp",
        reasons: FACE_AREAS,
        area: 6e-4,
        why: "arcs end 3e-3 mm apart; with the gap closed the second integral gives ours",
    },
    Finding {
        file: "pyiges_impeller.igs",
        reasons: AREAS,
        area: 1.2e-5,
        why: "the second integral gives ours to 6e-8; no point of a face lies below z = -32.93344, the reference's box ends at -33.273",
    },
    Finding {
        file: "bladex_root.iges",
        reasons: AREAS,
        area: 3e-5,
        why: "Gauss panels over the whole surface give ours to 1e-12",
    },
    Finding {
        file: "dealii_dtmb5415_bow.iges",
        reasons: &["box"],
        area: 0.0,
        why: "the edges lie up to 0.5 mm off the surface; points of the reference's own face stand out of its box",
    },
];

/// Why the differences of a file are not ours; `None` where one of them has another reason than those looked into.
pub fn explained(file: &str, differences: &[Difference]) -> Option<&'static str> {
    let finding = FINDINGS.iter().find(|f| file.ends_with(f.file))?;
    let known = differences
        .iter()
        .all(|d| finding.reasons.contains(&d.reason()) && d.relative_area() <= finding.area);
    (known && !differences.is_empty()).then_some(finding.why)
}
