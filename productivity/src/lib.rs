//! Strip-width formulas, productivity and tool-path planning.
pub mod closed_form;
pub mod plan;
