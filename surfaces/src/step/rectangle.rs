//! Parameters of a file on swept surfaces: of RECTANGULAR_TRIMMED_SURFACE standing by itself, and of parameter curves.
//!
//! The file's parameters are those of ISO 10303-42. Swept surfaces become splines with other ones: a spline's arc
//! is measured in quarters, `s / (1 - s) = sin(t / 2) / sin((pi / 2 - t) / 2)` within each, a line in parts of what of it is
//! built.

use super::geometry::{Geometry, Unread};
use super::graph::{Args, arg};
use crate::trim::boundary::Boundary;
use crate::trim::curve::{Curve, Line, Piece};
use osculate_geom::{Interval, Point3, Surface};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// The sides of a rectangle, and points as far out as its surface has to go.
pub(super) struct Rectangle {
    pub(super) sides: Vec<Boundary>,
    pub(super) reach: Vec<Point3>,
}

/// The parameters of a swept surface, and points as far out as its rectangle goes.
type Swept = ([Map; 2], Vec<Point3>);

/// How a parameter of the file becomes the spline's.
#[derive(Clone, Copy)]
enum Map {
    /// As many times as much.
    Scale(f64),
    /// An angle in units of so many radians, as quarters of a turn.
    Turn(f64),
    /// Lengths along a line, in units of so many mm, of which a piece so far to both sides of its origin is built.
    Line { unit_mm: f64, far_mm: f64 },
}

impl Map {
    fn apply(self, t: f64) -> f64 {
        match self {
            Self::Scale(unit) => t * unit,
            Self::Turn(angle_rad) => quarters(t * angle_rad),
            Self::Line { unit_mm, far_mm } => 0.5 * (1.0 + t * unit_mm / far_mm),
        }
    }

    /// The parameter of the file.
    fn undo(self, t: f64) -> f64 {
        match self {
            Self::Scale(unit) => t / unit,
            Self::Turn(unit) => angle_rad(t) / unit,
            Self::Line { unit_mm, far_mm } => (2.0 * t - 1.0) * far_mm / unit_mm,
        }
    }

    /// The period of the file's parameter.
    fn turn(self) -> Option<f64> {
        match self {
            Self::Turn(angle_rad) => Some(TAU / angle_rad),
            Self::Scale(_) | Self::Line { .. } => None,
        }
    }
}

/// The parameter of a full circle as a spline of four pieces at an angle, rad.
fn quarters(angle_rad: f64) -> f64 {
    let whole = (angle_rad / FRAC_PI_2).floor();
    let t = angle_rad - whole * FRAC_PI_2;
    let (a, b) = ((0.5 * t).sin(), (0.5 * (FRAC_PI_2 - t)).sin());
    whole + a / (a + b)
}

/// The angle at a parameter of the full circle as a spline, rad.
fn angle_rad(quarters: f64) -> f64 {
    let whole = quarters.floor();
    let s = quarters - whole;
    let (sin, cos) = (0.5 * FRAC_PI_2).sin_cos();
    whole * FRAC_PI_2 + 2.0 * (s * sin).atan2(1.0 - s + s * cos)
}

/// A curve of parameters of the file in those of a swept surface's spline.
pub(super) struct Measured {
    curve: Arc<dyn Curve>,
    maps: [Map; 2],
}

impl Measured {
    /// The curve on a surface of the file; itself where that is no swept one.
    pub(super) fn on(
        geometry: &Geometry<'_>,
        surface: u64,
        curve: Arc<dyn Curve>,
    ) -> Result<Arc<dyn Curve>, Unread> {
        Ok(match swept(geometry, surface, [0.0; 4])? {
            Some((maps, _)) => Arc::new(Self { curve, maps }),
            None => curve,
        })
    }
}

