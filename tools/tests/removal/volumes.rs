//! Slots, pockets, holes, rings and faces with the volume that they take, in closed form.

use super::common::{ball, flat, pose, shapes, through, toroidal, upright};
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
    all.extend([pocket(), sphere(), crossing_slots(), ring(), faced()]);
    all.extend(plunges());
    all.extend(leaning_slots());
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

/// Straight down: holes, a cap and a frustum.
fn plunges() -> Vec<Case> {
    let [_, cone, _, _] = shapes();
    let hole = |name, cutter, cell_mm, depth: f64, volume_mm3| {
        let (x, y, top) = (6.17, 5.83, 12.0);
        let motions = through(&[upright(x, y, 20.0), upright(x, y, top - depth)]);
        Case { name, size_mm: [12.0, 12.0, top], cell_mm, cutter, motions, volume_mm3 }
    };
    let cap = |r: f64, h: f64| PI * h * h * (r - h / 3.0);
    let frustum = |a: f64, b: f64, h: f64| PI * h / 3.0 * (a * a + a * b + b * b);
    vec![
        hole("hole of a flat end", flat(6.0), 0.06, 7.3, PI * 9.0 * 7.3),
        // A cylinder down to the centre, and half a sphere below.
        hole("hole of a ball", ball(6.0), 0.06, 7.3, PI * 9.0 * 4.3 + 2.0 / 3.0 * PI * 27.0),
        hole("cap of a ball", ball(6.0), 0.03, 1.2, cap(3.0, 1.2)),
        // Half angle 25 degrees from a flat of radius 1.5 on.
        hole("frustum of a cone", cone, 0.04, 3.0, frustum(1.5, 1.5 + 3.0 * 25f64.to_radians().tan(), 3.0)),
    ]
}

/// Slots of a flat end that leans.
fn leaning_slots() -> Vec<Case> {
    let (r, depth) = (3.0, 4.0);
    let (s, c) = 20f64.to_radians().sin_cos();
    let slot = |name, z: f64, axis: [f64; 3], section: f64| {
        let motions = through(&[pose([-20.0, 9.37, z], axis), pose([50.0, 9.37, z], axis)]);
        Case {
            name,
            size_mm: [30.0, 20.0, 10.0],
            cell_mm: 0.08,
            cutter: flat(2.0 * r),
            motions,
            volume_mm3: 30.0 * section,
        }
    };
    vec![
        // Across the feed: a rectangle that leans, `depth` deep at its middle; both its lower corners are below the top.
        slot("leaning slot", 10.0 - depth, [0.0, s, c], 2.0 * r * depth / c),
        // Along the feed: its end is seen as half an ellipse, whose lowest point is `depth` deep, and straight walls above.
        slot(
            "heel in a slot",
            10.0 - depth + r * s,
            [s, 0.0, c],
            0.5 * PI * r * r * s + 2.0 * r * (depth - r * s),
        ),
    ]
}

/// Two slots of a ball as deep as its centre that cross: both half cylinders less what they share, half of Steinmetz's body.
fn crossing_slots() -> Case {
    let (r, [length, width]) = (3.0, [24.0, 20.0]);
    let across = through(&[upright(-10.0, 9.37, 10.0 - r), upright(40.0, 9.37, 10.0 - r)]);
    let along = through(&[upright(13.11, -10.0, 10.0 - r), upright(13.11, 40.0, 10.0 - r)]);
    Case {
        name: "crossing slots",
        size_mm: [length, width, 10.0],
        cell_mm: 0.06,
        cutter: ball(2.0 * r),
        motions: [across, along].concat(),
        volume_mm3: 0.5 * PI * r * r * (length + width) - 8.0 / 3.0 * r.powi(3),
    }
}

/// The lower half of a torus, along the chords of its circle, with the ball's centre in the top.
///
/// At a height where the ball is p wide to each side the tool covers all within p of a polygon of perimeter P and n sides: outside
/// it P p + pi p^2 with the corners' sectors, inside P p - n p^2 tan(pi / n). Over a ball's lower half p^2 is r^2 - z^2.
fn ring() -> Case {
    let (r, radius, sides) = (2.0, 9.0, 40);
    let turn = 2.0 * PI / f64::from(sides);
    let poses: Vec<Pose> = (0..=sides)
        .map(|k| (turn * f64::from(k)).sin_cos())
        .map(|(s, c)| upright(12.03 + radius * c, 11.96 + radius * s, 8.0 - r))
        .collect();
    let perimeter = 2.0 * radius * (0.5 * turn).sin() * f64::from(sides);
    let corners = PI - f64::from(sides) * (0.5 * turn).tan();
    Case {
        name: "ring of a ball",
        size_mm: [24.0, 24.0, 8.0],
        cell_mm: 0.05,
        cutter: ball(2.0 * r),
        motions: through(&poses),
        volume_mm3: 0.5 * PI * r * r * perimeter + 2.0 / 3.0 * r.powi(3) * corners,
    }
}

/// A block faced off by a toroidal end whose rows leave nothing between them.
fn faced() -> Case {
    let (size, depth) = ([26.0, 18.0, 10.0], 1.37);
    let poses: Vec<Pose> = (0..6)
        .flat_map(|k| {
            let y = -1.0 + 4.0 * f64::from(k);
            let ends = [upright(-8.0, y, size[2] - depth), upright(34.0, y, size[2] - depth)];
            if k % 2 == 0 { ends } else { [ends[1], ends[0]] }
        })
        .collect();
    Case {
        name: "block faced off",
        size_mm: size,
        cell_mm: 0.1,
        cutter: toroidal(8.0, 1.0),
        motions: through(&poses),
        volume_mm3: size[0] * size[1] * depth,
    }
}
