//! Samples of a face, nearly evenly spaced, with the area that each stands for.
//!
//! Rows of constant v follow each other at the wanted spacing along the v-lines where these are longest;
//! along each row samples follow at the wanted spacing. Each sample owns the cell of the parameter rectangle
//! around it; cells of a row meet half way between samples, rows half way between rows. Where the rectangle
//! has an edge, samples lie on it. Cells that a trim crosses are divided further: the part inside gives the
//! area, and where the cell's own sample is outside one is put on the trim. A strip of the face narrower than
//! half a spacing may be missed by this: [`sample_boundary`] puts samples on the trims themselves.
//!
//! A surface of several pieces (the triangles of a mesh) is sampled piece by piece; a piece that is smaller than the spacing has one
//! sample in its middle, and its whole rectangle for a cell.

use super::density::Density;
use super::grid::{Cell, Table, normal, weight};
use super::job::Sample;
use osculate_geom::{Axis, Box3, Domain, Interval, Surface, Unit3, Uv, quadrature, uv};
use rayon::prelude::*;

/// The samples of a face.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sampling {
    /// The samples, row by row.
    pub samples: Vec<Sample>,
    /// The cell of each sample.
    pub patches: Vec<Patch>,
    /// The spacing used, larger than asked for where `max_samples` required it, and the part's curvature.
    pub density: Density,
    /// Area of all cells, mm2: what the samples' areas add up to.
    pub area_mm2: f64,
    /// Area of cells without a tangent plane anywhere, mm2, which no sample stands for.
    pub lost_area_mm2: f64,
}

/// The part of a surface that a sample looks after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Range of u.
    pub u: [f64; 2],
    /// Range of v.
    pub v: [f64; 2],
    /// Greatest concave normal curvature at the sample, 1/mm, as a positive number.
    pub concave_per_mm: f64,
    /// Greatest convex normal curvature at the sample, 1/mm.
    pub convex_per_mm: f64,
}

/// Two normals differ by no more than this.
const MOST_BEND: f64 = 2.0;
/// Where curvature in one place says that normals turn by more than this over a patch, rad, that at its corners is looked at.
const MUCH: f64 = 0.5;
/// Normals turn by this many times what corners show at most: where they turn a lot they do so in a part of the patch, as at a ridge.
const SHOWN: f64 = 2.0;

impl Patch {
    /// How much normals turn over the patch at most, rad, from one in its middle that is no farther than `radius` from any place of it.
    pub(super) fn bend(&self, surface: &dyn Surface, middle: &Unit3, radius: f64) -> f64 {
        let bend = self.concave_per_mm.max(self.convex_per_mm) * radius;
        if bend <= MUCH {
            return bend;
        }
        let turn = |at: Uv| {
            surface.jet2(at).normal().map_or(MOST_BEND, |n| (n.into_inner() - middle.into_inner()).norm())
        };
        let shown = self.corners().into_iter().map(turn).fold(0.0, f64::max);
        bend.min((SHOWN * shown).clamp(MUCH, MOST_BEND))
    }

    /// How much of that makes it hollow over so far, rad.
    pub(super) const fn hollow(&self, bend: f64, radius: f64) -> f64 {
        (self.concave_per_mm * radius).min(bend.max(MUCH))
    }

    /// Its corners, one after the other.
    pub(super) const fn corners(&self) -> [Uv; 4] {
        let [[u0, u1], [v0, v1]] = [self.u, self.v];
        [uv(u0, v0), uv(u1, v0), uv(u1, v1), uv(u0, v1)]
    }

    pub(super) fn middle(&self) -> Uv {
        uv(0.5 * (self.u[0] + self.u[1]), 0.5 * (self.v[0] + self.v[1]))
    }

