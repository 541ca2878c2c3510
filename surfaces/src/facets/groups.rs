//! The faces of a mesh: triangles that hang together without a sharp edge, all turned to the outside.

use super::weld::{Seam, Seams, Sets, Welded};
use osculate_geom::{Box3, Diagnostic, Facets, FacetsError, Point3};

/// Triangles that turn by more than this at a common side belong to different faces, rad: 30 degrees. Meshes of smooth shapes turn by
/// less, and edges of parts by more.
pub const SHARP_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// Faces at most: of a rougher mesh the smaller ones are one face together.
pub const MOST_FACES: usize = 500;
/// Turns that are below this are rounding, rad.
const LEVEL_RAD: f64 = 1e-6;
/// The share of the length of all bent sides at which the mesh comes as near to a smooth surface as it is told: the rest may be true
/// edges that are not sharp.
const MOST_SIDES: f64 = 0.95;

/// A face of a mesh.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MeshFace {
    /// Its triangles, outward.
    pub facets: Facets,
    /// Whether it is what is left of many small ones, which need not hang together.
    pub rest: bool,
}

/// A mesh as a part.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MeshPart {
    /// The faces, in the order of their first triangles in the file.
    pub faces: Vec<MeshFace>,
    /// Triangles in all.
    pub triangles: usize,
    /// Whether every side belongs to two triangles.
    pub closed: bool,
    /// How far the triangles stand off a smooth surface through their corners, as their angles suggest, mm; zero where none bend. It
    /// is an estimate: nothing in a mesh says it.
    pub chord_mm: f64,
    /// What was changed, and what is not closed.
    pub diagnostics: Vec<Diagnostic>,
}

/// Makes a part of triangles, in mm. Those that turn by more than `sharp_rad` ([`SHARP_RAD`]) at a common side belong to different faces.
///
/// ```
/// use osculate_geom::Point3;
/// use osculate_surfaces::facets::{SHARP_RAD, mesh_part};
/// // A corner cut off a cube of 6 mm: four triangles, a face each, closed.
/// let p = [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 6.0]].map(Point3::from);
/// let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|t| t.map(|k| p[k]));
/// let part = mesh_part(&triangles, SHARP_RAD)?;
/// assert!(part.closed && part.faces.len() == 4);
/// let area: f64 = part.faces.iter().map(|f| f.facets.area_mm2()).sum();
/// assert!((area - (54.0 + 18.0 * 3f64.sqrt())).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FacetsError`] where no triangle has an area, and where one is not finite or too far away.
pub fn mesh_part(triangles: &[[Point3; 3]], sharp_rad: f64) -> Result<MeshPart, FacetsError> {
    for (triangle, t) in triangles.iter().enumerate() {
        Facets::places(triangle, t)?;
    }
    let mut welded = Welded::new(triangles);
    if welded.triangles.is_empty() {
        return Err(FacetsError::Empty);
    }
    let mut diagnostics = Vec::new();
    let mut tell = |text: String| diagnostics.push(Diagnostic::note("mesh", text));
    if welded.flat > 0 {
        tell(format!("{} of its triangles have no area and are left out", welded.flat));
    }
    let seams = welded.seams();
    let bodies = turned(&mut welded, &seams, &mut tell);
    outward(&mut welded, &seams, &bodies, &mut tell);
    if !seams.open.is_empty() {
        let sides = seams.open.len();
        tell(format!(
            "it is not closed: {sides} sides of triangles belong to one alone; the material is where the triangles say"
        ));
    }
    if seams.crowded > 0 {
        tell(format!("{} sides belong to three triangles or more: faces end there", seams.crowded));
    }
    let angle = |s: &Seam| {
        let [a, b] = s.of.map(|k| welded.cross(&welded.triangles[k as usize]));
        a.cross(&b).norm().atan2(a.dot(&b))
    };
    let mut sets = Sets::new(welded.triangles.len());
    // Length and stand-off of each side that bends.
    let mut bent: Vec<(f64, f64)> = Vec::new();
    for s in &seams.seams {
        let turn = angle(s);
        if turn > sharp_rad {
            continue;
        }
        sets.join(s.of[0], s.of[1]);
        if turn > LEVEL_RAD {
            let [from, to] = s.ends.map(|k| welded.points[k as usize]);
            let length = (to - from).norm();
            let wide = |k: u32| welded.cross(&welded.triangles[k as usize]).norm() / length;
            bent.push((0.125 * turn * wide(s.of[0]).min(wide(s.of[1])), length));
        }
    }
    let faces = faces(&welded, sets.all(), &mut tell)?;
    Ok(MeshPart {
        faces,
        triangles: welded.triangles.len(),
        closed: seams.open.is_empty() && seams.crowded == 0,
        chord_mm: most_of(bent),
        diagnostics,
    })
}

