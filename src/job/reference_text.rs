//! References as text, and as files and options state them: a text or a mapping.

use super::numbers::bounded;
use super::poses::AxisPositions;
use super::reference::{Alignment, DatumPoint, Reference, ReferenceKind};
use crate::units::number;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, Deserialize, Deserializer, MapAccess, Visitor};
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A text that is no reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnknownReference;

impl fmt::Display for UnknownReference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a reference is `machine`, `zero`, `best-fit`, `best-fit:minimum-zone`, `machine-less-unheld`, \
             `zero:X,Y,Z` with the point of the zero in mm, or `datum:X,Y,Z,I,J,K:...` with six points and their \
             normals; `abbe explain E0850` has all forms",
        )
    }
}

impl std::error::Error for UnknownReference {}

/// `machine`, `machine-less-unheld`, `zero`, `best-fit`, `best-fit:minimum-zone`; `zero` and `datum` with parts behind
/// colons, part coordinates. A direction is `I,J,K`, or an axis such as `Z` or `-X`; points are in mm.
///
/// - `zero:X,Y,Z` has the point, and behind it may stand the direction of the tool, `zero:X,Y,Z,I,J,K`. Then may follow
///   `:rotary:A=0,C=90`, positions of rotary axes in deg in place of the direction, and `:about:Z:X,Y,Z`, an axis about
///   which a second point turns the part.
/// - `datum:X,Y,Z,I,J,K:...` has points with their normals.
impl FromStr for Reference {
    type Err = UnknownReference;

    fn from_str(text: &str) -> Result<Self, UnknownReference> {
        let mut parts = text.split(':');
        let of = match (parts.next(), parts.clone().next()) {
            (Some("machine"), None) => Some(Self::default()),
            (Some("machine-less-unheld"), None) => Some(Self::machine_less_unheld()),
            (Some("best-fit"), None) => Some(Self::best_fit()),
            (Some("best-fit"), Some("minimum-zone")) if parts.clone().count() == 1 => Some(Self::minimum_zone()),
            (Some("zero" | "zero-less-unheld"), _) => zero(&parts.collect::<Vec<_>>()),
            (Some("datum"), Some(_)) => datum(parts),
            _ => None,
        };
        of.ok_or(UnknownReference)
    }
}

fn zero(mut parts: &[&str]) -> Option<Reference> {
    let mut of = Reference::zero();
    let mut direction_stated = None;
    if let Some((place, others)) = parts.split_first().filter(|(first, _)| !["about", "rotary"].contains(*first)) {
        (of.point, direction_stated) = point_and_direction(place)?;
        of.direction = direction_stated.unwrap_or(of.direction);
        parts = others;
    }
    while let Some((word, others)) = parts.split_first() {
        parts = match (*word, others) {
            ("rotary", [positions, others @ ..]) if of.rotary.is_none() && direction_stated.is_none() => {
                of.rotary = Some(positions.split(',').map(position).collect::<Option<AxisPositions>>()?);
                others
            }
            ("about", [axis, second, others @ ..]) if of.align.is_none() => {
                of.align = Some(Alignment { about: direction(axis)?, point: numbers(second)? });
                others
            }
            _ => return None,
        };
    }
    Some(of)
}

fn datum<'a>(parts: impl Iterator<Item = &'a str>) -> Option<Reference> {
    let point = |part: &str| {
        let (point, normal) = point_and_direction(part)?;
        Some(DatumPoint { point, normal: normal? })
    };
    let datum = parts.map(point).collect::<Option<_>>()?;
    Some(Reference { kind: ReferenceKind::Datum, datum, ..Reference::default() })
}

/// Reads `X,Y,Z`, which a direction may follow.
fn point_and_direction(text: &str) -> Option<([f64; 3], Option<[f64; 3]>)> {
    let Some((end, _)) = text.match_indices(',').nth(2) else { return Some((numbers(text)?, None)) };
    let (point, behind) = text.split_at(end);
    Some((numbers(point)?, Some(direction(behind.strip_prefix(',')?)?)))
}

