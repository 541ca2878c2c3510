//! The two cheap levels: strips at places, and what constant spacing makes of them.

use super::course::{Course, Level, courses, level};
use super::{Axes, Candidate, Reason, Screened, Setting};
use crate::ideal::{Place, shared_places};
use crate::plan::LocalLead;
use osculate_geom::{Axis, Forms, Jet2, Surface, Unit3};
use osculate_tools::strip::{self, Chart, ChartError, StripError, Within};
use osculate_tools::{Contact, Cutter, FeedLine, Lean};
use rayon::prelude::*;

/// Places over all faces, about.
const PLACES: usize = 72;
/// Radius of charts, in the cutter's radius, and misfit accepted, of the tolerance: ranking needs no more.
const REACH: f64 = 1.2;
const MISFIT: f64 = 0.1;
/// Share of the area where a candidate may fail before it is out. Below it the plan itself tells more than places do.
const BAD_SHARE: f64 = 0.1;

/// Rows that the distances of parallel planes are sorted into.
const ROWS: usize = 9;

/// What a candidate does at a place.
#[derive(Clone, Copy)]
enum There {
    /// Strip width, mm, and how fast the levels of the passes follow each other, 1/mm.
    Strip { width_mm: f64, across_per_mm: Option<f64> },
    /// Too large; the largest diameter that fits, zero for none.
    TooLarge(f64),
    /// The body, depth and face.
    Body(f64, usize),
    /// The holder.
    Holder(f64, usize),
    /// The place looks away from the axis.
    Away,
    /// Too much is left.
    NoStrip,
}

/// A place with its geometry.
struct Spot<'a> {
    face: usize,
    surface: &'a dyn Surface,
    place: Place,
    jet: Jet2,
    forms: Forms,
}

/// Screens candidates; the answers are in their order.
#[must_use]
pub fn screen(setting: &Setting<'_>, candidates: &[Candidate]) -> Vec<Screened> {
    let spots: Vec<Spot<'_>> = shared_places(setting.faces, PLACES)
        .into_iter()
        .enumerate()
        .flat_map(|(face, places)| {
            let surface = setting.faces[face].surface;
            places.into_iter().filter_map(move |place| {
                let jet = surface.jet2(place.at);
                // Without a tangent plane there is nothing to say.
                let forms = jet.forms().ok()?;
                Some(Spot { face, surface, place, jet, forms })
            })
        })
        .collect();
    let at_places: Vec<Vec<There>> = spots.par_iter().map(|spot| look(setting, spot, candidates)).collect();
    candidates
        .iter()
        .enumerate()
        .map(|(k, c)| {
            let there: Vec<There> = at_places.iter().map(|p| p[k]).collect();
            sum(setting, &spots, c, &there)
        })
        .collect()
}

/// All candidates at one place.
fn look(setting: &Setting<'_>, spot: &Spot<'_>, candidates: &[Candidate]) -> Vec<There> {
    let tolerance = setting.tolerance.scallop_mm;
    let charts: Vec<Option<Chart>> = setting
        .tools
        .iter()
        .map(|t| {
            Chart::new(spot.surface, spot.place.at, REACH * t.cutter.radius_mm(), MISFIT * tolerance).ok()
        })
        .collect();
    let one = |c: &Candidate| {
        let Some(chart) = &charts[c.tool] else { return There::NoStrip };
        let all = courses(c, &spot.jet, &spot.forms);
        let mut best = if all.is_empty() { There::Away } else { There::NoStrip };
        for course in all {
            let here = match c.axes {
                Axes::Held => posture(setting, spot, chart, c, &course),
                Axes::Field if setting.line.is_some() => on_line(setting, spot, chart, c, &course),
                Axes::Local | Axes::Balanced | Axes::Field => least(setting, spot, chart, c, &course),
            };
            best = better(best, here);
        }
        best
    };
    candidates.iter().map(one).collect()
}

/// The wider of two strips, or what there is of one, or else the second.
fn better(a: There, b: There) -> There {
    match (a, b) {
        (There::Strip { width_mm: x, .. }, There::Strip { width_mm: y, .. }) if y > x => b,
        (There::Strip { .. }, _) => a,
        _ => b,
    }
}

/// Axes to each side of the one nearest to the normal that are tried where the machine has but a line of them, by their place in it.
const BESIDE: [usize; 3] = [2, 6, 18];

