//! Channels of instruments that measure six degrees of freedom, by their names, and the errors that they show.
//!
//! The instrument's frame is right-handed: the beam b from the launch to the receiver, the instrument's vertical v, and
//! h = v x b. The values are the motion of the tool relative to the workpiece in this frame: lengths along b, h and v,
//! angles about b (roll), h (pitch) and v (yaw).

use super::layout::{self, RunLabel};
use crate::machine::{AxisName, Direction, ErrorFamily, ErrorId};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum InstrumentChannel {
    Linear,
    Horizontal,
    Vertical,
    Roll,
    Pitch,
    Yaw,
}

use InstrumentChannel::{Horizontal, Linear, Pitch, Roll, Vertical, Yaw};

/// Groups of words that a title has one each of, and the channel.
const NAMES: [(&[&[&str]], InstrumentChannel); 6] = [
    (&[&["linear", "lin", "positioning"]], Linear),
    (&[STRAIGHT, &["h", "horizontal", "hor", "horiz"]], Horizontal),
    (&[STRAIGHT, &["v", "vertical", "ver", "vert", "vertikal"]], Vertical),
    (&[&["roll", "rollen", "rollwinkel"]], Roll),
    (&[&["pitch", "nicken", "nickwinkel"]], Pitch),
    (&[&["yaw", "gieren", "gierwinkel"]], Yaw),
];

const STRAIGHT: &[&str] = &["straightness", "straight", "str", "geradheit"];

/// Words beside those of the channel.
const FILLERS: [&str; 8] = ["error", "errors", "deviation", "angle", "displacement", "abweichung", "angular", "winkel"];

/// Returns the channel that a title names, with run and direction.
pub(super) fn channel(title: &str, layout: &layout::ExportLayout) -> Option<(InstrumentChannel, RunLabel)> {
    let lower = title.to_lowercase();
    let of = |groups: &[&[&str]]| -> Option<String> {
        let mut rest: Vec<&str> = layout::words(&lower).collect();
        for group in groups {
            let at = rest.iter().position(|word| group.contains(word))?;
            let word = rest.remove(at);
            // One of each: `straightness h v` is no channel.
            if rest.iter().any(|other| *other != word && group.contains(other)) {
                return None;
            }
        }
        let mut label = lower.clone();
        for word in groups.iter().flat_map(|group| group.iter()).chain(&FILLERS) {
            label = without_word(&label, word);
        }
        Some(label)
    };
    let (label, channel) = NAMES.iter().find_map(|(groups, channel)| Some((of(groups)?, *channel)))?;
    let label = label.trim().trim_start_matches(['_', '-', ',']).trim();
    let label = if label.is_empty() { Some(RunLabel::default()) } else { layout.run(label, false) };
    Some((channel, label?))
}

/// Returns a text without a whole word.
fn without_word(text: &str, word: &str) -> String {
    let mut kept = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(word) {
        let (before, after) = (&rest[..at], &rest[at + word.len()..]);
        let whole = !before.ends_with(char::is_alphabetic) && !after.starts_with(char::is_alphabetic);
        kept.push_str(before);
        kept.push_str(if whole { " " } else { word });
        rest = after;
    }
    kept + rest
}

impl InstrumentChannel {
    /// True if the channel can show the error of a linear axis in some mounting.
    pub fn can_show(self, error: &ErrorId) -> bool {
        let Some(own) = axis_direction(&error.axis) else { return true };
        let along = error.direction.index() % 3 == own;
        match self {
            Linear => !error.direction.is_rotation() && along,
            Horizontal | Vertical => !error.direction.is_rotation() && !along,
            Roll => error.direction.is_rotation() && along,
            Pitch | Yaw => error.direction.is_rotation() && !along,
        }
    }
}

/// Returns the machine's direction along which a linear axis of this name moves.
pub(super) fn axis_direction(axis: &AxisName) -> Option<usize> {
    let name = axis.to_string();
    ["XU", "YV", "ZW"].iter().position(|letters| name.starts_with(|c| letters.contains(c)))
}

/// A direction of the machine: index of the axis, and its sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct MachineDirection {
    index: usize,
    negative: bool,
}

/// Mounting of the instrument in the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mounting {
    beam: MachineDirection,
    vertical: MachineDirection,
}

