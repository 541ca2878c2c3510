//! Figures on a page.

use super::drawing::{Drawing, Type, letters};
use super::panel::{FRAME, HEIGHT, Panel, WIDTH, draw};
use super::scene::{Scene, direction};
use super::study::Study;
use crate::report::project::{Direction, Frame};

/// Room for a colour bar with its numbers, px.
const BAR: f64 = 85.0;

/// The view of a face in every figure.
pub fn scene(study: &Study, from: Option<Direction>) -> Scene {
    let [x, y, width, height] = FRAME;
    Scene::new(study, from.unwrap_or_else(|| direction(study)), Frame { x, y, width, height })
}

/// The view of a face that leaves room for a colour bar.
pub fn beside_bar(study: &Study, from: Option<Direction>) -> Scene {
    let [x, y, width, height] = FRAME;
    let frame = Frame { x, y, width: width - BAR, height };
    Scene::new(study, from.unwrap_or_else(|| direction(study)), frame)
}

/// One figure as a file of its own.
pub fn single(study: &Study, scene: &Scene, panel: Panel, name: &str) -> String {
    let title = format!("{name}: {}", panel.file());
    draw(study, scene, panel).finish(WIDTH, HEIGHT, &title)
}

/// All figures that apply on one page, three a row.
pub fn page(study: &Study, scene: &Scene, name: &str) -> String {
    const ROW: usize = 3;
    const TOP: f64 = 34.0;
    let panels: Vec<Panel> = Panel::ALL.into_iter().filter(|p| p.applies(study)).collect();
    // A seventh figure would stand alone in its row.
    let panels = if panels.len() % ROW == 1 { &panels[..panels.len() - 1] } else { &panels[..] };
    let mut sheet = Drawing::default();
    sheet.text([FRAME[0], 24.0], name, Type { bold: true, ..letters(15.0) });
    for (k, panel) in panels.iter().enumerate() {
        let at = [WIDTH * (k % ROW) as f64, TOP + HEIGHT * (k / ROW) as f64];
        sheet.insert(&draw(study, scene, *panel), at);
    }
    let rows = panels.len().div_ceil(ROW);
    sheet.finish(WIDTH * ROW as f64, TOP + HEIGHT * rows as f64, name)
}
