//! Setting a value in the tables of a job by its path, such as `tool.diameter_mm` or `tools[2].teeth`.

use toml::{Table, Value};

/// A step on the way to a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// Into a table.
    Key(String),
    /// Into a list, from 1 on.
    Place(usize),
}

/// The steps of a path.
///
/// # Errors
/// What is wrong with it.
pub fn steps(path: &str) -> Result<Vec<Step>, String> {
    let wrong = || format!("key = {path:?} is no path: write it as tool.diameter_mm or tools[2].teeth");
    let mut out = Vec::new();
    for part in path.split('.') {
        let (key, places) = part.split_once('[').map_or((part, None), |(key, rest)| (key, Some(rest)));
        if key.is_empty() || !key.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-')) {
            return Err(wrong());
        }
        out.push(Step::Key(key.to_owned()));
        if let Some(rest) = places {
            let inner = rest.strip_suffix(']').ok_or_else(wrong)?;
            for place in inner.split("][") {
                match place.parse() {
                    Ok(k) if k > 0 => out.push(Step::Place(k)),
                    _ => return Err(wrong()),
                }
            }
        }
    }
    Ok(out)
}

/// Sets a value; tables on the way are made where there are none.
///
/// # Errors
/// Where the way leads through a value that is none, or beyond the end of a list.
pub fn set(table: &mut Table, steps: &[Step], value: &Value) -> Result<(), String> {
    let Some((Step::Key(key), rest)) = steps.split_first() else { return Err("no key".to_owned()) };
    if rest.is_empty() {
        table.insert(key.clone(), value.clone());
        return Ok(());
    }
    let fresh = || Value::Table(Table::new());
    set_in(table.entry(key.clone()).or_insert_with(fresh), (key, rest), value)
}

/// As [`set`] in what stands under a name.
fn set_in(at: &mut Value, (name, rest): (&str, &[Step]), value: &Value) -> Result<(), String> {
    match (at, rest) {
        (at, []) => {
            *at = value.clone();
            Ok(())
        }
        (Value::Table(table), [Step::Key(_), ..]) => set(table, rest, value),
        (Value::Array(all), [Step::Place(k), rest @ ..]) => {
            let count = all.len();
            let one = all.get_mut(k - 1);
            let one = one.ok_or_else(|| format!("{name}[{k}] is not there: the job has {count}"))?;
            set_in(one, (&format!("{name}[{k}]"), rest), value)
        }
        (_, [Step::Key(_), ..]) => Err(format!("{name} is no table in the job")),
        (_, [Step::Place(_), ..]) => Err(format!("{name} is no list in the job")),
    }
}

/// All strings in a value.
pub fn strings<'a>(value: &'a Value, out: &mut Vec<&'a str>) {
    match value {
        Value::String(s) => out.push(s),
        Value::Array(all) => all.iter().for_each(|v| strings(v, out)),
        Value::Table(table) => table.values().for_each(|v| strings(v, out)),
        _ => {}
    }
}

/// Whether a string stands somewhere in a table.
pub fn names(table: &Table, name: &str) -> bool {
    fn within(value: &Value, name: &str) -> bool {
        match value {
            Value::String(s) => s == name,
            Value::Array(all) => all.iter().any(|v| within(v, name)),
            Value::Table(table) => names(table, name),
            _ => false,
        }
    }
    table.values().any(|v| within(v, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_leads_into_tables_and_lists() {
        let mut job: Table =
            "[tool]\nteeth = 2\n[[tools]]\nteeth = 3\n[[tools]]\nteeth = 4\n".parse().unwrap();
        let mut put = |path: &str, value: i64| set(&mut job, &steps(path)?, &Value::Integer(value));
        put("tool.teeth", 5).unwrap();
        put("tools[2].teeth", 6).unwrap();
        put("cutting.spindle_rpm", 7).unwrap();
        assert_eq!(put("tools[3].teeth", 1), Err("tools[3] is not there: the job has 2".to_owned()));
        assert_eq!(put("tool.teeth.more", 1), Err("teeth is no table in the job".to_owned()));
        assert_eq!(put("tool[1]", 1), Err("tool is no list in the job".to_owned()));
        for wrong in ["", "tool.", ".tool", "tools[0]", "tools[x]", "tools[1", "a b"] {
            assert!(put(wrong, 1).unwrap_err().contains("is no path"), "{wrong}");
        }
        let whole: Table =
            "cutting = { spindle_rpm = 7 }\ntool = { teeth = 5 }\ntools = [{ teeth = 3 }, { teeth = 6 }]\n"
                .parse()
                .unwrap();
        assert_eq!(job, whole);
    }

    #[test]
    fn strings_are_found_wherever_they_stand() {
        let job: Table = "a = 'x'\n[b]\nc = ['y', { d = 'z' }]\ne = 3\n".parse().unwrap();
        assert!(["x", "y", "z"].iter().all(|s| names(&job, s)) && !names(&job, "3"));
        let mut all = Vec::new();
        job.values().for_each(|v| strings(v, &mut all));
        all.sort_unstable();
        assert_eq!(all, ["x", "y", "z"]);
    }
}
