//! Causes of a file that cannot be read, as a person would name them: another format, a tab, a missing colon.

use crate::diagnostic::shown;
use std::ops::Range;
use std::path::Path;

/// A file of another format than the one that is wanted.
pub(super) struct ForeignFormat {
    /// Noun with its article.
    pub(super) noun: &'static str,
    /// The remedy.
    pub(super) remedy: &'static str,
}

/// Returns the format of bytes that are no text.
pub(super) fn binary_format(bytes: &[u8]) -> Option<ForeignFormat> {
    let remedy = "name a file of text";
    let noun = match bytes {
        [b'P', b'K', 3, 4, ..] | [0xd0, 0xcf, 0x11, 0xe0, ..] => "a workbook of a spreadsheet",
        [b'%', b'P', b'D', b'F', ..] => "a PDF page",
        _ => return None,
    };
    Some(ForeignFormat { noun, remedy })
}

/// Returns the format of a file that is no text table, by its ending or its first bytes.
pub(super) fn foreign_format(path: &Path, bytes: &[u8]) -> Option<ForeignFormat> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let is_one_of = |endings: &[&str]| endings.contains(&ending.as_str());
    let begins = |beginnings: &[&[u8]]| beginnings.iter().any(|beginning| bytes.starts_with(beginning));
    let format = |noun, remedy| Some(ForeignFormat { noun, remedy });
    if begins(&[b"PK\x03\x04", b"\xd0\xcf\x11\xe0"]) || is_one_of(&["xls", "xlsx", "xlsm", "ods"]) {
        format("a workbook of a spreadsheet", "save the sheet as CSV (UTF-8), and name that file")
    } else if begins(&[b"ISO-10303-21", b"solid "]) || is_one_of(&["stp", "step", "igs", "iges", "stl", "dxf"]) {
        let remedy = "export points of it as a table `X [mm], Y [mm], Z [mm]`, or its tool path as APT CL data";
        format("a drawing of a part", remedy)
    } else if begins(&[b"%PDF"]) || ending == "pdf" {
        format("a PDF page", "type its figures into a CSV table")
    } else if is_program(bytes) || is_one_of(&["nc", "ngc", "mpf", "gcode", "tap", "cnc", "h"]) {
        let remedy = "let the CAM system write APT CL data, or a table `X, Y, Z, I, J, K` of tips and tool directions";
        format("a program for a control", remedy)
    } else if is_one_of(&["yaml", "yml"]) && is_mapping(bytes) {
        format("a YAML file", "a job is given by `--job`, columns of a table by `--columns`; a table is CSV")
    } else {
        None
    }
}

/// True if the first line that says something is an entry `key: value` of a mapping, not the header of a table.
fn is_mapping(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let said = lines.find(|line| !line.is_empty() && !line.starts_with(b"#")).unwrap_or_default();
    let key = said.iter().position(|byte| *byte == b':').map(|end| &said[..end]);
    key.is_some_and(|key| key.iter().all(|byte| byte.is_ascii_alphanumeric() || *byte == b'_'))
}

/// True if the first line is a block of an NC program, such as `N10 G0 X5`.
fn is_program(bytes: &[u8]) -> bool {
    let line = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default().trim_ascii();
    let words: Vec<&[u8]> = line.split(|byte| *byte == b' ').collect();
    let is_word = |word: &[u8], letters: &[u8]| match word {
        [letter, digits @ ..] => {
            letters.contains(letter) && !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
        }
        [] => false,
    };
    let code = words.iter().find(|word| !is_word(word, b"N"));
    line.starts_with(b"BEGIN PGM") || code.is_some_and(|word| is_word(word, b"GM"))
}

/// The cause of a text that is not YAML.
pub(super) struct YamlCause {
    /// The message.
    pub(super) message: String,
    /// Its place, bytes of the text.
    pub(super) range: Range<usize>,
    /// The remedy.
    pub(super) help: String,
}

/// Returns the cause of a failure to parse at byte `at`, if it is a usual one.
pub(super) fn yaml_cause(text: &str, at: usize) -> Option<YamlCause> {
    let begin = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let end = text[at..].find('\n').map_or(text.len(), |end| at + end);
    let before = text[..begin].trim_end();
    let above = before.rfind('\n').map_or(0, |end| end + 1)..before.len();
    // The parser may notice one line late.
    let lines = [begin..end, above.clone()];
    let tab = lines.iter().find_map(|line| tab(text, line));
    tab.or_else(|| lines.iter().find_map(|line| quote(text, line)))
        .or_else(|| bracket(text, &above))
        .or_else(|| step(text, &(begin..end), &above))
        .or_else(|| lines.into_iter().find_map(|line| colon(text, line, at)))
}

