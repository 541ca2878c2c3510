//! Colours of faces and shape items: STYLED_ITEM down to an RGB or named colour.

use super::graph::{Graph, arg};
use crate::part::Colour;
use std::collections::HashMap;

/// References followed from a style to its colour at most: writers use six or seven.
const MAX_CHAIN: usize = 16;

/// Colours by the number of the styled item.
pub(crate) fn colours(graph: &Graph<'_>) -> HashMap<u64, Colour> {
    let (mut found, mut known) = (HashMap::new(), HashMap::new());
    for record in graph.structure() {
        let Some((_, args)) = record.any(&["STYLED_ITEM", "OVER_RIDING_STYLED_ITEM"]) else { continue };
        // Complex records leave the name to REPRESENTATION_ITEM: (styles, item) at the beginning or behind a name.
        let from = usize::from(args.len() > 2);
        let Some(item) = arg(&args, from + 1).reference() else { continue };
        let mut styles = arg(&args, from).list().references();
        if let Some(colour) = styles.find_map(|s| colour(graph, s, 0, &mut known)) {
            graph.get(record.id());
            found.insert(item, colour);
        }
    }
    found
}

/// The first surface colour that a style leads to. What is known of a record is not looked for again: styles may share
/// their parts any number of times.
fn colour(
    graph: &Graph<'_>,
    id: u64,
    depth: usize,
    known: &mut HashMap<u64, Option<Colour>>,
) -> Option<Colour> {
    if let Some(found) = known.get(&id) {
        return *found;
    }
    if depth >= MAX_CHAIN {
        return None;
    }
    // A style that leads to itself has no colour there.
    known.insert(id, None);
    let record = graph.peek(id)?;
    let found = if let Some(args) = record.part("COLOUR_RGB") {
        let c = [1, 2, 3].map(|k| arg(&args, k).number().unwrap_or(0.0).clamp(0.0, 1.0));
        Some(Colour { red: c[0], green: c[1], blue: c[2] })
    } else if let Some((_, args)) = record.any(&["DRAUGHTING_PRE_DEFINED_COLOUR", "PRE_DEFINED_COLOUR"]) {
        named(&arg(&args, 0).text())
    } else if record.is("CURVE_STYLE") || record.is("POINT_STYLE") {
        None
    } else {
        record.references().take(64).find_map(|r| colour(graph, r, depth + 1, known))
    };
    known.insert(id, found);
    found.inspect(|_| {
        graph.get(id);
    })
}

/// The colours of ISO 10303-46, draughting_pre_defined_colour.
fn named(name: &str) -> Option<Colour> {
    let (red, green, blue) = match name.to_ascii_lowercase().as_str() {
        "red" => (1.0, 0.0, 0.0),
        "green" => (0.0, 1.0, 0.0),
        "blue" => (0.0, 0.0, 1.0),
        "yellow" => (1.0, 1.0, 0.0),
        "magenta" => (1.0, 0.0, 1.0),
        "cyan" => (0.0, 1.0, 1.0),
        "black" => (0.0, 0.0, 0.0),
        "white" => (1.0, 1.0, 1.0),
        _ => return None,
    };
    Some(Colour { red, green, blue })
}
