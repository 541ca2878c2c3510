//! Length and angle units: which context a face belongs to and what its numbers are worth.

use super::graph::{Graph, Record, Value, arg};
use std::collections::HashMap;

/// What the numbers of one representation context are worth.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Units {
    /// Millimetres in one unit of length.
    pub(crate) length_mm: f64,
    /// Radians in one unit of plane angle.
    pub(crate) angle_rad: f64,
    /// The length unit's name.
    pub(crate) name: String,
}

/// Units by context, and the context of each face.
#[derive(Debug, Default)]
pub(crate) struct Contexts {
    units: Vec<Units>,
    /// Index into `units` by face.
    of_face: HashMap<u64, usize>,
}

/// Units that refer to units: conversion chains are one or two long.
const MAX_CHAIN: usize = 8;

impl Contexts {
    /// Reads all contexts and follows every representation to its faces.
    pub(crate) fn read(graph: &Graph) -> Self {
        let mut contexts: HashMap<u64, usize> = HashMap::new();
        let mut result = Self::default();
        for (id, record) in &graph.records {
            if let Some(args) = record.part("GLOBAL_UNIT_ASSIGNED_CONTEXT")
                && let Some(units) = assigned(graph, arg(args, 0).list())
            {
                contexts.insert(*id, result.units.len());
                result.units.push(units);
            }
        }
        let mut visited = std::collections::HashSet::new();
        for (_, record) in &graph.records {
            let Some((items, context)) = representation(record, &contexts) else { continue };
            let mut stack: Vec<u64> = items.iter().filter_map(Value::reference).collect();
            while let Some(id) = stack.pop() {
                if !visited.insert(id) {
                    continue;
                }
                let Some(r) = graph.get(id) else { continue };
                if is_face(r) {
                    result.of_face.insert(id, context);
                } else if representation(r, &contexts).is_none() {
                    stack.extend(r.references());
                }
            }
        }
        result
    }

    /// The units of a face; those of the file's first context where it belongs to none; millimetres and radians in
    /// a file without any.
    pub(crate) fn of(&self, face: u64) -> Units {
        let index = self.of_face.get(&face).copied().unwrap_or(0);
        self.units.get(index).cloned().unwrap_or(Units {
            length_mm: 1.0,
            angle_rad: 1.0,
            name: "none stated, mm assumed".into(),
        })
    }

    /// The names of the length units, without repetition.
    pub(crate) fn names(&self) -> String {
        let mut names: Vec<&str> = Vec::new();
        for u in &self.units {
            if !names.contains(&u.name.as_str()) {
                names.push(&u.name);
            }
        }
        names.join(", ")
    }
}

/// Whether a record is a face with a surface.
pub(crate) fn is_face(record: &Record) -> bool {
    record.is("ADVANCED_FACE") || record.is("FACE_SURFACE")
}

/// Items and context of a representation.
fn representation<'a>(record: &'a Record, contexts: &HashMap<u64, usize>) -> Option<(&'a [Value], usize)> {
    for (_, args) in &record.parts {
        if args.len() >= 3
            && let Some(context) = args[2].reference().and_then(|c| contexts.get(&c))
        {
            return Some((args[1].list(), *context));
        }
    }
    None
}

/// The units of a context.
fn assigned(graph: &Graph, units: &[Value]) -> Option<Units> {
    let (mut length, mut angle_rad) = (None, 1.0);
    for id in units.iter().filter_map(Value::reference) {
        let Some(unit) = graph.get(id) else { continue };
        if unit.is("LENGTH_UNIT") || unit.is("SI_UNIT") && si_name(unit) == "METRE" {
            length = length.or_else(|| measure(graph, id, 0).map(|m| (m, name(unit))));
        } else if (unit.is("PLANE_ANGLE_UNIT") || si_name(unit) == "RADIAN")
            && let Some(a) = measure(graph, id, 0)
        {
            angle_rad = a;
        }
    }
    length.map(|(length_mm, name)| Units { length_mm, angle_rad, name })
}

