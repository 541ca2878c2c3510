//! Temporary: what a search found, for looking at.
use super::field::AxisField;
use super::lattice::Lattice;
use super::search::{Asked, Possible, Search};
use super::rim::Rim;
use crate::plan::extended::Extended;
use crate::width::planar_width_mm;
use osculate_geom::{Unit3, Surface};
use osculate_tools::reach::Place;
use osculate_tools::strip::{Demand, exact_to};
use osculate_tools::{Contact, FeedLine, Lean};
use std::io::Write;

pub(super) fn knob(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

pub(super) fn dump(
    face: &Extended<'_>,
    asked: &Asked<'_>,
    lattice: &Lattice,
    possible: &[Possible],
    (axes, field, before): (&[Unit3], &AxisField, &AxisField),
    search: &Search<'_>,
    places: &[Option<Place>],
) {
    let Ok(path) = std::env::var("AXIS_DUMP") else { return };
    // Direction by the first frame: along u or v.
    let dir = lattice.nodes.iter().find_map(|n| { let f = n.frame.as_ref()?; let j = face.jet2(n.at); Some(if f.1.tangent.dot(&j.du).abs()/j.du.norm() > 0.999 {"u"} else {"v"}) }).unwrap_or("x");
    let along = if dir == "u" { osculate_geom::Axis::U } else { osculate_geom::Axis::V };
    let mut out = std::fs::File::create(format!("{path}.{dir}")).unwrap();
    let feed = FeedLine::Iso(along);
    let h = asked.scallop_mm;
    let n1 = lattice.spline.bases[1].count();
    for (k, node) in lattice.nodes.iter().enumerate() {
        let Some((forms, frame)) = &node.frame else { continue };
        if node.area_mm2 <= 0.0 { continue; }
        let exact_w = |axis: &Unit3| {
            let lean = Lean::of(axis, frame);
            Contact::new(face, node.at, asked.cutter, feed, lean).ok().and_then(|c| exact_to(&c, h, Demand { deepest_mm: f64::INFINITY, relative: 1e-3 }).ok()).map_or((0.0, 0.0), |s| (s.width_mm, s.undercut_mm))
        };
        let closed = |axis: &Unit3| planar_width_mm(forms, frame, (asked.cutter, Lean::of(axis, frame)), h);
        let own = axes[k];
        let set = field.at(node.at).0;
        // Best over rim ways and directions.
        let mut best = (0.0, own);
        let rim: Vec<Unit3> = possible[k].rim().iter().flat_map(|r: &&Rim| r.axes(0.0).map(|x| x.1)).collect();
        let far = asked.directions.all().iter().enumerate().filter(|(i, a)| possible[k].depths().get(*i).is_some_and(|d| *d > 0) && possible[k].rim().is_none_or(|r: &Rim| r.spot(a).is_none())).map(|(_, a)| *a);
        for a in rim.iter().copied().chain(far) {
            let w = closed(&a);
            if w > best.0 { best = (w, a); }
        }
        let mut best_exact = (0.0, own);
        for a in &rim {
            let w = exact_w(a).0;
            if w > best_exact.0 { best_exact = (w, *a); }
        }
        let l = |a: &Unit3| { let l = Lean::of(a, frame); format!("{:.3} {:.0}", l.lead_rad.to_degrees(), l.tilt_rad.to_degrees()) };
        let turn = |a: &Unit3| {
            let mut worst = 0.0f64;
            for e in &lattice.of_node[k] { let e = &lattice.edges[*e as usize]; let o = if e.ends[0]==k {e.ends[1]} else {e.ends[0]}; worst = worst.max(axes[o].angle(a).to_degrees()/e.length_mm.max(1e-9)); }
            worst
        };
        let (we, ue) = exact_w(&own);
        let ws = exact_w(&set);
        let spl = before.at(node.at).0;
        let clear = places[k].as_ref().is_some_and(|p| (asked.clear)(p, &set));
        let tab = search.width_mm(k, &own);
        let kk = [forms.normal_curvature(&frame.tangent), forms.normal_curvature(&frame.left)];
        if std::env::var("K_DEBUG").ok() == Some(format!("{},{}", k / n1, k % n1)) {
            let mut tries = vec![("own".to_owned(), own)];
            if let Some(r) = possible[k].rim() { for way in 0..16 { tries.push((format!("way {way} least {:.3}", r.least_rad(way).to_degrees()), r.axis(way, r.least_rad(way) + 0.002))); } }
            for e in &lattice.of_node[k] { let e = &lattice.edges[*e as usize]; let o = if e.ends[0]==k {e.ends[1]} else {e.ends[0]}; eprintln!("T: DEBUG node {}: n {:?} m {:?} a {:?} b {:?} stood {} area {} point {:?} {:?}", o, node.normal, lattice.nodes[o].normal, own, axes[o], lattice.nodes[o].stood, lattice.nodes[o].area_mm2, node.point, lattice.nodes[o].point); }
            for (what, a) in tries {
                let edges: Vec<String> = lattice.of_node[k].iter().map(|e| { let e = &lattice.edges[*e as usize]; let o = if e.ends[0]==k {e.ends[1]} else {e.ends[0]}; format!("{:.2e} (swing {:.2e}, along {:.2} len {:.2})", if e.ends[0]==k {search.edge_min(e, &a, &axes[o])} else {search.edge_min(e, &axes[o], &a)}, if e.ends[0]==k {search.swing_min(e, &a, &axes[o])} else {search.swing_min(e, &axes[o], &a)}, e.along, e.length_mm) }).collect();
                eprintln!("T: DEBUG {what} lean {} node {:.3e} depth {:.2} w {:.3} edges {:?}", l(&a), search.node_min(k, &a), search.depth(k, &a), search.width_mm(k, &a), edges);
            }
        }
        writeln!(out, "{} {} {:.4} {:.4} area {:.3} | own {} w {:.3} ({tab:.3}) spl ex {:.3} ex {:.3} und {:.4} depth {:.2} | set {} w {:.3} ex {:.3} {} | best {} w {:.3} ex {:.3} | bestex {} ex {:.3} | k {:.5} {:.5} turn {:.2}",
            k / n1, k % n1, node.at.u, node.at.v, node.area_mm2, l(&own), closed(&own), exact_w(&spl).0, we, ue, search.depth(k, &own), l(&set), closed(&set), ws.0, clear, l(&best.1), best.0, exact_w(&best.1).0, l(&best_exact.1), best_exact.0, kk[0], kk[1], turn(&own)).unwrap();
    }
}
