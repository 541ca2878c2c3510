//! Triangles from PLY, text or binary in either byte order. PLY has no unit.
//!
//! Of the elements `vertex` with x, y and z, and `face` with a list of vertex numbers are read, all else is passed over. A face of
//! more than three corners is taken as a fan from its first one. Counts are held against the bytes that are there before memory is
//! taken for them.

use osculate_geom::Point3;
use std::str::SplitAsciiWhitespace;

/// A file that is no PLY mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlyError {
    /// The head says something that is not known.
    #[error("line {line} of its head is not understood{}", .what.map_or_else(String::new, |w| format!(": {w}")))]
    Head {
        /// Line, from 1.
        line: usize,
        /// What is missing or wrong with it.
        what: Option<&'static str>,
    },
    /// No end of the head.
    #[error("its head does not end: it is truncated or no PLY")]
    Endless,
    /// The element that carries the corners is not there.
    #[error("it has no {0}")]
    Missing(&'static str),
    /// More is announced than there is.
    #[error("it ends in {element} {row} of {count}: it is truncated, or its head is wrong")]
    Short {
        /// The element, as its head names it.
        element: &'static str,
        /// The row in which it ends, from 1.
        row: usize,
        /// Rows that are announced.
        count: usize,
    },
    /// A word that is no number.
    #[error("{element} {row} has a word that is no number")]
    Number {
        /// The element.
        element: &'static str,
        /// Its row, from 1.
        row: usize,
    },
    /// A face with a corner that is not there, or too few of them.
    #[error("face {face}: its corners are not three or more of the {vertices} vertices")]
    Face {
        /// Which, from 1.
        face: usize,
        /// Vertices that are there.
        vertices: usize,
    },
    /// A coordinate that is not finite.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// Which, from 1.
        vertex: usize,
    },
    /// No triangles at all.
    #[error("there is no triangle in it")]
    Empty,
}

/// A kind of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn of(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// What a row of an element has.
#[derive(Clone, Debug)]
struct Property {
    name: String,
    kind: Number,
    /// Of a list, the kind of its length.
    list: Option<Number>,
}

#[derive(Clone, Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

/// Where numbers come from.
enum Body<'a> {
    Text(SplitAsciiWhitespace<'a>),
    Binary { rest: &'a [u8], big: bool },
}

/// Why no number comes.
enum Fault {
    Short,
    Word,
}

impl Body<'_> {
    fn number(&mut self, kind: Number) -> Result<f64, Fault> {
        match self {
            Self::Text(words) => words.next().ok_or(Fault::Short)?.parse().map_err(|_| Fault::Word),
            Self::Binary { rest, big } => {
                let (own, after) = rest.split_at_checked(kind.bytes()).ok_or(Fault::Short)?;
                *rest = after;
                // In the order of this machine's numbers: least byte first.
                let mut b = [0u8; 8];
                for (k, byte) in own.iter().enumerate() {
                    b[if *big { own.len() - 1 - k } else { k }] = *byte;
                }
                let four = [b[0], b[1], b[2], b[3]];
                Ok(match kind {
                    Number::I8 => f64::from(i8::from_le_bytes([b[0]])),
                    Number::U8 => f64::from(b[0]),
                    Number::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
                    Number::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
                    Number::I32 => f64::from(i32::from_le_bytes(four)),
                    Number::U32 => f64::from(u32::from_le_bytes(four)),
                    Number::F32 => f64::from(f32::from_le_bytes(four)),
                    Number::F64 => f64::from_le_bytes(b),
                })
            }
        }
    }
}

/// Whether bytes begin as PLY does.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

