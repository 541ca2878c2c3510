//! The best posture of a tool over a face: strip width with the direction of feed, area per minute, lead, and how far the
//! claim of the indicatrix of conformity is off [R97, eq. 63], as a picture and as arrays.
//!
//! Every node of the grid paints the cell around it, in pieces, so that cells follow the face and its trims.

use super::cells;
use super::drawing::{Anchor, Drawing, Type, letters, pen};
use super::panel::{self, BAR_AT, BAR_LENGTH, FRAME, HEIGHT, WIDTH};
use super::scene::Scene;
use super::study::Study;
use crate::report::legend::{KINDS, Rgb, Scale, UNKNOWN, hex};
use osculate_geom::{Surface, Uv, Vec3};
use osculate_productivity::field::{Field, best_postures};
use osculate_productivity::optimum::{Limits, Optimum, OptimumError};
use osculate_surfaces::TrimmedSurface;
use osculate_tools::Cutter;
use serde::Serialize;

/// Pieces of a cell along each parameter.
const PIECES: usize = 4;
/// Most strokes across the grid.
const STROKES: usize = 12;
/// Rows of a list of tools, its coloured boxes, and how far left of a bar it stands, px.
const ROW: f64 = 15.0;
const SWATCH: f64 = 9.0;
const INDENT: f64 = 30.0;
/// The figure that shows the best tool of several in place of conformity.
const TOOL: &str = "d";
/// The colour of a tool; a ninth has the first's.
const fn tool_colour(tool: usize) -> Rgb {
    KINDS[tool % KINDS.len()]
}

/// The postures of a face.
#[derive(Clone)]
pub struct Postures<'a> {
    field: Field,
    face: &'a TrimmedSurface,
    /// Of a list of tools the best one.
    tools: Option<Tools>,
}

/// Which of several tools is the best.
#[derive(Clone)]
struct Tools {
    /// In words.
    names: Vec<String>,
    /// At every node.
    best: Vec<Option<usize>>,
}

/// The same as arrays, by node: v grows first, then u. `null` outside the face and where the tool has no posture.
#[derive(Debug, Serialize)]
pub struct Arrays {
    /// Nodes along u and along v.
    count: [usize; 2],
    uv: Vec<[f64; 2]>,
    point_mm: Vec<[f64; 3]>,
    /// Strip width.
    width_mm: Vec<f64>,
    area_mm2_min: Vec<f64>,
    /// Feed from S_u towards S_v.
    direction_deg: Vec<f64>,
    lead_deg: Vec<f64>,
    tilt_deg: Vec<f64>,
    /// Height above contact.
    lift_mm: Vec<f64>,
    undercut_mm: Vec<f64>,
    /// Smaller eigenvalue of the relative form.
    relative_min_per_mm: Vec<Option<f64>>,
    /// Between the direction that the indicatrix of conformity claims and that of the widest strip.
    conformity_claim_off_deg: Vec<Option<f64>>,
    /// The tool by its place in the list, from 0, where there is a list.
    #[serde(skip_serializing_if = "Option::is_none")]
    tool: Option<Vec<Option<usize>>>,
}

/// One quantity of the page.
struct Shown {
    letter: &'static str,
    name: &'static str,
    unit: &'static str,
    values: Vec<f64>,
}

impl<'a> Postures<'a> {
    /// The best postures at `nodes` by `nodes` places.
    ///
    /// # Errors
    /// [`OptimumError`] of limits that are none.
    pub fn of(
        face: &'a TrimmedSurface,
        cutter: &Cutter,
        limits: &Limits,
        nodes: usize,
    ) -> Result<Self, OptimumError> {
        Ok(Self { field: best_postures(face, &[*cutter], limits, [nodes; 2])?, face, tools: None })
    }

