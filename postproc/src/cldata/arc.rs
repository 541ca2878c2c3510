//! Arcs of CL data, as chords.
//!
//! - `CIRCLE/x,y,z,i,j,k[,r,...]` and `MOVARC/x,y,z,i,j,k[,r][,ANGLE,a]`: centre and axis; the next point is the end, the
//!   tool goes right-handed about the axis. An end at the start is a full turn. `ANGLE` (deg) adds whole turns, and
//!   gives the end where no point follows.
//! - `INDIRV/x,y,z`, then `TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,ex,ey,ez)`: CATIA's form, which leaves in the given
//!   direction and ends where the line from the centre does.
//!
//! An end off the plane of the arc makes a helix; where the ends have slightly different radii, the radius goes over from
//! one to the other evenly.

use osculate_geom::{Point3, Unit3, Vec3};

use super::error::ClReadError;
use super::fields::{count, is_word, numbers, unit};
use super::statement::Statement;

/// The radii at both ends may differ by this: rounding of CL data, mm.
const LARGEST_RADIUS_ERROR_MM: f64 = 0.01;

/// Ends nearer than this, mm, are one point, and the arc between them a full turn.
const SAME_POINT_MM: f64 = 1e-6;

/// Chords of one arc at most: a full turn of 10 m radius within 1 um has 7000.
pub(super) const MOST_CHORDS: f64 = 1e5;

/// Why an arc has no chords.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NoArc {
    /// The ends miss a common circle by so much, mm.
    Off(f64),
    /// It would have so many, more than [`MOST_CHORDS`].
    Chords(f64),
}

/// An arc that waits for its end.
#[derive(Clone, Debug)]
pub(super) struct Arc {
    pub line: usize,
    pub centre: Point3,
    /// Right-handed.
    pub axis: Option<Unit3>,
    pub angle_rad: Option<f64>,
}

/// `CIRCLE/` and `MOVARC/`.
pub(super) fn circle(s: &Statement, unit_mm: f64) -> Result<Arc, ClReadError> {
    let at = s.fields.iter().position(|f| is_word(f)).unwrap_or(s.fields.len());
    let n = numbers(s, &s.fields[..at])?;
    if n.len() < 6 {
        return Err(count(s, n.len(), "6 (centre and axis) or more"));
    }
    let axis = unit(s.line, Vec3::new(n[3], n[4], n[5]))?;
    let angle = match s.fields.iter().position(|f| f == "ANGLE") {
        Some(k) => numbers(s, s.fields.get(k + 1..k + 2).unwrap_or_default())?.first().copied(),
        None => None,
    };
    Ok(Arc {
        line: s.line,
        centre: Point3::new(n[0], n[1], n[2]) * unit_mm,
        axis: Some(axis),
        angle_rad: angle.map(f64::to_radians),
    })
}

/// `TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,ex,ey,ez)`: the arc, whose axis the direction of leaving gives, and its
/// end; `None` where something else stands there.
pub(super) fn gofwd(s: &Statement, unit_mm: f64) -> Result<Option<(Arc, Point3)>, ClReadError> {
    let text = s.fields.join(",").replace([' ', '(', ')'], "");
    let Some((_, rest)) = text.split_once("CIRCLE/") else { return Ok(None) };
    let Some((circle, line)) = rest.split_once(",ON,LINE/") else { return Ok(None) };
    let fields = |t: &str| t.split(',').map(str::to_string).collect::<Vec<_>>();
    let (c, l) = (numbers(s, &fields(circle))?, numbers(s, &fields(line))?);
    if c.len() < 3 || l.len() < 6 {
        return Err(count(s, c.len() + l.len(), "a centre with radius and a line of two points"));
    }
    let centre = Point3::new(c[0], c[1], c[2]) * unit_mm;
    let end = Point3::new(l[3], l[4], l[5]) * unit_mm;
    Ok(Some((Arc { line: s.line, centre, axis: None, angle_rad: None }, end)))
}

impl Arc {
    /// Across the axis, from the centre.
    fn spoke(&self, axis: &Unit3, p: &Point3) -> Vec3 {
        let d = p - self.centre;
        d - axis.into_inner() * axis.dot(&d)
    }

    /// Where the angle leads from a point.
    pub fn end_by_angle(&self, from: &Point3) -> Option<Point3> {
        let (axis, angle) = (self.axis?, self.angle_rad?);
        let a = self.spoke(&axis, from);
        let (s, c) = angle.sin_cos();
        Some(from - a + a * c + axis.cross(&a) * s)
    }

    /// The points between the ends.
    pub fn chords(&self, from: &Point3, to: &Point3, tol_mm: f64) -> Result<Vec<Point3>, NoArc> {
        let Some(axis) = self.axis else { return Err(NoArc::Off((to - from).norm())) };
        let (a, b) = (self.spoke(&axis, from), self.spoke(&axis, to));
        let (ra, rb) = (a.norm(), b.norm());
        if (ra - rb).abs() > LARGEST_RADIUS_ERROR_MM || ra < SAME_POINT_MM {
            return Err(NoArc::Off((ra - rb).abs().max(SAME_POINT_MM)));
        }
        let full = std::f64::consts::TAU;
        let same = (a - b).norm() < SAME_POINT_MM;
        let mut angle = if same { full } else { axis.dot(&a.cross(&b)).atan2(a.dot(&b)).rem_euclid(full) };
        if let Some(given) = self.angle_rad {
            angle += full * ((given.abs() - angle) / full).round().max(0.0);
        }
        // A chord over the angle p strays by r (1 - cos(p / 2)).
        let piece = 2.0 * (1.0 - (tol_mm / ra).min(1.0)).acos();
        let count = (angle / piece).ceil().max(1.0);
        if count > MOST_CHORDS {
            return Err(NoArc::Chords(count));
        }
        let rise = axis.into_inner() * axis.dot(&(to - from));
        let foot = from - a;
        let (u, v) = (a / ra, axis.cross(&(a / ra)));
        let mut points = Vec::new();
        let mut k = 1.0;
        while k < count {
            let t = k / count;
            let (s, c) = (angle * t).sin_cos();
            points.push(foot + rise * t + (u * c + v * s) * (ra + (rb - ra) * t));
            k += 1.0;
        }
        Ok(points)
    }
}
