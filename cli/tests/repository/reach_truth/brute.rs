//! Which axes are possible at a place, by asking every axis about every point: of `tools::reach` only the types of the question are
//! used.
//!
//! With x the contact, n the outward normal there, a the axis, R the cutter's radius and r that of its corner, the circle of
//! corner centres stands at right angles to a about
//!
//! `c = x + r n + (R - r) m`, `m = (n - (n . a) a) / |n - (n . a) a|`.
//!
//! Its plane lies r above the tip. Bodies end above with a flat face, and distances are Euclidean all around them.

use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::reach::{ObstacleKind, ObstaclePoint, Place};

/// What two ways to the same spare may differ by, mm. A direction is known to 1e-16, so that `m` is known to 6e-15 at a lean of one
/// degree, and with coordinates of 6 m and tools of 0.3 m a distance to some 1e-12 mm; the rest is room.
pub const SLACK_MM: f64 = 1e-9;
/// The same for a lean, rad: a cosine is known to 1e-16, the lean of one degree that belongs to it to 6e-15.
pub const SLACK_RAD: f64 = 1e-12;

/// A body of revolution on the tool's axis: a cylinder with a rounded lower edge.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    pub radius_mm: f64,
    /// Radius of the lower edge.
    pub corner_mm: f64,
    /// Heights of its ends above the tip.
    pub from_mm: f64,
    pub to_mm: f64,
    /// Least distance from points of the part, and from those of other things.
    pub part_mm: f64,
    pub other_mm: f64,
}

impl Body {
    /// Signed distance of a point at a distance from the axis and a height above the tip, mm.
    fn distance_mm(&self, rho: f64, z: f64) -> f64 {
        // Plain: several times as fast as hypot, and millimetres neither overflow nor underflow.
        let norm = |x: f64, y: f64| (x * x + y * y).sqrt();
        let (side, top) = (rho - self.radius_mm, z - self.to_mm);
        let below = self.from_mm + self.corner_mm - z;
        if below > 0.0 {
            let core = self.radius_mm - self.corner_mm;
            norm((rho - core).max(0.0), below) - self.corner_mm
        } else if side > 0.0 && top > 0.0 {
            norm(side, top)
        } else {
            side.max(top).max(self.from_mm - z)
        }
    }

    fn limit_mm(&self, kind: ObstacleKind) -> f64 {
        match kind {
            ObstacleKind::Part => self.part_mm,
            ObstacleKind::Surroundings | ObstacleKind::Stock => self.other_mm,
        }
    }
}

/// What a direction is at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Its lean is out of the limits.
    Leaning,
    /// All points keep their limits by more than the slack.
    Free,
    /// A point is deeper than its limit in this body by more than the slack.
    Blocked(usize),
    /// The lean, or the least spare of all points, is within the slack of its limit; and whether it is possible all the same.
    Close(bool),
}

/// A tool and what it must keep out of.
pub struct Brute {
    /// The cutter first.
    pub bodies: Vec<Body>,
    /// Least and greatest angle between axis and normal.
    pub lean_rad: [f64; 2],
    pub points: Vec<ObstaclePoint>,
}

/// Where the tool stands: the centre of the circle of corner centres, and the axis.
struct Stand {
    centre: Point3,
    axis: Vec3,
}

impl Brute {
    fn stand(&self, place: &Place, axis: &Unit3) -> Stand {
        let (n, a) = (place.normal.into_inner(), axis.into_inner());
        let Body { radius_mm, corner_mm, .. } = self.bodies[0];
        let across = n - a * n.dot(&a);
        let core = radius_mm - corner_mm;
        // A ball has no circle.
        let ring = if core > 0.0 { across * (core / across.norm()) } else { Vec3::zeros() };
        Stand { centre: place.point + n * corner_mm + ring, axis: a }
    }

    /// The greatest of a length of all bodies, mm, and no less than nothing.
    fn most_mm(&self, of: impl Fn(&Body) -> f64) -> f64 {
        self.bodies.iter().map(of).fold(0.0, f64::max)
    }

    /// Beyond this distance from a body every point keeps its limit by more than the slack.
    fn apart_mm(&self) -> f64 {
        self.most_mm(|b| b.part_mm.max(b.other_mm)) + 2.0 * SLACK_MM
    }

    /// The points that the tool can come near to whatever its axis: the contact is on the tool, so that nothing of it is further
    /// away than the tool is long and wide.
    fn near(&self, place: &Place) -> Vec<ObstaclePoint> {
        let wide = self.bodies[0].radius_mm + self.most_mm(|b| b.radius_mm);
        let reach = wide.hypot(self.most_mm(|b| b.to_mm)) + self.apart_mm();
        self.points.iter().filter(|p| (p.point - place.point).norm() < reach).copied().collect()
    }

    /// The spares of points, mm, each with the body that leaves so little; those that are more than the slack may be left out.
    fn spares<'a>(
        &'a self,
        stand: &'a Stand,
        points: &'a [ObstaclePoint],
    ) -> impl Iterator<Item = (f64, usize, ObstaclePoint)> {
        let apart = self.apart_mm();
        let (wide, high) = (self.most_mm(|b| b.radius_mm) + apart, self.most_mm(|b| b.to_mm) + apart);
        let corner = self.bodies[0].corner_mm;
        points.iter().filter_map(move |p| {
            let w = p.point - stand.centre;
            let up = w.dot(&stand.axis);
            let (z, across2) = (up + corner, (w - stand.axis * up).norm_squared());
            // Away from the cylinder around all bodies.
            if z < -apart || z > high || across2 > wide * wide {
                return None;
            }
            let rho = across2.sqrt();
            let of = |(k, body): (usize, &Body)| (body.distance_mm(rho, z) - body.limit_mm(p.kind), k, *p);
            self.bodies.iter().enumerate().map(of).min_by(|a, b| a.0.total_cmp(&b.0))
        })
    }

    /// How far the lean of an axis is within its limits, rad.
    fn lean_spare_rad(&self, place: &Place, axis: &Unit3) -> f64 {
        let lean = place.normal.cross(axis).norm().atan2(place.normal.dot(axis));
        let [least, most] = self.lean_rad;
        if least > 0.0 { (lean - least).min(most - lean) } else { most - lean }
    }

    /// The answers for all directions at a place.
    pub fn answers(&self, place: &Place, directions: &[Unit3]) -> Vec<Answer> {
        let near = self.near(place);
        // What blocked the direction before often blocks this one too: it is asked first.
        let mut last: Option<ObstaclePoint> = None;
        let answer = |axis: &Unit3| {
            let lean = self.lean_spare_rad(place, axis);
            if lean < -SLACK_RAD {
                return Answer::Leaning;
            }
            let stand = self.stand(place, axis);
            let (mut least, first) = (f64::INFINITY, last);
            for points in [first.as_slice(), &near] {
                for (spare, body, p) in self.spares(&stand, points) {
                    if spare < -SLACK_MM {
                        last = Some(p);
                        return Answer::Blocked(body);
                    }
                    least = least.min(spare);
                }
            }
            let is_close = least <= SLACK_MM || lean <= SLACK_RAD;
            if is_close { Answer::Close(least >= 0.0 && lean >= 0.0) } else { Answer::Free }
        };
        directions.iter().map(answer).collect()
    }

    /// The least spare of all points, mm; infinite where none is near.
    pub fn least_mm(&self, place: &Place, axis: &Unit3) -> f64 {
        let stand = self.stand(place, axis);
        self.spares(&stand, &self.points).map(|(spare, ..)| spare).fold(f64::INFINITY, f64::min)
    }
}
