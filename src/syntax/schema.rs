//! The JSON Schema (draft-07) of the machine language, for editors.
//!
//! Keys come from the typed structs, forms of values from here. `null` is allowed where a variant
//! may remove what its base says.

use super::document::{
    AlgebraEntry, AxisEntry, ConventionsEntry, CovarianceEntry, IdentifyEntry, MeshFields, SetUpEntry, ToolEntry,
    VolumeFields, WorkpieceEntry,
};
use super::geometry::Branches;
use super::schema_errors::{self, errors};
use super::schema_forms::{AXIS, any, bound, class_name, interval, notes, object, preset, step, text};
use super::tolerance::{BoundEntry, ClassEntry};
use schemars::SchemaGenerator;
use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

/// Axes whose kind and direction follow from the letter.
const LETTERS: [(&str, &str); 9] = [
    ("X", "Linear axis along X."),
    ("Y", "Linear axis along Y."),
    ("Z", "Linear axis along Z."),
    ("A", "Rotary axis about X."),
    ("B", "Rotary axis about Y."),
    ("C", "Rotary axis about Z."),
    ("U", "Second linear axis along X."),
    ("V", "Second linear axis along Y."),
    ("W", "Second linear axis along Z."),
];

/// The schema of a machine file.
pub fn schema() -> Value {
    let mut generator = SchemaSettings::draft07().into_generator();
    let sections = sections(&mut generator);
    let errors = schema_errors::definitions(&mut generator);
    let mut definitions = generator.take_definitions(true);
    definitions.extend(errors);
    let mut schema = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "abbe machine file",
        "description": "A machine tool: its kinematics and its geometric errors.",
        "type": "object",
        "additionalProperties": false,
        "properties": sections,
        "if": { "not": { "required": ["extends"] } },
        "then": {
            "required": ["machine", "axes"],
            "if": { "not": { "required": ["branches"] } },
            "then": { "required": ["chain"] }
        },
        "allOf": [
            { "not": { "required": ["chain", "branches"] } },
            { "not": { "required": ["tool", "tools"] } }
        ],
        "definitions": definitions
    });
    without_defaults(&mut schema);
    schema
}

/// Takes the defaults of the typed structs out: an editor would write them.
fn without_defaults(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            // A property may have the name.
            if map.get("default").is_some_and(|value| value.get("type").is_none()) {
                map.remove("default");
            }
            map.values_mut().for_each(without_defaults);
        }
        Value::Array(list) => list.iter_mut().for_each(without_defaults),
        _ => {}
    }
}

/// The top-level keys.
fn sections(generator: &mut SchemaGenerator) -> Value {
    json!({
        "abbe": { "description": "Version of the language.", "const": 1 },
        "machine": name("The machine's name, one line.", 120),
        "extends": {
            "description": "Path of the file that this one is a variant of.", "type": "string", "minLength": 1
        },
        "chain": or_null("The walk from workpiece to tool: w C' A' Y' b X Z t.", chain()),
        "branches": or_null("The chain as its two branches.", object::<Branches>(generator)),
        "axes": or_null("Axes by name.", axes(generator)),
        "tool": or_null("The tool.", object::<ToolEntry>(generator)),
        "tools": or_null("Tools by name; the first is the default.", json!({
            "type": "object",
            "patternProperties": {
                r"^[A-Za-z0-9](\.?[A-Za-z0-9_-])*$": or_null("A tool.", object::<ToolEntry>(generator))
            },
            "additionalProperties": false
        })),
        "workpiece": or_null("The workpiece.", object::<WorkpieceEntry>(generator)),
        "conventions": any(vec![preset(generator).to_value(), object::<ConventionsEntry>(generator)]),
        "errors": or_null("Errors by name: EXX, EC0Y. Values carry their unit.", errors()),
        "tolerances": or_null(
            "Bounds: of errors (EXX), along and across axes (B), of squareness (X-Y).",
            tolerances(generator),
        ),
        "class": any(vec![class_name(generator).to_value(), object::<ClassEntry>(generator)]),
        "covariance": or_null("Joint uncertainty of the errors: independent parts, one standard one each.", json!({
            "type": "array", "items": object::<CovarianceEntry>(generator)
        })),
        "measured": or_null("CSV files of which every error column counts.", json!({
            "type": "array",
            "items": { "type": "string", "minLength": 1 }
        })),
        "volume": or_null("Intervals and steps of maps and tables; default: the travels.", volume(generator)),
        "provenance": notes(generator),
        "setup": or_null("Set-up errors.", object::<SetUpEntry>(generator)),
        "algebra": or_null("The algebra in which errors are followed.", object::<AlgebraEntry>(generator)),
        "identify": or_null("What `identify` fits.", object::<IdentifyEntry>(generator)),
        "job": or_null("The job that the machine is judged on.", job()),
        "up": or_null("Upwards in the picture, in machine coordinates; by default it follows from the chain.", json!({
            "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3
        })),
        "look": or_null("Meshes by body: bed, workpiece, tool, or an axis. For the picture alone.", look(generator))
    })
}

