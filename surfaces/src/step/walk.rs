//! Which faces a file has, and where: from the root representations down to the faces.
//!
//! Every item of a representation gives its own faces, those of a shared shell too, once for every place. The walk is
//! bounded in faces, visits and depth.

use super::graph::{Graph, arg};
use super::structure::{FACES, Web, is_face};
use super::units::Contexts;
use crate::trim::motion::Motion;
use osculate_geom::Diagnostic;
use osculate_geom::analytic::Placement;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// Faces placed at most: a bomb of nested instances ends here.
const MAX_FACES: usize = 200_000;

/// Representations and items visited at most.
const MAX_VISITS: usize = 1_000_000;

/// Deepest nesting of assemblies and of items in items.
const MAX_DEPTH: usize = 64;

/// A face at a place.
#[derive(Clone)]
pub(crate) struct Occurrence {
    /// The face, or the bounded surface of a geometric set.
    pub(crate) face: u64,
    /// Whether reversed shells or oriented faces turn it over.
    pub(crate) turned: bool,
    /// From the representation's coordinates to the root's; `None` where nothing moves.
    pub(crate) motion: Option<Motion>,
    /// The number of its place: edges are shared within one.
    pub(crate) place: usize,
    /// The units of its coordinates.
    pub(crate) context: Option<usize>,
    /// The shape item that it belongs to: a solid, a shell model.
    pub(crate) item: Option<u64>,
    /// The shell within it.
    pub(crate) shell: Option<u64>,
    /// The names of the products that it stands in, from the root down to its own.
    pub(crate) path: Arc<[Arc<str>]>,
}

impl Occurrence {
    /// The product's name; empty where it has none.
    pub(crate) fn product(&self) -> &str {
        self.path.last().map_or("", |name| name)
    }
}

/// Keywords of the items that are shells.
const SHELLS: [&str; 4] = ["CLOSED_SHELL", "OPEN_SHELL", "CONNECTED_FACE_SET", "CONNECTED_FACE_SUB_SET"];

/// Keywords of items that hold faces by direct reference.
const CONTAINERS: [&str; 13] = [
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
    "CLOSED_SHELL",
    "OPEN_SHELL",
    "CONNECTED_FACE_SET",
    "CONNECTED_FACE_SUB_SET",
    "GEOMETRIC_SET",
    "NON_MANIFOLD_SOLID_BREP",
    "SHELLED_SOLID",
    "SURFACED_OPEN_SHELL",
];

/// Surfaces that are bounded by themselves: as elements of a geometric set they are faces.
const BOUNDED: [&str; 9] = [
    "CURVE_BOUNDED_SURFACE",
    "RECTANGULAR_TRIMMED_SURFACE",
    "B_SPLINE_SURFACE_WITH_KNOTS",
    "B_SPLINE_SURFACE",
    "BEZIER_SURFACE",
    "UNIFORM_SURFACE",
    "QUASI_UNIFORM_SURFACE",
    "SPHERICAL_SURFACE",
    "TOROIDAL_SURFACE",
];

/// What the structure gives.
pub(crate) struct Found {
    /// The faces in the order of the roots, those of one place in file order.
    pub(crate) faces: Vec<Occurrence>,
    /// Whether a bound ended the walk.
    pub(crate) cut_short: bool,
}

/// Walks the file's representations down to their faces; faces in no representation come last.
pub(crate) fn occurrences(graph: &Graph<'_>, contexts: &Contexts, out: &mut Vec<Diagnostic>) -> Found {
    let web = Web::read(graph, contexts);
    let mut walk = Walk {
        web: &web,
        faces: Vec::new(),
        seen: HashSet::new(),
        items: HashMap::new(),
        round: 0,
        visits: 0,
        path: Vec::new(),
        names: Vec::new(),
        said: BTreeMap::new(),
        notes: Vec::new(),
        number: 0,
        cut_short: false,
    };
    let roots: Vec<usize> = (0..web.reps.len())
        .filter(|r| web.group[*r] == *r && !web.members[*r].iter().any(|m| web.placed[*m]))
        .collect();
    let of_product = |r: &usize| web.members[*r].iter().any(|m| web.products.contains_key(&web.reps[*m].id));
    let (first, second): (Vec<usize>, Vec<usize>) = roots.into_iter().partition(of_product);
    for root in first {
        walk.group(root, None, false);
    }
    // Representations of no product repeat items for other ends: only what is new counts. Circles have no root.
    for root in second {
        walk.round += 1;
        walk.group(root, None, true);
    }
    walk.round += 1;
    for r in 0..web.reps.len() {
        if web.group[r] == r && web.members[r].iter().any(|m| web.placed[*m]) {
            walk.group(r, None, true);
        }
    }
    walk.loose(out);
    for (what, (count, first)) in std::mem::take(&mut walk.said) {
        let more = if count > 1 { format!(" ({count} times)") } else { String::new() };
        out.push(Diagnostic::loss(graph.place(first), format!("{what}{more}")));
    }
    out.append(&mut walk.notes);
    if walk.cut_short {
        out.push(Diagnostic::loss(
            "",
            format!(
                "the assembly has more than {MAX_FACES} placed faces or {MAX_VISITS} placed items; the first {} \
                 faces are read. Export its parts one by one",
                walk.faces.len()
            ),
        ));
    }
    Found { faces: walk.faces, cut_short: walk.cut_short }
}

