//! Triangles from 3MF: a ZIP archive with a model as XML, in a unit that it says.
//!
//! Read are the meshes of objects, components with their places, and the items to build; objects in further files of the archive (the
//! production extension) are refused. Of XML only tags and their attributes are looked at: all of a mesh stands in them.

use super::zip::{ZipError, entries};
use osculate_geom::Point3;
use std::collections::HashMap;

/// A file that is no 3MF mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ThreeMfError {
    /// Not an archive that is read.
    #[error(transparent)]
    Zip(#[from] ZipError),
    /// No model in the archive.
    #[error("the archive has no 3D/3dmodel.model")]
    NoModel,
    /// A tag that does not end, or an attribute that is no number.
    #[error("its model is damaged: {0}")]
    Damaged(&'static str),
    /// Objects in other files.
    #[error(
        "its objects lie in several files of the archive (the production extension), which is not read: export it without"
    )]
    Several,
    /// A corner or an object that is not there.
    #[error("its model names {0} that is not there")]
    Missing(&'static str),
    /// Objects within objects without end, or more triangles than the file can mean.
    #[error("its objects stand within each other too deeply or too often")]
    Endless,
    /// A unit that is not known.
    #[error("its unit is none of those of 3MF")]
    Unit,
    /// Nothing to build.
    #[error("there is no triangle in it")]
    Empty,
}

/// A model unpacks to this many times the archive at most: meshes as XML shrink to a tenth.
const MOST_UNPACKED: usize = 100;
/// How deeply objects stand within each other at most.
const DEEPEST: usize = 16;
/// Triangles that places of objects come to at most, of those that stand in the file.
const MOST_PLACED: usize = 64;

/// A place: three columns and the origin, as the file has them, row after row.
type Place = [f64; 12];

/// What an object is.
#[derive(Default)]
struct Object {
    vertices: Vec<Point3>,
    triangles: Vec<[usize; 3]>,
    components: Vec<(String, Place)>,
}

/// A tag with its attributes; the name without what stands before a colon, empty for the end of one.
struct Tag<'a> {
    name: &'a str,
    rest: &'a str,
}

impl<'a> Tag<'a> {
    fn attribute(&self, name: &str) -> Option<&'a str> {
        let mut rest = self.rest;
        loop {
            let (key, after) = rest.split_once('=')?;
            let after = after.trim_start();
            let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
            let (value, next) = after[1..].split_once(quote)?;
            if key.trim() == name {
                return Some(value);
            }
            rest = next;
        }
    }

    fn number(&self, name: &str) -> Result<f64, ThreeMfError> {
        let wrong = ThreeMfError::Damaged("an attribute is no number");
        let value: f64 = self.attribute(name).and_then(|v| v.trim().parse().ok()).ok_or(wrong.clone())?;
        if value.is_finite() { Ok(value) } else { Err(wrong) }
    }

    fn index(&self, name: &str) -> Result<usize, ThreeMfError> {
        let value = self.attribute(name).and_then(|v| v.trim().parse().ok());
        value.ok_or(ThreeMfError::Damaged("a corner is no whole number"))
    }

    fn place(&self) -> Result<Place, ThreeMfError> {
        let Some(text) = self.attribute("transform") else {
            return Ok([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        };
        let numbers: Vec<f64> = text.split_ascii_whitespace().map_while(|w| w.parse().ok()).collect();
        let place: Place =
            numbers.try_into().map_err(|_| ThreeMfError::Damaged("a transform is no twelve numbers"))?;
        if place.iter().all(|x| x.is_finite()) {
            Ok(place)
        } else {
            Err(ThreeMfError::Damaged("a transform is not finite"))
        }
    }

    fn object(&self) -> Result<(String, Place), ThreeMfError> {
        if self.rest.contains(":path") {
            return Err(ThreeMfError::Several);
        }
        let id = self.attribute("objectid").ok_or(ThreeMfError::Missing("an object"))?;
        Ok((id.to_owned(), self.place()?))
    }
}

/// The next tag of a text and what follows it; none at its end.
fn next_tag(text: &str) -> Result<Option<(Tag<'_>, &str)>, ThreeMfError> {
    let mut text = text;
    loop {
        let Some(begin) = text.find('<') else { return Ok(None) };
        let inner = &text[begin + 1..];
        if let Some(comment) = inner.strip_prefix("!--") {
            let end = comment.find("-->").ok_or(ThreeMfError::Damaged("a comment does not end"))?;
            text = &comment[end + 3..];
            continue;
        }
        // A bracket may stand in an attribute.
        let mut quote = None;
        let end = inner.bytes().position(|b| match (quote, b) {
            (None, b'>') => true,
            (None, b'"' | b'\'') => {
                quote = Some(b);
                false
            }
            (Some(q), b) if q == b => {
                quote = None;
                false
            }
            _ => false,
        });
        let end = end.ok_or(ThreeMfError::Damaged("a tag does not end"))?;
        let whole = &inner[..end];
        let (name, rest) = whole.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((whole, ""));
        let name = if name.starts_with(['/', '?', '!']) { "" } else { name.trim_end_matches('/') };
        let name = name.rsplit_once(':').map_or(name, |n| n.1);
        return Ok(Some((Tag { name, rest }, &inner[end + 1..])));
    }
}

/// Whether bytes begin as an archive with a model does.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
        && entries(bytes)
            .is_ok_and(|all| all.iter().any(|e| e.name.to_ascii_lowercase().ends_with(b".model")))
}

