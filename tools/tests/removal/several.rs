//! Several tools one after the other: heights are the least of all, each tool has its own holder, and order counts for rapids.

use crate::removal::common::{ball, flat, sample, through, toroidal, upright};
use osculate_geom::analytic::Plane;
use osculate_geom::{Box3, Domain, Interval, Point3};
use osculate_tools::removal::stock::{Blank, Resolution};
use osculate_tools::removal::{
    Answer, Change, Cut, Goal, GoalFace, GoalLimits, GoalStep, GoalStock, GoalTool, Job, JobError, Looks,
    Program, ProveError, Sample, Swept, Verdict, cut, prove, prove_in_steps,
};
use osculate_tools::{Cutter, Holder, Pose};
use proptest::prelude::*;

/// Passes along x between two y, `step` apart, with the tip at a height.
fn raster([from, to]: [f64; 2], step: f64, z: f64) -> Vec<Pose> {
    let rows = ((to - from) / step).ceil() as usize;
    (0..=rows)
        .flat_map(|k| {
            let y = (from + step * k as f64).min(to);
            let ends = [upright(-8.0, y, z), upright(16.0, y, z)];
            if k % 2 == 0 { ends } else { [ends[1], ends[0]] }
        })
        .collect()
}

fn samples() -> Vec<Sample> {
    (0..400)
        .map(|k| sample([0.4 * f64::from(k % 20), 0.37 * f64::from(k / 20), 0.0], [0.0, 0.0, 1.0]))
        .collect()
}

/// What two tools leave, the second from motion `first` on.
fn both(
    tools: [(&Cutter, Option<&Holder>); 2],
    motions: &[Swept],
    first: usize,
    samples: &[Sample],
) -> Result<Vec<Cut>, JobError> {
    let [(cutter, holder), (next, other)] = tools;
    let changes = [Change { first, cutter: next, holder: other }];
    cut(&Job { cutter, holder, changes: &changes, motions, samples, stock_mm: 1.0, depth_mm: 2.0 }, &|_| ())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Each sample is as high as the lower of what the tools leave alone, to the last bit.
    #[test]
    fn heights_are_the_least_of_both(
        large in 5.0..20.0f64,
        small in 1.0..6.0f64,
        share in 0.2..0.9f64,
        [near, far] in [0.3..2.0f64, 0.1..0.8f64],
        lift in 0.0..0.2f64,
    ) {
        let (one, two) = (toroidal(large, 0.5 * share * large), ball(small));
        let poses = [raster([-1.0, 4.0], near, lift), raster([3.0, 8.5], far, 0.0)];
        let mut motions = through(&poses[0]);
        let first = motions.len();
        // Above everything from one to the other.
        let [end, begin] = [*poses[0].last().unwrap(), poses[1][0]];
        let up = |p: &Pose| upright(p.tip.x, p.tip.y, 30.0);
        let over = [end, up(&end), up(&begin), begin];
        motions.extend(through(&over));
        motions.extend(through(&poses[1]));
        let samples = samples();
        let got = both([(&one, None), (&two, None)], &motions, first, &samples).unwrap();
        let alone = |cutter: &Cutter, motions: &[Swept]| {
            cut(&Job { cutter, holder: None, changes: &[], motions, samples: &samples, stock_mm: 1.0, depth_mm: 2.0 }, &|_| ()).unwrap()
        };
        let (a, b) = (alone(&one, &motions[..first]), alone(&two, &motions[first..]));
        let (mut by, mut lower) = ([0; 2], [0; 2]);
        for ((got, a), b) in got.iter().zip(&a).zip(&b) {
            prop_assert!((got.standoff_mm - a.standoff_mm.min(b.standoff_mm)).abs() < 1e-12, "{got:?} {a:?} {b:?}");
            lower[0] += usize::from(a.standoff_mm < b.standoff_mm - 1e-12);
            lower[1] += usize::from(b.standoff_mm < a.standoff_mm - 1e-12);
            if let Some(cut) = got.by {
                let tool = usize::from(cut.motion as usize >= first);
                // Where both cut to the same height either may have done it.
                let own = if tool == 0 { a } else { b };
                prop_assert!((own.standoff_mm - got.standoff_mm).abs() < 1e-12);
                by[tool] += 1;
            }
        }
        // Where a large tool has been everywhere a small one is lower nowhere.
        prop_assert!(by[0] >= lower[0] && by[1] >= lower[1] && lower[0] + lower[1] > 50, "{by:?} {lower:?}");
    }
}

