//! What links are asked for.

use super::rates::{Rates, Step};
use super::tree::{Dot, Dots};
use crate::plan::{CcPoint, Pass};
use osculate_geom::Box3;
use osculate_tools::{Cutter, Holder};

/// How passes are linked: [`Links::new`]. Lengths mm, feeds mm/min.
///
/// ```
/// use osculate_geom::{Box3, Point3, Vec3, uv};
/// use osculate_productivity::plan::{CcPoint, Links, Pass, Walls, link};
/// use osculate_tools::{Cutter, CutterSpec, Pose, cl::Motion};
///
/// let at = |x: f64, y: f64| {
///     let point = Point3::new(x, y, 0.0);
///     CcPoint { uv: uv(x, y), point, normal: Vec3::z_axis(), pose: Pose { tip: point, axis: Vec3::z_axis() }, width_mm: 1.0 }
/// };
/// let pass = |y: f64, from: f64, to: f64| Pass { points: vec![at(from, y), at(to, y)], closed: false };
/// let obstacles = Box3 { min: Point3::new(0.0, 0.0, -10.0), max: Point3::new(20.0, 1.0, 0.0) };
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 30.0 })?;
/// let links = Links::new(obstacles, ball, 1000.0);
/// // Two passes of 20 mm beside each other: what is cut is 40 mm, and the first move comes in rapid.
/// let linked = link(&[pass(0.0, 0.0, 20.0), pass(1.0, 20.0, 0.0)], &links, &Walls::default());
/// assert!((linked.cutting_length_mm - 40.0).abs() < 1e-9);
/// assert_eq!(linked.path.moves[0].motion, Motion::Rapid);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Links {
    /// Box of everything the tool must stay clear of on rapid moves.
    pub obstacles: Box3,
    /// Clearance above the sphere around the obstacles.
    pub clearance_mm: f64,
    /// Distance from the surface at which a rapid approach changes to feed.
    pub approach_mm: f64,
    /// The least lift of a hop; one that is not clear is doubled until it is, up to `approach_mm`.
    pub hop_mm: f64,
    /// How deep ways straight along the surface may go into the faces to machine.
    pub dip_mm: f64,
    /// Whether the tool touches the part where passes say it does: those along waterlines know the height of the tool, and of
    /// what it touches the slope nearby only.
    pub contacts: bool,
    /// Whether the tool keeps its axis and stands nowhere lower than all faces let it: then nothing is in its way straight up, whereas
    /// points of the faces may miss an edge that it would meet on a way aside.
    pub dropped: bool,
    /// Material that may stand on the faces yet: rapids do not go into it.
    pub layer_mm: f64,
    /// The cutter.
    pub cutter: Cutter,
    /// The holder, whose nose sits where the cutter's length ends.
    pub holder: Option<Holder>,
    /// Feed of the tip on the part.
    pub feed_mm_min: f64,
    /// Feed of a roughing's ways on which the tool takes nothing, though too near to what stands for a rapid.
    pub air_mm_min: f64,
    /// Feed on approaches.
    pub plunge_mm_min: f64,
    /// How fast the machine goes between passes.
    pub rates: Rates,
}

impl Links {
    /// A cutter without a holder among obstacles, and its feed on the part: rapids 10 mm clear of all of them, approaches from 2 mm
    /// at half the feed, hops of .25 mm, on passes that touch finished faces.
    #[must_use]
    pub fn new(obstacles: Box3, cutter: Cutter, feed_mm_min: f64) -> Self {
        Self {
            obstacles,
            clearance_mm: 10.0,
            approach_mm: 2.0,
            hop_mm: 0.25,
            dip_mm: 0.0,
            contacts: true,
            dropped: false,
            layer_mm: 0.0,
            cutter,
            holder: None,
            feed_mm_min,
            air_mm_min: feed_mm_min,
            plunge_mm_min: 0.5 * feed_mm_min,
            rates: Rates::default(),
        }
    }

    /// What the tool is of, each standing on the one before: the cutter, and the sections of its holder.
    pub(super) fn bodies(&self) -> impl Iterator<Item = &Cutter> {
        let sections = self.holder.as_ref().map(Holder::sections).unwrap_or_default();
        std::iter::once(&self.cutter).chain(sections.iter().map(|s| &s.body))
    }
}

impl Links {
    /// How far what touches of the tool goes at most while the tip makes a step.
    pub(super) fn grazed_mm(&self, step: Step) -> f64 {
        step.length_mm + self.cutter.radius_mm() * step.turn_rad
    }
}

/// What touches goes on ways along the surface at this part of the feed of plunges: teeth mark the crests that are crossed.
pub(super) const GRAZING: f64 = 0.5;
/// Ways straight along the surface are no longer than so many radii.
pub(super) const STRAIGHT: f64 = 2.0;
/// Distance of the points along passes that stand for the part, in radii of the cutter.
const NEAR_POINTS: f64 = 0.25;

/// The contacts of passes, as points of the part, where they are.
pub(super) fn contacts(passes: &[Pass], links: &Links) -> Dots {
    let spacing_mm = NEAR_POINTS * links.cutter.radius_mm();
    let passes = if links.contacts { passes } else { &[] };
    let mut out: Vec<Dot> = Vec::new();
    for pass in passes {
        let mut last: Option<&CcPoint> = None;
        for p in &pass.points {
            if let Some(last) = last {
                let step = p.point - last.point;
                let pieces = (step.norm() / spacing_mm).ceil().max(1.0);
                out.extend(
                    (1..pieces as usize)
                        .map(|k| Dot { at: last.point + step * (k as f64 / pieces), normal: p.normal }),
                );
            }
            out.push(Dot { at: p.point, normal: p.normal });
            last = Some(p);
        }
    }
    Dots::new(out)
}
