//! Parameters of the file's surfaces as parameters of their carriers.
//!
//! A surface of revolution (120) has the parameter of its generatrix first and the angle second; its carrier has the
//! turn first, by quarter arcs in rational form. On an arc of angle 2 d the angle f from the middle and the parameter s
//! of the rational quadratic obey `tan(f / 2) = (2 s - 1) tan(d / 2)`. A tabulated cylinder (122) and a ruled surface
//! (118) run from 0 to 1 in both directions.

use super::geometry::{Geometry, MAX_CHAIN, Unread};
use crate::trim::curve::Curve;
use osculate_geom::Point3;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// How one parameter of the file becomes one of the carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Map {
    Same,
    /// From 0 to 1 onto a range.
    Onto([f64; 2]),
    /// An angle over a range onto quarter arcs of length one each.
    Turn {
        from: f64,
        sweep: f64,
    },
}

impl Map {
    fn of(self, t: f64) -> f64 {
        match self {
            Self::Same => t,
            Self::Onto([lo, hi]) => lo + t * (hi - lo),
            Self::Turn { from, sweep } => {
                // As `Spline::arc` cuts it.
                let pieces = ((sweep / FRAC_PI_2) - 1e-9).ceil().clamp(1.0, 4.0);
                let half = 0.5 * sweep / pieces;
                let along = (t - from) / (2.0 * half);
                let k = along.floor().clamp(0.0, pieces - 1.0);
                let off = (along - k - 0.5) * 2.0 * half;
                k + 0.5 + 0.5 * (0.5 * off).tan() / (0.5 * half).tan()
            }
        }
    }
}

/// How parameters of a surface of the file become those of its carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parameters {
    /// For the first and the second number of the file.
    maps: [Map; 2],
    /// Whether the carrier has them the other way round.
    swapped: bool,
}

impl Parameters {
    /// Whether the carrier has the file's own parameters.
    pub(super) fn are_same(self) -> bool {
        self == Self { maps: [Map::Same; 2], swapped: false }
    }

    fn of(self, p: &Point3) -> Point3 {
        let (a, b) = (self.maps[0].of(p.x), self.maps[1].of(p.y));
        if self.swapped { Point3::new(b, a, 0.0) } else { Point3::new(a, b, 0.0) }
    }
}

impl Geometry<'_> {
    /// The parameters of a surface; `None` where the file's are not known on the carrier.
    pub(super) fn parameters(&self, de: i64) -> Result<Option<Parameters>, Unread> {
        let mut e = self.entity(de)?;
        let mut de = de;
        // An offset has the parameters of its base.
        for _ in 0..MAX_CHAIN {
            if e.kind != 140 {
                break;
            }
            de = self.required(de, e, 4, "surface")?;
            e = self.entity(de)?;
        }
        let (maps, swapped) = match e.kind {
            128 | 114 => ([Map::Same; 2], false),
            118 => {
                let both =
                    [self.required(de, e, 0, "first curve")?, self.required(de, e, 1, "second curve")?];
                // An arc's own parameter is its angle, which the ruled carrier has not.
                let spline = |k: i64| self.entity(k).is_ok_and(|c| matches!(c.kind, 110 | 112 | 126));
                if !both.into_iter().all(spline) {
                    return Ok(None);
                }
                ([Map::Same; 2], false)
            }
            120 => {
                let Some(along) = self.generatrix_map(self.required(de, e, 1, "generatrix")?, false)? else {
                    return Ok(None);
                };
                let (from, to) = (self.number(de, e, 2)?, self.number(de, e, 3)?);
                ([along, Map::Turn { from, sweep: to - from }], true)
            }
            122 => match self.generatrix_map(self.required(de, e, 0, "directrix")?, true)? {
                Some(along) => ([along, Map::Same], false),
                None => return Ok(None),
            },
            _ => return Ok(None),
        };
        Ok(Some(Parameters { maps, swapped }))
    }

    /// The parameter of a generatrix as a spline; `unit` where the file's runs from 0 to 1.
    fn generatrix_map(&self, de: i64, unit: bool) -> Result<Option<Map>, Unread> {
        Ok(match self.entity(de)?.kind {
            110 => Some(Map::Same),
            112 | 126 if unit => Some(Map::Onto(self.generatrix(de)?.range())),
            112 | 126 => Some(Map::Same),
            _ => None,
        })
    }
}

/// A parameter-space curve on the carrier.
pub(super) struct OnCarrier {
    pub(super) curve: Arc<dyn Curve>,
    pub(super) parameters: Parameters,
}

impl Curve for OnCarrier {
    fn point(&self, t: f64) -> Point3 {
        self.parameters.of(&self.curve.point(t))
    }
    fn range(&self) -> [f64; 2] {
        self.curve.range()
    }
    fn locate(&self, p: &Point3) -> f64 {
        // Parameter curves are only followed, never searched; the best of a few samples is enough for that.
        let [lo, hi] = self.range();
        let at = |k: i32| lo + (hi - lo) * f64::from(k) / 64.0;
        let d2 = |k: i32| (self.point(at(k)) - p).norm_squared();
        at((0..=64).min_by(|a, b| d2(*a).total_cmp(&d2(*b))).unwrap_or(0))
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trim::spline::Spline;
    use osculate_geom::Vec3;

    #[test]
    fn angles_become_parameters_of_the_rational_turn() {
        for (from, sweep) in [(0.0, std::f64::consts::TAU), (-0.4, 0.7), (1.0, 3.5)] {
            let arc = Spline::arc(Point3::origin(), Vec3::x(), Vec3::y(), [from, from + sweep])
                .expect("a unit arc");
            for k in 0..=37 {
                let angle = from + sweep * f64::from(k) / 37.0;
                let p = arc.point(Map::Turn { from, sweep }.of(angle));
                // A unit circle, a dozen operations.
                assert!((p - Point3::new(angle.cos(), angle.sin(), 0.0)).norm() < 1e-14, "{angle}");
            }
        }
    }
}
