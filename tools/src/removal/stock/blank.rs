//! The raw material: a box, a closed mesh, or a layer of even thickness around a mesh.
//!
//! *Mesh.* A ray crosses triangles upwards and downwards; material is where the winding number is not zero, so that
//! bodies may overlap. A ray whose crossings do not close says that the mesh has a hole: an error, as volumes would be
//! arbitrary.
//!
//! *Layer.* The set of points within r of a triangle is convex: a prism, three cylinders and three balls, and a ray covers
//! in it the hull of what it covers in these. The layer is the union over all triangles; a closed mesh is filled besides.

use super::lattice::{Across, Lattice, TILE, Tile};
use super::{Field, Stock};
use osculate_geom::{Box3, Point3, Vec3};
use rayon::prelude::*;

/// What the material is before the first motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Blank<'a> {
    /// A box.
    Box(Box3),
    /// The inside of closed surfaces, each seen counter-clockwise from outside.
    Mesh(&'a [[Point3; 3]]),
    /// All points within a distance of the triangles.
    Layer {
        /// The triangles.
        triangles: &'a [[Point3; 3]],
        /// The distance, mm.
        thickness_mm: f64,
        /// Whether the triangles close and what they enclose is material as well.
        filled: bool,
    },
    /// What was left of another stock, as finely as that was looked at.
    Left(&'a Stock),
}

/// Raw material that is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlankError {
    /// A box without volume, or no triangles.
    #[error("the raw material has no volume: its box is {} x {} x {} mm", .0[0], .0[1], .0[2])]
    Empty([f64; 3]),
    /// A size that is not positive and finite.
    #[error("{what} must be positive and finite, got {got}")]
    Size {
        /// Which.
        what: &'static str,
        /// Its value.
        got: f64,
    },
    /// A mesh with holes.
    #[error(
        "the raw material's mesh is not closed: {open} of {rays} rays through it do not come out again, first near \
         ({}, {}, {}) mm; close it, or use a layer",
        .at.x, .at.y, .at.z
    )]
    Open {
        /// Rays whose crossings do not close.
        open: usize,
        /// Rays in all.
        rays: usize,
        /// On the first of them.
        at: Point3,
    },
}

/// Stock as it was made.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Made {
    /// The stock.
    pub stock: Stock,
    /// The cell that was asked for, where the budget required a larger one.
    pub coarsened: Option<f64>,
}

/// Bytes that a ray takes while it is cut: its place in a tile and, on average, three stretches, twice (before and
/// after).
const RAY_BYTES: f64 = 2.0 * (4.0 + 3.0 * 16.0);

/// How finely stock is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Largest side of a cell, mm.
    pub cell_mm: f64,
    /// Rays along x, y and z; without it along z alone, several stretches to a ray.
    pub tri: bool,
    /// Memory for the stretches: where the cells would need more they are made larger.
    pub budget_bytes: usize,
}

impl Stock {
    /// Stock filled with raw material.
    ///
    /// ```
    /// use osculate_geom::{Box3, Point3};
    /// use osculate_tools::removal::stock::{Blank, Resolution, Stock};
    /// let block = Blank::Box(Box3::around(&[Point3::origin(), Point3::new(30.0, 20.0, 10.0)]));
    /// let stock = Stock::fill(&block, &Resolution { cell_mm: 1.0, tri: true, budget_bytes: 1 << 24 })?.stock;
    /// assert!((stock.volume().mm3 - 6000.0).abs() < 1e-6);
    /// assert!(stock.is_material(&Point3::new(15.0, 10.0, 5.0)) && !stock.is_material(&Point3::new(15.0, 10.0, 15.0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BlankError`].
    pub fn fill(blank: &Blank<'_>, resolution: &Resolution) -> Result<Made, BlankError> {
        if let Blank::Left(stock) = blank {
            return Ok(Made { stock: (*stock).clone(), coarsened: None });
        }
        let Resolution { cell_mm, tri, budget_bytes } = *resolution;
        if !(cell_mm.is_finite() && cell_mm > 0.0) {
            return Err(BlankError::Size { what: "the stock's cell, mm,", got: cell_mm });
        }
        let bounds = blank.bounds()?;
        let size = bounds.max - bounds.min;
        if !(size.min() > 0.0 && size.max().is_finite()) {
            return Err(BlankError::Empty(size.into()));
        }
        let axes: &[usize] = if tri { &[0, 1, 2] } else { &[2] };
        let section: f64 = axes.iter().map(|a| size[(a + 1) % 3] * size[(a + 2) % 3]).sum();
        // Even a budget of nothing leaves a few rays.
        let least = (section * RAY_BYTES / budget_bytes.max(1 << 16) as f64).sqrt();
        let cell = cell_mm.max(least).min(size.max());
        let mut fields = Vec::with_capacity(axes.len());
        for axis in axes {
            let lattice = Lattice::over(&bounds, cell, *axis);
            let tiles = blank.fill(&lattice, &bounds)?;
            fields.push(Field { lattice, tiles });
        }
        let coarsened = (cell > 1.000_001 * cell_mm).then_some(cell_mm);
        Ok(Made { stock: Self { bounds, cell, fields }, coarsened })
    }
}

