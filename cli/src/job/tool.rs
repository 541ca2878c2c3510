//! A tool of a job: cutter, shank and holder made once, by the keys that go with its kind.

use crate::failure::Failure;
use crate::job::control;
use crate::job::problem::Places;
use crate::job::raw;
use crate::job::words::ToolKind;
use osculate_postproc::nc::Coolant;
use osculate_tools::{Cutter, CutterSpec, Holder, HolderError, HolderSpec};

/// Length of a cutter that gives none, in diameters.
const DEFAULT_LENGTH: f64 = 5.0;

/// Kinds with the keys that each needs, and those that it may have beside length_mm and what every tool may have.
pub const KINDS: [(ToolKind, &[&str], &[&str]); 7] = [
    (ToolKind::Ball, &["diameter_mm"], &["corner_radius_mm"]),
    (ToolKind::Flat, &["diameter_mm"], &["corner_radius_mm"]),
    (ToolKind::Toroidal, &["diameter_mm", "corner_radius_mm"], &[]),
    (ToolKind::Cylindrical, &["diameter_mm"], &["corner_radius_mm"]),
    (ToolKind::Cone, &["diameter_mm", "taper_deg"], &["corner_radius_mm", "tip_diameter_mm"]),
    (ToolKind::Barrel, &["diameter_mm", "barrel_radius_mm", "corner_radius_mm"], &[]),
    (ToolKind::Apt, &["diameter_mm"], &["corner_radius_mm", "bottom_angle_deg", "side_angle_deg"]),
];

/// A tool.
#[derive(Debug, Clone)]
pub struct Tool {
    kind: ToolKind,
    number: u32,
    spec: CutterSpec,
    cutter: Cutter,
    cutting: Cutter,
    shank: Option<Cutter>,
    holder: Option<Holder>,
    sections: Vec<HolderSpec>,
    teeth: Option<u32>,
    plunges: bool,
    words: String,
    feeding: raw::Cutting,
}

impl Tool {
    /// The tool of a table. `place` is its place in the list, from 1.
    /// Where its table says nothing of spindle and feed, `all` does.
    pub(super) fn of(
        places: &Places,
        table: &str,
        (t, place): (&raw::Tool, u32),
        all: &raw::Cutting,
    ) -> Result<Self, Failure> {
        let spec = spec(places, table, t)?;
        let cutter = Cutter::try_from(spec).map_err(|e| places.refuse(table, "", e))?;
        let (cutting, shank) = flutes(places, table, &cutter, t.flute_length_mm)?;
        let sections = t.holder.as_ref().map(raw::Holder::sections).unwrap_or_default();
        let holder = (!sections.is_empty()).then(|| {
            let words = |e: HolderError| e.to_string().replace("cutter", "section");
            Holder::new(&sections).map_err(|e| places.refuse(&format!("{table}.holder"), "", words(e)))
        });
        let own = t.cutting.clone().unwrap_or_default();
        let corner = t.corner_radius_mm.filter(|_| t.kind != ToolKind::Ball).map(|r| format!(" r {r}"));
        Ok(Self {
            kind: t.kind,
            number: t.number.unwrap_or(place),
            spec,
            cutter,
            cutting,
            shank,
            holder: holder.transpose()?,
            sections,
            teeth: t.teeth,
            plunges: t.plunges,
            words: t.name.clone().unwrap_or_else(|| {
                format!("{} {}{}", t.kind.word(), t.diameter_mm, corner.unwrap_or_default())
            }),
            feeding: raw::Cutting {
                spindle_rpm: own.spindle_rpm.or(all.spindle_rpm),
                feed_mm_min: own.feed_mm_min.or(all.feed_mm_min),
                air_feed_mm_min: own.air_feed_mm_min.or(all.air_feed_mm_min),
                feed_per_tooth_mm: own.feed_per_tooth_mm.or(all.feed_per_tooth_mm),
                coolant: own.coolant.or(all.coolant),
            },
        })
    }

    /// Its kind.
    #[must_use]
    pub const fn kind(&self) -> ToolKind {
        self.kind
    }

    /// Its number in the program.
    #[must_use]
    pub const fn number(&self) -> u32 {
        self.number
    }

    /// The cutter's description.
    #[must_use]
    pub const fn spec(&self) -> CutterSpec {
        self.spec
    }

    /// The cutter from the tip to the holder.
    #[must_use]
    pub const fn cutter(&self) -> Cutter {
        self.cutter
    }

    /// The part of the cutter that cuts, and the shank above it where the flutes end below the length.
    #[must_use]
    pub const fn flutes(&self) -> (Cutter, Option<Cutter>) {
        (self.cutting, self.shank)
    }

    /// Whether it may go straight down into material.
    #[must_use]
    pub const fn plunges(&self) -> bool {
        self.plunges
    }

    /// The holder.
    #[must_use]
    pub const fn holder(&self) -> Option<&Holder> {
        self.holder.as_ref()
    }

    /// The sections of the holder as the job has them, from the nose upwards; none where it has no holder.
    #[must_use]
    pub fn holder_sections(&self) -> &[HolderSpec] {
        &self.sections
    }

