//! What the tool must keep out of: points in a binary tree of balls.
//!
//! Each ball holds all points of its node; the leaves are single points, balls of radius 0. Points of the part, of what
//! else is around and of stock stand in trees of their own, so that a node has one limit. Points of a face lie in a thin slab as well:
//! next to a tool that touches the face the slab says far more than the ball.

use crate::cutter::Cutter;
use crate::pose::Pose;
use osculate_geom::{Point3, Vec3};

/// Added to the radius of a ball, of the size of the coordinates: it was computed, and must not come out too small.
const ROUNDING: f64 = 1e-14;

/// What a point belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ObstacleKind {
    /// A face of the part: the cutter may go into it as deep as the gouge limit.
    Part,
    /// Fixture, table, stock that is to stay: cutter and holder alike keep their clearance.
    Surroundings,
    /// Stock that the cutter may take; what is mounted above it keeps its clearance.
    Stock,
}

/// All kinds, in the order of their trees.
const KINDS: [ObstacleKind; 3] = [ObstacleKind::Part, ObstacleKind::Surroundings, ObstacleKind::Stock];

/// A point that the tool must keep out of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstaclePoint {
    /// Where it is, mm.
    pub point: Point3,
    /// Index of the face or body that it lies on, as the caller counts them.
    pub owner: u32,
    /// What that is.
    pub kind: ObstacleKind,
}

/// Why points are no obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ObstaclesError {
    /// A coordinate is not finite.
    #[error("obstacle point {index} has a coordinate that is not finite")]
    Point {
        /// Which point.
        index: usize,
    },
    /// More points than an index can hold.
    #[error("{count} obstacle points are too many: the most is {most}")]
    Count {
        /// Number of points.
        count: usize,
        /// The most that there may be.
        most: usize,
    },
}

/// A ball around points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub centre: Point3,
    pub radius_mm: f64,
    /// The second half of it, the first half follows the ball itself; zero for a single point.
    pub second: u32,
    /// Its first point in [`Obstacles::points`].
    pub first: u32,
    /// Its slab among all; none where it is this.
    pub slab: u32,
}

/// No slab.
const NONE: u32 = u32::MAX;
/// Balls of so many points have slabs: fewer are as soon looked at, more are seldom flat.
const SLABS: [usize; 2] = [4, 4096];

/// The space between two planes, in which all points of a ball lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab {
    /// Unit normal of both.
    normal: Vec3,
    /// Heights of both above the centre of the ball, mm.
    from_mm: f64,
    to_mm: f64,
}

impl Slab {
    /// A slab about points, as thin as three of them say.
    fn about(points: &[ObstaclePoint], centre: &Point3) -> Option<Self> {
        let furthest = |by: &dyn Fn(&Vec3) -> f64| {
            let all = points.iter().map(|p| p.point - centre);
            all.fold((0.0, Vec3::zeros()), |best, w| {
                let own = by(&w);
                if own > best.0 { (own, w) } else { best }
            })
        };
        let (_, along) = furthest(&Vec3::norm_squared);
        let (_, other) = furthest(&|w| w.cross(&along).norm_squared());
        let normal = along.cross(&other).try_normalize(f64::MIN_POSITIVE)?;
        let heights = || points.iter().map(|p| normal.dot(&(p.point - centre)));
        let (from_mm, to_mm) = (heights().fold(0.0, f64::min), heights().fold(0.0, f64::max));
        Some(Self { normal, from_mm, to_mm })
    }

    /// The least that a function may change from the centre of a ball to any point of it in this slab, whose slope is the
    /// unit vector `slope`, mm.
    pub fn least_mm(&self, slope: &Vec3, radius_mm: f64) -> f64 {
        let up = self.normal.dot(slope);
        let along = (1.0 - up * up).max(0.0).sqrt();
        (up * self.from_mm).min(up * self.to_mm) - along * radius_mm
    }
}

/// All points that the tool must keep out of.
#[derive(Clone, Debug, Default)]
pub struct Obstacles {
    /// In the order of the leaves.
    points: Vec<ObstaclePoint>,
    balls: Vec<Ball>,
    slabs: Vec<Slab>,
    /// Where the balls of each kind end.
    ends: [usize; KINDS.len()],
    /// Greatest coordinate of any point, mm.
    size_mm: f64,
}

impl Obstacles {
    /// Puts points into their trees.
    ///
    /// # Errors
    /// [`ObstaclesError`] where a coordinate is not finite, and for more than 2^30 points.
    pub fn new(points: impl IntoIterator<Item = ObstaclePoint>) -> Result<Self, ObstaclesError> {
        const MOST: usize = 1 << 30;
        let mut points: Vec<ObstaclePoint> = points.into_iter().collect();
        if let Some(index) = points.iter().position(|p| !p.point.iter().all(|x| x.is_finite())) {
            return Err(ObstaclesError::Point { index });
        }
        if points.len() > MOST {
            return Err(ObstaclesError::Count { count: points.len(), most: MOST });
        }
        points.sort_by_key(|p| p.kind);
        let size_mm = points.iter().map(|p| p.point.coords.amax()).fold(0.0, f64::max);
        let mut all = Self {
            balls: Vec::with_capacity(2 * points.len()),
            slabs: Vec::new(),
            points,
            ends: [0; KINDS.len()],
            size_mm,
        };
        let mut from = 0;
        for (k, kind) in KINDS.iter().enumerate() {
            let to = all.points.partition_point(|p| p.kind <= *kind);
            all.add(from, to);
            all.ends[k] = all.balls.len();
            from = to;
        }
        Ok(all)
    }

