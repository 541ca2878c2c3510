//! The strategy that a job's `[strategy]` table names.

use crate::failure::Failure;
use crate::job::{Job, LeadKey};
use osculate_geom::{Axis, Unit3, Vec3};
use osculate_productivity::plan::{Along, Strategy};

/// The strategy of a job.
///
/// # Errors
/// Names the key that is wrong and what it may be.
pub fn of_job(job: &Job) -> Result<Strategy, Failure> {
    let table = &job.strategy;
    let strategy = match table.kind.as_str() {
        "auto" | "isoparametric" => Strategy::Isoparametric { along: along(job)? },
        "regions" => Strategy::Regions { along: along(job)? },
        "contour_2cl" => Strategy::Contour2cl { axis: job.contour_axis()? },
        "isoplanar" => Strategy::Isoplanar { normal: normal(job)? },
        "isoscallop" => Strategy::Isoscallop,
        "streamline" => Strategy::Streamline,
        "curvature_5c" => Strategy::Curvature5c,
        other => {
            return Err(Failure::file(
                &job.path,
                format!(
                    "[strategy] kind = \"{other}\" is not available: use \"auto\", \"isoparametric\", \"regions\", \
                     \"isoplanar\", \"isoscallop\", \"streamline\", \"curvature_5c\", \"contour_2cl\", \"gradient_3c\", \
                     \"isoplanar_3c\" or \"z_level\""
                ),
            ));
        }
    };
    let leans = table.lead_deg == LeadKey::Local
        || matches!(table.lead_deg, LeadKey::Given(l) if l != 0.0)
        || table.tilt_deg != 0.0;
    if strategy.fixed_axis().is_some() && leans {
        return Err(Failure::file(
            &job.path,
            format!(
                "[strategy] {} keeps the tool axis on `axis`: leave out lead_deg and tilt_deg",
                strategy.name()
            ),
        ));
    }
    Ok(strategy)
}

fn along(job: &Job) -> Result<Along, Failure> {
    match job.strategy.along.as_str() {
        "auto" => Ok(Along::Auto),
        "u" => Ok(Along::Fixed(Axis::U)),
        "v" => Ok(Along::Fixed(Axis::V)),
        other => Err(Failure::file(
            &job.path,
            format!("[strategy] along = \"{other}\" must be \"u\", \"v\" or \"auto\""),
        )),
    }
}

/// The normal of the planes that isoplanar passes lie in.
fn normal(job: &Job) -> Result<Unit3, Failure> {
    let n = job.strategy.normal.unwrap_or([0.0, 1.0, 0.0]);
    Unit3::try_new(Vec3::from(n), 1e-9)
        .filter(|u| u.iter().all(|c| c.is_finite()))
        .ok_or_else(|| Failure::file(&job.path, format!("[strategy] normal = {n:?} has no direction")))
}