/// The triangles of the items to build of a 3MF file, and the millimetres in its unit.
///
/// # Errors
/// [`ThreeMfError`].
pub(super) fn read(bytes: &[u8]) -> Result<(Vec<[Point3; 3]>, f64), ThreeMfError> {
    let all = entries(bytes)?;
    let is = |end: &[u8]| all.iter().position(|e| e.name.to_ascii_lowercase().ends_with(end));
    let model = is(b"3d/3dmodel.model").or_else(|| is(b".model")).ok_or(ThreeMfError::NoModel)?;
    let model = all[model].unpacked(bytes.len().saturating_mul(MOST_UNPACKED))?;
    let text = String::from_utf8_lossy(&model);
    let mut unit_mm = 1.0;
    let mut objects: HashMap<String, Object> = HashMap::new();
    let (mut id, mut own) = (None, Object::default());
    let mut items: Vec<(String, Place)> = Vec::new();
    let mut rest: &str = &text;
    while let Some((tag, after)) = next_tag(rest)? {
        rest = after;
        match tag.name {
            "model" => {
                unit_mm = match tag.attribute("unit").unwrap_or("millimeter") {
                    "micron" => 1e-3,
                    "millimeter" => 1.0,
                    "centimeter" => 10.0,
                    "inch" => 25.4,
                    "foot" => 304.8,
                    "meter" => 1000.0,
                    _ => return Err(ThreeMfError::Unit),
                }
            }
            "object" => {
                if let Some(before) = id.take() {
                    objects.insert(before, std::mem::take(&mut own));
                }
                id =
                    Some(tag.attribute("id").ok_or(ThreeMfError::Damaged("an object has no id"))?.to_owned());
            }
            "vertex" => own.vertices.push(Point3::new(tag.number("x")?, tag.number("y")?, tag.number("z")?)),
            "triangle" => own.triangles.push([tag.index("v1")?, tag.index("v2")?, tag.index("v3")?]),
            "component" => own.components.push(tag.object()?),
            "item" => items.push(tag.object()?),
            _ => {}
        }
    }
    if let Some(last) = id {
        objects.insert(last, own);
    }
    let inside: usize = objects.values().map(|o| o.triangles.len()).sum();
    let mut out = Vec::new();
    let mut room = inside.saturating_mul(MOST_PLACED);
    for (id, place) in &items {
        put(&objects, id, &[*place], (&mut out, &mut room))?;
    }
    if out.is_empty() { Err(ThreeMfError::Empty) } else { Ok((out, unit_mm)) }
}

