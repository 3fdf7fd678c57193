//! Bounds as written: the sections `tolerances` and `class`.

use super::forms::{Forms, deserialize_by_forms, mapping_or_value};
use super::scalar::Scalar;
use super::schema_forms::FIGURE_WORDS;
use serde::Deserialize;
use serde::de::MapAccess;

/// A bound along or across an axis: a value, or figures of a data sheet by their words.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FigureEntry {
    /// Anywhere from minus to plus.
    pub value: Option<Scalar>,
    /// Words of data sheets, such as `P`, with their figures.
    pub words: Vec<(&'static str, Scalar)>,
}

/// Bounds along an axis and across it: of translations, and of rotations about these directions.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FrameEntry {
    /// Translation along the axis.
    #[schemars(schema_with = "super::schema_forms::figure")]
    pub along: Option<FigureEntry>,
    /// Translations across it, each.
    #[schemars(schema_with = "super::schema_forms::figure")]
    pub across: Option<FigureEntry>,
    /// Rotation about the axis.
    #[schemars(schema_with = "super::schema_forms::figure")]
    pub about_along: Option<FigureEntry>,
    /// Rotations about the directions across it, each.
    #[schemars(schema_with = "super::schema_forms::figure")]
    pub about_across: Option<FigureEntry>,
}

/// The bound of an error, of an axis, or of a squareness.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default, remote = "Self")]
pub struct BoundEntry {
    /// Of an error or squareness: anywhere from minus to plus.
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub value: Option<Scalar>,
    /// Of an axis: translation along it.
    #[schemars(schema_with = "super::schema_forms::figure")]
    pub along: Option<FigureEntry>,
    /// Of an axis: translations across it, each.
    #[schemars(schema_with = "super::schema_forms::figure")]
    pub across: Option<FigureEntry>,
    /// Of an axis: rotation about it.
    #[schemars(schema_with = "super::schema_forms::figure")]
    pub about_along: Option<FigureEntry>,
    /// Of an axis: rotations about the directions across it, each.
    #[schemars(schema_with = "super::schema_forms::figure")]
    pub about_across: Option<FigureEntry>,
    /// Of an axis: its location errors.
    pub location: Option<FrameEntry>,
    /// Whole width of the band that holds the error.
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub width: Option<Scalar>,
    /// ISO 230-2: bidirectional accuracy of positioning.
    #[serde(rename = "A")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub a: Option<Scalar>,
    /// ISO 230-2: bidirectional systematic positioning error.
    #[serde(rename = "E")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub e: Option<Scalar>,
    /// ISO 230-2: range of the mean bidirectional positioning error.
    #[serde(rename = "M")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub m: Option<Scalar>,
    /// ISO 230-2: reversal error; beside M.
    #[serde(rename = "B")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub b: Option<Scalar>,
    /// ISO 230-2: bidirectional repeatability; beside E or M.
    #[serde(rename = "R")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub r: Option<Scalar>,
    /// VDI/DGQ 3441: positioning uncertainty.
    #[serde(rename = "P")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub p: Option<Scalar>,
    /// VDI/DGQ 3441: tolerance of position, the limit of P.
    #[serde(rename = "Tp")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub tp: Option<Scalar>,
    /// VDI/DGQ 3441: positional deviation.
    #[serde(rename = "Pa")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub pa: Option<Scalar>,
    /// VDI/DGQ 3441: reversal error; beside Pa.
    #[serde(rename = "U")]
    #[schemars(schema_with = "super::schema_forms::bound")]
    pub u: Option<Scalar>,
    /// VDI/DGQ 3441: scatter of positions; beside Pa.
    #[serde(rename = "Ps")]
    #[schemars(schema_with = "super::schema_forms::bound")]
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

    /// The bound of an error or squareness: its value, and the words of data sheets that are given.
    pub fn figure(&self) -> FigureEntry {
        let figures =
            [&self.width, &self.a, &self.e, &self.m, &self.b, &self.r, &self.p, &self.tp, &self.pa, &self.u, &self.ps];
        let words = FIGURE_WORDS.into_iter().zip(figures);
        FigureEntry {
            value: self.value.clone(),
            words: words.filter_map(|(word, figure)| Some((word, figure.clone()?))).collect(),
        }
    }

    /// True if it bounds an error or a squareness, and nothing of an axis.
    pub fn is_figure(&self) -> bool {
        self.location.is_none() && self.frame() == FrameEntry::default()
    }
}

impl FigureEntry {
    /// True if there is either a value or words.
    pub fn is_one(&self) -> bool {
        self.value.is_some() == self.words.is_empty()
    }
}

impl std::fmt::Display for FigureEntry {
    /// As a file has it: `9 arcsec`, `{ E: 6 um, R: 3 um }`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.value {
            Some(value) => write!(f, "{value}"),
            None => {
                let words: Vec<String> = self.words.iter().map(|(word, figure)| format!("{word}: {figure}")).collect();
                write!(f, "{{ {} }}", words.join(", "))
            }
        }
    }
}

impl FrameEntry {
    /// The four bounds: along, across, about along, about across.
    pub fn four(&self) -> [Option<&FigureEntry>; 4] {
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

/// A key of [`FIGURE_WORDS`]; any other is refused where it stands.
struct FigureWord(&'static str);

impl<'de> Deserialize<'de> for FigureWord {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let word = FIGURE_WORDS.into_iter().find(|word| *word == key);
        word.map(Self).ok_or_else(|| serde::de::Error::unknown_field(&key, &FIGURE_WORDS))
    }
}

impl Forms for FigureEntry {
    const EXPECTING: &'static str = "a bound with its unit, or words of a data sheet such as { P: 9 arcsec }";

    fn scalar(value: Scalar) -> Option<Self> {
        Some(Self { value: Some(value), words: Vec::new() })
    }

    fn map<'de, A: MapAccess<'de>>(mut map: A) -> Result<Self, A::Error> {
        let mut words = Vec::new();
        while let Some(FigureWord(word)) = map.next_key()? {
            words.extend(map.next_value::<Option<Scalar>>()?.map(|figure| (word, figure)));
        }
        Ok(Self { value: None, words })
    }
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
deserialize_by_forms!(BoundEntry, FigureEntry, ClassEntry);
