//! Conventions of the error model (docs/theory.md, section on joints) and the three papers' presets.

use serde::{Deserialize, Serialize};

/// How a location error acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Location {
    /// `Loc N Loc^-1`: the axis of motion is displaced; nothing happens at the zero pose.
    AxisOnly,
    /// `Loc N`: the carried body is displaced at every position.
    CarriedBody,
}

/// Where the component errors of a linear axis sit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinearOrder {
    /// `N E`: on the carriage.
    After,
    /// `E N`: on the guide.
    Before,
}

/// Where the component errors of a rotary axis sit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RotaryOrder {
    /// `E N`: in the frame that does not turn.
    Stationary,
    /// `N E`: in the frame that turns.
    Rotating,
}

/// What a positive command of a workpiece-side axis does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sense {
    /// It moves the tool in + relative to the workpiece (the body moves in -).
    Iso841,
    /// It moves the carried body in +.
    Direct,
}

/// Whose error motion the numbers of a workpiece-side axis are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ErrorsAre {
    /// Of the tool relative to the workpiece.
    ToolRelative,
    /// Of the carried body itself.
    Body,
}

/// Of which order location errors are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LocationOrder {
    /// First order, like all errors.
    Nilpotent,
    /// In the real part of the joint, while the ideal machine stays without them (2015 paper).
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Conventions {
    /// How location errors act.
    pub location: Location,
    /// Component errors of linear axes.
    pub linear: LinearOrder,
    /// Component errors of rotary axes.
    pub rotary: RotaryOrder,
    /// Sense of workpiece-side axes.
    pub workpiece_axes: Sense,
    /// Whose errors those of workpiece-side axes are.
    pub errors_are: ErrorsAre,
    /// Order of location errors.
    pub location_order: LocationOrder,
    /// Shape of error matrices.
    pub joints: Joints,
    /// Order used when the command line names none (`hrdina-vasik-2014` is of order 1); `None` is exact.
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

    /// The conventions of one of the three papers.
    pub fn preset(name: &str) -> Option<Self> {
        let base = Self { joints: Joints::Linearised, ..Self::default() };
        match name {
            "holub-2015" => Some(Self { location_order: LocationOrder::Real, ..base }),
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
