//! What a part is known by again: its faces, by places on them.

use crate::part::Loaded;
use osculate_tools::removal::stock::sum_of;

/// Places on a face along each of its sides.
const PLACES: u32 = 3;
/// Coordinates count to this, mm: far below what any two parts differ by.
const COUNTS_MM: f64 = 1e-4;

impl Loaded {
    /// The part as a word: another part has another one.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        let mut bytes = Vec::new();
        for face in &self.faces {
            let domain = osculate_geom::Surface::domain(&*face.surface);
            bytes.extend(face.id.bytes());
            for k in 0..PLACES * PLACES {
                let at = |k: u32| f64::from(k) / f64::from(PLACES - 1);
                let p =
                    osculate_geom::Surface::point(&*face.surface, domain.at(at(k % PLACES), at(k / PLACES)));
                // Casting takes what is too far for a whole number to the last one.
                bytes.extend(p.iter().flat_map(|x| ((x / COUNTS_MM).round() as i64).to_le_bytes()));
            }
        }
        format!("{:016x}", sum_of(&bytes))
    }
}
