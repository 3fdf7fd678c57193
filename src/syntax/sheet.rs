//! Tables as instruments and spreadsheets write them: UTF-8, UTF-16 with or without byte order mark, or Windows-1252,
//! CRLF, comma, semicolon or tab, decimal commas where the comma does not separate, quotes, `#` and `//` comments.
//! Machine files and their own tables are read strictly ([`super::read_table`]); this is for what comes from outside.

use super::files::Files;
use super::read::{keep, read_table_bytes};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, SourceId, codes, shown};
use crate::units::{self, Failure};
use std::path::Path;
use std::sync::Arc;

/// Size of the largest file of readings, in bytes: some four million of them. All of it is held in memory.
const MAX_BYTES: u64 = 256 << 20;

/// The text of a file and how its cells are separated.
#[derive(Debug, Clone)]
pub struct Sheet {
    source: SourceId,
    text: Arc<str>,
}

/// The words of spreadsheets for a failed formula; they are no comments.
const MISTAKES: [&str; 7] = ["#REF!", "#N/A", "#DIV/0!", "#VALUE!", "#NAME?", "#NUM!", "#NULL!"];

/// A line that is neither blank nor a comment.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetLine {
    /// Its place.
    pub place: Place,
    /// Its number in the file, from 1.
    pub number: usize,
    /// Without its end.
    pub text: String,
}

/// Reads a file that may be UTF-16 or Windows-1252; anything else that is not text is refused.
pub fn read_sheet(path: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Sheet> {
    read_named_sheet(path, None, files, diagnostics)
}

/// Reads the same; `named` is where another file names it.
pub fn read_named_sheet(
    path: &Path,
    named: Option<Place>,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<Sheet> {
    let bytes = read_table_bytes(path, named.clone(), MAX_BYTES, files, diagnostics)?;
    let Some(text) = decode(bytes) else {
        let message = format!("`{}` is not text in UTF-8, UTF-16 or Windows-1252", shown(&path.display().to_string()));
        let help = "export it as text; for example: iconv -f IBM850 -t UTF-8 old > new";
        diagnostics.push(Diagnostic::new(codes::E0104, message).at(named, "").help(help));
        return None;
    };
    let (source, text) = keep(path, &end_lines(text), diagnostics);
    Some(Sheet { source, text })
}

/// Returns a text whose lines end in `\n`: old spreadsheets end them in a carriage return alone.
fn end_lines(text: String) -> String {
    let mut chars = text.chars().peekable();
    let mut ended = String::with_capacity(text.len());
    while let Some(c) = chars.next() {
        let lone = c == '\r' && chars.peek().is_some_and(|next| !['\r', '\n'].contains(next));
        ended.push(if lone { '\n' } else { c });
    }
    ended
}

/// UTF-8, or UTF-16 with a byte order mark or with every other byte of its beginning zero, or else Windows-1252.
fn decode(bytes: Vec<u8>) -> Option<String> {
    let wide = |little: bool, bytes: &[u8]| {
        let pair = |p: &[u8]| if little { u16::from_le_bytes([p[0], p[1]]) } else { u16::from_be_bytes([p[0], p[1]]) };
        let units: Vec<u16> = bytes.chunks_exact(2).map(pair).collect();
        bytes.len().is_multiple_of(2).then(|| String::from_utf16(&units).ok()).flatten()
    };
    match &bytes[..] {
        [0xff, 0xfe, rest @ ..] => wide(true, rest),
        [0xfe, 0xff, rest @ ..] => wide(false, rest),
        [first, 0, ..] if *first != 0 => wide(true, &bytes),
        [0, first, ..] if *first != 0 => wide(false, &bytes),
        _ => String::from_utf8(bytes).or_else(|failure| windows(failure.as_bytes()).ok_or(())).ok(),
    }
}

/// Windows-1252, in which instruments write `µ` and `°`; `None` where a byte is no character of it, or a control
/// character: that is no text.
fn windows(bytes: &[u8]) -> Option<String> {
    /// 0x80 to 0x9f; `\0` where there is none. All other bytes are those of Latin-1.
    const MIDDLE: [char; 32] = [
        '€', '\0', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\0', 'Ž', '\0', '\0', '‘', '’', '“', '”',
        '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\0', 'ž', 'Ÿ',
    ];
    let one = |byte: &u8| {
        let c = MIDDLE.get(usize::from(byte.wrapping_sub(0x80))).copied().unwrap_or(char::from(*byte));
        (!c.is_control() || ['\t', '\n', '\r', '\x0c'].contains(&c)).then_some(c)
    };
    bytes.iter().map(one).collect()
}

impl Sheet {
    /// The beginning of the file, as the place of what it lacks as a whole.
    pub fn start(&self) -> Place {
        Place { source: self.source, range: 0..0 }
    }

    /// The lines that count, all in memory.
    pub fn lines(&self) -> Vec<SheetLine> {
        self.each_line().collect()
    }

    /// The lines that count, one after the other.
    pub fn each_line(&self) -> impl Iterator<Item = SheetLine> {
        let mut start = 0;
        let line = move |(index, line): (usize, &str)| {
            let content = line.trim_end();
            let range = start..start + content.len();
            start += line.len();
            let bare = content.trim_start();
            let mistake = MISTAKES.iter().any(|mistake| bare.starts_with(mistake));
            let counts = !bare.is_empty() && (mistake || !bare.starts_with('#')) && !bare.starts_with("//");
            counts.then(|| SheetLine {
                place: Place { source: self.source, range },
                number: index + 1,
                text: content.to_owned(),
            })
        };
        self.text.split_inclusive('\n').enumerate().filter_map(line)
    }
}

/// Returns the separator of the cells of a line: a semicolon or tab if there is one, else the comma.
pub fn separator(header: &str) -> char {
    [';', '\t'].into_iter().find(|c| header.contains(*c)).unwrap_or(',')
}

/// The cells of a line, trimmed, without the quotes that spreadsheets put around text.
pub fn cells(line: &str, separator: char) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            c if c == separator && !quoted => cells.push(String::new()),
            c => cells.last_mut().into_iter().for_each(|cell| cell.push(c)),
        }
    }
    cells.into_iter().map(|cell| cell.trim().to_owned()).collect()
}

