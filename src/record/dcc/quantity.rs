//! Lists of values of a certificate, checked for what its schema leaves open: units, lengths, and finite numbers.

use crate::units::significant;

/// Units of D-SI without a prefix.
const UNITS: [&str; 26] = [
    "metre",
    "gram",
    "kilogram",
    "second",
    "ampere",
    "kelvin",
    "mole",
    "candela",
    "one",
    "radian",
    "steradian",
    "hertz",
    "newton",
    "pascal",
    "joule",
    "watt",
    "volt",
    "minute",
    "hour",
    "day",
    "degree",
    "arcminute",
    "arcsecond",
    "degreecelsius",
    "litre",
    "percent",
];

/// Prefixes of D-SI.
const PREFIXES: [&str; 20] = [
    "deca", "hecto", "kilo", "mega", "giga", "tera", "peta", "exa", "zetta", "yotta", "deci", "centi", "milli",
    "micro", "nano", "pico", "femto", "atto", "zepto", "yocto",
];

const DIGITS: usize = 9;

/// Reason why a list is no list of quantities.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ListFault {
    /// A unit that D-SI does not have.
    #[error("`{0}` is no unit of D-SI")]
    Unit(String),
    /// Lists of different lengths: what is listed, its number of values and the number of the first list.
    #[error("`{0}` has {1} values where {2} belong")]
    Length(String, usize, usize),
    /// A number that is not finite, or an uncertainty below 0, of this list.
    #[error("`{0}` has a value that cannot be written")]
    Number(String),
}

/// True for a unit of D-SI: `\micro\metre`, `\metre\tothe{-1}`, products of them.
pub fn is_unit(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('\\') else { return false };
    let (mut prefix, mut unit) = (false, false);
    for word in rest.split('\\') {
        let power = word.strip_prefix("tothe{").and_then(|rest| rest.strip_suffix('}'));
        if let Some(power) = power {
            if prefix || !unit || power.parse::<f64>().is_err() {
                return false;
            }
            unit = false;
        } else if UNITS.contains(&word) {
            (prefix, unit) = (false, true);
        } else if PREFIXES.contains(&word) && !prefix {
            prefix = true;
        } else {
            return false;
        }
    }
    !prefix
}

/// Values of one quantity in the order of the rows.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantityList {
    /// Name, as it is printed.
    pub name: String,
    /// Type of the quantity in the vocabulary of the certificate.
    pub ref_type: &'static str,
    /// The unit, as D-SI writes it.
    pub unit: &'static str,
    /// The values.
    pub values: Vec<f64>,
    /// Expanded uncertainties (k = 2), one for each value; empty if they are not known.
    pub expanded: Vec<f64>,
}

/// Columns of one table.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantityTable {
    /// Name of the table.
    pub name: String,
    /// Its columns, all of one length.
    pub lists: Vec<QuantityList>,
}

#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct WrittenList {
    name: String,
    ref_type: &'static str,
    unit: &'static str,
    values: String,
    expanded: String,
    /// Coverage factors and probabilities, one for each uncertainty.
    factors: String,
    probabilities: String,
}

impl QuantityTable {
    /// Checks every column: the unit, the number of values, and the values themselves.
    pub fn check(&self) -> Result<(), ListFault> {
        let rows = self.lists.first().map_or(0, |list| list.values.len());
        let wrong = |list: &QuantityList, found: usize| Err(ListFault::Length(list.name.clone(), found, rows));
        for list in &self.lists {
            let sizes = [list.values.len(), list.expanded.len()];
            if !is_unit(list.unit) {
                return Err(ListFault::Unit(list.unit.to_owned()));
            }
            if sizes[0] != rows || rows == 0 {
                return wrong(list, sizes[0]);
            }
            if sizes[1] != 0 && sizes[1] != rows {
                return wrong(list, sizes[1]);
            }
            let poor = |value: &f64| !value.is_finite();
            if list.values.iter().any(poor) || list.expanded.iter().any(|u| poor(u) || *u < 0.0) {
                return Err(ListFault::Number(list.name.clone()));
            }
        }
        Ok(())
    }

    pub(crate) fn lists(&self) -> Vec<WrittenList> {
        let text = |values: &[f64]| values.iter().map(|x| significant(*x, DIGITS)).collect::<Vec<_>>().join(" ");
        let each = |word: &str, list: &QuantityList| vec![word; list.expanded.len()].join(" ");
        let written = |list: &QuantityList| WrittenList {
            name: list.name.clone(),
            ref_type: list.ref_type,
            unit: list.unit,
            values: text(&list.values),
            expanded: text(&list.expanded),
            factors: each("2", list),
            probabilities: each("0.95", list),
        };
        self.lists.iter().map(written).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_d_si() {
        for unit in [r"\milli\metre", r"\micro\radian", r"\degree", r"\one", r"\metre\tothe{-1}", r"\micro\metre\metre"]
        {
            assert!(is_unit(unit), "{unit}");
        }
        for unit in
            ["mm", "", r"\", r"\mm", r"\milli", r"\milli\micro\metre", r"\tothe{2}", r"\metre\tothe{x}", "metre"]
        {
            assert!(!is_unit(unit), "{unit}");
        }
    }

    fn table(unit: &'static str, values: &[f64], expanded: &[f64]) -> QuantityTable {
        let list = |name: &str, unit, values: &[f64], expanded: &[f64]| QuantityList {
            name: name.to_owned(),
            ref_type: "basic_measurementError",
            unit,
            values: values.to_vec(),
            expanded: expanded.to_vec(),
        };
        let lists = vec![list("X", r"\milli\metre", &[0.0, 1.0, 2.0], &[]), list("EXX", unit, values, expanded)];
        QuantityTable { name: "EXX".to_owned(), lists }
    }

    #[test]
    fn lists_that_the_schema_would_let_pass_are_refused() {
        let micro = r"\micro\metre";
        assert_eq!(table(micro, &[1.0, 2.0, 3.0], &[0.5, 0.5, 0.5]).check(), Ok(()));
        assert_eq!(table(micro, &[1.0, 2.0, 3.0], &[]).check(), Ok(()));
        assert_eq!(table("um", &[1.0, 2.0, 3.0], &[]).check(), Err(ListFault::Unit("um".to_owned())));
        let length = |found| Err(ListFault::Length("EXX".to_owned(), found, 3));
        assert_eq!(table(micro, &[1.0, 2.0], &[]).check(), length(2));
        assert_eq!(table(micro, &[1.0, 2.0, 3.0], &[0.5]).check(), length(1));
        let number = Err(ListFault::Number("EXX".to_owned()));
        assert_eq!(table(micro, &[1.0, f64::NAN, 3.0], &[]).check(), number);
        assert_eq!(table(micro, &[1.0, 2.0, 3.0], &[0.5, -0.5, 0.5]).check(), number);
        assert!(QuantityTable { name: String::new(), lists: Vec::new() }.check().is_ok());
    }
}
