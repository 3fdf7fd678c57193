//! Lines as a control's own archive has them, brought to those of a set.
//!
//! A check word (`'38c0`) goes: its algorithm is not public, so that it is not verified, which is said. `N24550` before
//! a variable goes. A punch (`N01825 Q1 L1 A1 P3000 A4 P3000`) becomes a line for each axis without blanks.

use super::{Fault, ReadBack, patterns};
use crate::controller::manifest::{ArchiveForm, FileLayout};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use std::borrow::Cow;

/// The lines of a text.
#[derive(Debug, Default)]
pub(super) struct OpenedText<'t> {
    /// Each with its number (from 0), without comments and check words.
    pub lines: Vec<(usize, Cow<'t, str>)>,
    /// True if the text is of a control's archive.
    pub archive: bool,
    /// Number of lines with a check word.
    pub check_words: usize,
}

/// Opens a text; blank lines stay only where no mark begins a comment.
pub(super) fn open<'t>(
    form: Option<&ArchiveForm>,
    comment: Option<&str>,
    text: &'t str,
) -> Result<OpenedText<'t>, Fault> {
    open_with(form, comment, &[], text)
}

/// Opens a text; comments that fit a pattern stay.
pub(super) fn open_with<'t>(
    form: Option<&ArchiveForm>,
    comment: Option<&str>,
    kept: &[&str],
    text: &'t str,
) -> Result<OpenedText<'t>, Fault> {
    let mut opened = OpenedText::default();
    for (number, line) in text.lines().enumerate() {
        let line = form.map_or(line, |form| without_prefixes(form, line));
        if kept.iter().any(|pattern| patterns::fits(pattern, line.trim())) {
            opened.lines.push((number, Cow::Borrowed(line.trim())));
            continue;
        }
        let bare = comment.map_or(line, |mark| line.split(mark).next().unwrap_or_default()).trim();
        let Some(form) = form else {
            if !bare.is_empty() || comment.is_none() {
                opened.lines.push((number, Cow::Borrowed(bare)));
            }
            continue;
        };
        if bare.is_empty() && (comment.is_some() || form.punch) {
            continue;
        }
        let (bare, checked) = if form.check_words { without_check_word(bare) } else { (bare, false) };
        opened.check_words += usize::from(checked);
        let bare = if form.numbered { without_number(bare) } else { bare };
        opened.archive |= checked || form.header.iter().any(|pattern| patterns::fits(pattern, bare));
        if form.punch && bare.starts_with('N') {
            let words = lines_of_punch(form, bare).ok_or_else(|| Fault::new(number, "this is no line of a punch"))?;
            opened.lines.extend(words.into_iter().map(|line| (number, Cow::Owned(line))));
        } else if let Some(words) = lines_of_words(form, bare) {
            opened.lines.extend(words.into_iter().map(|line| (number, Cow::Owned(line))));
        } else {
            opened.lines.push((number, Cow::Borrowed(bare)));
        }
    }
    Ok(opened)
}

impl FileLayout {
    /// True for lines of this layout in a control's own archive.
    pub fn is_archive(&self, text: &str) -> bool {
        match self {
            Self::Lines { comment, archive, .. } => {
                archive.is_some() && open(archive.as_deref(), comment.as_deref(), text).is_ok_and(|text| text.archive)
            }
            _ => false,
        }
    }

    /// Warns of check words in a file (W0716).
    pub fn report_check_words(&self, file: &ReadBack, diagnostics: &mut Diagnostics) {
        let (Self::Lines { archive, .. } | Self::Parameters { archive, .. }) = self else { return };
        let Some(form) = archive.as_deref().filter(|form| form.check_words) else { return };
        let count = open(Some(form), None, &file.text).map_or(0, |opened| opened.check_words);
        if count > 0 {
            let message = format!("`{}`: the check words of {count} lines are not verified", file.found);
            let help = "how the control computes them is not public; the numbers count as they stand";
            diagnostics.push(Diagnostic::new(codes::W0716, message).help(help));
        }
    }
}

/// The line behind what stands before it in a log.
fn without_prefixes<'t>(form: &ArchiveForm, line: &'t str) -> &'t str {
    let behind = |line: &'t str, prefix: &String| line.trim_start().strip_prefix(&**prefix).unwrap_or(line);
    form.prefixes.iter().fold(line, behind)
}

