//! The second opinion against closed forms: kinematics by hand, a ball on a plane, one move in four wordings, words that it does
//! not know. Programs that the post has written stand in `second_posted.rs`.

use osculate::second::{
    Accepted, Agreement, Figures, HolderPart, NoOpinion, Opinion, Options, PartPoint, Setup, Shape, Station,
    Tool, Unread, Which, compare, forward, look, stations,
};

macro_rules! machine {
    ($name:literal) => {
        osculate_postproc::built_in_text($name).expect("built in")
    };
}

const HOME: [f64; 3] = [0.0; 3];

fn near(got: [[f64; 3]; 2], tip: [f64; 3], axis: [f64; 3]) {
    for k in 0..3 {
        assert!(
            (got[0][k] - tip[k]).abs() < 1e-10 && (got[1][k] - axis[k]).abs() < 1e-12,
            "{got:?} {tip:?} {axis:?}"
        );
    }
}

/// At home the tip is at the table's reference point, however long the tool is.
#[test]
fn machines_at_home() {
    let all = [
        machine!("3-axis"),
        machine!("head-b-table-c"),
        machine!("head-ca"),
        machine!("linuxcnc-xyzac"),
        machine!("linuxcnc-xyzbc"),
        machine!("nutated-b-table-c"),
        machine!("trunnion-ac"),
        machine!("trunnion-bc"),
    ];
    for text in all {
        near(forward(text, HOME, [0.0; 2], 100.0).unwrap(), HOME, [0.0, 0.0, 1.0]);
        // Linear joints alone are the tip.
        near(forward(text, [1.0, 2.0, 3.0], [0.0; 2], 100.0).unwrap(), [1.0, 2.0, 3.0], [0.0, 0.0, 1.0]);
    }
    // Its tool lies along X, and its chain is Z, X, Y.
    let text = machine!("mill-turn-xyzc");
    near(forward(text, [3.0, 1.0, 2.0], [0.0; 2], 100.0).unwrap(), [1.0, 2.0, 3.0], [1.0, 0.0, 0.0]);
}

/// Table and table, X1 Y2 Z3. By ISO the tool turns by +90 deg seen from the part, as LinuxCNC counts by -90 deg:
/// about X  (x, y, z) -> (x, -z, y), about Y  (z, y, -x), about Z  (-y, x, z).
#[test]
fn tables_at_right_angles() {
    let at = |text, rotary| forward(text, [1.0, 2.0, 3.0], rotary, 100.0).unwrap();
    let ac = machine!("trunnion-ac");
    near(at(ac, [0.0, 90.0]), [1.0, -3.0, 2.0], [0.0, -1.0, 0.0]);
    // C is nearer the part: it turns what A has turned.
    near(at(ac, [90.0, 90.0]), [3.0, 1.0, 2.0], [1.0, 0.0, 0.0]);
    let bc = machine!("trunnion-bc");
    near(at(bc, [0.0, 90.0]), [3.0, 2.0, -1.0], [1.0, 0.0, 0.0]);
    near(at(bc, [90.0, 90.0]), [-2.0, 3.0, -1.0], [0.0, 1.0, 0.0]);
    let xyzac = machine!("linuxcnc-xyzac");
    near(at(xyzac, [0.0, 90.0]), [1.0, 3.0, -2.0], [0.0, 1.0, 0.0]);
    near(at(xyzac, [90.0, 90.0]), [3.0, -1.0, -2.0], [1.0, 0.0, 0.0]);
    let xyzbc = machine!("linuxcnc-xyzbc");
    near(at(xyzbc, [0.0, 90.0]), [-3.0, 2.0, 1.0], [-1.0, 0.0, 0.0]);
    near(at(xyzbc, [90.0, 90.0]), [2.0, 3.0, 1.0], [0.0, 1.0, 0.0]);
    // C = 90 deg takes (1, 2, 3) to (-2, 1, 3), and the tool from X to Y.
    near(
        forward(machine!("mill-turn-xyzc"), [3.0, 1.0, 2.0], [90.0, 0.0], 100.0).unwrap(),
        [-2.0, 1.0, 3.0],
        [0.0, 1.0, 0.0],
    );
}

