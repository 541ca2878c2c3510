//! The lines of a face as JSON: what a program draws or measures on.

use super::study::{Levels, Study};
use osculate_geom::{Point3, Uv};
use osculate_surfaces::lines::{Critical, CriticalKind, Family, LineEnd, SurfacePolyline, Turn, UmbilicKind};
use serde::Serialize;

/// Everything in one object.
#[derive(Debug, Serialize)]
pub struct Answer {
    format: u32,
    face: String,
    unit: &'static str,
    axis: [f64; 3],
    size_mm: f64,
    /// Side of the largest cell searched: features below it may be missed.
    resolution_mm: f64,
    position_tolerance_mm: f64,
    chord_tolerance_mm: f64,
    umbilics: Umbilics,
    curvature_lines: Vec<FamilyLines>,
    difference: Field,
    contours: Field,
    gradient_lines: Vec<Line>,
    ridges: Vec<RidgeLine>,
    parabolic_lines: Vec<Line>,
    asymptotic_lines: Vec<Line>,
    /// What was not searched or drawn as finely as the rest.
    notes: Vec<String>,
    /// The best postures of a tool, where one is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub postures: Option<super::postures::Arrays>,
    /// The axis with the fewest minima of height, where `axis` has some.
    #[serde(skip_serializing_if = "Option::is_none")]
    fewest_minima: Option<Fewest>,
    /// Where a tool that does not turn stands, where one is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fixed_axis: Option<Vec<super::fixed_axis::Arrays>>,
    /// The files written.
    pub files: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Fewest {
    axis: [f64; 3],
    turn_deg: f64,
    minima: usize,
}

#[derive(Debug, Serialize)]
struct Umbilics {
    points: Vec<Umbilic>,
    /// Sum of the indices in the parameter rectangle, poles not counted; null where one could not be counted.
    index_sum: Option<f64>,
    /// What the sum must be, by the turn of the lines along the border.
    border_sum: Option<f64>,
    confirmed: bool,
    lines: usize,
    region_cells: usize,
}

#[derive(Debug, Serialize)]
struct Umbilic {
    uv: [f64; 2],
    point_mm: [f64; 3],
    kind: &'static str,
    index: Option<f64>,
    curvature_per_mm: f64,
}

#[derive(Debug, Serialize)]
struct FamilyLines {
    /// `k1`, the most convex curvature, or `k2`.
    family: &'static str,
    lines: Vec<Line>,
}

#[derive(Debug, Serialize)]
struct Field {
    unit: &'static str,
    levels: Vec<f64>,
    minima: Vec<Extreme>,
    maxima: Vec<Extreme>,
    saddles: Vec<Extreme>,
    /// Whether their indices agree with the gradient's turn along the border; null where that has no meaning.
    confirmed: Option<bool>,
    lines: Vec<LevelLine>,
}

#[derive(Debug, Serialize)]
struct Extreme {
    uv: [f64; 2],
    point_mm: [f64; 3],
    value: f64,
}

#[derive(Debug, Serialize)]
struct LevelLine {
    level: f64,
    #[serde(flatten)]
    line: Line,
}

#[derive(Debug, Serialize)]
struct RidgeLine {
    family: &'static str,
    greatest: bool,
    crest: bool,
    #[serde(flatten)]
    line: Line,
}

#[derive(Debug, Serialize)]
struct Line {
    closed: bool,
    ends: [&'static str; 2],
    length_mm: f64,
    points_mm: Vec<[f64; 3]>,
    uv: Vec<[f64; 2]>,
}

/// The lines of a study, and what its axis might be.
pub fn answer(study: &Study, turn: &Turn, face: &str) -> Answer {
    let u = &study.umbilics;
    let half = |twice: Option<i32>| twice.map(|t| 0.5 * f64::from(t));
    let point = |p: &osculate_surfaces::lines::Umbilic| Umbilic {
        uv: pair(p.at),
        point_mm: triple(&p.point),
        kind: match p.kind {
            UmbilicKind::Lemon => "lemon",
            UmbilicKind::Monstar => "monstar",
            UmbilicKind::Star => "star",
            UmbilicKind::Degenerate => "degenerate",
        },
        index: half(p.index_twice),
        curvature_per_mm: p.curvature_per_mm,
    };
    let lines = |all: &[SurfacePolyline]| all.iter().map(line).collect::<Vec<_>>();
    Answer {
        format: 1,
        face: face.to_owned(),
        unit: "mm",
        axis: [study.axis.x, study.axis.y, study.axis.z],
        size_mm: study.size_mm,
        resolution_mm: study.resolution_mm,
        position_tolerance_mm: study.tolerance.position_mm,
        chord_tolerance_mm: study.tolerance.chord_mm,
        umbilics: Umbilics {
            points: u.inside().map(point).collect(),
            index_sum: half(u.index_sum_twice),
            border_sum: half(u.border_sum_twice),
            confirmed: u.confirmed(),
            lines: u.lines.len(),
            region_cells: u.regions.len(),
        },
        curvature_lines: Family::ALL
            .iter()
            .zip(&study.curvature)
            .map(|(f, l)| FamilyLines { family: family_name(*f), lines: lines(l) })
            .collect(),
        difference: field(&study.difference, "1/mm", |square| square.max(0.0).sqrt()),
        contours: field(&study.heights, "mm", |height| height),
        gradient_lines: lines(&study.gradients),
        ridges: study
            .ridges
            .iter()
            .map(|r| RidgeLine {
                family: family_name(r.family),
                greatest: r.greatest,
                crest: r.crest,
                line: line(&r.line),
            })
            .collect(),
        parabolic_lines: study.parabolic.lines.iter().map(|c| line(&c.line)).collect(),
        asymptotic_lines: study.asymptotic.iter().flatten().map(line).collect(),
        notes: study.notes.clone(),
        postures: None,
        fewest_minima: (turn.asked.minima > 0).then(|| Fewest {
            axis: [turn.fewest.axis.x, turn.fewest.axis.y, turn.fewest.axis.z],
            turn_deg: turn.fewest.turn_rad.to_degrees(),
            minima: turn.fewest.minima,
        }),
        fixed_axis: None,
        files: Vec::new(),
    }
}

const fn family_name(family: Family) -> &'static str {
    match family {
        Family::Most => "k1",
        Family::Least => "k2",
    }
}

fn field(levels: &Levels, unit: &'static str, shown: impl Fn(f64) -> f64) -> Field {
    let extremes = |kind: CriticalKind| -> Vec<Extreme> {
        let one =
            |c: &Critical| Extreme { uv: pair(c.at), point_mm: triple(&c.point), value: shown(c.value) };
        levels.critical.inside(kind).map(one).collect()
    };
    Field {
        unit,
        levels: levels.values.clone(),
        minima: extremes(CriticalKind::Minimum),
        maxima: extremes(CriticalKind::Maximum),
        saddles: extremes(CriticalKind::Saddle),
        confirmed: levels.critical.confirmed,
        lines: levels
            .contours
            .lines
            .iter()
            .map(|c| LevelLine { level: shown(c.level), line: line(&c.line) })
            .collect(),
    }
}

fn line(l: &SurfacePolyline) -> Line {
    Line {
        closed: l.is_closed(),
        ends: l.ends.map(|e| match e {
            LineEnd::Closed => "closed",
            LineEnd::Border => "border",
            LineEnd::Trim => "trim",
            LineEnd::Stop(_) => "stop",
            LineEnd::Isotropic => "isotropic",
            LineEnd::Degenerate => "degenerate",
            LineEnd::Singular => "singular",
            LineEnd::Crowded => "crowded",
            LineEnd::TooLong => "too_long",
        }),
        length_mm: l.length_mm(),
        points_mm: l.points.iter().map(|p| triple(&p.point)).collect(),
        uv: l.points.iter().map(|p| pair(p.at)).collect(),
    }
}

fn pair(at: Uv) -> [f64; 2] {
    [at.u, at.v]
}

fn triple(p: &Point3) -> [f64; 3] {
    [p.x, p.y, p.z]
}
