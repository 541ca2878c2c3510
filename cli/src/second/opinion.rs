//! What a second opinion says.

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Opinion {
    /// Deepest point of the part in the cutter, in feed moves; negative where none is in it, zero where none is near.
    pub gouge_mm: f64,
    /// The face it is on; None where no feed move came near.
    pub on_face: Option<u32>,
    /// The point, mm.
    pub at_mm: Option<[f64; 3]>,
    /// The program's line, from 1.
    pub line: Option<usize>,
    /// The same for the cutter in rapids, which are taken to go straight as feed moves do.
    pub rapid_mm: f64,
    /// Its line; None where no rapid came near.
    pub rapid_line: Option<usize>,
    /// The same for shank and holder, in all moves.
    pub holder_mm: f64,
    /// Its line; None where neither came near.
    pub holder_line: Option<usize>,
    /// Most that stands over a point to machine, along its normal, the stock of the options at most.
    pub left_mm: f64,
    /// The face of that point; None where there is none to machine.
    pub left_face: Option<u32>,
    /// That point, mm.
    pub left_at_mm: Option<[f64; 3]>,
    /// Points to machine to which the cutter never came within the stock.
    pub uncut: usize,
    /// Frozen poses.
    pub poses: usize,
    /// Points of the part.
    pub points: usize,
    /// How far the tip is from one pose to the next where they are closest and it moves; zero where it never does.
    pub poses_apart_mm: f64,
    /// How far points are from their neighbours, but for one in a hundred.
    pub points_apart_mm: f64,
    /// By how much the figures may be off at the points; how it is found stands in `search`.
    pub slack_mm: f64,
    /// How much deeper a gouge may be between the points, for the corner of this tool.
    pub gouge_between_mm: f64,
    /// Corner radius, mm.
    pub corner_radius_mm: f64,
    /// Rapids from or to the machine's own places, which are not looked at.
    pub unseen_rapids: usize,
    /// Wall time.
    pub seconds: f64,
}

impl Opinion {
    /// What more than at the points may stand between them where ridges are this high.
    ///
    /// Between two passes of a corner of radius r a ridge of height h falls off with the slope `sqrt(2 h / r)` at its crest, and with
    /// the curvature 1/r from there on. The crest is half the diagonal of a square of points away from one at most.
    #[must_use]
    pub fn left_between_mm(&self, ridge_mm: f64) -> f64 {
        let aside = self.points_apart_mm * 0.5f64.sqrt();
        let r = self.corner_radius_mm;
        let falls = aside * (2.0 * ridge_mm.max(0.0) / r).sqrt() + 0.5 * aside * aside / r;
        // Of a sharp edge the formula says nothing; ridges steeper than that are walls.
        if falls.is_finite() { falls.min(aside) } else { aside }
    }
}
