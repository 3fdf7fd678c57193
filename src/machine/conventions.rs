//! Conventions of the error model (docs/theory.md, section on joints) and the three papers' presets.

use crate::syntax::from_yaml;
use serde::{Deserialize, Serialize};

/// The action of a location error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Location {
    /// `Loc N Loc^-1`: the axis of motion is displaced; nothing happens at the zero pose.
    AxisOnly,
    /// `Loc N`: the carried body is displaced at every position.
    CarriedBody,
}

/// The side of the motion on which the component errors of a linear axis act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinearOrder {
    /// `N E`: on the carriage.
    After,
    /// `E N`: on the guide.
    Before,
}

/// The side of the motion on which the component errors of a rotary axis act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RotaryOrder {
    /// `E N`: in the frame that does not turn.
    Stationary,
    /// `N E`: in the frame that turns.
    Rotating,
}

/// The sense of a positive command of a workpiece-side axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sense {
    /// It moves the tool in + relative to the workpiece (the body moves in -).
    Iso841,
    /// It moves the carried body in +.
    Direct,
}

/// The body whose error motion the numbers of a workpiece-side axis describe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ErrorsAre {
    /// The tool relative to the workpiece.
    ToolRelative,
    /// The carried body itself.
    Body,
}

/// The order of location errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LocationOrder {
    /// First order, like all errors.
    Nilpotent,
    /// In the real part of the joint, while the nominal machine stays without them (2015 paper).
    Real,
}

/// Shape of an error matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Joints {
    /// `exp(hat(eps))`.
    Orthogonal,
    /// `1 + hat(eps)`, as the papers print it.
    Linearised,
}

/// The conventions in force for a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct Conventions {
    /// The action of location errors.
    pub location: Location,
    /// Component errors of linear axes.
    pub linear: LinearOrder,
    /// Component errors of rotary axes.
    pub rotary: RotaryOrder,
    /// Sense of workpiece-side axes.
    pub workpiece_axes: Sense,
    /// Owner of the errors of workpiece-side axes.
    pub errors_are: ErrorsAre,
    /// Order of location errors.
    pub location_order: LocationOrder,
    /// Shape of error matrices.
    pub joints: Joints,
    /// Order used when the command line names none (`hrdina-vasik-2014` is of order 1, `holub-2015` of order 2);
    /// `None` is exact.
    pub default_order: Option<u8>,
}

impl Default for Conventions {
    fn default() -> Self {
        Self {
            location: Location::AxisOnly,
            linear: LinearOrder::After,
            rotary: RotaryOrder::Stationary,
            workpiece_axes: Sense::Iso841,
            errors_are: ErrorsAre::ToolRelative,
            location_order: LocationOrder::Nilpotent,
            joints: Joints::Orthogonal,
            default_order: None,
        }
    }
}

impl Conventions {
    /// Names of the presets.
    pub const PRESETS: [&'static str; 3] = ["holub-2015", "bui-kimm", "hrdina-vasik-2014"];

    /// These, changed as a text says: the name of a preset, words such as `carried_body`, or keys as in a machine
    /// file, `linear: before, rotary: rotating`; what is not named stays.
    pub fn amend(&self, text: &str) -> Result<Self, ConventionsFailure> {
        let items: Vec<String> = text.split(',').map(|item| with_key(item.trim())).collect::<Result<_, _>>()?;
        let words: ConventionWords =
            from_yaml(&format!("{{{}}}", items.join(", "))).map_err(|e| ConventionsFailure::Keys(e.to_string()))?;
        let base = match &words.preset {
            Some(name) => Self::preset(name).ok_or_else(|| ConventionsFailure::Preset(name.clone()))?,
            None => *self,
        };
        Ok(Self {
            location: words.location.unwrap_or(base.location),
            linear: words.linear.unwrap_or(base.linear),
            rotary: words.rotary.unwrap_or(base.rotary),
            workpiece_axes: words.workpiece_axes.unwrap_or(base.workpiece_axes),
            errors_are: words.errors_are.unwrap_or(base.errors_are),
            location_order: words.location_order.unwrap_or(base.location_order),
            joints: words.joints.unwrap_or(base.joints),
            default_order: base.default_order,
        })
    }

    /// Returns every word that [`Self::amend`] knows.
    pub fn words() -> Vec<&'static str> {
        let words = CHOICES.iter().flat_map(|(_, words)| words.iter().copied());
        Self::PRESETS.into_iter().chain(words).collect()
    }

    /// Keys and words of what differs: `location axis_only -> carried_body`.
    pub fn changes(&self, new: &Self) -> Vec<String> {
        let words = |conventions: &Self| serde_json::to_value(conventions).unwrap_or_default();
        let (old, new) = (words(self), words(new));
        let word = |value: &serde_json::Value, key: &str| value[key].as_str().unwrap_or_default().to_owned();
        let change = |(key, _): &(&str, &[&str])| {
            let (old, new) = (word(&old, key), word(&new, key));
            (old != new).then(|| format!("{key} {old} -> {new}"))
        };
        CHOICES.iter().filter_map(change).collect()
    }

    /// Returns the conventions of one of the three papers.
    pub fn preset(name: &str) -> Option<Self> {
        let base = Self { joints: Joints::Linearised, ..Self::default() };
        match name {
            "holub-2015" => Some(Self { location_order: LocationOrder::Real, default_order: Some(2), ..base }),
            "bui-kimm" => Some(Self {
                location: Location::CarriedBody,
                workpiece_axes: Sense::Direct,
                errors_are: ErrorsAre::Body,
                ..base
            }),
            "hrdina-vasik-2014" => Some(Self { linear: LinearOrder::Before, default_order: Some(1), ..base }),
            _ => None,
        }
    }
}

/// A text that names no conventions.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConventionsFailure {
    /// A word that is neither a preset nor a choice.
    #[error("`{0}` is neither a preset nor a word of any key")]
    Word(String),
    /// A preset that does not exist.
    #[error("there is no preset `{}`; they are {}", .0, Conventions::PRESETS.join(", "))]
    Preset(String),
    /// Keys or values that the parser refuses, in its words.
    #[error("{0}")]
    Keys(String),
}

const CHOICES: [(&str, &[&str]); 7] = [
    ("location", &["axis_only", "carried_body"]),
    ("linear", &["after", "before"]),
    ("rotary", &["stationary", "rotating"]),
    ("workpiece_axes", &["iso841", "direct"]),
    ("errors_are", &["tool_relative", "body"]),
    ("location_order", &["nilpotent", "real"]),
    ("joints", &["orthogonal", "linearised"]),
];

fn with_key(item: &str) -> Result<String, ConventionsFailure> {
    if item.contains(':') {
        return Ok(item.to_owned());
    }
    let of = CHOICES.iter().find(|(_, words)| words.contains(&item)).map(|(key, _)| *key);
    let key = of.or_else(|| Conventions::PRESETS.contains(&item).then_some("preset"));
    key.map(|key| format!("{key}: {item}")).ok_or_else(|| ConventionsFailure::Word(item.to_owned()))
}

/// Keys as in a machine file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ConventionWords {
    preset: Option<String>,
    location: Option<Location>,
    linear: Option<LinearOrder>,
    rotary: Option<RotaryOrder>,
    workpiece_axes: Option<Sense>,
    errors_are: Option<ErrorsAre>,
    location_order: Option<LocationOrder>,
    joints: Option<Joints>,
}
