//! A second opinion on a path: how deep the cutter goes into points of the face, at poses close together.
//!
//! Nothing of the libraries is used: the path is read from the text of the CL file, points of the face come from a mesh that
//! `osculate export` wrote or from `osculate probe`, and the distance to a cutter with a corner is the formula below. The depth is
//! that of the point in the cutter, which is less than along the face's normal, if anything. Between poses tip and axis go straight.

use serde_json::Value;
use std::collections::HashMap;

type V = [f64; 3];

/// A cutter with a corner: ball, flat or toroidal.
pub struct Cutter {
    radius_mm: f64,
    corner_mm: f64,
    length_mm: f64,
}

impl Cutter {
    /// The tool of a summary.
    pub fn of(tool: &Value) -> Option<Self> {
        let radius_mm = 0.5 * tool["diameter_mm"].as_f64()?;
        let corner_mm =
            if tool["kind"] == "ball" { radius_mm } else { tool["corner_radius_mm"].as_f64().unwrap_or(0.0) };
        Some(Self { radius_mm, corner_mm, length_mm: tool["length_mm"].as_f64()? })
    }

    /// How deep a point at this distance from the axis and height above the tip is in the cutter, mm; negative outside.
    fn depth_mm(&self, rho: f64, z: f64) -> f64 {
        let (r, core) = (self.corner_mm, self.radius_mm - self.corner_mm);
        if z > self.length_mm {
            self.length_mm - z
        } else if z >= r {
            (self.radius_mm - rho).min(z)
        } else if rho <= core {
            z
        } else {
            r - (rho - core).hypot(z - r)
        }
    }
}

/// Points in cells of a space hash.
pub struct Cloud {
    cell_mm: f64,
    cells: HashMap<[i32; 3], Vec<V>>,
    /// Points in all.
    pub count: usize,
}

impl Cloud {
    /// Sorts points into cells.
    pub fn new(points: impl Iterator<Item = V>, cell_mm: f64) -> Self {
        let mut out = Self { cell_mm, cells: HashMap::new(), count: 0 };
        for p in points {
            let cell = out.cell(&p);
            out.cells.entry(cell).or_default().push(p);
            out.count += 1;
        }
        out
    }

    fn cell(&self, p: &V) -> [i32; 3] {
        // Parts are some metres at most, cells a millimetre at least.
        p.map(|x| (x / self.cell_mm).floor() as i32)
    }

    /// The deepest point in the lower part of a cutter, to one diameter above the tip.
    fn deepest_mm(&self, cutter: &Cutter, tip: &V, axis: &V) -> f64 {
        let high = (2.0 * cutter.radius_mm).min(cutter.length_mm);
        let middle: V = std::array::from_fn(|k| tip[k] + 0.5 * high * axis[k]);
        let reach = (0.5 * high).hypot(cutter.radius_mm);
        let low = self.cell(&middle.map(|x| x - reach));
        let top = self.cell(&middle.map(|x| x + reach));
        let mut deepest = f64::NEG_INFINITY;
        for i in low[0]..=top[0] {
            for j in low[1]..=top[1] {
                for k in low[2]..=top[2] {
                    for p in self.cells.get(&[i, j, k]).into_iter().flatten() {
                        let d: V = std::array::from_fn(|k| p[k] - tip[k]);
                        let z = dot(&d, axis);
                        if z <= high {
                            let rho = (dot(&d, &d) - z * z).max(0.0).sqrt();
                            deepest = deepest.max(cutter.depth_mm(rho, z));
                        }
                    }
                }
            }
        }
        deepest
    }
}

fn dot(a: &V, b: &V) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The deepest that a cutter goes into the points along the moves of a CL file; poses are no further apart than `step_mm` at the
/// tip and a hundredth in the axis. With it the number of poses.
pub fn deepest_mm(cl: &str, cutter: &Cutter, cloud: &Cloud, step_mm: f64) -> (f64, usize) {
    let given: Vec<[f64; 6]> = cl
        .lines()
        .filter_map(|l| l.strip_prefix("GOTO/"))
        .filter_map(|l| {
            let n: Vec<f64> = l.split(',').filter_map(|x| x.trim().parse().ok()).collect();
            n.try_into().ok()
        })
        .collect();
    let (mut deepest, mut poses) = (f64::NEG_INFINITY, 0);
    for w in given.windows(2) {
        let far = |r: std::ops::Range<usize>| r.map(|k| (w[1][k] - w[0][k]).powi(2)).sum::<f64>().sqrt();
        let n = (far(0..3) / step_mm).max(far(3..6) / 0.01).ceil().max(1.0) as usize;
        for i in 0..n {
            let at: [f64; 6] = std::array::from_fn(|k| w[0][k] + i as f64 / n as f64 * (w[1][k] - w[0][k]));
            let axis = [at[3], at[4], at[5]];
            let length = dot(&axis, &axis).sqrt();
            deepest = f64::max(
                deepest,
                cloud.deepest_mm(cutter, &[at[0], at[1], at[2]], &axis.map(|a| a / length)),
            );
            poses += 1;
        }
    }
    (deepest, poses)
}

/// The corners of a binary STL file.
pub fn stl_points(bytes: &[u8]) -> impl Iterator<Item = V> + '_ {
    let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    bytes
        .get(84..)
        .unwrap_or_default()
        .chunks_exact(50)
        .flat_map(move |t| (0..3).map(move |c| std::array::from_fn(|k| number(&t[12 + 12 * c + 4 * k..]))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A toroidal cutter whose flat bottom lies 0.01 mm below a plane, going along it.
    #[test]
    fn a_sunk_cutter_is_as_deep_as_it_is() {
        let cutter = Cutter { radius_mm: 5.0, corner_mm: 1.0, length_mm: 40.0 };
        let plane = || {
            (-200..200).flat_map(|i| (-50..50).map(move |j| [0.2 * f64::from(i), 0.2 * f64::from(j), 0.0]))
        };
        let cloud = Cloud::new(plane(), 5.0);
        let (deepest, poses) =
            deepest_mm("GOTO/-20,0,-0.01,0,0,1\nRAPID\nGOTO/20,0,-0.01,0,0,1\n", &cutter, &cloud, 0.5);
        assert!((deepest - 0.01).abs() < 1e-12 && poses == 80, "{deepest} {poses}");
        let (above, _) = deepest_mm("GOTO/-20,0,0.5,0,0,1\nGOTO/20,0,0.5,0,0,1\n", &cutter, &cloud, 0.5);
        assert!(above < 0.0);
        // Leaning by 30 degrees the corner is the lowest: its centre stands at z = 4 sin 30 below that of the tip.
        let (s, c) = (0.5, 0.75f64.sqrt());
        let tip_z = 4.0 * s + 1.0 - c - 0.02;
        let line = format!("GOTO/0,0,{tip_z},{s},0,{c}\nGOTO/1,0,{tip_z},{s},0,{c}\n");
        let (deepest, _) = deepest_mm(&line, &cutter, &cloud, 0.1);
        assert!((deepest - 0.02).abs() < 2e-3, "{deepest}");
    }
}
