//! Geometry as written: positions, absolute or from a named point, and what holds on one side of the bed.

use super::forms::{Forms, deserialize_by_forms};
use super::places::{Keys, keys};
use super::scalar::Scalar;
use super::term::TermEntry;
use indexmap::IndexMap;
use serde::de::MapAccess;
use serde::de::value::MapAccessDeserializer;
use serde::{Deserialize, Serialize};
use serde_yaml::{Mapping, Value};
use std::collections::BTreeMap;

/// The chain as two lists from the bed outwards.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Branches {
    /// Axes that carry the workpiece.
    pub workpiece: Vec<String>,
    /// Axes that carry the tool; a name in parentheses at the end is the spindle.
    pub tool: Vec<String>,
}

/// `[min, max]` or `continuous`.
#[derive(Debug, Clone, PartialEq)]
pub enum TravelEntry {
    /// A word: `continuous`.
    Word(String),
    /// Lower and upper end.
    Range(Vec<Scalar>),
}

impl TravelEntry {
    /// True if an end is written in inches.
    pub fn is_in_inches(&self) -> bool {
        matches!(self, Self::Range(ends) if ends.iter().any(Scalar::is_in_inches))
    }
}

impl Forms for TravelEntry {
    const EXPECTING: &'static str = "[min, max] or continuous";

    fn scalar(word: Scalar) -> Option<Self> {
        Some(Self::Word(word.to_string()))
    }

    fn list(range: Vec<Scalar>) -> Option<Self> {
        Some(Self::Range(range))
    }
}

deserialize_by_forms!(TravelEntry);

/// A position: three coordinates, or the same from a named point.
#[derive(Debug, Clone, PartialEq)]
pub enum PositionEntry {
    /// Machine coordinates at the zero pose.
    Point(Vec<Scalar>),
    /// From a named point.
    Relative(RelativeEntry),
}

/// A position from a named point.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RelativeEntry {
    /// `gauge`, `tip`, `workpiece`, `bed` or the name of an axis.
    pub from: Option<String>,
    /// Coordinates from there.
    pub at: Option<Vec<Scalar>>,
}

/// Geometry of an axis on one side of the bed; it goes over the plain keys.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SideEntry {
    /// A point of the axis.
    #[schemars(schema_with = "super::schema_forms::position_entry")]
    pub origin: Option<PositionEntry>,
    /// Its travel.
    #[schemars(schema_with = "super::schema_forms::travel")]
    pub travel: Option<TravelEntry>,
    /// The direction of positive motion.
    #[schemars(schema_with = "super::schema_forms::direction")]
    pub direction: Option<Vec<Scalar>>,
    /// Errors of this axis by name, in place of those of the same name under `errors`.
    #[schemars(schema_with = "super::schema_errors::side_errors")]
    pub errors: IndexMap<String, TermEntry>,
}

const SIDES: [&str; 2] = ["on_tool", "on_workpiece"];
/// The plain keys that a block may give too.
const SIDED: [&str; 3] = ["origin", "travel", "direction"];

impl Forms for PositionEntry {
    const EXPECTING: &'static str = "[x, y, z], or a mapping such as { from: gauge, at: [0, 0, 180] }";

    fn list(point: Vec<Scalar>) -> Option<Self> {
        Some(Self::Point(point))
    }

    fn map<'de, A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
        RelativeEntry::deserialize(MapAccessDeserializer::new(map)).map(Self::Relative)
    }
}

/// A kinematic chain as a file writes it.
#[derive(Debug, Clone, PartialEq)]
pub enum WrittenChain {
    /// The walk from workpiece to tool.
    Walk(String),
    /// Two lists from the bed outwards.
    Branches(Branches),
}

/// The chains under which the geometry of axes was written: the plain keys of an axis hold for the side on which the
/// file that wrote them has the axis.
#[derive(Debug, Clone, Default)]
pub struct WrittenChains {
    /// The chain in force in each file, the base of all first.
    files: Vec<Option<WrittenChain>>,
    /// The file that wrote the plain `origin` of an axis, or else declared the axis.
    axes: BTreeMap<String, usize>,
}

impl WrittenChains {
    /// Returns the chains in force where the plain geometry of an axis was written and in the files that extend it.
    pub fn of(&self, axis: &str) -> impl Iterator<Item = &WrittenChain> {
        let first = self.axes.get(axis).copied().unwrap_or(0);
        self.files.iter().skip(first).flatten()
    }

