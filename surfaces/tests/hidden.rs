//! Faces hidden in other bodies, against closed forms.

use crate::bodies;

use bodies::{ball, block, frame, post, splined, within};
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Surface};
use osculate_surfaces::Face;
use osculate_surfaces::hidden::{Hidden, hidden};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// Areas to this part of them.
const AREA: f64 = 1e-3;

fn found(faces: &[Face]) -> Hidden {
    let all: Vec<&Face> = faces.iter().collect();
    hidden(&all, &vec![true; all.len()], None)
}

/// Every face has the hidden area that is wanted, and nothing is left unknown.
fn assert_hidden(faces: &[Face], wanted: &[f64]) -> Hidden {
    let got = found(faces);
    assert!(got.unknown.is_empty(), "{:?}", got.unknown);
    assert_eq!(faces.len(), wanted.len());
    for (k, want) in wanted.iter().enumerate() {
        let of = got.faces.iter().find(|f| f.face == k);
        let area = of.map_or(0.0, |f| f.hidden_mm2);
        assert!((area - want).abs() <= AREA * want, "face {k}: {area} where {want} is wanted");
        let whole = (faces[k].area_mm2() - want).abs() <= 1e-5 * want;
        assert_eq!(of.is_some_and(|f| f.visible.is_none()), whole, "face {k}");
    }
    got
}

