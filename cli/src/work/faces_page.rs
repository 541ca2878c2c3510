//! A page that shows the faces of a part with their ids, coloured by group.

use crate::report::measured::mesh_of;
use crate::report::{self, Column, Report, Scalar, Table};
use crate::words::{self, number};
use crate::work::init::{Grouped, name};

/// Triangles over all faces, about.
const TRIANGLES: f64 = 60_000.0;
/// Ids that a row lists at most.
const LISTED: usize = 24;

/// The page: a complete HTML document.
#[must_use]
pub fn page(grouped: &Grouped, title: &str) -> String {
    let area: f64 = grouped.part.faces.iter().map(crate::part::area).sum();
    let edge_mm = (2.0 * area / TRIANGLES).sqrt().max(1e-6);
    let mut group = vec![f32::NAN; grouped.part.faces.len()];
    for (k, g) in grouped.groups.iter().enumerate() {
        g.faces.iter().for_each(|f| group[*f] = (k + 1) as f32);
    }
    let faces = grouped.part.faces.iter().zip(&group).map(|(face, group)| {
        let mut mesh = mesh_of(face, edge_mm);
        mesh.scalars = vec![vec![*group; mesh.positions.len()]];
        mesh
    });
    let report = Report {
        title: format!("{title}: faces"),
        subtitle: format!("{} faces in {} groups", grouped.part.faces.len(), grouped.groups.len()),
        faces_only: true,
        faces: faces.collect(),
        scalars: vec![Scalar { name: "Group".to_owned(), unit: String::new() }],
        tables: vec![groups(grouped)],
        ..Report::default()
    };
    report::html(&report)
}

/// The groups with what they look like and which faces are in them.
fn groups(grouped: &Grouped) -> Table {
    let column = |name: &str, unit: &str| Column { name: name.to_owned(), unit: unit.to_owned() };
    let row = |k: usize| {
        let (g, ids) = (&grouped.groups[k], grouped.ids(k));
        let hollow = if g.hollow_mm.is_finite() { number(g.hollow_mm, 3) } else { "\u{2013}".to_owned() };
        vec![
            name(k),
            g.look.to_string(),
            number(g.area_mm2, 5),
            hollow,
            g.alike.to_string(),
            words::listed(&ids, LISTED),
        ]
    };
    Table {
        caption: "Groups".to_owned(),
        columns: vec![
            column("group", ""),
            column("looks", ""),
            column("area", "mm2"),
            column("smallest radius inwards", "mm"),
            column("alike", ""),
            column("faces", ""),
        ],
        rows: (0..grouped.groups.len()).map(row).collect(),
    }
}