    /// Its quarters.
    pub(super) fn parts(&self) -> [Self; 4] {
        let (middle, [[u0, u1], [v0, v1]]) = (self.middle(), [self.u, self.v]);
        [
            ([u0, middle.u], [v0, middle.v]),
            ([middle.u, u1], [v0, middle.v]),
            ([u0, middle.u], [middle.v, v1]),
            ([middle.u, u1], [middle.v, v1]),
        ]
        .map(|(u, v)| Self { u, v, ..*self })
    }

    /// Its share of a patch that it is a part of.
    pub(super) fn share_of(&self, whole: &Self) -> f64 {
        let size = |p: &Self| (p.u[1] - p.u[0]) * (p.v[1] - p.v[0]);
        if size(whole) > 0.0 { (size(self) / size(whole)).min(1.0) } else { 0.0 }
    }

    /// Places of a raster over it, its corners among them.
    pub(super) fn raster(&self) -> impl Iterator<Item = Uv> + '_ {
        const RASTER: u32 = 4;
        let at =
            |range: [f64; 2], k: u32| range[0] + (range[1] - range[0]) * f64::from(k) / f64::from(RASTER);
        (0..(RASTER + 1) * (RASTER + 1))
            .map(move |k| uv(at(self.u, k % (RASTER + 1)), at(self.v, k / (RASTER + 1))))
    }
}

/// A sampling that cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SamplingError {
    /// A spacing that is not positive and finite.
    #[error("the sample spacing must be positive and finite, got {got} mm")]
    Spacing {
        /// The value, mm.
        got: f64,
    },
    /// Too few samples allowed.
    #[error("max_samples = {got} is too few for a face: allow at least 9")]
    Count {
        /// The value.
        got: usize,
    },
    /// No sample lies on the face.
    #[error("face {face}: no sample at a spacing of {spacing_mm} mm lies on the face; refine the spacing")]
    Nothing {
        /// The face.
        face: u32,
        /// The spacing used, mm.
        spacing_mm: f64,
    },
    /// A mesh of more triangles than samples are allowed.
    #[error(
        "face {face}: its mesh has {pieces} triangles and each needs a sample, but max_samples = {max}: allow more, or coarsen the mesh"
    )]
    Pieces {
        /// The face.
        face: u32,
        /// Its triangles.
        pieces: usize,
        /// The samples allowed.
        max: usize,
    },
    /// The area of the face is not a number.
    #[error("face {face}: its area is {area_mm2} mm2; the surface has points that are not finite")]
    Area {
        /// The face.
        face: u32,
        /// What came out.
        area_mm2: f64,
    },
}

/// Lines across the rows on which the distance of rows is measured.
const ACROSS: usize = 17;
/// Where in a triangle that has its pole at v = 0 its centre of area is along v.
const MIDDLE: f64 = 2.0 / 3.0;
/// Normals that turn by less than this from sample to sample, rad, do so by rounding: the face is flat.
const LEVEL: f64 = 1e-9;
/// Attempts to get below the allowed count; each aims at it, and the second nearly always meets it.
const MAX_ATTEMPTS: u32 = 40;
/// Cells of a grid at most, but for as many as samples: of a face that fills little of its rectangle most lie outside, and take time.
const MOST_CELLS: f64 = 1e7;
/// Rows likewise: each is measured before it has cells. A face has as many with a million samples where it is 10,000 times as long as wide.
const MOST_ROWS: f64 = 1e5;

