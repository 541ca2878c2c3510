//! How the representations of a file hang together: one frame, or one inside another.
//!
//! A representation is a list of items in a context of units. Relations without transformation put two of them into
//! one frame; relations with one (the component is the first representation, unless the product structure says
//! otherwise) and mapped items place one inside another. What is placed nowhere is a root.
//!
//! Motions: a point of the component at item 1 comes to item 2 ([ISO 10303-43, item_defined_transformation]; mapped
//! items from the map's origin to the target).

use super::geometry::Geometry;
use super::graph::{Graph, Record, arg};
use super::units::Contexts;
use crate::trim::motion::Motion;
use osculate_geom::analytic::Placement;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Keywords of faces with a surface.
pub(super) const FACES: [&str; 2] = ["ADVANCED_FACE", "FACE_SURFACE"];

/// Whether a record is a face with a surface.
pub(crate) fn is_face(record: &Record<'_>) -> bool {
    record.any(&FACES).is_some()
}

/// A representation.
pub(super) struct Rep {
    pub(super) id: u64,
    pub(super) items: Vec<u64>,
    pub(super) context: Option<usize>,
}

/// One representation inside another.
pub(super) struct Child {
    pub(super) rep: usize,
    pub(super) motion: Result<Option<Motion>, String>,
    /// The record that places it.
    pub(super) by: u64,
}

/// All representations and how they hang together.
pub(super) struct Web<'g> {
    pub(super) graph: &'g Graph<'g>,
    pub(super) contexts: &'g Contexts,
    pub(super) reps: Vec<Rep>,
    pub(super) by_id: HashMap<u64, usize>,
    /// Representative of the group that a representation shares its frame with.
    pub(super) group: Vec<usize>,
    /// Members of each group, at its representative.
    pub(super) members: Vec<Vec<usize>>,
    pub(super) children: Vec<Vec<Child>>,
    /// Representations that are placed in another one.
    pub(super) placed: Vec<bool>,
    /// Product names by representation.
    pub(super) products: HashMap<u64, Arc<str>>,
    /// Placements that transformations refer to.
    pub(super) anchors: HashSet<u64>,
}

impl<'g> Web<'g> {
    pub(super) fn read(graph: &'g Graph<'g>, contexts: &'g Contexts) -> Self {
        let mut web = Self {
            graph,
            contexts,
            reps: Vec::new(),
            by_id: HashMap::new(),
            group: Vec::new(),
            members: Vec::new(),
            children: Vec::new(),
            placed: Vec::new(),
            products: HashMap::new(),
            anchors: HashSet::new(),
        };
        let mut relations = Vec::new();
        let mut definitions = Vec::new();
        let mut uses: HashMap<u64, u64> = HashMap::new();
        for record in graph.structure() {
            if record.part_ending("REPRESENTATION_RELATIONSHIP").is_some()
                || record.part_ending("RELATIONSHIP_WITH_TRANSFORMATION").is_some()
            {
                relations.push(record);
                continue;
            }
            if record.is("ITEM_DEFINED_TRANSFORMATION") {
                web.anchors.extend(record.references());
                continue;
            }
            let Some(args) = record.part_ending("REPRESENTATION") else { continue };
            if record.is("SHAPE_DEFINITION_REPRESENTATION") {
                definitions.push(record);
            } else if let Some(args) = record.part("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION") {
                if let (Some(relation), Some(shape)) = (arg(&args, 0).reference(), arg(&args, 1).reference())
                {
                    uses.insert(relation, shape);
                }
            } else if args.len() >= 3 || record.part("REPRESENTATION").is_some() {
                // In a complex record the items stand in the most general part.
                let args = record.part("REPRESENTATION").unwrap_or(args);
                let context = arg(&args, 2).reference().and_then(|c| contexts.index(c));
                web.by_id.insert(record.id(), web.reps.len());
                web.reps.push(Rep {
                    id: record.id(),
                    items: arg(&args, 1).list().references().collect(),
                    context,
                });
            }
        }
        let n = web.reps.len();
        web.group = (0..n).collect();
        web.children.resize_with(n, Vec::new);
        web.placed = vec![false; n];
        let owners = web.read_products(&definitions);
        for relation in relations {
            web.read_relation(&relation, &uses, &owners);
        }
        web.members = vec![Vec::new(); n];
        for r in 0..n {
            web.group[r] = web.representative(r);
            let g = web.group[r];
            web.members[g].push(r);
        }
        web.read_maps();
        web
    }

