//! Bodies of head and table along programs, against closed forms and against points all over them.

use osculate_geom::convex::{Convex, Crowd};
use osculate_geom::{Box3, Point3, Vec3};
use osculate_postproc::meetings::{CLEARANCE_MM, InSpindle, Meetings, Standing, meetings};
use osculate_postproc::{Dialect, Machine, Setup};
use proptest::prelude::*;

/// From the tip to the spindle nose.
const LENGTH_MM: f64 = 80.0;

fn machine(name: &str, bodies: &str) -> Machine {
    let text = osculate_postproc::built_in_text(name).unwrap();
    Machine::from_toml(&format!("{text}\n{bodies}")).unwrap()
}

fn look(machine: &Machine, moves: &str, standing: &[Standing], tools: &[InSpindle]) -> Meetings {
    let text = format!("G17 G21 G40 G90 G94 G54\nT1 M6\nG43 H1\nS1000 M3\n{moves}\nM2\n");
    let setup = Setup::at(Vec3::zeros(), LENGTH_MM);
    meetings(&text, Dialect::LinuxCnc, machine, (&setup, &[]), (standing, tools), true).unwrap().0
}

fn block(min: [f64; 3], max: [f64; 3]) -> Standing {
    let shape = Convex::cuboid(&Box3 { min: Point3::from(min), max: Point3::from(max) });
    Standing { name: "block".into(), shape: Crowd::new(vec![shape]).unwrap() }
}

const NOSE: &str = r#"
[[body]]
kind = "cylinder"
name = "spindle"
carried_by = "Z"
from_mm = [0, 0, 0]
to_mm = [0, 0, 150]
diameter_mm = 90
"#;

/// The flat nose over a flat block: it meets when the tip is lower than the block's top by the length less the clearance.
#[test]
fn a_nose_comes_down_on_a_block() {
    let machine = machine("3-axis", NOSE);
    let standing = [block([-20.0, -20.0, 0.0], [20.0, 20.0, 90.0])];
    let down = |z: f64| look(&machine, &format!("G0 X0 Y0 Z100\nG1 Z{z} F500\nG0 Z100"), &standing, &[]);
    let lowest = 90.0 + CLEARANCE_MM - LENGTH_MM;
    assert!(down(lowest + 0.02).found.is_empty());
    let met = down(lowest - 0.02);
    let [m] = &met.found[..] else { panic!("{met:?}") };
    assert_eq!((m.mover.as_str(), m.other.as_str(), m.line, m.blocks), ("spindle", "block", 6, 2));
    assert!((m.least_mm - CLEARANCE_MM).abs() < 0.1, "{m:?}");
    // Beside the block there is room for the radius, the clearance, and no more.
    let beside = 20.0 + 45.0 + CLEARANCE_MM;
    let pass = |x: f64| look(&machine, &format!("G0 X{x} Y0 Z100\nG1 Z0 F500\nG0 Z100"), &standing, &[]);
    assert!(pass(beside + 0.02).found.is_empty());
    assert_eq!(pass(beside - 0.02).found.len(), 1);
}

/// A rapid that dips and comes up again inside one block is seen: both its ends are clear.
#[test]
fn between_the_ends_of_a_block() {
    let machine = machine("3-axis", NOSE);
    let standing = [block([-0.5, -20.0, 0.0], [0.5, 20.0, 90.0])];
    let met = look(&machine, "G0 X-200 Y0 Z0\nG1 X200 F500", &standing, &[]);
    assert_eq!((met.found.len(), met.found[0].line, met.found[0].blocks), (1, 6, 1));
    // Between the first place, which no block leads to, and the end, the tool's own length away.
    assert!(look(&machine, "G0 X-200 Y0 Z20\nG1 X200 F500", &standing, &[]).found.is_empty());
}

