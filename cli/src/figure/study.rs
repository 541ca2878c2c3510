//! Everything that the figures of a face show, computed once.

use super::levels::nice_levels;
use osculate_geom::{Axis, Interval, Point3, Surface, Unit3, Uv, Vec3, uv};
use osculate_surfaces::lines::{
    Chart, ChartError, Contours, Course, Cover, CoverEnd, Covered, CriticalKind, CriticalPoints,
    CurvatureDifference, Family, FieldSample, Gauss, Height, LinePoint, LineTolerance, Ridge, ScalarField,
    SurfacePolyline, TraceStops, Turn, Umbilics, contours, cover, critical_points, ridges, turned, umbilics,
};
use osculate_surfaces::{BezierPatch, Mesh, NurbsSurface, TrimmedSurface, tessellate};

/// What a figure is asked to show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Direction of the contours and gradients: the tool axis.
    pub axis: Unit3,
    /// Distance of neighbouring lines of curvature, mm; a twenty-second of the face's size where it is `None`.
    pub spacing_mm: Option<f64>,
    /// About how many levels of height and of difference.
    pub levels: usize,
}

/// Why a face has no figures.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// No lines can be drawn on it.
    #[error(transparent)]
    Chart(#[from] ChartError),
}

/// A field with its lines.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Levels {
    /// Values of the lines, ascending.
    pub values: Vec<f64>,
    /// The lines.
    pub contours: Contours,
    /// Minima, maxima and saddles.
    pub critical: CriticalPoints,
}

/// The lines of a face.
#[derive(Clone, Debug)]
pub struct Study {
    /// Direction of the contours and gradients.
    pub axis: Unit3,
    /// Lines of constant u, then of constant v.
    pub net: [Vec<Vec<Point3>>; 2],
    /// The face's borders: sides and trims, without seams.
    pub borders: Vec<Vec<Point3>>,
    /// The Bezier patches of a spline face.
    pub bezier: Vec<BezierPatch>,
    /// Umbilics.
    pub umbilics: Umbilics,
    /// Lines of curvature of k_1 and of k_2.
    pub curvature: [Vec<SurfacePolyline>; 2],
    /// Lines of constant k_1 - k_2, values in 1/mm.
    pub difference: Levels,
    /// Contour lines, values in mm.
    pub heights: Levels,
    /// Gradient lines.
    pub gradients: Vec<SurfacePolyline>,
    /// Ridges.
    pub ridges: Vec<Ridge>,
    /// Parabolic lines.
    pub parabolic: Contours,
    /// Asymptotic lines of both kinds.
    pub asymptotic: [Vec<SurfacePolyline>; 2],
    /// Triangles of the face, for what hides what.
    pub mesh: Mesh,
    /// Few triangles, to paint it.
    pub coarse: Mesh,
    /// Mean outward normal; short where the face bends around.
    pub facing: Vec3,
    /// Diagonal of the box around sampled points, mm.
    pub size_mm: f64,
    /// Side of the largest cell searched, mm.
    pub resolution_mm: f64,
    /// The tolerances.
    pub tolerance: LineTolerance,
    /// What was not searched or drawn as finely as the rest, one a line; empty where all was.
    pub notes: Vec<String>,
    face: TrimmedSurface,
}

/// How much the face looks towards the viewer: zero on its outline.
struct Facing(Vec3);

impl ScalarField for Facing {
    fn sample(&self, surface: &dyn Surface, at: Uv) -> Option<FieldSample> {
        let n = surface.jet2(at).normal().ok()?;
        Some(FieldSample { value: n.dot(&self.0), gradient: None, sense: None })
    }
}

/// Lines of curvature over the size of the face, where nothing else is asked for.
const ACROSS: f64 = 22.0;
/// Most lines of a family in a figure.
const MOST_LINES: usize = 400;

/// Levels of a face whose lines are not looked at.
const FEW: usize = 1;

