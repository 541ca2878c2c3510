//! A geodesic feed line with the states near the contact kept.
//!
//! Every pose on a geodesic is integrated from the contact on; a strip asks for dozens. Kept states are added as far as is
//! asked for; between two of them with no knot of the surface between, parameters are the polynomial of fifth degree through
//! both with two derivatives, whose error is of sixth order in the distance where that of the integration is of fifth.

use super::StripError;
use super::knotted::Knotted;
use crate::contact::Contact;
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::line::{GeodesicLine, LineError, SurfaceLine};
use osculate_geom::{Darboux, Uv, uv};
use std::sync::{Mutex, PoisonError};

/// States for which there is room at once.
const FIRST: usize = 32;

/// Most states kept to each side: as far as a tool reaches over a place that is bent by a hundredth of its radius.
const MOST: usize = 20_000;

/// Most steps between knots: half the distance between two.
const OF_PITCH: f64 = 0.5;

/// A state with the second derivative of its parameters, and whether no knot lies between it and the next.
#[derive(Clone, Copy)]
pub(super) struct Kept {
    pub state: GeodesicState,
    pub second: Uv,
    pub clear: bool,
}

/// The geodesic, in arc length from the contact.
pub(super) struct Traced<'a> {
    part: &'a Knotted<'a>,
    step_mm: f64,
    /// Ahead and behind, from the contact on, as far as was asked for; a line may be shared between threads.
    kept: [Mutex<Vec<Kept>>; 2],
}

impl<'a> Traced<'a> {
    /// The line through a contact; `pitch_mm` is the distance between the surface's knots on it.
    pub(super) fn new(
        contact: &Contact<'a>,
        part: &'a Knotted<'a>,
        line: &GeodesicLine<'a>,
        pitch_mm: f64,
    ) -> Result<Self, StripError> {
        let state = line.state(0.0).map_err(crate::contact::ContactError::from)?;
        let first = Kept { state, second: state.acceleration(contact.surface)?, clear: false };
        let kept = [(); 2].map(|()| {
            let mut states = Vec::with_capacity(FIRST);
            states.push(first);
            Mutex::new(states)
        });
        let finest = contact.cutter.radius_mm() / MOST as f64;
        Ok(Self { part, step_mm: contact.step_mm().min(OF_PITCH * pitch_mm).max(finest), kept })
    }

    fn state(&self, t: f64) -> Result<GeodesicState, LineError> {
        let surface = self.part.surface;
        // A list that a panic has left is whole all the same: states are only added.
        let kept = &self.kept[usize::from(t < 0.0)];
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        let known = ((t.abs() / self.step_mm) as usize).min(MOST);
        let sign = if t < 0.0 { -1.0 } else { 1.0 };
        while kept.len() < known + 2 {
            let last = kept.len() - 1;
            let from = kept[last].state;
            let Ok(state) = self.part.advance(&from, self.step_mm * sign) else { break };
            let Ok(second) = state.acceleration(surface) else { break };
            kept[last].clear = self.part.is_clear(&from, &state);
            kept.push(Kept { state, second, clear: false });
        }
        let near = kept[known.min(kept.len() - 1)];
        let mut rest = t.abs() - (known.min(kept.len() - 1)) as f64 * self.step_mm;
        let state = if near.clear && rest <= self.step_mm {
            between(&near, &kept[known + 1], self.step_mm * sign, rest / self.step_mm)
        } else {
            let mut state = near.state;
            while rest > 0.0 {
                let by = rest.min(self.step_mm);
                state = self.part.advance(&state, by * sign)?;
                rest -= by;
            }
            state
        };
        if surface.domain().contains(state.at) { Ok(state) } else { Err(LineError::Outside { at: state.at }) }
    }
}

/// The state at the share `x` of the way `step_mm` between two.
pub(super) fn between(a: &Kept, b: &Kept, step_mm: f64, x: f64) -> GeodesicState {
    let one = |pa: f64, va: f64, wa: f64, pb: f64, vb: f64, wb: f64| {
        let (va, wa, vb, wb) =
            (va * step_mm, 0.5 * wa * step_mm * step_mm, vb * step_mm, wb * step_mm * step_mm);
        // pa + va x + wa x^2 + c3 x^3 + c4 x^4 + c5 x^5 with what is left at the end, its slope and its bend.
        let (p, v, w) = (pb - pa - va - wa, vb - va - 2.0 * wa, wb - 2.0 * wa);
        let c3 = 10.0 * p - 4.0 * v + 0.5 * w;
        let c4 = -15.0 * p + 7.0 * v - w;
        let c5 = 6.0 * p - 3.0 * v + 0.5 * w;
        let at = pa + x * (va + x * (wa + x * (c3 + x * (c4 + x * c5))));
        let rate = va + x * (2.0 * wa + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)));
        (at, rate / step_mm)
    };
    let (s, e) = (&a.state, &b.state);
    let (u, du) = one(s.at.u, s.rate.u, a.second.u, e.at.u, e.rate.u, b.second.u);
    let (v, dv) = one(s.at.v, s.rate.v, a.second.v, e.at.v, e.rate.v, b.second.v);
    GeodesicState { at: uv(u, v), rate: uv(du, dv) }
}

impl SurfaceLine for Traced<'_> {
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError> {
        let s = self.state(t)?;
        let jet = self.part.surface.jet2(s.at);
        let direction = jet.tangent(s.rate);
        Ok((Darboux::new(&jet, &direction, 0.0)?, direction.norm()))
    }
}
