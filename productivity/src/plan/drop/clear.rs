//! Moves of a roughing: along the pieces of a layer, between them and down into it.
//!
//! From the end of a piece the tool goes on to the one beside it through the layer, at a height that the dropped cutter says.
//! Elsewhere it goes up to a height above everything and comes down where the layer above has been cleared, then down a
//! ramp to and fro along the piece itself.

use super::course::Course;
use super::ground::Ground;
use super::pieces::{Piece, Place, RoughTask, raised, top_mm};
use super::trace;
use crate::plan::Linked;
use osculate_tools::Pose;
use osculate_tools::cl::Motion;

/// A piece is gone on to through the material where it begins within this many stepovers.
const BESIDE: f64 = 2.5;
/// Most times that a ramp goes to and fro on a piece.
const MOST_TURNS: f64 = 40.0;

/// Roughing under way.
pub(super) struct Clearing<'a> {
    ground: &'a Ground<'a>,
    task: &'a RoughTask<'a>,
    /// Height above everything.
    safe: f64,
    linked: Linked,
    cut: Vec<Piece>,
    /// Where the tool is: along the rows, across them, height.
    here: Option<[f64; 3]>,
    left_out_mm2: f64,
}

fn long(places: &[Place]) -> f64 {
    places.windows(2).map(|w| (w[1][0] - w[0][0]).abs()).sum()
}

