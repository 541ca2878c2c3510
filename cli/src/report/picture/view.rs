//! How to look at the part.

use crate::report::project::Direction;

/// What the surface's colours say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PartColours {
    /// The deviation.
    #[default]
    Deviation,
    /// Nothing but its shape.
    Plain,
    /// The further quantity of this number among those of the report.
    Quantity(usize),
}

/// What the path's colours say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PathColours {
    /// No path.
    Hidden,
    /// Nothing but its way.
    #[default]
    Plain,
    /// The strip width.
    StripWidth,
}

/// From where parts are looked at usually: a little to the right of the front, from above.
pub const USUAL: Direction = Direction { azimuth_deg: -52.0, elevation_deg: 34.0 };

/// How to look at the part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct View {
    /// From where; `None`: the side from which most of what is machined is seen.
    pub direction: Option<Direction>,
    /// Width of the picture, px.
    pub width_px: u32,
    /// Height of the picture, px.
    pub height_px: u32,
    /// What the surface's colours say.
    pub part: PartColours,
    /// What the path's colours say.
    pub path: PathColours,
    /// With the links and rapids.
    pub links: bool,
    /// With the tool, at this share of the path from 0 to 1.
    pub tool_at: Option<f64>,
}

impl Default for View {
    fn default() -> Self {
        Self {
            direction: None,
            width_px: 960,
            height_px: 600,
            part: PartColours::Deviation,
            path: PathColours::Plain,
            links: false,
            tool_at: Some(0.62),
        }
    }
}
