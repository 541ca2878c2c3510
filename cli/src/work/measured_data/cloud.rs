//! Points with named numbers, whatever file they go into.

/// Numbers of all points, so many for each.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Numbers {
    /// With a fraction.
    Real(Vec<f64>),
    /// Whole.
    Whole(Vec<i32>),
}

/// A quantity over points.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name, with its unit.
    pub name: &'static str,
    /// How many numbers each point has.
    pub width: usize,
    /// The numbers, point by point.
    pub numbers: Numbers,
}

impl Column {
    /// Of numbers with a fraction, so many a point.
    pub fn real(name: &'static str, width: usize, numbers: impl IntoIterator<Item = f64>) -> Self {
        Self { name, width, numbers: Numbers::Real(numbers.into_iter().collect()) }
    }

    /// Of whole numbers, one a point.
    pub fn whole(name: &'static str, numbers: impl IntoIterator<Item = i32>) -> Self {
        Self { name, width: 1, numbers: Numbers::Whole(numbers.into_iter().collect()) }
    }
}

/// Points with what is known of them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Cloud {
    /// Where they are, mm.
    pub points: Vec<[f64; 3]>,
    /// Chains of points that follow each other; none where each point stands alone.
    pub chains: Vec<std::ops::Range<usize>>,
    /// Quantities over the points.
    pub columns: Vec<Column>,
    /// Names that a column counts, with what they are called together.
    pub names: Option<(&'static str, Vec<String>)>,
}