/// A place in the walk.
#[derive(Clone)]
struct Place {
    motion: Option<Motion>,
    context: Option<usize>,
    item: Option<u64>,
    shell: Option<u64>,
    path: Arc<[Arc<str>]>,
}

struct Walk<'w, 'g> {
    web: &'w Web<'g>,
    faces: Vec<Occurrence>,
    /// Faces placed somewhere.
    seen: HashSet<u64>,
    /// Items placed somewhere, and the round of roots that placed them first.
    items: HashMap<u64, usize>,
    /// The round in hand.
    round: usize,
    visits: usize,
    /// Groups from the root down.
    path: Vec<usize>,
    /// The names of their products.
    names: Vec<Arc<str>>,
    /// Losses with their number and first record.
    said: BTreeMap<String, (usize, u64)>,
    notes: Vec<Diagnostic>,
    /// Number of the place in hand: every visit of a group is one.
    number: usize,
    cut_short: bool,
}

impl Walk<'_, '_> {
    /// Places what belongs to no representation: whole items first, then shells, then faces.
    fn loose(&mut self, out: &mut Vec<Diagnostic>) {
        let graph = self.web.graph;
        let nobody = Place { motion: None, context: None, item: None, shell: None, path: Arc::from([]) };
        let before = self.faces.len();
        self.number += 1;
        let oriented = ["ORIENTED_CLOSED_SHELL", "ORIENTED_OPEN_SHELL", "ORIENTED_FACE"];
        let stages: [&[&'static str]; 4] = [&CONTAINERS[..5], &oriented, &CONTAINERS[5..], &FACES];
        for stage in stages {
            for record in graph.structure().filter(|r| r.any(stage).is_some()) {
                let inner = if stage == oriented { record.references().next() } else { Some(record.id()) };
                let known = inner.is_none_or(|i| self.items.contains_key(&i) || self.seen.contains(&i));
                if !known && self.room() {
                    self.item(record.id(), &nobody, false, 0);
                }
            }
        }
        self.faces[before..].sort_by_key(|f| graph.rank(f.face));
        let loose = self.faces.len() - before;
        if loose > 0 && !self.web.reps.is_empty() {
            let said = format!("{loose} faces belong to no shape representation; they stand as they are");
            out.push(Diagnostic::warning("", said));
        }
    }

    fn say(&mut self, what: String, at: u64) {
        self.said.entry(what).or_insert((0, at)).0 += 1;
    }

    /// Whether roots before the ones in hand have placed an item.
    fn placed_before(&self, item: u64) -> bool {
        self.items.get(&item).is_some_and(|round| *round < self.round)
    }

    fn room(&mut self) -> bool {
        self.visits += 1;
        if self.visits > MAX_VISITS || self.faces.len() >= MAX_FACES {
            self.cut_short = true;
        }
        !self.cut_short
    }

    /// Places all representations of a group; with `only_new` items that already have a place are left out.
    fn group(&mut self, group: usize, motion: Option<Motion>, only_new: bool) {
        if !self.room() {
            return;
        }
        if self.path.contains(&group) {
            let by = self.web.reps[group].id;
            self.say("an assembly contains itself; the inner instance is left out".into(), by);
            return;
        }
        if self.path.len() >= MAX_DEPTH {
            let by = self.web.reps[group].id;
            self.say(format!("assemblies nested deeper than {MAX_DEPTH} are left out"), by);
            return;
        }
        self.path.push(group);
        self.number += 1;
        let web = self.web;
        let members = &web.members[group];
        let name = members.iter().find_map(|m| web.products.get(&web.reps[*m].id).cloned());
        self.names.push(name.unwrap_or_else(|| Arc::from("")));
        let path: Arc<[Arc<str>]> = self.names.as_slice().into();
        let first = self.faces.len();
        let mut own = HashSet::new();
        for r in members {
            let rep = &web.reps[*r];
            let motion = match self.path.len() {
                1 if !only_new => self.stand(*r),
                _ => motion,
            };
            for item in &rep.items {
                if !own.insert(*item) || only_new && self.placed_before(*item) {
                    continue;
                }
                // A representation of a tolerance or a datum names faces of the solid: they have their place already.
                let lone_face = web.graph.peek(*item).is_some_and(|i| is_face(&i));
                if only_new && lone_face && self.seen.contains(item) {
                    continue;
                }
                let place = Place {
                    motion,
                    context: rep.context,
                    item: Some(*item),
                    shell: None,
                    path: path.clone(),
                };
                self.item(*item, &place, false, 0);
                if web.graph.peek(*item).is_some_and(|i| i.any(&CONTAINERS).is_some()) {
                    web.graph.get(rep.id);
                }
            }
        }
        // Faces of one place in file order: ids stay what they are when a writer lists shells otherwise.
        let graph = web.graph;
        self.faces[first..].sort_by_key(|f| graph.rank(f.face));
        for r in members {
            for child in &web.children[*r] {
                if self.cut_short {
                    break;
                }
                let (target, only_new) = (web.group[child.rep], only_new);
                match &child.motion {
                    Ok(own) => {
                        let whole = match (own, &motion) {
                            (Some(own), Some(outer)) => Some(own.then(outer)),
                            (own, outer) => own.or(*outer),
                        };
                        self.group(target, whole, only_new);
                    }
                    Err(why) => {
                        self.say(format!("an instance of an assembly is left out: {why}"), child.by);
                    }
                }
            }
        }
        self.path.pop();
        self.names.pop();
    }

    /// The frame that a root representation stands in: a placement among its items that no transformation uses. The
    /// standard gives it no effect; importers in use move the shape there, and so does this one, saying so.
    fn stand(&mut self, r: usize) -> Option<Motion> {
        let rep = &self.web.reps[r];
        let geometry = self.web.geometry(rep.context);
        let free = rep.items.iter().filter(|i| !self.web.anchors.contains(i));
        let frames = free.filter_map(|i| {
            let frame = self.web.graph.peek(*i).filter(|r| r.is("AXIS2_PLACEMENT_3D"))?;
            let frame = geometry.placement(frame.id()).ok()?;
            Motion::between(&Placement::identity(), &frame).map(|m| (*i, m))
        });
        let (id, motion) = frames.last()?;
        let said = format!(
            "the shape of #{} is moved into this frame, as other importers do; the standard does not ask for it",
            rep.id
        );
        self.notes.push(Diagnostic::warning(self.web.graph.place(id), said));
        Some(motion)
    }

    /// Places the faces of a shape item.
    fn item(&mut self, id: u64, place: &Place, turned: bool, depth: usize) {
        let Some(record) = self.web.graph.peek(id) else { return };
        if !self.room() {
            return;
        }
        if depth >= MAX_DEPTH {
            self.say(format!("items nested deeper than {MAX_DEPTH} are left out"), id);
            return;
        }
        if is_face(&record) {
            self.emit(id, turned, place);
            return;
        }
        if let Some((_, args)) =
            record.any(&["ORIENTED_FACE", "ORIENTED_CLOSED_SHELL", "ORIENTED_OPEN_SHELL"])
        {
            self.web.graph.get(id);
            if let Some(inner) = args.references().next() {
                let against = args.iter().find_map(|v| v.flag()) == Some(false);
                self.item(inner, place, turned != against, depth + 1);
            }
            return;
        }
        if let Some(args) = record.part("SOLID_REPLICA") {
            self.web.graph.get(id);
            self.replica(id, [arg(&args, 1).reference(), arg(&args, 2).reference()], place, depth);
            return;
        }
        if record.any(&CONTAINERS).is_some() {
            self.web.graph.get(id);
            self.items.entry(id).or_insert(self.round);
            let free = record.is("GEOMETRIC_SET");
            let inner: Vec<u64> = record.references().collect();
            let shell = record.any(&SHELLS).map(|_| Place { shell: Some(id), ..place.clone() });
            let place = shell.as_ref().unwrap_or(place);
            for r in inner {
                let bounded = free && self.web.graph.peek(r).is_some_and(|s| s.any(&BOUNDED).is_some());
                if bounded {
                    self.emit(r, turned, place);
                } else {
                    self.item(r, place, turned, depth + 1);
                }
            }
        }
    }

    /// A solid at another place of the same representation.
    fn replica(&mut self, id: u64, parts: [Option<u64>; 2], place: &Place, depth: usize) {
        let [Some(solid), Some(operator)] = parts else { return };
        let motion = match self.web.graph.get(operator) {
            Some(r) => self.web.geometry(place.context).operator(&r),
            None => Err(format!("#{operator} is not defined")),
        };
        match motion {
            Ok(own) => {
                let motion = Some(place.motion.as_ref().map_or(own, |outer| own.then(outer)));
                self.item(solid, &Place { motion, ..place.clone() }, false, depth + 1);
            }
            Err(why) => self.say(format!("a SOLID_REPLICA is left out: {why}"), id),
        }
    }

    fn emit(&mut self, face: u64, turned: bool, place: &Place) {
        self.seen.insert(face);
        self.faces.push(Occurrence {
            face,
            turned,
            motion: place.motion,
            place: self.number,
            context: place.context,
            // What belongs to no representation is its own item.
            item: place.item.or(place.shell),
            shell: place.shell,
            path: place.path.clone(),
        });
    }
}