/// Frames that turn a part: none, and two without any symmetry.
fn turned() -> [Placement; 3] {
    [
        frame([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        frame([13.0, -4.0, 7.0], [0.3, -0.7, 0.5], [0.9, 0.2, -0.4]),
        frame([-220.0, 31.0, 90.0], [-0.61, 0.24, -0.53], [0.11, 0.87, 0.3]),
    ]
}

fn at(x: f64, y: f64, z: f64) -> Placement {
    frame([x, y, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
}

/// A post of radius 8 that stands in a plate of 100 x 80 x 10, from within it and through it.
#[test]
fn a_post_in_a_plate() {
    for part in turned() {
        let plate = || block(&part, [100.0, 80.0, 10.0]);
        let disk = PI * 64.0;
        let faces = [plate(), post(&within(&part, &at(30.0, 41.0, 4.0)), 8.0, 36.0)].concat();
        let got = assert_hidden(&faces, &[0.0, 0.0, 0.0, 0.0, 0.0, disk, TAU * 8.0 * 6.0, disk, 0.0]);
        assert_eq!(got.faces[0].within, [vec![6, 7, 8]]);
        assert_eq!(got.faces[1].within, [vec![0, 1, 2, 3, 4, 5]]);
        let faces = [plate(), post(&within(&part, &at(30.0, 41.0, -5.0)), 8.0, 36.0)].concat();
        assert_hidden(&faces, &[0.0, 0.0, 0.0, 0.0, disk, disk, TAU * 8.0 * 10.0, 0.0, 0.0]);
    }
}

/// A post that stands over the edge of a plate: the line of intersection ends on the plate's own edge, and so does the wall's.
#[test]
fn a_post_over_the_edge_of_a_plate() {
    for part in turned() {
        // Its axis is 3 from the side y = 0 of the plate.
        let faces =
            [block(&part, [100.0, 80.0, 10.0]), post(&within(&part, &at(50.0, 3.0, -5.0)), 8.0, 36.0)]
                .concat();
        let (r, d): (f64, f64) = (8.0, 3.0);
        let half = (d / r).acos();
        let segment = r * r * (half - half.sin() * half.cos());
        let disk = PI * r * r - segment;
        let chord = 2.0 * (r * r - d * d).sqrt();
        let wall = r * (TAU - 2.0 * half) * 10.0;
        assert_hidden(&faces, &[0.0, 0.0, chord * 10.0, 0.0, disk, disk, wall, 0.0, 0.0]);
    }
}

/// A ball half in a block, its axis anyhow: the line may run along its seam and through its poles.
#[test]
fn half_a_ball_in_a_block() {
    for part in turned() {
        for axis in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.3, 0.6, 0.2]] {
            let own = frame([20.0, 17.0, 30.0], axis, [0.2, 0.9, -0.1]);
            let faces = [block(&part, [40.0, 40.0, 30.0]), ball(&within(&part, &own), 9.0)].concat();
            assert_hidden(&faces, &[0.0, 0.0, 0.0, 0.0, 0.0, PI * 81.0, TAU * 81.0]);
        }
    }
}

/// The mean over a period is exact to rounding for a smooth function.
fn around(f: impl Fn(f64) -> f64) -> f64 {
    let n = 4000;
    (0..n).map(|k| f(TAU * f64::from(k) / f64::from(n))).sum::<f64>() * TAU / f64::from(n)
}

/// Cylinders of radius 5 and 3 through each other.
#[test]
fn two_cylinders_cross() {
    let (large, small) = (5.0_f64, 3.0_f64);
    let thin = around(|t| small * 2.0 * (large * large - (small * t.sin()).powi(2)).sqrt());
    // Over y = 3 sin t: the height 2 sqrt(9 - y^2), the arc 5 dy / sqrt(25 - y^2), on both sides; t goes twice over it.
    let thick = around(|t| {
        let y = small * t.sin();
        2.0 * (small * t.cos()).powi(2) * large / (large * large - y * y).sqrt()
    });
    for part in turned() {
        let lying = frame([-20.0, 0.0, 20.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.3]);
        let faces = [post(&part, large, 40.0), post(&within(&part, &lying), small, 40.0)].concat();
        assert_hidden(&faces, &[thick, 0.0, 0.0, thin, 0.0, 0.0]);
    }
}

/// Bodies that only touch hide nothing of each other: on a plane, with flush sides, on a line, at a point.
#[test]
fn bodies_that_touch_hide_nothing() {
    for part in turned() {
        let plate = block(&part, [100.0, 80.0, 10.0]);
        let others = [
            post(&within(&part, &at(30.0, 41.0, 10.0)), 8.0, 36.0),
            block(&within(&part, &at(0.0, 0.0, 10.0)), [20.0, 80.0, 5.0]),
            ball(&within(&part, &at(50.0, 40.0, 19.0)), 9.0),
            post(&within(&part, &frame([50.0, 10.0, 13.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])), 3.0, 40.0),
        ];
        for other in others {
            let faces = [plate.clone(), other].concat();
            assert_hidden(&faces, &vec![0.0; faces.len()]);
        }
    }
}

/// A block let into another one with flush tops, and one with a flush side.
#[test]
fn flush_faces_are_not_hidden() {
    for part in turned() {
        let plate = || block(&part, [100.0, 80.0, 10.0]);
        let let_in = block(&within(&part, &at(20.0, 20.0, 3.0)), [30.0, 40.0, 7.0]);
        let mut wanted = vec![0.0; 6];
        wanted.extend([280.0, 280.0, 210.0, 210.0, 1200.0, 0.0]);
        assert_hidden(&[plate(), let_in].concat(), &wanted);
        let beside = block(&within(&part, &at(20.0, 0.0, 3.0)), [30.0, 40.0, 27.0]);
        let wanted = [0.0, 0.0, 0.0, 0.0, 0.0, 1200.0, 280.0, 280.0, 0.0, 210.0, 1200.0, 0.0];
        assert_hidden(&[plate(), beside].concat(), &wanted);
    }
}

#[test]
fn a_body_within_another() {
    for part in turned() {
        let own = frame([20.0, 17.0, 15.0], [0.3, 0.6, 0.2], [1.0, 0.0, 0.0]);
        let faces = [block(&part, [40.0, 40.0, 30.0]), ball(&within(&part, &own), 9.0)].concat();
        assert_hidden(&faces, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0 * PI * 81.0]);
        // The wall of a void is no body: it is where the material ends.
        let faces =
            [block(&part, [40.0, 40.0, 30.0]), vec![ball(&within(&part, &own), 9.0)[0].clone().flipped()]];
        assert_hidden(&faces.concat(), &[0.0; 7]);
    }
}

/// Two bars across each other on a plate: what both hide counts once.
#[test]
fn three_bodies() {
    for part in turned() {
        let bar = |x: f64, y: f64, size| block(&within(&part, &at(x, y, -2.0)), size);
        let plate = block(&within(&part, &at(-20.0, -20.0, -10.0)), [40.0, 40.0, 10.0]);
        let faces =
            [plate, bar(-10.0, -3.0, [20.0, 6.0, 22.0]), bar(-3.0, -10.0, [6.0, 20.0, 17.0])].concat();
        let wanted = [
            [0.0, 0.0, 0.0, 0.0, 0.0, 204.0],
            // Ends 6 x 2 in the plate; sides 20 x 2 there and 6 x 15 in the other bar.
            [12.0, 12.0, 130.0, 130.0, 120.0, 0.0],
            [130.0, 130.0, 12.0, 12.0, 120.0, 36.0],
        ];
        assert_hidden(&faces, wanted.as_flattened());
    }
}

/// Faces on splines, where steps beyond a side end at it.
#[test]
fn faces_on_splines() {
    for part in turned() {
        let own = frame([30.0, 41.0, 4.0], [0.1, 0.2, 1.0], [1.0, 0.0, 0.0]);
        let exact = [
            block(&part, [100.0, 80.0, 10.0]),
            post(&within(&part, &own), 8.0, 36.0),
            ball(&within(&part, &at(70.0, 40.0, 8.0)), 9.0),
        ]
        .concat();
        let areas = |faces: &[Face]| {
            let got = found(faces);
            assert!(got.unknown.is_empty(), "{:?}", got.unknown);
            got.faces.iter().map(|f| (f.face, f.hidden_mm2)).collect::<Vec<_>>()
        };
        let (wanted, got) = (areas(&exact), areas(&exact.iter().map(splined).collect::<Vec<_>>()));
        assert_eq!(wanted.len(), got.len());
        for (w, g) in wanted.iter().zip(&got) {
            assert!(w.0 == g.0 && (w.1 - g.1).abs() <= AREA * w.1, "{w:?} {g:?}");
        }
    }
}

/// Without a word of the file on sides: bodies are told by the volume that they close around.
#[test]
fn sides_need_not_be_known() {
    let faces =
        [block(&at(0.0, 0.0, 0.0), [100.0, 80.0, 10.0]), post(&at(30.0, 41.0, 4.0), 8.0, 36.0)].concat();
    let turned: Vec<Face> = faces
        .iter()
        .enumerate()
        .map(|(k, f)| if k % 3 == 0 { f.clone().flipped() } else { f.clone() })
        .collect();
    let got = hidden(&turned.iter().collect::<Vec<_>>(), &[false; 9], None);
    let known = found(&faces);
    assert_eq!((got.faces.len(), known.faces.len()), (3, 3));
    for (g, k) in got.faces.iter().zip(&known.faces) {
        assert!(g.face == k.face && (g.hidden_mm2 - k.hidden_mm2).abs() <= 1e-9 * k.hidden_mm2);
    }
}

/// Lengths of any size.
#[test]
fn the_size_of_the_part_does_not_matter() {
    for size in [1e-3, 1.0, 1e4] {
        let plate = block(&at(0.0, 0.0, 0.0), [100.0 * size, 80.0 * size, 10.0 * size]);
        let own = frame([30.0 * size, 41.0 * size, 4.0 * size], [0.1, 0.2, 1.0], [1.0, 0.0, 0.0]);
        let faces = [plate, post(&own, 8.0 * size, 36.0 * size)].concat();
        let got = found(&faces);
        assert!(got.unknown.is_empty(), "{:?}", got.unknown);
        // The ellipse in which the plane across z cuts the post.
        let want = PI * 64.0 * size * size * 1.05_f64.sqrt();
        let top = got.faces.iter().find(|f| f.face == 5).unwrap().hidden_mm2;
        assert!((top - want).abs() < AREA * want, "{top} {want}");
    }
}

#[test]
fn one_body_alone_hides_nothing_and_threads_do_not_matter() {
    assert!(found(&block(&at(0.0, 0.0, 0.0), [1.0, 2.0, 3.0])).faces.is_empty());
    assert!(found(&[]).faces.is_empty());
    let faces = [
        block(&at(0.0, 0.0, 0.0), [100.0, 80.0, 10.0]),
        post(&at(30.0, 41.0, 4.0), 8.0, 36.0),
        ball(&at(31.0, 50.0, 12.0), 9.0),
    ]
    .concat();
    let with = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        let found = pool.install(|| found(&faces));
        let areas: Vec<u64> = found.faces.iter().map(|f| f.hidden_mm2.to_bits()).collect();
        let loops: Vec<_> =
            found.faces.iter().filter_map(|f| f.visible.as_ref()).map(|v| v.loops().to_vec()).collect();
        (areas, loops, found.unknown)
    };
    assert!(with(1) == with(4));
}

