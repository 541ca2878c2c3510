//! Which uses are one edge, and which ends are one vertex.

use super::chart::Chart;
use super::local::{self, LocalEdge};
use super::shared::{Edge, EdgeUse, FaceEdges, Topology};
use crate::part::Face;
use osculate_geom::{Box3, Point3};
use std::collections::{BTreeMap, HashMap};

/// Distance within which edges without a common identity are the same, as a part of the part's size: the sparest
/// writers keep five digits of it.
pub(crate) const JOIN: f64 = 1e-5;

/// An edge below this part of the whole size is a point.
const POINT: f64 = 1e-9;

/// Lengths of two uses of one edge agree to this fraction: they are summed over chords.
const SAME_LENGTH: f64 = 1e-2;

/// Numbers that are joined to classes.
struct Classes(Vec<usize>);

impl Classes {
    fn find(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        // The smaller number stays, so that the result does not depend on the order of joins.
        self.0[a.max(b)] = a.min(b);
    }
}

/// Whether two uses follow one way within `slack`, and if so whether in the same sense.
fn same(a: &LocalEdge, b: &LocalEdge, slack: f64) -> Option<bool> {
    let near = |p: &Point3, q: &Point3| (p - q).norm() <= slack;
    if !near(&a.middles[1], &b.middles[1])
        || (a.length_mm - b.length_mm).abs() > SAME_LENGTH * a.length_mm + slack
    {
        return None;
    }
    let forward = near(&a.ends[0], &b.ends[0])
        && near(&a.ends[1], &b.ends[1])
        && near(&a.middles[0], &b.middles[0])
        && near(&a.middles[2], &b.middles[2]);
    let backward = near(&a.ends[0], &b.ends[1])
        && near(&a.ends[1], &b.ends[0])
        && near(&a.middles[0], &b.middles[2])
        && near(&a.middles[2], &b.middles[0]);
    match (forward, backward) {
        // So short that the slack hides the sense: ends decide.
        (true, true) => Some((a.ends[0] - b.ends[0]).norm() <= (a.ends[0] - b.ends[1]).norm()),
        (true, false) => Some(true),
        (false, true) => Some(false),
        (false, false) => None,
    }
}

/// A group of uses: the first one, and every further one with its sense relative to the first.
struct Group {
    members: Vec<(usize, bool)>,
}

impl Topology {
    /// Finds the shared edges. `join_mm` is the distance within which edges without a common identity are the same.
    pub(crate) fn new(faces: &[Face], join_mm: Option<f64>) -> Self {
        let made: Vec<(Chart, Vec<LocalEdge>)> = faces
            .iter()
            .map(|f| {
                let chart = Chart::new(f);
                let local = local::edges(f, &chart);
                (chart, local)
            })
            .collect();
        let mut all = Box3::empty();
        for e in made.iter().flat_map(|m| &m.1) {
            e.ends.iter().chain(&e.middles).for_each(|p| all.add(p));
        }
        let size_mm = made.iter().map(|m| m.0.size_mm).fold(all.diagonal_mm().max(0.0), f64::max);
        let join_mm = join_mm.unwrap_or(JOIN * size_mm);
        build(made, size_mm, join_mm)
    }
}

