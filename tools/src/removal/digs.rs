//! How deep anything may go into the part between samples, cell by cell.
//!
//! Two bounds. At the bottom of a gouge the standoff is level, so that a sample r away from it stands higher by at most
//! `K r^2 / 2`, K the relative curvature of cutter and part: quick, and near enough for a ball. The bottom of a toroidal end
//! is as sharp as its corner, wherever on the tool its strip comes from, and that of a flat end or of a holder has no curvature
//! at all: tools that are far sharper than others of a program count with the holders. Cells of which this says too little are looked at themselves: a gouge deeper than h is a body that meets the
//! face set back by h, and where no motion brings a body to a box around a cell set back so, there is none. What comes near
//! has the cell divided, up to [`DIVISIONS`] times: a convex body that keeps off the face itself leaves the box by the square
//! of its size.
//!
//! Samples of check faces have cells too, and holder and rapids are bodies as the cutter is.

use super::body::Body;
use super::cluster::{Cluster, clusters};
use super::edges::Edges;
use super::job::{Cut, Job, JobError, Sample};
use super::piece::{Approach, Passes, Piece};
use super::sampling::Patch;
use super::target::Target;
use super::tree::{Ways, Which};
use crate::cutter::Cutter;
use osculate_geom::Surface;
use rayon::prelude::*;

/// How often a cell is halved in both directions.
pub const DIVISIONS: u32 = 3;
/// Pieces of motions are halved until they stray from straight ones by no more than this share of the depth that is asked for.
const STRAY: f64 = 0.1;
/// Halvings of a piece at most, each to a quarter of what it strays by.
const HALVINGS: u32 = 6;
/// Groups of samples that are asked about together before each is by itself.
const TOGETHER: usize = 32;
/// A cutter is far sharper than another where its corner has less than this part of the other's radius.
const SHARP: f64 = 0.25;
/// Turn of the relative curvature over a cell, rad, up to which the quick bound is of second order.
const MOST_TURN: f64 = 0.5;

/// What is known of the depth in one cell.
pub(super) struct Depth {
    /// The sample whose cell it is.
    pub sample: usize,
    /// Nothing in the cell is deeper, mm.
    pub most_mm: f64,
    /// Parts of the cell in which there may be something deeper than asked for; none where `most_mm` is no more than that.
    pub parts: Vec<Patch>,
}

/// Motions and the bodies that they carry.
#[derive(Clone, Copy)]
pub(super) struct Digs<'a> {
    pub job: &'a Job<'a>,
    pub ways: &'a Ways,
    /// The depth that is asked for, mm.
    pub depth_mm: f64,
    /// All faces, where places beside their outer edges are told apart.
    pub edges: Option<&'a Edges<'a>>,
}

/// A motion that brings a body near.
#[derive(Clone, Copy)]
struct Comer<'a> {
    body: Body<'a>,
    approach: Approach,
}

/// A cell set back.
struct Back {
    target: Target,
    /// From its middle to its farthest corner, mm.
    radius: f64,
}

impl Comer<'_> {
    fn comes_near(&self, target: &Target) -> bool {
        self.approach.passes(&self.body, target, 0.0) != Passes::Clear
    }
}

/// The cell of a sample.
struct Cell {
    sample: usize,
    patch: Patch,
    back: Back,
    /// By the quick bound nothing in it that does not intrude is deeper, mm.
    level_mm: f64,
}

/// Radius of a cutter's corner, mm: those with a meridian of their own may have edges anywhere.
fn corner_mm(cutter: &Cutter) -> f64 {
    if cutter.is_end_mill() { cutter.corner_mm() } else { 0.0 }
}

