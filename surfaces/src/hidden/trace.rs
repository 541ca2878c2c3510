//! Lines of intersection of two faces, marched from a place on them to where they leave either face or close.
//!
//! A step goes along `n_a x n_b` and is settled by Newton's method on both surfaces in the plane across it. It is as long as the
//! chord in the parameters of the first face stays within the chord tolerance of the line. Where a step would leave one of the
//! faces, the line ends on that segment of its border: there again both surfaces are met exactly.

use super::border::{Border, Crossing, Metric};
use super::sheet::{Across, Meet, Pair, between};
use osculate_geom::{Uv, Vec3};

/// Points of a line at most.
const POINTS: usize = 20_000;
/// Halvings of a step at most: it is then below rounding.
const HALVINGS: usize = 48;
/// Sine of the angle between the faces below which they touch rather than cross.
pub(super) const LEAST_SINE: f64 = 2e-3;
/// Cosine of the most that the line may turn in a step.
const TURN: f64 = 0.97;
/// Part of a step by which another one may miss the start and still come back to it.
const HOME: f64 = 0.2;
/// Neighbours of a segment that are tried where the line leaves beside it.
const BESIDE: usize = 4;

/// How a line is marched.
#[derive(Clone, Copy, Debug)]
pub(super) struct March {
    /// Greatest distance of its chords from the line, mm.
    pub(super) chord_mm: f64,
    /// Longest step, mm.
    pub(super) step_mm: f64,
}

/// A line of intersection.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Number of the other face.
    pub(super) other: usize,
    /// Its places; a closed one does not repeat the first.
    pub(super) places: Vec<Meet>,
    /// Whether it closes.
    pub(super) closed: bool,
}

/// Why a line could not be followed to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lost {
    /// The faces touch there.
    Touch,
    /// No step is short enough.
    Step,
    /// It has too many points.
    Long,
}

impl Lost {
    /// In words.
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::Touch => "they run into each other without an angle between them",
            Self::Step => "the line of intersection cannot be followed",
            Self::Long => "the line of intersection does not end",
        }
    }
}

/// The two faces that a line lies on.
pub(super) struct Faces<'a, 'b> {
    pub(super) pair: Pair<'a>,
    pub(super) borders: [&'b Border<'a>; 2],
}

/// How a march ended.
enum End {
    Closed,
    Left,
}

/// The line through a place on both faces.
pub(super) fn line(faces: &Faces<'_, '_>, other: usize, from: Meet, march: March) -> Result<Line, Lost> {
    let (mut places, end) = half(faces, from, 1.0, march)?;
    if matches!(end, End::Closed) {
        return Ok(Line { other, places, closed: true });
    }
    let (mut back, _) = half(faces, from, -1.0, march)?;
    back.reverse();
    back.pop();
    back.append(&mut places);
    Ok(Line { other, places: back, closed: false })
}

/// The places from one on, with or against the direction of the line.
fn half(faces: &Faces<'_, '_>, from: Meet, sense: f64, march: March) -> Result<(Vec<Meet>, End), Lost> {
    let along = |m: &Meet| faces.pair.along(m.at, LEAST_SINE).ok_or(Lost::Touch);
    let mut places = vec![from];
    let start = along(&from)? * sense;
    let (mut here, mut ahead) = (from, start);
    let mut step_mm = 0.1 * march.step_mm;
    while places.len() < POINTS {
        if places.len() > 2 && comes_home(faces, [&here, &from], [&ahead, &start], step_mm) {
            return Ok((places, End::Closed));
        }
        match step(faces, &here, &ahead, step_mm, march)? {
            Step::Left(last) => {
                places.push(last);
                return Ok((places, End::Left));
            }
            Step::To { place, ahead: next, next_mm } => {
                places.push(place);
                (here, ahead, step_mm) = (place, next, next_mm);
            }
        }
    }
    Err(Lost::Long)
}

/// Whether the start is just ahead, also in the parameters of the first face: there a seam lies between.
fn comes_home(
    faces: &Faces<'_, '_>,
    [here, start]: [&Meet; 2],
    [ahead, way]: [&Vec3; 2],
    step_mm: f64,
) -> bool {
    let to = start.point - here.point;
    let on = to.dot(ahead);
    let straight =
        on > 0.0 && on <= step_mm && (to - ahead * on).norm() <= HOME * on && way.dot(ahead) > TURN;
    let metric = Metric::new(&faces.pair.sheets[0].at(here.at[0]));
    straight && metric.to_segment(here.at[0], [start.at[0]; 2]).1 <= 1.5 * on
}

/// What a step comes to.
enum Step {
    To { place: Meet, ahead: Vec3, next_mm: f64 },
    Left(Meet),
}

