//! Ruled faces found, and free-form faces as ruled ones within a tolerance, in bands across.
//!
//! A face is ruled along one of its parameters where the lines of constant other parameter are straight; else its rules are
//! looked for between two opposite borders (`mates`). A face that is not ruled within the tolerance is cut
//! across its rules into bands, halved until each is: the error of a band falls with the square of its width.

use super::asked::{Band, RulingError, RulingOptions};
use super::mates::{Mate, Segments, chain, distance};
use super::surface::ruled;
use crate::fit::{Ends, Spacing, interpolate};
use crate::nurbs::NurbsSurface;
use osculate_geom::{Axis, Interval, Point3, Surface, Uv, uv};

/// What a face is, as far as straight lines go.
#[derive(Clone, Debug)]
pub enum Ruling {
    /// The lines along which the parameter `along` stays are straight: the rules, to rounding.
    Straight {
        /// The parameter that varies along the directrices.
        along: Axis,
        /// Greatest distance measured from the chords, mm.
        error_mm: f64,
    },
    /// Rules were found that stay within the tolerance.
    Found(RuledBand),
    /// There are none within the tolerance; the best there are.
    NotRuled(RuledBand),
}

/// A band with rules and the ruled surface over it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RuledBand {
    /// Which part of the face.
    pub band: Band,
    /// The rules, in rising order.
    pub mates: Vec<Mate>,
    /// The ruled surface: u along the directrices from 0 to 1, v along the rules from 0 to 1.
    pub surface: NurbsSurface,
    /// Greatest distance of the ruled surface from the face, mm, measured between the rules too.
    pub error_mm: f64,
}

/// A straight line of a parameter deviates from its chord by at most this fraction of the face's size: rounding.
const STRAIGHT: f64 = 1e-12;

fn check(surface: &dyn Surface, how: &RulingOptions) -> Result<(), RulingError> {
    let option = |what, got, need| Err(RulingError::Option { what, got, need });
    if !(how.tolerance_mm > 0.0 && how.tolerance_mm.is_finite()) {
        return option("tolerance_mm", how.tolerance_mm, "positive and finite");
    }
    if !(4..=1024).contains(&how.rules) {
        return option("rules", how.rules as f64, "from 4 to 1024");
    }
    if !(1..=256).contains(&how.checks) {
        return option("checks", how.checks as f64, "from 1 to 256");
    }
    for axis in [Axis::U, Axis::V] {
        let Interval { lo, hi, .. } = surface.domain().get(axis);
        if !(hi > lo && (hi - lo).is_finite()) {
            return Err(RulingError::Range { axis, lo, hi });
        }
    }
    Ok(())
}

/// Greatest distance of the lines across from their chords, and the size of the face.
fn straightness(surface: &dyn Surface, along: Axis, how: &RulingOptions) -> (f64, f64) {
    let domain = surface.domain();
    let (range, across) = (domain.get(along), domain.get(along.other()));
    let (mut worst, mut size) = (0.0f64, 0.0f64);
    let n = 2 * how.rules;
    for i in 0..=n {
        let t = range.at(i as f64 / n as f64);
        let at = |share: f64| surface.point(Uv::from_axis(along, t, across.at(share)));
        let (a, b) = (at(0.0), at(1.0));
        let chord = b - a;
        size = size.max(chord.norm());
        let Some(d) = osculate_geom::Unit3::try_new(chord, 0.0) else { return (f64::INFINITY, size) };
        for k in 1..=how.checks {
            let w = at(k as f64 / (how.checks + 1) as f64) - a;
            let off = w.cross(&d).norm();
            // NaN counts as far off.
            worst = if off <= worst { worst } else { off };
        }
    }
    (worst, size)
}

/// The ruled surface over mates, with its error measured at twice as many rules and between the places checked.
fn over(
    surface: &dyn Surface,
    band: Band,
    mates: Vec<Mate>,
    how: &RulingOptions,
) -> Result<RuledBand, RulingError> {
    let along = surface.domain().get(band.along);
    let low: Vec<Point3> = mates.iter().map(|m| border_at(surface, &band, 0, m.at_low)).collect();
    let high: Vec<Point3> = mates.iter().map(|m| border_at(surface, &band, 1, m.at_high)).collect();
    // The rules are evenly spread over the first border: one parameter for both directrices.
    let curve = |points: &[Point3]| interpolate(points, 3, Spacing::Uniform, &Ends::Free).map(|f| f.curve);
    let made = ruled(&curve(&low)?, &curve(&high)?)?;
    let n = mates.len() - 1;
    let mut error_mm = 0.0f64;
    for i in 0..=4 * n {
        let t = i as f64 / (4 * n) as f64;
        let cell = (i / 4).min(n - 1);
        let part = t * n as f64 - cell as f64;
        let mix = |a: f64, b: f64| a + (b - a) * part;
        let ends = [
            mix(mates[cell].at_low, mates[cell + 1].at_low),
            mix(mates[cell].at_high, mates[cell + 1].at_high),
        ];
        for k in 0..=2 * (how.checks + 1) {
            let v = k as f64 / (2 * (how.checks + 1)) as f64;
            let hint = Uv::from_axis(
                band.along,
                (ends[0] + (ends[1] - ends[0]) * v).clamp(along.lo, along.hi),
                band.across.at(v),
            );
            let p = made.point(uv(t, v));
            error_mm = error_mm.max(distance(surface, &p, hint)?);
        }
    }
    Ok(RuledBand { band, mates, surface: made, error_mm })
}

