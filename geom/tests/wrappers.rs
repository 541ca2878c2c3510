//! A wrapper of a surface hands on every question, the provided methods' too: what it forgets the trait's default answers,
//! which knows less.

use osculate_geom::analytic::{Placed, Placement};
use osculate_geom::laws::{Reversed, Swapped};
use osculate_geom::{
    Axis, Domain, Flipped, Interval, Jet2, Jet3, Offset, Patch, Point3, Series, Side, Surface, Taylor, Unit3,
    Uv, Vec3, forward_surface, uv,
};
use std::sync::Arc;

/// Every answer differs from what the trait's default would make of the others.
#[derive(Clone, Copy)]
struct Probe;

const POINT: Point3 = Point3::new(0.0, 0.0, 50.0);
const THIRD: Vec3 = Vec3::new(0.0, 0.0, 7.0);

impl Surface for Probe {
    fn domain(&self) -> Domain {
        Domain { u: Interval::new(0.0, 2.0), v: Interval::new(0.0, 3.0) }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        let (point, none) = (Point3::new(at.u, at.v, at.u * at.v), Vec3::zeros());
        let (du, dv) = (Vec3::new(1.0, 0.0, at.v), Vec3::new(0.0, 1.0, at.u));
        Jet2 { uv: at, point, du, dv, duu: none, duv: Vec3::z(), dvv: none, side: Side::Along }
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let (u, v) = (Series::variable(Axis::U, at.u, order), Series::variable(Axis::V, at.v, order));
        Taylor { uv: at, side: Side::Along, coordinates: [u, v, u * v] }
    }
    fn jet3(&self, at: Uv) -> Jet3 {
        Jet3 { jet2: self.jet2(at), duuu: THIRD, duuv: THIRD, duvv: THIRD, dvvv: THIRD }
    }
    fn point(&self, _: Uv) -> Point3 {
        POINT
    }
    fn contains(&self, at: Uv) -> bool {
        at.u + at.v < 4.0
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        if axis == Axis::U { vec![0.0, 0.75, 2.0] } else { vec![0.0, 0.25, 3.0] }
    }
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        let lo = if axis == Axis::U { 0.5 } else { 0.125 };
        vec![Interval::new(lo, 1.0 + fixed / 8.0)]
    }
    fn turns(&self) -> Vec<Uv> {
        vec![uv(0.5, 0.25), uv(1.5, 1.0)]
    }
}

const AT: Uv = Uv { u: 0.5, v: 1.5 };

/// What is asked about where the surface is.
#[derive(Debug, PartialEq)]
struct Trims {
    domain: Domain,
    contains: [bool; 2],
    breaks: [Vec<f64>; 2],
    spans: [Vec<Interval>; 2],
    turns: Vec<Uv>,
}

fn trims(s: &dyn Surface) -> Trims {
    let axes = [Axis::U, Axis::V];
    Trims {
        domain: s.domain(),
        contains: [AT, uv(1.75, 2.5)].map(|at| s.contains(at)),
        breaks: axes.map(|a| s.breaks(a)),
        spans: axes.map(|a| s.spans(a, 1.5)),
        turns: s.turns(),
    }
}

/// What is asked about its points; sides apart.
fn shape(s: &dyn Surface) -> (Jet2, Jet3, Taylor, Point3) {
    (s.jet2(AT), s.jet3(AT), s.taylor(AT, 4), s.point(AT))
}

fn whole() -> Patch<Probe> {
    Patch { surface: Probe, domain: Probe.domain(), side: Side::Along }
}

#[test]
fn pointers_and_the_macro_hand_on_everything() {
    struct Seen(Probe);
    impl Surface for Seen {
        forward_surface!(all | s | s.0);
    }
    let all: [&dyn Surface; 4] = [&&Probe, &Box::new(Probe), &Arc::new(Probe), &Seen(Probe)];
    for s in all {
        assert_eq!(trims(s), trims(&Probe));
        assert_eq!(shape(s), shape(&Probe));
    }
}

#[test]
fn wrappers_that_keep_the_parameters_keep_where_the_surface_is() {
    let placement = Placement::new(Point3::new(1.0, 2.0, 3.0), Unit3::new_normalize(Vec3::x()), None);
    let placed = Placed { surface: Probe, placement };
    let offset = Offset::new(Probe, 0.125).unwrap();
    let all: [&dyn Surface; 3] = [&Flipped(Probe), &placed, &offset];
    for s in all {
        assert_eq!(trims(s), trims(&Probe));
    }
}

#[test]
fn the_other_side_has_the_same_points() {
    let (jet2, jet3, taylor, point) = shape(&Probe);
    let against = (
        Jet2 { side: Side::Against, ..jet2 },
        Jet3 { jet2: Jet2 { side: Side::Against, ..jet2 }, ..jet3 },
        Taylor { side: Side::Against, ..taylor },
        point,
    );
    assert_eq!(shape(&Flipped(Probe)), against);
    assert_eq!(shape(&Patch { side: Side::Against, ..whole() }), against);
    assert_eq!(shape(&whole()), shape(&Probe));
}

#[test]
fn a_placed_surface_moves_what_it_is_told() {
    let placement = Placement::new(Point3::new(1.0, 2.0, 3.0), Unit3::new_normalize(Vec3::x()), None);
    let s = Placed { surface: Probe, placement };
    assert_eq!(s.point(AT), placement.point(&POINT));
    assert_eq!(s.jet3(AT).duuv, placement.vector(&THIRD));
}

#[test]
fn a_patch_cuts_spans_and_turns_to_its_rectangle() {
    assert_eq!(trims(&whole()).spans, trims(&Probe).spans);
    let domain = Domain { u: Interval::new(0.25, 0.75), v: Interval::new(0.5, 1.25) };
    let s = Patch { domain, ..whole() };
    assert_eq!(s.breaks(Axis::V), [0.5, 1.25]);
    assert_eq!(s.spans(Axis::U, 1.0), [Interval::new(0.5, 0.75)]);
    assert_eq!(s.spans(Axis::V, 0.5), [Interval::new(0.5, 1.0625)]);
    assert!(s.spans(Axis::U, 2.0).is_empty());
    // The ends of the spans on all four sides; of the surface's own turns none lies inside.
    let sides =
        [(0.5, 0.5), (0.75, 0.5), (0.75, 1.25), (0.5, 1.25), (0.25, 0.5), (0.25, 1.03125), (0.75, 1.09375)];
    assert_eq!(s.turns(), sides.map(|(u, v)| uv(u, v)));
    assert!(whole().turns().contains(&uv(1.5, 1.0)));
}

#[test]
fn other_parameters_for_the_same_places() {
    let (swapped, back) = (Swapped(Probe), Reversed { surface: Probe, axis: Axis::U });
    assert_eq!(swapped.spans(Axis::V, 1.5), Probe.spans(Axis::U, 1.5));
    assert_eq!(swapped.turns(), [uv(0.25, 0.5), uv(1.0, 1.5)]);
    assert_eq!(back.spans(Axis::U, 1.0), [Interval::new(2.0 - 1.125, 1.5)]);
    assert_eq!(back.spans(Axis::V, 1.5), Probe.spans(Axis::V, 0.5));
    assert_eq!(back.turns(), [uv(1.5, 0.25), uv(0.5, 1.0)]);
    assert_eq!((swapped.point(AT), back.point(AT)), (POINT, POINT));
}
