//! What a person sees of the tool's axes over the faces of a job: the fields that passes would have, and at single places every
//! direction with what keeps the tool from it.

use crate::failure::Failure;
use crate::figure::axes::{self as field_figure, Corners, Shown};
use crate::figure::directions::Named;
use crate::figure::{Study, sheet};
use crate::job::Job;
use crate::job::strategy::Kind;
use crate::part::{LoadedFace, Part};
use crate::watch::{Stage, Watch};
use crate::work::axes::{self, Fields, Told};
use crate::work::axis_places::{self, PlaceFigures};
use crate::work::budget::{self, Shares};
use crate::work::passes::each_direction;
use crate::work::setup;
use osculate_geom::{Diagnostic, Surface, Unit3, Uv};
use osculate_postproc::Orienting;
use osculate_productivity::axis::{Possibilities, Wish};
use osculate_productivity::plan::{Along, Strategy};
use rayon::prelude::*;
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// Most cells that a face is painted with.
const CELLS: usize = 4000;
/// Sticks along a parameter at most.
const STICKS: usize = 12;

/// What is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The face, by its id; all faces of the job where not given.
    pub face: Option<&'a str>,
    /// Places of it by u and v; the middle of each face and the place with the fewest directions where there are none.
    pub at: &'a [[f64; 2]],
    /// Whether pictures are wanted.
    pub pictures: bool,
}

/// The axes over the faces of a job.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct AxesOverFaces {
    /// 1.
    pub format: u32,
    /// The tool in words.
    pub tool: String,
    /// Least and greatest lean off the normal that is asked for.
    pub lean_deg: [f64; 2],
    /// The faces.
    pub faces: Vec<FaceFigures>,
    /// Findings.
    #[serde(serialize_with = "in_words")]
    pub diagnostics: Vec<Diagnostic>,
    /// Pictures, by the names of their files.
    #[serde(skip)]
    pub pictures: Vec<(String, String)>,
}

/// Findings as sentences.
fn in_words<S: Serializer>(all: &[Diagnostic], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(all.iter().map(ToString::to_string))
}

/// The axes over a face.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct FaceFigures {
    /// Its id.
    pub face: String,
    /// Area of the face as the places of the field stand for it, as in the findings of a plan.
    pub area_mm2: f64,
    /// Area that no axis reaches.
    pub unreached_mm2: f64,
    /// The same by what stands in the way of the best of all axes.
    pub unreached: Vec<Why>,
    /// The field for each direction of passes that the job leaves open.
    pub fields: Vec<FieldFigures>,
    /// Places.
    pub places: Vec<PlaceFigures>,
    /// The file of its picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
}

/// A reason with the area that it is the reason of.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct Why {
    /// In words.
    pub what: String,
    /// The area.
    pub area_mm2: f64,
}

/// A field over a face.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct FieldFigures {
    /// The parameter that passes run along; absent where the strategy has another direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<&'static str>,
    /// Why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_field: Option<String>,
    /// Places that were asked.
    pub places_asked: usize,
    /// Those of them at which the field is not clear.
    pub places_not_clear: usize,
    /// Least and greatest lean off the normal where the face is reached; absent without a field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lean_deg: Option<[f64; 2]>,
    /// For each rotary joint its largest turn between neighbouring places, along the passes where their direction is a parameter's.
    pub largest_turns: Vec<Turn>,
}

/// The largest turn of a joint.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct Turn {
    /// The joint.
    pub joint: String,
    /// How far it turns.
    pub turn_deg: f64,
    /// Distance of the two places.
    pub over_mm: f64,
    /// The first of them.
    pub uv: [f64; 2],
}

impl AxesOverFaces {
    /// Whether every face has a field in some direction.
    #[must_use]
    pub fn all_have_fields(&self) -> bool {
        self.faces.iter().all(|f| f.fields.iter().any(|f| f.no_field.is_none()))
    }
}

