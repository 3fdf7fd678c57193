//! The part of the schema that names errors: the usual letters one by one, with what each error is, and patterns for
//! the rest.

use super::error_words::{component_words, location_words};
use super::schema_forms::{ANGLE, AXIS, LENGTH, NUMBER, any, notes, object, quantity, text};
use super::term::TermEntry;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

/// Axes whose errors an editor completes: name, whether it is rotary, and the direction of the machine it lies in.
const AXES: [(&str, bool, Option<usize>); 10] = [
    ("X", false, Some(0)),
    ("Y", false, Some(1)),
    ("Z", false, Some(2)),
    ("A", true, Some(0)),
    ("B", true, Some(1)),
    ("C", true, Some(2)),
    ("U", false, Some(0)),
    ("V", false, Some(1)),
    ("W", false, Some(2)),
    // A spindle has location errors only.
    ("S", true, None),
];

/// Errors by name.
pub fn errors() -> Value {
    json!({ "$ref": "#/definitions/Errors" })
}

/// The same as the schema of a field.
pub fn errors_entry(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "$ref": "#/definitions/Errors" })
}

/// The definitions that [`errors`] refers to.
pub fn definitions(generator: &mut SchemaGenerator) -> Map<String, Value> {
    let length = text(&format!(r"^\s*{NUMBER}\s*{LENGTH}\s*$"), "a length with its unit: nm, um, mm, cm, m, in");
    let angle = text(
        &format!(r"^\s*{NUMBER}\s*({ANGLE}|{LENGTH}\s*/\s*{LENGTH}|/\s*{NUMBER})\s*$"),
        "an angle with its unit: nrad, urad, mrad, rad, arcsec, arcmin, deg, or um/m, mm/m",
    );
    let term = object::<TermEntry>(generator);
    let constant = json!({
        "type": "object",
        "properties": {
            "value": quantity(generator), "tolerance": quantity(generator), "uncertainty": quantity(generator),
            "provenance": notes(generator)
        },
        "oneOf": [{ "required": ["value"] }, { "required": ["tolerance"] }],
        "additionalProperties": false
    });
    let either = |short: &Value, long: &Value| any(vec![short.clone(), long.clone(), json!({ "type": "null" })]);
    let all = [
        ("LengthCurve", either(&length, &term)),
        ("AngleCurve", either(&angle, &term)),
        ("LengthConstant", either(&length, &constant)),
        ("AngleConstant", either(&angle, &constant)),
        ("Errors", by_name()),
    ];
    all.into_iter().map(|(name, schema)| (name.to_owned(), schema)).collect()
}

fn by_name() -> Value {
    json!({
        "description": "Errors by name: EXX, EC0Y. Values carry their unit.",
        "type": "object",
        "properties": usual_errors(),
        "patternProperties": patterns(),
        "additionalProperties": false
    })
}

fn reference(direction: usize, family: &str) -> Value {
    let unit = if direction < 3 { "Length" } else { "Angle" };
    json!({ "$ref": format!("#/definitions/{unit}{family}") })
}

fn usual_errors() -> Map<String, Value> {
    let mut all = Map::new();
    for (axis, rotary, along) in AXES {
        for (direction, letter) in "XYZABC".chars().enumerate() {
            let mut put = |name: String, words: String, family: &str| {
                let schema = json!({ "description": words, "allOf": [reference(direction, family)] });
                all.insert(name, schema);
            };
            if along.is_some() {
                put(format!("E{letter}{axis}"), component_words(axis, rotary, along, direction), "Curve");
            }
            put(format!("E{letter}0{axis}"), location_words(axis, rotary, along, direction), "Constant");
        }
    }
    all
}

fn patterns() -> Map<String, Value> {
    let mut patterns = Map::new();
    let mut put = |pattern: String, direction: usize, family: &str| {
        patterns.insert(pattern, reference(direction, family));
    };
    for (letters, direction, lower) in [("XYZ", 0, "d"), ("ABC", 3, "e")] {
        put(format!(r"^E_?\{{?[{letters}]{AXIS}\}}?$"), direction, "Curve");
        put(format!(r"^(E_?\{{?)?[{letters}](0|\(0X\)){AXIS}\}}?$"), direction, "Constant");
        put(format!(r"^[{letters}]O{AXIS}$"), direction, "Constant");
        put(format!("^{lower}[xyz][xyz]$"), direction, "Curve");
    }
    put("^S(xy|xz|yz)$".to_owned(), 3, "Constant");
    patterns
}

/// Errors of an axis that hold on one side of the bed.
pub fn side_errors(_: &mut SchemaGenerator) -> Schema {
    Schema::try_from(errors()).unwrap_or_default()
}
