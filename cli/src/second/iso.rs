//! Lines of Sinumerik, Fanuc and LinuxCNC.

use super::moves::Dialect;
use super::refusal::{NoOpinion, Unread};
use super::state::{Asked, Block, Position, State, Turning};
use super::vector::{M, about, after};
use super::words::{Word, iso, number, refuse};

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// What a line says beside its positions.
#[derive(Default)]
struct Said {
    /// G68.2 and G53.1.
    plane: bool,
    to_plane: bool,
    /// `G43`, `G43.4`, `G43.5`, by ten, and the length's number.
    length: Option<i64>,
    length_number: bool,
    /// `G64`, with LinuxCNC its `Q` too; `G5.1`.
    blend: bool,
    smooth: bool,
    p: bool,
    q: bool,
    end: bool,
    call: Option<String>,
}

/// Takes in a line.
pub(super) fn line(s: &mut State<'_>, number: usize, text: &str) -> Result<Block, NoOpinion> {
    let sinumerik = s.dialect == Dialect::Sinumerik;
    if text.starts_with('%') {
        return if text == "%" { Ok(Block::Nothing) } else { refuse(number, text, Unread::Unknown) };
    }
    let mut asked = Asked::default();
    let mut said = Said::default();
    for word in iso(number, text, !sinumerik)? {
        let known = match word {
            Word::Value("G", v) => code(s, number, tenths(v), (&mut asked, &mut said))?,
            Word::Value("M", v) => auxiliary(s, tenths(v), &mut asked, &mut said),
            Word::Value("N" | "F" | "S", _) => true,
            Word::Value("O", _) => s.dialect == Dialect::Fanuc,
            Word::Value("T", v) => s.take_tool(number, &v.to_string()).map(|()| true)?,
            Word::Value("D", v) if sinumerik => {
                // D0 stands beside the machine's own positions, D1 alone.
                asked.switched |= !asked.machine_frame && v != 0.0;
                s.switch_length(v != 0.0);
                v == 0.0 || v == 1.0
            }
            Word::Value("H", _) if !sinumerik => {
                said.length_number = true;
                true
            }
            Word::Value("P", _) if !sinumerik => {
                said.p = true;
                true
            }
            Word::Value("Q", _) if !sinumerik => {
                said.q = true;
                true
            }
            Word::Value(name, value) => position(s, name, value, &mut asked),
            Word::Shortest(name, value) => {
                asked.positions.push(Position { name, value, shortest: true });
                true
            }
            Word::Indexed(name) => name == "FGREF",
            Word::Call("CYCLE832" | "FGROUP", _) => true,
            Word::Call("CYCLE800", arguments) => {
                asked.switched = true;
                match cycle800(arguments) {
                    Some(plane) => s.tilt(plane),
                    None => return refuse(number, text, Unread::Misplaced),
                }
                plane_holds(s, number, text)?;
                true
            }
            Word::Call(..) => false,
            Word::Name(name) => sinumerik && named(s, name, &mut asked, &mut said),
        };
        if !known {
            return refuse(number, text, Unread::Unknown);
        }
    }
    if said.plane {
        let Some(plane) = euler(&asked) else { return refuse(number, text, Unread::Misplaced) };
        s.tilt(Some(plane));
        return plane_holds(s, number, text).map(|()| Block::Nothing);
    }
    if said.to_plane {
        plane_holds(s, number, text)?;
        if !s.stands_across() {
            return refuse(number, text, Unread::Plane);
        }
    }
    if let Some(length) = said.length {
        asked.switched = true;
        s.switch_length(true);
        // LinuxCNC's kinematics have a switch of their own.
        if s.dialect == Dialect::Fanuc {
            s.switch_tcp(length != 430);
            s.turning = if length == 435 { Turning::JointsByDirection } else { Turning::Joints };
        }
    }
    let alone = said.length.is_some() != said.length_number
        || said.p && !said.blend
        || said.q && !(said.smooth || said.blend && s.dialect == Dialect::LinuxCnc)
        || said.length_number && asked.machine_frame;
    if alone {
        return refuse(number, text, Unread::Misplaced);
    }
    let block = s.take(number, text, &asked)?;
    match (said.end, said.call) {
        (false, None) => Ok(block),
        (true, None) if block == Block::Nothing => Ok(Block::End),
        (false, Some(name)) if block == Block::Nothing => Ok(Block::Call(name)),
        _ => refuse(number, text, Unread::Misplaced),
    }
}

/// Ten times a code, which has one decimal at most; anything else becomes a code that nobody knows.
fn tenths(value: f64) -> i64 {
    let whole = (value * 10.0).round();
    // Small whole numbers are exact.
    #[allow(clippy::cast_possible_truncation)]
    if (whole - value * 10.0).abs() < 1e-9 && whole.abs() < 1e6 { whole as i64 } else { -1 }
}

fn plane_holds(s: &State<'_>, line: usize, text: &str) -> Result<(), NoOpinion> {
    // With tool-centre-point control X Y Z would be in two frames at once.
    if s.tcp { refuse(line, text, Unread::Misplaced) } else { Ok(()) }
}

