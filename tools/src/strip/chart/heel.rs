//! How deep the cutter's far side goes below a strip on a chart, at the times when it comes over it.
//!
//! The rays of a chart end before a leaning disc's far rim comes over the contact. Frames further along the feed are taken
//! from the surface itself, a quarter of the cutter's radius apart, and kept for all leads and tilts of one direction;
//! between them the place is interpolated by Hermite's cubics, normal and tangent by chords.

use super::ray::Extended;
use super::{Chart, KEPT_TRAILS};
use crate::contact::Lean;
use crate::cutter::{Cutter, Line};
use crate::strip::passages::{APART, extent};
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::{Darboux, Surface, Unit3, Vec3};
use std::rc::Rc;

/// The lead's sine against the radius in the greatest hollow's below which the far side is looked at.
const SUSPECT: f64 = 2.0;
/// Most frames along a direction.
const MOST: usize = 24;
/// Sections of the two steps around the lowest entry, by thirds: to a thousandth of a step.
const SECTIONS: usize = 19;

impl Chart<'_> {
    /// Depth below a place of the strip of the cutter's far side; zero where it stays above, and where the part is nowhere hollow
    /// enough on the chart for it to matter.
    pub(super) fn dip_mm(&self, cutter: &Cutter, angle_rad: f64, lean: Lean, line: &Line) -> f64 {
        let radius = cutter.radius_mm();
        if cutter.is_ball() || SUSPECT * radius * self.hollow < lean.lead_rad.sin().abs() {
            return 0.0;
        }
        let frame = self.frame(angle_rad);
        let [behind, ahead] = extent(cutter, lean, &frame, 0.0);
        let (s, c) = angle_rad.sin_cos();
        let apart = APART * radius;
        // Parts of the body behind the contact come over it later.
        let later = self.lowest(cutter, lean, line, &self.trail([c, s], apart, -behind));
        let back = self.trail([-c, -s], apart, ahead);
        let turned = Lean { tilt_rad: lean.tilt_rad + std::f64::consts::PI, ..lean };
        let earlier = self.lowest(cutter, turned, line, &back);
        (-later.min(earlier)).max(0.0)
    }

    /// Frames from the centre on to `reach_mm`, in a direction.
    fn trail(&self, direction: [f64; 2], apart: f64, reach_mm: f64) -> Rc<Vec<Darboux>> {
        let count = ((reach_mm / apart).ceil() as usize).min(MOST);
        let mut kept = self.trails.borrow_mut();
        let found = kept.iter().position(|k| k.0 == direction && k.1 == apart && k.2 >= count);
        if let Some(k) = found {
            kept[..=k].rotate_right(1);
        } else {
            kept.truncate(KEPT_TRAILS - 1);
            kept.insert(0, (direction, apart, count, Rc::new(self.frames_on(direction, apart, count))));
        }
        Rc::clone(&kept[0].3)
    }

    fn frames_on(&self, direction: [f64; 2], apart: f64, count: usize) -> Vec<Darboux> {
        let place = &self.place;
        let extended = Extended::new(place.part.surface);
        let mut frames = Vec::with_capacity(count + 1);
        let mut state = GeodesicState::start(place.part.surface, place.jet.uv, &place.direction(direction));
        for _ in 0..=count {
            let Ok(here) = state else { break };
            let jet = extended.jet2(here.at);
            let Ok(frame) = Darboux::new(&jet, &jet.tangent(here.rate), 0.0) else { break };
            // The feed ends with the surface; beyond a right angle the tool is on the part's other side.
            if !place.domain.contains(here.at) || frame.normal.dot(&self.forms.normal) <= 0.0 {
                break;
            }
            frames.push(frame);
            state = here.step(&extended, apart);
        }
        frames
    }

    /// The lowest entry of the line after it has come down from a higher one; infinite without.
    fn lowest(&self, cutter: &Cutter, lean: Lean, line: &Line, frames: &[Darboux]) -> f64 {
        let entry =
            |f: &Darboux| cutter.entry(&lean.pose(cutter, f, 0.0), line).map_or(f64::INFINITY, |e| e.at_mm);
        let heights: Vec<f64> = frames.iter().map(entry).collect();
        let mut lowest = f64::INFINITY;
        for k in 1..heights.len() {
            let after = heights.get(k + 1).copied().unwrap_or(f64::INFINITY);
            // A far rim that comes over the line between two frames: lower than it may go on to is of no interest.
            let falls = heights[k - 1] - heights[k];
            if !(heights[k].is_finite() && falls >= 0.0 && heights[k] <= after && heights[k] < 1.5 * falls) {
                continue;
            }
            let last = (k + 1).min(frames.len() - 1);
            let mut at = |x: f64| {
                let height = entry(&between(frames, x));
                lowest = lowest.min(height);
                height
            };
            let (mut a, mut b) = ((k - 1) as f64, last as f64);
            for _ in 0..SECTIONS {
                let third = (b - a) / 3.0;
                if at(a + third) < at(b - third) { b -= third } else { a += third }
            }
            lowest = lowest.min(heights[k]);
        }
        lowest
    }
}

/// The frame at a place between two of a row.
fn between(frames: &[Darboux], x: f64) -> Darboux {
    let k = (x.floor() as usize).min(frames.len() - 2);
    let (a, b, t) = (&frames[k], &frames[k + 1], x - k as f64);
    let chord = b.point - a.point;
    let step = chord.norm();
    let (u, tt) = (1.0 - t, t * t);
    let (ta, tb) = (a.tangent.into_inner(), b.tangent.into_inner());
    let point = a.point + chord * (tt * (3.0 - 2.0 * t)) + (ta * (t * u * u) - tb * (tt * u)) * step;
    let normal = Unit3::new_normalize(a.normal.into_inner() * u + b.normal.into_inner() * t);
    let flat: Vec3 = ta * u + tb * t;
    let tangent = Unit3::new_normalize(flat - normal.into_inner() * normal.dot(&flat));
    let left = Unit3::new_unchecked(normal.cross(&tangent));
    Darboux { point, tangent, left, normal, turn: Vec3::zeros() }
}
