//! The least time that passes over faces can take: `T = integral dA / E(P)`, E the greatest area per minute at a point.
//!
//! E is that of the best posture of the best tool ([`optimum`]), so that no plan whose passes touch the part within the
//! same tolerances is faster, whatever its lines: neighbouring strips overlap, feed directions are not free, links take
//! time. What it assumes: contact points move at the tool's feed; the tool touches the part and is not sunk into it; the
//! whole scallop tolerance goes to the strip; marks of single teeth, accelerations and the machine's joints cost nothing;
//! leads up to [`MOST_LEAD_RAD`] and the tilts of the [`Search`].
//!
//! *Error.* The integral is a sum over places, and [`Ideal::error_min`] its standard error, from the scatter of the places
//! about the plane through them. Parts of many faces are sampled: places then lie evenly by area over the faces in their
//! order, and some faces get none. The search at a place is a heuristic, and tools that a coarse look finds far behind another are not
//! searched; what is missed so makes the bound too long by as much. A dozen places tell a scatter to about a third: the error
//! is an indication, no guarantee.

mod lines;

pub use lines::isoparametric_min;

use crate::optimum::{self, Limits, OptimumError, Range};
use crate::plan::Tolerance;
use crate::rate::Caps;
use nalgebra::{Matrix2, Vector2};
use osculate_geom::{Surface, Uv};
use osculate_tools::strip::{Chart, Within};
use osculate_tools::{Cutter, Lean};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The greatest lead of a posture, rad.
pub const MOST_LEAD_RAD: f64 = 1.0;
/// The lead of a ball, whose strip does not depend on it.
const BALL_LEAD_RAD: f64 = 0.25;
/// Places a side of a face at least.
const LEAST_SIDE: usize = 2;
/// Steps of the sequence that fills a square evenly: powers of the root of x^3 = x + 1.
const FILL: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
/// Places of it that are tried to find one inside the trims.
const MOST_TRIES: usize = 60;

/// Directions and leads of the coarse look, and how far behind the best of it a tool may be, as a factor, to be searched.
const LOOK_DIRECTIONS: usize = 24;
const LOOK_LEADS_RAD: [f64; 12] = [0.003, 0.01, 0.02, 0.035, 0.05, 0.075, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8];
const BEHIND: f64 = 0.7;
/// Of how many of the widest strips the lead is searched closer, by a factor, and its roots after it.
const LOOK_CLOSER: usize = 8;
const LOOK_STEP: f64 = 1.2;
const LOOK_HALVINGS: u32 = 5;
/// Numbers that a plane takes from the places it is fitted to.
const FREE_OF_A_PLANE: f64 = 3.0;
/// Radius of its charts, in the cutter's radius, and misfit accepted, of the tolerance.
const LOOK_REACH: f64 = 1.2;
const LOOK_MISFIT: f64 = 0.1;

/// A cutter with the feed of its contact point.
#[derive(Clone, Copy)]
pub struct Feeding<'a> {
    /// The cutter.
    pub cutter: &'a Cutter,
    /// Its feed, mm/min.
    pub feed_mm_min: f64,
}

/// A face with its area.
#[derive(Clone, Copy)]
pub struct Patch<'a> {
    /// The face.
    pub surface: &'a dyn Surface,
    /// Its area, mm2.
    pub area_mm2: f64,
}

/// The bound over faces.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ideal {
    /// Least time, min.
    pub time_min: f64,
    /// Standard error of the sum over places, min.
    pub error_min: f64,
    /// Places at which the best posture was searched.
    pub places: usize,
    /// Area that no tool reaches, mm2; it counts as cut in no time.
    pub unreached_mm2: f64,
    /// For each tool the area where it is the best, mm2.
    pub best_mm2: Vec<f64>,
}

/// A place with its share of the face.
pub(crate) struct Place {
    pub at: Uv,
    pub area_mm2: f64,
    /// Row and column in the grid of the face.
    pub cell: [usize; 2],
}

/// About `count` places over a face, in the middles of equal parameter cells, with areas that add up to the face's.
pub(crate) fn places(patch: &Patch<'_>, count: usize) -> Vec<Place> {
    let side = ((count as f64).sqrt().round() as usize).max(LEAST_SIDE);
    let domain = patch.surface.domain();
    let mut out = Vec::with_capacity(side * side);
    for i in 0..side {
        for j in 0..side {
            let at = domain.at((i as f64 + 0.5) / side as f64, (j as f64 + 0.5) / side as f64);
            let jet = patch.surface.jet2(at);
            let area_mm2 = jet.du.cross(&jet.dv).norm();
            if patch.surface.contains(at) && area_mm2 > 0.0 {
                out.push(Place { at, area_mm2, cell: [i, j] });
            }
        }
    }
    let sum: f64 = out.iter().map(|p| p.area_mm2).sum();
    out.iter_mut().for_each(|p| p.area_mm2 *= patch.area_mm2 / sum);
    out
}