    fn representative(&mut self, mut r: usize) -> usize {
        while self.group[r] != r {
            // Every second step is taken out of the way, so that long chains are walked once.
            self.group[r] = self.group[self.group[r]];
            r = self.group[r];
        }
        r
    }

    /// Names the products, and tells which product definition a representation belongs to.
    fn read_products(&mut self, definitions: &[Record<'_>]) -> HashMap<u64, u64> {
        let mut owners = HashMap::new();
        for record in definitions {
            let Some(args) = record.part("SHAPE_DEFINITION_REPRESENTATION") else { continue };
            let (Some(shape), Some(rep)) = (arg(&args, 0).reference(), arg(&args, 1).reference()) else {
                continue;
            };
            self.graph.get(record.id());
            let definition = self.graph.get(shape).and_then(|s| {
                let args = s.part("PRODUCT_DEFINITION_SHAPE").or_else(|| s.part("PROPERTY_DEFINITION"))?;
                arg(&args, 2).reference()
            });
            // A shape aspect points at a part of a shape that a product has elsewhere.
            let is_product =
                |d: &u64| self.graph.peek(*d).is_some_and(|r| r.kind().contains("PRODUCT_DEFINITION"));
            let Some(definition) = definition.filter(is_product) else { continue };
            owners.insert(rep, definition);
            self.products.entry(rep).or_insert_with(|| Arc::from(product_name(self.graph, definition)));
        }
        owners
    }

    /// A relation of two representations, with or without a transformation.
    fn read_relation(&mut self, record: &Record<'_>, uses: &HashMap<u64, u64>, owners: &HashMap<u64, u64>) {
        let with = record.part_ending("RELATIONSHIP_WITH_TRANSFORMATION");
        let all = [
            record.part("REPRESENTATION_RELATIONSHIP"),
            record.part("SHAPE_REPRESENTATION_RELATIONSHIP"),
            with,
            record.part_ending("REPRESENTATION_RELATIONSHIP"),
        ];
        let Some(args) = all.into_iter().flatten().find(|a| a.len() >= 4) else { return };
        let rep = |k| arg(&args, k).reference().and_then(|r| self.by_id.get(&r).copied());
        let (Some(a), Some(b)) = (rep(2), rep(3)) else { return };
        self.graph.get(record.id());
        let Some(with) = with else {
            let (a, b) = (self.representative(a), self.representative(b));
            self.group[a.max(b)] = a.min(b);
            return;
        };
        let reversed = uses.get(&record.id()).is_some_and(|shape| self.reversed(*shape, [a, b], owners));
        let Some(operator) = arg(&with, with.len() - 1).reference() else { return };
        let motion = self
            .transformation(operator, [a, b])
            .map(|m| m.and_then(|m| if reversed { m.inverse() } else { Some(m) }));
        let (child, parent) = if reversed { (b, a) } else { (a, b) };
        self.placed[child] = true;
        self.children[parent].push(Child { rep: child, motion, by: record.id() });
    }

    /// Whether the product structure has the first representation as the assembly.
    fn reversed(&self, shape: u64, reps: [usize; 2], owners: &HashMap<u64, u64>) -> bool {
        let usage = self.graph.get(shape).and_then(|s| {
            let args = s.part("PRODUCT_DEFINITION_SHAPE").or_else(|| s.part("PROPERTY_DEFINITION"))?;
            self.graph.get(arg(&args, 2).reference()?)
        });
        let Some(args) = usage.and_then(|u| u.any(&USAGES)).map(|u| u.1) else { return false };
        let owner = |r: usize| owners.get(&self.reps[r].id).copied();
        let (whole, part) = (arg(&args, 3).reference(), arg(&args, 4).reference());
        whole.is_some() && owner(reps[0]) == whole && owner(reps[1]) == part && whole != part
    }

    /// The motion of an operator between two representations.
    fn transformation(&self, id: u64, reps: [usize; 2]) -> Result<Option<Motion>, String> {
        let record = self.graph.get(id).ok_or_else(|| format!("#{id} is not defined"))?;
        let Some(args) = record.part("ITEM_DEFINED_TRANSFORMATION") else {
            return self.geometry(self.reps[reps[1]].context).operator(&record).map(Some);
        };
        let frame = |k: usize| {
            let item = arg(&args, k).reference().ok_or_else(|| "a transformation without item".to_owned())?;
            self.geometry(self.reps[reps[k - 2]].context).placement(item).map_err(|e| e.to_string())
        };
        Ok(Motion::between(&frame(2)?, &frame(3)?))
    }

    pub(super) fn geometry(&self, context: Option<usize>) -> Geometry<'g> {
        Geometry::new(self.graph, self.contexts.units(context))
    }

