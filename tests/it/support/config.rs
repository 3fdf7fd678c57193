//! Own reader of the files in `configs/`, as far as they use the language: chains, geometry, constants and tables.
//! Unknown content is refused, so that no part of a machine is overlooked.

use std::path::Path;

use serde_yaml::{Mapping, Value};

use crate::oracle::curves::{Curve, Error, Points};
use crate::oracle::machines::{Extra, Sample};
use crate::oracle::matrix::V3;
use crate::oracle::rigid::{Axis, Conventions, Machine};

const DIRECTIONS: &str = "XYZABC";

/// The machine of a file, its first tool mounted.
pub fn sample(path: &Path) -> Sample {
    let file = load(path);
    known(
        &file,
        &["abbe", "machine", "chain", "conventions", "axes", "tool", "tools", "workpiece", "errors", "measured"],
    );
    let mut sample = geometry(&file);
    for (name, value) in entries(&file, "errors") {
        constant(&mut sample, name, text(value));
    }
    let folder = path.parent().unwrap();
    for (word, own) in words(&file) {
        let block = side_block(word, own).into_iter().flat_map(|block| entries(block, "errors"));
        for (name, value) in block {
            match value.as_mapping() {
                None => constant(&mut sample, name, text(value)),
                // The table of the whole axis, below.
                Some(of) => assert!(file["measured"].as_sequence().unwrap().contains(&of["table"]), "{name}"),
            }
        }
    }
    for table in file.get("measured").and_then(Value::as_sequence).into_iter().flatten() {
        measured(&mut sample, &std::fs::read_to_string(folder.join(text(table))).unwrap());
    }
    sample
}

/// The words of the chain that are axes, with their entries.
fn words(file: &Mapping) -> impl Iterator<Item = (&str, &Mapping)> {
    let axes = text(&file["chain"]).split(' ').filter(|word| !["w", "b", "t"].contains(word) && !word.starts_with('('));
    axes.map(|word| (word, file["axes"][word.trim_end_matches('\'')].as_mapping().unwrap()))
}

/// What an axis says of the side on which it is.
fn side_block<'a>(word: &str, own: &'a Mapping) -> Option<&'a Mapping> {
    let side = if word.ends_with('\'') { "on_workpiece" } else { "on_tool" };
    own.get(side).and_then(Value::as_mapping)
}

/// A file merged over the one it extends.
fn load(path: &Path) -> Mapping {
    let mut file: Mapping = serde_yaml::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let Some(base) = file.remove("extends") else { return file };
    let base = path.parent().unwrap().join(text(&base));
    // Lists of files are relative to the file that names them; all variants are one folder below.
    assert!(!file.contains_key("measured"));
    let mut merged = load(&base);
    if let Some(Value::Sequence(list)) = merged.get_mut("measured") {
        list.iter_mut().for_each(|name| *name = Value::String(format!("../{}", text(name))));
    }
    merge(&mut merged, file);
    merged
}

fn merge(base: &mut Mapping, other: Mapping) {
    for (key, value) in other {
        match (base.get_mut(&key), value) {
            (Some(Value::Mapping(old)), Value::Mapping(new)) => merge(old, new),
            (_, Value::Null) => drop(base.remove(&key)),
            (_, value) => drop(base.insert(key, value)),
        }
    }
}

fn geometry(file: &Mapping) -> Sample {
    let conventions = file.get("conventions").map_or_else(Conventions::default, |preset| match text(preset) {
        "bui-kimm" => {
            Conventions { carried_body: true, direct: true, body: true, linearised: true, ..Conventions::default() }
        }
        other => panic!("preset {other}"),
    });
    let chain = text(&file["chain"]);
    let mut rigid = Machine {
        conventions,
        workpiece_origin: optional(file, "workpiece", "origin"),
        workpiece_rotation: rotation(file),
        ..Machine::default()
    };
    let mut axes = Vec::new();
    rigid.spindle = chain.contains('(').then_some([0.0; 6]);
    for (word, own) in words(file) {
        rigid.walk.push(axis(word, own, tool(file).0));
        let travel = (own["travel"] != "continuous").then(|| [0, 1].map(|end| quantity(&own["travel"][end])));
        axes.push(Extra { travel, errors: Default::default() });
    }
    (rigid.gauge, rigid.offset) = tool(file);
    Sample { rigid, axes, branches: false }
}

/// The origin of an axis: of the block of its side, or the plain one. Positions count from the gauge point or from
/// machine zero.
fn origin(word: &str, own: &Mapping, gauge: V3) -> V3 {
    let block = side_block(word, own);
    block.iter().for_each(|block| known(block, &["origin", "errors"]));
    let Some(origin) = block.and_then(|block| block.get("origin")).or(own.get("origin")) else { return [0.0; 3] };
    let Some(relative) = origin.as_mapping() else { return vector(origin) };
    assert_eq!(relative["from"], "gauge", "this reader does not know the point");
    let at = vector(&relative["at"]);
    std::array::from_fn(|k| gauge[k] + at[k])
}

