//! Lines of Heidenhain's Klartext.

use super::refusal::{NoOpinion, Unread};
use super::state::{Asked, Block, Position, State, Turning};
use super::vector::{M, about, after};
use super::words::{klartext, number, refuse};

/// Takes in a line.
pub(super) fn line(s: &mut State<'_>, at: usize, text: &str) -> Result<Block, NoOpinion> {
    let code = text.split(';').next().unwrap_or_default();
    let mut words: Vec<&str> = code.split_whitespace().collect();
    if words.first().is_some_and(|w| w.bytes().all(|b| b.is_ascii_digit())) {
        words.remove(0);
    }
    let unknown = || refuse(at, text, Unread::Unknown);
    match words[..] {
        [] | ["BEGIN", "PGM", _, "MM"] | ["CYCL", "DEF", ..] if smoothing(&words) => {}
        ["END", "PGM", _, "MM"] | ["M2" | "M30"] => return Ok(Block::End),
        ["FUNCTION", "RESET", "TCPM"] => {
            s.switch_tcp(false);
            s.turning = Turning::Unsaid;
        }
        ["FUNCTION", "TCPM", "F", "TCP", "AXIS", "POS", "PATHCTRL", "AXIS"] => {
            s.switch_tcp(true);
            s.turning = Turning::Joints;
        }
        ["FUNCTION", "TCPM", "F", "TCP", "AXIS", "SPAT", "PATHCTRL", "VECTOR"] => {
            s.switch_tcp(true);
            s.turning = Turning::Circle;
        }
        ["TOOL", "CALL", name, "Z", ..] => {
            let plain = words[4..].iter().all(|w| w.strip_prefix('S').and_then(number).is_some());
            if !plain {
                return unknown();
            }
            s.take_tool(at, name)?;
            s.switch_length(true);
        }
        ["PLANE", "RESET", "STAY"] => s.tilt(None),
        ["PLANE", "SPATIAL", a, b, c, "STAY"] => {
            let Some(plane) = spatial(a, b, c).filter(|_| !s.tcp) else { return unknown() };
            s.tilt(Some(plane));
        }
        ["L", ..] => return straight(s, at, text, (&words[1..], false)),
        ["LN", ..] => return straight(s, at, text, (&words[1..], true)),
        _ => {
            for word in words {
                match word {
                    "M126" | "M127" => s.shortest = word == "M126",
                    "M0" | "M1" | "M3" | "M4" | "M5" | "M6" | "M7" | "M8" | "M9" => {}
                    _ => return unknown(),
                }
            }
        }
    }
    Ok(Block::Nothing)
}

/// Of cycles only the tolerance of smoothing is known.
fn smoothing(words: &[&str]) -> bool {
    words.first() != Some(&"CYCL") || words.get(2).is_some_and(|w| matches!(*w, "32.0" | "32.1" | "32.2"))
}

/// `PLANE SPATIAL SPA SPB SPC`: about the fixed X, then Y, then Z.
fn spatial(a: &str, b: &str, c: &str) -> Option<M> {
    let angle = |word: &str, name: &str| Some(number(word.strip_prefix(name)?)?.to_radians());
    let (a, b, c) = (angle(a, "SPA")?, angle(b, "SPB")?, angle(c, "SPC")?);
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Some(after(&about(z, c), &after(&about(y, b), &about(x, a))))
}

/// `L` and `LN`: positions, a direction, F, `FMAX`, `M91`.
fn straight(
    s: &mut State<'_>,
    at: usize,
    text: &str,
    (words, directed): (&[&str], bool),
) -> Result<Block, NoOpinion> {
    let mut asked = Asked::default();
    let mut rapid = false;
    for word in words {
        match *word {
            "R0" => continue,
            "FMAX" => {
                rapid = true;
                continue;
            }
            "M91" => {
                asked.machine_frame = true;
                continue;
            }
            _ => {}
        }
        let Some((name, value)) = klartext(word) else { return refuse(at, text, Unread::Unknown) };
        let component = ["TX", "TY", "TZ"].iter().position(|n| *n == name);
        let axis = s.chain.linear_named(name).is_some() || s.chain.rotary_named(name).is_some();
        match component {
            Some(k) if directed => asked.direction[k] = Some(value),
            None if axis || matches!(name, "X" | "Y" | "Z") => {
                asked.positions.push(Position { name, value, shortest: false });
            }
            None if name == "F" => {}
            _ => return refuse(at, text, Unread::Unknown),
        }
    }
    if directed && asked.direction.iter().any(Option::is_none) {
        return refuse(at, text, Unread::Misplaced);
    }
    // FMAX holds for its own line.
    s.rapid = Some(rapid);
    s.take(at, text, &asked)
}
