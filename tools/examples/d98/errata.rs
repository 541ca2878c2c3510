//! The slips of D98, each with the number that shows it.
//!
//! The paper's frames: z1 from P1 to P0, y the bisector, `x1 = y x z1`; at each end `x2 = cos(theta) x1 - sin(theta) z1` in the
//! plane of y and the directrix' tangent. With signed angles its equations (4) to (16) read, gamma the turn about y,
//!
//! ```text
//! L_0 = h_0 tan(gamma) / (cos(theta_0) + tan(gamma) sin(theta_0)),   a_i = R / cos(theta_i - gamma),   L_1 alike with -h_1
//! (C_i(u_i) - P_i) . x2 = a_i cos(w_i) + L_i       (11, 14)
//! (C_i(u_i) - P_i) . y  = R sin(w_i) + R            (12, 15)
//! tan(beta_i) = -R cos(w_i) / (a_i sin(w_i))        (13, 16), printed with beta_i at the left
//! ```

use super::{Done, deviation, eq18, liu, paraboloid, stations};
use nalgebra::{SMatrix, SVector};
use osculate_geom::{Side, Unit3, Vec3};
use osculate_tools::flank::closed::MiddleRule;
use osculate_tools::flank::{
    AxisLine, Rule, RuledStrip, Setting, SideTool, balanced_fraction, least_at, place, three_tangent,
};
use std::fmt::Write;

/// Unknowns u0, u1, w0, w1, h0 and gamma.
type Unknowns = SVector<f64, 6>;

struct Paper<'a> {
    strip: &'a RuledStrip<'a>,
    rule: Rule,
    radius: f64,
}

/// One end in the paper's frame.
struct EndFrame {
    x2: Vec3,
    z2: Vec3,
    theta: f64,
}

impl Paper<'_> {
    fn frame(&self, end: usize) -> EndFrame {
        let f = &self.rule.frame;
        let (x1, z1) = (-f.x, -f.z);
        let t = self.rule.ends[end].first;
        let theta = -(t.dot(&z1) / t.dot(&x1)).atan();
        let x2 = x1 * theta.cos() - z1 * theta.sin();
        EndFrame { x2, z2: x2.cross(&f.y), theta }
    }

    /// L and a of an end.
    fn ellipse(&self, end: usize, h0: f64, gamma: f64) -> [f64; 2] {
        let theta = self.frame(end).theta;
        let h = if end == 0 { h0 } else { h0 - self.rule.length_mm };
        let shift = h * gamma.tan() / (theta.cos() + gamma.tan() * theta.sin());
        [shift, self.radius / (theta - gamma).cos()]
    }

    /// (11) to (16), the latter with tan(beta) or, as printed, beta.
    fn residuals(&self, q: &Unknowns, printed: bool) -> Unknowns {
        let mut out = Unknowns::zeros();
        for end in 0..2 {
            let frame = self.frame(end);
            let [shift, a] = self.ellipse(end, q[4], q[5]);
            let j = self.strip.directrix(end, q[end]);
            let c = j.point - self.rule.ends[end].point;
            let (sin, cos) = q[2 + end].sin_cos();
            let slope = j.first.dot(&self.rule.frame.y) / j.first.dot(&frame.x2);
            out[3 * end] = c.dot(&frame.x2) - a * cos - shift;
            out[3 * end + 1] = c.dot(&self.rule.frame.y) - self.radius * (sin + 1.0);
            let left = if printed { slope.atan() } else { slope };
            out[3 * end + 2] = left * a * sin + self.radius * cos;
        }
        out
    }

    /// The exact setting in the paper's unknowns.
    fn exact(&self) -> Done<Unknowns> {
        let root = three_tangent(self.strip, self.rule.u, SideTool::cylinder(self.radius)?)?;
        let mut q = Unknowns::zeros();
        (q[4], q[5]) = (root.height_mm, -root.turn_rad);
        for end in 0..2 {
            q[end] = root.contacts[end];
            let j = self.strip.directrix(end, q[end]);
            let c = j.point - self.rule.ends[end].point;
            let [shift, a] = self.ellipse(end, q[4], q[5]);
            let sin = c.dot(&self.rule.frame.y) / self.radius - 1.0;
            q[2 + end] = sin.atan2((c.dot(&self.frame(end).x2) - shift) / a);
        }
        Ok(q)
    }

    /// Newton's method with differences.
    fn solve(&self, mut q: Unknowns, printed: bool) -> Option<Unknowns> {
        for _ in 0..60 {
            let r = self.residuals(&q, printed);
            if r.amax() < 1e-10 {
                return Some(q);
            }
            let mut jacobian = SMatrix::<f64, 6, 6>::zeros();
            for k in 0..6 {
                let h = 1e-7 * (1.0 + q[k].abs());
                let mut p = q;
                p[k] += h;
                jacobian.set_column(k, &((self.residuals(&p, printed) - r) / h));
            }
            q -= jacobian.lu().solve(&r)?;
            if !q.iter().all(|x| x.is_finite()) {
                return None;
            }
        }
        None
    }

    /// What the tool of a solution leaves at both directrices, mm.
    fn at_directrices(&self, q: &Unknowns) -> Done<[f64; 2]> {
        let (f, st) = (&self.rule.frame, stations(self.strip));
        let (sin, cos) = (-q[5]).sin_cos();
        let tool = SideTool::cylinder(self.radius)?;
        let axis = AxisLine {
            point: self.rule.ends[0].point + f.z * q[4] + f.y * self.radius,
            direction: Unit3::new_normalize(f.z * cos - f.x * sin),
        };
        Ok([0.0, 1.0].map(|v| least_at(self.strip, &st, &tool, &axis, v).deviation_mm))
    }
}

