//! The cost of tolerances: the sum over the errors of weight / tolerance^power, the tolerance in um or urad.

use super::bounds::Bound;
use crate::diagnostic::Reason;
use crate::machine::{Direction, ErrorId, ErrorKind, Machine, parse_error_name};
use crate::units;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Without a limit of its own a tolerance is at finest this fraction of the stated one.
const FINEST: f64 = 0.01;

/// Without a limit of its own a tolerance is at coarsest so many times the stated one.
const COARSEST: f64 = 10.0;

/// A cost model as it is written. Keys of the maps are names of kinds or of errors; an error goes before its kind.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CostModel {
    /// Exponent of the tolerance.
    pub power: f64,
    /// Weights, 1 where none is given.
    pub weights: BTreeMap<String, f64>,
    /// Finest tolerances, such as `1 um`.
    pub finest: BTreeMap<String, String>,
    /// Coarsest tolerances.
    pub coarsest: BTreeMap<String, String>,
}

impl Default for CostModel {
    fn default() -> Self {
        Self { power: 1.0, weights: BTreeMap::new(), finest: BTreeMap::new(), coarsest: BTreeMap::new() }
    }
}

/// The price of one bounded error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Price {
    /// Its kind.
    pub kind: ErrorKind,
    /// Its weight.
    pub weight: f64,
    /// Finest tolerance (mm, rad).
    pub finest: f64,
    /// Coarsest tolerance (mm, rad).
    pub coarsest: f64,
    /// um in a mm, or urad in a rad.
    pub per_unit: f64,
}

impl Price {
    /// Returns the cost of a tolerance (mm, rad).
    pub fn cost(&self, tolerance: f64, power: f64) -> f64 {
        self.weight / libm::pow(tolerance * self.per_unit, power)
    }
}

impl CostModel {
    /// Returns a model that was read, if it is one. Fails with the reason.
    pub fn validate(self) -> Result<Self, Reason> {
        let model = self;
        if !(model.power > 0.0 && model.power <= 10.0) {
            return Err(Reason::new(format!("`power` is {}; it is above 0 and 10 at most", model.power)));
        }
        if let Some((key, weight)) = model.weights.iter().find(|(_, weight)| !(**weight > 0.0 && weight.is_finite())) {
            return Err(Reason::new(format!("the weight of `{key}` is {weight}; it is above 0")));
        }
        let keys = model.weights.keys().chain(model.finest.keys()).chain(model.coarsest.keys());
        let known = |key: &str| ErrorKind::ALL.iter().any(|kind| kind.name() == key) || parse_error_name(key).is_some();
        if let Some(key) = keys.into_iter().find(|key| !known(key)) {
            let kinds = ErrorKind::ALL.map(ErrorKind::name).join(", ");
            return Err(Reason::new(format!("`{key}` is no error and no kind of error; the kinds are {kinds}")));
        }
        Ok(model)
    }

    /// Returns the prices of the bounded errors. Fails for limits in wrong units and limits that leave nothing.
    pub fn prices(&self, machine: &Machine, bounds: &[Bound]) -> Result<Vec<Price>, Reason> {
        bounds.iter().map(|bound| self.price(machine, bound)).collect()
    }

    fn price(&self, machine: &Machine, bound: &Bound) -> Result<Price, Reason> {
        let error = &bound.error;
        let axis = machine.axis_index(error.axis.as_str()).map(|index| &machine.axes()[index]);
        let kind = ErrorKind::of(axis, error, axis.is_some_and(|axis| bound.is_along(axis)));
        let limit = |of: &BTreeMap<String, String>, plain: f64| match entry(of, error, kind) {
            Some(text) => limit(text, error.direction),
            None => Ok(plain),
        };
        let finest = limit(&self.finest, bound.tolerance * FINEST)?;
        let coarsest = limit(&self.coarsest, bound.tolerance * COARSEST)?;
        if finest > coarsest {
            return Err(Reason::new(format!("the finest tolerance of `{error}` is larger than the coarsest")));
        }
        let weight = entry(&self.weights, error, kind).copied().unwrap_or(1.0);
        let per_unit = error.direction.micro().0;
        Ok(Price { kind, weight, finest, coarsest, per_unit })
    }
}

/// Returns what is given for an error, or else for its kind.
fn entry<'a, T>(of: &'a BTreeMap<String, T>, error: &ErrorId, kind: ErrorKind) -> Option<&'a T> {
    let own = of.iter().find(|(key, _)| parse_error_name(key).as_ref() == Some(error)).map(|(_, value)| value);
    own.or_else(|| of.get(kind.name()))
}

fn limit(text: &str, direction: Direction) -> Result<f64, Reason> {
    let quantity = units::quantity(text).map_err(|failure| Reason::new(format!("`{text}`: {failure}")))?;
    let (value, example) = if direction.is_rotation() {
        (quantity.as_angle(), "an angle such as `5 urad`")
    } else {
        (quantity.as_length(), "a length such as `2 um`")
    };
    let fits = value.filter(|value| *value > 0.0 && value.is_finite());
    fits.ok_or_else(|| Reason::new(format!("the limit `{text}` is not {example}, above 0")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<CostModel, Reason> {
        serde_yaml::from_str::<CostModel>(text).map_err(Reason::new)?.validate()
    }

    #[test]
    fn a_model_is_read_and_refused_with_its_reason() {
        let model = parse("power: 2\nweights: { straightness: 3, EXX: 0.5 }\nfinest: { tilt: 2 urad }\n");
        let model = model.unwrap();
        assert_eq!((model.power, model.weights["EXX"], model.finest["tilt"].as_str()), (2.0, 0.5, "2 urad"));
        assert_eq!(parse("{}"), Ok(CostModel::default()));
        for (text, words) in [
            ("wieghts: {}", "wieghts"),
            ("power: 0", "power"),
            ("weights: { EXX: -1 }", "EXX"),
            ("weights: { squarness: 1 }", "the kinds are positioning"),
        ] {
            let failure = parse(text).unwrap_err();
            assert!(failure.to_string().contains(words), "{failure:?}");
        }
        assert!(limit("2 urad", Direction::X).is_err() && limit("2 um", Direction::X) == Ok(0.002));
        assert_eq!(
            limit("-2 um", Direction::X).unwrap_err().to_string(),
            "the limit `-2 um` is not a length such as `2 um`, above 0"
        );
    }
}
