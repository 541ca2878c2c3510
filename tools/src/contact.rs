//! Contact of a cutter with a surface: lead and tilt to a pose, and the curvature of both there.
//!
//! At the CC point the tool's outward normal is `-n`. The axis starts along n, leans by `lead` towards the feed
//! (positive lifts the heel), then turns about n by `tilt`, right-handed:
//! `a = cos(lead) n + sin(lead) (cos(tilt) t + sin(tilt) b)`, `b = n x t`.

use crate::cutter::Cutter;
use crate::pose::Pose;
use crate::sweep::{Moving, SweptMotion};
use osculate_geom::line::{GeodesicLine, IsoLine, LineError, SurfaceLine};
use osculate_geom::{
    Axis, Darboux, Degenerate, Forms, Point3, Relative, Surface, ToolCurvature, Unit3, Uv, Vec3,
};
use std::f64::consts::FRAC_PI_2;

/// Lead and tilt of the tool axis against the surface normal and the feed.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Lean {
    /// From n towards the feed, rad.
    pub lead_rad: f64,
    /// About n, right-handed, after the lead, rad.
    pub tilt_rad: f64,
}

/// The direction of feed at a CC point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FeedLine {
    /// Along the isoparametric line on which this parameter grows.
    Iso(Axis),
    /// The same line the other way.
    IsoReversed(Axis),
    /// Along the geodesic at this angle from S_u towards S_v, rad.
    Angle(f64),
}

/// Why a contact cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// No tangent plane, or the line leaves the surface.
    #[error(transparent)]
    Line(#[from] LineError),
    /// A lead of 90 degrees or more, or a tilt that is not finite.
    #[error(
        "lead must lie strictly between -90 and 90 degrees and tilt be finite, got lead {lead_deg} and tilt {tilt_deg} degrees"
    )]
    Lean {
        /// Lead, degrees.
        lead_deg: f64,
        /// Tilt, degrees.
        tilt_deg: f64,
    },
    /// The tool is less curved than the part is hollow.
    #[error(
        "the tool does not fit at u = {}, v = {}: the part is hollow with curvature {part_per_mm:.6} 1/mm where the \
         tool has only {tool_per_mm:.6} 1/mm; use {}", at.u, at.v, advice(*part_per_mm, *largest_radius_mm)
    )]
    DoesNotFit {
        /// Where.
        at: Uv,
        /// Normal curvature of the part in the worst direction, negative.
        part_per_mm: f64,
        /// Normal curvature of the tool in the same direction.
        tool_per_mm: f64,
        /// Outer radius of the largest tool of this kind that fits at this lead, mm; zero where none does, and for cutters that are
        /// no end mills.
        largest_radius_mm: f64,
    },
}

fn advice(part_per_mm: f64, largest: f64) -> String {
    if largest > 0.0 {
        format!("a larger lead or a tool of radius {largest:.3} mm or less")
    } else {
        format!("a larger lead or a ball of radius {:.3} mm or less", -1.0 / part_per_mm)
    }
}

impl From<Degenerate> for ContactError {
    fn from(e: Degenerate) -> Self {
        Self::Line(e.into())
    }
}

impl Lean {
    /// The lean when it is usable.
    ///
    /// ```
    /// use osculate_tools::{ContactError, Lean};
    /// // Not given, the axis is the normal. A lead of a right angle would lay the tool on its side.
    /// assert_eq!(Lean::default(), Lean { lead_rad: 0.0, tilt_rad: 0.0 });
    /// let lying = Lean { lead_rad: 90f64.to_radians(), tilt_rad: 0.0 };
    /// assert!(matches!(lying.checked(), Err(ContactError::Lean { .. })));
    /// ```
    ///
    /// # Errors
    /// [`ContactError::Lean`].
    pub fn checked(self) -> Result<Self, ContactError> {
        if self.lead_rad.abs() < FRAC_PI_2 && self.tilt_rad.is_finite() {
            Ok(self)
        } else {
            Err(ContactError::Lean {
                lead_deg: self.lead_rad.to_degrees(),
                tilt_deg: self.tilt_rad.to_degrees(),
            })
        }
    }

    /// The direction in the tangent plane towards which the axis leans at positive lead.
    fn heading(self, frame: &Darboux) -> Unit3 {
        let (s, c) = self.tilt_rad.sin_cos();
        Unit3::new_normalize(frame.tangent.into_inner() * c + frame.left.into_inner() * s)
    }

