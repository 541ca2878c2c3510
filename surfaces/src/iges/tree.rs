//! From roots to placed faces: groups (402), solids (186), shells (514), solid instances (430), assemblies (184),
//! subfigure definitions (308) and their instances (408).
//!
//! Every face is placed by the transforms of what holds it. An instance scales its definition, then shifts, then
//! turns it. The operands of a boolean tree are no part of the model until the tree is evaluated, which is not done.

use super::directory::Entity;
use super::geometry::{Geometry, Unread};
use super::links::parts;
use crate::trim::motion::Motion;
use nalgebra::Matrix3;
use osculate_geom::Side;
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// Kinds that are faces when nothing holds them.
const FACES: [u32; 15] = [108, 114, 118, 120, 122, 128, 140, 143, 144, 190, 192, 194, 196, 198, 510];

/// Groups and instances within each other at most.
const MAX_DEPTH: usize = 64;

/// Placed faces at most; instances of instances reach any number.
const MAX_PLACED: usize = 50_000;

/// Visits of groups, shells and instances at most, those that lead nowhere included.
const MAX_VISITS: usize = 2_000_000;

/// One use of a face.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Placed {
    /// Applied after the face's own transform.
    pub(crate) motion: Motion,
    /// The material side, where a solid gives it: the outward normal along or against the surface's own.
    pub(crate) side: Option<Side>,
}

/// What the roots give.
#[derive(Debug, Default)]
pub(crate) struct Model {
    /// The faces by directory number, each with its places.
    pub(crate) faces: BTreeMap<i64, Vec<Placed>>,
    /// Groups, solids and instances on the way.
    pub(crate) used: BTreeSet<i64>,
    /// Entities that cannot be entered, and why.
    pub(crate) refused: Vec<(i64, Unread)>,
    /// Instances of subfigures and solids that were placed.
    pub(crate) instances: usize,
    /// Definitions that no instance places; their faces are given as they stand.
    pub(crate) unplaced: Vec<i64>,
    /// Boolean trees, whose operands are left out, and those operands.
    pub(crate) trees: BTreeSet<i64>,
    /// Whether the limits ended the walk.
    pub(crate) overflow: bool,
}

struct Walk<'g, 'c> {
    geometry: &'g Geometry<'c>,
    model: Model,
    seen: HashSet<(i64, [u64; 12])>,
    visits: usize,
    placed: usize,
}

/// Walks from the roots.
pub(crate) fn model(geometry: &Geometry<'_>) -> Model {
    let entities = &geometry.cards.entities;
    let mut held = BTreeSet::new();
    for (de, e) in entities {
        held.extend(parts(e).into_iter().filter(|p| p != de));
    }
    let mut walk = Walk { geometry, model: Model::default(), seen: HashSet::new(), visits: 0, placed: 0 };
    for (de, e) in entities {
        if held.contains(de) {
            continue;
        }
        if e.kind == 308 {
            walk.model.unplaced.push(*de);
        }
        walk.enter(*de, e, &Place { motion: Motion::identity(), side: None }, 0);
    }
    walk.model
}

#[derive(Clone)]
struct Place {
    motion: Motion,
    side: Option<Side>,
}

fn bits(m: &Motion) -> [u64; 12] {
    let mut out = [0; 12];
    for (slot, x) in out.iter_mut().zip(m.linear.iter().chain(m.shift.iter())) {
        // Minus zero is zero.
        *slot = (x + 0.0).to_bits();
    }
    out
}

impl Walk<'_, '_> {
    fn enter(&mut self, de: i64, e: &Entity, place: &Place, depth: usize) {
        self.visits += 1;
        if self.visits > MAX_VISITS || self.placed > MAX_PLACED {
            self.model.overflow = true;
            return;
        }
        if FACES.contains(&e.kind) {
            // The same face in the same place through two groups is one face.
            if self.seen.insert((de, bits(&place.motion))) {
                self.placed += 1;
                let use_ = Placed { motion: place.motion, side: place.side };
                self.model.faces.entry(de).or_default().push(use_);
            }
            return;
        }
        if !matches!(e.kind, 180 | 184 | 186 | 308 | 402 | 408 | 430 | 514) {
            return;
        }
        if depth >= MAX_DEPTH {
            let why =
                self.geometry.malformed(de, "groups or instances within each other, too deep or in a circle");
            self.refuse(de, why);
            return;
        }
        if let Err(why) = self.open(de, e, place, depth) {
            self.refuse(de, why);
        }
    }

    fn refuse(&mut self, de: i64, why: Unread) {
        if !self.model.refused.iter().any(|r| r.0 == de) {
            self.model.refused.push((de, why));
        }
    }

    fn member(&mut self, de: i64, place: &Place, depth: usize) -> Result<(), Unread> {
        let e = self.geometry.entity(de)?;
        self.enter(de, e, place, depth + 1);
        Ok(())
    }

