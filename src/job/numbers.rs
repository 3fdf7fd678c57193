//! The numbers of a job: finite, without units, and up to the bound that tables have; limits and tolerances are lengths
//! with their units.

use super::poses::AxisPositions;
use crate::diagnostic::{Reason, shown};
use crate::units::{FARTHEST, quantity};
use serde::de::{self, Deserialize, Deserializer, SeqAccess, Unexpected, Visitor};
use std::fmt;

/// Returns a number that a job may have: a place in mm, an angle in deg, a part of a direction.
pub(crate) fn bounded(number: f64) -> Option<f64> {
    (number.abs() <= FARTHEST).then_some(number)
}

/// Largest limit of a part, mm: none is as wide, and `30 mm` is `30 um` with a wrong unit.
const MAX_MM: f64 = 10.0;

/// Reads the limit or the tolerance of a part, such as `30 um`, in mm.
pub(crate) fn part_length(text: &str) -> Result<f64, Reason> {
    let mm = quantity(text).ok().and_then(|quantity| quantity.as_length());
    let mm = mm.filter(|mm| *mm > 0.0 && mm.is_finite());
    let mm = mm
        .ok_or_else(|| Reason::new(format!("`{}` is no tolerance: no length above 0, such as `30 um`", shown(text))))?;
    if mm > MAX_MM {
        return Err(Reason::new(format!("`{}` is above {MAX_MM} mm, the largest tolerance of a part", shown(text))));
    }
    Ok(mm)
}

/// A number of a job.
struct JobNumber(f64);

impl<'de> Deserialize<'de> for JobNumber {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Number;
        impl Visitor<'_> for Number {
            type Value = JobNumber;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a number without a unit, {} to {FARTHEST}", -FARTHEST)
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<JobNumber, E> {
                let found = format!("the number {number:e}");
                bounded(number).map(JobNumber).ok_or_else(|| E::invalid_value(Unexpected::Other(&found), &self))
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<JobNumber, E> {
                self.visit_f64(number as f64)
            }

            fn visit_u64<E: de::Error>(self, number: u64) -> Result<JobNumber, E> {
                self.visit_f64(number as f64)
            }
        }
        deserializer.deserialize_any(Number)
    }
}

/// Reads three numbers.
pub(crate) fn three<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 3], D::Error> {
    struct Three;
    impl<'de> Visitor<'de> for Three {
        type Value = [f64; 3];

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("three numbers, such as [0, 0, 90]")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut members: A) -> Result<[f64; 3], A::Error> {
            let mut list = Vec::new();
            while let Some(JobNumber(number)) = members.next_element()? {
                list.push(number);
            }
            list.try_into().map_err(|list: Vec<f64>| de::Error::invalid_length(list.len(), &self))
        }
    }
    deserializer.deserialize_any(Three)
}

/// Reads three numbers that may be absent.
pub(crate) fn three_if_any<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 3]>, D::Error> {
    struct Stated([f64; 3]);
    impl<'de> Deserialize<'de> for Stated {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            three(deserializer).map(Self)
        }
    }
    Ok(Option::<Stated>::deserialize(deserializer)?.map(|Stated(list)| list))
}

/// Reads positions of axes, deg, that may be absent.
pub(crate) fn positions<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<AxisPositions>, D::Error> {
    let stated = Option::<indexmap::IndexMap<String, JobNumber>>::deserialize(deserializer)?;
    Ok(stated.map(|map| map.into_iter().map(|(axis, JobNumber(deg))| (axis, deg)).collect()))
}
