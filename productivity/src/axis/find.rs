//! The search of a field of axes over a face: what is possible at its nodes, the axes of least time, and the way between them.

use super::around::Surroundings;
use super::field::AxisField;
use super::joints::Joints;
use super::lattice::{Feed, Lattice, Node, steady_normal};
use super::rim::Rim;
use super::search::{Asked, Possible, Search};
use super::settle::{Leaning, settle};
use crate::plan::extended::Extended;
use crate::plan::ripples::Ripples;
use crate::width::WIDEST;
use osculate_geom::{Jet2, Point3, Surface, Unit3, Uv, Vec3};
use osculate_tools::reach::{
    Best, Bits, Directions, Place, Reach, ReachError, ReachLimits, ReachProblem, Tool,
};
use osculate_tools::{Cutter, pose_with_axis};
use rayon::prelude::*;

/// Subdivisions of the icosahedron whose corners are tried: 2,562 directions, 4.3 degrees apart.
const LEVEL: u32 = 4;
/// Places that are asked between the nodes, and fewest and most of them along each side of a cell.
const ASKED: f64 = 4e4;
const ALONG: [f64; 2] = [4.0, 10.0];
/// Shares of the scallop by which a tool is lifted that no axis takes down to the face: dents narrower than the tool.
const LIFTS: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
/// On a rough face places that are not clear draw the harder by this part each time: tuned on the edges of a turbine's blade, where places
/// beside each other ask for different leans. On a smooth face they ask for nearly the same, and the least that is clear is best.
const STUBBORN: f64 = 0.1;

/// What a field is for.
#[derive(Clone, Copy)]
pub struct Wish<'a> {
    /// The face, with its trims and material side.
    pub surface: &'a dyn Surface,
    /// Highest material left between passes, mm.
    pub scallop_mm: f64,
    /// Feed, mm/min.
    pub feed_mm_min: f64,
    /// The machine's joints.
    pub joints: &'a dyn Joints,
    /// The tool.
    pub tool: &'a Tool,
    /// What it must keep out of; what it may go into is sunk by as much.
    pub around: &'a Surroundings,
    /// Least and greatest angle between axis and normal, rad.
    pub lean_rad: [f64; 2],
}

/// A place of the face with no possible axis.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Unreached {
    /// Its parameters.
    pub at: Uv,
    /// The place.
    pub point: Point3,
    /// Area of the face that it stands for, mm2.
    pub area_mm2: f64,
    /// The best axis of all, and what stands in its way; None where the machine has no axis there at all.
    pub best: Option<Best>,
}

/// A field as found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Found {
    /// The field.
    pub field: AxisField,
    /// Places that no axis reaches.
    pub unreached: Vec<Unreached>,
    /// Area of the nodes of the face, mm2.
    pub area_mm2: f64,
    /// Places at which the field as a whole keeps the tool from none of its possible axes, and all that were asked.
    pub unsettled: [usize; 2],
}

/// Why there is no field.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoField {
    /// Leans that are none.
    #[error(transparent)]
    Reach(#[from] ReachError),
    /// The joints reach no direction at all.
    #[error("the machine's joints reach no tool axis at all")]
    NoAxis,
    /// No place of the face is reached.
    #[error("no axis is possible at any of its {places} places")]
    Nowhere {
        /// Places that were looked at.
        places: usize,
    },
}

/// What is possible at the nodes of a face, whatever the direction of passes.
pub struct Possibilities {
    pub(super) lattice: Lattice,
    /// Whether the joints reach but a line of axes.
    pub(super) on_line: bool,
    pub(super) directions: Directions,
    /// The directions that the machine allows.
    pub(super) mask: Bits,
    pub(super) possible: Vec<Possible>,
    /// Places between the nodes that the field is asked at.
    between: Vec<Uv>,
    pub(super) unreached: Vec<Unreached>,
    pub(super) area_mm2: f64,
    /// Nodes at which a tool was to stand.
    places: usize,
}

/// Finds the field of axes of least time over a face for passes that run along a direction.
///
/// # Errors
/// Where the machine has no axis, or none is possible anywhere on the face.
pub fn find(wish: &Wish<'_>, feed: &Feed<'_>) -> Result<Found, NoField> {
    Possibilities::of(wish)?.field(wish, feed)
}

/// The face as passes see it that run out over its border, and how far to each side of a place its shape is looked at, mm.
pub(super) fn seen<'a>(wish: &Wish<'a>) -> (Extended<'a>, [f64; 2]) {
    let cutter: &Cutter = wish.tool.cutter();
    let widest_mm = WIDEST * cutter.radius_mm();
    // Half the strip of the tool's corner: what is narrower is the face's roughness, not its shape.
    let look_mm = (2.0 * cutter.corner_mm() * wish.scallop_mm).sqrt();
    (Extended::by(wish.surface, widest_mm), [widest_mm, look_mm])
}

