//! What stands too high on the finished part: by face, with its area, its highest place, and what would do.

use crate::job::{Job, Operations};
use crate::part::Part;
use crate::report::{Column, Table};
use crate::words::{self, number};
use crate::work::operations::step::Step;
use crate::work::verify::Verified;
use osculate_geom::{Point3, Surface, Unit3};
use osculate_tools::removal::Sample;
use serde::Serialize;

/// Within this of upright, as the cosine between normal and kept axis, a wall is: rows along the axis miss it, waterlines do not.
const UPRIGHT: f64 = 0.02;
/// A ball is to be smaller than the hollow that it goes into by this much.
const WITHIN: f64 = 0.9;
/// Faces that a row names at most.
pub const LISTED: usize = 12;
/// Areas below this are told as nothing, mm2.
const LEAST_MM2: f64 = 1e-6;

/// What stands too high on a face.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct LeftStanding {
    /// The face.
    pub face: String,
    /// The area, mm2.
    pub area_mm2: f64,
    /// The highest, mm.
    pub highest_mm: f64,
    /// Whether it is as high as was looked at, or higher.
    pub or_more: bool,
    /// Where that is, part coordinates.
    pub at_mm: [f64; 3],
    /// Why, as far as it is seen, and what would do.
    pub why: String,
}

/// Faces on which too much stands for the same reason.
#[non_exhaustive]
pub struct Alike<'a> {
    /// The faces, that with most first.
    pub faces: Vec<&'a str>,
    /// The area on all of them, mm2.
    pub area_mm2: f64,
    /// The one with the highest place.
    pub highest: &'a LeftStanding,
}

impl Alike<'_> {
    /// How high it stands, mm, in words.
    pub fn highest_words(&self) -> String {
        let or_more = if self.highest.or_more { " or more" } else { "" };
        number(self.highest.highest_mm, 3) + or_more
    }
}

/// What stands by why it does, most of all first.
pub fn alike(left: &[LeftStanding]) -> Vec<Alike<'_>> {
    let mut out: Vec<Alike<'_>> = Vec::new();
    for l in left {
        match out.iter_mut().find(|a| a.highest.why == l.why) {
            Some(a) => {
                a.faces.push(&l.face);
                a.area_mm2 += l.area_mm2;
                if l.highest_mm > a.highest.highest_mm {
                    a.highest = l;
                }
            }
            None => out.push(Alike { faces: vec![&l.face], area_mm2: l.area_mm2, highest: l }),
        }
    }
    out.sort_by(|a, b| b.area_mm2.total_cmp(&a.area_mm2));
    out
}

/// What was seen of one face.
struct Seen {
    area_mm2: f64,
    /// Of it in hollows that no tool fits into, in such as look away from all axes that tools keep, and in walls upright along them
    /// that no waterlines go around.
    hollow_mm2: f64,
    away_mm2: f64,
    upright_mm2: f64,
    /// The smallest radius of those hollows, mm.
    radius_mm: f64,
    highest: (f64, Point3),
}

