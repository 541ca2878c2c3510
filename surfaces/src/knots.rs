//! Knot vectors of B-spline curves and surfaces.
//!
//! A basis of degree p over n poles has n + p + 1 knots `t_0 <= t_1 <= ...` and lives on `[t_p, t_n]`. The
//! ends may be clamped (p + 1 equal knots) or not, so that periodic splines written out in full are knot
//! vectors too.
//!
//! Source: [Piegl & Tiller, The NURBS Book, chapter 2].

/// Largest degree: above it a basis function's value keeps too few digits, and no CAD system writes one.
pub const MAX_DEGREE: usize = 25;

/// Why numbers are no knot vector.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnotError {
    /// Degree zero, above [`MAX_DEGREE`], or not below the number of poles.
    #[error("degree {degree} over {poles} poles: it must be 1 to {MAX_DEGREE} and below the number of poles")]
    Degree {
        /// The degree.
        degree: usize,
        /// The number of poles.
        poles: usize,
    },
    /// Wrong number of knots, multiple knots written out.
    #[error("{got} knots, but poles + degree + 1 = {need} are needed (write multiple knots out)")]
    Count {
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// A knot that is not a finite number.
    #[error("knot {index} is {got}, not a finite number")]
    NotFinite {
        /// Which, from 0.
        index: usize,
        /// Its value.
        got: f64,
    },
    /// A knot below the one before.
    #[error("knot {index} is {got}, below the {before} before it")]
    Decreasing {
        /// Which, from 0.
        index: usize,
        /// Its value.
        got: f64,
        /// The one before.
        before: f64,
    },
    /// A knot repeated so often that the curve falls apart there.
    #[error("knot {at} stands {multiplicity} times, but only {most} are possible there with degree {degree}")]
    Multiplicity {
        /// The knot.
        at: f64,
        /// How often it stands there.
        multiplicity: usize,
        /// How often it may: the degree inside the domain, one more at its ends and beyond.
        most: usize,
        /// The degree.
        degree: usize,
    },
    /// The domain `[t_p, t_n]` has no length, or one that double precision cannot hold.
    #[error("the domain is [{lo}, {hi}]: its length must be positive and finite")]
    Empty {
        /// `t_p`.
        lo: f64,
        /// `t_n`.
        hi: f64,
    },
}

/// A checked knot vector.
///
/// ```
/// use osculate_surfaces::{KnotError, Knots};
/// // A clamped quadratic of two spans: 0 0 0, 1, 2 2 2.
/// let knots = Knots::new(2, 4, vec![0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0])?;
/// assert_eq!((knots.domain(), knots.span_count(), knots.multiplicity(2.0)), ([0.0, 2.0], 2, 3));
/// // At a break the span to its right.
/// assert_eq!((knots.find(0.5), knots.find(1.0)), (0, 1));
/// // Multiple knots are written out.
/// assert!(matches!(Knots::new(2, 4, vec![0.0, 1.0, 2.0]), Err(KnotError::Count { need: 7, got: 3 })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Knots {
    degree: usize,
    knots: Vec<f64>,
    /// Indices k of the spans `[t_k, t_(k+1)]` of the domain that are not empty.
    spans: Vec<usize>,
    /// Distinct knots of the domain: `spans` is where they stand.
    breaks: Vec<f64>,
    /// Where to look for a parameter's span.
    lookup: Lookup,
}

/// A table of equal buckets over the domain, so that a span is found without a search.
#[derive(Clone, Debug, PartialEq)]
struct Lookup {
    /// Buckets per parameter.
    scale: f64,
    /// For each bucket the last span that begins in an earlier one.
    first: Vec<u32>,
    /// For each span where the next one begins, infinity for the last.
    next: Vec<f64>,
    /// No bucket has more than one break.
    single: bool,
}

/// Buckets for each span: with evenly spaced knots at most one begins in a bucket.
const BUCKETS: usize = 4;

/// Most buckets: 16 kB.
const MAX_BUCKETS: usize = 4096;