/// A line for each word of a command of several; none of another line.
fn lines_of_words(form: &ArchiveForm, line: &str) -> Option<Vec<String>> {
    let mut words = line.split_whitespace();
    let command = words.next().filter(|word| form.split.iter().any(|known| known == word))?;
    let (common, own): (Vec<&str>, Vec<&str>) = words.partition(|word| word.starts_with('S'));
    let head = [&[command][..], &common].concat().join(" ");
    Some(own.iter().map(|word| format!("{head} {word}")).collect())
}

/// The line before a check word, and true if there was one.
fn without_check_word(line: &str) -> (&str, bool) {
    let word = line.rsplit_once('\'').filter(|(before, word)| {
        word.len() == 4 && word.chars().all(|c| c.is_ascii_hexdigit()) && before.ends_with([' ', '\t'])
    });
    word.map_or((line, false), |(before, _)| (before.trim_end(), true))
}

/// The line behind `N24550`.
fn without_number(line: &str) -> &str {
    let behind = line.strip_prefix('N').map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
    behind.filter(|rest| rest.starts_with([' ', '\t'])).map_or(line, str::trim_start)
}

/// A letter and its number, as written.
type Word<'t> = (char, &'t str);

/// A line for each axis (`A`) of a line of words, or one.
fn lines_of_punch(form: &ArchiveForm, line: &str) -> Option<Vec<String>> {
    let mut words: Vec<Word> = Vec::new();
    let mut rest = line.trim();
    while let Some(letter) = rest.chars().next() {
        let number = rest.strip_prefix(|c: char| c.is_ascii_uppercase())?.trim_start();
        let end = number.find(|c: char| !(c.is_ascii_digit() || ".-+".contains(c))).unwrap_or(number.len());
        words.push((letter, &number[..end]));
        rest = number[end..].trim_start();
    }
    let text = |(letter, number): &Word| format!("{letter}{number}");
    words.retain(|word| !form.silent.contains(&text(word)));
    let (first, mut rest) = words.split_first()?;
    let mut head = text(first);
    if let Some(word) = rest.first().filter(|(letter, _)| *letter == 'Q') {
        head.push_str(&text(word));
        rest = &rest[1..];
    } else {
        let from: u32 = first.1.parse().ok()?;
        let word = form.without.iter().filter(|(_, least)| from >= **least).max_by_key(|(_, least)| **least);
        head.push_str(word.map_or("", |(word, _)| word));
    }
    let mut parts: Vec<String> = Vec::new();
    for word in rest {
        if word.0 == 'A' || parts.is_empty() {
            parts.push(head.clone());
        }
        parts.last_mut()?.push_str(&text(word));
    }
    Some(if parts.is_empty() { vec![head] } else { parts })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_words_and_numbers_go() {
        assert_eq!(without_check_word("$NK_NAME[0]=\"ROOT\" '38c0"), ("$NK_NAME[0]=\"ROOT\"", true));
        for plain in ["$A=1 '38c", "$A=1 '38g0", "$A=1'38c0", "$A=\"it's \"", ""] {
            assert_eq!(without_check_word(plain), (plain, false));
        }
        assert_eq!(without_number("N24550 $MC_X=1"), "$MC_X=1");
        assert_eq!(without_number("N24550=1"), "N24550=1");
    }

    #[test]
    fn punches_become_lines_of_one_axis() {
        let form = ArchiveForm {
            punch: true,
            silent: vec!["L1".to_owned()],
            without: [("Q1".to_owned(), 0), ("Q0".to_owned(), 10_000)].into(),
            ..ArchiveForm::default()
        };
        let of = |line| lines_of_punch(&form, line);
        assert_eq!(of("N01825Q1A1P3000A4P-30").unwrap(), ["N01825Q1A1P3000", "N01825Q1A4P-30"]);
        assert_eq!(of("N01825 A1 P 3000 A4 P 30").unwrap(), ["N01825Q1A1P3000", "N01825Q1A4P30"]);
        assert_eq!(of("N00000Q1L1P00000010").unwrap(), ["N00000Q1P00000010"]);
        assert_eq!(of("N10039 P 3").unwrap(), ["N10039Q0P3"]);
        assert_eq!(of("N10039Q0P3 x"), None);
    }
}
