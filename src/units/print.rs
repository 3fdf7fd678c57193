//! Quantities to text for people: micrometres and microradians with a sensible number of digits.

/// A length in mm as text, in the unit that reads best: `1.2 um`, `350 mm`.
pub fn length(mm: f64) -> String {
    if mm == 0.0 || mm.abs() >= 1.0 {
        format!("{} mm", significant(mm, 6))
    } else {
        format!("{} um", significant(mm * 1e3, 4))
    }
}

/// An angle in rad as text in urad.
pub fn angle(rad: f64) -> String {
    format!("{} urad", significant(rad * 1e6, 4))
}

/// A number with at most `digits` significant digits, no trailing zeros, never `-0`.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let magnitude = libm::floor(libm::log10(value.abs())) as i64;
    let decimals = (digits as i64 - 1 - magnitude).clamp(0, 12) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// `1 reading`, `2 readings`.
pub fn counted(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(length(0.0012345), "1.234 um");
        assert_eq!(length(-350.0), "-350 mm");
        assert_eq!(angle(12e-6), "12 urad");
        assert_eq!(significant(-0.000_000_000_000_01, 3), "0");
    }
}
