//! Names of component errors as the columns of files spell them.

use crate::machine::{Approach, ErrorId, parse_error_name};

/// Splits `EXX+`, `EXX forward` into the error's name and its direction of approach.
pub(crate) fn split_direction(name: &str) -> (&str, Option<Approach>) {
    let cut = |endings: [&str; 2]| endings.iter().find_map(|ending| name.strip_suffix(ending)).map(str::trim);
    match (cut(["+", " forward"]), cut(["-", " reverse"])) {
        (Some(bare), _) => (bare, Some(Approach::Forward)),
        (_, Some(bare)) => (bare, Some(Approach::Reverse)),
        _ => (name, None),
    }
}

/// Returns the component error with this ISO name, or this name of VDI 2617 (`xtx`, `xrz`).
pub(super) fn parse_component_error(text: &str) -> Option<ErrorId> {
    parse_error_name(text).or_else(|| vdi_error(text)).filter(|error| !error.is_location())
}

/// Returns the error with a name of VDI 2617, axis, translation or rotation, direction: `xtx` is EXX, `xrz` is ECX.
fn vdi_error(text: &str) -> Option<ErrorId> {
    let [axis @ (b'x' | b'y' | b'z'), kind, direction @ (b'x' | b'y' | b'z')] = *text.as_bytes() else { return None };
    let directions = match kind {
        b't' => b"XYZ",
        b'r' => b"ABC",
        _ => return None,
    };
    let letter = directions[usize::from(direction - b'x')];
    parse_error_name(&format!("E{}{}", char::from(letter), char::from(axis.to_ascii_uppercase())))
}
