//! One file of a ZIP archive, stored or deflated, with a bound on what it unpacks to.
//!
//! Read are the directory at the end of the archive and the entries that it names; encrypted entries, archives of several volumes and
//! those beyond 4 GiB are not.

/// An archive that cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ZipError {
    /// No directory at the end.
    #[error("the archive has no directory at its end: it is truncated")]
    NoDirectory,
    /// An entry that lies outside the archive or is of a kind that is not read.
    #[error("an entry of the archive is damaged, encrypted or packed in a way that is not read")]
    Entry,
    /// Packed bytes that are none, or unpack to more than is allowed.
    #[error("an entry of the archive does not unpack, or to more than {most} bytes")]
    Packed {
        /// What it may unpack to.
        most: usize,
    },
}

/// Bytes before the entry's name in the directory, and in the entry itself.
const HEADS: [usize; 2] = [46, 30];
/// Bytes of the record that ends an archive, and of the longest comment after it.
const END: [usize; 2] = [22, 65_535];

/// An entry of an archive.
pub(super) struct Entry<'a> {
    pub(super) name: &'a [u8],
    method: usize,
    packed: &'a [u8],
}

fn number(bytes: &[u8], at: usize, size: usize) -> Option<usize> {
    let own = bytes.get(at..at.checked_add(size)?)?;
    Some(own.iter().rev().fold(0, |sum, b| sum << 8 | usize::from(*b)))
}

/// The entries of an archive.
pub(super) fn entries(bytes: &[u8]) -> Result<Vec<Entry<'_>>, ZipError> {
    let [record, comment] = END;
    let from = bytes.len().saturating_sub(record + comment);
    let tail = &bytes[from..];
    let end =
        tail.windows(4).rposition(|w| w == b"PK\x05\x06").map(|k| from + k).ok_or(ZipError::NoDirectory)?;
    let of = |at: usize, size: usize| number(bytes, end + at, size).ok_or(ZipError::NoDirectory);
    // Its last number, the length of a comment, is there too.
    let (count, mut at, _) = (of(10, 2)?, of(16, 4)?, of(20, 2)?);
    let mut out = Vec::new();
    for _ in 0..count {
        let [head, local_head] = HEADS;
        let own = |k: usize, size: usize| number(bytes, at.saturating_add(k), size).ok_or(ZipError::Entry);
        if bytes.get(at..at.saturating_add(4)) != Some(b"PK\x01\x02") {
            return Err(ZipError::Entry);
        }
        let (flags, method, size, local) = (own(8, 2)?, own(10, 2)?, own(20, 4)?, own(42, 4)?);
        let lengths = [own(28, 2)?, own(30, 2)?, own(32, 2)?];
        let name = bytes.get(at + head..at + head + lengths[0]).ok_or(ZipError::Entry)?;
        at += head + lengths.iter().sum::<usize>();
        if bytes.get(local..local.saturating_add(4)) != Some(b"PK\x03\x04") || flags & 1 == 1 {
            return Err(ZipError::Entry);
        }
        let more = |k: usize| number(bytes, local + k, 2).ok_or(ZipError::Entry);
        let begin = local + local_head + more(26)? + more(28)?;
        let packed = bytes.get(begin..begin.saturating_add(size)).ok_or(ZipError::Entry)?;
        out.push(Entry { name, method, packed });
    }
    Ok(out)
}

impl Entry<'_> {
    /// What the entry unpacks to, at most so many bytes.
    pub(super) fn unpacked(&self, most: usize) -> Result<Vec<u8>, ZipError> {
        match self.method {
            0 if self.packed.len() <= most => Ok(self.packed.to_vec()),
            8 => miniz_oxide::inflate::decompress_to_vec_with_limit(self.packed, most)
                .map_err(|_| ZipError::Packed { most }),
            0 => Err(ZipError::Packed { most }),
            _ => Err(ZipError::Entry),
        }
    }
}