/// The strategies whose fields a job may have, one for each direction that it leaves open.
///
/// # Errors
/// Where the tool keeps its axis or is led otherwise.
pub fn strategies(job: &Job) -> Result<Vec<Strategy>, Failure> {
    let strategy = job.strategy();
    match strategy.kind {
        Kind::Auto => Ok(each_direction(Strategy::Isoparametric { along: Along::Auto })),
        Kind::Faces(one) if strategy.kept_axis().is_none() => Ok(each_direction(one)),
        _ => {
            let why = format!(
                "kind = \"{}\" has no field of axes to look at: take a strategy whose tool leans along its passes, such as regions, \
                 isoparametric or auto",
                strategy.name()
            );
            Err(job.refuse("strategy", "kind", why))
        }
    }
}

/// The faces that are asked for, with their places among those of the job.
fn chosen<'a>(part: &'a Part, asked: &Asked<'_>) -> Result<Vec<(usize, &'a LoadedFace)>, Failure> {
    let all: Vec<(usize, &LoadedFace)> = part.faces.iter().enumerate().collect();
    let Some(id) = asked.face else {
        if !asked.at.is_empty() && all.len() > 1 {
            let text = format!("--at is on one face, and the job has {}: say which with --face", all.len());
            return Err(Failure::Usage(text));
        }
        return Ok(all);
    };
    part.part.face(id)?;
    let own = all.iter().find(|(_, f)| f.id == id).copied();
    let ids = || all.iter().map(|(_, f)| f.id.as_str()).collect::<Vec<_>>();
    let other = || {
        let what = format!("{id} is not among the faces that the job machines: {}", ids().join(", "));
        Failure::at("--face", what)
    };
    own.map(|one| vec![one]).ok_or_else(other)
}

/// Finds the axes over the faces of a job with the tool in hand.
///
/// # Errors
/// For a face or a place that is not there, a strategy without a field, and where the machine has no axis at all. A face that no axis reaches is
/// none.
pub fn of_job(
    job: &Job,
    part: &Part,
    asked: &Asked<'_>,
    watch: &dyn Watch,
) -> Result<AxesOverFaces, Failure> {
    part.part.to_plan(job.path())?;
    let strategies = strategies(job)?;
    let chosen = chosen(part, asked)?;
    let mut places = Vec::new();
    for at in asked.at {
        let (_, face) = chosen[0];
        let place = face.at(*at)?;
        if !face.surface.contains(place) {
            let what =
                format!("{},{} is outside the trims of {}: nothing is cut there", at[0], at[1], face.id);
            return Err(Failure::at("--at", what));
        }
        places.push(place);
    }
    let look = Look { job, part, fields: Fields::default(), strategies, pictures: asked.pictures };
    let mut out = AxesOverFaces {
        format: 1,
        tool: job.tool_words(),
        lean_deg: axes::leans_rad(&job.cutter()).map(f64::to_degrees),
        faces: Vec::new(),
        diagnostics: part.part.diagnostics.clone(),
        pictures: Vec::new(),
    };
    if !job.strategy().axis_field {
        let text = "the job does not ask for axis = \"field\": these are the axes that one would have";
        out.diagnostics.push(Diagnostic::note("strategy", text));
    }
    let stage = Stage::begin(watch, "axes");
    for (k, one) in chosen.iter().enumerate() {
        stage.at(k as f64 / chosen.len() as f64);
        let face = look.face(*one, &places, &mut out)?;
        out.faces.push(face);
    }
    stage.end();
    Ok(out)
}

/// What is looked at.
pub(super) struct Look<'a> {
    pub job: &'a Job,
    pub part: &'a Part,
    pub fields: Fields,
    pub strategies: Vec<Strategy>,
    pub pictures: bool,
}

/// What is possible over a face.
struct Possible {
    figures: FaceFigures,
    corners: Corners,
    /// The normals in the middles of cells within the trims; None outside them and where no axis is possible.
    normals: Vec<Option<Unit3>>,
    /// Whether the face is there and some axis is possible, at each corner.
    reached: Vec<bool>,
    unreached: field_figure::Unreached,
    fewest: Option<Uv>,
}

/// The name of a direction of passes.
fn passes(along: &str) -> String {
    if along.is_empty() { "the job's passes".to_owned() } else { format!("passes along {along}") }
}

