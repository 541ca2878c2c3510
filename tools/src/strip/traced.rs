//! A geodesic feed line with the states near the contact kept.
//!
//! Every pose on a geodesic is integrated from the contact on; a strip asks for dozens. Kept states make one step of each.

use super::StripError;
use crate::contact::Contact;
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::line::{GeodesicLine, LineError, SurfaceLine};
use osculate_geom::{Darboux, Surface};

/// States kept to each side.
const KEPT: usize = 24;

/// The geodesic, in arc length from the contact.
pub(super) struct Traced<'a> {
    surface: &'a dyn Surface,
    step_mm: f64,
    /// Ahead and behind, from the contact on; shorter where the line ends.
    kept: [Vec<GeodesicState>; 2],
}

impl<'a> Traced<'a> {
    pub(super) fn new(contact: &Contact<'a>, line: &GeodesicLine<'a>) -> Result<Self, StripError> {
        let start = line.state(0.0).map_err(crate::contact::ContactError::from)?;
        let step_mm = contact.step_mm();
        let kept = [1.0, -1.0].map(|sign| {
            let mut states = Vec::with_capacity(KEPT + 1);
            states.push(start);
            for k in 0..KEPT {
                match states[k].step(contact.surface, sign * step_mm) {
                    Ok(next) => states.push(next),
                    Err(_) => break,
                }
            }
            states
        });
        Ok(Self { surface: contact.surface, step_mm, kept })
    }

    fn state(&self, t: f64) -> Result<GeodesicState, LineError> {
        let kept = &self.kept[usize::from(t < 0.0)];
        let known = ((t.abs() / self.step_mm) as usize).min(kept.len() - 1);
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
