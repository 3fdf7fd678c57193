//! Tolerances of features as a job file states them.

use crate::analysis::zone::{CharacteristicKind, ZoneFit};
use crate::diagnostic::{Diagnostic, Place, codes, shown};
use crate::job::numbers::{part_length, three_if_any};
use crate::job::placement::Placement;
use crate::job::tool_poses::columns::unit_vector;
use crate::syntax::{JobText, Scalar};
use indexmap::IndexMap;
use nalgebra::Vector3;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// A tolerance in a job file.
#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct ToleranceEntry {
    /// The characteristic.
    kind: CharacteristicKind,
    /// Largest value, a length such as `10 um`.
    tolerance: Option<Scalar>,
    /// Name of the feature that is its datum.
    datum: Option<String>,
    /// Axis of a surface of revolution, part coordinates.
    #[serde(default, deserialize_with = "three_if_any")]
    axis: Option<[f64; 3]>,
    /// Fits a profile onto its nominal form first.
    free: Option<bool>,
    /// The fit by which it is judged.
    fit: Option<ZoneFit>,
}

impl ToleranceEntry {
    /// Returns the keys that it states, but for the kind and the tolerance.
    fn keys(&self) -> impl Iterator<Item = &'static str> {
        let Self { datum, axis, free, fit, .. } = self;
        let stated =
            [("datum", datum.is_some()), ("axis", axis.is_some()), ("free", free.is_some()), ("fit", fit.is_some())];
        stated.into_iter().filter(|(_, is)| *is).map(|(key, _)| key)
    }

    /// True if a key has an effect on its kind.
    fn acts(&self, key: &str) -> bool {
        use CharacteristicKind as Kind;
        match (key, self.kind) {
            ("fit", Kind::Profile) => self.free == Some(true),
            ("fit", kind) => kind != Kind::Position,
            ("free", kind) => kind == Kind::Profile,
            ("axis", kind) => !matches!(kind, Kind::Straightness | Kind::Flatness | Kind::Profile),
            (_, kind) => kind.is_angle() || kind == Kind::Position,
        }
    }
}

/// The tolerances of one feature: one mapping, or a list.
#[derive(Debug, Clone)]
enum Entries {
    One(Box<ToleranceEntry>),
    List(Vec<ToleranceEntry>),
}

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Entries;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a tolerance with `kind`, or a list of them")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Entries, A::Error> {
                ToleranceEntry::deserialize(MapAccessDeserializer::new(map)).map(|one| Entries::One(Box::new(one)))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Entries, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Entries::List)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// The tolerances of the features of a job, as its file states them.
#[derive(Debug, Clone, Default, serde::Deserialize)]
#[serde(transparent)]
pub(crate) struct FeatureEntries(IndexMap<String, Entries>);

/// A tolerance of a feature.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FeatureTolerance {
    /// Name of the feature.
    pub feature: String,
    /// The characteristic.
    pub kind: CharacteristicKind,
    /// Its largest value, mm.
    pub tolerance_mm: Option<f64>,
    /// Name of the datum feature.
    pub datum: Option<String>,
    /// Axis of a surface of revolution, a unit vector, workpiece frame.
    pub axis: Option<Vector3<f64>>,
    /// True if a profile is fitted onto its nominal form first.
    pub free: bool,
    /// The fit by which it is judged.
    pub fit: ZoneFit,
    /// The place at which the job states it.
    pub written: Option<Place>,
}

/// The tolerances of a job on the part where it lies.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct FeatureTolerances(pub(super) Vec<FeatureTolerance>);

impl FeatureTolerances {
    /// Returns the axis that is stated for a feature, workpiece frame.
    pub(crate) fn axis(&self, feature: &str) -> Option<Vector3<f64>> {
        self.0.iter().filter(|of| of.feature == feature).find_map(|of| of.axis)
    }
}

impl FeatureEntries {
    /// Returns the tolerances of a part at a place, or all that is wrong with them; `text` is the job.
    pub(crate) fn placed(self, place: Placement, text: &JobText) -> Result<FeatureTolerances, Vec<Diagnostic>> {
        let (mut tolerances, mut refusals) = (Vec::new(), Vec::new());
        for (feature, entries) in self.0 {
            let list: Vec<(Vec<String>, ToleranceEntry)> = match entries {
                Entries::One(one) => vec![(Vec::new(), *one)],
                Entries::List(list) => list.into_iter().enumerate().map(|(k, e)| (vec![k.to_string()], e)).collect(),
            };
            for (index, entry) in list {
                let at: Vec<&str> =
                    ["features", &feature].into_iter().chain(index.iter().map(String::as_str)).collect();
                let stated = Stated { feature: &feature, text, at };
                match stated.tolerance(entry, place) {
                    Ok(tolerance) => tolerances.push(tolerance),
                    Err(refusal) => refusals.push(refusal),
                }
            }
        }
        if refusals.is_empty() { Ok(FeatureTolerances(tolerances)) } else { Err(refusals) }
    }
}

/// A tolerance where a job states it.
struct Stated<'a> {
    feature: &'a str,
    text: &'a JobText,
    at: Vec<&'a str>,
}

impl Stated<'_> {
    fn tolerance(&self, entry: ToleranceEntry, place: Placement) -> Result<FeatureTolerance, Diagnostic> {
        if let Some(idle) = entry.keys().find(|key| !entry.acts(key)) {
            let kind = entry.kind.name();
            let why = match (idle, entry.kind) {
                ("fit", CharacteristicKind::Profile) => {
                    "`fit` has no effect on a profile without `free: true`".to_owned()
                }
                _ => format!("`{idle}` has no effect on {kind}"),
            };
            return Err(self.refused(self.text.key(&self.below(idle)), &why, "omit it, or state another kind"));
        }
        let ToleranceEntry { kind, tolerance, datum, axis, free, fit } = entry;
        let tolerance_mm = tolerance.map(|text| part_length(&text.to_string())).transpose().map_err(|why| {
            let place = self.text.value(&self.below("tolerance"));
            self.refused(place, &why.to_string(), "write a length with its unit, `10 um`")
        })?;
        let unit = axis.map(|axis| unit_vector(&Vector3::from(axis), "its axis")).transpose().map_err(|_| {
            self.refused(self.text.value(&self.below("axis")), "its axis has no direction", "write `axis: [0, 0, 1]`")
        })?;
        let (feature, axis) = (self.feature.to_owned(), unit.map(|axis| place.direction(axis)));
        let (free, fit, written) = (free.unwrap_or_default(), fit.unwrap_or_default(), self.text.value(&self.at));
        Ok(FeatureTolerance { feature, kind, tolerance_mm, datum, axis, free, fit, written })
    }

    fn below<'k>(&'k self, key: &'k str) -> Vec<&'k str> {
        self.at.iter().copied().chain([key]).collect()
    }

    fn refused(&self, place: Option<Place>, why: &str, help: &str) -> Diagnostic {
        Diagnostic::new(codes::E0851, format!("feature `{}`: {why}", shown(self.feature))).at(place, "").help(help)
    }
}