    /// How many points there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The points, in the order of the tree.
    #[must_use]
    pub fn points(&self) -> &[ObstaclePoint] {
        &self.points
    }

    /// Whether a point is nearer to a body at a pose than so much, whatever its kind.
    ///
    /// ```
    /// use osculate_geom::{Point3, Vec3};
    /// use osculate_tools::reach::{ObstacleKind, ObstaclePoint, Obstacles};
    /// use osculate_tools::{Cutter, CutterSpec, Pose};
    /// // A screw head 8 mm beside the axis of a tool of radius 3: 5 mm are left.
    /// let screw = ObstaclePoint { point: Point3::new(8.0, 0.0, 10.0), owner: 0, kind: ObstacleKind::Surroundings };
    /// let obstacles = Obstacles::new([screw])?;
    /// let tool = Cutter::try_from(CutterSpec::Flat { diameter_mm: 6.0, length_mm: 40.0 })?;
    /// let pose = Pose { tip: Point3::origin(), axis: Vec3::z_axis() };
    /// assert!(obstacles.is_within(&tool, &pose, 5.01) && !obstacles.is_within(&tool, &pose, 4.99));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn is_within(&self, body: &Cutter, pose: &Pose, limit_mm: f64) -> bool {
        self.roots().any(|root| self.any_within(root, (body, pose), limit_mm, None))
    }

    /// The same of the points that are further than `beyond_mm` from `from`.
    #[must_use]
    pub fn is_within_beyond(
        &self,
        posed: (&Cutter, &Pose),
        limit_mm: f64,
        (from, beyond_mm): (&Point3, f64),
    ) -> bool {
        self.roots().any(|root| self.any_within(root, posed, limit_mm, Some((from, beyond_mm))))
    }

    /// Whether a point is no further from a place than so much, whatever its kind.
    #[must_use]
    pub fn is_near(&self, place: &Point3, within_mm: f64) -> bool {
        self.roots().any(|root| self.any_near(root, place, within_mm))
    }

    fn any_near(&self, at: u32, place: &Point3, within_mm: f64) -> bool {
        let ball = &self.balls[at as usize];
        (ball.centre - place).norm() - ball.radius_mm <= within_mm
            && (ball.second == 0
                || self.any_near(at + 1, place, within_mm)
                || self.any_near(ball.second, place, within_mm))
    }

    fn any_within(
        &self,
        at: u32,
        (body, pose): (&Cutter, &Pose),
        limit_mm: f64,
        beyond: Option<(&Point3, f64)>,
    ) -> bool {
        let ball = &self.balls[at as usize];
        if body.distance(pose, &ball.centre) - ball.radius_mm >= limit_mm
            || beyond.is_some_and(|(from, mm)| (ball.centre - from).norm() + ball.radius_mm <= mm)
        {
            return false;
        }
        ball.second == 0
            || self.any_within(at + 1, (body, pose), limit_mm, beyond)
            || self.any_within(ball.second, (body, pose), limit_mm, beyond)
    }

    pub(super) const fn size_mm(&self) -> f64 {
        self.size_mm
    }

    pub(super) fn balls(&self) -> &[Ball] {
        &self.balls
    }

    /// The first balls of the trees.
    pub(super) fn roots(&self) -> impl Iterator<Item = u32> + '_ {
        let starts = std::iter::once(0).chain(self.ends);
        starts.zip(self.ends).filter(|(start, end)| start < end).map(|(start, _)| start as u32)
    }

    /// The slab of a ball, where it has one.
    pub(super) fn slab(&self, ball: &Ball) -> Option<&Slab> {
        self.slabs.get(ball.slab as usize)
    }

    /// The kind of all points in a ball.
    pub(super) const fn kind(&self, ball: u32) -> ObstacleKind {
        let [part, surroundings, _] = self.ends;
        let ball = ball as usize;
        if ball < part {
            ObstacleKind::Part
        } else if ball < surroundings {
            ObstacleKind::Surroundings
        } else {
            ObstacleKind::Stock
        }
    }

    fn add(&mut self, from: usize, to: usize) {
        if from >= to {
            return;
        }
        let own = &mut self.points[from..to];
        let (min, max) =
            own.iter().fold((own[0].point, own[0].point), |(lo, hi), p| (lo.inf(&p.point), hi.sup(&p.point)));
        let centre = min + (max - min) * 0.5;
        let single = own.len() == 1;
        let radius_mm = if single {
            0.0
        } else {
            own.iter().map(|p| (p.point - centre).norm()).fold(0.0, f64::max) + ROUNDING * self.size_mm
        };
        let flat = own.len() >= SLABS[0] && own.len() <= SLABS[1];
        let slab = flat.then(|| Slab::about(own, &centre)).flatten().map_or(NONE, |slab| {
            self.slabs.push(slab);
            self.slabs.len() as u32 - 1
        });
        let index = self.balls.len();
        self.balls.push(Ball { centre, radius_mm, second: 0, first: from as u32, slab });
        if single {
            return;
        }
        let extent: Vec3 = max - min;
        let widest = extent.imax();
        let half = own.len() / 2;
        own.select_nth_unstable_by(half, |a, b| a.point[widest].total_cmp(&b.point[widest]));
        self.add(from, from + half);
        self.balls[index].second = self.balls.len() as u32;
        self.add(from + half, to);
    }
}
