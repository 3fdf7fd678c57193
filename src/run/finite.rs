//! The one place where results leave the library: a number that is not finite is refused here, whatever face shows it
//! and in whatever form (JSON would turn it into `null` without a word).

use crate::diagnostic::{Diagnostic, codes};
use serde::ser::{self, Serialize, Serializer};
use std::fmt;

/// Returns the refusal of a result with a number that is not finite.
pub(crate) fn refusal(result: &impl Serialize) -> Option<Diagnostic> {
    let fault = result.serialize(Finite).err()?;
    let path: Vec<&str> = fault.path.iter().rev().map(String::as_str).collect();
    Some(not_finite(&path.join(".")))
}

/// Returns the refusal of a number that is not finite; `place` says where it would stand.
pub(crate) fn not_finite(place: &str) -> Diagnostic {
    let place = if place.is_empty() { "the result" } else { place };
    Diagnostic::new(codes::E0542, format!("`{place}` is not a finite number")).help(
        "an input is far from what a machine has (look for a wrong unit or power of ten), or the geometry is \
             singular at a pose, such as a tilted axis at a pole: leave that pose out; nothing was written",
    )
}

/// Visits numbers and writes nothing. Stops at the first that is not finite.
struct Finite;

/// Where a number that is not finite stands, from the inside out.
#[derive(Debug, thiserror::Error)]
#[error("a number is not finite")]
struct Fault {
    path: Vec<String>,
}

impl Fault {
    fn within(mut self, key: impl Into<String>) -> Self {
        self.path.push(key.into());
        self
    }
}

impl ser::Error for Fault {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self { path: Vec::new() }
    }
}

type Seen = Result<(), Fault>;

/// Members of a list, tuple, mapping or struct.
struct Members {
    index: usize,
    key: String,
}

impl Members {
    const fn new() -> Self {
        Self { index: 0, key: String::new() }
    }

    fn next<T: Serialize + ?Sized>(&mut self, value: &T) -> Seen {
        let index = self.index;
        self.index += 1;
        value.serialize(Finite).map_err(|fault| fault.within(index.to_string()))
    }
}

/// Values without numbers that can fail.
macro_rules! harmless {
    ($($method:ident: $kind:ty,)*) => { $(fn $method(self, _: $kind) -> Seen { Ok(()) })* };
}

/// Values with members, whatever they are told beforehand.
macro_rules! members {
    ($($method:ident: $($told:ty),+;)*) => {
        $(fn $method(self, $(_: $told),+) -> Result<Members, Fault> { Ok(Members::new()) })*
    };
}

impl Serializer for Finite {
    type Ok = ();
    type Error = Fault;
    type SerializeSeq = Members;
    type SerializeTuple = Members;
    type SerializeTupleStruct = Members;
    type SerializeTupleVariant = Members;
    type SerializeMap = Members;
    type SerializeStruct = Members;
    type SerializeStructVariant = Members;

    harmless! {
        serialize_bool: bool, serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64, serialize_char: char,
        serialize_str: &str, serialize_bytes: &[u8], serialize_unit_struct: &'static str,
    }

    fn serialize_f32(self, value: f32) -> Seen {
        self.serialize_f64(f64::from(value))
    }

    fn serialize_f64(self, value: f64) -> Seen {
        if value.is_finite() { Ok(()) } else { Err(Fault { path: Vec::new() }) }
    }

    fn serialize_none(self) -> Seen {
        Ok(())
    }

    fn serialize_unit(self) -> Seen {
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Seen {
        value.serialize(self)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, _: &'static str) -> Seen {
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Seen {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        value: &T,
    ) -> Seen {
        value.serialize(self)
    }

    members! {
        serialize_seq: Option<usize>;
        serialize_tuple: usize;
        serialize_tuple_struct: &'static str, usize;
        serialize_tuple_variant: &'static str, u32, &'static str, usize;
        serialize_map: Option<usize>;
        serialize_struct: &'static str, usize;
        serialize_struct_variant: &'static str, u32, &'static str, usize;
    }
}

/// The kinds of lists differ in the names of their methods only.
macro_rules! list {
    ($($kind:ident $method:ident,)*) => { $(
        impl ser::$kind for Members {
            type Ok = ();
            type Error = Fault;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Seen {
                self.next(value)
            }

            fn end(self) -> Seen {
                Ok(())
            }
        }
    )* };
}

list! {
    SerializeSeq serialize_element,
    SerializeTuple serialize_element,
    SerializeTupleStruct serialize_field,
    SerializeTupleVariant serialize_field,
}

macro_rules! fields {
    ($($kind:ident,)*) => { $(
        impl ser::$kind for Members {
            type Ok = ();
            type Error = Fault;

            fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Seen {
                value.serialize(Finite).map_err(|fault| fault.within(key))
            }

            fn end(self) -> Seen {
                Ok(())
            }
        }
    )* };
}

fields! { SerializeStruct, SerializeStructVariant, }

impl ser::SerializeMap for Members {
    type Ok = ();
    type Error = Fault;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Seen {
        self.key = serde_json::to_value(key).ok().and_then(|key| Some(key.as_str()?.to_owned())).unwrap_or_default();
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Seen {
        value.serialize(Finite).map_err(|fault| fault.within(std::mem::take(&mut self.key)))
    }

    fn end(self) -> Seen {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value that shows text, names and numbers.
    #[derive(serde::Serialize)]
    struct Content {
        name: &'static str,
        letter: char,
        inf_um: Vec<Option<f64>>,
    }

    #[test]
    fn numbers_that_are_not_finite_are_found_with_their_place() {
        let content = |x| Content { name: "NaN \" inf: NaN", letter: '"', inf_um: vec![Some(1.5), None, Some(x)] };
        assert!(refusal(&content(-1e308)).is_none());
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(refusal(&content(x)).is_some_and(|found| found.message.contains("`inf_um.2`")));
        }
        assert!(refusal(&f64::NAN).is_some());
    }
}
