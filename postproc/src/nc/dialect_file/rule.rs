//! Rules of a dialect file: which line of the engine is worded how.

use super::error::DialectFileError;
use super::pattern::Pattern;
use super::spec::RuleSpec;

/// What becomes of a line.
#[derive(Clone, Debug)]
pub(super) enum Then {
    Words(Vec<Pattern>),
    Refused(String),
}

#[derive(Clone, Debug)]
pub(super) struct Rule {
    pub engine: Pattern,
    pub then: Then,
}

/// Rules of a file, each checked: what it writes can be read back.
pub(super) fn rules(specs: &[RuleSpec]) -> Result<Vec<Rule>, DialectFileError> {
    let rules: Vec<Rule> = specs.iter().enumerate().map(|(k, r)| rule(k + 1, r)).collect::<Result<_, _>>()?;
    for (k, one) in rules.iter().enumerate() {
        let Some(said) = one.first() else { continue };
        if let Some(other) = rules[..k].iter().position(|r| r.first().is_some_and(|w| w.same(said))) {
            let what = format!("rule {} says the same: a program could not be read back", other + 1);
            return Err(DialectFileError::Rule { rule: k + 1, engine: specs[k].engine.clone(), what });
        }
    }
    Ok(rules)
}

impl Rule {
    /// The line that stands for the engine's.
    fn first(&self) -> Option<&Pattern> {
        match &self.then {
            Then::Words(words) => words.first(),
            Then::Refused(_) => None,
        }
    }
}

fn rule(number: usize, spec: &RuleSpec) -> Result<Rule, DialectFileError> {
    let bad = |what: String| DialectFileError::Rule { rule: number, engine: spec.engine.clone(), what };
    let engine = Pattern::new(&spec.engine).map_err(bad)?;
    let then = match (&spec.words, &spec.refused) {
        (Some(_), Some(_)) | (None, None) => return Err(bad("give words or refused, one of them".into())),
        (None, Some(why)) => Then::Refused(why.clone()),
        (Some(words), None) => {
            let words: Vec<Pattern> =
                words.iter().map(|w| Pattern::new(w)).collect::<Result<_, _>>().map_err(bad)?;
            if let Some(first) = words.first()
                && first.names() != engine.names()
            {
                let what = format!(
                    "the first line of words has {{{}}}, the engine's has {{{}}}: with other names it could not be read back",
                    first.names().join("}, {"),
                    engine.names().join("}, {")
                );
                return Err(bad(what));
            }
            let known = |w: &Pattern| w.names().iter().all(|n| engine.names().contains(n));
            if !words.iter().all(known) {
                return Err(bad("words has a name that the engine's line has not".into()));
            }
            Then::Words(words)
        }
    };
    Ok(Rule { engine, then })
}
