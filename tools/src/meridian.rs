//! Convex meridians made of arcs: cones, barrels and the general APT cutter.
//!
//! A convex body of revolution is told by its meridian in local coordinates (rho from the axis, z above the tip). Its
//! signed distance is `d(p) = max over unit normals n of (n . p - h(n))`, h the support function, inside as well as
//! outside. Here h comes from a chain of arcs, each with a centre, a radius (0 for a corner) and the range of outward
//! normals that belong to it; the ranges follow each other without gaps from straight down on. A straight flank is
//! where two neighbours share a normal. On one arc the maximum is `|p - c| - r` where p lies in the arc's range of
//! normals and the tangent at the nearer end of the range elsewhere.
//!
//! APT's `CUTTER/d, r, e, f, a, b, h`: the bottom rises from the tip by the angle a, the side opens by b from the axis,
//! both lines meet at the radius d/2, and the corner arc of radius r touches both; its centre (e, f) follows from the
//! rest.

use std::f64::consts::FRAC_PI_2;

/// An arc of a meridian; radius 0 is a corner.
///
/// ```
/// use osculate_tools::{Cutter, CutterSpec};
/// // Leaned by 10 degrees a barrel of radius 100 and diameter 20 touches a floor with its tip; leaned by 85 with its large arc.
/// let spec = CutterSpec::Barrel {
///     diameter_mm: 20.0,
///     barrel_radius_mm: 100.0,
///     corner_radius_mm: 3.0,
///     length_mm: 60.0,
/// };
/// let barrel = Cutter::try_from(spec)?;
/// assert_eq!(barrel.touching(10f64.to_radians()).radius_mm, 3.0);
/// let large = barrel.touching(85f64.to_radians());
/// assert_eq!((large.radius_mm, large.centre_rho_mm), (100.0, 10.0 - 100.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Distance of the centre from the axis, mm; negative for barrels.
    pub centre_rho_mm: f64,
    /// Height of the centre above the tip, mm.
    pub centre_z_mm: f64,
    /// Radius, mm.
    pub radius_mm: f64,
    /// First and last outward normal, as (rho, z).
    normals: [[f64; 2]; 2],
}

/// Distance and its gradient in local coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LocalNear {
    /// Signed distance, mm.
    pub distance: f64,
    /// Its derivative by rho.
    pub by_rho: f64,
    /// Its derivative by z.
    pub by_z: f64,
    /// Curvature of the curve of equal distance, 1/mm.
    pub bend: f64,
}

impl Arc {
    /// The arc over the angles of outward normals from `from` to `to`, rad, 0 along rho and -90 deg straight down.
    fn new(centre: [f64; 2], radius_mm: f64, from: f64, to: f64) -> Self {
        // sin and cos of a right angle leave 6e-17 where nothing belongs.
        let unit = |a: f64| {
            if a == -FRAC_PI_2 {
                [0.0, -1.0]
            } else if a == FRAC_PI_2 {
                [0.0, 1.0]
            } else {
                [a.cos(), a.sin()]
            }
        };
        Self { centre_rho_mm: centre[0], centre_z_mm: centre[1], radius_mm, normals: [unit(from), unit(to)] }
    }

    fn near(&self, rho: f64, z: f64) -> LocalNear {
        let (x, y) = (rho - self.centre_rho_mm, z - self.centre_z_mm);
        let [[ax, ay], [bx, by]] = self.normals;
        let (before, after) = (ax * y - ay * x, x * by - y * bx);
        if before >= 0.0 && after >= 0.0 && (x != 0.0 || y != 0.0) {
            let r = (x * x + y * y).sqrt();
            LocalNear { distance: r - self.radius_mm, by_rho: x / r, by_z: y / r, bend: 1.0 / r }
        } else {
            let (a, b) = (ax * x + ay * y, bx * x + by * y);
            if a >= b {
                LocalNear { distance: a - self.radius_mm, by_rho: ax, by_z: ay, bend: 0.0 }
            } else {
                LocalNear { distance: b - self.radius_mm, by_rho: bx, by_z: by, bend: 0.0 }
            }
        }
    }

    /// Whether a plane whose normal the axis leans away from by `lean_rad` touches the arc itself.
    pub(crate) fn touches_at(&self, lean_rad: f64) -> bool {
        let (s, c) = lean_rad.sin_cos();
        self.has_normal([s, -c])
    }

    /// Whether the outward normal (rho, z) belongs to the arc.
    fn has_normal(&self, n: [f64; 2]) -> bool {
        let [a, b] = self.normals;
        // To rounding: the ranges of neighbours meet in computed normals.
        a[0] * n[1] - a[1] * n[0] >= -1e-15 && n[0] * b[1] - n[1] * b[0] >= -1e-15
    }
}

