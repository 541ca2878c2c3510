//! The page of R97.

use super::forms::{HEIGHTS, Row, table};
use super::plot::{Curve, logarithmic, polar};
use osculate_geom::analytic::Paraboloid;
use osculate_geom::indicatrix::{Conformity, dupin_root_mm};
use osculate_geom::{Forms, Relative, Surface, ToolCurvature, Unit3, uv};
use osculate_productivity::closed_form::leading_order_swept;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Equation, our form, erratum.
const EQUATIONS: [[&str; 3]; 18] = [
    [
        "1, 2 area per tooth",
        "`rate::area_per_tooth_mm2`: magnitude of the cross product",
        "(1) prints 'dot product', which (2) contradicts",
    ],
    [
        "5, 6, 7 split of the tolerance",
        "`rate::Share`, `split::best_share`; by leading orders `split::leading_share`: 1/2, less where the feed is capped",
        "left to another paper",
    ],
    ["9 h(u, v), 19 S(u, v)", "`given::Given`", ""],
    [
        "11, 31 averages",
        "`levels::Levels`: regional and global; of a program in its real time `real_time::Region`, `real_time::Finishing`",
        "",
    ],
    [
        "18 volume of stock",
        "`rough::layer_volume`: S + S^2 H + S^3 K / 3 over the area; as printed: `rough::flat_volume`",
        "(18) drops curvature: off by S H",
    ],
    ["20, 21 change of parameters", "`finish::Place`, `Place::jacobian`", ""],
    ["22 roughing in time", "`rough::layer_rate_mm3_min`", "(22) prints dU dV under one integral: dw"],
    ["23, 24, 27, 28 continuous cutting surface", "`engagement::Outline`, `Engagement::rate`", ""],
    ["25 to 30 teeth", "`Engagement::rate_of_teeth`", ""],
    ["32 to 35 finishing in time", "`finish::area_rate_mm2_min`", ""],
    [
        "36, 37, 49 width of two arcs",
        "`closed_form::width_37`, in batches `closed_form::Sections`; as printed `acos_37`",
        "(37) loses all digits on flat parts",
    ],
    ["38, 42 chord for arc", "`closed_form::chord_38`", ""],
    [
        "39, 40, 43, 44, 46 signs",
        "`closed_form::linear_40`",
        "`[h] sgn R_P` gives no real value on any hollow part: [h]",
    ],
    ["41, 50 feed per tooth", "`width_37` along the feed; exact: `strip::mark`", ""],
    [
        "45, 46 area per tooth",
        "`Caps::rate` of width and mark; leading order `rate::leading_area_per_tooth_mm2`",
        "",
    ],
    ["47, 48 Euler", "`Forms::normal_curvature`: d^T W d", ""],
    [
        "51 to 62 Dupin, general parametrisations",
        "`indicatrix::dupin_root_mm`, `Forms::curvature`",
        "(57, 58, 61, 62) print + M sin 2 xi: minus; (61, 62) print M_P, N_P in the tool's radius",
    ],
    ["63 conformity", "`indicatrix::Conformity`, to be drawn", "the smallest r is not the widest strip"],
];

fn tangent(forms: &Forms, angle: f64) -> Unit3 {
    let (s, c) = angle.sin_cos();
    Unit3::new_normalize(forms.frame[0].into_inner() * c + forms.frame[1].into_inner() * s)
}

fn forms_of(k: [f64; 2]) -> Forms {
    let part = Paraboloid::new([-0.5 * k[0], -0.5 * k[1]], 1.0).expect("a good paraboloid");
    part.jet2(uv(0.0, 0.0)).forms().expect("a tangent plane")
}

/// Greatest and mean angle between the claimed and the widest direction over tools and turns, degrees.
fn claim(k: [f64; 2]) -> [f64; 2] {
    let part = forms_of(k);
    let (mut most, mut sum, mut count) = (0.0f64, 0.0, 0.0);
    for turn in 0..36 {
        for (along, across) in [(0.2, 0.2), (0.5, 0.12), (0.3, 0.06), (1.0, 0.1)] {
            let tool =
                ToolCurvature { along, across, direction: tangent(&part, PI * f64::from(turn) / 36.0) };
            if Relative::new(&part, &tool).min <= 0.0 {
                continue;
            }
            let off = Conformity::new(part, tool).claim().off_rad.to_degrees();
            most = most.max(off);
            sum += off;
            count += 1.0;
        }
    }
    [most, sum / f64::max(count, 1.0)]
}

