//! From figures to an answer: what fails, what is not shown, and what the verdict covers.

use super::goal::{GoalStock, GoalTool, Gravity, Unseen};
use super::job::Body;
use super::tally::Tally;
use super::trial::Trial;
use super::verdict::{Answer, Figures, ScopeRow};

/// Sums that exceed a limit by less than this are the limit, rounded.
const SAME: f64 = 1.0 + 1e-9;

/// What is more than its limit, in words.
fn over(what: &str, is: f64, limit: f64, unit: &str) -> Option<String> {
    (is > limit).then(|| format!("{what} {is:.4} {unit} where {limit} {unit} are accepted"))
}

impl Trial<'_> {
    /// What fails at the samples, in words.
    pub fn failings(&self, t: &Tally, height_mm: f64) -> Vec<String> {
        let mut why = self.harms(t);
        let (l, limits) = (&self.limits, &self.goal.limits);
        why.extend(over("uncut area of", t.uncut_area_mm2, limits.unreached_mm2, "mm2"));
        if height_mm > t.scallop_max_mm && height_mm > l.scallop_mm {
            why.extend(over("a scallop with its tooth mark of", height_mm, l.scallop_mm, "mm"));
        } else {
            why.extend(over("a scallop of", t.scallop_max_mm, l.scallop_mm, "mm"));
        }
        why
    }

    /// What was taken that should stand, or touched that should not be, in words.
    fn harms(&self, t: &Tally) -> Vec<String> {
        let l = &self.limits;
        let all = [
            over("a gouge of", t.gouge_max_mm, l.gouge_mm, "mm"),
            over("the holder takes", t.holder_max_mm, l.collision_mm, "mm"),
            over("a rapid move takes", t.rapid_max_mm, l.collision_mm, "mm"),
        ];
        all.into_iter().flatten().collect()
    }

    /// Whether all that fails is what is left standing.
    pub fn leaves_only(&self, f: &Figures) -> bool {
        let collides = f.stock.as_ref().is_some_and(|s| !s.carved.collisions.is_empty());
        let breaks = self.goal.control.remarks.iter().any(|r| r.gravity == Gravity::Breaks);
        !collides
            && !breaks
            && self.harms(&f.tally).is_empty()
            && !self.failings(&f.tally, f.height_max_mm).is_empty()
    }

    /// Whether what was measured leaves room for corners that the control blends: else nothing between samples can show that it holds.
    pub fn can_be_shown(&self, t: &Tally) -> bool {
        let wanted = self.wanted(0.0);
        self.goal.limits.at_samples
            || (t.gouge_max_mm <= wanted.gouge_mm && t.scallop_max_mm <= wanted.enough_mm)
    }

    /// The answer, and why it is not held.
    pub fn answer(&self, f: &Figures, left_out: usize) -> (Answer, Vec<String>) {
        let mut bad = self.failings(&f.tally, f.height_max_mm);
        if f.coarse {
            bad.push("a coarse look tells; nothing was looked at closer".to_owned());
        }
        if let Some(first) = f.stock.as_ref().and_then(|s| s.carved.collisions.first()) {
            let count = f.stock.as_ref().map_or(0, |s| s.carved.collisions.len());
            let body = match first.body {
                Body::Cutter => "cutter",
                Body::Shank => "shank",
                Body::Holder => "holder",
            };
            let rapid = if first.rapid { " in rapid" } else { "" };
            let (block, deep) = (first.block, first.deepest_mm);
            bad.push(format!(
                "{count} collisions with raw material, the first in block {block}: the {body}{rapid} goes {deep:.3} mm deep"
            ));
        }
        let of = |g: Gravity| {
            self.goal.control.remarks.iter().filter(move |r| r.gravity == g).map(|r| r.text.clone())
        };
        bad.extend(of(Gravity::Breaks));
        if !bad.is_empty() {
            return (Answer::NotHeld, bad);
        }
        let mut open = Vec::new();
        let blend_mm = self.goal.control.blend_mm;
        let blended = if blend_mm > 0.0 {
            format!(" and corners blended by up to {blend_mm} mm")
        } else {
            String::new()
        };
        let (scallop, gouge) = (f.hidden.scallop_mm + blend_mm, f.hidden.gouge_mm + blend_mm);
        let limits = &self.limits;
        let at_samples = self.goal.limits.at_samples;
        if f.height_max_mm + scallop > SAME * limits.scallop_mm
            && !(at_samples && f.height_max_mm + blend_mm <= limits.scallop_mm)
        {
            let by = if scallop.is_finite() {
                format!("{scallop:.5} mm")
            } else {
                "nobody knows how much".to_owned()
            };
            open.push(format!(
                "between samples{blended} scallops may be {by} higher than the {:.5} mm measured",
                f.height_max_mm
            ));
        }
        let gouge_max_mm = f.tally.gouge_max_mm;
        if gouge_max_mm + gouge > SAME * limits.gouge_mm
            && !(at_samples && gouge_max_mm + blend_mm <= limits.gouge_mm)
        {
            let by =
                if gouge.is_finite() { format!("{gouge:.5} mm") } else { "nobody knows how much".to_owned() };
            open.push(format!(
                "between samples{blended} gouges may be {by} deeper than the {gouge_max_mm:.5} mm measured"
            ));
        }
        if !open.is_empty() && left_out > 0 {
            open.push(format!(
                "{left_out} or more places between samples were not looked at: smaller spacing_mm, larger max_samples"
            ));
        }
        for unseen in &self.goal.unseen {
            if let Unseen::NoSide(faces) = unseen {
                open.push(format!("nothing says on which side of {} the material is", listed(faces)));
            }
        }
        open.extend(of(Gravity::Open));
        let answer = if open.is_empty() { Answer::Held } else { Answer::NotShown };
        (answer, open)
    }

    /// The faces for which alone the verdict is, where some of the part are not looked at.
    pub fn only(&self) -> Option<String> {
        let names: Vec<String> = self.goal.machined.iter().map(|f| f.name.to_owned()).collect();
        let part = self.goal.machined.iter().any(|f| f.part_of_it.is_some());
        let out = self.goal.unseen.iter().any(|u| !matches!(u, Unseen::Hidden(_) | Unseen::Mesh(_)));
        (part || out).then(|| listed(&names))
    }

    pub fn scope(&self, f: &Figures) -> Vec<ScopeRow> {
        let goal = self.goal;
        let mut rows = Vec::new();
        let mut row = |what: &'static str, covers: String| rows.push(ScopeRow { what, covers });
        let machined: Vec<String> = goal
            .machined
            .iter()
            .map(|f| f.part_of_it.as_ref().map_or_else(|| f.name.to_owned(), |p| format!("{} ({p})", f.name)))
            .collect();
        row("to machine", listed(&machined));
        let checked: Vec<String> = goal.checked.iter().map(|f| f.name.to_owned()).collect();
        let mut others =
            if checked.is_empty() { "none".to_owned() } else { format!("{} checked", listed(&checked)) };
        for unseen in &goal.unseen {
            match unseen {
                Unseen::MayBeHit(faces) => {
                    others += &format!("; NOT looked at, as they may be hit: {}", listed(faces))
                }
                Unseen::NoSide(faces) => {
                    others +=
                        &format!("; NOT looked at, as their material side is not known: {}", listed(faces));
                }
                Unseen::Hidden(_) | Unseen::Mesh(_) => {}
            }
        }
        row("other faces", others);
        let open = goal.machined.iter().chain(&goal.checked).filter(|f| !f.open_rims.is_empty());
        let open: Vec<String> = open.map(|f| f.name.to_owned()).collect();
        if !open.is_empty() {
            row(
                "open rims",
                format!(
                    "nothing is known beneath {} where no other face goes on: depth counts up to a wall along the normals there",
                    listed(&open)
                ),
            );
        }
        for unseen in &goal.unseen {
            if let Unseen::Mesh(words) = unseen {
                row("mesh", words.clone());
            }
        }
        let hidden =
            goal.unseen.iter().filter_map(|u| if let Unseen::Hidden(words) = u { Some(words) } else { None });
        let hidden: Vec<&str> = hidden.flatten().map(String::as_str).collect();
        if !hidden.is_empty() {
            row(
                "hidden",
                format!("in the material of other bodies, neither cut nor looked at: {}", hidden.join(", ")),
            );
        }
        if let Some(allowance) = goal.roughing_mm {
            row("roughing", format!("faces are judged {allowance} mm outside, by what stands above that"));
        }
        if goal.limits.unreached_mm2 > 0.0 {
            let mut text = format!(
                "{:.3} mm2, where {} mm2 are accepted",
                f.tally.uncut_area_mm2, goal.limits.unreached_mm2
            );
            // By a coarse look what is next to a high place does not count.
            if !f.coarse {
                text += &format!(
                    "; {:.3} mm2 of it were measured higher than the scallop, what is next to that counts too",
                    f.high_area_mm2
                );
            }
            if f.open_area_mm2 > 0.0 {
                text += &format!(
                    "; {:.3} mm2 of it are cut, but more than the scallop may hide there between samples",
                    f.open_area_mm2
                );
            }
            row("not reached", text);
        }
        row(
            "raw material",
            match (&goal.stock, f.coarse) {
                (GoalStock::Assumed { layer_mm }, _) => {
                    format!("none declared: {layer_mm:.3} mm on the faces to machine are assumed")
                }
                (GoalStock::Declared { words, .. }, false) => (*words).to_owned(),
                (GoalStock::Declared { words, .. }, true) => {
                    format!("{words}; NOT looked at, as the program is far off without it")
                }
            },
        );
        row(
            "fixtures",
            if goal.fixtures.is_empty() { "none declared".to_owned() } else { "as declared".to_owned() },
        );
        row("tool", self.tool_words());
        row("feed", self.feed_words(f.too_fast, f.stock.is_some()));
        row("tooth marks", self.teeth_words());
        let control = &goal.control;
        row(
            "control",
            if control.words.is_empty() {
                "NOT looked at: CL data have none".to_owned()
            } else {
                control.words.clone()
            },
        );
        let travel = "travel of its joints along an NC program's blocks, slides at the spindle nose";
        row(
            "machine",
            if control.bodies.is_empty() {
                format!("{travel}; table, head and their bodies are NOT described")
            } else {
                format!("{travel}; bodies {}", control.bodies)
            },
        );
        rows
    }

    fn tool_words(&self) -> String {
        let tools = &self.goal.tools;
        let bare: Vec<String> = (1..)
            .zip(tools)
            .filter(|(_, t)| t.holder.is_none())
            .map(|(k, _): (usize, _)| k.to_string())
            .collect();
        match (tools.len(), bare.len()) {
            (1, 0) => "cutter and holder, in feed and rapid".to_owned(),
            (1, _) => "cutter, in feed and rapid; no holder declared".to_owned(),
            (n, 0) => format!("{n} cutters one after the other, each with its holder, in feed and rapid"),
            (n, _) => format!(
                "{n} cutters one after the other, with their holders, in feed and rapid; no holder declared of {}",
                listed(&bare)
            ),
        }
    }

    fn teeth_words(&self) -> String {
        let mut each: Vec<String> = self.goal.tools.iter().map(|t| self.teeth_of(t)).collect();
        each.dedup();
        each.join("; ")
    }

    fn teeth_of(&self, tool: &GoalTool<'_>) -> String {
        match (self.period_min(tool), tool.spindle_rpm) {
            (Some(_), Some(rpm)) => {
                let teeth = tool
                    .teeth
                    .map_or_else(|| "one tooth, as none are declared,".to_owned(), |z| format!("{z} teeth"));
                format!("added to scallops: {teeth} at {rpm} rpm")
            }
            _ if self.goal.roughing_mm.is_some() => "NOT judged on a roughing".to_owned(),
            (None, None) => "NOT judged: nothing says the spindle's speed".to_owned(),
            _ => "NOT judged: nothing says the feed".to_owned(),
        }
    }
}

/// Names for a sentence; of many the first.
fn listed(names: &[String]) -> String {
    const MOST: usize = 12;
    match names.len() {
        0 => "none".to_owned(),
        n if n > MOST => format!("{} and {} more", names[..MOST].join(", "), n - MOST),
        _ => names.join(", "),
    }
}
