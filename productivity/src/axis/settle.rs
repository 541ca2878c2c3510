//! Axes between the nodes: where the tool is not clear there the poles around are moved until it is.
//!
//! A place that is not clear looks for the nearest axis that is, in rings around its own, and draws the poles around it towards that
//! axis by what they lack. What stays unclear after some rounds is counted.

use super::field::AxisField;
use crate::plan::extended::Extended;
use osculate_geom::{Jet2, Point3, Surface, Unit3, Uv, Vec3, any_perpendicular};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Rounds of looking and moving.
const ROUNDS: u32 = 40;
/// Rings around an axis that is not clear, rad: the spacing of directions and what is finer.
const RINGS: [f64; 9] = [0.001, 0.0025, 0.005, 0.01, 0.02, 0.04, 0.08, 0.12, 0.16];
/// So many of them are finer than a ball needs.
const FINER: usize = 2;
/// Axes on a ring.
const AROUND: usize = 12;
/// Halvings between an axis that is not clear and one on a ring that is.
const HALVINGS: u32 = 8;
/// Poles move further than they must by this part, so that rounds end.
const BEYOND: f64 = 0.25;
/// A pole whose places weigh less in it than one in the middle of its piece does moves by less than these lack: others move it too.
const LEAST_WEIGHT: f64 = 0.44;

/// Up to so many times harder a place draws that was not clear before.
const HARDEST: f64 = 3.0;

/// An axis that was found for a place counts until the field has turned so far there, rad.
const KNOWN: f64 = 0.02;

/// Axes that are so near to each other count as the same, rad: a long tool differs by less than a micrometre.
const SAME: f64 = 5e-6;

/// A place that is asked.
#[derive(Clone, Copy)]
struct Asked {
    at: Uv,
    point: Point3,
    normal: Unit3,
    /// The normal off which its axis leans: next to ripples that of the face without them.
    upright: Unit3,
    /// An axis that is not clear and the nearest to it that is, where there is one: what was found last.
    known: Option<(Unit3, Option<Unit3>)>,
    /// The axis that was found clear last.
    clear: Option<Unit3>,
    /// How often it was not clear.
    short: u32,
}

impl Asked {
    /// Whether the tool is clear with an axis; if not, the nearest with which it is becomes known.
    fn is_clear(&mut self, axis: &Unit3, (clear, held, leaning): How<'_>) -> bool {
        if self.clear.is_some_and(|last| last.angle(axis) < SAME) {
            return true;
        }
        let is_clear = |a: &Unit3| clear(&self.point, &self.normal, a);
        self.clear = is_clear(axis).then_some(*axis);
        if self.clear.is_some() {
            return true;
        }
        if self.known.is_none_or(|(from, _)| from.angle(axis) > KNOWN) {
            let next = match leaning {
                Leaning::Least { .. } => raised(&self.upright, axis, held, &is_clear).or_else(|| {
                    between(axis, &nearest_clear(axis, &RINGS, held, &is_clear)?, held, &is_clear)
                }),
                Leaning::Any => nearest_clear(axis, &RINGS[FINER..], held, &is_clear),
            };
            self.known = Some((*axis, next));
        }
        false
    }

    /// The clear axis that is known.
    fn near(&self) -> Option<Unit3> {
        self.known.and_then(|(_, near)| near)
    }
}

/// A place where the tool may not be clear.
struct Short {
    at: Uv,
    /// What its axis lacks.
    by: Vec3,
}

/// Whether a tool that touches a point with a normal is clear with an axis.
pub(super) type Clear<'a> = dyn Fn(&Point3, &Unit3, &Unit3) -> bool + Sync + 'a;

/// The normal at a place; None where there is none.
pub(super) type Normal<'a> = dyn Fn(Uv, &Jet2) -> Option<Unit3> + Sync + 'a;

/// Brings an axis to where the joints can take it.
pub(super) type Held<'a> = dyn Fn(Unit3) -> Unit3 + Sync + 'a;

/// How far an axis that is not clear is brought from where it is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Leaning {
    /// As little as is clear: the strips of flat and toroidal ends are widest there.
    Least {
        /// By which part a place draws the harder each time that it is not clear.
        harder: f64,
    },
    /// To a ring where it is: a ball's strip is the same at any lean, and it is better farther off.
    Any,
}

type How<'a> = (&'a Clear<'a>, &'a Held<'a>, Leaning);