/// Samples a face at about `spacing_mm`, more densely where it bends, with at most `max_samples` samples:
/// where that is too few, or where the rectangle of a trimmed face would take more than ten million cells, the spacing is increased,
/// and the one used is reported in [`Sampling::density`].
///
/// ```
/// use osculate_geom::{Interval, analytic::Cylinder};
/// use osculate_tools::removal::{SamplingError, sample_surface};
/// // A shaft of radius 10 and length 20: its samples stand for all of its area, none far from the next.
/// let shaft = Cylinder::new(10.0, Interval::new(0.0, 20.0))?;
/// let sampling = sample_surface(&shaft, 0, 2.0, 10_000)?;
/// let sum: f64 = sampling.samples.iter().map(|s| s.area_mm2).sum();
/// let area = std::f64::consts::TAU * 10.0 * 20.0;
/// assert!((sum / area - 1.0).abs() < 1e-9 && sampling.density.spacing_mm <= 2.0);
/// assert!(matches!(sample_surface(&shaft, 0, 0.0, 10_000), Err(SamplingError::Spacing { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SamplingError`].
pub fn sample_surface(
    surface: &dyn Surface,
    face: u32,
    spacing_mm: f64,
    max_samples: usize,
) -> Result<Sampling, SamplingError> {
    if !(spacing_mm > 0.0 && spacing_mm.is_finite()) {
        return Err(SamplingError::Spacing { got: spacing_mm });
    }
    if max_samples < 9 {
        return Err(SamplingError::Count { got: max_samples });
    }
    // Coarse: only to choose a first spacing.
    let area = quadrature::area(surface, 1e-2).value;
    if !area.is_finite() {
        return Err(SamplingError::Area { face, area_mm2: area });
    }
    let pieces = surface.pieces();
    if pieces.len() > 1 {
        return sample_pieces(
            (surface, &pieces),
            face,
            spacing_mm.max((area / max_samples as f64).sqrt()),
            max_samples,
        );
    }
    let most = max_samples as f64;
    let most_cells = MOST_CELLS.max(most);
    let inside = quadrature::share_within_trims(surface);
    let mut spacing = spacing_mm.max((area * inside / most).sqrt());
    for _ in 0..MAX_ATTEMPTS {
        let grid = Grid { surface, domain: surface.domain(), face, spacing };
        let rows = grid.rows();
        // Every row has a cell at least, so that this also bounds the work of counting.
        let row_count = rows.count();
        let over = if row_count > MOST_ROWS.min(4.0 * most / inside) {
            (row_count * inside / most).max(row_count / MOST_ROWS)
        } else {
            let cells = grid.count(&rows);
            (cells * inside / most).max(cells / most_cells)
        };
        if over <= 1.0 {
            let sampling = grid.samples(&rows);
            if sampling.samples.is_empty() {
                return Err(SamplingError::Nothing { face, spacing_mm: spacing });
            }
            if sampling.samples.len() <= max_samples {
                return Ok(sampling);
            }
            spacing *= 1.02 * (sampling.samples.len() as f64 / most).sqrt();
        } else {
            spacing *= 1.02 * over.sqrt();
        }
    }
    Err(SamplingError::Nothing { face, spacing_mm: spacing })
}

/// Samples of a surface of many pieces.
fn sample_pieces(
    (surface, pieces): (&dyn Surface, &[Domain]),
    face: u32,
    spacing_mm: f64,
    max_samples: usize,
) -> Result<Sampling, SamplingError> {
    if pieces.len() > max_samples {
        return Err(SamplingError::Pieces { face, pieces: pieces.len(), max: max_samples });
    }
    let mut spacing = spacing_mm;
    for _ in 0..MAX_ATTEMPTS {
        let owned: Vec<Vec<Owned>> = pieces
            .par_iter()
            .map(|domain| Grid { surface, domain: *domain, face, spacing }.of_piece())
            .collect();
        let sampling = Grid { surface, domain: surface.domain(), face, spacing }.gathered(owned);
        match sampling.samples.len() {
            0 => break,
            n if n <= max_samples => return Ok(sampling),
            n => spacing *= 1.02 * (n as f64 / max_samples as f64).sqrt().max(1.1),
        }
    }
    Err(SamplingError::Nothing { face, spacing_mm: spacing })
}

struct Grid<'a> {
    surface: &'a dyn Surface,
    /// What of the surface is looked at.
    domain: Domain,
    face: u32,
    spacing: f64,
}