impl Mounting {
    /// Returns the mounting with this beam and this vertical (`+X`, `-Z`); `None` if they are no two directions across.
    pub fn new(beam: &str, vertical: &str) -> Option<Self> {
        let direction = |text: &str| {
            let (negative, letter) = match text.trim().strip_prefix('-') {
                Some(letter) => (true, letter),
                None => (false, text.trim().trim_start_matches('+')),
            };
            let index = ["X", "Y", "Z"].iter().position(|known| letter.eq_ignore_ascii_case(known))?;
            Some(MachineDirection { index, negative })
        };
        let (beam, vertical) = (direction(beam)?, direction(vertical)?);
        (beam.index != vertical.index).then_some(Self { beam, vertical })
    }

    /// Returns the machine's direction along which the beam goes.
    pub(super) fn along(&self) -> usize {
        self.beam.index
    }

    /// Returns the third direction h = v x b.
    fn horizontal(&self) -> MachineDirection {
        let (v, b) = (self.vertical, self.beam);
        let cyclic = (v.index + 1) % 3 == b.index;
        MachineDirection { index: 3 - v.index - b.index, negative: (v.negative != b.negative) == cyclic }
    }

    /// Returns the error that a channel shows of an axis; true if the error is minus what the channel shows.
    pub(super) fn error(&self, channel: InstrumentChannel, axis: &AxisName) -> (ErrorId, bool) {
        let along = match channel {
            Linear | Roll => self.beam,
            Horizontal | Pitch => self.horizontal(),
            Vertical | Yaw => self.vertical,
        };
        let turns = matches!(channel, Roll | Pitch | Yaw);
        let direction = Direction::ALL[along.index + if turns { 3 } else { 0 }];
        (ErrorId { axis: axis.clone(), family: ErrorFamily::Component, direction }, along.negative)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::data::import::layout::GENERAL;

    /// The table of the right-handed frame, line by line.
    #[test]
    fn six_channels_are_six_errors_with_signs() {
        let lines = [
            ("+X", "+Z", "X", "+EXX +EYX +EZX +EAX +EBX +ECX"),
            ("+Y", "+Z", "Y", "+EYY -EXY +EZY +EBY -EAY +ECY"),
            ("+Z", "+X", "Z", "+EZZ -EYZ +EXZ +ECZ -EBZ +EAZ"),
            ("+Z", "+Y", "Z", "+EZZ +EXZ +EYZ +ECZ +EAZ +EBZ"),
            // The laser at the other end: linear, H, roll and pitch change sign.
            ("-X", "+Z", "X", "-EXX -EYX +EZX -EAX -EBX +ECX"),
        ];
        for (beam, vertical, axis, expected) in lines {
            let mounting = Mounting::new(beam, vertical).unwrap();
            let name = AxisName::new(axis).unwrap();
            let found = [Linear, Horizontal, Vertical, Roll, Pitch, Yaw].map(|channel| {
                let (error, negative) = mounting.error(channel, &name);
                format!("{}{error}", if negative { '-' } else { '+' })
            });
            assert_eq!(found.join(" "), expected, "{beam} {vertical}");
        }
        assert_eq!((Mounting::new("+X", "-X"), Mounting::new("X", "up")), (None, None));
    }

    #[test]
    fn names_of_channels() {
        let named = |title: &str| channel(title, &GENERAL).map(|(channel, label)| (channel, label.run));
        for (title, expected) in [
            ("Linear", Linear),
            ("Straightness H", Horizontal),
            ("Horizontal straightness error", Horizontal),
            ("straightness_v", Vertical),
            ("Geradheit vertikal", Vertical),
            ("Pitch angle", Pitch),
            ("Yaw", Yaw),
            ("Rollwinkel", Roll),
        ] {
            assert_eq!(named(title), Some((expected, String::new())), "{title}");
        }
        assert_eq!(named("Pitch 2"), Some((Pitch, "2".to_owned())));
        assert_eq!(channel("Yaw 2 -", &GENERAL).unwrap().1.direction, Some(crate::syntax::ColumnDirection::Reverse));
        for title in ["Straightness", "Pitch and roll", "pitch temperature", "Linear velocity", "straightness h v"] {
            assert_eq!(named(title), None, "{title}");
        }
    }
}
