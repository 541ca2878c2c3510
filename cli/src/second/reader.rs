//! Programs as moves of the tool: the four dialects, as far as they are posted, and nothing beyond.
//!
//! What is in force (rapid or feed, tool-centre-point control, a tilted plane, the tool's length) is kept from line to line. A
//! word that is not known ends the reading with its line. Work offsets stand for the setup. Positions in the machine's own
//! frame make the axes that they name unknown until they are named again: rapids from or to there are only counted.

use super::moves::{Dialect, Path, Shop};
use super::refusal::{NoOpinion, Unread};
use super::state::{Block, State};
use super::words::refuse;
use super::{heidenhain, iso};

/// Reads a program.
pub(super) fn read(program: &str, dialect: Dialect, shop: &Shop) -> Result<Path, NoOpinion> {
    let mut state = State::new(dialect, shop);
    let mut path = Path::default();
    let sections = sections(program, dialect);
    let [main, subs @ ..] = &sections[..] else { return Err(NoOpinion::Program { what: "is empty" }) };
    let mut called = Vec::new();
    let mut end = false;
    for (line, text) in &main.lines {
        match take(&mut state, *line, text)? {
            Block::End => {
                end = true;
                break;
            }
            Block::Move { rapid } => state.go(*line, text, rapid, &mut path)?,
            Block::Nothing => {}
            Block::Call(name) => {
                let sub = subs.iter().find(|s| s.name == name && !called.contains(&name));
                let Some(sub) = sub else { return refuse(*line, text, Unread::Call) };
                let mut back = false;
                for (line, text) in &sub.lines {
                    match take(&mut state, *line, text)? {
                        Block::Move { rapid } => state.go(*line, text, rapid, &mut path)?,
                        Block::Nothing => {}
                        Block::End => {
                            back = true;
                            break;
                        }
                        Block::Call(_) => return refuse(*line, text, Unread::Call),
                    }
                }
                if !back {
                    return Err(NoOpinion::Program { what: "has a subprogram without an end" });
                }
                called.push(name);
            }
        }
    }
    match (end, path.moves.is_empty()) {
        (false, _) => Err(NoOpinion::Program { what: "has no end" }),
        (_, true) => Err(NoOpinion::Program { what: "moves nothing" }),
        _ => Ok(path),
    }
}

/// Takes in a line.
fn take(state: &mut State<'_>, line: usize, text: &str) -> Result<Block, NoOpinion> {
    match state.dialect {
        Dialect::Heidenhain => heidenhain::line(state, line, text),
        _ => iso::line(state, line, text),
    }
}

/// A main program or a subprogram.
#[derive(Default)]
struct Section<'a> {
    name: String,
    lines: Vec<(usize, &'a str)>,
}

/// The main program first; of dialects other than Sinumerik's archives it is all there is.
fn sections(program: &str, dialect: Dialect) -> Vec<Section<'_>> {
    let mut sections = vec![Section::default()];
    for (k, text) in program.lines().enumerate() {
        let text = if k == 0 { text.trim_start_matches('\u{feff}') } else { text }.trim();
        let header = text.strip_prefix("%_N_").filter(|_| dialect == Dialect::Sinumerik);
        if let Some(header) = header {
            let name = header.strip_suffix("_SPF").unwrap_or_default().to_string();
            let begun = sections.last().is_some_and(|s| !s.lines.is_empty());
            if begun {
                sections.push(Section { name, lines: Vec::new() });
            }
            continue;
        }
        if let (false, Some(section)) = (text.is_empty(), sections.last_mut()) {
            section.lines.push((k + 1, text));
        }
    }
    sections
}
