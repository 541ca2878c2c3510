//! Every closed form against the exact strip or mark over many contacts: largest deviation, where, and observed order.

use osculate_geom::analytic::{Cylinder, Ellipsoid, Torus};
use osculate_geom::{Axis, Flipped, Interval, Point3, Surface, Uv, uv};
use osculate_productivity::closed_form::{
    DomainError, Section, chord_38, five_axis_flat, five_axis_refined, leading_order, leading_order_swept,
    linear_40, three_axis_flat, three_axis_toroidal, two_axis_ball, width_37,
};
use osculate_surfaces::{Net, NurbsSurface};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};

/// Tolerances over the tool's radius.
pub const HEIGHTS: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// Contacts of each kind.
const CASES: usize = 160;

/// A contact's part, place, tool and feed.
struct Case {
    part: Box<dyn Surface>,
    at: Uv,
    cutter: Cutter,
    feed: FeedLine,
    lean: Lean,
    words: String,
}

/// A closed form with what it applies to.
pub struct Row {
    pub name: &'static str,
    pub source: &'static str,
    pub domain: &'static str,
    pub order: &'static str,
    /// Largest relative deviation at each of [`HEIGHTS`], and where.
    pub worst: [(f64, String); 3],
    pub contacts: usize,
}

impl Row {
    /// Power of h with which the largest deviation falls from the largest to the smallest tolerance.
    pub fn observed(&self) -> f64 {
        (self.worst[0].0 / self.worst[2].0.max(1e-300)).log10() / 2.0
    }
}

fn spread(k: usize, step: usize) -> f64 {
    const STEPS: [f64; 4] =
        [0.856_674_883_854_502_9, 0.733_891_856_627_125_9, 0.628_706_721_037_735_2, 0.538_597_257_2];
    (0.5 + (k + 1) as f64 * STEPS[step % 4]).fract()
}

fn ball(radius: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * radius, length_mm: 100.0 }).expect("a good ball")
}

fn toroidal(radius: f64, corner_radius_mm: f64) -> Cutter {
    let spec = CutterSpec::Toroidal { diameter_mm: 2.0 * radius, corner_radius_mm, length_mm: 100.0 };
    Cutter::try_from(spec).expect("a good cutter")
}

/// A bicubic patch of 100 x 100 mm with its own hills.
fn nurbs(k: usize) -> NurbsSurface {
    let poles = (0..16)
        .map(|i| {
            let z = 12.0 * (spread(16 * k + i, i) - 0.5);
            Point3::new(100.0 / 3.0 * f64::from(i as u32 / 4), 100.0 / 3.0 * f64::from(i as u32 % 4), z)
        })
        .collect();
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    NurbsSurface::new([3, 3], [knots.clone(), knots], Net { count: [4, 4], points: poles, weights: None })
        .expect("a good net")
}

fn torus(k: usize) -> (Box<dyn Surface>, String) {
    let (major, minor) = (150.0 + 150.0 * spread(k, 0), 40.0 + 50.0 * spread(k, 1));
    let torus = Torus::new(major, minor).expect("a good torus");
    let name =
        format!("torus {major:.0}/{minor:.0} mm, {}", if k.is_multiple_of(2) { "outside" } else { "inside" });
    (if k.is_multiple_of(2) { Box::new(torus) } else { Box::new(Flipped(torus)) }, name)
}

/// Along parallels of tori: lines of curvature.
fn along_parallels(k: usize, cutter: Cutter, lean: Lean) -> Case {
    let (part, name) = torus(k);
    let at = uv(0.0, std::f64::consts::TAU * spread(k, 2));
    let words = format!("{name}, v = {:.3}", at.v);
    Case { part, at, cutter, feed: FeedLine::Iso(Axis::U), lean, words }
}

