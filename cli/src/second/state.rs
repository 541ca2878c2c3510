//! What is in force in a program.

use super::kinematics::Chain;
use super::moves::{Dialect, Move, Path, Place, Shop, Way};
use super::refusal::{NoOpinion, Unread};
use super::vector::{M, V, angle, times, unit};
use super::words::refuse;

/// The tool may lean by this against its tilted plane, rad: four decimals of three angles, and some.
const LARGEST_LEAN_RAD: f64 = 2e-5;

/// What a line does.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Block {
    Nothing,
    Move {
        rapid: Option<bool>,
    },
    /// A subprogram.
    Call(String),
    End,
}

/// What the program has said of turns between two directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turning {
    Unsaid,
    /// Rotary joints go evenly, and are named.
    Joints,
    /// Rotary joints go evenly, and directions are named.
    JointsByDirection,
    /// Directions on great circles.
    Circle,
}

/// A position of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Position<'a> {
    pub name: &'a str,
    /// mm or deg.
    pub value: f64,
    /// An endless axis goes there by the shortest way.
    pub shortest: bool,
}

/// Positions of one line.
#[derive(Clone, Debug, Default)]
pub(super) struct Asked<'a> {
    pub positions: Vec<Position<'a>>,
    /// Components of the tool's direction.
    pub direction: [Option<f64>; 3],
    /// Positions are the machine's own.
    pub machine_frame: bool,
    /// A mode was switched here that changes what positions mean.
    pub switched: bool,
}

/// The state of a control.
pub(super) struct State<'a> {
    pub dialect: Dialect,
    pub chain: &'a Chain,
    shop: &'a Shop,
    pub rapid: Option<bool>,
    pub tcp: bool,
    pub turning: Turning,
    /// The tool's length is applied.
    length: bool,
    plane: Option<M>,
    linear: [Option<f64>; 3],
    rotary: [Option<f64>; 2],
    /// The tool's direction where it and not the rotary joints was named.
    axis: Option<V>,
    /// Where the line before ended, and whether the last turn could have gone either way.
    before: Option<Place>,
    either_way: bool,
    tool: Option<String>,
    offset: Option<i64>,
    /// Heidenhain's M126.
    pub shortest: bool,
    /// Sinumerik's ORIWKS.
    pub workpiece: bool,
}

impl<'a> State<'a> {
    pub fn new(dialect: Dialect, shop: &'a Shop) -> Self {
        Self {
            dialect,
            chain: &shop.chain,
            shop,
            rapid: None,
            tcp: false,
            turning: Turning::Unsaid,
            length: false,
            plane: None,
            linear: [None; 3],
            rotary: [None; 2],
            axis: None,
            before: None,
            either_way: false,
            tool: None,
            offset: None,
            shortest: false,
            workpiece: false,
        }
    }

    /// Tool-centre-point control on or off: the machine stands still, what X Y Z mean changes.
    pub fn switch_tcp(&mut self, on: bool) {
        if self.tcp == on {
            return;
        }
        let joints = self.place(false).ok().flatten().filter(|_| on && self.plane.is_none());
        self.tcp = on;
        self.linear = match joints {
            Some(p) => {
                let tip = self.chain.at(&p.linear, &p.rotary, self.shop.stand.gauge_mm).0.tip;
                self.shop.stand.words_of(tip).map(Some)
            }
            None => [None; 3],
        };
        self.before = None;
    }

    /// The tool's length on or off.
    pub fn switch_length(&mut self, on: bool) {
        if self.length != on {
            self.length = on;
            self.linear = [None; 3];
            self.before = None;
        }
    }

    /// A tilted plane, or its end.
    pub fn tilt(&mut self, plane: Option<M>) {
        if self.plane.is_some() || plane.is_some() {
            self.plane = plane;
            self.linear = [None; 3];
            self.before = None;
        }
    }

