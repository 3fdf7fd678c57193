//! Entries that may be written in a short and a long form, without serde's `untagged`, which loses
//! the place of a mistake.

use super::scalar::Scalar;
use serde::Deserialize;
use serde::de::{self, Deserializer, MapAccess, SeqAccess, Unexpected, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// The forms that a type accepts; each default refuses.
pub trait Forms: Sized {
    /// The form to write.
    const EXPECTING: &'static str;

    /// Reads a single value.
    fn scalar(_: Scalar) -> Option<Self> {
        None
    }

    /// Reads a list of values.
    fn list(_: Vec<Scalar>) -> Option<Self> {
        None
    }

    /// Reads a mapping.
    fn map<'de, A: MapAccess<'de>>(_: A) -> Result<Self, A::Error> {
        Err(de::Error::invalid_type(Unexpected::Map, &Self::EXPECTING))
    }
}

/// Implements `Deserialize` by [`Forms`].
macro_rules! deserialize_by_forms {
    ($($entry:ty),*) => {$(
        impl<'de> serde::Deserialize<'de> for $entry {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $crate::syntax::forms::forms(deserializer)
            }
        }
    )*};
}
pub(super) use deserialize_by_forms;

/// Implements [`Forms`] for a mapping that may be written as the value of one of its fields.
macro_rules! mapping_or_value {
    ($entry:ty, $field:ident: $value:expr, $expecting:literal) => {
        impl $crate::syntax::forms::Forms for $entry {
            const EXPECTING: &'static str = $expecting;

            fn scalar(value: $crate::syntax::Scalar) -> Option<Self> {
                Some(Self { $field: Some($value(value)), ..Self::default() })
            }

            fn map<'de, A: serde::de::MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
                Self::deserialize(serde::de::value::MapAccessDeserializer::new(map))
            }
        }
    };
}
pub(super) use mapping_or_value;

/// Deserialises whichever form is there.
pub fn forms<'de, T: Forms, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    deserializer.deserialize_any(FormsVisitor(PhantomData))
}

impl Forms for Scalar {
    const EXPECTING: &'static str = "a number with its unit";

    fn scalar(scalar: Scalar) -> Option<Self> {
        Some(scalar)
    }
}

impl<'de> Deserialize<'de> for Scalar {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        forms(deserializer)
    }
}

struct FormsVisitor<T>(PhantomData<T>);

impl<T: Forms> FormsVisitor<T> {
    fn scalar<E: de::Error>(scalar: Scalar) -> Result<T, E> {
        let found = scalar.clone();
        T::scalar(scalar).ok_or_else(|| match &found {
            Scalar::Number(number) => E::invalid_type(Unexpected::Float(*number), &T::EXPECTING),
            Scalar::Text(text) => E::invalid_type(Unexpected::Str(text), &T::EXPECTING),
        })
    }
}

impl<'de, T: Forms> Visitor<'de> for FormsVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(T::EXPECTING)
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<T, E> {
        Self::scalar(Scalar::Number(value as f64))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<T, E> {
        Self::scalar(Scalar::Number(value as f64))
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<T, E> {
        Self::scalar(Scalar::Number(value))
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<T, E> {
        Self::scalar(Scalar::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut members: A) -> Result<T, A::Error> {
        let mut list = Vec::new();
        while let Some(member) = members.next_element()? {
            list.push(member);
        }
        T::list(list).ok_or_else(|| de::Error::invalid_type(Unexpected::Seq, &T::EXPECTING))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        T::map(map)
    }
}
