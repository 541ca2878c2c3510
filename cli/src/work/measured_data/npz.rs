//! Arrays as NumPy's `.npz`: a zip whose members are `.npy` files, not packed (NumPy's format 1.0; zip as in APPNOTE 6.3).

use super::cloud::{Cloud, Numbers};
use std::fmt::Write;

/// The archive of a cloud: `points`, its columns, `chains` with first and one past the last point of each, and its names.
pub fn bytes(cloud: &Cloud) -> Vec<u8> {
    let n = cloud.points.len();
    let reals = |all: &mut dyn Iterator<Item = f64>| all.flat_map(f64::to_le_bytes).collect::<Vec<u8>>();
    let mut members =
        vec![("points".to_owned(), npy("<f8", &[n, 3], &reals(&mut cloud.points.iter().flatten().copied())))];
    for column in &cloud.columns {
        let shape: &[usize] = if column.width == 1 { &[n] } else { &[n, column.width] };
        let (kind, body) = match &column.numbers {
            Numbers::Real(all) => ("<f8", reals(&mut all.iter().copied())),
            Numbers::Whole(all) => ("<i4", all.iter().flat_map(|k| k.to_le_bytes()).collect()),
        };
        members.push((column.name.to_owned(), npy(kind, shape, &body)));
    }
    if !cloud.chains.is_empty() {
        let ends = cloud.chains.iter().flat_map(|c| [c.start as i64, c.end as i64]);
        let body: Vec<u8> = ends.flat_map(i64::to_le_bytes).collect();
        members.push(("chains".to_owned(), npy("<i8", &[cloud.chains.len(), 2], &body)));
    }
    if let Some((name, all)) = &cloud.names {
        // Text of one length, four bytes a character, as NumPy has it.
        let longest = all.iter().map(|t| t.chars().count()).max().unwrap_or(0).max(1);
        let padded = all.iter().flat_map(|t| t.chars().chain(std::iter::repeat('\0')).take(longest));
        let body: Vec<u8> = padded.flat_map(|c| u32::from(c).to_le_bytes()).collect();
        members.push(((*name).to_owned(), npy(&format!("<U{longest}"), &[all.len()], &body)));
    }
    zip(&members)
}

/// An array as NumPy writes it: its kind and shape in words, then its numbers.
fn npy(kind: &str, shape: &[usize], body: &[u8]) -> Vec<u8> {
    let mut sizes = String::new();
    shape.iter().for_each(|k| {
        let _ = write!(sizes, "{k}, ");
    });
    let mut head = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({sizes}), }}");
    // Numbers begin at a multiple of 64 bytes, the ten of the preamble counted.
    let long = (10 + head.len() + 1).next_multiple_of(64) - 11;
    head = format!("{head:long$}\n");
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((head.len() as u16).to_le_bytes());
    out.extend(head.as_bytes());
    out.extend(body);
    out
}

/// CRC-32 of each byte, reflected, polynomial 0xEDB88320.
const CRC: [u32; 256] = {
    let mut table = [0_u32; 256];
    let mut k = 0;
    while k < 256 {
        let mut c = k as u32;
        let mut bit = 0;
        while bit < 8 {
            c = if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 };
            bit += 1;
        }
        table[k] = c;
        k += 1;
    }
    table
};

fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |c, b| CRC[((c ^ u32::from(*b)) & 0xff) as usize] ^ (c >> 8))
}

/// The first day that a zip can name.
const DAY: u16 = 0x21;

/// An archive of members that are not packed. Each is smaller than 4 GiB: a verdict has some ten million samples at most.
fn zip(members: &[(String, Vec<u8>)]) -> Vec<u8> {
    let (mut out, mut list) = (Vec::new(), Vec::new());
    for (name, body) in members {
        let name = format!("{name}.npy");
        let at = out.len() as u32;
        // Version 2.0, no flags, not packed, midnight of the first day.
        let mut common = Vec::new();
        [20, 0, 0, 0, DAY].iter().for_each(|x: &u16| common.extend(x.to_le_bytes()));
        [crc(body), body.len() as u32, body.len() as u32].iter().for_each(|x| common.extend(x.to_le_bytes()));
        [name.len() as u16, 0].iter().for_each(|x| common.extend(x.to_le_bytes()));
        out.extend(b"PK\x03\x04");
        out.extend(&common);
        out.extend(name.as_bytes());
        out.extend(body);
        list.extend(b"PK\x01\x02\x14\x00");
        list.extend(&common);
        // No comment, first disk, no attributes.
        list.extend([0; 10]);
        list.extend(at.to_le_bytes());
        list.extend(name.as_bytes());
    }
    let (begin, size, count) = (out.len() as u32, list.len() as u32, members.len() as u16);
    out.extend(list);
    out.extend(b"PK\x05\x06\x00\x00\x00\x00");
    [count, count].iter().for_each(|x| out.extend(x.to_le_bytes()));
    [size, begin].iter().for_each(|x| out.extend(x.to_le_bytes()));
    out.extend([0; 2]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of the CRC catalogue.
    #[test]
    fn the_checksum_is_that_of_zip() {
        assert_eq!(crc(b"123456789"), 0xCBF4_3926);
        assert_eq!(crc(b""), 0);
    }

    #[test]
    fn numbers_begin_at_multiples_of_64_bytes() {
        for shape in [&[3][..], &[1_000_000, 3], &[0]] {
            let made = npy("<f8", shape, &[1, 2, 3, 4, 5, 6, 7, 8]);
            assert_eq!((made.len() - 8) % 64, 0, "{shape:?}");
            assert_eq!(made[made.len() - 9], b'\n');
            assert_eq!(usize::from(u16::from_le_bytes([made[8], made[9]])), made.len() - 8 - 10);
        }
    }
}
