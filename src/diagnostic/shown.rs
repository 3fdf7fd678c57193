//! Text of the user's in messages.

/// Maximum number of characters of the user's text that a message repeats.
const LONGEST: usize = 80;

/// The text without control characters and of bearable length: it may have come from anywhere and
/// goes to a terminal.
pub fn shown(text: &str) -> String {
    let tame = |c: char| if c.is_control() || is_layout(c) { '\u{fffd}' } else { c };
    let mut clean: String = text.chars().take(LONGEST).map(tame).collect();
    if text.chars().nth(LONGEST).is_some() {
        clean.push('…');
    }
    clean
}

/// Line separators and characters that reverse the direction of writing.
pub(crate) fn is_layout(c: char) -> bool {
    matches!(c, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