impl Study {
    /// A face to paint on, whose lines are not looked at; `spline` as in [`Study::of`].
    pub fn to_paint(face: &TrimmedSurface, spline: Option<&NurbsSurface>) -> Result<Self, StudyError> {
        Self::of(face, spline, &Wanted { axis: Vec3::z_axis(), spacing_mm: None, levels: FEW })
    }

    /// The lines of a face; `spline` is the spline that it is a piece of, where it is one.
    pub fn of(
        face: &TrimmedSurface,
        spline: Option<&NurbsSurface>,
        wanted: &Wanted,
    ) -> Result<Self, StudyError> {
        // The size is not known before; the first chart's cells do not matter.
        let rough = Chart::new(face, LineTolerance { position_mm: 1.0, chord_mm: 1.0, cell_mm: f64::MAX })?;
        let size = rough.size_mm();
        let tolerance = LineTolerance { position_mm: 1e-9 * size, ..LineTolerance::for_size(size) };
        let chart = Chart::new(face, tolerance)?;
        let spacing_mm = wanted.spacing_mm.unwrap_or(size / ACROSS);
        let umbilics = umbilics(&chart);
        let stops = |points: Vec<LinePoint>| TraceStops { places: points, longest_mm: Some(12.0 * size) };
        let at_umbilics =
            stops(umbilics.points.iter().map(|u| LinePoint { at: u.at, point: u.point }).collect());
        let spread = |course: Course, stops: &TraceStops, ends_early: bool| {
            let how = Cover {
                spacing_mm,
                ends_early,
                stops: stops.clone(),
                seeds: Vec::new(),
                most_lines: MOST_LINES,
            };
            cover(&chart, course, &how)
        };
        let mut notes = Vec::new();
        let curvature = Family::ALL.map(|f| {
            let spread = spread(Course::Curvature(f), &at_umbilics, true);
            told(spread, "lines of curvature", spacing_mm, &mut notes)
        });
        let asymptotic = [true, false].map(|left| {
            let spread = spread(Course::Asymptotic { left }, &stops(Vec::new()), true);
            told(spread, "asymptotic lines", spacing_mm, &mut notes)
        });
        coarse(umbilics.coarse_cells, "umbilics", &mut notes);

        let height = Height { axis: wanted.axis };
        let critical = critical_points(&chart, &height);
        let values = levels_of(&chart, &height, wanted.levels, |v| v, size);
        let lines = contours(&chart, &height, &values, Some(&critical));
        let ends = critical.points.iter().map(|p| LinePoint { at: p.at, point: p.point }).collect();
        let gradients = spread(Course::Gradient(wanted.axis), &stops(ends), false);
        let gradients = told(gradients, "gradient lines", spacing_mm, &mut notes);
        coarse(critical.coarse_cells, "extremes of the height", &mut notes);
        unrefined(lines.coarse_pieces, "contours", &mut notes);
        let heights = Levels { values, contours: lines, critical };

        let critical = critical_points(&chart, &CurvatureDifference);
        let values =
            levels_of(&chart, &CurvatureDifference, wanted.levels, f64::sqrt, chart.curvature_per_mm());
        let squares: Vec<f64> = values.iter().map(|d| d * d).collect();
        let lines = contours(&chart, &CurvatureDifference, &squares, Some(&critical));
        coarse(critical.coarse_cells, "extremes of k1 - k2", &mut notes);
        unrefined(lines.coarse_pieces, "lines of constant k1 - k2", &mut notes);
        let difference = Levels { values, contours: lines, critical };
        let parabolic = contours(&chart, &Gauss, &[0.0], None);
        unrefined(parabolic.coarse_pieces, "parabolic lines", &mut notes);
        let ridges = ridges(&chart, &umbilics);
        unrefined(ridges.coarse_pieces, "ridges", &mut notes);
        // Both families of a kind may say the same.
        notes.dedup();

        let mesh = tessellate(face, 2e-3 * size, None);
        Ok(Self {
            axis: wanted.axis,
            net: [Axis::U, Axis::V].map(|axis| parameter_lines(&chart, face, axis)),
            borders: borders(&chart, face),
            bezier: spline.map(NurbsSurface::bezier_patches).unwrap_or_default(),
            curvature,
            difference,
            heights,
            gradients,
            ridges: ridges.lines,
            parabolic,
            asymptotic,
            umbilics,
            facing: facing(face),
            mesh,
            coarse: tessellate(face, 8e-3 * size, None),
            size_mm: size,
            resolution_mm: chart.resolution_mm(),
            tolerance,
            notes,
            face: face.clone(),
        })
    }

