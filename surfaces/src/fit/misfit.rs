//! How far points are from what was fitted to them, and why nothing was.

/// How far points are from what was fitted to them, at their own parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Misfit {
    /// Of the worst point, in the unit of the points (mm).
    pub max_mm: f64,
    /// Root of the mean square.
    pub rms_mm: f64,
}

impl Misfit {
    pub(super) fn of(distances: impl Iterator<Item = f64>) -> Self {
        let (mut max_mm, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
        for d in distances {
            max_mm = max_mm.max(d);
            sum += d * d;
            count += 1.0;
        }
        Self { max_mm, rms_mm: if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 } }
    }
}

/// Why points give no curve or surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Too few points for the degree, or a degree that is zero or too high.
    #[error(
        "degree {degree} over {points} points: at least {need} points and a degree from 1 to {most} are needed"
    )]
    Degree {
        /// The degree.
        degree: usize,
        /// The points there are.
        points: usize,
        /// The points needed.
        need: usize,
        /// The highest degree.
        most: usize,
    },
    /// A number of poles that the points do not determine.
    #[error("{poles} poles of degree {degree} over {points} points: {least} to {most} are possible")]
    Poles {
        /// The number asked for.
        poles: usize,
        /// The degree.
        degree: usize,
        /// The points.
        points: usize,
        /// Fewest poles.
        least: usize,
        /// Most poles.
        most: usize,
    },
    /// End conditions that only a cubic has.
    #[error("these end conditions belong to a cubic, not to degree {degree}")]
    Ends {
        /// The degree asked for.
        degree: usize,
    },
    /// Points that are not as many as the grid's counts say.
    #[error("{got} points where the counts of the grid ask for {need}")]
    Count {
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// A coordinate that is not a finite number.
    #[error("point {index} has the coordinate {got}, not a finite number")]
    NotFinite {
        /// Which point, from 0.
        index: usize,
        /// The coordinate.
        got: f64,
    },
    /// Two neighbours in one place: their parameters would be equal.
    #[error("points {index} and {} stand in one place: leave one out", index + 1)]
    Coincident {
        /// The first of the two, from 0.
        index: usize,
    },
    /// Too few sections.
    #[error("{got} sections: at least {need} are needed")]
    Sections {
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// A tolerance that is not positive or that all the poles allowed do not reach.
    #[error("a tolerance of {tolerance_mm} mm is not reached: {poles} poles are {reached_mm} mm off")]
    Tolerance {
        /// The tolerance.
        tolerance_mm: f64,
        /// The most poles tried.
        poles: usize,
        /// What they reach.
        reached_mm: f64,
    },
    /// The equations have no unique solution to the digits of double precision.
    #[error("the {unknowns} equations for the poles have no unique solution: spread the points more evenly")]
    Singular {
        /// Number of unknowns.
        unknowns: usize,
    },
}
