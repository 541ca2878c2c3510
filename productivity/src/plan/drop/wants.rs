//! Where passes must go: for every place of the faces the range of levels that leave no more than the design height.
//!
//! A tool with a fixed axis touches a place of normal n from one position only; a pass at another level passes it at
//! a distance. To leading order a tool moved by tau in the tangent plane and laid down again leaves
//! `h = 1/2 tau^T M tau`, `M = W_T Q^-1 W_T`: Q = W_P + W_T is the form of part and tool, and the sliding of the contact is
//! in it. Along the pass tau is free, so that the least over it counts.

use super::frame::Frame;
use osculate_geom::{Surface, Unit3, Uv};
use osculate_tools::Cutter;
use osculate_tools::removal::Sample;

/// Below this cosine between normal and axis a place is a wall or an undercut: the side of the tool meets it, not its end.
const STEEPEST: f64 = 0.02;
/// What rounding makes of the normal of a wall along the axis.
const UPRIGHT: f64 = 1e-9;
/// Above this cosine between normal and axis waterlines lie further apart than is worth while: 45 degrees.
const FLATTEST: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A flat bottom over a slope rises by this part of the height at most, from rim to rim, for the ground to count as level.
pub(super) const LEVEL: f64 = 0.1;

/// Of its radius, how far from its axis a flat end with a sharp rim is counted on: what the rim only grazes one tooth meets and the next one may not.
const RIM: f64 = 0.97;

/// What a sample wants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Want {
    /// Position of the tool that touches it, along and across the feed, mm.
    pub at: [f64; 2],
    /// Height of the tip there, mm.
    pub tip: f64,
    /// Passes within this distance of its level leave no more than the design height, mm.
    pub reach: f64,
    /// How far the positions of the places that it stands for lie from its own, along and across the feed, mm.
    pub half: [f64; 2],
    /// The area that it stands for, mm2.
    pub area: f64,
    /// The face's outer normal there.
    pub normal: Unit3,
    /// Its parameters.
    pub uv: Uv,
}

impl Want {
    /// How far the positions of the places that it stands for lie from its own in any direction, mm.
    pub(super) fn widest(&self) -> f64 {
        self.half[0].max(self.half[1])
    }
}

/// Why a sample cannot be cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lost {
    /// It faces away from the axis, or sideways.
    Undercut,
    /// Its contour line is hollow and bends tighter than the cutter's circle there: undercut on three axes [M86].
    TightContour,
    /// The tool does not fit into its hollow in another direction.
    TooHollow,
    /// It has no tangent plane.
    NoTangent,
    /// It is flatter than waterlines are for.
    Flat,
}

