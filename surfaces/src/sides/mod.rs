//! On which side of each face the material is, where the file does not say, from the whole part.
//!
//! Faces whose rims run together are joined: along a common edge their normals either agree or not, whatever the angle between
//! them. Within a group of joined faces one face settles all others: one of which the side is known, or else a single vote of
//! rays from the whole group, or the volume that it closes around. What none of these says stays open.
//!
//! Faces that bound different solids of a file are looked at apart: a solid says by itself where its material is, however it lies in
//! others, touches or cuts them. The walls of its voids are among its own faces, and rays tell them by the outer ones.

mod groups;
mod link;
mod meeting;
mod open;
mod rim;
mod shell;
mod tree;

pub(crate) use link::Met;
pub use meeting::{Meeting, meetings};
pub use open::{OpenRim, open_rims};
pub(crate) use shell::volume_sign;
pub(crate) use tree::Tree;
mod vote;

use crate::mesh::{Mesh, tessellate};
use crate::part::Face;
use osculate_geom::{Box3, Point3, Side};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Certainty below which a vote does not count.
const CLEAR_VOTE: f64 = 0.5;
/// Chord tolerance of the triangles that rays cross, as a part of the part's size.
const CHORD: f64 = 1e-3;
/// Crossings this near to the start of a ray are the face itself, as a part of the part's size: beyond the chord error of the
/// triangles, well below the thickness of anything that is machined.
const SKIP: f64 = 1e-4;
/// Length of the pieces of rims, as a part of the part's size.
const STEP: f64 = 5e-3;
/// Rims are one edge within this part of the part's size; a file that is less exact says so.
const JOIN: f64 = 1e-5;
/// Rims may gape this far, as a part of the part's size, where no other face is nearer.
const GAP: f64 = 5e-4;

/// Share of the rims of faces that close that other faces go on from: the rest is folds and places where more than two meet.
pub(crate) const CLOSED: f64 = 0.95;

/// What settles the sides of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Settled {
    /// Faces of the group whose side was known.
    Known,
    /// The vote of rays: the part, or the solid, encloses material there.
    Enclosed,
    /// The faces close, with the material inside, and rays do not say otherwise: walls so thin that rays miss them.
    Closed,
    /// Nothing: the group stays open.
    Open,
}

/// Faces that hang together, with the side of each.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SideGroup {
    /// Numbers of the faces, ascending.
    pub faces: Vec<usize>,
    /// The outward side of each relative to its present normal. Of an open group the sides are right relative to each other only.
    pub sides: Vec<Side>,
    /// What settled it.
    pub settled: Settled,
    /// How much the rays speak for these sides: 1 for a closed body, 0 for an open sheet, negative where they speak against them.
    pub certainty: f64,
    /// Known faces of the group that say otherwise than `sides`.
    pub otherwise: Vec<usize>,
}

/// Two neighbours that do not fit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SideConflict {
    /// Their numbers.
    pub faces: [usize; 2],
    /// Length of their common edge, mm.
    pub length_mm: f64,
    /// True where stretches of the common edge contradict each other, false where the other neighbours say otherwise.
    pub within: bool,
}

/// The sides of all faces.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Sides {
    /// The outward side of each face relative to its present normal; none where it is open. Known faces are as they were told.
    pub of: Vec<Option<Side>>,
    /// The groups, in the order of their first faces.
    pub groups: Vec<SideGroup>,
    /// Neighbours that do not fit, heaviest last.
    pub conflicts: Vec<SideConflict>,
}

/// What is known of faces before their sides are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Before<'a> {
    /// The sides that are known, relative to the present normals; a list that is too short says nothing of the rest.
    pub sides: &'a [Option<Side>],
    /// The number of the solid that each face bounds, as the file says ([`Structure::solids`](crate::structure::Structure::solids)); faces of none
    /// are one part together.
    pub solids: &'a [Option<usize>],
    /// What the file says of its own exactness, mm.
    pub uncertainty_mm: Option<f64>,
}