/// The places of all faces, each face's count by its area; of many faces only some have places.
pub(crate) fn shared_places(faces: &[Patch<'_>], count: usize) -> Vec<Vec<Place>> {
    let area: f64 = faces.iter().map(|f| f.area_mm2).sum();
    if faces.len() * LEAST_SIDE * LEAST_SIDE > count {
        return sampled_places(faces, count, area);
    }
    faces.iter().map(|f| places(f, (count as f64 * f.area_mm2 / area).round() as usize)).collect()
}

/// `count` places evenly by area over the faces in their order, each standing for as much area as any other; within a face
/// they follow a sequence that fills its parameter rectangle evenly.
fn sampled_places(faces: &[Patch<'_>], count: usize, area_mm2: f64) -> Vec<Vec<Place>> {
    let mut out: Vec<Vec<Place>> = faces.iter().map(|_| Vec::new()).collect();
    let share = area_mm2 / count as f64;
    let (mut face, mut before) = (0, 0.0);
    for k in 0..count {
        let at_mm2 = (k as f64 + 0.5) * share;
        while face + 1 < faces.len() && before + faces[face].area_mm2 <= at_mm2 {
            before += faces[face].area_mm2;
            face += 1;
        }
        let (surface, domain) = (faces[face].surface, faces[face].surface.domain());
        let tries = (0..MOST_TRIES).map(|m| {
            let part = |step: f64| (0.5 + step * (k + m * count) as f64).fract();
            domain.at(part(FILL[0]), part(FILL[1]))
        });
        let mut inside = tries.filter(|at| surface.contains(*at) && surface.jet2(*at).forms().is_ok());
        if let Some(at) = inside.next() {
            out[face].push(Place { at, area_mm2: share, cell: [k, 0] });
        }
    }
    out
}

/// How the bound is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Places in all, about.
    pub places: usize,
    /// Tilts; a single one makes the search some three times as fast.
    pub tilt: Range,
}

/// The bound over faces.
///
/// ```
/// use osculate_geom::{Domain, Interval, analytic::Plane};
/// use osculate_productivity::ideal::{Feeding, Patch, Search, ideal};
/// use osculate_productivity::{optimum::Range, plan::Tolerance};
/// use osculate_tools::{Cutter, CutterSpec};
///
/// let plane = Plane::new(Domain { u: Interval::new(0.0, 40.0), v: Interval::new(0.0, 40.0) });
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 })?;
/// let tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.005, chord_mm: 0.005 };
/// let faces = [Patch { surface: &plane, area_mm2: 1600.0 }];
/// let tools = [Feeding { cutter: &ball, feed_mm_min: 2000.0 }];
/// let bound = ideal(&faces, &tools, &tolerance, Search { places: 4, tilt: Range::only(0.0) })?;
/// // Area over feed times strip, 2 sqrt(h (2 R - h)).
/// let width_mm = 2.0 * f64::sqrt(0.02 * (10.0 - 0.02));
/// assert!((bound.time_min * 2000.0 * width_mm / 1600.0 - 1.0).abs() < 1e-3);
/// assert_eq!(bound.unreached_mm2, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`OptimumError`] of limits that are none and of an empty list of tools.
pub fn ideal(
    faces: &[Patch<'_>],
    tools: &[Feeding<'_>],
    tolerance: &Tolerance,
    search: Search,
) -> Result<Ideal, OptimumError> {
    if tools.is_empty() {
        return Err(OptimumError::NoTools);
    }
    for tool in tools {
        optimum::check(std::slice::from_ref(tool.cutter), &limits(tool, tolerance, search.tilt))?;
    }
    let places: Vec<(usize, Place)> = shared_places(faces, search.places)
        .into_iter()
        .enumerate()
        .flat_map(|(face, all)| all.into_iter().map(move |p| (face, p)))
        .collect();
    let best: Vec<Option<(usize, f64)>> = places
        .par_iter()
        .map(|(face, p)| best_at(faces[*face].surface, p.at, tools, (tolerance, search.tilt)))
        .collect();
    let mut out = Ideal {
        time_min: 0.0,
        error_min: 0.0,
        places: places.len(),
        unreached_mm2: 0.0,
        best_mm2: vec![0.0; tools.len()],
    };
    // Time per area at every place that a tool reaches, by face.
    let mut seen: Vec<Vec<Seen>> = faces.iter().map(|_| Vec::new()).collect();
    for ((face, p), best) in places.iter().zip(&best) {
        let pace = best.map_or(0.0, |(_, rate)| 1.0 / rate);
        seen[*face].push(Seen { area_mm2: p.area_mm2, pace, cell: p.cell.map(|c| c as f64) });
        out.time_min += p.area_mm2 * pace;
        match best {
            Some((tool, _)) => out.best_mm2[*tool] += p.area_mm2,
            None => out.unreached_mm2 += p.area_mm2,
        }
    }
    out.error_min = if faces.len() * LEAST_SIDE * LEAST_SIDE > search.places {
        // Sampled: the places follow each other by area.
        standard_error_min(&seen.concat())
    } else {
        seen.iter().map(|face| standard_error_min(face).powi(2)).sum::<f64>().sqrt()
    };
    Ok(out)
}

/// What was found at a place.
#[derive(Clone, Copy)]
struct Seen {
    area_mm2: f64,
    /// Least time per area, min/mm2.
    pace: f64,
    /// Row and column.
    cell: [f64; 2],
}

/// Standard error of the sum of area times pace: that of the scatter about the plane through the paces over the grid, which
/// the sum integrates exactly; about their mean where there are too few places for a plane.
fn standard_error_min(places: &[Seen]) -> f64 {
    let n = places.len() as f64;
    let area: f64 = places.iter().map(|p| p.area_mm2).sum();
    let mean = |of: &dyn Fn(&Seen) -> f64| places.iter().map(of).sum::<f64>() / n;
    let middle = [0, 1].map(|k| mean(&|p: &Seen| p.cell[k]));
    let pace = mean(&|p: &Seen| p.pace);
    let offset = |p: &Seen| Vector2::new(p.cell[0] - middle[0], p.cell[1] - middle[1]);
    let normal: Matrix2<f64> = places.iter().map(|p| offset(p) * offset(p).transpose()).sum();
    let right: Vector2<f64> = places.iter().map(|p| offset(p) * (p.pace - pace)).sum();
    let plane = normal.try_inverse().filter(|_| n > FREE_OF_A_PLANE).map(|inverse| inverse * right);
    let (slope, free) = plane.map_or((Vector2::zeros(), 1.0), |slope| (slope, FREE_OF_A_PLANE));
    let scatter = places.iter().map(|p| (p.pace - pace - slope.dot(&offset(p))).powi(2)).sum::<f64>();
    if n > free { area * (scatter / (n - free) / n).sqrt() } else { area * pace }
}

/// What the best posture of a tool keeps to, here and in pictures beside the bound.
#[must_use]
pub fn limits(tool: &Feeding<'_>, tolerance: &Tolerance, tilt: Range) -> Limits {
    let ball = tool.cutter.is_ball();
    Limits {
        scallop_mm: tolerance.scallop_mm,
        gouge_mm: tolerance.gouge_mm,
        lead: if ball {
            Range::only(BALL_LEAD_RAD)
        } else {
            Range { least_rad: 0.0, most_rad: MOST_LEAD_RAD }
        },
        tilt: if ball { Range::only(0.0) } else { tilt },
        axis: None,
        caps: Caps::of_feed(tool.feed_mm_min),
    }
}

/// The tool of the greatest area per minute at a place, mm2/min.
fn best_at(
    surface: &dyn Surface,
    at: Uv,
    tools: &[Feeding<'_>],
    (tolerance, tilt): (&Tolerance, Range),
) -> Option<(usize, f64)> {
    let seen: Vec<f64> = if tools.len() > 1 {
        tools.iter().map(|t| coarse_mm2_min(surface, at, t, tolerance)).collect()
    } else {
        vec![0.0]
    };
    let enough = BEHIND * seen.iter().copied().fold(0.0, f64::max);
    let mut best: Option<(usize, f64)> = None;
    for (k, tool) in tools.iter().enumerate().filter(|(k, _)| seen[*k] >= enough) {
        let found =
            optimum::at(surface, at, std::slice::from_ref(tool.cutter), &limits(tool, tolerance, tilt));
        if let Ok(o) = found
            && best.is_none_or(|b| o.rate.area_mm2_min > b.1)
        {
            best = Some((k, o.rate.area_mm2_min));
        }
    }
    best
}

/// Area per minute of the widest strip of a coarse look; zero where it finds none. Strips of two contacts are widest at a lead of their own,
/// a narrow peak that is searched between the leads looked at.
fn coarse_mm2_min(surface: &dyn Surface, at: Uv, tool: &Feeding<'_>, tolerance: &Tolerance) -> f64 {
    let reach = LOOK_REACH * tool.cutter.radius_mm();
    let Ok(chart) = Chart::new(surface, at, reach, LOOK_MISFIT * tolerance.scallop_mm) else { return 0.0 };
    let within = Within { scallop_mm: tolerance.scallop_mm, gouge_mm: tolerance.gouge_mm };
    let leads: &[f64] = if tool.cutter.is_ball() { &[BALL_LEAD_RAD] } else { &LOOK_LEADS_RAD };
    let width = |direction: usize, lead_rad: f64| {
        let angle_rad = TAU * direction as f64 / LOOK_DIRECTIONS as f64;
        let lean = Lean { lead_rad, tilt_rad: 0.0 };
        chart.strip(tool.cutter, angle_rad, lean, within).map_or(0.0, |strip| strip.width_mm)
    };
    let mut seen: Vec<(f64, usize, f64)> = (0..LOOK_DIRECTIONS)
        .flat_map(|k| leads.iter().map(move |lead| (k, *lead)))
        .map(|(k, lead)| (width(k, lead), k, lead))
        .collect();
    seen.sort_by(|a, b| b.0.total_cmp(&a.0));
    let closer = if leads.len() > 1 { LOOK_CLOSER } else { 1 };
    let peaks = seen.iter().take(closer).map(|(_, k, lead)| peak(|x| width(*k, x), *lead, LOOK_STEP));
    peaks.fold(0.0, f64::max) * tool.feed_mm_min
}

/// The greatest width near a lead, within about a factor.
fn peak(width: impl Fn(f64) -> f64, lead_rad: f64, mut factor: f64) -> f64 {
    let (mut most, mut lead) = (width(lead_rad), lead_rad);
    for _ in 0..LOOK_HALVINGS {
        for near in [lead / factor, lead * factor] {
            let here = width(near);
            if here > most {
                (most, lead) = (here, near);
            }
        }
        factor = factor.sqrt();
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_form::{Section, width_37};
    use osculate_geom::analytic::{Paraboloid, Sphere};
    use osculate_tools::CutterSpec;
    use std::f64::consts::PI;

    const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.002, chord_mm: 0.002 };

    const SEARCH: Search = Search { places: 16, tilt: Range::only(0.0) };

    fn ball(diameter_mm: f64) -> Cutter {
        Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm: 80.0 }).unwrap()
    }

    /// A ball on a sphere: every strip is the planar one of R97 (37).
    #[test]
    fn a_ball_on_a_sphere_has_a_closed_form() {
        let sphere = Sphere::new(30.0).unwrap();
        let area_mm2 = 4.0 * PI * 900.0;
        let (small, large) = (ball(6.0), ball(10.0));
        let tools = [&small, &large].map(|cutter| Feeding { cutter, feed_mm_min: 1500.0 });
        let found = ideal(&[Patch { surface: &sphere, area_mm2 }], &tools, &TOLERANCE, SEARCH).unwrap();
        let section = Section { part_per_mm: 1.0 / 30.0, tool_per_mm: 0.2, scallop_mm: TOLERANCE.scallop_mm };
        let expected = area_mm2 / (1500.0 * width_37(section).unwrap());
        // The share of the tolerance that goes to tooth marks anyway is 1e-4, half of that of the width.
        assert!((found.time_min / expected - 1.0).abs() < 2e-4, "{found:?} {expected}");
        assert!(found.error_min < 1e-4 * expected && found.unreached_mm2 == 0.0, "{found:?}");
        assert!((found.best_mm2[1] - area_mm2).abs() < 1e-6 * area_mm2 && found.best_mm2[0] == 0.0);
        // The slower tool loses where its feed is less by more than its strip is wider.
        let tools = [tools[0], Feeding { feed_mm_min: 1000.0, ..tools[1] }];
        let found = ideal(&[Patch { surface: &sphere, area_mm2 }], &tools, &TOLERANCE, SEARCH).unwrap();
        assert!(found.best_mm2[1] == 0.0, "{found:?}");
    }

    /// A ball under a dome: the sum over places against one over many more, with the error that it states.
    #[test]
    fn the_stated_error_is_that_of_the_sum() {
        let cutter = ball(12.0);
        let tools = [Feeding { cutter: &cutter, feed_mm_min: 1500.0 }];
        let mut off = Vec::new();
        for bend in [0.003, 0.012] {
            let dome = Paraboloid::new([bend, 0.2 * bend], 25.0).unwrap();
            let area_mm2 = 2500.0;
            let of = |places: usize| {
                let search = Search { places, ..SEARCH };
                ideal(&[Patch { surface: &dome, area_mm2 }], &tools, &TOLERANCE, search).unwrap()
            };
            let (few, many) = (of(16), of(144));
            let error = (few.time_min - many.time_min).abs();
            off.push(error / few.error_min);
            assert!(few.error_min > 0.0 && many.error_min < few.error_min, "{few:?} {many:?}");
        }
        // Within three standard errors, and not so wide that anything is.
        assert!(off.iter().all(|r| *r < 3.0) && off.iter().any(|r| *r > 0.02), "{off:?}");
    }

    /// Places that a symmetry maps onto each other still scatter.
    #[test]
    fn symmetric_places_have_an_error() {
        let at = |k: usize| {
            let cell = [(k / 4) as f64, (k % 4) as f64];
            let pace = 1.0 + 0.1 * ((cell[0] - 1.5).powi(2) - (cell[1] - 1.5).powi(2));
            Seen { area_mm2: 2.0, pace, cell }
        };
        let places: Vec<Seen> = (0..16).map(at).collect();
        // Paces 1 +- 0.2 at half of the places, 1 at the others: sum of squares 0.32, 13 free, 32 mm2.
        let expected = 32.0 * (0.32f64 / 13.0 / 16.0).sqrt();
        assert!((standard_error_min(&places) - expected).abs() < 1e-12, "{}", standard_error_min(&places));
        // A plane is integrated exactly.
        let tilted: Vec<Seen> =
            places.iter().map(|p| Seen { pace: 2.0 + p.cell[0] - 0.5 * p.cell[1], ..*p }).collect();
        assert!(standard_error_min(&tilted) < 1e-12);
    }

    /// Balls on spheres of two sizes, more of them than there are places: the sum is over area, not over faces.
    #[test]
    fn many_faces_are_sampled_by_area() {
        let radii: Vec<f64> = (0..40).map(|k| 8.0 + f64::from(k % 5)).collect();
        let spheres: Vec<Sphere> = radii.iter().map(|r| Sphere::new(*r).unwrap()).collect();
        let faces: Vec<Patch<'_>> = spheres
            .iter()
            .zip(&radii)
            .map(|(s, r)| Patch { surface: s, area_mm2: 4.0 * PI * r * r })
            .collect();
        let cutter = ball(6.0);
        let tools = [Feeding { cutter: &cutter, feed_mm_min: 1500.0 }];
        let found = ideal(&faces, &tools, &TOLERANCE, SEARCH).unwrap();
        let expected: f64 = radii
            .iter()
            .zip(&faces)
            .map(|(r, f)| {
                let scallop_mm = TOLERANCE.scallop_mm;
                let section = Section { part_per_mm: 1.0 / r, tool_per_mm: 1.0 / 3.0, scallop_mm };
                f.area_mm2 / (1500.0 * width_37(section).unwrap())
            })
            .sum();
        assert_eq!(found.places, SEARCH.places);
        assert!((found.time_min / expected - 1.0).abs() < 0.02, "{found:?} {expected}");
        assert!((found.time_min - expected).abs() < 3.0 * found.error_min + 2e-4 * expected, "{found:?}");
    }

    #[test]
    fn what_no_tool_reaches_is_named() {
        // Hollow with a radius of 10 mm in the middle, 12.8 mm in the corners, and a ball of 15.
        let bowl = Paraboloid::new([0.05, 0.05], 3.0).unwrap();
        let cutter = ball(30.0);
        let tools = [Feeding { cutter: &cutter, feed_mm_min: 1000.0 }];
        // Places nearer to the corners see less of the bowl.
        let search = Search { places: 9, ..SEARCH };
        let found = ideal(&[Patch { surface: &bowl, area_mm2: 36.0 }], &tools, &TOLERANCE, search).unwrap();
        assert!((found.unreached_mm2 - 36.0).abs() < 1e-9, "{found:?}");
        assert!(ideal(&[Patch { surface: &bowl, area_mm2: 36.0 }], &[], &TOLERANCE, search).is_err());
    }
}