    /// The tool in the spindle, which stays the same.
    pub fn take_tool(&mut self, line: usize, name: &str) -> Result<(), NoOpinion> {
        match &self.tool {
            Some(tool) if tool != name => refuse(line, name, Unread::Tool),
            _ => {
                self.tool = Some(name.into());
                Ok(())
            }
        }
    }

    /// The work offset, which stays the same.
    pub fn take_offset(&mut self, line: usize, code: i64) -> Result<(), NoOpinion> {
        if self.offset.is_some_and(|o| o != code) {
            return refuse(line, "work offset", Unread::Offset);
        }
        self.offset = Some(code);
        Ok(())
    }

    /// Takes in the positions of a line: a move, if there are any.
    pub fn take(&mut self, line: usize, text: &str, asked: &Asked<'_>) -> Result<Block, NoOpinion> {
        let directed = asked.direction.iter().any(Option::is_some);
        if asked.positions.is_empty() && !directed {
            return if asked.machine_frame {
                refuse(line, text, Unread::Misplaced)
            } else {
                Ok(Block::Nothing)
            };
        }
        if asked.switched {
            return refuse(line, text, Unread::Misplaced);
        }
        if asked.machine_frame {
            if directed || self.tcp {
                return refuse(line, text, Unread::Misplaced);
            }
            if self.plane.is_some() {
                // Along the machine's own axes all three of the plane's may change.
                self.linear = [None; 3];
            }
            for p in &asked.positions {
                match self.chain.linear_named(p.name) {
                    Some(slot) => self.linear[slot] = None,
                    None => return refuse(line, text, Unread::Misplaced),
                }
            }
            self.before = None;
            return Ok(Block::Nothing);
        }
        self.before = self.place(true).map_err(|why| word(line, text, why))?;
        self.either_way = false;
        for p in &asked.positions {
            self.position(line, text, p)?;
        }
        if directed {
            self.direct(line, text, asked)?;
        }
        Ok(Block::Move { rapid: self.rapid })
    }

    /// Axes with positions of the tip are called X Y Z whatever the joints are called.
    fn linear_slot(&self, name: &str) -> Option<usize> {
        if self.tcp || self.plane.is_some() {
            ["X", "Y", "Z"].iter().position(|n| *n == name)
        } else {
            self.chain.linear_named(name)
        }
    }

    fn position(&mut self, line: usize, text: &str, p: &Position<'_>) -> Result<(), NoOpinion> {
        if let Some((slot, endless)) = self.chain.rotary_named(p.name) {
            let by_direction = matches!(self.turning, Turning::Circle | Turning::JointsByDirection);
            if self.tcp && by_direction {
                return refuse(line, text, Unread::Misplaced);
            }
            let goal = p.value.to_radians();
            // Only LinuxCNC counts turns of an endless axis; the others have to be told to take the shortest way.
            let shortest = match self.dialect {
                Dialect::LinuxCnc => false,
                Dialect::Sinumerik => p.shortest,
                Dialect::Heidenhain => self.shortest && endless,
                Dialect::Fanuc => endless,
            };
            if endless && !shortest && self.dialect != Dialect::LinuxCnc {
                return refuse(line, text, Unread::EitherWay);
            }
            self.rotary[slot] = Some(match self.rotary[slot].filter(|_| shortest) {
                Some(before) => {
                    let turns = (before - goal) / std::f64::consts::TAU;
                    self.either_way |= (turns - turns.floor() - 0.5).abs() < 1e-9;
                    goal + std::f64::consts::TAU * turns.round()
                }
                None => goal,
            });
            self.axis = None;
            return Ok(());
        }
        let Some(slot) = self.linear_slot(p.name).filter(|_| !p.shortest) else {
            return refuse(line, text, Unread::Unknown);
        };
        if !self.length {
            return refuse(line, text, Unread::Length);
        }
        self.linear[slot] = Some(p.value);
        Ok(())
    }

