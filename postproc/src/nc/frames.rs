//! Tilted working planes, as the controls are told of them; see [`super::orientation`] for their angles.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};
use osculate_geom::{Unit3, Vec3};

use super::Dialect;
use super::asked::Asked;
use super::event::{Event, Sink};
use super::interpret::Interpreter;
use super::orientation::plane;
use super::read_error::ReadError;
use crate::machine::{NearWish, angle_between};

/// The tool may lean by this against the plane that the rotary axes are said to stand at, rad: four decimals of three
/// angles, and some.
const LARGEST_LEAN_RAD: f64 = 2e-5;

/// What the rotary axes do when a plane is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    /// They go there, by the nearest way.
    Go,
    /// They stand there.
    Stay,
    /// They will go there later (G53.1).
    Later,
}

impl<S: Sink> Interpreter<'_, S> {
    fn tilt(&mut self, line: usize, plane: Isometry3<f64>, turn: Turn) -> Result<(), ReadError> {
        self.state.tilt(Some(plane));
        self.tell(&Event::Halt);
        match turn {
            Turn::Go => self.turn_to_plane(line),
            Turn::Later => Ok(()),
            Turn::Stay => {
                let axis = plane.rotation * Vec3::z();
                let rotary = self.state.rotary.map(|q| q.unwrap_or(0.0));
                let known = self.state.rotary.iter().take(self.machine.rotary().len()).all(Option::is_some);
                if known && angle_between(&self.machine.axis_at(&rotary), &axis) <= LARGEST_LEAN_RAD {
                    return Ok(());
                }
                self.refuse(line, "a tilted plane that the tool does not stand across")
            }
        }
    }

    /// The rotary axes turn the tool across the plane in force.
    pub(super) fn turn_to_plane(&mut self, line: usize) -> Result<(), ReadError> {
        let Some(plane) = self.state.plane else { return self.refuse(line, "G53.1 without a tilted plane") };
        let axis = Unit3::new_normalize(plane.rotation * Vec3::z());
        let near = self.state.rotary.map(|q| q.unwrap_or(0.0));
        match self.machine.rotary_near(&axis, &NearWish { rotary_rad: near, cone_rad: 0.0 }) {
            Ok(rotary) => {
                // Where they stand there already, up to the rounding of the plane's angles, nothing turns.
                let stands = angle_between(&self.machine.axis_at(&near), &axis) <= LARGEST_LEAN_RAD;
                let known = self.state.rotary.iter().take(self.machine.rotary().len()).all(Option::is_some);
                if !(stands && known) {
                    self.state.rotary = rotary.map(Some);
                }
                Ok(())
            }
            Err(_) => self.refuse(line, "a tilted plane that the machine does not reach"),
        }
    }

    /// The end of a tilted plane.
    pub(super) fn level(&mut self) {
        if self.state.plane.is_some() {
            self.state.tilt(None);
            self.tell(&Event::Halt);
        }
    }

    /// `CYCLE800(_FR, _TC, _ST, _MODE, X0, Y0, Z0, A, B, C, X1, Y1, Z1, _DIR, ...)`; without arguments: the end.
    pub(super) fn cycle800(&mut self, line: usize, arguments: &str) -> Result<(), ReadError> {
        if arguments.trim().is_empty() {
            self.level();
            return Ok(());
        }
        let fields: Vec<&str> = arguments.split(',').map(str::trim).collect();
        let number = |k: usize| match fields.get(k) {
            None | Some(&"") => Some(0.0),
            Some(text) => text.parse::<f64>().ok().filter(|v| v.is_finite()),
        };
        let numbers: Option<Vec<f64>> = (4..14).map(number).collect();
        let fresh = number(2) == Some(0.0);
        let mode = fields.get(3).and_then(|m| m.parse::<u32>().ok());
        let (Some(n), Some(rotation), true) = (numbers, mode.and_then(|m| axis_by_axis(m, &number)), fresh)
        else {
            return self.refuse(line, &format!("CYCLE800({arguments})"));
        };
        let unit = self.state.unit_mm;
        let before = Vec3::new(n[0], n[1], n[2]) * unit;
        let after = rotation * (Vec3::new(n[6], n[7], n[8]) * unit);
        let turn = if n[9] == 0.0 { Turn::Stay } else { Turn::Go };
        self.tilt(line, isometry(&rotation, before + after), turn)
    }

    /// `PLANE SPATIAL SPA SPB SPC`, `PLANE VECTOR BX BY BZ NX NY NZ`, `PLANE RESET`.
    pub(super) fn klartext_plane(&mut self, line: usize, arguments: &str) -> Result<(), ReadError> {
        let words: Vec<&str> = arguments.split_whitespace().collect();
        if words.first() == Some(&"RESET") {
            self.level();
            return Ok(());
        }
        let number = |name: &str| {
            words.iter().find_map(|w| w.strip_prefix(name)?.parse::<f64>().ok()).filter(|v| v.is_finite())
        };
        let all = |names: [&str; 3]| -> Option<[f64; 3]> {
            Some([number(names[0])?, number(names[1])?, number(names[2])?])
        };
        let rotation = match words.first() {
            Some(&"SPATIAL") => all(["SPA", "SPB", "SPC"]).map(|a| plane(Dialect::Heidenhain, a)),
            Some(&"VECTOR") => {
                let (base, normal) = (all(["BX", "BY", "BZ"]), all(["NX", "NY", "NZ"]));
                base.zip(normal).and_then(|(b, n)| across(&Vec3::from(b), &Vec3::from(n)))
            }
            _ => None,
        };
        let turn = if words.contains(&"STAY") { Turn::Stay } else { Turn::Go };
        match rotation {
            Some(rotation) => self.tilt(line, isometry(&rotation, Vec3::zeros()), turn),
            None => self.refuse(line, &format!("PLANE {arguments}")),
        }
    }

    /// `G68.2 X Y Z I J K`: origin and Euler angles.
    pub(super) fn g68_2(&mut self, line: usize, asked: &Asked) -> Result<(), ReadError> {
        let unit = self.state.unit_mm;
        let at = |name: &str| asked.axes.iter().find(|a| a.0 == name).map_or(0.0, |a| a.1 * unit);
        // Read as centres they have been scaled.
        let angles = asked.centre.map(|c| c.unwrap_or(0.0) / unit);
        let origin = Vec3::new(at("X"), at("Y"), at("Z"));
        self.tilt(line, isometry(&plane(Dialect::Fanuc, angles), origin), Turn::Later)
    }
}

