//! What a job says, value by value: its tools, its tolerances, how to cut, for which machine.

use super::cutting::{MARK_SHARE, caps, feed_per_tooth_mm, marked, thin_mm};
use super::{
    Contact, Control, Fixture, Flank, Job, Overrides, Part, Setup, Stock, Strategy, Tool, Verification,
    control,
};
use osculate_geom::Diagnostic;
use osculate_postproc::nc::Coolant;
use osculate_productivity::plan::Tolerance;
use osculate_productivity::rate::{Caps, FeedLimit};
use osculate_tools::{Cutter, CutterSpec, Holder, Lean};
use std::path::Path;
use std::sync::Arc;

impl Job {
    /// The job once with each of its tools in hand.
    ///
    /// ```
    /// use osculate::Job;
    /// use std::path::Path;
    ///
    /// let text = r#"
    /// format = 1
    /// part = { builtin = { kind = "plane", half_size_mm = 5 } }
    /// tools = [
    ///     { number = 3, kind = "ball", diameter_mm = 6, length_mm = 40 },
    ///     { number = 8, kind = "ball", diameter_mm = 10, length_mm = 50 },
    /// ]
    /// tolerance = { scallop_mm = 0.1 }
    /// "#;
    /// let job = Job::from_toml(text, Path::new("two.toml"))?;
    /// assert!(job.is_open() && job.one_tool().is_err());
    /// let numbers: Vec<u32> = job.each_tool().iter().map(|one| one.tool().number()).collect();
    /// assert_eq!(numbers, [3, 8]);
    /// assert_eq!(job.in_hand(8).cutter().radius_mm(), 5.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn each_tool(&self) -> Vec<Self> {
        (0..self.told.tools.len()).map(|hand| self.plain(Some(hand))).collect()
    }

    /// The job with the tool of this number in hand; the first where there is none.
    #[must_use]
    pub fn in_hand(&self, number: u32) -> Self {
        let hand = self.told.tools.iter().position(|t| t.number() == number);
        self.plain(hand)
    }

    /// What the file tells, with a tool in hand.
    fn plain(&self, hand: Option<usize>) -> Self {
        Self { told: Arc::clone(&self.told), hand, own: Overrides::default(), kept: None }
    }

    /// The file it came from.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.told.places.path()
    }

    /// The part and which of its faces.
    #[must_use]
    pub fn part(&self) -> &Part {
        &self.told.part
    }

    /// All tools.
    #[must_use]
    pub fn tools(&self) -> &[Tool] {
        &self.told.tools
    }

    /// The tool in hand.
    #[must_use]
    pub fn tool(&self) -> &Tool {
        &self.told.tools[self.hand.unwrap_or(0)]
    }

    /// The tool in hand in words, as tables show it.
    #[must_use]
    pub fn tool_words(&self) -> String {
        self.tool().words().to_owned()
    }

    /// The cutter's description.
    #[must_use]
    pub fn cutter_spec(&self) -> CutterSpec {
        self.tool().spec()
    }

    /// The cutter.
    #[must_use]
    pub fn cutter(&self) -> Cutter {
        self.tool().cutter()
    }

    /// The part of the cutter that cuts, and the shank above it where the flutes end below the length.
    #[must_use]
    pub fn flutes(&self) -> (Cutter, Option<Cutter>) {
        self.tool().flutes()
    }

    /// The holder.
    #[must_use]
    pub fn holder(&self) -> Option<&Holder> {
        self.tool().holder()
    }

    /// The tolerances.
    #[must_use]
    pub fn tolerance(&self) -> Tolerance {
        let told = self.told.tolerance;
        Tolerance { chord_mm: self.own.chord_mm.unwrap_or(told.chord_mm), ..told }
    }

    /// Whether the file says how far straight moves may be off the path.
    #[must_use]
    pub fn gives_chord(&self) -> bool {
        self.told.gives_chord
    }

    /// What a search gave it.
    #[must_use]
    pub const fn overrides(&self) -> Overrides {
        self.own
    }

    /// The job with what a search gives it. [`Job::each_tool`] and [`Job::in_hand`] are without it again.
    ///
    /// ```
    /// use osculate::{Job, Overrides};
    /// use std::path::Path;
    ///
    /// let text = r#"
    /// format = 1
    /// part = { builtin = { kind = "plane", half_size_mm = 5 } }
    /// tool = { kind = "ball", diameter_mm = 6, length_mm = 40, teeth = 2 }
    /// tolerance = { scallop_mm = 0.001 }
    /// cutting = { spindle_rpm = 8000, feed_mm_min = 5000 }
    /// "#;
    /// let job = Job::from_toml(text, Path::new("plane.toml"))?;
    /// // Marks of a quarter of the height: half the feed, to leading order.
    /// let share = Some(0.25 * job.mark_share());
    /// let less = job.with(Overrides { mark_share: share, ..Overrides::default() });
    /// assert!((less.feed_mm_min() / job.feed_mm_min() - 0.5).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with(&self, own: Overrides) -> Self {
        let kept = own.three_axis.map(|way| self.told.strategy.kept(&way));
        Self { own, kept, ..self.clone() }
    }

    /// Area that no tool reaches and that is accepted.
    #[must_use]
    pub fn unreached_mm2(&self) -> f64 {
        self.own.unreached_mm2.unwrap_or(self.told.unreached_mm2)
    }

    /// How to cut.
    #[must_use]
    pub fn strategy(&self) -> &Strategy {
        self.kept.as_ref().unwrap_or(&self.told.strategy)
    }

    /// Whether something is left to be chosen: the strategy, or one of several tools.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.strategy().is_open() || self.told.tools.len() > 1
    }

    /// Lead and tilt, with this lead where the job leaves it to the program; of a tilt to one side those of passes along the growing
    /// parameter.
    #[must_use]
    pub fn lean(&self, auto_lead_rad: f64) -> Lean {
        self.strategy().lean(auto_lead_rad)
    }

    /// Greatest change of a local lead per mm of the face.
    #[must_use]
    pub fn lead_rate_rad_per_mm(&self) -> f64 {
        self.strategy().lead_rate_rad_per_mm
    }

    /// The feed of the tool in hand, capped by the feed per tooth where the job gives one.
    ///
    /// ```
    /// use osculate::Job;
    /// use std::path::Path;
    ///
    /// // 8000 turns a minute, two teeth, 0.05 mm each: 800 mm a minute.
    /// let text = r#"
    /// format = 1
    /// part = { builtin = { kind = "plane", half_size_mm = 5 } }
    /// tool = { kind = "ball", diameter_mm = 6, length_mm = 40, teeth = 2 }
    /// tolerance = { scallop_mm = 0.1 }
    /// cutting = { spindle_rpm = 8000, feed_mm_min = 5000, feed_per_tooth_mm = 0.05 }
    /// "#;
    /// let job = Job::from_toml(text, Path::new("plane.toml"))?;
    /// assert!((job.feed_mm_min() - 800.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn feed_mm_min(&self) -> f64 {
        self.feed().0
    }

    /// The feed of the tool in hand where it takes nothing in a roughing, no less than where it does, mm/min.
    #[must_use]
    pub fn air_mm_min(&self) -> f64 {
        self.tool().feeding().air_feed_mm_min.unwrap_or(0.0).max(self.feed_mm_min())
    }

    /// The feed that the tool in hand is for, whatever marks its teeth leave at it, mm/min.
    #[must_use]
    pub fn tool_feed_mm_min(&self) -> f64 {
        self.of_tool().0
    }

    fn of_tool(&self) -> (f64, FeedLimit) {
        self.told.feeds_mm_min[self.hand.unwrap_or(0)]
    }

    fn feed(&self) -> (f64, FeedLimit) {
        let shared = (self.mark_share(), self.tolerance().scallop_mm);
        marked(self.of_tool(), (self.tool(), self.strategy()), shared)
    }

    /// The share of the scallop that the marks of teeth take at most: a half, unless [`Job::with`] gives another.
    #[must_use]
    pub fn mark_share(&self) -> f64 {
        self.own.mark_share.unwrap_or(MARK_SHARE)
    }

    /// What sets that feed: the one that is given, the feed per tooth, or the height of the marks of teeth.
    #[must_use]
    pub fn feed_limit(&self) -> FeedLimit {
        self.feed().1
    }

    /// What holds the feed down besides the marks of teeth; None without a spindle speed.
    #[must_use]
    pub fn caps(&self) -> Option<Caps> {
        caps(self.tool())
    }

    /// How high material stands on the faces to machine, mm: what is declared, or else what approaches leave room for.
    #[must_use]
    pub fn layer_mm(&self) -> f64 {
        self.told.layers_mm[self.hand.unwrap_or(0)]
    }

    /// The thickness of a layer in which heights are judged where raw material itself is known, mm.
    #[must_use]
    pub fn thin_layer_mm(&self) -> f64 {
        thin_mm(self.tolerance().scallop_mm, self.cutter().radius_mm(), self.setup().approach_mm)
    }

    /// The feed per tooth whose mark on a plane is as high as this, mm; None for an edge that leans by an unknown lead.
    #[must_use]
    pub fn feed_per_tooth_mm(&self, mark_mm: f64) -> Option<f64> {
        feed_per_tooth_mm(self.tool(), self.strategy(), mark_mm)
    }

    /// Whether it is judged in a program with operations whose tools keep their axis.
    #[must_use]
    pub fn is_beside_kept(&self) -> bool {
        self.told.beside_kept
    }

    /// The spindle speed.
    #[must_use]
    pub fn spindle_rpm(&self) -> Option<f64> {
        self.tool().spindle_rpm()
    }

    /// The coolant.
    #[must_use]
    pub fn coolant(&self) -> Option<Coolant> {
        self.tool().coolant()
    }

    /// Machine and control.
    #[must_use]
    pub fn control(&self) -> &Control {
        &self.told.control
    }

    /// Whether the job says what machine it is for.
    #[must_use]
    pub fn names_machine(&self) -> bool {
        self.told.names_machine
    }

    /// What is to be known of the control: that the job names none.
    #[must_use]
    pub fn control_notes(&self) -> Vec<Diagnostic> {
        if self.names_machine() { Vec::new() } else { vec![control::assumed(self.control())] }
    }

    /// The work offset as the dialect says it.
    #[must_use]
    pub fn work_offset(&self) -> Option<&str> {
        self.told.work_offset.as_deref()
    }

    /// The number of the program.
    #[must_use]
    pub fn program_number(&self) -> Option<u32> {
        self.told.program_number
    }

    /// Where the part sits and how rapid moves go.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.told.setup
    }

    /// One contact.
    #[must_use]
    pub fn contact(&self) -> Option<&Contact> {
        self.told.contact.as_ref()
    }

    /// Raw material.
    #[must_use]
    pub fn stock(&self) -> Option<&Stock> {
        self.told.stock.as_ref()
    }

    /// What holds the part.
    #[must_use]
    pub fn fixture(&self) -> Option<&Fixture> {
        self.told.fixture.as_ref()
    }

    /// How a ruled face is milled with the side of the cutter.
    #[must_use]
    pub fn flank(&self) -> &Flank {
        &self.told.flank
    }

    /// How densely to verify.
    #[must_use]
    pub fn verification(&self) -> &Verification {
        &self.told.verification
    }
}
