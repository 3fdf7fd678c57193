//! The words by which a controller knows an axis.

/// The letter and the number of an axis in the controller, as far as the builder of the machine states them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ControllerAxis {
    /// The letter in programs and in the names of files.
    pub letter: Option<char>,
    /// The number, from 1.
    pub number: Option<u16>,
}

impl ControllerAxis {
    /// The words that are understood.
    pub const EXPECTED: &str = "a letter (A) or a number from 1 (6, AX6, #6)";

    /// Reads a letter (`A`) or a number (`6`, `AX6` as SINUMERIK writes it, `#6` as PMAC does).
    pub fn parse(word: &str) -> Option<Self> {
        if let [letter @ b'A'..=b'Z'] = *word.as_bytes() {
            return Some(Self { letter: Some(char::from(letter)), number: None });
        }
        let digits = word.strip_prefix("AX").or_else(|| word.strip_prefix('#')).unwrap_or(word);
        let plain = digits.bytes().all(|digit| digit.is_ascii_digit());
        let number: u16 = digits.parse().ok().filter(|number| plain && *number > 0)?;
        Some(Self { letter: None, number: Some(number) })
    }

    /// Adds a word; `None` if there is one of its kind already.
    pub fn and(self, other: Self) -> Option<Self> {
        let twice =
            (self.letter.is_some() && other.letter.is_some()) || (self.number.is_some() && other.number.is_some());
        (!twice).then(|| other.or(self))
    }

    /// Returns these words, and those of `other` where there are none.
    pub fn or(self, other: Self) -> Self {
        Self { letter: self.letter.or(other.letter), number: self.number.or(other.number) }
    }

    /// Returns the words as a machine file has them.
    pub fn words(self) -> Vec<String> {
        let letter = self.letter.map(String::from);
        letter.into_iter().chain(self.number.map(|number| number.to_string())).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that panics is a test that fails")]
mod tests {
    use super::*;

    #[test]
    fn letters_and_numbers_are_understood() {
        let numbers = ["6", "AX6", "#6"].map(|word| ControllerAxis::parse(word).unwrap());
        assert_eq!(numbers.map(|axis| (axis.letter, axis.number)), [(None, Some(6)); 3]);
        assert_eq!(ControllerAxis::parse("U").unwrap().words(), ["U"]);
        for word in ["", "0", "AX0", "AX", "#", "u", "UV", "+6", "AX+6", "6.0", "65536", "AX#6", "É"] {
            assert_eq!(ControllerAxis::parse(word), None, "{word}");
        }
    }

    #[test]
    fn a_letter_and_a_number_add_up() {
        let [letter, number] = ["U", "7"].map(|word| ControllerAxis::parse(word).unwrap());
        assert_eq!(letter.and(number).unwrap().words(), ["U", "7"]);
        assert!(letter.and(letter).is_none() && number.and(number).is_none());
    }
}
