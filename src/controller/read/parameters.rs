//! Kinematic parameters: lines of a pattern with `<name>` and `<value>`, each name once.

use super::{Fault, lines};
use crate::units;

/// Lines of parameters.
#[derive(Debug, Clone, Copy)]
pub struct ParameterLines<'a> {
    /// The mark that begins a comment.
    pub comment: &'a str,
    /// The pattern of a parameter.
    pub line: &'a str,
    /// Patterns of lines that say what the parameters mean.
    pub structure: &'a [String],
    /// Patterns of other lines.
    pub others: &'a [String],
}

/// Larger numbers are no parameters of a machine.
const MAX_NUMBER: f64 = 1e9;

impl<'a> ParameterLines<'a> {
    /// Reads the numbers of these names, in their order.
    pub fn read(&self, names: &[&str], text: &str) -> Result<Vec<f64>, Fault> {
        let mut found: Vec<Option<f64>> = vec![None; names.len()];
        for (line, bare) in self.bare(text) {
            let parameter = self.parameter(bare);
            let known = parameter.as_ref().and_then(|(name, _)| names.iter().position(|known| known == name));
            let other = self.is_structure(bare) || self.others.iter().any(|other| lines::fits(other, bare));
            if known.is_none() && other {
                continue;
            }
            let strange = || Fault::new(line, "the controller would not understand this line");
            let (name, value) = parameter.ok_or_else(strange)?;
            let slot = known.ok_or_else(|| Fault::new(line, format!("`{name}` is no parameter of this machine")))?;
            let number = units::number(&value).map_err(|why| Fault::new(line, why.to_string()))?;
            if number.abs() > MAX_NUMBER {
                return Err(Fault::new(line, format!("{value} is no parameter of a machine")));
            }
            if found[slot].replace(number).is_some() {
                return Err(Fault::new(line, format!("`{name}` is set twice: the controller takes the last")));
            }
        }
        match found.iter().position(Option::is_none) {
            Some(missing) => {
                Err(Fault::new(0, format!("`{}` is not set: the controller keeps the old number", names[missing])))
            }
            None => Ok(found.into_iter().flatten().collect()),
        }
    }

    /// Refuses another structure than that of a text that was written for the machine.
    pub fn same_structure(&self, text: &str, written: &str) -> Result<(), Fault> {
        let mut wanted = self.bare(written).filter(|(_, line)| self.is_structure(line)).map(|(_, line)| line);
        for (line, bare) in self.bare(text).filter(|(_, line)| self.is_structure(line)) {
            let expected = wanted.next().unwrap_or("no such line");
            if bare != expected {
                return Err(Fault::new(
                    line,
                    format!("this machine has `{expected}` here: the numbers would mean something else"),
                ));
            }
        }
        wanted.next().map_or(Ok(()), |missing| Err(Fault::new(0, format!("the line `{missing}` is missing"))))
    }

    fn is_structure(&self, line: &str) -> bool {
        self.structure.iter().any(|pattern| lines::fits(pattern, line))
    }

    /// Lines without comments and blanks, with their indices; no empty ones.
    fn bare<'t>(&self, text: &'t str) -> impl Iterator<Item = (usize, &'t str)> + use<'t, 'a> {
        let comment = self.comment;
        let bare = move |line: &'t str| line.split(comment).next().unwrap_or_default().trim();
        let all = text.lines().enumerate().map(move |(n, line)| (n, bare(line)));
        all.filter(|(_, line)| !line.is_empty())
    }

    /// Name and value of a parameter's line.
    fn parameter(&self, line: &str) -> Option<(String, String)> {
        let fields = lines::fields(self.line, line)?;
        let field = |name: &str| fields.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone());
        Some((field("name")?, field("value")?))
    }
}
