//! Point sections as text (blades, hulls): surfaces through rows of points.
//!
//! Every side of a file, the suction side say, becomes one face: cubic along the sections (u) and across them (v),
//! quadratic or straight where there are too few points or sections, with the points on it to rounding. A section
//! whose end meets its start is closed. A contour of radii over an axis becomes a surface of revolution about it. The
//! layouts that are read are those of `layout`.

mod error;
mod layout;

pub use error::SectionsError;

use crate::fit::{Ends, Grid, LoftOptions, Spacing, SurfaceFit, interpolate, interpolate_grid, loft};
use crate::nurbs::NurbsSurface;
use crate::part::{Face, FaceKind, Format, Part};
use crate::structure::Structure;
use crate::trim::boundary::build;
use crate::trim::carrier::FaceSurface;
use crate::trim::spline::Spline;
use crate::trim::sweep::{SweepError, revolve};
use layout::{Content, FEWEST, Layout, Section};
use osculate_geom::analytic::Placement;
use osculate_geom::{Box3, Diagnostic, Point3, Side, Unit3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Neighbours nearer than this fraction of a section's size are one point: files carry seven digits.
const SAME: f64 = 1e-7;

/// A section is closed where its ends are no farther apart than this multiple of the widest step beside them.
const CLOSED: f64 = 1.5;

/// Two sections whose starts are farther apart than this part of their size, where another point is much nearer, begin
/// at different places.
const SHIFTED: f64 = 0.5;

/// Whether the bytes begin like rows of points.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    layout::looks_like(&String::from_utf8_lossy(&bytes[..bytes.len().min(8192)]))
}

/// Reads sections in the unit that the file names, else in millimetres, which is told.
///
/// ```
/// use osculate_surfaces::sections;
/// // Three straight sections of three points, 10 mm apart in z: a plane of 20 x 20 mm.
/// let text = "x,y,z\n0,0,0\n10,0,0\n20,0,0\n0,0,10\n10,0,10\n20,0,10\n0,0,20\n10,0,20\n20,0,20\n";
/// let part = sections::read(text.as_bytes())?;
/// assert_eq!(part.faces.len(), 1);
/// assert!((part.faces[0].area_mm2() - 400.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SectionsError`].
pub fn read(bytes: &[u8]) -> Result<Part, SectionsError> {
    read_in(bytes, None)
}

/// Reads sections; `unit_mm`, millimetres in a unit of the file, counts before what the file says.
///
/// # Errors
/// [`SectionsError`].
pub fn read_in(bytes: &[u8], unit_mm: Option<f64>) -> Result<Part, SectionsError> {
    let text = String::from_utf8_lossy(bytes);
    let Layout { content, unit } = layout::read(&text)?;
    let mut diagnostics = Vec::new();
    let (factor, unit_name) = match (unit_mm, unit) {
        (Some(mm), _) => (mm, format!("{mm} mm")),
        (None, Some((mm, name))) => (mm, name.to_owned()),
        (None, None) => {
            diagnostics.push(Diagnostic::warning(
                "",
                "the file names no unit: its coordinates are taken as millimetres",
            ));
            (1.0, "mm".to_owned())
        }
    };
    let scaled = |s: Section| Section { points: s.points.iter().map(|p| p * factor).collect(), ..s };
    let faces = match content {
        Content::Contour(section) => vec![contour(scaled(section), &mut diagnostics)?],
        Content::Sides(sides) => sides
            .into_iter()
            .enumerate()
            .map(|(k, (name, sections))| {
                let sections = sections.into_iter().map(scaled).collect();
                side(&format!("F{}", k + 1), name, sections, &mut diagnostics)
            })
            .collect::<Result<Vec<_>, _>>()?,
    };
    Ok(Part {
        structure: Structure::default(),
        format: Format::Sections,
        uncertainty_mm: None,
        unit: unit_name,
        schema: String::new(),
        faces,
        not_used: Vec::new(),
        truncated: false,
        diagnostics,
    })
}

fn face(id: &str, name: String, line: usize, kind: FaceKind, n: NurbsSurface) -> Result<Face, SectionsError> {
    let built = build(FaceSurface::Nurbs(Arc::new(n)), &[], Side::Along, false)?;
    Ok(Face {
        id: id.to_owned(),
        name,
        product: String::new(),
        colour: None,
        entity: line as u64,
        kind,
        oriented: false,
        carrier: built.assembled.carrier,
        surface: Arc::new(built.assembled.surface),
    })
}

/// Leaves out points that stand where the one before stands; gives how many.
fn cleaned(section: &mut Section) -> usize {
    let size = Box3::around(&section.points).diagonal_mm();
    let before = section.points.len();
    section.points.dedup_by(|b, a| (*b - *a).norm() <= SAME * size);
    before - section.points.len()
}

/// Whether the end of a section meets its start.
fn is_closed(points: &[Point3]) -> bool {
    let n = points.len();
    if n < 4 {
        return false;
    }
    let step = |k: usize| (points[(k + 1) % n] - points[k]).norm();
    let beside = step(0).max(step(n - 2));
    // The widest step counts where points are spaced by curvature.
    step(n - 1) <= CLOSED * beside
}