/// The height of a piece at a position along its row.
fn height(places: &[Place], x: f64) -> f64 {
    places
        .windows(2)
        .filter(|w| (w[0][0] - x) * (w[1][0] - x) <= 0.0)
        .map(|w| {
            let d = w[1][0] - w[0][0];
            if d == 0.0 { w[0][1].max(w[1][1]) } else { w[0][1] + (w[1][1] - w[0][1]) * (x - w[0][0]) / d }
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

impl<'a> Clearing<'a> {
    pub(super) fn new(ground: &'a Ground<'a>, task: &'a RoughTask<'a>, top: f64) -> Self {
        let obstacles = top_mm(&task.links.obstacles, &task.axis);
        let safe = top.max(obstacles) + task.links.clearance_mm;
        let (linked, cut) = (Linked::default(), Vec::new());
        Self { ground, task, safe, linked, cut, here: None, left_out_mm2: 0.0 }
    }

    /// The path, the pieces in the order of cutting, and the area of those left out.
    pub(super) fn done(mut self) -> (Linked, Vec<Piece>, f64) {
        if let Some([x, y, _]) = self.here {
            self.go([x, y, self.safe], Motion::Rapid, None);
        }
        (self.linked, self.cut, self.left_out_mm2)
    }

    fn go(&mut self, at: [f64; 3], motion: Motion, pass: Option<u32>) {
        let pose = Pose { tip: self.ground.frame.point(at), axis: self.task.axis };
        self.linked.go(pose, motion, pass);
        self.here = Some(at);
    }

    const fn feed(&self) -> Motion {
        Motion::Feed(self.task.links.feed_mm_min)
    }

    const fn plunge(&self) -> Motion {
        Motion::Feed(self.task.links.plunge_mm_min)
    }

    /// Clears a layer between two heights.
    pub(super) fn layer(&mut self, pieces: Vec<Piece>, [ceiling, floor]: [f64; 2]) {
        let mut open: Vec<Option<Piece>> = pieces.into_iter().map(Some).collect();
        while let Some((k, turned)) = self.nearest(&open) {
            let Some(mut piece) = open[k].take() else { return };
            if turned {
                piece.places.reverse();
            }
            if !(self.beside(&piece, floor) || self.come_down(&piece, ceiling)) {
                self.left_out_mm2 += long(&piece.places) * self.task.sizes.stepover_mm;
                continue;
            }
            let pass = self.cut.len() as u32;
            for p in &piece.places {
                self.go([p[0], piece.y, p[1]], self.feed(), Some(pass));
            }
            self.cut.push(piece);
        }
    }

    /// The piece that begins nearest to the tool, and whether from its other end.
    fn nearest(&self, open: &[Option<Piece>]) -> Option<(usize, bool)> {
        let mut best: Option<(f64, usize, bool)> = None;
        for (k, piece) in open.iter().enumerate() {
            let Some(piece) = piece else { continue };
            for (turned, end) in [(false, piece.places.first()), (true, piece.places.last())] {
                let (Some(e), Some(h)) = (end, self.here) else { return Some((k, false)) };
                let d = (e[0] - h[0]).hypot(piece.y - h[1]);
                if best.is_none_or(|b| d < b.0) {
                    best = Some((d, k, turned));
                }
            }
        }
        best.map(|b| (b.1, b.2))
    }

    /// Goes on to the start of a piece through the layer, where it is near and something is below all the way.
    fn beside(&mut self, piece: &Piece, floor: f64) -> bool {
        let (Some([x, y, z]), Some(start)) = (self.here, piece.places.first().copied()) else { return false };
        let apart = (start[0] - x).hypot(piece.y - y);
        let s = &self.task.sizes;
        if z >= self.safe || apart > BESIDE * s.stepover_mm {
            return false;
        }
        if apart == 0.0 {
            return true;
        }
        let Some(course) = Course::through([[x, y], [start[0], piece.y]]) else { return false };
        let runs = trace::along(self.ground, &course);
        let [run] = runs.as_slice() else { return false };
        let places: Vec<Place> = run
            .points
            .iter()
            .map(|p| self.ground.frame.of(&p.pose.tip))
            .map(|t| [(t[0] - x).hypot(t[1] - y), t[2] + s.allowance_mm])
            .collect();
        let whole = places.first().is_some_and(|p| p[0] <= s.chord_mm)
            && places.last().is_some_and(|p| p[0] >= apart - s.chord_mm);
        if !whole {
            return false;
        }
        for p in raised(&places, floor) {
            let f = p[0] / apart;
            self.go([x + (start[0] - x) * f, y + (piece.y - y) * f, p[1]], self.feed(), None);
        }
        true
    }

    /// Comes down over the start of a piece and ramps into the layer along it; false, without a move, where it is too short.
    fn come_down(&mut self, piece: &Piece, ceiling: f64) -> bool {
        let (Some(start), Some(end)) = (piece.places.first().copied(), piece.places.last().copied()) else {
            return false;
        };
        let drop = ceiling - start[1];
        let whole = drop / self.task.sizes.ramp_rad.tan();
        // To and fro: twice the way for each turn, none longer than the piece.
        let most = (end[0] - start[0]).abs();
        let turns = (0.5 * whole / most).ceil().max(1.0);
        if drop > 0.0 && (turns.is_nan() || turns > MOST_TURNS) {
            return false;
        }
        if let Some([x, y, _]) = self.here {
            self.go([x, y, self.safe], Motion::Rapid, None);
        }
        self.go([start[0], piece.y, self.safe], Motion::Rapid, None);
        let above = (ceiling.max(start[1]) + self.task.links.approach_mm).min(self.safe);
        self.go([start[0], piece.y, above], Motion::Rapid, None);
        self.go([start[0], piece.y, ceiling.max(start[1])], self.plunge(), None);
        if drop > 0.0 {
            let way = 0.5 * whole / turns * (end[0] - start[0]).signum();
            for turn in 0..turns as usize {
                for there in [true, false] {
                    let from = 2.0 * turn as f64 + if there { 0.0 } else { 1.0 };
                    self.ramp(piece, [start[0], way], [from, 2.0 * turns], [ceiling, drop], there);
                }
            }
        }
        true
    }

    /// One way of a ramp, out or back: over the places of the piece on it, never below them.
    fn ramp(
        &mut self,
        piece: &Piece,
        [start, way]: [f64; 2],
        [from, of]: [f64; 2],
        [ceiling, drop]: [f64; 2],
        out: bool,
    ) {
        let part = |x: f64| if out { (x - start) / way } else { 1.0 - (x - start) / way };
        let mut stops: Vec<f64> =
            piece.places.iter().map(|p| part(p[0])).filter(|f| *f > 0.0 && *f < 1.0).collect();
        // Where the ramp meets the piece lies between two stops: fine ones keep the corner small.
        stops.extend((1..=8).map(|k| f64::from(k) / 8.0));
        stops.sort_by(f64::total_cmp);
        for f in stops {
            let x = start + way * if out { f } else { 1.0 - f };
            let z = (ceiling - drop * (from + f) / of).max(height(&piece.places, x));
            self.go([x, piece.y, z], self.plunge(), None);
        }
    }
}