    fn open(&mut self, de: i64, e: &Entity, place: &Place, depth: usize) -> Result<(), Unread> {
        let g = self.geometry;
        self.model.used.insert(de);
        match e.kind {
            180 => {
                self.model.trees.insert(de);
                Ok(())
            }
            186 => self.solid(de, e, place, depth),
            514 => self.shell(de, e, place, depth, None),
            184 => {
                let n = g.count(de, e, 0, [1, 2])?;
                for k in 0..n {
                    let Some(item) = g.pointer(de, e, 1 + k)? else { continue };
                    let own = g.matrix(g.pointer(de, e, 1 + n + k)?.unwrap_or(0))?;
                    let motion = own.then(&g.motion(e)?).then(&place.motion);
                    self.model.instances += 1;
                    self.member(item, &Place { motion, side: None }, depth)?;
                }
                Ok(())
            }
            430 => {
                let motion = g.motion(e)?.then(&place.motion);
                self.model.instances += 1;
                self.member(g.required(de, e, 0, "solid")?, &Place { motion, side: None }, depth)
            }
            408 => {
                let shift = g.triple(de, e, 1)? * g.scale_mm;
                let scale = g.number(de, e, 4)?;
                let scale = if scale == 0.0 { 1.0 } else { scale };
                if !(scale > 0.0 && scale.is_finite()) {
                    return Err(g.malformed(de, format!("an instance of scale {scale}")));
                }
                let own = Motion { linear: Matrix3::identity() * scale, shift };
                let motion = own.then(&g.motion(e)?).then(&place.motion);
                self.model.instances += 1;
                self.member(g.required(de, e, 0, "definition")?, &Place { motion, side: None }, depth)
            }
            308 => {
                let motion = g.motion(e)?.then(&place.motion);
                let n = g.count(de, e, 2, [3, 1])?;
                self.members(de, e, 3, n, &Place { motion, side: None }, depth)
            }
            _ if matches!(e.form, 1 | 7 | 14 | 15) => {
                let n = g.count(de, e, 0, [1, 1])?;
                self.members(de, e, 1, n, place, depth)
            }
            _ if e.form == 9 => {
                let n = g.count(de, e, 1, [3, 1])?;
                self.members(de, e, 2, n + 1, place, depth)
            }
            _ => Ok(()),
        }
    }

    fn members(
        &mut self,
        de: i64,
        e: &Entity,
        from: usize,
        count: usize,
        place_at: &Place,
        depth: usize,
    ) -> Result<(), Unread> {
        let mut missing = None;
        for k in from..from + count {
            let member = self.geometry.pointer(de, e, k)?;
            // One lost member does not lose the others.
            if let Some(member) = member
                && let Err(why) = self.member(member, place_at, depth)
            {
                missing = missing.or(Some(why));
            }
        }
        missing.map_or(Ok(()), Err)
    }

    /// Entity 186: its shells with the sense of each.
    fn solid(&mut self, de: i64, e: &Entity, place: &Place, depth: usize) -> Result<(), Unread> {
        let g = self.geometry;
        let motion = g.motion(e)?.then(&place.motion);
        let place = Place { motion, side: None };
        let voids = g.count(de, e, 2, [3, 2])?;
        let mut lost = None;
        for k in std::iter::once(0).chain((0..voids).map(|k| 3 + 2 * k)) {
            let along = g.number(de, e, k + 1)? != 0.0;
            let shell_de = g.required(de, e, k, "shell")?;
            let shell = g.entity(shell_de)?;
            if shell.kind != 514 {
                return Err(Unread::Kind { de: shell_de, kind: shell.kind, form: shell.form });
            }
            self.model.used.insert(shell_de);
            if let Err(why) = self.shell(shell_de, shell, &place, depth, Some(along)) {
                lost = lost.or(Some(why));
            }
        }
        lost.map_or(Ok(()), Err)
    }

    /// Entity 514. `along` is the sense of the shell in its solid, `None` for a shell of its own, which bounds no
    /// material.
    fn shell(
        &mut self,
        de: i64,
        e: &Entity,
        place: &Place,
        depth: usize,
        along: Option<bool>,
    ) -> Result<(), Unread> {
        let g = self.geometry;
        let motion = g.motion(e)?.then(&place.motion);
        let mut lost = None;
        for k in 0..g.count(de, e, 0, [1, 2])? {
            let Some(face) = g.pointer(de, e, 1 + 2 * k)? else { continue };
            let same = g.number(de, e, 2 + 2 * k)? != 0.0;
            let side = along.map(|a| if a == same { Side::Along } else { Side::Against });
            if let Err(why) = self.member(face, &Place { motion, side }, depth) {
                lost = lost.or(Some(why));
            }
        }
        lost.map_or(Ok(()), Err)
    }
}
