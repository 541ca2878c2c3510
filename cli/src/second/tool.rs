//! The tool as a body of revolution: how deep a point is in it, by closed formulas.
//!
//! A point is told by its distance from the axis and its height above the tip. Ball, flat and toroidal ends are one formula, the
//! offset of a cylinder by the corner radius. The others have a meridian of lines and arcs: the distance is that to the nearest
//! of its pieces, and a point is inside where it is behind every line and within every arc that faces it.

use super::refusal::NoOpinion;
use super::vector::usual;

/// What cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A half ball below a cylinder.
    Ball,
    /// A cylinder, with a sharp edge.
    Flat,
    /// A cylinder with a rounded corner.
    Toroidal {
        /// Radius of the corner.
        corner_radius_mm: f64,
    },
    /// A cone below a cylinder.
    Cone {
        /// Half of the cone's angle, deg.
        taper_deg: f64,
        /// Radius of the rounded end.
        corner_radius_mm: f64,
        /// Diameter at which the cone would meet the tip's plane; a ball end where none is given.
        tip_diameter_mm: Option<f64>,
    },
    /// A ball that runs into a large arc, widest at the diameter.
    Barrel {
        /// Radius of the large arc.
        barrel_radius_mm: f64,
        /// Radius of the ball.
        corner_radius_mm: f64,
    },
    /// APT's cutter; the diameter is where the lines of bottom and side meet.
    Apt {
        /// Radius of the corner.
        corner_radius_mm: f64,
        /// Rise of the bottom, deg.
        bottom_angle_deg: f64,
        /// Opening of the side, deg.
        side_angle_deg: f64,
    },
}

/// A section of a holder: a cylinder, or a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HolderPart {
    /// Diameter at its lower end.
    pub diameter_mm: f64,
    /// Diameter at its upper end.
    pub upper_diameter_mm: f64,
    /// Length.
    pub length_mm: f64,
}

/// Cutter, shank and holder.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// The cutter's end.
    pub shape: Shape,
    /// Its diameter.
    pub diameter_mm: f64,
    /// From the tip to the holder.
    pub length_mm: f64,
    /// From the tip to where the edges end and the shank, a cylinder of the greatest diameter, begins; the whole length where
    /// none is given.
    pub flute_mm: Option<f64>,
    /// The holder's sections, from the cutter upwards.
    pub holder: Vec<HolderPart>,
}

/// A signed distance, negative inside, with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Near {
    pub distance: f64,
    pub by_rho: f64,
    pub by_z: f64,
}

#[derive(Clone, Copy, Debug)]
enum Piece {
    /// From a to b, with its outward normal.
    Line { a: [f64; 2], b: [f64; 2], normal: [f64; 2] },
    /// About a centre, over outward normals from the first to the last angle.
    Arc { centre: [f64; 2], radius: f64, angles: [f64; 2] },
}

/// A cylinder or a cone without its point.
#[derive(Clone, Copy, Debug)]
struct Frustum {
    /// Radii of both ends, and their heights above the tip.
    radii: [f64; 2],
    ends: [f64; 2],
}

impl Frustum {
    /// Signed distance, a lower bound beside its rims.
    fn distance(&self, rho: f64, z: f64) -> f64 {
        let ([r, upper], [low, high]) = (self.radii, self.ends);
        // How far the point is out from the flank's line, across it.
        let (run, rise) = (upper - r, high - low);
        let flank = ((rho - r) * rise - (z - low) * run) / (run * run + rise * rise).sqrt();
        flank.max(low - z).max(z - high)
    }
}

#[derive(Clone, Debug)]
enum Profile {
    /// Offset of a cylinder of radius `core` that stands at height `corner`.
    Rounded {
        core: f64,
        corner: f64,
    },
    Meridian(Vec<Piece>),
}

/// A tool ready to be asked.
#[derive(Clone, Debug)]
pub(super) struct Bodies {
    profile: Profile,
    /// Where the cutter ends.
    top: f64,
    /// Corner radius, for what may hide between points.
    pub corner_mm: f64,
    /// Shank and sections of the holder.
    above: Vec<Frustum>,
}