/// Drops empty cells that spreadsheets leave at the end of a line, down to so many cells.
pub fn drop_empty(cells: &mut Vec<String>, min: usize) {
    while cells.len() > min && cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
}

/// The title of a column and its unit: `EXX [um]`, `EXX (um)`, `EXX/um`, `EXX_um`.
pub fn title(cell: &str) -> (String, Option<String>) {
    let (name, unit) = units::header(cell);
    if let Some(unit) = unit {
        return (name.to_owned(), Some(unit.to_owned()));
    }
    let bracketed = cell.strip_suffix(')').and_then(|open| open.split_once('('));
    let split = bracketed.or_else(|| cell.rsplit_once('/')).or_else(|| cell.rsplit_once('_'));
    match split {
        Some((name, unit)) if units::unit(unit.trim()).is_ok() => {
            (name.trim().to_owned(), Some(unit.trim().to_owned()))
        }
        _ => (cell.to_owned(), None),
    }
}

/// A number; with a decimal comma where the comma does not separate cells.
pub fn number(cell: &str, separator: char) -> Result<f64, Failure> {
    match units::number(cell) {
        Err(Failure::DecimalComma(_)) if separator != ',' => units::number(&cell.replacen(',', ".", 1)),
        other => other,
    }
}

/// The decimal mark of a file: comma and point in one leave open what `1.000` is.
#[derive(Debug, Clone, Default)]
pub struct Decimals {
    first: Option<(char, String)>,
}

impl Decimals {
    /// Takes note of a cell that is to be a number; says so if its mark is not that of the cells before. Cells that
    /// are none are for others to refuse; a comma that separates cells is no decimal comma.
    pub fn note(&mut self, cell: &str, separator: char) -> Result<(), MixedDecimals> {
        if separator == ',' || !cell.chars().all(|c| c.is_ascii_digit() || "+-.,eE".contains(c)) {
            return Ok(());
        }
        let mark = match (cell.contains(','), cell.contains('.')) {
            (false, false) => return Ok(()),
            (true, true) => return Err(MixedDecimals { cells: vec![cell.to_owned()] }),
            (comma, _) => [',', '.'][usize::from(!comma)],
        };
        match &self.first {
            Some((known, first)) if *known != mark => {
                Err(MixedDecimals { cells: vec![first.clone(), cell.to_owned()] })
            }
            Some(_) => Ok(()),
            None => {
                self.first = Some((mark, cell.to_owned()));
                Ok(())
            }
        }
    }
}

/// Decimal comma and decimal point in one file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "decimal comma and decimal point in one file ({}): write all numbers with the same, and digits ungrouped",
    .cells.iter().map(|cell| format!("`{}`", shown(cell))).collect::<Vec<_>>().join(", ")
)]
pub struct MixedDecimals {
    /// A cell with both marks, or two cells with one each.
    pub cells: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_comes_in_many_bytes() {
        let wide: Vec<u8> = "a;µ\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = [0xfe, 0xff].into_iter().chain("a;µ\n".encode_utf16().flat_map(u16::to_be_bytes)).collect();
        for bytes in [wide.clone(), [&[0xff, 0xfe], wide.as_slice()].concat(), big, "a;µ\n".into()] {
            assert_eq!(decode(bytes).as_deref(), Some("a;µ\n"));
        }
        assert_eq!(decode(vec![0xff, 0xfe, 0]), None);
        assert_eq!(decode(vec![b'a', 0xb5, b'\n', 0x80]).as_deref(), Some("aµ\n€"));
        assert_eq!((decode(vec![b'a', 0xb5, 1]), decode(vec![b'a', 0x81])), (None, None));
    }

    #[test]
    fn cells_and_decimal_commas() {
        assert_eq!(cells("a; \"b; c\" ;1,5", ';'), ["a", "b; c", "1,5"]);
        assert_eq!(number("1,5", ';').unwrap(), 1.5);
        assert!(number("1,5", ',').is_err() && number("1.234,5", ';').is_err());
    }
}
