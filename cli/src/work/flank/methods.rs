//! The positionings of a cutter on a strip side by side: what each leaves at a rule and over the face.

use osculate_geom::roots::{FLAT, minimum};
use osculate_geom::{Interval, Surface, Uv, uv};
use osculate_tools::Cutter;
use osculate_tools::flank::axes::{AxisPoints, AxisSurface};
use osculate_tools::flank::cutter_side::CutterSide;
use osculate_tools::flank::deviation::{Deviation, Patch, deviation};
use osculate_tools::flank::envelope::Envelope;
use osculate_tools::flank::global::{Goal, Options, Task, optimise};
use osculate_tools::flank::{
    AxisLine, Placed, Profile, Rule, RuledStrip, Setting, SideTool, Stations, Verdict, place, profile,
};
use rayon::prelude::*;
use serde::Serialize;

/// Names of the methods, in the order of the table.
pub const NAMES: &[&str] = crate::job::words::Method::WORDS;
/// Liu's share of the rule for the double point offset.
const LIU: f64 = 0.25;
/// Fewest positions of a motion.
const FEWEST: usize = 4;
/// Samples of a rule.
pub(super) const SAMPLES: usize = 129;
/// Samples of directrices between two breaks.
pub(super) const STATIONS: usize = 64;
/// Places across, of the optimum's grid and of the judged one.
const ACROSS: [usize; 2] = [21, 41];
/// Spans of an axis surface for as long a way as is judged, and the most.
const SPANS: f64 = 32.0;
const MOST_SPANS: usize = 96;

/// Least and greatest, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Range {
    /// Least, negative is gouge.
    pub min: f64,
    /// Greatest.
    pub max: f64,
}

/// One line of the table.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Method {
    /// One of [`NAMES`].
    pub name: &'static str,
    /// Whether there is such a position at the rule, with its contacts on the face.
    pub valid: bool,
    /// Why not, or what it is worth.
    pub why: String,
    /// From the rule to the axis.
    pub gamma_deg: Option<f64>,
    /// Of the tangency on the rule, from the first directrix.
    pub h0_mm: Option<f64>,
    /// Parameter of the contact on the first directrix.
    pub u0: Option<f64>,
    /// Parameter of the contact on the second directrix.
    pub u1: Option<f64>,
    /// Share of the rule from either end to the points of a double point offset.
    pub fraction: Option<f64>,
    /// Along the rule, the least over u at each place: what a cutter that stands leaves of the surface.
    pub static_mm: Option<Range>,
    /// Of the points of the rule itself, as Liu has it.
    pub on_rule_mm: Option<Range>,
    /// Over the judged patch.
    pub envelope_mm: Option<Range>,
    /// No motion near the found one on the same splines leaves less, to first order.
    pub lower_bound_mm: Option<f64>,
    /// The same for splines with twice as many spans.
    pub lower_bound_refined_mm: Option<f64>,
    /// Share of the judged patch's area within the tolerance, 0 to 1.
    pub share_within: Option<f64>,
    /// Positions of the span at which there is none.
    pub positions_missing: usize,
}

/// A motion with the cutter's side that goes with it.
#[derive(Clone)]
pub struct Motion {
    /// The pieces, in order.
    pub pieces: Vec<AxisSurface>,
    /// The side.
    pub side: CutterSide,
    /// Height of the tip from Q0 for cutters whose shape depends on it.
    pub tip_mm: Option<f64>,
}

/// What the methods work on.
pub struct Study<'a> {
    /// The face.
    pub face: &'a dyn Surface,
    /// The strip between its directrices.
    pub strip: &'a RuledStrip<'a>,
    /// The cutter.
    pub cutter: Cutter,
    /// Curvature of its side along the axis, 1/mm.
    pub bulge_per_mm: f64,
    /// How far its straight side reaches beyond the rules, mm.
    pub below_mm: f64,
    /// The rule.
    pub at_u: f64,
    /// Positions.
    pub span: Interval,
    /// Where the motions of least deviation go.
    pub longer: Interval,
    /// Judged.
    pub judge: Interval,
    /// Share of the strip's range by which it goes on at both ends for static deviations.
    pub beyond: f64,
    /// How many positions.
    pub positions: usize,
    /// Spans of the axis surface, where given.
    pub spans: Option<usize>,
    /// Weights.
    pub options: Options,
    /// Accepted above and below, mm.
    pub tolerance: [f64; 2],
}