impl Look<'_> {
    fn face(
        &self,
        one: (usize, &LoadedFace),
        places: &[Uv],
        out: &mut AxesOverFaces,
    ) -> Result<FaceFigures, Failure> {
        let (job, part, (_, face)) = (self.job, self.part, one);
        let tolerance = budget::leaning(job, part, Shares::WHOLE);
        let mut possible = self
            .fields
            .asked(job, part, one, tolerance, |all, wish| Ok(Possible::of(part, face, all, wish)))?;
        let mut fields: Vec<(&'static str, Result<Arc<Told>, Failure>)> = Vec::new();
        for strategy in &self.strategies {
            let along = axes::direction(strategy);
            fields.push((along, self.fields.of(job, part, one, (tolerance, strategy))));
        }
        let mut shown = Vec::new();
        for (along, found) in &fields {
            match found {
                Ok(told) => {
                    let (figures, drawn) = self.field(along, face, told, &possible);
                    possible.figures.fields.push(figures);
                    shown.push(drawn);
                    // The same of all directions is said once.
                    let new = told.1.iter().filter(|d| !out.diagnostics.contains(d)).cloned();
                    let new: Vec<Diagnostic> = new.collect();
                    out.diagnostics.extend(new);
                }
                Err(why) => {
                    possible.figures.fields.push(FieldFigures::none(along, why));
                    let lean_deg = vec![f64::NAN; possible.normals.len()];
                    shown.push(Shown { passes: passes(along), lean_deg, sticks: Vec::new() });
                }
            }
        }
        let places = if places.is_empty() { possible.own_places(face) } else { places.to_vec() };
        for at in places {
            let number = possible.figures.places.len() + 1;
            let named = |name: &str, told: &Told| {
                let name = if fields.len() > 1 { name.to_owned() } else { "field".to_owned() };
                Named { name, axis: told.0.field.at(at).0, clear: true }
            };
            let axes = fields.iter().filter_map(|(name, found)| Some(named(name, found.as_deref().ok()?)));
            let (figures, picture) = axis_places::look(self, one, (tolerance, at), (number, axes.collect()))?;
            possible.figures.places.push(figures);
            out.pictures.extend(picture);
        }
        if self.pictures {
            let refuse = |e| Failure::file(job.path(), format!("{}: {e}", face.id));
            let study = Study::to_paint(&face.surface, face.nurbs()).map_err(refuse)?;
            let scene = sheet::beside_bar(&study, None);
            let name = format!("{}, {}", face.id, out.tool);
            let corners = (&*face.surface, &possible.corners);
            let page = field_figure::page((&study, &scene, &name), corners, &shown, &possible.unreached);
            let file = format!("field-{}.svg", face.id);
            out.pictures.push((file.clone(), page));
            possible.figures.picture = Some(file);
        }
        Ok(possible.figures)
    }

    /// The figures of a field, and what is drawn of it.
    fn field(
        &self,
        along: &'static str,
        face: &LoadedFace,
        (found, _): &Told,
        possible: &Possible,
    ) -> (FieldFigures, Shown) {
        let middles = possible.corners.middles();
        let lean = |(at, normal): (&Uv, &Option<Unit3>)| {
            normal.map_or(f64::NAN, |n| found.field.at(*at).0.angle(&n).to_degrees())
        };
        let lean_deg: Vec<f64> = middles.iter().zip(&possible.normals).map(lean).collect();
        let range = lean_deg.iter().filter(|l| l.is_finite()).fold(None, |range: Option<[f64; 2]>, l| {
            Some(range.map_or([*l; 2], |[a, b]| [a.min(*l), b.max(*l)]))
        });
        let [n, m] = possible.corners.count;
        let every = [n, m].map(|count| count.div_ceil(STICKS).max(1));
        let on = |k: &usize| (k / m) % every[0] == every[0] / 2 && (k % m) % every[1] == every[1] / 2;
        let sticks = (0..n * m).filter(on).filter(|k| possible.reached[*k]).map(|k| {
            let at = possible.corners.at[k];
            (face.surface.point(at), found.field.at(at).0)
        });
        let shown = Shown { passes: passes(along), sticks: sticks.collect(), lean_deg };
        let [places_not_clear, places_asked] = found.unsettled;
        let figures = FieldFigures {
            along: Some(along).filter(|a| !a.is_empty()),
            no_field: None,
            places_asked,
            places_not_clear,
            lean_deg: range,
            largest_turns: self.turns(along, face, found, possible),
        };
        (figures, shown)
    }

    /// The largest turns of the joints between neighbours.
    fn turns(
        &self,
        along: &str,
        face: &LoadedFace,
        found: &osculate_productivity::axis::Found,
        possible: &Possible,
    ) -> Vec<Turn> {
        let machine = &self.job.control().machine;
        let (setup, _) = setup::of(self.job, self.part, None);
        let joints = Orienting::new(machine, &setup.part_zero.rotation);
        let [n, m] = possible.corners.count;
        let at = &possible.corners.at;
        let axes: Vec<Unit3> = at.par_iter().map(|at| found.field.at(*at).0).collect();
        let (by_u, by_v) = (along != "v", along != "u");
        let right = (0..n * m).filter(|k| by_u && k / m + 1 < n).map(|k| (k, k + m));
        let up = (0..n * m).filter(|k| by_v && k % m + 1 < m).map(|k| (k, k + 1));
        let pairs: Vec<(usize, usize)> =
            right.chain(up).filter(|(a, b)| possible.reached[*a] && possible.reached[*b]).collect();
        let turns: Vec<[f64; 2]> = pairs
            .par_iter()
            .map(|(a, b)| joints.turns_rad(&axes[*a], &axes[*b]).unwrap_or_default())
            .collect();
        let largest = |(k, place): (usize, &usize)| {
            let ((a, b), turn) = pairs.iter().zip(&turns).max_by(|x, y| x.1[k].total_cmp(&y.1[k]))?;
            Some(Turn {
                joint: machine.joints()[*place].letter.clone(),
                turn_deg: turn[k].to_degrees(),
                over_mm: (face.surface.point(at[*b]) - face.surface.point(at[*a])).norm(),
                uv: [at[*a].u, at[*a].v],
            })
        };
        machine.rotary().iter().enumerate().filter_map(largest).collect()
    }
}