/// A sample, or the area that has none.
struct Owned {
    sample: Option<Sample>,
    patch: Patch,
    area: f64,
}

impl Grid<'_> {
    fn rows(&self) -> Table {
        let domain = self.domain;
        let breaks = domain.v.breaks(self.surface.breaks(Axis::V));
        Table::new(domain.v, &breaks, |v| {
            (0..ACROSS)
                .map(|k| {
                    let jet = self.surface.jet2(uv(domain.u.at(k as f64 / (ACROSS - 1) as f64), v));
                    weight(&jet.dv, &jet.dvv, normal(&jet).as_ref(), self.spacing)
                })
                .fold(0.0, f64::max)
        })
    }

    fn row(&self, breaks: &[f64], v: f64) -> Table {
        Table::new(self.domain.u, breaks, |u| {
            let jet = self.surface.jet2(uv(u, v));
            weight(&jet.du, &jet.duu, normal(&jet).as_ref(), self.spacing)
        })
    }

    /// The number of cells of the whole rectangle.
    fn count(&self, rows: &Table) -> f64 {
        let breaks = self.surface.breaks(Axis::U);
        rows.cells().par_iter().map(|c| self.row(&breaks, c.at).count()).collect::<Vec<_>>().iter().sum()
    }

    fn samples(&self, rows: &Table) -> Sampling {
        let breaks = self.surface.breaks(Axis::U);
        let owned: Vec<Vec<Owned>> = rows
            .cells()
            .par_iter()
            .map(|row| {
                let cells = self.row(&breaks, row.at).cells();
                cells.iter().filter_map(|cell| self.own(cell, row)).collect()
            })
            .collect();
        self.gathered(owned)
    }

    /// What is owned on a piece: by one sample where the piece is smaller than samples are apart.
    fn of_piece(&self) -> Vec<Owned> {
        /// Places of a piece along each side by which its size is known.
        const SIDE: [f64; 3] = [0.0, 0.5, 1.0];
        let Domain { u, v } = self.domain;
        let places = SIDE.iter().flat_map(|f| SIDE.map(|g| self.surface.point(self.domain.at(*f, g))));
        if Box3::around(&places.collect::<Vec<_>>()).diagonal_mm() <= self.spacing {
            let whole = |i: &Interval, at: f64| Cell { lo: i.lo, at: i.at(at), hi: i.hi };
            return self.own(&whole(&u, 0.5), &whole(&v, MIDDLE)).into_iter().collect();
        }
        let rows = self.rows();
        let along = [u.lo, u.hi];
        let of_row = |row: Cell| {
            let cells = self.row(&along, row.at).cells();
            cells.into_iter().filter_map(move |cell| self.own(&cell, &row))
        };
        rows.cells().into_iter().flat_map(of_row).collect()
    }

    /// Samples and cells of all rows.
    fn gathered(&self, owned: Vec<Vec<Owned>>) -> Sampling {
        let mut out = Sampling {
            samples: Vec::with_capacity(owned.iter().map(Vec::len).sum()),
            patches: Vec::with_capacity(owned.iter().map(Vec::len).sum()),
            density: Density { spacing_mm: self.spacing, convex_per_mm: 0.0 },
            area_mm2: 0.0,
            lost_area_mm2: 0.0,
        };
        for one in owned.into_iter().flatten() {
            out.density.convex_per_mm = out.density.convex_per_mm.max(one.patch.convex_per_mm);
            match one.sample {
                Some(sample) => {
                    out.area_mm2 += one.area;
                    out.samples.push(sample);
                    out.patches.push(one.patch);
                }
                None => out.lost_area_mm2 += one.area,
            }
        }
        out
    }

    /// The sample of a cell; None where the cell is not on the face.
    fn own(&self, u: &Cell, v: &Cell) -> Option<Owned> {
        let node = uv(u.at, v.at);
        // Quarters between the sample and the cell's corners; those on an edge of the rectangle are empty.
        let mut quarters = [(node, 0.0); 4];
        let mut area = 0.0;
        for (k, q) in quarters.iter_mut().enumerate() {
            let (u0, u1) = if k % 2 == 0 { (u.lo, u.at) } else { (u.at, u.hi) };
            let (v0, v1) = if k / 2 == 0 { (v.lo, v.at) } else { (v.at, v.hi) };
            let middle = uv(0.5 * (u0 + u1), 0.5 * (v0 + v1));
            let share = (u1 - u0) * (v1 - v0);
            if share > 0.0 {
                let jet = self.surface.jet2(middle);
                *q = (middle, share * jet.du.cross(&jet.dv).norm());
                area += q.1;
            }
        }
        let full: Vec<Uv> = quarters.iter().filter(|q| q.1 > 0.0).map(|q| q.0).collect();
        let in_node = self.surface.contains(node);
        let hits = full.iter().filter(|q| self.surface.contains(**q)).count();
        let at = if in_node && hits == full.len() {
            node
        } else if !in_node && hits == 0 {
            return None;
        } else {
            let part = self.inside(u, v, node, in_node)?;
            area *= part.share;
            part.at
        };
        let around = full.iter().flat_map(|q| {
            // Next to a pole first, then well away from it.
            [1e-3, 1.0].map(|f| uv(at.u + f * (q.u - at.u), at.v + f * (q.v - at.v)))
        });
        let regular = std::iter::once(at).chain(around.filter(|p| self.surface.contains(*p))).find_map(|p| {
            let jet = self.surface.jet2(p);
            jet.forms().ok().map(|forms| (p, jet.point, forms))
        });
        let flat = Patch { u: [u.lo, u.hi], v: [v.lo, v.hi], concave_per_mm: 0.0, convex_per_mm: 0.0 };
        let Some((uv, point, forms)) = regular else {
            return Some(Owned { sample: None, patch: flat, area });
        };
        let sample =
            Sample { point, normal: forms.normal, face: self.face, uv, area_mm2: area, check_only: false };
        let principal = forms.principal();
        let bend = |k: f64| if k * self.spacing > LEVEL { k } else { 0.0 };
        let patch =
            Patch { concave_per_mm: bend(-principal.k_min), convex_per_mm: bend(principal.k_max), ..flat };
        Some(Owned { sample: Some(sample), patch, area })
    }

    /// The part of a cell that lies on the face, where a trim crosses it.
    fn inside(&self, u: &Cell, v: &Cell, node: Uv, in_node: bool) -> Option<Inside> {
        /// Places tested along each side of a cell: areas of crossed cells are good to about a tenth of a
        /// cell.
        const SIDE: u32 = 8;
        let part = |c: &Cell, k: u32| c.lo + (c.hi - c.lo) * (f64::from(k) + 0.5) / f64::from(SIDE);
        // Distances in parts of the cell.
        let far = |p: &Uv| ((p.u - node.u) / (u.hi - u.lo)).hypot((p.v - node.v) / (v.hi - v.lo));
        let hits: Vec<Uv> = (0..SIDE * SIDE)
            .map(|k| uv(part(u, k % SIDE), part(v, k / SIDE)))
            .filter(|p| self.surface.contains(*p))
            .collect();
        let share = (hits.len() as f64 / f64::from(SIDE * SIDE)).max(0.5 / f64::from(SIDE * SIDE));
        if in_node {
            return Some(Inside { at: node, share });
        }
        let mut inner = *hits.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
        let mut outer = node;
        // To the last digits of the cell.
        for _ in 0..40 {
            let middle = uv(0.5 * (inner.u + outer.u), 0.5 * (inner.v + outer.v));
            if self.surface.contains(middle) { inner = middle } else { outer = middle }
        }
        Some(Inside { at: inner, share })
    }
}

/// The part of a cell on the face: its share of the area and a place in it.
struct Inside {
    at: Uv,
    share: f64,
}
