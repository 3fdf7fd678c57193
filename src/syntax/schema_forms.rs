//! Schemas of the forms of values: quantities, positions, curves, words.

use super::scalar::Scalar;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Value, json};
use std::borrow::Cow;

/// A number.
pub const NUMBER: &str = r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?";
/// Units of length.
pub const LENGTH: &str = "(nm|um|µm|μm|mm|cm|m|in|inch)";
/// Units of angle.
pub const ANGLE: &str = "(nrad|urad|µrad|μrad|mrad|rad|deg|°|arcmin|arcsec)";
/// Axis names.
pub const AXIS: &str = "[A-Z][A-Z0-9]{0,7}";

/// The words of data sheets for the width of a band.
pub const FIGURE_WORDS: [&str; 11] = ["width", "A", "E", "M", "B", "R", "P", "Tp", "Pa", "U", "Ps"];

/// Message for a quantity that does not fit.
const WITH_UNIT: &str = "a value with its unit, such as 12 um, 25 urad, 5 arcsec, 3 um/m";
/// Message for a position in mm or deg that does not fit.
const POSITION: &str = "a position: a number in mm or deg, or one with its unit";
/// Message for an angle in deg that does not fit.
const IN_DEG: &str = "an angle: a number in deg, or one with its unit";
/// Message for a length in mm that does not fit.
const IN_MM: &str = "a length: a number in mm, or one with its unit (nm, um, mm, cm, m, in)";

/// The schema of a typed struct.
pub fn object<T: JsonSchema>(generator: &mut SchemaGenerator) -> Value {
    generator.subschema_for::<T>().to_value()
}

/// Any of some schemas.
pub fn any(of: Vec<Value>) -> Value {
    json!({ "anyOf": of })
}

/// A text; editors show `expected` for another.
pub fn text(pattern: &str, expected: &str) -> Value {
    json!({ "type": "string", "pattern": pattern, "patternErrorMessage": format!("Expected {expected}.") })
}

/// A number with any unit.
pub fn quantity(_: &mut SchemaGenerator) -> Schema {
    with_unit("")
}

/// A bound: a number with any unit, as it is or behind both signs.
pub fn bound(_: &mut SchemaGenerator) -> Schema {
    with_unit(r"((\+-|\+/-|±)\s*)?")
}

/// A bound along or across an axis: a value or words of a data sheet.
pub fn figure(generator: &mut SchemaGenerator) -> Schema {
    let bound = bound(generator).to_value();
    let words: serde_json::Map<String, Value> =
        FIGURE_WORDS.iter().map(|word| ((*word).to_owned(), bound.clone())).collect();
    json_schema!({
        "anyOf": [bound, { "type": "object", "properties": words, "additionalProperties": false }]
    })
}

/// A number with any unit, behind what `sign` matches.
fn with_unit(sign: &str) -> Schema {
    let unit = format!(r"({LENGTH}|{ANGLE})(\^[1-9])?");
    let pattern = format!(r"^\s*{sign}{NUMBER}\s*({unit}(\s*/\s*{unit})*|/\s*{NUMBER})\s*$");
    json_schema!({
        "description": "A value with its unit, such as 12 um.", "type": ["string", "null"], "pattern": pattern,
        "patternErrorMessage": format!("Expected {WITH_UNIT}.")
    })
}

/// Unless a field says otherwise, a value has a unit.
impl JsonSchema for Scalar {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Scalar".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        quantity(generator)
    }
}

/// A position: bare in mm or deg, or with a unit.
fn position() -> Value {
    let pattern = format!(r"^\s*{NUMBER}\s*({LENGTH}|{ANGLE})?\s*$");
    any(vec![json!({ "type": "number" }), text(&pattern, POSITION)])
}

/// A length from zero up: bare in mm, or with a unit.
pub fn length(_: &mut SchemaGenerator) -> Schema {
    let unsigned = NUMBER.replacen("[+-]?", r"\+?", 1);
    let pattern = format!(r"^\s*{unsigned}\s*{LENGTH}?\s*$");
    json_schema!({ "anyOf": [{ "type": ["number", "null"], "minimum": 0 }, text(&pattern, IN_MM)] })
}

/// Three lengths.
pub fn point(_: &mut SchemaGenerator) -> Schema {
    let pattern = format!(r"^\s*{NUMBER}\s*{LENGTH}?\s*$");
    let items = any(vec![json!({ "type": "number" }), text(&pattern, IN_MM)]);
    json_schema!({
        "description": "[x, y, z] in machine coordinates at the zero pose, mm.",
        "type": ["array", "null"], "items": items, "minItems": 3, "maxItems": 3
    })
}

/// Three lengths, or the same from a named point.
pub fn position_entry(generator: &mut SchemaGenerator) -> Schema {
    let point = point(generator).to_value();
    json_schema!({
        "description": "[x, y, z] in machine coordinates at the zero pose, mm; or from a named point.",
        "anyOf": [point, {
            "type": "object", "required": ["from"], "additionalProperties": false,
            "properties": {
                "from": {
                    "description": "gauge, tip, workpiece, bed, or the name of an axis.",
                    "type": "string", "pattern": format!("^(gauge|tip|workpiece|bed|{AXIS})$")
                },
                "at": point
            }
        }]
    })
}