/// The widest strip of the axes that a machine has which leaves them little choice, next to the normal.
fn on_line(
    setting: &Setting<'_>,
    spot: &Spot<'_>,
    chart: &Chart,
    candidate: &Candidate,
    course: &Course,
) -> There {
    let line = setting.line.unwrap_or_default();
    let (frame, n) = (chart.frame(course.angle_rad), spot.forms.normal);
    let nearest = (0..line.len()).max_by(|a, b| line[*a].dot(&n).total_cmp(&line[*b].dot(&n)));
    let Some(nearest) = nearest else { return There::Away };
    // A ball is the same with any axis. The last axis of a circle is the first again.
    let beside: &[usize] = if setting.tools[candidate.tool].cutter.is_ball() { &[] } else { &BESIDE };
    let places = beside.iter().flat_map(|k| [nearest + k, nearest + line.len() - k.min(&line.len())]);
    let tried = [nearest].into_iter().chain(places).map(|k| line[k % line.len()]);
    let there = tried.map(|axis| {
        if axis.dot(&n) <= 0.0 {
            return There::Away;
        }
        let lean = Lean::of(&axis, &frame);
        posture(setting, spot, chart, candidate, &Course { lean, ..*course })
    });
    there.reduce(better).unwrap_or(There::Away)
}

/// Quotient of leads that are tried where the lead is the least that fits, and halvings between the last two: strips of two contacts
/// are narrow peaks in the lead.
const STEP: f64 = 1.5;
const HALVINGS: u32 = 6;

/// The widest of the postures about the least lead that fits.
fn least(
    setting: &Setting<'_>,
    spot: &Spot<'_>,
    chart: &Chart,
    candidate: &Candidate,
    course: &Course,
) -> There {
    let with = |lead_rad: f64| {
        let lean = Lean { lead_rad, ..course.lean };
        posture(setting, spot, chart, candidate, &Course { lean, ..*course })
    };
    let fits = |there: &There| matches!(there, There::Strip { .. });
    let (mut low, mut high) = (None, course.lean.lead_rad);
    let mut best = with(high);
    while !fits(&best) && high > 0.0 && high < LocalLead::MOST_RAD {
        (low, high) = (Some(high), (high * STEP).min(LocalLead::MOST_RAD));
        best = with(high);
    }
    let Some(mut low) = low.filter(|_| fits(&best)) else { return best };
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let here = with(middle);
        if fits(&here) {
            (high, best) = (middle, better(best, here));
        } else {
            low = middle;
        }
    }
    best
}

fn posture(
    setting: &Setting<'_>,
    spot: &Spot<'_>,
    chart: &Chart,
    candidate: &Candidate,
    course: &Course,
) -> There {
    let tool = &setting.tools[candidate.tool];
    let t = &setting.tolerance;
    let within = Within { scallop_mm: t.scallop_mm, gouge_mm: t.gouge_mm };
    let too_large = || There::TooLarge(largest_mm(&spot.forms, tool.cutter, course.lean.lead_rad));
    let width_mm = match chart.strip(tool.cutter, course.angle_rad, course.lean, within) {
        Ok(s) if s.lift_mm == 0.0 => s.width_mm,
        // Lifted or above the part: the tool would dig in at the contact.
        Ok(_) | Err(ChartError::Above { .. }) => return too_large(),
        // Beyond the chart the exact strip tells.
        Err(ChartError::Beyond { .. }) => {
            let feed = FeedLine::Angle(course.angle_rad);
            let contact = Contact::new(spot.surface, spot.place.at, tool.cutter, feed, course.lean);
            match contact.map_err(StripError::from).and_then(|c| strip::exact(&c, t.scallop_mm)) {
                Ok(s) if s.undercut_mm <= t.gouge_mm => s.width_mm,
                Ok(_) | Err(StripError::AboveTolerance { .. }) => return too_large(),
                Err(_) => return There::NoStrip,
            }
        }
        Err(ChartError::Contact(_)) => return There::NoStrip,
    };
    let frame = chart.frame(course.angle_rad);
    let pose = course.lean.pose(tool.cutter, &frame, 0.0);
    if let Some((depth, face)) = setting.around.met(tool.cutter, &pose, t.gouge_mm + t.scallop_mm) {
        return There::Body(depth, face);
    }
    for (body, at) in tool.holder.iter().flat_map(|h| h.posed(tool.cutter, &pose)) {
        if let Some((depth, face)) = setting.around.met(body, &at, 0.0) {
            return There::Holder(depth, face);
        }
    }
    There::Strip { width_mm, across_per_mm: course.across_per_mm }
}

/// The largest diameter of this shape that fits at a lead, mm; zero where none does.
fn largest_mm(forms: &Forms, cutter: &Cutter, lead_rad: f64) -> f64 {
    let hollow = -forms.principal().k_min;
    if hollow <= 0.0 {
        return 0.0;
    }
    if cutter.is_ball() {
        return 2.0 / hollow;
    }
    let (s, r) = (lead_rad.sin().abs(), cutter.corner_mm());
    // Across the lean the tool's curvature is s / (core + r s), with core the outer radius less r.
    let radius = s / hollow - r * s + r;
    if r * hollow < 1.0 && radius > r { 2.0 * radius } else { 0.0 }
}