impl Bodies {
    pub fn of(tool: &Tool) -> Result<Self, NoOpinion> {
        let size = |what: &'static str, got: f64, good: bool| {
            if good && usual(got) { Ok(()) } else { Err(NoOpinion::Tool { what, got }) }
        };
        let (radius, length) = (0.5 * tool.diameter_mm, tool.length_mm);
        size("diameter_mm", tool.diameter_mm, radius > 0.0)?;
        size("length_mm", length, length > 0.0)?;
        let top = tool.flute_mm.unwrap_or(length);
        size("flute_mm", top, top > 0.0 && top <= length)?;
        let corner_mm = match tool.shape {
            Shape::Ball => radius,
            Shape::Flat => 0.0,
            Shape::Toroidal { corner_radius_mm: r }
            | Shape::Cone { corner_radius_mm: r, .. }
            | Shape::Barrel { corner_radius_mm: r, .. }
            | Shape::Apt { corner_radius_mm: r, .. } => r,
        };
        size("corner_radius_mm", corner_mm, corner_mm >= 0.0 && corner_mm <= radius && corner_mm < top)?;
        let (profile, widest) = match tool.shape {
            Shape::Ball | Shape::Flat | Shape::Toroidal { .. } => {
                (Profile::Rounded { core: radius - corner_mm, corner: corner_mm }, radius)
            }
            Shape::Cone { taper_deg, tip_diameter_mm, .. } => {
                size("taper_deg", taper_deg, taper_deg > 0.0 && taper_deg < 90.0)?;
                let pieces = cone(radius, corner_mm, (taper_deg.to_radians(), tip_diameter_mm), top);
                let pieces = pieces.ok_or(NoOpinion::Tool { what: "taper_deg", got: taper_deg })?;
                (Profile::Meridian(pieces), radius)
            }
            Shape::Barrel { barrel_radius_mm: large, .. } => {
                size("barrel_radius_mm", large, large > radius && corner_mm < radius)?;
                let pieces = barrel(radius, corner_mm, large, top);
                (Profile::Meridian(pieces.ok_or(NoOpinion::Tool { what: "length_mm", got: top })?), radius)
            }
            Shape::Apt { bottom_angle_deg, side_angle_deg, .. } => {
                let good = (0.0..90.0).contains(&bottom_angle_deg)
                    && side_angle_deg > -90.0
                    && bottom_angle_deg + side_angle_deg < 90.0;
                size("side_angle_deg", side_angle_deg, good)?;
                let angles = [bottom_angle_deg.to_radians(), side_angle_deg.to_radians()];
                let (pieces, widest) = apt(radius, corner_mm, angles, top)
                    .ok_or(NoOpinion::Tool { what: "corner_radius_mm", got: corner_mm })?;
                (Profile::Meridian(pieces), widest)
            }
        };
        let mut above = Vec::new();
        if top < length {
            above.push(Frustum { radii: [widest; 2], ends: [top, length] });
        }
        let mut low = length;
        for part in &tool.holder {
            size("holder diameter_mm", part.diameter_mm, part.diameter_mm > 0.0)?;
            size("holder length_mm", part.length_mm, part.length_mm > 0.0)?;
            size("holder upper_diameter_mm", part.upper_diameter_mm, part.upper_diameter_mm > 0.0)?;
            let radii = [0.5 * part.diameter_mm, 0.5 * part.upper_diameter_mm];
            above.push(Frustum { radii, ends: [low, low + part.length_mm] });
            low += part.length_mm;
        }
        Ok(Self { profile, top, corner_mm, above })
    }

    /// Signed distance from the cutter.
    pub fn cutter(&self, rho: f64, z: f64) -> f64 {
        self.near(rho, z).distance
    }

    /// Signed distance from the cutter with its derivatives; outside, next to the rim at its upper end, a lower bound.
    pub fn near(&self, rho: f64, z: f64) -> Near {
        let low = match &self.profile {
            Profile::Rounded { core, corner } => rounded(rho - core, corner - z, *corner),
            Profile::Meridian(pieces) => from_pieces(pieces, [rho, z]),
        };
        let above = z - self.top;
        if above > low.distance { Near { distance: above, by_rho: 0.0, by_z: 1.0 } } else { low }
    }

    /// Signed distance from shank and holder, a lower bound beside their rims; infinite where there are none.
    pub fn holder(&self, rho: f64, z: f64) -> f64 {
        self.above.iter().map(|f| f.distance(rho, z)).fold(f64::INFINITY, f64::min)
    }

    /// Share of a line at which the cutter, grown by `grown`, is met first, from `0` on and before `limit`.
    ///
    /// `at` and `way` are (along the axis, square of the distance from it) of the line's start and of its direction, `slope` the
    /// product of both across the axis. The distance along a line is convex, as the tool is: Newton's steps from outside
    /// never pass the entry, and each is a lower bound of it.
    pub fn entry(&self, at: [f64; 2], way: [f64; 2], slope: f64, (grown, limit): (f64, f64)) -> Option<f64> {
        /// Far below any tolerance.
        const CLOSE_MM: f64 = 1e-9;
        /// More are taken by lines that graze only, whose entry is then a lower bound.
        const MOST_STEPS: u32 = 50;
        let mut s = 0.0;
        for _ in 0..MOST_STEPS {
            let rho = (at[1] + s * (2.0 * slope + s * way[1])).max(0.0).sqrt();
            let near = self.near(rho, at[0] + s * way[0]);
            let left = near.distance - grown;
            if left <= CLOSE_MM {
                break;
            }
            let outwards = if rho > 1e-12 { (slope + s * way[1]) / rho } else { way[1].max(0.0).sqrt() };
            let falls = near.by_rho * outwards + near.by_z * way[0];
            if falls >= 0.0 {
                return None;
            }
            s -= left / falls;
            if s >= limit {
                return None;
            }
        }
        (s < limit).then_some(s)
    }
}