/// The reach of a tool over some of the directions.
pub(super) fn reach<'a>(
    wish: &Wish<'a>,
    directions: &'a Directions,
    mask: &'a Bits,
) -> Result<Reach<'a>, NoField> {
    let limits = ReachLimits {
        gouge_mm: 0.0,
        clearance_mm: wish.around.keep_mm,
        stock_mm: wish.around.stock_mm,
        least_lean_rad: wish.lean_rad[0],
        most_lean_rad: wish.lean_rad[1],
    };
    let obstacles = &wish.around.obstacles;
    Ok(Reach::new(ReachProblem { tool: wish.tool, limits, obstacles, directions, allowed: Some(mask) })?)
}

/// Whether the machine's slides reach a place with an axis: where it has few axes its other joints may leave even fewer.
pub(super) fn travels(wish: &Wish<'_>, on_line: bool, place: &Place, axis: &Unit3) -> bool {
    let pose = || pose_with_axis(wish.tool.cutter(), &place.point, &place.normal, axis);
    !on_line || wish.joints.travels(&pose())
}

/// Of the directions in which a tool is clear at a place those with which the machine's slides reach it.
pub(super) fn travelled(
    wish: &Wish<'_>,
    on_line: bool,
    all: &[Unit3],
    (place, bits): (&Place, Bits),
) -> Bits {
    if !on_line {
        return bits;
    }
    Bits::of(all.len(), |k| bits.contains(k) && travels(wish, on_line, place, &all[k]))
}

/// Where the tool cannot come down to a place of the face it may still stand off by what may be left: the place so far out, with
/// the directions there.
pub(super) fn lifted(
    wish: &Wish<'_>,
    on_line: bool,
    reach: &Reach<'_>,
    place: &Place,
) -> Option<(Place, Bits)> {
    LIFTS.iter().find_map(|share| {
        let point = place.point + place.normal.into_inner() * (share * wish.scallop_mm);
        let place = Place { point, ..*place };
        let bits = travelled(wish, on_line, reach.directions().all(), (&place, reach.bits(&place)));
        (!bits.is_empty()).then_some((place, bits))
    })
}

/// The least leans at a place of the face.
pub(super) fn rim(wish: &Wish<'_>, reach: &Reach<'_>, jet: &Jet2, place: &Place) -> Rim {
    Rim::of(reach, place, [jet.du, jet.dv], wish.lean_rad[0])
}

impl Possibilities {
    /// Asks the nodes of a face.
    ///
    /// # Errors
    /// Where the machine has no axis.
    pub fn of(wish: &Wish<'_>) -> Result<Self, NoField> {
        let cutter: &Cutter = wish.tool.cutter();
        let (face, [widest_mm, look_mm]) = seen(wish);
        let lattice = Lattice::new(&face, cutter.radius_mm(), (widest_mm, look_mm));
        let line = wish.joints.line();
        let on_line = line.is_some();
        let directions = line.map_or_else(|| Directions::icosphere(LEVEL), Directions::row);
        let directions = directions.map_err(|_| NoField::NoAxis)?;
        let all = directions.all();
        let mask = Bits::of(all.len(), |k| wish.joints.reaches(&all[k]));
        if mask.is_empty() {
            return Err(NoField::NoAxis);
        }
        let reach = reach(wish, &directions, &mask)?;
        let mut places: Vec<Option<Place>> = lattice
            .nodes
            .iter()
            .map(|n| n.normal.filter(|_| n.stood).map(|normal| Place { point: n.point, normal }))
            .collect();
        let on_face: Vec<Place> = places.iter().flatten().copied().collect();
        let reached = reach.map(&on_face);
        let mut reached = on_face.iter().zip(reached).map(|reached| travelled(wish, on_line, all, reached));
        let mut bits: Vec<Option<Bits>> =
            places.iter().map(|p| p.as_ref().and_then(|_| reached.next())).collect();
        places.par_iter_mut().zip(&mut bits).for_each(|(place, bits)| {
            let (Some(place), Some(bits)) = (place, bits) else { return };
            if bits.is_empty()
                && let Some(found) = lifted(wish, on_line, &reach, place)
            {
                (*place, *bits) = found;
            }
        });
        // A ball's strip is the same at any lean.
        let rims = !on_line && !cutter.is_ball();
        let rim = |node: &Node, place: &Place| rim(wish, &reach, &face.jet2(node.at), place);
        let possible: Vec<Possible> = lattice
            .nodes
            .par_iter()
            .zip(places.par_iter().zip(&bits))
            .map(|(node, both)| match both {
                (Some(place), Some(bits)) => {
                    let rim = rims.then(|| rim(node, place));
                    // Where no axis is possible nothing is cut: there the field goes on as it comes.
                    let none = bits.is_empty() && rim.as_ref().is_none_or(Rim::is_empty);
                    if none { Possible::default() } else { Possible::new(&directions, bits, rim) }
                }
                _ => Possible::default(),
            })
            .collect();
        // Between the two, a whole number.
        let parts = (ASKED / lattice.nodes.len() as f64).sqrt().clamp(ALONG[0], ALONG[1]) as usize;
        let (_, mut between) = lattice.between(parts);
        between.retain(|at| lattice.stands(*at));
        let unreached = lattice
            .nodes
            .par_iter()
            .zip(places.par_iter().zip(&bits).zip(&possible))
            .filter_map(|(n, ((place, bits), all))| Some((n, place.as_ref()?, bits.as_ref()?, all)))
            .filter(|(n, _, bits, all)| bits.is_empty() && !all.has_rim() && n.area_mm2 > 0.0)
            .map(|(n, place, ..)| Unreached {
                at: n.at,
                point: n.point,
                area_mm2: n.area_mm2,
                best: reach.best(place),
            })
            .collect();
        let area_mm2 = lattice.nodes.iter().map(|n| n.area_mm2).sum();
        let places = on_face.len();
        Ok(Self { lattice, on_line, directions, mask, possible, between, unreached, area_mm2, places })
    }

