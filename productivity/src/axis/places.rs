//! What is possible at single places of a face, for those who look at it.

use super::find::{NoField, Possibilities, Unreached, Wish, lifted, reach, rim, seen, travelled, travels};
use super::lattice::steady_normal;
use super::rim::Rim;
use osculate_geom::{Surface, Unit3, Uv};
use osculate_tools::reach::{Barred, Directions, Place};
use rayon::prelude::*;

/// The directions of the tool's axis at a place of a face.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PlaceAxes {
    /// The parameters of the place.
    pub at: Uv,
    /// Where the tool stands: on the face, or off it by [`lift_mm`](Self::lift_mm). The normal of a rough place is the mean of those
    /// around it.
    pub place: Place,
    /// How far the tool stands off the face along its normal, mm: zero unless nothing takes it down to the face.
    pub lift_mm: f64,
    /// For each of [`Possibilities::directions`] what keeps the tool from it; None where it is possible.
    pub barred: Vec<Option<Barred>>,
    /// Next to the normal, where directions of the set are too far apart to tell: the axis of least lean in each of the ways
    /// around the normal, anticlockwise seen from outside; None where no lean up to 15 degrees is possible. Empty for balls and for
    /// machines of three or four axes.
    pub least: Vec<Option<Unit3>>,
}

impl Possibilities {
    /// The directions that are asked: a sphere of them, or a row on a machine of three or four axes.
    #[must_use]
    pub const fn directions(&self) -> &Directions {
        &self.directions
    }

    /// Nodes of the face that no axis reaches.
    #[must_use]
    pub fn unreached(&self) -> &[Unreached] {
        &self.unreached
    }

    /// Area of the nodes of the face, mm2.
    #[must_use]
    pub const fn area_mm2(&self) -> f64 {
        self.area_mm2
    }

    /// Corners of cells over the parameters of the face, no more than about `most`, closer where it turns faster, as the field has them: how
    /// many there are along u and along v, and their parameters, v growing first.
    #[must_use]
    pub fn corners(&self, most: usize) -> ([usize; 2], Vec<Uv>) {
        let spans = self.lattice.spline.bases.map(|b| b.spans);
        // A whole number of parts, one at least.
        let parts = (most as f64 / (spans[0] * spans[1]) as f64).sqrt().max(1.0) as usize;
        self.lattice.between(parts)
    }

    /// Whether some axis is possible at the node next to a place of the face.
    #[must_use]
    pub fn reaches(&self, at: Uv) -> bool {
        self.possible[self.lattice.nearest(at)].is_any()
    }

    /// The place with the fewest possible directions among the nodes of the face: of those that no axis reaches the one with the
    /// least spare. None where the face has no nodes.
    #[must_use]
    pub fn fewest(&self) -> Option<Uv> {
        let spare = |u: &Unreached| u.best.map_or(f64::NEG_INFINITY, |b| b.gap.spare_mm);
        let unreached = self.unreached.iter().min_by(|a, b| spare(a).total_cmp(&spare(b)));
        let on_face = self.lattice.nodes.iter().zip(&self.possible);
        let on_face = on_face.filter(|(n, _)| n.area_mm2 > 0.0 && n.normal.is_some());
        let fewest = || on_face.min_by_key(|(_, possible)| possible.count());
        unreached.map(|u| u.at).or_else(|| Some(fewest()?.0.at))
    }

    /// The outward normal at a place as the nodes of the field have it: of a rough place the mean of those around it. None where there
    /// is none.
    #[must_use]
    pub fn normal(&self, wish: &Wish<'_>, at: Uv) -> Option<Unit3> {
        let (face, [_, look_mm]) = seen(wish);
        Some(steady_normal(&face, at, &face.jet2(at), look_mm)?.0)
    }

    /// The directions at a place, `wish` being that of [`Possibilities::of`]; None where the face has no normal there.
    ///
    /// # Errors
    /// As [`Possibilities::of`].
    pub fn at(&self, wish: &Wish<'_>, at: Uv) -> Result<Option<PlaceAxes>, NoField> {
        let Some(normal) = self.normal(wish, at) else { return Ok(None) };
        let jet = wish.surface.jet2(at);
        let reach = reach(wish, &self.directions, &self.mask)?;
        let all = self.directions.all();
        let on_face = Place { point: jet.point, normal };
        let bits = travelled(wish, self.on_line, all, (&on_face, reach.bits(&on_face)));
        let found = if bits.is_empty() { lifted(wish, self.on_line, &reach, &on_face) } else { None };
        let (place, bits) = found.unwrap_or((on_face, bits));
        let barred =
            |k: usize| (!bits.contains(k)).then(|| reach.barred(&place, k).unwrap_or(Barred::Machine));
        let near = !self.on_line && !wish.tool.cutter().is_ball();
        let least = near.then(|| {
            let rim = rim(wish, &reach, &jet, &place);
            let axis = |way: usize| {
                let lean_rad = rim.least_rad(way);
                let axis = lean_rad.is_finite().then(|| rim.axis(way, lean_rad));
                axis.filter(|axis| wish.joints.reaches(axis))
            };
            (0..Rim::ways()).map(axis).collect()
        });
        Ok(Some(PlaceAxes {
            at,
            place,
            lift_mm: (place.point - on_face.point).norm(),
            barred: (0..all.len()).into_par_iter().map(barred).collect(),
            least: least.unwrap_or_default(),
        }))
    }

    /// Whether the tool may stand at a place with any axis, `wish` being that of [`Possibilities::of`].
    ///
    /// # Errors
    /// As [`Possibilities::of`].
    pub fn is_clear(&self, wish: &Wish<'_>, place: &Place, axis: &Unit3) -> Result<bool, NoField> {
        let reach = reach(wish, &self.directions, &self.mask)?;
        Ok(wish.joints.reaches(axis)
            && reach.is_clear(place, axis)
            && travels(wish, self.on_line, place, axis))
    }
}