/// Three plain numbers.
pub fn direction(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "description": "Direction of positive motion; any length but zero.",
        "type": ["array", "null"], "items": { "type": "number" }, "minItems": 3, "maxItems": 3,
        "not": { "items": { "const": 0 } , "type": "array" }
    })
}

/// Lower and upper end.
pub fn interval(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "description": "[min, max], mm or deg.", "type": ["array", "null"], "items": position(),
        "minItems": 2, "maxItems": 2
    })
}

/// Lower and upper end, by axis.
pub fn intervals(generator: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "object", "additionalProperties": interval(generator) })
}

/// Lower and upper end; or `continuous`.
pub fn travel(generator: &mut SchemaGenerator) -> Schema {
    let range = interval(generator).to_value();
    json_schema!({ "anyOf": [range, { "const": "continuous" }] })
}

/// The position at which an axis is homed.
pub fn home(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyOf": [{ "type": ["number", "null"] }, position()["anyOf"][1].clone()] })
}

/// A letter, a number, or both.
pub fn controller_axis(_: &mut SchemaGenerator) -> Schema {
    let number = json!({ "type": "integer", "minimum": 1, "maximum": 65535 });
    let word = json!({ "type": "string", "pattern": "^([A-Z]|(AX|#)?[0-9]+)$" });
    let one = json!({ "anyOf": [number, word] });
    json_schema!({
        "description": "What the controller calls the axis: a letter (A) or a number from 1 (6, AX6, #6), or both.",
        "anyOf": [number, word, { "type": "array", "items": one, "maxItems": 2 }, { "type": "null" }]
    })
}

/// A distance above zero.
pub fn step(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyOf": [{ "type": ["number", "null"], "exclusiveMinimum": 0 }, position()["anyOf"][1].clone()] })
}

/// [[position, value], ...]
pub fn points(generator: &mut SchemaGenerator) -> Schema {
    let value = quantity(generator).to_value();
    json_schema!({
        "description": "[[position, value], ...] with rising positions.",
        "type": ["array", "null"], "minItems": 1,
        "items": { "type": "array", "items": [position(), value], "minItems": 2, "maxItems": 2 }
    })
}

/// Coefficients with units.
pub fn polynomial(generator: &mut SchemaGenerator) -> Schema {
    let value = quantity(generator).to_value();
    json_schema!({
        "description": "Coefficients by rising power: [0 um, 3 um/m].",
        "type": ["array", "null"], "items": value, "minItems": 1, "maxItems": 21
    })
}

/// { ORDER: [cosine, sine] }
pub fn harmonics(generator: &mut SchemaGenerator) -> Schema {
    let value = quantity(generator).to_value();
    let pair = json!({ "type": "array", "items": value, "minItems": 2, "maxItems": 2 });
    json_schema!({
        "description": "[cosine, sine] by order; rotary axes only.",
        "type": ["object", "null"], "minProperties": 1,
        "patternProperties": { "^[0-9]+$": pair }, "additionalProperties": false
    })
}

/// { degree, knots, coefficients }
pub fn bspline(generator: &mut SchemaGenerator) -> Schema {
    let value = quantity(generator).to_value();
    json_schema!({
        "description": "A B-spline: rising knots from end to end, and a coefficient for each interval and each degree; \
                        on a continuous axis for each interval.",
        "type": ["object", "null"], "required": ["knots", "coefficients"], "additionalProperties": false,
        "properties": {
            "degree": { "description": "Default 3.", "type": ["integer", "null"], "minimum": 1, "maximum": 3 },
            "knots": { "type": "array", "items": position(), "minItems": 2 },
            "coefficients": { "type": "array", "items": value, "minItems": 1 }
        }
    })
}

/// Keys and single values.
pub fn notes(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "description": "Origin of the numbers; free text.",
        "type": ["object", "null"], "additionalProperties": { "type": ["string", "number"] }
    })
}

fn setup(letters: &[&str], generator: &mut SchemaGenerator) -> Schema {
    let value = quantity(generator).to_value();
    let properties: serde_json::Map<String, Value> = letters.iter().map(|l| ((*l).to_owned(), value.clone())).collect();
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// Errors of the tip.
pub fn tool_setup(generator: &mut SchemaGenerator) -> Schema {
    setup(&["X", "Y", "Z"], generator)
}

/// Errors of the workpiece.
pub fn workpiece_setup(generator: &mut SchemaGenerator) -> Schema {
    setup(&["X", "Y", "Z", "A", "B", "C"], generator)
}

/// Angles by letter: bare in deg, or with a unit.
pub fn workpiece_rotation(_: &mut SchemaGenerator) -> Schema {
    let pattern = format!(r"^\s*{NUMBER}\s*{ANGLE}?\s*$");
    let angle = any(vec![json!({ "type": "number" }), text(&pattern, IN_DEG)]);
    let properties: serde_json::Map<String, Value> =
        ["A", "B", "C"].iter().map(|letter| ((*letter).to_owned(), angle.clone())).collect();
    json_schema!({
        "description": "Rotation of the part's coordinates, deg: by A, then B, then C about the fixed X, Y, Z of the \
                        machine.",
        "type": "object", "properties": properties, "additionalProperties": false
    })
}

/// The path of a file.
pub fn path(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "string", "minLength": 1, "maxLength": 4096 })
}

