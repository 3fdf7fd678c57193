//! Text to quantities. Numbers are plain decimals: `nan`, `inf`, `1e400` and a decimal comma are refused.

use super::{Dimension, Quantity};
use std::borrow::Cow;

/// The reason for which a text is not a quantity.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// No number at the start.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// A decimal comma.
    #[error("`{0}` has a decimal comma")]
    DecimalComma(String),
    /// NaN, infinite or too large for a double.
    #[error("`{0}` is not a finite number")]
    NotFinite(String),
    /// A unit nobody here knows.
    #[error("unknown unit `{0}`")]
    UnknownUnit(String),
    /// A number without a unit where one is needed.
    #[error("`{0}` has no unit")]
    NoUnit(String),
}

/// The minus sign of typography, which data sheets have, as that of keyboards.
fn plain(text: &str) -> Cow<'_, str> {
    if text.contains('\u{2212}') { Cow::Owned(text.replace('\u{2212}', "-")) } else { Cow::Borrowed(text) }
}

/// Parses a plain decimal number.
pub fn number(text: &str) -> Result<f64, Failure> {
    let plain = plain(text);
    let trimmed = plain.trim();
    let own = || trimmed.to_owned();
    match trimmed.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Failure::NotFinite(own())),
        Err(_) if trimmed.replacen(',', ".", 1).parse::<f64>().is_ok() => Err(Failure::DecimalComma(own())),
        Err(_) => Err(Failure::NotANumber(own())),
    }
}

/// Parses a number with a unit, such as `12 um`, `5 arcsec`, `-2 urad/m^2`, `0.02/500` or `0.02 mm/500 mm`.
pub fn quantity(text: &str) -> Result<Quantity, Failure> {
    let plain = plain(text);
    let trimmed = plain.trim();
    let split = number_end(trimmed);
    let value = number(&trimmed[..split]).map_err(|failure| match failure {
        // `nan um` and `inf` look like numbers: the message names the fault.
        Failure::NotANumber(_) => match number(trimmed.split_whitespace().next().unwrap_or_default()) {
            Err(failure @ Failure::NotFinite(_)) => failure,
            _ => Failure::NotANumber(trimmed.to_owned()),
        },
        other => other,
    })?;
    let rest = trimmed[split..].trim();
    if rest.is_empty() {
        return Err(Failure::NoUnit(trimmed.to_owned()));
    }
    if let Some(Ok(divisor)) = rest.strip_prefix('/').map(number) {
        return ratio(value, divisor, trimmed);
    }
    if let Some((over, under)) = rest.split_once('/').filter(|(_, under)| under.trim().starts_with(char::is_numeric)) {
        return quotient(value, over, under, trimmed);
    }
    let (factor, dimension) = unit(rest)?;
    finite(value * factor, dimension, trimmed)
}

/// The quotient of two lengths, `0.02 mm/500 mm`, as data sheets write squareness.
fn quotient(value: f64, over: &str, under: &str, text: &str) -> Result<Quantity, Failure> {
    if over.trim().is_empty() {
        return Err(Failure::NoUnit(text.split('/').next().unwrap_or_default().trim().to_owned()));
    }
    let (factor, dimension) = unit(over)?;
    let whole = || Failure::UnknownUnit(format!("{}/{}", over.trim(), under.trim()));
    if under.contains('/') {
        return Err(whole());
    }
    let divisor = quantity(under)?;
    let are_lengths = [dimension, divisor.dimension].iter().all(|of| *of == Dimension::LENGTH);
    if are_lengths { ratio(value * factor, divisor.value, text) } else { Err(whole()) }
}

fn ratio(value: f64, divisor: f64, text: &str) -> Result<Quantity, Failure> {
    finite(value / divisor, Dimension::RATIO, text)
}

fn finite(value: f64, dimension: Dimension, text: &str) -> Result<Quantity, Failure> {
    if value.is_finite() { Ok(Quantity { value, dimension }) } else { Err(Failure::NotFinite(text.to_owned())) }
}

/// Returns the end of the leading number. `1e-3 mm` keeps its exponent, `3 em` does not have one.
fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut i: usize| {
        while i < bytes.len() && (bytes[i].is_ascii_digit() || matches!(bytes[i], b'.' | b',')) {
            i += 1;
        }
        i
    };
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let mantissa = digits(sign);
    if mantissa == sign || !matches!(bytes.get(mantissa), Some(b'e' | b'E')) {
        return mantissa;
    }
    let exponent = mantissa + 1 + usize::from(matches!(bytes.get(mantissa + 1), Some(b'+' | b'-')));
    let end = digits(exponent);
    if end > exponent { end } else { mantissa }
}

/// Highest power in a unit: that of the longest polynomial of the machine language.
const POWER: i8 = 20;