    /// Of tools' postures at the same nodes those of the greatest area per minute; None of an empty list.
    pub fn best_of(all: &[Self], names: Vec<String>) -> Option<Self> {
        let rates: Vec<Vec<f64>> = all.iter().map(|p| p.field.productivity_mm2_min()).collect();
        let mut best = all.first()?.clone();
        let found = (0..best.field.nodes.len())
            .map(|k| {
                let posed = (0..all.len()).filter(|t| rates[*t][k].is_finite());
                // Of equals the first.
                let tool = posed.min_by(|a, b| rates[*b][k].total_cmp(&rates[*a][k]))?;
                best.field.nodes[k] = all[tool].field.nodes[k].clone();
                Some(tool)
            })
            .collect();
        best.tools = Some(Tools { names, best: found });
        Some(best)
    }

    /// Share of the nodes on the face at which each of the tools is the best, per cent.
    pub fn shares_percent(&self) -> Vec<f64> {
        let on_face = self.field.nodes.iter().filter(|n| n.best.is_some()).count().max(1);
        let share = |tools: &Tools, t: usize| {
            100.0 * tools.best.iter().filter(|k| **k == Some(t)).count() as f64 / on_face as f64
        };
        self.tools.as_ref().map_or_else(Vec::new, |all| (0..all.names.len()).map(|t| share(all, t)).collect())
    }

    /// The arrays.
    pub fn arrays(&self) -> Arrays {
        let f = &self.field;
        let degrees = |of: fn(&Optimum) -> f64| f.values(|o| of(o).to_degrees());
        let point = |at: Uv| {
            let p = self.face.point(at);
            [p.x, p.y, p.z]
        };
        Arrays {
            count: f.count,
            uv: f.nodes.iter().map(|n| [n.at.u, n.at.v]).collect(),
            point_mm: f.nodes.iter().map(|n| point(n.at)).collect(),
            width_mm: f.widths_mm(),
            area_mm2_min: f.productivity_mm2_min(),
            direction_deg: degrees(|o| o.direction_rad),
            lead_deg: degrees(|o| o.lean.lead_rad),
            tilt_deg: degrees(|o| o.lean.tilt_rad),
            lift_mm: f.values(|o| o.lift_mm),
            undercut_mm: f.values(|o| o.undercut_mm),
            relative_min_per_mm: f.nodes.iter().map(|n| n.relative_min_per_mm).collect(),
            conformity_claim_off_deg: f.nodes.iter().map(|n| n.claim_off_rad.map(f64::to_degrees)).collect(),
            tool: self.tools.as_ref().map(|t| t.best.clone()),
        }
    }

    /// The four figures on a page.
    pub fn page(&self, study: &Study, scene: &Scene, name: &str) -> String {
        const TOP: f64 = 34.0;
        let f = &self.field;
        let off = f.nodes.iter().map(|n| n.claim_off_rad.map_or(f64::NAN, f64::to_degrees)).collect();
        let leads = f.leads_rad().into_iter().map(f64::to_degrees).collect();
        let last = match &self.tools {
            Some(tools) => {
                let numbers = tools.best.iter().map(|t| t.map_or(f64::NAN, |t| t as f64)).collect();
                (TOOL, "the best tool", "", numbers)
            }
            None => ("d", "conformity: how far its claim is off the widest direction", "\u{b0}", off),
        };
        let all = [
            ("a", "strip width, with the direction of feed", "mm", f.widths_mm()),
            ("b", "area per minute", "mm\u{b2}/min", f.productivity_mm2_min()),
            ("c", "lead", "\u{b0}", leads),
            last,
        ]
        .map(|(letter, name, unit, values)| Shown { letter, name, unit, values });
        let mut sheet = Drawing::default();
        sheet.text([FRAME[0], 24.0], name, Type { bold: true, ..letters(15.0) });
        for (k, shown) in all.iter().enumerate() {
            let at = [WIDTH * (k % 2) as f64, TOP + HEIGHT * (k / 2) as f64];
            sheet.insert(&self.figure(study, scene, shown), at);
        }
        sheet.finish(2.0 * WIDTH, TOP + 2.0 * HEIGHT, &format!("{name}: postures"))
    }

