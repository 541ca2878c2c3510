//! What a machine file leaves open, and what for it matters.

use super::{Joint, JointKind, Machine};

/// Something that a machine file does not say.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Gap {
    /// The key, of which joint.
    pub key: String,
    /// What is not known, or assumed instead.
    pub meaning: String,
}

impl Machine {
    /// What its file leaves open.
    ///
    /// ```
    /// use osculate_postproc::Machine;
    ///
    /// // C of a trunnion turns without end; nothing says where G28 leads.
    /// let gaps = Machine::built_in("trunnion-ac")?.gaps();
    /// assert!(gaps.iter().any(|gap| gap.key == "min_deg and max_deg of C"));
    /// assert!(gaps.iter().any(|gap| gap.key == "home_mm of X"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn gaps(&self) -> Vec<Gap> {
        let mut gaps = Vec::new();
        let mut open = |key: String, meaning: &str| gaps.push(Gap { key, meaning: meaning.into() });
        for joint in self.joints() {
            let Joint { letter, kind, .. } = joint;
            let linear = *kind == JointKind::Linear;
            match (linear, joint.min.is_none(), joint.max.is_none()) {
                (_, false, false) => {}
                (true, ..) => {
                    open(format!("min_mm and max_mm of {letter}"), "paths are not held against its travel");
                }
                (false, true, true) => open(
                    format!("min_deg and max_deg of {letter}"),
                    "it turns without end: programs go the shortest way inside one turn; LinuxCNC counts on",
                ),
                (false, ..) => open(format!("one end of {letter}"), "it turns without end to one side"),
            }
            if joint.drive.jerk_per_s3.is_none() {
                let key = if linear { "max_jerk_mm_s3" } else { "max_jerk_deg_s3" };
                open(format!("{key} of {letter}"), "times are those of acceleration that steps");
            }
            if linear && joint.machine_zero.is_none() {
                let meaning = if letter == "Z" {
                    "the control's zero is taken to be the top of its travel: programs retract there"
                } else {
                    "the control's zero is taken to be the joint's own: where G53, SUPA and M91 lead is a guess"
                };
                open(format!("machine_zero_mm of {letter}"), meaning);
            }
            if linear && joint.home.is_none() {
                open(
                    format!("home_mm of {letter}"),
                    "where G28 leads is not known: programs that use it are not judged",
                );
            }
            if letter.len() > 1 {
                open(
                    format!("a letter for {letter}"),
                    "Heidenhain, Fanuc and LinuxCNC take names of one letter only",
                );
            }
        }
        if self.retract_mm().is_none() {
            open(
                "retract_mm of Z".into(),
                "programs do not retract Z at the start, between tools and at the end",
            );
        }
        if self.control().linuxcnc_tcp.is_none() && !self.rotary().is_empty() {
            open("control.linuxcnc_tcp".into(), "LinuxCNC programs have no tool-centre-point control");
        }
        let (head, table) =
            (self.bodies().iter().any(|b| b.of_head), self.bodies().iter().any(|b| !b.of_head));
        if !(head && table) {
            let what = match (head, table) {
                (true, _) => "[[body]] of the table",
                (_, true) => "[[body]] of the head",
                _ => "[[body]]",
            };
            open(what.into(), "whether head and table run into each other is not judged");
        }
        gaps
    }
}