impl Curve for Measured {
    fn point(&self, t: f64) -> Point3 {
        let p = self.curve.point(t);
        Point3::new(self.maps[0].apply(p.x), self.maps[1].apply(p.y), p.z)
    }
    fn range(&self) -> [f64; 2] {
        self.curve.range()
    }
    fn period(&self) -> Option<f64> {
        self.curve.period()
    }
    fn locate(&self, p: &Point3) -> f64 {
        self.curve.locate(&Point3::new(self.maps[0].undo(p.x), self.maps[1].undo(p.y), p.z))
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
}

/// The rectangle of a RECTANGULAR_TRIMMED_SURFACE.
pub(super) fn rectangle(geometry: &Geometry<'_>, id: u64, args: &Args<'_>) -> Result<Rectangle, Unread> {
    let basis = geometry.to(id, args, 1)?;
    let mut at = [0.0; 4];
    for (k, t) in at.iter_mut().enumerate() {
        *t = geometry.number(id, args, 2 + k)?;
    }
    let swept = swept(geometry, basis, at)?;
    let reach = swept.as_ref().map_or_else(Vec::new, |s| s.1.clone());
    let surface = geometry.surface(basis, &reach, 0)?.surface;
    let maps = swept.map_or_else(
        || surface.parameter_units(geometry.units.length_mm, geometry.units.angle_rad).map(Map::Scale),
        |s| s.0,
    );
    let domain = surface.domain();
    // The senses say on which way a closed direction is passed from the first value to the second (ISO 10303-42,
    // rectangular_trimmed_surface); elsewhere only one way leads there.
    let range = |k: usize, interval: Interval| {
        let [first, second] = [at[2 * k], at[2 * k + 1]];
        let forward = arg(args, 6 + k).flag().unwrap_or(true);
        let period = match (maps[k], interval.periodic) {
            (Map::Scale(unit), true) => Some(interval.length() / unit),
            (map, _) => map.turn(),
        };
        let [lo, hi] = match period {
            None => [first.min(second), first.max(second)],
            Some(period) => {
                let [lo, hi] = if forward { [first, second] } else { [second, first] };
                [lo, if hi <= lo { hi + period } else { hi }]
            }
        };
        [maps[k].apply(lo), maps[k].apply(hi)]
    };
    let ([u0, u1], [v0, v1]) = (range(0, domain.u), range(1, domain.v));
    let corners = [(u0, v0), (u1, v0), (u1, v1), (u0, v1)].map(|(u, v)| Point3::new(u, v, 0.0));
    let side = |k: usize| Line::segment(corners[k], corners[(k + 1) % 4]);
    let piece = |k| Boundary::Parameter { piece: Piece { curve: Arc::new(side(k)), ends: [0.0, 1.0] } };
    Ok(Rectangle { sides: (0..4).map(piece).collect(), reach })
}

/// The parameters of a swept surface, and points as far out as the rectangle goes; `None` for any other surface.
fn swept(geometry: &Geometry<'_>, id: u64, at: [f64; 4]) -> Result<Option<Swept>, Unread> {
    let record = geometry.record(id)?;
    if let Some(args) = record.part("SURFACE_OF_LINEAR_EXTRUSION") {
        let direction = geometry.vector(geometry.to(id, &args, 2)?)?;
        let curve = geometry.to(id, &args, 1)?;
        let reach = |points: &[Point3]| -> Vec<Point3> {
            points.iter().flat_map(|p| [p + direction * at[2], p + direction * at[3]]).collect()
        };
        let (map, reach) = along(geometry, curve, [at[0], at[1]], &reach)?;
        return Ok(Some(([map, Map::Scale(1.0)], reach)));
    }
    if let Some(args) = record.part("SURFACE_OF_REVOLUTION") {
        let curve = geometry.to(id, &args, 1)?;
        let (map, reach) = along(geometry, curve, [at[2], at[3]], &<[Point3]>::to_vec)?;
        return Ok(Some(([Map::Turn(geometry.units.angle_rad), map], reach)));
    }
    Ok(None)
}

/// The parameter along a generatrix, and `reach` of points of the part between two values of it.
fn along(
    geometry: &Geometry<'_>,
    id: u64,
    at: [f64; 2],
    reach: &dyn Fn(&[Point3]) -> Vec<Point3>,
) -> Result<(Map, Vec<Point3>), Unread> {
    let record = geometry.record(id)?;
    if let Some(args) = record.part("LINE") {
        let origin = geometry.point(geometry.to(id, &args, 1)?)?;
        let direction = geometry.vector(geometry.to(id, &args, 2)?)?;
        let points = reach(&at.map(|t| origin + direction * t));
        let far_mm = points.iter().map(|p| (p - origin).norm()).fold(0.0, f64::max);
        return Ok((Map::Line { unit_mm: direction.norm(), far_mm }, points));
    }
    if let Some(args) = record.part("TRIMMED_CURVE") {
        // A trimmed curve has its basis' parameters; one that runs against its basis is left out with a word.
        let basis = geometry.to(id, &args, 1)?;
        let straight = geometry.record(basis)?.part("TRIMMED_CURVE").is_none();
        if arg(&args, 4).flag() == Some(false) || !straight {
            let what = "a rectangle of parameters along a curve that is turned round or trimmed twice".into();
            return Err(Unread::Malformed { id, what });
        }
        return along(geometry, basis, at, reach);
    }
    let map = match geometry.ellipse(id, &record)? {
        Some(_) => Map::Turn(geometry.units.angle_rad),
        None => Map::Scale(1.0),
    };
    let spline = geometry.generatrix(id, &[], 0)?;
    Ok((map, reach(spline.curve().poles())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trim::spline::Spline;
    use osculate_geom::Vec3;

    #[test]
    fn quarters_are_the_parameter_of_the_spline() {
        let circle = Spline::arc(Point3::origin(), Vec3::x(), Vec3::y(), [0.0, TAU]).unwrap();
        for k in 0..=40 {
            let angle = TAU * f64::from(k) / 40.0;
            let p = circle.point(quarters(angle));
            assert!((angle_rad(quarters(angle)) - angle).abs() < 1e-14, "{angle}");
            // Rounding of a unit circle.
            assert!((p - Point3::new(angle.cos(), angle.sin(), 0.0)).norm() < 1e-14, "{angle}");
        }
    }
}