/// A tool against the table, and only the tool that is in the spindle.
#[test]
fn a_tool_and_the_table() {
    let table = "[[body]]\nkind = \"box\"\nname = \"table\"\ncarried_by = \"bed\"\nmin_mm = [-100, -100, -50]\nmax_mm = [100, 100, 0]\n";
    let machine = machine("3-axis", table);
    let shape = |radius: f64| {
        let ends = [Point3::origin(), Point3::new(0.0, 0.0, 40.0)];
        Crowd::new(vec![Convex::Frustum { ends, radii_mm: [radius, radius] }]).unwrap()
    };
    let tools = [1, 2].map(|n| InSpindle { number: Some(n), shape: shape(5.0 * f64::from(n)) });
    assert!(look(&machine, "G0 X0 Y0 Z50\nG1 Z1.02 F500", &[], &tools).found.is_empty());
    let met = look(&machine, "G0 X0 Y0 Z50\nG1 Z0.98 F500", &[], &tools);
    assert_eq!((met.found.len(), met.pairs), (1, 2));
    // Beside the table by 7: the first tool passes, of radius 5; the second would not.
    assert!(look(&machine, "G0 X107 Y0 Z50\nG1 Z-20 F500", &[], &tools).found.is_empty());
    let text = "G17 G21 G90 G94 G54\nT2 M6\nG43 H2\nG0 X107 Y0 Z50\nG1 Z-20 F500\nM2\n";
    let setup = Setup::at(Vec3::zeros(), LENGTH_MM);
    let second = meetings(text, Dialect::LinuxCnc, &machine, (&setup, &[]), (&[], &tools), true).unwrap().0;
    assert_eq!(second.found.len(), 1);
}

/// Points all over a cylinder along z.
fn cylinder(r: f64, [low, high]: [f64; 2]) -> Vec<Vec3> {
    let mut out = Vec::new();
    for k in 0..48 {
        let (s, c) = (std::f64::consts::TAU * f64::from(k) / 48.0).sin_cos();
        for z in 0..=12 {
            out.push(Vec3::new(r * c, r * s, low + (high - low) * f64::from(z) / 12.0));
        }
        for share in [0.0, 0.2, 0.4, 0.6, 0.8] {
            out.extend([low, high].map(|z| Vec3::new(share * r * c, share * r * s, z)));
        }
    }
    out
}

/// How far a point is from a cylinder along z; negative inside.
fn off(p: &Vec3, r: f64, [low, high]: [f64; 2]) -> f64 {
    let (across, along) = (p.xy().norm() - r, (low - p.z).max(p.z - high));
    if across > 0.0 && along > 0.0 { across.hypot(along) } else { across.max(along) }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// A table on a trunnion that turns both ways at once under the nose: against points of the table in the frame of the nose, where the
    /// machine is written down by hand.
    #[test]
    fn a_table_tilts_into_the_nose(
        from in [-150.0..150.0f64, -150.0..150.0f64, -60.0..60.0f64, -80.0..80.0f64, -180.0..180.0f64],
        step in [-120.0..120.0f64, -120.0..120.0f64, -60.0..60.0f64, -60.0..60.0f64, -150.0..150.0f64],
    ) {
        let table = "[[body]]\nkind = \"cylinder\"\nname = \"table\"\ncarried_by = \"C\"\nfrom_mm = [60, 0, -30]\nto_mm = [60, 0, 0]\ndiameter_mm = 160\n";
        let machine = machine("trunnion-ac", &format!("{NOSE}{table}"));
        let words = |w: [f64; 5]| format!("X{:.4} Y{:.4} Z{:.4} A{:.4} C{:.4}", w[0], w[1], w[2], w[3], w[4]);
        let to: [f64; 5] = std::array::from_fn(|k| from[k] + step[k]);
        let met = look(&machine, &format!("G0 {}\nG1 {} F500", words(from), words(to)), &[], &[]);
        let points = cylinder(80.0, [-30.0, 0.0]);
        let mut least = f64::INFINITY;
        for k in 0..=400 {
            let t = f64::from(k) / 400.0;
            let at: [f64; 5] = std::array::from_fn(|i| from[i] + t * step[i]);
            let (sa, ca) = at[3].to_radians().sin_cos();
            let (sc, cc) = at[4].to_radians().sin_cos();
            for p in &points {
                // ISO: a positive joint of a table turns it left-handed.
                let q = p + Vec3::new(60.0, 0.0, 0.0);
                let r = Vec3::new(cc * q.x + sc * q.y, -sc * q.x + cc * q.y, q.z);
                let s = Vec3::new(r.x, ca * r.y + sa * r.z, -sa * r.y + ca * r.z);
                let nose = s - Vec3::new(at[0], at[1], at[2] + LENGTH_MM);
                least = least.min(off(&nose, 45.0, [0.0, 150.0]));
            }
        }
        // Points are up to 11 mm apart, and 400 stands too.
        match met.found.first() {
            Some(m) => prop_assert!(least <= CLEARANCE_MM + 6.0, "met at {} mm, points come to {least}", m.least_mm),
            None => prop_assert!(least >= CLEARANCE_MM - 1e-6, "not met, points come to {least}"),
        }
    }
}