/// Moves the poles of a field until the tool is clear at places of a face; how many of them it is not at.
///
/// `held` brings an axis to where the joints can take it. A place at which no axis near the field's is clear is asked with the tool
/// lifted by `lift_mm`. The normals are those that passes see, then those off which axes lean.
pub(super) fn settle(
    field: &mut AxisField,
    (face, normal, upright): (&Extended<'_>, &Normal<'_>, &Normal<'_>),
    (places, lift_mm): (&[Uv], f64),
    how: How<'_>,
) -> usize {
    let mut all: Vec<Asked> = places
        .par_iter()
        .filter_map(|at| {
            let jet = face.jet2(*at);
            let normal = normal(*at, &jet)?;
            let upright = upright(*at, &jet).unwrap_or(normal);
            let axis = field.at(*at).0;
            let lifted = |mm: f64| {
                let point = jet.point + normal.into_inner() * mm;
                let mut asked = Asked { at: *at, point, normal, upright, known: None, clear: None, short: 0 };
                (asked.is_clear(&axis, how) || asked.near().is_some()).then_some(asked)
            };
            lifted(0.0).or_else(|| {
                // Beyond the border the tool may have no place to stand at all.
                let on_face = face.contains(*at);
                let none = || Asked {
                    at: *at,
                    point: jet.point,
                    normal,
                    upright,
                    known: Some((axis, None)),
                    clear: None,
                    short: 0,
                };
                on_face.then(|| lifted(lift_mm).unwrap_or_else(none))
            })
        })
        .collect();
    let (least_weight, harder) = match how.2 {
        Leaning::Least { harder } => (LEAST_WEIGHT, harder),
        Leaning::Any => (0.0, 0.0),
    };
    let mut asked: Vec<usize> = (0..all.len()).collect();
    let mut best = (usize::MAX, field.spline.poles.clone());
    for round in 0..=ROUNDS {
        let mut now: Vec<(usize, Asked)> = asked.iter().map(|k| (*k, all[*k])).collect();
        let short: Vec<Option<Short>> = now
            .par_iter_mut()
            .map(|(_, place)| {
                let axis = field.at(place.at).0;
                (!place.is_clear(&axis, how)).then(|| {
                    // What others hold back is pulled the harder.
                    let pull = (1.0 + harder * f64::from(place.short)).min(HARDEST);
                    place.short += 1;
                    let by = place
                        .near()
                        .map_or_else(Vec3::zeros, |a| (a.into_inner() - axis.into_inner()) * pull);
                    Short { at: place.at, by }
                })
            })
            .collect();
        for (k, place) in now {
            all[k] = place;
        }
        let count = short.iter().flatten().count();
        if asked.len() == all.len() && count < best.0 {
            best = (count, field.spline.poles.clone());
        }
        if best.0 == 0 || round == ROUNDS {
            break;
        }
        // What was clear may be so no more: every other round all are asked again.
        if round % 2 == 0 {
            let near = asked.iter().zip(&short).filter(|(_, s)| s.is_some());
            asked = near.map(|(k, _)| *k).collect();
        } else {
            asked = (0..all.len()).collect();
        }
        move_poles(field, short.iter().flatten(), least_weight);
    }
    field.spline.poles = best.1;
    best.0
}

/// Moves the poles around places by the mean of what these lack, as they weigh there.
fn move_poles<'a>(field: &mut AxisField, short: impl Iterator<Item = &'a Short>, least_weight: f64) {
    let n = field.spline.poles.len();
    let mut sums = vec![(Vec3::zeros(), 0.0); n];
    for s in short {
        let ([u, v], _) = field.bases(s.at);
        for (a, b) in (0..16).map(|k| (k / 4, k % 4)) {
            let weight = u.value[a] * v.value[b];
            let (sum, all) = &mut sums[field.spline.index(u.index[a], v.index[b])];
            *sum += s.by * weight;
            *all += weight;
        }
    }
    for (pole, (sum, all)) in field.spline.poles.iter_mut().zip(sums) {
        if all > 0.0 {
            let moved = *pole + sum / all.max(least_weight) * (1.0 + BEYOND);
            *pole = moved / moved.norm().max(f64::MIN_POSITIVE);
        }
    }
}

/// Leans that are tried beyond an axis' that is no further from the normal than that, rad.
const LEANS: f64 = 0.2;
const RAISES: [f64; 9] = [0.0005, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128];

