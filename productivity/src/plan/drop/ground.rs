//! What is known before passes of a tool that keeps its axis are laid out: seeds of drops, places, what each wants.

use super::frame::Frame;
use super::height::{Drops, Rest};
use super::seeds::{areas, sampled, seeds};
use super::task::DropTask;
use super::wants::{Lost, Want, want};
use crate::plan::{MAX_PASSES, Pass, Passes, PlanError, Tolerance};
use osculate_geom::{Diagnostic, Surface, Unit3};
use osculate_tools::removal::Sample;
use rayon::prelude::*;

/// Most places, over all faces.
const MOST_PLACES: f64 = 3e5;
/// The share of the tolerance that passes are laid out for: the rest is for what the leading order neglects.
pub(super) const DESIGN: f64 = 0.94;
/// Shares of the area below which a loss is not worth a word.
pub(super) const WORTH_A_WORD: f64 = 1e-3;

/// How passes run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lines {
    /// In the frame's parallel planes.
    Planes,
    /// Up and down the slope.
    Gradient,
    /// At constant heights.
    Waterlines,
}

impl Lines {
    /// Places that say where passes go, and those at which what is left is measured, stand these parts of a strip on level
    /// ground apart. Lines that come together leave peaks more pointed than planes do.
    const fn apart(self) -> [f64; 2] {
        match self {
            Self::Planes | Self::Waterlines => [0.5, 0.2],
            Self::Gradient => [0.25, 0.12],
        }
    }

    /// The share of the scallop up to which a measured place counts as done.
    pub(super) const fn met(self) -> f64 {
        match self {
            Self::Planes | Self::Waterlines => 0.5 * (1.0 + DESIGN),
            Self::Gradient => 0.9,
        }
    }

    /// A place nearer to a pass than this part of its reach, and not right under it, is not measured: what it keeps grows with the
    /// square of the distance, so that a place further out would tell first if leading order were wrong by as much. Gradient
    /// lines turn beside a place, which leading order does not know.
    pub(super) const fn near(self) -> f64 {
        match self {
            Self::Planes | Self::Waterlines => 0.7,
            Self::Gradient => 0.0,
        }
    }

    /// Most places to measure, over all faces.
    const fn most_judged(self) -> f64 {
        match self {
            Self::Planes | Self::Waterlines => MOST_PLACES,
            Self::Gradient => 3.0 * MOST_PLACES,
        }
    }
}

/// What is known before passes are laid out.
pub(super) struct Ground<'a> {
    pub task: &'a DropTask<'a>,
    pub lines: Lines,
    pub frame: Frame,
    pub drops: Drops<'a>,
    /// Samples of the faces to machine that say where passes must go, and their distance, mm.
    pub places: Vec<Sample>,
    pub spacing: f64,
    /// Samples at which what is left is measured.
    pub judged: Vec<Sample>,
}

impl Ground<'_> {
    /// What a sample wants of passes that leave `height_mm`, samples standing `spacing_mm` apart.
    pub(super) fn want(&self, s: &Sample, [height_mm, spacing_mm]: [f64; 2]) -> Result<Want, Lost> {
        let task = self.task;
        let asked = |frame: &Frame| {
            let surface = task.faces[s.face as usize].surface;
            want((surface, s), (task.cutter, frame), self.lines == Lines::Waterlines, [height_mm, spacing_mm])
        };
        match self.lines {
            Lines::Planes => asked(&self.frame),
            Lines::Waterlines => {
                let w = asked(&self.frame)?;
                // Out of touch by less than anybody asks for: what rounding says of a wall is nothing.
                let n = self.frame.along(&s.normal);
                let by = 0.25 * task.tolerance.chord_mm / n[0].hypot(n[1]);
                Ok(Want { at: [w.at[0] + by * n[0], w.at[1] + by * n[1]], ..w })
            }
            Lines::Gradient => {
                // Seen in a frame whose first direction goes down the slope.
                let frame = Frame::new(task.axis, &s.normal);
                let w = asked(&frame)?;
                let [x, y, _] = self.frame.of(&frame.point([w.at[0], w.at[1], 0.0]));
                Ok(Want { at: [x, y], ..w })
            }
        }
    }

    /// Distance of two passes that leave the tolerance around a contact between them, mm; NaN where the leading order
    /// has none.
    pub(super) fn width_mm(&self, rest: &Rest, normal: Unit3) -> f64 {
        let task = self.task;
        if rest.face as usize >= task.faces.len() {
            return f64::NAN;
        }
        let (uv, point) = (rest.uv, rest.point);
        let sample = Sample { point, normal, face: rest.face, uv, area_mm2: 0.0, check_only: false };
        let wanted = self.want(&sample, [task.tolerance.scallop_mm, 0.0]);
        wanted.map_or(f64::NAN, |w| 2.0 * w.reach)
    }
}

pub(super) fn too_many(task: &DropTask<'_>) -> PlanError {
    PlanError::TooManyPasses {
        face: task.faces[0].face.to_owned(),
        limit: MAX_PASSES,
        scallop_mm: task.tolerance.scallop_mm,
    }
}

