//! Random faults in good NC programs: what verification finds, against a slow reference.
//!
//! A good program of a patch of a paraboloid is posted in each dialect, for tool-centre-point control and without. A fault
//! changes its text (or the length of the tool that the reader is told). Verification reads it back and judges it. The
//! reference judges the same motions by brute force: at its own places, which are not verification's samples, it puts the
//! tool at many frozen poses of every motion and keeps the lowest entry, in the order of the program. Where that comes within
//! [`BAND`] of a limit the fault is counted apart: the two look at different places.

use osculate_geom::analytic::Paraboloid;
use osculate_geom::{Axis, Point3, Surface, Unit3, Vec3, uv};
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, post};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::removal::{Job, Limits, Swept, cut, judge, sample_surface};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, Line, Pose};
use std::collections::BTreeMap;

/// Half the side of the patch, mm.
const HALF: f64 = 4.0;
const COEFFICIENTS: [f64; 2] = [-0.006, 0.004];
const LIMITS: Limits =
    Limits { scallop_mm: 0.03, gouge_mm: 0.01, uncut_mm: 0.15, collision_mm: 0.01, worst: 3 };
const STOCK_MM: f64 = 0.6;
const DEPTH_MM: f64 = 1.5;
/// Share of a limit within which the two may differ: at samples 0.1 mm apart a gouge of relative curvature 0.4 looks up to
/// `0.4 * 0.07^2 / 2` = 0.001 mm shallower, a tenth of the limit.
pub const BAND: f64 = 0.12;

/// A generator good enough to choose faults (Knuth's constants).
pub struct Dice(u64);

impl Dice {
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

/// What verification says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Says {
    Refused,
    NotWithin,
    Within,
}

/// What the reference says: the largest share of a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    pub share: f64,
}

/// One fault.
#[derive(Clone, Debug)]
pub struct Row {
    pub dialect: Dialect,
    pub tcp: bool,
    pub kind: &'static str,
    pub fault: String,
    pub says: Says,
    pub truth: Option<Truth>,
}

impl Row {
    /// Whether the fault has an effect above the limits, None where it comes too close to tell.
    pub fn harmful(&self) -> Option<bool> {
        match self.truth {
            // What even lenient reading cannot follow is a fault.
            None => Some(true),
            Some(t) if t.share > 1.0 + BAND => Some(true),
            Some(t) if t.share < 1.0 - BAND => Some(false),
            Some(_) => None,
        }
    }
    pub fn right(&self) -> Option<bool> {
        self.harmful().map(|bad| bad == (self.says != Says::Within))
    }
}

pub struct Good {
    pub text: String,
    pub dialect: Dialect,
    pub feed: FeedMode,
    setup: Setup,
    machine: Machine,
    cutter: Cutter,
}

fn surface() -> Paraboloid {
    Paraboloid::new(COEFFICIENTS, HALF).expect("a good paraboloid")
}

/// A good program: passes along x, each at its own height, with a retract at both ends.
pub fn good(dialect: Dialect, feed: FeedMode, ball: bool) -> Good {
    let (spec, lead, step) = if ball {
        (CutterSpec::Ball { diameter_mm: 6.0, length_mm: 40.0 }, 0.3, 0.7)
    } else {
        (CutterSpec::Toroidal { diameter_mm: 10.0, corner_radius_mm: 2.0, length_mm: 40.0 }, 0.15, 1.1)
    };
    let cutter = Cutter::try_from(spec).expect("a good cutter");
    // Passes run out over the patch's sides.
    let part = Paraboloid::new(COEFFICIENTS, 2.0 * HALF).expect("a good paraboloid");
    let lean = Lean { lead_rad: lead, tilt_rad: 0.2 };
    let mut moves: Vec<ClMove> = Vec::new();
    let rows = (2.0 * HALF / step).ceil() as u32 + 2;
    for i in 0..rows {
        let y = (-HALF - 0.3 * step + step * f64::from(i)).min(HALF + 0.3 * step);
        for k in 0..=24u32 {
            let x = (HALF + 0.8) * (f64::from(k) / 12.0 - 1.0);
            let contact = Contact::new(&part, uv(x, y), &cutter, FeedLine::Iso(Axis::U), lean).expect("fits");
            let pose = lean.pose(&cutter, &contact.frame, 0.0);
            let lifted = ClMove { pose: pose.retracted(15.0), motion: Motion::Rapid };
            if k == 0 {
                moves.push(lifted);
            }
            moves.push(ClMove { pose, motion: Motion::Feed(800.0) });
            if k == 24 {
                moves.push(ClMove { pose: pose.retracted(15.0), motion: Motion::Rapid });
            }
        }
    }
    let path = ClPath { cutter: Some(spec), holder: None, spindle_rpm: Some(6000.0), moves };
    let machine = Machine::built_in("trunnion-ac").expect("built in");
    let setup = Setup::at(Vec3::new(0.0, 0.0, 30.0), 40.0);
    let posted = post(&path, &machine, &setup, &PostOptions::new(dialect, feed)).expect("within reach");
    Good { text: posted.text, dialect, feed, setup, machine, cutter }
}

