//! What `flank` needs beside its verb: the keys of its job, the face, the methods, radii and spans, and the path.

pub mod face;
pub mod largest;
pub mod methods;
pub mod path;
pub mod ratio;
pub mod span;
