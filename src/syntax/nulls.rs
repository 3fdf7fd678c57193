//! Keys without a value. `null` removes what a file inherits, so such keys are gone before sections are typed: whether
//! the language has them is asked here, of its schema. A decimal comma in a mapping on one line makes such keys, too:
//! `{ step: 100,5 mm }` has the key `5 mm`.

use super::places::{Keys, Places, below};
use super::schema_forms::AXIS;
use crate::diagnostic::{Diagnostic, Diagnostics, Sources, codes, did_you_mean, shown};
use serde_json::Value as Schema;
use serde_yaml::{Mapping, Value};

/// Deepest nesting of references within the schema.
const DEPTH: usize = 32;

/// Maximum number of letters and digits of an axis name, as in [`AXIS`].
const AXIS_LENGTH: usize = 8;

/// Refuses keys with the value `null` that the language does not have (E0201), and keys without any value (E0202);
/// `schema` is that of the mapping, references are followed in `root`.
pub(super) fn refuse_unknown(
    map: &Mapping,
    [schema, root]: [&Schema; 2],
    places: &mut Places,
    diagnostics: &mut Diagnostics,
) {
    if !has_null(map) {
        return;
    }
    let mut walk = NullWalk { root, written: (places, &diagnostics.sources), unknown: Vec::new(), bare: Vec::new() };
    walk.mapping(map, &[schema], &Keys::new());
    let NullWalk { unknown, bare, .. } = walk;
    for keys in bare {
        let name = keys.last().map_or("", String::as_str);
        let refusal = Diagnostic::new(codes::E0202, format!("`{}` stands here without a value", shown(name)));
        let help = match name.split_once(' ') {
            Some((digits, _)) if digits.bytes().all(|c| c.is_ascii_digit()) => {
                "write decimals with a point, 120.5 mm: a comma ends the value".to_owned()
            }
            Some((key, value)) if value.trim_start().starts_with('=') => {
                let value = value.trim_start_matches(['=', ' ']);
                format!("write `{}: {}`, with a colon in place of `=`", shown(key), shown(value))
            }
            Some((key, value)) => format!("write `{}: {}`, with a colon and a blank", shown(key), shown(value)),
            None if name.trim_end_matches([')', ']']).parse::<f64>().is_ok() => {
                "a list stands in brackets, [250, 225, -380]; decimals have a point, 100.5".to_owned()
            }
            None => "give it a value, `key: value`; `key: ~` removes what a file extends".to_owned(),
        };
        diagnostics.push(refusal.at(places.key(&keys), "").help(help));
        places.mar(&keys);
    }
    for (keys, known) in unknown {
        let name = keys.last().map_or("", String::as_str);
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        let refusal = Diagnostic::new(codes::E0201, format!("unknown key `{}`", shown(name)));
        diagnostics.push(refusal.at(places.key(&keys), "").help(did_you_mean(name, &known)));
        places.mar(&keys);
    }
}

/// Returns a mapping without the keys whose value is `null`.
pub(super) fn strip(map: Mapping) -> Mapping {
    map.into_iter().filter(|(_, v)| !v.is_null()).map(|(k, v)| (k, without_null(v))).collect()
}

/// Returns a value without the keys of mappings whose value is `null`.
pub(super) fn without_null(value: Value) -> Value {
    match value {
        Value::Mapping(map) => Value::Mapping(strip(map)),
        other => other,
    }
}

fn has_null(map: &Mapping) -> bool {
    map.values().any(|value| match value {
        Value::Null => true,
        Value::Mapping(inner) => has_null(inner),
        _ => false,
    })
}

struct NullWalk<'a> {
    root: &'a Schema,
    written: (&'a Places, &'a Sources),
    /// Keys without a value and without a colon.
    bare: Vec<Keys>,
    /// Keys that are unknown, each with those that are known in its place.
    unknown: Vec<(Keys, Vec<String>)>,
}

impl<'a> NullWalk<'a> {
    fn mapping(&mut self, map: &Mapping, schemas: &[&'a Schema], at: &Keys) {
        let mut objects = Vec::new();
        schemas.iter().for_each(|schema| self.objects(schema, DEPTH, &mut objects));
        for (key, value) in map {
            let Some(name) = key_text(key) else { continue };
            let here = below(at, &name);
            let of_key: Vec<&Schema> = objects.iter().filter_map(|object| member(object, &name)).collect();
            match value {
                Value::Null if self.is_bare(&here, &name) => self.bare.push(here),
                Value::Null if of_key.is_empty() && !objects.is_empty() => self.unknown.push((here, names(&objects))),
                Value::Mapping(inner) => self.mapping(inner, &of_key, &here),
                _ => {}
            }
        }
    }

    /// True if no colon follows the key: no value was meant to be removed.
    fn is_bare(&self, at: &Keys, name: &str) -> bool {
        let (places, sources) = self.written;
        let Some(place) = places.key(at) else { return false };
        let text = sources.text(place.source);
        let quotes = ['"', '\''];
        let own = text.get(place.range.clone()).is_some_and(|key| key.trim_matches(quotes) == name);
        let rest = text.get(place.range.end..).unwrap_or_default();
        own && !rest.trim_start_matches(quotes).trim_start().starts_with(':')
    }

    /// The forms of a schema that are objects, references followed.
    fn objects(&self, schema: &'a Schema, depth: usize, found: &mut Vec<&'a Schema>) {
        if depth == 0 {
            return;
        }
        if ["properties", "patternProperties", "additionalProperties"].iter().any(|key| schema.get(key).is_some()) {
            found.push(schema);
        }
        if let Some(name) = schema.get("$ref").and_then(Schema::as_str).and_then(|path| path.rsplit('/').next()) {
            self.root["definitions"].get(name).into_iter().for_each(|schema| self.objects(schema, depth - 1, found));
        }
        for branches in ["anyOf", "oneOf", "allOf"].iter().filter_map(|key| schema.get(key)?.as_array()) {
            branches.iter().for_each(|schema| self.objects(schema, depth - 1, found));
        }
    }
}

/// A key as text: harmonics are numbers.
fn key_text(key: &Value) -> Option<String> {
    key.as_str().map(str::to_owned).or_else(|| key.as_u64().map(|number| number.to_string()))
}

/// The schema of a member of an object: by its name, or by what holds of all names. Whether a name has the form of an
/// error is asked when it is used.
fn member<'a>(object: &'a Schema, name: &str) -> Option<&'a Schema> {
    let named = object.get("properties").and_then(|properties| properties.get(name));
    let patterns = || {
        let mut all = object.get("patternProperties")?.as_object()?.iter();
        all.find(|(pattern, _)| **pattern != format!("^{AXIS}$") || is_axis(name)).map(|(_, schema)| schema)
    };
    let others = || object.get("additionalProperties").filter(|others| **others != Schema::Bool(false));
    named.or_else(patterns).or_else(others)
}

/// True if a name has the form [`AXIS`].
fn is_axis(name: &str) -> bool {
    let letters = name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit());
    letters && name.len() <= AXIS_LENGTH && name.starts_with(|c: char| c.is_ascii_uppercase())
}

fn names(objects: &[&Schema]) -> Vec<String> {
    let properties = objects.iter().filter_map(|object| object.get("properties")?.as_object());
    properties.flat_map(|properties| properties.keys().cloned()).collect()
}
