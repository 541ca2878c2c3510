//! The operations of a job that lists none: from its raw material and its tools, with the reasons.
//!
//! The largest flat or rounded end roughs, and takes level faces with its bottom. The largest of the others finishes, and all smaller ones take what the one before them could not
//! reach. Where the whole part is seen from above the tool keeps its axis; where it is not, axes are a field and what the tool
//! cannot reach without harm is left to the next. The list is a job to edit: what it does not know, such as a second setup, a person
//! adds.

use crate::failure::Failure;
use crate::job::words::ToolKind;
use crate::job::{Job, Operations};
use crate::part::{self, Part};
use std::fmt::Write;

/// Points of a face along each of its sides whose normals are looked at.
const GRID: usize = 24;
/// A normal that looks down by more than this, as a sine, is not seen from above.
const DOWN: f64 = 0.02;

/// The list with the operations that are derived for it; itself where it has some.
///
/// # Errors
/// Where there is no raw material to begin with, or no tool that finishes.
pub fn derived(list: Operations, part: &Part) -> Result<Operations, Failure> {
    if !list.all().is_empty() {
        return Ok(list);
    }
    let whole = list.whole();
    if whole.stock().is_none() {
        let what = "has no [[operation]]: without a [stock] none can be derived; add one of the two";
        return Err(whole.refuse("", "", what));
    }
    list.with(&text(whole, part))
}

/// Ids of the faces that look down somewhere.
fn looking_down(part: &Part) -> Vec<&str> {
    let down = |f: &&part::LoadedFace| part::grid(&*f.surface, GRID).iter().any(|(_, _, n)| n.z < -DOWN);
    part.faces.iter().filter(down).map(|f| f.id.as_str()).collect()
}

/// A normal that leans off the vertical by less than this, as a sine, is that of a level face.
const LEVEL: f64 = 1e-9;

/// The faces that are level and look up, and the others.
fn level(part: &Part) -> (Vec<&part::LoadedFace>, Vec<&part::LoadedFace>) {
    let up = |f: &&part::LoadedFace| {
        part::grid(&*f.surface, GRID).iter().all(|(_, _, n)| n.z > 0.0 && n.x.hypot(n.y) < LEVEL)
    };
    part.faces.iter().partition(up)
}

/// The operations as they stand in a job file, with the reasons.
fn text(whole: &Job, part: &Part) -> String {
    let mut tools = whole.each_tool();
    let size = |t: &Job| t.cutter().radius_mm();
    tools.sort_by(|a, b| size(b).total_cmp(&size(a)).then(a.tool().number().cmp(&b.tool().number())));
    let roughs = |t: &&Job| matches!(t.tool().kind(), ToolKind::Flat | ToolKind::Toroidal);
    let bottom = tools.iter().find(roughs);
    let rough = bottom.unwrap_or(&tools[0]).tool().number();
    let fine: Vec<&Job> = match tools.iter().filter(|t| t.tool().number() != rough).collect::<Vec<_>>() {
        none if none.is_empty() => tools.iter().collect(),
        others => others,
    };
    let down = looking_down(part);
    let mut out = String::from("\n# Derived from raw material and tools; change what you know better.\n");
    let (strategy, way) = if down.is_empty() {
        (
            "{ kind = \"isoplanar_3c\" }",
            "all faces are seen from above, so that the tool keeps its axis".to_owned(),
        )
    } else {
        let some: Vec<&str> = down.iter().take(6).copied().collect();
        let more = if down.len() > some.len() { " and more" } else { "" };
        (
            "{ kind = \"isoparametric\", axis = \"field\" }",
            format!("{}{more} look down somewhere, so that the tool leans as it must", some.join(", ")),
        )
    };
    let _ = write!(
        out,
        "# T{rough} is the largest that cuts layers well.\n[[operation]]\nname = \"rough\"\nkind = \"rough\"\ntools = [{rough}]\n"
    );
    // Where the tool keeps its axis and another one finishes.
    let (level, others) = level(part);
    let another = bottom.is_some() && fine.iter().all(|t| t.tool().number() != rough);
    let apart = down.is_empty() && another && !level.is_empty() && !others.is_empty();
    let listed = |faces: &[&part::LoadedFace]| {
        faces.iter().map(|f| format!("\"{}\"", f.id)).collect::<Vec<_>>().join(", ")
    };
    let mut of_finish = String::new();
    if apart {
        let all = listed(&level);
        let _ = write!(
            out,
            "# Level: the bottom of T{rough} takes them in passes as wide as the tool.\n[[operation]]\nname = \"level faces\"\n\
             kind = \"finish\"\ntools = [{rough}]\nfaces = [{all}]\nstrategy = {strategy}\n"
        );
        of_finish = format!("faces = [{}]\n", listed(&others));
    }
    for (k, tool) in fine.iter().enumerate() {
        let faces = if k == 0 { of_finish.as_str() } else { "" };
        let n = tool.tool().number();
        let (name, kind, why) = if k == 0 {
            ("finish".to_owned(), "finish", format!("T{n} is the largest of the others; {way}."))
        } else {
            (
                format!("rest {k}"),
                "rest",
                format!("T{n} is smaller: it goes where the ones before left too much."),
            )
        };
        let _ = write!(
            out,
            "# {why}\n[[operation]]\nname = \"{name}\"\nkind = \"{kind}\"\ntools = [{n}]\n{faces}strategy = {strategy}\n"
        );
    }
    out
}
