//! A quantity given over a face: the tolerance `[h](u, v)` [R97, eq. 9] or the stock S(u, v) [R97, eq. 19].
//!
//! Either the same everywhere, or values at the nodes of a grid over the parameters with bilinear values between them;
//! outside the grid the value of its border holds.

use osculate_geom::Uv;

/// A positive quantity over the parameters of a face.
///
/// ```
/// use osculate_geom::uv;
/// use osculate_productivity::given::Given;
///
/// // 0.1 mm of stock at u = 0, 0.3 mm at u = 1, the same all along v.
/// let stock = Given::grid(vec![0.0, 1.0], vec![0.0, 1.0], vec![0.1, 0.1, 0.3, 0.3])?;
/// assert!((stock.at(uv(0.5, 0.7)) - 0.2).abs() < 1e-15);
/// // Beyond the grid its border's.
/// assert_eq!(stock.at(uv(5.0, 0.7)), 0.3);
/// // No stock at all is none.
/// assert!(Given::uniform(0.0).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    nodes: [Vec<f64>; 2],
    /// By u, then v.
    values: Vec<f64>,
}

/// Values that make no field.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GivenError {
    /// The count of values is not that of the nodes.
    #[error("{u} nodes in u and {v} in v need {} values, got {got}", u * v)]
    Count {
        /// Nodes in u.
        u: usize,
        /// Nodes in v.
        v: usize,
        /// Values.
        got: usize,
    },
    /// Nodes that do not ascend.
    #[error("the nodes in {axis} must ascend and be finite, node {index} is {got}")]
    Nodes {
        /// "u" or "v".
        axis: &'static str,
        /// Which.
        index: usize,
        /// Its value.
        got: f64,
    },
    /// A value that is not positive and finite.
    #[error("value {index} must be positive and finite, got {got}")]
    Value {
        /// Which.
        index: usize,
        /// Its value.
        got: f64,
    },
}

impl Given {
    /// The same value everywhere.
    ///
    /// # Errors
    /// [`GivenError::Value`].
    pub fn uniform(value: f64) -> Result<Self, GivenError> {
        Self::grid(vec![0.0], vec![0.0], vec![value])
    }

    /// Values at the nodes, in rows of v for each u.
    ///
    /// # Errors
    /// [`GivenError`].
    pub fn grid(u: Vec<f64>, v: Vec<f64>, values: Vec<f64>) -> Result<Self, GivenError> {
        for (axis, nodes) in [("u", &u), ("v", &v)] {
            for (index, x) in nodes.iter().enumerate() {
                if !x.is_finite() || index > 0 && nodes[index - 1] >= *x {
                    return Err(GivenError::Nodes { axis, index, got: *x });
                }
            }
        }
        if values.len() != u.len() * v.len() || values.is_empty() {
            return Err(GivenError::Count { u: u.len(), v: v.len(), got: values.len() });
        }
        match values.iter().position(|x| !(x.is_finite() && *x > 0.0)) {
            Some(index) => Err(GivenError::Value { index, got: values[index] }),
            None => Ok(Self { nodes: [u, v], values }),
        }
    }

    /// The value at a place.
    #[must_use]
    pub fn at(&self, at: Uv) -> f64 {
        let [i, j] = [cell(&self.nodes[0], at.u), cell(&self.nodes[1], at.v)];
        let value = |u: usize, v: usize| self.values[u * self.nodes[1].len() + v];
        let mix = |a: f64, b: f64, x: f64| a + (b - a) * x;
        let low = mix(value(i.0, j.0), value(i.0, j.1), j.2);
        let high = mix(value(i.1, j.0), value(i.1, j.1), j.2);
        mix(low, high, i.2)
    }
}

/// The two nodes around x and the share of the second.
fn cell(nodes: &[f64], x: f64) -> (usize, usize, f64) {
    let above = nodes.partition_point(|n| *n <= x);
    match above {
        0 => (0, 0, 0.0),
        k if k == nodes.len() => (k - 1, k - 1, 0.0),
        k => (k - 1, k, (x - nodes[k - 1]) / (nodes[k] - nodes[k - 1])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::uv;

    #[test]
    fn bilinear_between_nodes_and_constant_outside() {
        let f =
            Given::grid(vec![0.0, 1.0, 3.0], vec![-1.0, 1.0], vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        for (u, v, want) in
            [(0.0, -1.0, 1.0), (0.5, 0.0, 2.5), (2.0, 0.5, 4.75), (9.0, 9.0, 6.0), (-4.0, -3.0, 1.0)]
        {
            assert!((f.at(uv(u, v)) - want).abs() < 1e-15, "{u} {v}");
        }
        assert_eq!(Given::uniform(0.3).unwrap().at(uv(7.0, -2.0)), 0.3);
    }

    #[test]
    fn refuses_what_is_no_field() {
        assert!(matches!(Given::uniform(f64::NAN), Err(GivenError::Value { .. })));
        assert!(matches!(Given::uniform(-1.0), Err(GivenError::Value { .. })));
        assert!(matches!(
            Given::grid(vec![0.0, 0.0], vec![0.0], vec![1.0; 2]),
            Err(GivenError::Nodes { .. })
        ));
        assert!(matches!(Given::grid(vec![0.0, 1.0], vec![0.0], vec![1.0]), Err(GivenError::Count { .. })));
        assert!(matches!(Given::grid(vec![], vec![], vec![]), Err(GivenError::Count { .. })));
    }
}
