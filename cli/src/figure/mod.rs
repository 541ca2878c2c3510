//! Figures a person would put in a paper: the characteristic lines of a face as SVG, after figures a to f of M86.
//!
//! [`Study`] computes what is drawn, [`Scene`](scene::Scene) projects it and hides what lies behind, [`panel`] draws one
//! figure, [`postures`] paints the best posture of a tool over the face, [`fixed_axis`] where
//! it is undercut with its axis held, [`axes`] a field of axes, [`sheet`] sets figures on a page;
//! [`directions`] maps what a tool may do at one place, [`indicatrices`] draws how part and tool bend at a contact. Coordinates are
//! written in tenths of a pixel, as integers, so that the same input gives the same bytes.

pub mod axes;
mod cells;
pub mod directions;
pub mod drawing;
pub mod fixed_axis;
pub mod indicatrices;
pub mod json;
pub mod levels;
pub mod panel;
pub mod postures;
pub mod scene;
pub mod sheet;
pub mod study;

pub use panel::Panel;
pub use sheet::{page, single};
pub use study::{Study, Wanted};
