//! What a file has and the part has not: instances that no face, unit, name or colour led to, by keyword.

use super::graph::{Graph, Record};
use crate::leftovers::Leftovers;
use std::collections::HashMap;

/// Counts the records that were not asked for.
pub(crate) fn leftovers(graph: &Graph<'_>, left: &mut Leftovers) {
    // Parameter curves consist of points and lines that would read like lost geometry.
    let mut curves: HashMap<u64, ()> = HashMap::new();
    for record in graph.unused().filter(|r| r.is("PCURVE") || r.is("DEGENERATE_PCURVE")) {
        let mut stack: Vec<u64> = vec![record.id()];
        while let Some(id) = stack.pop() {
            let Some(r) = graph.peek(id) else { continue };
            if graph.is_unused(id) && curves.insert(id, ()).is_none() {
                stack.extend(r.references());
            }
        }
    }
    let mut counts: HashMap<(String, &'static str), (usize, Vec<usize>)> = HashMap::new();
    let mut order = Vec::new();
    for record in graph.unused() {
        let kind = record.kind();
        let why = if curves.contains_key(&record.id()) { PARAMETER } else { reason(&record, &kind) };
        let key = (kind, why);
        if let Some(entry) = counts.get_mut(&key) {
            entry.0 += 1;
            if entry.1.len() < Leftovers::LINES {
                entry.1.push(graph.line(record.at()));
            }
        } else {
            order.push(key.clone());
            counts.insert(key, (1, vec![graph.line(record.at())]));
        }
    }
    for key in order {
        if let Some((count, lines)) = counts.remove(&key) {
            left.add_lines(&key.0, count, key.1, &lines);
        }
    }
}

const PARAMETER: &str = "a parameter curve: the space curve is the definition";

/// Why records of a kind are of no use here.
fn reason(record: &Record<'_>, kind: &str) -> &'static str {
    const REASONS: [(&[&str], &str); 8] = [
        (
            &["TESSELLAT", "TRIANGULATED", "COORDINATES_LIST"],
            "tessellated geometry: faces come from exact surfaces",
        ),
        (
            &[
                "DIMENSION",
                "TOLERANCE",
                "DATUM",
                "ANNOTATION",
                "DRAUGHTING",
                "CALLOUT",
                "LEADER",
                "SHAPE_ASPECT",
            ],
            "dimensions, tolerances and notes",
        ),
        (
            &[
                "STYLE",
                "COLOUR",
                "COLOR",
                "PRESENTATION",
                "LAYER",
                "CAMERA",
                "VIEW",
                "INVISIBILITY",
                "TEXT",
                "FONT",
            ],
            "presentation that gives no face a colour",
        ),
        (
            &[
                "BOOLEAN",
                "CSG",
                "SWEPT_AREA",
                "SWEPT_FACE",
                "EXTRUDED",
                "REVOLVED",
                "BLOCK",
                "WEDGE",
                "HALF_SPACE",
            ],
            "a solid without boundary faces",
        ),
        (
            &[
                "PRODUCT",
                "APPLICATION",
                "ORGANIZATION",
                "PERSON",
                "DATE",
                "TIME",
                "APPROVAL",
                "SECURITY",
                "DOCUMENT",
                "CONTRACT",
                "CERTIFICATION",
                "CHANGE",
                "ACTION",
                "IDENTIFICATION",
                "EFFECTIVITY",
                "CONFIGURATION",
                "NEXT_ASSEMBLY",
                "USAGE",
                "EXTERNAL",
            ],
            "administrative data",
        ),
        (
            &[
                "PROPERTY",
                "MEASURE",
                "MATERIAL",
                "DESCRIPTIVE",
                "GROUP",
                "UNIT",
                "DIMENSIONAL_EXPONENTS",
                "CONTEXT",
            ],
            "properties and units of no face",
        ),
        (&["KINEMATIC", "MECHANISM", "JOINT"], "kinematics"),
        (&["REPRESENTATION"], "a representation without faces"),
    ];
    if kind.starts_with('!') {
        return "a user-defined entity";
    }
    if kind.starts_with("IFC") {
        return "a building model, which is not read; export AP203, AP214 or AP242";
    }
    if record.is("FACE") {
        return "a face without surface";
    }
    // Words of the keyword, or their beginnings: a CONTEXT is no TEXT.
    let begins =
        |w: &str| kind.match_indices(w).any(|(k, _)| k == 0 || matches!(kind.as_bytes()[k - 1], b'_' | b'+'));
    let found = REASONS.iter().find(|(words, _)| words.iter().any(|w| begins(w)));
    found.map_or("no face refers to it", |(_, why)| why)
}