/// Most arcs of a meridian: tip, corner, barrel or end of a cone.
const MOST: usize = 3;

/// A convex meridian, endless upwards: the cutter's length cuts it off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Meridian {
    arcs: [Arc; MOST],
    count: usize,
    /// Greatest distance from the axis below the length, mm.
    pub radius: f64,
    /// The arc that stands for the corner in the sense of an end mill.
    pub corner: Arc,
}

/// Why a meridian is none, in terms of the quantities that make it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Misfit {
    /// An angle outside its range, rad.
    Angle { what: &'static str, got: f64, least: f64, most: f64 },
    /// The corner is too large: its greatest radius, mm.
    Corner { most: f64 },
    /// The barrel radius is below the tool's radius, mm.
    Barrel { least: f64 },
    /// The length is outside what the shape needs, mm.
    Length { least: f64, most: f64 },
}

/// A cone with a rounded end, see [`Meridian::cone`].
#[derive(Clone, Copy)]
pub(crate) struct Cone {
    pub radius: f64,
    pub taper: f64,
    pub corner: f64,
    pub tip_radius: Option<f64>,
    pub length: f64,
}

/// A barrel with a ball tip, see [`Meridian::barrel`].
#[derive(Clone, Copy)]
pub(crate) struct Barrel {
    pub radius: f64,
    pub barrel: f64,
    pub corner: f64,
    pub length: f64,
}

/// The APT cutter, see [`Meridian::apt`].
#[derive(Clone, Copy)]
pub(crate) struct Apt {
    pub radius: f64,
    pub corner: f64,
    pub bottom: f64,
    pub side: f64,
    pub length: f64,
}

fn angle(what: &'static str, got: f64, [least, most]: [f64; 2]) -> Result<(), Misfit> {
    // The ends themselves make a line of the cone.
    if got > least && got < most { Ok(()) } else { Err(Misfit::Angle { what, got, least, most }) }
}

impl Meridian {
    fn of(arcs: &[Arc], radius: f64, corner: Arc) -> Self {
        let mut all = [corner; MOST];
        all[..arcs.len()].copy_from_slice(arcs);
        Self { arcs: all, count: arcs.len(), radius, corner }
    }

    /// Ball, flat or toroidal end.
    pub fn end_mill(radius: f64, corner: Arc) -> Self {
        Self::of(&[corner], radius, corner)
    }

    /// A corner of radius `corner` at the tip, then a cone with half angle `taper` up to the radius, then a cylinder.
    /// The cone meets the tip's plane at `tip_radius`; without it the tip is a ball.
    pub fn cone(c: Cone) -> Result<Self, Misfit> {
        angle("taper_deg", c.taper, [0.0, FRAC_PI_2])?;
        let (sin, cos) = c.taper.sin_cos();
        let core = match c.tip_radius {
            Some(tip) => {
                let core = tip - c.corner * (1.0 - sin) / cos;
                if core < 0.0 {
                    return Err(Misfit::Corner { most: tip * cos / (1.0 - sin) });
                }
                core
            }
            None => 0.0,
        };
        // Support of the flank, and where it reaches the radius.
        let h = cos * core - sin * c.corner + c.corner;
        let top = (c.radius * cos - h) / sin;
        if top <= c.corner * (1.0 - sin) {
            return Err(Misfit::Corner { most: c.radius });
        }
        if top > c.length {
            return Err(Misfit::Length { least: top, most: f64::INFINITY });
        }
        let corner = Arc::new([core, c.corner], c.corner, -FRAC_PI_2, -c.taper);
        let end = Arc::new([c.radius, top], 0.0, -c.taper, 0.0);
        Ok(Self::of(&[corner, end], c.radius, corner))
    }

    /// A ball tip that runs smoothly into an arc of radius `barrel`, which is widest, horizontal, at the radius.
    pub fn barrel(b: Barrel) -> Result<Self, Misfit> {
        if b.barrel <= b.radius {
            return Err(Misfit::Barrel { least: b.radius });
        }
        if b.corner >= b.radius {
            return Err(Misfit::Corner { most: b.radius });
        }
        let (apart, sideways) = (b.barrel - b.corner, b.barrel - b.radius);
        // Both terms positive, without the cancellation of the difference of squares.
        let up = ((apart - sideways) * (apart + sideways)).sqrt();
        let widest = b.corner + up;
        // Where the barrel has come back to the axis.
        let most = widest + (b.radius * (2.0 * b.barrel - b.radius)).sqrt();
        if !(b.length >= widest && b.length < most) {
            return Err(Misfit::Length { least: widest, most });
        }
        let meet = (-up).atan2(sideways);
        let tip = Arc::new([0.0, b.corner], b.corner, -FRAC_PI_2, meet);
        let barrel = Arc::new([-sideways, widest], b.barrel, meet, FRAC_PI_2);
        Ok(Self::of(&[tip, barrel], b.radius, tip))
    }