/// A method with its motion and deviation, where it has one.
pub struct Answer {
    /// The figures of the method.
    pub row: Method,
    /// Its motion, where it has one.
    pub motion: Option<Motion>,
    /// Its static deviation at the rule, where it stands there.
    pub profile: Option<Profile>,
}

impl Answer {
    fn none(row: Method) -> Self {
        Self { row, motion: None, profile: None }
    }
}

/// The side of a cutter near a height above its tip, in the form of the settings at a rule; Q0 is at `foot_mm` above the tip.
fn side_tool(
    cutter: &Cutter,
    side: &CutterSide,
    [z_mm, foot_mm]: [f64; 2],
    bulge_per_mm: f64,
) -> Result<SideTool, String> {
    if side.is_cylinder() {
        return SideTool::cylinder(cutter.radius_mm()).map_err(|e| e.to_string());
    }
    let z = z_mm - foot_mm;
    SideTool::barrel(side.radius_at_mm(z), side.taper_at_rad(z), bulge_per_mm).map_err(|e| e.to_string())
}

impl Study<'_> {
    fn patch(&self, across: usize) -> Patch {
        Patch { u: self.judge, v: Interval::new(0.0, 1.0), count: [self.positions.max(2), across] }
    }

    /// Length of the rule in the middle of the judged patch, mm.
    fn rule_mm(&self) -> f64 {
        let u = self.judge.at(0.5);
        (self.face.point(uv(u, 1.0)) - self.face.point(uv(u, 0.0))).norm()
    }

    fn spans(&self) -> usize {
        let by_length = SPANS * self.longer.length() / self.judge.length();
        self.spans.unwrap_or(2 * ((0.5 * by_length).round() as usize).clamp(2, MOST_SPANS / 2))
    }

    /// Height of the face's lower end above the tip of a cutter that is not a cylinder.
    fn foot_mm(&self) -> f64 {
        self.below_mm + self.cutter.corner_mm()
    }

    /// The cutter's side for guiding points beside the directrix at v = 0.
    fn side(&self) -> CutterSide {
        CutterSide::of(&self.cutter, -self.foot_mm())
    }

    /// Whether the cutter's side is a cylinder.
    pub(super) fn is_cylinder(&self) -> bool {
        self.side().is_cylinder()
    }

    /// The same with other positions.
    pub(super) fn with_span(&self, span: Interval) -> Study<'_> {
        Study { span, longer: span, ..*self }
    }

    fn judged(&self, motion: &Motion) -> Deviation {
        deviation(&Envelope::new(motion.side, &motion.pieces), self.face, self.patch(ACROSS[1]))
    }

    /// Share of the patch's area whose deviation is within the tolerance.
    fn share(&self, d: &Deviation) -> f64 {
        let [nu, nv] = d.patch.count;
        let (mut inside, mut all) = (0.0, 0.0);
        for i in 0..nu {
            for j in 0..nv {
                let at: Uv = d.at[i * nv + j];
                let jet = self.face.jet2(at);
                let v = |j: usize| d.at[i * nv + j].v;
                let width = v((j + 1).min(nv - 1)) - v(j.saturating_sub(1));
                let end = if i == 0 || i + 1 == nu { 0.5 } else { 1.0 };
                let area = jet.du.cross(&jet.dv).norm() * width * end;
                if !area.is_finite() {
                    continue;
                }
                let delta = d.values_mm[i * nv + j];
                all += area;
                if delta <= self.tolerance[0] && delta >= -self.tolerance[1] {
                    inside += area;
                }
            }
        }
        if all > 0.0 { inside / all } else { 0.0 }
    }

    /// A setting at a rule, over all positions.
    fn setting(&self, name: &'static str, setting: Setting) -> Answer {
        let stations = Stations::beyond(self.strip, STATIONS, self.beyond);
        let section = if self.side().is_cylinder() { 0.0 } else { self.foot_mm() + 0.5 * self.rule_mm() };
        let mut row = empty(name);
        let tool = match side_tool(&self.cutter, &self.side(), [section, self.foot_mm()], self.bulge_per_mm) {
            Ok(t) => t,
            Err(why) => {
                return Answer::none(Method { why, ..row });
            }
        };
        let mut profile = None;
        match place(self.strip, &stations, self.at_u, tool, setting) {
            Ok(p) => profile = Some(self.describe(&mut row, &p, &stations, &tool, setting)),
            Err(e) => row.why = e.to_string(),
        }
        let count = self.positions.max(FEWEST);
        let at = |k: usize| self.span.at(k as f64 / (count - 1) as f64);
        let places: Vec<Option<AxisLine>> = (0..count)
            .into_par_iter()
            .map(|k| place(self.strip, &stations, at(k), tool, setting).ok().map(|p| p.axis))
            .collect();
        row.positions_missing = places.iter().filter(|p| p.is_none()).count();
        let cylinder = self.side().is_cylinder();
        let mut pieces = Vec::new();
        let mut k = 0;
        while k < count {
            let run = places[k..].iter().take_while(|p| p.is_some()).count();
            if run >= FEWEST {
                let axes: Vec<AxisPoints> = places[k..k + run]
                    .iter()
                    .flatten()
                    .enumerate()
                    .map(|(i, line)| self.points(line, at(k + i), cylinder))
                    .collect();
                pieces.extend(AxisSurface::along(Interval::new(at(k), at(k + run - 1)), &axes));
            }
            k += run.max(1);
        }
        if pieces.is_empty() {
            return Answer { row, motion: None, profile };
        }
        let side = CutterSide::of(&self.cutter, -section);
        let motion = Motion { pieces, side, tip_mm: (!cylinder).then_some(-section) };
        self.finished(row, motion, profile)
    }

    /// Guiding points on an axis: beside both directrices, or the reference section.
    fn points(&self, line: &AxisLine, u: f64, cylinder: bool) -> AxisPoints {
        let [a, b] = [0, 1].map(|end: usize| self.strip.directrix(end, u).point);
        let (low, high) = (line.along_mm(&a), line.along_mm(&b));
        let low = if cylinder { low } else { 0.0 };
        AxisPoints { lower: line.at(low), upper: line.at(high.max(low + 0.1 * (b - a).norm())) }
    }

    fn describe(
        &self,
        row: &mut Method,
        p: &Placed,
        stations: &Stations,
        tool: &SideTool,
        setting: Setting,
    ) -> Profile {
        let profile = p.profile(self.strip, stations, tool, SAMPLES);
        row.gamma_deg = Some(p.turn_rad.to_degrees());
        row.static_mm = Some(extremes(&profile));
        row.on_rule_mm = self.strip.rule(self.at_u).ok().map(|rule| on_rule(&rule, tool, &p.axis));
        if let (Setting::DoublePoint(_) | Setting::BalancedDoublePoint, [near, _]) =
            (setting, p.touches.as_slice())
        {
            row.fraction = Some(near.v);
        }
        if let (Setting::ThreeTangent, [a, b, m]) = (setting, p.touches.as_slice()) {
            (row.u0, row.u1) = (Some(a.u), Some(b.u));
            row.h0_mm = Some((m.point - self.strip.directrix(0, self.at_u).point).norm());
        }
        let verdict = p.verdict(self.strip, tool, &profile, self.tolerance[0]);
        (row.valid, row.why) = match verdict {
            Err(e) => (false, e.to_string()),
            Ok(Verdict::Valid) => (true, "within the tolerance at the rule".to_owned()),
            Ok(Verdict::ContactOutside { end, u }) => {
                (false, format!("the contact on directrix {end} lies off the face, at u = {u:.6}"))
            }
            Ok(Verdict::DoesNotFit { largest_mm }) => (
                false,
                format!(
                    "the cutter is too large for the hollow along the rule: at most R = {largest_mm:.4} mm fits"
                ),
            ),
            Ok(Verdict::Gouge { depth_mm }) => (true, format!("gouges by {depth_mm:.4} mm at the rule")),
            Ok(Verdict::Left { height_mm }) => (true, format!("leaves {height_mm:.4} mm at the rule")),
        };
        profile
    }

    fn finished(&self, mut row: Method, motion: Motion, profile: Option<Profile>) -> Answer {
        let d = self.judged(&motion);
        row.envelope_mm = Some(Range { min: d.min.value_mm, max: d.max.value_mm });
        row.share_within = Some(self.share(&d));
        Answer { row, motion: Some(motion), profile }
    }

    /// The best motion for the whole face.
    fn global(&self, name: &'static str, goal: Goal) -> Answer {
        let mut row = empty(name);
        let side = self.side();
        let task = Task { surface: self.face, side, positions: self.longer, judged: self.patch(ACROSS[0]) };
        let options = Options { goal, spans: self.spans(), ..self.options };
        match optimise(&task, &options, &[]) {
            Err(e) => {
                row.why = e.to_string();
                Answer::none(row)
            }
            Ok(found) => {
                row.valid = true;
                row.why = format!(
                    "{} after {} linear problems",
                    if found.converged { "converged" } else { "not converged" },
                    found.iterations
                );
                row.lower_bound_mm = found.bound_mm;
                row.lower_bound_refined_mm = found.bound_refined_mm;
                let profile = self.at_rule(&mut row, &found.axes);
                let tip_mm = (!side.is_cylinder()).then_some(-self.foot_mm());
                let motion = Motion { pieces: vec![found.axes], side, tip_mm };
                self.finished(row, motion, profile)
            }
        }
    }

    /// The position of a motion at the rule.
    fn at_rule(&self, row: &mut Method, axes: &AxisSurface) -> Option<Profile> {
        let pose = axes.pose(self.at_u, 0.0);
        let line = AxisLine { point: pose.tip, direction: pose.axis };
        let rule = self.strip.rule(self.at_u).ok();
        if let Some(rule) = &rule {
            let f = &rule.frame;
            row.gamma_deg = Some((-line.direction.dot(&f.x)).atan2(line.direction.dot(&f.z)).to_degrees());
        }
        let tool = SideTool::cylinder(self.cutter.radius_mm()).ok().filter(|_| self.side().is_cylinder())?;
        let p = profile(self.strip, &self.stations(), &tool, &line, SAMPLES);
        row.static_mm = Some(extremes(&p));
        row.on_rule_mm = rule.map(|rule| on_rule(&rule, &tool, &line));
        Some(p)
    }

    /// Samples of the strip's directrices.
    pub(super) fn stations(&self) -> Stations {
        Stations::new(self.strip, STATIONS)
    }

    /// One method.
    pub fn run(&self, name: &'static str) -> Answer {
        match (setting_of(name), name) {
            (Some(setting), _) => self.setting(name, setting),
            (None, "envelope_rms") => self.global(name, Goal::Rms),
            _ => self.global(name, Goal::Minimax),
        }
    }
}

