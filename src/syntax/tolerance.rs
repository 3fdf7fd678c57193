//! Bounds as written: the sections `tolerances` and `class`.

use super::forms::{deserialize_by_forms, mapping_or_value};
use super::scalar::Scalar;
use serde::Deserialize;

/// Bounds along an axis and across it: of translations, and of rotations about these directions.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FrameEntry {
    /// Translation along the axis.
    pub along: Option<Scalar>,
    /// Translations across it, each.
    pub across: Option<Scalar>,
    /// Rotation about the axis.
    pub about_along: Option<Scalar>,
    /// Rotations about the directions across it, each.
    pub about_across: Option<Scalar>,
}

/// The bound of an error, of an axis, or of a squareness.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default, remote = "Self")]
pub struct BoundEntry {
    /// Of an error or squareness: anywhere from minus to plus.
    pub value: Option<Scalar>,
    /// Of an axis: translation along it.
    pub along: Option<Scalar>,
    /// Of an axis: translations across it, each.
    pub across: Option<Scalar>,
    /// Of an axis: rotation about it.
    pub about_along: Option<Scalar>,
    /// Of an axis: rotations about the directions across it, each.
    pub about_across: Option<Scalar>,
    /// Of an axis: its location errors.
    pub location: Option<FrameEntry>,
    /// Whole width of the band that holds the error.
    pub width: Option<Scalar>,
    /// ISO 230-2: bidirectional accuracy of positioning.
    #[serde(rename = "A")]
    pub a: Option<Scalar>,
    /// ISO 230-2: bidirectional systematic positioning error.
    #[serde(rename = "E")]
    pub e: Option<Scalar>,
    /// ISO 230-2: range of the mean bidirectional positioning error.
    #[serde(rename = "M")]
    pub m: Option<Scalar>,
    /// ISO 230-2: reversal error; beside M.
    #[serde(rename = "B")]
    pub b: Option<Scalar>,
    /// ISO 230-2: bidirectional repeatability; beside E or M.
    #[serde(rename = "R")]
    pub r: Option<Scalar>,
    /// VDI/DGQ 3441: positioning uncertainty.
    #[serde(rename = "P")]
    pub p: Option<Scalar>,
    /// VDI/DGQ 3441: positional deviation.
    #[serde(rename = "Pa")]
    pub pa: Option<Scalar>,
    /// VDI/DGQ 3441: reversal error; beside Pa.
    #[serde(rename = "U")]
    pub u: Option<Scalar>,
    /// VDI/DGQ 3441: scatter of positions; beside Pa.
    #[serde(rename = "Ps")]
    pub ps: Option<Scalar>,
}

impl BoundEntry {
    /// Bounds along and across the axis.
    pub fn frame(&self) -> FrameEntry {
        FrameEntry {
            along: self.along.clone(),
            across: self.across.clone(),
            about_along: self.about_along.clone(),
            about_across: self.about_across.clone(),
        }
    }

    /// The words of data sheets that are given.
    pub fn words(&self) -> Vec<(&'static str, &Scalar)> {
        let all = [
            ("width", &self.width),
            ("A", &self.a),
            ("E", &self.e),
            ("M", &self.m),
            ("B", &self.b),
            ("R", &self.r),
            ("P", &self.p),
            ("Pa", &self.pa),
            ("U", &self.u),
            ("Ps", &self.ps),
        ];
        all.into_iter().filter_map(|(word, value)| Some((word, value.as_ref()?))).collect()
    }
}

impl FrameEntry {
    /// The four bounds: along, across, about along, about across.
    pub fn four(&self) -> [Option<&Scalar>; 4] {
        [&self.along, &self.across, &self.about_along, &self.about_across].map(Option::as_ref)
    }
}

/// The class of machines that bounds what the file does not: the name of one, numbers of one's own, or both.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default, remote = "Self")]
pub struct ClassEntry {
    /// The class that has the numbers that are not given here.
    #[schemars(schema_with = "super::schema_forms::class_name")]
    pub like: Option<String>,
    /// Source of the numbers, one line.
    pub source: Option<String>,
    /// Linear axes, and the spindle's tilt.
    pub linear: Option<LinearClassEntry>,
    /// Rotary axes.
    pub rotary: Option<RotaryClassEntry>,
}

impl ClassEntry {
    /// A number by its section and key.
    pub fn number(&self, section: &str, key: &str) -> Option<&Scalar> {
        let (linear, rotary) = (self.linear.as_ref(), self.rotary.as_ref());
        match (section, key) {
            ("linear", "positioning") => linear?.positioning.as_ref(),
            ("linear", "straightness") => linear?.straightness.as_ref(),
            ("linear", "angular") => linear?.angular.as_ref(),
            ("linear", "squareness") => linear?.squareness.as_ref(),
            ("rotary", "position") => rotary?.position.as_ref(),
            ("rotary", "orientation") => rotary?.orientation.as_ref(),
            ("rotary", "radial") => rotary?.radial.as_ref(),
            ("rotary", "axial") => rotary?.axial.as_ref(),
            ("rotary", "tilt") => rotary?.tilt.as_ref(),
            ("rotary", "angular_positioning") => rotary?.angular_positioning.as_ref(),
            _ => None,
        }
    }
}

/// Bounds of linear axes.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LinearClassEntry {
    /// Error along the axis, per length of its travel.
    pub positioning: Option<Scalar>,
    /// Errors across it, per length of its travel.
    pub straightness: Option<Scalar>,
    /// Roll, pitch and yaw.
    pub angular: Option<Scalar>,
    /// Squareness and parallelism, and tilts of the spindle.
    pub squareness: Option<Scalar>,
    /// A shorter travel counts as this.
    #[schemars(schema_with = "super::schema_forms::length")]
    pub shortest: Option<Scalar>,
}

/// Bounds of rotary axes.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RotaryClassEntry {
    /// Place of the axis.
    pub position: Option<Scalar>,
    /// Tilt of the axis.
    pub orientation: Option<Scalar>,
    /// Error motion across the axis.
    pub radial: Option<Scalar>,
    /// Error motion along it.
    pub axial: Option<Scalar>,
    /// Tilt error motion.
    pub tilt: Option<Scalar>,
    /// Angle about the axis.
    pub angular_positioning: Option<Scalar>,
}

mapping_or_value!(
    BoundEntry,
    value: std::convert::identity,
    "a bound with its unit, or a mapping such as { across: 3 um } or { A: 8 um }"
);
mapping_or_value!(
    ClassEntry,
    like: |name: Scalar| name.to_string(),
    "the name of a class, or a mapping such as { like: premium, linear: { ... } }"
);
deserialize_by_forms!(BoundEntry, ClassEntry);
