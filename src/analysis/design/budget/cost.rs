//! The cost of tolerances: the sum over the errors of weight * (present / new - 1), which counts a tolerance that is
//! halved as its weight; or of weight / tolerance^power, the tolerance in um or urad.

use super::bounds::Bound;
use crate::diagnostic::Reason;
use crate::machine::{Direction, ErrorId, ErrorKind, Machine, parse_error_name};
use crate::units;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Without a limit of its own a tolerance is at finest this fraction of the stated one.
const FINEST: f64 = 0.01;

/// Without a limit of its own a tolerance that may be loosened is at coarsest so many times the stated one.
const COARSEST: f64 = 10.0;

/// What the cost counts where no model names it.
const HALVED: &str = "tolerances halved";

/// A cost model as it is written. Keys of the maps are names of kinds or of errors; an error goes before its kind.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CostModel {
    /// Exponent of the tolerance; without one the cost is relative to the present tolerances.
    pub power: Option<f64>,
    /// What the cost counts, such as EUR.
    pub unit: Option<String>,
    /// True for what keeps its present tolerance.
    pub held: BTreeMap<String, bool>,
    /// Weights, 1 where none is given.
    pub weights: BTreeMap<String, f64>,
    /// Finest tolerances, such as `1 um`.
    pub finest: BTreeMap<String, String>,
    /// Coarsest tolerances.
    pub coarsest: BTreeMap<String, String>,
}

/// The price of one bounded error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Price {
    /// Its kind.
    pub kind: ErrorKind,
    /// Its weight.
    pub weight: f64,
    /// True if it keeps its present tolerance.
    pub held: bool,
    /// Present tolerance (mm, rad).
    pub present: f64,
    /// Exponent of the tolerance; without one the cost is relative to the present tolerance.
    pub power: Option<f64>,
    /// Finest tolerance (mm, rad).
    pub finest: f64,
    /// Coarsest tolerance (mm, rad).
    pub coarsest: f64,
    /// um in a mm, or urad in a rad.
    pub per_unit: f64,
}

impl Price {
    /// Returns the cost of a tolerance (mm, rad); relative to the present one, below zero for a coarser one.
    pub fn cost(&self, tolerance: f64) -> f64 {
        match self.power {
            Some(power) => self.weight / libm::pow(tolerance * self.per_unit, power),
            None => self.weight * (self.present / tolerance - 1.0),
        }
    }

    /// Returns how much the cost rises for a tolerance (mm, rad) that shrinks, relatively: -dc / d log t.
    pub fn rise(&self, tolerance: f64) -> f64 {
        match self.power {
            Some(power) => power * self.cost(tolerance),
            None => self.weight * self.present / tolerance,
        }
    }

    /// Returns the exponent of the tolerance in what changes the cost.
    pub fn exponent(&self) -> f64 {
        self.power.unwrap_or(1.0)
    }
}

impl CostModel {
    /// Returns a model that was read, if it is one. Fails with the reason.
    pub fn validate(self) -> Result<Self, Reason> {
        let model = self;
        if let Some(power) = model.power.filter(|power| !(*power > 0.0 && *power <= 10.0)) {
            return Err(Reason::new(format!("`power` is {power}; it is above 0 and 10 at most")));
        }
        if let Some((key, weight)) = model.weights.iter().find(|(_, weight)| !(**weight > 0.0 && weight.is_finite())) {
            return Err(Reason::new(format!("the weight of `{key}` is {weight}; it is above 0")));
        }
        let keys =
            model.weights.keys().chain(model.held.keys()).chain(model.finest.keys()).chain(model.coarsest.keys());
        let known = |key: &str| ErrorKind::ALL.iter().any(|kind| kind.name() == key) || parse_error_name(key).is_some();
        if let Some(key) = keys.into_iter().find(|key| !known(key)) {
            let kinds = ErrorKind::ALL.map(ErrorKind::name).join(", ");
            return Err(Reason::new(format!("`{key}` is no error and no kind of error; the kinds are {kinds}")));
        }
        Ok(model)
    }

    /// Returns what the cost counts.
    pub fn unit(&self) -> &str {
        match (&self.unit, self.power) {
            (Some(unit), _) => unit,
            (None, Some(_)) => "of weight / tolerance^power (um, urad)",
            (None, None) => HALVED,
        }
    }

    /// Returns the prices of the bounded errors; none is above its present tolerance unless it may be loosened, or
    /// its coarsest one is given. Fails for limits in wrong units and limits that leave nothing.
    pub fn prices(&self, machine: &Machine, bounds: &[Bound], loosen: bool) -> Result<Vec<Price>, Reason> {
        bounds.iter().map(|bound| self.price(machine, bound, loosen)).collect()
    }

    fn price(&self, machine: &Machine, bound: &Bound, loosen: bool) -> Result<Price, Reason> {
        let error = &bound.error;
        let axis = machine.axis_index(error.axis.as_str()).map(|index| &machine.axes()[index]);
        let kind = ErrorKind::of(axis, error, axis.is_some_and(|axis| bound.is_along(axis)));
        let limit = |of: &BTreeMap<String, String>, plain: f64| match entry(of, error, kind) {
            Some(text) => limit(text, error.direction),
            None => Ok(plain),
        };
        let (present, held) = (bound.tolerance, entry(&self.held, error, kind).copied().unwrap_or(false));
        let mut finest = limit(&self.finest, present * FINEST)?;
        let mut coarsest = limit(&self.coarsest, present * if loosen { COARSEST } else { 1.0 })?;
        if held {
            (finest, coarsest) = (present, present);
        } else if !loosen && entry(&self.coarsest, error, kind).is_none() {
            // A finest tolerance above the present one asks for nothing.
            finest = finest.min(present);
        }
        if finest > coarsest {
            return Err(Reason::new(format!("the finest tolerance of `{error}` is larger than the coarsest")));
        }
        let weight = entry(&self.weights, error, kind).copied().unwrap_or(1.0);
        let per_unit = error.direction.micro().0;
        Ok(Price { kind, weight, held, present, power: self.power, finest, coarsest, per_unit })
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
        assert_eq!((model.power.unwrap(), model.weights["EXX"], model.finest["tilt"].as_str()), (2.0, 0.5, "2 urad"));
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
