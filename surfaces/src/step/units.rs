//! Units of length and angle and the uncertainty of length, by representation context.

use super::graph::{Args, Graph, Record, arg};
use std::collections::HashMap;

/// What the numbers of one representation context are worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Units {
    /// Millimetres in one unit of length.
    pub(crate) length_mm: f64,
    /// Radians in one unit of plane angle.
    pub(crate) angle_rad: f64,
    /// What the context calls its uncertainty of length, mm.
    pub(crate) uncertainty_mm: Option<f64>,
}

/// Units by context.
#[derive(Debug, Default)]
pub(crate) struct Contexts {
    units: Vec<Units>,
    names: Vec<String>,
    /// Index into `units` by the context's number.
    of: HashMap<u64, usize>,
}

/// Units that refer to units: conversion chains are one or two long.
const MAX_CHAIN: usize = 8;

impl Contexts {
    /// Reads all contexts.
    pub(crate) fn read(graph: &Graph<'_>) -> Self {
        let mut result = Self::default();
        for record in graph.structure() {
            if let Some(args) = record.part("GLOBAL_UNIT_ASSIGNED_CONTEXT")
                && let Some((units, name)) = assigned(graph, &record, &arg(&args, 0).list())
            {
                graph.get(record.id());
                result.of.insert(record.id(), result.units.len());
                result.units.push(units);
                result.names.push(name);
            }
        }
        result
    }

    /// The index of a context with units.
    pub(crate) fn index(&self, context: u64) -> Option<usize> {
        self.of.get(&context).copied()
    }

    /// The units of a context; those of the file's first one for none; millimetres and radians in a file without any.
    pub(crate) fn units(&self, context: Option<usize>) -> Units {
        let assumed = Units { length_mm: 1.0, angle_rad: 1.0, uncertainty_mm: None };
        self.units.get(context.unwrap_or(0)).copied().unwrap_or(assumed)
    }