impl FieldFigures {
    /// Where there is none.
    fn none(along: &'static str, why: &Failure) -> Self {
        Self {
            along: Some(along).filter(|a| !a.is_empty()),
            no_field: Some(why.problem().what),
            places_asked: 0,
            places_not_clear: 0,
            lean_deg: None,
            largest_turns: Vec::new(),
        }
    }
}

impl Possible {
    fn of(part: &Part, face: &LoadedFace, all: &Possibilities, wish: &Wish<'_>) -> Self {
        let (count, at) = all.corners(CELLS);
        let corners = Corners { count, at };
        let on_face = |at: &Uv| face.surface.contains(*at) && all.reaches(*at);
        let normal = |at: &Uv| if on_face(at) { all.normal(wish, *at) } else { None };
        let by = axes::unreached_mm2(part, all.unreached());
        let unreached_mm2 = by.values().fold(0.0, |sum, mm2| sum + mm2);
        let figures = FaceFigures {
            face: face.id.clone(),
            area_mm2: all.area_mm2(),
            unreached_mm2,
            unreached: by.into_iter().map(|(what, area_mm2)| Why { what, area_mm2 }).collect(),
            fields: Vec::new(),
            places: Vec::new(),
            picture: None,
        };
        let places = all.unreached().iter().map(|u| u.point).collect();
        Self {
            figures,
            normals: corners.middles().par_iter().map(normal).collect(),
            reached: corners.at.par_iter().map(on_face).collect(),
            corners,
            unreached: field_figure::Unreached { places, area_mm2: unreached_mm2 },
            fewest: all.fewest(),
        }
    }

    /// The middle of the face, as far as it lies within its trims, and the place with the fewest directions.
    fn own_places(&self, face: &LoadedFace) -> Vec<Uv> {
        let d = face.surface.domain();
        let middle = d.at(0.5, 0.5);
        let off = |at: &Uv| {
            let [u, v] = [(at.u - middle.u) / d.u.length(), (at.v - middle.v) / d.v.length()];
            u.hypot(v)
        };
        let inside = self.corners.at.iter().filter(|at| face.surface.contains(**at));
        let near = || inside.min_by(|a, b| off(a).total_cmp(&off(b))).copied();
        let middle = if face.surface.contains(middle) { Some(middle) } else { near() };
        middle.into_iter().chain(self.fewest.filter(|f| middle != Some(*f))).collect()
    }
}