    /// The pose that touches at the frame's point, raised by `lift_mm` along the normal.
    ///
    /// ```
    /// use osculate_geom::{Axis, Domain, Interval, analytic::Plane, uv};
    /// use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean};
    /// // A ball on a plane, fed along x and leaning by 30 degrees that way: its centre stands over the contact, its tip behind.
    /// let range = Interval::new(0.0, 50.0);
    /// let plane = Plane::new(Domain { u: range, v: range });
    /// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
    /// let lean = Lean { lead_rad: 30f64.to_radians(), tilt_rad: 0.0 };
    /// let contact = Contact::new(&plane, uv(20.0, 25.0), &ball, FeedLine::Iso(Axis::U), lean)?;
    /// let pose = lean.pose(&ball, &contact.frame, 0.0);
    /// assert!((pose.axis.x - 0.5).abs() < 1e-12);
    /// assert!((pose.tip.x - (20.0 - 2.5)).abs() < 1e-12);
    /// assert!((pose.tip.z - 5.0 * (1.0 - 0.75f64.sqrt())).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Without lead a flat or toroidal cutter touches with its whole bottom; the CC point is then taken where it
    /// is for a vanishing positive lead, on the corner's side towards the feed.
    #[must_use]
    pub fn pose(self, cutter: &Cutter, frame: &Darboux, lift_mm: f64) -> Pose {
        let heading = self.heading(frame).into_inner();
        let n = frame.normal.into_inner();
        let (s, c) = self.lead_rad.sin_cos();
        let axis = Unit3::new_normalize(n * c + heading * s);
        // From the axis to the corner's centre above the contact: the side of the bottom that has come down.
        let low = (heading * c - n * s) * if s < 0.0 { -1.0 } else { 1.0 };
        let arc = cutter.touching(self.lead_rad);
        let tip = frame.point + n * (arc.radius_mm + lift_mm)
            - low * arc.centre_rho_mm
            - axis.into_inner() * arc.centre_z_mm;
        Pose { tip, axis }
    }

    /// The pose in a frame that moves by `speed` mm along its tangent while lead and tilt grow by `rates` rad, all per unit of
    /// the motion's parameter; the lift is held.
    #[must_use]
    pub fn moving(
        self,
        cutter: &Cutter,
        frame: &Darboux,
        lift_mm: f64,
        (speed, rates): (f64, [f64; 2]),
    ) -> Moving {
        let pose = self.pose(cutter, frame, lift_mm);
        // Lead and tilt held, the tool is rigid in the moving frame.
        let turn = frame.turn * speed;
        let tip_rate = frame.tangent.into_inner() * speed + turn.cross(&(pose.tip - frame.point));
        if rates == [0.0; 2] {
            return Moving { pose, tip_rate, turn };
        }
        // With the lead the axis turns about n x heading, with the tilt about n, and the tool with it about the centre of its corner's
        // arc above the contact: that stays where it is.
        let [lead_rate, tilt_rate] = rates;
        let normal = frame.normal.into_inner();
        let about = normal.cross(&self.heading(frame)) * lead_rate + normal * tilt_rate;
        let centre =
            frame.point + frame.normal.into_inner() * (cutter.touching(self.lead_rad).radius_mm + lift_mm);
        Moving { pose, tip_rate: tip_rate + about.cross(&(pose.tip - centre)), turn: turn + about }
    }

