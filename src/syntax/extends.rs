//! A file and the files it extends become one tree.
//!
//! Mappings merge key by key, so an axis merges by field. An error term, a position and every list are
//! replaced whole, `chain` and `branches` (and the other pairs that exclude each other) replace each
//! other, a plain key displaces that of its name in the blocks of a side, and `null` removes.

use super::files::{Files, lexical};
use super::geometry::{self, WrittenChains};
use super::layer::Layer;
use super::mapping::{FileForm, WrittenMapping, read_mapping};
use super::nulls::{strip, without_null};
use super::places::{Keys, Places, below, keys};
use super::schema::schema;
use crate::diagnostic::{Diagnostic, Diagnostics, Place, codes, shown};
use serde_yaml::{Mapping, Value};
use std::path::{Path, PathBuf};

/// Most files in a chain of `extends`, the first one included.
const DEPTH: usize = 8;

/// Reads the file and, below it, what it extends.
pub fn layers(path: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Layer> {
    layer(path, None, files, diagnostics, &mut Vec::new())
}

fn layer(
    path: &Path,
    named: Option<Place>,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
    trail: &mut Vec<PathBuf>,
) -> Option<Layer> {
    let tidy = lexical(path);
    if trail.contains(&tidy) || trail.len() >= DEPTH {
        diagnostics.push(endless(path, trail, &tidy).at(named, ""));
        return None;
    }
    trail.push(tidy);
    let mut own = read_layer(path, named, files, diagnostics)?;
    let here = keys(["extends"]);
    let base = match own.map.remove("extends") {
        None | Some(Value::Null) => return Some(without_nulls(own)),
        Some(Value::String(base)) => own.places.resolve_path(&here, &base),
        Some(_) => {
            let message = "`extends` must be the path of one file";
            diagnostics.push(
                Diagnostic::new(codes::E0202, message).at(own.places.value(&here), "").help("extends: base.yaml"),
            );
            return None;
        }
    };
    let base = layer(&base, own.places.value(&here), files, diagnostics, trail)?;
    Some(merge(base, own))
}

fn endless(path: &Path, trail: &[PathBuf], tidy: &PathBuf) -> Diagnostic {
    let file = shown(&path.display().to_string());
    if trail.contains(tidy) {
        Diagnostic::new(codes::E0208, format!("`extends` is circular: `{file}` extends itself"))
            .help("let one of the files stand alone")
    } else {
        Diagnostic::new(codes::E0208, format!("`extends` joins more than {DEPTH} files"))
            .help("merge some of the files")
    }
}

/// One file's tree and places.
fn read_layer(path: &Path, named: Option<Place>, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Layer> {
    let help = "start with `abbe: 1`, then `machine:`, `chain:`, `axes:`; `abbe init` writes an example";
    let empty = Diagnostic::new(codes::E0109, "the file holds no machine").help(help);
    let root = schema();
    let form = FileForm { schemas: [&root, &root], empty };
    let WrittenMapping { map, places } = read_mapping(path, named, form, files, diagnostics)?;
    Some(Layer { map, places, chains: WrittenChains::default(), moved_gauges: Vec::new() })
}

/// Entries that take each other's place, by where they stand.
fn rivals(parents: &[String], key: &str) -> &'static [&'static str] {
    let depth = parents.len();
    let tool = parents.first().is_some_and(|p| p == "tool") && depth == 1
        || parents.first().is_some_and(|p| p == "tools") && depth == 2;
    match key {
        "chain" if depth == 0 => &["branches"],
        "branches" if depth == 0 => &["chain"],
        "tool" if depth == 0 => &["tools"],
        "tools" if depth == 0 => &["tool"],
        "length" if tool => &["offset"],
        "offset" if tool => &["length"],
        _ => &[],
    }
}

/// An error term, a bound, a class, a position and the branches are replaced whole.
fn replaces_whole(keys: &[String]) -> bool {
    let named = |section: &str| section == "errors" || section == "tolerances";
    let whole = |section: &String| section == "branches" || section == "class" || named(section) && keys.len() == 2;
    keys.first().is_some_and(whole) || geometry::replaces_whole(keys)
}

fn merge(mut base: Layer, over: Layer) -> Layer {
    base.places.adopt_files(&over.places);
    for top in ["abbe", "machine"] {
        // The document itself is where the derived file says so.
        if over.map.contains_key(top) {
            base.places.adopt(&keys([top]), &over.places);
        }
    }
    for entry in geometry::displaced_entries(&base.map, &over.map) {
        remove(&mut base.map, &entry);
        base.places.remove(&entry);
    }
    let moved = geometry::with_origin(&over.map);
    base.moved_gauges.extend(over.moved_gauges);
    base.moved_gauges.extend(geometry::displaced_gauges(&base.map, &over.map));
    merge_map(&mut base.map, over.map, &mut base.places, &over.places, &Vec::new());
    base.chains.note(&moved, &base.map);
    base
}

fn remove(map: &mut Mapping, entry: &[String]) {
    match entry {
        [] => {}
        [last] => {
            map.remove(last.as_str());
        }
        [first, rest @ ..] => {
            if let Some(Value::Mapping(inner)) = map.get_mut(first.as_str()) {
                remove(inner, rest);
            }
        }
    }
}

fn merge_map(base: &mut Mapping, over: Mapping, places: &mut Places, over_places: &Places, parents: &Keys) {
    let own: Vec<String> = over.keys().filter_map(|k| k.as_str().map(str::to_owned)).collect();
    for (key, value) in over {
        let Value::String(name) = &key else { continue };
        let here = below(parents, name);
        for rival in rivals(parents, name) {
            // Both in one file contradict each other; that is for a later stage to say.
            if !own.iter().any(|k| k == rival) && base.remove(*rival).is_some() {
                places.remove(&below(parents, rival));
            }
        }
        if let Some(old) = base.get_mut(name.as_str()) {
            spell_out(old, &here);
        }
        match (base.get_mut(name.as_str()), value) {
            (_, Value::Null) => {
                base.remove(name.as_str());
                places.remove(&here);
            }
            (Some(Value::Mapping(old)), Value::Mapping(new)) if !replaces_whole(&here) => {
                merge_map(old, new, places, over_places, &here);
            }
            (_, value) => {
                base.insert(key, without_null(value));
                places.adopt(&here, over_places);
            }
        }
    }
}

/// `conventions: NAME` is short for `conventions: { preset: NAME }`, which can be merged into.
fn spell_out(old: &mut Value, here: &[String]) {
    if let (Value::String(preset), true) = (&*old, here.len() == 1 && here[0] == "conventions") {
        *old = Value::Mapping([(Value::from("preset"), Value::from(preset.clone()))].into_iter().collect());
    }
}

fn without_nulls(mut layer: Layer) -> Layer {
    layer.map = strip(layer.map);
    layer.chains.note(&[], &layer.map);
    layer
}