/// The rim of a post runs through a block's edge 0.0004 of the post's turn before its seam: a triangle of 0.005 mm by 0.0025 is
/// left in the corner of its wall. And the corner of a block stands 0.024 mm out of another one: less than faces may gape.
#[test]
fn corners_smaller_than_gaps() {
    let post = (
        (
            Solid::Block([13.833659663099743, 8.0, 24.717313124404786]),
            [4.430050499329019, -3.0092538580314967, 6.777940508011465],
            [0.5189146658848016, -0.9713845521649042, -0.9180017004866979],
            [-0.3736917626565494, 0.8470997753447208, 0.60366209501846],
        ),
        (
            Solid::Post(7.020426332584241, 28.50049414844557),
            [3.7791686482051268, 2.4607781760794234, 5.016038563289032],
            [0.5495507900682766, -0.7738946838373644, 0.02799634383599844],
            [0.29374275731592164, 0.28682497608059815, -0.78819677505108],
        ),
    );
    let corner = (
        (
            Solid::Block([14.059222603728855, 20.20038369504883, 22.30963448824012]),
            [5.618104471609571, -2.570971217733398, 0.8685880101428801],
            [0.5111949361023403, -0.8937510797466073, 0.5999602324781669],
            [-0.253952684773288, 0.1506333416360355, 0.3471389919739681],
        ),
        (
            Solid::Block([24.411301228812594, 11.122084980282116, 12.323926136515729]),
            [9.648167408314036, 9.431590391453648, 4.822552740272968],
            [0.8410697185459005, -0.6746852459034313, -0.5617736949075804],
            [-0.7842121260542027, -0.338567336912192, 0.9713028018350707],
        ),
    );
    for (a, b) in [post, corner] {
        let made = [a, b].map(|(of, at, z, x)| made(of, &frame(at, z, x)));
        let got = found(&made.concat());
        assert!(got.unknown.is_empty(), "{:?}", got.unknown);
    }
}