/// Motions of a text, or None where it is refused.
fn motions(g: &Good, text: &str, setup: &Setup, strict: bool) -> Option<Vec<Swept>> {
    let options = ReadOptions { strict, ..ReadOptions::default() };
    let found = read(text, g.dialect, &g.machine, setup, &options).ok()?;
    let pairs = found.moves.windows(2);
    Some(
        pairs
            .map(|w| Swept {
                from: w[0].pose,
                to: w[1].pose,
                rapid: matches!(w[1].motion, Motion::Rapid),
                block: w[1].line as u32,
            })
            .collect(),
    )
}

/// What `verify` does.
pub fn verify(g: &Good, motions: &[Swept], cutter: &Cutter) -> Says {
    let sampling = sample_surface(&surface(), 0, 0.1, 20_000).expect("a good patch");
    let job = Job {
        cutter,
        holder: None,
        motions,
        samples: &sampling.samples,
        stock_mm: STOCK_MM,
        depth_mm: DEPTH_MM,
    };
    let _ = g;
    let Ok(cuts) = cut(&job, &|_| ()) else { return Says::Refused };
    let v =
        judge(&sampling.samples, &cuts, &LIMITS, &sampling.density, cutter.radius_mm()).expect("good limits");
    if v.within { Says::Within } else { Says::NotWithin }
}

/// The reference: frozen poses, motion by motion in order, at places of its own.
pub fn reference(motions: &[Swept], cutter: &Cutter, side: u32) -> Truth {
    let part = surface();
    let reach = cutter.length_mm().hypot(cutter.radius_mm());
    let mut share = 0.0f64;
    for i in 0..side * side {
        let at = |k: u32, shift: f64| HALF * (2.0 * (f64::from(k) + shift) / f64::from(side) - 1.0);
        let place = uv(at(i % side, 0.377), at(i / side, 0.613));
        let jet = part.jet2(place);
        let normal = jet.normal().expect("regular");
        let (mut height, mut touched) = (STOCK_MM, false);
        for m in motions {
            let turn = (m.to.axis.into_inner() - m.from.axis.into_inner()).norm();
            let way = (m.to.tip - m.from.tip).norm();
            // A point of the tool goes at most this far; the tool's distance changes by no more.
            let moved = way + 1.1 * turn * reach;
            if cutter.distance(&m.from, &jet.point) > moved + STOCK_MM {
                continue;
            }
            let before = height;
            let steps = ((moved / 0.01).ceil() as u32).clamp(4, 20_000);
            for k in 0..=steps {
                let t = f64::from(k) / f64::from(steps);
                let axis = m.from.axis.into_inner() * (1.0 - t) + m.to.axis.into_inner() * t;
                let pose =
                    Pose { tip: m.from.tip + (m.to.tip - m.from.tip) * t, axis: Unit3::new_normalize(axis) };
                if cutter.distance(&pose, &jet.point) > height.max(0.0) {
                    continue;
                }
                let entry = |p: Point3, d: Unit3| cutter.entry(&pose, &Line { origin: p, direction: d });
                let Some(up) = entry(jet.point, normal) else { continue };
                let exit = entry(jet.point, -normal).map_or(f64::INFINITY, |e| -e.at_mm);
                if exit < 0.0 {
                    continue;
                }
                let here = if up.at_mm >= 0.0 { up.at_mm } else { up.at_mm.max(-exit) };
                height = height.min(here.max(-DEPTH_MM));
            }
            touched |= height < before;
            if m.rapid {
                share = share.max((before - height) / LIMITS.collision_mm);
            }
        }
        let uncut = if touched { height / LIMITS.scallop_mm } else { 10.0 };
        share = share.max(uncut).max(-height / LIMITS.gouge_mm);
    }
    Truth { share }
}