/// The setting at a rule of a method; None for those of whole motions.
pub(super) fn setting_of(name: &str) -> Option<Setting> {
    Some(match name {
        "standard_a" => Setting::AtDirectrix(0),
        "standard_b" => Setting::Distributed,
        "double_point_offset" => Setting::DoublePoint(LIU),
        "double_point_balanced" => Setting::BalancedDoublePoint,
        "optimum" => Setting::ThreeTangent,
        "static_minimax" => Setting::Minimax,
        _ => return None,
    })
}

fn extremes(p: &Profile) -> Range {
    Range { min: p.lowest.deviation_mm, max: p.highest.deviation_mm }
}

/// Least and greatest deviation of the points of a rule, between samples too.
fn on_rule(rule: &Rule, tool: &SideTool, axis: &AxisLine) -> Range {
    let at = |v: f64| tool.deviation_mm(axis, &rule.point(v));
    let v = |k: usize| k as f64 / (SAMPLES - 1) as f64;
    let extreme = |sign: f64| {
        let value = |k: &usize| sign * at(v(*k));
        let k = (0..SAMPLES).min_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or(0);
        let around = [v(k.saturating_sub(1)), v((k + 1).min(SAMPLES - 1))];
        sign * minimum(around, FLAT, |v| sign * at(v)).f.min(value(&k))
    };
    Range { min: extreme(1.0), max: extreme(-1.0) }
}

fn empty(name: &'static str) -> Method {
    Method {
        name,
        valid: false,
        why: String::new(),
        gamma_deg: None,
        h0_mm: None,
        u0: None,
        u1: None,
        fraction: None,
        static_mm: None,
        on_rule_mm: None,
        envelope_mm: None,
        lower_bound_mm: None,
        lower_bound_refined_mm: None,
        share_within: None,
        positions_missing: 0,
    }
}
