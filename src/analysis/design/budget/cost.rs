//! What tolerances cost: the sum over the errors of weight / tolerance^power, the tolerance in um or urad.

use super::bounds::Bound;
use crate::machine::{AxisKind, Direction, ErrorFamily, ErrorId, Machine, parse_error_name};
use crate::units;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Without a limit of its own a tolerance is at finest this fraction of the stated one.
const FINEST: f64 = 0.01;

/// Without a limit of its own a tolerance is at coarsest so many times the stated one.
const COARSEST: f64 = 10.0;

/// The kind of an error, by which it is paid for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorKind {
    /// Of a linear axis along itself.
    Positioning,
    /// Of a linear axis across itself.
    Straightness,
    /// Rotation of the carriage of a linear axis.
    Angular,
    /// Orientation of a linear axis, or of the spindle.
    Squareness,
    /// Position of an axis.
    Position,
    /// Orientation of a rotary axis.
    Orientation,
    /// Of a rotary axis across itself.
    Radial,
    /// Of a rotary axis along itself.
    Axial,
    /// Rotation of a rotary axis across itself.
    Tilt,
    /// Of a rotary axis about itself.
    AngularPositioning,
}

impl ErrorKind {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Positioning,
        Self::Straightness,
        Self::Angular,
        Self::Squareness,
        Self::Position,
        Self::Orientation,
        Self::Radial,
        Self::Axial,
        Self::Tilt,
        Self::AngularPositioning,
    ];

    /// Returns the name in a cost model.
    pub fn name(self) -> &'static str {
        match self {
            Self::Positioning => "positioning",
            Self::Straightness => "straightness",
            Self::Angular => "angular",
            Self::Squareness => "squareness",
            Self::Position => "position",
            Self::Orientation => "orientation",
            Self::Radial => "radial",
            Self::Axial => "axial",
            Self::Tilt => "tilt",
            Self::AngularPositioning => "angular_positioning",
        }
    }

    /// Returns the kind of a bounded error of a machine.
    pub fn of(machine: &Machine, bound: &Bound) -> Self {
        let error = &bound.error;
        let axis = machine.axis_index(error.axis.as_str()).map(|index| &machine.axes()[index]);
        let turns = error.direction.is_rotation();
        let own = axis.is_some_and(|axis| bound.is_along(axis));
        match (axis.map(|axis| axis.kind), error.family, turns) {
            (None | Some(AxisKind::Linear), ErrorFamily::Location, true) => Self::Squareness,
            (_, ErrorFamily::Location, false) => Self::Position,
            (Some(AxisKind::Rotary), ErrorFamily::Location, true) => Self::Orientation,
            (None | Some(AxisKind::Linear), ErrorFamily::Component, true) => Self::Angular,
            (None | Some(AxisKind::Linear), ErrorFamily::Component, false) if own => Self::Positioning,
            (None | Some(AxisKind::Linear), ErrorFamily::Component, false) => Self::Straightness,
            (Some(AxisKind::Rotary), ErrorFamily::Component, true) if own => Self::AngularPositioning,
            (Some(AxisKind::Rotary), ErrorFamily::Component, true) => Self::Tilt,
            (Some(AxisKind::Rotary), ErrorFamily::Component, false) if own => Self::Axial,
            (Some(AxisKind::Rotary), ErrorFamily::Component, false) => Self::Radial,
        }
    }
}

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

/// The reason why a cost model does not fit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CostFailure(pub String);

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
    pub fn checked(self) -> Result<Self, CostFailure> {
        let model = self;
        if !(model.power > 0.0 && model.power <= 10.0) {
            return Err(CostFailure(format!("`power` is {}; it is above 0 and 10 at most", model.power)));
        }
        if let Some((key, weight)) = model.weights.iter().find(|(_, weight)| !(**weight > 0.0 && weight.is_finite())) {
            return Err(CostFailure(format!("the weight of `{key}` is {weight}; it is above 0")));
        }
        let keys = model.weights.keys().chain(model.finest.keys()).chain(model.coarsest.keys());
        let known = |key: &str| ErrorKind::ALL.iter().any(|kind| kind.name() == key) || parse_error_name(key).is_some();
        if let Some(key) = keys.into_iter().find(|key| !known(key)) {
            let kinds = ErrorKind::ALL.map(ErrorKind::name).join(", ");
            return Err(CostFailure(format!("`{key}` is no error and no kind of error; the kinds are {kinds}")));
        }
        Ok(model)
    }

    /// Returns the prices of the bounded errors. Fails for limits in wrong units and limits that leave nothing.
    pub fn prices(&self, machine: &Machine, bounds: &[Bound]) -> Result<Vec<Price>, CostFailure> {
        bounds.iter().map(|bound| self.price(machine, bound)).collect()
    }

    fn price(&self, machine: &Machine, bound: &Bound) -> Result<Price, CostFailure> {
        let (error, kind) = (&bound.error, ErrorKind::of(machine, bound));
        let limit = |of: &BTreeMap<String, String>, plain: f64| match entry(of, error, kind) {
            Some(text) => limit(text, error.direction),
            None => Ok(plain),
        };
        let finest = limit(&self.finest, bound.tolerance * FINEST)?;
        let coarsest = limit(&self.coarsest, bound.tolerance * COARSEST)?;
        if finest > coarsest {
            return Err(CostFailure(format!("the finest tolerance of `{error}` is larger than the coarsest")));
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

fn limit(text: &str, direction: Direction) -> Result<f64, CostFailure> {
    let quantity = units::quantity(text).map_err(|failure| CostFailure(format!("`{text}`: {failure}")))?;
    let (value, example) = if direction.is_rotation() {
        (quantity.as_angle(), "an angle such as `5 urad`")
    } else {
        (quantity.as_length(), "a length such as `2 um`")
    };
    let fits = value.filter(|value| *value > 0.0 && value.is_finite());
    fits.ok_or_else(|| CostFailure(format!("the limit `{text}` is not {example}, above 0")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<CostModel, CostFailure> {
        serde_yaml::from_str::<CostModel>(text).map_err(|failure| CostFailure(failure.to_string()))?.checked()
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
            assert!(failure.0.contains(words), "{failure:?}");
        }
        assert!(limit("2 urad", Direction::X).is_err() && limit("2 um", Direction::X) == Ok(0.002));
        assert_eq!(
            limit("-2 um", Direction::X).unwrap_err().0,
            "the limit `-2 um` is not a length such as `2 um`, above 0"
        );
    }
}
