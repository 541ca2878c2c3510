//! Knot vectors and the polynomial pieces of B-spline basis functions.
//!
//! A basis of degree p over n poles has n + p + 1 knots and lives on `[t_p, t_n]`. Ends need not be clamped.

/// Largest degree: beyond it double precision has no digits left for the basis.
pub const MAX_DEGREE: usize = 25;

/// Why numbers are no knot vector.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum KnotError {
    /// Degree zero, above [`MAX_DEGREE`], or not below the number of poles.
    #[error("degree {degree} with {poles} poles: the degree must be at least 1, at most {MAX_DEGREE} and below the number of poles")]
    Degree {
        /// The degree.
        degree: usize,
        /// The number of poles.
        poles: usize,
    },
    /// Wrong number of knots.
    #[error("{got} knots where poles + degree + 1 = {need} are needed")]
    Count {
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// A knot that is not finite.
    #[error("knot {index} is {got}, not a finite number")]
    NotFinite {
        /// Which.
        index: usize,
        /// Its value.
        got: f64,
    },
    /// A knot below the one before.
    #[error("knot {index} is {got}, below the {before} before it")]
    Decreasing {
        /// Which.
        index: usize,
        /// Its value.
        got: f64,
        /// The one before.
        before: f64,
    },
    /// An inner knot repeated so often that the curve falls apart, or an empty domain.
    #[error("knot {at} stands {multiplicity} times, more than the {most} that degree {degree} allows")]
    Multiplicity {
        /// The knot.
        at: f64,
        /// How often it stands there.
        multiplicity: usize,
        /// How often it may.
        most: usize,
        /// The degree.
        degree: usize,
    },
}

/// A checked knot vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Knots {
    degree: usize,
    knots: Vec<f64>,
    /// Indices k of the non-empty spans `[t_k, t_(k+1)]` inside the domain.
    spans: Vec<usize>,
}

impl Knots {
    /// The basis of `degree` for `poles` poles.
    ///
    /// # Errors
    /// [`KnotError`].
    pub fn new(degree: usize, poles: usize, knots: Vec<f64>) -> Result<Self, KnotError> {
        if degree == 0 || degree > MAX_DEGREE || degree >= poles {
            return Err(KnotError::Degree { degree, poles });
        }
        // Counts may come from a damaged file: no overflow here.
        let need = poles.saturating_add(degree + 1);
        if knots.len() != need {
            return Err(KnotError::Count { got: knots.len(), need });
        }
        for (index, k) in knots.iter().enumerate() {
            if !k.is_finite() {
                return Err(KnotError::NotFinite { index, got: *k });
            }
            if index > 0 && *k < knots[index - 1] {
                return Err(KnotError::Decreasing { index, got: *k, before: knots[index - 1] });
            }
        }
        let spans: Vec<usize> = (degree..poles).filter(|k| knots[*k] < knots[*k + 1]).collect();
        let mut start = 0;
        while start < knots.len() {
            let run = knots[start..].iter().take_while(|k| **k == knots[start]).count();
            let inner = knots[start] > knots[degree] && knots[start] < knots[poles];
            let most = if inner { degree } else { degree + 1 };
            if run > most || spans.is_empty() {
                return Err(KnotError::Multiplicity { at: knots[start], multiplicity: run, most, degree });
            }
            start += run;
        }
        Ok(Self { degree, knots, spans })
    }

    /// The degree.
    #[must_use]
    pub const fn degree(&self) -> usize {
        self.degree
    }

    /// All knots.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.knots
    }

    /// Number of poles.
    #[must_use]
    pub fn poles(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Both ends of the domain.
    #[must_use]
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.poles()]]
    }

    /// Distinct knots of the domain, ascending, ends included.
    #[must_use]
    pub fn breaks(&self) -> Vec<f64> {
        let mut out: Vec<f64> = self.spans.iter().map(|k| self.knots[*k]).collect();
        out.push(self.domain()[1]);
        out
    }

    /// Number of non-empty spans.
    #[must_use]
    pub fn span_count(&self) -> usize {
        self.spans.len()
    }

    /// The ends of a non-empty span and the index of the first pole that acts on it.
    #[must_use]
    pub fn span(&self, index: usize) -> ([f64; 2], usize) {
        let k = self.spans[index];
        ([self.knots[k], self.knots[k + 1]], k - self.degree)
    }

    /// The non-empty span that holds `t`; the first or last one outside the domain. At an inner knot the span to
    /// the right.
    #[must_use]
    pub fn find(&self, t: f64) -> usize {
        self.spans.partition_point(|k| self.knots[*k] <= t).saturating_sub(1)
    }

    /// Polynomial coefficients of the `degree + 1` basis functions on a span, in powers of the local parameter
    /// `(t - lo) / (hi - lo)`: row r belongs to pole `first + r`.
    pub(crate) fn span_polynomials(&self, index: usize) -> Vec<Vec<f64>> {
        let k = self.spans[index];
        let (lo, h) = (self.knots[k], self.knots[k + 1] - self.knots[k]);
        // Cox-de Boor on polynomials: of degree d, the functions of poles k-d ..= k are not zero here.
        let mut rows: Vec<Vec<f64>> = vec![vec![1.0]];
        for d in 1..=self.degree {
            let mut next = vec![vec![0.0; d + 1]; d + 1];
            for (r, row) in rows.iter().enumerate() {
                // This row is pole i = k - d + 1 + r of degree d - 1, with support [t_i, t_(i+d)].
                let i = k + 1 + r - d;
                let (a, width) = (self.knots[i], self.knots[i + d] - self.knots[i]);
                // Rising factor into the same pole, falling factor into the pole before: local forms c0 + c1 s.
                let rise = [(lo - a) / width, h / width];
                let fall = [(self.knots[i + d] - lo) / width, -h / width];
                for (p, c) in row.iter().enumerate() {
                    next[r + 1][p] += c * rise[0];
                    next[r + 1][p + 1] += c * rise[1];
                    next[r][p] += c * fall[0];
                    next[r][p + 1] += c * fall[1];
                }
            }
            rows = next;
        }
        rows
    }
}