/// Polar curves of one contact.
fn polar_of(k: [f64; 2], tool: (f64, f64, f64), title: &str) -> String {
    let part = forms_of(k);
    let tool = ToolCurvature { along: tool.0, across: tool.1, direction: tangent(&part, tool.2) };
    let both = Conformity::new(part, tool);
    let q = Relative::new(&part, &tool);
    let steps = 720;
    let over = |f: &dyn Fn(&Unit3) -> f64| -> Vec<[f64; 2]> {
        (0..=steps)
            .map(|i| TAU * f64::from(i) / f64::from(steps))
            .map(|a| [a, f(&tangent(&part, a))])
            .collect()
    };
    let curve = |name: &str, points| Curve { name: name.to_owned(), points, dots: false };
    let curves = [
        curve("Dupin's indicatrix of the part", over(&|d| dupin_root_mm(&part, d))),
        curve("indicatrix of conformity (63)", over(&|d| both.root_mm(d))),
        curve(
            "strip width along the direction",
            over(&|d| leading_order_swept(&q, d, 1e-3).unwrap_or(f64::NAN)),
        ),
    ];
    let angle = |d: &Unit3| d.dot(&part.frame[1]).atan2(d.dot(&part.frame[0]));
    let claim = both.claim();
    let words = format!("smallest r: {:.0} deg off", claim.off_rad.to_degrees());
    polar(
        title,
        &curves,
        &[(angle(&claim.across), &words), (angle(&claim.widest), "widest strip, eigenvector of Q")],
    )
}

pub fn page(rows: &[Row]) -> Vec<(String, String)> {
    let own: Vec<&Row> = rows.iter().filter(|r| !r.source.starts_with("M86")).collect();
    let curves: Vec<Curve> = own
        .iter()
        .filter(|r| !r.name.starts_with("tooth mark") && r.worst[0].0 > 1e-7)
        .map(|r| Curve {
            name: r.name.to_owned(),
            points: HEIGHTS.iter().zip(&r.worst).map(|(h, w)| [*h, w.0]).collect(),
            dots: false,
        })
        .collect();
    let mut text = String::from(
        "# R97: productivity of multi-axis machining of sculptured surfaces\n\n\
         Made by `cargo xtask papers r97`. S. P. Radzevich's formulas as they are in this project, held against the exact swept strip.\n\
         Curvature is positive where the body is convex, so that R97's radii keep their signs.\n\n\
         ## Equations\n\n| eq. | here | erratum |\n|---|---|---|\n",
    );
    for [a, b, c] in EQUATIONS {
        text += &format!("| {a} | {b} | {c} |\n");
    }
    text += "\nEvery erratum is a test that shows the printed form failing: `productivity/tests/errata.rs` and the tests beside the formulas.\n\n";
    text += "## Against the exact strip\n\nLargest relative deviation over the contacts of each form's domain.\n\n";
    text += &table_of(&own);
    text += "\nWhere the deviation is largest, at h/R = 1e-3:\n\n";
    for r in &own {
        text += &format!("- {}: {:.1e}, {}\n", r.name, r.worst[1].0, r.worst[1].1);
    }
    text += "\n![Deviation by tolerance](r97-error.svg)\n\n## The indicatrix of conformity\n\n\
             R97 says: feed across the direction in which |r| of (63) is smallest. The widest strip lies along the eigenvector of Q's smaller\n\
             eigenvalue. The angle between the two, over four tools turned in steps of 5 degrees:\n\n\
             | part | k_1, k_2, 1/mm | greatest, deg | mean, deg |\n|---|---|---:|---:|\n";
    for (name, k) in [
        ("hollow", [-0.004, -0.02]),
        ("hollow, nearly round", [-0.015, -0.02]),
        ("saddle", [0.02, -0.02]),
        ("convex", [0.03, 0.01]),
        ("convex, cylinder", [0.03, 1e-6]),
    ] {
        let [most, mean] = claim(k);
        text += &format!("| {name} | {}, {} | {most:.1} | {mean:.1} |\n", k[0], k[1]);
    }
    text += "\nEven in a hollow part with common principal directions it fails: k_P = (-0.01, -0.02), k_T = (0.05, 0.1) is a right angle off.\n\n\
             ![Hollow part](r97-conformity-hollow.svg)\n\n![Convex part](r97-conformity-convex.svg)\n\n\
             Each curve is scaled to its own largest radius.\n";
    vec![
        ("r97.md".into(), text),
        (
            "r97-error.svg".into(),
            logarithmic(
                "R97: largest relative deviation from the exact strip",
                ["h / R", "deviation"],
                &curves,
            ),
        ),
        (
            "r97-conformity-hollow.svg".into(),
            polar_of([-0.004, -0.02], (0.5, 0.12, 0.5), "Hollow part, toroidal tool: radii over directions"),
        ),
        (
            "r97-conformity-convex.svg".into(),
            polar_of(
                [0.03, 0.01],
                (0.2, 0.08, 0.25 * FRAC_PI_2),
                "Convex part, toroidal tool: radii over directions",
            ),
        ),
    ]
}

fn table_of(rows: &[&Row]) -> String {
    let owned: Vec<Row> = rows.iter().map(|r| Row { worst: r.worst.clone(), ..**r }).collect();
    table(&owned)
}
