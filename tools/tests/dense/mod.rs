//! Strips by brute force: a cutter of closed forms, put down anew at hundreds of places along its feed line, and at every
//! place across the lowest point of all of them over the part's normal.
//!
//! Nothing of the strip's own search is used: not the cutter's entry, not its contact, not its velocity. A body is the convex
//! function of one corner, two straight lines and a barrel arc in (rho, z); a normal's lowest point in it comes by bisection,
//! the deepest instant by a scan and golden sections.

use osculate_geom::geodesic::GeodesicState;
use osculate_geom::{Darboux, Point3, Surface, Vec3};
use osculate_tools::{Contact, CutterSpec, Lean};

/// The body: a corner between two straight lines by their outward normals, a cylinder, and a barrel arc.
pub struct Body {
    corner: [f64; 2],
    corner_radius: f64,
    normals: [[f64; 2]; 2],
    radius: f64,
    /// Centre and radius of the arc that goes on from the corner.
    barrel: Option<([f64; 2], f64)>,
    length: f64,
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

impl Body {
    pub fn new(spec: CutterSpec) -> Self {
        let end = |diameter: f64, r: f64, length: f64| Self {
            corner: [0.5 * diameter - r, r],
            corner_radius: r,
            normals: [[0.0, -1.0], [1.0, 0.0]],
            radius: 0.5 * diameter,
            barrel: None,
            length,
        };
        // A corner of radius r between two lines n . p = at: its centre is r inside both.
        let between = |n: [[f64; 2]; 2], at: [f64; 2], r: f64| {
            let (a, b) = (at[0] - r, at[1] - r);
            let det = cross(n[0], n[1]);
            [(a * n[1][1] - b * n[0][1]) / det, (b * n[0][0] - a * n[1][0]) / det]
        };
        match spec {
            CutterSpec::Ball { diameter_mm, length_mm } => end(diameter_mm, 0.5 * diameter_mm, length_mm),
            CutterSpec::Flat { diameter_mm, length_mm }
            | CutterSpec::Cylindrical { diameter_mm, length_mm } => end(diameter_mm, 0.0, length_mm),
            CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm } => {
                end(diameter_mm, corner_radius_mm, length_mm)
            }
            CutterSpec::Cone { diameter_mm, taper_deg, corner_radius_mm: r, tip_diameter_mm, length_mm } => {
                let (s, c) = taper_deg.to_radians().sin_cos();
                let normals = [[0.0, -1.0], [c, -s]];
                let corner =
                    tip_diameter_mm.map_or([0.0, r], |tip| between(normals, [0.0, 0.5 * tip * c], r));
                Self { corner, normals, corner_radius: r, ..end(diameter_mm, 0.0, length_mm) }
            }
            CutterSpec::Barrel { diameter_mm, barrel_radius_mm, corner_radius_mm: r, length_mm } => {
                let sideways = barrel_radius_mm - 0.5 * diameter_mm;
                let up = ((barrel_radius_mm - r).powi(2) - sideways * sideways).sqrt();
                // The large arc's centre beyond the axis, as high as the widest place; the line through both centres parts
                // ball and arc.
                let from = [sideways, -up];
                let size = from[0].hypot(from[1]);
                let normals = [[0.0, -1.0], [from[0] / size, from[1] / size]];
                let barrel = Some(([-sideways, r + up], barrel_radius_mm));
                Self {
                    corner: [0.0, r],
                    normals,
                    corner_radius: r,
                    barrel,
                    ..end(diameter_mm, 0.0, length_mm)
                }
            }
            CutterSpec::Apt {
                diameter_mm,
                corner_radius_mm: r,
                bottom_angle_deg,
                side_angle_deg,
                length_mm,
            } => {
                let (sa, ca) = bottom_angle_deg.to_radians().sin_cos();
                let (sb, cb) = side_angle_deg.to_radians().sin_cos();
                let normals = [[sa, -ca], [cb, -sb]];
                let d = 0.5 * diameter_mm;
                let corner = between(normals, [0.0, d * cb - d * sa / ca * sb], r);
                Self {
                    corner,
                    normals,
                    corner_radius: r,
                    radius: f64::INFINITY,
                    barrel: None,
                    length: length_mm,
                }
            }
        }
    }

    /// Negative inside, convex.
    fn inside(&self, rho: f64, z: f64) -> f64 {
        let p = [rho - self.corner[0], z - self.corner[1]];
        let [a, b] = self.normals;
        let dot = |n: [f64; 2]| n[0] * p[0] + n[1] * p[1];
        let own = if cross(a, p) >= 0.0 && cross(p, b) >= 0.0 {
            p[0].hypot(p[1]) - self.corner_radius
        } else if let Some((centre, radius)) = self.barrel
            && cross(b, p) > 0.0
        {
            (rho - centre[0]).hypot(z - centre[1]) - radius
        } else {
            dot(a).max(dot(b)) - self.corner_radius
        };
        own.max(rho - self.radius).max(z - self.length)
    }