fn step(
    faces: &Faces<'_, '_>,
    here: &Meet,
    ahead: &Vec3,
    longest_mm: f64,
    march: March,
) -> Result<Step, Lost> {
    let pair = &faces.pair;
    let mut step_mm = longest_mm;
    for _ in 0..HALVINGS {
        let guess = [0, 1].map(|k| {
            let t = pair.sheets[k].at(here.at[k]);
            pair.sheets[k]
                .step(&t, &(ahead * step_mm))
                .map(|d| osculate_geom::uv(here.at[k].u + d.u, here.at[k].v + d.v))
        });
        let [Some(a), Some(b)] = guess else { return Err(Lost::Step) };
        if let Some(last) = leaves(faces, here, ahead, [a, b], [step_mm, march.chord_mm]) {
            return Ok(Step::Left(last));
        }
        let plane = |f: f64| Across { through: here.point + ahead * (f * step_mm), normal: *ahead };
        let reached =
            pair.in_plane([a, b], &plane(1.0)).filter(|m| (m.point - here.point).norm() <= 2.0 * step_mm);
        let crossed = reached.map(|m| [0, 1].map(|k| faces.borders[k].crossing(here.at[k], m.at[k])));
        if let (Some(m), Some([None, None])) = (reached, crossed) {
            let next = pair.along(m.at, LEAST_SINE).ok_or(Lost::Touch)?;
            let next = if next.dot(ahead) < 0.0 { -next } else { next };
            let bent_mm = bend_mm(faces, here, &m, &plane(0.5));
            if next.dot(ahead) >= TURN && bent_mm.is_some_and(|b| b <= march.chord_mm) {
                let grow = (march.chord_mm / bent_mm.unwrap_or(0.0).max(1e-3 * march.chord_mm)).sqrt();
                let next_mm = (step_mm * (0.9 * grow).clamp(0.5, 2.0)).min(march.step_mm);
                return Ok(Step::To { place: m, ahead: next, next_mm });
            }
        } else if let (Some(m), Some(_)) = (reached, crossed)
            && let Some(last) = leaves(faces, here, ahead, m.at, [step_mm, march.chord_mm])
        {
            return Ok(Step::Left(last));
        }
        step_mm *= 0.5;
    }
    Err(Lost::Step)
}

/// How far the chord in the parameters of the first face is off the line in its middle, mm.
fn bend_mm(faces: &Faces<'_, '_>, here: &Meet, next: &Meet, plane: &Across) -> Option<f64> {
    let middle = [0, 1].map(|k| between(here.at[k], next.at[k], 0.5));
    let on = faces.pair.in_plane(middle, plane)?;
    let off = faces.pair.sheets[0].at(middle[0]).point - on.point;
    let along = plane.normal;
    Some((off - along * off.dot(&along)).norm())
}

/// Where the line leaves one of the faces on the way to parameters, if the step gets there.
fn leaves(
    faces: &Faces<'_, '_>,
    here: &Meet,
    ahead: &Vec3,
    to: [Uv; 2],
    [step_mm, chord_mm]: [f64; 2],
) -> Option<Meet> {
    let found = [0, 1].map(|k| faces.borders[k].crossing(here.at[k], to[k]));
    let first = match (&found[0], &found[1]) {
        (Some(a), Some(b)) => usize::from(b.way < a.way),
        (Some(_), None) => 0,
        (None, Some(_)) => 1,
        (None, None) => return None,
    };
    let last = on_border(faces, first, found[first].as_ref()?, here, to)?;
    let way = last.point - here.point;
    let on = way.dot(ahead);
    // Straight on, within the step, and with a chord that is good enough.
    let straight = (way - ahead * on).norm() <= 0.25 * on.abs() + faces.pair.close_mm;
    if !(straight && on >= -faces.pair.close_mm && on <= 1.5 * step_mm) {
        return None;
    }
    let plane = Across { through: here.point + ahead * (0.5 * on), normal: *ahead };
    let short = on <= chord_mm;
    (short || bend_mm(faces, here, &last, &plane).is_some_and(|b| b <= chord_mm)).then_some(last)
}

/// The place where the line meets the border of one of the faces, on a segment or beside it.
fn on_border(faces: &Faces<'_, '_>, which: usize, c: &Crossing, here: &Meet, to: [Uv; 2]) -> Option<Meet> {
    let border = faces.borders[which];
    let at = [0, 1].map(|k| between(here.at[k], to[k], c.way));
    let mut from = Meet { at, point: here.point };
    let chain = &border.loops[c.segment.chain];
    let home = border.ends(c.segment)[0];
    let shift = osculate_geom::uv(c.ends[0].u - home.u, c.ends[0].v - home.v);
    let mut first = c.segment.first;
    for _ in 0..=BESIDE {
        let ends = border.ends(super::border::Segment { chain: c.segment.chain, first });
        let ends = ends.map(|e| osculate_geom::uv(e.u + shift.u, e.v + shift.v));
        let (way, meet) = faces.pair.on_segment(which, ends, from)?;
        if (-1e-9..=1.0 + 1e-9).contains(&way) {
            return Some(meet);
        }
        from = meet;
        first = if way > 1.0 { (first + 1) % chain.len() } else { (first + chain.len() - 1) % chain.len() };
    }
    None
}