/// Heads, X1 Y2 Z3, a tool of 100 mm. The arm goes from the axis of rotation down to the tip.
#[test]
fn heads_at_right_angles() {
    let at = |text, rotary| forward(text, [1.0, 2.0, 3.0], rotary, 100.0).unwrap();
    // Pivot 200 above the gauge point, which is at 100: the arm is 300 long, and B = 90 lays it along -X from (0, 0, 300).
    let bc = machine!("head-b-table-c");
    near(at(bc, [0.0, 90.0]), [-299.0, 2.0, 303.0], [1.0, 0.0, 0.0]);
    near(at(bc, [90.0, 90.0]), [-2.0, -299.0, 303.0], [0.0, 1.0, 0.0]);
    // Pivot at 250: A = 90 lays the arm along +Y, C then turns it to -X. The part stands still.
    let ca = machine!("head-ca");
    near(at(ca, [0.0, 90.0]), [1.0, 252.0, 253.0], [0.0, -1.0, 0.0]);
    near(at(ca, [90.0, 90.0]), [-249.0, 2.0, 253.0], [1.0, 0.0, 0.0]);
    // Half a turn about k = (0, 1, 1) / sqrt 2 is v -> 2 (k.v) k - v: Z to Y, the arm of 300 along -Y.
    let nutated = machine!("nutated-b-table-c");
    near(at(nutated, [0.0, 180.0]), [1.0, -298.0, 303.0], [0.0, 1.0, 0.0]);
    near(at(nutated, [90.0, 180.0]), [298.0, 1.0, 303.0], [-1.0, 0.0, 0.0]);
}

const AT_ZERO: Setup = Setup { part_zero_mm: [0.0; 3], turn: [0.0, 0.0, 0.0, 1.0], gauge_length_mm: 40.0 };

fn ball() -> Tool {
    let holder = vec![HolderPart { diameter_mm: 30.0, upper_diameter_mm: 30.0, length_mm: 20.0 }];
    Tool { shape: Shape::Ball, diameter_mm: 6.0, length_mm: 40.0, flute_mm: None, holder }
}

/// A plane at z = 0, every 0.1 mm.
fn plane() -> Vec<PartPoint> {
    let at = |i: i32, j: i32| [0.1 * f64::from(i), 0.1 * f64::from(j), 0.0];
    let point = |at| PartPoint { face: 7, machined: true, at, normal: [0.0, 0.0, 1.0] };
    (0..=40).flat_map(|i| (0..=8).map(move |j| point(at(i, j)))).collect()
}

const HEAD: &str = "G17 G21 G40 G49 G80 G90 G94\nG53 G0 Z0\nT1 M6\nG43 H1\nG54\n";

fn opinion(moves: &str, options: &Options) -> Result<Opinion, NoOpinion> {
    let text = format!("{HEAD}{moves}M30\n");
    look(&text, "linuxcnc", machine!("3-axis"), Some(AT_ZERO), &ball(), &plane(), options)
}

/// Two passes 0.8 mm apart over the plane.
const PASSES: &str = "G0 X-1 Y0\nZ0\nG1 X5 F500\nG0 Z10\nY0.8\nZ0\nG1 X-1\nG0 Z10\n";