impl Lookup {
    fn new(breaks: &[f64]) -> Self {
        let spans = breaks.len() - 1;
        let lo = breaks[0];
        let count = (BUCKETS * spans).min(MAX_BUCKETS);
        let scale = count as f64 / (breaks[spans] - lo);
        // A domain too short for that ends in one bucket and a walk.
        let scale = if scale.is_finite() { scale } else { 0.0 };
        let mut first = vec![0; count];
        let (mut single, mut last) = (true, 0);
        for (span, t) in breaks[..spans].iter().enumerate() {
            // The very expression that finds a bucket: it grows with t, so that a parameter in a later bucket
            // is above this break.
            let bucket = (((t - lo) * scale) as usize).min(count - 1);
            // The first break is no step, so that another one may share its bucket.
            single &= span < 2 || bucket > last;
            last = bucket;
            if let Some(f) = first.get_mut(bucket + 1) {
                *f = span as u32;
            }
        }
        for k in 1..count {
            first[k] = first[k].max(first[k - 1]);
        }
        let next = breaks[1..spans].iter().copied().chain([f64::INFINITY]).collect();
        Self { scale, first, next, single }
    }
}

impl Knots {
    /// The knot vector of `degree` for `poles` poles.
    ///
    /// # Errors
    /// [`KnotError`].
    pub fn new(degree: usize, poles: usize, knots: Vec<f64>) -> Result<Self, KnotError> {
        if degree == 0 || degree > MAX_DEGREE || degree >= poles {
            return Err(KnotError::Degree { degree, poles });
        }
        // The count may come from a damaged file, hence no plain sum.
        let need = poles.saturating_add(degree + 1);
        if knots.len() != need {
            return Err(KnotError::Count { got: knots.len(), need });
        }
        if let Some((index, got)) = knots.iter().enumerate().find(|(_, k)| !k.is_finite()) {
            return Err(KnotError::NotFinite { index, got: *got });
        }
        if let Some(i) = (1..need).find(|i| knots[*i] < knots[*i - 1]) {
            return Err(KnotError::Decreasing { index: i, got: knots[i], before: knots[i - 1] });
        }
        let (lo, hi) = (knots[degree], knots[poles]);
        if !(hi > lo && (hi - lo).is_finite()) {
            return Err(KnotError::Empty { lo, hi });
        }
        for run in knots.chunk_by(|a, b| a == b) {
            let (at, multiplicity) = (run[0], run.len());
            let most = if at > lo && at < hi { degree } else { degree + 1 };
            if multiplicity > most {
                return Err(KnotError::Multiplicity { at, multiplicity, most, degree });
            }
        }
        Ok(Self::with_spans(degree, knots, poles))
    }

    /// The degree p.
    #[must_use]
    pub const fn degree(&self) -> usize {
        self.degree
    }

