//! Every direction of a tool at one place of a face, with what keeps the tool from it.

use crate::failure::Failure;
use crate::figure::directions::{Kind, Map, Named};
use crate::part::LoadedFace;
use crate::report::legend::{KINDS, Rgb, UNKNOWN};
use crate::report::text::short;
use crate::work::axes;
use crate::work::axis_view::Look;
use osculate_geom::{Surface, Uv};
use osculate_productivity::axis::PlaceAxes;
use osculate_productivity::plan::Tolerance;
use osculate_tools::reach::{Barred, Directions, Member};
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// Where a direction is free, where the machine has none, and where cutter or holder meet what is none of the few that have a colour of
/// their own.
const FREE: Rgb = [0xd3, 0xec, 0xdb];
const NO_MACHINE: Rgb = [0x6b, 0x72, 0x7a];
const OTHERS: [Rgb; 2] = [[0x3a, 0x3a, 0x3a], [0x8a, 0x5a, 0x33]];

/// The directions at a place.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct PlaceFigures {
    /// Its parameters.
    pub uv: [f64; 2],
    /// The point of the face.
    pub point_mm: [f64; 3],
    /// Its outward normal; of a rough place the mean of those around it.
    pub normal: [f64; 3],
    /// How far the tool stands off the face, as nothing takes it down there.
    pub lift_mm: f64,
    /// Directions that lean off the normal by no more than a right angle.
    pub directions: usize,
    /// Those of them that are free.
    pub free: usize,
    /// Their share.
    pub free_percent: f64,
    /// What keeps the tool from the others, the most first.
    pub barred: Vec<Share>,
    /// Axes of the fields.
    pub axes: Vec<AxisFigures>,
    /// The file of the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
}

/// A share of the directions.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct Share {
    /// What keeps the tool from them, in words.
    pub what: String,
    /// The share of all that lean by no more than a right angle.
    pub percent: f64,
}

/// An axis of a field at a place.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct AxisFigures {
    /// The parameter that passes run along, or `field` where there is one field.
    pub passes: String,
    /// The axis, from the tip to the spindle.
    pub axis: [f64; 3],
    /// Its lean off the normal.
    pub lean_deg: f64,
    /// Whether the tool is clear there.
    pub clear: bool,
}

/// What becomes of a direction; in the order of legends but for obstacles, which go by their share.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fate {
    Free,
    /// A body of the tool, the cutter first, against a face or raw material.
    Meets(bool, u32),
    Lean,
    Machine,
}

impl Fate {
    fn of(barred: Option<&Barred>) -> Self {
        match barred {
            None => Self::Free,
            Some(Barred::Lean) => Self::Lean,
            Some(Barred::Machine) => Self::Machine,
            Some(Barred::Meets(met)) => Self::Meets(met.member != Member::Cutter, met.obstacle.owner),
        }
    }
}

/// The directions by their fate.
struct Counted {
    /// Rows of the legend, and the row of each direction.
    kinds: Vec<Kind>,
    kind_of: Vec<usize>,
    /// What keeps the tool from directions, one by one, the most first.
    barred: Vec<Share>,
    /// How many are counted, and those of them that are free.
    all: usize,
    free: usize,
}

/// Looks at a place, whose number is that among those of the face.
pub(super) fn look(
    look: &Look<'_>,
    one: (usize, &LoadedFace),
    (tolerance, at): (Tolerance, Uv),
    (number, mut axes): (usize, Vec<Named>),
) -> Result<(PlaceFigures, Option<(String, String)>), Failure> {
    let face = one.1;
    let found = look.fields.asked(look.job, look.part, one, tolerance, |all, wish| {
        let Some(place) = all.at(wish, at)? else { return Ok(None) };
        for named in &mut axes {
            named.clear = all.is_clear(wish, &place.place, &named.axis)?;
        }
        Ok(Some((place, all.directions().clone())))
    })?;
    let Some((place, directions)) = found else {
        let what = format!("{} has no normal at {},{}", face.id, at.u, at.v);
        return Err(Failure::at("--at", what));
    };
    let counted = count(look, &place, &directions);
    let file = look.pictures.then(|| format!("reach-{}-{number}.svg", face.id));
    let picture = file.clone().map(|file| (file, map(look, face, (&place, &directions), &counted, &axes)));
    let normal = place.place.normal;
    let point = face.surface.point(at);
    let of_field = |named: Named| AxisFigures {
        passes: named.name,
        axis: named.axis.into_inner().into(),
        lean_deg: named.axis.angle(&normal).to_degrees(),
        clear: named.clear,
    };
    let figures = PlaceFigures {
        uv: [at.u, at.v],
        point_mm: [point.x, point.y, point.z],
        normal: normal.into_inner().into(),
        lift_mm: place.lift_mm,
        directions: counted.all,
        free: counted.free,
        free_percent: counted.kinds[0].percent,
        barred: counted.barred,
        axes: axes.into_iter().map(of_field).collect(),
        picture: file,
    };
    Ok((figures, picture))
}