    /// The boundary point that touches a plane from which the axis leans away by `lead`.
    fn touching(&self, lead: f64) -> [f64; 2] {
        let d = [lead.sin(), -lead.cos()];
        if let Some(([x, y], radius)) = self.barrel
            && cross(self.normals[1], d) > 0.0
        {
            return [x + radius * d[0], y + radius * d[1]];
        }
        [self.corner[0] + self.corner_radius * d[0], self.corner[1] + self.corner_radius * d[1]]
    }

    fn placed(&self, lean: Lean, lift_mm: f64, frame: &Darboux) -> Placed<'_> {
        let (s, c) = lean.tilt_rad.sin_cos();
        let heading = frame.tangent.into_inner() * c + frame.left.into_inner() * s;
        let n = frame.normal.into_inner();
        // A negative lead is the positive one with the opposite heading.
        let heading = if lean.lead_rad < 0.0 { -heading } else { heading };
        let (s, c) = lean.lead_rad.abs().sin_cos();
        let axis = n * c + heading * s;
        let low = heading * c - n * s;
        let [rho, z] = self.touching(lean.lead_rad.abs());
        Placed { body: self, tip: frame.point + n * lift_mm - axis * z - low * rho, axis }
    }
}

struct Placed<'a> {
    body: &'a Body,
    tip: Point3,
    axis: Vec3,
}

impl Placed<'_> {
    /// The lowest point of the body on a line, between `from` and `to`; infinite where it does not meet it.
    fn lowest(&self, origin: &Point3, normal: &Vec3, [from, to]: [f64; 2]) -> f64 {
        let f = |s: f64| {
            let w = origin + normal * s - self.tip;
            let z = w.dot(&self.axis);
            self.body.inside((w - self.axis * z).norm(), z)
        };
        let (mut a, mut b) = (from, to);
        if f(a) <= 0.0 {
            return from;
        }
        // Golden sections on a convex function until a point inside is met.
        const G: f64 = 0.618_033_988_749_895;
        let (mut x, mut y) = (b - G * (b - a), a + G * (b - a));
        let (mut fx, mut fy) = (f(x), f(y));
        let mut deep = None;
        for _ in 0..60 {
            if fx <= 0.0 || fy <= 0.0 {
                deep = Some(if fx <= 0.0 { x } else { y });
                break;
            }
            if fx < fy {
                (b, y, fy) = (y, x, fx);
                x = b - G * (b - a);
                fx = f(x);
            } else {
                (a, x, fx) = (x, y, fy);
                y = a + G * (b - a);
                fy = f(y);
            }
        }
        let Some(mut inside) = deep else { return f64::INFINITY };
        let mut outside = from;
        for _ in 0..48 {
            let m = 0.5 * (inside + outside);
            if f(m) <= 0.0 { inside = m } else { outside = m }
        }
        inside
    }
}

/// What the brute force found.
#[derive(Clone, Copy, Debug)]
pub struct Dense {
    pub left_mm: f64,
    pub right_mm: f64,
    /// Lowest height of the places inside the strip, negative below the part.
    pub lowest_mm: f64,
    /// Places whose lowest point comes at an instant more than a fifth of the radius from the contact's.
    pub other_passages: usize,
}

/// How finely: steps along the feed and across it.
pub struct Steps {
    pub along_mm: f64,
    pub across_mm: f64,
}

/// States of a geodesic from the contact on to `reach`, as far as the surface goes.
fn states(contact: &Contact<'_>, direction: &Vec3, step: f64, reach: f64) -> Vec<GeodesicState> {
    const SMALL: usize = 4;
    let start = GeodesicState::start(contact.surface, contact.at, direction).unwrap();
    let mut all = vec![start];
    for _ in 0..(reach / step).ceil() as usize {
        let mut next = all[all.len() - 1];
        for _ in 0..SMALL {
            let Ok(s) = next.step(contact.surface, step / SMALL as f64) else { return all };
            next = s;
        }
        if !contact.surface.domain().contains(next.at) {
            break;
        }
        all.push(next);
    }
    all
}

fn frame(surface: &dyn Surface, s: GeodesicState, sign: f64) -> Option<Darboux> {
    let jet = surface.jet2(s.at);
    Darboux::new(&jet, &(jet.tangent(s.rate) * sign), 0.0).ok()
}