/// The elements of a head, where the body begins, and whether it is text, or binary with the greatest byte first.
fn head(bytes: &[u8]) -> Result<(Vec<Element>, usize, Option<bool>), PlyError> {
    let (mut elements, mut order, mut at) = (Vec::<Element>::new(), None, 0);
    for line in 1.. {
        let rest = &bytes[at..];
        let end = rest.iter().position(|b| *b == b'\n').ok_or(PlyError::Endless)?;
        let text = String::from_utf8_lossy(&rest[..end]);
        at += end + 1;
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        let wrong = |what| PlyError::Head { line, what };
        match words[..] {
            ["end_header"] => {
                let order = order.ok_or_else(|| wrong(Some("no line says the format")))?;
                return Ok((elements, at, order));
            }
            ["format", "ascii", _] => order = Some(None),
            ["format", "binary_little_endian", _] => order = Some(Some(false)),
            ["format", "binary_big_endian", _] => order = Some(Some(true)),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| wrong(Some("its count is no whole number")))?;
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", ref kinds @ .., name] => {
                let known = |word: &str| Number::of(word).ok_or_else(|| wrong(Some("no kind of number")));
                let (kind, list) = match kinds {
                    ["list", length, kind] => (known(kind)?, Some(known(length)?)),
                    [kind] => (known(kind)?, None),
                    _ => return Err(wrong(None)),
                };
                let element = elements.last_mut().ok_or_else(|| wrong(Some("a property of no element")))?;
                element.properties.push(Property { name: name.to_owned(), kind, list });
            }
            [] | ["ply"] | ["comment" | "obj_info", ..] => {}
            _ => return Err(wrong(None)),
        }
    }
    Err(PlyError::Endless)
}

