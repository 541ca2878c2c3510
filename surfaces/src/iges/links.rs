//! Which entities an entity is made of.
//!
//! What nothing is made of is a root: roots are what a file gives, the rest belongs to them. Pointers to properties
//! and back to groups, which follow an entity's own parameters, do not count.

use super::directory::Entity;

/// Directory numbers that stand at `k`, `k + step`, ..., `count` of them.
fn every(e: &Entity, k: usize, step: usize, count: Option<f64>) -> Vec<i64> {
    let most = e.params.len().saturating_sub(k).div_ceil(step.max(1));
    let count = count.filter(|c| *c > 0.0).map_or(0, |c| c as usize).min(most);
    at(e, (0..count).map(|j| k + step * j))
}

fn at(e: &Entity, places: impl IntoIterator<Item = usize>) -> Vec<i64> {
    places
        .into_iter()
        .filter_map(|k| e.params.number(k))
        .filter(|p| *p != 0.0 && p.fract() == 0.0)
        .map(|p| p.abs() as i64)
        .collect()
}

/// Number of parameters that an entity of this kind has of its own, before pointers to groups, texts and properties.
/// `None` where the kind is not known or its counts lead beyond its parameters.
pub(crate) fn own_parameters(e: &Entity) -> Option<usize> {
    let n = |k: usize| e.params.number(k).filter(|x| *x >= 0.0 && x.fract() == 0.0).map(|x| x as usize);
    let own = match e.kind {
        108 => 9,
        114 => {
            let (m, n) = (n(2)?, n(3)?);
            m.checked_add(1)?
                .checked_mul(n.checked_add(1)?)?
                .checked_mul(48)?
                .checked_add(6 + m)?
                .checked_add(n)?
        }
        118 | 120 | 122 => 4,
        128 => {
            let (k1, k2, m1, m2) = (n(0)?, n(1)?, n(2)?, n(3)?);
            let poles = k1.checked_add(1)?.checked_mul(k2.checked_add(1)?)?;
            poles
                .checked_mul(4)?
                .checked_add(9 + 4 + 4)?
                .checked_add(k1)?
                .checked_add(m1)?
                .checked_add(k2)?
                .checked_add(m2)?
        }
        140 => 5,
        143 | 510 => n(if e.kind == 143 { 2 } else { 1 })?.checked_add(3)?,
        144 => n(2)?.checked_add(4)?,
        186 => n(2)?.checked_mul(2)?.checked_add(3)?,
        190 => 2 + e.form.clamp(0, 1) as usize,
        192 => 3 + e.form.clamp(0, 1) as usize,
        194 | 198 => 4 + e.form.clamp(0, 1) as usize,
        196 => 2 + 2 * e.form.clamp(0, 1) as usize,
        402 => n(0)?.checked_add(1)?,
        408 => 5,
        514 => n(0)?.checked_mul(2)?.checked_add(1)?,
        _ => return None,
    };
    (own <= e.params.len()).then_some(own)
}

/// Directory numbers of the entities that an entity is made of.
pub(crate) fn parts(e: &Entity) -> Vec<i64> {
    let n = |k: usize| e.params.number(k);
    match e.kind {
        102 => every(e, 1, 1, n(0)),
        108 => at(e, (e.form != 0).then_some(4)),
        118 | 120 => at(e, [0, 1]),
        122 => at(e, [0]),
        130 => at(e, [0, 2]),
        140 => at(e, [4]),
        141 => {
            let mut out = at(e, [2]);
            let mut k = 4;
            for _ in 0..n(3).unwrap_or(0.0).max(0.0) as usize {
                let Some(more) = n(k + 2) else { break };
                out.extend(at(e, [k]));
                out.extend(every(e, k + 3, 1, Some(more)));
                k = k.saturating_add(3).saturating_add(more.max(0.0) as usize);
            }
            out
        }
        142 => at(e, [1, 2, 3]),
        143 => [at(e, [1]), every(e, 3, 1, n(2))].concat(),
        144 => [at(e, [0, 3]), every(e, 4, 1, n(2))].concat(),
        162 | 164 => at(e, [0]),
        // Operations are small positive numbers, operands negative pointers.
        180 => at(e, (1..e.params.len()).filter(|k| n(*k).is_some_and(|p| p < 0.0))),
        184 => every(e, 1, 1, n(0)),
        186 => [at(e, [0]), every(e, 3, 2, n(2))].concat(),
        190 => at(e, [0, 1, 2]),
        192 => at(e, [0, 1, 3]),
        194 | 198 => at(e, [0, 1, 4]),
        196 => at(e, [0, 2, 3]),
        308 | 320 => every(e, 3, 1, n(2)),
        402 if matches!(e.form, 1 | 7 | 14 | 15) => every(e, 1, 1, n(0)),
        402 if e.form == 9 => every(e, 2, 1, n(1).map(|c| c + 1.0)),
        408 | 420 | 430 | 412 | 414 => at(e, [0]),
        504 => {
            let mut out = every(e, 1, 5, n(0));
            out.extend(every(e, 2, 5, n(0)));
            out.extend(every(e, 4, 5, n(0)));
            out
        }
        508 => {
            let mut out = Vec::new();
            let mut k = 1;
            for _ in 0..n(0).unwrap_or(0.0).max(0.0) as usize {
                let Some(more) = n(k + 4) else { break };
                out.extend(at(e, [k + 1]));
                out.extend(every(e, k + 6, 2, Some(more)));
                k = k.saturating_add(5).saturating_add(2_usize.saturating_mul(more.max(0.0) as usize));
            }
            out
        }
        510 => [at(e, [0]), every(e, 3, 1, n(1))].concat(),
        514 => every(e, 1, 2, n(0)),
        _ => Vec::new(),
    }
}