/// Lines of the text that name axes.
fn cutting(text: &str) -> Vec<usize> {
    let has = |l: &str| ["X", "Y", "Z", "A", "C"].iter().filter(|a| word(l, a).is_some()).count() >= 2;
    text.lines().enumerate().filter(|(_, l)| has(l)).map(|(k, _)| k).collect()
}

/// The place of an axis word's number in a line.
fn word(line: &str, axis: &str) -> Option<(usize, usize)> {
    let bytes = line.as_bytes();
    let digit = |k: usize| bytes.get(k).is_some_and(|b| b.is_ascii_digit() || b"+-.".contains(b));
    for (k, _) in line.match_indices(axis) {
        let alone = k == 0 || !bytes[k - 1].is_ascii_alphanumeric();
        let mut from = k + axis.len();
        if bytes.get(from) == Some(&b'=') {
            from += 1;
        }
        if alone && digit(from) {
            let to = (from..bytes.len()).take_while(|j| digit(*j)).count() + from;
            return Some((from, to));
        }
    }
    None
}

const KINDS: [&str; 12] = [
    "digit",
    "last digit",
    "word left out",
    "line left out",
    "lines swapped",
    "sign",
    "rapid for feed",
    "line twice",
    "feed",
    "comment",
    "tool length",
    "tool radius",
];

/// One fault, chosen by the dice; None where the line has nothing to change.
pub fn fault(g: &Good, dice: &mut Dice, side: u32) -> Option<Row> {
    let kind = KINDS[dice.below(KINDS.len())];
    let mut lines: Vec<String> = g.text.lines().map(str::to_owned).collect();
    let spots = cutting(&g.text);
    let k = spots[spots.len() / 8 + dice.below(spots.len() * 3 / 4)];
    let before = lines[k].clone();
    let axes = ["X", "Y", "Z", "A", "C"];
    let axis = axes[dice.below(axes.len())];
    let (mut setup, mut cutter) = (g.setup, g.cutter);
    let mut note = String::new();
    match kind {
        "digit" | "last digit" => {
            let (from, to) = word(&before, axis)?;
            let digits: Vec<usize> = (from..to).filter(|j| before.as_bytes()[*j].is_ascii_digit()).collect();
            let at = if kind == "digit" { digits[dice.below(digits.len())] } else { *digits.last()? };
            let old = before.as_bytes()[at];
            let new = b'0' + (old - b'0' + 1 + dice.below(9) as u8) % 10;
            lines[k].replace_range(at..=at, &char::from(new).to_string());
        }
        "word left out" => {
            let (from, to) = word(&before, axis)?;
            let letter = before[..from].rfind(axis)?;
            lines[k].replace_range(letter..to, "");
        }
        "line left out" => {
            lines.remove(k);
        }
        "lines swapped" => {
            let other = *spots.iter().find(|s| **s > k)?;
            lines.swap(k, other);
        }
        "sign" => {
            let (from, _) = word(&before, axis)?;
            match before.as_bytes()[from] {
                b'-' => lines[k].replace_range(from..=from, ""),
                b'+' => lines[k].replace_range(from..=from, "-"),
                _ => lines[k].insert(from, '-'),
            }
        }
        "rapid for feed" => {
            if g.dialect == Dialect::Heidenhain {
                let cut = before.find(" F").unwrap_or(before.len());
                lines[k] = format!("{} FMAX", &before[..cut]);
            } else if before.contains("G1") {
                lines[k] = before.replacen("G1", "G0", 1);
            } else {
                let (from, _) = axes.iter().filter_map(|a| word(&before, a)).min()?;
                let letter = before[..from].rfind(|c: char| c.is_ascii_alphabetic())?;
                lines[k].insert_str(letter, "G0 ");
            }
        }
        "line twice" => lines.insert(k, before.clone()),
        "feed" => {
            let (from, to) = word(&before, "F")?;
            lines[k].replace_range(from..to, "123.");
        }
        "comment" => {
            let text = match g.dialect {
                Dialect::Sinumerik | Dialect::Heidenhain => "; a remark",
                Dialect::Fanuc | Dialect::LinuxCnc => "(A REMARK)",
            };
            lines[k].push(' ');
            lines[k].push_str(text);
        }
        "tool length" => {
            let off = [0.0005, 0.002, 0.05, 0.3][dice.below(4)];
            setup.gauge_length_mm += off;
            note = format!("{off} mm");
        }
        _ => {
            let off = [0.0005, 0.002, 0.06, 0.3][dice.below(4)];
            let (diameter_mm, length_mm) = (2.0 * (cutter.radius_mm() + off), cutter.length_mm());
            let spec = if cutter.is_ball() {
                CutterSpec::Ball { diameter_mm, length_mm }
            } else {
                CutterSpec::Toroidal { diameter_mm, corner_radius_mm: cutter.corner_mm(), length_mm }
            };
            cutter = Cutter::try_from(spec).ok()?;
            note = format!("{off} mm");
        }
    }
    let text = lines.join("\n") + "\n";
    let says = motions(g, &text, &setup, true).map_or(Says::Refused, |m| verify(g, &m, &cutter));
    let truth = motions(g, &text, &setup, false).map(|m| reference(&m, &cutter, side));
    if note.is_empty() {
        note = format!("line {}: {} -> {}", k + 1, before.trim(), lines.get(k).map_or("", |l| l.trim()));
    }
    Some(Row { dialect: g.dialect, tcp: g.feed == FeedMode::Tcp, kind, fault: note, says, truth })
}

