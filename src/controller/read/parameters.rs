//! Kinematic parameters: lines of a pattern with `<name>` and `<value>`, each name once.

use super::{Fault, archive, patterns};
use crate::controller::manifest::ArchiveForm;
use crate::units;

/// Lines of parameters.
#[derive(Debug, Clone)]
pub struct ParameterLines<'a> {
    /// The mark that begins a comment.
    pub comment: &'a str,
    /// The pattern of a parameter.
    pub line: &'a str,
    /// Patterns of lines that say what the parameters mean.
    pub structure: &'a [String],
    /// Patterns of other lines.
    pub others: &'a [String],
    /// Patterns of lines that may be left out, and are those written for the machine otherwise.
    pub optional: &'a [String],
    /// Patterns of lines with a name that the builder of the machine gives.
    pub builder: &'a [String],
    /// Lines at which the controller stops reading.
    pub end: &'a [String],
    /// The first and the last line.
    pub frame: Option<&'a str>,
    /// The forms of the control's own archive.
    pub archive: Option<&'a ArchiveForm>,
    /// The names of the parameters of all kinds of machines.
    pub vocabulary: Vec<&'a str>,
}

/// Larger numbers are no parameters of a machine.
const MAX_NUMBER: f64 = 1e9;

impl ParameterLines<'_> {
    /// Reads the numbers of these names, in their order.
    pub fn read(&self, names: &[&str], text: &str) -> Result<Vec<f64>, Fault> {
        let mut found: Vec<Option<f64>> = vec![None; names.len()];
        let opened = archive::open(self.archive, Some(self.comment), text)?;
        for (line, bare) in self.in_frame(&opened)? {
            let parameter = self.parameter(bare);
            let known = parameter.as_ref().and_then(|(name, _)| names.iter().position(|known| known == name));
            if known.is_none() && (self.is_other(bare) || self.is_of_archive(&opened, bare, parameter.as_ref())) {
                continue;
            }
            match self.fixed_value(bare).filter(|_| known.is_none()) {
                Some(Ok(())) => continue,
                Some(Err(meant)) => {
                    let message = format!("only `{meant}` is read here: the numbers would mean something else");
                    return Err(Fault::new(line, message));
                }
                None => {}
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

    /// True if a text says more than parameters, which is compared with what is written for the machine.
    pub fn has_structure(&self) -> bool {
        [self.structure, self.optional, self.builder].iter().any(|patterns| !patterns.is_empty())
    }

    /// Refuses another structure than that of a text that was written for the machine. The order of lines is free.
    /// Returns what of the builder's names cannot be judged.
    pub fn same_structure(&self, text: &str, written: &str) -> Result<Vec<String>, Fault> {
        let of = |text| archive::open(self.archive, Some(self.comment), text);
        let (opened, written) = (of(text)?, of(written)?);
        let mut wanted: Vec<&str> = written.lines.iter().map(|(_, line)| &**line).collect();
        let mut taken: Vec<Option<&str>> = written.lines.iter().map(|(_, line)| value(line)).collect();
        let mut remarks = Vec::new();
        for (line, bare) in opened.lines.iter().map(|(line, bare)| (*line, &**bare)) {
            let [structure, optional, builder] = [self.structure, self.optional, self.builder].map(|p| fits(p, bare));
            if !structure && !optional && !builder {
                continue;
            }
            let expected = wanted.iter().position(|wanted| same(wanted, bare));
            let alike = wanted.iter().position(|wanted| key(wanted) == key(bare));
            match (expected, alike) {
                (Some(at), _) => drop(wanted.remove(at)),
                (None, Some(at)) if builder && !taken.contains(&value(bare)) => {
                    taken.push(value(bare));
                    remarks.push(format!("`{bare}`: taken as `{}`", wanted.remove(at)));
                }
                // An element that is not used.
                (None, None) if opened.archive && same(bare, &format!("{}=0", key(bare).unwrap_or_default())) => {}
                (None, None) if opened.archive && value(bare) == Some("\"\"") => {}
                (None, at) => {
                    let expected = at.map_or("no such line", |at| wanted[at]);
                    return Err(Fault::new(
                        line,
                        format!("this machine has `{expected}` here: the numbers would mean something else"),
                    ));
                }
            }
        }
        let needed = |line: &&str| fits(self.structure, line) || fits(self.builder, line);
        let missing = wanted.into_iter().find(needed);
        missing.map_or(Ok(remarks), |missing| Err(Fault::new(0, format!("the line `{missing}` is missing"))))
    }

    /// The lines that the controller reads.
    fn in_frame<'o>(&self, opened: &'o archive::OpenedText) -> Result<Vec<(usize, &'o str)>, Fault> {
        let mut all: Vec<(usize, &str)> = opened.lines.iter().map(|(line, bare)| (*line, &**bare)).collect();
        if let Some(frame) = self.frame {
            let is_frame = |line: Option<&(usize, &str)>| line.is_some_and(|(_, line)| *line == frame);
            if all.len() < 2 || !is_frame(all.first()) || !is_frame(all.last()) {
                let line = all.last().map_or(0, |(line, _)| *line);
                return Err(Fault::new(line, format!("the file does not begin and end with `{frame}`")));
            }
            all.pop();
            all.remove(0);
        }
        let is_end = |(_, line): &(usize, &str)| self.end.iter().any(|end| end == line);
        let Some(end) = all.iter().position(is_end) else {
            return match self.end.first() {
                None => Ok(all),
                Some(end) => {
                    let line = all.last().map_or(0, |(line, _)| *line);
                    Err(Fault::new(line, format!("there is no line `{end}`")))
                }
            };
        };
        if let Some((line, _)) = all[end..].iter().find(|line| !is_end(line)) {
            let message = format!("the controller stops reading at line {}: this is not in force", all[end].0 + 1);
            return Err(Fault::new(*line, message));
        }
        all.truncate(end);
        Ok(all)
    }

    /// True if a line is none of parameters.
    fn is_other(&self, line: &str) -> bool {
        [self.structure, self.others, self.optional, self.builder].iter().any(|patterns| fits(patterns, line))
    }

    /// True if a line of an archive holds other data: not that of the transformation, but for zeros of parameters that
    /// other machines have.
    fn is_of_archive(&self, opened: &archive::OpenedText, line: &str, parameter: Option<&(String, String)>) -> bool {
        let Some(form) = self.archive.filter(|_| opened.archive) else { return false };
        match parameter.filter(|(name, _)| self.vocabulary.contains(&&**name)) {
            Some((_, value)) => units::number(value).is_ok_and(|number| number == 0.0),
            None => self.fixed_value(line).is_none() && fits(&form.skip, line),
        }
    }

    /// True for a line whose value is that of the pattern with the same before `=`; the pattern if it has another one.
    fn fixed_value(&self, line: &str) -> Option<Result<(), &str>> {
        let own = key(line)?;
        let alike = |pattern: &&String| key(pattern).is_some_and(|pattern| patterns::fits(pattern, own));
        let all: Vec<&String> = self.others.iter().filter(alike).collect();
        let equal = |pattern: &&String| same(&format!("{own}={}", value(pattern).unwrap_or_default()), line);
        let first = all.first()?;
        Some(if all.iter().any(equal) { Ok(()) } else { Err(first) })
    }

    /// Name and value of a parameter's line.
    fn parameter(&self, line: &str) -> Option<(String, String)> {
        let fields = patterns::fields(self.line, line)?;
        let field = |name: &str| fields.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone());
        Some((field("name")?, field("value")?))
    }
}

fn fits(patterns: &[String], line: &str) -> bool {
    patterns.iter().any(|pattern| patterns::fits(pattern, line))
}

/// The text before the equals sign.
fn key(line: &str) -> Option<&str> {
    line.split_once('=').map(|(key, _)| key)
}

fn value(line: &str) -> Option<&str> {
    line.split_once('=').map(|(_, value)| value)
}

/// True if two lines are the same, or set the same number.
fn same(a: &str, b: &str) -> bool {
    let number = |line: &str| units::number(value(line)?).ok();
    a == b || key(a).is_some() && key(a) == key(b) && number(a).is_some() && number(a) == number(b)
}