pub(crate) fn build(made: Vec<(Chart, Vec<LocalEdge>)>, size_mm: f64, join_mm: f64) -> Topology {
    let flat: Vec<(usize, &LocalEdge)> =
        made.iter().enumerate().flat_map(|(f, m)| m.1.iter().map(move |e| (f, e))).collect();
    let collapsed: Vec<bool> = flat.iter().map(|e| e.1.length_mm <= POINT * size_mm).collect();
    let groups = groups(&flat, &collapsed, join_mm);

    // Ends: two numbers a use. Uses of an edge share theirs, neighbours in a loop share one.
    let mut ends = Classes((0..2 * flat.len()).collect());
    for g in &groups {
        let (first, _) = g.members[0];
        for (k, forward) in &g.members[1..] {
            ends.join(2 * first, 2 * k + usize::from(!forward));
            ends.join(2 * first + 1, 2 * k + usize::from(*forward));
        }
    }
    for (k, c) in collapsed.iter().enumerate() {
        if *c {
            ends.join(2 * k, 2 * k + 1);
        }
    }
    let mut base = 0;
    for (chart, local) in &made {
        neighbours(local, base, 1e-4 * chart.size_mm.min(size_mm), &mut ends);
        base += local.len();
    }

    let mut number: HashMap<usize, usize> = HashMap::new();
    let mut vertices = Vec::new();
    let mut vertex_of = vec![0; 2 * flat.len()];
    for (k, number_of) in vertex_of.iter_mut().enumerate() {
        let class = ends.find(k);
        *number_of = *number.entry(class).or_insert_with(|| {
            vertices.push(flat[k / 2].1.ends[k % 2]);
            vertices.len() - 1
        });
    }

    let mut uses: Vec<EdgeUse> = (0..flat.len())
        .map(|k| EdgeUse { edge: None, forward: true, vertices: [vertex_of[2 * k], vertex_of[2 * k + 1]] })
        .collect();
    let mut edges = Vec::with_capacity(groups.len());
    for g in groups {
        let (first, _) = g.members[0];
        for (k, forward) in &g.members {
            uses[*k].edge = Some(edges.len());
            uses[*k].forward = *forward;
        }
        edges.push(Edge {
            course: flat[first].1.course.clone(),
            vertices: uses[first].vertices,
            uses: g.members.iter().map(|m| flat[m.0].0).collect(),
            length_mm: flat[first].1.length_mm,
        });
    }
    let mut rest = uses.into_iter();
    let faces = made
        .into_iter()
        .map(|(chart, local)| {
            let uses = rest.by_ref().take(local.len()).collect();
            FaceEdges { chart, local, uses }
        })
        .collect();
    Topology { faces, edges, vertices, size_mm }
}

/// Uses that are one edge: by identity first, then those that are alone by geometry.
fn groups(flat: &[(usize, &LocalEdge)], collapsed: &[bool], join_mm: f64) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let mut by_key: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (k, (_, e)) in flat.iter().enumerate() {
        if collapsed[k] {
            continue;
        }
        // Placed copies of a part repeat its identities elsewhere, hence the look at geometry.
        let known = e.key.map(|key| by_key.entry(key).or_default());
        let slack = join_mm.max(1e-4 * e.length_mm);
        let found = known.as_ref().and_then(|list| {
            list.iter().find_map(|g| same(flat[groups[*g].members[0].0].1, e, slack).map(|s| (*g, s)))
        });
        match found {
            Some((g, forward)) => groups[g].members.push((k, forward)),
            None => {
                if let Some(list) = known {
                    list.push(groups.len());
                }
                groups.push(Group { members: vec![(k, true)] });
            }
        }
    }
    // A grid over the middles of edges that are alone.
    let cell = |p: &Point3| [p.x, p.y, p.z].map(|c| (c / (2.0 * join_mm)).floor() as i64);
    let mut grid: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let alone: Vec<usize> = (0..groups.len()).filter(|g| groups[*g].members.len() == 1).collect();
    let mut taken = vec![false; groups.len()];
    for g in alone {
        let e = flat[groups[g].members[0].0].1;
        let home = cell(&e.middles[1]);
        let mut partner = None;
        'cells: for k in 0..27 {
            let at = [home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1];
            for other in grid.get(&at).map_or(&[][..], Vec::as_slice) {
                if !taken[*other]
                    && let Some(forward) = same(flat[groups[*other].members[0].0].1, e, join_mm)
                {
                    partner = Some((*other, forward));
                    break 'cells;
                }
            }
        }
        match partner {
            Some((other, forward)) => {
                let (k, _) = groups[g].members[0];
                groups[other].members.push((k, forward));
                taken[other] = true;
                groups[g].members.clear();
            }
            None => grid.entry(home).or_default().push(g),
        }
    }
    groups.retain(|g| !g.members.is_empty());
    groups
}

/// Joins the end of every edge of a loop to the start that continues it.
fn neighbours(local: &[LocalEdge], base: usize, slack: f64, ends: &mut Classes) {
    let mut first = 0;
    while first < local.len() {
        let owner = local[first].owner;
        let count = local[first..].iter().take_while(|e| e.owner == owner).count();
        let of = &local[first..first + count];
        for (k, e) in of.iter().enumerate() {
            let following = (k + 1) % count;
            let gap = |j: usize| (of[j].ends[0] - e.ends[1]).norm();
            let next = if gap(following) <= slack {
                Some(following)
            } else {
                let all = (0..count).filter(|j| gap(*j) <= 100.0 * slack);
                all.min_by(|a, b| gap(*a).total_cmp(&gap(*b)))
            };
            if let Some(j) = next {
                ends.join(2 * (base + first + k) + 1, 2 * (base + first + j));
            }
        }
        first += count;
    }
}