/// Good programs in all dialects, with and without tool-centre-point control, ball and toroidal ends.
pub fn programs() -> Vec<Good> {
    let mut out = Vec::new();
    for (k, dialect) in Dialect::ALL.into_iter().enumerate() {
        let ball = k % 2 == 0;
        let other = if dialect == Dialect::LinuxCnc {
            FeedMode::InverseTime
        } else {
            FeedMode::Kv { fgref_mm: None }
        };
        // LinuxCNC's programs always move the joints; the others know both.
        let feeds = if dialect == Dialect::LinuxCnc { [other, FeedMode::Kf] } else { [FeedMode::Tcp, other] };
        out.push(good(dialect, feeds[0], ball));
        out.push(good(dialect, feeds[1], !ball));
    }
    out
}

/// Good programs must be good for both.
pub fn check_good(programs: &[Good], side: u32) {
    for g in programs {
        let m = motions(g, &g.text, &g.setup, true).expect("its own dialect");
        let truth = reference(&m, &g.cutter, side);
        let says = verify(g, &m, &g.cutter);
        assert!(
            says == Says::Within && truth.share < 1.0 - BAND,
            "{} {:?}: {says:?} {truth:?}",
            g.dialect,
            g.feed
        );
    }
}

/// `count` faults over the programs in turn.
pub fn study(programs: &[Good], count: usize, seed: u64, side: u32) -> Vec<Row> {
    let mut dice = Dice::new(seed);
    let mut rows = Vec::new();
    while rows.len() < count {
        let g = &programs[rows.len() % programs.len()];
        rows.extend(fault(g, &mut dice, side));
    }
    rows
}

/// Counts by kind: faults, harmful, of these found, harmless, of these called a fault, too close to tell.
pub fn table(rows: &[Row]) -> BTreeMap<&'static str, [usize; 6]> {
    let mut out: BTreeMap<&'static str, [usize; 6]> = BTreeMap::new();
    for row in rows {
        let c = out.entry(row.kind).or_default();
        c[0] += 1;
        let noticed = usize::from(row.says != Says::Within);
        match row.harmful() {
            Some(true) => {
                c[1] += 1;
                c[2] += noticed;
            }
            Some(false) => {
                c[3] += 1;
                c[4] += noticed;
            }
            None => c[5] += 1,
        }
    }
    out
}