    /// The tool's direction, in the axes of X Y Z.
    fn direct(&mut self, line: usize, text: &str, asked: &Asked<'_>) -> Result<(), NoOpinion> {
        let [Some(x), Some(y), Some(z)] = asked.direction else {
            return refuse(line, text, Unread::Misplaced);
        };
        let axis = unit([x, y, z]).filter(|_| self.tcp && self.plane.is_none());
        match (axis, self.turning) {
            (Some(axis), Turning::Circle) => {
                (self.axis, self.rotary) = (Some(axis), [None; 2]);
                Ok(())
            }
            (Some(axis), Turning::JointsByDirection) => {
                let near = self.rotary.map(|q| q.unwrap_or(0.0));
                match self.chain.pointing(axis, &near).filter(|_| self.rotary_known()) {
                    Some(found) => {
                        self.rotary = found.map(Some);
                        Ok(())
                    }
                    None => refuse(line, text, Unread::Unreached),
                }
            }
            _ => refuse(line, text, Unread::Misplaced),
        }
    }

    fn rotary_known(&self) -> bool {
        self.rotary.iter().take(self.chain.rotary_count()).all(Option::is_some)
    }

    /// Whether the rotary joints hold the tool across the plane in force.
    pub fn stands_across(&self) -> bool {
        let rotary = self.rotary.map(|q| q.unwrap_or(0.0));
        let axis = self.plane.map(|plane| times(&plane, [0.0, 0.0, 1.0]));
        self.rotary_known()
            && axis.is_some_and(|axis| angle(axis, self.chain.axis(&rotary)) <= LARGEST_LEAN_RAD)
    }

    /// Where the machine stands, once every axis is known; linear axes of the tip are turned into the table's frame.
    fn place(&self, checked: bool) -> Result<Option<Place>, Unread> {
        let [Some(x), Some(y), Some(z)] = self.linear else { return Ok(None) };
        let rotary = self.rotary.map(|q| q.unwrap_or(0.0));
        let axis = match self.axis {
            Some(axis) => axis,
            None if self.rotary_known() => self.chain.axis(&rotary),
            None => return Ok(None),
        };
        if checked && self.plane.is_some() && !self.stands_across() {
            return Err(Unread::Plane);
        }
        let words = self.plane.map_or([x, y, z], |plane| times(&plane, [x, y, z]));
        let linear = if self.tcp || self.plane.is_some() { self.shop.stand.tip_of(words) } else { [x, y, z] };
        Ok(Some(Place { linear, rotary, axis }))
    }

    /// The move from where the line before ended.
    pub fn go(
        &mut self,
        line: usize,
        text: &str,
        rapid: Option<bool>,
        path: &mut Path,
    ) -> Result<(), NoOpinion> {
        let Some(rapid) = rapid else { return refuse(line, text, Unread::Motion) };
        let to = self.place(true).map_err(|why| word(line, text, why))?;
        let (Some(from), Some(to)) = (self.before.take(), to) else {
            path.unseen_rapids += 1;
            return if rapid { Ok(()) } else { refuse(line, text, Unread::Unplaced) };
        };
        if self.either_way {
            return refuse(line, text, Unread::EitherWay);
        }
        let turns = angle(from.axis, to.axis) > 0.0;
        let way = match (self.tcp, self.plane, self.turning) {
            (false, None, _) => Way::Joints,
            (_, Some(_), _) => Way::Tip,
            (true, None, Turning::Circle) => Way::Circle,
            (true, None, Turning::Unsaid) if turns => return refuse(line, text, Unread::Turning),
            (true, None, _) => Way::Tip,
        };
        // On a great circle there is none between opposite directions.
        if way == Way::Circle && angle(from.axis, to.axis) > std::f64::consts::PI - 1e-6 {
            return refuse(line, text, Unread::EitherWay);
        }
        if from != to {
            path.moves.push(Move { line, rapid, way, from, to });
        }
        Ok(())
    }
}

fn word(line: usize, text: &str, why: Unread) -> NoOpinion {
    NoOpinion::Word { line, word: text.chars().take(40).collect(), why }
}
