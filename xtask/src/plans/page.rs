//! The page of plans: a table of all plans of each face, and one of where the time of `auto` goes.

/// Between the two tables.
const WHERE: &str = "\n## Where the time goes\n\nOf the plans by `auto` above, and of whole parts by the lists of operations in `examples` (their finishing and rest cutting together, each face \
once in the ideal, less what is left standing, with whichever of their tools is quickest there): the *ideal*, an estimate of the least time of any plan; strips of the chosen tool *along its lines*, with the least lead that fits at each place and none that overlap; \
the estimate for *isoparametric* passes, each as wide as its narrowest place, in up to four regions; the length of *its path* over the job's feed; its feed moves *by feed words*, which joints slow down; \
the same *on the control*, with accelerations and corners; and *all* of the program on the control, of whole parts with roughing and tool changes. Minutes.\n\n\
| face or part | tool | ideal | along its lines | isoparametric | its path | by feed words | on the control | all | ideal over feed words % | within |\n\
|---|---|---|---|---|---|---|---|---|---|---|\n";

/// Names of faces, in the order of the page, and of whole parts after them.
#[derive(Clone, Copy)]
pub struct Names<'a> {
    /// Of faces.
    pub faces: &'a [&'a str],
    /// Of whole parts.
    pub parts: &'a [&'a str],
}

impl<'a> Names<'a> {
    fn all(self) -> Vec<&'a str> {
        self.faces.iter().chain(self.parts).copied().collect()
    }
}

/// Rows of the page by what they are of.
#[derive(Default)]
pub struct Page {
    table: Vec<(String, String)>,
    times: Vec<(String, String)>,
}

/// The rows of one table by their first cell, each with the line of shares below it.
fn rows(text: &str, names: &[&str]) -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        let cell = line.strip_prefix("| ").and_then(|rest| rest.split(" | ").next()).unwrap_or("");
        let share = line.starts_with("| | ");
        match names.iter().find(|name| **name == cell) {
            Some(name) => {
                inside = true;
                match out.iter_mut().find(|(n, _)| n == name) {
                    Some((_, rows)) => *rows += &format!("{line}\n"),
                    None => out.push(((*name).to_owned(), format!("{line}\n"))),
                }
            }
            None if inside && share => {
                if let Some((_, rows)) = out.last_mut() {
                    *rows += &format!("{line}\n");
                }
            }
            None => inside = false,
        }
    }
    out
}

fn set(of: &mut Vec<(String, String)>, name: &str, rows: String) {
    of.retain(|(n, _)| n != name);
    of.push((name.to_owned(), rows));
}

impl Page {
    /// What stands on a page.
    pub fn read(text: &str, names: Names<'_>) -> Self {
        let (first, second) = text.split_once("\n## Where the time goes").unwrap_or((text, ""));
        Self { table: rows(first, names.faces), times: rows(second, &names.all()) }
    }

    /// New rows of a face in place of those that there were.
    pub fn set_plans(&mut self, face: &str, rows: String) {
        set(&mut self.table, face, rows);
    }

    /// The row that says where the time of a face or part goes.
    pub fn set_times(&mut self, name: &str, row: String) {
        set(&mut self.times, name, row);
    }

    /// All of it, with a head and what stands at the end: which rows an earlier run made is said.
    pub fn text(&self, head: &str, names: Names<'_>, made: [&[&str]; 2], end: &str) -> String {
        let all = names.all();
        let [table, times] = [(&self.table, names.faces, made[0]), (&self.times, &all[..], made[1])].map(
            |(of, names, made): (&Vec<(String, String)>, &[&str], &[&str])| {
                let (mut out, mut kept, mut missing) = (String::new(), Vec::new(), Vec::new());
                for name in names {
                    match of.iter().find(|(n, _)| n == name) {
                        Some((_, rows)) => {
                            out += rows;
                            if !made.contains(name) {
                                kept.push(*name);
                            }
                        }
                        None => missing.push(*name),
                    }
                }
                let list = |what: &str, names: &[&str]| match names {
                    [] => String::new(),
                    names => format!("\n{what}: {}.\n", names.join("; ")),
                };
                out + &list("Rows of an earlier run", &kept) + &list("Not in the table yet", &missing)
            },
        );
        format!("{head}{table}{WHERE}{times}{end}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_other_cases_stay_on_the_page() {
        let rows = |of: &str, time: &str| format!("| {of} | auto | {time} |\n| | *share* | 1.00 |\n");
        let parts = Names { faces: &["m86-1", "m86-2", "impeller hub"], parts: &["a part"] };
        let mut page = Page::read("", parts);
        page.set_plans("m86-2", rows("m86-2", "1"));
        let first = page.text("head\n", parts, [&["m86-2"], &[]], "end");
        let mut page = Page::read(&first, parts);
        page.set_plans("m86-1", rows("m86-1", "2"));
        page.set_times("a part", "| a part | 7 |\n".to_owned());
        page.set_times("m86-1", "| m86-1 | 6 |\n".to_owned());
        let second = page.text("head\n", parts, [&["m86-1"], &["a part", "m86-1"]], "end");
        assert!(second.contains(&(rows("m86-1", "2") + &rows("m86-2", "1"))), "{second}");
        assert!(second.contains("Rows of an earlier run: m86-2.") && second.contains("impeller hub"));
        assert!(second.contains("| m86-1 | 6 |\n| a part | 7 |\n"), "{second}");
        let mut page = Page::read(&second, parts);
        page.set_plans("m86-2", rows("m86-2", "3"));
        let third = page.text("head\n", parts, [&["m86-1", "m86-2"], &[]], "end");
        assert!(third.contains("| m86-2 | auto | 3 |") && !third.contains("| m86-2 | auto | 1 |"));
        assert_eq!(third.matches("Rows of an earlier run: m86-1; a part.").count(), 1);
        assert_eq!(third.matches("earlier run").count(), 1);
        assert_eq!(third.matches("| m86-1 | ").count(), 2);
    }
}