/// Finds the side of the material of every face. The answer is the same for any number of threads.
///
/// ```
/// use osculate_geom::Side;
/// use osculate_surfaces::{patches, sides};
/// // Two sheets at a right angle, of which the first is known: the other follows, turned round where it does not go with it.
/// let text = "2\n1 1\n0 0 0\n0 10 0\n10 0 0\n10 10 0\n1 1\n10 0 0\n10 0 -10\n10 10 0\n10 10 -10\n";
/// let part = patches::read(text.as_bytes())?;
/// let faces: Vec<_> = part.faces.iter().collect();
/// let known = [Some(Side::Along)];
/// let found = sides::settle(&faces, &sides::Before { sides: &known, ..Default::default() });
/// assert_eq!(found.of, [Some(Side::Along), Some(Side::Against)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn settle(faces: &[&Face], before: &Before<'_>) -> Sides {
    let mut solids: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
    for f in 0..faces.len() {
        solids.entry(before.solids.get(f).copied().flatten()).or_default().push(f);
    }
    let mut out = Sides { of: vec![None; faces.len()], ..Sides::default() };
    for (solid, own) in solids {
        let told: Vec<Option<Side>> = own.iter().map(|f| before.sides.get(*f).copied().flatten()).collect();
        let its: Vec<&Face> = own.iter().map(|f| faces[*f]).collect();
        let found = alone(&its, &told, before.uncertainty_mm, solid.is_some());
        own.iter().zip(found.of).for_each(|(f, side)| out.of[*f] = side);
        let at = |all: Vec<usize>| all.into_iter().map(|k| own[k]).collect::<Vec<_>>();
        out.groups.extend(found.groups.into_iter().map(|g| SideGroup {
            faces: at(g.faces),
            otherwise: at(g.otherwise),
            ..g
        }));
        let named = |c: SideConflict| SideConflict { faces: c.faces.map(|k| own[k]), ..c };
        out.conflicts.extend(found.conflicts.into_iter().map(named));
    }
    out.groups.sort_by_key(|g| g.faces[0]);
    heaviest_last(&mut out.conflicts);
    out
}

/// The sides of faces that are one part by themselves; a solid encloses material, however its faces meet.
fn alone(faces: &[&Face], known: &[Option<Side>], uncertainty_mm: Option<f64>, is_solid: bool) -> Sides {
    let told = |f: usize| known.get(f).copied().flatten();
    let Some((_, size_mm)) = sized(faces) else {
        return Sides { of: (0..faces.len()).map(told).collect(), ..Sides::default() };
    };
    let (joined, rims, conflicts) = hanging(faces, size_mm, uncertainty_mm);
    let meshes: Vec<Mesh> = faces.par_iter().map(|f| tessellate(&f.surface, CHORD * size_mm, None)).collect();
    let at = |m: &Mesh, k: u32| Point3::from(m.positions[k as usize]);
    let soup = meshes.iter().flat_map(|m| m.triangles.iter().map(|t| t.map(|k| at(m, k))));
    let part = Tree::new(soup.collect());
    let mut out = Sides { of: (0..faces.len()).map(told).collect(), groups: Vec::new(), conflicts };
    for group in joined {
        let of: Vec<(&Mesh, Side)> =
            group.faces.iter().zip(&group.sides).map(|(f, s)| (&meshes[*f], *s)).collect();
        // What all the known faces say, by their areas.
        let says =
            |(f, s): (&usize, &Side)| told(*f).map_or(0.0, |k| k.seen(*s).sign() * meshes[*f].area_mm2());
        let word: f64 = group.faces.iter().zip(&group.sides).map(says).sum();
        let vote = vote::enclosure(&vote::places(&of), &part, SKIP * size_mm);
        let rim: Met = group.faces.iter().map(|f| rims[*f]).sum();
        let (sign, settled) = if word != 0.0 {
            (word, Settled::Known)
        } else if vote.abs() >= CLEAR_VOTE && (is_solid || !among_others(&rim)) {
            (vote, Settled::Enclosed)
        } else {
            let of: Vec<(&Face, Side)> =
                group.faces.iter().zip(&group.sides).map(|(f, s)| (faces[*f], *s)).collect();
            let closes = rim.by_one_mm >= CLOSED * rim.whole_mm;
            let sign = if closes { volume_sign(&of) } else { None };
            sign.map_or((1.0, Settled::Open), |sign| (sign, Settled::Closed))
        };
        let turn = if sign < 0.0 { Side::Against } else { Side::Along };
        let sides: Vec<Side> = group.sides.iter().map(|s| s.seen(turn)).collect();
        let mut otherwise = Vec::new();
        for (f, s) in group.faces.iter().zip(&sides) {
            match told(*f) {
                Some(k) if k != *s => otherwise.push(*f),
                None if settled != Settled::Open => out.of[*f] = Some(*s),
                _ => {}
            }
        }
        let certainty = vote * turn.sign();
        out.groups.push(SideGroup { faces: group.faces, sides, settled, certainty, otherwise });
    }
    out
}

