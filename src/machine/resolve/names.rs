//! Names of errors in all their spellings, and names that people give.

use crate::machine::{AxisName, Direction, ErrorFamily, ErrorId};

/// An error as spelt: `Sxz` is `EB0Z` with the opposite sign.
#[derive(Debug, Clone, PartialEq)]
pub struct Spelling {
    pub error: ErrorId,
    /// Values under this spelling have the opposite sign.
    pub negated: bool,
}

/// Returns a word in capitals if that names an error, as `ec0y` does not.
pub fn error_name_in_capitals(word: &str) -> Option<String> {
    let upper = word.trim().to_uppercase();
    parse_error_name(&upper).map(|_| upper)
}

/// Returns the error that a name means: `EXX`, `EC0Y` and other usual spellings (`E_{C0Y}`, `C0Y`, `COY`, `dyx`, `eyx`,
/// `Sxy`). A letter O in the place of the zero is read as the zero.
///
/// `Sxz` names `EB0Z`, of which it has the opposite sign: this function gives the name only.
pub fn parse_error_name(text: &str) -> Option<ErrorId> {
    let mut readings = readings(text);
    (!readings.is_empty()).then(|| readings.swap_remove(0).error)
}

/// Returns all that a name may mean, the likeliest first.
pub fn readings(text: &str) -> Vec<Spelling> {
    let plain = text.trim().replace(['_', '{', '}', '$'], "").replace("(0X)", "0");
    let letter_o = location(&plain, 'O').or_else(|| plain.strip_prefix('E').and_then(|rest| location(rest, 'O')));
    let zero = plain.strip_prefix('E').and_then(|rest| location(rest, '0')).or_else(|| location(&plain, '0'));
    let component = plain.strip_prefix('E').and_then(component);
    let same = |error| Spelling { error, negated: false };
    [zero, letter_o, component].into_iter().flatten().map(same).chain(lower_case(&plain)).collect()
}

/// `C0Y`: direction, zero, axis.
fn location(text: &str, zero: char) -> Option<ErrorId> {
    let mut chars = text.chars();
    let direction = Direction::from_letter(chars.next()?)?;
    if chars.next()? != zero {
        return None;
    }
    Some(ErrorId { axis: AxisName::new(chars.as_str())?, family: ErrorFamily::Location, direction })
}

/// `XX` after the E: direction, axis.
fn component(text: &str) -> Option<ErrorId> {
    let mut chars = text.chars();
    let direction = Direction::from_letter(chars.next()?)?;
    Some(ErrorId { axis: AxisName::new(chars.as_str())?, family: ErrorFamily::Component, direction })
}

/// Small letters are those of the 2015 paper, where `ezz` is ECZ: not what who writes ISO names in them means.
pub fn in_other_letters(name: &str) -> Option<String> {
    let name = name.trim_end_matches(['+', '-']);
    let small = name.chars().all(|c| c.is_ascii_lowercase());
    let (paper, iso) = (parse_error_name(name)?, parse_error_name(&name.to_uppercase())?);
    (small && paper != iso)
        .then(|| format!("`{name}` is {paper} in the letters of the 2015 paper; write `{iso}` if that is meant"))
}

/// Returns the papers' letters: `dyx` translation in y of axis X, `eyx` rotation about y, `Sxy` squareness.
fn lower_case(text: &str) -> Option<Spelling> {
    let chars: Vec<char> = text.chars().collect();
    let [kind, first, second] = chars[..] else { return None };
    let place = |c: char| "xyz".find(c);
    let (a, b) = (place(first)?, place(second)?);
    let axis = AxisName::new(&second.to_ascii_uppercase().to_string())?;
    match (kind, a, b) {
        ('d', ..) => Some((ErrorFamily::Component, Direction::ALL[a], false)),
        ('e', ..) => Some((ErrorFamily::Component, Direction::ALL[3 + a], false)),
        ('S', 0, 1) => Some((ErrorFamily::Location, Direction::C, false)),
        ('S', 0, 2) => Some((ErrorFamily::Location, Direction::B, true)),
        ('S', 1, 2) => Some((ErrorFamily::Location, Direction::A, false)),
        _ => None,
    }
    .map(|(family, direction, negated)| Spelling { error: ErrorId { axis, family, direction }, negated })
}