    /// Takes note of a file: what it says itself, and that merged with what it extends.
    pub(super) fn note(&mut self, own: &[String], merged: &Mapping) {
        let file = self.files.len();
        self.files.push(chain(merged));
        for axis in merged.get("axes").and_then(Value::as_mapping).into_iter().flat_map(Mapping::keys) {
            let Some(axis) = axis.as_str() else { continue };
            if own.iter().any(|name| name == axis) {
                self.axes.insert(axis.to_owned(), file);
            } else {
                self.axes.entry(axis.to_owned()).or_insert(file);
            }
        }
    }
}

/// The axes of which a file gives the plain `origin`.
pub(super) fn with_origin(file: &Mapping) -> Vec<String> {
    axes(file).filter(|(_, axis)| axis.contains_key("origin")).map(|(name, _)| name.to_owned()).collect()
}

fn axes(file: &Mapping) -> impl Iterator<Item = (&str, &Mapping)> {
    let all = file.get("axes").and_then(Value::as_mapping).into_iter().flatten();
    all.filter_map(|(name, axis)| Some((name.as_str()?, axis.as_mapping()?)))
}

fn chain(map: &Mapping) -> Option<WrittenChain> {
    match (map.get("chain"), map.get("branches")) {
        (Some(Value::String(walk)), _) => Some(WrittenChain::Walk(walk.clone())),
        (Some(Value::Sequence(words)), _) => {
            let words: Vec<&str> = words.iter().filter_map(Value::as_str).collect();
            Some(WrittenChain::Walk(words.join(" ")))
        }
        (_, Some(lists)) => serde_yaml::from_value(lists.clone()).ok().map(WrittenChain::Branches),
        _ => None,
    }
}

/// The entries of a base that plain keys of a variant displace: the same keys in the blocks of a side.
pub(super) fn displaced_entries(base: &Mapping, over: &Mapping) -> Vec<Keys> {
    let plain = over.get("errors").and_then(Value::as_mapping);
    let mut entries = Vec::new();
    for (name, axis) in axes(base) {
        let own = over.get("axes").and_then(|axes| axes.get(name)).and_then(Value::as_mapping);
        for side in SIDES {
            let Some(block) = axis.get(side).and_then(Value::as_mapping) else { continue };
            let displaced = |key: &&str| block.contains_key(*key) && own.is_some_and(|own| own.contains_key(*key));
            entries.extend(SIDED.iter().copied().filter(displaced).map(|key| keys(["axes", name, side, key])));
            let errors = block.get("errors").and_then(Value::as_mapping).into_iter().flat_map(Mapping::keys);
            let errors = errors.filter(|error| plain.is_some_and(|plain| plain.contains_key(*error)));
            entries.extend(errors.filter_map(Value::as_str).map(|e| keys(["axes", name, side, "errors", e])));
        }
    }
    entries
}

/// Gauge points of a base that a variant writes anew.
pub(super) fn displaced_gauges(base: &Mapping, over: &Mapping) -> Vec<(Keys, [Scalar; 3])> {
    let tools = |map: &Mapping| -> Vec<Keys> {
        let named = map.get("tools").and_then(Value::as_mapping).into_iter().flat_map(Mapping::keys);
        let named = named.filter_map(Value::as_str).map(|name| keys(["tools", name, "gauge"]));
        named.chain([keys(["tool", "gauge"])]).collect()
    };
    let gauge = |map: &Mapping, at: &Keys| -> Option<[Scalar; 3]> {
        let (first, rest) = at.split_first()?;
        let value = rest.iter().try_fold(map.get(first.as_str())?, |value, key| value.get(key.as_str()))?;
        serde_yaml::from_value::<Vec<Scalar>>(value.clone()).ok()?.try_into().ok()
    };
    let displaced = |at: Keys| {
        let (own, new) = (gauge(base, &at)?, gauge(over, &at)?);
        (own != new).then_some((at, own))
    };
    tools(over).into_iter().filter_map(displaced).collect()
}

/// True for an entry that a variant replaces whole: a position, a rotation, or an error in the block of a side.
pub(super) fn replaces_whole(at: &[String]) -> bool {
    match at.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["workpiece", "origin" | "rotation"] | ["axes", _, "origin"] => true,
        ["axes", _, side, "origin"] | ["axes", _, side, "errors", _] => SIDES.contains(&side),
        _ => false,
    }
}

deserialize_by_forms!(PositionEntry);
