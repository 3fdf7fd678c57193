//! Numbers as templates see them. What is not finite is no digits but a mark, and no file with the mark is written.

/// Stands for a number that is not finite: a control character, which no name of a machine or axis holds.
pub const NOT_FINITE: char = '\u{1a}';

/// The shortest decimal number that is read as the same double; never `-0`.
pub fn exact(value: f64) -> String {
    if value.is_finite() { format!("{:?}", value + 0.0) } else { NOT_FINITE.to_string() }
}

/// Formats a number with `decimals` decimals, never `-0`. Callers have rounded it already, so nothing is lost.
pub fn decimal_text(value: f64, decimals: u8) -> String {
    let mut text = String::new();
    push_decimal(&mut text, value, decimals);
    text
}

/// The digits come from an integer: exact, and several times faster than the general formatter.
pub fn push_decimal(text: &mut String, value: f64, decimals: u8) {
    use std::fmt::Write;
    const EXACT: f64 = 9_007_199_254_740_992.0;
    if !value.is_finite() {
        text.push(NOT_FINITE);
        return;
    }
    let scaled = libm::round(value * libm::pow(10.0, f64::from(decimals)));
    // Writing to a String cannot fail.
    let _ = if scaled.abs() < EXACT {
        let digits = scaled.abs() as u64;
        let one = 10_u64.pow(u32::from(decimals));
        let sign = if scaled < 0.0 { "-" } else { "" };
        match decimals {
            0 => write!(text, "{sign}{digits}"),
            _ => write!(text, "{sign}{}.{:0width$}", digits / one, digits % one, width = usize::from(decimals)),
        }
    } else {
        write!(text, "{value:.decimals$}", decimals = usize::from(decimals))
    };
}

#[cfg(test)]
mod tests {
    use super::{NOT_FINITE, decimal_text, exact};

    #[test]
    fn numbers_are_plain_decimals() {
        let cases = [
            (0.0, "0.000"),
            (-0.0, "0.000"),
            (-0.0004, "0.000"),
            (-0.0006, "-0.001"),
            (12.5, "12.500"),
            (-359.9996, "-360.000"),
        ];
        for (value, text) in cases {
            assert_eq!(decimal_text(value, 3), text);
        }
        assert_eq!(decimal_text(7.4, 0), "7");
        assert_eq!(decimal_text(1e17, 2), "100000000000000000.00");
        assert_eq!((exact(-0.0), exact(0.1)), ("0.0".to_owned(), "0.1".to_owned()));
    }

    #[test]
    fn what_is_not_finite_is_a_mark() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!((decimal_text(value, 3), exact(value)), (NOT_FINITE.to_string(), NOT_FINITE.to_string()));
        }
        // Finite, though too large for its decimals.
        assert_eq!(decimal_text(1e308, 6).len(), 309 + 7);
    }
}
