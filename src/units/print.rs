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

/// Returns a figure and the ends of its interval with the digits that the interval leaves certain: the last one stands
/// for a tenth to a hundredth of its width, and none is beyond the fourth of the largest of the three.
/// Ends that differ in the first six digits are printed so that they differ.
///
/// An end that is not known is `-`, and the interval is taken to be as wide at both sides of the value.
pub fn by_uncertainty(value: f64, low: Option<f64>, high: Option<f64>) -> [String; 3] {
    let place = |x: f64| libm::floor(libm::log10(x.max(1e-12))) as i64;
    let ends = || [low, high].into_iter().flatten();
    let width = low.zip(high).map_or_else(
        || ends().map(|end| 2.0 * (end - value).abs()).fold(0.0, f64::max),
        |(low, high)| (high - low).abs(),
    );
    let largest = place(ends().map(f64::abs).fold(value.abs(), f64::max));
    let fine = if width > 0.0 { 1 - place(width) } else { 12 };
    let most = if width > 0.0 { (fine - 1).min(5 - largest) } else { 3 - largest };
    let decimals = fine.min((3 - largest).max(most)).clamp(0, 12) as usize;
    let text = |x: f64| without_sign_of_zero(format!("{x:.decimals$}"));
    let end = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), text);
    [text(value), end(low), end(high)]
}

/// Returns the two ends of an interval as [`by_uncertainty`] prints them.
pub fn ends(low: f64, high: f64) -> [String; 2] {
    let [_, low, high] = by_uncertainty(low, Some(low), Some(high));
    [low, high]
}

/// Returns a figure with its interval, such as `128 (119..136)`, with the digits that it leaves certain.
pub fn within(value: f64, low: Option<f64>, high: Option<f64>) -> String {
    let [value, low, high] = by_uncertainty(value, low, high);
    format!("{value} ({low}..{high})")
}

/// Returns a figure with its interval as [`within`] does, or with four digits where there is none.
pub fn with_interval(value: f64, interval: Option<[f64; 2]>) -> String {
    interval.map_or_else(|| significant(value, 4), |[low, high]| within(value, Some(low), Some(high)))
}

/// Returns a value and its standard uncertainty to the same decimal, the second of two digits of the uncertainty.
pub fn with_sigma(value: f64, sigma: f64) -> [String; 2] {
    let place = libm::floor(libm::log10(sigma.max(1e-12))) as i64;
    let decimals = (1 - place).clamp(0, 12) as usize;
    match sigma > 0.0 && sigma.is_finite() {
        true => [value, sigma].map(|x| without_sign_of_zero(format!("{x:.decimals$}"))),
        false => [significant(value, 5), significant(sigma, 2)],
    }
}

fn without_sign_of_zero(text: String) -> String {
    if text.chars().all(|c| matches!(c, '-' | '0' | '.')) { "0".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(within(127.62, Some(119.2), Some(136.4)), "128 (119..136)");
        assert_eq!(within(35.63, Some(34.52), Some(36.7)), "35.6 (34.5..36.7)");
        assert_eq!(within(141.14, Some(135.2), None), "141 (135..-)");
        assert_eq!(within(-0.004, Some(-0.3), Some(0.4)), "0 (-0.30..0.40)");
        assert_eq!(within(12.345, Some(12.345), Some(12.345)), "12.35 (12.35..12.35)");
        assert_eq!(within(0.0, Some(0.0), Some(0.0)), "0 (0..0)");
        assert_eq!(ends(0.1, 5.8), ["0.1", "5.8"]);
        assert_eq!(ends(0.04, 61.2), ["0", "61"]);
        assert_eq!(ends(1234.12, 1234.43), ["1234.1", "1234.4"]);
        assert_eq!(ends(1_234.5, 1_234.500_000_1), ["1234.50", "1234.50"]);
        assert_eq!(with_sigma(12.3456, 0.432), ["12.35", "0.43"]);
        assert_eq!(with_sigma(-0.001, 0.6), ["0", "0.60"]);
        assert_eq!(with_sigma(1234.5, 150.0), ["1234", "150"]);
        assert_eq!(with_sigma(1.234_567, 0.0), ["1.2346", "0"]);
        assert_eq!(length(0.0012345), "1.234 um");
        assert_eq!(length(-350.0), "-350 mm");
        assert_eq!(angle(12e-6), "12 urad");
        assert_eq!(significant(-0.000_000_000_000_01, 3), "0");
    }
}