    /// The lean of an axis against a frame: lead zero or more, tilt what remains; upright where the axis is the normal.
    ///
    /// ```
    /// use osculate_geom::{Darboux, Interval, Surface, Unit3, Vec3, analytic::Cylinder, uv};
    /// use osculate_tools::Lean;
    /// // On top of a shaft at x = 25, fed along z: the axis leans by 20 degrees to the left of the feed, a tilt of 90 degrees.
    /// let jet = Cylinder::new(25.0, Interval::new(0.0, 80.0))?.jet2(uv(0.0, 40.0));
    /// let frame = Darboux::new(&jet, &Vec3::z(), 0.0)?;
    /// let angle = 20f64.to_radians();
    /// let axis = Unit3::new_normalize(frame.normal.into_inner() * angle.cos() + frame.left.into_inner() * angle.sin());
    /// let lean = Lean::of(&axis, &frame);
    /// assert!((lean.lead_rad - angle).abs() < 1e-12 && (lean.tilt_rad - 90f64.to_radians()).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(axis: &Unit3, frame: &Darboux) -> Self {
        let [up, ahead, left] = [&frame.normal, &frame.tangent, &frame.left].map(|e| axis.dot(e));
        let flat = ahead.hypot(left);
        let tilt_rad = if flat == 0.0 { 0.0 } else { left.atan2(ahead) };
        Self { lead_rad: flat.atan2(up), tilt_rad }
    }

    /// Principal curvatures of the tool at the contact.
    ///
    /// ```
    /// use osculate_geom::{Axis, Domain, Interval, analytic::Plane, uv};
    /// use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean};
    /// // Corner radius r, lead l: across the feed it is as round as a ball of radius r + (R - r) / sin l.
    /// let range = Interval::new(0.0, 50.0);
    /// let plane = Plane::new(Domain { u: range, v: range });
    /// let bull = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 };
    /// let cutter = Cutter::try_from(bull)?;
    /// let lean = Lean { lead_rad: 30f64.to_radians(), tilt_rad: 0.0 };
    /// let contact = Contact::new(&plane, uv(25.0, 25.0), &cutter, FeedLine::Iso(Axis::U), lean)?;
    /// let tool = lean.tool_curvature(&cutter, &contact.frame);
    /// assert!((tool.along - 1.0 / 2.0).abs() < 1e-12 && (tool.across - 1.0 / (2.0 + 8.0 / 0.5)).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn tool_curvature(self, cutter: &Cutter, frame: &Darboux) -> ToolCurvature {
        let s = self.lead_rad.sin().abs();
        let arc = cutter.touching(self.lead_rad);
        let (core, r) = (arc.centre_rho_mm, arc.radius_mm);
        let along = if r > 0.0 { 1.0 / r } else { f64::INFINITY };
        // Meusnier on the parallel circle of radius core + r sin(lead).
        let across = if core == 0.0 { along } else { s / (core + r * s) };
        ToolCurvature { along, across, direction: self.heading(frame) }
    }
}

/// The motion of a cutter that touches the point of a frame with a given axis, while the frame moves by `speed` mm along its
/// tangent and the axis by `axis_rate`, both per unit of the motion's parameter. The axis leans off the normal, but for a ball.
///
/// With m the direction in the plane of normal and axis from the axis to the contact, at right angles to the axis, the tip is
/// `x + r n + c m - z a`, where r, c and z are the touching arc's radius and centre: what the derivative is taken of.
#[must_use]
pub fn moving_with_axis(
    cutter: &Cutter,
    frame: &Darboux,
    speed: f64,
    axis: &Unit3,
    axis_rate: &Vec3,
) -> Moving {
    let (n, a) = (frame.normal.into_inner(), axis.into_inner());
    let pose = pose_with_axis(cutter, &frame.point, &frame.normal, axis);
    // Only what is at right angles to the axis turns it.
    let a_rate = axis_rate - a * axis_rate.dot(&a);
    let n_rate = frame.turn.cross(&n) * speed;
    let arc = cutter.touching(axis.angle(&frame.normal));
    let mut tip_rate = frame.tangent.into_inner() * speed + n_rate * arc.radius_mm - a_rate * arc.centre_z_mm;
    let across = n - a * n.dot(&a);
    let sine = across.norm();
    if arc.centre_rho_mm != 0.0 && sine > 0.0 {
        let m = across / sine;
        let rate = n_rate - a_rate * n.dot(&a) - a * (n_rate.dot(&a) + n.dot(&a_rate));
        tip_rate += (rate - m * rate.dot(&m)) * (arc.centre_rho_mm / sine);
    }
    Moving { pose, tip_rate, turn: a.cross(&a_rate) }
}

/// The pose of a cutter that touches a point with outward normal `normal` and has a given axis. One that does not lean off the
/// normal touches with its whole bottom, and stands with its tip over the point.
///
/// ```
/// use osculate_geom::{Point3, Unit3, Vec3};
/// use osculate_tools::{Cutter, CutterSpec, pose_with_axis};
/// // A ball touches with its centre a radius above the point, whatever the axis; the tip is a radius below that along the axis.
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
/// let axis = Unit3::new_normalize(Vec3::new(0.6, 0.0, 0.8));
/// let pose = pose_with_axis(&ball, &Point3::new(7.0, 0.0, 0.0), &Vec3::z_axis(), &axis);
/// assert!((pose.tip - Point3::new(7.0 - 3.0, 0.0, 5.0 - 4.0)).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn pose_with_axis(cutter: &Cutter, point: &Point3, normal: &Unit3, axis: &Unit3) -> Pose {
    let (n, a) = (normal.into_inner(), axis.into_inner());
    let arc = cutter.touching(axis.angle(normal));
    let across = n - a * n.dot(&a);
    let m = Unit3::try_new(across, 0.0).map_or_else(Vec3::zeros, Unit3::into_inner);
    let tip = point + n * arc.radius_mm + m * arc.centre_rho_mm - a * arc.centre_z_mm;
    Pose { tip, axis: *axis }
}