#[test]
fn a_ball_leaves_its_ridge() {
    let options = Options::new(0.5, 0.001);
    let got = opinion(PASSES, &options).unwrap();
    // R - sqrt(R^2 - s^2 / 4), and there are points in the middle between the passes.
    let ridge = 3.0 - (9.0f64 - 0.16).sqrt();
    assert!(got.left_mm >= ridge - 1e-9 && got.left_mm <= ridge + got.slack_mm, "{got:?}");
    assert!((got.slack_mm - 0.001).abs() < 1e-12 && got.uncut == 0 && got.points == 41 * 9, "{got:?}");
    assert!(got.left_at_mm.is_some_and(|p| (p[1] - 0.4).abs() < 1e-9) && got.left_face == Some(7), "{got:?}");
    assert!(got.gouge_mm.abs() <= 0.001, "{got:?}");
    // 10 mm above the plane; the holder 40 mm.
    assert!(got.rapid_mm <= 1e-9 && (got.holder_mm + 40.0).abs() < 0.5, "{got:?}");
    assert!((got.points_apart_mm - 0.1).abs() < 1e-9, "{got:?}");
    // One pass: the far row, 0.8 mm aside, is cut at R - sqrt(R^2 - 0.8^2).
    let one = opinion("G0 X-1 Y0\nZ0\nG1 X5 F500\nG0 Z10\n", &options).unwrap();
    let high = 3.0 - (9.0f64 - 0.64).sqrt();
    assert!(one.left_mm >= high - 1e-9 && one.left_mm <= high + one.slack_mm, "{one:?}");
    // Less stock than that: those points are not cut at all.
    let thin = opinion("G0 X-1 Y0\nZ0\nG1 X5 F500\nG0 Z10\n", &Options::new(0.1, 0.001)).unwrap();
    assert!(thin.uncut == 41 && thin.left_mm == 0.1, "{thin:?}");
}

#[test]
fn a_planted_gouge_is_found_where_it_is() {
    let sunk = "G0 X-1 Y0\nZ0\nG1 X2 F500\nX2.04 Z-0.02\nX2.08 Z0\nX5\nG0 Z10\nY0.8\nZ0\nG1 X-1\nG0 Z10\n";
    for slack in [0.01, 0.001, 0.0001] {
        let got = opinion(sunk, &Options::new(0.5, slack)).unwrap();
        // The lowest place, at x = 2.04, lies over no point: of those at 2.0 and 2.1 the nearer one is as deep as this.
        let r = 3.0 - (3.0f64 - 0.02).hypot(0.04);
        assert!(got.gouge_mm <= r + 1e-9 && got.gouge_mm >= r - slack, "{slack}: {got:?} {r}");
        assert!(matches!(got.line, Some(9 | 10)) && got.on_face == Some(7), "{got:?}");
        assert!(got.at_mm.is_some_and(|p| (p[0] - 2.0).abs() < 1e-9 && p[1] == 0.0), "{got:?}");
    }
    // A rapid through the plane is not the feed's.
    let got = opinion("G0 X-1 Y0\nZ0\nG1 X5 F500\nG0 X-1 Z-0.3\n", &Options::new(0.5, 0.001)).unwrap();
    assert!(got.gouge_mm < 0.001 && got.rapid_mm > 0.2 && got.rapid_line == Some(9), "{got:?}");
    // The holder, 15 mm around and from 40 mm up: beside the tool its lower end comes 0.1 mm under the plane.
    let got = opinion("G0 X-10 Y0\nZ-40.1\nG1 X-8 F500\nG0 Z10\n", &Options::new(0.5, 0.001)).unwrap();
    assert!((got.holder_mm - 0.1).abs() < 0.0011, "{got:?}");
}

/// Numbers between -1 and 1 that look like chance, from a counter.
fn noise(counter: &mut f64) -> f64 {
    *counter += 1.0;
    let x = (*counter * 12.9898).sin() * 43_758.547;
    2.0 * (x - x.floor()) - 1.0
}