    /// The lines on which the face turns away from a viewer.
    pub fn silhouette(&self, toward: &Vec3) -> Vec<Vec<Point3>> {
        let Ok(chart) = Chart::new(&self.face, self.tolerance) else { return Vec::new() };
        let lines = contours(&chart, &Facing(*toward), &[0.0], None).lines;
        let closed = |l: &SurfacePolyline| l.is_closed().then(|| l.points[0].point);
        lines.iter().map(|c| c.line.points.iter().map(|p| p.point).chain(closed(&c.line)).collect()).collect()
    }

    /// The face under its axis, and the axis with the fewest minima of height.
    ///
    /// # Errors
    /// [`StudyError::Chart`].
    pub fn turned(&self) -> Result<Turn, StudyError> {
        Ok(turned(&Chart::new(&self.face, self.tolerance)?, self.axis))
    }

    /// The critical points of the difference other than umbilics.
    pub fn difference_extremes(&self) -> impl Iterator<Item = &osculate_surfaces::lines::Critical> {
        let near = self.tolerance.cell_mm * 1e-3;
        self.difference.critical.points.iter().filter(move |c| {
            c.inside
                && c.kind != CriticalKind::Degenerate
                && !self.umbilics.points.iter().any(|u| (u.point - c.point).norm() < near)
        })
    }
}

/// The lines of a family; where it came to a bound, a note says so.
fn told(covered: Covered, what: &str, spacing_mm: f64, notes: &mut Vec<String>) -> Vec<SurfacePolyline> {
    let count = covered.lines.len();
    match covered.end {
        CoverEnd::Full => {}
        CoverEnd::Most => {
            notes.push(format!("{what}: no more than {count} are drawn; a wider --spacing-mm shows the whole face"));
        }
        CoverEnd::Points => notes.push(format!(
            "{what}: {count} are drawn; they wind so often that no more were tried, as in noise"
        )),
        CoverEnd::Stubs => notes.push(format!(
            "{what}: {count} are drawn; after hundreds that end within the spacing of {spacing_mm:.3} mm no more were tried: a narrower \
             --spacing-mm shows them, unless the curvature there is noise"
        )),
    }
    covered.lines
}

/// A note on cells that were searched less finely.
fn coarse(cells: usize, what: &str, notes: &mut Vec<String>) {
    if cells > 0 {
        notes.push(format!(
            "{what}: in {cells} cells there is one nearly everywhere, as in noise; they were searched less finely, single ones are not told apart"
        ));
    }
}

/// A note on pieces whose lines may do more than is drawn.
fn unrefined(pieces: usize, what: &str, notes: &mut Vec<String>) {
    if pieces > 0 {
        notes.push(format!(
            "{what}: in {pieces} pieces of the face they may turn more often than is drawn, as in noise"
        ));
    }
}