/// Counts the directions by their fate.
fn count(look: &Look<'_>, place: &PlaceAxes, directions: &Directions) -> Counted {
    let fates: Vec<Fate> = place.barred.iter().map(|b| Fate::of(b.as_ref())).collect();
    let counts = |k: &usize| directions.all()[*k].angle(&place.place.normal) <= FRAC_PI_2;
    let mut shares: BTreeMap<Fate, usize> = BTreeMap::new();
    for k in (0..fates.len()).filter(counts) {
        *shares.entry(fates[k]).or_default() += 1;
    }
    let all: usize = shares.values().sum();
    let percent = |n: usize| 100.0 * n as f64 / all.max(1) as f64;
    let mut met: Vec<(Fate, usize)> =
        shares.iter().filter(|(f, _)| matches!(f, Fate::Meets(..))).map(|(f, n)| (*f, *n)).collect();
    met.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    let of = |fate: Fate| shares.get(&fate).copied().unwrap_or(0);
    let [least, most] = axes::leans_rad(&look.job.cutter()).map(|l| short(l.to_degrees(), 2));
    let kind = |name: String, colour: Rgb, n: usize| Kind { name, colour, percent: percent(n) };
    let free = of(Fate::Free);
    let mut kinds = vec![kind("free".to_owned(), FREE, free)];
    let (own, others) = met.split_at(met.len().min(KINDS.len()));
    let owned = own.iter().zip(KINDS).map(|((fate, n), colour)| kind(name(look, place, *fate), colour, *n));
    kinds.extend(owned);
    let rest = kinds.len();
    for ((body, of_holder), colour) in [("cutter", false), ("holder", true)].into_iter().zip(OTHERS) {
        let own = || others.iter().filter(|(f, _)| matches!(f, Fate::Meets(h, _) if *h == of_holder));
        kinds.push(kind(format!("{body}: {} others", own().count()), colour, own().map(|(_, n)| n).sum()));
    }
    let limits = format!("lean not within {least}\u{b0} to {most}\u{b0}");
    kinds.push(kind(limits, UNKNOWN, of(Fate::Lean)));
    kinds.push(kind("out of the machine's range".to_owned(), NO_MACHINE, of(Fate::Machine)));
    let row = |fate: &Fate| match fate {
        Fate::Free => 0,
        Fate::Meets(of_holder, _) => {
            let place = own.iter().position(|(f, _)| f == fate);
            place.map_or(rest + usize::from(*of_holder), |k| 1 + k)
        }
        Fate::Lean => rest + 2,
        Fate::Machine => rest + 3,
    };
    let single = others.iter().map(|(fate, n)| kind(name(look, place, *fate), UNKNOWN, *n));
    let single: Vec<Kind> = single.collect();
    let named = kinds[1..rest].iter().chain(&single).chain(&kinds[rest + 2..]);
    let barred = named.filter(|k| k.percent > 0.0);
    let mut barred: Vec<Share> = barred.map(|k| Share { what: k.name.clone(), percent: k.percent }).collect();
    barred.sort_by(|a, b| b.percent.total_cmp(&a.percent));
    Counted { kind_of: fates.iter().map(row).collect(), kinds, barred, all, free }
}

/// What the tool meets, in words.
fn name(look: &Look<'_>, place: &PlaceAxes, fate: Fate) -> String {
    let met = place.barred.iter().flatten().find_map(|barred| match barred {
        Barred::Meets(met) if Fate::of(Some(barred)) == fate => Some(met),
        _ => None,
    });
    met.map_or_else(String::new, |met| axes::met(look.part, met).join(": "))
}

/// The map of a place.
fn map(
    look: &Look<'_>,
    face: &LoadedFace,
    (place, directions): (&PlaceAxes, &Directions),
    counted: &Counted,
    axes: &[Named],
) -> String {
    let jet = face.surface.jet2(place.at);
    let p = jet.point;
    let [u, v] = [place.at.u, place.at.v].map(|x| short(x, 5));
    let [x, y, z] = [p.x, p.y, p.z].map(|x| short(x, 5));
    let lifted = if place.lift_mm > 0.0 {
        format!("; nothing takes it down to the face: it stands {} mm off", short(place.lift_mm, 3))
    } else {
        String::new()
    };
    Map {
        title: format!("{} at u {u}, v {v}: tool axes, seen along the normal", face.id),
        notes: vec![
            format!("{}, at x {x}, y {y}, z {z} mm{lifted}", look.job.tool_words()),
            "colours: the body of the tool that comes too near to something, and what stands in the way first, from the tip".to_owned(),
        ],
        directions,
        kind_of: &counted.kind_of,
        kinds: &counted.kinds,
        normal: place.place.normal,
        tangents: [jet.du, jet.dv],
        axes,
        least: &place.least,
    }
    .svg()
}