/// The strip of a contact fed along a geodesic, walked to `reach_mm` at most.
pub fn dense(contact: &Contact<'_>, spec: CutterSpec, h: f64, steps: &Steps, reach_mm: f64) -> Dense {
    let body = Body::new(spec);
    let surface = contact.surface;
    let size = 2.2 * contact.cutter.radius_mm() + body.length * contact.lean.lead_rad.sin().abs();
    let feed = contact.frame.tangent.into_inner();
    let sides = [1.0, -1.0].map(|sign| (sign, states(contact, &(feed * sign), steps.along_mm, size)));
    // From behind to ahead, by arc length.
    let place = |t: f64| -> Option<Placed<'_>> {
        let (sign, way) = &sides[usize::from(t < 0.0)];
        let k = ((t.abs() / steps.along_mm) as usize).min(way.len() - 1);
        let rest = t.abs() - k as f64 * steps.along_mm;
        if rest > 1.5 * steps.along_mm {
            return None;
        }
        let state = way[k].step(surface, rest).ok()?;
        if !surface.domain().contains(state.at) {
            return None;
        }
        let f = frame(surface, state, *sign)?;
        (f.normal.dot(&contact.frame.normal) > 0.0).then(|| body.placed(contact.lean, contact.lift_mm, &f))
    };
    let last = [1, 0].map(|k| sides[k].1.len() as i64 - 1);
    let placed: Vec<(f64, Placed<'_>)> = (-last[0]..=last[1])
        .filter_map(|k| place(k as f64 * steps.along_mm).map(|p| (k as f64 * steps.along_mm, p)))
        .collect();
    let span = [-0.25 * contact.cutter.radius_mm(), 3.0 * contact.cutter.radius_mm()];
    let height = |at: GeodesicState| -> (f64, f64) {
        let jet = surface.jet2(at.at);
        let normal = jet.normal().unwrap().into_inner();
        let over = |p: &Placed<'_>| p.lowest(&jet.point, &normal, span);
        let heights: Vec<f64> = placed.iter().map(|(_, p)| over(p)).collect();
        let mut best = (f64::INFINITY, 0.0);
        for k in 0..heights.len() {
            let (before, after) = (k.checked_sub(1).map(|j| heights[j]), heights.get(k + 1).copied());
            let falls = before.map_or(0.0, |b| b - heights[k]).max(after.map_or(0.0, |a| a - heights[k]));
            let lowest_here = before.is_none_or(|b| heights[k] <= b) && after.is_none_or(|a| heights[k] <= a);
            // Within the step the body goes down by no more than it has on the way here, or two.
            if !(lowest_here
                && heights[k].is_finite()
                && heights[k] - 2.0 * falls.min(1.0) < best.0.min(1.5 * h))
            {
                continue;
            }
            let t = placed[k].0;
            let (mut a, mut b) = (t - steps.along_mm, t + steps.along_mm);
            let mut seen = (heights[k], t);
            for _ in 0..36 {
                const G: f64 = 0.381_966_011_250_105;
                let (x, y) = (a + G * (b - a), b - G * (b - a));
                let [fx, fy] = [x, y].map(|t| place(t).map_or(f64::INFINITY, |p| over(&p)));
                for (f, t) in [(fx, x), (fy, y)] {
                    if f < seen.0 {
                        seen = (f, t);
                    }
                }
                if fx < fy { b = y } else { a = x }
            }
            if seen.0 < best.0 {
                best = seen;
            }
        }
        best
    };
    let mut found = Dense { left_mm: 0.0, right_mm: 0.0, lowest_mm: f64::INFINITY, other_passages: 0 };
    for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
        let across = contact.frame.left.into_inner() * sign;
        let way = states(contact, &across, steps.across_mm, reach_mm);
        let mut edge = (way.len() - 1) as f64 * steps.across_mm;
        for (j, state) in way.iter().enumerate() {
            let (f, t) = height(*state);
            if f > h {
                let (mut inside, mut outside) = (-steps.across_mm, 0.0);
                for _ in 0..24 {
                    let m = 0.5 * (inside + outside);
                    let over = state.step(surface, m).map_or(f64::INFINITY, |s| height(s).0);
                    if over > h { outside = m } else { inside = m }
                }
                edge = j as f64 * steps.across_mm + inside;
                break;
            }
            found.lowest_mm = found.lowest_mm.min(f);
            found.other_passages += usize::from(t.abs() > 0.2 * contact.cutter.radius_mm());
        }
        *(if k == 0 { &mut found.left_mm } else { &mut found.right_mm }) = edge;
    }
    found
}