/// Any direction on ellipsoids and NURBS patches.
fn anywhere(k: usize, cutter: Cutter, lean: Lean) -> Case {
    let angle = std::f64::consts::TAU * spread(k, 3);
    let feed = FeedLine::Angle(angle);
    let (fu, fv) = (spread(k, 0), 0.2 + 0.6 * spread(k, 1));
    if k.is_multiple_of(2) {
        let part = Ellipsoid::new([90.0, 60.0, 40.0]).expect("a good ellipsoid");
        let at = part.domain().at(fu, fv);
        let words = format!(
            "ellipsoid 90/60/40 mm, u = {:.3}, v = {:.3}, feed {:.0} deg",
            at.u,
            at.v,
            angle.to_degrees()
        );
        Case { part: Box::new(part), at, cutter, feed, lean, words }
    } else {
        let at = uv(0.2 + 0.6 * fu, fv);
        let words =
            format!("NURBS patch {k}, u = {:.3}, v = {:.3}, feed {:.0} deg", at.u, at.v, angle.to_degrees());
        Case { part: Box::new(nurbs(k)), at, cutter, feed, lean, words }
    }
}

type Form = fn(&Contact<'_>, f64) -> Result<f64, DomainError>;
/// A form of two arcs.
type Planar = fn(Section) -> Result<f64, DomainError>;

fn across(c: &Contact<'_>, h: f64) -> Section {
    let part_per_mm = c.forms.normal_curvature(&c.frame.left);
    Section { part_per_mm, tool_per_mm: c.relative().along(&c.frame.left) - part_per_mm, scallop_mm: h }
}

fn along(c: &Contact<'_>, h: f64) -> Section {
    let part_per_mm = c.forms.normal_curvature(&c.frame.tangent);
    Section { part_per_mm, tool_per_mm: c.relative().along(&c.frame.tangent) - part_per_mm, scallop_mm: h }
}

fn width(c: &Contact<'_>, h: f64) -> Option<f64> {
    strip::exact(c, h).ok().filter(|s| s.at_edge == [false; 2]).map(|s| s.width_mm)
}

fn mark(c: &Contact<'_>, h: f64) -> Option<f64> {
    strip::mark(c, h).ok().filter(|m| m.at_edge == [false; 2]).map(|m| m.length_mm())
}

/// The outer zeros of the posture that dips by just h: what the 5C formula means.
fn two_contacts(c: &Contact<'_>, h: f64) -> Option<f64> {
    let five = five(c, h).ok()?;
    let with = |lead_rad: f64| {
        Contact::new(c.surface, c.at, c.cutter, FeedLine::Iso(Axis::U), Lean { lead_rad, tilt_rad: 0.0 }).ok()
    };
    let dip = |lead: f64| Some(strip::exact(&with(lead)?, 1e-9).ok()?.undercut_mm / h - 1.0);
    // Secants on the lead.
    let (mut a, mut b) = (0.97 * five.lead_rad, five.lead_rad);
    let (mut fa, mut fb) = (dip(a)?, dip(b)?);
    for _ in 0..12 {
        if fb.abs() < 1e-9 || fb == fa {
            break;
        }
        let next = b - fb * (b - a) / (fb - fa);
        (a, fa) = (b, fb);
        (b, fb) = (next, dip(next)?);
    }
    Some(strip::exact(&with(b)?, 1e-12).ok()?.width_mm)
}

fn five(c: &Contact<'_>, h: f64) -> Result<osculate_productivity::closed_form::FiveAxis, DomainError> {
    let [kf, ky] = [&c.frame.tangent, &c.frame.left].map(|d| c.forms.normal_curvature(d));
    five_axis_flat(c.cutter.core_mm(), c.cutter.corner_mm(), kf, ky, h)
}

fn row(
    [name, source, domain, order]: [&'static str; 4],
    case: impl Fn(usize) -> Case,
    exact: impl Fn(&Contact<'_>, f64) -> Option<f64>,
    form: impl Fn(&Contact<'_>, f64) -> Result<f64, DomainError>,
) -> Row {
    let mut worst: [(f64, String); 3] = Default::default();
    let mut contacts = 0;
    for k in 0..CASES {
        let case = case(k);
        let Ok(contact) = Contact::new(&*case.part, case.at, &case.cutter, case.feed, case.lean) else {
            continue;
        };
        // Where part and tool nearly osculate the higher orders take over long before h/R = 1e-2.
        let least = if source.starts_with("M86") { 0.1 / case.cutter.radius_mm() } else { 0.0 };
        if contact.relative().min <= least && source != "M86 5C" {
            continue;
        }
        let mut counted = false;
        for (worst, height) in worst.iter_mut().zip(HEIGHTS) {
            let h = height * case.cutter.radius_mm();
            let (Some(want), Ok(got)) = (exact(&contact, h), form(&contact, h)) else { continue };
            counted = true;
            let off = (got / want - 1.0).abs();
            if off > worst.0 {
                *worst = (off, format!("{}, R = {:.2} mm", case.words, case.cutter.radius_mm()));
            }
        }
        contacts += usize::from(counted);
    }
    Row { name, source, domain, order, worst, contacts }
}

/// The whole table.
pub fn all() -> Vec<Row> {
    let balls = |k: usize| along_parallels(k, ball(4.0 + 8.0 * spread(k, 3)), Lean::default());
    let bulls = |k: usize| {
        let lean = Lean { lead_rad: 0.15 + 0.35 * spread(k, 2), tilt_rad: 1.2 * spread(k + 7, 1) - 0.6 };
        anywhere(k, toroidal(5.0, 1.0 + 3.0 * spread(k + 3, 0)), lean)
    };
    let any_ball = |k: usize| anywhere(k, ball(4.0 + 4.0 * spread(k + 5, 2)), Lean::default());
    let flats = |k: usize| {
        let lean = Lean { lead_rad: 0.2 + 0.4 * spread(k, 3), tilt_rad: 0.0 };
        along_parallels(k, toroidal(10.0, 0.0), lean)
    };
    let corners = |k: usize| {
        let lean = Lean { lead_rad: 0.2 + 0.4 * spread(k, 3), tilt_rad: 0.0 };
        along_parallels(k, toroidal(10.0, 1.0 + 3.0 * spread(k + 1, 1)), lean)
    };
    let straight = |k: usize| {
        let radius = 30.0 + 100.0 * spread(k, 0);
        let part = Cylinder::new(radius, Interval::new(-80.0, 80.0)).expect("a good cylinder");
        let cutter = ball(3.0 + 6.0 * spread(k, 1));
        let words = format!("around a cylinder of {radius:.0} mm");
        Case {
            part: Box::new(part),
            at: uv(0.3, 0.0),
            cutter,
            feed: FeedLine::Iso(Axis::U),
            lean: Lean::default(),
            words,
        }
    };
    let grooves = |corner: f64| {
        move |k: usize| {
            let (major, minor) = (170.0 + 80.0 * spread(k, 0), 50.0 + 30.0 * spread(k, 1));
            let part = Flipped(Torus::new(major, minor).expect("a good torus"));
            let words = format!("groove {major:.0}/{minor:.0} mm");
            let lean = Lean { lead_rad: 0.1, tilt_rad: 0.0 };
            let at = uv(0.0, std::f64::consts::PI);
            Case {
                part: Box::new(part),
                at,
                cutter: toroidal(10.0, corner),
                feed: FeedLine::Iso(Axis::U),
                lean,
                words,
            }
        }
    };
    let planar: [(&str, &str, &str, Planar); 4] = [
        ("two arcs, (37) in the stable form", "R97 36, 37, 49", "exact for arcs", width_37),
        ("chord for arc", "R97 38", "1", chord_38),
        ("without h^2", "R97 40", "1", linear_40),
        ("leading order", "R97, limit of 37", "1", leading_order),
    ];
    let mut out = Vec::new();
    for (name, source, order, form) in planar {
        let domain = "ball, feed along a line of curvature, round section";
        out.push(row([name, source, domain, order], balls, width, |c, h| form(across(c, h))));
    }
    out.push(row(
        ["two arcs, (37), any feed", "R97 37, 49", "ball, feed in any direction: 0 unless Q's", "0"],
        any_ball,
        width,
        |c, h| width_37(across(c, h)),
    ));
    let swept: Form = |c, h| leading_order_swept(&c.relative(), &c.frame.left, h);
    out.push(row(["leading order, swept", "here", "any cutter and feed, Q > 0", "1"], bulls, width, swept));
    let marks: [(&str, &str, Planar); 4] = [
        ("tooth mark, two arcs", "R97 41, 50", width_37),
        ("tooth mark, chord for arc", "R97 42", chord_38),
        ("tooth mark, without h^2", "R97 44", linear_40),
        ("tooth mark, leading order", "R97, limit of 41", leading_order),
    ];
    for (name, source, form) in marks {
        out.push(row([name, source, "ball, any direction", "1"], any_ball, mark, |c, h| form(along(c, h))));
    }
    let two: Form = |c, h| two_axis_ball(c.cutter.radius_mm(), h);
    out.push(row(["2CL, ball", "M86 2CL", "part straight across the feed", "1"], straight, width, two));
    let three: Form = |c, h| {
        three_axis_flat(c.cutter.radius_mm(), c.lean.lead_rad, c.forms.normal_curvature(&c.frame.left), h)
    };
    out.push(row(
        ["3C, flat end", "M86 3C", "feed along a line of curvature, Q at least 0.1 / R", "1"],
        flats,
        width,
        three,
    ));
    let three: Form = |c, h| {
        let k = c.forms.normal_curvature(&c.frame.left);
        three_axis_toroidal(c.cutter.core_mm(), c.cutter.corner_mm(), c.lean.lead_rad, k, h)
    };
    out.push(row(
        ["3C, toroidal end", "M86 3C", "feed along a line of curvature, Q at least 0.1 / R", "1"],
        corners,
        width,
        three,
    ));
    for (name, corner) in [("5C, flat end", 0.0), ("5C, toroidal end", 2.0)] {
        let form: Form = |c, h| Ok(five(c, h)?.width_mm);
        let labels = [name, "M86 5C", "two contacts in a groove along a line of curvature", "0"];
        out.push(row(labels, grooves(corner), two_contacts, form));
    }
    for (name, corner) in [("5C refined, flat end", 0.0), ("5C refined, toroidal end", 2.0)] {
        let form: Form = |c, h| {
            let [kf, ky] = [&c.frame.tangent, &c.frame.left].map(|d| c.forms.normal_curvature(d));
            Ok(five_axis_refined(c.cutter.core_mm(), c.cutter.corner_mm(), kf, ky, h)?.width_mm)
        };
        let labels = [name, "M86 5C", "two contacts in a groove along a line of curvature", "1/2"];
        out.push(row(labels, grooves(corner), two_contacts, form));
    }
    out
}

/// The rows as a table of Markdown.
pub fn table(rows: &[Row]) -> String {
    let mut out = String::from(
        "| form | source | domain | order in h | largest relative deviation at h/R = 1e-2 | 1e-3 | 1e-4 | observed order | contacts |\n\
         |---|---|---|---|---:|---:|---:|---:|---:|\n",
    );
    for r in rows {
        let [a, b, c] = [0, 1, 2].map(|k: usize| format!("{:.1e}", r.worst[k].0));
        let order = if r.worst[0].0 < 1e-7 { "-".to_owned() } else { format!("{:.2}", r.observed()) };
        out += &format!(
            "| {} | {} | {} | {} | {a} | {b} | {c} | {order} | {} |\n",
            r.name, r.source, r.domain, r.order, r.contacts
        );
    }
    out
}
