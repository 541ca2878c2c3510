//! What `flank` needs beside its verb: the keys of its job, the face, the methods and the path.

pub mod face;
pub mod largest;
pub mod methods;
pub mod path;
