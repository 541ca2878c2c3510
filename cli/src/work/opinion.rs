//! A second opinion on a program, beside its verification: the points that it looks at, and what the two come to.
//!
//! [`second`] reads the program, follows the machine and measures the tool by code of its own. All
//! that it is given are texts, sizes and points: these come from the surfaces at places of an even lattice over their parameters, not
//! from the samples of the verification.

use crate::job::Job;
use crate::part::{LoadedFace, Part, area};
use crate::second::{
    self, Accepted, Agreement, Figures, HolderPart, NoOpinion, Options, PartPoint, Shape, Tool, Which,
};
use crate::work::rough;
use crate::work::verify::Verified;
use osculate_geom::{Surface, uv};
use osculate_tools::CutterSpec;
use serde::Serialize;

/// Points on the faces to machine, and on all others, about.
const POINTS: [f64; 2] = [100_000.0, 30_000.0];
/// Places along each parameter from which a face's sizes are estimated.
const LOOKS: usize = 16;
/// Most points along one parameter of a face.
const MOST: f64 = 4000.0;
/// What the figures may be off by, of the scallop tolerance.
const SLACK: f64 = 0.1;

/// The `second_opinion` object of `verify --json`.
#[derive(Debug, Serialize, Clone)]
#[non_exhaustive]
pub struct SecondOpinion {
    /// Whether the two agree; absent where there is no second opinion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agrees: Option<bool>,
    /// Why there is none, or in what they differ.
    pub why: String,
    /// Its figures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figures: Option<OpinionFigures>,
}

/// What the second opinion measured.
#[derive(Debug, Serialize, Clone, Copy)]
#[non_exhaustive]
pub struct OpinionFigures {
    /// Deepest point of the part in the cutter, in feed.
    pub gouge_max_mm: f64,
    /// In rapid.
    pub rapid_max_mm: f64,
    /// In shank and holder.
    pub holder_max_mm: f64,
    /// Most that stands over a point of the faces to machine.
    pub left_max_mm: f64,
    /// Points that the cutter never came near.
    pub uncut_points: usize,
    /// Frozen poses.
    pub poses: usize,
    /// Points of the part.
    pub points: usize,
    /// How far points are apart.
    pub points_apart_mm: f64,
    /// By how much its figures may be off.
    pub slack_mm: f64,
    /// Wall time, s.
    pub wall_s: f64,
}

/// Asks for a second opinion on a program; where it disagrees the verdict is doubted.
pub fn ask(job: &Job, part: &Part, program: &str, verified: Verified) -> (Verified, SecondOpinion) {
    match opinion(job, part, &job.control().language.engine_text(program), &verified) {
        Err(none) => {
            let why = format!("there is no second opinion: {none}");
            (verified, SecondOpinion { agrees: None, why, figures: None })
        }
        Ok((figures, None)) => {
            (verified, SecondOpinion { agrees: Some(true), why: String::new(), figures: Some(figures) })
        }
        Ok((figures, Some(why))) => {
            (doubted(verified, &why), SecondOpinion { agrees: Some(false), why, figures: Some(figures) })
        }
    }
}

/// A verification whose verdict a second opinion does not share.
fn doubted(verified: Verified, why: &str) -> Verified {
    let mut verified = Verified { verdict: verified.verdict.doubted(why.to_owned()), ..verified };
    let held = verified.verdict.is_held();
    verified.summary.within_tolerance = held;
    verified.summary.certain &= held;
    verified
}

fn opinion(
    job: &Job,
    part: &Part,
    program: &str,
    verified: &Verified,
) -> Result<(OpinionFigures, Option<String>), NoOpinion> {
    let (tolerance, control) = (job.tolerance(), job.control());
    let options = Options::new(job.layer_mm(), SLACK * tolerance.scallop_mm);
    let (tool, points) = (tool(job), points(job, part));
    let found =
        second::look(program, control.dialect.name(), &control.machine_toml, None, &tool, &points, &options)?;
    let figures = OpinionFigures {
        gouge_max_mm: found.gouge_mm.max(0.0),
        rapid_max_mm: found.rapid_mm.max(0.0),
        holder_max_mm: found.holder_mm.max(0.0),
        left_max_mm: found.left_mm,
        uncut_points: found.uncut,
        poses: found.poses,
        points: found.points,
        points_apart_mm: found.points_apart_mm,
        slack_mm: found.slack_mm,
        wall_s: found.seconds,
    };
    let v = &verified.summary;
    let bound = |seen: f64, more: Option<f64>| more.map_or(f64::INFINITY, |m| seen + m);
    // What stands uncut is higher than any scallop.
    let left_mm = if v.uncut_area_mm2 > 0.0 { options.stock_mm } else { v.scallop_max_mm };
    let theirs = Figures {
        gouge_mm: v.gouge_max_mm,
        gouge_bound_mm: bound(v.gouge_max_mm, v.hidden_gouge_mm),
        left_mm,
        left_bound_mm: bound(left_mm.max(v.height_max_mm), v.hidden_scallop_mm),
    };
    let accepted = Accepted { gouge_mm: tolerance.gouge_mm, left_mm: tolerance.scallop_mm };
    let why = match second::compare(&found, &theirs, &accepted) {
        Agreement::Agrees { .. } => None,
        Agreement::Disagrees { which, theirs_mm, ours_mm, slack_mm } => {
            let what = match which {
                Which::Gouge => "gouges",
                Which::Left => "what is left",
            };
            Some(format!(
                "a second opinion disagrees on {what}: {theirs_mm:.5} mm by the verification, {ours_mm:.5} mm by frozen poses, \
                 which may be off by {slack_mm:.5} mm"
            ))
        }
    };
    Ok((figures, why))
}

