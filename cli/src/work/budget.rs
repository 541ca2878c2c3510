//! What posting may add to what a path leaves, and what planning keeps back for it.
//!
//! Passes are laid out for the scallop less two terms. *Words*: positions are rounded to the last decimal of the machine's axes; half
//! a unit of it at a crest, which lies between two passes that are rounded each for itself. *Ways*: between CL points the joints
//! move, and the tool's end strays from the straight motion that was planned, as far as the post allows: its tip, and what its axis
//! turns about the tip at the cutter's radius; across the axis, where it does not go towards the part, up to four times as far. Such a stray is
//! greatest in the middle of a block, and blocks are as long as it allows; at a crest it is the mean of two passes, which may stray to either
//! side: somewhat less than half of the most that the post allows is counted. What teeth leave at the feed of the job is kept back before both.

use crate::job::Job;
use crate::part::{self, Part};
use crate::work::axes;
use osculate_postproc::nc::Dialect;
use osculate_postproc::{FeedMode, SolveOptions};
use osculate_productivity::plan::Tolerance;

/// How far the tip may stray, of the chords, and the axis at the cutter's radius. Joints that turn a part bend the way of the tip
/// several times as much as faces do: most of the chord is theirs, and blocks become longer. A control that keeps the tip itself
/// leaves its share to the axis. (Tuned on the blades of `COUNTED` by the time on LinuxCNC: more of either takes a pass more where blocks gain least.)
const TIP: f64 = 0.4;
/// The tip's share where a cutting side joins no blocks: there what the axis strays keeps to fixed caps, which leave the tip more.
const SIDE_TIP: f64 = 0.5;
const AXIS: [f64; 2] = [0.25, 0.5];
/// What controls are asked to keep to at corners, of the chords; no more than what posts keep to without a job, as verdicts count all of it everywhere.
const BLEND: f64 = 0.25;
/// And of the scallop, where chords are coarser than usual and a job is given nothing else. (Tried on blades of an impeller and a propeller, which
/// take 2 and 4 % less of LinuxCNC's time, as their verdicts have room for a coarser chord; a hub takes 5 % more.)
const CORNER: f64 = 0.1;
/// None of these is less than this, mm, which programs can just say.
const LEAST_TIP_MM: f64 = 0.5e-4;
/// Tip and axis stray by no more than this share of the gouge limit: most of what the tip strays may go towards the part. (Above half of it plans of
/// compressor and impeller blades dig in, and gain 1 % of LinuxCNC's time: what the axis may stray and corners gain more.)
const DEEP: f64 = 0.5;
/// A tool that touches further from its axis than this cuts with its side, of which the axis moves most far from the tip: there posts stray by no
/// more than without a job, and join nothing.
const SIDE_RAD: f64 = 80.0 / 180.0 * std::f64::consts::PI;
/// The share of both that is counted. (Tuned on blades of a turbine, a compressor and an impeller: a quarter leaves too much between joined blocks, half
/// asks for passes that nothing needs.)
const COUNTED: f64 = 0.45;
/// What the tool may stray on ways off the surface, of the least lift: they are clear half as high.
const ALOFT: f64 = 0.25;
/// The cone in which joints are held near a pole, of what the axis may stray.
const CONE: f64 = 0.5;
/// Planning keeps back no more than this share of the scallop: above it passes cannot make good for a coarse machine.
const MOST: f64 = 0.3;

/// Exact marks of programs over those of leading order: at most 1.2 on a groove of a torus, where feeds at joints vary. Those of an
/// edge are of first order in the feed, and lie within some hundredths of it.
const EXACT_MARKS: f64 = 1.25;
const EXACT_EDGE: f64 = 1.03;
/// Planning keeps back no more than this share of the scallop for the marks of teeth: the feed is capped so that they take no more
/// on a plane.
const MARKS: f64 = 0.6;

/// How closely the joints follow the path of a job whose tool touches the part at no more than `touch_rad` from its axis.
pub fn solve(job: &Job, touch_rad: f64) -> SolveOptions {
    let (coarse, radius_mm, t) = (SolveOptions::default(), job.cutter().radius_mm(), job.tolerance());
    let of_chord = |share: f64| (share * t.chord_mm).min(DEEP * t.gouge_mm).max(LEAST_TIP_MM);
    let join = touch_rad <= SIDE_RAD;
    let axis = of_chord(AXIS[usize::from(keeps_tip(job))]) / radius_mm;
    let (tip_tol_mm, axis_tol_rad) = if join {
        (of_chord(TIP), axis)
    } else {
        (of_chord(SIDE_TIP).min(coarse.tip_tol_mm), axis.min(coarse.axis_tol_rad))
    };
    let singular_cone_rad = coarse.singular_cone_rad.min(CONE * axis_tol_rad);
    let setup = job.setup();
    let aloft_mm = ALOFT * setup.hop_mm.min(setup.approach_mm);
    let aloft_tol = (aloft_mm, aloft_mm / radius_mm);
    SolveOptions { tip_tol_mm, touch_rad, axis_tol_rad, singular_cone_rad, join, aloft_tol, ..coarse }
}

/// Whether the control keeps the tip on its line.
fn keeps_tip(job: &Job) -> bool {
    matches!(job.control().feed, FeedMode::Tcp)
}

/// How closely the control of a job is asked to keep to corners, mm.
pub fn asked_mm(job: &Job) -> f64 {
    let usual_mm = || (BLEND * job.tolerance().chord_mm).min(CORNER * job.tolerance().scallop_mm);
    within_post(job.overrides().blend_mm.unwrap_or_else(usual_mm))
}