/// The value that most of a length stays below.
fn most_of(mut values: Vec<(f64, f64)>) -> f64 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = values.iter().map(|v| v.1).sum();
    let mut sum = 0.0;
    let found = values.iter().find(|v| {
        sum += v.1;
        sum >= MOST_SIDES * whole
    });
    found.map_or(0.0, |v| v.0)
}

/// Turns triangles that do not go with their neighbours over, the fewer of each body; the bodies come back.
fn turned(welded: &mut Welded, seams: &Seams, tell: &mut dyn FnMut(String)) -> Vec<Vec<u32>> {
    let count = welded.triangles.len();
    let mut sets = Sets::new(count);
    for s in &seams.seams {
        sets.join(s.of[0], s.of[1]);
    }
    let bodies = sets.all();
    if seams.seams.iter().all(|s| !s.turned) {
        return bodies;
    }
    let mut beside: Vec<Vec<(u32, bool)>> = vec![Vec::new(); count];
    for s in &seams.seams {
        beside[s.of[0] as usize].push((s.of[1], s.turned));
        beside[s.of[1] as usize].push((s.of[0], s.turned));
    }
    let mut over: Vec<Option<bool>> = vec![None; count];
    let (mut all, mut contradict) = (0, false);
    for body in &bodies {
        over[body[0] as usize] = Some(false);
        let mut pending = vec![body[0]];
        while let Some(k) = pending.pop() {
            let own = over[k as usize] == Some(true);
            for (other, turned) in &beside[k as usize] {
                let wanted = own != *turned;
                match over[*other as usize] {
                    None => {
                        over[*other as usize] = Some(wanted);
                        pending.push(*other);
                    }
                    Some(known) => contradict |= known != wanted,
                }
            }
        }
        let is_over = |k: &&u32| over[**k as usize] == Some(true);
        let first = body.iter().filter(is_over).count();
        let fewer = 2 * first <= body.len();
        let these: Vec<u32> = body.iter().filter(|k| is_over(k) == fewer).copied().collect();
        all += these.len();
        for k in these {
            welded.triangles[k as usize].swap(1, 2);
        }
    }
    if all > 0 {
        tell(format!(
            "{all} of its triangles looked to the other side than those next to them and were turned over"
        ));
    }
    if contradict {
        tell("some of its triangles hang together to a band with one side only: their sides are not to be trusted".to_owned());
    }
    bodies
}

