//! How a job cuts: the kind of passes with what belongs to it, and nothing that says nothing there.

use crate::failure::Failure;
use crate::job::problem::Places;
use crate::job::raw;
use crate::job::roughing::{Layers, layers};
use crate::job::words::{AlongWord, AxisKey, ClimbWord, EffortWord, Gouges, LeanKey, StrategyWord};
use osculate_geom::{Axis, Unit3, Vec3};
use osculate_productivity::plan::{self, Along, Milling, Senses, SideTilt};
use osculate_tools::Lean;

/// Greatest change of a local lead where the job says none: at 2000 mm/min some 30 degrees a second, as rotary axes can.
const LEAD_RATE_DEG_PER_MM: f64 = 1.0;
/// Less than a degree away from the axis a direction says nothing about the passes.
const ACROSS: f64 = 0.0175;

/// The table's name.
const TABLE: &str = "strategy";

/// A way to cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// The fastest of all that hold.
    Auto,
    /// Passes along each face.
    Faces(plan::Strategy),
    /// Passes over all faces together, the tool dropped along an axis that it keeps.
    Drop(plan::ThreeAxisLines),
    /// Roughing in layers.
    Layers(Layers),
    /// The side of the cutter on a ruled face, for `flank`.
    Flank,
}

/// How a job cuts.
#[derive(Debug, Clone, Copy)]
pub struct Strategy {
    word: StrategyWord,
    /// The way to cut.
    pub kind: Kind,
    /// How much is tried where something is left to be chosen.
    pub effort: EffortWord,
    /// Lead; given ones in degrees.
    pub lead: LeanKey,
    /// Greatest change of a local lead along a face.
    pub lead_rate_rad_per_mm: f64,
    /// Tilt; given ones in degrees.
    pub tilt: LeanKey,
    /// Tilt to the left of the growing parameter on passes to and fro; the lead is then a given one.
    pub side_tilt_deg: Option<f64>,
    /// The axis of tools that keep it.
    pub axis: Unit3,
    /// Whether passes to and fro share the axes of a tool that leans.
    pub axis_field: bool,
    /// Whether the job leaves open how axes are found.
    axis_open: bool,
    /// Whether it gives the axis of a tool that keeps it.
    pub gives_axis: bool,
    /// In which senses passes are run.
    pub senses: Senses,
    /// The way of passes of a tool that keeps its axis, across the axis; the longest side of the faces where not given.
    pub feed_direction: Option<Vec3>,
    /// What becomes of places where the tool would go into the part or a check face.
    pub gouges: Gouges,
    /// Of places left out: what cutter and holder keep from check faces, and the holder from faces to machine.
    pub keep_off_mm: f64,
}