    /// Mapped items among the items: which representations they place.
    fn read_maps(&mut self) {
        for r in 0..self.reps.len() {
            let mut found = Vec::new();
            for item in &self.reps[r].items {
                let Some(args) = self.graph.peek(*item).and_then(|i| i.part("MAPPED_ITEM")) else { continue };
                self.graph.get(*item);
                let source = arg(&args, 1).reference().and_then(|m| self.graph.get(m));
                let Some(map) = source.and_then(|m| m.part("REPRESENTATION_MAP")) else { continue };
                let Some(rep) = arg(&map, 1).reference().and_then(|r| self.by_id.get(&r).copied()) else {
                    continue;
                };
                let motion = self.map_motion([arg(&map, 0).reference(), arg(&args, 2).reference()], [rep, r]);
                found.push(Child { rep, motion, by: *item });
            }
            for child in found {
                self.placed[child.rep] = true;
                self.children[r].push(child);
            }
        }
    }

    /// From the origin of a map to the target of a mapped item.
    fn map_motion(&self, items: [Option<u64>; 2], reps: [usize; 2]) -> Result<Option<Motion>, String> {
        let [origin, target] = items;
        let (Some(origin), Some(target)) = (origin, target) else { return Err("a map without ends".into()) };
        let from = self
            .geometry(self.reps[reps[0]].context)
            .placement(origin)
            .map_err(|e| format!("the map's origin: {e}"))?;
        let record = self.graph.get(target).ok_or_else(|| format!("#{target} is not defined"))?;
        let context = self.reps[reps[1]].context;
        if record.part_ending("TRANSFORMATION_OPERATOR_3D").is_some()
            || record.is("CARTESIAN_TRANSFORMATION_OPERATOR")
        {
            let base = Motion::between(&from, &Placement::identity()).unwrap_or_else(Motion::identity);
            return Ok(Some(base.then(&self.geometry(context).operator(&record)?)));
        }
        let to = self.geometry(context).placement(target).map_err(|e| e.to_string())?;
        Ok(Motion::between(&from, &to))
    }
}

/// Relations of a whole to its part.
const USAGES: [&str; 6] = [
    "NEXT_ASSEMBLY_USAGE_OCCURRENCE",
    "ASSEMBLY_COMPONENT_USAGE",
    "QUANTIFIED_ASSEMBLY_COMPONENT_USAGE",
    "PROMISSORY_USAGE_OCCURRENCE",
    "SPECIFIED_HIGHER_USAGE_OCCURRENCE",
    "PRODUCT_DEFINITION_USAGE",
];

/// The name of a product definition's product; its id where it has no name.
fn product_name(graph: &Graph<'_>, definition: u64) -> String {
    let follow = |id: u64, k: usize| {
        let record = graph.get(id)?;
        let args = record.all_args().find(|a| a.len() > k)?;
        arg(&args, k).reference().and_then(|to| graph.get(to))
    };
    let formation = follow(definition, 2);
    let product = formation.and_then(|f| follow(f.id(), 2)).and_then(|p| p.part("PRODUCT"));
    let Some(args) = product else { return String::new() };
    let name = arg(&args, 1).text();
    if name.is_empty() { arg(&args, 0).text() } else { name }
}