    /// The field of least time for passes that run along a direction; `wish` is that of [`Possibilities::of`].
    ///
    /// # Errors
    /// Where no axis is possible anywhere on the face.
    pub fn field(&self, wish: &Wish<'_>, feed: &Feed<'_>) -> Result<Found, NoField> {
        let cutter: &Cutter = wish.tool.cutter();
        let (face, [_, look_mm]) = seen(wish);
        let reach = reach(wish, &self.directions, &self.mask)?;
        let is_clear = |place: &Place, axis: &Unit3| {
            reach.is_clear(place, axis) && travels(wish, self.on_line, place, axis)
        };
        let asked = Asked {
            cutter,
            scallop_mm: wish.scallop_mm,
            feed_mm_min: wish.feed_mm_min,
            directions: &self.directions,
            joints: wish.joints,
            clear: &is_clear,
            on_line: self.on_line,
        };
        let clear = |point: &Point3, normal: &Unit3, axis: &Unit3| {
            wish.joints.reaches(axis) && is_clear(&Place { point: *point, normal: *normal }, axis)
        };
        let held = |axis: Unit3| if self.on_line { wish.joints.nearest(&axis) } else { axis };
        let lattice = self.lattice.along(&face, feed);
        let axes = Search::new(&asked, &lattice, &self.possible).best();
        let axes = axes.ok_or(NoField::Nowhere { places: self.places })?;
        let rough = lattice.nodes.iter().any(|n| n.rough);
        let ripples = rough.then(|| Ripples::new(&face, cutter.radius_mm()));
        let normal = |at: Uv, jet: &Jet2| match &ripples {
            Some(ripples) => feed(at, jet)
                .and_then(|way| ripples.mean_normal(&face, jet, &way))
                .or_else(|| Some(steady_normal(&face, at, jet, look_mm)?.0)),
            None => jet.normal().ok(),
        };
        // Of a rough face the normals of the nodes are means: they make a face without ripples.
        let steady = rough.then(|| {
            let mut spline = lattice.spline.clone();
            let normal = |n: &Node| n.normal.map_or_else(Vec3::zeros, Unit3::into_inner);
            spline.poles = lattice.nodes.iter().map(normal).collect();
            AxisField { spline, rectangle: lattice.rectangle, paces: lattice.paces.clone() }
        });
        let upright = |at: Uv, jet: &Jet2| match &steady {
            Some(steady) => Some(steady.at(at).0).filter(|n| n.iter().all(|x| x.is_finite())),
            None => jet.normal().ok(),
        };
        let mut spline = lattice.spline;
        spline.poles = axes.iter().map(|a| a.into_inner()).collect();
        let mut field = AxisField { spline, rectangle: lattice.rectangle, paces: lattice.paces };
        let leaning = if cutter.is_ball() {
            Leaning::Any
        } else {
            // On a line there is but one way to give, and others need it too.
            Leaning::Least { harder: if rough && !self.on_line { STUBBORN } else { 0.0 } }
        };
        let unsettled = settle(
            &mut field,
            (&face, &normal, &upright),
            (&self.between, wish.scallop_mm),
            (&clear, &held, leaning),
        );
        let unreached = self.unreached.clone();
        Ok(Found { field, unreached, area_mm2: self.area_mm2, unsettled: [unsettled, self.between.len()] })
    }
}