/// Parses a unit to its factor (to mm and rad) and dimension: `um`, `arcsec`, `urad/m^2`.
pub fn unit(text: &str) -> Result<(f64, Dimension), Failure> {
    let unknown = || Failure::UnknownUnit(text.trim().to_owned());
    let mut factor = 1.0;
    let mut dimension = Dimension::RATIO;
    for (place, part) in text.trim().split('/').enumerate() {
        let (name, power) = part.trim().split_once('^').unwrap_or((part.trim(), "1"));
        let power = power.trim().parse::<i8>().ok().filter(|power| (1..=POWER).contains(power)).ok_or_else(unknown)?;
        let (scale, length, angle) = atom(name).ok_or_else(unknown)?;
        let power = if place == 0 { power } else { -power };
        factor *= libm::pow(scale, f64::from(power));
        // A unit of many parts may leave the range of the powers.
        dimension.length = dimension.length.checked_add(length * power).ok_or_else(unknown)?;
        dimension.angle = dimension.angle.checked_add(angle * power).ok_or_else(unknown)?;
    }
    Ok((factor, dimension))
}

/// Factor, power of length, power of angle of a single unit.
fn atom(name: &str) -> Option<(f64, i8, i8)> {
    use std::f64::consts::PI;
    let length = |f| Some((f, 1, 0));
    let angle = |f| Some((f, 0, 1));
    match name.trim() {
        "nm" => length(1e-6),
        "um" | "µm" | "μm" => length(1e-3),
        "mm" => length(1.0),
        "cm" => length(10.0),
        "m" => length(1e3),
        "in" | "inch" => length(25.4),
        "nrad" => angle(1e-9),
        "urad" | "µrad" | "μrad" => angle(1e-6),
        "mrad" => angle(1e-3),
        "rad" => angle(1.0),
        "deg" | "°" => angle(PI / 180.0),
        "arcmin" => angle(PI / 10_800.0),
        "arcsec" => angle(PI / 648_000.0),
        _ => None,
    }
}

/// Splits a column header `EXX [um]` into the name and the text of its unit.
pub fn header(text: &str) -> (&str, Option<&str>) {
    let text = text.trim();
    match text.strip_suffix(']').and_then(|open| open.split_once('[')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim())),
        None => (text, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        quantity(text).unwrap().value
    }

    #[test]
    fn lengths_and_angles_come_out_in_mm_and_rad() {
        assert_eq!(value("12 um"), 12.0 * 1e-3);
        assert_eq!(value("-400mm"), -400.0);
        assert_eq!(value("5 arcsec"), 5.0 * (std::f64::consts::PI / 648_000.0));
        assert_eq!(value("0.02/500"), 0.02 / 500.0);
        assert_eq!(value("0.02 mm/500 mm"), 0.02 / 500.0);
        assert_eq!(value("20um / 0.5m"), 20.0 * 1e-3 / 500.0);
        assert_eq!(quantity("0.02 mm/500 mm").unwrap().dimension, Dimension::RATIO);
        assert_eq!(quantity("3 um/m").unwrap().dimension, Dimension::RATIO);
        assert!((value("3 um/m") - 3e-6).abs() < 1e-21);
        assert_eq!(quantity("-2 urad/m^2").unwrap().dimension, Dimension { length: -2, angle: 1 });
        assert!((value("1e-3 m") - 1.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_a_number_is_said_so() {
        assert!(matches!(quantity("1,5 um"), Err(Failure::DecimalComma(_))));
        assert!(matches!(quantity("nan um"), Err(Failure::NotFinite(_))));
        assert!(matches!(quantity("1e400 um"), Err(Failure::NotFinite(_))));
        assert!(matches!(quantity("12"), Err(Failure::NoUnit(_))));
        assert!(matches!(quantity("12 furlong"), Err(Failure::UnknownUnit(_))));
        assert!(matches!(quantity("um"), Err(Failure::NotANumber(_))));
        assert!(matches!(quantity("1/0"), Err(Failure::NotFinite(_))));
        assert!(matches!(quantity("1 um/0 m"), Err(Failure::NotFinite(_))));
        assert!(matches!(quantity("1 um/5"), Err(Failure::NoUnit(_))));
        assert!(matches!(quantity("1 um/5 deg"), Err(Failure::UnknownUnit(_))));
        assert!(matches!(quantity("1 um/2 mm/3 mm"), Err(Failure::UnknownUnit(_))));
    }

    #[test]
    fn powers_go_as_far_as_polynomials() {
        assert_eq!(quantity("3 um/m^20").unwrap().dimension, Dimension { length: -19, angle: 0 });
        assert!((value("3 um/m^12") / 3e-39 - 1.0).abs() < 1e-12);
        for text in ["um/m^21", "um/m^-1", "um/m^0", "um/m^1.5", "um/m^", &format!("um{}", "/m^20".repeat(8))] {
            assert!(matches!(unit(text), Err(Failure::UnknownUnit(_))), "{text}");
        }
    }

    #[test]
    fn headers_split_into_name_and_unit() {
        assert_eq!(header(" EXX [um] "), ("EXX", Some("um")));
        assert_eq!(header("X"), ("X", None));
    }
}
