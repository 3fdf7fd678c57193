//! ISO 230-1 names: axes and geometric errors.

use std::fmt;

/// Name of an axis or spindle: `[A-Z][A-Z0-9]{0,7}`, so that it can reach any controller's files.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AxisName(String);

impl AxisName {
    /// Returns the name, if it matches the grammar.
    pub fn new(text: &str) -> Option<Self> {
        let mut bytes = text.bytes();
        let head = bytes.next().is_some_and(|b| b.is_ascii_uppercase());
        let tail = bytes.all(|b| b.is_ascii_uppercase() || b.is_ascii_digit());
        (head && tail && text.len() <= 8).then(|| Self(text.to_owned()))
    }

    /// As text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns the index in [`MAIN_AXES`], if it is one of them.
    pub fn main(&self) -> Option<usize> {
        MAIN_AXES.iter().position(|name| *name == self.0)
    }
}

/// The linear axes between which squareness is.
pub const MAIN_AXES: [&str; 3] = ["X", "Y", "Z"];

impl fmt::Display for AxisName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// One of the six directions of an error: translation along or rotation about a machine axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "the letters are their own documentation")]
pub enum Direction {
    X,
    Y,
    Z,
    A,
    B,
    C,
}

impl Direction {
    /// All six, translations first: the order of every six-vector in this crate.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::A, Self::B, Self::C];

    /// 0..=5 in the order of [`Self::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// True for a rotation (rad), false for a translation (mm).
    pub fn is_rotation(self) -> bool {
        self.index() >= 3
    }

    /// Returns the unit in which errors are printed, `um` or `urad`, and how many of it there are in a mm or rad.
    pub fn micro(self) -> (f64, &'static str) {
        if self.is_rotation() { (1e6, "urad") } else { (1e3, "um") }
    }

    /// Returns its letter.
    pub fn letter(self) -> char {
        ['X', 'Y', 'Z', 'A', 'B', 'C'][self.index()]
    }

    /// Finds a direction by its letter.
    pub fn from_letter(letter: char) -> Option<Self> {
        Self::ALL.into_iter().find(|d| d.letter() == letter)
    }
}

/// The two families of geometric errors of ISO 230-1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ErrorFamily {
    /// A function of the axis position: `EXX`.
    Component,
    /// A constant: `EC0Y`.
    Location,
}

impl ErrorFamily {
    /// Both, in the order in which errors are listed.
    pub const ALL: [Self; 2] = [Self::Location, Self::Component];
}

/// Name of a geometric error: `EXX` (component error) or `EC0Y` (location error).
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ErrorId {
    /// The axis in motion.
    pub axis: AxisName,
    /// Location or component error.
    pub family: ErrorFamily,
    /// The direction of the error.
    pub direction: Direction,
}

/// Squareness by the two directions, and the sign with which a slope of either straightness enters it.
const SQUARENESS: [([Direction; 2], &str, Direction, f64); 3] = [
    ([Direction::X, Direction::Y], "Y", Direction::C, -1.0),
    ([Direction::X, Direction::Z], "Z", Direction::B, 1.0),
    ([Direction::Y, Direction::Z], "Z", Direction::A, -1.0),
];

impl ErrorId {
    /// Returns the squareness that a slope in this straightness would be if its reference was an artefact of the
    /// machine, and the sign with which it enters: -1 for EYX and EC0Y. `None` unless it is a straightness of X, Y or
    /// Z.
    pub fn squareness(&self) -> Option<(Self, f64)> {
        let along = Direction::ALL.into_iter().find(|d| d.letter().to_string() == self.axis.as_str())?;
        let of_both = |pair: &[Direction; 2]| pair.contains(&along) && pair.contains(&self.direction);
        let found = SQUARENESS.iter().find(|(pair, ..)| of_both(pair) && along != self.direction)?;
        let (_, axis, direction, sign) = found;
        Some((Self { axis: AxisName::new(axis)?, family: ErrorFamily::Location, direction: *direction }, *sign))
    }

    /// True if it is a location error.
    pub fn is_location(&self) -> bool {
        self.family == ErrorFamily::Location
    }
}

impl fmt::Display for ErrorId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "E{}{}{}", self.direction.letter(), if self.is_location() { "0" } else { "" }, self.axis)
    }
}

impl schemars::JsonSchema for ErrorId {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "ErrorId".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        String::json_schema(generator)
    }
}

impl serde::Serialize for ErrorId {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
