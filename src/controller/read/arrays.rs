//! Constant arrays of C, read back as a compiler would: `static const double NAME[N] = { ... };`.

use super::Fault;
use crate::units;
use std::collections::BTreeMap;

/// The arrays of a text by name, flattened, with the line (from 0) of each.
#[derive(Debug, Clone, Default)]
pub struct Arrays(BTreeMap<String, (usize, Vec<f64>)>);

/// A word, a number or a sign, with its line.
type ArrayToken<'a> = (usize, &'a str);

impl Arrays {
    /// Reads every array; anything else but comments and preprocessor lines is refused.
    pub fn read(text: &str) -> Result<Self, Fault> {
        let clean = without_comments(text)?;
        let tokens = tokens(&clean);
        let mut arrays = Self::default();
        let mut rest = tokens.as_slice();
        while !rest.is_empty() {
            rest = arrays.statement(rest)?;
        }
        Ok(arrays)
    }

    /// Reads one array from the start of the tokens; returns the tokens after it.
    fn statement<'a>(&mut self, tokens: &'a [ArrayToken<'a>]) -> Result<&'a [ArrayToken<'a>], Fault> {
        let line = tokens[0].0;
        let fault = |message: &str| Fault { line, message: message.to_owned() };
        let words: Vec<&str> = tokens.iter().take(4).map(|(_, word)| *word).collect();
        let ["static", "const", "double" | "int", name] = words[..] else {
            return Err(fault("this is no `static const` array of numbers"));
        };
        let equals = tokens.iter().position(|(_, word)| *word == "=").ok_or_else(|| fault("an array without `=`"))?;
        let end = tokens.iter().position(|(_, word)| *word == ";").ok_or_else(|| fault("an array without `;`"))?;
        let values = tokens.get(equals + 1..end).ok_or_else(|| fault("an array without values"))?;
        let mut numbers = Vec::new();
        for (line, word) in values.iter().filter(|(_, word)| !["{", "}", ","].contains(word)) {
            let value = units::number(word).map_err(|why| Fault { line: *line, message: why.to_string() })?;
            numbers.push(value);
        }
        if self.0.insert(name.to_owned(), (line, numbers)).is_some() {
            return Err(fault(&format!("`{name}` is there twice")));
        }
        Ok(&tokens[end + 1..])
    }

    /// Returns the numbers of an array of exactly `count`.
    pub fn take(&self, name: &str, count: usize) -> Result<&[f64], Fault> {
        let (line, numbers) =
            self.0.get(name).ok_or_else(|| Fault { line: 0, message: format!("the array `{name}` is missing") })?;
        if numbers.len() == count {
            Ok(numbers)
        } else {
            Err(Fault { line: *line, message: format!("`{name}` has {} numbers instead of {count}", numbers.len()) })
        }
    }

    /// Returns the number of elements of an array; 0 if it is missing.
    pub fn count(&self, name: &str) -> usize {
        self.0.get(name).map_or(0, |(_, numbers)| numbers.len())
    }

    /// Whole numbers from 0 (or -1, if `none` is allowed) up to below a limit.
    pub fn indices(&self, name: &str, count: usize, none: bool, below: usize) -> Result<Vec<Option<usize>>, Fault> {
        let numbers = self.take(name, count)?;
        let index = |x: &f64| match *x {
            -1.0 if none => Ok(None),
            x if x >= 0.0 && x < below as f64 && x.fract() == 0.0 => Ok(Some(x as usize)),
            _ => Err(self.fault(name, &format!("`{name}` holds {x} instead of an index below {below}"))),
        };
        numbers.iter().map(index).collect()
    }

    /// The same where every number must be one.
    pub fn whole(&self, name: &str, count: usize, below: usize) -> Result<Vec<usize>, Fault> {
        Ok(self.indices(name, count, false, below)?.into_iter().flatten().collect())
    }

    /// A fault at an array.
    pub fn fault(&self, name: &str, message: &str) -> Fault {
        Fault { line: self.0.get(name).map_or(0, |(line, _)| *line), message: message.to_owned() }
    }
}

/// Comments become blanks; lines keep their numbers.
pub fn without_c_comments(text: &str) -> Result<String, Fault> {
    let mut clean = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find("/*") {
        clean.push_str(&rest[..start]);
        let Some(length) = rest[start..].find("*/") else {
            return Err(Fault { line: clean.lines().count(), message: "a comment that never ends".to_owned() });
        };
        let comment = &rest[start..start + length];
        clean.extend(comment.chars().filter(|c| *c == '\n'));
        clean.push(' ');
        rest = &rest[start + length + 2..];
    }
    clean.push_str(rest);
    Ok(clean)
}

/// Comments become blanks, preprocessor lines go; lines keep their numbers.
fn without_comments(text: &str) -> Result<String, Fault> {
    let clean = without_c_comments(text)?;
    let lines = clean.split('\n').map(|line| if line.trim_start().starts_with('#') { "" } else { line });
    Ok(lines.collect::<Vec<_>>().join("\n"))
}

fn tokens(text: &str) -> Vec<ArrayToken<'_>> {
    let mut found = Vec::new();
    for (number, line) in text.split('\n').enumerate() {
        let mut rest = line.trim_start();
        while let Some(first) = rest.chars().next() {
            let inner = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '+' | '-');
            let length = if inner(first) { rest.find(|c| !inner(c)).unwrap_or(rest.len()) } else { first.len_utf8() };
            found.push((number, &rest[..length]));
            rest = rest[length..].trim_start();
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_read_as_a_compiler_reads_them() {
        let text = "/* a\n b */\n#define N 2\nstatic const double x[N][2] = { /* X */ { 1.5, -2e-3 }, { 0, 4 } };\n\
                    static const int n[1] = { -1 };\n";
        let arrays = Arrays::read(text).unwrap();
        assert_eq!(arrays.take("x", 4).unwrap(), [1.5, -2e-3, 0.0, 4.0]);
        assert_eq!(arrays.indices("n", 1, true, 5).unwrap(), [None]);
        assert_eq!(arrays.take("x", 3).unwrap_err().line, 3);
        assert!(arrays.take("y", 1).is_err() && arrays.whole("n", 1, 5).is_err());
    }

    #[test]
    fn whatever_else_stands_there_is_refused_with_its_line() {
        let faulty = [
            ("int main() { return 0; }", 0),
            ("static const double x[1] = { 1 };\nstatic const double x[1] = { 2 };", 1),
            ("\nstatic const double x[1] = { nan };", 1),
            ("static const double x[1] = {\n 1e400 };", 1),
            ("static const double x[1] = { 1 + 1 };", 0),
            ("static const double x[1] { 1 };", 0),
            ("static const double x[1] = { 1 }", 0),
            ("static const double ; = x", 0),
            ("\n/* never ends", 1),
        ];
        for (text, line) in faulty {
            assert_eq!(Arrays::read(text).unwrap_err().line, line, "{text}");
        }
    }
}
