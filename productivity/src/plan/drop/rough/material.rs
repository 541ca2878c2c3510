//! Material as it is planned for: where stock is in any of the places that are done alike.

use super::task::Places;
use nalgebra::Isometry3;
use osculate_geom::{Box3, Point3, Unit3};
use osculate_tools::removal::stock::Stock;
use std::f64::consts::TAU;

/// An axis that leans off that of the turns by less than this, as a sine, is the same in every place.
const ALONG: f64 = 1e-9;

/// Stock, seen from the place that is planned.
#[derive(Clone, Debug)]
pub(super) struct Material<'a> {
    stock: &'a Stock,
    /// What takes the planned place to each of the others.
    others: Vec<Isometry3<f64>>,
    bounds: Box3,
}

impl Places {
    /// What takes the first place to each, itself first.
    pub(super) fn turns(&self) -> Vec<Isometry3<f64>> {
        (0..self.count).map(|k| self.axis.turn(TAU * k as f64 / self.count as f64)).collect()
    }

    /// The places of a tool axis: one where it points along the axis of the turns, as that is the same in all.
    pub(super) fn of_axis(self, axis: &Unit3) -> Option<Self> {
        (self.axis.direction.cross(axis).norm() > ALONG).then_some(self)
    }

    /// The angle of a point about the axis, from a direction across it, rad.
    pub(super) fn angle_rad(&self, p: &Point3) -> f64 {
        let w = p - self.axis.origin;
        let z = self.axis.direction;
        let x = osculate_geom::any_perpendicular(&z);
        w.dot(&z.cross(&x)).atan2(w.dot(&x))
    }
}

impl<'a> Material<'a> {
    pub fn of(stock: &'a Stock, places: Option<&Places>) -> Self {
        let others: Vec<_> = places.map_or_else(Vec::new, |p| p.turns().split_off(1));
        let own = stock.bounds();
        let ends = [own.min, own.max];
        let corner = |k: usize| Point3::new(ends[k & 1].x, ends[k >> 1 & 1].y, ends[k >> 2].z);
        let turned = others.iter().flat_map(|turn| (0..8).map(move |k| turn.inverse() * corner(k)));
        let all: Vec<Point3> = turned.chain(ends).collect();
        Self { stock, others, bounds: Box3::around(&all) }
    }

    /// Whether there is material in any of the places.
    pub fn is(&self, p: &Point3) -> bool {
        self.stock.is_material(p) || self.others.iter().any(|turn| self.stock.is_material(&(turn * p)))
    }

    /// A box that contains all of it.
    pub const fn bounds(&self) -> &Box3 {
        &self.bounds
    }

    /// How well its boundary is known, mm.
    pub const fn cell_mm(&self) -> f64 {
        self.stock.cell_mm()
    }
}