/// Puts the triangles of an object at its place, the innermost of `places` last.
fn put(
    objects: &HashMap<String, Object>,
    id: &str,
    places: &[Place],
    (out, room): (&mut Vec<[Point3; 3]>, &mut usize),
) -> Result<(), ThreeMfError> {
    let object = objects.get(id).ok_or(ThreeMfError::Missing("an object"))?;
    *room = room.checked_sub(object.triangles.len().max(1)).ok_or(ThreeMfError::Endless)?;
    if places.len() > DEEPEST {
        return Err(ThreeMfError::Endless);
    }
    let placed = |p: &Point3| {
        places.iter().rev().fold(*p, |p, m| {
            let of = |k: usize| p.x * m[k] + p.y * m[3 + k] + p.z * m[6 + k] + m[9 + k];
            Point3::new(of(0), of(1), of(2))
        })
    };
    for t in &object.triangles {
        let mut corners = [Point3::origin(); 3];
        for (corner, k) in corners.iter_mut().zip(t) {
            *corner = placed(object.vertices.get(*k).ok_or(ThreeMfError::Missing("a corner"))?);
        }
        out.push(corners);
    }
    for (id, place) in &object.components {
        put(objects, id, &[places, &[*place]].concat(), (&mut *out, &mut *room))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An archive of one entry, packed where asked for.
    fn archive(name: &str, text: &str, packed: bool) -> Vec<u8> {
        let data = if packed {
            miniz_oxide::deflate::compress_to_vec(text.as_bytes(), 6)
        } else {
            text.as_bytes().to_vec()
        };
        let method = if packed { 8u16 } else { 0 };
        let mut out = b"PK\x03\x04\x14\0\0\0".to_vec();
        out.extend(method.to_le_bytes());
        out.extend([0; 8]);
        out.extend((data.len() as u32).to_le_bytes());
        out.extend((text.len() as u32).to_le_bytes());
        out.extend((name.len() as u16).to_le_bytes());
        out.extend([0; 2]);
        out.extend(name.as_bytes());
        out.extend(&data);
        let directory = out.len() as u32;
        out.extend(b"PK\x01\x02\x14\0\x14\0\0\0");
        out.extend(method.to_le_bytes());
        out.extend([0; 8]);
        out.extend((data.len() as u32).to_le_bytes());
        out.extend((text.len() as u32).to_le_bytes());
        out.extend((name.len() as u16).to_le_bytes());
        out.extend([0; 12]);
        out.extend([0; 4]);
        out.extend(name.as_bytes());
        let size = out.len() as u32 - directory;
        out.extend(b"PK\x05\x06\0\0\0\0\x01\0\x01\0");
        out.extend(size.to_le_bytes());
        out.extend(directory.to_le_bytes());
        out.extend([0; 2]);
        out
    }

    const MESH: &str = r#"<vertices><vertex x="0" y="0" z="0"/><vertex x='1' y="0" z="0" /><vertex x="0" y="2" z="0"/></vertices>
        <triangles><!-- > --><triangle v1="0" v2="1" v3="2" pid="a>b"/></triangles></mesh>"#;

    fn model(more: &str, build: &str) -> String {
        format!(
            r#"<?xml version="1.0"?><model unit="inch" xmlns:p="x"><resources><object id="1" type="model"><mesh>{MESH}</object>{more}</resources><build>{build}</build></model>"#
        )
    }

    #[test]
    fn items_and_components_stand_at_their_places() {
        let more = r#"<object id="2"><components><component objectid="1" transform="0 1 0 -1 0 0 0 0 1 10 0 0"/></components></object>"#;
        let text =
            model(more, r#"<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 5"/><m:item objectid="1"/>"#);
        for packed in [false, true] {
            let bytes = archive("3D/3dmodel.model", &text, packed);
            assert!(looks_like(&bytes));
            let (triangles, unit_mm) = read(&bytes).unwrap();
            // A quarter turn and 10 along x first, then twice the size and 5 up.
            let want = [[20.0, 0.0, 5.0], [20.0, 2.0, 5.0], [16.0, 0.0, 5.0]].map(Point3::from);
            assert_eq!((triangles.len(), unit_mm), (2, 25.4));
            assert!(triangles[0].iter().zip(&want).all(|(a, b)| (a - b).norm() < 1e-12), "{triangles:?}");
            assert_eq!(triangles[1][2], Point3::new(0.0, 2.0, 0.0));
        }
    }

    #[test]
    fn what_is_damaged_or_endless_is_refused() {
        let of = |text: &str| read(&archive("3D/3dmodel.model", text, true)).map(|r| r.0.len());
        let item = r#"<item objectid="1"/>"#;
        assert_eq!(of(&model("", item)), Ok(1));
        assert_eq!(of(&model("", "")), Err(ThreeMfError::Empty));
        assert_eq!(of(&model("", r#"<item objectid="7"/>"#)), Err(ThreeMfError::Missing("an object")));
        assert_eq!(
            of(&model("", r#"<item objectid="1" p:path="/3D/a.model"/>"#)),
            Err(ThreeMfError::Several)
        );
        let within = r#"<object id="2"><component objectid="2"/></object>"#;
        assert_eq!(of(&model(within, r#"<item objectid="2"/>"#)), Err(ThreeMfError::Endless));
        // Each stands in the next one nine times: 9^12 triangles.
        let many: String = (2..14)
            .map(|k| {
                format!(
                    "<object id=\"{k}\">{}</object>",
                    format!("<component objectid=\"{}\"/>", k - 1).repeat(9)
                )
            })
            .collect();
        assert_eq!(of(&model(&many, r#"<item objectid="13"/>"#)), Err(ThreeMfError::Endless));
        assert_eq!(
            of(&model("", item).replace("v3=\"2\"", "v3=\"3\"")),
            Err(ThreeMfError::Missing("a corner"))
        );
        assert!(matches!(
            of(&model("", item).replace("y=\"2\"", "y=\"nan\"")),
            Err(ThreeMfError::Damaged(_))
        ));
        assert!(matches!(of(&model("", item).replace("inch", "mile")), Err(ThreeMfError::Unit)));
        let whole = archive("3D/3dmodel.model", &model("", item), true);
        for end in 0..whole.len() {
            assert!(read(&whole[..end]).is_err(), "{end}");
        }
        assert_eq!(read(&archive("a.txt", "", false)), Err(ThreeMfError::NoModel));
        // A bomb: a hundred megabytes of spaces in a hundred kilobytes.
        let bomb = archive("3D/3dmodel.model", &" ".repeat(40_000_000), true);
        assert!(bomb.len() < 100_000);
        assert!(matches!(read(&bomb), Err(ThreeMfError::Zip(ZipError::Packed { .. }))));
    }
}