fn axis(word: &str, own: &Mapping, gauge: V3) -> Axis {
    known(own, &["controller", "travel", "origin", "direction", "kind", "sense", "on_tool", "on_workpiece"]);
    let name = word.trim_end_matches('\'').to_owned();
    let letter = "XYZUVWABC".find(&name);
    let rotary = own.get("kind").map_or_else(|| letter.unwrap() >= 6, |kind| kind == "rotary");
    let along = |k| f64::from(u8::from(letter.unwrap() % 3 == k));
    let direction = own.get("direction").map_or_else(|| std::array::from_fn(along), vector);
    let origin = origin(word, own, gauge);
    Axis {
        name,
        rotary,
        workpiece: word.ends_with('\''),
        direct: own.get("sense").map(|sense| text(sense) == "direct"),
        direction,
        origin,
        location: [0.0; 6],
    }
}

fn tool(file: &Mapping) -> (V3, V3) {
    let first = || file["tools"].as_mapping().unwrap().values().next().unwrap();
    let tool = file.get("tool").unwrap_or_else(first).as_mapping().unwrap();
    known(tool, &["gauge", "length", "offset", "direction"]);
    let gauge = tool.get("gauge").map_or([0.0; 3], vector);
    let along = tool.get("direction").map_or([0.0, 0.0, 1.0], vector);
    let norm = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    let below = || along.map(|x| -x / norm * quantity(&tool["length"]));
    let offset = tool.get("offset").map_or_else(below, vector);
    (gauge, offset)
}

/// A location error such as `EC0Y: 12 urad`.
fn constant(sample: &mut Sample, name: &str, value: &str) {
    let (direction, axis) = name[1..].split_once('0').unwrap_or_else(|| panic!("{name} is no location error"));
    let direction = DIRECTIONS.find(direction).unwrap();
    let value = quantity(&Value::String(value.into()));
    match sample.rigid.walk.iter_mut().find(|known| known.name == axis) {
        Some(axis) => axis.location[direction] = value,
        None => sample.rigid.spindle.as_mut().unwrap()[direction] = value,
    }
}

/// A table of errors of one axis.
fn measured(sample: &mut Sample, csv: &str) {
    let mut lines = csv.lines();
    let header: Vec<(&str, &str)> = lines.next().unwrap().split(',').map(heading).collect();
    let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(|cell| cell.trim().parse().unwrap()).collect()).collect();
    let at: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    let axis = sample.rigid.walk.iter().position(|axis| axis.name == header[0].0).unwrap();
    let extra = &mut sample.axes[axis];
    for (column, (name, unit)) in header.iter().enumerate().skip(1) {
        let values: Vec<f64> = rows.iter().map(|row| row[column] * factor(unit)).collect();
        let periodic = extra.travel.is_none();
        let points = Points { at: at.clone(), values, cubic: false, periodic, file: true };
        let points = if periodic { points } else { held(points) };
        let slot = &mut extra.errors[DIRECTIONS.find(&name[1..2]).unwrap()];
        match slot {
            Some(error) => error.reverse = Some(Curve::Points(points)),
            None => *slot = Some(Error { forward: Curve::Points(points), reverse: None }),
        }
        assert_eq!(name.ends_with('-'), slot.as_ref().unwrap().reverse.is_some(), "{name}: forward stands first");
    }
}

/// A corrected command may pass the end of the travel: there the end value holds, nothing is extrapolated.
fn held(mut points: Points) -> Points {
    let last = points.at.len() - 1;
    points.at.insert(0, points.at[0] - 1.0);
    points.values.insert(0, points.values[0]);
    points.at.push(points.at[last + 1] + 1.0);
    points.values.push(points.values[last + 1]);
    points
}

fn heading(cell: &str) -> (&str, &str) {
    cell.trim().strip_suffix(']').and_then(|cell| cell.split_once(" [")).unwrap()
}

fn known(map: &Mapping, keys: &[&str]) {
    // Bounds change no number of the model.
    let inert = ["volume", "provenance", "identify", "tolerances", "class", "covariance"];
    let foreign = map.keys().map(text).find(|key| !keys.contains(key) && !inert.contains(key));
    assert_eq!(foreign, None, "this reader does not know the key");
}

fn entries<'a>(file: &'a Mapping, key: &str) -> impl Iterator<Item = (&'a str, &'a Value)> {
    file.get(key).and_then(Value::as_mapping).into_iter().flatten().map(|(name, value)| (text(name), value))
}

fn optional(file: &Mapping, key: &str, inner: &str) -> V3 {
    file.get(key).and_then(|map| map.get(inner)).map_or([0.0; 3], vector)
}

/// The angles A, B, C of the workpiece, deg.
fn rotation(file: &Mapping) -> V3 {
    let Some(workpiece) = file.get("workpiece").and_then(Value::as_mapping) else { return [0.0; 3] };
    known(workpiece, &["origin", "rotation"]);
    let angles = workpiece.get("rotation").and_then(Value::as_mapping);
    angles.iter().for_each(|angles| known(angles, &["A", "B", "C"]));
    ["A", "B", "C"].map(|letter| angles.and_then(|angles| angles.get(letter)).map_or(0.0, quantity))
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value:?} is no text"))
}

fn vector(value: &Value) -> V3 {
    std::array::from_fn(|i| quantity(&value[i]))
}

/// A number, or a number with a unit: mm, rad for errors, deg for positions.
fn quantity(value: &Value) -> f64 {
    match value.as_f64() {
        Some(number) => number,
        None => {
            let (number, unit) = text(value).split_once(' ').unwrap();
            number.parse::<f64>().unwrap() * factor(unit)
        }
    }
}

fn factor(unit: &str) -> f64 {
    match unit {
        "um" => 1e-3,
        "urad" => 1e-6,
        "mm" | "deg" => 1.0,
        other => panic!("unit {other}"),
    }
}