/// A schema, or `null` in a variant; what the key is stands beside it, for editors.
fn or_null(description: &str, schema: Value) -> Value {
    json!({ "description": description, "anyOf": [schema, { "type": "null" }] })
}

/// A single line of text.
fn name(description: &str, longest: usize) -> Value {
    json!({
        "description": description, "type": "string", "minLength": 1, "maxLength": longest,
        "pattern": r"^[^\u0000-\u001f\u007f]+$"
    })
}

/// A job: docs/formats/jobs.md.
fn job() -> Value {
    let point = || json!({ "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 });
    json!({
        "type": "object",
        "required": ["tool_poses"],
        "properties": {
            "tool_poses": name("File of the tool poses, from the folder of this file.", 4096),
            "place": {
                "description": "Where the part lies on the workpiece frame: mm, and deg about X, then Y, then Z.",
                "type": "object", "additionalProperties": false,
                "properties": { "origin": point(), "rotation": point() }
            },
            "reference": {
                "description": "What the set-up takes out: machine, zero, zero:X,Y,Z, best-fit, datum:..., a mapping.",
                "type": ["string", "object"]
            },
            "path": { "description": "True if the tool poses are one continuous path.", "type": "boolean" },
            "tool": name("Name of the tool that the job is for.", 120),
            "limit": { "description": "Limit of the 95 % position deviation: 30 um.", "type": "string" },
            "features": { "description": "Tolerances of features." }
        },
        "additionalProperties": false
    })
}

fn chain() -> Value {
    let prime = "['’′]";
    let between = r"[\s,–-]+";
    let workpiece_side = format!("w{between}({AXIS}{prime}{between})*");
    let tool_side = format!(r"b{between}({AXIS}{between})*(\({AXIS}\){between})?t");
    let walk = format!(r"^\s*([VH]?\s*\[)?\s*{workpiece_side}{tool_side}\s*\]?\s*$");
    json!({
        "anyOf": [
            text(&walk, "a walk from workpiece to tool such as w C' A' Y' b X Z t"),
            { "type": "array", "items": { "type": "string" }, "minItems": 1 }
        ],
        "examples": ["w C' A' Y' b X Z t", "w X' Y' b Z t", "w b X Y Z t"]
    })
}

/// Axes by name: the letters that imply kind and direction one by one.
fn axes(generator: &mut SchemaGenerator) -> Value {
    let entry = object::<AxisEntry>(generator);
    let known: serde_json::Map<String, Value> =
        LETTERS.iter().map(|(name, words)| ((*name).to_owned(), or_null(words, entry.clone()))).collect();
    json!({
        "type": "object",
        "properties": known,
        "patternProperties": { format!("^{AXIS}$"): or_null("An axis.", entry) },
        "additionalProperties": false
    })
}

/// Meshes by body.
fn look(generator: &mut SchemaGenerator) -> Value {
    let path = json!({ "type": "string", "minLength": 1, "maxLength": 4096 });
    let entry = any(vec![path, object::<MeshFields>(generator), json!({ "type": "null" })]);
    json!({
        "type": "object",
        "patternProperties": { format!("^(bed|workpiece|tool|{AXIS})$"): entry },
        "additionalProperties": false
    })
}

/// Bounds by the name of an error, of an axis, or of a pair of linear axes.
fn tolerances(generator: &mut SchemaGenerator) -> Value {
    let entry = any(vec![bound(generator).to_value(), object::<BoundEntry>(generator), json!({ "type": "null" })]);
    json!({
        "type": "object",
        "additionalProperties": entry
    })
}

fn volume(generator: &mut SchemaGenerator) -> Value {
    let axis = any(vec![interval(generator).to_value(), object::<VolumeFields>(generator)]);
    json!({
        "type": "object",
        "properties": { "step": step(generator) },
        "patternProperties": { format!("^{AXIS}$"): axis },
        "additionalProperties": false
    })
}