    /// All knots, multiple ones written out.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.knots
    }

    /// Number of poles.
    #[must_use]
    pub fn poles(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Both ends of the domain, `[t_p, t_n]`.
    #[must_use]
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.poles()]]
    }

    /// The distinct knots of the domain, ascending, both ends included.
    #[must_use]
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// Number of spans between the breaks.
    #[must_use]
    pub fn span_count(&self) -> usize {
        self.spans.len()
    }

    /// How often a value stands in the knot vector.
    #[must_use]
    pub fn multiplicity(&self, t: f64) -> usize {
        self.knots.iter().filter(|k| **k == t).count()
    }

    /// The span that holds `t`, counted between [`Knots::breaks`]: at a break the one to its right, outside
    /// the domain the first or last.
    #[must_use]
    #[inline(always)]
    pub fn find(&self, t: f64) -> usize {
        let table = &self.lookup;
        // Negative numbers and NaN become bucket 0.
        let bucket = (((t - self.breaks[0]) * table.scale) as usize).min(table.first.len() - 1);
        let span = table.first[bucket] as usize;
        // Without a branch: the comparison is a coin toss for random parameters.
        let span = span + usize::from(table.next[span] <= t);
        if table.single { span } else { span + table.next[span..].iter().take_while(|b| **b <= t).count() }
    }

    /// Index of the first of the `degree + 1` poles that act on a span.
    #[must_use]
    pub fn first_pole(&self, span: usize) -> usize {
        self.spans[span] - self.degree
    }

    /// Index k of the knot at which a span begins.
    pub(crate) fn knot_index(&self, span: usize) -> usize {
        self.spans[span]
    }

    /// The same basis run backwards over the same domain: `t` becomes `lo + hi - t`.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let [lo, hi] = self.domain();
        // The ends must stay the same bits.
        let turn = |t: f64| {
            if t == lo {
                hi
            } else if t == hi {
                lo
            } else {
                lo + (hi - t)
            }
        };
        let knots: Vec<f64> = self.knots.iter().rev().map(|t| turn(*t)).collect();
        let poles = self.poles();
        Self::with_spans(self.degree, knots, poles)
    }

    /// A knot vector that is known to be in order.
    pub(crate) fn with_spans(degree: usize, knots: Vec<f64>, poles: usize) -> Self {
        let spans: Vec<usize> = (degree..poles).filter(|k| knots[*k] < knots[*k + 1]).collect();
        let breaks: Vec<f64> = spans.iter().map(|k| knots[*k]).chain([knots[poles]]).collect();
        let lookup = Lookup::new(&breaks);
        Self { degree, knots, spans, breaks, lookup }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clamped_and_unclamped_domains() {
        let k = Knots::new(2, 5, vec![0.0, 0.0, 0.0, 1.0, 1.0, 3.0, 3.0, 3.0]).unwrap();
        assert_eq!(k.domain(), [0.0, 3.0]);
        assert_eq!(k.breaks(), [0.0, 1.0, 3.0]);
        assert_eq!((k.find(-1.0), k.find(0.5), k.find(1.0), k.find(3.0), k.find(9.0)), (0, 0, 1, 1, 1));
        assert_eq!((k.first_pole(0), k.first_pole(1)), (0, 2));
        assert_eq!(k.multiplicity(1.0), 2);
        let open = Knots::new(3, 6, (0..10).map(f64::from).collect()).unwrap();
        assert_eq!(open.domain(), [3.0, 6.0]);
        assert_eq!(open.breaks(), [3.0, 4.0, 5.0, 6.0]);
        assert_eq!(open.first_pole(0), 0);
    }

    #[test]
    fn reversing_twice_is_the_identity() {
        let k = Knots::new(2, 5, vec![0.0, 0.0, 0.0, 1.0, 2.5, 3.0, 3.0, 3.0]).unwrap();
        assert_eq!(k.reversed().as_slice(), [0.0, 0.0, 0.0, 0.5, 2.0, 3.0, 3.0, 3.0]);
        assert_eq!(k.reversed().reversed(), k);
        assert_eq!(k.reversed(), Knots::new(2, 5, k.reversed().as_slice().to_vec()).unwrap());
    }

    #[test]
    fn every_refusal() {
        let new = |p: usize, n: usize, k: &[f64]| Knots::new(p, n, k.to_vec()).unwrap_err();
        assert_eq!(new(0, 2, &[0.0; 3]), KnotError::Degree { degree: 0, poles: 2 });
        assert_eq!(new(2, 2, &[0.0; 5]), KnotError::Degree { degree: 2, poles: 2 });
        assert_eq!(new(26, 40, &[0.0; 67]), KnotError::Degree { degree: 26, poles: 40 });
        assert_eq!(new(1, 2, &[0.0, 1.0]), KnotError::Count { got: 2, need: 4 });
        assert_eq!(new(1, usize::MAX, &[0.0]), KnotError::Count { got: 1, need: usize::MAX });
        let nan = new(1, 2, &[0.0, 0.0, f64::NAN, 1.0]);
        assert!(matches!(nan, KnotError::NotFinite { index: 2, got } if got.is_nan()));
        let down = new(1, 3, &[0.0, 0.0, 2.0, 1.0, 3.0]);
        assert_eq!(down, KnotError::Decreasing { index: 3, got: 1.0, before: 2.0 });
        assert_eq!(new(1, 2, &[0.0, 1.0, 1.0, 2.0]), KnotError::Empty { lo: 1.0, hi: 1.0 });
        let wide = new(1, 2, &[-1e308, -1e308, 1e308, 1e308]);
        assert_eq!(wide, KnotError::Empty { lo: -1e308, hi: 1e308 });
        let inner = new(1, 4, &[0.0, 0.0, 1.0, 1.0, 2.0, 2.0]);
        assert_eq!(inner, KnotError::Multiplicity { at: 1.0, multiplicity: 2, most: 1, degree: 1 });
        let end = new(1, 4, &[0.0, 0.0, 0.0, 1.0, 2.0, 2.0]);
        // The third zero leaves the domain starting at the second: pole 0 acts nowhere.
        assert_eq!(end, KnotError::Multiplicity { at: 0.0, multiplicity: 3, most: 2, degree: 1 });
    }
}
