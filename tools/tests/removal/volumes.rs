//! Slots, a pocket and a roughed sphere with the volume that they take, in closed form.

use crate::common::{ball, flat, shapes, through, toroidal, upright};
use osculate_geom::Vec3;
use osculate_tools::removal::Swept;
use osculate_tools::{Cutter, Pose};
use std::f64::consts::PI;

/// A block from the origin on and what is to be cut from it.
pub struct Case {
    pub name: &'static str,
    pub size_mm: [f64; 3],
    /// Cells at which the volume is good to well below 0.1 %.
    pub cell_mm: f64,
    pub cutter: Cutter,
    pub motions: Vec<Swept>,
    /// What the motions take, mm3.
    pub volume_mm3: f64,
}

pub fn cases() -> Vec<Case> {
    let mut all = slots();
    all.extend([pocket(), sphere()]);
    all
}

/// Slots along x, off the grid in y and z.
fn slots() -> Vec<Case> {
    let slot = |name, cutter, section: f64| {
        let motions = through(&[upright(-10.0, 13.37, 16.7), upright(50.0, 13.37, 16.7)]);
        Case { name, size_mm: [40.0, 30.0, 20.0], cell_mm: 0.1, cutter, motions, volume_mm3: 40.0 * section }
    };
    let [_, cone, _, _] = shapes();
    let depth = 2.0;
    let across = [upright(-10.0, 9.973, 10.0 - depth), upright(30.0, 9.973, 10.0 - depth)];
    vec![
        slot("slot of a flat end", flat(10.0), 10.0 * 3.3),
        // A ball 3.3 deep: the segment of a circle of radius 5.
        slot("slot of a ball", ball(10.0), 25.0 * (1.7f64 / 5.0).acos() - 1.7 * (25.0f64 - 1.7 * 1.7).sqrt()),
        // A bull of corner 2: two quarter circles and the rest.
        slot("slot of a toroidal end", toroidal(10.0, 2.0), 10.0 * 3.3 - 2.0 * (4.0 - PI)),
        // A cone of half angle 25 degrees with a flat of radius 1.5: a trapezium.
        Case {
            name: "groove of a cone",
            size_mm: [20.0, 20.0, 10.0],
            cell_mm: 0.05,
            cutter: cone,
            motions: through(&across),
            volume_mm3: 20.0 * depth * (3.0 + depth * 25f64.to_radians().tan()),
        },
    ]
}

fn pocket() -> Case {
    let (w, h, r, depth) = (23.0, 14.0, 4.0, 5.0);
    let mut poses = vec![upright(7.0, 8.0, 20.0)];
    let rows = 4;
    for k in 0..=rows {
        let y = 8.0 + h * f64::from(k) / f64::from(rows);
        let (a, b) = (7.0, 7.0 + w);
        let (from, to) = if k % 2 == 0 { (a, b) } else { (b, a) };
        poses.extend([upright(from, y, 15.0 - depth), upright(to, y, 15.0 - depth)]);
    }
    // Sides between the rows' ends: the tool runs along all four sides of the rectangle of its centres.
    poses.extend([
        upright(7.0, 8.0 + h, 10.0),
        upright(7.0, 8.0, 10.0),
        upright(30.0, 8.0, 10.0),
        upright(30.0, 22.0, 10.0),
    ]);
    Case {
        name: "pocket",
        size_mm: [40.0, 30.0, 15.0],
        cell_mm: 0.1,
        cutter: flat(2.0 * r),
        motions: through(&poses),
        volume_mm3: depth * (w * h + 2.0 * r * (w + h) + PI * r * r),
    }
}

/// Half a sphere roughed in levels with a flat end along polygons: what is left at each level is a polygon.
fn sphere() -> Case {
    let (radius, tool, levels, sides) = (15.0, 4.0, 10, 60);
    let (size, height) = (40.0, 20.0);
    let step = radius / f64::from(levels);
    let apothem = |k: u32| {
        let z = step * f64::from(k);
        (radius * radius - z * z).max(0.0).sqrt().max(1.0)
    };
    let turn = 2.0 * PI / f64::from(sides);
    let mut poses: Vec<Pose> = Vec::new();
    let mut want = 0.0;
    for k in (0..levels).rev() {
        // The tool's bottom is at the level's lower end and keeps off its wider section.
        let keep = apothem(k);
        want += step * (size * size - f64::from(sides) * keep * keep * (0.5 * turn).tan());
        let z = height - radius + step * f64::from(k);
        // Outwards until the corners of the block are gone.
        let mut at = keep + tool;
        while at < keep + tool || at - 6.0 < 0.5 * size * 2f64.sqrt() + tool {
            let corner = at / (0.5 * turn).cos();
            for i in 0..=sides {
                let (s, c) = (turn * f64::from(i)).sin_cos();
                poses.push(upright(0.5 * size + corner * c, 0.5 * size + corner * s, z));
            }
            at += 6.0;
        }
        poses.push(Pose { tip: poses[poses.len() - 1].tip + Vec3::z() * 40.0, ..poses[0] });
    }
    Case {
        name: "roughed sphere",
        size_mm: [size, size, height],
        cell_mm: 0.2,
        cutter: flat(2.0 * tool),
        motions: through(&poses),
        volume_mm3: want,
    }
}