fn si_name(unit: &Record) -> &str {
    let Some(args) = unit.part("SI_UNIT") else { return "" };
    // A simple SI_UNIT has the derived dimensions in front: (*, prefix, name).
    match args.last() {
        Some(Value::Enum(e)) => e,
        _ => "",
    }
}

/// The prefix of an SI_UNIT, empty for none.
fn prefix_of(unit: &Record) -> &str {
    let Some(args) = unit.part("SI_UNIT") else { return "" };
    match args.len().checked_sub(2).map(|k| &args[k]) {
        Some(Value::Enum(e)) => e,
        _ => "",
    }
}

fn si_prefix(unit: &Record) -> f64 {
    match prefix_of(unit) {
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
fn measure(graph: &Graph, id: u64, depth: usize) -> Option<f64> {
    if depth >= MAX_CHAIN {
        return None;
    }
    let unit = graph.get(id)?;
    if let Some(args) =
        unit.part("CONVERSION_BASED_UNIT").or_else(|| unit.part("CONVERSION_BASED_UNIT_WITH_OFFSET"))
    {
        // The factor is the reference among the last parameters that is a measure.
        let factor = args.iter().rev().filter_map(Value::reference).find_map(|f| {
            let r = graph.get(f)?;
            r.parts.iter().find(|p| p.0.ends_with("MEASURE_WITH_UNIT")).map(|p| p.1.as_slice())
        })?;
        let value = arg(factor, 0).number()?;
        let base = measure(graph, arg(factor, 1).reference()?, depth + 1)?;
        let whole = value * base;
        return (whole > 0.0 && whole.is_finite()).then_some(whole);
    }
    // In this order a millimetre is exactly one.
    let base = if si_name(unit) == "METRE" { 1000.0 } else { 1.0 };
    unit.is("SI_UNIT").then(|| si_prefix(unit) * base)
}

/// A readable name of a length unit.
fn name(unit: &Record) -> String {
    if let Some(args) =
        unit.part("CONVERSION_BASED_UNIT").or_else(|| unit.part("CONVERSION_BASED_UNIT_WITH_OFFSET"))
        && let Some(text) = args.iter().map(Value::text).find(|t| !t.is_empty())
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
        Contexts::read(&Graph::read(format!("{text}END-ISO-10303-21;").as_bytes(), 0))
    }

    #[test]
    fn inch_degree_and_per_face_contexts() {
        let c = contexts(
            "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\
             #2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#1);\
             #3=(CONVERSION_BASED_UNIT('INCH',#2)LENGTH_UNIT()NAMED_UNIT(#9));\
             #4=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\
             #5=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.0174532925),#4);\
             #6=(CONVERSION_BASED_UNIT('DEGREE',#5)NAMED_UNIT(*)PLANE_ANGLE_UNIT());\
             #10=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#3,#6))REPRESENTATION_CONTEXT('',''));\
             #11=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#4))REPRESENTATION_CONTEXT('',''));\
             #20=ADVANCED_FACE('',(),#99,.T.);#21=ADVANCED_FACE('',(),#99,.T.);\
             #22=OPEN_SHELL('',(#20));#23=OPEN_SHELL('',(#21));\
             #30=SHAPE_REPRESENTATION('',(#22),#10);#31=SHAPE_REPRESENTATION('',(#23),#11);",
        );
        assert_eq!(c.of(20), Units { length_mm: 25.4, angle_rad: 0.017_453_292_5, name: "inch".into() });
        assert_eq!(c.of(21), Units { length_mm: 1.0, angle_rad: 1.0, name: "millimetre".into() });
        assert_eq!(c.names(), "inch, millimetre");
    }

    #[test]
    fn circular_conversions_end() {
        let c = contexts(
            "#2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.),#3);\
             #3=(CONVERSION_BASED_UNIT('X',#2)LENGTH_UNIT()NAMED_UNIT(*));\
             #10=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#3))REPRESENTATION_CONTEXT('',''));",
        );
        assert_eq!(c.names(), "");
        assert_eq!(c.of(1).length_mm, 1.0);
    }
}
