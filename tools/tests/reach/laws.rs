//! Laws: the scale of the part does not matter, nor where it stands.

use crate::reach::scenes::{WIDE, obstacles, scenes, sphere, tool};
use nalgebra::{Rotation3, UnitVector3};
use osculate_geom::{Point3, Vec3};
use osculate_tools::reach::{Mounted, ObstaclePoint, Place, Reach, ReachLimits, ReachProblem, Tool};
use osculate_tools::{Cutter, CutterSpec};

fn scaled(tool: &Tool, by: f64) -> Tool {
    let cutter = tool.cutter();
    let spec = CutterSpec::Toroidal {
        diameter_mm: by * 2.0 * cutter.radius_mm(),
        corner_radius_mm: by * cutter.corner_mm(),
        length_mm: by * cutter.length_mm(),
    };
    let mounted = tool.mounted().iter().map(|m| Mounted {
        body: Cutter::cylinder(by * 2.0 * m.body.radius_mm(), by * m.body.length_mm()).unwrap(),
        height_mm: by * m.height_mm,
    });
    mounted.fold(Tool::new(Cutter::try_from(spec).unwrap(), None), |t, m| t.with(m).unwrap())
}

#[test]
fn scale_does_not_matter() {
    let directions = sphere(3);
    let tool = tool(2);
    for scene in scenes() {
        let mut all = Vec::new();
        for by in [1.0, 1e-3, 1e3] {
            let at = |p: Point3| Point3::from(p.coords * by);
            let moved: Vec<_> =
                scene.points.iter().map(|p| ObstaclePoint { point: at(p.point), ..*p }).collect();
            let places: Vec<_> = scene.places.iter().map(|p| Place { point: at(p.point), ..*p }).collect();
            let limits = ReachLimits {
                gouge_mm: by * WIDE.gouge_mm,
                clearance_mm: by * WIDE.clearance_mm,
                stock_mm: by * WIDE.stock_mm,
                ..WIDE
            };
            let (obstacles, tool) = (obstacles(&moved), scaled(&tool, by));
            let problem = ReachProblem {
                tool: &tool,
                limits,
                obstacles: &obstacles,
                directions: &directions,
                allowed: None,
            };
            all.push(Reach::new(problem).unwrap().map(&places));
        }
        assert!(all[0] == all[1] && all[0] == all[2]);
    }
}

/// A turn by a fifth about a corner of the icosahedron brings the directions onto each other.
#[test]
fn a_rigid_motion_moves_the_bits_with_the_directions() {
    let directions = sphere(3);
    let about = UnitVector3::new_normalize(directions.all()[0].into_inner());
    let turn = Rotation3::from_axis_angle(&about, std::f64::consts::TAU / 5.0);
    let shift = Vec3::new(13.0, -7.0, 40.0);
    let onto: Vec<usize> = directions.all().iter().map(|d| directions.nearest(&(turn * d))).collect();
    for (k, j) in onto.iter().enumerate() {
        assert!((turn * directions.all()[k]).angle(&directions.all()[*j]) < 1e-7);
    }
    let tool = tool(2);
    // An upright bull nose touches with its whole bottom: where it stands then is told by rounding.
    let limits = ReachLimits { least_lean_rad: 0.01, ..WIDE };
    for scene in scenes() {
        let moved: Vec<_> =
            scene.points.iter().map(|p| ObstaclePoint { point: turn * p.point + shift, ..*p }).collect();
        let [still, moved] = [obstacles(&scene.points), obstacles(&moved)];
        let of = |obstacles| {
            let problem =
                ReachProblem { tool: &tool, limits, obstacles, directions: &directions, allowed: None };
            Reach::new(problem).unwrap()
        };
        let [still, moved] = [of(&still), of(&moved)];
        for at in &scene.places {
            let to = Place { point: turn * at.point + shift, normal: turn * at.normal };
            let (a, b) = (still.bits(at), moved.bits(&to));
            for (k, &j) in onto.iter().enumerate() {
                // Directions at a right angle to the normal, or at a limit, may fall to either side by rounding.
                let axis = &directions.all()[k];
                let is_close =
                    at.normal.dot(axis).abs() < 1e-12 || still.gap(at, axis).spare_mm.abs() < 1e-10;
                assert!(a.contains(k) == b.contains(j) || is_close);
            }
        }
    }
}