    /// The general APT cutter, `radius` half of d.
    pub fn apt(a: Apt) -> Result<Self, Misfit> {
        if a.bottom != 0.0 {
            angle("bottom_angle_deg", a.bottom, [0.0, FRAC_PI_2])?;
        }
        angle("side_angle_deg", a.side, [-FRAC_PI_2, FRAC_PI_2 - a.bottom])?;
        let meet_z = a.radius * a.bottom.tan();
        // The corner's centre: r inside both lines, along their bisector from where they meet.
        let (down, out) = ([a.bottom.sin(), -a.bottom.cos()], [a.side.cos(), -a.side.sin()]);
        let off = [down, out].map(|d| d[0] * a.radius + d[1] * meet_z - a.corner);
        let [core, height] = osculate_geom::solve::general([down, out], off);
        // How far the corner moves its centre inwards, per mm of its radius.
        let per_corner = if a.corner > 0.0 { (a.radius - core) / a.corner } else { 0.0 };
        // To rounding of the coordinates: a ball's centre is computed.
        let slack = 1e-12 * a.radius;
        if core < -slack {
            return Err(Misfit::Corner { most: a.radius / per_corner });
        }
        let core = if core.abs() <= slack { 0.0 } else { core };
        let ends = height + a.corner * out[1];
        let opening = a.side.tan();
        let top = a.radius + (a.length - meet_z) * opening;
        if a.length <= ends || top <= 0.0 {
            let most = if opening < 0.0 { meet_z - a.radius / opening } else { f64::INFINITY };
            return Err(Misfit::Length { least: ends, most });
        }
        let widest = if a.side >= 0.0 { top } else { core + a.corner };
        let tip = Arc::new([0.0, 0.0], 0.0, -FRAC_PI_2, -FRAC_PI_2 + a.bottom);
        let corner = Arc::new([core, height], a.corner, -FRAC_PI_2 + a.bottom, -a.side);
        Ok(if a.bottom == 0.0 {
            Self::of(&[corner], widest, corner)
        } else {
            Self::of(&[tip, corner], widest, corner)
        })
    }

    /// Signed distance of a local point, rho >= 0, and its gradient.
    pub fn near(&self, rho: f64, z: f64) -> LocalNear {
        let mut best = self.arcs[0].near(rho, z);
        for arc in &self.arcs[1..self.count] {
            let own = arc.near(rho, z);
            if own.distance > best.distance {
                best = own;
            }
        }
        best
    }

    /// Points of the outline from the tip up to the height `length`, (rho, z), turning by at most `turn` on arcs.
    pub fn outline(&self, length: f64, turn: f64) -> Vec<[f64; 2]> {
        let mut points = vec![[0.0, 0.0]];
        for arc in &self.arcs[..self.count] {
            let [from, to] = arc.normals.map(|n| n[1].atan2(n[0]));
            let steps = if arc.radius_mm > 0.0 { ((to - from) / turn).ceil().clamp(1.0, 1e4) } else { 0.0 };
            for k in 0..=steps as u32 {
                let (s, c) = (from + (to - from) * f64::from(k) / steps.max(1.0)).sin_cos();
                let p = [arc.centre_rho_mm + arc.radius_mm * c, arc.centre_z_mm + arc.radius_mm * s];
                if p[0] >= 0.0 && p[1] < length {
                    points.push(p);
                }
            }
        }
        points.dedup();
        // Along the last flank: as far out as the distance at the top allows.
        let rho = |z: f64| {
            let (mut lo, mut hi) = (0.0, self.radius);
            // To the last digits of a radius.
            for _ in 0..60 {
                let middle = 0.5 * (lo + hi);
                if self.near(middle, z).distance <= 0.0 { lo = middle } else { hi = middle }
            }
            lo
        };
        points.push([rho(length), length]);
        points
    }

    /// The arc to which an outward normal belongs; the last one where none has it.
    pub fn touching(&self, normal: [f64; 2]) -> Arc {
        let arcs = &self.arcs[..self.count];
        *arcs.iter().find(|a| a.has_normal(normal)).unwrap_or(&arcs[self.count - 1])
    }
}

/// The arc of an end mill's corner.
pub(crate) fn end_mill_corner(core: f64, corner: f64) -> Arc {
    Arc::new([core, corner], corner, -FRAC_PI_2, 0.0)
}