/// A prime of a chain within single quotes, which it ends.
fn quote(text: &str, line: &Range<usize>) -> Option<YamlCause> {
    let content = text[line.clone()].split(" #").next().unwrap_or_default();
    let (key, value) = content.split_once(": ")?;
    let inner = value.trim().strip_prefix('\'')?.strip_suffix('\'')?;
    let prime = inner.find('\'')?;
    let opened = line.start + content.find('\'')?;
    let help = format!("double quotes keep the primes: `{}: \"{}\"`", shown(key.trim()), shown(inner));
    let message = "`'` ends this text, which begins with `'`".to_owned();
    Some(YamlCause { message, range: opened + 1 + prime..opened + 2 + prime, help })
}

/// A bracket that its line does not close.
fn bracket(text: &str, line: &Range<usize>) -> Option<YamlCause> {
    let content = text[line.clone()].split(" #").next().unwrap_or_default();
    let mut open = Vec::new();
    let mut crossed = None;
    for (at, c) in content.char_indices().filter(|_| !content.contains(['"', '\''])) {
        match (c, open.last()) {
            ('{' | '[', _) => open.push((at, c)),
            ('}', Some((_, '{'))) | (']', Some((_, '['))) => drop(open.pop()),
            ('}' | ']', last) => crossed = crossed.or(last.copied()),
            _ => {}
        }
    }
    // Brackets may go on in the next line behind a comma.
    let goes_on = content.trim_end().ends_with(['{', '[', ',']);
    let (at, c) = crossed.or(open.pop().filter(|_| !goes_on))?;
    let end = if c == '{' { '}' } else { ']' };
    let (start, help) = (line.start + at, format!("write `{end}` at the end of what `{c}` begins"));
    Some(YamlCause { message: format!("`{c}` is not closed"), range: start..start + 1, help })
}

/// A line that is indented deeper than the one above, which has its value already.
fn step(text: &str, line: &Range<usize>, above: &Range<usize>) -> Option<YamlCause> {
    let (line, above, start) = (&text[line.clone()], &text[above.clone()], line.start);
    let indentation = |line: &str| line.len() - line.trim_start().len();
    let (_, value) = above.split(" #").next().unwrap_or_default().split_once(": ")?;
    if value.trim().is_empty() || !line.contains(':') || indentation(line) <= indentation(above) {
        return None;
    }
    let message = "this line is indented deeper than the one above, which has its value already".to_owned();
    let help = "begin it in the column of the line above".to_owned();
    Some(YamlCause { message, range: start..start + indentation(line), help })
}

/// A tab in the indentation of a line.
fn tab(text: &str, line: &Range<usize>) -> Option<YamlCause> {
    let content = &text[line.clone()];
    let indentation = &content[..content.len() - content.trim_start().len()];
    let start = line.start + indentation.find('\t')?;
    let help = "indent with blanks, two for each level: YAML takes no tab there".to_owned();
    Some(YamlCause { message: "a tab indents this line".to_owned(), range: start..start + 1, help })
}

/// A key without its colon, or without the blank behind it.
fn colon(text: &str, line: Range<usize>, at: usize) -> Option<YamlCause> {
    let content = text[line.clone()].split(" #").next().unwrap_or_default();
    // Within brackets the entry before the failure, else the beginning of the line.
    let upto = if line.contains(&at) { (at - line.start).min(content.len()) } else { content.len() };
    let inner = content[..upto].rfind(['{', ',']).filter(|_| content[..upto].contains('{')).map_or(0, |open| open + 1);
    [inner, 0].into_iter().find_map(|from| {
        let entry = &content[from..];
        let start = from + entry.len() - entry.trim_start_matches([' ', '-']).len();
        let key: &str = content[start..].split([' ', '{', '[', '"', ',', '}', '#']).next().unwrap_or_default();
        let (name, glued) = key.split_once(':').map_or((key, None), |(name, rest)| (name, Some(rest)));
        let rest = &content[start + key.len()..];
        let is_key = name.chars().next().is_some_and(char::is_alphabetic)
            && name.chars().all(|c| c.is_alphanumeric() || c == '_');
        let touches = glued.is_some_and(|value| !value.is_empty() || rest.starts_with(['{', '[', '"']));
        let message = match glued {
            _ if !is_key => return None,
            Some(_) if touches => format!("no blank behind the colon of `{name}`"),
            None if !rest.trim_start().starts_with(':') => format!("no colon behind `{name}`"),
            _ => return None,
        };
        let start = line.start + start;
        let help = format!("write `{name}: ...`, with a colon and a blank");
        Some(YamlCause { message, range: start..start + name.len(), help })
    })
}
