//! Scalars to numbers: lengths and positions in mm or deg, error values in mm or rad.

use super::context::{Context, dotted_path};
use super::names::in_other_letters;
use crate::diagnostic::{codes, shown};
use crate::machine::{AxisKind, Direction};
use crate::syntax::{Keys, Scalar, below};
use crate::units::{self, Dimension, FARTHEST, Failure, Quantity};

const LENGTHS: &str = "lengths: nm, um, mm, cm, m, in";
const ANGLES: &str = "angles: urad, mrad, rad, arcsec, arcmin, deg, or a ratio such as um/m or 0.02/500";

/// Returns the remedy of a list that has other numbers than it should because of how they are parted.
pub(super) fn slip_in_list(list: &[Scalar]) -> Option<String> {
    let texts: Vec<&str> =
        list.iter().filter_map(|of| if let Scalar::Text(text) = of { Some(text.as_str()) } else { None }).collect();
    if texts.iter().any(|text| text.contains(';')) {
        return Some("part the numbers by commas, `[250, 225, 0]`".to_owned());
    }
    let dash = |text: &&str| {
        text.trim().get(1..).is_some_and(|rest| rest.contains(" - ") || rest.contains(" to ") || rest.contains(".."))
    };
    if list.len() == 1 && texts.iter().any(dash) {
        return Some("part the ends by a comma, `[0 mm, 500 mm]`".to_owned());
    }
    // `500,5 mm` is two numbers, the first without a unit beside others that have one.
    let is_digits = |of: &Scalar| of.to_string().bytes().all(|c| c.is_ascii_digit() || c == b'-');
    let parted = list
        .windows(2)
        .any(|pair| is_digits(&pair[0]) && pair[1].to_string().starts_with(|c: char| c.is_ascii_digit()));
    (list.len() > 2 && parted && !texts.is_empty())
        .then(|| "write decimals with a point, `500.5 mm`: a comma parts numbers".to_owned())
}