fn code(
    s: &mut State<'_>,
    line: usize,
    code: i64,
    (asked, said): (&mut Asked<'_>, &mut Said),
) -> Result<bool, NoOpinion> {
    let (fanuc, sinumerik) = (s.dialect == Dialect::Fanuc, s.dialect == Dialect::Sinumerik);
    match code {
        0 | 10 => s.rapid = Some(code == 0),
        // XY plane, no correction of the radius, absolute, per minute or inverse.
        170 | 400 | 900 | 930 | 940 => {}
        210 | 800 => return Ok(!sinumerik),
        7100 => return Ok(sinumerik),
        540..=570 if code % 10 == 0 => s.take_offset(line, code)?,
        640 => {
            said.blend = true;
            return Ok(!fanuc);
        }
        // At rest at the end of every move.
        611 => return Ok(s.dialect == Dialect::LinuxCnc),
        51 if fanuc => said.smooth = true,
        490 if !sinumerik => {
            asked.switched = true;
            s.switch_length(false);
            if fanuc {
                s.switch_tcp(false);
            }
        }
        430 if !sinumerik => said.length = Some(code),
        434 | 435 if fanuc => said.length = Some(code),
        921 => return Ok(s.dialect == Dialect::LinuxCnc),
        530 if !sinumerik => asked.machine_frame = true,
        682 if fanuc => said.plane = true,
        531 if fanuc => said.to_plane = true,
        690 if fanuc => {
            asked.switched = true;
            s.tilt(None);
        }
        _ => return Ok(false),
    }
    Ok(true)
}

fn auxiliary(s: &mut State<'_>, code: i64, asked: &mut Asked<'_>, said: &mut Said) -> bool {
    if let (Dialect::LinuxCnc, Some(switch)) = (s.dialect, &s.chain.switch) {
        let word = format!("M{}", code / 10);
        if let Some(k) = switch.iter().position(|w| *w == word).filter(|_| code % 10 == 0) {
            asked.switched = true;
            s.switch_tcp(k == 0);
            s.turning = Turning::Joints;
            return true;
        }
    }
    match code {
        // Spindle, coolant, tool change, stop.
        0 | 10 | 30 | 40 | 50 | 60 | 70 | 80 | 90 => true,
        20 | 300 => {
            said.end = true;
            true
        }
        170 if s.dialect == Dialect::Sinumerik => {
            said.end = true;
            true
        }
        _ => false,
    }
}

/// A letter that may be an axis or a component of a direction; false where it is neither.
fn position<'a>(s: &State<'_>, name: &'a str, value: f64, asked: &mut Asked<'a>) -> bool {
    let components = if s.dialect == Dialect::Sinumerik { ["A3", "B3", "C3"] } else { ["I", "J", "K"] };
    let component = components.iter().position(|n| *n == name).filter(|_| s.dialect != Dialect::LinuxCnc);
    if let Some(k) = component {
        asked.direction[k] = Some(value);
        return true;
    }
    let axis = s.chain.linear_named(name).is_some() || s.chain.rotary_named(name).is_some();
    if axis || matches!(name, "X" | "Y" | "Z") {
        asked.positions.push(Position { name, value, shortest: false });
        return true;
    }
    false
}

/// Sinumerik's words without arguments.
fn named(s: &mut State<'_>, name: &str, asked: &mut Asked<'_>, said: &mut Said) -> bool {
    match name {
        "TRAORI" | "TRAFOOF" => {
            asked.switched = true;
            s.switch_tcp(name == "TRAORI");
            s.turning = Turning::Unsaid;
        }
        // Alone in its line it deletes frames.
        "TRANS" => return asked.positions.is_empty(),
        "SUPA" => asked.machine_frame = true,
        "ORIMKS" | "ORIWKS" => s.workpiece = name == "ORIWKS",
        "ORIAXES" => s.turning = Turning::Joints,
        "ORIVECT" if s.workpiece => s.turning = Turning::Circle,
        "ORIVECT" => return false,
        _ => {
            let plain = name.len() > 2 && name.bytes().take(2).all(|b| b.is_ascii_uppercase() || b == b'_');
            if plain {
                said.call = Some(name.into());
            }
            return plain;
        }
    }
    true
}

/// `CYCLE800(0,"",0,57,0,0,0,A,B,C,0,0,0,0)`: axis by axis about X Y Z as turned so far, without motion; with nothing in its
/// brackets the end of the plane.
fn cycle800(arguments: &str) -> Option<Option<M>> {
    if arguments.is_empty() {
        return Some(None);
    }
    let fields: Vec<&str> = arguments.split(',').collect();
    let n: Vec<f64> =
        fields.iter().map(|f| if *f == "\"\"" { Some(0.0) } else { number(f) }).collect::<Option<_>>()?;
    let [a, b, c] = [*n.get(7)?, *n.get(8)?, *n.get(9)?].map(f64::to_radians);
    let rest = (0..14).all(|k| (7..10).contains(&k) || n.get(k) == Some(if k == 3 { &57.0 } else { &0.0 }));
    (rest && n.len() == 14).then(|| Some(after(&about(X, a), &after(&about(Y, b), &about(Z, c)))))
}

/// `G68.2 X0 Y0 Z0 I J K`: Euler angles about Z, X, Z as turned so far.
fn euler(asked: &Asked<'_>) -> Option<M> {
    let [i, j, k] = asked.direction;
    let [i, j, k] = [i?, j?, k?].map(f64::to_radians);
    let origin = ["X", "Y", "Z"]
        .iter()
        .all(|n| asked.positions.iter().filter(|p| p.name == *n).map(|p| p.value).eq([0.0]));
    let plain = origin && asked.positions.len() == 3;
    plain.then(|| after(&about(Z, i), &after(&about(X, j), &about(Z, k))))
}
