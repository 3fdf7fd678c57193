//! Patterns of lines: text with fields in angle brackets.
//!
//! A blank in a pattern matches any blanks, at its ends none too; letters are as written. `<row>` takes the rest of the
//! line as numbers; `<any>` and its text are ignored, `<whole>` is a whole number that is.

pub(super) fn fits(pattern: &str, line: &str) -> bool {
    match_pattern(&pieces(pattern), line).is_some()
}

/// The fields of a line that fits a pattern from end to end.
pub(super) fn fields(pattern: &str, line: &str) -> Option<Vec<(String, String)>> {
    match_pattern(&pieces(pattern), line)
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum PatternPiece {
    /// Literal letters.
    Text(String),
    /// Any blanks.
    Blank,
    /// A field.
    Field(String),
}

pub(super) fn pieces(pattern: &str) -> Vec<PatternPiece> {
    let mut pieces = Vec::new();
    let mut rest = pattern.trim();
    while let Some(first) = rest.chars().next() {
        if first.is_whitespace() {
            rest = rest.trim_start();
            pieces.push(PatternPiece::Blank);
        } else if let Some((field, after)) = rest.strip_prefix('<').and_then(|r| r.split_once('>')) {
            pieces.push(PatternPiece::Field(field.to_owned()));
            rest = after;
        } else {
            let tail = &rest[first.len_utf8()..];
            let end = tail.find(|c: char| c.is_whitespace() || c == '<').unwrap_or(tail.len()) + first.len_utf8();
            pieces.push(PatternPiece::Text(rest[..end].to_owned()));
            rest = &rest[end..];
        }
    }
    pieces
}

/// The fields of a line that fits a pattern from end to end.
pub(super) fn match_pattern(pieces: &[PatternPiece], line: &str) -> Option<Vec<(String, String)>> {
    let mut fields = Vec::new();
    let mut rest = line;
    for (i, piece) in pieces.iter().enumerate() {
        match piece {
            PatternPiece::Text(text) => rest = rest.strip_prefix(&**text)?,
            PatternPiece::Blank => {
                let after = rest.trim_start();
                (after.len() < rest.len()).then_some(())?;
                rest = after;
            }
            PatternPiece::Field(name) => {
                let end = match pieces.get(i + 1) {
                    _ if name == "row" || name == "any" && i + 1 == pieces.len() => rest.len(),
                    Some(PatternPiece::Text(next)) => rest.find(&**next)?,
                    _ => rest.find(char::is_whitespace).unwrap_or(rest.len()),
                };
                let value = rest[..end].trim();
                (!value.is_empty()).then_some(())?;
                if name == "whole" {
                    value.chars().all(|c| c.is_ascii_digit()).then_some(())?;
                } else {
                    fields.push((name.clone(), value.to_owned()));
                }
                rest = &rest[end..];
            }
        }
    }
    rest.trim().is_empty().then_some(fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_take_their_fields_and_nothing_else() {
        let found = fields("$AN_CEC[<table>,<index>]=<value>", "$AN_CEC[0,12]=-0.003").unwrap();
        let words: Vec<&str> = found.iter().flat_map(|(name, value)| [&**name, &**value]).collect();
        assert_eq!(words, ["table", "0", "index", "12", "value", "-0.003"]);
        assert_eq!(fields("$AN_CEC[<table>,<index>]=<value>", "$AN_CEC[0.12]=1"), None);
        assert_eq!(fields("kw.x <value>", "kw.x   7").unwrap()[0].1, "7");
        assert_eq!(fields("kw.x <value>", "kw.x"), None);
        assert_eq!(fields("M17", "M17 "), Some(Vec::new()));
        assert_eq!(fields("M17", "M170"), None);
        assert_eq!(fields("<row>", "1, 2,3").unwrap()[0].1, "1, 2,3");
        assert_eq!(fields("head <any>", "head what ever").unwrap()[0].1, "what ever");
    }
}