/// Whether a group that does not close runs along several others at once: sheets of several bodies in one place, of which rays through all
/// of them say nothing. In a solid they are edges where more than two of its faces meet.
fn among_others(rim: &Met) -> bool {
    rim.by_one_mm < CLOSED * rim.whole_mm && rim.by_several_mm > (1.0 - CLOSED) * rim.whole_mm
}

/// Groups, the rim of each face, and neighbours that do not fit.
pub(crate) type Hanging = (Vec<groups::Joined>, Vec<Met>, Vec<SideConflict>);

/// The boxes around faces and the size of all together, mm; none where that is not finite or nothing.
fn sized(faces: &[&Face]) -> Option<(Vec<Box3>, f64)> {
    let boxes: Vec<Box3> = faces.par_iter().map(|f| f.surface.bbox(1)).collect();
    let size_mm = boxes.iter().fold(Box3::empty(), |b, f| b.union(f)).diagonal_mm();
    (size_mm.is_finite() && size_mm > 0.0).then_some((boxes, size_mm))
}

/// The rims of all faces in short pieces, and the slacks within which two of them are one edge: always, and where nothing is nearer.
fn rims(faces: &[&Face], size_mm: f64, uncertainty_mm: Option<f64>) -> (Vec<rim::Bit>, [f64; 2]) {
    let (traced, slack_mm) = traced_rims(faces, size_mm, uncertainty_mm);
    (traced.into_iter().map(|t| t.0).collect(), slack_mm)
}

/// As [`rims`], with the polylines of the pieces.
fn traced_rims(faces: &[&Face], size_mm: f64, uncertainty_mm: Option<f64>) -> (Vec<rim::Traced>, [f64; 2]) {
    let bits: Vec<Vec<rim::Traced>> =
        faces.par_iter().enumerate().map(|(k, f)| rim::rim(k, f, STEP * size_mm)).collect();
    let join_mm = uncertainty_mm.filter(|u| u.is_finite()).unwrap_or(0.0).max(JOIN * size_mm);
    (bits.into_iter().flatten().collect(), [join_mm, join_mm.max(GAP * size_mm)])
}

/// The groups of faces that hang together.
pub(crate) fn hanging(faces: &[&Face], size_mm: f64, uncertainty_mm: Option<f64>) -> Hanging {
    let (bits, slack_mm) = rims(faces, size_mm, uncertainty_mm);
    let links = link::links(faces.len(), &bits, slack_mm);
    let (joined, against) = groups::groups(faces.len(), &links.clear);
    let within = links.mixed.iter().map(|(faces, length_mm)| (*faces, *length_mm, true));
    let among = against.iter().map(|l| (l.faces, l.weight_mm, false));
    let mut conflicts: Vec<SideConflict> = within
        .chain(among)
        .map(|(faces, length_mm, within)| SideConflict { faces, length_mm, within })
        .collect();
    heaviest_last(&mut conflicts);
    (joined, links.rims, conflicts)
}

fn heaviest_last(conflicts: &mut [SideConflict]) {
    conflicts.sort_by(|a, b| a.length_mm.total_cmp(&b.length_mm).then(a.faces.cmp(&b.faces)));
}
