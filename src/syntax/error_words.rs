//! Errors in words: what a name of ISO 230-1 stands for.

/// The letters of the directions, X Y Z A B C.
const LETTERS: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// Returns the words for a component error: of the axis `name`, which turns about or travels along the machine's axis
/// `along` (0 to 2), in the direction `direction` (0 to 5: X Y Z A B C). `None` for `along` states the direction only.
pub fn component_words(name: &str, rotary: bool, along: Option<usize>, direction: usize) -> String {
    let letter = LETTERS[direction];
    let about = LETTERS[direction % 3];
    let own = along == Some(direction % 3);
    match (rotary, direction < 3) {
        (false, true) if own => format!("Positioning error of {name}: along its own direction, at its position."),
        (false, true) => format!("Straightness error of {name} in {letter}: across its direction, at its position."),
        (false, false) => match angular(along, direction - 3) {
            Some(common) => format!("Angular error of {name} about {about} ({common}), at its position."),
            None => format!("Angular error of {name} about {about}, at its position."),
        },
        (true, true) if own => format!("Axial error of {name}: along its line ({letter}), at its position."),
        (true, true) => format!("Radial error of {name} in {letter}, at its position."),
        (true, false) if own => format!("Angular positioning error of {name}: about its own line, at its position."),
        (true, false) => format!("Tilt error of {name} about {about}, at its position."),
    }
}

/// Returns the words for a location error, as [`component_words`]: a constant.
pub fn location_words(name: &str, rotary: bool, along: Option<usize>, direction: usize) -> String {
    let (letter, about) = (LETTERS[direction], LETTERS[direction % 3]);
    let own = along == Some(direction % 3);
    let third = |along: usize| LETTERS[(0..3).find(|k| *k != along && *k != direction % 3).unwrap_or(along)];
    match (rotary, direction < 3) {
        (true, true) if !own => format!("Position of the line of {name} in {letter}."),
        (_, true) => format!("Zero position of {name} in {letter}."),
        (_, false) if own => format!("Zero position of {name}, about {about}."),
        (_, false) => match along {
            Some(along) => format!("Orientation of {name} about {about}: its squareness to {}.", third(along)),
            None => format!("Orientation of {name} about {about}."),
        },
    }
}

/// Roll, pitch or yaw of a linear axis that lies in the machine's X or Y; a vertical axis has tilts.
fn angular(along: Option<usize>, about: usize) -> Option<&'static str> {
    match (along?, about) {
        (along, about) if along == about => Some("roll"),
        (0, 1) | (1, 0) => Some("pitch"),
        (0, 2) | (1, 2) => Some("yaw"),
        _ => Some("tilt"),
    }
}
