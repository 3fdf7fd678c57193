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
    /// Patterns of other lines.
    pub others: &'a [String],
}

/// Larger numbers are no parameters of a machine.
const MAX_NUMBER: f64 = 1e9;

impl ParameterLines<'_> {
    /// Reads the numbers of these names, in their order.
    pub fn read(&self, names: &[&str], text: &str) -> Result<Vec<f64>, Fault> {
        let mut found: Vec<Option<f64>> = vec![None; names.len()];
        for (line, content) in text.lines().enumerate() {
            let bare = content.split(self.comment).next().unwrap_or_default().trim();
            if bare.is_empty() {
                continue;
            }
            let Some((name, value)) = self.parameter(bare) else {
                if self.others.iter().any(|other| lines::fits(other, bare)) {
                    continue;
                }
                return Err(Fault::new(line, "the controller would not understand this line"));
            };
            let known = names.iter().position(|known| *known == name);
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

    /// Name and value of a parameter's line.
    fn parameter(&self, line: &str) -> Option<(String, String)> {
        let fields = lines::fields(self.line, line)?;
        let field = |name: &str| fields.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone());
        Some((field("name")?, field("value")?))
    }
}