/// The triangles of a PLY file.
///
/// # Errors
/// [`PlyError`].
pub(super) fn read(bytes: &[u8]) -> Result<Vec<[Point3; 3]>, PlyError> {
    let (elements, at, order) = head(bytes)?;
    let rest = &bytes[at..];
    let text = order.is_none().then(|| String::from_utf8_lossy(rest));
    let mut body = match (&text, order) {
        (Some(text), _) => Body::Text(text.split_ascii_whitespace()),
        (None, big) => Body::Binary { rest, big: big == Some(true) },
    };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let (mut seen_vertices, mut seen_faces) = (false, false);
    for element in &elements {
        let name = match element.name.as_str() {
            "vertex" => "vertex",
            "face" => "face",
            _ => "a row",
        };
        let place = |axis: &str| element.properties.iter().position(|p| p.name == axis && p.list.is_none());
        let places = [place("x"), place("y"), place("z")];
        let is_corners =
            |p: &Property| p.list.is_some() && matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
        let corners = element.properties.iter().position(is_corners);
        if name == "vertex" {
            seen_vertices = places.iter().all(Option::is_some);
        }
        seen_faces |= name == "face" && corners.is_some();
        if element.properties.is_empty() {
            continue;
        }
        for row in 1..=element.count {
            let fault = |f: Fault| match f {
                Fault::Short => PlyError::Short { element: name, row, count: element.count },
                Fault::Word => PlyError::Number { element: name, row },
            };
            let mut point = [0.0; 3];
            let mut fan: Vec<usize> = Vec::new();
            for (k, p) in element.properties.iter().enumerate() {
                match p.list {
                    None => {
                        let value = body.number(p.kind).map_err(fault)?;
                        if let Some(axis) = places.iter().position(|q| *q == Some(k)) {
                            point[axis] = value;
                        }
                    }
                    Some(length) => {
                        let n = body.number(length).map_err(fault)?;
                        // What is below zero or no number is none. A list never takes more than is there.
                        for _ in 0..n as usize {
                            let value = body.number(p.kind).map_err(fault)?;
                            if name == "face" && corners == Some(k) {
                                let known = value >= 0.0 && value < vertices.len() as f64;
                                let wrong = PlyError::Face { face: row, vertices: vertices.len() };
                                fan.push(if known { value as usize } else { return Err(wrong) });
                            }
                        }
                    }
                }
            }
            if name == "vertex" {
                if !point.iter().all(|x| x.is_finite()) {
                    return Err(PlyError::NotFinite { vertex: row });
                }
                vertices.push(Point3::from(point));
            } else if name == "face" && corners.is_some() {
                if fan.len() < 3 {
                    return Err(PlyError::Face { face: row, vertices: vertices.len() });
                }
                let v = |k: usize| vertices[fan[k]];
                triangles.extend((1..fan.len() - 1).map(|k| [v(0), v(k), v(k + 1)]));
            }
        }
    }
    match (seen_vertices, seen_faces) {
        (false, _) => Err(PlyError::Missing("vertex with x, y and z")),
        (_, false) => Err(PlyError::Missing("face with a list of vertex_indices")),
        _ if triangles.is_empty() => Err(PlyError::Empty),
        _ => Ok(triangles),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\n\
        element face 2\nproperty list uchar int vertex_indices\nend_header\n";

    fn want() -> Vec<[Point3; 3]> {
        let p = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]].map(Point3::from);
        vec![[p[0], p[1], p[2]], [p[0], p[2], p[3]], [p[2], p[1], p[3]]]
    }

    fn binary(big: bool) -> Vec<u8> {
        let order = if big { "binary_big_endian" } else { "binary_little_endian" };
        let mut out = format!("ply\nformat {order} 1.0\ncomment a\n{HEAD}").into_bytes();
        let mut put = |bytes: &[u8]| {
            let mut b = bytes.to_vec();
            if big {
                b.reverse();
            }
            out.extend(b);
        };
        for [x, y, z] in [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]] {
            put(&x.to_le_bytes());
            put(&y.to_le_bytes());
            put(&f64::from(z).to_le_bytes());
            put(&[7]);
        }
        for face in [&[0i32, 1, 2, 3][..], &[2, 1, 3]] {
            put(&[face.len() as u8]);
            face.iter().for_each(|k| put(&k.to_le_bytes()));
        }
        out
    }

    #[test]
    fn text_and_both_byte_orders_say_the_same() {
        let text =
            format!("ply\nformat ascii 1.0\n{HEAD}0 0 0 7\n1 0 0 7\n1 1 .5 7\n0 1 0 7\n4 0 1 2 3\n3 2 1 3\n");
        assert_eq!(read(text.as_bytes()).unwrap(), want());
        for big in [false, true] {
            assert_eq!(read(&binary(big)).unwrap(), want());
        }
    }

    #[test]
    fn what_is_damaged_is_refused() {
        let whole = binary(false);
        for end in 0..whole.len() {
            assert!(read(&whole[..end]).is_err(), "{end}");
        }
        let face = "element face 1\nproperty list uchar int vertex_indices\n";
        let text = |middle: &str, body: &str| format!("ply\nformat ascii 1.0\n{middle}end_header\n{body}");
        let vertex =
            |n: &str| format!("element vertex {n}\nproperty float x\nproperty float y\nproperty float z\n");
        let of = |text: String| read(text.as_bytes());
        assert_eq!(of(text(face, "3 0 1 2")), Err(PlyError::Face { face: 1, vertices: 0 }));
        assert_eq!(
            of(text(&(vertex("99999999999999") + face), "0 0 0")),
            Err(PlyError::Short { element: "vertex", row: 2, count: 99_999_999_999_999 })
        );
        assert!(matches!(of(text(&vertex("-1"), "")), Err(PlyError::Head { line: 3, .. })));
        assert_eq!(of(text(&vertex("1"), "0 x 0")), Err(PlyError::Number { element: "vertex", row: 1 }));
        assert_eq!(of(text(&vertex("1"), "0 nan 0")), Err(PlyError::NotFinite { vertex: 1 }));
        assert_eq!(
            of(text(&(vertex("1") + face), "0 0 0 2 0 0")),
            Err(PlyError::Face { face: 1, vertices: 1 })
        );
        assert_eq!(
            of(text(&(vertex("1") + face), "0 0 0 3 0 0 1")),
            Err(PlyError::Face { face: 1, vertices: 1 })
        );
        assert_eq!(of(text(&vertex("0"), "")), Err(PlyError::Missing("face with a list of vertex_indices")));
        // A list that says it is longer than any file, and elements of nothing.
        let long = "element face 1\nproperty list float int vertex_indices\n";
        assert!(matches!(of(text(&(vertex("1") + long), "0 0 0 1e300 0 0")), Err(PlyError::Short { .. })));
        assert!(of(text("element nothing 99999999999999\n", "")).is_err());
    }
}