/// How closely it may be asked to as corners take the same share of a chord as usual, whatever its share of the scallop, mm.
pub fn rounder_mm(job: &Job) -> f64 {
    within_post(BLEND * job.tolerance().chord_mm)
}

fn within_post(mm: f64) -> f64 {
    mm.clamp(LEAST_TIP_MM, SolveOptions::default().tip_tol_mm)
}

/// Half a unit of the last decimal of the coarsest slide, mm.
fn words_mm(job: &Job) -> f64 {
    let machine = &job.control().machine;
    let decimals =
        machine.linear().map(|p| machine.joints()[p].decimals).into_iter().fold(usize::MAX, usize::min);
    // A machine has few decimals.
    0.5 * 10f64.powi(-(decimals.min(16) as i32))
}

/// By how much the control of a job leaves the programmed way at corners, mm, with a tool whose axis turns while it feeds or with another, or in a
/// program that has both: verdicts add it.
pub fn blend_mm(job: &Job, turns: bool) -> f64 {
    let asked = asked_mm(job);
    match job.control().dialect {
        Dialect::Fanuc => 0.0,
        Dialect::Sinumerik | Dialect::Heidenhain => asked,
        // It blends corners and, unless programs of tools that turn forbid it, joins short pieces, each as closely as they ask for.
        Dialect::LinuxCnc if turns && !job.is_beside_kept() => asked,
        Dialect::LinuxCnc => 2.0 * asked,
    }
}

/// The shares of scallop and gouge that passes are laid out for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shares {
    /// Of the scallop.
    pub scallop: f64,
    /// Of the gouge.
    pub gouge: f64,
}

impl Shares {
    /// All of both.
    pub const WHOLE: Self = Self { scallop: 1.0, gouge: 1.0 };
}

/// The tolerance that shares leave for passes of a tool that leans along them.
pub fn leaning(job: &Job, faces: &Part, shares: Shares) -> Tolerance {
    let s = solve(job, 0.0);
    let tip_mm = if keeps_tip(job) { 0.0 } else { s.tip_tol_mm };
    let ways_mm = COUNTED * (tip_mm + s.axis_tol_rad * job.cutter().radius_mm());
    kept_back(job, faces, shares, words_mm(job) + ways_mm + blend_mm(job, true))
}

/// The tolerance that shares leave for passes of a tool that keeps its axis: its straight ways are those of the machine.
pub fn upright(job: &Job, faces: &Part, shares: Shares) -> Tolerance {
    kept_back(job, faces, shares, words_mm(job) + blend_mm(job, false))
}

/// The highest that passes leave which keep all of a job's tolerance, mm, before teeth and corners add to it.
pub fn laid_out_mm(job: &Job, faces: &Part) -> f64 {
    let of = if job.strategy().kept_axis().is_some() { upright } else { leaning };
    of(job, faces, Shares::WHOLE).scallop_mm
}

/// The tolerance that passes are held against where the tool may go in: verdicts add what words and blended corners may.
pub fn left_in(job: &Job) -> Tolerance {
    let given = job.tolerance();
    let by_mm = (words_mm(job) + blend_mm(job, false)).min(MOST * given.gouge_mm);
    Tolerance { gouge_mm: given.gouge_mm - by_mm, ..given }
}

/// The highest mark that teeth leave on the faces at the feed of a job, mm: to leading order, with what exact ones are higher; zero where it is not
/// known.
///
/// Where the part's curvature along the feed is k the tip goes `1 + k r` times as fast as the contact, and tool and part close
/// with `1/r + k`: the mark is `f^2 / (8 r (1 + k r))`, highest where the part is most hollow. An edge is no corner of any radius: see [`edge_slope`].
fn mark_mm(job: &Job, faces: &Part) -> f64 {
    let (Some(rpm), r) = (job.spindle_rpm(), job.cutter().corner_mm()) else { return 0.0 };
    let teeth = f64::from(job.tool().teeth().unwrap_or(1).max(1));
    let f = job.feed_mm_min() / (rpm * teeth);
    if r <= 0.0 {
        return EXACT_EDGE * f * edge_slope(job, faces);
    }
    let ranges = faces.faces.iter().filter_map(|face| part::curvature_range(&*face.surface));
    let hollow = ranges.map(|[low, _]| low).fold(0.0, f64::min);
    EXACT_MARKS * f * f / (8.0 * r * (1.0 + hollow * r).max(MOST_HOLLOW))
}

/// How high an edge that leans by L leaves a mark for each mm of feed per tooth, `sin L cos L`: of the lead where that is given, of the
/// least leans that the faces ask for where the machine leaves axes no choice; zero where leads are to be found.
fn edge_slope(job: &Job, faces: &Part) -> f64 {
    if axes::is_line(job) {
        let leans = axes::least_leans_rad(job, faces);
        return leans.into_iter().map(|l| l.sin() * l.cos()).fold(0.0, f64::max);
    }
    job.feed_per_tooth_mm(1.0).map_or(0.0, |one| 1.0 / one)
}

/// Hollows that come closer to the tool's corner than this are no longer of leading order: there verification tells.
const MOST_HOLLOW: f64 = 0.5;

fn kept_back(job: &Job, faces: &Part, shares: Shares, by_mm: f64) -> Tolerance {
    let given = job.tolerance();
    let marks_mm = mark_mm(job, faces).min(MARKS * given.scallop_mm);
    let scallop_mm = shares.scallop * (given.scallop_mm - marks_mm - by_mm.min(MOST * given.scallop_mm));
    Tolerance { scallop_mm, gouge_mm: shares.gouge * given.gouge_mm, ..given }
}