pub(crate) fn errata(text: &mut String) -> Done<()> {
    writeln!(text, "## Errata, each with what shows it\n")?;
    let m = MiddleRule { height_mm: 80.0, half_twist_rad: 30f64.to_radians(), radius_mm: 10.0 };
    let h = paraboloid(&m)?;
    let p = Paper { strip: &h, rule: h.rule(0.5)?, radius: 10.0 };
    let exact = p.exact()?;
    let (good, printed) = (p.residuals(&exact, false), p.residuals(&exact, true));
    writeln!(
        text,
        "**(13), (16): the left sides must be tan(beta), and gamma_1 is gamma_0.** On the paraboloid (30 degrees, h = 80, R = 10),\n\
         whose directrices lie in planes through y, the exact position leaves {:.0e} in (13) times a sin(w) with tan(beta) and {:.4}\n\
         with beta.",
        good[2].abs().max(good[5].abs()),
        printed[2].abs()
    )?;
    match p.solve(exact, true) {
        Some(q) => {
            let [a, b] = p.at_directrices(&q)?;
            writeln!(
                text,
                "As printed the system gives gamma = {:.5} deg instead of {:.5}, and a tool that stands {a:+.4} and {b:+.4} mm off the\n\
                 directrices that it should touch.\n",
                q[5].abs().to_degrees(),
                exact[5].abs().to_degrees()
            )?;
        }
        None => writeln!(text, "As printed the system has no solution near it.\n")?,
    }
    writeln!(
        text,
        "**(11) to (16) drop the z component.** They hold only where each directrix lies in a plane through y. Elsewhere the\n\
         contact M_i lies off the plane of its ellipse, and the system, tan(beta) put right, gives another tool:\n\n\
         | surface | M0, M1 off their planes, mm | gamma, paper's system | exact | off C0, mm | off C1, mm |\n|---|---|---:|---:|---:|---:|"
    )?;
    let (e, l) = (eq18(Side::Along)?, liu()?);
    for (name, s, u) in [("(18), u = 0.4, R = 10", &e, 0.4), ("Liu, u = 21.892, R = 10", &l, 21.892)] {
        let p = Paper { strip: s, rule: s.rule(u)?, radius: 10.0 };
        let exact = p.exact()?;
        let off = [0, 1].map(|end: usize| {
            let c = s.directrix(end, exact[end]).point - p.rule.ends[end].point;
            c.dot(&p.frame(end).z2)
        });
        write!(text, "| {name} | {:+.4}, {:+.4} |", off[0], off[1])?;
        match p.solve(exact, false) {
            Some(q) => {
                let [a, b] = p.at_directrices(&q)?;
                writeln!(
                    text,
                    " {:.5} deg | {:.5} deg | {a:+.5} | {b:+.5} |",
                    q[5].abs().to_degrees(),
                    exact[5].abs().to_degrees()
                )?;
            }
            None => writeln!(text, " no solution | {:.5} deg | | |", exact[5].abs().to_degrees())?,
        }
    }
    let rule = e.rule(0.4)?;
    let raw: Vec3 = rule.ends.iter().map(|j| j.first.cross(&rule.frame.z)).sum();
    let between = raw.angle(&rule.frame.y).to_degrees();
    let lengths = [0, 1].map(|k: usize| rule.ends[k].first.cross(&rule.frame.z).norm());
    writeln!(
        text,
        "\n**The bisector needs unit N0 and N1.** On (18) at u = 0.4 they are {:.1} and {:.1} mm long; their sum as printed lies {between:.2}\n\
         degrees off the bisector.\n",
        lengths[0], lengths[1]
    )?;
    let root = three_tangent(&e, 0.4, SideTool::cylinder(10.0)?)?;
    let tool = SideTool::cylinder(10.0)?;
    let shift = rule.frame.z * (0.5 * rule.length_mm - root.height_mm);
    let moved = AxisLine { point: root.axis.line.point + shift, ..root.axis.line };
    let st = stations(&e);
    let [a, b] = [0.0, 1.0].map(|v| least_at(&e, &st, &tool, &moved, v).deviation_mm);
    writeln!(
        text,
        "**The origin of R2 is M2, not P2.** On (18) M2 lies {:.4} mm from the centre of the rule; the same tool through P2 stands\n\
         {a:+.4} and {b:+.4} mm off the directrices.\n",
        0.5 * rule.length_mm - root.height_mm
    )?;
    let rule = l.rule(23.014)?;
    let error = |r: f64| -> Done<f64> {
        let tool = SideTool::cylinder(r)?;
        let t = balanced_fraction(&rule, tool)?;
        let placed = place(&l, &stations(&l), 23.014, tool, Setting::DoublePoint(t))?;
        Ok(tool.deviation_mm(&placed.axis, &rule.point(0.0)))
    };
    let hundred = match error(100.0) {
        Ok(e) => format!("+-{e:.3} mm"),
        Err(why) => format!("nothing ({why})"),
    };
    let large = match deviation(&l, 21.892, 100.0, Setting::ThreeTangent) {
        Ok(p) => format!("they do, gouging {:.3} mm", -p.lowest.deviation_mm),
        Err(why) => why.to_string(),
    };
    writeln!(
        text,
        "**4.2: R = 10, not 'R = 100'.** Liu's setting gives +-{:.4} mm with R = 10 on his surface (printed: +-0.585) and {hundred} with\n\
         R = 100; three tangencies do not exist with R = 100 at u = 21.892:\n\
         {large}. The paper's own 0.22 mm is the gouge of three tangencies at u = 21.892 ({:.4}); at the end of the patch,\n\
         where Liu's 0.585 belongs, it is {:.4}.\n",
        error(10.0)?,
        deviation(&l, 21.892, 10.0, Setting::ThreeTangent)?.lowest.deviation_mm,
        deviation(&l, 23.014, 10.0, Setting::ThreeTangent)?.lowest.deviation_mm
    )?;
    let lowest = [5.0, 10.0, 15.0, 30.0, 45.0].map(|deg: f64| {
        let m = MiddleRule { height_mm: 80.0, half_twist_rad: deg.to_radians(), radius_mm: 20.0 };
        let t = m.three_tangent();
        (deg, t.map_or(f64::NAN, |t| m.standard_depth_mm() / t.depth_mm))
    });
    let least = lowest.iter().fold((0.0, f64::INFINITY), |a, b| if b.1 < a.1 { *b } else { a });
    writeln!(
        text,
        "**4.2: 'e_o = 45' is alpha_0 = 45.** Of the twists drawn the lowest indicator is that of alpha_0 = {} degrees\n\
         ({:.2} at R/h = 1/4).\n",
        least.0, least.1
    )?;
    Ok(())
}
