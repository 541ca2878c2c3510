//! The ruled surface between two curves.

use crate::knots::Knots;
use crate::nurbs::{Net, NurbsCurve3, NurbsSurface};
use osculate_geom::Side;

/// Why two curves span no ruled surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RuledError {
    /// The degrees differ.
    #[error("the curves have degrees {} and {}: raise the lower one first", degrees[0], degrees[1])]
    Degree {
        /// Both degrees.
        degrees: [usize; 2],
    },
    /// The numbers of poles differ.
    #[error("the curves have {} and {} poles: insert the knots of each into the other first", poles[0], poles[1])]
    Poles {
        /// Both numbers.
        poles: [usize; 2],
    },
    /// The knots differ.
    #[error(
        "knot {index} is {} on one curve and {} on the other: bring both to one domain and the same knots", knots[0], knots[1]
    )]
    Knots {
        /// The first knot that differs, from 0.
        index: usize,
        /// Both values.
        knots: [f64; 2],
    },
}

/// The ruled surface with `at_zero` at v = 0 and `at_one` at v = 1, over the curves' parameter u. The outward
/// normal is along `S_u x S_v`.
///
/// ```
/// use osculate_geom::{Point3, Surface, uv};
/// use osculate_surfaces::{NurbsCurve3, RuledError, ruled};
/// let edge = |y: f64, rise: f64| {
///     let ends = vec![Point3::new(0.0, y, 0.0), Point3::new(10.0, y, rise)];
///     NurbsCurve3::new(1, vec![0.0, 0.0, 1.0, 1.0], ends, None)
/// };
/// let saddle = ruled(&edge(0.0, 0.0)?, &edge(10.0, 10.0)?)?;
/// assert_eq!(saddle.point(uv(0.5, 0.5)), Point3::new(5.0, 5.0, 2.5));
/// // Curves of different degrees are raised to one first.
/// assert!(matches!(ruled(&edge(0.0, 0.0)?, &edge(1.0, 0.0)?.elevated(1)?), Err(RuledError::Degree { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RuledError`] where degrees, numbers of poles or knots differ.
pub fn ruled(at_zero: &NurbsCurve3, at_one: &NurbsCurve3) -> Result<NurbsSurface, RuledError> {
    let both = [at_zero, at_one];
    let degrees = both.map(|c| c.degree());
    if degrees[0] != degrees[1] {
        return Err(RuledError::Degree { degrees });
    }
    let poles = both.map(|c| c.poles().len());
    if poles[0] != poles[1] {
        return Err(RuledError::Poles { poles });
    }
    let [a, b] = both.map(|c| c.knots().as_slice());
    if let Some(index) = (0..a.len()).find(|i| a[*i] != b[*i]) {
        return Err(RuledError::Knots { index, knots: [a[index], b[index]] });
    }
    let points = at_zero.poles().iter().zip(at_one.poles()).flat_map(|(a, b)| [*a, *b]).collect();
    let weights = both.iter().any(|c| c.weights().is_some()).then(|| {
        (0..poles[0]).flat_map(|i| both.map(|c| c.weights().map_or(1.0, |w| w[i]))).collect::<Vec<_>>()
    });
    let across =
        Knots::new(1, 2, vec![0.0, 0.0, 1.0, 1.0]).expect("four clamped knots carry two poles of degree one");
    let net = Net { count: [poles[0], 2], points, weights };
    Ok(NurbsSurface::checked([at_zero.knots().clone(), across], net, Side::Along))
}