/// Turning moves of all joints, against frozen poses every 4000th of a move and the formulas of a ball and of a flat end.
#[test]
fn nothing_is_deeper_or_lower_between_the_poses() {
    let text = machine!("trunnion-ac");
    let (mut counter, mut seen) = (0.0, 0);
    for round in 0..12 {
        let flat = round % 2 == 1;
        let radius: f64 = 3.0;
        let shape = if flat { Shape::Flat } else { Shape::Ball };
        let tool = Tool { shape, ..ball() };
        let mut at = || {
            let linear = [0, 1, 2].map(|_| 12.0 * noise(&mut counter));
            (linear, [60.0 * noise(&mut counter), 20.0 + 40.0 * noise(&mut counter)])
        };
        let stations = [at(), at(), at()];
        let mut program = HEAD.to_string();
        for (k, ([x, y, z], [c, a])) in stations.iter().enumerate() {
            let head = if k == 0 { "G0" } else { "G1 F500" };
            program += &format!("{head} X{x:.9} Y{y:.9} Z{z:.9} A{a:.9} C{c:.9}\n");
        }
        program += "M30\n";
        let pose = |t: f64| {
            let (k, share) = if t < 1.0 { (0, t) } else { (1, t - 1.0) };
            let (p, q) = (stations[k], stations[k + 1]);
            let linear = [0, 1, 2].map(|i| p.0[i] + share * (q.0[i] - p.0[i]));
            let rotary = [0, 1].map(|i| p.1[i] + share * (q.1[i] - p.1[i]));
            forward(text, linear, rotary, 40.0).unwrap()
        };
        // Signed distance of a point, the tool 40 mm long.
        let distance = |[tip, axis]: &[[f64; 3]; 2], p: [f64; 3]| {
            let d = [0, 1, 2].map(|i| p[i] - tip[i]);
            let z: f64 = (0..3).map(|i| d[i] * axis[i]).sum();
            let rho = (0..3).map(|i| (d[i] - z * axis[i]).powi(2)).sum::<f64>().sqrt();
            let low = match (flat, z) {
                (true, _) if z < 0.0 && rho > radius => z.hypot(rho - radius),
                (true, _) => (-z).max(rho - radius),
                (false, z) if z < radius => rho.hypot(z - radius) - radius,
                (false, _) => rho - radius,
            };
            low.max(z - 40.0)
        };
        let poses: Vec<[[f64; 3]; 2]> = (0..8000).map(|k| pose(f64::from(k) / 4000.0)).collect();
        for k in 0..30 {
            // Around the tip's way.
            let [tip, axis] = pose(1.99 * f64::from(k) / 30.0);
            let shift = [0, 1, 2].map(|_| 3.2 * noise(&mut counter));
            let point = [0, 1, 2].map(|i| tip[i] + shift[i] - 1.5 * axis[i]);
            let n = [0, 1, 2].map(|i| axis[i] + 0.4 * noise(&mut counter));
            let size = n.iter().map(|c| c * c).sum::<f64>().sqrt();
            let normal = n.map(|c| c / size);
            let mut lowest = 1.5f64;
            let mut own = f64::NEG_INFINITY;
            for pose in &poses {
                own = own.max(-distance(pose, point));
                // Steps of the distance never go past the entry.
                let mut s = 0.0;
                while s < lowest {
                    let step = distance(pose, [0, 1, 2].map(|i| point[i] + s * normal[i]));
                    if step < 1e-5 {
                        lowest = s;
                        break;
                    }
                    s += step;
                }
            }
            let points = [PartPoint { face: 1, machined: true, at: point, normal }];
            let options = Options::new(1.5, 1e-3);
            let got = look(&program, "linuxcnc", text, Some(AT_ZERO), &tool, &points, &options).unwrap();
            // Those frozen poses are some 0.01 mm apart, and a sharp edge may pass between two.
            let blur = 5e-3;
            let deep = (got.gouge_mm.max(0.0) - own.max(0.0)).abs();
            assert!(deep <= got.slack_mm + blur, "{round} {k}: {own} {got:?}");
            // Where the tool only grazes a normal, a little of its way is much of the height: the slack says so.
            let high = (got.left_mm - lowest).abs();
            assert!(high <= got.slack_mm + blur, "{round} {k}: {lowest} {got:?}");
            seen += usize::from(own > 0.0 && got.slack_mm < 2e-3) + usize::from(lowest > 0.0 && lowest < 1.4);
        }
    }
    assert!(seen > 100, "{seen}");
}

#[test]
fn few_poses_say_that_they_are_few() {
    let all = opinion(PASSES, &Options::new(0.5, 0.0001)).unwrap();
    let few = opinion(PASSES, &Options { most_poses: 60, ..Options::new(0.5, 0.0001) }).unwrap();
    assert!(few.poses < all.poses && few.slack_mm > 10.0 * all.slack_mm, "{few:?} {all:?}");
    // Whatever they miss is within what they say.
    assert!((few.left_mm - all.left_mm).abs() <= few.slack_mm + all.slack_mm, "{few:?} {all:?}");
    assert!(
        (few.gouge_mm.max(0.0) - all.gouge_mm.max(0.0)).abs() <= few.slack_mm + all.slack_mm,
        "{few:?} {all:?}"
    );
}