/// A unit of length.
pub fn unit_of_length(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "enum": ["nm", "um", "mm", "cm", "m", "in"] })
}

/// 1 to 6.
pub fn degree(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": ["integer", "null"], "minimum": 1, "maximum": 6 })
}

/// A word, or groups of error names.
pub fn generators(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyOf": [
        { "enum": ["per-error", "per-axis", "single", null] },
        { "type": "object", "additionalProperties": { "type": "array", "items": { "type": "string" } } }
    ] })
}

/// Basis by error name.
pub fn bases(_: &mut SchemaGenerator) -> Schema {
    let pattern = "^((poly|fourier|spline|blocks)[1-9][0-9]?|spline|blocks|bspline([1-9][0-9]?)?(/[123])?)$";
    json_schema!({ "type": "object", "additionalProperties": { "type": "string", "pattern": pattern } })
}

/// Positions by error name.
pub fn knots(_: &mut SchemaGenerator) -> Schema {
    let position = json!({ "type": ["number", "string"] });
    json_schema!({ "type": "object", "additionalProperties": { "type": "array", "items": position } })
}

/// Coefficients by parameter and error name.
pub fn own_parameters(_: &mut SchemaGenerator) -> Schema {
    let powers = json!({ "type": "array", "items": { "type": "number" }, "minItems": 1, "maxItems": 10 });
    let errors = json!({ "type": "object", "additionalProperties": powers, "minProperties": 1 });
    json_schema!({ "type": "object", "additionalProperties": errors })
}

/// Error name, the error it follows, and a factor.
pub fn tie_schema(_: &mut SchemaGenerator) -> Schema {
    let factor = json!({ "type": "number" });
    let one = json!({ "type": "object", "additionalProperties": factor, "minProperties": 1, "maxProperties": 1 });
    json_schema!({ "type": "object", "additionalProperties": one })
}

/// Slopes by error name.
pub fn slopes(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "object", "additionalProperties": { "type": "string" } })
}

/// Exactly one form of a curve; `interpolation` and `beyond` only beside points.
pub fn one_form(schema: &mut Schema) {
    let directions = schema.get("properties").is_some_and(|p| p.get("forward").is_some());
    let single = ["value", "table", "points", "polynomial", "harmonics", "bspline"];
    let mut forms: Vec<Value> = single.iter().map(|form| json!({ "required": [form] })).collect();
    if directions {
        forms.extend([json!({ "required": ["forward", "reverse"] }), json!({ "required": ["tolerance"] })]);
    }
    schema.insert("oneOf".to_owned(), forms.into());
    let between = json!({ "anyOf": [{ "required": ["table"] }, { "required": ["points"] }] });
    schema.insert("dependencies".to_owned(), json!({ "interpolation": between, "beyond": between }));
}

/// Functions for fields that hold one of some words.
macro_rules! words {
    ($($name:ident: [$($word:literal),*], $description:literal;)*) => {$(
        #[doc = $description]
        pub fn $name(_: &mut SchemaGenerator) -> Schema {
            json_schema!({ "description": $description, "enum": [$($word,)* null] })
        }
    )*};
}

words! {
    kind: ["linear", "rotary"], "Kind of the axis; follows from the letter.";
    sense: ["iso841", "direct"], "Sense of a positive command of a workpiece-side axis.";
    class_name: ["ultra-precision", "premium", "production", "commodity", "large-gantry", "desktop"], "Class of \
        machines with typical tolerances.";
    preset: ["holub-2015", "bui-kimm", "hrdina-vasik-2014"], "Conventions of a paper.";
    location: ["axis_only", "carried_body"], "Action of location errors.";
    linear_order: ["after", "before"], "Side of the motion on which component errors of linear axes act.";
    rotary_order: ["stationary", "rotating"], "Side of the motion on which component errors of rotary axes act.";
    errors_are: ["tool_relative", "body"], "Body whose motion the errors of workpiece-side axes describe.";
    location_order: ["nilpotent", "real"], "Order of location errors.";
    joints: ["orthogonal", "linearised"], "Shape of error matrices.";
    interpolation: ["linear", "cubic"], "Between points.";
    beyond: ["hold", "slope", "refuse"], "Beyond the points of curves that stop short of the travel: the last value, \
        the last slope, or not at all.";
}