/// Turns closed bodies that are inside out, and are no voids of others, over.
fn outward(welded: &mut Welded, seams: &Seams, bodies: &[Vec<u32>], tell: &mut dyn FnMut(String)) {
    let mut open = vec![false; welded.triangles.len()];
    for k in &seams.open {
        open[*k as usize] = true;
    }
    let volume = |body: &[u32]| -> f64 {
        let o = welded.points[welded.triangles[body[0] as usize][0] as usize];
        let of = |t: &[u32; 3]| (welded.points[t[0] as usize] - o).dot(&welded.cross(t));
        body.iter().map(|k| of(&welded.triangles[*k as usize])).sum()
    };
    let around = |body: &[u32]| {
        let corners = body.iter().flat_map(|k| welded.triangles[*k as usize]);
        Box3::around(&corners.map(|k| welded.points[k as usize]).collect::<Vec<_>>())
    };
    let closed: Vec<(&Vec<u32>, f64)> =
        bodies.iter().filter(|b| !b.iter().any(|k| open[*k as usize])).map(|b| (b, volume(b))).collect();
    let solid: Vec<Box3> = closed.iter().filter(|b| b.1 > 0.0).map(|b| around(b.0)).collect();
    let within = |a: &Box3, b: &Box3| (0..3).all(|k| b.min[k] < a.min[k] && a.max[k] < b.max[k]);
    let over: Vec<u32> = closed
        .iter()
        .filter(|b| b.1 < 0.0)
        .filter(|b| {
            let own = around(b.0);
            !solid.iter().any(|s| within(&own, s))
        })
        .flat_map(|b| b.0.iter().copied())
        .collect();
    if !over.is_empty() {
        tell(format!(
            "{} of its triangles make bodies that are inside out: these were turned over",
            over.len()
        ));
    }
    for k in over {
        welded.triangles[k as usize].swap(1, 2);
    }
}