#[test]
fn threads_do_not_matter() {
    let options = Options::new(0.5, 0.001);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let wave: String = (0..9000)
            .map(|k| {
                let x = f64::from(k) * 0.01;
                format!(
                    "G1 X{:.4} Y{:.4} Z{:.4} F100\n",
                    2.0 + 3.0 * x.cos(),
                    0.008 * x,
                    0.01 * (3.0 * x).sin()
                )
            })
            .collect();
        let mut got = pool.install(|| opinion(&format!("G0 X0 Y0\nZ3\n{wave}"), &options)).unwrap();
        got.seconds = 0.0;
        got
    };
    let one = run(1);
    assert!(one.gouge_mm > 0.005 && one.poses > 9000, "{one:?}");
    assert_eq!(one, run(2));
    assert_eq!(one, run(5));
}

#[test]
fn figures_are_held_against_each_other() {
    let got = opinion(PASSES, &Options::new(0.5, 0.001)).unwrap();
    let accepted = Accepted { gouge_mm: 0.005, left_mm: 0.03 };
    let fair = Figures {
        gouge_mm: 0.0,
        gouge_bound_mm: 0.001,
        left_mm: got.left_mm,
        left_bound_mm: got.left_mm + 0.001,
    };
    assert!(matches!(compare(&got, &fair, &accepted), Agreement::Agrees { left_apart_mm: 0.0, .. }));
    // A verification that has seen only half of the ridge.
    let low = Figures { left_mm: 0.5 * got.left_mm, left_bound_mm: 0.6 * got.left_mm, ..fair };
    let said = compare(&got, &low, &accepted);
    assert!(
        matches!(said, Agreement::Disagrees { which: Which::Left, ours_mm, .. } if ours_mm == got.left_mm),
        "{said:?}"
    );
    // One that sees much more of it, and nothing between our points can be as high.
    let high = Figures { left_mm: 0.2, left_bound_mm: 0.2, ..fair };
    let said = compare(&got, &high, &accepted);
    assert!(matches!(said, Agreement::Disagrees { which: Which::Left, theirs_mm: 0.2, .. }), "{said:?}");
    // A gouge that it has not seen.
    let sunk = Opinion { gouge_mm: 0.02, ..got.clone() };
    let said = compare(&sunk, &fair, &accepted);
    assert!(matches!(said, Agreement::Disagrees { which: Which::Gouge, ours_mm: 0.02, .. }), "{said:?}");
    // And one that we have not.
    let said = compare(&got, &Figures { gouge_mm: 0.3, gouge_bound_mm: 0.3, ..fair }, &accepted);
    assert!(matches!(said, Agreement::Disagrees { which: Which::Gouge, theirs_mm: 0.3, .. }), "{said:?}");
}

