//! Faces of a part that lie in the material of its other bodies: neither to be machined nor looked at.

use crate::part::loaded::{InBodies, Loaded, LoadedFace};
use crate::words::{self, number};
use osculate_geom::Diagnostic;
use osculate_surfaces::hidden::{Hidden, HiddenFace, hidden};
use osculate_surfaces::{Face, TrimmedSurface};
use std::sync::Arc;

/// Ids that a message lists at most.
const LISTED: usize = 12;

/// What of the faces other bodies hide, what is to say of it, and the surfaces that are left of them.
pub struct Found {
    /// Faces of which something is hidden.
    pub faces: Vec<InBodies>,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
    left: Vec<(usize, Option<Arc<TrimmedSurface>>)>,
}

/// What other bodies hide of the faces of a part as they are turned now. `known` says for which faces by number the outer side
/// is known.
pub fn find(part: &Loaded, known: &dyn Fn(usize) -> bool) -> Found {
    let shape = |f: &LoadedFace| {
        f.source.as_deref().map(|source| Face { surface: f.surface.clone(), ..source.clone() })
    };
    let shapes: Option<Vec<Face>> = part.faces.iter().map(shape).collect();
    let Some(shapes) = shapes else {
        return Found { faces: Vec::new(), diagnostics: Vec::new(), left: Vec::new() };
    };
    let known: Vec<bool> = (0..shapes.len()).map(known).collect();
    let found = hidden(&shapes.iter().collect::<Vec<_>>(), &known, part.uncertainty_mm);
    told(part, found)
}

fn told(part: &Loaded, found: Hidden) -> Found {
    let of = |f: &HiddenFace| InBodies {
        id: part.faces[f.face].id.clone(),
        hidden_mm2: f.hidden_mm2,
        wholly: f.visible.is_none(),
        bodies: f.within.iter().map(|b| body(part, b)).collect(),
    };
    let faces: Vec<InBodies> = found.faces.iter().map(of).collect();
    let mut diagnostics = Vec::new();
    if !faces.is_empty() {
        let ids: Vec<&str> = faces.iter().map(|f| f.id.as_str()).collect();
        let place = words::listed(&ids, LISTED);
        let area_mm2: f64 = faces.iter().map(|f| f.hidden_mm2).sum();
        let text = format!(
            "{} mm2 of these faces lie in the material of other bodies: they are neither machined nor counted as uncut",
            number(area_mm2, 5)
        );
        diagnostics.push(Diagnostic::note(place, text));
    }
    for u in &found.unknown {
        let [a, b] = u.faces.map(|f| part.faces[f].id.as_str());
        let text =
            format!("what of {a} lies in the body of {b} is not found: {}; {a} counts as a whole", u.why);
        diagnostics.push(Diagnostic::warning(format!("{a} and {b}"), text));
    }
    let left = found.faces.into_iter().map(|f| (f.face, f.visible)).collect();
    Found { faces, diagnostics, left }
}

/// A body by its faces: those that follow each other as a range.
fn body(part: &Loaded, faces: &[usize]) -> String {
    let id = |k: usize| part.faces[k].id.as_str();
    let runs: Vec<String> = faces
        .chunk_by(|a, b| a + 1 == *b)
        .filter_map(|run| match run {
            [] => None,
            [one] => Some(id(*one).to_owned()),
            [first, .., last] => Some(format!("{} to {}", id(*first), id(*last))),
        })
        .collect();
    words::listed(&runs, LISTED)
}

/// Leaves of the faces of a part what no other body hides; those that are hidden wholly go.
pub(super) fn hide(part: &mut Loaded, open: &[usize]) {
    let found = find(part, &|k| !open.contains(&k));
    for (k, left) in &found.left {
        if let Some(left) = left {
            part.faces[*k].surface = left.clone();
        }
    }
    let gone = |k: usize| found.left.iter().any(|(j, left)| *j == k && left.is_none());
    let mut number = 0;
    part.faces.retain(|_| {
        number += 1;
        !gone(number - 1)
    });
    part.hidden = found.faces;
    part.diagnostics.extend(found.diagnostics);
}