/// Faces of sets of triangles; of more than are kept the smaller ones together.
fn faces(
    welded: &Welded,
    mut sets: Vec<Vec<u32>>,
    tell: &mut dyn FnMut(String),
) -> Result<Vec<MeshFace>, FacetsError> {
    let mut rest: Vec<u32> = Vec::new();
    if sets.len() > MOST_FACES {
        let area = |s: &[u32]| -> f64 {
            s.iter().map(|k| welded.cross(&welded.triangles[*k as usize]).norm()).sum()
        };
        let mut sized: Vec<(f64, usize)> = sets.iter().enumerate().map(|(k, s)| (area(s), k)).collect();
        sized.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut keep = vec![false; sets.len()];
        sized.iter().take(MOST_FACES - 1).for_each(|s| keep[s.1] = true);
        tell(format!(
            "sharp edges part it into {} pieces: the {} largest are faces, all others are one together",
            sets.len(),
            MOST_FACES - 1
        ));
        let mut kept = Vec::with_capacity(MOST_FACES);
        for (set, keep) in sets.into_iter().zip(keep) {
            if keep { kept.push(set) } else { rest.extend(set) }
        }
        sets = kept;
    }
    let corners = |t: &[u32; 3]| t.map(|k| welded.points[k as usize]);
    let face = |set: &[u32], rest| {
        let facets = Facets::new(set.iter().map(|k| corners(&welded.triangles[*k as usize])).collect())?;
        Ok(MeshFace { facets, rest })
    };
    let mut out: Vec<MeshFace> = sets.iter().map(|s| face(s, false)).collect::<Result<_, _>>()?;
    if !rest.is_empty() {
        out.push(face(&rest, true)?);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn p(x: f64, y: f64, z: f64) -> Point3 {
        Point3::new(x, y, z)
    }

    /// A closed cylinder of so many sides.
    fn cylinder(radius: f64, height: f64, sides: usize, at: Point3) -> Vec<[Point3; 3]> {
        let rim = |k: usize, z: f64| {
            let a = TAU * (k % sides) as f64 / sides as f64;
            at + p(radius * a.cos(), radius * a.sin(), z).coords
        };
        let middle = |z: f64| at + p(0.0, 0.0, z).coords;
        (0..sides)
            .flat_map(|k| {
                [
                    [rim(k, 0.0), rim(k + 1, 0.0), rim(k + 1, height)],
                    [rim(k, 0.0), rim(k + 1, height), rim(k, height)],
                    [middle(0.0), rim(k + 1, 0.0), rim(k, 0.0)],
                    [middle(height), rim(k, height), rim(k + 1, height)],
                ]
            })
            .collect()
    }

    fn volume(part: &MeshPart) -> f64 {
        let all = part.faces.iter().flat_map(|f| f.facets.triangles());
        all.map(|[a, b, c]| a.coords.dot(&(b - a).cross(&(c - a))) / 6.0).sum()
    }

    #[test]
    fn a_cylinder_is_three_faces_with_the_chord_of_a_circle() {
        let part = mesh_part(&cylinder(10.0, 4.0, 72, p(1.0, 2.0, 3.0)), SHARP_RAD).unwrap();
        assert_eq!((part.faces.len(), part.triangles, part.closed), (3, 288, true));
        assert!(part.diagnostics.is_empty());
        // The sagitta of a chord of five degrees; the estimate leaves terms of fourth order.
        let want = 10.0 * (1.0 - (TAU / 144.0).cos());
        assert!((part.chord_mm / want - 1.0).abs() < 2e-3, "{} {want}", part.chord_mm);
        let wall = 72.0 * 2.0 * 10.0 * (TAU / 144.0).sin() * 4.0;
        assert!((part.faces[0].facets.area_mm2() - wall).abs() < 1e-9);
        // Eight sides turn by 45 degrees each.
        assert_eq!(mesh_part(&cylinder(10.0, 4.0, 8, p(0.0, 0.0, 0.0)), SHARP_RAD).unwrap().faces.len(), 10);
    }

    #[test]
    fn triangles_are_turned_to_the_outside_and_it_is_told() {
        let good = cylinder(10.0, 4.0, 24, p(0.0, 0.0, 0.0));
        let want = volume(&mesh_part(&good, SHARP_RAD).unwrap());
        assert!(want > 1000.0);
        let over = |which: &dyn Fn(usize) -> bool| -> Vec<[Point3; 3]> {
            let turn = |(k, t): (usize, &[Point3; 3])| if which(k) { [t[0], t[2], t[1]] } else { *t };
            good.iter().enumerate().map(turn).collect()
        };
        for (which, told) in [
            (&(|k: usize| k.is_multiple_of(7)) as &dyn Fn(usize) -> bool, "were turned over"),
            (&|_| true, "inside out"),
            (&|k| k % 7 != 0, "inside out"),
        ] {
            let part = mesh_part(&over(which), SHARP_RAD).unwrap();
            assert!((volume(&part) - want).abs() < 1e-9);
            assert!(part.diagnostics.iter().any(|d| d.to_string().contains(told)), "{:?}", part.diagnostics);
        }
    }

    #[test]
    fn a_void_stays_one_and_a_hole_is_told() {
        let mut all = cylinder(10.0, 4.0, 24, p(0.0, 0.0, 0.0));
        let inner = cylinder(3.0, 1.0, 24, p(0.0, 0.0, 1.0));
        let (outer, void) = (mesh_part(&all, SHARP_RAD).unwrap(), mesh_part(&inner, SHARP_RAD).unwrap());
        all.extend(inner.iter().map(|t| [t[0], t[2], t[1]]));
        let part = mesh_part(&all, SHARP_RAD).unwrap();
        assert!((volume(&part) - volume(&outer) + volume(&void)).abs() < 1e-9);
        assert!(part.closed && part.diagnostics.is_empty());
        all.pop();
        let open = mesh_part(&all, SHARP_RAD).unwrap();
        assert!(!open.closed && open.diagnostics[0].to_string().contains("3 sides"));
    }

    #[test]
    fn many_pieces_are_faces_up_to_a_number() {
        let bodies = MOST_FACES / 2;
        let all: Vec<_> =
            (0..bodies).flat_map(|k| cylinder(1.0, 1.0, 24, p(3.0 * k as f64, 0.0, 0.0))).collect();
        let part = mesh_part(&all, SHARP_RAD).unwrap();
        assert_eq!(part.faces.len(), MOST_FACES);
        assert_eq!(part.faces.iter().filter(|f| f.rest).count(), 1);
        let triangles: usize = part.faces.iter().map(|f| f.facets.triangles().len()).sum();
        assert_eq!(triangles, all.len());
        // Flat ones are left out, and told.
        let mut flat = cylinder(1.0, 1.0, 24, p(0.0, 0.0, 0.0));
        flat.push([p(0.0, 0.0, 0.0); 3]);
        assert!(mesh_part(&flat, SHARP_RAD).unwrap().diagnostics[0].to_string().contains("no area"));
        assert!(matches!(mesh_part(&flat[96..], SHARP_RAD), Err(FacetsError::Empty)));
    }
}