impl Context<'_> {
    fn unreadable(&mut self, at: &Keys, failure: &Failure) {
        let help = match failure {
            Failure::NoUnit(_) => "add the unit, as in `12 um` or `5 urad`",
            Failure::UnknownUnit(unit) if matches!(unit.as_str(), "'" | "′" | "min") => "minutes of arc are `arcmin`",
            Failure::UnknownUnit(unit) if matches!(unit.as_str(), "\"" | "″" | "''" | "sec" | "as") => {
                "seconds of arc are `arcsec`, inches `in`"
            }
            Failure::UnknownUnit(unit) if matches!(unit.as_str(), "thou" | "mil" | "mils") => {
                "a thousandth of an inch is `0.001 in`"
            }
            Failure::UnknownUnit(unit) if matches!(unit.as_str(), "inches" | "inchs" | "ins" | "IN" | "In") => {
                "inches are `in`, as in `12 in`"
            }
            Failure::UnknownUnit(unit) if unit.starts_with("micron") => "micrometres are `um`, as in `6 um`",
            Failure::UnknownUnit(unit) if units::unit(&unit.to_lowercase()).is_ok() => {
                "units are in small letters, as in `6 um` or `0.006 mm`"
            }
            Failure::UnknownUnit(_) => "nm um mm cm m in; urad mrad rad arcsec arcmin deg; with / and ^ as in urad/m^2",
            Failure::DecimalComma(_) => "write a decimal point, as in `1.5 um`",
            Failure::NotFinite(_) => "write a finite number",
            Failure::NotANumber(text) if text.ends_with(".csv") || text.ends_with(".txt") => {
                "a table of an error is `{ table: FILE }`"
            }
            Failure::NotANumber(_) => "write a number with its unit, as in `12 um`",
        };
        let code = if matches!(failure, Failure::NoUnit(_)) { codes::E0204 } else { codes::E0206 };
        self.at_value(code, at, shown(&failure.to_string()), help);
    }

    /// Returns a quantity with its unit.
    pub fn quantity(&mut self, scalar: &Scalar, at: &Keys) -> Option<Quantity> {
        let parsed = match scalar {
            Scalar::Text(text) => units::quantity(text),
            Scalar::Number(n) if n.is_finite() => Err(Failure::NoUnit(n.to_string())),
            Scalar::Number(n) => Err(Failure::NotFinite(n.to_string())),
        };
        parsed.map_err(|failure| self.unreadable(at, &failure)).ok()
    }

    /// Returns a bare number, written as one or as text.
    fn bare(scalar: &Scalar) -> Option<Result<f64, Failure>> {
        match scalar {
            Scalar::Number(n) if n.is_finite() => Some(Ok(*n)),
            Scalar::Number(n) => Some(Err(Failure::NotFinite(n.to_string()))),
            Scalar::Text(text) => match units::number(text) {
                Err(Failure::NotANumber(_)) => None,
                number => Some(number),
            },
        }
    }

    fn wrong_unit(&mut self, at: &Keys, scalar: &Scalar, found: Dimension, wanted: &str, help: &str) {
        let message = format!("`{}` is {}, but {wanted} belongs here", shown(&scalar.to_string()), found.word());
        self.at_value(codes::E0205, at, message, help);
    }

    /// Returns a position or length; a bare number is in mm (linear) or deg (rotary).
    pub fn position(&mut self, scalar: &Scalar, kind: AxisKind, at: &Keys) -> Option<f64> {
        let value = self.any_position(scalar, kind, at)?;
        if value.abs() > FARTHEST {
            let unit = kind.unit();
            let message = format!("`{}` is {value:e} {unit}, which no machine reaches", dotted_path(at));
            self.at_value(codes::E0213, at, message, "check the unit; a bare number is in mm or deg");
            return None;
        }
        Some(value)
    }

    fn any_position(&mut self, scalar: &Scalar, kind: AxisKind, at: &Keys) -> Option<f64> {
        if let Some(number) = Self::bare(scalar) {
            return number.map_err(|failure| self.unreadable(at, &failure)).ok();
        }
        if let (AxisKind::Rotary, Some(degrees)) = (kind, in_degrees(scalar)) {
            return Some(degrees);
        }
        let quantity = self.quantity(scalar, at)?;
        match kind {
            AxisKind::Linear if quantity.dimension == Dimension::LENGTH => Some(quantity.value),
            AxisKind::Rotary if quantity.dimension == Dimension::ANGLE => Some(quantity.value.to_degrees()),
            AxisKind::Linear => {
                self.wrong_unit(at, scalar, quantity.dimension, "a length", LENGTHS);
                None
            }
            AxisKind::Rotary => {
                self.wrong_unit(at, scalar, quantity.dimension, "an angle", "positions of rotary axes are in deg");
                None
            }
        }
    }

    /// Returns a length; a bare number is in mm.
    pub fn length(&mut self, scalar: &Scalar, at: &Keys) -> Option<f64> {
        self.position(scalar, AxisKind::Linear, at)
    }

    /// Three lengths.
    pub fn vector(&mut self, list: &[Scalar], at: &Keys) -> Option<[f64; 3]> {
        if list.len() != 3 {
            let message = format!("`{}` has {} numbers, a point has three", dotted_path(at), list.len());
            let help = slip_in_list(list)
                .unwrap_or_else(|| "write [x, y, z] in machine coordinates, mm, with decimal points".to_owned());
            self.at_value(codes::E0207, at, message, help);
            return None;
        }
        let parts: Vec<Option<f64>> = list.iter().enumerate().map(|(i, s)| self.length(s, &below(at, i))).collect();
        Some([parts[0]?, parts[1]?, parts[2]?])
    }

    /// Returns the value of an error in a direction (mm or rad).
    pub fn error_value(&mut self, scalar: &Scalar, direction: Direction, at: &Keys) -> Option<f64> {
        self.coefficient(scalar, direction, AxisKind::Linear, 0, at)
    }

    /// Returns a coefficient of the position to a power: its unit must name the argument. Per mm or per deg.
    pub fn coefficient(
        &mut self,
        scalar: &Scalar,
        direction: Direction,
        kind: AxisKind,
        power: i8,
        at: &Keys,
    ) -> Option<f64> {
        let quantity = self.quantity(scalar, at)?;
        let (length, angle) = match kind {
            AxisKind::Linear => (-power, 0),
            AxisKind::Rotary => (0, -power),
        };
        let whole = |l, a| Dimension { length: length + l, angle: angle + a };
        let fits = if direction.is_rotation() {
            // A ratio of lengths is an angle.
            quantity.dimension == whole(0, 1) || quantity.dimension == whole(0, 0)
        } else {
            quantity.dimension == whole(1, 0)
        };
        if !fits {
            self.misfit(scalar, quantity.dimension, direction, kind, power, at);
            return None;
        }
        let scale =
            if kind == AxisKind::Rotary { libm::pow(std::f64::consts::PI / 180.0, f64::from(power)) } else { 1.0 };
        Some(quantity.value * scale)
    }

    fn misfit(
        &mut self,
        scalar: &Scalar,
        found: Dimension,
        direction: Direction,
        kind: AxisKind,
        power: i8,
        at: &Keys,
    ) {
        let (wanted, unit, help) =
            if direction.is_rotation() { ("an angle", "urad", ANGLES) } else { ("a length", "um", LENGTHS) };
        if power == 0 {
            let other = at.get(1).filter(|_| at[0] == "errors").and_then(|key| in_other_letters(key));
            let help = other.map_or_else(|| help.to_owned(), |hint| format!("{hint}; {help}"));
            return self.wrong_unit(at, scalar, found, wanted, &help);
        }
        let argument = if kind == AxisKind::Linear { "m" } else { "deg" };
        let exponent = if power == 1 { String::new() } else { format!("^{power}") };
        let wanted = format!("a coefficient in {unit}/{argument}{exponent}");
        self.wrong_unit(at, scalar, found, &wanted, "the unit of a coefficient names its argument: um, um/m, um/m^2");
    }
}

/// Degrees written as such stay as exact as they are written.
fn in_degrees(scalar: &Scalar) -> Option<f64> {
    let Scalar::Text(text) = scalar else { return None };
    let number = text.trim().strip_suffix("deg").or_else(|| text.trim().strip_suffix('°'))?;
    units::number(number).ok()
}