/// The job's tool by its sizes.
fn tool(job: &Job) -> Tool {
    let (shape, diameter_mm, length_mm) = match job.cutter_spec() {
        CutterSpec::Ball { diameter_mm, length_mm } => (Shape::Ball, diameter_mm, length_mm),
        CutterSpec::Flat { diameter_mm, length_mm } | CutterSpec::Cylindrical { diameter_mm, length_mm } => {
            (Shape::Flat, diameter_mm, length_mm)
        }
        CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm } => {
            (Shape::Toroidal { corner_radius_mm }, diameter_mm, length_mm)
        }
        CutterSpec::Cone { diameter_mm, taper_deg, corner_radius_mm, tip_diameter_mm, length_mm } => {
            (Shape::Cone { taper_deg, corner_radius_mm, tip_diameter_mm }, diameter_mm, length_mm)
        }
        CutterSpec::Barrel { diameter_mm, barrel_radius_mm, corner_radius_mm, length_mm } => {
            (Shape::Barrel { barrel_radius_mm, corner_radius_mm }, diameter_mm, length_mm)
        }
        CutterSpec::Apt { diameter_mm, corner_radius_mm, bottom_angle_deg, side_angle_deg, length_mm } => {
            (Shape::Apt { corner_radius_mm, bottom_angle_deg, side_angle_deg }, diameter_mm, length_mm)
        }
    };
    // The verification takes the whole length as cutting where it looks at faces.
    Tool {
        shape,
        diameter_mm,
        length_mm,
        flute_mm: None,
        holder: job
            .tool()
            .holder_sections()
            .iter()
            .map(|h| HolderPart {
                diameter_mm: h.diameter_mm,
                upper_diameter_mm: h.upper_diameter_mm.unwrap_or(h.diameter_mm),
                length_mm: h.length_mm,
            })
            .collect(),
    }
}

/// Points of all faces that are looked at, with their normals.
fn points(job: &Job, part: &Part) -> Vec<PartPoint> {
    let out_mm = job.strategy().layers().filter(|_| rough::is(job)).map_or(0.0, |l| l.allowance_mm);
    let mut points = Vec::new();
    for (faces, machined, count) in [(&part.faces, true, POINTS[0]), (&part.check, false, POINTS[1])] {
        let whole: f64 = faces.iter().map(area).sum();
        let apart_mm = (whole / count).sqrt();
        for face in faces {
            let number = points.last().map_or(0, |p: &PartPoint| p.face + 1);
            lattice(face, apart_mm, |at, normal| {
                let out = if machined { out_mm } else { 0.0 };
                let at = [0, 1, 2].map(|k| at[k] + out * normal[k]);
                points.push(PartPoint { face: number, machined, at, normal });
            });
        }
    }
    points
}

/// Places of a face about so far apart along its parameters.
fn lattice(face: &LoadedFace, apart_mm: f64, mut see: impl FnMut([f64; 3], [f64; 3])) {
    let surface: &dyn Surface = &*face.surface;
    let domain = surface.domain();
    let share = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
    // The longest line of each parameter says how many places it takes.
    let mut longest = [0.0f64; 2];
    for i in 0..LOOKS {
        for j in 0..LOOKS {
            let jet = surface.jet2(domain.at(share(i, LOOKS), share(j, LOOKS)));
            longest[0] = longest[0].max(jet.du.norm() * domain.u.length());
            longest[1] = longest[1].max(jet.dv.norm() * domain.v.length());
        }
    }
    let [nu, nv] = longest.map(|mm| (mm / apart_mm).ceil().clamp(3.0, MOST) as usize);
    for i in 0..nu {
        for j in 0..nv {
            let at = uv(domain.u.at(share(i, nu)), domain.v.at(share(j, nv)));
            if !surface.contains(at) {
                continue;
            }
            let jet = surface.jet2(at);
            if let Ok(normal) = jet.normal() {
                see(jet.point.coords.into(), normal.into_inner().into());
            }
        }
    }
}