/// By how much a gouge of a cutter that does not intrude may be deeper than a sample so far away shows. Of several the sharpest counts.
fn level_mm(bodies: &[Body<'_>], patch: &Patch, radius: f64) -> f64 {
    let blunt = bodies.iter().filter(|b| !b.intrudes);
    let corner = blunt.map(|b| corner_mm(b.cutter)).fold(f64::INFINITY, f64::min);
    let relative = 1.0 / corner + patch.convex_per_mm;
    if relative * radius <= MOST_TURN { 0.5 * relative * radius * radius } else { f64::INFINITY }
}

impl<'a> Digs<'a> {
    /// The depths of all cells, in the order of groups of samples.
    pub fn depths(
        &self,
        surfaces: &[&dyn Surface],
        (patches, cuts): (&[Option<Patch>], &[Cut]),
    ) -> Result<Vec<Depth>, JobError> {
        let mut bodies = Body::all(self.job);
        let bluntest_mm = self.job.cutters().map(corner_mm).fold(0.0, f64::max);
        for body in &mut bodies {
            body.intrudes |= corner_mm(body.cutter) < SHARP * bluntest_mm;
        }
        let of = |groups: &[Cluster]| self.of_groups(&bodies, groups, surfaces, (patches, cuts));
        Ok(clusters(self.job.samples)?.par_chunks(TOGETHER).flat_map_iter(of).collect())
    }

    /// Of groups next to each other: mostly nothing intrudes into any of them.
    fn of_groups(
        &self,
        bodies: &[Body<'a>],
        groups: &[Cluster],
        surfaces: &[&dyn Surface],
        (patches, cuts): (&[Option<Patch>], &[Cut]),
    ) -> Vec<Depth> {
        let cell = |k: usize| {
            let patch = patches[k]?;
            let back = self.back(surfaces, k, &patch);
            // At an open rim a gouge ends before its bottom is level, as far in as depth is asked for.
            let Sample { point, face, .. } = &self.job.samples[k];
            let within_mm = back.radius + self.depth_mm;
            let at_rim = self.edges.is_some_and(|edges| edges.is_at_rim(point, *face, within_mm));
            let level_mm = if at_rim {
                f64::INFINITY
            } else {
                level_mm(bodies, &patch, back.radius) - cuts[k].standoff_mm
            };
            Some(Cell { sample: k, patch, back, level_mm })
        };
        let cells: Vec<Vec<Cell>> = groups
            .iter()
            .map(|group| group.members.iter().filter_map(|k| cell(*k as usize)).collect())
            .collect();
        let any = !self.near_all(bodies, cells.iter().flatten(), Which::Intruding).is_empty();
        cells.iter().flat_map(|own| self.of_group((bodies, any), own, surfaces, cuts)).collect()
    }

    /// What comes near any of some cells.
    fn near_all<'c>(
        &self,
        bodies: &[Body<'a>],
        mut cells: impl Iterator<Item = &'c Cell> + Clone,
        which: Which,
    ) -> Vec<Comer<'a>> {
        let corners = cells.clone().flat_map(|cell| cell.back.target.corners());
        let Some(first) = cells.next() else { return Vec::new() };
        let whole = Target::around(corners, &self.job.samples[first.sample].normal);
        self.near(bodies, &whole, which)
    }

    /// Of one group, of which it is known whether anything intrudes. What comes near any of its cells is looked for once.
    fn of_group(
        &self,
        (bodies, any): (&[Body<'a>], bool),
        cells: &[Cell],
        surfaces: &[&dyn Surface],
        cuts: &[Cut],
    ) -> Vec<Depth> {
        let is_level = |cell: &Cell| cell.level_mm <= self.depth_mm;
        let intruders = if any { self.near_all(bodies, cells.iter(), Which::Intruding) } else { Vec::new() };
        let intrudes = !intruders.is_empty();
        let all = self.near_all(bodies, cells.iter().filter(|c| !is_level(c)), Which::All);
        let depth = |cell: &Cell| {
            let Cell { sample, patch, back, level_mm } = cell;
            let (sample, level) = (*sample, *level_mm);
            let around = match (is_level(cell), intrudes) {
                (true, false) => return Depth { sample, most_mm: level, parts: Vec::new() },
                (true, true) => &intruders,
                (false, _) => &all,
            };
            let mut parts = Vec::new();
            if cuts[sample].by.is_some() && level.is_finite() && self.is_coarse(bodies, level) {
                let surface = surfaces[self.job.samples[sample].face as usize];
                let all = patch.parts().into_iter().flat_map(|p| p.parts());
                parts.extend(all.filter(|p| p.raster().any(|place| surface.contains(place))));
            } else {
                let comers: Vec<Comer<'a>> =
                    around.iter().filter(|c| c.comes_near(&back.target)).copied().collect();
                self.divide(surfaces, sample, patch, &comers, (DIVISIONS, &mut parts));
            }
            parts.retain(|part| !self.is_beside(surfaces, sample, part));
            // The quick bound is one on the cutter's own gouges.
            let quick = if intrudes { f64::INFINITY } else { level };
            let known = if parts.is_empty() {
                self.depth_mm
            } else if quick.is_finite() {
                quick
            } else {
                self.known(bodies, surfaces, sample, patch)
            };
            Depth { sample, most_mm: quick.min(known), parts }
        };
        cells.iter().map(depth).collect()
    }

    /// Whether what is so deep beneath a part of a cell lies next to another place of the faces: beyond the centre of a ridge's curvature it
    /// does.
    fn is_beside(&self, surfaces: &[&dyn Surface], sample: usize, part: &Patch) -> bool {
        let Some(edges) = self.edges else { return false };
        let face = self.job.samples[sample].face;
        let surface = surfaces[face as usize];
        part.corners().into_iter().chain([part.middle()]).all(|at| {
            surface.jet2(at).forms().is_ok_and(|forms| {
                forms.principal().k_max * self.depth_mm > 1.0
                    || edges.is_beside((&surface.point(at), &forms.normal), face, self.depth_mm)
            })
        })
    }

    /// A depth that nothing in a cell goes beyond: doubled until this is so, or until gouges are not followed.
    fn known(&self, bodies: &[Body<'a>], surfaces: &[&dyn Surface], sample: usize, patch: &Patch) -> f64 {
        let mut depth_mm = self.depth_mm;
        while depth_mm < self.job.depth_mm {
            depth_mm *= 2.0;
            let deeper = Self { depth_mm, ..*self };
            let target = deeper.back(surfaces, sample, patch).target;
            if deeper.near(bodies, &target, Which::All).is_empty() {
                break;
            }
        }
        depth_mm
    }

    /// Whether a cell is so large that a ball would come near parts of it wherever it cuts, with no gouge at all: a ball is as sharp
    /// everywhere as the quick bound has it, which falls with the square of the size.
    fn is_coarse(&self, bodies: &[Body<'_>], level_mm: f64) -> bool {
        let mut blunt = bodies.iter().filter(|b| !b.intrudes);
        blunt.all(|b| b.cutter.is_ball()) && level_mm > 4f64.powi(DIVISIONS as i32) * self.depth_mm
    }

    /// A patch of the cell of sample `k`, set back into the part.
    fn back(&self, surfaces: &[&dyn Surface], k: usize, patch: &Patch) -> Back {
        let sample = &self.job.samples[k];
        let surface = surfaces[sample.face as usize];
        let jet = surface.jet2(patch.middle());
        // Without a tangent plane in the middle that of the sample stands for it: what counts is a box, whichever way it lies.
        let normal = jet.normal().unwrap_or(sample.normal);
        let points = patch.corners().map(|c| surface.point(c));
        let radius = points.iter().map(|p| (p - jet.point).norm()).fold(0.0, f64::max);
        let bend = patch.bend(surface, &normal, radius);
        let set = normal.into_inner() * self.depth_mm;
        let all = points.into_iter().chain([jet.point]).map(move |p| p - set);
        // The face leaves the plane of the middle by half the bend of the radius, and so do places set back along normals that
        // turn; these leave it sideways by the bend of the depth.
        let more = [0.5 * bend * (radius + bend * self.depth_mm), bend * self.depth_mm];
        let target = Target::wider(all, &normal, more);
        Back { target, radius }
    }

    fn near(&self, bodies: &[Body<'a>], target: &Target, which: Which) -> Vec<Comer<'a>> {
        let mut found = Vec::new();
        self.ways.near(bodies, target, which, |k, body, _| {
            let piece = self.ways.pieces[k as usize];
            let rapid = self.job.motions[piece.motion as usize].rapid;
            if which == Which::Intruding && !body.intrudes && !rapid {
                return;
            }
            self.comers(*body, piece, target, HALVINGS, &mut found);
        });
        found
    }

    /// The parts of a piece that may bring a body to the target.
    fn comers(
        &self,
        body: Body<'a>,
        piece: Piece,
        target: &Target,
        halvings: u32,
        found: &mut Vec<Comer<'a>>,
    ) {
        let approach = Approach::new(&self.job.motions[piece.motion as usize], &piece);
        match approach.passes(&body, target, 0.0) {
            Passes::Clear => {}
            Passes::Near { sagitta, .. } if sagitta > STRAY * self.depth_mm && halvings > 0 => {
                for half in piece.halves() {
                    self.comers(body, half, target, halvings - 1, found);
                }
            }
            Passes::Near { .. } => found.push(Comer { body, approach }),
        }
    }

    /// Divides a patch that `comers` come near, and keeps the parts that some come near still.
    fn divide(
        &self,
        surfaces: &[&dyn Surface],
        sample: usize,
        patch: &Patch,
        comers: &[Comer<'a>],
        (divisions, parts): (u32, &mut Vec<Patch>),
    ) {
        if comers.is_empty() {
            return;
        }
        if divisions == 0 {
            parts.push(*patch);
            return;
        }
        let surface = surfaces[self.job.samples[sample].face as usize];
        for part in patch.parts() {
            if !part.raster().any(|place| surface.contains(place)) {
                continue;
            }
            let target = self.back(surfaces, sample, &part).target;
            let comes = |c: &&Comer<'a>| c.comes_near(&target);
            // Of the last parts one that comes near says all there is to say.
            let wanted = if divisions == 1 { 1 } else { comers.len() };
            let near: Vec<Comer<'a>> = comers.iter().filter(comes).take(wanted).copied().collect();
            self.divide(surfaces, sample, &part, &near, (divisions - 1, &mut *parts));
        }
    }
}
