//! Tolerances of features as a job file states them.

use crate::analysis::zone::{CharacteristicKind, ZoneFit};
use crate::diagnostic::{Reason, shown};
use crate::job::placement::Placement;
use crate::units;
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
    tolerance: Option<String>,
    /// Name of the feature that is its datum.
    datum: Option<String>,
    /// Axis of a surface of revolution, part coordinates.
    axis: Option<[f64; 3]>,
    /// Fits a profile onto its nominal form first.
    #[serde(default)]
    free: bool,
    /// The fit by which it is judged.
    #[serde(default)]
    fit: ZoneFit,
}

/// The tolerances of one feature: one mapping, or a list.
#[derive(Debug, Clone)]
struct Entries(Vec<ToleranceEntry>);

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Entries;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a tolerance with `kind`, or a list of them")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Entries, A::Error> {
                ToleranceEntry::deserialize(MapAccessDeserializer::new(map)).map(|one| Entries(vec![one]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Entries, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Entries)
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
    /// Returns the tolerances of a part at a place.
    pub(crate) fn placed(self, place: Placement) -> Result<FeatureTolerances, Reason> {
        let all = self.0.into_iter().flat_map(|(feature, Entries(list))| {
            list.into_iter().map(move |entry| (feature.clone(), entry)).collect::<Vec<_>>()
        });
        let one = |(feature, entry): (String, ToleranceEntry)| {
            let reason = |why: Reason| Reason::new(format!("feature `{}`: {why}", shown(&feature)));
            let tolerance_mm = entry.tolerance.as_deref().map(length).transpose().map_err(reason)?;
            let axis = entry.axis.map(|axis| Vector3::from(axis).try_normalize(0.0));
            if axis.is_some_and(|axis| axis.is_none_or(|axis| !axis.norm().is_finite())) {
                return Err(reason(Reason::new("its axis has no direction")));
            }
            let ToleranceEntry { kind, datum, free, fit, .. } = entry;
            if datum.is_some() && !kind.is_angle() && kind != CharacteristicKind::Position {
                return Err(reason(Reason::new(format!("{} has no datum", kind.name()))));
            }
            if free && kind != CharacteristicKind::Profile {
                return Err(reason(Reason::new(format!("`free` is of a profile, not of {}", kind.name()))));
            }
            let axis = axis.flatten().map(|axis| place.direction(axis));
            Ok(FeatureTolerance { feature, kind, tolerance_mm, datum, axis, free, fit })
        };
        all.map(one).collect::<Result<_, _>>().map(FeatureTolerances)
    }
}

/// Returns a length above 0, mm.
fn length(text: &str) -> Result<f64, Reason> {
    let quantity = units::quantity(text).map_err(Reason::new)?;
    let mm = quantity.as_length().filter(|mm| *mm > 0.0);
    mm.ok_or_else(|| Reason::new(format!("`{}` is no tolerance: a length above 0, such as `10 um`", shown(text))))
}