impl Strategy {
    /// Its word in job files.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        self.word.word()
    }

    /// The same with passes of a tool that keeps its axis.
    pub(super) fn kept(&self, way: &plan::ThreeAxis) -> Self {
        let word = match way.lines {
            plan::ThreeAxisLines::Gradient => StrategyWord::Gradient3c,
            plan::ThreeAxisLines::Waterlines => StrategyWord::Waterline3c,
            plan::ThreeAxisLines::Planes => StrategyWord::Isoplanar3c,
        };
        let kind = Kind::Drop(way.lines);
        // A tool that drops on all faces goes into none.
        let gouges = Gouges::Report;
        Self { word, kind, axis: way.axis, feed_direction: Some(way.feed), gouges, ..*self }
    }

    /// Whether the job asks for nothing that a tool has not which keeps its axis.
    #[must_use]
    pub fn may_keep_axis(&self) -> bool {
        (self.axis_open || self.gives_axis)
            && self.lead == LeanKey::Auto
            && !self.tilts()
            && self.side_tilt_deg.is_none()
            && self.senses == Senses::default()
    }

    /// The sizes of a roughing, where it is one.
    #[must_use]
    pub const fn layers(&self) -> Option<&Layers> {
        match &self.kind {
            Kind::Layers(l) => Some(l),
            _ => None,
        }
    }

    /// Whether axes may be a field: the job asks for one, or for nothing that a field has not.
    #[must_use]
    pub fn may_be_field(&self) -> bool {
        self.axis_field || (self.axis_open && self.lead == LeanKey::Auto && !self.tilts())
    }

    /// The lean to one side of the faces, where the job asks for one.
    #[must_use]
    pub fn side_tilt(&self) -> Option<SideTilt> {
        match (self.side_tilt_deg, self.lead) {
            (Some(side), LeanKey::Given(lead)) => {
                Some(SideTilt { lead_rad: lead.to_radians(), side_rad: side.to_radians() })
            }
            _ => None,
        }
    }

    /// The tilt that is held, deg: none where it is found place by place.
    #[must_use]
    pub fn tilt_deg(&self) -> f64 {
        self.tilt.given_deg().unwrap_or(0.0)
    }

    /// Whether the job wants a tilt.
    fn tilts(&self) -> bool {
        self.tilt == LeanKey::Local || self.tilt_deg() != 0.0
    }

    /// As [`crate::job::Job::lean`].
    #[must_use]
    pub fn lean(&self, auto_lead_rad: f64) -> Lean {
        if let Some(side) = self.side_tilt() {
            return side.lean(1.0);
        }
        let lead_rad = match self.lead {
            LeanKey::Auto | LeanKey::Local => auto_lead_rad,
            LeanKey::Given(deg) => deg.to_radians(),
        };
        Lean { lead_rad, tilt_rad: self.tilt_deg().to_radians() }
    }

    /// Lead and tilt as the job gives them, of a lean of its passes: beside a tilt to one side that is the lead alone.
    #[must_use]
    pub fn as_given(&self, lean: Lean) -> Lean {
        self.side_tilt().map_or(lean, |s| Lean { lead_rad: s.lead_rad, tilt_rad: 0.0 })
    }

    /// Whether a pass leaves the same either way: where the axis does not follow the feed.
    #[must_use]
    pub fn is_same_either_way(&self) -> bool {
        let aside = self.side_tilt().is_some_and(|s| s.lead_rad == 0.0 && s.side_rad != 0.0);
        aside || self.axis_field || self.kept_axis().is_some()
    }

    /// The axis that the tool keeps, where it keeps one.
    #[must_use]
    pub fn kept_axis(&self) -> Option<Unit3> {
        use StrategyWord as W;
        if self.layers().is_some_and(|l| l.directions.is_some()) {
            return None;
        }
        let keeps =
            [W::Gradient3c, W::Isoplanar3c, W::Waterline3c, W::ZLevel, W::Contour2cl].contains(&self.word);
        keeps.then_some(self.axis)
    }

    /// Whether its passes go around upright walls.
    #[must_use]
    pub fn goes_around_walls(&self) -> bool {
        self.word == StrategyWord::Waterline3c
    }

    /// Whether it is to be chosen.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        matches!(self.kind, Kind::Auto)
    }

    /// The strategy of a table, for so many tools.
    pub(super) fn of(places: &Places, t: &raw::Strategy, tools: usize) -> Result<Self, Failure> {
        left_out(places, t)?;
        let axis = direction(match t.axis {
            Some(AxisKey::Given(axis)) => axis,
            Some(AxisKey::Feed | AxisKey::Field) | None => [0.0, 0.0, 1.0],
        });
        let along = match t.along {
            AlongWord::Auto => Along::Auto,
            AlongWord::U => Along::Fixed(Axis::U),
            AlongWord::V => Along::Fixed(Axis::V),
        };
        let kind = match t.kind {
            StrategyWord::Auto => Kind::Auto,
            StrategyWord::Isoparametric => Kind::Faces(plan::Strategy::Isoparametric { along }),
            StrategyWord::Regions => Kind::Faces(plan::Strategy::Regions { along }),
            StrategyWord::Isoplanar => {
                let normal = direction(t.normal.unwrap_or([0.0, 1.0, 0.0]));
                Kind::Faces(plan::Strategy::Isoplanar { normal })
            }
            StrategyWord::Isoscallop => Kind::Faces(plan::Strategy::Isoscallop),
            StrategyWord::Streamline => Kind::Faces(plan::Strategy::Streamline),
            StrategyWord::Curvature5c => Kind::Faces(plan::Strategy::Curvature5c),
            StrategyWord::AlongWalls => Kind::Faces(plan::Strategy::AlongWalls),
            StrategyWord::Contour2cl => Kind::Faces(plan::Strategy::Contour2cl { axis }),
            StrategyWord::Gradient3c => Kind::Drop(plan::ThreeAxisLines::Gradient),
            StrategyWord::Isoplanar3c => Kind::Drop(plan::ThreeAxisLines::Planes),
            StrategyWord::Waterline3c => Kind::Drop(plan::ThreeAxisLines::Waterlines),
            StrategyWord::ZLevel => Kind::Layers(layers(places, t)?),
            StrategyWord::Flank => Kind::Flank,
        };
        let lead = match t.lead_deg {
            LeanKey::Auto if t.side_tilt_deg.is_some() && !places.has(TABLE, "lead_deg") => {
                LeanKey::Given(0.0)
            }
            lead => lead,
        };
        let found = Self {
            word: t.kind,
            kind,
            effort: t.effort,
            lead,
            lead_rate_rad_per_mm: t.lead_rate_deg_per_mm.unwrap_or(LEAD_RATE_DEG_PER_MM).to_radians(),
            tilt: t.tilt_deg,
            side_tilt_deg: t.side_tilt_deg,
            axis,
            axis_field: t.axis == Some(AxisKey::Field),
            axis_open: t.axis.is_none(),
            gives_axis: matches!(t.axis, Some(AxisKey::Given(_))),
            senses: Senses {
                one_way: t.one_way,
                milling: match t.climb {
                    ClimbWord::Any => Milling::Any,
                    ClimbWord::Climb => Milling::Climb,
                    ClimbWord::Conventional => Milling::Conventional,
                },
            },
            feed_direction: t.feed_direction.map(Vec3::from),
            gouges: t.gouges,
            keep_off_mm: t.keep_off_mm.unwrap_or(0.0),
        };
        found.belongs(places, t)?;
        found.agrees(places, t, tools)?;
        Ok(found)
    }

    /// Refuses keys that say nothing of this kind.
    fn belongs(&self, places: &Places, t: &raw::Strategy) -> Result<(), Failure> {
        use StrategyWord as W;
        let is = |all: &[W]| all.contains(&self.word);
        let drops = is(&[W::Gradient3c, W::Isoplanar3c, W::ZLevel]);
        let around = is(&[W::Waterline3c]);
        let layers = is(&[W::ZLevel]);
        let keeps_axis = layers || self.kept_axis().is_some();
        let lined = is(&[W::Isoparametric, W::Regions]);
        let rows = [
            ("along", lined, "isoparametric and regions"),
            ("side_tilt_deg", lined, "isoparametric and regions"),
            ("feed_direction", drops, "gradient_3c, isoplanar_3c and z_level"),
            ("normal", is(&[W::Isoplanar]), "isoplanar"),
            ("stepdown_mm", layers, "z_level"),
            ("stepover_mm", layers, "z_level"),
            ("allowance_mm", layers, "z_level"),
            ("ramp_deg", layers, "z_level"),
            ("directions", layers, "z_level"),
            ("least_share", layers, "z_level"),
            ("entry", layers, "z_level"),
            ("volume_rate_mm3_min", layers, "z_level"),
            ("lead_rate_deg_per_mm", !keeps_axis, "strategies that lean"),
            ("one_way", self.axis_field, "axis = \"field\""),
            ("climb", self.axis_field || around, "waterline_3c, and axis = \"field\""),
        ];
        let axis = match t.axis {
            Some(AxisKey::Given(_)) => (
                keeps_axis || is(&[W::Auto]),
                "contour_2cl, gradient_3c, isoplanar_3c, waterline_3c and z_level",
            ),
            Some(AxisKey::Feed | AxisKey::Field) => (!keeps_axis && !is(&[W::Flank]), "strategies that lean"),
            None => (true, ""),
        };
        let rows = rows.into_iter().chain([("axis", axis.0, axis.1)]);
        for (key, fits, owners) in rows {
            if !fits && places.has(TABLE, key) {
                let what = format!("{key} is for {owners}, not for kind = \"{}\": leave it out", self.name());
                return Err(places.refuse(TABLE, key, what));
            }
        }
        let leans = match self.lead {
            LeanKey::Auto => false,
            LeanKey::Local => true,
            LeanKey::Given(deg) => deg != 0.0,
        };
        if self.axis_field && (leans || self.tilts()) {
            let key = if leans { "lead_deg" } else { "tilt_deg" };
            let what = "axis = \"field\" finds the axis at each place: leave out lead_deg and tilt_deg";
            return Err(places.refuse(TABLE, key, what.to_owned()));
        }
        if keeps_axis && (leans || self.tilts()) {
            let key = if leans { "lead_deg" } else { "tilt_deg" };
            let what =
                format!("{} keeps the tool axis on `axis`: leave out lead_deg and tilt_deg", self.name());
            return Err(places.refuse(TABLE, key, what));
        }
        Ok(())
    }

    /// Refuses keys that contradict each other.
    fn agrees(&self, places: &Places, t: &raw::Strategy, tools: usize) -> Result<(), Failure> {
        let refuse = |key: &str, what: String| Err(places.refuse(TABLE, key, what));
        if self.side_tilt_deg.is_some() {
            let wrong = [
                (
                    self.axis_field,
                    "axis",
                    "axis = \"field\" finds the axis at each place: leave out side_tilt_deg",
                ),
                (
                    t.along == AlongWord::Auto,
                    "side_tilt_deg",
                    "side_tilt_deg needs along = \"u\" or \"v\": its side is left of that parameter as it grows",
                ),
                (
                    !matches!(self.lead, LeanKey::Given(_)),
                    "lead_deg",
                    "side_tilt_deg needs lead_deg as a number, which is 0 where it is left out",
                ),
                (
                    self.tilts(),
                    "tilt_deg",
                    "tilt_deg changes sides with the feed, side_tilt_deg does not: leave one of them out",
                ),
            ];
            if let Some((_, key, what)) = wrong.into_iter().find(|w| w.0) {
                return refuse(key, what.to_owned());
            }
        }
        if self.tilt == LeanKey::Local && self.lead != LeanKey::Local {
            let what = "tilt_deg = \"local\" needs lead_deg = \"local\": the least lead that fits differs with the tilt";
            return refuse("tilt_deg", what.to_owned());
        }
        if let Some(d) = self.feed_direction {
            let across = d - self.axis.into_inner() * d.dot(&self.axis);
            if across.norm() <= ACROSS * d.norm() {
                let given = t.feed_direction.unwrap_or_default();
                let what = format!("feed_direction = {given:?} must point across the tool axis");
                return refuse("feed_direction", what);
            }
        }
        if places.has(TABLE, "effort") && tools < 2 && !self.is_open() {
            let what = format!(
                "effort is for kind = \"auto\" or several tools, not for one by {}: leave it out",
                self.name()
            );
            return refuse("effort", what);
        }
        if tools > 1 && matches!(self.kind, Kind::Drop(_) | Kind::Layers(_) | Kind::Flank) {
            return refuse("kind", format!("{} takes one [tool], not [[tools]]", self.name()));
        }
        Ok(())
    }
}

/// Refuses places to be left out where nothing can be.
fn left_out(places: &Places, t: &raw::Strategy) -> Result<(), Failure> {
    use StrategyWord as W;
    let refuse = |key: &str, what: String| Err(places.refuse(TABLE, key, what));
    match (t.gouges, t.keep_off_mm) {
        (Gouges::Report, Some(_)) => {
            refuse("keep_off_mm", "keep_off_mm needs gouges = \"leave_out\"".to_owned())
        }
        (Gouges::LeaveOut, _) if [W::ZLevel, W::Flank].contains(&t.kind) => refuse(
            "gouges",
            format!("gouges = \"leave_out\" is for passes of finishing, not for {}", t.kind.word()),
        ),
        _ => Ok(()),
    }
}

/// A direction that the schema has found to be one.
pub(super) fn direction(d: [f64; 3]) -> Unit3 {
    // Scaled first: squares of great or small numbers leave the range of numbers.
    let most = d.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    Unit3::new_normalize(Vec3::from(d.map(|x| x / most)))
}
