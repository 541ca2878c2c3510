//! Groups of faces and how neighbours meet, as `inspect` tells them.

use osculate::words::{self, Table, number};
use osculate::work::init::{Grouped, name};
use osculate_geom::Box3;
use serde::Serialize;

/// Ids that a line lists at most.
const LISTED: usize = 16;
/// Meetings that are printed at most; JSON has all of them.
const MEETINGS: usize = 30;

/// Faces that look alike and go on smoothly into each other.
#[derive(Serialize)]
pub struct GroupRow {
    id: String,
    /// `formed`, `flat`, `round`, `fillet` or `hole`.
    look: String,
    faces: Vec<String>,
    area_mm2: f64,
    /// The smallest radius inwards; absent where it is nowhere hollow.
    hollow_radius_mm: Option<f64>,
    /// Groups of the part that are like it, itself counted.
    alike: usize,
    /// Lower corner and upper corner.
    bbox_mm: Vec<f64>,
}

/// Two faces with a common edge.
#[derive(Serialize)]
pub struct Neighbours {
    faces: [String; 2],
    length_mm: f64,
    /// Positive at outer edges.
    bend_deg: f64,
    smooth: bool,
}

/// The groups of a part, largest first.
pub fn groups(grouped: &Grouped) -> Vec<GroupRow> {
    let row = |(k, g): (usize, &osculate_surfaces::groups::FaceGroup)| {
        let bounds = g
            .faces
            .iter()
            .fold(Box3::empty(), |b, f| b.union(&osculate::part::bounds(&grouped.part.faces[*f])));
        GroupRow {
            id: name(k),
            look: g.look.to_string(),
            faces: grouped.ids(k).into_iter().map(str::to_owned).collect(),
            area_mm2: g.area_mm2,
            hollow_radius_mm: g.hollow_mm.is_finite().then_some(g.hollow_mm),
            alike: g.alike,
            bbox_mm: if bounds.is_empty() {
                Vec::new()
            } else {
                bounds.min.iter().chain(bounds.max.iter()).copied().collect()
            },
        }
    };
    grouped.groups.iter().enumerate().map(row).collect()
}

/// How the faces of a part meet.
pub fn neighbours(grouped: &Grouped) -> Vec<Neighbours> {
    let id = |k: usize| grouped.part.faces[k].id.clone();
    grouped
        .meetings
        .iter()
        .map(|m| Neighbours {
            faces: m.faces.map(id),
            length_mm: m.length_mm,
            bend_deg: m.bend_rad.to_degrees(),
            smooth: m.smooth,
        })
        .collect()
}

/// Both as tables; nothing where they were not asked for.
pub fn describe(groups: &Option<Vec<GroupRow>>, neighbours: &Option<Vec<Neighbours>>) -> String {
    let (Some(groups), Some(neighbours)) = (groups, neighbours) else { return String::new() };
    let mut t = Table::left(["group", "looks", "area mm2", "inner radius mm", "alike", "faces"]);
    for g in groups {
        t.row([
            g.id.clone(),
            g.look.clone(),
            number(g.area_mm2, 5),
            g.hollow_radius_mm.map_or_else(|| "-".to_owned(), |r| number(r, 3)),
            g.alike.to_string(),
            words::listed(&g.faces, LISTED),
        ]);
    }
    let mut out = format!("{}\n", t.render());
    let mut t = Table::left(["faces", "edge mm", "bend deg", "meet"]);
    for n in neighbours.iter().take(MEETINGS) {
        let how = match (n.smooth, n.bend_deg > 0.0) {
            (true, _) => "smoothly",
            (false, true) => "in an outer edge",
            (false, false) => "in an inner edge",
        };
        t.row([n.faces.join(" "), number(n.length_mm, 4), number(n.bend_deg, 3), how.to_owned()]);
    }
    out.push_str(&t.render());
    if neighbours.len() > MEETINGS {
        out.push_str(&format!("  and {} more (--json has all)\n", neighbours.len() - MEETINGS));
    }
    out + "\n"
}