/// Distance from the offset by `corner` of a quadrant; `out` beyond the core's radius, `down` below its lower end.
fn rounded(out: f64, down: f64, corner: f64) -> Near {
    if out > 0.0 && down > 0.0 {
        let d = (out * out + down * down).sqrt();
        Near { distance: d - corner, by_rho: out / d, by_z: -down / d }
    } else if out >= down {
        Near { distance: out - corner, by_rho: 1.0, by_z: 0.0 }
    } else {
        Near { distance: down - corner, by_rho: 0.0, by_z: -1.0 }
    }
}

fn from_pieces(pieces: &[Piece], p: [f64; 2]) -> Near {
    let mut inside = true;
    let mut best = (f64::INFINITY, [0.0, 1.0]);
    for piece in pieces {
        let (q, normal) = match piece {
            Piece::Line { a, b, normal } => {
                inside &= normal[0] * (p[0] - a[0]) + normal[1] * (p[1] - a[1]) <= 0.0;
                let w = [b[0] - a[0], b[1] - a[1]];
                let t = (w[0] * (p[0] - a[0]) + w[1] * (p[1] - a[1])) / (w[0] * w[0] + w[1] * w[1]);
                let t = t.clamp(0.0, 1.0);
                ([a[0] + t * w[0], a[1] + t * w[1]], *normal)
            }
            Piece::Arc { centre, radius, angles } => {
                let d = [p[0] - centre[0], p[1] - centre[1]];
                let angle = d[1].atan2(d[0]);
                let faced = angle >= angles[0] && angle <= angles[1];
                inside &= !faced || d[0].hypot(d[1]) <= *radius;
                // Beyond both ends the nearer one.
                let at = if faced {
                    angle
                } else {
                    let far = |a: f64| (d[0] - radius * a.cos()).hypot(d[1] - radius * a.sin());
                    if far(angles[0]) <= far(angles[1]) { angles[0] } else { angles[1] }
                };
                let n = [at.cos(), at.sin()];
                ([centre[0] + radius * n[0], centre[1] + radius * n[1]], n)
            }
        };
        let d = (p[0] - q[0]).hypot(p[1] - q[1]);
        if d < best.0 {
            let way = if d > 1e-9 { [(p[0] - q[0]) / d, (p[1] - q[1]) / d] } else { normal };
            best = (d, way);
        }
    }
    let (d, way) = best;
    // On the boundary the normal points out from either side.
    let sign = if inside && d > 1e-9 { -1.0 } else { 1.0 };
    Near { distance: if inside { -d } else { d }, by_rho: sign * way[0], by_z: sign * way[1] }
}

fn line(a: [f64; 2], b: [f64; 2]) -> Option<Piece> {
    let (x, z) = (b[0] - a[0], b[1] - a[1]);
    let length = x.hypot(z);
    // Upwards the outside is to the right.
    (length > 1e-12).then(|| Piece::Line { a, b, normal: [z / length, -x / length] })
}