/// One face over its sections.
fn side(
    id: &str,
    name: String,
    mut sections: Vec<Section>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Face, SectionsError> {
    if let [only] = &sections[..] {
        return Err(SectionsError::OneSection { points: only.points.len() });
    }
    let repeated: usize = sections.iter_mut().map(cleaned).sum();
    let closed = sections.iter().all(|s| is_closed(&s.points));
    let mut doubled = 0;
    if closed {
        for s in &mut sections {
            let size = Box3::around(&s.points).diagonal_mm();
            while s.points.len() > 1 && (s.points[s.points.len() - 1] - s.points[0]).norm() <= SAME * size {
                s.points.pop();
                doubled += 1;
            }
        }
    }
    let need = if closed { FEWEST + 1 } else { FEWEST };
    if let Some(s) = sections.iter().find(|s| s.points.len() < need) {
        return Err(SectionsError::FewPoints { line: s.line, got: s.points.len(), need });
    }
    if repeated > 0 {
        let what = format!("{repeated} points stand where the one before them stands and were left out");
        diagnostics.push(Diagnostic::warning(id, what));
    }
    tell_order(id, &sections, closed, diagnostics);
    let fewest = sections.iter().map(|s| s.points.len()).min().unwrap_or(0);
    let most = sections.iter().map(|s| s.points.len()).max().unwrap_or(0);
    let degree = [(fewest - 1 - usize::from(closed)).min(3), (sections.len() - 1).min(3)];
    let SurfaceFit { surface, misfit, .. } = if fewest == most {
        let points = (0..fewest).flat_map(|i| sections.iter().map(move |s| s.points[i])).collect();
        let grid = Grid { count: [fewest, sections.len()], points };
        interpolate_grid(&grid, degree, Spacing::Centripetal, [closed, false])?
    } else {
        let rows: Vec<Vec<Point3>> = sections.iter().map(|s| s.points.clone()).collect();
        let options = LoftOptions { degree, spacing: Spacing::Centripetal, closed, tolerance_mm: None };
        loft(&rows, &options)?
    };
    diagnostics.push(Diagnostic::note(
        id,
        format!(
            "{} {} sections of {} points{}; the surface of degrees {} and {} is {:.1e} mm off the worst point",
            sections.len(),
            if closed { "closed" } else { "open" },
            if fewest == most { fewest.to_string() } else { format!("{fewest} to {most}") },
            if doubled > 0 { ", the repeated last ones left out" } else { "" },
            degree[0],
            degree[1],
            misfit.max_mm
        ),
    ));
    face(id, name, sections[0].line, FaceKind::Bspline, surface)
}

/// Says where a section runs against the one before, or begins elsewhere.
fn tell_order(id: &str, sections: &[Section], closed: bool, diagnostics: &mut Vec<Diagnostic>) {
    for pair in sections.windows(2) {
        let [a, b] = [&pair[0].points, &pair[1].points];
        let at = |p: &[Point3], f: f64| p[((p.len() - 1) as f64 * f).round() as usize];
        let apart = |turned: bool| -> f64 {
            [0.1, 0.3, 0.5, 0.7, 0.9]
                .iter()
                .map(|f| (at(a, *f) - at(b, if turned { 1.0 - f } else { *f })).norm())
                .sum()
        };
        let place = format!("{id}, section at line {}", pair[1].line);
        if apart(true) < 0.5 * apart(false) {
            let what = "it seems to run against the section before; the surface may be twisted";
            diagnostics.push(Diagnostic::warning(place, what));
        } else if closed {
            let size = Box3::around(b).diagonal_mm();
            let start = (a[0] - b[0]).norm();
            let nearest = b.iter().map(|p| (p - a[0]).norm()).fold(f64::INFINITY, f64::min);
            if start > SHIFTED * size && nearest < 0.25 * start {
                let what = "it seems to begin elsewhere than the section before; the surface may be twisted";
                diagnostics.push(Diagnostic::warning(place, what));
            }
        }
    }
}

/// A contour turned about the x axis by a full turn.
fn contour(mut section: Section, diagnostics: &mut Vec<Diagnostic>) -> Result<Face, SectionsError> {
    let repeated = cleaned(&mut section);
    let points = &section.points;
    if points.len() < FEWEST {
        return Err(SectionsError::FewPoints { line: section.line, got: points.len(), need: FEWEST });
    }
    if let Some(p) = points.iter().find(|p| p.y < 0.0) {
        return Err(SectionsError::Contour(format!("a radius of {}", p.y)));
    }
    let degree = (points.len() - 1).min(3);
    let fit = interpolate(points, degree, Spacing::Centripetal, &Ends::Free)?;
    let axis = Placement::new(Point3::origin(), Unit3::new_unchecked(Vec3::x()), Some(Vec3::y()));
    let swept = revolve(&Spline::from_curve(fit.curve), &axis, [0.0, TAU])
        .map_err(|e: SweepError| SectionsError::Contour(e.to_string()))?;
    diagnostics.push(Diagnostic::note(
        "F1",
        format!(
            "a contour of {} points turned about the x axis; the curve is {:.1e} mm off the worst one{}",
            points.len(),
            fit.misfit.max_mm,
            if repeated > 0 { format!("; {repeated} repeated points were left out") } else { String::new() }
        ),
    ));
    face("F1", String::new(), section.line, FaceKind::Revolution, swept)
}