/// Signed depth in a body by its closed form, positive inside, no deeper than it is.
fn depth(p: &Point3, at: &Placement, of: Solid) -> f64 {
    let q = at.local(p);
    match of {
        Solid::Block(size) => (0..3).map(|k| q[k].min(size[k] - q[k])).fold(f64::INFINITY, f64::min),
        Solid::Post(r, h) => (r - q.x.hypot(q.y)).min(q.z).min(h - q.z),
        Solid::Ball(r) => r - q.coords.norm(),
    }
}

#[derive(Clone, Copy, Debug)]
enum Solid {
    Block([f64; 3]),
    Post(f64, f64),
    Ball(f64),
}

fn made(of: Solid, at: &Placement) -> Vec<Face> {
    match of {
        Solid::Block(size) => block(at, size),
        Solid::Post(r, h) => post(at, r, h),
        Solid::Ball(r) => ball(at, r),
    }
}

fn any_solid() -> impl Strategy<Value = (Solid, [f64; 3], [f64; 3], [f64; 3])> {
    let size = prop_oneof![
        prop::array::uniform3(8.0..30.0_f64).prop_map(Solid::Block),
        (4.0..12.0_f64, 10.0..40.0_f64).prop_map(|(r, h)| Solid::Post(r, h)),
        (5.0..12.0_f64).prop_map(Solid::Ball),
    ];
    let place = prop::array::uniform3(-10.0..10.0_f64);
    let way = || {
        prop::array::uniform3(-1.0..1.0_f64)
            .prop_filter("long", |d| d.iter().map(|c| c * c).sum::<f64>() > 0.1)
    };
    (size, place, way(), way())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Two bodies anyhow: a place of a face is left where the closed form of the other body has it outside.
    #[test]
    fn what_is_left_is_outside_the_other_body((a, pa, za, xa) in any_solid(), (b, pb, zb, xb) in any_solid()) {
        let frames = [frame(pa, za, xa), frame(pb, zb, xb)];
        let bodies = [made(a, &frames[0]), made(b, &frames[1])];
        let faces = bodies.concat();
        let got = found(&faces);
        prop_assert!(got.unknown.is_empty(), "{:?}", got.unknown);
        for (k, face) in faces.iter().enumerate() {
            let other = if k < bodies[0].len() { (frames[1], b) } else { (frames[0], a) };
            let hiding = got.faces.iter().find(|f| f.face == k);
            for (at, p) in face.surface.samples(9) {
                let depth = depth(&p, &other.0, other.1);
                // The tolerances of border and depth, with room for flat angles between the bodies.
                if depth.abs() < 0.02 {
                    continue;
                }
                let visible = hiding.is_none_or(|h| h.visible.as_ref().is_some_and(|v| v.contains(at)));
                prop_assert_eq!(visible, depth < 0.0, "face {} at {} {}: depth {}", k, at.u, at.v, depth);
            }
        }
    }
}
