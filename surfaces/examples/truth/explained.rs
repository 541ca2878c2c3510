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
    /// Why ours is right, in a few words.
    why: &'static str,
}

const COUNT: &[&str] = &["faces without a reference"];
const AREAS: &[&str] = &["area of a face", "area in all", "box"];
const UNBOUNDED: &[&str] = &["number of faces", "area in all", "box", "number of faces of one entity"];
const NO_PRODUCT: &str = "faces stand in the file, no product definition leads to them";
const PARAMETERS: &str = "the reference follows parameter curves that leave the space curves";
const INACCURATE: &str = "the reference's area is less accurate than it says; both kinds of curves give ours";
const ENDLESS: &str = "a surface without limits is no face; the reference shows one of 1e100 mm";

/// Only files in which ours was found right by a second computation or by hand.
const FINDINGS: &[Finding] = &[
    Finding { file: "ap214_direct_manifold.stp", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "ap242_swept_solids.stp", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "doubly_periodic_native_remap_transaction.stp", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "periodic_budget_solid_a.stp", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "periodic_budget_solid_b.stp", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "ap203_periodic_pole_solid.stp", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "scaled_periodic_pole_solids.stp", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "pc01_surface_parameter.p21", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "pc04_shared_pcurve.p21", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "pc04_shared_pcurve_reordered.p21", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "tp12_two_admissions.p21", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "cadmpeg_ap214_sheet.p21", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "ap242_tessellation.p21", reasons: COUNT, why: NO_PRODUCT },
    Finding { file: "ap242_vertex_loop.p21", reasons: COUNT, why: NO_PRODUCT },
    Finding {
        file: "chrono_assembly.stp",
        reasons: &["number of faces", "area in all", "box", "number of faces of one entity"],
        why: "the reference shows parts placed by mapped items a second time, unplaced",
    },
    Finding {
        file: "axom_boxed_sphere.step",
        reasons: &["area of a face", "area in all", "sample: inside"],
        why: PARAMETERS,
    },
    Finding {
        file: "caxif_s1_c5_214__MAINBODY_FRONT.stp",
        reasons: &["area of a face"],
        why: "arcs end 3e-3 mm apart; with the gap closed both kinds of curves give ours",
    },
    Finding { file: "near_degenerate_nurbs_pole.stp", reasons: AREAS, why: PARAMETERS },
    Finding {
        file: "closed_nurbs_interval.stp",
        reasons: AREAS,
        why: "a cylinder of radius 10 over 0.4 rad and 10 mm: area 40, as ours",
    },
    Finding {
        file: "unclamped_closed_curve_knots.stp",
        reasons: AREAS,
        why: "de Boor's rule on the file's numbers gives ours, the reference changes the curve",
    },
    Finding {
        file: "open_nurbs_measured_mismatch.stp",
        reasons: &["box"],
        why: "the edges lie 0.15 mm off the surface; ours is the box of the surface, z = 0",
    },
    Finding {
        file: "nurbs_terminal_extension.stp",
        reasons: &["box"],
        why: "the reference's box holds a curve that the face uses no part of",
    },
    Finding { file: "nist_mbe_pmi_5_ap203.stp", reasons: &["area of a face"], why: INACCURATE },
    Finding { file: "build123d_m6_screw.step", reasons: &["area of a face"], why: INACCURATE },
    Finding { file: "trimesh_featuretype.STEP", reasons: &["area of a face"], why: INACCURATE },
    Finding { file: "occt_hammer.iges", reasons: &["area of a face"], why: INACCURATE },
    Finding {
        file: "nist_ctc_05_asme1_ap242.stp",
        reasons: &["area of a face"],
        why: "the reference follows parameter curves up to 2.5e-3 mm off the space curves",
    },
    Finding {
        file: "caxif_s1_c5_214__HEAD_BACK.stp",
        reasons: AREAS,
        why: "a quarter sphere less half a cap is 10788.76 mm2 as ours; the reference takes the complement",
    },
    Finding { file: "iges_micro/cadmpeg_plane.igs", reasons: UNBOUNDED, why: ENDLESS },
    Finding { file: "cadmpeg_analytic_plane_surface.igs", reasons: UNBOUNDED, why: ENDLESS },
    Finding { file: "cadmpeg_analytic_cone_surface.igs", reasons: UNBOUNDED, why: ENDLESS },
];

/// Why the differences of a file are not ours; `None` where one of them has another reason than those looked into.
pub fn explained(file: &str, differences: &[Difference]) -> Option<&'static str> {
    let finding = FINDINGS.iter().find(|f| file.ends_with(f.file))?;
    let known = differences.iter().all(|d| finding.reasons.contains(&d.reason()));
    (known && !differences.is_empty()).then_some(finding.why)
}
