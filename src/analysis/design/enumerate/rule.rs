//! Rules that an arrangement has to satisfy, a few words each.
//!
//! ```text
//! rule  = [not] (AXIS before AXIS | AXIS carries AXIS | AXIS on side | (at most | at least) N on side)
//! side  = table | tool
//! ```
//!
//! `before` is along the walk from workpiece to tool, as a chain is written; `carries` is from the bed
//! outwards, on one side of it. A rule about an axis that an arrangement does without holds there.

use crate::machine::{AxisName, Branch};
use std::fmt;

/// A rule for every arrangement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rule {
    negated: bool,
    clause: Clause,
}

/// The reason why a text is not a rule.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct RuleFailure(pub String);

#[derive(Debug, Clone, PartialEq, Eq)]
enum Clause {
    Before(AxisName, AxisName),
    Carries(AxisName, AxisName),
    On(AxisName, Branch),
    AtMost(usize, Branch),
    AtLeast(usize, Branch),
}

impl Rule {
    /// Returns the rule that a text states about axes of the chain. Fails with the reason.
    pub fn parse(text: &str, axes: &[&AxisName]) -> Result<Self, RuleFailure> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let (negated, words) = match words.split_first() {
            Some((&"not", rest)) => (true, rest),
            _ => (false, &words[..]),
        };
        let axis = |word: &str| {
            let found = axes.iter().find(|name| name.as_str() == word).map(|name| (*name).clone());
            found.ok_or_else(|| {
                let known: Vec<&str> = axes.iter().map(|name| name.as_str()).collect();
                RuleFailure(format!("`{word}` is no axis of the chain; its axes are {}", known.join(", ")))
            })
        };
        let number =
            |word: &str| word.parse::<usize>().map_err(|_| RuleFailure(format!("`{word}` is not a number of axes")));
        let clause = match words {
            [a, "before", b] => Clause::Before(axis(a)?, axis(b)?),
            [a, "carries", b] => Clause::Carries(axis(a)?, axis(b)?),
            [a, "on", side] => Clause::On(axis(a)?, branch(side)?),
            ["at", "most", n, "on", side] => Clause::AtMost(number(n)?, branch(side)?),
            ["at", "least", n, "on", side] => Clause::AtLeast(number(n)?, branch(side)?),
            _ => return Err(RuleFailure(format!("`{text}` is not a rule"))),
        };
        Ok(Self { negated, clause })
    }

    /// True if it holds for the walk whose first `table` axes carry the workpiece.
    pub fn holds(&self, walk: &[&AxisName], table: usize) -> bool {
        let place = |name: &AxisName| walk.iter().position(|other| *other == name);
        let count = |side: Branch| if side == Branch::Workpiece { table } else { walk.len() - table };
        let holds = match &self.clause {
            Clause::Before(a, b) => place(a).zip(place(b)).map(|(a, b)| a < b),
            Clause::Carries(a, b) => place(a).zip(place(b)).map(|(a, b)| {
                // The bed stands before the axis with the index `table`.
                if a < table { b < a } else { b > a }
            }),
            Clause::On(a, side) => place(a).map(|a| (a < table) == (*side == Branch::Workpiece)),
            Clause::AtMost(n, side) => Some(count(*side) <= *n),
            Clause::AtLeast(n, side) => Some(count(*side) >= *n),
        };
        holds.is_none_or(|holds| holds != self.negated)
    }
}

fn branch(word: &str) -> Result<Branch, RuleFailure> {
    match word {
        "table" | "workpiece" => Ok(Branch::Workpiece),
        "tool" | "head" => Ok(Branch::Tool),
        _ => Err(RuleFailure(format!("`{word}` is no side of the machine: `table` or `tool`"))),
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = |side: &Branch| if *side == Branch::Workpiece { "table" } else { "tool" };
        if self.negated {
            f.write_str("not ")?;
        }
        match &self.clause {
            Clause::Before(a, b) => write!(f, "{a} before {b}"),
            Clause::Carries(a, b) => write!(f, "{a} carries {b}"),
            Clause::On(a, branch) => write!(f, "{a} on {}", side(branch)),
            Clause::AtMost(n, branch) => write!(f, "at most {n} on {}", side(branch)),
            Clause::AtLeast(n, branch) => write!(f, "at least {n} on {}", side(branch)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_mean_what_they_say() {
        let names: Vec<AxisName> = ["C", "A", "Y", "X", "Z"].iter().filter_map(|n| AxisName::new(n)).collect();
        let walk: Vec<&AxisName> = names.iter().collect();
        // w C' A' Y' b X Z t
        let holds = |text: &str| Rule::parse(text, &walk).unwrap().holds(&walk, 3);
        for text in ["C before A", "A before Z", "A carries C", "Y carries A", "X carries Z", "C on table", "Z on tool"]
        {
            assert!(holds(text) && !holds(&format!("not {text}")), "{text}");
        }
        for text in ["Z before X", "C carries A", "X carries Y", "Y carries X", "C on tool", "at most 2 on table"] {
            assert!(!holds(text) && holds(&format!("not {text}")), "{text}");
        }
        assert!(holds("at least 3 on table") && holds("at most 2 on head"));
        for text in ["", "C", "C befor A", "B before C", "at most x on table", "at most 2 on bed", "not not C on table"]
        {
            assert!(Rule::parse(text, &walk).is_err(), "{text}");
        }
        let text = "not at most 2 on table";
        assert_eq!(Rule::parse(text, &walk).unwrap().to_string(), text);
        // Without A there is nothing to be before.
        let rule = Rule::parse("C before A", &walk).unwrap();
        assert!(rule.holds(&[&names[0]], 0));
    }
}
