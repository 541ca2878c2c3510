//! Bodies and layers of the faces that an import gives.

use super::graph::{Graph, arg};
use super::walk::Occurrence;
use crate::structure::{Body, BodyKind, Layer, Shell, Structure};
use std::collections::HashMap;

/// Items that enclose material.
const SOLIDS: [&str; 5] =
    ["MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "FACETED_BREP", "NON_MANIFOLD_SOLID_BREP", "SHELLED_SOLID"];

/// Items that are sets of faces.
const SETS: [&str; 2] = ["GEOMETRIC_SET", "GEOMETRIC_CURVE_SET"];

/// The structure of faces with their ids, in the order of the part.
pub(crate) fn structure<'o>(
    graph: &Graph<'_>,
    faces: impl Iterator<Item = (&'o Occurrence, &'o str)>,
) -> Structure {
    let mut out = Structure::default();
    let mut bodies: HashMap<(usize, u64), usize> = HashMap::new();
    let mut shells: HashMap<(usize, u64), usize> = HashMap::new();
    let layers = layers(graph);
    let mut of_layer: Vec<Vec<String>> = vec![Vec::new(); layers.names.len()];
    for (o, id) in faces {
        let items = [Some(o.face), o.shell, o.item];
        let mut on: Vec<usize> =
            items.iter().flatten().filter_map(|i| layers.of.get(i)).flatten().copied().collect();
        on.sort_unstable();
        on.dedup();
        on.into_iter().for_each(|k| of_layer[k].push(id.to_owned()));
        // A face that is an item by itself is no body.
        let Some(item) = o.item.filter(|i| *i != o.face) else { continue };
        let body = *bodies.entry((o.place, item)).or_insert_with(|| {
            out.bodies.push(Body {
                id: format!("B{}", out.bodies.len() + 1),
                entity: item,
                name: name(graph, item),
                kind: kind(graph, item),
                path: o.path.iter().filter(|name| !name.is_empty()).map(ToString::to_string).collect(),
                shells: Vec::new(),
            });
            out.bodies.len() - 1
        });
        let own = &mut out.bodies[body].shells;
        let shell = o.shell.unwrap_or(item);
        let k = *shells.entry((body, shell)).or_insert_with(|| {
            own.push(Shell {
                entity: shell,
                name: name(graph, shell),
                closed: graph.peek(shell).is_some_and(|r| r.is("CLOSED_SHELL")),
                faces: Vec::new(),
            });
            own.len() - 1
        });
        own[k].faces.push(id.to_owned());
    }
    let named = layers.names.into_iter().zip(of_layer).filter(|l| !l.1.is_empty());
    out.layers = named.map(|(name, faces)| Layer { name, faces }).collect();
    out
}

fn kind(graph: &Graph<'_>, item: u64) -> BodyKind {
    match graph.peek(item) {
        Some(r) if r.any(&SOLIDS).is_some() => BodyKind::Solid,
        Some(r) if r.any(&SETS).is_some() => BodyKind::Set,
        _ => BodyKind::Surfaces,
    }
}

/// The name of a representation item: its first word.
fn name(graph: &Graph<'_>, item: u64) -> String {
    let Some(record) = graph.peek(item) else { return String::new() };
    let args = record.part("REPRESENTATION_ITEM").or_else(|| record.all_args().next());
    args.map_or_else(String::new, |a| arg(&a, 0).text())
}

struct Layers {
    names: Vec<String>,
    /// The layers of faces, shells and items.
    of: HashMap<u64, Vec<usize>>,
}

/// Layers with what is assigned to them; several assignments to one name are one layer.
fn layers(graph: &Graph<'_>) -> Layers {
    let mut out = Layers { names: Vec::new(), of: HashMap::new() };
    let mut known: HashMap<String, usize> = HashMap::new();
    for record in graph.structure() {
        let Some(args) = record.part("PRESENTATION_LAYER_ASSIGNMENT") else { continue };
        graph.get(record.id());
        let name = arg(&args, 0).text();
        let k = *known.entry(name).or_insert_with_key(|name| {
            out.names.push(name.clone());
            out.names.len() - 1
        });
        for item in arg(&args, 2).list().references() {
            out.of.entry(item).or_default().push(k);
            // What is styled is meant.
            let styled =
                graph.peek(item).and_then(|r| Some(r.any(&["STYLED_ITEM", "OVER_RIDING_STYLED_ITEM"])?.1));
            if let Some(of) = styled.and_then(|a| arg(&a, 2).reference()) {
                out.of.entry(of).or_default().push(k);
            }
        }
    }
    out
}