fn border_at(surface: &dyn Surface, band: &Band, end: usize, t: f64) -> Point3 {
    let across = if end == 0 { band.across.lo } else { band.across.hi };
    surface.point(Uv::from_axis(band.along, t, across))
}

fn ruled_band(surface: &dyn Surface, band: Band, how: &RulingOptions) -> Result<RuledBand, RulingError> {
    let segments = Segments { surface, band, checks: how.checks };
    let mates = chain(&segments, how)?;
    over(surface, band, mates, how)
}

/// Whether a face is ruled, within the tolerance, and its rules.
///
/// Trims are not looked at: the rules are those of the carrier's rectangle. Straight parameter lines are found first, in
/// either direction; then rules between opposite borders, those of less error.
///
/// ```
/// use osculate_geom::{Axis, Interval, analytic::Cylinder};
/// use osculate_surfaces::{Ruling, RulingOptions, gallery, ruling};
/// // A shaft is ruled along its axis: its directrices are the circles, along u. A bowl is not ruled.
/// let shaft = Cylinder::new(10.0, Interval::new(0.0, 50.0))?;
/// assert!(matches!(ruling(&shaft, &RulingOptions::default())?, Ruling::Straight { along: Axis::U, .. }));
/// assert!(matches!(ruling(&gallery::m86(3), &RulingOptions::default())?, Ruling::NotRuled(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RulingError`].
pub fn ruling(surface: &dyn Surface, how: &RulingOptions) -> Result<Ruling, RulingError> {
    check(surface, how)?;
    for along in [Axis::U, Axis::V] {
        let (error_mm, size) = straightness(surface, along, how);
        if error_mm <= STRAIGHT * size {
            return Ok(Ruling::Straight { along, error_mm });
        }
    }
    let mut best: Option<RuledBand> = None;
    for along in [Axis::U, Axis::V] {
        let across = surface.domain().get(along.other());
        let found = ruled_band(surface, Band { along, across }, how)?;
        if best.as_ref().is_none_or(|b| found.error_mm < b.error_mm) {
            best = Some(found);
        }
    }
    let best = best.expect("two directions were tried");
    Ok(if best.error_mm <= how.tolerance_mm { Ruling::Found(best) } else { Ruling::NotRuled(best) })
}

/// A face as ruled bands within the tolerance, rules running across `along`: each band's rules are the best found for it,
/// its error is measured.
///
/// # Errors
/// [`RulingError`]; [`RulingError::TooMany`] where the bands allowed are not enough.
pub fn ruled_bands(
    surface: &dyn Surface,
    along: Axis,
    how: &RulingOptions,
) -> Result<Vec<RuledBand>, RulingError> {
    check(surface, how)?;
    let whole = surface.domain().get(along.other());
    // Bands between breaks: a band over a crease would follow neither side.
    let mut open: Vec<Interval> = surface
        .breaks(along.other())
        .windows(2)
        .map(|w| Interval::new(w[0].max(whole.lo), w[1].min(whole.hi)))
        .filter(|i| i.hi > i.lo)
        .collect();
    open.reverse();
    let mut done: Vec<RuledBand> = Vec::new();
    while let Some(across) = open.pop() {
        let made = ruled_band(surface, Band { along, across }, how)?;
        if made.error_mm <= how.tolerance_mm {
            done.push(made);
            continue;
        }
        let bands = done.len() + open.len() + 1;
        if bands >= how.most_bands {
            return Err(RulingError::TooMany {
                bands,
                tolerance_mm: how.tolerance_mm,
                error_mm: made.error_mm,
                across: along.other(),
                lo: across.lo,
                hi: across.hi,
            });
        }
        let middle = across.at(0.5);
        open.push(Interval::new(middle, across.hi));
        open.push(Interval::new(across.lo, middle));
    }
    Ok(done)
}