impl Blank<'_> {
    fn bounds(&self) -> Result<Box3, BlankError> {
        Ok(match self {
            Self::Box(b) => *b,
            Self::Mesh(t) => Box3::around(t.iter().flatten()),
            Self::Left(stock) => *stock.bounds(),
            Self::Layer { triangles, thickness_mm, .. } => {
                if !(thickness_mm.is_finite() && *thickness_mm > 0.0) {
                    return Err(BlankError::Size { what: "the layer's thickness, mm,", got: *thickness_mm });
                }
                Box3::around(triangles.iter().flatten()).grown(*thickness_mm)
            }
        })
    }

    fn fill(&self, lattice: &Lattice, bounds: &Box3) -> Result<Vec<Tile>, BlankError> {
        let (triangles, grown, filled, layer) = match self {
            Self::Box(_) | Self::Left(_) => (&[][..], 0.0, false, None),
            Self::Mesh(t) => (*t, 0.0, true, None),
            Self::Layer { triangles, thickness_mm, filled } => {
                (*triangles, *thickness_mm, *filled, Some(*thickness_mm))
            }
        };
        let [b, c] = lattice.others();
        let mut of_tile: Vec<Vec<u32>> = vec![Vec::new(); lattice.tiles()];
        for (k, t) in triangles.iter().enumerate() {
            let box3 = Box3::around(t).grown(grown);
            for tile in lattice.touching([box3.min[b], box3.min[c]], [box3.max[b], box3.max[c]]) {
                of_tile[tile].push(k as u32);
            }
        }
        let whole = [bounds.min[lattice.axis], bounds.max[lattice.axis]];
        let made: Vec<(Tile, usize, Option<Point3>)> = (0..lattice.tiles())
            .into_par_iter()
            .map(|tile| {
                let mut rays = vec![Vec::new(); TILE];
                let (mut open, mut first) = (0, None);
                lattice.each_ray(tile, |ray, at| {
                    let mine = of_tile[tile].iter().map(|k| &triangles[*k as usize]);
                    let spans = &mut rays[ray];
                    if matches!(self, Self::Box(_)) {
                        spans.push(whole);
                    }
                    if filled && !inside(lattice, at, mine.clone(), spans) {
                        open += 1;
                        first = first.or(Some(lattice.point(at, whole[0])));
                    }
                    if let Some(thickness) = layer {
                        spans.extend(mine.filter_map(|t| near_triangle(lattice, at, t, thickness)));
                        unite(spans);
                    }
                });
                (Tile::pack(&rays), open, first)
            })
            .collect();
        let open = made.iter().map(|m| m.1).sum();
        match made.iter().find_map(|m| m.2) {
            Some(at) => Err(BlankError::Open { open, rays: lattice.rays(), at }),
            None => Ok(made.into_iter().map(|m| m.0).collect()),
        }
    }
}

/// Makes stretches ascending and apart.
fn unite(spans: &mut Vec<[f64; 2]>) {
    spans.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut out: Vec<[f64; 2]> = Vec::with_capacity(spans.len());
    for s in spans.iter() {
        match out.last_mut() {
            Some(last) if s[0] <= last[1] => last[1] = last[1].max(s[1]),
            _ => out.push(*s),
        }
    }
    *spans = out;
}

/// Pushes the stretches of a ray inside closed triangles; false where they do not close.
fn inside<'t>(
    lattice: &Lattice,
    at: Across,
    triangles: impl Iterator<Item = &'t [Point3; 3]>,
    spans: &mut Vec<[f64; 2]>,
) -> bool {
    let mut crossings: Vec<(f64, i32)> = triangles.filter_map(|t| crossing(lattice, at, t)).collect();
    crossings.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (mut winding, mut from) = (0, 0.0);
    for (s, step) in crossings {
        if winding == 0 {
            from = s;
        }
        winding += step;
        if winding == 0 && s > from {
            spans.push([from, s]);
        }
    }
    winding == 0
}

