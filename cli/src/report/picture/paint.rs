//! Painting facets from far to near as few SVG paths.

use super::super::legend::Rgb;
use super::super::project::covered;
use std::cmp::Ordering;
use std::collections::HashMap;
use std::fmt::Write;

/// Something to paint: corners in the picture, how near, which colour.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct Facet {
    /// In picture coordinates.
    pub corners: [[f64; 3]; 3],
    /// With its light.
    pub colour: Rgb,
}

/// Greater is nearer to the viewer.
pub fn nearness(facet: &Facet) -> f64 {
    facet.corners.iter().map(|c| c[2]).sum()
}

/// `colour` at the brightness `light`, in steps that the eye hardly sees: neighbours with one colour share a path.
pub fn shaded(colour: Rgb, light: f64) -> Rgb {
    colour.map(|c| ((f64::from(c) * light.min(1.0) / 6.0).round() * 6.0).min(255.0) as u8)
}

/// Paints facets given from far to near. A facet joins the last path of its colour where nothing painted since covers
/// one of its pixels: the picture is that of strict order at half the bytes.
pub fn paint(facets: &[Facet], width: usize, height: usize) -> String {
    let mut last_path = vec![0_usize; width * height];
    let mut latest: HashMap<Rgb, usize> = HashMap::new();
    let mut paths: Vec<(Rgb, String)> = vec![([0; 3], String::new())];
    for facet in facets {
        let [a, b, c] = facet.corners.map(|p| [(2.0 * p[0]).round() as i64, (2.0 * p[1]).round() as i64]);
        // One sense of turning for all, or two that overlap in one path would cancel each other.
        let (b, c) = match ((b[0] - a[0]) * (c[1] - a[1])).cmp(&((c[0] - a[0]) * (b[1] - a[1]))) {
            Ordering::Greater => (b, c),
            Ordering::Less => (c, b),
            Ordering::Equal => continue,
        };
        let pixels: Vec<usize> = covered(facet.corners, width, height).map(|p| p.0).collect();
        let under = pixels.iter().map(|&p| last_path[p]).max().unwrap_or(0);
        let at = latest.get(&facet.colour).copied().filter(|&at| at >= under).unwrap_or(paths.len());
        if at == paths.len() {
            paths.push((facet.colour, String::new()));
            latest.insert(facet.colour, at);
        }
        pixels.iter().for_each(|&p| last_path[p] = at);
        let d = &mut paths[at].1;
        let _ = write!(d, "M{} {}", a[0], a[1]);
        step(d, 'l', a, b);
        step(d, ' ', b, c);
        d.push('z');
    }
    let mut out = String::new();
    for ([r, g, b], d) in &paths[1..] {
        let _ = write!(out, "<path color=\"#{r:02x}{g:02x}{b:02x}\" d=\"{d}\"/>");
    }
    out
}

/// A relative step, without the space where a minus separates already.
pub fn step(out: &mut String, command: char, from: [i64; 2], to: [i64; 2]) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    if command != ' ' || dx >= 0 {
        out.push(command);
    }
    let _ = write!(out, "{dx}");
    if dy >= 0 {
        out.push(' ');
    }
    let _ = write!(out, "{dy}");
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = [200, 0, 0];
    const BLUE: Rgb = [0, 0, 200];

    fn facet(x: f64, colour: Rgb) -> Facet {
        Facet { corners: [[x, 0.0, 0.0], [x + 10.0, 0.0, 0.0], [x, 10.0, 0.0]], colour }
    }

    fn colours(svg: &str) -> Vec<&str> {
        svg.split("color=\"").skip(1).map(|p| &p[..7]).collect()
    }

    #[test]
    fn facets_that_do_not_overlap_share_the_path_of_their_colour() {
        let out = paint(&[facet(0.0, RED), facet(20.0, BLUE), facet(40.0, RED)], 100, 20);
        assert_eq!(colours(&out), ["#c80000", "#0000c8"]);
    }

    #[test]
    fn what_comes_later_stays_above_what_it_covers() {
        let out = paint(&[facet(0.0, RED), facet(2.0, BLUE), facet(4.0, RED)], 100, 20);
        assert_eq!(colours(&out), ["#c80000", "#0000c8", "#c80000"]);
    }

    /// Filled by the winding rule, two overlapping triangles of one path would otherwise leave a hole.
    #[test]
    fn all_triangles_turn_the_same_way() {
        let back = Facet { corners: [[0.0; 3], [0.0, 10.0, 0.0], [10.0, 0.0, 0.0]], colour: RED };
        let out = paint(&[facet(0.0, RED), back], 100, 20);
        assert_eq!(out, "<path color=\"#c80000\" d=\"M0 0l20 0-20 20zM0 0l20 0-20 20z\"/>");
    }
}