fn isometry(rotation: &Rotation3<f64>, origin: Vec3) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(origin), UnitQuaternion::from_rotation_matrix(rotation))
}

/// Axes x along `base` and z along `normal`; `base` is made square to it.
fn across(base: &Vec3, normal: &Vec3) -> Option<Rotation3<f64>> {
    let z = Unit3::try_new(*normal, 1e-6)?;
    let x = Unit3::try_new(base - z.into_inner() * z.dot(base), 1e-6)?;
    let y = z.cross(&x);
    Some(Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x.into_inner(), y, z.into_inner()])))
}

/// Swivel mode axis by axis: two bits per rotation name its axis (1 X, 2 Y, 3 Z), the two above them are zero.
fn axis_by_axis(mode: u32, number: &dyn Fn(usize) -> Option<f64>) -> Option<Rotation3<f64>> {
    if mode >> 6 != 0 {
        return None;
    }
    let mut rotation = Rotation3::identity();
    for k in 0..3 {
        let axis = match (mode >> (2 * k)) & 3 {
            1 => Vec3::x_axis(),
            2 => Vec3::y_axis(),
            3 => Vec3::z_axis(),
            _ => return None,
        };
        let angle = number(7 + k as usize)?;
        rotation *= Rotation3::from_axis_angle(&axis, angle.to_radians());
    }
    Some(rotation)
}