/// The sums over the places.
fn sum(setting: &Setting<'_>, spots: &[Spot<'_>], candidate: &Candidate, there: &[There]) -> Screened {
    let feed = setting.tools[candidate.tool].feed_mm_min;
    let area: f64 = spots.iter().map(|s| s.place.area_mm2).sum();
    let (mut good, mut bare_mm) = (0.0, 0.0);
    for (spot, t) in spots.iter().zip(there) {
        if let There::Strip { width_mm, .. } = t {
            good += spot.place.area_mm2;
            bare_mm += spot.place.area_mm2 / width_mm;
        }
    }
    let scaled = |x: f64| if good > 0.0 { x * area / good } else { f64::INFINITY };
    let layout_mm = match level(&candidate.strategy) {
        Level::Free => bare_mm,
        fixed => layout_mm(spots, there, fixed),
    };
    Screened {
        pointwise_min: scaled(bare_mm) / feed,
        layout_min: scaled(layout_mm) / feed,
        length_mm: scaled(layout_mm),
        // A field has other ways to lean than along the feed: what stands in the way then is told by its search.
        out: (area - good > BAD_SHARE * area)
            .then(|| reason(setting, spots, there, area))
            .filter(|why| candidate.axes != Axes::Field || matches!(why, Reason::TooLarge { .. })),
    }
}

/// Length of passes whose spacing is constant along each: row by row, the narrowest step sets it.
fn layout_mm(spots: &[Spot<'_>], there: &[There], fixed: Level) -> f64 {
    let row = |s: &Spot<'_>| match fixed {
        Level::Parameter(Axis::U) => s.place.cell[1],
        Level::Parameter(Axis::V) => s.place.cell[0],
        Level::Planes(normal) => plane_row(spots, s, &normal),
        Level::Free => 0,
    };
    // By face and row: the narrowest step of the levels, and the integral of their density.
    let mut rows: std::collections::BTreeMap<(usize, usize), (f64, f64)> = std::collections::BTreeMap::new();
    for (s, t) in spots.iter().zip(there) {
        if let There::Strip { width_mm, across_per_mm: Some(across) } = t {
            let r = rows.entry((s.face, row(s))).or_insert((f64::INFINITY, 0.0));
            r.0 = r.0.min(width_mm * across);
            r.1 += s.place.area_mm2 * across;
        }
    }
    rows.values().map(|(step, density)| density / step).sum()
}

fn plane_row(spots: &[Spot<'_>], spot: &Spot<'_>, normal: &Unit3) -> usize {
    let height = |s: &Spot<'_>| s.jet.point.coords.dot(normal);
    let all = || spots.iter().filter(|s| s.face == spot.face).map(height);
    let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
    let share = (height(spot) - low) / (high - low).max(f64::MIN_POSITIVE);
    ((share * ROWS as f64) as usize).min(ROWS - 1)
}

/// The reason that concerns most of the area.
fn reason(setting: &Setting<'_>, spots: &[Spot<'_>], there: &[There], area: f64) -> Reason {
    let share = |is: &dyn Fn(&There) -> bool| {
        let bad = spots.iter().zip(there).filter(|(_, t)| is(t)).map(|(s, _)| s.place.area_mm2);
        100.0 * bad.sum::<f64>() / area
    };
    let deepest = |of: &dyn Fn(&There) -> Option<(f64, usize)>| {
        there.iter().filter_map(of).fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a })
    };
    let body = |t: &There| if let There::Body(d, f) = t { Some((*d, *f)) } else { None };
    let holder = |t: &There| if let There::Holder(d, f) = t { Some((*d, *f)) } else { None };
    let large = |t: &There| matches!(t, There::TooLarge(_));
    let fits = there.iter().filter_map(|t| if let There::TooLarge(d) = t { Some(*d) } else { None });
    let (in_body, in_holder) = (deepest(&body), deepest(&holder));
    let face = |f: usize| setting.around.name(f).to_owned();
    let all = [
        Reason::TooLarge { percent: share(&large), largest_mm: fits.fold(f64::INFINITY, f64::min) },
        Reason::Body { percent: share(&|t| body(t).is_some()), depth_mm: in_body.0, face: face(in_body.1) },
        Reason::Holder {
            percent: share(&|t| holder(t).is_some()),
            depth_mm: in_holder.0,
            face: face(in_holder.1),
        },
        Reason::Away { percent: share(&|t| matches!(t, There::Away)) },
        Reason::NoStrip { percent: share(&|t| matches!(t, There::NoStrip)) },
    ];
    all.into_iter()
        .reduce(|a, b| if b.percent() > a.percent() { b } else { a })
        .expect("there are five kinds")
}

impl Reason {
    /// The share of the area that it concerns.
    const fn percent(&self) -> f64 {
        match self {
            Self::TooLarge { percent, .. }
            | Self::Body { percent, .. }
            | Self::Holder { percent, .. }
            | Self::Away { percent }
            | Self::NoStrip { percent } => *percent,
        }
    }
}
