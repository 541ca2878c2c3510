//! A part as it is seen along a direction: how low a tool comes over every node of a lattice, and what it reaches.
//!
//! Points of the faces are seen at the nodes next to them, so that heights are good to a cell's way down the slope. That is enough to compare
//! directions and to say what a direction is for; where a tool goes is asked of the faces themselves.

use super::super::frame::Frame;
use super::columns::{Underside, within};
use super::grid::{Disc, Grid};
use osculate_geom::{Box3, Point3};

/// Points of a part.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    pub at: Vec<Point3>,
    /// Whether each is on a face to machine.
    pub own: Vec<bool>,
    /// Distance of points, mm.
    pub spacing_mm: f64,
}

/// A tool that keeps an allowance.
#[derive(Clone, Debug)]
pub(super) struct Rougher {
    /// The cutter.
    pub bare: Underside,
    /// The cutter everywhere larger by the allowance.
    pub grown: Underside,
    pub allowance_mm: f64,
    /// Radius of each section of the holder with what it keeps off, and how far above the tip it begins.
    pub holder: Vec<[f64; 2]>,
}

/// A part seen along a direction.
#[derive(Clone, Debug)]
pub(super) struct Relief {
    pub frame: Frame,
    pub grid: Grid,
    /// How low the tip comes at each node; minus infinity where nothing is below, infinity where it is not to go.
    pub tip: Vec<f64>,
    /// The same for the holder alone.
    pub holder: Vec<f64>,
    /// The least height at each node that some position of the tool reaches.
    pub reached: Vec<f64>,
    /// Whether material over a node is to go: what is seen there is a face to machine, or the side of one stands beside it.
    pub wanted: Vec<bool>,
}

/// How low the tool goes beside the part: as far as faces to machine are near, and where what is farther off would be left as a strip
/// narrower than the tool; infinite elsewhere.
fn beside(
    grid: &Grid,
    (top, low): (&[f64], &[f64]),
    tool: &Rougher,
    may_hold: impl Fn(usize) -> bool,
) -> Vec<f64> {
    let (near, wide) = (tool.grown.radius_mm + tool.bare.radius_mm, 2.0 * tool.bare.radius_mm);
    let mut out = grid.lowest(low, &Disc::new(near, grid.cell));
    let strip = Disc::new(wide, grid.cell);
    let is = |is: bool| if is { 1.0 } else { 0.0 };
    let done: Vec<f64> = out.iter().map(|z| is(z.is_finite())).collect();
    let done_near = grid.highest(&done, &strip);
    let far = |k: usize| top[k] == f64::NEG_INFINITY && out[k] == f64::INFINITY && may_hold(k);
    let core: Vec<f64> = (0..grid.len()).map(|k| is(far(k) && done_near[k] == 0.0)).collect();
    let core_near = grid.highest(&core, &strip);
    let narrow: Vec<usize> = (0..grid.len()).filter(|k| far(*k) && core_near[*k] == 0.0).collect();
    let farther = grid.lowest(low, &Disc::new(near + wide, grid.cell));
    for k in narrow {
        out[k] = farther[k];
    }
    out
}

impl Relief {
    /// A part seen in a frame, on nodes no further apart than `cell`.
    pub fn of(
        points: &Points,
        (frame, bounds): (Frame, &Box3),
        tool: &Rougher,
        (extent, cell): ([[f64; 2]; 2], f64),
    ) -> Self {
        // A node between two points must not be missed.
        let cell = cell.max(1.2 * points.spacing_mm);
        let grid = Grid::over(extent, cell);
        let mut top = vec![f64::NEG_INFINITY; grid.len()];
        let mut own = vec![false; grid.len()];
        let mut low = vec![f64::INFINITY; grid.len()];
        for (p, is_own) in points.at.iter().zip(&points.own) {
            let [x, y, z] = frame.of(p);
            let Some(k) = grid.near([x, y]) else { continue };
            if z > top[k] {
                (top[k], own[k]) = (z, *is_own);
            }
            if *is_own {
                low[k] = low[k].min(z);
            }
        }
        let grown = &tool.grown;
        let rests = grid.raised(&top, grown.radius_mm, |rho| grown.lift_mm(rho));
        let sides = beside(&grid, (&top, &low), tool, |k| within(bounds, &frame, grid.at(k)).is_some());
        let tip: Vec<f64> = rests
            .iter()
            .zip(&sides)
            .map(|(rest, side)| if *rest > f64::NEG_INFINITY { rest + tool.allowance_mm } else { *side })
            .collect();
        let mut holder = vec![f64::NEG_INFINITY; grid.len()];
        for [radius, above] in &tool.holder {
            let under = grid.highest(&top, &Disc::new(*radius, cell));
            holder.iter_mut().zip(under).for_each(|(low, h)| *low = low.max(h - above));
        }
        let stands: Vec<f64> = tip.iter().zip(&holder).map(|(t, h)| -t.max(*h)).collect();
        let bare = &tool.bare;
        let reached = if bare.is_flat() {
            grid.highest(&stands, &Disc::new(bare.radius_mm, cell))
        } else {
            grid.raised(&stands, bare.radius_mm, |rho| bare.lift_mm(rho))
        };
        let reached = reached.into_iter().map(|h| -h).collect();
        let wanted = (0..grid.len())
            .map(|k| if top[k] > f64::NEG_INFINITY { own[k] } else { sides[k] < f64::INFINITY })
            .collect();
        Self { frame, grid, tip, holder, reached, wanted }
    }

    /// Whether material at a point is to go and is reached.
    pub fn takes(&self, p: &Point3) -> bool {
        let [x, y, z] = self.frame.of(p);
        self.grid.near([x, y]).is_some_and(|k| self.wanted[k] && z >= self.reached[k])
    }
}
