//! `machines`, `dialects`, `tools`: what is built in.

use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome};
use osculate::job::tool;
use osculate::words;
use osculate::words::Table;
use osculate::work::nc;
use osculate_postproc::machine::spec::CarriedSide;
use osculate_postproc::machine::{Gap, Joint, JointKind};
use osculate_postproc::nc::Dialect;
use osculate_postproc::nc::reading::FeedRow;
use osculate_postproc::{DialectFile, shipped_dialects};
use osculate_postproc::{Machine, built_in_names};
use serde::Serialize;

#[derive(Serialize)]
struct MachineRow {
    name: String,
    description: String,
    joints: Vec<String>,
}

/// Runs `machines`.
pub fn machines(json: bool) -> Outcome {
    let mut rows = Vec::new();
    for name in built_in_names() {
        let m = Machine::built_in(name).map_err(Failure::job)?;
        rows.push(MachineRow {
            name: m.name().to_owned(),
            description: m.description().to_owned(),
            joints: m.joints().iter().map(|j| j.letter.clone()).collect(),
        });
    }
    if json {
        render::json(&rows)?;
        return Ok(Done::Yes);
    }
    let mut t = Table::new(["machine", "joints, part to tool"]);
    for r in &rows {
        t.row([r.name.clone(), r.joints.join(" ")]);
    }
    render::text(&format!("\n{}\n", t.render()))?;
    for name in built_in_names() {
        render::text(&chain(&Machine::built_in(name).map_err(Failure::job)?))?;
    }
    Ok(Done::Yes)
}

/// The chain of a machine as a line, part to tool, with the bed between, and its joints below.
fn chain(m: &Machine) -> String {
    let table = m.joints().iter().filter(|j| j.side == CarriedSide::Table);
    let head = m.joints().iter().filter(|j| j.side == CarriedSide::Head);
    let link = |j: &Joint| match j.kind {
        JointKind::Linear => format!("--[{}]", j.letter),
        JointKind::Rotary => format!("--({})", j.letter),
    };
    let carried: String = table.map(link).collect();
    let carrying: String = head.map(link).collect();
    let mut out = format!("  {}: {}\n    part{carried}--#bed#{carrying}--tool\n", m.name(), m.description());
    for j in m.joints() {
        let [x, y, z] = [j.direction.x, j.direction.y, j.direction.z].map(|c| words::number(c, 4));
        let end = |v: Option<f64>| v.map_or("no limit".into(), |v| words::number(j.shown(v), 5));
        let range =
            if j.is_endless() { "endless".into() } else { format!("{} to {}", end(j.min), end(j.max)) };
        let d = &j.drive;
        out.push_str(&format!(
            "      {:<4} along ({x}, {y}, {z}), {range} {u}, {} {u}/s, {} {u}/s2\n",
            j.letter,
            words::number(j.shown(d.velocity_per_s), 4),
            words::number(j.shown(d.acceleration_per_s2), 4),
            u = j.unit()
        ));
    }
    out + "\n"
}

/// Runs `machines --check`.
pub fn check_machine(word: &str, json: bool) -> Outcome {
    let machine = nc::machine(word)?;
    let gaps = machine.gaps();
    if json {
        let row = |g: &Gap| serde_json::json!({ "key": g.key, "meaning": g.meaning });
        render::json(
            &serde_json::json!({ "name": machine.name(), "open": gaps.iter().map(row).collect::<Vec<_>>() }),
        )?;
        return Ok(Done::Yes);
    }
    let mut t = Table::left(["not said", "what that means"]);
    gaps.into_iter().for_each(|g| t.row([g.key, g.meaning]));
    render::text(&format!("\n{}\n{}\n", chain(&machine).trim_end(), t.render()))?;
    Ok(Done::Yes)
}

/// Runs `dialects`.
pub fn dialects(json: bool) -> Outcome {
    if json {
        let feed = |d: Dialect| -> Vec<_> {
            let row = |r: &FeedRow| serde_json::json!({ "words": r.words, "meaning": r.meaning, "source": r.source });
            d.feed_rows().iter().map(row).collect()
        };
        let one =
            |d: Dialect| serde_json::json!({ "name": d.name(), "extension": d.extension(), "feed": feed(d) });
        let own = |d: DialectFile| serde_json::json!({ "name": d.name(), "extension": d.extension(), "engine": d.engine().name(), "description": d.description() });
        let shipped = shipped_dialects().filter_map(DialectFile::shipped).map(own);
        render::json(&Dialect::ALL.into_iter().map(one).chain(shipped).collect::<Vec<_>>())?;
        return Ok(Done::Yes);
    }
    for d in Dialect::ALL {
        let mut t = Table::new(["words", "F is"]);
        let mut sources: Vec<&str> = Vec::new();
        for r in d.feed_rows() {
            t.row([r.words.to_owned(), r.meaning.to_owned()]);
            if !sources.contains(&r.source) {
                sources.push(r.source);
            }
        }
        render::text(&format!("\n{} (.{})\n{}\n", d.name(), d.extension(), t.render()))?;
        for source in sources {
            render::text(&format!("  {source}\n"))?;
        }
    }
    for own in shipped_dialects().filter_map(DialectFile::shipped) {
        let (name, extension, engine) = (own.name(), own.extension(), own.engine());
        render::text(&format!(
            "\n{name} (.{extension}), words of its own over {engine}: {}\n",
            own.description()
        ))?;
    }
    render::text("\n")?;
    Ok(Done::Yes)
}

/// Runs `tools`.
pub fn tools(json: bool) -> Outcome {
    let rows = tool::KINDS.map(|(kind, needs, may)| {
        let optional = may.iter().copied().chain(["length_mm"]).map(|k| format!("[{k}]"));
        let keys: Vec<String> = needs.iter().map(ToString::to_string).chain(optional).collect();
        (kind.word(), keys.join(", "))
    });
    if json {
        render::json(&rows.map(|(kind, keys)| serde_json::json!({ "kind": kind, "keys": keys })))?;
        return Ok(Done::Yes);
    }
    let mut t = Table::new(["kind", "keys"]);
    for (kind, keys) in rows {
        t.row([kind.to_owned(), keys]);
    }
    render::text(&format!("\n{}\n", t.render()))?;
    Ok(Done::Yes)
}
