//! Entities of IGES, their parameters and transforms; curves are in [`super::curves`], surfaces in
//! [`super::carriers`].
//!
//! Parameter-space curves use the same entities without units or model transforms: a [`Space`] says which.

use super::cards::Cards;
use super::directory::Entity;
use super::names::kind_name;
use crate::knots::MAX_DEGREE;
use crate::trim::motion::Motion;
use osculate_geom::Vec3;
use std::cell::{Cell, RefCell};

/// Why an entity could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Unread {
    /// A pointer to nothing.
    #[error("directory entry {de} does not exist or could not be read")]
    Missing { de: i64 },
    /// A kind that is not read.
    #[error("directory entry {de} is a {}, which is not read", kind_name(*.kind, *.form))]
    Kind { de: i64, kind: u32, form: i32 },
    /// Parameters that make no such entity.
    #[error("directory entry {de} (line {line}): {what}")]
    Malformed { de: i64, line: u32, what: String },
    /// A surface without ends and no loop to end it.
    #[error("directory entry {de} is a {}, which has no ends, and nothing bounds it", kind_name(*.kind, *.form))]
    Unlimited { de: i64, kind: u32, form: i32 },
}

/// What a curve's numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Space {
    /// Model space: scaled to millimetres, transforms applied.
    Model,
    /// Parameters of a surface: as they are.
    Parameter,
}

/// Pointers followed from one curve, surface or transform to another at most.
pub(crate) const MAX_CHAIN: usize = 16;

/// Farthest from a rotation or reflection that a matrix is used as it is: sparse writers keep six digits.
const SKEWED: f64 = 1e-4;

/// A reader of geometry that keeps what it had to say.
pub(crate) struct Geometry<'c> {
    pub(crate) cards: &'c Cards,
    /// Millimetres in one unit of the file's numbers.
    pub(crate) scale_mm: f64,
    /// Findings on the way.
    pub(crate) findings: RefCell<Vec<String>>,
    /// Members of composite curves within composite curves so far.
    pub(super) members: Cell<usize>,
}

impl<'c> Geometry<'c> {
    pub(crate) fn new(cards: &'c Cards) -> Self {
        Self {
            cards,
            scale_mm: cards.global.unit_mm / cards.global.scale,
            findings: RefCell::new(Vec::new()),
            members: Cell::new(0),
        }
    }

    /// The entity of a directory entry.
    pub(crate) fn entity(&self, de: i64) -> Result<&'c Entity, Unread> {
        self.cards.entities.get(&de).ok_or(Unread::Missing { de })
    }

    /// The entity is not what it should be.
    pub(crate) fn malformed(&self, de: i64, what: impl Into<String>) -> Unread {
        let line = self.cards.entities.get(&de).map_or(0, |e| e.line);
        Unread::Malformed { de, line, what: what.into() }
    }

    /// Something was changed to be usable; said once.
    pub(crate) fn say(&self, what: String) {
        let mut all = self.findings.borrow_mut();
        if !all.contains(&what) {
            all.push(what);
        }
    }

    /// Parameter `k` (from zero) as a number; a default is zero.
    pub(crate) fn number(&self, de: i64, e: &Entity, k: usize) -> Result<f64, Unread> {
        if let Some(x) = e.params.number(k) {
            return Ok(x);
        }
        if k >= e.params.len() {
            let what = format!("{} parameters, at least {} are needed", e.params.len(), k + 1);
            return Err(self.malformed(de, what));
        }
        match e.params.text(k) {
            Some(t) => {
                let shown: String = t.chars().take(20).collect();
                Err(self.malformed(de, format!("parameter {} is {shown:?}, a number is due", k + 1)))
            }
            None => Ok(0.0),
        }
    }

    /// The parameters from `from` to `to` as numbers; defaults are zero.
    pub(crate) fn numbers(&self, de: i64, e: &Entity, from: usize, to: usize) -> Result<Vec<f64>, Unread> {
        match e.params.numbers(from, to) {
            Some(all) => Ok(all),
            // The one that is missing says so.
            None => (from..to).map(|k| self.number(de, e, k)).collect(),
        }
    }

    /// Parameter `k` as a pointer; zero is none.
    pub(crate) fn pointer(&self, de: i64, e: &Entity, k: usize) -> Result<Option<i64>, Unread> {
        let p = self.number(de, e, k)?;
        if p.fract() != 0.0 {
            return Err(self.malformed(de, format!("parameter {} is {p}, a pointer is due", k + 1)));
        }
        // A negative pointer means the same entity with another role.
        Ok((p != 0.0).then_some(p.abs() as i64))
    }

    /// Parameter `k` as a pointer that must be there, to a `what`.
    pub(crate) fn required(&self, de: i64, e: &Entity, k: usize, what: &str) -> Result<i64, Unread> {
        self.pointer(de, e, k)?.ok_or_else(|| self.malformed(de, format!("no pointer to its {what}")))
    }

    /// Parameter `k` as a count of things that take at least `each` parameters from `from` on.
    pub(crate) fn count(
        &self,
        de: i64,
        e: &Entity,
        k: usize,
        [from, each]: [usize; 2],
    ) -> Result<usize, Unread> {
        let n = self.number(de, e, k)?;
        let room = e.params.len().saturating_sub(from) / each.max(1);
        if n >= 0.0 && n.fract() == 0.0 && n <= room as f64 {
            Ok(n as usize)
        } else {
            Err(self.malformed(de, format!("a count of {n} where the parameters hold {room}")))
        }
    }

    pub(crate) fn triple(&self, de: i64, e: &Entity, k: usize) -> Result<Vec3, Unread> {
        Ok(Vec3::new(self.number(de, e, k)?, self.number(de, e, k + 1)?, self.number(de, e, k + 2)?))
    }

    pub(crate) fn degree(&self, de: i64, e: &Entity, k: usize) -> Result<usize, Unread> {
        let d = self.number(de, e, k)?;
        if d >= 1.0 && d <= MAX_DEGREE as f64 && d.fract() == 0.0 {
            Ok(d as usize)
        } else {
            Err(self.malformed(de, format!("degree {d}, 1 to {MAX_DEGREE} can be read")))
        }
    }

    /// The transform of an entity to model space, in millimetres.
    pub(crate) fn motion(&self, e: &Entity) -> Result<Motion, Unread> {
        self.matrix(e.transform)
    }

    /// The motion of a transformation matrix, zero being none, with those that it refers to.
    pub(crate) fn matrix(&self, first: i64) -> Result<Motion, Unread> {
        let mut motion = Motion::identity();
        let mut next = first;
        for _ in 0..MAX_CHAIN {
            if next <= 0 {
                return Ok(motion);
            }
            let de = next;
            let t = self.entity(de)?;
            if t.kind != 124 {
                return Err(Unread::Kind { de, kind: t.kind, form: t.form });
            }
            let m = self.numbers(de, t, 0, 12)?;
            let linear = nalgebra::Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
            let off = (linear * linear.transpose() - nalgebra::Matrix3::identity()).norm();
            if off.is_nan() || off > SKEWED {
                return Err(self.malformed(de, "a matrix that is no rotation or reflection"));
            }
            let shift = Vec3::new(m[3], m[7], m[11]) * self.scale_mm;
            motion = motion.then(&Motion { linear, shift });
            next = t.transform;
        }
        Err(self.malformed(next, "transforms refer to each other in a circle"))
    }

    pub(crate) const fn unit(&self, space: Space) -> f64 {
        match space {
            Space::Model => self.scale_mm,
            Space::Parameter => 1.0,
        }
    }
}