/// Reads `I,J,K`, or an axis such as `Z` or `-X`.
fn direction(text: &str) -> Option<[f64; 3]> {
    let text = text.trim();
    let (sign, letter) = match text.strip_prefix('-') {
        Some(letter) => (-1.0, letter),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    match ["X", "Y", "Z"].iter().position(|axis| *axis == letter) {
        Some(axis) => Some(std::array::from_fn(|k| if k == axis { sign } else { 0.0 })),
        None => numbers(text),
    }
}

/// Reads three numbers.
fn numbers(text: &str) -> Option<[f64; 3]> {
    let list: Vec<f64> = text.split(',').map(|x| bounded(number(x).ok()?)).collect::<Option<_>>()?;
    list.try_into().ok()
}

/// Reads `C=90`.
fn position(text: &str) -> Option<(String, f64)> {
    let (axis, value) = text.split_once('=')?;
    Some((axis.trim().to_owned(), bounded(number(value).ok()?)?))
}

/// A reference as a job states it: keys that have no effect are there still, for whoever knows their places.
pub(crate) struct WrittenReference(pub Reference);

impl<'de> Deserialize<'de> for WrittenReference {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entry;
        impl<'de> Visitor<'de> for Entry {
            type Value = Reference;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("`machine`, `zero`, `best-fit`, `zero:X,Y,Z`, or a mapping with `kind`")
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Reference, E> {
                text.parse().map_err(E::custom)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Reference, A::Error> {
                Reference::deserialize(MapAccessDeserializer::new(map))
            }
        }
        deserializer.deserialize_any(Entry).map(Self)
    }
}

impl<'de> Deserialize<'de> for Reference {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let WrittenReference(reference) = WrittenReference::deserialize(deserializer)?;
        // A mapping may state defaults: results do.
        match reference.idle_key(&reference.stated_keys()) {
            Some(idle) => Err(de::Error::custom(format!("{idle}: {}", idle.help()))),
            None => Ok(reference),
        }
    }
}

impl Serialize for Reference {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

/// A reference in the schema of options: as text on the command line, or its points.
#[derive(schemars::JsonSchema)]
#[serde(untagged)]
pub(crate) enum ReferenceOption {
    /// `machine`, `zero:X,Y,Z`, `best-fit` and the like.
    #[expect(dead_code, reason = "the schema alone")]
    Text(String),
    /// The points.
    #[expect(dead_code, reason = "the schema alone")]
    Points(Box<Reference>),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_mappings_mean_the_same() {
        let of = |text: &str| serde_json::from_str::<Reference>(text).ok();
        for (text, mapping) in [
            ("machine", r#"{"kind": "machine"}"#),
            ("zero", r#"{"kind": "zero"}"#),
            ("zero:1, 2,-3", r#"{"kind": "zero", "point": [1, 2, -3]}"#),
            ("zero:1,2,3,0,-1,0.5", r#"{"kind": "zero", "point": [1, 2, 3], "direction": [0, -1, 0.5]}"#),
            ("zero:1,2,3,-Y", r#"{"kind": "zero", "point": [1, 2, 3], "direction": [0, -1, 0]}"#),
            (
                "zero:1,2,3:about:Z:100,0,20",
                r#"{"kind": "zero", "point": [1, 2, 3], "align": {"about": [0, 0, 1], "point": [100, 0, 20]}}"#,
            ),
            (
                "zero:rotary:A=-30,C=90:about:0,1,1:1,2,3",
                r#"{"kind": "zero", "rotary": {"A": -30, "C": 90}, "align": {"about": [0, 1, 1], "point": [1, 2, 3]}}"#,
            ),
            ("best-fit", r#"{"kind": "best-fit"}"#),
            ("best-fit:minimum-zone", r#"{"kind": "best-fit", "minimum_zone": true}"#),
            (
                "datum:0,0,5,Z:1,2,3,0,1,-1",
                r#"{"kind": "datum", "datum": [{"point": [0, 0, 5], "normal": [0, 0, 1]},
                    {"point": [1, 2, 3], "normal": [0, 1, -1]}]}"#,
            ),
        ] {
            let text = text.parse().expect(text);
            assert_eq!(Some(&text), of(mapping).as_ref(), "{mapping}");
            assert_eq!(of(&serde_json::to_string(&text).unwrap()), Some(text), "{mapping}");
        }
        assert_eq!(of(r#""zero:1,2,3""#), "zero:1,2,3".parse().ok());
        for mapping in [
            r#"{"kind": "zero", "minimum_zone": true}"#,
            r#"{"kind": "best-fit", "point": [0, 0, 1]}"#,
            r#"{"point": [0, 0, 1]}"#,
            r#"{"kind": "datum", "align": {"about": [0, 0, 1], "point": [1, 0, 0]}}"#,
            r#"{"kind": "zero", "rotary": {"A": 0}, "direction": [1, 0, 0]}"#,
            r#"{"kind": "zero", "point": [1e7, 0, 0]}"#,
            r#"{"kind": "zero", "point": [0, 0]}"#,
            r#"{"kind": "zero", "rotary": {"A": 1e7}}"#,
        ] {
            assert_eq!(of(mapping), None, "{mapping}");
        }
        for text in [
            "",
            "part",
            "machine:1",
            "zero:1,2",
            "zero:1,2,3,0,1",
            "zero:1,2,3:about:Z",
            "zero:about:W:1,2,3",
            "zero:rotary:A",
            "zero:rotary:A=1:rotary:A=1",
            "zero:1,2,3,Z:rotary:A=1",
            "zero:1e7,2,3",
            "zero:rotary:A=-1e300",
            "best-fit:zone",
            "best-fit:minimum-zone:1",
            "datum",
            "datum:",
            "datum:1,2,3",
            "zero:",
            "zero:1,2,3,",
        ] {
            assert_eq!(text.parse::<Reference>(), Err(UnknownReference), "{text}");
        }
    }
}