    /// The names of the length units, without repetition.
    pub(crate) fn names(&self) -> String {
        let mut names: Vec<&str> = Vec::new();
        for name in &self.names {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        names.join(", ")
    }

    /// The largest uncertainty of length that a context states, mm.
    pub(crate) fn uncertainty_mm(&self) -> Option<f64> {
        self.units.iter().filter_map(|u| u.uncertainty_mm).reduce(f64::max)
    }
}

/// The units of a context, and the name of its length unit.
fn assigned(graph: &Graph<'_>, context: &Record<'_>, units: &Args<'_>) -> Option<(Units, String)> {
    let (mut length, mut angle_rad) = (None, 1.0);
    for id in units.references() {
        let Some(unit) = graph.get(id) else { continue };
        if unit.is("LENGTH_UNIT") || unit.is("SI_UNIT") && si_name(&unit) == "METRE" {
            length = length.or_else(|| measure(graph, id, 0).map(|m| (m, name(&unit))));
        } else if (unit.is("PLANE_ANGLE_UNIT") || si_name(&unit) == "RADIAN")
            && let Some(a) = measure(graph, id, 0)
        {
            angle_rad = a;
        }
    }
    let (length_mm, name) = length?;
    let stated = context.part("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT");
    let uncertainty_mm = stated.and_then(|args| {
        let found: Vec<f64> =
            arg(&args, 0).list().references().filter_map(|u| uncertainty(graph, u)).collect();
        found.into_iter().reduce(f64::max)
    });
    Some((Units { length_mm, angle_rad, uncertainty_mm }, name))
}

/// An UNCERTAINTY_MEASURE_WITH_UNIT of length, mm.
fn uncertainty(graph: &Graph<'_>, id: u64) -> Option<f64> {
    let record = graph.get(id)?;
    let args = record.part("MEASURE_WITH_UNIT").or_else(|| record.part("UNCERTAINTY_MEASURE_WITH_UNIT"))?;
    let unit = arg(&args, 1).reference()?;
    let is_length = graph.get(unit).is_some_and(|u| u.is("LENGTH_UNIT") || si_name(&u) == "METRE");
    let value = arg(&args, 0).number()? * measure(graph, unit, 0)?;
    (is_length && value > 0.0 && value.is_finite()).then_some(value)
}

fn si_name(unit: &Record<'_>) -> String {
    let Some(args) = unit.part("SI_UNIT") else { return String::new() };
    // A simple SI_UNIT has the derived dimensions in front: (*, prefix, name).
    args.iter().last().map_or_else(String::new, |v| v.choice())
}

/// The prefix of an SI_UNIT, empty for none.
fn prefix_of(unit: &Record<'_>) -> String {
    let Some(args) = unit.part("SI_UNIT") else { return String::new() };
    args.len().checked_sub(2).map_or_else(String::new, |k| arg(&args, k).choice())
}

fn si_prefix(unit: &Record<'_>) -> f64 {
    match prefix_of(unit).as_str() {
        "EXA" => 1e18,
        "PETA" => 1e15,
        "TERA" => 1e12,
        "GIGA" => 1e9,
        "MEGA" => 1e6,
        "KILO" => 1e3,
        "HECTO" => 1e2,
        "DECA" => 1e1,
        "DECI" => 1e-1,
        "CENTI" => 1e-2,
        "MILLI" => 1e-3,
        "MICRO" => 1e-6,
        "NANO" => 1e-9,
        "PICO" => 1e-12,
        "FEMTO" => 1e-15,
        "ATTO" => 1e-18,
        _ => 1.0,
    }
}

/// The value of a unit in millimetres or radians.
fn measure(graph: &Graph<'_>, id: u64, depth: usize) -> Option<f64> {
    if depth >= MAX_CHAIN {
        return None;
    }
    let unit = graph.get(id)?;
    if let Some(args) =
        unit.part("CONVERSION_BASED_UNIT").or_else(|| unit.part("CONVERSION_BASED_UNIT_WITH_OFFSET"))
    {
        // The factor is the reference among the last parameters that is a measure.
        let references: Vec<u64> = args.references().collect();
        let factor = references.into_iter().rev().find_map(|f| {
            let record = graph.get(f)?;
            record.part("MEASURE_WITH_UNIT").or_else(|| record.part_ending("MEASURE_WITH_UNIT"))
        })?;
        let value = arg(&factor, 0).number()?;
        let base = measure(graph, arg(&factor, 1).reference()?, depth + 1)?;
        let whole = value * base;
        return (whole > 0.0 && whole.is_finite()).then_some(whole);
    }
    // In this order a millimetre is exactly one.
    let base = if si_name(&unit) == "METRE" { 1000.0 } else { 1.0 };
    unit.is("SI_UNIT").then(|| si_prefix(&unit) * base)
}

/// A readable name of a length unit.
fn name(unit: &Record<'_>) -> String {
    if let Some(args) =
        unit.part("CONVERSION_BASED_UNIT").or_else(|| unit.part("CONVERSION_BASED_UNIT_WITH_OFFSET"))
        && let Some(text) = args.iter().map(|v| v.text()).find(|t| !t.is_empty())
    {
        return text.to_lowercase();
    }
    let prefix = prefix_of(unit).to_lowercase();
    format!("{prefix}metre")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contexts(text: &str) -> Contexts {
        let whole = format!("{text}END-ISO-10303-21;");
        Contexts::read(&Graph::read(whole.as_bytes(), 0))
    }

    #[test]
    fn inch_degree_and_several_contexts() {
        let c = contexts(
            "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\
             #2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#1);\
             #3=(CONVERSION_BASED_UNIT('INCH',#2)LENGTH_UNIT()NAMED_UNIT(#9));\
             #4=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\
             #5=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.0174532925),#4);\
             #6=(CONVERSION_BASED_UNIT('DEGREE',#5)NAMED_UNIT(*)PLANE_ANGLE_UNIT());\
             #7=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-2),#3,'','');\
             #10=(GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#7))GLOBAL_UNIT_ASSIGNED_CONTEXT((#3,#6)));\
             #11=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#4))REPRESENTATION_CONTEXT('',''));",
        );
        let inch = Units { length_mm: 25.4, angle_rad: 0.017_453_292_5, uncertainty_mm: Some(0.01 * 25.4) };
        assert_eq!((c.units(c.index(10)), c.units(None)), (inch, inch));
        let metric = Units { length_mm: 1.0, angle_rad: 1.0, uncertainty_mm: None };
        assert_eq!(c.units(c.index(11)), metric);
        assert_eq!(c.names(), "inch, millimetre");
        assert_eq!(c.uncertainty_mm(), Some(0.01 * 25.4));
    }

    #[test]
    fn circular_conversions_end() {
        let c = contexts(
            "#2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.),#3);\
             #3=(CONVERSION_BASED_UNIT('X',#2)LENGTH_UNIT()NAMED_UNIT(*));\
             #10=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#3))REPRESENTATION_CONTEXT('',''));",
        );
        assert_eq!(c.names(), "");
        assert_eq!(c.units(None).length_mm, 1.0);
    }
}