/// A cutter driven along a line on a surface at constant lead, tilt and lift: the exact motion, pose by pose.
///
/// ```
/// use osculate_geom::{Axis, Domain, Interval, analytic::Plane, line::IsoLine};
/// use osculate_tools::sweep::SweptMotion;
/// use osculate_tools::{ContactMotion, Cutter, CutterSpec, Lean};
/// // Along a line on a plane the tool moves straight and does not turn.
/// let range = Interval::new(0.0, 50.0);
/// let plane = Plane::new(Domain { u: range, v: range });
/// let line = IsoLine { surface: &plane, along: Axis::U, fixed: 20.0, reversed: false };
/// let cutter = Cutter::try_from(CutterSpec::Flat { diameter_mm: 12.0, length_mm: 40.0 })?;
/// let lean = Lean { lead_rad: 0.1, tilt_rad: 0.0 };
/// let moving = ContactMotion { line: &line, cutter: &cutter, lean, lift_mm: 0.0 }.at(10.0).ok_or("it ends")?;
/// assert!((moving.tip_rate.x - 1.0).abs() < 1e-12 && moving.turn.norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct ContactMotion<'a> {
    /// The line of CC points.
    pub line: &'a dyn SurfaceLine,
    /// The cutter.
    pub cutter: &'a Cutter,
    /// Lead and tilt.
    pub lean: Lean,
    /// Height above the contact along n, mm.
    pub lift_mm: f64,
}

impl SweptMotion for ContactMotion<'_> {
    fn at(&self, t: f64) -> Option<Moving> {
        let (frame, speed) = self.line.frame(t).ok()?;
        Some(self.lean.moving(self.cutter, &frame, self.lift_mm, (speed, [0.0; 2])))
    }
}

/// A cutter touching a surface at one CC point, with the line along which it is fed.
#[derive(Clone, Copy)]
pub struct Contact<'a> {
    /// The surface.
    pub surface: &'a dyn Surface,
    /// The CC point's parameters.
    pub at: Uv,
    /// The cutter.
    pub cutter: &'a Cutter,
    /// Lead and tilt.
    pub lean: Lean,
    /// Height above the contact along n, mm.
    pub lift_mm: f64,
    /// Darboux frame of the feed line at the CC point.
    pub frame: Darboux,
    /// Fundamental forms of the part there.
    pub forms: Forms,
    feed: FeedLine,
}

/// The feed line of a contact.
#[non_exhaustive]
pub enum ContactLine<'a> {
    /// An isoparametric line.
    Iso(IsoLine<'a>),
    /// A geodesic; `t` is arc length from the contact.
    Geodesic(GeodesicLine<'a>),
}

impl SurfaceLine for ContactLine<'_> {
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError> {
        match self {
            Self::Iso(l) => l.frame(t),
            Self::Geodesic(l) => l.frame(t),
        }
    }
}

impl<'a> Contact<'a> {
    /// The contact at `at` with the feed along `feed`.
    ///
    /// ```
    /// use osculate_geom::{Axis, Flipped, Interval, analytic::Cylinder, uv};
    /// use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean};
    /// // A ball of radius 5 along a bore of radius 20: across the feed they differ by 1/5 - 1/20, along it by 1/5.
    /// let bore = Flipped(Cylinder::new(20.0, Interval::new(0.0, 80.0))?);
    /// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
    /// let contact = Contact::new(&bore, uv(0.0, 40.0), &ball, FeedLine::Iso(Axis::V), Lean::default())?;
    /// contact.fits()?;
    /// let relative = contact.relative();
    /// assert!((relative.min - 0.15).abs() < 1e-12 && (relative.max - 0.2).abs() < 1e-12);
    /// // One of radius 25 does not fit.
    /// let thick = Cutter::try_from(CutterSpec::Ball { diameter_mm: 50.0, length_mm: 60.0 })?;
    /// let contact = Contact::new(&bore, uv(0.0, 40.0), &thick, FeedLine::Iso(Axis::V), Lean::default())?;
    /// assert!(contact.fits().is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ContactError::Lean`] and [`ContactError::Line`]. Whether the tool fits is a separate question:
    /// [`Contact::fits`].
    pub fn new(
        surface: &'a dyn Surface,
        at: Uv,
        cutter: &'a Cutter,
        feed: FeedLine,
        lean: Lean,
    ) -> Result<Self, ContactError> {
        let lean = lean.checked()?;
        let jet = surface.jet2(at);
        let forms = jet.forms()?;
        let mut contact = Self {
            surface,
            at,
            cutter,
            lean,
            lift_mm: 0.0,
            // Replaced below by the line's own frame, which needs the line.
            frame: Darboux::with_forms(&jet, &forms, &jet.du, 0.0),
            forms,
            feed,
        };
        let (line, t0) = contact.line()?;
        contact.frame = line.frame(t0)?.0;
        Ok(contact)
    }

