//! `[part]` of a job: where the part comes from and which of its faces are meant.

use crate::failure::Failure;
use crate::job::builtin::{self, Builtin};
use crate::job::problem::Places;
use crate::job::raw;
pub use crate::job::raw::{FaceChoice, Largest};
use crate::job::words::{MaterialWord, Normals};
use crate::job::words::{nearest, not_known};
use crate::job::{flank, stock};
use std::path::PathBuf;

/// The table's name.
const TABLE: &str = "part";

/// Where a part comes from.
#[derive(Debug, Clone)]
pub enum Source {
    /// A file that was there when the job was read.
    File {
        /// The file.
        path: PathBuf,
        /// Millimetres in its unit, where the job says it.
        unit_mm: Option<f64>,
    },
    /// A built-in surface.
    Builtin(Builtin),
    /// The surface between two curves.
    Ruled(Builtin),
}

/// The part of a job.
#[derive(Debug, Clone)]
pub struct Part {
    source: Source,
    faces: Option<FaceChoice>,
    check_faces: Option<FaceChoice>,
    may_hit: Option<FaceChoice>,
    normals: Normals,
    sides: Vec<(String, MaterialWord)>,
}

impl Part {
    pub(super) fn of(places: &Places, t: &raw::Part) -> Result<Self, Failure> {
        let source = match (&t.file, &t.builtin, &t.ruled) {
            (Some(file), None, None) => {
                Source::File { path: stock::present(places, TABLE, "file", file)?, unit_mm: t.unit_mm }
            }
            (None, Some(table), None) => {
                let wrong = |e: String| match not_known(&e) {
                    Some((kind, written, known)) => {
                        let all = known.join(", ");
                        let what = format!("builtin: there is no {kind} {written}; there are {all}");
                        places.full(TABLE, "builtin", what, all, nearest(written, known))
                    }
                    None => places.refuse(TABLE, "builtin", format!("builtin: {e}")),
                };
                Source::Builtin(builtin::build(table).map_err(wrong)?)
            }
            (None, None, Some(table)) => {
                let surface = flank::strip(places, table)?;
                Source::Ruled(Builtin { kind: "ruled", surface, spline: None })
            }
            (None, None, None) => {
                let what = "needs file = \"...\", builtin = { ... } or [part.ruled]";
                return Err(places.refuse(TABLE, "", what));
            }
            _ => {
                let what = "has several of file, builtin and ruled; keep one of them";
                return Err(places.refuse(TABLE, "", what));
            }
        };
        if t.unit_mm.is_some() && !matches!(source, Source::File { .. }) {
            return Err(places.refuse(TABLE, "unit_mm", "unit_mm goes with file: leave it out"));
        }
        if matches!(&t.faces, Some(FaceChoice::Ids(ids)) if ids.is_empty()) {
            return Err(places.refuse(TABLE, "faces", "faces = [] chooses no face"));
        }
        Self::clear(places, t)?;
        let sides = t.side.as_ref().map(raw::Sides::each).unwrap_or_default();
        if t.side.is_some() && !matches!(source, Source::File { .. }) {
            return Err(places.refuse(
                TABLE,
                "side",
                "[[part.side]] goes with file: what is built in has its side",
            ));
        }
        if let Some((k, (id, _))) =
            sides.iter().enumerate().find(|(k, (id, _))| sides[..*k].iter().any(|s| s.0 == *id))
        {
            let what = format!("[[part.side]] names {id} again (entry {} of all ids): name it once", k + 1);
            return Err(places.refuse(TABLE, "side", what));
        }
        Ok(Self {
            source,
            faces: t.faces.clone(),
            check_faces: t.check_faces.clone(),
            may_hit: t.may_hit.clone(),
            normals: t.normals,
            sides,
        })
    }

    /// Refuses faces that are named both as what the tool may hit and as what it must not.
    fn clear(places: &Places, t: &raw::Part) -> Result<(), Failure> {
        let named = ids(t.may_hit.as_ref());
        for (key, other) in [("faces", &t.faces), ("check_faces", &t.check_faces)] {
            if let Some(both) = ids(other.as_ref()).iter().find(|id| **id != "all" && named.contains(id)) {
                let what = format!("may_hit names {both}, which {key} names too: take it out of one of them");
                return Err(places.refuse(TABLE, "may_hit", what));
            }
        }
        Ok(())
    }

    /// Where it comes from.
    #[must_use]
    pub const fn source(&self) -> &Source {
        &self.source
    }

    /// Faces to machine; all where not given.
    #[must_use]
    pub const fn faces(&self) -> Option<&FaceChoice> {
        self.faces.as_ref()
    }

    /// Faces that the tool must not touch, where the job names some.
    #[must_use]
    pub const fn check_faces(&self) -> Option<&FaceChoice> {
        self.check_faces.as_ref()
    }

    /// Faces that are not machined and that the tool may cut or hit: ids, or "all" others.
    #[must_use]
    pub const fn may_hit(&self) -> Option<&FaceChoice> {
        self.may_hit.as_ref()
    }

    /// The side of the material for faces whose file does not say it.
    #[must_use]
    pub const fn normals(&self) -> Normals {
        self.normals
    }

    /// Faces whose side the job says one by one, with that side.
    #[must_use]
    pub fn sides(&self) -> &[(String, MaterialWord)] {
        &self.sides
    }
}

fn ids(choice: Option<&FaceChoice>) -> Vec<&str> {
    match choice {
        Some(FaceChoice::Word(w)) => vec![w.as_str()],
        Some(FaceChoice::Ids(all)) => all.iter().map(String::as_str).collect(),
        _ => Vec::new(),
    }
}
