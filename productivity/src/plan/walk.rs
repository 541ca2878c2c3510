//! How far a quantity stays within its limit.

use osculate_geom::roots::{End, bracketed};

/// Steps of a walk before it is given up as endless.
const MOST_STEPS: u32 = 400;

/// How near a good guess is taken to be, of itself.
const CLOSE: f64 = 0.1;

/// Where a walk starts, where it must end, its first step, and how exactly it ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    pub from: f64,
    pub to: f64,
    /// A guess of the distance.
    pub guess: f64,
    /// Accuracy of the end.
    pub tolerance: f64,
}

impl Walk {
    /// The largest argument towards `to` up to which `f` stays at or below zero, walking in growing steps; never beyond it.
    pub(super) fn last_below<E>(&self, f: impl FnMut(f64) -> Result<f64, E>) -> Result<f64, E> {
        self.walked(None, 0.5 * self.guess, f)
    }

    /// The same where the guess is a good one, such as the answer next door: looks a little before and behind it first.
    pub(super) fn last_below_near<E>(&self, mut f: impl FnMut(f64) -> Result<f64, E>) -> Result<f64, E> {
        let x = (self.from + (1.0 - CLOSE) * self.guess).min(self.to);
        let near = End { x, f: f(x)? };
        if near.f > 0.0 {
            return self.walked(None, (1.0 - CLOSE) * self.guess, f);
        }
        self.walked(Some(near), 2.0 * CLOSE * self.guess, f)
    }

    /// Walks on from a place that is known to be below, or else from the start.
    fn walked<E>(
        &self,
        known: Option<End>,
        first: f64,
        mut f: impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<f64, E> {
        let mut a = match known {
            Some(end) => end,
            None => End { x: self.from, f: f(self.from)? },
        };
        if a.f > 0.0 {
            return Ok(self.from);
        }
        let mut step = first;
        for _ in 0..MOST_STEPS {
            let x = (a.x + step).min(self.to);
            let b = End { x, f: f(x)? };
            if b.f > 0.0 {
                let mut failed = None;
                let root = bracketed(a, b, self.tolerance, |x| match f(x) {
                    Ok(y) => y,
                    Err(e) => {
                        failed = Some(e);
                        f64::NAN
                    }
                });
                return match (root, failed) {
                    // The lower end of the last bracket is certainly below.
                    (Ok(r), _) => Ok((r.x - r.error).max(a.x)),
                    (Err(_), Some(e)) => Err(e),
                    (Err(_), None) => Ok(a.x),
                };
            }
            if x >= self.to {
                return Ok(self.to);
            }
            a = b;
            step *= 1.3;
        }
        Ok(a.x)
    }
}
