//! Surfaces by name: the papers' test surfaces and classical ones with known lines.
//!
//! - `m86-1` to `m86-4` have the features that M86 tells of its four surfaces. The paper prints pictures and no control
//!   points; the points here are of our own design, with the same features: see [`m86`].
//! - `d98-eq18`, `d98-liu` and `d98-hyperbolic` are the ruled surfaces of D98, in the paper's parameters: see
//!   [`d98_eq18`].
//! - The monkey saddle and Enneper's surface have lines of curvature in closed form, and so have [`Ellipsoid`] and
//!   [`Torus`], which are analytic surfaces of their own.

mod bicubic;
mod directrices;
mod ruled;

pub use bicubic::{enneper, m86, monkey_saddle};
pub use directrices::{
    FormulaCurve, LiuSize, ParaboloidSize, eq18_directrices, liu_directrices, paraboloid_directrices,
};
pub use osculate_geom::analytic::{Ellipsoid, Torus};
pub use ruled::{Eq18, HyperbolicSize, d98_eq18, d98_hyperbolic, d98_liu};

/// What is special about a surface of the gallery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// What is known about it.
    pub properties: &'static str,
    /// The keys that a builtin of this kind takes beyond the common ones, with values to start from.
    pub keys: &'static str,
}

/// All surfaces with a name, in the order in which they are listed.
///
/// ```
/// use osculate_surfaces::gallery;
/// assert!(gallery::ENTRIES.iter().any(|e| e.name == "m86-3" && e.source == "M86, surface 3"));
/// ```
pub const ENTRIES: [Entry; 12] = [
    Entry {
        name: "m86-1",
        source: "M86, surface 1",
        properties: "no umbilic, no contour minimum; lines of curvature nearly parallel to lines of constant k1 - k2",
        keys: "",
    },
    Entry {
        name: "m86-2",
        source: "M86, surface 2",
        properties: "no umbilic, no contour minimum; k1 - k2 has an extremum inside",
        keys: "",
    },
    Entry {
        name: "m86-3",
        source: "M86, surface 3",
        properties: "one umbilic (lemon), one contour minimum",
        keys: "",
    },
    Entry {
        name: "m86-4",
        source: "M86, surface 4",
        properties: "two umbilics (lemons), one contour minimum",
        keys: "",
    },
    Entry {
        name: "d98-eq18",
        source: "D98, eq. 18",
        properties: "ruled; the printed example at u = 0.4 with R = 40 is impossible",
        keys: "",
    },
    Entry {
        name: "d98-liu",
        source: "D98, 4.2, after Liu",
        properties: "ruled between a line and a parabola, u from 0 to 23.014 mm",
        keys: "",
    },
    Entry {
        name: "d98-hyperbolic",
        source: "D98, fig. 7",
        properties: "hyperbolic paraboloid; the normals at both ends of the middle rule enclose alpha with their bisector",
        keys: "h_mm = 80, alpha_deg = 30",
    },
    Entry {
        name: "monkey_saddle",
        source: "classical",
        properties: "z = x^3 - 3 x y^2, scaled: one umbilic, a star of index -1/2, at a degenerate saddle",
        keys: "",
    },
    Entry {
        name: "enneper",
        source: "classical",
        properties: "minimal; the parameter lines are the lines of curvature, no umbilic",
        keys: "",
    },
    Entry {
        name: "ellipsoid",
        source: "classical",
        properties: "four lemons for three different axes; lines of curvature on confocal quadrics",
        keys: "semi_axes_mm = [3, 2, 1]",
    },
    Entry {
        name: "torus",
        source: "classical",
        properties: "no umbilic; its circles are the lines of curvature, parabolic on top and bottom",
        keys: "major_radius_mm = 5, minor_radius_mm = 2",
    },
    Entry {
        name: "paraboloid",
        source: "classical",
        properties: "two lemons for a, b > 0 and different; gradient lines y = c x^(b/a)",
        keys: "a_per_mm = 0.01, b_per_mm = 0.0125, half_size_mm = 40",
    },
];
