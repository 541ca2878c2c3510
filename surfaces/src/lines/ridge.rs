//! Ridges: where a principal curvature is extreme along its own line of curvature.
//!
//! They are the zeros of [`Extremality`], found as contours of a signless field, and end at umbilics. A ridge on which
//! the larger of both curvatures in size is extreme in size is a *crest*: the line that eye and hand find.

use super::chart::Chart;
use super::contour::contours;
use super::course::Family;
use super::field::{Extremality, ScalarField};
use super::trace::{LineEnd, SurfacePolyline};
use super::umbilic::Umbilics;
use osculate_geom::{Axis, Uv, uv};

/// A ridge.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ridge {
    /// Which principal curvature is extreme.
    pub family: Family,
    /// Whether it is greatest (or smallest) across the ridge, at the ridge's middle.
    pub greatest: bool,
    /// Whether the curvature is the larger one in size and extreme in size, at the ridge's middle.
    pub crest: bool,
    /// The line. An end of kind [`LineEnd::Stop`] is the umbilic of that number.
    pub line: SurfacePolyline,
}

/// An end of a ridge is at an umbilic that is nearer than this many cells.
const AT_UMBILIC: f64 = 1.0;

/// The ridges of a face.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Ridges {
    /// The lines, those of k_1 first.
    pub lines: Vec<Ridge>,
    /// Pieces of the face in which there may be more than is found: its curvature is noise there.
    pub coarse_pieces: usize,
}

/// The ridges of both families.
#[must_use]
pub fn ridges(chart: &Chart, umbilics: &Umbilics) -> Ridges {
    let mut out = Ridges::default();
    for family in Family::ALL {
        if is_constant(chart, family) {
            continue;
        }
        let found = contours(chart, &Extremality { family }, &[0.0], None);
        out.coarse_pieces += found.coarse_pieces;
        for contour in found.lines {
            let mut line = contour.line;
            if line.points.len() < 2 {
                continue;
            }
            for last in [false, true] {
                meet_umbilic(chart, umbilics, &mut line, last);
            }
            let middle = line.points[line.points.len() / 2].at;
            let Some((greatest, crest)) = judge(chart, family, middle) else { continue };
            out.lines.push(Ridge { family, greatest, crest, line });
        }
    }
    out
}

/// Whether the family's curvature is constant along all its own lines but for rounding, as on a torus: then every line
/// is a ridge and none.
fn is_constant(chart: &Chart, family: Family) -> bool {
    let field = Extremality { family };
    let limit = field.zero(chart.scale());
    let value = |u: &f64, v: &f64| field.sample(chart.surface(), uv(*u, *v)).map_or(0.0, |s| s.value.abs());
    let (us, vs) = (chart.borders(Axis::U), chart.borders(Axis::V));
    us.iter().all(|u| vs.iter().all(|v| value(u, v) <= limit))
}

/// An end that the signless field left open, led on to the umbilic that it stopped at.
fn meet_umbilic(chart: &Chart, umbilics: &Umbilics, line: &mut SurfacePolyline, last: bool) {
    let side = usize::from(last);
    if line.ends[side] != LineEnd::Singular {
        return;
    }
    let tip = if last { line.points[line.points.len() - 1] } else { line.points[0] };
    let found = umbilics
        .points
        .iter()
        .enumerate()
        .map(|(k, u)| (k, u, (u.point - tip.point).norm()))
        .filter(|(.., far)| *far <= AT_UMBILIC * chart.tolerance().cell_mm)
        .min_by(|a, b| a.2.total_cmp(&b.2));
    if let Some((k, u, _)) = found {
        let p = super::trace::LinePoint { at: u.at, point: u.point };
        if last {
            line.points.push(p);
        } else {
            line.points.insert(0, p);
        }
        line.ends[side] = LineEnd::Stop(k);
    }
}

/// Whether the family's curvature is greatest across the ridge, and whether the ridge is a crest, by its values a
/// tenth of a cell to both sides.
fn judge(chart: &Chart, family: Family, at: Uv) -> Option<(bool, bool)> {
    let surface = chart.surface();
    let jet = surface.jet2(at);
    let forms = jet.forms().ok()?;
    let p = forms.principal();
    let (k, d) = family.of(&p);
    let rate = forms.rate(&jet, &d);
    let h = 0.1 * chart.tolerance().cell_mm;
    let beside = |s: f64| {
        let forms = surface.jet2(uv(at.u + s * rate.u, at.v + s * rate.v)).forms().ok()?;
        Some(family.of(&forms.principal()).0)
    };
    let bend = beside(h)? + beside(-h)? - 2.0 * k;
    let other = p.k_max + p.k_min - k;
    let greatest = bend < 0.0;
    let crest = k.abs() > other.abs() && (greatest == (k > 0.0));
    Some((greatest, crest))
}
