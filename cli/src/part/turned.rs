//! Faces of a part that lie in other places again when they are turned about an axis.

use crate::part::loaded::Loaded;
use osculate_geom::{Box3, Point3, TurnAxis, Vec3};
use osculate_surfaces::pattern::{Circle, Pattern, PatternError, PatternFace, same_axis, turn_axis};

/// Places are one within this part of the part's size. What the images are off then stays well below tolerances of machining, and the
/// verdict measures it: it is made on the faces as they are.
const ONE_PLACE: f64 = 1e-5;

/// Where faces lie again.
#[non_exhaustive]
pub struct TurnedFaces {
    /// The turns.
    pub circle: Circle,
    /// The ids of the faces after each turn but the first, which is none.
    pub images: Vec<Vec<String>>,
}

/// The images of faces about an axis: the given one, or one that the part shows and that serves, beginning with z through the origin. Where
/// they `may_go_around` faces of all places will do, each of which is its own image then.
///
/// # Errors
/// In words, where there is none.
pub fn turned(
    part: &Loaded,
    ids: &[String],
    (axis, count): (Option<TurnAxis>, usize),
    may_go_around: bool,
) -> Result<TurnedFaces, String> {
    let size_mm = part.faces.iter().fold(Box3::empty(), |b, f| b.union(&f.surface.bbox(2))).diagonal_mm();
    let tolerance_mm = ONE_PLACE * size_mm;
    let faces: Vec<PatternFace<'_>> = part
        .faces
        .iter()
        .map(|f| PatternFace { name: &f.id, surface: &f.surface, carrier: f.nurbs() })
        .collect();
    let pattern = Pattern::new(&faces, tolerance_mm);
    let own: Vec<usize> = (0..part.faces.len()).filter(|k| ids.contains(&part.faces[*k].id)).collect();
    let z = TurnAxis { origin: Point3::origin(), direction: Vec3::z_axis() };
    let mut axes = vec![axis.unwrap_or(z)];
    if axis.is_none() {
        let shown = part.faces.iter().filter_map(|f| turn_axis(&f.source.as_ref()?.carrier));
        for found in shown {
            if !axes.iter().any(|a| same_axis(a, &found, tolerance_mm)) {
                axes.push(found);
            }
        }
    }
    let mut first: Option<PatternError> = None;
    for axis in &axes {
        let circle = Circle { axis: *axis, count };
        match pattern.images(&own, &circle) {
            Ok(images) => {
                let id = |k: &usize| part.faces[*k].id.clone();
                let images = images.iter().map(|all| all.iter().map(id).collect()).collect();
                return Ok(TurnedFaces { circle, images });
            }
            Err(_) if may_go_around && pattern.goes_around(&own, &circle) => {
                let all: Vec<String> = own.iter().map(|k| part.faces[*k].id.clone()).collect();
                return Ok(TurnedFaces { circle, images: vec![all; count - 1] });
            }
            Err(why) => first = first.or(Some(why)),
        }
    }
    let about = |a: &TurnAxis| {
        let (o, d) = (a.origin, a.direction);
        format!("({:.4}, {:.4}, {:.4}) through ({:.3}, {:.3}, {:.3})", d.x, d.y, d.z, o.x, o.y, o.z)
    };
    let serves = axes.iter().find_map(|a| Some((pattern.most_places(&own, a)?, a)));
    let what = match (serves, axis) {
        (Some((most, a)), _) => format!("about {} count = {most} serves, and what divides it", about(a)),
        (None, Some(a)) => format!(
            "about {} no number of places serves: change axis or at_mm, or write repeat = {count} to have the axis found",
            about(&a)
        ),
        (None, None) => format!(
            "no number of places serves about {}: say axis and at_mm, or name other faces",
            axes.iter().map(about).collect::<Vec<_>>().join(", or ")
        ),
    };
    Err(format!("{}; {what}", first.map_or_else(String::new, |why| why.to_string())))
}