/// Where a ray crosses a triangle: +1 into the body, -1 out of it. An edge belongs to one of its two triangles alone.
fn crossing(lattice: &Lattice, at: Across, t: &[Point3; 3]) -> Option<(f64, i32)> {
    let [b, c] = lattice.others();
    let q = t.map(|p| [p[b] - at[0], p[c] - at[1]]);
    // Edge functions, computed from the lexicographically lesser end: the same number for both triangles at an edge.
    let edge = |i: usize, j: usize| {
        let (p, r) = (q[i], q[j]);
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let forward = p[0] < r[0] || (p[0] == r[0] && p[1] < r[1]);
        let value = if forward { cross(p, r) } else { -cross(r, p) };
        // On the edge itself: inside for one direction of the edge, outside for the other.
        if value == 0.0 { if forward { 1.0 } else { -1.0 } } else { value }
    };
    let w = [edge(1, 2), edge(2, 0), edge(0, 1)];
    let up = w.iter().all(|x| *x > 0.0);
    if !up && !w.iter().all(|x| *x < 0.0) {
        return None;
    }
    let sum: f64 = w.iter().sum();
    let s = (0..3).map(|k| w[k] * t[k][lattice.axis]).sum::<f64>() / sum;
    // Counter-clockwise seen from outside, and the ray looks along its axis: counter-clockwise from there is an exit.
    Some((s, if up { -1 } else { 1 }))
}

/// The stretch of a ray within r of a triangle.
fn near_triangle(lattice: &Lattice, at: Across, t: &[Point3; 3], r: f64) -> Option<[f64; 2]> {
    let origin = lattice.point(at, 0.0);
    let mut d = Vec3::zeros();
    d[lattice.axis] = 1.0;
    let mut span = [f64::INFINITY, f64::NEG_INFINITY];
    let mut see = |s: Option<[f64; 2]>| {
        if let Some([a, b]) = s {
            span = [span[0].min(a), span[1].max(b)];
        }
    };
    for k in 0..3 {
        see(near_point(&(origin - t[k]), &d, r));
        see(near_segment(&(origin - t[k]), &d, &(t[(k + 1) % 3] - t[k]), r));
    }
    see(prism(&origin, &d, t, r));
    (span[0] < span[1]).then_some(span)
}

fn near_point(w: &Vec3, d: &Vec3, r: f64) -> Option<[f64; 2]> {
    let b = w.dot(d);
    let disc = b * b - w.norm_squared() + r * r;
    (disc >= 0.0).then(|| [-b - disc.sqrt(), -b + disc.sqrt()])
}

/// The side of a cylinder around the segment from 0 to e.
fn near_segment(w: &Vec3, d: &Vec3, e: &Vec3, r: f64) -> Option<[f64; 2]> {
    let ee = e.norm_squared();
    if ee == 0.0 {
        return None;
    }
    let (de, we) = (d.dot(e), w.dot(e));
    let (dp, wp) = (d - e * (de / ee), w - e * (we / ee));
    let (a, b, c) = (dp.norm_squared(), wp.dot(&dp), wp.norm_squared() - r * r);
    let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
    // Along the cylinder the ray is in or out for good.
    if a > 1e-24 {
        let disc = b * b - a * c;
        if disc < 0.0 {
            return None;
        }
        (lo, hi) = ((-b - disc.sqrt()) / a, (-b + disc.sqrt()) / a);
    } else if c > 0.0 {
        return None;
    }
    // Between the ends: 0 <= we + s de <= ee.
    if de == 0.0 {
        if we < 0.0 || we > ee {
            return None;
        }
    } else {
        let (x, y) = (-we / de, (ee - we) / de);
        (lo, hi) = (lo.max(x.min(y)), hi.min(x.max(y)));
    }
    (lo <= hi && lo.is_finite() && hi.is_finite()).then_some([lo, hi])
}

/// The prism over a triangle, r to both sides.
fn prism(origin: &Point3, d: &Vec3, t: &[Point3; 3], r: f64) -> Option<[f64; 2]> {
    let n = (t[1] - t[0]).cross(&(t[2] - t[0])).try_normalize(0.0)?;
    let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut clip = |m: Vec3, p: &Point3, most: f64| {
        // m . (o + s d - p) <= most
        let (slope, value) = (m.dot(d), m.dot(&(origin - p)) - most);
        if slope > 0.0 {
            hi = hi.min(-value / slope);
        } else if slope < 0.0 {
            lo = lo.max(-value / slope);
        } else if value > 0.0 {
            lo = f64::INFINITY;
        }
    };
    clip(n, &t[0], r);
    clip(-n, &t[0], r);
    for k in 0..3 {
        clip((t[(k + 1) % 3] - t[k]).cross(&n), &t[k], 0.0);
    }
    (lo <= hi && lo.is_finite() && hi.is_finite()).then_some([lo, hi])
}