    fn figure(&self, study: &Study, scene: &Scene, shown: &Shown) -> Drawing {
        let mut d = Drawing::default();
        let tools = self.tools.as_ref().filter(|_| shown.letter == TOOL);
        let scale = Scale::sequential(shown.name, shown.unit, shown.values.iter().copied());
        self.paint(&mut d, scene, |k| match (tools, &scale) {
            (Some(tools), _) => tools.best[k].map_or(UNKNOWN, tool_colour),
            (None, Some(s)) => s.colour(shown.values[k]),
            (None, None) => UNKNOWN,
        });
        let ink = pen("#222", 1.0);
        d.lines(&panel::seen(scene, &study.silhouette(&scene.toward())), pen("#222", 0.8));
        d.lines(&panel::seen(scene, &study.borders), ink);
        if shown.letter == "a" {
            let strokes = self.strokes(scene);
            d.lines(&strokes, pen("#fff", 2.6));
            d.lines(&strokes, ink);
        }
        panel::ornaments(&mut d, study, scene);
        if let Some(tools) = tools {
            for (t, name) in tools.names.iter().enumerate() {
                let y = BAR_AT[1] + ROW * t as f64;
                let (left, right) = (BAR_AT[0] - INDENT, BAR_AT[0] - INDENT + SWATCH);
                let box_of = [[left, y], [right, y], [right, y + SWATCH], [left, y + SWATCH]];
                d.area(&box_of, &hex(tool_colour(t)));
                d.text([right + 5.0, y + SWATCH - 1.0], name, letters(9.5));
            }
        } else if let Some(s) = &scale {
            d.fragment(&s.bar(BAR_LENGTH), BAR_AT, 9.5);
            let middle = Type { anchor: Anchor::Middle, ..letters(9.5) };
            d.text([BAR_AT[0] + 24.0, BAR_AT[1] + BAR_LENGTH + 16.0], shown.unit, middle);
        }
        let top = FRAME[1] + FRAME[3] + 30.0;
        d.text([FRAME[0], top], shown.letter, Type { bold: true, ..letters(13.0) });
        d.text([FRAME[0] + 16.0, top], shown.name, letters(13.0));
        d
    }

    /// The cells of all nodes.
    fn paint(&self, d: &mut Drawing, scene: &Scene, colour: impl Fn(usize) -> Rgb) {
        let [n, m] = self.field.count.map(|c| c * PIECES);
        let domain = self.face.domain();
        let at = |i: f64, j: f64| domain.at(i / n as f64, j / m as f64);
        cells::paint(d, scene, (self.face, [n, m]), &at, |i, j| {
            colour(i / PIECES * self.field.count[1] + j / PIECES)
        });
    }

    /// Strokes along the feed at some of the nodes that are seen.
    fn strokes(&self, scene: &Scene) -> Vec<Vec<[f64; 2]>> {
        const HALF_PX: f64 = 7.0;
        let [n, m] = self.field.count;
        let every = [n, m].map(|c| c.div_ceil(STROKES).max(1));
        let mut out = Vec::new();
        for (k, node) in self.field.nodes.iter().enumerate() {
            let on = (k / m) % every[0] == every[0] / 2 && (k % m) % every[1] == every[1] / 2;
            let Some(Ok(best)) = node.best.as_ref().filter(|_| on) else { continue };
            let jet = self.face.jet2(node.at);
            let Ok(forms) = jet.forms() else { continue };
            if !scene.sees(&jet.point) {
                continue;
            }
            let (s, c) = best.direction_rad.sin_cos();
            let feed: Vec3 =
                forms.frame[0].into_inner() * c + forms.frame[1].into_inner() * (s * jet.side.sign());
            let way = feed * (HALF_PX / scene.camera.scale);
            out.push(vec![scene.place(&(jet.point - way)), scene.place(&(jet.point + way))]);
        }
        out
    }
}