/// The position from which the tool touches a sample and how far off the level of a pass may be that leaves `height_mm`;
/// samples stand `spacing_mm` apart.
///
/// Passes lie in planes along the feed; with `around` at constant heights, and how far off then is measured up the axis.
pub(super) fn want(
    (surface, s): (&dyn Surface, &Sample),
    (cutter, frame): (&Cutter, &Frame),
    around: bool,
    [height_mm, spacing_mm]: [f64; 2],
) -> Result<Want, Lost> {
    let n = frame.along(&s.normal);
    if n[2] < if around { -UPRIGHT } else { STEEPEST } {
        return Err(Lost::Undercut);
    }
    if around && n[2] > FLATTEST {
        return Err(Lost::Flat);
    }
    let sine = n[0].hypot(n[1]);
    let slope = sine.atan2(n[2]);
    let arc = cutter.touching(slope);
    let (out, level) = if sine > 0.0 { ([n[0] / sine, n[1] / sine], sine) } else { ([0.0, 0.0], 0.0) };
    let rho = arc.centre_rho_mm + arc.radius_mm * level;
    let [x, y, z] = frame.of(&s.point);
    let at = [x + rho * out[0], y + rho * out[1]];
    let tip = z - (arc.centre_z_mm - arc.radius_mm * n[2]);
    // No tool leaves less than h further from its axis than where its lower side rises by h.
    let rise = height_mm.min(arc.radius_mm);
    let bottom = if arc.radius_mm > 0.0 { 1.0 } else { RIM };
    let most = bottom * arc.centre_rho_mm.max(0.0) + (rise * (2.0 * arc.radius_mm - rise)).max(0.0).sqrt();
    let wanted =
        Want { at: [x, y], tip, reach: most, half: [0.0; 2], area: s.area_mm2, normal: s.normal, uv: s.uv };
    if arc.centre_rho_mm > 0.0 && 2.0 * arc.centre_rho_mm * sine <= LEVEL * height_mm {
        // Level ground under a flat bottom: its middle comes down there, and its rim covers all around.
        let tip = z - (arc.centre_z_mm - arc.radius_mm);
        return Ok(Want { tip, half: [0.5 * spacing_mm; 2], ..wanted });
    }
    let forms = surface.jet2(s.uv).forms().map_err(|_| Lost::NoTangent)?;
    // In the tangent frame (down the slope, across it) the tool's curvatures are those of meridian and parallel.
    let meridian = 1.0 / arc.radius_mm.max(height_mm);
    let parallel = if rho > 0.0 { (level / rho).min(meridian) } else { meridian };
    let d = [out[0] * n[2], out[1] * n[2], -sine];
    let c = |v: &osculate_geom::Vec3| {
        let w = frame.along(v);
        if sine > 0.0 {
            // The cross direction is n x d.
            let e = [n[1] * d[2] - n[2] * d[1], n[2] * d[0] - n[0] * d[2], n[0] * d[1] - n[1] * d[0]];
            [dot(w, d), dot(w, e)]
        } else {
            [w[0], w[1]]
        }
    };
    // W_P in that frame.
    let (a, b) = (c(&forms.frame[0]), c(&forms.frame[1]));
    let w = &forms.curvature;
    let part = |p: usize, q: usize| {
        w[(0, 0)] * a[p] * a[q] + w[(0, 1)] * (a[p] * b[q] + b[p] * a[q]) + w[(1, 1)] * b[p] * b[q]
    };
    let q = [part(0, 0) + meridian, part(0, 1), part(1, 1) + parallel];
    let det = q[0] * q[2] - q[1] * q[1];
    if sine > 0.0 && q[2] <= 0.0 {
        return Err(Lost::TightContour);
    }
    if !(q[0] > 0.0 && det > 0.0) {
        return Err(Lost::TooHollow);
    }
    // M = W_T Q^-1 W_T with diagonal W_T.
    let m = [
        meridian * meridian * q[2] / det,
        -meridian * parallel * q[1] / det,
        parallel * parallel * q[0] / det,
    ];
    // The feed in the tangent plane: across e_y, and the direction next to it, which rises with e_y by the cosine. At constant
    // height it is e, and what is next to it rises by the sine.
    let (feed, cosine) = if around {
        ([0.0, 1.0], sine)
    } else if sine > 0.0 {
        // e_y in the frame (d, e) of the tangent plane; the feed is at right angles to it there.
        let e_y = [d[1], n[2] * d[0] - n[0] * d[2]];
        let length = e_y[0].hypot(e_y[1]);
        if length < STEEPEST {
            return Err(Lost::Undercut);
        }
        ([e_y[1] / length, -e_y[0] / length], length)
    } else {
        ([1.0, 0.0], 1.0)
    };
    let form = m[0] * feed[0] * feed[0] + 2.0 * m[1] * feed[0] * feed[1] + m[2] * feed[1] * feed[1];
    let across = (m[0] * m[2] - m[1] * m[1]) / form.max(f64::MIN_POSITIVE);
    let reach = if across > 0.0 { cosine * (2.0 * height_mm / across).sqrt() } else { most };
    // A step d over the part takes the tool along by (1 + R W) d: further where the part is convex, and only in the direction in which it
    // bends.
    let taken = |x: f64, y: f64| {
        let [x, y] = [
            x + cutter.radius_mm() * (w[(0, 0)] * x + w[(0, 1)] * y),
            y + cutter.radius_mm() * (w[(0, 1)] * x + w[(1, 1)] * y),
        ];
        0.5 * spacing_mm * x.hypot(y).max(1.0)
    };
    let frames = forms.frame.map(|e| frame.along(&e));
    let half = [0, 1].map(|k| taken(frames[0][k], frames[1][k]));
    Ok(Want { at, tip, reach: reach.min(most.max(height_mm)), half, ..wanted })
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