/// The axis that leans the least further the same way and is clear.
fn raised(normal: &Unit3, axis: &Unit3, held: &Held<'_>, clear: &dyn Fn(&Unit3) -> bool) -> Option<Unit3> {
    let away = Unit3::try_new(axis.into_inner() - normal.into_inner() * normal.dot(axis), 1e-6)?;
    let lean = normal.angle(axis);
    if lean > LEANS {
        return None;
    }
    let at = |more: f64| {
        let (s, c) = (lean + more).sin_cos();
        held(Unit3::new_normalize(normal.into_inner() * c + away.into_inner() * s))
    };
    let mut bad = 0.0;
    for more in RAISES {
        if clear(&at(more)) {
            let mut good = more;
            for _ in 0..HALVINGS / 2 {
                let middle = 0.5 * (bad + good);
                if clear(&at(middle)) { good = middle } else { bad = middle }
            }
            return Some(at(good));
        }
        bad = more;
    }
    None
}

/// The nearest clear axis on rings around one.
fn nearest_clear(
    axis: &Unit3,
    rings: &[f64],
    held: &Held<'_>,
    clear: &dyn Fn(&Unit3) -> bool,
) -> Option<Unit3> {
    let x = any_perpendicular(axis);
    let y = axis.cross(&x);
    rings.iter().find_map(|ring| {
        (0..AROUND)
            .map(|k| {
                let (s, c) = (2.0 * PI * k as f64 / AROUND as f64).sin_cos();
                held(Unit3::new_normalize(axis.into_inner() + (x.into_inner() * c + y * s) * ring.tan()))
            })
            .find(|a| clear(a))
    })
}

/// The axis nearest to one that is not clear, on the way to one that is.
fn between(bad: &Unit3, good: &Unit3, held: &Held<'_>, clear: &dyn Fn(&Unit3) -> bool) -> Option<Unit3> {
    let (mut bad, mut good) = (*bad, *good);
    for _ in 0..HALVINGS {
        let middle = held(Unit3::try_new(bad.into_inner() + good.into_inner(), 1e-9)?);
        if clear(&middle) { good = middle } else { bad = middle }
    }
    Some(good)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::Spline;
    use osculate_geom::analytic::Plane;
    use osculate_geom::{Domain, Interval, uv};

    /// By how much a tool must lean towards x at a place, rad: most at (5, 5), nothing 2.45 mm from there.
    fn need(at: &Point3) -> f64 {
        0.1 * (-0.5 * ((at.x - 5.0).powi(2) + (at.y - 5.0).powi(2))).exp() - 0.005
    }

    #[test]
    fn poles_follow_what_places_between_them_need_and_no_more() {
        let side = Interval::new(0.0, 10.0);
        let plane = Plane::new(Domain { u: side, v: side });
        let face = Extended::by(&plane, 0.0);
        let places: Vec<Uv> =
            (0..=1600).map(|k| uv(0.25 * f64::from(k / 41), 0.25 * f64::from(k % 41))).collect();
        let normal: &Normal<'_> = &|_, jet| jet.normal().ok();
        let settled = |clear: &Clear<'_>, leaning| {
            let mut field = AxisField::held(&plane, Vec3::z_axis());
            field.spline = Spline::constant(&field.rectangle, [10, 10], Vec3::z());
            let held: &Held<'_> = &|axis| axis;
            let short = settle(&mut field, (&face, normal, normal), (&places, 0.1), (clear, held, leaning));
            (field, short)
        };
        let lean = |axis: &Unit3| axis.x.atan2(axis.z);
        let leans: &Clear<'_> = &|at, _, axis| lean(axis) >= need(at);
        for harder in [0.0, 0.1] {
            let (field, short) = settled(leans, Leaning::Least { harder });
            assert_eq!(short, 0);
            for at in &places {
                let (axis, point) = (field.at(*at).0, plane.point(*at));
                assert!(leans(&point, &Vec3::z_axis(), &axis), "{at:?}: {} of {}", lean(&axis), need(&point));
                // A span is a millimetre, over which the need changes by 0.06 at most.
                assert!(lean(&axis) < need(&point).max(0.0) + 0.06, "{at:?}: {}", lean(&axis));
            }
            // Far from all that is needed hardly anything moves.
            assert!(field.at(uv(0.5, 0.5)).0.angle(&Vec3::z_axis()) < 1e-6);
        }
        // What no axis near the field's makes clear is counted, and holds nothing else up.
        let but_one: &Clear<'_> = &|at, _, axis| at.x.hypot(at.y) > 0.2 && lean(axis) >= need(at);
        let (field, short) = settled(but_one, Leaning::Any);
        assert_eq!(short, 1);
        let not = places.iter().filter(|at| !but_one(&plane.point(**at), &Vec3::z_axis(), &field.at(**at).0));
        assert_eq!(not.collect::<Vec<_>>(), [&uv(0.0, 0.0)]);
    }
}