/// Programs for trunnion-ac, tool-centre-point control on and off.
fn wordings() -> [(&'static str, [String; 2]); 4] {
    let sinumerik = |tcp: &str| {
        format!(
            "; TEST\nN10 G17 G40 G64 G90 G94 G710\nN20 TRAFOOF\nN30 G0 SUPA Z0 D0\nN40 T1\nN50 M6\nN60 D1\nN70 G54\n\
             N80 S8000 M3\nN90 G0 A30 C=DC(350)\n{tcp}N120 X10 Y5\nN130 Z20\nN140 CYCLE832(0.0020,1,1)\n\
             N150 G1 X11 Z19 A31 C=DC(10) F500\nN160 Y6\nN170 M5\nN180 TRAFOOF\nN190 G0 SUPA Z0 D0\nN200 M30\n"
        )
    };
    let heidenhain = |tcp: &str| {
        format!(
            "0 BEGIN PGM TEST MM\n1 ; TEST\n2 FUNCTION RESET TCPM\n3 M126\n4 L Z+0.0000 R0 FMAX M91\n5 TOOL CALL 1 Z S8000\n\
             6 M3\n7 L A+30 C+350 FMAX\n{tcp}9 L X+10 Y+5 FMAX\n10 L Z+20 FMAX\n11 CYCL DEF 32.0 TOLERANCE\n\
             12 CYCL DEF 32.1 T0.0020\n13 CYCL DEF 32.2 HSC-MODE:0\n14 L X+11 Z+19 A+31 C+10 F500\n15 L Y+6\n16 M5\n\
             17 FUNCTION RESET TCPM\n18 L Z+0.0000 R0 FMAX M91\n19 M30\n20 END PGM TEST MM\n"
        )
    };
    let fanuc = |length: &str| {
        format!(
            "%\nO0001 (TEST)\nG17 G21 G40 G49 G80 G90 G94\nG53 G0 Z0\nT1 M6\nG54\nS8000 M3\nG0 A30 C350\n{length} H1\nX10 Y5\n\
             Z20\nG5.1 Q1\nG1 X11 Z19 A31 C10 F500\nY6\nG94\nG5.1 Q0\nM5\nG49\nG53 G0 Z0\nM30\n%\n"
        )
    };
    let linuxcnc = |switch: &str| {
        format!(
            "(TEST)\nG17 G21 G40 G49 G80 G90 G94\nG64 P0.0020\nM429\nG53 G0 Z0\nT1 M6\nG43 H1\nG54\nS8000 M3\nG0 A30 C350\n\
             {switch}X10 Y5\nZ20\nG1 X11 Z19 A31 C370 F500\nY6\nG94\nM5\nM429\nG53 G0 Z0\nM30\n"
        )
    };
    let tcpm = "8 FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\n";
    [
        ("sinumerik", [sinumerik(""), sinumerik("N100 TRAORI\nN110 ORIMKS ORIAXES\n")]),
        ("heidenhain", [heidenhain(""), heidenhain(tcpm)]),
        ("fanuc", [fanuc("G43"), fanuc("G43.4")]),
        ("linuxcnc", [linuxcnc(""), linuxcnc("M428\n")]),
    ]
}

fn read(text: &str, dialect: &str) -> Result<Vec<Station>, NoOpinion> {
    let part_zero_mm = [100.0, 0.0, -50.0];
    let setup = Setup { part_zero_mm, ..AT_ZERO };
    stations(text, dialect, machine!("trunnion-ac"), Some(setup))
}

#[test]
fn one_move_in_four_wordings() {
    // C from 350 on to 370 deg: tool at 30 and 31 deg about X, then about Z.
    let axis = |a: f64, c: f64| {
        let (a, c) = (a.to_radians(), c.to_radians());
        [a.sin() * c.sin(), -a.sin() * c.cos(), a.cos()]
    };
    for (dialect, texts) in wordings() {
        for (tcp, text) in texts.iter().enumerate() {
            let got = read(text, dialect).unwrap();
            assert_eq!(got.iter().map(|s| s.rapid).collect::<Vec<_>>(), [true, false, false], "{dialect}");
            for (k, (linear, a, c)) in [
                ([10.0, 5.0, 20.0], 30.0, 350.0),
                ([11.0, 5.0, 19.0], 31.0, 370.0),
                ([11.0, 6.0, 19.0], 31.0, 370.0),
            ]
            .into_iter()
            .enumerate()
            {
                // With the control on X Y Z are the tip in the part's frame; off they are joints.
                let (s, co) = f64::to_radians(a).sin_cos();
                let [x, y, z]: [f64; 3] = linear;
                let tilted = [x, y * co - z * s, y * s + z * co];
                let (s, co) = f64::to_radians(c).sin_cos();
                let joints = [
                    tilted[0] * co - tilted[1] * s - 100.0,
                    tilted[0] * s + tilted[1] * co,
                    tilted[2] + 50.0,
                ];
                near([got[k].tip_mm, got[k].axis], if tcp == 1 { linear } else { joints }, axis(a, c));
            }
        }
    }
}

#[test]
fn what_is_not_known_is_named() {
    let why = |text: &str, dialect: &str| match read(text, dialect) {
        Err(NoOpinion::Word { line, why, .. }) => (line, why),
        other => panic!("{other:?}"),
    };
    // Put in at a line of the head or of the moves.
    let cases: [(&str, usize, &str, Unread); 20] = [
        ("sinumerik", 13, "N135 G2 X5 I3", Unread::Unknown),
        ("sinumerik", 13, "N135 G91", Unread::Unknown),
        ("sinumerik", 13, "N135 ROT Z45", Unread::Misplaced),
        ("sinumerik", 13, "N135 SUB_ONE", Unread::Call),
        ("sinumerik", 13, "N135 X=R1", Unread::Syntax),
        ("sinumerik", 13, "N135 C20", Unread::EitherWay),
        ("sinumerik", 13, "N135 G55", Unread::Offset),
        ("sinumerik", 13, "N135 T2", Unread::Tool),
        ("sinumerik", 13, "N135 CYCLE800(1,\"\",0,57,0,0,0,0,0,0,0,0,0,0)", Unread::Misplaced),
        ("heidenhain", 11, "12 CC X+0 Y+0", Unread::Unknown),
        ("heidenhain", 11, "12 L IX+1", Unread::Unknown),
        ("heidenhain", 11, "12 LN X+1 TX+0 TY+0 TZ+1", Unread::Misplaced),
        ("heidenhain", 11, "12 M127", Unread::EitherWay),
        ("fanuc", 12, "G3 X1 Y1 R2", Unread::Unknown),
        ("fanuc", 12, "#1=5", Unread::Syntax),
        ("fanuc", 12, "G68.2 X1 Y0 Z0 I0 J0 K0", Unread::Misplaced),
        ("linuxcnc", 12, "G20", Unread::Unknown),
        ("linuxcnc", 12, "G10 L2 P1 X3", Unread::Unknown),
        ("linuxcnc", 12, "M66 P0", Unread::Unknown),
        ("linuxcnc", 12, "O100 CALL", Unread::Unknown),
    ];
    let all = wordings();
    for (dialect, after, word, want) in cases {
        let text = &all.iter().find(|w| w.0 == dialect).unwrap().1[0];
        let mut lines: Vec<&str> = text.lines().collect();
        lines.insert(after, word);
        let (line, got) = why(&lines.join("\n"), dialect);
        // Without the shortest way the next turn is named, not the word that says so.
        let expected = if word.ends_with("M127") { after + 4 } else { after + 1 };
        assert_eq!((line, got), (expected, want), "{dialect} {word}");
    }
    // What is left out matters as much: no length, no G90's place, no known Y.
    let linuxcnc = &all[3].1[0];
    assert_eq!(why(&linuxcnc.replace("G43 H1\n", ""), "linuxcnc"), (10, Unread::Length));
    assert_eq!(why(&linuxcnc.replace("X10 Y5\n", "X10\n"), "linuxcnc"), (13, Unread::Unplaced));
    assert_eq!(
        why(&linuxcnc.replace("M429\nG53 G0 Z0\nT1", "T1").replace("G0 A30", "A30"), "linuxcnc"),
        (8, Unread::Motion)
    );
    let sinumerik = &all[0].1[1];
    assert_eq!(why(&sinumerik.replace(" ORIAXES", ""), "sinumerik"), (16, Unread::Turning));
    // And the whole of it.
    assert!(matches!(read("", "fanuc"), Err(NoOpinion::Program { .. })));
    assert!(matches!(read(&linuxcnc.replace("M30\n", ""), "linuxcnc"), Err(NoOpinion::Program { .. })));
    assert!(matches!(read(linuxcnc, "mazatrol"), Err(NoOpinion::Dialect { .. })));
    let bad = machine!("trunnion-ac").replace("side = \"table\"", "side = \"table\"\nshear = 1");
    assert!(
        matches!(forward(&bad, HOME, [0.0; 2], 0.0), Err(NoOpinion::Machine { what }) if what.contains("shear"))
    );
    assert!(matches!(
        stations(linuxcnc, "linuxcnc", machine!("trunnion-ac"), None),
        Err(NoOpinion::Setup { .. })
    ));
}