/// Only the second tool has a holder, and it meets a face that only it comes near.
#[test]
fn each_tool_has_its_own_holder() {
    let (long, short) = (flat(6.0), Cutter::cylinder(6.0, 4.0).unwrap());
    let holder = Holder::cylinder(30.0, 20.0).unwrap();
    let floor = sample([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    // A wall beside, as high as the nose of the short tool's holder lies deep.
    let top = sample([8.0, 0.0, 5.0], [0.0, 0.0, 1.0]);
    let motions = through(&[upright(-9.0, 0.0, 0.0), upright(0.0, 0.0, 0.0), upright(1.0, 0.0, 0.0)]);
    let of = |first: usize| {
        both([(&long, None), (&short, Some(&holder))], &motions, first, &[floor, top]).unwrap()[1]
    };
    // Who makes both motions has the holder; who makes the last one alone too; who makes none has not.
    for (first, meets) in [(0, true), (1, true), (2, false)] {
        let got = of(first);
        assert_eq!(got.holder.is_some(), meets, "{first}: {got:?}");
    }
}

/// A rapid of the second tool through what only the first has left.
#[test]
fn a_rapid_meets_what_the_tool_before_left() {
    let (one, two) = (ball(6.0), ball(4.0));
    let here = sample([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let down = |z: f64| through(&[upright(-5.0, 0.0, z), upright(5.0, 0.0, z)]);
    let rapid = |z: f64| down(z).into_iter().map(|m| Swept { rapid: true, ..m });
    let after = |cut: f64, quick: f64| {
        let motions: Vec<Swept> = down(cut).into_iter().chain(rapid(quick)).collect();
        both([(&one, None), (&two, None)], &motions, 1, &[here]).unwrap()[0]
    };
    assert!(after(0.2, 0.3).rapid.is_none());
    let took = after(0.4, 0.3).rapid.expect("it meets 0.1 mm").removed_mm;
    assert!((took - 0.1).abs() < 1e-9, "{took}");
    let wrong = both([(&one, None), (&two, None)], &down(0.0), 0, &[here]);
    assert!(wrong.is_ok());
    let changes =
        [Change { first: 1, cutter: &two, holder: None }, Change { first: 0, cutter: &two, holder: None }];
    let motions = down(0.0);
    let job = Job {
        cutter: &one,
        holder: None,
        changes: &changes,
        motions: &motions,
        samples: &[here],
        stock_mm: 1.0,
        depth_mm: 2.0,
    };
    assert_eq!(cut(&job, &|_| ()), Err(JobError::Changes { tool: 2, first: 0 }));
}

/// Two tools on a plate: the face of it, the block that it is cut from, and the program.
struct Plate {
    tools: [Cutter; 2],
    motions: Vec<Swept>,
    times_min: Vec<f64>,
    first: usize,
}

impl Plate {
    fn new([one, two]: [[f64; 2]; 2]) -> Self {
        let tools = [toroidal(6.0, 0.5), ball(4.0)];
        let mut poses = raster(one, 4.0, 0.0);
        let end = poses[poses.len() - 1];
        let second = raster(two, 0.1, 0.0);
        poses.extend([upright(end.tip.x, end.tip.y, 40.0)]);
        let mut motions = through(&poses);
        let first = motions.len();
        let begin = second[0];
        motions.extend(through(&[poses[poses.len() - 1], upright(begin.tip.x, begin.tip.y, 40.0), begin]));
        motions.extend(through(&second));
        let mut clock = 0.0;
        let times_min = motions
            .iter()
            .map(|m| {
                clock += (m.to.tip - m.from.tip).norm() / 300.0;
                clock
            })
            .collect();
        Self { tools, motions, times_min, first }
    }

    fn judged(&self, changes: &[usize], blank: Blank<'_>) -> Result<Verdict, ProveError> {
        self.with(changes, blank, |goal, program| prove(goal, program, &|_| ()))
    }

    fn with<T>(
        &self,
        changes: &[usize],
        blank: Blank<'_>,
        ask: impl FnOnce(&Goal<'_>, Program<'_>) -> T,
    ) -> T {
        let i = Interval::new(0.0, 8.0);
        let face = Plane::new(Domain { u: i, v: i });
        let tools = [(0, 3000.0), (1, 6000.0)].map(|(k, rpm)| GoalTool::new(&self.tools[k]).turning(2, rpm));
        let stock = GoalStock::Declared {
            blank,
            resolution: Resolution { cell_mm: 0.25, tri: true, budget_bytes: 1 << 28 },
            layer_mm: 0.5,
            words: "a plate",
        };
        let machined = vec![GoalFace::new("F1", &face)];
        let mut goal = Goal::new(machined, tools.to_vec(), stock, GoalLimits::new(0.01, 0.005));
        goal.looks = Looks::spaced(0.1, 100_000);
        ask(&goal, Program { motions: &self.motions, times_min: &self.times_min, changes })
    }
}

fn plate() -> Blank<'static> {
    Blank::Box(Box3 { min: Point3::new(-6.0, -6.0, -3.0), max: Point3::new(14.0, 14.0, 2.0) })
}

/// Half of a plate by one tool and half by another holds; with a strip between them it does not.
#[test]
fn a_plate_is_finished_by_two_tools() {
    let whole = Plate::new([[-2.0, 4.03], [5.0, 8.5]]);
    let verdict = whole.judged(&[whole.first], plate()).unwrap();
    assert_eq!(verdict.answer(), Answer::Held, "{verdict}");
    let text = verdict.to_string();
    assert!(
        text.contains("2 cutters one after the other") && text.contains("no holder declared of 1, 2"),
        "{text}"
    );
    assert!(text.contains("2 teeth at 3000 rpm") && text.contains("2 teeth at 6000 rpm"), "{text}");
    // The corner of the first is a quarter of the second's, and it turns half as fast.
    let two_circles = |r: f64, f: f64| r - (r * r - 0.25 * f * f).sqrt();
    let mark = verdict.figures().mark_max_mm.unwrap();
    assert!(mark >= two_circles(2.0, 0.025) && mark < two_circles(0.5, 0.05) + 1e-5, "{mark}");

    let apart = Plate::new([[-2.0, 2.0], [7.0, 8.5]]);
    let verdict = apart.judged(&[apart.first], plate()).unwrap();
    assert_eq!(verdict.answer(), Answer::NotHeld);
    assert!(verdict.why().iter().any(|w| w.contains("uncut area")), "{verdict}");

    let none = whole.judged(&[], plate());
    assert_eq!(none.unwrap_err(), ProveError::Tools { tools: 2, changes: 0 });
    let late = whole.judged(&[usize::MAX], plate());
    assert!(matches!(late, Err(ProveError::Tools { .. })));
}

/// What takes material faster than its tool's feed is counted, of ways through the air no speed is; it says itself where nothing tells a feed.
#[test]
fn feeds_are_held_against_material() {
    let both = Plate::new([[-2.0, 4.03], [5.0, 8.5]]);
    let first = both.first;
    let asked = |feeds: [Option<f64>; 2], hasten: &dyn Fn(&Swept) -> f64, timed: bool| {
        both.with(&[first], plate(), |goal, program| {
            let mut tools = goal.tools.clone();
            tools.iter_mut().zip(feeds).for_each(|(tool, feed)| tool.feed_mm_min = feed);
            let mut goal = Goal::new(goal.machined.clone(), tools, goal.stock, goal.limits);
            goal.looks = Looks::spaced(0.1, 100_000);
            let mut clock = 0.0;
            let each = program.motions.iter().map(|m| {
                clock += (m.to.tip - m.from.tip).norm() / hasten(m);
                clock
            });
            let times_min: Vec<f64> = if timed { each.collect() } else { Vec::new() };
            prove(&goal, Program { times_min: &times_min, ..program }, &|_| ()).unwrap()
        })
    };
    let row = |v: &Verdict| v.scope().iter().find(|r| r.what == "feed").unwrap().covers.clone();
    let even = |_: &Swept| 300.0;
    // In the air, between the tools, twenty times as fast.
    let in_air = |m: &Swept| if m.from.tip.z.min(m.to.tip.z) > 2.0 { 6000.0 } else { 300.0 };
    for speed in [&even as &dyn Fn(&Swept) -> f64, &in_air] {
        let verdict = asked([Some(300.0), Some(290.0)], speed, true);
        assert_eq!((verdict.answer(), &verdict.remarks().len()), (Answer::Held, &0), "{verdict}");
        assert!(row(&verdict).contains("no faster"), "{verdict}");
        assert_eq!(verdict.figures().stock.as_ref().unwrap().too_fast, None);
    }
    // The second tool takes along each of its rows but the first, which lies within what the first tool cut, and nothing outside of the plate.
    let verdict = asked([Some(300.0), Some(100.0)], &even, true);
    let found = verdict.figures().stock.as_ref().unwrap().too_fast.unwrap();
    let mut rows: Vec<f64> =
        both.motions[first..].iter().filter(|m| m.to.tip.z < 2.0).map(|m| m.to.tip.y).collect();
    rows.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    assert_eq!((rows.len(), found.moves), (36, 35));
    assert!((found.mm_min - 300.0).abs() < 1e-6 && found.feed_mm_min == 100.0, "{found:?}");
    assert!(
        verdict.remarks().iter().any(|r| *r == row(&verdict)) && row(&verdict).contains("300 mm/min"),
        "{verdict}"
    );
    // One of the two says nothing, or no motion says how long it takes.
    for (feeds, timed) in [([Some(300.0), None], true), ([Some(300.0), Some(100.0)], false)] {
        let verdict = asked(feeds, &even, timed);
        assert!(row(&verdict).starts_with("NOT looked at"), "{verdict}");
    }
}

/// What is left when the first of two operations ends is what the second begins from and what both have left; each is judged as it is
/// then, on what is measured for the whole, whose verdict stays the same.
#[test]
fn operations_are_judged_when_they_end() {
    let both = Plate::new([[-2.0, 4.03], [5.0, 8.5]]);
    let (first, all) = (both.first, both.motions.len());
    let alone = both.judged(&[first], plate()).unwrap();
    let proved = both.with(&[first], plate(), |goal, program| {
        let own = |tools: usize| {
            let tools = goal.tools[..tools].to_vec();
            let mut own = Goal::new(goal.machined.clone(), tools, goal.stock, goal.limits);
            own.limits.at_samples = true;
            own.looks = goal.looks;
            own.looks.between = false;
            own
        };
        let steps = [
            GoalStep { goal: own(1), from: 0, motions: 0..first },
            GoalStep { goal: own(2), from: first, motions: first..all },
        ];
        let wrong = prove_in_steps(goal, program, (&[all, first], &steps), &|_| ());
        assert!(matches!(wrong, Err(ProveError::Stops { .. })));
        prove_in_steps(goal, program, (&[first, all], &steps), &|_| ()).unwrap()
    });
    assert_eq!(proved.whole.answer(), Answer::Held);
    assert_eq!((proved.whole.to_string(), proved.whole.cuts()), (alone.to_string(), alone.cuts()));
    let of = |v: &Verdict| v.figures().stock.clone().unwrap();
    let (whole, halfway, after) = (of(&proved.whole), of(&proved.steps[0]), of(&proved.steps[1]));
    assert_eq!(whole, of(&alone));
    assert_eq!((&after.stock, after.before), (&whole.stock, halfway.left));
    assert!(halfway.carved.volume_mm3() > 1.0 && after.carved.volume_mm3() > 1.0);
    let sum = halfway.carved.volume_mm3() + after.carved.volume_mm3();
    assert!((sum - whole.carved.volume_mm3()).abs() < 1e-9 * sum);
    // Motions and blocks are those of the whole program.
    assert!(after.carved.work.iter().all(|w| w.motion as usize >= first));
    // The first leaves nearly half of the plate, and harms nothing; at its samples it has left what its motions alone leave there.
    let [one, two] = &proved.steps[..] else { panic!("two operations") };
    assert!(one.answer() == Answer::NotHeld && one.leaves_only(), "{one}");
    assert!((one.figures().tally.uncut_area_mm2 - 8.0 * (8.0 - 4.03 - 2.5)).abs() < 2.0, "{one}");
    let tool = &both.tools[0];
    let job = Job {
        cutter: tool,
        holder: None,
        changes: &[],
        motions: &both.motions[..first],
        samples: one.samples(),
        stock_mm: 0.5,
        depth_mm: 3.0,
    };
    assert_eq!(one.cuts(), cut(&job, &|_| ()).unwrap());
    assert_eq!(two.answer(), Answer::Held, "{two}");
    assert_eq!(two.figures().tally.worst, proved.whole.figures().tally.worst);
}