/// Round levels over the range of a field on the face, its lowest and highest hundredth left out.
fn levels_of(
    chart: &Chart,
    field: &dyn ScalarField,
    count: usize,
    shown: impl Fn(f64) -> f64,
    floor: f64,
) -> Vec<f64> {
    let mut values = Vec::new();
    for u in chart.borders(Axis::U) {
        for v in chart.borders(Axis::V) {
            let at = uv(*u, *v);
            if chart.surface().contains(at)
                && let Some(s) = field.sample(chart.surface(), at)
            {
                values.push(shown(s.value));
            }
        }
    }
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values.get((share * (values.len().max(1) - 1) as f64) as usize).copied();
    match (at(0.0), at(0.01), at(0.99), at(1.0)) {
        // Spikes are cut off, an even spread is not.
        (Some(least), Some(lo), Some(hi), Some(most)) => {
            let range = hi - lo;
            let lo = if lo - least < 0.2 * range { least } else { lo };
            let hi = if most - hi < 0.2 * range { most } else { hi };
            // What rounding makes of a constant has no levels.
            if range <= 1e-9 * hi.abs().max(lo.abs()).max(floor) {
                Vec::new()
            } else {
                nice_levels(lo, hi, count)
            }
        }
        _ => Vec::new(),
    }
}

/// Lines on which `axis` is constant, where they are inside the trims, about as far apart along both parameters.
fn parameter_lines(chart: &Chart, face: &TrimmedSurface, axis: Axis) -> Vec<Vec<Point3>> {
    /// Points of a whole line.
    const POINTS: usize = 160;
    let borders = chart.borders(axis);
    let d = face.domain();
    let count = (borders.len() - 1).div_ceil(3).clamp(4, 24);
    let i = d.get(axis);
    let last = if i.periodic { count - 1 } else { count };
    let mut out = Vec::new();
    for k in 0..=last {
        let fixed = i.at(k as f64 / count as f64);
        let whole = d.get(axis.other()).length();
        for span in face.spans(axis.other(), fixed) {
            let n = ((POINTS as f64 * span.length() / whole).ceil() as usize).max(2);
            out.push(
                (0..=n)
                    .map(|j| face.point(Uv::from_axis(axis, fixed, span.at(j as f64 / n as f64))))
                    .collect(),
            );
        }
    }
    out
}

/// The loops of the face without the pieces along seams and poles.
fn borders(chart: &Chart, face: &TrimmedSurface) -> Vec<Vec<Point3>> {
    let d = face.domain();
    let mut out: Vec<Vec<Point3>> = Vec::new();
    for l in face.loops() {
        let n = l.points.len();
        let mut line: Vec<Point3> = Vec::new();
        for k in 0..n {
            let (a, b) = (l.points[k], l.points[(k + 1) % n]);
            let on_seam = |i: Interval, a: f64, b: f64| {
                let slack = 1e-9 * i.length();
                let at = |t: f64| (a - t).abs() <= slack && (b - t).abs() <= slack;
                i.periodic && (at(i.lo) || at(i.hi))
            };
            if on_seam(d.u, a.u, b.u) || on_seam(d.v, a.v, b.v) {
                if line.len() > 1 {
                    out.push(std::mem::take(&mut line));
                }
                line.clear();
                continue;
            }
            // As many pieces as the side crosses cells.
            let cells = |axis: Axis| {
                let (lo, hi) = (a.get(axis).min(b.get(axis)), a.get(axis).max(b.get(axis)));
                chart.borders(axis).iter().filter(|t| **t > lo && **t < hi).count()
            };
            let pieces = 2 * (1 + cells(Axis::U).max(cells(Axis::V)));
            for j in usize::from(!line.is_empty())..=pieces {
                let t = j as f64 / pieces as f64;
                line.push(face.point(uv(a.u + t * (b.u - a.u), a.v + t * (b.v - a.v))));
            }
        }
        if line.len() > 1 {
            out.push(line);
        }
    }
    out
}

/// The mean outward normal over samples of the face, by area.
fn facing(face: &TrimmedSurface) -> Vec3 {
    let (mut sum, mut area) = (Vec3::zeros(), 0.0);
    for (at, _) in face.samples(6) {
        if let Ok(forms) = face.jet2(at).forms() {
            sum += forms.normal.into_inner() * forms.area_density();
            area += forms.area_density();
        }
    }
    if area > 0.0 { sum / area } else { sum }
}
