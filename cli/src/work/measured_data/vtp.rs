//! Points and chains as VTK's XML for polygonal data (`.vtp`, file format 1.0): the head as text, the numbers after it as they are.

use super::cloud::{Cloud, Numbers};
use std::fmt::Write;

/// Numbers after the head: each array with its size before it.
#[derive(Default)]
struct Appended {
    bytes: Vec<u8>,
}

impl Appended {
    /// Appends an array; where it stands.
    fn put(&mut self, bytes: &[u8]) -> usize {
        let at = self.bytes.len();
        self.bytes.extend((bytes.len() as u64).to_le_bytes());
        self.bytes.extend(bytes);
        at
    }
}

/// The file of a cloud. Points that stand alone are vertices, chains are lines. The names that a column counts are not in it.
pub fn bytes(cloud: &Cloud) -> Vec<u8> {
    let mut data = Appended::default();
    let n = cloud.points.len();
    let array = |name: &str, kind: &str, width: usize, at: usize| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{width}\" format=\"appended\" offset=\"{at}\"/>\n"
        )
    };
    let reals = |all: &mut dyn Iterator<Item = f64>| all.flat_map(f64::to_le_bytes).collect::<Vec<u8>>();
    let whole = |all: &mut dyn Iterator<Item = usize>| {
        all.flat_map(|k| (k as i64).to_le_bytes()).collect::<Vec<u8>>()
    };
    let mut values = String::new();
    for column in &cloud.columns {
        let (kind, body) = match &column.numbers {
            Numbers::Real(all) => ("Float64", reals(&mut all.iter().copied())),
            Numbers::Whole(all) => ("Int32", all.iter().flat_map(|k| k.to_le_bytes()).collect()),
        };
        values += &array(column.name, kind, column.width, data.put(&body));
    }
    let points = array("points", "Float64", 3, data.put(&reals(&mut cloud.points.iter().flatten().copied())));
    let alone = cloud.chains.is_empty();
    let ends: Vec<usize> = if alone {
        (1..=n).collect()
    } else {
        let lengths = cloud.chains.iter().map(ExactSizeIterator::len);
        lengths
            .scan(0, |sum, l| {
                *sum += l;
                Some(*sum)
            })
            .collect()
    };
    let members =
        if alone { whole(&mut (0..n)) } else { whole(&mut cloud.chains.iter().flat_map(Clone::clone)) };
    let cells = array("connectivity", "Int64", 1, data.put(&members))
        + &array("offsets", "Int64", 1, data.put(&whole(&mut ends.iter().copied())));
    let (what, count) = if alone { ("Verts", n) } else { ("Lines", cloud.chains.len()) };
    let counts = if alone {
        format!("NumberOfVerts=\"{count}\" NumberOfLines=\"0\"")
    } else {
        format!("NumberOfVerts=\"0\" NumberOfLines=\"{count}\"")
    };
    let first = cloud.columns.first().map_or("", |c| c.name);
    let mut out = String::new();
    let _ = write!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n\
         <Piece NumberOfPoints=\"{n}\" {counts} NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n\
         <PointData Scalars=\"{first}\">\n{values}</PointData>\n<Points>\n{points}</Points>\n<{what}>\n{cells}</{what}>\n\
         </Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_"
    );
    let mut out = out.into_bytes();
    out.extend(data.bytes);
    out.extend(b"\n</AppendedData>\n</VTKFile>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::super::cloud::Column;
    use super::*;

    /// Where the head says that an array stands, its size does.
    #[test]
    fn offsets_lead_to_arrays() {
        let cloud = Cloud {
            points: vec![[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [6.0, 7.0, 8.0]],
            chains: vec![0..2, 1..3],
            columns: vec![Column::real("depth_mm", 1, [0.5, 0.25, 0.125]), Column::whole("line", [1, 2, 3])],
            names: None,
        };
        let made = bytes(&cloud);
        let mark = b"encoding=\"raw\">\n_";
        let begin = made.windows(mark.len()).position(|w| w == mark).expect("a mark") + mark.len();
        let head = String::from_utf8_lossy(&made[..begin]).into_owned();
        let sizes: Vec<u64> = head
            .split("offset=\"")
            .skip(1)
            .map(|rest| {
                let at =
                    begin + rest.split('"').next().and_then(|x| x.parse::<usize>().ok()).expect("a number");
                u64::from_le_bytes(made[at..at + 8].try_into().expect("eight bytes"))
            })
            .collect();
        // Three reals, three whole numbers, nine coordinates, four members and two ends of chains.
        assert_eq!(sizes, [24, 12, 72, 32, 16]);
        assert!(head.contains("NumberOfLines=\"2\"") && head.contains("<Lines>"));
    }
}