const DOWN: f64 = -std::f64::consts::FRAC_PI_2;

fn arc(centre: [f64; 2], radius: f64, angles: [f64; 2]) -> Option<Piece> {
    (radius > 0.0 && angles[1] > angles[0]).then_some(Piece::Arc { centre, radius, angles })
}

fn on(centre: [f64; 2], radius: f64, angle: f64) -> [f64; 2] {
    [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
}

/// The corner's centre is where the flank, offset inwards by the corner, has the corner's height.
fn cone(radius: f64, corner: f64, (taper, tip): (f64, Option<f64>), top: f64) -> Option<Vec<Piece>> {
    let (sin, cos) = taper.sin_cos();
    // The flank goes through (tip radius, 0): cos rho - sin z = cos tip.
    let core = tip.map_or(0.0, |d| 0.5 * d - corner * (1.0 - sin) / cos);
    let centre = [core, corner];
    let begin = on(centre, corner, -taper);
    let end = [radius, begin[1] + (radius - begin[0]) * cos / sin];
    if core < 0.0 || end[0] <= begin[0] || end[1] > top {
        return None;
    }
    let pieces = [
        line([0.0, 0.0], [core, 0.0]),
        arc(centre, corner, [DOWN, -taper]),
        line(begin, end),
        line(end, [radius, top]),
        line([radius, top], [0.0, top]),
    ];
    Some(pieces.into_iter().flatten().collect())
}

/// Both arcs touch where the line of their centres leaves them.
fn barrel(radius: f64, corner: f64, large: f64, top: f64) -> Option<Vec<Piece>> {
    let sideways = large - radius;
    let up = ((large - corner).powi(2) - sideways * sideways).sqrt();
    let (low, high) = ([0.0, corner], [-sideways, corner + up]);
    let meet = -up.atan2(sideways);
    let sine = (top - high[1]) / large;
    let end = sine.asin();
    let rim = on(high, large, end);
    // The widest place lies below the top, the top below where the barrel is back at the axis.
    if !(0.0..1.0).contains(&sine) || rim[0] <= 0.0 {
        return None;
    }
    let pieces =
        [arc(low, corner, [DOWN, meet]), arc(high, large, [meet, end]), line([rim[0], top], [0.0, top])];
    Some(pieces.into_iter().flatten().collect())
}

/// The corner's arc touches the lines of bottom and side, which meet at the radius; its centre lies on the bisector of both.
/// With it the greatest radius below the top.
fn apt(radius: f64, corner: f64, [bottom, side]: [f64; 2], top: f64) -> Option<(Vec<Piece>, f64)> {
    let meet = [radius, radius * bottom.tan()];
    // Towards the tip along the bottom, and up along the side.
    let (inwards, upwards) = ([-bottom.cos(), -bottom.sin()], [side.sin(), side.cos()]);
    let opening = (inwards[0] * upwards[0] + inwards[1] * upwards[1]).clamp(-1.0, 1.0).acos();
    let (along, away) = (corner / (0.5 * opening).tan(), corner / (0.5 * opening).sin());
    let bisector = [inwards[0] + upwards[0], inwards[1] + upwards[1]];
    let size = bisector[0].hypot(bisector[1]);
    let centre = [meet[0] + away * bisector[0] / size, meet[1] + away * bisector[1] / size];
    let touch = [meet[0] + along * inwards[0], meet[1] + along * inwards[1]];
    let begin = [meet[0] + along * upwards[0], meet[1] + along * upwards[1]];
    let end = [radius + (top - meet[1]) * side.tan(), top];
    // Rounding of a ball's centre.
    if centre[0] < -1e-12 * radius || touch[0] < -1e-9 * radius || begin[1] >= top || end[0] <= 0.0 {
        return None;
    }
    let touch = [touch[0].max(0.0), touch[1].max(0.0)];
    let pieces = [
        line([0.0, 0.0], touch),
        arc([centre[0].max(0.0), centre[1]], corner, [DOWN + bottom, -side]),
        line(begin, end),
        line(end, [0.0, top]),
    ];
    Some((pieces.into_iter().flatten().collect(), end[0].max(centre[0] + corner).max(begin[0])))
}

#[cfg(test)]
#[path = "tool_tests.rs"]
mod tests;