pub(super) fn nothing(task: &DropTask<'_>, why: &str) -> PlanError {
    let face = task.faces.iter().map(|n| n.face).collect::<Vec<_>>().join(", ");
    PlanError::Nothing { face, why: why.to_owned() }
}

/// Passes in the order of cutting, with what there is to say about them.
pub(super) fn told(ground: &Ground<'_>, passes: Vec<Pass>, lost: &[(f64, &'static str)]) -> Passes {
    let task = ground.task;
    let mut out = Passes { passes, diagnostics: Vec::new() };
    let name = if task.faces.len() == 1 { task.faces[0].face } else { "all faces" };
    let lines = match ground.lines {
        Lines::Planes => "isoplanar",
        Lines::Gradient => "gradient",
        Lines::Waterlines => "waterline",
    };
    let text = format!("{} three-axis {lines} passes, {:.0} mm", out.passes.len(), out.length_mm());
    out.diagnostics.push(Diagnostic::note(name, text));
    let area: f64 = ground.places.iter().map(|s| s.area_mm2).sum();
    for (gone, what) in lost {
        if *gone > WORTH_A_WORD * area {
            out.diagnostics.push(Diagnostic::loss(
                name,
                format!("{gone:.2} mm2 of {area:.2} mm2 {what}; left by this strategy"),
            ));
        }
    }
    out
}

/// Samples the faces: seeds for drops on all of them, places on those to be machined.
pub(super) fn ground<'a>(
    task: &'a DropTask<'a>,
    surfaces: &'a [&'a dyn Surface],
    lines: Lines,
) -> Result<Ground<'a>, PlanError> {
    let frame = Frame::new(task.axis, &task.feed);
    let areas = areas(surfaces);
    let (seeds, spacing, _) = seeds(task, (surfaces, &areas), &frame)?;
    let drops = Drops::new(surfaces, task.cutter, frame, seeds, spacing);
    let strip = 2.0 * (2.0 * task.tolerance.scallop_mm * task.cutter.radius_mm()).sqrt();
    let machined: f64 = areas[..task.faces.len()].iter().sum();
    let over = |part: f64, most: f64| -> Result<(Vec<Sample>, f64), PlanError> {
        let (mut samples, mut spacing): (Vec<Sample>, f64) = (Vec::new(), 0.0);
        for k in 0..task.faces.len() {
            let sampling = sampled((task, surfaces, &areas), k, part * strip, [most, machined])?;
            spacing = spacing.max(sampling.density.spacing_mm);
            samples.extend(sampling.samples);
        }
        Ok((samples, spacing))
    };
    let [places, judged] = lines.apart();
    let (places, spacing) = over(places, MOST_PLACES)?;
    let (judged, _) = over(judged, lines.most_judged())?;
    Ok(Ground { task, lines, frame, drops, places, spacing, judged })
}

/// What every sample wants, and the areas that want nothing possible.
pub(super) fn asked(ground: &Ground<'_>) -> (Vec<Want>, Vec<(f64, &'static str)>) {
    let task = ground.task;
    let height = design_mm(&task.tolerance);
    let all: Vec<Result<Want, Lost>> = (0..ground.places.len())
        .into_par_iter()
        .map(|k| ground.want(&ground.places[k], [height, ground.spacing]))
        .collect();
    let mut wants = Vec::with_capacity(all.len());
    let mut areas = [0.0; 5];
    for (s, w) in ground.places.iter().zip(all) {
        match w {
            Ok(w) => wants.push(w),
            Err(Lost::Undercut) => areas[0] += s.area_mm2,
            Err(Lost::TightContour) => areas[1] += s.area_mm2,
            Err(Lost::TooHollow) => areas[2] += s.area_mm2,
            Err(Lost::NoTangent) => areas[3] += s.area_mm2,
            Err(Lost::Flat) => areas[4] += s.area_mm2,
        }
    }
    let words = [
        "faces away from the tool axis",
        "is too hollow for the tool: its contour lines bend tighter than the cutter",
        "is too hollow for the tool",
        "has no tangent plane",
        "is flatter than 45 degrees",
    ];
    (wants, areas.into_iter().zip(words).collect())
}

/// The height that passes are laid out for: chords of the path add a quarter of their tolerance in the mean.
pub(super) fn design_mm(t: &Tolerance) -> f64 {
    DESIGN * (t.scallop_mm - 0.25 * t.chord_mm).max(0.1 * t.scallop_mm)
}

/// Drops wants whose position the tool cannot take because it would cut elsewhere; returns their area.
pub(super) fn hide(ground: &Ground<'_>, wants: &mut Vec<Want>) -> f64 {
    // Seeds see the height to within what lies between them, so that this errs towards keeping a want.
    let slack = ground.task.tolerance.scallop_mm;
    let kept: Vec<bool> = wants.par_iter().map(|w| !ground.drops.is_above(w.at, w.tip + slack)).collect();
    let mut area = 0.0;
    let mut keep = kept.iter();
    wants.retain(|w| {
        // One answer for each want, in their order.
        let kept = keep.next().copied().unwrap_or(true);
        if !kept {
            area += w.area;
        }
        kept
    });
    area
}