    /// The same contact with the tool raised along the normal.
    #[must_use]
    pub const fn lifted(mut self, lift_mm: f64) -> Self {
        self.lift_mm = lift_mm;
        self
    }

    /// The same contact with the axis leaning otherwise.
    ///
    /// # Errors
    /// [`ContactError::Lean`].
    pub fn leaning(mut self, lean: Lean) -> Result<Self, ContactError> {
        self.lean = lean.checked()?;
        Ok(self)
    }

    /// The feed line and the line parameter of the contact.
    ///
    /// # Errors
    /// [`ContactError::Line`] without a tangent plane.
    pub fn line(&self) -> Result<(ContactLine<'a>, f64), ContactError> {
        match self.feed {
            FeedLine::Iso(along) | FeedLine::IsoReversed(along) => {
                let fixed = self.at.get(along.other());
                let reversed = matches!(self.feed, FeedLine::IsoReversed(_));
                let line = IsoLine { surface: self.surface, along, fixed, reversed };
                Ok((ContactLine::Iso(line), self.at.get(along)))
            }
            FeedLine::Angle(angle) => {
                let jet = self.surface.jet2(self.at);
                // From S_u towards S_v: the right-handed turn about S_u x S_v, whatever the outward side.
                let e1 = self.forms.frame[0].into_inner();
                let e2 = self.forms.frame[1].into_inner() * jet.side.sign();
                let (s, c) = angle.sin_cos();
                let step = self.step_mm();
                let line = GeodesicLine::new(self.surface, self.at, &(e1 * c + e2 * s), step)?;
                Ok((ContactLine::Geodesic(line), 0.0))
            }
        }
    }

    /// Relative curvature form Q.
    #[must_use]
    pub fn relative(&self) -> Relative {
        Relative::new(&self.forms, &self.lean.tool_curvature(self.cutter, &self.frame))
    }

    /// The pose of the tool.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.lean.pose(self.cutter, &self.frame, self.lift_mm)
    }

    /// Errors unless Q is positive semidefinite: the tool does not dig in next to the contact.
    ///
    /// # Errors
    /// [`ContactError::DoesNotFit`] with both curvatures and the largest radius that would fit.
    pub fn fits(&self) -> Result<(), ContactError> {
        let q = self.relative();
        if q.min >= 0.0 {
            return Ok(());
        }
        let part = self.forms.normal_curvature(&q.d_min);
        let s = self.lean.lead_rad.sin().abs();
        let r = self.cutter.corner_mm();
        // Across the lean the tool's curvature is s / (core + r s); along it 1/r.
        let hollow = -self.forms.principal().k_min;
        let largest = if !self.cutter.is_end_mill() {
            0.0
        } else if self.cutter.is_ball() {
            1.0 / hollow
        } else if r * hollow > 1.0 {
            0.0
        } else {
            (s / hollow - r * s).max(0.0) + r
        };
        Err(ContactError::DoesNotFit {
            at: self.at,
            part_per_mm: part,
            tool_per_mm: q.min - part,
            largest_radius_mm: if largest > r || self.cutter.is_ball() { largest } else { 0.0 },
        })
    }

    /// Length over which lines on the surface are integrated in one Runge-Kutta step, mm: a fiftieth of the
    /// smallest radius around, so that the fifth-order local error stays near 1e-11 of that radius.
    pub(crate) fn step_mm(&self) -> f64 {
        let p = self.forms.principal();
        let k = p.k_max.abs().max(p.k_min.abs()).max(1.0 / (10.0 * self.cutter.radius_mm()));
        0.02 / k
    }
}
