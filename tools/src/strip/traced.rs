//! A geodesic feed line with the states near the contact kept.
//!
//! Every pose on a geodesic is integrated from the contact on; a strip asks for dozens. Kept states make one step of each;
//! they are added as far as is asked for.

use super::StripError;
use crate::contact::Contact;
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::line::{GeodesicLine, LineError, SurfaceLine};
use osculate_geom::{Darboux, Surface};
use std::sync::{Mutex, PoisonError};

/// States for which there is room at once.
const FIRST: usize = 32;

/// Most states kept to each side: as far as a tool reaches over a place that is bent by a hundredth of its radius.
const MOST: usize = 20_000;

/// The geodesic, in arc length from the contact.
pub(super) struct Traced<'a> {
    surface: &'a dyn Surface,
    step_mm: f64,
    /// Ahead and behind, from the contact on, as far as was asked for; a line may be shared between threads.
    kept: [Mutex<Vec<GeodesicState>>; 2],
}

impl<'a> Traced<'a> {
    pub(super) fn new(contact: &Contact<'a>, line: &GeodesicLine<'a>) -> Result<Self, StripError> {
        let start = line.state(0.0).map_err(crate::contact::ContactError::from)?;
        let kept = [(); 2].map(|()| {
            let mut states = Vec::with_capacity(FIRST);
            states.push(start);
            Mutex::new(states)
        });
        Ok(Self { surface: contact.surface, step_mm: contact.step_mm(), kept })
    }

    fn state(&self, t: f64) -> Result<GeodesicState, LineError> {
        // A list that a panic has left is whole all the same: states are only added.
        let kept = &self.kept[usize::from(t < 0.0)];
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        let known = ((t.abs() / self.step_mm) as usize).min(MOST);
        while kept.len() <= known {
            let last = kept[kept.len() - 1];
            kept.push(last.step(self.surface, self.step_mm * t.signum())?);
        }
        let rest = t.abs() - known as f64 * self.step_mm;
        let steps = (rest / self.step_mm).ceil().max(1.0);
        let h = rest / steps * t.signum();
        let mut state = kept[known];
        for _ in 0..steps as usize {
            state = state.step(self.surface, h)?;
        }
        if self.surface.domain().contains(state.at) {
            Ok(state)
        } else {
            Err(LineError::Outside { at: state.at })
        }
    }
}

impl SurfaceLine for Traced<'_> {
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError> {
        let s = self.state(t)?;
        let jet = self.surface.jet2(s.at);
        let direction = jet.tangent(s.rate);
        Ok((Darboux::new(&jet, &direction, 0.0)?, direction.norm()))
    }
}