    /// Spindle and feed as given for it.
    pub(super) const fn feeding(&self) -> &raw::Cutting {
        &self.feeding
    }

    /// The spindle speed.
    #[must_use]
    pub const fn spindle_rpm(&self) -> Option<f64> {
        self.feeding.spindle_rpm
    }

    /// The coolant.
    #[must_use]
    pub fn coolant(&self) -> Option<Coolant> {
        self.feeding.coolant.and_then(control::coolant)
    }

    /// Number of teeth.
    #[must_use]
    pub const fn teeth(&self) -> Option<u32> {
        self.teeth
    }

    /// The tool in words, as tables show it.
    #[must_use]
    pub fn words(&self) -> &str {
        &self.words
    }
}

/// The part of a cutter that cuts, and the shank.
fn flutes(
    places: &Places,
    table: &str,
    whole: &Cutter,
    flute_mm: Option<f64>,
) -> Result<(Cutter, Option<Cutter>), Failure> {
    let Some(flute_mm) = flute_mm else { return Ok((*whole, None)) };
    let wrong =
        |why: String| places.refuse(table, "flute_length_mm", format!("flute_length_mm = {flute_mm}: {why}"));
    let shank_mm = whole.length_mm() - flute_mm;
    if shank_mm < 0.0 {
        return Err(wrong(format!("must lie between 0 and the length, {} mm", whole.length_mm())));
    }
    let short = whole.shortened(flute_mm).map_err(|e| wrong(e.to_string()))?;
    let shank = if shank_mm > 0.0 {
        Some(Cutter::cylinder(2.0 * whole.radius_mm(), shank_mm).map_err(|e| wrong(e.to_string()))?)
    } else {
        None
    };
    Ok((short, shank))
}

/// The cutter that a table describes.
fn spec(places: &Places, table: &str, t: &raw::Tool) -> Result<CutterSpec, Failure> {
    let kind = t.kind.word();
    let (needs, may) = KINDS.iter().find(|k| k.0 == t.kind).map_or((&[][..], &[][..]), |k| (k.1, k.2));
    let given = [
        ("corner_radius_mm", t.corner_radius_mm),
        ("taper_deg", t.taper_deg),
        ("tip_diameter_mm", t.tip_diameter_mm),
        ("barrel_radius_mm", t.barrel_radius_mm),
        ("bottom_angle_deg", t.bottom_angle_deg),
        ("side_angle_deg", t.side_angle_deg),
    ];
    for (key, value) in given {
        if value.is_none() && needs.contains(&key) {
            return Err(places.refuse(table, "kind", format!("kind = \"{kind}\" needs {key}")));
        }
        if value.is_some() && !needs.contains(&key) && !may.contains(&key) {
            let what = format!("{key} does not go with kind = \"{kind}\": leave it out");
            return Err(places.refuse(table, key, what));
        }
    }
    let diameter_mm = t.diameter_mm;
    let length_mm = t.length_mm.unwrap_or(DEFAULT_LENGTH * diameter_mm);
    let corner = t.corner_radius_mm.unwrap_or(0.0);
    let or_zero = |x: Option<f64>| x.unwrap_or(0.0);
    // A radius that the kind already says may be repeated, not contradicted.
    let fixed = |want: f64| match t.corner_radius_mm {
        Some(c) if (c - want).abs() > 1e-9 * diameter_mm => {
            let what = format!(
                "corner_radius_mm = {c} does not go with kind = \"{kind}\" of diameter {diameter_mm} mm: leave it \
                 out, make it {want}, or use kind = \"toroidal\""
            );
            Err(places.refuse(table, "corner_radius_mm", what))
        }
        _ => Ok(()),
    };
    Ok(match t.kind {
        ToolKind::Ball => {
            fixed(0.5 * diameter_mm)?;
            CutterSpec::Ball { diameter_mm, length_mm }
        }
        ToolKind::Flat => {
            fixed(0.0)?;
            CutterSpec::Flat { diameter_mm, length_mm }
        }
        ToolKind::Cylindrical => {
            fixed(0.0)?;
            CutterSpec::Cylindrical { diameter_mm, length_mm }
        }
        ToolKind::Toroidal => CutterSpec::Toroidal { diameter_mm, corner_radius_mm: corner, length_mm },
        ToolKind::Cone => CutterSpec::Cone {
            diameter_mm,
            taper_deg: or_zero(t.taper_deg),
            corner_radius_mm: corner,
            tip_diameter_mm: t.tip_diameter_mm,
            length_mm,
        },
        ToolKind::Barrel => CutterSpec::Barrel {
            diameter_mm,
            barrel_radius_mm: or_zero(t.barrel_radius_mm),
            corner_radius_mm: corner,
            length_mm,
        },
        ToolKind::Apt => CutterSpec::Apt {
            diameter_mm,
            corner_radius_mm: corner,
            bottom_angle_deg: or_zero(t.bottom_angle_deg),
            side_angle_deg: or_zero(t.side_angle_deg),
            length_mm,
        },
    })
}