/// The faces of a part on which too much stands.
pub fn left(list: &Operations, part: &Part, steps: &[Step<'_>], whole: &Verified) -> Vec<LeftStanding> {
    let verdict = &whole.verdict;
    let (limit, looked_mm) = (list.whole().tolerance().scallop_mm, list.whole().layer_mm());
    let smallest = |job: &Job| job.cutter().corner_mm();
    let mut out = Vec::new();
    for (k, face) in part.faces.iter().enumerate() {
        let on_it: Vec<&Step<'_>> = steps
            .iter()
            .filter(|s| s.job.strategy().layers().is_none() && s.part.faces.iter().any(|f| f.id == face.id))
            .collect();
        let tool_mm = on_it.iter().map(|s| smallest(&s.job)).fold(f64::INFINITY, f64::min);
        let axes: Option<Vec<Unit3>> = on_it.iter().map(|s| s.kept_axis).collect();
        let waterlines = on_it.iter().any(|s| s.job.strategy().goes_around_walls());
        // How far a place looks along that of the kept axes which it looks along most.
        let lean = |s: &Sample| {
            let each = axes.iter().flatten().map(|a| s.normal.dot(a));
            if axes.is_some() { each.fold(f64::NEG_INFINITY, f64::max) } else { 1.0 }
        };
        let mut seen = Seen {
            area_mm2: 0.0,
            hollow_mm2: 0.0,
            away_mm2: 0.0,
            upright_mm2: 0.0,
            radius_mm: f64::INFINITY,
            highest: (0.0, Point3::origin()),
        };
        let own = verdict.samples().iter().zip(verdict.cuts()).filter(|(s, _)| s.face as usize == k);
        for (s, c) in own.filter(|(s, c)| !s.check_only && (c.by.is_none() || c.standoff_mm > limit)) {
            seen.area_mm2 += s.area_mm2;
            if c.standoff_mm > seen.highest.0 {
                seen.highest = (c.standoff_mm, s.point);
            }
            let bend = face.surface.jet2(s.uv).forms().map_or(0.0, |f| -f.principal().k_min);
            if bend * tool_mm > 1.0 {
                seen.hollow_mm2 += s.area_mm2;
                seen.radius_mm = seen.radius_mm.min(1.0 / bend);
            } else if lean(s) < -UPRIGHT {
                seen.away_mm2 += s.area_mm2;
            } else if lean(s) < UPRIGHT && !waterlines {
                seen.upright_mm2 += s.area_mm2;
            }
        }
        if seen.area_mm2 > LEAST_MM2 {
            out.push(LeftStanding {
                face: face.id.clone(),
                area_mm2: seen.area_mm2,
                highest_mm: seen.highest.0,
                or_more: seen.highest.0 >= looked_mm,
                at_mm: seen.highest.1.into(),
                why: why(&seen, tool_mm),
            });
        }
    }
    out.sort_by(|a, b| b.area_mm2.total_cmp(&a.area_mm2).then(a.face.cmp(&b.face)));
    out
}

fn why(seen: &Seen, tool_mm: f64) -> String {
    let beside_mm2 = seen.area_mm2 - seen.hollow_mm2 - seen.away_mm2 - seen.upright_mm2;
    if !tool_mm.is_finite() {
        return "no finishing goes there".to_owned();
    }
    if seen.hollow_mm2 >= seen.away_mm2.max(seen.upright_mm2).max(beside_mm2) {
        let diameter = number(2.0 * WITHIN * seen.radius_mm, 3);
        return format!(
            "hollow to a radius of {} mm: a ball of {diameter} mm in diameter would do",
            number(seen.radius_mm, 3)
        );
    }
    if seen.upright_mm2 >= seen.away_mm2.max(beside_mm2) {
        return "upright along the axes that tools keep: waterline_3c would do".to_owned();
    }
    if seen.away_mm2 >= beside_mm2 {
        return "looks away from the axes that tools keep: another setup, or axis = \"field\", would do"
            .to_owned();
    }
    format!(
        "beside other faces, which the smallest tool there, of radius {} mm, does not come past: a smaller or longer one, or \
         another way of the passes, would do",
        number(tool_mm, 3)
    )
}

/// As reports show it.
pub fn table(left: &[LeftStanding]) -> Table {
    let row = |a: &Alike<'_>| {
        let [x, y, z] = a.highest.at_mm.map(|x| number(x, 5));
        vec![
            words::listed(&a.faces, LISTED),
            number(a.area_mm2, 4),
            a.highest_words(),
            format!("{x}, {y}, {z}"),
            a.highest.why.clone(),
        ]
    };
    Table {
        caption: "What stands too high on the finished part".to_owned(),
        columns: ["faces", "area mm2", "highest mm", "where", "why, and what would do"]
            .map(|n| Column { name: n.to_owned(), ..Column::default() })
            .to_vec(),
        rows: alike(left).iter().map(row).collect(),
    }
}
