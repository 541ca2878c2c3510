//! The axis surface that leaves the least envelope deviation over a whole face.
//!
//! Unknowns are the poles of the two guiding splines of an [`AxisSurface`](super::axes::AxisSurface). For a point P of the face with nearest position
//! tau, cutter normal g and foot z on the axis, moving Q0 and Q1 by a and b changes the deviation to first order by
//! `-g . ((1 - s) a + s b)`, `s = z / |Q1 - Q0|`: the minimum over tau does not move it (envelope theorem). The greatest deviation
//! is minimised by a sequence of such linear problems inside a trust region (`slp`), each solved by an interior point
//! method (`qp`). What the answer is worth is told by [`Found::bound_mm`].

mod band;
mod linear;
mod qp;
mod sampling;
mod slp;
mod start;
mod task;

pub use slp::optimise;
pub use start::{Start, starts};
pub use task::{Found, GlobalError, Goal, Options, StartError, Task};
